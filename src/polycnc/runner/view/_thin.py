"""Thin a curve over time so that it stays within a tolerance of every row: corners and ramps stay."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


def kept_rows(time: Floats, values: Floats, forced: Flags | None = None) -> Flags:
    """Return which rows to keep, so that straight lines over time between them miss no value by more than 1.

    `values` is [rows, columns], in tolerances; `time` rises. The first and the last row are kept, and those that
    `forced` marks. This is the method of Douglas and Peucker with the distance at equal times, so that
    a point between two kept rows is where the tool is at that moment. All open stretches are split at once.
    """
    rows = len(time)
    kept = np.zeros(rows, np.bool_) if forced is None else forced.copy()
    kept[:1] = kept[-1:] = True
    bounds = np.flatnonzero(kept)
    first, last = bounds[:-1], bounds[1:]
    while len(first := first[open_ := last - first > 1]):
        last = last[open_]
        inner = last - first - 1
        begin = np.concatenate((np.zeros(1, np.int64), np.cumsum(inner)[:-1]))
        row = np.arange(int(inner.sum())) + np.repeat(first + 1 - begin, inner)
        share = (time[row] - np.repeat(time[first], inner)) / np.repeat(time[last] - time[first], inner)
        miss = np.zeros(len(row))
        for column in values.T:
            chord = np.repeat(column[last] - column[first], inner)
            np.maximum(miss, np.abs(column[row] - np.repeat(column[first], inner) - share * chord), out=miss)
        worst = np.maximum.reduceat(miss, begin)
        at_worst = np.flatnonzero(miss == np.repeat(worst, inner))
        split = row[at_worst[np.searchsorted(at_worst, begin)]]
        missed = worst > 1.0
        first, split, last = first[missed], split[missed], last[missed]
        kept[split] = True
        first, last = np.stack((first, split), 1).ravel(), np.stack((split, last), 1).ravel()
    return kept
