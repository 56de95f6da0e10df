"""What a batch has done, in one SQLite file: found again by what it was made from."""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import resources
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.runner.batches._job import Answer, ProgramReport, report_in

_APPLICATION = 0x504E4342  # "PNCB"
_KEPT = ("ok", "error")  # what depends on the program alone; anything else is tried again


class ResultStore:
    """Reports by the keys of their jobs; without a path they are gone when it is closed.

    Raises:
        UsageError: the file is none of these, or cannot be written.
    """

    def __init__(self, path: Path | None) -> None:
        try:
            self._db = sqlite3.connect("" if path is None else path, timeout=30.0)
            try:
                self._prepare(path)
            except BaseException:
                self._db.close()
                raise
        except sqlite3.Error as error:
            raise UsageError(
                f"{path} cannot keep what is done: {error}", hint="Name another file, or remove this one."
            ) from None

    def _prepare(self, path: Path | None) -> None:
        (found,) = self._db.execute("PRAGMA application_id").fetchone()
        (tables,) = self._db.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if tables and found != _APPLICATION:
            raise UsageError(
                f"{path} is a database of something else", hint="Name another file to keep what is done."
            )
        self._db.execute(f"PRAGMA application_id = {_APPLICATION}")
        if path is not None:
            self._db.execute("PRAGMA journal_mode = WAL")
        self._db.execute("CREATE TABLE IF NOT EXISTS report (key TEXT PRIMARY KEY, status TEXT, report TEXT)")
        self._db.commit()

    def close(self) -> None:
        """Close the file."""
        self._db.close()

    def done(self, key: str) -> str | None:
        """Return the status of a job that has a report that holds for good, None of any other."""
        row = self._db.execute("SELECT status FROM report WHERE key = ?", (key,)).fetchone()
        return row[0] if row is not None and row[0] in _KEPT else None

    def keep(self, answers: Iterable[tuple[str, Answer]]) -> None:
        """Keep reports, durably."""
        rows = [(key, answer.status, answer.text) for key, answer in answers]
        with self._db:
            self._db.executemany("INSERT OR REPLACE INTO report VALUES (?, ?, ?)", rows)

    def report(self, key: str) -> ProgramReport:
        """Return the report of a job."""
        (text,) = self._db.execute("SELECT report FROM report WHERE key = ?", (key,)).fetchone()
        return report_in(text)

    def reports(self, keys: Iterable[str]) -> Iterator[ProgramReport]:
        """Return the reports of jobs, in their order."""
        return map(self.report, keys)


def forget_done(path: Path) -> None:
    """Remove a file that keeps what is done, if there is one.

    Raises:
        UsageError: the file is none of these.
    """
    if path.exists():
        ResultStore(path).close()
        for name in (path.name, f"{path.name}-wal", f"{path.name}-shm"):
            path.with_name(name).unlink(missing_ok=True)


def key_of(*parts: bytes) -> str:
    """Return the key of what is made from these parts."""
    digest = hashlib.blake2b(digest_size=20)
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


@cache
def version_digest() -> bytes:
    """Return a digest of all that this package is: another version of it may give another result."""
    digest = hashlib.blake2b(digest_size=20)
    root = Path(str(resources.files("polycnc")))
    for path in sorted(root.rglob("*")):
        if path.suffix in (".py", ".toml"):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.digest()


def folder_digest(folder: Path) -> bytes:
    """Return a digest of the names and contents of all files under a folder."""
    digest = hashlib.blake2b(digest_size=20)
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            content = path.read_bytes()
            name = path.relative_to(folder).as_posix().encode("utf-8", "surrogateescape")
            digest.update(
                len(name).to_bytes(8, "little") + name + len(content).to_bytes(8, "little") + content
            )
    return digest.digest()
