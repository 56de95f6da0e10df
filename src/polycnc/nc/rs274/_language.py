"""RS274/NGC as the language of a channel: parameters, expressions and O-words."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from polycnc.errors import ProgramError
from polycnc.language import Traced, standing
from polycnc.machine import Machine, SnapshotError
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.rs274._parameters import Parameters
from polycnc.nc.rs274._program import Program, translate
from polycnc.nc.rs274._saved import SAVED_CLASSES, SavedLanguage, SavedProgram
from polycnc.nc.rs274._source import RunningProgram, sub_program_file
from polycnc.nc.rs274._structure import holds_language, is_numbered_within
from polycnc.nc.sources._block_source import BlockSource, Returning, elsewhere
from polycnc.nc.text._program import ProgramText

_FILES = re.compile(rb"\([ \t]*(LOGOPEN|LOGAPPEND|LOGCLOSE|LOG|PROBEOPEN|PROBECLOSE)\b", re.IGNORECASE)
"""A comment that asks LinuxCNC to write a file."""


class Host(Protocol):
    """What the language asks of the channel that it works for."""

    state: ChannelState
    machine: Machine
    messages: Messages
    skip_levels: frozenset[int]


class NgcLanguage:
    """Execute programs of RS274/NGC. Sub-programs in files of their own lie beside the main one, or in `folders`."""

    def __init__(self, folders: tuple[Path, ...] = ()) -> None:
        self.parameters = Parameters()
        self.fast_forward = False
        self._folders = folders
        self._channel: Host | None = None
        self._translated: dict[tuple[int, int], tuple[ProgramText, Program]] = {}
        self._files: dict[str, Program | None] = {}

    def attach(self, channel: Host) -> None:
        """Work for a channel: its positions and modal state are what parameters read."""
        self._channel = channel
        self.parameters.attach(channel.state, channel.machine)
        self._files.clear()

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> RunningProgram | None:
        """Return a source for the program that begins at byte `offset`, None where plain text needs none.

        Raises:
            ProgramError: the program cannot be translated.
        """
        self._tell_files(text)
        is_numbered = is_numbered_within(text.content)
        if not is_numbered and not holds_language(text.content):
            return None
        program = self._of(text, offset)
        return RunningProgram(self, program) if is_numbered or not program.plain else None

    @property
    def machine(self) -> Machine:
        """The machine that the channel prepares for."""
        assert self._channel is not None
        return self._channel.machine

    def kept_text(self) -> str:
        """Return the text of a file with the parameters that outlive a program."""
        return self.parameters.file_text()

    def loops(self) -> bool:
        """Tell whether programs go round for ever; that is not known here."""
        return False

    def moves_on(self) -> None:
        """Take note that something has happened; nothing is kept of it."""

    def skips(self, level: int) -> bool:
        """Tell whether lines with a skip mark of this number are left out."""
        return self._channel is not None and level in self._channel.skip_levels

    def file_of(self, name: str, main: ProgramText) -> Program | None:
        """Return the translated file of a sub-program, None if there is none.

        Raises:
            ProgramError: the file cannot be translated.
            UsageError: the file cannot be read.
        """
        if name not in self._files:
            path = sub_program_file(
                name, main, (*self._folders, *map(Path, self.machine.config.programs.folders))
            )
            text = None if path is None else ProgramText.from_path(path)
            self._files[name] = None if text is None else self._of(text, 0)
            if text is not None:
                self._tell_files(text)
        return self._files[name]

    def _tell_files(self, text: ProgramText) -> None:
        """Say which comments would write files and do not."""
        assert self._channel is not None
        known: set[bytes] = set()
        for found in _FILES.finditer(text.content):
            word = found[1].upper()
            begin = text.content.rfind(b"\n", 0, found.start()) + 1
            if word in known or b";" in text.content[begin : found.start()]:
                continue
            known.add(word)
            line = text.content.count(b"\n", 0, begin) + 1
            self._channel.messages.note(f"({word.decode('ascii')}) writes no file here", line)

    # ------------------------------------------------------------------ where it stands

    @property
    def classes(self) -> Sequence[type]:
        """The classes of which its state is made."""
        return SAVED_CLASSES

    def save(self, under_way: Sequence[tuple[object, BlockSource | None]]) -> SavedLanguage:
        """Return all that it holds, with where its programs stand."""
        common, others = self.parameters.saved()
        return SavedLanguage(
            common,
            others,
            dict(self.parameters.names),
            self.parameters.level,
            tuple(source.saved() if isinstance(source, RunningProgram) else None for _, source in under_way),
        )

    def restore_point(self, channel: Host, saved: object) -> Returning:
        """Return what goes back to a state; nothing changes yet.

        Raises:
            SnapshotError: A program of the state cannot go on from there.
        """
        if not isinstance(saved, SavedLanguage):
            raise SnapshotError("this is a snapshot of another language", hint="use another one")
        programs = [None if each is None else (each, self._standing(each)) for each in saved.under_way]
        return lambda: self._go_to(saved, programs)

    def _standing(self, saved: SavedProgram) -> list[tuple[Program, Traced[int] | None]]:
        found: list[tuple[Program, Traced[int] | None]] = []
        for level in saved.levels:
            try:
                program = self._of(level.text, level.offset)
                found.append((program, standing(program.functions[level.label], level.line, level.names)))
            except (ProgramError, LookupError, ValueError) as error:
                raise elsewhere(level.text) from error
        return found

    def _go_to(
        self,
        saved: SavedLanguage,
        programs: Sequence[tuple[SavedProgram, list[tuple[Program, Traced[int] | None]]] | None],
    ) -> list[tuple[object, BlockSource | None]]:
        """Go back to a state; return the programs under way."""
        self.parameters.restore_state(saved.common, saved.others, saved.names)
        sources = [
            None if each is None else RunningProgram(self, each[1][0][0]).go_to(*each) for each in programs
        ]
        self.parameters.level = saved.level
        return [(None, source) for source in sources]

    def _of(self, text: ProgramText, offset: int) -> Program:
        key = id(text), offset
        if key not in self._translated:
            self._translated[key] = text, translate(text, offset)
        return self._translated[key][1]
