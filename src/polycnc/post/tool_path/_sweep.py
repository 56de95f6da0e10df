"""What a tool path means: the moves that the tool shall make, whatever control makes them.

Verification holds a program against these, so nothing here depends on a control file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from polycnc.post.tool_path._course import Course, CourseError, Hole, Straight
from polycnc.post.tool_path._cycles import hole_steps, without_pecks
from polycnc.post.tool_path._records import UPRIGHT, Record, Vector


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


def sweep_tool_path(records: Iterable[Record]) -> Iterator[Sweep]:
    """Yield the moves of a tool path; pecks of a hole are one feed to its bottom.

    Raises:
        ProgramError: a record comes to no move.
    """
    course = Course()
    for number, record in enumerate(records):
        try:
            act = course.take(record)
        except CourseError as error:
            raise error.as_error() from None
        if act is None:
            continue
        if isinstance(act, Straight):
            line, start, end, axis, rapid = act
            yield Sweep(number, line, rapid, start, end, axis=axis)
        elif isinstance(act, Hole):
            yield from _hole(act, number)
        else:
            line, start, end, axis, center, normal, angle = act
            yield Sweep(number, line, False, start, end, center, normal, angle, axis)


def _hole(hole: Hole, number: int) -> Iterator[Sweep]:
    here = hole.start
    for step in hole_steps(without_pecks(hole.cycle), hole.point, hole.axis, here, hole.levels, 0.0, 0.0):
        if step.kind in ("rapid", "feed") and step.point != here:
            yield Sweep(number, hole.line, step.kind == "rapid", here, step.point, axis=hole.axis)
            here = step.point
