"""Go along a path: one sample per control cycle, or many at once in closed form.

Time runs on across junctions that are passed with speed; where the path comes to rest, the last sample is the
end point itself and the next segment begins with the next cycle. So every stretch from rest to rest takes a
whole number of cycles.
"""

from __future__ import annotations

import math

from polycnc.kernel._geometry import segment_point
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._limits import AxisLimits
from polycnc.kernel._lookahead import limit_queue, plan_path, window_speed
from polycnc.kernel._path import (
    FEED_LENGTH,
    FEED_S,
    HELD,
    IDLE,
    RAPID_LENGTH,
    RAPID_S,
    READY,
    RUNNING,
    SEGMENTS,
    TOP_SPEED,
    WAIT_S,
    Paths,
    slot,
)
from polycnc.kernel._ramps import (
    FROM_S,
    LENGTH,
    ROUNDING,
    SPEED_OUT,
    SPEED_PEAK,
    TIME_CRUISE,
    in_ramp,
    plan_halt,
    plan_ramps,
    ramps_at,
    ramps_duration,
)
from polycnc.kernel._segments import RAPID, TURN, WAIT, WAIT_EVENT, Floats, Segments
from polycnc.kernel._segments import WAIT_S as GEO_WAIT_S

REST_SLACK = 1e-6  # part of a cycle by which rounding may make a rest late

# What a sample brought.
STILL = 0  # no motion: idle, held or nothing queued
INSIDE = 1  # in motion
RESTED = 2  # the path came to rest at the end of a segment
EVENT = 3  # an event stands at the point of rest


@entry
def start_path(paths: Paths, g: int) -> None:
    """Let path `g` begin with its queue in the next cycle."""
    if paths.row[g]["state"] == IDLE:
        paths.row[g]["state"] = READY


@compiled
def _account(seg: Segments, paths: Paths, g: int, k: int, seconds: float) -> None:
    totals = paths.totals[g]
    totals[SEGMENTS] += 1.0
    turns = seg.row[k]["flags"] & TURN  # degrees are neither path length nor feed
    length = 0.0 if turns else seg.row[k]["length"]
    if seg.row[k]["kind"] == WAIT:
        totals[WAIT_S] += seconds
    elif seg.row[k]["flags"] & RAPID:
        totals[RAPID_S] += seconds
        totals[RAPID_LENGTH] += length
    else:
        totals[FEED_S] += seconds
        totals[FEED_LENGTH] += length
        if not turns:
            totals[TOP_SPEED] = max(totals[TOP_SPEED], paths.ramps[g, SPEED_PEAK])


@compiled
def _leave(seg: Segments, paths: Paths, g: int, seconds: float) -> None:
    k = slot(paths, g, paths.row[g]["head"])
    _account(seg, paths, g, k, seconds)
    paths.row[g]["entry_share"] = seg.row[k]["share"]
    paths.row[g]["head"] += 1


@compiled
def settle(seg: Segments, paths: Paths, g: int) -> int:
    """Pass waits of no duration at a point of rest; return EVENT if one of them reports one, else STILL."""
    paths.row[g]["event"] = -1
    while paths.row[g]["state"] == READY and paths.row[g]["head"] < paths.row[g]["tail"]:
        k = slot(paths, g, paths.row[g]["head"])
        if seg.row[k]["kind"] != WAIT or seg.geo[k, GEO_WAIT_S] > 0.0:
            break
        event = int(seg.geo[k, WAIT_EVENT])
        paths.row[g]["tag"] = seg.row[k]["tag"]
        _leave(seg, paths, g, 0.0)
        if event >= 0:
            paths.row[g]["event"] = event
            return EVENT
    return STILL


