"""Commands as data: rows against the control, what they refuse, and that a refused one changes nothing."""

from __future__ import annotations

import asyncio
import inspect
import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.cnc import ControlError, Mode, Refusal
from polycnc.machine import Wall
from polycnc.servers.commands import COMMANDS, NUMBERS, carry_out, model_of
from polycnc.servers.machines import Keeper, ServedDevice, ServedMachine
from polycnc.servers.process import KINDS, Machinery
from support.often import share

R = TypeVar("R")


class Still(Wall):
    """A wall clock that does not move."""

    def now_s(self) -> float:
        return 0.0


def with_machine(kind: str, visit: Callable[[ServedMachine], R]) -> R:
    """Visit a machine that is served."""

    async def run() -> R:
        made = KINDS[kind](Machinery("m", None if kind != "plain" else "mill3"))
        served: ServedDevice[Any] = ServedDevice(made.device, made.find_control)
        keeper = Keeper(served, Still())
        made.programs = None  # those of its memory as they come
        machine = ServedMachine(**made.all(), name="m", kind=kind, served=served, keeper=keeper)
        try:
            return visit(machine)
        finally:
            machine.close()

    return asyncio.run(run())


@pytest.mark.parametrize("kind", ["plain", "fanuc"])
def test_a_program_is_put_in_started_held_and_reset(kind: str) -> None:
    def visit(machine: ServedMachine) -> None:
        control, programs = machine.control, machine.programs
        assert control is not None
        assert programs is not None
        assert programs.put("O0012", b"O12\nG1 X10 F600\nM30\n")
        assert not programs.put("O0012", b"O12\nG1 X20 F600\nM30\n")
        carry_out(machine, {"command": "select_mode", "mode": "auto"})
        carry_out(machine, {"command": "select_program", "program": "O0012"})
        carry_out(machine, {"command": "cycle_start"})
        machine.served.advance(500)
        assert control.axes()["X"].machine == pytest.approx(5.0, abs=0.5)
        with pytest.raises(ControlError) as refused:
            programs.delete("O0012")
        assert refused.value.reason is Refusal.IN_USE
        carry_out(machine, {"command": "set_overrides", "feed": 0.5})
        carry_out(machine, {"command": "feed_hold"})
        machine.served.advance(500)
        assert control.channel_status().run_state.value == "hold"
        carry_out(machine, {"command": "reset"})
        programs.delete("O0012")

    with_machine(kind, visit)


def test_each_row_names_what_its_call_takes() -> None:
    for row in COMMANDS.values():
        taken = inspect.signature(row.call).parameters
        names = {each.name for each in row.parameters}
        assert any(each.kind is each.VAR_KEYWORD for each in taken.values()) or names <= set(taken), row.name
        assert model_of(row.name).model_json_schema()["additionalProperties"] is False


def test_every_reason_has_a_number_of_its_own() -> None:
    assert sorted(NUMBERS.values()) == list(range(1, len(Refusal) + 1))


BAD: list[dict[str, Any]] = [
    {},
    {"command": None},
    {"command": "x" * 5000},
    {"command": "reset", "more": 1},
    {"command": "set_overrides", "feed": math.nan},
    {"command": "set_overrides", "feed": 1e308},
    {"command": "set_overrides", "feed": "1"},
    {"command": "set_overrides", "feed": True},
    {"command": "set_switches", "block_delete": [1] * 5000},
    {"command": "set_switches", "dry_run": True, "block_delete": [10]},
    {"command": "set_switches", "single_block": 1},
    {"command": "select_mode", "mode": "no"},
    {"command": "select_program", "program": "../../etc/passwd"},
    {"command": "select_program", "program": "\0"},
    {"command": "select_mode", "mode": "mdi", "channel": 98},
    {"command": "cycle_start", "channel": -1},
    {"command": "cycle_start", "line": 10**40},
    {"command": "cycle_start", "step": "far"},
    {"command": "jog", "axis": "Q", "direction": 1},
    {"command": "jog", "axis": "X"},
    {"command": "handwheel", "axis": "X", "pulses": 1.5, "size": 0.1},
    {"command": "set_offset", "name": "G54", "values": {"X": 1.0, "Q": 2.0}},
    {"command": "set_offset", "name": "G54", "values": {"X": math.inf}},
    {"command": "set_offset", "name": "G54", "values": {"X": "1"}},
    {"command": "set_tool", "number": 5, "values": {"length_mm": 4.0, "radius_mm": -1.0}},
    {"command": "set_tool", "number": 5, "values": {"no": 4.0}},
]


@pytest.fixture(scope="module")
def plain() -> list[Any]:
    """The state of a machine, before and after everything that it refuses."""
    seen: list[Any] = []

    def visit(machine: ServedMachine) -> None:
        control = machine.control
        assert control is not None
        for asked in BAD:
            before = control.status(), control.inventory(), control.snapshot()
            try:
                carry_out(machine, asked)
            except ControlError as error:
                seen.append(
                    (asked, error, before == (control.status(), control.inventory(), control.snapshot()))
                )
            else:
                seen.append((asked, None, False))

    with_machine("plain", visit)
    return seen


@pytest.mark.parametrize("place", range(len(BAD)))
def test_what_is_refused_changes_nothing(place: int, plain: list[Any]) -> None:
    asked, error, same = plain[place]
    if asked == {"command": "jog", "axis": "X"}:  # releasing a key is always allowed
        assert error is None
        return
    assert isinstance(error, ControlError), asked
    assert error.what
    assert error.hint
    assert len(str(error)) < 1000
    assert same


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**20), 10**20) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3),
    max_leaves=5,
)


@settings(max_examples=share(60), deadline=None)
@given(st.data())
def test_random_values_are_carried_out_or_refused(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(COMMANDS)))
    asked = {"command": name} | {
        each.name: data.draw(JSON) for each in COMMANDS[name].parameters if data.draw(st.booleans())
    }

    def visit(machine: ServedMachine) -> None:
        with suppress(ControlError):
            carry_out(machine, asked)
        machine.served.advance(3)

    with_machine("plain", visit)


def test_a_device_without_an_operator_says_so() -> None:
    def visit(machine: ServedMachine) -> None:
        with pytest.raises(ControlError, match="has no operator"):
            carry_out(machine, {"command": "reset"})

    with_machine("imc", visit)


def test_the_modes_of_a_power_mate_follow() -> None:
    def visit(machine: ServedMachine) -> None:
        for mode in Mode:
            carry_out(machine, {"command": "select_mode", "mode": mode.value})
            assert machine.control is not None
            assert machine.control.mode is mode

    with_machine("fanuc", visit)
