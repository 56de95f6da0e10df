"""TDA: the fields of the internal tool database (Manual 003, 4.6)."""

from __future__ import annotations

from polycnc.controllers.bosch.system._arguments import whole
from polycnc.nc.cpl import OMITTED, Fault, text_of

NO_ACCESS = (1, 2)
TEXTS = (8, 49)
LONGEST_TEXT = 31
FIELDS = range(1, 50)


class ToolDatabase:
    """Data sets by sector and place; their numbers are raw, what they mean is the configuration's.

    Args:
        places: How many places each sector has, by the number of the sector.
    """

    def __init__(self, places: dict[int, int]) -> None:
        self.places = dict(places)
        self.data: dict[tuple[int, int], dict[int, int | str]] = {}

    def read(self, sector: object, place: object, field: object, table: object = OMITTED) -> int | str:
        """Return a field: a text of 8 and 49, else a number.

        Raises:
            Fault: There is none, or it cannot be accessed.
        """
        data_set, number = self._place(sector, place, field, table)
        return self.data.get(data_set, {}).get(number, "" if number in TEXTS else 0)

    def write(
        self, value: object, sector: object, place: object, field: object, table: object = OMITTED
    ) -> None:
        """Set a field.

        Raises:
            Fault: There is none, it cannot be accessed, or the value has another type or is too long.
        """
        data_set, number = self._place(sector, place, field, table)
        kept: int | str
        if number in TEXTS:
            text = None if isinstance(value, int | float) else text_of(value)
            if text is None or len(text) > LONGEST_TEXT:
                raise Fault(
                    "inconsistent data", f"field {number} takes a text of up to {LONGEST_TEXT} characters"
                )
            kept = text
        elif isinstance(value, int) and not isinstance(value, bool):
            kept = value
        else:
            raise Fault("inconsistent data", f"field {number} takes an INTEGER")
        self.data.setdefault(data_set, {})[number] = kept

    def _place(
        self, sector: object, place: object, field: object, table: object
    ) -> tuple[tuple[int, int], int]:
        if not self.places:
            raise Fault("no tool database is configured")
        whole(table, "tool table", range(1, 2), 1)
        where = whole(sector, "sector", self.places.keys())
        data_set = where, whole(place, "place", range(1, self.places[where] + 1))
        number = whole(field, "field", FIELDS)
        if number in NO_ACCESS:
            raise Fault(
                "INVALID PARAMETER", "fields 1 and 2 are the sector and place themselves; there is no access"
            )
        return data_set, number
