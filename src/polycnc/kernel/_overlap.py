"""Let a motion begin while the one before it ends, where a corner may be left but no arc rounds it.

With BY_SHARE that is the corner beside a helix, or beside an arc that lies in another plane: as LinuxCNC does it, the
motion into the corner slows down to rest with half of its acceleration, and the one out of it speeds up with half of
its own so early that they pass the corner within the tolerance. An axis has what one leaves for the other, and both
keep to their half all along. The piece in which both move is an OVERLAP (`_cubic`).

Units: those of `_segments`.
"""

from __future__ import annotations

import math

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend_arcs import may_be_rounded
from polycnc.kernel._blend_speed import CUT, CUT_LINE
from polycnc.kernel._corner_rules import BY_SHARE, step_share
from polycnc.kernel._cubic import FIRST, SECOND
from polycnc.kernel._geometry import segment_point, segment_tangent
from polycnc.kernel._jit import compiled
from polycnc.kernel._limits import CENTRIPETAL_SHARE, OVERLAP_SHARE, segment_limits
from polycnc.kernel._path import SCRATCH_POINTS, Paths, slot
from polycnc.kernel._segments import (
    ARC,
    CENTER_P,
    CENTER_Q,
    LINE,
    OVERLAP,
    OVERLAPS,
    RADIUS_END,
    RADIUS_START,
    RAPID,
    SWEEP_RAD,
    Floats,
    Segments,
    set_common,
)

SHARPEST = math.radians(178.0)  # a sharper corner is a stop
SHORTEST_MM = 1e-6
LEAST_ASIDE = 1e-3  # sine of half the turn; smaller ones leave the speed free


@compiled
def overlap_corner(seg: Segments, paths: Paths, g: int, limits: AxisLimits) -> None:
    """Let the last two segments of path `g` overlap if their corner may be left and is no corner for an arc.

    Takes a slot more.
    """
    path = paths.row[g]
    if path["corner_rule"] != BY_SHARE or path["tolerance_mm"] <= 0.0 or path["tail"] - 2 < path["prepared"]:
        return
    k, following = slot(paths, g, path["tail"] - 2), slot(paths, g, path["tail"] - 1)
    row, after = seg.row[k], seg.row[following]
    if not may_be_rounded(path, row) or (row["flags"] | after["flags"]) & RAPID:
        return
    if (row["kind"] != ARC and after["kind"] != ARC) or _lie_in_a_plane(seg, k, following):
        return
    p, q, r = _three_axes(seg, k, following, limits)
    if p < 0:
        return
    flags = row["flags"]
    taken = 0.0  # by an overlap at its start; that of an arc is gone
    if flags & OVERLAPS and paths.blend[g, CUT_LINE] == path["tail"] - 2:
        taken = paths.blend[g, CUT]
    row["flags"] |= OVERLAPS
    after["flags"] |= OVERLAPS
    cut, speed = _size(seg, paths, g, k, following, limits, taken)
    if cut < SHORTEST_MM:
        row["flags"] = flags
        after["flags"] &= ~OVERLAPS
        return
    _insert(seg, paths, g, (p, q, r), cut, speed)


@compiled
def _lie_in_a_plane(seg: Segments, k: int, following: int) -> bool:
    """Tell whether no axis moves on either segment but the two of an arc; such corners have arcs or are stops."""
    arc = k if seg.row[k]["kind"] == ARC else following
    p, q = seg.plane[arc, 0], seg.plane[arc, 1]
    for i in range(seg.start.shape[1]):
        moves = seg.start[k, i] != seg.end[k, i] or seg.start[following, i] != seg.end[following, i]
        if moves and i != p and i != q:
            return False
    other = seg.row[following]["kind"] == ARC and (
        seg.plane[following, 0] != p or seg.plane[following, 1] != q
    )
    return not other


@compiled
def _three_axes(seg: Segments, k: int, following: int, limits: AxisLimits) -> tuple[int, int, int]:
    """Return the first three axes that count; -1 where another moves on either segment, or there are fewer."""
    found, p, q, r = 0, -1, -1, -1
    for i in range(seg.start.shape[1]):
        if limits.feed_axis[i] != 0 and found < 3:
            p, q, r = (i, q, r) if found == 0 else (p, i, r) if found == 1 else (p, q, i)
            found += 1
        elif seg.start[k, i] != seg.end[k, i] or seg.start[following, i] != seg.end[following, i]:
            return -1, -1, -1
    return (p, q, r) if found == 3 else (-1, -1, -1)


