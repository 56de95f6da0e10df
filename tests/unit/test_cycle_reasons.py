"""One control cycle: setpoints are sums of sources, and `advance` stops in the right cycle for the right reason."""

from __future__ import annotations

import math

import numpy as np
import pytest

from polycnc.kernel import (
    ADDED,
    FOLLOWING_ERROR,
    MAIN,
    PATH_EVENT,
    PATH_RESTED,
    PIDF,
    POINT_TO_POINT,
    PROFILE_ENDED,
    QUEUE_LOW,
    RECORDER_FULL,
    SHORT_OVERSHOOT,
    SOFT_LIMIT,
    SWITCH_EDGE,
    KernelState,
    advance,
    append_arc,
    append_line,
    append_wait,
    give_to_path,
    give_to_point_to_point,
    make_state,
    move_to,
    place_machine,
    prepare_path,
    start_path,
    stop_axis,
)

CYCLE_S = 0.001


def state_of(axes: int = 2, *, record_cycles: int = 0) -> KernelState:
    state = make_state(axes, segments=256, record_cycles=record_cycles)
    state.limits.speed[:] = 100.0
    state.limits.acceleration[:] = 1000.0
    return state


def move(state: KernelState, axis: int, target: float, layer: int = MAIN) -> None:
    assert move_to(state.ptp, layer, axis, target, 0.0, 50.0, 1000.0, 1000.0, 0.0, SHORT_OVERSHOOT) > 0


def lines(state: KernelState, *ends: tuple[float, ...], feed: float = 50.0, closed: bool = True) -> None:
    give_to_path(state, 0)
    for tag, end in enumerate(ends):
        append_line(state.seg, state.paths, 0, state.limits, np.array(end), feed, 0, tag + 1)
    finish(state, closed)


def finish(state: KernelState, closed: bool = True) -> None:
    state.paths.row[0]["closed"] = closed
    prepare_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
    start_path(state.paths, 0)


def run_until(state: KernelState, reason: int) -> int:
    state.clock[0]["mask"] = reason
    return advance(state, 1_000_000)


def test_a_setpoint_is_the_sum_of_its_sources() -> None:
    state = state_of(3)
    give_to_path(state, 0)
    append_line(state.seg, state.paths, 0, state.limits, np.array([10.0, 0.0, 7.25]), 50.0, 0, 1)
    finish(state)
    move(state, 0, 2.5, ADDED)
    move(state, 2, -1.75, ADDED)
    advance(state, 2000)
    assert state.setpoint.tolist() == [12.5, 0.0, 5.5]


def test_a_path_begins_where_the_axis_stands_and_hands_it_back_without_a_step() -> None:
    state = state_of(2, record_cycles=4000)
    move(state, 0, 7.0)
    run_until(state, PROFILE_ENDED)
    lines(state, (7.0, 5.0), (9.0, 5.0))
    assert state.owner.tolist() == [0, 0]
    run_until(state, PATH_RESTED)
    give_to_point_to_point(state, 0)
    assert state.owner.tolist() == [POINT_TO_POINT, 0]
    move(state, 0, 0.0)
    run_until(state, PROFILE_ENDED)
    rows = state.recorder.rows[: int(state.recorder.filled[0])]
    assert np.max(np.abs(np.diff(rows[:, 4:6], axis=0))) <= 50.0 * CYCLE_S * (1.0 + 1e-9)
    assert state.setpoint.tolist() == [0.0, 5.0]


def test_a_move_ends_in_the_cycle_of_its_closed_form_time() -> None:
    state = state_of()
    move(state, 1, 10.0)
    cycles = run_until(state, PROFILE_ENDED)
    assert cycles == math.ceil((10.0 / 50.0 + 50.0 / 1000.0) / CYCLE_S - 1e-6)
    assert state.clock[0]["raised"] == PROFILE_ENDED
    assert state.clock[0]["axis"] == 1


def test_stopping_an_axis_brakes_it_from_where_it_is() -> None:
    state = state_of()
    move(state, 0, 100.0)
    advance(state, 200)
    before = float(state.setpoint[0])
    stop_axis(state.ptp, MAIN, 0, 500.0, 0.0)
    cycles = run_until(state, PROFILE_ENDED)
    assert cycles == 100
    assert state.setpoint[0] == pytest.approx(before + 50.0**2 / (2.0 * 500.0), abs=1e-9)


