"""The recorder: one row of numbers per control cycle, written in compiled code into a buffer."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled

Floats = npt.NDArray[np.float64]

# Leading columns of a row; the setpoints of all axes follow, then, if wanted, their actual positions.
TIME_S, BLOCK, FEED_MM_S, IS_RAPID = 0, 1, 2, 3
LEADING = 4


class Recorder(NamedTuple):
    """A buffer of rows; an empty one (capacity 0) records nothing."""

    rows: Floats  # [capacity, LEADING + n] or [capacity, LEADING + 2 n]
    filled: npt.NDArray[np.int64]  # [1] rows


def make_recorder(capacity: int, axes: int, actual: bool) -> Recorder:
    """Make a recorder for `capacity` cycles of `axes` axes, with actual positions if wanted."""
    return Recorder(np.zeros((capacity, LEADING + axes * (2 if actual else 1))), np.zeros(1, np.int64))


@compiled
def is_full(recorder: Recorder) -> bool:
    """Tell whether a recorder that records has no room for another row."""
    return bool(recorder.rows.shape[0] > 0 and recorder.filled[0] >= recorder.rows.shape[0])


@compiled
def record(
    recorder: Recorder,
    time_s: float,
    block: int,
    speed_mm_s: float,
    rapid: int,
    setpoint: Floats,
    actual: Floats,
) -> None:
    """Append the row of a cycle; a full recorder, that nobody has emptied, keeps what it has."""
    if recorder.filled[0] >= recorder.rows.shape[0]:
        return
    row = recorder.rows[recorder.filled[0]]
    row[TIME_S] = time_s
    row[BLOCK] = block
    row[FEED_MM_S] = speed_mm_s
    row[IS_RAPID] = rapid
    n = setpoint.shape[0]
    for i in range(n):
        row[LEADING + i] = setpoint[i]
    if row.shape[0] > LEADING + n:
        for i in range(n):
            row[LEADING + n + i] = actual[i]
    recorder.filled[0] += 1
