"""Every return code of the board's library, with a short text of our own."""

from __future__ import annotations

from polycnc.controllers.apci.core._registers import Bits
from polycnc.controllers.library import Code


class Status(Code):
    """What most functions return; any other number but 0 is an unknown error."""

    DONE = 0, "done"
    NOT_AVAILABLE = -1, "this version of the operating system does not know the function"
    TIMEOUT = -4, "the board does not answer"


class Success(Code):
    """What rdSampleTime and rdslsp return, the other way round than all others."""

    FAILED = 0, "failed, for example because the operating system does not know the function"
    DONE = 1, "done"


class BootCode(Code):
    """What BootFile returns."""

    DONE = 0, "the board is booted"
    FILE_NAME = 10, "this is no file name"
    CANNOT_OPEN = 11, "the file cannot be opened"
    UNKNOWN_FORMAT = 12, "the file is no ELF file"
    BAD_ELF = 13, "the ELF file is damaged, or its transfer failed"
    START_ADDRESS = 14, "the start address in the file is wrong"
    WRONG_PLATFORM = 15, "the file is for another board"
    VERIFY_FAILED = 16, "the board did not receive what was sent"
    FLASH_ACCESS = 200, "the board's flash memory cannot be reached"
    FLASH_SIZE = 201, "the board's flash memory has the wrong size"
    DEVICE_ADDRESSES = 202, "the board cannot be reached at its addresses"


class InitCode(Code):
    """What InitMcuSystem, InitMcuSystem2 and InitMcuSystem3 return; also every code of a file transfer."""

    DONE = 0, "the system is initialised"
    NO_BOARD = 31, "there is no board in the PC"
    NOT_BOOTED = 32, "the operating system is not loaded, or has stopped; boot the board"
    VERSION_MISMATCH = 33, "the library and the operating system do not belong together"
    NO_DRIVER = 34, "the device driver cannot be opened"
    MAPPING = 35, "the board's memory cannot be mapped"
    MAPPING_IN = 36, "the board's memory cannot be mapped in"
    MAPPING_OUT = 37, "the board's memory cannot be mapped out"
    BOARD_ACCESS = 38, "the board cannot be reached"
    MAILBOX_ACCESS = 39, "the board's mailbox cannot be reached"


class TransferCode(Code):
    """What txbf and txbf2 return."""

    DONE = 0, "the file is transferred"
    CANNOT_OPEN = 20, "the file cannot be found or opened"
    TOO_LARGE = 21, "the file is larger than the memory of a CNC task"
    WRONG_TYPE = 22, "the file is neither a system file nor a CNC file"
    MEMORY = 23, "no memory for the transfer"
    DAMAGED = 24, "there is no such task, or the system file is damaged"
    REMOTE = 25, "the transfer to the remote system failed"


class BufferError(Bits):
    """What rdcbcnct and wrcbcnct return, bit by bit; 0 is done."""

    task_number = 0, "there is no such task"
    size = 1, "the buffer is not that large"
    address = 2, "there is no memory at this address"


CARD_NOT_THERE = -1  # CardSelect: board 0 is selected instead


def boot_text(code: int) -> str:
    """Return what a code of BootFile means."""
    return _text(code, BootCode)


def init_text(code: int) -> str:
    """Return what a code of InitMcuSystem, InitMcuSystem2 or InitMcuSystem3 means."""
    return _text(code, InitCode, TransferCode)


def transfer_text(code: int) -> str:
    """Return what a code of txbf or txbf2 means."""
    return _text(code, TransferCode)


def status_text(code: int) -> str:
    """Return what a code of a function with the usual status means."""
    return _text(code, Status)


def _text(code: int, *tables: type[Code]) -> str:
    return next((known.text for table in tables for known in table if known == code), f"unknown error {code}")
