"""Bosch Rexroth Typ3 osa and PNC: what their part programs can ask of the control (Manual 003)."""

from polycnc.controllers.bosch._channel_host import ChannelHost
from polycnc.controllers.bosch._debugged import DebuggedPnc
from polycnc.controllers.bosch._macoda import NEW_NUMBERS, present_number
from polycnc.controllers.bosch._pnc import Pnc
from polycnc.controllers.bosch._system import BoschSystem

__all__ = ["NEW_NUMBERS", "BoschSystem", "ChannelHost", "DebuggedPnc", "Pnc", "present_number"]
