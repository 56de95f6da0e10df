"""Where the reading of a program text stands: blocks of words scanned in pieces, and the one that comes next."""

from __future__ import annotations

from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import COMMENT, LABEL, ScanRules, WordColumns, scan, word_columns
from polycnc.nc.text._scan_plain import Block, Word, scan_block

CHUNK_BLOCKS = 1 << 14
_JUMP_BLOCKS = 1 << 8  # scanned behind a call or a return: sub-programs are short, and jumps many
_WORDS_ONLY = COMMENT | LABEL


class BlockReading:
    """Read the blocks of a text from `place` to byte `end`: `words` holds a piece of them, `next` is the next of these.

    `place` is behind the piece.
    """

    def __init__(self, text: ProgramText, text_rules: TextRules, rules: ScanRules) -> None:
        self.place = Place(text)
        self.end = len(text)  # what is beyond is not read
        self.next = 0
        self._chunk = word_columns(CHUNK_BLOCKS)
        self._jump_chunk = word_columns(_JUMP_BLOCKS)
        self.words = self._chunk
        self._text_rules = text_rules
        self._rules = rules

    @property
    def text(self) -> ProgramText:
        """The text that is read."""
        return self.place.text

    @property
    def is_through(self) -> bool:
        """Whether all blocks of the piece have been taken."""
        return self.next >= self.words.n_blocks

    @property
    def here(self) -> Place:
        """The place of the next block."""
        if self.is_through:
            return self.place
        return Place(self.text, int(self.words.offset[self.next]), int(self.words.line[self.next]))

    def more(self) -> bool:
        """Scan the next piece; False at the end."""
        if self.place.offset >= self.end:
            return False
        self._scan(self._chunk)
        return True

    def jump(self, place: Place, end: int) -> None:
        """Go on at another place, up to byte `end` of its text."""
        self.place = place
        self.end = end
        self._scan(self._jump_chunk)

    def stand_at(self, text: ProgramText, line: int) -> None:
        """Take note of the line that something else than reading gives blocks from."""
        self.place = Place(text, self.end, line)

    def stop(self) -> None:
        """Read no more of the present text."""
        self.jump(Place(self.text, self.end, self.place.line), self.end)

    def block(self, index: int) -> Block:
        """Return a block of the piece; one that is more than words is read again."""
        columns, text = self.words, self.text
        offset, line = int(columns.offset[index]), int(columns.line[index])
        flags = int(columns.flags[index])
        if flags & ~_WORDS_ONLY:
            return scan_block(text, offset, line, self._text_rules)
        span = slice(columns.first_word[index], columns.first_word[index + 1])
        words = tuple(
            map(
                Word,
                columns.letter[span].tobytes().decode("ascii"),
                columns.value[span].tolist(),
                columns.place[span].tolist(),
                columns.point[span].astype(bool).tolist(),
            )
        )
        return Block(words, flags, int(columns.skip_level[index]), offset, text.next_line(offset), line)

    def _scan(self, columns: WordColumns) -> None:
        """Scan the blocks that follow the present place; the place moves behind them."""
        place = self.place
        self.words = columns
        data = place.text.data[: self.end]
        offset = scan(data, place.offset, place.line, self._rules, columns)
        self.place = Place(place.text, offset, columns.next_line)
        self.next = 0
