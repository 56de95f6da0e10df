"""What body a program is cut from: said in a text, or found from the course of the tool."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.stock._auto import around, around_any_side, around_turned, leave_out_rapids
from polycnc.stock._rows import Rows
from polycnc.stock._solid import solid_stock, solid_voxels
from polycnc.stock._solid_target import SolidTarget
from polycnc.stock._stock import Box, Stock, check_cell
from polycnc.stock._target import TOLERANCE_MM, Target, check_tolerance
from polycnc.stock._tool import Tool
from polycnc.stock._turned import Turned
from polycnc.stock._voxels import Voxels

_FINER_TURNED = 5
CELLS_ACROSS = 1000
"""How many cells there are across a square body where no resolution is given."""
_FORMS = "auto, box=X0,Y0,Z0,X1,Y1,Z1, cylinder=D,Z0,Z1 or the name of an STL file"
_TURNS = ("x", "y")

Body = Stock | Turned | Voxels
"""What is left of a body, and can be cut again."""


@dataclass(frozen=True, slots=True)
class Form:
    """Say what body to cut: its text, and the resolution (mm) if one was given.

    `fixtures` are texts of what stands beside it, `target` is the STL file of what is to come out, within
    `tolerance_mm`. `given` is a body in place of the text, like that of a run before; it stays as it is.
    """

    text: str
    cell_mm: float | None = None
    fixtures: tuple[str, ...] = ()
    target: str | None = None
    tolerance_mm: float = TOLERANCE_MM
    given: Body | None = None

    def __post_init__(self) -> None:
        kind, _, numbers = self.text.partition("=")
        if self.given is not None:
            pass
        elif kind in ("box", "cylinder"):
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
        if isinstance(self.given, Stock):
            return self.given.copy()
        self._refuse_given("a mill")
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
        return Stock(box, self.cell_mm or _cell_mm(box.across_mm))

    def turned_body(self, course: Rows) -> Turned:
        """Return the body that a lathe turns, for a course of the tool: X is the distance from the axis.

        Raises:
            UsageError: nothing is cut, or a body that no lathe turns.
        """
        if isinstance(self.given, Turned):
            return self.given.copy()
        self._refuse_given("a lathe")
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

    def voxels(self, course: Rows, tools: Mapping[int, Tool]) -> Voxels:
        """Return the body for tools that come from any side; of an `auto` one nothing is where rapids go.

        Raises:
            UsageError: a body that is not one of these.
        """
        if isinstance(self.given, Voxels):
            return self.given.copy()
        if isinstance(self.given, Stock):
            size = max(b - a for a, b in zip(self.given.box.low, self.given.box.high, strict=True))
            return Voxels.of_heights(self.given, self.cell_mm or _cell_mm(_FINER_TURNED * size))
        self._refuse_given("a mill")
        kind, _, numbers = self.text.partition("=")
        if kind == "box":
            x0, y0, z0, x1, y1, z1 = numbers_of(self.text, numbers, 6)
            size = max(x1 - x0, y1 - y0, z1 - z0)
            return Voxels(Box((x0, y0, z0), (x1, y1, z1)), self.cell_mm or _cell_mm(_FINER_TURNED * size))
        if kind == "cylinder":
            diameter, low, high = numbers_of(self.text, numbers, 3)
            cell_mm = self.cell_mm or _cell_mm(_FINER_TURNED * max(diameter, high - low))
            return Voxels.cylinder(diameter, low, high, cell_mm)
        if self.text != "auto":
            name, turned = _file_of(self.text)
            return solid_voxels(Path(name), self.cell_mm, lambda size: _cell_mm(_FINER_TURNED * size), turned)
        box = around_any_side(course, tools)
        size = max(b - a for a, b in zip(box.low, box.high, strict=True))
        found = Voxels(box, self.cell_mm or _cell_mm(_FINER_TURNED * size))
        leave_out_rapids(found, course, tools)
        return found

    def _refuse_given(self, machine: str) -> None:
        if self.given is not None:
            raise UsageError(
                f"'{self.given}' as stock of {machine}",
                hint="Give a body that such a machine left, or save it as an STL file: stock.mesh().write('NAME.stl').",
            )

    def target_of(self, stock: Stock) -> Target | None:
        """Return what is to come out of a body; None if that is not said.

        Raises:
            UsageError: no such file, or a surface that is none.
        """
        return None if self.target is None else Target(Path(self.target), stock, self.tolerance_mm)

    def solid_target_of(self, body: Voxels) -> SolidTarget | None:
        """Return what is to come out of a body that tools cut from any side; None if that is not said.

        Raises:
            UsageError: no such file, or a surface that is none.
        """
        return None if self.target is None else SolidTarget(Path(self.target), body, self.tolerance_mm)


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
