"""Refused blocks: what the message says, where it points, what stays as it was; collecting errors."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.kernel import free_slots
from polycnc.machine import Machine
from polycnc.nc import DIALECTS, Channel, ProgramText, load_dialect
from polycnc.runner import check
from support.programs import FIVE, MILL, channel_state, listing, prepare, queue_bytes, refusal


def test_an_error_says_where_what_and_what_to_do() -> None:
    channel = prepare("G21\n\tG1 X10 F100 Y400\n")
    assert str(channel.error) == (
        "test.nc:2:14: axis Y would go to 400.000 mm, past its soft limit of 300.000 mm\n"
        "    \tG1 X10 F100 Y400\n"
        "    \t            ^\n"
        "Check the program, the work offset and the machine's soft limits (machine coordinates)."
    )


def test_the_file_is_named_by_its_path(tmp_path: Path) -> None:
    file = tmp_path / "part.nc"
    file.write_text("G1 X1\n")
    channel = prepare(ProgramText.from_path(file))
    assert str(channel.error).startswith(f"{file}:1:1: a feed move without a feed\n    G1 X1\n    ^\n")


def test_the_program_is_prepared_up_to_the_error_and_no_further() -> None:
    channel = prepare("G0 X1\nG0 X2\nG0 X400\nG0 X3\n")
    assert listing(channel) == ["rapid X1 stop", "rapid X2 stop"]
    assert len(channel.errors) == 1
    assert channel.done


NO_LANGUAGE = "dialect 'din' reads no variables, expressions or program flow (1 block has them)"


@pytest.mark.parametrize(
    ("program", "text"),
    [
        # The word that is wrong, else the first that is no block number.
        ("N10 G1 X1 F100 Q5 E5", "1:19: the address 'E' is not known in dialect 'din'"),
        ("G1 X1e-05 F100", "1:6: numbers are written without an exponent"),
        ("N10 G1 X1 X2", "1:11: 'X' is given twice in this block"),
        ("N10 N20", "1:5: 'N' is given twice in this block"),
        ("G1 X1O5 F100", "1:6: the letter O stands behind other words"),
        ("X5. O12", "1:5: the letter O stands behind other words"),
        ("N1 M8 O5", "1:7: the letter O stands behind other words"),
        ("N10 G17 G18", "1:9: G17 and G18 exclude each other (group 'plane')"),
        ("N10 G1 G1 X1", "1:8: G1 is given twice in this block"),
        ("G77", "1:1: G77 is not known in dialect 'din'"),
        ("G1.5", "1:1: G1.5 is not known in dialect 'din'"),
        ("G-1", "1:1: G-1 is not known in dialect 'din'"),
        ("G90.1 G91.1", "1:7: G90.1 and G91.1 exclude each other (group 'arc distance')"),
        ("N5 #1=5", f"1:1: {NO_LANGUAGE}"),
        ("   G1 X[1+2]", f"1:4: {NO_LANGUAGE}"),
        ("IF GOTO 5", f"1:1: {NO_LANGUAGE}"),
        ("while[#1 lt 5] do1", f"1:1: {NO_LANGUAGE}"),
        # Slips of the pen, each at its word.
        ("N5 G1 X1,5 F100", "1:7: 'X1,5' has a comma in its number"),
        ("G1 F1200 Z - 1,25", "1:10: 'Z - 1,25' has a comma in its number"),
        ("G1 Y,5", "1:4: 'Y,5' has a comma in its number"),
        ("G1 (1,5) Y2,5", "1:10: 'Y2,5' has a comma in its number"),
        ("G1 F1,250.5", "1:4: 'F1,250.5' is no number"),
        ("G1 Y1O F500", "1:4: 'Y1O' has the letter O in its number"),
        ("G1 Y5 Xabc F100", "1:7: 'X' has no number"),
        ("G1X10,Y5", "1:6: ',Y' (a chamfer or a rounding between blocks) is not known here"),
        ("G1 X10,", "1:7: ',' is not allowed in a block"),
        ("G1 X10 ,C2", "1:8: ',C' (a chamfer or a rounding between blocks) is not known here"),
        ("G0 U5", "1:4: there is no axis 'U' on machine 'test'"),
        ("G0 X1=5", "1:4: there is no axis 'X1' on machine 'test'"),
        ("G64 P-1", "1:5: the path tolerance P is negative"),
        # What the scanners refuse.
        ("G1 X", "1:4: 'X' has no number"),
        ("G1 5", "1:4: '5' has no letter"),
        ("G1 X5 (open", "1:7: the comment is not closed"),
        ("G1 X5 & Y1", "1:7: '&' is not allowed in a block"),
        ("X1.2.3", "1:5: '.3' has no letter"),
    ],
)
def test_places(program: str, text: str) -> None:
    assert refusal(program + "\n") == text


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize(
    ("word", "written"), [("X1,5", "X1.5"), ("x-0,25", "x-0.25"), ("Y ,75", "Y.75"), ("Z+12,125", "Z+12.125")]
)
def test_a_decimal_comma_is_told_what_to_write(dialect: str, word: str, written: str) -> None:
    channel = prepare(f"F100\nG1 {word} A5\n", dialect=dialect)
    assert channel.error is not None
    assert channel.error.hint == f"Write {written}: a decimal point, no comma."
    assert channel.error.position is not None
    assert channel.error.position.column == 4


def test_statements_are_reported_once_with_their_number() -> None:
    program = "O1 (#1, #2)\n#100=5\nG1 X[#100] F200\nX1,5\nIF [#100 EQ 5] GOTO 10\nG1 X3\nN10 #101=[1+2]\n"
    channel = prepare(program, collect_errors=True)
    assert [(error.position.line, error.what) for error in channel.errors if error.position] == [
        (
            2,
            "dialect 'din' reads no variables, expressions or program flow (4 blocks have them, this is the first)",
        ),
        (4, "'X1,5' has a comma in its number"),
        (6, "a feed move without a feed"),
    ]
    assert "--dialect fanuc" in channel.errors[0].hint


def test_no_motion_in_force() -> None:
    din = load_dialect("din")
    none = din.model_copy(update={"initial": din.initial.model_copy(update={"motion": "none"})})
    assert refusal("F100\nX5\n", dialect=none) == "2:1: axis words without a motion"


def test_an_address_that_belongs_to_something_names_it() -> None:
    channel = prepare("G1 F100 X1 R5\n")
    assert channel.error is not None
    assert channel.error.what == "'R' has no meaning in this block"
    assert channel.error.hint == "It belongs to an arc (G2, G3) or a drilling cycle."
    assert prepare("G1 F100 X1 L5\n", dialect="bosch").error is not None  # bosch ignores nothing


# --- refused blocks change nothing


BAD_BLOCKS = (
    "G20 G91 G18 G95 S500 M3 T2 M6 F.1 X99999",
    "G55 G61 G98 G64 G43 H1 M8 X400",
    "G41 D1 X10 Y10 G2 G3",
    "(MSG, hello) X400",
    "G92 X5 Y5 E1",
    "G81 Z-5 R2 X400",
    "G64 P0.5 X400",
    "G4 P1 X5",
    "G1 X5 M98 P77",
    "G93 G1 X5",
    "H7 G43 X400",
)


@pytest.mark.parametrize("bad", BAD_BLOCKS)
def test_a_refused_block_leaves_everything_as_it_was(bad: str) -> None:
    before = "G0 X1 Y2\nF100 S100 M3\nG56\nT1 M6\n"
    behind = "G1 X5 Y5\nG2 X9 I2\nM8\nX7\n"
    good = prepare(f"{before}(nothing)\n", config=FIVE, collect_errors=True)
    spoiled = prepare(f"{before}{bad}\n", config=FIVE, collect_errors=True)
    assert len(spoiled.errors) == 1
    assert channel_state(spoiled) == channel_state(good)
    assert queue_bytes(spoiled) == queue_bytes(good)
    good = prepare(f"{before}(nothing)\n{behind}", config=FIVE, collect_errors=True)
    spoiled = prepare(f"{before}{bad}\n{behind}", config=FIVE, collect_errors=True)
    assert channel_state(spoiled) == channel_state(good)
    assert queue_bytes(spoiled) == queue_bytes(good)


def test_radius_compensation_is_taken_back_too() -> None:
    before = "G1 F100 Y-10\nG41 D1 Y0\nX20\n"
    for bad in ("X40 Z400", "G40 X40 E5", "G3 X21 Y1 R1", "G42", "G40 G2 X40 I10", "M30 E1"):
        good = prepare(f"{before}(nothing)\nX40\nG40 X50\n", config=FIVE, collect_errors=True)
        spoiled = prepare(f"{before}{bad}\nX40\nG40 X50\n", config=FIVE, collect_errors=True)
        assert len(spoiled.errors) == 1, bad
        assert queue_bytes(spoiled) == queue_bytes(good), bad
        assert channel_state(spoiled) == channel_state(good), bad


# --- all errors


def test_all_errors_are_collected_in_order() -> None:
    channel = prepare("G1 X1\nG77\nF100\nX 5 5\nG2 X9 I1\nX3\n", collect_errors=True)
    positions = [error.position for error in channel.errors]
    assert [position.line for position in positions if position] == [1, 2, 4, 5]
    assert listing(channel) == ["line X3 F100"]


def test_a_check_finds_no_errors_that_follow_from_others() -> None:
    def wrong(program: str, dialect: str = "din") -> list[int]:
        errors = check(ProgramText.from_text(program), None, dialect)
        return [error.position.line for error in errors if error.position]

    assert wrong("G1 X1\nX5\nG3 X7 Y2 R2\n") == [1]  # the feed is missed once, and its move made
    assert wrong("G1 X1 E5 F100\nX5\nG2 X9 I2\n") == [1]  # F of a refused block counts
    contour = "N1 G0 X20.\nG1 Z-1.\nN2 X50. Z-9.\n"
    assert wrong(f"G98 G0 X60 Z1\nG71 P1 Q2 U1. F300\n{contour}G0 X50.\n", "fanuc-lathe") == [2]
    assert wrong("#1=[SQRT(2)]\n#2=5\nG0 X#2\n", "linuxcnc") == [1]
    assert wrong("G21\nN1 G0 X10 *45\n", "fanuc") == [2]


def test_an_error_in_a_repeated_sub_program_is_noted_once() -> None:
    channel = prepare("M98 P1 L9\nM98 P1\nM30\nO1\nG77\nM99\n", collect_errors=True)
    assert len(channel.errors) == 1


def test_a_contour_that_is_too_narrow_is_noted_once_and_the_rest_checked() -> None:
    narrow = "G1 F100 Y-10\nG41 D1 Y0\nX20\nY3\nX0\nY5\nX5\nY9\nG40 X-10\nG77\n"
    channel = prepare(narrow, config=FIVE, collect_errors=True)
    assert [error.position.line for error in channel.errors if error.position] == [4, 10]


def test_there_is_an_end_to_collecting() -> None:
    channel = prepare("G1 X1\n" * 5000, collect_errors=True)
    assert len(channel.errors) == 1000
    assert channel.messages.all()[-1].text == "the program was checked up to its error number 1000"


# --- the queue


def test_preparation_stops_when_the_queue_is_full_and_goes_on_when_there_is_room() -> None:
    machine = Machine(MILL, segments=64)
    program = "F100\n" + "".join(f"X{n}\nY{n}\n" for n in range(1, 151))
    channel = Channel(ProgramText.from_text(program), load_dialect("din"), machine)
    row = machine.state.paths.row[0]
    ends = []
    while not channel.done:
        before = int(row["head"])
        channel.fill()
        assert free_slots(machine.state.paths, 0) >= 0
        ends += [machine.state.seg.end[n % 64, :2].tolist() for n in range(before, int(row["tail"]))]
        row["head"] = row["tail"]
    wanted = [point for n in range(1, 151) for point in ([n, n - 1], [n, n])]
    assert ends == wanted


def test_a_block_that_needs_more_than_the_queue_waits_for_room() -> None:
    machine = Machine(MILL, segments=32)
    program = "F100 G0 Z10\nG83 X1 Z-100 R2 Q1\nM30\n"  # 102 pecks of three moves each
    channel = Channel(ProgramText.from_text(program), load_dialect("din"), machine)
    row = machine.state.paths.row[0]
    lengths = []
    while not channel.done:
        channel.fill()
        lengths.append(int(row["tail"] - row["head"]))
        row["head"] = row["tail"]
    assert channel.error is None
    assert int(row["tail"]) > 300
    assert max(lengths) <= 32
    assert len(lengths) >= 9


def test_a_queue_that_stays_full_stays_as_it_is() -> None:
    machine = Machine(MILL, segments=32)
    channel = Channel(ProgramText.from_text("F100 G83 X1 Z-100 R2 Q1\n"), load_dialect("din"), machine)
    channel.fill()
    filled = int(machine.state.paths.row[0]["tail"])
    channel.fill()
    assert not channel.done
    assert free_slots(machine.state.paths, 0) >= 0
    assert int(machine.state.paths.row[0]["tail"]) == filled