@compiled
def _plan_rest_of_segment(seg: Segments, paths: Paths, g: int, speed: float, s: float) -> None:
    """Plan the stretch of the segment at `head` from path length `s` on, entered with `speed`."""
    count = int(paths.row[g]["head"])
    k = slot(paths, g, count)
    ramps = paths.ramps[g]
    if seg.row[k]["kind"] == WAIT:
        ramps[:] = 0.0
        ramps[TIME_CRUISE] = seg.geo[k, GEO_WAIT_S]
        return
    length = seg.row[k]["length"] - s
    if paths.row[g]["hold"] != 0:
        plan_halt(ramps, speed, length, seg.row[k]["accel"], s)
        return
    out = seg.row[k]["out"] if paths.row[g]["depth"] == 0 else window_speed(seg, paths, g, count)
    plan_ramps(ramps, speed, length, seg.row[k]["cap"], seg.row[k]["accel"], out, s)


@compiled
def _enter(seg: Segments, paths: Paths, g: int, speed: float, lead: float) -> None:
    _plan_rest_of_segment(seg, paths, g, speed, 0.0)
    paths.row[g]["lead"] = lead
    paths.row[g]["cycles"] = 0
    paths.row[g]["pending"] = 0


@compiled
def _replan_running(seg: Segments, paths: Paths, g: int, dt: float) -> None:
    """Plan the rest of the running segment anew from the present place and speed."""
    k = slot(paths, g, paths.row[g]["head"])
    row = paths.row[g]
    row["pending"] = 0
    if seg.row[k]["kind"] == WAIT:
        return
    t = row["lead"] + row["cycles"] * dt
    s, speed = ramps_at(paths.ramps[g], t, row["jerkrel"])
    _plan_rest_of_segment(seg, paths, g, speed, min(s, seg.row[k]["length"]))
    row["lead"] = 0.0
    row["cycles"] = 0


@compiled
def _take_pending(seg: Segments, paths: Paths, g: int, t: float, dt: float) -> None:
    """Take over a change that waited for the end of a ramp."""
    if paths.row[g]["pending"] != 0 and not in_ramp(paths.ramps[g], t):
        _replan_running(seg, paths, g, dt)


@compiled
def _reached(seg: Segments, paths: Paths, g: int) -> float:
    """Return the path length within the running segment at which its planned stretch ends."""
    end = paths.ramps[g, FROM_S] + paths.ramps[g, LENGTH]
    length = seg.row[slot(paths, g, paths.row[g]["head"])]["length"]
    return float(end if end < length * (1.0 - ROUNDING) else length)


@compiled
def _ends_within(seg: Segments, paths: Paths, g: int) -> bool:
    """Tell whether the planned stretch stops short of the segment's end (feed hold)."""
    return bool(_reached(seg, paths, g) < seg.row[slot(paths, g, paths.row[g]["head"])]["length"])


