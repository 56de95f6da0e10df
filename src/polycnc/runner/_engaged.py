"""How hard tools cut, line by line of the programs, as plain data."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.runner._blocks import Blocks
from polycnc.stock import Engagement

Floats = npt.NDArray[np.float64]
MOST = ("rate_mm3_s", "axial_mm", "radial_mm", "chip_mm")
"""What is said of all stretches, and of those of a line: the greatest of each."""


def engaged(found: Engagement, blocks: Blocks) -> dict[str, Any]:
    """Return the greatest figures of a run, and those of each line with its time and mean rate; null: not known."""
    whole = dict(zip(MOST, map(_known, found.most), strict=True))
    return {**whole, "by_line": _by_line(found, blocks)}


def _by_line(found: Engagement, blocks: Blocks) -> list[dict[str, Any]]:
    numbers, first, of = np.unique(found.block, return_index=True, return_inverse=True)
    lines: dict[tuple[str, int], int] = {}
    row = np.zeros(len(numbers), np.int64)
    for at in np.argsort(first, kind="stable").tolist():
        block = blocks[int(numbers[at])]
        row[at] = lines.setdefault((block.program, block.line), len(lines))
    of = row[of]
    seconds = np.bincount(of, found.duration_s, len(lines))
    volume = np.bincount(of, found.rate_mm3_s * found.duration_s, len(lines))
    columns = [_most(getattr(found, name), of, len(lines)) for name in MOST]
    return [
        {
            "program": program,
            "line": line,
            "cutting_s": float(seconds[n]),
            "mean_mm3_s": float(volume[n] / seconds[n]),
            **{name: _known(column[n]) for name, column in zip(MOST, columns, strict=True)},
        }
        for (program, line), n in lines.items()
    ]


def _most(values: Floats, of: npt.NDArray[np.int64], count: int) -> Floats:
    found = np.zeros(count)
    np.fmax.at(found, of, values)
    return found


def _known(value: float) -> float | None:
    return float(value) if value > 0.0 else None
