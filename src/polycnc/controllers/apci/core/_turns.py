"""Turns of SAP tasks within the compiled scan, instruction by instruction as Python gives them.

What changes nothing but the task itself and the common variables is done here. In front of anything else a turn ends
`UNDONE`, with everything as it was before that instruction, and Python goes on with the instructions that are left.
"""

from __future__ import annotations

from polycnc.controllers.apci.core import _turn_state as ts
from polycnc.controllers.apci.core._state import BoardState
from polycnc.controllers.apci.core._turn_state import DONE, DOUBLE, UNDONE, Turns
from polycnc.controllers.apci.core._turn_steps import (
    REFUSED,
    WAITS,
    acted,
    differs,
    has_ended,
    jumped,
    value_of,
)
from polycnc.kernel import KernelState, compiled, detached

_CONDITION_MOST = 1000  # instructions of a condition; Python looks into longer ones
_HOLDS, _FAILS = 2, 3  # what a condition comes to

# Of `place`: where the program was when stack and frames were noted, and how many rounds there have been since.
_AT, _DEPTH, _BASE, _FRAMES, _LEFT, _CHANGES, _ROUNDS, _ROUNDS_MOST = range(ts.PLACES)


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
        if differs(t.kept[n], DOUBLE, t.stack[k, n], DOUBLE):
            return False
    for n in range(frames):
        if t.kept_frame[n, 0] != t.frame[k, n, 0] or t.kept_frame[n, 1] != t.frame[k, n, 1]:
            return False
    return True


@compiled
def _comes_back(
    t: Turns, k: int, at: int, depth: int, base: int, frames: int, changes: int, left: int
) -> bool:
    """Tell whether the program is back at the place that was noted, as it was; note places, more and more seldom."""
    place = t.place
    if (
        at == place[_AT]
        and changes == place[_CHANGES]
        and depth == place[_DEPTH]
        and base == place[_BASE]
        and frames == place[_FRAMES]
        and _is_as_kept(t, k, depth, frames)
    ):
        return True
    if depth <= ts.KEPT_CELLS and frames <= ts.KEPT_FRAMES:
        place[_ROUNDS] += 1
        if place[_ROUNDS] == place[_ROUNDS_MOST]:
            place[_ROUNDS], place[_ROUNDS_MOST] = 0, 2 * place[_ROUNDS_MOST]
            place[_AT], place[_LEFT], place[_CHANGES] = at, left, changes
            place[_DEPTH], place[_BASE], place[_FRAMES] = depth, base, frames
            _keep(t, k, depth, frames)
    return False


@compiled
def _fits(t: Turns, here: int, depth: int, floor: int) -> bool:
    """Tell whether an instruction is one for the scan, and the stack has the cells that it takes and makes."""
    return bool(t.code[here, 0] != ts.REFUSED and floor + t.code[here, 1] <= depth < ts.STACK_CELLS)


@compiled
def _instructions(
    b: BoardState, state: KernelState, t: Turns, k: int, cycle: int, begin: int, budget: int
) -> int:
    """Do instructions of task `k` from `begin` on: its turn, or, with a negative `budget`, a condition.

    A program that comes back to where it was in the same turn, and has changed nothing on the way, goes round
    until the turn ends: only the part of the last round is traversed.
    """
    task = t.task[k]
    asks = budget < 0
    left = _CONDITION_MOST if asks else budget
    first, count, at = task["first"], task["count"], begin
    depth, base, frames = task["depth"], task["base"], task["frames"]
    floor = depth if asks else 0
    t.place[_AT], t.place[_ROUNDS], t.place[_ROUNDS_MOST] = -1, 0, 1
    changes, goes_round = 0, False
    outcome = DONE
    while left > 0:
        outcome = UNDONE
        if not 0 <= at < count:
            break
        here = first + at
        operation, following = t.code[here, 0], at + 1
        if not _fits(t, here, depth, floor):
            break
        if operation <= ts.LAST_VALUE:
            value, kind, taken = value_of(b, state, t, k, here, depth, base)
            if kind < 0:
                break
            depth -= taken
            t.stack[k, depth], t.stack_kind[k, depth] = value, kind
            depth += 1
        elif operation <= ts.LAST_JUMP:
            following, depth = jumped(t, k, here, at, depth)
        elif asks:
            if operation != ts.END_CONDITION or depth != floor + 1:
                break
            return _HOLDS if t.stack[k, depth - 1] != 0.0 else _FAILS
        else:
            following, depth, base, frames, changed, result = acted(
                b, t, k, here, at, cycle, depth, base, frames
            )
            if result == REFUSED:
                break
            changes += changed
            if result == WAITS:
                at, outcome = following, DONE
                break
        left -= 1
        outcome = DONE
        if following <= at and not asks and not goes_round:
            goes_round = _comes_back(t, k, following, depth, base, frames, changes, left)
            if goes_round:
                left %= t.place[_LEFT] - left
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
                over = cycle >= task["until"] if task["wait"] == ts.TIME else has_ended(b, task["axes"])
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
