"""Expressions of custom macros as Python.

Local variables are the list `L`, common ones the list `C`, both indexed by number. A vacant variable is None:
`(x or 0.0)` is its value in a calculation, and Python's == and != compare as the control's EQ and NE do.
"""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.language import Chain, Flaw, Python, Unary, infix, prefix
from polycnc.nc.macro._operand_reader import COMPARISONS
from polycnc.nc.macro._syntax import Expression, Function, Name, Number, Refusal, Variable
from polycnc.nc.macro._system import SystemVariables
from polycnc.nc.macro._variables import MacroVariables

_ARITHMETIC = "+-*/"
_SMALL = 1e6  # adding so little at a time never gets a variable out of range


@dataclass(frozen=True, slots=True)
class Value:
    python: Python
    vacant: bool = False
    truth: bool = False

    def number(self) -> Python:
        return Python(f"({self.python.text} or 0.0)") if self.vacant else self.python


class Expressions:
    """Write expressions of a control's `variables` and those of its `system`.

    Lines that one needs before its own are in `before`; `drain` is the line that waits for the blocks before.
    """

    def __init__(self, variables: MacroVariables, system: SystemVariables) -> None:
        self.before: list[str] = []
        self.drain = ""
        self.in_address = False
        self.variables = variables
        self.system = system
        self._temporaries = 0

    def forget(self) -> None:
        """Leave a statement that is refused half written."""
        self.before.clear()
        self.in_address = False

    def value(self, tree: Expression) -> Python:
        value = self.expression(tree)
        if value.truth:
            raise no_value(getattr(tree, "at", 0))
        return value.number()

    def condition(self, tree: Expression) -> Python:
        value = self.expression(tree)
        if not value.truth:
            raise Flaw(
                getattr(tree, "at", 0),
                "this is no condition",
                "Compare two values with EQ, NE, GT, GE, LT or LE.",
                code="PS0114",
            )
        return value.python

    def expression(self, tree: Expression) -> Value:
        match tree:
            case Number():
                return Value(Python(repr(tree.value)))
            case Variable():
                return self.variable(tree)
            case Function():
                return self.function(tree)
            case Name():
                return Value(Python(f"H.named({tree.text!r})"))
            case Unary():
                operand = self.expression(tree.operand)
                if operand.truth:
                    raise no_value(tree.at)
                if operand.vacant and self.in_address:
                    if tree.operator == "+":
                        return operand
                    return Value(Python(f"negative({operand.python.text})"), vacant=True)
                return Value(prefix(tree.operator, operand.number()))
            case Chain():
                return self.chain(tree)

    def variable(self, tree: Variable) -> Value:
        number = tree.number
        if tree.index is not None:
            return Value(Python(f"get({self.index(tree.index)})"), vacant=True)
        match self.variables.kind(number):
            case "null":
                return Value(Python("None"), vacant=True)
            case "local":
                return Value(Python(f"L[{number}]"), vacant=True)
            case None:
                if not self.system.has(number):
                    raise no_variable_at(tree.at, number)
                if self.system.waits(number) and self.drain not in self.before:
                    self.before.append(self.drain)
                return Value(Python(f"get({number})"), vacant=True)
            case _:
                return Value(Python(f"C[{number}]"), vacant=True)

    def index(self, tree: Expression) -> str:
        """Emit the number of a variable that is calculated; return the Python name that holds it."""
        value = self.value(tree)
        self._temporaries += 1
        name = f"i{self._temporaries}"
        self.before.append(f"{name} = number({value.text})")
        self.before.append(f"if {name} > 999 and waits({name}): {self.drain}")
        return name

    def function(self, tree: Function) -> Value:
        name = tree.name
        if name == "ADP":
            (argument,) = tree.arguments
            return Value(Python(f"adp({self.value(argument).text})"))
        values = ", ".join(self.value(each).text for each in tree.arguments)
        if name in ("ROUND", "RND") and self.in_address:
            return Value(Python(f"H.increments({values})"))
        return Value(Python(f"f_{name}({values})"))

    def chain(self, tree: Chain[Number | Variable | Function | Name]) -> Value:
        left = self.expression(tree.first)
        for link in tree.links:
            right = self.expression(link.operand)
            left = self.linked(left, link.operator, right, link.at)
        return left

    def linked(self, left: Value, operator: str, right: Value, at: int) -> Value:
        if left.truth or right.truth:
            if left.truth and right.truth and operator in ("AND", "OR", "XOR"):
                word = {"AND": "and", "OR": "or", "XOR": "!="}[operator]
                return Value(infix(left.python, word, right.python), truth=True)
            raise no_value(at)
        if operator in ("EQ", "NE"):
            return Value(infix(left.python, COMPARISONS[operator], right.python), truth=True)
        if operator in COMPARISONS:
            return Value(infix(left.number(), COMPARISONS[operator], right.number()), truth=True)
        if operator in _ARITHMETIC:
            return Value(infix(left.number(), operator, right.number()))
        return Value(Python(f"o_{operator}({left.number().text}, {right.number().text})"))


def no_variable_at(at: int, number: int) -> Refusal:
    """Return what is wrong with a variable that the control does not have."""
    return Refusal(at, f"there is no variable #{number}", "See the table of variables.", code="PS0115")


def no_value(at: int) -> Flaw:
    return Flaw(at, "a condition where a number is needed", "Compare only in IF and WHILE.", code="PS0114")


def may_overflow(tree: Expression) -> bool:
    if isinstance(tree, (Number, Variable)):
        return False
    if isinstance(tree, Chain):
        operands = tree.first, *(link.operand for link in tree.links)
        variables = [each for each in operands if not isinstance(each, Number)]
        constants = [each.value for each in operands if isinstance(each, Number)]
        small = len(variables) <= 1 and all(abs(each) <= _SMALL for each in constants)
        plus = all(link.operator in "+-" for link in tree.links)
        return not (small and plus and all(isinstance(each, Variable) for each in variables))
    return not (isinstance(tree, Unary) and isinstance(tree.operand, (Number, Variable)))
