"""Corners as LinuxCNC programs ask for them: G61 stops in corners alone, G64 rounds, freely or within P."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import polycnc
from polycnc.nc import Group
from support.runs import program_run

SQUARE = "G1 X40 F3000\nY40\nX0\nY0\n"  # 50 mm/s on mill3: 5000 mm/s2
ALONE_S = 40.0 / 50.0 + 50.0 / 5000.0


def time_of(tmp_path: Path, program: str, dialect: str = "linuxcnc", machine: str | Path = "mill3") -> float:
    path = tmp_path / "part.ngc"
    path.write_text(program, encoding="utf-8")
    return polycnc.run(path, machine, dialect=dialect).time_s


def test_g61_stops_in_corners(tmp_path: Path) -> None:
    assert time_of(tmp_path, "G61 " + SQUARE) == pytest.approx(4.0 * ALONE_S, abs=1e-9)
    assert time_of(tmp_path, "G61.1 " + SQUARE) == pytest.approx(4.0 * ALONE_S, abs=1e-9)


def test_g61_goes_on_where_the_direction_stays(tmp_path: Path) -> None:
    track = "G1 X40 F3000\nG3 X40 Y20 J10\nG1 X7\nX0\n"
    length = 80.0 + 10.0 * math.pi
    expected = length / 50.0 + 50.0 / 5000.0
    assert time_of(tmp_path, "G61 " + track) == pytest.approx(expected, abs=2e-3)
    assert time_of(tmp_path, "G61.1 " + track) > expected + 0.02


def test_g64_rounds_within_p_and_freely_without(tmp_path: Path) -> None:
    stop, within, free = (time_of(tmp_path, f"{code} {SQUARE}") for code in ("G61", "G64 P0.3", "G64"))
    assert free < within < stop
    # Freely, half of each side becomes an arc of 20 mm radius; F3000 is slow enough for it.
    # The first and the last side keep their outer halves.
    length = 2.0 * 20.0 + 3.0 * 0.5 * math.pi * 20.0
    assert free == pytest.approx(length / 50.0 + 50.0 / 5000.0, abs=2e-3)
    assert time_of(tmp_path, "G64 P0 " + SQUARE) == free
    assert time_of(tmp_path, SQUARE) == free  # as it starts


def test_p_of_a_program_in_inches_is_in_inches(tmp_path: Path) -> None:
    metric = time_of(tmp_path, "G64 P0.254\n" + SQUARE)
    assert time_of(tmp_path, "G20 G64 P0.01\nG21\n" + SQUARE) == metric


def test_a_tolerance_of_the_machine_bounds_g64_without_p(tmp_path: Path) -> None:
    text = polycnc.machine.preset_text("mill3") + "\n[path]\npath_tolerance_mm = 0.3\n"
    machine = tmp_path / "tight.toml"
    machine.write_text(text, encoding="utf-8")
    assert time_of(tmp_path, "G64 " + SQUARE, machine=machine) == time_of(tmp_path, "G64 P0.3 " + SQUARE)


def test_a_free_tolerance_of_the_machine_holds_in_any_dialect(tmp_path: Path) -> None:
    machine = tmp_path / "free.toml"
    machine.write_text(
        polycnc.machine.preset_text("mill3") + '\n[path]\npath_tolerance_mm = "free"\n', encoding="utf-8"
    )
    assert time_of(tmp_path, SQUARE, "din", machine) == time_of(tmp_path, SQUARE)


def test_g61_holds_until_g64_its_last_corner_as_well(tmp_path: Path) -> None:
    mixed = "G61 " + SQUARE + "G64 P0.3\n" + SQUARE
    both = time_of(tmp_path, "G61 " + SQUARE) + time_of(tmp_path, "G64 P0.3\n" + SQUARE)
    assert time_of(tmp_path, mixed) == pytest.approx(both, abs=1e-9)


def test_an_unknown_code_is_named_as_not_supported(tmp_path: Path) -> None:
    with pytest.raises(polycnc.ProgramError, match=r"G38\.2"):
        time_of(tmp_path, "G38.2 Z-5 F100\n")


def test_the_executed_block_tells_which_of_them_is_in_force(tmp_path: Path) -> None:
    seen = {}
    run = program_run("G61 G1 X4 F3000\nX9\nG64 P0.1 Y5\nG61.1 X1\nM30\n", dialect="linuxcnc")
    run.start()
    while run.active:
        run.advance(1)
        if run.reading.block is not None and run.reading.modal is not None:
            seen[run.reading.block.line] = run.reading.modal.g.get(Group.STOPPING)
    assert seen == {1: "G61", 2: "G61", 3: "G64", 4: "G61.1", 5: "G61.1"}
