"""FANUC Power Mate: the control behind the function library, and the library (`fwlib`)."""

from polycnc.controllers.fanuc.data._parameter_rows import Attribute, Kind, ParameterRow, parameter_rows
from polycnc.controllers.fanuc.device._alarms import AlarmBit
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.device._snapshot import PowerMateSnapshot

__all__ = [
    "AlarmBit",
    "Attribute",
    "Kind",
    "ParameterRow",
    "PowerMate",
    "PowerMateMode",
    "PowerMateSnapshot",
    "parameter_rows",
]
