"""Digital inputs and outputs, interface status, lights, and the interrupt to the PC (Manual 002, 4.4.33 ff.)."""

# ruff: noqa: E501, N802  the names are the manual's

from __future__ import annotations

from collections.abc import Callable

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.core._registers import bit_of, with_output
from polycnc.controllers.apci.library._call import (
    CODE,
    INT,
    Routine,
    axis_call,
    board_call,
    filled_call,
    polled_axis_call,
    polled_call,
    record_call,
    session_call,
)
from polycnc.controllers.apci.library._session import Exchange, Session
from polycnc.controllers.apci.library._table import Rule, read_record, record_pair
from polycnc.controllers.library import named

_OUTPUTS = Rule(polled=True, note="Outputs belong to the board, whatever the axis.")

# fmt: off
rddigi         = read_record("digi", "digi",   "the digital inputs and the signals of the encoder", "", 52, Rule(polled=True))
rddigo, wrdigo = record_pair("digo", "digo",   "the digital outputs",                               "", 54, 138, _OUTPUTS)
# fmt: on


@session_call
def rdaxstb(session: Session, an: INT, bitnr: INT) -> INT:
    """Return a bit of the axis status, 1 or 0; bits count from 1: pe is 13 (Manual 002, 4.4.46)."""
    return bit_of(session.status_of(session.polled_axis(an)), bitnr)


@polled_axis_call
def rddigib(an: BoardAxis, bitnr: INT) -> INT:
    """Return a digital input or encoder signal, 1 or 0; inputs are 1 to 16 (Manual 002, 4.4.53)."""
    return bit_of(int(an.digi), bitnr)


@polled_axis_call
def rddigob(an: BoardAxis, bitnr: INT) -> INT:
    """Return a digital output, 1 or 0; they count from 1 (Manual 002, 4.4.55)."""
    return bit_of(an.board.outputs, bitnr)


@axis_call
def wrdigob(an: BoardAxis, bitnr: INT, value: INT) -> None:
    """Set a digital output, or reset it with 0; they count from 1 (Manual 002, 4.4.139)."""
    an.board.outputs = with_output(an.board.outputs, bitnr, value)


@record_call
def rdigi(tsrp: Exchange) -> None:
    """Reset the latched signals of an axis' encoder, bits 16 to 19 of digi (Manual 002, 4.4.72)."""
    tsrp.axis.reset_signals()


# ---------------------------------------------------------------------- interface status


@filled_call
def rdifs(tsrp: Exchange) -> CODE:
    """Read the interface status into `tsrp.ifs` and return 0 (Manual 002, 4.4.70)."""
    tsrp.record.ifs = tsrp.axis.board.variables.interface.word
    return 0


@polled_axis_call
def rdifsb(an: BoardAxis, bitnr: INT) -> INT:
    """Return a bit of the interface status, 1 or 0; bits count from 1: edv is 1 (Manual 002, 4.4.71)."""
    return bit_of(an.board.variables.interface.word, bitnr)


@record_call
def rifs(tsrp: Exchange) -> None:
    """Reset the errors of the interface status (Manual 002, 4.4.111)."""
    tsrp.axis.board.variables.interface.reset_errors()


# ---------------------------------------------------------------------- lights and interrupt


def _light(name: str, colour: str, read: int, write: int) -> tuple[Callable[[], int], Callable[[int], None]]:
    """Make the function that reads a light, and the one that switches it."""

    def is_on(board: Board) -> int:
        return int(getattr(board.variables, name) != 0)

    def switch(board: Board, value: int) -> None:
        setattr(board.variables, name, int(value != 0))

    reads = f"Return whether the {colour} light is on, 1 or 0 (Manual 002, 4.4.{read})."
    writes = f"Switch the {colour} light on, or off with 0 (Manual 002, 4.4.{write})."
    return (
        board_call(named(is_on, f"rd{name}", reads, {"board": Board}, INT)),
        board_call(named(switch, f"wr{name}", writes, {"board": Board, "value": INT})),
    )


rdledgn, wrledgn = _light("ledgn", "green", 79, 155)
rdledyl, wrledyl = _light("ledyl", "yellow", 81, 157)
rdledrd, wrledrd = _light("ledrd", "red", 80, 156)


@polled_call
def rdirqpc(board: Board) -> INT:
    """Return whether an interrupt to the PC is requested, 1 or 0 (Manual 002, 4.4.74)."""
    return int(board.variables.irqpc != 0)


@session_call
def MCUG3_SetBoardIntRoutine(session: Session, func: Routine) -> INT:
    """Call `func` with the bits of the interrupt lines whenever the board interrupts the PC (Manual 002, 4.4.33)."""
    return session.line().set_routine(func)


@session_call
def MCUG3_ResetBoardIntRoutine(session: Session) -> INT:
    """Call nothing on interrupts any more (Manual 002, 4.4.34)."""
    return session.line().reset_routine()


# fmt: off
__all__ = [
    "MCUG3_ResetBoardIntRoutine", "MCUG3_SetBoardIntRoutine", "rdaxstb", "rddigi", "rddigib", "rddigo",
    "rddigob", "rdifs", "rdifsb", "rdigi", "rdirqpc", "rdledgn", "rdledrd", "rdledyl", "rifs", "wrdigo",
    "wrdigob", "wrledgn", "wrledrd", "wrledyl",
]
# fmt: on
