"""What `polycnc check` says of a text, each with the part of the text that it is about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from polycnc import runner
from polycnc.editor._document import Document
from polycnc.editor._kinds import Kind, kind_of
from polycnc.editor._newest import LONGEST_S, GoOn, TooLong, within
from polycnc.editor._place import MOST_LINE, Span, word_at
from polycnc.editor._tables import problems
from polycnc.errors import ConfigurationError, PolycncError, ProgramError, SourcePosition
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText

_MARK = "\ufeff"  # which is no part of a text


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
    *,
    longest_s: float | None = None,
) -> list[Finding]:
    """Return everything that is wrong with a text; `name` is its path, and the folder of a program its root.

    Of a program it is what `polycnc check` says, of other files what loading them says.

    What concerns another file, like a sub-program, stands in the first line and names its place.

    Raises:
        TooLong: It took more than `longest_s` of computing; without that, one of more than 20 s is a finding.
    """
    folder = Path(name).parent
    lines = document.lines
    kind = kind_of(name, document.text)
    program = ProgramText.from_text(document.text, name)
    if (offset := program.line_longer_than(MOST_LINE)) is not None:
        what = f"a line with more than {MOST_LINE} bytes: the editor looks no further\nCheck the line ends."
        return [_finding(what, "", program.position(offset), name, lines, is_error=True)]
    if kind is not Kind.PROGRAM:
        return [_error(each, name, lines) for each in _wrong(document.text.removeprefix(_MARK), name, kind)]
    try:
        report = runner.inspect(
            program,
            machine,
            dialect,
            root=folder if folder.is_dir() else None,
            progress=within(longest_s or LONGEST_S, go_on),
            rehearse=longest_s is None,
        )
    except TooLong:
        if longest_s is not None:
            raise
        what = f"the check was ended after {LONGEST_S:g} s of computing\nDoes the program loop without end?"
        return [Finding(_span(None, lines), what, "", False)]
    except PolycncError as error:
        return [Finding(_span(None, lines), str(error), "", True)]
    found = [_error(each, name, lines) for each in report.errors]
    for remark in report.remarks:
        times = f" ({remark.count} times)" if remark.count > 1 else ""
        what = remark.text + times
        found.append(_finding(what, remark.key, remark.position, name, lines, is_error=False))
    return found


def _wrong(text: str, name: str, kind: Kind) -> Sequence[ProgramError | ConfigurationError]:
    if kind is Kind.STAND_ALONE:
        from polycnc.controllers.apci import sap

        return sap.check(text, name)[1]
    return problems(text, name, kind)


def _error(error: ProgramError | ConfigurationError, name: str, lines: list[str]) -> Finding:
    what = f"{error.what}\n{error.hint}" if error.hint else error.what
    code = error.code if isinstance(error, ProgramError) else ""
    return _finding(what, code, error.position, name, lines, is_error=True)


def _finding(
    what: str, code: str, at: SourcePosition | None, name: str, lines: list[str], *, is_error: bool
) -> Finding:
    if at is not None and at.file != name:
        return Finding(_span(None, lines), f"{at}: {what}", code, is_error)
    return Finding(_span(at, lines), what, code, is_error)


def _span(at: SourcePosition | None, lines: list[str]) -> Span:
    if at is None or not 1 <= at.line <= len(lines):
        return Span(0, 0, max(1, len(lines[0])))
    begin = at.column - 1 + (at.line == 1 and lines[0].startswith(_MARK))
    return Span(at.line - 1, begin, word_at(lines[at.line - 1], begin))
