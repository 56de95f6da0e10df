"""What stands on a path and is met there: auxiliary functions, stops, probing moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

from polycnc import kernel
from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._path_hold import PathHold
from polycnc.cnc._probing import Probing, cannot_begin, delete_rest, positions
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_state import RunOptions, RunState
from polycnc.cnc._stops import Stopper
from polycnc.cnc._tool_times import path_times
from polycnc.machine import Machine
from polycnc.nc import Event, Stop

OnEvent: TypeAlias = Callable[[Event], bool | None]
_STOP_STATES = {Stop.PROGRAM: RunState.PROGRAM_STOP, Stop.OPTIONAL: RunState.OPTIONAL_STOP}


class PathEvents:
    """Meet what stands on the path of `feed`; `on_event` and `on_skip` get what happens, see `ProgramRun`."""

    def __init__(
        self,
        machine: Machine,
        feed: PathFeed,
        stopper: Stopper,
        hold: PathHold,
        moment: RunProgress,
        options: RunOptions,
    ) -> None:
        self._machine = machine
        self._feed = feed
        self._stopper = stopper
        self._hold = hold
        self._moment = moment
        self._options = options
        self.on_event: OnEvent | None = None
        self.on_skip: Callable[[], None] | None = None

    def stands_at(self, stop: Stop) -> bool:
        """Tell whether the program would stand at such a stop now."""
        return self._options.stands_at_stops and (stop is Stop.PROGRAM or self._moment.optional_stop)

    def handle(self) -> None:
        """Do what the event asks for at which the path rests."""
        number = int(self._feed.row["event"])
        event = self._feed.channel.writer.take(number)
        self._moment.met = int(self._feed.row["head"]), event.tag
        self._moment.tool_times.change(
            self._feed.channel.records.tool(event.tag), path_times(self._machine, self._feed.channel.path)
        )
        if event.stop is Stop.REFUSED:
            if self.on_event is not None:
                self.on_event(event)
            return
        if event.word and self.on_event is not None:
            self._moment.unanswered = bool(self.on_event(event)) and not self._moment.suppressed.answers
            self._hold.apply()
        if event.barrier:
            self._moment.barrier = True
            self._pass_barrier()
        if event.stop in (Stop.PROBE, Stop.PROBE_IN_PASSING):
            self._moment.probing = Probing(event.stop is Stop.PROBE, positions(self._machine))
            if cannot_begin(self._machine, self._feed.channel):
                self._moment.probing.met = True  # what is left of the move is dropped
                self._tell_probe(at_once=True)
                self._hold.apply()
        elif event.stop is Stop.DRAIN:
            if self._moment.probing is not None:
                if not self._moment.probing.met:
                    self._tell_probe(missed=True)
                self._moment.probing = None
                self._feed.keep_box()
                self._hold.apply()
            if self._stopper.alone:
                self._feed.let_pass()  # what is read after it belongs to it
            self._go_on()
        elif event.stop is not None and self.stands_at(event.stop):
            self._moment.stop = event
            self._moment.state = _STOP_STATES[event.stop]
            self._hold.apply()
        elif event.stop is not None and self._options.stands_at_stops:
            self._go_on()

    def _tell_probe(self, *, missed: bool = False, at_once: bool = False) -> None:
        """Note in the channel's state how a probing move went wrong, where the program asks for it."""
        state = self._feed.channel.state
        if state.probe is not None and state.probe.code:
            state.probe = replace(state.probe, missed=missed, at_once=at_once)

    def answered(self) -> None:
        """Let the path, and preparation, go on from an auxiliary function."""
        self._moment.unanswered = False
        self._pass_barrier()
        self._hold.apply()

    def _pass_barrier(self) -> None:
        """Continue preparing after functions that have been answered: what they change counts for what follows."""
        if self._moment.barrier and not self._moment.unanswered:
            self._moment.barrier = False
            self._go_on()

    def _go_on(self) -> None:
        """Let preparation continue after what has been met."""
        self._feed.channel.go_on()
        self._feed.wake()

    def probe(self, probing: Probing) -> None:
        """Look for the contact of a probing move; what is left of the move is dropped once the axes stand."""
        if not probing.met:
            if (
                probing.look(self._machine, self._feed.channel, signal=self._moment.skip_signal)
                and probing.deletes
            ):
                self._hold.apply()
                if self.on_skip is not None and self._feed.channel.state.skip_position is not None:
                    self.on_skip()
        elif (
            probing.deletes
            and self._feed.row["state"] != kernel.RUNNING
            and self._moment.state is RunState.ACTIVE
        ):
            delete_rest(self._machine, self._feed.channel, self._feed)
            self._moment.probing = None
            self._hold.apply()

    def pass_stop(self) -> None:
        """Go on from a program stop."""
        if self._moment.stop is not None:
            self._moment.stop = None
            self._go_on()
