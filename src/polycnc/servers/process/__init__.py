"""A process that serves machines: kinds of machines, the table of doors, and what opens and ends them."""

from polycnc.servers.process._doors import DOORS, focas_kind, plant_kinds
from polycnc.servers.process._kinds import KINDS
from polycnc.servers.process._loop import run
from polycnc.servers.process._machinery import Machinery
from polycnc.servers.process._rehearsal import rehearse
from polycnc.servers.process._serving import MachineWanted, Serving

__all__ = [
    "DOORS",
    "KINDS",
    "MachineWanted",
    "Machinery",
    "Serving",
    "focas_kind",
    "plant_kinds",
    "rehearse",
    "run",
]
