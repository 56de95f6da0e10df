"""The tip of a turning tool: programs say where an imaginary tip goes, compensation where the middle of its nose.

While compensation is active, each compensated point is moved by the way from the middle of the nose to that tip. So the
tip's position stays what the machine shows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from polycnc.nc.blocks._moves import Arc, Line, Move, Point

_RECENT = 8  # programmed ends that a stage may hold back, and more

TIPS: dict[int, tuple[float, float]] = {
    0: (0.0, 0.0),
    1: (1.0, 1.0),
    2: (1.0, -1.0),
    3: (-1.0, -1.0),
    4: (-1.0, 1.0),
    5: (0.0, 1.0),
    6: (1.0, 0.0),
    7: (0.0, -1.0),
    8: (-1.0, 0.0),
    9: (0.0, 0.0),
}
"""Way from the middle of the nose to the tip, along X and Z in radii of the nose, by the number of the tip."""


@dataclass(frozen=True, slots=True)
class TipShift:
    """Where compensated points are moved to: `vector` by axis (mm); `moved` tells whether the last end was."""

    vector: tuple[tuple[int, float], ...] = ()
    programmed: tuple[Point, ...] = ()
    moved: bool = False

    def with_programmed(self, end: Point) -> TipShift:
        """Return the same, knowing one more programmed end."""
        return replace(self, programmed=(*self.programmed, end)[-_RECENT:]) if self.vector else self

    def applied(self, item: Move) -> tuple[TipShift, Move]:
        """Return what is after a compensated move, and the move of the tip."""
        if not self.vector:
            return self, item
        plane = [axis for axis, _ in self.vector]
        ends = {tuple(point[axis] for axis in plane) for point in self.programmed}
        moves_end = tuple(item.end[axis] for axis in plane) not in ends
        start = self._moved(item.start) if self.moved else item.start
        end = self._moved(item.end) if moves_end else item.end
        after = replace(self, moved=moves_end)
        if isinstance(item, Line):
            return after, replace(item, start=start, end=end)
        return after, self._arc(item, start, end)

    def _arc(self, item: Arc, start: Point, end: Point) -> Arc:
        by = dict(self.vector)
        p, q = item.plane[:2]
        center = item.center[0] + by.get(p, 0.0), item.center[1] + by.get(q, 0.0)
        return replace(item, start=start, end=end, center=center)

    def _moved(self, point: Point) -> Point:
        changed = list(point)
        for axis, way in self.vector:
            changed[axis] += way
        return tuple(changed)
