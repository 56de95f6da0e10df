"""Go along a path: one sample per control cycle, or many at once in closed form.

Time runs on across junctions that are passed with speed; where the path comes to rest, the last sample is the
end point itself and the next segment begins with the next cycle. So every stretch from rest to rest takes a
whole number of cycles.

Units: those of `_segments`; `dt`, the cycle, in s.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._curve_limits import goes_through
from polycnc.kernel._follow import follow_cycle_along, follows, start_following
from polycnc.kernel._geometry import segment_point
from polycnc.kernel._in_step import note_begun
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._lookahead import window_speed
from polycnc.kernel._path import (
    EVENT,
    FEED_S,
    FROM_S,
    GONE,
    HELD,
    INSIDE,
    LENGTH,
    MOST_PASSED,
    NO_LIMIT,
    PASSED_AT_ONCE,
    PASSED_COUNT,
    PASSED_CYCLE,
    PASSED_EVENT,
    PASSED_FEED_S,
    PASSED_RAPID_S,
    RAPID_S,
    READY,
    REST_SLACK,
    RESTED,
    RESTS_PER_CYCLE,
    RUNNING,
    SPEED_NOW,
    SPEED_OUT,
    STILL,
    TIME_CRUISE,
    TIME_IN,
    Paths,
    is_held,
    ramps_duration,
    slot,
)
from polycnc.kernel._ramps import (
    MOST_SHARE,
    beside_corner,
    halting_distance,
    plan_pause,
    plan_ramps,
    ramps_at,
    set_pieces,
)
from polycnc.kernel._segments import WAIT, WAIT_EVENT, WAIT_PASSES, Floats, Segments
from polycnc.kernel._segments import WAIT_S as GEO_WAIT_S
from polycnc.kernel._totals import account_time, leave_segment


@compiled
def _may_pass(seg: Segments, paths: Paths, g: int, k: int, now: int) -> bool:
    """Note the event of the wait in slot `k` and tell whether the path goes on, in cycle `now`; see `let_pass`."""
    path = paths.row[g]
    if path["passes"] == 0 or now < 0 or seg.geo[k, WAIT_PASSES] == 0.0 or path["passed"] >= MOST_PASSED:
        return False
    at_once = path["passed_at"] == now
    if not at_once:
        path["passed_at"], path["spare"] = now, RESTS_PER_CYCLE - 1
    elif path["spare"] <= 0:
        return False
    else:
        path["spare"] -= 1
    row, totals = paths.passed[g, path["passed"]], paths.totals[g]
    row[PASSED_EVENT], row[PASSED_CYCLE], row[PASSED_AT_ONCE] = seg.geo[k, WAIT_EVENT], now, at_once
    row[PASSED_COUNT] = 0.0
    row[PASSED_FEED_S], row[PASSED_RAPID_S] = totals[FEED_S], totals[RAPID_S]
    path["passed"] += 1
    return True


@compiled
def settle(seg: Segments, paths: Paths, g: int, now: int) -> int:
    """Pass waits of no duration at a point of rest; return EVENT if one of them reports one, else STILL.

    `now` is the cycle, negative where events count for nothing.
    """
    path = paths.row[g]
    path["event"] = -1
    while path["state"] == READY and path["head"] < path["prepared"]:
        k = slot(paths, g, path["head"])
        if is_held(path, seg.row[k]) or seg.row[k]["kind"] != WAIT or seg.geo[k, GEO_WAIT_S] > 0.0:
            break
        event = int(seg.geo[k, WAIT_EVENT])
        leave_segment(seg, paths, g, 0.0)
        if event >= 0 and not _may_pass(seg, paths, g, k, now):
            path["event"] = event
            return EVENT
    return STILL


@compiled
def _enter(seg: Segments, paths: Paths, g: int, speed: float, share: float, dt: float) -> None:
    """Note what the segment at `head` gives up near its start, which is passed with `speed`."""
    path = paths.row[g]
    row = seg.row[slot(paths, g, path["head"])]
    path["entry_share"] = share
    if share > 0.0:
        path["entry_zone"] = beside_corner(speed, row["accel"], share, dt, row["length"])


@compiled
def _plan_from(
    seg: Segments, paths: Paths, g: int, speed: float, s: float, lead: float, most: float, dt: float
) -> None:
    """Plan the segment at `head` from path length `s` on, entered with `speed` `lead` seconds ago.

    `most` is the highest speed at its end.
    """
    path, ramps = paths.row[g], paths.ramps[g]
    count = int(path["head"])
    k = slot(paths, g, count)
    row = seg.row[k]
    path["lead"] = lead
    path["cycles"] = 0
    path["pending"] = 0
    if row["kind"] == WAIT:
        plan_pause(ramps, seg.geo[k, GEO_WAIT_S])
    else:
        out = row["out"] if path["depth"] == 0 else window_speed(seg, paths, g, count)
        out = min(out, most)
        length = row["length"] - s
        if goes_through(row, seg.geo[k], speed):
            out = max(out, speed)
            _plan_pieces(path, row, ramps, speed, s, length, max(row["cap"], speed), out, out, dt)
        elif is_held(path, row) or row["cap"] <= 0.0:
            needed = halting_distance(speed, row["accel"], path["entry_zone"] - s, path["entry_share"])
            through = min(speed, max(out, row["bound"])) if needed > length else 0.0
            _plan_pieces(path, row, ramps, speed, s, min(needed, length), speed, through, 0.0, dt)
        else:
            _plan_pieces(path, row, ramps, speed, s, length, row["cap"], out, out, dt)
            if ramps[SPEED_OUT] > out and row["bound"] > out:  # too late to brake down to a lower override
                _plan_pieces(path, row, ramps, speed, s, length, row["cap"], row["bound"], out, dt)


@compiled
def _plan_pieces(
    path: np.void,
    row: np.void,
    ramps: Floats,
    speed: float,
    s: float,
    length: float,
    cap: float,
    through: float,
    out: float,
    dt: float,
) -> None:
    """Plan `length` from `s` on to speed `out`, ready to pass the corner there with up to `through`."""
    zone, share, accel = path["entry_zone"] - s, path["entry_share"], row["accel"]
    set_pieces(ramps, speed, length, accel, through, zone, share, row["yield_before"], dt)
    plan_ramps(ramps, speed, length, cap, accel, out, s)


@compiled
def ends_within(row: np.void, ramps: Floats) -> bool:
    """Tell whether the planned stretch stops short of the segment's end (feed hold)."""
    return bool(ramps[FROM_S] + ramps[LENGTH] < row["length"])


