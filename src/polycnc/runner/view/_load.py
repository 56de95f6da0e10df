"""How hard tools cut, as a view shows it: in equal stretches of time."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.stock import Engagement

Floats = npt.NDArray[np.float64]

STRETCHES = 4_000


def loads(found: Engagement, end_s: float) -> tuple[dict[str, npt.NDArray[np.float32]], float]:
    """Return by name the mean rate (mm3/s), the greatest depth, width and chip (mm) of stretches, and their length (s).

    What is known nowhere is left out.
    """
    stretch_s = max(end_s, 1e-6) / STRETCHES
    begin_s = found.t_s - found.duration_s
    edges = np.column_stack((begin_s, found.t_s)).ravel()
    volume = np.cumsum(np.column_stack((np.zeros(len(begin_s)), found.rate_mm3_s * found.duration_s)).ravel())
    at = np.arange(STRETCHES + 1) * stretch_s
    rate = np.diff(np.interp(at, edges, volume)) / stretch_s if len(edges) else np.zeros(STRETCHES)
    first = np.clip((begin_s / stretch_s).astype(np.int64), 0, STRETCHES - 1)
    last = np.clip(np.ceil(found.t_s / stretch_s).astype(np.int64) - 1, first, STRETCHES - 1)
    counts = last - first + 1
    row = np.repeat(np.arange(len(first)), counts)
    stretch = np.repeat(first, counts) + np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
    columns = {"rate": rate}
    for name, values in (("axial", found.axial_mm), ("radial", found.radial_mm), ("chip", found.chip_mm)):
        columns[name] = np.zeros(STRETCHES)
        np.fmax.at(columns[name], stretch, values[row])
    return {name: each.astype(np.float32) for name, each in columns.items() if each.any()}, stretch_s
