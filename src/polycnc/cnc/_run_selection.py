"""Select the program of a run, and the block in it with which it begins."""

from __future__ import annotations

import re

from polycnc import kernel
from polycnc.cnc._channel_axes import give_axes
from polycnc.cnc._path_runner import PathRunner
from polycnc.cnc._run_channels import RunChannels
from polycnc.cnc._run_reading import RunReading
from polycnc.cnc._run_state import OVER, RunState
from polycnc.cnc._stops import Step
from polycnc.errors import UsageError
from polycnc.kernel import drop_queue, give_to_path
from polycnc.machine import Machine
from polycnc.nc import Channel, ModalWords, ProgramText


class RunSelection:
    """Hold the program that a path executes; another one, and each beginning anew, gets a channel of its own."""

    def __init__(
        self, runner: PathRunner, channels: RunChannels, reading: RunReading, program: ProgramText
    ) -> None:
        self._runner = runner
        self._moment = runner.moment
        self._channels = channels
        self._reading = reading
        self.program = program

    def load(self, program: ProgramText, *, keeps_modal: bool = False) -> None:
        """Select another program; with `keeps_modal` it begins with the modal state that is in force.

        Raises:
            UsageError: a program is being executed, or there is an alarm.
        """
        self._check_over()
        keeps = keeps_modal and self._moment.state is not RunState.RESET
        self._renew(program, keeps_modal=keeps)
        self.program = program
        self._moment.state = RunState.READY

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
        self._renew(self.program, keeps_modal=False)
        moment, channel = self._moment, self._runner.channel
        moment.state = RunState.READY
        channel.bound(target, last)
        if not calculate:
            channel.go_to(target)
            return target
        try:
            calculate_to(self._runner.machine, channel, target)
        except UsageError:
            self._renew(self.program, keeps_modal=False)
            raise
        moment.searched = tuple(channel.state.modal.position.tolist())
        moment.approach = (moment.searched, target)
        return target

    @property
    def searched(self) -> tuple[float, ...] | None:
        """Where the calculated search of a block has come to (machine coordinates, mm or degree), None if none was."""
        channel = self._runner.channel
        return tuple(channel.state.modal.position.tolist()) if channel.seeking else self._moment.searched

    def opening_words(self) -> ModalWords:
        """Return the modal words with which the program begins anew."""
        runner = self._runner
        levels = self._moment.block_delete
        channel = self._channels.make(
            self.program, levels, before=runner.channel, keeps_modal=False, attaches=False
        )
        channel.state.tool = runner.channel.state.tool
        return channel.records.words(self.program, channel.state.snapshot())

    def begin(self, step: Step) -> None:
        """Begin the program from where the axes stand, and go as far as `step` says.

        Raises:
            UsageError: the axes are still moving, or there is an alarm.
        """
        self.check_start()
        runner, moment = self._runner, self._moment
        state, path = runner.machine.state, runner.path
        if moment.state is not RunState.READY:
            self._renew(self.program, keeps_modal=False)
        kernel.give_to_path(state, path)
        give_axes(runner.machine, path, locked=moment.locked)
        runner.channel.state.modal.position[:] = state.paths.position[path]
        kernel.start_path(state.paths, path)
        moment.hold = moment.held_back = False
        runner.row["limit"] = kernel.NO_LIMIT
        runner.row["tag"] = runner.row["blocks"] = 0
        if moment.approach is not None:
            runner.channel.begin_at(*moment.approach)
            moment.approach = None
        runner.go(step)

    def check_start(self) -> None:
        """Refuse a start while axes brake, and in an alarm.

        Raises:
            UsageError: They do, or there is one.
        """
        if self._moment.state is RunState.ALARM:
            raise UsageError("there is an alarm", hint="Reset it first.")
        if self._moment.dropping:
            raise UsageError("the axes are still braking", hint="Let time pass until `at_rest`.")

    def _check_over(self) -> None:
        """Refuse what would change the program while it is executed."""
        if self._moment.state not in OVER:
            raise UsageError(f"the program is {self._moment.state.value}", hint="Reset it, or let it end.")
        self.check_start()

    def _renew(self, program: ProgramText, *, keeps_modal: bool) -> None:
        """Read a program from its beginning."""
        runner, moment = self._runner, self._moment
        modal = self._reading.modal
        tool = runner.channel.state.tool if modal is None else modal.tool  # prepared is not changed
        channel = self._channels.make(
            program, moment.block_delete, before=runner.channel, keeps_modal=keeps_modal
        )
        channel.state.tool = tool
        runner.channel = channel
        moment.met = moment.approach = moment.searched = None  # of the program before
        runner.feed.clear()


_SEQUENCE = rb"(?:\A|(?<=[\r\n]))[ \t]*(?:/[1-9]?)?[ \t]*[Nn][ \t]*0*%d(?![0-9.])"


def block_line(program: ProgramText, line: int, sequence: int | None) -> int:
    """Return the line of the block on `line`, or of the first one with a sequence number if that is given.

    Raises:
        UsageError: the program has no such line or block.
    """
    if sequence is None:
        lines = len(program.content.splitlines())
        if not 1 <= line <= lines:
            raise UsageError(f"{program.name} has no line {line}", hint=f"Its lines are 1 to {lines}.")
        return line
    match = re.search(_SEQUENCE % sequence, program.content) if sequence >= 0 else None
    if match is None:
        raise UsageError(
            f"{program.name} has no block N{sequence}", hint="Give the number of a block in the main program."
        )
    return program.position(match.start()).line


def calculate_to(machine: Machine, channel: Channel, line: int) -> None:
    """Carry out what stands before `line` without moving; the channel's position is where that block begins.

    Raises:
        UsageError: the program ends before, or cannot be calculated.
    """
    state, path = machine.state, channel.path
    row = state.paths.row[path]

    def skip_queue() -> None:
        for name in ("head", "prepared", "planned"):
            row[name] = row["tail"]

    give_to_path(state, path)
    channel.state.modal.position[:] = state.paths.position[path]
    try:
        if not channel.calculate_to(line, skip_queue):
            hint = "Search a block that is executed." if channel.error is None else str(channel.error)
            raise UsageError(f"the program ends before line {line}", hint=hint)
    finally:
        drop_queue(state.seg, state.paths, path)
