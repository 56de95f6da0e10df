"""The function library of the Power Mate for C programs, `fwlib32`: what C needs beyond the table of functions."""

from __future__ import annotations

from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.fanuc.library._modal import is_of_groups
from polycnc.controllers.fanuc.library._structs import HEADER
from polycnc.controllers.library.clib import CLibrary

FWLIB = CLibrary(
    name="fwlib32",
    kind="fanuc",
    functions=fwlib.FUNCTIONS,
    header=HEADER,
    constants={name: getattr(fwlib, name) for name in fwlib.__all__ if isinstance(getattr(fwlib, name), int)},
    nobody=fwlib.EW_HSSB,
    lost=fwlib.EW_SOCKET,
    null=fwlib.EW_DATA,
    handle=fwlib.EW_HANDLE,
    version=fwlib.EW_VERSION,
    failed=fwlib.EW_UNEXP,
    through="FlibHndl",
    opens=frozenset(("cnc_allclibhndl", "cnc_allclibhndl2")),
    opens_at="cnc_allclibhndl3",
    frees="cnc_freelibhndl",
    packings=frozenset({4}),
    selected={"ODBMDL": lambda record: "g_rdata" if is_of_groups(record.datano) else "raux1"},
    extents={
        # The length counts the characters; two numbers stand before them.
        ("cnc_upload", "upld"): "(number ? 4 + *number : 0)",
        # More axes than a control has are refused without a look at them.
        **{
            (function.name, each.name): "(axis < MAX_AXIS ? axis : MAX_AXIS) * (int)sizeof(ODBPOS)"
            for function in fwlib.FUNCTIONS.values()
            for each in function.arguments
            if each.many == "axis"
        },
    },
)
"""Ruling: a null pointer is refused as EW_DATA."""

__all__ = ["FWLIB"]
