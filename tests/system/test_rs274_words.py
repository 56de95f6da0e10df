"""Words of the dialect `linuxcnc` beside LinuxCNC's `rs274`: the same end points, the same refusals.

The tools are the same in both: rs274 reads its table in inch.
"""

from __future__ import annotations

from itertools import zip_longest
from pathlib import Path

import pytest

from polycnc.errors import ProgramError
from polycnc.kernel import give_to_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, ProgramText, language_for, load_dialect
from support import rs274
from support.canonical import Function, Step, first_difference, queued_steps
from support.random_ngc_words import RandomWords

pytestmark = pytest.mark.skipif(rs274.COMMAND is None, reason="rs274 (LinuxCNC) is not installed")

TOLERANCE_MM = 1e-3  # rs274 prints four decimals, also of each shift and of each inch
LEAST_MM = 2.5e-3  # four decimals, of inches too
TOOLS = (
    "[tools]\n1 = {length_mm = 254.0, radius_mm = 76.2}\n2 = {x_mm = 25.4, length_mm = 508.0, radius_mm = 101.6}\n"
    "3 = {x_mm = 50.8, length_mm = 762.0, radius_mm = 50.8, tip = 2}\n"
)
TABLE = "T1 P1 Z10 D6\nT2 P2 X1 Z20 D8\nT3 P3 X2 Z30 D4 Q3\n"


def _config() -> MachineConfig:
    axes = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 5000\namax_mm_s2 = 20000\n' for name in "XYZ")
    return validate(
        MachineConfig,
        *parse_toml(f'name = "endless"\n{axes}{TOOLS}[programs]\nparameters_inch = true\n', "endless.toml"),
    )


CONFIG = _config()
DIALECT = load_dialect("linuxcnc")


def prepare(program: str) -> tuple[list[Step], ProgramError | None]:
    """Return what polycnc queues for a program, and what it refuses."""
    machine = Machine(CONFIG, segments=1 << 13)
    channel = Channel(ProgramText.from_text(program), DIALECT, machine, language=language_for(DIALECT))
    give_to_path(machine.state, channel.path)
    channel.fill()
    while channel.paused:
        machine.clock.tick(1)  # more is prepared with the next cycle
        channel.fill()
    assert channel.done
    return without_stops(queued_steps(machine, channel)), channel.error


def without_stops(steps: list[Step]) -> list[Step]:
    """Return the steps without the M5 of a tool change, which the oracle's steps do not have."""
    return [
        step
        for step, after in zip_longest(steps, steps[1:])
        if not (step == Function("M5") and isinstance(after, Function) and after.word.startswith("M6"))
    ]


def whole(blocks: str) -> str:
    return f"G21 G61 F6000\n{blocks}\nM2\n"


