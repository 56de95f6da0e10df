"""A run that is held, overridden and stepped at random keeps to the undisturbed path, its limits and its end."""

from __future__ import annotations

import numpy as np
import pytest

from polycnc.machine import MachineConfig
from support.interrupted_runs import (
    JERK,
    ROUND,
    ROUNDING,
    SHARP,
    SHORT,
    SOFT,
    farthest,
    fine_path,
    highest_jerk,
    interrupted,
    overload,
    random_program,
)
from support.often import often
from support.runs import program_run


@pytest.mark.parametrize("config", [SHARP, JERK, SHORT, SOFT], ids=["sharp", "jerk", "short", "soft"])
@pytest.mark.parametrize("seed", often(range(8), 3))
def test_holds_overrides_and_steps_keep_limits_and_the_end(seed: int, config: MachineConfig) -> None:
    rng = np.random.default_rng([seed, 71])
    program = random_program(rng)
    undisturbed = program_run(program, config, stands_at_stops=False)
    undisturbed.start()
    while undisturbed.active:
        undisturbed.advance(100_000)
    points, speeds, run = interrupted(program, config, rng)
    assert run.machine.setpoints == undisturbed.machine.setpoints
    assert overload(points, config) <= ROUNDING
    if config.path.jerk_mm_s3 is not None:
        assert highest_jerk(speeds) <= config.path.jerk_mm_s3 * ROUNDING


@pytest.mark.parametrize(
    ("config", "seed"), often([(config, seed) for config in (ROUND, SHARP, SOFT) for seed in range(3)], 1)
)
def test_every_position_of_an_interrupted_run_lies_on_the_path(seed: int, config: MachineConfig) -> None:
    rng = np.random.default_rng([seed, 73])
    program = random_program(rng)
    path = fine_path(program, config)
    points, _, run = interrupted(program, config, rng)
    # A step ends in a corner itself, which rounding passes at 0.03 mm; `path` is a polyline of points 0.14 mm apart.
    assert farthest(points[::61], path) < 0.0302
    assert overload(points, config) <= ROUNDING
    assert run.machine.setpoints == dict(zip("XYZ", path[-1].tolist(), strict=True))
