"""The text of a program, and what is wrong in it: offsets become file, line, column and the line with a caret."""

from __future__ import annotations

from bisect import bisect_right

from polycnc.errors import ProgramError, SourcePosition


class Flaw(Exception):  # noqa: N818 (never leaves the languages: who knows the file makes a PolycncError of it)
    """Something wrong in a text, at an offset of it.

    A language that reads its text line by line counts `at` within the line, and sets `line` (from 1).
    """

    def __init__(self, at: int, what: str, hint: str = "", *, code: str = "", line: int = 0) -> None:
        super().__init__(what)
        self.at = at
        self.what = what
        self.hint = hint
        self.code = code
        self.line = line


class Source:
    """A text with the name of its file. Lines and columns count from 1; a line ends with LF, or with CR LF."""

    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file
        self._begins = [0]
        at = text.find("\n")
        while at >= 0:
            self._begins.append(at + 1)
            at = text.find("\n", at + 1)

    @property
    def line_count(self) -> int:
        """Return the number of lines; a text that ends with a line feed has an empty last one."""
        return len(self._begins)

    def begin(self, line: int) -> int:
        """Return the offset of the first character of a line."""
        return self._begins[line - 1]

    def end(self, line: int) -> int:
        """Return the offset at which a line ends."""
        end = self._begins[line] - 1 if line < len(self._begins) else len(self.text)
        return end - 1 if self.text.endswith("\r", self._begins[line - 1], end) else end

    def line(self, line: int) -> str:
        """Return a line without its end."""
        return self.text[self._begins[line - 1] : self.end(line)]

    def line_of(self, at: int) -> int:
        """Return the number of the line that holds an offset."""
        return bisect_right(self._begins, at)

    def position(self, at: int) -> SourcePosition:
        """Return file, line, column and the text of the line for an offset."""
        line = self.line_of(min(at, len(self.text)))
        text = self.line(line)
        column = min(at - self._begins[line - 1], len(text))
        return SourcePosition(self.file, line, column + 1, text)

    def error(self, flaw: Flaw) -> ProgramError:
        """Return the error that a flaw of this text is."""
        at = self.begin(flaw.line) + flaw.at if flaw.line else flaw.at
        return ProgramError(flaw.what, code=flaw.code, position=self.position(at), hint=flaw.hint)
