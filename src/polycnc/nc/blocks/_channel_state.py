"""Everything that a block may change besides the queue."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.nc.blocks._compensation import RadiusCompensation
from polycnc.nc.blocks._coordinates import Coordinates, Floats
from polycnc.nc.blocks._corners import Corner
from polycnc.nc.blocks._cycles import CycleWords
from polycnc.nc.blocks._nurbs_curve import Nurbs
from polycnc.nc.blocks._probe import Probe
from polycnc.nc.blocks._tables import ProgramTables
from polycnc.nc.blocks._tip import TipShift
from polycnc.nc.blocks._turning import Turning
from polycnc.nc.modal._actions import Family
from polycnc.nc.modal._frame import UNTURNED, Frame, Rotation
from polycnc.nc.modal._modal import (
    AXIS_P,
    AXIS_Q,
    AXIS_R,
    CHANGING,
    FEED_NUMBER,
    NO_AXIS,
    PLANE,
    PLANE_LETTERS,
    Modal,
    changing,
    copy_modal,
)
from polycnc.nc.modal._modal_snapshot import ModalSnapshot, Spindle
from polycnc.nc.modal._placement import NO_PLACEMENT, NO_SHIFTS, Placement


@dataclass(frozen=True, slots=True)
class Cycle:
    """Hold the active drilling cycle (its action, empty: none; the G code that called it) and its words.

    Levels are those of the program; `initial` is where the drilling axis was when the first cycle began, in machine
    coordinates. `last_dwell_s` is the last dwell of a cycle, which some controls keep.
    """

    action: str = ""
    code: float = 80.0
    retract_to_initial: bool = True
    initial: float = 0.0
    words: CycleWords = field(default_factory=CycleWords)
    last_dwell_s: float | None = None


@dataclass
class Plain:
    """Hold the part of the state that is plain values.

    `tool` is in the spindle, `selected_tool` comes with the next tool change. `feed_word` is the F word of the
    present block as programmed, 0 without one. `side` is 1 for radius compensation left of the path, -1 right,
    0 off; `compensation_tool` the last D word, None before the first, `length_tool` the tool whose length is
    compensated. `path_tolerance_mm` is how far corners may be rounded, or that they are stops, `merge_mm` how
    far points may lie off the line that several are merged into. `m_codes` are those of the last block that had
    any. `frame` is how programmed positions are turned, scaled and mirrored, `placement` where they lie besides,
    `references` are the reference positions that the program has set,
    `skip_position` where the last skip move ended (machine coordinates), `probe` the last probing.
    `corner` is a straight move that waits for the next one, `nurbs` a curve that is being written, `spline_way` leads
    from the end of a cubic spline to its last control point turned about, until anything else moves.
    With `rigid_tap` a tapping cycle turns the spindle itself. `turning` is what turning cycles keep, `tip` where
    the tip of a turning tool lies. `mode` is the mode of motion in force, which gives the moves of a block.
    """

    spindle: Spindle = field(default_factory=Spindle)
    cycle: Cycle = field(default_factory=Cycle)
    tool: int = 0
    selected_tool: int = 0
    feed_word: float = 0.0
    path_tolerance_mm: float = 0.0
    merge_mm: float = 0.0
    side: int = 0
    compensation_tool: int | None = None
    length_tool: int = 0
    m_codes: tuple[int, ...] = ()
    frame: Frame = UNTURNED
    skip_position: tuple[float, ...] | None = None
    placement: Placement = NO_PLACEMENT
    probe: Probe | None = None
    rigid_tap: bool = False
    turning: Turning = field(default_factory=Turning)
    tip: TipShift = field(default_factory=TipShift)
    corner: Corner | None = None
    spline_way: tuple[float, float] | None = None
    nurbs: Nurbs | None = None
    mode: Family = Family.MOVE
    references: tuple[tuple[float, ...] | None, tuple[float, ...] | None] = (None, None)


class SavedState(NamedTuple):
    """Hold a state for a snapshot of its channel."""

    modal: tuple[npt.NDArray[Any], ...]
    coordinates: Coordinates
    compensation: RadiusCompensation | None
    plain: Plain


def of_another_channel(axis: str) -> str:
    """Return the name of an axis in a channel that does not own it: one that no word of a program has."""
    return f"({axis})"


class ChannelState(Plain):
    """Hold everything that a block may change, besides the queue.

    `tables` are the tools and work offsets, `coordinates` the shifts of program zero, `compensation` the stage of
    radius compensation, `axis_names` what programs call the axes.
    """

    def __init__(self, machine: MachineConfig, modal: Modal) -> None:
        path = machine.path
        super().__init__(path_tolerance_mm=path.tolerance_mm, merge_mm=path.merge_mm)
        self.machine = machine
        self.modal = modal
        self._memory = changing(modal)  # of the columns
        self.tables = ProgramTables(machine)
        self.coordinates = Coordinates.none(len(modal.position))
        self._shifts = NO_SHIFTS
        self._tables_taken = self._tables_revision()
        self.compensation = RadiusCompensation()
        self.axis_names: Sequence[str] = machine.axis_names

    def copy(self) -> ChannelState:
        """Return a state of its own that is equal; tools and work offsets are the same."""
        made = copy.copy(self)
        made.modal = copy_modal(self.modal)
        made._memory = changing(made.modal)
        made.compensation = self.compensation.copy()
        return made

    def take(self, other: ChannelState) -> None:
        """Become equal to another state of the same channel; the columns stay the arrays that others hold.

        The stage of radius compensation is that of `other`: who changes it copies it before.
        """
        modal, memory = self.modal, self._memory
        self.__dict__.update(other.__dict__)
        self.modal, self._memory = modal, memory
        memory[:] = other._memory

    def place_zero(self, coordinates: Coordinates) -> None:
        """Put program zero where these shifts say."""
        self.coordinates = coordinates
        self._shifts = coordinates.shifts()
        self._tables_taken = self._tables_revision()
        self.modal.offset[:] = coordinates.total(self.tables, self.modal)

    def take_changes(self) -> None:
        """Take over work offsets that have been changed in the table since."""
        if self._tables_revision() != self._tables_taken:
            self.place_zero(self.coordinates)

    def _tables_revision(self) -> int:
        """Return how often the tables of work offsets have been changed: those of the program and of the machine."""
        machine = self.machine
        return self.tables.changes + sum(
            int(getattr(each, "revision", 0)) for each in (machine.offsets, machine.tools)
        )

    def turn_work(self) -> None:
        """Turn the plane of X and Y as the active work offset says, where the program has turned one."""
        angle = self.tables.turn_of(self.coordinates.work[0])
        if angle == 0.0 and self.frame.outer is None:
            return
        turn = self.turn_of(self.coordinates.work[0])
        self.frame = replace(self.frame, outer=turn)
        self.place_zero(replace(self.coordinates, turn=turn))

    def turn_of(self, name: str) -> Rotation | None:
        """Return how a work offset turns the plane of X and Y; None if it does not."""
        angle = self.tables.turn_of(name)
        return Rotation(self.axis("X"), self.axis("Y"), 0.0, 0.0, angle) if angle else None

    def axis(self, letter: str) -> int:
        """Return the place of the axis that a letter names, NO_AXIS if there is none."""
        return int(self.modal.letter_axis[ord(letter) - ord("A")])

    @property
    def plane(self) -> tuple[int, int, int]:
        """The axes of the working plane: first, second, and normal; NO_AXIS for what the machine lacks."""
        whole = self.modal.whole
        return int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R])

    @property
    def plane_letters(self) -> str:
        """The letters of the working plane: first, second, and normal, whether the machine has them or not."""
        return PLANE_LETTERS[int(self.modal.whole[PLANE])]

    @property
    def here(self) -> list[float]:
        """The programmed position as seen from program zero (mm or degree)."""
        found: list[float] = (self.modal.position - self.modal.offset).tolist()
        return found

    def reference(self, number: int) -> tuple[float, ...]:
        """Return a reference position, 1 or 2 (mm or degree): the program's, else the machine's."""
        kept = self.references[number - 1]
        return tuple(axis.reference_position(number) for axis in self.machine.axes) if kept is None else kept

    @property
    def tool_offset(self) -> Floats:
        """What tools shift every axis by (mm)."""
        return self.coordinates.tool_offset(self.tables, self.modal)

    @property
    def zero_offset(self) -> Floats:
        """What zero offsets, without those of the program, shift every axis by (mm or degree)."""
        return self.coordinates.zero_offset(self.tables)

    def length_said_again(self) -> int | None:
        """Return the H word that would change nothing, None where there is none."""
        coordinates, tool = self.coordinates, self.length_tool
        axis = self.axis("Z")
        if coordinates.length_sign == 0 or tool == 0 or axis == NO_AXIS or not self.tables.has_tool(tool):
            return None
        data = self.tables.tool(tool)
        shift = coordinates.length_sign * (data.length_mm + data.wear_length_mm)
        same = coordinates.with_length({axis: shift}, coordinates.length_sign)
        return tool if np.array_equal(same.length, coordinates.length) else None

    def leave_drilling(self) -> None:
        """Leave a drilling cycle, and forget its words."""
        if self.cycle.action:
            old = self.cycle
            self.cycle = Cycle(retract_to_initial=old.retract_to_initial, last_dwell_s=old.last_dwell_s)
            self.rigid_tap = False
        if self.mode is Family.DRILLING:
            self.mode = Family.MOVE

    def leave_turning(self) -> None:
        """Leave a turning motion."""
        if self.turning.motion:
            self.turning = replace(self.turning, motion="", corner=(None, None), taper=0.0)
        if self.mode is Family.TURNING:
            self.mode = Family.MOVE

    def save(self) -> SavedState:
        """Return what a snapshot keeps."""
        modal = tuple(column.copy() for column in self.modal[CHANGING])
        stage = self.compensation.copy() if self.compensation.active else None
        return SavedState(modal, self.coordinates, stage, self.plain())

    def restore(self, saved: SavedState) -> None:
        """Go back to a snapshot."""
        for column, old in zip(self.modal[CHANGING], saved.modal, strict=True):
            column[...] = old
        self.coordinates = saved.coordinates
        self._shifts = saved.coordinates.shifts()
        self.compensation = RadiusCompensation() if saved.compensation is None else saved.compensation.copy()
        self.__dict__.update(vars(saved.plain))

    def plain(self) -> Plain:
        """Return the plain values."""
        return Plain(*(getattr(self, each.name) for each in fields(Plain)))

    def snapshot(self) -> ModalSnapshot:
        """Return what is in force now."""
        modal, coordinates = self.modal, self.coordinates
        return ModalSnapshot(
            modal.whole.tobytes(),
            float(modal.real[FEED_NUMBER]),
            modal.offset.tobytes(),
            coordinates.work,
            self.spindle,
            self.cycle.action,
            self.cycle.retract_to_initial,
            self.tool,
            self.selected_tool,
            self.side,
            self.compensation_tool,
            coordinates.length_sign,
            self.length_tool,
            self.m_codes,
            self.placement,
            self._shifts,
        )
