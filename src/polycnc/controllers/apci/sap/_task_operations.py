"""Instructions of the virtual machine that end, stop or delay a task, control others and write messages."""

from __future__ import annotations

from typing import Any

from polycnc.controllers.apci.sap._commands import BOOLEAN, INTEGER
from polycnc.controllers.apci.sap._machine import Build, Machine, Pause, Step


def _end_event(machine: Machine, argument: Any, following: int) -> Step:
    def step() -> int:
        del machine.stack[machine.base :]
        machine.next, machine.base = machine.frames.pop()
        machine.leave_event()
        raise Pause

    return step


def _finish(stop: bool) -> Build:
    def build(machine: Machine, argument: Any, following: int) -> Step:
        def step() -> int:
            machine.next = following if stop else following - 1
            machine.end(stop)
            raise Pause

        return step

    return build


def _task(machine: Machine, name: str, following: int) -> Step:
    def step() -> int:
        machine.next = following
        machine.control(name, machine.stack.pop())
        if machine.is_halted() or machine.next != following:
            raise Pause
        return following

    return step


def _wait(machine: Machine, argument: Any, following: int) -> Step:
    def step() -> int:
        machine.next = following
        if machine.wait(machine.stack.pop(), ()):
            raise Pause
        return following

    return step


def _write_text(machine: Machine, text: str, following: int) -> Step:
    def step() -> int:
        machine.write(text)
        return following

    return step


def _write(machine: Machine, argument: Any, following: int) -> Step:
    kind, forms = argument
    pop = machine.stack.pop

    def step() -> int:
        decimals = pop() if forms == 2 else None
        width = pop() if forms else 0
        machine.write(_text(pop(), kind, decimals).rjust(min(width, 512)))
        return following

    return step


def _text(value: Any, kind: str, decimals: int | None) -> str:
    if kind == BOOLEAN:
        return "TRUE" if value else "FALSE"
    if kind == INTEGER:
        return str(value)
    return f"{value:.15g}" if decimals is None else f"{value:.{max(0, min(decimals, 30))}f}"


def _write_line(machine: Machine, argument: Any, following: int) -> Step:
    def step() -> int:
        machine.next = following
        machine.write_line()
        if machine.is_halted():
            raise Pause
        return following

    return step


OPERATIONS: dict[str, Build] = {
    "endevent": _end_event,
    "end": _finish(stop=False),
    "abort": _finish(stop=False),
    "stop": _finish(stop=True),
    "task": _task,
    "wait": _wait,
    "writetext": _write_text,
    "write": _write,
    "writeln": _write_line,
}
