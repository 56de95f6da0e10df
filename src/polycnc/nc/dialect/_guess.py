"""Which dialect a program is written in: named, by its file's extension, or guessed from what it says.

A guess rests on one place of the text, which it names. What the text does not settle is the default dialect.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from polycnc.errors import ProgramError
from polycnc.nc.dialect._dialect import DEFAULT_DIALECT, DIALECTS, Dialect, load_dialect
from polycnc.nc.text._program import ProgramText

_LOOKED_AT = 1 << 18  # bytes: what a language is, its programs say early
_NOTHING = re.compile(rb"\([^)\r\n]*\)|;[^\r\n]*|\"[^\"\r\n]*\"")
_LINE = rb"[\r\n][ \t]*"  # found in a tenth of the time that a look behind takes
_NUMBER = _LINE + rb"(?:[Nn][ \t]*[0-9]+)?[ \t]*"


@dataclass(frozen=True, slots=True)
class _Sign:
    """What tells a dialect, or a language that nobody reads here."""

    name: str
    pattern: re.Pattern[bytes]


def _sign(name: str, pattern: bytes) -> _Sign:
    return _Sign(name, re.compile(pattern, re.IGNORECASE))


_HEIDENHAIN = "Heidenhain conversational language"
_SIEMENS = "Siemens language of Sinumerik controls"
_HEIDENHAIN_ISO = "DIN/ISO language of Heidenhain controls"
_OKUMA = "OSP language of Okuma controls"
_FAGOR = "Fagor language"
_PRINTER = "language of 3D printers"
_UNREADABLE = (
    _sign(_HEIDENHAIN, _LINE + rb"(?:[0-9]+[ \t]+)?BEGIN[ \t]+PGM\b"),
    _sign(_HEIDENHAIN, _LINE + rb"[0-9]+[ \t]+(?:TOOL CALL|CYCL DEF|FN ?[0-9]+:|LBL[ \t])"),
    _sign(_SIEMENS, rb"(?<![A-Z])(?:CYCLE[0-9]{2,4}|POCKET[1-4]|SLOT[12]|HOLES[12])[ \t]*\("),
    _sign(_SIEMENS, _NUMBER + rb"DEF[ \t]+(?:REAL|INT|BOOL|STRING|AXIS)\b"),
    _sign(_SIEMENS, _NUMBER + rb"(?:PROC[ \t]+[A-Z_]|TRANS[ \t]+[XYZ]|MSG[ \t]*\()"),
    _sign(_SIEMENS, _NUMBER + rb"(?:R[0-9]+[ \t]*=[ \t]*[-+0-9R(.]|(?:IF|WHILE)[ \t]+R[0-9]+|GOTO[BF][ \t])"),
    _sign(_SIEMENS, rb"%_N_[A-Z0-9_]+_[MS]PF\b"),
    _sign(_HEIDENHAIN_ISO, _NUMBER + rb"%[A-Z0-9_]+[ \t]+G7[01][ \t]*\*"),
    _sign(_OKUMA, _LINE + rb"\$[A-Z0-9_-]+\.(?:MIN|SSB|SUB)%"),
    _sign(
        _OKUMA,
        _NUMBER
        + rb"(?:V[CS][0-9]+[ \t]*=|G15[ \t]+H[0-9]|CALL[ \t]+O[A-Z]|(?:G85[ \t]+)?NLAP[0-9]|NAT[0-9])",
    ),
    _sign(_FAGOR, _LINE + rb"%[A-Z0-9_ ]+,MX[-,]"),
    _sign(_PRINTER, rb"(?<![A-Z])G[ \t]*92[ \t]+E[-.0-9]"),
    _sign(_PRINTER, _LINE + rb"<Slice>"),
    _sign(_PRINTER, _LINE + rb"M1(?:04|09|40|90)[ \t]+S[0-9]"),
    _sign(_PRINTER, rb"(?<![A-Z])G[ \t]*0?1[ \t](?:[XYZF][-.0-9]+[ \t]+)+E[-.0-9]"),
    _sign("language of ShopBot tools", _LINE + rb"(?:[JM][XYZABS2-5]|VS)[ \t]*,[ \t]*[-.0-9]"),
    _sign("NCP language of isel machines", rb"\A\n[ \t]*IMF_PBL"),
    _sign("plotter language HPGL", rb"\A\n[ \t]*IN;"),
)
_BETWEEN_BRACKETS = (
    _sign(
        _FAGOR, _NUMBER + rb"\((?:IF[ \t]+P[0-9]+|GOTO[ \t]+N[0-9]+|P[0-9]+[ \t]*=[ \t]*P[0-9]+[ \t]*[-+*/F])"
    ),
)
"""Signs of languages whose statements stand where other languages have comments."""
_O_WORDS = b"SUB|ENDSUB|CALL|RETURN|IF|ELSEIF|ELSE|ENDIF|WHILE|ENDWHILE|DO|REPEAT|ENDREPEAT|BREAK|CONTINUE"
_CPL_WORDS = b"IF|LET|FOR|REPEAT|WHILE|DIM|DEF|CASE|PRN#|DSP|CALL|GOTO|GOSUB|REM"
_CPL_ASSIGNS = rb"[A-Z_][A-Z0-9_]*[%$?!#]?(?:\([^)\r\n]*\))?[ \t]*="
_MACRO = rb"WHILE[ \t]*\[|IF[ \t]*\[|GOTO[ \t]*[0-9#\[]|#[ \t]*[0-9]+[ \t]*="
_SIGNS = (
    _sign("linuxcnc", rb"#[ \t]*<[ \t]*[A-Z_]"),
    _sign("linuxcnc", _NUMBER + rb"O[ \t]*(?:[0-9]+|<[^>\r\n]*>)[ \t]*(?:" + _O_WORDS + rb")\b"),
    _sign("linuxcnc", rb"(?<![A-Z])G[ \t]*64[ \t]*P[ \t]*[0-9.]"),
    _sign("bosch", _LINE + rb"[0-9]+[ \t]+(?:(?:" + _CPL_WORDS + rb")\b|" + _CPL_ASSIGNS + rb")"),
    _sign("grbl", _LINE + rb"\$(?:[0-9]+=|[HXCGIN#$]|J=)"),
    _sign("fanuc-lathe", rb"(?<![A-Z])G[ \t]*7[0-2][ \t]*P[0-9]+[ \t]*Q[0-9]+"),
    _sign("fanuc-lathe", rb"(?<![A-Z])G[ \t]*28[ \t]*(?:G[ \t]*0+[ \t]*)?U[-+.0-9]+[ \t]*(?=[W\r\n(;])"),
    _sign(
        "haas", rb"(?<![A-Z])G[ \t]*1[23](?=[^\r\n]*I[ \t]*[0-9.])(?=[^\r\n]*[DKQZ][ \t]*[-+0-9.])(?![0-9.])"
    ),
    _sign("haas", rb"(?<![A-Z])G[ \t]*150[ \t]+(?:[A-Z][-+0-9. \t]*)*P[ \t]*[0-9]"),
    _sign("fanuc", rb"(?<![A-Z])G[ \t]*6[56](?:\.1)?[ \t]*(?:[A-Z][-+0-9. \t]*)*P[ \t]*[0-9]"),
    _sign("fanuc", _NUMBER + rb"(?:/[0-9]?[ \t]*)?(?:" + _MACRO + rb")"),
    _sign("fanuc", rb"(?<![A-Z])G[ \t]*(?:16|31|6[89]|5[01]\.1|54\.1)(?![0-9.])"),
    _sign("fanuc", rb"(?:(?<=\A\n)|(?<=\A\n%\n)|(?<=\A\n%\r\n)):[ \t]*[0-9]{1,8}(?=[ \t]*(?:[\r\n(;]|\Z))"),
    _sign("fanuc", _LINE + rb"O[ \t]*[0-9]{1,8}(?=[ \t]*(?:[\r\n(;]|\Z))"),
)
_CODES, _, _NUMBERED = _SIGNS[-3:]
_CYCLES = [sign for sign in _SIGNS if sign.name == "fanuc-lathe"]
_BRACKETS = re.compile(rb"\([^)\r\n]*\)")
_REMARK = re.compile(rb";[ \t]*(?:[A-Za-z]{3}|[A-Za-z]{1,2}[ \t]+[A-Za-z]{2})")
"""A remark after a semicolon, which ends a block on controls whose programs have nothing but a number."""
_TURRET = re.compile(rb"(?<![A-Z])T[0-9]{3,4}(?![0-9])", re.IGNORECASE)
_MILL = re.compile(
    rb"(?<![A-Z])(?:Y[ \t]*[-+.0-9#\[]|M[ \t]*0?6(?![0-9])|G[ \t]*4[34](?![0-9]))", re.IGNORECASE
)
_TURNING = {"fanuc": "fanuc-lathe"}
_SYSTEM_B = re.compile(rb"(?<![A-Z])G[ \t]*(?:7[79]|9[15])(?![0-9.])", re.IGNORECASE)
"""Codes of turning controls that G code system A does not have."""


@dataclass(frozen=True, slots=True)
class ChosenDialect:
    """A dialect, and why it was guessed: like "O1000 in line 2", empty where it was named or is the default one.

    `problem` is the error of a program in a language that nobody reads here.
    """

    dialect: Dialect
    reason: str = ""
    problem: ProgramError | None = None


def choose_dialect(text: ProgramText, explicit: str | Path | Dialect | None = None) -> ChosenDialect:
    """Return the dialect of a program: the explicit one, else by the file's extension, else by what it says.

    Raises:
        UsageError: there is no such dialect.
    """
    if explicit is not None:
        return ChosenDialect(load_dialect(explicit))
    extension = Path(text.name).suffix.lower()
    for name in DIALECTS:
        if extension and extension in load_dialect(name).extensions:
            return ChosenDialect(_with_remarks(load_dialect(name), b"\n" + text.content[:_LOOKED_AT]))
    words = words_of(text)
    default = load_dialect(DEFAULT_DIALECT)
    for sign in _UNREADABLE:
        if found := sign.pattern.search(words):
            return ChosenDialect(default, problem=_unreadable(text, sign, found))
    with_comments = b"\n" + text.content[:_LOOKED_AT]
    for sign in _BETWEEN_BRACKETS:
        if found := sign.pattern.search(with_comments):
            return ChosenDialect(default, problem=_unreadable(text, sign, found))
    for sign in _SIGNS:
        if (chosen := _by_sign(sign, words, with_comments)) is not None:
            dialect, found = chosen
            line = text.position(_begin(found)).line
            return ChosenDialect(dialect, f"{_shown(text, found)} in line {line}")
    return ChosenDialect(default)


def _by_sign(sign: _Sign, words: bytes, with_comments: bytes) -> tuple[Dialect, re.Match[bytes]] | None:
    """Return the dialect that a sign tells, and what was found; None where it tells none."""
    found = sign.pattern.search(words)
    if found is None:
        return None
    remarks = sign in (_CODES, _NUMBERED, *_CYCLES) and _has_remarks(with_comments)
    turret = _TURRET.search(words) and not _MILL.search(words)
    lathe = _TURNING.get(sign.name) if turret else None
    if remarks and lathe is None and sign is _NUMBERED:
        return None
    dialect = load_dialect(lathe or sign.name)
    if dialect.name == "fanuc-lathe" and (code := _SYSTEM_B.search(words)):
        dialect, found = load_dialect("fanuc-lathe-b"), code
    return _with_remarks(dialect, with_comments) if remarks else dialect, found


def _has_remarks(text: bytes) -> bool:
    return _REMARK.search(_BRACKETS.sub(b"", text)) is not None


def _with_remarks(dialect: Dialect, text: bytes) -> Dialect:
    """Return a dialect whose blocks a semicolon ends, with remarks after semicolons where a text has some."""
    rules = dialect.text
    if not rules.semicolon_ends or rules.semicolon_comments or not _has_remarks(text):
        return dialect
    return dialect.model_copy(update={"text": rules.model_copy(update={"semicolon_comments": True})})


def dialect_for(text: ProgramText, explicit: str | Path | Dialect | None = None) -> Dialect:
    """Return the dialect of a program as `choose_dialect` does.

    Raises:
        UsageError: there is no such dialect.
        ProgramError: it is written in a language that nobody reads here.
    """
    chosen = choose_dialect(text, explicit)
    if chosen.problem is not None:
        raise chosen.problem
    return chosen.dialect


def _unreadable(text: ProgramText, sign: _Sign, found: re.Match[bytes]) -> ProgramError:
    return ProgramError(
        f"this program is in the {sign.name}, which polycnc does not read ({_shown(text, found)})",
        position=text.position(_begin(found)),
        hint=f"Post it for one of {', '.join(DIALECTS)}; if it is one of these, name it with --dialect.",
    )


def words_of(text: ProgramText, most: int = _LOOKED_AT) -> bytes:
    """Return a new line and the beginning of a text, blanks in its comments and strings."""
    begin = b"\n" + text.content[:most]
    return _NOTHING.sub(lambda found: found[0][:1] + b" " * (len(found[0]) - 1), begin)


def _begin(found: re.Match[bytes]) -> int:
    """Return where in the text begins what was found."""
    return _end(found) - len(found[0].lstrip())


def _end(found: re.Match[bytes]) -> int:
    return found.end() - 1


def _shown(text: ProgramText, found: re.Match[bytes]) -> str:
    """Return what has been found as it is written, short."""
    shown = text.content[_begin(found) : _end(found)].decode("utf-8", "replace")
    return " ".join(shown.split())[:30]
