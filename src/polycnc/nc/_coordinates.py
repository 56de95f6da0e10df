"""Where program zero is: work offsets, the G92 shift and tool length, summed into one offset per axis."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.nc._modal import Modal

Floats = npt.NDArray[np.float64]

MACHINE_ZERO = ""


@dataclass
class Coordinates:
    """Hold the zero shifts of one channel; every vector has one value per axis, mm or degree."""

    machine: MachineConfig
    modal: Modal
    work: str = MACHINE_ZERO  # name of the active work offset, MACHINE_ZERO for none
    shift: Floats = field(init=False)  # G92
    length: Floats = field(init=False)  # tool length compensation

    def __post_init__(self) -> None:
        axes = len(self.machine.axes)
        self.shift = np.zeros(axes)
        self.length = np.zeros(axes)
        self.renew()

    def renew(self) -> None:
        """Put the sum of all shifts in force."""
        work = self.machine.work_offset(self.work) if self.work else 0.0
        self.modal.offset[:] = work + self.shift + self.length

    def select_work_offset(self, name: str) -> None:
        """Take work offset `name` (G54, ...); MACHINE_ZERO for none."""
        self.work = name
        self.renew()

    def set_position(self, axis: int, value: float) -> None:
        """Shift program zero so that the present position of `axis` reads `value` (mm or degree)."""
        self.shift[axis] += self.modal.position[axis] - self.modal.offset[axis] - value
        self.renew()

    def clear_shift(self) -> None:
        """Take the G92 shift back."""
        self.shift[:] = 0.0
        self.renew()

    def set_length(self, axis: int, length_mm: float) -> None:
        """Compensate the tool length along `axis`; 0 cancels."""
        self.length[:] = 0.0
        self.length[axis] = length_mm
        self.renew()

    def saved(self) -> Coordinates:
        """Return a copy to go back to."""
        other = copy.copy(self)
        other.shift = self.shift.copy()
        other.length = self.length.copy()
        return other
