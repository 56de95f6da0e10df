"""CPL as a language of the channel: what its programs yield, as items of the block source."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

from polycnc.errors import ProgramError
from polycnc.language import Traced, standing
from polycnc.machine import SnapshotError
from polycnc.nc.cpl._bounds import Bounds
from polycnc.nc.cpl._code_calls import NO_CODES, CodeCalls, CodeWord
from polycnc.nc.cpl._cpl_state import (
    CPL_CLASSES,
    MadeObjects,
    Objects,
    SavedCalled,
    SavedCpl,
    SavedProgram,
    Standing,
    damaged,
    kept_names,
    restore_state,
)
from polycnc.nc.cpl._host import Event, Host, KeepingHost, Lines, NcValues, Step, SubProgram, Waiting
from polycnc.nc.cpl._link_table import LinkTables
from polycnc.nc.cpl._loops import LoopWatch, WatchedHost
from polycnc.nc.cpl._open_lines import BracketWords, line_words
from polycnc.nc.cpl._program import Linker, holds_cpl
from polycnc.nc.cpl._run import Arguments, Called, Execution, undeclared
from polycnc.nc.cpl._wait import Wait
from polycnc.nc.sources._block_source import (
    BlockSource,
    CallProgram,
    Drain,
    Pause,
    Returning,
    SourceItem,
    Statement,
    TextSpan,
    WordsBlock,
)
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import STATEMENT
from polycnc.nc.text._scan_plain import Word, scan_block

_LINE_END = re.compile(rb"\r\n|\r|\n")
_STATEMENT = re.compile(r"[ \t]*[0-9.@#](?![0-9]*[ \t]*WAIT)")
_STATEMENTS = 256  # so many, then time passes: a loop may hold no block


class CplLanguage:
    """Run CPL programs in a channel; one object is one run, whose global variables it holds in `globals`.

    Blocks of a level in `skip_levels` are left out. What linking finds out is kept in `tables`;
    `codes` are those that call programs.
    """

    def __init__(
        self,
        host: Host,
        *,
        skip_levels: frozenset[int] = frozenset(),
        stepping: bool = False,
        tables: LinkTables | None = None,
        codes: CodeCalls = NO_CODES,
    ) -> None:
        self.globals: dict[str, Any] = {}
        self.codes = codes
        self.modal: SubProgram | None = None
        """The call that is made after every move."""
        self.linker = Linker(host.program, stepping=stepping, opened=True, tables=tables, codes=codes)
        self.running: list[CplSource] = []
        """The sources under way, that of the main program first."""
        self.fast_forward = False
        """Whether a WAIT is over at once: a block is sought, and no time passes."""
        self.at_line: Callable[[str, int], bool] | None = None
        """What tells a debugger's wish to stand before a line, of programs linked for stepping."""
        self._control = host
        self._host = WatchedHost(host)
        self._loop = LoopWatch()
        self._skip_levels = skip_levels
        self._bounds: Bounds | None = None
        self.shows_statements = stepping
        """Whether statements are reported to who runs the channel."""

    def begin_between(self, first: int, last: int) -> None:
        """Let the main program that comes next look out for line `first`, and end after line `last` (0: its last)."""
        self._bounds = Bounds(first, last)

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> CplSource | None:
        """Return the source of a program, None for one without CPL.

        Raises:
            ProgramError: It, or a sub-program of it, is wrong; this is the link step.
        """
        called = arguments if isinstance(arguments, Called) else None
        bounds, self._bounds = self._bounds, None
        if called is None and not self.running:
            self.linker.stepping = self.shows_statements or bounds is not None
            self.linker.look_again()
        if offset or (called is None and not holds_cpl(text.content, self.linker.alone)):
            return None
        if called is None:
            if not self.running:
                self.globals.clear()
                self.modal = None
            main, errors = self.linker.link(_decoded(text.content), text.name)
            if main is None:
                raise errors[0]
            called = Called(main, Arguments())
        try:
            execution = Execution(called.program, self.linker, self._host, self.globals, called.arguments)
        except ProgramError:
            self.linker.refuse(called.program)
            raise
        source = CplSource(text, execution, self, modal=called.modal, bounds=bounds)
        self.running.append(source)
        return source

    # Where it stands

    @property
    def classes(self) -> Sequence[type]:
        """The classes of which its state is made."""
        return CPL_CLASSES

    def save(self, under_way: Sequence[tuple[object, BlockSource | None]]) -> SavedCpl:
        """Return its state; permanent variables are in it while a program is under way.

        Raises:
            SnapshotError: A program waits for an answer, or the control has something under way.
        """
        objects = Objects()
        if self.running and isinstance(self._control, KeepingHost) and (what := self._control.under_way()):
            raise SnapshotError(f"a CPL program is under way and {what}", hint="take the snapshot later")
        permanent = self._host.permanent if self.running else {}
        plain = objects.plain
        programs = tuple(
            (
                _saved_call(arguments, objects),
                source.saved(objects) if isinstance(source, CplSource) else None,
            )
            for arguments, source in under_way
        )
        both = self.globals, permanent
        shared, kept = ({name: plain(value) for name, value in variables.items()} for variables in both)
        return SavedCpl(objects.all(), shared, kept, self.modal, programs)

    def restore_point(self, channel: object, saved: object) -> Returning:
        """Return what goes back to a state; nothing changes yet.

        Raises:
            SnapshotError: A program of the state has been changed since, or cannot go on from there.
        """
        if not isinstance(saved, SavedCpl):
            raise damaged("it is of another language")
        made = MadeObjects(saved.objects)
        values = made.values(saved.globals), made.values(saved.permanent)
        names = set(values[1])
        if names and names != set(self._host.permanent):
            raise SnapshotError("the control has other permanent variables now", hint="declare the same ones")
        standing = [None if each is None else self._standing(each, made) for _, each in saved.under_way]
        return lambda: self._go_back(saved, values, standing)

    def _standing(self, saved: SavedProgram, made: MadeObjects) -> Standing:
        found = self._control.program("", saved.file.rpartition("/")[2])
        text = _decoded(saved.text.content)
        if found is not None and found[0] == saved.file and found[1] != text:
            raise SnapshotError(
                f"{saved.file} has been changed since the snapshot was taken",
                hint="put the program back as it was, or use another snapshot",
            )
        program = self.linker.program(text, saved.file)
        fits = (
            program is not None
            and not undeclared(program, self._host.permanent)
            and len(saved.wait) <= 1
            and (not saved.wait or bool(saved.place))
        )
        if program is None or not fits:
            raise damaged(f"{saved.file} cannot stand there")
        names = made.values(saved.names)
        called = tuple(made.value(each) for each in saved.called.values)
        try:
            traced = standing(program.traced, saved.place, names, again=bool(saved.wait))
        except ValueError as error:
            raise damaged(f"{saved.file} cannot stand there") from error
        return Standing(saved, program, called, names, traced)

    def _go_back(
        self,
        saved: SavedCpl,
        values: tuple[dict[str, object], dict[str, object]],
        standing: Sequence[Standing | None],
    ) -> list[tuple[object, BlockSource | None]]:
        """Go back to a state; return the programs under way."""
        restore_state(self.globals, values[0])
        if values[1]:
            restore_state(self._host.permanent, values[1])
        self.modal = saved.modal
        self.moves_on()
        self.running = []
        found: list[tuple[object, BlockSource | None]] = []
        for (called, _), each in zip(saved.under_way, standing, strict=True):
            if each is None:
                found.append((None, None))
                continue
            arguments = Arguments(each.called, each.saved.called.linked)
            execution = Execution(each.program, self.linker, self._host, self.globals, arguments)
            source = CplSource(each.saved.text, execution, self, modal=each.saved.called.modal)
            source.go_to(each.saved, each.traced, each.names)
            self.running.append(source)
            handed = None if called is None else Called(each.program, arguments, each.saved.called.modal)
            found.append((handed, source))
        return found

    def loops(self) -> bool:
        """Tell whether the programs under way loop without end: to be asked now and then while nothing moves."""
        running = (each.execution for each in self.running)
        return self._loop.repeats(self._host, running, (self.globals, self._host.permanent))

    def only_computes(self) -> bool:
        """Tell whether the programs have done nothing but compute since `loops` was asked first."""
        return self._loop.only_computes(self._host)

    def asks_nobody(self) -> bool:
        """Tell whether the programs have asked nobody else for anything since `loops` was asked first."""
        return self._loop.asks_nobody(self._host)

    def moves_on(self) -> None:
        """Take note that something has happened since `loops` was asked."""
        self._loop.forget()

    def stands(self, file: str, line: int) -> bool:
        """Tell whether preparation waits before a line for the path to come there, so that it can be stopped at."""
        return self.at_line is not None and self.at_line(file, line)

    def ended(self) -> None:
        """Take note that the last program under way has been left, or stopped by an error."""

    def skips(self, level: int) -> bool:
        """Tell whether blocks of a level are left out."""
        return level in self._skip_levels

    def milliseconds(self) -> int:
        """Return the time of the control."""
        return int(str(self._host.function("CLOCK")()))


