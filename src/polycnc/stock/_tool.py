"""Tools with a shape: what of them cuts, and what must not touch anything."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

from polycnc.errors import UsageError
from polycnc.stock._profile import Arc, Line, Profile, falling_profile, make_profile

LARGEST_MM = 1000.0
"""Of any size of a tool."""
_BAR_SHARE = 0.75
"""How thick a boring bar is, as a part of what it bores."""
_NO_PROFILE = make_profile(())
_OUTLINE = (
    "Give radii and heights from [0, 0], out to the greatest radius and back to a neck, never down: "
    "[[0, 0], [10, 0], [10, 6], [4, 6]]."
)


class ToolKind(StrEnum):
    """What the lower end of a tool looks like."""

    FLAT = "flat"
    BALL = "ball"
    BULL = "bull"
    DRILL = "drill"
    CHAMFER = "chamfer"
    TAPER = "taper"
    BORING = "boring"
    FORM = "form"


@dataclass(frozen=True, slots=True)
class Tool:
    """Describe a tool: kind and sizes (mm, degree).

    `corner_mm` is the radius at the end of a bull-nosed tool, `angle_deg` the included angle of a point (drills,
    chamfering tools) or the angle of a flank to the axis (tapers), `tip_mm` the flat diameter at the end of a
    chamfering or tapered tool. `flute_mm` is how far up it cuts, infinite where that is not known. `shank` and `holder`
    are cylinders above: height above the tip and radius, from below. A `left_hand` tool cuts with M4. `teeth` is how
    many edges cut in a turn, 0 where that is not known. `outline` is that of a form tool: radii and heights from the
    middle of its end out and up; where it comes back to a neck it cuts what lies under something else.

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
    outline: tuple[tuple[float, float], ...] = ()

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
        self._check_outline()
        for name, steps in (("shank", self.shank), ("holder", self.holder)):
            if any(low[0] > high[0] for low, high in pairwise(steps)):
                raise UsageError(f"steps of a {name} that do not rise", hint="Give them from below.")

    def _check_outline(self) -> None:
        if (self.kind is ToolKind.FORM) != bool(self.outline):
            raise UsageError(
                f"a {self.kind} tool with an outline of {len(self.outline)} points", hint=_OUTLINE
            )
        if not self.outline:
            return
        radii, heights = zip(*self.outline, strict=True)
        widest = radii.index(max(radii))
        rises = all(a <= b for a, b in pairwise(heights))
        bends_once = all(a <= b for a, b in pairwise(radii[: widest + 1])) and all(
            a >= b for a, b in pairwise(radii[widest:])
        )
        begins = (radii[0], heights[0]) == (0.0, 0.0)
        if not (begins and rises and bends_once and heights[-1] <= LARGEST_MM and len(radii) > 1):
            raise UsageError("an outline that is no tool's", hint=_OUTLINE)
        if abs(2.0 * max(radii) - self.diameter_mm) > 1e-6:
            raise UsageError(
                f"an outline of {2.0 * max(radii):g} mm on a tool of {self.diameter_mm:g} mm",
                hint="Its greatest radius is half the diameter.",
            )
        if self.undercuts and not (radii[-1] > 0.0 and heights[-1] > 0.0):
            raise UsageError("an outline without a neck", hint=_OUTLINE)

    def __str__(self) -> str:
        return f"{self.kind} of {self.diameter_mm:g} mm"

    @property
    def radius_mm(self) -> float:
        """Half the diameter."""
        return 0.5 * self.diameter_mm

    @property
    def undercuts(self) -> bool:
        """Whether it is narrower above than below."""
        return bool(self.outline) and self.outline[-1][0] < max(radius for radius, _ in self.outline)

    def upper_profile(self) -> Profile:
        """Return how high up it cuts at each radius beyond its neck; of other tools none, they cut all the way."""
        if not self.undercuts:
            return _NO_PROFILE
        radii = [radius for radius, _ in self.outline]
        back = self.outline[radii.index(max(radii)) :][::-1]
        pieces = [Line(0.0, back[0][0], math.inf, math.inf)]
        pieces += [Line(r0, r1, z0, z1) for (r0, z0), (r1, z1) in pairwise(back) if r1 > r0]
        return falling_profile(pieces)

    def cutting_profile(self) -> Profile:
        """Return the outline of what cuts."""
        radius, tip = self.radius_mm, 0.5 * self.tip_mm
        match self.kind:
            case ToolKind.FLAT | ToolKind.BORING:
                return make_profile((Line(0.0, radius, 0.0, 0.0),))
            case ToolKind.FORM:
                widest = max(self.outline)[0]
                below = [
                    at
                    for i, at in enumerate(self.outline)
                    if not any(r >= widest for r, _ in self.outline[:i])
                ]
                return make_profile(
                    [Line(r0, r1, z0, z1) for (r0, z0), (r1, z1) in pairwise(below) if r1 > r0]
                )
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

    def neck_profile(self) -> Profile:
        """Return the outline of the shank, or of the neck of a form tool that has no other."""
        return (
            self.shank_profile()
            if self.shank or not self.undercuts
            else _steps_profile((self.outline[-1][::-1],))
        )

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
