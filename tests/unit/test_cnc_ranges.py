"""The parts of a control at the ends of their ranges, and each by itself: what is just allowed, and what is not."""

from __future__ import annotations

import inspect
import math
import re
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from polycnc.cnc import (
    ALARMS,
    AlarmKind,
    AlarmList,
    AlarmRow,
    Answer,
    ChannelData,
    Control,
    ControlData,
    ControlError,
    Found,
    Function,
    ManualData,
    MemoryData,
    Mode,
    Motion,
    OffsetTable,
    OperatorMessages,
    Overrides,
    PartCounter,
    Parts,
    PlcModel,
    ProgramEdit,
    ProgramMemory,
    Refusal,
    Spindle,
    Timer,
    Timers,
    Tool,
    ToolTable,
    ToolTime,
)
from polycnc.cnc._plc import functions_of
from polycnc.cnc._program_edit import ProgramEdits
from polycnc.cnc._program_memory import first_comment
from polycnc.cnc._reference_steps import reference_steps
from polycnc.cnc._run_selection import block_line
from polycnc.cnc._tool_times import ToolTimes
from polycnc.errors import PolycncError, ProgramError, UsageError
from polycnc.machine import Clock, MachineConfig, Store, TimesConfig
from polycnc.nc import ProgramText
from support.cnc_control import control, started
from support.cnc_machine import cnc_machine

CONFIG = cnc_machine()


def _refused(reason: Refusal, call: Any, match: str = "") -> None:
    with pytest.raises(ControlError, match=match) as caught:
        call()
    assert caught.value.reason is reason
    assert caught.value.hint


# --- alarms and messages


def test_an_alarm_belongs_to_the_channel_of_its_axis() -> None:
    alarms = AlarmList(Store(), Clock(0.001), owners={"X": 0, "Z": 1})
    of_axis = alarms.put("following_error", axis="Z", channel=0)
    own = alarms.put("program", detail="wrong", channel=0)
    whole = alarms.put("function_failed", detail="M8")
    assert [each.channel for each in (of_axis, own, whole)] == [1, 0, None]
    assert alarms.of(0) == (own, whole)
    assert alarms.of(1) == (of_axis, whole)
    assert alarms.has("program", channel=0)
    assert not alarms.has("program", channel=1)
    assert alarms.has("following_error", "Z")
    assert not alarms.has("following_error", "X")
    assert (alarms.owner("Z"), alarms.owner("W")) == (1, None)
    alarms.reset(channel=0)
    assert alarms.active == (of_axis, whole)
    alone = AlarmList(Store(), Clock(0.001))
    assert alone.put("program", detail="a", channel=3).channel is None
    assert alone.has("program")


def test_an_error_of_a_program_has_a_row_of_its_own_where_the_table_has_one() -> None:
    rows = {
        **ALARMS,
        "program unknown_word": AlarmRow(7, AlarmKind.PROGRAM, "{detail}"),
        "program soft_limit_high": AlarmRow(8, AlarmKind.TRAVEL, "axis {axis} goes too high"),
    }
    alarms = AlarmList(Store(), Clock(0.001), rows)
    assert alarms.of_program(ProgramError("a", code="unknown_word")) == ("program unknown_word", None)
    assert alarms.of_program(ProgramError("a", code="other")) == ("program", None)
    assert alarms.of_program(ProgramError("a")) == ("program", None)
    for upper, expected in ((True, ("program soft_limit_high", "X")), (False, ("program", None))):
        error = ProgramError("a", code="travel")
        error.limit = ("X", upper, False)
        assert alarms.of_program(error) == expected
        error.limit = ("X", upper, True)  # the axis was moved up to it, as by hand
        assert alarms.of_program(error) == (f"soft_limit_{'high' if upper else 'low'}", "X")


def test_histories_keep_the_last_hundred() -> None:
    store, clock = Store(), Clock(0.001, datetime(2026, 2, 3, 4, 5, 6))
    alarms, messages = AlarmList(store, clock), OperatorMessages(store, clock)
    for number in range(101):
        alarms.put("program", detail=f"error {number}")
        alarms.reset()
        messages.show(number, f"message {number}")
    assert [each.text for each in alarms.history()][::99] == ["error 1", "error 100"]
    assert messages.history()[::99] == (
        (1, "message 1", "2026-02-03T04:05:06"), (100, "message 100", "2026-02-03T04:05:06"),
    )  # fmt: skip
    assert messages.show(0, "x" * 255).number == 0  # as long as one may be
    _refused(Refusal.DATA, lambda: messages.show(0, "x" * 256), "message 0 cannot be shown")
    assert messages.shown[-1].text == "x" * 255


