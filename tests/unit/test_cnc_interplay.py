"""Where two mechanisms of a control could hold each other, and what is left when a mode ends early."""

from __future__ import annotations

from functools import partial

import pytest

from polycnc.cnc import (
    Answer,
    Control,
    ControlData,
    ControlError,
    ControlEvent,
    Emergency,
    Function,
    Mode,
    Motion,
    OnModeChange,
    Refusal,
    RunState,
    Step,
)
from support.cnc_machine import cnc_machine

MAIN = """N10 G1 X20.5 F3000
N20 M98 P31
N30 G4 P0.4
N40 M0
N50 Y-3.25
N60 M30
"""
SUB = "N1 Z-4.5\nN2 M98 P32\nN3 M99\n"
INNER = "N5 Y2.75\nN6 M8\nN7 M99\n"
END = (20.5, -3.25, -4.5, 0.0)
LONG = 50_000


def control(script: dict[tuple[Function, int | None], Answer] | None = None, **data: object) -> Control:
    made = Control(cnc_machine(), script=script, data=ControlData(**data))  # type: ignore[arg-type]
    for name, text in (("MAIN", MAIN), ("O0031", SUB), ("O0032", INNER)):
        made.programs.create(name, text)
    made.select_program("MAIN")
    return made


def until_it_stands(made: Control) -> RunState:
    made.advance(LONG, until=lambda: not made.channels[0].active)
    return made.channels[0].run_state


def to_block(made: Control, sequence: int) -> None:
    def there() -> bool:
        block = made.channels[0].executed
        return block is not None and block.sequence == sequence

    made.advance(LONG, until=there)
    assert there()


def places(made: Control) -> tuple[float, ...]:
    return tuple(axis.machine for axis in made.status().axes.values())


def to_the_end(made: Control) -> None:
    for _ in range(3):
        if until_it_stands(made) is RunState.COMPLETED:
            break
        made.cycle_start()
    assert places(made) == END
    assert made.status().channel.run_state is RunState.COMPLETED


def sequence(made: Control) -> int | None:
    block = made.channels[0].executed
    return None if block is None else block.sequence


# ---------------------------------------------------------------------- dwells


def test_a_dwell_stands_still_while_it_is_held() -> None:
    made, free = control(), control()
    for each in (made, free):
        each.cycle_start()
        to_block(each, 30)
        each.advance(100)
    assert made.status().channel.motion is Motion.DWELL
    made.feed_hold()
    made.advance(3000)
    assert made.channels[0].run_state is RunState.HOLD
    assert sequence(made) == 30
    made.cycle_start()
    left = made.advance(LONG, until=ControlEvent.RUN_STATE), free.advance(LONG, until=ControlEvent.RUN_STATE)
    assert abs(left[0] - left[1]) <= 1
    assert made.channels[0].run_state.value == RunState.PROGRAM_STOP.value  # it was HOLD to the type checker
    to_the_end(made)


def test_a_dwell_passes_with_the_overrides_at_0_and_a_reset_ends_it() -> None:
    made = control()
    made.cycle_start()
    to_block(made, 30)
    made.set_overrides(feed=0.0, rapid=0.0)
    assert until_it_stands(made) is RunState.PROGRAM_STOP
    made.cycle_start()
    made.advance(500)
    assert made.channels[0].active
    assert places(made)[1] == 2.75  # stands: the feed is 0
    made.set_overrides(feed=1.0)
    to_the_end(made)
    made.cycle_start()
    to_block(made, 30)
    made.advance(50)
    made.reset()
    made.advance(5)
    assert made.status().channel.motion is Motion.NONE
    made.cycle_start()
    to_the_end(made)


# ---------------------------------------------------------------------- stops and holds


def test_a_hold_at_a_program_stop_is_refused_and_the_stop_stays() -> None:
    made = control()
    made.cycle_start()
    assert until_it_stands(made) is RunState.PROGRAM_STOP
    with pytest.raises(ControlError) as caught:
        made.feed_hold()
    assert caught.value.reason is Refusal.IDLE
    assert made.channels[0].run_state.value == RunState.PROGRAM_STOP.value  # it was HOLD to the type checker
    to_the_end(made)


