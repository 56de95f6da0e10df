"""The table of facts: what is read of a machine for a plant, in one unit each; doors name them in their way."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Any, TypeAlias

from polycnc.cnc import AxisStatus, ChannelStatus, Control, Inventory, Motion, RunState, Status, Timer

Value: TypeAlias = str | int | float | tuple[float, ...] | None
"""A value of a fact; None where there is none now."""

_HOME = 1e-6  # how near to the reference position an axis is at home, mm or deg


class Scope(StrEnum):
    """What a fact is one of."""

    MACHINE = "machine"
    CHANNEL = "channel"
    AXIS = "axis"
    SPINDLE = "spindle"


class Unit(StrEnum):
    """The unit of a fact; those of an axis are its own, mm or deg."""

    NONE = ""
    LENGTH = "mm or deg"
    SPEED = "mm/s or deg/s"
    MM = "mm"
    MM_MIN = "mm/min"
    RPM = "rpm"
    PERCENT = "%"
    SECOND = "s"
    DEG = "deg"


class Execution(StrEnum):
    """What a channel does with its program."""

    READY = "ready"
    ACTIVE = "active"
    HOLD = "hold"
    INTERRUPTED = "interrupted"
    STOPPED = "stopped"
    PROGRAM_STOP = "program stop"
    OPTIONAL_STOP = "optional stop"
    COMPLETED = "completed"


_EXECUTIONS = {
    RunState.READY: Execution.READY,
    RunState.RESET: Execution.STOPPED,
    RunState.ACTIVE: Execution.ACTIVE,
    RunState.HOLD: Execution.HOLD,
    RunState.STOPPED_AT_BLOCK: Execution.INTERRUPTED,
    RunState.PROGRAM_STOP: Execution.PROGRAM_STOP,
    RunState.OPTIONAL_STOP: Execution.OPTIONAL_STOP,
    RunState.COMPLETED: Execution.COMPLETED,
    RunState.ALARM: Execution.STOPPED,
}


_PROGRAMS = {RunState.HOLD: "interrupted", RunState.RESET: "canceled", RunState.ALARM: "canceled"}
_PRODUCTION = {
    RunState.READY: "initializing", RunState.COMPLETED: "ended", RunState.RESET: "aborted", RunState.ALARM: "aborted",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Seen:
    """A control at one cycle: its status, its inventory, and what of that is looked up often."""

    status: Status
    inventory: Inventory
    comments: Mapping[str, str]
    homes: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Fact:
    """A row: `read` returns the value; it gets the channel or axis that the fact is of, the spindle's gets None."""

    name: str
    scope: Scope
    what: str
    read: Callable[[Seen, Any], Value]
    unit: Unit = Unit.NONE


class _Lookups:
    """What is looked up in an inventory, made once for each revision of it."""

    def __init__(self) -> None:
        self._inventory: Inventory | None = None
        self._comments: Mapping[str, str] = MappingProxyType({})
        self._homes: Mapping[str, float] = MappingProxyType({})

    def see(self, status: Status, inventory: Inventory) -> Seen:
        if inventory is not self._inventory:
            self._inventory = inventory
            self._comments = {each.name: each.comment for each in inventory.programs}
            self._homes = {each.name: each.home for each in inventory.axes}
        return Seen(status, inventory, self._comments, self._homes)


def asset_id(machine: str, tool: int) -> str:
    """Return what a tool of a machine is called among all tools of a plant."""
    return f"{machine}.T{tool}"


def see(control: Callable[[], Control]) -> Callable[[], Seen]:
    """Return what reads a control at its present cycle."""
    lookups = _Lookups()

    def read() -> Seen:
        found = control()
        return lookups.see(found.status(), found.inventory())

    return read


def _execution(channel: ChannelStatus) -> str:
    return Execution.ACTIVE if channel.active else _EXECUTIONS[channel.run_state]


def _channel_state(channel: ChannelStatus) -> str:
    if channel.interrupted or channel.run_state is RunState.ALARM:
        return "interrupted"
    return "active" if channel.active or channel.motion is not Motion.NONE else "reset"


def _program_state(channel: ChannelStatus) -> str:
    if channel.run_state is RunState.ACTIVE and channel.starved:
        return "waiting"
    return "running" if channel.active else _PROGRAMS.get(channel.run_state, "stopped")


def _production(channel: ChannelStatus) -> str:
    return "running" if channel.active else _PRODUCTION.get(channel.run_state, "interrupted")


def _job(seen: Seen, channel: ChannelStatus) -> str:
    """Return the state of the lot: between two of its parts it is interrupted."""
    state, parts = _production(channel), seen.status.parts
    return "interrupted" if state == "ended" and parts.made < parts.required else state


