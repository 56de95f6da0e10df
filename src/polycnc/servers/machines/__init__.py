"""Served machines: a device, who lets its time pass, what happens to it by itself, and the doors to it."""

from polycnc.servers.machines._connections import (
    Crowd,
    Patience,
    notice_loss,
    peers_of,
    take_all_files,
    tell_errors,
)
from polycnc.servers.machines._door import LOOPBACK, Door, DoorKind, Wanted
from polycnc.servers.machines._log import Log
from polycnc.servers.machines._machine import (
    AS_USUAL,
    MachineError,
    Made,
    ServedMachine,
    Treatment,
    machines_of_path,
    treatment_of,
)
from polycnc.servers.machines._owner import HostOwner, Keeper, Owner
from polycnc.servers.machines._programs import MemoryPrograms, Programs
from polycnc.servers.machines._scenario import Scenario, ServedDevice
from polycnc.servers.machines._screens import Screen, ScreenShown, Tasks, TaskShown
from polycnc.servers.machines._turns import Turns
from polycnc.servers.machines._values import (
    NO_PARAMETERS,
    NO_SIGNALS,
    NO_VARIABLES,
    NamedValue,
    ReadValues,
    Single,
    Values,
    no_such,
)
from polycnc.servers.machines._watch import BUSY_S, IDLE_S

__all__ = [
    "AS_USUAL",
    "BUSY_S",
    "IDLE_S",
    "LOOPBACK",
    "NO_PARAMETERS",
    "NO_SIGNALS",
    "NO_VARIABLES",
    "Crowd",
    "Door",
    "DoorKind",
    "HostOwner",
    "Keeper",
    "Log",
    "MachineError",
    "Made",
    "MemoryPrograms",
    "NamedValue",
    "Owner",
    "Patience",
    "Programs",
    "ReadValues",
    "Scenario",
    "Screen",
    "ScreenShown",
    "ServedDevice",
    "ServedMachine",
    "Single",
    "TaskShown",
    "Tasks",
    "Treatment",
    "Turns",
    "Values",
    "Wanted",
    "machines_of_path",
    "no_such",
    "notice_loss",
    "peers_of",
    "take_all_files",
    "tell_errors",
    "treatment_of",
]
