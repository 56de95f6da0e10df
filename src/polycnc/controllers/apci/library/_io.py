"""Digital inputs and outputs, interface status, lights, and the interrupt to the PC (Manual 002, 4.4.33 ff.)."""

# ruff: noqa: N802  the names are the manual's

from __future__ import annotations

from collections.abc import Callable

from polycnc.controllers.apci.board._axis import Axis
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._environment import InterruptLine, InterruptRoutine
from polycnc.controllers.apci.board._records import TSRP
from polycnc.controllers.apci.core._registers import assigned_inputs, bit_of, with_output
from polycnc.controllers.apci.library._library import (
    UNKNOWN_ERROR,
    library,
    polled_board,
    revision,
    status_code,
    status_mask,
    usable_axis,
    usable_board,
)
from polycnc.controllers.apci.library._table import AxisRegister
from polycnc.controllers.apci.pc._installed import InstalledBoard


def _digi(axis: Axis) -> int:
    return int(axis.digi) & assigned_inputs(axis.board.config.type_number)


def _set_outputs(axis: Axis, value: int) -> None:
    axis.board.outputs = value


rddigi = AxisRegister(
    "digi", "the digital inputs and the signals of the encoder", 0, _digi, None, "", (52,), True
).read_record("digi")
rddigo, wrdigo = AxisRegister(
    "digo",
    "the digital outputs",
    0,
    lambda axis: axis.board.outputs,
    _set_outputs,
    sections=(54, 138),
    polled=True,
    note="Outputs belong to the board, whatever the axis.",
).in_record("digo")


def _bit(word: Callable[[Axis], int], an: int, bitnr: int) -> int:
    axis = usable_axis(an, polled=True)
    return 0 if axis is None else bit_of(word(axis), bitnr)


def rdaxstb(an: int, bitnr: int) -> int:
    """Return a bit of the axis status, 1 or 0; bits count from 1: pe is 13 (Manual 002, 4.4.46)."""
    return _bit(lambda axis: axis.status_word & status_mask(revision()), an, bitnr)


def rddigib(an: int, bitnr: int) -> int:
    """Return a digital input or encoder signal, 1 or 0; inputs are 1 to 16 (Manual 002, 4.4.53)."""
    return _bit(_digi, an, bitnr)


def rddigob(an: int, bitnr: int) -> int:
    """Return a digital output, 1 or 0; they count from 1 (Manual 002, 4.4.55)."""
    return _bit(lambda axis: axis.board.outputs, an, bitnr)


def wrdigob(an: int, bitnr: int, value: int) -> None:
    """Set a digital output, or reset it with 0; they count from 1 (Manual 002, 4.4.139)."""
    axis = usable_axis(an)
    if axis is not None:
        axis.board.outputs = with_output(axis.board.outputs, bitnr, value)


def rdigi(tsrp: TSRP) -> None:
    """Reset the latched signals of an axis' encoder, bits 16 to 19 of digi (Manual 002, 4.4.72)."""
    axis = usable_axis(tsrp.an)
    if axis is not None:
        for name in ("index_now", "encoder_error", "index_seen", "strobe_seen"):
            axis.row[name] = 0


# ---------------------------------------------------------------------- interface status


def _interface(an: int, *, polled: bool = False) -> InstalledBoard | None:
    return library().installed() if usable_axis(an, polled=polled) is not None else None


def rdifs(tsrp: TSRP) -> int:
    """Read the interface status into `tsrp.ifs` and return 0 (Manual 002, 4.4.70)."""
    installed = _interface(tsrp.an, polled=True)
    if installed is None:
        return status_code() or UNKNOWN_ERROR
    tsrp.ifs = installed.interface.word
    return 0


def rdifsb(an: int, bitnr: int) -> int:
    """Return a bit of the interface status, 1 or 0; bits count from 1: edv is 1 (Manual 002, 4.4.71)."""
    installed = _interface(an, polled=True)
    return 0 if installed is None else bit_of(installed.interface.word, bitnr)


def rifs(tsrp: TSRP) -> None:
    """Reset the errors of the interface status (Manual 002, 4.4.111)."""
    installed = _interface(tsrp.an)
    if installed is not None:
        installed.interface.reset_errors()


# ---------------------------------------------------------------------- lights and interrupt


def rdledgn() -> int:
    """Return whether the green light is on, 1 or 0 (Manual 002, 4.4.79)."""
    return _light("ledgn")


def rdledyl() -> int:
    """Return whether the yellow light is on, 1 or 0 (Manual 002, 4.4.81)."""
    return _light("ledyl")


def rdledrd() -> int:
    """Return whether the red light is on, 1 or 0 (Manual 002, 4.4.80)."""
    return _light("ledrd")


def wrledgn(value: int) -> None:
    """Switch the green light on, or off with 0 (Manual 002, 4.4.155)."""
    _switch("ledgn", value)


def wrledyl(value: int) -> None:
    """Switch the yellow light on, or off with 0 (Manual 002, 4.4.157)."""
    _switch("ledyl", value)


def wrledrd(value: int) -> None:
    """Switch the red light on, or off with 0 (Manual 002, 4.4.156)."""
    _switch("ledrd", value)


def _light(name: str) -> int:
    return _variable(usable_board(), name)


def _switch(name: str, value: int) -> None:
    board = usable_board()
    if board is not None:
        setattr(board.variables, name, int(value != 0))


def rdirqpc() -> int:
    """Return whether an interrupt to the PC is requested, 1 or 0 (Manual 002, 4.4.74)."""
    return _variable(polled_board(), "irqpc")


def _variable(board: Board | None, name: str) -> int:
    return 0 if board is None else int(getattr(board.variables, name) != 0)


def MCUG3_SetBoardIntRoutine(func: InterruptRoutine) -> int:
    """Call `func` with the bits of the interrupt lines whenever the board interrupts the PC (Manual 002, 4.4.33)."""
    line = _line()
    return 0 if line is None else line.set_routine(func)


def MCUG3_ResetBoardIntRoutine() -> int:
    """Call nothing on interrupts any more (Manual 002, 4.4.34)."""
    line = _line()
    return 0 if line is None else line.reset_routine()


def _line() -> InterruptLine | None:
    slot = library().application.slot
    return library().lines.get(slot.board) if slot and isinstance(slot.board, InstalledBoard) else None
