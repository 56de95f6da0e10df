"""Declarations for Visual Basic and Delphi, beside the prototypes that the manual prints in these languages."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from polycnc.conformance import load_conformance
from polycnc.controllers.apci.clib import MCUG3
from polycnc.controllers.library.clib import CLibrary, write_basic, write_pascal

OTHERWISE = {
    # What C has a pointer to is printed by value, or a number by reference.
    "VB": "rdEffRadius rdJerkRel rdMaxAcc rdMaxVel rdMCiS rdMDVel rdnfrax rdPosErr rdSampleTime wrEffRadius wrJerkRel "
    "wrMaxAcc wrMaxVel wrMDVel wrnfrax "
    # Another type, no result where C has one, or no word for what it is.
    "rdErrorReg gettskstr rdcbcnct wrcbcnct wrModeReg",
    "Delphi": "rdPosErr rdcncts",
}
"""What the manual prints otherwise than in C, by its name for the language."""
ALIKE = {
    "integer": "longint", "pchar": "pansichar", "string": "pansichar", "cppstring": "pansichar", "as": "as_",
    "asel": "as_", "asele": "as_",
}  # fmt: skip
_HEAD = re.compile(
    r"(?:(?:sub|function|procedure)\s+)?(\w+)\s*(?:\((.*?)\))?\s*(?:(?::|as)\s*(\w+))?", re.IGNORECASE
)
_BASIC = re.compile(r"\s*(?P<how>byval|byref)?\s*(?P<names>\w+)\s+as\s+(?P<type>\w+)", re.IGNORECASE)
_PASCAL = re.compile(r"[\s,]*(?P<how>var\s)?\s*(?P<names>[\w\s,]+?)\s*:\s*(?P<type>\w+)", re.IGNORECASE)


def _signature(head: str, *, basic: bool) -> tuple[list[tuple[bool, str]], str]:
    """Return of a prototype whether each argument goes by reference, and its type; and the type of the result."""
    match = _HEAD.match(head)
    assert match is not None, head
    arguments = list[tuple[bool, str]]()
    for found in (_BASIC if basic else _PASCAL).finditer(match[2] or ""):
        kind, how = _alike(found["type"]), (found["how"] or "").strip().lower()
        is_text = kind == "pansichar"  # the manual passes them by reference, which a pointer does
        by_reference = how != "byval" if basic else how == "var" and not is_text
        arguments += [(by_reference, kind)] * len(found["names"].split(","))
    return arguments, _alike(match[3] or "")


def _alike(kind: str) -> str:
    return ALIKE.get(kind.lower(), kind.lower())


@pytest.mark.parametrize(
    ("language", "write", "declared"),
    [
        pytest.param(
            "VB", write_basic, r'Public Declare (?P<head>\w+ (?P<name>\w+)) Lib "\S+" (?P<rest>\(.*\).*)',
            marks=pytest.mark.covers("apci.lib.vb"), id="basic",
        ),
        pytest.param(
            "Delphi", write_pascal, r"(?P<head>(?:procedure|function) (?P<name>\w+))(?P<rest>\(.*?\)[^;]*);",
            marks=pytest.mark.covers("apci.lib.delphi"), id="delphi",
        ),
    ],
)  # fmt: skip
def test_functions_are_declared_as_the_manual_prints_them(
    language: str, write: Callable[[CLibrary], str], declared: str
) -> None:
    ours = {each["name"]: each["head"] + each["rest"].strip() for each in re.finditer(declared, write(MCUG3))}
    basic, printed, otherwise = language == "VB", 0, set[str]()
    for row in load_conformance(Path(__file__).parents[2] / "conformance").rows("apci"):
        found = re.search(rf"{language}: (.*?)(?: \| |$)", row.signature)
        if row.name not in MCUG3.functions or found is None:
            continue
        printed += 1
        if _signature(found[1], basic=basic) != _signature(ours[row.name], basic=basic):
            otherwise.add(row.name)
    assert printed > 175
    assert otherwise == set(OTHERWISE[language].split())
