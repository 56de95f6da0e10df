"""Modes that M70 and M73 keep, as the words that put them in force again.

Source: LinuxCNC G-code manual, "M70 Save Modal State", "M72 Restore Modal State", "M73 Save and Autorestore". Neither
the motion nor positions are kept.
"""

from __future__ import annotations

import math
from typing import TypeAlias

from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    EXACT_PATH,
    EXACT_STOP,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_NUMBER,
    INCH,
    NO_AXIS,
    PLANE,
    length_scale,
)
from polycnc.nc.rs274._functions import NumberError
from polycnc.nc.rs274._known_names import has_diameters

Words: TypeAlias = tuple[tuple[str, float], ...]
KEEPING = {repr(float(code)): code for code in (70, 71, 72, 73)}
"""The codes by the Python of their number."""
_FEED_MODES = {0: 94.0, 1: 95.0, 2: 93.0}
_LENGTHS = "XYZABC"


def modes_of(state: ChannelState) -> tuple[Words, ...]:
    """Return the words of all modes in force, in the order in which they are put in force."""
    whole = state.modal.whole
    modal, spindle = state.modal, state.spindle
    mist, flood = 7 in spindle.coolant, 8 in spindle.coolant
    found: list[Words] = [
        (("G", 20.0 if whole[INCH] else 21.0),),
        (("G", 7.0 if has_diameters(state) else 8.0),) if state.axis("X") != NO_AXIS else (),
        (("G", 17.0 + float(whole[PLANE])),),
        (("G", 90.0 if whole[ABSOLUTE] else 91.0),),
        (("G", 90.1 if whole[ARC_ABSOLUTE] else 91.1),),
        (("G", _FEED_MODES[int(whole[FEED_MODE])]),),
        (("F", float(modal.real[FEED_NUMBER])),)
        if whole[FEED_MODE] != FEED_INVERSE_TIME and modal.real[FEED_NUMBER] > 0.0
        else (),
        (("G", 98.0 if state.cycle.retract_to_initial else 99.0),),
        (("G", float((state.coordinates.work[0] or "G54")[1:])),),
        _stopping(state),
        (("G", 96.0 if spindle.surface_speed else 97.0), ("S", spindle.speed)),
        (("M", {1: 3.0, -1: 4.0, 0: 5.0}[spindle.direction]),),
        (("M", 9.0),) if not (mist or flood) else (),
        (("M", 7.0),) if mist else (),
        (("M", 8.0),) if flood else (),
        _length(state),
        (("G", {0: 40.0, 1: 41.0, -1: 42.0}[state.side]),),
    ]
    return tuple(found)


def words_back(kept: tuple[Words, ...], state: ChannelState) -> list[Words]:
    """Return the blocks that put kept modes in force again, none for those that have not changed.

    Raises:
        NumberError: radius compensation would have to begin again.
    """
    now = modes_of(state)
    units = kept[0] != now[0]
    back = [
        old
        for old, new in zip(kept, now, strict=True)
        if old and (old != new or (units and old[0][0] == "F"))
    ]
    if any(words[0] in (("G", 41.0), ("G", 42.0)) for words in back):
        raise NumberError("radius compensation cannot be put in force again", "Cancel it before M70 or M73.")
    return back


def _stopping(state: ChannelState) -> Words:
    whole = state.modal.whole
    if whole[EXACT_STOP]:
        return (("G", 61.1),)
    if whole[EXACT_PATH]:
        return (("G", 61.0),)
    unit = length_scale(state.modal)
    rounded, merged = state.path_tolerance_mm / unit, state.merge_mm / unit
    if not math.isfinite(rounded):
        return (("G", 64.0),)
    return ("G", 64.0), ("P", rounded), ("Q", merged)


def _length(state: ChannelState) -> Words:
    if state.coordinates.length_sign == 0:
        return (("G", 49.0),)
    names = list(state.axis_names)
    values = state.coordinates.length.tolist()
    scale = state.modal.scale.tolist()
    shifts = tuple((name, values[at] / scale[at]) for at, name in enumerate(names) if name in _LENGTHS)
    return ("G", 43.1), *shifts