# --- timers and parts


def test_timers_are_saved_when_so_much_time_has_passed(tmp_path: Path) -> None:
    for each, (cycles, kept) in enumerate(((59_999, 0.0), (60_000, 60.0))):
        store, clock = Store(tmp_path / f"{each}"), Clock(0.001)
        timers = Timers(store, clock)
        clock.tick(cycles)
        timers.count(cycles, cut_s=1.5)
        assert timers.tools == ()  # nothing is in the spindle
        store.close()
        assert Timers(Store(tmp_path / f"{each}"), Clock(0.001)).seconds(Timer.POWER_ON) == kept


def test_a_timer_that_is_set_counts_on_from_there() -> None:
    clock = Clock(0.001)
    timers = Timers(Store(), clock)
    clock.tick(500)
    timers.count(500, operating=True, cut_s=0.25, tool=2)
    timers.set_seconds(Timer.OPERATING, 0.0)
    timers.set_tool_seconds(1, 0.0)
    saved = timers.snapshot()
    clock.tick(250)
    timers.count(250, operating=True, cut_s=0.375, tool=2)
    assert timers.seconds(Timer.OPERATING) == pytest.approx(0.25)
    assert timers.seconds(Timer.POWER_ON) == pytest.approx(0.75)
    assert (timers.tools, timers.tool_seconds(2), timers.tool_seconds(9)) == ((1, 2), 0.375, 0.0)
    timers.restore(saved)
    assert timers.tool_seconds(2) == 0.25
    assert timers.seconds(Timer.CUTTING) == 0.25
    _refused(Refusal.DATA, lambda: timers.set_tool_seconds(1, -0.001), "a timer cannot show")
    assert timers.tool_seconds(1) == 0.0


def test_parts_stay_at_the_largest_number() -> None:
    counter, most = PartCounter(Store()), 999_999_999
    counter.set(made=most, required=most, total=most - 1)
    assert Parts(most, most, most - 1).reached
    counter.count()
    assert counter.parts == Parts(most, most, most)
    for name in ("made", "required", "total"):
        _refused(Refusal.DATA, lambda name=name: counter.set(**{name: most + 1}), "is not a number of parts")
        _refused(Refusal.DATA, lambda name=name: counter.set(**{name: -1}), "is not a number of parts")
    counter.set(made=2, required=3, total=0)
    before = counter.parts
    assert not before.reached
    counter.count()
    assert counter.parts == Parts(3, 3, 1)
    counter.restore(before)
    assert counter.parts == Parts(2, 3, 0)


# --- tables


def test_tools_at_the_ends_of_their_ranges() -> None:
    tools = ToolTable(Store(), CONFIG)
    most = 99_999_999
    assert tools.set(1, radius_mm=0, tip=0) == Tool()
    assert tools.set(most, tip=9, description="end", x_mm=-3) == Tool(tip=9, description="end", x_mm=-3.0)
    assert isinstance(tools[most].x_mm, float)
    assert (list(tools), len(tools), tools.revision) == ([1, most], 2, 2)
    for number in (0, most + 1):
        _refused(Refusal.DATA, lambda number=number: tools.set(number, tip=1), "is not a tool number")
    _refused(Refusal.DATA, lambda: tools.set(1, tip=-1), "is no place")
    _refused(Refusal.DATA, lambda: tools.set(1, tip=True), "cannot be True")
    assert tools.set(1, wear_radius_mm=-0.5).wear_radius_mm == -0.5  # a worn tool is smaller
    _refused(Refusal.NOT_FOUND, lambda: tools.remove(2), "there is no tool 2")


