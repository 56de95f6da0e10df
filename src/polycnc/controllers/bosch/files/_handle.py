"""An open file as a program sees it: one logical number, one place in the file (Manual 003, 6.2 to 6.9)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from polycnc.controllers.bosch.files._stored import LONGEST_RECORD, StoredFile
from polycnc.nc.cpl import Box, CharacterField, Fault, Section

_NUMBERS = {
    "I": re.compile(r" *([+-]? *[0-9]+)"),
    "R": re.compile(r" *([+-]? *(?:[0-9]+\.?[0-9]*|\.[0-9]+))"),
}
_LIMITS = {"I": 2**31 - 1, "R": 3.4028235e38, "D": 1.7976931348623157e308}
_TOO_LONG = "BLOCK EXCEEDS 1024 BYTES"


class Handle:
    """Read or write a file of records of any length (`length` None), or of one length.

    `at` is the place in the file, a byte from 0 on.
    """

    def __init__(self, file: StoredFile, length: int | None, *, writing: bool) -> None:
        self.file = file
        self.length = length
        self.writing = writing
        self.at = len(file.data) if writing else 0
        self._open_record = False

    @property
    def at_end(self) -> bool:
        """Whether the place is at the EOF pointer."""
        return self.at >= len(self.file.data)

    def close(self) -> None:
        """End a record that a semicolon has left open, and let the file go."""
        try:
            self.end_record()
        finally:
            if self.writing:
                self.file.writer = False
            else:
                self.file.readers -= 1
            if not self.file.in_use:
                self.file.close()

    # ------------------------------------------------------------------ writing

    def put(self, text: str, *, stays_open: bool) -> None:
        """Write a text as a record, or into one; with `stays_open` the next text follows in the same.

        Raises:
            Fault: It is too long, or cannot be written; nothing has been written then.
        """
        if len(text) > LONGEST_RECORD:
            raise Fault(_TOO_LONG)
        try:
            lines = text.encode("latin-1").split(b"\r")
        except UnicodeEncodeError as error:
            raise Fault("INVALID CHARACTER", f"'{text[error.start]}' is no character of 8 bits") from None
        if self.length is None:
            self._append(lines, stays_open)
        else:
            for line in lines[:-1]:
                self._overwrite(line, self.length, stays_open=False)
            self._overwrite(lines[-1], self.length, stays_open=stays_open)

    def end_record(self) -> None:
        """End a record that a semicolon has left open."""
        if self._open_record:
            self._open_record = False
            if self.length is None:
                self.file.write(len(self.file.data), b"\n")

    def rewrite(self) -> None:
        """Discard what is in the file."""
        self._open_record = False
        self.file.discard()
        self.at = 0

    def _append(self, lines: list[bytes], stays_open: bool) -> None:
        data = self.file.data
        begun = len(data) - (data.rfind(b"\n") + 1) if self._open_record else 0
        if begun + len(lines[0]) > LONGEST_RECORD:
            raise Fault(_TOO_LONG, "the record that a semicolon has left open is part of it")
        if any(b"\n" in line for line in lines):
            raise Fault("INVALID CHARACTER", "CHR$(13) begins a new record, CHR$(10) cannot be part of one")
        self.file.write(len(data), b"\n".join(lines) + (b"" if stays_open else b"\n"))
        self._open_record = stays_open
        self.at = len(data)

    def _overwrite(self, line: bytes, length: int, *, stays_open: bool) -> None:
        if b"\n" in line:
            raise Fault("INVALID CHARACTER", "CHR$(13) begins a new record, CHR$(10) cannot be part of one")
        record = self.at // (length + 1) * (length + 1)
        offset = self.at - record
        part = line[: length - offset]
        end = offset + len(part)
        if self.at_end:
            self.file.write(record, part.ljust(length) + b"\n")
        else:
            self.file.write(self.at, part if stays_open else part.ljust(length - offset))
        self.at = record + (end if stays_open else length + 1)

    # ------------------------------------------------------------------ reading

    def take(self, variables: Iterable[object], *, stays_open: bool) -> None:
        """Read a record into variables, one after the other.

        Raises:
            Fault: A number is too large for its variable, or a text has no room.
        """
        data = self.file.data
        end = data.find(b"\n", self.at)
        end = len(data) if end < 0 else end
        text = data[self.at : end].decode("latin-1")
        if text.endswith("\r"):
            text = text[:-1]
        used = 0
        for variable in variables:
            used += _read(text[used:], variable)
        after = min(end + 1, len(data))
        self.at = self.at + used if stays_open and used < len(text) else after

    # ------------------------------------------------------------------ places

    def seek(self, place: int, offset: int | None) -> None:
        """Go to byte or record `place` (0: the EOF pointer), in a record to byte `offset` from 1 on.

        Raises:
            Fault: There is no such place.
        """
        data = self.file.data
        if self.length is None:
            if self.writing:
                raise Fault("INVALID COMPONENT", "SEEK in a sequential file needs OPENR")
            if offset is not None:
                raise Fault("INVALID PARAMETER", "an offset is for records of one length")
            if not 0 <= place <= len(data) + 1:
                raise Fault("INVALID COMPONENT", f"the file has {len(data)} bytes before the EOF pointer")
            self.at = place - 1 if place else len(data)
            return
        size = self.length + 1
        records = len(data) // size
        if not 0 <= place <= records + 1:
            raise Fault("INVALID COMPONENT", f"the file has {records} records")
        if offset is not None and not 1 <= offset <= size:
            raise Fault("INVALID PARAMETER", f"an offset in a record is 1 to {size}")
        begin = (place - 1) * size if place else len(data)
        self.at = begin if begin >= len(data) else begin + (offset or 1) - 1

    def place(self, mode: int | None) -> int:
        """Return the place: mode 1 the byte, 2 the record, 3 the byte in the record, all from 1 on.

        Raises:
            Fault: The file has no such mode.
        """
        modes = (1,) if self.length is None else (1, 2, 3)
        if mode is None:
            mode = modes[-1] if len(modes) == 1 else 2
        if mode not in modes:
            raise Fault("INVALID PARAMETER", f"modes of this file are {', '.join(map(str, modes))}")
        if mode == 1 or self.length is None:
            return self.at + 1
        record, offset = divmod(self.at, self.length + 1)
        return (record if mode == 2 else offset) + 1

    def size(self, what: int | None) -> int:
        """Return 1: the bytes of the file, 2: those before the EOF pointer, 3 and 4: the records.

        Raises:
            Fault: The file has no such size.
        """
        most = 2 if self.length is None else 4
        what = 1 if what is None else what
        if not 1 <= what <= most:
            raise Fault("INVALID PARAMETER", f"sizes of this file are 1 to {most}")
        data = len(self.file.data)
        if what <= 2 or self.length is None:
            return data + (2 if what == 1 else 0)
        return data // (self.length + 1)


def _read(text: str, variable: object) -> int:
    """Set a variable from the beginning of a text; return how many characters that took."""
    if isinstance(variable, Box) and variable.kind != "S":
        return _read_value(text, variable)
    if isinstance(variable, CharacterField):
        variable.assign(text[: variable.size])
        return min(len(text), variable.size)
    if isinstance(variable, Section):
        part = text[: variable.length]
        variable.write(part)
        return len(part)
    raise Fault(
        "inadmissible assignment to a non-dimensioned STRING variable", "dimension it with DIM before"
    )


def _read_value(text: str, box: Box) -> int:
    box.value = None
    if box.kind == "B":
        for word in ("TRUE", "FALSE"):
            if text.lstrip(" ").startswith(word):
                box.value = word == "TRUE"
                return len(text) - len(text.lstrip(" ")) + len(word)
        return 0
    kind = "I" if box.kind == "I" else "R"
    found = _NUMBERS[kind].match(text)
    if found is None:
        return 0
    digits = found[1].replace(" ", "")
    convert: Callable[[str], int | float] = int if kind == "I" else float
    value = convert(digits)
    if not -_LIMITS[box.kind] - (kind == "I") <= value <= _LIMITS[box.kind]:
        raise Fault(
            "INVALID INTEGER VALUE" if kind == "I" else "INVALID FLOAT VALUE", f"{digits} is too large"
        )
    box.value = value
    return found.end()
