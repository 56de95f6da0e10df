"""Structures of the handle, axis, program and data file functions (Manual 000), as the diagrams show them.

They are packed to 2 bytes: a `long` may lie at an address that 4 does not divide. Arrays whose length the manual
leaves open have the number of its samples; what a function returns is as long as what was read.
"""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

import ctypes
from typing import Annotated

from polycnc.controllers.fanuc.library._codes import MAX_AXIS, MAX_PBUF, MAX_RBUF
from polycnc.controllers.library import CHAR as _CHAR
from polycnc.controllers.library import (
    LONG,
    SHORT,
    USHORT,
    Chars,
    Longs,
    Number,
    Shorts,
    Structure,
    Times,
    Union,
    structure,
)

MAX_OFFSETS = 99
MAX_MACROS = 500
MAX_INFO = 100

SChars = Annotated[ctypes.Array[ctypes.c_int8], Number("char", ctypes.c_int8)]


@structure(pack=2)
class ODBACT(Structure):
    """Actual feed."""

    dummy: Annotated[Shorts, Times(2)]
    data: LONG


@structure(pack=2)
class ODBAXIS(Structure):
    """One value per axis; of one axis it is the first."""

    dummy: SHORT
    type: SHORT
    data: Annotated[Longs, Times(MAX_AXIS)]


@structure(pack=2)
class FAXIS(Structure):
    """Positions of all axes."""

    absolute: Annotated[Longs, Times(MAX_AXIS)]
    machine: Annotated[Longs, Times(MAX_AXIS)]
    relative: Annotated[Longs, Times(MAX_AXIS)]
    distance: Annotated[Longs, Times(MAX_AXIS)]


@structure(pack=2)
class OAXIS(Structure):
    """Positions of one axis."""

    absolute: LONG
    machine: LONG
    relative: LONG
    distance: LONG


@structure(pack=2)
class ODBDY_POS(Union):
    """Positions of all axes or of one."""

    faxis: FAXIS
    oaxis: OAXIS


@structure(pack=2)
class ODBDY(Structure):
    """What changes while a program runs, at one moment."""

    dummy: SHORT
    axis: SHORT
    alarm: SHORT
    prgnum: SHORT
    prgmnum: SHORT
    seqnum: LONG
    actf: LONG
    acts: LONG
    pos: ODBDY_POS


@structure(pack=2)
class FAXIS_D(Structure):
    """Positions of all axes of a Power Mate-D."""

    absolute: Annotated[Longs, Times(2)]
    machine: Annotated[Longs, Times(2)]
    relative: Annotated[Longs, Times(2)]
    distance: Annotated[Longs, Times(2)]


@structure(pack=2)
class ODBDY_POS_D(Union):
    """Positions of all axes or of one, on a Power Mate-D."""

    faxis: FAXIS_D
    oaxis: OAXIS


@structure(pack=2)
class ODBDY_D(Structure):
    """ODBDY of a Power Mate-D, whose arrays have room for 2 axes."""

    dummy: SHORT
    axis: SHORT
    alarm: SHORT
    prgnum: SHORT
    prgmnum: SHORT
    seqnum: LONG
    actf: LONG
    acts: LONG
    pos: ODBDY_POS_D


@structure(pack=2)
class IDBWRR(Structure):
    """Relative positions to preset."""

    datano: SHORT
    type: SHORT
    data: Annotated[Longs, Times(MAX_AXIS)]


@structure(pack=2)
class ODBUP(Structure):
    """A piece of a program."""

    dummy: Annotated[Shorts, Times(2)]
    data: Annotated[Chars, Times(MAX_RBUF)]


@structure(pack=2)
class PRGDIR(Structure):
    """The directory of programs, as text."""

    prg_data: Annotated[Chars, Times(MAX_PBUF)]


@structure(pack=2)
class ODBNC_BIN(Structure):
    """Program memory in numbers."""

    reg_prg: SHORT
    unreg_prg: SHORT
    used_mem: LONG
    unused_mem: LONG


@structure(pack=1)
class ODBNC_U(Union):
    """Program memory in numbers or as text."""

    bin: ODBNC_BIN
    asc: Annotated[Chars, Times(31)]


@structure(pack=1)
class ODBNC(Structure):
    """Program memory."""

    u: ODBNC_U


