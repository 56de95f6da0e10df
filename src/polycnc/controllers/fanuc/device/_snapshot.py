"""The state of a Power Mate at one cycle, without what is durable."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Self

from polycnc.cnc import ControlSnapshot
from polycnc.controllers.fanuc.device._device_state import (
    AxisMotionState,
    Block,
    DeviceState,
    MacroState,
    MdiState,
    Order,
    PathBuffers,
    SamplingState,
    SignalState,
)
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.machine import Form, Snapshot, SnapshotError, Values

DEVICE = "power mate"


@dataclass(frozen=True, slots=True)
class PowerMateSnapshot(Snapshot):
    """Everything but programs, parameters, offsets and other durable data, and open transfers."""

    control: ControlSnapshot
    state: DeviceState

    @classmethod
    def of(cls, control: ControlSnapshot, state: DeviceState) -> Self:
        """Return the snapshot with that of its control, of the same cycle."""
        return cls(DEVICE, control.made_from, control.cycle, (), "", control, state)

    @classmethod
    def checked(cls, snapshot: object, device: str = "") -> Self:
        """Return a snapshot of a Power Mate; of another one `device` is the name.

        Raises:
            SnapshotError: It is none.
        """
        if not isinstance(snapshot, cls):
            raise SnapshotError(
                f"this is a snapshot of {device or getattr(snapshot, 'device', 'nothing')}, not of a Power Mate",
                hint="restore it where it was taken",
            )
        return snapshot

    def to_bytes(self) -> bytes:
        """Return the snapshot as the contents of a file; what the memory file keeps is not in it.

        Raises:
            SnapshotError: Something of it cannot be kept.
        """
        whole = Snapshot.take(DEVICE, "", self.cycle, (), {"state": _VALUES.plain(self)})
        return Snapshot(DEVICE, self.made_from, self.cycle, (), whole.beside).to_bytes()

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """Return the snapshot that `to_bytes` has written.

        Raises:
            SnapshotError: The contents are not a snapshot of a Power Mate, or damaged.
        """
        whole = Snapshot.from_bytes(content)
        found = _VALUES.value(whole.data().get("state")) if whole.device == DEVICE else None
        return cls.checked(found, whole.device)


_VALUES = Values(
    (
        *(AxisMotionState, Block, DeviceState, MacroState, MdiState, Order, PathBuffers),
        *(PowerMateMode, PowerMateSnapshot, SamplingState, SignalState),
    ),
    {
        ControlSnapshot: Form(lambda control: (control.to_bytes(),), ControlSnapshot.from_bytes),
        deque: Form(tuple, lambda *parts: deque(parts)),
    },
)
