"""Why a program is stopped by an axis: whichever axis it is, its own number, and only where the path has it."""

from __future__ import annotations

import pytest

from polycnc.cnc._path_runner import axis_alarm
from polycnc.kernel import FOLLOWING_ERROR, LIMIT_HIGH, LIMIT_LOW, PATH_RESTED, REFERENCE, SWITCH_EDGE
from polycnc.machine import Machine
from support.cnc_machine import cnc_machine


def machine(path: tuple[int, ...] = (0, 1, 2, 3)) -> Machine:
    made = Machine(cnc_machine())
    made.state.paths.axis[0] = -1
    made.state.paths.axis[0, : len(path)] = path
    for index, error in enumerate((0.125, -2.75, 0.375, 31.5)):
        made.state.servo.row["following_error"][index] = error
        made.state.servo.actual[index] = 10.0 * index + 1.25
    return made


@pytest.mark.parametrize(
    ("axis", "text"),
    [(0, "axis X: following error 0.1250 mm"), (1, "axis Y: following error -2.7500 mm"),
     (3, "axis B: following error 31.5000 deg")],
)  # fmt: skip
def test_the_axis_that_lags_is_named_with_its_error(axis: int, text: str) -> None:
    made = machine()
    made.state.servo.error_tripped[axis] = 1
    assert axis_alarm(made, FOLLOWING_ERROR, 0) == (f"{text} is above its limit", "following_error")
    assert axis_alarm(made, FOLLOWING_ERROR | PATH_RESTED, 0) is not None
    assert axis_alarm(made, PATH_RESTED | SWITCH_EDGE, 0) is None  # that is not why it stopped


@pytest.mark.parametrize("axis", [0, 2])
@pytest.mark.parametrize("which", [LIMIT_LOW, LIMIT_HIGH])
def test_the_axis_on_a_switch_is_named_with_its_place(axis: int, which: int) -> None:
    made = machine()
    made.state.switches.switch["level"][axis, which] = 1
    place = f"{10.0 * axis + 1.25:.3f}"
    text = f"axis {'XYZB'[axis]} is on a limit switch at {place} mm"
    assert axis_alarm(made, SWITCH_EDGE, 0) == (text, "limit_switch")
    assert axis_alarm(made, FOLLOWING_ERROR, 0) is None
    made.state.switches.switch["level"][axis, which] = 0
    made.state.switches.switch["level"][axis, REFERENCE] = 1
    assert axis_alarm(made, SWITCH_EDGE, 0) is None


def test_axes_of_other_paths_stop_nothing_here_and_the_first_axis_is_told() -> None:
    made = machine((2, 1))
    made.state.servo.error_tripped[0] = made.state.servo.error_tripped[3] = 1
    assert axis_alarm(made, FOLLOWING_ERROR, 0) is None
    made.state.servo.error_tripped[1] = made.state.servo.error_tripped[2] = 1
    found = axis_alarm(made, FOLLOWING_ERROR, 0)
    assert found is not None
    assert found[0].startswith("axis Y")
