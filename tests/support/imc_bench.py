"""A card that a program works with, and what every word of its memory does meanwhile, as text.

A line of each parameter: the integer that it is at the end of each step, how often it changes, and the sum over the
cycles, each integer times the number of its cycle.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.core._parameters import PARAMETERS, Parameter
from support.imc_network import Program


def numbers(each: Parameter, memory: npt.NDArray[np.int16]) -> list[int]:
    """Return what a parameter is in each of some copies of memory, as integers."""
    words = memory[:, each.address : each.address + each.words].astype(np.int64) % 65536
    raw = (words << 16 * np.arange(each.words)).sum(axis=1)
    half = 1 << 16 * each.words - 1
    return [int(one - 2 * half if each.is_signed and one >= half else one) for one in raw]


def written_down(
    name: str, scope: str, memory: list[npt.NDArray[np.int16]], ends: list[int], *, constants: bool = False
) -> str:
    """Return what the parameters of the card or of an axis have done in a scene; `constants` too if they are not 0."""
    lines, copies = [f"# {name}"], np.stack(memory)
    for each in PARAMETERS.values():
        if each.scope != scope:
            continue
        values = numbers(each, copies)
        changes = sum(a != b for a, b in pairwise(values))
        if changes == 0 and ((each.access != "ro" and not constants) or values[0] == 0):
            continue
        if changes == 0 and constants:
            lines.append(f"{each.name} {values[0]}")
            continue
        total = sum(k * one for k, one in enumerate(values, 1))
        lines.append(f"{each.name} {' '.join(str(values[end - 1]) for end in ends)} / {changes} / {total}")
    return "\n".join([*lines, ""])


class Bench:
    """A program with a card: `step` lets cycles pass and keeps the memory, everything else is a call of the library."""

    def __init__(self, text: str) -> None:
        self.program = Program(text)
        self.card = self.program.card
        self.memory: list[npt.NDArray[np.int16]] = []
        self.ends: list[int] = []
        self.answers: list[str] = []

    def __getattr__(self, name: str) -> Callable[..., Any]:
        """Return a function of the library for this card; what it answers but IMC_OK is written down."""
        function = getattr(imclib, f"IMC_{name}")

        def call(*arguments: Any) -> None:
            answer = function(self.program.handle, *arguments)
            if answer != imclib.IMC_OK:
                values = answer[1:] if isinstance(answer, tuple) and answer[0] == imclib.IMC_OK else answer
                self.answers.append(f"{name}: {values}")

        return call

    def set(self, fifo: int = imclib.SEL_IFIFO, /, axis: int = 0, **values: float) -> None:
        """Write parameters by name, in their units."""
        for name, value in values.items():
            self.program.set(name, PARAMETERS[name].to_raw(value), axis, fifo)

    def set_any(self, each: Parameter, raw: int, axis: int, fifo: int) -> None:
        """Write an integer to a parameter in its width; what the library answers but IMC_OK is written down."""
        half = 1 << 16 * each.words - 1
        getattr(self, f"SetParam{16 * each.words}")(
            each.address, (raw + half) % (2 * half) - half, axis, fifo
        )

    def step(self, cycles: int) -> None:
        """Let cycles pass."""
        for _ in range(cycles):
            self.card.advance(1)
            self.memory.append(np.array(self.card.state.memory))
        self.ends.append(len(self.memory))

    def leap(self, cycles: int) -> None:
        """Let cycles pass and keep the memory at their end alone, which costs less."""
        self.card.advance(cycles)
        self.memory.append(np.array(self.card.state.memory))
        self.ends.append(len(self.memory))

    def text(self) -> str:
        """Return what the memory has done, and what the library has answered."""
        axes = self.card.axes
        parts = [written_down("card", "G", [each[axes] for each in self.memory], self.ends, constants=True)]
        for axis in range(axes):
            copies = [each[axis] for each in self.memory]
            parts.append(written_down(f"axis {axis}", "A", copies, self.ends, constants=True))
        return "".join([*parts, "# answers\n", *(f"{each}\n" for each in self.answers)])
