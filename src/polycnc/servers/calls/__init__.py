"""Calls of C programs to served machines: what their library sends is carried out by the façade of the machine."""

from polycnc.controllers.library.clib import PORT
from polycnc.servers.calls._build import TARGETS, build_command, build_library, target_here, write_library
from polycnc.servers.calls._caller import Caller
from polycnc.servers.calls._client import MAGIC, CallClient
from polycnc.servers.calls._imports import missing_of
from polycnc.servers.calls._libraries import LIBRARIES, library_of
from polycnc.servers.calls._replay import replay
from polycnc.servers.calls._server import CallsServer
from polycnc.servers.calls._trace import Trace

__all__ = [
    "LIBRARIES",
    "MAGIC",
    "PORT",
    "TARGETS",
    "CallClient",
    "Caller",
    "CallsServer",
    "Trace",
    "build_command",
    "build_library",
    "library_of",
    "missing_of",
    "replay",
    "target_here",
    "write_library",
]
