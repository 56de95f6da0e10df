"""What a control's parameters say about drilling cycles."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from polycnc.machine import StrictModel


class Cycles(StrictModel):
    """What the control's parameters say about drilling cycles."""

    chip_break_mm: Annotated[float, Field(ge=0)] = Field(
        default=1.0, description="How far a chip break backs up."
    )
    reentry_mm: Annotated[float, Field(ge=0)] = Field(
        default=1.0, description="How far above the last cut a deep-hole peck begins to feed."
    )
    shift: Literal["+1", "-1", "+2", "-2"] = Field(
        default="+1", description="Axis of the plane and direction in which Q shifts a boring tool."
    )
    peck_tap: Literal["none", "chip_break", "retract"] = Field(
        default="none",
        description='What Q does in a tapping cycle: nothing, "chip_break" backs up, "retract" goes back to R.',
    )
    rigid_tap: bool = Field(default=False, description="Tapping cycles turn the spindle by themselves.")
    feeds_out: bool = Field(
        default=False, description="Tapping and G89 go out at feed all the way, also above R."
    )
    levels_as_written: bool = Field(
        default=False,
        description="R and Z are absolute or incremental by the mode in force at the hole, not where they are written.",
    )
    keeps_dwell: bool = Field(
        default=False, description="A tapping cycle without P waits as long as the last P of a cycle said."
    )
    no_hole: bool = Field(
        default=True, description="L0 or K0 drills nothing and keeps the words for later blocks."
    )
    repeats: tuple[Literal["L", "K"], ...] = Field(
        default=("L", "K"), description="Addresses that say how many holes a block drills."
    )

    begins_without_r: bool = Field(
        default=False,
        description="A cycle that has never had R begins at the level before it, with a remark.",
    )

    @property
    def shift_direction(self) -> tuple[float, float]:
        """Where in the plane Q shifts the tool when a block gives no I and J."""
        sign = 1.0 if self.shift[0] == "+" else -1.0
        return (sign, 0.0) if self.shift[1] == "1" else (0.0, sign)
