"""One channel of a control: the program it has selected, its run, and the axes that are lent to manual motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from polycnc.cnc._channel_axes import ChannelAxes
from polycnc.cnc._control_data import AfterManual, ChannelData, Mode, Overrides, Search, Switches
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._run_making import RunMaker
from polycnc.cnc._run_selection import block_line
from polycnc.cnc._run_state import INTERRUPTED, RunState
from polycnc.cnc._stops import Breakpoint, Step
from polycnc.errors import UsageError
from polycnc.kernel import READY
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import BlockRecord, Dialect, IncomingText, ProgramText


class ControlChannel:
    """Execute programs on one path of a control's machine, with the axes that it owns.

    `program` is what is selected for automatic, `text` what is executed: that or an MDI text. While a program is
    interrupted, the operator may move the axes by hand: they are lent, and must be back before it goes on.
    """

    def __init__(
        self, machine: Machine, path: int, data: ChannelData, manual: ManualMotion, runs: RunMaker
    ) -> None:
        self.path = path
        self.skip_signal = False
        self.on_skip: Callable[[], None] | None = None
        self.data = data
        self.mode = Mode.AUTO
        self.overrides = Overrides()
        self.switches = Switches()
        self.search: Search | None = None  # where the selected program begins
        self.program: ProgramText | None = None
        self.mdi: ProgramText | None = None
        self.run: ProgramRun | None = None
        self.breakpoints: frozenset[Breakpoint] = frozenset()
        self.is_mdi = False
        self.broken = False  # an alarm has stopped the program: only a reset helps
        self.returning = False  # axes go back to where the program was interrupted
        self._machine = machine
        self._clock = machine.clock
        self._manual = manual
        self.runs = runs
        self.own_axes = ChannelAxes(machine, path, data.axes)
        self.axes = self.own_axes.names

    # ------------------------------------------------------------------ what it does

    @property
    def run_state(self) -> RunState:
        """What the channel is doing."""
        if self.broken:
            return RunState.ALARM
        return RunState.READY if self.run is None else self.run.state

    @property
    def active(self) -> bool:
        """Whether a program is being executed, or about to when axes have returned."""
        return self.returning or self.run_state is RunState.ACTIVE

    @property
    def interrupted(self) -> bool:
        """Whether a program stands and could go on."""
        return not self.broken and self.run_state in INTERRUPTED

    @property
    def at_rest(self) -> bool:
        """Whether the path stands."""
        return self.run is None or self.run.at_rest

    @property
    def executed(self) -> BlockRecord | None:
        """The block that is executed, or was last."""
        return None if self.run is None else self.run.reading.block

    @property
    def next_block(self) -> BlockRecord | None:
        """The block that comes next where the path stands between two blocks; None where none is known."""
        return None if self.run is None else next_block(self._machine, self.run)

    @property
    def programs(self) -> frozenset[str]:
        """The names of the programs that are being executed, callers and called."""
        if self.run is None or not (self.active or self.interrupted or self.broken):
            return frozenset()
        return frozenset({self.run.program.name, *self.run.reading.programs})

    @property
    def prepared(self) -> BlockRecord | None:
        """The block that was prepared last of those whose motion is queued; the executed one where none is."""
        return None if self.run is None else prepared_block(self._machine, self.run)

    # ------------------------------------------------------------------ commands

    def select(self, text: ProgramText | None) -> None:
        """Take a text as the program of the next start in automatic, from its beginning; None: none."""
        self.program = text
        self.search = None
        self._clock.changes += 1

    def seek(self, text: ProgramText, search: Search) -> int:
        """Make the selected program ready to begin at a block; return its line.

        Raises:
            ControlError: The axes are still braking, there is no such block, or the program cannot begin there.
        """
        self.check_rest()
        try:
            block_line(text, search.line, search.sequence)
        except UsageError as error:
            raise ControlError(Refusal.NOT_FOUND, error.what, hint=error.hint) from error
        run = self.run
        try:
            with unless_refused(self._machine, self.path, run):
                loaded = self.load(text, mdi=False)
                self.set_switches(self.switches)  # statements may ask for them
                line = find_block(loaded, search)
        except ControlError:
            self.run = run
            raise
        self.search = search
        self._clock.changes += 1
        return line

    def begin(self, text: ProgramText, *, mdi: bool, step: Step, search: Search | None) -> None:
        """Begin to execute a text, from where the axes stand.

        Raises:
            ControlError: The axes are still braking, or the program cannot begin at the block that is wanted.
        """
        self.check_rest()
        if not self._has_found(text, search):
            loaded = self.load(text, mdi=mdi)
            if search is not None:
                find_block(loaded, search)
        assert self.run is not None
        self.search = None
        self.is_mdi = mdi
        self.own_axes.taken = None
        self.set_switches(self.switches)
        self.set_overrides(self.overrides)
        self.run.switches.breakpoints = self.breakpoints
        self.run.switches.skip_signal = self.skip_signal
        self.run.events.on_skip = self.on_skip
        self._go(step)

    def _has_found(self, text: ProgramText, search: Search | None) -> bool:
        """Tell whether the run is where a start begins: statements before a block are not executed a second time."""
        is_sought = search is not None and search == self.search
        return self.run is not None and not self.runs.stale and stands_ready(self.run, text, is_sought)

    def load(self, text: ProgramText, *, mdi: bool) -> ProgramRun:
        """Make a run ready to begin a text, where the axes rest."""
        if self.run is None or self.runs.stale:
            self.runs.stale = False
            self.run = self.runs.make(text)
        else:
            self.run.selection.load(text, keeps_modal=mdi)
        return self.run

    def go_on(self, after_manual: AfterManual, step: Step) -> None:
        """Let an interrupted program go on; axes that were moved by hand go back first, if the control does that.

        Raises:
            ControlError: Axes are still braking, are moved by hand, or are not where the program was interrupted.
        """
        self.check_rest()
        self._clock.changes += 1
        displaced = self.own_axes.displaced()
        if not displaced:
            self._take_back(step)
            return
        if after_manual is AfterManual.REFUSE:
            raise ControlError(
                Refusal.DISPLACED,
                f"axis {', '.join(displaced)} is not where the program was interrupted",
                hint="Move it back by hand, or reset the program.",
            )
        for axis, position in displaced.items():
            self._manual.go_to(axis, position)
        self.returning = True

    def look(self) -> None:
        """Go on once the axes are back where the program was interrupted."""
        if self.returning and not self._manual.moves(self.axes):
            self.returning = False
            if not self.own_axes.displaced():
                self._take_back(Step.RUN)

    def hold(self, *, at_once: bool = False) -> None:
        """Hold the program, or the return of axes; `at_once` even where the program suppresses it."""
        self._clock.changes += 1
        if self.returning:
            self.returning = False
            self._manual.stop_all(self.axes)
        elif self.run is not None:
            self.run.hold(at_once=at_once)

    def reset(self) -> None:
        """Break off whatever is being executed; the axes brake on the path."""
        self._clock.changes += 1
        self.returning = False
        self.broken = False
        self.search = None
        if self.run is not None:
            self.run.reset()
            self.own_axes.taken = None

    def fail(self) -> None:
        """Stop because of an alarm; only a reset helps."""
        if self.returning or self.interrupted or self.active:
            self.hold(at_once=True)
            self.broken = True

    def release(self) -> None:
        """Give the axes to manual motion.

        Raises:
            ControlError: A program is being executed, or the axes are still braking.
        """
        if self.own_axes.taken is not None:
            return
        if self.active:
            raise ControlError(
                Refusal.RUNNING, "a program is being executed", hint="Hold it, or wait for its end."
            )
        self.check_rest()
        self.own_axes.release(come_back=self.interrupted or self.broken)

    # ------------------------------------------------------------------ settings

    def set_skip_signal(self, on: bool) -> None:
        """Give the signal that ends skip moves, or take it away."""
        self.skip_signal = on
        if self.run is not None:
            self.run.switches.skip_signal = on

    def set_breakpoints(self, breakpoints: frozenset[Breakpoint]) -> None:
        """Set where the program stops besides."""
        self.breakpoints = breakpoints
        if self.run is not None:
            self.run.switches.breakpoints = breakpoints

    def change_config(self, config: MachineConfig, dialect: Dialect) -> None:
        """Let programs that begin from now on keep other limits, and be read in this dialect."""
        self.runs.change(config, dialect, self.data.axes)
        self._clock.changes += 1

    def share(self, axes: tuple[str, ...]) -> None:
        """Have these axes from now on; no program is being executed."""
        self.data = replace(self.data, axes=axes)
        self.own_axes.share(axes)
        self.axes = self.own_axes.names
        self.runs.share(axes)
        self._clock.changes += 1

    def set_switches(self, switches: Switches) -> None:
        """Take over what the operator has switched on."""
        self.switches = switches
        self._clock.changes += 1
        if self.run is not None:
            own = self.run.switches
            own.single_block, own.optional_stop = switches.single_block, switches.optional_stop
            self.run.overrides.dry_run = switches.dry_run
            own.machine_lock = switches.machine_lock
            own.block_delete = switches.block_delete

    def set_overrides(self, overrides: Overrides) -> None:
        """Take over the overrides."""
        self.overrides = overrides
        self._clock.changes += 1
        if self.run is not None:
            self.run.overrides.feed = overrides.feed
            self.run.overrides.rapid = overrides.rapid

    def check_rest(self) -> None:
        """Refuse while the axes brake.

        Raises:
            ControlError: They do.
        """
        if not self.at_rest:
            raise ControlError(Refusal.RUNNING, "the axes are still braking", hint="Wait until they stop.")

    def _take_back(self, step: Step) -> None:
        """Take lent axes back, which are where they were, and go on."""
        self.own_axes.take_back(locked=self.run is not None and self.run.switches.machine_lock)
        self._go(step)

    def _go(self, step: Step) -> None:
        """Begin or go on, as far as `step` says; a single block goes no farther than one block.

        Raises:
            ControlError: The run cannot.
        """
        assert self.run is not None
        self._clock.changes += 1
        go = {
            Step.RUN: self.run.start,
            Step.INTO: self.run.step_into,
            Step.OVER: self.run.step_over,
            Step.OUT: self.run.step_out,
        }[step]
        try:
            go()
        except UsageError as error:
            raise ControlError(Refusal.RUNNING, error.what, hint=error.hint) from error


def next_block(machine: Machine, run: ProgramRun) -> BlockRecord | None:
    """Return the block that comes next where a path stands between two blocks; None where none is known."""
    if machine.state.paths.row[run.path]["state"] != READY:
        return None
    tag = run.feed.blocks.next_tag()
    return None if tag is None else run.channel.records.block(tag)


def prepared_block(machine: Machine, run: ProgramRun) -> BlockRecord | None:
    """Return the block that was prepared last of those whose motion is queued; the executed one where none is."""
    row = machine.state.paths.row[run.path]
    if row["tail"] <= row["head"]:
        return run.reading.block
    last = int(row["base"]) + (int(row["tail"]) - 1) % int(row["capacity"])
    return run.channel.records.block(int(machine.state.seg.row[last]["tag"])) or run.reading.block


def find_block(run: ProgramRun, search: Search) -> int:
    """Let a run begin at the block of a search; return its line.

    Raises:
        ControlError: There is none, or the program cannot begin there.
    """
    try:
        return run.selection.search(
            line=search.line, sequence=search.sequence, calculate=search.calculate, last=search.last
        )
    except UsageError as error:
        raise ControlError(Refusal.NOT_FOUND, error.what, hint=error.hint) from error


def stands_ready(run: ProgramRun, text: ProgramText, is_sought: bool) -> bool:
    """Tell whether a run has a text, and is before a block that was searched or at the beginning of what comes."""
    if run.program is not text or run.state is not RunState.READY:
        return False
    return isinstance(text, IncomingText) or (is_sought and run.channel.holds_searched)


@contextmanager
def unless_refused(machine: Machine, path: int, run: ProgramRun | None) -> Iterator[None]:
    """Let a refusal within leave a run and its path as they were."""
    state = machine.state
    arrays = (state.owner, *(each[path] for each in (state.paths.position, state.paths.queued)))
    kept = [each.copy() for each in arrays]
    row = state.paths.row[path : path + 1]
    kept_row = row.copy()
    try:
        saved = None if run is None else run.snapshot()
    except UsageError:  # a language has executed it: it stands at its beginning then
        saved = None
    try:
        yield
    except ControlError:
        row[:] = kept_row
        for each, content in zip(arrays, kept, strict=True):
            each[:] = content
        if run is not None and saved is not None:
            run.restore(saved)
        raise
