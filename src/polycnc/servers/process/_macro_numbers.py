"""Numbers of parameters and variables, and values of variables, as doors give them."""

from __future__ import annotations

from polycnc.cnc import ControlError, Refusal
from polycnc.errors import shown
from polycnc.units import is_number

LARGEST = 1e12
_MOST_DIGITS = 6


def variable_number(name: str) -> int:
    """Return the number of a variable from its name, with or without its `#`; -1 if it is none."""
    return number(name.removeprefix("#"))


def number(digits: str) -> int:
    """Return a number from its digits, -1 if they are none."""
    return int(digits) if digits.isascii() and digits.isdecimal() and len(digits) <= _MOST_DIGITS else -1


def variable_value(number: int, value: object) -> float | None:
    """Return what a variable is set to; None makes it vacant.

    Raises:
        ControlError: It is no number, or one from 1e12.
    """
    if value is None:
        return None
    if not is_number(value) or abs(value) >= LARGEST:
        raise ControlError(
            Refusal.DATA,
            f"variable #{number} cannot be {shown(value, 40)}",
            hint="Give a number below 1e12, or null.",
        )
    return float(value)
