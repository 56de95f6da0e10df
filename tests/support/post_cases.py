"""Read the worked cases of the macro language, and run lines of macros in their control file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

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
    *macros: str, words: Mapping[str, float | str] | None = None, tables: str = TABLES, **parameters: object
) -> list[str]:
    """Run macros one after the other in one program and return its blocks."""
    names = ("PATH_START", "RAPID", "LINEAR", "PATH_END")
    control = control_with(dict(zip(names, macros, strict=False)), tables=tables, **parameters)
    written: list[str] = []
    run = control.start(written.append)
    for name in names[: len(macros)]:
        run.call(name, words or {})
    assert all(block.endswith("\n") for block in written)
    return [block.removesuffix("\n") for block in written]


STATE = "$X$$Y$$Z$@1@!-G00!!-G91!!-M03!!-M08!&X*X&$X$&Y*Y&$Y$&Z*Z&$Z$$F$$S$$T$$OUTPUTORDER$"
"""Shows in one block what a macro has left behind."""


def check_every_way(
    *macros: str, words: Mapping[str, float | str] | None = None, tables: str = TABLES, **parameters: object
) -> None:
    """Check that the last macro, as LINEAR, does the same for moves one by one, along a path and many at once."""
    names = ("PATH_START", "RAPID", "PATH_END", "LINEAR")[-len(macros) :]
    used = {**dict(zip(names, macros, strict=True)), "STOP": STATE}
    control = control_with(used, tables=tables, **parameters)
    given = {"X": 0.0, "Y": 0.0, "Z": 0.0, "F": 0.0, "FEEDMODE": 0.0, **(words or {})}
    steps = np.array([[1.25, -2.5, 0.0], [1.25, -2.5, 0.75]])
    ends = np.array([float(given[name]) for name in "XYZ"]) + steps
    ways: list[list[str]] = []
    for way in ("one by one", "along", "at once"):
        written: list[str] = []
        run = control.start(written.append)
        for name in names[:-1]:
            run.call(name, given)
        run.call("LINEAR", given)
        if way == "one by one":
            for end in ends.tolist():
                run.call("LINEAR", {**given, **dict(zip("XYZ", end, strict=True))})
        elif way == "along":
            list(run.call_along(ends.tolist(), float(given["F"]), float(given["FEEDMODE"])))
        elif steady := run.rows():
            text, blocks, done = run.write_rows(steady, ends, np.zeros(2, np.int64))
            assert (text.count("\n"), done) == (blocks, 2)
            written += text.splitlines(keepends=True)
        else:
            continue
        run.call("STOP")
        ways.append(written)
    assert all(way == ways[0] for way in ways)


_KEY, _NAME = "[A-Za-z][A-Za-z0-9_.]*", "[A-Za-z][A-Za-z0-9_]*"
_SHOWN = {
    rf"!{_KEY}!": "code.output code.search_key",
    rf"!\*{_KEY}!": "code.star code.modal_state code.search_key",
    rf"!-{_KEY}!": "code.minus code.modal_state code.search_key",
    r'(?<!=)"[^"\n]+"': "string.dquote",
    r'"[^"\n]*[!$@&<>][^"\n]*"': "string.special_chars",
    r"'[^'\n]*,[ +-]*\d+ *'": "string.squote",
    r"(?s)<OUTPUTORDER ?= ?1>.*[!$@'\"a-z]": "word.OUTPUTORDER order.sort",
    r"(?s)<OUTPUTORDER=1>.*(?<![a-z])[a-z](?![a-z])": "string.order_default",
    rf"\${_NAME}\$": "word.expand word.reserved",
    r"\$[XYZFST]\$": "word.function_var sec.function_var",
    **{rf"[$<&]{name}\b": f"word.{name}" for name in ("X", "Y", "Z", "F", "T")},
    r"\$TOOLCHANGE\$": "word.TOOLCHANGE",
    "@0@": "seq.suppress",
    "@1@": "seq.output",
    "@0@@1@|@1@@0@": "seq.conflict",
    rf"<{_NAME}=[^\">]+>": "expr.assign op.assign expr.number",
    r"<[VQ]\d=": "expr.newvar",
    r"(?s)NONE|NOTDEF|v9": "expr.undefined",
    r"<(T|V\d|&X\*)=[^>]*\+": "op.plus",
    r"<(T|V\d)=[^>]*-": "op.minus",
    r"<(T|V\d)=[^>]*\*": "op.mul",
    r"<(T|V\d|X)=[^>]*/": "op.div",
    '<STARTOFLINE="': "word.STARTOFLINE expr.string_value",
    '<ENDOFLINE="': "word.ENDOFLINE expr.string_value",
    rf"&{_KEY}(\*[^&]*)?&": "init.key",
    r"&[XYZ]&": "init.xyz concept.machining_origin",
    rf"&{_KEY}\*": "init.value",
    r"\bIF ?\(": "if.statement if.endif if.condition if.operands",
    r"(?s)\bIF ?\([^)]*\)\s+IF|ELSE\s+IF ?\([^)]*\)\s+IF": "if.nesting",
    r"ELSE[ \t]?IF": "if.else_if",
    r"ELSE\n": "if.else",
    "==": "cond.equal cond.tolerance",
    "!=": "cond.not_equal cond.tolerance",
    r"[A-Z0-9]<=": "cond.less_or_equal cond.tolerance",
    r"[A-Z0-9]>=": "cond.greater_or_equal cond.tolerance",
    r"IF[^\n]*[A-Z0-9]<[^=]": "cond.less cond.tolerance",
    r"IF[^\n]*[A-Z0-9]>[^=]": "cond.greater cond.tolerance",
    "&&": "logic.and",
    r"\|\|": "logic.or",
    r"\n": "macro.line_is_block",
}


def rows_of(*macros: str, place: int = 0) -> list[str]:
    """Return the rows of Manual 001 that macros use, so that what they write shows them."""
    text = "\n".join(macros)
    found = [row for pattern, rows in _SHOWN.items() if re.search(pattern, text) for row in rows.split()]
    found += ["macro.elements"] if sum(mark in text for mark in "!$@&<'") >= 2 else []
    found += ["order.written"] if "OUTPUTORDER" not in text else []
    found += ["block.sequence_number"] if place == 1 or (place == 2 and "@1@" in text) else []
    found += ["seq.option2"] if place == 2 else []
    found += ["string.literal"] if re.search(r"(?m)^[a-z ]+$", text) else []
    return [f"post.{row}" for row in dict.fromkeys(found)]
