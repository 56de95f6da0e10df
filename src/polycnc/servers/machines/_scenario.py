"""What happens to a served device by itself: its program begins again when it is over, faults come at their cycles."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

from polycnc.cnc import Control, ControlError, ControlEvent, RunState
from polycnc.machine import Clock, Device, Snapshot
from polycnc.servers.machines._watch import Watch

_LOOK_CYCLES = 20
_ANY_EVENT = int(ControlEvent.RUN_STATE | ControlEvent.ALARM | ControlEvent.MANUAL | ControlEvent.FUNCTION)
_ANY_ATTENTION = (1 << 30) - 1
_PIECE_CYCLES = 500  # between two looks at the wall clock where the device cannot be told to share its thread

D = TypeVar("D", bound=Device[Any])
D_contra = TypeVar("D_contra", contravariant=True)


class Scenario(Protocol[D_contra]):
    """What is done to a device at times of its own clock."""

    def next_s(self) -> float:
        """Return the time of the device at which something is to be done; infinity for never."""

    def look(self, device: D_contra, /) -> None:
        """Do what is due."""


class Nothing:
    """A scenario in which nothing happens."""

    def next_s(self) -> float:
        """Return infinity."""
        return math.inf

    def look(self, device: object, /) -> None:
        """Do nothing."""


class ServedDevice(Generic[D]):
    """Let the time of a device pass as it is served, in the place of the device itself.

    `control` returns the control within the device, None for one without. `again` calls for the selected program
    whenever it has come to its end, at most 20 cycles later; what an alarm, a reset or an emergency stop broke off
    stays so. What the scenario says comes in the very cycle that it says, however time is cut.
    """

    def __init__(
        self,
        device: D,
        control: Callable[[], Control] | None = None,
        scenario: Scenario[D] | None = None,
        *,
        again: Callable[[], None] | None = None,
    ) -> None:
        self.device = device
        self._control = control
        self.scenario: Scenario[D] = scenario or Nothing()
        self._scenario_changed: list[Callable[[], object]] = []
        self.again = again
        self._watches: list[Watch] = []
        self._wanted: list[Callable[[], bool]] = []
        self.scenario.look(device)

    def follow(self, scenario: Scenario[D] | None) -> None:
        """Follow another scenario from now on, or none."""
        self.scenario = scenario or Nothing()
        self.scenario.look(self.device)
        self.clock.changes += 1
        for call in self._scenario_changed:
            call()

    def on_scenario(self, call: Callable[[], object]) -> None:
        """Call whenever another scenario is followed."""
        self._scenario_changed.append(call)

    def watch(self, look: Callable[[], object], wanted: Callable[[], bool] = lambda: True) -> None:
        """Call `look` from now on once a second of the device's own clock, ten times while something happens.

        Where `wanted` says that nobody wants to see it, once a second is enough.
        """
        self._wanted.append(wanted)
        self._watches.append(Watch(self.clock, lambda: wanted() and self.busy, look))

    @property
    def is_followed(self) -> bool:
        """Whether somebody wants to see what happens in it as soon as it does."""
        return any(wanted() for wanted in self._wanted)

    @property
    def clock(self) -> Clock:
        """The clock of the device."""
        clock: Clock = self.device.clock
        return clock

    @property
    def busy(self) -> bool:
        """Whether something is executed or moves; a device without a control may always be."""
        if self._control is None:
            return True
        control = self._control()
        return control.manual.active or any(channel.active for channel in control.channels)

    def advance(
        self, cycles: int, *, is_enough: Callable[[], bool] | None = None, until: int | None = None
    ) -> int:
        """Let up to `cycles` control cycles pass, until `is_enough` says so or something of `until` has happened."""
        done = 0
        most = 1 << 30
        # a program's end is seen in its cycle, however time is cut
        own = int(ControlEvent.RUN_STATE) if self.again is not None and self._control is not None else 0
        if self._control is not None:
            self._control().be_shared(is_enough)
        elif is_enough is not None:
            most = _PIECE_CYCLES
        while done < cycles:
            asked = min(cycles - done, most, self._to_next())
            passed = self.device.advance(asked, until=(until or 0) | own if own else until)
            done += passed
            self.scenario.look(self.device)
            if self.again is not None:
                self._start_again(self.again)
            for watch in self._watches:
                watch.passed()
            ended = bool(own) and self._has_happened(own)
            if (passed < asked and not ended) or (is_enough is not None and is_enough()):
                break
            if self._has_happened(until):
                break
        return done

    def _to_next(self) -> int:
        """Return how many cycles may pass at once."""
        clock = self.clock
        begins = self.again is not None and self._is_over
        most = _LOOK_CYCLES - clock.cycles % _LOOK_CYCLES if begins else 1 << 30
        most = min([most, *(watch.cycles_left() for watch in self._watches)])
        next_s = self.scenario.next_s()
        if next_s == math.inf:
            return most
        return max(1, min(most, math.ceil((next_s - clock.now_s) / clock.cycle_s - 1e-6)))

    def _has_happened(self, events: int | None) -> bool:
        return bool(events) and self._control is not None and bool(self._control().raised & (events or 0))

    @property
    def _is_over(self) -> bool:
        return self._control is not None and self._control().channels[0].run_state is RunState.COMPLETED

    def _start_again(self, again: Callable[[], None]) -> None:
        if self._is_over and self.clock.cycles % _LOOK_CYCLES == 0:
            try:
                again()
            except ControlError:
                return  # an alarm or another mode: later

    def jump(self, most: int, is_enough: Callable[[], bool]) -> tuple[int, bool]:
        """Let time pass to the next event, for at most so many cycles or until `is_enough`.

        Return how many cycles have passed, and whether it has ended: an event has come, or all have passed. Events are
        the starts, stops and ends of programs, alarms, ends of manual motion and auxiliary functions of a control; of a
        board or card what its program calls get.
        """
        events = _ANY_EVENT if self._control is not None else _ANY_ATTENTION
        enough = False

        def had_enough() -> bool:
            nonlocal enough
            enough = enough or is_enough()
            return enough

        passed = self.advance(most, is_enough=had_enough, until=events)
        return passed, passed >= most or self._has_happened(events) or not enough

    def status(self) -> Any:
        """Return the status of the device."""
        return self.device.status()

    def snapshot(self) -> Snapshot:
        """Return the state of the device."""
        return self.device.snapshot()

    def restore(self, snapshot: Snapshot) -> None:
        """Put the device back into a state."""
        self.device.restore(snapshot)
