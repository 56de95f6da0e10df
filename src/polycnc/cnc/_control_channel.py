"""One channel of a control: the program it has selected, its run, and the axes that are lent to manual motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from polycnc.cnc._block_search import block_line
from polycnc.cnc._control_data import AfterManual, ChannelData, Mode, Overrides, Search, Switches
from polycnc.cnc._control_snapshot import ChannelMoment, KeptText
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._run_snapshot import FindText
from polycnc.cnc._run_state import RunOptions, RunState
from polycnc.cnc._stops import Breakpoint, Step
from polycnc.errors import UsageError
from polycnc.kernel import OTHER_SOURCE, READY, give_to_point_to_point
from polycnc.machine import Machine, MachineConfig, Snapshot
from polycnc.nc import (
    BlockRecord,
    Dialect,
    Event,
    Language,
    Library,
    ProgramText,
    of_another_channel,
)

INTERRUPTED = frozenset(
    {RunState.HOLD, RunState.STOPPED_AT_BLOCK, RunState.PROGRAM_STOP, RunState.OPTIONAL_STOP}
)
"""States in which a program stands and can go on."""


class ControlChannel:
    """Execute programs on one path of a control's machine, with the axes that it owns.

    `program` is what is selected for automatic, `text` what is executed: that or an MDI text. While a program is
    interrupted, the operator may move the axes by hand: they are lent, and must be back before it goes on.
    """

    def __init__(
        self,
        machine: Machine,
        path: int,
        data: ChannelData,
        dialect: Dialect,
        manual: ManualMotion,
        *,
        config: MachineConfig,
        library: Library,
        dry_run_mm_min: float,
        on_event: Callable[[ControlChannel, Event], bool],
        language: Language | None = None,
    ) -> None:
        self.path = path
        self.language = language
        self.skip_signal = False
        self.on_skip: Callable[[], None] | None = None
        self.data = data
        names = machine.config.axis_names
        self.axes = tuple(name for name in names if name in data.axes)
        """The names of its axes, in the order of the machine."""
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
        self._dialect = dialect
        self._manual = manual
        self._file = config
        self.config = self._own(config)
        self.names: Sequence[str] | None = None
        """Names of the machine's axes for programs, see `of_another_channel`; None: as the machine has them."""
        self._library = library
        self._dry_run_mm_s = dry_run_mm_min / 60.0
        self._on_event = on_event
        self._lent: tuple[tuple[int, float], ...] | None = None  # axes and where they were
        self._changed = False  # the machine has other limits than the run knows
        machine.state.paths.axis[path, [name not in data.axes for name in config.axis_names]] = -1
        machine.state.paths.position[path] = machine.state.base
        machine.state.paths.queued[path] = machine.state.base

    def _own(self, config: MachineConfig) -> MachineConfig:
        """Return the machine file as the programs of this channel see it: no word reaches the axes of others."""
        axes = tuple(
            axis
            if axis.name in self.data.axes
            else axis.model_copy(update={"name": of_another_channel(axis.name)})
            for axis in config.axes
        )
        return config.model_copy(update={"axes": axes})

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
        return None if self.run is None else self.run.executed

    @property
    def next_block(self) -> BlockRecord | None:
        """The block that comes next where the path stands between two blocks; None where none is known."""
        run = self.run
        row = self._machine.state.paths.row[self.path]
        if run is None or row["state"] != READY:
            return None
        tag = run.feed.next_tag()
        return None if tag is None else run.channel.records.block(tag)

    @property
    def programs(self) -> frozenset[str]:
        """The names of the programs that are being executed, callers and called."""
        if self.run is None or not (self.active or self.interrupted or self.broken):
            return frozenset()
        names = {self.run.program.name}
        if (block := self.run.executed) is not None:
            names |= {block.program, *(call.program for call in block.stack)}
        return frozenset(names)

    # ------------------------------------------------------------------ commands

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
        with self._whole_or_nothing():
            self._load(text, mdi=False)
            self.set_switches(self.switches)  # statements may ask for them
            line = self._find(search)
        self.search = search
        self._clock.changes += 1
        return line

    @contextmanager
    def _whole_or_nothing(self) -> Iterator[None]:
        """Let a refusal within leave run and path as they were."""
        state = self._machine.state
        arrays = (state.owner, *(each[self.path] for each in (state.paths.position, state.paths.queued)))
        kept = [each.copy() for each in arrays]
        row, run = state.paths.row[self.path : self.path + 1], self.run
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
            self.run = run
            raise

    def _find(self, search: Search) -> int:
        assert self.run is not None
        try:
            return self.run.search(line=search.line, sequence=search.sequence, calculate=search.calculate)
        except UsageError as error:
            raise ControlError(Refusal.NOT_FOUND, error.what, hint=error.hint) from error

    def begin(self, text: ProgramText, *, mdi: bool, step: Step, search: Search | None) -> None:
        """Begin to execute a text, from where the axes stand.

        Raises:
            ControlError: The axes are still braking, or the program cannot begin at the block that is wanted.
        """
        self.check_rest()
        if not self._has_found(text, search):
            self._load(text, mdi=mdi)
            if search is not None:
                self._find(search)
        assert self.run is not None
        self.search = None
        self.is_mdi = mdi
        self._lent = None
        self.set_switches(self.switches)
        self.set_overrides(self.overrides)
        self.run.breakpoints = self.breakpoints
        self.run.skip_signal = self.skip_signal
        self.run.on_skip = self.on_skip
        self._go(step)

    def _has_found(self, text: ProgramText, search: Search | None) -> bool:
        """Tell whether the run stands before the block of a search; its statements are not executed a second time."""
        run = self.run
        if run is None or self._changed or search is None or search != self.search:
            return False
        return run.program is text and run.state is RunState.READY and run.channel.holds_searched

    def _load(self, text: ProgramText, *, mdi: bool) -> None:
        if self.run is None or self._changed:
            self._changed = False
            self.run = self._new_run(text)
        else:
            self.run.load(text, keeps_modal=mdi)

    def _new_run(self, text: ProgramText, *, attaches: bool = True) -> ProgramRun:
        return ProgramRun(
            self._machine,
            text,
            self._dialect,
            path=self.path,
            options=RunOptions(answers=True, dry_run_mm_s=self._dry_run_mm_s),
            config=self.config,
            library=self._library,
            language=self.language,
            axes=self.names,
            on_event=lambda event: self._on_event(self, event),
            attaches=attaches,
        )

    def go_on(self, after_manual: AfterManual, step: Step) -> None:
        """Let an interrupted program go on; axes that were moved by hand go back first, if the control does that.

        Raises:
            ControlError: Axes are still braking, are moved by hand, or are not where the program was interrupted.
        """
        self.check_rest()
        self._clock.changes += 1
        displaced = self._displaced()
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
            if not self._displaced():
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
            self._lent = None

    def fail(self) -> None:
        """Stop because of an alarm; only a reset helps."""
        if self.returning or self.interrupted or self.active:
            self.hold(at_once=True)
            self.broken = True

    def lend(self) -> None:
        """Give the axes to manual motion.

        Raises:
            ControlError: A program is being executed, or the axes are still braking.
        """
        if self._lent is not None:
            return
        if self.active:
            raise ControlError(
                Refusal.RUNNING, "a program is being executed", hint="Hold it, or wait for its end."
            )
        self.check_rest()
        state = self._machine.state
        taken = []
        for axis in self._indexes():
            if state.owner[axis] in (self.path, OTHER_SOURCE):
                give_to_point_to_point(state, axis)
                taken.append((axis, float(state.base[axis])))
        if self.interrupted or self.broken:
            self._lent = tuple(taken)

    # ------------------------------------------------------------------ settings

    def set_skip_signal(self, on: bool) -> None:
        """Give the signal that ends skip moves, or take it away."""
        self.skip_signal = on
        if self.run is not None:
            self.run.skip_signal = on

    def set_breakpoints(self, breakpoints: frozenset[Breakpoint]) -> None:
        """Set where the program stops besides."""
        self.breakpoints = breakpoints
        if self.run is not None:
            self.run.breakpoints = breakpoints

    def change_config(self, config: MachineConfig, dialect: Dialect) -> None:
        """Let programs that begin from now on keep other limits, and be read in this dialect."""
        self._file, self._dialect = config, dialect
        self.config = self._own(config)
        self._changed = True
        self._clock.changes += 1

    def share(self, axes: tuple[str, ...]) -> None:
        """Have these axes from now on; no program is being executed."""
        state, names = self._machine.state, self._machine.config.axis_names
        self.data = replace(self.data, axes=axes)
        self.axes = tuple(name for name in names if name in axes)
        for index, name in enumerate(names):
            if name not in axes and state.owner[index] == self.path:
                give_to_point_to_point(state, index)
            state.paths.axis[self.path, index] = index if name in axes else -1
        state.paths.position[self.path] = state.base
        state.paths.queued[self.path] = state.base
        self.change_config(self._file, self._dialect)

    def set_switches(self, switches: Switches) -> None:
        """Take over what the operator has switched on."""
        self.switches = switches
        self._clock.changes += 1
        if self.run is not None:
            self.run.single_block = switches.single_block
            self.run.optional_stop = switches.optional_stop
            self.run.dry_run = switches.dry_run
            self.run.machine_lock = switches.machine_lock
            self.run.block_delete = switches.block_delete

    def set_overrides(self, overrides: Overrides) -> None:
        """Take over the overrides."""
        self.overrides = overrides
        self._clock.changes += 1
        if self.run is not None:
            self.run.feed_override = overrides.feed
            self.run.rapid_override = overrides.rapid

    # ------------------------------------------------------------------ state

    def moment(self, waiting: Sequence[int]) -> ChannelMoment:
        """Return what the channel holds beside its run."""
        return ChannelMoment(
            mode=self.mode,
            overrides=self.overrides,
            switches=self.switches,
            program=_kept(self.program),
            mdi=_kept(self.mdi),
            search=self.search,
            is_mdi=self.is_mdi,
            broken=self.broken,
            returning=self.returning,
            lent=self._lent,
            waiting=tuple(waiting),
        )

    def way_back(self, run: Snapshot | None, find: FindText) -> Callable[[], ProgramRun | None]:
        """Return what makes a run that goes back to a snapshot, when it is certain that it can be done.

        Raises:
            SnapshotError: It cannot.
        """
        if run is None:
            return lambda: None
        made = self._new_run(ProgramText("", b""), attaches=False)
        back = made.way_back(run, find=find)

        def go_back() -> ProgramRun:
            back()
            return made

        return go_back

    def put_back(self, moment: ChannelMoment, run: ProgramRun | None) -> None:
        """Go back to a moment, with a run that nobody else has."""
        self._clock.changes += 1
        self.mode = moment.mode
        self.overrides = moment.overrides
        self.switches = moment.switches
        self.program = _text(moment.program)
        self.mdi = _text(moment.mdi)
        self.search = moment.search
        self.is_mdi = moment.is_mdi
        self.broken = moment.broken
        self.returning = moment.returning
        self._lent = moment.lent
        self.run = run
        if run is not None:
            self._changed = False
            run.on_skip = self.on_skip
            run.stopper.breakpoints = self.breakpoints

    # ------------------------------------------------------------------ lent axes

    def check_rest(self) -> None:
        """Refuse while the axes brake.

        Raises:
            ControlError: They do.
        """
        if not self.at_rest:
            raise ControlError(Refusal.RUNNING, "the axes are still braking", hint="Wait until they stand.")

    def _indexes(self) -> tuple[int, ...]:
        return tuple(axis for axis in self._machine.state.paths.axis[self.path].tolist() if axis >= 0)

    def _displaced(self) -> dict[str, float]:
        """Return where the axes that are elsewhere were when the program was interrupted."""
        if self._lent is None:
            return {}
        names = self._machine.config.axis_names
        base = self._machine.state.base
        return {names[axis]: there for axis, there in self._lent if base[axis] != there}

    def _take_back(self, step: Step) -> None:
        """Take lent axes back, which are where they were, and go on."""
        for axis, _ in self._lent or ():
            locked = self.run is not None and self.run.machine_lock
            self._machine.state.owner[axis] = OTHER_SOURCE if locked else self.path
        self._lent = None
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


def _kept(text: ProgramText | None) -> KeptText | None:
    return None if text is None else KeptText(text.name, text.content.decode("latin-1"))


def _text(kept: KeptText | None) -> ProgramText | None:
    return None if kept is None else ProgramText(kept.name, kept.content.encode("latin-1"))
