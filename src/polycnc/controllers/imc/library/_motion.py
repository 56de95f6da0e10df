"""Functions of motion: what they write is in the table of expansions (manual 004, 4)."""

# ruff: noqa: N802, N803  the names are the manual's

from __future__ import annotations

from collections.abc import Mapping
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


def _send(function: str, given: Mapping[str, Any]) -> IMC_STATUS:
    """Send what the function of this name stands for; `given` are all its arguments."""
    return send(given["Handle"], given["fifoSel"], expand(function, given))


@card_call
def IMC_MoveAbsolute(Handle: IMC_HANDLE, Pos: IMC32, axis: Axis, fifoSel: Queue) -> IMC_STATUS:
    """Move to a position of the main system (Manual 004, 4.1.1)."""
    return _send("IMC_MoveAbsolute", locals())


@card_call
def IMC_MoveRelative(Handle: IMC_HANDLE, dist: IMC32, axis: Axis, fifoSel: Queue) -> IMC_STATUS:
    """Move by a distance from where the axis is when the instruction is carried out (Manual 004, 4.1.2)."""
    return _send("IMC_MoveRelative", locals())


@card_call
def IMC_MoveSuperimposed(Handle: IMC_HANDLE, dist: IMC32, axis: Axis, fifoSel: Queue) -> IMC_STATUS:
    """Move by a distance on top of whatever the axis does (Manual 004, 4.1.3)."""
    return _send("IMC_MoveSuperimposed", locals())


@card_call
def IMC_Phasing(Handle: IMC_HANDLE, dist: IMC32, axis: Axis, fifoSel: Queue) -> IMC_STATUS:
    """Shift a master, `axis`, against slaves that follow its mcsvel (Manual 004, 4.1.4)."""
    return _send("IMC_Phasing", locals())


@card_call
def IMC_MoveVelocity(Handle: IMC_HANDLE, vel: IMC32, axis: Axis, fifoSel: Queue) -> IMC_STATUS:
    """Go to a velocity (S16.16, pulses per ms) and keep it; 0 stops (Manual 004, 4.2.1)."""
    return _send("IMC_MoveVelocity", locals())


