"""What a step can do, as rows: the commands of the operator, what happens to a machine, what happens to a door."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import timedelta
from typing import TYPE_CHECKING, Annotated, Any, cast

from pydantic import Field, ValidationError

from polycnc.cnc import Control, RunState
from polycnc.errors import UsageError
from polycnc.machine import StrictModel
from polycnc.servers.commands import COMMANDS, carry_out, model_of, told
from polycnc.servers.focas import Fault, FaultKind
from polycnc.servers.machines import ServedMachine

if TYPE_CHECKING:
    from polycnc.controllers.fanuc import PowerMate

Undo = Callable[[], object]
_Text = Annotated[str, Field(max_length=255)]


class _Nothing(StrictModel):
    """No values."""


class _Alarm(StrictModel):
    number: Annotated[int, Field(ge=0, le=5999)] = 310
    text: Annotated[str, Field(max_length=64)] = ""
    axis: Annotated[str, Field(max_length=16)] | None = None


class _Message(StrictModel):
    number: Annotated[int, Field(ge=0, le=9999)] = 1
    text: _Text


class _Input(StrictModel):
    point: Annotated[str, Field(min_length=1, max_length=64)]
    value: int = 1


class _Clock(StrictModel):
    shift_s: Annotated[float, Field(ge=-1e9, le=1e9)]


class _Rate(StrictModel):
    rate: Annotated[float, Field(ge=0.0, le=1000.0)]


class _Program(StrictModel):
    program: Annotated[str, Field(min_length=1, max_length=64)]
    channel: Annotated[int, Field(ge=0, le=99)] = 0


class _Connection(StrictModel):
    delay_s: Annotated[float, Field(ge=0.0, le=3600.0)] = 0.0
    commands: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Action:
    """One thing that a step does: `begin` does it and returns what undoes it, None where nothing does.

    `check` refuses a machine or values that it is not for. `connection`: it is about a door, which has to treat its
    requests in this way for as long as the step lasts.
    """

    name: str
    what: str
    values: type[StrictModel]
    begin: Callable[[ServedMachine, Any], Undo | None]
    check: Callable[[ServedMachine, Any], None] = lambda machine, values: None
    ends: bool = False
    connection: bool = False


def _control(machine: ServedMachine) -> Control:
    control = machine.control
    if control is None:
        raise UsageError(
            f"machine {machine.name} has no control", hint="A scenario is for a plain, fanuc or bosch one."
        )
    return control


def _mate(machine: ServedMachine) -> PowerMate:
    assert machine.kind == "fanuc"
    return cast("PowerMate", machine.device)


# ---------------------------------------------------------------------- what happens to a machine


def _alarm_name(machine: ServedMachine, number: int) -> str:
    table = _control(machine).data.alarms
    found = next((name for name, row in table.items() if row.number == number), None)
    if found is None:
        numbers = ", ".join(str(row.number) for row in table.values())
        raise UsageError(f"this control has no alarm {number}", hint=f"Its alarms are {numbers}.")
    return found


def _check_alarm(machine: ServedMachine, values: _Alarm) -> None:
    control = _control(machine)
    if values.axis is not None and values.axis not in control.machine.config.axis_names:
        raise UsageError(f"there is no axis {values.axis}", hint="Name one of the machine.")
    if machine.kind != "fanuc":
        _alarm_name(machine, values.number)


def _alarm(machine: ServedMachine, values: _Alarm) -> Undo:
    control = _control(machine)
    if machine.kind == "fanuc":
        names = control.machine.config.axis_names
        axis = None if values.axis is None else names.index(values.axis) + 1
        _mate(machine).raise_alarm(values.number, values.text, axis=axis)
    else:
        control.put_alarm(_alarm_name(machine, values.number), axis=values.axis, detail=values.text)
    return lambda: carry_out(machine, {"command": "reset"})


def _message(machine: ServedMachine, values: _Message) -> Undo:
    messages = _control(machine).messages
    messages.show(values.number, values.text)
    return lambda: messages.withdraw(values.number)


def _input(machine: ServedMachine, values: _Input) -> Undo:
    control = _control(machine)
    before = control.machine.io[values.point]

    def put(value: int) -> None:
        control.machine.io[values.point] = value
        control.clock.changes += 1

    put(values.value)
    return lambda: put(before)


def _check_input(machine: ServedMachine, values: _Input) -> None:
    io = _control(machine).machine.io
    before = io[values.point]
    io[values.point] = values.value  # refuses what does not fit
    io[values.point] = before


def _clock(machine: ServedMachine, values: _Clock) -> None:
    clock = machine.served.clock
    clock.set_now(clock.now + timedelta(seconds=values.shift_s))


def _part(machine: ServedMachine, _: _Nothing) -> None:
    _control(machine).parts.count()


def _rate(machine: ServedMachine, values: _Rate) -> Undo:
    pace = machine.keeper.pace
    before = pace.rate
    pace.rate = values.rate

    def back() -> None:
        pace.rate = before

    return back


def _start(machine: ServedMachine, values: _Program) -> None:
    carry_out(machine, {"command": "select_program", "program": values.program, "channel": values.channel})
    carry_out(machine, {"command": "cycle_start", "channel": values.channel})


def _power(machine: ServedMachine, _: _Nothing) -> None:
    _mate(machine).power_cycle()


def _check_power(machine: ServedMachine, _: _Nothing) -> None:
    if machine.kind != "fanuc":
        raise UsageError("a power cut is for a fanuc", hint="Press the emergency stop instead.")


# ---------------------------------------------------------------------- commands


def _before(machine: ServedMachine, name: str, values: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Return the command that undoes one, as things are before it; None where nothing does."""
    status = _control(machine).status()
    match name:
        case "emergency_stop":
            return {"command": name, "on": not values.get("on", True)}
        case "feed_hold":
            return {
                "command": "cycle_start",
                **({"channel": values["channel"]} if "channel" in values else {}),
            }
        case "select_mode":
            return {"command": name, "mode": status.mode.value}
        case "jog":
            return {"command": name, "axis": values["axis"]}
        case "set_overrides":
            return {
                "command": name,
                **{key: getattr(status.overrides, key) for key in values if key != "channel"},
            }
        case "set_switches":
            kept = {key: getattr(status.switches, key) for key in values if key != "channel"}
            marks = {"block_delete": sorted(kept.pop("block_delete"))} if "block_delete" in kept else {}
            return {"command": name, **kept, **marks}
    return None


