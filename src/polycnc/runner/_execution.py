"""Run a channel's queue on its machine: in closed form, or cycle by cycle where the cycles are wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from polycnc.kernel import (
    FEED_LENGTH,
    FEED_S,
    FOLLOWING_ERROR,
    LIMIT_HIGH,
    LIMIT_LOW,
    PATH_EVENT,
    PATH_RESTED,
    QUEUE_LOW,
    RAPID_LENGTH,
    RAPID_S,
    RECORDER_FULL,
    SWITCH_EDGE,
    TOP_SPEED,
    WAIT_S,
    free_slots,
    give_to_path,
    measure_queue,
    prepare_path,
    start_path,
)
from polycnc.machine import Machine
from polycnc.nc import Channel
from polycnc.runner._result import Alarm, RunEvent

Floats = npt.NDArray[np.float64]
Rows = Callable[[Floats], None]
Progress = Callable[[float], None]

_LOW_WATER = 1024  # final segments that stay queued: more than one cycle can pass
_STEP_CYCLES = 1 << 16
_LIMIT_SWITCHES = (LIMIT_LOW, LIMIT_HIGH)


@dataclass(frozen=True, slots=True)
class Totals:
    """Times and lengths of what the path went along."""

    rapid_s: float
    feed_s: float
    wait_s: float
    rapid_length: float
    feed_length: float
    top_speed: float


@dataclass
class Execution:
    """Execute one channel on path 0 of its machine from start to end.

    `rows` receives the recorder's rows. With `every_cycle` every control cycle is run, as simulated servos
    and limit switches need it; without, the same cycles are counted in closed form.
    """

    machine: Machine
    channel: Channel
    rows: Rows | None = None
    progress: Progress | None = None
    every_cycle: bool = False
    events: list[RunEvent] = field(default_factory=list)
    alarm: Alarm | None = None
    low: Floats = field(init=False)
    high: Floats = field(init=False)

    def __post_init__(self) -> None:
        state = self.machine.state
        self._row = state.paths.row[self.channel.path]
        self.low = state.setpoint.copy()
        self.high = state.setpoint.copy()
        depth = int(self._row["depth"])
        self._low_water = _LOW_WATER + depth
        self.channel.on_full_queue(self._make_room)
        self._run_queue = self._step if self.every_cycle else self._skip

    def run(self) -> None:
        """Run until the program has ended and everything has stopped, or an alarm."""
        state = self.machine.state
        give_to_path(state, self.channel.path)
        start_path(state.paths, self.channel.path)
        while self.alarm is None:
            self.channel.fill()
            self._row["closed"] = self.channel.done
            self._prepare()
            self._run_queue()
            if self.progress is not None:
                self.progress(self.channel.progress)
            if self.channel.done and self._row["head"] >= self._row["tail"]:
                break
        self._drain()

    def totals(self) -> Totals:
        """Return times and lengths so far."""
        totals = self.machine.state.paths.totals[self.channel.path]
        columns = (RAPID_S, FEED_S, WAIT_S, RAPID_LENGTH, FEED_LENGTH, TOP_SPEED)
        return Totals(*(float(totals[column]) for column in columns))

    def _prepare(self) -> None:
        state = self.machine.state
        path = self.channel.path
        first = int(self._row["prepared"])
        prepare_path(state.seg, state.paths, path, state.limits, self.machine.config.cycle_s, state.work)
        measure_queue(state.seg, state.paths, path, first, self.low, self.high)

    def _make_room(self) -> None:
        """Run part of the queue while a block is still being prepared."""
        self._prepare()
        self._run_queue()

    def _target(self) -> int:
        """Return the segment count to run up to now."""
        row = self._row
        if row["closed"]:
            return int(row["tail"])
        known = int(row["prepared"]) if row["depth"] else int(row["planned"])
        until = known - self._low_water
        if (
            until <= row["head"]
            and free_slots(self.machine.state.paths, self.channel.path) < row["capacity"] // 8
        ):
            # Braking takes longer than the queue is: go on with what is planned, which is always safe.
            return int(row["head"] + row["capacity"] // 4)
        return until

    def _skip(self) -> None:
        target = self._target()
        while self._row["head"] < target:
            cycles = self.machine.skip(self.channel.path, target)
            if self._row["event"] >= 0:
                self._note_event()
            elif cycles == 0:
                break

    def _step(self) -> None:
        target = self._target()
        clock = self.machine.state.clock[0]
        until = QUEUE_LOW | RECORDER_FULL | PATH_EVENT | PATH_RESTED | FOLLOWING_ERROR | SWITCH_EDGE
        clock["low_water"] = self._row["planned"] - target
        while self.alarm is None and self._row["head"] < target:
            self.machine.advance(_STEP_CYCLES, until=until)
            raised = int(clock["raised"])
            if raised & PATH_EVENT:
                self._note_event()
            if raised & RECORDER_FULL:
                self._drain()
            if raised & (FOLLOWING_ERROR | SWITCH_EDGE):
                self._check_alarm(raised)

    def _drain(self) -> None:
        """Hand the recorded rows on and empty the recorder."""
        recorder = self.machine.state.recorder
        count = int(recorder.filled[0])
        if self.rows is not None and count:
            self.rows(recorder.rows[:count])
        recorder.filled[0] = 0

    def _note_event(self) -> None:
        event = self.channel.writer.events[int(self._row["event"])]
        self.events.append(RunEvent(self.machine.time_s, event.line, event.word))

    def _check_alarm(self, raised: int) -> None:
        state, config = self.machine.state, self.machine.config
        for index, axis in enumerate(config.axes):
            if raised & FOLLOWING_ERROR and state.servo.error_tripped[index]:
                error = float(state.servo.row[index]["following_error"])
                self._stop(
                    f"axis {axis.name}: following error {error:.4f} {axis.unit} is above its limit",
                    "following_error",
                )
                return
            if raised & SWITCH_EDGE and any(
                state.switches.switch[index, j]["level"] for j in _LIMIT_SWITCHES
            ):
                at = float(state.servo.actual[index])
                self._stop(f"axis {axis.name} is on a limit switch at {at:.3f} {axis.unit}", "limit_switch")
                return

    def _stop(self, text: str, code: str) -> None:
        self.alarm = Alarm("machine", text, code, int(self._row["tag"]), 0, self.machine.time_s)
