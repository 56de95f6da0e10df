"""Time a caller that steps its machine from Python, one control cycle per call."""

from __future__ import annotations

from _machines import full_machine
from _measure import Figure, at_least, median_s
from _report import run_script
from polycnc.kernel import advance
from polycnc.machine import Machine, load_machine

RUNS = 5


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    calls = 5_000 if quick else 20_000
    eight = full_machine(record_cycles=0)
    three = Machine(load_machine("mill3"))

    def kernel_calls() -> None:
        for _ in range(calls):
            advance(eight.state, 1)

    def machine_calls(machine: Machine) -> None:
        for _ in range(calls):
            machine.advance(1)

    return [
        at_least(
            "kernel: advance(state, 1), 8 axes", calls / median_s(kernel_calls, RUNS), "calls/s", 50_000
        ),
        Figure("Machine.advance(1), 8 axes", calls / median_s(lambda: machine_calls(eight), RUNS), "calls/s"),
        Figure(
            "Machine.advance(1), 3 axes at rest",
            calls / median_s(lambda: machine_calls(three), RUNS),
            "calls/s",
        ),
    ]


if __name__ == "__main__":
    run_script("One cycle per call", figures)
