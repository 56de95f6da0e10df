"""Where program zero lies over a run: from machine coordinates to those of the work."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from polycnc.nc import CONTEXT_SHIFT, BlockRecords, Zero

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Zeros:
    """Hold from which row on which zero holds: `zeros` [n] from the rows `start` [n] of a record."""

    start: tuple[int, ...] = ()
    zeros: tuple[Zero, ...] = ()

    def at(self, row: int) -> Zero | None:
        """Return the zero that holds with a row, None where none is known."""
        place = int(np.searchsorted(np.array(self.start, np.int64), row, side="right")) - 1
        return self.zeros[max(place, 0)] if self.zeros else None

    def offsets(self, axes: int) -> Floats:
        """Return the zeros as an array [n, axes]; those of other axes are left out."""
        return np.array([each.offset[:axes] for each in self.zeros], np.float64).reshape(-1, axes)


NO_ZEROS = Zeros()


@dataclass(slots=True)
class ZeroCollector:
    """Collect where program zero lies, while records still say so."""

    _start: list[int] = field(default_factory=list)
    _zeros: list[Zero] = field(default_factory=list)

    def add(self, rows: Sequence[int], tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        """Take rows of the record and the tags of the blocks that begin there."""
        contexts = tags >> CONTEXT_SHIFT
        for place in np.flatnonzero(np.diff(contexts, prepend=~contexts[:1])).tolist():
            zero = records.zero(int(tags[place]))
            if zero is not None and (not self._zeros or zero != self._zeros[-1]):
                self._start.append(int(rows[place]))
                self._zeros.append(zero)

    def zeros(self) -> Zeros:
        """Return everything collected."""
        return Zeros(tuple(self._start), tuple(self._zeros))
