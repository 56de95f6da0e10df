"""What a G or M code does in the dialect of a program, from the rows that the reference is generated from."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from polycnc.editor._names import PROGRAM, Name
from polycnc.editor._place import Span, is_statement, words_only
from polycnc.nc import Action, Dialect, MAction
from polycnc.nc.cpl import FUNCTION_GROUPS, STATEMENTS
from polycnc.nc.macro import FUNCTIONS as MACRO_FUNCTIONS
from polycnc.nc.macro import OPERATORS as MACRO_OPERATORS
from polycnc.nc.rs274 import FUNCTIONS as NGC_FUNCTIONS
from polycnc.nc.rs274 import KNOWN_NAMES

_CODE = re.compile(r"(?<![A-Za-z_%$])([GM])[ \t]*([0-9]{1,6}(?:\.[0-9]{0,6})?)", re.IGNORECASE)
_ADDRESS = re.compile(r"(?<![A-Za-z_%$#.])([A-Z])[ \t]*[-+]?[0-9.#\[][0-9.\[\]#]*", re.IGNORECASE)
_O_NAMED = re.compile(r"[ \t]*(?:N[0-9]+[ \t]*)?O[ \t]*(?:<[^>]*>|[0-9]+)[ \t]+[A-Za-z]*", re.IGNORECASE)
_O_BEGUN = re.compile(r"[ \t]*(?:N[0-9]+[ \t]*)?O[ \t]*<[^>]*", re.IGNORECASE)
_PARAMETER_BEGUN = re.compile(r"#[ \t]*<[^>]*\Z")
_O_WORDS = (
    "sub", "endsub", "call", "return", "if", "elseif", "else", "endif", "while", "endwhile", "do",
    "repeat", "endrepeat", "break", "continue",
)  # fmt: skip
_NAME_BEGUN = re.compile(r"[A-Za-z_<@#][A-Za-z0-9_]*\Z")
_BEGUN = re.compile(r"(?:\A|(?<=[^A-Za-z_%$]))([GM])[0-9]*\.?[0-9]*\Z", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Completion:
    """A code that may be meant, and what it does."""

    label: str
    detail: str


def hover(lines: list[str], line: int, character: int, dialect: Dialect) -> tuple[str, Span] | None:
    """Return what the G or M code at a place does, as Markdown, and where it stands; None where none stands."""
    if (found := _at(_CODE, lines, line, character, dialect)) is None:
        return None
    return _described(found[1].upper(), float(found[2]), dialect), Span(line, *found.span())


def word(lines: list[str], line: int, character: int, dialect: Dialect) -> tuple[str, Span] | None:
    """Return the letter of the word at a place, and where it stands; None where no word stands."""
    found = _at(_ADDRESS, lines, line, character, dialect)
    return None if found is None else (found[1].upper(), Span(line, *found.span()))


def _at(
    pattern: re.Pattern[str], lines: list[str], line: int, character: int, dialect: Dialect
) -> re.Match[str] | None:
    """Return what of a pattern stands at a place, comments and statements apart."""
    words = words_only(lines[line], dialect) if 0 <= line < len(lines) else ""
    return next((each for each in pattern.finditer(words) if each.start() <= character < each.end()), None)


def completions(
    lines: list[str], line: int, character: int, dialect: Dialect, names: Sequence[Name] = ()
) -> list[Completion]:
    """Return the codes of the dialect with the letter that has been begun before a place, or `names` of the text."""
    if not 0 <= line < len(lines):
        return []
    before = lines[line][:character]
    if dialect.language == "rs274" and (found := _names_begun(before, line, names)) is not None:
        return found
    begun = _BEGUN.search(words_only(before, dialect))
    if begun is None:
        return _functions(before, dialect) if _NAME_BEGUN.search(before) else []
    if begun[1].upper() == "G":
        return [
            Completion(f"G{code:g}", _does(each, dialect)) for code, each in sorted(dialect.g_codes().items())
        ]
    codes = sorted({int(code) for code in dialect.m})
    return [Completion(f"M{code}", _plain(dialect.m_action(code))) for code in codes]


def _names_begun(before: str, line: int, names: Sequence[Name]) -> list[Completion] | None:
    """Return what may follow an O that has been begun, or `#<`; None where neither has."""
    elsewhere = [each for each in names if each.span.line != line]
    if _O_NAMED.fullmatch(before):
        return [Completion(word, "O-word") for word in _O_WORDS]
    if _O_BEGUN.fullmatch(before):
        keys = dict.fromkeys(each.key for each in elsewhere if each.kind == PROGRAM)
        return [Completion(key, "sub-program") for key in keys]
    if _PARAMETER_BEGUN.search(before):
        keys = dict.fromkeys(each.key for each in elsewhere if each.key.startswith("#<"))
        own = [key[2:-1] for key in keys if key[2:-1] not in KNOWN_NAMES]
        known = [Completion(name, "value of the control") for name in KNOWN_NAMES]
        return [*(Completion(name, "parameter") for name in own), *known]
    return None


def _functions(before: str, dialect: Dialect) -> list[Completion]:
    """Return the functions, statements and predefined names of the language that a program may hold."""
    match dialect.language:
        case "cpl" if is_statement(f"{before} ", dialect) or "[" in before:
            rows = [row for rows in FUNCTION_GROUPS.values() for row in rows]
            statements = [] if not is_statement(f"{before} ", dialect) else list(STATEMENTS.items())
            return [Completion(row.name, f"{row.usage}: {row.sentence}") for row in rows] + [
                Completion(usage.partition(" ")[0].rstrip(",:"), f"{usage}: {sentence}")
                for usage, sentence in statements
            ]
        case "macro" if "[" in before or "=" in before or "#" in before:
            rows_of = {**MACRO_FUNCTIONS, **MACRO_OPERATORS}
            return [Completion(name, _sentence(run)) for name, run in rows_of.items()]
        case "rs274" if "[" in before:
            return [
                Completion(name.rstrip("_").upper(), "function")
                for name in NGC_FUNCTIONS
                if name.endswith("_")
            ]
        case _:
            return []


def _sentence(run: object) -> str:
    return (run.__doc__ or "").partition("\n")[0]


def _described(letter: str, code: float, dialect: Dialect) -> str:
    name = f"**{letter}{code:g}**"
    if letter == "M":
        action = dialect.m_action(int(code)) if code.is_integer() else None
        if action is None:
            return f"{name}: no M code of dialect {dialect.name}"
        group = f"  \nGroup: {action.group}" if action.group else ""
        return f"{name} ({dialect.name}): {_plain(action)}{group}"
    row = dialect.g_action(code)
    if row is None:
        return f"{name}: no G code of dialect {dialect.name}"
    words = " ".join(_word(each, dialect) for each in row.takes if _is_taken(each, row, dialect))
    taken = f"  \nWords: {words}" if words else ""
    return f"{name} ({dialect.name}): {_does(row, dialect)}  \nGroup: {row.group}{taken}"


def _rounds(row: Action, dialect: Dialect) -> bool:
    """Tell whether words of a straight move round or chamfer the corner after it."""
    return row is not Action.LINEAR or dialect.corner_words


def _does(row: Action, dialect: Dialect) -> str:
    return row.sentence if _rounds(row, dialect) else row.sentence.partition(";")[0]


def _is_taken(word: str, row: Action, dialect: Dialect) -> bool:
    return word not in ("R", "C") or _rounds(row, dialect)


def _word(word: str, dialect: Dialect) -> str:
    if word == "time":
        return " ".join(f"{address} ({unit})" for address, unit in dialect.dwell.items())
    return word


def _plain(action: MAction | None) -> str:
    return "" if action is None else action.title.replace("_", " ")
