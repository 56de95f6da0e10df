"""The braking that a path with limited jerk is sure of: how it goes on if nothing better is safe.

A plan is braking to a node (see `_jerk_plan`), from where it is planned on, or to rest.

Units: those of `_segments`; jerk per s3; `dt`, the cycle, in s.
"""

from __future__ import annotations

import math

from polycnc.kernel._jerk import brake_phases, brake_way, moved
from polycnc.kernel._jerk_plan import last_known, node_short
from polycnc.kernel._jit import compiled
from polycnc.kernel._path import GONE, RATE, REGISTERS, REST_SLACK, SPEED_NOW, Paths, slot
from polycnc.kernel._segments import (
    LIMIT,
    NODE_ACCEL,
    NODE_COUNT,
    NODE_SPEED,
    NODE_WAY,
    REDUCED,
    SHARE_IN,
    ZONE_IN,
    Floats,
    Segments,
)
from polycnc.kernel._totals import leave_segment

# Registers of the plan: what braking begins with and how long ago, its target as a place from the start of `head`, its
# kind.
PLAN_S, PLAN_SPEED, PLAN_RATE, PLAN_TIME = REGISTERS + 3, REGISTERS + 4, REGISTERS + 5, REGISTERS + 6
PLAN_TO, PLAN_END_SPEED, PLAN_ACCEL, PLAN_COUNT = REGISTERS + 7, REGISTERS + 8, REGISTERS + 9, REGISTERS + 10
PLAN_KIND, PLAN_COAST = REGISTERS + 11, REGISTERS + 21  # the way before the braking, DIRECT: without that
NO_PLAN, LOOSE, TIGHT = 0.0, 1.0, 2.0
DIRECT = -1.0

ROUNDING = 1e-12  # mm, by which a way may be too short
SLACK = 1.0 + 1e-9
AT_TARGET = 1e-8  # mm
HALVINGS = 60


@compiled
def enter_next(seg: Segments, paths: Paths, g: int) -> None:
    """Leave the segment at `head`, all places being counted from the start of the next."""
    path, ramps = paths.row[g], paths.ramps[g]
    length = seg.row[slot(paths, g, path["head"])]["length"]
    leave_segment(seg, paths, g, 0.0)
    geo = seg.geo[slot(paths, g, path["head"])]
    path["entry_share"], path["entry_zone"] = geo[SHARE_IN], geo[ZONE_IN]
    ramps[GONE] -= length
    ramps[PLAN_S] -= length
    ramps[PLAN_TO] -= length


@compiled
def _plan_at(ramps: Floats, jerk: float, time: float) -> tuple[float, float, float, float]:
    """Return way, speed and acceleration of the plan at a time, and how much of the time is beyond its end, negative
    before its last phase."""
    speed, rate = ramps[PLAN_SPEED], ramps[PLAN_RATE]
    gone = 0.0
    if ramps[PLAN_COAST] >= 0.0:
        ease_time = abs(rate) / jerk
        gone, speed, rate = moved(speed, rate, -math.copysign(jerk, rate), min(time, ease_time))
        time -= ease_time
        if time <= 0.0:
            return gone, speed, rate, -math.inf
        rate = 0.0
        coasts = ramps[PLAN_COAST] / speed if speed > 0.0 else math.inf
        gone += speed * min(time, coasts)
        time -= coasts
        if time <= 0.0:
            return gone, speed, rate, -math.inf
    first, build, hold, release = brake_phases(speed, rate, ramps[PLAN_END_SPEED], ramps[PLAN_ACCEL], jerk)
    more, speed, rate = moved(speed, rate, first, min(time, build))
    gone += more
    time -= build
    if time > 0.0:
        more, speed, rate = moved(speed, rate, 0.0, min(time, hold))
        gone += more
        time -= hold
        if time > 0.0:
            more, speed, rate = moved(speed, rate, jerk, min(time, release))
            gone += more
            time -= release
            return gone, speed, rate, time
        return gone, speed, rate, -release
    return gone, speed, rate, time - hold - release


@compiled
def _plan_speed_at(ramps: Floats, jerk: float, way: float) -> float:
    """Return the speed with which the plan, that brakes to rest, has gone `way`."""
    _, build, hold, release = brake_phases(ramps[PLAN_SPEED], ramps[PLAN_RATE], 0.0, ramps[PLAN_ACCEL], jerk)
    early, late = 0.0, build + hold + release
    for _ in range(HALVINGS):
        time = 0.5 * (early + late)
        if _plan_at(ramps, jerk, time)[0] < way:
            early = time
        else:
            late = time
    return _plan_at(ramps, jerk, late)[1]


