"""FOCAS over TCP: frames, commands and sessions as Ethernet clients of FANUC controls speak them."""

from polycnc.controllers.fanuc.wire import (
    CNC,
    LAYOUTS,
    PMC,
    VACANT,
    Frame,
    FrameReader,
    FrameType,
    Layout,
    Reply,
    Request,
    Value8,
    read_replies,
    read_requests,
    read_status,
    status_body,
    text,
    write_replies,
    write_requests,
)
from polycnc.servers.focas._capture import explain_capture, from_hex
from polycnc.servers.focas._commands import COMMANDS, WRITING, known
from polycnc.servers.focas._control import FocasControl
from polycnc.servers.focas._dissect import Dissector, Field, dissect
from polycnc.servers.focas._faults import Fault, FaultKind, Faults, Plan, PresentFaults, load_faults
from polycnc.servers.focas._numbered import number_in, numbered, unframed
from polycnc.servers.focas._profile import PROFILES, Profile, load_profile
from polycnc.servers.focas._served import ServedControl
from polycnc.servers.focas._server import PORT, FocasServer
from polycnc.servers.focas._session import TRANSITIONS, Answerer, Ending, Session, State, Status, Transition
from polycnc.servers.machines import HostOwner, Keeper, Owner

__all__ = [
    "CNC",
    "COMMANDS",
    "LAYOUTS",
    "PMC",
    "PORT",
    "PROFILES",
    "TRANSITIONS",
    "VACANT",
    "WRITING",
    "Answerer",
    "Dissector",
    "Ending",
    "Fault",
    "FaultKind",
    "Faults",
    "Field",
    "FocasControl",
    "FocasServer",
    "Frame",
    "FrameReader",
    "FrameType",
    "HostOwner",
    "Keeper",
    "Layout",
    "Owner",
    "Plan",
    "PresentFaults",
    "Profile",
    "Reply",
    "Request",
    "ServedControl",
    "Session",
    "State",
    "Status",
    "Transition",
    "Value8",
    "dissect",
    "explain_capture",
    "from_hex",
    "known",
    "load_faults",
    "load_profile",
    "number_in",
    "numbered",
    "read_replies",
    "read_requests",
    "read_status",
    "status_body",
    "text",
    "unframed",
    "write_replies",
    "write_requests",
]
