"""The screen of a Bosch control, on which statements of CPL write and ask for keys."""

from __future__ import annotations

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.screen import KEYS, Surface
from polycnc.errors import UsageError
from polycnc.servers.machines import ScreenShown


class BoschScreen:
    """The screen of each channel."""

    def __init__(self, pnc: Pnc) -> None:
        self._pnc = pnc

    def shown(self, channel: int) -> ScreenShown:
        """Return lines, softkeys and the names of keys."""
        surface = self._surface(channel)
        return ScreenShown(tuple(surface.lines()), surface.softkeys, tuple(KEYS))

    def picture(self, channel: int) -> str:
        """Return it with its colours and graphics."""
        return self._surface(channel).svg()

    def press(self, key: str, channel: int) -> None:
        """Press a key."""
        self._surface(channel)
        try:
            self._pnc.press(key, channel=channel + 1)
        except UsageError as error:
            raise ControlError(Refusal.DATA, error.what, hint=error.hint) from None

    def _surface(self, channel: int) -> Surface:
        self._pnc.control.channel_status(channel)  # refuses a channel that there is not
        return self._pnc.screen(channel + 1)