def test_offsets_of_axes_that_a_machine_no_longer_has_are_left_out() -> None:
    store = Store()
    offsets = OffsetTable(store, CONFIG)
    offsets.set("G54", {"X": 2.5})
    offsets.set("G54", {"X": 0.25, "B": -7.0}, add=True)
    offsets.set("ABCDEFGH.ABCDEFG1", {"Y": 1.0})
    assert dict(offsets["G54"]) == {"X": 2.75, "B": -7.0}
    for name in ("ABCDEFGHI", "G54.", "G54.P3.P4", "5", ""):
        _refused(Refusal.DATA, lambda name=name: offsets.set(name, {"X": 1.0}), "cannot name a work offset")
    _refused(Refusal.DATA, lambda: offsets.set("G54", {"X": float("nan")}), "G54 X cannot be nan")
    _refused(Refusal.DATA, lambda: offsets.set("G54", {"W": 1.0}), "there is no axis 'W'")
    assert (offsets.revision, len(offsets), list(offsets)) == (3, 2, ["ABCDEFGH.ABCDEFG1", "G54"])
    without = MachineConfig.model_validate(
        {"name": "m", "axis": ({"name": "X", "vmax_mm_s": 100, "amax_mm_s2": 1000},)}
    )
    assert dict(OffsetTable(store, without)["G54"]) == {"X": 2.75}


# --- PLC and spindle


def test_an_answer_in_the_last_moment_is_in_time() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TimesConfig(auxiliary_s=0.25), {(Function.M, 5): Answer(2.001)}, limit_s=2.0)
    in_time = plc.strobe(Function.B, 4, default_s=2.0)
    late = plc.strobe(Function.M, 5)
    assert [each.timed_out for each in plc.pending] == [False, True]
    clock.tick(2000)
    assert plc.finished(in_time)
    assert not plc.finished(late)
    assert [str(each) for each in plc.take_failed()] == ["M5"]
    own = plc.strobe(Function.B, 4)
    assert plc.pending[0].due_cycle == 2250  # as long as a function of the machine file takes
    assert own == late + 1


def test_functions_are_answered_by_hand_one_by_one() -> None:
    clock = Clock(0.001)
    plc = PlcModel(clock, TimesConfig(), limit_s=1.0)
    plc.script(Function.M, None, Answer(None))
    plc.script(Function.M, 9, Answer(0.5))
    first, second, third = (plc.strobe(Function.M, number) for number in (7, 8, 9))
    clock.tick(10)
    plc.answer()  # the oldest
    assert plc.finished(first)
    plc.answer(second, alarm="no oil")
    assert not plc.finished(second)
    assert plc.due_cycle() == 500
    saved = plc.snapshot()
    plc.cancel([second])
    assert plc.take_failed() == ()
    assert [each.serial for each in plc.pending] == [third]
    plc.cancel([third])
    assert plc.pending == ()
    plc.restore(saved)
    (failed,) = plc.take_failed()
    assert (failed.alarm, failed.timed_out, failed.due_cycle) == ("no oil", False, 10)
    assert plc.strobe(Function.M, 0) == 4
    _refused(
        Refusal.DATA, lambda: plc.script(Function.M, None, Answer(-1.0)), "M cannot be answered after -1.0 s"
    )
    _refused(Refusal.DATA, lambda: plc.script(Function.M, -1, Answer()), "M-1 is not an auxiliary function")
    assert functions_of("M6 T12 S1000.5 X3 B0") == [("M", 6), ("T", 12), ("S", 1000), ("B", 0)]


def test_a_spindle_orients_in_its_direction_of_turn() -> None:
    clock = Clock(0.001)
    config = MachineConfig.model_validate(
        {
            "name": "m", "axis": ({"name": "X", "vmax_mm_s": 100, "amax_mm_s2": 1000},),
            "spindle": {
                "max_rpm": 8000, "acceleration_rpm_s": 6000.0, "orientation_rpm": 60.0, "orientation_deg": 90.0,
            },
        }
    )  # fmt: skip
    spindle = Spindle(clock, config)
    spindle.orient()
    assert spindle.is_orienting
    # From rest clockwise at 360 deg/s after 10 ms: a ramp of 1.8 degree at both ends, 86.4 degree between.
    assert spindle.reached_cycle() == 10 + 240 + 10
    clock.tick(130)
    assert spindle.state().angle_deg == pytest.approx(45.0)
    assert spindle.state().actual_rpm == pytest.approx(60.0)
    clock.tick(130)
    state = spindle.state()
    assert (state.angle_deg, state.oriented, state.direction) == (90.0, True, 0)
    spindle.turn(rpm=0.0)  # an S word lets it stand there
    assert spindle.state().oriented
    spindle.turn(direction=-1)
    assert not spindle.snapshot().orienting
    for override in (0.0, 2.0):
        spindle.set_override(override)
        assert spindle.state().override == override
    for override in (-0.01, float("nan")):
        _refused(Refusal.DATA, lambda override=override: spindle.set_override(override), "out of range")
    spindle.turn(rpm=5000.0, direction=-1)
    assert spindle.state().commanded_rpm == -8000.0
    spindle.stop()
    assert (spindle.state().direction, spindle.state().programmed_rpm) == (0, 5000.0)


