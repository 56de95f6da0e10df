"""Tool paths of turning in another plane: NX writes lathe parts in XY, with the spindle's axis along X."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from polycnc.errors import ProgramError
from polycnc.post.tool_path._records import (
    Circle,
    Delta,
    From,
    Goto,
    Home,
    Points,
    Record,
    Retract,
    Vector,
)
from polycnc.post.tool_path._source import Remarks, Source

Reader = Callable[[Source, Remarks], Iterator[Record | Points]]


def turned_from_xy(read: Reader) -> Reader:
    """Return a reader of the same path as a lathe's: its X becomes Z, its Y the radius X, its Z becomes Y.

    Tool axes stay as they are.

    Raises:
        ProgramError: on reading, a retract to a level, which says nothing about a lathe.
    """

    def turned(source: Source, remarks: Remarks) -> Iterator[Record | Points]:
        for record in read(source, remarks):
            yield _turned(record, source)

    return turned


def _turned(record: Record | Points, source: Source) -> Record | Points:
    match record:
        case From() | Goto():
            return record._replace(x=record.y, y=record.z, z=record.x)
        case Points():
            return record._replace(xyz=record.xyz[:, [1, 2, 0]])
        case Delta():
            return record if record.along_axis else record._replace(x=record.y, y=record.z, z=record.x)
        case Circle():
            return record._replace(
                x=record.y,
                y=record.z,
                z=record.x,
                center=_around(record.center),
                normal=_around(record.normal),
            )
        case Home():
            return record if record.point is None else record._replace(point=_around(record.point))
        case Retract():
            raise ProgramError(
                "a retract to a level in a turning path in XY",
                position=source.position(record.line),
                hint="Write a rapid to a point instead.",
            )
        case _:
            return record


def _around(vector: Vector) -> Vector:
    x, y, z = vector
    return y, z, x
