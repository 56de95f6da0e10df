"""Outputs in step with motion (M62, M63, M67 of LinuxCNC) come when the next motion begins, and stop nothing."""

from __future__ import annotations

import math
import re
from functools import partial

import numpy as np
import pytest

from polycnc import runner
from polycnc.cnc import ProgramRun, RunOptions
from polycnc.machine import Machine
from polycnc.nc import Event, ProgramText, load_dialect
from polycnc.nc.channel._options import ChannelOptions
from support.programs import LINEAR, machine_config, moves, notes

MILL = machine_config(LINEAR, name="mill")
PROGRAM = """\
G21 G90 {rule}
M62 P2
G1 X10 F3000
X20
M67 E1 Q-2.5
M63 P2
X30 M67 E3 Q0.125
M64 P5
M62 P1
G2 X34 I2
M63 P1
S200
M62 P7
G0 Z4
G1 X35
M2
"""
EXPECTED = [
    (2, "M62 P2", 3),
    (5, "M67 E1 Q-2.5", 7),
    (6, "M63 P2", 7),
    (7, "M67 E3 Q0.125", 7),
    (8, "M64 P5", 7),
    (9, "M62 P1", 10),
    (12, "S200", 10),
    (11, "M63 P1", 14),
    (13, "M62 P7", 14),
    (16, "M2", 15),
]
"""Line and word of each event, and the line of the motion that has the setpoint of its time."""


@pytest.mark.parametrize(("rule", "first"), [("G61", 3), ("G64 P0.05 Q0.02", 4)], ids=["exact", "merging"])
def test_each_comes_with_the_first_setpoint_of_the_next_motion(rule: str, first: int) -> None:
    """Merged, lines 3 and 4 are one motion."""
    program = PROGRAM.format(rule=rule)
    result = runner.run(program, MILL, "linuxcnc", trace=True)
    trace, found = result.trace, []
    for event in result.events:
        row = int(np.searchsorted(trace.t_s, event.time_s - 1e-6))
        found.append((event.line, event.word, int(trace.block[row])))
        if event.word[:3] in ("M62", "M63", "M67"):
            assert row == 0 or trace.block[row - 1] < trace.block[row]  # the first one
    assert found == [(2, "M62 P2", first), *EXPECTED[1:]]
    closed = runner.run(program, MILL, "linuxcnc")
    assert list(closed.events) == list(result.events)
    assert closed.time_s == result.time_s


def test_a_rounded_corner_belongs_to_the_motion_before() -> None:
    result = runner.run("G64 P0.1 F3000\nG1 X10\nM62 P1\nY10\nM2\n", MILL, "linuxcnc", trace=True)
    at = result.trace.setpoint[round(result.events[0].time_s * 1000.0) - 1]
    assert at[0] == 10.0
    assert 0.1 < at[1] < 0.4


def test_they_cost_no_time() -> None:
    points = [(0.4 * n, 3.0 * math.sin(0.1 * n)) for n in range(1, 120)]
    plain = "".join(f"X{x:.3f} Y{y:.3f}\n" for x, y in points)
    words = "".join(f"M67 E2 Q{n}\nX{x:.3f} Y{y:.3f} M62 P{n % 3}\n" for n, (x, y) in enumerate(points))
    head = "G21 G64 P0.01 F2400\nG1\n"
    times = [runner.run(head + blocks + "M2\n", MILL, "linuxcnc").time_s for blocks in (plain, words)]
    assert times[0] == times[1]


def test_one_at_once_stops() -> None:
    assert moves("G1 X1 F300\nM65 P1\nX2\nM63 P1\nX3\n", dialect="linuxcnc") == [
        "line X1 F300 stop",
        "M65 P1",
        "line X2 F300",
        "line X3 F300 with M63 P1",
    ]


@pytest.mark.parametrize("end", ["M2\n", "", "G4 P0.1\nG0 X1\nM30\n"])
def test_one_that_no_motion_follows_does_nothing(end: str) -> None:
    program = f"G0 X1\nM62 P3\n{end}"
    assert "M62 P3" not in [event.word for event in runner.run(program, MILL, "linuxcnc").events]
    assert "M62 P3 does nothing: no move follows" in notes(program, dialect="linuxcnc")


def _met(program: str, *, compiled: bool, skips: bool, passes: bool) -> list[tuple[float, int, str]]:
    """Return what a run tells, of whom nobody lets events pass, or somebody does."""
    found: list[tuple[float, int, str]] = []

    def met(event: Event) -> bool:
        found.append((run.machine.time_s, event.line, event.word))
        return False

    with pytest.MonkeyPatch.context() as patch:
        options = partial(ChannelOptions, ordinary_blocks=0 if compiled else math.inf)
        patch.setattr("polycnc.cnc._run_channels.ChannelOptions", options)
        run = ProgramRun(
            Machine(MILL),
            ProgramText.from_text(program, "part.ngc"),
            load_dialect("linuxcnc"),
            options=RunOptions(stands_at_stops=False, answers=not passes),
            on_event=met,
        )
    run.start()
    while run.active:
        if skips:
            run.skip()
        else:
            run.advance(23)
    assert run.error is None
    return found


def test_every_way_of_running_tells_the_same() -> None:
    blocks = "".join(f"M67 E1 Q{n % 9}\nX{n * 0.25} Y{n % 3}\n" for n in range(40))
    program = f"G21 F3000 G1\n{blocks}M62 P4\nM3 S50\nX1 M63 P4\nM2\n"
    expected = _met(program, compiled=False, skips=False, passes=True)
    assert len(expected) == 44
    for compiled in (False, True):
        for skips in (False, True):
            assert _met(program, compiled=compiled, skips=skips, passes=True) == expected
    assert _met(program, compiled=True, skips=False, passes=False) == expected


def test_many_within_a_cycle_are_all_told() -> None:
    blocks = "".join(f"M62 P{n % 7}\n" * 3 + f"X{n * 0.0005:.4f}\n" for n in range(1, 700))
    result = runner.run(f"G21 F6000 G64 G1\n{blocks}M2\n", MILL, "linuxcnc")
    assert [event.line for event in result.events][:-1] == [
        4 * n + 2 + k for n in range(699) for k in range(3)
    ]
    times = [event.time_s for event in result.events]
    assert times == sorted(times)


def test_blocks_of_any_mixture_are_as_the_reference_interpreter_has_them() -> None:
    rng = np.random.default_rng(4)
    words = (
        "M62 P1",
        "M67 E0 Q3",
        "M67 E2 Q4.5",
        "M63 P2",
        "S80",
        "M3",
        "M8",
        "M5 S20",
        "M68 E1 Q1",
        "",
        "",
        "",
    )
    lines = ["G21 G64 P0.05 Q0.02 F3000 G1"]
    for n in range(200):
        move = rng.choice((f"X{n % 13}.5", f"Y{n % 5} X{n % 3}", "", "G0 Z2", "G1 Z3", "X0", "X0"))
        lines.append(" ".join(filter(None, rng.permutation([str(move), str(rng.choice(words))]))))
    for table in ("", "[spindle]\nlaser = true\n"):
        config = machine_config(LINEAR, table, name="mixed")
        program = "\n".join(lines) + "\nX99\n"
        listed = [
            moves(program, config=config, dialect="linuxcnc", ordinary_blocks=least)
            for least in (0, math.inf)
        ]
        assert listed[0] == listed[1]
        assert sum(bool(re.search(r"with M6", each)) for each in listed[0]) > 20
