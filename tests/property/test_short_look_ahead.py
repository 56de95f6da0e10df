"""Whatever a look-ahead of a few blocks sees, and corners leave to ramps: limits hold, and going on costs no time."""

from __future__ import annotations

import math

import hypothesis.strategies as st
from hypothesis import HealthCheck, given, settings

from polycnc.kernel import skip
from support.random_paths import PathSettings, overload, random_path, run_recorded

ROUNDING = 1.0 + 1e-6
lengths = st.sampled_from([None, 0.0002, 0.002, 0.05, 1.0])
tolerances = st.sampled_from([0.0, 0.02, 0.1, math.inf])
jerkrels = st.sampled_from([0.0, 0.3, 1.0])
few = settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow], deadline=None)


@few
@given(st.integers(0, 10**6), lengths, tolerances, jerkrels, st.sampled_from([2, 3]))
def test_going_on_is_never_slower_than_stopping(
    seed: int, length: float | None, tolerance: float, jerkrel: float, depth: int
) -> None:
    path = PathSettings(tolerance=tolerance, jerkrel=jerkrel, depth=depth)
    going, stopping = (
        skip(state, 0, int(state.paths.row[0]["tail"]))
        for state in (
            random_path(seed, path, length, most=60),
            random_path(seed, path, length, stops=True, most=60),
        )
    )
    assert going <= stopping


@few
@given(
    st.integers(0, 10**6),
    lengths,
    st.sampled_from([0.02, 0.2, math.inf]),
    st.floats(0.001, 0.5),
    st.floats(0.1, 0.5),
    st.floats(0.5, 0.9),
    st.sampled_from([0, 2, 3, 16]),
)
def test_whatever_arcs_in_corners_leave_to_ramps_axes_keep_their_limits(
    seed: int, length: float | None, tolerance: float, corner: float, rounding: float, last: float, depth: int
) -> None:
    path = PathSettings(tolerance=tolerance, shares=(corner, rounding, last), depth=depth)
    state = random_path(seed, path, length, most=40)
    run_recorded(state)
    speed, acceleration = overload(state)
    assert speed <= ROUNDING
    assert acceleration <= ROUNDING
