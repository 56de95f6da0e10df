"""Random programs through polycnc and through LinuxCNC's `rs274`: the same moves, the same refusals.

Where the two read a block differently on purpose, it stands in a table below and is tested as such.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.kernel import give_to_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, Dialect, ProgramText, load_dialect
from support import rs274
from support.canonical import Feed, Step, first_difference, queued_steps
from support.often import often, share
from support.random_programs import AXES, Block, Program, random_program

pytestmark = pytest.mark.skipif(rs274.COMMAND is None, reason="rs274 (LinuxCNC) is not installed")

TOLERANCE_MM = 1e-6
CHIP_MM = 0.254  # how far LinuxCNC backs up in G73 and G83

# A known state, whatever a program has done before.
SETTLED = (
    "G80 G40 G49 G21 G90 G17 G94 G98 G91.1",
    "G92.1",
    "M3 S1000 F100",
    "G0 X0 Y0 Z0 A0 B0 C0",
)


def machine_config() -> MachineConfig:
    """Return a machine without limits that has the first six axes of LinuxCNC."""
    text = 'name = "endless"\n'
    for name in "XYZ":
        text += f'[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 2000\n'
    for name in "ABC":
        text += f'[[axis]]\nname = "{name}"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 900\n'
    return validate(MachineConfig, *parse_toml(text, "endless.toml"))


CONFIG = machine_config()


def dialect(scale: int) -> Dialect:
    """Return DIN with LinuxCNC's amounts of retreat, for a program that rs274 gets `scale` times as large."""
    din = load_dialect("din")
    amount = CHIP_MM / scale
    return din.model_copy(
        update={"cycles": din.cycles.model_copy(update={"chip_break_mm": amount, "reentry_mm": amount})}
    )


def prepare(
    program: str, *, scale: int = 1, block_delete: bool = False
) -> tuple[list[Step], ProgramError | None]:
    """Return what polycnc queues for a program, and what it refuses."""
    machine = Machine(CONFIG, segments=1 << 12)
    skip = frozenset({1} if block_delete else ())
    channel = Channel(ProgramText.from_text(program), dialect(scale), machine, skip_levels=skip)
    give_to_path(machine.state, channel.path)
    channel.fill()
    assert channel.done
    return queued_steps(machine, channel), channel.error


def compare(seed: int, folder: Path) -> str:
    """Return how a random program differs between the two; '' if it does not."""
    program = random_program(seed)
    block_delete = seed % 2 == 1
    theirs = rs274.interpret(program.text(rs274.SCALE), folder, block_delete=block_delete)
    ours, error = prepare(program.text(), scale=rs274.SCALE, block_delete=block_delete)
    if error is not None or theirs.error:
        return f"seed {seed}: refused\n  ours   {error}\n  theirs {theirs.error}: {theirs.block}"
    found = first_difference(ours, rs274.canonical_steps(theirs, len(AXES)), TOLERANCE_MM)
    return f"seed {seed}: {found}\n{program.text()}" if found else ""


@pytest.mark.parametrize("first", often(range(0, 400, 50), 1))
def test_random_programs_ask_for_the_same_moves(first: int, tmp_path: Path) -> None:
    found = [text for seed in range(first, first + share(50)) if (text := compare(seed, tmp_path))]
    assert not found, "\n\n".join(found[:2])


@pytest.mark.long
@pytest.mark.parametrize("first", range(10_000, 14_000, 500))
def test_many_random_programs_ask_for_the_same_moves(first: int, tmp_path: Path) -> None:
    found = [text for seed in range(first, first + 500) if (text := compare(seed, tmp_path))]
    assert not found, "\n\n".join(found[:2])


def test_random_programs_say_enough() -> None:
    """The comparison is only worth what the programs hold: each kind of step, units, planes, modes."""
    texts = [random_program(seed).text().upper().replace("+", "").replace("G0", "G") for seed in range(60)]
    words = {f"G{code}" for code in (1, 2, 3, 4, 17, 18, 19, 20, 21, 28, 53, 73, 80, 83, 92, 93, 95, 98, 99)}
    together = "\n".join(texts)
    assert not [word for word in words if word not in together]
    kinds: dict[str, int] = {}
    for seed in range(10):
        steps, error = prepare(random_program(seed).text(), scale=rs274.SCALE)
        assert error is None
        for step in steps:
            kinds[type(step).__name__] = kinds.get(type(step).__name__, 0) + 1
    assert set(kinds) == {"Traverse", "Feed", "Turn", "Dwell", "Function"}
    assert min(kinds.values()) >= 10


