"""The position loop against independent simulations, and its switches, limits and monitors."""

from __future__ import annotations

import copy
import hashlib
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import scipy

from polycnc.kernel._plant import Plant, make_plant
from polycnc.kernel._servo import (
    IDEAL,
    PIDF,
    SERVO_ROW,
    Servo,
    filter_lag_s,
    make_servo,
    servo_cycle,
    servo_place,
)

DT = 1e-3
SCAN_S = 1.28e-3


def loop(**settings: float) -> tuple[Servo, Plant]:
    """Return one axis in PIDF mode; a setting is a column of the servo or the plant."""
    servo, plant = make_servo(1), make_plant(1)
    servo.row["mode"][0] = PIDF
    for name, value in settings.items():
        (servo.row if name in (SERVO_ROW.names or ()) else plant.row)[name] = value
    return servo, plant


def follow(
    servo: Servo, plant: Plant, setpoints: npt.ArrayLike, velocity: float = 0.0, dt: float = DT
) -> npt.NDArray[np.float64]:
    """Run the setpoints and return ``[cycles, 3]``: actual, following error, output."""
    rows = []
    for setpoint in np.asarray(setpoints, dtype=np.float64):
        servo_cycle(0, servo, plant, setpoint, velocity, 0.0, dt)
        rows.append((servo.actual[0], servo.row["following_error"][0], servo.row["output"][0]))
    return np.array(rows)


def sampled_filter(kp: float, ki: float, kd: float, kpl: float, dt: float) -> tuple[list[float], list[float]]:
    """Return the z polynomials of the filter: trapezoidal integral, difference, lag for straight lines."""
    pid = np.array([kp + 0.5 * ki * dt + kd / dt, 0.5 * ki * dt - kp - 2.0 * kd / dt, kd / dt])
    lag_s = (1.0 - kpl) * dt / 2.0
    if lag_s == 0.0:
        return list(pid), [1.0, -1.0, 0.0]
    num, den, _ = scipy.signal.cont2discrete(([1.0], [lag_s, 1.0]), dt, method="foh")
    return list(np.polymul(pid, num[0])), list(np.polymul([1.0, -1.0, 0.0], den))


COEFFICIENTS = [
    (40.0, 0.0, 0.0, 0.0, 0.0),
    (40.0, 0.0, 0.0, 1.0, 0.01),
    (60.0, 300.0, 0.0, 0.0, 0.0),
    (60.0, 300.0, 0.2, 0.5, 0.01),
    (120.0, 2000.0, 0.4, 0.95, 0.004),
]


@pytest.mark.parametrize(("kp", "ki", "kd", "kpl", "lag_s"), COEFFICIENTS)
def test_step_response_equals_the_sampled_linear_system(
    kp: float, ki: float, kd: float, kpl: float, lag_s: float
) -> None:
    gain, cycles = 0.9, 400
    drive = ([gain], [1.0, 0.0]) if lag_s == 0.0 else ([gain], [lag_s, 1.0, 0.0])
    num_p, den_p, _ = scipy.signal.cont2discrete(drive, DT, method="zoh")
    num_c, den_c = sampled_filter(kp, ki, kd, kpl, DT)
    ahead = np.polymul(num_c, num_p[0])
    closed = scipy.signal.dlti(ahead, np.polyadd(np.polymul(den_c, den_p), ahead), dt=DT)
    _, (expected,) = scipy.signal.dstep(closed, n=cycles)
    servo, plant = loop(kp=kp, ki=ki, kd=kd, kpl=kpl, lag_s=lag_s, gain=gain)
    follow(servo, plant, [0.0])
    got = follow(servo, plant, np.ones(cycles))
    assert got[:, 0] == pytest.approx(expected[:, 0], abs=1e-9)


