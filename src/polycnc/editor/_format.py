"""Number blocks anew, and put one blank between words."""

from __future__ import annotations

import re
from collections import Counter
from itertools import count

from polycnc.editor._names import BLOCK, LABEL, Name, Role, names_of
from polycnc.editor._place import MOST_LINE, is_statement, without_comments
from polycnc.nc import Dialect

STEP = 10
_PLAIN = re.compile(r"[ \t]*(?:/[1-9]?[ \t]*)?(?:[A-Za-z][ \t]*[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)[ \t]*)*\Z")


def formatted(lines: list[str], dialect: Dialect) -> list[str]:
    """Return the lines with one blank between words, and their block numbers anew in steps of 10.

    Only blocks that have a number get one. Where a jump is computed, or names a number that no block has or that two
    have, numbers stay as they are: nothing may lead elsewhere than before.
    """
    spaced = [_spaced(line, dialect) for line in lines]
    names = [each for each in names_of(spaced, dialect) if each.kind in (BLOCK, LABEL)]
    return _renumbered(spaced, names, dialect)


def _spaced(line: str, dialect: Dialect) -> str:
    """Return a line with one blank between words; one with more than plain words and comments as it is."""
    if len(line) > MOST_LINE or is_statement(line, dialect):
        return line.rstrip(" \t")
    code = without_comments(line, dialect)
    words = code.rstrip(" \t")
    if not words or not line.startswith(words) or not _PLAIN.match(words):
        return line.rstrip(" \t")
    tight = words.replace(" ", "").replace("\t", "")
    if dialect.text.blanks_in_numbers or _glued(words) == tight:
        parts = [each for each in re.split(r"(?=[A-Za-z])", tight) if each]
        rest = line[len(words) :].strip(" \t")
        return " ".join([*parts, rest] if rest else parts)
    return line.rstrip(" \t")


def _glued(words: str) -> str:
    """Return words without the blanks around letters; those between digits stay, as they end a number."""
    return re.sub(r"[ \t]*([A-Za-z/])[ \t]*", r"\1", words.strip(" \t"))


def _renumbered(lines: list[str], names: list[Name], dialect: Dialect) -> list[str]:
    kinds = (BLOCK, LABEL) if dialect.language == "cpl" else (BLOCK,)
    numbers = [each for each in names if each.kind in kinds and each.key.isdigit()]
    given = [each for each in numbers if each.role is Role.GIVEN]
    used = {(each.kind, each.key) for each in numbers if each.role is Role.USED}
    times = Counter((each.kind, each.key) for each in given)
    if any(times[key] != 1 for key in used) or _jumps_by_value(lines, dialect):
        return lines
    new = {each.span: str(number) for each, number in zip(given, count(STEP, STEP))}
    targets = {(each.kind, each.key): new[each.span] for each in given}
    result = list(lines)
    for each in sorted(numbers, key=lambda each: (each.span.line, -each.span.begin)):
        line, span = result[each.span.line], each.span
        old = line[span.begin : span.end]
        put = re.sub(r"[0-9]+\Z", new.get(span) or targets[each.kind, each.key], old)
        result[span.line] = f"{line[: span.begin]}{put}{line[span.end :]}"
    return result


_COMPUTED = re.compile(r"GOTO[ \t]*[#\[]|(?<![A-Z])M[ \t]*99[^0-9\n]*P|M[ \t]*97", re.IGNORECASE)


def _jumps_by_value(lines: list[str], dialect: Dialect) -> bool:
    return any(_COMPUTED.search(without_comments(line, dialect)) for line in lines if len(line) <= MOST_LINE)
