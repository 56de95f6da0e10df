"""One coordinate system of an axis: a move to a target, or a ramp to a velocity that is kept.

A move is planned in closed form from any velocity, in the units of the card (pulses and control cycles), and sampled
in whole 2**-16 pulses; the last sample is the target exactly. A ramp is integer arithmetic on the velocity word. Both
read their velocity from memory, so a client that writes it there stops or speeds up the axis at once.
"""

from __future__ import annotations

import math

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._bits import INSERR
from polycnc.controllers.imc.core._state import GIVEN, IDLE, MOVE, RELEASED, VELOCITY, CardState
from polycnc.controllers.imc.core._words import (
    FLAG,
    ONE,
    clip32,
    get32,
    get48,
    get_u16,
    put16,
    put32,
    put48,
    wrap48,
)
from polycnc.kernel import SHORT_OVERSHOOT, compiled, plan_profile, profile_at, profile_duration

REST_SLACK = 1e-9  # of a cycle by which rounding may make a rest late
_TOP = 1 << 47  # where a position of 48 bits ends


@compiled
def to_units(pulses: float) -> int:
    """Return the nearest whole number of 2**-16 pulses."""
    return math.floor(pulses * 65536.0 + 0.5)


@compiled
def moved(s: CardState, position: int, step: int) -> int:
    """Return a position after a step; one that leaves 32 bits starts again at the origin, or wraps."""
    position += step
    if -_TOP <= position < _TOP:
        return position
    if s.card[0]["wrap_to_origin"] == 0:
        return wrap48(position)
    return position - _TOP if position >= _TOP else position + _TOP


@compiled
def advance_system(s: CardState, layer: int, i: int, step: int) -> None:
    """Move a coordinate system by `step`, which is its velocity in this cycle."""
    m, o = s.memory, layer * addr.PCS
    put32(m, i, o + addr.VEL, clip32(step))
    s.system[layer, i]["velocity"] = clip32(step)
    if step != 0:
        put48(m, i, o + addr.POS_FRACTION, moved(s, get48(m, i, o + addr.POS_FRACTION), step))


@compiled
def _plan_move(s: CardState, layer: int, i: int) -> None:
    """Plan the way that is left of a move, from the velocity in memory; one that has no speed any more brakes."""
    m, o, row = s.memory, layer * addr.PCS, s.system[layer, i]
    k = layer * s.axis.shape[0] + i
    row["left"] -= row["done"]
    row["done"] = 0
    row["cycles"] = 0
    row["paused"] = 0
    row["stale"] = 0
    speed = get32(m, i, row["speed_at"])
    count = plan_profile(
        s.phases[k],
        0.0,
        get32(m, i, o + addr.VEL) / 65536.0,
        row["left"] / 65536.0,
        0.0,
        (abs(speed) if s.axis[i]["home"] != 0 else speed) / 65536.0,
        get32(m, i, o + addr.ACCEL) / 65536.0,
        get32(m, i, o + addr.DECEL) / 65536.0,
        0.0,
        SHORT_OVERSHOOT,
    )
    row["phases"] = count
    if count < 0:
        refuse_move(s, layer, i)
        start_velocity(s, layer, i, 0)
        return
    row["duration"] = profile_duration(s.phases[k], count)


@compiled
def start_velocity(s: CardState, layer: int, i: int, target: int) -> None:
    """Let a coordinate system ramp to `target` and keep it; 0 brakes to rest."""
    row = s.system[layer, i]
    row["target"] = target
    row["mode"] = VELOCITY
    put16(s.memory, i, layer * addr.PCS + addr.GO, 0)


@compiled
def rest_system(s: CardState, layer: int, i: int) -> None:
    """Let a coordinate system be at rest, at once."""
    row = s.system[layer, i]
    row["mode"] = IDLE
    row["velocity"] = 0
    put16(s.memory, i, layer * addr.PCS + addr.GO, 0)
    put32(s.memory, i, layer * addr.PCS + addr.VEL, 0)


@compiled
def ramped(velocity: int, target: int, accel: int, decel: int) -> int:
    """Return the velocity of the next cycle on the way to `target`; without a deceleration it stops at once."""
    if velocity == target:
        return velocity
    slower = velocity != 0 and ((velocity > 0) != (target > 0) or abs(target) < abs(velocity))
    goal, rate = target, accel
    if slower:
        rate = decel
        if (velocity > 0) != (target > 0):
            goal = 0
        if rate <= 0:
            return goal
    if rate <= 0:
        return velocity
    if goal > velocity:
        return min(velocity + rate, goal)
    return max(velocity - rate, goal)


@compiled
def _is_paused(s: CardState, i: int) -> bool:
    return bool(s.memory[s.axis.shape[0], addr.HPAUSE] != 0 or s.memory[i, addr.HALTSTEP] != 0)


