"""What the interpreter hands to the channel queue, one item per motion or wait.

Coordinates are machine coordinates of all axes (mm for linear, degree for rotary axes) after every offset. `line` is
the line of the block that an item comes from, `tag` the reference of its record, which the interpreter puts in.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TypeAlias

Point: TypeAlias = tuple[float, ...]


class GeometryError(Exception):
    """Moves that cannot be made of what a block says: what is wrong, and what to do."""

    def __init__(self, what: str, hint: str) -> None:
        super().__init__(what)
        self.what = what
        self.hint = hint


class Stop(StrEnum):
    """Why preparation waits until the path has come to a point."""

    PROGRAM = "program stop"
    OPTIONAL = "optional stop"
    DRAIN = "preparation waits for execution"
    PROBE = "probing begins"
    REFUSED = "a block was refused"
    PROBE_IN_PASSING = "measuring in passing begins"


@dataclass(frozen=True, slots=True)
class Feed:
    """Say how fast a move goes: a path speed, or a time for the whole move (inverse time).

    One `with_spindle` cuts a thread: neither an override nor a feed hold acts before it is over.
    """

    speed_mm_s: float = 0.0
    duration_s: float = 0.0
    with_spindle: bool = False


@dataclass(frozen=True, slots=True)
class Line:
    """Move straight from `start` to `end`."""

    start: Point
    end: Point
    feed: Feed
    rapid: bool
    exact_stop: bool
    line: int
    tag: int = 0

    def tagged(self, tag: int) -> Line:
        """Return the same move as part of another block."""
        return Line(self.start, self.end, self.feed, self.rapid, self.exact_stop, self.line, tag)


@dataclass(frozen=True, slots=True)
class Arc:
    """Move on a circle or helix.

    `plane` holds the axis indices (first, second, normal). `center` is in the first two. `sweep_rad` is
    signed, positive from the first towards the second axis, and includes whole turns; all other axes move
    linearly.
    """

    start: Point
    end: Point
    center: tuple[float, float]
    sweep_rad: float
    plane: tuple[int, int, int]
    feed: Feed
    exact_stop: bool
    line: int
    tag: int = 0

    def tagged(self, tag: int) -> Arc:
        """Return the same move as part of another block."""
        sweep, plane = self.sweep_rad, self.plane
        return Arc(
            self.start, self.end, self.center, sweep, plane, self.feed, self.exact_stop, self.line, tag
        )


@dataclass(frozen=True, slots=True)
class Spline:
    """Move on a part of a Bezier curve in two axes, `plane`; no other axis moves.

    `span` is the row that the kernel's `cut_bezier` wrote for the part, `length_mm` its path length.
    """

    start: Point
    end: Point
    plane: tuple[int, int]
    span: tuple[float, ...]
    length_mm: float
    feed: Feed
    exact_stop: bool
    line: int
    tag: int = 0

    def tagged(self, tag: int) -> Spline:
        """Return the same move as part of another block."""
        span, length = self.span, self.length_mm
        return Spline(
            self.start, self.end, self.plane, span, length, self.feed, self.exact_stop, self.line, tag
        )


@dataclass(frozen=True, slots=True)
class Wait:
    """Let time pass with all axes at rest, then raise the events (auxiliary functions) in order.

    One that `passes` stops nothing: moves before and after it differ in the power of a laser, and its events are raised
    when the next move begins.

    A `stop` is a point where the program may stand: then preparation goes on when whoever runs the path says so.
    `message` is what the operator is shown there. One `with_spindle` is part of a thread, see `Feed`.
    """

    duration_s: float
    line: int
    events: tuple[str, ...] = field(default=())
    stop: Stop | None = None
    tag: int = 0
    message: str = ""
    passes: bool = False
    with_spindle: bool = False

    def tagged(self, tag: int) -> Wait:
        """Return the same wait as part of another block."""
        return replace(self, tag=tag)


Move: TypeAlias = Line | Arc
QueueItem: TypeAlias = Line | Arc | Spline | Wait
