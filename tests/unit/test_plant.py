"""The simulated drive: exact first-order lag, motor limits, play and encoder."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy

from polycnc.kernel._plant import Plant, make_plant, measured, plant_cycle, plant_place

DT = 1e-3


def run(plant: Plant, commands: list[float], dt: float = DT) -> tuple[list[float], list[float]]:
    positions, velocities = [], []
    for command in commands:
        plant_cycle(0, plant, command, dt)
        positions.append(float(plant.row["position"][0]))
        velocities.append(float(plant.row["velocity"][0]))
    return positions, velocities


def test_without_lag_the_velocity_follows_at_once() -> None:
    plant = make_plant(1)
    positions, velocities = run(plant, [10.0, -4.0])
    assert velocities == [10.0, -4.0]
    assert positions == pytest.approx([0.01, 0.006], abs=1e-15)


def test_held_commands_give_the_continuous_response_of_the_lag() -> None:
    lag_s, gain = 0.02, 0.8
    plant = make_plant(1)
    plant.row["lag_s"][0] = lag_s
    plant.row["gain"][0] = gain
    commands = [math.sin(0.3 * k) * 50.0 for k in range(200)]
    positions, velocities = run(plant, commands)
    system = scipy.signal.StateSpace(
        [[0, 1], [0, -1 / lag_s]], [[0], [gain / lag_s]], np.eye(2), np.zeros((2, 1))
    )
    _, expected, _ = scipy.signal.lsim(system, commands + [0.0], np.arange(201) * DT, interp=False)
    assert positions == pytest.approx(expected[1:, 0], abs=1e-11)
    assert velocities == pytest.approx(expected[1:, 1], abs=1e-10)


def test_step_reaches_63_percent_after_one_time_constant() -> None:
    plant = make_plant(1)
    plant.row["lag_s"][0] = 0.05
    _, velocities = run(plant, [100.0] * 50)
    assert velocities[-1] == pytest.approx(100.0 * (1.0 - 1.0 / math.e), rel=1e-12)


def test_dead_drive_coasts_by_velocity_times_lag() -> None:
    plant = make_plant(1)
    plant.row["lag_s"][0] = 0.05
    plant.row["gain"][0] = 0.0
    plant_place(0, plant, 7.0, 20.0)
    positions, velocities = run(plant, [20.0] * 2000)
    assert positions[-1] == pytest.approx(7.0 + 20.0 * 0.05, abs=1e-12)
    assert abs(velocities[-1]) < 1e-12


def test_velocity_limit_caps_both_directions() -> None:
    plant = make_plant(1)
    plant.row["velocity_limit"][0] = 30.0
    _, velocities = run(plant, [100.0, -100.0, 29.0])
    assert velocities == [30.0, -30.0, 29.0]


def test_acceleration_limit_without_lag_is_a_ramp_that_ends_inside_a_cycle() -> None:
    plant = make_plant(1)
    plant.row["acceleration_limit"][0] = 1000.0
    positions, velocities = run(plant, [2.5] * 4)
    assert velocities == pytest.approx([1.0, 2.0, 2.5, 2.5], abs=1e-14)
    # 2.5 units/s are reached after 2.5 ms and 2.5^2 / 2000 units.
    assert positions[2:] == pytest.approx([3.125e-3 + 0.5e-3 * 2.5, 3.125e-3 + 1.5e-3 * 2.5], abs=1e-15)


def test_acceleration_limit_with_lag_agrees_with_fine_integration() -> None:
    lag_s, top, target = 0.01, 800.0, 40.0
    plant = make_plant(1)
    plant.row["lag_s"][0] = lag_s
    plant.row["acceleration_limit"][0] = top
    positions, velocities = run(plant, [target] * 80)
    steps = 200
    x = v = 0.0
    for k in range(80):
        for _ in range(steps):
            h = DT / steps
            middle = v + 0.5 * h * max(-top, min(top, (target - v) / lag_s))
            x += h * middle
            v += h * max(-top, min(top, (target - middle) / lag_s))
        assert velocities[k] == pytest.approx(v, abs=2e-5)
        assert positions[k] == pytest.approx(x, abs=2e-6)
    assert velocities[0] == pytest.approx(top * DT, rel=1e-14)


def test_play_is_lost_once_per_reversal() -> None:
    plant = make_plant(1)
    plant.row["backlash"][0] = 0.2
    plant_cycle(0, plant, 1000.0, DT)
    assert plant.row["drive_position"][0] == pytest.approx(1.0)
    assert plant.row["position"][0] == pytest.approx(0.9)
    plant_cycle(0, plant, -150.0, DT)
    assert plant.row["position"][0] == pytest.approx(0.9), "inside the play the load stands still"
    plant_cycle(0, plant, -150.0, DT)
    assert plant.row["drive_position"][0] == pytest.approx(0.7)
    assert plant.row["position"][0] == pytest.approx(0.8)


def test_encoder_on_the_motor_does_not_see_the_play() -> None:
    plant = make_plant(1)
    plant.row["backlash"][0] = 0.2
    plant_cycle(0, plant, 1000.0, DT)
    assert measured(0, plant) == pytest.approx(0.9)
    plant.row["motor_encoder"][0] = 1
    assert measured(0, plant) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("position", "shown"),
    [
        (0.0, 0.0),
        (0.12, 0.0),
        (0.125, 0.25),
        (0.37, 0.25),
        (0.375, 0.5),
        (-0.12, 0.0),
        (-0.125, 0.0),
        (-0.13, -0.25),
    ],
)
def test_encoder_shows_the_nearest_step_and_rounds_half_up(position: float, shown: float) -> None:
    plant = make_plant(1)
    plant.row["resolution"][0] = 0.25
    plant_place(0, plant, position, 0.0)
    assert measured(0, plant) == shown


def test_axes_do_not_touch_each_other() -> None:
    plant = make_plant(3)
    plant_cycle(1, plant, 5.0, DT)
    assert plant.row["position"].tolist() == [0.0, 0.005, 0.0]
    assert plant.row["velocity"].tolist() == [0.0, 5.0, 0.0]
    plant_place(2, plant, 3.7, -1.9)
    assert plant.row["position"].tolist() == [0.0, 0.005, 3.7]
    assert plant.row["drive_position"].tolist() == [0.0, 0.005, 3.7]
    assert plant.row["velocity"].tolist() == [0.0, 5.0, -1.9]
    assert [measured(i, plant) for i in range(3)] == [0.0, 0.005, 3.7]


def test_changed_lag_takes_effect_in_the_next_cycle() -> None:
    plant = make_plant(1)
    for lag_s in (0.01, 0.05, 0.0):
        plant.row["lag_s"][0] = lag_s
        before = float(plant.row["velocity"][0])
        plant_cycle(0, plant, 10.0, DT)
        share = 1.0 if lag_s == 0.0 else -math.expm1(-DT / lag_s)
        assert plant.row["velocity"][0] == pytest.approx(before + (10.0 - before) * share, rel=1e-14)
