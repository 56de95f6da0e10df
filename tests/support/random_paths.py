"""Random paths for tests of the kernel: lines of every length, corners of every angle, arcs, waits."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

import numpy as np

from polycnc.kernel import (
    BY_SHARE,
    PATH_RESTED,
    RAPID,
    RECORDER_FULL,
    STOP,
    KernelState,
    advance,
    append_arc,
    append_line,
    append_wait,
    give_to_path,
    make_state,
    prepare_path,
    replan_path,
    start_path,
)
from support.often import share

AXES = 3
CYCLE_S = 0.001
RECORDED = 1 << 16
FEEDS = (5.0, 50.0, 200.0, 600.0, 2000.0)
TURNS = (0.0, 0.0, 1e-7, 1e-3, 0.05, 0.3, 1.5, math.pi)

# A hundred times slower: a few short paths, as scripts/mutate runs them.
INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"
FEW, SHORT = 3, 16


def seeds(first: int, behind: int) -> range:
    """Return the seeds of the paths that a test goes along."""
    return range(first, first + (min(behind - first, FEW) if INTERPRETED else share(behind - first)))


def blocks(most: int) -> int:
    """Return how many blocks such a path has at most."""
    return min(most, SHORT) if INTERPRETED else most


@dataclass(frozen=True)
class PathSettings:
    """What a path is planned with besides its geometry."""

    tolerance: float = 0.0
    jerkrel: float = 0.0
    depth: int = 0
    jerk: float = 0.0
    shares: tuple[float, float, float] | None = None  # of corners, arcs in them and last lines, see BY_SHARE
    free: bool = False  # overlaps leave tolerance and feed


def machine(rng: np.random.Generator, settings: PathSettings, segments: int = 4096) -> KernelState:
    """Return a machine with random limits of each axis, its path 0 empty and in charge of all axes."""
    state = make_state(AXES, cycle_s=CYCLE_S, segments=segments, record_cycles=RECORDED)
    state.limits.speed[:] = rng.uniform(50.0, 600.0, AXES)
    state.limits.acceleration[:] = rng.uniform(300.0, 8000.0, AXES)
    row = state.paths.row[0]
    row["tolerance_mm"], row["jerkrel"], row["depth"] = settings.tolerance, settings.jerkrel, settings.depth
    row["jerk_mm_s3"] = settings.jerk
    if settings.shares is not None:
        row["corner_rule"], row["corner_cycle_s"] = BY_SHARE, CYCLE_S
        row["corner_share"], row["rounding_share"], row["last_share"] = settings.shares
        row["free_overlaps"] = settings.free
    give_to_path(state, 0)
    return state


class PathMaker:
    """Append random segments to path 0 of a machine, one after the other."""

    def __init__(self, state: KernelState, rng: np.random.Generator, length: float | None = None) -> None:
        self.state = state
        self.rng = rng
        self.length = length  # of every line; random over six decades if None
        self.heading = float(rng.uniform(-3.0, 3.0))
        self.place = np.zeros(AXES)
        self.tag = 0

    def append(self, count: int) -> None:
        """Append `count` segments."""
        for _ in range(count):
            self.tag += 1
            self._append_one()

    def _append_one(self) -> None:
        rng, state = self.rng, self.state
        kind = int(rng.integers(0, 12))
        feed = float(rng.choice(FEEDS))
        self.heading += float(rng.choice(TURNS)) * float(rng.choice((-1.0, 1.0)))
        if kind == 0:
            self._arc(feed)
        elif kind == 1:
            append_wait(state.seg, state.paths, 0, 0.003, -1, self.tag, 0)
        else:
            length = 10.0 ** rng.uniform(-5.0, 1.5) if self.length is None else self.length
            direction = np.array(
                [math.cos(self.heading), math.sin(self.heading), float(rng.choice((0.0, 0.0, 0.3, -2.0)))]
            )
            end = self.place + direction * length
            speed, flags = (math.inf, RAPID) if kind == 2 else (feed, STOP if kind == 3 else 0)
            if append_line(state.seg, state.paths, 0, state.limits, end, speed, flags, self.tag):
                self.place = end

    def _arc(self, feed: float) -> None:
        """Append an arc that leaves in the present direction; some end a little off their circle."""
        rng, state = self.rng, self.state
        side = float(rng.choice((-1.0, 1.0)))
        radius = 10.0 ** rng.uniform(-1.5, 1.5)
        sweep = side * float(rng.uniform(0.05, 6.0))
        center = self.place[:2] + radius * side * np.array([-math.sin(self.heading), math.cos(self.heading)])
        angle = math.atan2(self.place[1] - center[1], self.place[0] - center[0]) + sweep
        off = float(rng.choice((0.0, 0.0, 1.0)) * rng.uniform(-1.0, 1.0)) * min(0.005, radius * 0.001)
        end = self.place.copy()
        end[:2] = center + (radius + off) * np.array([math.cos(angle), math.sin(angle)])
        end[2] += float(rng.choice((0.0, rng.normal() * 5.0)))
        append_arc(
            state.seg, state.paths, 0, state.limits, end, 0, 1, center[0], center[1], sweep, feed, 0, self.tag
        )
        self.place, self.heading = end, self.heading + sweep


def prepare(state: KernelState, *, closed: bool = True) -> None:
    """Take what was appended into the look-ahead."""
    state.paths.row[0]["closed"] = closed
    prepare_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)


def stop_everywhere(state: KernelState) -> None:
    """Let path 0 come to rest at the end of every block that was appended, as G61 does."""
    tail = int(state.paths.row[0]["tail"])
    tags = state.seg.row["tag"][:tail]
    ends = np.append(tags[1:] != tags[:-1], True)  # a spline is several segments
    state.seg.row["flags"][:tail][ends] |= STOP


def random_path(
    seed: int,
    settings: PathSettings,
    length: float | None = None,
    *,
    stops: bool = False,
    most: int = 300,
) -> KernelState:
    """Return a machine with a complete random path of up to `most` blocks, planned and ready to start.

    With `stops` it comes to rest at every block.
    """
    rng = np.random.default_rng(seed)
    state = machine(rng, settings)
    PathMaker(state, rng, length).append(int(rng.integers(2, blocks(most))))
    if stops:
        stop_everywhere(state)
    prepare(state)
    start_path(state.paths, 0)
    return state


def is_done(state: KernelState) -> bool:
    """Tell whether path 0 has been traversed to its end."""
    return bool(state.paths.row[0]["head"] >= state.paths.row[0]["tail"])


def run_recorded(state: KernelState) -> int:
    """Run every cycle until the path ends or the recorder is full; return the cycles."""
    state.clock[0]["mask"] = RECORDER_FULL | PATH_RESTED
    cycles = 0
    while not is_done(state) and state.recorder.filled[0] < RECORDED:
        cycles += advance(state, RECORDED)
    return cycles


def replan(state: KernelState) -> None:
    """Let what was changed of path 0 act on what is ahead."""
    replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)


def run_with_changes(rng: np.random.Generator, settings: PathSettings, *, late: bool = True) -> KernelState:
    """Return a machine that has traversed a random path with overrides and holds; its blocks came late, or at once."""
    state = machine(rng, settings)
    maker = PathMaker(state, rng, None if rng.random() < 0.3 else 10.0 ** rng.uniform(-4.0, 1.0))
    left = int(rng.integers(2, blocks(200)))
    row = state.paths.row[0]
    state.clock[0]["mask"] = RECORDER_FULL
    start_path(state.paths, 0)
    for step in range(60):
        piece = min(left, int(rng.integers(0, 20))) if late else left * (step == 0)
        maker.append(piece)
        left -= piece
        prepare(state, closed=left == 0)
        if rng.random() < 0.7:
            row["override"] = rng.choice((0.0, 0.05, 0.5, 1.0, 1.3, 2.0))
            row["hold"] = rng.choice((0, 0, 1))
            replan(state)
        advance(state, int(rng.integers(1, rng.choice((5, 50, 300)))))
    maker.append(left)
    prepare(state)
    row["hold"], row["override"] = 0, 1.0
    replan(state)
    run_recorded(state)
    return state


def overload(state: KernelState) -> tuple[float, float]:
    """Return the greatest speed and acceleration of any axis in any recorded cycle, as parts of limits."""
    rows = state.recorder.rows[: int(state.recorder.filled[0])]
    positions = np.concatenate([np.zeros((2, AXES)), rows[:, 4 : 4 + AXES]])
    speed = np.diff(positions, axis=0) / CYCLE_S
    acceleration = np.diff(speed, axis=0) / CYCLE_S
    return (
        float(np.max(np.abs(speed) / state.limits.speed)),
        float(np.max(np.abs(acceleration) / state.limits.acceleration)),
    )
