"""What is wrong with the jumps of a program."""

from __future__ import annotations

from collections.abc import Hashable, Iterable

from polycnc.language import Flaw, Jump, Mark, clipped
from polycnc.nc.cpl._syntax import Statement


def target_flaws(statements: Iterable[Statement]) -> list[Flaw]:
    """Return what is wrong with the jumps of all statements: a destination that is missing, or stands there twice."""
    places: dict[Hashable, list[int]] = {}
    gotos: list[Jump] = []
    for statement in statements:
        if isinstance(statement, Mark):
            places.setdefault(statement.key, []).append(statement.at)
        elif isinstance(statement, Jump):
            gotos.append(statement)
    flaws = []
    for goto in gotos:
        found, shown = len(places.get(goto.target, ())), clipped(str(goto.target))
        if not found:
            flaws.append(Flaw(goto.at, f"there is no jump destination {shown}", "spell it exactly alike"))
        elif found > 1:
            flaws.append(
                Flaw(goto.at, f"{found} jump destinations are called {shown}", "give each its own name")
            )
    return flaws
