"""Statements of a program that are alarms where they are executed, and what to say of those that are not."""

from __future__ import annotations

from typing import NoReturn

from polycnc.nc.blocks._messages import NOT_EXECUTED, Messages
from polycnc.nc.macro._syntax import Refusal
from polycnc.nc.macro._variables import MacroError
from polycnc.nc.text._program import ProgramText


class Refusals:
    """Raise what a program refuses by its index, and remember what was not executed."""

    def __init__(self, text: ProgramText, found: list[Refusal]) -> None:
        self._text = text
        self._found = found
        self._left = set(range(len(found)))

    def refuse(self, index: int) -> NoReturn:
        """Refuse a statement.

        Raises:
            MacroError: Always.
        """
        self._left.discard(index)
        refusal = self._found[index]
        raise MacroError(refusal.what, refusal.hint, refusal.code)

    def remark(self, messages: Messages) -> None:
        """Add a message on each statement that has not been executed."""
        for refusal in (self._found[index] for index in sorted(self._left)):
            messages.note(f"{refusal.what}{NOT_EXECUTED}", self._text.position(refusal.at).line)
