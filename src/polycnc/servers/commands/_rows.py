"""What an operator can do, as data: a name, parameters with ranges and units, the modes it needs, what it calls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from polycnc.cnc import Breakpoint, Control, Mode, Step

NUMBER, WHOLE, SWITCH, TEXT, MARKS, VALUES = "number", "whole", "switch", "text", "marks", "values"
_LONGEST_MM = 1e6
_MOST_TEXT = 65_536
_MOST_LINE = 10**9


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value that a command takes: `kind` is one of the words above; a `default` makes it optional."""

    name: str
    kind: str
    what: str
    low: float | None = None
    high: float | None = None
    unit: str = ""
    choices: tuple[str, ...] = ()
    required: bool = True
    default: Any = None


@dataclass(frozen=True, slots=True)
class Command:
    """One thing that an operator does; `call` gets the control and the values by name. `modes`: only in one of them."""

    name: str
    what: str
    call: Callable[..., object]
    parameters: tuple[Parameter, ...] = ()
    modes: tuple[Mode, ...] = ()


def _channel(*, all_of_them: bool) -> Parameter:
    what = "Channel, from 0; none is all of them." if all_of_them else "Channel, from 0."
    return Parameter("channel", WHOLE, what, 0, 99, required=False, default=None if all_of_them else 0)


def _switch(name: str, what: str) -> Parameter:
    return Parameter(name, SWITCH, what, required=False)


def _share(name: str, what: str) -> Parameter:
    return Parameter(name, NUMBER, what, 0.0, 10.0, "1 is 100 %", required=False)


_AXIS = Parameter("axis", TEXT, "Name of the axis.", 1, 16)
_DIRECTION = Parameter("direction", WHOLE, "1 or -1.", -1, 1)
_RAPID = Parameter("rapid", SWITCH, "At rapid.", required=False, default=False)
_SIZE = Parameter("size", NUMBER, "Size of an increment or pulse.", 0.0, 1000.0, "mm or deg")
_PROGRAM = Parameter("program", TEXT, "Name of a program in the memory.", 1, 64)
_LINE = Parameter("line", WHOLE, "Line of the program, from 1.", 1, _MOST_LINE, required=False, default=1)
_STEP = Parameter(
    "step", TEXT, "How far.", choices=tuple(step.value for step in Step), required=False, default="run"
)


def _cycle_start(control: Control, *, channel: int, step: str, line: int) -> None:
    control.cycle_start(channel=channel, step=Step(step), line=line)


def _set_switches(control: Control, *, block_delete: list[int] | None, **switches: Any) -> None:
    control.set_switches(block_delete=None if block_delete is None else frozenset(block_delete), **switches)


def _set_breakpoints(control: Control, *, program: str, lines: list[int], channel: int) -> None:
    chosen = control.channels[control.channel_status(channel) and channel]
    others = {each for each in chosen.breakpoints if each.program != program}
    chosen.set_breakpoints(frozenset(others | {Breakpoint(program, line) for line in lines}))
    control.clock.changes += 1


