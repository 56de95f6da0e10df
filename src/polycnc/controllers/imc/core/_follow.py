"""Coupled motion of a slave: electronic gears and synchronous motion.

A gear follows an increment of its source times a ratio, exactly: what is below 2**-16 pulses is kept and added to the
next cycle. It ramps to that velocity with the slave's own rates, or is led to it over a change of a pacing parameter,
and is locked from then on. Synchronous motion is paced the same way: to a position, with a cubic that leaves with the
present velocity and arrives at rest, or to a velocity, straight.
"""

from __future__ import annotations

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._ownership import cancel_waiting, end_sync, is_pending, take_over
from polycnc.controllers.imc.core._planner import ramped, start_velocity, to_units
from polycnc.controllers.imc.core._state import GEAR, GOAL, IDLE, SYNC, VELOCITY, CardState
from polycnc.controllers.imc.core._words import (
    FLAG,
    clip32,
    get32,
    get48,
    get_u16,
    put16,
    put32,
    scaled,
    wrap32,
)
from polycnc.controllers.imc.core._write_effects import row_of
from polycnc.kernel import compiled

_ONE_32 = 1 << 32
_RESTART = 1 << 31  # by how much a position jumps that restarts at the origin


@compiled
def _read(s: CardState, at: int, axis: int) -> int:
    """Return what stands at an address, 0 if nothing does."""
    row = row_of(s, at, axis)
    return get32(s.memory, row, at) if row >= 0 and at + 1 < s.memory.shape[1] else 0


@compiled
def _take_gear(s: CardState, i: int) -> None:
    """Follow what the registers of the gear say now."""
    axis, m = s.axis[i], s.memory
    axis["gear_source"] = get_u16(m, i, addr.GEARSRC)
    axis["gear_master"] = get_u16(m, i, addr.MASTER)
    axis["gear_ratio"] = get48(m, i, addr.GEARRATIO)


@compiled
def _source_velocity(s: CardState, i: int) -> int:
    """Return the increment that the gear of axis `i` follows; the registers count unless they are another gear's."""
    axis = s.axis[i]
    if axis["waits"] == 0:
        _take_gear(s, i)
    return _read(s, axis["gear_source"], axis["gear_master"])


@compiled
def _stop_move(s: CardState, i: int, mode: int) -> None:
    """Let a coupling have the main system, and show that a move has ended."""
    s.system[0, i]["mode"] = mode
    put16(s.memory, i, addr.GO, 0)


@compiled
def begin_gear(s: CardState, i: int) -> None:
    """Engage the gear: from now on the slave follows, with a ramp of its own."""
    axis, m = s.axis[i], s.memory
    axis["waits"] = 0
    axis["prepared"] = 0
    take_over(s, i)
    if is_pending(s, i):
        put16(m, i, addr.STARTSYN, 0)
    axis["armed"] = 0
    axis["locked"] = 0
    axis["rest"] = 0
    put16(m, i, addr.ENGEAR, FLAG)
    _stop_move(s, i, GEAR)


@compiled
def arm_gear(s: CardState, i: int) -> None:
    """Let the gear wait for startsyn beside whatever moves the slave."""
    s.axis[i]["waits"] = 1
    s.axis[i]["armed"] = 0
    put16(s.memory, i, addr.ENGEAR, FLAG)


@compiled
def leave_gear(s: CardState, i: int) -> None:
    """Leave the gear: go on with the speed of this moment, or to gearoutvel; forget one that waits."""
    axis, m = s.axis[i], s.memory
    engaged = s.system[0, i]["mode"] == GEAR
    velocity = get32(m, i, addr.VEL)
    if engaged and m[i, addr.GEAROUTMOD] != 0:
        velocity = get32(m, i, addr.GEAROUTVEL)
    elif engaged and axis["locked"] != 0:
        velocity = clip32(scaled(_source_velocity(s, i), axis["gear_ratio"])[0])
        put32(m, i, addr.VEL, velocity)  # a locked slave has that speed now
    if axis["waits"] != 0:
        cancel_waiting(s, i)
    if engaged:
        end_sync(s, i)
        put32(m, i, addr.TGVEL, velocity)
        start_velocity(s, 0, i, velocity)


@compiled
def begin_sync(s: CardState, i: int) -> None:
    """Start what waits for startsyn: the engagement of a gear, or a synchronous motion."""
    axis, m = s.axis[i], s.memory
    geared = axis["waits"] != 0 or s.system[0, i]["mode"] == GEAR
    geared = geared and m[i, addr.SYNTYPE] == 0 and axis["prepared"] != GOAL
    axis["waits"] = 0
    axis["prepared"] = 0
    take_over(s, i)
    put16(m, i, addr.STARTSYN, FLAG)
    put16(m, i, addr.ENASYN, FLAG)
    put16(m, i, addr.ENGEAR, FLAG if geared else 0)
    span = get32(m, i, addr.SYNSRCVAR)
    axis["sync_share"] = 0.0
    axis["sync_from"] = axis["sync_noted"]
    axis["sync_source"] = get_u16(m, i, addr.SYNSRC)
    axis["sync_axis"] = get_u16(m, i, addr.SYNAXIS)
    axis["sync_span"] = span
    axis["sync_type"] = m[i, addr.SYNTYPE]
    axis["sync_target"] = get32(m, i, addr.TGVEL)
    axis["sync_way"] = 0
    axis["sync_part"] = 0.0
    axis["sync_velocity"] = get32(m, i, addr.VEL) / 65536.0
    _stop_move(s, i, GEAR if geared else SYNC)
    if geared:
        return
    distance = get32(m, i, addr.SLAVEDIST) * 65536
    if m[i, addr.SLAVEABS] != 0:
        distance -= get48(m, i, addr.POS_FRACTION)
    axis["sync_distance"] = distance / 65536.0
    axis["sync_slope"] = axis["sync_velocity"] * span if axis["sync_source"] == addr.TICKS else 0.0


