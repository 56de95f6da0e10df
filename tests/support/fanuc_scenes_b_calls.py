"""A call of each function of the manual's second half, and a scene of calls that do not reach the control."""

from __future__ import annotations

from typing import Any
from unittest.mock import patch

from polycnc.controllers.fanuc import fwlib
from polycnc.servers.focas import FocasControl, load_profile
from support.fanuc_scenes_a_wire import Cable
from support.fanuc_scenes_b import AREAS, LETTERS, Bench, opdi, panel, plain, positions
from support.fanuc_scenes_b_matrix import STATES, begun

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


def over_the_network(b: Bench) -> None:
    """What can be asked over the network, in every state: as near the control, or written beside it; the whole PMC."""
    before: dict[str, str] = {}

    def both(name: str, *given: Any) -> None:
        found = [getattr(b.library, name)(handle, *given) for handle in (remote, b.handle)]
        texts = []
        for each in found:
            code, *values = each if isinstance(each, tuple) else (each,)
            texts.append(
                f"{fwlib.EW(code).name} {' | '.join(map(plain, values)) if code == 0 else ''}".rstrip()
            )
        call = f"{name}({', '.join(map(plain, given))})"
        text = f"{call} {texts[0]}" + (f"\n    near: {texts[1]}" if texts[1] != texts[0] else "")
        if before.get(call) != text:
            b.lines.append(text)
        before[call] = text

    for name in STATES:
        begun(b, name)
        control = FocasControl(b.control, load_profile("power-mate"))
        with patch("socket.create_connection", lambda *_, it=control: Cable(it, lambda way, data: None)):
            _, remote = b.library.cnc_allclibhndl3("control", 8193, 1)
            for function in ("cnc_sysinfo", "cnc_statinfo", "cnc_alarm"):
                both(function)
            for kind, first, last in ((0, 4, 15), (1, 0, 11), (1, 94, 106)):
                both("pmc_rdpmcrng", kind, 0, first, last, 9 + last - first)
            if name in ("a program is held", "jogging", "an alarm"):
                for kind, letter in enumerate(LETTERS):
                    for low, high in AREAS[letter]:
                        for data_type, size in ((0, 1), (1, 2), (2, 4)):
                            for at in (low, high - size + 1, high - size + 2, low - 1):
                                block = bytes((kind, 0, data_type, 0)) + at.to_bytes(2, "little", signed=True)
                                block += (at + size - 1).to_bytes(2, "little", signed=True)
                                if letter != "G" and at in (low, high - size + 1):
                                    code = b.library.pmc_wrpmcrng(
                                        remote,
                                        8 + size,
                                        block + bytes((0x81 + at + kind & 0xFF, 7, 0, 0x90)[:size]),
                                    )
                                    if code:
                                        b.lines.append(
                                            f"{letter}{at} {data_type} is not written: {fwlib.EW(code).name}"
                                        )
                                both("pmc_rdpmcrng", kind, data_type, at, at + size - 1, 8 + size)
            b.library.cnc_freelibhndl(remote)


SCENES = (faults, over_the_network)