@compiled
def plan_rest(
    seg: Segments, paths: Paths, g: int, s: float, speed: float, rate: float, since_s: float
) -> bool:
    """Plan to come to rest, if possible at the end of a segment, from `s` on, which was passed `since_s` ago.

    What is ahead may change so that a speed that was planned is too high, though rest is as possible as it was: to
    brake to a low speed takes a longer way than to rest, and another override lowers what lies after that rest.
    """
    path, ramps = paths.row[g], paths.ramps[g]
    jerk = path["jerk_mm_s3"]
    most = speed + 0.5 * rate * rate / jerk if rate > 0.0 else speed
    ease_way, eased, _ = moved(speed, rate, -math.copysign(jerk, rate), abs(rate) / jerk)
    way, least = -s, math.inf
    last = last_known(path)
    fits = True  # whatever the plan does
    ramps[PLAN_S], ramps[PLAN_SPEED], ramps[PLAN_RATE], ramps[PLAN_TIME] = s, speed, rate, since_s
    ramps[PLAN_END_SPEED], ramps[PLAN_COAST], ramps[PLAN_KIND] = 0.0, DIRECT, NO_PLAN
    for count in range(int(path["head"]), last):
        k = slot(paths, g, count)
        way += seg.row[k]["length"]
        if way < 0.0:
            continue
        least = min(least, seg.geo[k, REDUCED])
        ramps[PLAN_ACCEL], ramps[PLAN_TO], ramps[PLAN_COUNT] = least, s + way, count
        if brake_way(speed, rate, 0.0, least, jerk) <= way + ROUNDING:
            if fits and eased > 0.0:
                ramps[PLAN_COAST] = max(way - ease_way - brake_way(eased, 0.0, 0.0, least, jerk), DIRECT)
            ramps[PLAN_KIND] = TIGHT
            return True
        if count + 1 >= last:
            return False
        limit = min(seg.geo[k, LIMIT], seg.row[slot(paths, g, count + 1)]["cap"]) * SLACK
        if most > limit:
            fits = False
            if _plan_speed_at(ramps, jerk, way) > limit:
                return False
    return False


@compiled
def plan_holds(seg: Segments, paths: Paths, g: int) -> bool:
    """Tell whether the speed that the plan ends with is still one from which the path can go on."""
    ramps = paths.ramps[g]
    out = seg.row[slot(paths, g, int(ramps[PLAN_COUNT]))]["out"]
    return bool(ramps[PLAN_END_SPEED] <= out + ROUNDING)


@compiled
def _plan_on(seg: Segments, paths: Paths, g: int, beyond_s: float, dt: float) -> bool:
    """Plan on from the node at the end of the plan, which was reached `beyond_s` ago; return False if that fails."""
    ramps = paths.ramps[g]
    count = int(ramps[PLAN_COUNT])
    geo = seg.geo[slot(paths, g, count)]
    speed = ramps[PLAN_END_SPEED]
    to_end = node_short(geo, seg.row[slot(paths, g, count)]["out"], dt)
    end_speed, accel = min(speed, geo[NODE_SPEED]), geo[NODE_ACCEL]
    coast = to_end + geo[NODE_WAY] - brake_way(speed, 0.0, end_speed, accel, paths.row[g]["jerk_mm_s3"])
    if geo[NODE_COUNT] == count:
        return False
    if not plan_holds(seg, paths, g):
        return plan_rest(seg, paths, g, ramps[PLAN_TO], speed, 0.0, beyond_s)
    ramps[PLAN_S] = ramps[PLAN_TO]
    ramps[PLAN_TO] += to_end + geo[NODE_WAY]
    ramps[PLAN_SPEED], ramps[PLAN_RATE], ramps[PLAN_TIME] = speed, 0.0, beyond_s
    ramps[PLAN_END_SPEED], ramps[PLAN_ACCEL] = end_speed, accel
    ramps[PLAN_COUNT], ramps[PLAN_COAST] = geo[NODE_COUNT], max(coast, 0.0)
    return True


@compiled
def go_by_plan(seg: Segments, paths: Paths, g: int, dt: float) -> bool:
    """Go along the plan for a cycle; return True when it has brought the path to rest at its end."""
    path, ramps = paths.row[g], paths.ramps[g]
    jerk = path["jerk_mm_s3"]
    ramps[PLAN_TIME] += dt
    while True:
        gone, speed, rate, beyond = _plan_at(ramps, jerk, ramps[PLAN_TIME])
        if beyond < -REST_SLACK * dt:
            ramps[GONE] = ramps[PLAN_S] + gone
            ramps[PLAN_KIND] = TIGHT if rate < 0.0 else LOOSE
            break
        short = ramps[PLAN_TO] - ramps[PLAN_S] - gone
        at_target = abs(short) <= AT_TARGET
        speed, rate = min(speed, ramps[PLAN_END_SPEED]), 0.0
        if ramps[PLAN_COAST] < 0.0 and short > AT_TARGET and speed > 0.0:  # it may be done before its node
            ramps[PLAN_S] += gone
            ramps[PLAN_SPEED], ramps[PLAN_RATE], ramps[PLAN_END_SPEED] = speed, 0.0, speed
            ramps[PLAN_TIME], ramps[PLAN_COAST] = max(beyond, 0.0), short
            continue
        if at_target and ramps[PLAN_END_SPEED] == 0.0:
            ramps[SPEED_NOW], ramps[RATE], ramps[PLAN_KIND] = 0.0, 0.0, NO_PLAN
            while path["head"] < ramps[PLAN_COUNT]:
                enter_next(seg, paths, g)
            return True
        if not at_target or not _plan_on(seg, paths, g, max(beyond, 0.0), dt):
            ramps[GONE] = ramps[PLAN_S] + gone + max(beyond, 0.0) * speed
            ramps[PLAN_KIND] = NO_PLAN
            break
    ramps[SPEED_NOW], ramps[RATE] = max(speed, 0.0), rate
    last = last_known(path)
    while path["head"] + 1 < last and ramps[GONE] > seg.row[slot(paths, g, path["head"])]["length"]:
        if ramps[PLAN_END_SPEED] == 0.0 and path["head"] >= ramps[PLAN_COUNT]:
            break
        enter_next(seg, paths, g)
    return False
