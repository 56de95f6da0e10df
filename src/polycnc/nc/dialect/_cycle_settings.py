"""What a control's parameters say about drilling cycles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

PeckTap: TypeAlias = Literal["none", "chip_break", "retract"]


@dataclass(frozen=True, slots=True)
class CycleSettings:
    """What a control's parameters say about its cycles.

    `chip_break_mm` is how far G73 backs up, `reentry_mm` how far above the last cut G83 changes from rapid to
    feed. `shift_direction` is where Q shifts the tool when a block gives no I and J. `peck_tap` is what Q does in a
    tapping cycle: nothing, back by `chip_break_mm`, or back to R.
    """

    chip_break_mm: float = 1.0
    reentry_mm: float = 1.0
    shift_direction: tuple[float, float] = (1.0, 0.0)
    peck_tap: PeckTap = "none"
