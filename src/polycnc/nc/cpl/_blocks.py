"""CPL as a language of the channel: what its programs yield, as items of the block source."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from polycnc.errors import ProgramError
from polycnc.nc._block_source import CallProgram, Drain, Pause, SourceItem, Statement, TextSpan, WordsBlock
from polycnc.nc.cpl._code_calls import NO_CODES, CodeCalls, CodeWord
from polycnc.nc.cpl._host import Host, Lines, NcValues, Step, SubProgram, Waiting
from polycnc.nc.cpl._link_table import LinkTables
from polycnc.nc.cpl._loops import LoopWatch, WatchedHost
from polycnc.nc.cpl._program import Linker, Program, holds_cpl
from polycnc.nc.cpl._run import Arguments, Execution
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Word, scan_block

_LINE_END = re.compile(rb"\r\n|\r|\n")
_STATEMENT = re.compile(r"[ \t]*[0-9.@#](?![0-9]*[ \t]*WAIT)")

_STATEMENTS = 256  # so many, then time passes: a loop may hold no block


class _Called(NamedTuple):
    """What a call hands to the source of its sub-program; `modal`: its moves are followed by no call."""

    program: Program
    arguments: Arguments
    modal: bool = False


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
        """The call that is made behind every move."""
        self.linker = Linker(host.program, stepping=stepping, tables=tables, codes=codes)
        self.running: list[CplSource] = []
        """The sources under way, that of the main program first."""
        self.at_line: Callable[[str, int], bool] | None = None
        """What tells a debugger's wish to stand before a line, of programs linked for stepping."""
        self._host = WatchedHost(host)
        self._loop = LoopWatch()
        self._skip_levels = skip_levels

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> CplSource | None:
        """Return the source of a program, None for one without CPL.

        Raises:
            ProgramError: It, or a sub-program of it, is wrong; this is the link step.
        """
        called = arguments if isinstance(arguments, _Called) else None
        if called is None and not self.running:
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
            called = _Called(main, Arguments())
        try:
            execution = Execution(called.program, self.linker, self._host, self.globals, called.arguments)
        except ProgramError:
            self.linker.refuse(called.program)
            raise
        source = CplSource(text, execution, self, modal=called.modal)
        self.running.append(source)
        return source

    def loops(self) -> bool:
        """Tell whether the programs under way are in a loop without end, if nothing else changes what they read.

        To be asked now and then while nothing moves; `moves_on` begins anew.
        """
        executions = [source.execution for source in self.running]
        return self._loop.repeats(self._host.effects, executions, (self.globals, self._host.permanent))

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
        self, text: ProgramText, execution: Execution, language: CplLanguage, *, modal: bool = False
    ) -> None:
        self.execution = execution
        self.is_modal = modal
        """Whether its moves are followed by no modal call: it is that call."""
        self._items: Iterator[SourceItem] = iter(())
        self._text = text
        self._language = language
        self._starts = [0, *(found.end() for found in _LINE_END.finditer(text.content)), len(text.content)]
        self._statements = 0  # that were handed over, of a program linked for stepping
        self._waiting: _Wait | None = None
        self._answer: object = None

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
            if (item := next(self._items, None)) is not None:
                return item
            if self._waiting is not None:
                self._answer = self._waiting.answer()
                if self._answer is None:
                    return Pause.PAUSE
                self._waiting = None
            answer, self._answer = self._answer, None
            match self.execution.step(answer):
                case None:
                    return None
                case Lines(first=first, last=last):
                    if self._language.modal is None or self._in_modal:
                        return self._span(first, last)
                    self._items = self._lines(first, last)
                case NcValues() as block:
                    if not self._language.skips(block.skip):
                        words = [CodeWord(each.address, each.extension, each.value) for each in block.words]
                        self._items = self._calls_behind(words)
                        return self._words(block)
                case SubProgram() as call:
                    modal = f"{call.address}{call.name}" in self._language.codes.modal
                    if modal and not self._in_modal:
                        self._language.modal = call
                    return self._call(call, modal=modal)
                case Waiting() as wait:
                    if wait.condition is not None or wait.duration_ms is not None:
                        self._waiting = _Wait(wait, self._language.milliseconds)
                    return Drain(wait.line)
                case Step() as step:
                    if not _STATEMENT.match(self.execution.program.source.line(step.line)):
                        continue  # an NC block, or a WAIT: these are stopped at by themselves
                    if self._language.stands(self.execution.program.file, step.line):
                        return Drain(step.line)  # nothing is reckoned before the path has come here
                    self._statements += 1
                    return Statement(step.line) if self._statements % _STATEMENTS else Pause.PAUSE
                case _:
                    return Pause.PAUSE

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

    def _lines(self, first: int, last: int) -> Iterator[SourceItem]:
        """Give plain blocks one by one, each with the call behind its move, as long as there is one."""
        for line in range(first, last + 1):
            if self._language.modal is None:
                yield self._span(line, last)
                return
            yield self._span(line, line)
            try:
                block = scan_block(self._text, self._starts[line - 1], line, self._language.codes.rules)
            except ProgramError:
                continue  # the channel says so
            if not (block.skip_level and self._language.skips(block.skip_level)):
                yield from self._calls_behind(
                    [CodeWord(word.letter, word.index, word.value) for word in block.words]
                )

    def _calls_behind(self, words: list[CodeWord]) -> Iterator[SourceItem]:
        """Give the modal call behind a block that moves, or end it."""
        language = self._language
        if language.modal is None or self._in_modal:
            return
        if language.codes.cancels_modal(words):
            language.modal = None
        elif language.codes.moves(words):
            yield self._call(language.modal, modal=True)

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
        called = _Called(program, arguments, modal)
        return CallProgram(text, call.line, self._starts[call.line - 1], arguments=called)


class _Wait:
    """A WAIT with a condition or a duration, from when the queue has been drained."""

    def __init__(self, wait: Waiting, milliseconds: Callable[[], int]) -> None:
        self._wait = wait
        self._milliseconds = milliseconds
        self._began: int | None = None

    @property
    def begun(self) -> bool:
        """Whether the queue has been drained."""
        return self._began is not None

    @property
    def ends_ms(self) -> int | None:
        """When it ends at the latest; None if it has no duration or has not begun."""
        if self._began is None or self._wait.duration_ms is None:
            return None
        return self._began + self._wait.duration_ms

    def answer(self) -> int | None:
        """Return 0 if the condition holds at once, 2 if it came to, 1 if the time has passed, None for not yet."""
        wait = self._wait
        first = self._began is None
        if self._began is None:
            self._began = self._milliseconds() if wait.duration_ms is not None else 0
        if wait.condition is not None and wait.condition():
            return 0 if first else 2
        if wait.duration_ms is not None and self._milliseconds() - self._began >= wait.duration_ms:
            return 1
        return None


def _decoded(content: bytes) -> str:
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")
