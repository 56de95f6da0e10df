"""What every point-to-point profile must satisfy, whatever the state, the limits and the policy."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from polycnc.kernel._profile import (
    SHORT_JUMP,
    SHORT_OVERSHOOT,
    SHORT_REDUCE_START,
    plan_profile,
    stop_profile,
)
from polycnc.kernel._profile_shape import (
    ACCELERATION,
    DURATION,
    POSITION,
    PROFILE_COLUMNS,
    PROFILE_PHASES,
    VELOCITY,
    profile_at,
    profile_duration,
)
from support.often import share

Floats = npt.NDArray[np.float64]

LONGEST = 13  # four ramps of three phases and a cruise


class State(NamedTuple):
    """The arguments of plan_profile after `phases`, up to `jerkrel`."""

    start: float
    v0: float
    target: float
    v1: float
    vmax: float
    acc: float
    dec: float
    jerkrel: float

    def mirrored(self) -> State:
        return self._replace(start=-self.start, v0=-self.v0, target=-self.target, v1=-self.v1)

    @property
    def size(self) -> float:
        """Return the lengths in play: positions, a second's way, and a ramp up and down."""
        speed = abs(self.v0) + min(abs(self.v1), self.vmax)
        ramp = speed * speed * (0.5 / self.acc + 0.5 / self.dec)
        return abs(self.start) + abs(self.target) + speed + ramp


def numbers(limit: float) -> st.SearchStrategy[float]:
    plain = st.floats(-limit, limit, allow_nan=False, allow_subnormal=False)
    special = st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e-12, -1e-12, limit, -limit])
    return st.one_of(special, plain, plain)


def positives(low: float, high: float) -> st.SearchStrategy[float]:
    return st.one_of(st.sampled_from([low, 1.0, high]), st.floats(low, high))


@st.composite
def states(draw: st.DrawFn) -> State:
    vmax = draw(positives(1e-3, 1e4))
    start = draw(numbers(1e9))
    gap = draw(st.one_of(numbers(1e9), numbers(1e-6), numbers(100.0)))
    v0 = draw(st.one_of(st.sampled_from([0.0, vmax, -vmax]), numbers(2e4)))
    v1 = draw(st.one_of(st.sampled_from([0.0, vmax, -vmax, v0]), numbers(2e4)))
    acc = draw(positives(1e-2, 1e6))
    dec = draw(st.one_of(st.just(acc), positives(1e-2, 1e6)))
    jerkrel = draw(st.one_of(st.sampled_from([0.0, 0.2, 1.0]), st.floats(-1.0, 2.0)))
    return State(start, v0, start + gap, v1, vmax, acc, dec, jerkrel)


POLICIES = st.sampled_from([SHORT_OVERSHOOT, SHORT_JUMP, SHORT_REDUCE_START])
TINY = State(0.0, 0.0, 1e-12, 0.0, 50.0, 100.0, 100.0, 1.0)


def planned(state: State, policy: int = SHORT_OVERSHOOT) -> tuple[Floats, int]:
    phases = np.full((PROFILE_PHASES, PROFILE_COLUMNS), math.nan)
    count = plan_profile(phases, *state, policy)
    return phases, count


def end_of(row: Floats) -> tuple[float, float]:
    duration, position, velocity, acceleration, jerk = row.tolist()
    return (
        position + duration * (velocity + duration * (acceleration / 2 + duration * jerk / 6)),
        velocity + duration * (acceleration + duration * jerk / 2),
    )


@settings(deadline=None, max_examples=share(100))
@given(states(), POLICIES)
@example(TINY, SHORT_OVERSHOOT)
@example(TINY._replace(target=5e-324), SHORT_OVERSHOOT)
@example(TINY._replace(v0=1e-308, v1=-1e-308), SHORT_OVERSHOOT)
@example(TINY._replace(target=1e-12, v0=50.0, v1=50.0), SHORT_OVERSHOOT)
@example(TINY._replace(start=1e9, target=-1e9), SHORT_OVERSHOOT)
def test_phases_join_and_stay_within_the_limits(state: State, policy: int) -> None:
    phases, count = planned(state, policy)

    assert 0 <= count <= LONGEST
    assert np.isfinite(phases[: count + 1]).all()
    assert (phases[:count, DURATION] > 0.0).all()

    fastest = max(state.vmax, abs(state.v0))
    assert (np.abs(phases[:count, VELOCITY]) <= fastest * (1 + 1e-14)).all()
    strongest = max(state.acc, state.dec) * (1 + min(max(state.jerkrel, 0.0), 1.0))
    assert (np.abs(phases[:count, ACCELERATION]) <= strongest * (1 + 1e-14)).all()

    size = state.size + float(np.abs(phases[: count + 1, POSITION]).max())
    for row, following in pairwise(phases[: count + 1]):
        position, velocity = end_of(row)
        assert abs(position - following[POSITION]) <= 1e-12 * size + sys.float_info.min
        if following is not phases[count]:
            assert abs(velocity - following[VELOCITY]) <= 1e-12 * fastest or following[DURATION] == 0.0


