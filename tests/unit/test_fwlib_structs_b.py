"""Where the elements of structures lie: history, motion, state, panel and PMC functions, from the diagrams."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import pytest

from polycnc.conformance import read_rows
from polycnc.controllers.fanuc import fwlib
from support.c_elements import is_signed

ROWS = read_rows(Path(__file__).resolve().parents[2] / "conformance")

# fmt: off
PLACES = [
    ("ODBHIS.s_no", "ODBHIS", "s_no", 0, 2),
    ("ODBHIS.type", "ODBHIS", "type", 2, 2),
    ("ODBHIS.e_no", "ODBHIS", "e_no", 4, 2),
    ("ODBHIS.rec_type", "ODBHIS", "data.rec_alm.rec_type", 6, 2),
    ("ODBHIS.alm_grp", "ODBHIS", "data.rec_alm.alm_grp", 8, 2),
    ("ODBHIS.alm_no", "ODBHIS", "data.rec_alm.alm_no", 10, 2),
    ("ODBHIS.axis_no", "ODBHIS", "data.rec_alm.axis_no", 12, 1),
    ("ODBHIS.key_code", "ODBHIS", "data.rec_mdi.key_code", 8, 1),
    ("ODBHIS.pw_flag", "ODBHIS", "data.rec_mdi.pw_flag", 9, 1),
    ("ODBHIS.pw_flag", "ODBHIS", "data.rec_date.pw_flag", 11, 1),
    ("ODBHIS.pw_flag", "ODBHIS", "data.rec_time.pw_flag", 11, 1),
    ("ODBHIS.sig_name", "ODBHIS", "data.rec_sgn.sig_name", 8, 1),
    ("ODBHIS.sig_old", "ODBHIS", "data.rec_sgn.sig_old", 9, 1),
    ("ODBHIS.sig_new", "ODBHIS", "data.rec_sgn.sig_new", 10, 1),
    ("ODBHIS.sig_no", "ODBHIS", "data.rec_sgn.sig_no", 12, 2),
    ("ODBHIS.year", "ODBHIS", "data.rec_date.year", 8, 1),
    ("ODBHIS.month", "ODBHIS", "data.rec_date.month", 9, 1),
    ("ODBHIS.day", "ODBHIS", "data.rec_date.day", 10, 1),
    ("ODBHIS.hour", "ODBHIS", "data.rec_time.hour", 8, 1),
    ("ODBHIS.minute", "ODBHIS", "data.rec_time.minute", 9, 1),
    ("ODBHIS.second", "ODBHIS", "data.rec_time.second", 10, 1),
    ("ODBAHIS.s_no", "ODBAHIS", "s_no", 0, 2),
    ("ODBAHIS.type", "ODBAHIS", "type", 2, 2),
    ("ODBAHIS.e_no", "ODBAHIS", "e_no", 4, 2),
    ("ODBAHIS.alm_his.dummy", "ODBAHIS", "alm_his.dummy", 6, 2),
    ("ODBAHIS.alm_his.alm_grp", "ODBAHIS", "alm_his.alm_grp", 8, 2),
    ("ODBAHIS.alm_his.alm_no", "ODBAHIS", "alm_his.alm_no", 10, 2),
    ("ODBAHIS.alm_his.axis_no", "ODBAHIS", "alm_his.axis_no", 12, 1),
    ("ODBAHIS.alm_his.year", "ODBAHIS", "alm_his.year", 13, 1),
    ("ODBAHIS.alm_his.month", "ODBAHIS", "alm_his.month", 14, 1),
    ("ODBAHIS.alm_his.day", "ODBAHIS", "alm_his.day", 15, 1),
    ("ODBAHIS.alm_his.hour", "ODBAHIS", "alm_his.hour", 16, 1),
    ("ODBAHIS.alm_his.minute", "ODBAHIS", "alm_his.minute", 17, 1),
    ("ODBAHIS.alm_his.second", "ODBAHIS", "alm_his.second", 18, 1),
    ("ODBAHIS.alm_his.dummy2", "ODBAHIS", "alm_his.dummy2", 19, 1),
    ("ODBAHIS.alm_his.len_msg", "ODBAHIS", "alm_his.len_msg", 20, 2),
    ("ODBAHIS.alm_his.alm_msg", "ODBAHIS", "alm_his.alm_msg", 22, 32),
    ("IODBSIG.datano", "IODBSIG", "datano", 0, 2),
    ("IODBSIG.type", "IODBSIG", "type", 2, 2),
    ("IODBSIG.data.ent_no", "IODBSIG", "data.ent_no", 4, 2),
    ("IODBSIG.data.sig_no", "IODBSIG", "data.sig_no", 6, 2),
    ("IODBSIG.data.sig_name", "IODBSIG", "data.sig_name", 8, 1),
    ("IODBSIG.data.mask_pat", "IODBSIG", "data.mask_pat", 9, 1),
    ("ODBOPDI.axis", "ODBOPDI", "axis", 0, 2),
    ("ODBOPDI.u.cdata", "ODBOPDI", "u.cdata", 2, 1),
    ("ODBOPDI.u.idata", "ODBOPDI", "u.idata", 2, 2),
    ("ODBOPDI.u.ldata", "ODBOPDI", "u.ldata", 2, 4),
    ("ODBEXEC.dummy", "ODBEXEC", "dummy", 0, 2),
    ("ODBEXEC.cdata", "ODBEXEC", "cdata", 2, 16),
    ("ODBFIN.dummy", "ODBFIN", "dummy", 0, 2),
    ("ODBFIN.cdata", "ODBFIN", "cdata", 2, 8),
    ("ODBPOS.idata", "ODBPOS", "idata", 0, 2),
    ("ODBPOS.ldata", "ODBPOS", "ldata", 2, 4),
    ("ODBSYS.dummy", "ODBSYS", "dummy", 0, 2),
    ("ODBSYS.max_axis", "ODBSYS", "max_axis", 2, 2),
    ("ODBSYS.cnc_type", "ODBSYS", "cnc_type", 4, 2),
    ("ODBSYS.mt_type", "ODBSYS", "mt_type", 6, 2),
    ("ODBSYS.series", "ODBSYS", "series", 8, 4),
    ("ODBSYS.version", "ODBSYS", "version", 12, 4),
    ("ODBSYS.axes", "ODBSYS", "axes", 16, 2),
    ("ODBSYSC.slot_no_p", "ODBSYSC", "slot_no_p", 0, 16),
    ("ODBSYSC.slot_no_l", "ODBSYSC", "slot_no_l", 16, 16),
    ("ODBSYSC.mod_id", "ODBSYSC", "mod_id", 32, 32),
    ("ODBSYSC.soft_id", "ODBSYSC", "soft_id", 64, 32),
    ("ODBSYSC.s_series", "ODBSYSC", "s_series", 96, 80),
    ("ODBSYSC.s_version", "ODBSYSC", "s_version", 176, 80),
    ("ODBSYSC.dummy1", "ODBSYSC", "dummy1", 256, 16),
    ("ODBSYSC.m_rom", "ODBSYSC", "m_rom", 272, 2),
    ("ODBSYSC.s_rom", "ODBSYSC", "s_rom", 274, 2),
    ("ODBSYSC.svo_soft", "ODBSYSC", "svo_soft", 276, 8),
    ("ODBSYSC.pmc_soft", "ODBSYSC", "pmc_soft", 284, 6),
    ("ODBSYSC.lad_soft", "ODBSYSC", "lad_soft", 290, 6),
    ("ODBSYSC.mcr_soft", "ODBSYSC", "mcr_soft", 296, 8),
    ("ODBSYSC.spl1_soft", "ODBSYSC", "spl1_soft", 304, 6),
    ("ODBSYSC.spl2_soft", "ODBSYSC", "spl2_soft", 310, 6),
    ("ODBSYSC.frmmin", "ODBSYSC", "frmmin", 316, 2),
    ("ODBSYSC.drmmin", "ODBSYSC", "drmmin", 318, 2),
    ("ODBSYSC.srmmin", "ODBSYSC", "srmmin", 320, 2),
    ("ODBSYSC.pmcmin", "ODBSYSC", "pmcmin", 322, 2),
    ("ODBSYSC.sv1min", "ODBSYSC", "sv1min", 324, 2),
    ("ODBSYSC.sv3min", "ODBSYSC", "sv3min", 326, 2),
    ("ODBSYSC.sv5min", "ODBSYSC", "sv5min", 328, 2),
    ("ODBSYSC.sicmin", "ODBSYSC", "sicmin", 330, 2),
    ("ODBSYSC.posmin", "ODBSYSC", "posmin", 332, 2),
    ("ODBSYSC.submin", "ODBSYSC", "submin", 334, 2),
    ("ODBSYSC.hdiio", "ODBSYSC", "hdiio", 336, 2),
    ("ODBSYSC.dummy2", "ODBSYSC", "dummy2", 338, 64),
    ("ODBST.dummy", "ODBST", "dummy", 0, 4),
    ("ODBST.aut", "ODBST", "aut", 4, 2),
    ("ODBST.run", "ODBST", "run", 6, 2),
    ("ODBST.motion", "ODBST", "motion", 8, 2),
    ("ODBST.mstb", "ODBST", "mstb", 10, 2),
    ("ODBST.emergency", "ODBST", "emergency", 12, 2),
    ("ODBST.alarm", "ODBST", "alarm", 14, 2),
    ("ODBST.edit", "ODBST", "edit", 16, 2),
    ("ODBALM.dummy", "ODBALM", "dummy", 0, 4),
    ("ODBALM.data", "ODBALM", "data", 4, 2),
    ("ALMINFO.alm.axis", "ALMINFO", "u.alm1.alm.axis", 0, 2),
    ("ALMINFO.alm.axis", "ALMINFO", "u.alm2.alm.axis", 0, 2),
    ("ALMINFO.alm.alm_no", "ALMINFO", "u.alm1.alm.alm_no", 2, 2),
    ("ALMINFO.alm.alm_no", "ALMINFO", "u.alm2.alm.alm_no", 2, 2),
    ("ALMINFO.alm.msg_len", "ALMINFO", "u.alm2.alm.msg_len", 4, 2),
    ("ALMINFO.alm.alm_msg", "ALMINFO", "u.alm2.alm.alm_msg", 6, 32),
    ("ALMINFO.data_end", "ALMINFO", "u.alm1.data_end", 4, 2),
    ("ALMINFO.data_end", "ALMINFO", "u.alm2.data_end", 38, 2),
    ("ODBMDL.datano", "ODBMDL", "datano", 0, 2),
    ("ODBMDL.type", "ODBMDL", "type", 2, 2),
    ("ODBMDL.g_data", "ODBMDL", "modal.g_data", 4, 1),
    ("ODBMDL.g_rdata", "ODBMDL", "modal.g_rdata", 4, 21),
    ("ODBMDL.aux.aux_data", "ODBMDL", "modal.aux.aux_data", 4, 4),
    ("ODBMDL.aux.flag1", "ODBMDL", "modal.aux.flag1", 8, 1),
    ("ODBMDL.aux.flag2", "ODBMDL", "modal.aux.flag2", 9, 1),
    ("ODBMDL.raux1", "ODBMDL", "modal.raux1", 4, 162),
    ("ODBMDL.raux2", "ODBMDL", "modal.raux2", 4, 36),
    ("ODBDGN.datano", "ODBDGN", "datano", 0, 2),
    ("ODBDGN.type", "ODBDGN", "type", 2, 2),
    ("ODBDGN.u.cdata", "ODBDGN", "u.cdata", 4, 1),
    ("ODBDGN.u.idata", "ODBDGN", "u.idata", 4, 2),
    ("ODBDGN.u.ldata", "ODBDGN", "u.ldata", 4, 4),
    ("ODBDGN.u.cdatas", "ODBDGN", "u.cdatas", 4, 6),
    ("ODBDGN.u.idatas", "ODBDGN", "u.idatas", 4, 12),
    ("ODBDGN.u.ldatas", "ODBDGN", "u.ldatas", 4, 24),
    ("OPMSG.datano", "OPMSG", "datano", 0, 2),
    ("OPMSG.type", "OPMSG", "type", 2, 2),
    ("OPMSG.char_num", "OPMSG", "char_num", 4, 2),
    ("OPMSG.data", "OPMSG", "data", 6, 256),
    ("IODBSGNL.datano", "IODBSGNL", "datano", 0, 2),
    ("IODBSGNL.type", "IODBSGNL", "type", 2, 2),
    ("IODBSGNL.mode", "IODBSGNL", "mode", 4, 2),
    ("IODBSGNL.hndl_ax", "IODBSGNL", "hndl_ax", 6, 2),
    ("IODBSGNL.hndl_mv", "IODBSGNL", "hndl_mv", 8, 2),
    ("IODBSGNL.rpd_ovrd", "IODBSGNL", "rpd_ovrd", 10, 2),
    ("IODBSGNL.jog_ovrd", "IODBSGNL", "jog_ovrd", 12, 2),
    ("IODBSGNL.feed_ovrd", "IODBSGNL", "feed_ovrd", 14, 2),
    ("IODBSGNL.spdl_ovrd", "IODBSGNL", "spdl_ovrd", 16, 2),
    ("IODBSGNL.blck_del", "IODBSGNL", "blck_del", 18, 2),
    ("IODBSGNL.sngl_blck", "IODBSGNL", "sngl_blck", 20, 2),
    ("IODBSGNL.machn_lock", "IODBSGNL", "machn_lock", 22, 2),
    ("IODBSGNL.dry_run", "IODBSGNL", "dry_run", 24, 2),
    ("IODBSGNL.mem_prtct", "IODBSGNL", "mem_prtct", 26, 2),
    ("IODBSGNL.feed_hold", "IODBSGNL", "feed_hold", 28, 2),
    ("IODBGNRL.datano", "IODBGNRL", "datano", 0, 2),
    ("IODBGNRL.type", "IODBGNRL", "type", 2, 2),
    ("IODBGNRL.sgnal", "IODBGNRL", "sgnal", 4, 1),
    ("IODBRDNA.datano", "IODBRDNA", "datano", 0, 2),
    ("IODBRDNA.type", "IODBRDNA", "type", 2, 2),
    ("IODBRDNA.sgnl1_name", "IODBRDNA", "sgnl1_name", 4, 9),
    ("IODBRDNA.sgnl2_name", "IODBRDNA", "sgnl2_name", 13, 9),
    ("IODBRDNA.sgnl3_name", "IODBRDNA", "sgnl3_name", 22, 9),
    ("IODBRDNA.sgnl4_name", "IODBRDNA", "sgnl4_name", 31, 9),
    ("IODBRDNA.sgnl5_name", "IODBRDNA", "sgnl5_name", 40, 9),
    ("IODBRDNA.sgnl6_name", "IODBRDNA", "sgnl6_name", 49, 9),
    ("IODBRDNA.sgnl7_name", "IODBRDNA", "sgnl7_name", 58, 9),
    ("IODBRDNA.sgnl8_name", "IODBRDNA", "sgnl8_name", 67, 9),
    ("IODBPMC.type_a", "IODBPMC", "type_a", 0, 2),
    ("IODBPMC.type_d", "IODBPMC", "type_d", 2, 2),
    ("IODBPMC.datano_s", "IODBPMC", "datano_s", 4, 2),
    ("IODBPMC.datano_e", "IODBPMC", "datano_e", 6, 2),
    ("IODBPMC.u", "IODBPMC", "u", 8, 1024),
    ("ODBPMCINF.datano", "ODBPMCINF", "datano", 0, 2),
    ("ODBPMCINF.info.pmc_adr", "ODBPMCINF", "info.pmc_adr", 2, 1),
    ("ODBPMCINF.info.adr_attr", "ODBPMCINF", "info.adr_attr", 3, 1),
    ("ODBPMCINF.info.top_num", "ODBPMCINF", "info.top_num", 4, 2),
    ("ODBPMCINF.info.last_num", "ODBPMCINF", "info.last_num", 6, 2),
    ("ODBHIS.rec_alm.dummy", "ODBHIS", "data.rec_alm.dummy", 13, 1),
    ("ODBHIS.rec_mdi.dummy", "ODBHIS", "data.rec_mdi.dummy", 10, 4),
    ("ODBHIS.rec_sgn.dummy", "ODBHIS", "data.rec_sgn.dummy", 11, 1),
    ("ODBHIS.rec_date.dummy", "ODBHIS", "data.rec_date.dummy", 12, 2),
    ("ODBHIS.rec_time.dummy", "ODBHIS", "data.rec_time.dummy", 12, 2),
    ("ODBMDL.aux", "ODBMDL", "modal.aux", 4, 6),
    ("IODBPMC.u.cdata", "IODBPMC", "u.cdata", 8, 256),
    ("IODBPMC.u.idata", "IODBPMC", "u.idata", 8, 512),
    ("IODBPMC.u.ldata", "IODBPMC", "u.ldata", 8, 1024),
    ("ODBHIS.rec_alm", "ODBHIS", "data.rec_alm", 6, 8),
    ("ODBHIS.rec_mdi", "ODBHIS", "data.rec_mdi", 6, 8),
    ("ODBHIS.rec_sgn", "ODBHIS", "data.rec_sgn", 6, 8),
    ("ODBHIS.rec_date", "ODBHIS", "data.rec_date", 6, 8),
    ("ODBHIS.rec_time", "ODBHIS", "data.rec_time", 6, 8),
]
SIZES = {
    "ODBHIS": 14, "ODBAHIS": 54, "IODBSIG": 124, "ODBOPDI": 6, "ODBEXEC": 18, "ODBFIN": 10,
    "ODBPOS": 6, "ODBSYS": 18, "ODBSYSC": 402, "ODBST": 18, "ODBALM": 6, "ALMINFO": 40,
    "ODBMDL": 166, "ODBDGN": 28, "OPMSG": 262, "IODBSGNL": 30, "IODBGNRL": 5, "IODBRDNA": 76,
    "IODBPMC": 1032, "ODBPMCINF": 386,
}
# fmt: on
"""Of structures with an open number of elements the size with one; the PMC's has 256 longs."""


