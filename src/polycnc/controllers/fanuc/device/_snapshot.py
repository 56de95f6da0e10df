"""The state of a Power Mate at one cycle, without what is durable."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.cnc import ControlSnapshot
from polycnc.controllers.fanuc.device._axis_motion import AxisMotionState
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._signals import SignalState
from polycnc.machine import Snapshot, SnapshotError

DEVICE = "power mate"


@dataclass(frozen=True, slots=True)
class PowerMateSnapshot(Snapshot):
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

    def to_bytes(self) -> bytes:
        """Refuse to be written to a file.

        Raises:
            SnapshotError: Always; what a Power Mate keeps durably is in its memory file.
        """
        raise SnapshotError(
            "a snapshot of a Power Mate cannot be written to a file", hint="keep it in this process"
        )
