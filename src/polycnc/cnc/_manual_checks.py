"""What keeps an axis from being moved by hand."""

from __future__ import annotations

from polycnc.cnc._manual_data import ManualKind
from polycnc.cnc._manual_profiles import DOWN, UP, ManualProfiles
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import shown
from polycnc.kernel import POINT_TO_POINT
from polycnc.machine import Machine
from polycnc.units import is_finite


def check_way(profiles: ManualProfiles, i: int, direction: int) -> None:
    """Refuse to move an axis towards the end of travel at which it is."""
    axis = profiles.axes[i]
    if profiles.blocked(i, direction):
        raise ControlError(
            Refusal.TRAVEL,
            f"axis {axis.name} is on a limit switch",
            hint="Move it off in the other direction.",
        )
    if (profiles.soft(i, direction) - profiles.position(i)) * direction <= 0.0:
        raise ControlError(
            Refusal.TRAVEL,
            f"axis {axis.name} is at its software limit",
            hint="Move it in the other direction.",
        )


def check_free(
    machine: Machine, profiles: ManualProfiles, i: int, same: ManualKind = ManualKind.NONE
) -> None:
    """Refuse an axis that something else than `same` is moving."""
    axis = profiles.axes[i].name
    if machine.state.owner[i] != POINT_TO_POINT:
        raise ControlError(
            Refusal.RUNNING, f"a program moves axis {axis}", hint="Wait for its end, or reset it."
        )
    kind = profiles.motions[i].kind
    if kind is not ManualKind.NONE and kind is not same:
        raise ControlError(Refusal.RUNNING, f"axis {axis} is moving ({kind})", hint="Wait until it stops.")


def check_direction(direction: int) -> None:
    """Refuse what is no direction."""
    if direction not in (DOWN, UP):
        raise ControlError(Refusal.DATA, f"{shown(direction)} is no direction", hint="Give 1 or -1.")


def check_size(size: float) -> None:
    """Refuse what is no size of an increment."""
    if not (is_finite(size) and size > 0.0):
        raise ControlError(
            Refusal.DATA,
            f"an increment of {shown(size)} is none",
            hint="Give a size above 0, in mm or degree.",
        )
