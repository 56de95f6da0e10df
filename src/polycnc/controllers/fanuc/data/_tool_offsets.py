"""The tool offset memory: one value per number, in increments, which programs use as tool length (G43 H)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from polycnc.controllers.fanuc.data._increment import Scale, scale

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate

MEMORY_TYPE = 0


class ToolOffsets:
    """Read and write tool offsets, in increments of the input unit; durable with each change."""

    def __init__(self, power_mate: PowerMate, count: int) -> None:
        self.count = count
        self._power_mate = power_mate

    @property
    def limit(self) -> int:
        """The largest value, of either sign."""
        return self._power_mate.increment.offset_limit

    @property
    def _scale(self) -> Scale:
        return scale(self._power_mate.increment, linear=True, inch=self._power_mate.inch_input)

    @property
    def decimals(self) -> int:
        """How many decimals the values have."""
        return self._scale.decimals

    def get(self, number: int) -> int:
        """Return an offset; KeyError if there is none of this number."""
        if not 1 <= number <= self.count:
            raise KeyError(number)
        tool = self._power_mate.control.tools.get(number)
        return 0 if tool is None else self._scale.counts(tool.length_mm)

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
        tools, units = self._power_mate.control.tools, self._scale
        with self._power_mate.store.transaction():
            for number, value in values.items():
                tools.set(number, length_mm=units.value(value))
