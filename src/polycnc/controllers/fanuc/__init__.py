"""FANUC Power Mate: the control behind the function library, and the library (`fwlib`)."""

from polycnc.controllers.fanuc.data._parameter_rows import Attribute, Kind, ParameterRow, parameter_rows
from polycnc.controllers.fanuc.device import _pmc_memory as pmc
from polycnc.controllers.fanuc.device._alarms import AlarmBit, bit_of, shown
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.device._snapshot import PowerMateSnapshot
from polycnc.controllers.fanuc.device._state import State, read_state

__all__ = [
    "AlarmBit",
    "Attribute",
    "Kind",
    "ParameterRow",
    "PowerMate",
    "PowerMateMode",
    "PowerMateSnapshot",
    "State",
    "bit_of",
    "parameter_rows",
    "pmc",
    "read_state",
    "shown",
]
