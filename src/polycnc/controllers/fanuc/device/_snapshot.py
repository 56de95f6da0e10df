"""The state of a Power Mate at one cycle, without what is durable."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.cnc import ControlSnapshot
from polycnc.controllers.fanuc.device._axis_motion import AxisMotionState
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._signals import SignalState


@dataclass(frozen=True, slots=True)
class PowerMateSnapshot:
    """Everything but programs, parameters, offsets, variables and other durable data, and open transfers."""

    control: ControlSnapshot
    mode: PowerMateMode
    cursor: int
    mdi: tuple[str, ...]
    mdi_start: int
    skip: bool
    skip_positions: tuple[int, ...]
    protection_keys: frozenset[int]
    parameters_writable: bool
    inch: bool
    user_outputs: int
    signals: SignalState
    axis_motion: AxisMotionState
    pmc: dict[tuple[str, int], int]
    sampling_stopped: bool

    @property
    def cycle(self) -> int:
        """The cycle in which it was taken."""
        return self.control.cycle
