"""Corners of lines and arcs in one plane, rounded: the arcs touch both, stay within the tolerance, and save time."""

from __future__ import annotations

import itertools
import math

import numpy as np
import numpy.typing as npt
import pytest
import scipy

import polycnc
from polycnc.kernel import (
    BY_SHARE,
    EXACT_PATH,
    RAPID,
    STOP,
    KernelState,
    append_arc,
    append_line,
    give_to_path,
    make_state,
    skip,
    start_path,
)
from polycnc.kernel._geometry import segment_tangent
from polycnc.kernel._segments import ARC, LINE, RADIUS_END, RADIUS_START, ROUNDING, SWEEP_RAD
from polycnc.machine import load_machine
from support.random_paths import CYCLE_S, PathSettings, machine, overload, prepare, run_recorded, seeds

Floats = npt.NDArray[np.float64]

PLANES = {"G17": (0, 1), "G18": (2, 0), "G19": (1, 2)}


class Chain:
    """Lines and arcs in a plane from the origin, the first along the first axis; bend 0 is a line, else 1 / radius."""

    def __init__(self, state: KernelState, plane: tuple[int, int] = (0, 1), feed: float = 60.0) -> None:
        self.state = state
        self.plane = plane
        self.feed = feed
        self.place = np.zeros(3)
        self.heading = 0.0
        self.corners: list[Floats] = []
        self.tag = 0

    def go(self, turn: float, bend: float, length: float, *, growth: float = 0.0, flags: int = 0) -> None:
        """Turn by an angle, then go along `length` mm with a curvature; an arc's radius grows by `growth` mm."""
        state, (p, q) = self.state, self.plane
        if self.tag:
            self.corners.append(self.place)
        self.tag += 1
        self.heading += turn
        end = self.place.copy()
        if bend == 0.0:
            end[p] += length * math.cos(self.heading)
            end[q] += length * math.sin(self.heading)
            append_line(state.seg, state.paths, 0, state.limits, end, self.feed, flags, self.tag)
        else:
            center = (
                self.place[p] - math.sin(self.heading) / bend,
                self.place[q] + math.cos(self.heading) / bend,
            )
            sweep = length * bend
            radius = 1.0 + growth * abs(bend)
            end[p] = center[0] + radius * math.sin(self.heading + sweep) / bend
            end[q] = center[1] - radius * math.cos(self.heading + sweep) / bend
            append_arc(
                state.seg, state.paths, 0, state.limits, end, p, q, *center, sweep, self.feed, flags, self.tag
            )
            self.heading += sweep
        self.place = end

    def rows(self) -> npt.NDArray[np.void]:
        return self.state.seg.row[: int(self.state.paths.row[0]["tail"])]

    def roundings(self) -> list[int]:
        return [k for k, row in enumerate(self.rows()) if row["kind"] == ARC and int(row["flags"]) & ROUNDING]


def chain(tolerance: float, plane: tuple[int, int] = (0, 1), feed: float = 60.0) -> Chain:
    state = make_state(3, cycle_s=CYCLE_S, segments=4096)
    state.limits.speed[:], state.limits.acceleration[:] = 150.0, 800.0
    state.paths.row[0]["tolerance_mm"] = tolerance
    give_to_path(state, 0)
    return Chain(state, plane, feed)


def kink(state: KernelState, k: int) -> float:
    """Return by how much the direction changes from segment `k` to the next one."""
    before, after = np.zeros(3), np.zeros(3)
    segment_tangent(state.seg, k, 1.0, before)
    segment_tangent(state.seg, k + 1, 0.0, after)
    return float(np.linalg.norm(after / np.linalg.norm(after) - before / np.linalg.norm(before)))


def distance(path: Chain, k: int, corner: Floats) -> float:
    """Return how far the circle of the arc `k` stays away from its corner."""
    p, q = path.plane
    center_p, center_q, radius = path.state.seg.geo[k, :3]
    return float(abs(math.hypot(corner[p] - center_p, corner[q] - center_q) - radius))


def expect_smooth(path: Chain, k: int) -> None:
    seg = path.state.seg
    assert np.array_equal(seg.start[k], seg.end[k - 1])
    assert np.array_equal(seg.start[k + 1], seg.end[k])
    # A coordinate has some 14 digits, and so has the direction of what is left between two arcs.
    most = max(1e-9, 1e-14 / min(path.rows()["length"][k - 1 : k + 2]), 1e-14 / seg.geo[k, RADIUS_START])
    assert kink(path.state, k - 1) < most
    assert kink(path.state, k) < most
    assert abs(seg.geo[k, RADIUS_START] - seg.geo[k, RADIUS_END]) < 1e-9