def _spindle_state(seen: Seen) -> str:
    spindle = seen.status.spindle
    if spindle.actual_rpm == 0.0 and spindle.commanded_rpm == 0.0:
        return "stopped"
    if spindle.reached:
        return "in target area"
    return "decelerating" if abs(spindle.actual_rpm) > abs(spindle.commanded_rpm) else "accelerating"


def _codes(words: object) -> tuple[float, ...]:
    """Return the codes of words like `G54`, `54` or `M3` that are whole numbers."""
    found = []
    for word in words if isinstance(words, list | tuple) else ():
        text = str(word).lstrip("GMgm")
        if text.isascii() and text.isdigit():
            found.append(int(text))
    return tuple(found)


def _position(seen: Seen, channel: ChannelStatus) -> Value:
    """Return where the tool is in the channel's own work coordinates, None without three linear axes X, Y and Z."""
    axes = seen.status.axes
    if not all(name in channel.axes and axes[name].unit == "mm" for name in ("X", "Y", "Z")):
        return None
    return tuple(axes[name].work for name in ("X", "Y", "Z"))


def _axis_state(seen: Seen, axis: AxisStatus) -> str:
    if axis.moving:
        return "travel"
    at_home = axis.referenced and abs(axis.machine - seen.homes[axis.name]) <= _HOME
    return "home" if at_home else "stopped"


def _timer(timer: Timer) -> Callable[[Seen, Any], Value]:
    return lambda seen, _: int(seen.status.timers_s[timer] + 1e-9)


