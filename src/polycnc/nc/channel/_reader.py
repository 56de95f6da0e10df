"""The reading of program texts: blocks of words scanned in pieces, and the one that comes next."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from polycnc.errors import ProgramError
from polycnc.nc.channel._prepared import CHUNK_BLOCKS, LEAST_BLOCKS, Prepared
from polycnc.nc.channel._running import Running
from polycnc.nc.records._block_records import Call
from polycnc.nc.sources._block_source import EndSource, WordValues
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import (
    COMMENT,
    LABEL,
    OPEN_VALUE,
    PERCENT,
    ScanRules,
    WordColumns,
    open_text,
    scan,
    word_columns,
)
from polycnc.nc.text._scan_plain import Block, Word, scan_block

_JUMP_BLOCKS = LEAST_BLOCKS  # scanned after a call or a return: sub-programs are short, and jumps many
_LEAST_BLOCK_BYTES = 2  # a letter and the end of its line
_WORDS_ONLY = COMMENT | LABEL


class Reader:
    """Read the blocks of a text up to byte `end`, a piece at a time; `place` is after the piece.

    `at_end` tells whether all blocks of the piece have been taken, `line` is that of the last one. `blocks` counts
    those that have been taken, whoever gives them; those whose skip mark is in `skip_levels` are left out.
    """

    def __init__(
        self, text: ProgramText, text_rules: TextRules, rules: ScanRules, skip_levels: frozenset[int]
    ) -> None:
        self.place = Place(text)
        self.end = len(text)  # what is beyond is not read
        self.at_end = True
        self.line = 0
        self.blocks = 0
        self.skip_levels = skip_levels
        self._jump_chunk = word_columns(_JUMP_BLOCKS)
        self._chunk = self._words = self._jump_chunk
        self._next = 0
        self._after = 0  # the last block of the piece
        self._text_rules = text_rules
        self._rules = rules
        self.word_values: WordValues | None = None
        """What words without a number stand for in the text that is read from now on."""
        self._open: OpenWords | None = None

    @property
    def text(self) -> ProgramText:
        """The text that is read."""
        return self.place.text

    @property
    def here(self) -> Place:
        """The place of the next block."""
        if self.at_end:
            return self.place
        return Place(self.text, int(self._words.offset[self._next]), int(self._words.line[self._next]))

    @property
    def at_named_end(self) -> bool:
        """Whether the last block is a % with words after it, as if it began a remark."""
        begin = int(self._words.offset[self._next - 1])
        line = self.text.content[begin : self.text.line_end(begin)].strip()
        return line.startswith(b"%") and line[1:].lstrip()[:1].isalpha()

    def more(self) -> bool:
        """Scan the next piece; False at the end."""
        if self.place.offset >= self.end:
            return False
        self._scan(self._with_room())
        return True

    def _with_room(self) -> WordColumns:
        """Return columns for a whole piece; a text that is short needs no long ones."""
        blocks = min(CHUNK_BLOCKS, (self.end - self.place.offset) // _LEAST_BLOCK_BYTES + 1)
        if blocks > len(self._chunk.offset):
            self._chunk = word_columns(1 << (blocks - 1).bit_length())  # for what is still coming, too
        return self._chunk

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

    def take(self, running: Running) -> Block | EndSource | None:
        """Take the next block of the piece: None if it is left out, a return where the program that runs ends.

        Raises:
            ProgramError: it is no block.
        """
        words, index = self._words, self._next
        self._next = index + 1
        self.at_end = self._next >= self._after
        self.line = int(words.line[index])
        if words.flags[index] & PERCENT:
            # The % after a program ends it, the one before it does not matter.
            return EndSource.RETURN if running.begun else None
        if int(words.skip_level[index]) in self.skip_levels:
            self.blocks += 1
            return None
        block = self._block(index)
        if block.words:
            if running.begun and block.words[0].letter == "O":
                return EndSource.RETURN  # another program begins here
            running.begun = True
        self.blocks += 1
        return block

    def take_plain(
        self, running: Running, calls: tuple[Call, ...], most: int | None, prepared: Prepared
    ) -> int:
        """Let the compiled kernel prepare what it can, up to block number `most`; return why it stopped."""
        words, first = self._words, self._next
        after = self._after if most is None else min(self._after, first + most - self.blocks)
        feeds = None
        if self._open is not None:
            self._open.fill()
            feeds = self._open.feeds
        self._next, reason = prepared.plain_blocks(words, first, after, self.text, calls, feeds)
        self.at_end = self._next >= self._after
        self.blocks += self._next - first
        if words.first_word[self._next] > words.first_word[first]:
            running.begun = True
        return reason

    def _block(self, index: int) -> Block:
        """Return a block of the piece; one that is more than words is read again."""
        columns, text = self._words, self.text
        offset, line = int(columns.offset[index]), int(columns.line[index])
        flags = int(columns.flags[index])
        if flags & ~_WORDS_ONLY:
            return scan_block(text, offset, line, self._text_rules)
        span = slice(columns.first_word[index], columns.first_word[index + 1])
        if self._open is not None and OPEN_VALUE in columns.point[span]:
            words = tuple(self._words_of(span.start, span.stop))
            return Block(words, flags, int(columns.skip_level[index]), offset, line)
        words = tuple(
            map(
                Word,
                columns.letter[span].tobytes().decode("ascii"),
                columns.value[span].tolist(),
                columns.place[span].tolist(),
                columns.point[span].astype(bool).tolist(),
            )
        )
        return Block(words, flags, int(columns.skip_level[index]), offset, line)

    def _words_of(self, first: int, after: int) -> Iterator[Word]:
        """Yield the words of a block that has some without a number, but those that do not count."""
        columns = self._words
        assert self._open is not None
        for word in range(first, after):
            place = int(columns.place[word])
            if columns.point[word] != OPEN_VALUE:
                letter = chr(columns.letter[word])
                yield Word(letter, float(columns.value[word]), place, bool(columns.point[word]))
                continue
            letter, value = self._open.value(word)
            if value is not None:
                yield Word(letter, value, place, True)

    def _scan(self, columns: WordColumns) -> None:
        """Scan the blocks that follow the present place; the place moves after them."""
        place = self.place
        self._words = columns
        if place.offset >= self.end:
            self._open, self._next, self._after, self.at_end = None, 0, 0, True
            return
        data = place.text.data[: self.end]
        rules = self._rules if self.word_values is None else self._rules._replace(open_words=True)
        offset = scan(data, place.offset, place.line, rules, columns)
        self._open = None
        if self.word_values is not None:
            opened = OpenWords(self.word_values, place.text, columns)
            self._open = opened if opened.any else None
        self.place = Place(place.text, offset, columns.next_line)
        self._next, self._after = 0, columns.n_blocks
        self.at_end = self._after == 0


_NO_LETTER = (
    0  # of a word that does not count, or has no number: the compiled kernel leaves such a block alone
)


class OpenWords:
    """Put the numbers of a language into columns of words; equal words are asked for once.

    `feeds` are the numbers of F words by how they are written, as they were filled in last.
    """

    def __init__(self, values: WordValues, text: ProgramText, columns: WordColumns) -> None:
        self.feeds: tuple[tuple[str, float], ...] = ()
        self._values = values
        self._text = text
        self._columns = columns
        self._known: list[float | None] | None = None
        self._at: npt.NDArray[np.intp] = np.flatnonzero(columns.point[: columns.n_words] == OPEN_VALUE)
        self._letters = columns.letter[self._at]
        self._begins = columns.value[self._at].astype(np.int64)
        slots: dict[tuple[str, str], int] = {}
        places: list[int] = []
        content, count = text.content, len(slots)
        row = np.empty(len(self._at), np.int32)
        letters = self._letters.tobytes().decode("ascii")
        for n, (letter, begin) in enumerate(zip(letters, self._begins.tolist(), strict=True)):
            key = letter, open_text(content, begin)
            row[n] = slot = slots.setdefault(key, count)
            if slot == count:
                places.append(int(columns.place[self._at[n]]))
                count += 1
        self._slots = row
        self._words = [(*key, place) for key, place in zip(slots, places, strict=True)]

    @property
    def any(self) -> bool:
        """Whether there are such words at all."""
        return bool(self._words)

    def fill(self) -> None:
        """Put the present numbers into the columns."""
        values = [self._number(*word) for word in self._words]
        if values == self._known:
            return
        self._known = values
        numbers = np.array([np.nan if value is None else value for value in values])[self._slots]
        self._columns.value[self._at] = numbers
        self._columns.letter[self._at] = np.where(np.isnan(numbers), _NO_LETTER, self._letters)
        self.feeds = tuple(
            (text, value)
            for (letter, text, _), value in zip(self._words, values, strict=True)
            if letter == "F" and value is not None
        )

    def value(self, word: int) -> tuple[str, float | None]:
        """Return letter and present number of a word of the columns, None for one that does not count.

        Raises:
            ProgramError: It has none now.
        """
        index = int(np.searchsorted(self._at, word))
        letter, text, _ = self._words[self._slots[index]]
        return letter, self._values.value(letter, text, int(self._columns.place[word]))

    def _number(self, letter: str, text: str, place: int) -> float | None:
        try:
            return self._values.value(letter, text, place)
        except ProgramError:
            return None  # said when its block comes
