"""What a name of a program is, where it is given its meaning, and its value where that is one number."""

from __future__ import annotations

import re
from pathlib import Path

from polycnc.editor._names import LABEL, PROGRAM, VARIABLE, Name, Role, givers, same
from polycnc.editor._place import MOST_LINE, without_comments
from polycnc.nc import Dialect
from polycnc.nc.rs274 import KNOWN_NAMES

_MOST_SHOWN = 5
_LAST_LOCAL = {"rs274": 30, "macro": 33}
_FIRST_SYSTEM = {"rs274": 5001, "macro": 1000}
_NUMBER = re.compile(r"[ \t]*=[ \t]*\[?[ \t]*([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))[ \t]*\]?[ \t]*\Z")
_OPENS = re.compile(r"(?:sub|while|do|if|repeat)\Z", re.IGNORECASE)
_WORD = re.compile(r">?[ \t]*([A-Za-z]+)")
_ARGUMENT = re.compile(r"#[ \t]*<([^>]*)>[ \t]*=[ \t]*\[?[ \t]*#0*([0-9]+)[ \t]*\]?[ \t]*\Z")
_KINDS = {
    "if": "condition",
    "while": "loop",
    "do": "loop",
    "repeat": "repetition",
    "elseif": "condition",
}


def about_name(
    names: list[Name], lines: list[str], of: Name, dialect: Dialect, file: Path | None = None
) -> str:
    """Return what a variable, label or program is, as Markdown; `names` are all those of the text.

    `file` is that of a program which stands in none of its lines.
    """
    match of.kind:
        case "variable":
            parts = [_variable(of.key, dialect.language), *_given(names, lines, of, dialect)]
        case "program" if dialect.language == "rs274":
            parts = _sub_program(names, lines, of, dialect, file)
        case "label" if dialect.language == "rs274":
            parts = [_loop(names, lines, of)]
        case _:
            given = _lines(givers(names, of))
            kind = {LABEL: "label", PROGRAM: "program"}.get(of.kind, "block")
            where = f"in {given}" if given else f"in {file.name}" if file else "not in this text"
            parts = [f"**{of.key}**: {kind}, {where}"]
    return "  \n".join(parts)


def _variable(key: str, language: str) -> str:
    bare = key.removeprefix("#<").removesuffix(">")
    if language == "cpl":
        what = "permanent variable" if key[:1] == "@" else "variable"
    elif not bare.startswith("#"):
        known = bare in KNOWN_NAMES or bare.startswith(("_ini[", "_hal["))
        what = "value of the control" if known else f"{'common' if bare[:1] == '_' else 'local'} parameter"
    elif int(bare[1:]) >= _FIRST_SYSTEM.get(language, 0):
        what = "system variable"
    else:
        local = int(bare[1:]) <= _LAST_LOCAL.get(language, 0)
        what = "local variable: an argument of a call, or set here" if local else "common variable"
    return f"**{key}**: {what}"


def _given(names: list[Name], lines: list[str], of: Name, dialect: Dialect) -> list[str]:
    """Return where a variable is set, and its value if it is set once and to a number."""
    places = givers(names, of)
    if not places:
        return []
    said = f"Set in {_lines(places)}"
    if len(places) == 1:
        line = lines[places[0].span.line]
        code = without_comments(line, dialect)
        if found := _NUMBER.match(code, places[0].span.end):
            return [f"{said} to {float(found[1]):g}"]
        return [f"{said}: `{line.strip()[:80]}`"]
    return [said]


def _sub_program(
    names: list[Name], lines: list[str], of: Name, dialect: Dialect, file: Path | None
) -> list[str]:
    written = of.key if of.key.isdigit() else f"<{of.key}>"
    all_of_it = same(names, of)
    first = next((each.span.line for each in all_of_it if each.role is Role.GIVEN), None)
    if first is None:
        return [f"**O{written}**: sub-program " + (f"in {file.name}" if file else "that was not found")]
    last = next(
        (each.span.line for each in all_of_it if _word(each, lines) == "endsub" and each.span.line > first),
        len(lines) - 1,
    )
    calls = sum(_word(each, lines) == "call" for each in all_of_it)
    often = {0: "not called here", 1: "called once here"}.get(calls, f"called {calls} times here")
    parts = [f"**O{written}**: sub-program in lines {first + 1} to {last + 1}, {often}"]
    inside = [each for each in names if first <= each.span.line <= last and each.kind == VARIABLE]
    named: dict[int, str] = {}
    for line in lines[first : last + 1]:
        if len(line) <= MOST_LINE and (found := _ARGUMENT.search(without_comments(line, dialect))):
            named.setdefault(int(found[2]), found[1].strip())
    numbers = sorted(
        {int(each.key[1:]) for each in inside if each.key[1:].isdigit() and int(each.key[1:]) <= 30}
    )
    if numbers:
        told = (f"#{number} {named[number]}" if number in named else f"#{number}" for number in numbers)
        parts.append(f"Arguments: {', '.join(told)}")
    return parts


def _loop(names: list[Name], lines: list[str], of: Name) -> str:
    """Return what the words of a label make together, about the place that is asked about."""
    here = same(names, of)
    begins = [each for each in here if _OPENS.match(_word(each, lines)) and each.span.line <= of.span.line]
    first = begins[-1] if begins else here[0]
    word = _word(first, lines)
    if word == "while" and len(begins) > 1 and _word(begins[-2], lines) == "do":
        first, word = begins[-2], "do"
    ends = [each for each in here if each.span.line > first.span.line]
    last = next((each for each in ends if _word(each, lines).startswith("end")), None)
    if word == "do":
        last = next((each for each in ends if _word(each, lines) == "while"), None)
    end = f" to {last.span.line + 1}" if last else ""
    lines_of_it = f"lines {first.span.line + 1}{end}" if last else f"line {first.span.line + 1}"
    return f"**O{of.key}**: {_KINDS.get(word, 'label')} in {lines_of_it}: `{lines[first.span.line].strip()[:80]}`"


def _word(name: Name, lines: list[str]) -> str:
    found = _WORD.match(lines[name.span.line], name.span.end)
    return found[1].lower() if found else ""


def _lines(places: list[Name]) -> str:
    numbers = list(dict.fromkeys(each.span.line + 1 for each in places))
    if not numbers:
        return ""
    shown = ", ".join(str(number) for number in numbers[:_MOST_SHOWN])
    more = f" and {len(numbers) - _MOST_SHOWN} more" if len(numbers) > _MOST_SHOWN else ""
    return f"{'line' if len(numbers) == 1 else 'lines'} {shown}{more}"
