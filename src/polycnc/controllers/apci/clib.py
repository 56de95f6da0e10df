"""The function library of the APCI board for C programs, `mcug3`: what C needs beyond the table of functions."""

from __future__ import annotations

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.board._codes import InitCode, Status, Success
from polycnc.controllers.apci.board._declared import HEADER
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR
from polycnc.controllers.library.clib import CLibrary

_NO_PLACE = "the record has no place for the value, so nothing is read or written"
_WITHOUT_A_PLACE = ("rdaux", "wraux", "rdlp", "wrlp", "rdlpndx", "wrlpndx", "rddv", "rdsdec", "wrsdec")
_SERVED = "a served board is booted: booting it anew would make another one than the one that is served"
_ROUTINE = "the library calls no routine of the program"

_HELPERS = """\
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
    declarations="typedef void(PC_CALL *InterruptRoutine)(int lines);\n",
    helpers=_HELPERS,
    extents={
        **{(name, "tsrp"): "mcug3_records(as) * (int64_t)sizeof(TSRP)" for name in ("ja", "jhi", "jr")},
        **{(name, "spdbuf"): "(int64_t)size * 8" for name in ("spd", "spda", "spdr")},
        ("getEnvStr", "EnvStr"): "sizeof(CppString)",
    },
    failures={"rdSampleTime": Success.FAILED, "rdslsp": Success.FAILED},
    left_out={
        **dict.fromkeys(_WITHOUT_A_PLACE, _NO_PLACE),
        "BootFile": _SERVED,
        "MCUG3_SetBoardIntRoutine": _ROUTINE,
        "MCUG3_ResetBoardIntRoutine": _ROUTINE,
    },
)
"""Ruling: a null pointer is an unknown error, 1; the selected axes' records lie in the program at their numbers."""

__all__ = ["MCUG3"]
