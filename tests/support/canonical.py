"""Canonical moves: what a program asks a machine for, in machine millimetres, whoever interpreted it.

Two lists of them are compared here; one comes from the channel queue, the other from a foreign interpreter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

from polycnc.kernel import ARC, LINE, RAPID, WAIT
from polycnc.kernel._segments import CENTER_P, CENTER_Q, SPLINE, SWEEP_RAD, WAIT_EVENT, WAIT_S
from polycnc.machine import Machine
from polycnc.nc import Channel

Point: TypeAlias = tuple[float, ...]


@dataclass(frozen=True)
class Traverse:
    """A rapid to `end` (mm, degree)."""

    end: Point


@dataclass(frozen=True)
class Feed:
    """A straight feed move to `end` at `speed` (mm/min)."""

    end: Point
    speed: float


@dataclass(frozen=True)
class Turn:
    """An arc or helix to `end` about `center` in the plane of axes `plane`; `sweep` in rad, > 0 like G3."""

    end: Point
    center: tuple[float, float]
    plane: tuple[int, int]
    sweep: float
    speed: float


@dataclass(frozen=True)
class Dwell:
    """A wait of `duration_s`."""

    duration_s: float


@dataclass(frozen=True)
class Function:
    """An auxiliary function as a program writes it: M3, S500, M6 T2."""

    word: str


Step: TypeAlias = Traverse | Feed | Turn | Dwell | Function


def queued_steps(machine: Machine, channel: Channel) -> list[Step]:
    """Read what stands in the channel queue, from the first segment to the last."""
    state = machine.state
    row = state.paths.row[channel.path]
    steps: list[Step] = []
    for count in range(int(row["head"]), int(row["tail"])):
        k = int(row["base"]) + count % int(row["capacity"])
        segment, geo = state.seg.row[k], state.seg.geo[k]
        end = tuple(float(value) for value in state.seg.end[k])
        speed = float(segment["feed_mm_s"]) * 60.0
        kind = int(segment["kind"])
        for number in range(int(segment["events"])):
            steps += functions(channel.writer.events[int(segment["event"]) + number].word)
        if kind == WAIT:
            if geo[WAIT_EVENT] >= 0:
                steps += functions(channel.writer.events[int(geo[WAIT_EVENT])].word)
            if geo[WAIT_S] > 0.0:
                steps.append(Dwell(float(geo[WAIT_S])))
        elif kind == ARC:
            p, q = (int(axis) for axis in state.seg.plane[k, :2])
            center = (float(geo[CENTER_P]), float(geo[CENTER_Q]))
            steps.append(Turn(end, center, (p, q), float(geo[SWEEP_RAD]), speed))
        elif segment["flags"] & RAPID:
            steps.append(Traverse(end))
        else:
            assert kind in (LINE, SPLINE), kind
            steps.append(Feed(end, speed))
    return steps


def functions(words: str) -> list[Step]:
    """Split the words of one event: a speed comes before its direction, a tool stays with its M6."""
    m_word, _, rest = words.partition(" ")
    if m_word in ("M2", "M30"):
        return []  # what else an end does differs
    if rest.startswith("S"):
        return [Function(rest), Function(m_word)]
    return [Function(words)]


def difference(ours: Step, theirs: Step, tolerance_mm: float) -> str:
    """Say in what two steps differ, '' if they are the same within `tolerance_mm` and 1e-6 of the speed."""
    if type(ours) is not type(theirs):
        return "another kind of step"
    if isinstance(ours, Function) or isinstance(theirs, Function):
        return "" if ours == theirs else "another function"
    if isinstance(ours, Dwell) and isinstance(theirs, Dwell):
        # A dwell is printed with four decimals.
        return "" if abs(ours.duration_s - theirs.duration_s) < 6e-5 else "another time"
    assert isinstance(ours, Traverse | Feed | Turn)
    assert isinstance(theirs, Traverse | Feed | Turn)
    if _apart(ours.end, theirs.end) > tolerance_mm:
        return f"end points {_apart(ours.end, theirs.end):.3g} mm apart"
    if isinstance(ours, Turn) and isinstance(theirs, Turn):
        if ours.plane != theirs.plane:
            return "another plane"
        if _apart(ours.center, theirs.center) > 2.0 * tolerance_mm:
            return f"centres {_apart(ours.center, theirs.center):.3g} mm apart"
        radius = math.dist([ours.end[axis] for axis in ours.plane], ours.center)
        if abs(ours.sweep - theirs.sweep) > 1e-9 + 4.0 * tolerance_mm / max(radius, tolerance_mm):
            return f"sweeps differ by {ours.sweep - theirs.sweep:.3g} rad"
    if isinstance(ours, Traverse) or isinstance(theirs, Traverse):
        return ""
    if abs(ours.speed - theirs.speed) > 1e-6 * theirs.speed + tolerance_mm:
        return f"feeds {ours.speed:.6f} and {theirs.speed:.6f} mm/min"
    return ""


def first_difference(ours: list[Step], theirs: list[Step], tolerance_mm: float) -> str:
    """Describe the first place where two lists differ; '' if they are the same."""
    for index, (one, other) in enumerate(zip(ours, theirs, strict=False)):
        what = difference(one, other, tolerance_mm)
        if what:
            return f"step {index}: {what}\n  ours   {one}\n  theirs {other}"
    if len(ours) != len(theirs):
        index = min(len(ours), len(theirs))
        longer = "ours" if len(ours) > len(theirs) else "theirs"
        return f"step {index}: only {longer} go on: {(ours + theirs if longer == 'ours' else theirs)[index]}"
    return ""


def _apart(a: Point, b: Point) -> float:
    return max(abs(x - y) for x, y in zip(a, b, strict=True))