@settings(deadline=None, max_examples=share(100))
@given(states(), POLICIES)
def test_the_start_and_the_end_are_exact(state: State, policy: int) -> None:
    phases, count = planned(state, policy)
    duration = profile_duration(phases, count)

    position, velocity, acceleration = profile_at(phases, count, duration)
    assert position == state.target
    assert acceleration == 0.0
    if policy != SHORT_REDUCE_START:
        assert velocity == state.v1
    assert abs(velocity) <= abs(state.v1) * (1 + 1e-14)
    later = profile_at(phases, count, duration + 3.0)
    assert later[1:] == (velocity, 0.0)
    # The time after the end carries the rounding of the duration itself.
    slack = 1e-12 * (state.size + abs(velocity) * (1.0 + duration))
    assert abs(later[0] - (state.target + 3.0 * velocity)) <= slack
    if count and policy != SHORT_REDUCE_START:
        assert tuple(phases[0, [POSITION, VELOCITY]]) == (state.start, state.v0)


@settings(deadline=None, max_examples=share(100))
@given(states(), POLICIES)
def test_velocities_step_only_where_the_policy_says(state: State, policy: int) -> None:
    phases, count = planned(state, policy)
    assume(count > 0)
    arrival = end_of(phases[count - 1])[1]
    tolerance = 1e-12 * max(state.vmax, abs(state.v0))

    if abs(state.v1) <= state.vmax:
        if policy != SHORT_JUMP:
            assert abs(arrival - phases[count, VELOCITY]) <= tolerance
        if policy != SHORT_REDUCE_START:
            assert phases[0, VELOCITY] == state.v0
        else:
            assert abs(phases[0, VELOCITY]) <= abs(state.v0) * (1 + 1e-14)
    elif policy == SHORT_OVERSHOOT and abs(state.v0) <= state.vmax:
        assert abs(arrival - math.copysign(state.vmax, state.v1)) <= tolerance


@settings(deadline=None, max_examples=share(100))
@given(states(), POLICIES)
def test_the_mirrored_wish_is_the_mirrored_profile(state: State, policy: int) -> None:
    phases, count = planned(state, policy)
    mirrored, mirrored_count = planned(state.mirrored(), policy)

    duration = profile_duration(phases, count)
    assert math.isclose(duration, profile_duration(mirrored, mirrored_count), rel_tol=1e-12)
    size = state.size + float(np.abs(phases[: count + 1, POSITION]).max())
    for fraction in (0.0, 0.2, 0.5, 0.8):
        position = profile_at(phases, count, fraction * duration)[0]
        reflection = profile_at(mirrored, mirrored_count, fraction * duration)[0]
        assert abs(position + reflection) <= 1e-12 * size


@settings(deadline=None, max_examples=share(100))
@given(states(), st.floats(0.0, 1.0))
def test_a_bent_profile_meets_the_straight_one_at_every_ramp_end(state: State, jerkrel: float) -> None:
    straight, straight_count = planned(state._replace(jerkrel=0.0))
    bent, bent_count = planned(state._replace(jerkrel=jerkrel))
    duration = profile_duration(straight, straight_count)
    size = state.size + float(np.abs(straight[: straight_count + 1, POSITION]).max())

    assert math.isclose(profile_duration(bent, bent_count), duration, rel_tol=1e-12)
    time_s = 0.0
    for row in straight[:straight_count]:
        position, _, _ = profile_at(bent, bent_count, time_s)
        slack = 1e-12 * (size + max(state.vmax, abs(state.v0)) * duration)
        assert abs(position - row[POSITION]) <= slack
        time_s += row[DURATION]


