"""What a tool path means: the moves that the tool shall make, whatever control makes them.

Verification holds a program against these, so nothing here depends on a control file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.post.tool_path._course import Course, CourseError, Hole, Straight
from polycnc.post.tool_path._cycles import hole_steps, without_pecks
from polycnc.post.tool_path._records import UPRIGHT, Goto, Points, Record, Vector


class Sweep(NamedTuple):
    """One move: straight if `angle` is 0, else turning by `angle` rad about `normal` through `center`.

    `record` counts the records of the tool path from 0; `start` is None where it is not known; `axis` is the tool
    axis at the end.
    """

    record: int
    line: int
    rapid: bool
    start: Vector | None
    end: Vector
    center: Vector = (0.0, 0.0, 0.0)
    normal: Vector = UPRIGHT
    angle: float = 0.0
    axis: Vector = UPRIGHT


class Ways(NamedTuple):
    """Straight moves with the feed, one after the other from `start`: to the rows of `ends`, [moves, 3] in mm.

    The first is of `record` on `line`, and each further one of the next record on the next line.
    """

    record: int
    line: int
    start: Vector
    ends: npt.NDArray[np.float64]
    axis: Vector


def sweep_tool_path(records: Iterable[Record | Points]) -> Iterator[Sweep]:
    """Yield the moves of a tool path; pecks of a hole are one feed to its bottom.

    Raises:
        ProgramError: a record comes to no move.
    """
    for sweep in sweep_in_runs(records):
        if isinstance(sweep, Sweep):
            yield sweep
            continue
        start = sweep.start
        for place, (x, y, z) in enumerate(sweep.ends.tolist()):
            yield Sweep(sweep.record + place, sweep.line + place, False, start, (x, y, z), axis=sweep.axis)
            start = x, y, z


def sweep_in_runs(records: Iterable[Record | Points]) -> Iterator[Sweep | Ways]:
    """Yield the moves of a tool path as `sweep_tool_path` does, many at once where points lie one after another.

    Raises:
        ProgramError: a record comes to no move.
    """
    course = Course()
    number = 0
    for record in records:
        if isinstance(record, Points):
            yield from _points(course, record, number)
            number += len(record.xyz)
        else:
            yield from _record(course, record, number)
            number += 1


def _points(course: Course, record: Points, number: int) -> Iterator[Sweep | Ways]:
    line, xyz = record
    for place in range(len(xyz)):
        x, y, z = xyz[place].tolist()
        if course.here is not None and course.is_plain:
            yield Ways(number + place, line + place, course.here, xyz[place:], course.axis)
            x, y, z = xyz[-1].tolist()
            course.here = x, y, z
            return
        yield from _record(course, Goto(line + place, x, y, z), number + place)


def _record(course: Course, record: Record, number: int) -> Iterator[Sweep]:
    try:
        act = course.take(record)
    except CourseError as error:
        raise error.as_error() from None
    if isinstance(act, Straight):
        line, start, end, axis, rapid = act
        yield Sweep(number, line, rapid, start, end, axis=axis)
    elif isinstance(act, Hole):
        yield from _hole(act, number)
    elif act is not None:
        line, start, end, axis, center, normal, angle = act
        yield Sweep(number, line, False, start, end, center, normal, angle, axis)


def _hole(hole: Hole, number: int) -> Iterator[Sweep]:
    here = hole.start
    for step in hole_steps(without_pecks(hole.cycle), hole.point, hole.axis, here, hole.levels, 0.0, 0.0):
        if step.kind in ("rapid", "feed") and step.point != here:
            yield Sweep(number, hole.line, step.kind == "rapid", here, step.point, axis=hole.axis)
            here = step.point
