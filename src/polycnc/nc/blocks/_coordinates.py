"""Where program zero is: work offsets, shifts of the program and tool length, summed into one offset per axis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.nc.blocks._tables import COMMON_OFFSET, ProgramTables
from polycnc.nc.modal._frame import Rotation
from polycnc.nc.modal._modal import Modal
from polycnc.nc.modal._placement import NO_SHIFTS, Shifts

Floats: TypeAlias = npt.NDArray[np.float64]

MACHINE_ZERO = ""
WORK_GROUPS = 3
"""Groups of work offsets that add up: G54 to G59, G154 to G159, G254 to G259."""


def work_group(code: float) -> int:
    """Return the group of a work offset by its G code: the hundreds."""
    return int(code) // 100


@dataclass(frozen=True, slots=True, eq=False)
class Coordinates:
    """Hold the zero shifts of one channel; every vector has one value per axis, mm or degree, and is never changed.

    `work` names the active work offset of each group, MACHINE_ZERO for none. `shift` is that of G92, which counts while
    `shifted` and is kept while not, `local` that of G52. `length_sign` is 1 or -1 while tool length compensation is
    active, else 0. `inner` are shifts of programmed positions besides, `outer` those of a workpiece that `turn` turns;
    `external` names further offsets in force, `compensations` codes of further tool data. `selected` is the first work
    offset as it was when it was selected, where the table has been changed since and that waits for the next selection.
    """

    shift: Floats
    local: Floats
    length: Floats
    inner: Floats
    outer: Floats
    work: tuple[str, ...] = (MACHINE_ZERO,) * WORK_GROUPS
    length_sign: int = 0
    turn: Rotation | None = None
    external: tuple[str, ...] = ()
    compensations: tuple[int, ...] = ()
    shifted: bool = False
    selected: Floats | None = None

    @classmethod
    def none(cls, axes: int) -> Coordinates:
        """Return those of a channel in which nothing is shifted."""
        zero = np.zeros(axes)
        return cls(zero, zero, zero, zero, zero)

    def with_work_offset(self, group: int, name: str) -> Coordinates:
        """Return the same with work offset `name` (G54, ...) of a group; MACHINE_ZERO for none."""
        selected = self.selected if name == self.work[0] else None
        return replace(self, work=(*self.work[:group], name, *self.work[group + 1 :]), selected=selected)

    def first_offset(self, tables: ProgramTables) -> Floats:
        """Return the first work offset in force."""
        return np.array(tables.work_offset(self.work[0])) if self.selected is None else self.selected

    def with_shift(self, ways: dict[int, float]) -> Coordinates:
        """Return the same with program zero shifted further along some axes."""
        old = self.shift if self.shifted else np.zeros_like(self.shift)
        return replace(self, shift=_changed(old, ways, add=True), shifted=True)

    def with_shift_of(self, values: dict[int, float]) -> Coordinates:
        """Return the same with the shift of some axes as these values say."""
        old = self.shift if self.shifted else np.zeros_like(self.shift)
        return replace(self, shift=_changed(old, values), shifted=True)

    def keeping_shift(self, values: dict[int, float]) -> Coordinates:
        """Return the same with other values of that shift, which count when they did."""
        return replace(self, shift=_changed(self.shift, values))

    def without_shift(self) -> Coordinates:
        """Return the same without that shift."""
        return replace(self, shift=np.zeros_like(self.shift), shifted=False)

    def with_local(self, values: dict[int, float], *, add: bool = False) -> Coordinates:
        """Return the same with the zero of a local coordinate system in every work coordinate system."""
        return replace(self, local=_changed(self.local, values, add=add))

    def with_length(self, values: dict[int, float], sign: int) -> Coordinates:
        """Return the same with what the tool shifts some axes by; sign 0 is no tool length compensation."""
        return replace(self, length=_changed(np.zeros_like(self.length), values), length_sign=sign)

    def tool_offset(self, tables: ProgramTables, modal: Modal) -> Floats:
        """Return what tools shift every axis by (mm)."""
        if not self.compensations:
            return self.length
        further: Floats = np.array(tables.tool_shift(self.compensations, modal))
        return self.length + further

    def zero_offset(self, tables: ProgramTables) -> Floats:
        """Return what zero offsets, without those of the program, shift every axis by."""
        return self._with_offsets(np.zeros_like(self.length), tables)

    def total(self, tables: ProgramTables, modal: Modal) -> Floats:
        """Return the sum of all shifts."""
        return self._with_offsets(self._within() + self.tool_offset(tables, modal) + self.outer, tables)

    def shifts(self) -> Shifts:
        """Return what is shown of the program's own."""
        preset = self.shift if self.shifted else np.zeros(0)
        within = self._within()
        if self.turn is None and not within.any() and not preset.any():
            return NO_SHIFTS
        return Shifts(tuple(preset.tolist()), tuple(within.tolist()), self.turn)

    def _within(self) -> Floats:
        """Return what the program itself shifts by, turned with the workpiece."""
        within = self.shift + self.local + self.inner if self.shifted else self.local + self.inner
        if (turn := self.turn) is not None:
            within[turn.p], within[turn.q] = turn.turned(float(within[turn.p]), float(within[turn.q]))
        return within

    def _with_offsets(self, found: Floats, tables: ProgramTables) -> Floats:
        names = (COMMON_OFFSET, *self.work) if tables.has_offset(COMMON_OFFSET) else self.work
        for name in (*names, *self.external):
            if name == self.work[0] and self.selected is not None:
                found = found + self.selected
            elif name != MACHINE_ZERO:
                found = found + tables.work_offset(name)
        return found


def _changed(vector: Floats, values: dict[int, float], *, add: bool = False) -> Floats:
    found = vector.copy()
    for axis, value in values.items():
        if axis >= 0:
            found[axis] = value + (found[axis] if add else 0.0)
    return found
