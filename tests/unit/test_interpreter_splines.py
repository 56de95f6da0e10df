"""Splines in programs (G5, G5.1 of LinuxCNC): where they go, what they need, and all that reads a run of them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import scipy

import polycnc
from polycnc.kernel._segments import SPLINE
from polycnc.nc import Dialect, Group, load_dialect
from support.curves import prepared, track
from support.programs import LINEAR, MILL, listing, machine_config, moves, prepare, refusal
from support.runs import program_run, to_the_end

Floats = npt.NDArray[np.float64]

SERIES = "G5 X11 Y1.5 I2.5 J6.25 P-3.5 Q-7.25\nG5 X23 P-3 Q-6\n"
CONTROL = [
    [(0.0, 0.0), (2.5, 6.25), (7.5, -5.75), (11.0, 1.5)],
    [(11.0, 1.5), (14.5, 8.75), (20.0, -4.5), (23.0, 1.5)],
]


def refused(program: str) -> str:
    return refusal(program, dialect="linuxcnc")


def off(points: Floats, *controls: list[tuple[float, float]]) -> float:
    """Return how far the furthest of some points is from Bezier curves, as scipy evaluates them."""
    curves = [scipy.interpolate.BPoly(np.array(control)[:, None, :], [0.0, 1.0]) for control in controls]
    u = np.linspace(0.0, 1.0, 20001)
    worst = 0.0
    for point in points:
        found = []
        for curve in curves:
            dense = curve(u)
            nearest = int(np.argmin(np.sum((dense - point) ** 2, axis=1)))
            away = point - dense[nearest]
            along = curve.derivative()(u[nearest])
            found.append(float(np.linalg.norm(away - along * np.dot(away, along) / np.dot(along, along))))
        worst = max(worst, min(found))
    return worst


def length_of(control: list[tuple[float, float]]) -> float:
    dense = scipy.interpolate.BPoly(np.array(control)[:, None, :], [0.0, 1.0])(np.linspace(0.0, 1.0, 100_001))
    return float(np.linalg.norm(np.diff(dense, axis=0), axis=1).sum())


def test_cubics_go_along_their_curves_and_end_exactly() -> None:
    channel = prepared("F700\n" + SERIES)
    seg, tail = channel.machine.state.seg, int(channel.machine.state.paths.row[0]["tail"])
    assert set(seg.row["kind"][:tail].tolist()) == {SPLINE}
    assert off(track(channel), *CONTROL) < 1e-7
    assert seg.end[tail - 1].tolist() == [23.0, 1.5, 0.0]
    assert channel.state.modal.position.tolist() == [23.0, 1.5, 0.0]
    lengths = seg.row["length"][:tail].sum()
    assert lengths == pytest.approx(sum(length_of(control) for control in CONTROL), rel=1e-8)


def test_a_quadratic_is_the_parabola_of_its_three_points() -> None:
    channel = prepared("F700 G0 X-20 Y40\nG5.1 X22 Y37 I20.5 J-80\n")
    points = track(channel)
    quadratic = [(-20.0, 40.0), (0.5, -40.0), (22.0, 37.0)]
    assert off(points, quadratic) < 1e-7
    assert points[-1].tolist() == [22.0, 37.0]


@pytest.mark.parametrize(
    ("modes", "scale", "origin"), [("G20", 25.4, 0.0), ("G91", 1.0, 0.0), ("G92 X5 Y-3\nG91 G20", 25.4, 0.0)]
)
def test_control_points_are_ways_in_the_programs_units(modes: str, scale: float, origin: float) -> None:
    channel = prepared(f"F20 {modes}\nG5 X1.1 Y.15 I.25 J.625 P-.35 Q-.725\n")
    control = [(scale * 0.1 * x + origin, scale * 0.1 * y) for x, y in CONTROL[0]]
    assert off(track(channel), control) < 1e-7


def test_absolute_centres_leave_the_ways_to_control_points_ways() -> None:
    assert moves("F700 G0 X3\nG90.1\n" + SERIES, dialect="linuxcnc") == moves(
        "F700 G0 X3\n" + SERIES, dialect="linuxcnc"
    )


def test_a_spline_counts_for_its_own_block_only() -> None:
    items = listing(prepared("F700 G1 X-4\n" + SERIES + "X30\nG0 Y9\n" + "G5.1 X20 I2 J3\nX5\n"))
    assert items[-1].startswith("rapid X5")
    assert [item for item in items if item.startswith("line")] == [
        "line X-4 F700",
        "line X30 F700 stop",
    ]


def test_a_series_goes_on_over_blocks_that_do_not_move() -> None:
    broken = SERIES.replace("\n", "\nM8\n(remark)\nF700\n", 1)
    assert off(track(prepared("F700\n" + broken)), *CONTROL) < 1e-7


@pytest.mark.parametrize(
    "between", ["X11.1", "G1 X11.5\nX11", "G5.1 X12 I1 J1", "G2 X12 Y1.5 R4", "G0 X11 Y1.5 Z-1"]
)
@pytest.mark.parametrize("ordinary_blocks", [0, math.inf])
def test_any_other_move_ends_a_series(between: str, ordinary_blocks: float) -> None:
    first, second = SERIES.splitlines()
    program = f"G1 F700\n{first}\n{between}\n{second}\n"
    channel = prepare(program, dialect="linuxcnc", ordinary_blocks=ordinary_blocks)
    assert channel.error is not None
    assert "first of a series" in str(channel.error)


@pytest.mark.parametrize(
    ("block", "what"),
    [
        ("G5 X10 P-2 Q-6", "1: the first of a series of splines (G5) needs I and J"),
        ("G5 X10 I2 P-2 Q-6", "8: a control point with I and without J"),
        ("G5 X10 J2 P-2 Q-6", "8: a control point with J and without I"),
        ("G5 X10 I2 J1 P-2", "14: a control point with P and without Q"),
        ("G5 X10 I2 J1 Q-2", "14: a control point with Q and without P"),
        ("G5 X10 I2 J1", "1: a spline (G5) needs P and Q"),
        ("G5 I2 J1 P2 Q3", "1: a spline without an end point"),
        ("G5 X10 I2 J1 P2 Q3 Z1", "20: a spline moves X and Y only, not Z"),
        ("G5 X10 I2 J1 P2 Q3 K1", "20: 'K' has no meaning in this block"),
        ("G18 G5 X10 I2 J1 P2 Q3", "5: a spline outside the plane XY"),
        ("G5.1 X10", "1: a quadratic spline (G5.1) needs I and J"),
        ("G5.1 X10 I2", "10: a control point with I and without J"),
        ("G5.1 X10 I2 J3 Z1", "16: a spline moves X and Y only, not Z"),
        ("G5.1 X10 I2 J3 P2 Q2", "16: 'P' has no meaning in this block"),
        ("G5.1 I3 J3", "1: a spline without an end point"),
        ("G93 G5.1 X10 I2 J3", "5: a feed move with inverse time (G93) needs its own F"),
        ("G1 G5 X1 I1 J1 P1 Q1", "4: G1 and G5 exclude each other (group 'motion')"),
        ("G53 G5.1 X10 I2 J3", "5: G53 and G5.1 exclude each other: both use the axis words"),
        ("G28 G5.1 X10 I2 J3", "5: G28 and G5.1 exclude each other: both use the axis words"),
        ("G5.1 X10 I2 J900", "1: axis Y would pass 450.000 mm, past its soft limit of 300.000 mm"),
        ("G5.1 X310 I2 J9", "6: axis X would go to 310.000 mm, past its soft limit of 300.000 mm"),
    ],
)
def test_refusals_stand_at_their_word_and_change_nothing(block: str, what: str) -> None:
    assert refused(f"G1 F500 X0\n{block}\n") == f"2:{what}"
    channel = prepare(f"G1 F500 X7\n{block}\nG5.1 X3 I4 J5\n", dialect="linuxcnc", collect_errors=True)
    assert len(channel.errors) == 1
    assert off(track(channel), [(7.0, 0.0), (11.0, 5.0), (3.0, 0.0)]) < 1e-7


@pytest.mark.parametrize("spline", ["G5 X20 I1 J1 P1 Q1", "G5.1 X20 I1 J1"])
def test_radius_compensation_is_refused(spline: str) -> None:
    config = machine_config(LINEAR, "[tools.1]\nradius_mm = 3\n")
    for program, line in ((f"G41 D1 G1 X5 F500\nY5\n{spline}\n", 3), (f"F500 G41 D1 {spline}\n", 1)):
        text = refusal(program, config=config, dialect="linuxcnc")
        assert text.startswith(f"{line}:")
        assert text.endswith("a spline with radius compensation")


@pytest.mark.parametrize("dialect", ["grbl", "din", "haas", "bosch"])
def test_dialects_without_splines_refuse_them(dialect: str) -> None:
    assert prepare("G1 F100 X1\nG5 X5 Y5 I1 J1 P1 Q1\n", dialect=dialect).error is not None


def test_a_frame_turns_the_control_points_too() -> None:
    linuxcnc = load_dialect("linuxcnc")
    fields = {name: getattr(linuxcnc, name) for name in Dialect.model_fields}
    dialect = Dialect.model_validate({**fields, "g": {**linuxcnc.g, "68": "rotation"}})
    turned = prepared("F700 G68 X0 Y0 R90\n" + SERIES, dialect=dialect)
    assert off(track(turned), *([(-y, x) for x, y in control] for control in CONTROL)) < 1e-7


def test_inverse_time_is_the_time_of_the_whole_curve() -> None:
    channel = prepared("G93 G5 X110 Y15 I25 J62.5 P-35 Q-72.5 F.5\n")
    seg, tail = channel.machine.state.seg, int(channel.machine.state.paths.row[0]["tail"])
    assert tail > 1
    time_s = float(np.sum(seg.row["length"][:tail] / seg.row["feed_mm_s"][:tail]))
    assert time_s == pytest.approx(120.0, rel=1e-12)
    assert np.ptp(seg.row["feed_mm_s"][:tail]) < 1e-9


def run_of(tmp_path: Path, program: str, **options: Any) -> Any:
    path = tmp_path / "curves.ngc"
    path.write_text(program, encoding="utf-8")
    return polycnc.run(path, "mill3", dialect="linuxcnc", **options)


def test_a_run_traces_the_curve_measures_it_and_keeps_its_feed(tmp_path: Path) -> None:
    result = run_of(tmp_path, "G1 F600\n" + SERIES, trace=True)
    points = result.trace.setpoint[:, :2]
    assert off(points[::29], *CONTROL) < 1e-7
    assert points[-1].tolist() == [23.0, 1.5]
    assert result.cutting_path_mm == pytest.approx(sum(length_of(control) for control in CONTROL), rel=1e-8)
    dense = np.vstack(
        [
            scipy.interpolate.BPoly(np.array(c)[:, None, :], [0.0, 1.0])(np.linspace(0, 1, 10001))
            for c in CONTROL
        ]
    )
    low, high = result.extents_mm["Y"]
    assert (low, high) == pytest.approx((dense[:, 1].min(), dense[:, 1].max()), abs=1e-4)
    assert {block.kind for block in result.trace.execution.blocks} == {"spline"}
    speed = np.linalg.norm(np.diff(points, axis=0), axis=1) / 0.001
    assert np.allclose(speed[50:-50], 10.0, rtol=1e-4)  # chords of cycles are hardly shorter than the curve


def test_stopping_at_every_block_takes_no_less_time(tmp_path: Path) -> None:
    program = "F3000\n" + SERIES + "G5.1 X5 Y20 I-30 J4\nG1 X0\n"
    times = [run_of(tmp_path, f"{mode} {program}").time_s for mode in ("G64", "G61", "G61.1")]
    assert times == sorted(times)
    assert times[0] < times[2]


def test_the_executed_block_shows_its_spline_and_the_next_one_the_motion_before() -> None:
    run = program_run("G1 F900 X1\nG5 X9 I1 J4 P-1 Q4\nG5.1 X20 I2 J3\nX25\nM30\n", dialect="linuxcnc")
    run.start()
    seen = {}
    while run.active:
        run.advance(1)
        if run.reading.block is not None and run.reading.modal is not None:
            seen[run.reading.block.line] = run.reading.modal.g.get(Group.MOTION)
    assert seen == {1: "G1", 2: "G5", 3: "G5.1", 4: "G1", 5: "G1"}


def test_a_held_and_overridden_spline_ends_in_the_same_place() -> None:
    program = "G1 F6000\nG5 X110 Y15 I25 J62.5 P-35 Q-72.5\nG5.1 X30 Y8 I-3 J-40\nM30\n"
    undisturbed = program_run(program, dialect="linuxcnc")
    undisturbed.start()
    to_the_end(undisturbed)
    run = program_run(program, dialect="linuxcnc")
    run.start()
    for cycles, override in ((140, 0.4), (333, 1.7), (77, 0.9)):
        run.advance(cycles)
        run.hold()
        run.advance(200)
        run.overrides.feed = override
        run.resume()
    to_the_end(run)
    assert run.machine.setpoints == undisturbed.machine.setpoints
    assert run.machine.setpoints == {"X": 30.0, "Y": 8.0, "Z": 0.0}


def test_a_snapshot_within_a_series_goes_on_alike() -> None:
    program = "G1 F900\n" + SERIES + "G5 X40 P-2 Q9\nM30\n"
    run = program_run(program, dialect="linuxcnc", blocks_ahead=1)
    run.start()
    run.advance(500)
    saved, machine, there = run.snapshot(), run.machine.snapshot(), run.machine.setpoints
    run.advance(700)
    later = run.machine.setpoints
    run.restore(saved)
    run.machine.restore(machine)
    assert run.machine.setpoints == there != later
    run.advance(700)
    assert run.machine.setpoints == later


def test_checking_collects_the_errors_of_splines(tmp_path: Path) -> None:
    path = tmp_path / "bad.ngc"
    path.write_text("G1 F500\nG5 X10 I2 J1\nG5.1 X5\nM2\n", encoding="utf-8")
    errors = polycnc.check(path, "mill3", dialect="linuxcnc")
    assert [error.position.line for error in errors if error.position] == [2, 3]


def test_mill_is_as_large_as_the_refusals_say() -> None:
    assert MILL.axes[0].soft_limits == (-300.0, 300.0)
