"""Lines of G-code and jogs of a sender: checked, then fed to the program that the control executes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from polycnc.cnc import Control, ControlError, Mode, OpenProgram
from polycnc.errors import ProgramError
from polycnc.nc import Group, ModalWords
from polycnc.servers.grbl._codes import GrblAlarm, GrblError, RefusedError
from polycnc.servers.grbl._reports import MM_PER_INCH, Probed, Units
from polycnc.servers.grbl._settings import SOFT_LIMITS, GrblSettings
from polycnc.servers.grbl._state import DoorState
from polycnc.servers.grbl._words import Words, check_words, read_words

NAME = "grbl"
_JOG_GROUPS = {"units", "distance", "non-modal"}
_KEPT = (
    Group.PLANE, Group.UNITS, Group.DISTANCE, Group.FEED_MODE, Group.WORK_OFFSET, Group.MOTION,
)  # fmt: skip
_ARCS = ("G2", "G3")


class Sending:
    """Feed lines to the open program of a control, one after the other."""

    def __init__(self, control: Control, settings: GrblSettings, state: DoorState) -> None:
        self._control = control
        self._settings = settings
        self._state = state
        self._units = Units(settings)
        self._messages: list[str] = []
        self._program: OpenProgram | None = None
        self._kept: ModalWords | None = None  # in force before a jog
        self.probed = Probed((0.0,) * len(settings.names))

    def begin(self) -> None:
        """Begin as after a reset."""
        self._program = self._kept = None

    # ------------------------------------------------------------------ where it is

    @property
    def queued(self) -> int:
        """How many blocks have been taken that have not been executed."""
        return 0 if self._program is None else self._program.queued

    @property
    def rests(self) -> bool:
        """Whether all that has been taken has been executed."""
        program = self._program
        return program is None or not program.is_open or program.starved

    @property
    def zero(self) -> tuple[float, ...]:
        """Where program zero is with the executed block (machine coordinates)."""
        count = len(self._settings.names)
        modal = self._control.channel_status().modal
        if modal is not None:
            return modal.zero[:count]
        offset = self._control.offsets.get("G54", {})
        return tuple(offset.get(name, 0.0) for name in self._settings.names)

    def modal(self) -> ModalWords | None:
        """Return what is in force for the next line; None where that cannot be known."""
        if self._kept is not None:
            return self._kept
        if self._state.locked or self._control.channel_status().interrupted:
            return self._control.channel_status().modal
        with self._opened() as program:
            return program.modal_ahead()

    def take_messages(self) -> list[str]:
        """Return what lines that were executed have to tell, once."""
        messages, self._messages = self._messages, []
        return messages

    # ------------------------------------------------------------------ the program

    @contextmanager
    def _opened(self) -> Iterator[OpenProgram]:
        """Give the open program, a new one where there is none. Nothing is left of a new one that was fed nothing.

        Raises:
            RefusedError: The control executes something else.
            ControlError: It cannot begin.
        """
        if self._program is not None and self._program.is_open:
            yield self._program
            return
        control = self._control
        channel, mode = control.channel_status(), control.mode
        if channel.active or channel.interrupted:
            raise RefusedError(GrblError.NOT_IDLE)
        if mode is not Mode.MDI:
            control.select_mode(Mode.MDI)
        program, kept = control.open_program(NAME), self._kept
        try:
            yield program
            if program.lines or self._state.checking:
                self._start(program, kept)
        except RefusedError:
            if program.lines:  # what was in force before a jog
                self._start(program, kept)
            raise
        finally:
            if self._program is not program and mode is not Mode.MDI:
                control.select_mode(mode)

    def _start(self, program: OpenProgram, kept: ModalWords | None) -> None:
        try:
            self._control.cycle_start()
        except ControlError:
            self._kept = kept
            self._control.open_program(NAME)  # in place of the one whose blocks cannot be executed
            raise
        self._program = program

    def free(self) -> Iterator[None]:
        """End the open program, so that the control can do something else."""
        if self._program is not None and self._program.is_open:
            self._program.end()
        while self._control.channel_status().active:
            yield
        self._program = None

    def _restore(self, program: OpenProgram) -> None:
        """Feed what was in force before a jog."""
        if self._kept is not None:
            kept, self._kept = self._kept, None
            program.feed(self._restoring(kept, program) + "\n")

    def _restoring(self, kept: ModalWords, program: OpenProgram) -> str:
        codes = [kept.g.get(group, "G80") for group in _KEPT]
        words = " ".join("G1" if code in _ARCS else code for code in codes)
        if kept.feed > 0.0 and kept.g.get(Group.FEED_MODE) == "G94":
            words += f" F{kept.feed:.6f}"
        zero = program.modal_ahead().zero
        if zero != kept.zero:  # G92 has been lost with a reset
            at = program.position_ahead()
            unit = MM_PER_INCH if kept.inch else 1.0
            shift = [
                f"{name}{(at[n] - kept.zero[n]) / unit:.6f}" for n, name in enumerate(self._settings.names)
            ]
            words += "\nG92 " + " ".join(shift)
        return words

    # ------------------------------------------------------------------ lines

    def line(self, text: str) -> Iterator[None]:
        """Execute a line of G-code; it is over when grbl would answer.

        Raises:
            RefusedError: It is wrong; nothing has changed.
        """
        words = read_words(text)
        with self._opened() as program:
            check_words(words, self._kept or program.modal_ahead())
            self._restore(program)
            checking = self._state.checking
            if not self._fed(program.rehearse if checking else program.feed, text, words) or checking:
                return
        self._note_coolant(words)
        if words.needs_rest:
            while not self.rests:
                yield
        if words.m.get("stop") in (2, 30):
            yield from self.free()
            self._control.reset()
            self._state.coolant = frozenset()
        if words.g.get("motion") in (38.2, 38.3) and words.axes:
            self._note_probe(must_meet=words.g["motion"] == 38.2)

    def _fed(self, feed: Callable[[str], None], text: str, words: Words) -> bool:
        """Feed a line; False where it is beyond the travel, which is an alarm.

        Raises:
            RefusedError: It is wrong otherwise.
        """
        try:
            feed(text + "\n")
        except ProgramError as error:
            if error.limit is not None:
                self._state.alarm_to_say = GrblAlarm.SOFT_LIMIT
                if self._control.channel_status().active and not self.rests:
                    self._control.feed_hold()
                return False
            arc = words.g.get("motion") in (2.0, 3.0) or any(letter in words.values for letter in "IJKR")
            number = GrblError.UNSUPPORTED
            if arc:
                number = GrblError.ARC_RADIUS if "R" in words.values else GrblError.TARGET
            raise RefusedError(number, error.what) from None
        return True

    def _note_coolant(self, words: Words) -> None:
        if "coolant off" in words.m:
            self._state.coolant = frozenset()
        for group in ("mist", "flood"):
            if group in words.m:
                self._state.coolant |= {f"M{words.m[group]}"}

    def _note_probe(self, *, must_meet: bool) -> None:
        found = self._program.probed() if self._program is not None else None
        here = self._control.axes()
        at = tuple(here[name].machine for name in self._settings.names) if found is None else found
        self.probed = Probed(at[: len(self._settings.names)], found is not None)
        self._messages.append(self.probe_report)
        if must_meet and found is None:
            self._state.alarm_to_say = GrblAlarm.PROBE_NO_CONTACT

    @property
    def probe_report(self) -> str:
        """`[PRB:...]`."""
        return f"[PRB:{self._units.lengths(self.probed.position)}:{int(self.probed.met)}]"

    # ------------------------------------------------------------------ jogs

    def jog(self, text: str) -> None:
        """Begin a jog, or add one to those that go on.

        Raises:
            RefusedError: It is wrong, or would leave the travel.
        """
        words = read_words(text)
        allowed = set(words.g) <= _JOG_GROUPS and words.g.get("non-modal", 53.0) == 53.0 and not words.m
        if not allowed or not set(words.values) <= set("XYZFN"):
            raise RefusedError(GrblError.JOG)
        if not words.axes:
            raise RefusedError(GrblError.NO_AXES)
        if words.values.get("F", 0.0) <= 0.0:
            raise RefusedError(GrblError.NO_FEED)
        with self._opened() as program:
            modal = self._kept or program.modal_ahead()
            target = self._target(words, modal, program.position_ahead())
            axes = self._control.machine.config.axes
            for index, at in target.items():
                low, high = axes[index].soft_limits
                if self._settings.flag(SOFT_LIMITS) and not low - 1e-9 <= at <= high + 1e-9:
                    raise RefusedError(GrblError.TRAVEL)
            inch = words.g.get("units", 20.0 if modal.inch else 21.0) == 20.0
            feed = words.values["F"] * (MM_PER_INCH if inch else 1.0)
            points = " ".join(f"{axes[index].name}{at:.6f}" for index, at in target.items())
            program.feed(f"G53 G90 G21 G94 G1 {points} F{feed:.6f}\n")
        self._kept = modal
        self._state.jogging = True

    def _target(self, words: Words, modal: ModalWords, here: tuple[float, ...]) -> dict[int, float]:
        """Return where a jog leads, by axis (machine coordinates)."""
        inch = words.g.get("units", 20.0 if modal.inch else 21.0) == 20.0
        incremental = words.g.get("distance", 91.0 if modal.g.get(Group.DISTANCE) == "G91" else 90.0) == 91.0
        target = {}
        for index, name in enumerate(self._settings.names):
            if name in words.values:
                value = words.values[name] * (MM_PER_INCH if inch else 1.0)
                if "non-modal" in words.g:
                    target[index] = value
                else:
                    target[index] = (here[index] if incremental else modal.zero[index]) + value
        return target
