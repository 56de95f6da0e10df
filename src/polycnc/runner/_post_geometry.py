"""How far points lie from moves: lines, arcs and helices in space, many at a time."""

from __future__ import annotations

from array import array
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from polycnc.post import Sweep, Ways

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64] | npt.NDArray[np.int32]

_TWO_PI = 2.0 * np.pi
_NEWTON_STEPS = 6
_AT_ONCE = 1 << 16
_ARC_NUMBERS = 7  # centre, normal, angle
_RAPID, _KNOWN = 1, 2  # bits of what is known of a move
_KNOWN_FEED = bytes((_KNOWN,))
_WITNESSES = 8  # points of an arc that a program must pass


class Moves:
    """The moves of a tool path in arrays, in the order of its records.

    `first[r]` is the first move of record r, `first[r + 1]` the one after its last; `only_rapid` and `only_feed`
    tell of each record whether all its moves are, from points that are known. `axis` is the tool axis of each move,
    empty without `with_axes`; `lines` has the line of each record, if no move has another one.
    Most moves start where the one before ends, so starts are kept for the others alone.
    """

    def __init__(
        self,
        sweeps: Iterable[Sweep | Ways],
        records: int,
        with_axes: bool = False,
        lines: npt.NDArray[np.intc] | None = None,
    ) -> None:
        ends, axes, bends, jumps = array("d"), array("d"), array("d"), array("d")
        numbers, bent, jumped = array("i"), array("i"), array("i")
        own_lines = array("i") if lines is None else None
        flags = bytearray()
        here: tuple[float, ...] | None = None
        for move in sweeps:
            start = move.start
            if start != here or here is None:
                jumped.append(len(numbers))
                jumps.extend(start if start is not None else _end(move))
            if isinstance(move, Ways):
                count = len(move.ends)
                numbers.extend(range(move.record, move.record + count))
                if own_lines is not None:
                    own_lines.extend(range(move.line, move.line + count))
                flags.extend(_KNOWN_FEED * count)
                ends.frombytes(np.ascontiguousarray(move.ends).tobytes())
                here = tuple(move.ends[-1].tolist())
                if with_axes:
                    axes.extend(move.axis * count)
                continue
            if move.angle > 0.0:
                bent.append(len(numbers))
                bends.extend((*move.center, *move.normal, move.angle))
            ends.extend(move.end)
            numbers.append(move.record)
            if own_lines is not None:
                own_lines.append(move.line)
            flags.append((_RAPID if move.rapid else 0) | (_KNOWN if start is not None else 0))
            here = move.end
            if with_axes:
                axes.extend(move.axis)
        self.record = np.frombuffer(numbers, np.int32)
        self._lines = lines
        self._own_lines = own_lines
        self.end = np.frombuffer(ends, np.float64).reshape(-1, 3)
        self._jumped = np.frombuffer(jumped, np.int32)
        self._jumps = np.frombuffer(jumps, np.float64).reshape(-1, 3)
        marks = np.frombuffer(flags, np.uint8)
        self.rapid, self.known = (marks & _RAPID) != 0, (marks & _KNOWN) != 0
        self._bent = np.frombuffer(bent, np.int32)
        arcs = np.frombuffer(bends, np.float64).reshape(-1, _ARC_NUMBERS)
        self._center, self._normal, self._angle = arcs[:, 0:3], arcs[:, 3:6], arcs[:, 6]
        self.first = np.searchsorted(self.record, np.arange(records + 1, dtype=np.int32)).astype(np.int32)
        self.axis = np.frombuffer(axes, np.float64).reshape(-1, 3)
        self.only_rapid = np.ones(records, np.bool_)
        self.only_feed = np.zeros(records, np.bool_)
        used = np.flatnonzero(self.first[1:] > self.first[:-1])
        if len(used):
            begins = self.first[used]
            self.only_rapid[used] = np.logical_and.reduceat(self.rapid, begins)
            self.only_feed[used] = ~np.logical_or.reduceat(self.rapid | ~self.known, begins)

    def line(self, move: int) -> int:
        """Return the line of the tool path that a move stands on."""
        if self._own_lines is not None:
            return self._own_lines[move]
        assert self._lines is not None
        return int(self._lines[self.record[move]])

    def last_axes(self) -> tuple[Floats, npt.NDArray[np.bool_]]:
        """Return the tool axis with which each record ends, and whether it moves."""
        moving = self.first[1:] > self.first[:-1]
        axes = np.zeros((len(moving), 3))
        axes[moving] = self.axis[self.first[1:][moving] - 1]
        return axes, moving

    def length_mm(self) -> tuple[float, float]:
        """Return how far the moves with feed go, and the rapids."""
        feed = rapid = 0.0
        for begin in range(0, len(self.end), _AT_ONCE):
            piece = slice(begin, begin + _AT_ONCE)
            start = self.start(np.arange(begin, min(begin + _AT_ONCE, len(self.end)), dtype=np.int32))
            way = self.end[piece] - start
            lengths = _norm(way)
            arcs = np.arange(*np.searchsorted(self._bent, (begin, begin + _AT_ONCE)))
            bent = self._bent[arcs] - begin
            normal = self._normal[arcs]
            out = _across(start[bent] - self._center[arcs], normal)
            rise = (way[bent] * normal).sum(axis=1)
            lengths[bent] = np.hypot(self._angle[arcs] * _norm(out), rise)
            feed += float(lengths[~self.rapid[piece]].sum())
            rapid += float(lengths[self.rapid[piece]].sum())
        return feed, rapid

    def start(self, moves: Indices) -> Floats:
        """Return where moves start; an end where that is not known."""
        starts = self.end[np.maximum(moves - 1, 0)]
        places, found = _places(self._jumped, moves)
        starts[found] = self._jumps[places[found]]
        return starts

    def distances(self, points: Floats, moves: Indices) -> Floats:
        """Return how far each point lies from the move of the same place in `moves`."""
        found = to_segments(points, self.start(moves), self.end[moves])
        arcs, bent = _places(self._bent, moves)
        if bent.any():
            found[bent] = self._to_arcs(points[bent], moves[bent], arcs[bent])
        return found

    def _to_arcs(self, points: Floats, moves: Indices, slots: Indices) -> Floats:
        start, end, normal, center = (
            self.start(moves),
            self.end[moves],
            self._normal[slots],
            self._center[slots],
        )
        angle = self._angle[slots]
        out = _across(start - center, normal)
        size = np.sqrt((out * out).sum(axis=1))
        side = np.cross(normal, out)
        away = points - center
        flat = _across(away, normal)
        radius = np.sqrt((flat * flat).sum(axis=1))
        turned = np.arctan2((flat * side).sum(axis=1), (flat * out).sum(axis=1)) % _TWO_PI
        rise = ((end - start) * normal).sum(axis=1)
        height = ((points - start) * normal).sum(axis=1)
        end_size = _norm(_across(end - center, normal))
        slope = rise / angle
        with np.errstate(divide="ignore", invalid="ignore"):
            by_height = np.where(np.abs(rise) > 1e-9, height / slope, turned)
        turns = np.round((by_height - turned) / _TWO_PI)
        most = np.maximum(np.floor((angle - turned) / _TWO_PI), 0.0)
        found = np.minimum(_norm(points - start), _norm(points - end))
        # The nearest point has the direction of the point if the helix is flat, its height if it is steep.
        for first in (turned + _TWO_PI * np.clip(turns, 0.0, most), by_height):
            at = first
            for _ in range(_NEWTON_STEPS):
                off = at - turned
                pull = radius * size * np.sin(off) - slope * (height - slope * at)
                curve = radius * size * np.cos(off) + slope * slope
                at = np.where(curve > 0.0, at - pull / np.where(curve > 0.0, curve, 1.0), at)
            part = at / angle
            here = size + part * (end_size - size)
            off = at - turned
            flat_square = (radius - here) ** 2 + 4.0 * radius * here * np.sin(0.5 * off) ** 2
            away_square = flat_square + (height - slope * at) ** 2
            inside = (at >= 0.0) & (at <= angle)
            found = np.where(inside, np.minimum(found, np.sqrt(away_square)), found)
        return found

    def witnesses(self) -> tuple[Indices | None, Floats]:
        """Return points that a program must pass, with their moves: ends, and points along arcs.

        The moves are None without arcs: then each point is the end of the move of its place.
        """
        bent = self._bent
        if not len(bent):
            return None, self.end
        every = np.arange(len(self.end), dtype=np.int32)
        owner: list[npt.NDArray[np.int32]] = [every]
        points = [self.end]
        normal = self._normal
        start = self.start(bent)
        out = _across(start - self._center, normal)
        side = np.cross(normal, out)
        foot = start - out
        rise = ((self.end[bent] - start) * normal).sum(axis=1)[:, None]
        last = _norm(_across(self.end[bent] - self._center, normal))
        grow = (last / np.maximum(_norm(out), 1e-12))[:, None] - 1.0
        for number in range(1, _WITNESSES):
            part = number / _WITNESSES
            angle = (self._angle * part)[:, None]
            bow = (np.cos(angle) * out + np.sin(angle) * side) * (1.0 + part * grow)
            owner.append(bent)
            points.append(foot + bow + part * rise * normal)
        owners: npt.NDArray[np.int32] = np.concatenate(owner)
        order = np.argsort(owners, kind="stable")
        return owners[order], np.concatenate(points)[order]


def _end(move: Sweep | Ways) -> tuple[float, ...]:
    return move.end if isinstance(move, Sweep) else tuple(move.ends[0].tolist())


def _places(sparse: Indices, moves: Indices) -> tuple[Indices, npt.NDArray[np.bool_]]:
    """Return for moves their places in ascending numbers of moves, and whether they are among them."""
    places = np.minimum(np.searchsorted(sparse, moves), max(len(sparse) - 1, 0))
    return places, (sparse[places] == moves) if len(sparse) else np.zeros(len(moves), np.bool_)


def _across(way: Floats, normal: Floats) -> Floats:
    across: Floats = way - (way * normal).sum(axis=1)[:, None] * normal
    return across


def _norm(way: Floats) -> Floats:
    length: Floats = np.sqrt((way * way).sum(axis=1))
    return length


def to_segments(points: Floats, start: Floats, end: Floats) -> Floats:
    """Return how far each point lies from the segment of the same place."""
    way = end - start
    square = (way * way).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(square > 0.0, ((points - start) * way).sum(axis=1) / square, 0.0)
    return _norm(points - start - np.clip(part, 0.0, 1.0)[:, None] * way)
