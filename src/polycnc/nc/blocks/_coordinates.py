"""Where program zero is: work offsets, the G92 shift and tool length, summed into one offset per axis."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.nc.blocks._modal import Modal
from polycnc.nc.blocks._tables import COMMON_OFFSET, ProgramTables

Floats: TypeAlias = npt.NDArray[np.float64]
SavedCoordinates: TypeAlias = tuple[tuple[str, ...], Floats, Floats, Floats, int]

MACHINE_ZERO = ""
WORK_GROUPS = 3
"""Groups of work offsets that add up: G54 to G59, G154 to G159, G254 to G259."""


def work_group(code: float) -> int:
    """Return the group of a work offset by its G code: the hundreds."""
    return int(code) // 100


class Coordinates:
    """Hold the zero shifts of one channel; every vector has one value per axis, mm or degree.

    `work` names the active work offset of each group, MACHINE_ZERO for none. `length_sign` is 1 or -1 while
    tool length compensation is active, else 0. The vectors are replaced, never changed in place.
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
        self._revision = tables.revision

    def save(self) -> SavedCoordinates:
        """Return what to go back to; the sum in `modal.offset` is the modal state's business."""
        return self.work, self.shift, self.local, self.length, self.length_sign

    def restore(self, saved: SavedCoordinates) -> None:
        """Go back to a saved state."""
        self.work, self.shift, self.local, self.length, self.length_sign = saved

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

    def take_changes(self) -> None:
        """Take over work offsets that have been changed in the table since."""
        if self._tables.revision != self._revision:
            self._renew()

    def _renew(self) -> None:
        self._revision = self._tables.revision
        total = self.shift + self.local + self.length
        names = (COMMON_OFFSET, *self.work) if self._tables.has_offset(COMMON_OFFSET) else self.work
        for name in names:
            if name != MACHINE_ZERO:
                total = total + self._tables.work_offset(name)
        self._modal.offset[:] = total
