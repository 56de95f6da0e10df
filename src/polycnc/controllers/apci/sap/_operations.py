"""Instructions of the virtual machine that compute, jump and call."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.controllers.apci.sap._arithmetic import BINARY, UNARY
from polycnc.controllers.apci.sap._faults import INDEX_RANGE, STACK_OVERFLOW, Fault
from polycnc.controllers.apci.sap._machine import FRAME_CELLS, STACK_CELLS, Build, Machine, Step
from polycnc.controllers.apci.sap._program import cell_values

# Values and jumps


def _const(machine: Machine, argument: Any, following: int) -> Step:
    push = machine.stack.append

    def step() -> int:
        push(argument)
        return following

    return step


def _drop(machine: Machine, argument: Any, following: int) -> Step:
    pop = machine.stack.pop

    def step() -> int:
        pop()
        return following

    return step


def _load_global(machine: Machine, cell: int, following: int) -> Step:
    push, memory = machine.stack.append, machine.memory

    def step() -> int:
        push(memory[cell])
        return following

    return step


def _store_global(machine: Machine, cell: int, following: int) -> Step:
    pop, memory = machine.stack.pop, machine.memory

    def step() -> int:
        memory[cell] = pop()
        return following

    return step


def _load_local(machine: Machine, cell: int, following: int) -> Step:
    stack = machine.stack

    def step() -> int:
        stack.append(stack[machine.base + cell])
        return following

    return step


def _store_local(machine: Machine, cell: int, following: int) -> Step:
    stack = machine.stack

    def step() -> int:
        stack[machine.base + cell] = stack.pop()
        return following

    return step


def _load_element(local: bool) -> Build:
    def build(machine: Machine, argument: Any, following: int) -> Step:
        stack = machine.stack
        cells = stack if local else machine.memory
        cell, first, last = argument

        def step() -> int:
            index = stack[-1]
            if not first <= index <= last:
                raise Fault(INDEX_RANGE)
            stack[-1] = cells[(machine.base if local else 0) + cell + index - first]
            return following

        return step

    return build


def _store_element(local: bool) -> Build:
    def build(machine: Machine, argument: Any, following: int) -> Step:
        stack = machine.stack
        cells = stack if local else machine.memory
        cell, first, last = argument

        def step() -> int:
            value = stack.pop()
            index = stack.pop()
            if not first <= index <= last:
                raise Fault(INDEX_RANGE)
            cells[(machine.base if local else 0) + cell + index - first] = value
            return following

        return step

    return build


def _binary(function: Callable[[Any, Any], Any]) -> Build:
    def build(machine: Machine, argument: Any, following: int) -> Step:
        stack = machine.stack
        pop = stack.pop

        def step() -> int:
            right = pop()
            stack[-1] = function(stack[-1], right)
            return following

        return step

    return build


def _unary(function: Callable[[Any], Any]) -> Build:
    def build(machine: Machine, argument: Any, following: int) -> Step:
        stack = machine.stack

        def step() -> int:
            stack[-1] = function(stack[-1])
            return following

        return step

    return build


def _jump(machine: Machine, target: int, following: int) -> Step:
    return lambda: target


def _jump_false(machine: Machine, target: int, following: int) -> Step:
    pop = machine.stack.pop
    return lambda: following if pop() else target


def _decide(deciding: bool) -> Build:
    """Build AND or OR: jump if the left side decides, else go on without it."""

    def build(machine: Machine, target: int, following: int) -> Step:
        stack = machine.stack

        def step() -> int:
            if stack[-1] is deciding:
                return target
            stack.pop()
            return following

        return step

    return build


def _within(machine: Machine, argument: Any, following: int) -> Step:
    stack = machine.stack
    first, last, target = argument

    def step() -> int:
        if first <= stack[-1] <= last:
            stack.pop()
            return int(target)
        return following

    return step


# Routines


def _call(machine: Machine, routine: int, following: int) -> Step:
    assert machine.program is not None
    entry = machine.program.routines[routine]
    cells = tuple(cell_values(entry.cells))
    stack, frames = machine.stack, machine.frames
    start, parameters = entry.start, entry.parameters
    room = STACK_CELLS - len(cells) - FRAME_CELLS

    def step() -> int:
        if len(stack) + FRAME_CELLS * len(frames) > room:
            raise Fault(STACK_OVERFLOW)
        frames.append((following, machine.base))
        machine.base = len(stack) - parameters
        stack.extend(cells)
        return start

    return step


def _return(machine: Machine, result: int | None, following: int) -> Step:
    stack, frames = machine.stack, machine.frames

    def step() -> int:
        base = machine.base
        if result is None:
            del stack[base:]
        else:
            stack[base:] = [stack[base + result]]
        back, machine.base = frames.pop()
        return back

    return step


def _end_condition(machine: Machine, argument: Any, following: int) -> Step:
    return lambda: -1


OPERATIONS: dict[str, Build] = {
    "const": _const,
    "drop": _drop,
    "loadg": _load_global,
    "storeg": _store_global,
    "loadl": _load_local,
    "storel": _store_local,
    "loadxg": _load_element(local=False),
    "storexg": _store_element(local=False),
    "loadxl": _load_element(local=True),
    "storexl": _store_element(local=True),
    **{name: _binary(function) for name, function in BINARY.items()},
    **{name: _unary(function) for name, function in UNARY.items()},
    "jump": _jump,
    "jumpfalse": _jump_false,
    "unless": _decide(False),
    "when": _decide(True),
    "within": _within,
    "call": _call,
    "return": _return,
    "endcondition": _end_condition,
}
