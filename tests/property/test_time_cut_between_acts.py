"""However time is cut into calls between what an operator does, a control shows the same bits."""

from __future__ import annotations

import random

import numpy as np
import pytest

from polycnc.cnc import Answer, ChannelData, Control, Function
from polycnc.nc.macro import MacroLanguage
from support.cnc_machine import cnc_machine
from support.cut_devices import CALLED
from support.operator_desk import DATA, Desk

ALWAYS, LONG = (34, 119, 7), range(1000, 2000)
ACTS, RESTORES = 14, 17
PROBED = cnc_machine(surface=({"low": {"X": 22.0}, "high": {"X": 90.0}},))
SECOND = "G90 G21 F500\nG1 B20\nG4 P40\nB95 F6000\nM30\n"
MOVES = "G91 G1 X1.25 F2600\nY1.75\nG4 P30\nM99\n"


def _program(rng: random.Random) -> str:
    """Return a program that probes, taps, feeds by revolutions, stops, counts, waits and calls."""
    lines: list[str] = []
    for _ in range(rng.randint(3, 9)):
        lines += rng.choice(
            [
                [f"G1 X{rng.uniform(-9, 20):.3f} Y{rng.uniform(-9, 20):.3f} F{rng.randint(400, 6000)}"],
                [f"G31 X{rng.uniform(15, 40):.3f} F{rng.randint(200, 3000)}", "#101=#5061", "G0 X[#101-5]"],
                ["M3 S900", "G95", f"G1 X{rng.uniform(-9, 20):.2f} F0.35", "G94", "F900"],
                ["M3 S900", f"G84 X{rng.uniform(0, 9):.2f} Z-4.5 R-1. F{rng.randint(900, 1300)}", "G80"],
                ["M29 S600", "G84 Z-4.25 R-1. F600", "G80"],
                [f"G4 P{rng.randint(5, 90)}"],
                ["M8"],
                ["M0"],
                ["/G1 Y3.5 F700"],
                [f"G2 X{rng.uniform(5, 15):.2f} Y{rng.uniform(1, 9):.2f} R40. F2300"],
                ["#1=0", f"WHILE[#1LT{rng.randint(2, 3000)}]DO1", "#1=#1+1", "END1"],
                ["M98 P7"],
                [f"G65 P8 A{rng.randint(1, 40)} B{rng.uniform(0.5, 3):.2f}"],
                ["G91", *["X0.25 Y-0.125"] * rng.randint(2, 30), "G90"],
                ["#3001=0", f"WHILE[#3001LT{rng.randint(3, 90)}]DO1", "#4=#4+1", "END1"],
            ]
        )
    return "\n".join(["G90 G21 F500", "#1=0", "#4=0", *lines, "M30", ""])


def _desk(seed: int) -> Desk:
    rng = random.Random(seed)
    shares = (ChannelData(("X", "Y", "Z"), spindle=True), ChannelData(("B",)))
    channels = shares if rng.random() < 0.4 else ()
    control = Control(
        PROBED,
        dialect="fanuc",
        channels=channels,
        languages=[MacroLanguage() for _ in channels or (None,)],
        servo=rng.random() < 0.3,
        data=DATA[seed % len(DATA)],
        script={(Function.M, 8): Answer(None)} if seed % 3 == 0 else None,
    )
    programs = {"FIRST": _program(rng), "SECOND": SECOND, "O0007": MOVES, "O0008": CALLED}
    for name, text in programs.items():
        control.programs.create(name, text)
    for axis in control.machine.config.axis_names:
        control.manual.referenced[axis] = True
    control.select_program("FIRST")
    control.cycle_start()
    return Desk(control, np.random.default_rng(seed))


def _act(desk: Desk, number: int) -> None:
    if number % RESTORES or any(each.search is not None for each in desk.control.channels):
        desk.rng = np.random.default_rng(number)
        desk.anything()
    else:
        desk.control.restore(desk.control.snapshot())


def _seen(desk: Desk) -> object:
    control = desk.control
    times = [control.timers.seconds(each) for each in control.timers.snapshot().cycles]
    return control.status(), times, control.alarms.active, control.machine.state.setpoint.tolist()


@pytest.mark.parametrize(
    "seeds", [ALWAYS, pytest.param(LONG, marks=[pytest.mark.long, pytest.mark.timeout(0)])]
)
def test_any_cut_between_acts_gives_the_same_bits(seeds: range) -> None:
    for seed in seeds:
        by_ones, by_cuts, at_once = (_desk(seed) for _ in range(3))
        rng = random.Random(-1 - seed)
        for _ in range(ACTS):
            gap, act, done = rng.choice((1, 3, 17, 60, 150, 400)), rng.randrange(1 << 30), 0
            while done < gap:
                cut = min(int(rng.expovariate(1.0 / rng.choice((3.0, 60.0)))) + 1, gap - done)
                assert sum(by_ones.control.advance(1) for _ in range(cut)) == cut
                assert by_cuts.control.advance(cut) == cut
                done += cut
                assert _seen(by_cuts) == _seen(by_ones), f"seed {seed}: {by_ones.log}"
            assert at_once.control.advance(gap) == gap
            assert _seen(at_once) == _seen(by_ones), f"seed {seed} at once: {by_ones.log}"
            for each in (by_ones, by_cuts, at_once):
                _act(each, act)
