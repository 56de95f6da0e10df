"""Stand-alone programs of the APCI board: their names, what their words are, completion and outline."""

from __future__ import annotations

from itertools import pairwise

from polycnc.controllers.apci import sap
from polycnc.editor._codes import Completion
from polycnc.editor._names import VARIABLE, Name, Role
from polycnc.editor._outline import Symbol, sections
from polycnc.editor._place import Span

_PARTS = ("procedure", "function", "event")
_OWN = frozenset((*sap.KEYWORDS, *sap.COMMANDS, *sap.SYSTEM_VARIABLES, *sap.AXIS_QUALIFIERS))


def sap_words() -> frozenset[str]:
    """Return the words that no name may be."""
    return _OWN


def sap_names(text: str) -> list[Name]:
    """Return the names that a program gives; the first place of a name gives it."""
    found: list[Name] = []
    known: set[str] = set()
    before = ""
    for token in sap.tokens(sap.SourceText(text, ""), []):
        if token.kind == sap.NAME and token.word not in _OWN and before != ".":
            span = Span(token.at.line - 1, token.at.column - 1, token.at.column - 1 + len(token.text))
            role = Role.USED if token.word in known else Role.GIVEN
            found.append(Name(VARIABLE, token.word, span, role))
            known.add(token.word)
        before = token.text
    return found


def sap_hover(lines: list[str], line: int, character: int) -> tuple[str, Span] | None:
    """Return what a command or a variable of the board at a place is, as Markdown, and where it stands."""
    if not 0 <= line < len(lines):
        return None
    row = lines[line]
    for token in sap.tokens(sap.SourceText(row, ""), []):
        begin = token.at.column - 1
        if token.kind != sap.NAME or not begin <= character < begin + len(token.text):
            continue
        said = _meaning(token.word)
        return (f"**{token.text}**: {said}", Span(line, begin, begin + len(token.text))) if said else None
    return None


def sap_completions(text: str) -> list[Completion]:
    """Return the words of the language and of the board, and the names of the program."""
    words = sorted(_OWN)
    own = sorted({each.key for each in sap_names(text)})
    return [Completion(word, _meaning(word) or "word of the language") for word in words] + [
        Completion(name, "name of this program") for name in own
    ]


def sap_outline(text: str, length: int) -> list[Symbol]:
    """Return the procedures, functions and events of a program."""
    tokens = sap.tokens(sap.SourceText(text, ""), [])
    heads = [
        Symbol(f"{token.text} {after.text}", "", True, token.at.line - 1)
        for token, after in pairwise(tokens)
        if token.word in _PARTS and after.kind == sap.NAME
    ]
    return sections(heads, length)


def _meaning(word: str) -> str:
    if (command := sap.COMMANDS.get(word)) is not None:
        numbers = ", ".join(name for name, _ in command.numbers)
        return f"command of the board; {command.axes.value}" + (f"; numbers: {numbers}" if numbers else "")
    for table, what in (
        (sap.SYSTEM_VARIABLES, "variable of the board"),
        (sap.AXIS_QUALIFIERS, "value of an axis"),
    ):
        if (register := table.get(word)) is not None:
            return what + ("" if register.writable else ", cannot be written")
    return ""
