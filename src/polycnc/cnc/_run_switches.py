"""The switches of a program run: what an operator sets for it, also while it runs."""

from __future__ import annotations

from collections.abc import Iterable

from polycnc.cnc._channel_axes import give_axes
from polycnc.cnc._path_runner import PathRunner
from polycnc.cnc._run_state import GOING, OVER
from polycnc.cnc._stops import Breakpoint
from polycnc.errors import UsageError


class RunSwitches:
    """What is switched on for the program of a path."""

    def __init__(self, runner: PathRunner) -> None:
        self._runner = runner
        self._moment = runner.moment

    @property
    def single_block(self) -> bool:
        """Whether the program stops at the end of every block."""
        return self._moment.single_block

    @single_block.setter
    def single_block(self, on: bool) -> None:
        if on == self._moment.single_block:
            return
        self._moment.single_block = on
        self._runner.stopper.step = self._runner.step_of_switch
        self._runner.take_switch()
        self._look_again()

    @property
    def breakpoints(self) -> frozenset[Breakpoint]:
        """Where the program stops besides."""
        return self._runner.stopper.breakpoints

    @breakpoints.setter
    def breakpoints(self, breakpoints: Iterable[Breakpoint]) -> None:
        self._runner.stopper.breakpoints = frozenset(breakpoints)
        self._look_again()

    @property
    def block_delete(self) -> frozenset[int]:
        """The numbers of the skip marks whose blocks are left out, among the blocks prepared from now on."""
        return self._moment.block_delete

    @block_delete.setter
    def block_delete(self, levels: Iterable[int]) -> None:
        self._moment.block_delete = self._runner.channel.skip_levels = frozenset(levels)

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
        if not self._runner.reading.at_rest:
            raise UsageError("the machine lock cannot change while the axes move", hint="Hold first.")
        if not on and self._moment.state not in OVER:
            raise UsageError(
                "the machine lock cannot be taken off within a program",
                hint="End or reset the program first.",
            )
        self._moment.locked = on
        give_axes(self._runner.machine, self._runner.path, locked=on)

    def _look_again(self) -> None:
        if self._moment.state in GOING:
            self._runner.feed.look_again()
