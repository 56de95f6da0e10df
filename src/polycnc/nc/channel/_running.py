"""A program that is being executed, and where the reading goes on after it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple, cast

from polycnc.nc.records._block_records import Call
from polycnc.nc.sources._block_source import BlockSource, OpenSource, WordValues
from polycnc.nc.text._place import Place


@dataclass(frozen=True, slots=True)
class Back:
    """Say where the reading goes on after a sub-program: `end` is where that text ends; and which line called.

    `within` are calls that the source of the calling program had made by itself.
    """

    place: Place
    end: int
    line: int
    within: tuple[Call, ...] = ()


@dataclass
class Running:
    """Hold a program that is being executed, and where to go back to.

    `begun` is set with its first word: from there on, % or another program number ends it. `repeats` are still to
    come, `round` is the present one. `source` gives its blocks where a language executes it.
    """

    begin: Place
    repeats: int = 0
    back: Back | None = None
    begun: bool = False
    round: int = 1
    arguments: object = None
    source: BlockSource | None = None

    @property
    def word_values(self) -> WordValues | None:
        """What words without a number stand for in its text."""
        source = self.source
        if source is None or not _is_open(type(source)):
            return None
        return cast("OpenSource", source).word_values


@cache
def _is_open(source: type) -> bool:
    """Tell whether sources of a class know values of words; to ask a protocol costs more than a call does."""
    return hasattr(source, "word_values")


class SavedCall(NamedTuple):
    """Hold a program under way, to go back to, without what its language knows of it."""

    begin: Place
    repeats: int
    back: Back | None
    begun: bool
    round: int
