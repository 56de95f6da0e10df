"""SAP programs as numbers, so that the compiled scan can give their tasks their turns.

A cell of a program is a number beside its kind: integers (32 bits) and Booleans are numbers without a fraction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci.core._state import Floats, Whole

TASKS = 4

# Kinds of cells.
INTEGER, DOUBLE, BOOLEAN = range(3)

# Operations. What is not among them is REFUSED: Python carries it out.
REFUSED = 0
(CONSTANT, LOAD, LOAD_ELEMENT, OF_ONE, OF_TWO, AXIS, SLOT, COMMON, BUFFER) = range(
    1, 10
)  # put a value on the stack
(DROP, JUMP, JUMP_FALSE, DECIDE, WITHIN, END_CONDITION) = range(10, 16)
(STORE, STORE_ELEMENT, SET_COMMON, CALL, RETURN, WAIT_TIME, WAIT_AXES) = range(16, 23)  # not in conditions
LAST_VALUE, LAST_JUMP, LAST_STORE = BUFFER, WITHIN, SET_COMMON

# Functions of one value and of two.
(
    NEGATE_WHOLE,
    NEGATE,
    NOT_WHOLE,
    NOT,
    TO_DOUBLE,
    ABS_WHOLE,
    ABS,
    SQUARE_WHOLE,
    SQUARE,
    ROOT,
    TRUNC,
    ROUND,
    ODD,
    SINE,
    COSINE,
    TANGENT,
    ARC_TANGENT,
    LOGARITHM,
    EXPONENTIAL,
) = range(19)
(ADD_WHOLE, SUBTRACT_WHOLE, MULTIPLY_WHOLE, DIV, MOD, AND, OR, XOR, SHIFT_LEFT, SHIFT_RIGHT) = range(10)
(ADD, SUBTRACT, MULTIPLY, DIVIDE, LESS, LESS_EQUAL, MORE, MORE_EQUAL, EQUAL, UNEQUAL) = range(10, 20)

# What a task waits for.
NOTHING, TIME, PROFILES = range(3)

# What a turn comes to.
DONE, UNDONE = 0, 1

STACK_CELLS = 1024
MEMORY_CELLS = 4096
FRAMES = 256
KEPT_CELLS = 32  # of the stack, to see whether a program comes back to where it was
KEPT_FRAMES = 8
PLACES = 8
BUFFER_BYTES = 1000

TASK_ROW = np.dtype(
    [
        ("present", np.int64),  # the task is here; what runs and is not here has its turns from Python
        ("running", np.int64),
        ("first", np.int64),  # of its instructions in `code`
        ("count", np.int64),  # of its instructions; 0: only its wait is here
        ("event", np.int64),  # the first of its conditions in `condition`
        ("events", np.int64),
        ("next", np.int64),
        ("base", np.int64),
        ("depth", np.int64),
        ("frames", np.int64),
        ("in_event", np.int64),
        ("wait", np.int64),
        ("until", np.int64),  # scan
        ("axes", np.int64),  # bit by index
        ("names", np.int64),  # number of the list of axes that WT has, -1 none
        ("left", np.int64),  # instructions that are left of an unfinished turn; -1: it has not begun
    ],
    align=True,
)

CODE_COLUMNS = 6  # operation, cells that it takes, kind of the result, three arguments


class Turns(NamedTuple):
    """Four tasks as the compiled scan has them."""

    task: npt.NDArray[np.void]  # [TASKS] of TASK_ROW
    budget: Whole  # [1] instructions in a turn
    due: Whole  # [1] the task that waits for Python in the middle of a scan's turns, TASKS if none does
    code: Whole  # [n, CODE_COLUMNS]
    number: Floats  # [n] constants and factors
    condition: Whole  # [m, 2] where the condition of an event begins, whether it is armed
    routine: Whole  # [r, 4] start, parameters, first of its cells in `cells`, count of these
    cells: npt.NDArray[np.int8]  # kinds of the cells that routines add
    stack: Floats  # [TASKS, STACK_CELLS]
    stack_kind: npt.NDArray[np.int8]
    memory: Floats  # [TASKS, MEMORY_CELLS]
    memory_kind: npt.NDArray[np.int8]
    frame: Whole  # [TASKS, FRAMES, 2] where to return to, base
    slot: Floats  # what programs read and a scan leaves alone
    buffer: npt.NDArray[np.uint8]  # [TASKS, BUFFER_BYTES] common buffers
    kept: Floats  # [KEPT_CELLS] scratch
    kept_frame: Whole  # [KEPT_FRAMES, 2] scratch
    place: Whole  # [PLACES] scratch: where that was


def make_turns() -> Turns:
    """Return room for the tasks, without programs."""
    return Turns(
        task=np.zeros(TASKS, TASK_ROW),
        budget=np.zeros(1, np.int64),
        due=np.full(1, TASKS),
        code=np.zeros((0, CODE_COLUMNS), np.int64),
        number=np.zeros(0),
        condition=np.zeros((0, 2), np.int64),
        routine=np.zeros((0, 4), np.int64),
        cells=np.zeros(0, np.int8),
        stack=np.zeros((TASKS, STACK_CELLS)),
        stack_kind=np.zeros((TASKS, STACK_CELLS), np.int8),
        memory=np.zeros((TASKS, MEMORY_CELLS)),
        memory_kind=np.zeros((TASKS, MEMORY_CELLS), np.int8),
        frame=np.zeros((TASKS, FRAMES, 2), np.int64),
        slot=np.zeros(1),
        buffer=np.zeros((TASKS, BUFFER_BYTES), np.uint8),
        kept=np.zeros(KEPT_CELLS),
        kept_frame=np.zeros((KEPT_FRAMES, 2), np.int64),
        place=np.zeros(PLACES, np.int64),
    )
