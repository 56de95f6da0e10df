"""Permanent variables of a control on disk, beside its files (Manual 003, 2.4.3)."""

from __future__ import annotations

from typing import Any

from polycnc.controllers.bosch.files import Directory
from polycnc.errors import ProgramError
from polycnc.machine import Store
from polycnc.nc.cpl import CharacterField, Field, PermanentMemory

DECLARATIONS = ("wmhperm.dat", "anwperm.dat")
FEPROMS = ("usrfep", "fep")
"""Where the control looks for its own files after its root: the folders of the user FEPROM and of the FEPROM."""
_AREA = "cpl.permanent"


class KeptVariables:
    """The permanent variables of the control whose files lie in a directory.

    `memory` is what programs see, `errors` what is wrong with the declarations.
    """

    def __init__(self, directory: Directory) -> None:
        self.memory = PermanentMemory()
        found = (first_of(directory, name) for name in DECLARATIONS)
        self.errors: list[ProgramError] = self.memory.declare([each for each in found if each is not None])
        self._kept = self.values()

    def take(self, store: Store) -> None:
        """Take over what a store holds."""
        for name, kept in store.area(_AREA, dict).items():
            if name in self.memory:
                self.memory[str(name)] = _filled(self.memory[str(name)], kept["value"])
        self._kept = self.values()

    def changed(self) -> dict[str, object]:
        """Return what has changed since it was read or kept, as plain values."""
        return {name: value for name, value in self.values().items() if value != self._kept.get(name)}

    def keep(self, store: Store, changed: dict[str, object]) -> None:
        """Write what has changed; the caller has a transaction, and says when it is `kept`."""
        area = store.area(_AREA, dict)
        for name, value in changed.items():
            area[name] = {"value": value}

    def kept(self) -> None:
        """Take note that everything was written."""
        self._kept = self.values()

    def values(self) -> dict[str, object]:
        """Return all variables as plain values: fields as lists, NUL as None."""
        return {name: _plain(value) for name, value in self.memory.items()}


def first_of(directory: Directory, name: str) -> tuple[str, str] | None:
    """Return path and text of a file of the control, the first of root, user FEPROM and FEPROM; None without one.

    Raises:
        UsageError: It cannot be read.
    """
    for path in (name, *(f"{folder}/{name}" for folder in FEPROMS)):
        text = directory.own_text(path)
        if text is not None:
            return path, text
    return None


def plain_variable(value: object) -> object:
    """Return the value of a variable as plain data: a field as a list, a text as a text."""
    return _plain(value)


def _plain(value: object) -> Any:
    if isinstance(value, CharacterField):
        return value.text
    if not isinstance(value, Field):
        return value
    if value.kind == "S" or len(value.sizes) == 1:
        return [_plain(value[index]) for index in range(value.sizes[0] + 1)]
    rows, columns = value.sizes
    return [[value[row, column] for column in range(columns + 1)] for row in range(rows + 1)]


def _filled(variable: object, kept: Any) -> object:
    """Put a kept value into a variable, as far as its declaration has room for it."""
    if isinstance(variable, CharacterField):
        variable.assign(kept if isinstance(kept, str) else None)
        return variable
    if not isinstance(variable, Field):
        return None if isinstance(kept, list) else kept
    for row, value in enumerate(kept if isinstance(kept, list) else ()):
        if isinstance(value, list):
            for column, element in enumerate(value):
                if (row, column) in variable:
                    variable[row, column] = element
        elif row in variable:
            variable[row] = _filled(variable[row], value) if variable.kind == "S" else value
    return variable
