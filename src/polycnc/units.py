"""Convert between the units of the outside and the kernel's mm, degree and second.

Inside polycnc a length is mm, an angle degree, a time second. Conversions happen once, where a value enters
or leaves; the names here say which way.
"""

import sys
from typing import TypeGuard

MM_PER_INCH = 25.4
MM_PER_M = 1000.0
SECONDS_PER_MINUTE = 60.0

_MOST_DIGITS = 300
_BEYOND = 10**_MOST_DIGITS


def whole(digits: str | bytes) -> int:
    """Return a whole number from its digits; with more of them than Python reads it is one beyond all that count."""
    return int(digits) if len(digits) <= _MOST_DIGITS else _BEYOND


def is_finite(value: float) -> bool:
    """Tell whether a number is finite as a float; a whole number of any length is none beyond the largest."""
    return abs(value) <= sys.float_info.max


def is_number(value: object) -> TypeGuard[float]:
    """Tell whether a value is a finite number (true and false are none)."""
    return isinstance(value, int | float) and not isinstance(value, bool) and is_finite(value)
