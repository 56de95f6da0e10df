"""A control that is served: its program begins again whenever it is over, and its faults come at their cycles."""

from __future__ import annotations

import math
from collections.abc import Callable

from polycnc.cnc import ControlError, RunState, Status
from polycnc.controllers.fanuc import PowerMate, PowerMateSnapshot
from polycnc.machine import Clock
from polycnc.servers.focas._faults import Faults

_LOOK_CYCLES = 20


class ServedControl:
    """Let the time of a control pass as it is served, in the place of the control itself.

    `again` starts the selected program whenever it has come to its end, at most 20 cycles later; what an alarm, a reset
    or an emergency stop broke off stays so. Faults come in the very cycle that the script says, however time is cut.
    """

    def __init__(self, control: PowerMate, faults: Faults | None = None, *, again: bool = False) -> None:
        self.control = control
        self.faults = faults or Faults()
        self.again = again
        self.faults.look(control)

    @property
    def clock(self) -> Clock:
        """The clock of the control."""
        return self.control.clock

    @property
    def busy(self) -> bool:
        """Whether something is executed."""
        return self.control.control.channels[0].active

    def advance(
        self,
        cycles: int,
        *,
        until: int | Callable[[], bool] | None = None,
        is_enough: Callable[[], bool] | None = None,
    ) -> int:
        """Let up to `cycles` control cycles pass, or until `is_enough` says so; return how many did."""
        done = 0
        self.control.control.be_shared(is_enough)
        while done < cycles:
            asked = min(cycles - done, self._to_next())
            passed = self.control.advance(asked, until=until)
            done += passed
            self.faults.look(self.control)
            if self.again:
                self._start_again()
            if passed < asked:
                break
        return done

    def _to_next(self) -> int:
        """Return how many cycles may pass at once."""
        clock = self.clock
        # a program's end is looked for at cycles that do not depend on how time is cut
        looks = self.again and (self.busy or self._is_over)
        most = _LOOK_CYCLES - clock.cycles % _LOOK_CYCLES if looks else 1 << 30
        next_s = self.faults.next_s()
        if next_s == math.inf:
            return most
        return max(1, min(most, math.ceil((next_s - clock.now_s) / clock.cycle_s - 1e-6)))

    @property
    def _is_over(self) -> bool:
        return self.control.control.channels[0].run_state is RunState.COMPLETED

    def _start_again(self) -> None:
        if self._is_over and self.clock.cycles % _LOOK_CYCLES == 0:
            try:
                self.control.cycle_start()
            except ControlError:
                return  # an alarm or another mode: later

    def status(self) -> Status:
        """Return the status of the control."""
        return self.control.status()

    def snapshot(self) -> PowerMateSnapshot:
        """Return the state of the control."""
        return self.control.snapshot()

    def restore(self, snapshot: PowerMateSnapshot) -> None:
        """Put the control back into a state."""
        self.control.restore(snapshot)
