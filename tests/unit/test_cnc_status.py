"""One status a cycle: the same object until something changes, never an old one, and whole in JSON."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from datetime import datetime
from functools import partial
from pathlib import Path

import pytest
from pydantic import TypeAdapter

from polycnc.cnc import (
    Answer,
    ChannelData,
    Control,
    ControlError,
    ControlEvent,
    ControlSnapshot,
    Function,
    Mode,
    RunState,
    Status,
    Step,
    Timer,
    ToolInUse,
    WorkOffset,
)
from polycnc.machine import SnapshotError
from polycnc.nc import ProgramText, load_dialect
from support.cnc_control import PART, SLOT, control, fresh
from support.cnc_machine import cnc_machine

STATUS = TypeAdapter(Status)
TOOLS = """N10 T3 M6
N20 G54 G1 X31.5 F740
N30 G43 H3 Z-30.25
N40 M98 P12
N50 M30
"""
SUB = "G1 X7.25\nM99\n"


# ---------------------------------------------------------------------- states to start from


def _ready(made: Control) -> None:
    made.select_program("PART")


def _running(made: Control) -> None:
    made.select_program("PART")
    made.cycle_start()
    made.advance(137)


def _held(made: Control) -> None:
    _running(made)
    made.feed_hold()
    made.advance(900)


def _braking(made: Control) -> None:
    _running(made)
    made.feed_hold()
    made.advance(3)


def _waiting(made: Control) -> None:
    made.plc.script(Function.M, 8, Answer(None))
    made.select_program("SLOT")
    made.cycle_start()
    made.advance(60_000, until=lambda: bool(made.plc.pending))


def _alarmed(made: Control) -> None:
    _running(made)
    made.put_alarm("function_failed", detail="coolant")
    made.advance(11)


def _stopped(made: Control) -> None:
    _running(made)
    made.emergency_stop()
    made.advance(700)


def _jogging(made: Control) -> None:
    made.select_mode(Mode.JOG)
    made.jog("X", 1)
    made.advance(83)


def _mdi(made: Control) -> None:
    made.select_mode(Mode.MDI)
    made.set_mdi("G1 X4.5 F333\n")
    made.cycle_start()
    made.advance(29)


def _at_reference(made: Control) -> None:
    made.select_mode(Mode.REF)


def _by_wheel(made: Control) -> None:
    made.select_mode(Mode.HANDLE)


def _by_steps(made: Control) -> None:
    made.select_mode(Mode.INC)


STATES: dict[str, Callable[[Control], None]] = {
    each.__name__.removeprefix("_"): each
    for each in (
        _ready, _running, _held, _braking, _waiting, _alarmed, _stopped, _jogging, _mdi, _at_reference, _by_wheel,
        _by_steps,
    )
}  # fmt: skip


def _select(mode: Mode, made: Control) -> None:
    made.select_mode(mode)


COMMANDS: dict[str, Callable[[Control], object]] = {
    **{f"mode {mode}": partial(_select, mode) for mode in Mode},
    "overrides": lambda c: c.set_overrides(feed=0.35, rapid=0.25, spindle=0.7),
    "override of a channel": lambda c: c.set_overrides(feed=1.3, channel=0),
    "single block": lambda c: c.set_switches(single_block=True),
    "all switches": lambda c: c.set_switches(
        optional_stop=True, dry_run=True, machine_lock=True, block_delete=frozenset({2, 7})
    ),
    "select": lambda c: c.select_program("SLOT"),
    "select a text": lambda c: c.select_program(ProgramText.from_text("G1 X2.5 F90\n", "outside")),
    "mdi": lambda c: c.set_mdi("G1 Y3.5 F170\n"),
    "open": lambda c: c.open_program(),
    "search": lambda c: c.search(line=2),
    "calculated search": lambda c: c.search(sequence=30, calculate=True),
    "start": lambda c: c.cycle_start(),
    "start at a line": lambda c: c.cycle_start(line=2),
    "step": lambda c: c.cycle_start(step=Step.INTO),
    "hold": lambda c: c.feed_hold(),
    "hold a channel": lambda c: c.feed_hold(channel=0),
    "reset": lambda c: c.reset(),
    "reset a channel": lambda c: c.reset(channel=0),
    "emergency stop": lambda c: c.emergency_stop(),
    "emergency stop off": lambda c: c.emergency_stop(False),
    "alarm": lambda c: c.put_alarm("following_error", axis="Y"),
    "jog": lambda c: c.jog("Y", -1, rapid=True),
    "jog the other way": lambda c: c.jog("X", -1),
    "let go": lambda c: c.jog("X", None),
    "increment": lambda c: c.increment("Y", 1, 0.25),
    "handwheel": lambda c: c.handwheel("Z", 7, 0.03),
    "reference": lambda c: c.reference("Y"),
    "relative": lambda c: c.set_relative("X", 6.5),
    "edit": lambda c: c.edit("SLOT", background=True).close(),
    "dialect": lambda c: c.change_dialect(load_dialect("din")),
    "axes": lambda c: c.change_axes(
        tuple(axis.model_copy(update={"vmax_mm_s": 0.5 * axis.vmax}) if axis.kind == "linear" else axis
              for axis in c.machine.config.axes)
    ),
    "share": lambda c: c.share_axes([c.machine.config.axis_names]),
    "back": lambda c: c.restore(c.snapshot()),
    "clock": lambda c: c.clock.set_now(datetime(2031, 5, 17, 13, 45)),
    "tool": lambda c: c.tools.set(3, length_mm=17.25, radius_mm=2.5),
    "tool gone": lambda c: c.tools.remove(3),
    "offset": lambda c: c.offsets.set("G54", {"X": 3.25}, add=True),
    "parts": lambda c: c.parts.set(made=7, required=30),
    "part": lambda c: c.parts.count(),
    "timer": lambda c: c.timers.set_seconds(Timer.CUTTING, 43.5),
    "cycle timer": lambda c: c.timers.start_cycle(),
    "message": lambda c: c.messages.show(2041, "CHECK COOLANT"),
    "messages gone": lambda c: c.messages.withdraw(),
    "answer": lambda c: c.plc.answer(),
    "bad answer": lambda c: c.plc.answer(alarm="no pressure"),
    "cancel": lambda c: c.plc.cancel(),
    "spindle": lambda c: c.spindle.turn(rpm=850.0, direction=-1),
    "spindle stop": lambda c: c.spindle.stop(),
    "orient": lambda c: c.spindle.orient(135.0),
    "go to": lambda c: c.manual.go_to("Y", 4.75),
    "stop by hand": lambda c: c.manual.stop_all(),
    "history gone": lambda c: c.alarms.clear_history(),
    "alarms reset": lambda c: c.alarms.reset(),
    "program": lambda c: c.programs.create("NEW", "G1 X1.5 F40\n"),
}  # fmt: skip


def _made() -> Control:
    made = control()
    made.tools.set(3, length_mm=11.5, radius_mm=1.75)
    return made


def _restored(made: Control, kept: ControlSnapshot) -> bool:
    """Go back, unless a command has changed what the control is made of."""
    try:
        made.restore(kept)
    except SnapshotError:
        return False
    return True


THIRD = 3
"""Each state tries a third of the commands, the next state the next third."""
SHARES = [(state, (k + more) % THIRD) for more in range(THIRD) for k, state in enumerate(STATES)]


@pytest.mark.parametrize(
    ("state", "part"),
    [
        each if k < len(STATES) else pytest.param(*each, marks=pytest.mark.long)
        for k, each in enumerate(SHARES)
    ],
)
def test_no_command_leaves_an_old_status(state: str, part: int) -> None:
    made = kept_state = None
    for name, command in list(COMMANDS.items())[part::THIRD]:
        if made is None or kept_state is None or not _restored(made, kept_state):
            made = _made()
            STATES[state](made)
            kept_state = made.snapshot()
        before = made.status()
        try:
            command(made)
        except ControlError:
            assert fresh(made) == before, f"{name} is refused and changes something"
            continue
        kept = made.status()
        assert kept == fresh(made), f"{name} leaves an old status"
        made.advance(1)
        kept = made.status()
        assert kept == fresh(made), f"the cycle after {name} leaves an old status"


def test_the_public_commands_are_all_tried() -> None:
    text = Path(__file__).read_text()
    others = {
        "status",
        "axes",
        "channel_status",
        "inventory",
        "snapshot",
        "advance",
        "set_observer",
        "be_shared",
        "waiting_functions",
        "tool_in_use",
    }
    names = {
        name
        for name, value in vars(Control).items()
        if callable(value) and not name.startswith("_") and name not in others
    }
    assert {name for name in names if f"c.{name}(" not in text} == {"select_mode"}  # by `_select`


@pytest.mark.parametrize("state", STATES)
def test_a_status_is_one_object_until_time_passes(state: str) -> None:
    made = _made()
    STATES[state](made)
    first = made.status()
    assert made.status() is first
    assert made.axes() is first.axes
    assert made.channel_status() is first.channel
    if first.channel.block is None:
        assert made.tool_in_use() is None
    else:
        assert made.tool_in_use() is first.channel.tool
    made.advance(1)
    assert made.status() is not first
    assert made.status().cycle == first.cycle + 1


def test_parts_that_are_read_first_are_those_of_the_status() -> None:
    made = _made()
    _running(made)
    axes, channel = made.axes(), made.channel_status()
    assert made.status().axes is axes
    assert made.status().channels[0] is channel
    with pytest.raises(ControlError):
        made.channel_status(1)


def test_a_condition_sees_the_status_of_its_own_cycle() -> None:
    made = _made()
    made.select_program("PART")
    made.cycle_start()
    seen: list[int] = []
    made.advance(40, until=lambda: bool(seen.append(made.status().cycle)))  # type: ignore[func-returns-value]
    assert seen == list(range(1, 41))


def test_what_happens_without_a_cycle_is_seen() -> None:
    made = _made()
    made.programs.create("BAD", "G1 X2.5 F90 Q\n")
    made.select_program("BAD")
    before = made.status()
    made.cycle_start()
    made.advance(5, until=ControlEvent.ALARM)
    assert made.status() == fresh(made) != before
    assert made.status().channel.run_state is RunState.ALARM


@pytest.mark.parametrize("state", STATES)
def test_a_status_goes_to_json_and_back(state: str) -> None:
    made = _made()
    STATES[state](made)
    status = made.status()
    assert STATUS.validate_json(STATUS.dump_json(status)) == status
    assert pickle.loads(pickle.dumps(status)) == status


def test_the_schema_of_a_status_holds_what_is_written() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    schema = STATUS.json_schema(mode="serialization")
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for state in STATES.values():
        made = _made()
        state(made)
        written = json.loads(STATUS.dump_json(made.status()))
        validator.validate(written)
        assert written["axes"]["X"]["machine"] == made.axes()["X"].machine
        assert written["channels"][0]["run_state"] == made.channel_status().run_state
    written["cycle"] = "many"
    with pytest.raises(jsonschema.ValidationError):
        validator.validate(written)


def test_nobody_changes_a_status() -> None:
    status = _made().status()
    with pytest.raises(AttributeError):
        status.cycle = 7  # type: ignore[misc]
    for held, key in ((status.axes, "X"), (status.timers_s, Timer.CYCLE)):
        assert isinstance(held, dict)
        for change in (
            partial(held.__setitem__, key, 1.5),
            partial(held.__delitem__, key),
            partial(held.update, {key: 1.5}),
            partial(held.pop, key),
            held.clear,
        ):
            with pytest.raises(TypeError):
                change()
        assert key in held


# ---------------------------------------------------------------------- what it holds


def _with_tools() -> Control:
    made = control()
    made.tools.set(3, length_mm=11.5, wear_length_mm=0.25, radius_mm=1.75, wear_radius_mm=-0.5)
    made.offsets.set("G54", {"X": 2.5, "Z": -1.25})
    made.programs.create("MAIN", TOOLS)
    made.programs.create("O0012", SUB)
    made.select_program("MAIN")
    made.cycle_start()
    return made


def _at(made: Control, line: int, program: str = "MAIN") -> Status:
    def there() -> bool:
        block = made.status().channel.block
        return block is not None and (block.program, block.line) == (program, line)

    made.advance(60_000, until=there)
    assert there()
    return made.status()


def test_tool_and_work_offset_of_the_block() -> None:
    made = _with_tools()
    channel = _at(made, 2).channel
    assert channel.tool == ToolInUse(3, 11.75, 1.25, 0.0)
    assert channel.offsets == (WorkOffset("G54", {"X": 2.5, "Z": -1.25}),)
    assert channel.feed.programmed == 740.0
    channel = _at(made, 3).channel
    assert channel.tool.compensation_mm == 11.75
    made.tools.set(3, length_mm=20.5)
    made.offsets.set("G54", {"X": 0.75}, add=True)
    channel = made.status().channel
    assert channel.tool == ToolInUse(3, 20.75, 1.25, 20.75)
    assert channel.offsets[0].values["X"] == 3.25


def test_programs_on_the_way_to_the_block_and_its_place() -> None:
    made = _with_tools()
    channel = _at(made, 1, "O0012").channel
    assert channel.stack == ("MAIN", "O0012")
    assert channel.block is not None
    assert (channel.block.line, channel.block.lines) == (1, 2)
    channel = _at(made, 5).channel
    assert channel.stack == ("MAIN",)
    assert channel.block is not None
    assert (channel.block.line, channel.block.lines) == (5, 5)


def test_what_an_axis_carries_and_how_fast_a_key_moves_it() -> None:
    made = control()
    before = made.axes()["X"].jog_speed
    made.set_overrides(feed=0.5)
    assert made.axes()["X"].jog_speed == pytest.approx(0.5 * before)
    made.select_mode(Mode.JOG)
    made.jog("X", -1)
    made.advance(400)
    axis = made.axes()["X"]
    most = made.machine.config.axes[0].vmax
    assert axis.velocity == pytest.approx(-axis.jog_speed)
    assert made.channel_status().feed.actual == pytest.approx(60.0 * axis.jog_speed)
    assert axis.load_percent == pytest.approx(100.0 * axis.jog_speed / most)
    assert made.axes()["Y"].load_percent == 0.0


def test_the_handwheel_as_it_was_turned_last() -> None:
    made = control()
    assert made.status().wheel.axis == ""
    made.select_mode(Mode.HANDLE)
    made.handwheel("Y", -3, 0.125)
    assert (made.status().wheel.axis, made.status().wheel.size) == ("Y", 0.125)
    kept = made.snapshot()
    made.advance(300)
    made.handwheel("X", 2, 0.5)
    made.restore(kept)
    assert made.status().wheel.axis == "Y"


def test_when_the_last_alarm_came() -> None:
    made = control()
    assert made.status().last_alarm is None
    made.advance(1370)
    made.put_alarm("function_failed", detail="coolant")
    came = made.status().last_alarm
    assert came == made.clock.now.isoformat()
    made.reset()
    made.advance(211)
    assert made.status().alarms == ()
    assert made.status().last_alarm == came == made.alarms.history()[-1].time
    made.alarms.clear_history()
    assert made.status().last_alarm is None


def test_axes_of_two_channels() -> None:
    made = Control(cnc_machine(), channels=(ChannelData(("X", "Y"), spindle=True), ChannelData(("Z", "B"))))
    made.programs.create("PART", PART)
    made.programs.create("SLOT", SLOT.replace("X", "Z-"))
    made.select_program("PART")
    made.select_program("SLOT", channel=1)
    made.cycle_start()
    made.cycle_start(channel=1)
    made.advance(90)
    assert made.status() == fresh(made)
    assert made.channel_status(1).stack == ("SLOT",)
    assert made.axes()["Z"].to_go < 0.0 < made.axes()["X"].to_go
    made.feed_hold(channel=1)
    assert made.status().channels[1].run_state is RunState.HOLD
    assert made.status().channel.run_state is RunState.ACTIVE


LEFT = """G1 X31.5 F900
Y7.25 F1400
X-12.5 Y-3.75
G4 P1.35
G0 X2.5 Y1.25
M2
"""


@pytest.mark.parametrize("jerk_mm_s3", [0.0, 9000.0])
@pytest.mark.parametrize("feed", [0.65, 1.0, 1.4])
def test_the_time_that_is_left_runs_down_to_the_end(feed: float, jerk_mm_s3: float) -> None:
    made = Control(cnc_machine(path={"jerk_mm_s3": jerk_mm_s3} if jerk_mm_s3 else {}))
    made.programs.create("LEFT", LEFT)
    made.select_program("LEFT")
    made.set_overrides(feed=feed)
    assert made.status().left_s == (0.0,)
    made.cycle_start()
    made.advance(1)
    found = []
    while made.channel_status().active:
        found.append((made.clock.now_s, made.status().left_s[0]))
        made.advance(237)
    assert len(found) > 10
    ends = [now_s + left_s for now_s, left_s in found if left_s > 0.0]
    # With limited jerk ramps take longer than their mean acceleration says.
    slack_s = 0.4 if jerk_mm_s3 else 0.003
    assert max(ends) - min(ends) < slack_s
    assert found[-1][1] < 0.5


def test_a_hold_keeps_the_time_that_is_left() -> None:
    made = Control(cnc_machine())
    made.programs.create("LEFT", LEFT)
    made.select_program("LEFT")
    made.cycle_start()
    made.advance(900)
    made.feed_hold()
    made.advance(600)
    left_s = made.status().left_s
    made.advance(4000)
    assert made.status().left_s == left_s
    assert left_s[0] > 1.0


def test_work_positions_are_what_a_program_says_where_its_work_offset_turns() -> None:
    text = "G21 G90\nG10 L2 P1 X5 Y3 R30\nG54 G1 X10 Y2 F6000\nG92 X-4.5\nG1 X3.25 Y4\nG4 P9\nM2\n"
    made = Control("mill3", dialect="linuxcnc")
    made.select_program(ProgramText.from_text(text, "turned.ngc"))
    made.select_mode(Mode.AUTO)
    made.cycle_start()
    made.advance(2_000)
    axes = made.axes()
    assert (axes["X"].work, axes["Y"].work) == pytest.approx((3.25, 4.0), abs=1e-9)
    assert axes["X"].machine != pytest.approx(axes["X"].work, abs=1.0)