def test_small_cycles_approach_the_continuous_loop() -> None:
    kp, ki, kd, lag_s, dt = 30.0, 100.0, 0.1, 0.02, 2e-5
    closed = scipy.signal.TransferFunction([kd, kp, ki], [lag_s, 1.0 + kd, kp, ki])
    times = np.arange(4000) * dt
    _, expected = scipy.signal.step(closed, T=times)
    servo, plant = loop(kp=kp, ki=ki, kd=kd, lag_s=lag_s)
    follow(servo, plant, [0.0], dt=dt)
    got = follow(servo, plant, np.ones(4000), dt=dt)
    assert got[:, 0] == pytest.approx(expected, abs=3e-3)


def test_proportional_loop_follows_a_ramp_with_error_velocity_over_kp() -> None:
    servo, plant = loop(kp=50.0, lag_s=0.004)
    got = follow(servo, plant, 20.0 * DT * np.arange(1500), velocity=20.0)
    assert got[-1, 1] == pytest.approx(20.0 / 50.0, rel=1e-9)
    assert servo.row["actual_velocity"][0] == pytest.approx(20.0, rel=1e-9)


@pytest.mark.parametrize("gain", [1.0, 0.5])
def test_full_velocity_feed_forward_leaves_no_error(gain: float) -> None:
    servo, plant = loop(kp=50.0, lag_s=0.004, gain=gain, kfcv=1.0 / gain)
    got = follow(servo, plant, 20.0 * DT * np.arange(1500), velocity=20.0)
    assert abs(got[-1, 1]) < 1e-9


def test_partial_velocity_feed_forward_leaves_its_share() -> None:
    servo, plant = loop(kp=50.0, kfcv=0.75)
    got = follow(servo, plant, 20.0 * DT * np.arange(1500), velocity=20.0)
    assert got[-1, 1] == pytest.approx(0.25 * 20.0 / 50.0, rel=1e-9)


@pytest.mark.parametrize("kfca", [0.0, 0.012, 0.0130])
def test_acceleration_feed_forward_takes_away_the_lag_of_the_drive(kfca: float) -> None:
    kp, lag_s, acceleration = 50.0, 0.012, 100.0
    servo, plant = loop(kp=kp, kfcv=1.0, kfca=kfca, lag_s=lag_s)
    for k in range(1500):
        t = k * DT
        servo_cycle(0, servo, plant, 0.5 * acceleration * t * t, acceleration * t, acceleration, DT)
    # What is late: the drive, the command held over a cycle (half of it), the filter's lag (the other half).
    late_s = lag_s + 0.5 * DT + 0.5 * DT
    assert servo.row["following_error"][0] == pytest.approx(acceleration * (late_s - kfca) / kp, abs=1e-9)


@pytest.mark.covers("apci.ctrl.kpl")
@pytest.mark.parametrize(
    ("kpl", "lag_ms"), [(0.0, 0.64), (0.5, 0.32), (0.95, 0.032), (1.0, 0.0), (-1.0, 0.64), (2.0, 0.0)]
)
def test_kpl_shortens_the_lag_of_half_a_scan(kpl: float, lag_ms: float) -> None:
    lag_s = filter_lag_s(kpl, SCAN_S)
    assert lag_s == pytest.approx(lag_ms * 1e-3, abs=1e-15)
    # A jammed drive makes the filter visible: error = setpoint, output = lagged kp * error.
    servo, plant = loop(kp=1.0, kpl=kpl, gain=0.0)
    follow(servo, plant, [0.0], dt=SCAN_S)
    ramp = follow(servo, plant, 3.0 * SCAN_S * np.arange(1, 60), dt=SCAN_S)
    assert ramp[-1, 1] - ramp[-1, 2] == pytest.approx(3.0 * lag_ms * 1e-3, abs=1e-14), (
        "late by the time constant"
    )
    servo, plant = loop(kp=1.0, kpl=kpl, gain=0.0)
    follow(servo, plant, [0.0], dt=SCAN_S)
    missing = 1.0 - follow(servo, plant, np.ones(4), dt=SCAN_S)[:, 2]
    decay = math.exp(-SCAN_S / lag_s) if lag_s > 1e-12 else 0.0
    assert missing[1:] == pytest.approx(missing[:-1] * decay, abs=1e-15)
    if kpl >= 0.95:
        assert missing[1] < 1e-15, "nothing is left of the lag after one scan: a larger kpl gains nothing"


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        ({"kp": 4.0}, [8.0, 12.0]),
        ({"ki": 10.0}, [10.0 * DT, 10.0 * DT * 3.5]),
        ({"kd": 0.5}, [0.5 * 2.0 / DT, 0.5 * 1.0 / DT]),
        ({"kfcv": 0.3}, [2.1, 2.1]),
        ({"kfca": 0.2}, [1.0, 1.0]),
        ({}, [0.0, 0.0]),
    ],
)
def test_each_part_acts_alone_and_zero_switches_it_off(part: dict[str, float], expected: list[float]) -> None:
    """Errors 0, 2, 3 on a jammed drive, setpoint velocity 7 and acceleration 5."""
    servo, plant = loop(kpl=1.0, gain=0.0, **part)
    servo_cycle(0, servo, plant, 0.0, 0.0, 0.0, DT)
    outputs = []
    for setpoint in (2.0, 3.0):
        servo_cycle(0, servo, plant, setpoint, 7.0, 5.0, DT)
        outputs.append(float(servo.row["output"][0]))
    assert outputs == pytest.approx(expected, rel=1e-12)


