"""Inputs and outputs of a machine by name: inputs are set as the machine would, outputs are the control's."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from polycnc.cnc import Control, ControlError, Refusal
from polycnc.errors import UsageError, shown
from polycnc.servers.machines import NamedValue, Single, no_such

_WORD = (-(2**31), 2**31 - 1)


class IoValues:
    """The points of a control's I/O image: by their names in the machine file, else by address (`I3`, `OW1`)."""

    def __init__(self, find: Callable[[], Control]) -> None:
        self._find = find

    def all(self) -> Iterable[NamedValue]:
        """Return all points, those with names first."""
        machine = self._find().machine
        io, points = machine.io, machine.config.io.points
        sizes = {
            "I": io.inputs.now.size, "O": io.outputs.now.size, "IW": io.input_words.size, "OW": io.output_words.size,
        }  # fmt: skip
        addresses = (f"{letters}{index}" for letters, size in sizes.items() for index in range(size))
        named = set(points.values())
        return list(map(self.get, [*points, *(each for each in addresses if each not in named)]))

    def get(self, name: str) -> NamedValue:
        """Return one."""
        machine = self._find().machine
        try:
            value = machine.io[name]
        except UsageError:
            raise no_such("input or output", name) from None
        address = machine.config.io.points.get(name, name)
        is_input, is_word = address.startswith("I"), "W" in address
        low, high = _WORD if is_word else (0, 1)
        kind = f"{'input' if is_input else 'output'}{' word' if is_word else ''}"
        what = kind if name == address else f"{kind} {address}"
        return NamedValue(name, value, what, low, high, writable=is_input)

    def set(self, name: str, value: Single | Mapping[str, Single]) -> None:
        """Set an input."""
        before = self.get(name)
        if not before.writable:
            raise ControlError(Refusal.PROTECTED, f"{name} can only be read", hint="The control sets it.")
        low, high = int(before.low or 0), int(before.high or 0)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise ControlError(
                Refusal.DATA, f"{name} cannot be {shown(value, 40)}",
                hint=f"Give a whole number from {low} to {high}.",
            )  # fmt: skip
        control = self._find()
        control.machine.io[name] = value
        control.clock.changes += 1