SAME = [
    # drilling goes back to R until a G98
    "G0 Z[10+#<_retract_r_plane>]\nG81 X1 Z-5 R1\nX2\nG80",
    # radius compensation that starts with an arc, on both sides, in helices, before corners of every kind
    "G41.1 D2\nG3 X10 Y10 R10\nG1 Y20\nG40 G1 X30",
    "G42.1 D2\nG3 X10 Y10 R10\nG1 Y20\nG40 G1 X30",
    "G41.1 D2\nG2 X10 Y-10 R10\nG1 Y-20\nG40 G1 X30",
    "G41.1 D2\nG3 X10 Y10 R10\nG1 X20\nG1 Y30\nG40 G1 X30",
    "G41.1 D2\nG3 X10 Y10 R10\nG1 X0\nG1 Y30\nG40 G1 X-30",
    "G41.1 D8\nG3 X10 Y10 R10\nG3 X0 Y20 R10\nG40 G1 X-30",
    "G42.1 D2\nG3 X4 Y4 I0 J4 Z3\nG3 X0 Y8 R4\nG40 G1 X-30",
    "G18 G42.1 D3\nG2 X14 Z9 R17\nG1 X20 Z22\nG40 G1 X30",
    # one that starts with a straight move ends beside that, and trims or rounds the corner after it like others
    "G42.1 D2\nG1 X-10.045 Y-10.107\nG1 X-3.815 Y-11.974 Z2\nG40 G1 X9",
    "G41.1 D1\nG1 X-10.889 Y14.515\nG2 X-19.613 Y11.417 R7.192\nG40 G1 X9",
    "G42.1 D.5\nG1 X-11.998 Y17.383\nG1 X-2.596 Y17.576\nG40 G1 Y9",
    "G41.1 D2\nG1 X11.999 Y-17.688\nG1 X30.022 Y-12.397\nG40 G1 X9 Y-40",
    "G18 G42.1 D2\nG1 X-6.064 Z15.283\nG1 X-15.836 Z10.095\nG40 G1 X9",
    # which turns back, but for 0.05 rad, as one that turns about the corner; from and to an arc outside it is trimmed
    "G41.1 D2\nG1 X10 Y1\nG1 X70 Y1.5\nG1 X0 Y2.5\nG1 Y20\nG40 G1 X30 Y50",
    "G41.1 D.5\nG1 X-5 Y8\nG1 X-20 Y18\nG2 X-23.371289 Y13.043851 I-1.575966 J-2.552711\nG40 G1 X-28 Y-2",
    "G42.1 D.5\nG1 X-5 Y8\nG1 X-20 Y18\nG2 X-23.371289 Y13.043851 I-1.575966 J-2.552711\nG40 G1 X-28 Y-2",
    # with which positions are those of the tool
    "G41.1 D2\nG1 Y-11\nG1 X6\nG1 X[#<_y>] Y[#<_x>/3]\nG1 X[#<_y>] Y20\nG40 G1 X50",
    # arcs whose end lies off the circle: more in inches, and no more than 100 times as much
    "G20\nF60 G2 X5 I2.4986",
    "G2 X50 I24.986",
    "G2 X2000 I999.5",
    # a comment among the arguments, and a program with a name
    "O<part>\nO1 SUB\nG0 X#1 Y#2\nO1 ENDSUB\nO1 CALL [3] (first) [4] (second)",
    "G0 X#<_value> Y#<_value_returned>\nO1 SUB\nO1 ENDSUB [5]\nO1 CALL\nG0 X#<_value> Y#<_value_returned>",
    # which the next straight move ends, whatever it moves
    "G41.1 D2\nG1 Y10\nG1 Y20\nG40\nG0 Z4\nG42.1 D2\nG1 X30\nG1 X40\nG40 G1 X50 Z1",
    # a shift by G92 and by G52 is one shift
    "G0 X1 Y2\nG92 X5\nG0 X6\nG52 X10 Y3\nG0 X1 Y1\nG91 G52 X2\nG90 G0 X0\nG92.1\nG0 X2",
    "G0 X4 Y3\nG92 X5 Y7\nG92.2\nG0 X0 Y9\nG92.3\nG0 X0.5\nG92 X3\nG0 X7 Y2",
    "G0 X4 Y3\nG92 X5 Y7\nG92.2\nG92 X3\nG0 X7 Y2",  # what was suspended does not come back with another
    # work offsets up to the ninth, turned ones
    "#5381=.7\n#5382=.3\nG59.3\nG0 X1\nG10 L20 P9 Y4\nG0 X2 Y5\nG59.1 G0 X2\nG59.2 G0 X3",
    "G59.3\nG10 L2 P9 X1 Y2 R30\nG0 X1 Y0\nG1 X5 Y7\nG2 X7 Y7 R4\nG91 G1 X3\nG90 G53 G0 X1",
    "G92 X3 Y4\nG10 L2 P1 R30 X5 Y7\nG0 X3 Y8\nG91 G0 X7\nG90 G55 G0 X1 Y3\nG54 X9 Y1",
    "G10 L2 P0 X5 Y7 R-20\nG0 X3 Y8\nG92 X1\nG0 X2 Y3\nG1 X#<_x> Y[#<_y>+1]",
    "G10 L2 P1 X2 R30\nG0 X3 Y4\nG10 L20 P1 Y7\nG0 X1 Y2\nG10 L20 P2 X3\nG55 G0 X1 Y1\nG92 X5\nG10 L20 P1 X1 Y1\n"
    "G54 G0 X2 Y2",
    "T1 M6\nG43 G10 L2 P0 R45\nG0 X3 Z9\nG10 L10 P1 X1\nG43 G0 X2 Y1\nG10 L10 P1 Y2\nG10 L2 P9 X7 R20\n"
    "G10 L11 P1 X2 Y1\nG43 G0 X1",
    # reference positions
    "G30.1\nG10 L2 P1 X2 Y3 R20\nG0 X4 Y5 Z6\nG30 Y7 Z2\nG28 X1",
    "G0 X1 Y2 Z3\nG28.1\nG0 X5\nG30.1\nG0 X0 Y0 Z0\nG28\nG0 X9 Z0\nG30 Z4",
    # tools
    "T1 M6\nG43\nG0 X1 Z1\nG10 L1 P1 Z12 R4\nG0 Z2\nG43\nG0 Z1\nG10 L10 P1 Z5\nG43\nG0 Z2\nG10 L11 P1 Z6\nG43 G0 Z1",
    "G10 L10 P3 X4\nG43 H3 G0 X7 Z3\nG43.2 H2\nG0 X6\nG49 G0 X3",
    "G43.1 Z5 X1\nG0 X0 Y0 Z0\nG43.1 Y2\nG0 X1 Y0 Z0\nG43.2 H1\nG0 X0 Y1 Z0\nG91 G43.1 Z1\nG90 G0 Z7\nG49\nG0 Z0",
    # diameters
    "G7\nG0 X10\nG91 G0 X2\nG90 G92 X4\nG0 X6\nG92.1\nG10 L2 P1 X10\nG0 X6\nG18 G2 X10 Z2 I1 K1\n"
    "G10 L20 P1 X10\nG53 G0 X4\nG43.1 X2\nG0 X4 Z#5420\nG8 G0 X5\nG0 Z#5420",
    "G7 G20 G0 X1\nG21 G0 X8\nG8 G20 G0 X.5",
    # polar positions
    "G0 X3 Y4\nG91 G0 @5\nG90 G0 @2 Z1\nG91 @2\nG90 ^10",
    "G0 X3 Y4\nG10 L2 P1 R30 X5\nG0 @6\nG0 @3 ^10\nG2 @3 ^80 R3\nG92 X3 Y8\nG0 X1",
    "G0 X3 Y4\nG81 @5 ^0 Z-1 R1\n^90",
    "G0 X3 Y4 Z2\nG91 G81 ^20 @1 Z-3 R1 L4\n^-15 L2",
    "G0 X3 Y4\nG91 G0 @-2 ^[5*3]\nG90 @-3 ^20",
    "G7 G0 X6 Y4\nG0 @5 ^10\n@10",
    # threads
    "G0 X10 Z5\nM3 S500\nG33 Z-10 K1.5\nX12 K2\nG0 X20\nG33.1 Z-5 K1\nG0 X3",
    "M4 S300 G0 X20 Y3 Z2\nG33.1 Z3 K1.25\nG0 X1",
    "M3 S300 G18 G0 X20 Z2\nG76 P1.5 Z-20 I-1 J0.3 K1.2 R1.5 Q29.5 H2 E1 L3\nG0 X3\nG76 P1.5 Z20 I1 J0.3 K1.2 Q30\n"
    "G76 P1.5 Z1 I1 J0.3 K1.2 L1 E.5\nG76 P1.5 Z20 I1 J0.3 K1.2 L2 E.5\nG0 X5",
    "M3 S300 G7 G0 X20 Z2\nG76 P1.5 Z-20 I-1 J0.6 K1.2\nG91 G76 P1.5 Z-20 I-1 J0.6 K1.2\nG90 G0 X1",
]


