"""What a program run does along its path: lets it go, meets what stands on it, and stops it.

Nothing here changes where the path leads; see `ProgramRun`, which has the commands.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc import kernel
from polycnc.cnc._axis_alarms import axis_alarm
from polycnc.cnc._passed_events import PassedEvents
from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._path_overrides import PathOverrides
from polycnc.cnc._probing import Probing, cannot_begin, delete_rest, positions
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_state import RunAlarm, RunOptions, RunState
from polycnc.cnc._stops import Step, Stopper
from polycnc.cnc._tool_times import ToolTime
from polycnc.machine import Machine, Reason
from polycnc.nc import LINE_MASK, Channel, Event, Stop

Floats: TypeAlias = npt.NDArray[np.float64]
Rows: TypeAlias = Callable[[Floats, npt.NDArray[np.int64]], None]
OnEvent: TypeAlias = Callable[[Event], bool | None]
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
_STOP_STATES = {Stop.PROGRAM: RunState.PROGRAM_STOP, Stop.OPTIONAL: RunState.OPTIONAL_STOP}
_MOST_MARKS = 1000


class PathRunner:
    """Run one path of a machine through what its channel prepares, as `moment` says.

    `feed` keeps the path supplied, `stopper` says where it rests, `overrides` how fast it goes. `rows`, `on_event` and
    `on_skip` are told what happens, see `ProgramRun`.
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
        self.on_event: OnEvent | None = None
        self.on_skip: Callable[[], None] | None = None
        self.passed = PassedEvents(machine, channel.path)
        self.stopper = Stopper(channel.records, Step.INTO if moment.single_block else Step.RUN)
        self.feed = PathFeed(machine, channel, ahead, self.stopper)
        self.row = self.feed.row
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

    # ------------------------------------------------------------------ where it is

    @property
    def at_rest(self) -> bool:
        """Whether the path stands."""
        return bool(self.row["state"] != kernel.RUNNING)

    @property
    def executed_tag(self) -> int:
        """The tag of the block that is executed, or was last."""
        row, met = self.row, self.moment.met
        if met is not None and row["state"] == kernel.READY and row["head"] == met[0]:
            return met[1]
        return int(row["tag"])

    @property
    def path_times(self) -> ToolTime:
        """How long the path has cut and positioned so far, with whatever tool."""
        totals = self.machine.state.paths.totals[self.path]
        return ToolTime(float(totals[kernel.FEED_S]), float(totals[kernel.RAPID_S]))

    @property
    def to_go(self) -> Floats:
        """What is left to the end of the executed block, by the place of the axis; 0 where none is being executed."""
        row = self.row
        here = self.machine.state.paths.position[self.path]
        if row["state"] not in (kernel.RUNNING, kernel.HELD):
            return np.zeros_like(here)
        last = self.feed.block_end(int(row["head"])) - 1
        k = int(row["base"]) + last % int(row["capacity"])
        left: Floats = self.machine.state.seg.end[k] - here
        return left

    # ------------------------------------------------------------------ time

    def advance(self, cycles: int, *, until: Until | None = None, asleep: bool = False) -> int:
        """Let up to `cycles` cycles pass; return how many did.

        It returns early when the run stops (a block's end, a program stop, its end, an alarm), and with
        `until` when one of those reasons was met or the condition holds after a cycle. `asleep`: a language that waits
        is not asked meanwhile, since nothing can have come.
        """
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
        """Go along what is planned in closed form, to the next thing to be done; return the cycles.

        For runs that nobody looks at: servos are ideal, limit switches and the recorder see nothing.
        """
        self._tidy()
        self._meet_more()
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
                self._meet_event()
                if at_once:
                    self._count_rest()
            elif cycles == 0:
                break
        waits = self.row["head"] >= self.row["tail"] and not self.channel.done
        if done == 0 and (waits or self.channel.paused or self._has_met_enough):
            done = self.advance(1)  # the program itself waits for something, or for the next cycle
        self.look()
        return done

    def before_cycles(self, cycles: int, *, asleep: bool = False) -> int:
        """Make ready for up to `cycles` cycles; return how many may pass before `after_cycles`, 0 for any number.

        What must end `machine.advance` early is put into the clock's mask, beside what is there; `asleep` as `advance`.
        """
        self.machine.state.clock[0]["mask"] |= kernel.RECORDER_FULL  # rows are kept whatever the program does
        if self.moment.dropping or (self.moment.state is RunState.HOLD and self.at_rest):
            return 0 if self.at_rest else cycles
        if self.moment.state not in _GOING:
            return 0
        self._tidy()
        self._meet_more()
        if self.feed.is_due:
            self.feed.feed()
        self.take_suppressed()
        self.look()
        self.machine.state.clock[0]["mask"] |= _MASK
        self._head = int(self.row["head"])
        self.passed.begin(self.moment)
        paused = self.channel.paused and not asleep
        often = paused or self.moment.probing is not None or self._has_met_enough
        return min(cycles, 1) if often else cycles

    def after_cycles(self, cycles: int) -> None:
        """Do what the last `cycles` cycles ask for."""
        raised = int(self.machine.state.clock[0]["raised"])
        self.passed.take(self.channel, self.moment)
        at_once = cycles == 0 and bool(self.row["head"] != self._head)
        if self.moment.probing is not None:
            self._probe(self.moment.probing)
        if raised & kernel.PATH_EVENT and self.row["event"] >= 0:
            at_once |= self.passed.at_once
            self._meet_event()
        if at_once:
            self._count_rest()
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

    def hold(self, *, at_once: bool = False) -> None:
        """Brake and stand, now or when the program lets it."""
        moment = self.moment
        if moment.state is RunState.ACTIVE and moment.suppressed.hold and not at_once:
            moment.held_back = True
        elif moment.state is RunState.ACTIVE:
            moment.hold = True
            moment.state = RunState.HOLD
            self.set_hold()

    def stands_at(self, stop: Stop) -> bool:
        """Tell whether the program would stand at such a stop now."""
        return self.options.stands_at_stops and (stop is Stop.PROGRAM or self.moment.optional_stop)

    def go(self, step: Step) -> None:
        """Go on from where the program stands, as far as `step` says."""
        within = self.moment.state is RunState.HOLD and self.row["state"] in (kernel.RUNNING, kernel.HELD)
        record = self.executed_tag
        self.take_switch()
        self._pass_stop()
        self.moment.hold = False
        self.moment.state = RunState.ACTIVE
        if within:
            self._step_from(step, record)
        else:
            self.stopper.step = Step.RUN
            self.feed.go_on()
            self.feed.feed()
            following = self.feed.next_tag()
            self._step_from(step, record if following is None else following)
            if self._stand_at_marks():
                self.set_hold()
                return
        self.feed.look_again()
        self.set_hold()
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
            self.feed.forget_records(self.executed_tag)

    def set_hold(self) -> None:
        """Hold the path while anything holds it; take it over where it moves."""
        stands = (
            self.moment.state is RunState.STOPPED_AT_BLOCK
        )  # before a segment that is in the look-ahead already
        met = self.moment.probing is not None and self.moment.probing.met and self.moment.probing.deletes
        stops = stands or met or self.moment.stop is not None or self._has_met_enough
        hold = self.moment.hold or stops or self.moment.unanswered
        if bool(self.row["hold"]) != hold:
            self.row["hold"] = hold
            if self.row["state"] == kernel.RUNNING:
                self.feed.replan()

    def _stand_at_marks(self) -> bool:
        """Carry out the blocks without segments that come next; return whether the program stops after one."""
        for _ in range(_MOST_MARKS):  # a loop may have no other blocks
            if (tag := self.feed.take_mark()) is None:
                break
            self.moment.met = int(self.row["head"]), tag
            following = self.feed.next_tag()
            if following is None and not self.feed.stops_here:
                self.feed.feed()
                following = self.feed.next_tag()
            if self.feed.stops_here or (following is not None and self.stopper.stops_before(following)):
                self.moment.state = RunState.STOPPED_AT_BLOCK
                return True
        return False

    @property
    def _has_met_enough(self) -> bool:
        """Whether the path has left all the points of rest that it leaves in this cycle."""
        return self.moment.enough_at == self.machine.clock.cycles

    def _meet_more(self) -> None:
        """Let points of rest pass again once a cycle is over that had enough of them."""
        if self.moment.enough_at is not None and not self._has_met_enough:
            self.moment.enough_at = None
            self.set_hold()

    def _count_rest(self) -> None:
        """Let time pass once enough points of rest have been left in a cycle, however long the queue of them is."""
        cycle, count = self.moment.rests
        count = count + 1 if cycle == self.machine.clock.cycles else 1
        self.moment.rests = self.machine.clock.cycles, count
        if count >= kernel.RESTS_PER_CYCLE:
            self.moment.enough_at = self.machine.clock.cycles
            self.set_hold()

    def _meet_event(self) -> None:
        number = int(self.row["event"])
        event = self.channel.writer.take(number)
        self.moment.met = int(self.row["head"]), event.tag
        self.moment.tool_times.change(self.channel.records.tool(event.tag), self.path_times)
        if event.stop is Stop.REFUSED:
            if self.on_event is not None:
                self.on_event(event)
            return
        if event.word and self.on_event is not None:
            self.moment.unanswered = bool(self.on_event(event)) and not self.moment.suppressed.answers
            self.set_hold()
        if event.barrier:
            self.moment.barrier = True
            self._pass_barrier()
        if event.stop in (Stop.PROBE, Stop.PROBE_IN_PASSING):
            self.moment.probing = Probing(event.stop is Stop.PROBE, positions(self.machine))
            if cannot_begin(self.machine, self.channel):
                self.moment.probing.met = True  # what is left of the move is dropped
                self._tell_probe(at_once=True)
                self.set_hold()
        elif event.stop is Stop.DRAIN:
            if self.moment.probing is not None:
                if not self.moment.probing.met:
                    self._tell_probe(missed=True)
                self.moment.probing = None
                self.feed.keep_box()
                self.set_hold()
            if self.stopper.alone:
                self.feed.let_pass()  # what is read after it belongs to it
            self._go_on()
        elif event.stop is not None and self.stands_at(event.stop):
            self.moment.stop = event
            self.moment.state = _STOP_STATES[event.stop]
            self.set_hold()
        elif event.stop is not None and self.options.stands_at_stops:
            self._go_on()

    def _tell_probe(self, *, missed: bool = False, at_once: bool = False) -> None:
        """Note in the channel's state how a probing move went wrong, where the program asks for it."""
        state = self.channel.state
        if state.probe is not None and state.probe.code:
            state.probe = replace(state.probe, missed=missed, at_once=at_once)

    def answered(self) -> None:
        """Let the path, and preparation, go on from an auxiliary function."""
        self.moment.unanswered = False
        self._pass_barrier()
        self.set_hold()

    def _pass_barrier(self) -> None:
        """Continue preparing after functions that have been answered: what they change counts for what follows."""
        if self.moment.barrier and not self.moment.unanswered:
            self.moment.barrier = False
            self._go_on()

    def _go_on(self) -> None:
        """Let preparation continue after what has been met."""
        self.channel.go_on()
        self.feed.wake()

    def _probe(self, probing: Probing) -> None:
        """Look for the contact of a probing move; what is left of the move is dropped once the axes stand."""
        if not probing.met:
            if probing.look(self.machine, self.channel, signal=self.moment.skip_signal) and probing.deletes:
                self.set_hold()
                if self.on_skip is not None and self.channel.state.skip_position is not None:
                    self.on_skip()
        elif probing.deletes and self.at_rest and self.moment.state is RunState.ACTIVE:
            delete_rest(self.machine, self.channel, self.feed)
            self.moment.probing = None
            self.set_hold()

    def _pass_stop(self) -> None:
        if self.moment.stop is not None:
            self.moment.stop = None
            self._go_on()

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
            self.hold()

    def look(self) -> None:
        """See whether the path has come to an end, or to the end of a block."""
        row = self.row
        if self.moment.dropping:
            if self.at_rest:
                self._drop()
        elif (
            self.moment.state is RunState.ACTIVE
            and row["state"] == kernel.READY
            and not self.moment.unanswered
        ):
            if row["head"] >= row["limit"]:
                self._stop_at_block()
            elif self.feed.begins_with_mark and self._stand_at_marks():
                self.set_hold()
            elif row["head"] >= row["tail"] and self.channel.done:
                self.moment.state = RunState.COMPLETED if self.channel.error is None else RunState.ALARM

    def _stop_at_block(self) -> None:
        """Stand at the end of a block; blocks without segments before the one to stop at are carried out."""
        self.feed.pass_marks()
        while self.feed.at_mark:
            following = self.feed.next_tag()
            if following is None or self.stopper.stops_before(following):
                break
            tag = self.feed.take_mark()
            assert tag is not None
            self.moment.met = int(self.row["head"]), tag
        self.moment.state = RunState.STOPPED_AT_BLOCK

    def _drop(self) -> None:
        """Drop what is still queued; the path stands."""
        state = self.machine.state
        kernel.drop_queue(state.seg, state.paths, self.path)
        self.channel.writer.clear()
        self.feed.clear()
        self.moment.dropping = False
        self.moment.hold = False
        self.moment.stop = None
        self.moment.unanswered = self.moment.barrier = False
        self.moment.probing = None
        self.moment.met = None
        self.set_hold()

    def _stop_by(self, text: str, code: str) -> None:
        self.moment.alarm = RunAlarm(text, code, self.executed_tag, self.machine.clock.cycles)
        self.moment.state = RunState.ALARM
        self.moment.hold = True
        self.set_hold()
