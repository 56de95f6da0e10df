"""Everything that a block may change besides the queue, and going back when a block is refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.nc.blocks._compensation import RadiusCompensation
from polycnc.nc.blocks._coordinates import Coordinates, SavedCoordinates
from polycnc.nc.blocks._corners import Corner
from polycnc.nc.blocks._cycles import CycleWords
from polycnc.nc.blocks._nurbs_curve import Nurbs
from polycnc.nc.blocks._probe import Probe
from polycnc.nc.blocks._tables import ProgramTables
from polycnc.nc.blocks._tip import TipShift
from polycnc.nc.blocks._turning import Turning
from polycnc.nc.modal._frame import Frame
from polycnc.nc.modal._modal import FEED_NUMBER, Modal, restore_modal, save_modal
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


class SavedState(NamedTuple):
    """Hold a state to go back to."""

    modal: tuple[npt.NDArray[Any], ...]
    coordinates: SavedCoordinates
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
    the tip of a turning tool lies.
    """

    def __init__(self, machine: MachineConfig, modal: Modal) -> None:
        self.machine = machine
        self.modal = modal
        self.tables = ProgramTables(machine)
        self.coordinates = Coordinates(self.tables, modal)
        self.frame = Frame()
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
        self.side = 0
        self.compensation_tool: int | None = None
        self.length_tool = 0
        self.m_codes: tuple[int, ...] = ()
        self.axis_names: Sequence[str] = machine.axis_names

    def save(self) -> SavedState:
        """Return the state to go back to."""
        return SavedState(
            save_modal(self.modal),
            self.coordinates.save(),
            self.compensation.copy() if self.compensation.active else None,
            self.plain(),
        )

    def restore(self, saved: SavedState) -> None:
        """Go back to a saved state."""
        restore_modal(self.modal, saved.modal)
        self.coordinates.restore(saved.coordinates)
        if saved.compensation is None:
            self.compensation.reset()
        else:
            self.compensation = saved.compensation.copy()
        for name, value in zip(Plain._fields, saved.plain, strict=True):
            setattr(self, name, value)

    def plain(self) -> Plain:
        """Return the plain values."""
        return Plain(
            self.spindle,
            self.cycle,
            self.tool,
            self.selected_tool,
            self.feed_word,
            self.path_tolerance_mm,
            self.merge_mm,
            self.side,
            self.compensation_tool,
            self.length_tool,
            self.m_codes,
            self.frame,
            self.skip_position,
            self.placement,
            self.probe,
            self.rigid_tap,
            self.turning,
            self.tip,
            self.corner,
            self.spline_way,
            self.nurbs,
        )

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
