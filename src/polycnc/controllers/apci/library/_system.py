"""Selecting, booting and initialising boards, transferring files, reporting errors (Manual 002, 4.4.4 to 4.4.130)."""

# ruff: noqa: N802, N803  the names are the manual's

from __future__ import annotations

from polycnc.controllers.apci.board._declared import CppString
from polycnc.controllers.apci.library._call import (
    CODE,
    INT,
    LONG,
    TEXT,
    BoardType,
    Environment,
    FilledRecords,
    FilledSystem,
    session_call,
)
from polycnc.controllers.apci.library._session import Session


@session_call
def CardSelect(session: Session, CardNumber: INT) -> INT:
    """Select a board, from 0, and return its number; -1 if it is not there: then it is board 0 (Manual 002, 4.4.6).

    InitMcuSystem3 must have been called before, so that the list of boards is known.
    """
    return session.application.card_select(CardNumber)


@session_call
def BootFile(session: Session, BootFileName: TEXT, TpuBaseAddress: INT = 0) -> CODE:
    """Reset the board, load its operating system and return 0 or a `BootCode` (Manual 002, 4.4.5)."""
    return int(session.application.boot_file(BootFileName, TpuBaseAddress))


@session_call
def mcuinit(session: Session, rosi: FilledSystem) -> None:
    """Fill `rosi` from the board, with zeros if it does not answer (Manual 002, 4.4.32)."""
    session.application.mcuinit(rosi)


@session_call
def InitMcuSystem(session: Session, tsrp: FilledRecords) -> CODE:
    """Initialise the connection and `tsrp`, with system.dat if none is loaded; return a code (Manual 002, 4.4.16)."""
    return int(session.application.init_mcu_system(tsrp))


@session_call
def InitMcuSystem2(session: Session, tsrp: FilledRecords, TpuBaseAddress: INT, SystemFileName: TEXT) -> CODE:
    """Initialise the connection and `tsrp`, with a system file of any name; return a code (Manual 002, 4.4.17)."""
    return int(session.application.init_mcu_system2(tsrp, TpuBaseAddress, SystemFileName))


@session_call
def InitMcuSystem3(
    session: Session, tsrp: FilledRecords, rosi: FilledSystem, TpuBaseAddress: INT, SystemFileName: TEXT
) -> tuple[CODE, BoardType]:
    """Initialise the connection, `tsrp` and `rosi`; return a code and the type of the board (Manual 002, 4.4.18)."""
    code, board_type = session.application.init_mcu_system3(tsrp, rosi, TpuBaseAddress, SystemFileName)
    return int(code), int(board_type)


@session_call
def txbf(session: Session, filename: TEXT) -> CODE:
    """Transfer a system file or CNC file without a folder in its name; return a code (Manual 002, 4.4.129)."""
    return int(session.application.txbf(filename))


@session_call
def txbf2(session: Session, filename: TEXT) -> CODE:
    """Transfer a system file or CNC file and return 0 or a `TransferCode` (Manual 002, 4.4.129)."""
    return int(session.application.txbf2(filename))


@session_call
def getEnvStr(session: Session, EnvStr: Environment) -> tuple[CODE, TEXT]:
    """Return the length and the value of an environment string of the board; negative is an error (Manual 002, 4.4.12).

    The manual's string goes both ways; here the value is returned. On an error it is the name.
    """
    text = CppString(EnvStr)
    return int(session.application.get_env_str(text)), text.text


@session_call
def MsgToScreen(session: Session, Enable: LONG) -> None:
    """Switch the message boxes on, or off with 0 (Manual 002, 4.4.40)."""
    session.messages.msg_to_screen(Enable)


@session_call
def BootErrorReport(session: Session, filename: TEXT, error: INT) -> None:
    """Show what a code of BootFile means (Manual 002, 4.4.4)."""
    session.messages.boot_error_report(filename, error)


@session_call
def InitMcuErrorReport(session: Session, error: INT) -> None:
    """Show what a code of InitMcuSystem, InitMcuSystem2 or InitMcuSystem3 means (Manual 002, 4.4.15)."""
    session.messages.init_mcu_error_report(error)


@session_call
def txbfErrorReport(session: Session, filename: TEXT, error: INT) -> None:
    """Show what a code of txbf2 means (Manual 002, 4.4.130)."""
    session.messages.txbf_error_report(filename, error)


# fmt: off
__all__ = [
    "BootErrorReport", "BootFile", "CardSelect", "InitMcuErrorReport", "InitMcuSystem", "InitMcuSystem2",
    "InitMcuSystem3", "MsgToScreen", "getEnvStr", "mcuinit", "txbf", "txbf2", "txbfErrorReport",
]
# fmt: on
