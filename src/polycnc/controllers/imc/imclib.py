"""The function library of the iMC card: all its functions, structures and codes, by the manual's names.

`attach` puts virtual cards on the network; then a program runs as it is written in the manual::

    from polycnc.controllers.imc import Card, imclib

    imclib.attach(Card())
    info = imclib.NIC_INFO()
    status, num = imclib.IMC_FindNetCard(info)
    status, handle = imclib.IMC_Open(0, 0)
    imclib.IMC_SetParam16(handle, imclib.runLoc, -1, 0, imclib.SEL_IFIFO)
    imclib.IMC_MoveAbsolute(handle, 6250, 0, imclib.SEL_QFIFO)
    while imclib.IMC_GetParam16(handle, imclib.movingLoc, 0)[1]:
        pass

Arguments are the manual's, in its order. Structures are passed and filled in place, as in C. Pointers to single numbers
are no arguments: a function returns its status, and behind it what it reads (`status, value = IMC_GetParam16(...)`).
A call that is refused changes nothing. Addresses are the macros of the parameter header: the parameter's name and
`Loc`. Calls may come from several threads; one at a time is carried out.

An instruction for IFIFO takes one control cycle; all other time passes when a program reads: see `attach`.
"""

from __future__ import annotations

from polycnc.controllers.imc.core._event_codes import EventCommand, EventType
from polycnc.controllers.imc.core._parameters import PARAMETERS
from polycnc.controllers.imc.library._codes import (
    FIFO_SEL,
    IMC_CHECK_ERROR,
    IMC_DEVICE_NOT_FOUND,
    IMC_DEVICE_NOT_OPEN,
    IMC_FIFO_FULL,
    IMC_FIFO_NULL,
    IMC_INVALID_AXIS,
    IMC_INVALID_FIFO,
    IMC_INVALID_HANDLE,
    IMC_INVALID_PARAM,
    IMC_OK,
    IMC_OTHER_ERROR,
    IMC_OUT_OF_RANGE,
    IMC_PARAM_READ_ONLY,
    IMC_PASSWORD_ERROR,
    IMC_RBFIFO_EMPTY,
    IMC_READ_FAIL,
    IMC_SEND_FAIL,
    IMC_STATUS,
    IMC_TIME_OUT,
    IMC_VERSION_ERROR,
    SEL_CFIFO,
    SEL_IFIFO,
    SEL_PFIFO1,
    SEL_PFIFO2,
    SEL_QFIFO,
)
from polycnc.controllers.imc.library._device import (
    IMC_Close,
    IMC_FindNetCard,
    IMC_Open,
    IMC_OpenUsePassword,
    IMC_OpenX,
)
from polycnc.controllers.imc.library._memory import (
    IMC_GetMulParam,
    IMC_GetParam16,
    IMC_GetParam32,
    IMC_GetParam48,
    IMC_GetParamBit,
    IMC_ORXORParam,
    IMC_SetMulParam,
    IMC_SetParam16,
    IMC_SetParam32,
    IMC_SetParam48,
    IMC_SetParamBit,
    IMC_TurnParamBit,
    IMC_WaitParam,
    IMC_WaitParamBit,
    IMC_WaitParamMask,
    IMC_WaitTime,
)
from polycnc.controllers.imc.library._motion import (
    IMC_GearFree,
    IMC_GearInDist,
    IMC_GearInTime,
    IMC_HandWheel,
    IMC_HomeIndex,
    IMC_HomeSwitch1,
    IMC_HomeSwitch2,
    IMC_HomeSwitch3,
    IMC_HomeSwitchIndex1,
    IMC_HomeSwitchIndex2,
    IMC_HomeSwitchIndex3,
    IMC_MoveAbsolute,
    IMC_MoveInDist,
    IMC_MoveInTime,
    IMC_MoveRelative,
    IMC_MoveSuperimposed,
    IMC_MoveVelocity,
    IMC_Phasing,
    IMC_TgvelInDist,
    IMC_TgvelInTime,
)
from polycnc.controllers.imc.library._network import (
    IMC_HANDLE,
    NetCard,
    Port,
    attach,
    detach,
)
from polycnc.controllers.imc.library._path import (
    IMC_AddArc,
    IMC_AddArcLine,
    IMC_AddArcLineWithVel,
    IMC_AddArcWithVel,
    IMC_AddLineN,
    IMC_AddLineNWithVel,
    IMC_AddSpiral,
    IMC_AddSpiralWithVel,
    IMC_ClearFIFO,
    IMC_GetCapData,
    IMC_InstallEvent,
    IMC_PutContourData,
)
from polycnc.controllers.imc.library._structs import (
    NIC_INFO,
    WR_MUL_DES,
    EventInfo,
    PFIFOSegData,
    PFIFOSegInfo,
)

