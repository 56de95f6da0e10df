"""Every cycle of a run is a row, whatever the run does in it, and the rows come in order."""

from __future__ import annotations

import numpy as np
import pytest

from polycnc.cnc import ProgramRun, RunOptions, RunState
from polycnc.machine import Machine
from polycnc.nc import ProgramText, load_dialect
from support.programs import MILL

TEXT = "G1 X12 F1800\nG4 P0.1\nM0\nX3 Y5\nM30\n"
WRONG = "G1 X12 F1800\nX9 X9\n"


@pytest.mark.parametrize("cut", [1, 53, 700])
@pytest.mark.parametrize("text", [TEXT, WRONG])
def test_no_row_is_lost_in_any_state(text: str, cut: int) -> None:
    times: list[float] = []
    machine = Machine(MILL, record_cycles=61)
    run = ProgramRun(
        machine,
        ProgramText.from_text(text, "part.nc"),
        load_dialect("din"),
        options=RunOptions(),
        rows=lambda rows, tags: times.extend(rows[:, 0].tolist()),
    )

    def passed(cycles: int) -> None:
        done = 0
        while done < cycles:
            done += run.advance(min(cut, cycles - done))

    seen = {run.state}
    passed(217)  # ready
    run.start()
    passed(190)
    run.hold()
    passed(500)
    seen.add(run.state)
    for _ in range(3):
        if run.state in (RunState.HOLD, RunState.PROGRAM_STOP):
            run.resume()
        passed(900)
        seen.add(run.state)
    run.reset()
    passed(333)
    seen.add(run.state)
    run.drain()
    assert np.diff(times) == pytest.approx(MILL.cycle_s)
    assert len(times) == machine.clock.cycles
    end = RunState.COMPLETED if text == TEXT else RunState.ALARM
    assert seen >= {RunState.READY, RunState.HOLD, end, RunState.RESET}
