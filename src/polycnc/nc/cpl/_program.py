"""Link programs: syntax, jump destinations and sub-programs are checked before the first block runs (2.3)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from polycnc.errors import ProgramError
from polycnc.language import Flaw, Source, Traced, clipped, every, without_collection
from polycnc.nc.cpl._code_calls import NO_CODES, CodeCalls, pattern_of
from polycnc.nc.cpl._compile import Compiler
from polycnc.nc.cpl._jumps import target_flaws
from polycnc.nc.cpl._link_table import LinkedCall, LinkTable, LinkTables, NoTables, text_digest
from polycnc.nc.cpl._nc_lines import PLAIN_RULES, is_marked_din
from polycnc.nc.cpl._program_reader import read_program
from polycnc.nc.cpl._syntax import NcLine, SubCall
from polycnc.nc.cpl._variables import Variable
from polycnc.nc.text._program import TextRules

NESTING = 7
"""How deep sub-programs may be nested (Manual 003, 2.1)."""
_LONGEST_NAME = 100
Find = Callable[[str, str], "tuple[str, str] | None"]
_CALL = rb"P[ \t]*(?:[A-Z_]|[0-9]+[ \t]*(?:\(.*)?\r?$)"
_CPL = re.compile(rb"(?mi)^[ \t]*[0-9]|\[|^[ \t]*(?:N[ \t]*[0-9]+)?[ \t]*(?:WAIT|%b|\([ \t]*DIN)" % _CALL)


@dataclass(frozen=True)
class Program:
    """A program, linked: `traced` makes its generator, `calls` are the sub-programs that it calls."""

    source: Source
    traced: Traced[int]
    calls: tuple[LinkedCall, ...]
    variables: dict[Variable, int]
    marked_din: bool
    is_plain: bool
    text: str
    stepping: bool = False

    @property
    def file(self) -> str:
        """Return the name of the program's file."""
        return self.source.file


def holds_cpl(content: bytes, alone: frozenset[str] = frozenset()) -> bool:
    """Tell whether a program needs this language: NC blocks do not, but for those of codes that call programs."""
    calls = pattern_of(alone)
    return _CPL.search(content) is not None or (calls is not None and calls.search(content) is not None)


def compile_program(
    text: str,
    file: str,
    *,
    stepping: bool = False,
    opened: bool = False,
    alone: frozenset[str] = frozenset(),
    rules: TextRules = PLAIN_RULES,
) -> tuple[Program | None, list[ProgramError]]:
    """Return one program compiled, without looking at its sub-programs, and all that is wrong with it.

    The codes of `alone` ("G322") call programs where they stand alone in a block; `rules` say how blocks are read.
    """
    with without_collection():
        return _compiled(_source(text, file), text, stepping, alone, rules, opened)


def _compiled(
    source: Source, text: str, stepping: bool, alone: frozenset[str], rules: TextRules, opened: bool
) -> tuple[Program | None, list[ProgramError]]:
    statements, flaws = read_program(source, alone, rules, in_text=opened)
    whole = list(every(statements))
    flaws += target_flaws(whole)
    compiler = Compiler(source, stepping=stepping)
    traced = compiler.compile(statements, whole, f"<cpl {source.file}>") if not flaws else None
    flaws += compiler.flaws
    if traced is None:
        return None, [source.error(flaw) for flaw in sorted(flaws, key=lambda flaw: flaw.at)]
    calls = _calls(whole)
    plain = all(isinstance(each, NcLine) and not each.names for each in statements)
    return Program(
        source, traced, calls, compiler.variables, is_marked_din(source.line(1)), plain, text, stepping
    ), []


