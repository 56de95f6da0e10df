"""Selecting, booting and initialising boards, transferring files, reporting errors (Manual 002, 4.4.4 to 4.4.130)."""

# ruff: noqa: N802, N803  the names are the manual's

from __future__ import annotations

from collections.abc import Sequence

from polycnc.controllers.apci.board._records import ROSI, TSRP, CppString
from polycnc.controllers.apci.library._library import library


def CardSelect(CardNumber: int) -> int:
    """Select a board, from 0, and return its number; -1 if it is not there: then it is board 0 (Manual 002, 4.4.6).

    InitMcuSystem3 must have been called before, so that the list of boards is known.
    """
    return library().application.card_select(CardNumber)


def BootFile(BootFileName: str, TpuBaseAddress: int = 0) -> int:
    """Reset the board, load its operating system and return 0 or a `BootCode` (Manual 002, 4.4.5)."""
    return int(library().application.boot_file(BootFileName, TpuBaseAddress))


def mcuinit(rosi: ROSI) -> None:
    """Fill `rosi` from the board, with zeros if it does not answer (Manual 002, 4.4.32)."""
    library().application.mcuinit(rosi)


def InitMcuSystem(tsrp: Sequence[TSRP]) -> int:
    """Initialise the connection and `tsrp`, with system.dat if none is loaded; return a code (Manual 002, 4.4.16)."""
    return int(library().application.init_mcu_system(tsrp))


def InitMcuSystem2(tsrp: Sequence[TSRP], TpuBaseAddress: int, SystemFileName: str) -> int:
    """Initialise the connection and `tsrp`, with a system file of any name; return a code (Manual 002, 4.4.17)."""
    return int(library().application.init_mcu_system2(tsrp, TpuBaseAddress, SystemFileName))


def InitMcuSystem3(
    tsrp: Sequence[TSRP], rosi: ROSI, TpuBaseAddress: int, SystemFileName: str
) -> tuple[int, int]:
    """Initialise the connection, `tsrp` and `rosi`; return a code and the type of the board (Manual 002, 4.4.18)."""
    code, board_type = library().application.init_mcu_system3(tsrp, rosi, TpuBaseAddress, SystemFileName)
    return int(code), int(board_type)


def txbf(filename: str) -> int:
    """Transfer a system file or CNC file without a folder in its name; return a code (Manual 002, 4.4.129)."""
    return int(library().application.txbf(filename))


def txbf2(filename: str) -> int:
    """Transfer a system file or CNC file and return 0 or a `TransferCode` (Manual 002, 4.4.129)."""
    return int(library().application.txbf2(filename))


def getEnvStr(EnvStr: str) -> tuple[int, str]:
    """Return the length and the value of an environment string of the board; negative is an error (Manual 002, 4.4.12).

    The manual's string goes both ways; here the value is returned. On an error it is the name.
    """
    text = CppString(EnvStr)
    return int(library().application.get_env_str(text)), text.text


def MsgToScreen(Enable: int) -> None:
    """Switch the message boxes on, or off with 0 (Manual 002, 4.4.40)."""
    library().messages.msg_to_screen(Enable)


def BootErrorReport(filename: str, error: int) -> None:
    """Show what a code of BootFile means (Manual 002, 4.4.4)."""
    library().messages.boot_error_report(filename, error)


def InitMcuErrorReport(error: int) -> None:
    """Show what a code of InitMcuSystem, InitMcuSystem2 or InitMcuSystem3 means (Manual 002, 4.4.15)."""
    library().messages.init_mcu_error_report(error)


def txbfErrorReport(filename: str, error: int) -> None:
    """Show what a code of txbf2 means (Manual 002, 4.4.130)."""
    library().messages.txbf_error_report(filename, error)
