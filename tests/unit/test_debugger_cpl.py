"""CPL under the debugger: its lines are stepped, stopped at, and the variables are those of that moment."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc import runner
from polycnc.cnc import RunState, Step
from polycnc.nc import ProgramText
from polycnc.runner import Debugger, Place

MAIN = """10 SUM=0.5
20 FOR I%=1 TO 3
N10 G1 X[I%*10] F6000
30 SUM=SUM+I%
40 CALL SUB[SUM]
50 NEXT I%
60 #RESULT=SUM
N20 X5
"""
SUB = """10 HALF=P1/2
N110 G1 Y[HALF] F6000
20 #LAST=HALF
"""


@pytest.fixture
def debugger(tmp_path: Path) -> Debugger:
    (tmp_path / "main.npg").write_text(MAIN)
    (tmp_path / "SUB").write_text(SUB)
    return Debugger(ProgramText.from_path(tmp_path / "main.npg"))


def line(found: Place | None) -> tuple[str, int] | None:
    return None if found is None else (Path(found.program).name, found.line)


def stand(debugger: Debugger, step: Step | None = None) -> tuple[str, int] | None:
    """Go on, one step or to the next stop; return what comes next."""
    if step is None:
        debugger.run()
    else:
        debugger.step(step)
    debugger.pass_time(100_000)
    return line(debugger.next)


def test_a_breakpoint_on_a_cpl_line_stops_before_it_with_its_variables(debugger: Debugger) -> None:
    debugger.toggle_breakpoint(Place(debugger.program.name, 4))
    assert stand(debugger) == ("main.npg", 4)
    found = debugger.variables()
    assert (found["SUM"], found["I%"]) == (0.5, 1)
    assert debugger.status.axes["X"].machine == 10
    assert stand(debugger) == ("main.npg", 4)
    found = debugger.variables()
    assert (found["SUM"], found["I%"], found["#LAST"]) == (1.5, 2, 0.75)
    assert (debugger.status.axes["X"].machine, debugger.status.axes["Y"].machine) == (20, 0.75)
    debugger.toggle_breakpoint(Place(debugger.program.name, 4))
    assert stand(debugger) is None
    assert debugger.status.channel.run_state is RunState.COMPLETED
    assert debugger.variables()["#RESULT"] == 6.5


def test_a_breakpoint_in_a_sub_program_shows_its_own_variables(debugger: Debugger) -> None:
    debugger.toggle_breakpoint(Place("SUB", 3))
    assert stand(debugger) == ("SUB", 3)
    found = debugger.variables()
    assert (found["HALF"], "SUM" in found, found["#LAST"]) == (0.75, False, None)
    assert debugger.text("SUB").content == SUB.encode()


def test_every_line_is_stepped_once_in_its_order(debugger: Debugger) -> None:
    seen = [stand(debugger, Step.INTO) for _ in range(11)]
    assert seen == [
        ("main.npg", 2), ("main.npg", 3), ("main.npg", 4), ("main.npg", 5), ("SUB", 1), ("SUB", 2), ("SUB", 3),
        ("main.npg", 3), ("main.npg", 4), ("main.npg", 5), ("SUB", 1),
    ]  # fmt: skip
    assert debugger.variables()["P1"] == 3.5


def test_a_step_over_a_call_stops_behind_it(debugger: Debugger) -> None:
    debugger.toggle_breakpoint(Place(debugger.program.name, 5))
    assert stand(debugger) == ("main.npg", 5)
    assert stand(debugger, Step.OVER) == ("main.npg", 3)
    debugger.toggle_breakpoint(Place(debugger.program.name, 5))
    debugger.toggle_breakpoint(Place("SUB", 1))
    assert stand(debugger) == ("SUB", 1)
    assert stand(debugger, Step.OUT) == ("main.npg", 3)


def test_stops_change_neither_the_end_nor_the_permanent_variables(debugger: Debugger, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "SUB").write_text(SUB)
    expected = runner.run(tmp_path / "main.npg", root=elsewhere)
    for number in (1, 2, 4, 5, 7):
        debugger.toggle_breakpoint(Place(debugger.program.name, number))
    for _ in range(20):
        if stand(debugger) is None:
            break
    assert debugger.status.channel.run_state is RunState.COMPLETED
    assert {name: axis.machine for name, axis in debugger.status.axes.items()} == expected.end_position_mm
    assert debugger.variables()["#RESULT"] == expected.variables["#RESULT"]


def test_an_endless_loop_is_left_by_a_reset(tmp_path: Path) -> None:
    (tmp_path / "loop.npg").write_text("10 A%=1\n20 GOTO 10\n")
    debugger = Debugger(ProgramText.from_path(tmp_path / "loop.npg"))
    debugger.run()
    assert debugger.pass_time(20) == 20
    debugger.reset()
    assert debugger.status.channel.run_state is RunState.RESET
