"""One axis in motion: plan its profile, plan it again under way, take a sample.

Every axis of an interpolation runs its own copy of the path's profile. They stay together because they begin in the
same scan with the same numbers, and because the override is taken over for all of them at once (Manual 002, 2.2.6).
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.controllers.apci.core._registers import ModeReg
from polycnc.controllers.apci.core._state import IDLE, JOG, MOVE, SEARCH_ENDS, TABLE, BoardState, Floats
from polycnc.kernel import (
    VELOCITY,
    KernelState,
    add_ramp,
    close_profile,
    compiled,
    entry,
    plan_profile,
    profile_at,
    profile_duration,
    ramp_distance,
    segment_coordinate,
    segment_slope,
    stop_profile,
)

REST_SLACK = 1e-9  # part of a scan by which rounding may make a rest late

# What a sample brought.
INSIDE = 0
RESTED = 1  # the profile ended at rest, exactly at its target
PASSED = 2  # the profile ended with a velocity, before this sample

_S_PROFILE = int(ModeReg.SProfile)
_OVR_MODE = int(ModeReg.OvrMode)


@compiled
def jerk_of(b: BoardState, i: int) -> float:
    """Return the part of axis `i`'s ramps that is bent."""
    return float(b.axis[i]["jerkrel"]) if b.board[0]["mode_register"] & _S_PROFILE else 0.0


@compiled
def override_of(row: np.void) -> float:
    """Return the override that acts on the motion of an axis: that of the trajectory, or its own."""
    return float(row["tovr"] if row["motion"] == MOVE else row["jovr"])


@compiled
def _plan_endless(
    phases: Floats, start: float, first: float, last: float, rate: float, jerkrel: float
) -> int:
    """Fill `phases` with the ramp from velocity `first` to `last`, which then goes on for ever."""
    count = 0
    target = start
    if rate > 0.0:
        count = add_ramp(phases, 0, first, last, rate, rate, jerkrel)
        target = start + ramp_distance(first, last, rate, rate)
    close_profile(phases, count, count, start, target, last)
    return count


@compiled
def _rate_needed(row: np.void, place: float, speed: float, last: float) -> float:
    """Return the deceleration that takes a running profile to its target with velocity `last`, or less."""
    to_go = row["target"] - place
    if to_go * speed <= 0.0 or last * speed < 0.0 or abs(last) >= abs(speed):
        return 0.0
    return float((speed * speed - last * last) / abs(2.0 * to_go))


@compiled
def plan_motion(b: BoardState, i: int, place: float, speed: float, lead: float, runs: bool) -> None:
    """Plan the commanded motion of axis `i` from `place` and `speed`, `lead` seconds ago, with its present override.

    The override acts on velocities and on accelerations (Manual 002, 2.2.6). A profile that `runs` already keeps the
    braking that it needs: a lower override does not make its distance too short.
    """
    row = b.axis[i]
    k = override_of(row)
    phases = b.phases[i]
    # While the override goes to its goal a ramp of its own begins with every scan: bent, it would never get under way.
    jerkrel = 0.0 if runs and row["tovr"] != row["override_goal"] else jerk_of(b, i)
    if row["endless"] != 0:
        count = _plan_endless(phases, place, speed, k * row["tvl"], k * row["ac"], jerkrel)
    else:
        dec = k * row["dec"]
        if runs:
            dec = max(dec, _rate_needed(row, place, speed, k * row["tvl"]))
        count = plan_profile(
            phases,
            place,
            speed,
            row["target"],
            k * row["tvl"],
            k * row["vl"],
            k * row["ac"],
            dec,
            jerkrel,
            row["policy"],
        )
        if count < 0:  # nothing can move it: it stands for ever
            close_profile(phases, 0, 0, place, place, 0.0)
            _begin(b, i, 0, place, 0.0, lead)
            row["duration"] = math.inf
            return
    _begin(b, i, count, place, speed, lead)


@compiled
def _begin(b: BoardState, i: int, count: int, place: float, speed: float, lead: float) -> None:
    row = b.axis[i]
    row["phases"] = count
    row["duration"] = profile_duration(b.phases[i], count)
    row["lead"] = lead
    row["cycles"] = 0
    row["place"] = place
    row["speed"] = speed


