"""Link tables as files in the control's root: found, kept, and erased with their programs (Manual 003, 2.3)."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from polycnc.controllers.bosch.files import Directory, is_file
from polycnc.errors import UsageError
from polycnc.nc.cpl import Fault, LinkTable, read_table, written_table
from polycnc.outputs import complete_or_absent

EXTENSION = ".l"
_LARGEST = 1 << 24


class LinkFiles:
    """Link tables in `folder` of a root; programs are searched for in the folders of `search`.

    Only programs that lie in the root have one. A table that is damaged, or that something else has made, is written
    anew with a remark; one that cannot be written costs nothing but the next linking.
    """

    def __init__(self, directory: Directory, folder: str, search: Sequence[str]) -> None:
        self._directory = directory
        self._folder = folder.strip("/")
        self._search = tuple(search)
        self._known: dict[str, LinkTable] = {}
        self._remarks: list[str] = []

    def start_up(self) -> None:
        """Erase tables whose program is gone."""
        folder = self._directory.root / self._folder
        if not folder.resolve().is_relative_to(self._directory.root) or not folder.is_dir():
            return
        for path in sorted(folder.glob(f"*{EXTENSION}")):
            found = _read(path)
            if found is not None and not self._has(found[0]):
                with suppress(OSError):
                    path.unlink()

    def take_remarks(self) -> list[str]:
        """Return what there is to say about tables, and forget it."""
        remarks, self._remarks = self._remarks, []
        return remarks

    # ------------------------------------------------------------------ nc.cpl.LinkTables

    def find(self, file: str) -> LinkTable | None:
        """Return the table of a program; one that cannot be used is none, and is remarked once."""
        program, path = self._program(file), self._path(file)
        if program is None or path is None or not is_file(path):
            return None
        found = _read(path)
        if found is None:
            self._remark(f"the link table {path.name} is damaged or not of this control: it is written anew")
            return None
        if found[0] != program:  # of a program of the same name in another folder
            return None
        self._known[program] = found[1]
        return found[1]

    def keep(self, file: str, table: LinkTable) -> None:
        """Write a table, unless it is there already."""
        program = self._program(file)
        if program is None or self._known.get(program) == table or self.find(file) == table:
            return
        name = _table_name(file)
        try:
            path = self._directory.path(f"{self._folder}/{name}")
            if path.exists() and not is_file(path):
                raise UsageError("something that is no file has its name", hint="")
            path.parent.mkdir(parents=True, exist_ok=True)
            with complete_or_absent(path) as partial:
                partial.write_text(written_table(program, table), "utf-8")
        except (OSError, UsageError, Fault) as error:
            why = error.hint if isinstance(error, Fault) else str(error).splitlines()[0]
            self._remark(f"the link table {name} cannot be kept: {why}")
            return
        self._known[program] = table

    def drop(self, file: str) -> None:
        """Erase the table of a program that was refused."""
        program, path = self._program(file), self._path(file)
        if program is None or path is None:
            return
        self._known.pop(program, None)
        found = _read(path)
        if found is not None and found[0] == program:
            with suppress(OSError):
                path.unlink()

    # ------------------------------------------------------------------ within

    def _program(self, file: str) -> str | None:
        """Return the path of a program in the root, None if it does not lie there."""
        root = self._directory.root
        candidates: list[Path] = []
        with suppress(Fault):
            candidates.append(self._directory.path(file))
        with suppress(OSError, ValueError, RuntimeError):
            candidates.append(Path(file).resolve())
        for path in candidates:
            if path.is_relative_to(root) and is_file(path):
                return path.relative_to(root).as_posix()
        return None

    def _path(self, file: str) -> Path | None:
        """Return the path of a program's table; None if its name is too long, or leads out of the root."""
        with suppress(Fault):
            return self._directory.path(f"{self._folder}/{_table_name(file)}")
        return None

    def _has(self, program: str) -> bool:
        name = program.rpartition("/")[2]
        for place in (program, *(f"{folder}/{name}" for folder in self._search)):
            with suppress(Fault):
                if is_file(self._directory.path(place)):
                    return True
        return False

    def _remark(self, text: str) -> None:
        if text not in self._remarks:
            self._remarks.append(text)


def _table_name(file: str) -> str:
    return file.replace("\\", "/").rpartition("/")[2] + EXTENSION


def _read(path: Path) -> tuple[str, LinkTable] | None:
    """Return what a file holds, None if it is no link table."""
    try:
        if not is_file(path) or path.stat().st_size > _LARGEST:
            return None
        return read_table(path.read_text("utf-8"))
    except (OSError, ValueError):
        return None
