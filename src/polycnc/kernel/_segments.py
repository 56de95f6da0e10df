"""The channel queue: a ring of path segments in columns, and what a segment is made of.

A slot holds one segment of any kind; the columns are shared by all paths, path `g` owning a run of slots (see
`_path`). Speeds are along the path; the path length counts the feed axes of a segment only, the others ride along.

Units: lengths in mm (deg where only rotary axes move), speeds per s, accelerations per s2, times in s; the sweep of an
arc in rad, that of a circle in three axes in deg, which whole turns leave exact.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._bezier import BEZIER_SIZE
from polycnc.kernel._circle3d import circle3d_point, circle3d_setup
from polycnc.kernel._jit import allocating, compiled

LINE = 0
ARC = 1  # circle in two axes; every other axis moves linearly with the angle (helix)
CIRCLE3D = 2
SPLINE = 3  # curve in two axes; no other axis moves
WAIT = 4  # no motion: a dwell, or an event at a point of the path
OVERLAP = 5  # a motion that begins while the one before it ends, see `_overlap`

RAPID = 1  # flag: positioning at the axes' speed
STOP = 2  # flag: come to rest at the end (exact stop)
CORNER_STOP = 8  # flag: come to rest at the end unless the next segment goes on in the same direction
LAST = 16  # flag: rounded corners lie before it and the path rests at its end, with nothing after
ROUNDING = 32  # flag: an arc that rounds a corner
OVERLAPS = 64  # flag: at an end of it is an OVERLAP
WITH_SPINDLE = 128  # flag: follows the spindle, so no override and no HOLD_LATER acts
TURN = 4  # flag, set here: no feed axis moves, so length and speed are those of the axes that ride along

GEO = BEZIER_SIZE
GEO_WITH_JERK = GEO + 13
# Geometry of an ARC; RISE is how far it goes out of its plane, before an OVERLAP takes some of it.
CENTER_P, CENTER_Q, RADIUS_START, RADIUS_END, SWEEP_RAD, RISE = 0, 1, 2, 3, 4, 5
# Geometry of a CIRCLE3D is laid out in `_circle3d`; the row has room for one more point after it.
CIRCLE3D_RADIUS, CIRCLE3D_LENGTH = 10, 11
WORK_POINT = 13
# How a segment and its end are traversed with limited jerk, see `_jerk_plan`.
LIMIT, ASKED, REDUCED, ZONE_IN, ZONE_OUT, EASE = 16, 17, 18, 19, 20, 21
NODE_WAY, NODE_SPEED, NODE_ACCEL, NODE_FLOOR, NODE_COUNT, SHARE_IN, REACHED = 22, 23, 24, 25, 26, 27, 28
# Geometry of a SPLINE is laid out in `_bezier`, that of an OVERLAP in `_cubic`. Geometry of a WAIT.
WAIT_S, WAIT_EVENT, WAIT_PASSES = 0, 1, 2

TINY = 1e-12

Floats = npt.NDArray[np.float64]
Table = Annotated[Floats, 2]  # entries say how many dimensions an array has that is no row


SEGMENT_ROW = np.dtype(
    [
        ("length", np.float64),
        ("feed_mm_s", np.float64),  # programmed path speed, inf for rapids
        ("end_speed", np.float64),  # prescribed speed at the end, or negative: the look-ahead decides
        ("cap", np.float64),  # highest path speed that feed and axes allow
        ("full_accel", np.float64),  # path acceleration that the axes allow
        ("accel", np.float64),  # mean acceleration of its ramps
        ("junction", np.float64),  # highest speed through the end
        # `cap` and `junction` that its corners were planned with: an override that comes too late to plan them anew
        # lowers both, until a higher one comes.
        ("planned_cap", np.float64),
        ("planned_junction", np.float64),
        ("yield_before", np.float64),  # part of `accel` given up near its end, per speed through it
        ("yield_after", np.float64),  # the same of the following segment near its start
        # What its two ends keep for the rule of the path: with BY_SHARE the parts of `full_accel` that the corners
        # take all along, in `_cruise` the squared speeds that its start can have, coming from before.
        ("kept_in", np.float64),
        ("kept_out", np.float64),
        ("gain", np.float64),  # by how much its ramps can change the squared speed, at the least
        ("out", np.float64),  # planned speed at the end
        ("bound", np.float64),  # earlier planned speed there, if too close to reach a lower one
        ("tag", np.int64),  # the caller's name for the segment: what block it belongs to
        ("event", np.int64),  # the first of the events that come when it begins
        ("events", np.int32),  # how many
        ("kind", np.int8),
        ("flags", np.int16),
    ],
    align=True,
)


class Segments(NamedTuple):
    """S slots for segments of n axes: a row of numbers each, and the geometry in columns.

    Few arrays, because every array that a compiled function takes costs compile time.
    """

    row: npt.NDArray[np.void]  # [S] of SEGMENT_ROW
    start: Floats  # [S, n]
    end: Floats  # [S, n]
    plane: npt.NDArray[np.int8]  # [S, 3] axes of an ARC or a SPLINE (first two), or of a CIRCLE3D or OVERLAP
    geo: Floats  # [S, GEO], or [S, GEO_WITH_JERK] where paths may have limited jerk


def make_segments(slots: int, axes: int, *, limited_jerk: bool = False) -> Segments:
    """Allocate `slots` empty segments of `axes` axes; without `limited_jerk` no path of theirs may have any."""
    return Segments(
        row=np.zeros(slots, SEGMENT_ROW),
        start=np.zeros((slots, axes)),
        end=np.zeros((slots, axes)),
        plane=np.zeros((slots, 3), np.int8),
        geo=np.zeros((slots, GEO_WITH_JERK if limited_jerk else GEO)),
    )


@compiled
def set_common(
    seg: Segments, k: int, start: Floats, end: Floats, speed_mm_s: float, flags: int, tag: int
) -> None:
    """Fill what every kind of segment has."""
    _set_common(seg.row, seg.start, seg.end, k, start, end, speed_mm_s, flags, tag)


@compiled
def _set_common(
    row: npt.NDArray[np.void],
    starts: Floats,
    ends: Floats,
    k: int,
    start: Floats,
    end: Floats,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> None:
    for i in range(start.shape[0]):
        starts[k, i] = start[i]
        ends[k, i] = end[i]
    row[k]["feed_mm_s"] = speed_mm_s
    row[k]["flags"] = flags
    row[k]["tag"] = tag
    row[k]["events"] = 0
    row[k]["end_speed"] = -1.0
    row[k]["kept_in"] = 0.0
    row[k]["kept_out"] = 0.0


@compiled
def set_line(
    row: npt.NDArray[np.void],
    starts: Floats,
    ends: Floats,
    k: int,
    feed_axis: npt.NDArray[np.uint8],
    start: Floats,
    end: Floats,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> bool:
    """Fill slot `k` of the columns with a straight line; False if it has no length.

    It takes single columns because a compiled call costs by the arrays it hands over, and lines are many.
    """
    counted = 0.0
    riding = 0.0
    for i in range(start.shape[0]):
        d = end[i] - start[i]
        if feed_axis[i] != 0:
            counted += d * d
        else:
            riding += d * d
    length = math.sqrt(counted)
    if length < TINY:  # only axes that otherwise ride along: the feed is theirs
        length = math.sqrt(riding)
        flags |= TURN
    if length < TINY:
        return False
    _set_common(row, starts, ends, k, start, end, speed_mm_s, flags, tag)
    row[k]["kind"] = LINE
    row[k]["length"] = length
    return True


@compiled
def set_arc(
    seg: Segments,
    k: int,
    feed_axis: npt.NDArray[np.uint8],
    start: Floats,
    end: Floats,
    axis_p: int,
    axis_q: int,
    center_p: float,
    center_q: float,
    sweep_rad: float,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> bool:
    """Fill slot `k` with an arc about (center_p, center_q) through `sweep_rad`, positive from axis p to axis q.

    The radius goes linearly from the start's to the end's, so a rounded end point is met exactly.
    """
    dp, dq = start[axis_p] - center_p, start[axis_q] - center_q
    radius_start = math.sqrt(dp * dp + dq * dq)
    ep, eq = end[axis_p] - center_p, end[axis_q] - center_q
    radius_end = math.sqrt(ep * ep + eq * eq)
    in_plane = abs(sweep_rad) * 0.5 * (radius_start + radius_end)
    if in_plane < TINY or radius_start < TINY or radius_end < TINY:
        return False
    rise = 0.0
    for i in range(start.shape[0]):
        if i != axis_p and i != axis_q and feed_axis[i] != 0:
            d = end[i] - start[i]
            rise += d * d
    set_common(seg, k, start, end, speed_mm_s, flags, tag)
    seg.row[k]["kind"] = ARC
    seg.plane[k, 0] = axis_p
    seg.plane[k, 1] = axis_q
    seg.row[k]["length"] = math.sqrt(in_plane * in_plane + rise)
    seg.geo[k, CENTER_P] = center_p
    seg.geo[k, CENTER_Q] = center_q
    seg.geo[k, RADIUS_START] = radius_start
    seg.geo[k, RADIUS_END] = radius_end
    seg.geo[k, SWEEP_RAD] = sweep_rad
    seg.geo[k, RISE] = math.sqrt(rise)
    return True


@allocating
def set_circle3d(
    seg: Segments,
    k: int,
    start: Floats,
    axis_p: int,
    axis_q: int,
    axis_r: int,
    center: Floats,
    normal: Floats,
    sweep_deg: float,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> bool:
    """Fill slot `k` with a circle in three axes through `start` about `center`, by the right hand about `normal`.

    `sweep_deg` may be several turns; axes besides the three stay. False if there is no such circle.
    """
    three = np.empty(3)
    three[0], three[1], three[2] = start[axis_p], start[axis_q], start[axis_r]
    geo = seg.geo[k]
    if circle3d_setup(three, center, normal, sweep_deg, geo) != 0 or geo[CIRCLE3D_LENGTH] < TINY:
        return False
    end = start.copy()
    circle3d_point(geo, 1.0, three)
    end[axis_p], end[axis_q], end[axis_r] = three[0], three[1], three[2]
    set_common(seg, k, start, end, speed_mm_s, flags, tag)
    seg.row[k]["kind"] = CIRCLE3D
    seg.plane[k, 0], seg.plane[k, 1], seg.plane[k, 2] = axis_p, axis_q, axis_r
    seg.row[k]["length"] = geo[CIRCLE3D_LENGTH]
    return True


@compiled
def set_spline(
    seg: Segments,
    k: int,
    start: Floats,
    end: Floats,
    axis_p: int,
    axis_q: int,
    span: Floats,
    length_mm: float,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> None:
    """Fill slot `k` with a span of a Bezier curve (see `_bezier`), by the row that `cut_bezier` wrote for it."""
    set_common(seg, k, start, end, speed_mm_s, flags, tag)
    seg.row[k]["kind"] = SPLINE
    seg.row[k]["length"] = length_mm
    seg.plane[k, 0], seg.plane[k, 1] = axis_p, axis_q
    for j in range(BEZIER_SIZE):
        seg.geo[k, j] = span[j]


@compiled
def set_wait(seg: Segments, k: int, at: Floats, duration_s: float, event: int, tag: int, passes: int) -> None:
    """Fill slot `k` with a wait at rest; `event` >= 0 is reported when the path gets there, later if it `passes`."""
    set_common(seg, k, at, at, 0.0, STOP, tag)
    seg.row[k]["kind"] = WAIT
    seg.row[k]["length"] = 0.0
    seg.geo[k, WAIT_S] = max(duration_s, 0.0)
    seg.geo[k, WAIT_EVENT] = event
    seg.geo[k, WAIT_PASSES] = passes
