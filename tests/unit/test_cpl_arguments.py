"""Every function and command of CPL refuses more and fewer arguments than the manual writes down for it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from polycnc import conformance
from polycnc.nc.cpl import Linker
from polycnc.nc.cpl._function import MANY
from polycnc.nc.cpl._functions import FUNCTIONS
from support.cpl_runs import Root

WORDS = re.compile(r"<[^>]*>|\"[^\"]*\"(?:\|\"[^\"]*\")*|\+<offset>|[\[\]{}()]|[A-Za-z0-9]+")

# Where the signature does not tell, the text after it does (Manual 003).
TOLD = {
    "CIR": (1, 6),  # 5032: three or six; other numbers are refused when it runs
    "COL": (1, 6),  # 4923: any of the six may be left out
    "GETERR": (3, 4),  # 2510: the category may be left out, its comma not
    "GPR": (3, 3),  # 5058: the offset is added to a coordinate
    "MMC": (1, 20),  # 5179: at most 20 variables
    "PLC": (3, 4),  # 2420: the size has no meaning for timers and counters
    "SFK": (1, 9),  # 4806: eight texts
    "TFO": (1, 4),  # 4876: commas only in front of the last parameter given
}


def signatures() -> dict[str, str]:
    """Return what the manual writes for each function and command."""
    rows = conformance.read_rows(conformance.data_folder())
    return {name: rows[f"cpl.{name}"].signature for name in FUNCTIONS}


def counts(signature: str, name: str) -> tuple[int, int]:
    """Return the least and the most arguments of a signature: what stands in square brackets may be left out."""
    _, opening, rest = signature.partition(f"{name}(")
    least = most = depth = 0
    level = 1 if opening else 0
    for word in WORDS.findall(rest) if opening else ():
        if word in "()":
            level += 1 if word == "(" else -1
            if level == 0:
                break
        elif word in "[]{}":
            depth += 1 if word in "[{" else -1
            most += MANY if word == "{" else 0
        else:
            most += 1
            least += depth == 0
    return least, min(most, MANY)


WANTED = {name: TOLD.get(name) or counts(signature, name) for name, signature in signatures().items()}


def test_signatures_are_read_as_they_are_written() -> None:
    assert counts("SD(<group>[,<index1>[,<index2>[,<index3>]]])", "SD") == (1, 4)
    assert counts("<INTEGER> = GETERR(<channel>,[<category>],<no.>[,<n>])", "GETERR") == (2, 4)
    assert counts("CLOCK", "CLOCK") == (0, 0)
    assert counts("DSP(<line>,<column>,<expression>{,<expression>})", "DSP") == (3, MANY)


def said(name: str, count: int) -> list[str]:
    """Return what linking says about the number of arguments."""
    function = FUNCTIONS[name]
    given = [f"V{place}%" for place in range(count)]
    call = f"{name}({','.join(given)})" if count else name
    line = f"10 {call}" if function.command else f"10 IF {call}={call} THEN\n20 ENDIF"
    _, errors = Linker(lambda *_: None).link(f"{line}\n", "p.npg")
    return [str(error) for error in errors if f"{name} takes" in str(error)]


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_other_numbers_of_arguments_are_refused(name: str) -> None:
    least, most = WANTED[name]
    for count in range(least, min(most, least + 6) + 1):
        assert not said(name, count), count
    for count in {least - 1, most + 1, most + 3} & set(range(30)):
        (error,) = said(name, count)
        wanted = f"{least}" if least == most else f"{least} to {most}"
        assert f"{name} takes {wanted} arguments, not {count}" in error
        assert FUNCTIONS[name].usage in error


@pytest.mark.parametrize("statement", ["CIR(200,10)", "CIR(200,10,30,40)", "CIR(1,2,3,4,5)", "LIN(20,10,30)"])
def test_a_drawing_with_half_a_point_is_refused(tmp_path: Path, statement: str) -> None:
    assert Root(tmp_path).error(f"10 {statement}") == "1: INVALID PARAMETER"
