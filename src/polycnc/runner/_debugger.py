"""A program under a debugger: run, hold, go block by block, stop at lines, and look at what is executed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from polycnc.cnc import Breakpoint, Control, ControlData, ControlEvent, RunState, Status, Step
from polycnc.errors import UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText, dialect_for
from polycnc.runner._program_control import root_of, statements_for
from polycnc.runner._settings import RunSettings


@dataclass(frozen=True, slots=True)
class Place:
    """A line of a program, from 1."""

    program: str
    line: int


class Debugger:
    """Execute one program on a control of its own, and stop it where one wants to look.

    At a breakpoint it stands before the block of that line; its path stays the same. M0 stops it, and M1 does with
    `optional_stop`.

    Raises:
        UsageError: There is no such machine or dialect.
    """

    def __init__(
        self,
        program: ProgramText,
        machine: str | Path | MachineConfig | None = None,
        dialect: str | Dialect | None = None,
        *,
        optional_stop: bool = True,
        root: str | Path | None = None,
    ) -> None:
        self.program = program
        chosen = dialect_for(program, dialect)
        self._root = root_of(program, root)
        config = RunSettings(machine, chosen).machine_of(program)
        self._statements = statements_for(chosen, program, config, self._root)
        self.control = (
            Control(config, dialect=chosen, data=ControlData(count_parts=False))
            if self._statements is None
            else self._statements.control
        )
        self._step = Step.RUN
        self._depth = 0
        if self._statements is not None:
            self._statements.stand_at(self._stands)
        self.control.set_switches(optional_stop=optional_stop)
        self.control.select_program(program)
        self._breakpoints: set[Place] = set()
        self._texts = {program.name: program}

    def _stands(self, file: str, line: int, depth: int) -> bool:
        """Tell whether the program is to stop before a statement: by a breakpoint, or by a step."""
        channel = self.control.channels[0]
        if channel.run is not None and channel.run.channel.state.compensation.active:
            return False  # a stop would change the path
        if Place(file, line) in self._breakpoints or self._step is Step.INTO:
            return True
        return self._step is not Step.RUN and depth < self._depth + (self._step is Step.OVER)

    # ------------------------------------------------------------------ what it shows

    @property
    def status(self) -> Status:
        """The status of the control."""
        return self.control.status()

    @property
    def breakpoints(self) -> frozenset[Place]:
        """Where the program stops."""
        return frozenset(self._breakpoints)

    @property
    def running(self) -> bool:
        """Whether the program is being executed."""
        return self.control.channels[0].active

    @property
    def executed(self) -> Place | None:
        """The block that is executed, or was last; None before the first."""
        block = self.control.channels[0].executed
        return None if block is None else Place(block.program, block.line)

    @property
    def next(self) -> Place | None:
        """The block that a start would go on with, where the program stands between two blocks; else None."""
        channel = self.control.channels[0]
        block = None if channel.run_state is RunState.COMPLETED else channel.next_block
        return None if block is None else Place(block.program, block.line)

    def text(self, program: str) -> ProgramText:
        """Return the text of a program that has been executed.

        Raises:
            UsageError: It cannot be read any more.
        """
        if program not in self._texts:
            beside = self._root / program
            self._texts[program] = ProgramText.from_path(beside if beside.is_file() else program)
        return self._texts[program]

    def variables(self) -> dict[str, object]:
        """Return the variables of a program with statements, those of the sub-program that runs first; none else."""
        return {} if self._statements is None else self._statements.variables()

    # ------------------------------------------------------------------ commands

    def run(self) -> None:
        """Begin the program, or go on, to the next breakpoint or stop; without effect while it runs.

        Raises:
            ControlError: The control refuses the start.
        """
        self._go(Step.RUN)

    def step(self, step: Step = Step.INTO) -> None:
        """Execute one block, `Step.OVER` with the sub-program that it calls, `Step.OUT` to the end of this one.

        Without effect while the program runs.

        Raises:
            ControlError: The control refuses the start.
        """
        self._go(step)

    def _go(self, step: Step) -> None:
        if self.running:
            return
        begins = not self.control.channels[0].interrupted
        self._step = step
        if self._statements is not None:
            self._depth = self._statements.depth
        self.control.cycle_start(step=step)
        if begins and step is Step.RUN and self.next in self._breakpoints:
            self.control.feed_hold()  # nothing has moved yet

    def hold(self) -> None:
        """Brake and stand; without effect where nothing is executed."""
        if self.running:
            self.control.feed_hold()

    def reset(self) -> None:
        """Break the program off; a start begins it anew."""
        self.control.reset()

    def toggle_breakpoint(self, place: Place) -> bool:
        """Set a breakpoint, or take it away; return whether it is set now.

        Raises:
            UsageError: The program has no such line.
        """
        lines = self.text(place.program).content.count(b"\n") + 1
        if not 1 <= place.line <= lines:
            raise UsageError(f"{place.program} has no line {place.line}", hint=f"It has {lines} lines.")
        self._breakpoints ^= {place}
        self.control.channels[0].set_breakpoints(
            frozenset(Breakpoint(each.program, each.line) for each in self._breakpoints)
        )
        return place in self._breakpoints

    def change_feed_override(self, change: float) -> float:
        """Change the feed override, within 0 to 2; return it."""
        most = self.control.data.most_feed_override
        override = round(min(max(self.control.overrides.feed + change, 0.0), most), 3)
        self.control.set_overrides(feed=override)
        return override

    def pass_time(self, cycles: int) -> int:
        """Let control cycles pass; return how many did, fewer where the program has stop."""
        done = 0
        while done < cycles and self.running:
            moved = self.control.advance(cycles - done, until=ControlEvent.RUN_STATE)
            done += moved
            if moved == 0:
                break
        return done
