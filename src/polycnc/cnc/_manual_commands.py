"""Commands that move axes by hand: in the mode of each, with axes that their channel lends."""

from __future__ import annotations

from polycnc.cnc._alarms import AlarmKind
from polycnc.cnc._control_checks import check_ready, wrong_mode
from polycnc.cnc._control_data import Mode
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._status import Emergency
from polycnc.errors import shown
from polycnc.units import is_finite


class ManualCommands:
    """Carry out the commands that move axes by hand."""

    def __init__(self, of: ControlParts) -> None:
        self._of = of

    def jog(self, axis: str, direction: int | None, *, rapid: bool = False) -> None:
        """Press a jog key (1 or -1), or let it go (None).

        Raises:
            ControlError: Not in JOG (letting go is always allowed), or as `ManualMotion.jog`.
        """
        if direction:
            self._lend(axis, Mode.JOG)
        self._of.manual.jog(axis, direction, rapid=rapid)

    def increment(self, axis: str, direction: int, size: float, *, rapid: bool = False) -> None:
        """Go one increment (mm or degree).

        Raises:
            ControlError: Not in INC, or as `ManualMotion.increment`.
        """
        self._lend(axis, Mode.INC)
        self._of.manual.increment(axis, direction, size, rapid=rapid)

    def handwheel(self, axis: str, pulses: int, size: float) -> None:
        """Turn the handwheel by pulses of a size (mm or degree) each.

        Raises:
            ControlError: Not in HANDLE, or as `ManualMotion.handwheel`.
        """
        self._lend(axis, Mode.HANDLE)
        self._of.manual.handwheel(axis, pulses, size)

    def reference(self, axis: str) -> None:
        """Reference an axis.

        Raises:
            ControlError: Not in REF, a program is interrupted, or as `ManualMotion.reference`.
        """
        owner = self._of.owner(axis)
        if owner.interrupted:
            raise ControlError(
                Refusal.RUNNING, "a program is interrupted", hint="Let it go on to its end, or reset it."
            )
        self._lend(axis, Mode.REF)
        self._of.manual.reference(axis)

    def set_relative(self, axis: str, position: float = 0.0) -> None:
        """Let the relative position of an axis be `position` (mm or degree) here.

        Raises:
            ControlError: No such axis, or a position that is not finite.
        """
        names = self._of.machine.config.axis_names
        if axis not in names or not is_finite(position):
            raise ControlError(
                Refusal.DATA,
                f"axis {axis} cannot be at {shown(position)}",
                hint=f"The axes are {', '.join(names)}.",
            )
        index = names.index(axis)
        self._of.relative_zero[index] = float(self._of.machine.state.servo.actual[index]) - position
        self._of.clock.changes += 1

    def _lend(self, axis: str, mode: Mode) -> None:
        """Give the axes of a channel to manual motion in its mode."""
        owner = self._of.owner(axis)
        if owner.mode is not mode:
            raise wrong_mode(owner.mode, f"axes can be moved in {mode}", mode)
        alarms = self._of.alarms.of(owner.path)
        serious = [alarm for alarm in alarms if alarm.kind is not AlarmKind.TRAVEL]
        if self._of.emergency is not Emergency.OFF or serious:
            check_ready(self._of.emergency, alarms)
        owner.release()
