"""How far two polylines lie apart: exactly between their points too, and whether both are traversed in one order.

The greatest distance is found by bounds: the distance to one segment is convex along a line, and that to a whole
polyline changes by no more than one goes. A stretch whose bound is below what was found already is left; any other
is halved.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.jit import compiled, entry

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

PRECISION_MM = 1e-6
"""Greatest distances are found to this."""

_LEAF = 8  # segments of a box at the bottom of the tree
_DEPTH = 64  # of halvings, and of the walk down the tree


class Boxes:
    """Segments in a tree of boxes, in their order: neighbours along a path are neighbours in space."""

    def __init__(self, start: Floats, end: Floats) -> None:
        self.start, self.end = np.ascontiguousarray(start), np.ascontiguousarray(end)
        count, width = start.shape
        leaves = 1
        while leaves * _LEAF < count:
            leaves *= 2
        low = np.full((leaves * _LEAF, width), np.inf)
        high = np.full((leaves * _LEAF, width), -np.inf)
        low[:count], high[:count] = np.minimum(start, end), np.maximum(start, end)
        levels = [(low.reshape(leaves, _LEAF, width).min(1), high.reshape(leaves, _LEAF, width).max(1))]
        while len(levels[0][0]) > 1:
            under_low, under_high = levels[0]
            half = len(under_low) // 2
            pairs = (half, 2, width)
            levels.insert(0, (under_low.reshape(pairs).min(1), under_high.reshape(pairs).max(1)))
        self.low = np.concatenate([level[0] for level in levels])
        self.high = np.concatenate([level[1] for level in levels])


def greatest_distance(start: Floats, end: Floats, boxes: Boxes) -> tuple[float, int, float]:
    """Return how far the segments from `start` to `end` go from those in `boxes`, on which, and at which part of it."""
    distance, segment, part = farthest(
        np.ascontiguousarray(start),
        np.ascontiguousarray(end),
        boxes.start,
        boxes.end,
        boxes.low,
        boxes.high,
        PRECISION_MM,
    )
    return float(distance), int(segment), float(part)


@compiled
def _to_segment(point: Floats, start: Floats, end: Floats, at: int) -> float:
    square = 0.0
    along = 0.0
    for k in range(len(point)):
        way = end[at, k] - start[at, k]
        square += way * way
        along += way * (point[k] - start[at, k])
    part = 0.0
    if square > 0.0:
        part = min(max(along / square, 0.0), 1.0)
    found = 0.0
    for k in range(len(point)):
        off = point[k] - start[at, k] - part * (end[at, k] - start[at, k])
        found += off * off
    return np.sqrt(found)  # type: ignore[no-any-return]


@compiled
def _to_box(point: Floats, low: Floats, high: Floats, node: int) -> float:
    found = 0.0
    for k in range(len(point)):
        off = max(low[node, k] - point[k], point[k] - high[node, k], 0.0)
        found += off * off
    return np.sqrt(found)  # type: ignore[no-any-return]


@compiled
def _nearest(
    point: Floats, start: Floats, end: Floats, low: Floats, high: Floats, guess: int, stack: Indices
) -> tuple[float, int]:
    """Return how far the nearest segment is, and which it is; a good `guess` spares most of the way."""
    leaves = (len(low) + 1) // 2
    best = _to_segment(point, start, end, guess)
    which = guess
    stack[0] = 0
    held = 1
    while held:
        held -= 1
        node = stack[held]
        if _to_box(point, low, high, node) >= best:
            continue
        if node >= leaves - 1:
            first = (node - (leaves - 1)) * 8
            for at in range(first, min(first + 8, len(start))):
                here = _to_segment(point, start, end, at)
                if here < best:
                    best, which = here, at
            continue
        left, right = 2 * node + 1, 2 * node + 2
        if _to_box(point, low, high, left) > _to_box(point, low, high, right):
            left, right = right, left
        stack[held] = right
        stack[held + 1] = left  # the nearer one is looked at first
        held += 2
    return best, which


@entry(steps=lambda a_start, a_end, b_start, *_: 40 * (len(a_start) + len(b_start)))
def farthest(
    a_start: Floats,
    a_end: Floats,
    b_start: Floats,
    b_end: Floats,
    low: Floats,
    high: Floats,
    precision: float,
) -> tuple[float, int, float]:
    """Return the greatest distance of segments a from segments b, the segment of a, and the part of it (0 to 1)."""
    width = a_start.shape[1]
    stack = np.empty(128, np.int64)
    part0, part1 = np.empty(64), np.empty(64)
    at0, at1 = np.empty(64), np.empty(64)
    near0, near1 = np.empty(64, np.int64), np.empty(64, np.int64)
    here, first, last = np.empty(width), np.empty(width), np.empty(width)
    worst, where, where_part = -1.0, 0, 0.0
    guess = 0
    for i in range(len(a_start)):
        length = 0.0
        for k in range(width):
            first[k] = a_start[i, k]
            last[k] = a_end[i, k]
            way = last[k] - first[k]
            length += way * way
        length = np.sqrt(length)
        distance, guess = _nearest(first, b_start, b_end, low, high, guess, stack)
        part0[0], at0[0], near0[0] = 0.0, distance, guess
        if distance > worst:
            worst, where, where_part = distance, i, 0.0
        distance, guess = _nearest(last, b_start, b_end, low, high, guess, stack)
        part1[0], at1[0], near1[0] = 1.0, distance, guess
        if distance > worst:
            worst, where, where_part = distance, i, 1.0
        held = 1
        while held:
            held -= 1
            p0, p1, d0, d1, n0, n1 = part0[held], part1[held], at0[held], at1[held], near0[held], near1[held]
            if (d0 + d1 + (p1 - p0) * length) * 0.5 <= worst + precision:
                continue
            if n0 == n1:
                continue  # nearest to one segment at both ends: nowhere farther between them
            for k in range(width):
                here[k] = first[k] + p1 * (last[k] - first[k])
            if max(d0, _to_segment(here, b_start, b_end, n0)) <= worst + precision:
                continue
            for k in range(width):
                here[k] = first[k] + p0 * (last[k] - first[k])
            if max(d1, _to_segment(here, b_start, b_end, n1)) <= worst + precision:
                continue
            middle = 0.5 * (p0 + p1)
            for k in range(width):
                here[k] = first[k] + middle * (last[k] - first[k])
            distance, found = _nearest(here, b_start, b_end, low, high, n0, stack)
            if distance > worst:
                worst, where, where_part = distance, i, middle
            if held + 2 <= 64:
                part0[held], at0[held], near0[held] = middle, distance, found
                part1[held], at1[held], near1[held] = p1, d1, n1
                part0[held + 1], at0[held + 1], near0[held + 1] = p0, d0, n0
                part1[held + 1], at1[held + 1], near1[held + 1] = middle, distance, found
                held += 2
    return worst, where, where_part


@compiled
def _free(point: Floats, path: Floats, at: int, reach: float) -> tuple[float, float]:
    """Return the part of a segment within reach of a point, from and to; from above to where there is none."""
    square, along, off = 0.0, 0.0, 0.0
    for k in range(len(point)):
        way = path[at + 1, k] - path[at, k]
        from_start = point[k] - path[at, k]
        square += way * way
        along += way * from_start
        off += from_start * from_start
    if square == 0.0:
        return (0.0, 1.0) if off <= reach * reach else (2.0, -1.0)
    middle = along / square
    inside = middle * middle - (off - reach * reach) / square
    if inside < 0.0:
        return 2.0, -1.0
    half = np.sqrt(inside)
    low, high = max(middle - half, 0.0), min(middle + half, 1.0)
    return (low, high) if low <= high else (2.0, -1.0)


@entry(steps=lambda a, b, reach: len(a) * len(b))
def in_one_order(a: Floats, b: Floats, reach: float) -> tuple[bool, int, int]:
    """Say whether two polylines can be traversed together, never back, and never farther apart than `reach`.

    This is the decision of Alt and Godau for the distance of Fréchet. Where the answer is no, the numbers are the
    segments up to which it goes.
    """
    rows, columns = len(a) - 1, len(b) - 1
    here_low, here_high = (
        np.full(columns, 2.0),
        np.full(columns, -1.0),
    )  # what is reached of each b at the row's foot
    next_low, next_high = np.full(columns, 2.0), np.full(columns, -1.0)
    here, following = np.empty(columns, np.int64), np.empty(columns, np.int64)
    held = 0
    best_row, best_column = 0, 0
    for column in range(columns):  # along b, while a stands at its start
        low, high = _free(a[0], b, column, reach)
        if low > 0.0 or high < low:
            break
        here_low[column], here_high[column] = low, high
        here[held] = column
        held += 1
        if high < 1.0:
            break
    if held == 0:
        return False, 0, 0
    for row in range(rows):
        count = 0
        place = 0
        left_low, left_high = 2.0, -1.0
        if row == 0 or here[0] == 0:
            low, high = _free(b[0], a, row, reach)
            if low == 0.0 and here_low[0] == 0.0 and here[0] == 0:
                left_low, left_high = low, high
        column = here[0]
        while column < columns:
            from_below = place < held and here[place] == column
            if from_below:
                below_low = here_low[column]
                place += 1
            elif left_low > left_high:  # a gap: on to the next column that is reached from below
                if place >= held:
                    break
                column = here[place]
                continue
            right_low, right_high = _free(b[column + 1], a, row, reach)
            top_low, top_high = _free(a[row + 1], b, column, reach)
            if not from_below:
                right_low = max(right_low, left_low)
            elif left_low > left_high:
                top_low = max(top_low, below_low)
            if top_low <= top_high:
                next_low[column], next_high[column] = top_low, top_high
                following[count] = column
                count += 1
            if row >= best_row:
                best_row, best_column = row, column
            left_low, left_high = right_low, right_high
            column += 1
        for k in range(held):
            here_low[here[k]], here_high[here[k]] = 2.0, -1.0
        if row == rows - 1:
            reached = count > 0 and following[count - 1] == columns - 1 and next_high[columns - 1] >= 1.0
            if not reached and left_low <= left_high and column == columns:
                reached = left_high >= 1.0
            return reached, best_row, best_column
        if count == 0:
            return False, best_row, best_column
        here_low, next_low = next_low, here_low
        here_high, next_high = next_high, here_high
        here, following = following, here
        held = count
    return True, best_row, best_column
