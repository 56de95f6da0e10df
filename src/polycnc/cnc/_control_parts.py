"""What a control is made of: a machine of its own, channels that share it out, and what they have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

from polycnc.cnc._alarms import AlarmList, OperatorMessages
from polycnc.cnc._auxiliary import AuxiliaryFunctions
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_data import ChannelData, ControlData, check_channels
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._plc import PlcModel, Script
from polycnc.cnc._program_edit import ProgramEdits
from polycnc.cnc._program_memory import ProgramMemory
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._run_making import RunMaker
from polycnc.cnc._spindle import Spindle
from polycnc.cnc._status import Emergency
from polycnc.cnc._tables import OffsetTable, ToolTable
from polycnc.cnc._timers import PartCounter, Timers
from polycnc.errors import shown
from polycnc.machine import Clock, Machine, MachineConfig
from polycnc.nc import Dialect, Event, Language, Library, language_for


class Beside(Protocol):
    """What a device holds beside its control, to be kept in the control's snapshots."""

    def save(self) -> dict[str, Any]:
        """Return it as plain data."""

    def restore_point(self, data: Mapping[str, Any]) -> Callable[[], None]:
        """Return what goes back to what was saved, or to nothing for no data; nothing of it can fail any more.

        Raises:
            SnapshotError: It is not what was saved; nothing has changed.
        """


@dataclass(slots=True)
class ControlParts:
    """The machine, the channels, and what they share; each is the control's attribute of the same name.

    `data`, `dialect` and `emergency` may be exchanged, the others stay. `relative_zero` is where the relative positions
    count from (machine coordinates), by the place of the axis.
    """

    machine: Machine
    clock: Clock
    channels: tuple[ControlChannel, ...]
    data: ControlData
    dialect: Dialect
    programs: ProgramMemory
    edits: ProgramEdits
    tools: ToolTable
    offsets: OffsetTable
    alarms: AlarmList
    messages: OperatorMessages
    timers: Timers
    parts: PartCounter
    spindle: Spindle
    plc: PlcModel
    functions: AuxiliaryFunctions
    manual: ManualMotion
    emergency: Emergency = Emergency.OFF
    relative_zero: list[float] = field(default_factory=list)
    beside: Beside | None = None

    def __str__(self) -> str:
        states = ", ".join(channel.run_state.value for channel in self.channels)
        return (
            f"{self.machine.config.name}: {self.channels[0].mode.value}, {states}, {self.clock.now_s:.3f} s"
        )

    def channel(self, number: int) -> ControlChannel:
        """Return a channel by its number, from 0.

        Raises:
            ControlError: There is no such channel.
        """
        if not 0 <= number < len(self.channels):
            raise ControlError(
                Refusal.DATA,
                f"there is no channel {shown(number)}",
                hint=f"Give 0 to {len(self.channels) - 1}.",
            )
        return self.channels[number]

    def chosen(self, number: int | None) -> tuple[ControlChannel, ...]:
        """Return the channel that a command means, all of them for None.

        Raises:
            ControlError: There is no such channel.
        """
        return self.channels if number is None else (self.channel(number),)

    def owner(self, axis: str) -> ControlChannel:
        """Return the channel of an axis; the first one for an axis that there is not."""
        return next((channel for channel in self.channels if axis in channel.axes), self.channels[0])


def live_config(config: MachineConfig, tools: ToolTable, offsets: OffsetTable) -> MachineConfig:
    """Return a machine file with the tables that change while programs run."""
    return config.model_copy(update={"tools": tools, "offsets": offsets})


def check_shares(channels: Sequence[ChannelData], config: MachineConfig) -> tuple[ChannelData, ...]:
    """Return what each channel has; without channels there is one that has everything.

    Raises:
        UsageError: An axis belongs to none of them or to two, there is no such axis, or two have the spindle.
    """
    shares = tuple(channels) or (ChannelData(config.axis_names, spindle=True),)
    check_channels(shares, config.axis_names)
    return shares


def make_parts(
    machine: Machine,
    shares: Sequence[ChannelData],
    data: ControlData,
    dialect: Dialect,
    *,
    are_given: bool,
    script: Script | None,
    languages: Sequence[Language | None],
    library: Library,
    on_event: Callable[[int, Event], bool],
) -> ControlParts:
    """Return the parts of a control on a machine; `library` finds sub-programs, `on_event` gets each function
    with the number of its channel.

    `are_given` tells that somebody has shared the axes out: an alarm of an axis is that of its channel then.
    """
    store, clock, config = machine.memory, machine.clock, machine.config
    owners = {axis: n for n, share in enumerate(shares) for axis in share.axes} if are_given else {}
    tools, offsets = ToolTable(store, config), OffsetTable(store, config)
    alarms = AlarmList(store, clock, data.alarms, keep=data.history_length, owners=owners)
    spindle = Spindle(clock, config)
    plc = PlcModel(clock, config.times, script, limit_s=data.answer_limit_s)
    manual = ManualMotion(machine, alarms, data.manual, referenced=data.referenced_at_start)
    channels = _channels(
        machine,
        shares,
        data,
        dialect,
        manual,
        live_config(config, tools, offsets),
        languages=languages,
        library=library,
        on_event=on_event,
    )
    programs = ProgramMemory(
        store, clock, data.memory, lambda: frozenset().union(*(channel.programs for channel in channels))
    )
    return ControlParts(
        machine=machine,
        clock=clock,
        channels=channels,
        data=data,
        dialect=dialect,
        programs=programs,
        edits=ProgramEdits(programs),
        tools=tools,
        offsets=offsets,
        alarms=alarms,
        messages=OperatorMessages(store, clock, keep=data.history_length),
        timers=Timers(store, clock),
        parts=PartCounter(store),
        spindle=spindle,
        plc=plc,
        functions=AuxiliaryFunctions(clock, config.times, spindle, plc, end_stops=data.end_stops_spindle),
        manual=manual,
        relative_zero=[0.0] * len(config.axes),
    )


def _channels(
    machine: Machine,
    shares: Sequence[ChannelData],
    data: ControlData,
    dialect: Dialect,
    manual: ManualMotion,
    live: MachineConfig,
    *,
    languages: Sequence[Language | None],
    library: Library,
    on_event: Callable[[int, Event], bool],
) -> tuple[ControlChannel, ...]:
    return tuple(
        ControlChannel(
            machine,
            path,
            share,
            manual,
            RunMaker(
                machine,
                path,
                dialect,
                live,
                share.axes,
                library=library,
                dry_run_mm_s=data.dry_run_mm_min / 60.0,
                most_feed_override=data.most_feed_override,
                on_event=partial(on_event, path),
                language=languages[path] if path < len(languages) else language_for(dialect),
            ),
        )
        for path, share in enumerate(shares)
    )