# --- programs


@pytest.mark.parametrize(
    ("content", "comment"),
    [
        (b"%\n\nO5 ( FLANGE )\n", "FLANGE"),
        (b"%\n\n\n(too late)\n", ""),
        (b"O5\n(second line)\n", ""),
        (b" \n%\n(a)(b)\n", "a"),
        (b"(open\n", ""),
        (b"(\xff)\n", "\ufffd"),
        (b"", ""),
    ],
)
def test_the_comment_of_a_program_is_in_its_first_line(content: bytes, comment: str) -> None:
    assert first_comment(content) == comment


def test_names_and_room_at_their_ends() -> None:
    memory = ProgramMemory(Store(), Clock(0.001))
    assert (memory.free_bytes, len(memory), memory.used_bytes) == (None, 0, 0)
    entry = memory.create("n" * 64, "(\u00e4)\n")
    assert (entry.size_bytes, entry.protected) == (5, False)
    _refused(Refusal.DATA, lambda: memory.create("n" * 65), "cannot name a program")
    assert memory.entry("n" * 64) == entry
    assert len(memory) == 1
    assert 5 not in memory
    assert memory.search("(") == (Found("n" * 64, 1, "(\u00e4)"),)
    memory.protect("n" * 64)
    _refused(Refusal.PROTECTED, lambda: memory.write("n" * 64, ""), "is protected")
    memory.protect("n" * 64, on=False)
    assert memory.write("n" * 64, "M30\nM30\n").size_bytes == 8
    memory.data = MemoryData(capacity_bytes=6)
    assert memory.free_bytes == 0
    assert memory.write("n" * 64, "M30\nM3\n").size_bytes == 7  # too large still, and smaller
    _refused(Refusal.FULL, lambda: memory.write("n" * 64, "M30\nM30\n"), "0 bytes are free, 1 are needed")


def test_one_edit_in_the_foreground_and_one_in_the_background() -> None:
    memory = ProgramMemory(Store(), Clock(0.001, datetime(2026, 3, 4)))
    for name in "ABC":
        memory.create(name, f"({name})\nG0 X1\n")
    edits = ProgramEdits(memory)
    assert not edits.any_open
    front, back = edits.open("A", background=False), edits.open("B", background=True)
    _refused(Refusal.IN_USE, lambda: edits.open("C", background=False), "in the foreground")
    _refused(Refusal.IN_USE, lambda: edits.open("C", background=True), "in the background")
    edits.close_foreground()
    assert (front.is_open, back.is_open, edits.any_open) == (False, True, True)
    with edits.open("A", background=False):
        assert memory.edited == {"A", "B"}
    edits.close_all()
    assert (edits.any_open, memory.edited) == (False, frozenset())


def test_lines_of_an_edit() -> None:
    clock = Clock(0.001, datetime(2026, 3, 4))
    memory = ProgramMemory(Store(), clock)
    memory.create("EMPTY", b"")
    with ProgramEdit(memory, "EMPTY") as edit:
        _refused(Refusal.NOT_FOUND, lambda: edit.line(1), "has no line 1")
        edit.insert(1, "G0 X1")
        edit.insert(2, "M30")
        assert memory.read("EMPTY") == b"G0 X1\nM30\n"
        clock.tick(5000)
        assert edit.substitute("Q", "R") == 0
        assert memory.entry("EMPTY").changed == datetime(2026, 3, 4)  # nothing was written
        assert edit.find("0", after=-3) == 1
        assert edit.find("0", after=1) == 2
        assert edit.find("0", after=2) is None
        _refused(Refusal.DATA, lambda: edit.find(""), "nothing to search for")
        _refused(Refusal.DATA, lambda: edit.replace(1, "\udc80"), "is not one line of text")
        edit.delete(1, 1)
        assert (len(edit), edit.line(1)) == (1, "M30")
        assert memory.entry("EMPTY").changed == datetime(2026, 3, 4, 0, 0, 5)