def test_single_block_and_a_hold_within_the_block_end_at_its_end() -> None:
    made = control()
    made.set_switches(single_block=True)
    made.cycle_start()
    made.advance(150)
    made.feed_hold()
    made.advance(500)
    x = places(made)[0]
    assert 12.5 < x < 20.5
    made.cycle_start()
    assert until_it_stands(made) is RunState.STOPPED_AT_BLOCK
    assert (places(made)[0], sequence(made)) == (20.5, 10)


def test_single_block_stands_once_at_every_block_and_once_at_a_program_stop() -> None:
    made = control()
    made.set_switches(single_block=True)
    stood = []
    for _ in range(20):
        made.cycle_start()
        state = until_it_stands(made)
        stood.append((sequence(made), state))
        if state is RunState.COMPLETED:
            break
    numbers = [number for number, _ in stood]
    assert numbers == [10, 20, 1, 2, 5, 6, 7, 3, 30, 40, 50, 60]
    assert dict(stood)[40] is RunState.PROGRAM_STOP
    assert places(made) == END


@pytest.mark.parametrize("answer_while", ["held", "before", "after"])
def test_a_function_is_answered_while_the_program_is_held(answer_while: str) -> None:
    made = control({(Function.M, 8): Answer(None)})
    made.cycle_start()
    made.advance(LONG, until=lambda: made.status().channel.functions == ("M8",))
    if answer_while == "before":
        made.plc.answer()
    made.feed_hold()
    made.advance(100)
    if answer_while == "held":
        made.plc.answer()
    made.advance(100)
    assert made.channels[0].run_state is RunState.HOLD
    made.cycle_start()
    made.advance(100)
    if answer_while == "after":
        assert made.status().channel.functions == ("M8",)
        made.plc.answer()
    to_the_end(made)


@pytest.mark.parametrize("what", ["mode", "reset", "emergency", "alarm"])
def test_a_function_that_nobody_answers_holds_no_later_program(what: str) -> None:
    made = control(
        {(Function.M, 8): Answer(None)},
        mode_change_while_running=OnModeChange.RESET,
        emergency_needs_reset=False,
    )
    made.cycle_start()
    made.advance(LONG, until=lambda: made.status().channel.functions == ("M8",))
    if what == "mode":
        made.select_mode(Mode.MDI)
        made.select_mode(Mode.AUTO)
    elif what == "emergency":
        made.emergency_stop()
        made.advance(10)
        made.emergency_stop(False)
    elif what == "alarm":
        made.put_alarm("function_failed", detail="no air")
        made.advance(10)
        made.reset()
    else:
        made.reset()
    made.advance(10)
    assert made.status().channel.functions == ()
    assert made.plc.pending == ()
    made.plc.script(Function.M, 8, Answer(0.1))
    made.cycle_start()
    to_the_end(made)


# ---------------------------------------------------------------------- steps at the ends


def test_steps_over_and_out_at_the_ends_of_sub_programs() -> None:
    made = control()
    made.cycle_start(step=Step.INTO)
    assert until_it_stands(made) is RunState.STOPPED_AT_BLOCK
    assert sequence(made) == 10
    for _ in range(2):  # the call, and the first block in it
        made.cycle_start(step=Step.INTO)
        until_it_stands(made)
    assert sequence(made) == 1
    made.cycle_start(step=Step.OVER)  # the inner one as a whole
    until_it_stands(made)
    assert places(made)[:3] == (20.5, 2.75, -4.5)
    block = made.channels[0].executed
    assert block is not None
    assert len(block.stack) <= 2
    following = made.channels[0].next_block
    assert following is not None
    assert (following.program, following.sequence) == ("O0031", 3)
    made.cycle_start(step=Step.OVER)  # M99: back
    until_it_stands(made)
    following = made.channels[0].next_block
    assert following is not None
    assert (following.program, following.sequence) == ("MAIN", 30)
    made.cycle_start(step=Step.OUT)  # of the main program: to its end, but for the program stop
    assert until_it_stands(made) is RunState.PROGRAM_STOP
    made.cycle_start(step=Step.OUT)
    assert until_it_stands(made) is RunState.COMPLETED
    assert places(made) == END


