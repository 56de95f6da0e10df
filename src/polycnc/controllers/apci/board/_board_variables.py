"""Variables of the whole board, and what it asks of the SAP tasks that run in its time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from polycnc.controllers.apci.board._environment import InterfaceStatus
from polycnc.controllers.apci.core._state import Whole
from polycnc.controllers.apci.core._turn_state import BUFFER_BYTES, TASKS


class Tasks(Protocol):
    """What runs SAP programs within the board's time."""

    def turns(self) -> Whole:
        """Give the tasks their turns in this scan; return the call that gives them those of the scans that follow."""
        ...

    def halt(self) -> None:
        """Halt all tasks."""
        ...

    def save(self) -> list[dict[str, Any]]:
        """Return the state of all tasks, with their programs, as plain data."""
        ...

    def read_saved(self, data: Any) -> Callable[[], None]:
        """Read what `save` has returned; return what puts it back.

        Raises:
            KeyError, TypeError, ValueError: It is damaged.
        """
        ...


@dataclass
class Variables:
    """Variables of the whole board, by the manual's names in lower case."""

    pu: int = 0
    tu: int = 0
    trac: float = 1000.0
    trvl: float = 100.0
    trtvl: float = 0.0
    ledgn: int = 0
    ledrd: int = 0
    ledyl: int = 0
    irqpc: int = 0
    interface: InterfaceStatus = field(default_factory=InterfaceStatus)  # ifs
    buffers: list[bytearray] = field(default_factory=lambda: [bytearray(BUFFER_BYTES) for _ in range(TASKS)])
