"""Comparison of paths: against closed forms, against shapely, and what `polycnc compare` makes of programs."""

from __future__ import annotations

import base64
import gzip
import json
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import polycnc
from polycnc.errors import UsageError
from polycnc.nc import ProgramText, load_dialect
from polycnc.runner import Trace, TraceWriter
from polycnc.runner._blocks import execution_by_lines
from polycnc.runner.comparison import (
    BlockDifference,
    Boxes,
    first_difference,
    greatest_distance,
    in_one_order,
)
from polycnc.runner.comparison._path import PathCollector
from support.command import polycnc as command
from support.often import share

MILL = """name = "compared"
[[axis]]
name = "X"
vmax_mm_s = 250
amax_mm_s2 = 3000
[[axis]]
name = "Y"
vmax_mm_s = 250
amax_mm_s2 = 3000
[[axis]]
name = "Z"
vmax_mm_s = 250
amax_mm_s2 = 3000
"""
PART = """G0 X3 Y2 Z5
T4 M6
G1 Z-1.5 F300
G1 X43 F1700
G1 Y22
G1 X3
G1 Y2
G0 Z5
T7 M6
G0 X8 Y7
G1 Z-2.5 F400
G1 X33
G0 Z5
M30
"""


def _about(html: str) -> dict[str, Any]:
    packed = re.search(r'id="about">([^<]*)<', html)
    assert packed is not None
    about: dict[str, Any] = json.loads(gzip.decompress(base64.b64decode(packed[1])))
    return about


def _from(a: Sequence[tuple[float, ...]], b: Sequence[tuple[float, ...]]) -> tuple[float, int, float]:
    one, other = np.array(a, float), np.array(b, float)
    return greatest_distance(one[:-1], one[1:], Boxes(other[:-1], other[1:]))


def test_farthest_between_the_points_of_both() -> None:
    """From two posts at x = -7 and x = 5, a line along y = 0 is farthest where their middle crosses it."""
    line = np.array([[-7.0, 0.0], [6.0, 0.0]])
    posts = Boxes(np.array([[-7.0, -3.0], [5.0, -2.0]]), np.array([[-7.0, 4.0], [5.0, 9.0]]))
    distance, segment, part = greatest_distance(line[:1], line[1:], posts)
    assert distance == pytest.approx(6.0, abs=2e-6)
    assert segment == 0
    assert -7.0 + 13.0 * part == pytest.approx(-1.0, abs=3e-6)


def test_the_two_directions_are_two_numbers() -> None:
    """A spur of 4.25 that only one of them has is far from the other; the other is nowhere far from it."""
    plain = [(0.0, 0.0, 1.0), (9.0, 0.0, 1.0), (30.0, 0.0, 1.0)]
    with_spur = [*plain[:2], (9.0, 4.25, 1.0), *plain[1:]]
    assert _from(plain, with_spur)[0] == 0.0
    distance, *where = _from(with_spur, plain)
    assert distance == pytest.approx(4.25, abs=2e-6)
    assert where == [1, 1.0]


def test_parallel_lines_of_many_pieces_are_one_distance() -> None:
    x = np.linspace(0.0, 100.0, 3001)
    line = np.column_stack((x, np.full_like(x, 2.75)))
    found, _, _ = greatest_distance(
        np.array([[0.0, 0.0]]), np.array([[100.0, 0.0]]), Boxes(line[:-1], line[1:])
    )
    assert found == pytest.approx(2.75, abs=2e-6)


POINTS = st.lists(
    st.tuples(st.floats(-50, 50, width=32), st.floats(-50, 50, width=32)),
    min_size=2,
    max_size=40,
    unique=True,
)


