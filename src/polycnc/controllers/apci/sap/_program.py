"""A compiled SAP program: plain data, the same whether it was just compiled or read from a .CNC file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

Cells: TypeAlias = tuple[tuple[str, int], ...]
"""Kinds of memory cells with how many of each follow one another."""

Instruction: TypeAlias = tuple[str, Any, int]
"""Operation, its argument (None, a number, a text, a list) and its line in the source."""

_INITIAL: dict[str, int | float | bool] = {"i": 0, "d": 0.0, "b": False}


@dataclass(frozen=True, slots=True)
class Entry:
    """Where a routine begins, how many parameters it takes and which cells it adds."""

    start: int
    parameters: int
    cells: Cells


@dataclass(frozen=True, slots=True)
class Program:
    """A program for one task: its variables, instructions, routines, and events (condition, handler).

    `events` are (index of the first instruction of the condition, index of the handler's routine).
    """

    name: str
    task: int
    variables: Cells
    code: tuple[Instruction, ...]
    routines: tuple[Entry, ...]
    events: tuple[tuple[int, int], ...]


def cell_values(cells: Cells) -> list[int | float | bool]:
    """Return the cells as a list of zeros of their kinds."""
    return [_INITIAL[kind] for kind, count in cells for _ in range(count)]
