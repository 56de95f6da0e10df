"""Cutter radius compensation: small paths whose offset is worked out by hand, and a comparison with rs274."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

import pytest

from polycnc.errors import ConfigurationError, ProgramError
from polycnc.nc.blocks._compensation import RadiusCompensation, Side
from polycnc.nc.blocks._compensation_errors import CompensationError
from polycnc.nc.blocks._moves import Arc, Feed, Line, Move, QueueItem, Wait
from support.rs274 import COMMAND, call

XY_PLANE = (0, 1, 2)
FEED = Feed(speed_mm_s=10.0)
Step = tuple[float, float] | tuple[float, float, float, float, float]


def path(*points: Step, rapid: bool = False, feed: Feed = FEED, z: float = 0.0) -> list[Move]:
    """Return lines to (x, y) and arcs to (x, y) with center and sweep (degree), numbered from 1."""
    moves: list[Move] = []
    last = (float(points[0][0]), float(points[0][1]), z)
    for number, step in enumerate(points[1:], 1):
        to = (float(step[0]), float(step[1]), z)
        if len(step) == 2:
            moves.append(Line(last, to, feed, rapid, False, number))
        else:
            sweep = math.radians(step[4])
            moves.append(Arc(last, to, (step[2], step[3]), sweep, XY_PLANE, feed, False, number))
        last = to
    return moves


def compensate(
    moves: Iterable[QueueItem],
    radius: float,
    side: Side = Side.LEFT,
    *,
    lead_out: Sequence[QueueItem] = (),
    outer: Literal["arc", "intersection"] = "arc",
) -> list[QueueItem]:
    stage = RadiusCompensation(outer=outer)
    stage.start(side, radius, XY_PLANE)
    out = [done for item in moves for done in stage.push(item)]
    if lead_out:
        stage.cancel()
        out += [done for item in lead_out for done in stage.push(item)]
        assert not stage.active
    return out + stage.flush()


def ends(items: Iterable[QueueItem]) -> list[tuple[float, ...]]:
    return [item.end[:2] for item in items if not isinstance(item, Wait)]


def approx(*points: tuple[float, float]) -> list[object]:
    return [pytest.approx(point, abs=1e-12) for point in points]


def assert_refused(reason: str, line: int, moves: Sequence[QueueItem], radius: float, side: Side) -> None:
    with pytest.raises(CompensationError) as caught:
        compensate(moves, radius, side)
    assert caught.value.reason == reason
    assert caught.value.line == line
    assert caught.value.hint


# --- lead-in, lead-out ------------------------------------------------------------------------------------


def test_square_outside_with_leads() -> None:
    square = path((-20, -20), (0, 0), (0, 40), (40, 40), (40, 0), (0, 0))
    out = compensate(square, 5.0, lead_out=path((0, 0), (-20, -20)))
    assert [type(item) for item in out] == [Line, Line, Arc, Line, Arc, Line, Arc, Line, Line]
    assert ends(out) == approx(
        (-5, 0), (-5, 40), (0, 45), (40, 45), (45, 40), (45, 0), (40, -5), (0, -5), (-20, -20)
    )
    corner = out[2]
    assert isinstance(corner, Arc)
    assert corner.center == (0.0, 40.0)
    assert corner.sweep_rad == pytest.approx(-math.pi / 2)
    assert corner.line == 3


def test_square_inside() -> None:
    pocket = path((20, 20), (0, 20), (0, 40), (40, 40), (40, 0), (0, 0), (0, 20))
    out = compensate(pocket, 5.0, Side.RIGHT, lead_out=path((0, 20), (20, 20)))
    assert ends(out) == approx((5, 20), (5, 35), (35, 35), (35, 5), (5, 5), (5, 20), (20, 20))


def test_lead_in_ends_beside_the_start_of_an_arc() -> None:
    out = compensate(path((-10, -10), (0, 0), (10, 10, 0, 10, 90)), 2.0)
    assert ends(out) == approx((0, 2), (8, 10))


def test_lead_moves_may_be_rapid_and_may_leave_the_plane() -> None:
    lead_in = Line((-9.0, 0.0, 50.0), (0.0, 0.0, -1.0), FEED, True, False, 1)
    [first, *_] = compensate([lead_in, *path((0, 0), (0, 10), z=-1.0)], 2.0)
    assert first == Line((-9.0, 0.0, 50.0), (-2.0, 0.0, -1.0), FEED, True, False, 1)


def test_side_and_sign_of_the_radius() -> None:
    moves = path((0, -9), (0, 0), (0, 10), (7, 10), (9, 30))
    assert compensate(moves, -2.0, Side.LEFT) == compensate(moves, 2.0, Side.RIGHT)
    assert ends(compensate(moves, 2.0, Side.RIGHT))[0] == (2.0, 0.0)


def test_radius_zero_passes_everything_at_once() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 0.0, XY_PLANE)
    moves = path((-0.0, 0.1 + 0.2), (1, 1), (3, 1, 2, 1, 180), (3, 1), (4, 4))
    assert [stage.push(move)[0] for move in moves] == moves
    assert all(stage.push(move)[0] is move for move in moves[1:])
    stage.cancel()
    assert stage.push(moves[-1]) == [moves[-1]]
    assert not stage.active


def test_inactive_stage_passes_everything() -> None:
    stage = RadiusCompensation()
    [move] = path((0, 0), (1, 1))
    assert stage.push(move) == [move]
    assert stage.flush() == []
    stage.cancel()
    assert not stage.active


def test_active_from_start_to_the_end_of_the_lead_out() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    seen = [stage.active]
    for move in path((-9, 0), (0, 0), (0, 10)):
        stage.push(move)
        seen.append(stage.active)
    stage.cancel()
    seen.append(stage.active)
    stage.push(path((0, 10), (-9, 10))[0])
    assert [*seen, stage.active] == [True, True, True, True, False]


def test_cancel_before_the_lead_in_switches_off() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    stage.cancel()
    assert not stage.active
    [move] = path((0, 0), (1, 1))
    assert stage.push(move) == [move]


def test_lead_in_followed_by_lead_out_is_perpendicular_to_itself() -> None:
    out = compensate(path((-9, 0), (0, 0)), 2.0, lead_out=path((0, 0), (9, 5)))
    assert ends(out) == approx((0, 2), (9, 5))


def test_reset_forgets_everything() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    stage.push(path((0, 0), (1, 1))[0])
    stage.reset()
    assert not stage.active
    assert stage.flush() == []


# --- corners ----------------------------------------------------------------------------------------------


def test_outer_intersection_up_to_a_right_angle_and_an_arc_beyond() -> None:
    moves = path((-9, -5), (0, 0), (0, 40), (40, 40), (10, 10))
    out = compensate(moves, 5.0, outer="intersection")
    assert [type(item) for item in out] == [Line, Line, Line, Arc, Line]
    assert ends(out)[1] == pytest.approx((-5, 45))
    assert ends(out)[2] == pytest.approx((40, 45))


def test_outer_intersection_extends_arcs() -> None:
    # A quarter circle about (0, 0), then straight down at x = 6 from its point (6, 8).
    rest = 90 - math.degrees(math.atan2(8, 6))
    moves = path((-20, 0), (0, 10), (6, 8, 0, 0, -rest), (6, 0))
    out = compensate(moves, 2.0, outer="intersection")
    [_, arc, line] = out
    assert isinstance(arc, Arc)
    assert arc.end[:2] == pytest.approx((8, math.sqrt(144 - 64)))
    assert arc.sweep_rad == pytest.approx(-(math.pi / 2 - math.atan2(math.sqrt(80), 8)))
    assert isinstance(line, Line)
    assert line.end[:2] == pytest.approx((8, 0))


def test_shallow_outside_corner_has_no_arc() -> None:
    # 0.5 degree: the corner point is 2 / cos(0.25 degree) away, not 2.
    turn = math.radians(0.5)
    moves = path((0, -9), (0, 0), (10, 0), (10 + 10 * math.cos(turn), -10 * math.sin(turn)))
    out = compensate(moves, 2.0)
    assert [type(item) for item in out] == [Line, Line, Line]
    assert math.dist(ends(out)[1], (10, 0)) == pytest.approx(2 / math.cos(turn / 2))


def test_tangent_arcs_keep_their_sweep() -> None:
    slot = path((0, -30), (0, 0), (20, 0), (20, 10, 20, 5, 180), (0, 10), (0, 0, 0, 5, 180))
    out = compensate(slot, 2.0, lead_out=path((0, 0), (0, -30)))
    arcs = [item for item in out if isinstance(item, Arc)]
    assert [arc.sweep_rad for arc in arcs] == pytest.approx([math.pi, math.pi])
    assert ends(out) == approx((0, 2), (20, 2), (20, 8), (0, 8), (0, 2), (0, -30))


def test_full_circle_from_the_inside() -> None:
    out = compensate(path((0, 0), (10, 0), (10, 0, 0, 0, 360)), 3.0, lead_out=path((10, 0), (0, 0)))
    assert ends(out) == approx((7, 0), (7, 0), (0, 0))
    circle = out[1]
    assert isinstance(circle, Arc)
    assert circle.sweep_rad == pytest.approx(2 * math.pi)
    assert circle.center == (0, 0)


def test_helix_keeps_its_pitch_axis() -> None:
    lead = Line((0.0, 0.0, 5.0), (10.0, 0.0, 0.0), FEED, False, False, 1)
    helix = Arc((10.0, 0.0, 0.0), (10.0, 0.0, -6.0), (0.0, 0.0), 6 * math.pi, XY_PLANE, FEED, True, 2)
    [_, out] = compensate([lead, helix], 3.0)
    assert isinstance(out, Arc)
    assert out.start == pytest.approx((7, 0, 0))
    assert out.end == pytest.approx((7, 0, -6))
    assert out.sweep_rad == pytest.approx(6 * math.pi)
    assert out.exact_stop


def test_arc_whose_radius_is_the_tool_radius_turns_on_the_spot() -> None:
    moves = path((20, 5), (20, 0), (35, 0), (40, 5, 35, 5, 90), (40, 30))
    out = compensate(moves, 5.0)
    assert [type(item) for item in out] == [Line] * 4
    assert ends(out) == approx((20, 5), (35, 5), (35, 5), (35, 30))


def test_arc_with_rounded_ends_keeps_its_mismatch() -> None:
    moves = path((0, 0), (10, 0), (0, 10.002, 0, 0, 90))
    [_, arc] = compensate(moves, 3.0)
    assert isinstance(arc, Arc)
    assert math.hypot(*arc.start[:2]) == pytest.approx(7)
    assert math.hypot(*arc.end[:2]) == pytest.approx(7.002)


def test_retraced_path_goes_round_the_tip() -> None:
    out = compensate(path((0, -9), (0, 0), (10, 0), (0, 0)), 2.0)
    assert ends(out) == approx((0, 2), (10, 2), (10, -2), (0, -2))
    tip = out[2]
    assert isinstance(tip, Arc)
    assert tip.sweep_rad == pytest.approx(-math.pi)


def test_other_planes_use_their_own_axes() -> None:
    # G18: first axis Z (index 2), second X (index 0); left of +Z is +X.
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, (2, 0, 1))
    points = [(0.0, 7.0, -9.0), (0.0, 7.0, 0.0), (0.0, 7.0, 20.0)]
    out: list[QueueItem] = []
    for number in (0, 1):
        out += stage.push(Line(points[number], points[number + 1], FEED, False, False, number))
    assert [item.end for item in out + stage.flush() if isinstance(item, Line)] == [
        (2.0, 7.0, 0.0),
        (2.0, 7.0, 20.0),
    ]


# --- feed, stop, rapid ------------------------------------------------------------------------------------


def test_corner_arc_takes_feed_and_line_of_the_next_move() -> None:
    slow = Feed(speed_mm_s=2.0)
    out = compensate([*path((0, -9), (0, 0), (0, 9)), *path((0, 9), (9, 9), feed=slow)], 2.0)
    corner = out[2]
    assert isinstance(corner, Arc)
    assert corner.feed == slow


def test_corner_arc_before_a_rapid_keeps_the_feed() -> None:
    out = compensate([*path((0, -9), (0, 0), (0, 9)), *path((0, 9), (9, 9), rapid=True)], 2.0)
    corner = out[2]
    assert isinstance(corner, Arc)
    assert corner.feed == FEED


def test_corner_arc_under_inverse_time_takes_the_speed_of_the_next_move() -> None:
    out = compensate(path((0, -9), (0, 0), (0, 9), (8, 9), feed=Feed(duration_s=4.0)), 2.0)
    corner, last = out[2], out[3]
    assert isinstance(corner, Arc)
    assert corner.feed == Feed(speed_mm_s=2.0)
    assert isinstance(last, Line)
    assert last.feed == Feed(duration_s=4.0)
    turned = path((0, -9), (0, 0), (0, 9), (0, 1, 0, 5, -180), feed=Feed(duration_s=2.0))
    corner = compensate(turned, 2.0)[2]
    assert isinstance(corner, Arc)
    assert corner.feed.speed_mm_s == pytest.approx(4 * math.pi / 2)


@pytest.mark.parametrize("to", [(9.0, 9.0), (2.0, 1.0), (0.0, 0.0)])
def test_corner_between_rapids_is_straight_and_clear(to: tuple[float, float]) -> None:
    out = compensate(path((0, -9), (0, 0), (0, 9), to, rapid=True), 2.0)
    assert all(isinstance(item, Line) and item.rapid for item in out)
    corner = [item for item in out[1:] if isinstance(item, Line)]
    assert len(corner) == (2 if to == (9.0, 9.0) else 3)
    for item in corner:
        samples = [
            (item.start[0] + k / 50 * (item.end[0] - item.start[0]),
             item.start[1] + k / 50 * (item.end[1] - item.start[1]))
            for k in range(51)
        ]  # fmt: skip
        assert min(math.dist(sample, (0, 9)) for sample in samples) >= 2.0 - 1e-12


def test_exact_stop_stays_on_its_move() -> None:
    stop = Line((0.0, 0.0, 0.0), (0.0, 9.0, 0.0), FEED, False, True, 2)
    out = compensate([*path((0, -9), (0, 0)), stop, *path((0, 9), (9, 9))], 2.0)
    assert [item.exact_stop for item in out if not isinstance(item, Wait)] == [False, True, False, False]


# --- what stands between plane moves ----------------------------------------------------------------------


def test_waits_and_other_axes_stay_in_order_at_the_compensated_point() -> None:
    wait = Wait(0.5, 7, ("M8",))
    down = Line((0.0, 9.0, 0.0), (0.0, 9.0, -3.0), FEED, False, False, 8)
    flat = path((0, -9), (0, 0), (0, 9))
    after = path((0, 9), (9, 9), z=-3.0)
    out = compensate([*flat, wait, down, *after], 2.0)
    assert out[2] is wait
    assert out[3] == Line((-2.0, 9.0, 0.0), (-2.0, 9.0, -3.0), FEED, False, False, 8)
    corner = out[4]
    assert isinstance(corner, Arc)
    assert (corner.start, corner.end) == ((-2.0, 9.0, -3.0), (0.0, 11.0, -3.0))


def test_inside_corner_with_a_plunge_between() -> None:
    down = Line((0.0, 9.0, 0.0), (0.0, 9.0, -3.0), FEED, False, False, 8)
    out = compensate([*path((0, -9), (0, 0), (0, 9)), down, *path((0, 9), (9, 9), z=-3.0)], 2.0, Side.RIGHT)
    assert out[2] == Line((2.0, 7.0, 0.0), (2.0, 7.0, -3.0), FEED, False, False, 8)


def test_items_before_the_lead_in_are_untouched() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    down = Line((0.0, 9.0, 0.0), (0.0, 9.0, -3.0), FEED, False, False, 8)
    assert stage.push(down) == [down]


def test_moves_of_no_length_pass() -> None:
    still = Line((0.0, 9.0, 0.0), (0.0, 9.0, 0.0), FEED, False, False, 8)
    no_arc = Arc((0.0, 9.0, 0.0), (0.0, 9.0, 0.0), (0.0, 9.0), 1.0, XY_PLANE, FEED, False, 9)
    out = compensate([*path((0, -9), (0, 0), (0, 9)), still, no_arc, *path((0, 9), (0, 20))], 2.0)
    assert ends(out) == approx((-2, 0), (-2, 9), (-2, 9), (-2, 9), (-2, 20))


# --- flush ------------------------------------------------------------------------------------------------


def flushed(radius: float, side: Side, *points: Step, rapid: bool = False) -> list[QueueItem]:
    """Compensate with a flush before the last move."""
    moves = path(*points, rapid=rapid)
    stage = RadiusCompensation()
    stage.start(side, radius, XY_PLANE)
    out = [done for move in moves[:-1] for done in stage.push(move)]
    out += stage.flush()
    assert stage.flush() == []
    assert stage.active
    return out + stage.push(moves[-1]) + stage.flush()


def test_flush_ends_beside_the_move_and_an_outside_corner_is_still_exact() -> None:
    points: list[Step] = [(0, -9), (0, 0), (0, 9), (9, 9)]
    assert flushed(2.0, Side.LEFT, *points) == compensate(path(*points), 2.0)


def test_flush_between_rapids_goes_round_straight() -> None:
    out = flushed(2.0, Side.LEFT, (0, -9), (0, 0), (0, 9), (9, 9), rapid=True)
    assert all(isinstance(item, Line) for item in out)
    assert ends(out)[1] == pytest.approx((-2, 9))
    assert ends(out)[-1] == pytest.approx((9, 11))
    assert len(out) == 5


def test_flush_on_a_tangent_or_nearly_tangent_corner_goes_on() -> None:
    assert ends(flushed(2.0, Side.RIGHT, (0, -9), (0, 0), (0, 9), (0, 20)))[1:] == approx((2, 9), (2, 20))
    inward = math.radians(0.5)
    to = (20 * math.sin(inward), 9 + 20 * math.cos(inward))
    out = flushed(2.0, Side.RIGHT, (0, -9), (0, 0), (0, 9), to)
    assert len(out) == 4
    assert math.dist(ends(out)[1], ends(out)[2]) == pytest.approx(2 * 2 * math.sin(inward / 2))


def test_flush_at_an_inside_corner_is_refused() -> None:
    with pytest.raises(CompensationError) as caught:
        flushed(2.0, Side.RIGHT, (0, -9), (0, 0), (0, 9), (9, 9))
    assert caught.value.reason == "stopped_inside"
    assert caught.value.line == 3


def test_waits_after_a_flush_pass_at_once() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    for move in path((0, -9), (0, 0), (0, 9)):
        stage.push(move)
    stage.flush()
    wait = Wait(0.0, 5)
    down = Line((0.0, 9.0, 0.0), (0.0, 9.0, -3.0), FEED, False, False, 8)
    assert stage.push(wait) == [wait]
    assert stage.push(down) == [Line((-2.0, 9.0, 0.0), (-2.0, 9.0, -3.0), FEED, False, False, 8)]
    stage.cancel()
    out = stage.push(path((0, 9), (-9, 9), z=-3.0)[0])
    assert out == [Line((-2.0, 9.0, -3.0), (-9.0, 9.0, -3.0), FEED, False, False, 1)]


# --- refusals ---------------------------------------------------------------------------------------------


def test_arc_as_lead_in() -> None:
    assert_refused("lead_in_arc", 1, path((0, 0), (10, 0, 5, 0, 180)), 2.0, Side.LEFT)
    assert_refused("lead_in_arc", 1, path((0, 0), (10, 0, 5, 0, 180)), 0.0, Side.LEFT)


def test_arc_as_lead_out() -> None:
    with pytest.raises(CompensationError) as caught:
        compensate(path((0, -9), (0, 0), (0, 9)), 2.0, lead_out=path((0, 9), (9, 9, 4.5, 9, 180)))
    assert caught.value.reason == "lead_out_arc"


def test_arc_smaller_than_the_tool() -> None:
    moves = path((20, 5), (20, 0), (35, 0), (40, 5, 35, 5, 90), (40, 30))
    assert_refused("arc_too_small", 3, moves, 5.1, Side.LEFT)
    compensate(moves, 5.1, Side.RIGHT)


def test_inside_corner_the_tool_cannot_reach() -> None:
    half = math.degrees(math.atan2(3, 4))
    lens = path((0, 9), (-3, 0), (3, 0, 0, -4, -2 * half), (-3, 0, 0, 4, -2 * half))
    assert_refused("no_intersection", 3, lens, 1.5, Side.RIGHT)


@pytest.mark.parametrize("width", [9.9, 10.0])
def test_groove_narrower_than_the_tool(width: float) -> None:
    groove = path((-30, 30), (-20, 0), (0, 0), (0, -20), (width, -20), (width, 0), (40, 0))
    if width < 10.0:
        assert_refused("interference", 4, groove, 5.0, Side.LEFT)
    else:  # it just fits: the bottom shrinks to a point
        assert ends(compensate(groove, 5.0))[4:6] == approx((5, -15), (5, 0))


def test_step_smaller_than_the_tool() -> None:
    assert_refused("interference", 3, path((0, 9), (0, 0), (20, 0), (20, 3), (40, 40)), 5.0, Side.LEFT)


def test_arc_trimmed_away_at_inside_corners() -> None:
    # A bump of 10 degrees between two steep inside corners.
    bump = 10 * math.sin(math.radians(5))
    low = 10 * math.cos(math.radians(5))
    moves = path((-30, 30), (-bump, 30), (-bump, low), (bump, low, 0, 0, -10), (bump, 30))
    assert_refused("interference", 3, moves, 2.0, Side.LEFT)
    # As wide as the bump, the tool just touches its top between the walls.
    [_, _, top, out] = compensate(moves, bump, Side.LEFT)
    assert isinstance(top, Line)
    assert top.start == top.end == pytest.approx((0, 10 + bump, 0))
    assert isinstance(out, Line)


def test_plane_change_while_active() -> None:
    tilted = Arc((0.0, 9.0, 0.0), (0.0, 9.0, 8.0), (0.0, 4.0), math.pi, (2, 0, 1), FEED, False, 4)
    assert_refused("plane_change", 4, [*path((0, -9), (0, 0), (0, 9)), tilted], 2.0, Side.LEFT)


@pytest.mark.parametrize(
    ("side", "radius", "plane", "reason"),
    [
        (Side.RIGHT, 2.0, XY_PLANE, "side_change"),
        (Side.LEFT, 2.5, XY_PLANE, "radius_change"),
        (Side.LEFT, -2.0, XY_PLANE, "side_change"),
        (Side.LEFT, 2.0, (2, 0, 1), "plane_change"),
        (Side.LEFT, math.nan, XY_PLANE, "radius"),
    ],
)
def test_second_start(side: Side, radius: float, plane: tuple[int, int, int], reason: str) -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    stage.push(path((0, -9), (0, 0))[0])
    stage.start(Side.LEFT, 2.0, XY_PLANE)  # the same words again: nothing happens
    with pytest.raises(CompensationError) as caught:
        stage.start(side, radius, plane, line=12)
    assert (caught.value.reason, caught.value.line) == (reason, 12)


def test_start_before_the_lead_in_replaces_the_last_start() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    stage.start(Side.RIGHT, 3.0, XY_PLANE)
    out = [done for move in path((0, -9), (0, 0), (0, 9)) for done in stage.push(move)]
    assert ends(out) == approx((3, 0))


def test_start_before_the_lead_out() -> None:
    stage = RadiusCompensation()
    stage.start(Side.LEFT, 2.0, XY_PLANE)
    stage.push(path((0, -9), (0, 0))[0])
    stage.cancel()
    with pytest.raises(CompensationError, match="before its lead-out"):
        stage.start(Side.LEFT, 2.0, XY_PLANE)


def test_error_is_a_program_error_the_interpreter_can_place() -> None:
    error = CompensationError("what", reason="interference", line=3, hint="do")
    assert isinstance(error, ProgramError)
    assert str(error) == "what\ndo"


def test_configuration_is_checked() -> None:
    with pytest.raises(ConfigurationError, match="outer"):
        RadiusCompensation(outer="round")  # type: ignore[arg-type]
    with pytest.raises(ConfigurationError, match="lead"):
        RadiusCompensation(lead="arc")  # type: ignore[arg-type]
    with pytest.raises(ConfigurationError, match="shallow"):
        RadiusCompensation(shallow_deg=91.0)


# --- against another control ------------------------------------------------------------------------------

FEED_LINE = re.compile(r"(STRAIGHT_FEED|ARC_FEED)\((.*)\)")


def rs274_feeds(moves: Sequence[Move], radius: float, side: Side, folder: Path) -> list[tuple[float, ...]]:
    """Return end (and center, direction) of each feed as LinuxCNC's interpreter compensates the moves."""
    lines = ["G21 G17 G90 G94 G40 G49 G64 F100"]
    first = moves[0].start
    lines.append(f"G0 X{first[0]:.9f} Y{first[1]:.9f} Z0")
    lines.append(f"G{41 if side is Side.LEFT else 42}.1 D{2 * radius:.9f}")
    for move in moves:
        words = f"X{move.end[0]:.9f} Y{move.end[1]:.9f}"
        if isinstance(move, Line):
            lines.append(f"G1 {words}")
        else:
            i, j = move.center[0] - move.start[0], move.center[1] - move.start[1]
            lines.append(f"G{3 if move.sweep_rad > 0 else 2} {words} I{i:.9f} J{j:.9f}")
    lines += ["G40", "M2"]
    program = folder / "contour.ngc"
    program.write_text("\n".join(lines) + "\n")
    done = call(program)
    assert "PROGRAM_END" in done.stdout, done.stdout + done.stderr
    feeds: list[tuple[float, ...]] = []
    for kind, words in FEED_LINE.findall(done.stdout):
        numbers = [float(word) for word in words.split(",")]
        feeds.append(tuple(numbers[:2] if kind == "STRAIGHT_FEED" else numbers[:5]))
    return feeds