TURNS = (1e-3, 0.05, 0.7, 1.6, 2.4, 2.9)
BENDS = (0.0, 0.25, -0.25)


@pytest.mark.parametrize("plane", PLANES.values(), ids=PLANES)
@pytest.mark.parametrize(
    ("bend", "bend_after"), [pair for pair in itertools.product(BENDS, BENDS) if any(pair)]
)
def test_the_arc_touches_both_and_passes_the_corner_at_the_tolerance(
    plane: tuple[int, int], bend: float, bend_after: float
) -> None:
    for turn, side in itertools.product(TURNS, (1.0, -1.0)):
        path = chain(0.02, plane)
        path.go(0.0, 0.0, 10.0)  # touches the next
        path.go(0.0, bend, 10.0)
        path.go(side * turn, bend_after, 10.0)
        (k,) = path.roundings()
        expect_smooth(path, k)
        assert np.sign(path.state.seg.geo[k, SWEEP_RAD]) == side
        far = distance(path, k, path.corners[-1])
        assert far <= 0.02 * (1.0 + 1e-9)
        if turn > 0.5:  # what is nearly straight is limited by half of the arcs
            assert far == pytest.approx(0.02, rel=1e-3)
        # What was cut off on both sides is not traversed, the rest is.
        length = path.rows()["length"]
        kept = length[k - 1] + length[k + 1] + (0.0 if bend else length[0] - 10.0)
        assert kept < 20.0
        assert path.state.seg.end[k + 1] == pytest.approx(path.place, abs=1e-12)


def test_a_line_and_a_circle_by_hand() -> None:
    """A line along X ends in a circle of 10 mm about (0, 10) that it would touch, had it not been turned by 90 deg.

    The arc of radius r inside lies r off the line X = 0 and 10 - r off the centre: (r, 10 - sqrt((10 - r)^2 - r^2)).
    """
    path = chain(0.1)
    path.go(math.pi / 2, 0.0, -10.0)
    path.go(0.0, 0.0, 10.0)  # up to the corner at the origin
    path.go(-math.pi / 2, 0.1, 10.0)
    (k,) = path.roundings()
    radius = path.state.seg.geo[k, RADIUS_START]
    # The turn is to the right, the circle bends to the left: the arc lies outside, r below the corner's level.
    centre = (radius, 10.0 - math.sqrt((10.0 + radius) ** 2 - radius**2))
    assert path.state.seg.geo[k, :2] == pytest.approx(centre, abs=1e-9)
    assert math.hypot(*centre) - radius == pytest.approx(0.1, rel=1e-6)


def test_a_cusp_of_two_equal_arcs_by_hand() -> None:
    """Two circles of 5 mm about (-3, 4) and (3, 4) meet in the origin; the rounding arc lies on X = 0."""
    path = chain(0.05)
    first, sweep = math.atan2(-4.0, 3.0) - 1.2, 1.2
    path.place = np.array([-3.0 + 5.0 * math.cos(first), 4.0 + 5.0 * math.sin(first), 0.0])
    path.state.paths.queued[0] = path.place
    path.heading = first + math.pi / 2
    path.go(0.0, 0.2, 5.0 * sweep)
    assert path.place == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    turn = -2.0 * math.atan2(3.0, 4.0)
    path.go(turn, 0.2, 5.0 * sweep)
    (k,) = path.roundings()
    radius, (x, y) = path.state.seg.geo[k, RADIUS_START], path.state.seg.geo[k, :2]
    assert x == pytest.approx(0.0, abs=1e-9)
    assert math.hypot(3.0, y - 4.0) == pytest.approx(5.0 + radius, abs=1e-9)
    assert abs(y) - radius == pytest.approx(0.05, rel=1e-6)


def test_arcs_keep_half_for_either_end() -> None:
    path = chain(math.inf)
    for _ in range(4):
        path.go(1.2, 0.5, 3.0)
    found = path.roundings()
    assert len(found) == 3
    for k in found:
        expect_smooth(path, k)
    arcs = [row for k, row in enumerate(path.rows()) if k not in found]
    assert all(row["length"] > 0.0 for row in arcs)
    assert arcs[0]["length"] >= 1.5
    assert arcs[-1]["length"] >= 1.5


