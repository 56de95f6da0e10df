"""The outline of a program: its programs and sub-programs, and within each its tool changes."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from polycnc.editor._place import words_only
from polycnc.nc import Dialect, MAction
from polycnc.runner import Operation, Survey, time_text

_PROGRAM = re.compile(r"[ \t]*(?:N[0-9]+[ \t]*)?O[ \t]*([0-9]+)[ \t]*\Z", re.IGNORECASE)
_SUB = re.compile(r"[ \t]*(?:N[0-9]+[ \t]*)?O[ \t]*(<[^>]*>|[0-9]+)[ \t]*SUB\b", re.IGNORECASE)
_M = re.compile(r"(?<![A-Za-z_])M[ \t]*([0-9]{1,6})(?![0-9.])", re.IGNORECASE)
_TOOL = re.compile(r"(?<![A-Za-z_])T[ \t]*([0-9]{1,9})", re.IGNORECASE)
_COMMENT = re.compile(r"\(([^)]*)\)?|;(.*)")


@dataclass(frozen=True, slots=True)
class Symbol:
    """A program or a tool change: its name, the comment in its line, its first and last line from 0, its parts."""

    name: str
    detail: str
    is_program: bool
    line: int
    last: int = 0
    children: tuple[Symbol, ...] = ()

    def with_end(self, end: int, children: list[Symbol]) -> Symbol:
        """Return the same up to the line before `end`, with its parts."""
        return replace(self, last=max(self.line, end - 1), children=tuple(children))


def sections(heads: list[Symbol], end: int) -> list[Symbol]:
    """Return symbols of which each ends where the next one begins, the last one before line `end`."""
    ends = [*(head.line for head in heads), end][1:]
    return [head.with_end(after, []) for head, after in zip(heads, ends, strict=True)]


def outline(lines: list[str], dialect: Dialect, survey: Survey | None = None) -> list[Symbol]:
    """Return the programs in the lines of a text with their operations and tool changes, and those before the first.

    What a survey has found has its times.
    """
    marks = {number: mark for number, line in enumerate(lines) if (mark := _mark(number, line, dialect))}
    for each in survey.operations if survey else ():
        _time(each, marks)
    return _nested(sorted(marks.values(), key=lambda mark: mark.line), len(lines))


def _time(operation: Operation, marks: dict[int, Symbol]) -> None:
    """Give the mark at the beginning of an operation its times, one of its own where there is none."""
    number = operation.line - 1
    mark = marks.get(number)
    name = operation.name or (mark.name if mark else f"T{operation.tool}")
    if mark is not None and mark.is_program:  # its time is that of all that follows
        return
    times = f"{time_text(operation.time_s)} (cuts {time_text(operation.cutting_s)})"
    comment = mark.detail if mark and mark.detail != name else ""
    tool = f"T{operation.tool}" if operation.name else ""
    marks[number] = Symbol(name, " ".join(filter(None, (tool, comment, times))), False, number)


def _nested(marks: list[Symbol], length: int) -> list[Symbol]:
    heads = [number for number, mark in enumerate(marks) if mark.is_program]
    first = heads[0] if heads else len(marks)
    end = marks[first].line if heads else length
    found = sections(marks[:first], end)
    for head, after in zip(heads, [*heads, len(marks)][1:], strict=True):
        end = marks[after].line if after < len(marks) else length
        found.append(marks[head].with_end(end, sections(marks[head + 1 : after], end)))
    return found


def _mark(number: int, line: str, dialect: Dialect) -> Symbol | None:
    words = words_only(line, dialect)
    comment = _COMMENT.search(line)
    detail = (comment[1] or comment[2] or "").strip() if comment else ""
    if dialect.language == "rs274" and (sub := _SUB.match(line)):
        return Symbol(f"O{sub[1]}", detail, True, number)
    if program := _PROGRAM.match(words):
        return Symbol(f"O{program[1]}", detail, True, number)
    tool = _TOOL.search(words)
    changes = any(dialect.m_action(int(code)) is MAction.TOOL_CHANGE for code in _M.findall(words))
    if changes or (tool and dialect.tool_word == "turret"):
        return Symbol(f"T{tool[1]}" if tool else "tool change", detail, False, number)
    return None
