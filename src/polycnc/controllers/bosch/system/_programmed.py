"""COF, DPC, SCL, NCF, MCA: what was programmed last, and machine parameters (Manual 003, 4.7 and 4.8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER, whole
from polycnc.nc.cpl import OMITTED, Fault, text_of

MM_PER_INCH = 25.4
BASIC_SETTING = -1
PHYSICAL, COORDINATE = 0, 1
_ANGLE, _POLE, _FACTOR = range(3)


@dataclass(slots=True)
class ProgrammedShifts:
    """Contour shift (G60), position compensation (G138), rotation and scaling (G37, G38) programmed last.

    `coordinates` are the names of a channel's coordinates in their order, `physical` the coordinates (from 1) of
    physical axes, `names` those of other names of axes. Lengths are mm by coordinate, of `rotary` ones deg.
    """

    coordinates: Sequence[str]
    physical: Mapping[int, int] = field(default_factory=dict)
    names: Mapping[str, int] = field(default_factory=dict)
    rotary: frozenset[int] = frozenset()
    inch: bool = False
    contour: dict[int, float] = field(default_factory=dict)
    position: dict[int, float] = field(default_factory=dict)
    position_angle_deg: float = 0.0
    plane_angle_deg: float = 0.0
    poles: dict[int, float] = field(default_factory=dict)
    factors: dict[int, float] = field(default_factory=dict)

    def cof(self, axis: object, kind: object = OMITTED) -> float:
        """Return the contour shift of a coordinate.

        Raises:
            Fault: The channel has no such coordinate.
        """
        return self._length(self.contour, self._coordinate(axis, kind))

    def dpc(self, axis: object, kind: object = OMITTED) -> float:
        """Return the position compensation's shift of a coordinate, for 0 its angle.

        Raises:
            Fault: The channel has no such coordinate.
        """
        if isinstance(axis, int | float) and axis == 0:
            return self.position_angle_deg
        return self._length(self.position, self._coordinate(axis, kind))

    def scl(self, selection: object, axis: object = OMITTED, kind: object = OMITTED) -> float:
        """Return the angle of rotation (0), or pole (1) or scaling factor (2) of a coordinate.

        Raises:
            Fault: The channel has no such coordinate, or one is given for the angle.
        """
        which = whole(selection, "selection", range(3))
        if which == _ANGLE:
            if axis is not OMITTED or kind is not OMITTED:
                raise Fault(INVALID_PARAMETER, "the angle of rotation has no axis")
            return self.plane_angle_deg
        coordinate = self._coordinate(axis, kind)
        return self._length(self.poles, coordinate) if which == _POLE else self.factors.get(coordinate, 1.0)

    def _length(self, values: Mapping[int, float], coordinate: int) -> float:
        inch = self.inch and coordinate not in self.rotary
        return values.get(coordinate, 0.0) / (MM_PER_INCH if inch else 1.0)

    def _coordinate(self, axis: object, kind: object) -> int:
        which = whole(kind, "selection type", range(2), COORDINATE)
        if axis is OMITTED:
            raise Fault(INVALID_PARAMETER, "an axis is needed")
        if not isinstance(axis, int | float):
            name = text_of(axis) or ""
            if name in self.coordinates:
                return self.coordinates.index(name) + 1
            if name in self.names:
                return self.names[name]
            raise Fault(INVALID_PARAMETER, f"the channel has no coordinate {name}")
        if which == PHYSICAL:
            return self.physical[whole(axis, "physical axis", self.physical.keys())]
        return whole(axis, "coordinate", range(1, len(self.coordinates) + 1))


@dataclass(slots=True)
class LastFunctions:
    """NCF: the words programmed last, in modal groups; `groups` are the words of each, `last` one of each or ""."""

    groups: Sequence[frozenset[str]]
    last: dict[int, str] = field(default_factory=dict)

    def program(self, word: str) -> None:
        """Note that a word was programmed."""
        self.last[self._group(word)] = word

    def ncf(self, word: object) -> str:
        """Return the word of the group of `word` that was programmed last.

        Raises:
            Fault: There is no such word.
        """
        return self.last.get(self._group(text_of(word) or ""), "")

    def _group(self, word: str) -> int:
        for place, group in enumerate(self.groups):
            if word in group:
                return place
        raise Fault(INVALID_PARAMETER, f"there is no NC function {word}")


Parameter = int | float | str


@dataclass(slots=True)
class Macoda:
    """MCA: machine parameters by number, written like 100300004, channel (-1: basic setting) and index from 0.

    What a channel has not of its own, it has from the basic setting.
    """

    channel: int
    channels: int
    parameters: dict[tuple[int, int], Sequence[Parameter]] = field(default_factory=dict)

    def mca(self, number: object, index: object, channel: object = OMITTED) -> Parameter:
        """Return a parameter.

        Raises:
            Fault: There is none of this number, index or channel.
        """
        of = whole(channel, "channel", {BASIC_SETTING, *range(1, self.channels + 1)}, self.channel)
        known = {each for each, _ in self.parameters}
        block = whole(number, "parameter", known)
        values = self.parameters.get((block, of), self.parameters.get((block, BASIC_SETTING), ()))
        return values[whole(index, "index", range(len(values)))]
