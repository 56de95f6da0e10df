"""The flow machine does what a machine of jumps alone does, whatever leads where, and goes on from every yield."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc.errors import ProgramError
from polycnc.language import (
    Again,
    Choice,
    Emitter,
    Execution,
    Flow,
    Jump,
    Leave,
    Loop,
    Mark,
    Traced,
    every,
    standing,
)

ROUNDS = 7
MOST = 150


@dataclass(slots=True)
class Say:
    """A statement that gives its number."""

    at: int


@dataclass(slots=True)
class When(Choice):
    """Branches with a condition each, of which the last may have none; `before`: it writes a line before each."""

    at: int
    bodies_: list[list[Any]]
    otherwise: bool
    before: bool

    @property
    def bodies(self) -> list[list[Any]]:
        return self.bodies_


@dataclass(slots=True)
class While(Loop):
    """A loop that asks before its rounds, or never."""

    at: int
    asks: bool
    before: bool
    body: list[Any] = field(default_factory=list)


@dataclass(slots=True)
class Until(Loop):
    """A loop that asks at the end of its rounds."""

    closes = True

    at: int
    before: bool
    body: list[Any] = field(default_factory=list)


class Words:
    """The compiler of this small language."""

    def __init__(self) -> None:
        self.out: Emitter[int] = Emitter(0)
        self.names = 0

    def before(self, statement: Any) -> None:
        """Write nothing."""

    def statement(self, statement: Say) -> None:
        self.out.put(f"yield {statement.at}")

    def begin(self, structure: Any) -> None:
        if isinstance(structure, When):
            self.out.put(f"yield {-structure.at}")

    def condition(self, structure: Any, number: int) -> str | None:
        match structure:
            case When():
                last = number == len(structure.bodies) - 1
                return None if last and structure.otherwise else self.ask(before=structure.before)
            case While(asks=True):
                return self.ask(before=structure.before)
        return None

    def end(self, loop: Any) -> str | None:
        return self.ask(before=loop.before) if isinstance(loop, Until) else None

    def ask(self, *, before: bool) -> str:
        if not before:
            return "ask()"
        self.names += 1
        self.out.put(f"c{self.names} = ask()")
        return f"c{self.names}"


def compiled(statements: list[Any], begin: object = None) -> Traced[int]:
    words = Words()
    out = words.out
    with out.block("def program():"):
        used = {each.target for each in every(statements) if isinstance(each, Jump)} | {begin}
        Flow(out, words, rounds=ROUNDS).write(statements, used=used, begin=begin)
        out.put("return", "yield")
    return out.compile("<flow>")


class Tape:
    """Answers one after the other, then no."""

    def __init__(self, answers: list[bool], at: int = 0) -> None:
        self.answers = answers
        self.at = at

    def ask(self) -> bool:
        self.at += 1
        return self.at <= len(self.answers) and self.answers[self.at - 1]


def by_jumps(statements: list[Any]) -> list[tuple[Any, ...]]:
    """Return the program of a machine that knows steps and jumps alone."""
    code: list[tuple[Any, ...]] = []
    ends: dict[tuple[str, int], object] = {}

    def label(name: object) -> None:
        code.append(("label", name))

    def write(body: list[Any]) -> None:
        for each in body:
            here = len(code), id(each)
            match each:
                case Say():
                    code.append(("say", each.at))
                case Mark():
                    label(("mark", each.key))
                case Jump():
                    code.append(("go", ("mark", each.target)))
                case Leave():
                    code.append(("go", ends["end", id(each.loop)]))
                case Again():
                    code.append(("go", ends["close", id(each.loop)]))
                case When():
                    code.append(("say", -each.at))
                    for number, branch in enumerate(each.bodies):
                        if not (each.otherwise and number == len(each.bodies) - 1):
                            code.append(("unless", (here, number)))
                        write(branch)
                        code.append(("go", (here, "end")))
                        label((here, number))
                    label((here, "end"))
                case While() | Until():
                    ends["end", id(each)] = here, "end"
                    ends["close", id(each)] = here, "close" if isinstance(each, Until) else "begin"
                    label((here, "begin"))
                    if isinstance(each, While) and each.asks:
                        code.append(("unless", (here, "end")))
                    write(each.body)
                    label((here, "close"))
                    code.append(("unless" if isinstance(each, Until) else "go", (here, "begin")))
                    label((here, "end"))

    write(statements)
    return code


def said_by_jumps(statements: list[Any], tape: Tape) -> Iterator[int]:
    code = by_jumps(statements)
    labels = {step[1]: number for number, step in enumerate(code) if step[0] == "label"}
    at = steps = 0
    while at < len(code) and steps < 60 * MOST:
        kind, what = code[at]
        at, steps = at + 1, steps + 1
        if kind == "say":
            yield what
        elif kind == "go" or (kind == "unless" and not tape.ask()):
            at = labels[what]


def explain(error: Exception, at: int) -> ProgramError:
    raise AssertionError(at) from error


def execution(traced: Traced[int], tape: Tape) -> Execution:
    return Execution(traced, {"ask": tape.ask, "PAUSE": "pause"}, (), explain)


@st.composite
def programs(draw: st.DrawFn) -> list[Any]:
    number = iter(range(1, 10_000))
    marks: list[int] = []
    jumps: list[Jump] = []

    def body(depth: int, loops: list[Any]) -> list[Any]:
        kinds = ["say", "say", "mark", "jump", *(["leave", "again"] if loops else [])]
        kinds += ["when", "while", "until"] if depth else []
        return [statement(draw(st.sampled_from(kinds)), depth, loops) for _ in range(draw(st.integers(0, 4)))]

    def statement(kind: str, depth: int, loops: list[Any]) -> Any:
        at = next(number)
        match kind:
            case "mark":
                marks.append(at)
                return Mark(at, at)
            case "jump":
                jumps.append(Jump(at, at))
                return jumps[-1]
            case "leave" | "again":
                return (Leave if kind == "leave" else Again)(at, draw(st.sampled_from(loops)))
            case "when":
                bodies = [body(depth - 1, loops) for _ in range(draw(st.integers(1, 3)))]
                return When(at, bodies, draw(st.booleans()), draw(st.booleans()))
            case "while" | "until":
                asks, before = draw(st.booleans()), draw(st.booleans())
                loop = While(at, asks, before) if kind == "while" else Until(at, before)
                loop.body = body(depth - 1, [*loops, loop])
                return loop
        return Say(at)

    found = body(3, [])
    marks.append(0)
    for jump in jumps:
        jump.target = draw(st.sampled_from(marks))
    return [Mark(0, 0), *found]


ANSWERS = st.lists(st.booleans(), max_size=40)


@given(programs(), ANSWERS)
def test_flow_is_that_of_jumps_alone(statements: list[Any], answers: list[bool]) -> None:
    run = execution(compiled(statements), Tape(answers))
    given_ = [item for _ in range(MOST) if (item := run.next()) is not None]
    said = [item for item in given_ if item != "pause"]
    wanted = list(said_by_jumps(statements, Tape(answers)))
    if run.place is None:
        assert said == wanted
    else:
        count = min(len(said), len(wanted))
        assert said[:count] == wanted[:count]
        assert len(wanted) > 2 or "pause" in given_


@given(programs(), ANSWERS, st.integers(0, 30))
def test_a_program_goes_on_from_every_yield(statements: list[Any], answers: list[bool], count: int) -> None:
    traced, tape = compiled(statements), Tape(answers)
    run = execution(traced, tape)
    for _ in range(count):
        run.next()
    other_tape = Tape(answers, tape.at)
    other = execution(traced, other_tape)
    other.go_on(standing(traced, run.place, run.names), run.names)
    assert [other.next() for _ in range(40)] == [run.next() for _ in range(40)]


def nested(depth: int, make: Callable[[list[Any]], Any]) -> list[Any]:
    body: list[Any] = [Say(7)]
    for _ in range(depth):
        body = [make(body)]
    return body


@pytest.mark.parametrize("depth", [3, 18, 90])
def test_what_is_deeper_than_python_allows_is_taken_apart(depth: int) -> None:
    loops = nested(depth, lambda body: While(5, True, False, [*body]))
    run = execution(compiled(loops), Tape([True] * depth))
    assert [item for _ in range(depth) if (item := run.next()) not in (None, "pause")] == [7]
    assert run.place is None
    choices = nested(depth, lambda body: When(3, [body], False, False))
    run = execution(compiled(choices), Tape([True] * depth))
    assert [run.next() for _ in range(depth + 2)] == [-3] * depth + [7, None]


def test_a_program_begins_at_a_mark_and_its_places_are_told() -> None:
    statements = [Say(1), Mark(2, "two"), Say(3), Mark(4, "four"), Say(5)]
    run = execution(compiled(statements, begin="four"), Tape([]))
    assert [run.next(), run.next()] == [5, None]
