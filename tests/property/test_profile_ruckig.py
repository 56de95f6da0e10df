"""A hundred thousand random states against ruckig, an independent time-optimal planner.

ruckig limits the acceleration by axis direction, not by growing and falling speed; so most states have equal
rates, and unequal ones are compared where the velocity keeps its sign. A start above the maximum velocity
brakes first, as here; a target velocity above it ruckig refuses.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from ruckig import InputParameter, Ruckig, Trajectory

from polycnc.kernel._jit import entry
from polycnc.kernel._profile import SHORT_OVERSHOOT, plan_profile
from polycnc.kernel._profile_shape import PROFILE_COLUMNS, PROFILE_PHASES, profile_at, profile_duration

Floats = npt.NDArray[np.float64]

# Columns of a table of states.
START, V0, TARGET, V1, VMAX, ACC, DEC = range(7)
FRACTIONS = np.array([0.05, 0.3, 0.5, 0.7, 0.95])


@entry
def plan_all(states: Floats, fractions: Floats, phases: Floats, durations: Floats, positions: Floats) -> None:
    for i in range(states.shape[0]):
        s = states[i]
        count = plan_profile(phases, s[0], s[1], s[2], s[3], s[4], s[5], s[6], 0.0, SHORT_OVERSHOOT)
        durations[i] = profile_duration(phases, count)
        for k in range(fractions.shape[0]):
            positions[i, k] = profile_at(phases, count, fractions[k] * durations[i])[0]


def ours(states: Floats) -> tuple[Floats, Floats]:
    durations = np.empty(len(states))
    positions = np.empty((len(states), len(FRACTIONS)))
    plan_all(states, FRACTIONS, np.zeros((PROFILE_PHASES, PROFILE_COLUMNS)), durations, positions)
    return durations, positions


def theirs(states: Floats, signs: Floats) -> tuple[Floats, Floats]:
    planner, wish, found = Ruckig(1), InputParameter(1), Trajectory(1)
    wish.max_jerk = [math.inf]
    durations = np.empty(len(states))
    positions = np.empty((len(states), len(FRACTIONS)))
    for i, (start, v0, target, v1, vmax, acc, dec) in enumerate(states.tolist()):
        wish.current_position, wish.current_velocity = [start], [v0]
        wish.target_position, wish.target_velocity = [target], [v1]
        up, down = (acc, dec) if signs[i] > 0 else (dec, acc)
        wish.max_velocity, wish.max_acceleration, wish.min_acceleration = [vmax], [up], [-down]
        planner.calculate(wish, found)
        durations[i] = duration = found.duration
        for k, fraction in enumerate(FRACTIONS.tolist()):
            positions[i, k] = found.at_time(fraction * duration)[0][0]
    return durations, positions


def assert_same(states: Floats, signs: Floats) -> None:
    duration, position = ours(states)
    expected_duration, expected_position = theirs(states, signs)

    np.testing.assert_allclose(duration, expected_duration, rtol=1e-9, atol=1e-12)
    speed = np.maximum(states[:, VMAX], np.abs(states[:, V0]))
    ramp = speed * speed / np.minimum(states[:, ACC], states[:, DEC])
    size = np.abs(states[:, START]) + np.abs(states[:, TARGET]) + ramp
    assert float(np.max(np.abs(position - expected_position) / size[:, np.newaxis])) < 1e-7


def random_states(rng: np.random.Generator, size: int) -> Floats:
    states = np.empty((size, 7))
    states[:, START] = rng.uniform(-100, 100, size)
    states[:, VMAX] = 10 ** rng.uniform(0, 3, size)
    states[:, ACC] = states[:, DEC] = 10 ** rng.uniform(0, 4, size)
    # Distances from a micrometre to the whole range, both ways.
    states[:, TARGET] = states[:, START] + rng.choice([-1, 1], size) * 10 ** rng.uniform(-3, 2.3, size)
    # A fifth at rest, a third of the others above the maximum velocity.
    limit = np.where(rng.random(size) < 1 / 3, 3.0, 1.0)
    states[:, V0] = np.where(rng.random(size) < 0.2, 0.0, rng.uniform(-1, 1, size) * limit * states[:, VMAX])
    states[:, V1] = np.where(rng.random(size) < 0.3, 0.0, rng.uniform(-1, 1, size) * states[:, VMAX])
    # Some at the limits themselves, and some with equal velocities.
    edge = rng.random(size)
    states[edge < 0.05, V0] = states[edge < 0.05, VMAX]
    states[edge > 0.95, V1] = -states[edge > 0.95, VMAX]
    same = (edge > 0.5) & (edge < 0.55) & (np.abs(states[:, V0]) <= states[:, VMAX])
    states[same, V1] = states[same, V0]
    return states


def test_a_hundred_thousand_random_states_take_the_same_time_and_path() -> None:
    states = random_states(np.random.default_rng(8001), 100_000)

    toward = np.sign(states[:, TARGET] - states[:, START])
    assert np.count_nonzero(states[:, V0] * toward < 0) > 20_000
    assert np.count_nonzero(states[:, V1] * toward < 0) > 20_000
    assert np.count_nonzero(np.abs(states[:, V0]) > states[:, VMAX]) > 10_000
    assert_same(states, np.ones(len(states)))


def test_unequal_rates_where_the_velocity_keeps_its_sign() -> None:
    rng = np.random.default_rng(8008)
    states = random_states(rng, 10_000)
    # Ramps of a few metres at most: ruckig gives up on a cruise that is short beside its ramps.
    states[:, ACC] = 10 ** rng.uniform(2, 4, len(states))
    states[:, DEC] = 10 ** rng.uniform(2, 4, len(states))
    states[:, VMAX] = np.minimum(states[:, VMAX], 500.0)
    for column in (V0, V1):
        states[:, column] = np.clip(states[:, column], -states[:, VMAX], states[:, VMAX])
    signs = np.sign(states[:, TARGET] - states[:, START])
    states[:, V0] = signs * np.abs(states[:, V0])
    states[:, V1] = signs * np.abs(states[:, V1])
    # Long enough for the ramp from the start to the target velocity, so that nothing turns.
    grows = np.abs(states[:, V1]) > np.abs(states[:, V0])
    rate = np.where(grows, states[:, ACC], states[:, DEC])
    shortest = np.abs(states[:, V1] ** 2 - states[:, V0] ** 2) / (2 * rate)
    states[:, TARGET] += signs * shortest

    assert_same(states, signs)
