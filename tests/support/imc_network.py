"""A card that only notes what it is told, and one of the real kind, both opened through the function library."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.card._config import CardConfig, parse_card
from polycnc.controllers.imc.core._instructions import Instruction
from polycnc.controllers.imc.core._parameters import PARAMETERS
from polycnc.machine import Clock


class ToldCard:
    """A card without motion: `told` is what it has been sent, `memory` what it is asked for."""

    def __init__(self, axes: int = 4, **config: Any) -> None:
        self.config = CardConfig(number_of_axes=axes, **config)
        self.memory: dict[tuple[int, int], int] = {}
        self.told: list[tuple[int, Instruction]] = []
        self.points: list[int] = []
        self.cleared: list[int] = []
        self.captured: dict[int, list[int]] = {}
        self.full = False
        self.clock = Clock(0.001)
        self.room_for_events = 128

    @property
    def axes(self) -> int:
        return self.config.number_of_axes

    @property
    def cycles(self) -> int:
        return self.clock.cycles

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        self.clock.tick(cycles)
        return cycles

    def read_words(self, at: int, axis: int, count: int) -> tuple[int, ...]:
        return tuple(self.memory.get((k, axis), 0) for k in range(at, at + count))

    def push(self, fifo: int, instruction: Instruction) -> bool:
        if not self.full:
            self.told.append((fifo, instruction))
        return not self.full

    def push_points(self, words: Sequence[int]) -> bool:
        if not self.full:
            self.points += words
        return not self.full

    def clear_fifo(self, fifo: int) -> None:
        self.cleared.append(fifo)

    def read_capture(self, axis: int, most: int) -> tuple[list[int], int]:
        waiting = self.captured.setdefault(axis, [])
        taken, waiting[:most] = waiting[:most], []
        return taken, len(waiting)


def opened(card: Any, **options: Any) -> imclib.IMC_HANDLE:
    """Put a card on the network and return its handle."""
    imclib.attach(card, **options)
    status, handle = imclib.IMC_Open(0, 0)
    assert (status, handle is None) == (imclib.IMC_OK, False)
    assert handle is not None
    return handle


class Program:
    """A program that has opened a card: short ways to call, and to look into the card."""

    def __init__(self, text: str = "ready = true", **options: Any) -> None:
        self.card = Card(parse_card(text))
        self.handle = opened(self.card, **{"clock": None, **options})

    def run(self, cycles: int) -> None:
        """Let whole control cycles pass."""
        left = cycles
        while left > 0:
            left -= self.card.advance(left)

    def ok(self, function: Any, *arguments: Any) -> None:
        """Call a function of the library, and let the card take what it is sent."""
        status = function(self.handle, *arguments)
        assert status == imclib.IMC_OK, status.text

    def set(self, name: str, value: int, axis: int = 0, fifo: int = imclib.SEL_IFIFO) -> None:
        """Write a parameter by name, in its own width."""
        words = PARAMETERS[name].words
        function = (imclib.IMC_SetParam16, imclib.IMC_SetParam32, imclib.IMC_SetParam48)[words - 1]
        self.ok(function, PARAMETERS[name].address, value, axis, fifo)

    def get(self, name: str, axis: int = 0) -> int:
        """Read a parameter by name, in its own width."""
        words = PARAMETERS[name].words
        function = (imclib.IMC_GetParam16, imclib.IMC_GetParam32, imclib.IMC_GetParam48)[words - 1]
        status, value = function(self.handle, PARAMETERS[name].address, axis)
        assert status == imclib.IMC_OK, status.text
        return value

    def until(self, condition: Callable[[], bool], limit: int = 5000) -> int:
        """Let cycles pass until a condition holds, which it must; return how many."""
        for done in range(limit):
            if condition():
                return done
            self.card.advance(1)
        raise AssertionError(f"this has not happened in {limit} cycles")

    def rest(self, *axes: int, limit: int = 100_000) -> int:
        """Let time pass until axes do not move; return the cycles."""
        done = 0
        self.card.advance(1)
        while any(self.card.is_moving(axis) for axis in axes) and done < limit:
            done += self.card.advance(1)
        return done