@card_call
def IMC_HomeSwitch1(
    Handle: IMC_HANDLE, direction: IMC16, RiseEdge: IMC16, stop: IMC16, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Search the origin switch in one pass (Manual 004, 4.3.1)."""
    return _send("IMC_HomeSwitch1", locals())


@card_call
def IMC_HomeSwitch2(
    Handle: IMC_HANDLE, direction: IMC16, RiseEdge: IMC16, stop: IMC16, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Search the origin switch and come back to it slowly (Manual 004, 4.3.1)."""
    return _send("IMC_HomeSwitch2", locals())


@card_call
def IMC_HomeSwitch3(
    Handle: IMC_HANDLE, direction: IMC16, RiseEdge: IMC16, stop: IMC16, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Search the origin switch, come back over it, and reach it slowly once more (Manual 004, 4.3.1)."""
    return _send("IMC_HomeSwitch3", locals())


@card_call
def IMC_HomeSwitchIndex1(
    Handle: IMC_HANDLE, direction: IMC16, RiseEdge: IMC16, stop: IMC16, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Search the origin switch, then count index pulses (Manual 004, 4.3.2)."""
    return _send("IMC_HomeSwitchIndex1", locals())


@card_call
def IMC_HomeSwitchIndex2(
    Handle: IMC_HANDLE, direction: IMC16, RiseEdge: IMC16, stop: IMC16, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Search the origin switch, come back slowly, and count index pulses from it (Manual 004, 4.3.2)."""
    return _send("IMC_HomeSwitchIndex2", locals())


@card_call
def IMC_HomeSwitchIndex3(
    Handle: IMC_HANDLE, direction: IMC16, RiseEdge: IMC16, stop: IMC16, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Search the origin switch, come back, turn again, and count index pulses from it (Manual 004, 4.3.2)."""
    return _send("IMC_HomeSwitchIndex3", locals())


@card_call
def IMC_HomeIndex(
    Handle: IMC_HANDLE, direction: IMC16, stop: IMC16, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Count index pulses from the start (Manual 004, 4.3.3)."""
    return _send("IMC_HomeIndex", locals())


@card_call
def IMC_GearFree(
    Handle: IMC_HANDLE, ratio: Ratio, master: OtherAxis, sourcetype: Source, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Follow a master at a ratio from now on, with a ramp of the slave's own (Manual 004, 4.4.1)."""
    return _send("IMC_GearFree", locals())


@card_call
def IMC_GearInDist(
    Handle: IMC_HANDLE,
    ratio: Ratio,
    master: OtherAxis,
    sourcetype: Source,
    synaxis: OtherAxis,
    synsourcetype: Source,
    syndist: Positive,
    axis: Axis,
    fifoSel: Queue,
) -> IMC_STATUS:
    """Follow a master from startsyn on, fully when the sync source has gone `syndist` (Manual 004, 4.4.2)."""
    return _send("IMC_GearInDist", locals())


@card_call
def IMC_GearInTime(
    Handle: IMC_HANDLE,
    ratio: Ratio,
    master: OtherAxis,
    sourcetype: Source,
    syntime: Positive,
    axis: Axis,
    fifoSel: Queue,
) -> IMC_STATUS:
    """Follow a master from startsyn on, fully after `syntime` control cycles (Manual 004, 4.4.3)."""
    return _send("IMC_GearInTime", locals())


@card_call
def IMC_HandWheel(
    Handle: IMC_HANDLE, ratio: Ratio, encsaxis: OtherAxis, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Follow a wheel at the auxiliary encoder of `encsaxis`; 0 in engear ends it (Manual 004, 4.5.1)."""
    return _send("IMC_HandWheel", locals())


@card_call
def IMC_MoveInTime(
    Handle: IMC_HANDLE, time: Positive, movedist: IMC32, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Move by a distance in `time` control cycles from startsyn on (Manual 004, 4.6.1)."""
    return _send("IMC_MoveInTime", locals())


@card_call
def IMC_MoveInDist(
    Handle: IMC_HANDLE, refdist: Positive, refaxis: OtherAxis, movedist: IMC32, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Move by a distance while `refaxis` goes `refdist`, from enasyn and startsyn on (Manual 004, 4.6.2)."""
    return _send("IMC_MoveInDist", locals())


@card_call
def IMC_TgvelInTime(
    Handle: IMC_HANDLE, time: Positive, tgvel: IMC32, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Reach a velocity in `time` control cycles from startsyn on, and keep it (Manual 004, 4.6.3)."""
    return _send("IMC_TgvelInTime", locals())


@card_call
def IMC_TgvelInDist(
    Handle: IMC_HANDLE, refdist: Positive, refaxis: OtherAxis, tgvel: IMC32, axis: Axis, fifoSel: Queue
) -> IMC_STATUS:
    """Reach a velocity while `refaxis` goes `refdist`, from enasyn and startsyn on (Manual 004, 4.6.4)."""
    return _send("IMC_TgvelInDist", locals())


# Other names: as the manual misprints them, and for what its print has lost.
IMC_MoveTP = LIBRARY.alias("IMC_MoveTP", IMC_MoveInTime)
IMC_MovePP = LIBRARY.alias("IMC_MovePP", IMC_MoveInDist)
IMC_MoveTV = LIBRARY.alias("IMC_MoveTV", IMC_TgvelInTime)
IMC_MovePV = LIBRARY.alias("IMC_MovePV", IMC_TgvelInDist)

# fmt: off
__all__ = [
    "IMC_GearFree", "IMC_GearInDist", "IMC_GearInTime", "IMC_HandWheel", "IMC_HomeIndex",
    "IMC_HomeSwitch1", "IMC_HomeSwitch2", "IMC_HomeSwitch3", "IMC_HomeSwitchIndex1",
    "IMC_HomeSwitchIndex2", "IMC_HomeSwitchIndex3", "IMC_MoveAbsolute", "IMC_MoveInDist",
    "IMC_MoveInTime", "IMC_MovePP", "IMC_MovePV", "IMC_MoveRelative", "IMC_MoveSuperimposed",
    "IMC_MoveTP", "IMC_MoveTV", "IMC_MoveVelocity", "IMC_Phasing", "IMC_TgvelInDist", "IMC_TgvelInTime",
]
# fmt: on
