"""Radius compensation on random closed contours of lines and arcs: the tool touches, and never cuts in."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from polycnc.nc.blocks._compensation import RadiusCompensation, Side
from polycnc.nc.blocks._compensation_errors import CompensationError
from polycnc.nc.blocks._moves import Arc, Feed, Line, Move, QueueItem
from support.often import share

Outer = Literal["arc", "intersection"]
Floats = npt.NDArray[np.float64]
XY_PLANE = (0, 1, 2)
FEED = Feed(speed_mm_s=10.0)
# Steeper inside corners would need moves longer than the contours here have.
STEEPEST_INSIDE = math.radians(130)
REASONS = {"arc_too_small", "no_intersection", "interference", "stopped_inside"}


@dataclass(frozen=True)
class Contour:
    moves: list[Move]  # lead-in, closed contour from the middle of an edge, lead-out
    radius: float


def through(start: complex, end: complex, bulge: float, line: int) -> Move:
    """Return a line, or an arc whose sagitta is `bulge` half chords; a positive one turns left."""
    first, last = (start.real, start.imag, 0.0), (end.real, end.imag, 0.0)
    if bulge == 0.0:
        return Line(first, last, FEED, False, False, line)
    chord = end - start
    center = (start + end) / 2 + 1j * chord * (1 - bulge * bulge) / (4 * bulge)
    return Arc(first, last, (center.real, center.imag), 4 * math.atan(bulge), XY_PLANE, FEED, False, line)


def tangents(move: Move) -> tuple[complex, complex]:
    chord = complex(move.end[0] - move.start[0], move.end[1] - move.start[1])
    chord /= abs(chord)
    if isinstance(move, Line):
        return chord, chord
    turn = complex(math.cos(move.sweep_rad / 2), math.sin(move.sweep_rad / 2))
    return chord / turn, chord * turn


def sampled(move: Move, count: int) -> Floats:
    """Return `count` points from start to end, shape (count, 2)."""
    t = np.linspace(0.0, 1.0, count)
    start, end = np.array(move.start[:2]), np.array(move.end[:2])
    if isinstance(move, Line):
        return np.asarray(start + t[:, None] * (end - start), dtype=np.float64)
    center = np.array(move.center)
    angle = math.atan2(*(start - center)[::-1]) + t * move.sweep_rad
    radius = np.hypot(*(start - center))
    return np.asarray(center + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1), dtype=np.float64)


def lengths(vectors: Floats) -> Floats:
    return np.hypot(vectors[:, 0], vectors[:, 1])


def distances(points: Floats, move: Move) -> Floats:
    """Return the exact distance of each point from a move."""
    start, end = np.array(move.start[:2]), np.array(move.end[:2])
    if isinstance(move, Line):
        chord = end - start
        t = np.clip((points - start) @ chord / (chord @ chord), 0.0, 1.0)
        return lengths(points - start - t[:, None] * chord)
    center = np.array(move.center)
    v, u = points - center, start - center
    sense = math.copysign(1.0, move.sweep_rad)
    angle = sense * np.arctan2(u[0] * v[:, 1] - u[1] * v[:, 0], v @ u) % (2 * np.pi)
    on_arc = np.abs(lengths(v) - math.hypot(*u))
    at_ends = np.minimum(lengths(points - start), lengths(points - end))
    return np.where(angle <= abs(move.sweep_rad), np.minimum(on_arc, at_ends), at_ends)


def compensate(contour: Contour, side: Side, outer: Outer = "arc") -> list[QueueItem]:
    assume(steepest_inside(contour.moves[1:-1], side) < STEEPEST_INSIDE)
    stage = RadiusCompensation(outer=outer)
    stage.start(side, contour.radius, XY_PLANE)
    out = [done for move in contour.moves[:-1] for done in stage.push(move)]
    stage.cancel()
    out += stage.push(contour.moves[-1])
    assert not stage.active
    assert stage.flush() == []
    return out


def mirrored(contour: Contour) -> Contour:
    moves: list[Move] = []
    for move in contour.moves:
        start, end = (move.start[0], -move.start[1], 0.0), (move.end[0], -move.end[1], 0.0)
        if isinstance(move, Line):
            moves.append(Line(start, end, FEED, False, False, move.line))
        else:
            center = (move.center[0], -move.center[1])
            moves.append(Arc(start, end, center, -move.sweep_rad, XY_PLANE, FEED, False, move.line))
    return Contour(moves, contour.radius)


@st.composite
def contours(draw: st.DrawFn, *, convex: bool, arcs: bool) -> Contour:
    """Return a closed contour about the origin and a tool smaller than its smallest feature."""
    count = draw(st.integers(4, 9))
    direction = draw(st.sampled_from([1, -1]))
    shares = [draw(st.floats(0.6, 1.4)) for _ in range(count)]
    angles = np.cumsum(shares) / sum(shares) * 2 * math.pi * direction
    sizes = [50.0] * count if convex else [draw(st.floats(25.0, 60.0)) for _ in range(count)]
    corners = [complex(s * math.cos(a), s * math.sin(a)) for s, a in zip(sizes, angles, strict=True)]
    bulge = st.one_of(st.just(0.0), st.floats(0.05, 0.25), st.floats(-0.25, -0.05))
    moves: list[Move] = []
    for k in range(count):
        b = draw(bulge) if arcs and k else 0.0
        moves.append(through(corners[k], corners[(k + 1) % count], b, k + 2))
    # The first edge is a line: start and end in its middle, so that the leads do not stand in a corner.
    middle = (corners[0] + corners[1]) / 2
    moves[0] = through(middle, corners[1], 0.0, 2)
    moves.append(through(corners[0], middle, 0.0, count + 2))
    shortest = min(abs(complex(*m.end[:2]) - complex(*m.start[:2])) for m in moves)
    radius = shortest * draw(st.floats(0.02, 0.12))
    assume(separated(moves, radius))
    outside = middle * 2
    lead_in, lead_out = through(outside, middle, 0.0, 1), through(middle, outside, 0.0, count + 3)
    return Contour([lead_in, *moves, lead_out], radius)


def steepest_inside(moves: list[Move], side: Side) -> float:
    turns = [tangents(after)[0] / tangents(before)[1] for before, after in itertools.pairwise(moves)]
    return max(side * math.atan2(turn.imag, turn.real) for turn in turns)


def separated(moves: list[Move], radius: float) -> bool:
    """Tell whether the tool passes between moves that are not neighbours."""
    count = len(moves)
    for k, move in enumerate(moves):
        for other in range(k + 2, count - 1 if k == 0 else count):
            if distances(sampled(move, 60), moves[other]).min() < 2.2 * radius:
                return False
    return True


def check(contour: Contour, side: Side, outer: Outer) -> None:
    out = compensate(contour, side, outer)
    programmed = contour.moves[1:-1]
    moves = [item for item in out if isinstance(item, (Line, Arc))]
    assert len(moves) == len(out)
    for before, after in itertools.pairwise(moves):
        assert after.start == before.end
    assert moves[0].start == contour.moves[0].start
    assert moves[-1].end == contour.moves[-1].end
    for move in moves:
        if isinstance(move, Arc):
            radii = math.dist(move.start[:2], move.center), math.dist(move.end[:2], move.center)
            assert radii[0] == pytest.approx(radii[1], abs=1e-9)
            end = sampled(move, 2)[-1]
            assert tuple(end) == pytest.approx(move.end[:2], abs=1e-9)
    points = np.concatenate([sampled(move, 40) for move in moves[1:-1]])
    each = np.stack([distances(points, move) for move in programmed])
    assert each.min() >= contour.radius - 1e-9
    assert each.min(axis=1) == pytest.approx(np.full(len(programmed), contour.radius), abs=1e-9)


@settings(deadline=None, max_examples=share(60))
@given(contours(convex=True, arcs=False), st.sampled_from(Side), st.sampled_from(["arc", "intersection"]))
def test_convex_polygons(contour: Contour, side: Side, outer: Outer) -> None:
    check(contour, side, outer)


@settings(deadline=None, max_examples=share(60))
@given(contours(convex=False, arcs=False), st.sampled_from(Side), st.sampled_from(["arc", "intersection"]))
def test_star_shaped_polygons(contour: Contour, side: Side, outer: Outer) -> None:
    check(contour, side, outer)


@settings(deadline=None, max_examples=share(100))
@given(contours(convex=False, arcs=True), st.sampled_from(Side), st.sampled_from(["arc", "intersection"]))
def test_contours_with_arcs(contour: Contour, side: Side, outer: Outer) -> None:
    check(contour, side, outer)


@settings(deadline=None, max_examples=share(40))
@given(contours(convex=False, arcs=True), st.sampled_from(Side))
def test_left_and_right_mirror_each_other(contour: Contour, side: Side) -> None:
    other = Side.RIGHT if side is Side.LEFT else Side.LEFT
    ours, theirs = compensate(contour, side), compensate(mirrored(contour), other)
    assert [type(item) for item in ours] == [type(item) for item in theirs]
    for one, two in zip(ours, theirs, strict=True):
        assert isinstance(one, (Line, Arc))
        assert isinstance(two, (Line, Arc))
        assert one.end[:2] == pytest.approx((two.end[0], -two.end[1]), abs=1e-9)
        if isinstance(one, Arc) and isinstance(two, Arc):
            assert one.sweep_rad == pytest.approx(-two.sweep_rad, abs=1e-9)


@settings(deadline=None, max_examples=share(30))
@given(contours(convex=False, arcs=True), st.sampled_from(Side))
def test_radius_zero_changes_nothing(contour: Contour, side: Side) -> None:
    assert compensate(Contour(contour.moves, 0.0), side) == contour.moves


@settings(deadline=None, max_examples=share(30))
@given(contours(convex=False, arcs=True), st.sampled_from(Side), st.data())
def test_pieces_on_the_same_path_change_nothing(contour: Contour, side: Side, data: st.DataObject) -> None:
    """Cutting a line in two leaves the compensated path as it is."""
    lines = [k for k, move in enumerate(contour.moves) if isinstance(move, Line) and k]
    cut = data.draw(st.sampled_from(lines[:-1]))
    move = contour.moves[cut]
    share = data.draw(st.floats(0.4, 0.6))
    middle = tuple(a + share * (b - a) for a, b in zip(move.start, move.end, strict=True))
    pieces: list[Move] = [
        Line(move.start, middle, FEED, False, False, move.line),
        Line(middle, move.end, FEED, False, False, move.line),
    ]
    split = Contour([*contour.moves[:cut], *pieces, *contour.moves[cut + 1 :]], contour.radius)
    whole = [item.end for item in compensate(contour, side) if isinstance(item, (Line, Arc))]
    parts = [item.end for item in compensate(split, side) if isinstance(item, (Line, Arc))]
    assert len(parts) == len(whole) + 1
    missing = [end for end in whole if not any(math.dist(end, part) < 1e-9 for part in parts)]
    assert missing == []


@settings(deadline=None, max_examples=25)
@given(contours(convex=False, arcs=False), st.booleans())
def test_area_as_shapely_buffers_it(contour: Contour, grow: bool) -> None:
    """The compensated path of a polygon is the edge of its buffer."""
    geometry = pytest.importorskip("shapely.geometry")
    points = [move.end[:2] for move in contour.moves[1:-1]]
    polygon = geometry.Polygon(points)
    left = Side.LEFT if polygon.exterior.is_ccw != grow else Side.RIGHT
    out = [item for item in compensate(contour, left) if isinstance(item, (Line, Arc))]
    edge = polygon.buffer(contour.radius if grow else -contour.radius, quad_segs=256).exterior
    for move in out[1:-1]:
        for x, y in sampled(move, 10):
            assert edge.distance(geometry.Point(x, y)) < contour.radius * 1e-4


@st.composite
def grid_paths(draw: st.DrawFn) -> list[Move]:
    """Return lines and arcs between grid points: retraced, tangent, crossing, of no length."""
    points = draw(st.lists(st.tuples(st.integers(-4, 4), st.integers(-4, 4)), min_size=2, max_size=9))
    bulges = st.sampled_from([0.0, 0.0, 1.0, -1.0, 0.41421356237309503, -0.41421356237309503])
    moves: list[Move] = [through(-9 - 9j, complex(*points[0]), 0.0, 1)]
    for number, (start, end) in enumerate(itertools.pairwise(points), 2):
        bulge = draw(bulges) if start != end else 0.0
        moves.append(through(complex(*start), complex(*end), bulge, number))
    return moves


@settings(deadline=None, max_examples=share(100))
@given(
    grid_paths(),
    st.sampled_from([0.5, 1.0, 2.0, 5.0]),
    st.sampled_from(Side),
    st.booleans(),
    st.sampled_from(["arc", "intersection"]),
)
def test_any_path_is_followed_or_refused(
    moves: list[Move], radius: float, side: Side, flush: bool, outer: Outer
) -> None:
    stage = RadiusCompensation(outer=outer)
    stage.start(side, radius, XY_PLANE)
    out: list[QueueItem] = []
    refused: CompensationError | None = None
    try:
        for move in moves:
            out += stage.push(move)
            if flush:
                out += stage.flush()
        out += stage.flush()
    except CompensationError as error:
        refused = error
    if refused is not None:
        assert refused.line in range(1, len(moves) + 1)
        assert refused.reason in REASONS
        return
    done = [item for item in out if isinstance(item, (Line, Arc))]
    assert len(done) >= len(moves)
    assert all(math.isfinite(value) for item in done for value in item.end)
    for before, after in itertools.pairwise(done):
        assert after.start == before.end
    for item in done[1:]:
        if isinstance(item, Arc):
            radii = math.dist(item.start[:2], item.center), math.dist(item.end[:2], item.center)
            assert radii[0] == pytest.approx(radii[1], abs=1e-9)