@settings(deadline=None, max_examples=share(100))
@given(states(), st.floats(0.0, 1.0))
def test_planning_again_on_the_way_does_not_change_the_time(state: State, fraction: float) -> None:
    """A part of an optimal profile is optimal: also the test that no branch is chosen wrongly."""
    state = state._replace(jerkrel=0.0)
    assume(state.v1 == 0.0 or abs(state.v1) > 1e-3 * state.vmax)
    phases, count = planned(state)
    duration = profile_duration(phases, count)
    time_s = fraction * duration
    position, velocity, _ = profile_at(phases, count, time_s)

    rest, rest_count = planned(state._replace(start=position, v0=velocity))

    # An error of position costs the time of a short move of that length.
    size = state.size + float(np.abs(phases[: count + 1, POSITION]).max())
    error = 1e-14 * size + 1e-12 * (abs(state.v0) + abs(velocity) + min(abs(state.v1), state.vmax))
    slack = 10 * math.sqrt(error / min(state.acc, state.dec)) + 1e-12 * duration + 1e-12 * size / state.vmax
    assert abs(time_s + profile_duration(rest, rest_count) - duration) <= slack


@settings(deadline=None, max_examples=share(100))
@given(numbers(1e9), numbers(1e4), st.one_of(st.just(0.0), positives(1e-2, 1e6)), st.floats(-1.0, 2.0))
def test_a_stop_comes_to_rest_where_its_end_row_says(
    start: float, v0: float, dec: float, jerkrel: float
) -> None:
    phases = np.full((PROFILE_PHASES, PROFILE_COLUMNS), math.nan)
    count = stop_profile(phases, start, v0, dec, jerkrel)

    assert np.isfinite(phases[: count + 1]).all()
    target, velocity, _ = profile_at(phases, count, profile_duration(phases, count))
    assert velocity == 0.0
    if dec == 0.0 or v0 == 0.0:
        assert (count, target) == (0, start)
    else:
        assert math.isclose(profile_duration(phases, count), abs(v0) / dec, rel_tol=1e-12)
        way = v0 * abs(v0) / (2 * dec)
        slack = 1e-14 * (abs(start) + abs(way)) + sys.float_info.min
        assert abs(target - (start + way)) <= slack
        assert abs(target - end_of(phases[count - 1])[0]) <= slack


SHORT_SAMPLE = """
import numpy as np
from polycnc.kernel._profile import plan_profile, stop_profile
from polycnc.kernel._profile_shape import PROFILE_COLUMNS, PROFILE_PHASES, profile_at, profile_duration

rng = np.random.default_rng(4)
phases = np.zeros((PROFILE_PHASES, PROFILE_COLUMNS))
for i in range(300):
    v0, v1 = (rng.uniform(-80, 80, 2) * (rng.random(2) < 0.7)).tolist()
    start, target = rng.uniform(-100, 100, 2).round(int(rng.integers(0, 3))).tolist()
    acc, dec, vmax = (10 ** rng.uniform(0, 3, 3)).tolist()
    jerkrel = float(rng.choice([0.0, 0.2, 1.0]))
    count = plan_profile(phases, start, v0, target, v1, vmax, acc, dec, jerkrel, i % 3)
    duration = profile_duration(phases, count)
    print(count, duration.hex(), *(float(x).hex() for x in phases[: count + 1].ravel()))
    for fraction in (0.1, 0.5, 0.9, 1.0, 1.5):
        print(*(float(x).hex() for x in profile_at(phases, count, fraction * duration)))
    count = stop_profile(phases, start, v0, dec, jerkrel)
    print(*(float(x).hex() for x in phases[: count + 1].ravel()))
"""


def test_compiled_and_uncompiled_agree_to_the_last_bit() -> None:
    outputs = []
    for disable in ("0", "1"):
        environment = {**os.environ, "NUMBA_DISABLE_JIT": disable, "PYTHONPATH": os.pathsep.join(sys.path)}
        run = subprocess.run(
            [sys.executable, "-c", SHORT_SAMPLE], capture_output=True, text=True, check=True, env=environment
        )
        outputs.append(run.stdout)

    assert outputs[0].count("\n") == 300 * 7
    assert outputs[0] == outputs[1]
