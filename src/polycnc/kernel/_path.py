"""A path: its part of the segment ring, where it stands, how lines get into it, how long it takes.

The caller sees to free slots. Units: see `_segments`.

Counts (`head`, `tail`, ...) only grow; the slot of count c is `base + c % capacity`.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._segments import (
    CORNER_STOP,
    LAST,
    RAPID,
    STOP,
    WAIT,
    WITH_SPINDLE,
    Floats,
    Segments,
    set_line,
)
from polycnc.kernel._segments import WAIT_S as GEO_WAIT_S

Ints = npt.NDArray[np.int64]
Rows: TypeAlias = npt.NDArray[np.void]

IDLE = 0  # not started
READY = 1  # started and at rest: the next segment begins with the next cycle
RUNNING = 2  # the segment at `head` is being traversed
HELD = 3  # at rest within a segment, until released

HOLD, HOLD_LATER = 1, 2  # a feed hold: at once; where the motion with the spindle that is under way is over

# What a sample brought.
STILL = 0  # no motion: idle, held or nothing queued
INSIDE = 1  # in motion
RESTED = 2  # the path came to rest: at the end of a segment, or within it on feed hold
EVENT = 3  # an event stands at the point of rest

REST_SLACK = 1e-9  # part of a cycle by which rounding may make a rest late

NO_LIMIT = 1 << 62

EXACT_PATH = -1.0  # a tolerance: corners are stops, and the path goes on where there is none
BLEND_COLUMNS = 17  # see `_blend`
MOST_MERGED = 101  # points that one line takes the place of
CORNERS_AROUND = 18  # numbers, see `_small_arcs`
SCRATCH_POINTS = (
    BLEND_COLUMNS + 3 * MOST_MERGED
)  # column of `blend` from which there is room for three points

# The registers of a running segment, see `_ramps`.
SPEED_IN, SPEED_PEAK, SPEED_OUT, TIME_IN, TIME_CRUISE, TIME_OUT, FROM_S, LENGTH = 0, 1, 2, 3, 4, 5, 6, 7
LEGS_IN = 8  # of each leg its time, and the speed at its far end
LEGS_OUT = 14  # the same, from the segment's end backwards
PIECES = 20  # of each piece its length and its acceleration
REGISTERS = 26
# Where the path is in a segment that is followed (`_follow`), its speed and acceleration.
GONE, SPEED_NOW, RATE = REGISTERS, REGISTERS + 1, REGISTERS + 2
ALL_REGISTERS = 50  # with those of `_follow`

# Columns of `totals`.
RAPID_S, FEED_S, WAIT_S, RAPID_LENGTH, FEED_LENGTH, SEGMENTS, TOP_SPEED = 0, 1, 2, 3, 4, 5, 6
TOTALS = 7

# Columns of `passed`: what an event is, when it was passed, the totals of the path there, whether it came at a point
# of rest to which no time had passed, and how many events came as a motion began, 0 for one at a point of rest.
PASSED_EVENT, PASSED_CYCLE, PASSED_FEED_S, PASSED_RAPID_S, PASSED_AT_ONCE, PASSED_COUNT = 0, 1, 2, 3, 4, 5
PASSED_COLUMNS = 6
MOST_PASSED = 1024
RESTS_PER_CYCLE = 16
"""Points of rest at which no time passes, as functions that are answered at once, that a path leaves in one cycle."""

_LEAST = 1e-9  # a speed of 0 is that of a segment without length, or of one that an override holds

PATH_ROW = np.dtype(
    [
        ("base", np.int64),
        ("capacity", np.int64),
        ("head", np.int64),  # count of the segment that is running or comes next
        ("tail", np.int64),  # count of segments appended
        ("prepared", np.int64),  # segments before this count are in the look-ahead and may run
        ("planned", np.int64),  # segments before this count have their final end speed
        ("cruising", np.int64),  # segments before this count have their final cap, see `_cruise`
        ("limit", np.int64),  # segments from this count on stay out of the look-ahead: the path rests before
        ("low_water", np.int64),  # planned segments at which QUEUE_LOW is raised, negative never
        ("depth", np.int64),  # look-ahead in segments, 0 = unlimited
        ("merged", np.int64),  # points of the last line appended while lines may join it, see `_merge`
        ("blocks", np.int64),  # blocks whose last segment was left since the path began
        ("cycles", np.int64),  # samples taken in the running segment
        ("event", np.int64),  # event last met, -1 none
        ("next_event", np.int64),  # the first of the events that come when the motion appended next begins
        ("next_events", np.int64),  # how many
        ("in_step", np.int64),  # motions queued with events that have not begun
        ("looked_at", np.int64),  # segments before this count have none of them
        ("passes", np.int64),  # events that may be passed are noted in `passed`, while it has room
        ("passed", np.int64),  # so many have been noted
        ("passed_at", np.int64),  # the cycle of the last one, or from which on the path was let go
        ("spare", np.int64),  # so many more are passed in that cycle
        ("override", np.float64),  # factor of the programmed feeds; 0 holds moves at feed
        ("rapid_override", np.float64),  # factor of positioning speeds; 0 holds positioning
        ("rapid_top", np.float64),  # highest path speed of positioning
        ("dry_feed_mm_s", np.float64),  # path speed instead of every programmed feed, 0 = as programmed
        ("jerkrel", np.float64),  # shape of the ramps, see `_ramps`; may change at rest
        # How far the path may leave a corner between lines appended from now on; EXACT_PATH: it rests there.
        ("tolerance_mm", np.float64),
        (
            "merge_mm",
            np.float64,
        ),  # how far the points of lines may lie off the one that they are merged into, 0: none
        ("jerk_mm_s3", np.float64),  # highest jerk along the path, 0 = any; may change at rest
        ("speed_limit_mm_s", np.float64),  # of the path, whatever its axes allow
        ("accel_limit_mm_s2", np.float64),  # of the path, whatever its axes allow
        ("low_accel_mm_s2", np.float64),  # with which speeds between corners are found, 0: with all there is
        ("corner_deviation_mm", np.float64),  # of the corner rules by deviation, see `_corner_rules`
        ("corner_share", np.float64),  # of BY_SHARE
        ("corner_cycle_s", np.float64),  # of BY_SHARE: the control cycle
        (
            "rounding_share",
            np.float64,
        ),  # of the acceleration is left along arcs in corners, 0: what they leave
        ("last_share", np.float64),  # of the acceleration is left on LAST segments, 0: all
        (
            "rounding_gap_s",
            np.float64,
        ),  # what is left of a line beside such an arc belongs to it if it takes less
        ("free_overlaps", np.int8),  # motions that overlap leave tolerance and feed, see `_overlap`
        ("lead", np.float64),  # time into the running segment at sample 0
        (
            "entry_share",
            np.float64,
        ),  # part of its acceleration that the running segment gives up near its start
        ("entry_zone", np.float64),  # up to which path length in it
        ("speed", np.float64),  # path speed now
        ("tag", np.int64),  # tag of the segment that gave the last setpoint
        ("flags", np.int16),  # of that segment
        ("corner_rule", np.int8),  # see `_corner_rules`
        ("state", np.int8),
        ("hold", np.int8),  # feed hold: 0, HOLD or HOLD_LATER
        ("pending", np.int8),  # a change waits for the end of the S-shaped ramp that is under way
        ("closed", np.int8),  # nothing will be appended: the last segment ends the path
    ],
    align=True,
)


class Paths(NamedTuple):
    """G paths, each an ordered set of m coordinates mapped to machine axes."""

    row: npt.NDArray[np.void]  # [G] of PATH_ROW
    ramps: Floats  # [G, ALL_REGISTERS]
    totals: Floats  # [G, TOTALS] of the segments traversed so far
    position: Floats  # [G, m] now
    queued: Floats  # [G, m] end of the last segment appended
    # Scratch of `_blend`, points merged, 3 points of scratch, corners around small arcs: [G, BLEND_COLUMNS +
    # 3 MOST_MERGED + 3m + CORNERS_AROUND].
    blend: Floats
    passed: Floats  # [G, MOST_PASSED, PASSED_COLUMNS] events that were passed, in their order
    axis: Ints  # [G, m] machine axis of each coordinate, -1 none


def make_paths(paths: int, slots: int, coordinates: int) -> Paths:
    """Allocate `paths` idle paths, each with an equal part of `slots` segments."""
    row = np.zeros(paths, PATH_ROW)
    row["capacity"] = slots // paths
    row["base"] = np.arange(paths) * (slots // paths)
    row["override"] = 1.0
    row["rapid_override"] = 1.0
    row["rapid_top"] = np.inf
    row["speed_limit_mm_s"] = np.inf
    row["accel_limit_mm_s2"] = np.inf
    row["event"] = -1
    row["passed_at"] = -1
    row["limit"] = NO_LIMIT
    row["low_water"] = 1024
    return Paths(
        row=row,
        ramps=np.zeros((paths, ALL_REGISTERS)),
        totals=np.zeros((paths, TOTALS)),
        position=np.zeros((paths, coordinates)),
        queued=np.zeros((paths, coordinates)),
        blend=np.zeros((paths, SCRATCH_POINTS + 3 * coordinates + CORNERS_AROUND)),
        passed=np.zeros((paths, MOST_PASSED, PASSED_COLUMNS)),
        axis=np.tile(np.arange(coordinates, dtype=np.int64), (paths, 1)),
    )


def start_path(paths: Paths, g: int) -> None:
    """Let path `g` begin with its queue in the next cycle."""
    if paths.row[g]["state"] == IDLE:
        paths.row[g]["state"] = READY


def free_slots(paths: Paths, g: int) -> int:
    """Return how many segments path `g` still takes."""
    return int(paths.row[g]["capacity"] - (paths.row[g]["tail"] - paths.row[g]["head"]))


@compiled
def is_held(path: np.void, row: np.void) -> bool:
    """Tell whether a path may not follow the segment of this row; an override of 0 leaves waits alone."""
    with_spindle = row["flags"] & WITH_SPINDLE != 0
    if path["hold"] == HOLD or (path["hold"] == HOLD_LATER and not with_spindle):
        return True
    if row["kind"] == WAIT or with_spindle:
        return False
    factor = path["rapid_override"] if row["flags"] & RAPID else path["override"]
    return bool(factor <= 0.0)


@compiled
def slot(paths: Paths, g: int, count: int) -> int:
    """Return the slot of segment `count` of path `g`."""
    return slot_of(paths.row, g, count)


@compiled
def slot_of(path: npt.NDArray[np.void], g: int, count: int) -> int:
    """Return the same from the column `Paths.row` alone."""
    return int(path[g]["base"] + count % path[g]["capacity"])


@compiled
def appended(ends: Floats, path: Rows, queued: Floats, g: int, k: int) -> None:
    """Count slot `k` as the last segment of path `g`."""
    path[g]["closed"] = 0
    path[g]["tail"] += 1
    for i in range(ends.shape[1]):
        queued[g, i] = ends[k, i]


@compiled
def attach(row: Rows, path: Rows, g: int) -> None:
    """Let the events that wait for the next motion of path `g` come with the last segment appended."""
    events = path[g]["next_events"]
    if events > 0:
        k = slot_of(path, g, path[g]["tail"] - 1)
        row[k]["event"], row[k]["events"] = path[g]["next_event"], events
        path[g]["next_events"] = 0
        if path[g]["in_step"] == 0:
            path[g]["looked_at"] = path[g]["tail"] - 1
        path[g]["in_step"] += 1


@compiled
def set_ends(row: Rows, path: Rows, g: int, flags: int) -> None:
    """Let a path come to rest where positioning meets feed motion, and in the corners of an exact path."""
    if path[g]["tolerance_mm"] < 0.0:
        row[slot_of(path, g, path[g]["tail"])]["flags"] |= CORNER_STOP
    end_thread(row, path, g, flags)
    if path[g]["tail"] > path[g]["head"]:
        k = slot_of(path, g, path[g]["tail"] - 1)
        if (row[k]["flags"] ^ flags) & RAPID:
            row[k]["flags"] |= STOP


@compiled
def end_thread(row: Rows, path: Rows, g: int, flags: int) -> None:
    """Let a path rest, in a corner that is not rounded, where a motion with the spindle begins or ends."""
    if path[g]["tail"] > path[g]["head"]:
        k = slot_of(path, g, path[g]["tail"] - 1)
        if (row[k]["flags"] ^ flags) & WITH_SPINDLE:
            row[k]["flags"] |= STOP


@compiled
def mark_last(seg: Segments, paths: Paths, g: int) -> None:
    """Mark the last segment appended as the end of a path with rounded corners, if nothing has planned it."""
    path = paths.row[g]
    if path["tolerance_mm"] > 0.0 and path["tail"] > path["prepared"]:
        row = seg.row[slot(paths, g, path["tail"] - 1)]
        if row["kind"] != WAIT and not row["flags"] & (STOP | CORNER_STOP):
            row["flags"] |= LAST


@compiled
def add_line(
    row: Rows,
    starts: Floats,
    ends: Floats,
    path: Rows,
    queued: Floats,
    g: int,
    feed_axis: npt.NDArray[np.uint8],
    end: Floats,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> bool:
    """Append a straight line to path `g`, corners as they are, from single columns; False if it has no length."""
    k = slot_of(path, g, path[g]["tail"])
    if not set_line(row, starts, ends, k, feed_axis, queued[g], end, speed_mm_s, flags, tag):
        return False
    set_ends(row, path, g, flags)
    appended(ends, path, queued, g, k)
    attach(row, path, g)
    return True


@compiled
def ramps_duration(ramps: Floats) -> float:
    """Return the time of the planned stretch in s."""
    return float(ramps[TIME_IN] + ramps[TIME_CRUISE] + ramps[TIME_OUT])


def _steps(seg: Segments, paths: Paths, g: int, *_: object) -> int:
    return int(paths.row["prepared"][g] - paths.row["head"][g]) + 1


@entry(steps=_steps)
def planned_s(seg: Segments, paths: Paths, g: int, dt: float) -> float:
    """Return how long path `g` takes to the end of what is planned (s), without a hold.

    Ramps have their mean acceleration: with limited jerk, and beside corners, a motion takes a little longer.
    """
    path, ramps = paths.row[g], paths.ramps[g]
    under_way = path["state"] == RUNNING or path["state"] == HELD
    total, speed = 0.0, 0.0
    for count in range(path["head"], path["prepared"]):
        k = slot(paths, g, count)
        row = seg.row[k]
        first = under_way and count == path["head"]
        if row["kind"] == WAIT or (first and path["jerk_mm_s3"] <= 0.0):
            if first:
                total += max(0.0, ramps_duration(ramps) - path["lead"] - path["cycles"] * dt)
            else:
                total += seg.geo[k, GEO_WAIT_S]
            speed = row["out"]
            continue
        length = row["length"]
        if first:
            length, speed = length - ramps[GONE], path["speed"]
        out, accel = row["out"], max(row["accel"], _LEAST)
        square = min(row["cap"] * row["cap"], 0.5 * (speed * speed + out * out) + accel * length)
        top = math.sqrt(max(square, _LEAST))
        in_ramps = max(2.0 * top * top - speed * speed - out * out, 0.0) / (2.0 * accel)
        total += max(2.0 * top - speed - out, 0.0) / accel + max(length - in_ramps, 0.0) / top
        speed = out
    return total
