"""The records that programs exchange with the board, tables 2 to 11: the manual's names, in the manual's order.

The dataclasses are the tables: `pack` and `unpack` follow their annotations (see `_layout`). A new record is
zero throughout.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeAlias

from polycnc.controllers.apci.board._layout import Cell, Double, Longint, Pointer, Record
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

AxisDoubles: TypeAlias = Annotated[list[float], Cell("double", "d", (MAXAXIS,))]
AxisLongints: TypeAlias = Annotated[list[int], Cell("LONGINT", "i", (MAXAXIS,))]
CommonDoubles: TypeAlias = Annotated[list[float], Cell("double", "d", (COMMON_VARIABLES,))]
CommonLongints: TypeAlias = Annotated[list[int], Cell("LONGINT", "i", (COMMON_VARIABLES,))]


def _zeros(length: int, zero: Any = 0.0) -> Callable[[], Any]:
    return lambda: [zero] * length


def axis_number(number: int, axes: int = MAXAXIS) -> int:
    """Return `number`, which counts from 0.

    Raises:
        UsageError: There is no such axis among `axes` axes.
    """
    if not 0 <= number < axes:
        raise UsageError(f"there is no axis {number}", hint=f"axes have the numbers 0 to {axes - 1}")
    return number


@dataclass(slots=True)
class AS(Record):
    """Axis selection, table 2: `unoa` axes, whose numbers from 0 stand at the front of `san`."""

    unoa: Longint = 0
    san: AxisLongints = field(default_factory=_zeros(MAXAXIS, 0))

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


@dataclass(slots=True)
class TSRP(Record):
    """What is exchanged about one axis, table 3.

    The last four are used by functions but stand in no table, so they are not part of the memory.
    """

    an: Longint = 0
    kp: Double = 0.0
    ki: Double = 0.0
    kd: Double = 0.0
    kpl: Double = 0.0
    kfca: Double = 0.0
    kfcv: Double = 0.0
    jac: Double = 0.0
    jvl: Double = 0.0
    jtv: Double = 0.0
    jovr: Double = 0.0
    hac: Double = 0.0
    hvl: Double = 0.0
    rp: Double = 0.0
    dp: Double = 0.0
    tp: Double = 0.0
    sll: Double = 0.0
    slr: Double = 0.0
    ipw: Double = 0.0
    mpe: Double = 0.0
    gf: Double = 0.0
    mcp: Longint = 0
    axst: Longint = 0
    lsm: Longint = 0
    epc: Longint = 0
    digi: Longint = 0
    digo: Longint = 0
    ifs: Longint = 0
    scratch: Annotated[list[int], Cell("LONGINT", "i", (4,))] = field(default_factory=_zeros(4, 0))
    aux: float = 0.0
    lp: float = 0.0
    dv: float = 0.0
    sdec: float = 0.0


def tsrp_array() -> list[TSRP]:
    """Return one TSRP per possible axis, as the functions that initialise the system want them."""
    return [TSRP() for _ in range(MAXAXIS)]


@dataclass(slots=True)
class TRU(Record):
    """Units of interpolation, table 4: indices of the position and the time unit."""

    pu: Longint = 0
    tu: Longint = 0


@dataclass(slots=True)
class LMP(Record):
    """Parameters of a linear interpolation, table 5; `dtm` is indexed by axis number."""

    ac: Double = 0.0
    vl: Double = 0.0
    tvl: Double = 0.0
    dtm: AxisDoubles = field(default_factory=_zeros(MAXAXIS))

    def distances(self, selection: AS) -> tuple[float, ...]:
        """Return the distances or targets of the selected axes, in the order of the selection."""
        return tuple(self.dtm[axis] for axis in selection.axes())


@dataclass(slots=True)
class CMP(Record):
    """Parameters of a circular interpolation, table 6; `phi` in degrees, positive anti-clockwise."""

    ac: Double = 0.0
    vl: Double = 0.0
    tvl: Double = 0.0
    phi: Double = 0.0
    dtca1: Double = 0.0
    dtca2: Double = 0.0


@dataclass(slots=True)
class HMP(Record):
    """Parameters of a helical interpolation, table 7."""

    ac: Double = 0.0
    vl: Double = 0.0
    tvl: Double = 0.0
    phi: Double = 0.0
    dtca1: Double = 0.0
    dtca2: Double = 0.0
    dtm: AxisDoubles = field(default_factory=_zeros(MAXAXIS))

    @property
    def ends_at_target(self) -> bool:
        """Tell whether the circle ends at the point in `dtm`, because `phi` is no angle."""
        return abs(self.phi) <= TARGET_POINT_PHI

    @property
    def turns_clockwise(self) -> bool:
        """Tell the direction, which is the sign of `phi` also where the circle ends at a point; 0.0 is positive."""
        return math.copysign(1.0, self.phi) < 0.0


@dataclass(slots=True)
class HMP3D(Record):
    """Parameters of a circle in space, table 8; `pn1` to `pn3` are normal to its plane, `dtm` is not used."""

    ac: Double = 0.0
    vl: Double = 0.0
    tvl: Double = 0.0
    phi: Double = 0.0
    dtca1: Double = 0.0
    dtca2: Double = 0.0
    dtca3: Double = 0.0
    pn1: Double = 0.0
    pn2: Double = 0.0
    pn3: Double = 0.0
    dtm: AxisDoubles = field(default_factory=_zeros(MAXAXIS))


@dataclass(slots=True)
class ROSI(Record):
    """What the board says about its operating system, table 9; all zero if it does not answer."""

    revision: Annotated[str, Cell("char", "s", (SIZE_STRREV,))] = ""
    number_axis: Longint = 0
    sysfile_loaded: Longint = 0


@dataclass(slots=True)
class CBCNCT(Record):
    """A transfer of a CNC task's common buffer, table 10."""

    task_number: Longint = 0
    size: Longint = 0
    buffer: Pointer = field(default_factory=bytearray)


