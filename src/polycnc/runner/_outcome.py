"""What a run gives: times, lengths, extents, alarms, messages, and the trace if it was asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from polycnc.cnc import ToolTime
from polycnc.errors import AlarmError, PolycncError, ProgramError
from polycnc.machine import MachineConfig
from polycnc.nc import ProgramText
from polycnc.runner._blocks import Execution
from polycnc.runner._operations import Operation
from polycnc.runner._run_events import RunEvent
from polycnc.runner._trace_tables import array_of, arrow_of, columns_of, pandas_of

if TYPE_CHECKING:
    from polycnc.runner._machined import Collision, Machined
    from polycnc.stock import Stock, Turned, Voxels

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Alarm:
    """Why a run stopped before its end: a program error or an alarm of the machine, where and when.

    `line` and `column` count from 1 and are 0 where there is none; `str()` shows the line and the hint too.
    """

    kind: str  # "program" or "machine"
    text: str
    code: str = ""
    line: int = 0
    column: int = 0
    time_s: float = 0.0
    file: str = ""
    hint: str = ""
    error: PolycncError | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        if self.error is not None:
            return str(self.error)
        at = f"{self.time_s:.3f} s" + (f", line {self.line}" if self.line else "")
        return f"{self.text} (at {at})" + (f"\n{self.hint}" if self.hint else "")


@dataclass(frozen=True, slots=True)
class RunMessage:
    """A remark on the program: its text, the first line it is about, and how often it came up."""

    text: str
    line: int
    count: int


@dataclass(frozen=True, repr=False)
class Trace:
    """Hold one row per control cycle: time, block (line of the program), path speed and positions.

    `axes` and `units` name the columns of `setpoint` [cycles, n] and `actual`, which is None without
    simulated servos. The first row is the end of the first cycle, the last row the end of the run.
    `execution` tells the block of each row apart from its neighbours, in whatever program it stands; None in a trace
    that was read from a file. `program` [cycles] names the program of each row; None where there is only one.
    `power` [cycles] is that of a laser, in units of S; None for a machine without one.
    """

    axes: tuple[str, ...]
    units: tuple[str, ...]
    t_s: Floats
    block: npt.NDArray[np.int64]
    feed_mm_s: Floats
    rapid: npt.NDArray[np.bool_]
    setpoint: Floats
    actual: Floats | None = None
    execution: Execution | None = field(default=None, repr=False)
    program: npt.NDArray[np.object_] | None = field(default=None, repr=False)
    power: Floats | None = field(default=None, repr=False)

    def __len__(self) -> int:
        return len(self.t_s)

    def __repr__(self) -> str:
        end = f", {time_text(float(self.t_s[-1]))}" if len(self) else ""
        servo = ", actual positions" if self.actual is not None else ""
        return f"<Trace of {' '.join(self.axes)}: {counted(len(self), 'cycle')}{end}{servo}>"

    def _repr_html_(self) -> str:
        """Return the extents of each axis as a table, for notebooks."""
        from polycnc.web import html_table

        lows, highs = (self.setpoint.min(axis=0), self.setpoint.max(axis=0)) if len(self) else ((), ())
        rows = [
            (f"{axis} ({unit})", f"{low:,.3f}", f"{high:,.3f}")
            for axis, unit, low, high in zip(self.axes, self.units, lows, highs, strict=False)
        ]
        return html_table(repr(self)[1:-1], ("axis", "lowest", "highest"), rows)

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """Return the columns of a trace file by name, and `rapid` before `program`."""
        return columns_of(self)

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        """Return the columns that are numbers, side by side: what a trace file holds but for `program`."""
        return array_of(self, dtype, copy)

    def to_arrow(self) -> Any:
        """Return the columns as a table of pyarrow.

        Raises:
            UsageError: pyarrow is not installed.
        """
        return arrow_of(self)

    def to_pandas(self) -> Any:
        """Return the columns as a data frame of pandas.

        Raises:
            UsageError: pandas is not installed.
        """
        return pandas_of(self)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Return the table for whatever reads Arrow's C stream (polars, DuckDB)."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)


@dataclass(frozen=True, repr=False)
class RunOutcome:
    """Say how a program ran.

    Times are s, lengths mm. Positions and extents are machine coordinates by axis, in the unit that
    `axis_units` names: degree for rotary axes. Cutting is everything that is neither rapid nor waiting.
    """

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
    axis_units: dict[str, str]
    end_position_mm: dict[str, float]
    extents_mm: dict[str, tuple[float, float]]
    alarms: list[Alarm]
    messages: list[RunMessage]
    tool_times: dict[int, ToolTime]
    events: Sequence[RunEvent] = field(repr=False)
    source: ProgramText | None = field(default=None, repr=False, compare=False)
    config: MachineConfig | None = field(default=None, repr=False, compare=False)
    trace: Trace | None = field(default=None, repr=False)
    variables: dict[str, object] = field(default_factory=dict, repr=False)
    """Variables of a program's language by name, after the run: permanent and global ones."""
    operations: list[Operation] = field(default_factory=list, repr=False)
    machined: Machined | None = field(default=None, repr=False, compare=False)
    """What the run has cut from a body, with `stock`."""
    guessed: str = ""
    """Why the dialect was guessed, like "O1000 in line 2"; empty where it was named."""
    refused_s: float | None = None
    """When the path came to the first refused block, with `past_errors`: what comes later is what could be read."""

    def __str__(self) -> str:
        state = "to its end" if self.ok else f"until line {self.alarms[0].line}: {self.alarms[0].text}"
        blocks = counted(self.blocks, "block")
        return f"{self.program} on {self.machine}: {time_text(self.time_s)}, {blocks}, {state}"

    def __repr__(self) -> str:
        return f"<RunResult {self}>"

    @property
    def ok(self) -> bool:
        """Whether the program ran to its end."""
        return not self.alarms

    @property
    def stock(self) -> Stock | Turned | Voxels | None:
        """What is left of the body that was cut, with `stock`."""
        return None if self.machined is None else self.machined.stock

    @property
    def removed_mm3(self) -> float:
        """What was cut from a body, 0 without `stock`; `machined` has it by block and by tool."""
        return 0.0 if self.machined is None else self.machined.volume_mm3

    @property
    def collisions(self) -> list[Collision]:
        """What went wrong in the body that was cut, with `stock`."""
        return [] if self.machined is None else self.machined.collisions

    @property
    def path_mm(self) -> float:
        """Length of the whole path, cutting and rapid."""
        return self.cutting_path_mm + self.rapid_path_mm

    def raise_for_alarms(self) -> None:
        """Raise the error after the first alarm, if there is one; it carries this result as `result`.

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
            "guessed": self.guessed,
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
            "axis_units": self.axis_units,
            "end_position_mm": self.end_position_mm,
            "extents_mm": {axis: list(extent) for axis, extent in self.extents_mm.items()},
            "alarms": [
                {
                    "kind": alarm.kind,
                    "code": alarm.code,
                    "text": alarm.text,
                    "hint": alarm.hint,
                    "file": alarm.file,
                    "line": alarm.line,
                    "column": alarm.column,
                    "time_s": alarm.time_s,
                }
                for alarm in self.alarms
            ],
            "tool_times": {
                str(tool): {"cutting_time_s": time.cutting_s, "rapid_time_s": time.rapid_s}
                for tool, time in self.tool_times.items()
            },
            "operations": [
                {
                    "name": each.name,
                    "line": each.line,
                    "tool": each.tool,
                    "time_s": each.time_s,
                    "cutting_time_s": each.cutting_s,
                    "rapid_time_s": each.rapid_s,
                }
                for each in self.operations
            ],
            "messages": [{"text": m.text, "line": m.line, "count": m.count} for m in self.messages],
            "events": [{"time_s": e.time_s, "line": e.line, "word": e.word} for e in self.events],
            **({"variables": self.variables} if self.variables else {}),
            **({} if self.machined is None else {"stock": self.machined.as_dict()}),
        }


def counted(number: int, thing: str) -> str:
    """Return a number of things: 1 block, 2 blocks, 1,000 blocks."""
    return f"{number:,} {thing}" if number == 1 else f"{number:,} {thing}s"


def time_text(seconds: float) -> str:
    """Return a time as people write it: 0.250 s, 1:02.500 min, 2:03:04.500 h."""
    milliseconds = round(seconds * 1000.0)
    minutes, rest = divmod(milliseconds, 60_000)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours}:{minutes:02d}:{rest / 1000.0:06.3f} h"
    return f"{minutes}:{rest / 1000.0:06.3f} min" if minutes else f"{rest / 1000.0:.3f} s"
