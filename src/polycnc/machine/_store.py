"""What a machine remembers when it is switched off: named areas and histories in one SQLite file.

A write is acknowledged by returning, and what was acknowledged survives a killed process or a power cut (WAL,
synchronous FULL). Writes between which nothing may get lost belong into one `transaction`.
"""

from __future__ import annotations

import json
import math
import os
import re
import sqlite3
import threading
import weakref
from collections.abc import Iterator, Mapping, MutableMapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Self, TypeAlias, TypeVar

from polycnc.errors import UsageError, shown
from polycnc.machine._store_file import (
    StoreError,
    let_go,
    open_file,
    open_memory,
    read_snapshot,
    refusal,
    write_file,
)

Key: TypeAlias = int | str
Attributes: TypeAlias = Mapping[str, Any]
V = TypeVar("V", int, float, str, bytes, dict[str, Any])

_NAME = re.compile(r"[a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)*")


class Store:
    """Hold a machine's durable memory: `area` for values by key, `history` for ordered lists.

    Without a path the memory lasts as long as the object. A file belongs to one store at a time. All methods
    may be called from any thread; a transaction makes the other threads wait. A child that the process forks may not
    use a file of its parent; it may close the store, or just exit, and the parent loses nothing.

    Raises:
        StoreError: The file is not a store, is from a newer polycnc, or is in use; it is left as it was.
    """

    def __init__(self, path: str | Path | None = None) -> None:
        self._lock = threading.RLock()
        self._depth = 0
        self._path = None if path is None else Path(path)
        connection = open_memory() if self._path is None else open_file(self._path)
        self._connection: sqlite3.Connection | None = connection
        self._owner = os.getpid()
        self._close_connection = weakref.finalize(self, let_go, connection, self._owner)

    def area(self, name: str, of: type[V]) -> Area[V]:
        """Return the area called `name`, whose values are all of the type `of`.

        `of` is int, float, str, bytes, or dict for a JSON object. Names are lower-case words, joined by dots.

        Raises:
            UsageError: The name is not of that form.
        """
        return Area(self, _checked_name(name), of)

    def history(self, name: str) -> History:
        """Return the history called `name`.

        Raises:
            UsageError: The name is not lower-case words joined by dots.
        """
        return History(self, _checked_name(name))

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Make all writes inside durable together when the block ends, or none if it raises.

        A transaction inside another one is part of it.
        """
        self._refuse_other_process()
        with self._lock:
            connection = self._open_connection()
            if self._depth == 0:
                self._execute("BEGIN IMMEDIATE")
            self._depth += 1
            try:
                yield
                self._refuse_other_process()  # a child may come out of a block that its parent has begun
                if self._depth == 1:
                    self._execute("COMMIT")
            except BaseException:
                if self._depth == 1 and connection.in_transaction and not self._is_foreign:
                    with suppress(sqlite3.Error):  # what broke it is what is reported
                        connection.execute("ROLLBACK")
                raise
            finally:
                self._depth -= 1

    def query(self, sql: str, values: tuple[object, ...] = ()) -> list[tuple[Any, ...]]:
        """Run one SQL statement and return its rows; a write is durable on return, outside a transaction.

        Raises:
            StoreError: The store is closed, damaged, full or of another process, or cannot hold these values.
        """
        self._refuse_other_process()
        with self._lock:
            return self._execute(sql, values)

    def _execute(self, sql: str, values: tuple[object, ...] = ()) -> list[tuple[Any, ...]]:
        connection = self._open_connection()
        if self._depth and not connection.in_transaction:
            raise StoreError("an error has undone the transaction", hint="begin it again")
        try:
            return connection.execute(sql, values).fetchall()
        except (sqlite3.Error, OverflowError, UnicodeError) as error:
            raise refusal(error, self._name) from error

    def snapshot(self, path: str | Path) -> None:
        """Write a copy of the whole store to a file, which becomes complete in one step.

        A closed store that is there is replaced.

        Raises:
            UsageError: `path` is this store's own file or not a store, or a transaction is open.
        """
        if self._path is not None and Path(path).resolve() == self._path.resolve():
            raise StoreError(f"'{path}' is the store itself", hint="give the snapshot another name")
        self._refuse_other_process()
        with self._lock:
            self._refuse_in_transaction("snapshot")
            write_file(self._open_connection(), Path(path))

    def restore(self, path: str | Path) -> None:
        """Replace everything in this store by the contents of a snapshot, in one step.

        Raises:
            UsageError: The file is missing, in use, not a store or from a newer polycnc, or a transaction is
                open.
        """
        self._refuse_other_process()
        with closing(read_snapshot(Path(path))) as copy, self._lock:
            self._refuse_in_transaction("restore")
            try:
                copy.backup(self._open_connection())
            except sqlite3.Error as error:
                raise refusal(error, self._name) from error

    def close(self) -> None:
        """Close the file; a closed store refuses everything but another `close`."""
        if os.getpid() != self._owner:
            self._close_connection()  # leaves the file to the parent; a thread of it may hold the lock
            return
        with self._lock:
            self._connection = None
            self._close_connection()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _open_connection(self) -> sqlite3.Connection:
        if self._connection is None:
            raise StoreError("the store is closed", hint="open a new Store on the same path")
        return self._connection

    @property
    def _name(self) -> str:
        return "the store in memory" if self._path is None else f"the store '{self._path}'"

    @property
    def _is_foreign(self) -> bool:
        return self._path is not None and os.getpid() != self._owner

    def _refuse_other_process(self) -> None:
        if self._is_foreign:
            raise StoreError(
                f"{self._name} belongs to the process that opened it",
                hint="open it after forking, in one process",
            )

    def _refuse_in_transaction(self, what: str) -> None:
        if self._depth:
            raise StoreError(f"{what} inside a transaction", hint="end the transaction first")


class Area(MutableMapping[Key, V], Generic[V]):
    """A durable mapping of numbers or names to values of one type; keys come out in order, numbers first.

    Values come back as they were stored, bit by bit; NaN cannot be stored. Each value may have attributes, a
    JSON object beside it.
    """

    def __init__(self, store: Store, name: str, of: type[V]) -> None:
        self._store = store
        self._name = name
        self._of: type[V] = of

    def __getitem__(self, key: Key) -> V:
        """Return the value of `key`.

        Raises:
            KeyError: There is none.
            UsageError: It was stored as another type.
        """
        rows = self._store.query("SELECT value FROM item WHERE area = ? AND key = ?", (self._name, key))
        if not rows:
            raise KeyError(key)
        return self._value(key, rows[0][0])

    def __setitem__(self, key: Key, value: V) -> None:
        """Store a value; attributes that are there stay. Raises UsageError like `put`."""
        self.put(key, value)

    def put(self, key: Key, value: V, attributes: Attributes | None = None) -> None:
        """Store a value and, unless None, its attributes.

        Raises:
            UsageError: The value is not of the area's type, or cannot be kept (NaN, over 64 bits).
        """
        self._store.query(
            "INSERT INTO item (area, key, value, attributes) VALUES (?, ?, ?, coalesce(?, '{}'))"
            " ON CONFLICT DO UPDATE SET value = excluded.value, attributes = coalesce(?, attributes)",
            (self._name, _checked_key(key), self._stored(key, value), *(_as_json(attributes),) * 2),
        )

    def attributes(self, key: Key) -> dict[str, Any]:
        """Return the attributes of `key`.

        Raises:
            KeyError: There is no such key.
        """
        rows = self._store.query("SELECT attributes FROM item WHERE area = ? AND key = ?", (self._name, key))
        if not rows:
            raise KeyError(key)
        return _from_json(rows[0][0])

    def all_attributes(self) -> dict[Key, dict[str, Any]]:
        """Return the attributes of all keys, with one reading and without the values."""
        rows = self._store.query(
            "SELECT key, attributes FROM item WHERE area = ? ORDER BY key", (self._name,)
        )
        return {key: _from_json(attributes) for key, attributes in rows}

    def __delitem__(self, key: Key) -> None:
        """Forget `key`.

        Raises:
            KeyError: There is no such key.
        """
        if not self._store.query(
            "DELETE FROM item WHERE area = ? AND key = ? RETURNING 1", (self._name, key)
        ):
            raise KeyError(key)

    def __iter__(self) -> Iterator[Key]:
        return iter(
            [
                row[0]
                for row in self._store.query(
                    "SELECT key FROM item WHERE area = ? ORDER BY key", (self._name,)
                )
            ]
        )

    def __len__(self) -> int:
        return int(self._store.query("SELECT count(*) FROM item WHERE area = ?", (self._name,))[0][0])

    def load(self) -> dict[Key, V]:
        """Return the whole area as a dictionary, with one reading."""
        rows = self._store.query("SELECT key, value FROM item WHERE area = ? ORDER BY key", (self._name,))
        return {key: self._value(key, value) for key, value in rows}

    def save(self, values: Mapping[Key, V]) -> None:
        """Store many values with one transaction. Raises UsageError like `put`, and then stores none."""
        with self._store.transaction():
            for key, value in values.items():
                self.put(key, value)

    def clear(self) -> None:
        """Forget everything in the area."""
        self._store.query("DELETE FROM item WHERE area = ?", (self._name,))

    def _stored(self, key: Key, value: Any) -> object:
        if self._of is float and type(value) is int:
            try:
                value = float(value)
            except OverflowError:
                raise UsageError(
                    f"{self._name} {key!r}: the number is too large for a float",
                    hint="store a number below 1.8e308",
                ) from None
        if type(value) is not self._of:
            raise UsageError(
                f"{self._name} {key!r}: {shown(value)} is not of type {self._of.__name__}",
                hint=f"this area holds values of type {self._of.__name__}",
            )
        if isinstance(value, dict):
            return _as_json(value)
        if isinstance(value, float) and math.isnan(value):
            raise UsageError(
                f"{self._name} {key!r}: NaN cannot be stored", hint="delete the key if there is no value"
            )
        if isinstance(value, int) and not -(2**63) <= value < 2**63:
            raise UsageError(
                f"{self._name} {key!r}: {shown(value)} is over 64 bits", hint="store it as text or as bytes"
            )
        return value

    def _value(self, key: Key, stored: Any) -> V:
        if self._of is dict and isinstance(stored, str):
            stored = _from_json(stored)
        if type(stored) is not self._of:
            raise UsageError(
                f"{self._name} {key!r} holds {type(stored).__name__}, not {self._of.__name__}",
                hint="open the area with the type it was written with",
            )
        return stored


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a history; numbers rise and are never used again."""

    number: int
    content: dict[str, Any]


