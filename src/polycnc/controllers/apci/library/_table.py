"""How read and write functions are made: a `Register` is one row of the table, and the pair of functions comes out.

Four forms, as in the manual: through a record (TSRP), by axis number without or with a status, and for the board.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from polycnc.controllers.apci.board._axis import Axis
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import Status
from polycnc.controllers.apci.board._records import TSRP
from polycnc.controllers.apci.library._library import (
    UNKNOWN_ERROR,
    is_number,
    longint,
    polled_board,
    status_code,
    usable_axis,
    usable_board,
)

POSITION = "axis unit"
VELOCITY = "axis unit per time unit"
ACCELERATION = "axis unit per time unit²"
PATH_VELOCITY = "unit of interpolation, PU/TU"
PATH_ACCELERATION = "unit of interpolation, PU/TU²"

MODULE = "polycnc.controllers.apci.pcap"

N = TypeVar("N", int, float)
Read = TypeVar("Read", int, float, covariant=True)
Owner = TypeVar("Owner", Axis, Board)
C = TypeVar("C", bound=Callable[..., Any])


class WithRecord(Protocol):
    """Fill an element of the record, or send it to the axis `tsrp.an`."""

    def __call__(self, tsrp: TSRP) -> None: ...


class ReadAxis(Protocol[Read]):
    """Return a register of an axis."""

    def __call__(self, an: int) -> Read: ...


class WriteAxis(Protocol):
    """Write a register of an axis."""

    def __call__(self, an: int, value: float) -> None: ...


class ReadAxisCoded(Protocol[Read]):
    """Return a code and a register of an axis."""

    def __call__(self, an: int) -> tuple[int, Read]: ...


class WriteAxisCoded(Protocol):
    """Write a register of an axis and return a code."""

    def __call__(self, an: int, value: float) -> int: ...


class ReadBoard(Protocol[Read]):
    """Return a register of the board."""

    def __call__(self) -> Read: ...


class WriteBoard(Protocol):
    """Write a register of the board."""

    def __call__(self, value: float) -> None: ...


class ReadBoardCoded(Protocol[Read]):
    """Return a code and a register of the board."""

    def __call__(self) -> tuple[int, Read]: ...


class WriteBoardCoded(Protocol):
    """Write a register of the board and return a code."""

    def __call__(self, value: float) -> int: ...


@dataclass(frozen=True, slots=True)
class _Row(Generic[Owner, N]):
    """A register: the stem of its functions' names, what it is, its unit, and the sections of its functions.

    `zero` is what an unreachable board reads as, and with it the type. `polled` marks what the board changes by itself:
    time passes before it is read. Without `put` it cannot be written; `fits` refuses values.
    """

    stem: str
    what: str
    zero: N
    get: Callable[[Owner], Any]
    put: Callable[[Owner, Any], object] | None = None
    unit: str = ""
    sections: tuple[int, ...] = ()
    polled: bool = False
    fits: Callable[[float], bool] = is_number
    note: str = ""

    def store(self, owner: Owner, value: float) -> bool:
        """Write the register; False if the value cannot be."""
        if self.put is None or not is_number(value) or not self.fits(value):
            return False
        self.put(owner, longint(value) if isinstance(self.zero, int) else float(value))
        return True

    def named(self, function: C, verb: str, rest: str, number: int) -> C:
        """Give a function its name and its description."""
        function.__name__ = function.__qualname__ = f"{'rd' if verb == 'Read' else 'wr'}{self.stem}"
        function.__module__ = MODULE
        returned = str(function.__annotations__["return"])
        function.__annotations__["return"] = re.sub(r"\bN\b", type(self.zero).__name__, returned)
        unit = f" [{self.unit}]" if self.unit else ""
        section = f" (Manual 002, 4.4.{self.sections[number]})" if number < len(self.sections) else ""
        note = f"\n\n{self.note}" if self.note else ""
        function.__doc__ = f"{verb} {self.what}{unit}{rest}{section}.{note}"
        return function


class AxisRegister(_Row[Axis, N]):
    """A register of every axis."""

    __slots__ = ()

    def read_record(self, field: str) -> WithRecord:
        """Make the function that reads into a record."""
        get, polled = self.get, self.polled

        def read(tsrp: TSRP) -> None:
            axis = usable_axis(tsrp.an, polled=polled)
            if axis is not None:
                setattr(tsrp, field, get(axis))

        return self.named(read, "Read", f" into `tsrp.{field}`", 0)

    def write_record(self, field: str) -> WithRecord:
        """Make the function that writes from a record."""
        store = self.store

        def write(tsrp: TSRP) -> None:
            axis = usable_axis(tsrp.an)
            if axis is not None:
                store(axis, getattr(tsrp, field))

        return self.named(write, "Write", f" from `tsrp.{field}`", 1)

    def in_record(self, field: str) -> tuple[WithRecord, WithRecord]:
        """Make both functions that go through a record."""
        return self.read_record(field), self.write_record(field)

    def read(self) -> ReadAxis[N]:
        """Make the function that returns the register."""
        get, polled, zero = self.get, self.polled, self.zero

        def read(an: int) -> N:
            axis = usable_axis(an, polled=polled)
            value: N = zero if axis is None else get(axis)
            return value

        return self.named(read, "Read", " of axis `an`", 0)

    def both(self) -> tuple[ReadAxis[N], WriteAxis]:
        """Make the functions by axis number."""
        store = self.store

        def write(an: int, value: float) -> None:
            axis = usable_axis(an)
            if axis is not None:
                store(axis, value)

        return self.read(), self.named(write, "Write", " of axis `an`", 1)

    def read_coded(self, done: int = Status.DONE, failed: int = UNKNOWN_ERROR) -> ReadAxisCoded[N]:
        """Make the function that returns a code and the register; `failed` is the code for an unknown axis."""
        get, polled, zero = self.get, self.polled, self.zero

        def read(an: int) -> tuple[int, N]:
            axis = usable_axis(an, polled=polled)
            if axis is not None:
                return int(done), get(axis)
            return failed if done else (status_code() or failed), zero

        return self.named(read, "Read", f" of axis `an`; {int(done)} means done", 0)

    def coded(self) -> tuple[ReadAxisCoded[N], WriteAxisCoded]:
        """Make the functions by axis number that return a code."""
        store = self.store

        def write(an: int, value: float) -> int:
            axis = usable_axis(an)
            if axis is None:
                return status_code() or UNKNOWN_ERROR
            return int(Status.DONE) if store(axis, value) else UNKNOWN_ERROR

        return self.read_coded(), self.named(write, "Write", " of axis `an`; 0 means done", 1)


class BoardRegister(_Row[Board, N]):
    """A register of the board."""

    __slots__ = ()

    def read(self) -> ReadBoard[N]:
        """Make the function that returns the register."""
        get, zero, find = self.get, self.zero, polled_board if self.polled else usable_board

        def read() -> N:
            board = find()
            value: N = zero if board is None else get(board)
            return value

        return self.named(read, "Read", "", 0)

    def both(self) -> tuple[ReadBoard[N], WriteBoard]:
        """Make the functions without a code."""
        store = self.store

        def write(value: float) -> None:
            board = usable_board()
            if board is not None:
                store(board, value)

        return self.read(), self.named(write, "Write", "", 1)

    def coded(self) -> tuple[ReadBoardCoded[N], WriteBoardCoded]:
        """Make the functions that return a code."""
        get, zero, store = self.get, self.zero, self.store

        def read() -> tuple[int, N]:
            board = usable_board()
            return (status_code(), zero) if board is None else (int(Status.DONE), get(board))

        def write(value: float) -> int:
            board = usable_board()
            if board is None:
                return status_code()
            return int(Status.DONE) if store(board, value) else UNKNOWN_ERROR

        return (
            self.named(read, "Read", "; 0 means done", 0),
            self.named(write, "Write", "; 0 means done", 1),
        )
