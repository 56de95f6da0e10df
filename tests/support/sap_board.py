"""A board for SAP tasks that only remembers what it was told, and counts scans."""

from __future__ import annotations

from collections.abc import Mapping

from polycnc.controllers.apci.sap import BUFFER_BYTES, TASKS, Call, Tasks, compile_program
from polycnc.errors import UsageError

SCAN_S = 0.00128


class FakeBoard:
    """Axes A1 to A3 and X, Y, Z, C; a move ends `move_scans` scans after it was given."""

    def __init__(self) -> None:
        self.scan = 0
        self.scan_s = SCAN_S
        self.axes = {"A1": 0, "A2": 1, "A3": 2, "X": 0, "Y": 1, "Z": 2, "C": 3}
        self.system: dict[tuple[str, int | None], float] = {}
        self.qualifiers: dict[tuple[int, str, int | None], float] = {}
        self.calls: list[Call] = []
        self.move_scans = 10
        self.ends: dict[int, int] = {}
        self.buffers = [bytearray(BUFFER_BYTES) for _ in range(TASKS)]
        self.tasks = Tasks(self)

    def axis_index(self, name: str) -> int | None:
        return self.axes.get(name.upper())

    def call(self, call: Call) -> None:
        self.calls.append(call)
        if call.name == "azo":
            raise UsageError("no zero offsets here")
        if call.name == "rs":
            self.tasks.halt()
        for axis in call.axes:
            self.ends[axis] = self.scan + self.move_scans

    def profile_ended(self, axes: tuple[int, ...]) -> bool:
        return all(self.scan >= self.ends.get(axis, 0) for axis in axes)

    def read_system(self, name: str, index: int | None) -> float:
        return self.system.get((name, index), 0)

    def write_system(self, name: str, index: int | None, value: float) -> None:
        self.system[name, index] = value

    def read_axis(self, axis: int, name: str, index: int | None) -> float:
        return self.qualifiers.get((axis, name, index), 0)

    def write_axis(self, axis: int, name: str, index: int | None, value: float) -> None:
        self.qualifiers[axis, name, index] = value

    def common_buffer(self, task: int) -> bytearray:
        return self.buffers[task]

    def advance(self, scans: int = 1) -> None:
        """Run the tasks for some scans."""
        for _ in range(scans):
            self.scan += 1
            self.run_scan()

    def run_scan(self, budget: int = 100) -> None:
        """Give every task its turn in this scan."""
        for task in self.tasks.each:
            task.run(budget)

    def start(self, text: str, task: int = 0) -> None:
        """Compile a program, load it and start it."""
        self.tasks.load(compile_program(text, "test.sap", task))
        self.tasks.startcnct(task)

    def ci(self, index: int) -> int:
        """Return a common integer."""
        return int(self.system.get(("ci", index), 0))


def run_text(
    text: str, scans: int = 100, system: Mapping[tuple[str, int | None], float] | None = None
) -> FakeBoard:
    """Run a program on a fresh board and return the board."""
    board = FakeBoard()
    board.system.update(system or {})
    board.start(text)
    board.advance(scans)
    return board
