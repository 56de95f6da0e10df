"""GETERR: the errors that are present on the channels (Manual 003, 4.13)."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER
from polycnc.nc.cpl import OMITTED, Fault, Field

ALL_CHANNELS = -1
_ELEMENTS = 3


class Category(IntEnum):
    """Categories of errors and warnings; UNKNOWN asks for all of them."""

    UNKNOWN = 0
    MINOR_SYSTEM = 1
    CONTROL_OR_DRIVE = 2
    INTERPOLATOR = 3
    HARDWARE = 4
    PLC = 5
    PART_PROGRAM = 6
    RUNTIME_WARNING = 7
    MSD_ERROR = 8
    MSD_WARNING = 9
    MSD_MESSAGE = 10


class PresentError(NamedTuple):
    """An error: its number, its channel (-1: all), its category."""

    number: int
    channel: int
    category: Category


class ErrorList:
    """The errors that are present, in the order in which they came."""

    def __init__(self, channels: int) -> None:
        self.channels = channels
        self.errors: list[PresentError] = []

    def add(self, number: int, channel: int, category: Category = Category.UNKNOWN) -> None:
        """Note an error."""
        self.errors.append(PresentError(number, channel, category))

    def clear(self, channel: int = ALL_CHANNELS) -> None:
        """Forget the errors of a channel, or all."""
        self.errors = [each for each in self.errors if channel not in (ALL_CHANNELS, each.channel)]

    def read(self, channel: object, category: object, errors: object, number: object = OMITTED) -> int:
        """Write up to `number` errors (default 1) into a field, the rest of it 0; return how many are present.

        Raises:
            Fault: The field has not two dimensions, the second of 3 elements, of INTEGER.
        """
        if (
            not isinstance(errors, Field)
            or errors.kind != "I"
            or len(errors.sizes) != 2
            or errors.sizes[1] < _ELEMENTS
        ):
            raise Fault(INVALID_PARAMETER, "GETERR needs an INTEGER field: DIM E%(x,3)")
        kind = 0 if category is OMITTED else category
        wanted = 1 if number is OMITTED else number
        valid = (channel == ALL_CHANNELS or channel in range(1, self.channels + 1)) and kind in range(11)
        if not valid or not isinstance(wanted, int | float) or wanted < 1:
            return -1
        found = [
            each
            for each in self.errors
            if (channel == ALL_CHANNELS or each.channel in (channel, ALL_CHANNELS))
            and kind in (0, each.category)
        ]
        for row in range(1, errors.sizes[0] + 1):
            shown = row <= min(len(found), int(wanted))
            for column in range(_ELEMENTS):
                errors[row, column + 1] = int(found[row - 1][column]) if shown else 0
        return len(found)
