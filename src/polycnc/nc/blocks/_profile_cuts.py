"""The cuts of LinuxCNC's G70 to G72 along a profile: finishing passes, and roughing by levels, into pockets too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from polycnc.nc.blocks._moves import GeometryError
from polycnc.nc.blocks._profiles import NEAR, SHORT, Part, View, goes_on, moved_off, with_corners
from polycnc.nc.blocks._turning import MOST_PASSES

ALL, WITHOUT_POCKETS, POCKETS = 0, 1, 2
"""What roughing cuts: 71, 71.1 and 71.2."""
_FAR_DOWN = -1e9


@dataclass(frozen=True, slots=True)
class Cut:
    """A step of the tool: straight to `end`, as fast as it can with `rapid`, or on an arc about `center`."""

    end: complex
    rapid: bool = False
    center: complex | None = None
    ccw: bool = False


@dataclass(frozen=True, slots=True)
class Roughing:
    """Numbers of G71 and G72: what is cut, allowance, depth of a cut, retract, displacement of the profile."""

    what: int
    allowance: float
    depth: float
    retract: float
    displacement: complex


def finish(profile: Sequence[Part], first: float, last: float, passes: int) -> list[Cut]:
    """Return passes along a profile whose first part leads to it: the first `first` off it, the last one `last`.

    Raises:
        GeometryError: the profile goes back, or cannot be moved off so far.
    """
    view = View().falling(profile[1:])
    if not goes_on(view.seen(part) for part in profile[1:]):
        view = View(turned=True).falling(profile[1:])
        _check([view.seen(part) for part in profile[1:]])
    view = View(turned=view.turned).falling(profile)
    seen = _entered(with_corners([view.seen(part) for part in profile]))
    cuts: list[Cut] = []
    for left in range(passes, 0, -1):
        path = moved_off(seen, (left - 1) * (first - last) / passes + last)
        cuts += [Cut(path[0].start, rapid=True), Cut(path[0].end, rapid=True)]
        cuts += [Cut(part.end, False, part.center, part.ccw) for part in path[1:]]
    return [_seen_back(view, cut) for cut in cuts]


def rough(profile: Sequence[Part], numbers: Roughing, *, along_x: bool) -> list[Cut]:
    """Return the cuts down to a profile whose first part leads to it, along Z or `along_x`.

    Raises:
        GeometryError: the profile goes back, or cannot be moved off so far.
    """
    view = View(turned=along_x).falling(profile)
    path = moved_off(_entered(with_corners([view.seen(part) for part in profile])), numbers.allowance)
    cutter = _Cutter([part.moved(numbers.displacement) for part in path], numbers)
    cutter.cut()
    return [_seen_back(view, cut) for cut in cutter.cuts]


def _entered(path: list[Part]) -> list[Part]:
    """Return a path whose first part never leads up along Z.

    Raises:
        GeometryError: another part does.
    """
    way = path[0].end - path[0].start
    if way.real > 0.0:
        path[0] = replace(path[0], start=complex(path[0].end.real, path[0].start.imag))
    _check(path)
    return path


def _check(path: Sequence[Part]) -> None:
    if not goes_on(path):
        raise GeometryError("the profile goes back along the cuts", "Write it so that it never does.")


def _seen_back(view: View, cut: Cut) -> Cut:
    center = None if cut.center is None else view.back(cut.center)
    over = view.x_over is not view.z_over
    return Cut(view.back(cut.end), cut.rapid, center, cut.ccw is not over)


class _Cutter:
    """Cut level by level from the right to the profile, down along its falling parts; go up along the rising ones.

    `at` is where the tool is. Each level ends with a retract up and back to where it began. `tops` are where pockets
    begin.
    """

    def __init__(self, path: list[Part], numbers: Roughing) -> None:
        top, last = path[0].start.imag, path[-1].end
        if last.imag < top:
            path = [*path, Part(last, complex(last.real, top))]
        self._path = path
        self._depth = max(numbers.depth, 2.0 * NEAR)
        self._what = numbers.what
        self._escape = numbers.retract
        self.at = path[0].start
        self._tops = [top]
        self.cuts = [Cut(self.at, rapid=True)]

    def cut(self) -> None:
        """Cut what the cycle says."""
        place, count = 0, len(self._path)
        if self._what == POCKETS:
            while place < count and not self._dive(place, _FAR_DOWN):
                place += 1
        while place < count:
            place = self._levels(place)
            if self._what == WITHOUT_POCKETS:
                for part in self._path[place:]:
                    self._climb_from_here(part)
                return
            while place < count and not self._climb(self._path[place]):
                place += 1
            if self._what == POCKETS and place < count:
                self._begin_pocket()

    def _begin_pocket(self) -> None:
        """Let the levels of a pocket begin where it does."""
        if len(self._tops) > 1 and self.at.imag > self._tops[-1]:
            self._tops.pop()
        if len(self._tops) == 1:
            self._tops.append(self.at.imag)

    def _levels(self, place: int) -> int:
        """Cut levels down along falling parts from `place` on; return the first part that falls no more."""
        x = self._tops[-1]
        for _ in range(MOST_PASSES):
            if place >= len(self._path):
                return place
            while x - NEAR > self.at.imag:
                x -= self._depth
            if self._dive(place, x):
                return place
            if abs(self.at.imag - x) > NEAR:
                place += 1
                continue
            found = self._level(place)
            if found is None:
                x -= self._depth
            else:
                place = found
        raise GeometryError(
            f"more than {MOST_PASSES} cuts", "Check I, and that the profile is closed to the top."
        )

    def _level(self, place: int) -> int | None:
        """Cut along Z from here; return the part that begins here instead, `place` where nothing ends the cut."""
        for number in range(place, len(self._path)):
            crossings = self._path[number].crossings(self.at.imag)
            if not crossings:
                continue
            z = crossings[-1] if number == place else crossings[0]
            way = abs(z - self.at.real)
            if z - NEAR > self.at.real or (way < NEAR and number == place):
                continue
            if way < NEAR:
                return number if abs(self.at - self._path[number].start) < NEAR else None
            share = min(1.0, way / 2.0 / self._escape) if self._escape else 0.0
            up = share * self._escape
            begin = self.at
            self._go(complex(z, begin.imag))
            self._go(self.at + complex(up, up), rapid=True)
            self._go(begin + complex(-up, up), rapid=True)
            self._go(begin, rapid=place == 0)
            return None
        return place

    def _go(self, end: complex, *, rapid: bool = False) -> None:
        self.cuts.append(Cut(end, rapid))
        self.at = end

    def _bend(self, part: Part, end: complex) -> None:
        if abs(self.at - end) > SHORT:
            self.cuts.append(Cut(end, False, part.center, part.ccw))
        self.at = end

    def _dive(self, place: int, x: float) -> bool:
        """Go down a part as far as height `x`; tell whether it does not fall from here."""
        part = self._path[place]
        if part.center is not None:
            return self._dive_along_arc(part, part.center, x)
        if part.start.imag <= part.end.imag + NEAR:
            return True
        end = part.end
        if x >= end.imag:
            crossings = part.crossings(x)
            if not crossings:
                raise GeometryError("the profile lies above where its cuts begin", "Check X and Z.")
            end = complex(crossings[0], x)
        self._go(end, rapid=place == 0)
        return False

    def _dive_along_arc(self, part: Part, center: complex, x: float) -> bool:
        if (self.at - part.end).real <= NEAR:
            self.at = part.end
            return False
        crossings = part.crossings(x) or part.crossings(x - NEAR)
        if part.ccw:
            if self.at.real - NEAR > center.real:
                return True
            through = not crossings or crossings[-1] > center.real
            end = part.end if through else complex(crossings[-1], x)
        else:
            if self.at.real <= center.real:
                return True
            if crossings and crossings[0] < center.real:
                return False  # only its far side is hit
            end = complex(crossings[0], x) if crossings else part.end
        self.cuts.append(Cut(end, False, center, part.ccw))
        self.at = end
        return False

    def _climb(self, part: Part) -> bool:
        """Go up a part that the tool is at the beginning of; tell whether it falls, or falls further on."""
        if part.center is None:
            if part.end.imag + NEAR < part.start.imag:
                return True
            if abs(self.at - part.start) > NEAR:
                raise GeometryError("the tool is not at its profile", "Check D, U and W.")
            self._go(part.end)
            return False
        if not part.ccw:
            if self.at.real > part.center.real:
                return True
            self._bend(part, part.end)
            return False
        if self.at.real < part.center.real:
            return True
        self._bend(part, _top(part, part.center))
        return True

    def _climb_from_here(self, part: Part) -> None:
        """Go along Z to a part that rises, and up it; nowhere if it does not rise here."""
        if part.center is None and part.end.imag < part.start.imag:
            return
        crossings = part.crossings(self.at.imag)
        if not crossings:
            return
        if part.center is None:
            self._go(complex(crossings[0], self.at.imag))
            self._go(part.end)
            return
        z = crossings[0] if part.ccw else crossings[-1]
        if (z < part.center.real) if part.ccw else (z > part.center.real):
            return
        self._go(complex(z, self.at.imag))
        self._bend(part, _top(part, part.center) if part.ccw else part.end)


def _top(part: Part, center: complex) -> complex:
    """Return the end of a counter-clockwise arc, or its highest point where it falls from there on."""
    return (
        complex(center.real, center.imag + abs(part.start - center))
        if part.end.real < center.real
        else part.end
    )