@pytest.mark.parametrize(
    ("sequence", "line"), [(10, 2), (20, 3), (30, 4), (40, 5), (5, None), (12, None), (-1, None), (70, 7)]
)
def test_blocks_are_found_by_their_numbers(sequence: int, line: int | None) -> None:
    text = "X1 N12\nN0010 G0\n n20\r/N30\n/2 N 40\nN5.5 N1\nN70"
    program = ProgramText.from_text(text, "P")
    if line is None:
        with pytest.raises(UsageError, match=f"P has no block N{sequence}"):
            block_line(program, 1, sequence)
    else:
        assert block_line(program, 1, sequence) == line


def test_blocks_are_found_by_their_lines() -> None:
    program = ProgramText.from_text("G0 X1\nM30\n", "P")
    assert [block_line(program, line, None) for line in (1, 2)] == [1, 2]
    for line in (0, 3):
        with pytest.raises(UsageError, match=f"P has no line {line}"):
            block_line(program, line, None)


# --- data of a control


def test_overrides_at_the_ends_of_their_ranges() -> None:
    data = ControlData(most_feed_override=1.5, spindle_overrides=(0.5, 1.2))
    for good in (Overrides(0.0, 0.0, 0.5), Overrides(0.001, 0.25, 1.2), Overrides(1.5, 1.0, 1.0)):
        assert good.checked(data) == good
    for bad, match in (
        (Overrides(feed=0.0009), "a feed override of 0.0009"),
        (Overrides(feed=1.51), "a feed override"),
        (Overrides(feed=float("nan")), "a feed override"),
        (Overrides(rapid=0.75), "a rapid override"),
        (Overrides(spindle=0.49), "a spindle override"),
        (Overrides(spindle=1.21), "a spindle override"),
    ):
        _refused(Refusal.DATA, lambda bad=bad: bad.checked(data), match)


@pytest.mark.parametrize(
    ("shares", "match"),
    [
        (("XY", "Z"), "axis B belongs to no channel"),
        (("XYZ", "ZB"), "axis Z belongs to 2 channels"),
        (("XYZB", "W"), "there is no axis 'W'"),
        (("XYZB", ""), "a channel has no axes"),
    ],
)
def test_channels_that_share_out_wrongly(shares: tuple[str, ...], match: str) -> None:
    with pytest.raises(UsageError, match=match):
        Control(cnc_machine(), channels=tuple(ChannelData(tuple(each)) for each in shares))


@pytest.mark.parametrize("name", ["jog_share", "reference_share", "creep_share"])
def test_a_manual_speed_of_nothing_is_refused(name: str) -> None:
    for value in (0.0, -0.1, float("inf")):
        with pytest.raises(UsageError, match="moves nothing"):
            replace(ManualData(), **{name: value})  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="moves nothing"):
        ManualData(jog_speeds={"X": 0.0})


def test_times_of_tools_as_they_come_and_go() -> None:
    times = ToolTimes()
    times.change(0, ToolTime(1.0, 2.0))
    assert times == ToolTimes()
    for tool, now in ((7, ToolTime(0.0, 1.5)), (4, ToolTime(6.0, 2.0)), (7, ToolTime(6.0, 2.0))):
        times.change(tool, now)
    assert times.until(ToolTime(9.0, 2.25)) == {0: ToolTime(0.0, 1.5), 7: ToolTime(9.0, 0.75)}
    times.change(3, ToolTime(9.0, 2.25))
    assert list(times.until(ToolTime(9.0, 5.25))) == [0, 3, 7]


def test_how_an_axis_searches_its_reference_point() -> None:
    x, y, z, _ = CONFIG.axes
    index_only = x.model_copy(update={"reference_switch_mm": None})
    switch_only = x.model_copy(update={"index_pulse_mm": None})

    def ways(axis: Any, position: float, on: bool = False) -> list[tuple[int, bool, str]]:
        found = reference_steps(axis, position, on)
        return [(step.direction, step.fast, step.until.name) for step in found]

    find, leave = (-1, True, "ON"), (1, False, "OFF")
    assert ways(x, 0.0) == [find, leave, (1, False, "INDEX")]
    assert ways(y, 0.0) == [find, leave, (-1, False, "ON"), (-1, False, "INDEX")]
    assert ways(x, -45.0, on=True) == [(1, True, "OFF"), find, leave, (1, False, "INDEX")]
    assert ways(switch_only, 0.0) == [find, leave]
    assert ways(index_only, -37.6) == [(1, False, "INDEX")]
    assert ways(index_only, -37.4) == ways(index_only, -37.5) == [(-1, False, "INDEX")]
    assert ways(z, 0.0) == []


