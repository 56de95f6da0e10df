"""Read text in sections, `[NAME]` and `key = value` or `key: value`, with the place of every value."""

from __future__ import annotations

import re
from collections.abc import Sequence

from polycnc.errors import SourcePosition
from polycnc.runner.machine_sources._facts import Entry, Settings

SECTION = re.compile(r"\s*\[([^\]]+)\]")
VALUE = re.compile(r"([^\s=:#;][^=:]*?)\s*[=:]\s*(.*)")


def sections_of(text: str) -> list[str]:
    """Return the names of the sections, in their order."""
    return [match[1].strip() for match in map(SECTION.match, text.splitlines()) if match]


def read_sections(text: str, file: str, *, comments: Sequence[str], fold: bool) -> Settings:
    """Return every value by "SECTION.key"; the first of several counts.

    `comments` begin a comment after a blank, `fold` makes keys lower case. Lines that begin with a blank continue a
    value and are left out.
    """
    entries: dict[str, Entry] = {}
    section = ""
    for number, line in enumerate(text.splitlines(), 1):
        if match := SECTION.match(line):
            section = match[1].strip()
            continue
        if line[:1].isspace() or not (match := VALUE.match(line)):
            continue
        key = match[1].lower() if fold else match[1]
        value = match[2]
        for mark in comments:
            found = re.search(rf"(^|\s){re.escape(mark)}", value)
            value = value[: found.start()] if found else value
        name = f"{section}.{key}"
        position = SourcePosition(file, number, match.start(2) + 1, line)
        entries.setdefault(name, Entry(name, value.strip(), position))
    return Settings(file, entries)
