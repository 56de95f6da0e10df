"""The memory of the PMC by its address letters; G and F are the signals of the control itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from polycnc.controllers.fanuc.device._history import Note
from polycnc.controllers.fanuc.device._signals import Signals
from polycnc.machine import Store

LETTERS = "GFYXARTKCD"
"""Address letters in the order of their codes (Manual 000, pmc_rdpmcrng)."""


@dataclass(frozen=True, slots=True)
class Part:
    """Addresses without a gap, all writable or none."""

    letter: str
    first: int
    last: int
    writable: bool = True


# fmt: off
PARTS = (
    Part("G", 0, 255), Part("G", 1000, 1255),
    Part("F", 0, 255, False), Part("F", 1000, 1255, False),
    Part("Y", 0, 127), Part("Y", 1000, 1063),
    Part("X", 0, 127, False), Part("X", 1000, 1063, False),
    Part("A", 0, 24),
    Part("R", 0, 999), Part("R", 9000, 9117, False),
    Part("T", 0, 79),
    Part("K", 0, 16), Part("K", 17, 19, False),
    Part("C", 0, 79),
    Part("D", 0, 1859),
)
# fmt: on
_DURABLE = "TKCD"
_SKIP_ADDRESS, _SKIP_BIT = 4, 0x80


def parts_of(letter: str) -> tuple[Part, ...]:
    """Return the parts of a letter."""
    return tuple(part for part in PARTS if part.letter == letter)


def exists(letter: str, first: int, last: int) -> bool:
    """Whether all addresses from `first` to `last` are there, without a gap."""
    parts = parts_of(letter)
    return first <= last and all(
        any(part.first <= address <= part.last for part in parts) for address in range(first, last + 1)
    )


def writable(letter: str, first: int, last: int) -> bool:
    """Whether none of these addresses is protected."""
    return all(part.writable for part in parts_of(letter) if first <= part.last and part.first <= last)


class PmcMemory:
    """Read and write the memory; timers, keep relays, counters and the data table outlast switching off."""

    def __init__(
        self,
        store: Store,
        signals: Signals,
        volatile: dict[tuple[str, int], int],
        note: Note,
        skip: Callable[[bool], None],
    ) -> None:
        self._signals = signals
        self._volatile = volatile
        self._note = note
        self._skip = skip
        self._areas = {letter: store.area(f"fanuc.pmc_{letter.lower()}", int) for letter in _DURABLE}
        self._kept = {letter: area.load() for letter, area in self._areas.items()}

    def read(self, letter: str, first: int, last: int) -> bytes:
        """Return the bytes of addresses that exist."""
        return bytes(self._byte(letter, address) for address in range(first, last + 1))

    def write(self, letter: str, first: int, data: bytes) -> None:
        """Write bytes to addresses that exist and are not protected; G signals act at once, in ascending order."""
        if letter in _DURABLE:
            values: dict[int | str, int] = dict(enumerate(data, first))
            self._areas[letter].save(values)
            self._kept[letter].update(values)
            return
        for address, value in enumerate(data, first):
            if letter == "G":
                self._signals.give(address, value)
            else:
                self._put(letter, address, value)

    def set_input(self, address: int, value: int) -> None:
        """Let the machine give a byte of X signals."""
        self._put("X", address, value)
        if address == _SKIP_ADDRESS:
            self._skip(bool(value & _SKIP_BIT))

    def clear(self) -> None:
        """Forget what does not outlast switching off."""
        self._volatile.clear()

    def _put(self, letter: str, address: int, value: int) -> None:
        old = self._volatile.get((letter, address), 0)
        self._volatile[letter, address] = value
        if letter in "XY" and old != value:
            self._note(letter, address, old, value)

    def _byte(self, letter: str, address: int) -> int:
        if letter in "GF":
            return self._signals.byte(letter, address)
        if letter in _DURABLE:
            return self._kept[letter].get(address, 0)
        return self._volatile.get((letter, address), 0)
