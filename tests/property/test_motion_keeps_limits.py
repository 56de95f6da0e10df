"""Every cycle of every path keeps every axis' limits; counting the cycles gives the same as running them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from polycnc.kernel import (
    PATH_RESTED,
    RECORDER_FULL,
    KernelState,
    advance,
    append_line,
    replan_path,
    skip,
    start_path,
)
from support.random_paths import (
    CYCLE_S,
    PathMaker,
    PathSettings,
    blocks,
    is_done,
    machine,
    overload,
    prepare,
    random_path,
    run_recorded,
    run_with_changes,
    seeds,
)

ROUNDING = 1.0 + 1e-6
SETTINGS = (
    PathSettings(),
    PathSettings(tolerance=0.01),
    PathSettings(jerkrel=0.3),
    PathSettings(jerkrel=1.0),
    PathSettings(depth=2),
    PathSettings(depth=16),
)


@pytest.mark.parametrize("settings", SETTINGS, ids=str)
def test_random_paths_keep_the_limits_in_every_cycle(settings: PathSettings) -> None:
    for seed in seeds(0, 25):
        state = random_path(seed, settings)
        run_recorded(state)
        speed, acceleration = overload(state)
        assert speed <= ROUNDING, f"seed {seed}"
        assert acceleration <= ROUNDING, f"seed {seed}"


@pytest.mark.parametrize("length", [0.003, 0.02, 0.1, 0.4])
def test_segments_around_the_travel_of_one_cycle_keep_the_limits(length: float) -> None:
    for seed in seeds(1000, 1025):
        state = random_path(seed, PathSettings(), length)
        run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"


@pytest.mark.long
@pytest.mark.parametrize("settings", SETTINGS, ids=str)
def test_many_random_paths_keep_the_limits_in_every_cycle(settings: PathSettings) -> None:
    for seed in seeds(0, 1000):
        state = random_path(seed, settings)
        run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"


def rest_of(state: KernelState) -> int:
    return int(state.paths.row[0]["tail"])


@pytest.mark.parametrize("settings", SETTINGS, ids=str)
def test_counting_cycles_is_running_them(settings: PathSettings) -> None:
    for seed in seeds(40, 60):
        stepped, counted = random_path(seed, settings), random_path(seed, settings)
        stepped.clock[0]["mask"] = PATH_RESTED | RECORDER_FULL
        cycles = 0
        while not is_done(stepped):
            cycles += advance(stepped, 1 << 16)
            stepped.recorder.filled[0] = 0
        assert skip(counted, 0, rest_of(counted)) == cycles
        assert np.array_equal(counted.paths.totals, stepped.paths.totals)
        assert np.array_equal(counted.setpoint, stepped.setpoint)
        last = stepped.seg.end[(rest_of(stepped) - 1) % 4096]
        assert np.array_equal(stepped.setpoint, last)


def test_planning_in_pieces_gives_the_speeds_of_planning_at_once() -> None:
    for seed in seeds(0, 20):
        whole = random_path(seed, PathSettings())
        rng = np.random.default_rng(seed)
        pieces = machine(rng, PathSettings())
        maker = PathMaker(pieces, rng)
        count = int(rng.integers(2, blocks(300)))
        chunks = np.random.default_rng(seed + 1)
        while count > 0:
            chunk = min(int(chunks.integers(1, 40)), count)
            maker.append(chunk)
            prepare(pieces, closed=False)
            final = int(pieces.paths.row[0]["planned"])
            kept = pieces.seg.row["out"][:final].copy()
            assert np.array_equal(kept, whole.seg.row["out"][:final])
            count -= chunk
        prepare(pieces)
        assert np.array_equal(pieces.seg.row["out"], whole.seg.row["out"])


@pytest.mark.parametrize("jerkrel", [0.0, 0.5])
def test_override_and_hold_on_the_way_keep_the_limits_and_the_end(jerkrel: float) -> None:
    for seed in seeds(0, 30):
        state = random_path(seed, PathSettings(jerkrel=jerkrel))
        rng = np.random.default_rng(seed)
        row = state.paths.row[0]
        for _ in range(40):
            advance(state, int(rng.integers(1, 200)))
            row["override"] = rng.choice((0.1, 0.5, 1.0, 1.3))
            row["hold"] = rng.choice((0, 0, 1))
            replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
        row["hold"] = 0
        replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
        run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"


@pytest.mark.parametrize("depth", [0, 3])
def test_any_override_and_blocks_that_come_late_keep_the_limits_and_the_end(depth: int) -> None:
    for seed in seeds(0, 60):
        rng = np.random.default_rng(seed)
        settings = PathSettings(jerkrel=float(rng.choice((0.0, 0.0, 0.3, 1.0))), depth=depth)
        state = run_with_changes(rng, settings)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"
        if is_done(state):
            assert np.array_equal(state.setpoint, state.paths.queued[0])


# Seeds with which a plan was once changed within the last cycle before a corner.
@pytest.mark.parametrize(
    ("overrides", "length"), [((2.0, 0.05), 0.157), ((0.0, 1.3), 0.3), ((0.05, 0.0, 2.0), 0.05)]
)
def test_overrides_in_every_cycle_around_a_corner_keep_the_limits(
    overrides: tuple[float, ...], length: float
) -> None:
    for cycle in range(1, 40):
        rng = np.random.default_rng(289)
        state = machine(rng, PathSettings())
        PathMaker(state, rng, length).append(30)
        prepare(state)
        start_path(state.paths, 0)
        state.clock[0]["mask"] = RECORDER_FULL
        advance(state, 3 * cycle)
        for override in (*overrides, 1.0):
            state.paths.row[0]["override"] = override
            replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
            advance(state, 2)
        run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"cycle {cycle}"


def collinear(depth: int) -> float:
    """Return the time of 1000 blocks of 0.2 mm at 200 mm/s and 1 m/s2 with a look-ahead of `depth` blocks."""
    state = machine(np.random.default_rng(0), PathSettings(depth=depth))
    state.limits.speed[:] = 1000.0
    state.limits.acceleration[:] = 1000.0
    for block in range(1000):
        end = np.array([0.2 * (block + 1), 0.0, 0.0])
        append_line(state.seg, state.paths, 0, state.limits, end, 200.0, 0, block)
    prepare(state)
    start_path(state.paths, 0)
    return skip(state, 0, rest_of(state)) * CYCLE_S


def test_look_ahead_needs_the_braking_distance() -> None:
    # v2 / 2a is 20 mm: 100 blocks. 1.2 s is the trapezoid: 200 mm at 200 mm/s and one ramp time of 0.2 s.
    assert collinear(0) == pytest.approx(1.2, abs=1e-3)
    assert collinear(256) == collinear(0)
    # 16 blocks are 3.2 mm: sqrt(2 a s) = 80 mm/s is never exceeded.
    assert collinear(16) == pytest.approx(200.0 / 80.0 + 0.08, rel=0.03)
    assert collinear(16) > 2.0 * collinear(256)


SAMPLE = """
from support.random_paths import PathSettings, random_path, is_done
from polycnc.kernel import advance
for seed in (3, 5, 8):
    state = random_path(seed, PathSettings(tolerance=0.01, jerkrel=0.4), most=16)
    for _ in range(400):
        advance(state, 1)
        print(*(value.hex() for value in state.setpoint.tolist()))
"""


def test_compiled_and_uncompiled_runs_are_the_same_to_the_last_bit() -> None:
    tests = Path(__file__).resolve().parents[1]
    outputs = []
    for disabled in ("0", "1"):
        environment = dict(os.environ, NUMBA_DISABLE_JIT=disabled, PYTHONPATH=str(tests))
        done = subprocess.run(
            [sys.executable, "-c", SAMPLE], env=environment, capture_output=True, text=True, check=True
        )
        outputs.append(done.stdout)
    assert outputs[0].count("\n") == 1200
    assert outputs[0] == outputs[1]
