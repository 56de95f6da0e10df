"""Take over what is new while a path runs: segments appended, another override, feed hold and its release.

Speeds may fall at once, but what they were planned with (corners and their shares, accelerations) stays as it is
within the distance that braking takes, because the motion has already been planned and partly traversed with it.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend_arcs import may_be_rounded
from polycnc.kernel._cruise import first_open, limit_cruise
from polycnc.kernel._follow import follows
from polycnc.kernel._geometry import is_curved
from polycnc.kernel._interpolate import ends_within, in_ramp, plan_again
from polycnc.kernel._jerk import brake_way, moved
from polycnc.kernel._jerk_plan import has_limited_jerk, plan_with_jerk
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._limits import feed_in_force, least_accel, line_speed, overridden_rapid
from polycnc.kernel._lookahead import limit_queue, plan_path
from polycnc.kernel._merge import close_line, is_open
from polycnc.kernel._overlap import overlap_as_known
from polycnc.kernel._path import (
    FROM_S,
    GONE,
    HELD,
    IDLE,
    LENGTH,
    NO_LIMIT,
    RATE,
    READY,
    RUNNING,
    SPEED_NOW,
    SPEED_OUT,
    TIME_CRUISE,
    TIME_IN,
    Paths,
    mark_last,
    slot,
)
from polycnc.kernel._ramps import ramps_at
from polycnc.kernel._segments import ASKED, OVERLAP, RAPID, STOP, WAIT, Segments, Table, set_wait


@compiled
def _next_plan(seg: Segments, paths: Paths, g: int, dt: float) -> tuple[int, float, float]:
    """Return where path `g` can first be planned anew: segment count, path length in it, and speed there."""
    path, ramps = paths.row[g], paths.ramps[g]
    head = int(path["head"])
    row = seg.row[slot(paths, g, head)]
    if (path["state"] != RUNNING and path["state"] != HELD) or row["kind"] == WAIT:
        return head, 0.0, 0.0
    t = path["lead"] + path["cycles"] * dt
    if path["state"] == RUNNING and not in_ramp(paths, g, t):
        s, speed = ramps_at(ramps, t, path["jerkrel"])
        return head, s, speed
    if path["state"] == RUNNING and t < ramps[TIME_IN] and ramps[TIME_CRUISE] > 2.0 * dt:
        s, speed = ramps_at(ramps, ramps[TIME_IN], path["jerkrel"])
        return head, s, speed
    if ends_within(row, ramps):
        return head, float(ramps[FROM_S] + ramps[LENGTH]), 0.0
    return head + 1, 0.0, float(ramps[SPEED_OUT])


@compiled
def _frozen_with_jerk(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Return what `frozen_until` returns where the jerk is limited."""
    path, ramps = paths.row[g], paths.ramps[g]
    first, jerk = int(path["head"]), path["jerk_mm_s3"]
    rate = max(ramps[RATE], 0.0) + 2.0 * dt * jerk
    ease_time = rate / jerk
    way, speed, _ = moved(ramps[SPEED_NOW], rate, -jerk, ease_time)
    way += 2.0 * dt * speed
    passed = -ramps[GONE]
    least = math.inf
    for count in range(first, int(path["prepared"])):
        row = seg.row[slot(paths, g, count)]
        if row["kind"] == WAIT:
            return count
        least = min(least, least_accel(row, path))
        passed += row["length"]
        if passed >= way + brake_way(speed, 0.0, 0.0, least, jerk):
            return count
    return int(path["prepared"])


