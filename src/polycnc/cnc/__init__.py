"""A numerical control without a vendor: its programs, tools, alarms, timers, spindle, PLC and manual motion.

Running a program needs no control: what belongs to one is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from polycnc.cnc._passed_events import OnPassed, Passed, PassedRun, let_pass
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._run_snapshot import RunSnapshot
from polycnc.cnc._run_state import RunAlarm, RunOptions, RunState
from polycnc.cnc._stops import Breakpoint, Step
from polycnc.cnc._tool_times import ToolTime
from polycnc.on_demand import names_on_demand

if TYPE_CHECKING:
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
    from polycnc.cnc._control import Control
    from polycnc.cnc._control_channel import ControlChannel
    from polycnc.cnc._control_data import (
        AfterManual,
        ChannelData,
        ControlData,
        Mode,
        OnModeChange,
        Overrides,
        Search,
        Switches,
    )
    from polycnc.cnc._control_snapshot import ControlSnapshot
    from polycnc.cnc._control_time import ControlEvent
    from polycnc.cnc._inventory import AxisLimits, Identity, Inventory, PastMessage, SetBreakpoint
    from polycnc.cnc._manual import ManualMotion
    from polycnc.cnc._manual_data import AxisMotion, Handwheel, ManualData, ManualKind, ManualState
    from polycnc.cnc._open_program import OpenProgram
    from polycnc.cnc._plc import Answer, Function, PlcModel, PlcState, Request, Script
    from polycnc.cnc._program_edit import ProgramEdit
    from polycnc.cnc._program_memory import Found, MemoryData, ProgramEntry, ProgramMemory, first_comment
    from polycnc.cnc._refusal import ControlError, Refusal
    from polycnc.cnc._spindle import Spindle, SpindleMotion, SpindleState
    from polycnc.cnc._status import (
        AxisStatus,
        ChannelStatus,
        Emergency,
        Feed,
        Motion,
        Status,
        ToolInUse,
        WorkOffset,
    )
    from polycnc.cnc._stopping import PROGRAM_MESSAGE
    from polycnc.cnc._tables import OffsetTable, Tool, ToolTable
    from polycnc.cnc._timers import PartCounter, Parts, Timer, Timers, TimersState

__all__ = [
    "ALARMS",
    "PROGRAM_MESSAGE",
    "AfterManual",
    "Alarm",
    "AlarmKind",
    "AlarmList",
    "AlarmRow",
    "AlarmTable",
    "Answer",
    "AxisLimits",
    "AxisMotion",
    "AxisStatus",
    "Breakpoint",
    "ChannelData",
    "ChannelStatus",
    "ClearedBy",
    "Control",
    "ControlChannel",
    "ControlData",
    "ControlError",
    "ControlEvent",
    "ControlSnapshot",
    "Emergency",
    "Feed",
    "Found",
    "Function",
    "Handwheel",
    "Identity",
    "Inventory",
    "ManualData",
    "ManualKind",
    "ManualMotion",
    "ManualState",
    "MemoryData",
    "Mode",
    "Motion",
    "OffsetTable",
    "OnModeChange",
    "OnPassed",
    "OpenProgram",
    "OperatorMessage",
    "OperatorMessages",
    "Overrides",
    "PartCounter",
    "Parts",
    "Passed",
    "PassedRun",
    "PastAlarm",
    "PastMessage",
    "PlcModel",
    "PlcState",
    "ProgramEdit",
    "ProgramEntry",
    "ProgramMemory",
    "ProgramRun",
    "Refusal",
    "Request",
    "RunAlarm",
    "RunOptions",
    "RunSnapshot",
    "RunState",
    "Script",
    "Search",
    "SetBreakpoint",
    "Spindle",
    "SpindleMotion",
    "SpindleState",
    "Status",
    "Step",
    "Switches",
    "Timer",
    "Timers",
    "TimersState",
    "Tool",
    "ToolInUse",
    "ToolTable",
    "ToolTime",
    "WorkOffset",
    "first_comment",
    "let_pass",
]

__getattr__ = names_on_demand(__name__)
