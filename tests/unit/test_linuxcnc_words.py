"""Words of the dialect `linuxcnc`: numbers worked out by hand, what is refused, and parameters that tell of them."""

from __future__ import annotations

from pathlib import Path

import pytest

import polycnc

ENDS = [
    ("G0 X3 Y4\nG28.1\nG0 X9\nG28 X5", {"X": 3.0, "Y": 4.0}),
    ("G0 X3 Y4\nG30.1\nG0 X9\nG0 Y[#5181+#5182]", {"X": 9.0, "Y": 7.0}),
    ("#5161=6 #5163=2\nG0 X1\nG28", {"X": 6.0, "Z": 2.0}),
    ("G0 X6\nG92 X2\nG92.2\nG0 Y[#5210] Z[#5211]\nG92.3\nG0 X1 Y[#5210+8]", {"X": 5.0, "Y": 9.0, "Z": 4.0}),
    ("G92.1\n#5211=5\nG92.3\nG0 X2", {"X": 7.0}),
    ("G10 L2 P2 X7 R90\nG55 G0 X3 Y1\nG0 Z[#5250 / 10]", {"X": 6.0, "Y": 3.0, "Z": 9.0}),
    ("G59.2\nG0 X[#5220] Y[#<_coord_system>]", {"X": 8.0, "Y": 592.0}),
    ("G43.1 X3 Z5\nG0 X1 Z1 Y[#<_tool_offset>+6]", {"X": 4.0, "Z": 6.0, "Y": 7.0}),
    ("G7\nG0 X9 Z[#<_lathe_diameter_mode> + 1]\nG1 F99 Y#<_x>", {"X": 4.5, "Y": 4.5, "Z": 2.0}),
    ("M7 M8\nG0 X[#<_mist>+2*#<_flood>]\nM9\nG0 Y[#<_mist>+2*#<_flood>+5]", {"X": 3.0, "Y": 5.0}),
    ("G0 @5 ^90\nG1 F100 ^0", {"X": 5.0, "Y": 0.0}),
]


def run(tmp_path: Path, program: str, machine: str = "mill3") -> polycnc.Result:
    path = tmp_path / "part.ngc"
    path.write_text(f"G21\n{program}\nM2\n", encoding="ascii")
    return polycnc.run(path, machine)


@pytest.mark.parametrize(("program", "end"), ENDS)
def test_where_it_goes(program: str, end: dict[str, float], tmp_path: Path) -> None:
    found = run(tmp_path, program).end_position_mm
    assert {name: found[name] for name in end} == pytest.approx(end, abs=1e-9)


REFUSALS = [
    ("G10 L20 P1 X3 R5", "work offset that turns"),
    ("G10 L3 P1 X3", "L3 is not there"),
    ("G10 P1 X3", "without L and P"),
    ("G10 L1 P3 X3", "tool 3 is not in the tool table"),
    ("G43.2 X3", "without H"),
    ("G0 G43.1 X3", "both use the axis words"),
    ("G41.1 X3", "without D"),
    ("G42.1 D3 L2", "in another plane than G18"),
    ("G92.3\n#5211=5", "while its shift is in force"),
    ("G91 G81 @5 ^90 Z-1 R2 L3 F100", "the tool stands at zero"),
    ("G55\nG10 L2 P2 R30\nG18 G2 X3 Z1 R5 F100", "an arc outside the plane that the work offset turns"),
]


@pytest.mark.parametrize(("program", "what"), REFUSALS)
def test_what_is_refused(program: str, what: str, tmp_path: Path) -> None:
    with pytest.raises(polycnc.ProgramError, match=what):
        run(tmp_path, program)
