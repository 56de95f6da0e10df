"""What a control is made of, for those who let its time pass and who keep its state."""

from __future__ import annotations

from dataclasses import dataclass, field

from polycnc.cnc._alarms import AlarmList, OperatorMessages
from polycnc.cnc._auxiliary import AuxiliaryFunctions
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_data import ControlData
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._plc import PlcModel
from polycnc.cnc._program_edit import ProgramEdits
from polycnc.cnc._program_memory import ProgramMemory
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._spindle import Spindle
from polycnc.cnc._status import Emergency
from polycnc.cnc._tables import OffsetTable, ToolTable
from polycnc.cnc._timers import PartCounter, Timers
from polycnc.errors import shown
from polycnc.machine import Clock, Machine, MachineConfig
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
    edits: ProgramEdits
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

    def channel(self, number: int) -> ControlChannel:
        """Return a channel by its number, from 0.

        Raises:
            ControlError: There is no such channel.
        """
        if not 0 <= number < len(self.channels):
            raise ControlError(
                Refusal.DATA,
                f"there is no channel {shown(number)}",
                hint=f"Give 0 to {len(self.channels) - 1}.",
            )
        return self.channels[number]

    def chosen(self, number: int | None) -> tuple[ControlChannel, ...]:
        """Return the channel that a command means, all of them for None.

        Raises:
            ControlError: There is no such channel.
        """
        return self.channels if number is None else (self.channel(number),)

    def owner(self, axis: str) -> ControlChannel:
        """Return the channel of an axis; the first one for an axis that there is not."""
        return next((channel for channel in self.channels if axis in channel.axes), self.channels[0])


def live_config(config: MachineConfig, tools: ToolTable, offsets: OffsetTable) -> MachineConfig:
    """Return a machine file with the tables that change while programs run."""
    return config.model_copy(update={"tools": tools, "offsets": offsets})
