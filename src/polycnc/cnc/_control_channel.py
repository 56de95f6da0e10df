"""One channel of a control: the program it has selected, its run, and the axes that are lent to manual motion."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.cnc._control_data import AfterManual, Overrides, Switches
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._run_state import RunOptions, RunState
from polycnc.kernel import give_to_point_to_point
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import BlockRecord, Dialect, Event, Library, ProgramText

INTERRUPTED = frozenset(
    {RunState.HOLD, RunState.STOPPED_AT_BLOCK, RunState.PROGRAM_STOP, RunState.OPTIONAL_STOP}
)
"""States in which a program stands and can go on."""


class ControlChannel:
    """Execute programs on one path of a control's machine.

    `program` is what is selected for automatic, `text` what is executed: that or an MDI text. While a program is
    interrupted, the operator may move the axes by hand: they are lent, and must be back before it goes on.
    """

    def __init__(
        self,
        machine: Machine,
        path: int,
        dialect: Dialect,
        manual: ManualMotion,
        *,
        config: MachineConfig,
        library: Library,
        dry_run_mm_min: float,
        on_event: Callable[[ControlChannel, Event], bool],
    ) -> None:
        self.path = path
        self.program: ProgramText | None = None
        self.run: ProgramRun | None = None
        self.is_mdi = False
        self.broken = False  # an alarm has stopped the program: only a reset helps
        self.returning = False  # axes go back to where the program was interrupted
        self._machine = machine
        self._dialect = dialect
        self._manual = manual
        self._config = config
        self._library = library
        self._dry_run_mm_s = dry_run_mm_min / 60.0
        self._on_event = on_event
        self._lent: tuple[float, ...] | None = None
        self._changed = False  # the machine has other limits than the last run knew

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
    def programs(self) -> frozenset[str]:
        """The names of the programs that are being executed, callers and called."""
        if self.run is None or not (self.active or self.interrupted or self.broken):
            return frozenset()
        names = {self.run.program.name}
        if (block := self.run.executed) is not None:
            names |= {block.program, *(call.program for call in block.stack)}
        return frozenset(names)

    # ------------------------------------------------------------------ commands

    def begin(
        self, text: ProgramText, switches: Switches, overrides: Overrides, *, mdi: bool = False
    ) -> None:
        """Begin to execute a text from where the axes stand.

        Raises:
            ControlError: The axes are still braking.
        """
        self._check_rest()
        last = self.run
        self.run = ProgramRun(
            self._machine,
            text,
            self._dialect,
            path=self.path,
            options=RunOptions(
                block_delete=switches.block_delete,
                optional_stop=switches.optional_stop,
                single_block=switches.single_block,
            ),
            config=self._config,
            library=self._library,
            on_event=lambda event: self._on_event(self, event),
            before=last
            if last is not None and last.state is RunState.COMPLETED and not self._changed
            else None,
        )
        self._changed = False
        if last is not None and last.modal is not None:
            # What was prepared and never executed is forgotten with a reset; the tool is still in the spindle.
            self.run.channel.state.tool = last.modal.tool
        self.is_mdi = mdi
        self._lent = None
        self.set_switches(switches)
        self.set_overrides(overrides)
        self.run.start()

    def go_on(self, after_manual: AfterManual) -> None:
        """Let an interrupted program go on; axes that were moved by hand go back first, if the control does that.

        Raises:
            ControlError: Axes are still braking, are moved by hand, or are not where the program was interrupted.
        """
        self._check_rest()
        displaced = self._displaced()
        if not displaced:
            self._take_back()
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
        if self.returning and not self._manual.active:
            self.returning = False
            if not self._displaced():
                self._take_back()

    def hold(self) -> None:
        """Hold the program, or the return of axes."""
        if self.returning:
            self.returning = False
            self._manual.stop_all()
        elif self.run is not None:
            self.run.hold()

    def reset(self) -> None:
        """Break off whatever is being executed; the axes brake on the path."""
        self.returning = False
        self.broken = False
        if self.run is not None:
            self.run.reset()
            self._lent = None

    def fail(self) -> None:
        """Stop because of an alarm; only a reset helps."""
        if self.returning or self.interrupted or self.active:
            self.hold()
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
        self._check_rest()
        state = self._machine.state
        for axis in range(len(state.base)):
            if state.owner[axis] == self.path:
                give_to_point_to_point(state, axis)
        if self.interrupted or self.broken:
            self._lent = tuple(map(float, state.base))

    # ------------------------------------------------------------------ settings

    def change_config(self, config: MachineConfig, dialect: Dialect) -> None:
        """Let programs that begin from now on keep other limits, and be read in this dialect."""
        self._config, self._dialect = config, dialect
        self._changed = True

    def set_switches(self, switches: Switches) -> None:
        """Take over what the operator has switched on."""
        if self.run is not None:
            self.run.single_block = switches.single_block
            self.run.optional_stop = switches.optional_stop
            self._machine.state.paths.row[self.path]["dry_feed"] = (
                self._dry_run_mm_s if switches.dry_run else 0.0
            )
            self.run.feed.replan()

    def set_overrides(self, overrides: Overrides) -> None:
        """Take over the overrides."""
        if self.run is not None:
            self._machine.state.paths.row[self.path]["rapid_override"] = overrides.rapid
            self.run.feed_override = overrides.feed

    # ------------------------------------------------------------------ lent axes

    def _check_rest(self) -> None:
        if not self.at_rest:
            raise ControlError(Refusal.RUNNING, "the axes are still braking", hint="Wait until they stand.")

    def _displaced(self) -> dict[str, float]:
        """Return where the axes that are elsewhere were when the program was interrupted."""
        if self._lent is None:
            return {}
        names = self._machine.config.axis_names
        base = self._machine.state.base
        return {
            name: there for name, there, here in zip(names, self._lent, base, strict=True) if here != there
        }

    def _take_back(self) -> None:
        """Take lent axes back, which are where they were, and go on."""
        if self._lent is not None:
            self._machine.state.owner[:] = self.path
            self._lent = None
        assert self.run is not None
        self.run.resume()
