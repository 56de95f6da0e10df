"""A program run: one program on one path of a machine, that can be stopped and continued at every cycle.

Nothing here changes where the path leads. Holding, overrides and stops at block ends only change how fast it is gone
along, within every axis' limits, so a run that is interrupted ends where the undisturbed one does, to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc import kernel
from polycnc.cnc._axis_alarms import axis_alarm
from polycnc.cnc._block_search import block_line, calculate_to
from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._path_overrides import PathOverrides
from polycnc.cnc._probing import Probing, delete_rest, positions
from polycnc.cnc._run_snapshot import RunSnapshot, put_back, taken_of
from polycnc.cnc._run_state import RunAlarm, RunOptions, RunState
from polycnc.cnc._stops import Breakpoint, Step, Stopper
from polycnc.cnc._tool_times import ToolTime, ToolTimes
from polycnc.errors import ProgramError, UsageError
from polycnc.machine import Machine, MachineConfig, Reason
from polycnc.nc import (
    LINE_MASK,
    BlockRecord,
    Call,
    Channel,
    Dialect,
    Event,
    Language,
    Library,
    ModalWords,
    ProgramText,
    Stop,
    Suppressed,
    load_dialect,
)

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
_STANDING = {
    RunState.STOPPED_AT_BLOCK,
    RunState.PROGRAM_STOP,
    RunState.OPTIONAL_STOP,
}
_OVER = {RunState.READY, RunState.RESET, RunState.COMPLETED, RunState.ALARM}
_STOP_STATES = {Stop.PROGRAM: RunState.PROGRAM_STOP, Stop.OPTIONAL: RunState.OPTIONAL_STOP}
_MOST_MARKS = 1000


class ProgramRun:
    """Run `program` on path `path` of `machine`.

    `rows` gets the recorder's rows in pieces, with the tag of each row's block; their column BLOCK holds lines.
    `on_event` is told each auxiliary function in the cycle in which the path comes to it; if it returns True the path
    stands there until `answered`. `before` is the run on this path until now, whose modal state goes on. `axes` are the
    names of the machine's axes in this channel, those of others by `of_another_channel`.

    `skip_signal` is the signal that ends a skip move: the axes brake, and the next block goes on from where they stand.
    The surfaces of the machine file do the same. `on_skip` is told when either is met.

    `advance` lets the machine run. Who runs several paths of one machine calls `before_cycles` of each, then
    `machine.advance`, then `after_cycles` of each instead.
    """

    def __init__(
        self,
        machine: Machine,
        program: ProgramText,
        dialect: Dialect | None = None,
        *,
        path: int = 0,
        options: RunOptions | None = None,
        config: MachineConfig | None = None,
        library: Library | None = None,
        language: Language | None = None,
        axes: Sequence[str] | None = None,
        rows: Rows | None = None,
        on_event: OnEvent | None = None,
        before: ProgramRun | None = None,
    ) -> None:
        options = options or RunOptions()
        self.machine = machine
        self.program = program
        self.dialect = load_dialect(dialect)
        self.path = path
        self.rows = rows
        self.on_event = on_event
        self.on_skip: Callable[[], None] | None = None
        self.skip_signal = False
        self.optional_stop = options.optional_stop
        self.alarm: RunAlarm | None = None
        self._options = options
        self._language = language
        self._axes = axes
        self._config = config
        self._library = library
        self._block_delete = options.block_delete
        self._single_block = options.single_block
        self._state = RunState.READY
        self._hold = False  # feed hold; a stop holds the path as well
        self._stop: Event | None = None  # the stop at which the program stands
        self._met: tuple[int, int] | None = None  # segment count and tag of the event at which the path rests
        self._dropping = False
        self._suppressed = Suppressed()  # what the program keeps from acting now
        self._held_back = False  # a feed hold that comes when the program lets it
        self._locked = False
        self._tool_times = ToolTimes()
        self._approach: tuple[tuple[float, ...], int] | None = (
            None  # where a searched block begins, and its line
        )
        self._unanswered = False  # an auxiliary function at which the path stands
        self._probing: Probing | None = None
        self._row = machine.state.paths.row[path]
        self.channel: Channel = self._new_channel(program, None if before is None else before.channel)
        self.stopper = Stopper(self.channel.records, Step.INTO if self._single_block else Step.RUN)
        self.feed = PathFeed(machine, self.channel, self._ahead, self.stopper)
        self.overrides = PathOverrides(
            self._row,
            self.feed.replan,
            dry_run_mm_s=options.dry_run_mm_s,
            rapid_f0_mm_s=options.rapid_f0_mm_s,
        )

    def _new_channel(
        self, program: ProgramText, before: Channel | None, *, keeps_modal: bool = True
    ) -> Channel:
        return Channel(
            program,
            self.dialect,
            self.machine,
            path=self.path,
            config=self._config,
            library=self._library,
            language=self._language,
            axes=self._axes,
            skip_levels=self._block_delete,
            stands_at_stops=self._options.stands_at_stops,
            answers=self._options.answers,
            marks=self._options.stands_at_stops,
            before=before,
            keeps_modal=keeps_modal,
            collect_errors=self._options.collect_errors,
        )

    @property
    def _ahead(self) -> int | None:
        ahead = self._options.blocks_ahead
        return self.dialect.blocks_ahead if ahead is None else ahead

    # ------------------------------------------------------------------ commands

    def start(self) -> None:
        """Begin the program, or go on where it stands or is held (cycle start).

        Raises:
            UsageError: the axes are still moving, or there is an alarm.
        """
        self._check_start()
        if self._state in _OVER:
            self._begin(self._step_of_switch)
        elif self._state is not RunState.ACTIVE:
            self.resume()

    def hold(self, *, at_once: bool = False) -> None:
        """Brake the axes on the path and stand (feed hold); without effect where nothing is being executed.

        While the program suppresses feed holds it comes as soon as it does no more, or `at_once`.
        """
        if self._state is RunState.ACTIVE and self._suppressed.hold and not at_once:
            self._held_back = True
        elif self._state is RunState.ACTIVE:
            self._hold = True
            self._state = RunState.HOLD
            self._set_hold()

    def resume(self) -> None:
        """Go on from a feed hold, a block's end, or a program stop.

        Raises:
            UsageError: the program does not stand at any of these.
        """
        if self._state is not RunState.HOLD and self._state not in _STANDING:
            raise UsageError(
                f"there is nothing to resume: the program is {self._state.value}", hint="Start it."
            )
        self._go(self._step_of_switch)

    def load(self, program: ProgramText, *, keeps_modal: bool = False) -> None:
        """Select another program; with `keeps_modal` it begins with the modal state that is in force.

        Raises:
            UsageError: a program is being executed, or there is an alarm.
        """
        self._check_over()
        keeps = keeps_modal and self._state is not RunState.RESET
        self._replace_channel(program, keeps_modal=keeps)
        self.program = program
        self._state = RunState.READY

    def mdi(self, text: str) -> None:
        """Execute blocks that are typed in; modal words stay in force for the next (manual data input).

        Raises:
            UsageError: a program is being executed, or there is an alarm.
        """
        self.load(ProgramText.from_text(text, "MDI"), keeps_modal=True)
        self.start()

    def search(self, *, line: int = 0, sequence: int | None = None, calculate: bool = False) -> int:
        """Let the program begin at a block: the one on `line`, or the first with sequence number `sequence`.

        With `calculate` everything before is carried out without moving, and with the start the axes go straight at
        rapid to where that block begins; else modal state and position are what they are. Return the line.

        Raises:
            UsageError: there is no such block, or the program cannot begin there; it stands at its beginning then.
        """
        self._check_over()
        target = block_line(self.program, line, sequence)
        self._replace_channel(self.program, keeps_modal=False)
        self._state = RunState.READY
        if not calculate:
            self.channel.go_to(target)
            return target
        try:
            calculate_to(self.machine, self.channel, target)
        except UsageError:
            self._replace_channel(self.program, keeps_modal=False)
            raise
        self._approach = (tuple(self.channel.state.modal.position.tolist()), target)
        return target

    def step_into(self) -> None:
        """Go on to the end of the next block, into a sub-program if it calls one.

        Raises:
            UsageError: the program does not stand, and is not at its beginning.
        """
        self._step(Step.INTO)

    def step_over(self) -> None:
        """Go on to the end of the next block; a sub-program that it calls is run as a whole.

        Raises:
            UsageError: the program does not stand, and is not at its beginning.
        """
        self._step(Step.OVER)

    def step_out(self) -> None:
        """Go on to the end of the present sub-program, or of the program.

        Raises:
            UsageError: the program does not stand, and is not at its beginning.
        """
        self._step(Step.OUT)

    def answered(self) -> None:
        """Let the path go on from the auxiliary function at which it stands."""
        self._unanswered = False
        self._set_hold()

    def reset(self) -> None:
        """Break the program off: the axes brake on the path, then the rest of it is dropped.

        An alarm is over. The next start begins the program anew, from where the axes stand.
        """
        self.alarm = None
        self.channel.close()
        self.channel.suppressed = Suppressed()
        self._held_back = False
        self._take_suppressed()
        if self._row["state"] == kernel.IDLE:
            self._state = RunState.RESET
            return
        self._dropping = True
        self._hold = True
        self._state = RunState.RESET
        self._set_hold()
        self._look()

    @property
    def single_block(self) -> bool:
        """Whether the program stops at the end of every block."""
        return self._single_block

    @single_block.setter
    def single_block(self, on: bool) -> None:
        if on == self._single_block:
            return
        self._single_block = on
        self.stopper.step = self._step_of_switch
        if self._state in (RunState.ACTIVE, RunState.HOLD):
            self.feed.look_again()

    @property
    def breakpoints(self) -> frozenset[Breakpoint]:
        """Where the program stops besides."""
        return self.stopper.breakpoints

    @breakpoints.setter
    def breakpoints(self, breakpoints: Iterable[Breakpoint]) -> None:
        self.stopper.breakpoints = frozenset(breakpoints)
        if self._state in (RunState.ACTIVE, RunState.HOLD):
            self.feed.look_again()

    @property
    def block_delete(self) -> frozenset[int]:
        """The numbers of the skip marks whose blocks are left out, among the blocks prepared from now on."""
        return self._block_delete

    @block_delete.setter
    def block_delete(self, levels: Iterable[int]) -> None:
        self._block_delete = self.channel.skip_levels = frozenset(levels)

    @property
    def dry_run(self) -> bool:
        """Whether moves at feed go with the feed of a dry run."""
        return self.overrides.dry_run

    @dry_run.setter
    def dry_run(self, on: bool) -> None:
        self.overrides.dry_run = on

    @property
    def machine_lock(self) -> bool:
        """Whether the path is executed without its axes.

        Raises:
            UsageError: on a change while the axes move.
        """
        return self._locked

    @machine_lock.setter
    def machine_lock(self, on: bool) -> None:
        if on == self._locked:
            return
        if not self.at_rest:
            raise UsageError("the machine lock cannot change while the axes move", hint="Hold first.")
        if not on and self._state not in _OVER:
            raise UsageError(
                "the machine lock cannot be taken off within a program",
                hint="End or reset the program first.",
            )
        self._locked = on
        self._give_axes()

    @property
    def rapid_override(self) -> float:
        """Factor of positioning speeds, 0 to 1; 0 is the lowest speed of the options (F0)."""
        return self.overrides.rapid

    @rapid_override.setter
    def rapid_override(self, factor: float) -> None:
        self.overrides.rapid = factor

    @property
    def feed_override(self) -> float:
        """Factor of the programmed feeds, 0 to 2; at 0 moves at feed stand."""
        return self.overrides.feed

    @feed_override.setter
    def feed_override(self, factor: float) -> None:
        self.overrides.feed = factor

    def stands_at(self, stop: Stop) -> bool:
        """Tell whether the program would stand at such a stop now."""
        return self._options.stands_at_stops and (stop is Stop.PROGRAM or self.optional_stop)

    # ------------------------------------------------------------------ what it is doing

    @property
    def state(self) -> RunState:
        """What the run is doing."""
        return self._state

    @property
    def active(self) -> bool:
        """Whether the program is being executed."""
        return self._state is RunState.ACTIVE

    @property
    def at_rest(self) -> bool:
        """Whether the path stands."""
        return bool(self._row["state"] != kernel.RUNNING)

    @property
    def error(self) -> ProgramError | None:
        """What is wrong with the program, if anything is, as far as it has been prepared."""
        return self.channel.error

    @property
    def executed_tag(self) -> int:
        """The tag of the block that is executed, or was last."""
        row = self._row
        if self._met is not None and row["state"] == kernel.READY and row["head"] == self._met[0]:
            return self._met[1]
        return int(row["tag"])

    @property
    def executed(self) -> BlockRecord | None:
        """The block that is executed, or was last; None before the first."""
        return self.channel.records.block(self.executed_tag)

    @property
    def stack(self) -> tuple[Call, ...]:
        """The calls that led to the executed block, the outermost first."""
        record = self.executed
        return () if record is None else record.stack

    @property
    def modal(self) -> ModalWords | None:
        """The modal words in force with the executed block."""
        record = self.executed
        return None if record is None else record.modal

    @property
    def position(self) -> dict[str, float]:
        """Where the path stands (machine coordinates, mm or degree)."""
        return self._by_axis(self.machine.state.paths.position[self.path])

    @property
    def tool_times(self) -> dict[int, ToolTime]:
        """How long each tool has cut and positioned so far; tool 0 is an empty spindle."""
        return self._tool_times.until(self._seconds())

    @property
    def path_times(self) -> ToolTime:
        """How long the path has cut and positioned so far, with whatever tool."""
        return self._seconds()

    @property
    def distance_to_go(self) -> dict[str, float]:
        """What is left to the end of the executed block (mm or degree); 0 where none is being executed."""
        return self._by_axis(self.to_go)

    @property
    def to_go(self) -> Floats:
        """What `distance_to_go` tells, by the place of the axis."""
        row = self._row
        here = self.machine.state.paths.position[self.path]
        if row["state"] not in (kernel.RUNNING, kernel.HELD):
            return np.zeros_like(here)
        last = self.feed.block_end(int(row["head"])) - 1
        k = int(row["base"]) + last % int(row["capacity"])
        left: Floats = self.machine.state.seg.end[k] - here
        return left

    # ------------------------------------------------------------------ time

    def advance(self, cycles: int, *, until: Until | None = None) -> int:
        """Let up to `cycles` cycles pass; return how many did.

        It returns early when the run comes to a stand (a block's end, a program stop, its end, an alarm), and with
        `until` when one of those reasons was met or the condition holds after a cycle.
        """
        clock = self.machine.state.clock[0]
        condition = until if callable(until) and not isinstance(until, Reason) else None
        reasons = int(until) if isinstance(until, Reason) else 0
        done = 0
        while done < cycles:
            moving = self._state in (RunState.ACTIVE, RunState.HOLD)
            clock["mask"] = reasons
            most = self.before_cycles(cycles - done) or cycles - done
            if moving and self._state not in (RunState.ACTIVE, RunState.HOLD):
                break
            ran = self.machine.advance(1 if condition is not None else most, until=int(clock["mask"]))
            done += ran
            self.after_cycles(ran)
            if moving and self._state not in (RunState.ACTIVE, RunState.HOLD):
                break
            if int(clock["raised"]) & reasons or (condition is not None and condition()):
                break
        return done

    def skip(self) -> int:
        """Go along what is planned in closed form, to the next thing to be done; return the cycles.

        For runs that nobody looks at: servos are ideal, limit switches and the recorder see nothing.
        """
        self._tidy()
        self.feed.feed()
        self._take_suppressed()
        target = self.feed.target()
        done = 0
        while self._state is RunState.ACTIVE and self._row["head"] < target:
            if self._probing is not None:
                return done + self.advance(1)
            cycles = self.machine.skip(self.path, target)
            done += cycles
            if self._row["event"] >= 0:
                self._meet_event()
            elif cycles == 0:
                break
        if done == 0 and self._row["head"] >= self._row["tail"] and not self.channel.done:
            done = self.advance(1)  # the program itself waits for something
        self._look()
        return done

    def before_cycles(self, cycles: int) -> int:
        """Make ready for up to `cycles` cycles; return how many may pass before `after_cycles`, 0 for any number.

        What must end `machine.advance` early is put into the clock's mask, beside what is there.
        """
        if self._dropping or (self._state is RunState.HOLD and self.at_rest):
            return 0 if self.at_rest else cycles
        if self._state not in (RunState.ACTIVE, RunState.HOLD):
            return 0
        self._tidy()
        self.feed.feed()
        self._take_suppressed()
        self._look()
        self.machine.state.clock[0]["mask"] |= _MASK
        often = self._probing is not None or (
            self._options.asks_often and self.at_rest and not self.channel.done
        )
        return min(cycles, 1) if often else cycles

    def after_cycles(self, cycles: int) -> None:
        """Do what the last `cycles` cycles ask for."""
        raised = int(self.machine.state.clock[0]["raised"])
        if self._probing is not None:
            self._probe(self._probing)
        if raised & kernel.PATH_EVENT and self._row["event"] >= 0:
            self._meet_event()
        if raised & kernel.RECORDER_FULL:
            self.drain()
        if (found := axis_alarm(self.machine, raised, self.path)) is not None:
            self._stop_by(*found)
        self._look()

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

    def snapshot(self) -> RunSnapshot:
        """Return everything that this run holds, to go back to with `restore`.

        The machine has a snapshot of its own: take and restore both together.

        Raises:
            UsageError: a language executes the program; where that stands cannot be kept.
        """
        return taken_of(self)

    def restore(self, saved: RunSnapshot) -> None:
        """Go back to a snapshot of this run."""
        put_back(self, saved)

    # ------------------------------------------------------------------ within

    def _tidy(self) -> None:
        """Forget records that nobody can ask for any more."""
        if self.channel.records.crowded:
            self.drain()  # rows refer to records
            self.feed.forget_records(self.executed_tag)

    def _check_over(self) -> None:
        """Refuse what would change the program while it is executed."""
        if self._state not in _OVER:
            raise UsageError(f"the program is {self._state.value}", hint="Reset it, or let it end.")
        self._check_start()

    def _check_start(self) -> None:
        if self._state is RunState.ALARM:
            raise UsageError("there is an alarm", hint="Reset it first.")
        if self._dropping:
            raise UsageError("the axes are still braking", hint="Let time pass until `at_rest`.")

    def _begin(self, step: Step) -> None:
        """Begin the program from where the axes stand."""
        state, path = self.machine.state, self.path
        if self._state is not RunState.READY:
            self._replace_channel(self.program, keeps_modal=False)
        kernel.give_to_path(state, path)
        self._give_axes()
        self.channel.state.modal.position[:] = state.paths.position[path]
        kernel.start_path(state.paths, path)
        self._hold = self._held_back = False
        self._row["limit"] = kernel.NO_LIMIT
        self._row["tag"] = 0
        if self._approach is not None:
            self.channel.begin_at(*self._approach)
            self._approach = None
        self._go(step)

    def _replace_channel(self, program: ProgramText, *, keeps_modal: bool) -> None:
        tool = self.channel.state.tool if self.modal is None else self.modal.tool  # prepared is not changed
        self.channel = self.feed.channel = self._new_channel(program, self.channel, keeps_modal=keeps_modal)
        self.channel.state.tool = tool
        self._met = self._approach = None  # blocks of the program before
        self.stopper.records = self.channel.records
        self.feed.clear()

    def _give_axes(self) -> None:
        """Let the axes follow the path from where they stand, or nothing while the machine is locked."""
        state, path = self.machine.state, self.path
        for column, axis in enumerate(state.paths.axis[path]):
            if axis < 0 or state.owner[axis] not in (path, kernel.OTHER_SOURCE):
                continue
            if state.owner[axis] == kernel.OTHER_SOURCE and not self._locked:  # the path went on without it
                state.paths.position[path, column] = state.paths.queued[path, column] = state.base[axis]
            state.owner[axis] = kernel.OTHER_SOURCE if self._locked else path

    def _seconds(self) -> ToolTime:
        totals = self.machine.state.paths.totals[self.path]
        return ToolTime(float(totals[kernel.FEED_S]), float(totals[kernel.RAPID_S]))

    def _set_hold(self) -> None:
        """Hold the path while anything holds it; take it over where it moves."""
        stands = (
            self._state is RunState.STOPPED_AT_BLOCK
        )  # before a segment that is in the look-ahead already
        met = self._probing is not None and self._probing.met and self._probing.deletes
        hold = self._hold or stands or met or self._stop is not None or self._unanswered
        if bool(self._row["hold"]) != hold:
            self._row["hold"] = hold
            if self._row["state"] == kernel.RUNNING:
                self.feed.replan()

    def _step(self, step: Step) -> None:
        if self._state in _OVER:
            self._check_start()
            self._begin(step)
        elif self._state in _STANDING or self._state is RunState.HOLD:
            self._go(step)
        else:
            raise UsageError("the program is running", hint="Hold it, or let it stop at a breakpoint.")

    def _go(self, step: Step) -> None:
        """Go on from where the program stands, as far as `step` says."""
        within = self._state is RunState.HOLD and self._row["state"] in (kernel.RUNNING, kernel.HELD)
        record = self.executed_tag
        self._pass_stop()
        self._hold = False
        self._state = RunState.ACTIVE
        stopper = self.stopper
        stopper.step = Step.RUN
        self.feed.go_on()
        self.feed.feed()
        following = self.feed.next_tag()
        depth_of = record if within or following is None else following
        stopper.step, stopper.depth = step, self.channel.records.depth(depth_of)
        if not within and self._stand_at_marks():
            self._set_hold()
            return
        self.feed.look_again()
        self._set_hold()
        self._look()

    def _stand_at_marks(self) -> bool:
        """Carry out the blocks without segments that come next; return whether the program stops behind one."""
        for _ in range(_MOST_MARKS):  # a loop may have no other blocks
            if (tag := self.feed.take_mark()) is None:
                break
            self._met = int(self._row["head"]), tag
            following = self.feed.next_tag()
            if following is None:
                self.feed.feed()
                following = self.feed.next_tag()
            if following is not None and self.stopper.stops_before(following):
                self._state = RunState.STOPPED_AT_BLOCK
                return True
        return False

    def _meet_event(self) -> None:
        number = int(self._row["event"])
        event = self.channel.writer.events.pop(number)
        self._met = int(self._row["head"]), event.tag
        self._tool_times = self._tool_times.changed(self.channel.records.tool(event.tag), self._seconds())
        if event.word and self.on_event is not None:
            self._unanswered = bool(self.on_event(event)) and not self._suppressed.answers
            self._set_hold()
        if event.stop in (Stop.PROBE, Stop.PROBE_IN_PASSING):
            self._probing = Probing(event.stop is Stop.PROBE, positions(self.machine))
        elif event.stop is Stop.DRAIN:
            if self._probing is not None:
                self._probing = None
                self.feed.keep_box()
                self._set_hold()
            self.channel.go_on()
        elif event.stop is not None and self.stands_at(event.stop):
            self._stop = event
            self._state = _STOP_STATES[event.stop]
            self._set_hold()
        elif event.stop is not None and self._options.stands_at_stops:
            self.channel.go_on()

    def _probe(self, probing: Probing) -> None:
        """Look for the contact of a probing move; what is left of the move is dropped once the axes stand."""
        if not probing.met:
            if probing.look(self.machine, self.channel, signal=self.skip_signal) and probing.deletes:
                self._set_hold()
                if self.on_skip is not None and self.channel.state.skip_position is not None:
                    self.on_skip()
        elif probing.deletes and self.at_rest and self._state is RunState.ACTIVE:
            delete_rest(self.machine, self.channel, self.feed)
            self._probing = None
            self._set_hold()

    def _pass_stop(self) -> None:
        if self._stop is not None:
            self._stop = None
            self.channel.go_on()

    @property
    def _step_of_switch(self) -> Step:
        """How far a start goes as the switch of single blocks says, and the program lets it."""
        return Step.INTO if self._single_block and not self._suppressed.single_block else Step.RUN

    def _take_suppressed(self) -> None:
        """Let what the program suppresses act no more, and what it did until now act again."""
        was, now = self._suppressed, self.channel.suppressed
        if now == was:
            return
        self._suppressed = now
        self.overrides.suppress_feed(now.override)
        if now.single_block is not was.single_block and self._single_block:
            self.stopper.step = self._step_of_switch
            self.feed.let_pass()
            self.feed.look_again()
        if self._held_back and not now.hold:
            self._held_back = False
            self.hold()

    def _look(self) -> None:
        """See whether the path has come to an end, or to the end of a block."""
        row = self._row
        if self._dropping:
            if self.at_rest:
                self._drop()
        elif self._state is RunState.ACTIVE and row["state"] == kernel.READY and not self._unanswered:
            if row["head"] >= row["limit"]:
                self._stop_at_block()
            elif row["head"] >= row["tail"] and self.channel.done:
                self._state = RunState.COMPLETED if self.channel.error is None else RunState.ALARM

    def _stop_at_block(self) -> None:
        """Stand at the end of a block; blocks without segments before the one to stop at are carried out."""
        self.feed.pass_marks()
        while self.feed.at_mark:
            following = self.feed.next_tag()
            if following is None or self.stopper.stops_before(following):
                break
            tag = self.feed.take_mark()
            assert tag is not None
            self._met = int(self._row["head"]), tag
        self._state = RunState.STOPPED_AT_BLOCK

    def _drop(self) -> None:
        """Drop what is still queued; the path stands."""
        state = self.machine.state
        kernel.drop_queue(state.seg, state.paths, self.path)
        self.channel.writer.clear()
        self.feed.clear()
        self._dropping = False
        self._hold = False
        self._stop = None
        self._unanswered = False
        self._probing = None
        self._met = None
        self._set_hold()

    def _stop_by(self, text: str, code: str) -> None:
        self.alarm = RunAlarm(text, code, self.executed_tag, self.machine.clock.cycles)
        self._state = RunState.ALARM
        self._hold = True
        self._set_hold()

    def _by_axis(self, values: Floats) -> dict[str, float]:
        return {
            name: float(value) for name, value in zip(self.machine.config.axis_names, values, strict=True)
        }
