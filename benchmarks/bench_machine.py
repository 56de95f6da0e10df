"""Time a whole virtual machine, cycle by cycle: eight axes on a path, servo, plant, switches, recorder."""

from __future__ import annotations

import statistics
import time

from _machines import full_machine
from _measure import Figure, at_least
from _report import run_script
from polycnc.kernel import FOLLOWING_ERROR, RECORDER_FULL, SWITCH_EDGE
from polycnc.machine import Machine

RUNS = 3


def run_cycles(machine: Machine, cycles: int) -> float:
    """Run so many cycles, emptying the recorder when it is full; return the seconds that took."""
    state = machine.state
    clock = state.clock[0]
    clock["mask"] = RECORDER_FULL | FOLLOWING_ERROR | SWITCH_EDGE
    done = 0
    begin = time.process_time()
    while done < cycles:
        done += machine.advance(cycles - done)
        assert not clock["raised"] & (FOLLOWING_ERROR | SWITCH_EDGE)
        state.recorder.filled[0] = 0
    spent = time.process_time() - begin
    assert state.paths.row[0]["head"] < state.paths.row[0]["tail"], "the path was too short"
    return spent


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    cycles = 100_000 if quick else 400_000
    run_cycles(full_machine(), 1000)
    found = []
    for _ in range(RUNS):
        machine = full_machine()
        found.append(cycles * machine.config.cycle_s / run_cycles(machine, cycles))
    rate = statistics.median(found)
    return [
        at_least("8 axes at 1 ms: path, PIDF, plant, limits, recorder", rate, "x real", 1000.0),
        Figure("one cycle", 1e3 / rate, "us"),
    ]


if __name__ == "__main__":
    run_script("Whole virtual machine", figures)
