"""The functions of the library's second half have the manual's prototypes, and take any handle that was opened."""

from __future__ import annotations

import functools
import re

import pytest

from polycnc.conformance import Row, load_conformance
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW

NAMES = (
    "cnc_stopophis", "cnc_startophis", "cnc_rdophisno", "cnc_rdophistry", "cnc_rdalmhisno", "cnc_rdalmhistry",
    "cnc_clearophis", "cnc_rdhissgnl", "cnc_wrhissgnl", "cnc_opdi", "cnc_refpoint", "cnc_abspoint", "cnc_incpoint",
    "cnc_dwell", "cnc_coordre", "cnc_exebufstat", "cnc_finstate", "cnc_setfin", "cnc_sysinfo", "cnc_sysconfig",
    "cnc_statinfo", "cnc_alarm", "cnc_rdalminfo", "cnc_modal", "cnc_diagnoss", "cnc_diagnosr", "cnc_getfigure",
    "cnc_rdcurrent", "cnc_rdsrvspeed", "cnc_rdloopgain", "cnc_rdopmsg", "cnc_rdopnlsgnl", "cnc_wropnlsgnl",
    "cnc_rdopnlgnrl", "cnc_wropnlgnrl", "cnc_rdopnlgsname", "cnc_wropnlgsname", "pmc_rdpmcrng", "pmc_wrpmcrng",
    "pmc_rdpmcinfo",
)  # fmt: skip


@functools.cache
def _rows() -> dict[str, Row]:
    return {row.id: row for row in load_conformance().rows("fanuc")}


@pytest.mark.covers("fanuc.common.decl")
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.covers("fanuc.concept.function_index", "fanuc.concept.header_and_linkage")
def test_a_prototype_is_the_manuals(name: str) -> None:
    row = _rows()[f"fanuc.{name}"]
    printed = re.sub(r"FWLIBAPI |WINAPI |;", "", row.signature)
    if name == "cnc_rdcurrent":
        printed = printed.replace("short *crrnt", "long *crrnt")  # as its sample and the header have it
    assert fwlib.FUNCTIONS[name].prototype == re.sub(r"\s+", " ", printed).strip()


@pytest.mark.covers("fanuc.common.handle2")
@pytest.mark.covers("fanuc.concept.handle_lifecycle")
def test_every_function_wants_an_open_handle_first() -> None:
    session = fwlib.Session()
    session.attach(0, PowerMate())
    _, handle = session.cnc_allclibhndl()
    assert session.cnc_statinfo(handle)[0] is EW.EW_OK
    session.cnc_freelibhndl(handle)
    for name in NAMES:
        function = fwlib.FUNCTIONS[name]
        first = function.arguments[0]
        assert (first.name, first.c) == ("FlibHndl", "unsigned short")
    assert session.cnc_statinfo(handle)[0] is EW.EW_HANDLE
    assert session.pmc_rdpmcinfo(handle, -1)[0] is EW.EW_HANDLE


@pytest.mark.covers("fanuc.common.allmode")
@pytest.mark.parametrize("mode", ["MDI", "MEM", "EDIT", "HND", "JOG", "T-JOG", "T-HND", "INC", "REF", "RMT"])
@pytest.mark.covers("fanuc.concept.mode_matrix")
def test_functions_are_there_in_every_mode(mode: str) -> None:
    control = PowerMate()
    control.select_mode(mode)
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    block = bytes(fwlib.ODBPOS(idata=1, ldata=700))
    codes = [
        session.cnc_incpoint(handle, 1, 0, 1, 3000, block)[0],
        session.cnc_exebufstat(handle)[0],
        session.cnc_modal(handle, -1, 0)[0],
        session.cnc_diagnoss(handle, 30, 0, 6)[0],
        session.cnc_rdopmsg(handle, 0, 262)[0],
        session.cnc_rdopnlsgnl(handle, 0x1FB9)[0],
        session.pmc_rdpmcrng(handle, 9, 0, 5, 5, 9)[0],
        session.cnc_stopophis(handle),
        session.cnc_rdalmhisno(handle)[0],
    ]
    assert codes == [EW.EW_OK] * 9
    control.advance(1000)
    assert control.positions.read()[0].machine == 700
