"""What calls answer with: codes with number and text, and how the inside of a library refuses a call."""

from __future__ import annotations

from enum import IntEnum
from typing import Self


class Code(IntEnum):
    """Base of a library's codes: a member is its number and has a `text`."""

    text: str

    def __new__(cls, number: int, text: str = "") -> Self:
        """Make the code with this number."""
        code = int.__new__(cls, number)
        code._value_ = number
        code.text = text
        return code


class Refused(Exception):  # noqa: N818  no error of the program
    """A call that is answered with a code and changes nothing; it never leaves the library."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


# fmt: off
__all__ = [
    "Code", "Refused",
]
# fmt: on