@settings(max_examples=share(60), deadline=None)
@given(POINTS, POINTS)
def test_equals_the_distance_that_shapely_samples(
    a: list[tuple[float, float]], b: list[tuple[float, float]]
) -> None:
    """shapely knows how far a point is: at many points of the one, that is below ours by no more than their spacing."""
    shapely = pytest.importorskip("shapely")
    other = shapely.LineString(b)
    one = np.array(a, float)
    share = np.linspace(0.0, 1.0, 201)[:, None]
    sampled, spacing = 0.0, 0.0
    for start, end in pairwise(one):
        points = shapely.points(start + share * (end - start))
        sampled = max(sampled, float(shapely.distance(points, other).max()))
        spacing = max(spacing, float(np.hypot(*(end - start))) / 200.0)
    found, segment, part = _from(a, b)
    assert sampled - 2e-6 <= found <= sampled + 0.5 * spacing + 2e-6
    place = shapely.Point(one[segment] + part * (one[segment + 1] - one[segment]))
    assert shapely.distance(place, other) == pytest.approx(found, abs=1e-9)


STEPS = 12


def densified(line: list[tuple[float, float]]) -> list[tuple[float, float]]:
    shares = [step / STEPS for step in range(STEPS)]
    found = [(p[0] + (q[0] - p[0]) * t, p[1] + (q[1] - p[1]) * t) for p, q in pairwise(line) for t in shares]
    return [*found, line[-1]]


def walked_in_steps(one: list[tuple[float, float]], other: list[tuple[float, float]]) -> float:
    """Return the least leash of two walkers who go on from point to point, never back."""
    row: list[float] = []
    for i, p in enumerate(one):
        above, row = row, []
        for j, q in enumerate(other):
            ways = [*above[max(j - 1, 0) : j + 1], *row[-1:]] if i else row[-1:]
            row.append(max(math.dist(p, q), min(ways, default=0.0)))
    return row[-1]


@settings(max_examples=share(60), deadline=None)
@given(POINTS, POINTS)
def test_order_equals_the_frechet_distance_of_walks_in_steps(
    a: list[tuple[float, float]], b: list[tuple[float, float]]
) -> None:
    """Walking from point to point of densified lines is never nearer than walking freely, and hardly farther."""
    steps = walked_in_steps(densified(a), densified(b))
    longest = max(math.dist(p, q) / STEPS for line in (a, b) for p, q in pairwise(line))
    assert in_one_order(np.array(a), np.array(b), steps + 1e-9)[0]
    if steps > longest + 1e-6:
        assert not in_one_order(np.array(a), np.array(b), steps - longest - 1e-6)[0]


@pytest.fixture
def mill(tmp_path: Path) -> Path:
    path = tmp_path / "mill.toml"
    path.write_text(MILL)
    return path


def test_a_program_equals_itself_and_its_traces(mill: Path, tmp_path: Path) -> None:
    (tmp_path / "part.nc").write_text(PART)
    result = polycnc.run(tmp_path / "part.nc", mill, trace=True)
    assert result.trace is not None
    found = polycnc.compare(tmp_path / "part.nc", tmp_path / "part.nc", mill)
    assert found.ok
    assert (found.deviation_mm, found.same_order, found.tools) == (0.0, True, ((0, 4, 7), (0, 4, 7)))
    assert polycnc.compare(tmp_path / "part.nc", result, mill).deviation_mm == 0.0
    with TraceWriter(tmp_path / "part.csv", polycnc.load_machine(mill), actual=False) as writer:
        polycnc.run(tmp_path / "part.nc", mill, rows=writer.add)
    read = polycnc.compare(tmp_path / "part.nc", tmp_path / "part.csv", mill)
    assert read.ok
    assert (read.deviation_mm, read.cuts_a_from_b, read.tools) == (0.0, None, None)
    assert read.b.time_s == result.time_s
    assert read.b.extents_mm["Z"] == pytest.approx(result.extents_mm["Z"])
    assert (read.a.top_feed_mm_min, read.b.top_feed_mm_min) == (
        result.top_feed_mm_min,
        None,
    )  # cuts or rapids?


