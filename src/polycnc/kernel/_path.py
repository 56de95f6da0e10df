"""A path: its part of the segment ring, and where it stands.

Counts (`head`, `tail`, ...) only grow; the slot of count c is `base + c % capacity`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._ramps import ALL_REGISTERS
from polycnc.kernel._segments import RAPID, WAIT, WITH_SPINDLE, Floats

Ints = npt.NDArray[np.int64]

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
SCRATCH_POINTS = (
    BLEND_COLUMNS + 3 * MOST_MERGED
)  # column of `blend` from which there is room for three points

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
    blend: Floats  # [G, BLEND_COLUMNS + 3 MOST_MERGED + 3m] scratch of `_blend`, points merged, 3 points of scratch
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
        blend=np.zeros((paths, SCRATCH_POINTS + 3 * coordinates)),
        passed=np.zeros((paths, MOST_PASSED, PASSED_COLUMNS)),
        axis=np.tile(np.arange(coordinates, dtype=np.int64), (paths, 1)),
    )


def start_path(paths: Paths, g: int) -> None:
    """Let path `g` begin with its queue in the next cycle."""
    if paths.row[g]["state"] == IDLE:
        paths.row[g]["state"] = READY


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


@entry
def free_slots(paths: Paths, g: int) -> int:
    """Return how many segments path `g` still takes."""
    return int(paths.row[g]["capacity"] - (paths.row[g]["tail"] - paths.row[g]["head"]))
