"""The function library of the board: what mcug3.dll offers to a program on the PC, by the manual's names.

`attach` puts virtual boards into the PC; then a program runs as it is written in the manual::

    from polycnc.controllers.apci import Board, pcap

    pcap.attach(Board())
    tsrp, rosi = pcap.tsrp_array(), pcap.ROSI()
    code, board_type = pcap.InitMcuSystem3(tsrp, rosi, 0, "system.dat")
    pcap.cl(axes := pcap.AS.of(0))
    tsrp[0].tp = 10.0
    pcap.ja(axes, tsrp)
    while not pcap.rdaxstb(0, 13):
        pass

Arguments are the manual's, in its order; the argument `as`, a word of Python, is called `asel`. Records are passed and
filled in place, as in C. Pointers to single numbers are no arguments: a function without return value returns what it
reads (`value = rdrv(an)`), a function with one returns both (`code, value = rdtrac()`). A number that is written is
passed as it is (`wrtrac(500.0)`).

A call that does not reach the board, because it is not booted or the program has not called InitMcuSystem3, changes
nothing: codes are -4 (0 of rdSampleTime and rdslsp), bits and numbers 0. The same goes for an axis that is not there,
and for numbers that are not finite or beyond 1e100, with code 1; a selection with such an axis is ignored as a whole.
What no C compiler would take, such as a record of another kind, is a UsageError.

Time stands still but for calls that read what the board changes by itself (positions, status, common variables, ...):
one that reads what has been read in this scan already lets one scan pass before it reads, so polling loops end, and
what is read together comes from one scan. `attach(clock=...)` chooses otherwise.

Calls may come from several threads; one at a time is carried out. A program of its own, with its own boards and time,
is a `Session()`, which has all functions as attributes. `FUNCTIONS` is the table of all calls, `STRUCTURES` that of all
records.
"""

from __future__ import annotations

from polycnc.controllers.apci.board import _records
from polycnc.controllers.apci.board._records import *  # noqa: F403
from polycnc.controllers.apci.library import (
    _control,
    _io,
    _latch,
    _motion,
    _parameters,
    _special_variables,
    _spool,
    _system,
    _tasks,
)
from polycnc.controllers.apci.library._call import LIBRARY
from polycnc.controllers.apci.library._control import *  # noqa: F403
from polycnc.controllers.apci.library._io import *  # noqa: F403
from polycnc.controllers.apci.library._latch import *  # noqa: F403
from polycnc.controllers.apci.library._motion import *  # noqa: F403
from polycnc.controllers.apci.library._parameters import *  # noqa: F403
from polycnc.controllers.apci.library._session import Session
from polycnc.controllers.apci.library._special_variables import *  # noqa: F403
from polycnc.controllers.apci.library._spool import *  # noqa: F403
from polycnc.controllers.apci.library._system import *  # noqa: F403
from polycnc.controllers.apci.library._tasks import *  # noqa: F403

attach = LIBRARY.default.attach
detach = LIBRARY.default.detach
board = LIBRARY.default.board
FUNCTIONS = LIBRARY.functions
"""The table of all functions, with the C types and directions of their arguments."""

__all__ = [
    *_records.__all__,
    *_control.__all__,
    *_io.__all__,
    *_latch.__all__,
    *_motion.__all__,
    *_parameters.__all__,
    *_special_variables.__all__,
    *_spool.__all__,
    *_system.__all__,
    *_tasks.__all__,
    "FUNCTIONS",
    "Session",
    "attach",
    "board",
    "detach",
]
