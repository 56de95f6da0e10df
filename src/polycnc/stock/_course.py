"""The course of the tool over a run: thinned to chords, so that a long run stays small."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.stock._chords import find_chords
from polycnc.stock._rows import Rows, joined

Floats = npt.NDArray[np.float64]

TOLERANCE_MM = 0.001
"""How far the tool may be from the chords that are kept."""


class Course:
    """Collect where the tool was: the ends of chords that stay within a tolerance of every row."""

    def __init__(self, tolerance_mm: float = TOLERANCE_MM) -> None:
        self._tolerance_mm = tolerance_mm
        self._pieces: list[Rows] = []
        self._held: Rows | None = None

    def add(self, rows: Rows) -> None:
        """Take the next rows."""
        if not len(rows.t_s):
            return
        if self._held is not None:
            rows = joined([self._held, rows])
        ends = np.zeros(len(rows.t_s), np.int64)
        count = find_chords(rows.guides(), rows.keys(), self._tolerance_mm, ends)
        # The last chord may go on in the next piece: its beginning and its rows so far are looked at again.
        begin = int(ends[count - 2]) if count > 1 else 0
        kept = np.concatenate(([0], ends[: count - 1])) if count > 1 else np.zeros(1, np.int64)
        self._pieces.append(rows.at(kept[:-1] if count > 1 else kept[:0]))
        self._held = rows.at(np.arange(begin, len(rows.t_s)))

    def rows(self) -> Rows:
        """Return what was collected, the last row included."""
        if self._held is None:
            return joined([])
        ends = np.zeros(len(self._held.t_s), np.int64)
        count = find_chords(self._held.guides(), self._held.keys(), self._tolerance_mm, ends)
        return joined([*self._pieces, self._held.at(np.concatenate(([0], ends[:count])))])
