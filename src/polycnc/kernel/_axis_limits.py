"""What the axes of a path allow, as arrays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._segments import Floats


class AxisLimits(NamedTuple):
    """Limits of n axes, and which of them count in the path length."""

    speed: Floats
    acceleration: Floats
    jump: Floats  # velocity step at a junction; negative: what the acceleration allows
    feed_axis: npt.NDArray[np.uint8]


def make_limits(axes: int) -> AxisLimits:
    """Allocate limits of `axes` axes: unlimited, all counting. Rapids need a speed limit."""
    return AxisLimits(
        speed=np.full(axes, np.inf),
        acceleration=np.full(axes, np.inf),
        jump=np.full(axes, -1.0),
        feed_axis=np.ones(axes, np.uint8),
    )
