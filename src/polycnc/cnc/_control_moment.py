"""What the parts of a control hold at one cycle: taken, put back, and kept in a snapshot with machine and runs."""

from __future__ import annotations

from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._control_snapshot import ChannelMoment, ControlMoment, ControlSnapshot, KeptText
from polycnc.cnc._control_time import ControlEvent, ControlTime
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._run_snapshot import file_text
from polycnc.machine import Snapshot, SnapshotError, described
from polycnc.nc import IncomingText, ProgramText


def moment_of(of: ControlParts, raised: int) -> ControlMoment:
    """Return what a control holds beside machine and runs."""
    return ControlMoment(
        emergency=of.emergency,
        relative_zero=tuple(of.relative_zero),
        raised=raised,
        channels=tuple(_of_channel(channel, of.functions.serials(channel.path)) for channel in of.channels),
        manual=of.manual.snapshot(),
        spindle=of.spindle.snapshot(),
        plc=of.plc.snapshot(),
        alarms=of.alarms.snapshot(),
        messages=of.messages.snapshot(),
        timers=of.timers.snapshot(),
    )


def restore_state(of: ControlParts, moment: ControlMoment, runs: tuple[ProgramRun | None, ...]) -> None:
    """Let the parts hold a moment again, with runs that nobody else has."""
    of.clock.changes += 1
    of.emergency = moment.emergency
    of.relative_zero = list(moment.relative_zero)
    for channel, kept, run in zip(of.channels, moment.channels, runs, strict=True):
        _restore_channel(channel, kept, run)
    of.functions.restore((n, kept.waiting) for n, kept in enumerate(moment.channels))
    of.manual.restore(moment.manual)
    of.spindle.restore(moment.spindle)
    of.plc.restore(moment.plc)
    of.alarms.restore(moment.alarms)
    of.messages.restore(moment.messages)
    of.timers.restore(moment.timers)


def _of_channel(channel: ControlChannel, waiting: tuple[int, ...]) -> ChannelMoment:
    """Return what a channel holds beside its run."""
    return ChannelMoment(
        mode=channel.mode,
        overrides=channel.overrides,
        switches=channel.switches,
        program=_kept(channel.program),
        mdi=_kept(channel.mdi),
        search=channel.search,
        is_mdi=channel.is_mdi,
        broken=channel.broken,
        returning=channel.returning,
        lent=channel.own_axes.taken,
        waiting=waiting,
    )


def _restore_channel(channel: ControlChannel, moment: ChannelMoment, run: ProgramRun | None) -> None:
    """Let a channel hold a moment again, with a run that nobody else has."""
    channel.mode = moment.mode
    channel.overrides = moment.overrides
    channel.switches = moment.switches
    channel.program = _text(moment.program)
    channel.mdi = _text(moment.mdi)
    channel.search = moment.search
    channel.is_mdi = moment.is_mdi
    channel.broken = moment.broken
    channel.returning = moment.returning
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
        if len(runs) != len(self._of.channels) or len(moment.channels) != len(self._of.channels):
            raise SnapshotError("the snapshot of a control is damaged", hint="use another one")
        back = [
            channel.runs.restore_point(run, self._text)
            for channel, run in zip(self._of.channels, runs, strict=True)
        ]
        self._of.machine.restore(snapshot.machine)
        self._of.edits.close_all()
        self._time.raised = ControlEvent(moment.raised)
        restore_state(self._of, moment, tuple(each() for each in back))
        self._time.forget()

    @property
    def _made_from(self) -> str:
        of = self._of
        shares = tuple(channel.data for channel in of.channels)
        return described((of.machine.config, of.dialect, shares, of.data))

    def _text(self, name: str) -> ProgramText | None:
        """Return the present text of a program, of the memory or of a file."""
        return self._of.programs.text(name) if name in self._of.programs else file_text(name)
