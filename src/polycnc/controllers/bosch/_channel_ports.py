"""What the shared part of a control asks of its channels and its machine: of attached runs, or of a device."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from polycnc.cnc import Control, Mode, ProgramRun, RunState
from polycnc.controllers.bosch.ncs import Mode as BoschMode
from polycnc.machine import Machine

MODES = {
    BoschMode.JOG: Mode.JOG, BoschMode.REFERENCE: Mode.REF, BoschMode.MDI: Mode.MDI, BoschMode.AUTOMATIC: Mode.AUTO,
    BoschMode.PROGRAM_BLOCK: Mode.AUTO, BoschMode.SINGLE_STEP: Mode.AUTO, BoschMode.SINGLE_BLOCK: Mode.AUTO,
    BoschMode.DEBUG_BLOCK: Mode.AUTO, BoschMode.DEBUG_AUTOMATIC: Mode.AUTO,
}  # fmt: skip
"""Modes that can be selected, and what they are for the control within."""

_SHOWN = {
    Mode.AUTO: BoschMode.AUTOMATIC,
    Mode.MDI: BoschMode.MDI,
    Mode.JOG: BoschMode.JOG,
    Mode.REF: BoschMode.REFERENCE,
}


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

    def selected(self, number: int) -> str:
        """Return the program that a start would begin."""

    def referenced(self) -> frozenset[str]:
        """Return the axes that have been referenced."""

    def spindle(self) -> tuple[float, float | None]:
        """Return the override of the spindle and its actual speed (rpm), None where it is the programmed one."""


class AttachedRuns:
    """Runs that somebody else advances, each in automatic on a machine whose axes are all referenced."""

    def __init__(self, axis_names: Sequence[str]) -> None:
        self._axis_names = frozenset(axis_names)
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

    def selected(self, number: int) -> str:
        """Return no program: one is being executed."""
        return ""

    def referenced(self) -> frozenset[str]:
        """Return all axes."""
        return self._axis_names

    def spindle(self) -> tuple[float, float | None]:
        """Return 100 %, and no speed of its own."""
        return 1.0, None


class DeviceChannels:
    """The channels of a control that is a device, with the modes that its operator has selected."""

    def __init__(self, control: Control) -> None:
        self._control = control
        self._modes: dict[int, BoschMode] = {}

    @property
    def machine(self) -> Machine:
        """The machine of the control."""
        return self._control.machine

    def attach(self, number: int, run: ProgramRun) -> None:
        """Do nothing: the control has its runs."""

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

    def selected(self, number: int) -> str:
        """Return the program that a start would begin; one that has ended has to be selected again."""
        channel = self._control.channels[number - 1]
        if channel.program is None or (
            channel.run_state is RunState.COMPLETED
            and channel.run is not None
            and channel.run.program is channel.program
        ):
            return ""
        return channel.program.name

    def referenced(self) -> frozenset[str]:
        """Return the axes that have been referenced."""
        return frozenset(name for name, done in self._control.manual.referenced.items() if done)

    def spindle(self) -> tuple[float, float | None]:
        """Return the override of the spindle and its actual speed (rpm)."""
        now = self._control.spindle.state()
        return now.override, abs(now.actual_rpm)
