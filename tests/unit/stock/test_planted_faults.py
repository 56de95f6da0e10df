"""Programs with one planted fault each: `inspect` finds it at its block, and nothing in the same program without it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from polycnc import runner
from polycnc.errors import UsageError
from polycnc.machine import MachineConfig, ToolConfig, parse_machine, preset_text
from polycnc.stock import ContactKind, Mesh, fixtures_of

manifold3d = pytest.importorskip("manifold3d")

SLOTS = """G21 G90 G17 G94 G54
T1 M6
S5000 M3
G43 H1 G0 X-10 Y16 Z20
Z-4
G1 X70 F1500
G0 Z20
X-10 Y30
Z-4
G1 X70
G0 Z20
M30
"""
PLATE = "box=0,0,-20,60,42,0"
CLAMP = "box=20,-15,-20,30,4,15"
LENGTH = 62.0
TOO_HIGH = "axis Z would go to 1.000 mm, past its soft limit of 0.000 mm"
MILL = ToolConfig(length_mm=LENGTH, radius_mm=5.0, shape="flat", flute_mm=12.0)
TOOLS = {
    1: MILL.model_copy(update={"shank": ((12.0, 8.0),), "holder": ((40.0, 50.0), (60.0, 63.0))}),
    2: MILL.model_copy(update={"holder": ((12.0, 50.0),)}),
    3: MILL.model_copy(update={"holder": ((3.0, 20.0),)}),
    4: MILL.model_copy(update={"shank": ((3.0, 14.0),)}),
    5: MILL.model_copy(update={"left_hand": True}),
    6: MILL.model_copy(update={"flute_mm": 3.5}),
    7: MILL.model_copy(update={"shank": ((12.0, 30.0),), "holder": ((40.0, 50.0),)}),
}
# What is right, what is wrong instead, and all that is said of it: the error, or keys of remarks, each with its line.
FAULTS: dict[str, tuple[str, str, list[tuple[str, int]]]] = {
    "a rapid across the plate": ("G0 Z20\nX-10 Y30", "G0 X-10 Y30", [("gouge", 7), ("rapid", 7)]),
    "a rapid down into the plate": (
        "Z-4\nG1 X70 F1500",
        "X30 Z-4\nG1 X70 F1500",
        [("rest", 1), ("rapid", 5)],
    ),
    "a low holder": ("T1 M6", "T3 M6", [("holder", 6), ("holder", 10)]),
    "a wide shank": ("T1 M6", "T4 M6", [("shank", 6), ("shank", 10)]),
    "short flutes": ("T1 M6", "T6 M6", [("flutes", 6), ("flutes", 10)]),
    "a spindle at rest": ("S5000 M3\n", "S5000\n", [("spindle_off", 6), ("spindle", 6), ("spindle", 10)]),
    "a speed of 0": ("S5000 M3\n", "S0 M3\n", [("spindle", 6), ("spindle", 10)]),
    "a speed of 0 later": ("X-10 Y30\n", "X-10 Y30 S0\n", [("spindle", 10)]),
    "the other way": ("S5000 M3\n", "S5000 M4\n", [("direction", 6), ("direction", 10)]),
    "a tool for the other way": ("T1 M6", "T5 M6", [("direction", 6), ("direction", 10)]),
    "a tool in the clamp": ("X-10 Y30\n", "Z10 X25 Y0\nZ20\nX-10 Y30\n", [("fixture", 8), ("fixture", 9)]),
    "a holder in the clamp": ("T1 M6", "T2 M6", [("fixture_holder", 6)]),
    "a shank in the clamp": ("T1 M6", "T7 M6", [("fixture_shank", 6)]),
    "over-travel with the tool's length": ("G0 Z20\nM30", "G0 Z69\nM30", [(TOO_HIGH, 11)]),
    "a gouge in a floor": ("Z-4\nG1 X70\n", "Z-4.05\nG1 X70\n", [("gouge", 10)]),
    "a gouge in a wall": ("X-10 Y30", "X-10 Y30.05", [("gouge", 10)]),
    "something left": ("Z-4\nG1 X70\n", "Z-3.95\nG1 X70\n", [("rest", 1)]),
    "a feed in the air": ("G0 Z20\nM30", "G0 Z20\nG1 X-10\nM30", [("air", 12)]),
}


@pytest.fixture(scope="module")
def machine() -> MachineConfig:
    text = preset_text("mill3").replace('name = "Z"', 'name = "Z"\nsoft_limits_mm = [-400, 0]')
    config = parse_machine(text, "mill.toml")
    return config.model_copy(update={"tools": TOOLS, "offsets": {"G54": {"Z": -130.0}}})


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The plate with its slots, exactly."""
    body = manifold3d.Manifold.cube([60.0, 42.0, 20.0]).translate([0.0, 0.0, -20.0])
    for y in (11.0, 25.0):
        body -= manifold3d.Manifold.cube([80.0, 10.0, 10.0]).translate([-10.0, y, -4.0])
    return written(body, tmp_path_factory.mktemp("target") / "part.stl")


