"""Which numbers a board can be given, from the PC and by the programs of its tasks."""

from __future__ import annotations

import math

LARGEST = 1e100
"""Ruling: a number beyond it is treated like infinity."""


def is_number(value: float) -> bool:
    """Tell whether a board can be given this number."""
    return math.isfinite(value) and abs(value) <= LARGEST
