"""The parameters of one control: durable values, and parts of the control that have theirs elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from polycnc.controllers.fanuc.data._parameter_rows import Attribute, ParameterRow, parameter_rows
from polycnc.machine import Store

NO_AXIS = 0
AXES = 1010  # the number of axes, which is that of the control
_AREA = "fanuc.parameters"


@dataclass(frozen=True, slots=True)
class Bound:
    """A parameter whose value lives elsewhere in the control: a timer, a counter, an offset."""

    get: Callable[[int], int]
    set: Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Change:
    """One value to be written: `axis` from 1, 0 for a parameter that has one value."""

    row: ParameterRow
    axis: int
    value: int


class Parameters:
    """Keep the values; a change is durable when the call returns, several changes come all or not at all.

    `bound` are those that live elsewhere; `on_change` gets the rows that were changed, after they are durable.
    """

    def __init__(
        self,
        store: Store,
        axes: int,
        defaults: Mapping[tuple[int, int], int],
        bound: Mapping[int, Bound],
        on_change: Callable[[tuple[ParameterRow, ...]], None],
    ) -> None:
        self.rows = parameter_rows()
        self.axes = axes
        self._bound = bound
        self._on_change = on_change
        self._store = store
        self._area = store.area(_AREA, int)
        self._values = {
            (number, axis): row.default
            for number, row in self.rows.items()
            for axis in (range(1, axes + 1) if row.per_axis else (NO_AXIS,))
        }
        self._values.update(defaults)
        kept = self._area.load()
        if not kept:  # a new memory: it gets the settings of the control
            self._area.save({_key(number, axis): value for (number, axis), value in defaults.items()})
        for key, value in kept.items():
            number, axis = map(int, str(key).split("."))
            if (number, axis) in self._values and number != AXES:
                self._values[number, axis] = value

    def value(self, number: int, axis: int = NO_AXIS) -> int:
        """Return a value; KeyError if there is no such parameter or axis. Axes that are not there have 0."""
        bound = self._bound.get(number)
        if bound is not None and (number, axis) in self._values:
            return bound.get(axis)
        if self.rows[number].per_axis and axis > self.axes:
            return 0
        return self._values[number, axis]

    def bit(self, number: int, bit: int, axis: int = NO_AXIS) -> bool:
        """Return one bit of a bit parameter."""
        return bool(self.value(number, axis) >> bit & 1)

    def write(self, changes: tuple[Change, ...]) -> None:
        """Write values that have been checked; those of axes that are not there have no effect."""
        there = [each for each in changes if (each.row.number, each.axis) in self._values]
        with self._store.transaction():
            for each in there:
                bound = self._bound.get(each.row.number)
                if bound is None:
                    self._area[_key(each.row.number, each.axis)] = each.value
                else:
                    bound.set(each.axis, each.value)
        for each in there:
            if each.row.number not in self._bound:
                self._values[each.row.number, each.axis] = each.value
        self._on_change(tuple(dict.fromkeys(each.row for each in there)))

    def set(self, number: int, value: int, axis: int = NO_AXIS) -> None:
        """Write one value as the control itself does, write protection notwithstanding.

        Raises:
            KeyError: There is no such parameter or axis.
            ValueError: The parameter does not take this value.
        """
        row = self.rows[number]
        if (number, axis) not in self._values:
            raise KeyError(f"{number}, axis {axis}")
        if not row.fits(value):
            raise ValueError(f"parameter {number} takes {row.low} to {row.high}, not {value}")
        self.write((Change(row, axis, value),))

    @property
    def settings(self) -> tuple[ParameterRow, ...]:
        """The parameters that can be put in on the setting screen."""
        return tuple(row for row in self.rows.values() if Attribute.SETTING in row.attributes)


def _key(number: int, axis: int) -> str:
    return f"{number}.{axis}"
