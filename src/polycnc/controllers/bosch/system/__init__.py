"""System functions of CPL: interface signals, PLC data, errors, tool data, time."""

from polycnc.controllers.bosch.system._drives import Drives, Ident, Parameter
from polycnc.controllers.bosch.system._error_list import ALL_CHANNELS, Category, ErrorList, PresentError, Tab
from polycnc.controllers.bosch.system._interface import MODE_BY_PLC, RESET_EXECUTED, Interface, Signals
from polycnc.controllers.bosch.system._plc_data import PlcData, PlcRange
from polycnc.controllers.bosch.system._programmed import LastFunctions, Macoda, ProgrammedShifts
from polycnc.controllers.bosch.system._shift_tables import DATABASE as DATABASE_SHIFTS
from polycnc.controllers.bosch.system._shift_tables import SHIFT_CODES, Column, ShiftTable, ZeroShifts
from polycnc.controllers.bosch.system._system_data import SD_GROUPS, Area, AxisCoupling, Moment, SystemData
from polycnc.controllers.bosch.system._time import clock_ms, date_text, time_text
from polycnc.controllers.bosch.system._tool_data import ToolDatabase
from polycnc.controllers.bosch.system._tool_tables import DATABASE as DATABASE_TOOLS
from polycnc.controllers.bosch.system._tool_tables import KIND as TOOL_KIND
from polycnc.controllers.bosch.system._tool_tables import LENGTH as TOOL_LENGTH
from polycnc.controllers.bosch.system._tool_tables import RADIUS as TOOL_RADIUS
from polycnc.controllers.bosch.system._tool_tables import ToolCompensations, ToolTable

__all__ = [
    "ALL_CHANNELS",
    "DATABASE_SHIFTS",
    "DATABASE_TOOLS",
    "MODE_BY_PLC",
    "RESET_EXECUTED",
    "SD_GROUPS",
    "SHIFT_CODES",
    "TOOL_KIND",
    "TOOL_LENGTH",
    "TOOL_RADIUS",
    "Area",
    "AxisCoupling",
    "Category",
    "Column",
    "Drives",
    "ErrorList",
    "Ident",
    "Interface",
    "LastFunctions",
    "Macoda",
    "Moment",
    "Parameter",
    "PlcData",
    "PlcRange",
    "PresentError",
    "ProgrammedShifts",
    "ShiftTable",
    "Signals",
    "SystemData",
    "Tab",
    "ToolCompensations",
    "ToolDatabase",
    "ToolTable",
    "ZeroShifts",
    "clock_ms",
    "date_text",
    "time_text",
]
