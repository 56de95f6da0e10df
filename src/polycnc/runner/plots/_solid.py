"""The body that a run has cut, shaded, in place of the lines of its path."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from polycnc.stock import Stock

Floats = npt.NDArray[np.float64]

_MOST_ACROSS = 150  # cells along a side, so that a picture takes a second
_RAW, _CUT = (0.72, 0.75, 0.79), (0.93, 0.76, 0.45)
_LAMP = np.array((-0.45, -0.6, 1.0)) / np.linalg.norm((-0.45, -0.6, 1.0))
_AMBIENT = 0.45


def draw_solid(axes: Any, stock: Stock, zero: tuple[float, float, float]) -> None:
    """Draw what is left of a body, `zero` (mm) in machine coordinates is its own; what was cut has a colour."""
    from matplotlib.ticker import MaxNLocator

    grid = stock.grid
    several = max(1, -(-max(grid.z.shape) // _MOST_ACROSS))
    heights = grid.z[::several, ::several]
    x, y = (grid.x[::several] + zero[0], grid.y[::several] + zero[1])
    top, bottom = float(stock.box.high[2]), grid.bottom
    x = np.concatenate((x[:1], x, x[-1:]))  # upright sides
    y = np.concatenate((y[:1], y, y[-1:]))
    z = np.pad(np.pad(heights, 0, mode="edge"), 1, constant_values=bottom)
    z[1:-1, 1:-1] = heights
    mesh_x, mesh_y = np.meshgrid(x, y)
    axes.plot_surface(
        mesh_x, mesh_y, z + zero[2],
        facecolors=_shaded(mesh_x, mesh_y, z, top), rcount=len(y), ccount=len(x), shade=False, linewidth=0.0,
        antialiased=False,
    )  # fmt: skip
    low = np.array(stock.box.low) + zero
    high = np.array(stock.box.high) + zero
    sides = high - low
    for name, label, first, last in zip("xyz", "XYZ", low, high, strict=True):
        getattr(axes, f"set_{name}label")(f"{label} [mm]", labelpad=12)
        getattr(axes, f"set_{name}lim")(first, last)
    axes.zaxis.set_major_locator(MaxNLocator(3))
    axes.set_axisbelow(True)
    axes.set_box_aspect(np.maximum(sides, 0.08 * sides.max()), zoom=0.9)
    axes.view_init(elev=38, azim=-58)
    axes.set_title("What is left of the stock", loc="left")


def _shaded(x: Floats, y: Floats, z: Floats, top: float) -> Floats:
    """Return the colour of each face by how it lies to the lamp, and whether it was cut."""
    along = np.stack((np.diff(x, axis=1)[:-1], np.zeros_like(z[:-1, 1:]), np.diff(z, axis=1)[:-1]), axis=-1)
    across = np.stack(
        (np.zeros_like(z[1:, :-1]), np.diff(y, axis=0)[:, :-1], np.diff(z, axis=0)[:, :-1]), axis=-1
    )
    normal = np.cross(along, across)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    lit = np.abs(np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0) @ _LAMP)
    outside = np.zeros(lit.shape, np.bool_)
    outside[[0, -1], :] = outside[:, [0, -1]] = True
    lowest = np.minimum(np.minimum(z[:-1, :-1], z[1:, 1:]), np.minimum(z[:-1, 1:], z[1:, :-1]))
    cut = (lowest < top - 1e-6) & ~outside
    colours = np.where(cut[..., None], _CUT, _RAW) * (_AMBIENT + (1.0 - _AMBIENT) * lit[..., None])
    shaded: Floats = np.ones((*z.shape, 4))
    shaded[:-1, :-1, :3] = colours
    return shaded
