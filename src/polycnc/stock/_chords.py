"""From the tool's places in each control cycle to chords: as few straight moves as stay within a tolerance."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

MOST_ROWS = 64
"""Of one chord: every place between its ends is compared with it again when it grows."""


@compiled
def _distance2(place: Floats, begin: Floats, end: Floats) -> float:
    """Return the square of the distance of a place from the chord between two others (mm2)."""
    along, length2 = 0.0, 0.0
    for i in range(begin.shape[0]):
        step = end[i] - begin[i]
        along += (place[i] - begin[i]) * step
        length2 += step * step
    share = min(1.0, max(0.0, along / length2)) if length2 > 0.0 else 0.0
    found = 0.0
    for i in range(begin.shape[0]):
        missed = place[i] - begin[i] - share * (end[i] - begin[i])
        found += missed * missed
    return found


@compiled
def _fits(places: Floats, begin: int, end: int, tolerance2: float) -> bool:
    for at in range(begin + 1, end):
        missed2 = _distance2(places[at], places[begin], places[end])
        if missed2 > tolerance2:
            return False
    return True


@entry(steps=lambda places, *_: 20 * len(places))
def find_chords(places: Floats, keys: Integers, tolerance_mm: float, ends: Integers) -> int:
    """Write the row of each chord's end into `ends` [at least rows]; return how many chords there are.

    `places` [rows, 3 or more] is where the tool is (mm), and more points of it; the first chord begins at row 0. A
    chord lies within one value of `keys` [rows], the key of the row at its end.
    """
    tolerance2 = tolerance_mm * tolerance_mm
    count, begin, end = 0, 0, 0
    for at in range(1, places.shape[0]):
        goes_on = end > begin and keys[at] == keys[end] and at - begin <= MOST_ROWS
        if end > begin and not (goes_on and _fits(places, begin, at, tolerance2)):
            ends[count] = end
            count += 1
            begin = end
        end = at
    if end > begin:
        ends[count] = end
        count += 1
    return count


@compiled
def chord(begin: Floats, end: Floats) -> tuple[float, float, float, float]:
    """Return the level length of a chord (mm), its direction in the plane, and its slope.

    A chord straight down or up has length 0 and the direction of x.
    """
    dx, dy = end[0] - begin[0], end[1] - begin[1]
    length = math.sqrt(dx * dx + dy * dy)
    if length < 1e-9:
        return 0.0, 1.0, 0.0, 0.0
    return length, dx / length, dy / length, (end[2] - begin[2]) / length
