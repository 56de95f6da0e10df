"""The names of a program: variables, labels, numbers of blocks and programs; where each is given and used."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from polycnc.editor._place import MOST_LINE, Span, is_statement, without_comments
from polycnc.errors import UsageError
from polycnc.nc import Dialect, Family, MAction, ProgramText, SubPrograms
from polycnc.nc.cpl import LEXICON, RESERVED
from polycnc.nc.rs274 import sub_program_file

VARIABLE, LABEL, BLOCK, PROGRAM = "variable", "label", "block", "program"


class Role(Enum):
    """What a program does with a name at a place."""

    GIVEN = "given"
    USED = "used"


@dataclass(frozen=True, slots=True)
class Name:
    """A name at a place: what it names, how it compares with others, whether it is given its meaning there."""

    kind: str
    key: str
    span: Span
    role: Role


_LEAD = r"[ \t]*(?:/[1-9]?[ \t]*)?"
_N = re.compile(rf"{_LEAD}(N[ \t]*0*([0-9]+))(?![0-9.])", re.IGNORECASE)
_PROGRAM = re.compile(rf"{_LEAD}(?:N[0-9]+[ \t]*)?([O:][ \t]*0*([0-9]+))[ \t]*\Z", re.IGNORECASE)
_GOTO = re.compile(r"GOTO[ \t]*(0*([0-9]+))(?![0-9.])", re.IGNORECASE)
_CALL = re.compile(r"(?<![A-Z_])([GM])[ \t]*([0-9]+(?:\.[0-9]+)?)", re.IGNORECASE)
_P = re.compile(r"(?<![A-Z_#])(P[ \t]*0*([0-9]+))(?![0-9.])", re.IGNORECASE)
_P_Q = re.compile(r"(?<![A-Z_#])([PQ][ \t]*0*([0-9]+))(?![0-9.])", re.IGNORECASE)
_MACRO_CALLS = (65.0, 66.0, 66.1)  # of custom macros, as the dialect's language has them
_NUMBERED = re.compile(r"#[ \t]*0*([0-9]+)(?![0-9.])(?=([ \t]*=(?!=))?)")
_NAMED = re.compile(r"#[ \t]*<([^>]*)>(?=([ \t]*=(?!=))?)")
_EXISTS = re.compile(r"EXISTS[ \t]*\[", re.IGNORECASE)
_O_WORD = re.compile(
    rf"{_LEAD}(?:N[0-9]+[ \t]*)?O[ \t]*(?:<([^>]*)>|0*([0-9]+))[ \t]*([A-Z]+)", re.IGNORECASE
)
_CPL_LINE = re.compile(r"[ \t]*(0*([0-9]+))[ \t]+(\.[A-Za-z][^\s:,]*)?")
_CPL_GOTO = re.compile(r"GOTO[ \t]+(?:(N)[ \t]*)?(0*([0-9]+))", re.IGNORECASE)
_CPL_CALL = re.compile(r"\bCALL[ \t]+([A-Za-z_][A-Za-z0-9_.]*)", re.IGNORECASE)
_CPL_DECLARES = re.compile(r"[ \t]*[0-9]+[ \t]+(?:LET[ \t]+|FOR[ \t]+|P?DIM[ \t]+)?\Z", re.IGNORECASE)
_IN_BRACKETS = re.compile(r"\[([^\]]*)\]")


def names_of(lines: list[str], dialect: Dialect) -> Iterator[Name]:
    """Yield the names in the lines of a program, in their order."""
    for number, line in enumerate(lines):
        if len(line) <= MOST_LINE:
            yield from sorted(_in_line(number, line, dialect), key=lambda each: each.span.begin)


def name_at(names: list[Name], line: int, character: int) -> Name | None:
    """Return the name at a place, also right after it."""
    here = [
        each for each in names if each.span.line == line and each.span.begin <= character <= each.span.end
    ]
    return here[-1] if here else None


def givers(names: list[Name], of: Name) -> list[Name]:
    """Return where a name is given: for a variable all assignments to it."""
    return [each for each in same(names, of) if each.role is Role.GIVEN]


def same(names: list[Name], of: Name) -> list[Name]:
    """Return all places of a name."""
    return [each for each in names if (each.kind, each.key) == (of.kind, of.key)]


def _in_line(number: int, line: str, dialect: Dialect) -> Iterator[Name]:
    code = without_comments(line, dialect)
    if is_statement(line, dialect):
        yield from _of_cpl(number, code)
        return
    if block := _N.match(code):
        yield Name(BLOCK, block[2], Span(number, *block.span(1)), Role.GIVEN)
    match dialect.language:
        case "rs274":
            yield from _of_rs274(number, code)
        case "macro":
            for found in _NUMBERED.finditer(code):
                yield Name(
                    VARIABLE, f"#{found[1]}", Span(number, *found.span(0)), _role(found[2] is not None)
                )
            for found in _GOTO.finditer(code):
                yield Name(BLOCK, found[2], Span(number, *found.span(1)), Role.USED)
        case "cpl":
            for found in _IN_BRACKETS.finditer(code):
                yield from _cpl_variables(number, code, found.start(1), found.end(1))
        case _:
            pass
    if dialect.language != "rs274":
        yield from _of_programs(number, code, dialect)


def _of_programs(number: int, code: str, dialect: Dialect) -> Iterator[Name]:
    """Yield the program that a block begins or calls, and the blocks of a contour that it names."""
    if head := _PROGRAM.match(code):
        yield Name(PROGRAM, head[2], Span(number, *head.span(1)), Role.GIVEN)
    calls = contours = False
    for word in _CALL.finditer(code):
        value = float(word[2])
        if word[1] in "Mm":
            calls |= value.is_integer() and dialect.m_action(int(value)) is MAction.SUB_CALL
        else:
            calls |= dialect.language == "macro" and value in _MACRO_CALLS
            action = dialect.g_action(value)
            contours |= action is not None and action.family is Family.CONTOUR_CYCLE
    if calls and (called := _P.search(code)):
        yield Name(PROGRAM, _program(called[2], dialect), Span(number, *called.span(1)), Role.USED)
    elif contours:
        for found in _P_Q.finditer(code):
            yield Name(BLOCK, found[2], Span(number, *found.span(1)), Role.USED)


def _program(digits: str, dialect: Dialect) -> str:
    """Return the program that P calls; of more than four digits the last four, where the others are repetitions."""
    return digits[-4:].lstrip("0") or "0" if dialect.sub_program.repeats_in_p and len(digits) > 4 else digits


def _of_rs274(number: int, code: str) -> Iterator[Name]:
    for found in _NUMBERED.finditer(code):
        yield Name(VARIABLE, f"#{found[1]}", Span(number, *found.span(0)), _role(found[2] is not None))
    for found in _NAMED.finditer(code):
        yield Name(
            VARIABLE, f"#<{_folded(found[1])}>", Span(number, *found.span(0)), _role(found[2] is not None)
        )
    if head := _O_WORD.match(code):
        label = _folded(head[1]) if head[1] is not None else head[2]
        begin, end = head.span(1) if head[1] is not None else head.span(2)
        word = head[3].lower()
        kind = PROGRAM if word in ("sub", "endsub", "call", "return") else LABEL
        given = word in ("sub", "while", "do", "if", "repeat")
        yield Name(kind, label, Span(number, begin, end), _role(given))


def _of_cpl(number: int, code: str) -> Iterator[Name]:
    line = _CPL_LINE.match(code)
    assert line is not None
    yield Name(LABEL, line[2], Span(number, *line.span(1)), Role.GIVEN)
    for found in _CPL_GOTO.finditer(code):
        yield Name(BLOCK if found[1] else LABEL, found[3], Span(number, *found.span(2)), Role.USED)
    for found in _CPL_CALL.finditer(code):
        yield Name(PROGRAM, found[1].upper(), Span(number, *found.span(1)), Role.USED)
    yield from _cpl_variables(number, code, line.end(1), len(code))


def _cpl_variables(number: int, code: str, begin: int, end: int) -> Iterator[Name]:
    tokens = LEXICON.row(code, begin, end)
    called = False
    for token, after in zip(tokens, [*tokens[1:], None], strict=True):
        span = Span(number, token.at, token.at + len(token.text))
        first = bool(_CPL_DECLARES.match(code, 0, token.at))
        if token.kind == "label":
            yield Name(
                LABEL, token.word, span, _role(_CPL_LINE.match(code, 0, span.end) is not None and first)
            )
        elif token.kind == "name" and token.word not in RESERVED and not called:
            given = first and after is not None and after.word in ("=", "(")
            yield Name(VARIABLE, token.word, span, _role(given))
        called = token.word == "CALL" or (token.word == "GOTO")


def _role(given: bool) -> Role:
    return Role.GIVEN if given else Role.USED


def _folded(name: str) -> str:
    return re.sub(r"[ \t]", "", name).lower()


def program_file(key: str, text: str, name: str, dialect: Dialect) -> tuple[Path, int] | None:
    """Return the file of a program that is called, and its line from 0; None if there is none beside the caller."""
    here = ProgramText.from_text(text, name)
    if dialect.language == "cpl":
        path = next((each for each in _beside(name) if each.name.upper() == key), None)
        return None if path is None else (path, 0)
    if dialect.language == "rs274":
        path = sub_program_file(key, here, ())
        return None if path is None else (path, 0)
    try:
        place = SubPrograms(here, dialect, None).find(int(key), here)
    except UsageError:
        return None
    if place is None:
        return None
    return Path(place.text.name), place.line - 1


def _beside(name: str) -> list[Path]:
    try:
        return sorted(each for each in Path(name).parent.iterdir() if each.is_file())
    except OSError:
        return []
