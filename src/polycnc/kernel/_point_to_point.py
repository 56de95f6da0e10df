"""The point-to-point source: one running profile per axis and layer.

Layer MAIN gives the position of an axis itself, layer ADDED is summed on top of whatever else moves the axis.
A profile begins with the cycle after it was commanded, from the position and velocity at that moment.

Units: lengths in the axis' own unit (mm or deg), velocities per s, rates per s2, times in s.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._profile import plan_profile, stop_profile
from polycnc.kernel._profile_shape import (
    POSITION,
    PROFILE_COLUMNS,
    PROFILE_PHASES,
    VELOCITY,
    profile_at,
    profile_duration,
)

MAIN = 0
ADDED = 1
LAYERS = 2

REST_SLACK = 1e-9  # part of a cycle by which rounding may make a rest late

Floats = npt.NDArray[np.float64]

PROFILE_ROW = np.dtype(
    [
        ("count", np.int64),  # phases
        ("cycles", np.int64),  # samples taken
        ("duration", np.float64),
        ("position", np.float64),  # of the last sample
        ("velocity", np.float64),
        ("active", np.int8),
        ("ended", np.int8),  # the profile reached its target with the last sample
    ],
    align=True,
)


class PointToPoint(NamedTuple):
    """Profiles of n axes in LAYERS layers."""

    row: npt.NDArray[np.void]  # [LAYERS, n] of PROFILE_ROW
    phases: Floats  # [LAYERS, n, PROFILE_PHASES, PROFILE_COLUMNS]


def make_point_to_point(axes: int) -> PointToPoint:
    """Make idle profiles for `axes` axes at 0."""
    return PointToPoint(
        row=np.zeros((LAYERS, axes), PROFILE_ROW),
        phases=np.zeros((LAYERS, axes, PROFILE_PHASES, PROFILE_COLUMNS)),
    )


@entry
def move_to(
    ptp: PointToPoint,
    layer: int,
    i: int,
    target: float,
    target_velocity: float,
    velocity: float,
    acceleration: float,
    deceleration: float,
    jerkrel: float,
    short_policy: int,
) -> int:
    """Begin a profile of axis `i` from its present position and velocity; return its phases, negative if refused.

    A refused profile leaves the running one alone. See `plan_profile` for the numbers.
    """
    row = ptp.row[layer, i]
    planned = np.zeros((PROFILE_PHASES, PROFILE_COLUMNS))  # all of it becomes state
    count = plan_profile(
        planned,
        row["position"],
        row["velocity"],
        target,
        target_velocity,
        velocity,
        acceleration,
        deceleration,
        jerkrel,
        short_policy,
    )
    if count < 0:
        return count
    _begin(ptp, layer, i, planned, count)
    return count


@entry
def stop_axis(ptp: PointToPoint, layer: int, i: int, deceleration: float, jerkrel: float) -> int:
    """Brake axis `i` to rest from its present velocity; a deceleration of 0 stops it at once."""
    row = ptp.row[layer, i]
    planned = np.zeros((PROFILE_PHASES, PROFILE_COLUMNS))  # all of it becomes state
    count = stop_profile(planned, row["position"], row["velocity"], deceleration, jerkrel)
    _begin(ptp, layer, i, planned, count)
    return count


def rest_position(ptp: PointToPoint, layer: int, i: int) -> float:
    """Return where the running profile of axis `i` comes to rest; NaN if none runs, or it does not."""
    row = ptp.row[layer, i]
    end = ptp.phases[layer, i, row["count"]]
    return float(end[POSITION]) if row["active"] and end[VELOCITY] == 0.0 else math.nan


@compiled
def _begin(ptp: PointToPoint, layer: int, i: int, planned: Floats, count: int) -> None:
    for phase in range(PROFILE_PHASES):
        for column in range(PROFILE_COLUMNS):
            ptp.phases[layer, i, phase, column] = planned[phase, column]
    row = ptp.row[layer, i]
    row["count"] = count
    row["cycles"] = 0
    row["duration"] = profile_duration(planned, count)
    row["active"] = 1
    row["ended"] = 0


@compiled
def profile_cycle(ptp: PointToPoint, layer: int, i: int, dt: float) -> bool:
    """Take the profile of axis `i` one cycle on; True if it reached its target with this sample.

    A profile with a target velocity goes on with it after the target.
    """
    row = ptp.row[layer, i]
    row["ended"] = 0
    if row["active"] == 0:
        return False
    row["cycles"] += 1
    t = row["cycles"] * dt
    phases = ptp.phases[layer, i]
    count = row["count"]
    # A rest that rounding would make one cycle late is taken in time, as on a path.
    end = row["duration"] - REST_SLACK * dt
    reached = t >= end
    at_rest = phases[count, VELOCITY] == 0.0
    if reached and at_rest:
        t = row["duration"]
    position, velocity, _ = profile_at(phases, count, t)
    row["position"] = position
    row["velocity"] = velocity
    if not reached:
        return False
    if at_rest:
        row["active"] = 0
        row["ended"] = 1
        return True
    first = row["cycles"] == 1 or t - dt < end
    row["ended"] = 1 if first else 0
    return bool(first)


def place_axis(ptp: PointToPoint, layer: int, i: int, position: float) -> None:
    """Put axis `i` of a layer at rest at `position`."""
    row = ptp.row[layer, i]
    row["active"] = 0
    row["ended"] = 0
    row["position"] = position
    row["velocity"] = 0.0
