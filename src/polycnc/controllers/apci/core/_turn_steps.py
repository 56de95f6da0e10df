"""What single instructions of SAP programs do in the compiled scan: values, jumps, stores, routines, waits.

Nothing has changed where a step says that it cannot be done here: a kind or a depth of -1.
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core import _turn_state as ts
from polycnc.controllers.apci.core._state import BoardState
from polycnc.controllers.apci.core._turn_state import BOOLEAN, DOUBLE, INTEGER, Turns
from polycnc.controllers.apci.core._turn_values import from_buffer, of_one, of_two, register
from polycnc.kernel import KernelState, compiled

WAIT_UNIT_S = 0.001
"""Ruling: `wt (t)` waits t ms, rounded up to whole scans; Part 1 of the manual does not say."""

LATE = 5e-7
"""Part of a scan that a wait may be too long for its number of scans: what comes of a sum of rounded times."""

REFUSED, OVER, WAITS = range(3)  # what becomes of an instruction: Python has to, done, it waits

_LONGEST_WAIT = 2.0**53
_COMMON = 1000.0


@compiled
def differs(a: float, kind_a: int, b: float, kind_b: int) -> bool:
    """Tell whether two cells may differ, be it in the sign of a zero."""
    return a != b or kind_a != kind_b or math.copysign(1.0, a) != math.copysign(1.0, b)


@compiled
def _index(t: Turns, k: int, cell: int, first: int, count: float) -> int:
    """Return the index that stands in a cell of the stack, from `first` on, or -1 if it is none of `count`."""
    index = t.stack[k, cell]
    if t.stack_kind[k, cell] != INTEGER or not 0.0 <= index - first < count:
        return -1
    return int(index) - first


@compiled
def _loaded(t: Turns, k: int, local: int, cell: int, base: int, depth: int) -> tuple[float, int, int]:
    """Return what a variable holds, its kind, and that it takes nothing off the stack."""
    if local == 0:
        return t.memory[k, cell], int(t.memory_kind[k, cell]), 0
    cell += base
    if not 0 <= cell < depth:
        return 0.0, -1, 0
    return t.stack[k, cell], int(t.stack_kind[k, cell]), 0


@compiled
def _of_program(t: Turns, k: int, here: int, depth: int, base: int) -> tuple[float, int, int]:
    """Return the value of an instruction that reads the program's own cells."""
    operation, x, y = t.code[here, 0], t.code[here, 3], t.code[here, 4]
    top = depth - 1
    if operation == ts.CONSTANT:
        return t.number[here], t.code[here, 2], 0
    if operation == ts.LOAD:
        return _loaded(t, k, x, y, base, depth)
    if operation == ts.LOAD_ELEMENT:
        index = _index(t, k, top, t.code[here, 5], t.number[here])
        if index < 0:
            return 0.0, -1, 0
        value, kind, _ = _loaded(t, k, x, y + index, base, depth)
        return value, kind, 1
    if operation == ts.OF_ONE:
        value, kind = of_one(x, t.stack[k, top], t.stack_kind[k, top])
        return value, kind, 1
    value, kind = of_two(
        x, t.stack[k, top - 1], t.stack_kind[k, top - 1], t.stack[k, top], t.stack_kind[k, top]
    )
    return value, kind, 2


