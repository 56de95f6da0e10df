"""Structures of the history, axis motion, status, panel and PMC functions (Manual 000), packed as its diagrams show.

Arrays whose length the manual leaves open (N) have one for the table; what a function returns has as many as were read.
"""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

import ctypes
from functools import cache
from typing import Annotated, Any

from polycnc.controllers.fanuc.library._codes import MAX_AXIS
from polycnc.controllers.fanuc.library._structs_a import SChars
from polycnc.controllers.library import (
    CHAR,
    LONG,
    SHORT,
    UCHAR,
    USHORT,
    Chars,
    Longs,
    Number,
    Shorts,
    Structure,
    Texts,
    Times,
    UChars,
    Union,
    structure,
)

MSG_SIZE = 256
HISTORY_SIGNALS = 20
PMC_ITEMS = 256
MODAL_GROUPS = 21
MODAL_ADDRESSES = 27


# ---------------------------------------------------------------------- histories


@structure(pack=2)
class REC_ALM(Structure):
    """An alarm in the operation history."""

    rec_type: SHORT
    alm_grp: SHORT
    alm_no: SHORT
    axis_no: CHAR
    dummy: CHAR


@structure(pack=2)
class REC_MDI(Structure):
    """A key in the operation history."""

    rec_type: SHORT
    key_code: UCHAR
    pw_flag: CHAR
    dummy: Annotated[SChars, Times(4)]


@structure(pack=2)
class REC_SGN(Structure):
    """A change of a signal in the operation history."""

    rec_type: SHORT
    sig_name: CHAR
    sig_old: UCHAR
    sig_new: UCHAR
    dummy: CHAR
    sig_no: SHORT


@structure(pack=2)
class REC_DATE(Structure):
    """A date in the operation history."""

    rec_type: SHORT
    year: CHAR
    month: CHAR
    day: CHAR
    pw_flag: CHAR
    dummy: Annotated[SChars, Times(2)]


@structure(pack=2)
class REC_TIME(Structure):
    """A time in the operation history."""

    rec_type: SHORT
    hour: CHAR
    minute: CHAR
    second: CHAR
    pw_flag: CHAR
    dummy: Annotated[SChars, Times(2)]


@structure(pack=2)
class ODBHIS_DATA(Union):
    """A record of the operation history; all kinds begin with `rec_type`."""

    rec_alm: REC_ALM
    rec_mdi: REC_MDI
    rec_sgn: REC_SGN
    rec_date: REC_DATE
    rec_time: REC_TIME


@structure(pack=2)
class ODBHIS(Structure):
    """Records of the operation history."""

    s_no: USHORT
    type: SHORT
    e_no: USHORT
    data: Annotated[ctypes.Array[ODBHIS_DATA], Times(1)]


@structure(pack=2)
class ALM_HIS(Structure):
    """A record of the alarm history."""

    dummy: SHORT
    alm_grp: SHORT
    alm_no: SHORT
    axis_no: CHAR
    year: CHAR
    month: CHAR
    day: CHAR
    hour: CHAR
    minute: CHAR
    second: CHAR
    dummy2: CHAR
    len_msg: SHORT
    alm_msg: Annotated[Chars, Times(32)]


@structure(pack=2)
class ODBAHIS(Structure):
    """Records of the alarm history."""

    s_no: USHORT
    type: SHORT
    e_no: USHORT
    alm_his: Annotated[ctypes.Array[ALM_HIS], Times(1)]


@structure(pack=2)
class IODBSIG_DATA(Structure):
    """A signal whose changes are noted."""

    ent_no: SHORT
    sig_no: SHORT
    sig_name: CHAR
    mask_pat: UCHAR


@structure(pack=2)
class IODBSIG(Structure):
    """The signals whose changes are noted."""

    datano: SHORT
    type: SHORT
    data: Annotated[ctypes.Array[IODBSIG_DATA], Times(HISTORY_SIGNALS)]


# ---------------------------------------------------------------------- axis motion


@structure(pack=2)
class ODBOPDI_u(Union):
    """The value of an operation signal."""

    cdata: UCHAR
    idata: SHORT
    ldata: LONG


@structure(pack=2)
class ODBOPDI(Structure):
    """An operation signal."""

    axis: SHORT
    u: ODBOPDI_u


@structure(pack=2)
class ODBPOS(Structure):
    """An axis, and a coordinate, a distance or a time."""

    idata: SHORT
    ldata: LONG


@structure(pack=2)
class ODBEXEC(Structure):
    """The state of the execution buffers: `cdata[0]` of the first, `cdata[1]` of the second ones."""

    dummy: SHORT
    cdata: Annotated[Any, Number("char", ctypes.c_uint8), Times(2, 8)]


