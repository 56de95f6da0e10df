"""CNC tasks as the PC sees them: control, status, output, common variables and buffers (Manual 002, 4.4.10 ff.).

The tasks belong to the board (`Board.tasks`); a board without any has none that runs.
"""

# ruff: noqa: N803  the names are the manual's

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import BufferError
from polycnc.controllers.apci.board._declared import CBCNCT, CDBUF, CIBUF, COMMON_VARIABLES
from polycnc.controllers.apci.board._numbers import is_number
from polycnc.controllers.apci.board._records import TASK_STRING_BYTES
from polycnc.controllers.apci.core._turn_state import BUFFER_BYTES, TASKS
from polycnc.controllers.apci.library._call import (
    CODE,
    INT,
    BufferSize,
    FilledBuffer,
    FilledDoubles,
    FilledIntegers,
    FilledStatus,
    TaskInfo,
    TaskText,
    board_call,
    polled_call,
    session_call,
)
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR, Session
from polycnc.controllers.apci.sap._board_host import BoardTasks
from polycnc.controllers.library import Refused

_STATUS = ("errnum", "errline", "stackfree", "running", "csrcline")
_BULK = {100: 100, COMMON_VARIABLES: COMMON_VARIABLES}  # index: variables from 0


def _tasks(board: Board) -> BoardTasks:
    if not isinstance(board.tasks, BoardTasks):
        raise Refused(UNKNOWN_ERROR)
    return board.tasks


# ---------------------------------------------------------------------- control


@board_call
def startcnct(board: Board, TaskNr: INT) -> None:
    """Start the program of a task from its beginning; one that runs is stopped first (Manual 002, 4.4.124)."""
    _tasks(board).startcnct(TaskNr)


@board_call
def stopcnct(board: Board, TaskNr: INT) -> None:
    """Stop the program of a task, its EVENT handlers too (Manual 002, 4.4.126)."""
    _tasks(board).stopcnct(TaskNr)


@board_call
def contcnct(board: Board, TaskNr: INT) -> None:
    """Continue the program of a task that was stopped, not one that was aborted (Manual 002, 4.4.10)."""
    _tasks(board).contcnct(TaskNr)


@board_call
def stepcnct(board: Board, TaskNr: INT) -> None:
    """Do nothing: the manual declares single steps as not implemented (Manual 002, 4.4.125)."""
    _tasks(board).stepcnct(TaskNr)


@polled_call
def rdcncts(board: Board, TaskNr: INT, cncts: FilledStatus) -> None:
    """Read the status of a task into `cncts`; zeros for a task that is not there (Manual 002, 4.4.50)."""
    for name, value in zip(_STATUS, _tasks(board).rdcncts(TaskNr), strict=True):
        setattr(cncts, name, value)


# ---------------------------------------------------------------------- output


@polled_call
def gettskinfo(board: Board, TaskNr: INT) -> tuple[CODE, TaskInfo]:
    """Return a status and what is to be read: bit 0 an incomplete, bit 1 a complete string (Manual 002, 4.4.13)."""
    return _tasks(board).gettskinfo(TaskNr)


@board_call
def gettskstr(board: Board, TaskNr: INT, szbuffer: BufferSize = TASK_STRING_BYTES) -> tuple[INT, TaskText]:
    """Return the number of characters and the output of a task, at most `szbuffer` and 512 (Manual 002, 4.4.14)."""
    text = _tasks(board).gettskstr(TaskNr, szbuffer)
    return len(text), text


# ---------------------------------------------------------------------- common variables and buffers


@polled_call
def rdcd(board: Board, ndx: INT, cdbuf: FilledDoubles) -> None:
    """Read variable `ndx` of CD into `cdbuf.cd[ndx]`; 100 and 1000 read all below (Manual 002, 4.4.48)."""
    _read(board.state.cd, cdbuf.cd, ndx)


@polled_call
def rdci(board: Board, ndx: INT, cibuf: FilledIntegers) -> None:
    """Read variable `ndx` of CI into `cibuf.ci[ndx]`; 100 and 1000 read all below (Manual 002, 4.4.49)."""
    _read(board.state.ci, cibuf.ci, ndx)


@board_call
def wrcd(board: Board, ndx: INT, cdbuf: CDBUF) -> None:
    """Write variable `ndx` of CD, 0 to 999, from `cdbuf.cd[ndx]` (Manual 002, 4.4.135)."""
    if not 0 <= ndx < COMMON_VARIABLES or not is_number(cdbuf.cd[ndx]):
        raise Refused(UNKNOWN_ERROR)
    board.state.cd[ndx] = cdbuf.cd[ndx]


@board_call
def wrci(board: Board, ndx: INT, cibuf: CIBUF) -> None:
    """Write variable `ndx` of CI, 0 to 999, from `cibuf.ci[ndx]`; ClearCI99 releases waits (Manual 002, 4.4.136)."""
    if not 0 <= ndx < COMMON_VARIABLES:
        raise Refused(UNKNOWN_ERROR)
    board.state.ci[ndx] = cibuf.ci[ndx]


def _read(variables: npt.NDArray[Any], into: ctypes.Array[Any], ndx: int) -> None:
    if ndx in _BULK:
        np.frombuffer(memoryview(into), variables.dtype)[: _BULK[ndx]] = variables[: _BULK[ndx]]
    elif 0 <= ndx < COMMON_VARIABLES:
        into[ndx] = variables[ndx].item()


@session_call
def rdcbcnct(session: Session, cbcnct: FilledBuffer) -> CODE:
    """Copy the beginning of a common buffer into `cbcnct.buffer`; return 0 or error bits (Manual 002, 4.4.47)."""
    buffer = _buffer(session, cbcnct, polled=True)
    cbcnct.buffer[: cbcnct.size] = buffer[: cbcnct.size]
    return 0


@session_call
def wrcbcnct(session: Session, cbcnct: CBCNCT) -> CODE:
    """Copy `cbcnct.buffer` to the beginning of a task's common buffer; return 0 or error bits (Manual 002, 4.4.134)."""
    buffer = _buffer(session, cbcnct)
    buffer[: cbcnct.size] = cbcnct.buffer[: cbcnct.size]
    return 0


def _buffer(session: Session, cbcnct: CBCNCT, *, polled: bool = False) -> bytearray:
    """Return the common buffer of a task.

    Raises:
        Refused: With all error bits: a board that is not reached has no memory.
    """
    error = 0 if 0 <= cbcnct.task_number < TASKS else int(BufferError.task_number)
    if not 0 <= cbcnct.size <= BUFFER_BYTES:
        error |= BufferError.size
    try:
        board = session.polled() if polled else session.usable()
    except Refused:
        board = None
    if not error & BufferError.size and (board is None or len(cbcnct.buffer) < cbcnct.size):
        error |= BufferError.address
    if error or board is None:
        raise Refused(error)
    return board.variables.buffers[cbcnct.task_number]


# fmt: off
__all__ = [
    "contcnct", "gettskinfo", "gettskstr", "rdcbcnct", "rdcd", "rdci", "rdcncts", "startcnct", "stepcnct",
    "stopcnct", "wrcbcnct", "wrcd", "wrci",
]
# fmt: on
