"""What changes seldom: read once, with a revision for each part."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from pydantic import TypeAdapter

from polycnc.cnc import (
    AxisLimits,
    Breakpoint,
    Control,
    ControlData,
    Identity,
    Inventory,
    PastMessage,
    SetBreakpoint,
    Tool,
)
from polycnc.nc import load_dialect
from support.cnc_control import control, started
from support.cnc_machine import cnc_machine

INVENTORY = TypeAdapter(Inventory)

CHANGES: dict[str, tuple[str, Callable[[Control], object]]] = {
    "a program comes": ("programs", lambda c: c.programs.create("NEW", "(FLANGE)\nG1 X1.5 F40\n")),
    "a program is written": ("programs", lambda c: c.programs.write("SLOT", "M30\n")),
    "a program goes": ("programs", lambda c: c.programs.delete("SLOT")),
    "all programs go": ("programs", lambda c: c.programs.delete_all()),
    "a program is renamed": ("programs", lambda c: c.programs.rename("SLOT", "GROOVE")),
    "a program is copied": ("programs", lambda c: c.programs.copy("SLOT", "GROOVE")),
    "a program is protected": ("programs", lambda c: c.programs.protect("SLOT")),
    "a tool is measured": ("tools", lambda c: c.tools.set(12, length_mm=31.25)),
    "a tool goes": ("tools", lambda c: c.tools.remove(7)),
    "an offset is set": ("offsets", lambda c: c.offsets.set("G55", {"Y": -4.75})),
    "an alarm comes": ("alarms", lambda c: c.put_alarm("function_failed", detail="coolant")),
    "the history goes": ("alarms", lambda c: c.alarms.clear_history()),
    "a message comes": ("messages", lambda c: c.messages.show(2041, "CHECK COOLANT")),
    "a breakpoint": (
        "breakpoints",
        lambda c: c.channels[0].set_breakpoints(frozenset({Breakpoint("PART", 3)})),
    ),
    "another dialect": ("identity", lambda c: c.change_dialect(load_dialect("haas"))),
    "other limits": (
        "axes",
        lambda c: c.change_axes(
            tuple(
                axis.model_copy(update={"soft_limits_mm": (-3.5, 2.25)}) if axis.name == "Y" else axis
                for axis in c.machine.config.axes
            )
        ),
    ),
}


def _made() -> Control:
    made = control(ControlData(serial_number="A-4711"))
    made.tools.set(7, radius_mm=1.25)
    return made


@pytest.mark.parametrize("change", CHANGES)
def test_one_part_changes_and_no_other(change: str) -> None:
    part, command = CHANGES[change]
    made = _made()
    before = made.inventory()
    assert made.inventory() is before
    command(made)
    after = made.inventory()
    grown = {name for name, number in after.revisions.items() if number != before.revisions[name]}
    assert grown == {part}
    assert after.revisions[part] == before.revisions[part] + 1
    for name in before._fields[1:]:
        if name != part:
            assert getattr(after, name) is getattr(before, name)
    if change != "the history goes":  # there was none
        assert getattr(after, part) != getattr(before, part)


def test_time_changes_nothing_of_it() -> None:
    made = started(ControlData(serial_number="A-4711"))
    before = made.inventory()
    made.advance(5000)
    assert made.inventory() is before


def test_what_is_in_it() -> None:
    made = _made()
    made.offsets.set("G54", {"X": 2.5})
    made.advance(733)
    made.put_alarm("function_failed", detail="coolant")
    made.messages.show(2041, "CHECK COOLANT")
    made.channels[0].set_breakpoints(frozenset({Breakpoint("PART", 3), Breakpoint(condition=lambda: True)}))
    found = made.inventory()
    assert found.identity == Identity("cnc", "A-4711", "din")
    assert found.axes[0] == AxisLimits("X", "mm", -50.0, 80.0, 12.5, 120.0, 700.0)
    assert found.axes[3] == AxisLimits("B", "deg", None, None, 0.0, 90.0, 360.0)
    assert [(each.name, each.comment) for each in found.programs] == [("PART", "PLATE"), ("SLOT", "")]
    assert found.tools == {7: Tool(radius_mm=1.25)}
    assert found.offsets == {"G54": {"X": 2.5}}
    assert [each.text for each in found.alarms] == ["coolant"]
    assert found.messages == (PastMessage(2041, "CHECK COOLANT", made.clock.now.isoformat()),)
    assert found.breakpoints == (SetBreakpoint(0, "", 0, True), SetBreakpoint(0, "PART", 3, False))


def test_it_goes_to_json_and_back() -> None:
    made = _made()
    made.put_alarm("following_error", axis="Y")
    found = made.inventory()
    assert INVENTORY.validate_json(INVENTORY.dump_json(found)) == found


def test_every_machine_has_one() -> None:
    assert Control(cnc_machine()).inventory().identity.serial_number == ""
