"""What a tool path means: the moves that the tool shall make, whatever control makes them.

Verification holds a program against these, so nothing here depends on a control file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from polycnc.post.tool_path._arcs import TWO_PI, sweep_of
from polycnc.post.tool_path._cycles import hole_steps, level_of, levels_of, without_pecks
from polycnc.post.tool_path._records import (
    UPRIGHT,
    Circle,
    Cycle,
    CycleOff,
    Delta,
    From,
    Goto,
    Home,
    Rapid,
    Record,
    Tool,
    Vector,
)


class Sweep(NamedTuple):
    """One move: straight if `angle` is 0, else turning by `angle` rad about `normal` through `center`.

    `record` counts the records of the tool path from 0; `start` is None where it is not known.
    """

    record: int
    line: int
    rapid: bool
    start: Vector | None
    end: Vector
    center: Vector = (0.0, 0.0, 0.0)
    normal: Vector = UPRIGHT
    angle: float = 0.0


class _State:
    def __init__(self) -> None:
        self.here: Vector | None = None
        self.home: Vector | None = None
        self.axis: Vector = UPRIGHT
        self.rapid = False
        self.cycle: Cycle | None = None
        self.last: Cycle | None = None
        self.initial: Vector | None = None


def sweep_tool_path(records: Iterable[Record]) -> Iterator[Sweep]:
    """Yield the moves of a tool path; pecks of a hole are one feed to its bottom."""
    state = _State()
    for number, record in enumerate(records):
        match record:
            case Goto():
                yield from _point(state, number, record.line, (record.x, record.y, record.z), record.axis)
            case Rapid():
                state.rapid = True
            case Circle():
                yield _circle(state, number, record)
            case Delta() if state.here is not None:
                yield from _point(state, number, record.line, _behind(state, state.here, record), None)
            case Home() if state.home is not None:
                state.cycle, state.rapid = None, True
                yield from _point(state, number, record.line, state.home, None)
            case From():
                state.here = state.home = (record.x, record.y, record.z)
                state.axis = record.axis or state.axis
            case Cycle():
                state.cycle = state.last = record
                state.initial = state.here
            case CycleOff(on=on):
                state.cycle = state.last if on else None
                state.initial = state.here
            case Tool():
                state.cycle = None
            case _:
                pass


def _point(state: _State, number: int, line: int, point: Vector, axis: Vector | None) -> Iterator[Sweep]:
    state.axis = axis or state.axis
    rapid, state.rapid = state.rapid, False
    if state.cycle is not None:
        yield from _hole(state, state.cycle, number, line, point)
        return
    yield Sweep(number, line, rapid, state.here, point)
    state.here = point


def _hole(state: _State, cycle: Cycle, number: int, line: int, point: Vector) -> Iterator[Sweep]:
    here, axis = state.here, state.axis
    initial = level_of(state.initial, point, axis)
    levels = levels_of(cycle, level_of(here, point, axis), initial)
    for step in hole_steps(without_pecks(cycle), point, axis, here, levels, 0.0, 0.0):
        if step.kind in ("rapid", "feed") and step.point != state.here:
            yield Sweep(number, line, step.kind == "rapid", state.here, step.point)
            state.here = step.point


def _circle(state: _State, number: int, record: Circle) -> Sweep:
    end = (record.x, record.y, record.z)
    state.rapid = False
    start = state.here or end
    angle = sweep_of(start, end, record.center, record.normal) + TWO_PI * (record.turns - 1)
    state.here = end
    return Sweep(number, record.line, False, start, end, record.center, record.normal, angle)


def _behind(state: _State, here: Vector, record: Delta) -> Vector:
    if record.along_axis:
        i, j, k = state.axis
        return here[0] + i * record.x, here[1] + j * record.x, here[2] + k * record.x
    return here[0] + record.x, here[1] + record.y, here[2] + record.z
