"""The files of compiled functions: found, checked, replaced whole, locked, and swept."""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import sys
from pathlib import Path
from uuid import uuid4

_LOG = logging.getLogger("polycnc")

_MAGIC = b"polycnc1"
_DIGEST_BYTES = 16
_LEFT_S = 3600.0  # what is in passing for so long was left by a process that was killed
_KEPT = 24  # files of one function: some versions of it, each for some types of arguments

if sys.platform == "win32":
    import msvcrt
    import time

    def _lock(descriptor: int) -> None:
        while True:
            with contextlib.suppress(OSError):
                msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
                return
            time.sleep(0.05)

    def _unlock(descriptor: int) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_UNLCK, 1)

else:
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX)

    def _unlock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_UN)


def _cache_folder() -> Path | None:
    named = os.environ.get("POLYCNC_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    try:
        base = Path(named) if named else Path.home() / ".cache"
    except RuntimeError:  # no home
        return None
    return base / "polycnc" / "compiled"


CACHE_FOLDER = _cache_folder()
"""The folder where compiled functions are kept; None where there is no home for it."""


SHIPPED_FOLDER = Path(__file__).parents[1] / "_compiled"
"""The folder of the package with functions that came compiled with it, for any processor of a kind; often absent."""


class Files:
    """The kept files of one folder, by stem; a file is whole, or as good as not there.

    Nothing here raises for what is wrong with the disk: it makes one remark, and what is compiled is not kept.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._remarked = False

    def has(self, stem: str) -> bool:
        """Tell whether something was written under this stem."""
        return self._folder is not None and (self._folder / f"{stem}.nbc").exists()

    def read(self, stem: str) -> bytes | None:
        """Return what was written under this stem; None where there is nothing, or nothing whole."""
        if self._folder is None:
            return None
        path = self._folder / f"{stem}.nbc"
        try:
            content = path.read_bytes()
        except OSError:
            return None
        head = len(_MAGIC) + _DIGEST_BYTES
        data = content[head:]
        if content[:head] != _MAGIC + hashlib.blake2b(data, digest_size=_DIGEST_BYTES).digest():
            self.remark(f"{path} is damaged; it is compiled anew")
            return None
        if self._folder != SHIPPED_FOLDER:
            with contextlib.suppress(OSError):
                os.utime(path)  # what is used is swept last
        return data

    def write(self, stem: str, family: str, data: bytes) -> None:
        """Write a file whole, and sweep the oldest files of its family (the beginning of their stems)."""
        if self._folder is None:
            return
        path = self._folder / f"{stem}.nbc"
        passing = self._folder / f"{stem}.{uuid4().hex[:12]}.tmp"
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            try:
                passing.write_bytes(_MAGIC + hashlib.blake2b(data, digest_size=_DIGEST_BYTES).digest() + data)
                passing.replace(path)
            finally:
                passing.unlink(missing_ok=True)
        except OSError as error:
            self._cannot_keep(error)
        else:
            with contextlib.suppress(OSError):
                self._sweep(family)

    def lock(self, stem: str) -> Lock:
        """Wait until no other process makes this file, and keep others from making it until released."""
        if self._folder is None:
            self._cannot_keep(OSError("there is no home folder"))
            return Lock(None)
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(self._folder / f"{stem}.lock", os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            self._cannot_keep(error)
            return Lock(None)
        try:
            _lock(descriptor)
        except OSError:  # a file system without locks: at worst it is compiled twice
            os.close(descriptor)
            return Lock(None)
        return Lock(descriptor)

    def remark(self, text: str) -> None:
        """Tell once, in the log, what is wrong with the folder."""
        if not self._remarked:
            self._remarked = True
            _LOG.warning("Compiled functions: %s", text)

    def _cannot_keep(self, error: OSError) -> None:
        self.remark(
            f"{self._folder or 'the cache folder'} cannot be written ({error.strerror or error}), so every start "
            "compiles them again; POLYCNC_CACHE_DIR names another folder"
        )

    def _sweep(self, family: str) -> None:
        assert self._folder is not None
        kept = sorted(self._folder.glob(f"{family}-*.nbc"), key=lambda each: each.stat().st_mtime_ns)
        for path in kept[:-_KEPT]:
            path.unlink(missing_ok=True)
            path.with_suffix(".lock").unlink(missing_ok=True)
        if kept:
            now_s = kept[-1].stat().st_mtime  # just written
            for path in self._folder.glob("*.tmp"):
                if now_s - path.stat().st_mtime > _LEFT_S:
                    path.unlink(missing_ok=True)


class Lock:
    """A lock on one file, held until released or until the process ends."""

    def __init__(self, descriptor: int | None) -> None:
        self._descriptor = descriptor

    def release(self) -> None:
        """Let others have it; nothing happens when it is not held."""
        descriptor, self._descriptor = self._descriptor, None
        if descriptor is not None:
            with contextlib.suppress(OSError):
                _unlock(descriptor)
            os.close(descriptor)


FILES = Files(CACHE_FOLDER)
"""The files of this user."""
