"""What a run gives: times, lengths, extents, alarms, messages, and the trace if it was asked for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import AlarmError, PolycncError, ProgramError

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Alarm:
    """Why a run stopped before its end: a program error or an alarm of the machine."""

    kind: str  # "program" or "machine"
    text: str
    code: str = ""
    line: int = 0
    column: int = 0
    time_s: float = 0.0
    error: PolycncError | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RunMessage:
    """A remark on the program: its text, the first line it is about, and how often it came up."""

    text: str
    line: int
    count: int


@dataclass(frozen=True, slots=True)
class RunEvent:
    """An auxiliary function, and when the path came to it."""

    time_s: float
    line: int
    word: str


@dataclass(frozen=True)
class Trace:
    """Hold one row per control cycle: time, block (line of the program), path speed and positions.

    `axes` and `units` name the columns of `setpoint` [cycles, n] and `actual` (None without simulated servos).
    """

    axes: tuple[str, ...]
    units: tuple[str, ...]
    t_s: Floats
    block: npt.NDArray[np.int64]
    feed_mm_s: Floats
    rapid: npt.NDArray[np.bool_]
    setpoint: Floats
    actual: Floats | None = None

    def __len__(self) -> int:
        return len(self.t_s)


@dataclass(frozen=True)
class RunResult:
    """Say how a program ran. Lengths are mm, times s; positions and extents are machine coordinates by axis."""

    program: str
    dialect: str
    machine: str
    blocks: int
    cycles: int
    time_s: float
    cutting_time_s: float
    rapid_time_s: float
    waiting_time_s: float
    cutting_path_mm: float
    rapid_path_mm: float
    top_feed_mm_min: float
    end_position_mm: dict[str, float]
    extents_mm: dict[str, tuple[float, float]]
    alarms: list[Alarm]
    messages: list[RunMessage]
    events: list[RunEvent]
    trace: Trace | None = None

    @property
    def ok(self) -> bool:
        """Whether the program ran to its end."""
        return not self.alarms

    @property
    def path_mm(self) -> float:
        """Length of the whole path, cutting and rapid."""
        return self.cutting_path_mm + self.rapid_path_mm

    def raise_for_alarms(self) -> None:
        """Raise the error behind the first alarm, if there is one; it carries this result as `result`.

        Raises:
            ProgramError: the program cannot be run as written.
            AlarmError: the machine stopped.
        """
        if not self.alarms:
            return
        alarm = self.alarms[0]
        error = alarm.error or AlarmError(alarm.text, code=alarm.code, time_s=alarm.time_s)
        assert isinstance(error, ProgramError | AlarmError)
        error.result = self
        raise error

    def as_dict(self) -> dict[str, Any]:
        """Return the result as plain data for JSON, without the trace."""
        return {
            "program": self.program,
            "dialect": self.dialect,
            "machine": self.machine,
            "blocks": self.blocks,
            "cycles": self.cycles,
            "time_s": self.time_s,
            "cutting_time_s": self.cutting_time_s,
            "rapid_time_s": self.rapid_time_s,
            "waiting_time_s": self.waiting_time_s,
            "path_mm": self.path_mm,
            "cutting_path_mm": self.cutting_path_mm,
            "rapid_path_mm": self.rapid_path_mm,
            "top_feed_mm_min": self.top_feed_mm_min,
            "end_position_mm": self.end_position_mm,
            "extents_mm": {axis: list(extent) for axis, extent in self.extents_mm.items()},
            "alarms": [
                {
                    "kind": alarm.kind,
                    "code": alarm.code,
                    "text": alarm.text,
                    "line": alarm.line,
                    "column": alarm.column,
                    "time_s": alarm.time_s,
                }
                for alarm in self.alarms
            ],
            "messages": [{"text": m.text, "line": m.line, "count": m.count} for m in self.messages],
            "events": [{"time_s": e.time_s, "line": e.line, "word": e.word} for e in self.events],
        }
