"""Link tables: what linking has found out about a program, kept so that it is not linked again (Manual 003, 2.3).

A table holds what linking a caller needs to know of a program: which sub-programs it calls, and where. It holds no
code: a program that runs is compiled from its own text, whatever its table says.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any, NamedTuple, Protocol

_MARK = "polycnc CPL link table"
_FORMAT = 1
_LONGEST_PATH = 1000


class LinkedCall(NamedTuple):
    """A call in a linked program: offset in its text, line, address ("" for CALL), name, whether DIN excludes it."""

    at: int
    line: int
    address: str
    name: str
    unlinked: bool


class LinkTable(NamedTuple):
    """A program that was found right: the digest of its text, and the sub-programs that it calls."""

    digest: str
    calls: tuple[LinkedCall, ...]


class LinkTables(Protocol):
    """Where link tables are kept, by the file of the program."""

    def find(self, file: str) -> LinkTable | None:
        """Return the table of a program, None if there is none that can be used."""

    def keep(self, file: str, table: LinkTable) -> None:
        """Keep the table of a program that was linked."""

    def drop(self, file: str) -> None:
        """Forget the table of a program that was refused."""


class NoTables:
    """Tables that are kept nowhere."""

    def find(self, file: str) -> LinkTable | None:
        """Return none."""
        return None

    def keep(self, file: str, table: LinkTable) -> None:
        """Keep nothing."""

    def drop(self, file: str) -> None:
        """Forget nothing."""


def text_digest(text: str) -> str:
    """Return what tells the text of a program from every other one."""
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def written_table(program: str, table: LinkTable) -> str:
    """Return a table as it is kept on disk; `program` is the path of its program in the root."""
    content = {"program": program, "text": table.digest, "calls": [list(call) for call in table.calls]}
    return json.dumps({_MARK: _FORMAT, "content": content, "check": _check(content)}) + "\n"


def read_table(text: str) -> tuple[str, LinkTable] | None:
    """Return the program and the table that a text holds, None if it is damaged or holds something else."""
    try:
        whole = json.loads(text)
        content = whole["content"]
        if whole[_MARK] != _FORMAT or whole["check"] != _check(content):
            return None
        program, digest = content["program"], content["text"]
        calls = tuple(LinkedCall(*call) for call in content["calls"])
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
    if not all(map(_is_call, calls)) or not _is_name(program) or not isinstance(digest, str):
        return None
    return program, LinkTable(digest, calls)


def _is_call(call: LinkedCall) -> bool:
    places = all(type(place) is int and 0 <= place < 1 << 40 for place in (call.at, call.line))
    return (
        places and call.address in ("", "G", "M", "P") and _is_name(call.name) and type(call.unlinked) is bool
    )


def _is_name(value: object) -> bool:
    return isinstance(value, str) and 0 < len(value) <= _LONGEST_PATH and "\x00" not in value


def _check(content: Any) -> str:
    return text_digest(json.dumps(content, sort_keys=True))
