"""The programs under way: calls of sub-programs, returns from them, and the languages that execute them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from polycnc.errors import ProgramError, UsageError
from polycnc.machine import SnapshotError
from polycnc.nc.blocks._outcomes import Problem
from polycnc.nc.channel._errors import Errors
from polycnc.nc.channel._reader import Reader
from polycnc.nc.channel._running import Back, Running, SavedCall
from polycnc.nc.channel._sub_programs import SubPrograms
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.records._block_records import Call
from polycnc.nc.sources._block_source import (
    BoundedLanguage,
    BoundLanguage,
    CallProgram,
    Language,
    LastingLanguage,
    Returning,
    SearchingLanguage,
    TidyLanguage,
)
from polycnc.nc.text._incoming import IncomingText
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText

_WHERE = (
    "Write it after the program, beginning with O{program}, or in a file O{program} beside it; "
    "--ignore M98,G65 leaves all calls out."
)


class Calls:
    """Keep the stack of running programs, the main program at the bottom, and let `reader` read the present one.

    `running` is the program that is being executed. `stack` are the calls that led to what is prepared now, the
    outermost first; `within` are those among them that the source of the present program has made by itself.
    """

    def __init__(
        self,
        main: ProgramText,
        dialect: Dialect,
        programs: SubPrograms,
        language: Language | None,
        reader: Reader,
        errors: Errors,
    ) -> None:
        self._dialect = dialect
        self._incoming = main if isinstance(main, IncomingText) else None
        self._programs = programs
        self._language = language
        self._reader = reader
        self._errors = errors
        self._refused: dict[tuple[str, int], Problem] = {}
        self._all = [Running(Place(main.opening))]
        self._entered: tuple[Call, ...] = ()
        self.running = self._all[0]
        self.bounds = MainBounds(self.running, language)
        self.within: tuple[Call, ...] = ()
        self.stack: tuple[Call, ...] = ()

    @property
    def depth(self) -> int:
        """How deep the present program is nested; 0 is the main program."""
        return len(self._all) - 1

    def text_of(self, program: int) -> ProgramText | None:
        """Return the text that a sub-program stands in, None if there is none."""
        try:
            place = self._find(program)
        except UsageError:
            return None
        return None if place is None else place.text

    def begin(self) -> None:
        """Begin the present program, or its next round."""
        self.go_within(())
        running, language = self.running, self._language
        begin = running.begin
        if language is not None:
            try:
                running.source = language.source(begin.text, begin.offset, begin.line, running.arguments)
            except ProgramError as error:
                self._errors.note(error)
        self._reader.word_values = running.word_values
        if running.source is not None:
            self._reader.jump(begin, begin.offset)  # no text for now
        elif self.depth or language is not None or self.bounds.is_cut:
            self._reader.jump(begin, len(begin.text) if self.depth else self.bounds.end)

    @property
    def has_language(self) -> bool:
        """Whether a language may execute programs."""
        return self._language is not None

    @property
    def is_coming(self) -> bool:
        """Whether more of the main program, which is the present one, waits or may still come."""
        return self._incoming is not None and self.depth == 0 and not self._incoming.over

    @property
    def has_come(self) -> bool:
        """Whether a piece of the main program waits to be read."""
        return self._incoming is not None and self._incoming.waiting > 0

    def take_piece(self) -> bool:
        """Go on with what has come of the main program; False while nothing has.

        Where a language or a cycle might look beyond its line, each line is a piece: how the program was cut when it
        came makes no difference then.
        """
        incoming, running = self._incoming, self.running
        assert incoming is not None
        piece = incoming.take(one_line=self.has_language or self._dialect.reads_contours)
        if piece is None:
            return False
        if isinstance(self._language, TidyLanguage):
            self._language.tidy()
        running.begin = Place(piece, 0, piece.first_line)
        self.begin()
        if running.source is None:
            self._reader.jump(running.begin, len(piece))
        return True

    def end_piece(self) -> None:
        """Leave the source of a piece of the main program that has come to its end."""
        _close(self.running)
        self._reader.word_values = None

    def target(self, line: int) -> Place:
        """Return the place of a line of the main program, to begin there.

        Raises:
            UsageError: a language is executing the program.
        """
        if self.running.source is not None:
            raise UsageError("a block of a program with statements cannot be searched", hint="Start it anew.")
        text = self.running.begin.text
        return Place(text, text.line_start(line), line)

    def begin_at(self, place: Place) -> None:
        """Begin the main program at a line instead of its first.

        Raises:
            UsageError: a language executes the program, and cannot begin there.
        """
        running = self.running
        begin = running.begin
        if place.offset == begin.offset:
            self.begin()
            return
        running.begun = True
        if isinstance(self._language, SearchingLanguage):
            try:
                running.source = self._language.source_at(begin.text, begin.offset, begin.line, place.offset)
            except ProgramError as error:
                raise UsageError(error.what, hint=error.hint) from error
            self._reader.word_values = running.word_values
            if running.source is not None:
                self._reader.jump(begin, begin.offset)  # no text for now
                return
        self._reader.jump(place, self.bounds.end)

    def enter(self, program: int | ProgramText, repeats: int, line: int, arguments: object = None) -> None:
        """Begin a sub-program that can be called, from `line`; nothing for no repeats."""
        if repeats < 1:
            return
        begin = self._find(program)
        assert begin is not None
        back = Back(self._reader.here, self._reader.end, line, self.within)
        self._all.append(Running(begin, repeats - 1, back, arguments=arguments))
        self._note_calls()
        self.begin()

    def call(self, text: ProgramText, call: CallProgram) -> None:
        """Begin the sub-program that the source of the present program calls.

        Raises:
            ProgramError: it cannot be called.
        """
        problem = self.problem(call.program, text, call.offset) if call.repeats > 0 else None
        if problem is not None:
            what, hint, code = problem
            raise ProgramError(what, position=text.position(call.offset), hint=hint, code=code)
        self.enter(call.program, call.repeats, call.line, call.arguments)

    def leave(self) -> bool:
        """End the present round of a sub-program and go on after it; False in the main program."""
        running = self.running
        if running.back is None:
            return False
        _close(running)
        running.begun = False
        if running.repeats > 0:
            running.repeats -= 1
            running.round += 1
            self._note_calls()
            self.begin()
            return True
        self._all.pop()
        self._note_calls()
        self.go_within(running.back.within)
        self._reader.jump(running.back.place, running.back.end)
        return True

    def go_within(self, calls: tuple[Call, ...]) -> None:
        """Take note of the calls that the source of the present program has made by itself."""
        self.within = calls
        self.stack = self._entered + calls

    def failed(self) -> None:
        """Let the source of the present program take note of an error."""
        if self.running.source is not None:
            self.running.source.failed()

    def close(self) -> None:
        """End all programs."""
        for running in reversed(self._all):
            _close(running)
        if self._incoming is not None:
            self._incoming.close()

    def _note_calls(self) -> None:
        self.running = self._all[-1]
        self._reader.word_values = self.running.word_values
        calls: list[Call] = []
        for running in self._all[1:]:
            back = running.back
            assert back is not None
            calls += [*back.within, Call(back.place.text.name, back.line, running.round)]
        self._entered = tuple(calls)
        self.stack = self._entered + self.within

    def problem(self, program: int | ProgramText, text: ProgramText, offset: int) -> Problem | None:
        """Return what is against a call that stands at byte `offset` of `text`, None if nothing is.

        Where errors are collected, a call that has been refused once is so ever after: a program that calls itself k
        times would else be gone through k to the power of the depth times.
        """
        site = (text.name, offset)
        problem = self._refused.get(site) or self._problem_of(program)
        if problem is not None and self._errors.collects:
            self._refused[site] = problem
        return problem

    def _problem_of(self, program: int | ProgramText) -> Problem | None:
        deepest = self._dialect.sub_program.depth
        # Calls with arguments have their own limit, which the language watches.
        if sum(running.arguments is None for running in self._all) > deepest:
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
                _WHERE.format(program=program),
                self._code("PS0078"),
            )
        return None

    def _code(self, code: str) -> str:
        """Return the number that controls with custom macros give an error; others have none here."""
        return code if self._dialect.language == "macro" else ""

    def _find(self, program: int | ProgramText) -> Place | None:
        return self._programs.find(program, self.running.begin.text)

    # ------------------------------------------------------------------ going back

    def snapshot(self) -> tuple[SavedCall, ...]:
        """Return the programs under way, to go back to."""
        return tuple(
            SavedCall(each.begin, each.repeats, each.back, each.begun, each.round) for each in self._all
        )

    def language_state(self) -> object:
        """Return what the language says of itself and of the programs under way.

        Raises:
            SnapshotError: it cannot tell where they stand.
        """
        under_way = [(each.arguments, each.source) for each in self._all]
        if isinstance(self._language, LastingLanguage):
            return self._language.save(under_way)
        if any(source is not None for _, source in under_way):
            raise SnapshotError(
                "a program with statements is under way, whose language cannot tell where it is",
                hint="Take the snapshot before or after it.",
            )
        return None

    def attach(self, host: object) -> None:
        """Let the language work for a channel."""
        if self._language is not None and isinstance(self._language, BoundLanguage):
            self._language.attach(host)

    def restore_point(self, host: object, saved: object) -> Callable[[], None]:
        """Return what the language does last when its programs go back to a state; nothing changes yet.

        Raises:
            SnapshotError: a program of it cannot go on from there.
        """
        returning: Returning | None = None
        if isinstance(self._language, LastingLanguage):
            returning = self._language.restore_point(host, saved)
        elif saved is not None:
            raise SnapshotError(
                "the program under way needs its language", hint="Restore it where it was taken."
            )
        return lambda: self._take_up(returning)

    def _take_up(self, returning: Returning | None) -> None:
        if returning is not None:
            for running, (arguments, source) in zip(self._all, returning(), strict=True):
                running.arguments, running.source = arguments, source
        self._reader.word_values = self.running.word_values

    def restore(
        self, saved: tuple[SavedCall, ...], within: tuple[Call, ...], texts: Iterable[ProgramText]
    ) -> None:
        """Go back to a snapshot; `texts` are those that were read until then."""
        self._all = [Running(each.begin, each.repeats, each.back, each.begun, each.round) for each in saved]
        self._programs.restore(saved[0].begin.text, (*texts, *(each.begin.text for each in saved)))
        self.within = within
        self._note_calls()


def _close(running: Running) -> None:
    if running.source is not None:
        running.source.close()
        running.source = None


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
