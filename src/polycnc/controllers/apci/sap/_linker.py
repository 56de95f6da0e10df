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


def link(machine: Machine, program: Program) -> list[Step]:
    """Return the instructions of a program as functions that work on `machine`."""
    return [
        OPERATIONS[operation](machine, argument, at + 1)
        for at, (operation, argument, _) in enumerate(program.code)
    ]
