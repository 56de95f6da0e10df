"""Macro variables as programs on a PC see them: in two number forms, and as they were written."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum

from polycnc.machine import Store
from polycnc.nc.macro import LARGEST, LOCALS, MacroVariables

_AREA = "fanuc.macro_pairs"
_SHARED = ("common", "permanent")
MOST_MANTISSA = 99_999_999
MOST_DECIMALS = 8
VACANT = 0, -1
UNFIT = -1, -1


class CommonRange(IntEnum):
    """Which common variables there are (Manual 000, cnc_rdmacroinfo)."""

    SMALL = 0
    LARGE = 1
    MIDDLE = 2

    @classmethod
    def of(cls, has_option: Callable[[str], bool]) -> CommonRange:
        """Return those of a control with these options."""
        if has_option("macro_variables_600"):
            return cls.LARGE
        return cls.MIDDLE if has_option("macro_variables_300") else cls.SMALL


_MACRO_TYPES = {CommonRange.SMALL: "a", CommonRange.LARGE: "b", CommonRange.MIDDLE: "c"}


@dataclass(frozen=True, slots=True)
class Value:
    """A value and, if a program on a PC wrote it, the pair that it wrote."""

    number: float
    pair: tuple[int, int] | None = None


class SharedMacros:
    """Read and write the variables of a control's programs (`variables`) from outside.

    A pair that was written stays that variable's as long as its value does; pairs are as durable as values.
    """

    def __init__(self, store: Store, common: CommonRange) -> None:
        self.common = common
        self.variables = MacroVariables(_MACRO_TYPES[common], store=store)  # type: ignore[arg-type]
        self._store = store
        self._area = store.area(_AREA, str)
        self._pairs = {int(key): _pair(text) for key, text in self._area.load().items()}

    def __contains__(self, number: object) -> bool:
        return isinstance(number, int) and self.variables.kind(number) in _SHARED

    def block(self, number: int) -> range | None:
        """Return the numbers that belong together with `number`: locals, volatile or permanent ones."""
        blocks = ((1, LOCALS), *self.variables.ranges)
        return next((range(first, last + 1) for first, last in blocks if first <= number <= last), None)

    def get(self, number: int) -> float | None:
        """Return a common variable; KeyError if there is none of this number."""
        if self.variables.kind(number) not in _SHARED:
            raise KeyError(number)
        return self.variables.common[number]

    def pair(self, number: int) -> tuple[int, int] | None:
        """Return the decimal pair that a variable was written with, if it has not changed since."""
        pair = self._pairs.get(number)
        return None if pair is None or _number(pair) != self.variables.get(number) else pair

    def set(self, number: int, value: float | None, pair: tuple[int, int] | None = None) -> None:
        """Set a common variable, or make it vacant; KeyError if there is none of this number."""
        self.set_all({number: None if value is None else Value(value, pair)})

    def set_all(self, values: Mapping[int, Value | None]) -> None:
        """Set several, all or none; KeyError if there is none of a number."""
        for number in values:
            if number not in self:
                raise KeyError(number)
        pairs = {number: value.pair for number, value in values.items() if value is not None and value.pair}
        with self._store.transaction():
            for number, pair in pairs.items():
                if self._pairs.get(number) != pair:
                    self._area[number] = f"{pair[0]} {pair[1]}"
            self.variables.set_all(
                {number: None if value is None else value.number for number, value in values.items()}
            )
        self._pairs.update(pairs)


def _pair(text: str) -> tuple[int, int]:
    mantissa, decimals = text.split()
    return int(mantissa), int(decimals)


def _number(pair: tuple[int, int]) -> float:
    return pair[0] / 10.0 ** pair[1]


def decimal_pair(value: float | None) -> tuple[int, int]:
    """Return mantissa M and decimals E of M * 10^-E: as few digits as the value needs, at most 8.

    Ruling: digits beyond the eighth, and decimals beyond the eighth, are rounded; what has none left does not fit.
    """
    if value is None:
        return VACANT
    if value == 0.0:
        return 0, 0
    if not abs(value) < MOST_MANTISSA + 0.5:
        return UNFIT
    whole = len(str(int(abs(value)))) if abs(value) >= 1.0 else 0
    decimals = min(MOST_DECIMALS, 8 - whole)
    mantissa = round(value * 10.0**decimals)
    if abs(mantissa) > MOST_MANTISSA:  # rounding has brought a ninth digit
        decimals -= 1
        mantissa = round(value * 10.0**decimals)
    if mantissa == 0:
        return UNFIT
    while decimals and mantissa % 10 == 0:
        mantissa //= 10
        decimals -= 1
    return mantissa, decimals


def binary_pair(value: float | None) -> tuple[int, int]:
    """Return mantissa M and exponent E of M * 2^-E, M without trailing zero bits where E allows it."""
    if value is None:
        return VACANT
    fraction, exponent = math.frexp(value)
    mantissa, places = round(fraction * 2**31), 31 - exponent
    if mantissa == 1 << 31:
        mantissa, places = mantissa >> 1, places - 1
    if places > 127:
        mantissa, places = round(mantissa / 2.0 ** (places - 127)), 127
    while mantissa and mantissa % 2 == 0 and places > -128:
        mantissa, places = mantissa // 2, places - 1
    return (mantissa, places) if mantissa else (0, 0)


def from_decimal(mantissa: int, decimals: int) -> Value | None:
    """Return the value of a decimal pair, None for the vacant one.

    Raises:
        ValueError: Not a pair of this form.
    """
    if (mantissa, decimals) == VACANT:
        return None
    if not (abs(mantissa) <= MOST_MANTISSA and 0 <= decimals <= MOST_DECIMALS):
        raise ValueError(f"{mantissa} with {decimals} decimals")
    return Value(_number((mantissa, decimals)), (mantissa, decimals))


def from_binary(mantissa: int, places: int) -> Value | None:
    """Return the value of a binary pair, None for the vacant one.

    Raises:
        ValueError: Not a pair of this form.
    """
    if (mantissa, places) == VACANT:
        return None
    value = math.ldexp(mantissa, -places) if -128 <= places <= 127 else LARGEST
    if not abs(value) < LARGEST:
        raise ValueError(f"{mantissa} with exponent {places}")
    return Value(value)