class CplSource:
    """The blocks of one CPL program."""

    def __init__(
        self,
        text: ProgramText,
        execution: Execution,
        language: CplLanguage,
        *,
        modal: bool = False,
        bounds: Bounds | None = None,
    ) -> None:
        self.execution = execution
        self._bounds = bounds
        self.is_modal = modal
        """Whether its moves are followed by no modal call: it is that call."""
        self._behind: tuple[CodeWord, ...] | None = None  # words after which a modal call may come
        self._left: tuple[int, int] | None = None  # plain blocks that are given one by one
        self._text = text
        self._language = language
        self._starts = [0, *(found.end() for found in _LINE_END.finditer(text.content)), len(text.content)]
        self._statements = 0  # that were handed over, of a program linked for stepping
        self._waiting: Wait | None = None
        self._answer: object = None
        self._names: dict[str, Any] | None = None  # of the program's Python, where it stands

    @property
    def word_values(self) -> BracketWords:
        """What words with variables in the plain blocks that come next are worth."""
        return BracketWords(self._local, self._language.globals, self.execution.program.source, self._starts)

    def _local(self) -> dict[str, Any]:
        if self._names is None:
            self._names = self.execution.names()
        return self._names

    @property
    def waits(self) -> bool:
        """Whether a WAIT for a condition or a time is under way."""
        return self._waiting is not None and self._waiting.begun

    @property
    def wait_ends_ms(self) -> int | None:
        """When a WAIT under way ends at the latest, in ms of CLOCK; None if there is none or it has no duration."""
        return None if self._waiting is None else self._waiting.ends_ms

    def next(self) -> SourceItem | None:
        """Return what comes next.

        Raises:
            ProgramError: A statement cannot be executed.
        """
        while True:
            if (item := self._left_over()) is not None:
                return item
            if self._waiting is not None:
                self._answer = self._waiting.answer(fast_forward=self._language.fast_forward)
                if self._answer is None:
                    return Pause.PAUSE
                self._waiting = None
            answer, self._answer = self._answer, None
            self._names = None
            event = self.execution.step(answer)
            if event is None or (isinstance(event, Step) and self._ends_before(event.line)):
                return None
            if (item := self._item(event)) is not None:
                return item

    def _item(self, event: Event) -> SourceItem | None:
        """Return the item that an event is, None where it is none, or leaves some for later."""
        match event:
            case Lines(first=first, last=last):
                if self._language.modal is None or self._in_modal:
                    return self._span(first, last)
                self._left = first, last
            case NcValues() as block:
                if not self._language.skips(block.skip):
                    self._behind = tuple(
                        CodeWord(each.address, each.extension, each.value) for each in block.words
                    )
                    return self._words(block)
            case SubProgram() | Waiting() as skipped if self._language.skips(skipped.skip):
                return None
            case SubProgram() as call:
                modal = f"{call.address}{call.name}" in self._language.codes.modal
                if modal and not self._in_modal:
                    self._language.modal = call
                return self._call(call, modal=modal)
            case Waiting() as wait:
                if wait.condition is not None or wait.duration_ms is not None:
                    self._waiting = Wait(wait, self._language.milliseconds)
                return Drain(wait.line)
            case Step() as step:
                return self._statement(step.line)
            case _:
                return Pause.PAUSE
        return None

    def _ends_before(self, line: int) -> bool:
        return self._bounds is not None and self._bounds.end_before(line)

    def _statement(self, line: int) -> SourceItem | None:
        """Return the item of a statement that is stepped to or looked for."""
        is_sought = self._language.fast_forward and self._bounds is not None and self._bounds.first == line
        is_shown = self._language.shows_statements or is_sought
        if not is_shown or not _STATEMENT.match(self.execution.program.source.line(line)):
            return None  # of NC blocks and WAIT: these are stopped at by themselves
        if self._language.stands(self.execution.program.file, line):
            return Drain(line)  # nothing is computed before the path has come here
        self._statements += 1
        return Statement(line) if self._statements % _STATEMENTS else Pause.PAUSE

    def saved(self, objects: Objects) -> SavedProgram:
        """Return where the program stands.

        Raises:
            SnapshotError: It waits for the answer of a function, or ends after a block that was given.
        """
        if self._bounds is not None and self._bounds.last:
            raise SnapshotError(
                "a part of a CPL program is under way, up to a block that was given",
                hint="take the snapshot when it has ended",
            )
        execution = self.execution
        place = execution.place
        return SavedProgram(
            self._text,
            execution.program.file,
            SavedCalled(
                tuple(map(objects.plain, execution.arguments.values)),
                execution.arguments.linked,
                self.is_modal,
            ),
            execution.line,
            place,
            kept_names(execution.names(), objects) if place else {},
            self._statements,
            () if self._waiting is None else (self._waiting.began_ms,),
            self._answer if isinstance(self._answer, int) else None,
            self._behind,
            self._left,
        )

    def go_to(self, saved: SavedProgram, traced: Traced[int] | None, names: dict[str, object]) -> None:
        """Stand where another one stood; `traced` is code that stands there, None for the end."""
        self._statements, self._answer = saved.statements, saved.answer
        self._behind, self._left = saved.behind, saved.left
        self.execution.line = saved.line
        event = self.execution.go_to(traced, names)
        if saved.wait and isinstance(event, Waiting):
            self._waiting = Wait(event, self._language.milliseconds, began_ms=saved.wait[0])

    def leave(self) -> bool:
        """Leave returns to the channel, which has entered every sub-program."""
        return False

    def failed(self) -> None:
        """End what does not outlive the program; its variables can be looked at until it is left."""
        self._language.ended()

    def close(self) -> None:
        """End the program."""
        self.execution.close()
        if self in self._language.running:
            self._language.running.remove(self)
            if not self._language.running:
                self._language.ended()

    @property
    def _in_modal(self) -> bool:
        return any(source.is_modal for source in self._language.running)

    def _span(self, first: int, last: int) -> TextSpan:
        return TextSpan(self._starts[first - 1], first, self._starts[last])

    def _left_over(self) -> SourceItem | None:
        """Return what a block or plain lines have left to give: the modal call after a move, the next line."""
        while self._behind is not None or self._left is not None:
            if self._behind is None:
                return self._next_line()
            words, self._behind = self._behind, None
            if (call := self._call_behind(words)) is not None:
                return call
        return None

    def _next_line(self) -> SourceItem:
        """Return the next of plain blocks that are given one by one; all of them once there is no modal call."""
        assert self._left is not None
        line, last = self._left
        if self._language.modal is None:
            self._left = None
            return self._span(line, last)
        self._left = (line + 1, last) if line < last else None
        try:
            block = scan_block(self._text, self._starts[line - 1], line, self._language.codes.rules)
            words = [CodeWord(word.letter, word.index, word.value) for word in block.words]
            if block.flags & STATEMENT:
                text, place = self.execution.program.source.line(line), self._starts[line - 1]
                words = [
                    CodeWord(letter, None, value)
                    for letter, value in line_words(text, self.word_values, place)
                ]
        except ProgramError:
            return self._span(line, line)  # the channel says what is wrong
        if not (block.skip_level and self._language.skips(block.skip_level)):
            self._behind = tuple(words)
        return self._span(line, line)

    def _call_behind(self, words: Sequence[CodeWord]) -> SourceItem | None:
        """Return the modal call after a block that moves, or end it."""
        language = self._language
        if language.modal is None or self._in_modal:
            return None
        if language.codes.cancels_modal(words):
            language.modal = None
        elif language.codes.moves(words):
            return self._call(language.modal, modal=True)
        return None

    def _words(self, block: NcValues) -> WordsBlock:
        begin, end = self._starts[block.line - 1 : block.line + 1]
        line = _decoded(self._text.content[begin:end])
        words = [Word("N", float(block.number), begin, False)] if block.number is not None else []
        for word in block.words:
            place = begin + len(line[: word.column - 1].encode("utf-8"))
            words.append(Word(word.address, word.value, place, True, word.extension))
        return WordsBlock(tuple(words), block.line, begin, block.message)

    def _call(self, call: SubProgram, *, modal: bool = False) -> CallProgram:
        running = [source.execution.program for source in self._language.running]
        program = self.execution.called(call, running)
        text = ProgramText.from_text(program.source.text, program.file)
        arguments = Arguments(call.arguments, self.execution.linked)
        called = Called(program, arguments, modal)
        return CallProgram(text, call.line, self._starts[call.line - 1], arguments=called)


def _saved_call(arguments: object, objects: Objects) -> SavedCalled | None:
    if not isinstance(arguments, Called):
        return None
    given = arguments.arguments
    return SavedCalled(tuple(map(objects.plain, given.values)), given.linked, arguments.modal)


def _decoded(content: bytes) -> str:
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")
