"""FOCAS over TCP: frames, commands and sessions as Ethernet clients of FANUC controls speak them."""

from polycnc.controllers.fanuc.wire import (
    CNC,
    PMC,
    VACANT,
    Frame,
    FrameReader,
    FrameType,
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
from polycnc.servers.focas._commands import COMMANDS
from polycnc.servers.focas._control import FocasControl
from polycnc.servers.focas._profile import PROFILES, Profile, load_profile
from polycnc.servers.focas._server import PORT, FocasServer
from polycnc.servers.focas._session import TRANSITIONS, Answerer, Ending, Session, State, Status, Transition

__all__ = [
    "CNC",
    "COMMANDS",
    "PMC",
    "PORT",
    "PROFILES",
    "TRANSITIONS",
    "VACANT",
    "Answerer",
    "Ending",
    "FocasControl",
    "FocasServer",
    "Frame",
    "FrameReader",
    "FrameType",
    "Profile",
    "Reply",
    "Request",
    "Session",
    "State",
    "Status",
    "Transition",
    "Value8",
    "load_profile",
    "read_replies",
    "read_requests",
    "read_status",
    "status_body",
    "text",
    "write_replies",
    "write_requests",
]
