"""What `polycnc check` says of a text, each with the part of the text that it is about."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from polycnc import runner
from polycnc.editor._document import Document
from polycnc.editor._newest import LONGEST_S, GoOn, TooLong, within
from polycnc.editor._place import Span, word_at
from polycnc.errors import PolycncError, SourcePosition
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText


@dataclass(frozen=True, slots=True)
class Finding:
    """An error, or a remark on what is no error but seldom meant: its place, text with hint, and code."""

    span: Span
    text: str
    code: str
    is_error: bool


def findings(
    document: Document,
    name: str,
    machine: MachineConfig | None = None,
    dialect: Dialect | None = None,
    go_on: GoOn = lambda: None,
) -> list[Finding]:
    """Return everything that `polycnc check` says of a program; `name` is its path, whose folder is the root.

    What concerns another file, like a sub-program, stands in the first line and names its place.
    """
    folder = Path(name).parent
    lines = document.lines
    try:
        report = runner.inspect(
            ProgramText.from_text(document.text, name),
            machine,
            dialect,
            root=folder if folder.is_dir() else None,
            progress=within(LONGEST_S, go_on),
        )
    except TooLong:
        what = f"the check was ended after {LONGEST_S:g} s, before the end of the program\nDoes it loop without end?"
        return [Finding(_span(None, lines), what, "", False)]
    except PolycncError as error:
        return [Finding(_span(None, lines), str(error), "", True)]
    found = []
    for each in report.errors:
        what = f"{each.what}\n{each.hint}" if each.hint else each.what
        found.append(_finding(what, each.code, each.position, name, lines, is_error=True))
    for remark in report.remarks:
        times = f" ({remark.count} times)" if remark.count > 1 else ""
        what = remark.text + times
        found.append(_finding(what, remark.key, remark.position, name, lines, is_error=False))
    return found


def _finding(
    what: str, code: str, at: SourcePosition | None, name: str, lines: list[str], *, is_error: bool
) -> Finding:
    if at is not None and at.file != name:
        return Finding(_span(None, lines), f"{at}: {what}", code, is_error)
    return Finding(_span(at, lines), what, code, is_error)


def _span(at: SourcePosition | None, lines: list[str]) -> Span:
    if at is None or not 1 <= at.line <= len(lines):
        return Span(0, 0, max(1, len(lines[0])))
    return Span(at.line - 1, at.column - 1, word_at(lines[at.line - 1], at.column - 1))
