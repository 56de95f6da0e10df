"""Expressions and conditions of macros: read once, then turned into Python (Manual 001, sections 6 and 8)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from polycnc.language import (
    Chain,
    Flaw,
    Infix,
    Lexicon,
    Operators,
    Prefix,
    Python,
    Tokens,
    Tree,
    Unary,
    infix,
    prefix,
    read_expression,
    real_value,
)

FUNCTIONS = (
    *("SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "DEG", "RAD", "SQRT", "EXP", "LOG10", "LOG", "DABS"),
    *("DMS", "ADMS"),
)
LOGICAL_OPERATORS = 5
"""How many logical operators a condition may have (Manual 001, 8)."""
EQUAL_WITHIN = 0.0001
"""Values count as equal if their difference is smaller (Manual 001, 8)."""

NESTED_PARENTHESES = 50

_LEXICON = Lexicon(
    (
        ("number", r"[0-9]+(?:\.[0-9]*)?|\.[0-9]+"),
        ("name", r"[A-Za-z][A-Za-z0-9_]*"),
        ("mark", r"==|!=|<=|>=|&&|\|\||[-+*/()<>]"),
    ),
    folded=("name",),
)
_OPERATORS = Operators(
    infix={"+": Infix(1), "-": Infix(1), "*": Infix(2), "/": Infix(2)},
    prefix={"+": Prefix(3), "-": Prefix(3)},
)
_COMPARISONS = {
    "==": (f"-{EQUAL_WITHIN}<(", ")-(", f")<{EQUAL_WITHIN}"),
    "!=": (f"not -{EQUAL_WITHIN}<(", ")-(", f")<{EQUAL_WITHIN}"),
    "<=": ("(", ")-(", f")<{EQUAL_WITHIN}"),
    ">=": ("(", ")-(", f")>-{EQUAL_WITHIN}"),
    "<": ("(", ")-(", f")<=-{EQUAL_WITHIN}"),
    ">": ("(", ")-(", f")>={EQUAL_WITHIN}"),
}
_LOGIC = {"&&": " and ", "||": " or "}


@dataclass(frozen=True, slots=True)
class Constant:
    """A number."""

    at: int
    value: float


@dataclass(frozen=True, slots=True)
class Name:
    """A variable, in capitals."""

    at: int
    text: str


@dataclass(frozen=True, slots=True)
class Call:
    """A function of one argument."""

    at: int
    function: str
    argument: Expression


Expression: TypeAlias = Tree[Constant | Name | Call]


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two expressions that are compared, after a logical operator or ""."""

    logic: str
    left: Expression
    operator: str
    right: Expression


@dataclass(frozen=True, slots=True)
class Condition:
    """Comparisons, joined by logical operators; && binds tighter."""

    at: int
    comparisons: tuple[Comparison, ...]


def read_value(line: str, start: int, end: int) -> Expression:
    """Read `line[start:end]` as one expression.

    Raises:
        Flaw: It is none.
    """
    reader = _Reader(Tokens(_LEXICON, line, start, end, nesting=NESTED_PARENTHESES))
    tree = reader.expression()
    reader.tokens.end("the expression")
    return tree


def read_condition(line: str, start: int) -> Condition:
    """Read the rest of an IF line, which begins at the parenthesis at `start`.

    Raises:
        Flaw: It is no condition, or has too many logical operators.
    """
    reader = _Reader(Tokens(_LEXICON, line, start, nesting=NESTED_PARENTHESES))
    tokens = reader.tokens
    tokens.expect("(", "write the condition in parentheses, like IF(T==1)")
    first = tokens.token.at
    found = [reader.comparison("")]
    while tokens.token.word in _LOGIC:
        if len(found) > LOGICAL_OPERATORS:
            raise Flaw(
                tokens.token.at,
                f"more than {LOGICAL_OPERATORS} logical operators in one IF",
                "split the condition into nested IFs",
            )
        found.append(reader.comparison(tokens.step().word))
    tokens.expect(")", "join comparisons with && or ||, and end the condition with )")
    tokens.end("the condition")
    return Condition(first, tuple(found))


def python_condition(condition: Condition, value: Callable[[Name], str]) -> str:
    """Return a condition as Python; `value` gives the Python for a variable."""
    text = ""
    for each in condition.comparisons:
        before, between, behind = _COMPARISONS[each.operator]
        left, right = python_value(each.left, value), python_value(each.right, value)
        text += f"{_LOGIC.get(each.logic, '')}{before}{left}{between}{right}{behind}"
    return text


def python_value(tree: Expression, value: Callable[[Name], str]) -> str:
    """Return an expression as Python; `value` gives the Python for a variable."""
    return _python(tree, value).text


def _python(tree: Expression, value: Callable[[Name], str]) -> Python:
    match tree:
        case Constant():
            return Python(repr(tree.value))
        case Name():
            return Python(value(tree))
        case Call():
            return Python(f"{tree.function}({_python(tree.argument, value).text})")
        case Unary():
            return prefix(tree.operator, _python(tree.operand, value))
        case Chain():
            python = _python(tree.first, value)
            for link in tree.links:
                python = infix(python, link.operator, _python(link.operand, value))
            return python


class _Reader:
    """Read operands and what is around them."""

    def __init__(self, tokens: Tokens) -> None:
        self.tokens = tokens

    def expression(self) -> Expression:
        return read_expression(self.tokens, _OPERATORS, self._operand)

    def comparison(self, logic: str) -> Comparison:
        left = self.expression()
        operator = self.tokens.token
        if operator.word not in _COMPARISONS:
            raise Flaw(
                operator.at,
                f"a comparison is missing before {operator}",
                f"compare two expressions with one of {' '.join(_COMPARISONS)}",
            )
        self.tokens.step()
        return Comparison(logic, left, operator.word, self.expression())

    def _operand(self) -> Expression:
        token = self.tokens.token
        if token.word == "(":
            return self._in_parentheses()
        if token.kind == "number":
            self.tokens.step()
            return Constant(token.at, real_value(token))
        if token.kind != "name":
            raise Flaw(token.at, f"a number or a variable is missing before {token}")
        self.tokens.step()
        if self.tokens.token.word == "(":
            if token.word not in FUNCTIONS:
                raise Flaw(
                    token.at, f"there is no function {token.text}", f"functions: {', '.join(FUNCTIONS)}"
                )
            return Call(token.at, token.word, self._in_parentheses())
        if token.word in FUNCTIONS:
            raise Flaw(
                token.at,
                f"{token.word} is a function",
                f"write its argument in parentheses: {token.word}(V1)",
            )
        return Name(token.at, token.word)

    def _in_parentheses(self) -> Expression:
        opening = self.tokens.step()
        with self.tokens.nested(opening.at):
            tree = self.expression()
            self.tokens.expect(")", "close the parenthesis")
        return tree
