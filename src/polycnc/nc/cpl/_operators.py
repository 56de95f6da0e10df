"""Constants and operators of CPL turned into Python, with the type of what they give.

`double` tells that the whole expression is computed with double precision.
"""

from __future__ import annotations

from collections.abc import Container
from typing import NamedTuple

from polycnc.language import Flaw, Python, Unary, infix, prefix
from polycnc.nc.cpl._faults import INVALID_ASSIGNMENT
from polycnc.nc.cpl._reader import single
from polycnc.nc.cpl._syntax import Leaf, Number
from polycnc.nc.cpl._variables import KIND_NAMES, Kind

NUMERIC: Container[Kind] = ("I", "R", "D", "X")
COMPARISONS = {"=": "==", "<>": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}
LOGIC = {"AND": "&", "OR": "|", "XOR": "^"}


class Typed(NamedTuple):
    """A Python expression with its type.

    `exact` tells that it needs no rounding to its type any more, `leaf` that it may be NUL: it was stored so.
    """

    python: Python
    kind: Kind
    exact: bool = True
    leaf: bool = False


def rounded(typed: Typed, double: bool) -> Python:
    """Return a value as its type has it, rounded to single precision if need be."""
    return (
        typed.python if typed.exact or double or typed.kind == "D" else Python(f"single({typed.python.text})")
    )


def number(tree: Number, double: bool) -> Typed:
    """Return a constant.

    Raises:
        Flaw: It is too large for its type.
    """
    if isinstance(tree.value, int):
        return Typed(Python(repr(tree.value)), "I")
    if double:
        return Typed(Python(repr(tree.value)), "D")
    try:
        return Typed(Python(repr(single(tree.value))), "R")
    except OverflowError:
        raise Flaw(
            tree.at, "the number is too large for REAL", "assign it to a DOUBLE variable: X!"
        ) from None


def unary(tree: Unary[Leaf], operand: Typed, double: bool) -> Typed:
    """Return an operand with the sign or NOT before it.

    Raises:
        Flaw: It has the wrong type.
    """
    if tree.operator == "NOT":
        if operand.kind == "B":
            return Typed(infix(operand.python, "^", Python("True")), "B")
        if operand.kind == "I":
            return Typed(prefix("~", operand.python), "I")
        raise Flaw(tree.at, f"NOT takes BOOLEAN or INTEGER, not {KIND_NAMES[operand.kind]}")
    if operand.kind not in NUMERIC:
        raise Flaw(tree.at, f"a sign belongs before a number, not before {KIND_NAMES[operand.kind]}")
    return Typed(prefix(tree.operator, rounded(operand, double)), operand.kind)


def is_flat(typed: Typed, double: bool) -> bool:
    """Tell whether Python computes on with a value without a further parenthesis around it."""
    return typed.kind != "B" and (typed.exact or double)


def compared(left: Typed, operator: str, right: Typed, at: int, double: bool) -> Typed:
    """Return a comparison.

    Raises:
        Flaw: The values are not compared with each other.
    """
    if "N" in (left.kind, right.kind):
        if operator not in ("=", "<>"):
            raise Flaw(at, "NUL is only compared by = and <>")
        value = right if left.kind == "N" else left
        names = value.leaf and value.python.text[0] not in "'\""
        tests = ("is", "is not") if names else ("==", "!=")  # Python warns of a constant with `is`
        test = tests[operator != "="]
        return Typed(Python(f"{value.python.within(5)} {test} None", 4), "B")
    numbers = left.kind in NUMERIC and right.kind in NUMERIC
    if not numbers and left.kind != right.kind and "X" not in (left.kind, right.kind):
        raise Flaw(at, f"{KIND_NAMES[left.kind]} is not compared with {KIND_NAMES[right.kind]}")
    if left.kind == "B" and operator not in ("=", "<>"):
        raise Flaw(at, f"TRUE and FALSE are only compared by = and <>, not by {operator}")
    python = infix(rounded(left, double), COMPARISONS[operator], rounded(right, double))
    return Typed(python, "B")


def computed(left: Typed, operator: str, right: Typed, at: int, double: bool) -> Typed:
    """Return what an operator makes of two numbers.

    Raises:
        Flaw: They are none.
    """
    if left.kind not in NUMERIC or right.kind not in NUMERIC:
        wrong = left if left.kind not in NUMERIC else right
        raise Flaw(at, f"{operator} does not take {KIND_NAMES[wrong.kind]}")
    whole = operator != "/" and left.kind == right.kind == "I"
    kind: Kind = "I" if whole else "D" if double else "R"
    return Typed(infix(rounded(left, double), operator, rounded(right, double)), kind, exact=whole)


def logical(left: Typed, operator: str, right: Typed, at: int) -> Typed:
    """Return what AND, OR or XOR makes of two values.

    Raises:
        Flaw: They are not both BOOLEAN, or both INTEGER.
    """
    if left.kind != right.kind or left.kind not in ("B", "I"):
        kinds = f"{KIND_NAMES[left.kind]} and {KIND_NAMES[right.kind]}"
        raise Flaw(
            at, f"{operator} takes two BOOLEAN or two INTEGER values, not {kinds}", INVALID_ASSIGNMENT.what
        )
    return Typed(infix(left.python, LOGIC[operator], right.python), left.kind)
