"""CNC tasks as the PC sees them: control, status, output, common variables and buffers (Manual 002, 4.4.10 ff.).

The tasks belong to the board (`Board.tasks`); a board without any has none that runs.
"""

# ruff: noqa: N803  the names are the manual's

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import BufferError
from polycnc.controllers.apci.board._records import (
    CBCNCT,
    CDBUF,
    CIBUF,
    CNC_TASKS,
    CNCTS,
    COMMON_BUFFER_BYTES,
    COMMON_VARIABLES,
    TASK_STRING_BYTES,
)
from polycnc.controllers.apci.library._library import (
    UNKNOWN_ERROR,
    is_number,
    longint,
    polled_board,
    status_code,
    usable_board,
)
from polycnc.controllers.apci.sap import Tasks
from polycnc.controllers.apci.sap._board_host import BoardTasks

_STATUS = ("errnum", "errline", "stackfree", "running", "csrcline")
_BULK = {100: 100, COMMON_VARIABLES: COMMON_VARIABLES}  # index: variables from 0

V = TypeVar("V", int, float)


def _tasks(board: Board | None) -> Tasks | None:
    return board.tasks.tasks if board is not None and isinstance(board.tasks, BoardTasks) else None


# ---------------------------------------------------------------------- control


def startcnct(TaskNr: int) -> None:
    """Start the program of a task from its beginning; one that runs is stopped first (Manual 002, 4.4.124)."""
    if (tasks := _tasks(usable_board())) is not None:
        tasks.startcnct(TaskNr)


def stopcnct(TaskNr: int) -> None:
    """Stop the program of a task, its EVENT handlers too (Manual 002, 4.4.126)."""
    if (tasks := _tasks(usable_board())) is not None:
        tasks.stopcnct(TaskNr)


def contcnct(TaskNr: int) -> None:
    """Continue the program of a task that was stopped, not one that was aborted (Manual 002, 4.4.10)."""
    if (tasks := _tasks(usable_board())) is not None:
        tasks.contcnct(TaskNr)


def stepcnct(TaskNr: int) -> None:
    """Do nothing: the manual declares single steps as not implemented (Manual 002, 4.4.125)."""
    if (tasks := _tasks(usable_board())) is not None:
        tasks.stepcnct(TaskNr)


def rdcncts(TaskNr: int, cncts: CNCTS) -> None:
    """Read the status of a task into `cncts`; zeros for a task that is not there (Manual 002, 4.4.50)."""
    board = polled_board()
    if board is None:
        return
    tasks = _tasks(board)
    status = tasks.rdcncts(TaskNr) if tasks is not None else (0, 0, 0, 0, 0)
    for name, value in zip(_STATUS, status, strict=True):
        setattr(cncts, name, value)


# ---------------------------------------------------------------------- output


def gettskinfo(TaskNr: int) -> tuple[int, int]:
    """Return a status and what is to be read: bit 0 an incomplete, bit 1 a complete string (Manual 002, 4.4.13)."""
    board = polled_board()
    if board is None:
        return status_code(), 0
    tasks = _tasks(board)
    if tasks is not None:
        return tasks.gettskinfo(TaskNr)
    return (0 if 0 <= TaskNr < CNC_TASKS else UNKNOWN_ERROR), 0


def gettskstr(TaskNr: int, szbuffer: int = TASK_STRING_BYTES) -> tuple[int, str]:
    """Return the number of characters and the output of a task, at most `szbuffer` and 512 (Manual 002, 4.4.14)."""
    tasks = _tasks(usable_board())
    text = "" if tasks is None else tasks.gettskstr(TaskNr, szbuffer)
    return len(text), text


# ---------------------------------------------------------------------- common variables and buffers


def rdcd(ndx: int, cdbuf: CDBUF) -> None:
    """Read variable `ndx` of CD into `cdbuf.cd[ndx]`; 100 and 1000 read all below (Manual 002, 4.4.48)."""
    board = polled_board()
    if board is not None:
        _read(board.state.cd, cdbuf.cd, ndx)


def rdci(ndx: int, cibuf: CIBUF) -> None:
    """Read variable `ndx` of CI into `cibuf.ci[ndx]`; 100 and 1000 read all below (Manual 002, 4.4.49)."""
    board = polled_board()
    if board is not None:
        _read(board.state.ci, cibuf.ci, ndx)


def wrcd(ndx: int, cdbuf: CDBUF) -> None:
    """Write variable `ndx` of CD, 0 to 999, from `cdbuf.cd[ndx]` (Manual 002, 4.4.135)."""
    board = usable_board()
    if board is not None and 0 <= ndx < COMMON_VARIABLES and is_number(cdbuf.cd[ndx]):
        board.state.cd[ndx] = cdbuf.cd[ndx]


def wrci(ndx: int, cibuf: CIBUF) -> None:
    """Write variable `ndx` of CI, 0 to 999, from `cibuf.ci[ndx]`; ClearCI99 releases waits (Manual 002, 4.4.136)."""
    board = usable_board()
    if board is not None and 0 <= ndx < COMMON_VARIABLES and is_number(cibuf.ci[ndx]):
        board.state.ci[ndx] = longint(cibuf.ci[ndx])


def _read(variables: npt.NDArray[np.float64] | npt.NDArray[np.int32], into: list[V], ndx: int) -> None:
    if ndx in _BULK:
        into[: _BULK[ndx]] = variables[: _BULK[ndx]].tolist()
    elif 0 <= ndx < COMMON_VARIABLES:
        into[ndx] = variables[ndx].item()


def rdcbcnct(cbcnct: CBCNCT) -> int:
    """Copy the beginning of a common buffer into `cbcnct.buffer`; return 0 or error bits (Manual 002, 4.4.47)."""
    board = polled_board()
    error = _buffer_error(board, cbcnct)
    if board is not None and not error:
        cbcnct.buffer[: cbcnct.size] = board.variables.buffers[cbcnct.task_number][: cbcnct.size]
    return error


def wrcbcnct(cbcnct: CBCNCT) -> int:
    """Copy `cbcnct.buffer` to the beginning of a task's common buffer; return 0 or error bits (Manual 002, 4.4.134)."""
    board = usable_board()
    error = _buffer_error(board, cbcnct)
    if board is not None and not error:
        board.variables.buffers[cbcnct.task_number][: cbcnct.size] = cbcnct.buffer[: cbcnct.size]
    return error


def _buffer_error(board: Board | None, cbcnct: CBCNCT) -> int:
    error = 0 if 0 <= cbcnct.task_number < CNC_TASKS else int(BufferError.task_number)
    if not 0 <= cbcnct.size <= COMMON_BUFFER_BYTES:
        return error | BufferError.size
    no_memory = board is None or len(cbcnct.buffer) < cbcnct.size
    return error | (BufferError.address if no_memory else 0)
