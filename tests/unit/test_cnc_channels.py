"""A control with two channels: each executes its own program, with its own axes, mode, overrides and alarms."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.cnc import (
    AlarmKind,
    Answer,
    ChannelData,
    Control,
    ControlData,
    ControlError,
    ControlEvent,
    Emergency,
    Function,
    Mode,
    OnModeChange,
    Parts,
    Refusal,
    RunState,
)
from polycnc.errors import UsageError
from support.cnc_machine import cnc_machine
from support.programs import AXIS, machine_config, refusal

LONG_S = 100_000
FIRST = "N10 G1 X42.5 Y7.5 F1500\nN20 X13.5 Y-4.25\nN30 M30\n"
SECOND = "N5 G1 Z-31.25 F600\nN6 B75 F2000\nN7 Z2.5 B15 F700\nN8 M30\n"
SHARES = (ChannelData(("X", "Y"), spindle=True), ChannelData(("Z", "B")))


def control(data: ControlData | None = None, **keys: object) -> Control:
    made = Control(cnc_machine(), data=data, channels=SHARES, **keys)  # type: ignore[arg-type]
    made.programs.create("FIRST", FIRST)
    made.programs.create("SECOND", SECOND)
    made.select_program("FIRST")
    made.select_program("SECOND", channel=1)
    return made


def started(data: ControlData | None = None, **keys: object) -> Control:
    made = control(data, **keys)
    made.cycle_start()
    made.cycle_start(channel=1)
    return made


def refused(reason: Refusal, call: Callable[[], object], made: Control) -> None:
    before = made.status()
    with pytest.raises(ControlError) as caught:
        call()
    assert caught.value.reason is reason
    assert caught.value.hint
    assert made.status() == before


def places(made: Control) -> tuple[float, ...]:
    return tuple(axis.machine for axis in made.status().axes.values())


def alone(program: str, cycles: int) -> tuple[float, ...]:
    """Return where a program of its own control is after so many cycles."""
    made = Control(cnc_machine())
    made.programs.create("P", program)
    made.select_program("P")
    made.cycle_start()
    made.advance(cycles)
    return places(made)


def to_the_end(made: Control) -> int:
    return made.advance(LONG_S, until=lambda: not any(channel.active for channel in made.channels))


# ---------------------------------------------------------------------- side by side


def test_two_programs_are_under_way_at_once_each_as_if_alone() -> None:
    made = started()
    made.advance(333)
    first, second = alone(FIRST, 333), alone(SECOND, 333)
    assert places(made) == (first[0], first[1], second[2], second[3])
    assert first[0] != 12.5
    assert second[2] != 3.0
    status = made.status()
    assert [each.program for each in status.channels] == ["FIRST", "SECOND"]
    assert [each.axes for each in status.channels] == [("X", "Y"), ("Z", "B")]
    blocks = [each.block for each in status.channels]
    assert [(block.program, block.sequence) for block in blocks if block is not None] == [
        ("FIRST", 10),
        ("SECOND", 5),
    ]
    assert [each.feed.commanded for each in status.channels] == pytest.approx([1500.0, 600.0])
    to_go = {name: axis.to_go for name, axis in status.axes.items()}
    assert to_go["X"] == pytest.approx(42.5 - first[0])
    assert to_go["Z"] == pytest.approx(-31.25 - second[2])
    assert to_go["B"] == 0.0
    assert made.programs.running == {"FIRST", "SECOND"}
    to_the_end(made)
    assert [channel.run_state for channel in made.channels] == [RunState.COMPLETED] * 2
    assert places(made) == (13.5, -4.25, 2.5, 15.0)
    assert made.status().parts == Parts(1, 0, 1)  # the first channel counts


def test_one_is_held_while_the_other_goes_on() -> None:
    made = started()
    made.advance(200)
    made.feed_hold(channel=0)
    made.advance(150)
    stood = places(made)[:2]
    made.advance(400)
    assert places(made)[:2] == stood
    assert places(made)[2:] == alone(SECOND, 750)[2:]
    assert [channel.run_state for channel in made.channels] == [RunState.HOLD, RunState.ACTIVE]
    refused(Refusal.IDLE, lambda: made.feed_hold(channel=0), made)
    made.cycle_start(channel=0)
    to_the_end(made)
    assert places(made) == (13.5, -4.25, 2.5, 15.0)


def test_overrides_and_switches_are_those_of_a_channel() -> None:
    made = started()
    made.set_overrides(feed=0.0, channel=1)
    made.set_switches(single_block=True, channel=0)
    made.advance(2500)
    assert made.channels[0].run_state is RunState.STOPPED_AT_BLOCK
    assert places(made) == (42.5, 7.5, 3.0, 0.0)
    status = made.status()
    assert [each.overrides.feed for each in status.channels] == [1.0, 0.0]
    assert [each.switches.single_block for each in status.channels] == [True, False]
    assert status.switches.single_block
    refused(Refusal.DATA, lambda: made.set_overrides(feed=2.5, channel=1), made)
    refused(Refusal.DATA, lambda: made.set_overrides(feed=0.5, channel=2), made)
    made.set_overrides(feed=1.25)
    made.cycle_start()
    made.advance(LONG_S, until=lambda: not made.channels[1].active)
    assert places(made)[2:] == (2.5, 15.0)
    assert [each.overrides.feed for each in made.status().channels] == [1.25, 1.25]


def test_each_has_its_mode() -> None:
    made = control()
    made.cycle_start()
    made.select_mode(Mode.JOG, channel=1)
    made.advance(100)
    assert [each.mode for each in made.status().channels] == [Mode.AUTO, Mode.JOG]
    refused(Refusal.MODE, lambda: made.jog("X", 1), made)
    refused(Refusal.MODE, lambda: made.cycle_start(channel=1), made)
    refused(Refusal.RUNNING, lambda: made.select_mode(Mode.MDI), made)  # the first one is executing
    made.jog("Z", -1)
    made.advance(300)
    assert places(made)[2] < 3.0
    assert places(made)[:2] == alone(FIRST, 400)[:2]
    made.set_overrides(feed=0.0, channel=0)  # jogging goes on
    made.advance(200)
    assert made.status().axes["Z"].velocity == pytest.approx(-12.0)
    assert made.status().axes["X"].velocity == 0.0
    made.feed_hold(channel=0)
    made.advance(10)
    assert made.status().axes["Z"].velocity == pytest.approx(-12.0)
    made.select_mode(Mode.MDI, channel=1)
    made.set_mdi("G1 Z-12.75 F900", channel=1)
    refused(Refusal.RUNNING, lambda: made.cycle_start(channel=1), made)  # the axis still brakes
    made.advance(500)
    made.cycle_start(channel=1)
    made.advance(LONG_S, until=lambda: not made.channels[1].active)
    assert places(made)[2] == -12.75
    assert made.channels[0].run_state is RunState.HOLD


# ---------------------------------------------------------------------- what goes wrong


def test_a_word_for_the_axis_of_another_channel_is_an_error_of_the_program() -> None:
    made = control()
    made.programs.write("FIRST", "N1 G1 X20.5 F900\nN2 Z1\nN3 M30\n")
    made.cycle_start()
    made.cycle_start(channel=1)
    made.advance(1500)
    (alarm,) = made.status().alarms
    assert "axis 'Z' belongs to another channel" in alarm.text
    assert "FIRST:2" in alarm.text
    assert (alarm.kind, alarm.channel) == (AlarmKind.PROGRAM, 0)
    assert places(made)[0] == 20.5
    assert made.channels[1].active
    assert places(made)[2:] == alone(SECOND, 1500)[2:]


@pytest.mark.parametrize(
    ("block", "column", "what"),
    [
        ("G43 H1", 4, "tool length compensation along axis Z, which belongs to another channel"),
        ("G1 X3 G44 H2", 10, "tool length compensation along axis Z, which belongs to another channel"),
    ],
)
def test_a_length_along_the_axis_of_another_channel_is_refused_at_its_word(
    block: str, column: int, what: str
) -> None:
    made = control()
    made.programs.write("FIRST", f"N1 G49 X20.5 F900\nN2 {block}\nN3 M30\n")
    made.cycle_start()
    made.advance(1500)
    (alarm,) = made.status().alarms
    assert what in alarm.text
    assert f"FIRST:2:{column}" in alarm.text
    assert places(made)[0] == 20.5


def test_a_turret_whose_offset_moves_the_axis_of_another_channel_is_refused_at_its_word() -> None:
    lathe = machine_config(
        "".join(AXIS.format(name=name, low=-300, high=300) for name in "XZ"),
        "[tools.3]\nx_mm = 2.5\n[tools.4]\nx_mm = 1.5\nz_mm = -7.25\n",
    )
    text = refusal("T0303\nG1 X2 F90 T0304\n", config=lathe, dialect="fanuc-lathe", axes=("X", "(Z)"))
    assert text == "2:11: offset 4 moves axis Z, which belongs to another channel"


def test_an_alarm_in_one_leaves_the_other_alone() -> None:
    made = started()
    made.advance(200)
    made.put_alarm("following_error", axis="Z")
    made.advance(300)
    at = places(made)[2]
    made.advance(200)
    assert places(made)[2] == at
    assert [channel.run_state for channel in made.channels] == [RunState.ALARM, RunState.ACTIVE][::-1]
    refused(Refusal.ALARM, lambda: made.cycle_start(channel=1), made)
    assert places(made)[:2] == alone(FIRST, 700)[:2]
    made.advance(LONG_S, until=ControlEvent.RUN_STATE)
    made.cycle_start(channel=0)  # the alarm of the other one does not keep it from starting
    made.advance(50)
    made.reset(channel=1)
    assert made.status().alarms == ()
    assert made.channels[0].active
    made.cycle_start(channel=1)
    to_the_end(made)
    assert places(made) == (13.5, -4.25, 2.5, 15.0)


def test_a_limit_switch_stops_the_channel_of_its_axis() -> None:
    machine = cnc_machine()
    axes = (machine.axes[0].model_copy(update={"limit_switches_mm": (-60.0, 31.5)}), *machine.axes[1:])
    made = Control(machine.model_copy(update={"axis": axes, "axes": axes}), channels=SHARES)
    made.select_mode(Mode.JOG, channel=1)
    made.programs.create("FIRST", FIRST)
    made.select_program("FIRST")
    made.cycle_start()
    made.jog("B", 1)
    made.advance(3000)
    assert made.channels[0].run_state is RunState.ALARM
    assert [(alarm.axis, alarm.channel) for alarm in made.status().alarms] == [("X", 0)]
    assert made.status().axes["X"].velocity == 0.0
    assert made.status().axes["B"].velocity > 0.0


def test_an_alarm_of_the_whole_control_stops_both() -> None:
    made = started()
    made.advance(200)
    made.put_alarm("function_failed", detail="no air")
    made.advance(400)
    at = places(made)
    made.advance(200)
    assert places(made) == at
    assert [channel.run_state for channel in made.channels] == [RunState.ALARM] * 2
    made.reset(channel=0)
    assert made.channels[0].run_state is RunState.RESET
    refused(Refusal.ALARM, made.cycle_start, made)
    made.reset()
    assert [channel.run_state for channel in made.channels] == [RunState.RESET] * 2
    made.cycle_start()


def test_an_emergency_stop_stops_both_and_wants_a_reset_of_all() -> None:
    made = started()
    made.advance(200)
    made.emergency_stop()
    made.advance(500)
    at = places(made)
    assert all(axis.velocity == 0.0 for axis in made.status().axes.values())
    assert [channel.run_state for channel in made.channels] == [RunState.RESET] * 2
    made.emergency_stop(False)
    for channel in (0, 1):
        made.reset(channel=channel)
        refused(Refusal.EMERGENCY, lambda n=channel: made.cycle_start(channel=n), made)  # type: ignore[misc]
    made.reset()
    assert made.status().emergency is Emergency.OFF
    made.advance(100)
    assert places(made) == at
    made.cycle_start(channel=1)
    made.advance(LONG_S, until=lambda: not made.channels[1].active)
    assert places(made) == (*at[:2], 2.5, 15.0)


def test_functions_are_awaited_by_the_channel_that_came_to_them() -> None:
    script = {(Function.M, 8): Answer(None), (Function.M, 9): Answer(0.25)}
    made = control(script=script)
    made.programs.write("FIRST", "N1 M3 S900\nN2 M8\nN3 G1 X20.5 F900\nN4 M30\n")
    made.programs.write("SECOND", "N1 M9\nN2 G1 Z-4.5 F900\nN3 M8\nN4 M30\n")
    made.cycle_start()
    made.cycle_start(channel=1)
    made.advance(1200)
    assert [each.functions for each in made.status().channels] == [("M8",), ("M8",)]
    assert places(made) == (12.5, 0.0, -4.5, 0.0)
    assert made.status().spindle.commanded_rpm == 900.0  # M9 of the other channel has not stopped it
    made.reset(channel=1)
    assert [each.functions for each in made.status().channels] == [("M8",), ()]
    assert made.status().spindle.commanded_rpm == 900.0
    made.plc.answer()
    made.advance(2000)
    assert places(made)[0] == 20.5
    assert made.channels[0].run_state is RunState.COMPLETED


def test_a_failed_function_is_the_alarm_of_its_channel() -> None:
    made = control(script={(Function.M, 8): Answer(0.1, alarm="no coolant")})
    made.programs.write("SECOND", "N1 G1 Z-4.5 F900\nN2 M8\nN3 Z1.5\nN4 M30\n")
    made.cycle_start()
    made.cycle_start(channel=1)
    made.advance(900)
    assert [(alarm.text, alarm.channel) for alarm in made.status().alarms] == [("M8: no coolant", 1)]
    assert [channel.run_state for channel in made.channels] == [RunState.ACTIVE, RunState.ALARM]


@pytest.mark.parametrize("what", [OnModeChange.HOLD, OnModeChange.RESET])
def test_a_change_of_mode_of_one_leaves_the_other_alone(what: OnModeChange) -> None:
    made = started(ControlData(mode_change_while_running=what))
    made.advance(200)
    made.select_mode(Mode.MDI, channel=1)
    made.advance(300)
    assert made.channels[1].run_state is (RunState.HOLD if what is OnModeChange.HOLD else RunState.RESET)
    assert places(made)[:2] == alone(FIRST, 500)[:2]


# ---------------------------------------------------------------------- sharing out


@pytest.mark.parametrize(
    ("shares", "message"),
    [
        ((ChannelData(("X", "Y")), ChannelData(("Y", "Z", "B"))), "axis Y belongs to 2 channels"),
        ((ChannelData(("X", "Y")), ChannelData(("Z",))), "axis B belongs to no channel"),
        ((ChannelData(("X", "Y", "Z", "B", "C")),), "no axis 'C'"),
        ((ChannelData(("X", "Y", "Z", "B")), ChannelData(())), "has no axes"),
        ((ChannelData(("X", "Y"), spindle=True), ChannelData(("Z", "B"), spindle=True)), "spindle"),
    ],
)
def test_channels_that_do_not_share_out_the_axes_are_refused(
    shares: tuple[ChannelData, ...], message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        Control(cnc_machine(), channels=shares)


def test_a_snapshot_of_both_goes_on_as_the_undisturbed_control() -> None:
    made = started()
    made.advance(222)
    made.set_overrides(feed=0.75, channel=1)
    saved = made.snapshot()
    ends = []
    for _ in range(2):
        made.advance(77)
        made.feed_hold(channel=0)
        made.advance(900)
        made.cycle_start()
        passed = to_the_end(made)
        ends.append((passed, places(made), made.status().channels[1].overrides.feed))
        made.select_mode(Mode.EDIT, channel=1)
        made.restore(saved)
        assert made.snapshot() == saved
        assert made.channels[1].mode is Mode.AUTO
    assert ends[0] == ends[1]
    assert ends[0][1:] == ((13.5, -4.25, 2.5, 15.0), 0.75)
