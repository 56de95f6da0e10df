"""Stand-alone programs on a simulated board with three axes."""

from __future__ import annotations

from typing import Any

from polycnc.controllers.apci import sap
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._system_axis import AxisSetup
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.sap._board_host import BoardTasks

TWO_AXES = """
[[axis]]
name = "A1"
[[axis]]
name = "A2"
[inputs]
3 = { functions = ["REF"], axes = ["A2"] }
"""
"""Two axes, with the reference switch of the second on input 3."""


class Sap:
    """A board with three axes whose task 0 runs programs; the first has a right software limit at 5."""

    def __init__(
        self, units: tuple[Any, Any, Any] = ("mm", "mm", "mm"), names: str = "A1 A2 A3", **each: Any
    ) -> None:
        first, *rest = names.split()
        limited = AxisSetup(name=first, sll=-5.0, slr=5.0, soft_right="SMD", unit=units[0], **each)
        others = (AxisSetup(name=name, unit=unit, **each) for name, unit in zip(rest, units[1:], strict=True))
        self.board = Board(SystemFile(axis=(limited, *others)))
        self.board_tasks = BoardTasks(self.board)
        self.tasks = self.board_tasks

    def run(self, text: str, scans: int = 2000) -> None:
        """Run a program to its end."""
        self.board_tasks.load(sap.compile_program(text))
        self.tasks.startcnct(0)
        self.board.advance(scans)
        assert self.tasks.each[0].error == ""
        assert self.tasks.rdcncts(0).running == 0

    def cd(self, index: int) -> float:
        """Return a common double."""
        return float(self.board.state.cd[index])

    def ci(self, index: int) -> int:
        """Return a common integer."""
        return int(self.board.state.ci[index])
