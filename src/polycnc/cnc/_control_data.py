"""What differs from control to control, as data: modes, what a change of mode does, ranges, alarms."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from polycnc.cnc._alarms import ALARMS, AlarmTable
from polycnc.cnc._manual_data import ManualData
from polycnc.cnc._program_memory import MemoryData
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import UsageError, shown
from polycnc.machine import LEAST_OVERRIDE


class Mode(StrEnum):
    """The modes of a control."""

    AUTO = "auto"
    MDI = "mdi"
    JOG = "jog"
    INC = "inc"
    HANDLE = "handle"
    REF = "ref"
    EDIT = "edit"


class OnModeChange(StrEnum):
    """What a change of mode does to a program that is being executed."""

    REFUSE = "refuse"
    HOLD = "hold"  # feed hold; it goes on with a start in its own mode
    RESET = "reset"


class AfterManual(StrEnum):
    """What a start does when axes were moved by hand while the program was interrupted."""

    REFUSE = "refuse"
    RETURN = "return"  # the axes go back first, at jogging speed


@dataclass(frozen=True, slots=True)
class ControlData:
    """Say how a control behaves where controls differ.

    `rapid_overrides` are the steps of the rapid override. `referenced_at_start`: encoders that know their position when
    switched on. `reference_required`: no start of a program before all axes are referenced. `emergency_needs_reset`:
    after an emergency stop a reset comes first. `answer_limit_s`: how long the PLC may take (None: for ever).
    `dry_run_mm_min` is the feed of a dry run, `sub_program_names` are the names under which a called number is sought.
    `reset_stops_spindle`, `end_stops_spindle` (M2, M30) and `count_parts` (at the program end) say so.
    `serial_number` is that of the control.
    """

    manual: ManualData = field(default_factory=ManualData)
    memory: MemoryData = field(default_factory=MemoryData)
    alarms: AlarmTable = field(default_factory=lambda: ALARMS)
    history_length: int = 100
    mode_change_while_running: OnModeChange = OnModeChange.REFUSE
    after_manual: AfterManual = AfterManual.REFUSE
    referenced_at_start: bool = True
    reference_required: bool = True
    emergency_needs_reset: bool = True
    reset_stops_spindle: bool = True
    end_stops_spindle: bool = True
    count_parts: bool = True
    most_feed_override: float = 2.0
    rapid_overrides: tuple[float, ...] = (0.0, 0.25, 0.5, 1.0)
    spindle_overrides: tuple[float, float] = (0.0, 2.0)
    answer_limit_s: float | None = None
    dry_run_mm_min: float = 3000.0
    sub_program_names: tuple[str, ...] = ("O{number:04d}", "O{number}", "{number}")
    serial_number: str = ""


@dataclass(frozen=True, slots=True)
class ChannelData:
    """Say what a channel owns: `axes` by their names, which no other channel has, and perhaps the spindle.

    Auxiliary functions of all channels go to the same PLC. Parts are counted by the program ends of the first channel.
    """

    axes: tuple[str, ...]
    spindle: bool = False


def check_channels(channels: tuple[ChannelData, ...], axes: tuple[str, ...]) -> None:
    """Refuse channels that do not share out the axes of a machine.

    Raises:
        UsageError: An axis belongs to none of them or to two, there is no such axis, or two have the spindle.
    """
    given = [axis for channel in channels for axis in channel.axes]
    for axis in (*axes, *given):
        owners = given.count(axis)
        if axis not in axes:
            raise UsageError(f"there is no axis '{axis}'", hint=f"The axes are {', '.join(axes)}.")
        if owners != 1:
            belongs = "no channel" if owners == 0 else f"{owners} channels"
            raise UsageError(f"axis {axis} belongs to {belongs}", hint="Give it to one channel.")
    if any(not channel.axes for channel in channels):
        raise UsageError("a channel has no axes", hint="Give it some, or leave it out.")
    if sum(channel.spindle for channel in channels) > 1:
        raise UsageError("the spindle belongs to several channels", hint="Give it to one.")


@dataclass(frozen=True, slots=True)
class Search:
    """Where a program begins with its next start: the block on `line`, or with sequence number `sequence`.

    With `calculate` what stands before is carried out without moving. It ends after the block on line `last`, if
    that is given.
    """

    line: int = 0
    sequence: int | None = None
    calculate: bool = False
    last: int = 0


@dataclass(frozen=True, slots=True)
class Overrides:
    """The overrides, 1 is 100 %."""

    feed: float = 1.0
    rapid: float = 1.0
    spindle: float = 1.0

    def checked(self, data: ControlData) -> Overrides:
        """Return these overrides if a control has them.

        Raises:
            ControlError: One is out of range, or no step of the rapid override.
        """
        low, high = data.spindle_overrides
        if self.feed != 0.0 and not LEAST_OVERRIDE <= self.feed <= data.most_feed_override:
            hint = f"Give 0, or {LEAST_OVERRIDE:g} to {data.most_feed_override:g}; 1 is 100 %."
            raise _refused("feed", self.feed, hint)
        if self.rapid not in data.rapid_overrides:
            steps = ", ".join(f"{step:g}" for step in data.rapid_overrides)
            raise _refused("rapid", self.rapid, f"The steps are {steps}; 1 is 100 %.")
        if not low <= self.spindle <= high:
            raise _refused("spindle", self.spindle, f"Give {low:g} to {high:g}; 1 is 100 %.")
        return self


@dataclass(frozen=True, slots=True)
class Switches:
    """What the operator has switched on for programs; `block_delete` are the numbers of the skip marks."""

    single_block: bool = False
    optional_stop: bool = False
    dry_run: bool = False
    machine_lock: bool = False
    block_delete: frozenset[int] = frozenset()


def _refused(which: str, value: float, hint: str) -> ControlError:
    return ControlError(Refusal.DATA, f"a {which} override of {shown(value)} is out of range", hint=hint)
