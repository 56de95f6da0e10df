"""The root of a control on a real directory: names become paths that never leave it (Manual 003, 6.1.1)."""

from __future__ import annotations

import os
import re
import stat
from contextlib import suppress
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.nc.cpl import Fault

LONGEST_NAME = 30
_NAME = re.compile(r"[A-Za-z0-9_.$ -]+")
STORE = "cpl.store"
"""The file in which a control keeps what is permanent. No program gets at it, nor at what stands beside it while it is
open, in this root or in one that lies within it."""


class Directory:
    """Find files by the names that programs use. A path with or without / at its front begins at the root.

    Capitals and small letters are different. Neither `..` nor a link leads out of the root.
    """

    def __init__(self, root: str | Path) -> None:
        self.root = Path(root).resolve()
        self.writes = 0
        """How often programs have written: the clock of a disk may be too coarse to tell."""
        self._texts: dict[str, tuple[tuple[int, ...], str]] = {}

    def path(self, name: str | None) -> Path:
        """Return the path that a name stands for, whether there is such a file or not.

        Raises:
            Fault: The name is none, or leads out of the root.
        """
        parts = [part for part in (name or "").split("/") if part]
        if not parts or (name or "").endswith("/"):
            raise Fault("INVALID FILE NAME", "a name of 1 to 30 letters, digits, '.' and '_' is needed")
        for part in parts:
            if part in (".", "..") or not _NAME.fullmatch(part):
                raise Fault(
                    "INVALID FILE NAME",
                    f"'{part}' is no name: letters, digits, '.' and '_' are, but neither '.' nor '..'",
                )
        if len(parts[-1]) > LONGEST_NAME:
            raise Fault("INVALID FILE NAME", f"a name has at most {LONGEST_NAME} characters")
        try:
            resolved = self.root.joinpath(*parts).resolve()
            own = self._is_own(resolved)
        except (OSError, RuntimeError) as error:  # RuntimeError: a link to itself
            why = error.strerror if isinstance(error, OSError) else "it is a link to itself"
            raise Fault("INVALID FILE NAME", f"there cannot be a file '{name}': {why}") from None
        if not resolved.is_relative_to(self.root):
            raise Fault("INVALID FILE NAME", f"'{name}' is a link that leads out of the control's directory")
        if own:
            raise Fault("INVALID FILE NAME", f"'{name}' is a file of the control's own memory")
        return resolved

    def text(self, name: str) -> str | None:
        """Return the text of a program, None if there is no such file.

        Raises:
            Fault: The name leads out of the root, or the file cannot be read.
        """
        state: tuple[int, ...] = ()
        with suppress(OSError, ValueError):
            found = os.stat(f"{self.root}/{name}")
            state = (
                found.st_dev,
                found.st_ino,
                found.st_size,
                found.st_mtime_ns,
                found.st_ctime_ns,
                self.writes,
            )
        known = self._texts.get(name)
        if known is not None and state and known[0] == state:
            return known[1]
        path = self.path(name)
        if not is_file(path):
            return None
        try:
            text = self._read(path)
        except OSError as error:
            raise Fault("INVALID FILE NAME", f"'{name}' cannot be read: {error.strerror}") from None
        self._texts[name] = state, text
        return text

    def own_text(self, name: str) -> str | None:
        """Return the text of a file that the control reads when it is switched on, None if there is none.

        Raises:
            UsageError: It cannot be read, or lies out of the root.
        """
        try:
            return self.text(name)
        except Fault as fault:
            raise UsageError(
                f"{name}: {fault.hint}", hint="Put a readable file there, or take it out."
            ) from None

    @staticmethod
    def _read(path: Path) -> str:
        content = path.read_bytes().partition(b"\x03")[0].removeprefix(b"\xef\xbb\xbf")
        try:
            return content.decode("utf-8")
        except UnicodeDecodeError:
            return content.decode("latin-1")

    def access(self, name: str | None) -> int:
        """Return -1 if there is no such file, else its rights: 1 to execute, 2 to write, 4 to read, 8 a directory.

        Raises:
            Fault: The name is none, or leads out of the root.
        """
        path = self.path(name)
        if not path.exists():
            return -1
        rights = ((os.X_OK, 1), (os.W_OK, 2), (os.R_OK, 4))
        allowed = path.stat().st_mode
        bits = sum(bit for right, bit in rights if os.access(path, right) and allowed & right * 0o111)
        return bits + (8 if path.is_dir() else 0)

    def _is_own(self, path: Path) -> bool:
        """Tell whether a path is the store, or what SQLite or an owner has beside it; case and links do not matter."""
        if is_own_name(path.name):
            return True
        found = path.stat() if path.exists() else None
        if found is None or found.st_nlink < 2 or not stat.S_ISREG(found.st_mode):
            return False
        return any(
            os.path.samestat(found, own.stat()) for own in self.root.iterdir() if is_own_name(own.name)
        )


def is_own_name(name: str) -> bool:
    """Tell whether a file of this name belongs to a store on some system: not all mind case, or a point at the end."""
    name = name.rstrip(". ").casefold()
    return name == STORE or name.startswith(f"{STORE}-")


def is_file(path: Path) -> bool:
    """Tell whether a path is an ordinary file: pipes and devices would hold the program up."""
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except OSError:
        return False
