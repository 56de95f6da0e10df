"""What a run and a check say besides errors: functions that counted no time, home at the part's zero, remarks."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import polycnc
from polycnc.machine import MachineConfig, load_machine
from polycnc.runner import inspect
from support.programs import LINEAR, SPINDLE, machine_config, prepare

TIMED = machine_config(
    LINEAR, SPINDLE, "[times]\ntool_change_s = 5\nspindle_start_s = 2\nauxiliary_s = 0.25\n"
)
NO_CHANGE_TIME = machine_config(LINEAR, SPINDLE, "[times]\nspindle_start_s = 2\nauxiliary_s = 0.25\n")
PART = (
    "(HEADER)\nG90 G21\n(FACE)\nT3 M6\nS900 M3\nG0 X5 Z2\nG1 Z-1 F300\nX25\nG0 Z30\n(PLUNGE)\nT4 M6\nM3\nG0 X7\n"
    "G1 Z-4 F150\nG0 Z30\n(CONTOUR)\nS1200 M3\nG1 X15.5 F1000\nM30\n"
)


def remarks(program: str, **options: object) -> list[tuple[str, int, int]]:
    report = inspect(program, **options)  # type: ignore[arg-type]
    assert report.errors == []
    return [(each.key, each.position.line, each.count) for each in report.remarks]


def counted_nothing(program: str, config: str | MachineConfig) -> str:
    result = polycnc.run(program, config)
    return next((each.text for each in result.messages if "counted 0 s" in each.text), "")


# --- functions that counted no time


def test_what_counted_no_time_is_said() -> None:
    text = counted_nothing(PART + "", "mill3")
    assert text == (
        "2 tool changes and 3 spindle starts counted 0 s: a machine file says in [times] how long they take "
        "(preset vmc3 does)"
    )
    assert counted_nothing("M8\nM7\nM77\nM5\nM9\nG0 X1\n", "mill3").startswith(
        "5 other functions counted 0 s"
    )
    assert counted_nothing("T1 M6\n\n", "mill3").startswith("1 tool change counted 0 s")


def test_what_counted_is_not_said() -> None:
    assert counted_nothing(PART, TIMED) == ""
    assert counted_nothing(PART, NO_CHANGE_TIME).startswith("2 tool changes counted 0 s")
    assert counted_nothing("G0 X1\nS500\nM0\nM30\n", "mill3") == ""
    ramp = machine_config(LINEAR, "[spindle]\nacceleration_rpm_s = 500\n")
    assert counted_nothing("M3 S100\nG0 X1\n", ramp) == ""


# --- home


def test_home_at_the_zero_of_the_part_is_said_once() -> None:
    result = polycnc.run("G0 X5 Z7\nG91 G28 Z0\nG28 X0\nM30\n", "mill3")
    found = [(each.text, each.line, each.count) for each in result.messages]
    assert found == [
        ("G28: home lies at the part's zero on machine 'mill3'; a machine file says where it is", 2, 2)
    ]
    assert polycnc.run("G0 X-5 Z7\nG91 G28 Z0\nG28 X0\nM30\n", "vmc3").messages == []


def test_the_machining_centre_counts_what_it_does() -> None:
    """Three tool changes, three starts of the spindle, one stop, two coolant codes: as its file says."""
    machine = load_machine("vmc3")
    result = polycnc.run("T1 M6\nS1000 M3\nM8\nG0 X1 Y2 Z3\nM9\nM5\nG53 G0 Z0\nM30\n", machine)
    times = machine.times
    assert result.waiting_time_s == pytest.approx(
        times.tool_change_s + 2 * times.spindle_start_s + 2 * times.auxiliary_s, abs=0.006
    )
    assert result.end_position_mm["Z"] == 0.0
    assert all(axis.home == axis.soft_limits[1] for axis in machine.axes)


# --- operations


def test_operations_begin_with_tools_and_with_functions_behind_remarks() -> None:
    result = polycnc.run(PART, TIMED)
    assert [(each.name, each.line, each.tool) for each in result.operations] == [
        ("FACE", 4, 3),
        ("PLUNGE", 11, 4),
        ("CONTOUR", 17, 4),
    ]
    face, plunge, contour = result.operations
    assert face.cutting_s == pytest.approx(3 / 5 + 20 / 5, abs=0.02)
    assert plunge.cutting_s == pytest.approx(34 / 2.5, abs=0.02)
    assert contour.cutting_s == pytest.approx(8.5 / (1000 / 60), abs=0.02)
    assert face.time_s == pytest.approx(7.0 + face.cutting_s + face.rapid_s, abs=0.01)
    assert contour.time_s == pytest.approx(2.0 + contour.cutting_s, abs=0.01)
    assert sum(each.time_s for each in result.operations) == pytest.approx(result.time_s)
    assert sum(each.cutting_s for each in result.operations) == pytest.approx(result.cutting_time_s)
    assert sum(each.rapid_s for each in result.operations) == pytest.approx(result.rapid_time_s)
    assert result.as_dict()["operations"][1] == {
        "name": "PLUNGE",
        "line": 11,
        "tool": 4,
        "time_s": plunge.time_s,
        "cutting_time_s": plunge.cutting_s,
        "rapid_time_s": plunge.rapid_s,
    }


def test_what_cuts_before_the_first_function_is_an_operation_of_its_own() -> None:
    result = polycnc.run("F600\nG1 X10\n(SECOND)\nM8\nG1 X25\n(END)\nM9\nG0 X0\nM30\n", TIMED)
    assert [(each.name, each.line) for each in result.operations] == [("", 1), ("SECOND", 4)]
    assert result.operations[1].rapid_s == pytest.approx(result.rapid_time_s)


def test_functions_in_sub_programs_begin_nothing() -> None:
    result = polycnc.run("T1 M6\nM98 P7\nG1 X5 F500\nM30\nO7\n(NOT HERE)\nM8\nG1 X3 F500\nM99\n", TIMED)
    assert [(each.name, each.line, each.tool) for each in result.operations] == [("", 1, 1)]
    assert polycnc.run("G0 X1\nG0 X2\n").operations == []


def test_block_numbers_and_semicolons_do_not_hide_a_remark() -> None:
    result = polycnc.run("N1 (FIRST)\nN2 T1 M6\nG1 X5 F500\n; SECOND ;\nN4 T2 M6\nG1 X9\n", TIMED)
    assert [each.name for each in result.operations] == ["FIRST", "SECOND ;"]


# --- remarks of check


@pytest.mark.parametrize(("code", "said"), [("G90", "U and W"), ("G94", "feed per minute is G98")])
def test_codes_of_another_system_for_lathes_are_remarked(code: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text(f"O1\nT0101\n{code} G40\nG97 S500 M3\nG0 X20. Z2.\n{code} X18. Z-5. F.1\nX17.\nM30\n")
    report = inspect(path, dialect="fanuc-lathe")
    assert [(each.key, each.position.line) for each in report.remarks if said in each.text] == [
        ("code_system", 3)
    ]
    path.write_text("O1\nT0101\nG95\nM30\n")
    (error,) = inspect(path, dialect="fanuc-lathe").errors
    assert (
        error.hint
        == "The dialect is G code system A: feed per revolution is G99. System B is dialect fanuc-lathe-b."
    )
    assert not inspect(path, dialect="fanuc-lathe-b").errors


def test_cutting_with_the_spindle_at_rest_or_without_a_tool() -> None:
    cut = "G0 X5\nG1 Z-1 F100\nX9\n"
    assert remarks(cut) == [("spindle_off", 2, 2), ("no_tool", 2, 2)]
    assert remarks("T1 M6\n" + cut) == [("spindle_off", 3, 2)]
    assert remarks("T1 M6\nM3 S500\n" + cut) == []
    assert remarks("T1 M6\nM4 S500\n" + cut + "M5\nG0 Z9\nX1\nG1 X2\n") == [("spindle_off", 9, 1)]
    assert remarks("M3 S500\nG0 X5\n") == []
    assert remarks("T1 M6\nM3 S500\nG81 X5 Z-3 R2 F100\n") == []
    assert remarks("M3 S500\n" + cut, dialect="grbl") == []  # which has no tools


@pytest.mark.parametrize("blocks", [3, 5000])
def test_the_remark_names_the_first_place_however_blocks_are_read(blocks: int) -> None:
    program = "T1 M6\nM3 S500\nG1 X1 F100\nM5\n" + "".join(f"X{n / 10}\n" for n in range(blocks))
    assert remarks(program + "M30\n") == [("spindle_off", 5, blocks)]


READY = "T1 M6\nM3 S900 F400\n"


@pytest.mark.parametrize(
    ("moves", "line"),
    [
        # Fed in from Z2, cut at -1 and -2.5, then across at rapid at -2.5.
        ("G0 X0 Z2\nG1 Z-1\nX20\nZ-2.5\nX0\nG0 X30\n", 8),
        ("G0 X0 Z2\nG1 Z-1\nX20\nG0 X30 Z5\n", 6),  # a slant out of it
        ("G0 X0 Z2\nG1 Z-1\nX20\nG0 Z2\nX30 Z-1\n", 7),  # a slant into it
    ],
)
def test_rapids_across_where_it_has_cut(moves: str, line: int) -> None:
    assert remarks(READY + moves) == [("rapid_in_material", line, 1)]


@pytest.mark.parametrize(
    "moves",
    [
        "G0 X0 Z5\nG1 Z1\nX20\nG0 Z5\nG28 G91 Z0\nG28 X0\n",  # home, which nobody has set
        "G0 X0 Z5\nG1 Z-1\nX20\nG0 Z2\nX30\n",  # across at 2, above what has been cut
        "G0 X0 Z2\nG1 Z-1\nX20\nG0 Z10\nX30\nZ2\nG1 Z-2\nX9\nG0 Z2\nX1\n",
        "G0 X0 Z2\nG1 Z-1\nX20\nG0 Z-0.5\nZ2\nX30\n",  # along Z only
        "G0 X0 Z2\nG83 X5 Y5 Z-9 Q2 R1\nX9\nX15 Y2\nG80\nG0 X0\n",
        "G0 X0 Z-8\nG1 X20\nG0 Z-5\nX40\n",  # part zero elsewhere
        "G0 X0 Z2\nG1 Z-1\nX20\nG0 Z9\nT2 M6\nM3\nG0 X9 Z-5\n",  # another tool, another place
    ],
)
def test_rapids_that_are_fine(moves: str) -> None:
    assert remarks(READY + moves) == []


def test_what_follows_a_line_that_begins_with_a_percent_sign() -> None:
    assert remarks("%\nG0 X1\n% fan on\nG0 X2\n") == [("unread", 3, 1)]
    assert remarks("% begin\nG0 X1\n%\nO2\nG0 X2\n") == []


def test_a_program_stop_waits() -> None:
    program = READY + "G0 X1\nM0\nG0 X2\nM00\nM1\n"
    assert remarks(program) == [("program_stop", 4, 2)]
    assert polycnc.check(program) == []
    (error,) = polycnc.check(program, strict=True)
    assert error.code == "program_stop"
    assert str(error).splitlines()[0] == (
        "<text>:4:1: M0 stops the program until the operator starts it again [program_stop]"
    )
    assert error.hint


def test_a_remark_in_a_sub_program_names_its_file(tmp_path: Path) -> None:
    (tmp_path / "O0007.nc").write_text("(\n\n\n\n".replace("(", "(a)") + "\n\n\nM0\nM99\n")
    main = tmp_path / "main.nc"
    main.write_text("M98 P7\nM30\n")
    (remark,) = inspect(main).remarks
    assert (remark.position.file, remark.position.line) == (str(tmp_path / "O0007.nc"), 8)
    assert len(polycnc.check(main, strict=True)) == 1


# --- a program that calls itself


@pytest.mark.parametrize("calls", [1, 9])
def test_a_program_that_calls_itself_is_reported_once_for_each_call(calls: int) -> None:
    program = "M98 P1\nM30\nO1\n" + "G91 G0 X1\nM98 P1\n" * calls + "M99\n"
    channel = prepare(program, collect_errors=True)
    assert [error.position.line for error in channel.errors if error.position] == [
        5 + 2 * n for n in range(calls)
    ]
    assert {error.what for error in channel.errors} == {"sub-programs are nested more than 7 deep"}
    assert channel.blocks < 12 * (calls + 1) * 8


def test_two_programs_that_call_each_other() -> None:
    program = "M98 P1\nM30\nO1\n" + "M98 P2\n" * 6 + "M99\nO2\n" + "M98 P1\n" * 6 + "M99\n"
    channel = prepare(program, collect_errors=True)
    assert len(channel.errors) == 6
    assert channel.blocks < 500


def test_macros_that_call_themselves_are_reported_once_for_each_call() -> None:
    program = "#1=1\nM98 P1\nM30\nO1\n" + "#2=3\nM98 P1\n" * 5 + "M99\n"
    errors = polycnc.check(program, dialect="fanuc")
    assert [error.position.line for error in errors if error.position] == [6, 8, 10, 12, 14]


# --- results


def test_results_and_traces_are_short_in_a_notebook() -> None:
    result = polycnc.run(PART, TIMED, trace=True)
    assert repr(result) == f"<RunResult {result}>"
    assert len(repr(result.trace)) < 80
    assert repr(result.trace).startswith("<Trace of X Y Z: ")
    html = result._repr_html_() + result.trace._repr_html_()
    assert html.count("<table>") == html.count("</table>") == 2
    assert "FACE" in html
    tricky = polycnc.run("(<b>&)\nT1 M6\nG1 X1 F99\n", TIMED)
    assert "&lt;b&gt;&amp;" in tricky._repr_html_()
    assert math.isfinite(result.trace.t_s[-1])


# --- nothing at all


@pytest.mark.parametrize("text", ["\n", "%\n\n  %\r\n", "\0\n"])
@pytest.mark.parametrize("dialect", ["din", "fanuc", "bosch"])
def test_an_empty_program_is_remarked(text: str, dialect: str) -> None:
    assert remarks(text, dialect=dialect) == [("empty", 1, 1)]
    messages = [each.text for each in polycnc.run(text, dialect=dialect, check=False).messages]
    assert messages == ["the program is empty"]
    assert [error.code for error in polycnc.check(text, dialect=dialect, strict=True)] == ["empty"]


@pytest.mark.parametrize("text", ["%\nM30\n%\n", "#100=7\n"])
def test_a_program_that_only_ends_or_computes_is_not_empty(text: str) -> None:
    assert remarks(text, dialect="fanuc") == []
