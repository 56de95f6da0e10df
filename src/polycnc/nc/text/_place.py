"""A place in a program text."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.nc.text._program import ProgramText


@dataclass(frozen=True, slots=True)
class Place:
    """Say where the reading of a program stands: at the line that begins at byte `offset`."""

    text: ProgramText
    offset: int = 0
    line: int = 1
