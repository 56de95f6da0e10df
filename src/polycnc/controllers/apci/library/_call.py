"""The makers of the library's functions, and the C types of their arguments.

A number that is not finite or beyond `LARGEST` is refused with code 1, before anything is changed.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._environment import InterruptRoutine
from polycnc.controllers.apci.board._numbers import is_number
from polycnc.controllers.apci.board._records import AS, CBCNCT, CDBUF, CIBUF, CNCTS, ROSI, TSRP
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR, Selection, Session
from polycnc.controllers.library import (
    INOUT,
    OUT,
    Coded,
    Elements,
    Facade,
    LengthOf,
    Many,
    Number,
    Out,
    Pointer,
    Refused,
    named,
)
from polycnc.controllers.library import Real as AnyReal
from polycnc.controllers.library import Text as AnyText


def longint(value: int) -> int:
    """Return a whole number as 32 bits hold it."""
    return ctypes.c_int32(value).value


@dataclass(frozen=True, slots=True)
class Whole(Number):
    """A whole number of 32 bits."""

    ctype: Any = ctypes.c_int32

    def take(self, value: Any, to: Any) -> int:
        """Refuse what is no number for the board."""
        if not is_number(value):
            raise Refused(UNKNOWN_ERROR)
        return Number.take(self, value, to)


@dataclass(frozen=True, slots=True)
class Real(AnyReal):
    """A floating-point number."""

    def take(self, value: Any, to: Any) -> float:
        """Refuse what is no number for the board."""
        if not is_number(value):
            raise Refused(UNKNOWN_ERROR)
        return float(value)


INT: TypeAlias = Annotated[int, Whole("int")]
LONG: TypeAlias = Annotated[int, Whole("long")]
DOUBLE: TypeAlias = Annotated[float, Real()]
TEXT: TypeAlias = Annotated[str, AnyText()]
CODE: TypeAlias = Annotated[int, Number("int", ctypes.c_int32), Coded()]

# Numbers that C passes by address, although they are only read.
INT_AT: TypeAlias = Annotated[int, Whole("int *")]
LONG_AT: TypeAlias = Annotated[int, Whole("long *")]
DOUBLE_AT: TypeAlias = Annotated[float, Real("double *")]

Records: TypeAlias = Annotated[Elements[TSRP], Pointer("TSRP *", of=TSRP)]
FilledRecords: TypeAlias = Annotated[Records, INOUT, Many("MAXAXIS")]
SelectedRecords: TypeAlias = Annotated[Records, Many("max(as.san) + 1")]
FilledSystem: TypeAlias = Annotated[ROSI, OUT]
FilledStatus: TypeAlias = Annotated[CNCTS, OUT]
FilledDoubles: TypeAlias = Annotated[CDBUF, INOUT]
FilledIntegers: TypeAlias = Annotated[CIBUF, INOUT]
FilledBuffer: TypeAlias = Annotated[CBCNCT, INOUT]
Routine: TypeAlias = Annotated[InterruptRoutine, Pointer("InterruptRoutine", of=callable)]
Environment: TypeAlias = Annotated[TEXT, INOUT]
BufferSize: TypeAlias = Annotated[INT, LengthOf("buffer")]
PointCount: TypeAlias = Annotated[INT, LengthOf("spdbuf")]

BoardType: TypeAlias = Annotated[INT, Out("BoardType")]
TaskInfo: TypeAlias = Annotated[INT, Out("tskinfo")]
TaskText: TypeAlias = Annotated[TEXT, Out("buffer", "szbuffer")]
Value: TypeAlias = Annotated[LONG, Out("value")]
"""What a call reads: an argument in C."""

LIBRARY = Facade("polycnc.controllers.apci.pcap", Session(), code="int")
session_call = LIBRARY.on(lambda session: session)
board_call = LIBRARY.on(Session.usable)
polled_call = LIBRARY.on(Session.polled)
axis_call = LIBRARY.through(Session.axis, INT)
polled_axis_call = LIBRARY.through(Session.polled_axis, INT)
record_call = LIBRARY.through(Session.named_in, TSRP)
filled_call = LIBRARY.through(Session.polled_in, Annotated[TSRP, INOUT])
axes_call = LIBRARY.through(Session.selected, AS, name="as")


def axes_order(
    command: Callable[[Board, tuple[int, ...]], object], what: str, section: int
) -> Callable[[AS], None]:
    """Make the function that gives the selected axes a command of the board, by the command's name."""

    def order(asel: Selection) -> None:
        asel.order(command)

    text = f"{what} (Manual 002, 4.4.{section})."
    return axes_call(named(order, command.__name__, text, {"asel": Selection}))
