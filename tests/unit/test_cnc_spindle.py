"""The spindle: ramps, override, speed reached, angle and orientation, by numbers worked out by hand."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc.cnc import ControlError, Spindle
from polycnc.machine import Clock, MachineConfig, load_machine

AXIS = {"name": "X", "vmax_mm_s": 100, "amax_mm_s2": 1000}


def machine(times: dict[str, float] | None = None, **spindle: float) -> MachineConfig:
    return MachineConfig.model_validate(
        {"name": "m", "axis": (AXIS,), "spindle": {"max_rpm": 8000, **spindle}, "times": times or {}}
    )


def test_it_ramps_with_the_acceleration_of_the_machine_file() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine(acceleration_rpm_s=2000.0))
    spindle.turn(rpm=3000.0, direction=1)
    clock.tick(750)
    state = spindle.state()
    assert state.actual_rpm == pytest.approx(1500.0)
    assert not state.reached
    assert state.commanded_rpm == 3000.0
    # Half of 1500 rpm (9000 deg/s) for 0.75 s: 3375 degree, 135 after nine turns.
    assert state.angle_deg == pytest.approx(135.0)
    clock.tick(749)
    assert not spindle.state().reached
    clock.tick(1)
    assert spindle.state().reached
    assert spindle.state().actual_rpm == 3000.0


def test_without_an_acceleration_every_change_takes_the_starting_time() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine({"spindle_start_s": 1.5}))
    spindle.turn(rpm=1234.0, direction=-1)
    assert spindle.reached_cycle() == 1500
    clock.tick(1500)
    assert spindle.state().actual_rpm == -1234.0
    spindle.turn(direction=0)
    clock.tick(500)
    assert spindle.state().actual_rpm == pytest.approx(-1234.0 * 2.0 / 3.0)
    assert spindle.reached_cycle() == 3000


def test_without_any_time_it_turns_at_once() -> None:
    spindle = Spindle(Clock(0.001), machine())
    spindle.turn(rpm=700.0, direction=1)
    assert spindle.state().actual_rpm == 700.0
    assert spindle.state().reached


def test_the_override_ramps_and_the_highest_speed_holds() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine({"spindle_start_s": 2.0}))
    spindle.turn(rpm=6000.0, direction=1)
    clock.tick(2000)
    spindle.set_override(1.2)
    assert spindle.state().commanded_rpm == 7200.0
    # 1200 of 8000 rpm: 0.15 of the starting time.
    assert spindle.reached_cycle() == 2300
    spindle.set_override(2.0)
    assert spindle.state().commanded_rpm == 8000.0
    assert spindle.state().programmed_rpm == 6000.0
    spindle.set_override(0.0)
    clock.tick(5000)
    assert spindle.state().actual_rpm == 0.0
    assert spindle.state().direction == 1


def test_speed_reached_may_have_a_band() -> None:
    spindle = Spindle(Clock(0.001), machine(acceleration_rpm_s=1000.0, reached_share=0.15))
    spindle.turn(rpm=2000.0, direction=1)
    assert spindle.reached_cycle() == 1700


def test_a_change_that_changes_no_speed_is_reached_at_once() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine({"spindle_start_s": 1.5}, reached_share=0.07))
    spindle.turn(rpm=9100.0, direction=1)
    assert spindle.reached_cycle() == 1395  # 93 % of the way to 8000
    clock.tick(1600)
    spindle.set_override(1.3)  # beyond the highest speed before and after
    assert spindle.state().actual_rpm == pytest.approx(8000.0)
    assert spindle.state().reached


def test_an_orientation_from_full_turn_begins_with_the_speed_that_it_has() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine(acceleration_rpm_s=2500.0, orientation_rpm=90.0))
    spindle.turn(rpm=2000.0, direction=-1)
    clock.tick(900)
    spindle.orient(37.5)
    clock.tick(100)
    assert spindle.state().actual_rpm == pytest.approx(-1750.0)
    clock.tick(664)  # down to 90 rpm, of which some is left to turn
    assert spindle.state().actual_rpm == pytest.approx(-90.0, abs=1e-9)
    clock.tick(2000)
    assert spindle.state().actual_rpm == 0.0
    assert spindle.state().angle_deg == pytest.approx(37.5)


def test_a_change_in_the_middle_of_a_ramp_goes_on_from_the_speed_and_angle_there() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine(acceleration_rpm_s=1000.0))
    spindle.turn(rpm=1000.0, direction=1)
    clock.tick(400)
    before = spindle.state()
    spindle.turn(direction=-1)
    assert spindle.state().actual_rpm == before.actual_rpm == pytest.approx(400.0)
    assert spindle.state().angle_deg == before.angle_deg
    assert spindle.reached_cycle() == 400 + 1400


@given(
    rpm=st.floats(0.0, 8000.0),
    direction=st.sampled_from((-1, 0, 1)),
    wait=st.integers(0, 3000),
    angle=st.floats(-720.0, 720.0),
    acceleration=st.one_of(st.none(), st.floats(50.0, 20000.0)),
)
def test_an_orientation_ends_at_its_angle_at_rest_within_the_acceleration(
    rpm: float, direction: int, wait: int, angle: float, acceleration: float | None
) -> None:
    clock = Clock(0.001)
    keys = {} if acceleration is None else {"acceleration_rpm_s": acceleration}
    config = machine({"spindle_start_s": 0.7}, **keys)
    spindle = Spindle(clock, config)
    spindle.turn(rpm=rpm, direction=direction)
    clock.tick(wait)
    spindle.orient(angle)
    end = spindle.reached_cycle()
    last = spindle.state()
    allowed = 0.001 * (8000.0 / 0.7 if acceleration is None else acceleration) * 1.001 + 1e-6
    while clock.cycles < min(end - 1, wait + 60):
        clock.tick(1)
        state = spindle.state()
        assert abs(state.actual_rpm - last.actual_rpm) <= allowed
        # The angle moves with the mean of both speeds: 3 deg/s for each rpm of their sum.
        turned = 3.0 * (state.actual_rpm + last.actual_rpm) * 0.001
        assert abs((state.angle_deg - last.angle_deg - turned + 180.0) % 360.0 - 180.0) <= allowed
        last = state
    clock.tick(max(0, end - clock.cycles))
    state = spindle.state()
    assert state.oriented
    assert state.reached
    assert state.actual_rpm == 0.0
    assert state.angle_deg == angle % 360.0 % 360.0
    clock.tick(1234)
    assert spindle.state().angle_deg == angle % 360.0 % 360.0
    spindle.turn(direction=1)
    assert not spindle.state().oriented


def test_an_orientation_arrives_without_a_jump_of_the_angle() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine(acceleration_rpm_s=1500.0, orientation_rpm=90.0))
    spindle.turn(rpm=500.0, direction=-1)
    clock.tick(333)
    spindle.orient(211.0)
    clock.tick(spindle.reached_cycle() - clock.cycles - 1)
    # Less than a cycle before the end, at the last of the ramp.
    assert spindle.state().angle_deg == pytest.approx(211.0, abs=0.01)
    assert not spindle.state().oriented


def test_a_snapshot_takes_it_back() -> None:
    clock = Clock(0.001)
    spindle = Spindle(clock, machine(acceleration_rpm_s=900.0))
    spindle.turn(rpm=800.0, direction=1)
    saved = spindle.snapshot()
    clock.tick(300)
    expected = spindle.state()
    spindle.stop()
    spindle.restore(saved)
    assert spindle.state() == expected


@pytest.mark.parametrize("rpm", [-1.0, float("nan"), float("inf")])
def test_a_speed_that_cannot_be_is_refused_and_changes_nothing(rpm: float) -> None:
    spindle = Spindle(Clock(0.001), load_machine("mill3"))
    before = spindle.snapshot()
    with pytest.raises(ControlError, match="cannot turn"):
        spindle.turn(rpm=rpm, direction=1)
    with pytest.raises(ControlError, match="direction"):
        spindle.turn(rpm=5.0, direction=2)
    with pytest.raises(ControlError, match="override"):
        spindle.set_override(2.01)
    with pytest.raises(ControlError, match="cannot stop"):
        spindle.orient(float("inf"))
    assert spindle.snapshot() == before