@compiled
def _size(
    seg: Segments, paths: Paths, g: int, k: int, following: int, limits: AxisLimits, taken: float
) -> tuple[float, float]:
    """Return how much of both segments the overlap takes, and the speed at its ends; 0 where there is none.

    The motion that ends has its speed with the deviation that is allowed left to go. What takes the place of both has
    one speed at both its ends, and takes the time that both would.
    """
    path, work = paths.row[g], paths.blend[g]
    n = seg.start.shape[1]
    tangents = work[SCRATCH_POINTS : SCRATCH_POINTS + 2 * n].reshape(2, n)
    row, after = seg.row[k], seg.row[following]
    cap, accel = segment_limits(seg, k, limits, path, tangents[0], tangents[1])
    cap_after, accel_after = segment_limits(seg, following, limits, path, tangents[0], tangents[1])
    _pull(seg, k, limits, 1.0, tangents[0])
    _pull(seg, following, limits, 0.0, tangents[1])
    pull = _dot(tangents, limits)
    segment_tangent(seg, k, 1.0, tangents[0])
    segment_tangent(seg, following, 0.0, tangents[1])
    dot = _dot(tangents, limits)
    if dot < math.cos(SHARPEST):
        return 0.0, 0.0
    beside = math.sqrt(max(0.0, 0.5 * (1.0 - dot)))  # sine of half the turn
    length = row["length"] + taken
    fast = min(cap, math.sqrt(accel * length))
    fast_after = min(cap_after, math.sqrt(accel_after * after["length"]))
    time = min(length / fast, after["length"] / fast_after, max(fast / accel, fast_after / accel_after))
    leaving, entering = min(fast, time * accel), min(fast_after, time * accel_after)
    most = min(0.5 * length, 0.5 * after["length"], row["length"] - SHORTEST_MM)
    tolerance = path["tolerance_mm"]
    if beside > 0.0 and tolerance < math.inf:
        straight = 2.0 * tolerance / beside
        bend = min(most, straight) * max(_curvature(seg, k), _curvature(seg, following))
        most = min(most, straight / (1.0 + bend * bend / 6.0))
    aside = math.sqrt(max(0.0, 0.5 * (1.0 - pull)))
    if aside > LEAST_ASIDE and tolerance < math.inf:
        slow = 2.0 * math.sqrt(accel * tolerance / aside)
        leaving, entering = min(leaving, slow), min(entering, slow)
    share = step_share(
        limits, tangents, min(cap, cap_after), accel_after / OVERLAP_SHARE, path["corner_cycle_s"]
    )
    if path["rounding_share"] > 0.0:
        share /= path["rounding_share"]
    net = 0.5 * math.sqrt(max(0.0, 0.5 * (1.0 + pull))) * (leaving + entering)
    if share <= path["corner_share"] or min(cap, cap_after) * path["corner_share"] / share >= net:
        return 0.0, 0.0
    mean = 2.0 / (1.0 / accel + 1.0 / accel_after)
    speed = min(leaving * mean / accel, cap, cap_after, math.sqrt(2.0 * mean * max(most, 0.0)))
    return 0.5 * speed * speed / mean, speed


@compiled
def _curvature(seg: Segments, k: int) -> float:
    """Return the greatest curvature of the line or arc `k`."""
    geo = seg.geo[k]
    return 1.0 / min(geo[RADIUS_START], geo[RADIUS_END]) if seg.row[k]["kind"] == ARC else 0.0


@compiled
def _dot(vectors: Floats, limits: AxisLimits) -> float:
    """Return the product of two directions in the axes that count."""
    product = 0.0
    for i in range(vectors.shape[1]):
        if limits.feed_axis[i] != 0:
            product += vectors[0, i] * vectors[1, i]
    return product


