"""Where program zero is: work offsets, shifts of the program and tool length, summed into one offset per axis."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.nc.blocks._tables import COMMON_OFFSET, ProgramTables
from polycnc.nc.modal._frame import Rotation
from polycnc.nc.modal._modal import Modal

Floats: TypeAlias = npt.NDArray[np.float64]
SavedCoordinates: TypeAlias = tuple[
    tuple[str, ...],
    Floats,
    Floats,
    Floats,
    int,
    Floats,
    Floats,
    Rotation | None,
    tuple[str, ...],
    tuple[int, ...],
]

MACHINE_ZERO = ""
WORK_GROUPS = 3
"""Groups of work offsets that add up: G54 to G59, G154 to G159, G254 to G259."""


def work_group(code: float) -> int:
    """Return the group of a work offset by its G code: the hundreds."""
    return int(code) // 100


class Coordinates:
    """Hold the zero shifts of one channel; every vector has one value per axis, mm or degree.

    `work` names the active work offset of each group, MACHINE_ZERO for none. `length_sign` is 1 or -1 while
    tool length compensation is active, else 0. `inner` are shifts of programmed positions besides, `outer` those of a
    workpiece that `turn` turns; `external` names further offsets in force, `compensations` codes of further tool data.
    The vectors are replaced, never changed in place.
    """

    def __init__(self, tables: ProgramTables, modal: Modal) -> None:
        self._tables = tables
        self._modal = modal
        axes = len(modal.position)
        self.work = (MACHINE_ZERO,) * WORK_GROUPS
        self.shift: Floats = np.zeros(axes)  # G92
        self.local: Floats = np.zeros(axes)  # G52
        self.length: Floats = np.zeros(axes)
        self.length_sign = 0
        self.inner: Floats = np.zeros(axes)
        self.outer: Floats = np.zeros(axes)
        self.turn: Rotation | None = None
        self.external: tuple[str, ...] = ()
        self.compensations: tuple[int, ...] = ()
        self._revision = tables.revision

    def save(self) -> SavedCoordinates:
        """Return what to go back to; the sum in `modal.offset` is the modal state's business."""
        return (
            self.work, self.shift, self.local, self.length, self.length_sign,
            self.inner, self.outer, self.turn, self.external, self.compensations,
        )  # fmt: skip

    def restore(self, saved: SavedCoordinates) -> None:
        """Go back to a saved state."""
        (
            self.work, self.shift, self.local, self.length, self.length_sign,
            self.inner, self.outer, self.turn, self.external, self.compensations,
        ) = saved  # fmt: skip

    def select_work_offset(self, group: int, name: str) -> None:
        """Take work offset `name` (G54, ...) of a group; MACHINE_ZERO for none."""
        self.work = (*self.work[:group], name, *self.work[group + 1 :])
        self._renew()

    def set_position(self, axis: int, value: float) -> None:
        """Shift program zero so that the present position of `axis` reads `value` (mm or degree)."""
        self.shift = self.shift.copy()
        self.shift[axis] += self._modal.position[axis] - self._modal.offset[axis] - value
        self._renew()

    def set_local(self, values: dict[int, float], *, add: bool = False) -> None:
        """Put the zero of a local coordinate system into every work coordinate system (mm or degree)."""
        self.local = self.local.copy()
        for axis, value in values.items():
            self.local[axis] = value + (self.local[axis] if add else 0.0)
        self._renew()

    def clear_shift(self) -> None:
        """Take the G92 shift back."""
        self.shift = np.zeros_like(self.shift)
        self._renew()

    def set_length(self, axis: int, sign: int, length_mm: float = 0.0) -> None:
        """Compensate the tool length along `axis` by `sign` times `length_mm`; sign 0 cancels."""
        self.length_sign = sign
        self.length = np.zeros_like(self.length)
        self.length[axis] = sign * length_mm
        self._renew()

    def set_tool(self, values: dict[int, float], *, active: bool) -> None:
        """Compensate where the tip of a tool lies, along several axes (mm)."""
        self.length_sign = int(active)
        self.length = np.zeros_like(self.length)
        for axis, value in values.items():
            if axis >= 0:
                self.length[axis] = value
        self._renew()

    def place(self, inner: list[float], outer: list[float], turn: Rotation | None) -> None:
        """Shift programmed positions by `inner`, and put the workpiece where `outer` and `turn` say."""
        self.inner, self.outer, self.turn = np.array(inner), np.array(outer), turn
        self._renew()

    def set_external(self, offsets: tuple[str, ...], compensations: tuple[int, ...]) -> None:
        """Take further offsets by name, and further tool data by code."""
        self.external, self.compensations = offsets, compensations
        self._renew()

    def take_changes(self) -> None:
        """Take over work offsets that have been changed in the table since."""
        if self._tables.revision != self._revision:
            self._renew()

    @property
    def tool_offset(self) -> Floats:
        """What tools shift every axis by (mm)."""
        found = self.length
        if self.compensations:
            found = found + np.array(self._tables.tool_shift(self.compensations, self._modal))
        return found

    @property
    def zero_offset(self) -> Floats:
        """What zero offsets, without those of the program, shift every axis by (mm or degree)."""
        found = np.zeros_like(self.length)
        names = (COMMON_OFFSET, *self.work) if self._tables.has_offset(COMMON_OFFSET) else self.work
        for name in (*names, *self.external):
            if name != MACHINE_ZERO:
                found = found + self._tables.work_offset(name)
        return found

    def _renew(self) -> None:
        self._revision = self._tables.revision
        within = self.shift + self.local + self.inner
        if (turn := self.turn) is not None:
            within[turn.p], within[turn.q] = turn.turned(float(within[turn.p]), float(within[turn.q]))
        total = within + self.tool_offset + self.outer
        names = (COMMON_OFFSET, *self.work) if self._tables.has_offset(COMMON_OFFSET) else self.work
        for name in (*names, *self.external):
            if name != MACHINE_ZERO:
                total = total + self._tables.work_offset(name)
        self._modal.offset[:] = total
