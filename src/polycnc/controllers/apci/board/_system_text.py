"""A system file as text: all keys with their values, so that reading it gives the same again."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from polycnc.controllers.apci.board._system_file import SystemFile


def system_file_text(config: SystemFile) -> str:
    """Return `config` as the text of a system file."""
    return "\n".join(_table((), config.model_dump(by_alias=True, exclude_none=True))).strip("\n") + "\n"


def _table(path: tuple[str, ...], table: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of a table: plain values first, then the tables inside."""
    inner = {name: value for name, value in table.items() if isinstance(value, dict) or _is_tables(value)}
    yield from (f"{_key(name)} = {_value(value)}" for name, value in table.items() if name not in inner)
    for name, value in inner.items():
        below = (*path, _key(name))
        opening = "[[{}]]" if _is_tables(value) else "[{}]"
        for each in value if _is_tables(value) else (value,):
            yield from ("", opening.format(".".join(below)), *_table(below, each))


def _is_tables(value: object) -> bool:
    return isinstance(value, tuple) and bool(value) and isinstance(value[0], dict)


def _key(name: object) -> str:
    text = str(name)
    return text if text.isascii() and text.replace("_", "").isalnum() else _quoted(text)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return _quoted(value) if isinstance(value, str) else repr(value)
