"""Everything a control shows at one cycle, frozen: what every door, page and façade reads."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from enum import StrEnum
from typing import NamedTuple

from polycnc.cnc._alarms import Alarm, OperatorMessage
from polycnc.cnc._control_data import Mode, Overrides, Switches
from polycnc.cnc._frozen import row
from polycnc.cnc._manual_data import Handwheel
from polycnc.cnc._run_state import INTERRUPTED, RunState
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


@row
class AxisStatus(NamedTuple):
    """One axis; positions in `unit` (mm or deg), the velocity per second.

    `machine` is the actual position in machine coordinates, `work` from the program zero of the executed block,
    `relative` from where it was last set, `to_go` what is left of the executed block or of the manual motion.
    `load_percent` follows the speed, 100 at the axis' highest. `jog_speed` is that of a jog key, with `feed_override`,
    the one that acts on the axis when it is moved by hand.
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
    load_percent: float
    jog_speed: float
    feed_override: float = 1.0


@row
class Feed(NamedTuple):
    """Feeds along the path (mm/min, of rotary axes alone deg/min); `programmed` is the F word as it is written."""

    programmed: float = 0.0
    commanded: float = 0.0
    actual: float = 0.0
    rapid: bool = False


@row
class WorkOffset(NamedTuple):
    """A work offset in force: its name, and what its table holds for each axis (mm or deg)."""

    name: str
    values: Mapping[str, float]


@row
class ToolInUse(NamedTuple):
    """The tool in the spindle (0: none) with length and radius of its table, wear added.

    `compensation_mm` is the length compensation in force, with its sign.
    """

    number: int = 0
    length_mm: float = 0.0
    radius_mm: float = 0.0
    compensation_mm: float = 0.0


@row
class ChannelStatus(NamedTuple):
    """One channel: the selected program, the executed block with its calls and modal words, and what it waits for.

    `stack` are the names of the programs that led to the block, the outermost first, its own the last. `axes` are those
    of the channel, in the order of the machine. `starved`: the path rests until more of the program comes.
    """

    run_state: RunState
    motion: Motion
    program: str | None
    block: BlockRecord | None
    modal: ModalWords | None
    stack: tuple[str, ...]
    offsets: tuple[WorkOffset, ...]
    tool: ToolInUse
    feed: Feed
    functions: tuple[str, ...]
    returning: bool
    mode: Mode
    overrides: Overrides
    switches: Switches
    axes: tuple[str, ...]
    starved: bool = False

    @property
    def active(self) -> bool:
        """Whether a program is being executed, or about to when axes have returned."""
        return self.returning or self.run_state is RunState.ACTIVE

    @property
    def interrupted(self) -> bool:
        """Whether a program stands and could go on."""
        return self.run_state in INTERRUPTED


@row
class Status(NamedTuple):
    """A control at one cycle; mode, overrides and switches are those of the first channel.

    `last_alarm` is the machine's date and time (ISO) when the newest alarm of the history came; it may be gone.
    `left_s` is how long what each channel has planned ahead still takes, without holds (s); how long its program has
    taken so far is `Timer.CYCLE`.
    """

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
    last_alarm: str | None
    messages: tuple[OperatorMessage, ...]
    wheel: Handwheel
    timers_s: Mapping[Timer, float]
    left_s: tuple[float, ...]
    parts: Parts

    @property
    def channel(self) -> ChannelStatus:
        """The first channel."""
        return self.channels[0]
