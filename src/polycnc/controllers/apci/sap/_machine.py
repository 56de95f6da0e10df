"""What the instructions of the virtual machine work on, and how they end a turn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

from polycnc.controllers.apci.sap._host import Host
from polycnc.controllers.apci.sap._program import Program

Step: TypeAlias = Callable[[], int]
"""Do one instruction and return the number of the next one."""

STACK_CELLS = 4096
CELL_BYTES = 8
FRAME_CELLS = 2  # of a call, for where to return to


class Pause(Exception):  # noqa: N818  # no error: how an instruction ends the turn of its task
    """The task has ended, stopped or begun to wait; its next instruction is in the task."""


class Machine(Protocol):
    """What instructions work on; see `Task`."""

    program: Program | None
    number: int
    stack: list[Any]
    memory: list[Any]
    frames: list[tuple[int, int]]
    base: int
    next: int

    @property
    def host(self) -> Host: ...
    def end(self, stop: bool) -> None: ...
    def leave_event(self) -> None: ...
    def wait(self, time_ms: float, axes: tuple[int, ...]) -> bool: ...
    def control(self, name: str, number: int) -> None: ...
    def write(self, text: str) -> None: ...
    def write_line(self) -> None: ...
    def is_halted(self) -> bool: ...


Build: TypeAlias = Callable[[Machine, Any, int], Step]
"""Make a step from the machine, the argument of an instruction and the number of the following one."""
