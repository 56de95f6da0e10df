"""Where sub-programs are found: in the present file, the main file, a library, or a file of their own."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TypeAlias

from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText
from polycnc.units import whole

Library: TypeAlias = Callable[[int], ProgramText | None]
"""Where sub-programs come from that are in no file beside the main program: a program by its number, or None."""

_LABEL = re.compile(rb"(?:\A|(?<=[\r\n]))[ \t]*[Oo:][ \t]*0*([0-9]+)")
_DIGITS = 4  # how many digits a program number is usually written with


class SubPrograms:
    """Find the sub-programs of a main program; each text is one object, however often it is found."""

    def __init__(self, main: ProgramText, dialect: Dialect, library: Library | None) -> None:
        self._main = main.opening
        self._is_coming = main.opening is not main
        self._extensions = dialect.extensions
        self._library = library
        self._labels: dict[str, dict[int, Place]] = {}
        self._files: dict[tuple[Path, int], Place | None] = {}
        self._texts: dict[str, ProgramText] = {}

    def find(self, program: int | ProgramText, present: ProgramText) -> Place | None:
        """Return where a sub-program begins that a block of `present` calls, None if there is none.

        Raises:
            UsageError: its file cannot be read.
        """
        if isinstance(program, ProgramText):
            return Place(self._known(program))
        for text in (present, self._main):
            if self._is_coming and text.name == self._main.name:
                continue  # nothing of it can be found again
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

    def restore(self, main: ProgramText, texts: Iterable[ProgramText]) -> None:
        """Go back to where only these texts were known."""
        self._main = main
        self._labels.clear()
        self._files.clear()
        self._texts = {text.name: text for text in texts}

    def _own_file(self, main: Path, program: int) -> Place | None:
        digits = f"{program:0{_DIGITS}d}"
        for name in (f"O{digits}", f"O{program}", f"o{digits}", f"o{program}", digits, f"{program}"):
            for extension in dict.fromkeys((main.suffix, "", *self._extensions)):
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
