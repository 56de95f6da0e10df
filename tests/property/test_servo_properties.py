"""What holds for every drive, loop, switch and coupling, whatever the numbers."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from polycnc.kernel._plant import make_plant, measured, plant_cycle, plant_place
from polycnc.kernel._servo import PIDF, make_servo, servo_cycle
from polycnc.kernel._switches import index_crossings
from support.often import share

DT = 1e-3

some = settings(deadline=None, max_examples=share(60))


def between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, allow_infinity=False)


def zero_or(low: float, high: float) -> st.SearchStrategy[float]:
    return st.one_of(st.just(0.0), between(low, high))


@some
@given(
    lag_s=zero_or(1e-5, 1.0),
    acceleration=zero_or(1.0, 1e5),
    start=between(-100.0, 100.0),
    command=between(-100.0, 100.0),
    cut=between(0.01, 0.99),
)
def test_drive_does_not_depend_on_how_time_is_cut(
    lag_s: float, acceleration: float, start: float, command: float, cut: float
) -> None:
    plant = make_plant(2)
    plant.row["lag_s"][:] = lag_s
    plant.row["acceleration_limit"][:] = acceleration
    plant_place(0, plant, 0.0, start)
    plant_place(1, plant, 0.0, start)
    plant_cycle(0, plant, command, DT)
    plant_cycle(1, plant, command, cut * DT)
    plant_cycle(1, plant, command, DT - cut * DT)
    assert plant.row["velocity"][0] == pytest.approx(plant.row["velocity"][1], abs=1e-9)
    assert plant.row["position"][0] == pytest.approx(plant.row["position"][1], abs=1e-12)


@some
@given(
    lag_s=zero_or(1e-4, 0.1),
    acceleration=zero_or(10.0, 1e4),
    top=zero_or(1.0, 50.0),
    backlash=zero_or(1e-4, 1.0),
    resolution=zero_or(1e-5, 0.1),
    commands=st.lists(between(-100.0, 100.0), min_size=1, max_size=30),
)
def test_drive_stays_within_its_limits_its_play_and_its_encoder_step(
    lag_s: float, acceleration: float, top: float, backlash: float, resolution: float, commands: list[float]
) -> None:
    plant = make_plant(1)
    plant.row["lag_s"][0] = lag_s
    plant.row["acceleration_limit"][0] = acceleration
    plant.row["velocity_limit"][0] = top
    plant.row["backlash"][0] = backlash
    plant.row["resolution"][0] = resolution
    for command in commands:
        before = float(plant.row["velocity"][0])
        plant_cycle(0, plant, command, DT)
        change = float(plant.row["velocity"][0]) - before
        if acceleration > 0.0:
            assert abs(change) <= acceleration * DT * (1.0 + 1e-9) + 1e-12
        if top > 0.0:
            assert abs(plant.row["velocity"][0]) <= top * (1.0 + 1e-12)
        assert abs(plant.row["drive_position"][0] - plant.row["position"][0]) <= 0.5 * backlash + 1e-12
        assert abs(measured(0, plant) - plant.row["position"][0]) <= 0.5 * resolution + 1e-12


@some
@given(
    kp=zero_or(1.0, 1e3),
    ki=zero_or(1.0, 1e4),
    kd=zero_or(1e-3, 10.0),
    kpl=between(0.0, 1.0),
    limit=between(0.1, 100.0),
    setpoints=st.lists(between(-10.0, 10.0), min_size=2, max_size=40),
    gain=st.sampled_from([0.0, 1.0]),
)
def test_output_and_integral_stay_within_reach_of_the_limit(
    kp: float, ki: float, kd: float, kpl: float, limit: float, setpoints: list[float], gain: float
) -> None:
    servo, plant = make_servo(1), make_plant(1)
    servo.row["mode"][0] = PIDF
    plant.row["gain"][0] = gain
    for name, value in {"kp": kp, "ki": ki, "kd": kd, "kpl": kpl, "output_limit": limit}.items():
        servo.row[name] = value
    for setpoint in setpoints:
        integral = abs(float(servo.row["integral"][0]))
        servo_cycle(0, servo, plant, setpoint, 0.0, 0.0, DT)
        assert abs(servo.row["output"][0]) <= limit
        # It grows only while the sum of all parts is inside the limit.
        error = abs(float(servo.row["following_error"][0]))
        others = kp * error + kd * 20.0 / DT * 3.0
        assert abs(servo.row["integral"][0]) <= max(integral, limit + others) + 1e-9


@some
@given(
    kp=between(1.0, 300.0),
    lag_share=between(0.0, 0.2),
    velocity=between(-100.0, 100.0),
    gain=between(0.2, 3.0),
)
def test_full_feed_forward_follows_every_ramp_without_error(
    kp: float, lag_share: float, velocity: float, gain: float
) -> None:
    servo, plant = make_servo(1), make_plant(1)
    servo.row["mode"][0] = PIDF
    servo.row["kp"][0] = kp / gain
    servo.row["kfcv"][0] = 1.0 / gain
    plant.row["gain"][0] = gain
    plant.row["lag_s"][0] = lag_share / kp
    for k in range(200):
        servo_cycle(0, servo, plant, velocity * k * DT, velocity, 0.0, DT)
    first_cycles_error = abs(velocity) * (2.0 * DT + lag_share / kp)
    assert abs(servo.row["following_error"][0]) <= first_cycles_error * math.exp(-0.15 * kp / 2.0) + 1e-9


@some
@given(
    pitch=between(0.01, 5.0),
    origin=between(-5.0, 5.0),
    places=st.lists(between(-20.0, 20.0), min_size=2, max_size=20),
)
def test_index_pulses_on_a_way_there_and_back_cancel(
    pitch: float, origin: float, places: list[float]
) -> None:
    pulses = origin + pitch * np.arange(-3000, 3001)
    total = 0
    for last, now in pairwise(places):
        low, high = min(last, now), max(last, now)
        assume(not np.any(np.abs(pulses - last) < 1e-9))
        assume(not np.any(np.abs(pulses - now) < 1e-9))
        crossed, first = index_crossings(origin, pitch, now, last)
        between_them = pulses[(pulses > low) & (pulses < high)]
        assert abs(crossed) == len(between_them)
        if crossed:
            assert first == pytest.approx(between_them[0] if now > last else between_them[-1], abs=1e-9)
            assert (crossed > 0) == (now > last)
        total += crossed
    back, _ = index_crossings(origin, pitch, places[0], places[-1])
    assert total + back == 0
