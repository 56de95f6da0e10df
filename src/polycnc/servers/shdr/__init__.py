"""SHDR: a machine as an adapter that a foreign MTConnect agent reads."""

from polycnc.servers.shdr._lines import PONG_MS, Adapter, Session, line_of
from polycnc.servers.shdr._server import PORT, ShdrServer

__all__ = ["PONG_MS", "PORT", "Adapter", "Session", "ShdrServer", "line_of"]