def test_a_full_circle_between_two_lines() -> None:
    path = chain(1.0)
    path.go(0.0, 0.0, 20.0)
    path.go(1.0, 1.0, 2.0 * math.pi)
    path.go(1.0, 0.0, 20.0)
    before, after = path.roundings()
    for k in (before, after):
        expect_smooth(path, k)
    assert math.pi < abs(path.state.seg.geo[before + 1, SWEEP_RAD]) < 2.0 * math.pi


@pytest.mark.parametrize("growth", [1e-4, -3e-4, 0.02])
def test_an_arc_whose_end_lies_off_its_circle_is_touched_too(growth: float) -> None:
    path = chain(0.05)
    path.go(0.0, 0.0, 20.0)
    path.go(0.8, 0.2, 7.0, growth=growth)
    path.go(-1.3, -0.3, 6.0, growth=growth)
    path.go(1.1, 0.0, 9.0)
    found = path.roundings()
    assert len(found) == 3
    for k, corner in zip(found, path.corners, strict=True):
        expect_smooth(path, k)
        assert distance(path, k, corner) <= 0.05 * (1.0 + 1e-9)


@pytest.mark.parametrize(
    ("tolerance", "turn", "bend", "flags"),
    [
        pytest.param(0.0, 1.0, 0.2, 0, id="no tolerance"),
        pytest.param(EXACT_PATH, 1.0, 0.2, 0, id="exact path"),
        pytest.param(0.1, 0.0, 0.2, 0, id="tangential"),
        pytest.param(0.1, math.pi, 0.2, 0, id="reversal"),
        pytest.param(0.1, math.pi, -0.2, 0, id="reversal to the other side"),
        pytest.param(0.1, 1.0, 0.2, STOP, id="exact stop"),
        pytest.param(0.1, 1.0, 0.2, RAPID, id="positioning"),
    ],
)
def test_corners_that_stay_as_they_are(tolerance: float, turn: float, bend: float, flags: int) -> None:
    path = chain(tolerance)
    path.go(0.0, 0.0, 10.0, flags=flags)
    path.go(turn, bend, 10.0)
    assert [int(kind) for kind in path.rows()["kind"]] == [LINE, ARC]
    assert path.rows()["length"] == pytest.approx([10.0, 10.0], rel=1e-12)


@pytest.mark.parametrize("lifted", ["line", "helix"])
def test_what_leaves_the_plane_stays_as_it_is(lifted: str) -> None:
    path = chain(0.1)
    state = path.state
    end = np.array([10.0, 0.0, 1.0 if lifted == "line" else 0.0])
    append_line(state.seg, state.paths, 0, state.limits, end, 60.0, 0, 1)
    end = np.array([10.0, 10.0, 1.0])
    append_arc(state.seg, state.paths, 0, state.limits, end, 0, 1, 10.0, 5.0, -math.pi, 60.0, 0, 2)
    assert [int(kind) for kind in path.rows()["kind"]] == [LINE, ARC]


def test_a_machine_of_two_axes_rounds_too() -> None:
    state = make_state(2, segments=16)
    state.limits.speed[:], state.limits.acceleration[:] = 150.0, 800.0
    state.paths.row[0]["tolerance_mm"] = 0.1
    append_line(state.seg, state.paths, 0, state.limits, np.array([10.0, 0.0]), 60.0, 0, 1)
    append_arc(
        state.seg,
        state.paths,
        0,
        state.limits,
        np.array([14.0, -4.0]),
        0,
        1,
        14.0,
        0.0,
        math.pi / 2,
        60.0,
        0,
        2,
    )
    assert [int(kind) for kind in state.seg.row["kind"][:3]] == [LINE, ARC, ARC]


@pytest.mark.parametrize("bend", [0.0, 0.2])
def test_what_may_be_rounded_waits_for_the_corner_behind_it(bend: float) -> None:
    path = chain(0.1)
    row = path.state.paths.row[0]
    path.go(0.0, 0.0, 10.0)
    path.go(0.9, bend, 10.0)
    prepare(path.state, closed=False)
    waiting = int(row["tail"]) - 1
    assert row["prepared"] == waiting
    path.go(0.9, 0.2 - bend, 10.0)
    assert len(path.rows()) == waiting + 3
    prepare(path.state)
    assert row["prepared"] == row["tail"]


