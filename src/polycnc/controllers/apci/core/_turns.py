"""Turns of SAP tasks within the compiled scan, instruction by instruction as Python gives them.

What changes nothing but the task itself and the common variables is done here. In front of anything else a turn ends
`UNDONE`, with everything as it was before that instruction, and Python goes on with the instructions that are left.
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core import _turn_state as ts
from polycnc.controllers.apci.core._state import BoardState
from polycnc.controllers.apci.core._turn_state import BOOLEAN, DONE, DOUBLE, INTEGER, UNDONE, Turns
from polycnc.controllers.apci.core._turn_values import from_buffer, of_one, of_two, register
from polycnc.kernel import KernelState, compiled, detached

WAIT_UNIT_S = 0.001
"""Ruling: `wt (t)` waits t ms, rounded up to whole scans; Part 1 of the manual does not say."""

LATE = 5e-7
"""Part of a scan that a wait may be too long for its number of scans: what comes of a sum of rounded times."""

_LONGEST_WAIT = 2.0**53
_COMMON = 1000
_CONDITION_MOST = 1000  # instructions of a condition; Python looks into longer ones
_HOLDS, _FAILS = 2, 3  # what a condition comes to


@compiled
def _differs(a: float, kind_a: int, b: float, kind_b: int) -> bool:
    """Tell whether two cells may differ, be it in the sign of a zero."""
    return a != b or kind_a != kind_b or math.copysign(1.0, a) != math.copysign(1.0, b)


@compiled
def _keep(t: Turns, k: int, depth: int, frames: int) -> None:
    """Note stack and frames of task `k`."""
    for n in range(depth):
        t.kept[n] = t.stack[k, n]
    for n in range(frames):
        t.kept_frame[n, 0] = t.frame[k, n, 0]
        t.kept_frame[n, 1] = t.frame[k, n, 1]


@compiled
def _is_as_kept(t: Turns, k: int, depth: int, frames: int) -> bool:
    """Tell whether stack and frames of task `k` are as they were noted."""
    for n in range(depth):
        if _differs(t.kept[n], DOUBLE, t.stack[k, n], DOUBLE):
            return False
    for n in range(frames):
        if t.kept_frame[n, 0] != t.frame[k, n, 0] or t.kept_frame[n, 1] != t.frame[k, n, 1]:
            return False
    return True


@compiled
def _has_ended(b: BoardState, axes: int) -> bool:
    waiting = 0
    for i in range(b.axis.shape[0]):
        waiting |= (axes >> i & 1) if b.axis[i]["pe"] == 0 else 0
    return waiting == 0


@compiled
def _instructions(
    b: BoardState, state: KernelState, t: Turns, k: int, cycle: int, begin: int, budget: int
) -> int:
    """Do instructions of task `k` from `begin` on: its turn, or, with a negative `budget`, a condition.

    A program that comes back to where it was in the same turn, and has changed nothing on the way, goes round
    until the turn ends: only the part of the last round is gone through.
    """
    task = t.task[k]
    asks = budget < 0
    left = _CONDITION_MOST if asks else budget
    first, count, at = task["first"], task["count"], begin
    depth, base, frames = task["depth"], task["base"], task["frames"]
    floor = depth if asks else 0
    kept_at, kept_depth, kept_base, kept_frames, kept_left, kept_changes = -1, 0, 0, 0, 0, 0
    rounds, rounds_most, changes, goes_round = 0, 1, 0, False
    outcome = DONE
    while left > 0:
        outcome = UNDONE
        if not 0 <= at < count:
            break
        here = first + at
        operation, kind = t.code[here, 0], t.code[here, 2]
        x, y, z = t.code[here, 3], t.code[here, 4], t.code[here, 5]
        if depth - t.code[here, 1] < floor or depth >= ts.STACK_CELLS:
            break
        following = at + 1
        value = 0.0
        pushes = False
        if operation == ts.CONSTANT:
            value, pushes = t.number[here], True
        elif operation == ts.DROP:
            depth -= 1
        elif operation == ts.LOAD:
            if x != 0:
                cell = base + y
                if not 0 <= cell < depth:
                    break
                value, kind = t.stack[k, cell], t.stack_kind[k, cell]
            else:
                value, kind = t.memory[k, y], t.memory_kind[k, y]
            pushes = True
        elif operation == ts.STORE or operation == ts.STORE_ELEMENT:
            if asks:
                break
            value, kind = t.stack[k, depth - 1], t.stack_kind[k, depth - 1]
            room = depth - 1
            cell = y
            if operation == ts.STORE_ELEMENT:
                room -= 1
                index = t.stack[k, room]
                if t.stack_kind[k, room] != INTEGER or not 0.0 <= index - z < t.number[here]:
                    break
                cell += int(index) - z
            if x != 0:
                cell += base
                if not 0 <= cell < room:
                    break
                if _differs(t.stack[k, cell], t.stack_kind[k, cell], value, kind):
                    changes += 1
                t.stack[k, cell], t.stack_kind[k, cell] = value, kind
            else:
                if _differs(t.memory[k, cell], t.memory_kind[k, cell], value, kind):
                    changes += 1
                t.memory[k, cell], t.memory_kind[k, cell] = value, kind
            depth = room
        elif operation == ts.LOAD_ELEMENT:
            index = t.stack[k, depth - 1]
            if t.stack_kind[k, depth - 1] != INTEGER or not 0.0 <= index - z < t.number[here]:
                break
            cell = y + int(index) - z
            if x != 0:
                cell += base
                if not 0 <= cell < depth:
                    break
                value, kind = t.stack[k, cell], t.stack_kind[k, cell]
            else:
                value, kind = t.memory[k, cell], t.memory_kind[k, cell]
            depth -= 1
            pushes = True
        elif operation == ts.OF_TWO:
            value, kind = of_two(
                x,
                t.stack[k, depth - 2],
                t.stack_kind[k, depth - 2],
                t.stack[k, depth - 1],
                t.stack_kind[k, depth - 1],
            )
            if kind < 0:
                break
            depth -= 2
            pushes = True
        elif operation == ts.OF_ONE:
            value, kind = of_one(x, t.stack[k, depth - 1], t.stack_kind[k, depth - 1])
            if kind < 0:
                break
            depth -= 1
            pushes = True
        elif operation == ts.JUMP:
            following = x
        elif operation == ts.JUMP_FALSE:
            depth -= 1
            if t.stack[k, depth] == 0.0:
                following = x
        elif operation == ts.DECIDE:  # AND, OR
            if t.stack_kind[k, depth - 1] == BOOLEAN and t.stack[k, depth - 1] == y:
                following = x
            else:
                depth -= 1
        elif operation == ts.WITHIN:
            if y <= t.stack[k, depth - 1] <= z:
                depth -= 1
                following = x
        elif operation == ts.CALL:
            start, parameters = t.routine[x, 0], t.routine[x, 1]
            cell, cells = t.routine[x, 2], t.routine[x, 3]
            if asks or frames >= ts.FRAMES or depth + cells >= ts.STACK_CELLS or depth < parameters:
                break
            t.frame[k, frames, 0], t.frame[k, frames, 1] = following, base
            frames += 1
            base = depth - parameters
            for n in range(cells):
                t.stack[k, depth], t.stack_kind[k, depth] = 0.0, t.cells[cell + n]
                depth += 1
            following = start
        elif operation == ts.RETURN:
            if asks or frames <= task["in_event"] or not 0 <= base <= depth or base + x >= depth:
                break
            if x >= 0:
                t.stack[k, base], t.stack_kind[k, base] = t.stack[k, base + x], t.stack_kind[k, base + x]
            depth = base + (1 if x >= 0 else 0)
            frames -= 1
            following, base = t.frame[k, frames, 0], t.frame[k, frames, 1]
        elif operation == ts.END_CONDITION:
            if not asks or depth != floor + 1:
                break
            return _HOLDS if t.stack[k, depth - 1] != 0.0 else _FAILS
        elif operation == ts.AXIS:
            value, pushes = register(b, state, x, y, t.number[here], t.slot[z]), True
        elif operation == ts.SLOT:
            if z > 0:  # a field
                index = t.stack[k, depth - 1]
                if t.stack_kind[k, depth - 1] != INTEGER or not 0.0 <= index < z:
                    break
                depth -= 1
                x += int(index)
            value, pushes = t.slot[x], True
        elif operation == ts.COMMON:
            if y < 0:
                index = t.stack[k, depth - 1]
                if t.stack_kind[k, depth - 1] != INTEGER or not 0.0 <= index < _COMMON:
                    break
                depth -= 1
                y = int(index)
            value, pushes = (float(b.ci[y]) if x == 0 else b.cd[y]), True
        elif operation == ts.SET_COMMON:
            value = t.stack[k, depth - 1]
            given, room = t.stack_kind[k, depth - 1], depth - 1
            if asks or given == BOOLEAN or (x == 0 and given != INTEGER):
                break
            if y < 0:
                room -= 1
                index = t.stack[k, room]
                if t.stack_kind[k, room] != INTEGER or not 0.0 <= index < _COMMON:
                    break
                y = int(index)
            if x == 0:
                if b.ci[y] != value:
                    changes += 1
                b.ci[y] = int(value)
            else:
                if _differs(b.cd[y], DOUBLE, value, DOUBLE):
                    changes += 1
                b.cd[y] = value
            depth = room
        elif operation == ts.BUFFER:
            index = t.stack[k, depth - 1]
            if t.stack_kind[k, depth - 1] != INTEGER or not 0.0 <= index <= ts.BUFFER_BYTES - y:
                break
            value, kind = from_buffer(t, k, x, int(index))
            if kind < 0:
                break
            depth -= 1
            pushes = True
        elif operation == ts.WAIT_TIME or operation == ts.WAIT_AXES:
            if asks:
                break
            waits, until = ts.PROFILES, 0
            if operation == ts.WAIT_TIME:
                scans = t.stack[k, depth - 1] * WAIT_UNIT_S / b.board[0]["dt"]
                if not scans < _LONGEST_WAIT:
                    break
                depth -= 1
                waits, until = ts.TIME, cycle + max(math.ceil(scans - LATE), 0)
                is_over = cycle >= until
            else:
                is_over = _has_ended(b, x)
            if not is_over:
                task["wait"], task["until"], task["axes"], task["names"] = waits, until, x, y
                at, outcome = following, DONE
                break
        else:
            break
        if pushes:
            t.stack[k, depth], t.stack_kind[k, depth] = value, kind
            depth += 1
        left -= 1
        outcome = DONE
        if following <= at and not asks and not goes_round:
            if (
                following == kept_at
                and changes == kept_changes
                and depth == kept_depth
                and base == kept_base
                and frames == kept_frames
                and _is_as_kept(t, k, depth, frames)
            ):
                left %= kept_left - left
                goes_round = True
            elif depth <= ts.KEPT_CELLS and frames <= ts.KEPT_FRAMES:
                rounds += 1
                if rounds == rounds_most:
                    rounds, rounds_most = 0, 2 * rounds_most
                    kept_at, kept_left, kept_changes = following, left, changes
                    kept_depth, kept_base, kept_frames = depth, base, frames
                    _keep(t, k, depth, frames)
        at = following
    if asks:
        return UNDONE
    task["next"], task["depth"], task["base"], task["frames"] = at, depth, base, frames
    task["left"] = left
    return outcome


@compiled
def _turn(b: BoardState, state: KernelState, t: Turns, k: int, cycle: int) -> int:
    """Give task `k` its turn in scan `cycle`: its events, what it waits for, its instructions."""
    task = t.task[k]
    events = 0 if task["in_event"] != 0 else task["events"]
    stage, budget = 0, -1
    # One place calls the instructions, for the conditions one after the other and then for the program: they are
    # a long function that becomes part of this one.
    while True:
        if stage < events:
            begin = t.condition[task["event"] + stage, 0]
        else:
            if task["wait"] != ts.NOTHING:
                over = cycle >= task["until"] if task["wait"] == ts.TIME else _has_ended(b, task["axes"])
                if not over:
                    return DONE
            if task["count"] == 0:
                return UNDONE
            task["wait"] = ts.NOTHING
            begin, budget = task["next"], t.budget[0]
        result = _instructions(b, state, t, k, cycle, begin, budget)
        if budget >= 0 or result == UNDONE:
            return result
        if (result == _HOLDS) == (t.condition[task["event"] + stage, 1] != 0):
            return UNDONE  # to be raised, or armed again
        stage += 1


@compiled
def turns_cycle(b: BoardState, state: KernelState, t: Turns, begin: int, cycle: int) -> int:
    """Give the tasks from `begin` on their turns in a scan; return `UNDONE` at the first that needs Python."""
    for k in range(begin, t.task.shape[0]):
        task = t.task[k]
        if task["running"] == 0:
            continue
        task["left"] = -1
        if task["present"] == 0 or _turn(b, state, t, k, cycle) == UNDONE:
            t.due[0] = k
            return UNDONE
    return DONE


TURNS = detached(turns_cycle)
"""The turns, for boards whose tasks have programs: the scan of all others does without, and is compiled sooner."""
