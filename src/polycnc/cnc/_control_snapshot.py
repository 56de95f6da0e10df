"""The state of a control at one cycle, taken and restored: arrays of the machine, plain data, programs under way."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from typing import Any, Self

from pydantic import TypeAdapter, ValidationError

from polycnc.cnc._alarms import Alarm, OperatorMessage
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_data import Mode, Overrides, Search, Switches
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._control_time import ControlEvent, ControlTime
from polycnc.cnc._manual_data import ManualState
from polycnc.cnc._plc import PlcState
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._run_snapshot import RunSnapshot, file_text
from polycnc.cnc._spindle import SpindleMotion
from polycnc.cnc._status import Emergency
from polycnc.cnc._timers import Timer, TimersState
from polycnc.machine import Snapshot, SnapshotError, damaged_snapshot, described
from polycnc.nc import IncomingText, ProgramText

DEVICE = "control"
_PARTS = ("manual", "spindle", "plc", "alarms", "messages", "timers")
"""The parts of a control that have snapshots of their own."""
_AS_IT_IS = ("mode", "overrides", "switches", "search", "is_mdi", "broken", "returning")
"""What a snapshot keeps of a channel as it is."""


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
    beside: dict[str, Any] = field(default_factory=dict)


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
            raise damaged_snapshot(error.errors()[0]["msg"], "control") from error

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


def moment_of(of: ControlParts, raised: int) -> ControlMoment:
    """Return what a control holds beside machine and runs."""
    return ControlMoment(
        emergency=of.emergency,
        relative_zero=tuple(of.relative_zero),
        raised=raised,
        channels=tuple(_of_channel(channel, of.functions.serials(channel.path)) for channel in of.channels),
        beside={} if of.beside is None else of.beside.save(),
        **{name: getattr(of, name).snapshot() for name in _PARTS},
    )


def restore_state(of: ControlParts, moment: ControlMoment, runs: tuple[ProgramRun | None, ...]) -> None:
    """Let the parts hold a moment again, with runs that nobody else has."""
    of.clock.changes += 1
    of.emergency = moment.emergency
    of.relative_zero = list(moment.relative_zero)
    for channel, kept, run in zip(of.channels, moment.channels, runs, strict=True):
        _restore_channel(channel, kept, run)
    of.functions.restore((n, kept.waiting) for n, kept in enumerate(moment.channels))
    for name in _PARTS:
        getattr(of, name).restore(getattr(moment, name))


def _of_channel(channel: ControlChannel, waiting: tuple[int, ...]) -> ChannelMoment:
    """Return what a channel holds beside its run."""
    return ChannelMoment(
        program=_kept(channel.program),
        mdi=_kept(channel.mdi),
        lent=channel.own_axes.taken,
        waiting=waiting,
        **{name: getattr(channel, name) for name in _AS_IT_IS},
    )


def _fits(of: ControlParts, moment: ControlMoment) -> bool:
    """Tell whether a moment has the channels, axes and timers of a control."""
    manual, timers, axes = moment.manual, moment.timers, len(of.relative_zero)
    of_axes = (
        moment.relative_zero,
        *(getattr(manual, each.name) for each in fields(manual) if each.name != "wheel"),
    )
    lent = {axis for channel in moment.channels for axis, _ in channel.lent or ()}
    return (
        len(moment.channels) == len(of.channels)
        and all(len(each) == axes for each in of_axes)
        and lent <= set(range(axes))
        and all(each.keys() == set(Timer) for each in (timers.base_s, timers.cycles))
    )


def _restore_channel(channel: ControlChannel, moment: ChannelMoment, run: ProgramRun | None) -> None:
    """Let a channel hold a moment again, with a run that nobody else has."""
    for name in _AS_IT_IS:
        setattr(channel, name, getattr(moment, name))
    channel.program = _text(moment.program)
    channel.mdi = _text(moment.mdi)
    channel.own_axes.taken = moment.lent
    channel.run = run
    if run is not None:
        channel.runs.stale = False
        run.events.on_skip = channel.on_skip
        run.stopper.breakpoints = channel.breakpoints


def _kept(text: ProgramText | None) -> KeptText | None:
    """Keep a text; a program that was still coming is gone with its end."""
    if text is None or isinstance(text, IncomingText):
        return None
    return KeptText(text.name, text.content.decode("latin-1"))


def _text(kept: KeptText | None) -> ProgramText | None:
    return None if kept is None else ProgramText(kept.name, kept.content.encode("latin-1"))


class Keeping:
    """Take snapshots of a control and go back to them."""

    def __init__(self, of: ControlParts, time: ControlTime) -> None:
        self._of = of
        self._time = time

    def snapshot(self) -> ControlSnapshot:
        """Return the whole state, to go back to with `restore`; what is durable (programs, tables, parts) is not in it.

        Raises:
            SnapshotError: A program is under way whose language cannot tell where it is.
        """
        runs = tuple(
            None if channel.run is None else channel.run.snapshot(find=self._text)
            for channel in self._of.channels
        )
        moment = moment_of(self._of, int(self._time.raised))
        return ControlSnapshot.of(self._made_from, self._of.machine.snapshot(), moment, runs)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this control, or of one made alike.

        Raises:
            SnapshotError: It is of something else, of programs that have been changed since, or damaged; nothing has
                changed.
        """
        if not isinstance(snapshot, ControlSnapshot):
            raise SnapshotError(
                f"this is a snapshot of {snapshot.device}, not of a control",
                hint="restore it where it was taken",
            )
        snapshot.check("control", self._made_from, ())
        moment: ControlMoment = snapshot.moment()
        runs = snapshot.runs or (None,) * len(self._of.channels)
        if len(runs) != len(self._of.channels) or not _fits(self._of, moment):
            raise damaged_snapshot(device="control")
        back = [
            channel.runs.restore_point(run, self._text)
            for channel, run in zip(self._of.channels, runs, strict=True)
        ]
        beside = None if self._of.beside is None else self._of.beside.restore_point(moment.beside)
        self._of.machine.restore(snapshot.machine)
        self._of.edits.close_all()
        self._time.raised = ControlEvent(moment.raised)
        restore_state(self._of, moment, tuple(each() for each in back))
        if beside is not None:
            beside()
        self._time.forget()

    @property
    def _made_from(self) -> str:
        of = self._of
        shares = tuple(channel.data for channel in of.channels)
        return described((of.machine.config, of.dialect, shares, of.data))

    def _text(self, name: str) -> ProgramText | None:
        """Return the present text of a program, of the memory or of a file."""
        return self._of.programs.text(name) if name in self._of.programs else file_text(name)
