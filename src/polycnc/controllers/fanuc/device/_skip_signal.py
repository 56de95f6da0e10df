"""The skip signal: its rising edge notes where the axes are, and ends skip moves (G31)."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.controllers.fanuc.device._device_state import DeviceState
from polycnc.controllers.fanuc.device._positions import Positions
from polycnc.controllers.fanuc.device._power import Power


class SkipSignal:
    """The signal, and the positions at its last rising edge."""

    def __init__(self, power: Power, positions: Positions, state: DeviceState, axes: int) -> None:
        self._axes = axes
        self._power = power
        self._positions = positions
        self._state = state

    @property
    def positions(self) -> tuple[int, ...]:
        """Where the axes were at the last rising edge, in increments; zeros before the first."""
        return self._state.skip_positions or (0,) * self._axes

    def give(self, on: bool) -> None:
        """Give the signal, or take it away."""
        if on and not self._state.skip:
            self._note()
        self._state.skip = on
        self.restored()

    def restored(self) -> None:
        """Let the control have the signal as the state has it."""
        self._power.control.channels[0].set_skip_signal(self._state.skip)

    def clear(self) -> None:
        """Forget everything, as when the power goes off."""
        self._state.skip, self._state.skip_positions = False, ()

    def noting(self) -> Callable[[], None]:
        """Return what notes the positions when a skip move ends."""
        return lambda: self._note()  # a function, not a method: a copy of the run shares it

    def _note(self) -> None:
        self._state.skip_positions = tuple(each.absolute for each in self._positions.read())
