"""What the function library needs of a card, and nothing else: any object that has this can be attached."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from polycnc.controllers.imc.card._config import CardConfig
from polycnc.controllers.imc.core._instructions import Instruction
from polycnc.machine import Clock


class CardLike(Protocol):
    """A card as the library sees it over the network."""

    @property
    def config(self) -> CardConfig:
        """Return what the card is: its password and version count here."""
        ...

    @property
    def axes(self) -> int:
        """Return how many axes it has."""
        ...

    @property
    def room_for_events(self) -> int:
        """Return how many events can still be installed."""
        ...

    @property
    def clock(self) -> Clock:
        """Return the clock that `advance` lets go on."""
        ...

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        """Let up to `cycles` control cycles pass; return how many did, fewer after an attention of `until`."""
        ...

    def read_words(self, at: int, axis: int, count: int) -> Sequence[int]:
        """Return words of memory, each 0 to 65535; of the card itself where the address is the card's own."""
        ...

    def push(self, fifo: int, instruction: Instruction) -> bool:
        """Put an instruction into a queue; False if it does not fit."""
        ...

    def push_points(self, words: Sequence[int]) -> bool:
        """Put displacements into the contour queue; False, and nothing put, if they do not all fit."""
        ...

    def clear_fifo(self, fifo: int) -> None:
        """Empty a queue and end the wait that it is in."""
        ...

    def read_capture(self, axis: int, most: int) -> tuple[Sequence[int], int]:
        """Take captured positions, at most `most`; return them, and how many are left."""
        ...
