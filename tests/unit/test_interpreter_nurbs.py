"""Curves by weighted control points (G5.2, G5.3 of LinuxCNC): where they go, what they need, what ends them."""

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
from polycnc.nc import Group
from polycnc.nc.blocks._nurbs_curve import nurbs_cubics
from support.curves import prepared, track
from support.programs import LINEAR, machine_config, prepare, refusal
from support.runs import program_run

Floats = npt.NDArray[np.float64]
Points = list[tuple[float, float, float]]  # X, Y, weight

HALF = math.sqrt(0.5)
ARC: Points = [(10.0, 0.0, 1.0), (10.0, 10.0, HALF), (0.0, 10.0, 1.0)]
WAVE: Points = [(3.0, -2.0, 1.5), (9.0, 14.0, 0.4), (21.0, 3.0, 2.25), (30.0, 17.0, 1.0), (37.5, -4.0, 3.0)]


def program(points: Points, order: int, before: str = "F700") -> str:
    """Return blocks that go to the first point and then along the curve."""
    (x, y, weight), *others = points
    more = "".join(f"X{x!r} Y{y!r} P{weight!r}\n" for x, y, weight in others)
    return f"{before} G0 X{x!r} Y{y!r}\nG5.2 P{weight!r} L{order}\n{more}G5.3\n"


def curve_of(points: Points, order: int) -> Any:
    """Return the curve as scipy evaluates it: a spline in homogeneous coordinates over even, clamped knots."""
    spans = len(points) - order + 1
    knots = [0] * (order - 1) + list(range(spans + 1)) + [spans] * (order - 1)
    homogeneous = np.array([(x * w, y * w, w) for x, y, w in points])
    spline = scipy.interpolate.BSpline(knots, homogeneous, order - 1)

    def at(u: Any) -> Floats:
        value = spline(np.clip(u, 0.0, spans))
        return np.asarray(value[..., :2] / value[..., 2:])

    return at, float(spans)


def off(points: Floats, control: Points, order: int) -> float:
    """Return how far the furthest of some points is from a curve."""
    at, end = curve_of(control, order)
    u = np.linspace(0.0, end, 2001)
    dense = at(u)
    worst = 0.0
    for point in points:
        near = int(np.clip(np.argmin(np.sum((dense - point) ** 2, axis=1)), 1, len(u) - 2))
        found = scipy.optimize.minimize_scalar(
            lambda v, point=point: float(np.sum((at(v) - point) ** 2)),
            bounds=(u[near - 1], u[near + 1]),
            method="bounded",
        )
        away, along = at(found.x) - point, at(found.x + 1e-5) - at(found.x - 1e-5)
        worst = max(worst, abs(float(away[0] * along[1] - away[1] * along[0])) / float(np.hypot(*along)))
    return worst


def test_weights_make_a_quarter_of_a_circle() -> None:
    channel = prepared(program(ARC, 3))
    points = track(channel, 3)
    assert np.abs(np.hypot(points[:, 0], points[:, 1]) - 10.0).max() < 1e-5
    seg, tail = channel.machine.state.seg, int(channel.machine.state.paths.row[0]["tail"])
    assert seg.end[tail - 1].tolist() == [0.0, 10.0, 0.0]
    assert channel.state.modal.position.tolist() == [0.0, 10.0, 0.0]
    length = seg.row["length"][seg.row["kind"] == SPLINE].sum()
    assert length == pytest.approx(5.0 * math.pi, rel=1e-7)


@pytest.mark.parametrize("order", [3, 4, 5])
def test_curves_of_any_order_are_those_of_scipy(order: int) -> None:
    points = track(prepared(program(WAVE, order)), 3)
    assert off(points[::7], WAVE, order) < 1e-5
    assert points[-1] == pytest.approx([37.5, -4.0], abs=1e-12)


@pytest.mark.parametrize(("order", "pieces"), [(3, 3), (4, 2)])
def test_parabolas_and_cubics_without_weights_are_exact(order: int, pieces: int) -> None:
    """The five points make three parabolas, or two cubics, and each is one cubic."""
    even = [(x, y, 2.5) for x, y, _ in WAVE]
    channel = prepared(program(even, order))
    assert off(track(channel, 3)[::3], even, order) < 2e-8
    straight = [(3.0, 4.0, 1.0), (5.0, 8.0, 1.0), (9.0, 16.0, 1.0)]
    row = prepared(program(straight, 3)).machine.state.seg.row
    assert row["length"].sum() == pytest.approx(5.0 + math.hypot(6.0, 12.0), rel=1e-12)
    assert len(list(nurbs_cubics(even, order))) == pieces