_UNDONE = frozenset({"emergency_stop", "feed_hold", "jog", "select_mode", "set_overrides", "set_switches"})


def _is_due(machine: ServedMachine, back: Mapping[str, Any]) -> bool:
    """Tell whether there is anything to undo: a start goes on with what is held, and starts nothing else."""
    if back["command"] != "cycle_start":
        return True
    control = _control(machine)
    chosen = control.channels if (number := back.get("channel")) is None else (control.channels[number],)
    return any(each.run_state is RunState.HOLD for each in chosen)


def _command(name: str) -> Action:
    def begin(machine: ServedMachine, values: Mapping[str, Any]) -> Undo | None:
        back = _before(machine, name, values)
        carry_out(machine, {"command": name, **values})
        if back is None:
            return None
        return lambda: carry_out(machine, back) if _is_due(machine, back) else None

    def check(machine: ServedMachine, values: Mapping[str, Any]) -> None:
        _control(machine)
        try:
            model_of(name).model_validate({"command": name, **values})
        except ValidationError as error:
            raise _refused(error) from None

    return Action(name, COMMANDS[name].what, StrictModel, begin, check, ends=name in _UNDONE)


# ---------------------------------------------------------------------- connections

_KINDS = {
    "latency": "Answers come later by `delay_s`.",
    "drop": "The connection is reset instead of an answer.",
    "half": "Half of an answer is sent, then the connection is reset.",
    "mute": "Requests are carried out and never answered.",
    "refuse": "New sessions are refused as if all were used.",
    "unreachable": "Nothing listens; connections that are open stay.",
    "no_option": "`commands` (all, if none are named) answer that their option is missing.",
}
DOORS: Mapping[str, frozenset[str]] = {
    "focas": frozenset(_KINDS),
    **dict.fromkeys(("http", "calls", "grbl", "mtconnect", "shdr", "opcua"), frozenset({"latency", "drop"})),
}
"""The doors that count requests, and what can happen to their connections."""


def fault_of(name: str, values: _Connection) -> Fault:
    """Return what happens to a connection, as the door of FOCAS knows it."""
    return Fault(kind=FaultKind(name), at_s=0.0, delay_s=values.delay_s, commands=values.commands)


def _check_connection(name: str) -> Callable[[ServedMachine, Any], None]:
    def check(_: ServedMachine, values: _Connection) -> None:
        try:
            fault_of(name, values)
        except ValidationError as error:
            raise _refused(error) from None

    return check


def _refused(error: ValidationError) -> UsageError:
    return UsageError(told(error), hint="See the values of its row in the reference.")


ROWS = (
    *(_command(name) for name in COMMANDS),
    Action("alarm", "An alarm comes on; at the end RESET is pressed.", _Alarm, _alarm, _check_alarm, ends=True),
    Action("message", "A message to the operator is shown.", _Message, _message, ends=True),
    Action("input", "An input (`I3`, or its name) changes.", _Input, _input, _check_input, ends=True),
    Action("clock", "The machine's date and time jump; its cycles do not.", _Clock, _clock),
    Action("part", "A part is counted.", _Nothing, _part),
    Action("rate", "The machine's time passes at another rate.", _Rate, _rate, ends=True),
    Action("start", "A program of the memory is selected and started.", _Program, _start),
    Action("power_cut", "The control is switched off and on.", _Nothing, _power, _check_power),
    *(Action(name, what, _Connection, lambda machine, values: None, _check_connection(name), True, True)
        for name, what in _KINDS.items()),
)  # fmt: skip
ACTIONS = {row.name: row for row in ROWS}
"""The actions by name."""