ROWS = (
    Command("select_mode", "Change the mode.", Control.select_mode, (
        Parameter("mode", TEXT, "The mode.", choices=tuple(mode.value for mode in Mode)), _channel(all_of_them=True))),
    Command("select_program", "Select what a start in AUTO executes.", Control.select_program,
        (_PROGRAM, _channel(all_of_them=False))),
    Command("set_mdi", "Put in the text that a start in MDI executes.", Control.set_mdi,
        (Parameter("text", TEXT, "Blocks.", 1, _MOST_TEXT), _channel(all_of_them=False)), (Mode.MDI,)),
    Command("search", "Let the next start begin the selected program at a block.", Control.search, (
        Parameter("line", WHOLE, "Line of the block; 0 to go by the sequence number.", 0, _MOST_LINE,
            required=False, default=0),
        Parameter("sequence", WHOLE, "Sequence number (N) of the block.", 0, _MOST_LINE, required=False),
        Parameter("calculate", SWITCH, "Carry out what is before, without moving.", required=False, default=False),
        _channel(all_of_them=False)), (Mode.AUTO,)),
    Command("cycle_start", "Begin the selected program or the MDI text, or go on.", _cycle_start,
        (_STEP, _LINE, _channel(all_of_them=False)), (Mode.AUTO, Mode.MDI)),
    Command("feed_hold", "Brake the axes of executed programs and of manual motion.", Control.feed_hold,
        (_channel(all_of_them=True),)),
    Command("reset", "Break off everything and clear alarms whose causes are gone.", Control.reset,
        (_channel(all_of_them=True),)),
    Command("emergency_stop", "Press or release the emergency stop.", Control.emergency_stop,
        (Parameter("on", SWITCH, "True presses it.", required=False, default=True),)),
    Command("set_overrides", "Set overrides; what is not given stays.", Control.set_overrides, (
        _share("feed", "Feed override."), _share("rapid", "Rapid override, one of the control's steps."),
        _share("spindle", "Spindle override."), _channel(all_of_them=True))),
    Command("set_switches", "Switch single block and its like; what is not given stays.", _set_switches, (
        _switch("single_block", "Stop after each block."), _switch("optional_stop", "Stop at M1."),
        _switch("dry_run", "Move at the feed of a dry run."), _switch("machine_lock", "Keep the axes at rest."),
        Parameter("block_delete", MARKS, "Numbers of the skip marks that act.", 1, 9, required=False),
        _channel(all_of_them=True))),
    Command("set_breakpoints", "Stop before these lines of a program; others of it no longer.", _set_breakpoints,
        (_PROGRAM, Parameter("lines", MARKS, "Lines, from 1; none takes them away.", 1, _MOST_LINE),
         _channel(all_of_them=False))),
    Command("jog", "Press a jog key, or release it.", Control.jog,
        (_AXIS, Parameter("direction", WHOLE, "1 or -1; none releases the key.", -1, 1, required=False), _RAPID),
        (Mode.JOG,)),
    Command("increment", "Go one increment.", Control.increment, (_AXIS, _DIRECTION, _SIZE, _RAPID), (Mode.INC,)),
    Command("handwheel", "Turn the handwheel.", Control.handwheel,
        (_AXIS, Parameter("pulses", WHOLE, "Pulses, with their sign.", -100_000, 100_000), _SIZE), (Mode.HANDLE,)),
    Command("reference", "Reference an axis.", Control.reference, (_AXIS,), (Mode.REF,)),
    Command("set_relative", "Let the relative position of an axis be this here.", Control.set_relative, (
        _AXIS, Parameter("position", NUMBER, "Position.", -_LONGEST_MM, _LONGEST_MM, "mm or deg",
            required=False, default=0.0))),
    Command("set_tool", "Change fields of a tool, which is made if it is not there.",
        lambda control, number, values: control.tools.set(number, **values),
        (Parameter("number", WHOLE, "Number of the tool.", 1, 99_999_999),
         Parameter("values", VALUES, "Values by field.", -_LONGEST_MM, _LONGEST_MM, "mm"))),
    Command("remove_tool", "Take a tool out of the table.", lambda control, number: control.tools.remove(number),
        (Parameter("number", WHOLE, "Number of the tool.", 1, 99_999_999),)),
    Command("set_offset", "Set, or shift, a work offset; axes that are not given stay.",
        lambda control, name, values, add: control.offsets.set(name, values, add=add),
        (Parameter("name", TEXT, "Name, like G54.", 1, 17),
         Parameter("values", VALUES, "Values by axis.", -_LONGEST_MM, _LONGEST_MM, "mm or deg"),
         Parameter("add", SWITCH, "Add to what is there.", required=False, default=False))),
    Command("clear_alarm_history", "Forget past alarms.", lambda control: control.alarms.clear_history()),
)  # fmt: skip

COMMANDS = {row.name: row for row in ROWS}
"""The commands by name."""
