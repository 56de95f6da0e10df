"""Verification: distances from lines and arcs, and every kind of wrong program is found."""

from __future__ import annotations

import math
import random
import re
from pathlib import Path

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.machine import MachineConfig, ToolConfig, load_machine
from polycnc.nc import ProgramText
from polycnc.post import (
    BlockMap,
    ControlFile,
    Sweep,
    parse_control,
    parse_tool_path,
    shipped_text,
    sweep_tool_path,
)
from polycnc.post.output._program import post_program
from polycnc.runner import PostResult, PostVerification, post_file, run
from polycnc.runner._post_geometry import Moves
from polycnc.runner._verify_post import verify_post
from support.often import share
from support.post_controls import control

TRIANGLE = "FROM/0,0,0\nRAPID\nGOTO/0,0,5\nFEDRAT/3000\nGOTO/10,0,0\nGOTO/10,10,0\nGOTO/0,0,0\nFINI\n"
ROUND = (
    "FROM/10,0,0\nRAPID\nGOTO/10,0,0\nFEDRAT/3000\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\nGOTO/0,20,0\nFINI\n"
)


def moves_of(*sweeps: Sweep) -> Moves:
    """Return moves, one for each record."""
    return Moves(sweeps, len(sweeps))


def distance(moves: Moves, *point: float) -> float:
    """Return how far a point lies from the first move."""
    return float(moves.distances(np.array([point], np.float64), np.zeros(1, np.int64))[0])


def test_distance_from_a_line() -> None:
    line = moves_of(Sweep(0, 1, False, (0.0, 0.0, 0.0), (10.0, 0.0, 0.0)))
    assert distance(line, 5.0, 3.0, 4.0) == pytest.approx(5.0)
    assert distance(line, 13.0, 4.0, 0.0) == pytest.approx(5.0)
    assert distance(line, -3.0, 0.0, 0.0) == pytest.approx(3.0)
    point = moves_of(Sweep(0, 1, False, (1.0, 1.0, 1.0), (1.0, 1.0, 1.0)))
    assert distance(point, 1.0, 1.0, 3.0) == pytest.approx(2.0)


def test_distance_from_an_arc() -> None:
    center, up = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    arc = moves_of(Sweep(0, 1, False, (10.0, 0.0, 0.0), (0.0, 10.0, 0.0), center, up, 0.5 * math.pi))
    assert distance(arc, 8.0, 6.0, 0.0) == pytest.approx(0.0, abs=1e-12)
    assert distance(arc, 16.0, 12.0, 0.0) == pytest.approx(10.0)
    assert distance(arc, 6.0, 8.0, 3.0) == pytest.approx(3.0)
    # Behind the end of the arc it is the end that counts, on the circle too.
    assert distance(arc, -10.0, 0.0, 0.0) == pytest.approx(math.hypot(10.0, 10.0))
    assert distance(arc, 10.0, -1.0, 0.0) == pytest.approx(1.0)


def test_distance_from_a_helix() -> None:
    center, up = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    helix = moves_of(Sweep(0, 1, False, (10.0, 0.0, 0.0), (10.0, 0.0, -6.0), center, up, 6.0 * math.pi))
    assert distance(helix, 10.0, 0.0, -2.0) == pytest.approx(0.0, abs=1e-12)
    assert distance(helix, 0.0, 10.0, -4.5) == pytest.approx(0.0, abs=1e-12)
    lead = math.atan2(6.0, 60.0 * math.pi)
    assert distance(helix, 0.0, 10.0, -4.6) == pytest.approx(0.1 * math.cos(lead), rel=1e-4)
    # A steep one: off by a hundredth across, not by what that is in height.
    steep = moves_of(Sweep(0, 1, False, (10.0, 0.0, 0.0), (0.0, 10.0, 300.0), center, up, 0.5 * math.pi))
    assert distance(steep, 0.99 * math.sqrt(50.0), 0.99 * math.sqrt(50.0), 150.0) == pytest.approx(0.1)
    across = 300.0 / math.hypot(300.0, 5.0 * math.pi)
    assert distance(steep, 10.0, 0.01, 0.0) == pytest.approx(0.01 * across, rel=1e-5)
    feed_mm, rapid_mm = helix.length_mm()
    assert feed_mm == pytest.approx(math.hypot(60.0 * math.pi, 6.0))
    assert rapid_mm == 0.0