@structure(pack=2)
class ODBFIN(Structure):
    """Completion flags by path."""

    dummy: SHORT
    cdata: Annotated[UChars, Times(8)]


# ---------------------------------------------------------------------- what the control is


@structure(pack=2)
class ODBSYS(Structure):
    """Kind, software and axes of the control; no text ends in a zero."""

    dummy: SHORT
    max_axis: SHORT
    cnc_type: Annotated[Chars, Times(2)]
    mt_type: Annotated[Chars, Times(2)]
    series: Annotated[Chars, Times(4)]
    version: Annotated[Chars, Times(4)]
    axes: Annotated[Chars, Times(2)]


@structure(pack=2)
class ODBSYSC(Structure):
    """Software, memory modules and boards of the control. The manual calls both spare arrays `dummy`."""

    slot_no_p: Annotated[SChars, Times(16)]
    slot_no_l: Annotated[SChars, Times(16)]
    mod_id: Annotated[Shorts, Times(16)]
    soft_id: Annotated[Shorts, Times(16)]
    s_series: Annotated[Texts, Times(16, 5)]
    s_version: Annotated[Texts, Times(16, 5)]
    dummy1: Annotated[SChars, Times(16)]
    m_rom: SHORT
    s_rom: SHORT
    svo_soft: Annotated[Chars, Times(8)]
    pmc_soft: Annotated[Chars, Times(6)]
    lad_soft: Annotated[Chars, Times(6)]
    mcr_soft: Annotated[UChars, Times(8)]
    spl1_soft: Annotated[Chars, Times(6)]
    spl2_soft: Annotated[Chars, Times(6)]
    frmmin: SHORT
    drmmin: SHORT
    srmmin: SHORT
    pmcmin: SHORT
    sv1min: SHORT
    sv3min: SHORT
    sv5min: SHORT
    sicmin: SHORT
    posmin: SHORT
    submin: SHORT
    hdiio: SHORT
    dummy2: Annotated[Shorts, Times(32)]


@structure(pack=2)
class ODBST(Structure):
    """The state of the control."""

    dummy: Annotated[Shorts, Times(2)]
    aut: SHORT
    run: SHORT
    motion: SHORT
    mstb: SHORT
    emergency: SHORT
    alarm: SHORT
    edit: SHORT


@structure(pack=2)
class ODBALM(Structure):
    """The alarm groups, as bits of a signed number."""

    dummy: Annotated[Shorts, Times(2)]
    data: SHORT


@structure(pack=2)
class ALM1(Structure):
    """An alarm without its text."""

    axis: SHORT
    alm_no: SHORT


@structure(pack=2)
class ALM2(Structure):
    """An alarm with its text."""

    axis: SHORT
    alm_no: SHORT
    msg_len: SHORT
    alm_msg: Annotated[Chars, Times(32)]


def _structure(name: str, base: type, like: type | None = None, **elements: Any) -> Any:
    """Return a structure whose elements are known only now."""
    made: Any = structure(pack=2)(
        type(name, (base,), {"__annotations__": elements, "__module__": __name__, "__doc__": f"{name}."})
    )
    if like is not None:
        made.variant_of = like
    return made


@cache
def alminfo(alarms: int, like: type | None = None) -> Any:
    """Return the structure of cnc_rdalminfo for a number of alarms; the end mark stands behind them."""
    first = _structure(
        "ALMINFO_1", Structure, alm=Annotated[ctypes.Array[ALM1], Times(alarms)], data_end=SHORT
    )
    second = _structure(
        "ALMINFO_2", Structure, alm=Annotated[ctypes.Array[ALM2], Times(alarms)], data_end=SHORT
    )
    both = _structure("ALMINFO_u", Union, alm1=first, alm2=second)
    return _structure("ALMINFO", Structure, like, u=both)


ALMINFO: Any = alminfo(1)


@structure(pack=2)
class MODAL_AUX(Structure):
    """The value of an address or axis and what is known about it."""

    aux_data: LONG
    flag1: UCHAR
    flag2: UCHAR


@structure(pack=2)
class ODBMDL_u(Union):
    """Modal data of one kind or of all."""

    g_data: UCHAR
    g_rdata: Annotated[UChars, Times(MODAL_GROUPS)]
    aux: MODAL_AUX
    raux1: Annotated[ctypes.Array[MODAL_AUX], Times(MODAL_ADDRESSES)]
    raux2: Annotated[ctypes.Array[MODAL_AUX], Times(MAX_AXIS)]


