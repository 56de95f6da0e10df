"""The APCI-8001/8008 positioning and contouring board: profiles, spoolers, interpolation, its function library.

`pcap` is the library that programs call, by the manual's names; `Board` is the virtual board behind it.
"""

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import BootCode, InitCode, Status, Success, TransferCode
from polycnc.controllers.apci.board._system_file import SystemFile, load_system_file, parse_system_file
from polycnc.controllers.apci.board._system_text import system_file_text
from polycnc.controllers.apci.core._registers import Axst, Digi, Digo, ErrorReg, Ifs, ModeReg
from polycnc.controllers.apci.pc._installed import InstalledBoard
from polycnc.controllers.apci.sap._board_host import BoardTasks

__all__ = [
    "Axst",
    "Board",
    "BoardTasks",
    "BootCode",
    "Digi",
    "Digo",
    "ErrorReg",
    "Ifs",
    "InitCode",
    "InstalledBoard",
    "ModeReg",
    "Status",
    "Success",
    "SystemFile",
    "TransferCode",
    "load_system_file",
    "parse_system_file",
    "system_file_text",
]
