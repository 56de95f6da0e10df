"""Functions and operators of RS274/NGC that are more than a Python operator. Angles are degrees."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

Function = Callable[..., float]
_PI = np.longdouble("3.14159265358979323846264338327950288")
_TINY = 1e-9


class NumberError(Exception):
    """A value that the language has no answer for: what is wrong, and what to do."""

    def __init__(self, what: str, hint: str = "") -> None:
        super().__init__(what)
        self.what, self.hint = what, hint


def divide(a: float, b: float) -> float:
    if b == 0.0:
        raise NumberError("division by zero")
    return a / b


def power(a: float, b: float) -> float:
    if a < 0.0 and b != math.floor(b):
        raise NumberError("a negative number to a power that is no whole number")
    if a == 0.0 and b < 0.0:
        raise NumberError("zero to a negative power")
    try:
        return float(a**b)
    except OverflowError:
        raise NumberError("the power is too large") from None


def modulo(a: float, b: float) -> float:
    """Return the rest of a division, from 0 up to the size of `b`."""
    if b == 0.0:
        raise NumberError("MOD by zero")
    rest = math.fmod(a, b)
    return rest + abs(b) if rest < 0.0 else rest


def _acos(x: float) -> float:
    if not -1.0 <= x <= 1.0:
        raise NumberError("ACOS of a number that is not between -1 and 1")
    return math.degrees(math.acos(x))


def _asin(x: float) -> float:
    if not -1.0 <= x <= 1.0:
        raise NumberError("ASIN of a number that is not between -1 and 1")
    return math.degrees(math.asin(x))


def _atan(a: float, b: float) -> float:
    return math.degrees(math.atan2(a, b))


def _exp(x: float) -> float:
    try:
        return math.exp(x)
    except OverflowError:
        raise NumberError("EXP is too large") from None


def _ln(x: float) -> float:
    if x <= 0.0:
        raise NumberError("LN of a number that is not above zero")
    return math.log(x)


def _sqrt(x: float) -> float:
    if x < 0.0:
        raise NumberError("SQRT of a negative number")
    return math.sqrt(x)


def _round(x: float) -> float:
    """Return the nearest whole number, the half away from zero."""
    return math.floor(x + 0.5) if x >= 0.0 else math.ceil(x - 0.5)


def _near_zero(found: float, function: Callable[[np.longdouble], np.longdouble], degrees: float) -> float:
    """Return what a function of an angle gives; what is all but 0 as LinuxCNC finds it, which FUP and FIX show."""
    if found == 0.0 or abs(found) > _TINY:
        return found
    return float(function(np.longdouble(degrees) * _PI / np.longdouble(180)))


FUNCTIONS: dict[str, Function] = {
    "divide": divide,
    "power": power,
    "modulo": modulo,
    "abs_": abs,
    "acos_": _acos,
    "asin_": _asin,
    "atan_": _atan,
    "cos_": lambda x: _near_zero(math.cos(math.radians(x)), np.cos, x),
    "exp_": _exp,
    "fix_": lambda x: float(math.floor(x)),
    "fup_": lambda x: float(math.ceil(x)),
    "ln_": _ln,
    "round_": lambda x: float(_round(x)),
    "sin_": lambda x: _near_zero(math.sin(math.radians(x)), np.sin, x),
    "sqrt_": _sqrt,
    "tan_": lambda x: _near_zero(math.tan(math.radians(x)), np.tan, x),
}
"""What the Python of a program calls."""
