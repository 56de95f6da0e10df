"""Sub-programs: where they are found, and where the reading goes on after them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeAlias

from polycnc.errors import UsageError
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.records._block_records import Call
from polycnc.nc.sources._block_source import BlockSource
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText
from polycnc.units import whole

Library: TypeAlias = Callable[[int], ProgramText | None]
"""Where sub-programs come from that are in no file beside the main program: a program by its number, or None."""

_LABEL = re.compile(rb"(?:\A|(?<=[\r\n]))[ \t]*[Oo:][ \t]*0*([0-9]+)")
_DIGITS = 4  # how many digits a program number is usually written with


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


class SavedCall(NamedTuple):
    """Hold a program under way, to go back to, without what its language knows of it."""

    begin: Place
    repeats: int
    back: Back | None
    begun: bool
    round: int


class Calls:
    """Keep the stack of running programs, the main program at the bottom."""

    def __init__(self, main: ProgramText, dialect: Dialect, library: Library | None = None) -> None:
        self._dialect = dialect
        self._library = library
        self._main = main
        self._stack = [Running(Place(main))]
        self._calls: tuple[Call, ...] = ()
        self._labels: dict[str, dict[int, Place]] = {}
        self._files: dict[tuple[Path, int], Place | None] = {}
        self._texts: dict[str, ProgramText] = {}

    @property
    def running(self) -> Running:
        """The program that is being executed."""
        return self._stack[-1]

    @property
    def depth(self) -> int:
        """How deep the present program is nested; 0 is the main program."""
        return len(self._stack) - 1

    @property
    def stack(self) -> tuple[Call, ...]:
        """The calls under way, the outermost first."""
        return self._calls

    def trouble(self, program: int | ProgramText) -> tuple[str, str, str] | None:
        """Return what is against calling a sub-program, what to do about it and its code; None if nothing is.

        Raises:
            UsageError: its file cannot be read.
        """
        deepest = self._dialect.sub_program.depth
        # Calls with arguments have their own limit, which the language watches.
        if sum(running.arguments is None for running in self._stack) > deepest:
            return (
                f"sub-programs are nested more than {deepest} deep",
                f"Dialect '{self._dialect.name}' allows {deepest} levels: does a sub-program call itself?",
                self._code("PS0077"),
            )
        try:
            found = self._find(program)
        except UsageError as error:
            return error.what, error.hint, ""
        if found is None:
            return (
                f"there is no sub-program {program}",
                f"Write it behind the program, beginning with O{program}, or in a file O{program} beside it.",
                self._code("PS0078"),
            )
        return None

    def _code(self, code: str) -> str:
        """Return the number that controls with custom macros give an error; others have none here."""
        return code if self._dialect.language == "macro" else ""

    def enter(self, program: int | ProgramText, repeats: int, back: Back, arguments: object = None) -> bool:
        """Begin a sub-program that `trouble` had nothing against; False for no repeats."""
        begin = self._find(program)
        assert begin is not None
        if repeats < 1:
            return False
        self._stack.append(Running(begin, repeats - 1, back, arguments=arguments))
        self._note_calls()
        return True

    def leave(self) -> Back | None:
        """End the present round of the present program.

        Return where the reading goes on, None where the program begins anew (`running.begun` is False then).
        """
        running = self.running
        if running.source is not None:
            running.source.close()
            running.source = None
        running.begun = False
        if running.repeats > 0:
            running.repeats -= 1
            running.round += 1
            self._note_calls()
            return None
        self._stack.pop()
        self._note_calls()
        return running.back

    @property
    def under_way(self) -> tuple[Running, ...]:
        """The programs under way, the main program first."""
        return tuple(self._stack)

    def snapshot(self) -> tuple[SavedCall, ...]:
        """Return the programs under way, to go back to."""
        return tuple(
            SavedCall(each.begin, each.repeats, each.back, each.begun, each.round) for each in self._stack
        )

    def restore(self, stack: tuple[SavedCall, ...], texts: Iterable[ProgramText]) -> None:
        """Go back to a snapshot; `texts` are those that were read until then.

        What a language knows of the programs is put into `under_way` by who knows it.
        """
        self._stack = [Running(each.begin, each.repeats, each.back, each.begun, each.round) for each in stack]
        self._main = stack[0].begin.text
        self._labels.clear()
        self._files.clear()
        self._texts = {text.name: text for text in texts} | {
            each.begin.text.name: each.begin.text for each in stack
        }
        self._note_calls()

    def close(self) -> None:
        """End all programs."""
        for running in reversed(self._stack):
            if running.source is not None:
                running.source.close()
                running.source = None

    def _note_calls(self) -> None:
        calls: list[Call] = []
        for running in self._stack[1:]:
            back = running.back
            assert back is not None
            calls += [*back.within, Call(back.place.text.name, back.line, running.round)]
        self._calls = tuple(calls)

    def text_of(self, program: int) -> ProgramText | None:
        """Return the text that a sub-program stands in, None if there is none."""
        try:
            place = self._find(program)
        except UsageError:
            return None
        return None if place is None else place.text

    def _find(self, program: int | ProgramText) -> Place | None:
        """Return where a sub-program begins: in the present file, the main file, the library or a file of its own."""
        if isinstance(program, ProgramText):
            return Place(self._known(program))
        for text in (self.running.begin.text, self._main):
            if text.name not in self._labels:
                self._labels[text.name] = _labels(text)
            if program in self._labels[text.name]:
                return self._labels[text.name][program]
        if self._library is not None:
            found = self._library(program)
            if found is not None:
                return Place(self._known(found))
        main = Path(self._main.name)
        if not main.is_file():
            return None  # a text from elsewhere has no folder
        key = (main.parent, program)
        if key not in self._files:
            self._files[key] = self._own_file(main, program)
        return self._files[key]

    def _own_file(self, main: Path, program: int) -> Place | None:
        digits = f"{program:0{_DIGITS}d}"
        for name in (f"O{digits}", f"O{program}", f"o{digits}", f"o{program}", digits, f"{program}"):
            for extension in dict.fromkeys((main.suffix, "", *self._dialect.extensions)):
                path = main.parent / f"{name}{extension}"
                if path.is_file():
                    return Place(self._known(ProgramText.from_path(path)))
        return None

    def _known(self, text: ProgramText) -> ProgramText:
        """Return a text as one object: the one that is known already where it says the same."""
        known = self._texts.get(text.name)
        if known is not None and (known is text or known.content == text.content):
            return known
        self._texts[text.name] = text
        return text


def _labels(text: ProgramText) -> dict[int, Place]:
    """Return where the programs of a file begin, by number; the first of a number counts."""
    found: dict[int, Place] = {}
    for match in _LABEL.finditer(text.content):
        number = whole(match[1])
        if number not in found:
            position = text.position(match.start())
            found[number] = Place(text, match.start(), position.line)
    return found
