"""What a run has cut from a body: what is left, what was removed, and what went wrong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import SourcePosition
from polycnc.runner._blocks import Blocks
from polycnc.runner._engaged import engaged
from polycnc.stock import (
    ContactKind,
    Engagement,
    Form,
    Insert,
    Rows,
    Stock,
    TargetComparison,
    Tool,
    Turned,
    Voxels,
)

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Collision:
    """Say what went wrong in a block: kind, program and line (from 1), when first, and where it was how deep (mm).

    `position` is the block's place in its text, None where that is not known.
    """

    kind: ContactKind
    program: str
    line: int
    position: SourcePosition | None
    t_s: float
    place: tuple[float, float, float]
    depth_mm: float

    def __str__(self) -> str:
        return f"{self.kind}, {self.depth_mm:.3f} mm deep at {_place_text(self.place)}"


@dataclass(frozen=True, slots=True)
class IdleFeed:
    """Say that a block feeds through air alone: program and line (from 1), when, how long (s), and where to."""

    program: str
    line: int
    position: SourcePosition | None
    t_s: float
    duration_s: float
    place: tuple[float, float, float]

    def __str__(self) -> str:
        return f"feeds {self.duration_s:.3f} s through air, to {_place_text(self.place)}"


@dataclass(frozen=True, eq=False)
class Machined:
    """Hold what a run left of a body: the stock, volumes (mm3) in all, by block and by tool, and what went wrong.

    `idle` are blocks that feed through air for long, `idle_s` is how long tools fed without removing anything;
    `comparison` is with the target.
    `removed_mm3` [blocks] belongs to `blocks`; `engagement` is how hard tools cut when. `messages` say what was
    assumed. The body of `form` was cut by `tools` on their `course`, from `zero_mm` in machine coordinates. `missed`
    says where it lies and where tools have cut, if none has met it.
    """

    stock: Stock | Turned | Voxels
    blocks: Blocks
    removed_mm3: Floats
    by_tool_mm3: Mapping[int, float]
    engagement: Engagement
    collisions: list[Collision]
    idle: list[IdleFeed]
    idle_s: float
    comparison: TargetComparison | None
    messages: list[str]
    form: Form
    course: Rows
    tools: Mapping[int, Tool | Insert]
    zero_mm: tuple[float, float, float]
    missed: str = ""

    @property
    def volume_mm3(self) -> float:
        """What all blocks have removed."""
        return float(self.removed_mm3.sum())

    @property
    def rotating(self) -> dict[int, Tool]:
        """The tools that rotate: no inserts."""
        return {number: tool for number, tool in self.tools.items() if isinstance(tool, Tool)}

    def as_dict(self) -> dict[str, Any]:
        """Return sizes, volumes and collisions as plain data for JSON; lines are those of the programs."""
        lines: dict[tuple[str, int], float] = {}
        for number in np.flatnonzero(self.removed_mm3).tolist():
            block = self.blocks[number]
            key = block.program, block.line
            lines[key] = lines.get(key, 0.0) + float(self.removed_mm3[number])
        return {
            "low_mm": list(self.stock.box.low),
            "high_mm": list(self.stock.box.high),
            "cell_mm": self.stock.cell_mm,
            "volume_mm3": self.stock.volume_mm3,
            "removed_mm3": self.volume_mm3,
            "removed_by_tool_mm3": {str(tool): volume for tool, volume in self.by_tool_mm3.items()},
            "removed_by_line_mm3": [
                {"program": program, "line": line, "volume_mm3": volume}
                for (program, line), volume in lines.items()
            ],
            "engagement": engaged(self.engagement, self.blocks),
            "collisions": [
                {
                    "kind": each.kind.name.lower(),
                    "text": str(each),
                    "program": each.program,
                    "line": each.line,
                    "time_s": each.t_s,
                    "place_mm": list(each.place),
                    "depth_mm": each.depth_mm,
                }
                for each in self.collisions
            ],
            "idle_s": self.idle_s,
            "idle": [
                {
                    "text": str(each),
                    "program": each.program,
                    "line": each.line,
                    "time_s": each.t_s,
                    "duration_s": each.duration_s,
                    "place_mm": list(each.place),
                }
                for each in self.idle
            ],
            **({} if self.comparison is None else {"target": _compared(self.comparison)}),
        }


def _compared(found: TargetComparison) -> dict[str, Any]:
    return {
        "tolerance_mm": found.tolerance_mm,
        "gouge_mm3": found.gouge_mm3,
        "rest_mm3": found.rest_mm3,
        "rest_mm": found.rest_mm,
        "rest_place_mm": [] if found.rest_place is None else list(found.rest_place),
    }


def _place_text(place: tuple[float, float, float]) -> str:
    return " ".join(f"{name}{value:.3f}" for name, value in zip("XYZ", place, strict=True))
