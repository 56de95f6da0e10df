"""What of a Power Mate can be set by name: parameters, macro variables, tool offsets and work offsets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.fanuc import Attribute, ParameterRow, PowerMate
from polycnc.errors import shown
from polycnc.servers.machines import NamedValue, Single, no_such
from polycnc.servers.process._macro_numbers import LARGEST, number, variable_number, variable_value
from polycnc.units import is_number

_LOCALS = range(1, 34)
_LENGTH = "length_mm"
_OFFSETS = frozenset(
    {"EXT", *(f"G{number}" for number in range(54, 60)), *(f"G54.P{k}" for k in range(1, 301))}
)


class FanucParameters:
    """The parameters by number; values of axes by their names. What the library refuses to write is refused here."""

    def __init__(self, mate: PowerMate) -> None:
        self._mate = mate

    def all(self) -> Iterable[NamedValue]:
        """Return all that can be read."""
        return [
            self._named(row)
            for row in self._mate.parameters.rows.values()
            if Attribute.NOT_READABLE not in row.attributes
        ]

    def get(self, name: str) -> NamedValue:
        """Return one by its number."""
        return self._named(self._row(name))

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Set one, or those of the axes that are named."""
        row, mate = self._row(name), self._mate
        if Attribute.WRITE_PROTECTED in row.attributes or not mate.state.parameters_writable:
            raise ControlError(
                Refusal.PROTECTED, f"parameter {row.number} cannot be written", hint="It can be read."
            )
        if not mate.has_option(row.option):
            raise ControlError(
                Refusal.PROTECTED,
                f"parameter {row.number} belongs to an option that is not fitted",
                hint="Serve a control with it.",
            )
        axes = self._axes()
        given: Mapping[str, Single] = value if isinstance(value, Mapping) else {"": value}
        if row.per_axis is not isinstance(value, Mapping):
            takes = (
                f"a value for each axis, like {{{next(iter(axes))!r}: 1}}" if row.per_axis else "one value"
            )
            raise ControlError(Refusal.DATA, f"parameter {row.number} takes {takes}", hint="See its row.")
        for axis, each in given.items():
            if row.per_axis and axis not in axes:
                raise ControlError(
                    Refusal.DATA, f"there is no axis '{axis[:16]}'", hint=f"The axes are {', '.join(axes)}."
                )
            if isinstance(each, bool) or not isinstance(each, int) or not row.fits(each):
                raise ControlError(
                    Refusal.DATA,
                    f"parameter {row.number} cannot be {shown(each, 40)}",
                    hint=f"Give whole numbers from {row.low} to {row.high}.",
                )
        with mate.store.transaction():
            for axis, each in given.items():
                assert isinstance(each, int)
                mate.parameters.set(row.number, each, axes.get(axis, 0))

    def _axes(self) -> dict[str, int]:
        return {self._mate.units.axis_name(axis): axis for axis in range(1, self._mate.axes + 1)}

    def _row(self, name: str) -> ParameterRow:
        row = self._mate.parameters.rows.get(number(name))
        if row is None or Attribute.NOT_READABLE in row.attributes:
            raise no_such("parameter", name)
        return row

    def _named(self, row: ParameterRow) -> NamedValue:
        value = self._mate.parameters.value
        writable = Attribute.WRITE_PROTECTED not in row.attributes and self._mate.has_option(row.option)
        return NamedValue(
            str(row.number),
            {axis: value(row.number, at) for axis, at in self._axes().items()}
            if row.per_axis
            else value(row.number),
            row.name,
            row.low,
            row.high,
            writable=writable and self._mate.state.parameters_writable,
        )


class FanucVariables:
    """Macro variables: #1 to #33 of the executed macro and system variables to be read, common ones to be set too."""

    def __init__(self, mate: PowerMate) -> None:
        self._mate = mate

    def all(self) -> Iterable[NamedValue]:
        """Return the local and common variables that are not vacant."""
        commons = (range(first, last + 1) for first, last in self._mate.macros.variables.ranges)
        numbers = [*_LOCALS, *(number for each in commons for number in each)]
        return [each for each in map(self._named, numbers) if each.value is not None]

    def get(self, name: str) -> NamedValue:
        """Return one by its number, with or without its `#`."""
        try:
            return self._named(variable_number(name))
        except KeyError:
            raise no_such("variable", name) from None

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Set a common variable; None makes it vacant."""
        number = variable_number(name)
        if number not in self._mate.macros:
            self.get(name)
            raise ControlError(
                Refusal.PROTECTED, f"variable #{number} can only be read", hint="Set it in a program."
            )
        self._mate.macros.set(number, variable_value(number, value))

    def _named(self, number: int) -> NamedValue:
        mate = self._mate
        if number in _LOCALS:
            return NamedValue(f"#{number}", mate.custom_macros.local(number), "local", writable=False)
        if number in mate.macros:
            return NamedValue(f"#{number}", mate.macros.get(number), "common", -LARGEST, LARGEST)
        return NamedValue(f"#{number}", mate.custom_macros.at_rest(number), "system", writable=False)


def set_tool(mate: PowerMate, number: int, values: Mapping[str, float | str]) -> None:
    """Set the offset of a tool, in increments of the control (its memory has one value for each number).

    Raises:
        ControlError: There is none of this number, another field, or out of range.
    """
    if set(values) - {_LENGTH}:
        raise ControlError(
            Refusal.DATA, "an offset memory of one value for each tool", hint=f"Give {_LENGTH} alone."
        )
    offsets = mate.tool_offsets
    decimals = mate.units.increment.decimals
    per_mm = 10.0**decimals if not mate.units.inch_input else 10.0 ** (decimals + 1) / 25.4
    try:
        length = values.get(_LENGTH)
        if length is not None and not is_number(length):
            raise ControlError(Refusal.DATA, f"a length of {shown(length, 40)}", hint="Give mm.")
        offsets.set_all({number: offsets.get(number) if length is None else round(length * per_mm)})
    except KeyError:
        raise ControlError(
            Refusal.NOT_FOUND, f"there is no tool offset {number}", hint=f"Give 1 to {offsets.count}."
        ) from None
    except ValueError as error:
        raise ControlError(
            Refusal.DATA, f"tool offset {number}: {error}", hint=f"In increments up to {offsets.limit}."
        ) from None


def set_offset(mate: PowerMate, name: str, values: Mapping[str, float], *, add: bool) -> None:
    """Set, or shift, a work offset that the control has.

    Raises:
        ControlError: It has no such offset or axis, or out of range.
    """
    if name not in _OFFSETS:
        raise ControlError(
            Refusal.NOT_FOUND,
            f"there is no work offset '{name[:20]}'",
            hint="Give EXT, G54 to G59, G54.P1 to G54.P300.",
        )
    before = mate.control.offsets.get(name, {})
    most = mate.units.increment.offset_limit * 10.0**-mate.units.increment.decimals
    for axis, value in values.items():
        total = value + (before.get(axis, 0.0) if add else 0.0)
        if not abs(total) <= most:
            raise ControlError(
                Refusal.DATA,
                f"{name} {axis[:16]} cannot be {total:g}",
                hint=f"Give up to {most:g} mm or degree.",
            )
    mate.control.offsets.set(name, values, add=add)
