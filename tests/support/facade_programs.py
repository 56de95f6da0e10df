"""What the example programs have to print, worked out by the façade in Python."""

from __future__ import annotations

from pathlib import Path

from polycnc.controllers.fanuc import PowerMate, fwlib

SYSTEM = Path(__file__).parents[2] / "examples" / "apci_system.dat"


def facade_says() -> str:
    """Return what the program `fanuc_macro` prints."""
    session = fwlib.Session()
    session.attach(0, PowerMate(3, characters=128_000))
    _, handle = session.cnc_allclibhndl()
    write = session.cnc_wrmacro(handle, 103, 10, 271828, 5)
    code, macro = session.cnc_rdmacro(handle, 103, 10)
    read, at = session.cnc_absolute(handle, fwlib.ALL_AXES, 16)
    short, _ = session.cnc_absolute(handle, fwlib.ALL_AXES, 15)
    found, parameter = session.cnc_rdparam(handle, 1420, 1, 8)
    lines = (
        "open 0", f"write {write:d}", f"macro {code:d}: {macro.mcr_val} {macro.dec_val}",
        f"position {read:d}: {at.data[0]} {at.data[1]} {at.data[2]}", f"too short {short:d}",
        f"parameter {found:d}: {parameter.u.ldata}", "free 0",
    )  # fmt: skip
    return "".join(f"{line}\n" for line in lines)