IMC_EVENT_CMD = EventCommand
IMC_EventType = EventType

(
    CMD_ADD32,
    CMD_ADD32i,
    CMD_ADD48,
    CMD_ADD48i,
    CMD_CMP32,
    CMD_CMP32i,
    CMD_CMP48,
    CMD_CMP48i,
    CMD_SCA32,
    CMD_SCA32i,
    CMD_SCA48,
    CMD_SCA48i,
    CMD_MUL32L,
    CMD_MUL32iL,
    CMD_MUL32A,
    CMD_MUL32iA,
    CMD_COP16,
    CMD_COP32,
    CMD_COP48,
    CMD_SET16,
    CMD_SET32,
    CMD_SET48,
    CMD_OR16,
    CMD_OR16i,
    CMD_OR16B,
    CMD_OR16iB,
    CMD_AND16,
    CMD_AND16i,
    CMD_AND16B,
    CMD_AND16iB,
    CMD_XOR16,
    CMD_XOR16i,
    CMD_XOR16B,
    CMD_XOR16iB,
) = IMC_EVENT_CMD

(
    IMC_Allways,
    IMC_Edge_Zero,
    IMC_Edge_NotZero,
    IMC_Edge_Great,
    IMC_Edge_GreatEqu,
    IMC_Edge_Little,
    IMC_Edge_Carry,
    IMC_Edge_NotCarry,
    IMC_IF_Zero,
    IMC_IF_NotZero,
    IMC_IF_Great,
    IMC_IF_GreatEqu,
    IMC_IF_Little,
    IMC_IF_Carry,
    IMC_IF_NotCarry,
) = IMC_EventType

# Other names: as the manual misprints them, and for what its print has lost.
COP48 = CMD_COP48
IMC_AddApiralWithVel = IMC_AddSpiralWithVel
IMC_AddApiralWitchVel = IMC_AddSpiralWithVel
IMC_GetPatamBit = IMC_GetParamBit
IMC_AddContourData = IMC_PutContourData
IMC_MoveTP = IMC_MoveInTime
IMC_MovePP = IMC_MoveInDist
IMC_MoveTV = IMC_TgvelInTime
IMC_MovePV = IMC_TgvelInDist

_ADDRESSES = {f"{each.name}Loc": each.address for each in PARAMETERS.values()}
_ADDRESSES["startgroup"] = _ADDRESSES["startgroupLoc"]  # the one macro that is printed without its ending


def __getattr__(name: str) -> int:
    """Return the address that a macro of the parameter header stands for."""
    if name in _ADDRESSES:
        return _ADDRESSES[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, *_ADDRESSES])


