"""Commands about programs: select, search, start, hold, reset, and what breaks them off."""

from __future__ import annotations

from polycnc.cnc._alarms import Alarm
from polycnc.cnc._control_checks import (
    check_hands_off,
    check_over,
    check_ready,
    check_referenced,
    text_to_begin,
    wrong_mode,
)
from polycnc.cnc._control_data import Mode, Search
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._control_time import ControlEvent, ControlTime
from polycnc.cnc._open_program import OpenProgram
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._status import Emergency
from polycnc.cnc._stopping import PROGRAM_MESSAGE, break_off, stop_for
from polycnc.cnc._stops import Step
from polycnc.errors import shown
from polycnc.nc import ROOM_BYTES, IncomingText, ProgramText

_PROGRAM_MODES = frozenset({Mode.AUTO, Mode.MDI})
_MDI_NAME = "MDI"
_OPEN_NAME = "OPEN"


class ProgramCommands:
    """Carry out the commands about programs; `time` notes what they begin and end."""

    def __init__(self, of: ControlParts, time: ControlTime) -> None:
        self._of = of
        self._time = time

    def select_program(self, program: str | ProgramText, *, channel: int = 0) -> None:
        """Select what a start in AUTO executes: a program of the memory, or a text of the outside.

        Raises:
            ControlError: There is no such program or channel, or the channel executes one.
        """
        chosen = self._of.channel(channel)
        check_over(chosen)
        text = self._of.programs.text(program) if isinstance(program, str) else program
        chosen.select(text)

    def set_mdi(self, text: str, *, channel: int = 0) -> None:
        """Put in the text that a start in MDI executes.

        Raises:
            ControlError: Not in MDI, no text, no such channel, or the channel executes a program.
        """
        chosen = self._of.channel(channel)
        if chosen.mode is not Mode.MDI:
            raise wrong_mode(chosen.mode, "a text can be put in", Mode.MDI)
        check_over(chosen)
        if not text.strip():
            raise ControlError(Refusal.DATA, "there is nothing to execute", hint="Write a block.")
        chosen.mdi = ProgramText.from_text(text, _MDI_NAME)

    def open_program(self, name: str = "", *, room_bytes: int = ROOM_BYTES, channel: int = 0) -> OpenProgram:
        """Open a program that comes while it is executed; return what feeds it.

        In AUTO it is selected, in MDI it takes the place of the MDI text; the next start begins it.

        Raises:
            ControlError: Neither in AUTO nor in MDI, a program of the memory has the name, no such channel, the channel
                executes a program, or its axes are still braking.
        """
        chosen = self._of.channel(channel)
        if chosen.mode not in _PROGRAM_MODES:
            raise wrong_mode(chosen.mode, "a program can be opened", *sorted(_PROGRAM_MODES))
        check_over(chosen)
        is_mdi = chosen.mode is Mode.MDI
        name = name or (_MDI_NAME if is_mdi else _OPEN_NAME)
        if name in self._of.programs:
            raise ControlError(
                Refusal.EXISTS, f"there is a program {name} in the memory", hint="Choose another name."
            )
        if room_bytes < 1:
            raise ControlError(
                Refusal.DATA, f"a room of {shown(room_bytes)} bytes takes nothing", hint="Give 1 or more."
            )
        text = IncomingText(name, room_bytes)
        chosen.check_rest()
        chosen.load(text, mdi=is_mdi)
        if is_mdi:
            chosen.mdi = text
        else:
            chosen.select(text)
        self._of.clock.changes += 1
        return OpenProgram(chosen, text, self._of.clock)

    def search(
        self,
        *,
        line: int = 0,
        sequence: int | None = None,
        calculate: bool = False,
        last: int = 0,
        channel: int = 0,
    ) -> int:
        """Let the next start begin the selected program at a block; return its line.

        It is the block on `line`, or the first one with a sequence number. With `calculate` everything before is
        carried out without moving, and with the start the axes go straight at rapid to where that block begins; else
        modal state and position are what they are. With `last` the program ends after the block on
        that line. A reset, another selection and the start itself end the search.

        Raises:
            ControlError: Not in AUTO, nothing is selected, there is no such block, the program cannot begin there, or
                something is being executed or moves.
        """
        chosen = self._of.channel(channel)
        if chosen.mode is not Mode.AUTO:
            raise wrong_mode(chosen.mode, "a block can be searched", Mode.AUTO)
        check_over(chosen)
        check_hands_off(chosen, self._of.manual)
        check_ready(self._of.emergency, self._of.alarms.of(channel))
        text = text_to_begin(chosen, self._of.programs, is_mdi=False)
        if isinstance(text, IncomingText):
            raise ControlError(
                Refusal.NOT_FOUND, f"{text.name} is still coming", hint="Search a program of the memory."
            )
        return chosen.seek(text, Search(line, sequence, calculate, last))

    def cycle_start(self, *, channel: int = 0, step: Step = Step.RUN, line: int = 1) -> None:
        """Begin the selected program or the MDI text, or go on where a program is interrupted.

        `step` says how far. It begins at `line`; with 1, at the block that was searched.

        Raises:
            ControlError: The emergency stop or an alarm is on, the mode has no programs, nothing is selected, axes
                move or are not referenced, a program is being executed, or an interrupted one is to begin at a line.
        """
        chosen = self._of.channel(channel)
        check_ready(self._of.emergency, self._of.alarms.of(channel))
        if chosen.mode not in _PROGRAM_MODES:
            raise wrong_mode(chosen.mode, "a program can start", *sorted(_PROGRAM_MODES))
        if chosen.active:
            raise ControlError(
                Refusal.RUNNING, "a program is being executed", hint="Hold it, or wait for its end."
            )
        check_hands_off(chosen, self._of.manual)
        is_mdi = chosen.mode is Mode.MDI
        if chosen.interrupted:
            if chosen.is_mdi is not is_mdi:
                raise ControlError(
                    Refusal.MODE,
                    f"the program that is interrupted was started in {Mode.MDI if chosen.is_mdi else Mode.AUTO}",
                    hint="Go on in that mode, or reset it.",
                )
            if line != 1:
                raise ControlError(
                    Refusal.RUNNING,
                    f"a program is interrupted, it cannot begin at line {line}",
                    hint="Reset it first, or let it go on without a line.",
                )
            chosen.go_on(self._of.data.after_manual, step)
            self._of.messages.withdraw(PROGRAM_MESSAGE + chosen.path)
        else:
            text = text_to_begin(chosen, self._of.programs, is_mdi=is_mdi)
            if self._of.data.reference_required:
                check_referenced(chosen, self._of.manual)
            if not 1 <= line <= text.content.count(b"\n") + 1:
                raise ControlError(Refusal.NOT_FOUND, f"there is no line {line}", hint="Use an existing one.")
            search = Search(line) if line > 1 else None if is_mdi else chosen.search
            chosen.begin(text, mdi=is_mdi, step=step, search=search)
            self._of.timers.start_cycle()
        self._time.note_start(chosen)

    def feed_hold(self, *, channel: int | None = None) -> None:
        """Brake the axes of executed programs (None: of all channels) and let them stand; manual motion ends.

        Raises:
            ControlError: Nothing moves or is being executed.
        """
        chosen = self._of.channels if channel is None else (self._of.channel(channel),)
        running = [each for each in chosen if each.active]
        axes = [axis for each in chosen for axis in each.axes]
        if not running and not self._of.manual.moves(axes):
            raise ControlError(Refusal.IDLE, "nothing is being executed", hint="There is nothing to hold.")
        for each in running:
            each.hold()
        self._of.manual.stop_all(axes)
        self._time.raised |= ControlEvent.RUN_STATE

    def reset(self, *, channel: int | None = None) -> None:
        """Break off everything, and take away the alarms whose causes are gone; the axes brake.

        The reset of one channel takes away its own alarms; those of the whole control, and what an emergency stop
        leaves behind, need a reset of all.
        """
        chosen = self._of.chosen(channel)
        break_off(self._of, chosen)
        if self._of.data.reset_stops_spindle and any(each.data.spindle for each in chosen):
            self._of.spindle.stop()
        if self._of.emergency is Emergency.RESET_NEEDED and channel is None:
            self._of.emergency = Emergency.OFF
        self._of.alarms.reset(channel)
        names = self._of.machine.config.axis_names
        for axis in (axis for each in chosen for axis in each.axes):
            self._of.machine.state.servo.error_tripped[names.index(axis)] = 0
        self._of.manual.check_limit_switches()
        self._time.raised |= ControlEvent.RUN_STATE

    def emergency_stop(self, on: bool = True) -> None:
        """Press or release the emergency stop: everything brakes and is broken off; the spindle stops."""
        if on and self._of.emergency is not Emergency.ON:
            self._of.emergency = Emergency.ON
            self._of.alarms.put("emergency_stop")
            self._time.raised |= ControlEvent.ALARM
            break_off(self._of, self._of.channels)
            self._of.spindle.stop()
        elif not on and self._of.emergency is Emergency.ON:
            self._of.alarms.cause_gone("emergency_stop")
            self._of.clock.changes += 1
            needed = self._of.data.emergency_needs_reset
            self._of.emergency = Emergency.RESET_NEEDED if needed else Emergency.OFF

    def put_alarm(self, name: str, *, axis: str | None = None, detail: str = "") -> Alarm:
        """Put an alarm on from outside: everything brakes, and only a reset helps; one that is on stays as it is.

        With an axis it is an alarm of the channel that the axis belongs to.

        Raises:
            ControlError: There is no such alarm or axis.
        """
        if axis is not None and axis not in (names := self._of.machine.config.axis_names):
            raise ControlError(
                Refusal.DATA, f"there is no axis {shown(axis)}", hint=f"The axes are {', '.join(names)}."
            )
        if self._of.alarms.has(name, axis):
            return self._of.alarms.put(name, axis=axis)
        alarm = self._of.alarms.put(name, axis=axis, detail=detail)
        stop_for(self._of, (alarm,))
        self._time.raised |= ControlEvent.ALARM
        return alarm
