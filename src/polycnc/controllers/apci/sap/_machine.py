"""What the instructions of the virtual machine work on, and how they end a turn."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from polycnc.controllers.apci.sap._task import Task

Step: TypeAlias = Callable[[], int]
"""Do one instruction and return the number of the next one."""

STACK_CELLS = 4096
CELL_BYTES = 8
FRAME_CELLS = 2  # of a call, for where to return to


class Pause(Exception):  # noqa: N818  # no error: how an instruction ends the turn of its task
    """The task has ended, stopped or begun to wait; its next instruction is in the task."""


Machine: TypeAlias = "Task"
Build: TypeAlias = Callable[["Task", Any, int], Step]
"""Make a step from the machine, the argument of an instruction and the number of the following one."""
