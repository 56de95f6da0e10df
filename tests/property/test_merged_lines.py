"""Short lines become one while all that is left out lies within a distance: against a plain reading of that rule."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import polycnc
from polycnc.kernel import (
    NOT_MERGED,
    NOT_SMALL,
    RAPID,
    STOP,
    KernelState,
    append_line,
    append_small_arc,
    close_line,
    drop_queue,
    make_state,
    merge_line,
    prepare_path,
)
from polycnc.kernel._path import MOST_MERGED
from polycnc.kernel._segments import ARC, LINE
from support.often import often
from support.programs import prepare
from support.runs import program_run

Floats = npt.NDArray[np.float64]
MERGE_MM = 0.03


def off_line(point: Floats, start: Floats, end: Floats) -> float:
    """Return the distance of a point from a line with ends."""
    way = end - start
    along = np.clip(np.dot(point - start, way) / np.dot(way, way), 0.0, 1.0)
    return float(np.linalg.norm(point - start - along * way))


def kept(points: Floats, most_mm: float) -> list[int]:
    """Return the numbers of the points that stay: each line as long as the rule allows, begun at `points[0]`."""
    found = [0]
    for number in range(2, len(points)):
        begin = found[-1]
        between = points[begin + 1 : number]
        closed = np.array_equal(points[number], points[begin])
        if closed or len(between) > MOST_MERGED - 1 or len(between) == 0:
            fits = len(between) == 0
        else:
            fits = max(off_line(point, points[begin], points[number]) for point in between) <= most_mm
        if not fits:
            found.append(number - 1)
    return [*found, len(points) - 1]


def track(rng: np.random.Generator, count: int) -> Floats:
    """Return points of a curve that winds, from the origin, with some that lie on one another's line."""
    heading = np.cumsum(rng.normal(size=count) * rng.choice([0.0, 0.03, 0.4]))
    steps = np.stack([np.cos(heading), np.sin(heading), 0.3 * np.sin(2.0 * heading)], axis=1)
    points = np.cumsum(steps * rng.uniform(0.01, 0.7, (count, 1)), axis=0)
    return np.vstack([np.zeros(3), points])


def give(state: KernelState, point: Floats, feed: float = 50.0, flags: int = 0, tag: int = 1) -> bool:
    """Give a line as a channel does; tell whether it has joined the last one."""
    if merge_line(state.seg, state.paths, 0, state.limits, point, feed, flags, tag) >= 0:
        return True
    append_line(state.seg, state.paths, 0, state.limits, point, feed, flags, tag)
    return False


def queue(merge_mm: float, tolerance_mm: float = 0.01) -> KernelState:
    state = make_state(3, segments=4096)
    state.paths.row["merge_mm"] = merge_mm
    state.paths.row["tolerance_mm"] = tolerance_mm
    return state


def lines(state: KernelState) -> Floats:
    """Return where the queued lines begin and end, [lines, 2, 3]."""
    tail = int(state.paths.row[0]["tail"])
    found = state.seg.row["kind"][:tail] == LINE
    return np.stack([state.seg.start[:tail][found], state.seg.end[:tail][found]], axis=1)