@compiled
def frozen_until(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Return the count of the first segment in which path `g` could come to rest with the least acceleration.

    Those before it keep what they were planned with. Two more cycles are put in front of the braking: a corner
    counts in the two cycles around it, so nothing may change in the last two before it.
    """
    path = paths.row[g]
    if (path["state"] == RUNNING or path["state"] == HELD) and follows(seg, paths, g):
        return _frozen_with_jerk(seg, paths, g, dt)
    first, s, speed = _next_plan(seg, paths, g, dt)
    if path["state"] != RUNNING and path["state"] != HELD:
        return first
    margin = 0.0
    if first < path["prepared"]:
        speed += 2.0 * dt * seg.row[slot(paths, g, first)]["full_accel"]
        margin = 2.0 * dt * speed
    square = speed * speed
    for count in range(first, int(path["prepared"])):
        row = seg.row[slot(paths, g, count)]
        if row["kind"] == WAIT:
            return count
        left = row["length"] - s
        s = 0.0
        used = min(margin, left)
        margin -= used
        square -= 2.0 * least_accel(row, path) * (left - used)
        if square <= 0.0 and margin <= 0.0:
            return count
    return int(path["prepared"])


@compiled
def _ready_count(seg: Segments, paths: Paths, g: int) -> int:
    """Return the count up to which segments will not change: a line that may yet be rounded off or grow waits.

    So does a free overlap, and the motion before it, until it is known what follows the one after it.
    """
    path = paths.row[g]
    tail = int(path["tail"])
    if path["limit"] <= tail:  # the path rests there, so nothing joins the last line nor rounds its end
        return int(path["limit"])
    if tail > path["prepared"] and path["tolerance_mm"] > 0.0 and path["closed"] == 0:
        row = seg.row[slot(paths, g, tail - 1)]
        may_be_last = path["last_share"] > 0.0 and row["kind"] != WAIT and not row["flags"] & STOP
        if may_be_rounded(path, row) or may_be_last:
            ready = tail - 2 if is_open(paths, g) else tail - 1
            if path["free_overlaps"] != 0 and seg.row[slot(paths, g, ready - 1)]["kind"] == OVERLAP:
                ready -= 2
            return max(ready, int(path["prepared"]))
    return tail


@compiled
def _plan(seg: Segments, paths: Paths, g: int, dt: float) -> None:
    if has_limited_jerk(paths.row[g]):
        plan_with_jerk(seg, paths, g, dt)
    else:
        plan_path(seg, paths, g)
    path = paths.row[g]
    if path["low_accel_mm_s2"] > 0.0:
        path["planned"] = max(path["head"], min(path["planned"], path["cruising"]))


@compiled
def _ask_for_caps(seg: Segments, paths: Paths, g: int, first: int) -> None:
    """Let a path with limited jerk go for the caps of its segments from count `first` on.

    Those before it keep what was asked for, which may be less than the cap that they were planned with.
    """
    if has_limited_jerk(paths.row[g]):
        for count in range(first, int(paths.row[g]["prepared"])):
            k = slot(paths, g, count)
            seg.geo[k, ASKED] = seg.row[k]["cap"]


def _steps(seg: Segments, paths: Paths, g: int, *_: object) -> int:
    return 3 * int(paths.row["tail"][g] - paths.row["head"][g]) + 1


@compiled
def _keep_planned(seg: Segments, paths: Paths, g: int, begin: int, first_end: int) -> None:
    """Keep what segments have been planned with: caps from count `begin` on, junctions from `first_end` on."""
    for count in range(min(begin, first_end), int(paths.row[g]["prepared"])):
        row = seg.row[slot(paths, g, count)]
        if count >= begin:
            row["planned_cap"] = row["cap"]
        if count >= first_end:
            row["planned_junction"] = row["junction"]


@entry(steps=_steps)
def prepare_path(seg: Segments, paths: Paths, g: int, limits: AxisLimits, dt: float, work: Table) -> None:
    """Take what was appended since the last call into the look-ahead of path `g`. `work` is scratch, [3, n].

    If the last segment before is running, the path goes on through its end, unless that is too close. With a
    path tolerance a line waits for the one after it, or for `closed`.
    """
    path = paths.row[g]
    if path["closed"] != 0:
        close_line(seg, paths, g, limits)
        mark_last(seg, paths, g)
        path["closed"] = 1  # though the line has been appended anew
    head, first = int(path["head"]), int(path["prepared"])
    ready = _ready_count(seg, paths, g)
    overlap_as_known(seg, paths, g, limits, first, ready)
    first_end = max(first - 1, head)
    goes_on = first_end == head and head < first < ready
    if goes_on and frozen_until(seg, paths, g, dt) > head:  # what is new has no limits yet
        goes_on = False
        first_end = first
    path["prepared"] = ready
    begin = first_open(path, first)
    first_end = min(first_end, max(begin - 1, head))
    limit_queue(seg, paths, g, limits, dt, begin, first_end, work)
    limit_cruise(seg, paths, g, begin, first)
    _keep_planned(seg, paths, g, begin, first_end)
    _ask_for_caps(seg, paths, g, begin)
    _plan(seg, paths, g, dt)
    if goes_on:
        plan_again(seg, paths, g, dt)


@compiled
def _asked_cap(seg: Segments, k: int, limits: AxisLimits, path: np.void, most: float) -> float:
    """Return what feed and override make of the cap of a segment, `most` at most; an override of 0 holds it instead."""
    row = seg.row[k]
    if row["flags"] & RAPID:
        cap = overridden_rapid(line_speed(seg, k, limits), path)
    else:
        cap = feed_in_force(row, path)
    return float(min(most, cap) if cap > 0.0 else most)


@entry
def earliest_limit(seg: Segments, paths: Paths, g: int, dt: float) -> int:
    """Return the lowest `limit` that path `g` can still rest before."""
    path = paths.row[g]
    if path["state"] != RUNNING and path["state"] != HELD:
        return int(path["head"])
    return min(frozen_until(seg, paths, g, dt) + 1, int(path["prepared"]))


@entry
def drop_queue(seg: Segments, paths: Paths, g: int) -> None:
    """Forget what path `g`, which is at rest, has still to follow; it stays where it is."""
    path = paths.row[g]
    tag = path["tag"]
    path["tail"] = path["head"]
    path["merged"] = 0
    path["next_events"], path["in_step"] = 0, 0
    for i in range(paths.queued.shape[1]):
        paths.queued[g, i] = paths.position[g, i]
    set_wait(seg, slot(paths, g, path["head"]), paths.queued[g], 0.0, -1, tag, 0)  # where it stands
    path["head"] += 1
    path["tail"] = path["head"]
    path["prepared"] = path["head"]
    path["planned"] = path["head"]
    path["cruising"] = path["head"]
    if path["state"] != IDLE:
        path["state"] = READY
    path["entry_share"] = 0.0
    path["entry_zone"] = 0.0
    path["pending"] = 0
    path["limit"] = NO_LIMIT


@entry(steps=_steps)
def replan_path(seg: Segments, paths: Paths, g: int, limits: AxisLimits, dt: float, work: Table) -> None:
    """Take over a new override, feed hold or its release from where path `g` stands now."""
    path = paths.row[g]
    head, last = int(path["head"]), int(path["prepared"])
    first = frozen_until(seg, paths, g, dt)
    k = slot(paths, g, first)
    keeps = first < last and is_curved(seg, k)
    accel, cap = seg.row[k]["full_accel"], seg.row[k]["cap"]
    with_jerk = has_limited_jerk(path)
    for count in range(head, head if with_jerk else min(first, last)):
        passed = slot(paths, g, count)
        seg.row[passed]["bound"] = max(seg.row[passed]["bound"], seg.row[passed]["out"])
        seg.row[passed]["cap"] = _asked_cap(seg, passed, limits, path, seg.row[passed]["planned_cap"])
    limit_queue(seg, paths, g, limits, dt, first, first, work)
    limit_cruise(seg, paths, g, first, last)
    if with_jerk and first < last:  # it may be entered faster than it will be traversed
        seg.row[k]["cap"] = max(cap, seg.row[k]["cap"])
    if keeps and accel < seg.row[k]["full_accel"]:  # it may be entered, or traversed now, above its new cap
        seg.row[k]["accel"] *= accel / seg.row[k]["full_accel"]
        seg.row[k]["gain"] *= accel / seg.row[k]["full_accel"]
        seg.row[k]["full_accel"] = accel
    for count in range(head, head if with_jerk else min(first, last - 1)):
        row, after = seg.row[slot(paths, g, count)], seg.row[slot(paths, g, count + 1)]
        row["junction"] = min(row["planned_junction"], row["cap"], after["cap"])
    _keep_planned(seg, paths, g, first, first)
    path["planned"] = head
    _plan(seg, paths, g, dt)
    _ask_for_caps(seg, paths, g, first + 1)
    for count in range(head, min(first + 1, last) if with_jerk else head):
        k = slot(paths, g, count)
        seg.geo[k, ASKED] = _asked_cap(seg, k, limits, path, seg.row[k]["cap"])
    plan_again(seg, paths, g, dt)
