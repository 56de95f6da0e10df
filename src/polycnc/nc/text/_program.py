"""The text of a part program as bytes: nothing is decoded until somebody wants to read a line of it.

The scanners work on the bytes and name places by byte offset; a place becomes line and column only when an
error or a message is printed.
"""

from __future__ import annotations

import re
import string
from difflib import get_close_matches
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import AfterValidator, Field

from polycnc.errors import ProgramError, SourcePosition, UsageError
from polycnc.machine import StrictModel, problem

_UTF8_MARK = b"\xef\xbb\xbf"
_UTF16 = re.compile(rb"\xff\xfe|\xfe\xff|(?:[^\0]\0){2}|(?:\0[^\0]){2}")  # with its mark, and without
_NEWLINE = ord("\n")
_RETURN = ord("\r")
_PIECE_BYTES = 1 << 20
_MOST_NAMES = 2_000  # of a folder that are compared with one that is not there


MOST_LINE = 1 << 18  # bytes


def _only_marks(characters: str) -> str:
    # A letter, digit, sign or point here would turn plain words into statements.
    if wrong := "".join(char for char in characters if char not in string.punctuation or char in "+-."):
        raise problem(f"'{wrong}' cannot mark a statement", hint="use punctuation marks other than + - .")
    return characters


class TextRules(StrictModel):
    """What may stand in a block besides words."""

    semicolon_comments: bool = Field(default=True, description="; begins a comment to the end of the line.")
    semicolon_ends: bool = Field(default=False, description="; may end a block, at the end of its line.")
    parenthesis_comments: bool = Field(default=True, description="( ) enclose a comment.")
    nested_comments: bool = Field(
        default=False, description="A comment with brackets in it ends where they match, else at the first )."
    )
    unclosed_comments: bool = Field(default=False, description="A comment may end with its line.")
    blanks_in_numbers: bool = Field(
        default=False, description="Blanks between the digits of a number do not end it: X1 0 is X10."
    )
    sender_commands: bool = Field(
        default=False,
        description="A line that begins with $ or ? is a command to the control, which is noted and not carried out; "
        "those that move are refused.",
    )
    line_numbers: bool = Field(
        default=False, description="A block may begin with a bare number or a point: then it is a statement."
    )
    statement_characters: Annotated[str, AfterValidator(_only_marks)] = Field(
        default="[]#\"',*<>",
        description='Characters, besides "=", that make a block a statement.',
    )


