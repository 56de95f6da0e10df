"""How fast a helix may be taken: the axis that has the least left decides, whichever it is."""

from __future__ import annotations

import math

import numpy as np
import pytest

from polycnc.kernel import (
    RAPID,
    KernelState,
    append_arc,
    append_line,
    give_to_path,
    make_state,
    prepare_path,
)

# In ZX the way is 3 parts, along Y 4 parts of 5.
RADIUS_MM = 7.5
SWEEP_RAD = 2.4
ACROSS, ALONG = 0.6, 0.8
BEND = ACROSS * ACROSS / RADIUS_MM  # of Z and X, where they have most of it


def helix(speed: tuple[float, ...], acceleration: tuple[float, ...], **path: float) -> KernelState:
    """Return a machine with a line and a helix about Y after it, planned."""
    state = make_state(3, segments=16)
    state.limits.speed[:], state.limits.acceleration[:] = speed, acceleration
    for name, value in path.items():
        state.paths.row[0][name] = value
    give_to_path(state, 0)
    append_line(state.seg, state.paths, 0, state.limits, np.array([2.0, 3.0, -4.0]), 700.0, 0, 1)
    angle = 0.7
    center_z, center_x = -4.0 - RADIUS_MM * math.cos(angle), 2.0 - RADIUS_MM * math.sin(angle)
    angle += SWEEP_RAD
    end = np.array(
        [
            center_x + RADIUS_MM * math.sin(angle),
            3.0 + RADIUS_MM * SWEEP_RAD / ACROSS * ALONG,
            center_z + RADIUS_MM * math.cos(angle),
        ]
    )
    assert append_arc(
        state.seg, state.paths, 0, state.limits, end, 2, 0, center_z, center_x, SWEEP_RAD, 700.0, 0, 2
    )
    state.paths.row[0]["closed"] = 1
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    assert state.seg.row[1]["length"] == pytest.approx(RADIUS_MM * SWEEP_RAD / ACROSS, rel=1e-12)
    return state


@pytest.mark.parametrize(
    ("speed", "cap"),
    [
        ((33.0, 90.0, 95.0), 33.0 / ACROSS),
        ((91.0, 28.0, 95.0), 28.0 / ALONG),
        ((91.0, 90.0, 31.0), 31.0 / ACROSS),
    ],
)
def test_the_slowest_axis_limits_the_speed(speed: tuple[float, ...], cap: float) -> None:
    row = helix(speed, (9000.0, 8000.0, 9500.0)).seg.row[1]
    assert row["cap"] == pytest.approx(cap, rel=1e-12)


@pytest.mark.parametrize("axis", [0, 2])
def test_the_weakest_axis_of_the_plane_limits_the_speed_around_the_curve(axis: int) -> None:
    acceleration = [2300.0, 2500.0, 2700.0]
    acceleration[axis] = 130.0
    state = helix((900.0, 950.0, 980.0), tuple(acceleration))
    # Turning may take sqrt(3/4) of the axis, the change of speed along the path what is then left of 0.95, at right
    # angles to it.
    cap = math.sqrt(math.sqrt(0.75) * 130.0 / BEND)
    assert state.seg.row[1]["cap"] == pytest.approx(cap, rel=1e-12)
    left = math.sqrt(0.95**2 - 0.75)
    assert state.seg.row[1]["full_accel"] == pytest.approx(left * 130.0 / ACROSS, rel=1e-12)


@pytest.mark.parametrize(("axis", "part"), [(0, ACROSS), (1, ALONG), (2, ACROSS)])
def test_the_weakest_axis_limits_the_change_of_speed(axis: int, part: float) -> None:
    acceleration = [2300.0, 2500.0, 2700.0]
    acceleration[axis] = 410.0
    state = helix((70.0, 60.0, 80.0), tuple(acceleration))
    cap = 60.0 / ALONG
    assert state.seg.row[1]["cap"] == pytest.approx(cap, rel=1e-12)
    used = cap * cap * BEND / 410.0 if axis != 1 else 0.0
    assert state.seg.row[1]["full_accel"] == pytest.approx(
        math.sqrt(0.95**2 - used**2) * 410.0 / part, rel=1e-12
    )


def test_limits_of_the_path_count_as_those_of_axes() -> None:
    slow = helix((900.0, 950.0, 980.0), (2300.0, 2500.0, 2700.0), speed_limit_mm_s=43.0).seg.row
    assert slow["cap"][:2].tolist() == [43.0, 43.0]
    weak = helix((900.0, 950.0, 980.0), (2300.0, 2500.0, 2700.0), accel_limit_mm_s2=130.0).seg.row
    assert weak[0]["full_accel"] == 130.0
    assert weak[1]["cap"] == pytest.approx(math.sqrt(math.sqrt(0.75) * 130.0 / BEND), rel=1e-12)
    # Where the path turns least of all, along Y, its own limit is what is left.
    left = math.sqrt(0.95**2 - 0.75)
    assert weak[1]["full_accel"] == pytest.approx(left * 130.0 / ACROSS, rel=1e-12)


@pytest.mark.parametrize(
    ("flags", "override", "dry_mm_s", "speed_mm_s"),
    [
        (0, 0.7, 0.0, 490.0),
        (0, 0.0, 0.0, 700.0),
        (0, 0.7, 40.0, 28.0),
        (RAPID, 0.7, 40.0, 900.0 / 0.8 * 0.75),
    ],
)
def test_the_feed_in_force(flags: int, override: float, dry_mm_s: float, speed_mm_s: float) -> None:
    state = make_state(3, segments=16)
    state.limits.speed[:], state.limits.acceleration[:] = 900.0, 5000.0
    row = state.paths.row[0]
    row["override"], row["dry_feed_mm_s"], row["rapid_override"], row["closed"] = override, dry_mm_s, 0.75, 1
    give_to_path(state, 0)
    append_line(
        state.seg,
        state.paths,
        0,
        state.limits,
        np.array([30.0, 0.0, -40.0]),
        math.inf if flags else 700.0,
        flags,
        1,
    )
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    assert state.seg.row[0]["cap"] == pytest.approx(speed_mm_s, rel=1e-12)
