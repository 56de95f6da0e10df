"""Custom macros as the language of a channel: programs are compiled once and give their blocks one after the other."""

from __future__ import annotations

import re
from collections.abc import Sequence

from polycnc.errors import ProgramError
from polycnc.language import Traced
from polycnc.machine import SnapshotError
from polycnc.nc.macro._calls import Arguments, MacroCalls
from polycnc.nc.macro._compile import compile_program, names
from polycnc.nc.macro._expressions import Expressions
from polycnc.nc.macro._functions import asin, atan2
from polycnc.nc.macro._host import Host
from polycnc.nc.macro._macro_source import Compiled, MacroSource, error_at, standing_code
from polycnc.nc.macro._macro_state import MACRO_CLASSES, ModalCall, SavedLanguage, SavedSource
from polycnc.nc.macro._output import OutputDevice
from polycnc.nc.macro._plain_lines import OpenLines
from polycnc.nc.macro._reader import LineReader
from polycnc.nc.macro._shape import extent, parse, shape
from polycnc.nc.macro._special_lines import Special, called_programs, returns_to_a_block, special
from polycnc.nc.macro._system import SystemVariables
from polycnc.nc.macro._variables import MacroVariables, Value
from polycnc.nc.records._block_records import Call
from polycnc.nc.sources._block_source import BlockSource, Returning, elsewhere
from polycnc.nc.text._program import ProgramText

PAUSE_JUMPS = 20_000
"""Jumps back after which a program gives a pause."""
LONGEST_LOOP_PAUSES = 2_500
"""So many pauses in a row without a block are a loop without end."""
_LEVELS_REMEMBERED = 64
_TEXTS_REMEMBERED = 256
_PLAIN_CALLS = MacroCalls()
_BLOCK_END = re.compile(rb";(?=[ \t]*(?:[\r\n]|\Z))")
_PIECE_BYTES = 1 << 20


