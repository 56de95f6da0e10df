"""Points, directions, lengths and extents of segments against the curves themselves, in numpy."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.kernel import (
    MOST_SPANS,
    SPAN_CURVED,
    SPAN_END,
    SPAN_LENGTH,
    SPAN_SIZE,
    KernelState,
    append_arc,
    append_circle3d,
    append_line,
    append_spline,
    cut_bezier,
    give_to_path,
    make_state,
    measure_queue,
    prepare_path,
    segment_coordinate,
    segment_point,
    segment_slope,
)
from polycnc.kernel._geometry import segment_tangent

Floats = npt.NDArray[np.float64]
START = np.array([1.3, -2.7, 0.9, 4.1])
AXES = 4
PARTS = (0.0, 0.13, 0.37, 0.5, 0.81, 1.0)


def machine() -> KernelState:
    state = make_state(AXES, segments=64)
    state.limits.feed_axis[3] = 0  # rides along
    state.base[:] = START - 0.3
    give_to_path(state, 0)
    assert append_line(state.seg, state.paths, 0, state.limits, START, 19.0, 0, 1)
    return state


def point(state: KernelState, s: float, k: int = 1) -> Floats:
    out = np.zeros(AXES)
    segment_point(state.seg, k, s, out)
    return out


def length(state: KernelState, k: int = 1) -> float:
    return float(state.seg.row[k]["length"])


@dataclass(frozen=True)
class Arc:
    """An arc about a centre in the plane of axes `p` and `q` that ends on `radius`; `ways` are those of other axes."""

    p: int
    q: int
    center: tuple[float, float]
    sweep_rad: float
    radius: float
    ways: dict[int, float] = field(default_factory=dict)

    @property
    def first(self) -> tuple[float, float]:
        """Return angle and radius of the start."""
        at_p, at_q = START[self.p] - self.center[0], START[self.q] - self.center[1]
        return math.atan2(at_q, at_p), math.hypot(at_p, at_q)

    def at(self, part: float) -> Floats:
        """Return the point at a part of the sweep."""
        out, (begin, first) = START.copy(), self.first
        angle, now = begin + self.sweep_rad * part, first + (self.radius - first) * part
        out[self.p], out[self.q] = (
            self.center[0] + now * math.cos(angle),
            self.center[1] + now * math.sin(angle),
        )
        for axis, way in self.ways.items():
            out[axis] += way * part
        return out

    def queued(self) -> KernelState:
        """Return a machine with this arc."""
        state = machine()
        center_p, center_q = self.center
        assert append_arc(
            state.seg, state.paths, 0, state.limits, self.at(1.0), self.p, self.q, center_p, center_q,
            self.sweep_rad, 23.0, 0, 1,
        )  # fmt: skip
        return state


ARCS = [
    Arc(0, 1, (2.4, 0.3), 1.37, math.hypot(1.1, 3.0)),
    Arc(1, 2, (-4.6, 2.2), -2.83, math.hypot(1.9, 1.3), {0: 3.7, 3: -1.9}),
    Arc(2, 0, (0.2, 3.4), 5.91, 2.87, {1: -2.3}),  # its radius grows
    Arc(2, 0, (0.2, 3.4), -4.17, 1.71),
]


@pytest.mark.parametrize("arc", ARCS)
def test_points_of_an_arc_lie_on_it(arc: Arc) -> None:
    state = arc.queued()
    for part in PARTS:
        s = part * length(state)
        assert point(state, s) == pytest.approx(arc.at(part), abs=1e-12)
        found = [segment_coordinate(state.seg, 1, i, s) for i in range(AXES)]
        assert found == pytest.approx(list(arc.at(part)), abs=1e-12)
    for part in (-0.21, 1.17):  # what comes before and after goes on in the same way
        found = [segment_coordinate(state.seg, 1, i, part * length(state)) for i in range(AXES)]
        assert found == pytest.approx(list(arc.at(part)), abs=1e-12)


@pytest.mark.parametrize("arc", ARCS)
def test_the_length_of_an_arc_counts_the_axes_that_count(arc: Arc) -> None:
    along = sum(way for axis, way in arc.ways.items() if axis != 3)
    round_ = abs(arc.sweep_rad) * (arc.first[1] + arc.radius) / 2.0
    assert length(arc.queued()) == pytest.approx(math.hypot(round_, along), rel=1e-13)


@pytest.mark.parametrize("arc", ARCS)
def test_directions_of_an_arc_are_the_slopes_of_its_points(arc: Arc) -> None:
    state = arc.queued()
    step, whole = 1e-6, length(state)
    for part in PARTS:
        slope = (arc.at(part + step) - arc.at(part - step)) / (2.0 * step * whole)
        found = [segment_slope(state.seg, 1, i, part * whole) for i in range(AXES)]
        assert found == pytest.approx(list(slope), abs=1e-8)
        if part in (0.0, 1.0):
            tangent = np.zeros(AXES)
            segment_tangent(state.seg, 1, part, tangent)
            assert tangent == pytest.approx(slope, abs=1e-8)


@pytest.mark.parametrize("arc", ARCS)
@pytest.mark.parametrize("turn", [0.0, 1.1, 2.6, 4.4])
def test_the_extents_of_a_circle_hold_its_quadrants(arc: Arc, turn: float) -> None:
    _, radius = arc.first
    center = (START[arc.p] - radius * math.cos(turn), START[arc.q] - radius * math.sin(turn))
    arc = replace(arc, center=center, radius=radius)
    low, high = extents(arc.queued())
    points = np.array([arc.at(part) for part in np.linspace(0.0, 1.0, 4001)])
    assert low == pytest.approx(points.min(axis=0), abs=1e-5)
    assert high == pytest.approx(points.max(axis=0), abs=1e-5)
    assert (low <= points.min(axis=0) + 1e-12).all()
    assert (high >= points.max(axis=0) - 1e-12).all()


def extents(state: KernelState, first: int = 1) -> tuple[Floats, Floats]:
    state.limits.speed[:] = 90.0
    state.paths.row[0]["closed"] = 1
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    low, high = np.full(AXES, np.inf), np.full(AXES, -np.inf)
    measure_queue(state.seg, state.paths, 0, first, low, high)
    return low, high


def test_a_line_goes_straight_in_every_axis() -> None:
    state = machine()
    end = np.array([4.4, 3.1, -0.8, 9.2])
    assert append_line(state.seg, state.paths, 0, state.limits, end, 19.0, 0, 1)
    whole = math.sqrt(3.1**2 + 5.8**2 + 1.7**2)
    assert length(state) == pytest.approx(whole, rel=1e-14)
    for part in (*PARTS, -0.3, 1.4):
        wanted = START + (end - START) * part
        found = [segment_coordinate(state.seg, 1, i, part * whole) for i in range(AXES)]
        assert found == pytest.approx(list(wanted), abs=1e-13)
        found = [segment_slope(state.seg, 1, i, part * whole) for i in range(AXES)]
        assert found == pytest.approx(list((end - START) / whole), abs=1e-14)
        if 0.0 <= part <= 1.0:
            assert point(state, part * whole) == pytest.approx(wanted, abs=1e-13)
    low, high = extents(state)
    assert low == pytest.approx(np.minimum(START, end))
    assert high == pytest.approx(np.maximum(START, end))


def circle(sweep_deg: float) -> tuple[KernelState, Callable[[float], Floats]]:
    """Return a machine with a circle in space, in its axes 0, 2 and 1, and the curve itself."""
    state = machine()
    center, normal = np.array([2.9, 3.4, -1.8]), np.array([0.4, -0.7, 1.1])
    axes = [0, 2, 1]
    assert append_circle3d(state.seg, state.paths, 0, 0, 2, 1, center, normal, sweep_deg, 31.0, 0, 1)
    unit = normal / np.linalg.norm(normal)
    radius = START[axes] - center
    radius -= unit * (radius @ unit)  # the centre is moved into the plane

    def curve(part: float) -> Floats:
        angle, out = math.radians(sweep_deg) * part, START.copy()
        out[axes] += (math.cos(angle) - 1.0) * radius + math.sin(angle) * np.cross(unit, radius)
        return out

    assert length(state) == pytest.approx(abs(math.radians(sweep_deg)) * np.linalg.norm(radius), rel=1e-12)
    return state, curve


@pytest.mark.parametrize("sweep_deg", [77.0, -213.0, 1171.0])
def test_a_circle_in_space_turns_by_the_right_hand_about_its_normal(sweep_deg: float) -> None:
    state, curve = circle(sweep_deg)
    whole, step = length(state), 1e-6
    for part in PARTS:
        assert point(state, part * whole) == pytest.approx(curve(part), abs=1e-11)
        slope = (curve(part + step) - curve(part - step)) / (2.0 * step * whole)
        for i in range(AXES):
            assert segment_coordinate(state.seg, 1, i, part * whole) == pytest.approx(
                curve(part)[i], abs=1e-11
            )
            assert segment_slope(state.seg, 1, i, part * whole) == pytest.approx(slope[i], abs=1e-7)
        if part in (0.0, 1.0):
            tangent = np.zeros(AXES)
            segment_tangent(state.seg, 1, part, tangent)
            assert tangent == pytest.approx(slope, abs=1e-7)
    low, high = extents(state)
    points = np.array([curve(part) for part in np.linspace(0.0, 1.0, 4001)])
    reach = 0.001 * abs(sweep_deg) / 360.0 * np.ptp(points, axis=0).max() + 1e-9
    if abs(sweep_deg) < 360.0:
        assert low == pytest.approx(points.min(axis=0), abs=reach)
        assert high == pytest.approx(points.max(axis=0), abs=reach)


def test_a_curve_is_met_point_by_point_and_in_length() -> None:
    state, spans = machine(), np.zeros((MOST_SPANS, SPAN_SIZE))
    control = np.array([[0.0, 0.0], [2.3, 1.9], [3.1, -4.4], [7.7, 0.6]])
    count = cut_bezier(control, spans)
    u = np.linspace(0.0, 1.0, 20001)[:, None]
    weights = ((1 - u) ** 3, 3 * u * (1 - u) ** 2, 3 * u**2 * (1 - u), u**3)
    curve = sum(w * c for w, c in zip(weights, control, strict=True)) + START[[2, 0]]
    ways = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    gone = 0.0
    for k, span in enumerate(spans[:count], 1):
        assert span[SPAN_CURVED]
        end = START.copy()
        end[[2, 0]] += span[SPAN_END : SPAN_END + 2]
        append_spline(state.seg, state.paths, 0, end, 2, 0, span, float(span[SPAN_LENGTH]), 31.0, 0, 1)
        for part in PARTS:
            found = point(state, part * length(state, k), k)
            s = gone + part * length(state, k)
            on_curve = [np.interp(s, ways, curve[:, j]) for j in range(2)]
            assert found[[2, 0]] == pytest.approx(on_curve, abs=2e-7)
            assert found[[1, 3]] == pytest.approx(START[[1, 3]], abs=0)
            if part in (0.0, 1.0):
                tangent, at = np.zeros(AXES), int(np.clip(np.searchsorted(ways, s), 1, len(ways) - 2))
                segment_tangent(state.seg, k, part, tangent)
                slope = (curve[at + 1] - curve[at - 1]) / (ways[at + 1] - ways[at - 1])
                assert tangent[[2, 0]] == pytest.approx(slope, abs=2e-3)
        gone += length(state, k)
    assert gone == pytest.approx(ways[-1], rel=1e-6)
    low, high = extents(state)
    assert low[[2, 0]] == pytest.approx(curve.min(axis=0), abs=2e-3)
    assert high[[2, 0]] == pytest.approx(curve.max(axis=0), abs=2e-3)