@compiled
def in_ramp(paths: Paths, g: int, t: float) -> bool:
    """Tell whether an S-shaped ramp is under way at time `t` of the planned stretch."""
    ramps = paths.ramps[g]
    change = t < ramps[TIME_IN] or t > ramps[TIME_IN] + ramps[TIME_CRUISE]
    return bool(paths.row[g]["jerkrel"] > 0.0 and change)


@compiled
def plan_again(seg: Segments, paths: Paths, g: int, dt: float) -> None:
    """Plan the running segment anew from where the path stands, unless the next sample is beyond it anyway.

    A wait that is held stands still: what is left of it passes when the hold ends. An S-shaped ramp that is under way
    is finished first, so that the acceleration does not step. A corner less than a cycle away is not passed faster than
    was planned before.
    """
    path, ramps = paths.row[g], paths.ramps[g]
    row = seg.row[slot(paths, g, path["head"])]
    if path["state"] != RUNNING:
        return
    if row["kind"] == WAIT:
        if is_held(path, row):
            path["state"] = HELD
        return
    if follows(seg, paths, g):  # it looks anew in every cycle
        return
    t = path["lead"] + path["cycles"] * dt
    if in_ramp(paths, g, t):
        path["pending"] = 1
    elif ramps_duration(ramps) - t > dt or ends_within(row, ramps):
        account_time(seg, paths, g, t)
        s, speed = ramps_at(ramps, t, path["jerkrel"])
        s = min(s, row["length"])
        planned = 0.0 if ends_within(row, ramps) else ramps[SPEED_OUT]
        _plan_from(seg, paths, g, speed, s, 0.0, math.inf, dt)
        if ramps[SPEED_OUT] > planned and ramps_duration(ramps) < dt:
            # The last cycle before the corner has begun, and gave up no more than the speed planned then needs.
            _plan_from(seg, paths, g, speed, s, 0.0, planned, dt)


