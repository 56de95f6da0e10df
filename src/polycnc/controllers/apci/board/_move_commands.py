"""Interpolation as data: what each command describes, by the manual's names, and two verbs for all (Manual 002, 4.4).

Axes by their numbers, distances one per axis in that order; speeds and distances in the units that ctru set.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._interpolation import Speeds, go, queue
from polycnc.controllers.apci.board._shapes import Circle, Helix, Line, Shape, SpaceCircle

Kind: TypeAlias = Callable[..., Shape]

MOVES: dict[str, tuple[Kind, bool]] = {
    "mla": (Line, False),
    "mlr": (Line, True),
    "mca": (Circle, False),
    "mcr": (Circle, True),
    "mha": (Helix, False),
    "mhr": (Helix, True),
    "mca3d": (SpaceCircle, False),
    "mcr3d": (SpaceCircle, True),
}
"""What each command describes, and whether from where it begins; with an s in front it goes into the spoolers."""


def _command(name: str) -> Callable[..., None]:
    """Return a command: the numbers of its shape, one after the other, then the speeds."""
    kind, relative = MOVES[name]

    def move(
        board: CommandedBoard, axes: Sequence[int], *given: Any, spool: bool = False, index: int = -1
    ) -> None:
        *numbers, speeds = given
        shape = kind(*numbers, relative=relative)
        if spool:
            queue(board, axes, shape, speeds, index)
        else:
            go(board, axes, shape, speeds)

    move.__name__ = name
    return move


mla, mlr, mca, mcr, mha, mhr, mca3d, mcr3d = map(_command, MOVES)

# fmt: off
__all__ = [
    "MOVES", "Circle", "Helix", "Kind", "Line", "SpaceCircle", "Speeds", "go", "mca", "mca3d", "mcr",
    "mcr3d", "mha", "mhr", "mla", "mlr", "queue",
]
# fmt: on
