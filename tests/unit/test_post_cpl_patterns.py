"""Drilling patterns posted as CPL loops, and that the verification sees what the loops do."""

from __future__ import annotations

from pathlib import Path

import pytest

import polycnc.post
from polycnc.runner import post_file

CONTROL = Path(polycnc.post.__file__).parent / "control" / "bosch-pnc-cpl.toml"
PART = """\
PARTNO PATTERN
UNITS/MM
LOAD/TOOL,3,ADJUST,3
SPINDL/RPM,2200,CLW
RAPID
GOTO/12.5000,7.0000,50.0000
CYCLE/DRILL,DEPTH,9.5,MMPM,350,CLEAR,2
GOTO/12.5000,7.0000,0.0000
GOTO/31.0000,7.0000,0.0000
GOTO/31.0000,28.2500,-3.0000
CYCLE/OFF
CYCLE/DEEP,DEPTH,14,STEP,4,MMPM,250,CLEAR,10,RAPTO,8
GOTO/31.0000,28.2500,-3.0000
GOTO/12.5000,28.2500,-3.0000
CYCLE/OFF
RAPID
GOTO/12.5000,28.2500,50.0000
SPINDL/OFF
END-OF-PATH
FINI
"""


@pytest.fixture
def part(tmp_path: Path) -> Path:
    path = tmp_path / "pattern.cl"
    path.write_text(PART, encoding="utf-8")
    return path


def test_a_pattern_is_one_block_in_a_loop_and_drills_as_meant(part: Path, tmp_path: Path) -> None:
    output = tmp_path / "pattern.npg"
    proof = post_file(part, "bosch-pnc-cpl", output, verify=True).verification
    assert proof is not None
    assert proof.ok, proof.as_dict()
    text = output.read_text(encoding="ascii")
    assert text.count("G81 X[") == text.count("G83 X[") == 1
    assert text.count("FOR HOLE%=1 TO HOLES%") == 2
    assert text.count("G81") == text.count("G83") == 1  # no hole is drilled but in its loop


@pytest.mark.parametrize(
    ("right", "wrong", "off_mm"),
    [
        ("<HOLEX=X>", "<HOLEX=X+0.25>", 0.25),  # drilled beside
        ("FOR HOLE%=1 TO HOLES%", "FOR HOLE%=1 TO HOLES%-1", 9.5),  # the last one left out
        ("FOR HOLE%=1 TO HOLES%", "FOR HOLE%=2 TO HOLES%", 9.5),  # the first one left out
    ],
)
def test_the_verification_finds_a_wrong_loop(
    part: Path, tmp_path: Path, right: str, wrong: str, off_mm: float
) -> None:
    control = tmp_path / "wrong.toml"
    text = CONTROL.read_text(encoding="utf-8")
    assert right in text
    control.write_text(text.replace(right, wrong), encoding="utf-8")
    proof = post_file(part, control, tmp_path / "wrong.npg", verify=True).verification
    assert proof is not None
    assert not proof.ok
    assert proof.deviation_mm >= off_mm - 1e-3
