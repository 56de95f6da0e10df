"""What a SAP task needs from the board that it runs on, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Call:
    """One motion or input/output command, with everything that the manual's call of the same name gets.

    `axes` are axis indices in the order of the program, `values` belong to them one by one (targets,
    distances or centres; empty where the command takes none). `numbers` are the remaining arguments in the
    order of the command table; a table of points is a tuple in its place. `path` is (TRAC, TRVL, TRTVL) for
    interpolated moves, else None.
    """

    name: str
    axes: tuple[int, ...] = ()
    values: tuple[float, ...] = ()
    numbers: tuple[float | tuple[float, ...], ...] = ()
    path: tuple[float, float, float] | None = None


class Host(Protocol):
    """A board, as its tasks see it; names are the manual's, spelled as in the tables of `_commands`.

    A method may raise `PolycncError` to refuse (an index that the board does not have, say); that stops the
    task with run-time error 7.
    """

    @property
    def scan(self) -> int:
        """Return the number of the present scan."""

    @property
    def scan_s(self) -> float:
        """Return the scan time in s."""

    def axis_index(self, name: str) -> int | None:
        """Return the index of the axis called `name` (in either case), None if there is none."""

    def call(self, call: Call) -> None:
        """Give a command."""

    def profile_ended(self, axes: tuple[int, ...]) -> bool:
        """Return whether all of `axes` have reached the end of their profiles, just given ones included."""

    def read_system(self, name: str, index: int | None) -> float:
        """Return a system variable; `index` is None unless it is a field of variables."""

    def write_system(self, name: str, index: int | None, value: float) -> None:
        """Set a system variable."""

    def read_axis(self, axis: int, name: str, index: int | None) -> float:
        """Return an axis qualifier; `index` is None unless it is a field of variables."""

    def write_axis(self, axis: int, name: str, index: int | None, value: float) -> None:
        """Set an axis qualifier."""

    def common_buffer(self, task: int) -> bytearray:
        """Return the common buffer of a task, 1000 bytes, always the same object."""
