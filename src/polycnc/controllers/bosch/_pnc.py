"""A Typ3 osa or PNC control as a device: channels, operator commands, status, memory in its root."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

from polycnc.cnc import (
    AxisStatus,
    ChannelData,
    Control,
    ControlData,
    ControlError,
    ControlSnapshot,
    Refusal,
    RunState,
    Script,
    Status,
)
from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.controllers.bosch._channel_host import ChannelHost
from polycnc.controllers.bosch._channel_ports import MODES, DeviceChannels
from polycnc.controllers.bosch._device_moment import DeviceMoment
from polycnc.controllers.bosch._dialogs import DialogCalls
from polycnc.controllers.bosch._operator import DeviceOperator
from polycnc.controllers.bosch._parameters import DIALOG_CHANNEL
from polycnc.controllers.bosch._services import Services
from polycnc.controllers.bosch._system import BoschSystem
from polycnc.controllers.bosch.files import STORE, RootOwner, SelectedBlock
from polycnc.controllers.bosch.ncs import Mode as BoschMode
from polycnc.controllers.bosch.ncs import NcsServer, find_block
from polycnc.controllers.bosch.screen import Surface
from polycnc.controllers.bosch.system import Tab
from polycnc.machine import Clock, MachineConfig, Snapshot, load_machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.cpl import Fault

_ONE_BY_ONE = (BoschMode.PROGRAM_BLOCK, BoschMode.SINGLE_STEP, BoschMode.SINGLE_BLOCK, BoschMode.DEBUG_BLOCK)
Axes: TypeAlias = Sequence[str]
Condition: TypeAlias = Callable[[], bool]


class Pnc:
    """A control on a machine of its own; channels count from 1, as its programs count them.

    `root` is the control's directory: part programs, files, tables and everything permanent lie in it. `channels` are
    the names of each channel's axes, one channel with all of them if there are none; an axis in none is asynchronous.
    `numbers` are the physical indices of the machine's axes, 1 and up if absent. `keys` are pressed when a program of
    channel 1 asks for one. `server` is the control that programs ask by MCODS and MCOPS, as the `ncs` of another; None:
    this one. `script` says how the PLC answers functions. With `stepping` a debugger can stop at each line. With
    `reselects` a program that has ended, or that MCOPS has left, is selected again (MCODS(70)). With `references` axes
    have to be referenced after power-up before a program starts.

    Raises:
        UsageError: Another control runs in the root.
    """

    def __init__(
        self,
        root: str | Path,
        config: MachineConfig | str | Path | None = None,
        *,
        channels: Sequence[Axes] = (),
        numbers: Sequence[int] = (),
        keys: Sequence[str] = (),
        server: NcsServer | None = None,
        script: Script | None = None,
        servo: bool = False,
        stepping: bool = False,
        reselects: bool = False,
        references: bool = False,
    ) -> None:
        machine = load_machine(config)
        self._owner = RootOwner(Path(root).resolve())
        self._owner.take()
        shares = [tuple(each) for each in channels] or [machine.axis_names]
        axes = SystemAxes(machine.axis_names, numbers)
        axes.set_channels(shares)
        dialect, hosts = load_dialect("bosch"), list[ChannelHost]()
        self._control = Control(
            machine, channels=_owners(shares, machine.axis_names), memory=Path(root) / STORE, dialect=dialect,
            data=_data(references), script=script, servo=servo,
        )  # fmt: skip
        self._control.share_axes(shares)
        self._channels = DeviceChannels(self._control, reselects=reselects)
        store = self._control.machine.memory
        self.system = BoschSystem(root, self._control.clock, machine, self._channels, axes=axes, store=store)
        self.services = Services(self.system, DeviceOperator(self, self._control, self._channels, hosts))
        self.ncs = NcsServer(self.services)
        """Where programs of other controls ask this one; changes of what they asked for are noted in every cycle."""
        self.server = server or self.ncs
        self._control.set_observer(self.ncs, beside=DeviceMoment(self._channels, self.system))
        for number, channel in enumerate(self._control.channels, 1):
            host = ChannelHost(
                self.system, number, keys=keys if number == 1 else (), server=self.server, in_device=True,
                stepping=stepping,
            )  # fmt: skip
            hosts.append(host)
            channel.runs.language = host.language
            channel.change_config(self.system.live_config(), dialect)
            channel.runs.names = axes.names_in(number)
        self.hosts = tuple(hosts)
        self.system.links.start_up()
        self._dialogs = DialogCalls(self.system.directory, self.system.parameters, self._start_dialog)
        self._dialog_channel = int(str(self.system.parameter(DIALOG_CHANNEL)))

    def __repr__(self) -> str:
        return f"<Pnc in {self.system.directory.root}: {self._control!r}>"

    @property
    def clock(self) -> Clock:
        """The clock, counted in control cycles."""
        return self._control.clock

    @property
    def control(self) -> Control:
        """The control within: manual motion, overrides, switches, alarms, PLC."""
        return self._control

    def advance(self, cycles: int, *, until: int | Condition | None = None) -> int:
        """Let up to `cycles` control cycles pass; return how many did (see `Control.advance`)."""
        return self._control.advance(cycles, until=until)

    def status(self) -> Status:
        """Return what the control is and does in the present cycle."""
        return self._control.status()

    def snapshot(self) -> ControlSnapshot:
        """Return the whole state; what is durable is not in it.

        Raises:
            SnapshotError: A CPL program is under way and has a file or a dialog open, or waits for an answer.
        """
        return self._control.snapshot()

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this control.

        Raises:
            SnapshotError: It is of something else; nothing has changed.
        """
        self._control.restore(snapshot)
        for host in self.hosts:
            host.buffer = None

    def close(self) -> None:
        """Keep what is permanent, and close the memory."""
        try:
            for host in self.hosts:
                host.finish()
        finally:
            self._control.machine.memory.close()
            self._owner.release()

    def select_mode(self, mode: BoschMode, *, channel: int | None = None) -> None:
        """Change the mode of a channel, or of all.

        Raises:
            ControlError: There is no such mode, or a program is being executed.
        """
        if mode not in MODES:
            raise ControlError(Refusal.DATA, f"the mode {mode} cannot be selected", hint="See `Mode`.")
        path = None if channel is None else self._path(channel)
        self._control.select_mode(MODES[mode], channel=path)
        self._control.set_switches(single_block=mode in _ONE_BY_ONE, channel=path)
        self._channels.select_mode([*self.system.axes.channels] if channel is None else [channel], mode)

    def select_program(self, name: str, *, channel: int = 1) -> None:
        """Select a part program of the root.

        Raises:
            ControlError: There is none of this name, or the channel executes one.
        """
        text = self._text(name)
        if text is None:
            raise ControlError(Refusal.NOT_FOUND, f"there is no program {name}", hint="Put it into the root.")
        self._channels.found(channel)
        self._control.select_program(ProgramText.from_text(text, name), channel=self._path(channel))
        self.system.reset_signal(channel, False)

    def select_blocks(self, text: str, *, channel: int = 1) -> None:
        """Select blocks put in by hand.

        Raises:
            ControlError: See `Control.set_mdi`.
        """
        self._control.set_mdi(text, channel=self._path(channel))
        self.hosts[channel - 1].buffer = None
        self.system.reset_signal(channel, False)

    def cycle_start(self, *, channel: int = 1) -> None:
        """Begin what is selected, or go on.

        Raises:
            ControlError: See `Control.cycle_start`.
        """
        self._control.cycle_start(channel=self._path(channel))
        self.system.reset_signal(channel, False)

    def search_block(self, start: str = "", end: str = "", *, channel: int = 1) -> int:
        """Let the selected program begin at the first block that begins with `start`; return its line.

        What stands before is carried out without moving, statements too, and the next start goes straight to where the
        block begins. The program ends with the first block from there that begins with `end`. Without one of them it
        begins, or ends, as it would (Manual 003, 4.14.2: MCOPS(3)).

        Raises:
            ControlError: There is no such block, or the program does not come to it; see `Control.search`.
        """
        program = self._control.channels[self._path(channel)].program
        first, last = _found_lines(program, start, end)
        return self._control.search(line=first, calculate=first > 1, last=last, channel=self._path(channel))

    @property
    def dialogs(self) -> tuple[str, ...]:
        """The areas of the operator interface that had a dialog program at power-up (`AREAS`)."""
        return tuple(self._dialogs.areas)

    def call_dialog(self, area: str) -> None:
        """Start the dialog program of an area, as its softkey does, in the channel for dialogs.

        Raises:
            ControlError: The area had none at power-up, or the channel executes a program.
        """
        self._dialogs.call(area)

    def edit_block(self, text: str) -> SelectedBlock:
        """Start the dialog program for an NC block of the editor; what it makes of it is in what is returned.

        Raises:
            ControlError: There is no such program, or the channel executes one.
        """
        return self._dialogs.edit(text)

    def press(self, key: str, *, channel: int = 1) -> None:
        """Press a key, a name of `KEYS` or one character: the program of a channel that asks for one gets it.

        Raises:
            UsageError: There is no such key.
        """
        self.hosts[self._path(channel)].keyboard.press(key)

    def screen(self, channel: int = 1) -> Surface:
        """Return what the programs of a channel have put on the screen."""
        return self.hosts[self._path(channel)].screen

    def feed_hold(self, *, channel: int | None = None) -> None:
        """Hold the feed of a channel, or of all.

        Raises:
            ControlError: Nothing is being executed.
        """
        self._control.feed_hold(channel=None if channel is None else self._path(channel))

    def reset(self, *, channel: int | None = None) -> None:
        """Break off what a channel, or all of them, execute; their errors are gone."""
        self._control.reset(channel=None if channel is None else self._path(channel))
        for number in self.system.axes.channels if channel is None else (channel,):
            self.system.forget_errors(number)
            self.system.reset_signal(number, True)
            self.hosts[number - 1].release()
            self.hosts[number - 1].buffer = None
            self._channels.found(number)

    def transfer_axis(self, axis: str, channel: int | None) -> None:
        """Give an axis to a channel, or to none: then it is asynchronous. Logical indices are counted anew.

        Raises:
            ControlError: There is no such axis or channel, or a channel concerned executes a program.
        """
        names = list(self.system.axes.names)
        if axis not in names or (channel is not None and channel not in self.system.axes.channels):
            raise ControlError(
                Refusal.DATA,
                f"axis {axis} cannot go to channel {channel}",
                hint=f"The axes are {', '.join(names)}.",
            )
        physical = self.system.axes.numbers[names.index(axis)]
        concerned = {self.system.axes.channel_of(physical), channel} - {None}
        for number in concerned:
            each = self._control.channels[self._path(number or 0)]
            if each.active or each.interrupted or not each.at_rest:
                raise ControlError(
                    Refusal.RUNNING,
                    f"channel {number} executes a program",
                    hint="Wait for its end, or reset it.",
                )
        self.system.axes.move(physical, channel)
        self._control.share_axes(
            [tuple(map(self.system.axes.physical_name, own)) for own in self.system.axes.channels.values()]
        )
        for number, each in enumerate(self._control.channels, 1):
            each.runs.names = self.system.axes.names_in(number)

    @property
    def axes(self) -> Mapping[str, AxisStatus]:
        """The axes in the present cycle."""
        return self._control.axes()

    def run_state(self, channel: int = 1) -> RunState:
        """Return what a channel is doing."""
        return self._control.channels[self._path(channel)].run_state

    def is_ready(self, channel: int = 1) -> bool:
        """Tell whether a channel is ready to start (NC ready, NC-O 16.0)."""
        return self.system.shown.renew().channels[channel].is_ready

    def information(self, tab: Tab) -> list[tuple[str, ...]]:
        """Return a list of the information window: number, channel, date, time, ms and description of each entry."""
        self.system.note_errors()
        return [each.columns for each in self.system.errors.shown(tab)]

    def variables(self, channel: int = 1) -> dict[str, object]:
        """Return permanent variables and a channel's global ones, by name."""
        return self.hosts[channel - 1].variables()

    def _start_dialog(self, program: tuple[str, str], block: SelectedBlock | None) -> None:
        channel = self._dialog_channel
        self._control.select_program(
            ProgramText.from_text(program[1], program[0]), channel=self._path(channel)
        )
        self.hosts[channel - 1].files.block = block
        self.cycle_start(channel=channel)

    def _path(self, channel: int) -> int:
        return channel - 1

    def _text(self, name: str) -> str | None:
        try:
            return self.system.directory.text(name)
        except Fault:
            return None


def _data(references: bool) -> ControlData:
    return ControlData(
        referenced_at_start=not references, reference_required=references, reset_stops_spindle=False,
        end_stops_spindle=False,
    )  # fmt: skip


def _owners(shares: Sequence[tuple[str, ...]], names: Sequence[str]) -> list[ChannelData]:
    """Return who has the axes while the control is made: those that no channel has lie in the first one."""
    left = tuple(name for name in names if all(name not in share for share in shares))
    return [
        ChannelData((*share, *left) if n == 0 else share, spindle=n == 0) for n, share in enumerate(shares)
    ]


def _found_lines(program: ProgramText | None, start: str, end: str) -> tuple[int, int]:
    """Return the lines of the first block that begins with `start`, and of the first from there with `end`, or 0."""
    blocks = [] if program is None else [line.decode("latin-1") for line in program.content.splitlines()]
    first = find_block(blocks, start) if start else 0
    last = find_block(blocks, end, first or 0) if end else -1
    if first is None or last is None:
        sought = start if first is None else end
        raise ControlError(Refusal.NOT_FOUND, f"there is no block {sought}", hint="Give its beginning.")
    return first + 1, last + 1
