"""Programs from the wild: each runs as it should, goes where it should, and keeps the machine's limits."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

import polycnc as library
from support.command import polycnc

INCH = 25.4
QUARTER = 20.0 + 10.0 * math.pi  # a line of 20 mm and a quarter circle of radius 20 mm

# Extents, end and cutting length, worked out from the programs' texts.
PROGRAMS: dict[str, dict[str, Any]] = {
    "arc-ijk": {"X": (0, 20), "Y": (0, 20), "Z": (0, 0), "end": (20, 0, 0), "cut": QUARTER},
    # G18 turns Z to X, so clockwise from Z to X is the long way round.
    "arc-xz-plane": {
        "X": (-20, 20),
        "Y": (0, 0),
        "Z": (-20, 20),
        "end": (20, 0, 0),
        "cut": 20.0 + 30.0 * math.pi,
    },
    "arc-yz-plane": {"X": (0, 0), "Y": (0, 20), "Z": (0, 20), "end": (0, 20, 0), "cut": QUARTER},
    "circle": {"X": (-5, 5), "Y": (-5, 5), "Z": (0, 5), "end": (0, 0, 5), "cut": 10.0 * math.pi + 1.0},
    "circle-inch": {
        "X": (-0.5 * INCH, 0.5 * INCH),
        "Y": (-0.5 * INCH, 0.5 * INCH),
        "Z": (0, 0.25 * INCH),
        "end": (0, 0, 0.25 * INCH),
        "cut": (math.pi + 0.2) * INCH,
    },
    # Incremental moves in inch: the end is their sum.
    "helical-thread-milling": {
        "Z": (-0.6533 * INCH, 0),
        "end": (0.0244 * INCH, 0.0974 * INCH, (10 * 0.0179 - 0.6533) * INCH),
    },
    "jsdc": {"X": (0, 102.3526), "Y": (-58.1149, 0), "Z": (-1, 1), "end": (0, 0, 1)},
}


def _run(program: Path, folder: Path, status: int = 0) -> dict[str, Any]:
    """Run a program with the command, hold its trace against the machine, and return its report."""
    arguments = ("run", program, "--json", "--trace", folder / "trace.npz")
    report: dict[str, Any] = json.loads(polycnc(*arguments, status=status).stdout)
    trace = library.read_trace(folder / "trace.npz")
    assert library.verify_trace(trace, library.load_machine("mill3")) == []
    assert len(trace) == report["cycles"]
    assert trace.t_s[-1] == report["time_s"]
    assert trace.setpoint[-1].tolist() == list(report["end_position_mm"].values())
    assert trace.setpoint.min() >= min(low for low, _ in report["extents_mm"].values())
    assert trace.setpoint.max() <= max(high for _, high in report["extents_mm"].values())
    assert math.isfinite(report["time_s"])
    return report


@pytest.mark.parametrize("name", PROGRAMS)
def test_program(name: str, data_nc: Path, tmp_path: Path) -> None:
    report = _run(data_nc / f"{name}.gcode", tmp_path)
    assert report["alarms"] == []
    expected = dict(PROGRAMS[name])
    end = tuple(report["end_position_mm"].values())
    assert end == pytest.approx(expected.pop("end"), abs=1e-9)
    if "cut" in expected:
        assert report["cutting_path_mm"] == pytest.approx(expected.pop("cut"), rel=1e-9)
    for axis, extent in expected.items():
        assert report["extents_mm"][axis] == pytest.approx(extent, abs=1e-9), axis


def test_program_with_a_word_left_out(data_nc: Path, tmp_path: Path) -> None:
    # Its author left out a G1 behind a full circle, so N55 is an arc without a centre.
    report = _run(data_nc / "full-circle-without-xyz.gcode", tmp_path, status=1)
    (alarm,) = report["alarms"]
    assert (alarm["line"], alarm["text"]) == (11, "an arc needs a centre or a radius")
    # Two full circles of radius 1.1 with the ways in and out between them, and nothing after the second.
    ways = 0.5 + 0.25 + 0.25 + 0.7 + 0.7 + 0.25
    assert report["cutting_path_mm"] == pytest.approx(ways + 2.0 * 2.0 * math.pi * 1.1, rel=1e-9)


def test_pocket_prefix(data_nc: Path, tmp_path: Path) -> None:
    lines = (data_nc / "tball-pocket.gcode").read_text().splitlines(keepends=True)
    prefix = tmp_path / "prefix.gcode"
    prefix.write_text("".join(lines[:2500]))
    report = _run(prefix, tmp_path)
    assert report["alarms"] == []
    assert report["blocks"] == 2500 - sum(not line.strip() for line in lines[:2500])


def test_pocket_is_timed_in_closed_form(data_nc: Path) -> None:
    report = json.loads(polycnc("run", data_nc / "tball-pocket.gcode", "--json").stdout)
    assert report["alarms"] == []
    assert report["extents_mm"] == {
        "X": pytest.approx([0.0, 135.8667]),
        "Y": pytest.approx([-135.8681, 0.0]),
        "Z": [-3.175, 5.0],
    }
    # Lengths over feeds, summed up from the text; corners can only add to that.
    assert 5175.83 < report["cutting_time_s"] < 1.001 * 5175.83
    assert report["cutting_path_mm"] == pytest.approx(8924.971, abs=1e-3)


@pytest.mark.long
def test_whole_pocket_cycle_by_cycle(data_nc: Path, tmp_path: Path) -> None:
    report = _run(data_nc / "tball-pocket.gcode", tmp_path)
    closed = json.loads(polycnc("run", data_nc / "tball-pocket.gcode", "--json").stdout)
    assert report == closed