# --- what the status says


def test_the_status_tells_rapids_cuts_and_dwells() -> None:
    made = control()
    made.programs.create("P", "G0 X72.5\nG4 F0.5\nG1 Y20 F1200\nM30\n")
    made.select_program("P")
    made.cycle_start()
    made.advance(300)
    status = made.status()
    feed = status.channel.feed
    assert (feed.rapid, feed.programmed) == (True, 0.0)
    assert feed.actual == pytest.approx(120.0 * 60.0)
    assert status.axes["X"].velocity == pytest.approx(120.0)
    assert (status.axes["X"].moving, status.axes["Y"].moving) == (True, False)
    assert status.axes["X"].unit == "mm"
    made.advance(600)
    status = made.status()
    assert status.channel.motion is Motion.DWELL
    assert (status.channel.feed.actual, status.channel.feed.rapid) == (0.0, False)
    assert not status.axes["X"].moving
    made.advance(600)
    status = made.status()
    assert status.channel.motion is Motion.MOVING
    assert (status.channel.feed.rapid, status.channel.feed.programmed) == (False, 1200.0)
    assert status.channel.feed.commanded == pytest.approx(1200.0)
    assert status.axes["Y"].to_go == pytest.approx(20.0 - status.axes["Y"].machine)
    made.advance(5000)
    assert made.status().channel.motion is Motion.NONE
    made.select_mode(Mode.JOG)
    made.jog("X", -1)
    made.advance(300)
    status = made.status()
    assert (status.channel.motion, status.axes["X"].manual) == (Motion.MOVING, "jog")
    assert status.axes["X"].to_go == 0.0  # it has no end but its software limit
    assert status.axes["X"].velocity == pytest.approx(-24.0)
    made.jog("B", 1)
    made.advance(300)
    assert made.status().axes["B"].to_go == 0.0  # there is no end to it


def test_time_passes_no_further_than_it_was_asked_to() -> None:
    made = started()
    assert made.advance(0) == 0
    assert made.advance(7) == 7
    assert made.status().cycle == 7
    asked: list[int] = []

    def until() -> bool:
        asked.append(made.status().cycle)
        return len(asked) == 3

    assert made.advance(50, until=until) == 3
    assert asked == [8, 9, 10]


_ODD = (1e308, 1e-308, math.inf, -math.inf, math.nan, 0, -1, 10**400, -(10**400), 10**5000, -(10**5000))
_NUMBERS = [
    (name, each.name)
    for name, command in vars(Control).items()
    if inspect.isfunction(command) and name[0] != "_"
    for each in inspect.signature(command).parameters.values()
    if re.search(r"\b(int|float)\b", str(each.annotation))
]


@pytest.mark.parametrize(("command", "argument"), [each for each in _NUMBERS if each[0] != "advance"])
def test_no_number_of_a_command_is_more_than_refused(command: str, argument: str) -> None:
    """Python writes no whole number of over 4,300 digits, and makes no float of one beyond 1.8e308."""
    parameters = inspect.signature(getattr(Control, command)).parameters
    whole = "float" not in str(parameters[argument].annotation)
    for odd in (each for each in _ODD if isinstance(each, int) or not whole):
        made = Control(CONFIG, data=ControlData(reference_required=False))
        others = {
            each.name: "X" if "str" in str(each.annotation) else 1
            for each in parameters.values()
            if each.default is inspect.Parameter.empty and each.name not in ("self", argument)
        }
        value = frozenset({odd}) if "frozenset" in str(parameters[argument].annotation) else odd
        with suppress(PolycncError):
            getattr(made, command)(**others, **{argument: value})
        assert not {math.inf, -math.inf} & {axis.relative for axis in made.status().axes.values()}


def test_no_number_of_a_table_is_more_than_refused() -> None:
    made = Control(CONFIG)
    for odd in (math.inf, -math.inf, math.nan, 10**400, -(10**400), 10**5000):
        _refused(Refusal.DATA, lambda odd=odd: made.offsets.set("G54", {"X": odd}), "G54 X cannot be")
        _refused(Refusal.DATA, lambda odd=odd: made.tools.set(7, length_mm=odd), "length_mm cannot be")
    with pytest.raises(UsageError, match="a manual speed of a number without end"):
        ManualData(jog_share=-(10**5000))