@pytest.mark.parametrize("seed", often(range(60), 25))
def test_every_point_lies_within_the_distance_and_lines_are_as_long_as_that_allows(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = track(rng, int(rng.integers(2, 400)))
    merge_mm = float(rng.choice([0.002, MERGE_MM, 0.4]))
    state = queue(merge_mm, tolerance_mm=1e-9)  # corners stay where they are, so that the ends can be told
    for point in points[1:]:
        give(state, point)
    close_line(state.seg, state.paths, 0, state.limits)
    stay = kept(points, merge_mm)
    ends = lines(state)[:, 1]
    assert np.allclose(ends, points[stay[1:]], atol=1e-6)
    for begin, end in pairwise(stay):
        for point in points[begin + 1 : end]:
            assert off_line(point, points[begin], points[end]) <= merge_mm * (1.0 + 1e-12)


@pytest.mark.parametrize("seed", range(25))
def test_corners_are_rounded_as_if_the_merged_lines_had_been_given(seed: int) -> None:
    rng = np.random.default_rng(1000 + seed)
    points = track(rng, 150)
    merged, given = queue(MERGE_MM, 0.05), queue(0.0, 0.05)
    for point in points[1:]:
        give(merged, point)
    for number in kept(points, MERGE_MM)[1:]:
        give(given, points[number])
    for state in (merged, given):
        state.paths.row[0]["closed"] = 1
        prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    assert merged.paths.row[0]["prepared"] == merged.paths.row[0]["tail"] == given.paths.row[0]["tail"]
    assert merged.seg.row.tobytes() == given.seg.row.tobytes()
    assert merged.seg.end.tobytes() == given.seg.end.tobytes()
    assert merged.seg.geo.tobytes() == given.seg.geo.tobytes()


STRAIGHT = [np.array([0.4 * n, 0.1 * n, 0.0]) for n in range(1, 6)]


@pytest.mark.parametrize(
    ("feed", "flags", "merge_mm", "joins"),
    [
        pytest.param(50.0, 0, MERGE_MM, True, id="as the line before"),
        pytest.param(51.0, 0, MERGE_MM, False, id="another feed"),
        pytest.param(math.inf, RAPID, MERGE_MM, False, id="positioning"),
        pytest.param(50.0, STOP, MERGE_MM, False, id="exact stop"),
        pytest.param(50.0, 0, 0.0, False, id="no merging"),
    ],
)
def test_what_joins_a_line(feed: float, flags: int, merge_mm: float, joins: bool) -> None:
    state = queue(merge_mm)
    assert not give(state, STRAIGHT[0])
    assert give(state, STRAIGHT[1], feed, flags) is joins
    assert len(lines(state)) == (1 if joins else 2)


def test_another_axis_that_moves_keeps_its_points() -> None:
    state = make_state(4, segments=64)
    state.limits.feed_axis[3] = 0
    state.paths.row["merge_mm"], state.paths.row["tolerance_mm"] = MERGE_MM, 0.01
    joined = [
        give(state, np.array([0.7 * n, 0.0, 0.0, turn])) for n, turn in enumerate((0, 0, 5, 9, 9, 9), start=1)
    ]
    assert joined == [False, True, False, False, False, True]


def test_a_line_that_may_grow_and_the_one_before_it_wait() -> None:
    state = queue(MERGE_MM)

    def prepared() -> int:
        prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
        return int(state.paths.row[0]["prepared"])

    give(state, np.array([7.0, 0.0, 0.0]))
    assert prepared() == 0
    give(state, np.array([7.0, 3.0, 0.0]))
    give(state, np.array([7.0, 6.0, 0.0]))
    assert prepared() == 0  # the corner between them is still open
    give(state, np.array([2.0, 6.0, 0.0]))
    assert prepared() == 2  # the line up to the first corner and the arc in it
    assert not give(state, np.array([2.0, 6.5, 0.0]))
    state.paths.row[0]["closed"] = 1
    assert prepared() == state.paths.row[0]["tail"] == 7
    assert not give(state, np.array([2.0, 7.0, 0.0])), "what has been planned stays"


def test_a_dropped_queue_takes_nothing_into_lines_that_are_gone() -> None:
    state = queue(MERGE_MM)
    give(state, STRAIGHT[0])
    drop_queue(state.seg, state.paths, 0)
    assert not give(state, STRAIGHT[1])


# ------------------------------------------------------------------ small arcs


def give_arc(state: KernelState, to: float, radius: float, rise: float = 0.0, **other: int) -> int:
    """Give an arc from the end of the queue to a point beyond it in X, half a turn or less, as a channel does."""
    start = state.paths.queued[0].copy()
    half = 0.5 * (to - start[0])
    angle = math.asin(min(1.0, half / radius))
    end = start + [2.0 * half, 0.0, rise, *np.zeros(len(start) - 3)]
    center = start[1] - radius * math.cos(angle)
    axes = other.get("p", 0), other.get("q", 1)
    found = append_small_arc(
        *(state.seg, state.paths, 0, state.limits, end, *axes, start[0] + half, center),
        *(-2.0 * angle, 50.0, other.get("flags", 0), other.get("tag", 7)),
    )
    return int(found)


@pytest.mark.parametrize("radius", [0.01, 0.025, 0.4])
def test_small_arcs_merge_and_the_line_stays_near_all_of_them(radius: float) -> None:
    state = queue(MERGE_MM, 1e-9)
    give(state, np.array([0.7, 0.0, 0.0]))
    half = min(radius, 0.1)
    arcs: list[Floats] = []
    for _ in range(40):
        start = state.paths.queued[0].copy()
        give_arc(state, float(start[0]) + 2.0 * half, radius, 0.001)
        turn = np.linspace(-1.0, 1.0, 30) * math.asin(half / radius)
        x, y = radius * np.sin(turn) + start[0] + half, radius * (np.cos(turn) - math.cos(turn[0])) + start[1]
        arcs.append(np.stack([x, y, np.linspace(start[2], start[2] + 0.001, 30)], axis=1))
        give(state, state.paths.queued[0] + [0.3, 0.0, 0.0])
    close_line(state.seg, state.paths, 0, state.limits)
    ends = lines(state)
    assert 1 <= len(ends) < 12, "each line takes the place of several arcs"
    for point in np.concatenate(arcs):
        assert min(off_line(point, *pair) for pair in ends) <= MERGE_MM * (1.0 + 1e-9)


@pytest.mark.parametrize(
    ("radius", "other", "axes"),
    [
        pytest.param(0.0305, {}, 3, id="bends by as much"),
        pytest.param(0.01, {"p": 1, "q": 2}, 3, id="another plane"),
        pytest.param(0.01, {"flags": STOP}, 3, id="exact stop"),
        pytest.param(0.01, {}, 2, id="no third axis"),
    ],
)
def test_arcs_that_stay_arcs(radius: float, other: dict[str, int], axes: int) -> None:
    state = make_state(axes, segments=64) if axes != 3 else queue(MERGE_MM)
    state.paths.row["merge_mm"], state.paths.row["tolerance_mm"] = MERGE_MM, 0.01
    if axes == 3:
        assert give_arc(state, 2.0 * radius, radius, **other) == NOT_SMALL
    else:
        end = np.array([2.0 * radius, 0.0])
        args = (state.seg, state.paths, 0, state.limits, end, 0, 1, radius, 0.0, -math.pi, 50.0, 0, 7)
        assert append_small_arc(*args) == NOT_SMALL
    assert state.paths.row[0]["tail"] == 0


def test_a_small_arc_tells_which_block_it_has_joined() -> None:
    state = queue(MERGE_MM)
    give(state, np.array([0.7, 0.0, 0.0]), tag=5)
    assert give_arc(state, 0.71, 0.01) == 5
    assert state.seg.row["tag"][0] == 7
    assert give_arc(state, 0.76, 0.05, tag=8, rise=9.0) == NOT_MERGED  # it climbs: a line of its own
    assert len(lines(state)) == 2


# ------------------------------------------------------------------ programs

RULES = {
    "G64 P0.03": MERGE_MM,
    "G64 P0.2 Q0.03": MERGE_MM,
    "G64 P0.03 Q0": 0.0,
    "G64 Q0.03": MERGE_MM,
    "G64": 0.0,
    "G64 P0": 0.0,
    "G61": 0.0,
}


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("ordinary_blocks", [3, math.inf])
def test_the_rule_in_force_decides(rule: str, ordinary_blocks: float) -> None:
    blocks = [f"G1 X{0.5 * n:.3f} Y{0.02 * (n % 2):.3f}\n" for n in range(1, 40)]
    program = f"G21 F2400 {rule}\n" + "".join(blocks) + "G2 X30 Y9 R40\nM30\n"
    channel = prepare(program, dialect="linuxcnc", ordinary_blocks=ordinary_blocks)
    found = channel.machine.state.seg.row["kind"][: int(channel.machine.state.paths.row[0]["tail"])] == LINE
    assert np.count_nonzero(found) == (1 if RULES[rule] else 39)


@pytest.mark.parametrize("ordinary_blocks", [3, math.inf])
def test_small_arcs_of_a_program_join_the_lines_beside_them(ordinary_blocks: float) -> None:
    blocks = "".join(f"G1 X{0.52 * n + 0.5:.2f}\nG3 X{0.52 * n + 0.52:.2f} Y0 I0.01 J0\n" for n in range(8))
    for plane, found in (("", [LINE]), ("G18", [LINE, ARC])):
        program = f"G21 F2400 G64 P0.03 {plane}\n" + blocks.replace("J0", "K0" if plane else "J0") + "M30\n"
        channel = prepare(program, dialect="linuxcnc", ordinary_blocks=ordinary_blocks, marks=True)
        kinds = channel.machine.state.seg.row["kind"][: int(channel.machine.state.paths.row[0]["tail"])]
        assert sorted(set(kinds) & {LINE, ARC}) == found
        if not plane:
            assert np.count_nonzero(kinds == LINE) == 1
            assert channel.writer.marks is not None
            assert len(channel.writer.marks) == 16  # the first block, and all but the last have joined it
        else:
            assert np.count_nonzero(kinds == LINE) >= 8


def test_q_of_a_program_in_inches_is_in_inches_and_not_negative(tmp_path: Path) -> None:
    channel = prepare("G20 G64 P0.1 Q0.01\nG1 X1 F60\nM30\n", dialect="linuxcnc")
    assert channel.machine.state.paths.row[0]["merge_mm"] == pytest.approx(0.254, rel=1e-15)
    part = tmp_path / "part.ngc"
    part.write_text("G64 P0.1 Q-0.2\nM30\n", encoding="utf-8")
    with pytest.raises(polycnc.ProgramError, match="merging tolerance Q is negative"):
        polycnc.run(part, dialect="linuxcnc")


def test_a_merged_line_counts_as_the_last_of_its_blocks() -> None:
    blocks = "".join(f"X{4 * n} Y{0.01 * (n % 2)}\n" for n in range(1, 9))
    run = program_run("G64 P0.02 G1 F3000\n" + blocks + "Y7\nX2\nM30\n", dialect="linuxcnc")
    run.start()
    seen: list[int] = []
    while run.active:
        run.advance(1)
        if run.reading.block is not None and run.reading.block.line not in seen[-1:]:
            seen.append(run.reading.block.line)
    assert seen == [9, 10, 11, 12]  # the line of eight blocks counts as the last of them
