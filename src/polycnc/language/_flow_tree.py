"""What the flow of a program is made of, and which of its structures stay structures in Python.

A language's own statements are in the same lists; its structures are subclasses of `Choice` and `Loop`. Python has no
jump: where one leads into a structure from outside, or structures are nested deeper than Python allows, the structure
is *taken apart*: it becomes pieces that are entered by number.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

_LOOPS = 15  # Python has 20
_LEVELS = 40  # Python has 100
_BRANCHES = 200  # Python has a thousand or so


@dataclass(slots=True)
class Mark:
    """A place that jumps lead to, by its key; each key stands once."""

    at: int
    key: Hashable


@dataclass(slots=True)
class Jump:
    """A jump to the mark of a key."""

    at: int
    target: Hashable


@dataclass(slots=True)
class Leave:
    """The end of a loop around."""

    at: int
    loop: Loop


@dataclass(slots=True)
class Again:
    """The end of this round of a loop around."""

    at: int
    loop: Loop


class Choice:
    """Alternatives: of the first branch whose condition holds the body is executed."""

    __slots__ = ()
    at: int

    @property
    def bodies(self) -> Sequence[list[Any]]:
        """The statements of each branch."""
        raise NotImplementedError


class Loop:
    """A body that is repeated; `closes`: something is done or asked at the end of each round."""

    __slots__ = ()
    at: int
    body: list[Any]
    closes = False


def bodies_of(statement: object) -> Sequence[list[Any]]:
    """Return the bodies of a structure, none for other statements."""
    if isinstance(statement, Choice):
        return statement.bodies
    return (statement.body,) if isinstance(statement, Loop) else ()


def every(statements: Iterable[Any]) -> Iterator[Any]:
    """Yield all statements, those inside structures too."""
    left = [iter(statements)]
    while left:
        for statement in left[-1]:
            yield statement
            if isinstance(statement, (Choice, Loop)):
                left += [iter(body) for body in reversed(bodies_of(statement))]
                break
        else:
            left.pop()


@dataclass(slots=True, eq=False)
class _Body:
    """A list of statements, and the structure that it belongs to."""

    statements: list[Any]
    owner: Choice | Loop | None
    outer: _Body | None
    inner: list[_Body] = field(default_factory=list)
    has_marks: bool = False

    def around(self) -> Iterator[_Body]:
        """Yield it and all bodies around it."""
        body: _Body | None = self
        while body is not None:
            yield body
            body = body.outer


class Plan:
    """How a program becomes Python.

    `apart` are the ids of the structures that are taken apart, `regions` has the keys of the marks at which a body is
    entered, by the id of the body.
    """

    def __init__(self, statements: list[Any], used: Collection[Hashable] | None) -> None:
        self.apart: set[int] = set()
        self.regions: dict[int, list[Hashable]] = {}
        self._used = used
        self._marks: dict[Hashable, _Body] = {}
        self._leads: list[tuple[Hashable, _Body]] = []
        whole = _Body(statements, None, None)
        self._walk(whole)
        for key, body in self._leads:
            self._let_in(key, body)
        self._depth(whole)
        for key, home in self._marks.items():
            self.regions.setdefault(self._region(home), []).append(key)
        self._note_regions(whole)

    def _walk(self, body: _Body) -> None:
        used, marks = self._used, self._marks
        for statement in body.statements:
            if isinstance(statement, (Choice, Loop)):
                if isinstance(statement, Choice) and len(statement.bodies) > _BRANCHES:
                    self.apart.add(id(statement))
                for each in bodies_of(statement):
                    inner = _Body(each, statement, body)
                    body.inner.append(inner)
                    self._walk(inner)
            elif isinstance(statement, Mark):
                if used is None or statement.key in used:
                    marks[statement.key] = body
                    body.has_marks = True
            elif isinstance(statement, Jump):
                self._leads.append((statement.target, body))
            elif isinstance(statement, Again) and statement.loop.closes:
                self.apart.add(id(statement.loop))  # what a round ends with is jumped to

    def _let_in(self, key: Hashable, body: _Body) -> None:
        """Take apart what is around a mark, but not around the jump that leads there."""
        around = set(map(id, body.around()))
        home: _Body | None = self._marks[key]
        while home is not None and id(home) not in around:
            self.apart.add(id(home.owner))
            home = home.outer

    def _depth(self, body: _Body) -> tuple[int, int]:
        """Return how deep Python's loops and blocks are nested in a body; what is too deep is taken apart whole."""
        loops = levels = 0
        apart = body.has_marks
        for inner in body.inner:
            inner_loops, inner_levels = self._depth(inner)
            if id(inner.owner) not in self.apart:
                inner_loops, inner_levels = inner_loops + isinstance(inner.owner, Loop), inner_levels + 1
                if inner_loops > _LOOPS or inner_levels > _LEVELS:
                    self.apart.update(id(each.owner) for each in inner.around() if each.owner is not None)
            if id(inner.owner) in self.apart:
                apart = True
            loops, levels = max(loops, inner_loops), max(levels, inner_levels)
        if apart and id(body.owner) not in self.apart:
            loops, levels = loops + 1, levels + 3
        return loops, levels

    def _region(self, body: _Body) -> int:
        while id(body.owner) in self.apart and body.outer is not None:
            body = body.outer
        return id(body.statements)

    def _note_regions(self, body: _Body) -> None:
        if id(body.owner) in self.apart:
            self.regions.setdefault(self._region(body), [])
        for inner in body.inner:
            self._note_regions(inner)
