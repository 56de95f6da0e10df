"""What only some machines have: the screen of programs that ask for keys, and tasks that run beside the axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class ScreenShown:
    """What a program has put on the screen, line by line, and the names of the keys besides those of characters."""

    lines: tuple[str, ...]
    softkeys: tuple[str, ...]
    keys: tuple[str, ...]


class Screen(Protocol):
    """The screen and keys of a control; channels count from 0."""

    def shown(self, channel: int) -> ScreenShown:
        """Return what is shown.

        Raises:
            ControlError: There is no such channel.
        """

    def picture(self, channel: int) -> str:
        """Return the same as a drawing, SVG.

        Raises:
            ControlError: There is no such channel.
        """

    def press(self, key: str, channel: int) -> None:
        """Press a key: one character, or a name.

        Raises:
            ControlError: There is no such key or channel.
        """


@dataclass(frozen=True, slots=True)
class TaskShown:
    """A task: what it does, the line that it is in, and the last error with its line; 0 where there is none."""

    task: int
    state: str
    line: int
    error: str
    error_number: int
    error_line: int


class Tasks(Protocol):
    """Tasks of a board that run programs by themselves."""

    def all(self) -> list[TaskShown]:
        """Return them in their order."""

    def load(self, task: int, source: str) -> None:
        """Stop a task and give it a program.

        Raises:
            ControlError: There is no such task, or the program has errors; the task runs on then.
        """

    def control(self, task: int, what: str) -> None:
        """`start` a task's program from its beginning, `stop` it or let it `continue`.

        Raises:
            ControlError: There is no such task.
        """
