"""A call of each function of the manual's second half, and a scene of calls that do not reach the control."""

from __future__ import annotations

from typing import Any

from polycnc.controllers.fanuc import fwlib
from support.fanuc_scenes_b import Bench, opdi, panel, plain, positions

CALLS: tuple[tuple[Any, ...], ...] = (
    ("cnc_stopophis",), ("cnc_startophis",), ("cnc_rdophisno",), ("cnc_rdophistry", 1, 1, 14), ("cnc_rdalmhisno",),
    ("cnc_rdalmhistry", 1, 1, 54), ("cnc_clearophis", 0), ("cnc_rdhissgnl",), ("cnc_wrhissgnl", fwlib.IODBSIG(type=1)),
    ("cnc_opdi", 10, opdi(5)), ("cnc_refpoint", 1, 0, 1), ("cnc_abspoint", 1, 0, 1, 600, positions((1, 5))),
    ("cnc_incpoint", 1, 0, 1, 600, positions((1, 5))), ("cnc_dwell", 1, 0, 1, positions((1, 5))),
    ("cnc_coordre", 1, 0, 1, positions((1, 5))), ("cnc_exebufstat",), ("cnc_finstate",), ("cnc_setfin", fwlib.ODBFIN()),
    ("cnc_sysinfo",), ("cnc_sysconfig",), ("cnc_statinfo",), ("cnc_alarm",), ("cnc_rdalminfo", 0, -1, 6),
    ("cnc_modal", 0, 0), ("cnc_diagnoss", 0, 0, 5), ("cnc_diagnosr", 0, 0, 0, 6), ("cnc_getfigure", 0),
    ("cnc_rdcurrent",), ("cnc_rdsrvspeed",), ("cnc_rdloopgain",), ("cnc_rdopmsg", 0, 262), ("cnc_rdopnlsgnl", 1),
    ("cnc_wropnlsgnl", panel(0x20, feed_ovrd=3)), ("cnc_rdopnlgnrl", 1),
    ("cnc_wropnlgnrl", fwlib.IODBGNRL(type=1, sgnal=1)), ("cnc_rdopnlgsname", 1),
    ("cnc_wropnlgsname", fwlib.IODBRDNA(type=1, sgnl1_name=b"A")), ("pmc_rdpmcrng", 9, 0, 5, 5, 9),
    ("pmc_wrpmcrng", 9, bytes((9, 0, 0, 0, 5, 0, 5, 0, 7))), ("pmc_rdpmcinfo", 9),
)  # fmt: skip
"""A call of each function."""


def faults(b: Bench) -> None:
    """Each function on a handle that is none, on a way that is broken, while the control is busy; then as it is."""
    good, node = b.handle, b.library.nodes[0]
    b.ask("cnc_stopophis")
    for handle, fault in (
        (good + 1, "EW_OK"),
        (0, "EW_OK"),
        (good, "EW_BUSY"),
        (good, "EW_HSSB"),
        (good, "EW_SYSTEM"),
    ):
        b.title(f"{'the' if handle == good else 'another'} handle, {fault}")
        node.fault = fwlib.EW[fault]
        for name, *arguments in CALLS:
            found = getattr(b.library, name)(handle, *arguments)
            code = found[0] if isinstance(found, tuple) else found
            rest = " ".join(map(plain, found[1:])) if isinstance(found, tuple) else ""
            b.lines.append(f"{name} {fwlib.EW(code).name} {rest}".rstrip())
        node.fault = fwlib.EW.EW_OK
        b.look()
    b.title("nothing is wrong")
    for name, *arguments in CALLS:
        b.do(name, *arguments)


SCENES = (faults,)
