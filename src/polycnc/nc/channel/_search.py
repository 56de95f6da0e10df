"""The search of a block by carrying out what stands before it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from polycnc.errors import UsageError
from polycnc.machine import SnapshotError
from polycnc.nc.channel._calls import Calls
from polycnc.nc.channel._reader import Reader
from polycnc.nc.sources._block_source import (
    CallProgram,
    Drain,
    FastForwardLanguage,
    Language,
    Pause,
    SourceItem,
    Statement,
    TextSpan,
    WordsBlock,
)
from polycnc.nc.text._place import Place

_MOST_IDLE_TURNS = 100  # of a calculated search without a block: nothing ends its wait or loop


class Search:
    """Seek `place`, the beginning of a line of the main program, None while nothing is sought.

    `held` is what the source of the main program has given of the block sought: it comes next.
    """

    def __init__(self, calls: Calls, reader: Reader, language: Language | None) -> None:
        self.place: Place | None = None
        self.held: SourceItem | None = None
        self._calls = calls
        self._reader = reader
        self._language: FastForwardLanguage | None = None
        if language is not None and isinstance(language, FastForwardLanguage):
            self._language = language
        self._idle = 0
        self._before = (-1, -1)

    @contextmanager
    def of(self, place: Place) -> Iterator[None]:
        """Seek a place; no time passes meanwhile for programs that wait for it."""
        self.place = place
        self._idle, self._before = 0, (-1, -1)
        self._fast_forward(True)
        try:
            yield
        finally:
            self.place = None
            self._fast_forward(False)

    def begin(self) -> None:
        """Read no more than what stands before the place; the program has begun."""
        if self.place is not None and self._calls.running.source is None:
            # A language that leaves the program to the reader has let it scan beyond the place.
            self._reader.jump(self._calls.running.begin, self.place.offset)

    @property
    def active(self) -> bool:
        """Whether a block is sought."""
        return self.place is not None

    @property
    def in_main_program(self) -> bool:
        """Whether a block is sought and blocks of the main program are read."""
        return self.place is not None and self._calls.depth == 0

    @property
    def found(self) -> bool:
        """Whether all that stands before the place has been prepared."""
        if not self.in_main_program or not self._reader.at_end:
            return False
        if self._calls.running.source is not None:
            return self.held is not None
        return self.place is None or self._reader.place.offset >= self.place.offset

    def check(self) -> None:
        """Look whether preparation has come on since this was asked last.

        Raises:
            UsageError: statements wait or loop without end.
        """
        now = self._reader.blocks, self._calls.depth
        self._idle, self._before = self._idle + 1 if now == self._before else 0, now
        if self._language is not None and not self._idle:
            self._language.moves_on()
        endless = self._language is not None and self._idle > 0 and self._language.loops()
        if self._idle > _MOST_IDLE_TURNS or endless:
            line = 0 if self.place is None else self.place.line
            raise UsageError(
                f"the program waits or loops without a block before line {line}",
                hint="Let it look at the search (SD(13) of a Typ3 osa or PNC), or search another block.",
            )

    def next_item(self) -> SourceItem | None:
        """Return what the source of the present program gives next, a pause where the block sought begins.

        Raises:
            ProgramError: a statement cannot be executed.
        """
        source = self._calls.running.source
        assert source is not None
        item, self.held = (source.next() if self.held is None else self.held), None
        self._calls.running.begun = True
        if self.place is not None and self._calls.depth == 0:
            return self._before_sought(item, self.place)
        return item

    def _before_sought(self, item: SourceItem | None, place: Place) -> SourceItem | None:
        """Return what of an item stands before the block sought, and hold the rest; a pause if nothing does."""
        if not isinstance(item, WordsBlock | TextSpan | Drain | Statement | CallProgram) or (
            not isinstance(item, CallProgram) and (item.calls or (item.text or place.text) is not place.text)
        ):
            return item
        if isinstance(item, TextSpan) and item.offset < place.offset < item.end:
            self.held = replace(item, offset=place.offset, line=place.line)
            return replace(item, end=place.offset)
        if item.line == place.line:
            self.held = item
            return Pause.PAUSE
        return item

    def refuse_held(self) -> None:
        """Refuse a snapshot between the search and the start.

        Raises:
            SnapshotError: a block of a program with statements has been searched.
        """
        if self.held is not None:
            raise SnapshotError(
                "a block of a program with statements has been searched",
                hint="Take the snapshot after its start.",
            )

    def _fast_forward(self, on: bool) -> None:
        if self._language is not None:
            self._language.fast_forward = on
