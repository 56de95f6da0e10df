"""Who gets the record of a run, and whether each of its cycles is looked at."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from polycnc.kernel import BLOCK
from polycnc.machine import MachineConfig
from polycnc.nc import BlockRecords, ProgramText
from polycnc.runner._execution import Floats, Progress, Rows, TaggedRows

_RECORD_CYCLES = 1 << 14


class Record:
    """Hand the rows of a run on to those who want them.

    With `every_cycle` each cycle is run; then `progress` is read off the rows, else it is asked for: `asked`.
    """

    def __init__(
        self,
        text: ProgramText,
        config: MachineConfig,
        *,
        servo: bool,
        rows: Rows | None,
        tagged: Sequence[TaggedRows],
        progress: Progress | None,
    ) -> None:
        self._sinks: list[Rows] = [] if rows is None else [rows]
        self._tagged = tagged
        self.every_cycle = bool(self._sinks or tagged) or servo or _has_limit_switches(config)
        self.asked = None if self.every_cycle else progress
        if self.every_cycle and progress is not None:
            self._sinks.append(_progress_by_line(text, progress))

    @property
    def is_wanted(self) -> bool:
        """Whether anybody wants the rows."""
        return bool(self._sinks or self._tagged)

    @property
    def cycles(self) -> int:
        """How many cycles the recorder holds."""
        return _RECORD_CYCLES if self.is_wanted else 0

    def take(self, piece: Floats, tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        """Hand a piece on, with the tags of its blocks and the records that read them."""
        for sink in self._sinks:
            sink(piece)
        for tagged in self._tagged:
            tagged(piece, tags, records)


def _progress_by_line(text: ProgramText, progress: Progress) -> Rows:
    """Return a sink that tells how far the line of the last row is into the program."""
    lines = max(text.content.count(b"\n"), text.content.count(b"\r"), 1)

    def tell(rows: npt.NDArray[np.float64]) -> None:
        progress(min(float(rows[-1, BLOCK]) / lines, 1.0))

    return tell


def _has_limit_switches(config: MachineConfig) -> bool:
    return any(
        limit not in (float("inf"), float("-inf")) for axis in config.axes for limit in axis.limit_switches
    )
