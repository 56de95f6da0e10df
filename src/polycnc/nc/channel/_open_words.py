"""The words of a piece of text whose numbers a language knows, like F#101: given their numbers as these are now."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.errors import ProgramError
from polycnc.nc.sources._block_source import WordValues
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import OPEN_VALUE, WordColumns, open_text

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
