"""What a Power Mate is at one cycle, beside its control and what is durable: the state of each part, in one value."""

from __future__ import annotations

from dataclasses import dataclass, field

from polycnc.controllers.fanuc.device._axis_motion import AxisMotionState
from polycnc.controllers.fanuc.device._history import SamplingState
from polycnc.controllers.fanuc.device._macros import MacroState
from polycnc.controllers.fanuc.device._mdi import MdiState
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._signals import SignalState


@dataclass(slots=True)
class DeviceState:
    """State of a Power Mate; its parts hold theirs."""

    signals: SignalState
    axis_motion: AxisMotionState
    inch: bool
    mode: PowerMateMode = PowerMateMode.MEM
    cursor: int = 0
    mdi: MdiState = field(default_factory=MdiState)
    skip: bool = False
    skip_positions: tuple[int, ...] = ()
    protection_keys: frozenset[int] = frozenset()
    parameters_writable: bool = True
    macros: MacroState = field(default_factory=MacroState)
    pmc: dict[tuple[str, int], int] = field(default_factory=dict)
    sampling: SamplingState = field(default_factory=SamplingState)
