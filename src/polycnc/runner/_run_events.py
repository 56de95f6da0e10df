"""The auxiliary functions of a run, as columns: of a million of them nobody wants a million objects."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
import numpy.typing as npt

from polycnc.nc import LINE_MASK, EventRun, run_word


@dataclass(frozen=True, slots=True)
class RunEvent:
    """An auxiliary function, and when the path came to it."""

    time_s: float
    line: int
    word: str


class RunEvents(Sequence[RunEvent]):
    """Hold the auxiliary functions of a run in their order."""

    def __init__(self) -> None:
        self._words: dict[str, int] = {}
        self._names: list[str] = []
        self._known: dict[tuple[float, float, float], int] = {}  # of runs of plain blocks
        self._time_s = array("d")
        self._line = array("q")
        self._word = array("q")

    def add(self, time_s: float, line: int, word: str) -> None:
        """Append an event."""
        self._time_s.append(time_s)
        self._line.append(line)
        self._word.append(self._number(word))

    def add_run(self, time_s: npt.NDArray[np.float64], events: EventRun) -> None:
        """Append the events of a run of plain blocks."""
        self._time_s.frombytes(time_s.tobytes())
        self._line.frombytes((events.tag & LINE_MASK).tobytes())
        known, numbers = self._known, self._word
        for said in zip(events.speed.tolist(), events.code.tolist(), events.number.tolist(), strict=True):
            number = known.get(said)
            if number is None:
                number = known[said] = self._number(run_word(*said))
            numbers.append(number)

    def _number(self, word: str) -> int:
        number = self._words.setdefault(word, len(self._names))
        if number == len(self._names):
            self._names.append(word)
        return number

    def counts(self) -> Counter[str]:
        """Return how often each word has come."""
        return Counter({self._names[word]: count for word, count in Counter(self._word).items()})

    def __len__(self) -> int:
        return len(self._line)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(list(self))

    @overload
    def __getitem__(self, at: int) -> RunEvent: ...
    @overload
    def __getitem__(self, at: slice) -> list[RunEvent]: ...
    def __getitem__(self, at: int | slice) -> RunEvent | list[RunEvent]:
        if isinstance(at, slice):
            return [self[i] for i in range(*at.indices(len(self)))]
        return RunEvent(self._time_s[at], self._line[at], self._names[self._word[at]])