def test_integral_doubles_the_output_after_the_textbook_reset_time() -> None:
    kp, reset_s = 5.0, 0.25
    servo, plant = loop(kp=kp, ki=kp / reset_s, kpl=1.0, gain=0.0)
    got = follow(servo, plant, np.full(251, 0.4))
    assert got[0, 2] == pytest.approx(kp * 0.4 * (1.0 + DT / reset_s), rel=1e-12), (
        "the first cycle counts in full"
    )
    assert got[249, 2] == pytest.approx(2.0 * kp * 0.4, rel=1e-12)


def test_derivative_is_ahead_of_a_ramp_by_the_textbook_time() -> None:
    kp, ahead_s = 5.0, 0.02
    servo, plant = loop(kp=kp, kd=kp * ahead_s, kpl=1.0, gain=0.0)
    error = 3.0 * DT * np.arange(50)
    got = follow(servo, plant, error)
    assert got[1:, 2] == pytest.approx(kp * (error[1:] + 3.0 * ahead_s), rel=1e-12)


def test_new_integral_coefficient_does_not_jump_and_zero_forgets() -> None:
    servo, plant = loop(ki=20.0, kpl=1.0, gain=0.0)
    before = follow(servo, plant, np.ones(100))[-1, 2]
    servo.row["ki"][0] = 500.0
    assert follow(servo, plant, [1.0])[0, 2] == pytest.approx(before + 500.0 * DT, rel=1e-12)
    servo.row["ki"][0] = 0.0
    assert follow(servo, plant, [1.0])[0, 2] == 0.0
    servo.row["ki"][0] = 20.0
    assert follow(servo, plant, [1.0])[0, 2] == pytest.approx(20.0 * DT, rel=1e-12)


def test_derivative_switched_on_late_knows_the_last_error() -> None:
    servo, plant = loop(kpl=1.0, gain=0.0)
    follow(servo, plant, [0.0, 1.0, 5.0, 5.0])
    servo.row["kd"][0] = 3.0
    assert follow(servo, plant, [5.0])[0, 2] == 0.0
    assert follow(servo, plant, [5.001])[0, 2] == pytest.approx(3.0, rel=1e-9)


def test_lag_changed_in_a_steady_state_does_not_move_the_output() -> None:
    servo, plant = loop(kp=2.0, kpl=0.3, gain=0.0)
    follow(servo, plant, np.ones(100))
    for kpl in (0.0, 0.9, 1.0, 0.5):
        servo.row["kpl"][0] = kpl
        assert follow(servo, plant, [1.0, 1.0])[:, 2] == pytest.approx([2.0, 2.0], abs=1e-15)


