"""Path spaces: mapped axes, lines, arcs, arc-lines, speeds at the joints, override, coding, limits of a segment."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from polycnc.controllers.imc.core._instructions import Points, Segment
from support.imc_card import (
    FLAG,
    IFIFO,
    PFIFO1,
    enable_path,
    line,
    move_absolute,
    ready_card,
    send,
    set_now,
    shows,
    trace,
    wait_for,
)


def _positions(card, count: int) -> list[float]:  # type: ignore[no-untyped-def]
    return [card.read("curpos", i) for i in range(count)]


@pytest.mark.covers("imc.IMC_AddLineNWithVel", "imc.param.pfifoenable")
@shows("curpos")
@pytest.mark.covers(
    "imc.concept.pfifo_setup", "imc.param.segmap_x1", "imc.param.segmap_x2", "imc.param.segtgvel1"
)
@pytest.mark.parametrize("space", [1, 2])
def test_coordinates_are_the_axes_they_are_mapped_to(space: int) -> None:
    card = ready_card()
    enable_path(card, 1, 0, space=space)
    line(card, 300, 400, speed=10, space=space)
    card.advance(10)
    assert card.read(f"pathmoving{space}") == FLAG
    assert card.read(f"moveinpath{space}", 0) == FLAG
    card.wait()
    assert _positions(card, 3) == [400, 300, 0]
    assert (card.read("segstart", 1), card.read("segend", 1)) == (0, 300)
    assert (card.read(f"seglen{space}"), card.read(f"segID{space}"), card.read(f"pathmoving{space}")) == (
        500,
        1,
        0,
    )


@pytest.mark.covers("imc.IMC_AddLineNWithVel", "imc.concept.pfifo_setup")
@shows("segmap_x1 segmap_x2")
@pytest.mark.covers("imc.param.pathacc1", "imc.param.pathacc2", "imc.param.segtgvel2", "imc.param.segtgvel1")
@pytest.mark.parametrize("space", [1, 2])
def test_a_segment_has_its_speed_and_the_acceleration_of_its_space(space: int) -> None:
    card = ready_card()
    enable_path(card, 0, 1, space=space)
    set_now(card, (f"pathacc{space}", 0.5))
    line(card, 3000, 4000, speed=20, space=space)
    speeds = trace(card, f"pathvel{space}", 60)
    assert speeds[9] == 5.0
    assert speeds[39:] == [20.0] * 21
    assert card.read(f"segtgvel{space}") == 20
    card.wait()
    # 5000 at 20 with two ramps of 40 ms: 5000 / 20 + 40 cycles, and one at rest
    assert card.clock.cycles == 250 + 40 + 1


@pytest.mark.covers("imc.IMC_AddLineN", "imc.IMC_AddLineNWithVel", "imc.concept.pfifo_setup")
@shows("curpos")
@pytest.mark.covers("imc.param.segtgvel1")
@pytest.mark.covers("imc.param.pathaxisnum1")
def test_a_plain_segment_takes_the_speeds_in_force_and_needs_no_axis_count() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    set_now(card, ("segtgvel1", 8))
    line(card, 1000, 0)
    line(card, 2000, 0, speed=4)
    line(card, 3000, 0)
    speeds = trace(card, "pathvel1", 700)
    assert (card.read("pathaxisnum1"), card.read("curpos")) == (0, 3000)
    assert max(speeds[:130]) == 8
    assert set(speeds[200:350]) == set(speeds[450:600]) == {4.0}


@pytest.mark.covers("imc.IMC_AddLineNWithVel", "imc.struct.PFIFOSegInfo")
@shows("curvel")
def test_segments_with_an_end_speed_join_within_a_cycle() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    for x in (333, 677, 1001):
        line(card, x, 0, speed=10, end_speed=10)
    line(card, 1500, 0, speed=10)
    steps = trace(card, "curvel", 200)
    assert steps[10:140] == pytest.approx([10.0] * 130, abs=3 / 65536)
    assert sum(steps) == 1500
    assert card.read("segID1") == 4


@pytest.mark.covers("imc.IMC_AddLineNWithVel", "imc.concept.pfifo1")
@shows("curpos curvel user16b0")
def test_a_write_between_joined_segments_does_not_stop_them() -> None:
    card = ready_card()
    enable_path(card, 0)
    line(card, 300, speed=10, end_speed=10)
    send(card, PFIFO1, ("user16b0", 1))
    wait_for(card, PFIFO1, "user16b1", 0)
    line(card, 600, speed=10)
    steps = trace(card, "curvel", 90)
    assert set(steps[10:55]) == {10.0}
    assert (card.read("user16b0"), card.read("curpos")) == (1, 600)


@pytest.mark.covers("imc.IMC_WaitParam", "imc.concept.pfifo1")
@shows("curpos user32b0")
@pytest.mark.covers("imc.concept.segment_blocking")
def test_a_wait_between_segments_holds_the_path_until_it_is_met() -> None:
    card = ready_card()
    enable_path(card, 0)
    set_now(card, ("user32b0", FLAG))
    line(card, 200, speed=10)
    wait_for(card, PFIFO1, "user32b0", 0)
    line(card, 400, speed=10)
    card.advance(300)
    assert card.read("curpos") == 200
    set_now(card, ("user32b0", 0))
    card.advance(100)
    assert card.read("curpos") == 400


@pytest.mark.covers("imc.IMC_AddArc", "imc.IMC_AddArcWithVel", "imc.const.arc_dir")
@shows("curpos moving segmap_x1")
@pytest.mark.covers("imc.const.dir_conflict")
@pytest.mark.parametrize(("clockwise", "middle"), [(False, (-10, 45)), (True, (-109, -25))])
def test_an_arc_goes_round_its_centre_in_its_direction(clockwise: bool, middle: tuple[int, int]) -> None:
    # from (0, 0) about (-60, 10): a quarter ends in (-50, 70), the other way it is three quarters
    card = ready_card()
    enable_path(card, 0, 1)
    assert card.push(PFIFO1, Segment((-50, 70), (-60, 10), clockwise, 5 * 65536))
    ways = []
    card.advance(1)
    while card.read("moving", 0):
        ways.append((card.read("curpos", 0), card.read("curpos", 1)))
        card.advance(1)
    assert list(ways[-1]) == [-50, 70]
    radius = math.hypot(60, 10)
    assert all(abs(math.hypot(x + 60, y - 10) - radius) < 1.5 for x, y in ways)
    assert min(math.hypot(x - middle[0], y - middle[1]) for x, y in ways) < 5
    assert card.read("arcdir1") == (0 if clockwise else FLAG)
    assert card.read("radius1") == round(radius)
    assert card.read("seglen1") == round(math.pi / 2 * radius * (3 if clockwise else 1))


@pytest.mark.covers("imc.IMC_AddArc", "imc.IMC_AddArcWithVel")
@shows("curpos")
def test_an_arc_that_ends_where_it_begins_is_a_full_circle() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    card.push(PFIFO1, Segment((0, 0), (50, 0), False, 5 * 65536))
    xs = trace(card, "curpos", 80)
    assert max(xs) in (99, 100)
    assert card.read("seglen1") == round(2 * math.pi * 50)
    card.wait()
    assert _positions(card, 2) == [0, 0]


@pytest.mark.covers(
    "imc.IMC_AddSpiral", "imc.IMC_AddSpiralWithVel", "imc.IMC_AddArcLine", "imc.const.arc_dir"
)
@pytest.mark.parametrize(("clockwise", "side"), [(False, 40), (True, -40)])
def test_a_helix_that_ends_where_it_begins_in_its_plane_goes_once_round(clockwise: bool, side: int) -> None:
    card = ready_card()
    enable_path(card, 3, 1, 2)
    assert card.push(PFIFO1, Segment((0, 0, -72), (-40, 0), clockwise, 5 * 65536))
    places: list[list[float]] = []
    while not places or card.read("moving", 3):
        card.advance(1)
        places.append([card.read("curpos", axis) for axis in (3, 1, 2)])
    assert places[-1] == [0, 0, -72]
    assert card.read("seglen1") == round(math.hypot(2 * math.pi * 40, 72))
    place = min(places, key=lambda at: abs(at[2] + 18))  # after a quarter
    assert math.dist(place, (-40, side, -18)) < 5


@pytest.mark.covers(
    "imc.IMC_AddArcLine", "imc.IMC_AddArcLineWithVel", "imc.IMC_AddSpiral", "imc.IMC_AddSpiralWithVel"
)
@shows("curpos segmap_x1")
def test_an_arc_line_takes_the_other_coordinates_along_straight() -> None:
    card = ready_card()
    enable_path(card, 2, 3, 0, 1)
    card.push(PFIFO1, Segment((100, 100, 40, -80), (0, 100), False, 5 * 65536))
    card.advance(20)
    angle = math.atan2(100 - card.read("curpos", 3), card.read("curpos", 2))
    part = (math.pi / 2 - angle) / (math.pi / 2)
    assert card.read("curpos", 0) == pytest.approx(40 * part, abs=1.5)
    assert card.read("curpos", 1) == pytest.approx(-80 * part, abs=1.5)
    card.wait()
    assert _positions(card, 4) == [40, -80, 100, 100]


@pytest.mark.covers("imc.IMC_AddLineN", "imc.IMC_AddArc", "imc.concept.pfifo_setup")
@shows("curpos mcsgo mcstgpos")
@pytest.mark.covers("imc.param.segabs")
def test_data_are_positions_or_distances_by_axis() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    for i in (0, 1):
        move_absolute(card, 100, i)
    card.wait()
    set_now(card, ("pathabs", 0, 1))
    line(card, 300, 300, speed=20)
    card.wait()
    assert _positions(card, 2) == [300, 400]
    set_now(card, ("pathabs", 0, 0))
    card.push(PFIFO1, Segment((-50, 50), (-50, 0), False, 5 * 65536))  # the centre counts from the start too
    card.wait()
    assert _positions(card, 2) == [250, 450]


@pytest.mark.parametrize("space", [1, 2])
@pytest.mark.covers("imc.param.pathacc1", "imc.param.pathacc2", "imc.param.segtgvel1", "imc.param.segtgvel2")
@pytest.mark.covers("imc.concept.pfifo_setup", "imc.IMC_AddLineNWithVel")
@shows("curpos")
@pytest.mark.covers("imc.param.feedoverride")
def test_the_override_acts_at_once_and_0_pauses(space: int) -> None:
    card = ready_card()
    enable_path(card, 0, space=space)
    set_now(card, (f"pathacc{3 - space}", 7), (f"feedrate{3 - space}", 0.25), (f"segtgvel{3 - space}", 3))
    line(card, 5000, speed=20, space=space)
    card.advance(40)
    send(card, IFIFO, (f"feedrate{space}", 0.5))
    assert trace(card, f"pathvel{space}", 11) == [*range(19, 9, -1), 10]
    send(card, IFIFO, (f"feedrate{space}", 0))
    assert trace(card, f"pathvel{space}", 30) == [*range(9, -1, -1), *[0] * 20]
    held = card.read("curpos")
    assert (card.read(f"pathvel{space}"), card.read(f"moveinpath{space}")) == (0, FLAG)
    card.advance(50)
    assert card.read("curpos") == held
    send(card, IFIFO, (f"feedrate{space}", 1))
    assert trace(card, f"pathvel{space}", 30) == [*range(1, 21), *[20] * 10]
    card.wait()
    assert card.read("curpos") == 5000


@pytest.mark.covers("imc.IMC_AddLineNWithVel")
@shows("curpos curvel")
def test_the_speed_counts_on_x_y_z_or_on_one_coordinate() -> None:
    card = ready_card()
    enable_path(card, 0, 1, 2, 3)
    line(card, 100, 200, 200, 900, speed=3)
    card.advance(20)
    assert (card.read("curvel", 0), card.read("curvel", 3)) == (1.0, 9.0)
    card.wait()
    set_now(card, ("asseglen1", 4))
    line(card, 200, 400, 400, 1800, speed=3)
    card.advance(20)
    assert card.read("pathvel1") == 3
    assert card.read("curvel", 3) == pytest.approx(3, abs=2 / 65536)
    card.wait()
    assert _positions(card, 4) == [200, 400, 400, 1800]


@pytest.mark.covers("imc.param.pfifoenable")
@shows("curpos moving")
def test_switching_the_space_off_stops_by_force() -> None:
    card = ready_card()
    enable_path(card, 0)
    line(card, 5000, speed=20)
    line(card, 6000, speed=20)
    card.advance(40)
    send(card, IFIFO, ("startpath1", 0))
    here = card.read("curpos")
    card.advance(3)
    assert (card.read("curpos"), card.read("moving"), card.read("pathmoving1")) == (here, 0, 0)
    send(card, IFIFO, ("startpath1", FLAG))
    card.advance(2)
    card.wait()
    assert card.read("curpos") == 6000


@pytest.mark.covers("imc.fifo.SEL_PFIFO1", "imc.fifo.SEL_PFIFO2")
@pytest.mark.covers(
    "imc.concept.pfifo1", "imc.concept.pfifo2", "imc.param.pfifoenable", "imc.concept.fifo_independence"
)
@shows("curpos segmap_x2")
def test_two_spaces_run_side_by_side() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    enable_path(card, 2, 3, space=2)
    line(card, 600, 800, speed=10)
    line(card, 300, -400, speed=5, space=2)
    card.advance(50)
    assert (card.read("pathvel1"), card.read("pathvel2")) == (10, 5)
    card.wait()
    assert _positions(card, 4) == [600, 800, 300, -400]


@pytest.mark.covers("imc.concept.pfifo_setup")
@shows("curpos error user16b0")
def test_an_axis_that_cannot_take_part_makes_the_segment_an_error() -> None:
    card = ready_card()
    set_now(card, ("run", 0, 1), ("stopfilt", 0))
    enable_path(card, 0, 1)
    line(card, 600, 800, speed=10)
    send(card, PFIFO1, ("user16b0", 1))
    card.advance(20)
    assert _positions(card, 2) == [0, 0]
    assert (card.read("error", 0), card.read("user16b0")) == (0x1000, 1)


@shows("error curpos segmap_x1 segmap_x2")
@pytest.mark.covers("imc.concept.pfifo_setup", "imc.IMC_AddLineN")
@pytest.mark.parametrize("space", [1, 2])
@pytest.mark.parametrize("other", [2, 4, 9, 0xFFFF])  # the same axis again, and axes that are not there
def test_coordinates_are_axes_that_there_are_and_each_once(space: int, other: int) -> None:
    card = ready_card()
    set_now(card, (f"segmap_x{space}", 2), (f"segmap_y{space}", other), (f"startpath{space}", FLAG))
    line(card, 31, -42, speed=5, space=space)
    card.advance(12)
    assert [card.read("error", axis) for axis in range(4)] == [0, 0, 0x1000, 0]
    assert (_positions(card, 4), card.read(f"pathmoving{space}")) == ([0] * 4, 0)


@pytest.mark.covers("imc.concept.segment_blocking")
@shows("curpos")
def test_a_move_behind_a_segment_in_the_same_queue_is_carried_out() -> None:
    card = ready_card()
    enable_path(card, 0)
    line(card, 203, speed=10)
    move_absolute(card, 50, 0, PFIFO1)
    wait_for(card, PFIFO1, "moving", 0)
    line(card, 60, speed=10)
    card.advance(200)
    assert (card.read("curpos"), card.read("segID1")) == (60, 2)


@shows("curpos")
@pytest.mark.covers("imc.param.hpause")
def test_pause_of_all_axes_holds_a_path() -> None:
    card = ready_card()
    enable_path(card, 0)
    line(card, 1000, speed=10)
    card.advance(30)
    set_now(card, ("hpause", FLAG))
    card.advance(30)
    here = card.read("curpos")
    card.advance(30)
    assert card.read("curpos") == here
    set_now(card, ("hpause", 0))
    card.wait()
    assert card.read("curpos") == 1000


@pytest.mark.covers("imc.IMC_AddLineN")
@shows("curpos")
def test_a_segment_of_no_length_is_passed() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    line(card, 0, 0, speed=10)
    line(card, 100, 0, speed=10)
    card.wait()
    assert (card.read("curpos"), card.read("segID1")) == (100, 2)


@shows("curpos")
@pytest.mark.covers("imc.param.smooth")
def test_smoothing_acts_behind_the_path() -> None:
    card = ready_card()
    set_now(card, ("smooth", 16))
    enable_path(card, 0)
    line(card, 1000, speed=10)
    velocities = trace(card, "curvel", 160)
    assert max(abs(b - a) for a, b in pairwise(velocities)) <= 0.7
    assert card.read("curpos") == 1000


@shows("curpos moving")
@pytest.mark.parametrize("smooth", [0, 7])
@pytest.mark.covers("imc.param.mcsmoving", "imc.param.segmap_x1", "imc.param.smooth")
def test_an_axis_that_leaves_the_mapping_between_joined_segments_arrives(smooth: int) -> None:
    card = ready_card()
    set_now(card, *(("smooth", smooth, i) for i in range(3)))
    enable_path(card, 0, 1)
    line(card, 1000, 377, speed=10, end_speed=10)
    send(card, PFIFO1, ("segmap_x1", 2))
    line(card, 901, 622, speed=10)
    card.advance(130)
    assert card.read("curpos", 0) == 1000
    card.wait()
    assert _positions(card, 3) == [1000, 622, 901]
    assert [card.read(name, 0) for name in ("moveinpath1", "moving", "mcsmoving")] == [0, 0, 0]


@shows("curpos mcsgo mcstgpos")
@pytest.mark.covers("imc.param.segmap_x1")
def test_an_axis_that_has_left_the_mapping_takes_a_command_behind_the_joint() -> None:
    card = ready_card()
    enable_path(card, 0, 1)
    line(card, 1003, 377, speed=10, end_speed=10)
    send(card, PFIFO1, ("segmap_x1", 2))
    move_absolute(card, 950, 0, PFIFO1)
    line(card, 901, 622, speed=10)
    card.advance(300)
    assert _positions(card, 3) == [950, 622, 901]


@shows("curpos error segmap_x1 segmap_x2 stopfilt")
@pytest.mark.parametrize(("first", "second"), [(1, 2), (2, 1)])
def test_an_axis_cannot_be_in_both_spaces_at_once(first: int, second: int) -> None:
    card = ready_card()
    set_now(card, ("stopfilt", 0, 2), ("stopfilt", 0, 3))
    enable_path(card, 1, 3, space=first)
    line(card, 700, 310, speed=10, space=first)
    card.advance(10)
    enable_path(card, 3, 2, space=second)
    line(card, 55, 66, speed=10, space=second)
    card.advance(5)
    assert [card.read("error", axis) for axis in range(4)] == [0, 0, 0x1000, 0x1000]
    card.wait()
    assert _positions(card, 4) == [0, 700, 0, 310]


@shows("curpos error segmap_x1 segmap_x2")
@pytest.mark.covers("imc.param.pathaxisnum1", "imc.param.pathaxisnum2", "imc.concept.pfifo_setup")
@pytest.mark.parametrize("space", [1, 2])
def test_no_segment_may_have_more_axes_than_the_space(space: int) -> None:
    card = ready_card()
    enable_path(card, 2, 0, 1, space=space)
    set_now(card, (f"pathaxisnum{space}", 2))
    line(card, 31, -42, speed=5, space=space)
    card.wait()
    line(card, 50, 60, 70, speed=5, space=space)
    card.advance(40)
    assert _positions(card, 3) == [-42, 0, 31]
    assert [card.read("error", i) for i in range(4)] == [0x1000, 0x1000, 0x1000, 0]


@pytest.mark.covers("imc.IMC_AddContourData")
@shows("curpos pathacc1 pathacc2 segmap_x1 segmap_x2 segtgvel1 segtgvel2")
@pytest.mark.covers("imc.param.pathaxisnum1", "imc.param.pathaxisnum2")
@pytest.mark.parametrize("space", [1, 2])
def test_points_in_a_path_queue_are_gone_along_with_the_speed_of_the_space(space: int) -> None:
    card = ready_card()
    enable_path(card, 2, 1, space=space)
    values = (("pathaxisnum", 2), ("segtgvel", 5), ("pathacc", 0.25), ("segendvel", 0))
    set_now(card, *((f"{name}{space}", value) for name, value in values))
    queue = PFIFO1 + space - 1
    assert card.push(queue, Points((30, 40) * 4))
    assert card.push(queue, Points((30, 40, -6, 8) * 3))
    assert card.waiting_words(queue) == 2 + 8 + 12
    speeds = trace(card, f"pathvel{space}", 100)
    # 380 pulses: 20 cycles up to 5, 20 down to rest, and 50 on each of the ramps
    assert speeds[:21] == [0.25 * k for k in range(1, 21)] + [5.0]
    assert max(speeds) == 5
    assert sum(speed > 0 for speed in speeds) in (95, 96)
    assert max(abs(b - a) for a, b in pairwise(speeds)) <= 0.25 + 1e-4
    assert _positions(card, 3) == [0, 4 * 40 + 3 * 48, 4 * 30 + 3 * 24]
    assert (card.waiting_words(queue), card.read(f"segID{space}")) == (0, 10)


@pytest.mark.covers("imc.IMC_AddContourData")
@shows("curpos")
@pytest.mark.covers("imc.param.pathacc1", "imc.param.feedoverride")
@pytest.mark.covers("imc.param.pathaxisnum1", "imc.param.segtgvel1")
def test_points_slow_down_for_what_follows_and_take_the_override() -> None:
    card = ready_card()
    enable_path(card, 0)
    set_now(card, ("pathaxisnum1", 1), ("segtgvel1", 8), ("pathacc1", 0.5), ("segendvel1", 2))
    card.push(PFIFO1, Points((25,) * 40))
    line(card, 1300, speed=2)
    speeds = trace(card, "pathvel1", 60)
    assert speeds[-1] == 8
    send(card, IFIFO, ("feedrate1", 0.5))
    assert trace(card, "pathvel1", 10)[-1] == 4
    send(card, IFIFO, ("feedrate1", 1))
    speeds = trace(card, "pathvel1", 400)
    assert max(speeds) == 8
    assert set(speeds[-150:-110]) <= {2.0, 0.0}
    card.wait()
    assert card.read("curpos") == 1300


@pytest.mark.covers("imc.IMC_AddContourData")
@shows("error segmap_x1 user16b0")
@pytest.mark.parametrize(("named", "points"), [(0, (3, 4)), (2, (3, 4, 5))])
@pytest.mark.covers("imc.param.pathaxisnum1", "imc.param.segtgvel1")
def test_points_that_are_not_whole_are_an_error(named: int, points: tuple[int, ...]) -> None:
    card = ready_card()
    enable_path(card, 1, 3)
    set_now(card, ("pathaxisnum1", named), ("segtgvel1", 8))
    card.push(PFIFO1, Points(points))
    send(card, PFIFO1, ("user16b0", 5))
    card.advance(20)
    assert (card.read("error", 1), card.read("user16b0")) == (0x1000, 5)
    assert card.waiting_words(PFIFO1) == 0
