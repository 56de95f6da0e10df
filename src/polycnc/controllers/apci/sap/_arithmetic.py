"""Arithmetic of the language: 32-bit integers that wrap, doubles, Pascal's division and functions."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

from polycnc.controllers.apci.sap._commands import BOOLEAN, DOUBLE, INTEGER
from polycnc.controllers.apci.sap._faults import ARGUMENT, DIVISION_BY_ZERO, VALUE_RANGE, Fault

_HALF = 1 << 31
_MASK = (1 << 32) - 1


def wrap(value: int) -> int:
    """Return the low 32 bits of `value` as a signed number."""
    return value if -_HALF <= value < _HALF else ((value + _HALF) & _MASK) - _HALF


def _add(a: int, b: int) -> int:
    total = a + b
    return total if -_HALF <= total < _HALF else wrap(total)


def _subtract(a: int, b: int) -> int:
    difference = a - b
    return difference if -_HALF <= difference < _HALF else wrap(difference)


def _multiply(a: int, b: int) -> int:
    return wrap(a * b)


def _quotient(a: int, b: int) -> int:
    """Return a / b cut off towards zero."""
    if b == 0:
        raise Fault(DIVISION_BY_ZERO)
    whole = abs(a) // abs(b)
    return wrap(whole if (a < 0) == (b < 0) else -whole)


def _remainder(a: int, b: int) -> int:
    """Return a - (a DIV b) * b, which has the sign of a."""
    if b == 0:
        raise Fault(DIVISION_BY_ZERO)
    rest = abs(a) % abs(b)
    return -rest if a < 0 else rest


def _divide(a: float, b: float) -> float:
    if b == 0:
        raise Fault(DIVISION_BY_ZERO)
    return a / b


def _shift_left(a: int, b: int) -> int:
    return wrap(a << (b & 31))


def _shift_right(a: int, b: int) -> int:
    """Return `a` shifted right with zeros filled in from the left."""
    return wrap((a & _MASK) >> (b & 31))


def _whole(value: float) -> int:
    if not -_HALF <= value < _HALF:  # NaN too
        raise Fault(VALUE_RANGE)
    return int(value)


def _round(value: float) -> int:
    """Return the nearest integer, halves away from zero."""
    whole = math.trunc(value) if math.isfinite(value) else 0
    rest = value - whole
    return _whole(whole + (rest >= 0.5) - (rest <= -0.5) if math.isfinite(value) else value)


def _checked(function: Callable[[float], float]) -> Callable[[float], float]:
    def checked(value: float) -> float:
        try:
            return function(value)
        except ValueError:
            raise Fault(ARGUMENT) from None
        except OverflowError:
            raise Fault(VALUE_RANGE) from None

    return checked


# Instruction to what it computes from the two topmost values. The last letter is the operands' type.
BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "addi": _add,
    "subi": _subtract,
    "muli": _multiply,
    "divi": _quotient,
    "modi": _remainder,
    "andi": operator.and_,
    "ori": operator.or_,
    "xori": operator.xor,
    "shli": _shift_left,
    "shri": _shift_right,
    "addd": operator.add,
    "subd": operator.sub,
    "muld": operator.mul,
    "slashd": _divide,
    "lt": operator.lt,
    "le": operator.le,
    "gt": operator.gt,
    "ge": operator.ge,
    "eq": operator.eq,
    "ne": operator.ne,
}

# Instruction to what it computes from the topmost value.
UNARY: dict[str, Callable[[Any], Any]] = {
    "negi": lambda value: wrap(-value),
    "negd": operator.neg,
    "noti": operator.invert,
    "notb": operator.not_,
    "double": float,
    "absi": lambda value: wrap(abs(value)),
    "absd": abs,
    "sqri": lambda value: wrap(value * value),
    "sqrd": lambda value: value * value,
    "sqrt": _checked(math.sqrt),
    "sin": _checked(math.sin),
    "cos": _checked(math.cos),
    "tan": _checked(math.tan),
    "arctan": math.atan,
    "ln": _checked(math.log),
    "exp": _checked(math.exp),
    "trunc": _whole,
    "round": _round,
    "odd": lambda value: value % 2 != 0,
}

# Function of the language: type of its argument (None: integer and double alike) and of its result.
FUNCTIONS: dict[str, tuple[str | None, str | None]] = {
    **dict.fromkeys(("abs", "sqr"), (None, None)),
    **dict.fromkeys(("sqrt", "sin", "cos", "tan", "arctan", "ln", "exp"), (DOUBLE, DOUBLE)),
    **dict.fromkeys(("trunc", "round"), (DOUBLE, INTEGER)),
    "odd": (INTEGER, BOOLEAN),
}