def test_the_order_is_three_and_the_first_weight_one_without_words() -> None:
    text = "F700 G0 X10 Y0\nG5.2 X10 Y10 P.70710678118654757\nX0 Y10 P1\nG5.3\n"
    assert track(prepared(text)).tolist() == track(prepared(program(ARC, 3))).tolist()


def test_the_word_may_stand_with_every_point_and_other_blocks_between() -> None:
    (_, _, first), *others = WAVE
    more = "\nM8\n(remark)\nG4 P.1\n".join(f"G5.2 X{x!r} Y{y!r} P{w!r}" for x, y, w in others)
    text = f"F700 G0 X3 Y-2\nG5.2 P{first!r} L4\n{more}\nG5.3\n"
    assert track(prepared(text)).tolist() == track(prepared(program(WAVE, 4))).tolist()


def test_ways_count_from_the_start_of_the_curve_and_inches_are_inches() -> None:
    (x, y, _), *_ = WAVE
    ways = [(a - x, b - y, w) for a, b, w in WAVE]
    more = "".join(f"X{a!r} Y{b!r} P{w!r}\n" for a, b, w in ways[1:])
    text = f"F700 G0 X{x!r} Y{y!r}\nG91 G5.2 P1.5 L3\n{more}G5.3\n"
    assert np.allclose(track(prepared(text)), track(prepared(program(WAVE, 3))), rtol=0.0, atol=1e-12)
    small = [(a / 25.4, b / 25.4, w) for a, b, w in WAVE]
    inches = track(prepared(program(small, 3, "G20 F20")))
    assert np.allclose(inches, track(prepared(program(WAVE, 3))), rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("blocks", "what"),
    [
        ("G5.2 X1 P1", "6: a control point with X and without Y"),
        ("G5.2 Y1 P1", "6: a control point with Y and without X"),
        ("G5.2 X1 Y2", "6: a control point without a weight"),
        ("G5.2 X1 Y2 P0", "12: a weight of 0"),
        ("G5.2 X1 Y2 P-.5", "12: a weight of -0.5"),
        ("G5.2 X1 Y2 P1 L2", "15: a curve of order 2"),
        ("G5.2 X1 Y2 P1 L3.5", "15: a curve of order 3.5"),
        ("G5.2 X1 Y2 P1 L17", "15: a curve of order 17"),
        ("G5.2 X1 Y2 Z3 P1", "12: a spline moves X and Y only, not Z"),
        ("G5.2 X1 Y2 P1 I4", "15: 'I' has no meaning in this block"),
        ("G18 G5.2 X1 Y2 P1", "5: a spline outside the plane XY"),
        ("G93 G5.2 X1 Y2 P1", "5: a feed move with inverse time (G93) needs its own F"),
        ("G5.2 X1 Y400 P1", "9: axis Y would go to 400.000 mm, past its soft limit of 300.000 mm"),
        ("G53 G5.2 X1 Y2 P1", "5: G53 and G5.2 exclude each other: both use the axis words"),
        ("G5.3", "1: G5.3 without a curve that it ends"),
        ("G5.2 X1 Y2 P1\nG5.3", "1: a curve of order 3 with 2 control points"),
        ("G5.2 X1 Y2 P1 L5\nX2 Y5 P1\nX7 Y9 P1\nG5.3", "1: a curve of order 5 with 4 control points"),
        ("G5.2 X1 Y2 P1\nG5.2 P2", "6: a weight without a control point"),
        ("G5.2 X1 Y2 P1\nP2", "1: 'P' has no meaning in this block"),
        ("G5.2 X1 Y2 P1\nX3 Y2 P1 L4", "10: 'L' has no meaning in this block"),
        ("G5.2 X1 Y2 P1\nX9 Y2 P1\nG5.3 X4", "6: 'X' cannot be combined with this function"),
        ("G5.2 X1 Y2 P1\nG1 X3", "1: G1 in a curve (G5.2) that is not ended"),
        ("G5.2 X1 Y2 P1\nX4 Y3 P1 G91", "10: G91 in a curve (G5.2) that is not ended"),
        ("G5.2 X1 Y2 P1\nG92 X0", "1: G92 in a curve (G5.2) that is not ended"),
        ("G5.2 X1 Y2 P1\nG4 P1 X2", "7: a control point with X and without Y"),
    ],
)
def test_refusals_stand_at_their_word(blocks: str, what: str) -> None:
    text = refusal(f"G1 F500 X0\n{blocks}\n", dialect="linuxcnc")
    assert text == f"{1 + len(blocks.splitlines())}:{what}"