@compiled
def next_sample(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Take path `g` one cycle on in time; return STILL, INSIDE or RESTED. Positions are not evaluated."""
    if paths.row[g]["state"] == READY:
        while settle(seg, paths, g) == EVENT:
            pass  # whoever wants events has settled before, see `advance` and `skip_path`
        if paths.row[g]["head"] >= paths.row[g]["tail"] or paths.row[g]["hold"] != 0:
            return STILL
        paths.row[g]["state"] = RUNNING
        _enter(seg, paths, g, 0.0, 0.0)
    elif paths.row[g]["state"] == HELD and paths.row[g]["hold"] == 0:
        paths.row[g]["state"] = RUNNING
        _plan_rest_of_segment(seg, paths, g, 0.0, _reached(seg, paths, g))
        paths.row[g]["lead"] = 0.0
        paths.row[g]["cycles"] = 0
    elif paths.row[g]["state"] != RUNNING:
        return STILL
    paths.row[g]["cycles"] += 1
    t = paths.row[g]["lead"] + paths.row[g]["cycles"] * dt
    while True:
        ramps = paths.ramps[g]
        duration = ramps_duration(ramps)
        current = seg.row[slot(paths, g, paths.row[g]["head"])]
        paths.row[g]["tag"] = current["tag"]
        paths.row[g]["flags"] = current["flags"]
        if ramps[SPEED_OUT] == 0.0:
            if t < duration - REST_SLACK * dt:
                _take_pending(seg, paths, g, t, dt)
                return INSIDE
            if _ends_within(seg, paths, g):
                paths.row[g]["state"] = HELD
            else:
                paths.row[g]["state"] = READY
                _leave(seg, paths, g, t)
            return RESTED
        if t <= duration:
            _take_pending(seg, paths, g, t, dt)
            return INSIDE
        t -= duration
        speed = ramps[SPEED_OUT]
        _leave(seg, paths, g, duration)
        if paths.row[g]["head"] >= paths.row[g]["tail"]:  # a prescribed end speed, and nothing to go on with
            paths.row[g]["state"] = READY
            return RESTED
        _enter(seg, paths, g, speed, t)


@compiled
def path_cycle(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Take path `g` one cycle on and set its `position` and `speed`; return what `next_sample` returns."""
    before = int(paths.row[g]["head"])
    result = next_sample(seg, paths, g, dt)
    position = paths.position[g]
    if result == INSIDE:
        k = slot(paths, g, paths.row[g]["head"])
        t = paths.row[g]["lead"] + paths.row[g]["cycles"] * dt
        s, speed = ramps_at(paths.ramps[g], t, paths.row[g]["jerkrel"])
        paths.row[g]["speed"] = speed
        if seg.row[k]["kind"] != WAIT:
            segment_point(seg, k, min(s, seg.row[k]["length"]), position)
    elif result == RESTED:
        paths.row[g]["speed"] = 0.0
        if paths.row[g]["state"] == HELD:
            segment_point(seg, slot(paths, g, paths.row[g]["head"]), _reached(seg, paths, g), position)
        else:
            k = slot(paths, g, max(before, int(paths.row[g]["head"]) - 1))
            for i in range(position.shape[0]):
                position[i] = seg.end[k, i]
    else:
        paths.row[g]["speed"] = 0.0
    return result


@compiled
def skip_path(seg: Segments, paths: Paths, g: int, dt: float, until: int) -> int:
    """Go along path `g` without setpoints while its segment count is below `until`; return the cycles taken.

    The cycles are those that `path_cycle` takes, to the last one: all but the samples next to a segment's end
    are counted at once, the rest stepped. Stops at an event, which then stands in the path's row.
    """
    cycles = 0
    paths.row[g]["event"] = -1
    while paths.row[g]["head"] < until:
        if paths.row[g]["state"] == READY and settle(seg, paths, g) == EVENT:
            break
        if paths.row[g]["state"] == RUNNING:
            left = ramps_duration(paths.ramps[g]) - paths.row[g]["lead"]
            jump = math.floor(left / dt) - 2
            if jump > paths.row[g]["cycles"]:
                cycles += jump - int(paths.row[g]["cycles"])
                paths.row[g]["cycles"] = jump
        result = next_sample(seg, paths, g, dt)
        if result == STILL:
            break
        cycles += 1
    if paths.row[g]["state"] == READY and paths.row[g]["head"] > 0:
        k = slot(paths, g, paths.row[g]["head"] - 1)
        for i in range(seg.end.shape[1]):
            paths.position[g, i] = seg.end[k, i]
    return cycles


@entry
def replan_path(seg: Segments, paths: Paths, g: int, limits: AxisLimits, dt: float, work: Floats) -> None:
    """Take over a new override, hold or queue extension from where path `g` stands now.

    An S-shaped ramp that is under way is finished first, so that the acceleration does not step.
    """
    row = paths.row[g]
    limit_queue(seg, paths, g, limits, dt, int(row["head"]), work)
    row["planned"] = row["head"]
    plan_path(seg, paths, g)
    if row["state"] == RUNNING:
        if row["jerkrel"] > 0.0 and in_ramp(paths.ramps[g], row["lead"] + row["cycles"] * dt):
            row["pending"] = 1
        else:
            _replan_running(seg, paths, g, dt)
