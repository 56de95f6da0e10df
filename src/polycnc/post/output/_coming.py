"""What comes later in a tool path: macros may ask for it before it is read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from polycnc.post.macros._control_file import ControlFile
from polycnc.post.tool_path._records import End, Spindle, Tool
from polycnc.post.tool_path._tool_path import ToolPath

SPINDLE_STATES = {"cw": 3.0, "ccw": 4.0, "off": 5.0}


@dataclass(frozen=True, slots=True)
class Coming:
    """The tools of all tool changes, and the speed and state of all records that turn the spindle."""

    tools: Sequence[int] = ()
    spindles: Sequence[tuple[float, float]] = ()

    @classmethod
    def of(cls, tool_path: ToolPath, control: ControlFile) -> Coming:
        """Read the tool path for it, if any macro asks."""
        if not any(control.names(word) for word in ("NEXTTOOL", "NEXTSPINDLE", "NEXTSPINDLESTATE")):
            return cls()
        tools: list[int] = []
        spindles: list[tuple[float, float]] = []
        turning = Spindle(0, "cw")
        for record in tool_path:
            if record.__class__ is End:
                break
            if isinstance(record, Tool):
                tools.append(record.number)
            elif isinstance(record, Spindle) and record.sense != "off":
                turning = turned(turning, record)
                rpm = 0.0 if turning.surface else turning.speed or 0.0
                spindles.append((rpm, SPINDLE_STATES[turning.sense]))
        return cls(tools, spindles)

    def words(self, tools: int, spindles: int) -> dict[str, float]:
        """Return the words after so many tool changes and records that turn the spindle."""
        speed, state = (
            self.spindles[spindles] if spindles < len(self.spindles) else (0.0, SPINDLE_STATES["off"])
        )
        return {
            "NEXTTOOL": float(self.tools[tools]) if tools < len(self.tools) else 0.0,
            "NEXTSPINDLE": speed,
            "NEXTSPINDLESTATE": state,
        }


def turned(before: Spindle | None, record: Spindle) -> Spindle:
    """Return how the spindle turns after a record that switches it on: what it does not say stays as it was."""
    sense = record.sense
    if sense == "on":
        sense = "cw" if before is None else before.sense
    if record.speed is None and before is not None:
        return Spindle(record.line, sense, before.speed, before.surface)
    return Spindle(record.line, sense, record.speed, record.surface)
