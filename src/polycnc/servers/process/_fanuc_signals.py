"""The addresses of a Power Mate's PMC by name (`G12`), a byte each; X are the machine's own and set as it would."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.fanuc import PowerMate, pmc
from polycnc.errors import shown
from polycnc.servers.machines import NamedValue, Single, no_such

_ADDRESS = re.compile(rf"([{pmc.LETTERS}])(\d{{1,4}})")
_INPUTS = "X"
_MEANING = {
    "G": "to the control", "F": "from the control", "Y": "to the machine", "X": "from the machine", "A": "messages",
    "R": "relays", "T": "timers", "K": "keep relays", "C": "counters", "D": "data table",
}  # fmt: skip


class FanucSignals:
    """The bytes of the PMC."""

    def __init__(self, mate: PowerMate) -> None:
        self._mate = mate

    def all(self) -> Iterable[NamedValue]:
        """Return those that are not 0."""
        for part in pmc.PARTS:
            for offset, byte in enumerate(self._mate.pmc.read(part.letter, part.first, part.last)):
                if byte:
                    yield _named(part.letter, part.first + offset, byte)

    def get(self, name: str) -> NamedValue:
        """Return one."""
        letter, address = _place(name)
        return _named(letter, address, self._mate.pmc.read(letter, address, address)[0])

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Set one, 0 to 255; G signals act at once."""
        letter, address = _place(name)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= 255:
            raise ControlError(
                Refusal.DATA,
                f"{name} cannot be {shown(value, 40)}",
                hint="Give a whole number from 0 to 255.",
            )
        if letter == _INPUTS:
            self._mate.pmc.set_input(address, value)
        elif pmc.writable(letter, address, address):
            self._mate.pmc.write(letter, address, bytes([value]))
        else:
            raise ControlError(Refusal.PROTECTED, f"{name} can only be read", hint="The control writes it.")


def _place(name: str) -> tuple[str, int]:
    found = _ADDRESS.fullmatch(name)
    if found is None or not pmc.exists(found[1], int(found[2]), int(found[2])):
        raise no_such("address of the PMC", name)
    return found[1], int(found[2])


def _named(letter: str, address: int, byte: int) -> NamedValue:
    settable = letter == _INPUTS or pmc.writable(letter, address, address)
    what = f"{_MEANING[letter]}: {byte:08b}"
    return NamedValue(f"{letter}{address}", byte, what, 0, 255, writable=settable)
