"""Dialog programs that the operator calls, and those that belong to sub-program calls (Manual 003, 7.1 and 7.2)."""

from __future__ import annotations

import re
from collections.abc import Sequence

from polycnc.controllers.bosch.files import CALL

AREAS = {
    "manual": "cpldlg01.dlg", "automatic": "cpldlg02.dlg", "manage": "cpldlg03.dlg", "diagnostics": "cpldlg04.dlg",
    "editor": "cpldlg05.dlg",
}  # fmt: skip
"""The dialog program of each area of the operator interface."""


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
