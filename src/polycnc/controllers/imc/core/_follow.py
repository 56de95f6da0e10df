"""Coupled motion of a slave: electronic gears and synchronous motion.

A gear follows an increment of its source times a ratio, exactly: what is below 2**-16 pulses is kept and added to the
next cycle. It ramps to that velocity with the slave's own rates, or is led to it over a change of a pacing parameter,
and is locked from then on. Synchronous motion is paced the same way: to a position, with a cubic that leaves with the
present velocity and arrives at rest, or to a velocity, straight.
"""

from __future__ import annotations

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._planner import ramped, start_velocity, to_units
from polycnc.controllers.imc.core._state import GEAR, IDLE, SYNC, VELOCITY, CardState
from polycnc.controllers.imc.core._words import (
    clip32,
    get32,
    get48,
    get_u16,
    put16,
    put32,
    scaled,
    wrap32,
)
from polycnc.controllers.imc.core._write_effects import row_of, sync_source
from polycnc.kernel import compiled

_ONE_32 = 1 << 32


@compiled
def source_velocity(s: CardState, i: int) -> int:
    """Return the increment that the gear of axis `i` follows."""
    at = get_u16(s.memory, i, addr.GEARSRC)
    row = row_of(s, at, get_u16(s.memory, i, addr.MASTER))
    return get32(s.memory, row, at) if row >= 0 and at + 1 < s.memory.shape[1] else 0


@compiled
def begin_gear(s: CardState, i: int) -> None:
    """Engage the gear: from now on the slave follows, at once or when its synchronous motion starts."""
    axis, row = s.axis[i], s.system[0, i]
    axis["engaged"] = 1
    axis["armed"] = 0
    axis["home"] = 0
    axis["locked"] = 0
    axis["rest"] = 0
    axis["sync_share"] = -1.0
    if s.memory[i, addr.ENASYN] == 0:
        row["mode"] = GEAR


@compiled
def leave_gear(s: CardState, i: int) -> None:
    """Leave the gear: go on with the speed of this moment, or to gearoutvel."""
    axis = s.axis[i]
    if axis["engaged"] == 0:
        return
    axis["engaged"] = 0
    end_sync(s, i)
    if s.system[0, i]["mode"] != GEAR:  # it waits for its synchronous motion to start
        return
    velocity = get32(s.memory, i, addr.VEL)
    if s.memory[i, addr.GEAROUTMOD] != 0:
        velocity = get32(s.memory, i, addr.GEAROUTVEL)
    elif axis["locked"] != 0:
        velocity = clip32(scaled(source_velocity(s, i), get48(s.memory, i, addr.GEARRATIO))[0])
        put32(s.memory, i, addr.VEL, velocity)  # a locked slave has that speed now
    put32(s.memory, i, addr.TGVEL, velocity)
    start_velocity(s, 0, i, velocity)


@compiled
def begin_sync(s: CardState, i: int) -> None:
    """Start the synchronous motion whose source has been noted when startsyn was written."""
    axis, m = s.axis[i], s.memory
    span = get32(m, i, addr.SYNSRCVAR)
    axis["sync_share"] = 0.0
    axis["sync_way"] = 0
    axis["sync_part"] = 0.0
    axis["sync_velocity"] = get32(m, i, addr.VEL) / 65536.0
    if axis["engaged"] != 0:
        s.system[0, i]["mode"] = GEAR
        return
    s.system[0, i]["mode"] = SYNC
    distance = get32(m, i, addr.SLAVEDIST) * 65536
    if m[i, addr.SLAVEABS] != 0:
        distance -= get48(m, i, addr.POS_FRACTION)
    axis["sync_distance"] = distance / 65536.0
    axis["sync_slope"] = axis["sync_velocity"] * span if get_u16(m, i, addr.SYNSRC) == addr.TICKS else 0.0


@compiled
def end_sync(s: CardState, i: int) -> None:
    """Leave synchronous motion, complete or not."""
    s.axis[i]["sync_share"] = -1.0
    put16(s.memory, i, addr.STARTSYN, 0)
    put16(s.memory, i, addr.ENASYN, 0)


@compiled
def _share(s: CardState, i: int) -> float:
    """Return which part of the pacing change has been covered, from 0 on."""
    span = get32(s.memory, i, addr.SYNSRCVAR)
    if span <= 0:
        return 1.0
    return abs(wrap32(sync_source(s, i) - s.axis[i]["sync_from"])) / span


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
    source, ratio = source_velocity(s, i), get48(m, i, addr.GEARRATIO)
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
    axis, m, row = s.axis[i], s.memory, s.system[0, i]
    if axis["sync_share"] < 0.0:
        row["mode"] = IDLE
        return 0
    before = axis["sync_share"]
    now = max(_share(s, i), before)
    axis["sync_share"] = now
    if m[i, addr.SYNTYPE] != 0:
        step = _position_step(s, i, now)
        if now >= 1.0:
            row["mode"] = IDLE
            end_sync(s, i)
        return step
    target = get32(m, i, addr.TGVEL)
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
