"""The records that programs exchange with the board, tables 2 to 11: the manual's names, in the manual's order.

The annotations are the tables; elements are aligned to at most 4 bytes. A new record is zero throughout.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterable
from typing import Annotated, TypeAlias

from polycnc.controllers.library import (
    DOUBLE,
    Address,
    Doubles,
    Latin,
    Number,
    Structure,
    Times,
    layouts,
    structure,
)
from polycnc.errors import UsageError

MAXAXIS = 18
LONGINT_BITS = 32
COMMON_VARIABLES = 1000
COMMON_BUFFER_BYTES = 1000
CNC_TASKS = 4
TASK_STRING_BYTES = 512
SIZE_STRREV = 80  # ruling: the manual names the constant without its value
ENVIRONMENT_STRING_BYTES = 1024  # the manual's example
TARGET_POINT_PHI = 1e-100  # an angle not larger than this: the circle ends at a target point

LONGINT: TypeAlias = Annotated[int, Number("LONGINT", ctypes.c_int32)]
Longints: TypeAlias = Annotated[ctypes.Array[ctypes.c_int32], Number("LONGINT", ctypes.c_int32)]
AxisDoubles: TypeAlias = Annotated[Doubles, Times(MAXAXIS)]
AxisLongints: TypeAlias = Annotated[Longints, Times(MAXAXIS)]
CommonDoubles: TypeAlias = Annotated[Doubles, Times(COMMON_VARIABLES)]
CommonLongints: TypeAlias = Annotated[Longints, Times(COMMON_VARIABLES)]


def axis_number(number: int, axes: int = MAXAXIS) -> int:
    """Return `number`, which counts from 0.

    Raises:
        UsageError: There is no such axis among `axes` axes.
    """
    if not 0 <= number < axes:
        raise UsageError(f"there is no axis {number}", hint=f"axes have the numbers 0 to {axes - 1}")
    return number


@structure(pack=4, checked=True)
class AS(Structure):
    """Axis selection, table 2: `unoa` axes, whose numbers from 0 stand at the front of `san`."""

    unoa: LONGINT
    san: AxisLongints

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


@structure(pack=4, checked=True)
class TSRP(Structure):
    """What is exchanged about one axis, table 3.

    The last four are used by functions but stand in no table, so they are not part of the memory.
    """

    an: LONGINT
    kp: DOUBLE
    ki: DOUBLE
    kd: DOUBLE
    kpl: DOUBLE
    kfca: DOUBLE
    kfcv: DOUBLE
    jac: DOUBLE
    jvl: DOUBLE
    jtv: DOUBLE
    jovr: DOUBLE
    hac: DOUBLE
    hvl: DOUBLE
    rp: DOUBLE
    dp: DOUBLE
    tp: DOUBLE
    sll: DOUBLE
    slr: DOUBLE
    ipw: DOUBLE
    mpe: DOUBLE
    gf: DOUBLE
    mcp: LONGINT
    axst: LONGINT
    lsm: LONGINT
    epc: LONGINT
    digi: LONGINT
    digo: LONGINT
    ifs: LONGINT
    scratch: Annotated[Longints, Times(4)]
    aux: float
    lp: float
    dv: float
    sdec: float


def pack_all(records: Iterable[Structure]) -> bytes:
    """Return records that lie directly behind each other, as the library wants its TSRP."""
    return b"".join(record.pack() for record in records)


def tsrp_array() -> list[TSRP]:
    """Return one TSRP per possible axis, as the functions that initialise the system want them."""
    return [TSRP() for _ in range(MAXAXIS)]


@structure(pack=4, checked=True)
class TRU(Structure):
    """Units of interpolation, table 4: indices of the position and the time unit."""

    pu: LONGINT
    tu: LONGINT


@structure(pack=4, checked=True)
class LMP(Structure):
    """Parameters of a linear interpolation, table 5; `dtm` is indexed by axis number."""

    ac: DOUBLE
    vl: DOUBLE
    tvl: DOUBLE
    dtm: AxisDoubles

    def distances(self, selection: AS) -> tuple[float, ...]:
        """Return the distances or targets of the selected axes, in the order of the selection."""
        return tuple(self.dtm[axis] for axis in selection.axes())


@structure(pack=4, checked=True)
class CMP(Structure):
    """Parameters of a circular interpolation, table 6; `phi` in degrees, positive anti-clockwise."""

    ac: DOUBLE
    vl: DOUBLE
    tvl: DOUBLE
    phi: DOUBLE
    dtca1: DOUBLE
    dtca2: DOUBLE


@structure(pack=4, checked=True)
class HMP(Structure):
    """Parameters of a helical interpolation, table 7."""

    ac: DOUBLE
    vl: DOUBLE
    tvl: DOUBLE
    phi: DOUBLE
    dtca1: DOUBLE
    dtca2: DOUBLE
    dtm: AxisDoubles

    @property
    def ends_at_target(self) -> bool:
        """Tell whether the circle ends at the point in `dtm`, because `phi` is no angle."""
        return abs(self.phi) <= TARGET_POINT_PHI

    @property
    def turns_clockwise(self) -> bool:
        """Tell the direction, which is the sign of `phi` also where the circle ends at a point; 0.0 is positive."""
        return math.copysign(1.0, self.phi) < 0.0


@structure(pack=4, checked=True)
class HMP3D(Structure):
    """Parameters of a circle in space, table 8; `pn1` to `pn3` are normal to its plane, `dtm` is not used."""

    ac: DOUBLE
    vl: DOUBLE
    tvl: DOUBLE
    phi: DOUBLE
    dtca1: DOUBLE
    dtca2: DOUBLE
    dtca3: DOUBLE
    pn1: DOUBLE
    pn2: DOUBLE
    pn3: DOUBLE
    dtm: AxisDoubles


@structure(pack=4, checked=True)
class ROSI(Structure):
    """What the board says about its operating system, table 9; all zero if it does not answer."""

    revision: Annotated[Latin, Times(SIZE_STRREV)]
    number_axis: LONGINT
    sysfile_loaded: LONGINT


@structure(pack=4, checked=True)
class CBCNCT(Structure):
    """A transfer of a CNC task's common buffer, table 10."""

    task_number: LONGINT
    size: LONGINT
    buffer: Annotated[bytearray, Address()]


