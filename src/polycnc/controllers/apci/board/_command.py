"""A command between being given and taking effect: a direct one, or one of the spoolers after it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial


@dataclass(slots=True)
class Command:
    """A command on its way."""

    due: int  # clock cycles
    axes: tuple[int, ...]
    orders: tuple[int, ...]  # of these axes, when it was given
    begin: partial[None]
    moves: bool = True  # False for one that only waits for its turn after those that move
