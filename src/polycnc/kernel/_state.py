"""Everything that one machine is made of in the control cycle, as one tuple of arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._axis_limits import AxisLimits, make_limits
from polycnc.kernel._path import Paths, make_paths
from polycnc.kernel._plant import Plant, make_plant
from polycnc.kernel._point_to_point import PointToPoint, make_point_to_point
from polycnc.kernel._recorder import Recorder, make_recorder
from polycnc.kernel._segments import Segments, make_segments
from polycnc.kernel._servo import Servo, make_servo
from polycnc.kernel._switches import Switches, make_switches

Floats = npt.NDArray[np.float64]

# Reasons to stop, bits of `mask` and `raised`.
QUEUE_LOW = 1  # few planned segments are left of a path that is started and not closed
PATH_RESTED = 2  # a path came to rest, or passed its last wait, and has nothing queued
PROFILE_ENDED = 4
SWITCH_EDGE = 8
SOFT_LIMIT = 16  # a setpoint is beyond a software limit
FOLLOWING_ERROR = 32
RECORDER_FULL = 64
PATH_EVENT = 128  # a path stands at an event

CLOCK_ROW = np.dtype(
    [
        ("cycle", np.int64),
        ("dt", np.float64),
        ("mask", np.int64),  # reasons that stop `advance`
        ("raised", np.int64),  # reasons met in its last cycle
        ("axis", np.int64),  # the axis of the last axis reason, -1 none
        ("main_path", np.int64),  # the path whose block and feed are recorded
    ],
    align=True,
)

# Who gives an axis its position; a path g is g.
POINT_TO_POINT = -1
OTHER_SOURCE = -2  # whoever writes `base` before the cycle


class KernelState(NamedTuple):
    """A machine of n axes; `setpoint` is the sum of what its sources give."""

    clock: npt.NDArray[np.void]  # [1] of CLOCK_ROW
    owner: npt.NDArray[np.int64]  # [n] POINT_TO_POINT, OTHER_SOURCE or a path
    base: Floats  # [n] what the owner gives
    setpoint: Floats  # [n]
    velocity: Floats  # [n] of the setpoint
    acceleration: Floats  # [n] of the setpoint
    ptp: PointToPoint
    paths: Paths
    seg: Segments
    limits: AxisLimits
    servo: Servo
    plant: Plant
    switches: Switches
    recorder: Recorder
    work: Floats  # [3, n] scratch


def make_state(
    axes: int,
    *,
    cycle_s: float = 0.001,
    paths: int = 1,
    segments: int = 1 << 16,
    record_cycles: int = 0,
    record_actual: bool = False,
    limited_jerk: bool = True,
) -> KernelState:
    """Allocate a machine of `axes` axes at rest at 0, all with ideal servos and without limits.

    Without `limited_jerk` its paths take less memory, and none may have a jerk limit.
    """
    clock = np.zeros(1, CLOCK_ROW)
    clock["dt"] = cycle_s
    clock["axis"] = -1
    return KernelState(
        clock=clock,
        owner=np.full(axes, POINT_TO_POINT, np.int64),
        base=np.zeros(axes),
        setpoint=np.zeros(axes),
        velocity=np.zeros(axes),
        acceleration=np.zeros(axes),
        ptp=make_point_to_point(axes),
        paths=make_paths(paths, segments, axes),
        seg=make_segments(segments, axes, limited_jerk=limited_jerk),
        limits=make_limits(axes),
        servo=make_servo(axes),
        plant=make_plant(axes),
        switches=make_switches(axes),
        recorder=make_recorder(record_cycles, axes, record_actual),
        work=np.zeros((3, axes)),
    )