def test_a_refused_block_leaves_the_curve_as_it_was() -> None:
    blocks = program(WAVE, 3).splitlines()
    blocks.insert(3, "X4 Y5 P-1")
    channel = prepare("\n".join(blocks) + "\n", dialect="linuxcnc", collect_errors=True)
    assert len(channel.errors) == 1
    assert track(channel).tolist() == track(prepared(program(WAVE, 3))).tolist()


@pytest.mark.parametrize("end", ["M2\n", "M30\n", ""])
def test_a_program_that_ends_in_a_curve_is_refused_where_the_curve_begins(end: str) -> None:
    text = refusal(f"G1 F500 X4\n\nG5.2 X1 Y2 P1\nX3 Y4 P1\n{end}", dialect="linuxcnc")
    assert text == "3:1: the program ends in a curve (G5.2)"


def test_radius_compensation_is_refused() -> None:
    config = machine_config(LINEAR, "[tools.1]\nradius_mm = 3\n")
    text = refusal("G41 D1 G1 X5 F500\nY5\nG5.2 X9 Y9 P1\n", config=config, dialect="linuxcnc")
    assert text.endswith("a spline with radius compensation")


def test_behind_a_curve_no_motion_is_in_force_and_no_series_goes_on() -> None:
    curve = program(WAVE, 3)
    for behind, what in (
        ("X5", "1: axis words without a motion"),
        ("G5 X50 P1 Q2", "1: the first of a series of splines (G5) needs I and J"),
    ):
        text = refusal(f"G1 F500 Z1\nG5 X1 I1 J1 P1 Q1\n{curve}{behind}\n", dialect="linuxcnc")
        assert text == f"{3 + len(curve.splitlines())}:{what}"


def test_inverse_time_is_the_time_of_the_whole_curve() -> None:
    channel = prepared(
        program(WAVE, 4, "F700").replace("G5.2 P", "G93 F9 G5.2 P").replace("G5.3", "G5.3 F.5")
    )
    row = channel.machine.state.seg.row
    row = row[row["kind"] == SPLINE]
    assert float(np.sum(row["length"] / row["feed_mm_s"])) == pytest.approx(120.0, rel=1e-12)


def test_a_run_goes_along_it_with_its_feed_and_shows_its_blocks(tmp_path: Path) -> None:
    path = tmp_path / "curve.ngc"
    from_zero = [(x - 3.0, y + 2.0, w) for x, y, w in WAVE]
    path.write_text(program(from_zero, 4, "F600"), encoding="utf-8")
    result = polycnc.run(path, "mill3", dialect="linuxcnc", trace=True)
    assert result.trace is not None
    points = result.trace.setpoint[:, :2]
    assert points[-1].tolist() == [34.5, -2.0]
    assert off(points[::97], from_zero, 4) < 1e-5
    assert result.trace.execution is not None
    assert {block.kind for block in result.trace.execution.blocks} == {"spline"}
    speed = np.linalg.norm(np.diff(points, axis=0), axis=1) / 0.001
    assert np.allclose(speed[50:-50], 10.0, rtol=1e-4)


def test_the_executed_block_shows_the_curve() -> None:
    run = program_run("G1 F900 X1\nG5.2 X1 Y9 P1\nX9 Y9 P1\nG5.3\nG1 X25\nM30\n", dialect="linuxcnc")
    run.start()
    seen = {}
    while run.active:
        run.advance(1)
        if run.reading.block is not None and run.reading.modal is not None:
            seen[run.reading.block.line] = run.reading.modal.g.get(Group.MOTION)
    assert {line: g for line, g in seen.items() if line in (1, 4, 5)} == {1: "G1", 4: "G5.2", 5: "G1"}


def test_a_snapshot_within_a_curve_goes_on_alike() -> None:
    text = "G1 F900 X4\nG5.2 X1 Y9 P2.5 L4\nX9 Y7 P.5\nG4 P1\nX15 Y2 P1.5\nG5.3\nM30\n"
    run = program_run(text, dialect="linuxcnc", blocks_ahead=1)
    run.start()
    run.advance(700)
    assert run.machine.setpoints == {"X": 4.0, "Y": 0.0, "Z": 0.0}
    saved, machine = run.snapshot(), run.machine.snapshot()
    run.advance(1200)
    later = run.machine.setpoints
    run.restore(saved)
    run.machine.restore(machine)
    run.advance(1200)
    assert run.machine.setpoints == later
    assert later["Y"] > 1.0