def test_a_path_at_rest_with_nothing_queued_is_told_once() -> None:
    state = state_of()
    lines(state, (10.0, 0.0))
    assert run_until(state, PATH_RESTED) == math.ceil((10.0 / 50.0 + 0.05) / CYCLE_S - 1e-6)
    assert state.setpoint.tolist() == [10.0, 0.0]
    assert advance(state, 50) == 50
    assert state.clock[0]["raised"] == 0


def test_events_stop_the_run_at_their_point_one_by_one() -> None:
    state = state_of()
    give_to_path(state, 0)
    append_wait(state.seg, state.paths, 0, 0.0, 7, 1, 0)
    append_line(state.seg, state.paths, 0, state.limits, np.array([5.0, 0.0]), 50.0, 0, 2)
    append_wait(state.seg, state.paths, 0, 0.0, 8, 3, 0)
    append_wait(state.seg, state.paths, 0, 0.0, 9, 4, 0)
    finish(state)
    found = []
    for _ in range(3):
        cycles = run_until(state, PATH_EVENT)
        found.append((cycles, int(state.paths.row[0]["event"]), float(state.setpoint[0])))
    assert found == [(0, 7, 0.0), (150, 8, 5.0), (0, 9, 5.0)]
    advance(state, 3)
    assert state.paths.row[0]["event"] == -1  # told once


def test_an_event_of_one_path_is_not_told_again_with_that_of_another() -> None:
    state = make_state(2, segments=64, paths=2)
    state.limits.speed[:], state.limits.acceleration[:] = 100.0, 1000.0
    state.paths.axis[0], state.paths.axis[1] = (0, -1), (1, -1)
    for g, (wait_s, event) in enumerate([(0.004, 7), (0.0, 8)]):
        give_to_path(state, g)
        append_wait(state.seg, state.paths, g, wait_s, -1, 1, 0)
        append_wait(state.seg, state.paths, g, 0.0, event, 2, 0)
        append_wait(state.seg, state.paths, g, 0.003, -1, 3, 0)
        state.paths.row[g]["closed"] = 1
        prepare_path(state.seg, state.paths, g, state.limits, CYCLE_S, state.work)
        start_path(state.paths, g)
    found = []
    for _ in range(2):
        cycles = run_until(state, PATH_EVENT)
        found.append((cycles, state.paths.row["event"].tolist()))
    assert found == [(0, [-1, 8]), (4, [7, -1])]


def test_a_wait_takes_whole_cycles_at_rest() -> None:
    state = state_of()
    give_to_path(state, 0)
    append_wait(state.seg, state.paths, 0, 0.0025, -1, 1, 0)
    append_line(state.seg, state.paths, 0, state.limits, np.array([5.0, 0.0]), 50.0, 0, 2)
    finish(state)
    assert run_until(state, PATH_RESTED) == 3 + 150


def test_a_path_that_runs_out_of_planned_segments_says_so() -> None:
    state = state_of()
    state.paths.row[0]["low_water"] = 2
    lines(state, *((float(i), 0.0) for i in range(1, 40)), closed=False)
    run_until(state, QUEUE_LOW)
    row = state.paths.row[0]
    assert row["planned"] - row["head"] == 2


def test_a_soft_limit_is_told_in_the_cycle_that_passes_it() -> None:
    state = state_of()
    state.switches.marks[0]["soft_high"] = 5.0
    state.switches.marks[0]["soft_enabled"] = 1
    move(state, 0, 10.0)
    run_until(state, SOFT_LIMIT)
    assert 5.0 < state.setpoint[0] <= 5.0 + 50.0 * CYCLE_S


def test_a_switch_edge_is_told_with_its_axis() -> None:
    state = state_of()
    state.switches.switch[1, 2]["on_from"], state.switches.switch[1, 2]["on_to"] = 3.0, 4.0
    move(state, 1, 10.0)
    run_until(state, SWITCH_EDGE)
    assert (int(state.clock[0]["axis"]), int(state.switches.rising[1, 2])) == (1, 1)
    run_until(state, SWITCH_EDGE)
    assert int(state.switches.falling[1, 2]) == 1
    assert state.servo.actual[1] > 4.0


