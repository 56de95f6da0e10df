"""A program run: one program on one path of a machine, that can be stopped and continued at every cycle.

Nothing here changes where the path leads. Holding, overrides and stops at block ends only change how fast it is
followed, within every axis' limits, so a run that is interrupted ends where the undisturbed one does, to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from polycnc import kernel
from polycnc.cnc._block_search import block_line, calculate_to
from polycnc.cnc._passed_events import OnPassed
from polycnc.cnc._path_events import OnEvent
from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._path_overrides import PathOverrides
from polycnc.cnc._path_runner import Floats, PathRunner, Rows, Until
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_snapshot import DEVICE, FindText, RunSnapshot, SavedRun, file_text
from polycnc.cnc._run_state import RunAlarm, RunOptions, RunState
from polycnc.cnc._stops import Breakpoint, Step, Stopper
from polycnc.cnc._tool_times import ToolTime, path_times
from polycnc.errors import ProgramError, UsageError
from polycnc.machine import Machine, MachineConfig, Snapshot, SnapshotError, described
from polycnc.nc import (
    BlockRecord,
    Call,
    Channel,
    ChannelOptions,
    Dialect,
    IncomingText,
    Language,
    Library,
    LineCheck,
    ModalWords,
    ProgramText,
    Stop,
    Suppressed,
    load_dialect,
)

_STANDING = {RunState.STOPPED_AT_BLOCK, RunState.PROGRAM_STOP, RunState.OPTIONAL_STOP}
_GOING = {RunState.ACTIVE, RunState.HOLD}
_OVER = {RunState.READY, RunState.RESET, RunState.COMPLETED, RunState.ALARM}


class ProgramRun:
    """Run `program` on path `path` of `machine`.

    `rows` gets the recorder's rows in pieces, with the tag of each row's block; their column BLOCK holds lines.
    `on_event` gets each auxiliary function in the cycle in which the path comes to it; if it returns True the path
    stands there until `answered`. With `on_passed` the path does not stop for those at which it need not: they are told
    later, to that. `axes` are the
    names of the machine's axes in this channel, those of others by `of_another_channel`.

    `skip_signal` is the signal that ends a skip move: the axes brake, and the next block goes on from where they stand.
    The surfaces of the machine file do the same. `on_skip` is called when either ends a move.

    Without `attaches` it is made to go back to a snapshot: only then it takes its language over.

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
        on_passed: OnPassed | None = None,
        attaches: bool = True,
    ) -> None:
        options = options or RunOptions()
        self.machine = machine
        self.program = self._first = program
        self.dialect = load_dialect(dialect)
        self.path = path
        self._options = options
        self._language = language
        self._axes = axes
        self._config = config
        self._library = library
        moment = RunProgress(options.block_delete, options.single_block, options.optional_stop)
        channel = self._new_channel(program, None, options.block_delete, attaches=attaches)
        ahead = self.dialect.blocks_ahead if options.blocks_ahead is None else options.blocks_ahead
        self._path_runner = PathRunner(machine, channel, options, moment, ahead=ahead)
        self._path_runner.rows = rows
        self._path_runner.events.on_event = on_event
        self._path_runner.passed.told = on_passed

    def _new_channel(
        self,
        program: ProgramText,
        before: Channel | None,
        skip_levels: frozenset[int],
        *,
        keeps_modal: bool = True,
        attaches: bool = True,
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
            skip_levels=skip_levels,
            options=ChannelOptions(
                stands_at_stops=self._options.stands_at_stops,
                answers=self._options.answers,
                marks=self._options.stands_at_stops,
                collect_errors=self._options.collect_errors,
                mark_refused=self._options.mark_refused,
            ),
            before=before,
            keeps_modal=keeps_modal,
            attaches=attaches,
        )

    # ------------------------------------------------------------------ what it is made of

    @property
    def channel(self) -> Channel:
        """The channel that prepares the program."""
        return self._path_runner.channel

    @property
    def language(self) -> Language | None:
        """The language that executes the program, None where it holds NC blocks only."""
        return self._language

    @property
    def feed(self) -> PathFeed:
        """What keeps the path supplied."""
        return self._path_runner.feed

    @property
    def stopper(self) -> Stopper:
        """What decides where the path rests between blocks."""
        return self._path_runner.stopper

    @property
    def overrides(self) -> PathOverrides:
        """How fast the path goes, against what is programmed."""
        return self._path_runner.overrides

    @property
    def on_event(self) -> OnEvent | None:
        """What gets each auxiliary function."""
        return self._path_runner.events.on_event

    @on_event.setter
    def on_event(self, on_event: OnEvent | None) -> None:
        self._path_runner.events.on_event = on_event

    @property
    def on_skip(self) -> Callable[[], None] | None:
        """What is called at the end of a skip move."""
        return self._path_runner.events.on_skip

    @on_skip.setter
    def on_skip(self, on_skip: Callable[[], None] | None) -> None:
        self._path_runner.events.on_skip = on_skip

    # ------------------------------------------------------------------ commands

    def start(self) -> None:
        """Begin the program, or go on where it stands or is held (cycle start).

        Raises:
            UsageError: the axes are still moving, or there is an alarm.
        """
        self._check_start()
        if self._moment.state in _OVER:
            self._begin(self._path_runner.step_of_switch)
        elif self._moment.state is not RunState.ACTIVE:
            self.resume()

    def hold(self, *, at_once: bool = False) -> None:
        """Brake the axes on the path and stand (feed hold); without effect where nothing is being executed.

        While the program suppresses feed holds it comes as soon as it does no more, or `at_once`.
        """
        self._path_runner.hold(at_once=at_once)

    def resume(self) -> None:
        """Go on from a feed hold, a block's end, or a program stop.

        Raises:
            UsageError: the program does not stand at any of these.
        """
        if self._moment.state is not RunState.HOLD and self._moment.state not in _STANDING:
            raise UsageError(
                f"there is nothing to resume: the program is {self._moment.state.value}", hint="Start it."
            )
        self._path_runner.go(self._path_runner.step_of_switch)

    def load(self, program: ProgramText, *, keeps_modal: bool = False) -> None:
        """Select another program; with `keeps_modal` it begins with the modal state that is in force.

        Raises:
            UsageError: a program is being executed, or there is an alarm.
        """
        self._check_over()
        keeps = keeps_modal and self._moment.state is not RunState.RESET
        self._replace_channel(program, keeps_modal=keeps)
        self.program = program
        self._moment.state = RunState.READY

    def mdi(self, text: str) -> None:
        """Execute blocks that are typed in; modal words stay in force for the next (manual data input).

        Raises:
            UsageError: a program is being executed, or there is an alarm.
        """
        self.load(ProgramText.from_text(text, "MDI"), keeps_modal=True)
        self.start()

    def search(
        self, *, line: int = 0, sequence: int | None = None, calculate: bool = False, last: int = 0
    ) -> int:
        """Let the program begin at a block: the one on `line`, or the first with sequence number `sequence`.

        With `calculate` everything before is carried out without moving, and with the start the axes go straight at
        rapid to where that block begins; else modal state and position are what they are. The program ends after the
        block on line `last`, if one is given. Return the line.

        Raises:
            UsageError: there is no such block, or the program cannot begin there; it stands at its beginning then.
        """
        self._check_over()
        target = block_line(self.program, line, sequence)
        self._replace_channel(self.program, keeps_modal=False)
        self._moment.state = RunState.READY
        self.channel.bound(target, last)
        if not calculate:
            self.channel.go_to(target)
            return target
        try:
            calculate_to(self.machine, self.channel, target)
        except UsageError:
            self._replace_channel(self.program, keeps_modal=False)
            raise
        self._moment.searched = tuple(self.channel.state.modal.position.tolist())
        self._moment.approach = (self._moment.searched, target)
        return target

    @property
    def searched(self) -> tuple[float, ...] | None:
        """Where the calculated search of a block has come to (machine coordinates, mm or degree), None if none was."""
        if self.channel.seeking:
            return tuple(self.channel.state.modal.position.tolist())
        return self._moment.searched

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
        self._path_runner.events.answered()

    def reset(self) -> None:
        """Break the program off: the axes brake on the path, then the rest of it is dropped.

        An alarm is over. The next start begins the program anew, from where the axes stand.
        """
        self._moment.alarm = None
        self.channel.close()
        self.channel.suppressed = Suppressed()
        self._moment.held_back = False
        self._path_runner.take_suppressed()
        if self._path_runner.row["state"] == kernel.IDLE:
            self._moment.state = RunState.RESET
            return
        self._moment.dropping = True
        self._moment.hold = True
        self._moment.state = RunState.RESET
        self._path_runner.path_hold.apply()
        self._path_runner.look()

    @property
    def single_block(self) -> bool:
        """Whether the program stops at the end of every block."""
        return self._moment.single_block

    @single_block.setter
    def single_block(self, on: bool) -> None:
        if on == self._moment.single_block:
            return
        self._moment.single_block = on
        self.stopper.step = self._path_runner.step_of_switch
        self._path_runner.take_switch()
        if self._moment.state in _GOING:
            self.feed.look_again()

    @property
    def breakpoints(self) -> frozenset[Breakpoint]:
        """Where the program stops besides."""
        return self.stopper.breakpoints

    @breakpoints.setter
    def breakpoints(self, breakpoints: Iterable[Breakpoint]) -> None:
        self.stopper.breakpoints = frozenset(breakpoints)
        if self._moment.state in _GOING:
            self.feed.look_again()

    @property
    def block_delete(self) -> frozenset[int]:
        """The numbers of the skip marks whose blocks are left out, among the blocks prepared from now on."""
        return self._moment.block_delete

    @block_delete.setter
    def block_delete(self, levels: Iterable[int]) -> None:
        self._moment.block_delete = self.channel.skip_levels = frozenset(levels)

    @property
    def optional_stop(self) -> bool:
        """Whether the program stands at M1."""
        return self._moment.optional_stop

    @optional_stop.setter
    def optional_stop(self, on: bool) -> None:
        self._moment.optional_stop = on

    @property
    def skip_signal(self) -> bool:
        """Whether the signal is on that ends a skip move."""
        return self._moment.skip_signal

    @skip_signal.setter
    def skip_signal(self, on: bool) -> None:
        self._moment.skip_signal = on

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
        return self._moment.locked

    @machine_lock.setter
    def machine_lock(self, on: bool) -> None:
        if on == self._moment.locked:
            return
        if not self.at_rest:
            raise UsageError("the machine lock cannot change while the axes move", hint="Hold first.")
        if not on and self._moment.state not in _OVER:
            raise UsageError(
                "the machine lock cannot be taken off within a program",
                hint="End or reset the program first.",
            )
        self._moment.locked = on
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
        return self._path_runner.events.stands_at(stop)

    # ------------------------------------------------------------------ what it is doing

    @property
    def state(self) -> RunState:
        """What the run is doing."""
        return self._moment.state

    @property
    def active(self) -> bool:
        """Whether the program is being executed."""
        return self._moment.state is RunState.ACTIVE

    @property
    def at_rest(self) -> bool:
        """Whether the path stands."""
        return self._path_runner.at_rest

    @property
    def alarm(self) -> RunAlarm | None:
        """Why the machine stopped the run, if it did."""
        return self._moment.alarm

    @property
    def error(self) -> ProgramError | None:
        """What is wrong with the program, if anything is, as far as it has been prepared."""
        return self.channel.error

    @property
    def starved(self) -> bool:
        """Whether the path rests because nothing more of a program that is still coming has come."""
        row = self._path_runner.row
        rests = self.at_rest and not self._moment.unanswered and bool(row["head"] >= row["tail"])
        return self.active and rests and self.channel.starved

    @property
    def queued(self) -> int:
        """How many moves and waits are queued that have not been executed."""
        return int(self._path_runner.row["tail"] - self._path_runner.row["head"])

    def line_check(self) -> LineCheck:
        """Return a check of blocks that would come after what has been prepared."""
        check = self.channel.line_check()
        if self._moment.state is RunState.READY:  # a start begins where the axes are
            check.state.modal.position[:] = self.machine.state.base
        return check

    def has_come(self) -> None:
        """Take note that more has come of a program that is still coming."""
        self.feed.wake()

    @property
    def executed_tag(self) -> int:
        """The tag of the block that is executed, or was last."""
        return self._path_runner.executed_tag

    @property
    def blocks_done(self) -> int:
        """How many blocks have been executed since the start, of those that move, dwell or hand out functions."""
        return int(self._path_runner.row["blocks"])

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
        return self._moment.tool_times.until(path_times(self.machine, self.path))

    @property
    def path_times(self) -> ToolTime:
        """How long the path has cut and positioned so far, with whatever tool."""
        return path_times(self.machine, self.path)

    @property
    def distance_to_go(self) -> dict[str, float]:
        """What is left to the end of the executed block (mm or degree); 0 where none is being executed."""
        return self._by_axis(self.to_go)

    @property
    def to_go(self) -> Floats:
        """What `distance_to_go` tells, by the place of the axis."""
        return self._path_runner.to_go

    # ------------------------------------------------------------------ time

    def advance(self, cycles: int, *, until: Until | None = None, asleep: bool = False) -> int:
        """Let up to `cycles` cycles pass; return how many did.

        It returns early when the run stops (a block's end, a program stop, its end, an alarm), and with
        `until` when one of those reasons was met or the condition holds after a cycle. `asleep`: a language that waits
        is not asked meanwhile, since nothing can have come.
        """
        return self._path_runner.advance(cycles, until=until, asleep=asleep)

    def skip(self) -> int:
        """Follow what is planned in closed form, to the next thing to be done; return the cycles.

        For runs that nobody looks at: servos are ideal, limit switches and the recorder see nothing.
        """
        return self._path_runner.skip()

    def before_cycles(self, cycles: int) -> int:
        """Make ready for up to `cycles` cycles; return how many may pass before `after_cycles`, 0 for any number.

        What must end `machine.advance` early is put into the clock's mask, beside what is there.
        """
        return self._path_runner.before_cycles(cycles)

    def after_cycles(self, cycles: int) -> None:
        """Do what the last `cycles` cycles ask for."""
        self._path_runner.after_cycles(cycles)

    def drain(self) -> None:
        """Hand the recorded rows on and empty the recorder."""
        self._path_runner.drain()

    def snapshot(self, *, find: FindText = file_text) -> RunSnapshot:
        """Return everything that this run holds, to go back to with `restore`, in a process of any time.

        The machine has a snapshot of its own: take and restore both together. `find` gives the present text of a
        program; the programs that it finds must be the same when the run goes back.

        Raises:
            SnapshotError: a language executes the program, and cannot tell where it stands.
        """
        program = self.program
        if isinstance(program, IncomingText):
            if not self.channel.done:
                raise SnapshotError(
                    "a program that is still coming is under way",
                    hint="Take the snapshot before or after it.",
                )
            program = ProgramText(program.name, b"")
        saved = SavedRun(
            program,
            self.channel.snapshot(),
            self.feed.snapshot(),
            self.stopper.step,
            self.stopper.depth,
            self.overrides.kept,
            self._moment.copy(),
        )
        return RunSnapshot.of(self._made_from, self.machine.clock.cycles, saved, self._language, find)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this run, or of one that was made alike; breakpoints stay as they are.

        Raises:
            SnapshotError: It is of something else, of a program that has been changed since, or damaged; nothing has
                changed.
        """
        self.restore_point(snapshot)()

    def restore_point(self, snapshot: Snapshot, *, find: FindText = file_text) -> Callable[[], None]:
        """Return what `restore` does, when it is certain that it can be done.

        Raises:
            SnapshotError: As `restore`.
        """
        snapshot.check(DEVICE, self._made_from, ())
        saved = RunSnapshot.of_any(snapshot).saved(self._language, find)
        mine, kept = self.program, saved.program
        if mine is self._first and mine.name == kept.name and mine.content != kept.content:
            raise SnapshotError(
                f"{mine.name} is another program than the one of the snapshot",
                hint="give the same one, or use another snapshot",
            )
        channel = self._new_channel(kept, None, saved.moment.block_delete, attaches=False)
        back = channel.restore_point(saved.channel)
        return lambda: self._go_back(saved, channel, back)

    def _go_back(self, saved: SavedRun, channel: Channel, back: Callable[[], None]) -> None:
        runner = self._path_runner
        back()
        self.program = saved.program
        runner.channel = channel
        runner.feed.restore(saved.feed)
        runner.stopper.step, runner.stopper.depth = saved.step, saved.depth
        runner.overrides.kept = saved.override_kept
        runner.moment.restore(saved.moment)
        runner.take_switch()

    @property
    def _made_from(self) -> str:
        return described((self.machine.config, self.path, self.dialect, self._options, self._axes))

    # ------------------------------------------------------------------ within

    @property
    def _moment(self) -> RunProgress:
        return self._path_runner.moment

    def _check_over(self) -> None:
        """Refuse what would change the program while it is executed."""
        if self._moment.state not in _OVER:
            raise UsageError(f"the program is {self._moment.state.value}", hint="Reset it, or let it end.")
        self._check_start()

    def _check_start(self) -> None:
        if self._moment.state is RunState.ALARM:
            raise UsageError("there is an alarm", hint="Reset it first.")
        if self._moment.dropping:
            raise UsageError("the axes are still braking", hint="Let time pass until `at_rest`.")

    def _begin(self, step: Step) -> None:
        """Begin the program from where the axes stand."""
        state, path = self.machine.state, self.path
        if self._moment.state is not RunState.READY:
            self._replace_channel(self.program, keeps_modal=False)
        kernel.give_to_path(state, path)
        self._give_axes()
        self.channel.state.modal.position[:] = state.paths.position[path]
        kernel.start_path(state.paths, path)
        self._moment.hold = self._moment.held_back = False
        self._path_runner.row["limit"] = kernel.NO_LIMIT
        self._path_runner.row["tag"] = self._path_runner.row["blocks"] = 0
        if self._moment.approach is not None:
            self.channel.begin_at(*self._moment.approach)
            self._moment.approach = None
        self._path_runner.go(step)

    def _replace_channel(self, program: ProgramText, *, keeps_modal: bool) -> None:
        tool = self.channel.state.tool if self.modal is None else self.modal.tool  # prepared is not changed
        channel = self._new_channel(program, self.channel, self.block_delete, keeps_modal=keeps_modal)
        channel.state.tool = tool
        self._path_runner.channel = channel
        self._moment.met = self._moment.approach = self._moment.searched = None  # of the program before
        self.feed.clear()

    def _give_axes(self) -> None:
        """Let the axes follow the path from where they stand, or nothing while the machine is locked."""
        state, path, locked = self.machine.state, self.path, self._moment.locked
        for column, axis in enumerate(state.paths.axis[path]):
            if axis < 0 or state.owner[axis] not in (path, kernel.OTHER_SOURCE):
                continue
            if state.owner[axis] == kernel.OTHER_SOURCE and not locked:  # the path went on without it
                state.paths.position[path, column] = state.paths.queued[path, column] = state.base[axis]
            state.owner[axis] = kernel.OTHER_SOURCE if locked else path

    def _step(self, step: Step) -> None:
        if self._moment.state in _OVER:
            self._check_start()
            self._begin(step)
        elif self._moment.state in _STANDING or self._moment.state is RunState.HOLD:
            self._path_runner.go(step)
        else:
            raise UsageError("the program is running", hint="Hold it, or let it stop at a breakpoint.")

    def _by_axis(self, values: Floats) -> dict[str, float]:
        return {
            name: float(value) for name, value in zip(self.machine.config.axis_names, values, strict=True)
        }
