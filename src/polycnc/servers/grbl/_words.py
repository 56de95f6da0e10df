"""The check of a line's words as grbl does it, before anything else looks at them: the number of its answer."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from polycnc.nc import Group, ModalWords
from polycnc.servers.grbl._codes import GrblError, RefusedError

_WORD = re.compile(r"([A-Z])([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))?")
_GROUPS: Mapping[str, tuple[float, ...]] = {
    "motion": (0, 1, 2, 3, 38.2, 38.3, 80),
    "non-modal": (4, 10, 28, 30, 53, 92, 92.1),
    "plane": (17, 18, 19),
    "units": (20, 21),
    "distance": (90, 91),
    "arc distance": (91.1,),
    "feed mode": (93, 94),
    "radius": (40,),
    "length": (49,),
    "system": (54, 55, 56, 57, 58, 59),
    "path": (61,),
}
_GROUP_OF = {code: group for group, codes in _GROUPS.items() for code in codes}
_M_GROUPS = {0: "stop", 1: "stop", 2: "stop", 30: "stop", 3: "spindle", 4: "spindle", 5: "spindle"}
_M_GROUPS |= {7: "mist", 8: "flood", 9: "coolant off"}
_LETTERS = frozenset("FIJKLNPRSTXYZ")
_NOT_NEGATIVE = frozenset("FNPST")
AXES = "XYZ"
_OFFSETS = {17: "IJ", 18: "IK", 19: "JK"}
_PLANES = {17: "XY", 18: "XZ", 19: "YZ"}
_TAKES_AXES = (10.0, 28.0, 30.0, 92.0)
_ARCS = (2.0, 3.0)
_PROBES = (38.2, 38.3)
_MOST_LINE_NUMBER = 9_999_999


@dataclass(slots=True)
class Words:
    """The words of a line: G codes by their group, M codes, and the values of the other letters."""

    g: dict[str, float] = field(default_factory=dict)
    m: dict[str, int] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)

    @property
    def axes(self) -> str:
        """The axes that it names."""
        return "".join(axis for axis in AXES if axis in self.values)

    @property
    def needs_rest(self) -> bool:
        """Whether grbl answers only when everything before it, and the line itself, has been executed."""
        return bool(self.m) or self.g.get("non-modal") in (4.0, 10.0) or self.g.get("motion") in _PROBES


def read_words(text: str) -> Words:
    """Return the words of a line.

    Raises:
        RefusedError: One is none, is unknown, or is there twice.
    """
    words = Words()
    place = 0
    while place < len(text):
        found = _WORD.match(text, place)
        if found is None:
            raise RefusedError(GrblError.LETTER)
        if found[2] is None:
            raise RefusedError(GrblError.NUMBER)
        place = found.end()
        _take(words, found[1], float(found[2]))
    return words


def _take(words: Words, letter: str, value: float) -> None:
    if not math.isfinite(value):
        raise RefusedError(GrblError.NUMBER)
    if letter == "G":
        group = _GROUP_OF.get(value)
        if group is None:
            raise RefusedError(GrblError.UNSUPPORTED)
        if group in words.g:
            raise RefusedError(GrblError.GROUP)
        words.g[group] = value
    elif letter == "M":
        if value != int(value):
            raise RefusedError(GrblError.INTEGER)
        group = _M_GROUPS.get(int(value))
        if group is None:
            raise RefusedError(GrblError.UNSUPPORTED)
        if group in words.m:
            raise RefusedError(GrblError.GROUP)
        words.m[group] = int(value)
    else:
        if letter not in _LETTERS:
            raise RefusedError(GrblError.UNSUPPORTED)
        if letter in words.values:
            raise RefusedError(GrblError.REPEATED)
        if value < 0.0 and letter in _NOT_NEGATIVE:
            raise RefusedError(GrblError.NEGATIVE)
        if letter == "N" and value > _MOST_LINE_NUMBER:
            raise RefusedError(GrblError.LINE_NUMBER)
        words.values[letter] = value


def check_words(words: Words, modal: ModalWords) -> None:
    """Hold the words of a line against each other and against what is in force.

    Raises:
        RefusedError: They do not go together, or something is missing.
    """
    left = set(words.values) - set("FNST")
    motion = words.g.get("motion", _number(modal.g.get(Group.MOTION, "G80")))
    non_modal = words.g.get("non-modal", math.nan)
    takes_axes = non_modal in _TAKES_AXES
    if takes_axes and "motion" in words.g and words.g["motion"] != 80.0:
        raise RefusedError(GrblError.TWO_AXIS_COMMANDS)
    if non_modal == 53.0 and motion not in (0.0, 1.0):
        raise RefusedError(GrblError.MACHINE_MOTION)
    if non_modal == 4.0:
        _need("P" in left, GrblError.MISSING)
        left.discard("P")
    if non_modal == 10.0:
        left -= _set_offset(words)
    if non_modal == 92.0:
        _need(bool(words.axes), GrblError.NO_AXES)
    if takes_axes:
        left -= set(words.axes)
    elif words.axes or words.g.get("motion") in (*_ARCS, *_PROBES):
        left -= _move(words, modal, motion)
    if left:
        raise RefusedError(GrblError.UNUSED)


def _set_offset(words: Words) -> set[str]:
    values = words.values
    _need(bool(words.axes), GrblError.NO_AXES)
    _need("P" in values and "L" in values, GrblError.MISSING)
    _need(values["L"] in (2.0, 20.0), GrblError.UNSUPPORTED)
    _need(values["P"] <= 6.0, GrblError.NO_SYSTEM)
    return set("PL")


def _move(words: Words, modal: ModalWords, motion: float) -> set[str]:
    """Check a motion; return the letters that it uses."""
    values = words.values
    used = set(words.axes)
    _need(motion != 80.0, GrblError.NO_MOTION)
    by_time = words.g.get("feed mode", _number(modal.g.get(Group.FEED_MODE, "G94"))) == 93.0
    if motion != 0.0:
        was_by_time = modal.g.get(Group.FEED_MODE) == "G93"
        feed = values.get("F", 0.0 if by_time or was_by_time else modal.feed)
        _need(feed > 0.0, GrblError.NO_FEED)
    if motion in _PROBES:
        _need(bool(words.axes), GrblError.NO_AXES)
    if motion in _ARCS:
        plane = int(words.g.get("plane", _number(modal.g.get(Group.PLANE, "G17"))))
        _need(bool(words.axes), GrblError.NO_AXES)
        _need(any(axis in values for axis in _PLANES[plane]), GrblError.ARC_AXES)
        if "R" in values:
            return used | {"R"}
        _need(any(offset in values for offset in _OFFSETS[plane]), GrblError.ARC_OFFSETS)
        used |= set(_OFFSETS[plane])
    return used


def _need(holds: bool, error: GrblError) -> None:
    if not holds:
        raise RefusedError(error)


def _number(code: str) -> float:
    return float(code.removeprefix("G"))