@compiled
def _of_board(
    b: BoardState, state: KernelState, t: Turns, k: int, here: int, depth: int
) -> tuple[float, int, int]:
    """Return the value of an instruction that reads registers, common variables or buffers."""
    operation, kind = t.code[here, 0], t.code[here, 2]
    x, y, z = t.code[here, 3], t.code[here, 4], t.code[here, 5]
    if operation == ts.AXIS:
        return register(b, state, x, y, t.number[here], t.slot[z]), kind, 0
    taken, index = 0, 0
    if operation == ts.SLOT:
        if z > 0:  # a field
            taken, index = 1, _index(t, k, depth - 1, 0, float(z))
        return (t.slot[x + index], kind, taken) if index >= 0 else (0.0, -1, 0)
    if operation == ts.BUFFER:
        index = _index(t, k, depth - 1, 0, float(ts.BUFFER_BYTES - y + 1))
        if index < 0:
            return 0.0, -1, 0
        value, kind = from_buffer(t, k, x, index)
        return value, kind, 1
    if y < 0:
        taken, y = 1, _index(t, k, depth - 1, 0, _COMMON)
    if y < 0:
        return 0.0, -1, 0
    return (float(b.ci[y]) if x == 0 else b.cd[y]), kind, taken


@compiled
def value_of(
    b: BoardState, state: KernelState, t: Turns, k: int, here: int, depth: int, base: int
) -> tuple[float, int, int]:
    """Return what an instruction puts on the stack, its kind, -1 if Python has to, and how many cells it takes."""
    if t.code[here, 0] <= ts.OF_TWO:
        return _of_program(t, k, here, depth, base)
    return _of_board(b, state, t, k, here, depth)


@compiled
def jumped(t: Turns, k: int, here: int, at: int, depth: int) -> tuple[int, int]:
    """Return where the program goes on after a jump that may take its condition off the stack, and the depth."""
    operation, x, y = t.code[here, 0], t.code[here, 3], t.code[here, 4]
    top = depth - 1
    if operation == ts.DROP:
        return at + 1, top
    if operation == ts.JUMP:
        return x, depth
    if operation == ts.JUMP_FALSE:
        return (x if t.stack[k, top] == 0.0 else at + 1), top
    if operation == ts.DECIDE:  # AND, OR
        decided = t.stack_kind[k, top] == BOOLEAN and t.stack[k, top] == y
        return (x, depth) if decided else (at + 1, top)
    within = y <= t.stack[k, top] <= t.code[here, 5]
    return (x, top) if within else (at + 1, depth)


@compiled
def _set_common(b: BoardState, t: Turns, k: int, here: int, depth: int) -> tuple[int, int]:
    """Store into a common variable."""
    x, y, room = t.code[here, 3], t.code[here, 4], depth - 1
    value, given = t.stack[k, room], t.stack_kind[k, room]
    if given == BOOLEAN or (x == 0 and given != INTEGER):
        return -1, 0
    if y < 0:
        room -= 1
        y = _index(t, k, room, 0, _COMMON)
    if y < 0:
        return -1, 0
    if x == 0:
        changed = b.ci[y] != value
        b.ci[y] = int(value)
    else:
        changed = differs(b.cd[y], DOUBLE, value, DOUBLE)
        b.cd[y] = value
    return room, int(changed)


@compiled
def _stored(b: BoardState, t: Turns, k: int, here: int, depth: int, base: int) -> tuple[int, int]:
    """Store the top of the stack; return the depth, -1 if Python has to, and whether anything has changed."""
    operation, cell, room = t.code[here, 0], t.code[here, 4], depth - 1
    if operation == ts.SET_COMMON:
        return _set_common(b, t, k, here, depth)
    value, kind = t.stack[k, room], t.stack_kind[k, room]
    if operation == ts.STORE_ELEMENT:
        room -= 1
        index = _index(t, k, room, t.code[here, 5], t.number[here])
        if index < 0:
            return -1, 0
        cell += index
    if t.code[here, 3] == 0:
        changed = differs(t.memory[k, cell], t.memory_kind[k, cell], value, kind)
        t.memory[k, cell], t.memory_kind[k, cell] = value, kind
        return room, int(changed)
    cell += base
    if not 0 <= cell < room:
        return -1, 0
    changed = differs(t.stack[k, cell], t.stack_kind[k, cell], value, kind)
    t.stack[k, cell], t.stack_kind[k, cell] = value, kind
    return room, int(changed)