@structure(pack=2)
class ODBMDL(Structure):
    """Modal data."""

    datano: SHORT
    type: SHORT
    modal: ODBMDL_u


@structure(pack=2)
class ODBDGN_u(Union):
    """A diagnosis value, or those of all axes."""

    cdata: CHAR
    idata: SHORT
    ldata: LONG
    cdatas: Annotated[SChars, Times(MAX_AXIS)]
    idatas: Annotated[Shorts, Times(MAX_AXIS)]
    ldatas: Annotated[Longs, Times(MAX_AXIS)]


@structure(pack=2)
class ODBDGN(Structure):
    """Diagnosis data of one number."""

    datano: SHORT
    type: SHORT
    u: ODBDGN_u


@structure(pack=2)
class OPMSG(Structure):
    """A message to the operator; the text ends in a zero."""

    datano: SHORT
    type: SHORT
    char_num: SHORT
    data: Annotated[Chars, Times(MSG_SIZE)]


# ---------------------------------------------------------------------- software operator's panel


@structure(pack=2)
class IODBSGNL(Structure):
    """Signals of the software operator's panel; `type` says which."""

    datano: SHORT
    type: SHORT
    mode: SHORT
    hndl_ax: SHORT
    hndl_mv: SHORT
    rpd_ovrd: SHORT
    jog_ovrd: SHORT
    feed_ovrd: SHORT
    spdl_ovrd: SHORT
    blck_del: SHORT
    sngl_blck: SHORT
    machn_lock: SHORT
    dry_run: SHORT
    mem_prtct: SHORT
    feed_hold: SHORT


@structure(pack=1)
class IODBGNRL(Structure):
    """General-purpose signals of the software operator's panel; `type` says which."""

    datano: SHORT
    type: SHORT
    sgnal: UCHAR


@structure(pack=1)
class IODBRDNA(Structure):
    """Names of the general-purpose signals; `type` says which."""

    datano: SHORT
    type: SHORT
    sgnl1_name: Annotated[Chars, Times(9)]
    sgnl2_name: Annotated[Chars, Times(9)]
    sgnl3_name: Annotated[Chars, Times(9)]
    sgnl4_name: Annotated[Chars, Times(9)]
    sgnl5_name: Annotated[Chars, Times(9)]
    sgnl6_name: Annotated[Chars, Times(9)]
    sgnl7_name: Annotated[Chars, Times(9)]
    sgnl8_name: Annotated[Chars, Times(9)]


# ---------------------------------------------------------------------- PMC


@cache
def iodbpmc(items: int, like: type | None = None) -> Any:
    """Return the structure of the PMC functions for a number of items."""
    data = _structure(
        "IODBPMC_u",
        Union,
        cdata=Annotated[SChars, Times(items)],
        idata=Annotated[Shorts, Times(items)],
        ldata=Annotated[Longs, Times(items)],
    )
    return _structure(
        "IODBPMC", Structure, like, type_a=SHORT, type_d=SHORT, datano_s=SHORT, datano_e=SHORT, u=data
    )


IODBPMC: Any = iodbpmc(PMC_ITEMS)


@structure(pack=2)
class PMCINF(Structure):
    """A range of PMC addresses; bit 7 of `adr_attr` forbids to write."""

    pmc_adr: UCHAR
    adr_attr: UCHAR
    top_num: USHORT
    last_num: USHORT


@structure(pack=2)
class ODBPMCINF(Structure):
    """The ranges of PMC addresses."""

    datano: SHORT
    info: Annotated[ctypes.Array[PMCINF], Times(64)]


STRUCTURES_B = (
    ODBHIS, ODBAHIS, IODBSIG, ODBOPDI, ODBPOS, ODBEXEC, ODBFIN, ODBSYS, ODBSYSC, ODBST, ODBALM, ALMINFO, ODBMDL,
    ODBDGN, OPMSG, IODBSGNL, IODBGNRL, IODBRDNA, IODBPMC, ODBPMCINF,
)  # fmt: skip

__all__ = [
    "ALMINFO",
    "IODBGNRL",
    "IODBPMC",
    "IODBRDNA",
    "IODBSGNL",
    "IODBSIG",
    "MSG_SIZE",
    "ODBAHIS",
    "ODBALM",
    "ODBDGN",
    "ODBEXEC",
    "ODBFIN",
    "ODBHIS",
    "ODBMDL",
    "ODBOPDI",
    "ODBPMCINF",
    "ODBPOS",
    "ODBST",
    "ODBSYS",
    "ODBSYSC",
    "OPMSG",
]
