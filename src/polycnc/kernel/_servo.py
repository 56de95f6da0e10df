"""The position loop of an axis: ideal, or a PIDF filter with feed-forward that commands a velocity.

One cycle is: the plant moves for the past cycle with the command it was given, the encoder is read, the
filter makes the next command from setpoint minus actual. So setpoint, actual and following error of a cycle
belong to one instant. Between these instants the filter takes the error, and its own sum, as straight lines.

Units: lengths in the axis' own unit (mm or deg), velocities per s, accelerations per s2, times in s.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._plant import Plant, drive_cycle, drive_measured, drive_place, limited

IDEAL = 0
PIDF = 1

SERVO_ROW = np.dtype(
    [
        # Written by the caller, in axis units and seconds; 0 switches a property off.
        ("mode", np.int64),  # IDEAL: actual = setpoint, bit for bit; or PIDF
        ("loop_closed", np.int64),
        ("kp", np.float64),  # 1/s, on the following error
        ("ki", np.float64),  # 1/s2
        ("kd", np.float64),  # 1
        ("kpl", np.float64),  # 0..1: how much of the filter's lag of half a cycle is taken away
        ("kfcv", np.float64),  # 1, on the setpoint's velocity
        ("kfca", np.float64),  # s, on the setpoint's acceleration
        ("output_limit", np.float64),
        ("command", np.float64),  # what is put out with the loop open
        ("blocked", np.int64),  # -1 or 1: the drive is off in that direction
        ("in_position_window", np.float64),
        ("following_error_limit", np.float64),
        # Results.
        ("actual_velocity", np.float64),
        ("following_error", np.float64),  # setpoint - actual
        ("output", np.float64),  # commanded velocity
        ("in_position", np.int64),
        # The filter's memory.
        ("running", np.int64),
        ("integral", np.float64),  # in output units
        ("last_error", np.float64),
        ("lag_input", np.float64),
        ("lag_cycles", np.float64),  # for which `lag_decay` holds
        ("lag_decay", np.float64),
    ],
    align=True,
)


class Servo(NamedTuple):
    """The position loops of n axes."""

    row: npt.NDArray[np.void]  # [n] of SERVO_ROW
    actual: npt.NDArray[np.float64]  # [n] result: the measured position
    profile_at_rest: npt.NDArray[np.uint8]  # [n] written by the caller: no profile moves the axis
    error_tripped: npt.NDArray[np.uint8]  # [n] result: stays 1 until the caller clears it


def make_servo(axes: int) -> Servo:
    """Make closed, ideal position loops with all coefficients 0 for `axes` axes at rest at 0."""
    row = np.zeros(axes, SERVO_ROW)
    row["mode"] = IDEAL
    row["loop_closed"] = 1
    row["lag_cycles"] = -1.0
    return Servo(row, np.zeros(axes), np.ones(axes, np.uint8), np.zeros(axes, np.uint8))


@compiled
def filter_lag_s(kpl: float, dt: float) -> float:
    """Return the time constant of the filter's lag: (1 - kpl) dt / 2, `kpl` taken within 0..1.

    Manual 002, 2.1.2.2.
    """
    return 0.5 * (1.0 - min(max(kpl, 0.0), 1.0)) * dt


@compiled
def _lagged(row: np.void, value: float) -> float:
    """Return what the first-order lag shows at the end of a straight line from its last input to `value`."""
    lag_cycles = filter_lag_s(row["kpl"], 1.0)
    if lag_cycles != row["lag_cycles"]:
        row["lag_cycles"] = lag_cycles
        row["lag_decay"] = math.exp(-1.0 / lag_cycles) if lag_cycles > 0.0 else 0.0
    last = row["lag_input"]
    trail = (value - last) * lag_cycles
    row["lag_input"] = value
    return float(value - trail + (row["output"] - last + trail) * row["lag_decay"])


@compiled
def _filter(row: np.void, error: float, velocity: float, acceleration: float, dt: float) -> float:
    """Return the PIDF filter's next output.

    The integral keeps output units, so a change of `ki` does not jump. It stands still while it would drive
    the sum further beyond the output limit.
    """
    if row["running"] == 0:
        row["running"] = 1
        row["integral"] = 0.0
        row["last_error"] = error
        row["lag_input"] = row["output"]
    last = row["last_error"]
    row["last_error"] = error
    total = row["kp"] * error + row["kd"] * (error - last) / dt
    total += row["kfcv"] * velocity + row["kfca"] * acceleration
    limit = row["output_limit"]
    if row["ki"] == 0.0:
        row["integral"] = 0.0
    else:
        step = row["ki"] * 0.5 * (error + last) * dt
        ahead = total + row["integral"] + step
        if not (limit > 0.0 and abs(ahead) > limit and ahead * step > 0.0):
            row["integral"] += step
        total += row["integral"]
    return limited(_lagged(row, limited(total, limit)), limit)


@compiled
def _take_ideal(row: np.void, drive: np.void, setpoint: float, velocity: float) -> None:
    """Let everything agree with the setpoint, so that a filter can take over from here."""
    row["running"] = 0
    row["actual_velocity"] = velocity
    row["following_error"] = 0.0
    row["output"] = velocity
    drive_place(drive, setpoint, velocity)


@compiled
def _moved(
    row: np.void,
    drive: np.void,
    last: float,
    setpoint: float,
    velocity: float,
    acceleration: float,
    dt: float,
) -> float:
    """Let the axis follow for one cycle from the `last` actual position; return the new one."""
    if row["loop_closed"] != 0 and row["mode"] == IDEAL:
        if row["blocked"] != 0 and (setpoint - last) * row["blocked"] > 0.0:
            _take_ideal(row, drive, last, 0.0)
            row["following_error"] = setpoint - last
            return last
        _take_ideal(row, drive, setpoint, velocity)
        return setpoint
    drive_cycle(drive, row["output"], dt)
    actual = drive_measured(drive)
    error = setpoint - actual
    row["actual_velocity"] = (actual - last) / dt
    row["following_error"] = error
    if row["loop_closed"] != 0:
        row["output"] = _filter(row, error, velocity, acceleration, dt)
    else:
        row["running"] = 0
        row["output"] = limited(row["command"], row["output_limit"])
    if row["output"] * row["blocked"] > 0.0:
        row["output"] = 0.0
    return actual


@compiled
def _tripped(row: np.void, at_rest: int) -> int:
    """Set `in_position`; return 1 if the following error is beyond its limit in a closed loop, else 0."""
    error = abs(row["following_error"])
    row["in_position"] = 1 if at_rest != 0 and error < row["in_position_window"] else 0
    limit = row["following_error_limit"]
    return 1 if limit > 0.0 and row["loop_closed"] != 0 and error > limit else 0


@compiled
def servo_cycle(
    i: int,
    servo: Servo,
    plant: Plant,
    setpoint: float,
    setpoint_velocity: float,
    setpoint_acceleration: float,
    dt: float,
) -> None:
    """Run the position loop of axis `i` for one cycle of `dt` seconds; the results are in `servo`."""
    row = servo.row[i]
    servo.actual[i] = _moved(
        row, plant.row[i], servo.actual[i], setpoint, setpoint_velocity, setpoint_acceleration, dt
    )
    servo.error_tripped[i] |= _tripped(row, int(servo.profile_at_rest[i]))


@entry
def servo_place(i: int, servo: Servo, plant: Plant, position: float) -> None:
    """Put axis `i` at rest at `position` and forget what its filter remembers."""
    row = servo.row[i]
    _take_ideal(row, plant.row[i], position, 0.0)
    servo.actual[i] = drive_measured(plant.row[i])
