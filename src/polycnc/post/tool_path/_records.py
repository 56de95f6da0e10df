"""The records of a tool path: what every input format is read into. Lengths are mm, feeds mm/min or mm/rev.

Each begins with `line`, where it stands in its file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

Vector: TypeAlias = tuple[float, float, float]

LARGEST_MM = 1e6
"""No machine has a position, centre or radius further away: a kilometre."""

MOST_TURNS = 100_000
"""No thread has more turns in one arc."""

UPRIGHT: Vector = (0.0, 0.0, 1.0)
"""The tool axis of a machine without rotary axes: from the tip to the holder."""

CycleKind: TypeAlias = Literal["drill", "dwell", "deep", "chip_break", "tap", "bore"]


class Text(NamedTuple):
    """A text: the name of the part or machine, a comment, or a block that goes to the control as it is."""

    line: int
    kind: Literal["part", "machine", "comment", "insert"]
    text: str


class Path(NamedTuple):
    """The beginning of an operation; with None for a name its end. `work_offset` None: as before."""

    line: int
    name: str | None
    work_offset: int | None = None


class WorkOffset(NamedTuple):
    """Positions count from another zero from here on; nothing says where the tool is in it.

    `frame`: it comes of a coordinate system of the tool path, the first of which is 1.
    """

    line: int
    number: int
    frame: bool = False


class ToolShape(NamedTuple):
    """Name and size of the tool that comes next, or that is at work; None where it is not said."""

    line: int
    name: str | None = None
    diameter: float | None = None
    length: float | None = None


class Tool(NamedTuple):
    """A tool change; `h` and `d` are the numbers of its offsets, None if the tool's own."""

    line: int
    number: int
    name: str | None = None
    length: float | None = None
    h: int | None = None
    d: int | None = None


class Spindle(NamedTuple):
    """Speed and sense of the spindle; None where it stays as it is. `surface`: the speed is m/min.

    `max_rpm` is the highest speed that is allowed with it, 0 if none is given.
    """

    line: int
    sense: Literal["cw", "ccw", "off", "on"]
    speed: float | None = None
    surface: bool = False
    max_rpm: float = 0.0


class Feed(NamedTuple):
    """The feed of the moves that follow."""

    line: int
    value: float
    per_revolution: bool = False


class Rapid(NamedTuple):
    """The next move is a rapid."""

    line: int


class From(NamedTuple):
    """Where the tool stands, without moving there."""

    line: int
    x: float
    y: float
    z: float
    axis: Vector | None = None


class Goto(NamedTuple):
    """A straight move to a point, or in a cycle a hole; `axis` is the tool axis, None if it stays."""

    line: int
    x: float
    y: float
    z: float
    axis: Vector | None = None


class Points(NamedTuple):
    """Many `Goto` without an axis, one on each line from `line` on: `xyz` has a row for each, [points, 3] in mm."""

    line: int
    xyz: npt.NDArray[np.float64]


class Delta(NamedTuple):
    """A straight move by a distance; `along_axis`: by `x` along the tool axis."""

    line: int
    x: float
    y: float
    z: float
    along_axis: bool = False


class Home(NamedTuple):
    """A rapid to a point, or with None to where FROM was."""

    line: int
    point: Vector | None = None


class Retract(NamedTuple):
    """A rapid along Z up to a level; from above it, nothing."""

    line: int
    z: float


class Axis(NamedTuple):
    """The tool axis from here on; nothing moves."""

    line: int
    axis: Vector


class Circle(NamedTuple):
    """An arc or a helix to a point, turning by the right-hand rule about `normal` through `center`.

    `turns` is how often it comes to the end point: 1 for up to a whole turn.
    """

    line: int
    x: float
    y: float
    z: float
    center: Vector
    normal: Vector = UPRIGHT
    turns: int = 1


class Cycle(NamedTuple):
    """What is done at the points that follow. Levels count from the point, upwards.

    The feed begins at `clearance` and ends at -`depth`; the tool leaves to `out`, where None is the level from
    which it came to the first hole. `feed` None is the feed in force.
    """

    line: int
    kind: CycleKind
    depth: float
    clearance: float
    out: float | None
    feed: float | None = None
    per_revolution: bool = False
    peck: float = 0.0
    dwell_s: float = 0.0


class Thread(NamedTuple):
    """Feed moves cut a thread from here on, or do not any more.

    `lead` is the way of one turn of the spindle; None is the feed per revolution in force.
    """

    line: int
    on: bool
    lead: float | None = None


class CycleOff(NamedTuple):
    """Points are moves again; `on` takes the cycle up once more."""

    line: int
    on: bool = False


class Coolant(NamedTuple):
    """Coolant on, of a kind, or off."""

    line: int
    mode: Literal["flood", "mist", "through", "off"]


class Compensation(NamedTuple):
    """Radius compensation by the control; `plane` is 18 or 19 where another one than XY is said."""

    line: int
    side: Literal["left", "right", "off"]
    d: int | None = None
    plane: int | None = None


class Dwell(NamedTuple):
    """A pause, in seconds or in revolutions of the spindle."""

    line: int
    seconds: float = 0.0
    revolutions: float = 0.0


class Stop(NamedTuple):
    """A stop for the operator, or one that the operator can switch off."""

    line: int
    optional: bool = False


class Word(NamedTuple):
    """A record that is not known here: its first word, the numbers and the text after its slash.

    `first` is the first word after the slash, empty if there is none.
    """

    line: int
    name: str
    first: str
    numbers: tuple[float, ...]
    text: str


class End(NamedTuple):
    """The end of the tool path."""

    line: int


Record: TypeAlias = (
    Text | Path | WorkOffset | ToolShape | Tool | Spindle | Feed | Rapid | From | Goto | Delta | Home | Retract | Axis
    | Circle | Cycle | CycleOff | Thread | Coolant | Compensation | Dwell | Stop | Word | End
)  # fmt: skip


def one_by_one(records: Iterable[Record | Points]) -> Iterator[Record]:
    """Yield records, and for points each move by itself."""
    for record in records:
        if isinstance(record, Points):
            line = record.line
            for place, (x, y, z) in enumerate(record.xyz.tolist()):
                yield Goto(line + place, x, y, z)
        else:
            yield record
