"""A control: its modes and commands, what refuses what, and what is left when a mode ends early."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.cnc import (
    AfterManual,
    Answer,
    ControlData,
    ControlEvent,
    Emergency,
    Function,
    Mode,
    Motion,
    OnModeChange,
    Parts,
    Refusal,
    RunState,
    Timer,
)
from support.cnc_control import control, refused, started, x_of

# ---------------------------------------------------------------------- programs


def test_a_program_runs_to_its_end_and_everything_is_counted() -> None:
    made = control()
    made.parts.set(required=2)
    refused(Refusal.NOT_FOUND, made.cycle_start, made)
    refused(Refusal.NOT_FOUND, lambda: made.select_program("NONE"), made)
    made.select_program("PART")
    assert made.status().channel.run_state is RunState.READY
    made.cycle_start()
    made.advance(300)
    status = made.status()
    assert (status.cycle, status.mode, status.channel.run_state) == (300, Mode.AUTO, RunState.ACTIVE)
    assert status.channel.motion is Motion.MOVING
    assert status.channel.program == "PART"
    block = status.channel.block
    assert block is not None
    assert (block.program, block.line, block.sequence, block.text) == ("PART", 2, 10, "N10 G1 X42.5 F3000")
    axis = status.axes["X"]
    assert axis.to_go == pytest.approx(42.5 - axis.machine)
    assert axis.velocity == pytest.approx(50.0)
    feed = status.channel.feed
    assert (feed.programmed, feed.commanded, feed.actual) == pytest.approx((3000.0, 3000.0, 3000.0))
    assert made.programs.running == {"PART"}
    passed = made.advance(100_000, until=ControlEvent.RUN_STATE)
    status = made.status()
    assert status.channel.run_state is RunState.COMPLETED
    assert status.channel.motion is Motion.NONE
    assert status.axes["X"].machine == 12.5
    assert status.parts == Parts(1, 2, 1)
    assert passed < 1200
    assert status.timers_s[Timer.CYCLE] == pytest.approx(status.time_s)
    assert status.timers_s[Timer.CUTTING] == pytest.approx(status.time_s, abs=0.01)
    assert made.programs.running == frozenset()
    made.cycle_start()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert made.status().parts == Parts(2, 2, 2)


def test_a_run_in_pieces_is_the_run_in_one() -> None:
    one, other = started(), started()
    one.advance(1000)
    for cycles in (1, 7, 100, 392, 500):
        other.advance(cycles)
    assert one.status() == other.status()


def test_a_condition_is_looked_at_in_every_cycle() -> None:
    made = started()
    made.advance(100_000, until=lambda: x_of(made) >= 20.0)
    assert 20.0 <= x_of(made) < 20.051


def test_a_hold_stands_and_a_start_goes_on_to_the_same_end() -> None:
    made = started()
    made.advance(300)
    made.feed_hold()
    refused(Refusal.IDLE, made.feed_hold, made)
    made.advance(500)
    status = made.status()
    assert status.channel.run_state is RunState.HOLD
    assert status.axes["X"].velocity == 0.0
    assert status.axes["X"].to_go > 0.0
    stood = status.axes["X"].machine
    made.advance(500)
    assert x_of(made) == stood
    assert status.timers_s[Timer.OPERATING] == pytest.approx(0.3)
    made.cycle_start()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 12.5


def test_a_program_is_in_use_while_it_runs_stands_or_was_broken_off_by_an_alarm() -> None:
    made = started()
    (channel,) = made.channels
    assert channel.programs == {"PART"}
    made.advance(100)
    made.feed_hold()
    made.advance(400)
    assert channel.programs == {"PART"}
    refused(Refusal.IN_USE, lambda: made.programs.delete("PART"), made)
    made.cycle_start()
    made.advance(3000)
    assert channel.programs == frozenset()
    made.programs.delete("PART")


def test_a_reset_tells_whoever_waits_for_a_change_of_state() -> None:
    made = started()
    made.advance(100)
    assert not made.raised & ControlEvent.RUN_STATE
    made.reset()
    assert made.raised & ControlEvent.RUN_STATE


def test_a_start_while_the_axes_still_brake_is_refused() -> None:
    made = started()
    made.advance(300)
    made.reset()
    made.advance(5)
    refused(Refusal.RUNNING, made.cycle_start, made)
    made.advance(200)
    made.cycle_start()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state is RunState.COMPLETED
    assert x_of(made) == 12.5


def test_override_0_in_single_block_neither_ends_nor_skips_a_block() -> None:
    made = control()
    made.set_switches(single_block=True)
    made.select_program("PART")
    made.cycle_start()
    made.advance(10, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state == RunState.STOPPED_AT_BLOCK  # after the line with the O number
    made.advance(50)
    assert x_of(made) == 12.5
    made.cycle_start()
    made.advance(200)
    made.set_overrides(feed=0.0)
    made.advance(5000)
    assert made.status().channel.run_state is RunState.ACTIVE
    assert made.status().axes["X"].velocity == 0.0
    made.set_overrides(feed=1.3)
    made.advance(5000, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state is RunState.STOPPED_AT_BLOCK
    assert x_of(made) == 42.5
    made.set_overrides(feed=0.0)
    made.cycle_start()
    made.advance(700)
    assert x_of(made) == 42.5
    made.reset()
    made.set_overrides(feed=1.0)
    made.advance(700)
    assert x_of(made) == 42.5
    assert made.status().channel.run_state is RunState.RESET


def test_mdi_executes_a_text_and_leaves_the_selected_program_alone() -> None:
    made = control()
    made.select_program("PART")
    refused(Refusal.MODE, lambda: made.set_mdi("G1 X15 F600"), made)
    made.select_mode(Mode.MDI)
    refused(Refusal.NOT_FOUND, made.cycle_start, made)
    refused(Refusal.DATA, lambda: made.set_mdi("  \n"), made)
    made.set_mdi("G1 X15 F600")
    made.cycle_start()
    made.advance(100)
    refused(Refusal.RUNNING, lambda: made.set_mdi("G1 X16"), made)
    refused(Refusal.RUNNING, lambda: made.select_program("SLOT"), made)
    made.feed_hold()
    made.advance(200)
    made.select_mode(Mode.AUTO)
    refused(Refusal.MODE, made.cycle_start, made)
    made.select_mode(Mode.MDI)
    made.cycle_start()
    made.advance(10_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 15.0
    assert made.status().parts == Parts()
    assert made.status().channel.program == "PART"


def test_an_error_of_the_program_is_an_alarm_that_a_reset_clears() -> None:
    made = control()
    made.programs.create("BAD", "N10 G1 X20 F600\nN20 G1 X200\nM30\n")
    made.select_program("BAD")
    made.cycle_start()
    made.advance(5000)
    status = made.status()
    assert status.channel.run_state is RunState.ALARM
    (alarm,) = status.alarms
    assert alarm.number == 100
    assert "BAD:2" in alarm.text
    assert status.parts == Parts()
    refused(Refusal.ALARM, made.cycle_start, made)
    made.reset()
    assert made.status().alarms == ()
    made.select_program("PART")
    made.cycle_start()
    made.advance(5000)
    assert x_of(made) == 12.5


# ---------------------------------------------------------------------- modes


def test_the_mode_cannot_change_under_a_running_program() -> None:
    made = started()
    made.advance(100)
    refused(Refusal.RUNNING, lambda: made.select_mode(Mode.JOG), made)
    made.select_mode(Mode.AUTO)
    refused(Refusal.DATA, lambda: made.select_mode("automatic"), made)  # type: ignore[arg-type]
    made.feed_hold()
    made.select_mode(Mode.JOG)
    assert made.status().mode is Mode.JOG


@pytest.mark.parametrize(
    ("what", "state"), [(OnModeChange.HOLD, RunState.HOLD), (OnModeChange.RESET, RunState.RESET)]
)
def test_a_change_of_mode_holds_or_resets_where_the_control_is_made_so(
    what: OnModeChange, state: RunState
) -> None:
    made = started(ControlData(mode_change_while_running=what))
    made.advance(100)
    made.select_mode(Mode.JOG)
    assert made.status().channel.run_state is state
    made.advance(300)
    assert made.status().axes["X"].velocity == 0.0


def test_manual_motion_needs_its_mode() -> None:
    made = control()
    calls: tuple[tuple[Mode, Callable[[], object]], ...] = (
        (Mode.JOG, lambda: made.jog("X", 1)),
        (Mode.INC, lambda: made.increment("X", 1, 0.1)),
        (Mode.HANDLE, lambda: made.handwheel("X", 1, 0.1)),
        (Mode.REF, lambda: made.reference("X")),
    )
    for mode, call in calls:
        for other in Mode:
            made.select_mode(other)
            if other is not mode:
                refused(Refusal.MODE, call, made)
        made.select_mode(mode)
        call()
        assert made.manual.active
        made.select_mode(Mode.EDIT)
        made.advance(3000)
        assert not made.manual.active
    refused(Refusal.MODE, made.cycle_start, made)


def test_a_mode_that_ends_early_leaves_nothing_moving_and_nothing_armed() -> None:
    made = control(ControlData(referenced_at_start=False))
    made.select_mode(Mode.REF)
    made.reference("X")
    made.advance(700)
    made.select_mode(Mode.JOG)
    made.advance(1000)
    assert made.status().axes["X"].velocity == 0.0
    assert not made.status().axes["X"].referenced
    made.jog("Y", 1)
    made.advance(100)
    made.select_mode(Mode.AUTO)
    made.advance(1000)
    assert made.status().axes["Y"].velocity == 0.0
    made.jog("Y", None)
    made.select_program("PART")
    refused(Refusal.NOT_REFERENCED, made.cycle_start, made)
    made.select_mode(Mode.REF)
    for axis in "XYZB":
        made.reference(axis)
    made.advance(60_000, until=ControlEvent.MANUAL)
    assert all(axis.referenced for axis in made.status().axes.values())
    made.select_mode(Mode.AUTO)
    made.cycle_start()


def test_editing_in_fore_and_background() -> None:
    made = control()
    refused(Refusal.MODE, lambda: made.edit("PART"), made)
    made.select_mode(Mode.EDIT)
    edit = made.edit("PART")
    refused(Refusal.IN_USE, lambda: made.edit("SLOT"), made)
    edit.replace(2, "N10 G1 X22.5 F3000")
    made.select_mode(Mode.AUTO)
    assert not edit.is_open
    made.select_program("PART")
    made.cycle_start()
    made.advance(10)
    refused(Refusal.IN_USE, lambda: made.edit("PART", background=True), made)
    back = made.edit("SLOT", background=True)
    back.insert(1, "N5 G4 P1")
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 12.5
    back.close()


def test_a_program_that_was_edited_between_two_starts_runs_as_it_is_now() -> None:
    made = started()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    made.programs.write("PART", "G1 X14.25 F3000\nM30\n")
    made.cycle_start()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 14.25


# ---------------------------------------------------------------------- by hand, in between


def test_axes_moved_during_an_interruption_must_be_back() -> None:
    made = started()
    made.advance(300)
    made.feed_hold()
    made.select_mode(Mode.JOG)
    refused(Refusal.RUNNING, lambda: made.jog("Y", 1), made)  # still braking
    made.advance(300)
    stood = x_of(made)
    made.jog("Y", 1)
    made.advance(200)
    made.jog("Y", None)
    made.advance(200)
    away = made.status().axes["Y"].machine
    assert away > 1.0
    made.select_mode(Mode.AUTO)
    refused(Refusal.DISPLACED, made.cycle_start, made)
    made.select_mode(Mode.INC)
    made.increment("Y", -1, away)
    made.advance(3000)
    made.select_mode(Mode.AUTO)
    assert made.status().axes["Y"].machine == 0.0
    made.cycle_start()
    made.advance(1)
    assert x_of(made) >= stood
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 12.5


def test_or_they_return_by_themselves() -> None:
    made = started(ControlData(after_manual=AfterManual.RETURN))
    made.advance(300)
    made.feed_hold()
    made.advance(300)
    stood = x_of(made)
    made.select_mode(Mode.JOG)
    made.jog("X", -1)
    made.advance(500)
    made.select_mode(Mode.AUTO)
    refused(Refusal.RUNNING, made.cycle_start, made)
    made.advance(500)
    made.cycle_start()
    assert made.status().channel.returning
    refused(Refusal.RUNNING, made.cycle_start, made)
    made.advance(20)
    made.feed_hold()  # in the middle of the return
    made.advance(500)
    assert not made.status().channel.returning
    assert x_of(made) != stood
    made.cycle_start()
    made.advance(100_000, until=lambda: not made.status().channel.returning)
    assert x_of(made) == stood
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state is RunState.COMPLETED
    assert x_of(made) == 12.5


def test_a_reset_after_moving_by_hand_forgets_the_interruption() -> None:
    made = started()
    made.advance(300)
    made.feed_hold()
    made.advance(300)
    made.select_mode(Mode.JOG)
    made.jog("Z", -1)
    made.advance(100)
    made.reset()
    made.advance(300)
    assert not made.manual.active
    made.select_mode(Mode.AUTO)
    made.cycle_start()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 12.5


# ---------------------------------------------------------------------- PLC, spindle


def test_a_function_holds_the_program_until_the_plc_has_answered() -> None:
    made = started(program="SLOT", script={(Function.M, 8): Answer(None)})
    made.advance(1500)
    status = made.status()
    assert status.channel.functions == ("M8",)
    assert status.channel.run_state is RunState.ACTIVE
    assert status.axes["X"].machine == 20.0
    # A hold while the PLC is awaited, its answer, then the start: neither keeps the other for ever.
    made.feed_hold()
    made.plc.answer()
    made.advance(1000)
    assert made.status().axes["X"].machine == 20.0
    assert made.status().channel.run_state is RunState.HOLD
    made.cycle_start()
    made.advance(20_000, until=ControlEvent.RUN_STATE)
    assert made.status().axes["X"].machine == 30.0
    assert made.status().channel.functions == ()


def test_the_answer_may_come_after_the_start() -> None:
    made = started(program="SLOT", script={(Function.M, 8): Answer(None)})
    made.advance(1500)
    made.feed_hold()
    made.advance(10)
    made.cycle_start()
    made.advance(1000)
    assert made.status().axes["X"].machine == 20.0
    made.plc.answer()
    made.advance(1500)
    assert made.status().channel.run_state is RunState.COMPLETED


def test_a_reset_while_the_plc_is_awaited_withdraws_the_function() -> None:
    made = started(program="SLOT", script={(Function.M, 8): Answer(None)})
    made.advance(1500)
    made.reset()
    assert made.plc.pending == ()
    made.advance(10)
    made.select_program("PART")
    made.cycle_start()
    made.advance(20_000, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state is RunState.COMPLETED


@pytest.mark.parametrize(
    ("answer", "limit_s", "number"), [(Answer(0.2, alarm="no pressure"), None, 310), (Answer(None), 0.5, 311)]
)
def test_a_function_that_fails_is_an_alarm(answer: Answer, limit_s: float | None, number: int) -> None:
    made = started(ControlData(answer_limit_s=limit_s), "SLOT", script={(Function.M, 8): answer})
    made.advance(1500)
    (alarm,) = made.status().alarms
    assert alarm.number == number
    assert "M8" in alarm.text
    assert made.status().channel.run_state is RunState.ALARM
    refused(Refusal.ALARM, made.cycle_start, made)
    made.reset()
    made.advance(10)
    made.select_program("PART")
    made.cycle_start()


def test_the_time_of_a_tool_is_what_it_cut() -> None:
    """X 12.5 to 42.5 at 50 mm/s with tool 4: 0.6 s and a ramp of 50/700 s; the other way without a tool."""
    made = control()
    made.programs.create("CHANGE", "G1 X42.5 F3000\nT4 M6\nG1 X12.5\nG0 X20\nM30\n")
    for program, tools in (("PART", ()), ("CHANGE", (4,))):
        made.select_program(program)
        made.cycle_start()
        made.advance(20_000, until=ControlEvent.RUN_STATE)
        made.advance(20)
        assert made.timers.tools == tools
    assert made.timers.tool_seconds(4) == pytest.approx(0.6 + 50.0 / 700.0, abs=2e-3)
    assert made.timers.seconds(Timer.CUTTING) == pytest.approx(4 * (0.6 + 50.0 / 700.0), abs=0.01)


def test_the_spindle_follows_the_program_and_stops_with_a_reset() -> None:
    made = control()
    made.programs.create("TURN", "S1500 M3\nG1 X42.5 F60\nM5\nM30\n")
    made.select_program("TURN")
    made.cycle_start()
    made.advance(2000)
    spindle = made.status().spindle
    assert (spindle.commanded_rpm, spindle.direction, spindle.reached) == (1500.0, 1, True)
    made.set_overrides(spindle=0.5)
    made.advance(1000)
    assert made.status().spindle.actual_rpm == 750.0
    made.reset()
    made.advance(1000)
    assert made.status().spindle.actual_rpm == 0.0


@pytest.mark.parametrize(("end", "stops", "direction"), [
    ("M30", True, 0), ("M2", True, 0), ("M30", False, -1), ("", True, -1),
])  # fmt: skip
def test_the_end_of_a_program_stops_the_spindle_after_its_motion(
    end: str, stops: bool, direction: int
) -> None:
    made = control(data=ControlData(end_stops_spindle=stops))
    made.programs.create("TURN", f"S900 M4\nG1 X2.5 F600 {end}\n")
    made.select_program("TURN")
    made.cycle_start()
    made.advance(340)
    assert made.status().spindle.direction == -1
    made.advance(20_000, until=ControlEvent.RUN_STATE)
    assert made.channels[0].run_state is RunState.COMPLETED
    assert made.status().spindle.direction == direction
    assert made.status().spindle.commanded_rpm == 900.0 * direction


@pytest.mark.parametrize(("returns", "direction"), [(True, 1), (False, 0)])
def test_an_end_that_returns_to_its_caller_lets_the_spindle_turn(returns: bool, direction: int) -> None:
    made = control()
    calls = made.dialect.sub_program.model_copy(update={"end_returns": returns})
    made.change_dialect(made.dialect.model_copy(update={"sub_program": calls}))
    made.programs.create("CALL", "S700 M3\nM98 P12\nG4 P2.5\nM5\nM30\n")
    made.programs.create("O0012", "G1 X1.5 F900\nM30\n")
    made.select_program("CALL")
    made.cycle_start()
    made.advance(2000)
    assert made.status().spindle.direction == direction


# ---------------------------------------------------------------------- emergency, limits


def test_an_emergency_stop_breaks_everything_off_and_wants_a_reset() -> None:
    made = started()
    made.advance(300)
    made.emergency_stop()
    made.emergency_stop()
    assert made.status().emergency is Emergency.ON
    refused(Refusal.EMERGENCY, made.cycle_start, made)
    made.advance(300)
    status = made.status()
    assert status.axes["X"].velocity == 0.0
    assert [alarm.number for alarm in status.alarms] == [400]
    made.reset()
    assert made.status().emergency is Emergency.ON
    assert [alarm.number for alarm in made.status().alarms] == [400]
    made.select_mode(Mode.JOG)
    refused(Refusal.EMERGENCY, lambda: made.jog("X", 1), made)
    made.emergency_stop(False)
    assert made.status().emergency is Emergency.RESET_NEEDED
    refused(Refusal.EMERGENCY, lambda: made.jog("X", 1), made)
    made.reset()
    made.jog("X", -1)
    made.advance(100)
    made.emergency_stop()
    made.advance(300)
    assert not made.manual.active
    made.jog("X", None)
    made.emergency_stop(False)
    made.reset()
    made.select_mode(Mode.AUTO)
    made.cycle_start()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 12.5
    assert len(made.alarms.history()) == 2


def test_an_overtravel_stops_the_axis_which_can_only_go_back() -> None:
    made = control(ControlData(referenced_at_start=False))
    made.select_mode(Mode.JOG)
    made.jog("X", 1, rapid=True)
    made.advance(5000, until=ControlEvent.ALARM)
    made.advance(500)
    assert [alarm.number for alarm in made.status().alarms] == [213]
    refused(Refusal.TRAVEL, lambda: made.jog("X", 1), made)
    made.reset()
    assert [alarm.number for alarm in made.status().alarms] == [213]
    made.jog("X", -1)
    made.advance(2000)
    made.jog("X", None)
    made.advance(300)
    made.reset()
    assert made.status().alarms == ()


def test_a_limit_switch_in_a_program_is_an_alarm_that_stops_it() -> None:
    made = started()
    made.machine.state.switches.switch[0][1]["on_from"] = 30.0
    made.advance(5000)
    status = made.status()
    assert [alarm.number for alarm in status.alarms] == [213]
    assert status.channel.run_state is RunState.ALARM
    assert 30.0 < status.axes["X"].machine < 34.0
    made.reset()
    made.advance(100)
    made.select_mode(Mode.JOG)
    made.jog("X", -1)
    made.advance(500)
    made.jog("X", None)
    made.advance(100)
    made.reset()
    assert made.status().alarms == ()
