"""The functions and operators of custom macros, in degrees and with the control's rounding."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from polycnc.nc.macro._variables import MacroError, checked

_LARGEST_WHOLE = 2**31 - 1
_EXACT = {0.0: 0.0, 30.0: 0.5, 90.0: 1.0, 150.0: 0.5, 180.0: 0.0, 210.0: -0.5, 270.0: -1.0, 330.0: -0.5}
_ROUND = 1e-9  # results of FIX and FUP are not thrown off by the last bits of a calculation
_CODE = "PS0119"


def sin(angle: float) -> float:
    """Return the sine of an angle in degrees, exact where it is a whole or a half."""
    turned = math.fmod(angle, 360.0)
    if turned < 0.0:
        turned += 360.0
    exact = _EXACT.get(turned)
    return math.sin(math.radians(turned)) if exact is None else exact


def cos(angle: float) -> float:
    """Return the cosine of an angle in degrees, exact where it is a whole or a half."""
    return sin(math.fmod(angle, 360.0) + 90.0)


def tan(angle: float) -> float:
    """Return the tangent of an angle in degrees."""
    below = cos(angle)
    if below == 0.0:
        raise MacroError(f"TAN[{angle:g}] is infinite", "Take another angle.", _CODE)
    if math.fmod(angle, 45.0) == 0.0:
        return round(sin(angle) / below)
    return math.tan(math.radians(math.fmod(angle, 360.0)))


def asin(value: float, nat: bool = False) -> float:
    """Return the arc sine in degrees: 270 to 90, with `nat` -90 to 90."""
    angle = math.degrees(math.asin(_sine(value, "ASIN")))
    return angle if nat or angle >= 0.0 else angle + 360.0


def acos(value: float) -> float:
    """Return the arc cosine in degrees, 180 to 0."""
    return math.degrees(math.acos(_sine(value, "ACOS")))


def atan(value: float) -> float:
    """Return the arc tangent in degrees, -90 to 90."""
    return math.degrees(math.atan(value))


def atan2(value: float, below: float, nat: bool = False) -> float:
    """Return the angle of `ATAN[value]/[below]` in degrees: 0 to 360, with `nat` -180 to 180."""
    if value == 0.0 and below == 0.0:
        raise MacroError("ATAN[0]/[0] is no angle", "Check both values.", _CODE)
    angle = math.degrees(math.atan2(value, below))
    return angle if nat or angle >= 0.0 else angle + 360.0


def sqrt(value: float) -> float:
    """Return the square root."""
    if value < 0.0:
        raise MacroError(f"SQRT[{value:g}]: a negative number has no root", "Check the value.", _CODE)
    return math.sqrt(value)


def rounded(value: float) -> float:
    """Return the nearest whole number, halves away from 0."""
    return math.copysign(math.floor(abs(value) + 0.5), value) if value else 0.0


def fix(value: float) -> float:
    """Return the whole number nearer to 0."""
    near = rounded(value)
    return near if abs(value - near) < _ROUND else float(math.trunc(value))


def fup(value: float) -> float:
    """Return the whole number further from 0."""
    near = rounded(value)
    return near if abs(value - near) < _ROUND else math.copysign(math.ceil(abs(value)), value)


def ln(value: float) -> float:
    """Return the natural logarithm."""
    if value <= 0.0:
        raise MacroError(f"LN[{value:g}]: only numbers above 0 have a logarithm", "Check the value.", _CODE)
    return math.log(value)


def exp(value: float) -> float:
    """Return e to the power of a value."""
    return checked(math.exp(value) if value < 700.0 else math.inf)


def power(base: float, exponent: float) -> float:
    """Return a value to the power of another one."""
    try:
        return checked(math.pow(base, exponent))
    except (ValueError, OverflowError):
        raise MacroError(f"POW[{base:g},{exponent:g}] cannot be calculated", "Check both.", _CODE) from None


def from_bcd(value: float) -> float:
    """Return the number whose decimal digits are the hexadecimal ones of a value (BIN)."""
    digits = f"{whole(value):X}"
    if not digits.isdecimal():
        raise MacroError(f"BIN[{value:g}]: the value is not binary coded decimal", "Check the value.", _CODE)
    return float(digits)


def to_bcd(value: float) -> float:
    """Return the number whose hexadecimal digits are the decimal ones of a value (BCD)."""
    number = whole(value)
    if not 0 <= number <= 99_999_999:
        raise MacroError(f"BCD[{value:g}]: only 0 to 99999999 can be coded", "Check the value.", _CODE)
    return float(int(str(number), 16))


def whole(value: float) -> int:
    """Return a value as a whole number of 32 bits.

    Raises:
        MacroError: It has more.
    """
    if not -_LARGEST_WHOLE <= value <= _LARGEST_WHOLE:
        raise MacroError(f"{value:g} has more than 32 bits", "Check the value.", _CODE)
    return int(rounded(value))


def both(left: float, right: float) -> float:
    """Return the bits that two values have in common (AND)."""
    return float(whole(left) & whole(right))


def either(left: float, right: float) -> float:
    """Return the bits that one or both values have (OR)."""
    return float(whole(left) | whole(right))


def differing(left: float, right: float) -> float:
    """Return the bits that just one of two values has (XOR)."""
    return float(whole(left) ^ whole(right))


def remainder(left: float, right: float) -> float:
    """Return the remainder of two whole numbers, with the sign of the first (MOD)."""
    below = rounded(right)
    if below == 0.0:
        raise MacroError("MOD 0: a division by zero", "Check the value after MOD.", "PS0112")
    return math.fmod(rounded(left), below)


FUNCTIONS: Mapping[str, Callable[[float], float]] = {
    "SIN": sin,
    "COS": cos,
    "TAN": tan,
    "ASIN": asin,
    "ACOS": acos,
    "ATAN": atan,
    "SQRT": sqrt,
    "SQR": sqrt,
    "ABS": abs,
    "BIN": from_bcd,
    "BCD": to_bcd,
    "ROUND": rounded,
    "RND": rounded,
    "FIX": fix,
    "FUP": fup,
    "LN": ln,
    "EXP": exp,
}
"""Functions of one value by name."""

OPERATORS: Mapping[str, Callable[[float, float], float]] = {
    "AND": both,
    "OR": either,
    "XOR": differing,
    "MOD": remainder,
}
"""Operators that Python has none for, by name."""


def _sine(value: float, name: str) -> float:
    if abs(value) > 1.0:
        if abs(value) - 1.0 < _ROUND:
            return math.copysign(1.0, value)
        raise MacroError(f"{name}[{value:g}]: the value is beyond -1 to 1", "Check the value.", _CODE)
    return value
