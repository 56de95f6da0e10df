"""The part of a channel's modal state that only the ordinary path knows, and going back when a block is refused."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from polycnc.machine import MachineConfig
from polycnc.nc._coordinates import Coordinates
from polycnc.nc._cycles import CycleWords
from polycnc.nc._modal import Modal, copy_modal, restore_modal


@dataclass
class Spindle:
    """Hold what the program asked of the spindle: direction 1 clockwise, -1 counter-clockwise, 0 stopped."""

    speed: float = 0.0  # rpm, or m/min with constant surface speed
    direction: int = 0
    surface_speed: bool = False


@dataclass
class Cycle:
    """Hold the active drilling cycle and its words, levels in machine coordinates."""

    action: str = ""
    retract_to_initial: bool = True
    initial: float = 0.0  # drill axis position at the call, machine coordinates
    words: CycleWords = field(default_factory=CycleWords)


@dataclass
class ChannelState:
    """Hold everything that a block may change, besides the queue."""

    machine: MachineConfig
    modal: Modal
    coordinates: Coordinates
    spindle: Spindle = field(default_factory=Spindle)
    cycle: Cycle = field(default_factory=Cycle)
    tool: int = 0
    selected_tool: int = 0
    feed_words: float = 0.0  # the F word as programmed, for feed per revolution and inverse time
    path_tolerance_mm: float = 0.0
    compensation: int = 0  # 0 off, 1 left, -1 right
    compensation_tool: int = 0

    @contextmanager
    def unchanged_on_error(self) -> Iterator[None]:
        """Put everything back if the body raises."""
        modal = copy_modal(self.modal)
        coordinates = self.coordinates.saved()
        spindle = replace(self.spindle)
        cycle = replace(self.cycle)
        rest = (self.tool, self.selected_tool, self.feed_words, self.path_tolerance_mm)
        compensation = (self.compensation, self.compensation_tool)
        try:
            yield
        except BaseException:
            restore_modal(self.modal, modal)
            self.coordinates = coordinates
            self.spindle, self.cycle = spindle, cycle
            self.tool, self.selected_tool, self.feed_words, self.path_tolerance_mm = rest
            self.compensation, self.compensation_tool = compensation
            raise