def test_a_bulge_is_as_far_as_its_sagitta(mill: Path) -> None:
    """A chord of 40 and an arc over it of radius 41: the middle is R - sqrt(R^2 - 20^2) away."""
    line = "G0 X5 Y5\nG1 X45 F900\nM30\n"
    arc = line.replace("G1 X45 F900", "G3 X45 Y5 R41 F900")
    found = polycnc.compare(line, arc, mill, tolerance_mm=5.3)
    sagitta = 41.0 - math.sqrt(41.0**2 - 20.0**2)
    assert found.b_from_a.mm == pytest.approx(sagitta, abs=2e-4)
    assert found.b_from_a.position["X"] == pytest.approx(25.0, abs=0.5)
    assert found.b_from_a.line == 2
    assert found.a_from_b.mm == pytest.approx(sagitta, abs=2e-4)
    assert found.ok
    assert not polycnc.compare(line, arc, mill, tolerance_mm=5.1).ok
    assert found.first_difference is not None
    assert (found.first_difference.line_a, found.first_difference.text_b) == (2, "G3 X45 Y5 R41 F900")


def test_a_pocket_the_other_way_round_is_not_the_same(mill: Path) -> None:
    lines = PART.splitlines()
    lines[3:7] = ["G1 Y22 F1700", "G1 X43", "G1 Y2", "G1 X3"]
    found = polycnc.compare(PART, "\n".join(lines) + "\n", mill)
    assert found.deviation_mm < 2e-3
    assert found.same_order is False
    assert not found.ok
    assert found.parts_at == (("<text>", 4), ("<text>", 4))


def test_a_second_pass_that_is_missing_is_not_the_same(mill: Path) -> None:
    square = "G1 X43 F1700\nG1 Y22\nG1 X3\nG1 Y2\n"
    twice = "G0 X3 Y2 Z5\nG1 Z-1.5 F300\n" + square * 2 + "G0 Z5\nM30\n"
    found = polycnc.compare(twice, twice.replace(square, "", 1), mill)
    assert found.deviation_mm < 2e-3
    assert (found.same_order, found.ok) == (False, False)


def test_a_cut_that_becomes_a_rapid_is_not_the_same(mill: Path) -> None:
    found = polycnc.compare(PART, PART.replace("G1 X33", "G0 X33"), mill)
    assert max(found.a_from_b.mm, found.b_from_a.mm) < 2e-3
    assert found.cuts_a_from_b is not None
    # What was cut at Y7 is nearest to the side at Y2, which is 1 mm higher.
    assert found.cuts_a_from_b.mm == pytest.approx(math.hypot(5.0, 1.0), abs=0.01)
    assert found.cuts_a_from_b.line == 12
    assert not found.ok


def test_a_cut_over_a_cut_that_becomes_a_rapid_is_not_the_same(mill: Path) -> None:
    twice = "G0 X3 Y2 Z5\nG1 Z-1.5 F300\nX43\nX3\nG0 Z5\nM30\n"
    found = polycnc.compare(twice, twice.replace("\nX3\n", "\nG0 X3\n"), mill)
    assert found.deviation_mm < 0.01
    assert (found.same_order, found.ok) == (False, False)


def test_another_tool_is_not_the_same(mill: Path) -> None:
    found = polycnc.compare(PART, PART.replace("T7", "T8"), mill)
    assert found.tools == ((0, 4, 7), (0, 4, 8))
    assert (found.deviation_mm, found.ok) == (0.0, False)


def test_another_feed_changes_times_and_no_path(mill: Path) -> None:
    found = polycnc.compare(PART, PART.replace("F1700", "F1250"), mill)
    assert found.ok
    slower_s = 60.0 * 120.0 / 1250.0 - 60.0 * 120.0 / 1700.0
    assert found.b.time_s - found.a.time_s == pytest.approx(slower_s, abs=0.02)
    assert (found.a.top_feed_mm_min, found.b.top_feed_mm_min) == pytest.approx((1700.0, 1250.0))


