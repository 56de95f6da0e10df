"""A program run: one program on one path of a machine, that can be stopped and continued at every cycle.

Nothing here changes where the path leads. Holding, overrides and stops at block ends only change how fast it is gone
along, within every axis' limits, so a run that is interrupted ends where the undisturbed one does, to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._run_state import RunAlarm, RunOptions, RunState
from polycnc.errors import ProgramError, UsageError
from polycnc.kernel import (
    BLOCK,
    FOLLOWING_ERROR,
    HELD,
    IDLE,
    LIMIT_HIGH,
    LIMIT_LOW,
    NO_LIMIT,
    PATH_EVENT,
    PATH_RESTED,
    QUEUE_LOW,
    READY,
    RECORDER_FULL,
    RUNNING,
    SWITCH_EDGE,
    drop_queue,
    give_to_path,
    start_path,
)
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
    load_dialect,
)

Floats: TypeAlias = npt.NDArray[np.float64]
Rows: TypeAlias = Callable[[Floats, npt.NDArray[np.int64]], None]
OnEvent: TypeAlias = Callable[[Event], bool | None]
Until: TypeAlias = Reason | Callable[[], bool]

_MASK = QUEUE_LOW | RECORDER_FULL | PATH_EVENT | PATH_RESTED | FOLLOWING_ERROR | SWITCH_EDGE
_LIMIT_SWITCHES = (LIMIT_LOW, LIMIT_HIGH)
_STANDING = {
    RunState.STOPPED_AT_BLOCK,
    RunState.PROGRAM_STOP,
    RunState.OPTIONAL_STOP,
}
_OVER = {RunState.READY, RunState.RESET, RunState.COMPLETED, RunState.ALARM}
_STOP_STATES = {Stop.PROGRAM: RunState.PROGRAM_STOP, Stop.OPTIONAL: RunState.OPTIONAL_STOP}
HIGHEST_OVERRIDE = 2.0


class ProgramRun:
    """Run `program` on path `path` of `machine`.

    `rows` gets the recorder's rows in pieces, with the tag of each row's block; their column BLOCK holds lines.
    `on_event` is told each auxiliary function in the cycle in which the path comes to it; if it returns True the path
    stands there until `answered`. `before` is the run on this path until now, whose modal state goes on.

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
        self.optional_stop = options.optional_stop
        self.alarm: RunAlarm | None = None
        self._options = options
        self._language = language
        self._config = config
        self._library = library
        self._block_delete = options.block_delete
        self._single_block = options.single_block
        self._state = RunState.READY
        self._hold = False  # feed hold; a stop holds the path as well
        self._stop: Event | None = None  # the stop at which the program stands
        self._met: tuple[int, int] | None = None  # segment count and tag of the event at which the path rests
        self._dropping = False
        self._unanswered = False  # an auxiliary function at which the path stands
        self._row = machine.state.paths.row[path]
        self.channel: Channel = self._new_channel(program, None if before is None else before.channel)
        self.feed = PathFeed(machine, self.channel, self._ahead)

    def _new_channel(self, program: ProgramText, before: Channel | None) -> Channel:
        return Channel(
            program,
            self.dialect,
            self.machine,
            path=self.path,
            config=self._config,
            library=self._library,
            language=self._language,
            skip_levels=self._block_delete,
            stands_at_stops=self._options.stands_at_stops,
            before=before,
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
        if self._state is RunState.ALARM:
            raise UsageError("there is an alarm", hint="Reset it first.")
        if self._dropping:
            raise UsageError("the axes are still braking", hint="Let time pass until `at_rest`.")
        if self._state in _OVER:
            self._begin()
        elif self._state is not RunState.ACTIVE:
            self.resume()

    def hold(self) -> None:
        """Brake the axes on the path and stand (feed hold); without effect where nothing is being executed."""
        if self._state is RunState.ACTIVE:
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
        if self._state is RunState.STOPPED_AT_BLOCK:
            self.feed.go_on()
        self._pass_stop()
        self._hold = False
        self._state = RunState.ACTIVE
        self._set_hold()
        self._set_limit(next_block=True)

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
        if self._row["state"] == IDLE:
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
        self._single_block = on
        if self._state in (RunState.ACTIVE, RunState.HOLD):
            if on:
                self._set_limit(next_block=False)
            else:
                self.feed.go_on()
                self.feed.prepare()

    @property
    def feed_override(self) -> float:
        """Factor of the programmed feeds, 0 to 2; at 0 moves at feed stand."""
        return float(self._row["override"])

    @feed_override.setter
    def feed_override(self, factor: float) -> None:
        _check_factor(factor, HIGHEST_OVERRIDE, "the feed override")
        self._row["override"] = factor
        self.feed.replan()

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
        return bool(self._row["state"] != RUNNING)

    @property
    def error(self) -> ProgramError | None:
        """What is wrong with the program, if anything is, as far as it has been prepared."""
        return self.channel.error

    @property
    def executed_tag(self) -> int:
        """The tag of the block that is executed, or was last."""
        row = self._row
        if self._met is not None and row["state"] == READY and row["head"] == self._met[0]:
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
    def distance_to_go(self) -> dict[str, float]:
        """What is left to the end of the executed block (mm or degree); 0 where none is being executed."""
        row = self._row
        here = self.machine.state.paths.position[self.path]
        if row["state"] not in (RUNNING, HELD):
            return self._by_axis(np.zeros_like(here))
        last = self.feed.block_end(int(row["head"])) - 1
        k = int(row["base"]) + last % int(row["capacity"])
        return self._by_axis(self.machine.state.seg.end[k] - here)

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
        self.feed.feed()
        target = self.feed.target()
        done = 0
        while self._state is RunState.ACTIVE and self._row["head"] < target:
            cycles = self.machine.skip(self.path, target)
            done += cycles
            if self._row["event"] >= 0:
                self._meet_event()
            elif cycles == 0:
                break
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
        self.feed.feed()
        self._look()
        self.machine.state.clock[0]["mask"] |= _MASK
        return cycles

    def after_cycles(self, cycles: int) -> None:
        """Do what the last `cycles` cycles ask for."""
        raised = int(self.machine.state.clock[0]["raised"])
        if raised & PATH_EVENT and self._row["event"] >= 0:
            self._meet_event()
        if raised & RECORDER_FULL:
            self.drain()
        if raised & (FOLLOWING_ERROR | SWITCH_EDGE):
            self._check_alarm(raised)
        self._look()

    def drain(self) -> None:
        """Hand the recorded rows on and empty the recorder."""
        recorder = self.machine.state.recorder
        count = int(recorder.filled[0])
        if self.rows is not None and count:
            rows = recorder.rows[:count]
            tags = rows[:, BLOCK].astype(np.int64)
            rows[:, BLOCK] = tags & LINE_MASK
            self.rows(rows, tags)
        recorder.filled[0] = 0

    # ------------------------------------------------------------------ within

    def _begin(self) -> None:
        """Begin the program from where the axes stand."""
        state, path = self.machine.state, self.path
        if self._state is not RunState.READY:
            self.channel = self.feed.channel = self._new_channel(self.program, self.channel)
        give_to_path(state, path)
        self.channel.state.modal.position[:] = state.paths.position[path]
        start_path(state.paths, path)
        self._hold = False
        self._row["limit"] = NO_LIMIT
        self._state = RunState.ACTIVE
        self._set_hold()
        self._set_limit(next_block=True)

    def _set_hold(self) -> None:
        """Hold the path while anything holds it; take it over where it moves."""
        hold = self._hold or self._stop is not None or self._unanswered
        if bool(self._row["hold"]) != hold:
            self._row["hold"] = hold
            if self._row["state"] == RUNNING:
                self.feed.replan()

    def _set_limit(self, *, next_block: bool) -> None:
        """In single block, let the path rest behind the block that runs, or comes next."""
        if not self._single_block:
            return
        if next_block:
            self.feed.feed()
        self.feed.stop_behind(int(self._row["head"]))
        self.feed.prepare()

    def _meet_event(self) -> None:
        number = int(self._row["event"])
        event = self.channel.writer.events.pop(number)
        self._met = int(self._row["head"]), event.tag
        if event.word and self.on_event is not None:
            self._unanswered = bool(self.on_event(event))
            self._set_hold()
        if event.stop is Stop.DRAIN:
            self.channel.go_on()
        elif event.stop is not None and self.stands_at(event.stop):
            self._stop = event
            self._state = _STOP_STATES[event.stop]
            self._set_hold()
        elif event.stop is not None and self._options.stands_at_stops:
            self.channel.go_on()

    def _pass_stop(self) -> None:
        if self._stop is not None:
            self._stop = None
            self.channel.go_on()

    def _look(self) -> None:
        """See whether the path has come to an end, or to the end of a block."""
        row = self._row
        if self._dropping:
            if self.at_rest:
                self._drop()
        elif self._state is RunState.ACTIVE and row["state"] == READY and not self._unanswered:
            if row["head"] >= row["tail"] and self.channel.done:
                self._state = RunState.COMPLETED if self.channel.error is None else RunState.ALARM
            elif row["head"] >= row["limit"]:
                self._state = RunState.STOPPED_AT_BLOCK

    def _drop(self) -> None:
        """Drop what is still queued; the path stands."""
        state = self.machine.state
        drop_queue(state.seg, state.paths, self.path)
        self.channel.writer.clear()
        self.feed.clear()
        self._dropping = False
        self._hold = False
        self._stop = None
        self._unanswered = False
        self._met = None
        self._set_hold()

    def _check_alarm(self, raised: int) -> None:
        state, config = self.machine.state, self.machine.config
        for index, axis in enumerate(config.axes):
            if raised & FOLLOWING_ERROR and state.servo.error_tripped[index]:
                error = float(state.servo.row[index]["following_error"])
                self._stop_by(
                    f"axis {axis.name}: following error {error:.4f} {axis.unit} is above its limit",
                    "following_error",
                )
                return
            if raised & SWITCH_EDGE and any(
                state.switches.switch[index, j]["level"] for j in _LIMIT_SWITCHES
            ):
                at = float(state.servo.actual[index])
                self._stop_by(
                    f"axis {axis.name} is on a limit switch at {at:.3f} {axis.unit}", "limit_switch"
                )
                return

    def _stop_by(self, text: str, code: str) -> None:
        self.alarm = RunAlarm(text, code, self.executed_tag, self.machine.clock.cycles)
        self._state = RunState.ALARM
        self._hold = True
        self._set_hold()

    def _by_axis(self, values: Floats) -> dict[str, float]:
        return {
            name: float(value) for name, value in zip(self.machine.config.axis_names, values, strict=True)
        }


def _check_factor(factor: float, highest: float, what: str) -> None:
    if not 0.0 <= factor <= highest:
        raise UsageError(f"{what} cannot be {factor:g}", hint=f"Give a factor from 0 to {highest:g}.")
