"""Part programs: block scanner, dialects, modal state, coordinate systems, tool compensation, the channel."""

from polycnc.nc._channel import Channel
from polycnc.nc._dialect import DEFAULT_DIALECT, DIALECTS, Dialect, dialect_for, load_dialect
from polycnc.nc.blocks._actions import Action, Group, MAction
from polycnc.nc.blocks._messages import Message
from polycnc.nc.text._program import ProgramText

__all__ = [
    "DEFAULT_DIALECT",
    "DIALECTS",
    "Action",
    "Channel",
    "Dialect",
    "Group",
    "MAction",
    "Message",
    "ProgramText",
    "dialect_for",
    "load_dialect",
]
