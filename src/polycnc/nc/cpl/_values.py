"""Expressions of CPL turned into Python, with the type that each has.

Intermediate results that are REAL are rounded to single precision, as a 32-bit machine does; where anything in an
expression is DOUBLE all of it is computed with double precision (Manual 003, 2.4.2).
"""

from __future__ import annotations

import ast
from collections.abc import Callable

from polycnc.language import Chain, Flaw, Python, Unary, infix, prefix
from polycnc.nc.cpl._faults import NESTING_TOO_DEEP, Fault
from polycnc.nc.cpl._function import Function, Takes
from polycnc.nc.cpl._functions import FUNCTIONS
from polycnc.nc.cpl._operators import (
    COMPARISONS,
    LOGIC,
    NUMERIC,
    Typed,
    compared,
    computed,
    is_flat,
    logical,
    number,
    rounded,
    unary,
)
from polycnc.nc.cpl._syntax import Call, Expression, Leaf, Name, Number, Parentheses, Text, Word
from polycnc.nc.cpl._variables import KIND_NAMES, Kind, Variable

_CONSTANT = frozenset("+-.0123456789'\"")
_CHAIN_DEPTH = 3
_IN_ONE = 10
"""So many operands are rounded inside each other; what they give is kept: Python nests only so deep."""