@compiled
def _called(
    t: Turns, k: int, routine: int, at: int, depth: int, base: int, frames: int
) -> tuple[int, int, int, int]:
    """Call a routine; return where it begins, depth, base and frames, -1 if Python has to."""
    start, parameters = t.routine[routine, 0], t.routine[routine, 1]
    cell, cells = t.routine[routine, 2], t.routine[routine, 3]
    if frames >= ts.FRAMES or depth + cells >= ts.STACK_CELLS or depth < parameters:
        return at, depth, base, -1
    t.frame[k, frames, 0], t.frame[k, frames, 1] = at + 1, base
    base = depth - parameters
    for n in range(cells):
        t.stack[k, depth], t.stack_kind[k, depth] = 0.0, t.cells[cell + n]
        depth += 1
    return start, depth, base, frames + 1


@compiled
def _returned(
    t: Turns, k: int, result: int, at: int, depth: int, base: int, frames: int
) -> tuple[int, int, int, int]:
    """Leave a routine, with the cell of its result or -1; return where it was called, depth, base and frames."""
    if frames <= t.task[k]["in_event"] or not 0 <= base <= depth or base + result >= depth:
        return at, depth, base, -1
    if result >= 0:
        t.stack[k, base], t.stack_kind[k, base] = t.stack[k, base + result], t.stack_kind[k, base + result]
    depth = base + (1 if result >= 0 else 0)
    frames -= 1
    return t.frame[k, frames, 0], depth, t.frame[k, frames, 1], frames


@compiled
def has_ended(b: BoardState, axes: int) -> bool:
    """Tell whether the profiles of all of `axes`, bit by index, have ended."""
    waiting = 0
    for i in range(b.axis.shape[0]):
        waiting |= (axes >> i & 1) if b.axis[i]["pe"] == 0 else 0
    return waiting == 0


@compiled
def _waited(b: BoardState, t: Turns, k: int, here: int, cycle: int, depth: int) -> int:
    """Begin to wait for a time, whose cell stays on the stack, or for axes; return what becomes of it."""
    task, axes = t.task[k], t.code[here, 3]
    waits, until = ts.PROFILES, 0
    if t.code[here, 0] == ts.WAIT_TIME:
        scans = t.stack[k, depth - 1] * WAIT_UNIT_S / b.board[0]["dt"]
        if not scans < _LONGEST_WAIT:
            return REFUSED
        waits, until = ts.TIME, cycle + max(math.ceil(scans - LATE), 0)
        if cycle >= until:
            return OVER
    elif has_ended(b, axes):
        return OVER
    task["wait"], task["until"], task["axes"], task["names"] = waits, until, axes, t.code[here, 4]
    return WAITS


@compiled
def acted(
    b: BoardState, t: Turns, k: int, here: int, at: int, cycle: int, depth: int, base: int, frames: int
) -> tuple[int, int, int, int, int, int]:
    """Store, call, return or wait; return place, depth, base, frames, whether anything changed, what became of it."""
    operation, x = t.code[here, 0], t.code[here, 3]
    if operation == ts.END_CONDITION:
        return at, depth, base, frames, 0, REFUSED
    if operation <= ts.LAST_STORE:
        room, changed = _stored(b, t, k, here, depth, base)
        if room < 0:
            return at, depth, base, frames, 0, REFUSED
        return at + 1, room, base, frames, changed, OVER
    if operation >= ts.WAIT_TIME:
        result = _waited(b, t, k, here, cycle, depth)
        if result != REFUSED and operation == ts.WAIT_TIME:
            depth -= 1
        return at + 1, depth, base, frames, 0, result
    if operation == ts.CALL:
        following, cells, place, nested = _called(t, k, x, at, depth, base, frames)
    else:
        following, cells, place, nested = _returned(t, k, x, at, depth, base, frames)
    if nested < 0:
        return at, depth, base, frames, 0, REFUSED
    return following, cells, place, nested, 0, OVER