@pytest.mark.parametrize("blocks", SAME)
def test_blocks_have_the_same_end_points(
    blocks: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rs274, "tool_table", lambda: TABLE)
    theirs = rs274.interpret(whole(blocks), tmp_path)
    ours, error = prepare(whole(blocks))
    assert error is None
    assert not theirs.error
    assert not first_difference(ours, rs274.canonical_steps(theirs, 3, 1, LEAST_MM), TOLERANCE_MM)


@pytest.mark.parametrize("orientation", range(1, 10))
def test_where_a_tip_lies_is_counted_as_linuxcnc_counts(
    orientation: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rs274, "tool_table", lambda: TABLE)
    program = whole(f"G18 G0 X20 Z5\nG42.1 D6 L{orientation}\nG1 X10 Z3\nZ-20\nZ-30\nX40\nX50")
    ours, error = prepare(program)
    assert error is None
    theirs = rs274.canonical_steps(rs274.interpret(program, tmp_path), 3, 1, LEAST_MM)
    assert not first_difference(ours, theirs, TOLERANCE_MM)


REFUSED = [
    "G0 @5 X1",
    "G18\nG0 @5",
    "G53 G0 @6",
    "G91\nG53 G0 X3",
    "G81 X1 Z-3 R1 L0",
    "G92 @6",
    "G28 @6",
    "G91 G0 @5",
    "G10 L1 P77 Z1",
    "G42.1 D6 L3",
    "G41.1",
    "G41.1 D8\nG1 X3 Y2",
    "G52",
    "G10 L2 P10 X1",
    "G43.2 Z1",
    "G33 Z3 K1",
    "M3 S100 G33 Z3",
    "M3 S100 G33 K1",
    "M3 S100 G33.1 Z-3",
    "G76 P1.5 Z-20 I-1 J0.6 K1.2",
    *(
        f"M3 S100\nG76 {words}"
        for words in ("P1 Z-9 I-1 J1", "P1 Z-9 I-1 J1.2 K1", "Z-9 I-1 J.2 K1", "P1 I-1 J.2 K1")
    ),
    *(
        f"M3 S100\nG76 P1 Z-9 {words}"
        for words in ("I0 J.2 K1", "I-1 J0 K1", "I-1 J.2 K1 H1.5", "I-1 J.2 K1 E1 L1.5")
    ),
    "M3 S100\nG76 P1 Z-9 I1 J.2 K1\nX3",
    "G20\nF60\nG2 X5 I2.4985",
    "G2 X50 I24.9857",
    "G2 X6000 I3001.4284",
    "G2 X20 R9.998",
    "G0 X3\n(ABORT, stop at #<_x>)",
    "G49 H7.25",
    "G38.2",
    "G41.1 D1\nG38.2 Z-3",
]
"""Blocks that both refuse, in their last line."""


