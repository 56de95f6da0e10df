"""The rows of functions and errors: what follows from them is right for each (Manual 003, annex A.2)."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import polycnc
from polycnc.nc.cpl import (
    ERRORS,
    FUNCTION_GROUPS,
    RESERVED,
    CharacterField,
    Fault,
    Function,
    Linker,
    Run,
)
from polycnc.nc.cpl._function import Takes
from polycnc.nc.cpl._functions import FUNCTIONS
from support.cpl_host import RecordingHost

OWN = [row for row in FUNCTIONS.values() if row.run is not None]
CONSTANTS = {
    Takes.NUMBER: ("0.35", "!"),
    Takes.PRINTED: ("2.75", ""),
    Takes.INTEGER: ("66", "%"),
    Takes.PLACE: ("3", "%"),
    Takes.TEXT: ('"7#.##"', "$"),
    Takes.LETTER: ('"L"', "$"),
    Takes.STORED: ('" ABCDE"', "$"),
}


def _value(text: str) -> object:
    host = RecordingHost()
    linker = Linker(host.program)
    main, errors = linker.link(text, "x.cpl")
    assert main is not None, errors
    run = Run(main, linker, host)
    while run.step() is not None:
        pass
    found = run.globals["#S$"] if "#S$" in run.globals else run.globals["#A!"]
    return found.text if isinstance(found, CharacterField) else found


@pytest.mark.parametrize("row", OWN, ids=lambda row: row.name)
def test_a_constant_is_evaluated_as_a_variable_is(row: Function) -> None:
    """Sixteen digits are compared, of a number that single precision does not have."""
    for count in range(row.count[0], row.count[1] + 1):
        takes = row.takes[len(row.takes) - count :] if row.leading else row.takes[:count]
        constants = [*(CONSTANTS[each][0] for each in takes)] if row.name not in ("BCD", "BIN") else ["49"]
        names = [f"V{place}{CONSTANTS[each][1]}" for place, each in enumerate(takes)]
        if row.name in ("BCD", "BIN"):
            names = ["V%"]
        lines = ["DIM #S$(40)"] if row.kind == "S" else []
        for name, constant in zip(names, constants, strict=True):
            lines += [f"DIM {name}(9)"] * name.endswith("$") + [f"{name}={constant}"]
        target = "#S$" if row.kind == "S" else "#A!"
        made = [
            _value("\n".join(f"1 {line}" for line in (*lines, f"{target}={row.name}({','.join(given)})")))
            for given in (constants, names)
        ]
        assert made[0] == made[1]
        assert made[0] is not None


def test_every_function_is_reserved_and_has_a_sentence() -> None:
    assert set(FUNCTIONS) <= RESERVED
    for row in FUNCTIONS.values():
        assert row.sentence.endswith(".")
        assert row.count[0] <= row.count[1]
        assert row.run is None or len(row.takes) == row.count[1]
    assert sum(map(len, FUNCTION_GROUPS.values())) == len(FUNCTIONS)


def _faults() -> set[str]:
    """Return the texts that are written where a fault is made."""
    found: set[str] = set()
    package = Path(polycnc.__file__).parent
    for folder in ("nc/cpl", "controllers/bosch"):
        for path in sorted((package / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if (
                    isinstance(node, ast.Call)
                    and getattr(node.func, "id", "") == Fault.__name__
                    and node.args
                ):
                    first = node.args[0]
                    found |= {str(first.value)} if isinstance(first, ast.Constant) else set()
    return found


def test_every_fault_is_in_the_table_of_errors() -> None:
    assert _faults() <= set(ERRORS)
    assert len(_faults()) > 15
