"""What outlives a control: permanent variables and tables, in one store that one control owns at a time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from polycnc.controllers.bosch._kept_tables import KeptTables
from polycnc.controllers.bosch._memory import KeptVariables
from polycnc.controllers.bosch.files import STORE, RootOwner
from polycnc.machine import Store


class Permanence:
    """Take over what was kept in a root, and keep what has changed.

    A device gives its `store`, which stays open. Without one, the root belongs to this control from `own` to `release`;
    the store is opened to read and to write, and made when there is something to keep.
    """

    def __init__(
        self, root: Path, variables: KeptVariables, tables: KeptTables, store: Store | None = None
    ) -> None:
        self._path = root / STORE
        self._variables = variables
        self._tables = tables
        self._store = store
        self._owner = RootOwner(root)
        if store is not None:
            self._take()

    def look(self) -> None:
        """Take over what was kept, for a program that changes nothing of it.

        Raises:
            UsageError: Another control runs in the root.
        """
        if self._store is None and self._path.exists():
            with self._owner.looking():
                self._take()

    def own(self) -> None:
        """Own the root, and take over what was kept, unless this has been done.

        Raises:
            UsageError: Another control runs in the root.
        """
        if self._store is None and not self._owner.owns:
            self._owner.take()
            if self._path.exists():
                self._take()

    def release(self) -> None:
        """Let another control have the root."""
        self._owner.release()

    def keep(self) -> None:
        """Write what has changed, all of it or nothing.

        Raises:
            UsageError: The disk refuses it, or another control has the store open.
        """
        variables, tables = self._variables.changed(), self._tables.changed()
        if not variables and not tables:
            return
        with self._opened() as store, store.transaction():
            self._variables.keep(store, variables)
            self._tables.keep(store, tables)
        self._variables.kept()
        self._tables.kept()

    def _take(self) -> None:
        with self._opened() as store:
            self._variables.take(store)
            self._tables.take(store)

    @contextmanager
    def _opened(self) -> Iterator[Store]:
        if self._store is not None:
            yield self._store
            return
        with Store(self._path) as store:
            yield store