class MacroLanguage:
    """Execute programs with custom macros.

    `turns` counts how often programs were asked for a block: whoever keeps variables sees by it that they may have
    changed. `variables` may be shared with whoever else reads and writes them, `system` are the control's own
    variables, `calls` the codes that call programs. With `nat` ASIN and ATAN give -90 to 90 and -180 to 180 degrees.
    With `main_repeats` M99 in the main program begins it anew instead of ending it. With `endless_loops` a loop may go
    round without a block for ever; else that is an error after 2,500 pauses. It pauses after `pause_jumps` rounds, and
    after each that changes nothing.
    """

    def __init__(
        self,
        variables: MacroVariables | None = None,
        *,
        system: SystemVariables | None = None,
        calls: MacroCalls | None = None,
        nat: bool = False,
        main_repeats: bool = False,
        endless_loops: bool = False,
        pause_jumps: int = PAUSE_JUMPS,
    ) -> None:
        self.variables = variables or MacroVariables()
        self.system = system or SystemVariables()
        self.calls = calls or _PLAIN_CALLS
        self.nat = nat
        self.main_repeats = main_repeats
        self.longest_loop_pauses = None if endless_loops else LONGEST_LOOP_PAUSES
        self.modals: tuple[ModalCall, ...] = ()
        self.interrupt_program: int | None = None
        self.output = OutputDevice()
        self.pending: int | None = None
        self._interrupt = False
        self.codes_off = 0
        self._channel: Host | None = None
        self._compiled: dict[tuple[int, int, bool], Compiled | None] = {}
        self._returns: dict[int, tuple[ProgramText, bool]] = {}
        self._latin: dict[int, tuple[ProgramText, str, bytes]] = {}
        self._without: dict[tuple[int, bool], ProgramText] = {}
        self.turns = 0
        self._levels: dict[tuple[Call, ...], list[Value]] = {}
        self._pause_jumps = pause_jumps

    def attach(self, channel: Host) -> None:
        """Work for a channel: its positions, modal state and tables are what system variables read."""
        self._channel = channel
        self._levels.clear()
        self.system.attach(channel)
        self.variables.leave_all()
        self.modals, self.pending = (), None
        self.interrupt_program, self._interrupt = None, False
        self.output.attach(channel)
        self.codes_off = 0
        for kept in (self._returns, self._latin, self._without, self._compiled):
            kept.clear()

    def interrupt(self) -> None:
        """Give the interrupt signal: the program that M96 names is called after the block that is executed."""
        self._interrupt = self.interrupt_program is not None

    def take_interrupt(self) -> bool:
        """Tell whether the interrupt signal has come since this was asked last."""
        taken, self._interrupt = self._interrupt, False
        return taken

    @property
    def channel(self) -> Host:
        """The channel that the language works for."""
        assert self._channel is not None
        return self._channel

    def locals_of(self, stack: tuple[Call, ...]) -> list[Value]:
        """Return the local variables of a block that calls led to; preparation may have left its macro already."""
        for depth in range(len(stack), 0, -1):
            if (found := self._levels.get(stack[:depth])) is not None:
                return found
        return self.variables.locals_of(0)

    def note_level(self) -> None:
        """Remember the local variables of the macro that begins, for those who look at the block executed."""
        self._levels.pop(self.channel.stack, None)
        self._levels[self.channel.stack] = self.variables.local
        if len(self._levels) > _LEVELS_REMEMBERED:
            del self._levels[next(iter(self._levels))]

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> MacroSource | None:
        """Return a source for the program that begins at byte `offset`, None where plain text needs none."""
        given = _given(arguments)
        needed = given is not None or bool(self.modals) or self.interrupt_program is not None
        key = (id(text), offset, self.codes_off > 0 or (given is not None and given.by_code))
        if key not in self._compiled:
            self._compiled[key] = self._compile(text, offset, line, key[2], force=False)
        compiled = self._compiled[key]
        if compiled is None:
            if not needed:
                return None
            compiled = self._compile(text, offset, line, key[2], force=True)
            assert compiled is not None
        return MacroSource(self, compiled, given).begin()

    def tidy(self) -> None:
        """Keep no more of what was translated than a bounded amount: there is no end of texts."""
        if len(self._without) + len(self._compiled) > _TEXTS_REMEMBERED:
            for kept in (self._returns, self._latin, self._without, self._compiled):
                kept.clear()

    def source_at(self, text: ProgramText, offset: int, line: int, start: int) -> MacroSource | None:
        """Return a source that begins at byte `start`, the beginning of a line; None where plain text needs none.

        Raises:
            ProgramError: The program is wrong, or cannot begin there.
        """
        compiled = self._compile(text, offset, line, False, force=False, start=start)
        if compiled is None:
            return None
        if compiled.errors:
            raise compiled.errors[0]
        return MacroSource(self, compiled, None).begin()

    def _compile(
        self, text: ProgramText, offset: int, line: int, plain: bool, *, force: bool, start: int | None = None
    ) -> Compiled | None:
        calls = _PLAIN_CALLS if plain else self.calls
        known = id(text) in self._latin or force
        if not known and self._is_plain(
            text, plain, special(calls, restarts=self.main_repeats, returns=True)
        ):
            return None
        returns = self._is_returned_into(text, calls)
        wanted = special(calls, restarts=self.main_repeats, returns=returns)
        if not known and not returns and self._is_plain(text, plain, wanted):
            return None
        if id(text) not in self._latin:
            content = _BLOCK_END.sub(b" ", text.content) if b";" in text.content else text.content
            self._latin[id(text)] = (text, content.decode("latin-1"), content.upper())
        _, whole, folded = self._latin[id(text)]
        begin, first_line, end = extent(whole, offset, line)
        if not force and next(wanted.lines(whole, folded, begin, end), None) is None:
            return None
        reader = LineReader(whole, calls, repeats=self.main_repeats)
        lines = wanted.lines(whole, folded, begin, end, OpenLines(wanted.codes, self._is_stored))
        parts, flaws = parse(whole, lines, begin, first_line, end, reader)
        name = f"<macro {id(text)} {offset} {plain}>"
        code = None
        if not flaws:
            made, flaws = shape(whole, parts, returns=returns, start=start)
            if not flaws:
                increment = self.channel.dialect.increment
                values = Expressions(self.variables, self.system)
                code, flaws = compile_program(whole, made, values, increment, self._pause_jumps, name)
        errors = [error_at(text, flaw) for flaw in flaws]
        number = _program_number(whole, offset)
        return Compiled(text, offset, line, plain, start, code, errors, name, number)

    def _is_stored(self, number: int) -> bool:
        return self.variables.kind(number) not in (None, "null")

    def _is_returned_into(self, text: ProgramText, calls: MacroCalls) -> bool:
        """Tell whether a program of a text, or one that it calls, returns to a block of its caller (M99 P)."""
        known = self._returns.get(id(text))
        if known is None:
            called = [text]
            numbers = called_programs(text.content, calls)
            for number in numbers or ():
                found = self.channel.sub_program(number)
                if found is not None and found is not text:
                    called.append(found)
            returns = numbers is None or any(returns_to_a_block(each.content) for each in called)
            self._returns[id(text)] = known = text, returns
        return known[1]

    def _is_plain(self, text: ProgramText, plain: bool, wanted: Special) -> bool:
        """Tell whether no line of a text is special; it is looked at in pieces, as most programs are long and plain."""
        key = (id(text), plain)
        if key in self._without:
            return True
        begin, size = 0, len(text.content)
        while begin < size:
            end = text.content.find(b"\n", begin + _PIECE_BYTES) + 1 or size
            piece = text.content[begin:end]
            if next(wanted.lines(piece.decode("latin-1"), piece.upper(), 0, len(piece)), None) is not None:
                return False
            begin = end
        self._without[key] = text
        return True

    # ------------------------------------------------------------------ where it stands

    @property
    def classes(self) -> Sequence[type]:
        """The classes of which its state is made."""
        return MACRO_CLASSES

    def save(self, under_way: Sequence[tuple[object, BlockSource | None]]) -> SavedLanguage:
        """Return all that it holds; variables that outlast switching off only while a program of it is under way.

        Raises:
            SnapshotError: A program under way has been reset.
        """
        executions = [(_given(each), source) for each, source in under_way]
        lasting = any(source is not None for _, source in executions)
        return SavedLanguage(
            self.variables.saved(lasting=lasting),
            self.system.saved(),
            self.modals,
            self.interrupt_program,
            self._interrupt,
            self.pending,
            self.codes_off,
            self.output.saved(),
            tuple(
                (stack, -1 if (level := self.variables.level_of(values)) is None else level, tuple(values))
                for stack, values in self._levels.items()
            ),
            tuple(
                (each, source.saved() if isinstance(source, MacroSource) else None)
                for each, source in executions
            ),
        )

    def restore_point(self, channel: Host, saved: object) -> Returning:
        """Return what goes back to a state, for a channel that it is attached to by then; nothing changes yet.

        Raises:
            SnapshotError: A program of the state cannot go on from there.
        """
        if not isinstance(saved, SavedLanguage) or not self.variables.fits(saved.variables):
            raise SnapshotError("this is a snapshot of another language", hint="use another one")
        before, self._channel = self._channel, channel
        try:
            with self.system.seen_from(channel):
                sources = [None if each is None else self._standing(each) for _, each in saved.under_way]
        finally:
            self._channel = before
        return lambda: self._go_to(saved, sources)

    def _standing(self, saved: SavedSource) -> tuple[SavedSource, Compiled, Traced[int] | None]:
        try:
            compiled = self._compile(
                saved.text, saved.offset, saved.line, saved.plain, force=True, start=saved.start
            )
        except (ProgramError, LookupError, ValueError) as error:
            raise elsewhere(saved.text) from error
        assert compiled is not None
        return saved, compiled, standing_code(compiled, saved)

    def _go_to(
        self, saved: SavedLanguage, sources: Sequence[tuple[SavedSource, Compiled, Traced[int] | None] | None]
    ) -> list[tuple[object, BlockSource | None]]:
        """Go back to a state; return the programs under way."""
        self.variables.restore_state(saved.variables)
        self.system.restore_state(saved.system)
        self.modals, self.interrupt_program = saved.modals, saved.interrupt_program
        self._interrupt, self.pending, self.codes_off = saved.interrupt, saved.pending, saved.codes_off
        self.output.restore_state(saved.output)
        for stack, level, values in saved.levels:
            self._levels[stack] = list(values) if level < 0 else self.variables.locals_of(level)
        self.turns += 1
        return [
            (
                given,
                None
                if source is None
                else MacroSource(self, source[1], source[0].arguments).go_to(source[0], source[2]),
            )
            for (given, _), source in zip(saved.under_way, sources, strict=True)
        ]

    def bindings(self) -> dict[str, object]:
        """Return the functions and operators as compiled programs call them, and what they are set to."""
        nat = self.nat
        return {
            **names(),
            "f_ASIN": lambda value: asin(value, nat),
            "f_ATAN2": lambda value, below: atan2(value, below, nat),
        }


def _given(arguments: object) -> Arguments | None:
    return arguments if isinstance(arguments, Arguments) else None


def _program_number(text: str, offset: int) -> int:
    number = re.match("[0-9]*", text[offset : offset + 200].lstrip("% \t\r\n:Oo")[:8])
    return int(number[0]) if number and number[0] else 0
