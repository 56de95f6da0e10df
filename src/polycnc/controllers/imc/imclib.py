"""The function library of the iMC card: all its functions, structures and codes, by the manual's names.

`attach` puts virtual cards on the network; then a program runs as it is written in the manual::

    from polycnc.controllers.imc import Card, imclib

    imclib.attach(Card())
    info = imclib.NIC_INFO()
    status, num = imclib.IMC_FindNetCard(info)
    status, handle = imclib.IMC_Open(0, 0)
    imclib.IMC_SetParam16(handle, imclib.runLoc, -1, 0, imclib.SEL_IFIFO)
    imclib.IMC_MoveAbsolute(handle, 6250, 0, imclib.SEL_QFIFO)
    while imclib.IMC_GetParam16(handle, imclib.movingLoc, 0)[1]:
        pass

Arguments are the manual's, in its order. Structures are passed and filled in place, as in C. Pointers to single numbers
are no arguments: a function returns its status, and after it what it reads (`status, value = IMC_GetParam16(...)`).
A call that is refused changes nothing. Addresses are the macros of the parameter header: the parameter's name and
`Loc`. Calls may come from several threads; one at a time is carried out. A program of its own, with its own network,
handles and time, is a `Session()`, which has all functions as attributes. `FUNCTIONS` is the table of all calls,
`STRUCTURES` that of all structures.

An instruction for IFIFO takes one control cycle; all other time passes when a program reads again what it has read in
this cycle already: see `attach`.
"""

from __future__ import annotations

from polycnc.controllers.imc.core._parameters import PARAMETERS
from polycnc.controllers.imc.library import _codes, _device, _events, _memory, _motion, _path, _structs
from polycnc.controllers.imc.library._call import LIBRARY
from polycnc.controllers.imc.library._codes import *  # noqa: F403
from polycnc.controllers.imc.library._device import *  # noqa: F403
from polycnc.controllers.imc.library._events import *  # noqa: F403
from polycnc.controllers.imc.library._memory import *  # noqa: F403
from polycnc.controllers.imc.library._motion import *  # noqa: F403
from polycnc.controllers.imc.library._network import IMC_HANDLE, NetCard, Port, Session
from polycnc.controllers.imc.library._path import *  # noqa: F403
from polycnc.controllers.imc.library._structs import *  # noqa: F403

attach = LIBRARY.default.attach
detach = LIBRARY.default.detach
FUNCTIONS = LIBRARY.functions
"""The table of all functions, with the C types and directions of their arguments."""

_ADDRESSES = {f"{each.name}Loc": each.address for each in PARAMETERS.values()}
_ADDRESSES["startgroup"] = _ADDRESSES["startgroupLoc"]  # the one macro that is printed without its ending


def __getattr__(name: str) -> int:
    """Return the address that a macro of the parameter header stands for."""
    if name in _ADDRESSES:
        return _ADDRESSES[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)


__all__ = [
    *_codes.__all__,
    *_device.__all__,
    *_events.__all__,
    *_memory.__all__,
    *_motion.__all__,
    *_path.__all__,
    *_structs.__all__,
    *_ADDRESSES,
    "FUNCTIONS",
    "IMC_HANDLE",
    "NetCard",
    "Port",
    "Session",
    "attach",
    "detach",
]
