"""Random macros as models, and a slow interpreter of them that shares no code with polycnc.

It reads no text and compiles nothing: it walks the model, sorts the parts of each block, and keeps its state in
dictionaries. The numbers are multiples of 1/8, so that sums are exact.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from hypothesis import strategies as st

GROUPS = {"G00": "motion", "G01": "motion", "G90": "distance", "G91": "distance", "G28": ""}
ORDERS = {"G00": 10, "G01": 10, "G28": 15, "G90": 20, "G91": 20, "X": 30, "Z": 32, "T": 50}
FORMATS = {"X": "X%.3f", "Z": "Z%.3f", "T": "T%02d"}
ORIGINS = {"X": 0.0, "Z": 100.0}
NAMES = (*FORMATS, "V1", "V2")

Node = tuple[Any, ...]

_TEXTS = st.text(alphabet="ABx() /.%{}\\#", min_size=1, max_size=4).filter(str.strip)
_NUMBERS = st.integers(0, 400).map(lambda n: n / 8)
_KEYS = st.sampled_from(sorted(GROUPS))
_LEAVES = st.one_of(
    st.tuples(st.just("number"), _NUMBERS), st.tuples(st.just("name"), st.sampled_from(NAMES))
)
EXPRESSIONS = st.recursive(
    _LEAVES, lambda inner: st.tuples(st.sampled_from("+-*"), inner, inner), max_leaves=4
).flatmap(lambda node: st.sampled_from([node, ("/", node, ("number", 4.0)), ("-u", node)]))
_COMPARISONS = st.tuples(st.sampled_from(("==", "!=", "<", "<=", ">", ">=")), EXPRESSIONS, EXPRESSIONS)
_CONDITIONS = st.tuples(
    _COMPARISONS, st.lists(st.tuples(st.sampled_from(("&&", "||")), _COMPARISONS), max_size=3)
)
ELEMENTS = st.one_of(
    st.tuples(st.just("text"), _TEXTS),
    st.tuples(st.just("quoted"), st.text(alphabet="A!$@&<>'", max_size=3)),
    st.tuples(st.just("ordered"), _TEXTS, st.sampled_from((-200, -100, 0, 5, 31, 99))),
    st.tuples(st.just("code"), st.sampled_from(("", "*", "-", "-")), _KEYS),
    st.tuples(st.just("variable"), st.sampled_from(sorted(FORMATS))),
    st.tuples(st.just("number"), st.booleans()),
    st.tuples(st.just("assign"), st.sampled_from(NAMES), EXPRESSIONS),
    st.tuples(st.just("init"), st.sampled_from(sorted(ORDERS)), st.none()),
    st.tuples(st.just("init"), st.sampled_from(sorted(FORMATS)), EXPRESSIONS),
    st.tuples(st.just("order"), st.integers(0, 1)),
    st.tuples(
        st.just("ends"), st.sampled_from(("STARTOFLINE", "ENDOFLINE")), st.sampled_from(("", "/", ">;"))
    ),
)
_LINES = st.tuples(st.just("line"), st.lists(ELEMENTS, min_size=1, max_size=7))


def _ifs(inner: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    body = st.lists(inner, max_size=3)
    branches = st.lists(st.tuples(_CONDITIONS, body), min_size=1, max_size=3)
    return st.tuples(st.just("if"), branches, st.none() | body)


STATEMENTS = st.recursive(_LINES, lambda inner: _ifs(inner) | _LINES, max_leaves=6)
MACROS = st.lists(STATEMENTS, min_size=1, max_size=6)


def macro_text(macro: list[Node]) -> str:
    """Return the model as it stands in a control file."""
    return "\n".join(line for statement in macro for line in _lines(statement)) + "\n"


def _lines(statement: Node) -> list[str]:
    if statement[0] == "line":
        return ["".join(_element(element) for element in statement[1])]
    lines = []
    for index, (condition, body) in enumerate(statement[1]):
        (first, others) = condition
        text = _comparison(first) + "".join(f" {logic} {_comparison(each)}" for logic, each in others)
        lines += [
            f"{'ELSE ' if index else ''}IF( {text} )",
            *(line for each in body for line in _lines(each)),
        ]
    if statement[2] is not None:
        lines += ["ELSE", *(line for each in statement[2] for line in _lines(each))]
    return [*lines, "ENDIF"]


def _element(element: Node) -> str:
    match element:
        case ("text", text):
            return str(text)
        case ("quoted", text):
            return f'"{text}"'
        case ("ordered", text, order):
            return f"'{text},{order}'"
        case ("code", prefix, key):
            return f"!{prefix}{key}!"
        case ("variable", name):
            return f"${name}$"
        case ("number", wanted):
            return "@1@" if wanted else "@0@"
        case ("assign", name, value):
            return f"<{name} = {_expression(value)}>"
        case ("init", key, value):
            return f"&{key}&" if value is None else f"&{key}*{_expression(value)}&"
        case ("order", value):
            return f"<OutputOrder={value}>"
        case _:
            return f'<{element[1]}="{element[2]}">'


def _comparison(node: Node) -> str:
    return f"{_expression(node[1])}{node[0]}{_expression(node[2])}"


def _expression(node: Node) -> str:
    match node:
        case ("number", value):
            return f"{value:g}"
        case ("name", name):
            return str(name).lower()
        case ("-u", inner):
            return f"-({_expression(inner)})"
        case (sign, left, right):
            # Only the parentheses that the precedence needs.
            loose = ("+", "-") if sign in "*/" else ()
            a = f"({_expression(left)})" if left[0] in loose else _expression(left)
            b = f"({_expression(right)})" if right[0] in ("+", "-", "*", "/") else _expression(right)
            return f"{a}{sign}{b}"
        case _:
            raise AssertionError(node)


@dataclass
class Slow:
    """The state of a program, and the blocks so far."""

    place: int
    separator: str
    blocks: list[str] = field(default_factory=list)
    values: dict[str, float] = field(default_factory=lambda: dict(ORIGINS))
    modes: dict[str, str] = field(default_factory=dict)
    written: dict[str, str] = field(default_factory=dict)
    ends: dict[str, str] = field(default_factory=dict)
    ordered: bool = False
    next_number: int = 10

    def run(self, statements: list[Node]) -> None:
        for statement in statements:
            if statement[0] == "line":
                self._line(statement[1])
                continue
            for condition, body in statement[1]:
                if self._holds(condition):
                    self.run(body)
                    break
            else:
                self.run(statement[2] or [])

    def _line(self, elements: list[Node]) -> None:
        parts: list[tuple[int, str, bool]] = []
        flags = set()
        if not _line_has_more_than_blanks(elements):
            return
        for element in elements:
            if element[0] == "number":
                flags.add(element[1])
            else:
                parts += [part for part in self._act(element) if part[1]]
        if not parts:
            return
        number = ""
        if False not in flags and (self.place == 1 or (self.place == 2 and True in flags)):
            number = f"N{self.next_number}"
            self.next_number += 10
        numbers = [(-100, number, True)] if number else []
        parts = sorted([*numbers, *parts], key=lambda part: part[0]) if self.ordered else [*numbers, *parts]
        block, before = "", None
        for part in parts:
            behind_number = bool(numbers) and before is numbers[0]
            block += (self.separator if block and (part[2] or behind_number) else "") + part[1]
            before = part
        self.blocks.append(self.ends.get("STARTOFLINE", "") + block + self.ends.get("ENDOFLINE", "") + "\n")

    def _act(self, element: Node) -> list[tuple[int, str, bool]]:
        match element:
            case ("text" | "quoted", text):
                return [(0, text, False)]
            case ("ordered", text, order):
                return [(order, text, False)]
            case ("code", prefix, key):
                group = GROUPS[key]
                same = bool(group) and self.modes.get(group) == key
                self.modes[group] = key
                return [] if prefix == "*" or (prefix == "-" and same) else [(ORDERS[key], key, True)]
            case ("variable", name):
                text = FORMATS[name] % (round(self._value(("name", name))) if name == "T" else self._of(name))
                text = text.replace("-0.000", "0.000") if float(text[1:]) == 0.0 else text
                if self.written.get(name) == text:
                    return []
                self.written[name] = text
                return [(ORDERS[name], text, True)]
            case ("assign", name, value):
                self.values[name] = self._value(value)
            case ("init", key, value):
                if key in GROUPS:
                    self.modes.pop(GROUPS[key], None)
                else:
                    self.written.pop(key, None)
                    if value is not None:
                        self.values[key] = self._value(value)
                    elif key in ORIGINS:
                        self.values[key] = ORIGINS[key]
            case ("order", value):
                self.ordered = bool(value)
            case (_, name, text):
                self.ends[name] = text
        return []

    def _of(self, name: str) -> float:
        return self.values.get(name, 0.0)

    def _value(self, node: Node) -> float:
        match node:
            case ("number", value):
                return float(value)
            case ("name", name):
                return self._of(name)
            case ("-u", inner):
                return -self._value(inner)
            case (sign, left, right):
                return float(_ARITHMETIC[sign](self._value(left), self._value(right)))
            case _:
                raise AssertionError(node)

    def _holds(self, condition: Node) -> bool:
        first, others = condition
        groups = [[first]]  # || of && of comparisons
        for logic, each in others:
            if logic == "||":
                groups.append([each])
            else:
                groups[-1].append(each)
        return any(all(self._compared(each) for each in group) for group in groups)

    def _compared(self, node: Node) -> bool:
        a, b = self._value(node[1]), self._value(node[2])
        equal = abs(a - b) < 0.0001
        return {
            "==": equal,
            "!=": not equal,
            "<": a < b and not equal,
            ">": a > b and not equal,
            "<=": a < b or equal,
            ">=": a > b or equal,
        }[node[0]]


def _line_has_more_than_blanks(elements: list[Node]) -> bool:
    return bool("".join(_element(element) for element in elements).strip(" \t"))


_ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
