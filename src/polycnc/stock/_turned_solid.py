"""What stands about the axis of a lathe: targets and fixtures as radii along it, from files of triangles too."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.stock._fixtures import box_of, check_fixtures, cylinder_of
from polycnc.stock._mesh import Mesh
from polycnc.stock._solid import check_closed, read_stl
from polycnc.stock._target import TargetComparison, check_tolerance
from polycnc.stock._turned import Turned

Floats = npt.NDArray[np.float64]


def turned_fixtures_of(texts: Sequence[str], cell_mm: float) -> list[Turned]:
    """Return the fixtures that texts tell: they turn with the part, so that they are as wide as they reach.

    Raises:
        UsageError: no such file, no closed surface, or too many cells.
    """
    check_fixtures(texts)
    return [_fixture(text, cell_mm) for text in texts]


def _fixture(text: str, cell_mm: float) -> Turned:
    if text.startswith("cylinder="):
        return Turned(*cylinder_of(text), cell_mm)
    if text.startswith("box="):
        box = box_of(text)
        far, near = ([each(abs(box.low[i]), abs(box.high[i])) for i in range(2)] for each in (max, min))
        inside = [box.low[i] <= 0.0 <= box.high[i] for i in range(2)]
        found = Turned(2.0 * math.hypot(*far), box.low[2], box.high[2], cell_mm)
        found.inner[:] = math.hypot(
            *(0.0 if within else side for within, side in zip(inside, near, strict=True))
        )
        return found
    surface = _surface(Path(text))
    low_z, high_z = (float(each) for each in (surface.vertices[:, 2].min(), surface.vertices[:, 2].max()))
    radius = float(np.hypot(surface.vertices[:, 0], surface.vertices[:, 1]).max())
    found = Turned(2.0 * radius, low_z, high_z, cell_mm)
    found.outer[:], found.inner[:] = _radii(surface, found)
    return found


def _surface(path: Path) -> Mesh:
    surface = read_stl(path)
    check_closed(path, surface)
    return surface


def _radii(surface: Mesh, body: Turned) -> tuple[Floats, Floats]:
    """Return how far a surface reaches from the axis in each cell of a body, and how wide its bore is; 0: nothing.

    Corners of facets lie on the round surface that they stand for.
    """
    corners = surface.vertices[surface.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = np.einsum("ij,ij->i", normal[:, :2], corners.mean(axis=1)[:, :2])
    level = np.hypot(normal[:, 0], normal[:, 1]) < 1e-9 * np.maximum(np.abs(normal[:, 2]), 1e-300)
    outer, inner = np.zeros_like(body.outer), np.zeros_like(body.inner)
    _reach(corners[(outwards > 0.0) & ~level], body, outer)
    _reach(corners[(outwards < 0.0) & ~level], body, inner)
    return outer, np.minimum(inner, outer)


def _reach(corners: Floats, body: Turned, radii: Floats) -> None:
    """Raise radii to those of the edges of triangles [n, 3, 3] at the middles of the cells."""
    z = body.z
    edges = np.concatenate([corners[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    edges = edges[np.arange(len(edges))[:, None], np.argsort(edges[:, :, 2], axis=1)]
    # The place of a corner may be rounded beyond the middle of a cell.
    firsts = np.searchsorted(z, edges[:, 0, 2] - 1e-6)
    lasts = np.searchsorted(z, edges[:, 1, 2] + 1e-6, side="right")
    for (begin, end), first, last in zip(edges, firsts.tolist(), lasts.tolist(), strict=True):
        if first < last:
            high = end[2] - begin[2]
            share = (
                np.clip((z[first:last] - begin[2]) / high, 0.0, 1.0) if high > 0.0 else np.zeros(last - first)
            )
            x, y = (begin[i] + share * (end[i] - begin[i]) for i in range(2))
            np.maximum(radii[first:last], np.hypot(x, y), out=radii[first:last])


class TurnedTarget:
    """Hold what is to be turned out of a stock, from an STL file about Z in the same coordinates.

    `limit` is the body that no tool may get into: the target less the tolerance, and less a cell along the axis.

    Raises:
        UsageError: no such file, or no closed surface.
    """

    def __init__(self, path: Path, stock: Turned, tolerance_mm: float) -> None:
        check_tolerance(tolerance_mm)
        surface = _surface(path)
        self.tolerance_mm = tolerance_mm
        self._outer, self._inner = _radii(surface, stock)
        self._within = stock.z >= surface.vertices[:, 2].min()  # what is behind is parted off
        self.limit = stock.copy()
        self.limit.outer = _around(self._outer, np.minimum) - tolerance_mm
        self.limit.inner = _around(self._inner, np.maximum) + tolerance_mm
        self.limit.outer = np.maximum(self.limit.outer, 0.0)

    def compare(self, stock: Turned) -> TargetComparison:
        """Return how a body differs from the target; what is behind the target does not count."""
        cell, tolerance = math.pi * stock.cell_mm, self.tolerance_mm
        outer, inner = self._outer, self._inner
        full, wanted = stock.outer > stock.inner, outer > inner
        over = np.where(full, stock.outer - _around(outer, np.maximum), 0.0)
        under = np.where(full & wanted, _around(inner, np.minimum) - stock.inner, 0.0)
        rest = np.where(over > tolerance, stock.outer**2 - outer**2, 0.0)
        rest += np.where(under > tolerance, inner**2 - stock.inner**2, 0.0)
        gouge = np.where(self.limit.outer > stock.outer, outer**2 - stock.outer**2, 0.0)
        gouge += np.where(wanted & (stock.inner > self.limit.inner), stock.inner**2 - inner**2, 0.0)
        rest, gouge = np.where(self._within, rest, 0.0), np.where(self._within, gouge, 0.0)
        left = np.where(self._within & (rest > 0.0), np.maximum(over, under), 0.0)
        at = int(np.argmax(left))
        bore = under[at] > over[at]
        place = float(stock.inner[at] if bore else stock.outer[at]), 0.0, float(stock.z[at])
        most = float(stock.outer[at] - outer[at] if not bore else inner[at] - stock.inner[at])
        any_left = bool(left[at] > 0.0)
        return TargetComparison(
            tolerance,
            float(gouge.sum()) * cell,
            float(rest.sum()) * cell,
            most if any_left else 0.0,
            place if any_left else None,
        )


def _around(radii: Floats, pick: np.ufunc) -> Floats:
    """Return the least or greatest of each cell and its neighbours."""
    wide = np.pad(radii, 1, mode="edge")
    found = radii
    for each in (wide[:-2], wide[2:]):
        found = pick(found, each)
    return found
