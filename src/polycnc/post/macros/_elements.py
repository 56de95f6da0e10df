"""What a line of a macro is made of: the seven kinds of elements, found from left to right (Manual 001, 1 to 7)."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from polycnc.language import Flaw
from polycnc.post.macros._expression import FUNCTIONS, Expression, read_value
from polycnc.post.macros._symbols import LINE_TEXTS
from polycnc.units import whole


@dataclass(frozen=True, slots=True)
class Text:
    """Text as it is written, and its place in the order of output."""

    at: int
    text: str
    order: int = 0
    quoted: bool = True


@dataclass(frozen=True, slots=True)
class Code:
    """A G or M code by its search key; "*" only sets the mode, "-" keeps quiet if the mode is in force."""

    at: int
    key: str
    prefix: Literal["", "*", "-"]


@dataclass(frozen=True, slots=True)
class Word:
    """The contents of a reserved word or of a function variable."""

    at: int
    name: str


@dataclass(frozen=True, slots=True)
class Numbering:
    """This block gets a sequence number, or gets none."""

    at: int
    wanted: bool


@dataclass(frozen=True, slots=True)
class Assignment:
    """A variable and its new value: an expression, or the text for a reserved word."""

    at: int
    name: str
    value: Expression | str


@dataclass(frozen=True, slots=True)
class Initialisation:
    """The next output of a code or function variable is not omitted; the variable may get a value."""

    at: int
    key: str
    value: Expression | None


Element: TypeAlias = Text | Code | Word | Numbering | Assignment | Initialisation

_PLAIN = re.compile(r"""[^!$@&<>"']+""")
_ORDERED = re.compile(r"(.*),[ \t]*([+-]?[0-9]{1,9})[ \t]*")
_TARGET = re.compile(r"<[ \t]*([A-Za-z][A-Za-z0-9_]*)[ \t]*=[ \t]*")
_TEXT_VALUE = re.compile(r'"([^"]*)"[ \t]*>')
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
KEY = re.compile(r"[A-Za-z][A-Za-z0-9_.]*")
"""How a search key is spelled."""


def read_elements(line: str) -> tuple[Element, ...]:
    """Return the elements of a line that is no IF, ELSE or ENDIF.

    Raises:
        Flaw: Something in the line is no element.
    """
    elements: list[Element] = []
    at = 0
    while at < len(line):
        reader = _READERS.get(line[at])
        if reader is None:
            end = _PLAIN.match(line, at).end()  # type: ignore[union-attr]
            elements.append(Text(at, line[at:end], quoted=False))
        else:
            element, end = reader(line, at)
            elements.append(element)
        at = end
    return tuple(elements)


def _closing(line: str, at: int, what: str) -> int:
    end = line.find(line[at], at + 1)
    if end < 0:
        raise Flaw(
            at, f"{what} has no end", f"write {line[at]} after it too; to output {_quotable(line[at])}"
        )
    return end


def _quotable(mark: str) -> str:
    return f"{mark} itself, put it in double quotes" if mark != '"' else "the quote itself is not possible"


def _quoted(line: str, at: int) -> tuple[Element, int]:
    end = _closing(line, at, "the text in double quotes")
    return Text(at, line[at + 1 : end]), end + 1


def _ordered(line: str, at: int) -> tuple[Element, int]:
    end = _closing(line, at, "the text in single quotes")
    found = _ORDERED.fullmatch(line, at + 1, end)
    if found is None:
        raise Flaw(
            at,
            "a text in single quotes ends with a comma and its place in the order",
            "write it like '/,-200'; a text without an order needs no quotes, or double quotes",
        )
    return Text(at, found[1], whole(found[2])), end + 1


def _code(line: str, at: int) -> tuple[Element, int]:
    end = _closing(line, at, "the code")
    body = line[at + 1 : end]
    prefix: Literal["", "*", "-"] = "*" if body[:1] == "*" else "-" if body[:1] == "-" else ""
    key = body[len(prefix) :]
    if not KEY.fullmatch(key):
        raise Flaw(
            at,
            f"'{body}' is not the search key of a code",
            "write !G00!, !*G00! or !-G00!; a code has one prefix at most",
        )
    return Code(at, key.upper(), prefix), end + 1


def _word(line: str, at: int) -> tuple[Element, int]:
    end = _closing(line, at, "the word")
    name = line[at + 1 : end]
    if not _NAME.fullmatch(name):
        raise Flaw(at, f"'{name}' is not a word", "write the name of a word between two $, like $X$")
    return Word(at, name.upper()), end + 1


def _numbering(line: str, at: int) -> tuple[Element, int]:
    if line[at : at + 3] not in ("@0@", "@1@"):
        raise Flaw(at, "@ begins neither @0@ nor @1@", "to output @ itself, put it in double quotes")
    return Numbering(at, line[at + 1] == "1"), at + 3


def _assignment(line: str, at: int) -> tuple[Element, int]:
    target = _TARGET.match(line, at)
    if target is None:
        raise Flaw(
            at, "< begins no assignment", "write <V1=100+1>; to output < itself, put it in double quotes"
        )
    name = target[1].upper()
    if name in FUNCTIONS:
        raise Flaw(at + 1, f"{name} is a function", "choose another name for the variable")
    if line.startswith('"', target.end()):
        text = _TEXT_VALUE.match(line, target.end())
        if text is None:
            raise Flaw(target.end(), "the text is not closed by a quote and >", f'write <{name}="text">')
        return Assignment(at, name, text[1]), text.end()
    if name in LINE_TEXTS:
        raise Flaw(target.end(), f"{name} takes a text in double quotes", f'write <{name}="text">')
    end = line.find(">", target.end())
    if end < 0:
        raise Flaw(at, "the assignment has no end", "write > after its expression")
    return Assignment(at, name, read_value(line, target.end(), end)), end + 1


def _initialisation(line: str, at: int) -> tuple[Element, int]:
    end = _closing(line, at, "the initialisation")
    key, star, _ = line[at + 1 : end].partition("*")
    if not KEY.fullmatch(key):
        raise Flaw(at, f"'{key}' is not a search key", "write &F&, or &X*0& with a value")
    value = read_value(line, at + 1 + len(key) + 1, end) if star else None
    return Initialisation(at, key.upper(), value), end + 1


def _stray(line: str, at: int) -> tuple[Element, int]:
    raise Flaw(at, "> ends nothing here", "to output > itself, put it in double quotes")


_READERS: dict[str, Callable[[str, int], tuple[Element, int]]] = {
    '"': _quoted,
    "'": _ordered,
    "!": _code,
    "$": _word,
    "@": _numbering,
    "<": _assignment,
    ">": _stray,
    "&": _initialisation,
}
