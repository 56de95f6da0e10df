"""Know on which line of a TOML text a key stands.

`tomllib` parses but forgets where things stood. A `Locator` walks text that `tomllib` has accepted a second
time, and remembers only that.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from typing import TypeAlias

from polycnc.errors import SourcePosition

KeyPath: TypeAlias = tuple[str | int, ...]


class Locator:
    """Remember on which line and column of a TOML text each key and array element stands.

    `text` must be valid TOML. A key path holds the keys from the outside in, and 0-based indices for elements
    of arrays and of arrays of tables: ``("axis", 1, "vmax_mm_s")``.
    """

    def __init__(self, text: str, file: str) -> None:
        self.file = file
        self._lines = [line.rstrip("\r") for line in text.split("\n")]
        self._starts = [0]
        for line in text.split("\n"):
            self._starts.append(self._starts[-1] + len(line) + 1)
        self._marks = _Scanner(text).marks

    def position(self, path: KeyPath) -> SourcePosition:
        """Return the place of `path`, or of the innermost table around it that the text mentions."""
        while path and path not in self._marks:
            path = path[:-1]
        return self.at_offset(self._marks.get(path, 0))

    def at_offset(self, offset: int) -> SourcePosition:
        """Return the place of a character of the text."""
        row = bisect_right(self._starts, offset, hi=len(self._lines)) - 1
        return self.at_line(row + 1, offset - self._starts[row] + 1)

    def at_line(self, line: int, column: int) -> SourcePosition:
        """Return the place of a 1-based line and column."""
        return SourcePosition(self.file, line, column, self._lines[line - 1])


class _Scanner:
    """Walk valid TOML once and keep the offset of every key and element."""

    _SPACE = re.compile(r"[ \t]*")
    _GAP = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
    _BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
    _STRING = re.compile(
        r'"""(?:[^\\]|\\.)*?"""(?:"{0,2})' r"|'''.*?'''(?:'{0,2})" r'|"(?:[^"\\\n]|\\.)*"' r"|'[^'\n]*'",
        re.DOTALL,
    )
    _SCALAR = re.compile(r"[^,\]}#\n]*")

    def __init__(self, text: str) -> None:
        self.marks: dict[KeyPath, int] = {}
        self._text = text
        self._at = 0
        self._last_element: dict[KeyPath, int] = {}
        table: KeyPath = ()
        self._skip(self._GAP)
        while self._at < len(text):
            if text[self._at] == "[":
                table = self._header()
            else:
                self._pair(table)
            self._skip(self._GAP)

    def _skip(self, pattern: re.Pattern[str]) -> str:
        found = pattern.match(self._text, self._at)
        if found is None:
            return ""
        self._at = found.end()
        return found.group()

    def _next_is(self, mark: str) -> bool:
        """Step over `mark` if it comes next."""
        hit = self._text.startswith(mark, self._at)
        self._at += len(mark) if hit else 0
        return hit

    def _keys(self) -> list[tuple[str, int]]:
        keys: list[tuple[str, int]] = []
        while not keys or self._next_is("."):
            self._skip(self._SPACE)
            start = self._at
            key = self._skip(self._BARE_KEY)
            if not key:
                key = str(tomllib.loads(f"key = {self._skip(self._STRING)}")["key"])
            keys.append((key, start))
            self._skip(self._SPACE)
        return keys

    def _header(self) -> KeyPath:
        start = self._at
        is_element = self._next_is("[[") or not self._next_is("[")
        keys = [key for key, _ in self._keys()]
        self._at += 2 if is_element else 1
        path: KeyPath = ()
        for depth, key in enumerate(keys, 1):
            path += (key,)
            self.marks.setdefault(path, start)
            if depth == len(keys) and is_element:
                self._last_element[path] = self._last_element.get(path, -1) + 1
            if path in self._last_element:
                path += (self._last_element[path],)
                self.marks.setdefault(path, start)
        # A table that an earlier header only implied ([a.b] before [a]) stands where its own header is.
        self.marks[path] = start
        return path

    def _pair(self, table: KeyPath) -> None:
        path = table
        for key, start in self._keys():
            path += (key,)
            self.marks.setdefault(path, start)
        self._next_is("=")
        self._value(path)

    def _value(self, path: KeyPath) -> None:
        self._skip(self._SPACE)
        self.marks.setdefault(path, self._at)
        if self._next_is("["):
            index = 0
            self._skip(self._GAP)
            while not self._next_is("]"):
                self._value((*path, index))
                index += 1
                self._between_values()
        elif self._next_is("{"):
            self._skip(self._GAP)
            while not self._next_is("}"):
                self._pair(path)
                self._between_values()
        elif not self._skip(self._STRING):
            self._skip(self._SCALAR)

    def _between_values(self) -> None:
        self._skip(self._GAP)
        self._next_is(",")
        self._skip(self._GAP)
