"""One channel of a control that runs CPL programs: what its programs need of it, its files, its screen."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from polycnc.cnc import ProgramRun
from polycnc.controllers.bosch._block_buffer import BlockBuffer
from polycnc.controllers.bosch._called_codes import DRILLING, called_codes
from polycnc.controllers.bosch._memory import plain_variable
from polycnc.controllers.bosch._services import Services
from polycnc.controllers.bosch._system import BoschSystem
from polycnc.controllers.bosch.files import FileCommands
from polycnc.controllers.bosch.ncs import Coupling, Mmc, NcsServer
from polycnc.controllers.bosch.screen import Dialog, Image, Keyboard, Surface, read_bitmap
from polycnc.controllers.bosch.system import Category
from polycnc.errors import ProgramError
from polycnc.machine import MachineConfig, SnapshotError
from polycnc.nc import BlockSource, ProgramText, Returning, load_dialect
from polycnc.nc.cpl import (
    OMITTED,
    CodeCalls,
    CplLanguage,
    CplSource,
    Fault,
    Linker,
    PermanentMemory,
    holds_cpl,
    is_marked_typ2,
    text_of,
    undeclared,
)

_COMPUTING_S, _COMPUTING_SHARE = 0.2, 0.02
"""Of a loop that only computes: a second of processor time, or 4 million rounds."""
_WRITING_SHARE = 0.5
"""Of a loop that writes and shows, and asks nobody: some seconds of processor time, or 50,000 outputs."""
_WORD = re.compile(
    r"(?P<letter>[A-Za-z]) *(?:(?P<extension>[0-9]{1,2}) *= *)?(?P<value>[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))"
)


class ChannelHost:
    """What CPL programs of channel `number` need of their control (nc.cpl.Host).

    Sub-programs, files and permanent variables lie in the root of the `system`. Give the run that the language is used
    in to `attach`, and call `finish` when it is over. `functions` and `setters` may be added to. `server` is the
    control that MCODS and MCOPS ask, this one if None. `in_device` tells that programs follow each other: what does not
    outlive one ends with it.
    """

    def __init__(
        self,
        system: BoschSystem,
        number: int = 1,
        *,
        program: str | Path | None = None,
        keys: Iterable[str] = (),
        skip_levels: Iterable[int] = (),
        server: NcsServer | None = None,
        stepping: bool = False,
        in_device: bool = False,
    ) -> None:
        self.system = system
        self.number = number
        self.directory = system.directory
        self.kept = system.kept
        codes = called_codes(system, load_dialect("bosch"), lambda: system.axes.names_in(number))
        self.language = _Language(self, codes, skip_levels=frozenset(skip_levels), stepping=stepping)
        system.running_files.append(self._running_files)
        system.programs[number] = self
        self.buffer: BlockBuffer | None = None
        """The blocks put in by hand that wait, in a device."""
        self.files = FileCommands(
            self.directory,
            self._say,
            lambda: set().union(*(each() for each in system.running_files)),
            warn=self._warn,
            stored=system.open_files,
        )
        self.keyboard = Keyboard(keys, live=in_device)
        self.dialog = Dialog(
            self.keyboard, lambda: self.files.left_justified, self._bitmap, self._warn, few_keys=self._is_typ2
        )
        self.coupling = Coupling(server or NcsServer(Services(system)), system.shown.image, number)
        self._clock = system.clock
        self._in_device = in_device
        self._main = None if program is None else Path(program).resolve()
        self._unplaced: list[str] = []
        self.functions: dict[str, Callable[..., object]] = {
            **system.functions(number),
            **self.files.functions,
            **self.dialog.functions,
            "AXP": self._axis_word,
            "MCODS": self.coupling.mcods,
            "MCOPS": self.coupling.mcops,
            "MMC": Mmc(system.clients).call,
        }
        self.setters: dict[str, Callable[..., None]] = system.setters(number)

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
        """Return the words of a text in brackets, or the axis word of AXP.

        Raises:
            Fault: The text holds something else.
        """
        if isinstance(value, _AxisWord):
            return ((value.letter, value.extension, value.value),)
        return _words(text_of(value) or "")

    def program(self, address: str, name: str) -> tuple[str, str] | None:
        """Return file and text of a sub-program on the search path."""
        if address not in ("G", "M"):
            return self.system.program_of(name)
        code = f"{address}{name}"
        drilling = self.system.program_of(DRILLING[code]) if code in DRILLING else None
        return drilling or self.system.program(code)

    def under_way(self) -> str:
        """Return what of the control is under way and no snapshot keeps; empty if nothing is."""
        if self.files.any_open:
            return "a file is open"
        if self.dialog.is_open:
            return "a dialog is open"
        return "the coupling has not answered" if self.coupling.is_waiting else ""

    # ------------------------------------------------------------------ for who runs it

    @property
    def screen(self) -> Surface:
        """What the program has put on the screen."""
        return self.dialog.surface

    def attach(self, run: ProgramRun) -> None:
        """Take the run whose channel this control is, and what the root keeps.

        Raises:
            UsageError: Another control runs in the root.
        """
        permanence = self.system.permanence
        if self.has_statements(run.program):
            permanence.own()
        else:
            permanence.look()
        self.system.channels.attach(self.number, run)
        self.system.links.start_up()
        for each in self.system.not_installed:
            run.channel.messages.note(f"MSG: {each.what}", 0)

    @property
    def config(self) -> MachineConfig:
        """The machine file with the tables that programs change."""
        return self.system.live_config()

    def has_statements(self, program: ProgramText) -> bool:
        """Tell whether a program holds CPL."""
        return holds_cpl(program.content, self.language.codes.alone())

    def check(self, program: ProgramText) -> list[ProgramError]:
        """Link a program with its sub-programs without running it; return everything that is wrong."""
        linker = Linker(self.program, codes=self.language.codes)
        _, errors = linker.link(_decoded(program.content), program.name)
        for each in linker.programs():
            errors += undeclared(each, self.permanent)
        return [*self.system.errors_of_files, *self.system.not_installed, *errors]

    @property
    def waits(self) -> bool:
        """Whether a WAIT for a signal or a time is under way."""
        return any(source.waits for source in self.language.running[-1:])

    @property
    def is_buffered(self) -> bool:
        """Whether blocks can be put after those under way."""
        return self.buffer is not None

    @property
    def buffer_is_empty(self) -> bool:
        """Whether all blocks that were buffered have been taken, and more may come."""
        return self.buffer is not None and not self.buffer.waiting

    def wakes_in_s(self) -> float | None:
        """Return when the WAIT of the program ends at the latest (s from now), None if it is in none."""
        source = self.language.running[-1] if self.language.running else None
        if source is None or not source.waits:
            return None
        deadline = source.wait_ends_ms
        return float("inf") if deadline is None else max(deadline / 1000.0 - self._clock.now_s, 0.0)

    def stuck(self) -> ProgramError | None:
        """Return the error of a program that waits for what will not come."""
        hint = "give WAIT a duration, or the control the keys that the program asks for"
        return self._error_here("the program waits without end", hint)

    def looping(self, cycles: int, limit_s: float) -> ProgramError | None:
        """Return the error of a program that has looped for `cycles` cycles of standstill, None if it may go on.

        It must not come back to a state in which it was, nor loop for longer than `limit_s`; one that only computes may
        for a 50th of that, or 0.2 s, and one that also writes files and shows texts for half of it.
        """
        if not cycles:
            self.language.moves_on()
            return None
        if self.language.loops():
            hint = "nothing that it does can end the loop: change it, or put a block or a WAIT into it"
            return self._error_here("the program loops without end", hint)
        if self.language.only_computes():
            limit_s = min(limit_s, max(_COMPUTING_S, _COMPUTING_SHARE * limit_s))
        elif self.language.asks_nobody():
            limit_s = min(limit_s, max(_COMPUTING_S, _WRITING_SHARE * limit_s))
        if cycles * self._clock.cycle_s <= limit_s:
            return None
        hint = "put a block or a WAIT into the loop, or raise the limit: --loop-limit, loop_limit_s"
        return self._error_here(f"the program has looped for {limit_s:g} s without a block or a WAIT", hint)

    def _error_here(self, what: str, hint: str) -> ProgramError | None:
        running = self.language.running
        return running[-1].execution.error_here(what, hint) if running else None

    def finish(self) -> None:
        """End everything that does not outlive a program, and keep the permanent variables.

        Raises:
            UsageError: They cannot be kept.
        """
        try:
            self.files.close_all()
        except Fault as fault:
            self._say(f"{fault.what}: {fault.hint}")
        self.files.block = None
        self.dialog.finish()
        self.coupling.release()
        self.system.note_errors()
        try:
            self.system.permanence.keep()
        finally:
            self.system.permanence.release()

    def end_program(self) -> None:
        """Do the same in a device, where a program has ended by itself, by an error or a reset."""
        if self._in_device:
            self.keyboard.clear()
            self.finish()

    def release(self) -> None:
        """Forget what is asked of another control, and the keys that nobody has asked for."""
        self.keyboard.clear()
        self.coupling.release()

    def variables(self) -> dict[str, object]:
        """Return permanent and global variables as plain values, by name."""
        if not self.language.used and not self._in_device:
            return {}
        return {
            **self.kept.values(),
            **{name: _shown(value) for name, value in self.language.globals.items()},
        }

    # ------------------------------------------------------------------ within

    def _attached(self) -> ProgramRun:
        run = self.system.channels.run(self.number)
        assert run is not None, "attach the run first"
        return run

    def _axis_word(self, axis: object, position: object, kind: object = OMITTED) -> _AxisWord:
        """Return the word of an axis that is selected by its index (AXP)."""
        if not isinstance(axis, int | float) or isinstance(axis, bool):
            raise Fault("INVALID PARAMETER", "AXP takes an axis by its index")
        axes = self.system.axes
        found = axes.axis(self.number, int(axis) if axis == int(axis) else axis, kind)
        if found not in axes.channels[self.number]:
            raise Fault(
                "INVALID PARAMETER", f"axis {axes.physical_name(found)} does not belong to this channel"
            )
        if not isinstance(position, int | float) or isinstance(position, bool):
            raise Fault("INVALID PARAMETER", "AXP takes a number as the position")
        name = axes.logical_name(self.number, found)
        return _AxisWord(name[0], int(name[1:]) if name[1:] else None, float(position))

    def note(self, remark: str) -> None:
        """Put a remark of the control beside what the program says."""
        self._attached().channel.messages.note(remark, 0)

    def _say(self, text: str) -> None:
        line = self.language.running[-1].execution.statement_line if self.language.running else 0
        self._attached().channel.messages.note(f"MSG: {text}", line)

    def _warn(self, text: str) -> None:
        """Put out a warning, and note it for GETERR."""
        self._say(text)
        self.system.note_error(self.number, "", Category.RUNTIME_WARNING, text)

    def _is_typ2(self) -> bool:
        running = self.language.running
        return bool(running) and is_marked_typ2(running[-1].execution.program.source.text)

    def _bitmap(self, name: str) -> Image | None:
        folder = self.directory.root / "cplbmp"
        path = (folder / f"{name}.bmp").resolve()
        inside = path.is_relative_to(self.directory.root) and path.parent == folder
        return read_bitmap(path) if inside and path.is_file() else None

    def _running_files(self) -> set[Path]:
        files = {self.directory.root / source.execution.program.file for source in self.language.running}
        return files if self._main is None else files | {self._main}


class _AxisWord(NamedTuple):
    """A word of an axis: letter, extension (X2 has 2) or None, position."""

    letter: str
    extension: int | None
    value: float


class _Language(CplLanguage):
    """CPL on a control whose declarations of permanent variables are right."""

    def __init__(
        self, host: ChannelHost, codes: CodeCalls, *, skip_levels: frozenset[int], stepping: bool
    ) -> None:
        super().__init__(
            host, skip_levels=skip_levels, stepping=stepping, tables=host.system.links, codes=codes
        )
        self._host_of = host
        self.used = False
        """Whether a program with CPL has begun."""

    def save(self, under_way: Sequence[tuple[object, BlockSource | None]]) -> Any:
        """Return its state (see `CplLanguage.save`).

        Raises:
            SnapshotError: Buffered blocks are under way.
        """
        if any(isinstance(source, BlockBuffer) for _, source in under_way):
            raise SnapshotError("buffered blocks are under way", hint="take the snapshot when they are left")
        return super().save(under_way)

    def source(  # type: ignore[override]
        self, text: ProgramText, offset: int, line: int, arguments: object
    ) -> CplSource | BlockBuffer | None:
        buffer = self._host_of.buffer
        if buffer is not None and text is buffer.text:
            return buffer
        if self._host_of.system.errors_of_files:
            raise self._host_of.system.errors_of_files[0]
        try:
            source = super().source(text, offset, line, arguments)
        finally:
            for remark in self._host_of.system.links.take_remarks():
                self._host_of.note(remark)
        if source is not None and not self.used:
            self._host_of.system.permanence.own()
            self.used = True
        return source

    def restore_point(self, channel: object, saved: object) -> Returning:
        """Return what goes back to a state, with the variables of its programs."""
        back = super().restore_point(channel, saved)

        def go_back() -> Sequence[tuple[object, BlockSource | None]]:
            found = back()
            self.used = self.used or bool(self.running)
            return found

        return go_back

    def ended(self) -> None:
        """End what does not outlive the program."""
        self._host_of.end_program()


def _missing(name: str) -> Callable[..., Any]:
    def refuse(*_arguments: object, **_named: object) -> object:
        raise Fault(f"the control has no {name}", "this function is not simulated")

    return refuse


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
