"""Round the corner between a line and an arc, or two arcs, with an arc that touches both (`_touching`).

Both lie in one plane of two axes that count, and no other axis moves. The arc stays within the tolerance of the corner
and takes at most half of each, and no more than a quarter turn of an arc, so every arc keeps room at both ends. With
BY_SHARE an arc gives a third of its angle at its start and two thirds of what remains at its end, and the rounding is
found as if a chord stood for an arc that bends to the side the path turns to.

Units: those of `_segments`.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend_speed import (
    AFTER,
    BEFORE,
    CUT,
    CUT_LINE,
    NORMAL,
    cut_by_share,
    feed_along,
    saves_time_in_plane,
)
from polycnc.kernel._corner_rules import BY_SHARE
from polycnc.kernel._jit import apart, compiled
from polycnc.kernel._path import Paths, slot
from polycnc.kernel._segments import (
    ARC,
    CENTER_P,
    CENTER_Q,
    CORNER_STOP,
    LINE,
    OVERLAPS,
    RADIUS_END,
    RADIUS_START,
    RAPID,
    ROUNDING,
    STOP,
    SWEEP_RAD,
    Floats,
    Segments,
    set_arc,
)
from polycnc.kernel._touching import (
    LARGEST_RADIUS,
    Element,
    arc_element,
    curvature,
    cuts,
    fitting_radius,
    line_element,
    touch,
)

SMALLEST_TURN = 1e-6  # rad; a smaller corner is passed as it is
LARGEST_TURN = math.radians(175.0)  # a reversal has no room for an arc
SMALLEST_ARC = 1e-6  # mm
FREE_SHARE = 0.25  # of the shorter element is the tolerance where none is set
QUARTER_TURN = 0.5 * math.pi
MOST_TAKEN = 0.98  # of what is left of an arc, or of a line beside a spiral
MOST_GROWTH = 0.05  # of the radius, per rad: spirals that grow faster are left alone
MOST_OVER = 1.01  # of what may be taken is what an arc with a growing radius is taken of
SMALLEST_GROWN = 1e-9  # mm; no arc that bends by more is as long as SMALLEST_ARC
FIRST_SHARE, LAST_SHARE = 1.0 / 3.0, 2.0 / 3.0  # of an arc's angle, with BY_SHARE


@compiled
def may_be_rounded(path: np.void, row: np.void) -> bool:
    """Tell whether a corner after a segment may be rounded: it is a line or arc at feed; positioning with BY_SHARE."""
    stops = STOP | CORNER_STOP | (0 if path["corner_rule"] == BY_SHARE else RAPID)
    if row["kind"] == ARC:
        stops |= ROUNDING
    return bool(row["kind"] in (LINE, ARC) and not row["flags"] & stops)


@compiled
def round_to_line(
    seg: Segments, paths: Paths, g: int, limits: AxisLimits, end: Floats, speed_mm_s: float, tag: int
) -> bool:
    """Append an arc between the arc at the end of path `g` and a line to `end`, if it may have one (see `_blend`)."""
    row = paths.row[g]
    k = slot(paths, g, row["tail"] - 1)
    p, q = int(seg.plane[k, 0]), int(seg.plane[k, 1])
    if not _in_plane(seg, k, limits, p, q, end):
        return False
    along_p, along_q = end[p] - seg.end[k, p], end[q] - seg.end[k, q]
    length = math.sqrt(along_p * along_p + along_q * along_q)
    if length <= 2.0 * SMALLEST_ARC:
        return False
    after = line_element(along_p, along_q)
    return _round(seg, paths, g, limits, (p, q), after, 0.0, length, speed_mm_s, tag) > 0.0


@apart
@compiled
def round_to_arc(
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    end: Floats,
    plane: tuple[int, int],
    center: tuple[float, float],
    sweep_rad: float,
    speed_mm_s: float,
    tag: int,
) -> float:
    """Append an arc between the last segment of path `g` and an arc to `end`, if the corner may have one.

    Return what is left of the sweep of the arc to `end`.
    """
    row = paths.row[g]
    if row["tolerance_mm"] <= 0.0 or row["tail"] <= row["prepared"] or math.isinf(speed_mm_s):
        return sweep_rad
    k = slot(paths, g, row["tail"] - 1)
    line = seg.row[k]
    p, q = plane
    if not may_be_rounded(row, line) or line["flags"] & RAPID or not _in_plane(seg, k, limits, p, q, end):
        return sweep_rad
    if line["kind"] == ARC and (seg.plane[k, 0] != p or seg.plane[k, 1] != q):
        return sweep_rad
    corner_p, corner_q = seg.end[k, p], seg.end[k, q]
    first = math.hypot(corner_p - center[0], corner_q - center[1])
    last = math.hypot(end[p] - center[0], end[q] - center[1])
    turn = abs(sweep_rad)
    if first * turn <= 2.0 * SMALLEST_ARC or abs(last - first) > MOST_GROWTH * turn * first:
        return sweep_rad
    after = arc_element(corner_p, corner_q, center[0], center[1], sweep_rad, last - first)
    length = 0.5 * (first + last) * turn
    cut = _round(seg, paths, g, limits, plane, after, turn, length, speed_mm_s, tag)
    return math.copysign(turn - cut, sweep_rad)


@compiled
def _in_plane(seg: Segments, k: int, limits: AxisLimits, p: int, q: int, end: Floats) -> bool:
    """Tell whether none but the axes p and q, which count, move on segment `k` and on to `end`."""
    if limits.feed_axis[p] == 0 or limits.feed_axis[q] == 0:
        return False
    for i in range(end.shape[0]):
        if i != p and i != q and (seg.start[k, i] != seg.end[k, i] or end[i] != seg.end[k, i]):
            return False
    return True


@compiled
def _element_before(seg: Segments, k: int, p: int, q: int) -> Element:
    """Return the line or arc `k` as it is at its end."""
    if seg.row[k]["kind"] == LINE:
        return line_element(seg.end[k, p] - seg.start[k, p], seg.end[k, q] - seg.start[k, q])
    geo = seg.geo[k]
    growth = geo[RADIUS_END] - geo[RADIUS_START]
    return arc_element(seg.end[k, p], seg.end[k, q], geo[CENTER_P], geo[CENTER_Q], geo[SWEEP_RAD], growth)


@compiled
def _round(
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    plane: tuple[int, int],
    after: Element,
    sweep_after: float,
    length_after: float,
    speed_mm_s: float,
    tag: int,
) -> float:
    """Round the corner of the last segment of path `g` with `after`; return what that takes of it, mm or rad, or 0."""
    row = paths.row[g]
    work = paths.blend[g]
    p, q = plane
    k = slot(paths, g, row["tail"] - 1)
    line = seg.row[k]
    before = _element_before(seg, k, p, q)
    cross = before[0] * after[1] - before[1] * after[0]
    side = 1.0 if cross >= 0.0 else -1.0
    turn = math.atan2(abs(cross), before[0] * after[0] + before[1] * after[1])
    if turn < SMALLEST_TURN or turn > LARGEST_TURN:
        return 0.0
    kappa, kappa_after = curvature(before, side), curvature(after, side)
    length_before = line["length"] + (work[CUT] if work[CUT_LINE] == row["tail"] - 1 else 0.0)
    tolerance = row["tolerance_mm"]
    by_share = row["corner_rule"] == BY_SHARE
    if by_share or math.isinf(tolerance):
        tolerance = min(tolerance, FREE_SHARE * min(length_before, length_after))
    left = abs(seg.geo[k, SWEEP_RAD]) if before[2] > 0.0 else 0.0
    spiral = 2.0 * (_growth(before) + _growth(after))
    kept = SMALLEST_ARC if spiral == 0.0 else (1.0 - MOST_TAKEN) * line["length"]
    most = _most_of(before[2], length_before, line["length"] - kept, left, LAST_SHARE if by_share else 0.0)
    most_after = _most_of(after[2], length_after, length_after, sweep_after, FIRST_SHARE if by_share else 0.0)
    largest, speed = LARGEST_RADIUS, 0.0
    if by_share:
        _note_directions(work, before, after)
        reach, bent = _as_chords(before, after, turn, (kappa, kappa_after), (most, most_after), tolerance)
        beside = row["rounding_share"] if row["rounding_share"] > 0.0 else 1.0
        cut, speed = cut_by_share(row, line, limits, (p, q, p), work, reach, bent, speed_mm_s, beside)
        largest = cut / math.tan(0.5 * bent)
    if largest * turn < SMALLEST_GROWN:
        return 0.0
    # What bends a spiral a little further than its circle comes off the tolerance.
    tolerance *= 1.0 - spiral
    radius = fitting_radius(turn, kappa, kappa_after, largest, tolerance, most, most_after)
    if radius * turn < SMALLEST_GROWN:
        return 0.0
    cut, cut_after = cuts(turn, kappa, kappa_after, radius)
    cut, cut_after, start_p, start_q, end_p, end_q, center_p, center_q, angle = touch(
        before, after, seg.end[k, p], seg.end[k, q], side, radius, cut, cut_after
    )
    bend = side * angle
    if bend > LARGEST_TURN or radius * bend < SMALLEST_ARC or min(cut, cut_after) <= 0.0:
        return 0.0
    if cut > MOST_OVER * most or cut_after > MOST_OVER * most_after:  # a spiral that goes its own way
        return 0.0
    ways = (_way(before, cut), _way(after, cut_after))
    feeds = (float(line["feed_mm_s"]), speed_mm_s)
    if not by_share and not saves_time_in_plane(limits, plane, before, after, feeds, ways, radius, bend):
        return 0.0
    seg.end[k, p], seg.end[k, q] = start_p, start_q
    _shorten(seg, k, before, cut)
    is_short = line["length"] < row["rounding_gap_s"] * speed and not line["flags"] & OVERLAPS
    if before[2] <= 0.0 and is_short:
        line["flags"] |= ROUNDING
    work[CUT], work[CUT_LINE] = ways[1], row["tail"] + 1
    end = paths.queued[g]
    end[p], end[q] = end_p, end_q
    feed, arc = feed_along(row, feeds[0], feeds[1]), slot(paths, g, row["tail"])
    set_arc(seg, arc, limits.feed_axis, seg.end[k], end, p, q, center_p, center_q, angle, feed, ROUNDING, tag)
    seg.geo[arc, RADIUS_END] = seg.geo[arc, RADIUS_START]  # they differ by rounding
    row["tail"] += 1
    return cut_after


@compiled
def _way(element: Element, cut: float) -> float:
    """Return in mm what a cut takes of an element."""
    return cut * element[2] if element[2] > 0.0 else cut


@compiled
def _growth(element: Element) -> float:
    """Return by which part of it the radius of an arc changes per rad."""
    return abs(element[4]) / element[2] if element[2] > 0.0 else 0.0


@compiled
def _most_of(radius: float, whole_mm: float, left_mm: float, sweep_rad: float, share: float) -> float:
    """Return how much of an element an arc may take, mm or rad: a share of its angle, or half of what it was."""
    if radius <= 0.0:
        return min(0.5 * whole_mm, left_mm)
    most = share * sweep_rad if share > 0.0 else 0.5 * whole_mm / radius
    return min(most, QUARTER_TURN, MOST_TAKEN * sweep_rad)


@compiled
def _note_directions(work: Floats, before: Element, after: Element) -> None:
    """Write the directions on both sides of a corner, and the normal of its plane, to the scratch of `_blend_speed`."""
    for j in range(2):
        work[BEFORE + j], work[AFTER + j], work[NORMAL + j] = before[j], after[j], 0.0
    work[BEFORE + 2], work[AFTER + 2], work[NORMAL + 2] = 0.0, 0.0, 1.0


@compiled
def _as_chords(
    before: Element,
    after: Element,
    turn: float,
    kappas: tuple[float, float],
    most: tuple[float, float],
    tolerance_mm: float,
) -> tuple[float, float]:
    """Return how much of both chords the largest arc takes, mm, and the angle between them.

    An arc that bends to the side of the turn gives half of the chord over half of what it may give, and its chord turns
    by a quarter of that; an arc that bends the other way counts with its length.
    """
    half = 0.5 * (math.pi - turn)
    way, bends = _chord(before, kappas[0], most[0], half)
    way_after, bends_after = _chord(after, kappas[1], most[1], half)
    half -= 0.25 * max(bends, bends_after)
    reach = tolerance_mm * math.cos(half) / (1.0 - math.sin(half))
    return min(reach, way, way_after), math.pi - 2.0 * half


@compiled
def _chord(element: Element, kappa: float, most: float, half_rad: float) -> tuple[float, float]:
    """Return how much of one chord there is, mm, and the angle of its arc that counts."""
    if kappa <= 0.0:
        return _way(element, most), 0.0
    angle = min(most, half_rad)
    return math.sin(0.25 * angle) * element[2], angle


@compiled
def _shorten(seg: Segments, k: int, element: Element, cut: float) -> None:
    """Take `cut` (mm or rad) off the end of the line or arc `k`, whose end point has been moved."""
    row = seg.row[k]
    if element[2] <= 0.0:
        row["length"] -= cut
        return
    geo = seg.geo[k]
    turn = abs(geo[SWEEP_RAD]) - cut
    geo[SWEEP_RAD] = math.copysign(turn, geo[SWEEP_RAD])
    geo[RADIUS_END] -= element[4] * cut
    row["length"] = 0.5 * (geo[RADIUS_START] + geo[RADIUS_END]) * turn
