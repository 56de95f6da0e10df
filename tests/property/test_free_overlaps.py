"""Motions that overlap as freely as LinuxCNC's: the same pieces however blocks come, within the limits of the axes."""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel import (
    RECORDER_FULL,
    STOP,
    KernelState,
    advance,
    append_arc,
    append_line,
    append_wait,
    start_path,
)
from polycnc.kernel._segments import OVERLAP
from support.random_paths import (
    FEEDS,
    PathMaker,
    PathSettings,
    machine,
    overload,
    prepare,
    replan,
    run_recorded,
    seeds,
)

ROUNDING = 1.0 + 1e-6
PLANES = ((0, 1, 2), (0, 1, 2), (2, 0, 1), (1, 2, 0))


class Helices(PathMaker):
    """Append lines at any angle, and as many arcs and helices in all planes, with a wait now and then."""

    def _append_one(self) -> None:
        rng, state = self.rng, self.state
        feed, kind = float(rng.choice(FEEDS)), rng.random()
        if kind < 0.04:
            append_wait(state.seg, state.paths, 0, 0.003, -1, self.tag, 0)
        elif kind < 0.5:
            way = rng.normal(size=3) * rng.choice([1.0, 1.0, 0.0], size=3)
            end = self.place + way / max(float(np.linalg.norm(way)), 1e-9) * 10.0 ** rng.uniform(-2.0, 1.3)
            flags = STOP if rng.random() < 0.05 else 0
            append_line(state.seg, state.paths, 0, state.limits, end, feed, flags, self.tag)
            self.place = end
        else:
            self._turn(feed)

    def _turn(self, feed: float) -> None:
        rng, state = self.rng, self.state
        p, q, other = PLANES[int(rng.integers(4))]
        radius, angle = 10.0 ** rng.uniform(-1.5, 1.2), float(rng.uniform(-3.0, 3.0))
        sweep = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 6.0))
        center = self.place[[p, q]] - radius * np.array([math.cos(angle), math.sin(angle)])
        end = self.place.copy()
        end[[p, q]] = center + radius * np.array([math.cos(angle + sweep), math.sin(angle + sweep)])
        end[other] += float(rng.choice([0.0, rng.normal() * radius, rng.normal() * 5.0]))
        where = (p, q, center[0], center[1], sweep)
        append_arc(state.seg, state.paths, 0, state.limits, end, *where, feed, 0, self.tag)
        self.place = end


def rules(seed: int) -> PathSettings:
    rng = np.random.default_rng(10**6 + seed)
    corner, rounding = float(rng.choice([0.1, 0.02, 0.4])), float(rng.choice([0.5, 0.2]))
    return PathSettings(
        tolerance=float(rng.choice([0.02, 0.2, math.inf])),
        shares=(corner, rounding, 0.5),
        depth=int(rng.choice([0, 0, 2, 3, 16])),
        free=True,
    )


def queued(seed: int, at_once: int) -> KernelState:
    """Return a path of which so many blocks come before it is planned each time."""
    rng = np.random.default_rng(seed)
    state = machine(rng, rules(seed))
    maker = Helices(state, rng)
    left = int(rng.integers(2, 30))
    while left > 0:
        maker.append(min(at_once, left))
        left -= at_once
        prepare(state, closed=left <= 0)
    return state


def test_pieces_are_the_same_however_many_blocks_come_at_once_and_axes_keep_their_limits() -> None:
    overlaps = 0
    for seed in seeds(0, 60):
        state, one_by_one, by_threes = (queued(seed, at_once) for at_once in (10**6, 1, 3))
        tail = int(state.paths.row[0]["tail"])
        rows = state.seg.row[:tail]
        overlaps += int(np.sum(rows["kind"] == OVERLAP))
        for other in (one_by_one, by_threes):
            assert other.paths.row[0]["tail"] == tail, f"seed {seed}"
            assert np.array_equal(other.seg.start[:tail], state.seg.start[:tail]), f"seed {seed}"
            for column in ("length", "feed_mm_s", "cap", "junction", "accel"):
                assert np.array_equal(other.seg.row[column][:tail], rows[column]), f"seed {seed}: {column}"
        start_path(state.paths, 0)
        run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"
    assert overlaps > 0


def test_late_blocks_overrides_and_holds_break_no_limit() -> None:
    for seed in seeds(0, 60):
        rng = np.random.default_rng(seed)
        state = machine(rng, rules(seed))
        maker, row = Helices(state, rng), state.paths.row[0]
        left = int(rng.integers(2, 40))
        state.clock[0]["mask"] = RECORDER_FULL
        start_path(state.paths, 0)
        for _ in range(30):
            piece = min(left, int(rng.integers(0, 8)))
            maker.append(piece)
            left -= piece
            prepare(state, closed=left == 0)
            row["override"], row["hold"] = rng.choice((0.0, 0.05, 0.5, 1.0, 1.3, 2.0)), rng.choice((0, 0, 1))
            replan(state)
            advance(state, int(rng.integers(1, rng.choice((5, 50, 300)))))
        maker.append(left)
        row["hold"], row["override"] = 0, 1.0
        prepare(state)
        replan(state)
        run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"
