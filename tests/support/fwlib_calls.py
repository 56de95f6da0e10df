"""Arguments for every function of fwlib32, of which many are meant and some are not."""

from __future__ import annotations

import random
from typing import Any

from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.library.clib import Call, Slot, Way
from support.c_hold import Passed

HANDLE = 1
LENGTHS = (4, 5, 6, 8, 10, 12, 16, 20, 28, 38, 46, 118, 262)


def number_of(call: Call, slot: Slot, dice: random.Random) -> Any:
    """Return a value for an argument by value, None for any."""
    name = slot.argument.name
    if name == "FlibHndl":
        return HANDLE if dice.random() < 0.95 else dice.choice((0, 2, 0xFFFF))
    if slot.argument.length_of and dice.random() < 0.8:
        return dice.choice(LENGTHS)
    if dice.random() < 0.6:
        return dice.randrange(-1, 5)
    return None


def size_of(call: Call, slot: Slot, numbers: dict[str, Any]) -> int:
    """Return what a program has there: what its length says, else one structure, or one per count."""
    name = call.function.name
    if name == "cnc_upload" and slot.way is Way.RECORD:
        return 4 + (numbers["number"] or 0)
    counter = next(
        (each.name for each in call.function.arguments if each.length_of == slot.argument.name), ""
    )
    if counter:
        size = int(numbers[counter] or 0)
        return min(size, slot.width) if slot.way is Way.RECORD and not slot.writes else size
    if slot.argument.many:
        count = 6 if slot.argument.many == "MAX_AXIS" else numbers[slot.argument.many] or 0
        most = 6 if slot.argument.many == "axis" else 0x7FFF
        return max(0, min(most, count)) * slot.width
    return slot.width


def before(call: Call, passed: list[Passed]) -> Any:
    """Return what the library answers without asking anybody: of a handle that is none."""
    if call.slots and call.slots[0].argument.name == "FlibHndl" and passed[0].slot.way is Way.VALUE:
        return None if passed[0].python == HANDLE else fwlib.EW_HANDLE
    return None


AT_HOME = ("cnc_allclibhndl", "cnc_allclibhndl2", "cnc_allclibhndl3", "cnc_freelibhndl")