class Values:
    """Turn expressions of one program into Python.

    `use` notes a variable and returns the Python for it; `host` does so for a function of the control, `box` for
    a variable that such a function sets; `temporary` returns a new name of Python.
    """

    def __init__(
        self,
        use: Callable[[Variable, int], str],
        host: Callable[[str, int], str],
        box: Callable[[Name], str],
        temporary: Callable[[], str],
    ) -> None:
        self._use = use
        self._host = host
        self._box = box
        self._temporary = temporary
        self.fields: dict[str, int] = {}
        """Local variables that a DIM makes a field, with the number of their indices."""
        self._known: dict[Variable, Typed] = {}
        self._numbers: dict[tuple[float, str], Typed] = {}
        self._double = False

    def value(self, tree: Expression, wanted: Kind | None = None) -> Typed:
        """Return an expression that is assigned to a variable of type `wanted`, or used otherwise.

        Raises:
            Flaw: Its types do not go together.
        """
        outside, self._double = self._double, wanted == "D" or _has_double(tree)
        try:
            return self._typed(tree)
        finally:
            self._double = outside

    def condition(self, tree: Expression) -> str:
        """Return a condition; NUL is none.

        Raises:
            Flaw: It is neither TRUE nor FALSE.
        """
        typed = self.value(tree)
        if typed.kind == "X":
            return f"to_boolean({typed.python.text}) & True"
        if typed.kind != "B":
            raise Flaw(
                tree.at, f"a condition is TRUE or FALSE, not {KIND_NAMES[typed.kind]}", "compare it: X%<>0"
            )
        return infix(typed.python, "&", Python("True")).text if typed.leaf else typed.python.text

    def integer(self, tree: Expression) -> str:
        """Return an expression that must be INTEGER.

        Raises:
            Flaw: It has another type.
        """
        typed = self.value(tree)
        if typed.kind == "I":
            return typed.python.text
        if typed.kind not in ("X", "R", "D"):
            raise Flaw(tree.at, f"an INTEGER is needed, not {KIND_NAMES[typed.kind]}")
        return f"to_integer({typed.python.text})"

    def assigned(self, tree: Expression) -> str:
        """Return an expression that must be INTEGER and have a value.

        Raises:
            Flaw: It has another type.
        """
        text = self.integer(tree)
        return text if isinstance(tree, Number) else f"assigned({text})"

    def text(self, tree: Expression) -> str:
        """Return the text that a string expression has.

        Raises:
            Flaw: It is none.
        """
        stored = self.stored(tree)
        return stored if makes_text(tree) else f"text_of({stored})"

    def stored(self, tree: Expression, depth: int = 0) -> str:
        """Return a string expression as what a string variable can hold: parts of fields as references.

        Raises:
            Flaw: It is none.
        """
        match tree:
            case Text():
                return repr(tree.value)
            case Word(value=None):
                return "None"
            case Name(variable=Variable(kind="S")):
                return self._place(tree)
            case Parentheses():
                if depth >= _CHAIN_DEPTH:
                    raise Flaw(
                        tree.at, NESTING_TOO_DEEP.what, "keep a part in a field", code=NESTING_TOO_DEEP.code
                    )
                return self.stored(tree.inner, depth + 1)
            case Chain():
                return self._joined(tree, depth)
            case Call() if FUNCTIONS[tree.function].kind in ("S", "X"):
                return self._text_call(tree)
        raise Flaw(tree.at, "a text is needed")

    def element(self, name: Name) -> tuple[str, str]:
        """Return a variable and its index, "" if it has none.

        Raises:
            Flaw: It has not the indices that its DIM says.
        """
        variable, indices = name.variable, name.indices
        python = self._use(variable, name.at)
        if variable.scope == "local":
            dimensions = self.fields.get(variable.name, 0)
            wanted = dimensions - (variable.kind == "S" and dimensions > 0)
            if len(indices) != wanted:
                what = f"{variable.name} has {wanted} indices, not {len(indices)}"
                hint = "a field is dimensioned with DIM before" if not dimensions else ""
                raise Flaw(name.at, what, hint)
        return python, ", ".join([self.integer(index) for index in indices])

    def host_call(self, call: Call) -> str:
        """Return the call of a function of the control."""
        parts = [self._host(call.function, call.at), *self.arguments(call)]
        if FUNCTIONS[call.function].waiting:
            return f"(yield from wait_for({', '.join(parts)}))"
        return f"{parts[0]}({', '.join(parts[1:])})"

    def arguments(self, call: Call) -> list[str]:
        """Return the arguments of a call of the control, one by one."""
        function = FUNCTIONS[call.function]
        parts = [self._argument(function, place, tree) for place, tree in enumerate(call.arguments)]
        if function.named:
            names = tuple(tree.variable.name for tree in call.arguments if isinstance(tree, Name))
            parts.append(f"names={names!r}")
        return [*parts, "open=True"] if call.open else parts

    def _argument(self, function: Function, place: int, tree: Expression | None) -> str:
        if tree is None:
            return "OMITTED"
        from_list = function.listed and function.results and place >= function.results[0]
        if place in function.results or from_list:
            if from_list and isinstance(tree, Call) and tree.function == "MID$":
                return _section(self, tree)
            return self._result(tree)
        if isinstance(tree, Name) and not tree.indices and self.fields.get(tree.variable.name):
            return self._use(tree.variable, tree.at)
        typed = self.value(tree)
        if function.listed and place >= 1:
            return f"Item({typed.kind!r}, {self.rounded(typed).text})"
        return self.rounded(typed).text

    def _result(self, tree: Expression) -> str:
        if isinstance(tree, Call) and tree.function == "MID$":
            raise Flaw(tree.at, "MID$ cannot be set here", "read into a field, and take MID$ of that")
        if not isinstance(tree, Name):
            raise Flaw(tree.at, "a variable is needed, because it is set")
        dimensions = self.fields.get(tree.variable.name, 0)
        if dimensions and not tree.indices:
            return self._use(tree.variable, tree.at)
        if any(map(_sets, tree.indices)):  # which is computed more than once
            raise Flaw(
                tree.at, "the index of a variable that is set sets another one", "keep it in a variable"
            )
        return self._box(tree)

    def rounded(self, typed: Typed) -> Python:
        """Return the value as its type has it, rounded to single precision if need be."""
        return rounded(typed, self._double)

    def _typed(self, tree: Expression) -> Typed:
        if isinstance(tree, Name) and tree.variable.kind != "S":  # most of them are variables and numbers
            if tree.indices or tree.variable.name in self.fields:
                return Typed(Python(self._place(tree)), tree.variable.kind, leaf=True)
            if (known := self._known.get(tree.variable)) is None:
                python = Python(self._use(tree.variable, tree.at))
                self._known[tree.variable] = known = Typed(python, tree.variable.kind, leaf=True)
            return known
        if isinstance(tree, Number):
            return self._number(tree)
        match tree:
            case Word(value=None):
                return Typed(Python("None"), "N")
            case Word():
                return Typed(Python(repr(tree.value)), "B")
            case Parentheses() if not is_text(tree):
                return self._typed(tree.inner)
            case Unary():
                return unary(tree, self._typed(tree.operand), self._double)
            case Chain() if not is_text(tree):
                return self._chain(tree)
            case Call() if FUNCTIONS[tree.function].kind != "S":
                return self._call(tree)
        return Typed(Python(self.text(tree)), "S", leaf=True)

    def _number(self, tree: Number) -> Typed:
        key = (tree.value, "I" if isinstance(tree.value, int) else "D" if self._double else "R")
        if (known := self._numbers.get(key)) is None:
            self._numbers[key] = known = number(tree, self._double)
        return known

    def _place(self, name: Name) -> str:
        if not name.indices and name.variable.name not in self.fields:
            return self._use(name.variable, name.at)
        python, index = self.element(name)
        return f"{python}[{index}]" if index else python

    def _chain(self, tree: Chain[Leaf]) -> Typed:
        typed = self._typed(tree.first)
        kept: list[str] = []
        for place, link in enumerate(tree.links):
            if place and place % _IN_ONE == 0 and not is_flat(typed, self._double):
                name = self._temporary()
                kept.append(f"{name} := {typed.python.text}")
                typed = typed._replace(python=Python(name))
            right = self._typed(link.operand)
            if link.operator in COMPARISONS:
                typed = compared(typed, link.operator, right, link.at, self._double)
            elif link.operator in LOGIC:
                typed = logical(typed, link.operator, right, link.at)
            else:
                typed = computed(typed, link.operator, right, link.at, self._double)
        if kept:
            whole = Python(f"({', '.join((*kept, typed.python.text))})[-1]")
            typed = typed._replace(python=whole)
        return typed

    def _call(self, call: Call) -> Typed:
        row = FUNCTIONS[call.function]
        if row.run is None:
            if row.command:
                raise Flaw(call.at, f"{row.name} is a command and has no value")
            return Typed(Python(self.host_call(call)), row.kind, leaf=True)
        python, kinds = self._own_call(call, row)
        if row.keeps_type:
            return Typed(python, kinds[0])
        if row.kind == "R":
            return Typed(python, "D" if self._double else "R", exact=False)
        return Typed(python, row.kind, leaf=row.kind == "X" and python.text[0] not in _CONSTANT)

    def _text_call(self, call: Call) -> str:
        row = FUNCTIONS[call.function]
        if row.run is None:
            return self.host_call(call)
        if row.kind != "S":
            raise Flaw(call.at, f"{row.name} is no text")
        return self._own_call(call, row)[0].text

    def _own_call(self, call: Call, row: Function) -> tuple[Python, list[Kind]]:
        """Return the call of one of CPL's own functions, and the types of its arguments; a constant is evaluated."""
        assert row.run is not None
        left_out = row.leading if len(call.arguments) == row.count[0] else 0
        parts, kinds = ["None"] * left_out, list[Kind]()
        for takes, tree in zip(row.takes[left_out:], call.arguments, strict=False):
            if tree is None:
                raise Flaw(call.at, f"{row.name} has an argument left out", row.usage)
            text, kind = self._taken(row.name, takes, tree)
            parts.append(text)
            kinds.append(kind)
        constant = _evaluated(row.run, parts)
        return Python(f"{row.run.__name__}({', '.join(parts)})") if constant is None else constant, kinds

    def _taken(self, name: str, takes: Takes, tree: Expression) -> tuple[str, Kind]:
        """Return an argument as a function takes it, and its type."""
        match takes:
            case Takes.TEXT:
                return self.text(tree), "S"
            case Takes.LETTER:
                return f"assigned({self.text(tree)})", "S"
            case Takes.STORED:
                return self.stored(tree), "S"
            case Takes.PLACE:
                return self.assigned(tree), "I"
            case Takes.INTEGER:
                return self.integer(tree), "I"
        typed = self._typed(tree) if takes is Takes.NUMBER else self.value(tree)
        if typed.kind not in NUMERIC:
            raise Flaw(tree.at, f"{name} takes a number, not {KIND_NAMES[typed.kind]}")
        number = self.rounded(typed).text
        return number if takes is Takes.NUMBER else f"{typed.kind!r}, {number}", typed.kind

    def _joined(self, tree: Chain[Leaf], depth: int) -> str:
        def text(part: Expression) -> str:
            bare = part
            while isinstance(bare, Parentheses):
                bare = bare.inner
            if isinstance(bare, Word):
                raise Flaw(bare.at, f"+ does not take {'NUL' if bare.value is None else 'BOOLEAN'}")
            stored = self.stored(part, depth)
            return stored if makes_text(part) else f"text_of({stored})"

        for link in tree.links:
            if link.operator != "+":
                raise Flaw(link.at, f"texts are joined by +, not by {link.operator}")
        parts = [text(part) for part in (tree.first, *(link.operand for link in tree.links))]
        return f"added({', '.join(parts)})"