def looked_at(text: str, machine: MachineConfig, target: str) -> list[tuple[str, int]]:
    report = runner.inspect(
        text, machine, "fanuc", stock=PLATE, resolution_mm=0.2, fixtures=[CLAMP], target=target
    )
    errors = [(error.what, error.position.line if error.position else 0) for error in report.errors]
    return errors + [(each.key, each.position.line if each.position else 0) for each in report.remarks]


def test_what_is_right_is_not_remarked(machine: MachineConfig, target: str) -> None:
    assert looked_at(SLOTS, machine, target) == []
    assert looked_at(SLOTS.replace("S5000 ", ""), machine, target) == []  # the operator sets the speed
    left = SLOTS.replace("T1 M6", "T5 M6").replace("M3\n", "M4\n")
    assert looked_at(left, machine, target) == []


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found_at_its_block(fault: str, machine: MachineConfig, target: str) -> None:
    right, wrong, said = FAULTS[fault]
    assert SLOTS.count(right) == 1
    assert looked_at(SLOTS.replace(right, wrong), machine, target) == said


def test_a_gouge_says_how_deep_it_is(machine: MachineConfig, target: str) -> None:
    """In a floor as in a wall, to some micrometres; the volume is that of the floor, 60 x 10 mm."""
    wanted = {"floor": ("Z-4\nG1 X70\n", "Z-4.05\nG1 X70\n"), "wall": ("X-10 Y30", "X-10 Y30.05")}
    found = {}
    for where, (right, wrong) in wanted.items():
        text = SLOTS.replace(right, wrong)
        options = {"stock": PLATE, "resolution_mm": 0.2, "target": target, "tolerance_mm": 0.03}
        found[where] = runner.run(text, machine, "fanuc", check=False, **options).machined  # type: ignore[call-overload]
        [gouge] = found[where].collisions
        assert gouge.depth_mm == pytest.approx(0.05, abs=0.003)
        assert gouge.line == 10
    assert found["floor"].comparison.gouge_mm3 == pytest.approx(60.0 * 10.0 * 0.05, rel=0.05)
    assert found["floor"].comparison.rest_place is None
    assert found["floor"].as_dict()["target"]["tolerance_mm"] == 0.03


def written(body: Any, file: Path) -> str:
    found = body.to_mesh()
    vertices = np.array(found.vert_properties[:, :3], np.float64)
    Mesh(vertices, np.array(found.tri_verts, np.int64)).write_stl(file)
    return str(file)


def gouges(text: str, stock: str, target: str) -> list[tuple[int, float]]:
    found = runner.run(text, "mill3", "fanuc", check=False, stock=stock, resolution_mm=0.2, target=target)
    return [(each.line, each.depth_mm) for each in found.collisions if each.kind is ContactKind.GOUGE]


@pytest.mark.parametrize("slope_deg", [30.0, 60.0, 85.0])
def test_a_gouge_in_a_slope_is_as_deep_as_it_is_square_to_it(slope_deg: float, tmp_path: Path) -> None:
    """A ball of 10 mm runs down a slope three times, the second time 0.05 mm too deep."""
    sine, cosine = math.sin(math.radians(slope_deg)), math.cos(math.radians(slope_deg))
    cut = manifold3d.Manifold.cube([60.0, 200.0, 200.0]).translate([-30.0, -100.0, 0.0])
    body = manifold3d.Manifold.cube([24.0, 12.0, 90.0]).translate([-2.0, -6.0, -60.0])
    target = written(body - cut.rotate([-slope_deg, 0.0, 0.0]), tmp_path / "slope.stl")
    lines = ["(T1 D=10 ball end mill)", "G21 G90 G54", "T1 M6", "S5000 M3"]
    for x, off in ((0.0, 5.0), (10.0, 4.95), (20.0, 5.0)):
        begin, end = (
            f"Y{y * cosine + off * sine:.5f} Z{off * cosine - y * sine - 5.0:.5f}" for y in (-3.0, 3.0)
        )
        lines += [f"G0 X{x} Y0 Z60", begin.split()[0], begin.split()[1], f"G1 {end} F900"]
    found = gouges("\n".join([*lines, "G0 Z60", "M30", ""]), "box=-2,-6,-60,22,6,30", target)
    assert {line for line, _ in found} == {11, 12, 13}
    assert dict(found)[12] == pytest.approx(0.05, abs=0.002)


