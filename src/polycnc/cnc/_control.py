"""A numerical control: modes, the operator's commands, channels, and what they share, as one device.

Every command is carried out or refused whole: a refused one raises `ControlError` and changes nothing. Time passes in
`advance`, in stretches that end where anything has to be looked at, so Python is not entered in every cycle.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import partial
from pathlib import Path

from polycnc.cnc._alarms import MOST_MESSAGE_CHARACTERS, Alarm
from polycnc.cnc._control_checks import wrong_mode
from polycnc.cnc._control_data import ChannelData, ControlData, Mode, Overrides, Switches
from polycnc.cnc._control_parts import Beside, check_shares, make_parts
from polycnc.cnc._control_snapshot import ControlSnapshot, Keeping
from polycnc.cnc._control_time import Condition, ControlEvent, ControlTime, CycleWatch
from polycnc.cnc._inventory import Inventory, InventoryReader
from polycnc.cnc._manual_commands import ManualCommands
from polycnc.cnc._open_program import OpenProgram
from polycnc.cnc._plc import Script
from polycnc.cnc._program_commands import ProgramCommands
from polycnc.cnc._program_edit import ProgramEdit
from polycnc.cnc._settings import Settings
from polycnc.cnc._status import AxisStatus, ChannelStatus, Emergency, Status, ToolInUse
from polycnc.cnc._status_reading import StatusReader
from polycnc.cnc._stopping import PROGRAM_MESSAGE, stop_for
from polycnc.cnc._stops import Step
from polycnc.machine import AnyAxis, Machine, MachineConfig, Snapshot, Store, load_machine
from polycnc.nc import ROOM_BYTES, Dialect, Event, Language, ProgramText, load_dialect


class Control:
    """A numerical control on a machine of its own.

    `channels` share out its axes; without any there is one that has all of them, and the spindle. Each executes its own
    program in its own mode. Commands that take a `channel` mean the first one where they change a program, and all of
    them where they set or stop something, if it is not given.
    `memory` is the durable memory, a file or an open store: programs, tools, offsets, timers, parts, histories.
    `script` tells how the PLC answers auxiliary functions. `servo` simulates the position loops of the machine file.
    `languages` are those of the channels' programs, one for each channel; without any, the language of the dialect.

    Commands raise `ControlError` where the control refuses them; what each refuses is said where it is carried out:
    `Settings`, `ProgramCommands`, `ManualCommands`.
    """

    def __init__(
        self,
        config: MachineConfig | str | Path | None = None,
        *,
        channels: Sequence[ChannelData] = (),
        memory: str | Path | Store | None = None,
        dialect: Dialect | str | Path | None = None,
        data: ControlData | None = None,
        script: Script | None = None,
        servo: bool = False,
        record_cycles: int = 0,
        languages: Sequence[Language | None] = (),
    ) -> None:
        file = load_machine(config)
        shares = check_shares(channels, file)
        machine = Machine(file, servo=servo, paths=len(shares), memory=memory, record_cycles=record_cycles)
        self._parts = of = make_parts(
            machine,
            shares,
            data or ControlData(),
            load_dialect(dialect),
            are_given=bool(channels),
            script=script,
            languages=languages,
            library=self._sub_program,
            on_event=self._on_event,
        )
        self.machine, self.clock, self.channels = machine, of.clock, of.channels
        self.programs, self.tools, self.offsets = of.programs, of.tools, of.offsets
        self.alarms, self.messages, self.timers, self.parts = of.alarms, of.messages, of.timers, of.parts
        self.spindle, self.plc, self.functions, self.manual = of.spindle, of.plc, of.functions, of.manual
        self._time = ControlTime(of, partial(stop_for, of))
        self._settings = Settings(of)
        self._programs = ProgramCommands(of, self._time)
        self._hands = ManualCommands(of)
        self._keeping = Keeping(of, self._time)
        self._reader = StatusReader(of)
        self._inventory = InventoryReader(of)
        self.manual.check_limit_switches()

    def __repr__(self) -> str:
        return f"<Control of {self._parts}>"

    @property
    def dialect(self) -> Dialect:
        """The dialect of the programs."""
        return self._parts.dialect

    @property
    def data(self) -> ControlData:
        """What is set for the control."""
        return self._parts.data

    @data.setter
    def data(self, data: ControlData) -> None:
        self._parts.data = data

    # ------------------------------------------------------------------ modes and settings

    def change_axes(self, axes: tuple[AnyAxis, ...]) -> None:
        """Let the axes have these speeds, accelerations and limits from now on."""
        self._settings.change_axes(axes)

    def share_axes(self, shares: Sequence[tuple[str, ...]]) -> None:
        """Share the axes out anew, one tuple a channel; refused while one executes a program that is to change."""
        self._settings.share_axes(shares)

    def change_dialect(self, dialect: Dialect) -> None:
        """Let programs be read in another dialect, or with other settings of it, from now on."""
        self._settings.change_dialect(dialect)

    @property
    def mode(self) -> Mode:
        """The mode of the first channel."""
        return self.channels[0].mode

    @property
    def overrides(self) -> Overrides:
        """The overrides of the first channel."""
        return self.channels[0].overrides

    @property
    def switches(self) -> Switches:
        """What the operator has switched on for programs of the first channel."""
        return self.channels[0].switches

    @property
    def emergency(self) -> Emergency:
        """The state of the emergency stop."""
        return self._parts.emergency

    def select_mode(
        self, mode: Mode, *, channel: int | None = None, going: Collection[str] = frozenset()
    ) -> None:
        """Change the mode; manual motion of the old one brakes, but of the axes `going`, a foreground edit ends."""
        self._settings.select_mode(mode, channel=channel, going=going)

    def set_overrides(
        self,
        *,
        feed: float | None = None,
        rapid: float | None = None,
        spindle: float | None = None,
        channel: int | None = None,
    ) -> None:
        """Set overrides, 1 is 100 %; what is None stays. Those of all channels hold for axes without a channel too."""
        self._settings.set_overrides(feed=feed, rapid=rapid, spindle=spindle, channel=channel)

    def set_switches(
        self,
        *,
        single_block: bool | None = None,
        optional_stop: bool | None = None,
        dry_run: bool | None = None,
        machine_lock: bool | None = None,
        block_delete: frozenset[int] | None = None,
        channel: int | None = None,
    ) -> None:
        """Switch single block and its like on or off; what is None stays."""
        self._settings.set_switches(
            single_block=single_block,
            optional_stop=optional_stop,
            dry_run=dry_run,
            machine_lock=machine_lock,
            block_delete=block_delete,
            channel=channel,
        )

    # ------------------------------------------------------------------ programs

    def select_program(self, program: str | ProgramText, *, channel: int = 0) -> None:
        """Select what a start in AUTO executes: a program of the memory, or a text of the outside."""
        self._programs.select_program(program, channel=channel)

    def set_mdi(self, text: str, *, channel: int = 0) -> None:
        """Put in the text that a start in MDI executes."""
        self._programs.set_mdi(text, channel=channel)

    def open_program(self, name: str = "", *, room_bytes: int = ROOM_BYTES, channel: int = 0) -> OpenProgram:
        """Open a program that comes while it is executed (AUTO or MDI); the next start begins it."""
        return self._programs.open_program(name, room_bytes=room_bytes, channel=channel)

    def search(
        self,
        *,
        line: int = 0,
        sequence: int | None = None,
        calculate: bool = False,
        last: int = 0,
        channel: int = 0,
    ) -> int:
        """Let the next start begin the selected program at a block; return its line."""
        return self._programs.search(
            line=line, sequence=sequence, calculate=calculate, last=last, channel=channel
        )

    def cycle_start(self, *, channel: int = 0, step: Step = Step.RUN, line: int = 1) -> None:
        """Begin the selected program or the MDI text, or go on where a program is interrupted."""
        self._programs.cycle_start(channel=channel, step=step, line=line)

    def feed_hold(self, *, channel: int | None = None) -> None:
        """Brake the axes of executed programs (None: of all channels) and let them stand; manual motion ends."""
        self._programs.feed_hold(channel=channel)

    def reset(self, *, channel: int | None = None) -> None:
        """Break off everything, and take away the alarms whose causes are gone; the axes brake."""
        self._programs.reset(channel=channel)

    def emergency_stop(self, on: bool = True) -> None:
        """Press or release the emergency stop: everything brakes and is broken off; the spindle stops."""
        self._programs.emergency_stop(on)

    def put_alarm(self, name: str, *, axis: str | None = None, detail: str = "") -> Alarm:
        """Put an alarm on from outside: everything brakes, and only a reset helps; one that is on stays as it is."""
        return self._programs.put_alarm(name, axis=axis, detail=detail)

    def edit(self, name: str, *, background: bool = False) -> ProgramEdit:
        """Open a program for editing: in EDIT in the foreground, in any mode in the background; one of each."""
        if not background and all(channel.mode is not Mode.EDIT for channel in self.channels):
            raise wrong_mode(self.mode, "a program can be edited in the foreground", Mode.EDIT)
        return self._parts.edits.open(name, background=background)

    @property
    def is_editing(self) -> bool:
        """Whether a program is open for editing."""
        return self._parts.edits.any_open

    def jog(self, axis: str, direction: int | None, *, rapid: bool = False) -> None:
        """Press a jog key (1 or -1), or let it go (None)."""
        self._hands.jog(axis, direction, rapid=rapid)

    def increment(self, axis: str, direction: int, size: float, *, rapid: bool = False) -> None:
        """Go one increment (mm or degree)."""
        self._hands.increment(axis, direction, size, rapid=rapid)

    def handwheel(self, axis: str, pulses: int, size: float) -> None:
        """Turn the handwheel by pulses of a size (mm or degree) each."""
        self._hands.handwheel(axis, pulses, size)

    def reference(self, axis: str) -> None:
        """Reference an axis."""
        self._hands.reference(axis)

    def set_relative(self, axis: str, position: float = 0.0) -> None:
        """Let the relative position of an axis be `position` (mm or degree) here."""
        self._hands.set_relative(axis, position)

    @property
    def relative_zero(self) -> tuple[float, ...]:
        """Where the relative positions count from (machine coordinates)."""
        return tuple(self._parts.relative_zero)

    @property
    def raised(self) -> ControlEvent:
        """What happened in the last cycle that was run, and since."""
        return self._time.raised

    def advance(self, cycles: int, *, until: int | Condition | None = None) -> int:
        """Let up to `cycles` control cycles pass; return how many did.

        Fewer after the cycle in which one of the events `until` (`ControlEvent`) happened, or in which the condition
        `until`, looked at in every cycle, holds.
        """
        return self._time.advance(cycles, until=until)

    def be_shared(self, is_enough: Condition | None) -> None:
        """Let `advance` return early when this holds: its thread has more to do than to let the time of this pass."""
        self._time.is_enough = is_enough

    @property
    def has_enough(self) -> bool:
        """Whether its thread has more to do now than to let the time of this pass."""
        return self._time.has_enough

    def set_observer(self, watch: CycleWatch | None, beside: Beside | None = None) -> None:
        """Let somebody look at every cycle while awake (time passes slower); snapshots keep what is `beside`."""
        self._time.watch, self._parts.beside = watch, beside

    def _sub_program(self, number: int) -> ProgramText | None:
        names = (name.format(number=number) for name in self.data.sub_program_names)
        return next((found for found in map(self.programs.find, names) if found is not None), None)

    def _on_event(self, path: int, event: Event) -> bool:
        """Hand the auxiliary functions of a block to spindle and PLC; return whether the path has to wait for them."""
        if event.message:  # until the program goes on or is reset
            self.messages.show(PROGRAM_MESSAGE + path, event.message[:MOST_MESSAGE_CHARACTERS])
        self._time.raised |= ControlEvent.FUNCTION
        return self.functions.on_event(self.channels[path], event, self.dialect)

    def waiting_functions(self, path: int) -> tuple[str, ...]:
        """Return the auxiliary functions, like "M8", that a channel waits for."""
        return self.functions.waiting(path)

    # ------------------------------------------------------------------ state

    def status(self) -> Status:
        """Return what the control is and does in the present cycle; the same object until something changes."""
        return self._reader.status()

    def axes(self) -> Mapping[str, AxisStatus]:
        """Return the axes of the status, without the rest of it."""
        return self._reader.axes()

    def channel_status(self, channel: int = 0) -> ChannelStatus:
        """Return a channel of the status, without the rest of it.

        Raises:
            ControlError: There is no such channel.
        """
        return self._reader.channel(self._parts.channel(channel).path)

    def tool_in_use(self, channel: int = 0) -> ToolInUse | None:
        """Return the tool of a channel of the status, without the rest of it; None before the first block."""
        return self._reader.tool(self._parts.channel(channel).path)

    def inventory(self) -> Inventory:
        """Return what changes seldom: programs, tools, offsets, limits, histories; the same object until it does."""
        return self._inventory.read()

    def snapshot(self) -> ControlSnapshot:
        """Return the whole state, to go back to; what is durable (programs, tables, parts) is not in it."""
        return self._keeping.snapshot()

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this control, or of one made alike."""
        self._keeping.restore(snapshot)
