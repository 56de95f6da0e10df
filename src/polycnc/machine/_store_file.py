"""The file of a store: how it begins, grows from version to version, is copied, and is told from other files.

A file is looked at read-only before it is opened, so what is refused stays as it was. New files and snapshots
are made whole under another name and then renamed: there is never half of one.
"""

from __future__ import annotations

import ctypes
import os
import sqlite3
from contextlib import closing
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.outputs import complete_or_absent, is_special

APPLICATION_ID = 0x706F6C79  # "poly"
# Each entry brings a store from the version before to its own (1, 2, ...). Never change a released one.
MIGRATIONS: tuple[tuple[str, ...], ...] = (
    (
        """CREATE TABLE item (
               area TEXT NOT NULL,
               key ANY NOT NULL,
               value ANY NOT NULL,
               attributes TEXT NOT NULL DEFAULT '{}',
               PRIMARY KEY (area, key)
           ) STRICT, WITHOUT ROWID""",
        """CREATE TABLE entry (
               number INTEGER PRIMARY KEY AUTOINCREMENT,
               history TEXT NOT NULL,
               content TEXT NOT NULL
           ) STRICT""",
        "CREATE INDEX entry_by_history ON entry (history, number)",
    ),
)


# What keeps SQLite from its file although the file is good.
_OUTSIDE = {
    sqlite3.SQLITE_FULL,
    sqlite3.SQLITE_IOERR,
    sqlite3.SQLITE_READONLY,
    sqlite3.SQLITE_CANTOPEN,
    sqlite3.SQLITE_BUSY,
    sqlite3.SQLITE_LOCKED,
    sqlite3.SQLITE_NOMEM,
    sqlite3.SQLITE_PERM,
    sqlite3.SQLITE_INTERRUPT,
}


class StoreError(UsageError):
    """A store that cannot be used: damaged, full, foreign, in use, too large, or of another process."""


def refusal(error: sqlite3.Error | OverflowError | UnicodeError, name: str) -> StoreError:
    """Return what an error of SQLite means for who uses the store called `name`."""
    if isinstance(error, UnicodeEncodeError):
        return StoreError(f"{name} cannot hold this text: {error}", hint="store it as bytes")
    if isinstance(error, sqlite3.DataError | OverflowError):
        return StoreError(
            f"{name} cannot hold this: {error}", hint="it is too large: store less of it at once"
        )
    if isinstance(error, sqlite3.Error) and getattr(error, "sqlite_errorcode", 0) & 0xFF in _OUTSIDE:
        return StoreError(
            f"cannot use {name}: {error}",
            hint="make room and check the access rights; what was acknowledged before is kept",
        )
    return StoreError(f"{name} is damaged: {error}", hint="restore a snapshot of it")


def let_go(connection: sqlite3.Connection, owner: int) -> None:
    """Close a connection; in a child of the process `owner` leave it open for ever.

    Closing would there move the parent's writes about and remove its log: they would be lost. Nor may the object die.
    """
    if os.getpid() == owner:
        connection.close()
    else:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(connection))


def open_memory() -> sqlite3.Connection:
    """Return an empty store in memory."""
    connection = _connect(":memory:")
    _migrate(connection, "the store in memory")
    return connection


def open_file(path: Path) -> sqlite3.Connection:
    """Return the store in a file, which is made if it is not there or empty, and locked for this connection.

    Raises:
        StoreError: The file is not a store, is from a newer polycnc, is damaged or is in use.
    """
    if is_new(path):
        with closing(open_memory()) as empty:
            write_file(empty, path)
    check_header(path)
    connection = _connect(path)
    try:
        connection.execute("PRAGMA locking_mode = EXCLUSIVE")
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = FULL")
        _migrate(connection, f"'{path}'")
    except sqlite3.OperationalError as error:
        connection.close()
        raise StoreError(
            f"cannot open the store '{path}': {error}",
            hint="a store belongs to one machine at a time: close the other one, and check the access rights",
        ) from error
    except (sqlite3.Error, UnicodeError) as error:  # UnicodeError: of the text of a damaged schema
        connection.close()
        raise StoreError(
            f"the store '{path}' is damaged: {error}", hint="restore a snapshot of it"
        ) from error
    except StoreError:
        connection.close()
        raise
    return connection


