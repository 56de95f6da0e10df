"""Chamfers and roundings between two straight moves: the first is held until the second is known."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from polycnc.nc.blocks._moves import Arc, GeometryError, Line, Move, Point

_STRAIGHT_RAD = 1e-9


@dataclass(frozen=True, slots=True)
class Corner:
    """A straight move that ends in a chamfer (`size_mm` from the corner on both sides) or a rounding (its radius).

    `word` is the word that asks for it.
    """

    move: Line
    size_mm: float
    rounds: bool
    word: str


def joined(corner: Corner, after: Line, plane: tuple[int, int, int]) -> list[Move]:
    """Return the held move, the corner, and the move after it, in a plane (axes first, second, normal).

    Raises:
        GeometryError: the corner is larger than a move, or the moves turn back on the spot.
    """
    p, q = plane[:2]
    at = corner.move.end
    back, back_length = _way(at, corner.move.start, p, q)
    ahead, ahead_length = _way(at, after.end, p, q)
    if back_length == 0.0 or ahead_length == 0.0:
        raise GeometryError(
            f"{corner.word} beside a move that does not move in the plane", "Write the corner without it."
        )
    angle = math.acos(max(-1.0, min(1.0, back[0] * ahead[0] + back[1] * ahead[1])))
    if angle < _STRAIGHT_RAD:
        raise GeometryError(f"{corner.word} where the path turns back", "Remove it.")
    if angle > math.pi - _STRAIGHT_RAD:
        return [corner.move, after]
    reach = corner.size_mm / math.tan(0.5 * angle) if corner.rounds else corner.size_mm
    if reach > min(back_length, ahead_length) * (1.0 + 1e-12):
        raise GeometryError(
            f"{corner.word} needs {reach:.6g} mm of both moves, and one has {min(back_length, ahead_length):.6g} mm",
            "Give a smaller one.",
        )
    begin, end = (_along(at, p, q, way, reach) for way in (back, ahead))
    first = replace(corner.move, end=begin)
    last = replace(after, start=end)
    if not corner.rounds:
        between: Move = replace(corner.move, start=begin, end=end)
        return [first, between, last]
    middle = corner.size_mm / math.sin(0.5 * angle) / math.hypot(back[0] + ahead[0], back[1] + ahead[1])
    center = at[p] + middle * (back[0] + ahead[0]), at[q] + middle * (back[1] + ahead[1])
    turns_left = -back[0] * ahead[1] + back[1] * ahead[0] > 0.0
    sweep = (math.pi - angle) if turns_left else (angle - math.pi)
    move = corner.move
    return [
        first,
        Arc(begin, end, center, sweep, plane, move.feed, move.exact_stop, move.line, move.tag),
        last,
    ]


def _way(start: Point, end: Point, p: int, q: int) -> tuple[tuple[float, float], float]:
    """Return the direction from one point to another in the plane, and how far it is."""
    dp, dq = end[p] - start[p], end[q] - start[q]
    length = math.hypot(dp, dq)
    return ((dp / length, dq / length) if length else (0.0, 0.0)), length


def _along(point: Point, p: int, q: int, way: tuple[float, float], reach: float) -> Point:
    moved = list(point)
    moved[p] += way[0] * reach
    moved[q] += way[1] * reach
    return tuple(moved)
