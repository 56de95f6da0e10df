"""A FANUC control that is served: its program begins again whenever it is over, and its faults come at their cycles."""

from __future__ import annotations

from polycnc.controllers.fanuc import PowerMate
from polycnc.servers.focas._faults import Faults
from polycnc.servers.machines import ServedDevice


class ServedControl(ServedDevice[PowerMate]):
    """Let the time of a Power Mate pass as it is served; `again` starts its program whenever that has ended."""

    def __init__(self, control: PowerMate, faults: Faults | None = None, *, again: bool = False) -> None:
        self.faults = faults or Faults()
        super().__init__(
            control, lambda: control.control, self.faults, again=control.cycle_start if again else None
        )

    @property
    def control(self) -> PowerMate:
        """The control."""
        return self.device
