"""What the shared part of a control asks of its channels and its machine: of attached runs, or of a device."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

from polycnc.cnc import Alarm, AxisStatus, Control, Emergency, Mode, Overrides, ProgramRun, RunState, Switches
from polycnc.controllers.bosch.ncs import Mode as BoschMode
from polycnc.kernel import PIDF
from polycnc.machine import Machine

MODES = {
    BoschMode.JOG: Mode.JOG, BoschMode.REFERENCE: Mode.REF, BoschMode.MDI: Mode.MDI, BoschMode.AUTOMATIC: Mode.AUTO,
    BoschMode.PROGRAM_BLOCK: Mode.AUTO, BoschMode.SINGLE_STEP: Mode.AUTO, BoschMode.SINGLE_BLOCK: Mode.AUTO,
    BoschMode.DEBUG_BLOCK: Mode.AUTO, BoschMode.DEBUG_AUTOMATIC: Mode.AUTO,
}  # fmt: skip
"""Modes that can be selected, and what they are for the control within."""

CUTTING = ("G96", "G196")
"""What makes S a cutting speed."""

_SHOWN = {
    Mode.AUTO: BoschMode.AUTOMATIC,
    Mode.MDI: BoschMode.MDI,
    Mode.JOG: BoschMode.JOG,
    Mode.INC: BoschMode.JOG,
    Mode.HANDLE: BoschMode.JOG,
    Mode.REF: BoschMode.REFERENCE,
}


class Selected(NamedTuple):
    """What a start would begin: the name of a program, or "" for blocks put in by hand.

    `searched` tells that it begins, or ends, at a block that was searched.
    """

    program: str
    searched: bool = False


class SpindleNow(NamedTuple):
    """The spindle; `actual_rpm` is None where there is none but in programs, which alone know the rest then."""

    override: float
    actual_rpm: float | None = None
    programmed_rpm: float = 0.0
    direction: int = 0
    oriented: bool = False


class ChannelPorts(Protocol):
    """Channels count from 1."""

    @property
    def machine(self) -> Machine:
        """The machine."""

    def attach(self, number: int, run: ProgramRun) -> None:
        """Take the run of a channel."""

    def run(self, number: int) -> ProgramRun | None:
        """Return the run of a channel."""

    def mode(self, number: int) -> BoschMode:
        """Return the mode of a channel."""

    def selected(self, number: int) -> Selected | None:
        """Return what a start would begin, None if nothing is selected."""

    def missing(self, number: int) -> str:
        """Return the program that was selected and does not exist, "" if there is none."""

    def reselects(self) -> bool:
        """Tell whether a program that has ended is selected again."""

    def functions_wait(self, number: int) -> bool:
        """Tell whether an auxiliary function waits for its acknowledgement."""

    def is_by_hand(self, number: int) -> bool:
        """Tell whether what is executed are blocks put in by hand."""

    def axes(self) -> Mapping[str, AxisStatus]:
        """Return the axes of the machine in the present cycle."""

    def overrides(self, number: int) -> Overrides:
        """Return the overrides of a channel."""

    def switches(self, number: int) -> Switches:
        """Return what the operator has switched on for the programs of a channel."""

    def needs_reset(self, number: int) -> bool:
        """Tell whether an alarm or the emergency stop lets a channel do nothing until it is reset."""

    def alarms(self) -> tuple[Alarm, ...]:
        """Return the alarms that are on beside the errors of runs."""

    def spindle(self) -> SpindleNow:
        """Return the spindle in the present cycle."""


class AttachedRuns:
    """Runs that somebody else advances, each in automatic on a machine whose axes are all referenced."""

    def __init__(self) -> None:
        self._runs: dict[int, ProgramRun] = {}

    @property
    def machine(self) -> Machine:
        """The machine of the run that was attached last."""
        assert self._runs, "attach a run first"
        return next(reversed(self._runs.values())).machine

    def attach(self, number: int, run: ProgramRun) -> None:
        """Take the run of a channel."""
        self._runs.pop(number, None)
        self._runs[number] = run

    def run(self, number: int) -> ProgramRun | None:
        """Return the run of a channel."""
        return self._runs.get(number)

    def mode(self, number: int) -> BoschMode:
        """Return automatic."""
        return BoschMode.AUTOMATIC

    def selected(self, number: int) -> Selected | None:
        """Return nothing: a program is being executed."""
        return None

    def missing(self, number: int) -> str:
        """Return none."""
        return ""

    def reselects(self) -> bool:
        """Return False."""
        return False

    def functions_wait(self, number: int) -> bool:
        """Return False: nobody acknowledges functions."""
        return False

    def is_by_hand(self, number: int) -> bool:
        """Return False: it is a program."""
        return False

    def axes(self) -> Mapping[str, AxisStatus]:
        """Return the axes; all are referenced, and nobody moves them by hand."""
        return {axis.name: _axis(self.machine, place) for place, axis in enumerate(self.machine.config.axes)}

    def overrides(self, number: int) -> Overrides:
        """Return 100 % before a run is attached, else those of the run."""
        run = self._runs.get(number)
        return Overrides() if run is None else Overrides(run.overrides.feed, run.overrides.rapid)

    def switches(self, number: int) -> Switches:
        """Return what is switched on in the run."""
        run = self._runs.get(number)
        if run is None:
            return Switches()
        on = run.switches
        return Switches(
            on.single_block, on.optional_stop, machine_lock=on.machine_lock, block_delete=on.block_delete
        )

    def needs_reset(self, number: int) -> bool:
        """Return False: the run itself is in alarm then."""
        return False

    def alarms(self) -> tuple[Alarm, ...]:
        """Return none: runs have their own."""
        return ()

    def spindle(self) -> SpindleNow:
        """Return 100 %, and no speed of its own."""
        return SpindleNow(1.0)


def _axis(machine: Machine, place: int) -> AxisStatus:
    """Return an axis that a program moves; without a servo it is where it should be."""
    axis, state = machine.config.axes[place], machine.state
    setpoint, velocity = float(state.setpoint[place]), float(state.velocity[place])
    at = float(state.servo.actual[place]) if state.servo.row[place]["mode"] == PIDF else setpoint
    return AxisStatus(
        axis.name, axis.unit, at, at, at, 0.0, setpoint, at, setpoint - at, velocity, True, velocity != 0.0, "none",
        0.0, axis.vmax,
    )  # fmt: skip


class DeviceChannels:
    """The channels of a control that is a device, with the modes that its operator has selected."""

    def __init__(self, control: Control, *, reselects: bool = False) -> None:
        self._control = control
        self._reselects = reselects
        self._modes: dict[int, BoschMode] = {}
        self._missing: dict[int, str] = {}

    @property
    def machine(self) -> Machine:
        """The machine of the control."""
        return self._control.machine

    def attach(self, number: int, run: ProgramRun) -> None:
        """Do nothing: the control has its runs."""

    def save(self) -> tuple[dict[str, int], dict[str, str]]:
        """Return modes and missing programs as plain data."""
        modes = {str(number): int(mode) for number, mode in self._modes.items()}
        return modes, {str(number): name for number, name in self._missing.items()}

    def restore(self, modes: dict[int, BoschMode], missing: dict[int, str]) -> None:
        """Go back to modes and missing programs."""
        self._modes = modes
        self._missing = missing

    def select_mode(self, numbers: Sequence[int], mode: BoschMode) -> None:
        """Note the mode that was selected: several are one for the control within."""
        self._modes.update(dict.fromkeys(numbers, mode))

    def run(self, number: int) -> ProgramRun | None:
        """Return the run of a channel."""
        return self._control.channels[number - 1].run

    def mode(self, number: int) -> BoschMode:
        """Return the mode of a channel as it was selected, or the one that it has come to."""
        mode = self._control.channels[number - 1].mode
        kept = self._modes.get(number)
        return kept if kept is not None and MODES[kept] is mode else _SHOWN.get(mode, BoschMode.NONE)

    def selected(self, number: int) -> Selected | None:
        """Return what a start would begin; what has ended has to be selected again."""
        channel = self._control.channels[number - 1]
        text = channel.mdi if channel.mode is Mode.MDI else channel.program
        run = channel.run
        ended = channel.run_state is RunState.COMPLETED and run is not None and run.program is text
        if text is None or (ended and not (self._reselects and channel.mode is not Mode.MDI)):
            return None
        return Selected("" if channel.mode is Mode.MDI else text.name, channel.search is not None)

    def leave(self, number: int, *, again: bool) -> None:
        """Have nothing selected, or with `again` the program from its beginning."""
        channel = self._control.channels[number - 1]
        channel.mdi = None
        channel.select(channel.program if again else None)
        self._missing.pop(number, None)

    def miss(self, number: int, name: str) -> None:
        """Take note that a program was selected that does not exist."""
        self.leave(number, again=False)
        self._missing[number] = name

    def found(self, number: int) -> None:
        """Take note that something else was selected, or the channel was reset."""
        self._missing.pop(number, None)

    def missing(self, number: int) -> str:
        """Return the program that was selected and does not exist, "" if there is none."""
        return self._missing.get(number, "")

    def reselects(self) -> bool:
        """Tell whether a program that has ended is selected again."""
        return self._reselects

    def functions_wait(self, number: int) -> bool:
        """Tell whether an auxiliary function waits for its acknowledgement."""
        return bool(self._control.waiting_functions(number - 1))

    def is_by_hand(self, number: int) -> bool:
        """Tell whether what is executed are blocks put in by hand."""
        return self._control.channels[number - 1].is_mdi

    def axes(self) -> Mapping[str, AxisStatus]:
        """Return the axes of the control's status."""
        return self._control.axes()

    def overrides(self, number: int) -> Overrides:
        """Return the overrides of a channel."""
        return self._control.channels[number - 1].overrides

    def switches(self, number: int) -> Switches:
        """Return what the operator has switched on for the programs of a channel."""
        return self._control.channels[number - 1].switches

    def needs_reset(self, number: int) -> bool:
        """Tell whether an alarm or the emergency stop lets a channel do nothing until it is reset."""
        return self._control.channels[number - 1].broken or self._control.emergency is not Emergency.OFF

    def alarms(self) -> tuple[Alarm, ...]:
        """Return the alarms that are on."""
        return self._control.alarms.active

    def spindle(self) -> SpindleNow:
        """Return the spindle in the present cycle."""
        spindle = self._control.spindle
        now = spindle.state()
        return SpindleNow(
            now.override, abs(now.actual_rpm), now.programmed_rpm, now.direction, spindle.is_orienting
        )
