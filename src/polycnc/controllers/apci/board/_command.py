"""A direct command between being given and taking effect."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial


@dataclass(slots=True)
class Command:
    """A direct command on its way."""

    due: int  # clock cycles
    axes: tuple[int, ...]
    orders: tuple[int, ...]  # of these axes, when it was given
    begin: partial[None]
