"""Let time pass in a control: in stretches that end where anything has to be looked at, and look."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import IntFlag
from typing import Protocol, TypeAlias

from polycnc.cnc._alarms import Alarm
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._run_state import RunState
from polycnc.kernel import feed_time_s
from polycnc.machine import Reason

Condition: TypeAlias = Callable[[], bool]


class ControlEvent(IntFlag):
    """What can end `Control.advance` early."""

    NONE = 0
    RUN_STATE = 1  # a channel has begun, stopped, ended
    ALARM = 2  # an alarm has come
    MANUAL = 4  # all manual motion has ended
    FUNCTION = 8  # an auxiliary function was handed to the PLC, or answered


class CycleWatch(Protocol):
    """Somebody who looks at a control in every cycle, as long as it `is_awake`."""

    @property
    def is_awake(self) -> bool:
        """Whether anything has to be looked at."""

    def look(self) -> None:
        """Look at the control after a cycle."""


class ControlTime:
    """Let time pass; `raised` is what happened in the last stretch and since, `fail` stops what alarms stop.

    A `watch` that is awake looks at every cycle. `is_enough` ends `advance` after a stretch, for those who share a
    thread; it changes nothing of what happens in a cycle.
    """

    def __init__(self, of: ControlParts, fail: Callable[[Iterable[Alarm]], None]) -> None:
        self._of = of
        self._fail = fail
        self.raised = ControlEvent.NONE
        self.watch: CycleWatch | None = None
        self.is_enough: Condition | None = None
        self._noted = [channel.run_state for channel in of.channels]

    def advance(self, cycles: int, *, until: int | Condition | None = None) -> int:
        """Let up to `cycles` control cycles pass; return how many did (see `Control.advance`)."""
        condition = until if callable(until) else None
        events = 0 if until is None or callable(until) else int(until)
        done = 0
        while done < cycles:
            self.raised = ControlEvent.NONE
            passed = self._stretch(1 if condition is not None else cycles - done)
            done += passed
            if self.raised & events or (condition is not None and condition()):
                break
            if self.has_enough:
                break
        return done

    @property
    def has_enough(self) -> bool:
        """Whether `advance` is to return early."""
        return self.is_enough is not None and self.is_enough()

    def _stretch(self, cycles: int) -> int:
        """Let time pass until something has to be looked at, and look."""
        states = [channel.run_state for channel in self._of.channels]
        alarms, manual = self._of.alarms.active, self._of.manual.active
        row = self._of.machine.state.clock[0]
        row["mask"] = 0
        for channel in self._of.channels:
            self._take_answers(channel)  # somebody may have answered since
            if channel.run is not None and not channel.returning:
                cycles = min(cycles, channel.run.before_cycles(cycles) or cycles)
        if [channel.run_state for channel in self._of.channels] != states:
            cycles = min(cycles, 1)  # a program has ended, or failed, while it was prepared
        due = self._of.plc.due_cycle()
        if due is not None:
            cycles = min(cycles, max(1, due - self._of.clock.cycles))
        cycles = min(cycles, self._of.manual.horizon())
        watch = self.watch
        if watch is not None and watch.is_awake:
            cycles = min(cycles, 1)
        reasons = int(ManualMotion.REASONS | Reason.FOLLOWING_ERROR)
        passed = self._of.machine.advance(cycles, until=int(row["mask"]) | reasons)
        self._of.timers.count(
            passed, operating=RunState.ACTIVE in states, cut_s=self._cut_s(), tool=self._tool()
        )
        self._look(passed, alarms)
        self._of.clock.changes += 1  # where no cycle has passed as well
        if watch is not None and watch.is_awake:
            watch.look()
        if [channel.run_state for channel in self._of.channels] != states:
            self.raised |= ControlEvent.RUN_STATE
        if manual and not self._of.manual.active:
            self.raised |= ControlEvent.MANUAL
        return passed

    def _look(self, passed: int, alarms: tuple[Alarm, ...]) -> None:
        """Look at what the last cycles have brought since these alarms were on."""
        self._of.manual.after()
        for channel in self._of.channels:
            if channel.run is not None and not channel.returning:
                channel.run.after_cycles(passed)
            channel.look()
            self._note_state(channel)
            self._take_answers(channel)
            if channel.data.spindle and self._of.machine.config.spindle.laser:
                self._of.functions.follow(channel)
        self._of.functions.note_failures(self._of.alarms)
        for index, axis in enumerate(self._of.machine.config.axes):
            if self._of.machine.state.servo.error_tripped[index]:
                self._of.alarms.put("following_error", axis=axis.name)
        self._fail_for(alarms)

    def _fail_for(self, before: tuple[Alarm, ...]) -> None:
        """Stop what the alarms stop that have come since these."""
        if new := [alarm for alarm in self._of.alarms.active if alarm not in before]:
            self.raised |= ControlEvent.ALARM
            self._fail(new)

    def note_start(self, channel: ControlChannel) -> None:
        """Take note that a program was started, or went on; it may be over, or wrong, before anything moves."""
        alarms = self._of.alarms.active
        self._noted[channel.path] = RunState.ACTIVE
        self._note_state(channel)
        self._fail_for(alarms)
        self.raised |= ControlEvent.RUN_STATE

    def forget(self) -> None:
        """Take what channels do now as known."""
        self._noted = [channel.run_state for channel in self._of.channels]

    def _note_state(self, channel: ControlChannel) -> None:
        """Count the part of a program that has ended since this was asked last, or put its error among the alarms.

        Every way into an end or an alarm comes by here, whether a cycle or a command has led to it.
        """
        if channel.run_state is self._noted[channel.path]:
            return
        self._noted[channel.path] = channel.run_state
        run = channel.run
        counts = self._of.data.count_parts and channel.path == 0 and not channel.is_mdi
        if channel.run_state is RunState.COMPLETED and counts:
            self._of.parts.count()
        if run is None or channel.broken or run.alarm is not None:  # it got to no block prepared ahead
            return
        if run.state is RunState.ALARM and (error := run.error) is not None:
            name, axis = self._of.alarms.of_program(error)
            detail = str(error).splitlines()[0] if name == "program" else error.what
            self._of.alarms.put(name, axis=axis, detail=detail, channel=channel.path)

    def _take_answers(self, channel: ControlChannel) -> None:
        if self._of.functions.take_answers(channel):
            self.raised |= ControlEvent.FUNCTION

    def _cut_s(self) -> float:
        state = self._of.machine.state
        return float(feed_time_s(state.seg, state.paths, self._of.clock.cycle_s))

    def _tool(self) -> int:
        turning = next(
            (channel for channel in self._of.channels if channel.data.spindle), self._of.channels[0]
        )
        return 0 if turning.run is None else turning.run.reading.tool
