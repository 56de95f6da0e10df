"""The modes of a Power Mate, and which mode of the control behind it each one is."""

from __future__ import annotations

from enum import IntEnum

from polycnc.cnc import Mode
from polycnc.errors import UsageError


class PowerMateMode(IntEnum):
    """Modes, with the numbers that cnc_statinfo gives them (Manual 000, cnc_statinfo)."""

    MDI = 0
    MEM = 1
    EDIT = 3
    HND = 4
    JOG = 5
    T_JOG = 6
    T_HND = 7
    INC = 8
    REF = 9
    RMT = 10

    @property
    def label(self) -> str:
        """Return the name that the operator reads."""
        return self.name.replace("_", "-")


CONTROL_MODES = {
    PowerMateMode.MDI: Mode.MDI,
    PowerMateMode.MEM: Mode.AUTO,
    PowerMateMode.EDIT: Mode.EDIT,
    PowerMateMode.HND: Mode.HANDLE,
    PowerMateMode.JOG: Mode.JOG,
    PowerMateMode.T_JOG: Mode.JOG,
    PowerMateMode.T_HND: Mode.HANDLE,
    PowerMateMode.INC: Mode.INC,
    PowerMateMode.REF: Mode.REF,
    PowerMateMode.RMT: Mode.AUTO,
}

_NAMES = {mode.label: mode for mode in PowerMateMode} | {
    "MEMORY": PowerMateMode.MEM,
    "HANDLE": PowerMateMode.HND,
    "REMOTE": PowerMateMode.RMT,
}


def mode_of(mode: PowerMateMode | str) -> PowerMateMode:
    """Return a mode by its name, like "MEM" or "T-JOG".

    Raises:
        UsageError: There is no such mode.
    """
    if isinstance(mode, str):
        try:
            return _NAMES[mode.upper().replace("_", "-")]
        except KeyError:
            names = ", ".join(each.label for each in PowerMateMode)
            raise UsageError(f"there is no mode '{mode}'", hint=f"The modes are {names}.") from None
    return PowerMateMode(mode)
