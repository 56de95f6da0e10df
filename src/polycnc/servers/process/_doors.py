"""The table of doors: a protocol is a row."""

from __future__ import annotations

from collections.abc import Sequence

from polycnc.servers.machines import Door, DoorKind, ServedMachine, Wanted

FOCAS_PROFILE = "31i"


def focas_kind(profile: str = FOCAS_PROFILE) -> DoorKind:
    """Return the row of FOCAS, with the series that clients see."""

    def open_door(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
        from polycnc.servers.focas import FocasServer, load_profile

        (machine,) = machines
        port = 8193 if wanted.port is None else wanted.port
        return FocasServer.of(machine, load_profile(profile), address=wanted.address, port=port)

    return DoorKind("focas", 8193, open_door, frozenset({"fanuc"}))


DOORS = {row.name: row for row in (focas_kind(),)}
"""The doors by name."""
