"""CPL read twice: a grammar for lark takes the same programs, and computes the same values."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest
from lark.exceptions import LarkError

from polycnc.errors import ProgramError
from polycnc.nc.cpl import compile_program
from support.cpl_grammar import Author, Reading, changed
from support.cpl_host import Ran

LONG = (pytest.mark.long, pytest.mark.timeout(0))
GRAMMAR = Reading()
VALUES: dict[str, Any] = {
    "I%": 7, "J3%": -13, "K2%": 5, "Q1": 2.5, "S22": -0.1, "R7": 1234.567, "D!": 0.7, "B?": True, "C1?": False,
}  # fmt: skip
SET = " : ".join(f"{name}={str(value).upper()}" for name, value in VALUES.items())


def both_take(seed: int) -> bool:
    """Read the program of a seed twice; tell whether it is taken."""
    chance = random.Random(seed)
    words = Author(chance, depth=3 if seed % 20 == 0 else 1 + seed % 2).program()
    if seed % 3:
        words = changed(words, chance)
    text = " ".join(words) + " "
    takes = GRAMMAR.takes(text)
    _, errors = compile_program(text, "main.cpl")
    assert takes == (not errors), f"{seed}: {text!r}: {errors[0] if errors else 'taken'}"
    return takes


@pytest.mark.parametrize("count", [50, pytest.param(20_000, marks=LONG)])
def test_a_grammar_takes_the_same_programs(count: int) -> None:
    taken = sum(map(both_take, range(count)))
    assert 0.25 * count < taken < 0.75 * count


@pytest.mark.parametrize(
    ("seed", "taken"), [(1823, True), (2806, False), (5512, False), (6199, False), (18905, True)]
)
def test_programs_that_were_read_differently_once(seed: int, taken: bool) -> None:
    assert both_take(seed) is taken


def expected(text: str, values: dict[str, Any], *, truth: bool, double: bool) -> Any:
    """Return the value of an expression, None where it has none."""
    try:
        with np.errstate(all="raise", under="ignore"):
            value = GRAMMAR.value(text, values, truth=truth, double=double)
            if value is not None and not truth and not double:
                value = np.float32(value)
    except (ArithmeticError, TypeError, ValueError, LarkError):  # no derivation: 2.5 AND 7
        return None
    return value if truth or value is None else float(value)


def found(text: str, target: str, nul: str) -> Any:
    assigned = SET + (f" : {nul}=NUL" if nul else "")
    try:
        return Ran(f"1 {assigned}\n2 {target}={text}").run.globals[target]
    except ProgramError:
        return None


@pytest.mark.parametrize("count", [150, pytest.param(20_000, marks=LONG)])
@pytest.mark.parametrize("truth", [False, True])
def test_expressions_are_worth_what_an_evaluator_makes_of_them(truth: bool, count: int) -> None:
    worth = 0
    for seed in range(count):
        chance = random.Random(seed)
        author = Author(chance, plain=True)
        text = " ".join(author.truth(2) if truth else author.number(3))
        nul = chance.choice(("", "", "", "Q1", "I%"))
        values = {name: None if name == nul else value for name, value in VALUES.items()}
        target = "#E?" if truth else chance.choice(("#R", "#D!"))
        double = "D!" in text or target == "#D!"
        if truth and double:
            continue  # each side of a comparison would have a precision of its own
        one, two = expected(text, values, truth=truth, double=double), found(text, target, nul)
        if target == "#R" and one is not None and double:
            one = float(np.float32(one))
        assert one == two, f"{seed}: {target}={text} with {nul}=NUL"
        worth += one is not None
    assert worth > count // 4
