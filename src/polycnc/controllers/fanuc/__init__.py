"""FANUC Power Mate: the control behind the function library, and the library (`fwlib`)."""

from polycnc.controllers.fanuc.data._diagnosis import DIAGNOSIS, Diagnosis
from polycnc.controllers.fanuc.data._parameter_rows import Attribute, Kind, ParameterRow, parameter_rows
from polycnc.controllers.fanuc.device import _pmc_memory as pmc
from polycnc.controllers.fanuc.device._alarms import AlarmBit, bit_of, is_macro_alarm, shown
from polycnc.controllers.fanuc.device._modal_data import ADDRESSES as MODAL_ADDRESSES
from polycnc.controllers.fanuc.device._modal_data import CODES as MODAL_CODES
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._panel import MEMBERS as PANEL_SIGNALS
from polycnc.controllers.fanuc.device._positions import AxisPositions
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.device._program_rules import Objection, delete_program, search_program
from polycnc.controllers.fanuc.device._snapshot import PowerMateSnapshot
from polycnc.controllers.fanuc.device._state import State, read_state
from polycnc.controllers.fanuc.device._transfer import Fault, Transfer, TransferError

__all__ = [
    "DIAGNOSIS",
    "MODAL_ADDRESSES",
    "MODAL_CODES",
    "PANEL_SIGNALS",
    "AlarmBit",
    "Attribute",
    "AxisPositions",
    "Diagnosis",
    "Fault",
    "Kind",
    "Objection",
    "ParameterRow",
    "PowerMate",
    "PowerMateMode",
    "PowerMateSnapshot",
    "State",
    "Transfer",
    "TransferError",
    "bit_of",
    "delete_program",
    "is_macro_alarm",
    "parameter_rows",
    "pmc",
    "read_state",
    "search_program",
    "shown",
]
