"""A control file that records what its macros are called with, in place of one that writes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast

from polycnc.post import ControlFile, PostSummary, ToolPath, parse_tool_path, post_program
from polycnc.post.macros._control_parameters import Parameters
from polycnc.post.macros._events import MACROS

Call = tuple[str, dict[str, float | str]]


@dataclass
class RecordingControl:
    """Has every macro but those in `without`, and keeps the calls."""

    parameters: Parameters = field(default_factory=Parameters)
    without: frozenset[str] = frozenset()
    calls: list[Call] = field(default_factory=list)
    variables: frozenset[str] = frozenset()
    file: str = "recording"
    write: Any = None

    def has(self, macro: str) -> bool:
        """Tell whether there is a macro."""
        return macro in MACROS - self.without

    def uses(self, macro: str, word: str) -> bool:
        """Tell whether a macro uses a word: each does."""
        return True

    def start(self, write: Any) -> RecordingControl:
        """Begin a program."""
        self.write = write
        return self

    def names(self, word: str) -> bool:
        """Tell whether any macro uses a word: one does."""
        return True

    def keep(self, words: Mapping[str, float | str]) -> None:
        """Take words that hold in every macro: tests of their own look at them."""

    def forget(self, names: Any) -> None:
        """Let the next output not be omitted."""

    def call(self, macro: str, words: Mapping[str, float | str] = {}) -> None:
        """Keep a call."""
        if self.has(macro):
            self.calls.append((macro, dict(words)))
            if macro == "WORK_OFFSET":  # has to write something
                self.write("")


def calls_of(
    text: str | ToolPath, without: tuple[str, ...] = (), **parameters: Any
) -> tuple[list[Call], PostSummary]:
    """Return the macros that a tool path calls, with their words, and the summary."""
    control = RecordingControl(Parameters(**parameters), frozenset(without))
    tool_path = parse_tool_path(text, "part.cl") if isinstance(text, str) else text
    summary = post_program(tool_path, cast(ControlFile, control), lambda text: None)
    return control.calls, summary


def moves_of(text: str, without: tuple[str, ...] = (), **parameters: Any) -> list[tuple[str, dict[str, Any]]]:
    """Return only the calls that move the tool."""
    moving = ("RAPID", "LINEAR", "ARC", "CYCLE")
    return [call for call in calls_of(text, without, **parameters)[0] if call[0].startswith(moving)]


def points_of(moves: list[tuple[str, dict[str, Any]]]) -> list[tuple[str, float, float, float]]:
    """Return what moves where."""
    return [(macro, words["X"], words["Y"], words["Z"]) for macro, words in moves if "X" in words]
