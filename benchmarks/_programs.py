"""The part programs that the benchmarks run: as a CAM system writes them for a surface, of any length.

A layer is a wavy contour in short straight pieces, with an arc now and then; between layers the tool lifts, goes on
at rapid and plunges. G words are modal and written when they change.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

LAYER_BLOCKS = 5000
ARC_EVERY = 50
HEADER = "%\nO1000 (SURFACE)\nG21 G17 G40 G49 G80 G90 G94\nS12000 M3\nM8\n"
FOOTER = "G0 Z50.\nM9\nM5\nM30\n%\n"
_FIXED_BLOCKS = 8  # of header and footer


def write_program(path: Path, blocks: int) -> Path:
    """Write a program of `blocks` blocks, the same at every run; an existing file of that name is kept."""
    if path.exists():
        return path
    partial = path.with_suffix(".part")
    left = blocks - _FIXED_BLOCKS
    rng = np.random.default_rng(1)
    with partial.open("w", encoding="ascii", newline="\n") as file:
        file.write(HEADER)
        for layer in range(math.ceil(left / LAYER_BLOCKS)):
            lines = _layer(rng, layer, min(LAYER_BLOCKS, left - layer * LAYER_BLOCKS))
            file.write("\n".join(lines) + "\n")
        file.write(FOOTER)
    return partial.rename(path)


def _layer(rng: np.random.Generator, layer: int, blocks: int) -> list[str]:
    points = contour(rng, layer, LAYER_BLOCKS)
    centers = _centers(points)
    x, y, z = points[0]
    lines = ["G0 Z10.", f"X{x:.3f} Y{y:.3f}", f"G1 Z{z:.3f} F600."]
    feed = " F2400."
    straight = True
    for i, (x, y, z) in enumerate(points[1:].tolist(), start=1):
        if i % ARC_EVERY == 0:
            center_x, center_y = centers[i - 1]
            code = "G2" if i % (2 * ARC_EVERY) else "G3"
            lines.append(f"{code} X{x:.3f} Y{y:.3f} Z{z:.3f} I{center_x:.4f} J{center_y:.4f}")
        else:
            lines.append(f"{'' if straight else 'G1 '}X{x:.3f} Y{y:.3f} Z{z:.3f}{feed}")
            feed = ""
        straight = i % ARC_EVERY != 0
    return lines[:blocks]


def contour(rng: np.random.Generator, layer: int, points: int) -> Floats:
    """Return a wavy closed curve in steps of 0.05 to 2 mm, [points, 3], rounded as it will be written."""
    step = np.exp(rng.uniform(np.log(0.05), np.log(1.7), points))
    angle = np.cumsum(step) / 60.0  # about 60 mm from the middle
    radius = 60.0 + 5.0 * np.sin(5.0 * angle) + np.sin(13.0 * angle + layer)
    height = -0.05 * (layer % 400) + 0.5 * np.sin(5.0 * angle + 0.1 * layer)
    curve = np.column_stack((radius * np.cos(angle), radius * np.sin(angle), height))
    return np.asarray(np.round(curve, 3), dtype=np.float64)


def _centers(points: Floats) -> Floats:
    """Return for every step the centre of an arc over it, from its start, [points - 1, 2]; it lies to the right.

    The radius is the chord, so the centre is exact to the last digit that is written.
    """
    chord = np.diff(points[:, :2], axis=0)
    right = np.column_stack((chord[:, 1], -chord[:, 0]))
    right[2 * ARC_EVERY - 1 :: 2 * ARC_EVERY] *= -1.0  # counter-clockwise ones have it to the left
    return 0.5 * chord + math.sqrt(0.75) * right
