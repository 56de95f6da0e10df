"""What a program run does along its path: lets it go, meets what stands on it, and stops it.

Nothing here changes where the path leads; see `ProgramRun`, which has the commands.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc import kernel
from polycnc.cnc._passed_events import PassedEvents
from polycnc.cnc._path_events import PathEvents
from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._path_hold import PathHold
from polycnc.cnc._path_overrides import PathOverrides
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_reading import Floats, RunReading
from polycnc.cnc._run_state import RunAlarm, RunOptions, RunState
from polycnc.cnc._stops import Step, Stopper
from polycnc.kernel import FOLLOWING_ERROR, LIMIT_HIGH, LIMIT_LOW, SWITCH_EDGE
from polycnc.machine import Machine, Reason
from polycnc.nc import LINE_MASK, Channel

Rows: TypeAlias = Callable[[Floats, npt.NDArray[np.int64]], None]
Until: TypeAlias = Reason | Callable[[], bool]

_MASK = (
    kernel.QUEUE_LOW
    | kernel.RECORDER_FULL
    | kernel.PATH_EVENT
    | kernel.PATH_RESTED
    | kernel.FOLLOWING_ERROR
    | kernel.SWITCH_EDGE
)
_GOING = (RunState.ACTIVE, RunState.HOLD)
_MOST_MARKS = 1000


class PathRunner:
    """Run one path of a machine through what its channel prepares, as `moment` says.

    `feed` keeps the path supplied, `stopper` says where it rests, `overrides` how fast it goes, `path_hold` holds it,
    `events` are what it meets, `reading` shows where it is. `rows` gets what is recorded, see `ProgramRun`.
    """

    def __init__(
        self,
        machine: Machine,
        channel: Channel,
        options: RunOptions,
        moment: RunProgress,
        *,
        ahead: int | None,
    ) -> None:
        self.machine = machine
        self.path = channel.path
        self.options = options
        self.moment = moment
        self.rows: Rows | None = None
        self.passed = PassedEvents(machine, channel.path)
        self.stopper = Stopper(channel.records, Step.INTO if moment.single_block else Step.RUN)
        self.feed = PathFeed(machine, channel, ahead, self.stopper)
        self.row = self.feed.row
        self.reading = RunReading(machine, channel.path, self.feed, moment)
        self.path_hold = PathHold(machine, self.feed, moment)
        self.events = PathEvents(machine, self.feed, self.stopper, self.path_hold, moment, options)
        self._head = 0  # the segment count before the last cycles
        self.overrides = PathOverrides(
            self.row,
            self.feed.replan,
            dry_run_mm_s=options.dry_run_mm_s,
            rapid_f0_mm_s=options.rapid_f0_mm_s,
            most_feed=options.most_feed_override,
        )

    @property
    def channel(self) -> Channel:
        """The channel that prepares the program."""
        return self.feed.channel

    @channel.setter
    def channel(self, channel: Channel) -> None:
        self.feed.channel = channel
        self.stopper.records = channel.records

    # ------------------------------------------------------------------ time

    def advance(self, cycles: int, *, until: Until | None = None, asleep: bool = False) -> int:
        """Let up to `cycles` cycles pass; return how many did, see `ProgramRun.advance`."""
        clock = self.machine.state.clock[0]
        condition = until if callable(until) and not isinstance(until, Reason) else None
        reasons = int(until) if isinstance(until, Reason) else 0
        done = 0
        while done < cycles:
            moving = self.moment.state in _GOING
            clock["mask"] = reasons
            most = self.before_cycles(cycles - done, asleep=asleep) or cycles - done
            if moving and self.moment.state not in _GOING:
                break
            ran = self.machine.advance(1 if condition is not None else most, until=int(clock["mask"]))
            done += ran
            self.after_cycles(ran)
            if moving and self.moment.state not in _GOING:
                break
            if int(clock["raised"]) & reasons or (condition is not None and condition()):
                break
        return done

    def skip(self) -> int:
        """Follow what is planned in closed form, to the next thing to be done; return the cycles."""
        self._tidy()
        self.path_hold.let_more()
        self.feed.feed()
        self.take_suppressed()
        target = self.feed.target()
        done = 0
        while self.moment.state is RunState.ACTIVE and self.row["head"] < target:
            if self.moment.probing is not None:
                return done + self.advance(1)
            self.passed.begin(self.moment)
            cycles = self.machine.skip(self.path, target)
            done += cycles
            self.passed.take(self.channel, self.moment)
            if self.row["event"] >= 0:
                at_once = cycles == 0 or self.passed.at_once
                self.events.handle()
                if at_once:
                    self.path_hold.count_rest()
            elif cycles == 0:
                break
        waits = self.row["head"] >= self.row["tail"] and not self.channel.done
        if done == 0 and (waits or self.channel.paused or self.path_hold.has_met_enough):
            done = self.advance(1)  # the program itself waits for something, or for the next cycle
        self.look()
        return done

    def before_cycles(self, cycles: int, *, asleep: bool = False) -> int:
        """Make ready for up to `cycles` cycles, see `ProgramRun.before_cycles`; `asleep` as `advance`."""
        self.machine.state.clock[0]["mask"] |= kernel.RECORDER_FULL  # rows are kept whatever the program does
        if self.moment.dropping or (self.moment.state is RunState.HOLD and self.reading.at_rest):
            return 0 if self.reading.at_rest else cycles
        if self.moment.state not in _GOING:
            return 0
        self._tidy()
        self.path_hold.let_more()
        if self.feed.is_due:
            self.feed.feed()
        self.take_suppressed()
        self.look()
        self.machine.state.clock[0]["mask"] |= _MASK
        self._head = int(self.row["head"])
        self.passed.begin(self.moment)
        paused = self.channel.paused and not asleep
        often = paused or self.moment.probing is not None or self.path_hold.has_met_enough
        return min(cycles, 1) if often else cycles

    def after_cycles(self, cycles: int) -> None:
        """Do what the last `cycles` cycles ask for."""
        raised = int(self.machine.state.clock[0]["raised"])
        self.passed.take(self.channel, self.moment)
        at_once = cycles == 0 and bool(self.row["head"] != self._head)
        if self.moment.probing is not None:
            self.events.probe(self.moment.probing)
        if raised & kernel.PATH_EVENT and self.row["event"] >= 0:
            at_once |= self.passed.at_once
            self.events.handle()
        if at_once:
            self.path_hold.count_rest()
        if raised & kernel.RECORDER_FULL:
            self.drain()
        if (found := axis_alarm(self.machine, raised, self.path)) is not None:
            self._stop_by(*found)
        self.look()

    def drain(self) -> None:
        """Hand the recorded rows on and empty the recorder."""
        recorder = self.machine.state.recorder
        count = int(recorder.filled[0])
        if self.rows is not None and count:
            rows = recorder.rows[:count]
            tags = rows[:, kernel.BLOCK].astype(np.int64)
            rows[:, kernel.BLOCK] = tags & LINE_MASK
            self.rows(rows, tags)
        recorder.filled[0] = 0

    # ------------------------------------------------------------------ going and standing

    def go(self, step: Step) -> None:
        """Go on from where the program stands, as far as `step` says."""
        under_way = self.moment.unanswered or self.row["state"] in (kernel.RUNNING, kernel.HELD)
        within = self.moment.state is RunState.HOLD and under_way
        record = self.reading.tag
        self.take_switch()
        self.events.pass_stop()
        self.moment.hold, self.moment.state = False, RunState.ACTIVE
        self.moment.hold_later = False
        if within:
            self._step_from(step, record)
        else:
            self.stopper.step = Step.RUN
            self.feed.go_on()
            self.feed.feed()
            following = self.feed.blocks.next_tag()
            self._step_from(step, record if following is None else following)
            if self._stand_at_marks():
                self.path_hold.apply()
                return
        self.feed.look_again()
        self.path_hold.apply()
        self.look()

    def _step_from(self, step: Step, tag: int) -> None:
        """Go as far as `step` says, from the block of a tag."""
        self.stopper.step, self.stopper.depth = step, self.channel.records.depth(tag)

    def take_switch(self) -> None:
        """Let blocks be prepared alone, or ahead, as the switch of single blocks says."""
        self.stopper.alone = self.step_of_switch is Step.INTO

    @property
    def step_of_switch(self) -> Step:
        """How far a start goes as the switch of single blocks says, and the program lets it."""
        return Step.INTO if self.moment.single_block and not self.moment.suppressed.single_block else Step.RUN

    def _tidy(self) -> None:
        """Forget records that nobody can ask for any more."""
        if self.channel.records.crowded:
            self.drain()  # rows refer to records
            self.feed.forget_records(self.reading.tag)

    def _stand_at_marks(self) -> bool:
        """Carry out the blocks without segments that come next; return whether the program stops after one."""
        for _ in range(_MOST_MARKS):  # a loop may have no other blocks
            if (tag := self.feed.blocks.take_mark()) is None:
                break
            self.moment.met = int(self.row["head"]), tag
            following = self.feed.blocks.next_tag()
            if following is None and not self.feed.stops_here:
                self.feed.feed()
                following = self.feed.blocks.next_tag()
            if self.feed.stops_here or (following is not None and self.stopper.stops_before(following)):
                self.moment.state = RunState.STOPPED_AT_BLOCK
                return True
        return False

    def take_suppressed(self) -> None:
        """Let what the program suppresses act no more, and what it did until now act again."""
        was, now = self.moment.suppressed, self.channel.suppressed
        if now == was:
            return
        self.moment.suppressed = now
        self.overrides.suppress_feed(now.override)
        self.take_switch()
        if now.single_block is not was.single_block and self.moment.single_block:
            self.stopper.step = self.step_of_switch
            self.feed.let_pass()
            self.feed.look_again()
        if self.moment.held_back and not now.hold:
            self.moment.held_back = False
            self.path_hold.brake()

    def look(self) -> None:
        """See whether the path has come to an end, or to the end of a block."""
        row = self.row
        ready = row["state"] == kernel.READY and not self.moment.unanswered
        if self.moment.dropping:
            if self.reading.at_rest:
                self._drop()
        elif self.moment.state is RunState.ACTIVE and ready:
            if row["head"] >= row["limit"]:
                self._stop_at_block()
            elif self.feed.begins_with_mark and self._stand_at_marks():
                self.path_hold.apply()
            elif row["head"] >= row["tail"] and self.channel.done:
                self.moment.state = RunState.COMPLETED if self.channel.error is None else RunState.ALARM

    def _stop_at_block(self) -> None:
        """Stand at the end of a block; blocks without segments before the one to stop at are carried out."""
        self.feed.blocks.pass_marks()
        while self.feed.blocks.at_mark:
            following = self.feed.blocks.next_tag()
            if following is None or self.stopper.stops_before(following):
                break
            tag = self.feed.blocks.take_mark()
            assert tag is not None
            self.moment.met = int(self.row["head"]), tag
        self.moment.state = RunState.STOPPED_AT_BLOCK

    def _drop(self) -> None:
        """Drop what is still queued; the path stands."""
        state = self.machine.state
        kernel.drop_queue(state.seg, state.paths, self.path)
        self.channel.writer.clear()
        self.feed.clear()
        moment = self.moment
        moment.dropping = moment.hold = moment.unanswered = moment.barrier = False
        moment.stop = moment.probing = moment.met = None
        self.path_hold.apply()

    def _stop_by(self, text: str, code: str) -> None:
        self.moment.alarm = RunAlarm(text, code, self.reading.tag, self.machine.clock.cycles)
        self.moment.state = RunState.ALARM
        self.moment.hold, self.moment.hold_later = True, False
        self.path_hold.apply()


_LIMIT_SWITCHES = (LIMIT_LOW, LIMIT_HIGH)


def axis_alarm(machine: Machine, raised: int, path: int) -> tuple[str, str] | None:
    """Return text and code of the first alarm of a path's axes by the reasons `raised` in a cycle, None for none."""
    if not raised & (FOLLOWING_ERROR | SWITCH_EDGE):
        return None
    state = machine.state
    for index, axis in enumerate(machine.config.axes):
        if index not in state.paths.axis[path]:
            continue
        if raised & FOLLOWING_ERROR and state.servo.error_tripped[index]:
            error = float(state.servo.row[index]["following_error"])
            text = f"axis {axis.name}: following error {error:.4f} {axis.unit} is above its limit"
            return text, "following_error"
        if raised & SWITCH_EDGE and any(state.switches.switch[index, j]["level"] for j in _LIMIT_SWITCHES):
            at = float(state.servo.actual[index])
            return f"axis {axis.name} is on a limit switch at {at:.3f} {axis.unit}", "limit_switch"
    return None
