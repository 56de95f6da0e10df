"""A trace that breaks a limit is found, with axis, place and number; one that just keeps all of them is not."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import polycnc
from polycnc.machine import MachineConfig
from polycnc.runner import Trace
from polycnc.runner._verify import Violation, verify_trace

CYCLE_S = 0.002
PLACE = 17  # the row from which on something is wrong


def machine() -> MachineConfig:
    mill = polycnc.load_machine("mill3")
    limits = (
        (170.0, 900.0, None, (-31.0, 47.0)),
        (230.0, 700.0, 3.0, None),
        (90.0, 1100.0, 1.0, (-7.0, 130.0)),
    )
    axes = tuple(
        axis.model_copy(
            update={
                "vmax_mm_s": vmax, "amax_mm_s2": amax, "jump_mm_s": jump, "soft_limits_mm": soft,
                "home_mm": home,
            }
        )
        for axis, (vmax, amax, jump, soft), home in zip(mill.axes, limits, (3.0, -5.0, 11.0), strict=True)
    )  # fmt: skip
    return mill.model_copy(update={"axes": axes, "cycle_s": CYCLE_S})


def trace(positions: npt.NDArray[np.float64]) -> Trace:
    """Return a trace of three axes; block 3 is executed five rows at a time."""
    rows = len(positions)
    return Trace(
        axes=("X", "Y", "Z"),
        units=("mm", "mm", "mm"),
        t_s=np.arange(1, rows + 1, dtype=np.float64) * CYCLE_S,
        block=np.arange(rows, dtype=np.int64) // 5 + 3,
        feed_mm_s=np.zeros(rows),
        rapid=np.zeros(rows, np.bool_),
        setpoint=positions,
    )


def at_home(rows: int = 40) -> npt.NDArray[np.float64]:
    return np.tile(np.array(machine().start_positions), (rows, 1))


def motion(axis: int, accelerations: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return positions of an axis that has these accelerations in every cycle."""
    positions = at_home(len(accelerations))
    positions[:, axis] += np.cumsum(np.cumsum(accelerations)) * CYCLE_S**2
    return positions


@pytest.mark.parametrize(("axis", "name", "limit"), [(0, "X", 900.0), (1, "Y", 2200.0), (2, "Z", 1600.0)])
def test_an_acceleration_above_the_limit_is_found_in_its_cycle(axis: int, name: str, limit: float) -> None:
    # Limit and the permitted step in velocity over a cycle: 700 + 3 / 0.002, 1100 + 1 / 0.002.
    accelerations = np.zeros(40)
    accelerations[PLACE], accelerations[PLACE + 1] = limit, -limit
    assert verify_trace(trace(motion(axis, accelerations)), machine()) == []
    accelerations[PLACE + 1] = -1.003 * limit
    (found,) = verify_trace(trace(motion(axis, accelerations)), machine())
    assert (found.axis, found.what, found.block) == (name, "acceleration", (PLACE + 1) // 5 + 3)
    assert found.time_s == pytest.approx((PLACE + 2) * CYCLE_S)
    assert found.value == pytest.approx(1.003 * limit)
    assert found.limit == limit


@pytest.mark.parametrize(("axis", "name", "limit"), [(0, "X", 170.0), (1, "Y", 230.0), (2, "Z", 90.0)])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_speed_above_the_limit_is_found_whichever_way_it_goes(
    axis: int, name: str, limit: float, way: float
) -> None:
    free = machine()
    free = free.model_copy(
        update={"axes": tuple(each.model_copy(update={"soft_limits_mm": None}) for each in free.axes)}
    )
    reached = int(limit / (600.0 * CYCLE_S)) + 1
    accelerations = np.append(np.full(reached, way * limit / (reached * CYCLE_S)), np.zeros(9))
    assert verify_trace(trace(motion(axis, accelerations)), free) == []
    accelerations[reached + 2] = way * 0.004 * limit / CYCLE_S
    accelerations[reached + 3] = -way * 0.004 * limit / CYCLE_S
    (found,) = verify_trace(trace(motion(axis, accelerations)), free)
    assert (found.axis, found.what) == (name, "speed")
    assert found.value == pytest.approx(1.004 * limit)
    assert found.limit == limit
    assert found.time_s == pytest.approx((reached + 3) * CYCLE_S)


@pytest.mark.parametrize(
    ("axis", "beyond", "text"),
    [
        (0, 47.25, "axis X: position 47.25 above 47 at 0.092000 s, block 12"),
        (0, -31.5, "axis X: position -31.5 below -31 at 0.092000 s, block 12"),
        (2, 130.125, "axis Z: position 130.125 above 130 at 0.092000 s, block 12"),
        (2, -7.75, "axis Z: position -7.75 below -7 at 0.092000 s, block 12"),
    ],
)
def test_a_place_beyond_a_limit_is_told_as_it_is(axis: int, beyond: float, text: str) -> None:
    slow = machine()
    fast = tuple(each.model_copy(update={"vmax_mm_s": 1e6, "amax_mm_s2": 1e9}) for each in slow.axes)
    positions = at_home(60)
    positions[40:, axis] = beyond - 0.875 if beyond > 0 else beyond + 0.875
    assert verify_trace(trace(positions), slow.model_copy(update={"axes": fast})) == []
    positions[45, axis] = beyond
    (found,) = verify_trace(trace(positions), slow.model_copy(update={"axes": fast}))
    assert str(found) == text


def test_everything_that_is_wrong_is_told_once_for_each_limit() -> None:
    positions = at_home(50)
    positions[30:, 0] = 61.0
    positions[40:, 0] = 62.0
    positions[20:, 1] = 90.0
    found = verify_trace(trace(positions), machine())
    assert [(each.axis, each.what) for each in found] == [
        ("X", "speed"), ("X", "acceleration"), ("X", "position"), ("Y", "speed"), ("Y", "acceleration"),
    ]  # fmt: skip
    assert found[2] == Violation("X", "position", 41 * CYCLE_S, 11, 62.0, 47.0)
    assert verify_trace(trace(at_home(0)), machine()) == []


def test_a_trace_begins_at_rest_where_the_machine_does() -> None:
    positions = at_home(3)
    positions[:, 1] += 0.4  # 200 mm/s in the first cycle
    (found,) = verify_trace(trace(positions), machine())
    assert (found.axis, found.what, found.time_s) == ("Y", "acceleration", CYCLE_S)
