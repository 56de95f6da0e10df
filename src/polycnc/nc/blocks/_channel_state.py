"""Everything that a block may change besides the queue."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

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
from polycnc.nc.modal._frame import UNTURNED, Frame
from polycnc.nc.modal._modal import CHANGING, FEED_NUMBER, Modal, changing, copy_modal
from polycnc.nc.modal._modal_snapshot import ModalSnapshot, Spindle
from polycnc.nc.modal._placement import Placement


@dataclass(frozen=True, slots=True)
class Cycle:
    """Hold the active drilling cycle (its action, empty: none; the G code that called it) and its words.

    Levels are those of the program; `initial` is where the drilling axis was when the first cycle began, in machine
    coordinates.
    """

    action: str = ""
    code: float = 80.0
    retract_to_initial: bool = True
    initial: float = 0.0
    words: CycleWords = field(default_factory=CycleWords)


class Plain(NamedTuple):
    """Hold the part of the state that is plain values."""

    spindle: Spindle
    cycle: Cycle
    tool: int
    selected_tool: int
    feed_word: float
    path_tolerance_mm: float
    merge_mm: float
    side: int
    compensation_tool: int | None
    length_tool: int
    m_codes: tuple[int, ...]
    frame: Frame
    skip_position: tuple[float, ...] | None
    placement: Placement
    probe: Probe | None
    rigid_tap: bool
    turning: Turning
    tip: TipShift
    corner: Corner | None
    spline_way: tuple[float, float] | None
    nurbs: Nurbs | None
    mode: Family


class SavedState(NamedTuple):
    """Hold a state for a snapshot of its channel."""

    modal: tuple[npt.NDArray[Any], ...]
    coordinates: Coordinates
    compensation: RadiusCompensation | None
    plain: Plain


def of_another_channel(axis: str) -> str:
    """Return the name of an axis in a channel that does not own it: one that no word of a program has."""
    return f"({axis})"


class ChannelState:
    """Hold everything that a block may change, besides the queue.

    `tool` is in the spindle, `selected_tool` comes with the next tool change. `feed_word` is the F word of the
    present block as programmed, 0 without one. `side` is 1 for radius compensation left of the path, -1 right,
    0 off; `compensation_tool` the last D word, None before the first, `length_tool` the tool whose length is
    compensated. `path_tolerance_mm` is how far corners may be rounded, or that they are stops, `merge_mm` how
    far points may lie off the line that several are merged into. `m_codes` are those of the last block that had
    any. `tables` are the tools and work offsets, `frame` how programmed positions are turned, scaled and mirrored,
    `placement` where they lie besides, `skip_position` where the last skip move ended (machine coordinates),
    `probe` the last probing.
    `spline_way` leads from the end of a cubic spline to its last control point turned about, until anything else moves.
    With `rigid_tap` a tapping cycle turns the spindle itself. `turning` is what turning cycles keep, `tip` where
    the tip of a turning tool lies. `mode` is the mode of motion in force, which gives the moves of a block.
    """

    def __init__(self, machine: MachineConfig, modal: Modal) -> None:
        self.machine = machine
        self.modal = modal
        self._memory = changing(modal)  # of the columns
        self.tables = ProgramTables(machine)
        self.coordinates = Coordinates.none(len(modal.position))
        self._tables_taken = self._tables_revision()
        self.frame = UNTURNED
        self.placement = Placement()
        self.probe: Probe | None = None
        self.skip_position: tuple[float, ...] | None = None
        self.compensation = RadiusCompensation()
        self.spindle = Spindle()
        self.cycle = Cycle()
        self.tool = 0
        self.selected_tool = 0
        self.feed_word = 0.0
        self.path_tolerance_mm = machine.path.tolerance_mm
        self.merge_mm = machine.path.merge_mm
        self.rigid_tap = False
        self.turning = Turning()
        self.tip = TipShift()
        self.corner: Corner | None = None  # a straight move that waits for the next one
        self.spline_way: tuple[float, float] | None = None
        self.nurbs: Nurbs | None = None  # a curve that is being written
        self.mode = Family.MOVE
        self.side = 0
        self.compensation_tool: int | None = None
        self.length_tool = 0
        self.m_codes: tuple[int, ...] = ()
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

    @property
    def tool_offset(self) -> Floats:
        """What tools shift every axis by (mm)."""
        return self.coordinates.tool_offset(self.tables, self.modal)

    @property
    def zero_offset(self) -> Floats:
        """What zero offsets, without those of the program, shift every axis by (mm or degree)."""
        return self.coordinates.zero_offset(self.tables)

    def leave_drilling(self) -> None:
        """Leave a drilling cycle, and forget its words."""
        if self.cycle.action:
            self.cycle = Cycle(retract_to_initial=self.cycle.retract_to_initial)
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
        self.compensation = RadiusCompensation() if saved.compensation is None else saved.compensation.copy()
        self.__dict__.update(saved.plain._asdict())

    def plain(self) -> Plain:
        """Return the plain values."""
        return Plain._make(getattr(self, name) for name in Plain._fields)

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
        )
