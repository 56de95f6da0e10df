"""Where program zero is: work offsets, the G92 shift and tool length, summed into one offset per axis."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.nc.blocks._modal import Modal

Floats: TypeAlias = npt.NDArray[np.float64]
SavedCoordinates: TypeAlias = tuple[tuple[str, ...], Floats, Floats, int]

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

    def __init__(self, machine: MachineConfig, modal: Modal) -> None:
        self._machine = machine
        self._modal = modal
        axes = len(machine.axes)
        self.work = (MACHINE_ZERO,) * WORK_GROUPS
        self.shift: Floats = np.zeros(axes)  # G92
        self.length: Floats = np.zeros(axes)
        self.length_sign = 0
        self._revision = _revision(machine)

    def save(self) -> SavedCoordinates:
        """Return what to go back to; the sum in `modal.offset` is the modal state's business."""
        return self.work, self.shift, self.length, self.length_sign

    def restore(self, saved: SavedCoordinates) -> None:
        """Go back to a saved state."""
        self.work, self.shift, self.length, self.length_sign = saved

    def select_work_offset(self, group: int, name: str) -> None:
        """Take work offset `name` (G54, ...) of a group; MACHINE_ZERO for none."""
        self.work = (*self.work[:group], name, *self.work[group + 1 :])
        self._renew()

    def set_position(self, axis: int, value: float) -> None:
        """Shift program zero so that the present position of `axis` reads `value` (mm or degree)."""
        self.shift = self.shift.copy()
        self.shift[axis] += self._modal.position[axis] - self._modal.offset[axis] - value
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

    def take_changes(self) -> None:
        """Take over work offsets that have been changed in the table since."""
        if _revision(self._machine) != self._revision:
            self._renew()

    def _renew(self) -> None:
        self._revision = _revision(self._machine)
        total = self.shift + self.length
        for name in self.work:
            if name != MACHINE_ZERO:
                total = total + self._machine.work_offset(name)
        self._modal.offset[:] = total


def _revision(machine: MachineConfig) -> int:
    """Return how often the table of work offsets has been changed; that of a machine file never is."""
    return int(getattr(machine.offsets, "revision", 0))
