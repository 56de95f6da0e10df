"""The first answer to a change of a long program: what is known already, and what the changed lines are by themselves.

The changed lines are checked after what sets the state of the control before them: plain moves and arcs far above are
left out. So this is not the last word; the check of the whole text, which follows, is.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass, replace

from polycnc.editor._document import Document
from polycnc.editor._findings import Finding, findings
from polycnc.editor._newest import GoOn, TooLong
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect

LEAST_LINES = 2_000
"""A shorter program is checked as a whole at once."""
_MOST_CHANGED = 200
_WHOLE_BEFORE = 100
_LONGEST_S = 0.15  # of computing
_BEYOND_PLAIN = re.compile(
    r"^(?![ \t]*(?:N[0-9]+[ \t]*)?(?:G0?[0-3][ \t]*)?(?:[XYZABCIJKR][ \t]*[-+]?[0-9.]+[ \t]*)+$).*[^\s].*$",
    re.MULTILINE | re.IGNORECASE,
)


@dataclass(frozen=True, slots=True)
class Checked:
    """A text and everything that was found in it."""

    document: Document
    found: list[Finding]


def quick_findings(
    before: Checked,
    now: Document,
    name: str,
    machine: MachineConfig | None = None,
    dialect: Dialect | None = None,
    go_on: GoOn = lambda: None,
) -> list[Finding] | None:
    """Return the findings of a text after a change of a few of its lines, None where they take a whole check."""
    old, new = before.document.lines, now.lines
    if len(new) < LEAST_LINES or "\r" in now.text:
        return None
    most = min(len(old), len(new))
    first = next((number for number in range(most) if old[number] != new[number]), most)
    most -= first
    tail = next((number for number in range(most) if old[-1 - number] != new[-1 - number]), most)
    end = len(new) - tail
    if end - first > _MOST_CHANGED:
        return None
    kept = [each for each in before.found if each.span.line < first]
    moved = [_moved(each, len(new) - len(old)) for each in before.found if each.span.line >= len(old) - tail]
    return [*kept, *_of_lines(now, first, end, name, machine, dialect, go_on), *moved]


def _moved(found: Finding, lines: int) -> Finding:
    return replace(found, span=replace(found.span, line=found.span.line + lines))


def _of_lines(
    now: Document,
    first: int,
    end: int,
    name: str,
    machine: MachineConfig | None,
    dialect: Dialect | None,
    go_on: GoOn,
) -> list[Finding]:
    """Return the errors of some lines, after what stands above them and is no plain move."""
    if first == end:
        return []
    near = max(0, first - _WHOLE_BEFORE)
    far = _BEYOND_PLAIN.finditer(now.text, 0, now.start(near))
    numbers = [bisect_right(now.starts, each.start()) - 1 for each in far]
    numbers += range(near, end)
    excerpt = Document("\n".join(now.lines[number] for number in numbers) + "\n")
    try:
        found = findings(excerpt, name, machine, dialect, go_on, longest_s=_LONGEST_S)
    except TooLong:
        return []
    placed = [
        replace(each, span=replace(each.span, line=numbers[each.span.line]))
        for each in found
        if each.is_error and each.span.line < len(numbers)
    ]
    return [each for each in placed if first <= each.span.line < end]
