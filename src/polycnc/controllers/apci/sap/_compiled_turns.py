"""Tasks of a board that have their turns in the compiled scan: bring programs there, and back for what they do.

A task is in one place at a time: at home, in its Python object, or in the compiled scan (`core._turns`). It goes there
when it is to have a turn, and is reclaimed when it needs Python or somebody asks for its state.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from polycnc.controllers.apci.core import _turn_state as ts
from polycnc.controllers.apci.core._scan import NO_TURNS, first_turns
from polycnc.controllers.apci.core._state import BoardState, Whole
from polycnc.controllers.apci.core._turn_state import TASKS, Turns, make_turns
from polycnc.controllers.apci.core._turns import TURNS
from polycnc.controllers.apci.sap._program import Program
from polycnc.controllers.apci.sap._task import State, Task, Wait
from polycnc.controllers.apci.sap._translation import (
    KIND_OF,
    BoardHost,
    Slot,
    Translation,
    mask_of,
    translate,
)
from polycnc.jit import Ready
from polycnc.kernel import KernelState

_TYPES = (int, float, bool)  # by kind
_WORTH_SCANS = 4  # that a task stays away for
_PATIENCE_MOST = 64  # scans between two attempts that are of no use


class _Away:
    """The state of one task in the compiled scan."""

    def __init__(self, turns: CompiledTurns, task: Task) -> None:
        self._all = turns
        self._task = task

    def where(self) -> tuple[int, int, int, bool]:
        """Return the next instruction, cells on the stack, frames, and whether the task waits."""
        row = self._all.turns.task[self._task.number]
        return int(row["next"]), int(row["depth"]), int(row["frames"]), bool(row["wait"] != ts.NOTHING)

    def reclaim(self) -> None:
        """Put the state back into the task."""
        self._all.reclaim(self._task)


class CompiledTurns:
    """Give the tasks of a board their turns: from Python, or by letting the compiled scan do it."""

    def __init__(
        self, tasks: Sequence[Task], host: BoardHost, states: tuple[BoardState, KernelState], budget: int
    ) -> None:
        self.turns: Turns = make_turns()
        self._tasks = tasks
        self._host = host
        self._states = states
        self._call: Ready
        self._budget = budget
        self._programs: list[Program | None] = [None] * TASKS  # that `turns` holds
        self._translations = [Translation() for _ in range(TASKS)]
        self._slots: list[Slot] = []
        self._waits: list[list[tuple[int, ...]]] = [[] for _ in range(TASKS)]
        self._since = [0] * TASKS  # scan in which a task went away
        self._next = [0] * TASKS  # scan before which it does not go away again
        self._patience = [1] * TASKS
        self._in_turn = [False] * TASKS

    def give(self) -> Whole:
        """Give the tasks their turns in this scan; return the call that gives them those of the scans that follow."""
        due, begin = int(self.turns.due[0]), 0
        while True:
            self.turns.due[0] = TASKS
            if due < TASKS:
                self._give(due, int(self.turns.task[due]["left"]))
                begin = due + 1
            if not any(task.state is State.RUNNING for task in self._tasks):
                return NO_TURNS
            self._take_over()
            while begin < TASKS and not self._goes_away(begin):
                self._give(begin, -1)
                begin += 1
            for number in range(TASKS):
                self._goes_away(number)
            self._refresh()
            if begin == TASKS or not first_turns(self._call.numbers, begin, self._host.scan):
                return self._call.numbers
            due = int(self.turns.due[0])

    def _give(self, number: int, left: int) -> None:
        """Give a task the `left` instructions of its turn from Python, -1 for all of it."""
        task = self._tasks[number]
        if self._in_turn[number]:  # what an instruction has called lets time pass
            return
        self._in_turn[number] = True
        try:
            task.run(self._budget if left < 0 else left, rest=left >= 0)
        finally:
            self._in_turn[number] = False

    def _goes_away(self, number: int) -> bool:
        """Tell whether a task has its turn in the compiled scan, and see to it."""
        task = self._tasks[number]
        row = self.turns.task[number]
        runs = task.state is State.RUNNING and not self._in_turn[number]
        row["running"] = runs
        if not runs:
            return False
        if task.away is None and self._is_worth_it(number):
            self._send(number)
        row["present"] = task.away is not None
        return task.away is not None

    def _is_worth_it(self, number: int) -> bool:
        scan, wait = self._host.scan, self._tasks[number].waiting
        if wait is not None and (wait.until is None or wait.until >= scan + _WORTH_SCANS):
            return True
        return scan >= self._next[number]

    # Away and back

    def _send(self, number: int) -> None:
        task, turns = self._tasks[number], self.turns
        fits = (
            len(task.memory) <= ts.MEMORY_CELLS
            and len(task.stack) < ts.STACK_CELLS // 2
            and len(task.frames) < ts.FRAMES // 2
        )
        events = 0 if task.in_event else len(task.armed)
        if not fits and (task.waiting is None or events):
            self._fail(number)
            return
        row = turns.task[number]
        try:
            if fits:
                _put(turns.memory[number], turns.memory_kind[number], task.memory)
                _put(turns.stack[number], turns.stack_kind[number], task.stack)
                turns.frame[number, : len(task.frames)] = np.array(task.frames, np.int64).reshape(-1, 2)
        except (KeyError, ArithmeticError, TypeError, ValueError):  # of a forged program
            self._fail(number)
            return
        row["count"] = len(self._translations[number].rows) if fits else 0
        row["next"], row["base"] = task.next, task.base
        row["depth"], row["frames"] = len(task.stack), len(task.frames)
        row["in_event"] = task.in_event
        row["events"] = events
        turns.condition[row["event"] : row["event"] + events, 1] = task.armed[:events]
        self._put_wait(number, task.waiting)
        self._since[number] = self._host.scan
        task.away = _Away(self, task)

    def _fail(self, number: int) -> None:
        """Note that it was of no use to send a task away."""
        self._patience[number] = min(2 * self._patience[number], _PATIENCE_MOST)
        self._next[number] = self._host.scan + self._patience[number]

    def _put_wait(self, number: int, wait: Wait | None) -> None:
        row = self.turns.task[number]
        if wait is None:
            row["wait"] = ts.NOTHING
        elif wait.until is not None:
            row["wait"], row["until"] = ts.TIME, wait.until
        else:
            known = self._waits[number]
            if wait.axes not in known:
                known.append(wait.axes)
            row["wait"], row["axes"], row["names"] = (ts.PROFILES, mask_of(wait.axes), known.index(wait.axes))

    def reclaim(self, task: Task) -> None:
        """Put the state of a task back into it."""
        number, turns = task.number, self.turns
        row = turns.task[number]
        row["present"] = 0
        if row["count"]:
            depth, frames = int(row["depth"]), int(row["frames"])
            task.stack[:] = _get(turns.stack[number], turns.stack_kind[number], depth)
            task.memory[:] = _get(turns.memory[number], turns.memory_kind[number], len(task.memory))
            task.frames[:] = [(back, base) for back, base in turns.frame[number, :frames].tolist()]
            task.next, task.base = int(row["next"]), int(row["base"])
            task.waiting = self._wait(number)
        if self._host.scan - self._since[number] >= _WORTH_SCANS:
            self._patience[number] = 1
            self._next[number] = 0
        else:
            self._fail(number)

    def _wait(self, number: int) -> Wait | None:
        row = self.turns.task[number]
        if row["wait"] == ts.NOTHING:
            return None
        if row["wait"] == ts.TIME:
            return Wait(int(row["until"]), ())
        return Wait(None, self._waits[number][row["names"]])

    # Programs

    def _take_over(self) -> None:
        """Have the programs that run among those of the compiled scan."""
        new = [
            task
            for task in self._tasks
            if task.state is State.RUNNING and task.program is not self._programs[task.number]
        ]
        if not new:
            return
        for task in self._tasks:
            task.reclaim_state()
        for task in new:
            assert task.program is not None
            translation = translate(task.program, self._host)
            self._programs[task.number] = task.program
            self._translations[task.number] = translation
            self._waits[task.number] = translation.waits
            self._patience[task.number], self._next[task.number] = 1, 0
        self._join()

    def _join(self) -> None:
        """Put all programs one after another."""
        rows: list[tuple[Any, ...]] = []
        routines: list[tuple[int, ...]] = []
        cells: list[int] = []
        conditions: list[tuple[int, int]] = []
        slots = 1
        self._slots = []
        for row, one in zip(self.turns.task, self._translations, strict=True):
            row["first"], row["event"] = len(rows), len(conditions)
            offsets = {ts.CALL: len(routines), ts.SLOT: slots - 1}
            for operation, takes, kind, x, y, z, number in one.rows:
                if operation == ts.AXIS and z > 0:
                    z += slots - 1
                rows.append((operation, takes, kind, x + offsets.get(operation, 0), y, z, number))
            routines += [
                (start, count, first + len(cells), many) for start, count, first, many in one.routines
            ]
            cells += one.cells
            conditions += [(each, 0) for each in one.conditions]
            self._slots += [Slot(each.first + slots - 1, each.count, each.read) for each in one.slots]
            slots += one.slot_count - 1
        self.turns = self.turns._replace(
            budget=np.array([self._budget]),
            code=np.array([row[:-1] for row in rows], np.int64).reshape(-1, ts.CODE_COLUMNS),
            number=np.array([row[-1] for row in rows]),
            routine=np.array(routines, np.int64).reshape(-1, 4),
            cells=np.array(cells, np.int8),
            condition=np.array(conditions, np.int64).reshape(-1, 2),
            slot=np.zeros(slots),
        )
        self._call = TURNS.ready(*self._states, self.turns, numbers=2)

    def _refresh(self) -> None:
        """Note what only Python changes and programs read."""
        for each in self._slots:
            self.turns.slot[each.first : each.first + each.count] = each.read()
        for number, one in enumerate(self._translations):
            if one.reads_buffer:
                self.turns.buffer[number] = np.frombuffer(self._host.common_buffer(number), np.uint8)


def _put(values: Any, kinds: Any, cells: Sequence[Any]) -> None:
    """Write cells as numbers and kinds.

    Raises:
        KeyError, ArithmeticError, ValueError: A cell holds what no compiled program puts there.
    """
    if not cells:
        return
    count = len(cells)
    kinds[:count] = [KIND_OF[type(cell)] for cell in cells]
    values[:count] = cells
    whole = values[:count][kinds[:count] == ts.INTEGER]
    if whole.size and not (whole.min() >= -(2.0**31) and whole.max() < 2.0**31):
        raise ValueError("no integer of 32 bits")


def _get(values: Any, kinds: Any, count: int) -> list[Any]:
    """Return numbers and kinds as cells."""
    return [
        _TYPES[kind](value)
        for value, kind in zip(values[:count].tolist(), kinds[:count].tolist(), strict=True)
    ]