class Linker:
    """Compile programs and those that they call, each once as long as its text stays; `find` returns file and text.

    `tables` keep what was found out about sub-programs: one whose text is still the linked one is not linked again.
    `codes` say which G and M codes call programs where they stand alone.
    """

    def __init__(
        self,
        find: Find,
        *,
        stepping: bool = False,
        opened: bool = False,
        tables: LinkTables | None = None,
        codes: CodeCalls = NO_CODES,
    ) -> None:
        self._find = find
        self._codes = codes
        self.alone: frozenset[str] = frozenset()
        """The codes that call programs where they stand alone, as they were when `look_again` was called."""
        self.stepping = stepping
        """Whether programs are compiled so that each of their lines is reported."""
        self._opened = opened
        self._tables = tables or NoTables()
        self._faulty: dict[str, str] = {}  # texts by file
        self._programs: dict[str, Program] = {}
        self._files: dict[tuple[str, str], tuple[str, str] | None] = {}
        self._checked: dict[tuple[str, int], bool] = {}
        self.look_again()

    def link(self, text: str, file: str) -> tuple[Program | None, list[ProgramError]]:
        """Return a main program with its sub-programs checked, and all that is wrong with any of them."""
        errors: list[ProgramError] = []
        self._files.clear()
        self._faulty.clear()
        self._checked.clear()
        main = self._compiled(text, file, errors)
        if main is None:
            self._check_faulty(file, text, (), errors)
        elif not main.marked_din:
            self._check(file, text, main.calls, (), errors)
        return (None if errors else main), errors

    def look_again(self) -> None:
        """Ask the control anew which codes call programs: one may have been written since."""
        if (alone := self._codes.alone()) != self.alone:
            self.alone = alone
            self._programs.clear()

    def sub_program(self, address: str, name: str) -> Program | None:
        """Return a sub-program that is called, as its file is now; None if there is none.

        One that was not linked, or has been written since, is compiled.

        Raises:
            ProgramError: Something is wrong with it.
        """
        found = self._find(address, name)
        if found is None:
            return None
        errors: list[ProgramError] = []
        program = self._compiled(found[1], found[0], errors)
        if errors:
            raise errors[0]
        return program

    def program(self, text: str, file: str) -> Program | None:
        """Return the program of a text as it runs, None if something is wrong with it."""
        return self._compiled(text, file, [])

    def refuse(self, program: Program) -> None:
        """Forget that a program was linked: the control refuses it."""
        self._tables.drop(program.file)

    def programs(self) -> Iterable[Program]:
        """Return all programs compiled so far."""
        return self._programs.values()

    def _found(self, address: str, name: str) -> tuple[str, str] | None:
        key = (address, name)
        if key not in self._files:
            self._files[key] = self._find(address, name)
        return self._files[key]

    def _compiled(self, text: str, file: str, errors: list[ProgramError]) -> Program | None:
        if self._faulty.get(file) == text:
            return None
        known = self._programs.get(file)
        if known is None or known.text != text or known.stepping != self.stepping:
            program, found = compile_program(
                text,
                file,
                stepping=self.stepping,
                opened=self._opened,
                alone=self.alone,
                rules=self._codes.rules,
            )
            errors += found
            if program is None:
                self._faulty[file] = text
                self._tables.drop(file)
                return None
            self._programs[file] = program
        return self._programs[file]

    def _check(
        self,
        file: str,
        text: str,
        calls: tuple[LinkedCall, ...],
        stack: tuple[str, ...],
        errors: list[ProgramError],
    ) -> bool:
        """Check the calls of a program that others led to; what is right as a whole leaves a table."""
        key = (file, len(stack))
        if key in self._checked:
            return self._checked[key]
        right = True
        for call in calls:
            flaw, inner = self._call_flaw(call, (*stack, file), errors)
            right = right and inner and flaw is None
            if flaw is not None:
                error = _source(text, file).error(flaw)
                if str(error) not in map(str, errors):
                    errors.append(error)
        self._checked[key] = right
        if not right:
            self._tables.drop(file)
        elif file not in self._programs or not self._programs[file].is_plain:
            self._tables.keep(file, LinkTable(text_digest(text), calls))
        return right

    def _check_faulty(self, file: str, text: str, stack: tuple[str, ...], errors: list[ProgramError]) -> None:
        """Check the calls of a program that is wrong itself, as far as it can be read; it leaves no table."""
        if is_marked_din(text.split("\n", 1)[0]) or (file, len(stack)) in self._checked:
            return
        self._checked[file, len(stack)] = False
        source = _source(text, file)
        statements, _ = read_program(source, self.alone, self._codes.rules, in_text=self._opened)
        for call in _calls(every(statements)):
            flaw, _ = self._call_flaw(call, (*stack, file), errors)
            if flaw is not None:
                errors.append(source.error(flaw))

    def _call_flaw(
        self, call: LinkedCall, stack: tuple[str, ...], errors: list[ProgramError]
    ) -> tuple[Flaw | None, bool]:
        """Return what is wrong with a call, and whether what it calls is right."""
        found = self._found(call.address, call.name)
        shown = shown_call(call.address, call.name)
        if found is None and call.unlinked:
            return None, True  # it may be written before it is called
        if found is None:
            hint = "write it into a file of this name"
            return Flaw(call.at, f"there is no sub-program {shown}", hint), False
        file, text = found
        if file in stack:
            return Flaw(call.at, f"{shown} calls itself", "recursive calls are not possible"), False
        if len(stack) > NESTING:
            return Flaw(call.at, f"sub-programs are nested more than {NESTING} deep"), False
        if call.unlinked or is_marked_din(text.split("\n", 1)[0]):
            return None, True
        table = self._tables.find(file)
        if table is not None and table.digest == text_digest(text) and file not in self._programs:
            return None, self._check(file, text, table.calls, stack, errors)
        program = self._compiled(text, file, errors)
        if program is None:
            self._check_faulty(file, text, stack, errors)
            return None, False
        return None, self._check(file, text, program.calls, stack, errors)


def _calls(statements: Iterable[object]) -> tuple[LinkedCall, ...]:
    return tuple(
        LinkedCall(each.at, each.line, each.address, each.name, each.unlinked)
        for each in statements
        if isinstance(each, SubCall)
    )


def shown_call(address: str, name: str) -> str:
    """Return a sub-program as messages name it."""
    return f"{address}{name}" if address in ("G", "M") else clipped(name, _LONGEST_NAME)


def _source(text: str, file: str) -> Source:
    return Source(text.replace("\r\n", "\n").replace("\r", "\n"), file)
