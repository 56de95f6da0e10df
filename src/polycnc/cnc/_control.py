"""A numerical control: modes, the operator's commands, channels, and what they share, as one device.

Every command is carried out or refused whole: a refused one raises `ControlError` and changes nothing. Time passes in
`advance`, in stretches that end where anything has to be looked at, so Python is not entered in every cycle.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from polycnc.cnc._alarms import MOST_MESSAGE_CHARACTERS, Alarm, AlarmKind, AlarmList, OperatorMessages
from polycnc.cnc._auxiliary import AuxiliaryFunctions
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_checks import (
    check_hands_off,
    check_over,
    check_ready,
    check_referenced,
    share_axes,
    text_to_begin,
    wrong_mode,
)
from polycnc.cnc._control_data import (
    ChannelData,
    ControlData,
    Mode,
    OnModeChange,
    Overrides,
    Search,
    Switches,
    check_channels,
)
from polycnc.cnc._control_moment import moment_of, put_back
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._control_snapshot import ControlMoment, ControlSnapshot
from polycnc.cnc._control_time import Condition, ControlEvent, ControlTime, CycleWatch
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._plc import PlcModel, Script
from polycnc.cnc._program_edit import ProgramEdit, ProgramEdits
from polycnc.cnc._program_memory import ProgramMemory
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._run_snapshot import file_text
from polycnc.cnc._spindle import Spindle
from polycnc.cnc._status import AxisStatus, ChannelStatus, Emergency, Status
from polycnc.cnc._status_reading import StatusReader
from polycnc.cnc._stops import Step
from polycnc.cnc._tables import OffsetTable, ToolTable
from polycnc.cnc._timers import PartCounter, Timers
from polycnc.machine import (
    AnyAxis,
    Machine,
    MachineConfig,
    Snapshot,
    SnapshotError,
    Store,
    described,
    load_machine,
)
from polycnc.nc import Dialect, Event, Language, ProgramText, load_dialect
from polycnc.nc.macro import language_for

_PROGRAM_MODES = frozenset({Mode.AUTO, Mode.MDI})
_MDI_NAME = "MDI"
PROGRAM_MESSAGE = 3006
"""Number of the message of a stop in a program of the first channel; those of the others follow."""


class Control:
    """A numerical control on a machine of its own.

    `channels` share out its axes; without any there is one that has all of them, and the spindle. Each executes its own
    program in its own mode. Commands that take a `channel` mean the first one where they change a program, and all of
    them where they set or stop something, if it is not given.
    `memory` is the durable memory, a file or an open store: programs, tools, offsets, timers, parts, histories.
    `script` tells how the PLC answers auxiliary functions. `servo` simulates the position loops of the machine file.
    `languages` are those of the channels' programs, one for each channel; without any, the language of the dialect.
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
        data = data or ControlData()
        file = load_machine(config)
        shares = tuple(channels) or (ChannelData(file.axis_names, spindle=True),)
        check_channels(shares, file.axis_names)
        owners = {axis: n for n, share in enumerate(shares) for axis in share.axes} if channels else {}
        self.machine = Machine(
            file, servo=servo, paths=len(shares), memory=memory, record_cycles=record_cycles
        )
        self.dialect = load_dialect(dialect)
        store, clock, machine_file = self.machine.memory, self.machine.clock, self.machine.config
        self.programs = ProgramMemory(store, clock, data.memory)
        self.tools = ToolTable(store, machine_file)
        self.offsets = OffsetTable(store, machine_file)
        self.alarms = AlarmList(store, clock, data.alarms, keep=data.history_length, owners=owners)
        self.messages = OperatorMessages(store, clock, keep=data.history_length)
        self.timers = Timers(store, clock)
        self.parts = PartCounter(store)
        self.spindle = Spindle(clock, machine_file)
        self.plc = PlcModel(clock, machine_file.times, script, limit_s=data.answer_limit_s)
        self.functions = AuxiliaryFunctions(
            clock, machine_file.times, self.spindle, self.plc, end_stops=data.end_stops_spindle
        )
        self.manual = ManualMotion(
            self.machine, self.alarms, data.manual, referenced=data.referenced_at_start
        )
        self._live = self._live_config()
        self.channels = tuple(
            ControlChannel(
                self.machine,
                path,
                share,
                self.dialect,
                self.manual,
                config=self._live,
                library=self._sub_program,
                dry_run_mm_min=data.dry_run_mm_min,
                on_event=self._meet,
                language=languages[path] if path < len(languages) else language_for(self.dialect),
            )
            for path, share in enumerate(shares)
        )
        self.clock = clock
        self._parts = ControlParts(
            self.machine, clock, self.channels, data, self.dialect, self.programs, self.tools, self.offsets,
            self.alarms, self.messages, self.timers, self.parts, self.spindle, self.plc, self.functions, self.manual,
            relative_zero=[0.0] * len(machine_file.axes),
        )  # fmt: skip
        self._time = ControlTime(self._parts, self._fail)
        self._reader = StatusReader(self._parts)
        self._edits = ProgramEdits(self.programs)
        self.manual.check_limit_switches()

    @property
    def data(self) -> ControlData:
        """What is set for the control."""
        return self._parts.data

    @data.setter
    def data(self, data: ControlData) -> None:
        self._parts.data = data

    def _live_config(self) -> MachineConfig:
        """Return the machine file with the tables that change while programs run."""
        return self.machine.config.model_copy(update={"tools": self.tools, "offsets": self.offsets})

    # ------------------------------------------------------------------ modes and settings

    def change_axes(self, axes: tuple[AnyAxis, ...]) -> None:
        """Let the axes have these speeds, accelerations and limits from now on.

        Raises:
            ControlError: A program is being executed or is interrupted, or axes move.
        """
        for channel in self.channels:
            check_over(channel)
        if self.manual.active:
            raise ControlError(Refusal.RUNNING, "axes are moved by hand", hint="Wait until they stand.")
        self.machine.change_axes(axes)
        self.manual.change_axes(axes)
        self._live = self._live_config()
        for channel in self.channels:
            channel.change_config(self._live, self.dialect)

    def share_axes(self, shares: Sequence[tuple[str, ...]]) -> None:
        """Share the axes out anew, one tuple a channel; refused while one executes a program that is to change."""
        share_axes(self.channels, shares)
        self.alarms.owners = {axis: n for n, axes in enumerate(shares) for axis in axes}
        for each in self.channels:
            self.manual.set_overrides(feed=each.overrides.feed, rapid=each.overrides.rapid, axes=each.axes)

    def change_dialect(self, dialect: Dialect) -> None:
        """Let programs be read in another dialect, or with other settings of it, from now on.

        Raises:
            ControlError: A program is being executed or is interrupted.
        """
        for channel in self.channels:
            check_over(channel)
        other = dialect.language != self.dialect.language
        self.dialect = self._parts.dialect = dialect
        for channel in self.channels:
            channel.change_config(self._live, dialect)
            if other:
                channel.language = language_for(dialect)

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
        """Change the mode; manual motion of the old one brakes, but of the axes `going`, a foreground edit ends.

        What it does to a program that is executed is `ControlData.mode_change_while_running`.

        Raises:
            ControlError: No such mode, or a program is being executed and the control refuses to leave its mode then.
        """
        if mode not in list(Mode):
            raise ControlError(
                Refusal.DATA, f"there is no mode '{mode}'", hint=f"The modes are {', '.join(Mode)}."
            )
        mode = Mode(mode)
        changing = [each for each in self._chosen(channel) if each.mode is not mode]
        running = [each for each in changing if each.active]
        what = self.data.mode_change_while_running
        if running and what is OnModeChange.REFUSE:
            raise ControlError(
                Refusal.RUNNING,
                f"the mode cannot change to {mode} while a program is being executed",
                hint="Hold the program first (feed hold), or wait for its end.",
            )
        if what is OnModeChange.RESET:
            self._break_off(running)
        for each in changing:
            each.hold()
            self.manual.stop_all(axis for axis in each.axes if axis not in going)
            if each.mode is Mode.EDIT:
                self._edits.close_foreground()
            each.mode = mode
        self.clock.changes += 1

    def set_overrides(
        self,
        *,
        feed: float | None = None,
        rapid: float | None = None,
        spindle: float | None = None,
        channel: int | None = None,
    ) -> None:
        """Set overrides, 1 is 100 %; what is None stays. Those of all channels hold for axes without a channel too.

        Raises:
            ControlError: One is out of range.
        """
        given = {"feed": feed, "rapid": rapid, "spindle": spindle}
        changes = {name: each for name, each in given.items() if each is not None}
        chosen = self._chosen(channel)
        wanted = [replace(each.overrides, **changes).checked(self.data) for each in chosen]
        for each, overrides in zip(chosen, wanted, strict=True):
            self.manual.set_overrides(feed=overrides.feed, rapid=overrides.rapid, axes=each.axes)
            if each.data.spindle:
                self.spindle.set_override(overrides.spindle)
            each.set_overrides(overrides)
        if channel is None:
            free = set(self.machine.config.axis_names).difference(*(each.axes for each in chosen))
            self.manual.set_overrides(feed=feed, rapid=rapid, axes=free)

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
        """Switch single block and its like on or off; what is None stays.

        Raises:
            ControlError: A skip mark that is not from 1 to 9, a dry run without a feed, or the machine lock while a
                program is executed or interrupted, or axes still brake.
        """
        given: dict[str, Any] = {
            "single_block": single_block,
            "optional_stop": optional_stop,
            "dry_run": dry_run,
            "machine_lock": machine_lock,
            "block_delete": block_delete,
        }
        if block_delete is not None and not block_delete <= frozenset(range(1, 10)):
            raise ControlError(
                Refusal.DATA, f"{sorted(block_delete)} are not skip marks", hint="Give numbers from 1 to 9."
            )
        if dry_run and not self.data.dry_run_mm_min > 0.0:
            raise ControlError(
                Refusal.DATA, "there is no feed for a dry run", hint="Set one (dry_run_mm_min)."
            )
        chosen = self._chosen(channel)
        changes = {name: each for name, each in given.items() if each is not None}
        wanted = [replace(each.switches, **changes) for each in chosen]
        for each, switches in zip(chosen, wanted, strict=True):
            if switches.machine_lock != each.switches.machine_lock:
                check_over(each)
                each.check_rest()
        for each, switches in zip(chosen, wanted, strict=True):
            each.set_switches(switches)

    # ------------------------------------------------------------------ programs

    def select_program(self, program: str | ProgramText, *, channel: int = 0) -> None:
        """Select what a start in AUTO executes: a program of the memory, or a text of the outside.

        Raises:
            ControlError: There is no such program or channel, or the channel executes one.
        """
        chosen = self._channel(channel)
        check_over(chosen)
        text = self.programs.text(program) if isinstance(program, str) else program
        chosen.program = text
        chosen.search = None
        self.clock.changes += 1

    def set_mdi(self, text: str, *, channel: int = 0) -> None:
        """Put in the text that a start in MDI executes.

        Raises:
            ControlError: Not in MDI, no text, no such channel, or the channel executes a program.
        """
        chosen = self._channel(channel)
        if chosen.mode is not Mode.MDI:
            raise wrong_mode(chosen.mode, "a text can be put in", Mode.MDI)
        check_over(chosen)
        if not text.strip():
            raise ControlError(Refusal.DATA, "there is nothing to execute", hint="Write a block.")
        chosen.mdi = ProgramText.from_text(text, _MDI_NAME)

    def search(
        self, *, line: int = 0, sequence: int | None = None, calculate: bool = False, channel: int = 0
    ) -> int:
        """Let the next start begin the selected program at a block; return its line.

        It is the block on `line`, or the first one with a sequence number. With `calculate` everything before is
        carried out without moving, and with the start the axes go straight at rapid to where that block begins; else
        modal state and position are what they are. A reset, another selection and the start itself end the search.

        Raises:
            ControlError: Not in AUTO, nothing is selected, there is no such block, the program cannot begin there, or
                something is being executed or moves.
        """
        chosen = self._channel(channel)
        if chosen.mode is not Mode.AUTO:
            raise wrong_mode(chosen.mode, "a block can be searched", Mode.AUTO)
        check_over(chosen)
        check_hands_off(chosen, self.manual)
        check_ready(self._parts.emergency, self.alarms.of(channel))
        text = text_to_begin(chosen, self.programs, is_mdi=False)
        return chosen.seek(text, Search(line, sequence, calculate))

    def cycle_start(self, *, channel: int = 0, step: Step = Step.RUN, line: int = 1) -> None:
        """Begin the selected program or the MDI text, or go on where a program is interrupted.

        `step` says how far. It begins at `line`; with 1, at the block that was searched.

        Raises:
            ControlError: The emergency stop or an alarm is on, the mode has no programs, nothing is selected, axes
                move or are not referenced, or a program is being executed.
        """
        chosen = self._channel(channel)
        check_ready(self._parts.emergency, self.alarms.of(channel))
        if chosen.mode not in _PROGRAM_MODES:
            raise wrong_mode(chosen.mode, "a program can start", *sorted(_PROGRAM_MODES))
        if chosen.active:
            raise ControlError(
                Refusal.RUNNING, "a program is being executed", hint="Hold it, or wait for its end."
            )
        check_hands_off(chosen, self.manual)
        is_mdi = chosen.mode is Mode.MDI
        if chosen.interrupted:
            if chosen.is_mdi is not is_mdi:
                raise ControlError(
                    Refusal.MODE,
                    f"the program that is interrupted was started in {Mode.MDI if chosen.is_mdi else Mode.AUTO}",
                    hint="Go on in that mode, or reset it.",
                )
            chosen.go_on(self.data.after_manual, step)
            self.messages.withdraw(PROGRAM_MESSAGE + chosen.path)
        else:
            text = text_to_begin(chosen, self.programs, is_mdi=is_mdi)
            if self.data.reference_required:
                check_referenced(chosen, self.manual)
            if not 1 <= line <= text.content.count(b"\n") + 1:
                raise ControlError(
                    Refusal.NOT_FOUND, f"there is no line {line}", hint="Give one that there is."
                )
            search = Search(line) if line > 1 else None if is_mdi else chosen.search
            chosen.begin(text, mdi=is_mdi, step=step, search=search)
            self.timers.start_cycle()
        self._time.note_start(chosen)

    def feed_hold(self, *, channel: int | None = None) -> None:
        """Brake the axes of executed programs (None: of all channels) and let them stand; manual motion ends.

        Raises:
            ControlError: Nothing moves or is being executed.
        """
        chosen = self._chosen(channel)
        running = [each for each in chosen if each.active]
        axes = [axis for each in chosen for axis in each.axes]
        if not running and not self.manual.moves(axes):
            raise ControlError(Refusal.IDLE, "nothing is being executed", hint="There is nothing to hold.")
        for each in running:
            each.hold()
        self.manual.stop_all(axes)
        self._time.raised |= ControlEvent.RUN_STATE

    def reset(self, *, channel: int | None = None) -> None:
        """Break off everything, and take away the alarms whose causes are gone; the axes brake.

        The reset of one channel takes away its own alarms; those of the whole control, and what an emergency stop
        leaves behind, need a reset of all.
        """
        chosen = self._chosen(channel)
        self._break_off(chosen)
        if self.data.reset_stops_spindle and any(each.data.spindle for each in chosen):
            self.spindle.stop()
        if self._parts.emergency is Emergency.RESET_NEEDED and channel is None:
            self._parts.emergency = Emergency.OFF
        self.alarms.reset(channel)
        names = self.machine.config.axis_names
        for axis in (axis for each in chosen for axis in each.axes):
            self.machine.state.servo.error_tripped[names.index(axis)] = 0
        self.manual.check_limit_switches()
        self._time.note_running()
        self._time.raised |= ControlEvent.RUN_STATE

    def emergency_stop(self, on: bool = True) -> None:
        """Press or release the emergency stop: everything brakes and is broken off; the spindle stops."""
        if on and self._parts.emergency is not Emergency.ON:
            self._parts.emergency = Emergency.ON
            self.alarms.put("emergency_stop")
            self._time.raised |= ControlEvent.ALARM
            self._break_off(self.channels)
            self.spindle.stop()
            self._time.note_running()
        elif not on and self._parts.emergency is Emergency.ON:
            self.alarms.cause_gone("emergency_stop")
            self.clock.changes += 1
            needed = self.data.emergency_needs_reset
            self._parts.emergency = Emergency.RESET_NEEDED if needed else Emergency.OFF

    def put_alarm(self, name: str, *, axis: str | None = None, detail: str = "") -> Alarm:
        """Put an alarm on from outside: everything brakes, and only a reset helps; one that is on stays as it is.

        With an axis it is an alarm of the channel that the axis belongs to.
        """
        if self.alarms.has(name, axis):
            return self.alarms.put(name, axis=axis)
        alarm = self.alarms.put(name, axis=axis, detail=detail)
        self._fail((alarm,))
        self._time.raised |= ControlEvent.ALARM
        return alarm

    def _fail(self, alarms: Iterable[Alarm]) -> None:
        """Stop what these alarms stop."""
        for alarm in alarms:
            for channel in self._chosen(alarm.channel):
                self.manual.stop_all(channel.axes)
                channel.fail()

    def _break_off(self, channels: Sequence[ControlChannel]) -> None:
        """Let everything brake, and forget what was under way."""
        for channel in channels:
            self.manual.stop_all(channel.axes)
            channel.reset()
            self.messages.withdraw(PROGRAM_MESSAGE + channel.path)
        self.functions.withdraw(channels)
        if len(channels) == len(self.channels):
            self.plc.cancel()  # what nobody waits for as well

    # ------------------------------------------------------------------ editing

    def edit(self, name: str, *, background: bool = False) -> ProgramEdit:
        """Open a program for editing: in EDIT in the foreground, in any mode in the background; one of each.

        Raises:
            ControlError: Not in EDIT, such an edit is open, or the program is not there, protected or in use.
        """
        if not background and all(channel.mode is not Mode.EDIT for channel in self.channels):
            raise wrong_mode(self.mode, "a program can be edited in the foreground", Mode.EDIT)
        return self._edits.open(name, background=background)

    @property
    def is_editing(self) -> bool:
        """Whether a program is open for editing."""
        return self._edits.any_open

    # ------------------------------------------------------------------ axes by hand

    def jog(self, axis: str, direction: int | None, *, rapid: bool = False) -> None:
        """Press a jog key (1 or -1), or let it go (None).

        Raises:
            ControlError: Not in JOG (letting go is always allowed), or as `ManualMotion.jog`.
        """
        if direction:
            self._lend(axis, Mode.JOG)
        self.manual.jog(axis, direction, rapid=rapid)

    def increment(self, axis: str, direction: int, size: float, *, rapid: bool = False) -> None:
        """Go one increment (mm or degree).

        Raises:
            ControlError: Not in INC, or as `ManualMotion.increment`.
        """
        self._lend(axis, Mode.INC)
        self.manual.increment(axis, direction, size, rapid=rapid)

    def handwheel(self, axis: str, pulses: int, size: float) -> None:
        """Turn the handwheel by pulses of a size (mm or degree) each.

        Raises:
            ControlError: Not in HANDLE, or as `ManualMotion.handwheel`.
        """
        self._lend(axis, Mode.HANDLE)
        self.manual.handwheel(axis, pulses, size)

    def reference(self, axis: str) -> None:
        """Reference an axis.

        Raises:
            ControlError: Not in REF, a program is interrupted, or as `ManualMotion.reference`.
        """
        owner = self._owner(axis)
        if owner.interrupted:
            raise ControlError(
                Refusal.RUNNING, "a program is interrupted", hint="Let it go on to its end, or reset it."
            )
        self._lend(axis, Mode.REF)
        self.manual.reference(axis)

    def set_relative(self, axis: str, position: float = 0.0) -> None:
        """Let the relative position of an axis be `position` (mm or degree) here.

        Raises:
            ControlError: No such axis, or a position that is not finite.
        """
        names = self.machine.config.axis_names
        if axis not in names or position - position != 0.0:
            raise ControlError(
                Refusal.DATA, f"axis {axis} cannot be at {position}", hint=f"The axes are {', '.join(names)}."
            )
        index = names.index(axis)
        self._parts.relative_zero[index] = float(self.machine.state.servo.actual[index]) - position
        self.clock.changes += 1

    @property
    def relative_zero(self) -> tuple[float, ...]:
        """Where the relative positions count from (machine coordinates)."""
        return tuple(self._parts.relative_zero)

    # ------------------------------------------------------------------ time

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

    def be_watched(self, watch: CycleWatch | None) -> None:
        """Let somebody look at every cycle for as long as it is awake; time passes slower then."""
        self._time.watch = watch

    def _sub_program(self, number: int) -> ProgramText | None:
        for name in self.data.sub_program_names:
            if (found := name.format(number=number)) in self.programs:
                return self.programs.text(found)
        return None

    # ------------------------------------------------------------------ auxiliary functions

    def _meet(self, channel: ControlChannel, event: Event) -> bool:
        """Hand the auxiliary functions of a block to spindle and PLC; return whether the path has to wait for them."""
        if event.message:  # until the program goes on or is reset
            self.messages.show(PROGRAM_MESSAGE + channel.path, event.message[:MOST_MESSAGE_CHARACTERS])
        self._time.raised |= ControlEvent.FUNCTION
        return self.functions.meet(channel, event, self.dialect)

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
        return self._reader.channel(self._channel(channel).path)

    def snapshot(self) -> ControlSnapshot:
        """Return the whole state, to go back to with `restore`; what is durable (programs, tables, parts) is not in it.

        Raises:
            SnapshotError: A program is under way whose language cannot tell where it stands.
        """
        runs = tuple(
            None if channel.run is None else channel.run.snapshot(find=self._text)
            for channel in self.channels
        )
        moment = moment_of(self._parts, int(self._time.raised))
        return ControlSnapshot.of(self._made_from, self.machine.snapshot(), moment, runs)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this control, or of one made alike.

        Raises:
            SnapshotError: It is of something else, of programs that have been changed since, or damaged; nothing has
                changed.
        """
        if not isinstance(snapshot, ControlSnapshot):
            raise SnapshotError(
                f"this is a snapshot of {snapshot.device}, not of a control",
                hint="restore it where it was taken",
            )
        snapshot.check("control", self._made_from, ())
        moment: ControlMoment = snapshot.moment()
        runs = snapshot.runs or (None,) * len(self.channels)
        if len(runs) != len(self.channels) or len(moment.channels) != len(self.channels):
            raise SnapshotError("the snapshot of a control is damaged", hint="use another one")
        back = [channel.way_back(run, self._text) for channel, run in zip(self.channels, runs, strict=True)]
        self.machine.restore(snapshot.machine)
        self._edits.close_all()
        self._time.raised = ControlEvent(moment.raised)
        put_back(self._parts, moment, tuple(each() for each in back))
        self._time.forget()

    @property
    def _made_from(self) -> str:
        shares = tuple(channel.data for channel in self.channels)
        return described((self.machine.config, self.dialect, shares, self.data))

    def _text(self, name: str) -> ProgramText | None:
        """Return the present text of a program, of the memory or of a file."""
        return self.programs.text(name) if name in self.programs else file_text(name)

    # ------------------------------------------------------------------ within

    def _channel(self, number: int) -> ControlChannel:
        if not 0 <= number < len(self.channels):
            raise ControlError(
                Refusal.DATA, f"there is no channel {number}", hint=f"Give 0 to {len(self.channels) - 1}."
            )
        return self.channels[number]

    def _chosen(self, number: int | None) -> tuple[ControlChannel, ...]:
        """Return the channel that a command means, all of them for None."""
        return self.channels if number is None else (self._channel(number),)

    def _owner(self, axis: str) -> ControlChannel:
        """Return the channel of an axis; the first one for an axis that there is not."""
        return next((channel for channel in self.channels if axis in channel.axes), self.channels[0])

    def _lend(self, axis: str, mode: Mode) -> None:
        """Give the axes of a channel to manual motion in its mode."""
        owner = self._owner(axis)
        if owner.mode is not mode:
            raise wrong_mode(owner.mode, f"axes can be moved in {mode}", mode)
        alarms = self.alarms.of(owner.path)
        serious = [alarm for alarm in alarms if alarm.kind is not AlarmKind.TRAVEL]
        if self._parts.emergency is not Emergency.OFF or serious:
            check_ready(self._parts.emergency, alarms)
        owner.lend()