@pytest.mark.parametrize("blocks", REFUSED)
def test_both_refuse_the_same(blocks: str, tmp_path: Path) -> None:
    theirs = rs274.interpret(whole(blocks), tmp_path)
    _, error = prepare(whole(blocks))
    assert theirs.block == blocks.splitlines()[-1]
    assert error is not None
    assert error.position is not None
    assert error.position.line == 1 + len(blocks.splitlines())


def compare(seed: int, count: int, folder: Path) -> str:
    """Return how random sequences differ between the two; '' if they do not."""
    program = whole(RandomWords(seed).sequences(count))
    theirs = rs274.interpret(program, folder)
    ours, error = prepare(program)
    refused = None if error is None or error.position is None else error.position.line
    if refused is not None and theirs.block == program.splitlines()[refused - 1]:
        return ""  # a position by radius and angle where the tool stands at zero
    if error is not None or theirs.error:
        return f"seed {seed}: refused\n  ours   {error}\n  theirs {theirs.error}: {theirs.block}\n{program}"
    found = first_difference(ours, rs274.canonical_steps(theirs, 3, 1, LEAST_MM), 5.0 * TOLERANCE_MM)
    return f"seed {seed}: {found}\n{program}" if found else ""


@pytest.mark.parametrize("first", range(0, 10, 5))
def test_random_words_ask_for_the_same_moves(
    first: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten sequences each: a sequence begins with all modes set anew."""
    monkeypatch.setattr(rs274, "tool_table", lambda: TABLE)
    found = [text for seed in range(first, first + 5) if (text := compare(seed, 10, tmp_path))]
    assert not found, f"{len(found)} of 5\n" + found[0]


@pytest.mark.long
@pytest.mark.parametrize("first", range(10_000, 10_500, 50))
def test_many_random_words_ask_for_the_same_moves(
    first: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rs274, "tool_table", lambda: TABLE)
    found = [text for seed in range(first, first + 50) if (text := compare(seed, 10, tmp_path))]
    assert not found, f"{len(found)} of 50\n" + found[0]
