"""FOCAS over TCP: frames, commands and sessions as Ethernet clients of FANUC controls speak them."""

from typing import TYPE_CHECKING

from polycnc.on_demand import names_on_demand
from polycnc.servers.focas._faults import Fault, FaultKind, Faults, Plan, PresentFaults, load_faults
from polycnc.servers.focas._profile import PROFILES, load_profile

if TYPE_CHECKING:
    from polycnc.servers.focas._capture import explain_capture, from_hex
    from polycnc.servers.focas._commands import COMMANDS, WRITING, known
    from polycnc.servers.focas._control import FocasControl
    from polycnc.servers.focas._dissect import Dissector, dissect
    from polycnc.servers.focas._numbered import number_in, numbered, unframed
    from polycnc.servers.focas._served import ServedControl
    from polycnc.servers.focas._server import FocasServer
    from polycnc.servers.focas._session import TRANSITIONS, Ending, Session, State, Status

__all__ = [
    "COMMANDS",
    "PROFILES",
    "TRANSITIONS",
    "WRITING",
    "Dissector",
    "Ending",
    "Fault",
    "FaultKind",
    "Faults",
    "FocasControl",
    "FocasServer",
    "Plan",
    "PresentFaults",
    "ServedControl",
    "Session",
    "State",
    "Status",
    "dissect",
    "explain_capture",
    "from_hex",
    "known",
    "load_faults",
    "load_profile",
    "number_in",
    "numbered",
    "unframed",
]

__getattr__ = names_on_demand(__name__)