def test_a_rotary_axis_that_one_machine_lacks(mill: Path, tmp_path: Path) -> None:
    with_c = tmp_path / "mill_c.toml"
    with_c.write_text(
        MILL + '[[axis]]\nname = "C"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 900\nmodulo = true\n'
    )
    still = polycnc.compare(PART, PART, mill, machine_b=with_c)
    assert (still.ok, still.lone_axes) == (True, ())
    turned = polycnc.compare(PART, PART.replace("G0 Z5\nT7", "G0 Z5 C35\nT7"), mill, machine_b=with_c)
    assert (turned.ok, turned.lone_axes) == (False, ("C",))
    both = polycnc.compare(
        "G1 X5 F900\nG91\nC350\nC350\nM30\n", "G1 X5 F900\nG91\nC350\nC350.5\nM30\n", with_c
    )
    assert both.b_from_a.mm == pytest.approx(0.5, abs=1e-4)  # counted on over the full turn


def test_an_alarm_in_one_of_them_is_not_the_same(mill: Path) -> None:
    found = polycnc.compare(PART, PART.replace("M30", "G1 B7"), mill)
    assert (found.a.ok, found.b.ok, found.ok) == (True, False, False)
    assert found.as_dict()["b"]["alarms"][0]["line"] == 14


def test_nothing_moves_anywhere() -> None:
    assert polycnc.compare("M3\nM30\n", "M5\nM30\n").ok
    lone = polycnc.compare("M3\nM30\n", "G1 X5 F100\nM30\n")
    assert (lone.b_from_a.mm > 4.9, lone.ok) == (True, False)


def test_first_difference_is_of_words_and_not_of_dress() -> None:
    read = load_dialect("din")

    def lines(a: str, b: str) -> tuple[int, int] | None:
        found = first_difference(ProgramText.from_text(a), ProgramText.from_text(b), read, read)
        return None if found is None else (found.line_a, found.line_b)

    # A decimal point can mean another unit.
    assert lines("N10 G1 X10 F5\nN20 Y7\n", "(part)\n\nG1X10.F5\n") == (1, 3)
    assert lines("N10 G1 X10 F5\nN20 Y7\n", "(part)\n\nG1 X10 F05 (slow)\r\nN999 Y7.\n") == (2, 4)
    assert lines("N10 G1 X10 F5\nN20 Y7\n", "(part)\n\nG1 X10 F05 (slow)\r\nN999 Y7\n") is None
    assert lines("G1 X10\nY7\n", "G1 X10\nY7\nM30\n") == (0, 3)
    assert lines("G1 X10\n/Y7\n", "G1 X10\nY7\n") == (2, 2)
    assert lines("G1 X10\nY7\nZ3\nX1\n", "G1 X10\n\nY7\n(part)\nZ3\nX2\n") == (4, 6)


def test_refusals(mill: Path) -> None:
    with pytest.raises(UsageError, match="a tolerance of -1"):
        polycnc.compare(PART, PART, mill, tolerance_mm=-1.0)
    with pytest.raises(UsageError, match="a tolerance of nan"):
        polycnc.compare(PART, PART, mill, tolerance_mm=math.nan)
    with pytest.raises(UsageError, match="no trace"):
        polycnc.compare(PART, polycnc.run(PART, mill), mill)


