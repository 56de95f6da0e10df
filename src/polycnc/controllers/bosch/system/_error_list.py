"""GETERR: the errors that are present on the channels (Manual 003, 4.13)."""

from __future__ import annotations

from datetime import datetime
from enum import Enum, IntEnum
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


class Tab(Enum):
    """The lists of the information window, and the categories that each shows."""

    ERRORS = frozenset(Category) - {Category.RUNTIME_WARNING, Category.MSD_WARNING, Category.MSD_MESSAGE}
    WARNINGS = frozenset((Category.RUNTIME_WARNING, Category.MSD_WARNING))
    MESSAGES = frozenset((Category.MSD_MESSAGE,))


class PresentError(NamedTuple):
    """An error: its number, its channel (-1: all), its category, what it says, and when it came."""

    number: int
    channel: int
    category: Category
    text: str = ""
    at: datetime | None = None

    @property
    def record(self) -> tuple[int, int, int]:
        """Return what GETERR tells of it: number, channel, category."""
        return self.number, self.channel, int(self.category)

    @property
    def columns(self) -> tuple[str, ...]:
        """Return what the information window shows of it: number, channel, date, time, ms, description."""
        date, time, ms = ("", "", "")
        if self.at is not None:
            date, time = f"{self.at:%d.%m.%y}", f"{self.at:%H:%M:%S}"
            ms = f"({self.at.microsecond // 1000:03})"
        return str(self.number), str(self.channel), date, time, ms, self.text


class ErrorList:
    """The errors that are present, in the order in which they came."""

    def __init__(self, channels: int) -> None:
        self.channels = channels
        self.errors: list[PresentError] = []

    def add(
        self,
        number: int,
        channel: int,
        category: Category = Category.UNKNOWN,
        text: str = "",
        at: datetime | None = None,
    ) -> None:
        """Note an error."""
        self.errors.append(PresentError(number, channel, category, text, at))

    def shown(self, tab: Tab) -> list[PresentError]:
        """Return what a list of the information window holds."""
        return [each for each in self.errors if each.category in tab.value]

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
            record = found[row - 1].record if shown else (0,) * _ELEMENTS
            for column, value in enumerate(record, 1):
                errors[row, column] = value
        return len(found)
