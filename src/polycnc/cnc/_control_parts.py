"""What a control is made of, for those who let its time pass and who keep its state."""

from __future__ import annotations

from dataclasses import dataclass, field

from polycnc.cnc._alarms import AlarmList, OperatorMessages
from polycnc.cnc._auxiliary import AuxiliaryFunctions
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_data import ControlData
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._plc import PlcModel
from polycnc.cnc._program_memory import ProgramMemory
from polycnc.cnc._spindle import Spindle
from polycnc.cnc._status import Emergency
from polycnc.cnc._tables import OffsetTable, ToolTable
from polycnc.cnc._timers import PartCounter, Timers
from polycnc.machine import Clock, Machine
from polycnc.nc import Dialect


@dataclass(slots=True)
class ControlParts:
    """The machine, the channels, and what they share; each is the control's attribute of the same name.

    `data`, `dialect` and `emergency` may be exchanged, the others stay. `relative_zero` is where the relative positions
    count from (machine coordinates), by the place of the axis.
    """

    machine: Machine
    clock: Clock
    channels: tuple[ControlChannel, ...]
    data: ControlData
    dialect: Dialect
    programs: ProgramMemory
    tools: ToolTable
    offsets: OffsetTable
    alarms: AlarmList
    messages: OperatorMessages
    timers: Timers
    parts: PartCounter
    spindle: Spindle
    plc: PlcModel
    functions: AuxiliaryFunctions
    manual: ManualMotion
    emergency: Emergency = Emergency.OFF
    relative_zero: list[float] = field(default_factory=list)
