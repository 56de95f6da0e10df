"""Generators that are put to the place at which others stand."""

from collections.abc import Generator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc.language import INNER, Emitter, Traced, inner_of, line_of, names_of, resumed

NESTED = """def program(L, H):
    n = 7
    helper = H
    while True:
        if n <= 9:
            a = yield n, 'before'
            while n < 60:
                n += helper(3)
                if n % 4 == 0:
                    n += 1
                    yield n, a
                    if n > 50: break
                    continue
                elif n % 5 == 0:
                    yield from given(n)
                else:
                    yield n, 'else', a
                L.append(n)
            else:
                yield 'no break'
            yield n, 'behind'
        n += 2
        if n > 70: break
    yield 'end'
    return"""


class Given:
    """Two items and where it stands between them."""

    def __init__(self, n: int, left: int = 2) -> None:
        self.n = n
        self.left = left

    def __iter__(self) -> "Given":
        return self

    def __next__(self) -> tuple[int, str]:
        if not self.left:
            raise StopIteration
        self.left -= 1
        return self.n * 1000 + self.left, "given"


def traced(text: str) -> Traced[int]:
    out: Emitter[int] = Emitter(0)
    for number, line in enumerate(text.split("\n"), 11):
        out.place = number
        out.put(line)
    return out.compile("nested")


def made(program: Traced[int], kept: list[int], *more: Any) -> Generator[Any, Any, None]:
    names = {"given": Given}
    result: Generator[Any, Any, None] = program.load(names)["program"](kept, lambda step: step, *more)
    return result


def steps(generator: Generator[Any, Any, None], answers: list[int]) -> list[object]:
    return [step(generator, answer) for answer in answers]


def step(generator: Generator[Any, Any, None], answer: int) -> object:
    return next(generator) if inner_of(generator) is not None else generator.send(answer)


def again(
    program: Traced[int], generator: Generator[Any, Any, None], kept: list[int]
) -> Generator[Any, Any, None]:
    """Return a generator at the place of another one, as plain values tell it."""
    line = line_of(generator)
    assert line
    found = {name: value for name, value in names_of(generator).items() if name not in ("L", "H", "helper")}
    inner = inner_of(generator)
    if isinstance(inner, Given):
        found[INNER] = Given(inner.n, inner.left)
    other = made(resumed(program, line, found.keys() - {INNER}), kept, found)
    assert next(other) is None
    return other


def rest_of(generator: Generator[Any, Any, None]) -> list[object]:
    found: list[object] = []
    for answer in range(100, 200):
        try:
            found.append(step(generator, answer))
        except StopIteration:
            return found
    return found


@given(st.integers(1, 40), st.integers(0, 12))
def test_a_generator_goes_on_like_the_one_it_was_made_from(first: int, second: int) -> None:
    program = traced(NESTED)
    kept: list[int] = []
    one = made(program, kept)
    next(one)
    undisturbed = made(program, [])
    next(undisturbed)
    whole = rest_of(undisturbed)
    first = min(first, len(whole) - 2)
    seen = steps(one, list(range(50, 50 + first)))
    assert len(seen) == first
    copy = list(kept)
    other = again(program, one, copy)
    assert line_of(other) == line_of(one)
    assert steps(other, list(range(60, 60 + min(second, len(whole) - 2 - first)))) == steps(
        one, list(range(60, 60 + min(second, len(whole) - 2 - first)))
    )
    third_kept = list(copy)
    third = again(program, other, third_kept)
    assert rest_of(third) == rest_of(one)
    assert third_kept == kept


def test_a_generator_that_has_not_begun_and_one_that_has_ended() -> None:
    program = traced(NESTED)
    one = made(program, [])
    assert line_of(one) == 0
    one.close()
    assert line_of(one) is None
    assert names_of(one) == {}


def test_a_yield_may_be_gone_through_again() -> None:
    program = traced("def program(L, H):\n    n = 3\n    n = n + 2\n    a = yield n, H(4)\n    yield a")
    one = made(program, [])
    assert next(one) == (5, 4)
    line = line_of(one)
    assert line
    other = made(resumed(program, line, ["n"], again=True), [], {"n": 9})
    assert next(other) == (9, 4)
    assert other.send(17) == 17


@pytest.mark.parametrize("line", [1, 2, 4, 99])
def test_a_line_without_a_yield_is_refused(line: int) -> None:
    with pytest.raises(ValueError, match="yield"):
        resumed(traced(NESTED), line, ["n"])


def test_what_was_given_out_from_is_forgotten_when_it_has_ended() -> None:
    program = traced(
        "def program(L, H):\n    n = 3\n    yield from given(n)\n    yield n, 'behind'\n    yield 'end'"
    )
    one = made(program, [])
    assert next(one) == (3001, "given")
    line = line_of(one)
    assert line == 3
    other = made(resumed(program, line, ["n"]), [], {"n": 4, INNER: Given(4, 1)})
    assert next(other) is None
    assert isinstance(inner_of(other), Given)  # it goes on with it
    assert next(other) == (4000, "given")
    assert next(other) == (4, "behind")
    assert inner_of(other) is None
    assert names_of(other).keys() == {"L", "H", "n"}