@compiled
def next_sample(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Take path `g` one cycle on in time; return STILL, INSIDE or RESTED. Positions are not evaluated."""
    path, ramps = paths.row[g], paths.ramps[g]
    if path["state"] == READY:
        while settle(seg, paths, g, -1) == EVENT:
            pass  # whoever wants events has settled before, see `advance` and `skip_path`
        if path["head"] >= path["prepared"] or is_held(path, seg.row[slot(paths, g, path["head"])]):
            return STILL
        if follows(seg, paths, g):
            start_following(seg, paths, g, dt)
        path["state"] = RUNNING
        if not follows(seg, paths, g):
            _plan_from(seg, paths, g, 0.0, 0.0, 0.0, math.inf, dt)
    elif path["state"] == HELD and not is_held(path, seg.row[slot(paths, g, path["head"])]):
        path["state"] = RUNNING
        if seg.row[slot(paths, g, path["head"])]["kind"] != WAIT and not follows(seg, paths, g):
            _plan_from(seg, paths, g, 0.0, ramps[FROM_S] + ramps[LENGTH], 0.0, math.inf, dt)
    elif path["state"] != RUNNING:
        return STILL
    if follows(seg, paths, g):
        return follow_cycle_along(seg, paths, g, dt)
    path["cycles"] += 1
    t = path["lead"] + path["cycles"] * dt
    while True:
        row = seg.row[slot(paths, g, path["head"])]
        path["tag"] = row["tag"]
        path["flags"] = row["flags"]
        duration = ramps_duration(ramps)
        speed = ramps[SPEED_OUT]
        inside = t < duration - REST_SLACK * dt if speed == 0.0 else t <= duration
        if inside:
            if path["pending"] != 0:
                plan_again(seg, paths, g, dt)
            return INSIDE
        if speed == 0.0:
            if ends_within(row, ramps):
                path["state"] = HELD
                account_time(seg, paths, g, t)
            else:
                path["state"] = READY
                leave_segment(seg, paths, g, t)
            return RESTED
        share = min(MOST_SHARE, row["yield_after"] * speed)
        leave_segment(seg, paths, g, duration)
        if path["head"] >= path["prepared"]:  # a prescribed end speed, and nothing to go on with
            path["state"] = READY
            return RESTED
        t -= duration
        _enter(seg, paths, g, speed, share, dt)
        _plan_from(seg, paths, g, speed, 0.0, t, math.inf, dt)


@compiled
def place_path(seg: Segments, paths: Paths, g: int, dt: float) -> None:
    """Set `position` and `speed` of path `g` to where it stands."""
    path, ramps = paths.row[g], paths.ramps[g]
    count = int(path["head"])
    s, speed = ramps[FROM_S] + ramps[LENGTH], 0.0
    if (path["state"] == RUNNING or path["state"] == HELD) and follows(seg, paths, g):
        s, speed = ramps[GONE], ramps[SPEED_NOW]
    elif path["state"] == RUNNING:
        s, speed = ramps_at(ramps, path["lead"] + path["cycles"] * dt, path["jerkrel"])
    elif path["state"] == READY:
        count -= 1
        s = math.inf
    path["speed"] = speed
    segment_point(seg, slot(paths, g, count), s, paths.position[g])


@compiled
def path_cycle(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Take path `g` one cycle on and set its `position` and `speed`; return what `next_sample` returns."""
    result = next_sample(seg, paths, g, dt)
    paths.row[g]["speed"] = 0.0
    if result != STILL:
        place_path(seg, paths, g, dt)
    return result


@compiled
def _jump_ahead(paths: Paths, g: int, dt: float) -> int:
    """Count the samples up to the last one inside the planned stretch at once; return how many."""
    path, ramps = paths.row[g], paths.ramps[g]
    last = ramps_duration(ramps)
    rests = ramps[SPEED_OUT] == 0.0
    if rests:
        last -= REST_SLACK * dt
    now = int(path["cycles"])
    cycles = max(math.floor((last - path["lead"]) / dt) + 1, now)
    while cycles > now:  # the very comparison that `next_sample` makes
        t = path["lead"] + cycles * dt
        if t < last or (t == last and not rests):
            break
        cycles -= 1
    path["cycles"] = cycles
    return int(cycles - now)


def _steps(seg: Segments, paths: Paths, g: int, dt: float, until: int, *_: int) -> int:
    path = paths.row[g]
    if path["jerk_mm_s3"] > 0.0:
        return NO_LIMIT  # each cycle is one, and nobody knows how many there will be
    return 3 * int(min(until, path["tail"]) - path["head"]) + 1


@entry(steps=_steps)
def skip_path(seg: Segments, paths: Paths, g: int, dt: float, until: int, cycle: int) -> int:
    """Go along path `g` from a cycle on while its segment count is below `until`; return the cycles taken.

    The cycles are those that `path_cycle` takes, to the last one, but only the last position is evaluated: the
    samples inside a segment are counted at once. Stops at an event, which then stands in the path's row, and where
    `note_begun` asks for it.
    """
    path = paths.row[g]
    taken = 0
    path["event"] = -1
    path["passed_at"] = cycle if path["passes"] != 0 else -1
    while path["head"] < until:
        if path["state"] == READY and settle(seg, paths, g, cycle + taken) == EVENT:
            break
        if path["state"] == RUNNING and path["pending"] == 0 and not follows(seg, paths, g):
            taken += _jump_ahead(paths, g, dt)
        if next_sample(seg, paths, g, dt) == STILL:
            break
        taken += 1
        if path["in_step"] > 0 and note_begun(seg, paths, g, cycle + taken):
            break
    if path["head"] > 0 or path["state"] > READY:
        place_path(seg, paths, g, dt)
    return taken
