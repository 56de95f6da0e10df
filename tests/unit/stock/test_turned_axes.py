"""Tools that come from any side: volumes against exact bodies, faults at their blocks, a table that turns."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from polycnc import runner
from polycnc.errors import UsageError
from polycnc.machine import load_machine, parse_machine, preset_text
from polycnc.stock import (
    Box,
    ContactKind,
    Form,
    Mesh,
    Rows,
    Tool,
    ToolKind,
    TurnedCutting,
    Voxels,
    _fixtures,
    check_closed,
    solid_fixtures_of,
)
from polycnc.stock._auto import leave_out_rapids

BOX = Box((-10.0, -8.0, -9.0), (11.0, 9.0, 0.5))
MILL = Tool(ToolKind.FLAT, 6.0, flute_mm=30.0)


def tilted(degrees: float) -> tuple[float, float, float]:
    """Return the direction of a tool that leans towards +X and a little towards +Y."""
    a = math.radians(degrees)
    x, y, z = math.sin(a), 0.4 * math.sin(a), math.cos(a)
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def record(
    places: list[tuple[float, float, float]], axes: list[tuple[float, float, float]], rapid: list[bool]
) -> Rows:
    n = len(places)
    whole = np.arange(n)
    return Rows(
        np.arange(1.0, n + 1.0),
        np.array(places),
        whole + 10,
        np.full(n, 4),
        np.array(rapid),
        np.full(n, 900.0),
        np.array(axes),
    )


NOWHERE = record([(0.0, 0.0, 0.0)], [(0.0, 0.0, 1.0)], [True])


def drilled(degrees: float, cell: float, *, rapid: bool = False, tool: Tool = MILL) -> TurnedCutting:
    """Move a tool along its leaning axis through the box, and back at rapid."""
    axis = np.array(tilted(degrees))
    deep, high = np.array([0.7, -0.4, -6.1]), np.array([0.7, -0.4, -6.1]) + 25.0 * axis
    places = [tuple(each) for each in (high, deep, high)]
    found = TurnedCutting(Voxels(BOX, cell), {4: tool})
    found.add(record(places, [tuple(axis)] * 3, [True, rapid, True]))
    return found


@pytest.mark.parametrize("degrees", [0.0, 31.0, 75.0])
def test_a_hole_along_a_leaning_axis(degrees: float) -> None:
    manifold3d = pytest.importorskip("manifold3d")
    found = drilled(degrees, 0.2)
    sizes = [b - a for a, b in zip(BOX.low, BOX.high, strict=True)]
    block: Any = manifold3d.Manifold.cube(sizes).translate(BOX.low)
    x, y, z = tilted(degrees)
    turn = math.degrees(math.acos(z))
    tool = manifold3d.Manifold.cylinder(60.0, 3.0, circular_segments=256)
    tool = tool.rotate([0.0, turn, 0.0]).rotate([0.0, 0.0, math.degrees(math.atan2(y, x)) if turn else 0.0])
    exact = (block ^ tool.translate([0.7, -0.4, -6.1])).volume()
    assert found.tally.by_tool_mm3[4] == pytest.approx(exact, rel=0.0015)
    assert found.tally.by_block_mm3[11] == found.tally.by_tool_mm3[4]
    assert found.tally.contacts.all() == []
    assert not found.stock.holds(0.7, -0.4, -5.5)
    assert found.stock.holds(-9.0, 7.0, -8.0)


def test_a_tool_that_turns_in_its_place_leaves_a_wedge() -> None:
    """A ball whose middle stays where it is while its axis leans from one side to the other: half a disc, and edges."""
    ball = Tool(ToolKind.BALL, 4.0)
    middle, lean = np.array([0.5, 0.3, -3.0]), math.radians(40.0)
    angles = np.linspace(-lean, lean, 81)
    axes = np.column_stack((np.sin(angles), np.zeros(81), np.cos(angles)))
    found = TurnedCutting(Voxels(BOX, 0.2), {4: ball})
    found.add(record((middle - 2.0 * axes).tolist(), axes.tolist(), [True] + [False] * 80))
    # By slices across Y: within the radius there, a sector of rods between two leaning lines, up to the top.
    total = 0.0
    for y in (np.arange(50) + 0.5) / 50 * 4.0 - 2.0:
        half = math.sqrt(4.0 - y * y)
        x, z = np.meshgrid(np.arange(-8.0, 8.0, 0.02), np.arange(-2.0, 3.5, 0.02))
        angle = np.clip(np.arctan2(x, z), -lean, lean)
        along = np.maximum(x * np.sin(angle) + z * np.cos(angle), 0.0)
        total += (
            float(np.sum(np.hypot(x - along * np.sin(angle), z - along * np.cos(angle)) <= half))
            * 0.02**2
            * 0.08
        )
    assert found.tally.by_tool_mm3[4] == pytest.approx(total, rel=0.02)


def test_faults_with_a_leaning_tool() -> None:
    [crash] = drilled(31.0, 0.25, rapid=True).tally.contacts.all()
    assert (crash.kind, crash.block) == (ContactKind.RAPID, 11)
    short = Tool(ToolKind.FLAT, 6.0, flute_mm=5.0)
    assert [(each.kind, each.block) for each in drilled(31.0, 0.25, tool=short).tally.contacts.all()] == [
        (ContactKind.FLUTES, 11)
    ]
    low = Tool(ToolKind.FLAT, 6.0, holder=((4.0, 9.0),))
    assert ContactKind.HOLDER in {each.kind for each in drilled(31.0, 0.25, tool=low).tally.contacts.all()}
    left = Tool(ToolKind.FLAT, 6.0, left_hand=True)
    assert [each.kind for each in drilled(31.0, 0.25, tool=left).tally.contacts.all()] == [
        ContactKind.DIRECTION
    ]


TABLE = """(T1 D=6. - flat end mill)
T1 M6
S900 M3
G0 X0 Y0 Z80 A-90 C0
X0 Y0 Z30
G1 Z12 F400
G0 Z80
C120
Z30
G1 Z12
G0 Z30
G1 Z80
M30
"""


def test_a_table_that_turns_shows_its_sides_to_the_tool() -> None:
    """Two holes of 6 mm into the side of a cylinder of 40 mm, 8 mm deep, 120 degrees apart."""
    config = load_machine("mill5").model_copy(update={"start": {"Z": 80.0}})
    found = runner.run(TABLE, config, "fanuc", stock="cylinder=40,-15,15", resolution_mm=0.4, check=False)
    assert found.machined is not None
    # The cylinder's side is curved: a hole from its outermost place, less what is above the side.
    y = (np.arange(2000) + 0.5) / 2000 * 6.0 - 3.0
    exact = 2.0 * float(np.sum(2.0 * np.sqrt(9.0 - y**2) * (np.sqrt(400.0 - y**2) - 12.0)) * 6.0 / 2000)
    assert found.removed_mm3 == pytest.approx(exact, rel=0.03)
    assert found.collisions == []
    assert [each.line for each in found.machined.idle] == [12]
    lines = {found.machined.blocks[n].line for n in np.flatnonzero(found.machined.removed_mm3).tolist()}
    assert lines == {6, 10}
    wrong = runner.run(
        TABLE.replace("G1 Z12 F400", "Z12"), config, "fanuc", stock="cylinder=40,-15,15", check=False
    )
    assert (wrong.collisions[0].kind, wrong.collisions[0].line) == (ContactKind.RAPID, 6)


@pytest.mark.parametrize(
    ("first_mm", "second_mm", "gouges", "rest_mm"),
    [
        (12.0, 12.0, {}, 0.0),
        (11.95, 12.0, {6: 0.05, 7: 0.05}, 0.0),
        (12.0, 11.95, {10: 0.05, 11: 0.05}, 0.0),
        (12.0, 14.0, {}, 2.0),
    ],
)
def test_a_target_is_compared_from_any_side(
    first_mm: float, second_mm: float, gouges: dict[int, float], rest_mm: float, tmp_path: Path
) -> None:
    """The two holes of the table, 12 mm from its axis: one 0.05 mm too deep, or 2 mm too short."""
    manifold3d = pytest.importorskip("manifold3d")
    body: Any = manifold3d.Manifold.cylinder(30.0, 20.0, circular_segments=360).translate([0.0, 0.0, -15.0])
    for angle in (90.0, 210.0):
        hole = manifold3d.Manifold.cylinder(30.0, 3.0, circular_segments=256).translate([0.0, 0.0, 12.0])
        body -= hole.rotate([0.0, 90.0, 0.0]).rotate([0.0, 0.0, angle])
    mesh = body.to_mesh()
    file = tmp_path / "part.stl"
    Mesh(np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int64)).write_stl(
        file
    )
    text = TABLE.replace("G1 Z12 F400", f"G1 Z{first_mm} F400").replace("G1 Z12\n", f"G1 Z{second_mm}\n")
    config = load_machine("mill5").model_copy(update={"start": {"Z": 80.0}})
    found = runner.run(
        text, config, "fanuc", stock="cylinder=40,-15,15", resolution_mm=0.5, target=str(file), check=False
    )
    assert {each.kind for each in found.collisions} == ({ContactKind.GOUGE} if gouges else set())
    assert {each.line: each.depth_mm for each in found.collisions} == pytest.approx(gouges, abs=0.003)
    assert found.machined is not None
    assert found.machined.comparison is not None
    assert found.machined.comparison.rest_mm == pytest.approx(rest_mm, abs=0.51)
    assert found.machined.comparison.rest_mm3 == pytest.approx(math.pi * 9.0 * rest_mm, rel=0.2)


def test_a_target_with_a_tool_that_undercuts_is_refused() -> None:
    lines = 'shape = "form"\noutline = [[0, 0], [8, 0], [8, 4], [3, 4]]'
    config = parse_machine(f"{preset_text('mill3')}\n[tools.1]\n{lines}\n", "m.toml")
    text = "T1 M6\nS900 M3\nG0 X0 Y0 Z5\nG1 Z-3 F400\nG0 Z5\nM30\n"
    with pytest.raises(UsageError, match="a target with tools that undercut") as refused:
        runner.run(text, config, "fanuc", stock="box=-9,-9,-9,9,9,0", target="part.stl", check=False)
    assert refused.value.hint


def test_an_auto_body_has_nothing_where_rapids_come_along() -> None:
    """Both holes are cut whole: what is left out is what a rapid meets before it is cut, not the way out of a hole."""
    config = load_machine("mill5").model_copy(update={"start": {"Z": 80.0}})
    near = TABLE.replace("G0 X0 Y0 Z80 A-90 C0\nX0 Y0 Z30", "G0 X0 Y0 Z80 A-90 C0\nX20 Z14\nX0 Z19.5")
    for text in (TABLE, near):
        found = runner.run(text, config, "fanuc", stock="auto", resolution_mm=0.5, check=False)
        assert found.machined is not None
        assert found.collisions == []
        lines = {
            found.machined.blocks[n].line for n in np.flatnonzero(found.machined.removed_mm3 > 50.0).tolist()
        }
        assert len(lines) == 2
        assert found.machined.form.text == "auto"


def test_a_body_from_a_file_is_cut_from_any_side(tmp_path: Path) -> None:
    """Leaning walls, a tunnel and a hollow: cells have the volume of the exact body, upright and turned over."""
    manifold3d = pytest.importorskip("manifold3d")
    solid = manifold3d.Manifold
    body: Any = solid.sphere(12.0, 48) - solid.cube([7.0, 6.0, 5.0], True)
    body -= (
        solid.cylinder(40.0, 4.0, circular_segments=32, center=True)
        .rotate([0.0, 90.0, 0.0])
        .translate([0.0, 0.0, 6.5])
    )
    body += solid.cube([8.0, 5.0, 3.0]).rotate([20.0, 30.0, 10.0]).translate([15.0, 3.0, 2.0])
    found = body.to_mesh()
    vertices = np.array(found.vert_properties[:, :3], np.float64)
    file = tmp_path / "part.stl"
    Mesh(vertices, np.array(found.tri_verts, np.int64)).write_stl(file)
    cells = Form(str(file), 0.4).voxels(NOWHERE, {})
    assert cells.volume_mm3 == pytest.approx(body.volume(), rel=5e-4)
    assert [cells.holds(0.0, y, z) for y, z in ((0.0, 0.0), (0.0, 6.0), (9.0, 0.0), (0.0, -9.0))] == [
        False, False, True, True,
    ]  # fmt: skip
    over = Form(f"x-turned={file}", 0.4).voxels(NOWHERE, {})
    assert over.volume_mm3 == pytest.approx(body.volume(), rel=5e-4)
    middle = vertices.min(axis=0) + vertices.max(axis=0)
    assert not over.holds(0.0, middle[1], middle[2] - 6.0)
    cutting = TurnedCutting(cells, {4: MILL})
    cutting.add(record([(0.0, 0.0, 20.0), (0.0, 0.0, 9.0)], [(0.0, 0.0, 1.0)] * 2, [True, False]))
    assert cutting.tally.by_tool_mm3[4] > 20.0


def test_the_surface_of_cells_is_closed_and_has_their_volume() -> None:
    body = drilled(31.0, 0.5).stock
    surface = body.mesh()
    check_closed(Path("body.stl"), surface)
    assert surface.volume_mm3 == pytest.approx(body.volume_mm3, rel=0.004)
    whole = Voxels(BOX, 0.5)
    assert whole.volume_mm3 == pytest.approx(21.0 * 17.0 * 9.5)
    assert whole.mesh().vertices.min(axis=0).tolist() == list(BOX.low)


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (lambda: Voxels(Box((0.0, 0.0, 0.0), (1.0, 0.0, 1.0)), 0.1), "no volume"),
        (lambda: Voxels(Box((0.0, 0.0, 0.0), (100.0, 100.0, 100.0)), 0.02), "125,000,000,000 cells"),
        (lambda: Voxels(BOX, float("nan")), "resolution of nan"),
        (lambda: Form("missing.stl").voxels(NOWHERE, {}), "cannot read"),
        (lambda: Form("auto").voxels(NOWHERE, {}), "cuts nothing"),
    ],
)
def test_what_no_body_of_points_has_is_refused(wrong: Any, text: str) -> None:
    with pytest.raises(UsageError, match=text) as refused:
        wrong()
    assert refused.value.hint


def test_what_rapids_leave_of_an_auto_body_is_found_where_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    axis, cell = tilted(25.0), 0.5
    places = [(-30.0, -3.0, 20.0), (-9.0, -3.0, -2.0), (-9.0, 3.0, -2.0), (-9.0, 3.0, 20.0), (9.0, 4.0, -3.0)]
    course = record(places, [axis] * 5, [True, True, False, True, True])
    body = Voxels(BOX, cell)
    near, everywhere = body.copy(), body.copy()
    part = body.reached(course.tip[:2], np.array([axis, axis]), MILL.radius_mm)
    assert body.cells[part].size < 0.6 * body.cells.size  # the cost of a rapid is that of its own way
    leave_out_rapids(near, course, {4: MILL})
    whole = (slice(None), slice(None), slice(None))
    monkeypatch.setattr(Voxels, "reached", lambda *_: whole)
    leave_out_rapids(everywhere, course, {4: MILL})
    assert 100.0 < body.volume_mm3 - near.volume_mm3 < 0.5 * body.volume_mm3
    assert np.array_equal(near.cells, everywhere.cells)


def test_a_leaning_tool_in_a_fixture(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tool leans towards +X: what stands there meets its shank, what stands on its way the cutter."""
    tool = Tool(ToolKind.FLAT, 6.0, flute_mm=12.0, holder=((14.0, 9.0),))
    axis = tilted(40.0)
    course = record([(0.0, -12.0, 1.0), (0.0, 0.0, 1.0), (0.0, 12.0, 1.0)], [axis] * 3, [False] * 3)
    beside = {
        "box=-9,-20,-9,9,20,0": [],
        "box=-2,9,0,2,16,9": ["tool in fixture"],
        "box=16,-2,9,26,8,30": ["holder in fixture"],
    }
    for text, kinds in beside.items():
        cutting = TurnedCutting(Voxels(BOX, 0.5), {4: tool}, solid_fixtures_of((text,), 0.5))
        cutting.add(course)
        found = [str(each.kind) for each in cutting.tally.contacts.all() if "fixture" in each.kind]
        assert sorted(set(found)) == kinds, text
    monkeypatch.setattr(_fixtures, "MOST_VOXELS", 1999)
    with pytest.raises(UsageError, match="the fixtures have more than 1,999 cells"):
        solid_fixtures_of(("box=0,0,0,5,5,5", "box=0,0,0,5,5,5"), 0.5)
