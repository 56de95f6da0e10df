"""The settings of a grbl ($0 to $132): rows, what they may be, and what of the machine they are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from polycnc.cnc import Control
from polycnc.machine import AnyAxis
from polycnc.servers.grbl._codes import GrblError, RefusedError

_AREA = "grbl.settings"
AXES = 3
SOFT_LIMITS, HARD_LIMITS, HOMING = 20, 21, 22
REPORT_MASK, REPORT_INCHES = 10, 13
MAX_RPM = 30
LASER = 32
_STEPS, _RATE, _ACCELERATION, _TRAVEL = 100, 110, 120, 130


@dataclass(frozen=True, slots=True)
class Setting:
    """A setting: its number, what it is and its unit, its default, and whether it is a whole number."""

    number: int
    text: str
    unit: str
    default: float
    whole: bool = False
    most: float = 1e9

    def shown(self, value: float) -> str:
        """Return a value as grbl writes it."""
        return f"{int(value)}" if self.whole else f"{value:.3f}"


def _axis_rows(first: int, text: str, unit: str, default: float) -> tuple[Setting, ...]:
    return tuple(Setting(first + n, f"{name} {text}", unit, default) for n, name in enumerate("XYZ"))


ROWS = (
    Setting(0, "Step pulse time", "us", 10, True, 255),
    Setting(1, "Step idle delay", "ms", 25, True, 255),
    Setting(2, "Step pulse invert", "mask", 0, True, 255),
    Setting(3, "Step direction invert", "mask", 0, True, 255),
    Setting(4, "Invert step enable pin", "boolean", 0, True, 1),
    Setting(5, "Invert limit pins", "boolean", 0, True, 1),
    Setting(6, "Invert probe pin", "boolean", 0, True, 1),
    Setting(REPORT_MASK, "Status report options: 1 machine position, 2 buffers", "mask", 1, True, 255),
    Setting(11, "Junction deviation", "mm", 0.01),
    Setting(12, "Arc tolerance", "mm", 0.002),
    Setting(REPORT_INCHES, "Report in inches", "boolean", 0, True, 1),
    Setting(SOFT_LIMITS, "Soft limits", "boolean", 0, True, 1),
    Setting(HARD_LIMITS, "Hard limits", "boolean", 0, True, 1),
    Setting(HOMING, "Homing cycle", "boolean", 0, True, 1),
    Setting(23, "Homing direction invert", "mask", 0, True, 255),
    Setting(24, "Homing locate feed rate", "mm/min", 25),
    Setting(25, "Homing search seek rate", "mm/min", 500),
    Setting(26, "Homing switch debounce", "ms", 250, True, 65535),
    Setting(27, "Homing switch pull-off", "mm", 1),
    Setting(MAX_RPM, "Maximum spindle speed", "RPM", 1000),
    Setting(31, "Minimum spindle speed", "RPM", 0),
    Setting(LASER, "Laser mode", "boolean", 0, True, 1),
    *_axis_rows(_STEPS, "steps per mm", "steps/mm", 250),
    *_axis_rows(_RATE, "maximum rate", "mm/min", 500),
    *_axis_rows(_ACCELERATION, "acceleration", "mm/s^2", 10),
    *_axis_rows(_TRAVEL, "maximum travel", "mm", 200),
)
BY_NUMBER = {row.number: row for row in ROWS}


def _rate(axis: AnyAxis) -> float:
    return axis.vmax * 60.0


def _acceleration(axis: AnyAxis) -> float:
    return axis.amax


def _travel(axis: AnyAxis) -> float:
    low, high = axis.soft_limits
    return high - low if high - low < 1e9 else 0.0


_READ: dict[int, Callable[[AnyAxis], float]] = {_RATE: _rate, _ACCELERATION: _acceleration, _TRAVEL: _travel}


_OF_THE_FILE = {MAX_RPM: "the highest spindle speed is", LASER: "the laser is [spindle] laser"}


class GrblSettings:
    """Read and write settings; those of the axes are the axes' own, the others are kept with the machine's memory.

    $20 and $130 are the axes' soft limits: the upper end stays where it is. Those that were switched off are kept.
    """

    def __init__(self, control: Control) -> None:
        self._control = control
        self._area = control.machine.memory.area(_AREA, float)
        self._kept: dict[int, float] = {int(key): float(value) for key, value in self._area.load().items()}
        self._off: dict[str, tuple[float, float]] = {}
        self.names = control.machine.config.axis_names[:AXES]

    @property
    def rows(self) -> Sequence[Setting]:
        """The settings of this machine."""
        return [row for row in ROWS if row.number < _STEPS or row.number % 10 < len(self.names)]

    def __getitem__(self, number: int) -> float:
        """Return a value."""
        axes = self._control.machine.config.axes
        if number == SOFT_LIMITS:
            return float(any(_travel(axis) > 0.0 for axis in axes[:AXES]))
        if number == MAX_RPM:
            return self._control.machine.config.spindle.max_rpm
        if number == LASER:
            return float(self._control.machine.config.spindle.laser)
        read = _READ.get(number // 10 * 10) if number >= _STEPS else None
        if read is not None:
            axis = axes[number % 10]
            low, high = self._off.get(axis.name, (0.0, 0.0)) if read is _travel else (0.0, 0.0)
            return high - low or read(axis)
        return self._kept.get(number, self._default(number))

    def _default(self, number: int) -> float:
        if number == HOMING:
            return float(any(each.reference_switch is not None for each in self._control.machine.config.axes))
        return BY_NUMBER[number].default

    def flag(self, number: int) -> bool:
        """Return whether a setting is on."""
        return self[number] != 0.0

    def changes_axes(self, number: int) -> bool:
        """Tell whether a setting is one of the axes: it cannot be written while they may move."""
        return number == SOFT_LIMITS or (number >= _STEPS and number // 10 * 10 in _READ)

    def check(self, number: int, value: float) -> None:
        """Look whether a setting can be written.

        Raises:
            RefusedError: There is no such setting, or it cannot have the value.
        """
        row = BY_NUMBER.get(number)
        if row is None or row not in self.rows:
            raise RefusedError(GrblError.STATEMENT)
        if value < 0.0:
            raise RefusedError(GrblError.NEGATIVE)
        if value > row.most or (number >= _RATE and value == 0.0):
            raise RefusedError(GrblError.NUMBER, f"${number} cannot be {value:g}")
        if number == SOFT_LIMITS and value:
            if not self.flag(HOMING):
                raise RefusedError(GrblError.NEEDS_HOMING)
            if not self._off and not self.flag(SOFT_LIMITS):
                raise RefusedError(GrblError.STATEMENT, "no axis has a travel: write $130 to $132 first")
        if number in _OF_THE_FILE and value != self[number]:
            raise RefusedError(GrblError.STATEMENT, f"{_OF_THE_FILE[number]} in the machine file")

    def write(self, number: int, value: float) -> None:
        """Write a setting that `check` let pass.

        Raises:
            ControlError: One of the axes, while they may move.
        """
        value = float(int(value)) if BY_NUMBER[number].whole else value
        if self.changes_axes(number):
            axes, off = self._control.machine.config.axes, dict(self._off)
            changed = [self._changed(axis, index, number, value, off) for index, axis in enumerate(axes)]
            self._control.change_axes(tuple(changed))
            self._off = off
        elif number not in _OF_THE_FILE:
            self._area[number] = value
            self._kept[number] = value
        if number == HOMING and not value and self.flag(SOFT_LIMITS):
            self.write(SOFT_LIMITS, 0.0)

    def restore_defaults(self) -> None:
        """Forget what was written of settings that are not the axes'."""
        for number in list(self._kept):
            self.write(number, self._default(number))

    def _changed(
        self, axis: AnyAxis, index: int, number: int, value: float, off: dict[str, tuple[float, float]]
    ) -> AnyAxis:
        """Return an axis with a setting; limits that do not act are kept in `off`."""
        update: dict[str, Any] = {}
        limits = axis.soft_limits
        unit = "mm" if axis.kind == "linear" else "deg"
        if number == SOFT_LIMITS and index < AXES:
            if value and axis.name in off:
                update = {f"soft_limits_{unit}": off.pop(axis.name)}
            elif not value and _travel(axis) > 0.0:
                off[axis.name] = limits
                update = {f"soft_limits_{unit}": None}
        elif number % 10 == index and number >= _RATE:
            match number // 10 * 10:
                case 110:
                    update = {f"vmax_{unit}_s": value / 60.0}
                case 120:
                    update = {f"amax_{unit}_s2": value}
                case _:
                    _, high = off.get(axis.name, limits if _travel(axis) > 0.0 else (0.0, 0.0))
                    if self.flag(SOFT_LIMITS):
                        update = {f"soft_limits_{unit}": (high - value, high)}
                    else:
                        off[axis.name] = (high - value, high)
        return axis.model_copy(update=update) if update else axis