def place(name: str, path: str) -> tuple[int, int]:
    """Return offset and size of an element; in arrays of structures that of the first."""
    kind: Any = getattr(fwlib, name)
    offset = size = 0
    for step in path.split("."):
        while issubclass(kind, ctypes.Array):
            kind = kind._type_
        field = getattr(kind, step)
        offset, size = offset + field.offset, field.size
        kind = dict(kind._fields_)[step]
    return offset, size


@pytest.mark.parametrize(
    ("row", "name", "path", "offset", "size"),
    [
        pytest.param(row, *each, marks=pytest.mark.covers(f"fanuc.{row}"), id=f"{row}-{each[1]}")
        for row, *each in PLACES
    ],
)
@pytest.mark.covers("fanuc.concept.c_types", "fanuc.concept.struct_packing", "fanuc.common.types")
def test_an_element_lies_where_the_diagram_shows_it(
    row: str, name: str, path: str, offset: int, size: int
) -> None:
    assert place(name, path) == (offset, size)
    printed = ROWS[f"fanuc.{row}"].signature
    if printed.startswith(("short", "long", "unsigned")):
        assert is_signed(getattr(fwlib, name), path) is not printed.startswith("unsigned")


@pytest.mark.parametrize(
    ("name", "size"),
    [
        pytest.param(name, size, marks=pytest.mark.covers(f"fanuc.{name}"), id=name)
        for name, size in SIZES.items()
    ],
)
@pytest.mark.covers("fanuc.concept.struct_packing", "fanuc.common.types")
def test_a_structure_is_as_long_as_the_manual_says(name: str, size: int) -> None:
    assert fwlib.STRUCTURES[name].size == ctypes.sizeof(getattr(fwlib, name)) == size


@pytest.mark.covers(
    "fanuc.common.types", "fanuc.MSG_SIZE", "fanuc.common.MAX_AXIS2", "fanuc.common.ALL_AXES2"
)
@pytest.mark.covers("fanuc.concept.c_types", "fanuc.concept.struct_packing")
def test_no_element_is_moved_to_an_even_or_whole_address() -> None:
    assert place("ODBPOS", "ldata") == (2, 4)
    assert place("ODBAHIS", "alm_his.dummy2") == (19, 1)
    assert (fwlib.MSG_SIZE, fwlib.MAX_AXIS, fwlib.ALL_AXES) == (256, 6, -1)
