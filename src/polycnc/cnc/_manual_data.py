"""What moving axes by hand is about, as data: kinds of motion, what is set for them, what an axis is doing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from polycnc.cnc._reference_steps import Step
from polycnc.errors import UsageError, shown
from polycnc.units import is_finite


class ManualKind(StrEnum):
    """What moves an axis by hand."""

    NONE = "none"
    JOG = "jog"
    INCREMENT = "increment"
    HANDLE = "handle"
    REFERENCE = "reference"
    GO = "go"


@dataclass(frozen=True, slots=True)
class ManualData:
    """Say how a control moves axes by hand; speeds are shares of an axis' highest, or by axis in mm/s or deg/s.

    `soft_limits_unreferenced`: software limits hold before an axis is referenced. `search_again`: referencing a
    referenced axis searches its switch again, where otherwise it goes straight to its reference position.
    `soft_limit_alarm`: an axis that was told to go beyond a software limit puts an alarm on when it rests there.
    """

    jog_share: float = 0.2
    jog_speeds: Mapping[str, float] = field(default_factory=dict)
    reference_share: float = 0.25
    creep_share: float = 0.01
    search_margin: float = 10.0
    soft_limits_unreferenced: bool = False
    search_again: bool = False
    soft_limit_alarm: bool = True

    def __post_init__(self) -> None:
        for speed in (self.jog_share, self.reference_share, self.creep_share, *self.jog_speeds.values()):
            if not (is_finite(speed) and speed > 0.0):
                raise UsageError(
                    f"a manual speed of {shown(speed)} moves nothing", hint="Give a speed above 0."
                )


@dataclass(frozen=True, slots=True)
class AxisMotion:
    """What an axis is doing by hand; `target` None is no end in `direction`.

    `stopping`: it brakes and then is done. `beyond`: it was told to go farther than the software limit at `target`.
    `home`: a reference search goes to the reference position. `braking`: a step of a search is over. `waiting`: what it
    did before has to come to rest first (see `ManualMotion._is_late`).
    """

    kind: ManualKind = ManualKind.NONE
    direction: int = 0
    target: float | None = None
    speed: float = 0.0
    rapid: bool = False
    stopping: bool = False
    beyond: bool = False
    steps: tuple[Step, ...] = ()
    step: int = 0
    braking: bool = False
    home: bool = False
    waiting: bool = False


REST = AxisMotion()
"""An axis that is not moved by hand."""


@dataclass(frozen=True, slots=True)
class Handwheel:
    """The axis that the handwheel was turned for last, and the size of its pulses (mm or degree); "" before that."""

    axis: str = ""
    size: float = 0.0


@dataclass(frozen=True, slots=True)
class ManualState:
    """Everything that manual motion holds beside the kernel's arrays, to go back to."""

    motions: tuple[AxisMotion, ...]
    referenced: tuple[bool, ...]
    feed_overrides: tuple[float, ...]
    rapid_overrides: tuple[float, ...]
    wheel: Handwheel = Handwheel()
