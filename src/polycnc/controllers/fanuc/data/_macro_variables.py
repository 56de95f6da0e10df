"""The common variables of custom macros, and the two number forms in which programs on a PC see them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from polycnc.machine import Store

LOCALS = 33
_AREA = "fanuc.macro_variables"
MOST_MANTISSA = 99_999_999
MOST_DECIMALS = 8
VACANT = 0, -1
UNFIT = -1, -1


class CommonRange(IntEnum):
    """Which common variables there are (Manual 000, cnc_rdmacroinfo)."""

    SMALL = 0
    LARGE = 1
    MIDDLE = 2

    @property
    def blocks(self) -> tuple[range, range]:
        """Return the numbers of the volatile and of the permanent ones."""
        return {
            0: (range(100, 150), range(500, 532)),
            1: (range(100, 200), range(500, 1000)),
            2: (range(100, 200), range(500, 700)),
        }[self.value]


@dataclass(frozen=True, slots=True)
class Value:
    """A value and, if a program on a PC wrote it, the pair that it wrote."""

    number: float
    pair: tuple[int, int] | None = None


class MacroVariables:
    """Keep the common variables, durably with each change; None is vacant."""

    def __init__(self, store: Store, common: CommonRange) -> None:
        self.common = common
        self._store = store
        self._area = store.area(_AREA, dict)
        self._values: dict[int, Value] = {}
        for key, row in self._area.load().items():
            pair = row.get("pair")
            self._values[int(key)] = Value(
                float.fromhex(row["number"]), None if pair is None else tuple(pair)
            )

    def __contains__(self, number: object) -> bool:
        return any(number in block for block in self.common.blocks)

    def block(self, number: int) -> range | None:
        """Return the numbers that belong together with `number`: locals, volatile or permanent ones."""
        blocks = (range(1, LOCALS + 1), *self.common.blocks)
        return next((block for block in blocks if number in block), None)

    def get(self, number: int) -> float | None:
        """Return a common variable; KeyError if there is none of this number."""
        if number not in self:
            raise KeyError(number)
        kept = self._values.get(number)
        return None if kept is None else kept.number

    def pair(self, number: int) -> tuple[int, int] | None:
        """Return the decimal pair that a variable was written with, if it has not changed since."""
        kept = self._values.get(number)
        return None if kept is None else kept.pair

    def set(self, number: int, value: float | None, pair: tuple[int, int] | None = None) -> None:
        """Set a common variable, or make it vacant; KeyError if there is none of this number."""
        self.set_all({number: None if value is None else Value(value, pair)})

    def set_all(self, values: dict[int, Value | None]) -> None:
        """Set several, all or none; KeyError if there is none of a number."""
        for number in values:
            if number not in self:
                raise KeyError(number)
        with self._store.transaction():
            for number, value in values.items():
                if value is not None:
                    row: dict[str, Any] = {"number": value.number.hex()}
                    if value.pair is not None:
                        row["pair"] = list(value.pair)
                    self._area[number] = row
                elif number in self._values:
                    del self._area[number]
        for number, value in values.items():
            if value is None:
                self._values.pop(number, None)
            else:
                self._values[number] = value

    def clear_volatile(self) -> None:
        """Make the volatile ones vacant."""
        self.set_all(dict.fromkeys(self.common.blocks[0]))


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
    return Value(mantissa / 10.0**decimals, (mantissa, decimals))


def from_binary(mantissa: int, places: int) -> Value | None:
    """Return the value of a binary pair, None for the vacant one.

    Raises:
        ValueError: Not a pair of this form.
    """
    if (mantissa, places) == VACANT:
        return None
    if not -128 <= places <= 127:
        raise ValueError(f"{mantissa} with exponent {places}")
    return Value(math.ldexp(mantissa, -places))
