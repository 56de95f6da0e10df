"""Read a control's status: one pass over the kernel's arrays and what the parts of the control know."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from polycnc.cnc._manual import ManualKind
from polycnc.cnc._status import AxisStatus, ChannelStatus, Feed, Motion, Status
from polycnc.cnc._timers import Timer
from polycnc.kernel import RAPID, RUNNING, WAIT

if TYPE_CHECKING:
    from polycnc.cnc._control import Control
    from polycnc.cnc._control_channel import ControlChannel

_MM_MIN = 60.0


def read_status(control: Control) -> Status:
    """Return the status of a control at the present cycle."""
    clock = control.clock
    return Status(
        cycle=clock.cycles,
        time_s=clock.now_s,
        now=clock.now,
        mode=control.mode,
        emergency=control.emergency,
        channels=tuple(_channel(control, channel) for channel in control.channels),
        axes=MappingProxyType(read_axes(control)),
        spindle=control.spindle.state(),
        overrides=control.overrides,
        switches=control.switches,
        alarms=control.alarms.active,
        messages=control.messages.shown,
        timers_s=MappingProxyType({timer: control.timers.seconds(timer) for timer in Timer}),
        parts=control.parts.parts,
    )


def _channel(control: Control, channel: ControlChannel) -> ChannelStatus:
    state = control.machine.state
    row = state.paths.row[channel.path]
    block = channel.executed
    running = row["state"] == RUNNING
    segment = state.seg.row[int(row["base"]) + int(row["head"]) % int(row["capacity"])]
    dwells = running and segment["kind"] == WAIT
    feed = Feed(programmed=0.0 if block is None else block.modal.feed)
    if running and not dwells:
        feed = Feed(
            programmed=feed.programmed,
            commanded=float(segment["cap"]) * _MM_MIN,
            actual=float(row["speed"]) * _MM_MIN,
            rapid=bool(segment["flags"] & RAPID),
        )
    by_hand = control.manual.moves(channel.axes)
    moving = bool(running and not dwells) or by_hand
    return ChannelStatus(
        run_state=channel.run_state,
        motion=Motion.DWELL if dwells else Motion.MOVING if moving else Motion.NONE,
        program=None if channel.program is None else channel.program.name,
        block=block,
        modal=None if block is None else block.modal,
        feed=feed,
        functions=control.waiting_functions(channel.path),
        returning=channel.returning,
        mode=channel.mode,
        overrides=channel.overrides,
        switches=channel.switches,
        axes=channel.axes,
    )


class AxisFigures(NamedTuple):
    """What an axis has at one cycle, as `AxisStatus` tells it, by the place of the axis (mm, degree, per second)."""

    actual: list[float]
    zero: list[float]
    to_go: list[float]
    following_error: list[float]
    velocity: list[float]


def read_figures(control: Control) -> AxisFigures:
    """Return the figures of all axes at the present cycle, for those who read them often."""
    machine = control.machine
    state, count = machine.state, len(machine.config.axes)
    zero, to_go = [0.0] * count, [0.0] * count
    for channel in control.channels:
        block = channel.executed
        program_zero = zero if block is None else block.modal.zero
        left = to_go if channel.run is None else channel.run.to_go.tolist()
        if len(control.channels) == 1:
            zero, to_go = list(program_zero), left
            break
        own = channel.axes
        for index, name in enumerate(machine.config.axis_names):
            if name in own:
                zero[index], to_go[index] = program_zero[index], left[index]
    if control.manual.active:
        for index, axis in enumerate(machine.config.axes):
            manual = control.manual.motion(axis.name)
            if manual.kind is not ManualKind.NONE:
                to_go[index] = 0.0 if manual.target is None else manual.target - float(state.base[index])
    return AxisFigures(
        state.servo.actual[:count].tolist(),
        zero,
        to_go,
        state.servo.row["following_error"][:count].tolist(),
        state.velocity[:count].tolist(),
    )


def read_axes(control: Control) -> dict[str, AxisStatus]:
    """Return the axes of a control at the present cycle."""
    state, config = control.machine.state, control.machine.config
    figures = read_figures(control)
    referenced = control.manual.referenced
    found = {}
    for index, axis in enumerate(config.axes):
        actual, velocity = figures.actual[index], figures.velocity[index]
        found[axis.name] = AxisStatus(
            name=axis.name,
            unit=axis.unit,
            machine=actual,
            work=actual - figures.zero[index],
            relative=actual - control.relative_zero[index],
            to_go=figures.to_go[index],
            setpoint=float(state.setpoint[index]),
            actual=actual,
            following_error=figures.following_error[index],
            velocity=velocity,
            referenced=referenced[axis.name],
            moving=velocity != 0.0,
            manual=control.manual.motion(axis.name).kind.value,
        )
    return found
