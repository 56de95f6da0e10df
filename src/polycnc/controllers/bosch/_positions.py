"""Positions of axes and coordinates as programs read them (Manual 003, 4.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from polycnc.cnc import ProgramRun
from polycnc.kernel import PIDF
from polycnc.nc.cpl import OMITTED, Fault

_PHYSICAL, _OWN = 0, 1


class Positions:
    """What MPOS, SPOS, APOS, WPOS and CPOS read in the only channel of a run; all its axes are synchronous.

    MPOS, SPOS, APOS and WPOS tell where the axes are now, CPOS where the last prepared block ends. Lengths are mm or
    inch as the channel has it, angles degrees.
    """

    def __init__(self, run: Callable[[], ProgramRun]) -> None:
        self._run = run
        self.functions: Mapping[str, Callable[..., object]] = {
            "MPOS": self._mpos, "SPOS": self._spos, "APOS": self._apos, "WPOS": self._wpos, "CPOS": self._cpos,
            "PPOS": self._not_measured, "PROBE": self._not_measured, "CPROBE": self._not_measured,
        }  # fmt: skip

    def _mpos(self, axis: object, kind: object = OMITTED, channel: object = OMITTED) -> float:
        index = self._axis(axis, kind, channel)
        return float(list(self._run().machine.setpoints.values())[index]) / self._scale(index)

    def _spos(self, axis: object) -> float:
        return self._mpos(axis)

    def _apos(self, axis: object) -> float:
        index = self._axis(axis, OMITTED, OMITTED)
        machine = self._run().machine
        simulated = (
            machine.state.servo.row[index]["mode"] == PIDF
        )  # without servos an axis is where it should be
        positions = machine.actual if simulated else machine.setpoints
        return float(list(positions.values())[index]) / self._scale(index)

    def _wpos(self, axis: object, kind: object = OMITTED, channel: object = OMITTED) -> float:
        index = self._axis(axis, kind, channel)
        offset = float(self._run().channel.state.modal.offset[index])
        machine = float(list(self._run().machine.setpoints.values())[index])
        return (machine - offset) / self._scale(index)

    def _cpos(self, axis: object, kind: object = OMITTED) -> float:
        index = self._axis(axis, kind, OMITTED)
        modal = self._run().channel.state.modal
        return float(modal.position[index] - modal.offset[index]) / self._scale(index)

    def _not_measured(self, axis: object, kind: object = OMITTED) -> float:
        self._axis(axis, kind, OMITTED)
        raise Fault("NO PROBE POSITION", "no probe has switched: test SD(9)=0 before")

    def _scale(self, index: int) -> float:
        return float(self._run().channel.state.modal.scale[index])

    def _axis(self, axis: object, kind: object, channel: object) -> int:
        """Return the index of an axis from 0 on."""
        if kind is not OMITTED and kind not in (_PHYSICAL, _OWN):
            raise Fault("INVALID PARAMETER", "0 selects the physical axis, 1 that of the channel")
        if channel is not OMITTED:
            if kind == _PHYSICAL:
                raise Fault("INVALID PARAMETER", "a physical axis takes no channel")
            if channel != 1:
                raise Fault("INVALID PARAMETER", f"there is no channel {channel}")
        names = self._run().machine.config.axis_names
        if isinstance(axis, str):
            if axis in names:
                return names.index(axis)
            raise Fault("INVALID PARAMETER", f"there is no axis {axis}; there are {', '.join(names)}")
        if type(axis) is not int or not 1 <= axis <= len(names):
            raise Fault("INVALID PARAMETER", f"axes are 1 to {len(names)}")
        return axis - 1
