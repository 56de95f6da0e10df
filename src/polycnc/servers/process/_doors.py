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


def _open_grbl(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
    from polycnc.servers.grbl import PORT, GrblCore, GrblServer, grbl_dialect

    (machine,) = machines
    control = machine.control
    assert control is not None
    control.change_dialect(grbl_dialect())
    port = PORT if wanted.port is None else wanted.port
    core = GrblCore(control)
    return GrblServer(machine.keeper, core, address=wanted.address, port=port, terminal=wanted.path)


DOORS = {row.name: row for row in (focas_kind(), DoorKind("grbl", 8123, _open_grbl, frozenset({"plain"})))}
"""The doors by name."""
