"""The function library of the FANUC Power Mate, by the manual's names.

`attach` puts a virtual control on the bus; then a program runs as it is written in the manual::

    from polycnc.controllers.fanuc import PowerMate, fwlib

    control = PowerMate()
    fwlib.attach(0, control)
    code, handle = fwlib.cnc_allclibhndl()
    code, position = fwlib.cnc_absolute(handle, fwlib.ALL_AXES, 4 + 4 * 3)
    print(position.data[:3])

Arguments are the manual's, in its order. Pointers to what a function reads are no arguments: a function returns its
code, and after it what it reads. A call that is refused changes nothing. `STRUCTURES` says what lies where in memory.
`Session()` is another program with a library of its own. Calls may come from several threads; one at a time is
carried out.
"""

from __future__ import annotations

from polycnc.controllers.fanuc.library import (
    _axes,
    _codes,
    _diagnosis,
    _handles,
    _history,
    _macros,
    _misc,
    _modal,
    _motion,
    _offsets,
    _panel,
    _parameters,
    _pmc,
    _programs,
    _structs,
)
from polycnc.controllers.fanuc.library._axes import *  # noqa: F403
from polycnc.controllers.fanuc.library._call import LIBRARY
from polycnc.controllers.fanuc.library._codes import *  # noqa: F403
from polycnc.controllers.fanuc.library._diagnosis import *  # noqa: F403
from polycnc.controllers.fanuc.library._handles import *  # noqa: F403
from polycnc.controllers.fanuc.library._history import *  # noqa: F403
from polycnc.controllers.fanuc.library._macros import *  # noqa: F403
from polycnc.controllers.fanuc.library._misc import *  # noqa: F403
from polycnc.controllers.fanuc.library._modal import *  # noqa: F403
from polycnc.controllers.fanuc.library._motion import *  # noqa: F403
from polycnc.controllers.fanuc.library._network import Node, Session
from polycnc.controllers.fanuc.library._offsets import *  # noqa: F403
from polycnc.controllers.fanuc.library._panel import *  # noqa: F403
from polycnc.controllers.fanuc.library._parameters import *  # noqa: F403
from polycnc.controllers.fanuc.library._pmc import *  # noqa: F403
from polycnc.controllers.fanuc.library._programs import *  # noqa: F403
from polycnc.controllers.fanuc.library._structs import *  # noqa: F403

attach = LIBRARY.default.attach
detach = LIBRARY.default.detach
FUNCTIONS = LIBRARY.functions
"""The table of all functions, with the C types and directions of their arguments."""

STRUCTURES = _structs.HEADER.layouts
"""The tables of all structures: `size`, and `fields` with name, type, offset and size."""

__all__ = [
    *_axes.__all__,
    *_codes.__all__,
    *_diagnosis.__all__,
    *_handles.__all__,
    *_history.__all__,
    *_macros.__all__,
    *_misc.__all__,
    *_modal.__all__,
    *_motion.__all__,
    *_offsets.__all__,
    *_panel.__all__,
    *_parameters.__all__,
    *_pmc.__all__,
    *_programs.__all__,
    *_structs.__all__,
    "FUNCTIONS",
    "STRUCTURES",
    "Node",
    "Session",
    "attach",
    "detach",
]
