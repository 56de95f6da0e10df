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


def mm_from_inch(inch: float) -> float:
    """Convert inch to mm."""
    return inch * MM_PER_INCH


def inch_from_mm(mm: float) -> float:
    """Convert mm to inch."""
    return mm / MM_PER_INCH


def per_s_from_per_min(per_min: float) -> float:
    """Convert a rate per minute (mm/min, rev/min) to a rate per second."""
    return per_min / SECONDS_PER_MINUTE


def per_min_from_per_s(per_s: float) -> float:
    """Convert a rate per second to a rate per minute."""
    return per_s * SECONDS_PER_MINUTE


def whole(digits: str | bytes) -> int:
    """Return a whole number from its digits; with more of them than Python reads it is one beyond all that count."""
    return int(digits) if len(digits) <= _MOST_DIGITS else _BEYOND


def is_finite(value: float) -> bool:
    """Tell whether a number is finite as a float; a whole number of any length is none beyond the largest."""
    return abs(value) <= sys.float_info.max


def is_number(value: object) -> TypeGuard[float]:
    """Tell whether a value is a finite number (true and false are none)."""
    return isinstance(value, int | float) and not isinstance(value, bool) and is_finite(value)