def test_a_step_out_that_is_held_goes_on_as_far_as_the_next_start_says() -> None:
    made = control({(Function.M, 8): Answer(0.3)})
    made.cycle_start()
    to_block(made, 5)
    made.feed_hold()
    made.advance(100)
    status = made.status().channel
    assert status.block is not None
    assert [(call.program, call.line) for call in status.block.stack] == [("MAIN", 2), ("O0031", 2)]
    made.cycle_start(step=Step.OUT)
    made.advance(60)
    made.feed_hold()
    made.advance(100)
    made.cycle_start(step=Step.OUT)
    assert until_it_stands(made) is RunState.STOPPED_AT_BLOCK
    following = made.channels[0].next_block
    assert following is not None
    assert (following.program, following.sequence) == ("O0031", 3)
    to_the_end(made)


# ---------------------------------------------------------------------- MDI ends early


@pytest.mark.parametrize("how", ["reset", "emergency", "alarm"])
def test_mdi_that_is_broken_off_leaves_nothing_for_auto(how: str) -> None:
    made = control({(Function.M, 8): Answer(None)})
    made.select_mode(Mode.MDI)
    made.set_mdi("G91 G1 X4.25 F3000\nM98 P32\nM8\nX1.5")
    made.cycle_start()
    made.advance(LONG, until=lambda: made.status().channel.functions == ("M8",))
    if how == "emergency":
        made.emergency_stop()
        made.advance(20)
        made.emergency_stop(False)
    elif how == "alarm":
        made.put_alarm("following_error", axis="Y")
    made.reset()
    made.advance(300)
    assert made.status().emergency is Emergency.OFF
    assert made.status().channel.functions == ()
    made.plc.script(Function.M, 8, Answer(0.05))
    made.cycle_start()  # the text anew
    assert until_it_stands(made) is RunState.COMPLETED
    made.select_mode(Mode.AUTO)
    assert made.status().parts.made == 0
    made.cycle_start()
    made.advance(10)
    modal = made.status().channel.modal
    assert modal is not None
    assert "G90" in modal.g.values()
    to_the_end(made)
    assert made.status().parts.made == 1


def test_an_interrupted_program_survives_no_other_mode_than_by_its_own_start() -> None:
    made = control()
    made.cycle_start()
    to_block(made, 1)
    made.feed_hold()
    made.advance(200)
    stood = places(made)
    made.select_mode(Mode.MDI)
    for call in (partial(made.set_mdi, "G1 X0 F600"), made.cycle_start):
        with pytest.raises(ControlError):
            call()
    made.select_mode(Mode.EDIT)
    with pytest.raises(ControlError):
        made.edit("O0031")  # is being executed
    made.select_mode(Mode.AUTO)
    made.advance(100)
    assert places(made) == stood
    made.cycle_start()
    to_the_end(made)


def test_a_reset_within_a_sub_program_lets_all_its_programs_go() -> None:
    made = control()
    made.cycle_start()
    to_block(made, 5)
    assert made.programs.running == {"MAIN", "O0031", "O0032"}
    made.reset()
    made.advance(300)
    assert made.programs.running == frozenset()
    made.programs.write("O0032", INNER.replace("2.75", "4.125"))
    made.cycle_start()
    until_it_stands(made)
    assert places(made)[1] == 4.125


def test_machine_lock_and_an_emergency_stop() -> None:
    made = control()
    made.set_switches(machine_lock=True)
    made.cycle_start()
    to_block(made, 1)
    made.emergency_stop()
    made.advance(300)
    assert places(made) == (12.5, 0.0, 3.0, 0.0)
    made.emergency_stop(False)
    made.reset()
    made.set_switches(machine_lock=False)
    made.cycle_start()
    to_the_end(made)
