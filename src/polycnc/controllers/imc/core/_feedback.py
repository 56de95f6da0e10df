"""What an axis measures and shows after a control cycle: encoders, terminals, captures, windows, flags."""

from __future__ import annotations

import math

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._bits import CAPTURE_ON, FOLLOW_COMMAND, ORIGIN_HIGH
from polycnc.controllers.imc.core._planner import to_units
from polycnc.controllers.imc.core._state import AXIS_RESTED, GEAR, IDLE, MOVE, CardState
from polycnc.controllers.imc.core._words import (
    FLAG,
    clip32,
    get32,
    get48,
    get_u16,
    get_u32,
    put16,
    put32,
    put48,
    wrap32,
    wrap48,
)
from polycnc.controllers.imc.core._write_effects import keep_capture
from polycnc.kernel import LIMIT_HIGH, LIMIT_LOW, REFERENCE, KernelState, compiled


@compiled
def encoders_cycle(s: CardState, i: int, actual: float) -> None:
    """Read both encoders of axis `i`."""
    axis, m = s.axis[i], s.memory
    counts = math.floor(actual * axis["counts_per_pulse"] + 0.5)
    step = counts - axis["counts"]
    axis["counts"] = counts
    if get_u16(m, i, addr.ENCPCTR) & FOLLOW_COMMAND:
        put48(m, i, addr.ENCP_FRACTION, get48(m, i, addr.CURPOS_FRACTION))
        put32(m, i, addr.ENCPVEL, get32(m, i, addr.CURVEL))
    elif step != 0 or get32(m, i, addr.ENCPVEL) != 0:
        step *= get_u32(m, i, addr.ENCPFACTOR)
        put32(m, i, addr.ENCPVEL, clip32(step))
        put48(m, i, addr.ENCP_FRACTION, wrap48(get48(m, i, addr.ENCP_FRACTION) + step))
    if axis["aux_rate"] != 0.0:
        axis["aux_part"] += axis["aux_rate"]
        whole = math.floor(axis["aux_part"])
        axis["aux_part"] -= whole
        axis["aux"] += whole
    if axis["aux"] != 0 or get32(m, i, addr.ENCSVEL) != 0:
        step = axis["aux"] * get_u32(m, i, addr.ENCSFACTOR)
        axis["aux"] = 0
        put32(m, i, addr.ENCSVEL, clip32(step))
        put48(m, i, addr.ENCS_FRACTION, wrap48(get48(m, i, addr.ENCS_FRACTION) + step))


@compiled
def terminals_cycle(s: CardState, state: KernelState, i: int) -> int:
    """Show the levels of the axis' terminals, latch what became active; return the levels."""
    axis, m = s.axis[i], s.memory
    levels = state.switches.switch[i, LIMIT_HIGH]["level"] | state.switches.switch[i, LIMIT_LOW]["level"] << 1
    levels = (levels | state.switches.switch[i, REFERENCE]["level"] << 2) ^ axis["inverted"]
    control = get_u16(m, i, addr.AIOCTR)
    high = (control & 1) | (control >> 1 & 2) | (4 if control & ORIGIN_HIGH else 0)
    levels = (levels & ~axis["unwired"]) | (axis["unwired"] & ~high)
    if levels != axis["levels"]:
        active = ~(levels ^ high) & (levels ^ axis["levels"]) & 7
        put16(m, i, addr.AIOLAT, get_u16(m, i, addr.AIOLAT) | active)
        axis["levels"] = levels
    put16(m, i, addr.AIO, (get_u16(m, i, addr.AIO) & ~7) | levels)
    return int(levels)


