"""A file of records: what is in it, in memory and on disk, where it ends with ETX LF after every write."""

from __future__ import annotations

import os
import re
from pathlib import Path

from polycnc.controllers.bosch.files._directory import is_file
from polycnc.nc.cpl import Fault

END = b"\x03\n"
"""The EOF pointer."""
LONGEST_RECORD = 1024
_END = re.compile(rb"\x03\n*\Z|^\x03", re.MULTILINE)
_FLAGS = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
_NOT_WRITTEN = "FILE CANNOT BE WRITTEN"


class StoredFile:
    """Hold the data of a file up to the EOF pointer; what is written is on disk when `write` returns.

    A write that fails leaves data and disk as they were before it.

    Raises:
        Fault: There is no file and it cannot be made, or it cannot be read.
    """

    def __init__(self, path: Path, *, writing: bool) -> None:
        self.path = path
        self.writer = False
        self.readers = 0
        self._descriptor: int | None = None
        if path.exists() and not is_file(path):
            raise Fault("INVALID FILE NAME", f"{path.name} is no file")
        if not path.exists():
            self.data = bytearray()
            self._tail = END
            self._open(os.O_CREAT | os.O_EXCL)
            self._store(0, b"", b"")
        else:
            try:
                content = path.read_bytes()
            except OSError as error:
                raise Fault("FILE CANNOT BE READ", _reason(error)) from None
            found = _END.search(content)
            self.data = bytearray(content[: found.start()] if found else content)
            self._tail = content[len(self.data) :]
            if writing:
                self._open(0)

    @property
    def in_use(self) -> bool:
        """Whether a program has it open."""
        return self.writer or self.readers > 0

    def begin_writing(self) -> None:
        """Make ready for writing; the last line gets the LF that an editor may have left out.

        Raises:
            Fault: The file is write-protected.
        """
        if self._descriptor is None:
            self._open(0)
        if self._tail != END:
            self._store(len(self.data), END, self._tail)
            self._tail = END
        if self.data and not self.data.endswith(b"\n"):
            self.write(len(self.data), b"\n")

    def write(self, at: int, text: bytes) -> None:
        """Write over the data from byte `at` (from 0) on, and beyond their end.

        Raises:
            Fault: The disk is full, or something else is wrong with it; nothing has been changed.
        """
        if not text:
            return
        old = bytes(self.data[at : at + len(text)])
        grows = at + len(text) > len(self.data)
        self._store(at, text + END if grows or not self.data else text, old + END if grows else old)
        self.data[at : at + len(text)] = text

    def discard(self) -> None:
        """Forget all data.

        Raises:
            Fault: The disk refuses it.
        """
        self._store(0, END, bytes(self.data[:2]))
        try:
            assert self._descriptor is not None
            os.ftruncate(self._descriptor, len(END))
        except OSError as error:
            raise Fault(_NOT_WRITTEN, _reason(error)) from None
        self.data.clear()

    def check_records(self, length: int) -> None:
        """Check that all records have a length.

        Raises:
            Fault: One has not.
        """
        size = length + 1
        lengths_right = len(self.data) % size == 0 and all(
            self.data[end] == ord("\n") for end in range(length, len(self.data), size)
        )
        if not lengths_right or self.data.count(b"\n") != len(self.data) // size:
            raise Fault(
                "INVALID COMPONENT LENGTH", f"not every record of {self.path.name} has {length} characters"
            )

    def close(self) -> None:
        """Let the file go."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def _open(self, flags: int) -> None:
        try:
            self._descriptor = os.open(self.path, os.O_RDWR | flags | _FLAGS, 0o644)
        except OSError as error:
            raise Fault(_NOT_WRITTEN, _reason(error)) from None

    def _store(self, at: int, text: bytes, old: bytes) -> None:
        """Write text at a place on disk, where `old` stands; go back to that if it fails."""
        assert self._descriptor is not None
        text = text or END
        try:
            _put(self._descriptor, at, text)
            if text.endswith(END):
                os.ftruncate(self._descriptor, at + len(text))
        except OSError as error:
            try:
                _put(self._descriptor, at, old)
                if old.endswith(END) or not old:
                    os.ftruncate(self._descriptor, at + len(old))
            except OSError:
                pass  # the disk refuses even what it held before: nothing more can be done
            raise Fault(_NOT_WRITTEN, _reason(error)) from None


def _put(descriptor: int, at: int, text: bytes) -> None:
    os.lseek(descriptor, at, os.SEEK_SET)
    view = memoryview(text)
    while view:
        view = view[os.write(descriptor, view) :]


def _reason(error: OSError) -> str:
    return f"the system says: {error.strerror or error}"