# ---------------------------------------------------------------------- refusals

REFUSED = (
    # two words of one group, one address twice
    *("G0 G1 X1", "G17 G18", "G90 G91", "G20 G21", "G54 G55", "G93 G94", "G98 G99", "G40 G41", "G90.1 G91.1"),
    *("G0 G53 X1 G1", "G28 G92 X1", "M3 M4", "M3 M5", "M0 M1", "M2 M30"),
    *("X1 X2", "S1 S2", "F1 F2", "T1 T2", "N1 N2"),
    # codes that neither knows, numbers that are none of these
    *("G11", "G12 X1", "G22", "G78", "G999", "G1.5 X1", "G-1 X1", "G0.5 X1", "G5", "G10", "G52"),
    *("M-1", "M1.5", "M3.5", "M98", "T-1", "T1.5", "M6 T-1", "S-5", "F-1", "G43 H-1", "G43 H1.5", "G41 D-1"),
    # no feed
    *("G1 X1 F0", "G93 G1 X1", "G93 G2 X10 I5", "G95 G1 X1", "G53 G1 X1 F0"),
    # arcs
    *("G2 X10 Y0 I4 J0", "G2 X10 Y0 I5 J0 R5", "G2 X10 Y0 R4", "G2 X0 Y0 R4", "G2 X10 Y0 R0"),
    *("G2 R5", "G2 X10 I0 J0", "G2 I0 J0", "G2 I5 K5", "G2 X10 Y0 K5", "G18 G2 X10 Z0 J5", "G19 G2 Y10 I5"),
    *("G2 X10 Y0 I5 P0", "G2 X10 Y0 I5 P-1", "G2 X10 Y0 I5 P1.5", "G53 G2 X10 I5"),
    # words that nothing uses, or that are missing
    *("G1 X1 I5", "G1 X1 R5", "G0 X1 J5", "G0 X1 K1", "G0 R1", "I5", "R5", "E1", "U1", "V1", "W1"),
    *("G4", "G4 P-1", "G92"),
    # drilling cycles
    *("G81 X1 Y1 Z-5", "G81 X1 Y1 R5", "G81 X1 Y1 R-5 Z5", "G91 G81 X1 Z5 R1", "G81 X1 Z-5 R1 L-1"),
    *("G83 X1 Z-5 R1", "G83 X1 Z-5 R1 Q0", "G83 X1 Z-5 R1 Q-1", "G73 X1 Z-5 R1 Q0", "G82 X1 Z-5 R1 P-1"),
    *("G81 X1 Z-5 R1 L1.5", "M5 G84 X1 Z-5 R1", "M5 G86 X1 Z-5 R1 P1"),
    # text
    *("(unclosed", "X", "X1Y", "5", "X1.2.3", "X1e3", "X1,5", "X#", "$1", "@1", "X1 )", "N", "O", "G", "M"),
    *("N1.5.2", "//X1", "X/1", "X1 /", "A1=5"),
)
"""Blocks that both refuse, wherever they stand."""


@pytest.mark.parametrize("block", REFUSED)
def test_both_refuse_the_same_block(block: str, tmp_path: Path) -> None:
    program = "\n".join((*SETTLED, block, "G80", "M2", ""))
    theirs = rs274.interpret(program, tmp_path)
    _, error = prepare(program)
    assert theirs.error
    assert theirs.block == block
    assert error is not None
    assert error.position is not None
    assert error.position.line == len(SETTLED) + 1


@pytest.mark.parametrize("seed", range(0, 60, 10))
def test_both_refuse_a_spoiled_program_at_the_same_line(seed: int, tmp_path: Path) -> None:
    for number in range(seed, seed + 10):
        rng = np.random.default_rng(number)
        program = random_program(number, 30)
        bad = str(rng.choice(REFUSED))
        index = int(rng.integers(2, len(program.blocks)))
        spoiled = Program(
            (
                *program.blocks[:index],
                *(Block(comment=line) for line in (*SETTLED, bad)),
                *program.blocks[index:],
            )
        ).text()
        theirs = rs274.interpret(spoiled, tmp_path)
        _, error = prepare(spoiled)
        assert (theirs.block, bool(theirs.error)) == (bad, True), spoiled
        assert error is not None, spoiled
        assert error.position is not None
        assert error.position.line == index + len(SETTLED) + 1, spoiled


