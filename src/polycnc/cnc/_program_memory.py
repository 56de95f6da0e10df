"""The programs that a control keeps: names, sizes, dates, comments, protection; nothing is ever half written.

A program is one value of the durable store, so a change is there whole or not at all, and what was acknowledged
survives a killed process. Its bytes are kept as they came.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime

from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import UsageError
from polycnc.machine import Clock, Store
from polycnc.nc import ProgramText

_PROGRAMS = "cnc.programs"
_COMMENT = re.compile(rb"\(([^()\r\n]*)\)")


def first_comment(content: bytes) -> str:
    """Return the first comment in parentheses of the first line that holds more than %; empty if there is none."""
    for line in content.splitlines()[:3]:
        if line.strip() not in (b"", b"%"):
            found = _COMMENT.search(line)
            return found[1].decode("utf-8", "replace").strip() if found else ""
    return ""


@dataclass(frozen=True, slots=True)
class MemoryData:
    """Say what a control's program memory takes: names (a pattern and what to say of it), bytes, programs.

    None is no limit. `comment_of` finds the comment of a program in its text.
    """

    names: str = r"[^/\\\x00-\x1f]{1,64}"
    names_hint: str = "Give 1 to 64 characters, no slash and no control character."
    capacity_bytes: int | None = None
    most_programs: int | None = None
    comment_of: Callable[[bytes], str] = first_comment


@dataclass(frozen=True, slots=True)
class ProgramEntry:
    """A line of the directory; `changed` is the machine's date and time."""

    name: str
    size_bytes: int
    comment: str
    changed: datetime
    protected: bool


@dataclass(frozen=True, slots=True)
class Found:
    """A place where a text was found: line number (1-based) of a program, and the line."""

    name: str
    line: int
    text: str


