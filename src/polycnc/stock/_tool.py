"""Tools with a shape: what of them cuts, and what must not touch anything."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

from polycnc.errors import UsageError
from polycnc.stock._profile import Arc, Line, Profile, make_profile

LARGEST_MM = 1000.0
"""Of any size of a tool."""
_BAR_SHARE = 0.75
"""How thick a boring bar is, as a part of what it bores."""
_NO_PROFILE = make_profile(())


class ToolKind(StrEnum):
    """What the lower end of a tool looks like."""

    FLAT = "flat"
    BALL = "ball"
    BULL = "bull"
    DRILL = "drill"
    CHAMFER = "chamfer"
    TAPER = "taper"
    BORING = "boring"


@dataclass(frozen=True, slots=True)
class Tool:
    """Describe a tool: kind and sizes (mm, degree).

    `corner_mm` is the radius at the end of a bull-nosed tool, `angle_deg` the included angle of a point (drills,
    chamfering tools) or the angle of a flank to the axis (tapers), `tip_mm` the flat diameter at the end of a
    chamfering or tapered tool. `flute_mm` is how far up it cuts, infinite where that is not known. `shank` and `holder`
    are cylinders above: height above the tip and radius, from below. A `left_hand` tool cuts with M4. `teeth` is how
    many edges cut in a turn, 0 where that is not known.

    Raises:
        UsageError: a size that no tool has, or sizes that do not fit together.
    """

    kind: ToolKind
    diameter_mm: float
    corner_mm: float = 0.0
    angle_deg: float = 0.0
    tip_mm: float = 0.0
    flute_mm: float = math.inf
    holder: tuple[tuple[float, float], ...] = ()
    shank: tuple[tuple[float, float], ...] = ()
    left_hand: bool = False
    teeth: int = 0

    def __post_init__(self) -> None:
        sizes = (self.diameter_mm, *(size for step in (*self.shank, *self.holder) for size in step))
        if not all(0.0 < size <= LARGEST_MM for size in sizes):
            raise UsageError(
                f"a {self.kind} tool of {self.diameter_mm:g} mm",
                hint=f"Sizes of tools are above 0 and at most {LARGEST_MM:g} mm.",
            )
        if not 0.0 <= self.corner_mm <= 0.5 * self.diameter_mm:
            raise UsageError(
                f"a corner radius of {self.corner_mm:g} mm on a tool of {self.diameter_mm:g} mm",
                hint="It is at most half the diameter.",
            )
        if not 0.0 <= self.tip_mm < self.diameter_mm:
            raise UsageError(
                f"a tip of {self.tip_mm:g} mm on a tool of {self.diameter_mm:g} mm",
                hint="It is smaller than the tool.",
            )
        pointed = self.kind in (ToolKind.DRILL, ToolKind.CHAMFER, ToolKind.TAPER)
        if pointed and not 0.0 < self.angle_deg < (90.0 if self.kind is ToolKind.TAPER else 180.0):
            raise UsageError(
                f"an angle of {self.angle_deg:g} degrees on a {self.kind} tool",
                hint="Points have an angle between 0 and 180 degrees, flanks of tapers one between 0 and 90.",
            )
        if not self.flute_mm > 0.0:
            raise UsageError("a tool without flutes", hint="Give a flute length above 0 mm.")
        for name, steps in (("shank", self.shank), ("holder", self.holder)):
            if any(low[0] > high[0] for low, high in pairwise(steps)):
                raise UsageError(f"steps of a {name} that do not rise", hint="Give them from below.")

    def __str__(self) -> str:
        return f"{self.kind} of {self.diameter_mm:g} mm"

    @property
    def radius_mm(self) -> float:
        """Half the diameter."""
        return 0.5 * self.diameter_mm

    def cutting_profile(self) -> Profile:
        """Return the outline of what cuts."""
        radius, tip = self.radius_mm, 0.5 * self.tip_mm
        match self.kind:
            case ToolKind.FLAT | ToolKind.BORING:
                return make_profile((Line(0.0, radius, 0.0, 0.0),))
            case ToolKind.BALL:
                return make_profile((Arc(0.0, radius, 0.0, radius, radius),))
            case ToolKind.BULL:
                inner = radius - self.corner_mm
                flat = (Line(0.0, inner, 0.0, 0.0),) if inner > 0.0 else ()
                round_ = (Arc(inner, radius, inner, self.corner_mm, self.corner_mm),)
                return make_profile((*flat, *(round_ if self.corner_mm > 0.0 else ())))
            case _:
                flank = self.angle_deg if self.kind is ToolKind.TAPER else 0.5 * self.angle_deg
                rise = (radius - tip) / math.tan(math.radians(flank))
                flat = (Line(0.0, tip, 0.0, 0.0),) if tip > 0.0 else ()
                return make_profile((*flat, Line(tip, radius, 0.0, rise)))

    def core_profile(self) -> Profile:
        """Return the outline of what must not touch anything at rapid: of a boring bar what is beside its one edge.

        Its cycles retract it off the wall with the spindle oriented, which a body of its full diameter cannot.
        """
        if self.kind is not ToolKind.BORING:
            return self.cutting_profile()
        bar = min((radius for _, radius in self.shank), default=_BAR_SHARE * self.radius_mm)
        return make_profile((Line(0.0, min(bar, self.radius_mm), 0.0, 0.0),))

    def holder_profile(self) -> Profile:
        """Return the outline of the holder, which must not touch anything."""
        return _steps_profile(self.holder)

    def above_flutes_profile(self, beside_mm: float) -> Profile:
        """Return the outline of what is above the flutes, wider by `beside_mm`; none where it is free or not known.

        A mill with a neck that is narrower than its flutes does not rub, but the flutes of a drill carry its chips.
        """
        necked = bool(self.shank) and self.shank[0][1] < self.radius_mm and self.kind is not ToolKind.DRILL
        if necked or self.kind is ToolKind.BORING or math.isinf(self.flute_mm):
            return _NO_PROFILE
        return _steps_profile(((self.flute_mm, self.radius_mm + beside_mm),))

    def shank_profile(self) -> Profile:
        """Return the outline of the shank, which must not touch anything."""
        return _steps_profile(self.shank)


def _steps_profile(steps: tuple[tuple[float, float], ...]) -> Profile:
    pieces, inner = [], 0.0
    for height, radius in steps:
        if radius > inner:
            pieces.append(Line(inner, radius, height, height))
            inner = radius
    return make_profile(pieces) if pieces else _NO_PROFILE
