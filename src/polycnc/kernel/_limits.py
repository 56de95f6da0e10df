"""How fast a segment and a junction may be taken so that no axis breaks its limits, cycle by cycle.

What an axis does in two neighbouring cycles weighs the motion with a triangle two cycles wide. A corner's change of
velocity must fit under it together with the ramps beside it and with the other corners nearby. It does if every
change is at most a part (over CORNER_MARGIN) of what the axis' acceleration gives in a cycle, or in the time to the
next corner where that is shorter, and if the ramps leave that part alone within a cycle of the corner. An axis that the
ramps do not use up has that much for the corner anyway. On a curve the centripetal and the tangential part share what
is left after the corners' fixed part: as a circle where they are a quarter turn apart (arcs), as a sum elsewhere
(splines). See docs/explanation/motion.md.

Units: those of `_segments` along the path; an axis' limits in its own unit (mm or deg) per s and s2.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._corner_rules import AS_AXES_ALLOW, BY_SHARE, corner_speed, step_share, turns
from polycnc.kernel._curve_limits import (
    CENTRIPETAL_SHARE,
    OVERLAP_SHARE,
    adds_up,
    curve_bounds,
    gets_faster,
    keep_turning,
    limit_arc_by_share,
    limit_overlap,
    speed_at_end,
)
from polycnc.kernel._geometry import is_curved, segment_tangent
from polycnc.kernel._jit import compiled
from polycnc.kernel._path import HELD, RUNNING
from polycnc.kernel._ramps import MOST_SHARE, beside_corner
from polycnc.kernel._segments import (
    ARC,
    CORNER_STOP,
    LAST,
    LINE,
    OVERLAP,
    OVERLAPS,
    RAPID,
    ROUNDING,
    STOP,
    WAIT,
    WITH_SPINDLE,
    Floats,
    Segments,
)

CURVE_CORNER_SHARE = 0.05  # the same beside a curve, which needs the rest for itself
CURVE_SHARE = 1.0 - CURVE_CORNER_SHARE
SPLINE_CENTRIPETAL_SHARE = 0.45
CORNER_MARGIN = 1.125  # the most that corners closer than a cycle can add up to unevenly
LARGEST_BEND = 0.005  # rad; more is a corner, where an exact path comes to rest
SHARPEST = math.radians(178.0)  # a sharper corner is a stop, which a path with BY_SHARE keeps nothing for
STRAIGHT = 1e-13  # a smaller change of direction is rounding
LEAST_PART = 0.249  # of `full_accel` is left whatever the corners and the override turn out to be
LEAST_OF_ARC = 0.5  # of that is left to an arc with BY_SHARE that is turned through faster
LEAST_OF_OVERLAP = 1e-6  # nothing is counted on where one motion ends and another begins
LEAST_ON_CURVE = 0.5  # of its ramps is left to a curve beside a corner with BY_SHARE
STEP_OF_ROUNDING = 1e-5  # smaller shares of a cycle come from arcs that touch a line by rounding only
MOST_BETWEEN = 16  # joints that are looked at between two corners with BY_SHARE
WORTH = 0.5  # of a corner's speed is what the ramp beside it may lose; more and stopping would be as good


@compiled
def feed_in_force(row: np.void, path: np.void) -> float:
    """Return the path speed that is asked for: the programmed feed, or that of a dry run, times the override.

    An override of 0 holds the path, so its segments stay planned as they are programmed.
    """
    feed = row["feed_mm_s"]
    if row["flags"] & RAPID:
        return float(feed)
    if path["dry_feed_mm_s"] > 0.0:
        feed = path["dry_feed_mm_s"]
    if row["flags"] & WITH_SPINDLE:
        return float(feed)
    return float(feed * path["override"] if path["override"] > 0.0 else feed)


@compiled
def overridden_rapid(cap: float, path: np.void) -> float:
    """Return what the override of positioning leaves of a path speed that the axes allow."""
    factor = path["rapid_override"] if path["rapid_override"] > 0.0 else 1.0
    return float(min(cap * factor, path["rapid_top"]))


@compiled
def line_speed(seg: Segments, k: int, limits: AxisLimits) -> float:
    """Return the path speed that the axes allow on line `k`."""
    speed = math.inf
    for i in range(limits.speed.shape[0]):
        part = abs(seg.end[k, i] - seg.start[k, i]) / seg.row[k]["length"]
        if part > 0.0:
            speed = min(speed, limits.speed[i] / part)
    return speed


@compiled
def limit_segment(seg: Segments, k: int, limits: AxisLimits, path: np.void, work: Floats) -> None:
    """Set `cap` and `full_accel` of segment `k`: feed times override, within what every axis allows.

    `work` is scratch, [3, n].
    """
    cap, accel = segment_limits(seg, k, limits, path, work[0], work[1])
    seg.row[k]["cap"] = cap
    seg.row[k]["full_accel"] = accel


@compiled
def segment_limits(
    seg: Segments, k: int, limits: AxisLimits, path: np.void, tangent: Floats, bend: Floats
) -> tuple[float, float]:
    """Return the speed of segment `k` and the acceleration along it that every axis allows; two rows are scratch."""
    row = seg.row[k]
    kind = row["kind"]
    cap = feed_in_force(row, path)
    accel = math.inf
    if kind == WAIT:
        return 0.0, 1.0
    if kind == LINE:
        for i in range(limits.speed.shape[0]):
            part = abs(seg.end[k, i] - seg.start[k, i]) / row["length"]
            if part > 0.0:
                cap = min(cap, limits.speed[i] / part)
                accel = min(accel, limits.acceleration[i] / part)
        accel = min(accel, path["accel_limit_mm_s2"])
        if path["rounding_share"] > 0.0 and row["flags"] & ROUNDING:
            accel *= path["rounding_share"]
        if row["flags"] & OVERLAPS:
            accel *= OVERLAP_SHARE
        cap = min(cap, path["speed_limit_mm_s"])
    else:
        cap, accel = _limit_curve(seg, k, limits, path, cap, tangent, bend)
    if row["flags"] & RAPID:
        cap = overridden_rapid(cap, path)
    return cap, accel


@compiled
def _limit_curve(
    seg: Segments,
    k: int,
    limits: AxisLimits,
    path: np.void,
    asked_mm_s: float,
    tangent: Floats,
    bend: Floats,
) -> tuple[float, float]:
    """Return speed cap and tangential acceleration on a curve from per-axis bounds of tangent and curvature."""
    if seg.row[k]["kind"] == OVERLAP:
        return limit_overlap(seg, k, limits, path, asked_mm_s, tangent, bend)
    curve_bounds(seg, k, tangent, bend)
    if path["corner_rule"] == BY_SHARE and seg.row[k]["kind"] == ARC and not seg.row[k]["flags"] & ROUNDING:
        return limit_arc_by_share(seg, k, limits, path, asked_mm_s, tangent, bend)
    is_sum = adds_up(seg.row[k])
    bend_share = SPLINE_CENTRIPETAL_SHARE if is_sum else CENTRIPETAL_SHARE
    whole = path["accel_limit_mm_s2"]
    most = math.inf
    for i in range(tangent.shape[0]):
        if tangent[i] > 0.0:
            most = min(most, limits.speed[i] / tangent[i])
        if bend[i] > 0.0:
            most = min(most, math.sqrt(bend_share * min(limits.acceleration[i], whole) / bend[i]))
    cap = min(asked_mm_s, path["speed_limit_mm_s"], most)
    # With BY_SHARE the lines beside a corner do without what it takes, and an arc has nothing put aside for it.
    # What an arc needs to turn counts as if it were traversed with all that its axes allow, whatever the feed.
    by_share = path["corner_rule"] == BY_SHARE and not is_sum
    share = 1.0 if by_share else CURVE_SHARE
    turning = most if by_share else cap
    rounds = path["rounding_share"] > 0.0 and seg.row[k]["flags"] & ROUNDING != 0
    accel = share * whole
    for i in range(tangent.shape[0]):
        if tangent[i] > 0.0:
            allowed = min(limits.acceleration[i], whole)
            used = turning * turning * bend[i] / allowed if bend[i] > 0.0 else 0.0
            left = share - used if is_sum else math.sqrt(share * share - used * used)
            accel = min(accel, (path["rounding_share"] if rounds else left) * allowed / tangent[i])
    return cap, accel


@compiled
def _gap_s(row: np.void, speed: float) -> float:
    """Return the shortest time that a segment takes when one of its ends is passed with `speed`."""
    length = row["length"]
    return float(2.0 * length / (speed + math.sqrt(speed * speed + 2.0 * row["full_accel"] * length)))


@compiled
def _fitting_square(allowed: float, change: float, row: np.void) -> float:
    """Return the square of the speed v at which v change = allowed times the shortest time of the segment."""
    step = 2.0 * allowed / change
    return float(step * step * row["length"] / (2.0 * (row["full_accel"] + step)))


@compiled
def _lasts(row: np.void, speed: float, time_s: float) -> bool:
    """Tell whether a segment takes at least `time_s`, one of its ends being passed with `speed`."""
    return bool(row["length"] >= (speed + 0.5 * row["full_accel"] * time_s) * time_s)


@compiled
def _yielded(corner: float, used: float) -> float:
    """Return the part of its ramps a line gives away to an axis that needs `corner` and has `used` of its own."""
    return max(0.0, 1.0 - (1.0 - corner) / used) if used > 1.0 - corner else 0.0


@compiled
def _yielded_alone(step: float, less: float) -> float:
    """Return what both lines give away at a corner that is two cycles from any other.

    `step` is the axis' change of velocity over what its acceleration gives in a cycle. One line uses the axis up, the
    other uses `less` of it, so a part of the triangle is free: with q of it between the sample and the corner, the
    need is q step - q^2 (1 - less) / 2, and what is given away counts at least (1 + less q) / 2.
    """
    most = 2.0 * step / (1.0 + less)
    return min(most, step * step / (1.0 - less)) if less < 1.0 else most


@compiled
def limit_junction(
    seg: Segments, k: int, following: int, limits: AxisLimits, path: np.void, dt: float, work: Floats
) -> None:
    """Set `junction`, `yield_before` and `yield_after` of the end of segment `k`, which `following` continues.

    `work` is scratch, [3, n]: first the tangents, then what `_give_way` takes.
    """
    row, after = seg.row[k], seg.row[following]
    row["junction"] = 0.0
    row["yield_before"] = 0.0
    row["yield_after"] = 0.0
    if path["corner_rule"] == BY_SHARE:
        row["kept_out"], after["kept_in"] = 0.0, 0.0
    if row["flags"] & STOP or row["kind"] == WAIT or after["kind"] == WAIT:
        return
    segment_tangent(seg, k, 1.0, work[0])
    segment_tangent(seg, following, 0.0, work[1])
    speed = min(row["cap"], after["cap"])
    if path["corner_rule"] == BY_SHARE:
        speed = min(speed_at_end(seg, k, 1.0), speed_at_end(seg, following, 0.0))
        row["junction"] = _junction_by_share(seg, k, following, limits, path, work, speed)
        return
    if row["flags"] & CORNER_STOP and turns(work, LARGEST_BEND):
        return
    if path["corner_rule"] != AS_AXES_ALLOW:
        row["junction"] = corner_speed(seg, k, following, limits, path, work, speed)
        return
    curved = is_curved(seg, k) or is_curved(seg, following)
    corner = False
    needs = False
    accel_before, accel_after = row["full_accel"], after["full_accel"]
    for i in range(work.shape[1]):
        change = abs(work[1, i] - work[0, i])
        acceleration = limits.acceleration[i]
        work[2, i] = 0.0
        if change <= STRAIGHT:
            continue
        jump = limits.jump[i]
        if jump >= 0.0:
            corner = True
            work[2, i] = -change
            if jump < speed * change:
                speed = jump / change
        elif acceleration < math.inf:
            corner = True
            needs = True
            inverse = 1.0 / acceleration
            before = min(1.0, abs(work[0, i]) * accel_before * inverse) if work[0, i] != 0.0 else 0.0
            behind = min(1.0, abs(work[1, i]) * accel_after * inverse) if work[1, i] != 0.0 else 0.0
            most = CURVE_CORNER_SHARE if curved else 1.0 - max(before, behind) * (1.0 - MOST_SHARE)
            need = change * inverse
            if most * dt < speed * need:
                speed = most * dt / need
            work[0, i], work[1, i], work[2, i] = before, behind, need
            continue
        work[0, i], work[1, i] = 0.0, 0.0
    if corner:
        near = not (_lasts(row, speed, CORNER_MARGIN * dt) and _lasts(after, speed, CORNER_MARGIN * dt))
        if near:
            speed = _speed_between(seg, k, following, limits, dt, work, speed)
        if needs and speed > 0.0:
            speed = _give_way(seg, k, following, path["jerkrel"], dt, work, speed, near)
    row["junction"] = speed


@compiled
def _junction_by_share(
    seg: Segments, k: int, following: int, limits: AxisLimits, path: np.void, work: Floats, speed: float
) -> float:
    """Return the speed of a corner that takes a share of the acceleration, and hold that share back beside it.

    An exact path that rests in the corner holds it back all the same.
    """
    row, after = seg.row[k], seg.row[following]
    if turns(work, SHARPEST):
        return 0.0
    share = step_share(limits, work, speed, after["full_accel"], path["corner_cycle_s"])
    part = 1.0
    if (row["kind"] == ARC or after["kind"] == ARC) and path["rounding_share"] > 0.0:
        part = path["rounding_share"]  # an arc needs the rest to turn
    most = path["corner_share"]
    needed = share / part
    step = part * min(needed, most)
    rests = needed > most and row["flags"] & CORNER_STOP != 0
    curved = step > STEP_OF_ROUNDING and not rests and (is_curved(seg, k) or is_curved(seg, following))
    if curved:
        # A corner that the path slows down for anyway is passed slower instead of taking more of the ramps.
        kept = most if needed > most else 1.0 - LEAST_ON_CURVE
        near = speed * min(1.0, most / needed)
        largest = 1.0
        if is_curved(seg, k):
            largest = float(_held(seg, k, limits, work, kept, _speed_near(row, path, near)))
        if is_curved(seg, following):
            near_after = _speed_near(after, path, near)
            largest = min(largest, float(_held(seg, following, limits, work, kept, near_after)))
        if step > largest:
            step = largest
            most = step / part
    if needed > most:
        speed = 0.0 if rests else speed * most / needed
    row["kept_out"] = min(needed, most)
    after["kept_in"] = row["kept_out"]
    if row["kept_out"] > STEP_OF_ROUNDING:
        keep_turning(seg, k, limits, path, work[:2], row["kept_out"])
        keep_turning(seg, following, limits, path, work[:2], row["kept_out"])
        speed = min(speed, row["cap"], after["cap"])
    if curved:
        near = _speed_near(row, path, speed)
        row["kept_out"] = max(row["kept_out"], _kept_on_curve(seg, k, limits, work, step, near))
        near = _speed_near(after, path, speed)
        after["kept_in"] = max(after["kept_in"], _kept_on_curve(seg, following, limits, work, step, near))
    if speed > 0.0:
        if step > STEP_OF_ROUNDING:
            speed = float(_apart(seg, k, limits, path, work, speed, step))
        inherited = float(row["kept_in"])
        if inherited > STEP_OF_ROUNDING and not _lasts_beside(row, path["corner_cycle_s"], speed):
            inherited = min(inherited, _held(seg, k, limits, work, inherited, row["cap"]))
            after["kept_in"] = max(after["kept_in"], inherited)
            if is_curved(seg, following):
                after["kept_in"] = max(
                    after["kept_in"], _kept_on_curve(seg, following, limits, work, inherited, after["cap"])
                )
    free = row["kind"] == OVERLAP and path["free_overlaps"] != 0
    if after["flags"] & LAST and path["last_share"] > 0.0 and not free:
        speed = min(speed, math.sqrt(_last_part(after, path) * after["full_accel"] * after["length"]))
    return float(speed)


@compiled
def _last_part(row: np.void, path: np.void) -> float:
    """Return which part of the acceleration of a LAST segment is left; one that overlaps may have given its part."""
    part = path["last_share"] / (OVERLAP_SHARE if row["flags"] & OVERLAPS else 1.0)
    return float(min(part, 1.0))


@compiled
def _lasts_beside(row: np.void, time_s: float, speed: float) -> bool:
    """Tell whether a segment takes at least `time_s`, its end being passed with `speed`."""
    return bool(row["length"] >= row["cap"] * time_s or _lasts(row, speed, time_s))


@compiled
def _apart(
    seg: Segments, k: int, limits: AxisLimits, path: np.void, work: Floats, speed: float, step: float
) -> float:
    """Return the speed up to `speed` at the end of segment `k` so late that the corner before is a cycle away.

    Two corners within a cycle would both take their shares of it, and a corner needs its share, `step`, to be held
    back for a whole cycle before it: what is known of the segments there may be final.
    """
    cycle = path["corner_cycle_s"]
    base, capacity = path["base"], path["capacity"]
    head = base + path["head"] % capacity
    way, time, accel, before = 0.0, 0.0, 0.0, math.inf
    for _ in range(MOST_BETWEEN):
        row = seg.row[k]
        way += row["length"]
        time += row["length"] / row["cap"]
        accel = max(accel, row["full_accel"])
        if time >= cycle:
            return speed
        if k == head:
            if path["state"] != RUNNING and path["state"] != HELD:  # it begins at rest
                return speed
            break
        k = base + (k - base - 1 + capacity) % capacity
        last = seg.row[k]
        if last["junction"] <= 0.0:
            return speed
        kept = max(last["kept_in"], last["kept_out"])
        if last["kept_out"] > STEP_OF_ROUNDING or _held(seg, k, limits, work, kept, last["cap"]) < step * (
            1.0 - 1e-9
        ):
            before = float(last["junction"])
            break
    gain = accel * cycle
    slow = max(0.0, way / cycle - 0.5 * gain)  # even if it comes as fast as it can brake
    if before < math.inf:
        root = gain * (4.0 * before + 2.0 * gain) - 4.0 * accel * way
        if root <= 0.0:
            return speed
        other = before + gain - math.sqrt(root)
        if other > slow and before * before <= other * other + 2.0 * accel * way:
            slow = other
    return float(min(speed, slow))


@compiled
def _speed_near(row: np.void, path: np.void, speed: float) -> float:
    """Return the highest speed within two cycles of a corner that is passed with `speed`."""
    return float(min(row["cap"], speed + 2.0 * path["corner_cycle_s"] * row["full_accel"]))


@compiled
def _held(seg: Segments, k: int, limits: AxisLimits, work: Floats, kept: float, speed: float) -> float:
    """Return which part of every axis' acceleration segment `k` leaves alone up to a speed.

    Its ramps give up `kept`.
    """
    if not is_curved(seg, k):
        return kept
    row = seg.row[k]
    curve_bounds(seg, k, work[0], work[1])
    held = 1.0
    for i in range(work.shape[1]):
        if work[0, i] > 0.0:
            turning = speed * speed * work[1, i] / limits.acceleration[i]
            ramp = (1.0 - kept) * row["full_accel"] * work[0, i] / limits.acceleration[i]
            used = turning + ramp if adds_up(row) else math.sqrt(turning * turning + ramp * ramp)
            held = min(held, 1.0 - used)
    return max(held, 0.0)


@compiled
def _kept_on_curve(
    seg: Segments, k: int, limits: AxisLimits, work: Floats, step: float, speed: float
) -> float:
    """Return the part of its ramps that a curve gives up so that all it uses up to a speed leaves a corner the share.

    Turning takes what it takes, so the ramps give up more than the corner needs.
    """
    if not is_curved(seg, k):
        return 0.0
    row = seg.row[k]
    curve_bounds(seg, k, work[0], work[1])
    kept = 0.0
    for i in range(work.shape[1]):
        if work[0, i] > 0.0 and row["full_accel"] > 0.0:
            turning = speed * speed * work[1, i] / limits.acceleration[i]
            ramp = row["full_accel"] * work[0, i] / limits.acceleration[i]
            left = max(0.0, 1.0 - step - turning)
            if not adds_up(row):
                left = math.sqrt(left * (1.0 - step + turning))
            kept = max(kept, 1.0 - left / ramp)
    return min(kept, 1.0 - LEAST_ON_CURVE)


@compiled
def _speed_between(
    seg: Segments, k: int, following: int, limits: AxisLimits, dt: float, work: Floats, speed: float
) -> float:
    """Return the highest speed up to `speed` where the next corner is less than a cycle away.

    `work` holds what each axis uses on both sides and the time it needs per speed, or minus its change where it may
    jump.
    """
    row, after = seg.row[k], seg.row[following]
    curved = is_curved(seg, k) or is_curved(seg, following)
    square = speed * speed
    for i in range(work.shape[1]):
        if work[2, i] > 0.0:
            most = CURVE_CORNER_SHARE if curved else 1.0 - max(work[0, i], work[1, i]) * (1.0 - MOST_SHARE)
            need = work[2, i]
        elif work[2, i] < 0.0:
            most = limits.jump[i] / dt
            need = -work[2, i]
        else:
            continue
        square = min(square, _fitting_square(most / CORNER_MARGIN, need, row))
        square = min(square, _fitting_square(most / CORNER_MARGIN, need, after))
    return math.sqrt(square)


@compiled
def _give_way(
    seg: Segments, k: int, following: int, jerkrel: float, dt: float, work: Floats, speed: float, near: bool
) -> float:
    """Set what the lines beside a corner give away to it; return its speed, `speed` or what is worth it.

    `work` holds what each axis uses on both sides and the time it needs per speed; `near`: the next corner is.
    """
    row, after = seg.row[k], seg.row[following]
    free_before, free_after = is_curved(seg, k), is_curved(seg, following)  # a curve has put its part aside
    long_before, long_after = True, True
    time = dt
    if near:
        long_before, long_after = _lasts(row, speed, dt), _lasts(after, speed, dt)
        time = min(dt, min(_gap_s(row, speed), _gap_s(after, speed)) / CORNER_MARGIN)
    before = 0.0 if free_before else _given(work, 0, speed, time)
    behind = 0.0 if free_after else _given(work, 1, speed, time)
    loses = long_before and before * row["full_accel"] * dt > WORTH * speed
    loses = loses or (long_after and behind * after["full_accel"] * dt > WORTH * speed)
    if loses:
        alone = speed if free_before or free_after else _speed_alone(row, after, dt, work, speed)
        far = not (free_before or free_after)
        far = far and _lasts(row, alone, 2.0 * dt) and _lasts(after, alone, 2.0 * dt)
        if far:
            speed = alone
        else:
            if long_before and not free_before:
                speed = _worth_speed(row, after, work, 0, dt, speed)
            if long_after and not free_after:
                speed = _worth_speed(after, row, work, 1, dt, speed)
        if speed <= 0.0:
            return 0.0
        time = min(dt, min(_gap_s(row, speed), _gap_s(after, speed)) / CORNER_MARGIN)
        before, behind = 0.0, 0.0
        for i in range(work.shape[1]):
            if work[2, i] > 0.0:
                step = work[2, i] * speed
                given, taken = _yielded(step / time, work[0, i]), _yielded(step / time, work[1, i])
                if far:
                    both = _yielded_alone(step / dt, min(work[0, i], work[1, i]))
                    if both < max(given, taken):
                        given, taken = both, both
                before, behind = max(before, given), max(behind, taken)
        before = 0.0 if free_before else before
        behind = 0.0 if free_after else behind
    if near:
        if not (free_before or _lasts(row, speed, dt) or _saves_time(row, speed, before, jerkrel, dt)):
            return 0.0
        if not (free_after or _lasts(after, speed, dt) or _saves_time(after, speed, behind, jerkrel, dt)):
            return 0.0
    row["yield_before"] = before / speed
    row["yield_after"] = behind / speed
    return speed


@compiled
def _given(work: Floats, side: int, speed: float, time_s: float) -> float:
    """Return the part of its ramps that the line on one side gives to a corner within `time_s` of the next."""
    share = 0.0
    for i in range(work.shape[1]):
        if work[2, i] > 0.0:
            share = max(share, _yielded(work[2, i] * speed / time_s, work[side, i]))
    return share


@compiled
def _speed_alone(row: np.void, after: np.void, dt: float, work: Floats, speed: float) -> float:
    """Return the highest speed up to `speed` at a corner far from others that costs no more than WORTH of it."""
    accel = max(row["full_accel"], after["full_accel"])
    for i in range(work.shape[1]):
        if work[2, i] > 0.0:
            crude = min(
                _worth_of_axis(row, work[2, i], work[0, i], dt, speed),
                _worth_of_axis(after, work[2, i], work[1, i], dt, speed),
            )
            if crude < speed:
                step = work[2, i] / dt
                less = min(work[0, i], work[1, i])
                speed = min(speed, max(crude, WORTH * (1.0 - less) / (step * step * accel * dt)))
    return speed


@compiled
def _worth_of_axis(row: np.void, need: float, used: float, dt: float, speed: float) -> float:
    """Return the highest speed at which a line gives one axis no more than WORTH of it, by a full cycle each way."""
    accel = row["full_accel"]
    if _yielded(need * speed / dt, used) * accel * dt <= WORTH * speed:
        return speed
    return float((1.0 - used) / (need / dt - used * WORTH / (accel * dt)))


@compiled
def _worth_speed(row: np.void, other: np.void, work: Floats, side: int, dt: float, speed: float) -> float:
    """Return the highest speed up to `speed` at which line `row`, longer than a cycle, loses no more than WORTH of it.

    It loses what it gives away of its acceleration for a cycle.
    """
    time = min(dt, _gap_s(other, speed) / CORNER_MARGIN)
    accel = row["full_accel"]
    lowest = speed
    for i in range(work.shape[1]):
        need, used = work[2, i], work[side, i]
        if need <= 0.0:
            continue
        if time == dt:
            lowest = min(lowest, _worth_of_axis(row, need, used, dt, speed))
        elif _yielded(need * speed / time, used) * accel * dt > WORTH * speed:
            # So slow that the way to the next corner takes as long as the change of velocity needs.
            longer = CORNER_MARGIN * need * accel * dt / WORTH
            slow = other["length"] / longer - 0.5 * other["full_accel"] * longer
            lowest = float(min(lowest, max(0.0, slow)))
    return lowest


@compiled
def _saves_time(row: np.void, speed: float, share: float, jerkrel: float, dt: float) -> bool:
    """Tell whether a short line from rest to a corner at `speed` takes no longer than from rest to rest.

    At rest at both ends it takes a cycle at least.
    """
    length, accel = row["length"], row["full_accel"] / (1.0 + jerkrel)
    give = share * accel * length / speed  # what is given away grows with the speed that is reached
    reached = min(speed, math.sqrt(give * give + 2.0 * accel * length) - give)
    less = accel * (1.0 - share * reached / speed)
    time = reached / less + (length - 0.5 * reached * reached / less) / reached
    return bool(time <= max(dt, 2.0 * math.sqrt(length / accel)))


@compiled
def share_acceleration(
    seg: Segments, k: int, before: float, yield_before: float, jerkrel: float, path: np.void, dt: float
) -> None:
    """Set `accel` of segment `k`, and `gain`: what its ramps add to the squared speed beside both its corners.

    `before` is the junction at its start; the segment gives `yield_before` per speed to that corner. An S-shaped ramp
    has (1 + jerkrel) times its mean acceleration at its peak, so the mean is that much lower.
    """
    row = seg.row[k]
    accel = row["full_accel"] / (1.0 + jerkrel)
    if path["corner_rule"] == BY_SHARE:
        accel *= 1.0 - max(row["kept_in"], row["kept_out"])
        if row["flags"] & LAST and path["last_share"] > 0.0:
            accel *= _last_part(row, path)
    length = row["length"]
    row["accel"] = accel
    row["gain"] = 0.0 if gets_faster(row, seg.geo[k]) else 2.0 * accel * length
    first, last = yield_before * before, row["yield_before"] * row["junction"]
    if first > 0.0 or last > 0.0:
        from_start = beside_corner(before, accel, first, dt, length) if first > 0.0 else 0.0
        to_end = beside_corner(row["junction"], accel, last, dt, length) if last > 0.0 else 0.0
        both = max(0.0, from_start + to_end - length)
        lost = first * (from_start - both) + last * (to_end - both) + max(first, last) * both
        row["gain"] -= 2.0 * accel * lost


@compiled
def least_accel(row: np.void, path: np.void) -> float:
    """Return an acceleration that the segment will allow whatever comes after it, another override included."""
    part = LEAST_PART * (LEAST_OF_ARC if row["kind"] == ARC and path["corner_rule"] == BY_SHARE else 1.0)
    if row["kind"] == OVERLAP:
        part = LEAST_OF_OVERLAP
    return float(row["full_accel"] * part / (1.0 + path["jerkrel"]))
