"""What a control file's parameters say about moves: units, arcs, cycles, rotary axes, and where to verify.

The base of the table `[parameters]`; what its macros need (sequence numbers, ...) comes on top.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from polycnc.machine import StrictModel, problem

RotaryAxes = Literal["none", "vector", "ac_table", "bc_table"]


_PARALLEL = 1e-6

Finite = Annotated[float, Field(allow_inf_nan=False)]
Triple = tuple[Finite, Finite, Finite]

NO_DIALECT = "none"
"""What a control file names as its dialect if nothing here reads its programs."""


class RotaryAxis(StrictModel):
    """A rotary axis of a five-axis machine."""

    letter: Literal["A", "B", "C"] = Field(description="Its word.")
    on: Literal["table", "head"] = Field(description="What it turns: the part, or the tool.")
    direction: Triple = Field(
        description="What it turns about while the others are at 0. The sense is that of the tool on the part, by the "
        "right-hand rule; turn the direction round for a machine that counts the other way."
    )
    point_mm: Triple = Field(
        default=(0.0, 0.0, 0.0),
        description="A point of its centre line with all rotary axes at 0: of a table from program zero, of a "
        "head from the nose of the spindle.",
    )
    limits_deg: tuple[Finite, Finite] | None = Field(
        default=None, description="Lowest and highest position; absent: it turns without end."
    )

    @field_validator("direction")
    @classmethod
    def _has_a_direction(cls, direction: Triple) -> Triple:
        if math.hypot(*direction) < _PARALLEL:
            raise problem("the direction has no length", hint="write it like [1, 0, 0]")
        return direction

    @field_validator("limits_deg")
    @classmethod
    def _ascends(cls, limits: tuple[float, float] | None) -> tuple[float, float] | None:
        if limits is None:
            return None
        if not limits[0] <= 0.0 <= limits[1] or limits[0] == limits[1]:
            raise problem("the limits do not lie on both sides of 0", hint="write them like [-30, 120]")
        return limits


class FiveAxis(StrictModel):
    """The rotary axes of a machine, in their order from the part to the tool."""

    output: Literal["machine", "tip"] = Field(
        default="machine",
        description="What X, Y, Z are: positions of the machine's axes, or of the tool tip on the part, for a control "
        "that follows the tip itself (RTCP, TCPM, G43.4).",
    )
    inverse_time: bool = Field(
        default=False,
        description="F of feed moves that turn the tool axis is 1 by the minutes of the move, with FEEDMODE 93.",
    )
    turning_deg_min: Annotated[float, Field(gt=0, allow_inf_nan=False)] = Field(
        default=3600.0,
        description="Speed of a feed move with inverse time that only turns the tool about its tip.",
    )
    axis: tuple[RotaryAxis, RotaryAxis] = Field(description="The two axes, from the part to the tool.")

    @model_validator(mode="after")
    def _can_be(self) -> FiveAxis:
        first, second = self.axis
        if first.letter == second.letter:
            raise problem(f"both axes are {first.letter}", hint="give each a letter of its own")
        if first.on == "head" and second.on == "table":
            raise problem("the head comes before the table", hint="name the axes from the part to the tool")
        if _parallel(first.direction, second.direction) or _parallel(second.direction, (0.0, 0.0, 1.0)):
            raise problem(
                "the second axis does not tilt the tool against the first",
                hint="its direction must be neither that of the first nor along Z",
            )
        return self


def _parallel(a: Triple, b: Triple) -> bool:
    across = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return math.hypot(*across) < _PARALLEL * math.hypot(*a) * math.hypot(*b)


class MotionParameters(StrictModel):
    """How moves of a tool path become moves of the control."""

    dialect: str = Field(
        default="din",
        description='Dialect in which the virtual machine reads the program; "none": nothing here reads it, and '
        "`--verify` refuses.",
    )
    machine: str = Field(default="mill3", description="Machine on which `--verify` runs the program.")
    extension: str = Field(default=".nc", description="File extension of a program, if none is named.")
    arc_axis: Literal["auto", "counterclockwise", "clockwise"] = Field(
        default="auto",
        description="What the axis of CIRCLE/ in a tool path is for: arcs by the right-hand rule, or against it; "
        '"auto": against it in a CLSF of NX.',
    )
    turning_plane: Literal["zx", "xy"] = Field(
        default="zx",
        description="Plane of turning in the tool path: X is the radius and Z the axis, or with xy, as NX has it, "
        "X the axis and Y the radius.",
    )
    coordinate_systems: Literal["one", "work_offsets"] = Field(
        default="one",
        description="A tool path in several coordinate systems (MSYS, CSYS): an error, or each is a work offset, the "
        "first one number 1.",
    )
    units: Literal["mm", "inch"] = Field(default="mm", description="Units in which lengths are written.")
    decimals: Annotated[int, Field(ge=0, le=9)] = Field(
        default=3, description="Decimals of positions; centres of arcs are computed from rounded positions."
    )
    arcs: Literal["arcs", "lines"] = Field(default="arcs", description="Arcs stay arcs, or become lines.")
    arc_center: Literal["relative", "absolute"] = Field(
        default="relative", description="I, J, K from the start point, or as a position."
    )
    arc_split: Literal["none", "half", "quadrant"] = Field(
        default="none", description="Split arcs: not, above half a turn, or where they cross an axis."
    )
    arc_planes: tuple[Literal[17, 18, 19], ...] = Field(
        default=(17, 18, 19), description="Planes of arcs; an arc in another plane becomes lines."
    )
    arc_min_radius_mm: Annotated[float, Field(ge=0)] = Field(
        default=0.0, description="Arcs with a smaller radius become lines."
    )
    arc_max_radius_mm: Annotated[float, Field(gt=0)] = Field(
        default=100_000.0, description="Arcs with a larger radius become lines."
    )
    helix: Literal["arcs", "lines"] = Field(
        default="arcs", description="Helices stay arcs with a height, or become lines."
    )
    tolerance_mm: Annotated[float, Field(gt=0)] = Field(
        default=0.0003, description="How far lines may lie off the arc they stand for."
    )
    cycles: Literal["macros", "moves"] = Field(
        default="macros",
        description="Drilling cycles call their macros, or become moves (as they do without a macro).",
    )
    chip_break_mm: Annotated[float, Field(ge=0)] = Field(
        default=1.0, description="How far a peck that breaks the chip backs up, in a cycle of moves."
    )
    reentry_mm: Annotated[float, Field(ge=0)] = Field(
        default=1.0, description="How far above the last cut a deep-hole peck begins to feed, likewise."
    )
    rotary: RotaryAxes = Field(
        default="none",
        description="What follows the tool axis: nothing, so that it must stay upright; the words TOOLI, TOOLJ, "
        "TOOLK; or a table with the axes A and C, or B and C. X, Y, Z stay those of the tool tip on the part.",
    )
    five_axis: FiveAxis | None = Field(
        default=None, description="Rotary axes of the machine with their places; in place of `rotary`."
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> MotionParameters:
        if self.five_axis is not None and self.rotary != "none":
            raise problem("'rotary' and 'five_axis' say the same", hint="leave 'rotary' out")
        return self
