"""The plugin for pytest: devices fresh in each test, reports that show where they are and hide no failure."""

from __future__ import annotations

import subprocess
import sys

import pytest

from support.command import environment

TESTS = r"""
import pytest

SAP = '''program feeder;
var n: longint;
begin
  while true do begin n := n + 1; ci[7] := n end
end.
'''
kept = []

def run(cnc, text, cycles):
    cnc.programs.create("PLATE", text)
    cnc.select_program("PLATE")
    cnc.cycle_start()
    cnc.advance(cycles)

@pytest.mark.parametrize("again", range(2))
def test_new(cnc, again):
    assert (cnc.status().cycle, len(cnc.programs), cnc.status().axes["X"].machine) == (0, 0, 0.0)
    now = cnc.status().now
    run(cnc, "G1 X5 F3000", 83)
    assert (cnc.status().now - now).total_seconds() == 0.083
    kept.append(cnc)

def test_closed(power_mate):
    from polycnc.machine import StoreError

    assert kept[0] is not kept[1]
    for cnc in kept:
        with pytest.raises(StoreError):
            cnc.programs.create("Q", "M30")
    power_mate.close()  # what a test has closed is no trouble

@pytest.mark.parametrize("cnc", ["lathe2"], indirect=True)
@pytest.mark.parametrize("power_mate", [{"axes": 2, "model": "D"}], indirect=True)
@pytest.mark.parametrize("board", ["number_of_axes = 5"], indirect=True)
@pytest.mark.parametrize("card", ["number_of_axes = 3"], indirect=True)
def test_parameters(cnc, power_mate, board, card):
    assert list(cnc.status().axes) == ["X", "Z"]
    assert (power_mate.axes, power_mate.model, len(board.axes), card.axes) == (2, "D", 5, 3)

def test_line(cnc):
    run(cnc, "G1 X42.5 F3000\n\n(down) G1 Z-7.25\nM30\n", 1_000)
    assert 17 == 19

def test_alarm(cnc):
    run(cnc, "G0 Y3\nM98 P1000\n", 90)
    assert cnc.alarms.active == ()

def test_all(power_mate, board, card):
    from polycnc.controllers.apci import BoardTasks
    from polycnc.controllers.apci.sap import compile_program

    power_mate.programs.register(7, "O0007\nG1X3.7F6000\nM98P21\nM30\n")
    power_mate.programs.register(21, "O0021\nG4X2.\nM99\n")
    power_mate.select_mode("MEM")
    power_mate.select_program(7)
    power_mate.cycle_start()
    power_mate.advance(700)
    power_mate.operator_message(2003, "LOW AIR")
    tasks = BoardTasks(board)
    tasks.load(compile_program(SAP, task=2))
    tasks.startcnct(2)
    board.advance(11)
    card.advance(13)
    raise ValueError("here")

def test_unreadable(card):
    card.status = None
    assert 7 == 11

class TestOwn:
    @pytest.fixture
    def board(self):
        return "pcb"

    def test_own(self, board):
        assert board == "plank"

@pytest.fixture
def late():
    yield
    raise RuntimeError("too late")

def test_late(late, card):
    pass
"""


@pytest.fixture(scope="module")
def output(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Run the tests once, in a process of their own, and return what pytest prints."""
    folder = tmp_path_factory.mktemp("tests")
    (folder / "test_it.py").write_text(TESTS, encoding="utf-8")
    options = ["-W", "error", "-p", "polycnc.testing", "-p", "no:cacheprovider"]
    quick = environment(PYTEST_DISABLE_PLUGIN_AUTOLOAD="1", POLYCNC_COMPILE_AT_ONCE="")
    command = [sys.executable, "-m", "pytest", *options, "test_it.py"]
    done = subprocess.run(command, cwd=folder, env=quick, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    return done.stdout


def _report(output: str, test: str) -> list[str]:
    """Return the lines about one failed test."""
    after = output[output.index(f" {test} __") :].splitlines()[1:]
    return after[: next(i for i, line in enumerate(after) if line.startswith(("____", "====")))]


def _in_order(lines: list[str], *wanted: str) -> None:
    """Hold lines that begin so, blanks counted as one, against a report."""
    left = iter(" ".join(line.strip("- ").split()) for line in lines)
    for each in wanted:
        assert any(line.startswith(each) for line in left), (each, lines)


def test_devices_are_new_and_closed_and_their_clocks_are_stepped(output: str) -> None:
    assert "5 failed, 5 passed, 1 error in" in output  # new, new, closed, parameters, late


def test_a_failed_test_shows_program_line_and_positions(output: str) -> None:
    _in_order(
        _report(output, "test_line"),
        "E assert 17 == 19",
        "polycnc: cnc",
        "after 1.000 s (1000 cycles), mode auto",
        "program PLATE: active",
        "PLATE:3: (down) G1 Z-7.25",
        "axis machine work to go",
        "X 42.5000 42.5000 0.0000 mm",
        "Z -",
    )


def test_calls_alarms_and_every_device_that_is_used_are_shown(output: str) -> None:
    _in_order(_report(output, "test_alarm"), "program PLATE: alarm", "alarm 100: PLATE:2:5: there is no sub")
    _in_order(
        _report(output, "test_all"),
        "polycnc: power_mate",
        "program O0007: active",
        "called from O0007:3",
        "O0021:2: G4X2.",
        "message 2003: LOW AIR",
        "X 3.7000 3.7000 0.0000 mm",
        "polycnc: board",
        "after 0.014 s (11 cycles)",
        "task 2: feeder:4: running",
        "axis rp dp axst queued",
        "polycnc: card",
        "after 0.013 s (13 cycles)",
    )


def test_a_device_that_cannot_be_read_does_not_hide_the_failure(output: str) -> None:
    _in_order(
        _report(output, "test_unreadable"), "E assert 7 == 11", "polycnc: card", "its state cannot be read"
    )


def test_a_fixture_of_the_same_name_goes_before_and_is_not_shown(output: str) -> None:
    assert "polycnc:" not in "\n".join(_report(output, "TestOwn.test_own"))


def test_an_error_after_a_device_was_closed_shows_the_error_alone(output: str) -> None:
    assert "RuntimeError: too late" in output
    assert "polycnc:" not in "\n".join(_report(output, "ERROR at teardown of test_late"))
