"""Soft limits of a Power Mate: its axes run up to them, then the alarm comes; 1301#7 checks before."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.cnc import ControlEvent
from polycnc.controllers.fanuc import PowerMate

LOW, HIGH = (-8.0, -15.0), (12.0, 10.0)


def limited(*, check_before: bool = False) -> PowerMate:
    """Return a control of two axes with stroke limits."""
    control = PowerMate(axes=2)
    for axis in (1, 2):
        control.parameters.set(1320, round(1000 * HIGH[axis - 1]), axis)
        control.parameters.set(1321, round(1000 * LOW[axis - 1]), axis)
    control.parameters.set(1301, 0x80 if check_before else 0)
    return control


def ended(control: PowerMate, blocks: str) -> tuple[float, float]:
    """Execute blocks to their alarm or end, within the limits in every cycle; return where the axes stand."""
    control.programs.register(1, f"O0001\n{blocks}\nM30\n")
    control.select_program(1)
    control.cycle_start()
    for _ in range(100_000):
        if control.advance(1, until=ControlEvent.RUN_STATE) and not control.control.channels[0].active:
            break
        at = [control.machine.actual[name] for name in "XY"]
        assert all(a - 1e-6 <= x <= b + 1e-6 for x, a, b in zip(at, LOW, HIGH, strict=True)), at
    return control.machine.actual["X"], control.machine.actual["Y"]


def numbers(control: PowerMate) -> list[int]:
    return [alarm.number for alarm in control.status().alarms]


# By hand: half of the first line is X12. The arc about 0 with radius 14 begins at Y-14 and passes X12 at Y
# -sqrt(196 - 144); the circle about 0 goes the other way and passes X-8 at Y -sqrt(196 - 64).
CASES = {
    "line": ("G1 X24. Y8. F3000", (12.0, 4.0), [500]),
    "line down": ("G1 X4. Y-30. F3000", (2.0, -15.0), [501]),
    "rapid": ("G0 X24. Y8.", (12.0, 4.0), [500]),
    "second block": ("G1 X6. F3000\nY5.\nX-10. Y13.\nX0", (-4.0, 10.0), [500]),
    "arc": ("G1 Y-14. F3000\nG3 X14. Y0 J14.", (12.0, -math.sqrt(52.0)), [500]),
    "whole circle": ("G1 Y-14. F3000\nG2 J14.", (-8.0, -math.sqrt(132.0)), [501]),
    "within": ("G1 X12. Y10. F3000", (12.0, 10.0), []),
    "from the limit": ("G1 X12. F3000\nX13. Y5.", (12.0, 0.0), [500]),
    "along the limit": ("G1 X12. F3000\nY5.", (12.0, 5.0), []),
    "stop words": ("G1 X24. F3000 M0", (12.0, 0.0), [500]),
}


@pytest.mark.parametrize(("blocks", "end", "alarms"), CASES.values(), ids=CASES)
def test_axes_run_up_to_the_limit_then_the_alarm_comes(
    blocks: str, end: tuple[float, float], alarms: list[int]
) -> None:
    control = limited()
    assert ended(control, blocks) == pytest.approx(end, abs=1e-6)
    assert numbers(control) == alarms
    if alarms:
        control.reset()
        assert numbers(control) == []
        assert ended(control, "G1 X1. Y1. F3000") == (1.0, 1.0)


@pytest.mark.parametrize(
    ("blocks", "alarm"), [("G1 X24. Y8. F3000", 510), ("G1 X4. Y-30. F3000", 511)], ids=["plus", "minus"]
)
def test_with_the_check_before_a_move_nothing_moves(blocks: str, alarm: int) -> None:
    control = limited(check_before=True)
    assert ended(control, blocks) == (0.0, 0.0)
    assert numbers(control) == [alarm]


def test_a_compensated_path_stops_at_the_limit_too() -> None:
    control = limited()
    control.control.tools.set(1, radius_mm=2.0)
    end = ended(control, "G41 D1 G1 Y5. F3000\nX30.\nX31. Y-5.\nG40 X0 Y0")
    assert end == pytest.approx((12.0, 7.0), abs=1e-6)  # 2 mm to the left of Y5
    assert numbers(control) == [500]


_AT = st.integers(-20_000, 20_000).map(lambda n: n / 1000.0)
_LINE = st.tuples(st.sampled_from(["G0", "G1"]), _AT, _AT).map(
    lambda it: f"{it[0]} X{it[1]:.3f} Y{it[2]:.3f}"
)
_ARC = st.tuples(st.sampled_from(["G2", "G3"]), _AT, _AT).map(lambda it: f"{it[0]} I{it[1]:.3f} J{it[2]:.3f}")


@settings(max_examples=20)
@given(st.lists(st.one_of(_LINE, _ARC), min_size=1, max_size=6))
def test_no_program_passes_a_limit_and_the_alarm_means_that_an_axis_is_on_one(blocks: list[str]) -> None:
    blocks = [each for each in blocks if "I0.000 J0.000" not in each]
    control = limited()
    end = ended(control, "F12000\n" + "\n".join(blocks))
    found = numbers(control)
    on = [
        500 if x >= b - 1e-6 else 501
        for x, a, b in zip(end, LOW, HIGH, strict=True)
        if x <= a + 1e-6 or x >= b - 1e-6
    ]
    assert set(found) <= set(on), (end, found)