_M, _C, _A, _S = Scope.MACHINE, Scope.CHANNEL, Scope.AXIS, Scope.SPINDLE
# fmt: off
_ROWS = (
    Fact("available", _M, "whether the machine answers", lambda seen, _: "available"),
    Fact("emergency", _M, "the emergency stop: on, off, or released without the reset that it needs",
        lambda seen, _: seen.status.emergency.value),
    Fact("powered_s", _M, "how long it has been on", _timer(Timer.POWER_ON), Unit.SECOND),
    Fact("operating_s", _M, "how long programs have run", _timer(Timer.OPERATING), Unit.SECOND),
    Fact("cutting_s", _M, "how long feeds have moved", _timer(Timer.CUTTING), Unit.SECOND),
    Fact("mode", _C, "the mode", lambda seen, it: it.mode.value),
    Fact("execution", _C, "what it does with its program", lambda seen, it: _execution(it)),
    Fact("program", _C, "the selected program", lambda seen, it: it.program),
    Fact("active_program", _C, "the program whose block is executed",
        lambda seen, it: it.stack[-1] if it.stack else None),
    Fact("program_comment", _C, "the comment of the selected program",
        lambda seen, it: seen.comments.get(it.program or "") or None),
    Fact("nest_level", _C, "how deep sub-programs are called", lambda seen, it: max(0, len(it.stack) - 1)),
    Fact("block", _C, "the executed block", lambda seen, it: it.block.text.strip() if it.block else None),
    Fact("line", _C, "its line, from 1", lambda seen, it: it.block.line if it.block else None),
    Fact("sequence", _C, "its sequence number (N)", lambda seen, it: it.block.sequence if it.block else None),
    Fact("offset", _C, "where it begins in its program, in bytes",
        lambda seen, it: it.block.offset if it.block else None),
    Fact("block_program", _C, "the program of the executed block, the selected one without a block",
        lambda seen, it: it.block.program if it.block else it.program),
    Fact("main_program", _C, "the program that called the others",
        lambda seen, it: it.stack[0] if it.stack else it.program),
    Fact("g_codes", _C, "the modal G codes that are whole numbers",
        lambda seen, it: _codes(list(it.modal.g.values())) if it.modal else ()),
    Fact("m_codes", _C, "the M codes of the executed block that are whole numbers",
        lambda seen, it: tuple(it.modal.m) if it.modal else ()),
    Fact("channel_state", _C, "active, interrupted (after an alarm until a reset) or reset",
        lambda seen, it: _channel_state(it)),
    Fact("program_state", _C, "stopped, running, waiting for more of the program, interrupted or canceled",
        lambda seen, it: _program_state(it)),
    Fact("production", _C, "initializing, running, ended, interrupted or aborted", lambda seen, it: _production(it)),
    Fact("job", _C, "the same of the lot, which is interrupted between two of its parts", _job),
    Fact("hold", _C, "feed hold", lambda seen, it: int(it.run_state is RunState.HOLD)),
    Fact("feed", _C, "the speed along the path", lambda seen, it: it.feed.actual, Unit.MM_MIN),
    Fact("commanded_feed", _C, "the speed that it shall have, with overrides",
        lambda seen, it: it.feed.commanded, Unit.MM_MIN),
    Fact("programmed_feed", _C, "the F word, without overrides",
        lambda seen, it: it.feed.programmed, Unit.MM_MIN),
    Fact("feed_override", _C, "the feed override", lambda seen, it: 100 * it.overrides.feed, Unit.PERCENT),
    Fact("rapid_override", _C, "the rapid override", lambda seen, it: 100 * it.overrides.rapid, Unit.PERCENT),
    Fact("path_position", _C, "X, Y and Z in work coordinates", _position, Unit.MM),
    Fact("tool", _C, "the tool in the spindle, 0 for none", lambda seen, it: it.tool.number),
    Fact("work_offset", _C, "the work offset", lambda seen, it: it.offsets[0].name if it.offsets else None),
    Fact("active_axes", _C, "its axes", lambda seen, it: " ".join(it.axes)),
    Fact("dry_run", _C, "dry run", lambda seen, it: int(it.switches.dry_run)),
    Fact("single_block", _C, "single block", lambda seen, it: int(it.switches.single_block)),
    Fact("machine_lock", _C, "machine lock", lambda seen, it: int(it.switches.machine_lock)),
    Fact("optional_stop", _C, "optional stop", lambda seen, it: int(it.switches.optional_stop)),
    Fact("block_delete", _C, "block delete", lambda seen, it: int(bool(it.switches.block_delete))),
    Fact("jog_increment", _M, "the step of the handwheel", lambda seen, _: seen.status.wheel.size, Unit.MM),
    Fact("cycle_s", _M, "how long the program has run", _timer(Timer.CYCLE), Unit.SECOND),
    Fact("parts", _M, "parts made in this lot", lambda seen, _: seen.status.parts.made),
    Fact("parts_wanted", _M, "parts that the lot shall have, 0 for no number",
        lambda seen, _: seen.status.parts.required),
    Fact("parts_total", _M, "parts made in all", lambda seen, _: seen.status.parts.total),
    Fact("machine_position", _A, "the actual machine position", lambda seen, it: it.machine, Unit.LENGTH),
    Fact("setpoint", _A, "the commanded machine position", lambda seen, it: it.setpoint, Unit.LENGTH),
    Fact("work_position", _A, "the position in work coordinates", lambda seen, it: it.work, Unit.LENGTH),
    Fact("to_go", _A, "what is left of the executed block", lambda seen, it: it.to_go, Unit.LENGTH),
    Fact("following_error", _A, "setpoint less actual position", lambda seen, it: it.following_error, Unit.LENGTH),
    Fact("velocity", _A, "the velocity", lambda seen, it: it.velocity, Unit.SPEED),
    Fact("load", _A, "the load, which follows the speed", lambda seen, it: it.load_percent, Unit.PERCENT),
    Fact("zero_offset", _A, "machine position less work position", lambda seen, it: it.machine - it.work, Unit.LENGTH),
    Fact("moving", _A, "whether it moves", lambda seen, it: int(it.moving)),
    Fact("referenced", _A, "whether its reference is known", lambda seen, it: int(it.referenced)),
    Fact("axis_state", _A, "home, travel or stopped", _axis_state),
    Fact("spindle_speed", _S, "its speed, without sign", lambda seen, _: abs(seen.status.spindle.actual_rpm), Unit.RPM),
    Fact("commanded_spindle_speed", _S, "the speed that it shall have, with the override",
        lambda seen, _: abs(seen.status.spindle.commanded_rpm), Unit.RPM),
    Fact("programmed_spindle_speed", _S, "the S word",
        lambda seen, _: abs(seen.status.spindle.programmed_rpm), Unit.RPM),
    Fact("spindle_override", _S, "its override", lambda seen, _: 100 * seen.status.spindle.override, Unit.PERCENT),
    Fact("spindle_direction", _S, "the direction that it was given: 1 clockwise, -1, None for stopped",
        lambda seen, _: seen.status.spindle.direction or None),
    Fact("spindle_turn", _S, "the direction in which it turns: 1 clockwise, -1, 0 for none",
        lambda seen, _: (seen.status.spindle.actual_rpm > 0.0) - (seen.status.spindle.actual_rpm < 0.0)),
    Fact("spindle_state", _S, "stopped, in target area, accelerating or decelerating",
        lambda seen, _: _spindle_state(seen)),
    Fact("spindle_angle", _S, "its angle", lambda seen, _: seen.status.spindle.angle_deg, Unit.DEG),
    Fact("spindle_mode", _S, "what the rotary axis is used as", lambda seen, _: "spindle"),
)
# fmt: on

FACTS: Mapping[str, Fact] = MappingProxyType({row.name: row for row in _ROWS})
"""The facts by name."""
