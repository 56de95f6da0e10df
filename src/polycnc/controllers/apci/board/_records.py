"""The records that programs exchange with the board, tables 2 to 11: the manual's names, in the manual's order.

`structures.h` has the tables; elements are aligned to at most 4 bytes. A new record is zero throughout.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from polycnc.controllers.apci.board import _declared
from polycnc.controllers.apci.board._declared import (
    CBCNCT,
    CDBUF,
    CIBUF,
    CMP,
    CNCTS,
    COMMON_VARIABLES,
    CTRLPARAMS,
    HEADER,
    HMP3D,
    LATCH_INFOS,
    MAXAXIS,
    ROSI,
    TRU,
    TSRP,
)
from polycnc.controllers.library import Structure
from polycnc.errors import UsageError

TASK_STRING_BYTES = 512
TARGET_POINT_PHI = 1e-100  # an angle not larger than this: the circle ends at a target point


def axis_number(number: int, axes: int = MAXAXIS) -> int:
    """Return `number`, which counts from 0.

    Raises:
        UsageError: There is no such axis among `axes` axes.
    """
    if not 0 <= number < axes:
        raise UsageError(f"there is no axis {number}", hint=f"axes have the numbers 0 to {axes - 1}")
    return number


class AS(_declared.AS):
    """Axis selection, table 2: `unoa` axes, whose numbers from 0 stand at the front of `san`."""

    __slots__ = ()

    @classmethod
    def of(cls, *axes: int) -> AS:
        """Return the selection of `axes`, in this order.

        Raises:
            UsageError: More than `MAXAXIS` axes, or a number that is no axis.
        """
        if len(axes) > MAXAXIS:
            raise UsageError(f"{len(axes)} axes are selected", hint=f"there are at most {MAXAXIS}")
        return cls(len(axes), [*map(axis_number, axes), *([0] * (MAXAXIS - len(axes)))])

    def axes(self, number_of_axes: int = MAXAXIS) -> tuple[int, ...]:
        """Return the numbers of the selected axes, in their order.

        Raises:
            UsageError: `unoa` is no number of axes, or `san` names an axis that is not there.
        """
        if not 0 <= self.unoa <= min(len(self.san), MAXAXIS):
            raise UsageError(f"unoa is {self.unoa}", hint=f"select 0 to {MAXAXIS} axes")
        return tuple(axis_number(number, number_of_axes) for number in self.san[: self.unoa])

    @property
    def names_an_axis_twice(self) -> bool:
        """Tell whether a command with this selection is refused with ErrorReg.errAxDef."""
        chosen = self.san[: self.unoa]
        return len(set(chosen)) < len(chosen)


def pack_all(records: Iterable[Structure]) -> bytes:
    """Return records that lie directly one after another, as the library wants its TSRP."""
    return b"".join(record.pack() for record in records)


def tsrp_array() -> list[TSRP]:
    """Return one TSRP per possible axis, as the functions that initialise the system want them."""
    return [TSRP() for _ in range(MAXAXIS)]


class LMP(_declared.LMP):
    """Parameters of a linear interpolation, table 5; `dtm` is indexed by axis number."""

    __slots__ = ()

    def distances(self, selection: AS) -> tuple[float, ...]:
        """Return the distances or targets of the selected axes, in the order of the selection."""
        return tuple(self.dtm[axis] for axis in selection.axes())


class HMP(_declared.HMP):
    """Parameters of a helical interpolation, table 7."""

    __slots__ = ()

    @property
    def ends_at_target(self) -> bool:
        """Tell whether the circle ends at the point in `dtm`, because `phi` is no angle."""
        return abs(self.phi) <= TARGET_POINT_PHI

    @property
    def turns_clockwise(self) -> bool:
        """Tell the direction, which is the sign of `phi` also where the circle ends at a point; 0.0 is positive."""
        return math.copysign(1.0, self.phi) < 0.0


class SPDBUF(_declared.SPDBUF):
    """Setpoints for spd, spda and spdr."""

    __slots__ = ()

    def points(self, size: int) -> tuple[float, ...]:
        """Return the first `size` positions.

        Raises:
            UsageError: `size` is not 1 to 1000.
        """
        if not 1 <= size <= COMMON_VARIABLES:
            raise UsageError(f"{size} positions", hint=f"pass 1 to {COMMON_VARIABLES}")
        return tuple(self.position[:size])


STRUCTURES = HEADER.layouts
"""What lies where, by the record's name."""

# fmt: off
__all__ = [
    "AS", "CBCNCT", "CDBUF", "CIBUF", "CMP", "CNCTS", "CTRLPARAMS", "HMP", "HMP3D", "LATCH_INFOS", "LMP",
    "MAXAXIS", "ROSI", "SPDBUF", "STRUCTURES", "TRU", "TSRP", "tsrp_array",
]
# fmt: on
