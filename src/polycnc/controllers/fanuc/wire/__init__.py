"""The Ethernet protocol of FANUC controls: frames, command blocks and numbers for both ends, and a client."""

from polycnc.controllers.fanuc.wire._blocks import (
    CNC,
    PMC,
    REPLY_SIZE,
    Reply,
    Request,
    read_replies,
    read_requests,
    write_replies,
    write_requests,
)
from polycnc.controllers.fanuc.wire._client import Client, Connection, WireRefusedError
from polycnc.controllers.fanuc.wire._frames import Frame, FrameReader, FrameType, read_status, status_body
from polycnc.controllers.fanuc.wire._numbers import VACANT, VALUE8_SIZE, Value8, text

__all__ = [
    "CNC",
    "PMC",
    "REPLY_SIZE",
    "VACANT",
    "VALUE8_SIZE",
    "Client",
    "Connection",
    "Frame",
    "FrameReader",
    "FrameType",
    "Reply",
    "Request",
    "Value8",
    "WireRefusedError",
    "read_replies",
    "read_requests",
    "read_status",
    "status_body",
    "text",
    "write_replies",
    "write_requests",
]
