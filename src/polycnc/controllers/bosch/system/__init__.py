"""System functions of CPL: interface signals, PLC data, errors, tool data, time."""

from polycnc.controllers.bosch.system._error_list import ALL_CHANNELS, Category, ErrorList, PresentError
from polycnc.controllers.bosch.system._interface import Interface, Signals
from polycnc.controllers.bosch.system._plc_data import PlcData, PlcRange
from polycnc.controllers.bosch.system._system_data import Area, AxisCoupling, Moment, SystemData
from polycnc.controllers.bosch.system._time import clock_ms, date_text, time_text
from polycnc.controllers.bosch.system._tool_data import ToolDatabase

__all__ = [
    "ALL_CHANNELS",
    "Area",
    "AxisCoupling",
    "Category",
    "ErrorList",
    "Interface",
    "Moment",
    "PlcData",
    "PlcRange",
    "PresentError",
    "Signals",
    "SystemData",
    "ToolDatabase",
    "clock_ms",
    "date_text",
    "time_text",
]
