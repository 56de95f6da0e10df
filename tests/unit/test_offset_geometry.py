"""Parallel curves and corners, against numbers worked out by hand."""

from __future__ import annotations

import math

import pytest

from polycnc.nc.blocks._offset_geometry import (
    Leg,
    arc_leg,
    chamfer,
    collapses,
    end_offset,
    join,
    leg_length,
    line_leg,
    offset_sweep,
    round_joint,
    smallest_offset_radius,
    start_offset,
    turns_inside,
)

ALWAYS_ROUND = 2.0


def line(x0: float, y0: float, x1: float, y1: float) -> Leg:
    leg = line_leg(x0, y0, x1, y1)
    assert leg is not None
    return leg


def arc(x0: float, y0: float, x1: float, y1: float, cx: float, cy: float, sweep_deg: float) -> Leg:
    leg = arc_leg(x0, y0, x1, y1, cx, cy, math.radians(sweep_deg))
    assert leg is not None
    return leg


def test_offset_is_positive_to_the_left() -> None:
    leg = line(0, 0, 10, 0)
    assert start_offset(leg, 2.0) == (0.0, 2.0)
    assert end_offset(leg, -2.0) == (10.0, -2.0)


@pytest.mark.parametrize(("offset", "radius"), [(3.0, 7.0), (-3.0, 13.0)])
def test_left_of_an_arc_that_turns_left_is_its_center(offset: float, radius: float) -> None:
    leg = arc(10, 0, 0, 10, 0, 0, 90)
    assert start_offset(leg, offset) == pytest.approx((radius, 0))
    assert end_offset(leg, offset) == pytest.approx((0, radius))
    assert smallest_offset_radius(leg, offset) == radius


def test_right_of_an_arc_that_turns_right_is_its_center() -> None:
    leg = arc(0, 10, 10, 0, 0, 0, -90)
    assert end_offset(leg, -4.0) == pytest.approx((6, 0))
    assert (leg.tx0, leg.ty0) == pytest.approx((1, 0))
    assert (leg.tx1, leg.ty1) == pytest.approx((0, -1))


def test_an_arc_collapses_at_its_own_radius_only() -> None:
    leg = arc(10, 0, 0, 10, 0, 0, 90)
    assert collapses(leg, 10.0)
    assert not collapses(leg, 9.99)
    assert not collapses(leg, -10.0)
    assert not collapses(line(0, 0, 1, 0), 10.0)


@pytest.mark.parametrize("length", [0.0, 1e-9])
def test_moves_too_short_to_have_a_direction_are_no_legs(length: float) -> None:
    assert line_leg(1.0, 2.0, 1.0 + length, 2.0) is None
    assert arc_leg(1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0) is None
    assert arc_leg(1.0, 2.0, 1.0, 2.0, 0.0, 2.0, length) is None


def test_length_counts_whole_turns() -> None:
    assert leg_length(line(0, 0, 3, 4)) == 5.0
    assert leg_length(arc(2, 0, 0, 2, 0, 0, 450)) == pytest.approx(2 * 2.5 * math.pi)


def test_inside_corner_of_two_lines() -> None:
    joint = join(line(0, 0, 10, 0), line(10, 0, 10, 10), 2.0, ALWAYS_ROUND)
    assert joint is not None
    assert joint.end == joint.start == pytest.approx((8, 2))
    assert joint.sweep_rad == 0.0


def test_outside_corner_of_two_lines() -> None:
    before, after = line(0, 0, 10, 0), line(10, 0, 10, 10)
    joint = join(before, after, -2.0, ALWAYS_ROUND)
    assert joint is not None
    assert joint.end == pytest.approx((10, -2))
    assert joint.start == pytest.approx((12, 0))
    assert joint.sweep_rad == pytest.approx(math.pi / 2)
    sharp = join(before, after, -2.0, -0.5)
    assert sharp is not None
    assert sharp.end == sharp.start == pytest.approx((12, -2))


def test_inside_corner_of_line_and_arc() -> None:
    # The offset line y = 1 meets the offset circle of radius 6 about (10, 5): x = 10 - sqrt(36 - 16).
    joint = join(line(0, 0, 5, 0), arc(5, 0, 15, 0, 10, 0, -180), 1.0, ALWAYS_ROUND)
    assert joint is not None
    assert joint.end == pytest.approx((10 - math.sqrt(36 - 1), 1))


def test_inside_corner_of_arc_and_line() -> None:
    joint = join(arc(5, 0, 15, 0, 10, 0, -180), line(15, 0, 20, 0), 1.0, ALWAYS_ROUND)
    assert joint is not None
    assert joint.end == pytest.approx((10 + math.sqrt(35), 1))


def test_inside_corner_of_two_arcs() -> None:
    # Two humps of radius 5 about (0, 0) and (10 - 2, 0) would cross; they meet at (4, 3).
    before = arc(-5, 0, 4, 3, 0, 0, -(180 - math.degrees(math.atan2(3, 4))))
    after = arc(4, 3, 13, 0, 8, 0, -(180 - math.degrees(math.atan2(3, 4))))
    joint = join(before, after, 1.0, ALWAYS_ROUND)
    assert joint is not None
    assert joint.end == pytest.approx((4, math.sqrt(36 - 16)))


def test_shallow_outside_corner_of_two_arcs_meets() -> None:
    before = arc(0, 10, 10, 0, 0, 0, -90)
    after = arc(10, 0, 0, -10, -0.1, 0, -90)
    after.x1, after.y1 = -0.1, -10.1
    joint = join(before, after, 2.0, 0.9)
    assert joint is not None
    assert joint.start == joint.end
    assert math.hypot(*joint.end) == pytest.approx(12)
    assert math.hypot(joint.end[0] + 0.1, joint.end[1]) == pytest.approx(12.1)


