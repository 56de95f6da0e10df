"""Positions of axes and coordinates as programs read them (Manual 003, 4.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from polycnc.cnc import ProgramRun
from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.kernel import PIDF
from polycnc.nc import ModalWords
from polycnc.nc.cpl import OMITTED, Fault

Floats = npt.NDArray[np.float64]
Runs = Callable[[int], ProgramRun | None]


class Positions:
    """What AXO, CPOS, WPOS, MPOS, SPOS, APOS, PPOS, PROBE and CPROBE read in a program of channel `number`.

    WPOS, MPOS, SPOS and APOS tell where the axes are now, AXO and CPOS what the last prepared block says. Lengths are
    mm or inch as the channel has it, of asynchronous axes always mm; angles are degrees.
    """

    def __init__(self, axes: SystemAxes, number: int, runs: Runs) -> None:
        self._axes = axes
        self._number = number
        self._runs = runs
        self.functions: Mapping[str, Callable[..., object]] = {
            "AXO": self._axo, "CPOS": self._cpos, "WPOS": self._wpos, "MPOS": self._mpos, "SPOS": self._spos,
            "APOS": self._apos, "PPOS": self._ppos, "PROBE": self._probe, "CPROBE": self._cprobe,
        }  # fmt: skip

    @property
    def _run(self) -> ProgramRun:
        run = self._runs(self._number)
        assert run is not None, "attach the run first"
        return run

    # ------------------------------------------------------------------ of the last prepared block

    def _axo(self, axis: object, kind: object = OMITTED) -> float:
        index, physical = self._own(axis, kind)
        return float(self._run.channel.state.coordinates.shift[index]) / self._scale(physical)

    def _cpos(self, axis: object, kind: object = OMITTED) -> float:
        index, physical = self._own(axis, kind)
        modal = self._run.channel.state.modal
        return self._programmed(modal.position)[index] / self._scale(physical)

    def _programmed(self, machine: Floats) -> list[float]:
        """Return the program coordinates of a machine position."""
        state = self._run.channel.state
        return state.frame.back((machine - state.modal.offset).tolist())

    # ------------------------------------------------------------------ of now

    def _mpos(self, axis: object, kind: object = OMITTED, channel: object = OMITTED) -> float:
        physical = self._axes.axis(self._number, axis, kind, channel)
        return float(self._run.machine.state.setpoint[self._axes.index(physical)]) / self._scale(physical)

    def _spos(self, axis: object) -> float:
        physical = self._axes.physical(axis)
        return float(self._run.machine.state.setpoint[self._axes.index(physical)]) / self._scale(physical)

    def _apos(self, axis: object) -> float:
        physical = self._axes.physical(axis)
        index, state = self._axes.index(physical), self._run.machine.state
        simulated = state.servo.row[index]["mode"] == PIDF  # without a servo an axis is where it should be
        return float((state.servo.actual if simulated else state.setpoint)[index]) / self._scale(physical)

    def _wpos(self, axis: object, kind: object = OMITTED, channel: object = OMITTED) -> float:
        physical = self._axes.axis(self._number, axis, kind, channel)
        index = self._axes.index(physical)
        owner = self._axes.channel_of(physical)
        run = None if owner is None else self._runs(owner)
        setpoint = self._run.machine.state.setpoint
        return workpiece(None if run is None else executed_words(run), setpoint)[index] / self._scale(
            physical
        )

    # ------------------------------------------------------------------ measured

    def _probe(self, axis: object, kind: object = OMITTED) -> float:
        index, physical = self._own(axis, kind)
        return float(self._measured(index)[index]) / self._scale(physical)

    def _ppos(self, axis: object, kind: object = OMITTED) -> float:
        index, physical = self._own(axis, kind)
        state = self._run.channel.state
        placement = state.placement
        shifts = state.zero_offset + state.tool_offset
        for vector in (placement.program, placement.additive):
            shifts = shifts + np.array(vector or (0.0,) * len(shifts))
        return float(self._measured(index)[index] - shifts[index]) / self._scale(physical)

    def _cprobe(self, axis: object, kind: object = OMITTED) -> float:
        index, physical = self._own(axis, kind)
        probe = self._run.channel.state.probe
        if probe is not None and probe.in_passing:
            raise Fault(
                "NO PROBE POSITION", "on-the-fly measurement (G275) has one axis only: use PPOS or PROBE"
            )
        return self._programmed(self._measured(index))[index] / self._scale(physical)

    def _measured(self, index: int) -> Floats:
        probe = self._run.channel.state.probe
        if probe is None or probe.position is None or index not in probe.axes:
            raise Fault("NO PROBE POSITION", "no probe has switched: test SD(9)=0 before")
        return np.array(probe.position)

    # ------------------------------------------------------------------ within

    def _own(self, axis: object, kind: object) -> tuple[int, int]:
        """Return place and physical index of an axis of the own channel."""
        physical = self._axes.own_axis(self._number, axis, kind)
        return self._axes.index(physical), physical

    def _scale(self, physical: int) -> float:
        """Return mm per unit of the own channel: asynchronous axes are in mm."""
        if self._axes.channel_of(physical) is None:
            return 1.0
        return float(self._run.channel.state.modal.scale[self._axes.index(physical)])


def executed_words(run: ProgramRun) -> ModalWords:
    """Return the words of the executed block; before the first one what the program begins with."""
    if (words := run.reading.modal) is not None:
        return words
    return run.channel.records.words(run.program, run.channel.state.snapshot())


def workpiece(words: ModalWords | None, machine: Floats) -> list[float]:
    """Return the workpiece coordinates of a machine position with the executed block's words."""
    if words is None:
        return list(map(float, machine))
    shifts = words.shifts
    found = machine - np.array(words.zero) + np.array(shifts.own or 0.0)
    return shifts.back([float(each) for each in found])
