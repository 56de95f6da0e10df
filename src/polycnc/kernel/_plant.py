"""The simulated drive of an axis: motor velocity of first order, play in the transmission, an encoder.

The motor follows the commanded velocity with one time constant, optionally within a velocity and an
acceleration limit; over one cycle with a held command this is solved exactly, so the result does not depend
on how a time is cut into cycles. The load follows the motor through play. The encoder sits on either side and
counts whole steps.

Units: lengths in the axis' own unit (mm or deg), velocities per s, times in s.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled

DRIVE_ROW = np.dtype(
    [
        # Configuration, in axis units and seconds; 0 switches a property off.
        ("lag_s", np.float64),  # time constant of the velocity: inertia over damping
        (
            "gain",
            np.float64,
        ),  # velocity reached per commanded velocity; 0 is a dead drive, which coasts to rest
        ("velocity_limit", np.float64),
        ("acceleration_limit", np.float64),  # torque over inertia
        ("backlash", np.float64),  # full width of the play between motor and load
        ("resolution", np.float64),  # encoder step
        ("motor_encoder", np.int64),  # 0 measures the load (a linear scale), 1 the motor (which sees no play)
        # State.
        ("velocity", np.float64),  # of the motor
        ("drive_position", np.float64),  # of the motor
        ("position", np.float64),  # of the load
        # The solution for one lag and cycle time, kept because an exponential costs more than all the rest.
        ("solved_lag_s", np.float64),
        ("solved_dt", np.float64),
        ("solved_rise", np.float64),
    ],
    align=True,
)


class Plant(NamedTuple):
    """The drives of n axes."""

    row: npt.NDArray[np.void]  # [n] of DRIVE_ROW


def make_plant(axes: int) -> Plant:
    """Make drives without lag, limits, play or encoder steps for `axes` axes at rest at 0."""
    row = np.zeros(axes, DRIVE_ROW)
    row["gain"] = 1.0
    return Plant(row)


@compiled
def limited(value: float, limit: float) -> float:
    """Return `value` within plus and minus `limit`; a `limit` of 0 is none."""
    if limit > 0.0:
        if value > limit:
            return limit
        if value < -limit:
            return -limit
    return value


@compiled
def _saturated(drive: np.void, target: float, dt: float) -> float:
    """Move with the largest acceleration while the lag would ask for more; return the time left over."""
    top = drive["acceleration_limit"]
    gap = target - drive["velocity"]
    excess = abs(gap) - top * drive["lag_s"]
    if excess <= 0.0:
        return dt
    time = min(float(excess / top), dt)
    acceleration = top if gap > 0.0 else -top
    drive["drive_position"] += (drive["velocity"] + 0.5 * acceleration * time) * time
    drive["velocity"] += acceleration * time
    return dt - time


@compiled
def _rise(drive: np.void, dt: float) -> float:
    """Return the share of a velocity step that a drive with lag has covered after `dt`."""
    lag = drive["lag_s"]
    if lag != drive["solved_lag_s"] or dt != drive["solved_dt"]:
        drive["solved_lag_s"] = lag
        drive["solved_dt"] = dt
        drive["solved_rise"] = -math.expm1(-dt / lag)
    return float(drive["solved_rise"])


@compiled
def drive_cycle(drive: np.void, command_velocity: float, dt: float) -> None:
    """Advance one drive by `dt` seconds with a held velocity command.

    With target u and time constant T the motor has v(t) = u + (v0 - u) exp(-t/T), and its position is the
    integral of that.
    """
    target = limited(drive["gain"] * command_velocity, drive["velocity_limit"])
    rest = dt
    if drive["acceleration_limit"] > 0.0:
        rest = _saturated(drive, target, dt)
    if drive["lag_s"] > 0.0:
        covered = (target - drive["velocity"]) * _rise(drive, rest)
        drive["drive_position"] += target * rest - covered * drive["lag_s"]
        drive["velocity"] += covered
    elif rest > 0.0:
        drive["drive_position"] += target * rest
        drive["velocity"] = target
    half = 0.5 * drive["backlash"]
    if drive["drive_position"] - half > drive["position"]:
        drive["position"] = drive["drive_position"] - half
    elif drive["drive_position"] + half < drive["position"]:
        drive["position"] = drive["drive_position"] + half


@compiled
def drive_place(drive: np.void, position: float, velocity: float) -> None:
    """Put motor and load at `position`, in the middle of the play, moving with `velocity`."""
    drive["velocity"] = velocity
    drive["drive_position"] = position
    drive["position"] = position


@compiled
def drive_measured(drive: np.void) -> float:
    """Return what the encoder shows: the nearest multiple of `resolution`, half a step rounds up.

    Rounding to the nearest step puts a target on whole steps in the middle of its step, so an axis at rest
    there does not hunt between two readings.
    """
    position = drive["drive_position"] if drive["motor_encoder"] != 0 else drive["position"]
    step = drive["resolution"]
    if step > 0.0:
        return float(math.floor(position / step + 0.5) * step)
    return float(position)


@compiled
def plant_cycle(i: int, plant: Plant, command_velocity: float, dt: float) -> None:
    """Advance the drive of axis `i` by `dt` seconds with a held velocity command."""
    drive_cycle(plant.row[i], command_velocity, dt)


@compiled
def plant_place(i: int, plant: Plant, position: float, velocity: float) -> None:
    """Put motor and load of axis `i` at `position`, in the middle of the play, moving with `velocity`."""
    drive_place(plant.row[i], position, velocity)


@compiled
def measured(i: int, plant: Plant) -> float:
    """Return what the encoder of axis `i` shows, in axis units."""
    return drive_measured(plant.row[i])
