"""What the parts of a control hold at one cycle, taken and put back."""

from __future__ import annotations

from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._control_snapshot import ControlMoment
from polycnc.cnc._program_run import ProgramRun


def moment_of(of: ControlParts, raised: int) -> ControlMoment:
    """Return what a control holds beside machine and runs."""
    return ControlMoment(
        emergency=of.emergency,
        relative_zero=tuple(of.relative_zero),
        raised=raised,
        channels=tuple(channel.moment(of.functions.serials(channel.path)) for channel in of.channels),
        manual=of.manual.snapshot(),
        spindle=of.spindle.snapshot(),
        plc=of.plc.snapshot(),
        alarms=of.alarms.snapshot(),
        messages=of.messages.snapshot(),
        timers=of.timers.snapshot(),
    )


def put_back(of: ControlParts, moment: ControlMoment, runs: tuple[ProgramRun | None, ...]) -> None:
    """Let the parts hold a moment again, with runs that nobody else has."""
    of.emergency = moment.emergency
    of.relative_zero = list(moment.relative_zero)
    for channel, kept, run in zip(of.channels, moment.channels, runs, strict=True):
        channel.put_back(kept, run)
    of.functions.restore((n, kept.waiting) for n, kept in enumerate(moment.channels))
    of.manual.restore(moment.manual)
    of.spindle.restore(moment.spindle)
    of.plc.restore(moment.plc)
    of.alarms.restore(moment.alarms)
    of.messages.restore(moment.messages)
    of.timers.restore(moment.timers)
