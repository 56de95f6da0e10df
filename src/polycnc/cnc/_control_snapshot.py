"""The state of a control at one cycle: the machine's arrays, plain data, and where programs under way stand."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Self

from pydantic import TypeAdapter, ValidationError

from polycnc.cnc._alarms import Alarm, OperatorMessage
from polycnc.cnc._control_data import Mode, Overrides, Search, Switches
from polycnc.cnc._manual_data import ManualState
from polycnc.cnc._plc import PlcState
from polycnc.cnc._run_snapshot import RunSnapshot
from polycnc.cnc._spindle import SpindleMotion
from polycnc.cnc._status import Emergency
from polycnc.cnc._timers import TimersState
from polycnc.machine import Snapshot, SnapshotError

DEVICE = "control"


@dataclass(frozen=True, slots=True)
class KeptText:
    """A program text: its name, and its bytes as Latin-1."""

    name: str
    content: str


@dataclass(frozen=True, slots=True)
class ChannelMoment:
    """What a channel holds beside its run; `waiting` are requests to the PLC."""

    mode: Mode
    overrides: Overrides
    switches: Switches
    program: KeptText | None
    mdi: KeptText | None
    search: Search | None
    is_mdi: bool
    broken: bool
    returning: bool
    lent: tuple[tuple[int, float], ...] | None
    waiting: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class ControlMoment:
    """What a control holds beside machine and runs."""

    emergency: Emergency
    relative_zero: tuple[float, ...]
    raised: int
    channels: tuple[ChannelMoment, ...]
    manual: ManualState
    spindle: SpindleMotion
    plc: PlcState
    alarms: tuple[Alarm, ...]
    messages: tuple[OperatorMessage, ...]
    timers: TimersState


_MOMENT = TypeAdapter(ControlMoment)


@dataclass(frozen=True, slots=True)
class ControlSnapshot(Snapshot):
    """The snapshot of a control; `runs` are those of its channels' runs, None where a channel has had none."""

    machine: Snapshot
    runs: tuple[Snapshot | None, ...] = ()

    @classmethod
    def of(
        cls, made_from: str, machine: Snapshot, moment: ControlMoment, runs: tuple[Snapshot | None, ...]
    ) -> Self:
        """Keep a moment."""
        data = asdict(moment)
        for kept in data["channels"]:
            kept["switches"]["block_delete"] = sorted(kept["switches"]["block_delete"])
        plain = Snapshot.take(DEVICE, made_from, machine.cycle, (), data)
        return cls(DEVICE, plain.made_from, plain.cycle, (), plain.beside, machine, runs)

    def moment(self, name: str = "") -> Any:
        """Return the moment, or a date and time of this name.

        Raises:
            SnapshotError: The snapshot is damaged.
        """
        if name:
            return Snapshot.moment(self, name)
        try:
            return _MOMENT.validate_python(self.data())
        except ValidationError as error:
            raise SnapshotError(
                f"the snapshot of a control is damaged: {error.errors()[0]['msg']}", hint="use another one"
            ) from error

    def to_bytes(self) -> bytes:
        """Return the snapshot as the contents of a file."""
        runs = [None if run is None else run.to_bytes() for run in self.runs]
        data = {"moment": self.beside, "machine": self.machine.to_bytes(), "runs": runs}
        whole = Snapshot.take(DEVICE, "", self.cycle, (), data)
        return Snapshot(DEVICE, self.made_from, self.cycle, (), whole.beside).to_bytes()

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """Return the snapshot that `to_bytes` has written.

        Raises:
            SnapshotError: The contents are not a snapshot of a control, or damaged.
        """
        whole = Snapshot.from_bytes(content)
        data = whole.data()
        runs = data.pop("runs", [])
        if whole.device != DEVICE or set(data) != {"moment", "machine"} or not isinstance(runs, list):
            raise SnapshotError(
                f"this is a snapshot of {whole.device}, not of a control",
                hint="restore it where it was taken",
            )
        machine = Snapshot.from_bytes(data["machine"])
        made = tuple(None if run is None else RunSnapshot.from_bytes(run) for run in runs)
        return cls(DEVICE, whole.made_from, whole.cycle, (), data["moment"], machine, made)
