"""Numbers of CPL: functions of degrees, conversions between types, BCD (Manual 003, 2.5.1 and 2.5.3)."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable

from polycnc.nc.cpl._faults import INVALID_ASSIGNMENT, INVALID_PARAMETER, INVALID_VARIABLE, Fault
from polycnc.nc.cpl._function import Function, Takes, function

LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1
_ULPS = 4.0 * 2.220446049250313e-16
_SINES = {0.0: 0.0, 30.0: 0.5, 90.0: 1.0, 150.0: 0.5, 180.0: 0.0, 210.0: -0.5, 270.0: -1.0, 330.0: -0.5}

_NOT_ASSIGNED = "assign a value before; X=NUL tells whether there is one"


def not_assigned() -> Fault:
    """Return what is wrong where a value is needed and a variable is NUL."""
    return Fault(
        INVALID_VARIABLE._replace(what="INVALID VARIABLE: a variable without a value (NUL)"), _NOT_ASSIGNED
    )


def single_rounder() -> Callable[[float], float]:
    """Return a function that rounds to single precision, exactly as a store into 32 bits does.

    It raises OverflowError for what is too large.
    """
    cell = array("f", (0.0,))

    def rounded(value: float) -> float:
        cell[0] = value
        value = cell[0]
        if value - value:
            raise OverflowError
        return value

    return rounded


_single = single_rounder()


def to_real(value: object) -> float | None:
    """Return a value as REAL; NUL stays NUL.

    Raises:
        Fault: It is no number, or too large.
    """
    number = to_double(value)
    if number is None:
        return None
    return _single(number)


def to_double(value: object) -> float | None:
    """Return a value as DOUBLE; NUL stays NUL.

    Raises:
        Fault: It is no number, or too large.
    """
    if value is None:
        return None
    if value.__class__ is float or value.__class__ is int:
        number = float(value)
        if number - number:  # not finite
            raise OverflowError
        return number
    raise Fault(INVALID_ASSIGNMENT, f"a number is needed, not {_shown(value)}")


def to_integer(value: object) -> int | None:
    """Return a value as INTEGER; NUL stays NUL.

    Raises:
        Fault: It is no INTEGER.
    """
    if value is None:
        return None
    if value.__class__ is not int:
        raise Fault(
            INVALID_ASSIGNMENT, f"an INTEGER is needed, not {_shown(value)}; convert it with INT or ROUND"
        )
    if not LOWEST <= value <= HIGHEST:
        raise OverflowError
    return value


def to_boolean(value: object) -> bool | None:
    """Return a value as BOOLEAN; NUL stays NUL.

    Raises:
        Fault: It is none.
    """
    if value is None or value.__class__ is bool:
        return value
    raise Fault(INVALID_ASSIGNMENT, f"TRUE or FALSE is needed, not {_shown(value)}")


def _shown(value: object) -> str:
    return "a text" if value.__class__ is str else "TRUE or FALSE" if value.__class__ is bool else f"{value}"


@function("SIN(angle)", "R", Takes.NUMBER)
def sine(degrees: float) -> float:
    """Return the sine of an angle in degrees, exact where it is a simple number."""
    degrees = math.fmod(degrees, 360.0)
    exact = _SINES.get(degrees if degrees >= 0.0 else degrees + 360.0)
    return math.sin(math.radians(degrees)) if exact is None else exact


@function("COS(angle)", "R", Takes.NUMBER)
def cosine(degrees: float) -> float:
    """Return the cosine of an angle in degrees, exact where it is a simple number."""
    degrees = abs(math.fmod(degrees, 360.0))
    exact = _SINES.get(math.fmod(degrees + 90.0, 360.0)) if degrees % 30.0 == 0.0 else None
    return math.cos(math.radians(degrees)) if exact is None else exact


@function("TAN(angle)", "R", Takes.NUMBER)
def tangent(degrees: float) -> float:
    """Return the tangent of an angle in degrees.

    Raises:
        Fault: It has none.
    """
    divisor = cosine(degrees)
    if not divisor:
        raise Fault(INVALID_PARAMETER, "the tangent of this angle is infinite")
    if degrees % 90.0 == 45.0:
        return 1.0 if degrees % 180.0 == 45.0 else -1.0
    return math.tan(math.radians(math.fmod(degrees, 180.0)))


def _in_degrees(function: Callable[[float], float], value: float) -> float:
    degrees = math.degrees(function(value))
    nice = round(degrees, 9)
    return nice if abs(nice - degrees) <= _ULPS * abs(degrees) else degrees


@function("ASIN(value)", "R", Takes.NUMBER)
def arc_sine(value: float) -> float:
    """Return the angle of a sine, in degrees.

    Raises:
        ValueError: There is none.
    """
    return _in_degrees(math.asin, value)


@function("ACOS(value)", "R", Takes.NUMBER)
def arc_cosine(value: float) -> float:
    """Return the angle of a cosine, in degrees.

    Raises:
        ValueError: There is none.
    """
    return _in_degrees(math.acos, value)


@function("ATAN(value)", "R", Takes.NUMBER)
def arc_tangent(value: float) -> float:
    """Return the angle of a tangent, in degrees."""
    return _in_degrees(math.atan, value)


@function("SQRT(value)", "R", Takes.NUMBER)
def root(value: float) -> float:
    """Return the square root of a number.

    Raises:
        Fault: It is negative.
    """
    if value < 0:
        raise Fault(INVALID_PARAMETER, "SQRT takes no negative number")
    return float(value**0.5)


ABSOLUTE = Function(
    "ABS(value)", "X", "Return a number without its sign.", abs, (Takes.NUMBER,), keeps_type=True
)


@function("INT(value)", "I", Takes.NUMBER)
def whole(value: float) -> int:
    """Return a number without its decimals."""
    return _bounded(math.trunc(value))


@function("ROUND(value)", "I", Takes.NUMBER)
def nearest(value: float) -> int:
    """Return a number rounded to the nearest whole one, halves away from zero."""
    below = math.floor(abs(value))
    number = below + (abs(value) - below >= 0.5)
    return _bounded(number if value >= 0 else -number)


def _bounded(value: int) -> int:
    if not LOWEST <= value <= HIGHEST:
        raise OverflowError
    return value


@function("BCD(binary value)", "I", Takes.NUMBER)
def to_bcd(value: int) -> int:
    """Return a number with each decimal digit in four bits.

    Raises:
        Fault: It is negative, or has more than eight digits.
    """
    value = _natural(value)
    if value > 79_999_999:
        raise Fault(INVALID_PARAMETER, "BCD takes numbers from 0 to 79999999: eight digits in 32 bits")
    return int(str(value), 16)


@function("BIN(BCD value)", "I", Takes.NUMBER)
def from_bcd(value: int) -> int:
    """Return the number that decimal digits of four bits each stand for.

    Raises:
        Fault: It is negative, or a digit is above 9.
    """
    digits = f"{_natural(value):x}"
    if not digits.isdigit():
        raise Fault(INVALID_PARAMETER, "BIN takes digits from 0 to 9 in groups of four bits")
    return int(digits)


def _natural(value: object) -> int:
    number = to_integer(value)
    if number is None:
        raise not_assigned()
    if number < 0:
        raise Fault(INVALID_PARAMETER, "negative numbers have no BCD form")
    return number
