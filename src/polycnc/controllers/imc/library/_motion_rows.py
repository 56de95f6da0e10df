"""Functions of motion: a row for each; what they write is in the table of expansions (manual 004, 4)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.controllers.imc.library._call import LIBRARY, card_call, send
from polycnc.controllers.imc.library._codes import IMC_STATUS
from polycnc.controllers.imc.library._expansions import expand
from polycnc.controllers.imc.library._network import IMC_HANDLE
from polycnc.controllers.imc.library._types import (
    IMC16,
    IMC32,
    Axis,
    OtherAxis,
    Positive,
    Queue,
    Ratio,
    Source,
)
from polycnc.controllers.library import named

TYPES: dict[str, Any] = {
    "Pos": IMC32, "dist": IMC32, "vel": IMC32, "movedist": IMC32, "tgvel": IMC32,
    "direction": IMC16, "RiseEdge": IMC16, "stop": IMC16,
    "ratio": Ratio, "sourcetype": Source, "synsourcetype": Source,
    "syndist": Positive, "syntime": Positive, "time": Positive, "refdist": Positive,
    "master": OtherAxis, "synaxis": OtherAxis, "encsaxis": OtherAxis, "refaxis": OtherAxis,
    "axis": Axis, "fifoSel": Queue,
}  # fmt: skip
"""What an argument of this name is, in all functions of motion."""

# fmt: off
ROWS = {
    "IMC_MoveAbsolute": ("Pos", "4.1.1", "Move to a position of the main system"),
    "IMC_MoveRelative": ("dist", "4.1.2",
        "Move by a distance from where the axis is when the instruction is carried out"),
    "IMC_MoveSuperimposed": ("dist", "4.1.3", "Move by a distance on top of whatever the axis does"),
    "IMC_Phasing": ("dist", "4.1.4", "Shift a master, `axis`, against slaves that follow its mcsvel"),
    "IMC_MoveVelocity": ("vel", "4.2.1", "Go to a velocity (S16.16, pulses per ms) and keep it; 0 stops"),
    "IMC_HomeSwitch1": ("direction RiseEdge stop", "4.3.1", "Search the origin switch in one pass"),
    "IMC_HomeSwitch2": ("direction RiseEdge stop", "4.3.1", "Search the origin switch and come back to it slowly"),
    "IMC_HomeSwitch3": ("direction RiseEdge stop", "4.3.1",
        "Search the origin switch, come back over it, and reach it slowly once more"),
    "IMC_HomeSwitchIndex1": ("direction RiseEdge stop", "4.3.2", "Search the origin switch, then count index pulses"),
    "IMC_HomeSwitchIndex2": ("direction RiseEdge stop", "4.3.2",
        "Search the origin switch, come back slowly, and count index pulses from it"),
    "IMC_HomeSwitchIndex3": ("direction RiseEdge stop", "4.3.2",
        "Search the origin switch, come back, turn again, and count index pulses from it"),
    "IMC_HomeIndex": ("direction stop", "4.3.3", "Count index pulses from the start"),
    "IMC_GearFree": ("ratio master sourcetype", "4.4.1",
        "Follow a master at a ratio from now on, with a ramp of the slave's own"),
    "IMC_GearInDist": ("ratio master sourcetype synaxis synsourcetype syndist", "4.4.2",
        "Follow a master from startsyn on, fully when the sync source has gone `syndist`"),
    "IMC_GearInTime": ("ratio master sourcetype syntime", "4.4.3",
        "Follow a master from startsyn on, fully after `syntime` control cycles"),
    "IMC_HandWheel": ("ratio encsaxis", "4.5.1",
        "Follow a wheel at the auxiliary encoder of `encsaxis`; 0 in engear ends it"),
    "IMC_MoveInTime": ("time movedist", "4.6.1", "Move by a distance in `time` control cycles from startsyn on"),
    "IMC_MoveInDist": ("refdist refaxis movedist", "4.6.2",
        "Move by a distance while `refaxis` goes `refdist`, from enasyn and startsyn on"),
    "IMC_TgvelInTime": ("time tgvel", "4.6.3",
        "Reach a velocity in `time` control cycles from startsyn on, and keep it"),
    "IMC_TgvelInDist": ("refdist refaxis tgvel", "4.6.4",
        "Reach a velocity while `refaxis` goes `refdist`, from enasyn and startsyn on"),
}
"""By name: arguments before `axis` and `fifoSel`, section of manual 004, and what the function does."""

ALIASES = {
    "IMC_MoveTP": "IMC_MoveInTime", "IMC_MovePP": "IMC_MoveInDist", "IMC_MoveTV": "IMC_TgvelInTime",
    "IMC_MovePV": "IMC_TgvelInDist",
}
"""Other names: as the manual misprints them, and for what its print has lost."""
# fmt: on


def _made(name: str, before: str, section: str, sentence: str) -> Callable[..., IMC_STATUS]:
    arguments = [*before.split(), "axis", "fifoSel"]

    def call(handle: IMC_HANDLE, *values: Any) -> IMC_STATUS:
        given = dict(zip(arguments, values, strict=True))
        return send(handle, given["fifoSel"], expand(name, given))

    types = {"Handle": IMC_HANDLE, **{each: TYPES[each] for each in arguments}}
    return card_call(named(call, name, f"{sentence} (Manual 004, {section}).", types, IMC_STATUS))


FUNCTIONS = {name: _made(name, *row) for name, row in ROWS.items()}
FUNCTIONS.update({other: LIBRARY.alias(other, FUNCTIONS[name]) for other, name in ALIASES.items()})
"""The functions that programs call, by all their names."""
