"""Where a searched main program begins and ends."""

from __future__ import annotations

from polycnc.errors import ProgramError, UsageError
from polycnc.nc.channel._running import Running
from polycnc.nc.sources._block_source import BoundedLanguage, Language
from polycnc.nc.text._program import ProgramText


class MainBounds:
    """The part of the program `main` that is executed; `language` is notified."""

    def __init__(self, main: Running, language: Language | None) -> None:
        self._main = main
        self._language = language
        self._end: int | None = None

    @property
    def is_cut(self) -> bool:
        """Whether it ends before its end."""
        return self._end is not None

    @property
    def end(self) -> int:
        """The byte after the last one that is executed."""
        return len(self._main.begin.text) if self._end is None else self._end

    def set(self, first: int, last: int) -> None:
        """Let the program, which has not begun, be searched for line `first` and end after line `last` (0: its end).

        Raises:
            UsageError: A language executes it that cannot end there.
        """
        text = self._main.begin.text
        if last:
            self._end = text.next_line(text.line_start(last))
        if isinstance(self._language, BoundedLanguage):
            self._language.begin_between(first, last)
        elif last and self._language is not None:
            _refuse_source(self._language, text)


def _refuse_source(language: Language, text: ProgramText) -> None:
    try:
        source = language.source(text, 0, 1, None)
    except ProgramError:
        return  # said when it begins
    if source is not None:
        source.close()
        hint = "Search its beginning alone."
        raise UsageError("a program with statements cannot end at a block that is given", hint=hint)
