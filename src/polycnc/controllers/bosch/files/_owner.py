"""One control at a time runs in a root: what two of them read, change and keep would undo each other."""

from __future__ import annotations

import errno
import os
import sys
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from polycnc.controllers.bosch.files._directory import STORE
from polycnc.errors import UsageError

if sys.platform == "win32":
    import msvcrt

    def _open(root: Path) -> int:
        return os.open(root / f"{STORE}-lock", os.O_RDWR | os.O_CREAT)

    def _lock(descriptor: int, *, shared: bool) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _open(root: Path) -> int:
        return os.open(root, os.O_RDONLY)  # the folder itself: nothing is written, so it may be read-only

    def _lock(descriptor: int, *, shared: bool) -> None:
        fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)


_TAKEN = (errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK)


class RootOwner:
    """Own a root from `take` to `release`, or to the end of the process."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._release: weakref.finalize[[int], RootOwner] | None = None

    @property
    def owns(self) -> bool:
        """Whether the root is this owner's."""
        return self._release is not None and self._release.alive

    def take(self) -> None:
        """Take the root.

        Raises:
            UsageError: Another control runs in it, in this process or another one.
        """
        if not self.owns and (descriptor := _locked(self._root, shared=False)) is not None:
            self._release = weakref.finalize(self, os.close, descriptor)

    def release(self) -> None:
        """Let the next control have the root."""
        if self._release is not None:
            self._release()

    @contextmanager
    def looking(self) -> Iterator[None]:
        """Keep others from taking the root while something is read.

        Raises:
            UsageError: Another control runs in it.
        """
        descriptor = None if self.owns else _locked(self._root, shared=True)
        try:
            yield
        finally:
            if descriptor is not None:
                os.close(descriptor)


def _locked(root: Path, *, shared: bool) -> int | None:
    """Return what has to be closed to unlock a root, None if it cannot be locked: then nobody is kept out."""
    try:
        descriptor = _open(root)
    except OSError:
        return None
    try:
        _lock(descriptor, shared=shared)
    except OSError as error:
        os.close(descriptor)
        if error.errno not in _TAKEN:
            return None
        raise UsageError(
            f"a control runs in {root} already",
            hint="A root belongs to one control at a time: wait for the end of its program, or close it;"
            " or take a copy of the folder as root.",
        ) from None
    return descriptor
