"""Axes moved by direct commands of a program on a PC: two execution buffers and a completion flag per path.

Every axis of a command goes to its own end at the commanded speed, and a block is over when all of them are there. The
feed override holds, and so does a hold: the rest of the way comes when it is taken back, or with the start button. An
alarm, a reset or the emergency stop empties all buffers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from polycnc.cnc import ControlError, ControlEvent, Emergency
from polycnc.controllers.fanuc.device._alarms import shown
from polycnc.controllers.fanuc.device._device_state import (
    PATHS,
    AxisMotionState,
    Block,
    Order,
    PathBuffers,
    SignalState,
)
from polycnc.controllers.fanuc.device._positions import Positions
from polycnc.controllers.fanuc.device._power import Power
from polycnc.controllers.fanuc.device._units import Units

BUFFERS = 2
_MM_PER_MIN = 60.0
_FOR_EVER = 1 << 40


class AxisMotion:
    """Execute direct commands on the machine of a Power Mate."""

    def __init__(
        self, power: Power, units: Units, positions: Positions, signals: SignalState, state: AxisMotionState
    ) -> None:
        self._power = power
        self._axis_name, self._scale = units.axis_name, units.output_scale
        self._positions = positions
        self._signals = signals
        self.state = state

    def clear(self) -> None:
        """Forget everything, as when the power comes on."""
        self.drop()
        self.state.shift = [0] * len(self.state.shift)
        self.state.finished = [False] * PATHS

    def drop(self) -> None:
        """Empty all buffers; axes that were moving brake."""
        for path in self.state.paths:
            if path.begun:
                for axis in path.blocks[0][1].axes:
                    self._power.control.manual.stop(self._axis_name(axis))
            path.blocks.clear()
            path.begun = path.held = False
        self.state.held = False

    def advance(self, cycles: int, until: int | Callable[[], bool] | None) -> int:
        """Let time pass, in stretches that end where direct commands have to be looked at; return the cycles."""
        control = self._power.control
        events = 0 if until is None or callable(until) else int(until)
        done = 0
        while done < cycles:
            self.look()
            step = min(cycles - done, self.horizon())
            watch = until if callable(until) else events | self.EVENTS
            busy = self.busy
            passed = control.advance(step, until=watch if busy else until)
            done += passed
            over = callable(until) and until()
            if over or control.has_enough or (passed < step and not busy) or not passed:
                break
            if control.raised & events:
                break
        self.look()
        return done

    # ------------------------------------------------------------------ what is known

    @property
    def busy(self) -> bool:
        """Whether a buffer holds a block."""
        return any(path.blocks for path in self.state.paths)

    @property
    def moving(self) -> frozenset[str]:
        """The names of the axes that move by a command."""
        moves = (path.blocks[0][1] for path in self.state.paths if path.begun)
        return frozenset(self._axis_name(axis) for block in moves for axis in block.axes)

    def buffers(self, path: int) -> tuple[bool, bool]:
        """Return which execution buffers of a path (from 1) hold a block."""
        used = {buffer for buffer, _ in self.state.paths[path - 1].blocks}
        return 0 in used, 1 in used

    @property
    def is_ready(self) -> bool:
        """Whether no alarm, emergency stop or reset would drop a command at once."""
        control = self._power.control
        stopped = self._signals.reset_is_on or control.emergency is not Emergency.OFF
        return not stopped and not shown(control.alarms.active)

    def has_room(self, path: int) -> bool:
        """Whether a path (from 1) takes a block now: a buffer is free, and no program has the axes."""
        programs = any(channel.active for channel in self._power.control.channels)
        return len(self.state.paths[path - 1].blocks) < BUFFERS and not programs

    # ------------------------------------------------------------------ commands

    def put(self, path: int, block: Block) -> None:
        """Put a block into a free buffer of a path (from 1); it begins when the one before it is over."""
        blocks = self.state.paths[path - 1].blocks
        buffer = 1 - blocks[0][0] if blocks else 0
        blocks.append((buffer, block))

    def hold(self) -> None:
        """Let the axes of commands that move brake and wait for `go_on`."""
        self.state.held = self.busy

    def go_on(self) -> None:
        """Let commands that are held go on."""
        self.state.held = False

    def has_gone_on(self) -> bool:
        """Let commands that are held go on, and tell whether there were any."""
        waited = self.state.held and self.busy
        self.go_on()
        return waited

    # ------------------------------------------------------------------ time

    def horizon(self) -> int:
        """Return how many cycles may pass before somebody has to look."""
        if not self.busy:
            return _FOR_EVER
        now = self._power.control.clock.cycles
        dwells = [path.until - now for path in self.state.paths if path.begun and path.until > now]
        waits = any(path.blocks and (path.held or not path.begun) for path in self.state.paths)
        return 1 if waits else min(dwells, default=_FOR_EVER)

    EVENTS = ControlEvent.MANUAL | ControlEvent.ALARM | ControlEvent.RUN_STATE

    def look(self) -> None:
        """Begin blocks whose turn it is, and end those that are over."""
        if self.busy and not self.is_ready:
            self.drop()
        for number, path in enumerate(self.state.paths):
            while path.blocks:
                if not path.begun and not self._begin(path):
                    break
                if not self._is_over(path):
                    break
                _, block = path.blocks.popleft()
                path.begun, path.until, path.held = False, 0, False
                if block.flag:
                    self.state.finished[number] = True

    def _is_over(self, path: PathBuffers) -> bool:
        control, block = self._power.control, path.blocks[0][1]
        if block.order is Order.DWELL:
            return control.clock.cycles >= path.until
        stopped = self._is_stopped(block)
        path.held = path.held or (stopped and block.order is not Order.SET)
        if path.held and not stopped:
            path.held = not self._take_up(path, block)
        names = map(self._axis_name, block.axes)
        return not path.held and all(control.manual.motion(name).kind.value == "none" for name in names)

    def _is_stopped(self, block: Block) -> bool:
        """Whether a hold or a servo that is off keeps the axes of a block where they are."""
        signals = self._signals
        return self.state.held or signals.hold_is_on or any(map(signals.servo_is_off, block.axes))

    def _take_up(self, path: PathBuffers, block: Block) -> bool:
        """Let the axes that were stopped on their way go on, as soon as they stand; tell whether all do."""
        manual = self._power.control.manual
        motions = {axis: manual.motion(self._axis_name(axis)) for axis in block.axes}
        if any(motion.stopping for motion in motions.values()):
            return False
        for axis, motion in motions.items():
            if motion.kind.value == "none":
                self._go(block, axis, path.ends.get(axis, 0.0))
        return True

    def _begin(self, path: PathBuffers) -> bool:
        """Begin the first block; tell whether it could."""
        control, block = self._power.control, path.blocks[0][1]
        if self._is_stopped(block):
            return False
        taken = {
            axis
            for other in self.state.paths
            if other is not path and other.begun
            for axis in other.blocks[0][1].axes
        }
        if taken & block.axes:
            return False
        if block.order is Order.DWELL:
            longest_s = max(value for _, value in block.values) / 1000.0
            path.until = control.clock.cycles + control.clock.cycles_for(longest_s)
        elif block.order is Order.SET:
            for axis, value in block.values:
                self.state.shift[axis - 1] += value - self._positions.coordinate(axis)
        else:
            try:
                for channel in control.channels:
                    channel.release()
                path.ends = {axis: self._end(block, axis, value) for axis, value in block.values}
                for axis, there in path.ends.items():
                    self._go(block, axis, there)
            except ControlError as error:
                for each in block.axes:
                    control.manual.stop(self._axis_name(each))
                if error.reason.name == "TRAVEL":
                    self.drop()
                    self._travel_alarm(block, axis, dict(block.values)[axis])
                return False
        path.begun = True
        return True

    def _travel_alarm(self, block: Block, axis: int, value: int) -> None:
        """Raise the alarm of the limit that a command would go past."""
        position = 0 if block.order is Order.INCREMENTAL else self._positions.coordinate(axis)
        number, sign = (500, "+") if value > position else (501, "-")
        self._power.raise_alarm(number, f"OVER TRAVEL : {sign}{self._axis_name(axis)}", axis=axis)

    def _end(self, block: Block, axis: int, value: int) -> float:
        """Return where an axis of a block goes, in machine coordinates; a reference return knows that itself."""
        if block.order is Order.REFERENCE:
            return 0.0
        scale = self._scale(axis)
        distance = value if block.order is Order.INCREMENTAL else value - self._positions.coordinate(axis)
        target = float(self._power.control.machine.state.base[axis - 1])
        return scale.value(scale.counts(target) + distance)

    def _go(self, block: Block, axis: int, there: float) -> None:
        manual, name = self._power.control.manual, self._axis_name(axis)
        if block.order is Order.REFERENCE:
            manual.reference(name)
            return
        speeds = manual.data.jog_speeds
        speed = block.feed / _MM_PER_MIN * (0.254 if self._scale(axis).inch else 1.0)
        manual.data = replace(manual.data, jog_speeds={**speeds, name: speed})
        try:
            manual.go_to(name, there)
        finally:
            manual.data = replace(manual.data, jog_speeds=speeds)