def test_what_has_been_planned_is_not_shortened() -> None:
    path = chain(0.1)
    path.go(0.0, 0.1, 10.0)
    prepare(path.state)
    path.go(0.9, 0.2, 10.0)
    assert [int(kind) for kind in path.rows()["kind"]] == [ARC, ARC]
    assert path.rows()["length"] == pytest.approx([10.0, 10.0])


PROGRAM = """G21 G90 G17 {code}
F9000
G1 X20
G2 X30 Y-10 I0 J-10
G1 X42 Y-3
G1 X42.5 Y-2.7
G1 X43 Y-2.4
G3 X43 Y9.6 I-3 J6
G3 X31 Y9.6 I-6 J-1
G1 Z4
G2 X20 Y2 R9
G18
G2 X14 Z4 R5
G1 X10 Z0
G19
G3 Y10 Z2 R6
G1 Y14
M30
"""


def test_a_program_of_lines_and_arcs_keeps_tolerance_and_limits() -> None:
    machine = load_machine("mill3")
    exact, rounded = (
        polycnc.run(PROGRAM.format(code=code), machine, dialect="linuxcnc", trace=True)
        for code in ("G61", "G64 P0.05 Q0.01")
    )
    assert exact.trace is not None
    assert rounded.trace is not None
    assert rounded.time_s < 0.97 * exact.time_s
    assert polycnc.verify_trace(rounded.trace, machine) == []
    assert tuple(rounded.trace.setpoint[-1]) == tuple(exact.trace.setpoint[-1])
    off, _ = scipy.spatial.cKDTree(exact.trace.setpoint).query(rounded.trace.setpoint)
    # Of a step of 0.15 mm in a cycle the nearest point is 0.075 mm at most away along the path.
    assert 0.03 < float(off.max()) < math.hypot(0.05, 0.075) + 0.002


def random_chain(seed: int, settings: PathSettings, *, stops: bool = False) -> Chain:
    """Return a random chain of lines and arcs at corners of every angle, ready to start."""
    rng = np.random.default_rng(seed)
    state = machine(rng, settings)
    path = Chain(state, list(PLANES.values())[seed % 3], float(rng.choice((20.0, 60.0, 300.0))))
    scale = 10.0 ** rng.uniform(-1.0, 1.0)
    for _ in range(40):
        bend = float(rng.choice((0.0, 1.0, -1.0))) / (scale * 10.0 ** rng.uniform(-0.5, 1.0))
        length = scale * 10.0 ** rng.uniform(-1.0, 0.7)
        if bend:
            length = min(length, 5.5 / abs(bend))
        turn = float(rng.choice((0.0, 1e-4, 0.02, 0.3, 1.0, 2.0, 3.0, math.pi))) * float(
            rng.choice((-1.0, 1.0))
        )
        growth = float(rng.choice((0.0, 0.0, 1.0))) * rng.uniform(-1e-4, 1e-4) * scale
        path.go(turn, bend, length, growth=growth, flags=STOP if stops else 0)
    prepare(state)
    start_path(state.paths, 0)
    return path


ROUNDED = (
    PathSettings(tolerance=0.02),
    PathSettings(tolerance=math.inf),
    PathSettings(tolerance=0.05, jerkrel=0.4),
    PathSettings(tolerance=0.05, jerk=2e5),
    PathSettings(tolerance=0.05, shares=(0.1, 0.5, 0.5)),
    PathSettings(tolerance=math.inf, shares=(0.1, 0.5, 0.5)),
)


@pytest.mark.parametrize("settings", ROUNDED, ids=str)
def test_random_chains_keep_limits_and_tolerance(settings: PathSettings) -> None:
    rounded = 0
    for seed in seeds(0, 30):
        path = random_chain(seed, settings)
        found = path.roundings()
        rounded += len(found)
        for k in found:
            expect_smooth(path, k)
            corner = path.corners[int(path.rows()["tag"][k]) - 2]
            assert distance(path, k, corner) <= settings.tolerance * (1.0 + 1e-9)
        assert path.rows()["length"].min() > 0.0
        run_recorded(path.state)
        assert max(overload(path.state)) <= 1.0 + 1e-6, f"seed {seed}"
        assert path.state.paths.position[0] == pytest.approx(path.place, abs=1e-9)
    assert rounded > 10 * len(seeds(0, 30))


