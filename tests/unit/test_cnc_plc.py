"""Auxiliary functions and the answers of the PLC model."""

from __future__ import annotations

import pytest

from polycnc.cnc import Answer, ControlError, Function, PlcModel
from polycnc.machine import Clock, TimesConfig

TIMES = TimesConfig(tool_change_s=3.5, auxiliary_s=0.25)


def test_without_a_script_answers_come_after_the_machine_files_times() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TIMES)
    m8 = plc.strobe(Function.M, 8)
    t7 = plc.strobe(Function.T, 7)
    s9 = plc.strobe(Function.S, 900)
    assert plc.finished(s9)
    assert [str(each) for each in plc.pending] == ["M8", "T7"]
    assert plc.due_cycle() == 250
    clock.tick(249)
    assert not plc.finished(m8)
    clock.tick(1)
    assert plc.finished(m8)
    assert not plc.finished(t7)
    assert plc.due_cycle() == 3500
    clock.tick(3250)
    assert plc.finished(t7)
    assert plc.due_cycle() is None


def test_the_caller_and_then_the_script_know_better() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TIMES, {(Function.M, 21): Answer(0.7), (Function.B, None): Answer(0.002)})
    plc.strobe(Function.M, 3, default_s=1.1)
    plc.strobe(Function.M, 21, default_s=1.1)
    plc.strobe(Function.B, 4)
    assert [each.due_cycle for each in plc.pending] == [1100, 700, 2]


def test_a_function_without_an_answer_waits_until_it_gets_one() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TIMES, {(Function.M, 60): Answer(None)})
    serial = plc.strobe(Function.M, 60)
    clock.tick(1_000_000)
    assert not plc.finished(serial)
    assert plc.due_cycle() is None
    plc.answer(serial)
    assert plc.finished(serial)
    with pytest.raises(ControlError, match="does not wait"):
        plc.answer(serial)
    with pytest.raises(ControlError, match="no auxiliary function waits"):
        plc.answer()


def test_an_alarm_is_no_answer() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TIMES, {(Function.M, 10): Answer(0.1, alarm="clamp is open")})
    serial = plc.strobe(Function.M, 10)
    clock.tick(100)
    assert not plc.finished(serial)
    assert [each.alarm for each in plc.take_failed()] == ["clamp is open"]
    assert plc.take_failed() == ()
    assert plc.pending == ()


def test_an_answer_that_does_not_come_in_time_has_failed() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TIMES, {(Function.M, 60): Answer(None)}, limit_s=2.0)
    plc.strobe(Function.M, 60)
    clock.tick(1999)
    assert plc.take_failed() == ()
    clock.tick(1)
    (failed,) = plc.take_failed()
    assert (str(failed), failed.timed_out) == ("M60", True)


def test_a_reset_withdraws_what_waits() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TIMES)
    plc.strobe(Function.M, 8)
    saved = plc.snapshot()
    plc.cancel()
    assert plc.pending == ()
    clock.tick(1000)
    assert plc.take_failed() == ()
    plc.restore(saved)
    assert plc.snapshot() == saved


@pytest.mark.parametrize(
    ("function", "number", "after_s"),
    [(Function.M, -1, 0.0), (Function.T, 3, -0.5), (Function.B, 3, float("nan"))],
)
def test_what_cannot_be_meant_is_refused(function: Function, number: int, after_s: float) -> None:
    plc = PlcModel(Clock(0.001), TIMES)
    with pytest.raises(ControlError):
        plc.strobe(function, number, default_s=after_s)
    with pytest.raises(ControlError):
        plc.script(function, number, Answer(after_s))
    with pytest.raises(ControlError):
        PlcModel(Clock(0.001), TIMES, {(function, number): Answer(after_s)})
    assert plc.pending == ()
