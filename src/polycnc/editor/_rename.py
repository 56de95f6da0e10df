"""Give a variable, a label or a block another name, everywhere in its program."""

from __future__ import annotations

import re

from polycnc.editor._names import BLOCK, LABEL, PROGRAM, VARIABLE, Name, Role, same
from polycnc.editor._place import Span
from polycnc.errors import UsageError
from polycnc.nc import Dialect
from polycnc.nc.cpl import LEXICON, RESERVED
from polycnc.nc.rs274 import KNOWN_NAMES

_FIRST_SYSTEM = {"macro": 1000, "rs274": 5061}
"""The first numbers of variables that belong to the control."""
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_ ]*")


def check_renaming(names: list[Name], of: Name, dialect: Dialect) -> None:
    """Check that a name is one that can be changed.

    Raises:
        UsageError: It belongs to the control, or to other files too.
    """
    if of.kind == PROGRAM and (dialect.language != "rs274" or not any(
        each.role is Role.GIVEN for each in same(names, of)
    )):  # fmt: skip
        raise UsageError(
            "a program is called from other files too", hint="Rename its file and its calls by hand."
        )
    if of.kind == LABEL and dialect.language == "cpl" and of.key.isdigit():
        raise UsageError(
            "the numbers of CPL lines keep their order", hint="Renumber them all: format the text."
        )
    if of.kind == VARIABLE and _is_of_the_control(of.key, dialect):
        raise UsageError(f"{of.key} belongs to the control", hint="Rename a variable of the program.")


def renamed(
    names: list[Name], lines: list[str], of: Name, new: str, dialect: Dialect
) -> list[tuple[Span, str]]:
    """Return what to write at each place of a name for it to be another one.

    Raises:
        UsageError: It cannot be changed, the new name is none, or is in use.
    """
    check_renaming(names, of, dialect)
    key = _key(of, new.strip(), dialect)
    if key == of.key:
        return []
    if any((each.kind, each.key) == (of.kind, key) for each in names) or (
        of.kind == VARIABLE and _is_of_the_control(key, dialect)
    ):
        raise UsageError(f"{key} is in use already", hint="Choose another name.")
    return [(each.span, _written(each, lines, key)) for each in same(names, of)]


def _is_of_the_control(key: str, dialect: Dialect) -> bool:
    if re.fullmatch(r"#[0-9]+", key):
        return int(key[1:]) >= _FIRST_SYSTEM.get(dialect.language, 0) or int(key[1:]) == 0
    bare = key.removeprefix("#<").removesuffix(">")
    return dialect.language == "rs274" and (bare in KNOWN_NAMES or bare.startswith(("_ini[", "_hal[")))


def _key(of: Name, new: str, dialect: Dialect) -> str:
    """Return how a new name compares with others.

    Raises:
        UsageError: It is no name of that kind.
    """
    bare = new
    if of.key.startswith("#<"):
        bare = new.removeprefix("#").strip("<>")
        if _NAME.fullmatch(bare) and bare.startswith("_") == of.key.startswith("#<_"):
            return f"#<{bare.replace(' ', '').lower()}>"
    elif dialect.language == "cpl" and of.kind == VARIABLE:
        token = LEXICON.row(new, 0, len(new))[:1]
        if (token and token[0].kind == "name" and token[0].text == new and token[0].word not in RESERVED
                and _type(new) == _type(of.key)):  # fmt: skip
            return new.upper()
    elif of.key[:1] == ".":
        if re.fullmatch(r"\.?[A-Za-z][^\s:,]*", new):
            return "." + new.removeprefix(".").upper()
    elif of.key.lstrip("#").isdigit():
        bare = new.upper().removeprefix("#").removeprefix("N").removeprefix("O").lstrip("0")
        if bare.isascii() and bare.isdigit() and len(bare) <= 8:
            return f"#{bare}" if of.key[0] == "#" else bare
    elif _NAME.fullmatch(new):
        return new.replace(" ", "").lower()
    raise UsageError(f"'{new[:40]}' is no name of this kind", hint=f"Write one like {of.key}.")


def _type(name: str) -> tuple[str, str]:
    """Return what the first and the last sign of a variable of CPL say: where it is kept, and its type."""
    return (name[0] if name[0] in "#@" else ""), (name[-1] if name[-1] in "%!?$" else "")


def _written(name: Name, lines: list[str], key: str) -> str:
    old = lines[name.span.line][name.span.begin : name.span.end]
    if name.kind == BLOCK or (name.kind == LABEL and key.isdigit()):
        return re.sub(r"[0-9]+\Z", key, old)
    return key