@structure(pack=4, checked=True)
class CNCTS(Structure):
    """State of a CNC task, table 11; for the bits of `running` see `Running`."""

    errnum: LONGINT
    errline: LONGINT
    stackfree: LONGINT
    running: LONGINT
    csrcline: LONGINT


@structure(pack=4, checked=True)
class LATCH_INFOS(Structure):  # noqa: N801
    """What lpr and lprs record. Only the element `san`, the axis of lpr, is known."""

    san: LONGINT


@structure(pack=4, checked=True)
class CDBUF(Structure):
    """The common double variables CD0 to CD999."""

    cd: CommonDoubles


@structure(pack=4, checked=True)
class CIBUF(Structure):
    """The common integer variables CI0 to CI999."""

    ci: CommonLongints


@structure(pack=4, checked=True)
class SPDBUF(Structure):
    """Setpoints for spd, spda and spdr."""

    position: CommonDoubles

    def points(self, size: int) -> tuple[float, ...]:
        """Return the first `size` positions.

        Raises:
            UsageError: `size` is not 1 to 1000.
        """
        if not 1 <= size <= COMMON_VARIABLES:
            raise UsageError(f"{size} positions", hint=f"pass 1 to {COMMON_VARIABLES}")
        return tuple(self.position[:size])


@structure(pack=4, checked=True)
class CTRLPARAMS(Structure):
    """The parameter field of scp, 15 rows of 15."""

    parameters: Annotated[Doubles, Times(15, 15)]


@structure(pack=4, checked=True)
class CppString(Structure):
    """The in and out text of getEnvStr: a name goes in, its value comes out."""

    text: Annotated[Latin, Times(ENVIRONMENT_STRING_BYTES)]


STRUCTURES = layouts(
    AS,
    TSRP,
    TRU,
    LMP,
    CMP,
    HMP,
    HMP3D,
    ROSI,
    CBCNCT,
    CNCTS,
    LATCH_INFOS,
    CDBUF,
    CIBUF,
    SPDBUF,
    CTRLPARAMS,
    CppString,
)
"""What lies where, by the record's name."""

# fmt: off
__all__ = [
    "AS", "CBCNCT", "CDBUF", "CIBUF", "CMP", "CNCTS", "CTRLPARAMS", "HMP", "HMP3D", "LATCH_INFOS", "LMP",
    "MAXAXIS", "ROSI", "SPDBUF", "STRUCTURES", "TRU", "TSRP", "tsrp_array",
]
# fmt: on
