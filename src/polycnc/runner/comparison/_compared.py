"""What is compared, and how far from another path one goes, as values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from polycnc.runner._result import RunResult


@dataclass(frozen=True, slots=True)
class PathDeviation:
    """The greatest distance of one path from another, and where on the one: positions by axis, block, time.

    `mm` counts a degree of a rotary axis as a millimetre. `line` is 0 where there is no path.
    """

    mm: float = 0.0
    position: dict[str, float] = field(default_factory=dict)
    program: str = ""
    line: int = 0
    time_s: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        names = ("mm", "position", "program", "line", "time_s")
        return {name: getattr(self, name) for name in names}


@dataclass(frozen=True, slots=True)
class Compared:
    """What is compared: its name, path and extents, and the result of the run where it was one.

    `top_feed_mm_min` is None for a trace from a file, which does not say what was a rapid.
    """

    name: str
    machine: str
    time_s: float
    path_mm: float
    extents_mm: dict[str, tuple[float, float]]
    top_feed_mm_min: float | None
    result: RunResult | None = field(repr=False)

    @property
    def ok(self) -> bool:
        """Whether the program ran to its end."""
        return self.result is None or self.result.ok

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        names = ("name", "machine", "ok", "time_s", "path_mm", "top_feed_mm_min")
        data: dict[str, Any] = {name: getattr(self, name) for name in names}
        data["extents_mm"] = {axis: list(extent) for axis, extent in self.extents_mm.items()}
        if self.result is not None:
            data |= {
                "cutting_time_s": self.result.cutting_time_s,
                "cutting_path_mm": self.result.cutting_path_mm,
                "tool_times": self.result.as_dict()["tool_times"],
                "alarms": self.result.as_dict()["alarms"],
            }
        return data