def test_inside_corner_without_intersection() -> None:
    # Inside a lens of two arcs that is 2 high, a tool of radius 1.5 finds no place.
    half = math.degrees(math.atan2(3, 4))
    before = arc(-3, 0, 3, 0, 0, -4, -2 * half)
    after = arc(3, 0, -3, 0, 0, 4, -2 * half)
    assert turns_inside(before, after, -1.5)
    assert join(before, after, -1.5, ALWAYS_ROUND) is None
    fitting = join(before, after, -0.5, ALWAYS_ROUND)
    assert fitting is not None
    assert fitting.end == pytest.approx((math.sqrt(4.5**2 - 4**2), 0))


def test_retraced_line_is_rounded() -> None:
    joint = join(line(0, 0, 10, 0), line(10, 0, 0, 0), 1.0, 0.9)
    assert joint is not None
    assert abs(joint.sweep_rad) == pytest.approx(math.pi)
    assert joint.sweep_rad < 0.0
    assert (joint.end, joint.start) == ((10.0, 1.0), (10.0, -1.0))


def test_cusp_between_line_and_arc_is_inside_or_outside_by_curvature() -> None:
    # The arc leaves (0, 0) backwards and curls up: left of the line is inside the cusp.
    before, after = line(-10, 0, 0, 0), arc(0, 0, -4, 4, 0, 4, -90)
    joint = join(before, after, 1.0, ALWAYS_ROUND)
    assert joint is not None
    # Offset line y = 1, offset circle of radius 5 about (0, 4).
    assert joint.end == pytest.approx((-4, 1))
    below = join(before, after, -1.0, ALWAYS_ROUND)
    assert below is not None
    assert below.sweep_rad == pytest.approx(math.pi)


def test_cusp_between_two_arcs() -> None:
    # Circles of radius 4 and 9 touch at (0, 0) from both sides of y = 0.
    before, after = arc(-9, -9, 0, 0, 0, -9, -90), arc(0, 0, -4, 4, 0, 4, -90)
    joint = join(before, after, 1.0, ALWAYS_ROUND)
    assert joint is not None
    x, y = joint.end
    assert x < 0
    assert math.hypot(x, y + 9) == pytest.approx(10)
    assert math.hypot(x, y - 4) == pytest.approx(5)


def test_tangent_joint_lies_on_both_offset_curves() -> None:
    joint = join(line(-10, 0, 0, 0), arc(0, 0, 5, 5, 0, 5, 90), 2.0, 0.9)
    assert joint is not None
    assert joint.end == joint.start == (0.0, 2.0)


def test_joint_with_a_collapsed_arc_is_its_center() -> None:
    joint = join(line(-10, 0, 0, 0), arc(0, 0, 5, 5, 0, 5, 90), 5.0, 0.9)
    assert joint is not None
    assert joint.end == (0.0, 5.0)
    assert join(arc(0, 0, 5, 5, 0, 5, 90), line(5, 5, 5, 9), 5.0, 0.9) == ((0.0, 5.0), (0.0, 5.0), 0.0)
    assert join(line(-10, -10, 0, 0), arc(0, 0, 5, 5, 0, 5, 90), 5.0, 2.0) is not None
    assert join(line(-10, 10, 0, 0), arc(0, 0, 5, 5, 0, 5, 90), 5.0, 0.9) is None


def test_inside_corner_of_a_line_that_passes_the_offset_circle_by() -> None:
    # The offset line x = 1.5 misses the offset circle of radius 0.5 about (0, 2).
    assert join(line(0, 10, 0, 0), arc(0, 0, 2, 2, 0, 2, 90), 1.5, ALWAYS_ROUND) is None


@pytest.mark.parametrize("meet_cosine", [ALWAYS_ROUND, -ALWAYS_ROUND])
def test_retraced_arc_is_rounded(meet_cosine: float) -> None:
    joint = join(arc(5, 0, 0, 5, 0, 0, 90), arc(0, 5, 5, 0, 0, 0, -90), 0.5, meet_cosine)
    assert joint is not None
    assert joint.sweep_rad == pytest.approx(-math.pi)
    assert joint.end == pytest.approx((0, 4.5))
    assert joint.start == pytest.approx((0, 5.5))


def test_sweep_of_a_trimmed_and_an_extended_arc() -> None:
    leg = arc(10, 0, 0, 10, 0, 0, 90)
    eighth = 8 * math.sqrt(0.5)
    assert offset_sweep(leg, (8, 0), (0, 8)) == pytest.approx(math.pi / 2)
    assert offset_sweep(leg, (eighth, eighth), (0, 8)) == pytest.approx(math.pi / 4)
    assert offset_sweep(leg, (eighth, -eighth), (0, 8)) == pytest.approx(3 * math.pi / 4)
    assert offset_sweep(leg, (0, 8), (8, 0)) == pytest.approx(-math.pi / 2)


def test_sweep_keeps_whole_turns() -> None:
    leg = arc(10, 0, 0, 10, 0, 0, -630)
    assert offset_sweep(leg, (12, 0), (0, 12)) == pytest.approx(math.radians(-630))


def test_chamfer_touches_the_circle_it_replaces() -> None:
    before, after = line(0, 0, 10, 0), line(10, 0, 0, 0)
    joint = chamfer(before, after, round_joint(before, after, 2.0))
    assert joint.end == pytest.approx((12, 2))
    assert joint.start == pytest.approx((12, -2))
