"""A program run: one program on one path of a machine, that can be stopped and continued at every cycle.

Nothing here changes where the path leads. Holding, overrides and stops at block ends only change how fast it is
followed, within every axis' limits, so a run that is interrupted ends where the undisturbed one does, to the last bit.
Only a stop at the end of a block whose corner would be rounded is in the corner itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from polycnc import kernel
from polycnc.cnc._passed_events import OnPassed
from polycnc.cnc._path_events import OnEvent, PathEvents
from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._path_overrides import PathOverrides
from polycnc.cnc._path_runner import PathRunner, Rows, Until
from polycnc.cnc._run_channels import RunChannels
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_reading import RunReading
from polycnc.cnc._run_selection import RunSelection
from polycnc.cnc._run_snapshot import FindText, RunGoingBack, RunSnapshot, file_text
from polycnc.cnc._run_state import OVER, STANDING, RunAlarm, RunOptions, RunState
from polycnc.cnc._run_switches import RunSwitches
from polycnc.cnc._stops import Step, Stopper
from polycnc.errors import ProgramError, UsageError
from polycnc.machine import Machine, MachineConfig, Snapshot
from polycnc.nc import Channel, Dialect, Language, Library, LineCheck, ProgramText, Suppressed, load_dialect


class ProgramRun:
    """Run `program` on path `path` of `machine`.

    `selection` holds the program and where in it the run begins, `switches` what an operator sets for it, `reading`
    what it shows, `events` what its path meets.

    `rows` gets the recorder's rows in pieces, with the tag of each row's block; their column BLOCK holds lines.
    `on_event` gets each auxiliary function in the cycle in which the path comes to it; if it returns True the path
    stands there until `events.answered`. With `on_passed` the path does not stop for those at which it need not: they
    are reported to that later. `axes` are the names of the machine's axes in this channel, those of others by
    `of_another_channel`.

    `switches.skip_signal` is the signal that ends a skip move: the axes brake, and the next block goes on from where
    they stand. The surfaces of the machine file do the same. `events.on_skip` is called when either ends a move.

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
        self.dialect = load_dialect(dialect)
        self.path = path
        self._channels = RunChannels(machine, path, self.dialect, options, config, library, language, axes)
        channel = self._channels.make(program, options.block_delete, attaches=attaches)
        ahead = self.dialect.blocks_ahead if options.blocks_ahead is None else options.blocks_ahead
        self._moment = RunProgress(options.block_delete, options.single_block, options.optional_stop)
        self._runner = runner = PathRunner(machine, channel, options, self._moment, ahead=ahead)
        runner.rows = rows
        runner.events.on_event = on_event
        runner.passed.told, runner.passed.on_event = on_passed, on_event
        self.events: PathEvents = runner.events
        self.feed: PathFeed = runner.feed
        self.stopper: Stopper = runner.stopper
        self.overrides: PathOverrides = runner.overrides
        self.switches = RunSwitches(runner)
        self.reading: RunReading = runner.reading
        self.selection = RunSelection(runner, self._channels, self.reading, program)
        self._going_back = RunGoingBack(runner, self._channels, program)

    @property
    def program(self) -> ProgramText:
        """The program that is selected."""
        return self.selection.program

    @property
    def channel(self) -> Channel:
        """The channel that prepares the program."""
        return self._runner.channel

    @property
    def language(self) -> Language | None:
        """The language that executes the program, None where it holds NC blocks only."""
        return self._channels.language

    # ------------------------------------------------------------------ commands

    def start(self) -> None:
        """Begin the program, or go on where it stands or is held (cycle start).

        Raises:
            UsageError: the axes are still moving, or there is an alarm.
        """
        self.selection.check_start()
        if self._moment.state in OVER:
            self.selection.begin(self._runner.step_of_switch)
        elif self._moment.state is not RunState.ACTIVE:
            self.resume()

    def hold(self, *, at_once: bool = False) -> None:
        """Brake the axes on the path and stand (feed hold); without effect where nothing is being executed.

        While the program suppresses feed holds it comes as soon as it does no more, or `at_once`.
        """
        self._runner.path_hold.brake(at_once=at_once)

    def resume(self) -> None:
        """Go on from a feed hold, a block's end, or a program stop.

        Raises:
            UsageError: the program does not stand at any of these.
        """
        if self._moment.state is not RunState.HOLD and self._moment.state not in STANDING:
            raise UsageError(
                f"there is nothing to resume: the program is {self._moment.state.value}", hint="Start it."
            )
        self._runner.go(self._runner.step_of_switch)

    def mdi(self, text: str) -> None:
        """Execute blocks that are typed in; modal words stay in force for the next (manual data input).

        Raises:
            UsageError: a program is being executed, or there is an alarm.
        """
        self.selection.load(ProgramText.from_text(text, "MDI"), keeps_modal=True)
        self.start()

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

    def reset(self) -> None:
        """Break the program off: the axes brake on the path, then the rest of it is dropped.

        An alarm is over. The next start begins the program anew, from where the axes stand.
        """
        self._moment.alarm = None
        self.channel.close()
        self.channel.suppressed = Suppressed()
        self._moment.held_back = False
        self._runner.take_suppressed()
        self._moment.state = RunState.RESET
        if self._runner.row["state"] == kernel.IDLE:
            return
        self._runner.row["tag"] = self.reading.tag  # a block without motion stays the last one
        self._moment.dropping = True
        self._moment.hold, self._moment.hold_later = True, False
        self._runner.path_hold.apply()
        self._runner.look()

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
        return self.reading.at_rest

    @property
    def alarm(self) -> RunAlarm | None:
        """Why the machine stopped the run, if it did."""
        return self._moment.alarm

    @property
    def error(self) -> ProgramError | None:
        """What is wrong with the program, if anything is, as far as it has been prepared."""
        return self.channel.error

    def line_check(self) -> LineCheck:
        """Return a check of blocks that would come after what has been prepared."""
        check = self.channel.line_check()
        if self._moment.state is RunState.READY:  # a start begins where the axes are
            check.state.modal.position[:] = self.machine.state.base
        return check

    # ------------------------------------------------------------------ time

    def advance(self, cycles: int, *, until: Until | None = None, asleep: bool = False) -> int:
        """Let up to `cycles` cycles pass; return how many did.

        It returns early when the run stops (a block's end, a program stop, its end, an alarm), and with
        `until` when one of those reasons was met or the condition holds after a cycle. `asleep`: a language that waits
        is not asked meanwhile, since nothing can have come.
        """
        return self._runner.advance(cycles, until=until, asleep=asleep)

    def skip(self) -> int:
        """Follow what is planned in closed form, to the next thing to be done; return the cycles.

        For runs that nobody looks at: servos are ideal, limit switches and the recorder see nothing.
        """
        return self._runner.skip()

    def before_cycles(self, cycles: int) -> int:
        """Make ready for up to `cycles` cycles; return how many may pass before `after_cycles`, 0 for any number.

        What must end `machine.advance` early is put into the clock's mask, beside what is there.
        """
        return self._runner.before_cycles(cycles)

    def after_cycles(self, cycles: int) -> None:
        """Do what the last `cycles` cycles ask for."""
        self._runner.after_cycles(cycles)

    def drain(self) -> None:
        """Hand the recorded rows on and empty the recorder."""
        self._runner.drain()

    def snapshot(self, *, find: FindText = file_text) -> RunSnapshot:
        """Return everything that this run holds, to go back to with `restore`, in a process of any time.

        The machine has a snapshot of its own: take and restore both together. `find` gives the present text of a
        program; the programs that it finds must be the same when the run goes back.

        Raises:
            SnapshotError: a language executes the program, and cannot tell where it is.
        """
        return self._going_back.snapshot(self.program, find)

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
        back = self._going_back.restore_point(snapshot, self.program, find)

        def go_back() -> None:
            self.selection.program = back()

        return go_back

    def _step(self, step: Step) -> None:
        if self._moment.state in OVER:
            self.selection.begin(step)
        elif self._moment.state in STANDING or self._moment.state is RunState.HOLD:
            self._runner.go(step)
        else:
            raise UsageError("the program is running", hint="Hold it, or let it stop at a breakpoint.")
