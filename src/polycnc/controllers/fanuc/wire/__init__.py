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
from polycnc.controllers.fanuc.wire._layouts import (
    AREAS,
    LAYOUTS,
    PMC_WIDTHS,
    POSITION_KINDS,
    Content,
    Layout,
    Rows,
    layout_of,
)
from polycnc.controllers.fanuc.wire._numbers import VACANT, VALUE8_SIZE, Value8, swapped, text
from polycnc.controllers.fanuc.wire._records import Part, Record, record

__all__ = [
    "AREAS",
    "CNC",
    "LAYOUTS",
    "PMC",
    "PMC_WIDTHS",
    "POSITION_KINDS",
    "REPLY_SIZE",
    "VACANT",
    "VALUE8_SIZE",
    "Client",
    "Connection",
    "Content",
    "Frame",
    "FrameReader",
    "FrameType",
    "Layout",
    "Part",
    "Record",
    "Reply",
    "Request",
    "Rows",
    "Value8",
    "WireRefusedError",
    "layout_of",
    "read_replies",
    "read_requests",
    "read_status",
    "record",
    "status_body",
    "swapped",
    "text",
    "write_replies",
    "write_requests",
]
