"""What a control file's parameters say about moves: units, arcs, cycles, rotary axes, and where to verify.

The base of the table `[parameters]`; what its macros need (sequence numbers, ...) comes on top.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from polycnc.machine import StrictModel

RotaryAxes = Literal["none", "vector", "ac_table", "bc_table"]


class MotionParameters(StrictModel):
    """How moves of a tool path become moves of the control."""

    dialect: str = Field(default="din", description="Dialect in which the virtual machine reads the program.")
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
    units: Literal["mm", "inch"] = Field(default="mm", description="Units in which lengths are written.")
    decimals: Annotated[int, Field(ge=0, le=9)] = Field(
        default=3, description="Decimals of positions; centres of arcs are reckoned from rounded positions."
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
