"""The $ commands of a sender, by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from polycnc.cnc import Control, Mode
from polycnc.errors import PolycncError
from polycnc.nc import ModalWords
from polycnc.servers.grbl._codes import GrblAlarm, GrblError, RefusedError
from polycnc.servers.grbl._lines import RX_BYTES
from polycnc.servers.grbl._motion import Sending
from polycnc.servers.grbl._reports import HELP, PLANNER_BLOCKS, SYSTEMS, VERSION, Units, modal_report
from polycnc.servers.grbl._settings import HOMING, GrblSettings
from polycnc.servers.grbl._state import DoorState
from polycnc.servers.grbl._words import read_words

_STARTUP = "grbl.startup"
_STARTUP_LINES = 2
_WRITE = re.compile(r"\$([0-9]{1,3})=([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")
_STARTUP_LINE = re.compile(r"\$N([0-9])=(.*)")
_AT_REST = frozenset({"Idle", "Alarm"})
_DEFAULT_MODAL = "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"
_HOMING_ORDER = "ZXY"


class Commands:
    """Execute $ commands; `say` sends lines, `restart` begins anew as a soft reset does."""

    def __init__(
        self,
        control: Control,
        settings: GrblSettings,
        units: Units,
        state: DoorState,
        sending: Sending,
        *,
        say: Callable[..., None],
        restart: Callable[[], None],
        name: Callable[[], str],
    ) -> None:
        self._control = control
        self._settings = settings
        self._units = units
        self._state = state
        self._sending = sending
        self._say = say
        self._restart = restart
        self._name = name
        self._startup = control.machine.memory.area(_STARTUP, str)
        kept = {int(number): str(line) for number, line in self._startup.load().items()}
        self._lines = [kept.get(number, "") for number in range(_STARTUP_LINES)]
        self._table: dict[str, tuple[Callable[[], Iterator[None] | None], bool]] = {
            "$": (self._help, False),
            "$$": (self._all_settings, True),
            "$G": (self._modal, False),
            "$#": (self._parameters, True),
            "$I": (self._build, True),
            "$N": (self._startup_lines, True),
            "$C": (self._check_mode, False),
            "$X": (self._unlock, False),
            "$H": (self._home, True),
            "$SLP": (self._sleep, True),
            "$RST=$": (self._restore_settings, True),
            "$RST=#": (self._restore_offsets, True),
            "$RST=*": (self._restore_all, True),
        }

    def execute(self, text: str) -> Iterator[None]:
        """Execute a command; it is over when grbl would answer.

        Raises:
            RefusedError: It is none, or cannot be executed now.
        """
        if text.startswith("$J"):
            return self._jog(text)
        if text in self._table:
            command, at_rest = self._table[text]
            if at_rest:
                self._need_rest()
            return command() or iter(())
        if found := _WRITE.fullmatch(text):
            self._need_rest()
            return self._write(int(found[1]), float(found[2]))
        if found := _STARTUP_LINE.fullmatch(text):
            self._need_rest()
            return self._write_startup(int(found[1]), found[2])
        raise RefusedError(GrblError.STATEMENT)

    def abandon(self) -> None:
        """Forget a command that a reset or an alarm has ended."""
        self._state.homing = False

    def _need_rest(self) -> None:
        if self._name() not in _AT_REST:
            raise RefusedError(GrblError.NOT_IDLE)

    # ------------------------------------------------------------------ reports

    def _help(self) -> None:
        self._say(HELP)

    def _all_settings(self) -> None:
        for row in self._settings.rows:
            self._say(f"${row.number}={row.shown(self._settings[row.number])}")

    def _modal(self) -> None:
        modal: ModalWords | None = self._sending.modal()
        self._say(_DEFAULT_MODAL if modal is None else modal_report(modal, self._state.coolant, self._units))

    def _parameters(self) -> None:
        names, lengths = self._settings.names, self._units.lengths
        axes = self._control.machine.config.axes
        for name in SYSTEMS:
            offset = self._control.offsets.get(name, {})
            self._say(f"[{name}:{lengths(offset.get(axis, 0.0) for axis in names)}]")
        self._say(f"[G28:{lengths(axes[n].reference_position(1) for n in range(len(names)))}]")
        second = [axis.reference_positions[0] if axis.reference_positions else 0.0 for axis in axes]
        self._say(f"[G30:{lengths(second[: len(names)])}]")
        modal = self._sending.modal()
        shift = [0.0] * len(names)
        if modal is not None:
            table = self._control.offsets.get(modal.work[0] if modal.work else "G54", {})
            shift = [modal.zero[n] - table.get(axis, 0.0) for n, axis in enumerate(names)]
        self._say(f"[G92:{lengths(shift)}]", f"[TLO:{lengths([0.0])}]", self._sending.probe_report)

    def _build(self) -> None:
        self._say(f"[VER:{VERSION}.polycnc:{self._control.machine.config.name}]")
        self._say(f"[OPT:VM,{PLANNER_BLOCKS},{RX_BYTES}]")

    def _startup_lines(self) -> None:
        for number, line in enumerate(self._lines):
            self._say(f"$N{number}={line}")

    # ------------------------------------------------------------------ states

    def _check_mode(self) -> None:
        if self._state.checking:
            self._state.checking = False
            self._say("[MSG:Disabled]")
            self._control.reset()
            self._restart()
            return
        if self._name() != "Idle":
            raise RefusedError(GrblError.NOT_IDLE)
        self._state.checking = True
        self._say("[MSG:Enabled]")

    def _unlock(self) -> None:
        if not self._state.locked:
            return
        self._control.reset()
        if self._control.alarms.active:
            raise RefusedError(GrblError.LOCKED, self._control.alarms.active[0].text)
        self._state.locked = False
        self._say("[MSG:Caution: Unlocked]")

    def _sleep(self) -> None:
        self._say("[MSG:Sleeping]")
        self._state.sleeping = True

    def _home(self) -> Iterator[None]:
        if not self._settings.flag(HOMING):
            raise RefusedError(GrblError.NO_HOMING)
        return self._homing()

    def _homing(self) -> Iterator[None]:
        control = self._control
        control.reset()
        if control.alarms.active:
            raise RefusedError(GrblError.LOCKED, control.alarms.active[0].text)
        self._state.locked, self._state.homing = False, True
        while not control.channels[0].at_rest:
            yield
        self._sending.begin()
        control.select_mode(Mode.REF)
        for name in sorted(self._settings.names, key=_HOMING_ORDER.find):
            control.reference(name)
            while control.manual.moves((name,)):
                yield
            if not control.axes()[name].referenced:
                self._state.alarm_to_say = GrblAlarm.HOMING_FAILED
                break
        self._state.homing = False
        control.select_mode(Mode.MDI)

    def _jog(self, text: str) -> Iterator[None]:
        if self._name() not in ("Idle", "Jog"):
            raise RefusedError(GrblError.NOT_IDLE)
        if not text.startswith("$J="):
            raise RefusedError(GrblError.JOG)
        self._sending.jog(text.removeprefix("$J="))
        yield from ()

    # ------------------------------------------------------------------ what is written

    def _write(self, number: int, value: float) -> Iterator[None]:
        self._settings.check(number, value)
        if self._settings.changes_axes(number) or number == HOMING:
            yield from self._sending.free()
        try:
            self._settings.write(number, value)
        except PolycncError as error:
            raise RefusedError(GrblError.NUMBER, error.what) from None

    def _write_startup(self, number: int, line: str) -> Iterator[None]:
        if number >= _STARTUP_LINES:
            raise RefusedError(GrblError.STATEMENT)
        read_words(line)
        self._startup[number] = line
        self._lines[number] = line
        yield from ()

    def _restore_settings(self) -> Iterator[None]:
        yield from self._sending.free()
        self._settings.restore_defaults()
        self._say("[MSG:Restoring defaults]")

    def _restore_offsets(self) -> None:
        names = self._settings.names
        for system in SYSTEMS:
            self._control.offsets.set(system, dict.fromkeys(names, 0.0))
        self._say("[MSG:Restoring defaults]")

    def _restore_all(self) -> Iterator[None]:
        for number in range(_STARTUP_LINES):
            self._startup[number] = self._lines[number] = ""
        self._restore_offsets()
        yield from self._sending.free()
        self._settings.restore_defaults()
