"""The function library of the iMC card for C programs, `IMCnet`: what C needs beyond the table of functions."""

from __future__ import annotations

from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.library._declared import HEADER
from polycnc.controllers.library.clib import CLibrary

_DECLARATIONS = """\
typedef unsigned short IMCU16;
typedef double IMCFLOAT;
typedef int IMC_STATUS;
typedef void *IMC_HANDLE; /* a number, which leads nowhere */
typedef void *PVOID;
typedef WR_MUL_DES *pWR_MUL_DES;
typedef EventInfo *PEventInfo;
"""

_CALLS = imclib.Session.calls

IMCNET = CLibrary(
    name="IMCnet",
    kind="imc",
    functions=imclib.FUNCTIONS,
    header=HEADER,
    constants={
        name: int(getattr(imclib, name))
        for name in dict.fromkeys(imclib.__all__)
        if isinstance(getattr(imclib, name), int)
    },
    nobody=imclib.IMC_DEVICE_NOT_FOUND,
    lost=imclib.IMC_TIME_OUT,
    null=imclib.IMC_INVALID_PARAM,
    handle=imclib.IMC_INVALID_HANDLE,
    version=imclib.IMC_VERSION_ERROR,
    failed=imclib.IMC_OTHER_ERROR,
    opens=frozenset(("IMC_FindNetCard", "IMC_Open", "IMC_OpenX", "IMC_OpenUsePassword")),
    in_bytes=False,
    declarations=_DECLARATIONS,
    extents={
        # More than a call takes is refused by its number, without a look at all of it.
        ("IMC_GetMulParam", "pdes"): "(NumofArr < 33 ? NumofArr : 33) * (int64_t)sizeof(WR_MUL_DES)",
        ("IMC_InstallEvent", "pEvent"): "(EventNum < 32 ? EventNum : 32) * (int64_t)sizeof(EventInfo)",
        ("IMC_PutContourData", "pdata"): "(nWords < 127 ? nWords : 127) * (int64_t)2",
        ("IMC_GetCapData", "pdata"): "(rdnum < 121 ? rdnum : 121) * (int64_t)4",
    },
    aliases={
        alias: next(name for name in imclib.FUNCTIONS if _CALLS[name] is call)
        for alias, call in _CALLS.items()
        if alias not in imclib.FUNCTIONS
    },
)
"""Ruling: a null pointer is refused as IMC_INVALID_PARAM; a lost connection is a card that does not answer."""

__all__ = ["IMCNET"]
