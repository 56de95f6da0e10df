"""Keep the speed between corners that are close together so low that a part of the way is not spent on ramps.

As a control with a minimum cruise ratio does it, the path is planned a second time with a lower acceleration. Where
that plan goes up and down again without reaching its speed, its peak bounds the speed of the whole rise and fall; the
ramps themselves keep the full acceleration. In the fall a segment is not traversed faster than it is entered.

A bound may rise as long as segments are appended behind: it is final before the last rise but one that is known. All
passes work on squared speeds. Units: those of `_segments`.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._jit import compiled
from polycnc.kernel._path import Paths, slot
from polycnc.kernel._segments import Segments


@compiled
def first_open(path: np.void, first: int) -> int:
    """Return the count from which on the bounds of a path are to be found anew when segments from `first` on change."""
    if path["low_accel_mm_s2"] <= 0.0:
        return first
    return int(max(path["head"], min(first, path["cruising"])))


@compiled
def _low_gain(path: np.void, row: np.void) -> float:
    return float(2.0 * min(path["low_accel_mm_s2"], row["full_accel"]) * row["length"])


@compiled
def _gain(row: np.void) -> float:
    return float(2.0 * row["full_accel"] * row["length"])


@compiled
def _rise(seg: Segments, paths: Paths, g: int, first: int, known: int) -> None:
    """Set the squared speeds that segments from count `first` on can have at their starts, coming from before.

    Those before `known` have been set once.
    """
    path = paths.row[g]
    for count in range(first, int(path["prepared"])):
        row = seg.row[slot(paths, g, count)]
        if count > path["head"]:
            last = seg.row[slot(paths, g, count - 1)]
            limit = last["junction"] * last["junction"]
            row["kept_in"] = min(limit, last["kept_in"] + _gain(last))
            row["kept_out"] = min(limit, last["kept_out"] + _low_gain(path, last))
        elif count >= known:  # it begins at rest
            row["kept_in"] = 0.0
            row["kept_out"] = 0.0


@compiled
def limit_cruise(seg: Segments, paths: Paths, g: int, first: int, known: int) -> None:
    """Lower caps and junctions of the segments from count `first` on; those before `known` are not new."""
    path = paths.row[g]
    if path["low_accel_mm_s2"] <= 0.0:
        return
    tail = int(path["prepared"])
    _rise(seg, paths, g, first, known)
    final = first
    peaks, falling = 0, 0
    peak, out, low_out = 0.0, 0.0, 0.0
    for count in range(tail - 1, first - 1, -1):
        row = seg.row[slot(paths, g, count)]
        low_gain = _low_gain(path, row)
        reach, low_reach = out + _gain(row), low_out + low_gain
        start, low_start = min(row["kept_in"], reach), min(row["kept_out"], low_reach)
        if low_start < low_reach:
            if low_start + low_gain > low_out or falling > 0:
                peaks += 1
                if peaks == 2:
                    final = count
                peak = min(row["cap"] * row["cap"], 0.5 * (low_start + low_reach))
                for other in range(count + 1, count + 1 + falling):
                    later = seg.row[slot(paths, g, other)]
                    later["cap"] = min(later["cap"], math.sqrt(peak))
                falling = 0
            row["cap"] = min(row["cap"], math.sqrt(peak))
        else:
            falling += 1
            row["cap"] = min(row["cap"], math.sqrt(start))
        out, low_out = start, low_start
    if path["closed"] != 0 and tail == path["tail"]:
        final = tail
    path["cruising"] = final
    for count in range(max(first - 1, int(path["head"])), tail - 1):
        row, after = seg.row[slot(paths, g, count)], seg.row[slot(paths, g, count + 1)]
        row["junction"] = min(row["junction"], row["cap"], after["cap"])