# ---------------------------------------------------------------------- differences on purpose

RULINGS: tuple[tuple[str, str, str], ...] = (
    # Words that a control ignores where nothing uses them; din lists D H L P Q (`ignored_addresses`).
    ("ours", "P5", "P, Q, L, D, H without a use are ignored"),
    ("ours", "G1 X1 Q5", "the same beside a motion"),
    ("ours", "G1 X1 L5", "the same beside a motion"),
    ("ours", "G1 X1 D5", "the same beside a motion"),
    ("ours", "G1 X1 H5", "the same beside a motion"),
    # Blocks that CAM systems write.
    ("ours", "G0 G28", "a motion word beside G28 or G92 is modal only"),
    ("ours", "M7 M8", "both coolants in one block"),
    ("ours", "X1 N5", "the block number may stand anywhere"),
    ("ours", "G4 X1", "the dwell may be X or F"),
    ("ours", "G4 F1", "the dwell may be X or F"),
    ("ours", "G91 G53 G0 X1", "G53 counts from machine zero with G91 too"),
    ("ours", "G90.1 G2 X10 Y0 I5", "a missing centre word is the start point's"),
    ("ours", "G80 X1", "behind a cycle the motion before it is in force again"),
    ("ours", "G43 H99", "a tool that the table lacks has length 0, with a message"),
    ("ours", "G41 D99", "a tool that the table lacks has radius 0, with a message"),
    ("ours", "X1((b)", "a comment may hold an opening parenthesis"),
    ("ours", "X=5", "a sign of equality before the number"),
    ("ours", "M100", "an M code without a meaning is an auxiliary function"),
    # Codes of DIN 66025 that LinuxCNC lacks or uses otherwise.
    ("ours", "G70", "inch"),
    ("ours", "G71", "metric"),
    ("ours", "G60", "exact stop"),
    ("ours", "G9", "exact stop of one block"),
    # Drilling cycles: docs/reference/drilling-cycles.md.
    ("ours", "G82 X1 Z-5 R1", "no P, no dwell"),
    ("ours", "G88 X1 Z-5 R1", "no P, no dwell"),
    ("ours", "G81 X1 Z-5 R1 L0", "L0 stores the words"),
    ("ours", "G81 X1 Z-5 R1 A5", "other axes are positioned first"),
    ("ours", "M4\nG84 X1 Z-5 R1", "a left-hand thread"),
    # What only LinuxCNC takes.
    ("theirs", "F0", "a feed of 0 is refused where it is programmed, there where it is used"),
    ("theirs", "G92.1 X1", "axis words that nothing uses"),
    ("theirs", "X 1 2", "numbers may not be broken by blanks"),
    ("theirs", "X--1", "two signs"),
    ("theirs", "X+-1", "two signs"),
    ("theirs", "G61.1", "not in din"),
    ("theirs", "G33 X1 K1", "not in din"),
)
"""Who takes the block, the block, what we say."""


@pytest.mark.parametrize(("taken_by", "block", "ruling"), RULINGS)
def test_what_only_one_of_both_takes(taken_by: str, block: str, ruling: str, tmp_path: Path) -> None:
    program = "\n".join((*SETTLED, block, "G80", "M2", ""))
    theirs = rs274.interpret(program, tmp_path)
    _, error = prepare(program)
    assert (error is None) == (taken_by == "ours"), ruling
    assert (not theirs.error) == (taken_by == "theirs"), ruling


