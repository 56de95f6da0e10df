"""Go along a path with limited jerk, cycle by cycle.

In every cycle the path takes the acceleration it would like best, if from there it can still keep everything ahead
(`_is_safe`): by easing off to a speed that is planned, or by braking to a node (see `_jerk_plan`). If not, it takes the
greatest that is safe. From there braking just reaches its node, so it is traversed as it was found (the plan), until
something better is safe. What is planned may change in any cycle; the path never does what is not safe by the plan.

Units: those of `_segments`; jerk per s3; `dt`, the cycle, in s.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._braking import (
    AT_TARGET,
    DIRECT,
    HALVINGS,
    LOOSE,
    NO_PLAN,
    PLAN_ACCEL,
    PLAN_COAST,
    PLAN_COUNT,
    PLAN_END_SPEED,
    PLAN_KIND,
    PLAN_RATE,
    PLAN_S,
    PLAN_SPEED,
    PLAN_TIME,
    PLAN_TO,
    ROUNDING,
    SLACK,
    TIGHT,
    enter_next,
    go_by_plan,
    plan_holds,
    plan_rest,
)
from polycnc.kernel._jerk import brake_way, moved, wanted_rate
from polycnc.kernel._jerk_plan import has_limited_jerk, last_known, node_short, plan_with_jerk
from polycnc.kernel._jit import compiled
from polycnc.kernel._path import (
    GONE,
    HELD,
    INSIDE,
    RATE,
    READY,
    REGISTERS,
    RESTED,
    SPEED_NOW,
    SPEED_PEAK,
    Paths,
    is_held,
    slot,
)
from polycnc.kernel._segments import (
    ASKED,
    EASE,
    LIMIT,
    NODE_ACCEL,
    NODE_COUNT,
    NODE_FLOOR,
    NODE_SPEED,
    NODE_WAY,
    REDUCED,
    WAIT,
    ZONE_IN,
    ZONE_OUT,
    Floats,
    Segments,
)
from polycnc.kernel._totals import account_time, leave_segment

# What a cycle would come to: how many segments on, place, speed, acceleration; and the node it could brake to.
NEXT_COUNT, NEXT_S, NEXT_SPEED, NEXT_RATE = REGISTERS + 12, REGISTERS + 13, REGISTERS + 14, REGISTERS + 15
NODE_TO, NODE_END_SPEED, NODE_BRAKE, NODE_AT = REGISTERS + 16, REGISTERS + 17, REGISTERS + 18, REGISTERS + 19
NODE_COAST = REGISTERS + 20  # before the braking, DIRECT: without that

AT_REST = 1e-9  # mm/s


@compiled
def follows(seg: Segments, paths: Paths, g: int) -> bool:
    """Tell whether the segment at `head` is traversed with limited jerk."""
    path = paths.row[g]
    if not has_limited_jerk(path) or path["head"] >= path["prepared"]:
        return False
    return bool(seg.row[slot(paths, g, path["head"])]["kind"] != WAIT)


@compiled
def start_following(seg: Segments, paths: Paths, g: int, dt: float) -> None:
    """Stand at the start of the segment at `head`."""
    if paths.row[g]["depth"] > 0:
        plan_with_jerk(seg, paths, g, dt)
    ramps = paths.ramps[g]
    ramps[GONE], ramps[SPEED_NOW], ramps[RATE], ramps[PLAN_KIND] = 0.0, 0.0, 0.0, NO_PLAN
    paths.row[g]["cycles"] = 0
    paths.row[g]["lead"] = 0.0


@compiled
def _allowed(row: np.void, geo: Floats, s: float) -> float:
    """Return the acceleration at `s` within a segment."""
    inside = geo[ZONE_IN] <= s <= row["length"] - geo[ZONE_OUT]
    return float(row["accel"] if inside else geo[REDUCED])


@compiled
def _aim(ramps: Floats, way: float, speed: float, accel: float, count: int, coast: float) -> bool:
    """Note a node that is safe to brake to: `way` from here, after going `coast` without acceleration."""
    ramps[NODE_TO], ramps[NODE_END_SPEED], ramps[NODE_BRAKE], ramps[NODE_AT] = way, speed, accel, count
    ramps[NODE_COAST] = coast
    return True


@compiled
def _sheds(speed: float, rate: float, carried: float, jerk: float, way: float) -> bool:
    """Tell whether an acceleration is taken back to `carried` within a way."""
    if abs(rate) <= carried:
        return True
    gone, _, _ = moved(speed, rate, -math.copysign(jerk, rate), (abs(rate) - carried) / jerk)
    return bool(gone <= way)


@compiled
def _is_safe(
    seg: Segments, paths: Paths, g: int, count: int, s: float, speed: float, rate: float, dt: float
) -> bool:
    """Tell whether the path can go on from `s` in segment `count` with a speed and an acceleration; aim at a node."""
    path, ramps = paths.row[g], paths.ramps[g]
    jerk = path["jerk_mm_s3"]
    k = slot(paths, g, count)
    row, geo = seg.row[k], seg.geo[k]
    ramps[NODE_AT] = -1.0
    left = row["length"] - s
    most = speed + 0.5 * rate * rate / jerk if rate > 0.0 else speed
    if rate > 0.0 and count > path["head"] and most > row["cap"] * SLACK:
        return False
    # What acceleration is left beside the corner and at the end is not too much there.
    carries = _sheds(speed, rate, geo[REDUCED], jerk, left - geo[ZONE_OUT] - most * dt)
    carries = carries and _sheds(speed, rate, geo[EASE], jerk, left - most * dt)
    if carries and _can_ease(seg, paths, g, count, left, speed, rate, most, dt):
        return True
    eased = speed + 0.5 * rate * abs(rate) / jerk
    if rate >= 0.0 or eased < -AT_REST:
        return False
    # Braking on.
    way = left - node_short(geo, row["out"], dt)
    accel = _allowed(row, geo, s)
    if brake_way(speed, rate, row["out"], accel, jerk) <= way + ROUNDING:
        return _aim(ramps, way, min(row["out"], max(eased, 0.0)), accel, count, DIRECT)
    if carries and geo[NODE_COUNT] > count and speed <= geo[NODE_FLOOR] * SLACK:
        way = left + geo[NODE_WAY]
        accel = min(geo[REDUCED], geo[NODE_ACCEL])
        if brake_way(speed, rate, geo[NODE_SPEED], accel, jerk) <= way + ROUNDING:
            speed = min(geo[NODE_SPEED], max(eased, 0.0))
            return _aim(ramps, way, speed, accel, int(geo[NODE_COUNT]), DIRECT)
    return False


@compiled
def _can_ease(
    seg: Segments,
    paths: Paths,
    g: int,
    count: int,
    to_end: float,
    speed: float,
    rate: float,
    most: float,
    dt: float,
) -> bool:
    """Tell whether it is safe to take the acceleration back, `to_end` before the end of segment `count`.

    `most` is the highest speed meanwhile.
    """
    path, ramps = paths.row[g], paths.ramps[g]
    jerk = path["jerk_mm_s3"]
    last = last_known(path)
    time = abs(rate) / jerk
    eased = speed + 0.5 * rate * time
    if eased < 0.0:
        if eased < -AT_REST:
            return False
        eased = 0.0
    way = time * (speed + rate * time / 3.0)
    k = slot(paths, g, count)
    while to_end < way:
        if most > seg.geo[k, LIMIT] * SLACK or count + 1 >= last:
            return False
        count += 1
        k = slot(paths, g, count)
        if most > seg.row[k]["cap"] * SLACK:
            return False
        to_end += seg.row[k]["length"]
    row, geo = seg.row[k], seg.geo[k]
    out = row["out"]
    rest = to_end - way
    if eased == 0.0:
        return True
    if eased <= out + ROUNDING:
        if geo[NODE_COUNT] == count:  # the end is a stop, and speed is a rounding
            return True
        speed, accel = min(eased, geo[NODE_SPEED]), geo[NODE_ACCEL]
        coast = rest + geo[NODE_WAY] - brake_way(eased, 0.0, speed, accel, jerk)
        return _aim(ramps, to_end + geo[NODE_WAY], speed, accel, int(geo[NODE_COUNT]), max(coast, 0.0))
    short = node_short(geo, out, dt)
    accel = _allowed(row, geo, row["length"] - rest)
    coast = rest - short - brake_way(eased, 0.0, out, accel, jerk)
    if coast >= -ROUNDING:
        return _aim(ramps, to_end - short, out, accel, count, max(coast, 0.0))
    if geo[NODE_COUNT] > count and eased <= geo[NODE_FLOOR] * SLACK:
        accel = min(geo[REDUCED], geo[NODE_ACCEL])
        speed = min(eased, geo[NODE_SPEED])
        coast = rest + geo[NODE_WAY] - brake_way(eased, 0.0, speed, accel, jerk)
        if coast >= -ROUNDING:
            node = int(geo[NODE_COUNT])
            return _aim(ramps, to_end + geo[NODE_WAY], speed, accel, node, max(coast, 0.0))
    return False


@compiled
def _speed_after(speed: float, rate: float, jerk: float, build: float, dt: float, way: float) -> float:
    """Return the speed with which the path has gone `way` in a cycle."""
    early, late = 0.0, dt
    now = speed
    for _ in range(HALVINGS):
        time = 0.5 * (early + late)
        gone, now, then = moved(speed, rate, jerk, min(time, build))
        if time > build:
            more, now, then = moved(now, then, 0.0, time - build)
            gone += more
        if gone < way:
            early = time
        else:
            late = time
    return now


@compiled
def _try(seg: Segments, paths: Paths, g: int, rate: float, dt: float) -> bool:
    """Tell whether it is safe to have the acceleration `rate` after this cycle; note what that comes to."""
    path, ramps = paths.row[g], paths.ramps[g]
    speed, now = ramps[SPEED_NOW], ramps[RATE]
    jerk = math.copysign(path["jerk_mm_s3"], rate - now)
    build = min(dt, (rate - now) / jerk)
    gone, after, _ = moved(speed, now, jerk, build)
    most = max(speed, after)
    if now > 0.0 > rate:
        most = max(most, speed + 0.5 * now * now / abs(jerk))
    more, after, _ = moved(after, rate, 0.0, dt - build)
    most = max(most, after)
    if after < 0.0:
        if after < -AT_REST:
            return False
        after = 0.0
    count = int(path["head"])
    last = last_known(path)
    start = ramps[GONE]
    s = start + gone + more
    k = slot(paths, g, count)
    passed = -start
    largest = max(abs(now), abs(rate))
    while s > seg.row[k]["length"]:
        limit = seg.geo[k, LIMIT]
        length = seg.row[k]["length"]
        passed += length
        if count + 1 >= last or largest > seg.geo[k, REDUCED] * SLACK:
            return False
        if most > limit * SLACK:
            if limit <= 0.0:
                return False
            there = _speed_after(speed, now, jerk, build, dt, passed)
            if there > limit * SLACK:
                return False
        s -= length
        count += 1
        k = slot(paths, g, count)
        if largest > seg.geo[k, REDUCED] * SLACK:
            return False
    allowed = _allowed(seg.row[k], seg.geo[k], s) * SLACK
    if abs(rate) > allowed and abs(rate) >= abs(now):
        return False
    if not _is_safe(seg, paths, g, count, s, after, rate, dt):
        return False
    ramps[NEXT_COUNT], ramps[NEXT_S], ramps[NEXT_SPEED], ramps[NEXT_RATE] = count, s, after, rate
    return True


@compiled
def _take(seg: Segments, paths: Paths, g: int, kind: float) -> None:
    """Do what was tried last, and keep the braking it found as the plan."""
    path, ramps = paths.row[g], paths.ramps[g]
    while path["head"] < ramps[NEXT_COUNT]:
        enter_next(seg, paths, g)
    ramps[GONE], ramps[SPEED_NOW], ramps[RATE] = ramps[NEXT_S], ramps[NEXT_SPEED], ramps[NEXT_RATE]
    ramps[PLAN_KIND] = NO_PLAN
    if ramps[NODE_AT] >= 0.0:
        ramps[PLAN_KIND] = kind if ramps[NODE_COAST] <= ROUNDING else LOOSE
        ramps[PLAN_S], ramps[PLAN_TIME] = ramps[GONE], 0.0
        ramps[PLAN_SPEED], ramps[PLAN_RATE] = ramps[SPEED_NOW], ramps[RATE]
        ramps[PLAN_TO] = ramps[GONE] + ramps[NODE_TO]
        ramps[PLAN_END_SPEED], ramps[PLAN_ACCEL] = ramps[NODE_END_SPEED], ramps[NODE_BRAKE]
        ramps[PLAN_COUNT], ramps[PLAN_COAST] = ramps[NODE_AT], ramps[NODE_COAST]


@compiled
def _choose(seg: Segments, paths: Paths, g: int, to_speed: float, dt: float) -> bool:
    """Go on for a cycle towards a speed, as far as it is safe; return True at rest at the end of a segment."""
    path, ramps = paths.row[g], paths.ramps[g]
    k = slot(paths, g, path["head"])
    jerk = path["jerk_mm_s3"]
    now = ramps[RATE]
    step = jerk * dt
    allowed = _allowed(seg.row[k], seg.geo[k], ramps[GONE])
    lowest = min(max(now - step, -allowed), now + step)
    highest = max(min(now + step, allowed), now - step)
    wanted = min(max(wanted_rate(ramps[SPEED_NOW], now, to_speed, jerk, dt), lowest), highest)
    if _try(seg, paths, g, wanted, dt):
        _take(seg, paths, g, LOOSE)
        return False
    if ramps[PLAN_KIND] == TIGHT and plan_holds(seg, paths, g):
        return go_by_plan(seg, paths, g, dt)
    safe = lowest
    if not _try(seg, paths, g, safe, dt):
        safe = now - min(max(now, -step), step)
        if not _try(seg, paths, g, safe, dt):
            if ramps[PLAN_KIND] == NO_PLAN or not plan_holds(seg, paths, g):
                plan_rest(seg, paths, g, ramps[GONE], ramps[SPEED_NOW], now, 0.0)
            if ramps[PLAN_KIND] != NO_PLAN:
                return go_by_plan(seg, paths, g, dt)
            return _brake_anyway(seg, paths, g, lowest, dt)
    unsafe = wanted
    for _ in range(HALVINGS):
        middle = 0.5 * (safe + unsafe)
        if middle in (safe, unsafe):
            break
        if _try(seg, paths, g, middle, dt):
            safe = middle
        else:
            unsafe = middle
    _try(seg, paths, g, safe, dt)
    _take(seg, paths, g, TIGHT)
    return False


@compiled
def _brake_anyway(seg: Segments, paths: Paths, g: int, rate: float, dt: float) -> bool:
    """Brake where nothing is safe: what is ahead has changed too late. Return True at rest at the end of a segment.

    Random paths with overrides, holds and late blocks did not come here, with any look-ahead.
    """
    path, ramps = paths.row[g], paths.ramps[g]
    speed, now = ramps[SPEED_NOW], ramps[RATE]
    jerk = math.copysign(path["jerk_mm_s3"], rate - now)
    rest = speed + 0.5 * now * abs(now) / path["jerk_mm_s3"]
    if rest <= 0.0:
        rate = min(0.0, now + path["jerk_mm_s3"] * dt)
        jerk = path["jerk_mm_s3"]
    build = min(dt, (rate - now) / jerk)
    gone, speed, _ = moved(speed, now, jerk, build)
    more, speed, _ = moved(speed, rate, 0.0, dt - build)
    ramps[GONE] += max(gone + more, 0.0)
    ramps[SPEED_NOW], ramps[RATE] = max(speed, 0.0), rate
    ramps[PLAN_KIND] = NO_PLAN
    last = last_known(path)
    while ramps[GONE] >= seg.row[slot(paths, g, path["head"])]["length"]:
        if path["head"] + 1 >= last or seg.geo[slot(paths, g, path["head"]), LIMIT] <= 0.0:
            return True
        enter_next(seg, paths, g)
    return False


@compiled
def _stands(ramps: Floats, dt: float) -> bool:
    return bool(ramps[SPEED_NOW] <= AT_REST and abs(ramps[RATE]) * dt <= AT_REST)


@compiled
def _stands_at_stop(seg: Segments, paths: Paths, g: int, dt: float) -> bool:
    """Tell whether the path has come to rest at the end of a segment without a plan."""
    path, ramps = paths.row[g], paths.ramps[g]
    k = slot(paths, g, path["head"])
    left = seg.row[k]["length"] - ramps[GONE]
    return bool(left <= AT_TARGET and seg.geo[k, LIMIT] <= 0.0 and _stands(ramps, dt))


@compiled
def follow_cycle_along(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Take path `g`, which is in motion, one cycle on in time; return INSIDE or RESTED."""
    path, ramps = paths.row[g], paths.ramps[g]
    head = int(path["head"])
    k = slot(paths, g, head)
    held = is_held(path, seg.row[k])
    rests = _choose(seg, paths, g, 0.0 if held else seg.geo[k, ASKED], dt) or _stands_at_stop(
        seg, paths, g, dt
    )
    ramps[SPEED_PEAK] = ramps[SPEED_NOW]
    row = seg.row[slot(paths, g, path["head"])]
    path["tag"] = row["tag"]
    path["flags"] = row["flags"]
    if rests:
        path["state"] = READY
        leave_segment(seg, paths, g, dt)
        return RESTED
    account_time(seg, paths, g, dt)
    if path["depth"] > 0 and path["head"] > head:
        plan_with_jerk(seg, paths, g, dt)
    if held and _stands(ramps, dt):
        ramps[SPEED_NOW], ramps[RATE], ramps[PLAN_KIND] = 0.0, 0.0, NO_PLAN
        path["state"] = HELD
        return RESTED
    return INSIDE
