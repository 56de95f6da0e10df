"""A parameter of an axis by the manual's name: a number of its row, in the axis' units."""

from __future__ import annotations

import math
from typing import Any, Protocol, overload

from polycnc.controllers.apci.board._system_axis import LEAST


class HasRow(Protocol):
    """Who has parameters."""

    row: Any
    time_unit_s: float

    def change_units(self) -> None:
        """Take over what follows from parameters on which units depend."""


class Parameter:
    """A number of the axis' row; `per` says how often the axis' time unit divides it.

    On what is marked with `units` the units of interpolations depend. What must be `above_zero` keeps its value when
    it is given less than `LEAST`.
    """

    def __init__(self, name: str, per: int = 0, *, units: bool = False, above_zero: bool = False) -> None:
        self.name = name
        self.per = per
        self.units = units
        self.above_zero = above_zero

    @overload
    def __get__(self, axis: None, owner: type) -> Parameter: ...
    @overload
    def __get__(self, axis: HasRow, owner: type) -> float: ...
    def __get__(self, axis: HasRow | None, owner: type) -> Parameter | float:
        """Return the number in the axis' units."""
        if axis is None:
            return self
        return float(axis.row[self.name] * axis.time_unit_s**self.per)

    def __set__(self, axis: HasRow, value: float) -> None:
        """Store the number; one that is none is left out, so that it cannot get into a profile."""
        if math.isfinite(value) and (value >= LEAST or not self.above_zero):
            axis.row[self.name] = value / axis.time_unit_s**self.per
            if self.units:
                axis.change_units()