def _has_double(tree: Expression | None) -> bool:
    if isinstance(tree, Name):
        return tree.variable.kind == "D"
    if isinstance(tree, Chain):
        for link in tree.links:
            if _has_double(link.operand):
                return True
        return _has_double(tree.first)
    if isinstance(tree, Call):
        function = FUNCTIONS[tree.function]
        return function.kind == "D" or (function.run is not None and any(map(_has_double, tree.arguments)))
    if isinstance(tree, Parentheses):
        return _has_double(tree.inner)
    return isinstance(tree, Unary) and _has_double(tree.operand)


def _evaluated(run: Callable[..., object], parts: list[str]) -> Python | None:
    """Return what a function gives for constants as one; None if they are none, or it refuses them."""
    if not all(part[0] in _CONSTANT for part in parts):
        return None
    try:
        value = run(*ast.literal_eval(f"({', '.join(parts)},)"))
    except (Fault, ArithmeticError, SyntaxError, TypeError, ValueError):
        return None
    text = repr(value)
    return None if value is None else prefix("-", Python(text[1:])) if text[0] == "-" else Python(text)


def _sets(tree: Expression | None) -> bool:
    """Tell whether a function in an expression sets a variable."""
    match tree:
        case Call():
            return bool(FUNCTIONS[tree.function].results) or any(map(_sets, tree.arguments))
        case Name():
            return any(map(_sets, tree.indices))
        case Parentheses():
            return _sets(tree.inner)
        case Unary():
            return _sets(tree.operand)
        case Chain():
            return _sets(tree.first) or any(_sets(link.operand) for link in tree.links)
    return False


def makes_text(tree: Expression) -> bool:
    """Tell whether a string expression makes a new text, which only a dimensioned field can hold."""
    match tree:
        case Chain():
            return True
        case Parentheses():
            return makes_text(tree.inner)
        case Call():
            row = FUNCTIONS[tree.function]
            source = tree.arguments[0] if row.takes[:1] == (Takes.STORED,) else None
            return row.new_text or (source is not None and makes_text(source))
    return False


def is_text(tree: Expression) -> bool:
    """Tell whether an expression is a string expression."""
    match tree:
        case Text():
            return True
        case Name():
            return tree.variable.kind == "S"
        case Parentheses():
            return is_text(tree.inner)
        case Chain():
            return is_text(tree.first) and all(link.operator == "+" for link in tree.links)
        case Call():
            return FUNCTIONS[tree.function].kind == "S"
    return False


def _section(values: Values, call: Call) -> str:
    """Return a part of a character field that a command sets."""
    first, *others = call.arguments
    places = [values.assigned(tree) for tree in others if tree is not None]
    if not isinstance(first, Name) or len(places) != len(others):
        raise Flaw(call.at, "MID$ sets a part of a character field", "MID$(A$,start[,number])")
    return f"section({', '.join((values.stored(first), *places))})"
