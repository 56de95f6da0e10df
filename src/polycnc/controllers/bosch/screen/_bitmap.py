"""Bitmap files on the dialog window (Manual 003, 8.10)."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.controllers.bosch.screen._surface import HEIGHT, SOFTKEY_ROWS, WIDTH, Surface

Image: TypeAlias = npt.NDArray[np.uint8]
"""Red, green and blue by [row from the top, column]."""
_LARGEST = 4096
# How the bitmap (source) goes onto the window (target), by the copy type.
COPY_TYPES: tuple[Callable[[Image, Image], Image], ...] = (
    lambda source, target: source,
    lambda source, target: np.full_like(source, 255),
    lambda source, target: np.zeros_like(source),
    lambda source, target: source | target,
    lambda source, target: source & target,
    lambda source, target: source ^ target,
    lambda source, target: source & ~target,
    lambda source, target: ~source,
    lambda source, target: ~source & ~target,
)


def read_bitmap(path: Path) -> Image | None:
    """Read an uncompressed bitmap file of 8, 24 or 32 bits a pixel; None if it is none."""
    try:
        content = path.read_bytes()
        kind, start, header, width, height, planes, depth, packing = struct.unpack_from(
            "<2s8xIIiiHHI", content
        )
    except (OSError, struct.error):
        return None
    rows = abs(height)
    known = kind == b"BM" and planes == 1 and depth in (8, 24, 32) and packing == 0
    if not known or not (0 < width <= _LARGEST and 0 < rows <= _LARGEST):
        return None
    stride = (width * depth // 8 + 3) // 4 * 4
    if len(content) < start + rows * stride:
        return None
    lines = np.frombuffer(content, np.uint8, rows * stride, start).reshape(rows, stride)
    if height > 0:
        lines = lines[::-1]  # the bottom row comes first
    if depth == 8:
        palette = np.frombuffer(content[14 + header : start].ljust(1024, b"\0")[:1024], np.uint8).reshape(
            256, 4
        )
        pixels = palette[lines[:, :width]]
    else:
        pixels = lines[:, : width * depth // 8].reshape(rows, width, depth // 8)
    return np.ascontiguousarray(pixels[:, :, 2::-1])


def paint(surface: Surface, x: int, y: int, image: Image, copy_type: int) -> None:
    """Copy an image onto the window, its upper left pixel at (x, y) of the graphics, in the nearest colours."""
    top = y + SOFTKEY_ROWS
    rows, columns = min(image.shape[0], top + 1), min(image.shape[1], WIDTH - x)
    place = np.s_[HEIGHT - 1 - top : HEIGHT - 1 - top + rows, x : x + columns]
    table = np.array(surface.tables[surface.table], np.uint8)
    target = surface.pixels[::-1][place]
    result = COPY_TYPES[copy_type](image[:rows, :columns], table[np.maximum(target, 0)])
    distance = ((result[:, :, None, :].astype(np.int32) - table) ** 2).sum(axis=3)
    target[:] = distance.argmin(axis=2)