def test_a_following_error_above_its_limit_is_told() -> None:
    state = state_of()
    state.servo.row[0]["mode"] = PIDF
    state.servo.row[0]["kp"] = 10.0
    state.servo.row[0]["following_error_limit"] = 1.0
    move(state, 0, 50.0)
    run_until(state, FOLLOWING_ERROR)
    assert 1.0 < state.setpoint[0] - state.servo.actual[0] < 1.1
    assert state.clock[0]["axis"] == 0


def test_an_axis_is_in_position_only_where_no_source_moves_it() -> None:
    state = state_of()
    state.servo.row["in_position_window"] = 0.02
    move(state, 1, 3.7)
    advance(state, 30)
    assert state.servo.row["in_position"].tolist() == [1, 0]
    run_until(state, PROFILE_ENDED)
    advance(state, 2)
    assert state.servo.row["in_position"].tolist() == [1, 1]


def test_an_axis_is_placed_and_no_other() -> None:
    state = state_of(3)
    place_machine(state, 0, 4.25)
    place_machine(state, 2, -2.75)
    assert state.setpoint.tolist() == state.servo.actual.tolist() == [4.25, 0.0, -2.75]
    advance(state, 5)
    assert state.setpoint.tolist() == state.servo.actual.tolist() == [4.25, 0.0, -2.75]


def test_a_full_recorder_is_told() -> None:
    state = state_of(record_cycles=25)
    assert run_until(state, RECORDER_FULL) == 25


def test_prescribed_end_speeds_replace_the_look_ahead() -> None:
    state = state_of(record_cycles=4000)
    give_to_path(state, 0)
    for tag in range(1, 4):
        append_line(state.seg, state.paths, 0, state.limits, np.array([10.0 * tag, 0.0]), 50.0, 0, tag)
        state.seg.row[tag - 1]["end_speed"] = (20.0, 35.0, 0.0)[tag - 1]
    finish(state)
    run_until(state, PATH_RESTED)
    rows = state.recorder.rows[: int(state.recorder.filled[0])]
    for at, speed in ((10.0, 20.0), (20.0, 35.0)):
        crossing = int(np.searchsorted(rows[:, 4], at))
        assert rows[crossing - 1 : crossing + 1, 2] == pytest.approx([speed, speed], abs=1000.0 * CYCLE_S)
    assert state.setpoint[0] == 30.0


def test_the_cycle_may_be_that_of_another_controller() -> None:
    state = make_state(2, cycle_s=0.00128, segments=16)
    state.limits.speed[:] = 100.0
    state.limits.acceleration[:] = 100.0
    give_to_path(state, 0)
    append_line(state.seg, state.paths, 0, state.limits, np.array([100.0, 0.0]), 50.0, 0, 1)
    state.paths.row[0]["closed"] = 1
    prepare_path(state.seg, state.paths, 0, state.limits, 0.00128, state.work)
    start_path(state.paths, 0)
    # 0.5 s up, 1.5 s at 50 mm/s, 0.5 s down.
    assert run_until(state, PATH_RESTED) == math.ceil(2.5 / 0.00128)


def test_an_arc_stays_on_its_circle_and_ends_on_its_point() -> None:
    state = state_of(record_cycles=4000)
    give_to_path(state, 0)
    append_line(state.seg, state.paths, 0, state.limits, np.array([3.0, -2.0]), 40.0, 0, 1)
    end = np.array([13.0, 8.0])
    append_arc(state.seg, state.paths, 0, state.limits, end, 0, 1, 3.0, 8.0, math.pi / 2, 40.0, 0, 2)
    finish(state)
    run_until(state, PATH_RESTED)
    rows = state.recorder.rows[: int(state.recorder.filled[0])]
    x, y = rows[rows[:, 1] == 2.0][:, 4:6].T
    assert len(x) > 300
    assert np.max(np.abs(np.hypot(x - 3.0, y - 8.0) - 10.0)) <= 1e-9 * 10.0
    assert np.all(x >= 3.0 - 1e-12)
    assert np.all(y <= 8.0 + 1e-12)
    assert state.setpoint.tolist() == [13.0, 8.0]
