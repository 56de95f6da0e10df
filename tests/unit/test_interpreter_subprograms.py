"""Sub-programs: where they are found, repetitions, nesting, return, and calls that go nowhere."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.nc import Channel, ProgramText
from support.programs import FIVE, accepted, listing, moves, notes, prepare, refusal


def ends(program: str, **options: object) -> list[str]:
    """Return where the rapids of a program go."""
    return [item.split()[1] for item in moves(program, **options) if item.startswith("rapid")]


def test_a_call_and_what_comes_behind_it() -> None:
    assert ends("G0 X1\nM98 P100\nX3\nM30\nO100\nX2\nM99\n") == ["X1", "X2", "X3"]


def test_repetitions() -> None:
    assert ends("G91 G0 X1\nM98 P7 L3\nX10\nM30\nO7\nX2\nM99\n") == ["X1", "X3", "X5", "X7", "X17"]
    assert ends("G0 X1\nM98 P7 L0\nX3\nM30\nO7\nX2\nM99\n") == ["X1", "X3"]


@pytest.mark.parametrize("label", ["O0100", "o100", " O100 (hole)", ":100", "O 100"])
def test_ways_to_begin_a_sub_program(label: str) -> None:
    assert ends(f"G0 X1\nM98 P100\nM30\n{label}\nX2\nM99\n") == ["X1", "X2"]


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_labels_are_found_behind_any_newline(newline: str) -> None:
    program = "G0 X1\nM98 P100\nX3\nM30\nO100\nX2\nM99\n".replace("\n", newline)
    assert ends(program) == ["X1", "X2", "X3"]


def test_the_motion_of_the_calling_block_comes_first() -> None:
    assert ends("G0 X1 M98 P5\nM30\nO5\nX2\nM99\n") == ["X1", "X2"]


def test_the_modal_state_goes_in_and_comes_out() -> None:
    assert ends("G91 G0 X1\nM98 P5\nX7\nM30\nO5\nX1\nG90\nM99\n") == ["X1", "X2", "X7"]


def test_a_sub_program_ends_with_m99_the_next_program_number_percent_or_the_file() -> None:
    for end in ("M99\nX9\n", "O6\nX9\n", "%\nX9\n", ""):
        assert ends(f"G0 X1\nM98 P5\nX3\nM30\nO5\nX2\n{end}") == ["X1", "X2", "X3"], end


def test_a_main_program_without_m30_ends_at_the_next_program_number() -> None:
    assert ends("%\nO1\nG0 X1\nM98 P5\nX3\nO5\nX2\nM99\n%\n") == ["X1", "X2", "X3"]


def test_an_end_inside_a_sub_program_ends_everything() -> None:
    assert moves("G0 X1\nM98 P5\nX3\nM30\nO5\nX2\nM30\n") == ["rapid X1 stop", "rapid X2 stop", "M30"]


def test_a_return_from_the_main_program_ends_it() -> None:
    assert ends("G0 X1\nM99\nX2\n") == ["X1"]
    assert notes("G0 X1\nM99\nX2\n") == ["a return from the main program ends it"]


def test_repetitions_and_program_in_one_number() -> None:
    program = "G91 G0 X1\nM98 P{}\nM30\nO100\nX2\nM99\n"
    assert ends(program.format("30100"), dialect="fanuc") == ["X1", "X3", "X5", "X7"]
    assert ends(program.format("0030100"), dialect="fanuc") == ["X1", "X3", "X5", "X7"]
    assert ends(program.format("100 L2"), dialect="fanuc") == ["X1", "X3", "X5"]
    assert refusal(program.format("30100")) == "2:5: there is no sub-program 30100"


# --- nesting


def chain(depth: int) -> str:
    """Return a program whose sub-programs call each other `depth` deep, each with a move before and after."""
    program = "G0 X0.5\nM98 P1\nX100\nM30\n"
    for number in range(1, depth + 1):
        call = f"M98 P{number + 1}\n" if number < depth else ""
        program += f"O{number}\nX{number}\n{call}Y{number}\nM99\n"
    return program


@pytest.mark.parametrize(("dialect", "deepest"), [("bosch", 7), ("din", 7), ("fanuc", 4)])
def test_calls_may_be_nested_so_deep(dialect: str, deepest: int) -> None:
    down = [f"X{number}" for number in range(1, deepest + 1)]
    up = [f"Y{number}" for number in range(deepest, 0, -1)]
    assert ends(chain(deepest), dialect=dialect) == ["X0.5", *down, *up, "X100"]
    too_deep = refusal(chain(deepest + 1), dialect=dialect)
    assert too_deep.endswith(f":5: sub-programs are nested more than {deepest} deep")


@pytest.mark.covers("cpl.structure.nesting")
def test_bosch_nests_seven_deep_and_goes_on_behind_each_call() -> None:
    """Manual 003, 2.1: sub-programs call sub-programs up to seven deep; the caller continues after the call."""
    down = [f"X{number}" for number in range(1, 8)]
    up = [f"Y{number}" for number in range(7, 0, -1)]
    assert ends(chain(7), dialect="bosch") == ["X0.5", *down, *up, "X100"]
    assert "nested more than 7 deep" in refusal(chain(8), dialect="bosch")


def test_a_program_that_calls_itself_is_refused_and_not_run_forever() -> None:
    assert refusal("O1\nG91 G0 X1\nM98 P1\nM30\n") == "3:5: sub-programs are nested more than 7 deep"


# --- files of their own


@pytest.mark.parametrize("name", ["O0100.nc", "O100.nc", "o0100.nc", "O100", "O0100", "100", "0100.nc"])
def test_a_file_beside_the_program(tmp_path: Path, name: str) -> None:
    main = tmp_path / "part.nc"
    main.write_text("G0 X1\nM98 P100 L2\nX3\nM30\n")
    (tmp_path / name).write_text("%\nO0100 (a file that begins with percent)\nG91 X10\nG90\nM99\n%\n")
    channel = accepted(ProgramText.from_path(main))
    assert [item.split()[1] for item in listing(channel)[:-1]] == ["X1", "X11", "X21", "X3"]


def test_the_main_file_comes_first_and_its_programs_are_found_from_other_files(tmp_path: Path) -> None:
    main = tmp_path / "part.nc"
    main.write_text("G0 X1\nM98 P1\nM98 P2\nM30\nO2\nX2\nM99\n")
    (tmp_path / "O1.nc").write_text("X10\nM98 P2\n")
    (tmp_path / "O2.nc").write_text("X99\n")
    channel = accepted(ProgramText.from_path(main))
    assert [item.split()[1] for item in listing(channel)[:-1]] == ["X1", "X10", "X2"]


def test_an_error_in_another_file_names_that_file(tmp_path: Path) -> None:
    main = tmp_path / "part.nc"
    main.write_text("G0 X1\nM98 P1\nM30\n")
    sub = tmp_path / "O1.nc"
    sub.write_text("X10\n  X20 X30\n")
    channel = prepare(ProgramText.from_path(main))
    assert channel.error is not None
    assert str(channel.error).splitlines()[0] == f"{sub}:2:7: 'X' is given twice in this block"


def test_a_move_held_back_by_compensation_is_named_in_its_own_file(tmp_path: Path) -> None:
    main = tmp_path / "part.nc"
    main.write_text("G1 F100 Y-10\nG41 D1 Y0\nM98 P1\nX0\nG40 X-10\nM30\n")
    sub = tmp_path / "O1.nc"
    sub.write_text("\n\n\n\n\nX20\nY3\n")
    channel = prepare(ProgramText.from_path(main), config=FIVE)
    assert channel.error is not None
    assert str(channel.error).startswith(f"{sub}:7:1: the compensated move would run backwards")


def test_a_file_that_is_no_text_is_said_so(tmp_path: Path) -> None:
    main = tmp_path / "part.nc"
    main.write_text("M98 P1\n")
    (tmp_path / "O1.nc").write_bytes(b"\xff\xfeG\0")
    channel = prepare(ProgramText.from_path(main))
    assert channel.error is not None
    assert "UTF-16" in str(channel.error)


def test_a_text_without_a_file_looks_into_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "O1").write_text("G0 X1\n")
    monkeypatch.chdir(tmp_path)
    assert refusal("M98 P1\n") == "1:5: there is no sub-program 1"


# --- calls that go nowhere


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("M98 P5", "1:5: there is no sub-program 5"),
        ("M98", "1:1: M98 without a sub-program"),
        ("M98 P1.5", "1:5: P1.5 is not the number of a program"),
        ("M98 P-1", "1:5: P-1 is not the number of a program"),
        ("M98 P1 L-1", "1:8: L-1 is not a number of repetitions"),
        ("M98 P1 L1.5", "1:8: L1.5 is not a number of repetitions"),
        ("M99 P10", "1:5: M99 P: a return to a block number cannot be carried out"),
    ],
)
def test_calls_that_are_refused(block: str, text: str) -> None:
    assert refusal(f"{block}\nM30\nO1\nM99\n") == text


def test_a_refused_call_changes_nothing() -> None:
    channel = prepare("G0 X1\nG91 G1 F100 S500 X5 M98 P9\n")
    assert channel.error is not None
    assert listing(channel) == ["rapid X1 stop"]
    assert channel.state.spindle.speed == 0.0


# --- many calls


def test_many_short_calls_in_a_long_file_are_fast_enough_to_be_tested() -> None:
    """A call scans only a little of what lies after the sub-program."""
    calls = 2000
    filler = "(something long that nobody reads)\n" * 20_000
    program = f"G91 G0 X1\nM98 P5 L{calls}\nM30\nO5\nY.01\nM99\n{filler}"
    channel: Channel = prepare(program)
    assert channel.error is None
    assert len(listing(channel)) == calls + 2
