"""SHDR: a machine as an adapter that a foreign MTConnect agent reads."""

from polycnc.servers.shdr._lines import Adapter, Session
from polycnc.servers.shdr._server import PORT, ShdrServer

__all__ = ["PORT", "Adapter", "Session", "ShdrServer"]
