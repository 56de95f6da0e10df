"""Versions of data: what tells a caller that data are still those that it has (Manual 003, MCODS)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from polycnc.controllers.bosch.ncs._codes import NcsError
from polycnc.controllers.bosch.ncs._data_services import DATA_SERVICES, Asked, Values
from polycnc.controllers.bosch.ncs._image import Image

Key: TypeAlias = tuple[int, int, tuple[int | None, ...]]
_CHANGING = ("E", "S")
LARGEST = 2**24 - 1
"""Versions fit into a REAL variable without rounding."""


@dataclass(slots=True)
class Ledger:
    """The version of each of the data that were ever asked for; no two data share one."""

    last: int = 0
    entries: dict[Key, tuple[object, int]] = field(default_factory=dict)
    unchanged: set[Key] = field(default_factory=set)
    """Those that can change and change back, and have not changed since they were asked for."""

    def read(self, image: Image, key: Key) -> tuple[Values, int]:
        """Return data and their version.

        Raises:
            NcsError: There are none.
        """
        values, stamp = _read(image, key)
        entry = self.entries.get(key)
        changes = DATA_SERVICES[key[0]].refresh in _CHANGING
        if entry is None or entry[0] != stamp or (changes and key not in self.unchanged):
            self.last = self.last % LARGEST + 1
            entry = self.entries[key] = (stamp, self.last)
        if changes:
            self.unchanged.add(key)
        return values, entry[1]

    @property
    def is_used(self) -> bool:
        """Whether a change of data that were asked for, and may change back, is yet to be noted."""
        return bool(self.unchanged)

    def look(self, image: Image) -> None:
        """Note what changed of the data asked for before, in every cycle: they may change back."""
        for key in list(self.unchanged):
            try:
                changed = _read(image, key)[1] != self.entries[key][0]
            except NcsError:
                changed = True
            if changed:
                self.unchanged.discard(key)


def _read(image: Image, key: Key) -> tuple[Values, object]:
    number, channel, extra = key
    values = DATA_SERVICES[number].read(Asked(image, channel, extra))
    return values, _stamp(image, number, channel, values)


def _stamp(image: Image, number: int, channel: int, values: Values) -> object:
    refresh = DATA_SERVICES[number].refresh
    if refresh == "Z":
        return image.cycle
    if refresh == "S":
        if channel in image.channels:
            return image.channels[channel].blocks
        return tuple(each.blocks for each in image.channels.values())
    if refresh == "R":
        return None
    return values if isinstance(values, str) else tuple(values)
