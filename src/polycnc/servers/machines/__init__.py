"""Served machines: a device, who lets its time pass, what happens to it by itself, and the doors to it."""

from polycnc.servers.machines._door import LOOPBACK, Door, DoorKind, Wanted
from polycnc.servers.machines._log import Log
from polycnc.servers.machines._machine import AS_USUAL, MachineError, ServedMachine, Treatment
from polycnc.servers.machines._owner import HostOwner, Keeper, Kept, Owner
from polycnc.servers.machines._programs import MemoryPrograms, Programs
from polycnc.servers.machines._scenario import Nothing, Scenario, ServedDevice

__all__ = [
    "AS_USUAL",
    "LOOPBACK",
    "Door",
    "DoorKind",
    "HostOwner",
    "Keeper",
    "Kept",
    "Log",
    "MachineError",
    "MemoryPrograms",
    "Nothing",
    "Owner",
    "Programs",
    "Scenario",
    "ServedDevice",
    "ServedMachine",
    "Treatment",
    "Wanted",
]
