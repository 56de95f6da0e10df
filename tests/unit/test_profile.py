"""The point-to-point profile generator: the manual's cases, with numbers worked out by hand or by search."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pytest
import scipy

from polycnc.kernel._profile import (
    PROFILE_REFUSED,
    SHORT_JUMP,
    SHORT_OVERSHOOT,
    SHORT_REDUCE_START,
    plan_profile,
    stop_profile,
)
from polycnc.kernel._profile_shape import (
    ACCELERATION,
    DURATION,
    JERK,
    POSITION,
    PROFILE_COLUMNS,
    PROFILE_PHASES,
    VELOCITY,
    profile_at,
    profile_duration,
)

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """A planned profile with its questions as methods."""

    phases: Floats
    count: int

    @property
    def duration(self) -> float:
        return profile_duration(self.phases, self.count)

    @property
    def end_velocity(self) -> float:
        return float(self.phases[self.count, VELOCITY])

    def at(self, time_s: float) -> tuple[float, float, float]:
        return profile_at(self.phases, self.count, time_s)

    def begins(self) -> list[float]:
        return [0.0, *np.cumsum(self.phases[: self.count, DURATION])]

    def arrival_velocity(self) -> float:
        """Return the velocity just before the target, that is before any step there."""
        duration, _, velocity, acceleration, jerk = self.phases[self.count - 1]
        return float(velocity + duration * (acceleration + duration * jerk / 2))


def plan(
    target: float,
    *,
    start: float = 0.0,
    v0: float = 0.0,
    v1: float = 0.0,
    vmax: float = 50.0,
    acc: float = 100.0,
    dec: float = 100.0,
    jerkrel: float = 0.0,
    policy: float = SHORT_OVERSHOOT,
) -> Profile:
    phases = np.full((PROFILE_PHASES, PROFILE_COLUMNS), math.nan)
    count = plan_profile(
        phases,
        float(start),
        float(v0),
        float(target),
        float(v1),
        float(vmax),
        float(acc),
        float(dec),
        float(jerkrel),
        int(policy),
    )
    return Profile(phases, count)


def stop(start: float, v0: float, dec: float, jerkrel: float = 0.0) -> Profile:
    phases = np.full((PROFILE_PHASES, PROFILE_COLUMNS), math.nan)
    return Profile(phases, stop_profile(phases, start, v0, dec, jerkrel))


def integrated(profile: Profile, samples: int = 65) -> tuple[float, float]:
    """Return where and how fast a profile ends up, from its accelerations alone (without steps)."""
    position = float(profile.phases[0, POSITION])
    velocity = float(profile.phases[0, VELOCITY])
    for duration, _, _, acceleration, jerk in profile.phases[: profile.count]:
        times = np.linspace(0.0, duration, samples)
        velocities = velocity + scipy.integrate.cumulative_trapezoid(
            acceleration + jerk * times, times, initial=0.0
        )
        position += float(scipy.integrate.cumulative_simpson(velocities, x=times, initial=0.0)[-1])
        velocity = float(velocities[-1])
    return position, velocity


# --- The plain cases, forward and mirrored ---

DIRECT_CASES = {
    # name: (arguments, duration in s, velocity of the fastest point)
    "trapezoid": ({"target": 100}, 0.5 + 1.5 + 0.5, 50.0),
    "triangle": ({"target": 10}, 2 * math.sqrt(10 / 100), math.sqrt(1000.0)),
    "half the braking rate": ({"target": 100, "dec": 50}, 0.5 + 1.25 + 1.0, 50.0),
    # vp^2 (1/200 + 1/400) = 3: vp = 20; 0.2 s up, 0.1 s down.
    "triangle with twice the braking rate": ({"target": 3, "dec": 200}, 0.3, 20.0),
    "start above the maximum": ({"target": 100, "v0": 80}, 0.3 + (100 - 19.5 - 12.5) / 50 + 0.5, 80.0),
    "start the wrong way": ({"target": 100, "v0": -30}, 0.3 + 0.5 + (104.5 - 25) / 50 + 0.5, 50.0),
    "target velocity against the travel": (
        {"target": 100, "v1": -20},
        0.5 + (102 - 25) / 50 + 0.5 + 0.2,
        50.0,
    ),
    "start at the maximum": ({"target": 100, "v0": 50}, 87.5 / 50 + 0.5, 50.0),
    "end at the maximum": ({"target": 100, "v1": 50}, 0.5 + 87.5 / 50, 50.0),
    "start and end at the maximum": ({"target": 100, "v0": 50, "v1": 50}, 2.0, 50.0),
    "end above the maximum": ({"target": 100, "v1": 80}, 0.5 + 87.5 / 50, 50.0),
    # Brake 80 to 50 over 390 at 5: exactly one ramp.
    "brake to the maximum only": ({"target": 390, "v0": 80, "v1": 50, "dec": 5}, 6.0, 80.0),
}


@pytest.mark.parametrize("mirror", [1.0, -1.0], ids=["forward", "backward"])
@pytest.mark.parametrize("jerkrel", [0.0, 0.2, 1.0])
@pytest.mark.parametrize("name", DIRECT_CASES)
def test_the_manuals_cases_take_the_time_worked_out_by_hand(name: str, jerkrel: float, mirror: float) -> None:
    arguments, duration, peak = DIRECT_CASES[name]
    signed = {k: v * mirror if k in ("target", "v0", "v1") else v for k, v in arguments.items()}

    profile = plan(**signed, jerkrel=jerkrel)

    assert profile.duration == pytest.approx(duration, rel=1e-14)
    assert max(abs(profile.at(t)[1]) for t in profile.begins()[:-1]) == pytest.approx(peak, rel=1e-14)
    # The end is exact, and the end velocity is kept from there on.
    target, v1 = float(signed["target"]), float(signed.get("v1", 0.0))
    assert profile.at(profile.duration) == (target, v1, 0.0)
    assert profile.at(profile.duration + 2.0) == pytest.approx((target + 2 * v1, v1, 0.0), rel=1e-15)
    assert profile.at(0.0)[:2] == (0.0, signed.get("v0", 0.0))
    assert profile.at(-1.0) == profile.at(0.0)


def test_the_first_example_sampled() -> None:
    profile = plan(100)

    assert profile.at(0.25) == (3.125, 25.0, 100.0)
    assert profile.at(0.5) == (12.5, 50.0, 0.0)
    assert profile.at(1.0) == (37.5, 50.0, 0.0)
    assert profile.at(2.25) == pytest.approx((100 - 3.125, 25.0, -100.0))


def test_a_wrong_way_start_turns_where_braking_ends() -> None:
    profile = plan(100, v0=-30)

    position, velocity, _ = profile.at(0.3)
    assert position == pytest.approx(-4.5)
    assert velocity == pytest.approx(0.0, abs=1e-12)


def test_a_target_velocity_against_the_travel_overshoots_by_its_own_ramp() -> None:
    profile = plan(100, v1=-20)

    position, velocity, _ = profile.at(profile.duration - 0.2)
    assert (position, velocity) == pytest.approx((102, 0), abs=1e-12)
    assert profile.arrival_velocity() == pytest.approx(-20)


def test_a_target_velocity_above_the_maximum_is_a_step_at_the_target() -> None:
    profile = plan(100, v1=80)

    assert profile.arrival_velocity() == 50.0
    assert profile.at(profile.duration) == (100.0, 80.0, 0.0)
    assert profile.at(profile.duration + 1.0) == (180.0, 80.0, 0.0)


def test_positions_away_from_zero_shift_everything() -> None:
    near, far = plan(100), plan(-899, start=-999)

    assert far.duration == near.duration
    assert far.at(1.0)[0] == pytest.approx(near.at(1.0)[0] - 999, abs=1e-12)
    assert far.at(0.0)[0] == -999.0
    assert far.at(far.duration)[0] == -899.0


# --- Distances that are too short ---


def test_too_short_to_brake_overshoots_and_comes_back() -> None:
    # Braking from 50 takes 12.5; the way back of 11.5 is a triangle.
    profile = plan(1, v0=50)

    assert profile.at(0.5)[0] == pytest.approx(12.5)
    assert profile.duration == pytest.approx(0.5 + 2 * math.sqrt(11.5 / 100), rel=1e-14)
    assert profile.at(profile.duration) == (1.0, 0.0, 0.0)


def test_too_short_to_brake_steps_at_the_target() -> None:
    profile = plan(1, v0=50, policy=SHORT_JUMP)

    arrival = math.sqrt(50**2 - 2 * 100 * 1)
    assert profile.count == 1
    assert profile.arrival_velocity() == pytest.approx(arrival)
    assert profile.duration == pytest.approx((50 - arrival) / 100)
    assert profile.at(profile.duration) == (1.0, 0.0, 0.0)


def test_too_short_to_brake_reduces_the_start_velocity() -> None:
    profile = plan(1, v0=50, policy=SHORT_REDUCE_START)

    assert profile.at(0.0) == pytest.approx((0.0, 14.142135623730951, -100.0))
    assert profile.duration == pytest.approx(0.1414213562373095)
    assert profile.arrival_velocity() == pytest.approx(0.0, abs=1e-12)


def test_too_short_to_brake_to_a_target_velocity_reduces_the_start_velocity() -> None:
    profile = plan(-1, v0=-50, v1=-10, dec=200, policy=SHORT_REDUCE_START)

    assert profile.at(0.0)[1] == pytest.approx(-math.sqrt(10**2 + 2 * 200 * 1))
    assert profile.arrival_velocity() == pytest.approx(-10)
    assert profile.end_velocity == -10.0


def test_too_short_to_reach_the_target_velocity_moves_back_for_run_up() -> None:
    # 50 takes a run-up of 12.5 at 100, so the profile first goes to -11.5.
    profile = plan(1, v1=50)

    assert profile.at(profile.duration - 0.5)[0] == pytest.approx(-11.5)
    assert profile.arrival_velocity() == pytest.approx(50)
    assert profile.duration == pytest.approx(2 * math.sqrt(11.5 / 100) + 0.5, rel=1e-14)


def test_too_short_to_reach_the_target_velocity_reduces_it() -> None:
    profile = plan(1, v1=50, policy=SHORT_REDUCE_START)

    assert profile.end_velocity == pytest.approx(14.142135623730951)
    assert profile.arrival_velocity() == pytest.approx(profile.end_velocity)
    assert profile.duration == pytest.approx(0.1414213562373095)


def test_too_short_to_reach_the_target_velocity_steps_at_the_target() -> None:
    profile = plan(1, v1=50, policy=SHORT_JUMP)

    assert profile.arrival_velocity() == pytest.approx(14.142135623730951)
    assert profile.at(profile.duration) == (1.0, 50.0, 0.0)


@pytest.mark.parametrize("policy", [SHORT_JUMP, SHORT_REDUCE_START])
def test_a_run_up_after_a_wrong_way_start_begins_where_it_turns(policy: int) -> None:
    # -20 turns after 1 at 200; then 3 + 1 at 50 give sqrt(2 * 50 * 4) = 20.
    profile = plan(3, v0=-20, v1=50, acc=50, dec=200, policy=policy)

    assert profile.at(0.1)[0] == pytest.approx(-1.0)
    assert profile.arrival_velocity() == pytest.approx(20.0)
    assert profile.duration == pytest.approx(0.1 + 0.4)
    assert profile.end_velocity == pytest.approx(50.0 if policy == SHORT_JUMP else 20.0)


@pytest.mark.parametrize("policy", [SHORT_OVERSHOOT, SHORT_JUMP, SHORT_REDUCE_START])
def test_when_the_target_velocity_steps_anyway_nothing_turns_back(policy: int) -> None:
    profile = plan(1, v0=80, v1=80, policy=policy)

    assert profile.count == 1
    assert profile.arrival_velocity() == pytest.approx(math.sqrt(80**2 - 200))
    assert profile.at(profile.duration) == (1.0, 80.0, 0.0)


@pytest.mark.parametrize("policy", [SHORT_OVERSHOOT, SHORT_JUMP, SHORT_REDUCE_START])
def test_a_turn_past_the_target_is_never_too_short(policy: int) -> None:
    # Braking from 50 passes the target by 11.5; on the way back 0 -> sqrt(...) -> 10 over 11.5.
    profile = plan(1, v0=50, v1=-10, policy=policy)

    peak = math.sqrt((11.5 + 10**2 / 200) * 100)
    assert profile.at(0.0)[1] == 50.0
    assert profile.arrival_velocity() == pytest.approx(-10)
    assert profile.duration == pytest.approx(0.5 + peak / 100 + (peak - 10) / 100, rel=1e-14)


@pytest.mark.parametrize(
    ("v0", "v1", "policy", "end_velocity"),
    [
        (0, 0, SHORT_OVERSHOOT, 0.0),
        (30, 30, SHORT_OVERSHOOT, 30.0),
        (30, 30, SHORT_JUMP, 30.0),
        (30, 0, SHORT_JUMP, 0.0),
        (0, 30, SHORT_JUMP, 30.0),
        (30, 10, SHORT_REDUCE_START, 10.0),
        (10, 30, SHORT_REDUCE_START, 10.0),
        (-30, 0, SHORT_JUMP, 0.0),
        (-10, -30, SHORT_REDUCE_START, -10.0),
        (0, -30, SHORT_REDUCE_START, 0.0),
    ],
)
def test_no_distance_without_a_loop_is_no_phase(
    v0: float, v1: float, policy: int, end_velocity: float
) -> None:
    profile = plan(7, start=7, v0=v0, v1=v1, policy=policy)

    assert profile.count == 0
    assert profile.duration == 0.0
    assert profile.at(0.0) == (7.0, end_velocity, 0.0)


def test_no_distance_with_a_velocity_is_a_loop_back_to_the_same_place() -> None:
    # Out 12.5 in 0.5 s, back 12.5 as a triangle.
    profile = plan(7, start=7, v0=50)

    assert profile.duration == pytest.approx(0.5 + 2 * math.sqrt(0.125), rel=1e-14)
    assert profile.at(profile.duration) == (7.0, 0.0, 0.0)


def test_no_distance_and_opposite_velocities_is_the_loop_of_a_turn_past_the_target() -> None:
    # Travel is where the motion goes: out beyond the 0.5 of braking, for 12.5 of run-up to -50.
    profile = plan(7, start=7, v0=10, v1=-50, policy=SHORT_JUMP)

    peak = math.sqrt(10**2 + 12 * 100)
    assert profile.arrival_velocity() == pytest.approx(-50)
    assert profile.duration == pytest.approx((peak - 10) / 100 + peak / 100 + 0.5, rel=1e-14)


# --- S-shape ---


@pytest.mark.parametrize(
    ("jerkrel", "edge", "peak"),
    [(0.2, 1 / 12, 120.0), (1.0, 0.25, 200.0), (0.5, 1 / 6, 150.0), (3.0, 0.25, 200.0)],
)
def test_a_bent_ramp_keeps_its_time_and_distance(jerkrel: float, edge: float, peak: float) -> None:
    profile = plan(100, jerkrel=jerkrel)
    straight = plan(100)

    assert profile.phases[0, DURATION] == pytest.approx(edge)
    assert profile.at(edge)[2] == pytest.approx(peak)
    assert profile.at(edge / 2)[2] == pytest.approx(peak / 2)
    assert profile.at(0.25)[1] == pytest.approx(25.0)
    for time_s in (0.5, 1.0, 2.0, 2.5):
        assert profile.at(time_s)[:2] == pytest.approx(straight.at(time_s)[:2])
    assert np.isclose(profile.phases[: profile.count, JERK].max(), peak / edge)


@pytest.mark.parametrize("jerkrel", [-0.5, 0.0, math.nan])
def test_without_a_jerk_part_the_acceleration_is_a_rectangle(jerkrel: float) -> None:
    profile = plan(100, jerkrel=jerkrel)

    assert profile.count == 3
    assert set(profile.phases[:3, ACCELERATION]) == {100.0, 0.0, -100.0}
    assert not profile.phases[:3, JERK].any()


def test_a_ramp_through_standstill_is_two_ramps() -> None:
    profile = plan(100, v0=-30, acc=100, dec=50, jerkrel=1.0)

    # Each of them has its own rate and its own bend: 0.6 s at 50, then 0.5 s at 100.
    assert list(profile.phases[:4, DURATION]) == pytest.approx([0.3, 0.3, 0.25, 0.25])
    assert [profile.at(t)[2] for t in (0.3, 0.6, 0.85, 1.1)] == pytest.approx([100, 0, 200, 0], abs=1e-9)


# --- Unequal rates, by integration and by search ---


def random_states(seed: int, size: int) -> list[dict[str, float]]:
    rng = np.random.default_rng(seed)
    states = []
    for _ in range(size):
        vmax = 10 ** rng.uniform(0, 2)
        states.append(
            {
                "start": rng.uniform(-50, 50),
                "target": rng.uniform(-50, 50),
                "vmax": vmax,
                "v0": vmax * rng.uniform(-2, 2),
                "v1": vmax * rng.uniform(-1, 1),
                "acc": 10 ** rng.uniform(0.5, 3),
                "dec": 10 ** rng.uniform(0.5, 3),
            }
        )
    return states


def test_integrated_accelerations_lead_to_the_target() -> None:
    rng = np.random.default_rng(3)
    for state in random_states(17, 400):
        profile = plan(**state, jerkrel=rng.choice([0.0, 0.3, 1.0]))

        position, velocity = integrated(profile)

        size = 100 + np.abs(profile.phases[: profile.count, POSITION]).max()
        assert position == pytest.approx(state["target"], abs=1e-12 * size)
        assert velocity == pytest.approx(state["v1"], abs=1e-11 * max(state["vmax"], abs(state["v0"])))


def test_rates_belong_to_growing_and_falling_speed() -> None:
    for state in random_states(5, 200):
        profile = plan(**state)

        for _, _, velocity, acceleration, _ in profile.phases[: profile.count]:
            if acceleration != 0.0:
                grows = velocity * acceleration >= 0.0
                assert abs(acceleration) == (state["acc"] if grows else state["dec"])


def ramp(first: Floats, last: Floats, acc: float, dec: float) -> tuple[Floats, Floats]:
    """Return time and way of the ramps between two velocities, each cut where it passes standstill."""

    def one_way(low: Floats, high: Floats, rate: float) -> tuple[Floats, Floats]:
        return (high - low) / rate, (high**2 - low**2) / (2 * rate)

    time, way = np.zeros(np.broadcast(first, last).shape), np.zeros(np.broadcast(first, last).shape)
    for sign in (1.0, -1.0):
        begin, end = np.maximum(sign * first, 0.0), np.maximum(sign * last, 0.0)
        low, high = np.minimum(begin, end), np.maximum(begin, end)
        up, down = one_way(low, high, acc), one_way(low, high, dec)
        time += np.where(end > begin, up[0], down[0])
        way += sign * np.where(end > begin, up[1], down[1])
    return time, way


def test_no_other_middle_velocity_is_faster() -> None:
    """Search every ramp, hold, ramp with a held velocity of either sign: none arrives earlier."""
    for state in random_states(29, 300):
        held = np.linspace(-state["vmax"], state["vmax"], 4000)
        time_in, way_in = ramp(np.array(state["v0"]), held, state["acc"], state["dec"])
        time_out, way_out = ramp(held, np.array(state["v1"]), state["acc"], state["dec"])
        hold = (state["target"] - state["start"] - way_in - way_out) / held
        times = np.where(hold >= 0.0, time_in + hold + time_out, math.inf)

        duration = plan(**state).duration

        assert duration <= times.min() * (1 + 1e-12)
        assert times.min() < 1.05 * duration + 0.05


# --- Changing a running profile ---


def replan(running: Profile, time_s: float, target: float, **changes: float) -> Profile:
    position, velocity, _ = running.at(time_s)
    return plan(target, start=position, v0=velocity, **changes)


def test_a_new_target_ahead() -> None:
    # At 1 s: 37.5 with 50. To 200: 150 of cruise, 0.5 s of braking.
    changed = replan(plan(100), 1.0, 200)

    assert 1.0 + changed.duration == pytest.approx(1.0 + 3.0 + 0.5)


def test_a_new_target_within_the_braking_way() -> None:
    # From 37.5 with 50 to 20: stop at 50, then 30 back: 0.5 + 0.1 + 0.5.
    changed = replan(plan(100), 1.0, 20)

    assert changed.at(0.5)[0] == pytest.approx(50)
    assert changed.duration == pytest.approx(0.5 + 0.5 + 0.1 + 0.5)
    assert changed.at(changed.duration) == (20.0, 0.0, 0.0)


def test_a_new_target_just_at_the_braking_way_is_one_ramp() -> None:
    changed = replan(plan(100), 1.0, 50)

    assert changed.count == 1
    assert changed.duration == 0.5


def test_a_new_velocity() -> None:
    # At 1 s: 37.5 with 50; to 80 over 19.5 in 0.3 s, braking 32 in 0.8 s.
    faster = replan(plan(100), 1.0, 100, vmax=80)
    # To 20 over 10.5 in 0.3 s, braking 2 in 0.2 s.
    slower = replan(plan(100), 1.0, 100, vmax=20)

    assert faster.duration == pytest.approx(0.3 + (62.5 - 51.5) / 80 + 0.8)
    assert slower.duration == pytest.approx(0.3 + (62.5 - 12.5) / 20 + 0.2)


def test_an_override_scales_velocity_and_rates_alike() -> None:
    k = 0.5
    from_the_start = plan(100, vmax=k * 50, acc=k * 100, dec=k * 100)
    # At 1 s: 37.5 with 50; to 25 at 50 over 18.75 in 0.5 s; braking 6.25 in 0.5 s.
    on_the_way = replan(plan(100), 1.0, 100, vmax=k * 50, acc=k * 100, dec=k * 100)

    assert from_the_start.duration == pytest.approx(4.5)
    assert on_the_way.duration == pytest.approx(0.5 + (62.5 - 25) / 25 + 0.5)


@pytest.mark.parametrize("v1", [0.0, 1e-3, 1.0, 20.0, -20.0])
@pytest.mark.parametrize("target", [0.0, 100.0, -1e4])
def test_planning_again_in_every_cycle_changes_nothing(target: float, v1: float) -> None:
    rest: dict[str, float] = {"v1": v1, "vmax": 50, "acc": 80, "dec": 120}
    start = target - 20
    whole = plan(target, start=start, **rest)
    position, velocity = start, 0.0
    cycle_s = 1.28e-3

    for cycle in range(1, int(whole.duration / cycle_s)):
        again = plan(target, start=position, v0=velocity, **rest)
        position, velocity, _ = again.at(cycle_s)
        assert (position, velocity) == pytest.approx(whole.at(cycle * cycle_s)[:2], rel=1e-11, abs=1e-9)


def test_rounding_in_mid_ramp_does_not_turn_back_for_run_up() -> None:
    # Missing the target velocity of 1 by a last bit would cost 0.04 s of turning back.
    whole = plan(0, start=-100, v1=1)

    for time_s in np.arange(0.0, whole.duration, 1e-3):
        rest = replan(whole, float(time_s), 0, v1=1)
        assert time_s + rest.duration == pytest.approx(whole.duration, abs=1e-9)


def test_the_first_position_is_the_start_to_the_last_bit() -> None:
    # One ramp over 12.5, where 0.3 + 12.5 is rounded.
    profile = plan(0.3 + 12.5, start=0.3, v1=50)

    assert profile.count == 1
    assert profile.at(0.0) == (0.3, 0.0, 100.0)


# --- Braking to rest ---


@pytest.mark.parametrize("jerkrel", [0.0, 0.2, 1.0])
def test_a_stop_brakes_to_where_it_comes_to_rest(jerkrel: float) -> None:
    profile = stop(10.0, 50.0, 200.0, jerkrel)

    assert profile.duration == pytest.approx(0.25)
    assert profile.at(profile.duration) == (16.25, 0.0, 0.0)
    assert profile.at(0.0)[:2] == (10.0, 50.0)
    assert integrated(profile) == pytest.approx((16.25, 0.0), abs=1e-12)
    assert stop(10.0, -50.0, 200.0, jerkrel).at(1.0)[0] == 3.75


@pytest.mark.parametrize(("v0", "dec"), [(50.0, 0.0), (0.0, 100.0), (0.0, 0.0)])
def test_a_stop_at_once(v0: float, dec: float) -> None:
    profile = stop(10.0, v0, dec)

    assert profile.count == 0
    assert profile.at(0.0) == (10.0, 0.0, 0.0)
    assert profile.at(1.0) == (10.0, 0.0, 0.0)


# --- Numbers that cannot be meant ---


@pytest.mark.parametrize(
    "bad",
    [
        {"vmax": 0},
        {"vmax": -50},
        {"vmax": math.nan},
        {"acc": 0},
        {"dec": -1},
        {"dec": math.inf},
        {"acc": math.nan},
        {"v0": math.nan},
        {"v1": math.inf},
        {"start": math.inf},
        {"target": math.nan},
    ],
)
def test_a_plan_that_cannot_be_meant_is_refused_and_leaves_the_profile(bad: dict[str, float]) -> None:
    arguments: dict[str, float] = {"target": 100.0, **bad}
    profile = plan(**arguments)

    assert profile.count == PROFILE_REFUSED
    assert np.isnan(profile.phases).all()


def test_an_infinite_maximum_velocity_is_no_limit() -> None:
    assert plan(1e4, vmax=math.inf).duration == pytest.approx(2 * math.sqrt(1e4 / 100))
