"""The return codes of the function library, by the names of the manual (Manual 000, 2) and of its header."""

from __future__ import annotations

from polycnc.controllers.library import Code


class EW(Code):
    """What a function answers: 0 is success, below 0 the way to the control, above 0 the request.

    Some numbers have a second name in functions of the PMC.
    """

    EW_PROTOCOL = -17, "who answers on the network does not speak the protocol"
    EW_SOCKET = -16, "no connection over the network, or it was lost"
    EW_NODLL = -15, "the library of this control is missing"
    EW_INIERR = -14, "the library cannot be initialised"
    EW_ITLOW = -13, "low temperature alarm of the intelligent terminal"
    EW_ITHIGHT = -12, "high temperature alarm of the intelligent terminal"
    EW_BUS = -11, "bus error of the control"
    EW_SYSTEM2 = -10, "system error (2) of the control"
    EW_HSSB = -9, "no communication with the control: the cable or the interface board"
    EW_HANDLE = -8, "bad library handle"
    EW_VERSION = -7, "library and control do not match"
    EW_UNEXP = -6, "unexpected error"
    EW_SYSTEM = -5, "system error of the control"
    EW_PARITY = -4, "parity error of the shared memory"
    EW_MMCSYS = -3, "system error of the intelligent terminal"
    EW_RESET = -2, "RESET or STOP was pressed"
    EW_BUSY = -1, "busy: wait until the control has finished, or try again"
    EW_OK = 0, "normal end"
    EW_FUNC = 1, "the function that comes before was not executed, or this one is not available"
    EW_NOPMC = 1, "there is no PMC"
    EW_LENGTH = 2, "wrong length of the data block, or number of data"
    EW_NUMBER = 3, "wrong data number"
    EW_RANGE = 3, "wrong address range of the PMC"
    EW_ATTRIB = 4, "wrong attribute: axis, kind or type"
    EW_TYPE = 4, "wrong data type of the PMC"
    EW_DATA = 5, "wrong data; there is no such program"
    EW_NOOPT = 6, "the option is not fitted"
    EW_PROT = 7, "write protected"
    EW_OVRFLOW = 8, "the memory is full"
    EW_PARAM = 9, "a parameter is set wrongly"
    EW_BUFFER = 10, "the buffer is empty or full"
    EW_PATH = 11, "wrong path number"
    EW_MODE = 12, "the control is in the wrong mode"
    EW_REJECT = 13, "the control refuses to execute it"
    EW_DTSRVR = 14, "error of the data server"


EW_PROTOCOL = EW.EW_PROTOCOL
EW_SOCKET = EW.EW_SOCKET
EW_NODLL = EW.EW_NODLL
EW_INIERR = EW.EW_INIERR
EW_ITLOW = EW.EW_ITLOW
EW_ITHIGHT = EW.EW_ITHIGHT
EW_BUS = EW.EW_BUS
EW_SYSTEM2 = EW.EW_SYSTEM2
EW_HSSB = EW.EW_HSSB
EW_HANDLE = EW.EW_HANDLE
EW_VERSION = EW.EW_VERSION
EW_UNEXP = EW.EW_UNEXP
EW_SYSTEM = EW.EW_SYSTEM
EW_PARITY = EW.EW_PARITY
EW_MMCSYS = EW.EW_MMCSYS
EW_RESET = EW.EW_RESET
EW_BUSY = EW.EW_BUSY
EW_OK = EW.EW_OK
EW_FUNC = EW.EW_FUNC
EW_NOPMC = EW.EW_NOPMC
EW_LENGTH = EW.EW_LENGTH
EW_NUMBER = EW.EW_NUMBER
EW_RANGE = EW.EW_RANGE
EW_ATTRIB = EW.EW_ATTRIB
EW_TYPE = EW.EW_TYPE
EW_DATA = EW.EW_DATA
EW_NOOPT = EW.EW_NOOPT
EW_PROT = EW.EW_PROT
EW_OVRFLOW = EW.EW_OVRFLOW
EW_PARAM = EW.EW_PARAM
EW_BUFFER = EW.EW_BUFFER
EW_PATH = EW.EW_PATH
EW_MODE = EW.EW_MODE
EW_REJECT = EW.EW_REJECT
EW_DTSRVR = EW.EW_DTSRVR

ALL_AXES = -1
"""All axes, where an axis number is asked for."""

__all__ = [
    "ALL_AXES",
    "EW",
    "EW_ATTRIB",
    "EW_BUFFER",
    "EW_BUS",
    "EW_BUSY",
    "EW_DATA",
    "EW_DTSRVR",
    "EW_FUNC",
    "EW_HANDLE",
    "EW_HSSB",
    "EW_INIERR",
    "EW_ITHIGHT",
    "EW_ITLOW",
    "EW_LENGTH",
    "EW_MMCSYS",
    "EW_MODE",
    "EW_NODLL",
    "EW_NOOPT",
    "EW_NOPMC",
    "EW_NUMBER",
    "EW_OK",
    "EW_OVRFLOW",
    "EW_PARAM",
    "EW_PARITY",
    "EW_PATH",
    "EW_PROT",
    "EW_PROTOCOL",
    "EW_RANGE",
    "EW_REJECT",
    "EW_RESET",
    "EW_SOCKET",
    "EW_SYSTEM",
    "EW_SYSTEM2",
    "EW_TYPE",
    "EW_UNEXP",
    "EW_VERSION",
]
