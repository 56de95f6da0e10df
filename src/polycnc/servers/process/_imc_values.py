"""The parameter memory of an iMC card by name: one value, or one for each axis by its number."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.imc import PARAMETERS, Card
from polycnc.errors import PolycncError, shown
from polycnc.servers.machines import NamedValue, Single, no_such


class ImcParameters:
    """The parameters of the card, in the units that its memory has: pulses, pulses/ms, plain numbers."""

    def __init__(self, card: Card) -> None:
        self._card = card

    def all(self) -> Iterable[NamedValue]:
        """Return all that can be read."""
        return [self.get(name) for name, row in PARAMETERS.items() if row.access != "w"]

    def get(self, name: str) -> NamedValue:
        """Return one."""
        row = PARAMETERS.get(name)
        if row is None:
            raise no_such("parameter", name)
        value: float | dict[str, Single]
        if row.scope == "A":
            value = {str(axis): self._card.read(name, axis) for axis in range(self._card.axes)}
        else:
            value = self._card.read(name)
        return NamedValue(name, value, row.meaning, row.least, row.most, writable=row.access != "ro")

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Write one, or those of the axes that are named, with all that a write sets off."""
        row = PARAMETERS.get(name)
        if row is None:
            raise no_such("parameter", name)
        if row.access == "ro":
            raise ControlError(Refusal.PROTECTED, f"{name} can only be read", hint="The card writes it.")
        if (row.scope == "A") is not isinstance(value, Mapping):
            takes = 'a value for each axis, like {"0": 1}' if row.scope == "A" else "one value"
            raise ControlError(Refusal.DATA, f"{name} takes {takes}", hint="See its row.")
        given: Mapping[str, Single] = value if isinstance(value, Mapping) else {"0": value}
        asked: dict[int, float] = {}
        for axis, each in given.items():
            if axis not in map(str, range(self._card.axes)):
                raise ControlError(
                    Refusal.DATA,
                    f"there is no axis '{axis[:16]}'",
                    hint=f"Axes are 0 to {self._card.axes - 1}.",
                )
            if (
                isinstance(each, bool)
                or not isinstance(each, int | float)
                or not row.least <= each <= row.most
            ):
                raise ControlError(
                    Refusal.DATA, f"{name} cannot be {shown(each, 40)}",
                    hint=f"Give a number from {row.least:g} to {row.most:g}.",
                )  # fmt: skip
            asked[int(axis)] = each
        try:
            for number, one in asked.items():
                self._card.write(name, one, number)
        except PolycncError as error:
            raise ControlError(Refusal.DATA, error.what, hint=error.hint) from None