OTHER_WAYS: tuple[tuple[str, str], ...] = (
    # Units and feed.
    ("G20 F10\nG1 X1", "F counts in the unit of its own block; in LinuxCNC in that of the block before"),
    # Drilling cycles: docs/reference/drilling-cycles.md.
    ("G0 Z10\nG89 X1 Z-5 R1 P1", "out by feed to R, then by rapid"),
    ("G0 Z10\nG84 X1 Z-5 R1", "out by feed to R, then by rapid"),
    ("G88 X1 Z-5 R1 P1", "goes out after the stop"),
    ("G19\nG84 X-5 Y1 Z1 R1", "LinuxCNC mixes up the axes in other planes than G17"),
    (
        "G81 X5 Z7 R9\nX6 Z2 R4",
        "goes to the next hole before it goes down, also from above the initial level",
    ),
    ("G0 Z10\nG99 G81 X5 Z-5 R-1\nG83 X9 Z-3 R2 Q7", "rises to R before it goes to the next hole"),
    ("G0 Z30\nG99 G81 X5 Z-7 R9\nG98 X7", "goes to the next hole at R also when G98 begins there"),
)
"""Blocks that both take and carry out differently, and what we do."""


@pytest.mark.parametrize(("blocks", "ruling"), OTHER_WAYS)
def test_what_both_do_differently(blocks: str, ruling: str, tmp_path: Path) -> None:
    program = "\n".join((*SETTLED, blocks, "G80", "M2", ""))
    theirs = rs274.interpret(program, tmp_path)
    ours, error = prepare(program)
    assert not theirs.error
    assert error is None
    assert first_difference(ours, rs274.canonical_steps(theirs, len(AXES), scale=1), 1e-3), ruling


# ---------------------------------------------------------------------- splines, which rs274 does not print

LINUXCNC = load_dialect("linuxcnc")
CURVES = (
    "G5 X11 Y1.5 I2.5 J6.25 P-3.5 Q-7.25\nG5 X23 P-3 Q-6",
    "G91 G5 X11 I2 J6 P-3 Q-7\nG90 G5.1 Y-4 I1 J2",
    "G20 G5.1 X1.5 Y2.25 I-.5 J.75",
    "G92 X7 Y-3\nG5.1 X22 Y37 I20.5 J-80",
    "G10 L2 P1 X3 Y-9\nG5 X5 I0 J0 P0 Q0",
    "G90.1 G5 Y8 I3 J4 P5 Q6",
    "G93 G5.1 X4 I5 J6 F2\nG94 F100",
)
"""Curves, and what is in force with them."""
NO_CURVES = (
    *("G5 X10 I2 P-2 Q-6", "G5 X10 J2 P-2 Q-6", "G5 X10 I2 J1 P-2", "G5 X10 I2 J1 Q-2", "G5 X10 I2 J1"),
    *("G5 I2 J1 P2 Q3", "G5 X10 I2 J1 P2 Q3 Z1", "G5 X10 I2 J1 P2 Q3 B1", "G5 X10 I2 J1 P2 Q3 K1"),
    *(
        "G5 X10 I2 J1 P2 Q3 R1",
        "G18 G5 X10 I2 J1 P2 Q3",
        "G5 X10 I2 J1 P2 Q3 L2",
        "G5",
        "G1 G5 X1 I1 J1 P1 Q1",
    ),
    *("G5.1 X10", "G5.1 X10 I2", "G5.1 X10 J2", "G5.1 X10 I2 J3 C1", "G5.1 I3 J3", "G5.1 X10 I2 J3 P2"),
    *("G5.1 X10 I2 J3 Q2", "G93 G5.1 X10 I2 J3", "G41 D1 G5.1 X10 I2 J3", "G53 G5.1 X10 I2 J3"),
    *("G28 G5.1 X10 I2 J3", "G19 G5.1 Y1 J1 K1", "G5.1 X10 I2 J3\nX9 I2 J3", "G5 X1 I1 J1 P1 Q1\nX9 P1 Q1"),
)
"""Curves that both refuse."""


def spline_program(blocks: str) -> str:
    return "\n".join((*SETTLED, "G61 G1 X-2 Y5", blocks, "G91 G1 X1 Y2 Z3", "G90", "M2", ""))


def ends(program: str) -> tuple[list[Step], ProgramError | None]:
    """Return the straight moves that polycnc queues for a program."""
    machine = Machine(CONFIG, segments=1 << 12)
    channel = Channel(ProgramText.from_text(program), LINUXCNC, machine)
    give_to_path(machine.state, channel.path)
    channel.fill()
    return [step for step in queued_steps(machine, channel) if isinstance(step, Feed)], channel.error


