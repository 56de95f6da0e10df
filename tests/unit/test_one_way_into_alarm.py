"""A program that is wrong ends in an alarm that can be read, whatever led there, and a reset ends it."""

from __future__ import annotations

from itertools import product

import pytest

from polycnc.cnc import Control, ControlData, ControlError, ControlEvent, Refusal, RunState, Step
from polycnc.nc.macro import MacroLanguage
from support.cnc_machine import cnc_machine

ERRORS = {
    "unknown code": "G177 X5",
    "no feed for a number": "G1 X",
    "beyond the limit": "G1 X7777 F600",
    "no program": "M98 P777",
    "division by zero": "#1=1/0",
    "own alarm": "#3000=7(TURN THE PART)",
}
BEFORE = {
    "at once": "",
    "behind motion": "G1 X20 F3000\n",
    "behind none": "G90\n",
    "behind motion and none": "G1 X20 F3000\nG90\n",
    "behind a function": "M50\n",
    "behind a call": "M98 P7\n",
    "behind a dwell": "G4 P0.01\n",
}
WAYS = {
    "run": (Step.RUN, False),
    "into": (Step.INTO, False),
    "over": (Step.OVER, False),
    "out": (Step.OUT, False),
    "single block": (Step.RUN, True),
}
_NOT_ACTIVE = ControlEvent.RUN_STATE


@pytest.mark.parametrize(("before", "way", "error"), list(product(BEFORE, WAYS, ERRORS)))
def test_every_error_is_an_alarm_with_its_text(before: str, way: str, error: str) -> None:
    step, single_block = WAYS[way]
    made = Control(
        cnc_machine(),
        dialect="fanuc",
        data=ControlData(reference_required=False),
        languages=(MacroLanguage(),),
    )
    made.programs.create("O0007", "G90\nG91\nG90\nM99\n")
    made.programs.create("PART", f"{BEFORE[before]}{ERRORS[error]}\nG1 X3 F600\nM30\n")
    made.select_program("PART")
    made.set_switches(single_block=single_block)
    for _ in range(9):
        made.cycle_start(step=step)
        while made.channels[0].run_state is RunState.ACTIVE:
            made.advance(4000, until=_NOT_ACTIVE)
        if made.channels[0].run_state is not RunState.STOPPED_AT_BLOCK:
            break
    assert made.channels[0].run_state is RunState.ALARM
    (alarm,) = made.alarms.active
    assert alarm.text
    assert alarm.number
    assert made.status().alarms == (alarm,)
    with pytest.raises(ControlError) as refused:
        made.cycle_start(step=step)
    assert refused.value.reason is Refusal.ALARM
    assert alarm.text in str(refused.value)
    made.reset()
    made.advance(500)
    assert not made.alarms.active
    assert [each.run_state for each in made.channels] == [RunState.RESET]


@pytest.mark.parametrize("steps", [1, 3])
def test_the_end_that_a_step_leads_to_counts_its_part_once(steps: int) -> None:
    made = Control(cnc_machine(), data=ControlData(reference_required=False))
    made.programs.create("PART", "G1 X20 F3000\n" * (steps > 1) + "G90\n" * (steps > 1) + "M30\n")
    made.select_program("PART")
    made.set_switches(single_block=True)
    for _ in range(6):
        made.cycle_start()
        made.advance(4000, until=_NOT_ACTIVE)
        if made.channels[0].run_state is RunState.COMPLETED:
            break
    assert made.channels[0].run_state is RunState.COMPLETED
    made.advance(5)
    assert made.parts.parts.made == 1


def test_a_control_refuses_with_its_own_errors_alone() -> None:
    made = Control(cnc_machine(), data=ControlData(reference_required=False, dry_run_mm_min=0.0))
    made.programs.create("PART", "G1 X20 F3000\nM30\n")
    made.select_program("PART")
    for on in (False, True):
        if on:
            made.cycle_start()
            made.advance(3)
        before = made.status()
        with pytest.raises(ControlError):
            made.set_switches(dry_run=True, single_block=True)
        assert made.status() == before
        assert made.switches.single_block is False


@pytest.mark.parametrize(("name", "axis"), [("no such alarm", None), ("", "X"), ("following_error", "Q")])
def test_an_alarm_that_the_control_does_not_have_is_refused_and_changes_nothing(
    name: str, axis: str | None
) -> None:
    made = Control(cnc_machine(), data=ControlData(reference_required=False))
    made.programs.create("PART", "G1 X20 F3000\nM30\n")
    made.select_program("PART")
    made.cycle_start()
    made.advance(7)
    before = made.status()
    with pytest.raises(ControlError, match=r"there is no (alarm|axis)"):
        made.put_alarm(name, axis=axis)
    assert (made.status(), made.alarms.history()) == (before, ())


@pytest.mark.parametrize("cut", [1, 37])
def test_an_alarm_of_the_machine_brings_none_of_a_block_that_is_not_reached(cut: int) -> None:
    made = Control(cnc_machine(), dialect="fanuc", data=ControlData(reference_required=False))
    made.programs.create("PART", "G1 X20 F300\nG177 X5\nM30\n")
    made.select_program("PART")
    made.cycle_start()
    made.advance(50)
    assert made.channels[0].run is not None
    assert made.channels[0].run.error is not None  # known, since the block is prepared ahead
    made.put_alarm("following_error", axis="Y")
    for _ in range(74 // cut):
        made.advance(cut)
    assert made.channels[0].run_state is RunState.ALARM
    assert [each.name for each in made.alarms.active] == ["following_error"]