@compiled
def brake(b: BoardState, i: int, position: float, velocity: float, rate: float, who: int) -> None:
    """Let axis `i` brake to rest from here, on its own; a rate of 0 stops it at once. `who` wants it so."""
    row = b.axis[i]
    count = stop_profile(b.phases[i], position, velocity, rate, jerk_of(b, i))
    row["motion"] = JOG
    row["stopping"] = who
    row["past"] = 0
    row["endless"] = 0
    _begin(b, i, count, position, velocity, 0.0)


@compiled
def axis_velocity(b: BoardState, i: int) -> float:
    """Return the velocity of axis `i`'s setpoint (axis units/s), as its motion has it and not as a difference."""
    row = b.axis[i]
    if row["motion"] == MOVE:
        slope = segment_slope(b.seg, row["entry"], i, row["place"])
        return float(slope * row["speed"] / b.weight[row["entry"], i])
    return float(row["speed"]) if row["motion"] == JOG or row["motion"] == TABLE else 0.0


@entry
def profile_velocity(b: BoardState, i: int) -> float:
    """Return the velocity of axis `i`'s profile (axis units/s)."""
    return axis_velocity(b, i)


@compiled
def has_ended(row: np.void) -> bool:
    """Tell whether no profile is to be run: the axis rests, or goes on past the end of one."""
    if row["commanded"] != 0 or row["running"] != 0:
        return False
    return bool(row["motion"] == IDLE or row["past"] != 0)


@compiled
def keep_going(b: BoardState, i: int, position: float, velocity: float, lead: float) -> None:
    """Let axis `i` go on with its velocity after the end of a profile, by itself."""
    row = b.axis[i]
    row["motion"] = JOG
    row["stopping"] = 0
    row["past"] = 1
    row["endless"] = 1
    row["tvl"] = velocity
    row["ac"] = 0.0
    close_profile(b.phases[i], 0, 0, position, position, velocity)
    _begin(b, i, 0, position, velocity, lead)


@compiled
def position_at(b: BoardState, i: int, place: float) -> float:
    """Return the machine position of axis `i` at `place` of its motion."""
    row = b.axis[i]
    if row["motion"] == MOVE:
        return segment_coordinate(b.seg, row["entry"], i, place) / float(b.weight[row["entry"], i])
    return place


@compiled
def sample(b: BoardState, state: KernelState, i: int) -> int:
    """Take axis `i`'s profile to its present time and write its setpoint; tell how it ended, if it did."""
    row = b.axis[i]
    dt = b.board[0]["dt"]
    t = row["lead"] + row["cycles"] * dt
    phases = b.phases[i]
    count = row["phases"]
    at_rest = phases[count, VELOCITY] == 0.0
    over = t >= row["duration"] - REST_SLACK * dt if at_rest else t > row["duration"]
    if not over or (row["endless"] != 0 and not at_rest):
        row["place"], row["speed"], _ = profile_at(phases, count, t)
        state.base[i] = position_at(b, i, row["place"])
        return INSIDE
    row["place"], row["speed"], _ = profile_at(phases, count, row["duration"])
    if at_rest:
        state.base[i] = position_at(b, i, row["place"])
        return RESTED
    return PASSED


@compiled
def override_cycle(b: BoardState, i: int) -> None:
    """Move axis `i`'s trajectory override to its goal, and plan the motion again while it changes."""
    row = b.axis[i]
    goal = row["override_goal"]
    if row["tovr"] == goal:
        return
    board = b.board[0]
    step = board["dt"] / board["trovrst"] if board["trovrst"] > board["dt"] else math.inf
    change = goal - row["tovr"]
    row["tovr"] = goal if abs(change) <= step else row["tovr"] + math.copysign(step, change)
    if board["mode_register"] & _OVR_MODE == 0:
        row["jovr"] = row["tovr"]
    override_changed(b, i)


@compiled
def override_changed(b: BoardState, i: int) -> None:
    """Plan the motion of axis `i` again from its last sample, because its override is another."""
    row = b.axis[i]
    moving = row["motion"] == JOG or row["motion"] == MOVE
    # Past its end it keeps the velocity that it was left with.
    if moving and row["past"] == 0 and row["stopping"] == 0 and row["search"] != SEARCH_ENDS:
        plan_motion(b, i, row["place"], row["speed"], 0.0, True)


@compiled
def rest(b: BoardState, i: int) -> None:
    """Let axis `i` be at rest."""
    row = b.axis[i]
    row["motion"] = IDLE
    row["search"] = 0
    row["stopping"] = 0
    row["past"] = 0
    row["endless"] = 0
    row["speed"] = 0.0
