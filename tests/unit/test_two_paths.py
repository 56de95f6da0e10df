"""Two paths of one machine, each with limits and axes of its own, go as each would alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.kernel import (
    PATH_RESTED,
    KernelState,
    advance,
    append_line,
    append_wait,
    free_slots,
    give_to_path,
    make_state,
    prepare_path,
    replan_path,
    start_path,
)

Floats = npt.NDArray[np.float64]
CYCLE_S = 0.01
AXES = ((3, 0), (1, 2))  # of the two paths
ENDS = (
    [(2.3, -1.7), (4.1, -0.6), (4.4, 2.9), (7.7, 3.1)],
    [(-3.9, 0.8), (-4.2, 4.7), (1.3, 5.2), (2.6, 9.9), (3.1, 9.7)],
)
FEEDS = (37.0, 29.0)


def machine(limited: bool) -> KernelState:
    state = make_state(4, cycle_s=CYCLE_S, paths=2, segments=12)
    state.limits.speed[:], state.limits.acceleration[:] = 90.0, (510.0, 430.0, 470.0, 390.0)
    for g in range(2):
        state.paths.axis[g] = -1
        state.paths.axis[g, :2] = AXES[g]
        state.paths.row[g]["jerk_mm_s3"] = 9000.0 * (g + 1) if limited else 0.0
        state.paths.row[g]["jerkrel"] = 0.0 if limited else 0.37 * g
    return state


def queue(state: KernelState, g: int) -> None:
    give_to_path(state, g)
    for tag, (x, y) in enumerate(ENDS[g], 1):
        end = np.array([x, y, 0.0, 0.0])
        assert append_line(state.seg, state.paths, g, state.limits, end, FEEDS[g], 0, tag)
    append_wait(state.seg, state.paths, g, 0.04, -1, 9, 0)
    assert free_slots(state.paths, g) == 6 - len(ENDS[g]) - 1
    state.paths.row[g]["closed"] = 1
    prepare_path(state.seg, state.paths, g, state.limits, CYCLE_S, state.work)
    start_path(state.paths, g)


def positions(state: KernelState, changes: bool) -> Floats:
    """Return the setpoints of every cycle."""
    rows = []
    for cycle in range(125):
        if changes and cycle == 11:  # of path 1 alone
            state.paths.row[1]["override"] = 0.43
            replan_path(state.seg, state.paths, 1, state.limits, CYCLE_S, state.work)
        if changes and cycle == 17:
            state.paths.row[0]["hold"] = 1
            replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
        advance(state, 1)
        rows.append(state.setpoint.copy())
    return np.array(rows)


@pytest.mark.parametrize("changes", [False, True])
@pytest.mark.parametrize("limited", [False, True])
def test_each_path_goes_as_if_it_were_alone(limited: bool, changes: bool) -> None:
    both = machine(limited)
    queue(both, 0)
    queue(both, 1)
    together = positions(both, changes)
    for g in range(2):
        alone = machine(limited)
        queue(alone, g)
        assert np.array_equal(positions(alone, changes)[:, AXES[g]], together[:, AXES[g]])
        if not changes:
            assert tuple(together[-1, AXES[g]]) == ENDS[g][-1]
            assert alone.clock[0]["raised"] & PATH_RESTED == 0  # long ago
    assert not np.array_equal(both.paths.totals[0], both.paths.totals[1])
