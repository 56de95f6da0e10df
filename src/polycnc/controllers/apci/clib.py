"""The function library of the APCI board for C programs, `mcug3`: what C needs beyond the table of functions."""

from __future__ import annotations

import ctypes
from typing import Any

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.board._codes import BootCode, InitCode, Status, Success
from polycnc.controllers.apci.board._declared import HEADER
from polycnc.controllers.apci.core._turn_state import BUFFER_BYTES
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR
from polycnc.controllers.library import Element, Table, lay_out
from polycnc.controllers.library.clib import CLibrary

_BESIDE = ("aux", "lp", "dv", "sdec")
TSRPX: Any = lay_out(
    "TSRPX",
    False,
    Table(
        {"tsrp": Element("TSRP", pcap.TSRP, pcap.TSRP)}
        | {name: Element("double", ctypes.c_double, float) for name in _BESIDE},
        pack=pcap.TSRP._table_.pack,
    ),
)
"""A TSRP with the values that functions use and it has no place for; see `MCUG3_EXTEND` of the header."""
_WITHOUT_A_PLACE = ("rdaux", "wraux", "rdlp", "wrlp", "rdlpndx", "wrlpndx", "rddv", "rdsdec", "wrsdec")
_SERVED = "booting a served board would make another one than the one that is served; it answers 202"

# The names of functions as the prints of the manual have them besides: programs may be linked by these.
_PRINTED = {
    "rdcbcnc": "rdcbcnct", "rdjtvI": "rdjtvl", "rdlsM": "rdlsm", "rdtrtv": "rdtrtvl", "wrbcnct": "wrcbcnct",
    "wrjtvI": "wrjtvl", "wrppe": "wrrp", "wrtrtv": "wrtrtvl",
}  # fmt: skip
_MOST = BUFFER_BYTES + 1
_DECLARATIONS = """\
typedef void(PC_CALL *InterruptRoutine)(int lines);

/* Marks a TSRPX: rdaux, rdlp, rddv, rdsdec and those like them then read and write its own elements, which TSRP does
   not have. The marked record is passed as a TSRP. */
#define MCUG3_EXTEND(x) \\
    ((x)->tsrp.scratch[0] = 0x584E4350, (x)->tsrp.scratch[1] = 0x31505253, \\
     (x)->tsrp.scratch[2] = (PC_LONG)sizeof(TSRPX), (x)->tsrp.scratch[3] = ~(PC_LONG)sizeof(TSRPX))
"""

_HELPERS = """\
/* Whether a record is the first part of a marked TSRPX. */
static int mcug3_is_extended(const TSRP *tsrp)
{
    return tsrp && tsrp->scratch[0] == 0x584E4350 && tsrp->scratch[1] == 0x31505253 &&
           tsrp->scratch[2] == (PC_LONG)sizeof(TSRPX) && tsrp->scratch[3] == ~(PC_LONG)sizeof(TSRPX);
}

/* How many records there are for a selection: up to the highest axis in it. */
static int64_t mcug3_records(const AS *as)
{
    int64_t most = 0;
    PC_LONG k;
    for (k = 0; as && k < as->unoa && k < MAXAXIS; k++)
        if (as->san[k] >= most && as->san[k] < MAXAXIS)
            most = as->san[k] + 1;
    return most;
}
"""

MCUG3 = CLibrary(
    name="mcug3",
    kind="apci",
    functions=pcap.FUNCTIONS,
    header=HEADER,
    constants={
        name: int(getattr(pcap, name))
        for name in dict.fromkeys(pcap.__all__)
        if isinstance(getattr(pcap, name), int)
    },
    nobody=InitCode.NO_BOARD,
    lost=Status.TIMEOUT,
    null=UNKNOWN_ERROR,
    handle=UNKNOWN_ERROR,
    version=InitCode.VERSION_MISMATCH,
    failed=UNKNOWN_ERROR,
    opens=frozenset(("InitMcuSystem", "InitMcuSystem2", "InitMcuSystem3")),
    in_bytes=False,
    basic=True,
    declarations=_DECLARATIONS,
    extensions=dict.fromkeys(_WITHOUT_A_PLACE, TSRPX),
    is_extended="mcug3_is_extended({})",
    helpers=_HELPERS,
    extents={
        **{(name, "tsrp"): "mcug3_records(as) * (int64_t)sizeof(TSRP)" for name in ("ja", "jhi", "jr")},
        **{(name, "spdbuf"): "(int64_t)size * 8" for name in ("spd", "spda", "spdr")},
        ("getEnvStr", "EnvStr"): "sizeof(CppString)",
        # More than a buffer has is refused by its number, without a look at all of it.
        **{
            (name, "cbcnct_buffer"): f"!cbcnct ? 0 : cbcnct->size < {_MOST} ? cbcnct->size : {_MOST}"
            for name in ("rdcbcnct", "wrcbcnct")
        },
    },
    failures={
        "rdSampleTime": Success.FAILED,
        "rdslsp": Success.FAILED,
        "BootFile": BootCode.DEVICE_ADDRESSES,
    },
    aliases=_PRINTED,
    left_out={"BootFile": _SERVED},
    interrupts=("MCUG3_SetBoardIntRoutine", "MCUG3_ResetBoardIntRoutine"),
)
"""Ruling: a null pointer is an unknown error, 1; the selected axes' records lie in the program at their numbers."""

__all__ = ["MCUG3"]
