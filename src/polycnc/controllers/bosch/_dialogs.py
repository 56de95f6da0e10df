"""Dialog programs that the operator calls, and those that belong to sub-program calls (Manual 003, 7.1 and 7.2)."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import TypeAlias

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.bosch._memory import first_of
from polycnc.controllers.bosch._parameters import DIALOG_CALLS, DIALOG_PROGRAMS
from polycnc.controllers.bosch.files import CALL, Directory, SelectedBlock

AREAS = {
    "manual": "cpldlg01.dlg", "automatic": "cpldlg02.dlg", "manage": "cpldlg03.dlg", "diagnostics": "cpldlg04.dlg",
    "editor": "cpldlg05.dlg",
}  # fmt: skip
"""The dialog program of each area of the operator interface."""


Start: TypeAlias = Callable[[tuple[str, str], SelectedBlock | None], None]
"""Start a dialog program, file and text, for a block of the editor or none."""


class DialogCalls:
    """The dialog programs of a control: those of areas are read at power-up, which is when this is made."""

    def __init__(
        self, directory: Directory, parameters: Callable[[int], Sequence[object]], start: Start
    ) -> None:
        self._directory = directory
        self._parameters = parameters
        self._start = start
        places = ((area, first_of(directory, name)) for area, name in AREAS.items())
        self.areas = {area: found for area, found in places if found is not None}

    def call(self, area: str) -> None:
        """Start the dialog program of an area.

        Raises:
            ControlError: The area had none at power-up.
        """
        if area not in self.areas:
            hint = f"Dialog programs are {', '.join(AREAS.values())}, read at power-up."
            raise ControlError(Refusal.NOT_FOUND, f"{area} has no dialog program", hint=hint)
        self._start(self.areas[area], None)

    def edit(self, text: str) -> SelectedBlock:
        """Start the dialog program for an NC block of the editor; what it makes of it is in what is returned.

        Raises:
            ControlError: There is no such program.
        """
        name = dialog_for(text, self._parameters(DIALOG_CALLS), self._parameters(DIALOG_PROGRAMS))
        found = first_of(self._directory, name)
        if found is None:
            raise ControlError(Refusal.NOT_FOUND, f"there is no program {name}", hint="Put it into the root.")
        block = SelectedBlock(text)
        self._start(found, block)
        return block


def called_name(block: str) -> str:
    """Return what a block calls, "SP" of `P SP[3]` and "Q900" of `N5 Q900[3]`; "" if it is no call."""
    found = CALL.match(block)
    return "" if found is None else (found[1] or re.sub(r"[ \t]", "", found[2])).upper()


def dialog_for(block: str, calls: Sequence[object], programs: Sequence[object]) -> str:
    """Return the dialog program for a block: that of the call it holds, else that of the editor."""
    name = called_name(block)
    for call, program in zip(map(str, calls), map(str, programs), strict=False):
        if call and call.upper() == name:
            return program
    return AREAS["editor"]
