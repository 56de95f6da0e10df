"""Link programs: syntax, jump destinations and sub-programs are checked before the first block runs (2.3)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from polycnc.errors import ProgramError
from polycnc.language import Flaw, Source, Traced
from polycnc.nc.cpl._compile import Compiler
from polycnc.nc.cpl._nc_lines import is_marked_din
from polycnc.nc.cpl._program_reader import read_program
from polycnc.nc.cpl._shape import every, target_flaws
from polycnc.nc.cpl._syntax import NcLine, SubCall
from polycnc.nc.cpl._variables import Variable

NESTING = 7
"""How deep sub-programs may be nested (Manual 003, 2.1)."""
Find = Callable[[str, str], "tuple[str, str] | None"]
_CPL = re.compile(rb"(?mi)^[ \t]*[0-9]|\[|^[ \t]*(?:N[ \t]*[0-9]+)?[ \t]*(?:WAIT|P[ \t]*[A-Z_]|\([ \t]*DIN)")


@dataclass(frozen=True)
class Program:
    """A program, linked: `traced` makes its generator, `calls` are the sub-programs that it calls."""

    source: Source
    traced: Traced[int]
    calls: tuple[SubCall, ...]
    variables: dict[Variable, int]
    marked_din: bool
    is_plain: bool
    text: str

    @property
    def file(self) -> str:
        """Return the name of the program's file."""
        return self.source.file


def holds_cpl(content: bytes) -> bool:
    """Tell whether a program needs this language: NC blocks alone do not."""
    return _CPL.search(content) is not None


def compile_program(
    text: str, file: str, *, stepping: bool = False
) -> tuple[Program | None, list[ProgramError]]:
    """Return one program compiled, without looking at its sub-programs, and all that is wrong with it."""
    source = Source(text.replace("\r\n", "\n").replace("\r", "\n"), file)
    statements, flaws = read_program(source)
    flaws += target_flaws(statements)
    compiler = Compiler(source, stepping=stepping)
    traced = compiler.compile(statements, f"<cpl {file}>") if not flaws else None
    flaws += compiler.flaws
    if traced is None:
        return None, [source.error(flaw) for flaw in sorted(flaws, key=lambda flaw: flaw.at)]
    calls = tuple(each for each in every(statements) if isinstance(each, SubCall))
    plain = all(isinstance(each, NcLine) for each in statements)
    return Program(source, traced, calls, compiler.variables, is_marked_din(source.line(1)), plain, text), []


class Linker:
    """Compile programs and those that they call, each once as long as its text stays; `find` returns file and text."""

    def __init__(self, find: Find, *, stepping: bool = False) -> None:
        self._find = find
        self._stepping = stepping
        self._faulty: set[str] = set()
        self._programs: dict[str, Program] = {}
        self._files: dict[tuple[str, str], tuple[str, str] | None] = {}

    def link(self, text: str, file: str) -> tuple[Program | None, list[ProgramError]]:
        """Return a main program with its sub-programs checked, and all that is wrong with any of them."""
        errors: list[ProgramError] = []
        self._files.clear()
        self._faulty.clear()
        main = self._compiled(text, file, errors)
        if main is not None and not main.marked_din:
            self._check_calls(main, (main,), errors)
        return (None if errors else main), errors

    def sub_program(self, address: str, name: str) -> Program | None:
        """Return a sub-program that is called, compiled now if it was not linked; None if there is none.

        Raises:
            ProgramError: Something is wrong with it.
        """
        found = self._found(address, name)
        if found is None:
            return None
        errors: list[ProgramError] = []
        program = self._compiled(found[1], found[0], errors)
        if errors:
            raise errors[0]
        return program

    def programs(self) -> Iterable[Program]:
        """Return all programs compiled so far."""
        return self._programs.values()

    def traced(self, name: str) -> Traced[int] | None:
        """Return the running code of a name, for `frame_of`."""
        program = self._programs.get(name.removeprefix("<cpl ").removesuffix(">"))
        return None if program is None else program.traced

    def source(self, name: str) -> Source:
        """Return the source of the running code of a name."""
        return self._programs[name.removeprefix("<cpl ").removesuffix(">")].source

    def _found(self, address: str, name: str) -> tuple[str, str] | None:
        key = (address, name)
        if key not in self._files:
            self._files[key] = self._find(address, name)
        return self._files[key]

    def _compiled(self, text: str, file: str, errors: list[ProgramError]) -> Program | None:
        if file in self._faulty:
            return None
        known = self._programs.get(file)
        if known is None or known.text != text:
            program, found = compile_program(text, file, stepping=self._stepping)
            errors += found
            if program is None:
                self._faulty.add(file)
                return None
            self._programs[file] = program
        return self._programs[file]

    def _check_calls(self, program: Program, stack: tuple[Program, ...], errors: list[ProgramError]) -> None:
        for call in program.calls:
            flaw = self._call_flaw(call, stack, errors)
            if flaw is not None:
                error = program.source.error(flaw)
                if str(error) not in map(str, errors):
                    errors.append(error)

    def _call_flaw(
        self, call: SubCall, stack: tuple[Program, ...], errors: list[ProgramError]
    ) -> Flaw | None:
        found = self._found(call.address, call.name)
        shown = f"{call.address}{call.name}" if call.address in ("G", "M") else call.name
        if found is None:
            return Flaw(call.at, f"there is no sub-program {shown}", "write it into a file of this name")
        if any(program.file == found[0] for program in stack):
            return Flaw(call.at, f"{shown} calls itself", "recursive calls are not possible")
        if len(stack) > NESTING:
            return Flaw(call.at, f"sub-programs are nested more than {NESTING} deep")
        if call.unlinked or is_marked_din(found[1].split("\n", 1)[0]):
            return None
        before = len(errors)
        program = self._compiled(found[1], found[0], errors)
        if program is not None and len(errors) == before:
            self._check_calls(program, (*stack, program), errors)
        return None