@structure(pack=2)
class ODBPRO(Structure):
    """Program numbers."""

    dummy: Annotated[Shorts, Times(2)]
    data: SHORT
    mdata: SHORT


@structure(pack=2)
class ODBSEQ(Structure):
    """Sequence number."""

    dummy: Annotated[Shorts, Times(2)]
    data: LONG


@structure(pack=2)
class ODBMDIP(Structure):
    """Pointers of MDI operation."""

    mdiprog: SHORT
    mdipntr: LONG
    crntprog: SHORT
    crntpntr: LONG


@structure(pack=2)
class ODBTOFS(Structure):
    """One tool offset."""

    datano: SHORT
    type: SHORT
    data: LONG


@structure(pack=2)
class IODBTO_U(Union):
    """Tool offsets, of type 0 or of all types."""

    m_ofs: Annotated[Longs, Times(MAX_OFFSETS)]
    m_ofs_a: Annotated[Longs, Times(MAX_OFFSETS)]


@structure(pack=2)
class IODBTO(Structure):
    """A range of tool offsets."""

    datano_s: SHORT
    type: SHORT
    datano_e: SHORT
    u: IODBTO_U


@structure(pack=2)
class ODBTLINF(Structure):
    """What the tool offset memory is."""

    ofs_type: SHORT
    use_no: SHORT


@structure(pack=2)
class IODBPSD_U(Union):
    """Value of a parameter, or its values of all axes."""

    cdata: _CHAR
    idata: SHORT
    ldata: LONG
    cdatas: Annotated[SChars, Times(MAX_AXIS)]
    idatas: Annotated[Shorts, Times(MAX_AXIS)]
    ldatas: Annotated[Longs, Times(MAX_AXIS)]


@structure(pack=2)
class IODBPSD(Structure):
    """A parameter."""

    datano: SHORT
    type: SHORT
    u: IODBPSD_U


@structure(pack=2)
class PARAIF_INFO(Structure):
    """Number and attributes of a parameter."""

    prm_no: SHORT
    prm_type: SHORT


@structure(pack=2)
class ODBPARAIF(Structure):
    """Parameters that there are."""

    info_no: USHORT
    prev_no: SHORT
    next_no: SHORT
    info: Annotated[ctypes.Array[PARAIF_INFO], Times(MAX_INFO)]


@structure(pack=2)
class ODBM(Structure):
    """A custom macro variable."""

    datano: SHORT
    dummy: SHORT
    mcr_val: LONG
    dec_val: SHORT


@structure(pack=2)
class IODBMR_DATA(Structure):
    """Value of a custom macro variable."""

    mcr_val: LONG
    dec_val: SHORT


@structure(pack=2)
class IODBMR(Structure):
    """A range of custom macro variables."""

    datano_s: SHORT
    dummy: SHORT
    datano_e: SHORT
    data: Annotated[ctypes.Array[IODBMR_DATA], Times(MAX_MACROS)]


@structure(pack=2)
class ODBMVINF(Structure):
    """Which custom macro variables there are."""

    use_no1: SHORT
    use_no2: SHORT


@structure(pack=4)
class ODBNODE(Structure):
    """A node, as the header of the library has it."""

    node_no: LONG
    io_base: LONG
    status: LONG
    cnc_type: LONG
    node_name: Annotated[Chars, Times(20)]


STRUCTURES_A = (
    ODBACT, ODBAXIS, ODBDY, IDBWRR, ODBUP, PRGDIR, ODBNC, ODBPRO, ODBSEQ, ODBMDIP, ODBTOFS, IODBTO, ODBTLINF,
    IODBPSD, ODBPARAIF, ODBM, IODBMR, ODBMVINF, ODBNODE,
)  # fmt: skip

__all__ = [
    "IDBWRR",
    "IODBMR",
    "IODBPSD",
    "IODBTO",
    "ODBACT",
    "ODBAXIS",
    "ODBDY",
    "ODBM",
    "ODBMDIP",
    "ODBMVINF",
    "ODBNC",
    "ODBNODE",
    "ODBPARAIF",
    "ODBPRO",
    "ODBSEQ",
    "ODBTLINF",
    "ODBTOFS",
    "ODBUP",
    "PRGDIR",
]