@compiled
def _pull(seg: Segments, k: int, limits: AxisLimits, at: float, out: Floats) -> None:
    """Write where segment `k` accelerates to at its start or its end to `out[n]`, as LinuxCNC takes it.

    Along a line; along an arc in its plane, and at its start also to its centre, as at half of its feed.
    """
    segment_tangent(seg, k, at, out)
    if seg.row[k]["kind"] != ARC:
        return
    p, q = seg.plane[k, 0], seg.plane[k, 1]
    along_p, along_q = out[p], out[q]
    size = math.sqrt(along_p * along_p + along_q * along_q)
    for i in range(out.shape[0]):
        out[i] = 0.0
    out[p], out[q] = along_p / size, along_q / size
    if at > 0.0:
        return
    in_p, in_q = seg.geo[k, CENTER_P] - seg.start[k, p], seg.geo[k, CENTER_Q] - seg.start[k, q]
    radius, accel = math.sqrt(in_p * in_p + in_q * in_q), min(limits.acceleration[p], limits.acceleration[q])
    square = min(seg.row[k]["feed_mm_s"] ** 2, CENTRIPETAL_SHARE * accel * radius)
    part = 0.25 * square / (OVERLAP_SHARE * accel * radius * radius)
    out[p], out[q] = out[p] + part * in_p, out[q] + part * in_q
    size = math.sqrt(out[p] * out[p] + out[q] * out[q])
    out[p], out[q] = out[p] / size, out[q] / size


@compiled
def _insert(
    seg: Segments, paths: Paths, g: int, axes: tuple[int, int, int], cut: float, speed: float
) -> None:
    """Shorten the last two segments of path `g` by `cut` at their corner and put an OVERLAP between them."""
    path, work = paths.row[g], paths.blend[g]
    k, between = slot(paths, g, path["tail"] - 2), slot(paths, g, path["tail"] - 1)
    following = slot(paths, g, path["tail"])
    n = seg.start.shape[1]
    point = work[SCRATCH_POINTS : SCRATCH_POINTS + n]
    _copy(seg, between, following)
    _shorten(seg, k, cut, False, point)
    _shorten(seg, following, cut, True, point)
    tag = int(seg.row[following]["tag"])
    set_common(seg, between, seg.end[k], seg.start[following], speed, OVERLAPS, tag)
    seg.row[between]["kind"] = OVERLAP
    seg.row[between]["length"] = 2.0 * cut
    geo = seg.geo[between]
    segment_tangent(seg, k, 1.0, point)
    for j in range(3):
        seg.plane[between, j] = axes[j]
        geo[FIRST + j] = 2.0 / 3.0 * cut * point[axes[j]]
    segment_tangent(seg, following, 0.0, point)
    for j in range(3):
        i = axes[j]
        geo[SECOND + j] = seg.end[between, i] - seg.start[between, i] - 2.0 / 3.0 * cut * point[i]
    path["tail"] += 1
    work[CUT], work[CUT_LINE] = cut, path["tail"] - 1


@compiled
def _copy(seg: Segments, k: int, to: int) -> None:
    """Copy segment `k` to another slot."""
    row, copy = seg.row[k], seg.row[to]
    set_common(seg, to, seg.start[k], seg.end[k], row["feed_mm_s"], int(row["flags"]), int(row["tag"]))
    copy["event"], copy["events"] = row["event"], row["events"]
    copy["kind"], copy["length"], copy["end_speed"] = row["kind"], row["length"], row["end_speed"]
    for j in range(3):
        seg.plane[to, j] = seg.plane[k, j]
    for j in range(SWEEP_RAD + 1):
        seg.geo[to, j] = seg.geo[k, j]


@compiled
def _shorten(seg: Segments, k: int, cut: float, at_start: bool, point: Floats) -> None:
    """Take `cut` off the start or the end of the line or arc `k`; `point` is scratch."""
    row, geo = seg.row[k], seg.geo[k]
    length = row["length"]
    segment_point(seg, k, cut if at_start else length - cut, point)
    for i in range(point.shape[0]):
        if at_start:
            seg.start[k, i] = point[i]
        else:
            seg.end[k, i] = point[i]
    row["length"] = length - cut
    if row["kind"] == LINE:
        return
    growth = (geo[RADIUS_END] - geo[RADIUS_START]) * cut / length
    if at_start:
        geo[RADIUS_START] += growth
    else:
        geo[RADIUS_END] -= growth
    geo[SWEEP_RAD] *= 1.0 - cut / length
