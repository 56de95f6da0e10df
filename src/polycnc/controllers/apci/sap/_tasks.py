"""The four CNC tasks of a board: loading, control from the PC and from programs, and their turns in a scan."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.controllers.apci.sap._faults import TASK_NUMBER, Fault
from polycnc.controllers.apci.sap._host import BUFFER_BYTES, Host
from polycnc.controllers.apci.sap._program import TASKS, Program
from polycnc.controllers.apci.sap._task import STRING_BYTES, Task, TaskStatus

BUDGET = 100
"""Ruling: instructions that every task runs per scan, in the order of their numbers."""

NO_SUCH_TASK, TOO_MANY_BYTES, BAD_MEMORY = 0x1, 0x2, 0x4
"""What rdcbcnct and wrcbcnct return, bit by bit."""

_UNKNOWN_ERROR = 1


class Tasks:
    """Four tasks of equal priority, by the manual's names (Manual 002, 3.2.1 and 4.4).

    Calls with a task number that does not exist do nothing, since their namesakes return nothing.
    """

    def __init__(self, host: Host) -> None:
        self._host = host
        self.each = tuple(Task(number, host, self._control) for number in range(TASKS))

    def load(self, program: Program) -> None:
        """Halt the program's task and overwrite what it had to run."""
        self.each[program.task].load(program)

    def startcnct(self, task: int) -> None:
        """Start the program of a task from its beginning; a running one is stopped first."""
        if 0 <= task < TASKS:
            self.each[task].start()

    def stopcnct(self, task: int) -> None:
        """Stop the program of a task; its event handlers are not processed any more."""
        if 0 <= task < TASKS:
            self.each[task].end(stop=True)

    def contcnct(self, task: int) -> None:
        """Continue a stopped program; one that has ended, by ABORT too, stays ended."""
        if 0 <= task < TASKS:
            self.each[task].resume()

    def stepcnct(self, task: int) -> None:
        """Do nothing: the manual declares single steps as not implemented (Manual 002, 4.4.125)."""

    def halt_all(self) -> None:
        """Stop all programs, as a system reset does."""
        for task in self.each:
            task.end(stop=True)

    def rdcncts(self, task: int) -> TaskStatus:
        """Return the status of a task; zeros for one that does not exist."""
        return self.each[task].status() if 0 <= task < TASKS else TaskStatus(0, 0, 0, 0, 0)

    def error_text(self, task: int) -> str:
        """Return what the run-time error of a task says, for people; empty without one."""
        return self.each[task].error

    def gettskinfo(self, task: int) -> tuple[int, int]:
        """Return status (0: good) and tskinfo: bit 0 an incomplete, bit 1 a complete string is to be read."""
        return (0, self.each[task].text_bits) if 0 <= task < TASKS else (_UNKNOWN_ERROR, 0)

    def gettskstr(self, task: int, size: int = STRING_BYTES) -> str:
        """Return the string of a task, at most `size` and at most 512 characters, and clear the tskinfo bits."""
        return self.each[task].take_text(size) if 0 <= task < TASKS else ""

    # State

    def save(self) -> list[dict[str, Any]]:
        """Return the state of all tasks, with their programs, as plain data."""
        return [task.save() for task in self.each]

    def read_saved(self, data: Any) -> Callable[[], None]:
        """Read what `save` has returned; return what puts it back.

        Raises:
            KeyError, TypeError, ValueError: It is damaged.
        """
        changes = [task.read_saved(each) for task, each in zip(self.each, data, strict=True)]

        def put() -> None:
            for change in changes:
                change()

        return put

    # Common buffers

    def rdcbcnct(self, task: int, size: int, memory: bytearray) -> int:
        """Copy the first `size` bytes of a task's common buffer into `memory`; return 0 or error bits."""
        error = _buffer_error(task, size, memory)
        if not error:
            memory[:size] = self._host.common_buffer(task)[:size]
        return error

    def wrcbcnct(self, task: int, size: int, memory: bytes | bytearray) -> int:
        """Copy `size` bytes of `memory` to the beginning of a task's common buffer; return 0 or error bits."""
        error = _buffer_error(task, size, memory)
        if not error:
            self._host.common_buffer(task)[:size] = memory[:size]
        return error

    # Turns

    def run_scan(self, budget: int = BUDGET) -> None:
        """Give every task its turn; to be called once per scan, with the host's `scan` already counted up."""
        for task in self.each:
            task.run(budget)

    def _control(self, name: str, number: int) -> None:
        if not 0 <= number < TASKS:
            raise Fault(TASK_NUMBER)
        {"startcnct": self.startcnct, "stopcnct": self.stopcnct, "contcnct": self.contcnct}[name](number)


def _buffer_error(task: int, size: int, memory: bytes | bytearray) -> int:
    error = 0 if 0 <= task < TASKS else NO_SUCH_TASK
    if not 0 <= size <= BUFFER_BYTES:
        return error | TOO_MANY_BYTES
    return error | (BAD_MEMORY if len(memory) < size else 0)
