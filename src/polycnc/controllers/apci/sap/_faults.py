"""Run-time errors of SAP programs: what CNCTS.errnum means.

The manual lists its numbers in a part that is not printed in Part 1, so these are polycnc's own.
"""

from __future__ import annotations

DIVISION_BY_ZERO = 1
INDEX_RANGE = 2
VALUE_RANGE = 3
ARGUMENT = 4
STACK_OVERFLOW = 5
UNKNOWN_AXIS = 6
REFUSED = 7
BUFFER_RANGE = 8
TASK_NUMBER = 9
ILLEGAL = 10

FAULTS = {
    DIVISION_BY_ZERO: "division by zero",
    INDEX_RANGE: "index out of range",
    VALUE_RANGE: "value does not fit",
    ARGUMENT: "argument outside the function's domain",
    STACK_OVERFLOW: "stack overflow",
    UNKNOWN_AXIS: "the board has no axis of this name",
    REFUSED: "refused by the board",
    BUFFER_RANGE: "outside the common buffer",
    TASK_NUMBER: "no such task",
    ILLEGAL: "an instruction that no compiler writes",
}


class Fault(Exception):  # noqa: N818  # it never leaves a task, which turns it into CNCTS.errnum
    """A run-time error on its way to the task that stops with it."""

    def __init__(self, number: int, name: str = "") -> None:
        super().__init__(f"{FAULTS[number]}: {name}" if name else FAULTS[number])
        self.number = number
