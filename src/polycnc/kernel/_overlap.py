"""Let a motion begin while the one before it ends, where a corner may be left but no arc rounds it.

With BY_SHARE that is the corner beside a helix, or beside an arc that no other one touches: as LinuxCNC does it, the
motion into the corner slows down to rest with half of its acceleration, and the one out of it speeds up with half of
its own so early that they pass the corner within the tolerance, which `free_overlaps` lets them leave. An axis has what
one leaves for the other, and both keep to their half all along. The piece in which both move is an OVERLAP (`_cubic`).
LinuxCNC finds how motions overlap as they come, when it knows what follows the second one, be it an arc that rounds its
end or nothing at all: a free piece is found anew then, and the motion before it waits for that.

Units: those of `_segments`.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend_arcs import may_be_rounded
from polycnc.kernel._blend_speed import CUT, CUT_LINE
from polycnc.kernel._corner_rules import BY_SHARE, step_share
from polycnc.kernel._cubic import TAKEN
from polycnc.kernel._curve_limits import (
    LAST_ARC_SHARE,
    OVERLAP_BEND_SHARE,
    OVERLAP_SHARE,
    axes_allow,
    axis_use,
)
from polycnc.kernel._geometry import segment_tangent
from polycnc.kernel._jit import apart, compiled
from polycnc.kernel._limits import SHARPEST, feed_in_force, segment_limits
from polycnc.kernel._overlap_piece import Size, insert, join, part, size_of, taken_of_first
from polycnc.kernel._path import SCRATCH_POINTS, Paths, slot
from polycnc.kernel._segments import (
    ARC,
    CENTER_P,
    CENTER_Q,
    LAST,
    OVERLAP,
    OVERLAPS,
    RADIUS_END,
    RADIUS_START,
    RAPID,
    Floats,
    Segments,
)

SHORTEST_MM = 1e-6
MOST_TRIES = 16
LEAST_ASIDE = 1e-3  # sine of half the turn; smaller ones leave the speed free
KNOWN = 0.5  # of its length is a motion sure of whose corners are not known, as the last one's are not


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
    work, n = paths.blend[g], seg.start.shape[1]
    pair = work[SCRATCH_POINTS : SCRATCH_POINTS + 2 * n].reshape(2, n)
    flags = row["flags"]
    taken = 0.0  # by an overlap at its start; that of an arc is gone
    if flags & OVERLAPS and work[CUT_LINE] == path["tail"] - 2:
        taken = work[CUT]
    row["flags"] |= OVERLAPS
    after["flags"] |= OVERLAPS
    size = (0.0, 0.0, 0.0, 0.0)
    if not _is_passed(seg, k, following, limits, path, pair):
        size = _size(seg, k, following, limits, path, pair, (taken, 0.0))
    if not _is_worth(size):
        row["flags"] = flags
        after["flags"] &= ~OVERLAPS
        return
    slots = (k, following, slot(paths, g, path["tail"]))
    insert(seg, slots, (p, q, r), size, taken, pair[0])
    path["tail"] += 1
    work[CUT], work[CUT_LINE] = size[3], path["tail"] - 1


@apart
@compiled
def overlap_as_known(seg: Segments, paths: Paths, g: int, limits: AxisLimits, first: int, ready: int) -> None:
    """Find the free overlaps from count `first` to `ready` anew: what follows their second motion is known now."""
    path, work, n = paths.row[g], paths.blend[g], seg.start.shape[1]
    pair = work[SCRATCH_POINTS : SCRATCH_POINTS + 2 * n].reshape(2, n)
    for count in range(first + 1, ready if path["free_overlaps"] != 0 else first):
        k, between, following = slot(paths, g, count - 1), slot(paths, g, count), slot(paths, g, count + 1)
        if seg.row[between]["kind"] != OVERLAP:
            continue
        slots, old, beyond = (k, between, following), size_of(seg, between), slot(paths, g, count + 2)
        goes_on = count + 2 < path["tail"] and seg.row[beyond]["kind"] == OVERLAP
        part(seg, slots, old, pair[0])
        taken = (float(seg.geo[between, TAKEN]), taken_of_first(size_of(seg, beyond)) if goes_on else 0.0)
        size = _size(seg, k, following, limits, path, pair, taken)
        if not _is_worth(size):
            size = old
        join(seg, slots, size, pair[0])
        if goes_on:
            seg.geo[beyond, TAKEN] = size[3]


@compiled
def _is_worth(size: Size) -> bool:
    """Tell whether both motions do a way together."""
    return size[0] * min(size[1], size[2]) >= 2.0 * SHORTEST_MM


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
    seg: Segments,
    k: int,
    following: int,
    limits: AxisLimits,
    path: np.void,
    tangents: Floats,
    taken: tuple[float, float],
) -> Size:
    """Return the size of the OVERLAP of two motions, of which others have taken at the far ends what `taken` says.

    The one that ends has its speed with the deviation that is allowed left to go, and the other reaches its own by the
    end, with its acceleration at most.
    """
    row, after = seg.row[k], seg.row[following]
    cap, accel = segment_limits(seg, k, limits, path, tangents[0], tangents[1])
    cap_after, accel_after = segment_limits(seg, following, limits, path, tangents[0], tangents[1])
    length, length_after = row["length"] + taken[0], after["length"] + taken[1]
    alone = axes_allow(seg, following, limits, path, tangents[0], tangents[1])
    aside = _pulled_aside(seg, k, following, limits, tangents, alone)
    known = KNOWN if after["flags"] & LAST and path["free_overlaps"] != 0 else 1.0
    leaving, _ = _blend_speeds(
        (cap, accel, length),
        (cap_after, accel_after, length_after),
        aside,
        path["tolerance_mm"],
        (1.0, known),
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
) -> Size:
    """Return the same where the next motion begins with the ramp of the one before it, and goes as its own lets it."""
    time = leaving / accel[0]
    entering, cut_after = _gone(time, accel[1], cap_after, after)
    room = min(0.5 * length, row["length"] - SHORTEST_MM) / (0.5 * leaving * time)
    room = min(room, (after["length"] - SHORTEST_MM) / cut_after)
    if room < 1.0:
        time *= math.sqrt(max(0.0, room))
        entering, cut_after = _gone(time, accel[1], cap_after, after)
    return time, accel[0] * time, entering, cut_after


@compiled
def _gone(time_s: float, accel_mm_s2: float, speed_mm_s: float, row: np.void) -> tuple[float, float]:
    """Return how fast a motion is a time after it began at rest, with an acceleration and up to a speed, and how far.

    The last one comes to rest at its end.
    """
    reached = min(speed_mm_s, accel_mm_s2 * time_s)
    way = reached * (time_s - 0.5 * reached / accel_mm_s2)
    if row["flags"] & LAST and row["length"] - way < 0.5 * reached * reached / accel_mm_s2:
        top = min(speed_mm_s, math.sqrt(accel_mm_s2 * row["length"]))
        left = row["length"] / top + top / accel_mm_s2 - time_s
        reached = accel_mm_s2 * max(0.0, left)
        way = row["length"] - 0.5 * reached * left
    return reached, way


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
    known: tuple[float, float],
) -> tuple[float, float]:
    """Return the speeds with which one motion begins to end and the next has begun.

    `before` and `after` are speed, acceleration and length each, of which the parts `known` are theirs for sure.
    """
    fast = min(before[0], math.sqrt(before[1] * before[2] * known[0]))
    fast_after = min(after[0], math.sqrt(after[1] * after[2] * known[1]))
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
    aside = _pulled_aside(seg, k, following, limits, tangents, (top_after, accel_after))
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
        (KNOWN, KNOWN),
    )
    net = 0.25 * math.sqrt(max(0.0, 1.0 - aside * aside)) * (leaving + entering)
    return bool(min(cap, cap_after) * path["corner_share"] / share >= net)


@compiled
def _part_for_sure(row: np.void, path: np.void) -> float:
    """Return which part of its acceleration a motion is sure of that overlaps and whose corner is not known."""
    part = OVERLAP_SHARE * (1.0 - path["corner_share"])
    return float(part * (LAST_ARC_SHARE if row["kind"] == ARC else 1.0))


@compiled
def _pulled_aside(
    seg: Segments, k: int, following: int, limits: AxisLimits, pulls: Floats, alone: tuple[float, float]
) -> float:
    """Return the sine of half the angle between where both motions accelerate to; `pulls` is scratch.

    `alone` is what the axes allow the second one, a speed and an acceleration.
    """
    _pull(seg, k, 0.0, 1.0, pulls[0])
    speed = min(float(seg.row[following]["feed_mm_s"]), alone[0])
    _pull(seg, following, 0.25 * speed * speed / (OVERLAP_SHARE * alone[1]), 0.0, pulls[1])
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
def _pull(seg: Segments, k: int, aside_mm: float, at: float, out: Floats) -> None:
    """Write where segment `k` accelerates to at its start or its end to `out[n]`, as LinuxCNC takes it.

    Along a line; along an arc in its plane, and also to its centre, by as much as the radius is less than `aside_mm`.
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
    in_p, in_q = seg.geo[k, CENTER_P] - seg.start[k, p], seg.geo[k, CENTER_Q] - seg.start[k, q]
    part = aside_mm / (in_p * in_p + in_q * in_q)
    out[p], out[q] = out[p] + part * in_p, out[q] + part * in_q
    size = math.sqrt(out[p] * out[p] + out[q] * out[q])
    out[p], out[q] = out[p] / size, out[q] / size