@compiled
def probes_cycle(s: CardState, state: KernelState, i: int, actual: float, last: float) -> None:
    """Count index and probe pulses, and capture where the probe pulses lie."""
    axis, m = s.axis[i], s.memory
    pulses = abs(state.switches.marks[i]["index_crossed"])
    if pulses != 0:
        put16(m, i, addr.COUNTER, get_u16(m, i, addr.COUNTER) + pulses)
    origin, pitch = axis["probe_origin"], axis["probe_pitch"]
    asked = axis["probe_now"]
    axis["probe_now"] = 0
    if asked == 0 and (actual == last or not math.isfinite(origin)):
        return
    captures = (get_u16(m, i, addr.ENCPCTR) & CAPTURE_ON) != 0
    if asked != 0:
        put16(m, i, addr.COUNTER, get_u16(m, i, addr.COUNTER) + 1)
        if captures:
            keep_capture(s, i, get48(m, i, addr.ENCP_FRACTION) >> 16)
    if actual == last or not math.isfinite(origin):
        return
    way = 1.0 if actual > last else -1.0
    step = pitch if pitch > 0.0 else math.inf
    first = origin
    if pitch > 0.0:
        turns = (last - origin) / pitch
        first = origin + (math.floor(turns) + 1.0 if way > 0.0 else math.ceil(turns) - 1.0) * pitch
    elif (origin - last) * way <= 0.0:
        return
    at = first
    while (actual - at) * way >= 0.0:
        put16(m, i, addr.COUNTER, get_u16(m, i, addr.COUNTER) + 1)
        if captures:
            behind = to_units(
                (actual - at) * axis["counts_per_pulse"] * (get_u32(m, i, addr.ENCPFACTOR) / 65536.0)
            )
            keep_capture(s, i, (get48(m, i, addr.ENCP_FRACTION) - behind) >> 16)
        at += way * step


@compiled
def _plans(s: CardState, layer: int, i: int) -> bool:
    """Tell whether a coordinate system is at work."""
    if get32(s.memory, i, layer * addr.PCS + addr.VEL) != 0:
        return True
    row = s.system[layer, i]
    mode = row["mode"]
    if mode == IDLE:
        return False
    if mode == GEAR:
        return bool(s.axis[i]["locked"] == 0)
    if mode == MOVE:
        return bool(row["paused"] != 0 or row["cycles"] < row["duration"])
    return True


@compiled
def flags_cycle(s: CardState, i: int) -> None:
    """Show what axis `i` is doing, and whether it has settled."""
    axis, m = s.axis[i], s.memory
    position = get48(m, i, addr.CURPOS_FRACTION) >> 16
    error = wrap32(position - (get48(m, i, addr.ENCP_FRACTION) >> 16))
    error = min(max(error, -32768), 32767)
    put16(m, i, addr.POSERR, error)
    unsettled = abs(error) > get_u16(m, i, addr.SETTLEWIN)
    put16(m, i, addr.OUTSETTLE, FLAG if unsettled else 0)
    put16(m, i, addr.OUTTRACK, FLAG if abs(error) > get_u16(m, i, addr.TRACKWIN) else 0)
    put16(m, i, addr.STATUS, 1 if position >= get32(m, i, addr.BREAKP) else 0)
    first, second = _plans(s, 0, i), _plans(s, 1, i)
    put16(m, i, addr.SYSTEM_MOVING, FLAG if first else 0)
    put16(m, i, addr.PCS + addr.SYSTEM_MOVING, FLAG if second else 0)
    planning = first or second
    smoothing = axis["lag"] != 0 or axis["recent"] != 0
    moving = planning or smoothing or get32(m, i, addr.CURVEL) != 0
    put16(m, i, addr.PROFILING, FLAG if planning else 0)
    put16(m, i, addr.SMOOTHING, FLAG if smoothing else 0)
    put16(m, i, addr.MOVING, FLAG if moving else 0)
    if not moving and axis["was_moving"] != 0:
        s.card[0]["attention"] |= AXIS_RESTED
    axis["was_moving"] = 1 if moving else 0
    if moving or unsettled:
        axis["settled"] = 0
        put16(m, i, addr.MOTION, FLAG)
    elif m[i, addr.MOTION] != 0:
        axis["settled"] += 1
        if axis["settled"] >= get_u16(m, i, addr.SETTLEN):
            put16(m, i, addr.MOTION, 0)
