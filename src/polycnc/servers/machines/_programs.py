"""The programs that a served machine keeps, as its doors list, read and change them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from polycnc.cnc import Control, ProgramEntry


class Programs(Protocol):
    """Programs by their names; refusals are the control's (`ControlError`)."""

    def directory(self) -> tuple[ProgramEntry, ...]:
        """Return the directory, by name."""

    def read(self, name: str) -> bytes:
        """Return the bytes of a program."""

    def put(self, name: str, content: bytes) -> bool:
        """Put a program in, in place of one of this name; return whether it is new."""

    def delete(self, name: str) -> None:
        """Delete a program."""


class MemoryPrograms:
    """The program memory of a control."""

    def __init__(self, control: Callable[[], Control]) -> None:
        self._control = control

    def directory(self) -> tuple[ProgramEntry, ...]:
        """Return the directory, by name."""
        return self._control().programs.directory()

    def read(self, name: str) -> bytes:
        """Return the bytes of a program."""
        return self._control().programs.read(name)

    def put(self, name: str, content: bytes) -> bool:
        """Put a program in, in place of one of this name; return whether it is new."""
        programs = self._control().programs
        is_new = name not in programs
        (programs.create if is_new else programs.write)(name, content)
        return is_new

    def delete(self, name: str) -> None:
        """Delete a program."""
        self._control().programs.delete(name)
