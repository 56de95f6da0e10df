"""The control without a vendor within a Power Mate: made when power comes on, kept in step with the parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from polycnc.cnc import (
    AfterManual,
    Control,
    ControlData,
    ControlError,
    ManualData,
    MemoryData,
    OnModeChange,
    Script,
)
from polycnc.controllers.fanuc.data._increment import Scale
from polycnc.controllers.fanuc.data._parameter_rows import Attribute, ParameterRow
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.device._alarms import (
    NAME_ALARM,
    POWER_MATE_ALARMS,
    PREFIX,
    AlarmBit,
    alarm_bits,
)
from polycnc.controllers.fanuc.device._device_state import DeviceState
from polycnc.controllers.fanuc.device._machine_file import AxisSetting, axis_of, machine_of, usable_names
from polycnc.controllers.fanuc.device._units import Units
from polycnc.errors import UsageError
from polycnc.machine import AnyAxis, Machine, Store
from polycnc.nc import Dialect, load_dialect
from polycnc.nc.macro import MacroLanguage

_MM_PER_MIN = 60.0
_MOST_FEED_OVERRIDE = 2.54  # Manual 000, cnc_opdi: 11111110
_BLOCKS_AHEAD = 1  # Manual 000, cnc_modal: the next block, and the next but one at the most
_ACT_ON_MOTION = frozenset({0, 1301, 1320, 1321, 1420, 1423, 1620, 1825, 1828, 3401})


@dataclass(frozen=True, slots=True)
class Fitted:
    """What a control is fitted with.

    `script` says how the PMC answers functions, `servo` simulates the position loops, `memory` is what the program
    memory takes, and with `macros` programs have custom macros.
    """

    script: Script | None
    servo: bool
    memory: MemoryData
    macros: bool


class Power:
    """The control that is on; encoders are absolute."""

    control: Control

    def __init__(
        self, store: Store, parameters: Parameters, units: Units, state: DeviceState, fitted: Fitted
    ) -> None:
        self._store = store
        self._parameters = parameters
        self._units = units
        self._state = state
        self._fitted = fitted
        self._stale = False  # parameters have changed that the control could not take over yet

    def switch_on(
        self, before: Machine | None, languages: tuple[MacroLanguage, ...], on_skip: Callable[[], None]
    ) -> None:
        """Make the control that there is when power comes on, with the axes where those of `before` are."""
        self._units.switched_on()
        axes, fitted = self._axes(), self._fitted
        names = [axis.name for axis in axes]
        start = (
            dict.fromkeys(names, 0.0)
            if before is None
            else dict(zip(names, before.actual.values(), strict=True))
        )
        self.control = control = Control(
            machine_of(axes, start),
            memory=self._store,
            dialect=self._dialect(),
            script=fitted.script,
            servo=fitted.servo,
            languages=languages,
            data=ControlData(
                memory=fitted.memory,
                alarms=POWER_MATE_ALARMS,
                mode_change_while_running=OnModeChange.HOLD,
                after_manual=AfterManual.RETURN,
                dry_run_mm_min=float(self._parameters.value(1410)),
                most_feed_override=_MOST_FEED_OVERRIDE,
                sub_program_names=("O{number:04d}",),
                manual=ManualData(jog_speeds=self._jog_speeds(axes)),
                emergency_needs_reset=False,
            ),
        )
        control.channels[0].on_skip = on_skip
        control.change_axes(axes)
        for axis, name in enumerate(names, 1):
            if self._parameters.value(1020, axis) != ord(name):
                self.raise_alarm(NAME_ALARM, f"PARAMETER 1020 OF AXIS {axis}: {name}", axis=axis)

    def raise_alarm(self, number: int, text: str = "", *, axis: int | None = None) -> None:
        """Put an alarm on by its number; axes count from 1.

        Raises:
            UsageError: The number is none, or there is no such axis.
        """
        if not 0 <= number <= 5999 or (axis is not None and not 1 <= axis <= self._parameters.axes):
            raise UsageError(f"there is no alarm {number} of axis {axis}", hint="Numbers are 0 to 5999.")
        name = None if axis is None else self._units.axis_name(axis)
        self.control.put_alarm(f"{PREFIX}{number}", axis=name, detail=text)

    @property
    def alarm_bits(self) -> AlarmBit:
        """The groups of the alarms that are on."""
        return alarm_bits(self.control.alarms.active)

    @property
    def blocks_transfers(self) -> bool:
        """Whether alarm 000 or 101 keeps programs from being moved."""
        return bool(self.alarm_bits & (AlarmBit.PS000 | AlarmBit.PS101))

    # ------------------------------------------------------------------ parameters

    def parameters_changed(self, rows: tuple[ParameterRow, ...]) -> None:
        """Take note of parameters that have been written."""
        if any(Attribute.POWER_OFF in row.attributes for row in rows):
            self.raise_alarm(0)
        if any(row.number == 0 for row in rows):
            self._state.inch = self._parameters.bit(0, 2)
        if any(row.number in _ACT_ON_MOTION for row in rows):
            self._stale = True
            self.take_over()

    def take_over(self) -> None:
        """Let the control have what parameters say now, as soon as nothing moves; axes and units wait for the power."""
        if not self._stale or self.alarm_bits & AlarmBit.PS000:
            return
        axes = self._axes()
        try:
            self.control.change_axes(axes)
            self.control.change_dialect(self._dialect())
        except (ControlError, UsageError):
            return  # something moves; tried again when time has passed
        self.control.manual.data = replace(self.control.manual.data, jog_speeds=self._jog_speeds(axes))
        self._stale = False

    def _dialect(self) -> Dialect:
        data = load_dialect("fanuc").model_dump()
        data["name"] = "power mate"
        data["blocks_ahead"] = _BLOCKS_AHEAD
        data["soft_limits"] = "before" if self._parameters.bit(1301, 7) else "at_limit"
        data["language"] = "macro" if self._fitted.macros else "none"
        data["numbers"] = {
            "decimal_point": "calculator" if self._parameters.bit(3401, 0) else "least_input",
            "least_input": 10.0**-self._units.increment.decimals,
        }
        data["initial"]["units"] = "inch" if self._state.inch else "metric"
        return Dialect.model_validate(data)

    def _axes(self) -> tuple[AnyAxis, ...]:
        """Return the axes as the parameters describe them."""
        value = self._parameters.value
        numbers = range(1, self._parameters.axes + 1)
        turning = [self._parameters.bit(1006, 0, axis) for axis in numbers]
        names = usable_names([value(1020, axis) for axis in numbers], turning)
        made = []
        for axis, name, rotary in zip(numbers, names, turning, strict=True):
            units = self._units.output(linear=not rotary)
            vmax = _speed(value(1420, axis), units)
            high, low = value(1320, axis), value(1321, axis)
            kp = value(1825, axis) / 100.0 if self._fitted.servo else None
            setting = AxisSetting(
                name=name,
                rotary=rotary,
                vmax=vmax,
                amax=vmax / (value(1620, axis) / 1000.0),
                soft_limits=(units.value(low), units.value(high)) if low < high else None,
                servo_kp=kp,
                error_limit=units.step * value(1828, axis) if kp and value(1828, axis) else None,
            )
            made.append(axis_of(setting))
        return tuple(made)

    def _jog_speeds(self, axes: tuple[AnyAxis, ...]) -> dict[str, float]:
        return {
            each.name: _speed(
                self._parameters.value(1423, axis), self._units.output(linear=each.kind == "linear")
            )
            for axis, each in enumerate(axes, 1)
        }


def _speed(value: int, units: Scale) -> float:
    """Return a speed parameter (mm/min, deg/min; on an inch machine 0.1 inch/min) per second."""
    return value / _MM_PER_MIN * (2.54 if units.inch else 1.0)
