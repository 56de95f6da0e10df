"""A program that comes while it is executed: however it is cut, and whenever it comes, its path is the whole one's."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.cnc import ProgramRun
from polycnc.machine import MachineConfig
from polycnc.nc import IncomingText
from support.interrupted_runs import (
    JERK,
    ROUND,
    ROUNDING,
    SHARP,
    SHORT,
    SOFT,
    farthest,
    fine_path,
    overload,
    random_program,
)
from support.runs import program_run

Floats = npt.NDArray[np.float64]
LINES = 14
MORE_SEEDS = [pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 15)]
SEEDS = pytest.mark.parametrize("seed", [0, *MORE_SEEDS])
CONFIGS = pytest.mark.parametrize(
    "config", [SHARP, JERK, SHORT, SOFT, ROUND], ids=["sharp", "jerk", "short", "soft", "round"]
)


def coming(rng: np.random.Generator) -> str:
    """Return a random program that calls nothing: what is still coming cannot be called."""
    lines = random_program(rng).split("M30")[0].splitlines()[:LINES]
    return "\n".join([*(line for line in lines if "M98" not in line), "M30", ""])


def open_run(config: MachineConfig) -> tuple[ProgramRun, IncomingText]:
    text = IncomingText("test.nc")
    return program_run(text, config, stands_at_stops=False), text


def chunks(program: str, rng: np.random.Generator) -> list[bytes]:
    data = program.encode()
    cuts = sorted({0, len(data), *rng.integers(0, len(data), int(rng.integers(4, 12))).tolist()})
    return [data[a:b] for a, b in pairwise(cuts)]


def put(run: ProgramRun, text: IncomingText, data: bytes) -> None:
    text.put(text.arrived(data))
    run.feed.wake()


def trace(run: ProgramRun, cycles: int) -> list[list[float]]:
    found = []
    for _ in range(cycles):
        if not run.active and run.state.value != "hold":
            break
        run.advance(1)
        found.append(run.machine.state.setpoint.tolist())
    return found


@CONFIGS
@SEEDS
def test_what_has_come_before_the_start_is_the_whole_program(seed: int, config: MachineConfig) -> None:
    rng = np.random.default_rng([seed, 511])
    program = coming(rng)
    whole = program_run(program, config, stands_at_stops=False)
    whole.start()
    expected = trace(whole, 200_000)
    run, text = open_run(config)
    for piece in chunks(program, rng):
        put(run, text, piece)
    run.start()
    assert trace(run, 200_000) == expected
    assert run.state is whole.state
    assert run.channel.blocks == whole.channel.blocks


@CONFIGS
@SEEDS
def test_a_starved_run_rests_on_the_path_and_keeps_every_limit(seed: int, config: MachineConfig) -> None:
    rng = np.random.default_rng([seed, 512])
    program = coming(rng)
    run, text = open_run(config)
    run.start()
    found: list[list[float]] = []
    first, *more = chunks(program, rng)
    put(run, text, first)
    while not run.reading.starved:
        found += trace(run, 10)
    for piece in more:
        put(run, text, piece)
        found += trace(run, int(rng.choice((30, 200, 4000))))
        match int(rng.integers(0, 4)):
            case 0:
                run.hold()
                found += trace(run, int(rng.integers(1, 300)))
                run.start()
            case 1:
                run.overrides.feed = float(rng.choice((0.13, 0.5, 1.0, 1.7)))
    run.overrides.feed = 1.0
    while run.active:
        found += trace(run, 1000)
    points = np.array(found)
    whole = program_run(program, config, stands_at_stops=False)
    whole.start()
    while whole.active:
        whole.advance(100_000)
    assert run.machine.setpoints == whole.machine.setpoints
    assert overload(points, config) <= ROUNDING
    if config is SHARP:
        assert farthest(points[::29], fine_path(program, config)) < 0.03


@CONFIGS
@SEEDS
def test_time_cut_elsewhere_makes_no_difference(seed: int, config: MachineConfig) -> None:
    rng = np.random.default_rng([seed, 513])
    program = coming(rng)
    pieces = [(piece, int(rng.integers(1, 700))) for piece in chunks(program, rng)]
    ends = []
    for cut in (1, 7, 100_000):
        run, text = open_run(config)
        run.start()
        row = []
        for piece, cycles in pieces:
            put(run, text, piece)
            left = cycles
            while left and run.active:
                left -= run.advance(min(cut, left))
            row.append((run.machine.state.setpoint.tolist(), run.reading.tag, run.reading.starved))
        while run.active:
            run.advance(cut if cut > 1 else 50)
        ends.append((row, run.machine.clock.cycles if cut != 1 else None, run.machine.setpoints))
    assert ends[0][0] == ends[1][0] == ends[2][0]
    assert ends[0][2] == ends[1][2] == ends[2][2]


def test_lines_end_with_any_newline_wherever_they_are_cut() -> None:
    whole = IncomingText("a")
    data = b"G1 X1\r\nX2\rX3\n\r\nX4\r\n"
    whole.put(whole.arrived(data))
    for first in range(len(data)):
        for second in range(first, len(data)):
            cut = IncomingText("a")
            for piece in (data[:first], data[first:second], data[second:]):
                cut.put(cut.arrived(piece))
            assert cut.lines == whole.lines
            assert cut.room >= whole.room
