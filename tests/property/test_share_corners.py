"""Corners that take a share of the acceleration, arcs as large as their speed needs, lines that hold the rest back."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.kernel import (
    EXACT_PATH,
    RAPID,
    append_arc,
    append_line,
    append_wait,
    give_to_path,
    prepare_path,
    skip,
    start_path,
)
from polycnc.kernel._segments import CIRCLE3D, LINE
from polycnc.machine import LinearAxis, Machine, MachineConfig, PathConfig
from support.random_paths import PathSettings, overload, random_path, run_recorded

Floats = npt.NDArray[np.float64]

CYCLE_S = 0.001
SHARE = 0.07
SPEED = np.array([137.0, 113.0, 41.0])
ACCELERATION = np.array([1700.0, 1300.0, 430.0])
RULES = {"corner_share": SHARE, "rounding_share": 0.45, "last_share": 0.7, "rounding_gap_s": 0.003}


class Track:
    """A path of lines from the origin on a machine with these rules."""

    def __init__(self, tolerance: float, **rules: float) -> None:
        config = MachineConfig(
            name="router",
            axis=tuple(
                LinearAxis(name=name, vmax_mm_s=v, amax_mm_s2=a)
                for name, v, a in zip("XYZ", SPEED, ACCELERATION, strict=True)
            ),
            path=PathConfig.model_validate(rules or RULES),
        )
        self.state = Machine(config, segments=4096).state
        self.row = self.state.paths.row[0]
        self.row["tolerance_mm"] = tolerance
        give_to_path(self.state, 0)
        self.tag = 0

    def line(self, *point: float, feed: float = 60.0, flags: int = 0) -> None:
        self.tag += 1
        state = self.state
        append_line(state.seg, state.paths, 0, state.limits, np.array(point), feed, flags, self.tag)

    def close(self) -> None:
        self.row["closed"] = 1
        prepare_path(self.state.seg, self.state.paths, 0, self.state.limits, CYCLE_S, self.state.work)

    def rows(self) -> npt.NDArray[np.void]:
        return self.state.seg.row[: int(self.row["tail"])]

    def time(self) -> float:
        self.close()
        start_path(self.state.paths, 0)
        return float(skip(self.state, 0, int(self.row["tail"])) * CYCLE_S)


def whole(time_s: float) -> float:
    return math.ceil(time_s / CYCLE_S - 1e-9) * CYCLE_S


# ------------------------------------------------------------------ corners as they are


def needed(u: Floats, w: Floats, speed: float, accel: float) -> float:
    """Return what part of its acceleration the busiest axis needs for a corner within a cycle."""
    return float(np.max(np.abs(w - u) * (speed / CYCLE_S + accel) / ACCELERATION))


def allowed(u: Floats) -> float:
    with np.errstate(divide="ignore"):
        return float(np.min(ACCELERATION / np.abs(u)))


@pytest.mark.parametrize("turn", [2e-5, 2e-4, 0.004, 0.3, 2.0])
def test_a_corner_is_passed_with_its_share_and_both_lines_keep_the_rest(turn: float) -> None:
    track = Track(0.0)
    u, w = np.array([0.8, 0.6, 0.0]), np.array([math.cos(0.9), math.sin(0.9), 0.0])
    w = np.array(
        [0.8 * math.cos(turn) - 0.6 * math.sin(turn), 0.6 * math.cos(turn) + 0.8 * math.sin(turn), 0.0]
    )
    track.line(*(30.0 * u))
    track.line(*(30.0 * u + 20.0 * w))
    track.close()
    share = needed(u, w, 60.0, allowed(w))
    first, second = track.rows()
    assert first["junction"] == pytest.approx(60.0 * min(1.0, SHARE / share), rel=1e-9)
    held = min(share, SHARE)
    assert first["accel"] == pytest.approx(allowed(u) * (1.0 - held), rel=1e-9)
    assert second["accel"] == pytest.approx(allowed(w) * (1.0 - held), rel=1e-9)


def test_an_exact_path_rests_in_corners_with_the_lines_held_back() -> None:
    track = Track(EXACT_PATH)
    points = [(20.0, 0.0, 0.0), (20.0, 0.9, 0.0), (4.0, 0.9, 0.0)]
    for point in points:
        track.line(*point)
    expected = 0.0
    for length, axis in ((20.0, 0), (0.9, 1), (16.0, 0)):
        accel = ACCELERATION[axis] * (1.0 - SHARE)
        top = min(60.0, math.sqrt(length * accel))
        expected += whole(length / top + top / accel)
    assert track.time() == pytest.approx(expected, abs=1e-9)


def test_an_exact_path_goes_on_through_a_corner_that_needs_less_than_the_share() -> None:
    track = Track(EXACT_PATH)
    track.line(20.0, 0.0, 0.0)
    track.line(40.0, 0.0004, 0.0)
    track.line(60.0, 0.3, 0.0)
    track.close()
    first, second, _ = track.rows()
    assert first["junction"] == 60.0
    assert second["junction"] == 0.0


@pytest.mark.parametrize("tolerance", [EXACT_PATH, 0.0, 0.05])
def test_a_path_that_turns_back_rests_and_its_lines_keep_all_of_their_acceleration(tolerance: float) -> None:
    track = Track(tolerance)
    track.line(30.0, 0.0, 0.0)
    track.line(11.0, 0.3, 0.0)  # turned by 179.1 degrees
    track.line(11.0, 9.0, 0.0)
    track.close()
    first, second = track.rows()[:2]
    assert first["junction"] == 0.0
    assert first["accel"] == pytest.approx(ACCELERATION[0], rel=1e-9)
    held = SHARE if tolerance <= 0.0 else 0.0  # by the next corner, where that is not rounded
    u = np.array([-19.0, 0.3, 0.0]) / math.hypot(19.0, 0.3)
    assert second["accel"] == pytest.approx(allowed(u) * (1.0 - held), rel=1e-6)


# ------------------------------------------------------------------ rounded corners


def arc_of(
    u: Floats, w: Floats, lengths: tuple[float, float], feeds: tuple[float, float], tolerance: float
) -> tuple[float, float]:
    """Return radius and highest speed of the arc between two lines, from the rule in words.

    The largest arc keeps the tolerance, which is at most a quarter of the shorter line, and takes half of each line.
    The path goes along it with the higher feed or what the axes allow in its plane. It is as small as that speed lets
    it be, but no smaller than what the path covers, by angle, in the time in which two ramps of half the acceleration
    overlap.
    """
    turn = math.acos(np.clip(u @ w, -1.0, 1.0))
    normal = np.cross(u, w) / np.linalg.norm(np.cross(u, w))
    in_plane = np.sqrt(1.0 - normal**2)
    with np.errstate(divide="ignore"):
        accel = float(np.min(ACCELERATION / in_plane))
        speed = min(
            max(feeds), *(float(np.min(SPEED / np.abs(v))) for v in (u, w)), float(np.min(SPEED / in_plane))
        )
    within = min(tolerance, 0.25 * min(lengths)) / (1.0 / math.cos(0.5 * turn) - 1.0)
    room = 0.5 * min(lengths) / math.tan(0.5 * turn)
    largest = min(within, room)
    speed = min(speed, math.sqrt(math.sqrt(0.75) * accel * largest))
    overlap = 2.0 * min(math.sqrt(accel * largest * math.tan(0.5 * turn)), speed) / accel
    radius = max(speed**2 / (math.sqrt(0.75) * accel), min(overlap * speed / turn, largest))
    return radius, speed


@pytest.mark.parametrize("tolerance", [0.003, 0.2, math.inf])
@pytest.mark.parametrize("seed", range(12))
def test_the_arc_is_as_large_as_its_speed_needs(seed: int, tolerance: float) -> None:
    rng = np.random.default_rng(seed)
    u, w = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)) * [1.0, 1.0, rng.choice([0.0, 0.4])])
    lengths = tuple(rng.uniform(0.5, 12.0, 2))
    feeds = tuple(rng.uniform(5.0, 120.0, 2))
    track = Track(tolerance)
    track.line(*(lengths[0] * u), feed=feeds[0])
    track.line(*(lengths[0] * u + lengths[1] * w), feed=feeds[1])
    track.close()
    before, arc, _ = track.rows()
    radius, speed = arc_of(u, w, lengths, feeds, tolerance)
    turn = math.acos(u @ w)
    assert arc["kind"] == CIRCLE3D
    assert arc["length"] == pytest.approx(radius * turn, rel=1e-6)
    assert min(arc["cap"], max(feeds)) == pytest.approx(speed, rel=1e-6)
    assert radius * (1.0 / math.cos(0.5 * turn) - 1.0) <= min(tolerance, 0.25 * min(lengths)) * (1.0 + 1e-9)
    assert before["length"] == pytest.approx(lengths[0] - radius * math.tan(0.5 * turn), rel=1e-6)


def test_arcs_and_what_is_left_of_a_line_beside_them_have_their_share() -> None:
    track = Track(math.inf)
    for point in ((30.0, 0.0, 0.0), (30.0, 0.4, 0.0), (29.6, 0.4, 0.0), (29.6, 20.0, 0.0)):
        track.line(*point, feed=100.0)
    track.close()
    rows = track.rows()
    assert [int(row["kind"]) for row in rows] == [LINE, CIRCLE3D] * 3 + [LINE]
    for arc in rows[1::2]:
        assert arc["accel"] == pytest.approx(0.45 * ACCELERATION[1], rel=1e-6)
    assert rows[0]["accel"] == pytest.approx(ACCELERATION[0], rel=1e-9)
    assert rows[2]["length"] < 0.003 * rows[3]["cap"]  # next to nothing is left of it
    assert rows[2]["accel"] == pytest.approx(0.45 * ACCELERATION[1], rel=1e-9)


def test_positioning_is_rounded_as_well_but_not_into_feed() -> None:
    track = Track(0.2)
    track.line(30.0, 0.0, 0.0, feed=math.inf, flags=RAPID)
    track.line(30.0, 20.0, 0.0, feed=math.inf, flags=RAPID)
    track.line(10.0, 20.0, 0.0)
    track.close()
    rows = track.rows()
    assert [int(row["kind"]) for row in rows] == [LINE, CIRCLE3D, LINE, LINE]
    assert all(row["flags"] & RAPID for row in rows[:3])
    assert rows[2]["out"] == 0.0
    full = rows["cap"][1]
    slow = Track(0.2)
    slow.row["rapid_override"] = 0.3
    slow.line(30.0, 0.0, 0.0, feed=math.inf, flags=RAPID)
    slow.line(30.0, 20.0, 0.0, feed=math.inf, flags=RAPID)
    slow.close()
    assert slow.rows()["cap"][1] == pytest.approx(0.3 * full, rel=1e-9)


# ------------------------------------------------------------------ the end


def wait(track: Track) -> None:
    append_wait(track.state.seg, track.state.paths, 0, 0.4, -1, 99, 0)


@pytest.mark.parametrize("end", [Track.close, wait], ids=["end", "wait"])
def test_the_last_line_has_its_share_and_is_entered_so_that_it_may_be_the_last(
    end: Callable[[Track], None],
) -> None:
    track = Track(0.01)
    track.line(30.0, 0.0, 0.0)
    track.line(32.0, 0.0003, 0.0)
    end(track)
    track.close()
    first, last = track.rows()[:2]
    share = needed(np.array([1.0, 0, 0]), np.array([1.0, 0.00015, 0.0]), 60.0, ACCELERATION[0])
    accel = 0.7 * ACCELERATION[0]
    assert first["junction"] == pytest.approx(math.sqrt(accel * 2.0), rel=1e-6)
    assert last["accel"] == pytest.approx(accel * (1.0 - share), rel=1e-6)


def test_the_last_arc_has_its_share_too() -> None:
    track = Track(0.01, **(RULES | {"last_share": 0.55}))
    state = track.state
    append_arc(
        state.seg,
        state.paths,
        0,
        state.limits,
        np.array([0.0, 40.0, 0.0]),
        0,
        1,
        0.0,
        20.0,
        math.pi,
        9.0,
        0,
        1,
    )
    track.close()
    (arc,) = track.rows()
    # As if turning took its most, whatever the radius: 0.5 of what the axes have, and 0.55 of that.
    assert arc["accel"] == pytest.approx(0.55 * 0.5 * ACCELERATION[1], rel=1e-3)


# ------------------------------------------------------------------ limits


@pytest.mark.parametrize("tolerance", [EXACT_PATH, 0.01, math.inf])
@pytest.mark.parametrize("length", [0.003, 0.1, 3.0])
def test_lines_of_one_length_keep_the_limits_of_the_axes(tolerance: float, length: float) -> None:
    settings = replace(PathSettings(tolerance=tolerance), shares=(0.1, 0.5, 0.5))
    for seed in range(12):
        state = random_path(seed, settings, length)
        run_recorded(state)
        assert max(overload(state)) <= 1.0 + 1e-6, f"seed {seed}"


@pytest.mark.parametrize(
    ("rules", "what"),
    [
        ({"corner_share": 0.1, "square_corner_mm_s": 5.0}, "'square_corner_mm_s' and 'corner_share'"),
        ({"corner_share": 0.1, "jerk_mm_s3": 900.0}, "ramps of even acceleration"),
        ({"corner_share": 0.1, "rounding_share": 0.51}, "rounding_share"),
        ({"last_share": 0.6}, "'last_share' needs 'corner_share'"),
        ({"rounding_gap_s": 0.003}, "'rounding_gap_s' needs 'corner_share'"),
        ({"free_overlaps": True}, "'free_overlaps' needs 'corner_share'"),
    ],
)
def test_rules_that_do_not_go_together_are_refused(rules: dict[str, float], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        PathConfig.model_validate(rules)
