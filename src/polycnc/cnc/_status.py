"""Everything a control shows at one cycle, frozen: what every door, page and façade reads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from polycnc.cnc._alarms import Alarm, OperatorMessage
from polycnc.cnc._control_data import Mode, Overrides, Switches
from polycnc.cnc._run_state import RunState
from polycnc.cnc._spindle import SpindleState
from polycnc.cnc._timers import Parts, Timer
from polycnc.nc import BlockRecord, ModalWords


class Motion(StrEnum):
    """Whether a channel's axes move."""

    NONE = "none"
    MOVING = "moving"
    DWELL = "dwell"


class Emergency(StrEnum):
    """The state of the emergency stop."""

    OFF = "off"
    ON = "on"
    RESET_NEEDED = "reset needed"  # released, and a reset comes first


@dataclass(frozen=True, slots=True)
class AxisStatus:
    """One axis; positions in `unit` (mm or deg), the velocity per second.

    `machine` is the actual position in machine coordinates, `work` from the program zero of the executed block,
    `relative` from where it was last set, `to_go` what is left of the executed block or of the manual motion.
    """

    name: str
    unit: str
    machine: float
    work: float
    relative: float
    to_go: float
    setpoint: float
    actual: float
    following_error: float
    velocity: float
    referenced: bool
    moving: bool
    manual: str


@dataclass(frozen=True, slots=True)
class Feed:
    """Feeds along the path (mm/min, of rotary axes alone deg/min); `programmed` is the F word as it is written."""

    programmed: float = 0.0
    commanded: float = 0.0
    actual: float = 0.0
    rapid: bool = False


@dataclass(frozen=True, slots=True)
class ChannelStatus:
    """One channel: the selected program, the executed block with its calls and modal words, and what it waits for.

    `axes` are its own, in the order of the machine.
    """

    run_state: RunState
    motion: Motion
    program: str | None
    block: BlockRecord | None
    modal: ModalWords | None
    feed: Feed
    functions: tuple[str, ...]
    returning: bool
    mode: Mode
    overrides: Overrides
    switches: Switches
    axes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Status:
    """A control at one cycle; mode, overrides and switches are those of the first channel."""

    cycle: int
    time_s: float
    now: datetime
    mode: Mode
    emergency: Emergency
    channels: tuple[ChannelStatus, ...]
    axes: Mapping[str, AxisStatus]
    spindle: SpindleState
    overrides: Overrides
    switches: Switches
    alarms: tuple[Alarm, ...]
    messages: tuple[OperatorMessage, ...]
    timers_s: Mapping[Timer, float]
    parts: Parts

    @property
    def channel(self) -> ChannelStatus:
        """The first channel."""
        return self.channels[0]
