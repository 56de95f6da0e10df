"""The state of a control at one cycle: the machine's arrays, plain data, and copies of programs under way.

A program under way is an interpreter in the middle of its text, so its copy lives in this process only: a snapshot
taken then can be restored, but not written to a file.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any, Self

from pydantic import TypeAdapter, ValidationError

from polycnc.cnc._alarms import Alarm, OperatorMessage
from polycnc.cnc._control_data import Mode, Overrides, Search, Switches
from polycnc.cnc._manual import ManualState
from polycnc.cnc._plc import PlcState
from polycnc.cnc._program_run import ProgramRun
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
    """The snapshot of a control; `runs` are copies of its channels' runs, none at all if it comes from a file."""

    machine: Snapshot
    runs: tuple[ProgramRun | None, ...] = field(default=(), compare=False)
    under_way: bool = False

    @classmethod
    def of(
        cls,
        made_from: str,
        machine: Snapshot,
        moment: ControlMoment,
        runs: tuple[ProgramRun | None, ...],
        under_way: bool,
    ) -> Self:
        """Keep a moment; `under_way` says that a program is being executed or interrupted."""
        data = asdict(moment)
        for kept in data["channels"]:
            kept["switches"]["block_delete"] = sorted(kept["switches"]["block_delete"])
        plain = Snapshot.take(DEVICE, made_from, machine.cycle, (), data)
        return cls(DEVICE, plain.made_from, plain.cycle, (), plain.beside, machine, runs, under_way)

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
        """Return the snapshot as the contents of a file; which block was the last of an ended program is not in it.

        Raises:
            SnapshotError: A program was under way.
        """
        if self.under_way:
            raise SnapshotError(
                "a snapshot with a program under way cannot be written to a file",
                hint="take it when no program is being executed or interrupted",
            )
        data = {"moment": self.beside, "machine": self.machine.to_bytes()}
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
        if whole.device != DEVICE or set(data) != {"moment", "machine"}:
            raise SnapshotError(
                f"this is a snapshot of {whole.device}, not of a control",
                hint="restore it where it was taken",
            )
        machine = Snapshot.from_bytes(data["machine"])
        return cls(DEVICE, whole.made_from, whole.cycle, (), data["moment"], machine)


def copied(run: ProgramRun | None, keep: Iterable[object]) -> ProgramRun | None:
    """Return a copy of a run that shares the objects of `keep` with it.

    Raises:
        SnapshotError: A language holds state in it that cannot be copied.
    """
    if run is None:
        return None
    # Rows of the kernel's arrays are views: the copy has to look at the same array.
    memo: dict[int, Any] = {id(each): each for each in (*keep, run.feed.row)}
    try:
        return copy.deepcopy(run, memo)
    except TypeError as error:
        raise SnapshotError(
            "the program under way cannot be kept: its language cannot tell where it stands",
            hint="take the snapshot when it has ended, or of a program without statements of a language",
        ) from error


def nested(value: object) -> list[object]:
    """Return nested tuples and everything in them."""
    found: list[object] = [value]
    if isinstance(value, tuple):
        for item in value:
            found += nested(item)
    return found
