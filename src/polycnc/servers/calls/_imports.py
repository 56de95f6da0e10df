"""What a program takes from a library: import tables of Windows programs (PE), symbols of Linux ones (ELF)."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from pathlib import Path

from polycnc.controllers.library.clib import CLibrary
from polycnc.errors import UsageError

_MOST_BYTES = 256 << 20
_MOST_NAMES = 65_536
_MOST_LIBRARIES = 4096
_MOST_SECTIONS = 96
_MOST_NAME = 512
_PE32, _PE64 = 0x10B, 0x20B
_IMPORTS, _DELAYED = 1, 13  # data directories
_DYNSYM, _UNDEFINED = 11, 0


_PREFIX = re.compile(r"[A-Za-z]+_")


class _Broken(Exception):  # noqa: N818  becomes a UsageError
    """A file whose tables lead out of it."""


def missing_of(path: Path, library: CLibrary) -> tuple[list[str], list[str]]:
    """Return what a program takes from a library, in order, and what of it the library does not have.

    Ordinals are `#NUMBER`. What a program loads by name while it runs is not seen. A Linux program does not say from
    which library it takes a name: what begins as all names of the library do is its own.

    Raises:
        UsageError: It cannot be read, is no program for Windows or Linux, or does not tell.
    """
    names = _imports_of(path, library)
    return names, [each for each in names if each not in library.functions and each not in library.aliases]


def _imports_of(path: Path, library: CLibrary) -> list[str]:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise UsageError(f"{path} has more than {_MOST_BYTES >> 20} MB", hint="Name the program itself.")
        content = path.read_bytes()
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}", hint="Name a program.") from None
    try:
        if content[:2] == b"MZ":
            names = _some(_of_windows(content, library.name.lower()))
        elif content[:4] == b"\x7fELF":
            names = _of_library(_some(_of_linux(content)), path, library)
        else:
            raise UsageError(
                f"{path} is no program for Windows or Linux", hint="Name an .exe, .dll or ELF file."
            )
    except (_Broken, struct.error):
        raise UsageError(f"{path} is cut or broken: its tables lead out of it", hint="Get it anew.") from None
    return list(dict.fromkeys(names))


def _some(names: Iterator[str]) -> list[str]:
    """Return names, so many as a program may have: tables that overlap have far more."""
    found = list(islice(names, _MOST_NAMES + 1))
    if len(found) > _MOST_NAMES:
        raise _Broken
    return found


def _of_library(names: Iterable[str], path: Path, library: CLibrary) -> list[str]:
    """Return the names that begin as those of a library."""
    found = {_PREFIX.match(each) for each in library.functions}
    begins = tuple({each[0] for each in found if each})
    if None in found:
        raise UsageError(
            f"{path} is a Linux program, which does not say what it takes from {library.name}",
            hint=f"The linker names what lib{library.name}.so does not have: link it anew.",
        )
    return [each for each in names if each.startswith(begins)]


def _text(content: bytes, at: int) -> str:
    """Return a text that ends in a zero."""
    end = content.find(b"\0", at, at + _MOST_NAME)
    if not 0 <= at < len(content) or end < 0:
        raise _Broken
    return content[at:end].decode("latin-1")


def _read(content: bytes, form: str, at: int) -> tuple[int, ...]:
    if at < 0:
        raise _Broken
    return struct.unpack_from(form, content, at)


def _of_windows(content: bytes, library: str) -> Iterator[str]:
    (header,) = _read(content, "<I", 0x3C)
    if content[header : header + 4] != b"PE\0\0":
        raise _Broken
    sections, optional_size = _read(content, "<H12xH", header + 6)
    optional = header + 24
    (magic,) = _read(content, "<H", optional)
    if magic not in (_PE32, _PE64):
        raise _Broken
    wide = magic == _PE64
    base = _read(content, "<Q", optional + 24)[0] if wide else _read(content, "<I", optional + 28)[0]
    directories = optional + (112 if wide else 96)
    (count,) = _read(content, "<I", directories - 4)
    table = [
        _read(content, "<IIII", optional + optional_size + 40 * k + 8)
        for k in range(min(sections, _MOST_SECTIONS))
    ]

    def place(address: int) -> int:
        """Return where an address of the loaded program lies in the file."""
        for size, at, held, begin in table:
            if at <= address < at + max(size, held):
                return begin + address - at
        raise _Broken

    for number, size, name_at, thunks_at in ((_IMPORTS, 20, 12, 0), (_DELAYED, 32, 4, 16)):
        if number >= count:
            continue
        (begin,) = _read(content, "<I", directories + 8 * number)
        for k in range(_MOST_LIBRARIES if begin else 0):
            row = place(begin) + k * size
            (name,) = _read(content, "<I", row + name_at)
            (thunks,) = _read(content, "<I", row + thunks_at)
            if number == _IMPORTS and not thunks:
                (thunks,) = _read(content, "<I", row + 16)
            if not name:
                break
            # old delayed imports have addresses in place of distances
            shift = base if number == _DELAYED and not _read(content, "<I", row)[0] & 1 else 0
            if _text(content, place(name - shift)).lower().removesuffix(".dll") == library:
                yield from (
                    _thunk(content, each, place, shift)
                    for each in _thunks(content, place(thunks - shift), wide)
                )


def _thunks(content: bytes, at: int, wide: bool) -> Iterator[int]:
    """Go through a list of imports; one by ordinal is negative."""
    form, size, top = ("<Q", 8, 1 << 63) if wide else ("<I", 4, 1 << 31)
    for k in range(_MOST_NAMES):
        (each,) = _read(content, form, at + k * size)
        if not each:
            return
        yield -(each & 0xFFFF) if each & top else each
    raise _Broken


def _thunk(content: bytes, each: int, place: Callable[[int], int], shift: int) -> str:
    return f"#{-each}" if each <= 0 else _text(content, place(each - shift) + 2)


def _of_linux(content: bytes) -> Iterator[str]:
    wide, little = content[4:5] == b"\2", content[5:6] == b"\1"
    if content[4:5] not in (b"\1", b"\2") or content[5:6] not in (b"\1", b"\2"):
        raise _Broken
    order = "<" if little else ">"
    (sections,) = _read(content, f"{order}{'Q' if wide else 'I'}", 40 if wide else 32)
    size, count = _read(content, f"{order}HH", 58 if wide else 46)
    section = f"{order}II{'QQQQIIQQ' if wide else 'IIIIIIII'}"
    if size != struct.calcsize(section):
        raise _Broken
    rows = [_read(content, section, sections + k * size) for k in range(count)]
    for row in rows:
        if row[1] != _DYNSYM:
            continue
        begin, length, names = row[4], row[5], row[6]
        if names >= len(rows) or begin + length > len(content):
            raise _Broken
        step = 24 if wide else 16
        for k in range(1, min(length // step, _MOST_NAMES)):
            at = begin + k * step
            (name,) = _read(content, f"{order}I", at)
            (within,) = _read(content, f"{order}H", at + (6 if wide else 14))
            if within == _UNDEFINED and name:
                yield _text(content, rows[names][4] + name)
