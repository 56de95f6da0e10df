"""The file commands of CPL: OPENW, OPENR, PRN#, INP# and those around them (Manual 003, chapter 6)."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from datetime import datetime
from pathlib import Path

from polycnc.controllers.bosch.files._directory import LONGEST_NAME, Directory, is_file
from polycnc.controllers.bosch.files._handle import Handle
from polycnc.controllers.bosch.files._print import as_output
from polycnc.controllers.bosch.files._selected_block import NO_BLOCK, SelectedBlock
from polycnc.controllers.bosch.files._stored import LONGEST_RECORD, StoredFile
from polycnc.nc.cpl import OMITTED, CharacterField, Fault, text_of

NUMBERS = range(1, 10)
_SMALLEST = 130
_ACTIVE = 16
_INVALID_NUMBER = "INVALID LOGICAL NUMBER"


class FileCommands:
    """The files that a program has open, and what it can do with files.

    `say` puts a text out as a message, `warn` a warning (a message, if absent), `active` holds the paths of the
    programs that run, `stored` the files that any program of the control has opened.
    """

    def __init__(
        self,
        directory: Directory,
        say: Callable[[str], None],
        active: Callable[[], Container[Path]],
        *,
        warn: Callable[[str], None] | None = None,
        stored: dict[Path, StoredFile] | None = None,
    ) -> None:
        self._stored = {} if stored is None else stored
        self._warn = warn or say
        self._directory = directory
        self._say = say
        self._active = active
        self.block: SelectedBlock | None = None
        """The block that is selected in the editor: number 0 means it, and without one the messages."""
        self._open: dict[int, Handle] = {}
        self._left = False
        self.functions: Mapping[str, Callable[..., object]] = {
            "OPENW": self._writing(self._openw), "OPENR": self._openr, "PRN#": self._writing(self._print),
            "INP#": self._input, "REWRITE": self._writing(self._rewrite), "CLOSE": self._writing(self._close),
            "EOF": self._eof, "FILEPOS": self._filepos, "SEEK": self._seek, "FILESIZE": self._filesize,
            "ERASE": self._writing(self._erase), "LJUST": self._ljust,
            "NJUST": self._njust, "FILEACCESS": self._access, "FILEDATE": self._date,
        }  # fmt: skip

    @property
    def any_open(self) -> bool:
        """Whether the program has a file open."""
        return bool(self._open)

    @property
    def left_justified(self) -> bool:
        """Whether LJUST is in force."""
        return self._left

    def close_all(self) -> None:
        """Close all files, as at the end of a program; numbers are formatted again.

        Raises:
            Fault: The end of a record could not be written; all files are closed nevertheless.
        """
        self._left = False
        self._directory.writes += 1
        handles, self._open = list(self._open.values()), {}
        trouble: Fault | None = None
        for handle in handles:
            try:
                handle.close()
            except Fault as fault:
                trouble = fault
        if trouble is not None:
            raise trouble

    # ------------------------------------------------------------------ opening and closing

    def _openw(self, number: object, name: object, *rest: object) -> int:
        reserved = _whole(rest[0]) if rest and rest[0] is not OMITTED else None
        if reserved is not None and reserved < _SMALLEST:
            raise Fault("ILLEGAL FILE SIZE", f"reserve at least {_SMALLEST} bytes")
        length: int | None = None
        if len(rest) == 2 and not isinstance(rest[1], str | CharacterField) and rest[1] is not OMITTED:
            length = _record_length(rest[1])
        elif len(rest) > 2 and rest[2] is not OMITTED:
            length = _record_length(rest[2])
        place, path = self._new_number(number), self._directory.path(_name(name))
        if path in self._active():
            raise Fault(
                "FILE ALREADY OPEN", f"{path.name} is a program that runs: it cannot be written meanwhile"
            )
        file = self._file(path, writing=True)
        if file.writer:
            raise Fault("FILE ALREADY OPEN", f"{path.name} is open for writing")
        if length is not None:
            file.check_records(length)
        file.begin_writing()
        file.writer = True
        self._open[place] = Handle(file, length, writing=True)
        return 0

    def _openr(self, number: object, name: object, length: object = OMITTED) -> int:
        records = None if length is OMITTED else _record_length(length)
        place, path = self._new_number(number), self._directory.path(_name(name))
        file = self._file(path, writing=False)
        if records is not None:
            file.check_records(records)
        file.readers += 1
        self._open[place] = Handle(file, records, writing=False)
        return 0

    def _close(self, number: object) -> int:
        place = _logical(number, _INVALID_NUMBER)
        handle = self._handle(place, _INVALID_NUMBER)
        del self._open[place]
        handle.close()
        return 0

    def _new_number(self, number: object) -> int:
        place = _logical(number, _INVALID_NUMBER)
        if place in self._open:
            raise Fault(_INVALID_NUMBER, f"file {place} is open already: close it before")
        return place

    def _file(self, path: Path, *, writing: bool) -> StoredFile:
        file = self._stored.get(path)
        if file is None or not file.in_use:
            file = self._stored[path] = StoredFile(path, writing=writing)
        return file

    # ------------------------------------------------------------------ writing and reading

    def _print(self, number: object, *items: object, open: bool = False) -> int:
        output = as_output(items, left=self._left)
        if output.misfits:
            self._warn(f"PRN FORMAT INCORRECT: {', '.join(output.misfits)}")
        if number == 0 and not isinstance(number, bool):
            if self.block is None:
                self._say(output.text)
            else:
                self.block.text = output.text
            return 0
        handle = self._handle(_logical(number, _INVALID_NUMBER), _INVALID_NUMBER)
        if not handle.writing:
            raise Fault(_INVALID_NUMBER, f"file {number} is open for reading: use OPENW")
        handle.put(output.text, stays_open=open)
        return 0

    def _input(self, number: object, *variables: object, open: bool = False) -> int:
        if number == 0 and not isinstance(number, bool):
            (self.block or NO_BLOCK).read(*variables)
            return 0
        self._reading(number, _INVALID_NUMBER).take(variables, stays_open=open)
        return 0

    def _rewrite(self, number: object) -> int:
        handle = self._handle(_logical(number, _INVALID_NUMBER), _INVALID_NUMBER)
        if not handle.writing:
            raise Fault(_INVALID_NUMBER, f"file {number} is open for reading: use OPENW")
        handle.rewrite()
        return 0

    def _eof(self, number: object) -> bool:
        return self._handle(_logical(number, _INVALID_NUMBER), _INVALID_NUMBER).at_end

    def _ljust(self) -> int:
        self._left = True
        return 0

    def _njust(self) -> int:
        self._left = False
        return 0

    # ------------------------------------------------------------------ places and sizes

    def _filepos(self, number: object, mode: object = OMITTED) -> int:
        handle = self._handle(_logical(number, "INVALID FILE NUMBER"), "INVALID FILE NUMBER")
        return handle.place(None if mode is OMITTED else _whole(mode))

    def _seek(self, number: object, place: object, offset: object = OMITTED) -> int:
        handle = self._handle(_logical(number, "INVALID FILE NUMBER"), "INVALID FILE NUMBER")
        handle.seek(_whole(place), None if offset is OMITTED else _whole(offset))
        return 0

    def _filesize(self, number: object, what: object = OMITTED) -> int:
        handle = self._reading(number, "INVALID FILE NUMBER")
        return handle.size(None if what is OMITTED else _whole(what))

    # ------------------------------------------------------------------ files by name

    def _erase(self, name: object) -> int:
        text = _name(name)
        if text is None or len(text.rpartition("/")[2]) > LONGEST_NAME:
            raise Fault("INVALID FILE NAME", f"a name has at most {LONGEST_NAME} characters")
        path = self._directory.path(text)
        if not path.exists():
            code, why = 1, "it does not exist"
        elif self._is_active(path):
            code, why = 3, "it is active"
        elif not is_file(path) or not self._directory.access(text) & 2:
            code, why = 2, "it is erase-protected"
        else:
            try:
                path.unlink()
                return 0
            except OSError:
                code, why = 2, "it is erase-protected"
        self._warn(f"{text} was not erased: {why}")
        return code

    def _access(self, name: object) -> int:
        text = _name(name)
        bits = self._directory.access(text)
        return bits if bits < 0 or not self._is_active(self._directory.path(text)) else bits | _ACTIVE

    def _date(self, name: object, mode: object = OMITTED) -> str:
        form = {1: "%d.%m.%y", 2: "%H.%M.%S"}.get(1 if mode is OMITTED else _whole(mode))
        if form is None:
            raise Fault("INVALID PARAMETER", "modes of FILEDATE are 1 and 2")
        try:
            return datetime.fromtimestamp(self._directory.path(_name(name)).stat().st_mtime).strftime(form)
        except (Fault, OSError):
            return ""

    def _is_active(self, path: Path) -> bool:
        file = self._stored.get(path)
        return path in self._active() or (file is not None and file.in_use)

    # ------------------------------------------------------------------ within

    def _writing(self, command: Callable[..., object]) -> Callable[..., object]:
        """Return a command after which texts of programs are read anew."""

        def write(*arguments: object, **named: object) -> object:
            self._directory.writes += 1
            return command(*arguments, **named)

        return write

    def _handle(self, number: int, trouble: str) -> Handle:
        if number not in self._open:
            raise Fault(trouble, f"file {number} is not open")
        return self._open[number]

    def _reading(self, number: object, trouble: str) -> Handle:
        handle = self._handle(_logical(number, trouble), trouble)
        if handle.writing:
            raise Fault(trouble, f"file {number} is open for writing: use OPENR")
        return handle


def _logical(number: object, trouble: str) -> int:
    if type(number) is not int or number not in NUMBERS:
        raise Fault(trouble, "logical numbers are INTEGER, 1 to 9")
    return number


def _whole(value: object) -> int:
    if type(value) is not int:
        raise Fault("INVALID PARAMETER", "an INTEGER is needed")
    return value


def _record_length(value: object) -> int:
    if type(value) is not int or not 1 <= value <= LONGEST_RECORD:
        raise Fault("INVALID COMPONENT LENGTH", f"records have 1 to {LONGEST_RECORD} characters")
    return value


def _name(value: object) -> str | None:
    """Return the name of a file; a number stands for the P name of older controls."""
    return f"P{value}" if type(value) is int else text_of(value)
