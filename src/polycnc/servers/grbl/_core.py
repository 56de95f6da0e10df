"""A control behind the interface of grbl 1.1: bytes in, bytes out, without sockets and without a clock of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from polycnc.cnc import Control, ControlError, RunState
from polycnc.errors import PolycncError
from polycnc.servers.grbl._codes import GrblAlarm, GrblError, RefusedError
from polycnc.servers.grbl._commands import Commands
from polycnc.servers.grbl._lines import LINE, Line, LineReader
from polycnc.servers.grbl._motion import Sending
from polycnc.servers.grbl._overrides import override_of
from polycnc.servers.grbl._reports import PLANNER_BLOCKS, WELCOME, StatusReport, Units
from polycnc.servers.grbl._settings import HOMING, GrblSettings
from polycnc.servers.grbl._state import DoorState

_CYCLE_START, _HOLD, _STATUS, _RESET = ord("~"), ord("!"), ord("?"), 0x18
_DOOR, _JOG_CANCEL = 0x84, 0x85


class GrblCore:
    """Answer one sender for a control.

    `receive` takes bytes as they come, `turn` is called when time has passed; both return what the sender gets. The
    same bytes at the same cycles give the same answers, however they are cut.
    """

    def __init__(self, control: Control) -> None:
        self._control = control
        self._reader = LineReader()
        self._out: list[str] = []
        self._state = DoorState()
        self.settings = GrblSettings(control)
        units = Units(self.settings)
        self._report = StatusReport(self.settings, units)
        self._sending = Sending(control, self.settings, self._state)
        self._commands = Commands(
            control,
            self.settings,
            units,
            self._state,
            self._sending,
            say=self._say,
            restart=self._restart,
            name=lambda: self.state,
        )
        self._job: Iterator[None] | None = None
        if self.settings.flag(HOMING) and not all(axis.referenced for axis in control.axes().values()):
            self._state.locked = True

    # ------------------------------------------------------------------ the sender

    def greet(self) -> bytes:
        """Return what a sender sees first."""
        self._say("", WELCOME)
        if self._locked:
            self._say("[MSG:'$H'|'$X' to unlock]")
        self._report.begin()
        return self._given()

    def receive(self, data: bytes) -> bytes:
        """Take bytes of the sender; return what it gets at once."""
        for byte in self._reader.read(data):
            if byte == LINE:
                self._go_on()
            else:
                self._real_time(byte)
        return self._given()

    def turn(self) -> bytes:
        """Go on with what waited for time to pass; return what the sender gets."""
        self._go_on()
        return self._given()

    @property
    def busy(self) -> bool:
        """Whether lines wait, or something that was begun has not ended."""
        return bool(self._reader.lines) or self._job is not None or self._state.cancels

    def _say(self, *lines: str) -> None:
        self._out += lines

    def _given(self) -> bytes:
        given = "".join(line + "\r\n" for line in self._out).encode("ascii", "replace")
        self._out.clear()
        return given

    # ------------------------------------------------------------------ lines

    def _go_on(self) -> None:
        self._watch()
        while True:
            if self._job is not None:
                if next(self._job, self) is not self:
                    return
                self._job = None
            if not self._reader.lines or self._state.sleeping or self._state.cancels or self._state.halted:
                return
            if not self._has_room():
                return
            self._begin(self._reader.take())

    def _has_room(self) -> bool:
        """Tell whether grbl would read the next line now: blocks wait while its planner is full."""
        text = self._reader.lines[0].text
        return text.startswith("$") or self._sending.queued < PLANNER_BLOCKS

    def _begin(self, line: Line) -> None:
        """Execute a line; what takes time goes on as a job."""
        try:
            if line.overflows:
                raise RefusedError(GrblError.OVERFLOW)
            if line.text.startswith("$"):
                self._job = self._answered(self._commands.execute(line.text))
                return
            if line.text:
                if self._locked or self.state == "Jog":
                    raise RefusedError(GrblError.LOCKED)
                self._job = self._answered(self._sending.line(line.text))
                return
        except RefusedError as refused:
            self._refuse(refused)
            return
        self._say("ok")

    def _answered(self, job: Iterator[None]) -> Iterator[None]:
        """Carry out a job and answer when it is done."""
        try:
            yield from job
        except RefusedError as refused:
            self._refuse(refused)
            return
        except PolycncError as error:  # of the control: something else uses it
            self._commands.abandon()
            self._refuse(RefusedError(GrblError.NOT_IDLE, error.what))
            return
        for message in self._sending.take_messages():
            self._say(message)
        if self._state.alarm_to_say is not None:
            self._alarm(self._state.alarm_to_say)
            self._state.alarm_to_say = None
            if self._state.halted:
                return
        self._say("ok")

    def _refuse(self, refused: RefusedError) -> None:
        if refused.message:
            self._say(f"[MSG:{refused.message}]")
        self._say(f"error:{int(refused.error)}")

    # ------------------------------------------------------------------ real-time commands

    def _real_time(self, byte: int) -> None:
        state, control = self._state, self._control
        match byte:
            case _ if byte == _STATUS:
                self._say(self._status())
            case _ if byte == _RESET:
                self._reset()
            case _ if byte == _HOLD and self.state in ("Run", "Jog"):
                self._tried(control.feed_hold)
                if state.jogging:
                    state.cancels = True
            case _ if byte == _CYCLE_START and not self._locked and not state.sleeping:
                state.door = False
                if control.channel_status().interrupted and not state.cancels:
                    self._tried(control.cycle_start)
            case _ if byte == _DOOR and not state.sleeping and not self._locked:
                state.door = True
                if control.channel_status().active:
                    self._tried(control.feed_hold)
                state.cancels |= state.jogging
            case _ if byte == _JOG_CANCEL and state.jogging:
                self._tried(control.feed_hold)
                state.cancels = True
            case _:
                self._override(byte)

    def _override(self, byte: int) -> None:
        given = override_of(byte, self._control.channel_status().overrides).get
        self._tried(
            lambda: self._control.set_overrides(
                feed=given("feed"), rapid=given("rapid"), spindle=given("spindle")
            )
        )

    def _tried(self, command: Callable[[], object]) -> None:
        """Carry out a command that has no answer."""
        try:
            command()
        except ControlError as error:
            self._say(f"[MSG:{error.what}]")

    def _reset(self) -> None:
        state = self.state
        moving = state in ("Run", "Jog", "Home", "Hold:1", "Door:2")
        self._control.reset()
        self._reader.clear()
        if self._job is not None:
            self._commands.abandon()
            self._job = None
        locked = self._state.locked or self._state.halted
        self._state.begin_again()
        self._state.locked = locked
        if moving:
            self._alarm(GrblAlarm.HOMING_RESET if state == "Home" else GrblAlarm.ABORTED)
            self._state.halted = False
        self._restart()

    def _restart(self) -> None:
        """Begin anew, as after a soft reset."""
        self._sending.begin()
        self._tried(lambda: self._control.set_overrides(feed=1.0, rapid=1.0, spindle=1.0))
        self._out += self.greet().decode("ascii").splitlines()

    # ------------------------------------------------------------------ what happens by itself

    def _watch(self) -> None:
        """See what time has brought: alarms of the control, the end of jogs, a cancelled jog at rest."""
        control, state = self._control, self._state
        alarms = control.alarms.active
        if alarms and not state.seen:
            self._say(f"[MSG:{alarms[0].text}]")
            self._alarm(GrblAlarm.ABORTED if "emergency" in alarms[0].name else GrblAlarm.HARD_LIMIT)
            self._commands.abandon()
            self._job = None
        state.seen = bool(alarms)
        channel = control.channel_status()
        if state.cancels and channel.run_state is not RunState.ACTIVE and control.channels[0].at_rest:
            control.reset()
            state.cancels = state.jogging = False
        if state.jogging and self._sending.rests and not self._reader.lines and self._job is None:
            state.jogging = False

    def _alarm(self, alarm: GrblAlarm) -> None:
        self._state.locked = True
        self._say(f"ALARM:{int(alarm)}")
        if alarm in (GrblAlarm.HARD_LIMIT, GrblAlarm.SOFT_LIMIT):
            self._state.halted = True
            self._say("[MSG:Reset to continue]")

    @property
    def _locked(self) -> bool:
        return self._state.locked

    @property
    def state(self) -> str:
        """The state that a status report names."""
        state = self._state
        if state.sleeping:
            return "Sleep"
        if state.locked:
            return "Alarm"
        if state.homing:
            return "Home"
        channel = self._control.channel_status()
        braking = not self._control.channels[0].at_rest
        if state.door:
            return "Door:2" if braking else "Door:0"
        if state.checking:
            return "Check"
        if channel.interrupted and not state.cancels:
            return "Hold:1" if braking else "Hold:0"
        if state.jogging and not self._sending.rests:
            return "Jog"
        return "Run" if braking or (channel.active and not channel.starved) else "Idle"

    def _status(self) -> str:
        spindle = self._control.spindle.state()
        accessories = {1: "S", -1: "C"}.get(spindle.direction, "")
        accessories += "".join(
            {"M7": "M", "M8": "F"}[code] for code in sorted(self._state.coolant, reverse=True)
        )
        return self._report.text(
            self.state,
            self._control.status(),
            self._sending.zero,
            self._reader.free,
            self._sending.queued,
            accessories,
            "",
        )
