"""Cut the text of a SAP program into tokens."""

from __future__ import annotations

import re
from dataclasses import dataclass

from polycnc.controllers.apci.sap._arithmetic import wrap
from polycnc.controllers.apci.sap._syntax import Place
from polycnc.errors import ProgramError, SourcePosition

NAME, NUMBER, TEXT, SYMBOL, END = "name", "number", "text", "symbol", "end"

_WORDS = """
    and array begin boolean case const div do double downto else end event for function if integer longint mod
    not of on or otherwise procedure program real repeat shl shr then to until var while xor
"""
KEYWORDS = frozenset(_WORDS.split())

_TOKEN = re.compile(
    r"""
    (?P<space>\s+|//[^\n]*|\{[^}]*\}|\(\*.*?\*\))
    |(?P<real>[0-9]+\.[0-9]+(?:[eE][+-]?[0-9]+)?|[0-9]+[eE][+-]?[0-9]+)
    |(?P<integer>[0-9]+)
    |\$(?P<hex>[0-9a-fA-F]+)
    |(?P<name>[A-Za-z_][A-Za-z0-9_]*)
    |'(?P<text>(?:[^'\n]|'')*)'
    |(?P<symbol>:=|<=|>=|<>|\.\.|[-+*/=<>()\[\],;:.])
    """,
    re.VERBOSE | re.DOTALL,
)
_UNFINISHED = {
    "'": ("text without an end", "Close it with ' on the same line; write '' for a quote inside it."),
    "{": ("comment without an end", "Close it with }."),
    "(": ("comment without an end", "Close it with *)."),
    "$": ("'$' without hexadecimal digits", "Write a hexadecimal number like $1F."),
}


@dataclass(frozen=True, slots=True)
class Token:
    """A piece of source: `word` is what to compare with (lower case), `text` how it was written."""

    kind: str
    word: str
    text: str
    value: int | float | str
    at: Place

    def __str__(self) -> str:
        return "end of file" if self.kind == END else f"'{self.text}'"


class SourceText:
    """A source with its lines, to say where something is."""

    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file
        self.lines = text.split("\n")

    def error(self, at: Place, what: str, hint: str) -> ProgramError:
        """Return an error at a place."""
        line = self.lines[at.line - 1].rstrip("\r")
        return ProgramError(what, position=SourcePosition(self.file, at.line, at.column, line), hint=hint)


def tokens(source: SourceText, errors: list[ProgramError]) -> list[Token]:
    """Return the tokens of a source, an end token last; what is no token is added to `errors`."""
    found: list[Token] = []
    text = source.text
    offset, line, begin = 0, 1, 0
    while offset < len(text):
        match = _TOKEN.match(text, offset)
        at = Place(line, offset - begin + 1)
        if match is None or (text.startswith("(*", offset) and match.lastgroup == "symbol"):
            what, hint = _UNFINISHED.get(
                text[offset],
                (f"unexpected character {text[offset]!r}", "Remove it, or put it into a comment."),
            )
            errors.append(source.error(at, what, hint))
            if text[offset] in "{(":
                break
            offset = text.find("\n", offset) if text[offset] == "'" else offset + 1
            offset = len(text) if offset < 0 else offset
            continue
        if match.lastgroup != "space":
            found.append(_token(match, at, source, errors))
        breaks = text.count("\n", offset, match.end())
        if breaks:
            line += breaks
            begin = text.rfind("\n", offset, match.end()) + 1
        offset = match.end()
    last = len(source.lines)
    found.append(Token(END, "", "", "", Place(last, len(source.lines[-1].rstrip("\r")) + 1)))
    return found


def _token(match: re.Match[str], at: Place, source: SourceText, errors: list[ProgramError]) -> Token:
    kind = match.lastgroup or ""
    text, part = match[0], match[kind]
    if kind == "name":
        return Token(NAME, text.lower(), text, text, at)
    if kind == "text":
        return Token(TEXT, "", text, part.replace("''", "'"), at)
    if kind == "symbol":
        return Token(SYMBOL, text, text, text, at)
    if kind == "real":
        value = float(part)
        if value == float("inf"):
            errors.append(source.error(at, f"{text} is too large", "The largest number is about 1.7e308."))
        return Token(NUMBER, "", text, value, at)
    digits = part.lstrip("0")  # before int(), which refuses thousands of them
    if len(digits) > (8 if kind == "hex" else 10) or (kind == "integer" and int(digits or "0") >= 1 << 31):
        hint = "An integer has 32 bits; write a double with a decimal point."
        errors.append(source.error(at, f"{text[:40]} is too large", hint))
        digits = "0"
    return Token(NUMBER, "", text, wrap(int(digits or "0", 16 if kind == "hex" else 10)), at)
