"""Which structures of a program stay structures in Python, and which become jumps.

Python has no GOTO: where one leads out of a loop or into a structure, or where structures are nested deeper than
Python allows, the structure is taken apart into segments that are entered by number.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from polycnc.language import Flaw, clipped
from polycnc.nc.cpl._syntax import Case, For, Goto, If, Repeat, Statement, Target, While

_LOOPS = 15  # Python has 20
_LEVELS = 40  # Python has 100
_BRANCHES = 200  # Python has a thousand or so


_LOOPING = (For, While, Repeat)
_STRUCTURES = (If, Case, *_LOOPING)


@dataclass(slots=True)
class Shape:
    """What stands inside a structure: jumps, places jumped to, parts taken apart; how deep loops and all else nest."""

    jumps: bool = False
    targets: bool = False
    apart: bool = False
    loops: int = 0
    levels: int = 0

    def take(self, other: Shape) -> None:
        """Add what stands inside a part."""
        self.jumps |= other.jumps
        self.targets |= other.targets
        self.apart |= other.apart
        self.loops = max(self.loops, other.loops)
        self.levels = max(self.levels, other.levels)


def bodies(statement: Statement) -> tuple[list[Statement], ...]:
    """Return the bodies of a structure, none for other statements."""
    if isinstance(statement, If):
        return (statement.then, statement.otherwise)
    if isinstance(statement, Case):
        return tuple(body for _, body in statement.branches)
    return (statement.body,) if isinstance(statement, _LOOPING) else ()


def every(statements: Iterable[Statement]) -> Iterable[Statement]:
    """Yield all statements, those inside structures too."""
    left = [iter(statements)]
    while left:
        for statement in left[-1]:
            yield statement
            if isinstance(statement, _STRUCTURES):
                left += [iter(body) for body in reversed(bodies(statement))]
                break
        else:
            left.pop()


def taken_apart(statements: list[Statement], targets: set[str]) -> tuple[set[int], bool]:
    """Return the ids of the structures that become jumps, and whether there is any jump at all.

    `targets` are the places that are jumped to.
    """
    apart: set[int] = set()
    shape = _shape(statements, targets, apart)
    return apart, shape.jumps or shape.apart


def _shape(statements: list[Statement], used: set[str], apart: set[int]) -> Shape:
    whole = Shape()
    for statement in statements:
        if isinstance(statement, Goto):
            whole.jumps = True
        elif isinstance(statement, Target):
            whole.targets |= statement.name in used
        elif isinstance(statement, _STRUCTURES):
            inside = Shape()
            for body in bodies(statement):
                if body:
                    inside.take(_shape(body, used, apart))
            loop = isinstance(statement, _LOOPING)
            inside.loops += loop
            inside.levels += 1
            deep = inside.loops > _LOOPS or inside.levels > _LEVELS
            wide = isinstance(statement, Case) and len(statement.branches) > _BRANCHES
            if inside.targets or inside.apart or deep or wide or (loop and inside.jumps):
                apart.add(id(statement))
                inside.apart = True
                inside.loops = inside.levels = 0
            whole.take(inside)
    return whole


def target_flaws(statements: Iterable[Statement]) -> list[Flaw]:
    """Return what is wrong with the jumps of all statements: a destination that is missing, or stands there twice."""
    places: dict[str, list[int]] = {}
    gotos: list[Goto] = []
    for statement in statements:
        if isinstance(statement, Target):
            places.setdefault(statement.name, []).append(statement.at)
        elif isinstance(statement, Goto):
            gotos.append(statement)
    flaws = []
    for goto in gotos:
        found, shown = len(places.get(goto.target, ())), clipped(goto.target)
        if not found:
            flaws.append(Flaw(goto.at, f"there is no jump destination {shown}", "spell it exactly alike"))
        elif found > 1:
            flaws.append(
                Flaw(goto.at, f"{found} jump destinations are called {shown}", "give each its own name")
            )
    return flaws
