"""What body a program is cut from: said in a text, or found from the course of the tool."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from polycnc.errors import UsageError
from polycnc.stock._contacts import ContactKind
from polycnc.stock._cutting import Cutting
from polycnc.stock._rows import Rows
from polycnc.stock._solid import solid_stock
from polycnc.stock._stock import Box, Stock, check_cell
from polycnc.stock._target import TOLERANCE_MM, Target, check_tolerance
from polycnc.stock._tool import Tool
from polycnc.stock._turned import Turned
from polycnc.stock._voxels import Voxels

MARGIN_MM = 1.0
"""Of an `auto` body around what is cut."""
_FINER_TURNED = 5
_COARSE_CELLS = 200
CELLS_ACROSS = 1000
"""How many cells there are along the longer side where no resolution is given."""
_FORMS = "auto, box=X0,Y0,Z0,X1,Y1,Z1, cylinder=D,Z0,Z1 or the name of an STL file"
_TURNS = ("x", "y")


class NoStockError(UsageError):
    """A program that leaves nothing to say about stock: it cuts nothing, or in a way that is not simulated."""


@dataclass(frozen=True, slots=True)
class Form:
    """Say what body to cut: its text, and the resolution (mm) if one was given.

    `fixtures` are texts of what stands beside it, `target` is the STL file of what is to come out, within
    `tolerance_mm`.
    """

    text: str
    cell_mm: float | None = None
    fixtures: tuple[str, ...] = ()
    target: str | None = None
    tolerance_mm: float = TOLERANCE_MM

    def __post_init__(self) -> None:
        kind, _, numbers = self.text.partition("=")
        if kind in ("box", "cylinder"):
            numbers_of(self.text, numbers, 6 if kind == "box" else 3)
        elif self.text != "auto" and not _file_of(self.text)[0].lower().endswith(".stl"):
            raise UsageError(f"'{self.text}' is no stock", hint=f"Write {_FORMS}.")
        if self.cell_mm is not None:
            check_cell(self.cell_mm)
        check_tolerance(self.tolerance_mm)
        if self.target is not None and not self.target.lower().endswith(".stl"):
            raise UsageError(f"'{self.target}' is no target", hint="Name an STL file.")

    def body(self, course: Rows, tools: Mapping[int, Tool]) -> Stock:
        """Return the body for a course of the tool.

        Raises:
            UsageError: nothing is cut, no such file, or a body that cannot be told.
        """
        kind, _, numbers = self.text.partition("=")
        if kind == "box":
            x0, y0, z0, x1, y1, z1 = numbers_of(self.text, numbers, 6)
            box = Box((x0, y0, z0), (x1, y1, z1))
        elif kind == "cylinder":
            diameter, low, high = numbers_of(self.text, numbers, 3)
            return Stock.cylinder(diameter, low, high, self.cell_mm or _cell_mm(diameter))
        elif self.text == "auto":
            box = around(course, tools)
        else:
            name, turned = _file_of(self.text)
            return solid_stock(Path(name), self.cell_mm, _cell_mm, turned)
        return Stock(
            box, self.cell_mm or _cell_mm(max(b - a for a, b in zip(box.low[:2], box.high, strict=False)))
        )

    def turned_body(self, course: Rows) -> Turned:
        """Return the body that a lathe turns, for a course of the tool: X is the distance from the axis.

        Raises:
            UsageError: nothing is cut, or a body that no lathe turns.
        """
        if self.fixtures or self.target is not None:
            raise UsageError(
                "fixtures and targets on a lathe", hint="They are for three axes: leave them out."
            )
        if self.text == "auto":
            diameter, low, high = around_turned(course)
        elif self.text.startswith("cylinder="):
            diameter, low, high = numbers_of(self.text, self.text.partition("=")[2], 3)
        else:
            raise UsageError(f"'{self.text}' on a lathe", hint="Write auto or cylinder=D,Z0,Z1.")
        return Turned(diameter, low, high, self.cell_mm or _cell_mm((high - low) / _FINER_TURNED))

    def told(self, course: Rows, tools: Mapping[int, Tool]) -> Form:
        """Return the box for a course in place of `auto`."""
        if self.text != "auto":
            return self
        box = around(course, tools)
        return replace(self, text="box=" + ",".join(f"{each:.9g}" for each in (*box.low, *box.high)))

    def voxels(self) -> Voxels:
        """Return the body for tools that come from any side.

        Raises:
            UsageError: a body that is not one of these.
        """
        if self.fixtures or self.target is not None:
            raise UsageError(
                "fixtures and targets with turning axes or tools that undercut", hint="Leave them out."
            )
        kind, _, numbers = self.text.partition("=")
        if kind == "box":
            x0, y0, z0, x1, y1, z1 = numbers_of(self.text, numbers, 6)
            size = max(x1 - x0, y1 - y0, z1 - z0)
            return Voxels(Box((x0, y0, z0), (x1, y1, z1)), self.cell_mm or _cell_mm(_FINER_TURNED * size))
        if kind == "cylinder":
            diameter, low, high = numbers_of(self.text, numbers, 3)
            cell_mm = self.cell_mm or _cell_mm(_FINER_TURNED * max(diameter, high - low))
            return Voxels.cylinder(diameter, low, high, cell_mm)
        raise NoStockError(
            f"'{self.text}' where an axis turns, or a tool undercuts",
            hint="Write box=X0,Y0,Z0,X1,Y1,Z1 or cylinder=D,Z0,Z1.",
        )

    def target_of(self, stock: Stock) -> Target | None:
        """Return what is to come out of a body; None if that is not said.

        Raises:
            UsageError: no such file, or a surface that is none.
        """
        return None if self.target is None else Target(Path(self.target), stock, self.tolerance_mm)


def file_of(text: str) -> Path | None:
    """Return the file that a body or fixture is read from, None for one that numbers describe."""
    name = _file_of(text)[0]
    return Path(name) if name.lower().endswith(".stl") else None


def _file_of(text: str) -> tuple[str, str]:
    """Return the name of a file, and the axis that its body is turned over about: `x`, `y` or none."""
    kind, _, name = text.partition("=")
    axis, _, turned = kind.lower().partition("-")
    return (name, axis) if axis in _TURNS and turned == "turned" and name else (text, "")


def _cell_mm(size_mm: float) -> float:
    """Return a resolution for a body of this size: 1, 2 or 5 times a power of ten."""
    wanted = max(size_mm, 1e-3) / CELLS_ACROSS
    power = 10.0 ** math.floor(math.log10(wanted))
    return float(
        f"{next(step for step in (1.0, 2.0, 5.0, 10.0) if step * power >= wanted * 0.999) * power:.3g}"
    )


def numbers_of(text: str, numbers: str, count: int, forms: str = _FORMS) -> list[float]:
    """Return the numbers after the kind of a body.

    Raises:
        UsageError: too few or too many, or none.
    """
    found = re.split(r"\s*,\s*", numbers.strip())
    try:
        values = [float(each) for each in found]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise UsageError(f"'{text}' is no body", hint=f"Write {forms}, with {count} numbers (mm) here.")
    return values


def around(course: Rows, tools: Mapping[int, Tool]) -> Box:
    """Return the box that holds what is cut, with a margin beside and below it.

    Its top is program zero where the tool cuts below that, else the highest cut across. Where the tool gets down
    into it at rapid, close to a side, the box ends beside it.

    Raises:
        UsageError: nothing is cut.
    """
    begin, end = course.tip[:-1], course.tip[1:]
    cuts = ~course.rapid[1:] & np.any(begin != end, axis=1)
    if not cuts.any():
        raise NoStockError(
            "the program cuts nothing: no stock can be told", hint="Give one, like box=0,0,-10,90,60,0."
        )
    radius = np.zeros(len(course.tool))
    for number in np.unique(course.tool).tolist():
        if (tool := tools.get(number)) is not None:
            radius[course.tool == number] = tool.radius_mm
    places, reach = np.concatenate((begin[cuts], end[cuts])), np.tile(radius[1:][cuts], 2)[:, None]
    low_xy, high_xy = (
        (places[:, :2] - reach).min(axis=0) - MARGIN_MM,
        (places[:, :2] + reach).max(axis=0) + MARGIN_MM,
    )
    across = cuts & np.any(begin[:, :2] != end[:, :2], axis=1)
    lowest = float(places[:, 2].min())
    top = 0.0 if lowest < 0.0 else float(end[across if across.any() else cuts][:, 2].max())
    top, below = top if top > lowest else lowest + MARGIN_MM, lowest - MARGIN_MM
    low, high = [*low_xy.tolist(), below], [*high_xy.tolist(), top]
    deep = course.rapid[1:] & (end[:, 2] < high[2])
    if deep.any():
        deep &= np.isin(course.block[1:], _met_at_rapid(course, tools, low, high))
    for (x, y), away in zip(end[deep, :2].tolist(), radius[1:][deep].tolist(), strict=True):
        _leave_out((x, y), away, low, high)
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def _met_at_rapid(course: Rows, tools: Mapping[int, Tool], low: list[float], high: list[float]) -> list[int]:
    """Return the blocks that go through a box at rapid; what they have cut before does not count."""
    box = Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))
    stock = Stock(box, max(high[0] - low[0], high[1] - low[1]) / _COARSE_CELLS)
    cutting = Cutting(stock, tools)
    cutting.add(course)
    return [each.block for each in cutting.contacts if each.kind is ContactKind.RAPID]


def around_turned(course: Rows) -> tuple[float, float, float]:
    """Return diameter and ends along Z of the bar that holds what is turned.

    It is as thick as the tool gets at a feed, ends 1 mm behind its last place, and begins where it is faced, at program
    zero if it is not.

    Raises:
        NoStockError: nothing is cut.
    """
    begin, end = course.tip[:-1], course.tip[1:]
    cuts = ~course.rapid[1:] & np.any(begin != end, axis=1)
    if not cuts.any():
        raise NoStockError(
            "the program cuts nothing: no stock can be told", hint="Give one, like cylinder=30,-60,0."
        )
    places = np.concatenate((begin[cuts], end[cuts]))
    faces = cuts & (np.abs(begin[:, 2] - end[:, 2]) < 1e-6) & (end[:, 0] <= 0.0)
    high = float(end[faces][:, 2].max()) if faces.any() else 0.0
    low = min(float(places[:, 2].min()), high - MARGIN_MM) - MARGIN_MM
    return 2.0 * float(np.abs(places[:, 0]).max()), low, high


def _leave_out(place: tuple[float, float], radius: float, low: list[float], high: list[float]) -> None:
    """Draw one side of a box in, so that a tool that came to a place at rapid, beside what it cuts, is beside it."""
    if any(not low[i] - radius < place[i] < high[i] + radius for i in range(2)):
        return
    sides = [(place[i] + radius - low[i], i, low) for i in range(2)]
    sides += [(high[i] - place[i] + radius, i, high) for i in range(2)]
    drawn, i, side = min(sides, key=lambda each: each[0])
    if drawn <= 2.0 * (radius + MARGIN_MM):
        side[i] = place[i] + radius if side is low else place[i] - radius
