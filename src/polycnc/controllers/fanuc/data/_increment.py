"""Increment systems: how long the least increment of an axis is in mm, inch and degree (Manual 000, cnc_rdtofs)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cache

MM_PER_INCH = 25.4


class Increment(StrEnum):
    """The increment systems; parameter 1004 selects one."""

    IS_A = "IS-A"
    IS_B = "IS-B"
    IS_C = "IS-C"

    @property
    def decimals(self) -> int:
        """Return the decimals of lengths in mm and of angles; lengths in inch have one more."""
        return {"IS-A": 2, "IS-B": 3, "IS-C": 4}[self.value]

    @property
    def offset_limit(self) -> int:
        """Return the largest tool offset, in increments."""
        return {"IS-A": 99_999, "IS-B": 999_999, "IS-C": 9_999_999}[self.value]


@dataclass(frozen=True, slots=True)
class Scale:
    """Converts positions of an axis, which the control has in mm or degree, to whole increments and back."""

    decimals: int
    inch: bool = False

    @property
    def step(self) -> float:
        """Return the increment in mm or degree."""
        return 10.0**-self.decimals * (MM_PER_INCH if self.inch else 1.0)

    def counts(self, value: float) -> int:
        """Return a value (mm or degree) in increments, the nearest; half of one goes away from zero."""
        scaled = (value / MM_PER_INCH if self.inch else value) * 10.0**self.decimals
        return int(abs(scaled) + 0.5 + 1e-9) * (1 if scaled >= 0.0 else -1)

    def value(self, counts: int) -> float:
        """Return increments in mm or degree."""
        return counts / 10.0**self.decimals * (MM_PER_INCH if self.inch else 1.0)


@cache
def scale(increment: Increment, *, linear: bool, inch: bool) -> Scale:
    """Return the scale of an axis: inch counts for linear axes only."""
    in_inch = linear and inch
    return Scale(increment.decimals + (1 if in_inch else 0), in_inch)
