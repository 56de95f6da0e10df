"""Read a control's status: one pass over the kernel's arrays and what the parts of the control know."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

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


def read_axes(control: Control) -> dict[str, AxisStatus]:
    """Return the axes of a control at the present cycle."""
    machine = control.machine
    state, config = machine.state, machine.config
    to_go: dict[str, float] = {}
    zero = {}
    for channel in control.channels:
        block = channel.executed
        program_zero = (0.0,) * len(config.axes) if block is None else block.modal.zero
        here = {} if channel.run is None else channel.run.distance_to_go
        for axis_name, at in zip(config.axis_names, program_zero, strict=True):
            if axis_name in channel.axes:
                zero[axis_name] = at
                to_go[axis_name] = here.get(axis_name, 0.0)
    referenced = control.manual.referenced
    found = {}
    for index, axis in enumerate(config.axes):
        actual = float(state.servo.actual[index])
        manual = control.manual.motion(axis.name)
        left = to_go[axis.name]
        if manual.kind is not ManualKind.NONE:
            left = 0.0 if manual.target is None else manual.target - float(state.base[index])
        velocity = float(state.velocity[index])
        found[axis.name] = AxisStatus(
            name=axis.name,
            unit=axis.unit,
            machine=actual,
            work=actual - zero[axis.name],
            relative=actual - control.relative_zero[index],
            to_go=left,
            setpoint=float(state.setpoint[index]),
            actual=actual,
            following_error=float(state.servo.row[index]["following_error"]),
            velocity=velocity,
            referenced=referenced[axis.name],
            moving=velocity != 0.0,
            manual=manual.kind.value,
        )
    return found
