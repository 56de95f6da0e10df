"""Let a motion begin while the one before it ends, where a corner may be left but no arc rounds it.

With BY_SHARE that is the corner beside a helix, or beside an arc that no other one touches: as LinuxCNC does it, the
motion into the corner slows down to rest with half of its acceleration, and the one out of it speeds up with half of
its own so early that they pass the corner within the tolerance, which `free_overlaps` lets them leave. An axis has what
one leaves for the other, and both keep to their half all along. The piece in which both move is an OVERLAP (`_cubic`).

Units: those of `_segments`.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend_arcs import may_be_rounded
from polycnc.kernel._blend_speed import CUT, CUT_LINE
from polycnc.kernel._corner_rules import BY_SHARE, step_share
from polycnc.kernel._cubic import ENTRY, FIRST, SECOND
from polycnc.kernel._curve_limits import (
    CENTRIPETAL_SHARE,
    LAST_ARC_SHARE,
    OVERLAP_BEND_SHARE,
    OVERLAP_SHARE,
    axes_allow,
    axis_use,
)
from polycnc.kernel._geometry import segment_point, segment_tangent
from polycnc.kernel._jit import apart, compiled
from polycnc.kernel._limits import SHARPEST, feed_in_force, segment_limits
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
    RISE,
    SWEEP_RAD,
    Floats,
    Segments,
    set_common,
)

SHORTEST_MM = 1e-6
MOST_TRIES = 16
LEAST_ASIDE = 1e-3  # sine of half the turn; smaller ones leave the speed free


@apart
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
    if row["kind"] != ARC and after["kind"] != ARC:
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
    time, leaving, entering, cut_after = _size(seg, paths, g, k, following, limits, taken)
    if time * min(leaving, entering) < 2.0 * SHORTEST_MM:
        row["flags"] = flags
        after["flags"] &= ~OVERLAPS
        return
    _insert(seg, paths, g, (p, q, r), time, (leaving, entering), cut_after)


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
) -> tuple[float, float, float, float]:
    """Return how long two motions overlap, the speeds with which one begins to end and the other has begun, its way.

    All 0 where they do not. The one that ends has its speed with the deviation that is allowed left to go, and the
    other reaches its own by the end, with its acceleration at most.
    """
    path, work = paths.row[g], paths.blend[g]
    n = seg.start.shape[1]
    tangents = work[SCRATCH_POINTS : SCRATCH_POINTS + 2 * n].reshape(2, n)
    row, after = seg.row[k], seg.row[following]
    if _is_passed(seg, k, following, limits, path, tangents):
        return 0.0, 0.0, 0.0, 0.0
    cap, accel = segment_limits(seg, k, limits, path, tangents[0], tangents[1])
    cap_after, accel_after = segment_limits(seg, following, limits, path, tangents[0], tangents[1])
    length, length_after = row["length"] + taken, after["length"]
    aside = _pulled_aside(seg, k, following, limits, tangents)
    leaving, _ = _blend_speeds(
        (cap, accel, length), (cap_after, accel_after, length_after), aside, path["tolerance_mm"], 1.0
    )
    if path["free_overlaps"] != 0:
        return _by_ramps(row, length, after, (accel, accel_after), leaving, cap_after)
    segment_tangent(seg, k, 1.0, tangents[0])
    segment_tangent(seg, following, 0.0, tangents[1])
    time = leaving / accel
    if accel_after * time > cap_after and _axes_can(
        tangents, limits, leaving * accel_after / cap_after, accel_after
    ):
        time = (
            cap_after / accel_after
        )  # the next has its speed before the other is over, which ends sooner instead
    rate, rate_after = _rates(tangents, limits, leaving / time, min(accel_after, cap_after / time))
    if max(rate * time / cap, rate_after * time / cap_after) > 1.0:
        rate = rate_after = 2.0 / (1.0 / rate + 1.0 / rate_after)
        time = min(time, cap / rate, cap_after / rate)
    off = _nearer(seg, k, following, limits, tangents, path["tolerance_mm"], (rate, rate_after, time))
    if off < 1.0:
        time, rate, rate_after = _as_quick(tangents, limits, rate, rate_after, time, off)
    room = min(0.5 * length, row["length"] - SHORTEST_MM) / (0.5 * rate)
    room = min(room, length_after / rate_after)
    time = min(time, math.sqrt(max(0.0, room)))
    return time, rate * time, rate_after * time, 0.5 * time * (rate_after * time)


@compiled
def _by_ramps(
    row: np.void,
    length: float,
    after: np.void,
    accel: tuple[float, float],
    leaving: float,
    cap_after: float,
) -> tuple[float, float, float, float]:
    """Return the same where the next motion begins with the ramp of the one before it, and goes as its own lets it."""
    time = leaving / accel[0]
    cut_after = _gone(time, accel[1], cap_after)
    room = min(0.5 * length, row["length"] - SHORTEST_MM) / (0.5 * leaving * time)
    room = min(room, (after["length"] - SHORTEST_MM) / cut_after)
    if room < 1.0:
        time *= math.sqrt(max(0.0, room))
        cut_after = _gone(time, accel[1], cap_after)
    return time, accel[0] * time, min(cap_after, accel[1] * time), cut_after


@compiled
def _gone(time_s: float, accel_mm_s2: float, speed_mm_s: float) -> float:
    """Return how far a motion goes from rest in a time, with an acceleration and up to a speed."""
    reached = min(speed_mm_s, accel_mm_s2 * time_s)
    return reached * (time_s - 0.5 * reached / accel_mm_s2)


@compiled
def _nearer(
    seg: Segments,
    k: int,
    following: int,
    limits: AxisLimits,
    tangents: Floats,
    tolerance_mm: float,
    course: tuple[float, float, float],
) -> float:
    """Return by how much a corner has to be passed nearer to keep its tolerance, 1 at most; `course`: rates, time."""
    beside = math.sqrt(max(0.0, 0.5 * (1.0 - _dot(tangents, limits))))  # sine of half the turn
    if beside <= 0.0 or tolerance_mm == math.inf:
        return 1.0
    rate, rate_after, time = course
    cut, cut_after = 0.5 * rate * time * time, 0.5 * rate_after * time * time
    # Where both have gone as far from the corner, and what they bend.
    both = cut * cut_after / (math.sqrt(cut) + math.sqrt(cut_after)) ** 2
    off = min(1.0, tolerance_mm / (2.0 * both * beside))
    bend = off * max(cut * _curvature(seg, k), cut_after * _curvature(seg, following))
    return float(off / (1.0 + bend * bend / 6.0))


@compiled
def _as_quick(
    tangents: Floats, limits: AxisLimits, rate: float, rate_after: float, time: float, off: float
) -> tuple[float, float, float]:
    """Return in which time and with which rates a corner is passed nearer by `off`.

    With so much more of both rates, or of one, that nothing is lost of the time that the corner saves, if every axis
    can, else with as much as they can.
    """
    nearer = 0.5 * (math.sqrt(1.0 + 8.0 * off) - 1.0)
    more = off / (nearer * nearer)
    if not _axes_can(tangents, limits, more * rate, more * rate_after):
        alone = _more_alone(rate, rate_after, off)
        if _axes_can(tangents, limits, alone * rate, rate_after):
            return time / alone, alone * rate, rate_after
        alone = _more_alone(rate_after, rate, off)
        if _axes_can(tangents, limits, rate, alone * rate_after):
            return time / alone, rate, alone * rate_after
        for _ in range(MOST_TRIES):
            more = max(1.0, more - 0.1)
            if _axes_can(tangents, limits, more * rate, more * rate_after):
                break
        else:
            more = 1.0
    return time * math.sqrt(off / more), more * rate, more * rate_after


@compiled
def _more_alone(rate: float, other: float, off: float) -> float:
    """Return by how much a rate grows, and the time shrinks, where the corner is passed nearer by `off`."""
    root, root_other = math.sqrt(rate), math.sqrt(other)
    way = (root + root_other) / math.sqrt(off)
    grown = 2.0 * way / (root_other + math.sqrt(other + 4.0 * root * way))
    return grown * grown


@compiled
def _blend_speeds(
    before: tuple[float, float, float],
    after: tuple[float, float, float],
    aside: float,
    tolerance_mm: float,
    known: float,
) -> tuple[float, float]:
    """Return the speeds with which one motion begins to end and the next has begun.

    `before` and `after` are speed, acceleration and length each, of which the part `known` is theirs for sure.
    """
    fast = min(before[0], math.sqrt(before[1] * before[2] * known))
    fast_after = min(after[0], math.sqrt(after[1] * after[2] * known))
    time = min(before[2] / fast, after[2] / fast_after, max(fast / before[1], fast_after / after[1]))
    leaving, entering = min(fast, time * before[1]), min(fast_after, time * after[1])
    if aside > LEAST_ASIDE and tolerance_mm < math.inf:
        slow = 2.0 * math.sqrt(before[1] * tolerance_mm / aside)
        leaving, entering = min(leaving, slow), min(entering, slow)
    return leaving, entering


@compiled
def _is_passed(
    seg: Segments, k: int, following: int, limits: AxisLimits, path: np.void, tangents: Floats
) -> bool:
    """Tell whether the corner is passed as it is: with all its speed, or faster than motions that overlap would be.

    As LinuxCNC weighs it: before it knows the next corner, and half of the speed because both motions lose theirs.
    """
    row, after = seg.row[k], seg.row[following]
    top, accel = axes_allow(seg, k, limits, path, tangents[0], tangents[1])
    top_after, accel_after = axes_allow(seg, following, limits, path, tangents[0], tangents[1])
    cap, cap_after = min(top, feed_in_force(row, path)), min(top_after, feed_in_force(after, path))
    aside = _pulled_aside(seg, k, following, limits, tangents)
    segment_tangent(seg, k, 1.0, tangents[0])
    segment_tangent(seg, following, 0.0, tangents[1])
    if _dot(tangents, limits) < math.cos(SHARPEST):
        return True
    share = step_share(limits, tangents, min(cap, cap_after), accel_after, path["corner_cycle_s"])
    if path["rounding_share"] > 0.0:
        share /= path["rounding_share"]
    if share <= path["corner_share"]:
        return True
    part, part_after = _part_for_sure(row, path), _part_for_sure(after, path)
    leaving, entering = _blend_speeds(
        (cap, part * accel, row["length"]),
        (cap_after, part_after * accel_after, after["length"]),
        aside,
        path["tolerance_mm"],
        0.5,
    )
    net = 0.25 * math.sqrt(max(0.0, 1.0 - aside * aside)) * (leaving + entering)
    return bool(min(cap, cap_after) * path["corner_share"] / share >= net)


@compiled
def _part_for_sure(row: np.void, path: np.void) -> float:
    """Return which part of its acceleration a motion is sure of that overlaps and whose corner is not known."""
    part = OVERLAP_SHARE * (1.0 - path["corner_share"])
    return float(part * (LAST_ARC_SHARE if row["kind"] == ARC else 1.0))


@compiled
def _pulled_aside(seg: Segments, k: int, following: int, limits: AxisLimits, pulls: Floats) -> float:
    """Return the sine of half the angle between where both motions accelerate to; `pulls` is scratch."""
    _pull(seg, k, limits, 1.0, pulls[0])
    _pull(seg, following, limits, 0.0, pulls[1])
    return math.sqrt(max(0.0, 0.5 * (1.0 - _dot(pulls, limits))))


@compiled
def _rates(tangents: Floats, limits: AxisLimits, accel: float, accel_after: float) -> tuple[float, float]:
    """Return how fast one speed falls and the other rises, nearer to each other where an axis cannot have both."""
    rate, rate_after = accel, accel_after
    apart = 1.0
    while apart > 0.0 and not _axes_can(tangents, limits, rate, rate_after):
        apart = apart - 0.25
        even = 0.5 * (1.0 / accel + 1.0 / accel_after)
        rate = 1.0 / (even + apart * (1.0 / accel - even))
        rate_after = 1.0 / (even + apart * (1.0 / accel_after - even))
    return rate, rate_after


@compiled
def _axes_can(tangents: Floats, limits: AxisLimits, rate: float, rate_after: float) -> bool:
    """Tell whether every axis can go from one direction to the other while the path speed changes."""
    for i in range(tangents.shape[1]):
        turned = abs(rate_after * tangents[1, i] - rate * tangents[0, i])
        steady = max(rate, rate_after) * abs(tangents[1, i] - tangents[0, i])
        along = max(abs(tangents[0, i]), abs(tangents[1, i])) * abs(rate_after - rate)
        used = axis_use(turned, steady, along, rate / (rate + rate_after))
        if used > OVERLAP_BEND_SHARE * limits.acceleration[i]:
            return False
    return True


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
    seg: Segments,
    paths: Paths,
    g: int,
    axes: tuple[int, int, int],
    time: float,
    speeds: tuple[float, float],
    cut_after: float,
) -> None:
    """Put an OVERLAP that takes `time`, with its speeds at both ends, between the last two segments of path `g`."""
    path, work = paths.row[g], paths.blend[g]
    k, between = slot(paths, g, path["tail"] - 2), slot(paths, g, path["tail"] - 1)
    following = slot(paths, g, path["tail"])
    n = seg.start.shape[1]
    point = work[SCRATCH_POINTS : SCRATCH_POINTS + n]
    cut, even = 0.5 * time * speeds[0], 0.5 * time * speeds[1]
    _copy(seg, between, following)
    _shorten(seg, k, cut, False, point)
    _shorten(seg, following, cut_after, True, point)
    tag = int(seg.row[following]["tag"])
    set_common(seg, between, seg.end[k], seg.start[following], max(speeds[0], speeds[1]), OVERLAPS, tag)
    seg.row[between]["kind"] = OVERLAP
    seg.row[between]["length"] = cut + even
    geo = seg.geo[between]
    geo[ENTRY] = speeds[0] / (speeds[0] + speeds[1])
    segment_tangent(seg, k, 1.0, point)
    for j in range(3):
        seg.plane[between, j] = axes[j]
        geo[FIRST + j] = 2.0 / 3.0 * cut * point[axes[j]]
    segment_tangent(seg, following, 0.0, point)
    for j in range(3):
        i = axes[j]
        geo[SECOND + j] = seg.end[between, i] - seg.start[between, i] - 2.0 / 3.0 * even * point[i]
    path["tail"] += 1
    work[CUT], work[CUT_LINE] = cut_after, path["tail"] - 1


@compiled
def _copy(seg: Segments, k: int, to: int) -> None:
    """Copy segment `k` to another slot."""
    row, copy = seg.row[k], seg.row[to]
    set_common(seg, to, seg.start[k], seg.end[k], row["feed_mm_s"], int(row["flags"]), int(row["tag"]))
    copy["event"], copy["events"] = row["event"], row["events"]
    copy["kind"], copy["length"], copy["end_speed"] = row["kind"], row["length"], row["end_speed"]
    for j in range(3):
        seg.plane[to, j] = seg.plane[k, j]
    for j in range(RISE + 1):
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
