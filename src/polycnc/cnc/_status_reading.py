"""Read a control's status once in a cycle, in parts: axes, channels, and what they share.

Whoever looks often at one part asks for that; a part that was read stays until time passes or something changes, so all
who ask between two changes get the same objects.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._frozen import FrozenDict
from polycnc.cnc._manual_data import AxisMotion, ManualKind
from polycnc.cnc._run_state import RunState
from polycnc.cnc._status import AxisStatus, ChannelStatus, Feed, Motion, Status, ToolInUse, WorkOffset
from polycnc.kernel import OTHER_SOURCE, RAPID, RUNNING, WAIT, planned_s
from polycnc.machine import MachineConfig
from polycnc.nc import BlockRecord, Group

_MM_MIN = 60.0
_SIGNS = {"length_plus": 1.0, "length_minus": -1.0}
_AT_REST = Feed()


class StatusReader:
    """Read the status of the control that is made of these parts, and keep it for as long as it holds."""

    def __init__(self, of: ControlParts) -> None:
        self._of = of
        config = of.machine.config
        self._names: tuple[str, ...] = config.axis_names
        self._units = tuple(axis.unit for axis in config.axes)
        self._limit(config)
        state, count = of.machine.state, len(self._names)
        columns = state.servo.actual, state.velocity, state.setpoint, state.servo.row["following_error"]
        self._arrays = tuple(column[:count] for column in columns)
        planned_s(
            of.machine.state.seg, of.machine.state.paths, 0, of.clock.cycle_s
        )  # load it before time passes
        self._blocks = [_BlockPart(of, channel) for channel in of.channels]
        self._moment: tuple[object, ...] = ()
        self._status: Status | None = None
        self._axes: Mapping[str, AxisStatus] | None = None
        self._channels: list[ChannelStatus | None] = []

    def _limit(self, config: MachineConfig) -> None:
        self._config = config
        self._most = [axis.vmax for axis in config.axes]

    def _look(self) -> None:
        """Forget what was read, if anything has changed since."""
        of, clock = self._of, self._of.clock
        moment = (clock.cycles, clock.changes, of.tools.revision, of.offsets.revision, of.parts.parts)
        if moment != self._moment:
            self._moment = moment
            self._status = self._axes = None
            self._channels = [None] * len(of.channels)
            for block in self._blocks:
                block.fresh = False

    def status(self) -> Status:
        """Return the status at the present cycle."""
        self._look()
        if self._status is None:
            of, first, clock = self._of, self._of.channels[0], self._of.clock
            self._status = Status(
                clock.cycles,
                clock.cycles * clock.cycle_s,
                clock.now,
                first.mode,
                of.emergency,
                tuple(map(self._channel, range(len(of.channels)))),
                self._axes or self._read_axes(),
                of.spindle.state(),
                first.overrides,
                first.switches,
                of.alarms.active,
                of.alarms.last_time,
                of.messages.shown,
                of.manual.wheel,
                FrozenDict(of.timers.shown_s()),
                tuple(self._left_s(channel.path) for channel in of.channels),
                of.parts.parts,
            )
        return self._status

    def axes(self) -> Mapping[str, AxisStatus]:
        """Return the axes of the status."""
        self._look()
        return self._axes or self._read_axes()

    def tool(self, number: int) -> ToolInUse | None:
        """Return the tool of a channel of the status, None before its first block."""
        self._look()
        part = self._blocks[number]
        return None if part.read() is None else part.tool

    def channel(self, number: int) -> ChannelStatus:
        """Return a channel of the status."""
        self._look()
        return self._channel(number)

    # ------------------------------------------------------------------ axes

    def _read_axes(self) -> Mapping[str, AxisStatus]:
        of, manual = self._of, self._of.manual
        if of.machine.config is not self._config:
            self._limit(of.machine.config)
        zero, to_go = self._of_blocks()
        kinds: list[str] = ["none"] * len(zero)
        for index, motion in enumerate(manual.motions):
            if motion.kind is not ManualKind.NONE:
                kinds[index] = motion.kind.value
                to_go[index] = _left(motion, float(of.machine.state.base[index]))
        actual, velocity, setpoint, lag = (each.tolist() for each in self._arrays)
        shown = actual if (locked := self._of_locked(actual)) is None else locked
        work = self._turned([at - own for at, own in zip(shown, zero, strict=True)])
        rows: list[AxisStatus] = []
        for index, name in enumerate(self._names):
            at, speed = actual[index], velocity[index]
            rows.append(
                AxisStatus(
                    name,
                    self._units[index],
                    at,
                    work[index],
                    shown[index] - of.relative_zero[index],
                    to_go[index],
                    setpoint[index],
                    at,
                    lag[index],
                    speed,
                    manual.references[index],
                    speed != 0.0,
                    kinds[index],
                    min(100.0, 100.0 * abs(speed) / self._most[index]) if speed else 0.0,
                    manual.jog_speeds[index],
                    manual.feed_overrides[index],
                )
            )
        self._axes = FrozenDict(zip(self._names, rows, strict=True))
        return self._axes

    def _turned(self, work: list[float]) -> list[float]:
        """Return distances from program zero as coordinates, where a work offset or the program turns the workpiece."""
        for channel in self._of.channels:
            block = self._blocks[channel.path].read()
            if block is not None and (shifts := block.modal.shifts).turn is not None:
                shifts.back(work)
        return work

    def _of_locked(self, actual: list[float]) -> list[float] | None:
        """Return what positions of programs show where a machine lock lets paths run without their axes."""
        state, shown = self._of.machine.state, None
        for channel in self._of.channels:
            if channel.run is None or not channel.run.reading.locked:
                continue
            shown = shown or list(actual)
            for column, axis in enumerate(state.paths.axis[channel.path]):
                if axis >= 0 and state.owner[axis] == OTHER_SOURCE:
                    shown[axis] = float(state.paths.position[channel.path, column])
        return shown

    def _of_blocks(self) -> tuple[list[float], list[float]]:
        """Return where program zero is, and what is left of the executed block, for each axis in its channel."""
        count = len(self._names)
        zero, to_go = [0.0] * count, [0.0] * count
        for channel in self._of.channels:
            run = channel.run
            if run is None:
                continue
            block = self._blocks[channel.path].read()
            own_zero = zero if block is None else block.modal.zero
            left: list[float] = run.reading.to_go.tolist()
            if len(self._of.channels) == 1:
                return list(own_zero), left[:count]
            for index, name in enumerate(self._names):
                if name in channel.axes:
                    zero[index], to_go[index] = own_zero[index], left[index]
        return zero, to_go

    # ------------------------------------------------------------------ channels

    def _left_s(self, path: int) -> float:
        state = self._of.machine.state
        row = state.paths.row[path]
        if row["head"] >= row["prepared"]:
            return 0.0
        return planned_s(state.seg, state.paths, path, self._of.clock.cycle_s)

    def _speed(self, channel: ControlChannel) -> float:
        """Return how fast the axes of a channel move together: mm/min, deg/min where only rotary ones do."""
        squares = {"mm": 0.0, "deg": 0.0}
        for name, unit, velocity in zip(self._names, self._units, self._arrays[1].tolist(), strict=True):
            if velocity != 0.0 and name in channel.axes:
                squares[unit] += velocity * velocity
        return math.sqrt(squares["mm"] or squares["deg"]) * _MM_MIN

    def _channel(self, number: int) -> ChannelStatus:
        if (known := self._channels[number]) is not None:
            return known
        of, channel, part = self._of, self._of.channels[number], self._blocks[number]
        block = part.read()
        state = of.machine.state
        row: np.void = state.paths.row[number]
        dwells = moves = False
        feed = part.feed
        if row["state"] == RUNNING:
            segment: np.void = state.seg.row[int(row["base"]) + int(row["head"]) % int(row["capacity"])]
            dwells = bool(segment["kind"] == WAIT)
            moves = not dwells
            if moves:
                cap, speed = float(segment["cap"]) * _MM_MIN, float(row["speed"]) * _MM_MIN
                feed = Feed(feed.programmed, cap, speed, bool(segment["flags"] & RAPID))
        if (
            not moves and (speed := self._speed(channel)) != 0.0
        ):  # by hand, or braking for an alarm or a reset
            feed = Feed(feed.programmed, feed.commanded, speed, feed.rapid)
        by_hand = any(
            motion.kind is not ManualKind.NONE and name in channel.axes
            for motion, name in zip(of.manual.motions, self._names, strict=True)
        )
        run = channel.run
        read = ChannelStatus(
            RunState.ALARM if channel.broken else RunState.READY if run is None else run.reading.state,
            Motion.DWELL if dwells else Motion.MOVING if moves or by_hand else Motion.NONE,
            None if channel.program is None else channel.program.name,
            block,
            None if block is None else block.modal,
            part.stack,
            part.offsets,
            part.tool,
            feed,
            of.functions.waiting(number) if number in of.functions.requests else (),
            channel.returning,
            channel.mode,
            channel.overrides,
            channel.switches,
            channel.axes,
            run is not None and not channel.broken and run.reading.starved,
        )
        self._channels[number] = read
        return read


class _BlockPart:
    """What of a channel's status changes with the executed block and the tables alone."""

    def __init__(self, of: ControlParts, channel: ControlChannel) -> None:
        self._of = of
        self._of_channel = channel
        self.fresh = False
        """Whether it was read since something has changed."""
        self._block: BlockRecord | None = None
        self._tables: tuple[object, ...] = ()
        self.stack: tuple[str, ...] = ()
        self.offsets: tuple[WorkOffset, ...] = ()
        self.tool = ToolInUse()
        self.feed = _AT_REST

    def read(self) -> BlockRecord | None:
        """Return the executed block, with the rest made to fit."""
        if self.fresh:
            return self._block
        self.fresh = True
        run, of = self._of_channel.run, self._of
        block = None if run is None else run.reading.block
        tables = of.tools.revision, of.offsets.revision, of.dialect
        if block is not self._block or tables != self._tables:
            self._block, self._tables = block, tables
            self._make(block)
        return block

    def _make(self, block: BlockRecord | None) -> None:
        if block is None:
            self.stack, self.offsets, self.tool, self.feed = (), (), ToolInUse(), _AT_REST
            return
        of, modal = self._of, block.modal
        self.stack = (*(call.program for call in block.stack), block.program)
        self.feed = Feed(modal.feed)
        self.offsets = tuple(
            WorkOffset(name, FrozenDict(of.offsets.by_name.get(name, {}))) for name in modal.work if name
        )
        word = modal.g.get(Group.LENGTH_COMPENSATION, "").removeprefix("G")
        sign = _SIGNS.get(of.dialect.g.get(word, ""))
        compensating = None if sign is None else of.tools.get(modal.h)
        used = of.tools.get(modal.tool) if modal.tool else None
        self.tool = ToolInUse(
            modal.tool,
            0.0 if used is None else used.length_mm + used.wear_length_mm,
            0.0 if used is None else used.radius_mm + used.wear_radius_mm,
            0.0
            if compensating is None or sign is None
            else sign * (compensating.length_mm + compensating.wear_length_mm),
        )


def _left(motion: AxisMotion, at: float) -> float:
    """Return what is left to where an axis that is moved by hand goes; 0 of a jog, which has no end but a limit."""
    return 0.0 if motion.target is None or motion.kind is ManualKind.JOG else motion.target - at