class History:
    """A durable list that grows at its end; each entry is a JSON object."""

    def __init__(self, store: Store, name: str) -> None:
        self._store = store
        self._name = name

    def append(self, content: Attributes) -> int:
        """Add an entry and return its number.

        Raises:
            UsageError: The content is not a JSON object.
        """
        rows = self._store.query(
            "INSERT INTO entry (history, content) VALUES (?, ?) RETURNING number",
            (self._name, _as_json(content)),
        )
        return int(rows[0][0])

    def read(self, *, after: int = 0, count: int | None = None) -> list[Entry]:
        """Return the oldest `count` entries (None: all) whose number is above `after`, oldest first."""
        rows = self._store.query(
            "SELECT number, content FROM entry WHERE history = ? AND number > ? ORDER BY number LIMIT ?",
            (self._name, after, -1 if count is None else count),
        )
        return [Entry(number, _from_json(content)) for number, content in rows]

    def last(self, count: int) -> list[Entry]:
        """Return the newest `count` entries, oldest first."""
        rows = self._store.query(
            "SELECT number, content FROM entry WHERE history = ? ORDER BY number DESC LIMIT ?",
            (self._name, count),
        )
        return [Entry(number, _from_json(content)) for number, content in reversed(rows)]

    def trim(self, keep: int) -> int:
        """Forget all but the newest `keep` entries; return how many are gone."""
        return len(
            self._store.query(
                "DELETE FROM entry WHERE history = ?1 AND number NOT IN"
                " (SELECT number FROM entry WHERE history = ?1 ORDER BY number DESC LIMIT ?2) RETURNING 1",
                (self._name, keep),
            )
        )

    def __len__(self) -> int:
        return int(self._store.query("SELECT count(*) FROM entry WHERE history = ?", (self._name,))[0][0])


def _checked_name(name: str) -> str:
    if not _NAME.fullmatch(name):
        raise UsageError(
            f"'{name}' cannot name a part of a store", hint="use lower-case words joined by dots"
        )
    return name


def _checked_key(key: Key) -> Key:
    if type(key) not in (int, str) or (isinstance(key, int) and not -(2**63) <= key < 2**63):
        raise UsageError(f"{shown(key)} cannot be a key", hint="use a whole number of 64 bits, or text")
    return key


def _as_json(content: Attributes | None) -> str | None:
    """Return JSON text; None stays None."""
    if content is None:
        return None
    try:
        return json.dumps(content, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    except (TypeError, ValueError, RecursionError) as error:
        raise UsageError(
            f"not a JSON object: {error}", hint="use text, finite numbers, lists and dicts"
        ) from error


def _from_json(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (TypeError, ValueError, RecursionError) as error:
        raise StoreError(f"the store is damaged: {error}", hint="restore a snapshot of it") from error
    if not isinstance(found, dict):
        raise StoreError("the store is damaged: no JSON object", hint="restore a snapshot of it")
    return found
