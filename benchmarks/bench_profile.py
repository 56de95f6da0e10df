"""Time the planning of point-to-point profiles, from any state and from rest to rest, with ruckig beside it.

Figures are for one axis. ruckig is called from Python, one state at a time; handing over a state costs more than
its own arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from ruckig import InputParameter, Ruckig, Trajectory

from _measure import Figure, at_most, median_s
from _report import run_script
from polycnc.kernel._jit import entry
from polycnc.kernel._profile import SHORT_OVERSHOOT, plan_profile
from polycnc.kernel._profile_shape import PROFILE_COLUMNS, PROFILE_PHASES, profile_at, profile_duration

Floats = npt.NDArray[np.float64]

PLANS = 1_000_000
PEER_PLANS = 50_000
RUNS = 5


@entry
def plan_all(states: Floats, jerkrel: float, phases: Floats) -> float:
    """Plan every state (start, v0, target, v1, vmax, acc, dec) from its row; return the sum of durations."""
    total = 0.0
    for i in range(states.shape[0]):
        s = states[i]
        count = plan_profile(phases, s[0], s[1], s[2], s[3], s[4], s[5], s[6], jerkrel, SHORT_OVERSHOOT)
        total += profile_duration(phases, count)
    return total


@entry
def plan_one(phases: Floats) -> int:
    """Plan one profile of all phases into `phases`; return how many they are."""
    return plan_profile(phases, 0.0, 0.0, 100.0, 0.0, 50.0, 100.0, 100.0, 1.0, SHORT_OVERSHOOT)


@entry
def sample_all(phases: Floats, count: int, samples: int) -> float:
    """Sample one profile evenly; return the sum of positions."""
    total = 0.0
    step = profile_duration(phases, count) / samples
    for i in range(samples):
        total += profile_at(phases, count, i * step)[0]
    return total


def random_states(size: int, moving: bool) -> Floats:
    """Make random states with velocities up to half above the maximum, or at rest at both ends."""
    rng = np.random.default_rng(1)
    states = np.zeros((size, 7))
    states[:, 0], states[:, 2] = rng.uniform(-500, 500, (2, size))
    states[:, 4] = rng.uniform(5, 500, size)
    states[:, 5] = states[:, 6] = 10 ** rng.uniform(1, 4, size)
    if moving:
        states[:, 1] = states[:, 4] * rng.uniform(-1.5, 1.5, size)
        states[:, 3] = states[:, 4] * rng.uniform(-1, 1, size)
    return states


def peer_all(states: Floats) -> float:
    """Plan every state with ruckig, without a jerk limit; return the sum of durations."""
    planner, wish, found = Ruckig(1), InputParameter(1), Trajectory(1)
    wish.max_jerk = [math.inf]
    total = 0.0
    for start, v0, target, v1, vmax, acceleration, deceleration in states.tolist():
        wish.current_position, wish.current_velocity = [start], [v0]
        wish.target_position, wish.target_velocity = [target], [v1]
        wish.max_velocity, wish.max_acceleration, wish.min_acceleration = (
            [vmax],
            [acceleration],
            [-deceleration],
        )
        planner.calculate(wish, found)
        total += found.duration
    return total


def peer_one(states: Floats) -> float:
    """Plan the first state again and again with ruckig: its `calculate` alone."""
    planner, wish, found = Ruckig(1), InputParameter(1), Trajectory(1)
    start, v0, target, v1, vmax, acceleration, deceleration = states[0].tolist()
    wish.max_jerk = [math.inf]
    wish.current_position, wish.current_velocity = [start], [v0]
    wish.target_position, wish.target_velocity = [target], [v1]
    wish.max_velocity, wish.max_acceleration, wish.min_acceleration = [vmax], [acceleration], [-deceleration]
    for _ in range(len(states)):
        planner.calculate(wish, found)
    return float(found.duration)


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    plans, peer_plans = (PLANS // 10, PEER_PLANS // 10) if quick else (PLANS, PEER_PLANS)
    phases = np.zeros((PROFILE_PHASES, PROFILE_COLUMNS))
    moving, resting = random_states(plans, moving=True), random_states(plans, moving=False)
    few = moving[:peer_plans]
    count = plan_one(phases)

    def us(work: Callable[[], float], size: int) -> float:
        return 1e6 * median_s(work, RUNS) / size

    sampled = us(lambda: sample_all(phases, count, plans), plans)
    return [
        at_most("from any state", us(lambda: plan_all(moving, 0.0, phases), plans), "us/plan", 10.0),
        Figure("from any state, S-shape", us(lambda: plan_all(moving, 1.0, phases), plans), "us/plan"),
        at_most("rest to rest", us(lambda: plan_all(resting, 0.0, phases), plans), "us/plan", 1.0),
        Figure("rest to rest, S-shape", us(lambda: plan_all(resting, 1.0, phases), plans), "us/plan"),
        Figure("one sample, S-shape", sampled, "us"),
        Figure("ruckig from Python, any state", us(lambda: peer_all(few), peer_plans), "us/plan"),
        Figure("ruckig from Python, calculate alone", us(lambda: peer_one(few), peer_plans), "us/plan"),
    ]


if __name__ == "__main__":
    run_script("Point-to-point planning", figures)