CONTOURS: dict[str, list[Step]] = {
    "square": [(-20, -30), (0, 0), (0, 40), (40, 40), (40, 0), (0, 0)],
    "inside corners": [(-20, -30), (0, 0), (0, 40), (30, 40), (30, 70), (60, 70), (60, 0), (0, 0)],
    "sharp": [(-20, -30), (0, 0), (10, 50), (20, 0), (35, 60), (50, 0)],
    "tangent arcs": [(-20, -30), (0, 0), (0, 30), (9, 39, 9, 30, -90), (50, 39), (60, 49, 50, 49, 90)],
    "line to arc": [(-20, -30), (0, 0), (0, 30), (40, 30, 20, 30, -180), (40, 0), (80, 0, 60, 0, -180)],
    "arcs, inside": [(-20, -50), (0, 0), (40, 0, 20, 0, -180), (80, 0, 60, 0, -180), (80, -20)],
    "hollows": [(-20, -50), (0, 0), (40, 0, 20, 0, 180), (80, 0, 60, 0, 180), (80, -20)],
    "hollow to hump": [(-20, -50), (0, 0), (40, 0, 20, 0, 180), (80, 0, 60, 0, -180), (120, 0)],
}  # fmt: skip


@pytest.mark.skipif(COMMAND is None, reason="rs274 (LinuxCNC) is not installed")
@pytest.mark.parametrize("side", Side)
@pytest.mark.parametrize("name", CONTOURS)
def test_contours_as_linuxcnc_compensates_them(name: str, side: Side, tmp_path: Path) -> None:
    moves = path(*CONTOURS[name])
    ours: list[tuple[float, ...]] = []
    for item in compensate(moves, 3.0, side):
        if isinstance(item, Arc):
            ours.append((*item.end[:2], *item.center, math.copysign(1, item.sweep_rad)))
        elif isinstance(item, Line):
            ours.append(item.end[:2])
    theirs = rs274_feeds(moves, 3.0, side, tmp_path)
    # The lead-in differs: theirs ends perpendicular to itself, and may need a corner arc to the contour.
    while theirs[0] != pytest.approx(ours[1], abs=2e-4):
        theirs.pop(0)
    assert [pytest.approx(feed, abs=2e-4) for feed in ours[1:]] == theirs
