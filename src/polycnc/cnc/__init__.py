"""A numerical control without a vendor: its programs, tools, alarms, timers, spindle, PLC and manual motion."""

from polycnc.cnc._alarms import (
    ALARMS,
    Alarm,
    AlarmKind,
    AlarmList,
    AlarmRow,
    AlarmTable,
    ClearedBy,
    OperatorMessage,
    OperatorMessages,
    PastAlarm,
)
from polycnc.cnc._manual import AxisMotion, ManualData, ManualKind, ManualMotion, ManualState
from polycnc.cnc._plc import Answer, Function, PlcModel, PlcState, Request, Script
from polycnc.cnc._program_edit import ProgramEdit
from polycnc.cnc._program_memory import Found, MemoryData, ProgramEntry, ProgramMemory, first_comment
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._spindle import Spindle, SpindleMotion, SpindleState
from polycnc.cnc._tables import OffsetTable, Tool, ToolTable
from polycnc.cnc._timers import PartCounter, Parts, Timer, Timers, TimersState

__all__ = [
    "ALARMS",
    "Alarm",
    "AlarmKind",
    "AlarmList",
    "AlarmRow",
    "AlarmTable",
    "Answer",
    "AxisMotion",
    "ClearedBy",
    "ControlError",
    "Found",
    "Function",
    "ManualData",
    "ManualKind",
    "ManualMotion",
    "ManualState",
    "MemoryData",
    "OffsetTable",
    "OperatorMessage",
    "OperatorMessages",
    "PartCounter",
    "Parts",
    "PastAlarm",
    "PlcModel",
    "PlcState",
    "ProgramEdit",
    "ProgramEntry",
    "ProgramMemory",
    "Refusal",
    "Request",
    "Script",
    "Spindle",
    "SpindleMotion",
    "SpindleState",
    "Timer",
    "Timers",
    "TimersState",
    "Tool",
    "ToolTable",
    "first_comment",
]