@compiled
def _paused_velocity(s: CardState, i: int, velocity: int, decel: int) -> int:
    """Return the velocity on the way to a pause."""
    at_once = s.memory[i, addr.HALTSTEP] != 0 and s.memory[i, addr.HALTMODE] == 0
    return 0 if at_once else ramped(velocity, 0, 0, decel)


@compiled
def _velocity_cycle(s: CardState, layer: int, i: int) -> int:
    m, o, row = s.memory, layer * addr.PCS, s.system[layer, i]
    velocity = get32(m, i, o + addr.VEL)
    accel, decel = get32(m, i, o + addr.ACCEL), get32(m, i, o + addr.DECEL)
    if velocity == 0 and (row["target"] == 0 or accel <= 0):
        row["mode"] = IDLE
        return 0
    if _is_paused(s, i):
        return _paused_velocity(s, i, velocity, decel)
    return ramped(velocity, row["target"], accel, decel)


@compiled
def _track_cycle(s: CardState, layer: int, i: int) -> None:
    """Let a tracking move follow its target."""
    m, o, row = s.memory, layer * addr.PCS, s.system[layer, i]
    target = get32(m, i, o + addr.TGPOS)
    if target != row["followed"]:
        row["left"] += (target - row["followed"]) * ONE
        row["followed"] = target
        row["stale"] = 1


@compiled
def _move_cycle(s: CardState, layer: int, i: int) -> int:
    m, o, row = s.memory, layer * addr.PCS, s.system[layer, i]
    velocity = get32(m, i, o + addr.VEL)
    if _is_paused(s, i):
        row["paused"] = 1
        step = _paused_velocity(s, i, velocity, get32(m, i, o + addr.DECEL))
        row["done"] += step
        return step
    tracks = m[i, o + addr.TRACK] != 0
    if tracks:
        _track_cycle(s, layer, i)
    if row["stale"] != 0 or row["paused"] != 0 or velocity != row["velocity"]:
        _plan_move(s, layer, i)
        if row["mode"] != MOVE:
            return _velocity_cycle(s, layer, i)
    row["cycles"] += 1
    at = row["left"]
    if row["cycles"] < row["duration"] - REST_SLACK:
        k = layer * s.axis.shape[0] + i
        position, _, _ = profile_at(s.phases[k], row["phases"], float(row["cycles"]))
        at = to_units(position)
    elif not tracks:
        row["mode"] = IDLE
        put16(m, i, o + addr.GO, 0)
    step = at - row["done"]
    row["done"] = at
    return int(step)


@compiled
def refuse_move(s: CardState, layer: int, i: int) -> None:
    """Show that a move is a bad instruction: it has no speed, acceleration or deceleration."""
    put16(s.memory, i, layer * addr.PCS + addr.GO, 0)
    put16(s.memory, i, addr.ERROR, get_u16(s.memory, i, addr.ERROR) | INSERR)


@compiled
def can_move(s: CardState, layer: int, i: int) -> bool:
    """Tell whether the registers of a coordinate system let it move to a target."""
    m, o = s.memory, layer * addr.PCS
    speed, accel = get32(m, i, o + addr.MAXVEL), get32(m, i, o + addr.ACCEL)
    return bool(speed > 0 and accel > 0 and get32(m, i, o + addr.DECEL) > 0)


@compiled
def begin_move(s: CardState, layer: int, i: int, speed_at: int) -> bool:
    """Begin the move that the registers describe, as fast as that parameter says; False if beyond 32 bits."""
    m, o, row = s.memory, layer * addr.PCS, s.system[layer, i]
    position = get48(m, i, o + addr.POS_FRACTION)
    distance = get32(m, i, o + addr.DIST)
    if distance != 0:
        target = position + distance * ONE
        put32(m, i, o + addr.DIST, 0)
        if not -_TOP <= target < _TOP:
            put16(m, i, o + addr.GO, 0)
            return False
        put32(m, i, o + addr.TGPOS, target >> 16)
        row["left"] = distance * ONE
    else:
        row["left"] = get32(m, i, o + addr.TGPOS) * ONE - position
    row["done"] = 0
    row["followed"] = get32(m, i, o + addr.TGPOS)
    row["speed_at"] = speed_at
    row["mode"] = MOVE
    row["stale"] = 1
    return True


@compiled
def system_step(s: CardState, layer: int, i: int) -> int:
    """Return by how much a coordinate system that plans by itself moves in this cycle."""
    mode = s.system[layer, i]["mode"]
    if mode == MOVE:
        return _move_cycle(s, layer, i)
    if mode == VELOCITY:
        return _velocity_cycle(s, layer, i)
    if mode == GIVEN:
        if s.axis[i]["by"] == RELEASED:
            s.system[0, i]["mode"] = IDLE
        return int(s.axis[i]["given"])
    return 0


@compiled
def show_slope(s: CardState, layer: int, i: int, before: int, step: int) -> None:
    """Show whether the velocity changes."""
    put16(s.memory, i, layer * addr.PCS + addr.SLOPE, FLAG if step != before else 0)
