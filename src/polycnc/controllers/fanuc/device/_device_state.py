"""What a Power Mate is at one cycle, beside its control and what is durable: the state of each part, in one value."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from enum import Enum, auto

from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.errors import UsageError

PATHS = 6
SP, ESP, ERS = 1 << 5, 1 << 4, 1 << 7
"""Signals at G8: no feed hold, no emergency stop, external reset."""
SERVO_OFF = 126
_KEYS = frozenset({1, 2, 3, 4})
AT_POWER_ON = {4: 0, 7: 0, 8: SP | ESP, SERVO_OFF: 0}


@dataclass(slots=True)
class SignalState:
    """The signals that are given."""

    torque_override: list[int]
    given: dict[int, int] = field(default_factory=AT_POWER_ON.copy)
    feed: int = 100
    rapid: int = 0
    jog: float = 100.0
    battery_low: bool = False
    torque_mode: int = 0

    @property
    def hold_is_on(self) -> bool:
        """Whether the signal of feed hold is given, so that nothing can start."""
        return not self.given[8] & SP

    @property
    def reset_is_on(self) -> bool:
        """Whether the signal of external reset is given."""
        return bool(self.given[8] & ERS)

    def servo_is_off(self, axis: int) -> bool:
        """Whether the servo of an axis (from 1) is switched off by its signal."""
        return bool(self.given.get(SERVO_OFF, 0) >> axis - 1 & 1)


class Order(Enum):
    """What a direct command does."""

    REFERENCE = auto()
    ABSOLUTE = auto()
    INCREMENTAL = auto()
    DWELL = auto()
    SET = auto()


@dataclass(frozen=True, slots=True)
class Block:
    """A direct command: values by axis (from 1), in increments of the output unit, of a dwell in milliseconds."""

    order: Order
    values: tuple[tuple[int, int], ...]
    feed: int = 0
    flag: bool = False

    @property
    def axes(self) -> frozenset[int]:
        """The axes that it is about."""
        return frozenset(axis for axis, _ in self.values)


@dataclass(slots=True)
class PathBuffers:
    """The buffers of a path: blocks with the number of the buffer that they are in, the first is executed."""

    blocks: deque[tuple[int, Block]]
    begun: bool = False
    until: int = 0  # the cycle at which a dwell ends
    ends: dict[int, float] = field(default_factory=dict)  # where its axes go, in machine coordinates
    held: bool = False  # a hold or a servo that is off has stopped it on its way


@dataclass(slots=True)
class AxisMotionState:
    """Buffers, flags and coordinates; `shift` counts in increments of the machine, which no program changes.

    `held`: a hold was given and has not been taken back.
    """

    shift: list[int]
    paths: list[PathBuffers]
    finished: list[bool]
    held: bool = False

    @classmethod
    def of(cls, axes: int) -> AxisMotionState:
        """Return what there is when the power comes on."""
        return cls([0] * axes, [PathBuffers(deque()) for _ in range(PATHS)], [False] * PATHS)


@dataclass(slots=True)
class SamplingState:
    """Whether sampling of the histories has been stopped."""

    stopped: bool = False


@dataclass(slots=True)
class MacroState:
    """What macros have that is neither a variable nor theirs while they run."""

    user_outputs: int = 0


@dataclass(slots=True)
class MdiState:
    """The blocks that were put in, and the one that execution begins at."""

    blocks: tuple[str, ...] = ()
    start: int = 0


@dataclass(slots=True)
class DeviceState:
    """State of a Power Mate; its parts hold theirs. `increment` and `inch_output` are 1004 and 1001#0 at power-on."""

    signals: SignalState
    axis_motion: AxisMotionState
    inch: bool
    increment: int = 0
    inch_output: bool = False
    mode: PowerMateMode = PowerMateMode.MEM
    cursor: int = 0
    mdi: MdiState = field(default_factory=MdiState)
    skip: bool = False
    skip_positions: tuple[int, ...] = ()
    protection_keys: frozenset[int] = frozenset()
    parameters_writable: bool = True
    macros: MacroState = field(default_factory=MacroState)
    pmc: dict[tuple[str, int], int] = field(default_factory=dict)
    sampling: SamplingState = field(default_factory=SamplingState)

    @classmethod
    def of(cls, axes: int, inch: bool) -> DeviceState:
        """Return what there is when the power comes on."""
        return cls(SignalState([255] * axes), AxisMotionState.of(axes), inch)

    def turn_key(self, on: bool, key: int | None) -> None:
        """Turn a memory protection key (1 to 4, None: all), on is protected.

        Raises:
            UsageError: There is no such key.
        """
        if key is not None and key not in _KEYS:
            raise UsageError(f"there is no key {key}", hint="Keys are 1 to 4.")
        turned = _KEYS if key is None else {key}
        self.protection_keys = self.protection_keys | turned if on else self.protection_keys - turned