def test_integral_stands_still_at_the_output_limit() -> None:
    servo, plant = loop(kp=1.0, ki=100.0, output_limit=5.0, gain=0.0)
    got = follow(servo, plant, np.ones(1000))
    assert got[-1, 2] <= 5.0
    assert got[-1, 2] == pytest.approx(5.0, abs=0.1)
    assert servo.row["integral"][0] <= 4.0
    released = follow(servo, plant, -np.ones(100))
    # 4 units/s of integral run down at 100 per second: under 50 cycles, not the second spent at the limit.
    assert released[0, 2] < 5.0
    assert released[49, 2] < 0.0


def test_output_limit_holds_for_every_part_and_in_open_loop() -> None:
    servo, plant = loop(kp=1.0, kd=1.0, kfcv=10.0, output_limit=5.0, gain=0.0)
    got = follow(servo, plant, [0.0, 3.0, -3.0, 100.0, -100.0], velocity=7.0)
    assert np.all(np.abs(got[:, 2]) <= 5.0)
    servo.row["loop_closed"][0] = 0
    servo.row["command"][0] = -80.0
    assert follow(servo, plant, [0.0])[0, 2] == -5.0


def test_ideal_servo_is_the_setpoint_bit_for_bit() -> None:
    servo, plant = loop(mode=IDEAL, resolution=0.01, backlash=0.5, lag_s=0.1)
    for setpoint in np.random.default_rng(3).normal(0.0, 100.0, 100):
        servo_cycle(0, servo, plant, setpoint, 2.5, 0.0, DT)
        assert servo.actual[0] == setpoint
        assert servo.row["following_error"][0] == 0.0
        assert servo.row["actual_velocity"][0] == 2.5


def test_ideal_servo_hands_a_moving_axis_over_to_the_filter() -> None:
    servo, plant = loop(mode=IDEAL, kp=50.0, kd=0.1, kfcv=1.0, lag_s=0.02)
    track = 20.0 * DT * np.arange(200)
    follow(servo, plant, track[:100], velocity=20.0)
    servo.row["mode"][0] = PIDF
    got = follow(servo, plant, track[100:], velocity=20.0)
    assert np.max(np.abs(got[:, 1])) < 1e-12


def test_open_loop_holds_the_command_and_coasts_without_one() -> None:
    servo, plant = loop(kp=50.0, lag_s=0.02, loop_closed=0, command=10.0)
    got = follow(servo, plant, np.full(501, 99.0))
    assert set(got[:, 2]) == {10.0}
    assert servo.row["actual_velocity"][0] == pytest.approx(10.0, rel=1e-9)
    assert got[-1, 0] == pytest.approx(10.0 * (0.5 - 0.02), rel=1e-9)
    servo.row["command"][0] = 0.0
    end = follow(servo, plant, np.zeros(1000))
    # One more cycle at 10 units/s before the new command is out, then velocity times lag.
    assert end[-1, 0] - got[-1, 0] == pytest.approx(10.0 * DT + 10.0 * 0.02, rel=1e-9)


def test_closing_the_loop_on_the_actual_position_does_not_kick() -> None:
    servo, plant = loop(kp=50.0, ki=30.0, kd=5.0, loop_closed=0, command=3.0)
    follow(servo, plant, np.full(200, 12.0))
    servo.row["command"][0] = 0.0
    follow(servo, plant, np.full(2, 12.0))
    servo.row["loop_closed"][0] = 1
    here = float(servo.actual[0])
    got = follow(servo, plant, np.full(20, here))
    assert got[:, 1:] == pytest.approx(np.zeros((20, 2)), abs=1e-12)


def test_following_error_trips_only_beyond_a_limit_in_a_closed_loop() -> None:
    servo, plant = loop(gain=0.0)
    follow(servo, plant, [5.0])
    assert servo.error_tripped[0] == 0, "no limit, no monitor"
    servo.row["following_error_limit"][0] = 5.0
    servo.row["loop_closed"][0] = 0
    follow(servo, plant, [50.0])
    assert servo.error_tripped[0] == 0, "open loop"
    servo.row["loop_closed"][0] = 1
    follow(servo, plant, [5.0, -5.0])
    assert servo.error_tripped[0] == 0, "at the limit is not beyond it"
    follow(servo, plant, [-5.001, 0.0])
    assert servo.error_tripped[0] == 1, "stays until the caller clears it"
    servo.error_tripped[0] = 0
    follow(servo, plant, [0.0])
    assert servo.error_tripped[0] == 0


