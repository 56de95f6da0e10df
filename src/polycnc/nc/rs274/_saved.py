"""What a snapshot keeps of RS274/NGC: parameters, and where each program under way stands."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.nc.records._block_records import Call
from polycnc.nc.text._program import ProgramText


@dataclass(frozen=True, slots=True)
class SavedLevel:
    """Hold a program or sub-program (`label`) of a file: its own parameters, the line of Python and its names.

    The line is 0 before the first, None at the end.
    """

    text: ProgramText
    offset: int
    label: str
    numbered: tuple[float, ...]
    named: dict[str, float]
    calls: tuple[Call, ...]
    line: int | None
    names: dict[str, object]
    kept: tuple[tuple[tuple[str, float], ...], ...]
    goes_back: tuple[int, int, int] | None
    shares: bool


@dataclass(frozen=True, slots=True)
class SavedProgram:
    """Hold one execution: its levels, the outermost first, and the blocks that put kept modes in force again."""

    levels: tuple[SavedLevel, ...]
    pauses: int
    over: bool
    back: tuple[tuple[tuple[tuple[str, float, int], ...], int, int, tuple[Call, ...]], ...]
    calls: int


@dataclass(frozen=True, slots=True)
class SavedLanguage:
    """Hold what programs have set, by number and by name, and the programs under way."""

    common: dict[int, float]
    others: dict[int, float]
    names: dict[str, float]
    level: int
    under_way: tuple[SavedProgram | None, ...]


SAVED_CLASSES = (SavedLanguage, SavedProgram, SavedLevel)