def test_what_is_cut_as_deep_as_its_tolerance_beside_an_edge_is_no_gouge(tmp_path: Path) -> None:
    """Around a boss with round corners in fine facets; 0.015 mm too far in is within the tolerance, 0.05 is not."""
    square = manifold3d.CrossSection.square([12.0, 8.0])
    round_ = square.offset(4.0, manifold3d.JoinType.Round, circular_segments=720)
    body = manifold3d.Manifold.cube([32.0, 28.0, 4.0]).translate([-10.0, -10.0, -7.0])
    target = written(
        body + manifold3d.Manifold.extrude(round_, 4.0).translate([0.0, 0.0, -4.0]), tmp_path / "a.stl"
    )
    for off, wrong in ((4.0, False), (3.985, False), (3.95, True)):
        r = 4.0 + off
        text = f"""(T1 D=8 flat end mill)
G21 G90 G17 G54
T1 M6
S5000 M3
G0 X-20 Y0 Z5
Z-3
G1 X{-r} F1500
Y8
G2 X0 Y{8.0 + r} R{r}
G1 X12
G2 X{12.0 + r} Y8 R{r}
G1 Y-20
G0 Z20
M30
"""
        found = gouges(text, "box=-10,-10,-7,22,18,0", target)
        assert [line for line, _ in found] == ([7, 8, 9, 10, 11, 12] if wrong else [])
        assert all(depth == pytest.approx(0.05, abs=0.006) for _, depth in found)


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        ({"fixtures": ["box=1,2,3"]}, "no body"),
        ({"fixtures": ["vice"]}, "'vice' is no fixture"),
        ({"fixtures": ["box=0,0,0,1,1,inf"]}, "no body"),
        ({"fixtures": [CLAMP] * 51}, "51 fixtures"),
        ({"fixtures": ["missing.stl"]}, "cannot read"),
        ({"fixtures": ["box=-9e5,-9e5,0,9e5,9e5,1"]}, "cells"),
        ({"target": "part.step"}, "'part.step' is no target"),
        ({"target": "missing.stl"}, "cannot read"),
        ({"target": "part.stl", "tolerance_mm": 0.0}, "tolerance of 0 mm"),
        ({"target": "part.stl", "tolerance_mm": float("nan")}, "tolerance of nan"),
        ({"tolerance_mm": 0.1}, "without a target"),
        ({"stock": None, "target": "part.stl"}, "without stock"),
        ({"stock": None, "fixtures": [CLAMP]}, "without stock"),
    ],
)
def test_wrong_fixtures_and_targets_are_refused(arguments: dict[str, Any], wrong: str) -> None:
    with pytest.raises(UsageError, match=wrong) as refused:
        runner.run(SLOTS, None, "fanuc", check=False, **{"stock": PLATE, "resolution_mm": None, **arguments})
    assert refused.value.hint


def test_fixtures_have_as_many_cells_as_a_body_in_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("polycnc.stock._fixtures.MOST_CELLS", 1000)
    assert [each.heights.size for each in fixtures_of(["box=0,0,0,10,6,1"], 0.25)] == [960]
    with pytest.raises(UsageError, match="more than 1,000 cells of 0"):
        fixtures_of(["box=0,0,0,10,6,1", "box=20,0,0,23,4,1"], 0.25)


def test_a_tool_of_the_machine_file_that_cannot_be_is_refused() -> None:
    for lines, wrong in (
        ('shape = "bull"\nradius_mm = 4\ncorner_mm = 5', "tool 3 of 'mill3': a corner radius of 5 mm"),
        ('shape = "ball"', "without a radius"),
        ("radius_mm = 1e9", "tool 3 of 'mill3': a flat tool of 2e"),
    ):
        config = parse_machine(f"{preset_text('mill3')}\n[tools.3]\n{lines}\n", "m.toml")
        with pytest.raises(UsageError, match=wrong) as refused:
            runner.run(SLOTS, config, "fanuc", check=False, stock=PLATE)
        assert refused.value.hint
