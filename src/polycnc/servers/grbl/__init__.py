"""The interface of grbl 1.1: what senders of hobby machines and small mills speak."""

from polycnc.servers.grbl._codes import GrblAlarm, GrblError
from polycnc.servers.grbl._core import GrblCore
from polycnc.servers.grbl._make import grbl_control, grbl_dialect
from polycnc.servers.grbl._server import PORT, GrblServer
from polycnc.servers.grbl._settings import ROWS as SETTINGS
from polycnc.servers.grbl._watching import GrblWatch

__all__ = [
    "PORT",
    "SETTINGS",
    "GrblAlarm",
    "GrblCore",
    "GrblError",
    "GrblServer",
    "GrblWatch",
    "grbl_control",
    "grbl_dialect",
]
