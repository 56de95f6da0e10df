"""Bezier curves as path segments, against scipy's Bernstein polynomials and quadrature."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from typing import Any

import hypothesis.strategies as st
import numpy as np
import numpy.typing as npt
import pytest
import scipy
from hypothesis import given, settings

from polycnc.kernel import MOST_SPANS, SPAN_CURVED, SPAN_END, SPAN_LENGTH, SPAN_SIZE, cut_bezier
from polycnc.kernel._bezier import BEND_BOUND, SHORTEST_MM, TANGENT_BOUND, bezier_point, bezier_tangent
from support.often import share

Floats = npt.NDArray[np.float64]

CURVES: dict[str, list[tuple[float, float]]] = {
    "hump": [(0, 0), (2.5, 6.25), (7.5, 7.75), (11, 1.5)],
    "S": [(0, 0), (9, 1), (-4, 5), (6.5, 7)],
    "loop": [(0, 0), (31, 22), (-19, 17), (10.5, -3)],
    "small": [(0, 0), (0.003, 0.001), (0.0045, 0.0025), (0.007, 0.0005)],
    "large": [(0, 0), (700, -1900), (1300, 2600), (3100, 400)],
    "parabola": [(0, 0), (10 / 3, 20 / 3), (25 / 3, 22 / 3), (15, 2)],
}


@dataclass
class Cut:
    """A curve as it was cut, with the way from the start of each span."""

    spans: Floats
    curve: Any

    @property
    def lengths(self) -> Floats:
        return self.spans[:, SPAN_LENGTH]

    def begin(self, number: int) -> Floats:
        return np.zeros(2) if number == 0 else np.asarray(self.spans[number - 1, SPAN_END : SPAN_END + 2])

    def way(self, number: int) -> Floats:
        return np.asarray(self.spans[number, SPAN_END : SPAN_END + 2] - self.begin(number))

    def point(self, number: int, part: float) -> Floats:
        way = self.way(number)
        if not self.spans[number, SPAN_CURVED]:
            return np.asarray(self.begin(number) + part * way)
        return np.asarray(
            self.begin(number) + np.asarray(bezier_point(self.spans[number], way[0], way[1], part))
        )

    def tangent(self, number: int, at: float) -> Floats:
        way = self.way(number)
        p, q = bezier_tangent(self.spans[number], way[0], way[1], at)
        return np.array([p, q])


def cut(control: list[tuple[float, float]]) -> Cut:
    """Cut a curve that begins at 0."""
    points = np.array(control, np.float64)
    spans = np.zeros((MOST_SPANS, SPAN_SIZE))
    count = cut_bezier(points, spans)
    assert count >= 0
    return Cut(spans[:count], scipy.interpolate.BPoly(points[:, None, :], [0.0, 1.0]))


def length_of(curve: Any, low: float, high: float) -> float:
    velocity = curve.derivative()
    total: float = scipy.integrate.quad(
        lambda u: float(np.linalg.norm(velocity(u))), low, high, epsabs=1e-13, epsrel=1e-13
    )[0]
    return total


@pytest.mark.parametrize("name", CURVES)
def test_a_length_leads_where_the_curve_is_after_that_length(name: str) -> None:
    found = cut(CURVES[name])
    whole = length_of(found.curve, 0.0, 1.0)
    assert found.lengths.sum() == pytest.approx(whole, rel=1e-11)
    before = 0.0
    for number, length in enumerate(found.lengths):
        for part in (0.0, 0.21, 0.5, 0.83):
            s = before + part * length
            u = (
                scipy.optimize.brentq(lambda x, s=s: length_of(found.curve, 0.0, x) - s, 0.0, 1.0, xtol=1e-15)
                if s
                else 0.0
            )
            away = found.point(number, part) - found.curve(u)
            direction = found.curve.derivative()(u)
            direction /= np.linalg.norm(direction)
            assert abs(away @ direction) <= 3e-8 * whole
            assert abs(away[0] * direction[1] - away[1] * direction[0]) <= 1e-13 * whole
        before += length


@pytest.mark.parametrize("name", CURVES)
def test_spans_join_and_their_directions_do(name: str) -> None:
    found = cut(CURVES[name])
    velocity = found.curve.derivative()
    size = float(np.abs(CURVES[name]).max())
    assert np.array_equal(found.spans[-1, SPAN_END : SPAN_END + 2], CURVES[name][-1])
    for number in range(len(found.spans)):
        assert np.allclose(
            found.point(number, 1.0), found.spans[number, SPAN_END : SPAN_END + 2], atol=1e-12 * size
        )
        if number:
            assert np.allclose(
                found.tangent(number - 1, 1.0), found.tangent(number, 0.0), rtol=0.0, atol=1e-11
            )
    first, last = velocity(0.0), velocity(1.0)
    assert np.allclose(found.tangent(0, 0.0), first / np.linalg.norm(first), atol=1e-13)
    assert np.allclose(found.tangent(len(found.spans) - 1, 1.0), last / np.linalg.norm(last), atol=1e-11)


@pytest.mark.parametrize("name", CURVES)
def test_bounds_hold_and_are_close(name: str) -> None:
    found = cut(CURVES[name])
    places = np.linspace(0.0, 1.0, 401)
    for number, length in enumerate(found.lengths):
        step = length / 400.0
        points = np.array([found.point(number, float(part)) for part in places])
        tangent = np.abs(np.diff(points, axis=0)).max(axis=0) / step
        row = found.spans[number]
        assert np.all(tangent <= row[TANGENT_BOUND : TANGENT_BOUND + 2])
        assert np.all(row[TANGENT_BOUND : TANGENT_BOUND + 2] <= 1.03 * tangent + 1e-3)
        if length > 0.01:  # closer together, differences of differences are rounding
            bend = np.abs(np.diff(points, 2, axis=0)).max(axis=0) / (step * step)
            bound = row[BEND_BOUND : BEND_BOUND + 2]
            assert np.all(bend <= bound * (1.0 + 1e-6) + 1e-4 * bound.max())
            assert np.all(bound <= 1.05 * bend + 0.02 * bound.max())


@pytest.mark.parametrize(
    "control",
    [
        [(0, 0), (0, 0), (7, 3), (7, 3)],
        [(0, 0), (1.75, 0.75), (3.5, 1.5), (7, 3)],
        [(0, 0), (7, 3), (7, 3), (7, 3)],
    ],
)
def test_a_curve_that_is_straight_is_one_line(control: list[tuple[float, float]]) -> None:
    found = cut(control)
    assert found.spans[:, SPAN_CURVED].tolist() == [0.0]
    assert found.lengths[0] == pytest.approx(np.hypot(7.0, 3.0), rel=1e-15)
    assert found.spans[0, SPAN_END : SPAN_END + 2].tolist() == [7.0, 3.0]


@pytest.mark.parametrize(
    ("control", "tip"),
    [
        ([(0, 0), (0, 0), (3, 8), (9, 5)], (0, 0)),
        ([(0, 0), (3, 8), (9, 5), (9, 5)], (9, 5)),
        ([(0, 0), (8, 6), (0, 6), (8, 0)], (4, 4.5)),
    ],
)
def test_where_a_curve_stands_still_what_is_left_is_straight_and_too_short_to_be_seen(
    control: list[tuple[float, float]], tip: tuple[float, float]
) -> None:
    found = cut(control)
    straight = found.spans[:, SPAN_CURVED] == 0.0
    assert straight.any()
    assert np.all(found.lengths[straight] <= SHORTEST_MM)
    assert found.lengths.sum() == pytest.approx(
        length_of(found.curve, 0.0, 0.5) + length_of(found.curve, 0.5, 1.0), rel=1e-6
    )
    assert len(found.spans) < 150
    nearest = min(
        np.linalg.norm(np.subtract(end, tip)) for end in (*found.spans[:, SPAN_END : SPAN_END + 2], (0, 0))
    )
    assert nearest <= 2.0 * SHORTEST_MM


def test_a_curve_that_turns_back_on_one_line_is_lines_between_where_it_turns() -> None:
    # 36 u v2 - 15 u2 v + 4 u3, v = 1 - u, is even at the roots of 165 u2 - 174 u + 36.
    found = cut([(0, 0), (12, 12), (-5, -5), (4, 4)])
    turns = (174.0 + np.array([-1.0, 1.0]) * np.sqrt(174.0**2 - 4.0 * 165.0 * 36.0)) / 330.0
    places = [36.0 * u * (1.0 - u) ** 2 - 15.0 * u * u * (1.0 - u) + 4.0 * u**3 for u in turns]
    assert found.spans[:, SPAN_CURVED].tolist() == [0.0, 0.0, 0.0]
    assert np.allclose(found.spans[:, SPAN_END], [*places, 4.0], rtol=1e-13)
    assert np.allclose(found.spans[:, SPAN_END + 1], [*places, 4.0], rtol=1e-13)
    ways = np.abs(np.diff([0.0, *places, 4.0]))
    assert np.allclose(found.lengths, np.sqrt(2.0) * ways, rtol=1e-13)
    back = cut([(0, 0), (0, 9), (0, 9), (0, 0)])  # to 3/4 of the way, and back to where it began
    assert back.spans[:, SPAN_END + 1].tolist() == [6.75, 0.0]


def test_a_point_is_no_curve_and_numbers_too_large_make_none() -> None:
    assert len(cut([(0, 0), (0, 0), (0, 0), (0, 0)]).spans) == 0
    spans = np.zeros((MOST_SPANS, SPAN_SIZE))
    for huge in (1e200, np.inf, np.nan):
        assert cut_bezier(np.array([(0, 0), (huge, 1), (2, huge), (3, 5)]), spans) == -1


coordinates = st.integers(-100_000, 100_000).map(lambda x: x / 1000.0)
points = st.tuples(coordinates, coordinates)


@settings(deadline=None, max_examples=share(80))
@given(points, points, points)
def test_every_curve_is_cut_where_it_is(
    first: tuple[float, float], second: tuple[float, float], end: tuple[float, float]
) -> None:
    found = cut([(0.0, 0.0), first, second, end])
    size = float(np.abs([first, second, end]).max())
    if size == 0.0:
        return
    dense = found.curve(np.linspace(0.0, 1.0, 4001))
    apart = np.linalg.norm(np.diff(dense, axis=0), axis=1).max()
    for number in range(len(found.spans)):
        for part in (0.0, 0.37, 0.74, 1.0):
            # Beside the curve by no more than the chord between two of its points is.
            off = np.linalg.norm(dense - found.point(number, part), axis=1).min()
            assert off <= apart
    chords = np.linalg.norm(np.diff(dense, axis=0), axis=1).sum()
    assert chords * (1.0 - 1e-9) <= found.lengths.sum() + 1e-6
    assert found.lengths.sum() <= chords * (1.0 + 1e-4) + 1e-6


BITS_PROGRAM = """
import numpy as np
from polycnc.kernel import MOST_SPANS, SPAN_SIZE, cut_bezier
from polycnc.kernel._bezier import bezier_point, bezier_tangent
spans = np.zeros((MOST_SPANS, SPAN_SIZE))
for control in ([(0, 0), (31, 22), (-19, 17), (10.5, -3)], [(0, 0), (0, 0), (3, 8), (9, 5)]):
    count = cut_bezier(np.array(control, np.float64), spans)
    print(count, spans[:count].tobytes().hex())
    for row in spans[:count]:
        for part in (0.0, 0.3, 1.0):
            print(np.array(bezier_point(row, 1.5, -0.25, part)).tobytes().hex())
        print(np.array(bezier_tangent(row, 1.5, -0.25, 1.0)).tobytes().hex())
"""


def test_compiled_and_interpreted_code_give_the_same_bits() -> None:
    outputs = [
        subprocess.run(
            [sys.executable, "-c", BITS_PROGRAM],
            env={**os.environ, "NUMBA_DISABLE_JIT": disable, "POLYCNC_OPEN_INTERNALS": "1"},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for disable in ("0", "1")
    ]
    assert outputs[0] == outputs[1]
    assert len(outputs[0]) > 1000