def test_witnesses_lie_on_their_moves() -> None:
    sweeps = list(sweep_tool_path(parse_tool_path(ROUND)))
    moves = Moves(sweeps, 8)
    owner, points = moves.witnesses()
    assert owner is not None
    assert np.bincount(owner).tolist() == [1, 8, 1]
    assert moves.distances(points, owner) == pytest.approx(np.zeros(10), abs=1e-12)


def test_moves_of_a_hole_are_what_the_cycle_means() -> None:
    text = "FROM/0,0,9\nCYCLE/DEEP,DEPTH,10,STEP,2,CLEAR,3,RETURN,5\nGOTO/4,0,0\nCYCLE/OFF\nGODLTA/0,0,1\nGOHOME\n"
    found = [(move.record, move.rapid, move.end) for move in sweep_tool_path(parse_tool_path(text))]
    assert found == [
        (2, True, (4.0, 0.0, 9.0)),
        (2, True, (4.0, 0.0, 5.0)),
        (2, True, (4.0, 0.0, 3.0)),
        (2, False, (4.0, 0.0, -10.0)),
        (2, True, (4.0, 0.0, 5.0)),
        (4, False, (4.0, 0.0, 6.0)),
        (5, True, (0.0, 0.0, 9.0)),
    ]


def verified(text: str, used: ControlFile, tolerance_mm: float = 1e-3) -> PostResult:
    """Return the result of posting and verifying a text."""
    return post_file(parse_tool_path(text, "part.cl"), used, verify=True, tolerance_mm=tolerance_mm)


@pytest.mark.parametrize("text", [TRIANGLE, ROUND])
def test_a_right_program_is_proven(text: str) -> None:
    result = verified(text, control())
    proof = result.verification
    assert proof is not None
    assert result.ok
    assert proof.deviation_mm < 1e-4
    assert proof.run.cutting_path_mm == pytest.approx(proof.path_feed_mm, abs=1e-6)
    assert result.text is not None
    assert result.text.endswith("M30\n")


