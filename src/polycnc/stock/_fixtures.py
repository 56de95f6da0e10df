"""What holds a part, and must not be touched: boxes and files of triangles, seen from above."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from polycnc.errors import UsageError
from polycnc.stock._form import numbers_of
from polycnc.stock._solid import solid_stock, solid_voxels
from polycnc.stock._stock import MOST_CELLS, Box, Stock
from polycnc.stock._voxels import MOST_VOXELS, Voxels

T = TypeVar("T", Stock, Voxels)

MOST_FIXTURES = 50
_FORMS = "box=X0,Y0,Z0,X1,Y1,Z1, cylinder=D,Z0,Z1 or the name of an STL file"


def check_fixtures(texts: Sequence[str]) -> None:
    """Refuse texts that tell no fixtures.

    Raises:
        UsageError: one tells none, or there are too many.
    """
    if len(texts) > MOST_FIXTURES:
        raise UsageError(f"{len(texts)} fixtures", hint=f"At most {MOST_FIXTURES} are looked at.")
    for text in texts:
        if text.startswith("box="):
            box_of(text)
        elif text.startswith("cylinder="):
            cylinder_of(text)
        elif not text.lower().endswith(".stl"):
            raise UsageError(f"'{text}' is no fixture", hint=f"Write {_FORMS}.")


def fixtures_of(texts: Sequence[str], cell_mm: float) -> list[Stock]:
    """Return the fixtures that texts tell (mm, in the coordinates of the stock), in cells of this width.

    What lies under an overhang of one counts as full.

    Raises:
        UsageError: no such file, no closed surface, or too many cells.
    """
    return _made(
        texts,
        cell_mm,
        lambda text: (
            Stock(box_of(text), cell_mm)
            if text.startswith("box=")
            else Stock.cylinder(*cylinder_of(text), cell_mm)
            if text.startswith("cylinder=")
            else solid_stock(Path(text), cell_mm, lambda _: cell_mm)
        ),
        lambda fixture: fixture.heights.size,
        MOST_CELLS,
    )


def solid_fixtures_of(texts: Sequence[str], cell_mm: float) -> list[Voxels]:
    """Return the fixtures for tools that come from any side, in the coordinates of the part, which they turn with.

    Raises:
        UsageError: no such file, no closed surface, or too many cells.
    """
    return _made(
        texts,
        cell_mm,
        lambda text: (
            Voxels(box_of(text), cell_mm)
            if text.startswith("box=")
            else Voxels.cylinder(*cylinder_of(text), cell_mm)
            if text.startswith("cylinder=")
            else solid_voxels(Path(text), cell_mm, lambda _: cell_mm)
        ),
        lambda fixture: fixture.cells.size,
        MOST_VOXELS,
    )


def _made(
    texts: Sequence[str], cell_mm: float, make: Callable[[str], T], size: Callable[[T], int], most: int
) -> list[T]:
    """Return what texts tell, as long as all of them together have not too many cells."""
    check_fixtures(texts)
    found: list[T] = []
    cells = 0
    for text in texts:
        found.append(make(text))
        cells += size(found[-1])
        if cells > most:
            raise UsageError(
                f"the fixtures have more than {most:,} cells of {cell_mm:g} mm",
                hint="Choose a coarser resolution.",
            )
    return found


def box_of(text: str) -> Box:
    """Return the box that a text tells.

    Raises:
        UsageError: it tells none.
    """
    x0, y0, z0, x1, y1, z1 = numbers_of(text, text.partition("=")[2], 6, _FORMS)
    return Box((x0, y0, z0), (x1, y1, z1))


def cylinder_of(text: str) -> tuple[float, float, float]:
    """Return diameter and ends of the cylinder that a text tells.

    Raises:
        UsageError: it tells none.
    """
    diameter, low_z, high_z = numbers_of(text, text.partition("=")[2], 3, _FORMS)
    return diameter, low_z, high_z
