"""Lathes: what turning tools leave of a bar, against closed forms and exact bodies; faults at their blocks."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc import runner
from polycnc.errors import UsageError
from polycnc.machine import ToolConfig, load_machine, parse_machine, preset_text
from polycnc.stock import (
    ContactKind,
    Insert,
    InsertKind,
    Rows,
    Tool,
    ToolKind,
    Turned,
    TurnedTarget,
    TurningCutting,
    grooving_tool,
    iso_insert,
    threading_tool,
)
from polycnc.stock._insert_sweep import sweep_insert
from polycnc.stock._sweep import FIGURES

SHARP = Insert(InsertKind.TURNING, 0.0, 90.0, 5.0, 12.0, tip=(-1.0, -1.0))


def turned(
    places: list[tuple[float, float]],
    tool: Tool | Insert,
    stock: Turned,
    *,
    rapid: int = 1,
    rpm: float = 800.0,
) -> TurningCutting:
    """Turn with one tool along places (X, Z), a second and a block each; the first `rapid` of them at rapid."""
    n = len(places)
    found = TurningCutting(stock, {4: tool})
    found.add(
        Rows(
            np.arange(1.0, n + 1.0),
            np.array([(x, 0.0, z) for x, z in places]),
            np.arange(10, 10 + n),
            np.full(n, 4),
            np.arange(n) < rapid,
            np.full(n, rpm),
        )
    )
    return found


def test_a_cone_a_face_and_a_groove() -> None:
    bar = Turned(30.0, -40.0, 1.5, 0.01)
    full = bar.volume_mm3
    assert full == pytest.approx(math.pi * 15.0**2 * 41.5)
    found = turned([(17.0, 0.0), (-0.5, 0.0)], SHARP, bar)
    assert found.tally.by_block_mm3[11] == pytest.approx(math.pi * 15.0**2 * 1.5, rel=1e-3)
    found = turned([(7.0, 3.0), (7.0, 0.0), (15.5, -17.0)], SHARP, bar, rapid=2)
    # Between the cone through (7, 0) and (15, -16) and the bar.
    cone = math.pi * 16.0 / 3.0 * (7.0**2 + 7.0 * 15.0 + 15.0**2)
    assert found.tally.by_tool_mm3[4] == pytest.approx(math.pi * 15.0**2 * 16.0 - cone, rel=1e-3)
    assert bar.radii(-8.005) == pytest.approx((11.0, 0.0), abs=0.01)
    groove = grooving_tool(3.0, 0.4, 9.0, tip=(-1.0, -1.0))
    found = turned([(17.0, -30.0), (11.0, -30.0), (17.0, -30.0)], groove, bar)
    # A circle in each corner: how much less is removed there is what Pappus says of it.
    corner = 0.4**2 * (1.0 - math.pi / 4.0)
    away = 0.4 * (10.0 - 3.0 * math.pi) / (12.0 - 3.0 * math.pi)  # of its middle from the sharp corner
    less = 2.0 * corner * 2.0 * math.pi * (11.0 + away)
    assert found.tally.by_tool_mm3[4] == pytest.approx(math.pi * (15.0**2 - 11.0**2) * 3.0 - less, rel=1e-3)
    assert found.tally.contacts.all() == []


def test_a_thread_has_one_groove_for_each_turn() -> None:
    """M20 x 1.5 with a sharp tool of 60 degrees, 0.9 mm deep, four passes: one helix."""
    bar = Turned(20.0, -30.0, 0.0, 0.002)
    rpm, lead, deep = 600.0, 1.5, 0.9
    tool = threading_tool(60.0)
    places = []
    for depth in (0.4, 0.7, 0.85, deep):
        places += [(12.0, 3.0), (10.0 - depth, 3.0), (10.0 - depth, 3.0 - 1.5 * rpm / 60.0), (12.0, -12.0)]
    n = len(places)
    rapid = np.arange(n) % 4 != 2
    found = TurningCutting(bar, {4: tool})
    found.add(
        Rows(
            np.arange(1.0, n + 1.0),
            np.array([(x, 0.0, z) for x, z in places]),
            np.arange(n),
            np.full(n, 4),
            rapid,
            np.full(n, rpm),
        )
    )
    half = deep * math.tan(math.radians(30.0))
    steps = (np.arange(4000) + 0.5) / 4000 * half
    each = (
        2.0
        * np.sum(math.pi * (10.0**2 - (10.0 - deep + steps / math.tan(math.radians(30.0))) ** 2))
        * half
        / 4000
    )
    # Grooves at 0 (its half is in the bar), -1.5, ... -12.
    assert found.tally.by_tool_mm3[4] == pytest.approx(8.5 * each, rel=2e-3)
    assert bar.radii(-3.001)[0] == pytest.approx(10.0 - deep, abs=0.01)
    assert bar.radii(-3.0 - 0.5 * lead)[0] == 10.0


def test_a_drill_makes_a_bore_and_a_boring_bar_widens_it() -> None:
    bar = Turned(30.0, -40.0, 0.0, 0.02)
    drill = Tool(ToolKind.DRILL, 8.0, angle_deg=118.0)
    found = turned([(0.0, 5.0), (0.0, -25.0)], drill, bar)
    point = 4.0 / math.tan(math.radians(59.0))
    bored = math.pi * 4.0**2 * (25.0 - point) + math.pi * 4.0**2 * point / 3.0
    assert found.tally.by_tool_mm3[4] == pytest.approx(bored, rel=1e-3)
    bar_tool = iso_insert("CCMT060204", inside=True, tip=(1.0, -1.0))
    assert bar_tool is not None
    found = turned([(6.0, 2.0), (6.0, -18.0), (3.0, -18.0), (3.0, 2.0)], bar_tool, bar)
    assert found.tally.contacts.all() == []
    assert bar.radii(-10.01) == pytest.approx((15.0, 6.0), abs=1e-3)
    assert bar.radii(-22.01)[1] == pytest.approx(4.0)
    assert turned([(3.0, 2.0), (5.0, -16.0), (7.0, -16.0)], bar_tool, bar).tally.contacts.all() == []
    [crash] = turned([(3.0, 2.0), (3.0, -16.0), (8.0, -16.0)], bar_tool, bar, rapid=3).tally.contacts.all()
    assert (crash.kind, crash.block) == (ContactKind.RAPID, 12)
    assert crash.depth_mm == pytest.approx(1.0, abs=0.01)


@settings(max_examples=20)
@given(
    st.lists(st.tuples(st.integers(2, 18), st.integers(-25, 4)), min_size=2, max_size=5),
    st.sampled_from(
        [
            SHARP,
            iso_insert("DNMG150404", 93.0),
            iso_insert("RCMT080300"),
            grooving_tool(2.0, 0.3),
        ]
    ),
)
def test_a_way_leaves_what_the_tool_leaves_at_all_of_its_places(
    places: list[tuple[int, int]], tool: Insert
) -> None:
    whole, stamped = Turned(30.0, -30.0, 0.0, 0.25), Turned(30.0, -30.0, 0.0, 0.25)
    turned([(float(x), float(z)) for x, z in places], tool, whole, rapid=0)
    for begin, end in pairwise(np.array(places, np.float64)):
        at = begin + np.linspace(0.0, 1.0, 240)[:, None] * (end - begin) + tool.middle()
        figures = np.zeros((len(at), FIGURES))
        bar = (stamped.first_z, stamped.cell_mm, stamped.outer, stamped.inner)
        sweep_insert(*bar, at, at, tool.outline(), 0.0, True, figures)
    assert np.all(whole.outer <= stamped.outer + 1e-6)
    # Stamps are up to 0.3 mm apart: what stands between them is no higher than that on steep flanks.
    assert np.all(stamped.outer - whole.outer <= 0.35 / math.tan(math.radians(5.0)))


SHAFT = """(T1 CNMG120408 roughing)
(T3 grooving 3 mm)
G21 G18 G40 G99
T0101
G97 S800 M4
G0 X32 Z2
G71 U1.5 R0.5
G71 P10 Q20 U0.4 W0.1 F0.25
N10 G0 X12
G1 Z-20
X20 Z-30
N20 X30
G70 P10 Q20
G0 X40 Z20
T0303
G0 X32 Z-40
G1 X20 F0.1
X32
G0 X40 Z20
M30
"""
PLAIN = "(T1 CNMG120408)\nT1 M6\nG18 G0 X16 Z2\nG1 Z-9 F200\nM30\n"
FAULTS: dict[str, tuple[str, str, list[tuple[ContactKind, int]]]] = {
    "nothing": ("M30", "M30", []),
    "a rapid through the shaft": ("G0 X32 Z-40", "G0 X22 Z-40\nX32", [(ContactKind.RAPID, 16)]),
    "a groove that is fed to at rapid": ("G1 X20 F0.1", "G0 X20 F0.1", [(ContactKind.RAPID, 17)]),
    "a spindle at rest": (
        "T0303\nG0 X32 Z-40\nG1 X20 F0.1",
        "T0303 M5\nG0 X32 Z-40\nG98 G1 X20 F60",
        [(ContactKind.SPINDLE, 17)],
    ),
    "a groove deeper than the blade": (
        "G1 X20 F0.1",
        "G1 X14 F0.1",
        [(ContactKind.HOLDER, 17), (ContactKind.HOLDER, 18)],
    ),
}


@pytest.mark.parametrize(
    ("turns", "left_hand", "wrong"),
    [("M3", False, []), ("M4", False, [4]), ("M3", True, [3, 4]), ("M4", True, [])],
)
def test_what_turns_the_wrong_way_for_a_tool(turns: str, left_hand: bool, wrong: list[int]) -> None:
    """A drill says its way by itself, an insert only where the machine file says that it is left-handed."""
    config = load_machine("lathe2").model_copy(
        update={"tools": {n: ToolConfig(left_hand=left_hand) for n in (1, 5)}}
    )
    text = (
        f"(T1 CNMG120408) (T5 drill 8 mm)\nT0101\nG98 G97 S800 {turns}G0 X26 Z2\nG1 X26 Z-9 F200\n"
        "G0 X60 Z50\nT0505\nG0 X0 Z3\nG1 Z-9 F100\nG0 Z9\nM30\n"
    )
    found = runner.run(
        text, config, "fanuc-lathe", stock="cylinder=30,-60,0", resolution_mm=0.1, check=False
    ).machined
    assert found is not None
    assert [(each.kind, each.line) for each in found.collisions] == [
        (ContactKind.DIRECTION, {3: 4, 4: 8}[each]) for each in wrong
    ]


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found_at_its_block(fault: str) -> None:
    right, wrong, said = FAULTS[fault]
    assert SHAFT.count(right) == 1
    config = load_machine("lathe2").model_copy(
        update={"tools": {3: ToolConfig(width_mm=3.0, radius_mm=0.2, tip=3, flute_mm=6.0)}}
    )
    found = runner.run(
        SHAFT.replace(right, wrong),
        config,
        "fanuc-lathe",
        stock="cylinder=30,-60,0",
        resolution_mm=0.1,
        check=False,
    ).machined
    assert found is not None
    assert [(each.kind, each.line) for each in found.collisions] == said
    if not said:
        assert isinstance(found.stock, Turned)
        assert found.by_tool_mm3[3] == pytest.approx(math.pi * (15.0**2 - 10.0**2) * 3.0, rel=0.01)
        assert found.stock.radii(-15.0)[0] == pytest.approx(6.0, abs=0.002)


def test_auto_is_the_bar_that_the_program_turns() -> None:
    text = "(T1 VNMG160404)\nT1 M6\nS900 M4\nG18 G90 G0 X16 Z0\nG1 X-0.4 F200\nG0 Z2\nX13\nG1 Z-30 F300\nX15\nM30\n"
    found = runner.run(text, "lathe2", "din", stock="auto", check=False)
    assert found.machined is not None
    assert found.machined.messages == ["stock: cylinder of 32 mm from Z-31 to Z0, 0.01 mm a cell"]
    assert found.machined.collisions == []
    assert found.machined.as_dict()["low_mm"] == [-16.0, -16.0, -31.0]


def test_the_surface_of_a_turned_body_is_closed_and_has_its_volume() -> None:
    manifold3d = pytest.importorskip("manifold3d")
    bar = Turned(30.0, -40.0, 0.0, 0.05)
    turned([(0.0, 5.0), (0.0, -25.0)], Tool(ToolKind.DRILL, 8.0, angle_deg=118.0), bar)
    insert = iso_insert("DNMG150404", 93.0, tip=(-1.0, -1.0))
    assert insert is not None
    turned([(9.0, 3.0), (9.0, -7.0), (13.0, -15.0), (17.0, -15.0)], insert, bar)
    turned([(17.0, -33.0), (-0.5, -33.0)], grooving_tool(3.0), bar)  # parted off
    surface = bar.mesh()
    assert surface.volume_mm3 == pytest.approx(bar.volume_mm3, rel=1e-3)
    body: Any = manifold3d.Manifold(
        manifold3d.Mesh(surface.vertices.astype(np.float32), surface.faces.astype(np.uint32))
    )
    assert body.status() == manifold3d.Error.NoError
    assert body.volume() == pytest.approx(bar.volume_mm3, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "corner", "right", "nose"),
    [
        ("CNMG120408", 80.0, 5.0, 0.8),
        ("T2 DNMG 150612 finish", 55.0, 30.0, 1.2),
        ("vbmt160404", 35.0, 50.0, 0.4),
    ],
)
def test_inserts_by_iso_1832(text: str, corner: float, right: float, nose: float) -> None:
    found = iso_insert(text)
    assert found is not None
    assert 180.0 - 95.0 - corner == right
    assert (found.right_deg, found.left_deg, found.nose_mm) == pytest.approx((right, 90.0, nose))


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (lambda: iso_insert("SNMG120408"), "SNMG120408 with an approach of 95"),
        (lambda: grooving_tool(2.0, 1.1), "2 mm wide with corners of 1.1 mm"),
        (lambda: grooving_tool(1e9), "1e\\+09"),
        (lambda: grooving_tool(float("nan")), "nan"),
        (lambda: threading_tool(180.0), "flank of 0 degrees"),
        (lambda: Insert(InsertKind.TURNING, 0.4, 90.0, 5.0, 0.0), "edge of 0 mm"),
        (lambda: Turned(0.0, -3.0, 1.0, 0.1), "no volume"),
        (lambda: Turned(30.0, 1.0, 1.0, 0.1), "no volume"),
        (lambda: Turned(float("nan"), -3.0, 1.0, 0.1), "corner at"),
        (lambda: Turned(30.0, -1e5, 1e5, 0.0011), "181,818,182 cells"),
    ],
)
def test_what_no_lathe_has_is_refused(wrong: Any, text: str) -> None:
    with pytest.raises(UsageError, match=text) as refused:
        wrong()
    assert refused.value.hint


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        ({"stock": "box=0,0,-20,60,42,0"}, "on a lathe"),
        ({"stock": "cylinder=30,-60,0", "fixtures": ["cylinder=0,0,1"]}, "no volume"),
        ({"stock": "cylinder=30,-60,0", "fixtures": ["cylinder=30,0"]}, "'cylinder=30,0' is no body"),
        ({"stock": "cylinder=30,-60,0", "target": "missing.stl"}, "cannot read"),
        ({"stock": "cylinder=-30,-60,0"}, "no volume"),
    ],
)
def test_what_is_not_for_lathes_is_refused(arguments: dict[str, Any], wrong: str) -> None:
    with pytest.raises(UsageError, match=wrong) as refused:
        runner.run(PLAIN, "lathe2", "din", check=False, **arguments)
    assert refused.value.hint


FIXTURE_AT_GROOVE = [(ContactKind.FIXTURE, line) for line in (16, 17, 18, 19)]
CHUCK = "cylinder=80,-70,-41"
AROUND: dict[str, tuple[str, str, str, list[tuple[ContactKind, int]], float]] = {
    "nothing": ("M30", "M30", CHUCK, [], 0.0),
    "a cone too thin by 0.15 mm": ("X20 Z-30", "X19.7 Z-30", CHUCK, [(ContactKind.GOUGE, 13)], 0.0),
    "a groove too deep by 0.1 mm": (
        "G1 X20 F0.1",
        "G1 X19.8 F0.1",
        CHUCK,
        [(ContactKind.GOUGE, 17), (ContactKind.GOUGE, 18)],
        0.0,
    ),
    "a groove not deep enough by 0.1 mm": ("G1 X20 F0.1", "G1 X20.2 F0.1", CHUCK, [], 0.1),
    "a blade beside the chuck": ("M30", "M30", "cylinder=80,-70,-38.5", FIXTURE_AT_GROOVE, 0.0),
    "a blade beside a jaw": ("M30", "M30", "box=20,-5,-70,40,5,-38.5", FIXTURE_AT_GROOVE, 0.0),
}


@pytest.fixture(scope="module")
def shaft(tmp_path_factory: pytest.TempPathFactory) -> str:
    file = tmp_path_factory.mktemp("shaft") / "shaft.stl"
    done = runner.run(SHAFT, "lathe2", "fanuc-lathe", stock="cylinder=30,-60,0", check=False)
    assert done.stock is not None
    done.stock.mesh().write_stl(file)
    return str(file)


@pytest.mark.parametrize("fault", AROUND)
def test_targets_and_fixtures_on_a_lathe(fault: str, shaft: str) -> None:
    right, wrong, fixture, said, rest_mm = AROUND[fault]
    options: dict[str, Any] = {"stock": "cylinder=30,-60,0", "target": shaft, "fixtures": [fixture]}
    found = runner.run(SHAFT.replace(right, wrong), "lathe2", "fanuc-lathe", check=False, **options).machined
    assert found is not None
    assert found.comparison is not None
    assert [(each.kind, each.line) for each in found.collisions] == said
    assert found.comparison.rest_mm == pytest.approx(rest_mm, abs=0.01)
    assert (found.comparison.gouge_mm3 > 0.0) == any(kind is ContactKind.GOUGE for kind, _ in said)


def test_a_drill_too_long_for_the_bore_of_its_target(tmp_path: Path) -> None:
    part = Turned(30.0, -40.0, 0.0, 0.02)
    part.inner[part.z > -25.0] = 4.0
    part.mesh().write_stl(tmp_path / "part.stl")
    for deep, gouges in ((-24.9, []), (-25.5, [11])):
        bar = Turned(30.0, -50.0, 0.0, 0.02)
        drilled = TurningCutting(
            bar, {4: Tool(ToolKind.FLAT, 8.0)}, (), TurnedTarget(tmp_path / "part.stl", bar, 0.02)
        )
        drilled.add(
            Rows(
                np.array([1.0, 2.0]),
                np.array([(0.0, 0.0, 2.0), (0.0, 0.0, deep)]),
                np.array([10, 11]),
                np.full(2, 4),
                np.zeros(2, np.bool_),
                np.full(2, 800.0),
            )
        )
        assert [each.block for each in drilled.tally.contacts.all()] == gouges


def test_an_insert_of_the_machine_file_that_cannot_be_is_refused() -> None:
    for lines, wrong in (
        ('insert = "XYZ"', "an insert 'XYZ'"),
        ("width_mm = 2\nradius_mm = 3", "corners of 3 mm"),
    ):
        config = parse_machine(f"{preset_text('lathe2')}\n[tools.7]\n{lines}\n", "m.toml")
        with pytest.raises(UsageError, match=f"tool 7 of 'lathe2'.*{wrong}"):
            runner.run(SHAFT, config, "fanuc-lathe", stock="cylinder=30,-60,0", check=False)


def test_a_feed_in_the_air_is_not_one_along_what_was_cut() -> None:
    """Back along the cone and out of the bore the tool touches what it has cut; further out it is in the air."""
    text = (
        "(T1 CNMG120408) (T5 drill 8 mm)\nT0101\nG98 G97 S800 M3\nG0 X26 Z2\nG1 X26 Z-9 F200\nZ2\nZ40\n"
        "G0 X60 Z50\nT0505\nG0 X0 Z3\nG1 Z-9 F100\nZ3\nZ30\nG0 Z50\nM30\n"
    )
    found = runner.run(text, "lathe2", "fanuc-lathe", stock="cylinder=30,-60,0", check=False).machined
    assert found is not None
    assert [(each.line, each.place[2]) for each in found.idle] == [(7, 40.0), (13, 30.0)]
