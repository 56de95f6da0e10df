"""The APCI-8001/8008 positioning and contouring board: profiles, spoolers, interpolation, its function library.

`pcap` is the library that programs call, by the manual's names; `Board` is the virtual board behind it.
"""

from polycnc.controllers.apci._board import Board
from polycnc.controllers.apci._installed import InstalledBoard
from polycnc.controllers.apci._registers import Axst, Digi, Digo, ErrorReg, Ifs, ModeReg
from polycnc.controllers.apci._sap_host import BoardTasks
from polycnc.controllers.apci._system_file import SystemFile, load_system_file, parse_system_file
from polycnc.controllers.apci._system_text import system_file_text

__all__ = [
    "Axst",
    "Board",
    "BoardTasks",
    "Digi",
    "Digo",
    "ErrorReg",
    "Ifs",
    "InstalledBoard",
    "ModeReg",
    "SystemFile",
    "load_system_file",
    "parse_system_file",
    "system_file_text",
]
