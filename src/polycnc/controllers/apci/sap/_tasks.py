"""The four CNC tasks of a board: loading, control from the PC and from programs, and their turns in a scan."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.controllers.apci.core._turn_state import TASKS
from polycnc.controllers.apci.sap._faults import TASK_NUMBER, Fault
from polycnc.controllers.apci.sap._host import Host
from polycnc.controllers.apci.sap._program import Program
from polycnc.controllers.apci.sap._task import STRING_BYTES, Task, TaskStatus

_UNKNOWN_ERROR = 1


class Tasks:
    """Four tasks of equal priority, by the manual's names (Manual 002, 3.2.1 and 4.4).

    Calls with a task number that does not exist do nothing, since their namesakes return nothing.
    """

    def __init__(self, host: Host) -> None:
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

    def halt(self) -> None:
        """Stop all programs, as a system reset does."""
        for task in self.each:
            task.end(stop=True)

    def rdcncts(self, task: int) -> TaskStatus:
        """Return the status of a task; zeros for one that does not exist."""
        return self.each[task].status() if 0 <= task < TASKS else TaskStatus(0, 0, 0, 0, 0)

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

    def _control(self, name: str, number: int) -> None:
        if not 0 <= number < TASKS:
            raise Fault(TASK_NUMBER)
        {"startcnct": self.startcnct, "stopcnct": self.stopcnct, "contcnct": self.contcnct}[name](number)