@compiled
def _share(s: CardState, i: int) -> float:
    """Return which part of the pacing change has been covered, from 0 on."""
    axis = s.axis[i]
    if axis["sync_span"] <= 0:
        return 1.0
    source = _read(s, axis["sync_source"], axis["sync_axis"])
    way = wrap32(source - axis["sync_from"])
    if axis["sync_source"] != addr.TICKS and axis["sync_span"] < _RESTART // 2:
        way = (way + _RESTART // 2) % _RESTART - _RESTART // 2  # a position may have restarted at the origin
    return float(abs(way) / axis["sync_span"])


@compiled
def _whole(s: CardState, i: int, way: float) -> int:
    """Return `way` pulses as whole units, and keep the rest for the next cycle."""
    axis = s.axis[i]
    exact = way + axis["sync_part"]
    step = to_units(exact)
    axis["sync_part"] = exact - step / 65536.0
    return step


@compiled
def _mean_share(before: float, now: float) -> float:
    """Return the mean of a share that grows evenly from `before` to `now` and stays at 1 once it is there."""
    if now <= 1.0 or now <= before:
        return 0.5 * (before + min(now, 1.0))
    growing = (1.0 - before) / (now - before)
    return growing * 0.5 * (before + 1.0) + (1.0 - growing)


@compiled
def _led_in(s: CardState, i: int, source: int, ratio: int) -> int:
    """Return the step of a gear whose ratio grows with the share of the pacing parameter."""
    axis = s.axis[i]
    before = axis["sync_share"]
    now = max(_share(s, i), before)
    part = _mean_share(before, now)
    axis["sync_share"] = now
    full = (source / 65536.0) * (ratio / 4294967296.0)
    step = _whole(s, i, part * full + (1.0 - part) * axis["sync_velocity"])
    if now >= 1.0:
        end_sync(s, i)
        axis["locked"] = 1
        axis["ratio"] = ratio
    return step


@compiled
def _gear_step(s: CardState, i: int) -> int:
    axis, m = s.axis[i], s.memory
    source = _source_velocity(s, i)
    ratio = axis["gear_ratio"]
    if axis["sync_share"] >= 0.0:
        return _led_in(s, i, source, ratio)
    step, fraction = scaled(source, ratio)
    if axis["locked"] == 0 or ratio != axis["ratio"]:
        axis["locked"] = 0
        velocity = get32(m, i, addr.VEL)
        accel, decel = get32(m, i, addr.ACCEL), get32(m, i, addr.DECEL)
        reached = ramped(velocity, step, accel, decel)
        if reached != step:
            return reached
        axis["locked"] = 1
        axis["ratio"] = ratio
        axis["rest"] = 0
    rest = axis["rest"] + fraction
    axis["rest"] = rest & (_ONE_32 - 1)
    return step + int(rest >> 32)


@compiled
def _position_step(s: CardState, i: int, now: float) -> int:
    """Return the step of a motion to a position: a cubic from the first velocity to rest."""
    axis = s.axis[i]
    u = min(now, 1.0)
    rise = u * u * (3.0 - 2.0 * u)
    way = to_units(rise * axis["sync_distance"] + u * (1.0 - u) * (1.0 - u) * axis["sync_slope"])
    step = way - axis["sync_way"]
    axis["sync_way"] = way
    return int(step)


@compiled
def _sync_step(s: CardState, i: int) -> int:
    axis, row = s.axis[i], s.system[0, i]
    if axis["sync_share"] < 0.0:
        row["mode"] = IDLE
        return 0
    before = axis["sync_share"]
    now = max(_share(s, i), before)
    axis["sync_share"] = now
    if axis["sync_type"] != 0:
        step = _position_step(s, i, now)
        if now >= 1.0:
            row["mode"] = IDLE
            end_sync(s, i)
        return step
    target = int(axis["sync_target"])
    if now >= 1.0:
        row["mode"] = VELOCITY
        row["target"] = target
        end_sync(s, i)
        return target
    return to_units(axis["sync_velocity"] * (1.0 - now) + target / 65536.0 * now)


@compiled
def follow_step(s: CardState, i: int) -> int:
    """Return by how much a slave moves in this cycle."""
    return _gear_step(s, i) if s.system[0, i]["mode"] == GEAR else _sync_step(s, i)
