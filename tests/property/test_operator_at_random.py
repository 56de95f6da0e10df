"""An operator who presses anything at any time: refusals change nothing, limits hold, a reset leaves nothing behind."""

from __future__ import annotations

import numpy as np
import pytest

from support.often import often
from support.operator_desk import CONFIG, CYCLE_S, Floats, desk

ROUNDING = 1.0 + 1e-6


def overload(points: Floats) -> float:
    """Return the highest part of an axis' limits that any cycle uses."""
    speed = np.diff(points, axis=0) / CYCLE_S
    speed[:, 3] = (speed[:, 3] + 180.0 / CYCLE_S) % (360.0 / CYCLE_S) - 180.0 / CYCLE_S  # modulo
    acceleration = np.diff(speed, axis=0) / CYCLE_S
    return max(
        float(np.max(np.abs(speed) / [axis.vmax for axis in CONFIG.axes])),
        float(np.max(np.abs(acceleration) / [axis.amax for axis in CONFIG.axes])),
    )


def from_the_dwell(points: Floats) -> Floats:
    """Return the setpoints from the first rest at the first point on."""
    rests = (np.diff(points[:, :2], axis=0) == 0.0).all(axis=1) & (points[1:, :2] == (10.5, -7.25)).all(
        axis=1
    )
    return points[np.flatnonzero(rests)[0] :]


@pytest.mark.parametrize("seed", often([2, 9, 14, 45, 53, 60], 2))
def test_whatever_was_pressed_before_a_part_comes_out_the_same(seed: int) -> None:
    fresh, used = desk(seed), desk(seed)
    used.some_time()
    used.to_rest()
    expected, found = from_the_dwell(fresh.parts()), from_the_dwell(used.parts())
    assert found.shape == expected.shape, used.log
    assert np.abs(found - expected).max() < 1e-9, used.log
    assert (found[-1] == expected[-1]).all()
    assert overload(np.array(used.points)) <= ROUNDING
