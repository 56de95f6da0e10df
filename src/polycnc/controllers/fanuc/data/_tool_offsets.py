"""The tool offset memory: one value per number, in increments, which programs use as tool length (G43 H)."""

from __future__ import annotations

from polycnc.controllers.fanuc.device._power import Power
from polycnc.controllers.fanuc.device._units import Units
from polycnc.machine import Store

MEMORY_TYPE = 0


class ToolOffsets:
    """Read and write tool offsets, in increments of the input unit; durable with each change."""

    def __init__(self, store: Store, power: Power, units: Units, count: int) -> None:
        self.count = count
        self._store = store
        self._power = power
        self._units = units

    @property
    def limit(self) -> int:
        """The largest value, of either sign."""
        return self._units.increment.offset_limit

    @property
    def decimals(self) -> int:
        """How many decimals the values have."""
        return self._units.input().decimals

    def get(self, number: int) -> int:
        """Return an offset; KeyError if there is none of this number."""
        if not 1 <= number <= self.count:
            raise KeyError(number)
        tool = self._power.control.tools.get(number)
        return 0 if tool is None else self._units.input().counts(tool.length_mm)

    def set_all(self, values: dict[int, int]) -> None:
        """Set offsets, all or none.

        Raises:
            KeyError: There is none of a number.
            ValueError: A value is out of range.
        """
        for number, value in values.items():
            if not 1 <= number <= self.count:
                raise KeyError(number)
            if abs(value) > self.limit:
                raise ValueError(f"{value} is above {self.limit}")
        tools, units = self._power.control.tools, self._units.input()
        with self._store.transaction():
            for number, value in values.items():
                tools.set(number, length_mm=units.value(value))