WRONG: dict[str, tuple[str, dict[str, str], float]] = {
    "a coordinate is scaled": (TRIANGLE, {"LINEAR": "<X=X*1.001>!-G01!$X$$Y$$Z$$F$"}, 0.01),
    "an axis is left out": (TRIANGLE, {"LINEAR": "!-G01!$X$$Z$$F$"}, 10.0),
    # Its middle, at 225 degree, is as far from one end of the right arc as from the other.
    "the arc turns the wrong way": (
        ROUND,
        {"ARC_CCW": "!-G17!!-G02!$X$$Y$$I$$J$$F$"},
        20.0 * math.sin(math.radians(67.5)),
    ),
    "the arc is a line": (ROUND, {"ARC_CCW": "!-G01!$X$$Y$$Z$$F$"}, 10.0 - 10.0 / math.sqrt(2.0)),
    "the modal position is stale": (
        TRIANGLE,
        {"LINEAR": "IF(X==10 && Y==10)\n!*G01!<Y=0>\nELSE\n!-G01!$X$$Y$$Z$$F$\nENDIF"},
        10.0,
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_program_is_found(name: str) -> None:
    text, macros, deviation = WRONG[name]
    result = verified(text, control(macros=macros))
    proof = result.verification
    assert proof is not None
    assert not result.ok
    assert proof.run.ok
    assert proof.deviation_mm == pytest.approx(deviation, rel=0.02)


def test_the_place_of_a_deviation_is_named() -> None:
    text = TRIANGLE.replace("GOTO/10,10,0", "GOTO/10,10,0\nPPRINT here")
    used = control(macros={"LINEAR": "IF(Y==10)\n<X=X+0.5>\nENDIF\n!-G01!$X$$Y$$Z$$F$"})
    proof = verified(text, used).verification
    assert proof is not None
    assert proof.off_path.mm == pytest.approx(0.5, rel=1e-3)
    assert proof.missed.mm == pytest.approx(0.5, abs=0.01)
    assert (proof.missed.line, proof.missed.point) == (6, (10.0, 10.0, 0.0))
    # In the program: the block after %, G90..., G21, G00 and G01, and the one after it, which leaves from there.
    assert proof.missed.block in (6, 7, 8)
    assert proof.off_path.line in (6, 8)


def test_a_rapid_where_feed_was_meant_is_found() -> None:
    used = control(macros={"LINEAR": "!-G00!$X$$Y$$Z$"})
    result = verified(TRIANGLE, used)
    assert result.verification is not None
    assert result.verification.deviation_mm < 1e-3
    assert result.verification.rapid_cuts == 3
    assert not result.ok


def test_rapids_may_leave_the_straight_line() -> None:
    used = control(macros={"RAPID": "!-G00!$Z$\n!-G00!$X$$Y$"})
    result = verified("FROM/0,0,0\nRAPID\nGOTO/3,0,4\nRAPID\nGOTO/0,0,0\nFINI\n", used)
    assert result.verification is not None
    assert result.ok
    assert result.verification.detour_mm == pytest.approx(2.4, abs=0.01)


def test_a_program_that_the_control_refuses_is_not_proven() -> None:
    used = control(macros={"LINEAR": "!-G01!$X$$Y$$Z$"})
    proof = verified(TRIANGLE, used).verification
    assert proof is not None
    assert not proof.ok
    assert "a feed move without a feed" in str(proof.run.alarms[0])
    assert proof.as_dict()["alarms"]


def test_decimals_too_few_are_found() -> None:
    text = "FROM/0,0,0\nFEDRAT/3000\nGOTO/1.234,0,0\nGOTO/5,5.678,0\nFINI\n"
    assert verified(text, control({}, decimals=3)).ok
    proof = verified(text, control({}, decimals=1)).verification
    assert proof is not None
    assert proof.deviation_mm == pytest.approx(math.hypot(0.034, 0.0), abs=0.01)


def test_positions_that_do_not_change_in_the_program_count() -> None:
    # 0.0004 mm is below the decimals: nothing is written, and the machine stands 0.0004 mm off.
    proof = verified("FROM/0,0,0\nFEDRAT/3000\nGOTO/1,0,0\nGOTO/1.0004,0,0\nFINI\n", control()).verification
    assert proof is not None
    assert proof.missed.mm == pytest.approx(0.0004, abs=1e-4)


def test_a_character_that_the_encoding_lacks(tmp_path: Path) -> None:
    used = control({"encoding": "ascii"})
    with pytest.raises(ProgramError, match="cannot be written in ascii"):
        post_file(parse_tool_path("PPRINT Grün\n"), used, tmp_path / "part.nc")
    assert list(tmp_path.iterdir()) == []


# A plate on a real machine: its zero at 100, 50, -300, and a tool of 120 mm, whose gauge line is what the axes move.
OFFSETS = {"G54": {"X": 100.0, "Y": 50.0, "Z": -300.0}}
TOOLS = {3: ToolConfig(length_mm=120.0, radius_mm=4.0)}
PLATE = "LOADTL/3\nSPINDL/RPM,900,CLW\nRAPID\nGOTO/7,3,30\nFEDRAT/900\nGOTO/7,3,-2\nGOTO/37,3,-2\nRAPID\nGOTO/37,3,30\n"


def real_machine(**changed: object) -> MachineConfig:
    """Return a mill as it stands in a workshop, with travels that PLATE fits into when it is set up right."""
    mill = load_machine("mill3")
    limits = {"X": (0.0, 500.0), "Y": (0.0, 400.0), "Z": (-200.0, 0.0)}
    axes = tuple(axis.model_copy(update={"soft_limits_mm": limits[axis.name]}) for axis in mill.axes)
    return mill.model_copy(update={"axes": axes, "offsets": OFFSETS, "tools": TOOLS, **changed})


def on(machine: MachineConfig, program: str = "fanuc-mill", text: str = PLATE) -> PostVerification:
    """Return the proof of a plate on a machine."""
    used: str | ControlFile = program
    if program != "fanuc-mill":
        old, new = program.split("|")
        used = parse_control(shipped_text("fanuc-mill").replace(old, new), "mine.toml")
    proof = post_file(parse_tool_path(text, "plate.cl"), used, verify=True, machine=machine).verification
    assert proof is not None
    return proof


def test_the_proof_is_on_the_machine_as_it_stands() -> None:
    machine = real_machine()
    proof = on(machine)
    assert proof.run.alarms == []
    assert proof.deviation_mm < 1e-4
    assert proof.ok
    low = proof.run.extents_mm["Z"][0]
    assert low == pytest.approx(-300.0 + 120.0 - 2.0)  # the real run: zero, tool length, depth
    assert proof.run.extents_mm["X"][1] == pytest.approx(137.0)
    result = post_file(parse_tool_path(PLATE, "plate.cl"), "fanuc-mill")
    assert result.text is not None
    real = run(result.text, machine, "fanuc")
    assert (proof.run.time_s, proof.run.cycles) == (real.time_s, real.cycles)


def test_a_part_that_the_machine_cannot_reach_is_no_proof() -> None:
    short = {3: ToolConfig(length_mm=20.0)}
    proof = on(real_machine(tools=short))
    assert not proof.ok
    assert "Z" in str(proof.run.alarms[0])


def test_a_length_that_is_not_compensated_is_found() -> None:
    proof = on(real_machine(offsets={"G54": {"X": 100.0, "Y": 50.0, "Z": -100.0}}), "!G43!$H$$Z$|$Z$")
    assert proof.run.alarms == []
    assert not proof.ok
    assert proof.off_path.mm == pytest.approx(120.0, rel=1e-3)


@pytest.mark.parametrize("name", ["din", "fanuc-mill"])
def test_a_move_that_rounds_to_nothing_in_fast_motion_is_no_deviation(name: str) -> None:
    points = ("10,0", "10.0003,0", "50,0", "50.0002,0.0003", "50,40", "50,40.0002")
    text = "FEDRAT/6000,MMPM\nGOTO/0,0,-1\n" + "".join(f"GOTO/{point},-1\n" for point in points)
    proof = post_file(
        parse_tool_path("LOADTL/1\nSPINDL/RPM,9000,CLW\n" + text), name, verify=True
    ).verification
    assert proof is not None
    assert proof.ok
    assert proof.deviation_mm < 5e-4


def coarse(name: str, decimals: int, units: str, radius: bool) -> ControlFile:
    """Return a shipped control file with other decimals, and with R in place of the centres of arcs."""
    text = shipped_text(name).replace("decimals = 3", f'decimals = {decimals}\nunits = "{units}"')
    text = text.replace("%.3f", f"%.{decimals}f")
    for center in ("$I$$J$", "$I$$K$", "$J$$K$") if radius else ():
        text = text.replace(center, "&R&$R$")
    return parse_control(text, "mine.toml")


@pytest.mark.parametrize(
    ("name", "decimals", "units", "radius", "arcs_left"),
    [
        ("fanuc-mill", 3, "mm", False, 60),
        ("grbl", 2, "inch", False, 42),
        ("linuxcnc-mill", 1, "mm", False, 40),
        ("fanuc-mill", 3, "inch", False, 48),
        ("fanuc-mill", 2, "inch", True, 22),
    ],
)
def test_arcs_are_written_so_that_the_control_takes_them(
    name: str, decimals: int, units: str, radius: bool, arcs_left: int
) -> None:
    # Of every size and sweep, whole turns and what rounds to them or to nothing among them: 60.
    chance = random.Random(5)
    lines = ["LOADTL/1", "SPINDL/RPM,9000,CLW", "FEDRAT/6000,MMPM", "GOTO/0,0,-1"]
    x = y = 0.0
    for _ in range(60):
        size, begin = chance.choice((0.4, 10.0 ** chance.uniform(-0.5, 1.3))), chance.uniform(0.0, math.tau)
        sense, turn = chance.choice((-1, 1)), chance.choice((chance.uniform(0.05, 6.0), 0.5, 6.27, math.tau))
        center = x - size * math.cos(begin), y - size * math.sin(begin)
        x, y = (c + size * f(begin + sense * turn) for c, f in zip(center, (math.cos, math.sin), strict=True))
        lines.append(f"CIRCLE/{center[0]:.6f},{center[1]:.6f},-1,0,0,{sense},{size:.6f}")
        lines.append(f"GOTO/{x:.6f},{y:.6f},-1")
    path = parse_tool_path("\n".join(lines) + "\n")
    result = post_file(path, coarse(name, decimals, units, radius), verify=True)
    proof = result.verification
    assert proof is not None
    assert proof.run.alarms == []
    assert result.text is not None
    arcs = re.findall(r"^[^(\n]*[IJR]-?[0-9]", result.text, re.MULTILINE)
    assert len(arcs) == arcs_left
    unit_mm = 10.0**-decimals * (25.4 if units == "inch" else 1.0)
    assert proof.deviation_mm <= proof.tolerance_mm == pytest.approx(1.25 * unit_mm)
    assert proof.run.cutting_path_mm == pytest.approx(proof.path_feed_mm, rel=0.01 + unit_mm)


@pytest.mark.parametrize(
    ("decimals", "units", "tolerance_mm"), [(4, "mm", 0.001), (2, "mm", 0.0125), (4, "inch", 0.003175)]
)
def test_without_a_tolerance_it_is_what_rounding_may_cost(
    decimals: int, units: str, tolerance_mm: float
) -> None:
    path = parse_tool_path("FEDRAT/900,MMPM\nGOTO/1,2,-1\nGOTO/3,4,-1\n")
    shipped = shipped_text("din").replace("decimals = 3", f'decimals = {decimals}\nunits = "{units}"')
    proof = post_file(path, parse_control(shipped, "mine.toml"), verify=True).verification
    assert proof is not None
    assert proof.tolerance_mm == pytest.approx(tolerance_mm)


@pytest.mark.parametrize(
    ("decimals", "units", "feed", "turn"),
    [(3, "mm", 30000, 0), (4, "mm", 700, 1), (4, "inch", 6000, 2), (2, "mm", 6000, 3)],
)
def test_each_wrong_digit_of_a_point_is_found_and_no_smaller_one(
    decimals: int, units: str, feed: int, turn: int
) -> None:
    # Sharp corners everywhere, moves of a few units among them, an arc: each position is where something turns.
    text = (
        f"FROM/0,0,35\nRAPID\nGOTO/3.1415,-7.2718,5.1234\nFEDRAT/{feed}\nGOTO/3.1415,-7.2718,-1.4142\n"
        "GOTO/13.6271,4.1873,-2.6457\nGOTO/13.5771,4.2573,-2.6957\nGOTO/-8.3166,9.9498,-2.6957\n"
        "CIRCLE/-8.3166,3.9498,-2.6957,0,0,1,6\nGOTO/-14.3166,3.9498,-2.6957\nRAPID\n"
        "GOTO/2.2360,1.7320,8.6602\nFINI\n"
    )
    shipped = shipped_text("din").replace("%.3f", f"%.{decimals}f")
    used = parse_control(
        shipped.replace("decimals = 3", f'decimals = {decimals}\nunits = "{units}"'), "mine.toml"
    )
    path, blocks, pieces = parse_tool_path(text), BlockMap(), list[str]()
    post_program(path, used, pieces.append, block_map=blocks)
    program = "".join(pieces)

    def proof(changed: str) -> PostVerification:
        parameters = used.parameters
        written = ProgramText.from_text(changed, "part.nc")
        return verify_post(
            written, path, blocks, parameters.machine, parameters.dialect, parameters=parameters
        )

    right = proof(program)
    assert right.ok
    unit_mm = 10.0**-decimals * (25.4 if units == "inch" else 1.0)
    wrong = math.ceil(2.0 * right.tolerance_mm / unit_mm)  # rounding has taken up to one tolerance
    for place, found in enumerate(re.finditer(r"[XYZ](-?[0-9]+\.[0-9]+)", program)):
        if place % 4 != turn and share(2) == 1:
            continue
        for units_off in (wrong, *((1,) if 3.0 * unit_mm < right.tolerance_mm else ())):
            value = float(found[1]) + units_off * 10.0**-decimals * (1 if place % 2 else -1)
            changed = f"{program[: found.start(1)]}{value:.{decimals}f}{program[found.end(1) :]}"
            assert proof(changed).ok == (units_off == 1), (found[0], value)
