"""A good call of each function that sends something to the card, without its queue, and the rows they belong to."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain
from typing import Any

from polycnc.controllers.imc import imclib as lib


def line(count: int = 2) -> lib.PFIFOSegData:
    """Return a line of so many axes."""
    return lib.PFIFOSegData(datanum=count)


def fast(count: int = 2) -> lib.PFIFOSegInfo:
    """Return a line with its own speed."""
    return lib.PFIFOSegInfo.of(65536, 0, line(count))


def many(*elements: tuple[int, int, int]) -> list[lib.WR_MUL_DES]:
    """Return descriptions of parameters: address, axis, words."""
    return [lib.WR_MUL_DES.of(addr, axis, length) for addr, axis, length in elements]


SENDERS: dict[str, tuple[Any, ...]] = {
    "IMC_SetMulParam": (many((12, 0, 2)), 1),
    "IMC_SetParam16": (12, 5, 0),
    "IMC_SetParam32": (12, 5, 0),
    "IMC_SetParam48": (175, 5, 0),
    "IMC_SetParamBit": (562, 0, 1, 0),
    "IMC_ORXORParam": (562, 1, 1, 0),
    "IMC_TurnParamBit": (562, 0, 0),
    "IMC_InstallEvent": ([lib.EventInfo.of(lib.CMD_SET16, src2=1, dest=(307, 0))], 1),
    "IMC_MoveAbsolute": (5, 0),
    "IMC_MoveRelative": (5, 0),
    "IMC_MoveSuperimposed": (5, 0),
    "IMC_Phasing": (5, 0),
    "IMC_MoveVelocity": (5, 0),
    "IMC_HomeSwitch1": (0, 1, 0, 0),
    "IMC_HomeSwitch2": (0, 1, 0, 0),
    "IMC_HomeSwitch3": (0, 1, 0, 0),
    "IMC_HomeSwitchIndex1": (0, 1, 0, 0),
    "IMC_HomeSwitchIndex2": (0, 1, 0, 0),
    "IMC_HomeSwitchIndex3": (0, 1, 0, 0),
    "IMC_HomeIndex": (0, 0, 0),
    "IMC_GearFree": (0.5, 1, 0, 0),
    "IMC_GearInDist": (0.5, 1, 0, 1, 0, 1000, 0),
    "IMC_GearInTime": (0.5, 1, 0, 1000, 0),
    "IMC_HandWheel": (10.0, 1, 0),
    "IMC_MoveInTime": (1000, 5000, 0),
    "IMC_MoveInDist": (2000, 1, 500, 0),
    "IMC_TgvelInTime": (500, 65536, 0),
    "IMC_TgvelInDist": (2000, 1, 65536, 0),
}
WAITERS: dict[str, tuple[Any, ...]] = {
    "IMC_WaitTime": (100,),
    "IMC_WaitParamBit": (562, 2, 1, 0, 0),
    "IMC_WaitParam": (218, 0, 0, 0),
    "IMC_WaitParamMask": (562, 7, 4, 0, 0),
}
PATHS: dict[str, tuple[Any, ...]] = {
    "IMC_AddLineNWithVel": (fast(),),
    "IMC_AddLineN": (line(),),
    "IMC_AddArcLineWithVel": (fast(),),
    "IMC_AddArcLine": (line(),),
    "IMC_AddArcWithVel": (65536, 0, 1000, 1000, 0, 1000, 0),
    "IMC_AddArc": (1000, 1000, 0, 1000, 0),
    "IMC_AddSpiralWithVel": (65536, 0, 1000, 1000, 500, 0, 1000, 0),
    "IMC_AddSpiral": (1000, 1000, 500, 0, 1000, 0),
}


def functions(*tables: Iterable[str]) -> list[str]:
    """Return the rows of functions; the manual describes some under another name."""
    return [f"imc.{MANUAL_NAMES.get(name, name)}" for name in sorted(set(chain(*tables)))]


MANUAL_NAMES = {
    "IMC_MoveInTime": "IMC_MoveTP", "IMC_MoveInDist": "IMC_MovePP", "IMC_TgvelInTime": "IMC_MoveTV",
    "IMC_TgvelInDist": "IMC_MovePV", "IMC_PutContourData": "IMC_AddContourData",
}  # fmt: skip


READERS: dict[str, tuple[tuple[Any, ...], tuple[Any, ...]]] = {
    "IMC_GetParam16": ((218, 0), (0,)),
    "IMC_GetParam32": ((225, 0), (0,)),
    "IMC_GetParam48": ((175, 0), (0,)),
    "IMC_GetParamBit": ((562, 2, 0), (0,)),
    "IMC_GetCapData": ((7, 0), ([], 0, 0)),
}
"""Arguments of what reads, and what a refused call returns beside its status."""
OTHERS: dict[str, tuple[Any, ...]] = {
    "IMC_GetMulParam": (many((12, 0, 2)), 1),
    "IMC_ClearFIFO": (1,),
    "IMC_PutContourData": ([5], 1, 4),
}
