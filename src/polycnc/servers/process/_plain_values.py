"""What of a control without a vendor can be set by name: what is set for it, and the variables of its language."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from polycnc.cnc import AfterManual, Control, ControlError, OnModeChange, Refusal
from polycnc.errors import PolycncError, shown
from polycnc.nc.macro import MacroLanguage, MacroVariables
from polycnc.servers.machines import NamedValue, Single, no_such
from polycnc.servers.process._macro_numbers import variable_number, variable_value


@dataclass(frozen=True, slots=True)
class _Row:
    """A field of the control's data: a switch, a word, or a number, which its runs are made with and which stays."""

    name: str
    what: str
    kind: type


_ROWS = (
    _Row("mode_change_while_running", "What a change of the mode does while a program runs.", OnModeChange),
    _Row("after_manual", "What a start does after axes were moved by hand.", AfterManual),
    _Row("reference_required", "Whether a start needs referenced axes.", bool),
    _Row("emergency_needs_reset", "Whether a released emergency stop needs a reset.", bool),
    _Row("reset_stops_spindle", "Whether a reset stops the spindle.", bool),
    _Row("end_stops_spindle", "Whether a program's end stops the spindle.", bool),
    _Row("count_parts", "Whether program ends count parts.", bool),
    _Row("most_feed_override", "The largest feed override, 1 is 100 %.", float),
    _Row("dry_run_mm_min", "The feed of a dry run (mm/min).", float),
)
ROWS = {row.name: row for row in _ROWS}


class PlainParameters:
    """What is set for a control, by the names of `ControlData`."""

    def __init__(self, control: Control) -> None:
        self._control = control

    def all(self) -> Iterable[NamedValue]:
        """Return all of them."""
        return list(map(self.get, ROWS))

    def get(self, name: str) -> NamedValue:
        """Return one."""
        row = _row(name)
        value = getattr(self._control.data, name)
        choices = tuple(each.value for each in row.kind) if issubclass(row.kind, StrEnum) else ()
        shown = value.value if isinstance(value, StrEnum) else value
        return NamedValue(name, shown, row.what, choices=choices, writable=row.kind is not float)

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Set one."""
        self._control.data = replace(self._control.data, **{name: _checked(_row(name), value)})


def _row(name: str) -> _Row:
    if name not in ROWS:
        raise no_such("parameter", name)
    return ROWS[name]


def _checked(row: _Row, value: object) -> Any:
    hint = "Give true or false."
    if row.kind is bool:
        if isinstance(value, bool):
            return value
    elif row.kind is float:
        raise ControlError(
            Refusal.PROTECTED, f"{row.name} can only be read", hint="It is set when a control is made."
        )
    elif issubclass(row.kind, StrEnum):
        words = [each.value for each in row.kind]
        hint = f"Give one of {', '.join(words)}."
        if value in words:
            return row.kind(value)
    raise ControlError(Refusal.DATA, f"{row.name} cannot be {shown(value, 40)}", hint=hint)


class MacroValues:
    """The variables of the custom macros that a control's programs are written in."""

    def __init__(self, find: Callable[[], Control]) -> None:
        self._find = find

    def all(self) -> Iterable[NamedValue]:
        """Return those that are not vacant."""
        variables = self._variables()
        numbers = [*range(1, 34), *(k for first, last in variables.ranges for k in range(first, last + 1))]
        return [each for each in map(self._named, numbers) if each.value is not None]

    def get(self, name: str) -> NamedValue:
        """Return one by its number, with or without its `#`."""
        number = variable_number(name)
        if self._variables().kind(number) is None:
            raise no_such("variable", name)
        return self._named(number)

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Set one that is not of a macro alone; None makes it vacant."""
        number = variable_number(name)
        if not self.get(name).writable:
            raise ControlError(
                Refusal.PROTECTED, f"variable #{number} can only be read", hint="Set it in a program."
            )
        given = variable_value(number, value)
        try:
            self._variables().set_all({number: given})
        except PolycncError as error:
            raise ControlError(Refusal.DATA, error.what, hint=error.hint) from None

    def _variables(self) -> MacroVariables:
        control = self._find()
        language = control.channels[0].runs.language
        if not isinstance(language, MacroLanguage):
            raise ControlError(
                Refusal.NOT_FOUND,
                f"programs of dialect {control.dialect.name} have no variables by number",
                hint="Serve a control whose dialect has custom macros.",
            )
        return language.variables

    def _named(self, number: int) -> NamedValue:
        variables = self._variables()
        kind = variables.kind(number) or ""
        return NamedValue(f"#{number}", variables.get(number), kind, writable=kind in ("common", "permanent"))