def read_snapshot(path: Path) -> sqlite3.Connection:
    """Return a copy in memory of the store in a file, brought to this version.

    Raises:
        StoreError: The file is missing, is not a store, is from a newer polycnc, is damaged or is in use.
    """
    if is_new(path) or not path.is_file():
        raise StoreError(f"there is no snapshot '{path}'", hint="check the name of the file")
    check_header(path)
    _refuse_unclosed(path)
    copy = _connect(":memory:")
    try:
        with closing(_connect_unchanged(path)) as original:
            original.backup(copy)
        _migrate(copy, f"'{path}'")
    except (sqlite3.Error, UnicodeError) as error:
        copy.close()
        raise StoreError(f"the snapshot '{path}' is damaged: {error}", hint="use another snapshot") from error
    except StoreError:
        copy.close()
        raise
    return copy


def write_file(connection: sqlite3.Connection, target: Path) -> None:
    """Write everything in `connection` to a file that appears, or replaces a closed store, in one step.

    Raises:
        StoreError: The target is not a store, is in use, or cannot be written.
    """
    if not is_new(target):
        check_header(target)
    if is_special(target):
        raise StoreError(f"'{target}' is no file", hint="a store needs a file of its own")
    _refuse_unclosed(target)
    try:
        with complete_or_absent(target, durable=True) as part, closing(_connect(part)) as copy:
            copy.execute("PRAGMA journal_mode = OFF")  # nobody sees the file before it is whole
            connection.backup(copy)
            # A copy of a WAL file says it is one; a snapshot shall be a single plain file.
            copy.execute("PRAGMA journal_mode = DELETE")
    except (OSError, sqlite3.Error, UsageError) as error:
        why = error.what if isinstance(error, UsageError) else error
        raise StoreError(
            f"cannot write '{target}': {why}", hint="check that the folder exists, is writable and has room"
        ) from error


def is_new(path: Path) -> bool:
    """Tell whether there is nothing at `path`, or an empty file.

    Raises:
        StoreError: There cannot be a file of this name.
    """
    try:
        if "\0" in str(path):
            raise ValueError("a file name has no null characters")
        return not path.exists() or (path.is_file() and path.stat().st_size == 0)
    except (OSError, ValueError) as error:
        raise StoreError(
            f"cannot use '{path}': {error}", hint="check the name and the access rights"
        ) from error


def check_header(path: Path) -> None:
    """Refuse a file that is not a store, or a newer one, without changing it.

    SQLite itself reads the header: closing a file that was opened beside it would, on POSIX systems, drop the
    lock that a store in this process may hold on the file.

    Raises:
        StoreError: The file is not a store, is from a newer polycnc or cannot be read.
    """
    try:
        with closing(_connect_unchanged(path)) as connection:
            application = connection.execute("PRAGMA application_id").fetchone()[0]
            version = connection.execute("PRAGMA user_version").fetchone()[0]
    except sqlite3.OperationalError as error:
        raise StoreError(
            f"cannot read '{path}': {error}", hint="check the name and the access rights"
        ) from error
    except (sqlite3.Error, UnicodeError):
        application, version = 0, 0
    if application != APPLICATION_ID:
        raise StoreError(f"'{path}' is not a store of polycnc", hint="name a store, or a new file")
    _refuse_newer(version, f"'{path}'")


def _connect_unchanged(path: Path) -> sqlite3.Connection:
    return _connect(f"{path.resolve().as_uri()}?mode=ro&immutable=1")


def _connect(database: str | Path) -> sqlite3.Connection:
    return sqlite3.connect(
        database,
        timeout=0.2,
        isolation_level=None,
        check_same_thread=False,
        uri=isinstance(database, str) and database.startswith("file:"),
    )


def _migrate(connection: sqlite3.Connection, name: str) -> None:
    version = connection.execute("PRAGMA user_version").fetchone()[0]
    _refuse_newer(version, name)
    for number, statements in enumerate(MIGRATIONS[version:], version + 1):
        connection.execute("BEGIN IMMEDIATE")
        try:
            for statement in (
                *statements,
                f"PRAGMA user_version = {number}",
                f"PRAGMA application_id = {APPLICATION_ID}",
            ):
                connection.execute(statement)
            connection.execute("COMMIT")
        except BaseException:
            connection.execute("ROLLBACK")
            raise


def _refuse_newer(version: int, name: str) -> None:
    if version > len(MIGRATIONS):
        raise StoreError(
            f"{name} has version {version}, and this polycnc knows versions up to {len(MIGRATIONS)}",
            hint="use the polycnc that wrote it, or a newer one",
        )


def _refuse_unclosed(path: Path) -> None:
    """Refuse a file with writes waiting beside it: to copy or replace the file alone would lose them."""
    for ending in ("-wal", "-journal"):
        leftover = Path(f"{path}{ending}")
        if leftover.exists():
            raise StoreError(
                f"'{leftover}' shows that the store is in use or was not closed",
                hint="close the store, or open and close it once; if the store is gone, remove the leftover",
            )
