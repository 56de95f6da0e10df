"""G70 to G72 of LinuxCNC: a part worked out by hand, and what they refuse. The rest is compared with rs274."""

from __future__ import annotations

from typing import Any

import pytest

from polycnc.nc import language_for, load_dialect
from support.programs import moves, refusal

HEAD = "G18 G61 F600\nG0 X9 Z1\nO3 SUB\nG0 X4\nG1 Z-6\nG1 X7 Z-9\nO3 ENDSUB\n"


def linuxcnc() -> dict[str, Any]:
    dialect = load_dialect("linuxcnc")
    return {"dialect": dialect, "language": language_for(dialect)}


def test_levels_of_a_shaft_with_a_cone() -> None:
    """0.2 off the cone, whose X + Z is -2, X + Z is -1.7172; its end at X7 Z-9 is then at X7.1414 Z-8.8586."""
    found = moves(HEAD + "G71 Q3 X9 Z1 D0.2 I2 R0.25\nM2\n", **linuxcnc())
    assert [each.removesuffix(" stop") for each in found] == [
        "rapid X9 Z1",
        *("line Z-8.8586 F600", "rapid X9.25 Z-8.6086", "rapid Z0.75", "rapid X9 Z1", "rapid X7"),
        *("line Z-8.7172 F600", "rapid X7.25 Z-8.4672", "rapid Z0.75", "rapid X7 Z1", "rapid X5"),
        *("line Z-6.7172 F600", "rapid X5.25 Z-6.4672", "rapid Z0.75", "rapid X5 Z1", "rapid X4.2"),
        *("line Z-5.9172 F600", "line X7.1414 Z-8.8586 F600", "line X9 F600", "M2"),
    ]


@pytest.mark.parametrize(
    ("block", "what"),
    [
        ("G71 X9", "8:1: G71 without Q"),
        ("G71 Q4 X9", "8:5: there is no sub-program O4"),
        ("G72 Q3 I0", "8:8: the depth of a cut is not above zero"),
        ("G71.2 Q3 R-1", "8:10: the retract is negative"),
        ("G17 G71 Q3", "8:5: G71 outside the plane of X and Z"),
        ("G70 Q3 H2", "8:8: 'H' has no meaning in this block"),
        ("G70 Q3 P2000", "8:1: G70: 2000 passes"),
        ("G41.1 D1 L2\nG71 Q3", "9:1: a turning cycle while radius compensation is active"),
        ("O4 SUB\nO3 CALL\nO4 ENDSUB\nG71 Q4", "11:1: a profile with a call"),
        (
            "O4 SUB\nG1 X5 Z-2\nG2 X7 Z-5\nO4 ENDSUB\nG71 Q4",
            "12:1: G71: an arc of the profile without a centre",
        ),
        ("O4 SUB\nG1 X5 Z-2 A1 C1\nX9\nO4 ENDSUB\nG71 Q4", "12:1: G71: A and C at one corner"),
        (
            "O4 SUB\nG1 X5 Z-2\nX9 Z-3\nX8 Z-2\nO4 ENDSUB\nG71 Q4",
            "13:1: G71: the profile goes back along the cuts",
        ),
    ],
)
def test_what_they_refuse(block: str, what: str) -> None:
    assert refusal(HEAD + block + "\nM2\n", **linuxcnc()).startswith(what)
