"""The debugger without its screen: stops, steps, and that the path stays what it is."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from polycnc import runner
from polycnc.cli._debug import debug_command
from polycnc.cnc import ControlError, RunState
from polycnc.errors import UsageError
from polycnc.nc import ProgramText
from polycnc.runner import Debugger, Place

MAIN = "N10 G1 X4.5 F6000\nN20 M98 P815\nN30 X7.25 Y1.5\nN40 M0\nN50 Z-2.75\nN60 M30\n"
SUB = "O0815\nN110 G91 Y2.25\nN120 Y3.5\nN130 G90\nM99\n"


@pytest.fixture
def debugger(tmp_path: Path) -> Debugger:
    (tmp_path / "main.nc").write_text(MAIN)
    (tmp_path / "O0815.nc").write_text(SUB)
    return Debugger(ProgramText.from_path(tmp_path / "main.nc"), dialect="fanuc")


def positions(debugger: Debugger) -> dict[str, float]:
    return {name: axis.machine for name, axis in debugger.status.axes.items()}


def place(found: Place | None) -> tuple[str, int] | None:
    return None if found is None else (Path(found.program).name, found.line)


def test_it_stops_before_a_breakpoint_in_a_sub_program_of_its_own_file(
    debugger: Debugger, tmp_path: Path
) -> None:
    sub = Place(str(tmp_path / "O0815.nc"), 3)
    assert debugger.toggle_breakpoint(sub)
    debugger.run()
    debugger.pass_time(100_000)
    assert not debugger.running
    assert place(debugger.executed) == ("O0815.nc", 2)
    assert place(debugger.next) == ("O0815.nc", 3)
    assert positions(debugger) == {"X": 4.5, "Y": 2.25, "Z": 0.0}
    block = debugger.status.channel.block
    assert block is not None
    assert [(Path(call.program).name, call.line) for call in block.stack] == [("main.nc", 2)]
    assert "G91" in block.modal.g.values()
    debugger.step()
    debugger.pass_time(100_000)
    assert positions(debugger)["Y"] == 5.75
    assert not debugger.toggle_breakpoint(sub)
    debugger.run()
    debugger.pass_time(100_000)
    assert debugger.status.channel.run_state.value == "program stop"
    debugger.run()
    debugger.pass_time(100_000)
    assert debugger.status.channel.run_state.name == "COMPLETED"


def test_stepping_through_ends_where_the_undisturbed_run_ends(debugger: Debugger) -> None:
    expected = runner.run(debugger.program, dialect="fanuc", check=False).end_position_mm
    seen = []
    for _ in range(30):
        debugger.step()
        debugger.pass_time(100_000)
        seen.append(place(debugger.executed))
        if debugger.status.channel.run_state is RunState.COMPLETED:
            break
    assert debugger.status.channel.run_state is RunState.COMPLETED
    assert positions(debugger) == expected
    inside = [each for each in seen if each and each[0] == "O0815.nc"]
    assert inside == [("O0815.nc", line) for line in (1, 2, 3, 4, 5)]


def test_a_breakpoint_on_the_first_block_stops_before_it_moves(debugger: Debugger) -> None:
    debugger.toggle_breakpoint(Place(debugger.program.name, 1))
    debugger.run()
    debugger.pass_time(1000)
    assert positions(debugger)["X"] == 0.0
    assert not debugger.running
    debugger.run()
    debugger.pass_time(100_000)
    assert positions(debugger)["X"] == 7.25


def test_a_hold_in_the_middle_then_a_step(debugger: Debugger) -> None:
    debugger.run()
    debugger.pass_time(20)
    debugger.hold()
    debugger.hold()
    debugger.control.advance(100)
    assert 0.0 < positions(debugger)["X"] < 4.5
    debugger.step()
    debugger.pass_time(100_000)
    assert positions(debugger) == {"X": 4.5, "Y": 0.0, "Z": 0.0}
    debugger.reset()
    debugger.run()
    debugger.pass_time(100_000)
    assert positions(debugger)["Y"] == 1.5


def test_what_cannot_be_done_says_so(debugger: Debugger) -> None:
    with pytest.raises(UsageError, match="no line 70"):
        debugger.toggle_breakpoint(Place(debugger.program.name, 70))
    assert debugger.breakpoints == frozenset()
    assert debugger.change_feed_override(5.0) == 2.0
    assert debugger.change_feed_override(-5.0) == 0.0
    debugger.change_feed_override(1.0)
    debugger.control.emergency_stop()
    with pytest.raises(ControlError, match="emergency"):
        debugger.run()


class NoTerminal:
    """A stream that leads to a file, a pipe or /dev/null."""

    def isatty(self) -> bool:
        return False


@pytest.mark.parametrize("stream", [None, NoTerminal()], ids=["closed", "redirected"])
@pytest.mark.parametrize("name", ["stdin", "stdout"])
def test_the_screen_is_refused_without_a_terminal(
    name: str, stream: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "main.nc"
    program.write_text("G1 X4.5 F600\n")
    monkeypatch.setattr(sys, name, stream)
    with pytest.raises(UsageError, match="needs a terminal"):
        debug_command(program)
