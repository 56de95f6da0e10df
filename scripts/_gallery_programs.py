"""Programs of the gallery that are calculated: carved surfaces, and a picture that a laser burns."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Surface = Callable[[Floats, Floats], Floats]

_STEP_MM = 0.5
_TOLERANCE_MM = 0.01


def _dome(
    x: Floats, y: Floats, at: tuple[float, float], radius: tuple[float, float], height: float
) -> Floats:
    """Return the height of half an ellipsoid above 0; 0 beside it."""
    left = 1.0 - ((x - at[0]) / radius[0]) ** 2 - ((y - at[1]) / radius[1]) ** 2
    return height * np.sqrt(np.maximum(left, 0.0))


def bear(x: Floats, y: Floats) -> Floats:
    """Return the heights of a bear's head (mm): its highest place is 0, the ground lies at -12."""
    found: Floats = np.maximum.reduce(
        [
            np.zeros_like(x),
            _dome(x, y, (0.0, -2.0), (24.0, 22.0), 9.0),
            *(_dome(x, y, (side * 19.0, 18.0), (9.0, 9.0), 6.0) for side in (-1.0, 1.0)),
            _dome(x, y, (0.0, -9.0), (11.0, 9.0), 11.0),
            _dome(x, y, (0.0, -6.5), (4.0, 3.0), 12.0),
        ]
    )
    for side in (-1.0, 1.0):
        found -= np.minimum(found, _dome(x, y, (side * 8.5, 5.0), (3.4, 3.4), 2.5))
        found -= np.minimum(found, _dome(x, y, (side * 19.0, 18.5), (5.0, 5.0), 2.5))
    return found - 12.0


def bottle(x: Floats, y: Floats) -> Floats:
    """Return the heights of half a mould for a bottle that lies along X (mm), its parting plane at 0."""
    neck, shoulder = 4.5, 12.0
    share = np.clip((x - 8.0) / 14.0, 0.0, 1.0)
    radius = shoulder + (neck - shoulder) * share * share * (3.0 - 2.0 * share)
    radius = np.where(x < -30.0, shoulder - 4.0 + 4.0 * np.sqrt(np.clip((x + 34.0) / 4.0, 0.0, 1.0)), radius)
    radius = np.where((x < -34.0) | (x > 34.0), 0.0, radius)
    depth: Floats = -np.sqrt(np.maximum(radius**2 - y**2, 0.0))
    return depth


def _offset(heights: Floats, radius: float) -> Floats:
    """Return how low the tip of a ball gets at each point of a grid without cutting into the surface."""
    reach = int(radius / _STEP_MM)
    around = np.pad(heights, reach, mode="edge")
    found = np.full_like(heights, -np.inf)
    ny, nx = heights.shape
    for iy in range(-reach, reach + 1):
        for ix in range(-reach, reach + 1):
            left = radius**2 - (ix**2 + iy**2) * _STEP_MM**2
            if left >= 0.0:
                moved = around[reach + iy : reach + iy + ny, reach + ix : reach + ix + nx]
                found = np.maximum(found, moved - radius + np.sqrt(left))
    return found


def _thinned(x: Floats, z: Floats) -> Iterator[tuple[float, float]]:
    """Yield the points of a row that are needed."""
    begin = 0
    for end in range(2, len(x)):
        inside = np.interp(x[begin : end + 1], x[[begin, end]] if x[end] > x[begin] else x[[end, begin]],
                           z[[begin, end]] if x[end] > x[begin] else z[[end, begin]])  # fmt: skip
        if np.abs(inside - z[begin : end + 1]).max() > _TOLERANCE_MM:
            begin = end - 1
            yield float(x[begin]), float(z[begin])
    yield float(x[-1]), float(z[-1])


def carved(title: str, surface: Surface, half: tuple[float, float], diameter: float, deep: float) -> str:
    """Return a program that clears a surface by level rows, then follows it, to and fro along X."""
    x, y = (np.arange(-each, each + 0.5 * _STEP_MM, _STEP_MM) for each in half)
    heights = surface(*np.meshgrid(x, y))
    ball, rough = _offset(heights, 0.5 * diameter), _offset(heights, diameter)
    lines = ["%", f"({title})", f"(STOCK box={-half[0]:g},{-half[1]:g},{-deep:g},{half[0]:g},{half[1]:g},0)",
             f"(T1 D={2 * diameter:g} ball end mill)", f"(T2 D={diameter:g} ball end mill)",
             "G21 G90 G17 G94 G54"]  # fmt: skip
    for tool, tips, rows, left, feed in ((1, rough, 6, 0.4, 3000), (2, ball, 1, 0.0, 2400)):
        lines += [f"T{tool} M6", f"S{8000 * tool} M3", f"G0 X{x[0] - 12:g} Y{y[0]:g} Z10"]
        for number, at in enumerate(range(0, len(y), rows)):
            order = slice(None) if number % 2 == 0 else slice(None, None, -1)
            row_x, row_z = x[order], np.minimum(tips[at][order] + left, 2.0)
            lines.append(f"G1 X{row_x[0]:g} Y{y[at]:g} Z{row_z[0]:.3f} F{feed}")
            lines += [f"X{a:g} Z{b:.3f}" for a, b in _thinned(row_x, row_z)]
        lines.append("G0 Z10")
    return "\n".join([*lines, "G0 Z50 M5", "M30", "%", ""])


def burnt() -> str:
    """Return a program that burns the bear line by line, deeper where it is lower."""
    x, y = np.arange(-30.0, 30.01, 0.5), np.arange(-26.0, 28.01, 0.75)
    shades = np.rint((0.0 - bear(*np.meshgrid(x, y))) / 12.0 * 50.0) * 20.0
    lines = ["G21 G90", "M4 S0"]
    for number, row in enumerate(shades):
        order = slice(None) if number % 2 == 0 else slice(None, None, -1)
        at, power = x[order], row[order]
        lines.append(f"G0 X{at[0]:g} Y{y[number]:g}")
        ends = [*np.flatnonzero(np.diff(power)).tolist(), len(at) - 1]
        lines += [f"G1 X{at[end]:g} S{power[end]:g} F6000" for end in ends if end > 0]
    return "\n".join([*lines, "M5", "M2", ""])
