"""A control that runs CPL programs: one channel, the files of its root, its screen and its permanent variables."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from polycnc.cnc import ProgramRun
from polycnc.controllers.bosch._memory import KeptVariables, plain_variable
from polycnc.controllers.bosch._positions import Positions
from polycnc.controllers.bosch._system_functions import SystemFunctions
from polycnc.controllers.bosch.files import Directory, FileCommands
from polycnc.errors import ProgramError
from polycnc.machine import Clock
from polycnc.nc import ProgramText
from polycnc.nc.cpl import (
    CplLanguage,
    CplSource,
    Fault,
    Linker,
    PermanentMemory,
    text_of,
    undeclared,
)

_WORD = re.compile(
    r"(?P<letter>[A-Za-z]) *(?:(?P<extension>[0-9]{1,2}) *= *)?(?P<value>[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))"
)


class Pnc:
    """What a CPL program needs of the control (nc.cpl.Host), for a run of one program.

    `root` is the control's directory: sub-programs, files and permanent variables lie in it. Give the run that the
    language is used in to `attach`, and call `finish` when it is over. `functions` and `setters` may be added to.
    """

    def __init__(
        self,
        root: str | Path,
        clock: Clock,
        *,
        program: str | Path | None = None,
        keys: Iterable[str] = (),
        skip_levels: Iterable[int] = (),
    ) -> None:
        self.directory = Directory(root)
        self.kept = KeptVariables(self.directory)
        self.system = SystemFunctions(clock, self._attached)
        self.language = _Language(self, skip_levels=frozenset(skip_levels))
        self.files = FileCommands(self.directory, self._say, self._running_files)
        self._clock = clock
        self._run: ProgramRun | None = None
        self._main = None if program is None else Path(program).resolve()
        self._unplaced: list[str] = []
        self.functions: dict[str, Callable[..., object]] = {
            **Positions(self._attached).functions,
            **self.files.functions,
            **self.system.functions,
        }
        self.setters: dict[str, Callable[..., None]] = dict(self.system.setters)

    # ------------------------------------------------------------------ nc.cpl.Host

    @property
    def permanent(self) -> PermanentMemory:
        """Permanent variables by name."""
        return self.kept.memory

    def function(self, name: str) -> Callable[..., object]:
        """Return a function of the control; one that it does not have refuses when it is called."""
        return self.functions.get(name) or _missing(name)

    def setter(self, name: str) -> Callable[..., None]:
        """Return what an assignment to a system value does; one that cannot be set refuses when it is tried."""
        return self.setters.get(name) or _missing(name)

    def insert(self, value: object) -> tuple[tuple[str, int | None, float], ...]:
        """Return the words of a text in brackets.

        Raises:
            Fault: The text holds something else.
        """
        return _words(text_of(value) or "")

    def program(self, address: str, name: str) -> tuple[str, str] | None:
        """Return file and text of a sub-program in the root."""
        for file in _file_names(address, name):
            try:
                text = self.directory.text(file)
            except Fault:
                continue
            if text is not None:
                return file, text
        return None

    # ------------------------------------------------------------------ for who runs it

    def attach(self, run: ProgramRun) -> None:
        """Take the run whose channel this control is."""
        self._run = run

    def check(self, program: ProgramText) -> list[ProgramError]:
        """Link a program with its sub-programs without running it; return everything that is wrong."""
        linker = Linker(self.program)
        _, errors = linker.link(_decoded(program.content), program.name)
        for each in linker.programs():
            errors += undeclared(each, self.permanent)
        return [*self.kept.errors, *errors]

    def wakes_in_s(self) -> float | None:
        """Return when the WAIT of the program ends at the latest (s from now), None if it is in none."""
        source = self.language.running[-1] if self.language.running else None
        if source is None or not source.waits:
            return None
        deadline = source.wait_ends_ms
        return float("inf") if deadline is None else max(deadline / 1000.0 - self._clock.now_s, 0.0)

    def stuck(self) -> ProgramError | None:
        """Return the error of a program that waits for what will not come."""
        if not self.language.running:
            return None
        hint = "give WAIT a duration, or the control the keys that the program asks for"
        return self.language.running[-1].execution.error_here("the program waits without end", hint)

    def finish(self) -> None:
        """End everything that does not outlive a program, and keep the permanent variables.

        Raises:
            UsageError: They cannot be kept.
        """
        try:
            self.files.close_all()
        except Fault as fault:
            self._say(f"{fault.what}: {fault.hint}")
        self.kept.keep()

    def variables(self) -> dict[str, object]:
        """Return permanent and global variables as plain values, by name."""
        return {
            **self.kept.values(),
            **{name: _shown(value) for name, value in self.language.globals.items()},
        }

    # ------------------------------------------------------------------ within

    def _attached(self) -> ProgramRun:
        assert self._run is not None, "attach the run first"
        return self._run

    def _say(self, text: str) -> None:
        line = self.language.running[-1].execution.statement_line if self.language.running else 0
        self._attached().channel.messages.note(f"MSG: {text}", line)

    def _running_files(self) -> set[Path]:
        files = {self.directory.root / source.execution.program.file for source in self.language.running}
        return files if self._main is None else files | {self._main}


class _Language(CplLanguage):
    """CPL on a control whose declarations of permanent variables are right."""

    def __init__(self, pnc: Pnc, *, skip_levels: frozenset[int]) -> None:
        super().__init__(pnc, skip_levels=skip_levels)
        self._pnc = pnc

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> CplSource | None:
        if self._pnc.kept.errors:
            raise self._pnc.kept.errors[0]
        return super().source(text, offset, line, arguments)


def _missing(name: str) -> Callable[..., Any]:
    def refuse(*_arguments: object, **_named: object) -> object:
        raise Fault(f"the control has no {name}", "this function is not simulated")

    return refuse


def _file_names(address: str, name: str) -> tuple[str, ...]:
    """Return the files that a call may mean: G22 lies in G22, P999 in P999 or 999."""
    if address in ("G", "M"):
        return (f"{address}{name}",)
    return (f"P{name}", name) if name[:1].isdigit() else (name,)


def _words(text: str) -> tuple[tuple[str, int | None, float], ...]:
    found: list[tuple[str, int | None, float]] = []
    end = 0
    text = text.strip()
    for word in _WORD.finditer(text):
        if text[end : word.start()].strip():
            break
        extension = None if word["extension"] is None else int(word["extension"])
        found.append((word["letter"].upper(), extension, float(word["value"])))
        end = word.end()
    if text[end:].strip():
        raise Fault("INVALID PARAMETER", f"'{text[end:].strip()}' is no NC word")
    return tuple(found)


def _shown(value: object) -> object:
    try:
        return plain_variable(value if isinstance(value, int | float | None) else _text_or_field(value))
    except Fault:
        return None


def _text_or_field(value: object) -> object:
    return value if hasattr(value, "sizes") or isinstance(value, str) else text_of(value)


def _decoded(content: bytes) -> str:
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("latin-1")