def test_in_position_needs_a_window_a_finished_profile_and_a_small_error() -> None:
    servo, plant = loop(gain=0.0)
    follow(servo, plant, [0.0])
    assert servo.row["in_position"][0] == 0, "no window"
    servo.row["in_position_window"][0] = 0.01
    seen = []
    for setpoint, at_rest in ((0.0, 1), (0.0099, 1), (-0.0099, 1), (0.01, 1), (0.0, 0), (0.0, 1)):
        servo.profile_at_rest[0] = at_rest
        follow(servo, plant, [setpoint])
        seen.append(int(servo.row["in_position"][0]))
    assert seen == [1, 1, 1, 0, 0, 1]


def test_place_puts_the_axis_down_at_rest() -> None:
    servo, plant = loop(kp=50.0, ki=9.0, kd=1.0, lag_s=0.02, resolution=0.25)
    follow(servo, plant, np.arange(50.0), velocity=8.0)
    servo_place(0, servo, plant, 3.0)
    got = follow(servo, plant, np.full(10, 3.0))
    assert got.tolist() == [[3.0, 0.0, 0.0]] * 10


def test_target_on_whole_encoder_steps_is_held_without_hunting() -> None:
    servo, plant = loop(kp=40.0, lag_s=0.003, resolution=0.001, in_position_window=0.0005)
    got = follow(servo, plant, np.full(1500, 1.0))
    assert got[-500:].tolist() == [[1.0, 0.0, 0.0]] * 500
    assert servo.row["in_position"][0] == 1


def busy_digest(cycles: int) -> str:
    """Return a digest of every number of three axes after a run that uses all parts of servo and plant."""
    servo, plant = make_servo(3), make_plant(3)
    servo.row["mode"][:] = (IDEAL, PIDF, PIDF)
    for name, value in {"kp": 45.0, "ki": 30.0, "kd": 0.05, "kpl": 0.4, "kfcv": 0.9, "kfca": 0.01}.items():
        servo.row[name] = value
    servo.row["output_limit"][2] = 40.0
    plant.row["lag_s"][:] = 0.007
    plant.row["acceleration_limit"][2] = 900.0
    plant.row["resolution"][2] = 0.001
    plant.row["backlash"][2] = 0.03
    digest = hashlib.sha256()
    for k in range(cycles):
        t = k * DT
        servo.row["loop_closed"][1] = 0 if 500 < k < 600 else 1
        for i in range(3):
            place = math.sin(9.0 * t) * 20.0
            servo_cycle(i, servo, plant, place, math.cos(9.0 * t) * 180.0, -81.0 * place, DT)
    for array in (*servo, *plant):
        digest.update(array.tobytes())
    return digest.hexdigest()


def test_uncompiled_run_is_bit_identical() -> None:
    root = Path(__file__).resolve().parents[2]
    code = "import sys; sys.path[:0] = sys.argv[1:]; import test_servo; print(test_servo.busy_digest(800))"
    result = subprocess.run(
        [sys.executable, "-c", code, str(root / "src"), str(Path(__file__).parent)],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert result.stdout.strip() == busy_digest(800)


def test_copied_arrays_are_a_snapshot() -> None:
    servo, plant = loop(kp=45.0, ki=30.0, kd=0.05, kpl=0.4, lag_s=0.007, resolution=0.001, backlash=0.02)
    track = np.sin(0.02 * np.arange(400)) * 5.0
    follow(servo, plant, track[:200])
    saved = copy.deepcopy((servo, plant))
    first = follow(servo, plant, track[200:])
    assert np.array_equal(first, follow(*saved, track[200:]))
