"""The four tasks of an APCI board: programs in rw_SymPas are compiled and loaded, started and stopped."""

from __future__ import annotations

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.apci import Board, BoardTasks, sap
from polycnc.controllers.apci.sap import Task
from polycnc.servers.machines import TaskShown

NO_PROGRAM = "no program"
_FROM = {
    "start": ("idle", "running", "waiting", "stopped"),
    "stop": ("running", "waiting"),
    "continue": ("stopped",),
}


class ApciTasks:
    """The tasks; a board gets them with the first program."""

    def __init__(self, board: Board) -> None:
        self._board = board

    def all(self) -> list[TaskShown]:
        """Return them in their order."""
        tasks = self._tasks()
        if tasks is None:
            return [TaskShown(number, NO_PROGRAM, 0, "", 0, 0) for number in range(sap.TASKS)]
        return [
            TaskShown(
                each.number,
                _state(each),
                each.status().csrcline,
                each.error,
                each.status().errnum,
                each.status().errline,
            )
            for each in tasks.each
        ]

    def load(self, task: int, source: str) -> None:
        """Compile a program and give it to a task."""
        _check(task)
        program, errors = sap.check(source, f"task {task}", task)
        if program is None:
            first = errors[0]
            raise ControlError(
                Refusal.DATA, f"{len(errors)} errors: {first}"[:500], hint="Mend the first one."
            )
        (self._tasks() or BoardTasks(self._board)).load(program)

    def control(self, task: int, what: str) -> None:
        """Start, stop or continue a task."""
        _check(task)
        tasks = self._tasks()
        state = NO_PROGRAM if tasks is None else _state(tasks.each[task])
        if tasks is None or state not in _FROM[what]:
            raise ControlError(
                Refusal.IDLE, f"task {task} cannot {what}: {state}", hint="Load a program, or start it."
            )
        {"start": tasks.startcnct, "stop": tasks.stopcnct, "continue": tasks.contcnct}[what](task)

    def _tasks(self) -> BoardTasks | None:
        tasks = self._board.tasks
        return tasks if isinstance(tasks, BoardTasks) else None


def _check(task: int) -> None:
    if not 0 <= task < sap.TASKS:
        raise ControlError(
            Refusal.NOT_FOUND, f"there is no task {task}", hint=f"Tasks are 0 to {sap.TASKS - 1}."
        )


def _state(task: Task) -> str:
    """Return what a task does, in a word."""
    if task.program is None:
        return NO_PROGRAM
    return "waiting" if task.status().running & sap.WAITING else task.state.value
