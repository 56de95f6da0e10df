"""Edit one program of a memory line by line; each change is in the memory, durably, when the call returns."""

from __future__ import annotations

from polycnc.cnc._program_memory import ProgramMemory
from polycnc.cnc._refusal import ControlError, Refusal


class ProgramEdit:
    """Hold a program open for editing, until `close`; nobody else changes, renames or deletes it meanwhile.

    Lines are counted from 1. Untouched lines keep their bytes, and new ones get the line end of the first line. The
    foreground edit is the operator's, of the selected program; one in the background goes on while another program
    is executed.

    Raises:
        ControlError: The program is not there, is protected, or is being executed or edited.
    """

    def __init__(self, memory: ProgramMemory, name: str, *, background: bool = False) -> None:
        memory.begin_edit(name)
        self.name = name
        self.background = background
        self._memory = memory
        self._open = True
        self._lines = memory.read(name).splitlines(keepends=True)
        first = self._lines[0] if self._lines else b"\n"
        self._end = first[len(first.rstrip(b"\r\n")) :] or b"\n"

    def __len__(self) -> int:
        return len(self._lines)

    @property
    def is_open(self) -> bool:
        """Whether the edit goes on."""
        return self._open

    def line(self, number: int) -> str:
        """Return a line without its end.

        Raises:
            ControlError: There is no such line.
        """
        self._check_line(number)
        return self._lines[number - 1].rstrip(b"\r\n").decode("utf-8", "replace")

    def find(self, text: str, *, after: int = 0) -> int | None:
        """Return the number of the first line after line `after` that holds a text, or None.

        Raises:
            ControlError: The text is empty.
        """
        if not text:
            raise ControlError(Refusal.DATA, "there is nothing to search for", hint="Give a text.")
        wanted = text.encode("utf-8", "replace")
        for number in range(max(after, 0), len(self._lines)):
            if wanted in self._lines[number]:
                return number + 1
        return None

    def replace(self, number: int, text: str) -> None:
        """Put a text in place of a line.

        Raises:
            ControlError: There is no such line, the text is not one line, the memory is full or protected.
        """
        self._check_line(number)
        old = self._lines[number - 1]
        end = old[len(old.rstrip(b"\r\n")) :]
        self._keep([*self._lines[: number - 1], _encoded(text) + end, *self._lines[number:]])

    def insert(self, number: int, text: str) -> None:
        """Put a new line before line `number`; one more than there are lines appends.

        Raises:
            ControlError: There is no such place, the text is not one line, the memory is full or protected.
        """
        if number != len(self._lines) + 1:
            self._check_line(number)
        lines = list(self._lines)
        if number > len(lines) and lines and not lines[-1].endswith((b"\n", b"\r")):
            lines[-1] += self._end
        lines.insert(number - 1, _encoded(text) + self._end)
        self._keep(lines)

    def delete(self, first: int, last: int | None = None) -> None:
        """Delete a line, or the lines from `first` to `last`.

        Raises:
            ControlError: There is no such line, `last` is before `first`, or the memory is protected.
        """
        last = first if last is None else last
        self._check_line(first)
        self._check_line(last)
        if last < first:
            raise ControlError(
                Refusal.DATA, f"lines {first} to {last} are none", hint="Give the first line first."
            )
        self._keep([*self._lines[: first - 1], *self._lines[last:]])

    def substitute(self, old: str, new: str) -> int:
        """Put `new` for every `old` in the program; return how many there were.

        Raises:
            ControlError: `old` is empty, `new` is not within one line, the memory is full or protected.
        """
        if not old:
            raise ControlError(Refusal.DATA, "there is nothing to search for", hint="Give a text.")
        wanted, put = _encoded(old), _encoded(new)
        count = sum(line.count(wanted) for line in self._lines)
        if count:
            self._keep([line.replace(wanted, put) for line in self._lines])
        return count

    def close(self) -> None:
        """End the edit; a closed one is closed again without effect."""
        if self._open:
            self._open = False
            self._memory.end_edit(self.name)

    def __enter__(self) -> ProgramEdit:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def _keep(self, lines: list[bytes]) -> None:
        if not self._open:
            raise ControlError(
                Refusal.IDLE, f"the edit of '{self.name}' has ended", hint="Open the program again."
            )
        self._memory.rewrite(self.name, b"".join(lines))
        self._lines = lines

    def _check_line(self, number: int) -> None:
        if not 1 <= number <= len(self._lines):
            raise ControlError(
                Refusal.NOT_FOUND,
                f"program '{self.name}' has no line {number}",
                hint=f"It has {len(self._lines)} lines.",
            )


def _encoded(text: str) -> bytes:
    try:
        line = text.encode("utf-8")
    except UnicodeEncodeError:
        line = b"\n"
    if b"\n" in line or b"\r" in line:
        raise ControlError(Refusal.DATA, f"{text[:40]!r} is not one line of text", hint="Edit line by line.")
    return line


class ProgramEdits:
    """The programs of a memory that are open for editing: one in the foreground and one in the background."""

    def __init__(self, programs: ProgramMemory) -> None:
        self._programs = programs
        self._edits: list[ProgramEdit] = []

    def open(self, name: str, *, background: bool) -> ProgramEdit:
        """Open a program.

        Raises:
            ControlError: Such an edit is open, or the program is not there, protected or in use.
        """
        self._edits = [edit for edit in self._edits if edit.is_open]
        if any(edit.background is background for edit in self._edits):
            raise ControlError(
                Refusal.IN_USE,
                f"a program is being edited in the {'background' if background else 'foreground'}",
                hint="Close that edit first.",
            )
        edit = ProgramEdit(self._programs, name, background=background)
        self._edits.append(edit)
        return edit

    @property
    def any_open(self) -> bool:
        """Whether a program is open."""
        return any(edit.is_open for edit in self._edits)

    def close_foreground(self) -> None:
        """Close what is open in the foreground."""
        for edit in self._edits:
            if not edit.background:
                edit.close()

    def close_all(self) -> None:
        """Close everything."""
        for edit in self._edits:
            edit.close()
