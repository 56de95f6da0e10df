"""Instructions of the virtual machine that use the board: registers, commands, the common buffer."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from polycnc.controllers.apci.core._turn_state import BUFFER_BYTES
from polycnc.controllers.apci.sap import _commands
from polycnc.controllers.apci.sap._arithmetic import wrap
from polycnc.controllers.apci.sap._commands import DOUBLE
from polycnc.controllers.apci.sap._faults import BUFFER_RANGE, INDEX_RANGE, UNKNOWN_AXIS, Fault
from polycnc.controllers.apci.sap._host import Call
from polycnc.controllers.apci.sap._machine import Build, Machine, Pause, Step


def _converted(kind: str) -> Callable[[Any], Any]:
    return float if kind == DOUBLE else lambda value: wrap(int(value))


def _axes(machine: Machine, names: list[str]) -> Callable[[], tuple[int, ...]]:
    """Return a function that gives the indices of axes, or fails if the board lacks one of them."""
    indices = [machine.host.axis_index(name) for name in names]
    known = tuple(index for index in indices if index is not None)

    def axes() -> tuple[int, ...]:
        if len(known) != len(names):
            raise Fault(
                UNKNOWN_AXIS,
                ", ".join(name for name, index in zip(names, indices, strict=True) if index is None),
            )
        return known

    return axes


def _axis_get(machine: Machine, argument: Any, following: int) -> Step:
    axis, name, kind, indexed = argument
    axes, convert, stack, host = _axes(machine, [axis]), _converted(kind), machine.stack, machine.host

    def step() -> int:
        stack.append(convert(host.read_axis(axes()[0], name, stack.pop() if indexed else None)))
        return following

    return step


def _axis_put(machine: Machine, argument: Any, following: int) -> Step:
    axis, name, _, indexed = argument
    axes, stack, host = _axes(machine, [axis]), machine.stack, machine.host

    def step() -> int:
        value = stack.pop()
        host.write_axis(axes()[0], name, stack.pop() if indexed else None, value)
        return following

    return step


def _system_index(name: str, index: int | None, indexed: bool, stack: list[Any]) -> int | None:
    if indexed:
        index = int(stack.pop())
        count = _commands.SYSTEM_VARIABLES[name].count
        if index < 0 or (count is not None and index >= count):
            raise Fault(INDEX_RANGE)
    return index


def _system_get(machine: Machine, argument: Any, following: int) -> Step:
    name, kind, fixed, indexed = argument
    convert, stack, read = _converted(kind), machine.stack, machine.host.read_system

    def step() -> int:
        stack.append(convert(read(name, _system_index(name, fixed, indexed, stack))))
        return following

    return step


def _system_put(machine: Machine, argument: Any, following: int) -> Step:
    name, _, fixed, indexed = argument
    stack, write = machine.stack, machine.host.write_system

    def step() -> int:
        value = stack.pop()
        write(name, _system_index(name, fixed, indexed, stack), value)
        return following

    return step


def _command(machine: Machine, argument: Any, following: int) -> Step:
    name, names, with_values, tables = argument
    stack, host = machine.stack, machine.host
    axes = _axes(machine, names)
    path = _commands.COMMANDS[name.lower()].path
    scalars = sum(table is None for table in tables)

    def step() -> int:
        machine.next = following
        selected = axes()
        taken = [stack.pop() for _ in range(scalars)]
        numbers: list[Any] = []
        for table in tables:
            numbers.append(taken.pop() if table is None else _table(machine, table, numbers[-1]))
        values = tuple(reversed([stack.pop() for _ in names])) if with_values else ()
        dynamics = (
            tuple(float(host.read_system(part, None)) for part in ("trac", "trvl", "trtvl")) if path else None
        )
        host.call(Call(name, selected, values, tuple(numbers), dynamics))  # type: ignore[arg-type]
        if machine.is_halted() or machine.next != following:  # RS halts the tasks, this one included
            raise Pause
        return following

    return step


def _table(machine: Machine, table: list[Any], size: int) -> tuple[float, ...]:
    where, cell, count = table
    if not 1 <= size <= count:
        raise Fault(INDEX_RANGE)
    cells, begin = (machine.stack, machine.base + cell) if where == "l" else (machine.memory, cell)
    return tuple(cells[begin : begin + size])


def _wait_axes(machine: Machine, names: list[str], following: int) -> Step:
    axes = _axes(machine, names)

    def step() -> int:
        machine.next = following
        if machine.wait(0.0, axes()):
            raise Pause
        return following

    return step


def _read_buffer(machine: Machine, letter: str, following: int) -> Step:
    form = struct.Struct(_commands.BUFFER_LETTERS[letter][0])
    stack = machine.stack

    def step() -> int:
        offset = _offset(stack[-1], form)
        (stack[-1],) = form.unpack_from(machine.host.common_buffer(machine.number), offset)
        return following

    return step


def _write_buffer(machine: Machine, letter: str, following: int) -> Step:
    form = struct.Struct(_commands.BUFFER_LETTERS[letter][0])
    stack = machine.stack

    def step() -> int:
        value = stack.pop()
        offset = _offset(stack.pop(), form)
        form.pack_into(
            machine.host.common_buffer(machine.number), offset, value & 255 if form.size == 1 else value
        )
        return following

    return step


def _offset(offset: int, form: struct.Struct) -> int:
    if not 0 <= offset <= BUFFER_BYTES - form.size:
        raise Fault(BUFFER_RANGE)
    return offset


OPERATIONS: dict[str, Build] = {
    "axget": _axis_get,
    "axput": _axis_put,
    "sysget": _system_get,
    "sysput": _system_put,
    "command": _command,
    "waitaxes": _wait_axes,
    "rdcb": _read_buffer,
    "wrcb": _write_buffer,
}