__all__ = [
    "CMD_ADD32",
    "CMD_ADD48",
    "CMD_AND16",
    "CMD_AND16B",
    "CMD_CMP32",
    "CMD_CMP48",
    "CMD_COP16",
    "CMD_COP32",
    "CMD_COP48",
    "CMD_MUL32A",
    "CMD_MUL32L",
    "CMD_OR16",
    "CMD_OR16B",
    "CMD_SCA32",
    "CMD_SCA48",
    "CMD_SET16",
    "CMD_SET32",
    "CMD_SET48",
    "CMD_XOR16",
    "CMD_XOR16B",
    "COP48",
    "FIFO_SEL",
    "IMC_CHECK_ERROR",
    "IMC_DEVICE_NOT_FOUND",
    "IMC_DEVICE_NOT_OPEN",
    "IMC_EVENT_CMD",
    "IMC_FIFO_FULL",
    "IMC_FIFO_NULL",
    "IMC_HANDLE",
    "IMC_INVALID_AXIS",
    "IMC_INVALID_FIFO",
    "IMC_INVALID_HANDLE",
    "IMC_INVALID_PARAM",
    "IMC_OK",
    "IMC_OTHER_ERROR",
    "IMC_OUT_OF_RANGE",
    "IMC_PARAM_READ_ONLY",
    "IMC_PASSWORD_ERROR",
    "IMC_RBFIFO_EMPTY",
    "IMC_READ_FAIL",
    "IMC_SEND_FAIL",
    "IMC_STATUS",
    "IMC_TIME_OUT",
    "IMC_VERSION_ERROR",
    "NIC_INFO",
    "SEL_CFIFO",
    "SEL_IFIFO",
    "SEL_PFIFO1",
    "SEL_PFIFO2",
    "SEL_QFIFO",
    "WR_MUL_DES",
    "CMD_ADD32i",
    "CMD_ADD48i",
    "CMD_AND16i",
    "CMD_AND16iB",
    "CMD_CMP32i",
    "CMD_CMP48i",
    "CMD_MUL32iA",
    "CMD_MUL32iL",
    "CMD_OR16i",
    "CMD_OR16iB",
    "CMD_SCA32i",
    "CMD_SCA48i",
    "CMD_XOR16i",
    "CMD_XOR16iB",
    "EventInfo",
    "IMC_AddApiralWitchVel",
    "IMC_AddApiralWithVel",
    "IMC_AddArc",
    "IMC_AddArcLine",
    "IMC_AddArcLineWithVel",
    "IMC_AddArcWithVel",
    "IMC_AddContourData",
    "IMC_AddLineN",
    "IMC_AddLineNWithVel",
    "IMC_AddSpiral",
    "IMC_AddSpiralWithVel",
    "IMC_Allways",
    "IMC_ClearFIFO",
    "IMC_Close",
    "IMC_Edge_Carry",
    "IMC_Edge_Great",
    "IMC_Edge_GreatEqu",
    "IMC_Edge_Little",
    "IMC_Edge_NotCarry",
    "IMC_Edge_NotZero",
    "IMC_Edge_Zero",
    "IMC_EventType",
    "IMC_FindNetCard",
    "IMC_GearFree",
    "IMC_GearInDist",
    "IMC_GearInTime",
    "IMC_GetCapData",
    "IMC_GetMulParam",
    "IMC_GetParam16",
    "IMC_GetParam32",
    "IMC_GetParam48",
    "IMC_GetParamBit",
    "IMC_GetPatamBit",
    "IMC_HandWheel",
    "IMC_HomeIndex",
    "IMC_HomeSwitch1",
    "IMC_HomeSwitch2",
    "IMC_HomeSwitch3",
    "IMC_HomeSwitchIndex1",
    "IMC_HomeSwitchIndex2",
    "IMC_HomeSwitchIndex3",
    "IMC_IF_Carry",
    "IMC_IF_Great",
    "IMC_IF_GreatEqu",
    "IMC_IF_Little",
    "IMC_IF_NotCarry",
    "IMC_IF_NotZero",
    "IMC_IF_Zero",
    "IMC_InstallEvent",
    "IMC_MoveAbsolute",
    "IMC_MoveInDist",
    "IMC_MoveInTime",
    "IMC_MovePP",
    "IMC_MovePV",
    "IMC_MoveRelative",
    "IMC_MoveSuperimposed",
    "IMC_MoveTP",
    "IMC_MoveTV",
    "IMC_MoveVelocity",
    "IMC_ORXORParam",
    "IMC_Open",
    "IMC_OpenUsePassword",
    "IMC_OpenX",
    "IMC_Phasing",
    "IMC_PutContourData",
    "IMC_SetMulParam",
    "IMC_SetParam16",
    "IMC_SetParam32",
    "IMC_SetParam48",
    "IMC_SetParamBit",
    "IMC_TgvelInDist",
    "IMC_TgvelInTime",
    "IMC_TurnParamBit",
    "IMC_WaitParam",
    "IMC_WaitParamBit",
    "IMC_WaitParamMask",
    "IMC_WaitTime",
    "NetCard",
    "PFIFOSegData",
    "PFIFOSegInfo",
    "Port",
    "attach",
    "detach",
]
