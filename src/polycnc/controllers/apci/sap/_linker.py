"""Turn a program into functions that are called one after the other.

Every instruction becomes one closure over the stack and the memory of its task, which does the instruction and
returns the number of the next one. Whatever may end or delay a task leaves that number in the task and raises
`Pause`.
"""

from __future__ import annotations

from polycnc.controllers.apci.sap import _board_operations, _operations, _task_operations
from polycnc.controllers.apci.sap._machine import Build, Machine, Step
from polycnc.controllers.apci.sap._program import Program

OPERATIONS: dict[str, Build] = {
    **_operations.OPERATIONS,
    **_task_operations.OPERATIONS,
    **_board_operations.OPERATIONS,
}


POLLED = frozenset((*_operations.OPERATIONS, "axget", "sysget", "rdcb", "wait", "waitaxes"))
"""Instructions that do nothing to the board, whatever they do to their task."""

_TAKEN_BY_READING = "lp"  # an axis qualifier


class Acts(Exception):  # noqa: N818  # no error: how an instruction that is tried out says that it acts
    """The next instruction would do something to the board, to a task or to a message."""


def _refuse() -> int:
    raise Acts


def only_polling(program: Program, steps: list[Step]) -> list[Step]:
    """Return the instructions of a program with those that act replaced by one that raises `Acts`."""
    return [
        step
        if operation in POLLED and not (operation == "axget" and argument[1].lower() == _TAKEN_BY_READING)
        else _refuse
        for step, (operation, argument, _) in zip(steps, program.code, strict=True)
    ]


def link(machine: Machine, program: Program) -> list[Step]:
    """Return the instructions of a program as functions that work on `machine`."""
    return [
        OPERATIONS[operation](machine, argument, at + 1)
        for at, (operation, argument, _) in enumerate(program.code)
    ]
