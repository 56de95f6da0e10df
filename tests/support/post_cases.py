"""Read the worked cases of the macro language, and run lines of macros in their control file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from polycnc.post import ControlFile, parse_control

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "post"
TABLES = (GOLDEN / "cases.toml").read_text(encoding="utf-8")
_HEAD = re.compile(
    r"([SD][0-9]{2})  (?:stated|derived), Manual 001 line [0-9,-]+; sequence place ([012]): .+"
)
_PART = re.compile(r"    (setup|macro|gives|error|covers|     ) \| (.*)|    (gives nothing)")


@dataclass
class Case:
    """A worked case: what runs before, the macro, and what both write; or the error."""

    name: str
    place: int
    parts: dict[str, list[str]] = field(default_factory=dict)

    def part(self, name: str) -> list[str]:
        return self.parts.get(name, [])


def cases() -> Iterator[Case]:
    """Yield the cases of the table; everything in it must be understood."""
    case: Case | None = None
    lines: list[str] = []
    for line in (GOLDEN / "cases.txt").read_text(encoding="utf-8").splitlines():
        if head := _HEAD.fullmatch(line):
            case = Case(head[1], int(head[2]))
            yield case
        elif part := _PART.fullmatch(line):
            assert case is not None
            if part[3]:
                case.parts["gives"] = []
                continue
            if part[1].strip():
                lines = case.parts.setdefault(part[1], [])
            lines += part[2].split() if part[1] == "covers" else [part[2]]
        else:
            assert not line or line.startswith("#"), line


def control_with(macros: Mapping[str, str], *, tables: str = TABLES, **parameters: object) -> ControlFile:
    """Return the control file of the cases with these macros, and with more parameters."""
    values = "".join(f"{key} = {json.dumps(value)}\n" for key, value in parameters.items())
    text = tables.replace("[parameters]\n", f"[parameters]\n{values}", 1)
    body = "".join(f"{name} = '''\n{lines}'''\n" for name, lines in macros.items())
    return parse_control(f"{text}\n[nc_macros]\n{body}", "cases.toml")


def blocks_of(
    *macros: str, words: Mapping[str, float | str] | None = None, **parameters: object
) -> list[str]:
    """Run macros one after the other in one program and return its blocks."""
    names = ("PATH_START", "RAPID", "LINEAR", "PATH_END")
    control = control_with(dict(zip(names, macros, strict=False)), tables=TABLES, **parameters)
    written: list[str] = []
    run = control.start(written.append)
    for name in names[: len(macros)]:
        run.call(name, words or {})
    assert all(block.endswith("\n") for block in written)
    return [block.removesuffix("\n") for block in written]
