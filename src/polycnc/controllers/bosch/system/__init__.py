"""System functions of CPL: interface signals, PLC data, errors, tool data, time."""

from polycnc.controllers.bosch.system._error_list import ALL_CHANNELS, Category, ErrorList, PresentError
from polycnc.controllers.bosch.system._interface import Interface, Signals
from polycnc.controllers.bosch.system._plc_data import PlcData, PlcRange
from polycnc.controllers.bosch.system._programmed import LastFunctions, Macoda, ProgrammedShifts
from polycnc.controllers.bosch.system._shift_tables import Column, ShiftTable, ZeroShifts
from polycnc.controllers.bosch.system._system_data import Area, AxisCoupling, Moment, SystemData
from polycnc.controllers.bosch.system._time import clock_ms, date_text, time_text
from polycnc.controllers.bosch.system._tool_data import ToolDatabase
from polycnc.controllers.bosch.system._tool_tables import ToolCompensations, ToolTable

__all__ = [
    "ALL_CHANNELS",
    "Area",
    "AxisCoupling",
    "Category",
    "Column",
    "ErrorList",
    "Interface",
    "LastFunctions",
    "Macoda",
    "Moment",
    "PlcData",
    "PlcRange",
    "PresentError",
    "ProgrammedShifts",
    "ShiftTable",
    "Signals",
    "SystemData",
    "ToolCompensations",
    "ToolDatabase",
    "ToolTable",
    "ZeroShifts",
    "clock_ms",
    "date_text",
    "time_text",
]