def test_the_command(mill: Path, tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_text(PART)
    (tmp_path / "b.nc").write_text(PART.replace("G1 X33", "G1 X33.75"))
    same = command("compare", "a.nc", "a.nc", "-m", mill, cwd=tmp_path)
    assert same.stdout.endswith("the same within 0.01 mm\n")
    found = command("compare", "a.nc", "b.nc", "-m", mill, "-o", "both.html", cwd=tmp_path, status=1)
    assert "B from A 0.7500 mm at X33.750 Y7.000 Z-2.500, line 12" in found.stdout
    assert "differs    A line 12: G1 X33\n" in found.stdout
    page = (tmp_path / "both.html").read_text("utf-8")
    assert 'content="polycnc view"' in page
    command("compare", "a.nc", "b.nc", "-m", mill, "--tolerance", "0.8", cwd=tmp_path)
    data = json.loads(command("compare", "a.nc", "b.nc", "-m", mill, "--json", cwd=tmp_path, status=1).stdout)
    assert data["b_from_a"]["mm"] == pytest.approx(0.75, abs=2e-5)
    alone = command("compare", "a.nc", cwd=tmp_path, status=2)
    assert "nothing to be compared with" in alone.stderr
    over = command("compare", "a.nc", "b.nc", "-o", "a.nc", cwd=tmp_path, status=2)
    assert "error:" in over.stderr
    assert (tmp_path / "a.nc").read_text() == PART


def test_walks_that_just_stay_within_reach() -> None:
    """By hand: a roof of 3, a way back of 6 of which half is waited for, and walkers that stand."""
    line = np.array([[0.0, 0.0], [10.0, 0.0]])
    roof = np.array([[0.0, 0.0], [5.0, 3.0], [10.0, 0.0]])
    back = np.array([[0.0, 0.0], [8.0, 0.0], [2.0, 0.0], [10.0, 0.0]])
    for other in (roof, back):
        assert in_one_order(line, other, 3.0)[0]
        assert in_one_order(other, line, 3.0)[0]
        assert not in_one_order(line, other, 2.999)[0]
        assert not in_one_order(other, line, 2.999)[0]
    stands = np.array([[6.0, 0.0], [6.0, 0.0]])
    assert in_one_order(stands, line, 6.0)[0]
    assert in_one_order(line, stands, 6.0)[0]
    assert not in_one_order(stands, line, 5.999)[0]
    assert not in_one_order(line, stands, 5.999)[0]
    assert in_one_order(stands, stands + (0.0, 2.0), 2.0)[0]
    assert not in_one_order(stands, stands + (0.0, 2.0), 1.999)[0]


def test_walks_part_where_they_part() -> None:
    one = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    for other, where in (
        (((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (20.0, 10.0)), (2, 2)),
        (((0.0, 0.0), (4.0, 0.0), (7.0, 0.0), (10.0, 0.0), (20.0, 0.0)), (1, 3)),
        (((5.0, 0.0), (10.0, 0.0), (10.0, 10.0)), (0, 0)),
    ):
        assert in_one_order(one, np.array(other), 1.0) == (False, *where)


def _trace_of(x: Sequence[float], rapid: Sequence[bool], unit: str = "mm") -> Trace:
    rows = len(x)
    return Trace(
        ("X", "Y"), (unit, "mm"),
        t_s=np.arange(1, rows + 1, dtype=np.float64) * 0.002,
        block=np.arange(rows) // 3 + 4,
        feed_mm_s=np.zeros(rows),
        rapid=np.array(rapid, np.bool_),
        setpoint=np.column_stack((x, np.zeros(rows))),
    )  # fmt: skip


def test_a_path_keeps_its_ends_and_where_the_block_changes() -> None:
    """Along a line nothing else is kept; a rapid and a cut meet in cycles of which the longest is 3 mm."""
    x = [0.0, 1.0, 3.0, 6.0, 10.0, 14.0, 15.0]
    path = PathCollector(("X", "Y"), ("mm", "mm")).path_of(_trace_of(x, [True] * 3 + [False] * 4))
    assert path.point.tolist() == [[0.0, 0.0], [3.0, 0.0], [14.0, 0.0], [15.0, 0.0]]
    assert path.t_s.tolist() == pytest.approx([0.002, 0.006, 0.012, 0.014])
    assert path.rapid.tolist() == [True, True, False, False]
    assert [path.blocks[each].line for each in path.number.tolist()] == [4, 4, 5, 6]
    assert (path.step, path.kinds_known, path.length()) == (3.0, False, 15.0)
    ends = PathCollector(("X", "Y"), ("mm", "mm")).path_of(_trace_of([0.0, 5.0, 9.0], [False, False, True]))
    assert ends.step == 5.0
    plain = PathCollector(("X", "Y"), ("mm", "mm")).path_of(_trace_of(x, [False] * 7))
    assert plain.step == 0.0


def test_a_path_that_comes_in_pieces_has_no_points_between_them() -> None:
    rows = 70_000
    trace = _trace_of(np.arange(rows) * 0.007 % 360.0, [False] * rows, "deg")  # type: ignore[arg-type]
    trace = replace(trace, block=np.full(rows, 4))
    path = PathCollector(("X", "Y"), ("deg", "mm")).path_of(trace)
    assert len(path.point) <= 3  # its pieces end at row 65536
    assert path.point[-1, 0] == pytest.approx((rows - 1) * 0.007)  # more than a turn


def test_a_comparison_as_data_and_as_text(mill: Path) -> None:
    line = "G0 X5 Y5\nG1 X45 F900\nM30\n"
    arc = line.replace("G1 X45 F900", "G3 X45 Y5 R41 F900")
    found = polycnc.compare(line, arc, mill)
    assert found.same_order is None  # too far apart anyway
    data = found.as_dict()
    assert data["deviation_mm"] == found.deviation_mm == max(found.a_from_b.mm, found.b_from_a.mm)
    assert (data["ok"], data["tolerance_mm"], data["parts_at"]) == (False, 0.01, None)
    assert data["tools"] == [[0], [0]]
    assert data["lone_axes"] == []
    assert data["first_difference"] == {
        "a": {"line": 2, "text": "G1 X45 F900"}, "b": {"line": 2, "text": "G3 X45 Y5 R41 F900"},
    }  # fmt: skip
    assert data["a_from_b"]["position"] == found.a_from_b.position
    assert data["cuts_b_from_a"]["mm"] == pytest.approx(data["b_from_a"]["mm"], abs=1e-4)
    assert (data["a"]["cutting_path_mm"], data["a"]["ok"], data["a"]["machine"]) == (40.0, True, "compared")
    assert data["b"]["extents_mm"]["X"] == [0.0, 45.0]
    half_s = 41.0 * math.asin(20.0 / 41.0) / 15.0  # from the middle of the arc to its end
    assert found.b_from_a.time_s == pytest.approx(found.b.time_s - half_s, abs=0.05)
    assert found.b_from_a.program == "<text>"
    assert str(found) == f"<text> and <text> differ: deviation {found.deviation_mm:.6f} mm"
    assert str(polycnc.compare(line, line, mill)) == "<text> and <text> agree: deviation 0.000000 mm"
    lines = PART.splitlines()
    lines[3:7] = ["G1 Y22 F1700", "G1 X43", "G1 Y2", "G1 X3"]
    parted = polycnc.compare(PART, "(round)\n" + "\n".join(lines) + "\n", mill).as_dict()
    assert parted["parts_at"] == {
        "a": {"program": "<text>", "line": 4}, "b": {"program": "<text>", "line": 5},
    }  # fmt: skip


def test_both_paths_in_one_view(mill: Path) -> None:
    line = "G0 X5 Y5\nG1 X45 F900\nM30\n"
    arc = line.replace("G1 X45 F900", "G3 X45 Y5 R41 F900")
    found = polycnc.compare(line, arc, mill)
    other = _about(found.view().html)["other"]
    a, b = other["marks"]
    assert a["text"] == f"A is farthest from B: {found.a_from_b.mm:.4f} mm, line 2"
    assert a["place"] == [found.a_from_b.position[axis] for axis in "XYZ"]
    assert a["time_s"] == found.a_from_b.time_s
    assert b["text"] == f"B is farthest from A: {found.b_from_a.mm:.4f} mm, line 2"
    assert b["place"] == [found.b_from_a.position[axis] for axis in "XYZ"]
    assert b["time_s"] is None  # on the view's own clock nobody knows
    assert _about(polycnc.compare(line, line, mill).view().html)["other"]["marks"] == []


def test_a_trace_beside_its_program(mill: Path) -> None:
    """A trace tells its end, its length and its extents; what was a cut is in the object and not in a file."""
    result = polycnc.run(PART, mill, trace=True)
    trace = result.trace
    found = polycnc.compare(trace, PART, mill)
    assert found.ok
    assert (found.a.name, found.a.machine, found.a.result) == ("trace", "", None)
    assert (found.a.time_s, found.a.top_feed_mm_min) == (result.time_s, None)
    # The first cycle of the rapid has gone before the first row, a dry 0.003 mm of it.
    assert found.a.path_mm == pytest.approx(result.path_mm, abs=0.01)
    assert found.a.extents_mm["Z"] == result.extents_mm["Z"]
    assert found.tools == ((0, 4, 7), (0, 4, 7))
    assert found.first_difference is None  # nobody knows its text
    assert "alarms" not in found.a.as_dict()
    about = _about(found.view().html)
    assert (about["machine"], about["time_s"]) == ("trace", result.time_s)
    said = polycnc.compare(result, PART.replace("X33", "X34"), mill)
    assert (said.a.name, said.a.machine, said.a.top_feed_mm_min) == (
        "<text>",
        "compared",
        result.top_feed_mm_min,
    )
    assert said.first_difference is not None
    assert (said.first_difference.line_a, said.first_difference.line_b) == (12, 12)
    bare = replace(trace, execution=None)
    assert polycnc.compare(bare, PART, mill).tools is None


def test_rapids_alone_against_cuts(mill: Path) -> None:
    found = polycnc.compare("G0 X5 Y3\nM30\n", "\nG1 X5 Y3 F900\nM30\n", mill)
    assert found.cuts_a_from_b is not None
    assert found.cuts_b_from_a is not None
    assert found.cuts_a_from_b.as_dict() == {
        "mm": 0.0,
        "position": {},
        "program": "",
        "line": 0,
        "time_s": 0.0,
    }
    assert (found.cuts_b_from_a.mm, found.cuts_b_from_a.line) == (math.inf, 2)
    assert max(found.a_from_b.mm, found.b_from_a.mm) < 1e-2
    assert (found.deviation_mm, found.ok) == (math.inf, False)


def test_a_machine_that_stands_is_a_point(mill: Path) -> None:
    assert polycnc.compare("G4 F0.1\nM30\n", "G4 F0.2\nM30\n", mill).ok
    found = polycnc.compare("G4 F0.1\nM30\n", "G4 F0.1\nG1 X5 F100\nM30\n", mill)
    assert found.a_from_b.mm == 0.0
    assert found.b_from_a.mm == pytest.approx(5.0)
    assert found.b_from_a.line == 2
    assert found.b_from_a.position["X"] == pytest.approx(5.0)
    assert found.b_from_a.time_s == pytest.approx(found.b.time_s)


def test_the_tolerance_itself_is_within_it(mill: Path) -> None:
    moved = PART.replace("G1 X33", "G1 X33.75")
    assert polycnc.compare(PART, moved, mill, tolerance_mm=0.75).ok
    assert not polycnc.compare(PART, moved, mill, tolerance_mm=0.7499).ok
    assert polycnc.compare(PART, PART, mill, tolerance_mm=0.0).ok


def test_each_side_has_its_machine_and_dialect(mill: Path, tmp_path: Path) -> None:
    din, fanuc = "G70\nG1 X1 F10\nM30\n", "G20\nG1 X1. F10.\nM30\n"
    found = polycnc.compare(din, fanuc, mill, "din", dialect_b="fanuc")
    assert found.ok
    assert found.b.extents_mm["X"] == pytest.approx((0.0, 25.4))
    other = tmp_path / "other.toml"
    other.write_text(MILL.replace('"Y"', '"V"').replace('"Z"', '"C"\nkind = "rotary"'
                     ).replace("compared", "other"))  # fmt: skip
    other.write_text(other.read_text().replace(
        'kind = "rotary"\nvmax_mm_s = 250\namax_mm_s2 = 3000', 'kind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 900'
    ))  # fmt: skip
    found = polycnc.compare("G1 C5 V3 X2 F90\nM30\n", "G1 X2 Y3 F90\nM30\n", other, machine_b=mill)
    assert (found.lone_axes, found.ok, found.a.machine, found.b.machine) == (
        ("V", "C", "Y"), False, "other", "compared",
    )  # fmt: skip
    assert [axis for axis, _ in found.axes] == ["X"]
    lone = tmp_path / "lone.toml"
    lone.write_text(MILL.partition("[[axis]]")[0] + '[[axis]]\nname = "U"\nvmax_mm_s = 9\namax_mm_s2 = 90\n')
    with pytest.raises(UsageError, match="<text> and <text> have no axis in common") as caught:
        polycnc.compare("G1 X2 F90\n", "G1 U2 F90\n", mill, machine_b=lone)
    assert caught.value.hint == "Axes are X, Y, Z and U."


def test_progress_is_that_of_both(mill: Path) -> None:
    done: list[float] = []
    polycnc.compare(PART, PART, mill, progress=done.append)
    first, second = done
    assert second == 0.5 + first
    assert first == pytest.approx(0.5 * 13 / 14)  # the last line that moves


def test_differences_in_what_is_no_word() -> None:
    read = load_dialect("din")

    def found(a: str, b: str) -> BlockDifference | None:
        return first_difference(ProgramText.from_text(a), ProgramText.from_text(b), read, read)

    assert found("G1 X1\rX2\rX3\n", "G1 X1\rX2\rX4\n") == BlockDifference(3, "X3", 3, "X4")
    assert found("G1 X1\r\nX2\r\nX3\r\n", "G1 X1\r\nX2\r\nX4\r\n") == BlockDifference(3, "X3", 3, "X4")
    assert found("G1 X9 Q\nX2\n", "G1 X9 Q \nX2\n") is None  # wrong in both in the same way
    assert found("X2\n\nG1 X9 Q\n", "X2\nG1 X9 R\n") == BlockDifference(3, "G1 X9 Q", 2, "G1 X9 R")
    assert found("G1 X1\nM30\n", "G1 X1\n") == BlockDifference(2, "M30", 0, "")
    assert found("G1 X1\n", "G1 X1\n(end)\n") is None


def _along_x(cut: tuple[float, float]) -> Trace:
    """Return a trace to X30 and on, at a millimetre a cycle: a rapid, a cut, a rapid."""
    x = sorted({*map(float, range(31)), *cut})
    trace = _trace_of(x, [not cut[0] < at <= cut[1] for at in x])
    return replace(trace, execution=execution_by_lines(trace.block))


@pytest.mark.parametrize(
    ("cut", "beyond"),
    [((10.0, 20.0), 0.0), ((10.75, 20.75), 0.0), ((8.0, 20.0), 1.0), ((10.0, 23.0), 2.0), ((7.5, 21.0), 1.5)],
)
def test_where_a_cut_begins_and_ends_is_known_to_a_cycle(cut: tuple[float, float], beyond: float) -> None:
    found = polycnc.compare(_along_x(cut), _along_x((10.0, 20.0)))
    assert found.a_from_b.mm == found.b_from_a.mm == 0.0
    assert found.cuts_a_from_b is not None
    assert found.cuts_b_from_a is not None
    assert found.cuts_a_from_b.mm == pytest.approx(beyond, abs=2e-5)
    assert found.cuts_b_from_a.mm == pytest.approx(0.0, abs=2e-5)
    assert found.ok is (beyond == 0.0)
