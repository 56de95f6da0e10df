"""Five axes: positions and angles against rotations of scipy, poles, limits, the shortest way, verification."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import scipy

from polycnc.errors import ConfigurationError, ProgramError
from polycnc.post import FiveAxis, Parameters, parse_control, parse_tool_path, shipped_text
from polycnc.post.output._kinematics import Angles, Kinematics
from polycnc.post.tool_path._records import Vector
from polycnc.runner import PostVerification, post_file
from polycnc.runner._post_rotary import PartFrame
from support.post_controls import posted
from support.post_recorder import calls_of, moves_of

Floats = npt.NDArray[np.float64]
X, Y, Z, NUTATING = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, -0.6, 0.8)
LENGTH_MM = 83.5


def axis(
    letter: str, on: str, direction: Vector, point: Vector, limits: tuple[float, float] | None = None
) -> Any:
    """Return a rotary axis as a control file has it."""
    more = {} if limits is None else {"limits_deg": limits}
    return {"letter": letter, "on": on, "direction": direction, "point_mm": point, **more}


def geometry(*axes: Any, **more: Any) -> FiveAxis:
    """Return the axes of a machine."""
    return FiveAxis.model_validate({"axis": axes, **more}, strict=False)


C_TABLE = axis("C", "table", Z, (3.5, -7.25, 0.0))
MACHINES = {
    "trunnion A C": geometry(C_TABLE, axis("A", "table", X, (0.0, 2.75, -61.0))),
    "trunnion B C": geometry(C_TABLE, axis("B", "table", Y, (-4.0, 0.0, -33.0))),
    "nutating table": geometry(C_TABLE, axis("B", "table", NUTATING, (1.5, 2.5, -40.0))),
    "table C head B": geometry(C_TABLE, axis("B", "head", Y, (0.0, 0.0, 121.5))),
    "head C A": geometry(axis("C", "head", Z, (5.0, 11.0, 0.0)), axis("A", "head", X, (0.0, 11.5, 140.25))),
    "head B A": geometry(axis("B", "head", Y, (0.5, 0.0, 90.0)), axis("A", "head", X, (0.0, -1.5, 70.0))),
    "against the sense": geometry(
        axis("C", "table", (0.0, 0.0, -1.0), (3.5, -7.25, 0.0)),
        axis("A", "table", (-2.0, 0.0, 0.0), (0.0, 2.0, -9.0)),
    ),
}


def turn(each: Any, angle_deg: float) -> Any:
    """Return the rotation of an axis by scipy."""
    direction = np.asarray(each.direction) / np.linalg.norm(each.direction)
    return scipy.spatial.transform.Rotation.from_rotvec(direction * math.radians(angle_deg))


def tip_on_part(
    machine: FiveAxis, position: Vector, angles: Angles, length_mm: float
) -> tuple[Floats, Floats]:
    """Return tip and tool axis on the part: the machine put together link by link with scipy's rotations.

    A head hangs the tool below its axes, the last one first; a table takes the part with it, against the count.
    """
    hangs, points = np.array((0.0, 0.0, -length_mm)), np.array(Z)
    for each, angle in reversed(list(zip(machine.axis, angles, strict=True))):
        if each.on == "head":
            rotation = turn(each, angle)
            hangs = rotation.apply(hangs - each.point_mm) + each.point_mm
            points = rotation.apply(points)
    tip = np.asarray(position) + (0.0, 0.0, length_mm) + hangs
    for each, angle in reversed(list(zip(machine.axis, angles, strict=True))):
        if each.on == "table":
            back = turn(each, -angle).inv()
            tip = back.apply(tip - each.point_mm) + each.point_mm
            points = back.apply(points)
    return tip, points


def tool_axes(count: int, seed: int) -> list[Vector]:
    """Return tool axes above the part: any, very near to the pole, and the pole."""
    random = np.random.default_rng(seed)
    leans = np.concatenate(
        (random.uniform(0.02, 1.1, count), 10.0 ** random.uniform(-5.0, -2.0, count // 4), [0.0])
    )
    ways = random.uniform(-math.pi, math.pi, len(leans))
    flat = np.sin(leans)
    return [
        (float(x), float(y), float(z))
        for x, y, z in zip(flat * np.cos(ways), flat * np.sin(ways), np.cos(leans), strict=True)
    ]


@pytest.mark.parametrize("name", MACHINES)
def test_positions_and_angles_bring_the_tool_to_the_point(name: str) -> None:
    machine = MACHINES[name]
    kinematics = Kinematics(machine)
    random = np.random.default_rng(5)
    now: Angles = (17.0, -3.0)
    reached = 0
    for wanted in tool_axes(60, 11):
        tip = tuple(random.uniform(-150.0, 150.0, 3).tolist())
        angles = kinematics.nearest(wanted, now)
        if angles is None:
            assert "nutating" in name  # it turns the tool by 106 degree at most, but not from each side alike
            continue
        reached += 1
        position = kinematics.position(tip, angles, LENGTH_MM)
        found, leaning = tip_on_part(machine, position, angles, LENGTH_MM)
        assert found == pytest.approx(tip, abs=1e-9)
        assert leaning == pytest.approx(wanted, abs=2e-6)
        assert kinematics.axis_of(angles) == pytest.approx(wanted, abs=2e-6)
        # Of the verification, which goes the other way round.
        frame = PartFrame(Parameters(five_axis=machine))
        there = np.array([position]), np.array([angles])
        assert frame.tips(*there, np.array([LENGTH_MM]))[0] == pytest.approx(tip, abs=1e-9)
        assert frame.tool_axes(there[1])[0] == pytest.approx(wanted, abs=2e-6)
        now = angles
    assert reached > 60


@pytest.mark.parametrize("name", MACHINES)
def test_no_other_position_of_the_axes_is_nearer(name: str) -> None:
    machine = MACHINES[name]
    kinematics = Kinematics(machine)
    now: Angles = (131.0, 24.0)
    firsts = np.arange(-720.0, 720.0, 7.5)
    seconds = np.arange(-175.0, 180.0, 5.0)
    grid = np.array([(first, second) for first in firsts for second in seconds])
    leaning = PartFrame(Parameters(five_axis=machine)).tool_axes(grid)
    way = np.abs(grid - now).sum(axis=1)
    for angles, wanted, longest in zip(grid[::977], leaning[::977], way[::977], strict=True):
        found = kinematics.nearest(tuple(wanted.tolist()), now)
        assert found is not None
        costs = sum(abs(a - b) for a, b in zip(found, now, strict=True))
        same = np.linalg.norm(leaning - wanted, axis=1) < 1e-9
        assert costs <= way[same].min() + 1e-6 <= longest + 2e-6, angles


def test_the_pole_leaves_the_first_axis_where_it_is() -> None:
    kinematics = Kinematics(MACHINES["trunnion A C"])
    assert kinematics.nearest(Z, (217.5, 31.0)) == pytest.approx((217.5, 0.0))
    # Six decimals of a CAM system say nothing about a direction.
    assert kinematics.nearest((4e-7, -3e-7, 1.0), (217.5, 31.0)) == pytest.approx((217.5, 0.0), abs=1e-4)
    # Across the pole the tilt changes its sign, and the first axis does not turn round.
    lean = math.sin(math.radians(0.5))
    before = kinematics.nearest((lean, 0.0, math.cos(math.radians(0.5))), (90.0, 0.0))
    assert before == pytest.approx((90.0, 0.5))
    behind = kinematics.nearest((-lean, 0.0, math.cos(math.radians(0.5))), (90.0, 0.5))
    assert behind == pytest.approx((90.0, -0.5))


def limited(first: tuple[float, float] | None, second: tuple[float, float] | None) -> Kinematics:
    """Return a trunnion with limits."""
    return Kinematics(geometry(axis("C", "table", Z, Z, first), axis("A", "table", X, Z, second)))


def test_limits_choose_the_other_position_or_refuse() -> None:
    lean = math.sin(math.radians(20.0)), 0.0, math.cos(math.radians(20.0))
    assert limited(None, None).nearest(lean, (-80.0, -1.0)) == pytest.approx((-90.0, -20.0))
    assert limited(None, (-10.0, 110.0)).nearest(lean, (-80.0, -1.0)) == pytest.approx((90.0, 20.0))
    assert limited(None, (-10.0, 15.0)).nearest(lean, (-80.0, -1.0)) is None
    # C at 350 cannot go on to 370 within its limits, so it unwinds.
    assert limited(None, (-5.0, 110.0)).nearest(lean, (440.0, 20.0)) == pytest.approx((450.0, 20.0))
    assert limited((-360.0, 440.0), (-5.0, 110.0)).nearest(lean, (440.0, 20.0)) == pytest.approx((90.0, 20.0))
    assert limited((-80.0, 80.0), (-5.0, 110.0)).nearest(lean, (0.0, 20.0)) is None


def test_a_tool_axis_beyond_the_machine_is_an_error_with_its_line() -> None:
    five = geometry(axis("C", "table", Z, Z), axis("A", "table", X, Z, (-10.0, 15.0)))
    with pytest.raises(ProgramError, match=r"C and A cannot reach the tool axis 0\.5, 0, 0\.8660") as caught:
        moves_of("RAPID\nGOTO/1,2,3\nGOTO/1,2,3,0.5,0,0.8660254\n", five_axis=five)
    assert caught.value.position is not None
    assert caught.value.position.line == 3


TILTING = (
    "LOADTL/3,LENGTH,83.5\nFEDRAT/600,MMPM\nRAPID\nGOTO/10,20,50\nRAPID\nGOTO/10,20,5,0.3,0.4,0.8660254\n"
    "GOTO/10,20,-1,0.3,0.4,0.8660254\nGOTO/40,22,-2,0.5,0.1,0.8602325\n"
)


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("tolerance_mm", [0.02, 0.001])
def test_between_blocks_the_tip_stays_on_its_line(name: str, tolerance_mm: float) -> None:
    machine = MACHINES[name]
    moves = moves_of(TILTING, five_axis=machine, tolerance_mm=tolerance_mm)
    letters = [each.letter for each in machine.axis]
    rows = np.array([[words[key] for key in ("X", "Y", "Z", *letters)] for _, words in moves], np.float64)
    frame = PartFrame(Parameters(five_axis=machine))
    begin = next(
        place for place, row in enumerate(rows) if frame_tip(frame, row) == pytest.approx((10, 20, -1))
    )
    parts = np.linspace(0.0, 1.0, 9)[:, None]
    ways = [
        first + (last - first) * parts for first, last in zip(rows[begin:-1], rows[begin + 1 :], strict=True)
    ]
    points = np.concatenate(ways)
    tips = frame.tips(points[:, :3], points[:, 3:], np.full(len(points), LENGTH_MM))
    line = np.array((30.0, 2.0, -1.0)) / math.sqrt(905.0)
    away = tips - (10.0, 20.0, -1.0)
    off = np.linalg.norm(away - np.outer(away @ line, line), axis=1)
    assert off.max() <= 1.2 * tolerance_mm
    assert off.max() > 0.05 * tolerance_mm  # no more pieces than are needed
    assert tips[-1] == pytest.approx((40.0, 22.0, -2.0))


def frame_tip(frame: PartFrame, row: Floats) -> Floats:
    """Return where the tip is in a row."""
    tips: Floats = frame.tips(row[None, :3], row[None, 3:], np.array([LENGTH_MM]))[0]
    return tips


def test_the_time_of_a_move_is_that_of_the_tip() -> None:
    machine = MACHINES["trunnion A C"].model_copy(update={"inverse_time": True})
    moves = [words for macro, words in moves_of(TILTING, five_axis=machine) if macro == "LINEAR"]
    assert (moves[0]["FEEDMODE"], moves[0]["F"]) == (94.0, 600.0)
    assert {words["FEEDMODE"] for words in moves[1:]} == {93.0}
    minutes = sum(1.0 / words["F"] for words in moves[1:])
    assert minutes == pytest.approx(math.sqrt(905.0) / 600.0)
    inch = [words for macro, words in moves_of(TILTING, five_axis=machine, units="inch") if macro == "LINEAR"]
    assert inch[-1]["F"] == pytest.approx(moves[-1]["F"])
    assert inch[-1]["X"] == pytest.approx(moves[-1]["X"] / 25.4)


def test_a_turn_about_the_tip_has_the_speed_of_the_control_file() -> None:
    machine = MACHINES["trunnion A C"].model_copy(update={"inverse_time": True, "turning_deg_min": 720.0})
    text = "FEDRAT/600,MMPM\nRAPID\nGOTO/1,2,3\nGOTO/1,2,3,0,-0.5,0.8660254\n"
    moves = [words for macro, words in moves_of(text, five_axis=machine) if macro == "LINEAR"]
    assert sum(1.0 / words["F"] for words in moves) == pytest.approx(30.0 / 720.0)
    with pytest.raises(ProgramError, match="a feed per revolution with inverse time"):
        moves_of(text.replace("600,MMPM", "0.1,MMPR"), five_axis=machine)


def test_a_feed_that_is_not_that_of_the_tip_and_a_large_turn_are_remarked() -> None:
    five = MACHINES["trunnion A C"]
    text = "FEDRAT/600,MMPM\nRAPID\nGOTO/1,2,3,0,-0.5,0.8660254\nGOTO/4,2,3,0.3,-0.4,0.8660254\n"
    found = [remark.text.split(",")[0] for remark in calls_of(text, five_axis=five)[1].remarks]
    assert found == ["the feed of moves that turn the tool axis is that of the machine's axes"]
    wide = text.replace("0.3,-0.4,0.8660254", "-0.5,0.2,0.84261498")
    limited_ = geometry(C_TABLE, axis("A", "table", X, Z, (0.0, 120.0)), inverse_time=True)
    found = [remark.text for remark in calls_of(wide, five_axis=limited_)[1].remarks]
    assert found == ["a feed move turns a rotary axis by more than 90 degree"]


def test_a_head_needs_the_length_of_this_very_tool() -> None:
    head = MACHINES["head C A"]
    with pytest.raises(ProgramError, match="the head turns a tool whose length is not known"):
        moves_of(TILTING.replace(",LENGTH,83.5", ""), five_axis=head)
    with pytest.raises(ProgramError, match="the head turns a tool whose length is not known"):
        moves_of("LOADTL/2,LENGTH,60\n" + TILTING.replace(",LENGTH,83.5", ""), five_axis=head)
    assert moves_of(TILTING, five_axis=head)


def test_a_control_that_follows_the_tip_gets_the_tip() -> None:
    five = MACHINES["table C head B"].model_copy(update={"output": "tip"})
    last = moves_of(TILTING.replace(",LENGTH,83.5", ""), five_axis=five)[-1][1]
    assert (last["X"], last["Y"], last["Z"]) == (40.0, 22.0, -2.0)
    assert (last["TOOLI"], last["TOOLJ"], last["TOOLK"]) == pytest.approx((0.5, 0.1, 0.8602325), abs=1e-6)
    assert last["C"] == pytest.approx(math.degrees(math.atan2(0.1, 0.5)), abs=1e-4)
    assert last["B"] == pytest.approx(math.degrees(math.acos(0.8602325)), abs=1e-4)


def test_arcs_and_cycles_stay_only_where_the_part_is_not_turned() -> None:
    five = MACHINES["trunnion A C"]
    part = (
        "CIRCLE/10,25,5,0,0,1,5\nGOTO/10,30,5\nCYCLE/DRILL,DEPTH,5,CLEAR,2\nGOTO/6,7,0\nCYCLE/OFF\n"
    )  # fmt: skip
    begin = "FEDRAT/600,MMPM\nRAPID\nGOTO/10,20,5\n"
    assert {macro for macro, _ in moves_of(begin + part, five_axis=five)} >= {"ARC_CCW", "CYCLE_DRILL"}
    # Upright again, but the table stays turned.
    turned = begin + "GOTO/10,20,5,0.3,0.4,0.8660254\nGOTO/10,20,5,0,0,1\n" + part
    moves = moves_of(turned, five_axis=five)
    assert {macro for macro, _ in moves} == {"RAPID", "LINEAR"}
    frame = PartFrame(Parameters(five_axis=five))
    rows = np.array([[words[key] for key in ("X", "Y", "Z", "C", "A")] for _, words in moves], np.float64)
    tips = frame.tips(rows[:, :3], rows[:, 3:], np.zeros(len(rows)))
    assert np.min(np.linalg.norm(tips - (6.0, 7.0, -5.0), axis=1)) < 1e-9


@pytest.mark.parametrize(
    ("axes", "more", "said"),
    [
        ((C_TABLE, axis("C", "table", X, Z)), {}, "both axes are C"),
        ((axis("B", "head", Y, Z), axis("A", "table", X, Z)), {}, "the head comes before the table"),
        ((C_TABLE, axis("A", "table", (0.0, 0.0, 3.0), Z)), {}, "the second axis does not tilt the tool"),
        ((C_TABLE, axis("A", "table", (0.0, 0.0, 0.0), Z)), {}, "the direction has no length"),
        ((C_TABLE, axis("A", "table", X, Z, (10.0, 90.0))), {}, "the limits do not lie on both sides of 0"),
        ((C_TABLE,), {}, "axis"),
    ],
)
def test_axes_that_cannot_be_are_refused(axes: Any, more: dict[str, Any], said: str) -> None:
    text = "[parameters.five_axis]\n"
    for each in axes:
        text += "[[parameters.five_axis.axis]]\n"
        text += "".join(
            f"{key} = {list(v) if isinstance(v, tuple) else repr(v)}\n" for key, v in each.items()
        )
    with pytest.raises(ConfigurationError, match=said):
        parse_control(text + "[nc_macros]\nSTOP = 'X'\n")


def test_two_ways_to_say_the_rotary_axes_are_refused() -> None:
    text = shipped_text("fanuc-5axis").replace("decimals = 4", 'decimals = 4\nrotary = "vector"')
    with pytest.raises(ConfigurationError, match="'rotary' and 'five_axis' say the same"):
        parse_control(text)


def test_without_rotary_axes_nothing_changes() -> None:
    blocks, _ = posted("FEDRAT/600,MMPM\nRAPID\nGOTO/1,2,3\nGOTO/4,2,3\n")
    assert blocks[-3:-1] == ["G00X1.000Y2.000Z3.000", "G01X4.000F600.000"]


VERIFIED = (
    "LOADTL/3\nSPINDL/RPM,900,CLW\nFEDRAT/1500,MMPM\nRAPID\nGOTO/10,20,50\nRAPID\nGOTO/10,20,5,0.3,0.4,0.8660254\n"
    "GOTO/10,20,3,0.3,0.4,0.8660254\nGOTO/14,22,2.5,0.35,0.38,0.8562126\nGOTO/14,22,2.5,0.36,0.3,0.8833459\nFINI\n"
)


def verification(*changes: tuple[str, str]) -> PostVerification:
    """Return the verification of a tilted path with the control file of five axes, changed."""
    text = shipped_text("fanuc-5axis")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    proof = post_file(parse_tool_path(VERIFIED, "part.cl"), parse_control(text), verify=True).verification
    assert proof is not None
    assert not proof.run.alarms
    return proof


def test_a_right_program_of_five_axes_is_verified() -> None:
    proof = verification()
    assert proof.ok
    assert proof.compared == "X Y Z, tool axis by C and A, tip by the geometry of the control file"
    assert 0.0 < proof.tool_axis_deg < 1e-3
    moved = verification(("point_mm = [0, 0, 0]", "point_mm = [12.5, -8.25, -31.5]"))
    assert moved.ok
    tip = verification(
        ('output = "machine"', 'output = "tip"'), ("inverse_time = true", "inverse_time = false")
    )
    assert tip.ok
    assert tip.compared == "X Y Z, tool axis by C and A"


@pytest.mark.parametrize(
    "change",
    {
        "an axis counts the other way": ('A = { format = "A%.4f"', 'A = { scale = -1.0, format = "A%.4f"'),
        "an axis is left out": ("$Z$$A$$C$$F$", "$Z$$A$$F$"),
        "an axis has no decimals": ('C = { format = "C%.4f", zeros = "point"', 'C = { format = "C%d."'),
    }.items(),
    ids=lambda each: each[0],
)
@pytest.mark.parametrize("output", ["machine", "tip"])
def test_a_wrong_rotary_axis_is_found(change: tuple[str, tuple[str, str]], output: str) -> None:
    proof = verification(change[1], ('output = "machine"', f'output = "{output}"'))
    assert not proof.ok
    assert proof.tool_axis_deg > 0.05
    assert 6 <= proof.tool_axis_line <= 10
    assert (proof.deviation_mm > proof.tolerance_mm) is (output == "machine")


SWIVEL = Path(__file__).parents[2] / "examples" / "swivel_head.toml"


def head_proof(*changes: tuple[str, str], path: str = VERIFIED) -> PostVerification:
    """Return the verification on the example machine, with the axes that its file tells to write, changed."""
    axes = "\n".join(
        line[4:] for line in SWIVEL.read_text().splitlines() if line == "#" or line.startswith("#   ")
    )
    shipped = shipped_text("fanuc-5axis")
    begin, end = shipped.index("[[parameters.five_axis.axis]]"), shipped.index("[nc_code]")
    macros = re.sub(
        r"\$A\$|&A&|\bA(?= = \{)|(?<=\")A(?=%)| A0", lambda found: found[0].replace("A", "B"), shipped[end:]
    )
    text = f"{shipped[:begin]}{axes}\n\n{macros}"
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    tool_path = parse_tool_path(path.replace("LOADTL/3", "LOADTL/3,LENGTH,95"), "part.cl")
    proof = post_file(tool_path, parse_control(text), verify=True, machine=str(SWIVEL)).verification
    assert proof is not None
    assert not proof.run.alarms
    return proof


def test_a_program_for_a_swivelling_head_is_verified_on_its_machine() -> None:
    proof = head_proof()
    assert proof.ok
    assert proof.compared == "X Y Z, tool axis by C and B, tip by the geometry of the machine"
    assert 0.0 < proof.tool_axis_deg < 1e-3


@pytest.mark.parametrize("pivot_mm", [179.5, 100.0])
def test_a_wrong_pivot_length_is_found(pivot_mm: float) -> None:
    proof = head_proof(("point_mm = [0, 0, 180]", f"point_mm = [0, 0, {pivot_mm}]"))
    assert not proof.ok
    # The tool leans by up to 31.1 degree, and its pivot is off along it.
    lean = math.acos(0.8562126)
    assert proof.deviation_mm == pytest.approx(2.0 * (180.0 - pivot_mm) * math.sin(0.5 * lean), rel=0.05)
    assert proof.tool_axis_deg < 1e-3


def test_a_head_that_counts_the_other_way_is_found() -> None:
    proof = head_proof(("direction = [0, 1, 0]", "direction = [0, -1, 0]"))
    assert not proof.ok
    assert proof.tool_axis_deg > 5.0


def test_the_ring_is_posted_for_the_head_too() -> None:
    ring = (SWIVEL.parent / "ring.cl").read_text()
    proof = head_proof(path=ring.replace("LOADTL/4,LENGTH,95", "LOADTL/3"))
    assert proof.ok


@pytest.mark.parametrize(
    ("rotary", "letter", "axis"),
    [
        (
            "ac_table",
            "A",
            lambda tilt, turn: (np.sin(tilt) * np.sin(turn), -np.sin(tilt) * np.cos(turn), np.cos(tilt)),
        ),
        (
            "bc_table",
            "B",
            lambda tilt, turn: (np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)),
        ),
    ],
)
def test_two_turning_tables_lean_the_tool_over_the_part(
    rotary: str, letter: str, axis: Callable[..., object]
) -> None:
    frame = PartFrame(Parameters.model_validate({"rotary": rotary}))
    assert frame.letters == ("C", letter)
    assert frame.compared.startswith(f"X Y Z, tool axis by C and {letter}")
    turns, tilts = np.array([0.0, 37.0, -110.0, 190.0]), np.array([0.0, 23.0, -61.0, 90.0])
    for turn, tilt, found in zip(turns, tilts, frame.tool_axes(np.column_stack((turns, tilts))), strict=True):
        assert found == pytest.approx(axis(np.radians(tilt), np.radians(turn)), abs=1e-12)
