"""Random CPL: values as an independent evaluator computes them, flow as a slow interpreter goes, no crash."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.errors import ProgramError
from polycnc.nc.cpl import Linker, Run
from support.cpl_host import Ran, RecordingHost
from support.often import share

# Expressions: a node is (text, power of its loosest operator, how its value is computed, type)

Reckon = Callable[[dict[str, Any], type], Any]
Node = tuple[str, int, Reckon, str]
VARIABLES = {"I%": 7, "K%": -13, "X": 2.5, "Y": -0.1, "Z": 1234.567}
SIGNS = {"+": operator.add, "-": operator.sub, "*": operator.mul}
RELATIONS = {
    "=": operator.eq, "<>": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip
LOGIC = {"AND": operator.and_, "OR": operator.or_, "XOR": operator.xor}
POWERS = {"+": 2, "-": 2, "OR": 2, "XOR": 2, "*": 3, "/": 3, "AND": 3}


def number(value: Any, real: type) -> Any:
    """Return a value as it is computed with: INTEGER stays, all else is `real`."""
    return value if isinstance(value, int) else real(value)


def leaf(text: str, value: Any, kind: str) -> Node:
    return text, 9, lambda _values, real: number(value, real), kind


def name(text: str) -> Node:
    def reckon(values: dict[str, Any], real: type) -> Any:
        value = values[text]
        return value if isinstance(value, int) else real(np.float32(value))

    return text, 9, reckon, "I" if text.endswith("%") else "R"


def within(node: Node, least: int) -> str:
    return node[0] if node[1] >= least else f"({node[0]})"


def joined(parts: tuple[Node, str, Node]) -> Node:
    left, sign, right = parts
    power = POWERS[sign]
    whole = sign != "/" and left[3] == right[3] == "I"

    def reckon(values: dict[str, Any], real: type) -> Any:
        one, two = left[2](values, real), right[2](values, real)
        if whole:
            return SIGNS[sign](one, two)
        one, two = real(one), real(two)
        if sign == "/" and not two:
            raise ZeroDivisionError
        return one / two if sign == "/" else SIGNS[sign](one, two)

    return f"{within(left, power)}{sign}{within(right, power + 1)}", power, reckon, "I" if whole else "R"


NUMBERS: st.SearchStrategy[Node] = st.one_of(
    st.integers(0, 99).map(lambda value: leaf(str(value), value, "I")),
    st.sampled_from(("0.1", "2.75", "31.4", "0.007")).map(lambda text: leaf(text, float(text), "R")),
    st.sampled_from(sorted(VARIABLES)).map(name),
)


def depth(node: Node) -> int:
    deepest = now = 0
    for character in node[0]:
        now += (character == "(") - (character == ")")
        deepest = max(deepest, now)
    return deepest


NUMERIC = st.recursive(
    NUMBERS,
    lambda inner: st.tuples(inner, st.sampled_from(("+", "-", "*", "/")), inner).map(joined),
    max_leaves=9,
).filter(lambda node: depth(node) <= 7)


@given(node=NUMERIC, double=st.booleans())
@settings(deadline=None, max_examples=share(300))
def test_numbers_are_reckoned_in_the_precision_of_their_expression(node: Node, double: bool) -> None:
    real = np.float64 if double else np.float32
    try:
        with np.errstate(over="raise"):
            expected = real(node[2](VARIABLES, real))
    except (ArithmeticError, ValueError):
        return
    target = "#D!" if double else "#R"
    given_values = " : ".join(f"{key}={value}" for key, value in VARIABLES.items())
    found = Ran(f"1 {given_values}\n2 {target}={node[0]}").run.globals[target]
    assert found == float(expected), node[0]


@given(left=NUMERIC, right=NUMERIC, sign=st.sampled_from(sorted(RELATIONS)))
@settings(deadline=None, max_examples=share(100))
def test_comparisons_compare_single_precision(left: Node, right: Node, sign: str) -> None:
    try:
        with np.errstate(over="raise"):
            one, two = (side[2](VARIABLES, np.float32) for side in (left, right))
    except (ArithmeticError, ValueError):
        return
    given_values = " : ".join(f"{key}={value}" for key, value in VARIABLES.items())
    found = Ran(f"1 {given_values}\n2 #E?={left[0]}{sign}{right[0]}").run.globals["#E?"]
    assert found is bool(RELATIONS[sign](float(one), float(two)))


# Flow: a program is a list of nodes, run by a slow interpreter that knows no Python source

Flow = list[tuple[Any, ...]]
STEP = st.tuples(st.just("step"), st.integers(1, 9))
NC = st.tuples(st.just("nc"), st.integers(1, 9))
BODY: st.SearchStrategy[Flow] = st.recursive(
    st.lists(st.one_of(STEP, NC), max_size=2),
    lambda inner: st.lists(
        st.one_of(
            STEP,
            NC,
            st.tuples(st.just("if"), st.integers(2, 5), inner, inner),
            st.tuples(st.just("for"), st.integers(0, 3), st.sampled_from((1, 2, -1)), inner),
            st.tuples(st.just("while"), st.integers(0, 3), inner),
            st.tuples(st.just("repeat"), st.integers(1, 3), inner),
            st.tuples(st.just("case"), inner, inner, inner),
        ),
        max_size=3,
    ),
    max_leaves=8,
)


class Writer:
    """Write a flow as CPL; `apart` puts a jump destination into every body, so that nothing stays a structure."""

    def __init__(self, apart: bool) -> None:
        self.lines: list[str] = []
        self.apart = apart
        self.count = 0

    def body(self, flow: Flow) -> None:
        if self.apart:
            self.count += 1
            label = f".L{self.count}"
            self.put(f"IF S%<0 THEN GOTO {label} ENDIF")
            self.put(label)
        for node in flow:
            self.node(node)

    def put(self, text: str) -> None:
        self.lines.append(f"{len(self.lines) + 1} {text}")

    def node(self, node: tuple[Any, ...]) -> None:
        self.count += 1
        counter = f"C{self.count}%"
        match node:
            case ("step", number):
                self.put(f"S%=S%*3+{number} : S%=S%-INT(S%/9973)*9973")
            case ("nc", number):
                self.lines.append(f"N{number} X[S%]")
            case ("if", divisor, then, otherwise):
                self.put(f"IF S%-INT(S%/{divisor})*{divisor}=0 THEN")
                self.body(then)
                self.put("ELSE")
                self.body(otherwise)
                self.put("ENDIF")
            case ("for", end, step, body):
                self.put(f"FOR {counter}=0 STEP {step} TO {end if step > 0 else -end}")
                self.body(body)
                self.put("NEXT")
            case ("while", times, body):
                self.put(f"{counter}=0")
                self.put(f"WHILE {counter}<{times} DO")
                self.body(body)
                self.put(f"{counter}={counter}+1")
                self.put("END")
            case ("repeat", times, body):
                self.put(f"{counter}=0")
                self.put("REPEAT")
                self.body(body)
                self.put(f"{counter}={counter}+1")
                self.put(f"UNTIL {counter}>={times}")
            case ("case", one, two, otherwise):
                self.put("CASE S%-INT(S%/4)*4 OF")
                self.put("LABEL 0,2")
                self.body(one)
                self.put("LABEL 1")
                self.body(two)
                self.put("OTHERWISE")
                self.body(otherwise)
                self.put("ENDCASE")


class Slow:
    """Run a flow by walking over it."""

    def __init__(self) -> None:
        self.state = 1
        self.blocks: list[str] = []

    def body(self, flow: Flow) -> None:
        for node in flow:
            self.node(node)

    def node(self, node: tuple[Any, ...]) -> None:
        match node:
            case ("step", number):
                self.state = (self.state * 3 + number) % 9973
            case ("nc", _):
                self.blocks.append(f"X{self.state}")
            case ("if", divisor, then, otherwise):
                self.body(then if self.state % divisor == 0 else otherwise)
            case ("for", end, step, body):
                for _ in range(0, (end + 1) if step > 0 else (-end - 1), step):
                    self.body(body)
            case ("while" | "repeat", times, body):
                for _ in range(times):
                    self.body(body)
            case ("case", one, two, otherwise):
                self.body({0: one, 2: one, 1: two}.get(self.state % 4, otherwise))


@pytest.mark.parametrize("apart", [False, True])
@given(flow=BODY)
@settings(deadline=None, max_examples=share(60))
def test_structures_run_as_a_slow_interpreter_walks_them(apart: bool, flow: Flow) -> None:
    writer = Writer(apart)
    writer.put("S%=1")
    writer.body(flow)
    writer.put("#S%=S%")
    slow = Slow()
    slow.body(flow)
    ran = Ran("\n".join(writer.lines))
    assert (ran.blocks, ran.run.globals["#S%"]) == (slow.blocks, slow.state)


WORDS = (
    """
    1 2.5 .5 99999999999 X X% X! X? A$ #G #A$ @7 @_R @X% P1 P2$ ( ) [ ] , ; : . = <> < >= + - * / " "T" N10 X5 G1 .L
    IF THEN ELSE ENDIF FOR TO STEP NEXT WHILE DO END REPEAT UNTIL CASE OF LABEL OTHERWISE ENDCASE GOTO CALL DIN é
    DIM PDIM WAIT REM AND OR XOR NOT NUL TRUE SIN( ABS( MID$( LEN( VAL( STR$( IC( PRN#( DLG FIX
    """.split()  # noqa: SIM905 (a hundred words in quotes are no easier to read)
    + ["\t", "\n", "\n10 ", "\n20 "]
)


@given(st.lists(st.sampled_from(WORDS), max_size=25), st.sampled_from(("", " ")))
@settings(deadline=None, max_examples=share(400))
def test_any_text_runs_or_is_refused_with_its_place(words: list[str], blank: str) -> None:
    text = "1 " + blank.join(words)
    host = RecordingHost(
        {"IC": lambda *given: True, "PRN#": lambda *given, **more: None, "DLG": lambda: None}
    )
    linker = Linker(host.program)
    main, errors = linker.link(text, "main.cpl")
    assert (main is None) == bool(errors)
    for error in errors:
        assert error.position is not None
        assert error.position.file == "main.cpl"
    if main is None:
        return
    stopped = stopped_by(Run, main, linker, host)
    if stopped is not None:
        assert stopped.position is not None
        assert stopped.position.text in text.split("\n")


def stopped_by(make: Any, *given: Any) -> ProgramError | None:
    try:
        run = make(*given)
        for _ in range(20):
            if run.step() is None:
                break
    except ProgramError as error:
        return error
    return None