@dataclass(slots=True)
class CNCTS(Record):
    """State of a CNC task, table 11; for the bits of `running` see `Running`."""

    errnum: Longint = 0
    errline: Longint = 0
    stackfree: Longint = 0
    running: Longint = 0
    csrcline: Longint = 0


@dataclass(slots=True)
class LATCH_INFOS(Record):  # noqa: N801
    """What lpr and lprs record. Only the element `san`, the axis of lpr, is known."""

    san: Longint = 0


@dataclass(slots=True)
class CDBUF(Record):
    """The common double variables CD0 to CD999."""

    cd: CommonDoubles = field(default_factory=_zeros(COMMON_VARIABLES))


@dataclass(slots=True)
class CIBUF(Record):
    """The common integer variables CI0 to CI999."""

    ci: CommonLongints = field(default_factory=_zeros(COMMON_VARIABLES, 0))


@dataclass(slots=True)
class SPDBUF(Record):
    """Setpoints for spd, spda and spdr."""

    position: CommonDoubles = field(default_factory=_zeros(COMMON_VARIABLES))

    def points(self, size: int) -> tuple[float, ...]:
        """Return the first `size` positions.

        Raises:
            UsageError: `size` is not 1 to 1000.
        """
        if not 1 <= size <= COMMON_VARIABLES:
            raise UsageError(f"{size} positions", hint=f"pass 1 to {COMMON_VARIABLES}")
        return tuple(self.position[:size])


@dataclass(slots=True)
class CTRLPARAMS(Record):
    """The parameter field of scp, 15 rows of 15."""

    parameters: Annotated[list[list[float]], Cell("double", "d", (15, 15))] = field(
        default_factory=lambda: [[0.0] * 15 for _ in range(15)]
    )


@dataclass(slots=True)
class CppString(Record):
    """The in and out text of getEnvStr: a name goes in, its value comes out."""

    text: Annotated[str, Cell("char", "s", (ENVIRONMENT_STRING_BYTES,))] = ""
