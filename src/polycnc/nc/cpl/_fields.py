"""Fields of one or two dimensions (Manual 003, 2.4.3): indices from 0 to the dimension, one more than it says."""

from __future__ import annotations

from itertools import product

from polycnc.nc.cpl._faults import INVALID_FIELD_LIMIT, INVALID_VARIABLE, Fault
from polycnc.nc.cpl._strings import LONGEST, CharacterField
from polycnc.nc.cpl._variables import Kind

LARGEST = 65536


class Field(dict[object, object]):
    """The elements of a field by index, or pair of indices; of a field of strings, character fields by index."""

    __slots__ = ("kind", "sizes")

    def __init__(self, kind: Kind, sizes: tuple[int, ...]) -> None:
        self.kind = kind
        self.sizes = sizes
        if kind == "S":
            super().__init__((index, CharacterField(sizes[1])) for index in range(sizes[0] + 1))
        elif len(sizes) == 1:
            super().__init__(dict.fromkeys(range(sizes[0] + 1)))
        else:
            super().__init__(dict.fromkeys(product(range(sizes[0] + 1), range(sizes[1] + 1))))

    def __missing__(self, index: object) -> object:
        """Refuse an index that is outside.

        Raises:
            Fault: Always.
        """
        if index is None or (isinstance(index, tuple) and None in index):
            raise Fault(INVALID_VARIABLE, "the index has no value (NUL)")
        shown = ",".join(str(each) for each in (index if isinstance(index, tuple) else (index,)))
        raise Fault(
            INVALID_FIELD_LIMIT, f"the field has the size ({_shown(self.sizes)}), the index is ({shown})"
        )


def check_sizes(kind: Kind, sizes: tuple[int, ...]) -> None:
    """Check the sizes of a DIM.

    Raises:
        Fault: They are outside what a field may have.
    """
    longest = LONGEST if kind == "S" else LARGEST
    if not all(1 <= size <= longest for size in sizes) or (kind != "S" and _elements(sizes) > LARGEST):
        unit = "characters and elements" if kind == "S" else "elements in all"
        raise Fault(INVALID_FIELD_LIMIT, f"a field has 1 to {longest} {unit}")


def dimension_field(old: object, kind: Kind, sizes: tuple[int, ...]) -> Field:
    """Return a field of sizes; one that has them already is kept with its values.

    Raises:
        Fault: Other sizes are in force.
    """
    if not isinstance(old, Field):
        return Field(kind, sizes)
    if old.sizes != sizes:
        raise Fault(INVALID_FIELD_LIMIT, f"it was dimensioned with ({_shown(old.sizes)}) before")
    return old


def index_needed(name: str) -> Fault:
    """Return the fault of a value that is assigned to a field as a whole."""
    return Fault(INVALID_VARIABLE, f"{name} is a field: write the index of its element, {name}(1)=...")


def _elements(sizes: tuple[int, ...]) -> int:
    return sizes[0] * (sizes[1] if len(sizes) == 2 else 1)


def _shown(sizes: tuple[int, ...]) -> str:
    return ",".join(map(str, sizes))