@pytest.mark.parametrize("settings", ROUNDED, ids=str)
def test_a_rounded_chain_is_never_slower_than_exact_stops(settings: PathSettings) -> None:
    saved = 0
    for seed in seeds(0, 80):
        cycles = [
            skip(path.state, 0, int(path.state.paths.row[0]["tail"]))
            for path in (random_chain(seed, settings), random_chain(seed, settings, stops=True))
        ]
        assert cycles[0] <= cycles[1], f"seed {seed}"
        saved += cycles[1] - cycles[0]
    assert saved > 0


# ------------------------------------------------------------------ down to next to nothing


def short_chain(
    seed: int,
    tolerance: float,
    *,
    last: float = 0.5,
    stops: bool = False,
    jerk: float = 0.0,
    depth: int = 0,
) -> Chain:
    """Return a random chain of elements down to 1e-7 mm with corners by share, ready to start."""
    rng = np.random.default_rng(seed)
    settings = PathSettings(tolerance=tolerance, shares=(0.1, 0.5, last), jerk=jerk, depth=depth)
    path = Chain(
        machine(rng, settings),
        list(PLANES.values())[seed % 3],
        float(rng.choice((20.0, 60.0, 300.0))),
    )
    path.state.paths.row[0]["rounding_gap_s"] = 0.004
    shortest = rng.uniform(-7.0, 0.0)
    longest = min(1.0, shortest + float(rng.choice((0.5, 2.0, 9.0))))
    count = int(rng.choice((2, 4, 10, 40)))
    turns: tuple[float, ...] = (0.0, 1e-4, 0.003, 0.02, 0.3, 1.0, 2.0, 3.0, math.pi)
    if seed % 2 == 0:
        turns = (0.0, 1e-3, 0.01, 0.05, 10.0 ** rng.uniform(-4, 0))
    one_side = rng.random() < 0.3
    curved = float(rng.choice((0.0, 0.5, 1.0)))
    for _ in range(count):
        length = 10.0 ** rng.uniform(shortest, longest)
        side = float(rng.choice((1.0, -1.0))) if rng.random() < curved else 0.0
        bend = side / (length * 10.0 ** rng.uniform(-0.7, 2.0))
        turn = float(rng.choice(turns)) * (1.0 if one_side else float(rng.choice((-1.0, 1.0))))
        path.go(turn, bend, length, flags=STOP if stops else 0)
    prepare(path.state)
    start_path(path.state.paths, 0)
    return path


# Two corners within a cycle, a corner beside a short element and a smooth joint, and one between arcs.
@pytest.mark.parametrize(
    ("seed", "tolerance"),
    [(437, 0.0), (637, math.inf), (651, 0.01), (1144, math.inf), (1589, 0.01)],
)
def test_corners_closer_than_a_cycle_share_it(seed: int, tolerance: float) -> None:
    path = short_chain(seed, tolerance)
    run_recorded(path.state)
    assert max(overload(path.state)) <= 1.0 + 1e-6


@pytest.mark.parametrize(("jerk", "depth"), [(0.0, 0), (1e5, 2)])
@pytest.mark.parametrize("tolerance", [0.0, 0.01, math.inf])
def test_short_chains_keep_the_limits(tolerance: float, jerk: float, depth: int) -> None:
    for seed in seeds(0, 30):
        path = short_chain(seed, tolerance, jerk=jerk, depth=depth)
        run_recorded(path.state)
        assert max(overload(path.state)) <= 1.0 + 1e-6, f"seed {seed}"


def test_what_corners_hold_back_costs_no_more_than_its_root() -> None:
    """A line from rest to rest with 1 - s of its acceleration takes 1 / sqrt(1 - s) of the time at most."""
    for seed in [*seeds(0, 20), 169, 1085, 1119]:
        own, stop = (
            skip(path.state, 0, int(path.state.paths.row[0]["tail"]))
            for path in (short_chain(seed, 0.01, last=0.0, stops=stops) for stops in (False, True))
        )
        assert own <= stop / math.sqrt(0.9) + 1, f"seed {seed}"


def test_there_is_no_room_beside_a_line_of_next_to_no_length() -> None:
    path = chain(math.inf)
    row = path.state.paths.row[0]
    row["corner_rule"], row["corner_cycle_s"], row["corner_share"] = BY_SHARE, CYCLE_S, 0.1
    for bend in (0.0, 0.0, 0.5e6, 0.0):
        path.go(1.0, bend, 5e-7)
    assert [int(kind) for kind in path.rows()["kind"]] == [LINE, LINE, ARC, LINE]