@pytest.mark.parametrize("blocks", CURVES)
def test_splines_end_in_the_same_place_with_the_same_modes(blocks: str, tmp_path: Path) -> None:
    theirs = rs274.interpret(spline_program(blocks), tmp_path)
    assert not theirs.error, theirs.error
    curves = blocks.count("G5")
    assert [name for name, _ in theirs.calls].count("NURBS_FEED") == curves
    ours, error = ends(spline_program(blocks))
    assert error is None
    steps = rs274.canonical_steps(theirs, len(AXES), scale=1)
    there, here = steps[-1], ours[-1]
    assert isinstance(there, Feed)
    assert isinstance(here, Feed)
    assert np.allclose(here.end, there.end, rtol=0.0, atol=2e-3)
    assert here.speed == pytest.approx(there.speed, rel=1e-3)


@pytest.mark.parametrize("blocks", NO_CURVES)
def test_both_refuse_the_same_splines(blocks: str, tmp_path: Path) -> None:
    program = spline_program(blocks)
    theirs = rs274.interpret(program, tmp_path)
    _, error = ends(program)
    assert theirs.block == blocks.splitlines()[-1]
    assert error is not None
    assert error.position is not None
    assert error.position.line == len(SETTLED) + 1 + len(blocks.splitlines())


def test_a_series_that_has_no_beginning_is_refused_as_the_manual_says(tmp_path: Path) -> None:
    """The interpreter takes the way of whatever spline came before, or none at all."""
    for blocks in ("G5 X9 P1 Q2", "G5 X9 I3 J4 P1 Q2\nG1 X4\nG5 X20 P1 Q2"):
        assert not rs274.interpret(spline_program(blocks), tmp_path).error
        error = ends(spline_program(blocks))[1]
        assert error is not None
        assert "first of a series" in str(error)


POINTS = "X4 Y9 P.5\nX11 Y-2.5 P3\nX17 Y8 P1"
NURBS = (
    f"G5.2 P2 L3\n{POINTS}\nG5.3",
    f"G5.2 X1 Y2 P1.5 L4\n{POINTS}\nG5.3",
    f"G5.2 X1 Y2 P1.5\nM8\n(remark)\nG4 P1\nG5.2 {POINTS}\nG5.3",
    f"G91 G5.2 X1 Y2 P1.5 L5\n{POINTS}\nG5.3\nG90",
    "G20 G92 X.5 Y-1\nG5.2 X.1 Y.2 P1.5 L3\nX.4 Y.9 P.5\nX1.1 Y-.25 P3\nG5.3",
)
"""Curves by control points, and what is in force with them."""
NO_NURBS = (
    *(
        "G5.2 X1 P1",
        "G5.2 Y1 P1",
        "G5.2 X1 Y1 P1 L3.5",
        "G5.3",
        "G5.2 X1 Y2 P1\nG5.3",
        "G5.2 X1 Y2 P1\nX3 Y4",
    ),
    *(f"G5.2 X1 Y2 P1 L6\n{POINTS}\nG5.3", "G5.2 X1 Y2 P1\nG5.2 P2"),
    *(f"G5.2 P2 L3\n{POINTS}\nG5.3\nX7", "G5.2 X1 Y2 P1\nX3 Y2 P0"),
)
"""Curves that both refuse."""


@pytest.mark.parametrize("blocks", NURBS)
def test_curves_by_control_points_end_in_the_same_place_with_the_same_modes(
    blocks: str, tmp_path: Path
) -> None:
    theirs = rs274.interpret(spline_program(blocks), tmp_path)
    assert not theirs.error, theirs.error
    assert [name for name, _ in theirs.calls].count("NURBS_FEED") == 1
    ours, error = ends(spline_program(blocks))
    assert error is None
    there, here = rs274.canonical_steps(theirs, len(AXES), scale=1)[-1], ours[-1]
    assert isinstance(there, Feed)
    assert isinstance(here, Feed)
    assert np.allclose(here.end, there.end, rtol=0.0, atol=2e-3)


@pytest.mark.parametrize("blocks", NO_NURBS)
def test_both_refuse_the_same_curves_by_control_points(blocks: str, tmp_path: Path) -> None:
    test_both_refuse_the_same_splines(blocks, tmp_path)
