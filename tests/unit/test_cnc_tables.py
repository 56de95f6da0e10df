"""Alarms, messages, timers, parts, tools and offsets: what they hold, and what lasts."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import pytest

from polycnc.cnc import (
    ALARMS,
    AlarmKind,
    AlarmList,
    ControlError,
    OffsetTable,
    OperatorMessages,
    PartCounter,
    Parts,
    Timer,
    Timers,
    Tool,
    ToolTable,
)
from polycnc.machine import Clock, MachineConfig, Store

AXES = (
    {"name": "X", "vmax_mm_s": 100, "amax_mm_s2": 1000},
    {"name": "Z", "vmax_mm_s": 100, "amax_mm_s2": 1000},
)
CONFIG = MachineConfig.model_validate(
    {
        "name": "m",
        "axis": AXES,
        "tools": {"7": {"length_mm": 83.5, "radius_mm": 6.0, "description": "mill"}},
        "offsets": {"G54": {"X": 12.5}},
    }
)


def test_alarms_have_numbers_and_texts_and_go_as_their_kind_says() -> None:
    clock = Clock(0.001, datetime(2026, 2, 3, 4, 5, 6))
    alarms = AlarmList(Store(), clock)
    clock.tick(41)
    first = alarms.put("soft_limit_high", axis="Z")
    assert (first.number, first.text) == (211, "axis Z is at its upper software limit")
    assert (first.kind, first.cycle) == (AlarmKind.TRAVEL, 41)
    alarms.put("emergency_stop")
    clock.tick(5)
    assert alarms.put("soft_limit_high", axis="Z") is first
    alarms.put("soft_limit_high", axis="X")
    assert [alarm.axis for alarm in alarms.active] == ["Z", None, "X"]
    alarms.cause_gone("soft_limit_high", "Z")
    assert alarms.has("soft_limit_high", "Z")
    saved = alarms.snapshot()
    alarms.reset()
    assert [alarm.name for alarm in alarms.active] == ["emergency_stop"]
    alarms.cause_gone("emergency_stop")
    assert alarms.active == ()
    assert bool(alarms) is False
    alarms.restore(saved)
    assert alarms.active == saved
    past = alarms.history()
    assert [(each.number, each.axis) for each in past] == [(211, "Z"), (400, None), (211, "X")]
    assert past[0].time == "2026-02-03T04:05:06.041000"
    alarms.clear_history()
    assert alarms.history() == ()
    assert alarms


def test_the_history_is_bounded_and_lasts(tmp_path: Path) -> None:
    store = Store(tmp_path / "s")
    alarms = AlarmList(store, Clock(0.001), keep=3)
    for number in range(5):
        alarms.put("program", detail=f"error {number}")
        alarms.reset()
    store.close()
    again = AlarmList(Store(tmp_path / "s"), Clock(0.001), keep=3)
    assert [each.text for each in again.history()] == ["error 2", "error 3", "error 4"]
    assert not again


def test_every_alarm_has_a_number_of_its_own() -> None:
    numbers = [row.number for row in ALARMS.values()]
    assert len(set(numbers)) == len(numbers)


def test_messages_are_shown_by_number_and_withdrawn() -> None:
    clock = Clock(0.001)
    messages = OperatorMessages(Store(), clock, keep=2)
    messages.show(2001, "load the next blank")
    messages.show(2002, "door is open")
    messages.show(2001, "load two blanks")
    assert [(each.number, each.text) for each in messages.shown] == [
        (2002, "door is open"),
        (2001, "load two blanks"),
    ]
    messages.withdraw(2002)
    messages.withdraw(2002)
    saved = messages.snapshot()
    messages.withdraw()
    assert list(messages.shown) == []
    messages.restore(saved)
    assert len(messages.shown) == 1
    for number, text in ((-1, "a"), (1, " "), (1, "a\nb"), (1, "x" * 256)):
        with pytest.raises(ControlError):
            messages.show(number, text)
    assert [text for _, text, _ in messages.history()] == ["door is open", "load two blanks"]


def test_timers_count_what_runs_and_last(tmp_path: Path) -> None:
    store, clock = Store(tmp_path / "s"), Clock(0.002)
    timers = Timers(store, clock, save_every_s=10.0)
    for cycles, operating, cut_s, tool in (
        (700, False, 0.0, 0),
        (1500, True, 0.0, 3),
        (900, True, 1.75, 3),
    ):
        clock.tick(cycles)
        timers.count(cycles, operating=operating, cut_s=cut_s, tool=tool)
    shown = {timer: timers.seconds(timer) for timer in Timer}
    assert shown == pytest.approx(
        {Timer.POWER_ON: 6.2, Timer.OPERATING: 4.8, Timer.CUTTING: 1.75, Timer.CYCLE: 4.8}
    )
    assert timers.tool_seconds(3) == pytest.approx(1.75)
    timers.start_cycle()
    assert timers.seconds(Timer.CYCLE) == 0.0
    assert Timers(Store(), clock).seconds(Timer.OPERATING) == 0.0
    saved = timers.snapshot()
    timers.set_seconds(Timer.OPERATING, 77.0)
    timers.set_tool_seconds(4, 5.5)
    store.close()
    store = Store(tmp_path / "s")
    again = Timers(store, Clock(0.001))
    assert again.seconds(Timer.OPERATING) == 77.0
    assert again.seconds(Timer.CUTTING) == pytest.approx(1.75)
    assert {tool: again.tool_seconds(tool) for tool in again.tools} == pytest.approx({3: 1.75, 4: 5.5})
    timers.restore(saved)
    assert timers.seconds(Timer.OPERATING) == pytest.approx(4.8)
    for bad in (-1.0, float("inf")):
        with pytest.raises(ControlError):
            again.set_seconds(Timer.CUTTING, bad)
    with pytest.raises(ControlError):
        again.set_tool_seconds(0, 1.0)


def test_timers_are_saved_on_the_way(tmp_path: Path) -> None:
    store, clock = Store(tmp_path / "s"), Clock(0.001)
    timers = Timers(store, clock, save_every_s=2.0)
    for _ in range(5):
        clock.tick(900)
        timers.count(900)
    store.close()  # not asked to save: 2.7 s were saved on the way
    assert Timers(Store(tmp_path / "s"), Clock(0.001)).seconds(Timer.POWER_ON) == pytest.approx(2.7)


def test_parts_are_counted_durably(tmp_path: Path) -> None:
    store = Store(tmp_path / "s")
    counter = PartCounter(store)
    counter.set(required=3, total=40)
    counter.count()
    counter.count()
    assert counter.parts == Parts(2, 3, 42)
    counter.count()
    assert counter.parts == Parts(3, 3, 43)
    assert Parts(3, 3, 43).reached
    counter.set(made=0)
    assert counter.parts == Parts(0, 3, 43)
    assert not Parts(0, 3, 43).reached
    for bad in ({"made": -1}, {"required": 10**9}):
        with pytest.raises(ControlError):
            counter.set(**bad)
    store.close()
    assert PartCounter(Store(tmp_path / "s")).parts == Parts(0, 3, 43)
    counter_without_lot = PartCounter(Store())
    counter_without_lot.count()
    assert not counter_without_lot.parts.reached


def test_tools_overlay_the_machine_file_and_last(tmp_path: Path) -> None:
    store = Store(tmp_path / "s")
    tools = ToolTable(store, CONFIG)
    assert tools[7] == Tool(83.5, 6.0, description="mill")
    tools.set(7, wear_length_mm=-0.125)
    tools.set(12, radius_mm=3, tip=8)
    assert tools.revision == 2
    store.close()
    store = Store(tmp_path / "s")
    again = ToolTable(store, CONFIG)
    assert dict(again) == {
        7: Tool(83.5, 6.0, -0.125, description="mill"),
        12: Tool(radius_mm=3.0, tip=8),
    }
    before = again.revision
    again.remove(7)
    assert 7 not in again
    assert again.revision == before + 1  # a program under way asks for it
    store.close()
    assert list(ToolTable(Store(tmp_path / "s"), CONFIG)) == [12]


def test_tools_that_an_earlier_version_has_kept_are_read(tmp_path: Path) -> None:
    store = Store(tmp_path / "s")
    store.area("cnc.tools", dict)[5] = {
        "length_mm": 71.25,
        "radius_mm": 0.4,
        "description": "old",
        "orientation": 3,
    }
    store.close()
    assert ToolTable(Store(tmp_path / "s"), CONFIG)[5] == Tool(71.25, 0.4, description="old", tip=3)


@pytest.mark.parametrize(
    ("number", "changes"),
    [
        (0, {"length_mm": 1.0}),
        (7, {"size": 1.0}),
        (7, {"length_mm": 1.5, "radius_mm": -2.0}),
        (7, {"wear_radius_mm": float("nan")}),
        (7, {"length_mm": "long"}),
        (7, {"length_mm": True}),
        (7, {"tip": 10}),
        (7, {"tip": 2.5}),
        (7, {"description": 5.0}),
    ],
)
def test_a_tool_that_cannot_be_is_refused(number: int, changes: dict[str, float | str]) -> None:
    tools = ToolTable(Store(), CONFIG)
    with pytest.raises(ControlError):
        tools.set(number, **changes)
    with pytest.raises(ControlError):
        tools.remove(8)
    assert dict(tools) == {7: Tool(83.5, 6.0, description="mill")}
    assert tools.revision == 0


def test_offsets_change_axis_by_axis_and_last(tmp_path: Path) -> None:
    store = Store(tmp_path / "s")
    offsets = OffsetTable(store, CONFIG)
    offsets.set("G54", {"Z": -3.25})
    offsets.set("G54", {"X": 0.5}, add=True)
    offsets.set("G54.P12", {"X": 2}, add=True)
    for name, values in (
        ("g54", {"X": 1.0}),
        ("G55", {"W": 1.0}),
        ("G54", {"X": 1.0, "Z": float("inf")}),
    ):
        with pytest.raises(ControlError):
            offsets.set(name, values)
    assert offsets.revision == 3
    with pytest.raises(TypeError):
        offsets["G54"]["X"] = 1.0  # type: ignore[index]
    store.close()
    again = OffsetTable(Store(tmp_path / "s"), CONFIG)
    assert {name: dict(values) for name, values in again.items()} == {
        "G54": {"X": 13.0, "Z": -3.25},
        "G54.P12": {"X": 2.0},
    }
