"""Tool paths in JSON: an object with `units`, `part` and `path`, a list of objects that say what to do.

Each kind of object is a model below; the names are those of the reference.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError

from polycnc.errors import ProgramError
from polycnc.machine import MOST_NESTING, StrictModel, is_nested_beyond
from polycnc.post.tool_path import _records as records
from polycnc.post.tool_path._arcs import dot, off_circle
from polycnc.post.tool_path._records import LARGEST_MM, MOST_TURNS, Record
from polycnc.post.tool_path._source import Remarks, Source
from polycnc.units import MM_PER_INCH

Coordinate = Annotated[float, Field(ge=-LARGEST_MM, le=LARGEST_MM)]
Triple: TypeAlias = tuple[Coordinate, Coordinate, Coordinate]
Length = Annotated[float, Field(gt=0, le=LARGEST_MM)]


class DoPath(StrictModel):
    """Begin an operation."""

    do: Literal["operation"]
    name: str = Field(description="Its name.")
    work_offset: Annotated[int, Field(ge=1, le=999)] | None = Field(
        default=None, description="Number of its work offset; absent: as before, at first 1."
    )

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Path(line, self.name, self.work_offset)


class DoTool(StrictModel):
    """Change the tool."""

    do: Literal["tool"]
    number: Annotated[int, Field(ge=0)] = Field(description="Its number.")
    name: str = Field(default="", description="Its name.")
    diameter: Length | None = Field(default=None, description="Its diameter.")
    length: Length | None = Field(default=None, description="Its length.")
    h: int | None = Field(default=None, description="Number of the length offset; absent: the tool's.")
    d: int | None = Field(default=None, description="Number of the radius offset; absent: the tool's.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        size = self.diameter and self.diameter * scale
        length = self.length and self.length * scale
        yield records.ToolShape(line, self.name, size or 0.0, length or 0.0)
        yield records.Tool(line, self.number, self.name, None, self.h, self.d)


class DoSpindle(StrictModel):
    """Turn the spindle."""

    do: Literal["spindle"]
    sense: Literal["cw", "ccw", "off"] = Field(default="cw", description="Clockwise, the other way, or off.")
    speed: Length | None = Field(default=None, description="Revolutions per minute.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Spindle(line, self.sense, self.speed)


class DoFeed(StrictModel):
    """Set the feed."""

    do: Literal["feed"]
    feed: Length = Field(description="Feed, per minute if nothing else is said.")
    per_revolution: bool = Field(default=False, description="Feed per revolution.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Feed(line, self.feed * scale, self.per_revolution)


class DoFrom(StrictModel):
    """Say where the tool stands."""

    do: Literal["from"]
    at: Triple = Field(description="The position.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.From(line, *_scaled(self.at, scale))


class DoMove(StrictModel):
    """Move straight, by rapid or with the feed."""

    do: Literal["rapid", "line"]
    to: Triple = Field(description="The end point.")
    axis: Triple | None = Field(default=None, description="The tool axis; absent: as before.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        if self.do == "rapid":
            yield records.Rapid(line)
        yield records.Goto(line, *_scaled(self.to, scale), None if self.axis is None else _unit(self.axis))


class DoArc(StrictModel):
    """Move along an arc or a helix, turning about the normal by the right-hand rule."""

    do: Literal["arc"]
    to: Triple = Field(description="The end point.")
    center: Triple = Field(description="The centre.")
    normal: Triple = Field(default=records.UPRIGHT, description="The axis it turns about.")
    turns: Annotated[int, Field(ge=1, le=MOST_TURNS)] = Field(
        default=1, description="How often it comes to the end point."
    )

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        center = _scaled(self.center, scale)
        yield records.Circle(line, *_scaled(self.to, scale), center, _unit(self.normal), self.turns)


class DoCycle(StrictModel):
    """Drill holes; levels count from the points, upwards."""

    do: Literal["cycle"]
    kind: Literal["drill", "dwell", "deep", "chip_break", "tap", "bore"] = Field(description="The cycle.")
    points: tuple[Triple, ...] = Field(description="The holes: points on the surface.")
    depth: Length = Field(description="How deep, below the points.")
    clearance: Length = Field(description="Where the feed begins, above the points.")
    out: Length | None = Field(default=None, description="Where the tool leaves to; absent: the clearance.")
    feed: Length | None = Field(default=None, description="Feed; absent: the one in force.")
    per_revolution: bool = Field(default=False, description="Feed per revolution.")
    peck: Length | None = Field(default=None, description="Peck, of deep and chip_break.")
    dwell_s: Annotated[float, Field(ge=0)] = Field(default=0.0, description="Dwell at the bottom.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Cycle(
            line,
            self.kind,
            self.depth * scale,
            self.clearance * scale,
            max(self.out or self.clearance, self.clearance) * scale,
            None if self.feed is None else self.feed * scale,
            self.per_revolution,
            (self.peck or 0.0) * scale,
            self.dwell_s,
        )
        for point in self.points:
            yield records.Goto(line, *_scaled(point, scale))
        yield records.CycleOff(line)


class DoCoolant(StrictModel):
    """Switch the coolant."""

    do: Literal["coolant"]
    mode: Literal["flood", "mist", "through", "off"] = Field(description="Kind, or off.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Coolant(line, self.mode)


class DoCompensation(StrictModel):
    """Switch the radius compensation of the control."""

    do: Literal["compensation"]
    side: Literal["left", "right", "off"] = Field(description="Side of the contour, or off.")
    d: int | None = Field(default=None, description="Number of the offset; absent: the tool's.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Compensation(line, self.side, self.d)


class DoDwell(StrictModel):
    """Wait."""

    do: Literal["dwell"]
    seconds: Annotated[float, Field(ge=0)] = Field(default=0.0, description="Time.")
    revolutions: Annotated[float, Field(ge=0)] = Field(default=0.0, description="Or revolutions.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Dwell(line, self.seconds, self.revolutions)


class DoStop(StrictModel):
    """Stop for the operator."""

    do: Literal["stop"]
    optional: bool = Field(default=False, description="Only if the operator wants it.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Stop(line, self.optional)


class DoText(StrictModel):
    """Write a comment, or a block of the control as it stands."""

    do: Literal["comment", "insert"]
    text: str = Field(description="The text.")

    def records(self, line: int, scale: float) -> Iterator[Record]:
        """Yield the records."""
        yield records.Text(line, self.do, self.text)


DOINGS: tuple[type[StrictModel], ...] = (
    *(DoPath, DoTool, DoSpindle, DoFeed, DoFrom, DoMove, DoArc, DoCycle, DoCoolant, DoCompensation),
    *(DoDwell, DoStop, DoText),
)
"""The models of what stands in `path`."""

_Doing: TypeAlias = (
    DoPath | DoTool | DoSpindle | DoFeed | DoFrom | DoMove | DoArc | DoCycle | DoCoolant | DoCompensation
    | DoDwell | DoStop | DoText
)  # fmt: skip
_DOING: TypeAdapter[_Doing] = TypeAdapter(Annotated[_Doing, Field(discriminator="do")])
_PATH = re.compile(r'"path"\s*:\s*\[\s*')
_MOST_DIGITS = 300
_NEXT = re.compile(r"\s*,?\s*")


def read_json(source: Source, remarks: Remarks) -> Iterator[Record]:
    """Yield the records of a tool path in JSON.

    Raises:
        ProgramError: it is no JSON, or says something that is not known.
    """
    text = source.text()
    try:
        whole = json.loads(text, parse_int=_whole)
        if is_nested_beyond(whole, MOST_NESTING):
            raise RecursionError
    except json.JSONDecodeError as error:
        position = source.position(error.lineno, error.colno)
        raise ProgramError(
            f"not valid JSON: {error.msg}", position=position, hint="Correct the text."
        ) from None
    except RecursionError:
        raise ProgramError(
            f"lists or objects nested more than {MOST_NESTING} deep",
            position=source.position(1),
            hint="The path is a list of flat objects.",
        ) from None
    found = _PATH.search(text)
    if not isinstance(whole, dict) or not isinstance(whole.get("path"), list) or found is None:
        raise ProgramError(
            "a tool path in JSON is an object with a list 'path'",
            position=source.position(1),
            hint='Write it like {"units": "mm", "path": [{"do": "rapid", "to": [0, 0, 50]}]}.',
        )
    if unknown := sorted(set(whole) - {"units", "part", "path"}):
        raise ProgramError(
            f"unknown key '{unknown[0]}'", position=source.position(1), hint="Known are part, units and path."
        )
    if whole.get("units", "mm") not in ("mm", "inch"):
        raise ProgramError(
            "'units' must be mm or inch", position=source.position(1), hint="Write one of them."
        )
    scale = MM_PER_INCH if whole.get("units") == "inch" else 1.0
    yield records.Text(1, "part", str(whole.get("part", "")))
    yield from _doings(source, text, found.end(), scale)


def _whole(digits: str) -> int | float:
    """Return a whole number; one with more digits than Python reads is no length or count of anything."""
    return int(digits) if len(digits) <= _MOST_DIGITS else math.inf


def _doings(source: Source, text: str, place: int, scale: float) -> Iterator[Record]:
    decoder = json.JSONDecoder(parse_int=_whole)
    line, counted = 1, 0
    here: records.Vector | None = None
    while text[place] != "]":
        item, end = decoder.raw_decode(text, place)
        line += text.count("\n", counted, place)
        counted = place
        for record in _checked(source, item, line, scale):
            if record.__class__ is records.Circle:
                _check_arc(source, here, record)
            if isinstance(record, records.Goto | records.Circle | records.From):
                here = (record.x, record.y, record.z)
            yield record
        gap = _NEXT.match(text, end)
        place = gap.end() if gap else end


def _checked(source: Source, item: Any, line: int, scale: float) -> Iterator[Record]:
    try:
        doing = _DOING.validate_python(_with_tuples(item))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"][1:])
        what = f"'{where}': {first['msg']}" if where else first["msg"]
        raise ProgramError(
            what,
            position=source.position(line),
            hint='An object of the path begins with "do" and has the keys of its kind, and no others.',
        ) from None
    if isinstance(doing, DoCycle) and doing.kind in ("deep", "chip_break") and doing.peck is None:
        raise ProgramError(
            f"a cycle {doing.kind} without a peck", position=source.position(line), hint='Add "peck".'
        )
    yield from doing.records(line, scale)


def _check_arc(source: Source, start: records.Vector | None, arc: records.Circle) -> None:
    if start is None:
        raise ProgramError(
            "an arc without a start point",
            position=source.position(arc.line),
            hint='Write a "from" before it.',
        )
    off = off_circle(start, (arc.x, arc.y, arc.z), arc.center, arc.normal)
    if off:
        raise ProgramError(
            f"the end point of the arc lies {off:.4g} mm off the circle through its start",
            position=source.position(arc.line),
            hint="Check the centre, and the points before and after the arc.",
        )


def _with_tuples(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_with_tuples(each) for each in value)
    if isinstance(value, dict):
        return {key: _with_tuples(each) for key, each in value.items()}
    return value


def _scaled(point: Triple, scale: float) -> records.Vector:
    return point[0] * scale, point[1] * scale, point[2] * scale


def _unit(vector: Triple) -> records.Vector:
    length = dot(vector, vector) ** 0.5
    return (vector[0] / length, vector[1] / length, vector[2] / length) if length else records.UPRIGHT
