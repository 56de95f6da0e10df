"""Give a variable, a label or a block another name, everywhere in its program."""

from __future__ import annotations

import re

from polycnc.editor._names import BLOCK, LABEL, PROGRAM, VARIABLE, Name, Role, same
from polycnc.editor._place import Span
from polycnc.editor._stand_alone import sap_words
from polycnc.errors import UsageError
from polycnc.nc.cpl import LEXICON, RESERVED
from polycnc.nc.rs274 import KNOWN_NAMES

STAND_ALONE, CONTROL = "stand-alone", "control file"
"""What is renamed in files that are no part programs; else it is the language of the dialect."""
_FIRST_SYSTEM = {"macro": 1000, "rs274": 5061}
"""The first numbers of variables that belong to the control."""
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_ ]*")


def check_renaming(names: list[Name], of: Name, language: str) -> None:
    """Check that a name is one that can be changed.

    Raises:
        UsageError: It belongs to the control, or to other files too.
    """
    if of.kind == PROGRAM and (language != "rs274" or not any(
        each.role is Role.GIVEN for each in same(names, of)
    )):  # fmt: skip
        raise UsageError(
            "a program is called from other files too", hint="Rename its file and its calls by hand."
        )
    if language == CONTROL:
        raise UsageError(
            "a control file names what tool paths say", hint="Its names are fixed: see its reference."
        )
    if of.kind == LABEL and language == "cpl" and of.key.isdigit():
        raise UsageError(
            "the numbers of CPL lines keep their order", hint="Renumber them all: format the text."
        )
    if of.kind == VARIABLE and _is_of_the_control(of.key, language):
        raise UsageError(f"{of.key} belongs to the control", hint="Rename a variable of the program.")


def renamed(names: list[Name], lines: list[str], of: Name, new: str, language: str) -> list[tuple[Span, str]]:
    """Return what to write at each place of a name for it to be another one.

    Raises:
        UsageError: It cannot be changed, the new name is none, or is in use.
    """
    check_renaming(names, of, language)
    key = _key(of, new.strip(), language)
    if key == of.key:
        return []
    if any((each.kind, each.key) == (of.kind, key) for each in names) or (
        of.kind == VARIABLE and _is_of_the_control(key, language)
    ):
        raise UsageError(f"{key} is in use already", hint="Choose another name.")
    return [(each.span, _written(each, lines, key)) for each in same(names, of)]


def _is_of_the_control(key: str, language: str) -> bool:
    if re.fullmatch(r"#[0-9]+", key):
        return int(key[1:]) >= _FIRST_SYSTEM.get(language, 0) or int(key[1:]) == 0
    bare = key.removeprefix("#<").removesuffix(">")
    return language == "rs274" and (bare in KNOWN_NAMES or bare.startswith(("_ini[", "_hal[")))


def _key(of: Name, new: str, language: str) -> str:
    """Return how a new name compares with others.

    Raises:
        UsageError: It is no name of that kind.
    """
    if of.key.startswith("#<"):
        key = _parameter(of, new)
    elif language == "cpl" and of.kind == VARIABLE:
        key = _of_cpl(of, new)
    elif of.key[:1] == ".":
        key = f".{new.removeprefix('.').upper()}" if _CPL_LABEL.fullmatch(new) else None
    elif of.key.lstrip("#").isdigit():
        key = _number(of, new)
    elif _NAME.fullmatch(new) and not (
        language == STAND_ALONE and (" " in new or new.lower() in sap_words())
    ):
        key = new.replace(" ", "").lower()
    else:
        key = None
    if key is None:
        raise UsageError(f"'{new[:40]}' is no name of this kind", hint=f"Write one like {of.key}.")
    return key


_CPL_LABEL = re.compile(r"\.?[A-Za-z][^\s:,]*")


def _parameter(of: Name, new: str) -> str | None:
    bare = new.removeprefix("#").strip("<>")
    if not _NAME.fullmatch(bare) or bare.startswith("_") != of.key.startswith("#<_"):
        return None
    return f"#<{bare.replace(' ', '').lower()}>"


def _of_cpl(of: Name, new: str) -> str | None:
    token = LEXICON.row(new, 0, len(new))[:1]
    whole = bool(token) and token[0].kind == "name" and token[0].text == new
    return new.upper() if whole and token[0].word not in RESERVED and _type(new) == _type(of.key) else None


def _number(of: Name, new: str) -> str | None:
    found = re.fullmatch(r"[#NO]?0*([0-9]{1,8})", new.upper())
    if found is None:
        return None
    return f"#{found[1]}" if of.key[0] == "#" else found[1]


def _type(name: str) -> tuple[str, str]:
    """Return what the first and the last sign of a variable of CPL say: where it is kept, and its type."""
    return (name[0] if name[0] in "#@" else ""), (name[-1] if name[-1] in "%!?$" else "")


def _written(name: Name, lines: list[str], key: str) -> str:
    old = lines[name.span.line][name.span.begin : name.span.end]
    if name.kind == BLOCK or (name.kind == LABEL and key.isdigit()):
        return re.sub(r"[0-9]+\Z", key, old)
    return key