class ProgramMemory:
    """Keep programs in a machine's store.

    `write_protected` is the key switch that keeps everybody from changing anything. `running` names the programs
    being executed and `edited` the ones being edited: others leave both alone.
    """

    def __init__(
        self,
        store: Store,
        clock: Clock,
        data: MemoryData | None = None,
        running: Callable[[], frozenset[str]] = frozenset,
    ) -> None:
        self.data = data or MemoryData()
        self.write_protected = False
        self.revision = 0
        """Grows with every change of the directory or of a program."""
        self._running = running
        self.edited: frozenset[str] = frozenset()
        self._store = store
        self._clock = clock
        self._area = store.area(_PROGRAMS, bytes)
        self._found: tuple[int, dict[str, ProgramText | None]] = (0, {})

    # ------------------------------------------------------------------ reading

    @property
    def running(self) -> frozenset[str]:
        """The names of the programs that are being executed, callers and called."""
        return self._running()

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name in self._area

    def __len__(self) -> int:
        return len(self._area)

    def __iter__(self) -> Iterator[str]:
        return iter([str(name) for name in self._area])

    def read(self, name: str) -> bytes:
        """Return the bytes of a program.

        Raises:
            ControlError: There is no such program.
        """
        self._known(name)
        return self._area[name]

    def text(self, name: str) -> ProgramText:
        """Return a program to run it.

        Raises:
            ControlError: There is no such program, or it is UTF-16.
        """
        return ProgramText(name, self.read(name))

    def find(self, name: str) -> ProgramText | None:
        """Return a program to call it, None if there is none; what does not change is read once.

        Raises:
            ControlError: It is UTF-16.
        """
        if self._found[0] != self.revision:
            self._found = self.revision, {}
        found = self._found[1]
        if name not in found:
            found[name] = self.text(name) if name in self else None
        return found[name]

    def entry(self, name: str) -> ProgramEntry:
        """Return the directory line of a program.

        Raises:
            ControlError: There is no such program.
        """
        self._known(name)
        return _entry(name, self._area.attributes(name))

    def directory(self) -> tuple[ProgramEntry, ...]:
        """Return the directory, by name."""
        return tuple(_entry(str(name), row) for name, row in self._area.all_attributes().items())

    @property
    def used_bytes(self) -> int:
        """How many bytes all programs have."""
        return sum(each.size_bytes for each in self.directory())

    @property
    def free_bytes(self) -> int | None:
        """How many bytes more fit in, None if there is no limit."""
        capacity = self.data.capacity_bytes
        return None if capacity is None else max(0, capacity - self.used_bytes)

    def search(self, text: str) -> tuple[Found, ...]:
        """Return every line of every program that holds a text, by program and line; upper and lower case differ.

        Raises:
            ControlError: The text is empty.
        """
        if not text:
            raise ControlError(Refusal.DATA, "there is nothing to search for", hint="Give a text.")
        wanted = text.encode("utf-8", "replace")
        return tuple(
            Found(name, number, line.decode("utf-8", "replace"))
            for name in self
            for number, line in enumerate(self._area[name].splitlines(), 1)
            if wanted in line
        )

    # ------------------------------------------------------------------ changing

    def create(self, name: str, content: bytes | str = b"") -> ProgramEntry:
        """Put a new program in.

        Raises:
            ControlError: The name is not allowed or taken, the memory is protected or full, the text is UTF-16.
        """
        content = _bytes(content)
        self._check_new(name)
        self._check_room(len(content), new=1)
        self._put(name, content)
        return self.entry(name)

    def write(self, name: str, content: bytes | str) -> ProgramEntry:
        """Put a program in place of the one that is there.

        Raises:
            ControlError: There is none, it is protected or in use, or the memory is full.
        """
        self._changeable(name)
        return self.rewrite(name, content)

    def begin_edit(self, name: str) -> None:
        """Keep a program for one editor (`ProgramEdit`), until `end_edit`.

        Raises:
            ControlError: There is none, or it is protected or in use.
        """
        self._changeable(name)
        self.edited |= {name}

    def end_edit(self, name: str) -> None:
        """Give a program back that was kept for an editor."""
        self.edited -= {name}

    def rewrite(self, name: str, content: bytes | str) -> ProgramEntry:
        """Write a program that the caller is editing: as `write`, but being edited is no obstacle.

        Raises:
            ControlError: As `write`.
        """
        content = _bytes(content)
        self._changeable(name, by_editor=True)
        self._check_room(len(content) - len(self._area[name]))
        self._put(name, content)
        return self.entry(name)

    def delete(self, name: str) -> None:
        """Delete a program.

        Raises:
            ControlError: There is none, or it is protected or in use.
        """
        self._changeable(name)
        self.revision += 1
        del self._area[name]

    def delete_all(self) -> int:
        """Delete every program that is not protected; return how many.

        Raises:
            ControlError: The memory is protected, or a program is being executed or edited; none is deleted.
        """
        self._check_key()
        names = [each.name for each in self.directory() if not each.protected]
        for name in names:
            self._changeable(name)
        self.revision += 1
        with self._store.transaction():
            for name in names:
                del self._area[name]
        return len(names)

    def rename(self, name: str, new: str) -> None:
        """Give a program another name; its date stays.

        Raises:
            ControlError: There is none, it is protected or in use, or the new name is not allowed or taken.
        """
        self._changeable(name)
        self._check_new(new)
        self.revision += 1
        with self._store.transaction():
            self._area.put(new, self._area[name], self._area.attributes(name))
            del self._area[name]

    def copy(self, name: str, new: str) -> ProgramEntry:
        """Copy a program; the copy is not protected and has the date of now.

        Raises:
            ControlError: There is none, the new name is not allowed or taken, or the memory is full.
        """
        return self.create(new, self.read(name))

    def protect(self, name: str, on: bool = True) -> None:
        """Protect one program from being changed, or no longer.

        Raises:
            ControlError: There is none, the memory is protected, or the program is in use.
        """
        self._check_key()
        self._known(name)
        self._check_free(name)
        self.revision += 1
        self._area.put(name, self._area[name], {**self._area.attributes(name), "protected": on})

    # ------------------------------------------------------------------ checks

    def _put(self, name: str, content: bytes) -> None:
        self.revision += 1
        attributes = {
            "size": len(content),
            "comment": self.data.comment_of(content),
            "changed": self._clock.now.isoformat(),
            "protected": False,
        }
        self._area.put(name, content, attributes)

    def _known(self, name: str) -> None:
        if name not in self:
            raise ControlError(
                Refusal.NOT_FOUND, f"there is no program '{name}'", hint="The directory lists the programs."
            )

    def _check_key(self) -> None:
        if self.write_protected:
            raise ControlError(
                Refusal.PROTECTED, "the program memory is protected", hint="Switch the protection off first."
            )

    def _changeable(self, name: str, *, by_editor: bool = False) -> None:
        self._check_key()
        self._known(name)
        if self.entry(name).protected:
            raise ControlError(
                Refusal.PROTECTED, f"program '{name}' is protected", hint="Take its protection off first."
            )
        self._check_free(name, by_editor=by_editor)

    def _check_free(self, name: str, *, by_editor: bool = False) -> None:
        if name in self.running:
            raise ControlError(
                Refusal.IN_USE, f"program '{name}' is being executed", hint="Wait for its end, or reset it."
            )
        if name in self.edited and not by_editor:
            raise ControlError(
                Refusal.IN_USE, f"program '{name}' is being edited", hint="End the edit first."
            )

    def _check_new(self, name: str) -> None:
        self._check_key()
        if not re.fullmatch(self.data.names, name):
            raise ControlError(Refusal.DATA, f"'{name}' cannot name a program", hint=self.data.names_hint)
        if name in self:
            raise ControlError(
                Refusal.EXISTS, f"there is a program '{name}' already", hint="Delete or rename it first."
            )

    def _check_room(self, more_bytes: int, *, new: int = 0) -> None:
        limit, most = self.data.capacity_bytes, self.data.most_programs
        if limit is not None and more_bytes > 0 and self.used_bytes + more_bytes > limit:
            raise ControlError(
                Refusal.FULL,
                f"the program memory is full: {self.free_bytes} bytes are free, {more_bytes} are needed",
                hint="Delete programs that are not needed.",
            )
        if most is not None and len(self) + new > most:
            raise ControlError(
                Refusal.FULL, f"the program memory holds {most} programs already", hint="Delete one first."
            )


def _bytes(content: bytes | str) -> bytes:
    try:
        content = content if isinstance(content, bytes) else content.encode("utf-8")
        ProgramText("the program", content)  # refuses what no program can be
    except UnicodeEncodeError as error:
        raise ControlError(
            Refusal.DATA,
            f"character {error.start + 1} cannot be kept as text",
            hint="Give the program as bytes.",
        ) from error
    except UsageError as error:
        raise ControlError(Refusal.DATA, error.what, hint=error.hint) from error
    return content


def _entry(name: str, row: dict[str, object]) -> ProgramEntry:
    return ProgramEntry(
        name=name,
        size_bytes=int(str(row["size"])),
        comment=str(row["comment"]),
        changed=datetime.fromisoformat(str(row["changed"])),
        protected=bool(row["protected"]),
    )