class ProgramText:
    """Hold one part program: its name and its bytes, newlines as they came (LF, CR LF or CR).

    `first_line` is the number of its first line, above 1 for a later piece of a program that comes in pieces.
    """

    def __init__(self, name: str, content: bytes, first_line: int = 1) -> None:
        if _UTF16.match(content):
            raise UsageError(f"{name}: the file is UTF-16 text", hint="Save it as ASCII or UTF-8.")
        self.name = name
        self.first_line = first_line
        self.content = content.removeprefix(_UTF8_MARK)

    @classmethod
    def from_path(cls, path: str | Path) -> ProgramText:
        """Read a part program from a file.

        Raises:
            UsageError: the file cannot be read, or is UTF-16.
        """
        try:
            content = Path(path).read_bytes()
        except FileNotFoundError:
            raise UsageError(f"no such file: {path}", hint=_nearest(Path(path))) from None
        except IsADirectoryError:
            raise UsageError(
                f"cannot read {path}: it is a folder", hint=f"polycnc batch {path} runs the programs in it."
            ) from None
        except (OSError, ValueError) as error:  # ValueError: no file can have this name
            why = error.strerror if isinstance(error, OSError) else error
            raise UsageError(f"cannot read {path}: {why}", hint="Give a readable file.") from None
        return cls(str(path), content)

    @classmethod
    def from_text(cls, text: str | bytes, name: str = "<text>") -> ProgramText:
        """Take a part program from a string (kept as UTF-8) or from bytes."""
        return cls(name, text if isinstance(text, bytes) else text.encode("utf-8", "replace"))

    def __len__(self) -> int:
        return len(self.content)

    @property
    def opening(self) -> ProgramText:
        """The text that a channel begins with: this, or nothing yet where it is still coming."""
        return self

    @cached_property
    def data(self) -> npt.NDArray[np.uint8]:
        """The bytes as a read-only array, without a byte-order mark."""
        return np.frombuffer(self.content, dtype=np.uint8)

    @property
    def lines(self) -> int:
        """How many lines the program has; what comes after the last newline counts if there is anything."""
        starts = self._line_starts
        return self.first_line - 1 + len(starts) - int(int(starts[-1]) >= len(self.content))

    def line(self, offset: int) -> str:
        """Return the line that holds the byte at `offset`, without its newline."""
        start, end = self._bounds(offset)
        return _decoded(self.content[start:end])

    def position(self, offset: int) -> SourcePosition:
        """Return file, line and column (both 1-based, in characters) and the line of the byte at `offset`."""
        number = self._lines_to(offset)
        start, end = self._bounds(offset)
        column = len(_decoded(self.content[start : min(offset, end)])) + 1
        return SourcePosition(
            self.name, self.first_line - 1 + number, column, _decoded(self.content[start:end])
        )

    def line_position(self, line: int) -> SourcePosition:
        """Return the place of the first character that is no blank in line number `line` (1-based)."""
        start = self.line_start(line)
        row = self.content[start : self.line_end(start)]
        return self.position(start + len(row) - len(row.lstrip()))

    def line_start(self, line: int) -> int:
        """Return the offset of the first byte of line number `line` (1-based)."""
        return int(self._line_starts[line - self.first_line])

    def line_end(self, offset: int) -> int:
        """Return the offset of the newline that ends the line of `offset` (the length for the last line)."""
        feed = self.content.find(b"\n", offset)
        end = len(self.content) if feed < 0 else feed
        carriage = self.content.find(b"\r", offset, end)
        return end if carriage < 0 else carriage

    def line_longer_than(self, most: int) -> int | None:
        """Return where the first line with more than `most` bytes begins, None where no line has.

        It looks at the last newline in each piece of so many bytes, and at hardly any other byte.
        """
        content, begin = self.content, 0
        while len(content) - begin > most:
            after = max(content.rfind(sign, begin, begin + most + 1) for sign in (b"\n", b"\r")) + 1
            if after <= begin:
                return begin
            begin = after
        return None

    def endless_line(self) -> ProgramError | None:
        """Return the error of a line that is longer than anybody writes, before anything looks at its words."""
        offset = self.line_longer_than(MOST_LINE)
        if offset is None:
            return None
        what = f"a line with more than {MOST_LINE} characters"
        return ProgramError(what, position=self.position(offset), hint="Check the line ends.")

    def next_line(self, offset: int) -> int:
        """Return the offset of the first byte after the line of `offset` and its newline."""
        end = self.line_end(offset)
        if self.content[end : end + 2] == b"\r\n":
            return end + 2
        return min(end + 1, len(self.content))

    def _lines_to(self, offset: int) -> int:
        """Return how many lines begin at or before an offset."""
        starts = self._line_starts
        # A number of another type would have all of them converted, each time.
        place = starts.dtype.type(min(offset, len(self.content)))
        return int(np.searchsorted(starts, place, side="right"))

    def _bounds(self, offset: int) -> tuple[int, int]:
        number = self._lines_to(offset)
        start = int(self._line_starts[number - 1])
        return start, self.line_end(start)

    @cached_property
    def _line_starts(self) -> npt.NDArray[np.signedinteger[Any]]:
        data = self.data
        kind = np.min_scalar_type(-len(data) - 1)
        starts: list[npt.NDArray[np.signedinteger[Any]]] = [np.zeros(1, dtype=kind)]
        for begin in range(0, len(data), _PIECE_BYTES):
            piece = data[begin : begin + _PIECE_BYTES + 1]
            ends = piece == _NEWLINE
            returns = piece == _RETURN
            returns[:-1] &= ~ends[1:]  # the CR of a CR LF does not end the line by itself
            found = np.flatnonzero((ends | returns)[:_PIECE_BYTES]) + (begin + 1)
            starts.append(found.astype(kind))
        return np.concatenate(starts)


def _decoded(line: bytes) -> str:
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")


def _nearest(path: Path) -> str:
    """Return what to do about a file that is not there: the name beside it that comes nearest, if any is near."""
    try:
        names = [each.name for each in islice(path.parent.iterdir(), _MOST_NAMES)]
    except OSError:
        return "Check the name and the folder."
    found = get_close_matches(path.name, sorted(names), n=1, cutoff=0.75)
    return f"Did you mean {path.with_name(found[0])}?" if found else "Check the name and the folder."
