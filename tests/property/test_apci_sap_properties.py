"""Expressions against Python as the oracle, slicing into scans, files, and any text as a program."""

from __future__ import annotations

import math

from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.apci import sap
from support.often import share
from support.sap_board import FakeBoard, run_text

_32_BITS = 1 << 32


def _wrapped(value: int) -> int:
    return (value + (1 << 31)) % _32_BITS - (1 << 31)


@st.composite
def integers(draw: st.DrawFn, depth: int = 4) -> tuple[str, int]:
    """Draw an integer expression, fully bracketed, with its value by Python."""
    if depth == 0 or draw(st.integers(0, 3)) == 0:
        value = draw(st.integers(-(1 << 31) + 1, (1 << 31) - 1) | st.integers(-9, 9))
        return (str(value), value) if value >= 0 else (f"({value})", value)
    left_text, left = draw(integers(depth - 1))
    right_text, right = draw(integers(depth - 1))
    results = {
        "+": left + right,
        "-": left - right,
        "*": left * right,
        "AND": left & right,
        "OR": left | right,
        "XOR": left ^ right,
        "SHL": left << (right % 32),
        "SHR": left % _32_BITS >> (right % 32),
    }
    if right != 0:
        quotient = abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)
        results |= {"DIV": quotient, "MOD": int(math.fmod(left, right))}
    operator = draw(st.sampled_from(sorted(results)))
    return f"({left_text} {operator} {right_text})", _wrapped(results[operator])


@settings(max_examples=share(100))
@given(expression=integers())
def test_integer_expressions_are_what_python_says(expression: tuple[str, int]) -> None:
    text, value = expression
    board = run_text(f"CI0 := {text};", 5)
    assert board.tasks.each[0].error == ""
    assert board.ci(0) == value


_OPERANDS = st.integers(0, 19).map(str) | st.sampled_from(["1.5", "2.25", "1e3"])


@settings(max_examples=share(100))
@given(
    operands=st.lists(_OPERANDS, min_size=2, max_size=6),
    operators=st.lists(st.sampled_from("+-*"), min_size=5, max_size=5),
    negative=st.booleans(),
)
def test_precedence_without_brackets_is_python_s(
    operands: list[str], operators: list[str], negative: bool
) -> None:
    text = ("-" if negative else "") + operands[0]
    for operator, operand in zip(operators, operands[1:], strict=False):
        text += f" {operator} {operand}"
    exact = eval(text.replace("1e3", "1000.0"))
    board = run_text(f"CD0 := {text};", 5)
    assert board.system["cd", 0] == exact


@settings(max_examples=share(100))
@given(
    values=st.lists(st.integers(-3, 3), min_size=4, max_size=4),
    operators=st.lists(st.sampled_from(["and", "or"]), min_size=3, max_size=3),
    comparisons=st.lists(st.sampled_from(["<", "<=", ">", ">=", "=", "<>"]), min_size=4, max_size=4),
    negated=st.lists(st.booleans(), min_size=4, max_size=4),
)
def test_conditions_are_what_python_says(
    values: list[int], operators: list[str], comparisons: list[str], negated: list[bool]
) -> None:
    parts = [
        f"{'not ' if no else ''}({value} {comparison} 0)"
        for value, comparison, no in zip(values, comparisons, negated, strict=True)
    ]
    text = parts[0] + "".join(
        f" {operator} {part}" for operator, part in zip(operators, parts[1:], strict=True)
    )
    expected = eval(text.replace("<>", "!=").replace(" = ", " == "))
    assert run_text(f"IF {text} THEN CI0 := 1;", 5).ci(0) == int(expected)


_SORT = """
VAR a : ARRAY [1..12] OF INTEGER; n, i, j : INTEGER;
PROCEDURE swap (p, q : INTEGER); VAR t : INTEGER; BEGIN t := a[p]; a[p] := a[q]; a[q] := t END;
BEGIN
  n := CI20;
  FOR i := 1 TO n DO a[i] := CI[i];
  FOR i := 2 TO n DO BEGIN
    j := i;
    WHILE (j > 1) AND (a[j] < a[j - 1]) DO BEGIN swap (j, j - 1); j := j - 1 END
  END;
  FOR i := 1 TO n DO CI[i] := a[i]
END.
"""


@settings(max_examples=share(40))
@given(values=st.lists(st.integers(-99, 99), max_size=12), budget=st.integers(1, 60))
def test_a_program_does_the_same_however_it_is_cut_into_scans(values: list[int], budget: int) -> None:
    board = FakeBoard()
    board.system["ci", 20] = len(values)
    board.system.update({("ci", index): value for index, value in enumerate(values, 1)})
    board.tasks.load(sap.read_cnc(sap.write_cnc(sap.compile_program(_SORT))))
    board.tasks.startcnct(0)
    for _ in range(8000):
        if not board.tasks.rdcncts(0).running:
            break
        board.scan += 1
        board.run_scan(budget)
    assert board.tasks.rdcncts(0)[:4] == (0, 0, 32768, 0)
    assert [board.ci(index) for index in range(1, len(values) + 1)] == sorted(values)


_WORDS = """
program const var begin end if then else while do repeat until for to downto case of procedure function event on
array integer double boolean and or not div mod shl := ; . , : ( ) [ ] .. = < + - * / i j f X A1 CI0 PU 1 2.5 $F
't' mlr js ssf wt writeln startcnct { } (* *) true sqrt rdcbi
"""
_PIECES = [*_WORDS.split(), "// comment\n", "'"]


@settings(max_examples=share(100))
@given(pieces=st.lists(st.sampled_from(_PIECES), max_size=60) | st.text(max_size=60).map(lambda text: [text]))
def test_any_text_is_compiled_or_refused_with_a_place(pieces: list[str]) -> None:
    text = " ".join(pieces)
    program, errors = sap.check(text)
    assert (program is None) == bool(errors)
    lines = text.split("\n")
    for error in errors:
        assert error.position is not None
        assert 1 <= error.position.line <= len(lines)
        assert 1 <= error.position.column <= len(lines[error.position.line - 1]) + 1
        assert error.hint
