"""Bodies from files of triangles."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import entry
from polycnc.stock._mesh import Mesh
from polycnc.stock._stock import FARTHEST_MM, Box, Stock
from polycnc.stock._voxel_sweep import FULL
from polycnc.stock._voxels import Voxels

MOST_TRIANGLES = 5_000_000
MOST_TEXT_BYTES = 200_000_000
_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER = 84
_RAYS = 3  # through a cell, along x as along y
_ASIDE = 1.234567e-4
_MOST_SHARES = 8_000_000
_VERTEX = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)


def read_stl(path: Path) -> Mesh:
    """Return the surface in a binary or text STL file.

    Raises:
        UsageError: no such file, no STL, too many triangles, or numbers that are none.
    """
    content = _content(path)
    count = int(np.frombuffer(content[80:_HEADER], "<u4")[0]) if len(content) >= _HEADER else -1
    if count >= 0 and len(content) == _HEADER + count * _ROW.itemsize:
        corners = np.frombuffer(content, _ROW, offset=_HEADER)["corners"].reshape(-1, 3).astype(np.float64)
    else:
        corners = _text_corners(path, content)
    if not len(corners) or not np.isfinite(corners).all():
        raise UsageError(f"'{path}' has no triangles or wrong numbers", hint="Export it anew.")
    if (farthest := float(np.abs(corners).max())) > FARTHEST_MM:
        raise UsageError(
            f"'{path}' reaches {farthest:g} mm", hint=f"Corners are at most {FARTHEST_MM:,.0f} mm from zero."
        )
    vertices, faces = np.unique(corners, axis=0, return_inverse=True)
    return Mesh(vertices, faces.reshape(-1, 3).astype(np.int64))


def _content(path: Path) -> bytes:
    """Return what is in a file, whose size is looked at first: some hundred bytes are needed for a triangle."""
    if "\0" in str(path):
        raise UsageError("the name of a file with a zero byte in it", hint="Name an STL file.")
    try:
        if path.exists() and not path.is_file():
            raise UsageError(f"'{path}' is no file", hint="Name an STL file.")
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(_HEADER)
            count = int(np.frombuffer(head[80:], "<u4")[0]) if len(head) == _HEADER else 0
            binary = size == _HEADER + count * _ROW.itemsize
            if count > MOST_TRIANGLES and (binary or not (_is_text(head) or _in_letters(head))):
                raise UsageError(
                    f"'{path}' has {count:,} triangles",
                    hint=f"At most {MOST_TRIANGLES:,} are read: export it coarser.",
                )
            if not binary and size > MOST_TEXT_BYTES:
                raise UsageError(
                    f"'{path}' has {size:,} bytes and is no binary STL file",
                    hint=f"As text at most {MOST_TEXT_BYTES:,} are read: export it as binary STL.",
                )
            return head + file.read(size)
    except OSError as error:
        raise UsageError(
            f"cannot read '{path}': {error.strerror}", hint="Check the name and the folder."
        ) from None


def _is_text(content: bytes) -> bool:
    return content[:_HEADER].lstrip()[:5].lower() == b"solid"


def _in_letters(content: bytes) -> bool:
    """Tell whether a file begins as a text does: what stands in place of a number of triangles is none then."""
    return all(9 <= byte <= 13 or 32 <= byte < 127 for byte in content[80:_HEADER])


def _text_corners(path: Path, content: bytes) -> npt.NDArray[np.float64]:
    found = _VERTEX.findall(content) if _is_text(content) else []
    try:
        corners = np.array([[float(each) for each in place] for place in found], np.float64).reshape(-1, 3)
    except ValueError:
        corners = np.zeros((1, 3))
    if not len(corners) or len(corners) % 3:
        raise UsageError(f"'{path}' is no STL file", hint="Binary and text STL are read.")
    return corners


def check_closed(path: Path, surface: Mesh) -> None:
    """Refuse a surface that is open, without volume or inside out.

    Raises:
        UsageError: it is.
    """
    edges = np.sort(surface.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    if np.any(uses % 2):
        gaps = int(np.count_nonzero(uses % 2))
        raise UsageError(
            f"the surface in '{path}' is open: {gaps} edges have one side", hint="Repair it, then export it."
        )
    if surface.volume_mm3 == 0.0:
        raise UsageError(f"the surface in '{path}' has no volume", hint="Export a solid body.")
    if surface.volume_mm3 < 0.0:
        raise UsageError(f"the surface in '{path}' is inside out", hint="Turn its normals, then export it.")


def solid_stock(
    path: Path, cell_mm: float | None, default_mm: Callable[[float], float], turned: str = ""
) -> Stock:
    """Return the body in an STL file, seen from above: what lies under an overhang counts as full.

    It is turned over about the axis `turned`, `x` or `y`, through its middle: it lies where it was, its bottom on top.

    Raises:
        UsageError: no such file, no closed surface, or too many cells.
    """
    surface, box = _placed(path, turned)
    stock = Stock(box, cell_mm or default_mm(box.across_mm))
    stock.heights[...] = stock.grid.bottom
    grid = stock.grid
    draw(np.ascontiguousarray(surface.vertices[surface.faces]), grid.x0, grid.y0, grid.cell_mm, grid.z)
    return stock


def solid_voxels(
    path: Path, cell_mm: float | None, default_mm: Callable[[float], float], turned: str = ""
) -> Voxels:
    """Return the body in an STL file for tools that come from any side, with what is hollow in it.

    Raises:
        UsageError: no such file, no closed surface, or too many cells.
    """
    surface, box = _placed(path, turned)
    size = max(b - a for a, b in zip(box.low, box.high, strict=True))
    found = Voxels(box, cell_mm or default_mm(size))
    found.name = f"'{path.name}'"
    draw_cells(np.ascontiguousarray(surface.vertices[surface.faces]), found)
    return found


def draw_cells(triangles: npt.NDArray[np.float64], body: Voxels) -> None:
    """Fill the cells of a body by what is within a closed surface [n, 3, 3], whatever they were."""
    height, _, width = body.cells.shape
    strip = max(1, _MOST_SHARES // (height * width))
    for first in range(0, body.cells.shape[1], strip):
        cells = body.cells[:, first : first + strip]
        shares = np.zeros(cells.shape, np.float32)
        fill(triangles, body.first + (0.0, first * body.cell_mm, 0.0), body.cell_mm, shares)
        shares = np.cumsum(shares[::-1], axis=0)[::-1]
        cells[...] = np.rint(np.clip(shares / _RAYS**2, 0.0, 1.0) * FULL)


def _placed(path: Path, turned: str) -> tuple[Mesh, Box]:
    """Return the closed surface in a file, turned over if that is said, and the box around it."""
    surface = read_stl(path)
    check_closed(path, surface)
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    if turned:
        across = [1, 2] if turned == "x" else [0, 2]
        surface.vertices[:, across] = (low + high - surface.vertices)[:, across]
    (x0, y0, z0), (x1, y1, z1) = low.tolist(), high.tolist()
    return surface, Box((x0, y0, z0), (x1, y1, z1))


@entry(steps=lambda triangles, *_: 50 * len(triangles))
def fill(
    triangles: npt.NDArray[np.float64],
    first: npt.NDArray[np.float64],
    cell_mm: float,
    shares: npt.NDArray[np.float32],
) -> None:
    """Add up where upright rays, some through each cell, leave and enter a closed surface [n, 3, 3].

    `shares` [nz, ny, nx] summed from the top down are how many rays of a cell are inside, in part at its ends.
    """
    nz, ny, nx = shares.shape
    step = cell_mm / _RAYS
    # Beside the middle by a little: rays through edges would count twice.
    x0, y0 = (
        first[0] - 0.5 * (cell_mm - step) + _ASIDE * step,
        first[1] - 0.5 * (cell_mm - step) - _ASIDE * step,
    )
    for n in range(triangles.shape[0]):
        ax, ay, az = triangles[n, 0, 0], triangles[n, 0, 1], triangles[n, 0, 2]
        bx, by, bz = triangles[n, 1, 0], triangles[n, 1, 1], triangles[n, 1, 2]
        cx, cy, cz = triangles[n, 2, 0], triangles[n, 2, 1], triangles[n, 2, 2]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0.0:
            continue
        first_x = max(0, int(np.ceil((min(ax, bx, cx) - x0) / step)))
        last_x = min(nx * _RAYS - 1, int(np.floor((max(ax, bx, cx) - x0) / step)))
        first_y = max(0, int(np.ceil((min(ay, by, cy) - y0) / step)))
        last_y = min(ny * _RAYS - 1, int(np.floor((max(ay, by, cy) - y0) / step)))
        for iy in range(first_y, last_y + 1):
            y = y0 + iy * step
            for ix in range(first_x, last_x + 1):
                x = x0 + ix * step
                u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
                v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
                w = 1.0 - u - v
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                up = (u * az + v * bz + w * cz - first[2]) / cell_mm + 0.5
                iz = min(nz - 1, max(0, int(np.floor(up))))
                part = min(1.0, max(0.0, up - iz))
                sign = 1.0 if area > 0.0 else -1.0
                shares[iz, iy // _RAYS, ix // _RAYS] += sign * part
                if iz > 0:
                    shares[iz - 1, iy // _RAYS, ix // _RAYS] += sign * (1.0 - part)


@entry(steps=lambda triangles, *_: 50 * len(triangles))
def draw(
    triangles: npt.NDArray[np.float64], x0: float, y0: float, cell_mm: float, z: npt.NDArray[np.float64]
) -> None:
    """Raise each cell of a field to the highest of the triangles [n, 3, 3] over its middle."""
    for n in range(triangles.shape[0]):
        ax, ay, az = triangles[n, 0, 0], triangles[n, 0, 1], triangles[n, 0, 2]
        bx, by, bz = triangles[n, 1, 0], triangles[n, 1, 1], triangles[n, 1, 2]
        cx, cy, cz = triangles[n, 2, 0], triangles[n, 2, 1], triangles[n, 2, 2]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area <= 0.0:  # upright, or seen from below
            continue
        first_x = max(0, int(np.ceil((min(ax, bx, cx) - x0) / cell_mm - 1e-9)))
        last_x = min(z.shape[1] - 1, int(np.floor((max(ax, bx, cx) - x0) / cell_mm + 1e-9)))
        first_y = max(0, int(np.ceil((min(ay, by, cy) - y0) / cell_mm - 1e-9)))
        last_y = min(z.shape[0] - 1, int(np.floor((max(ay, by, cy) - y0) / cell_mm + 1e-9)))
        for iy in range(first_y, last_y + 1):
            y = y0 + iy * cell_mm
            for ix in range(first_x, last_x + 1):
                x = x0 + ix * cell_mm
                u = ((bx - x) * (cy - y) - (cx - x) * (by - y)) / area
                v = ((cx - x) * (ay - y) - (ax - x) * (cy - y)) / area
                w = 1.0 - u - v
                if u >= -1e-12 and v >= -1e-12 and w >= -1e-12:
                    z[iy, ix] = max(z[iy, ix], u * az + v * bz + w * cz)
