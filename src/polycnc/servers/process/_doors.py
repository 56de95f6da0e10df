"""The table of doors: a protocol is a row."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from polycnc.errors import UsageError
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


def _http(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
    try:
        from polycnc.servers.http import HttpDoor
    except ModuleNotFoundError as error:
        raise UsageError(
            f"http needs {error.name}, which is not installed", hint="pip install 'polycnc[serve]'"
        ) from None
    return HttpDoor(machines, wanted)


def _open_grbl(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
    from polycnc.servers.grbl import PORT, GrblCore, GrblServer, grbl_dialect

    (machine,) = machines
    control = machine.control
    assert control is not None
    control.change_dialect(grbl_dialect())
    port = PORT if wanted.port is None else wanted.port
    core = GrblCore(control)
    return GrblServer(machine.keeper, core, address=wanted.address, port=port, terminal=wanted.path)


def _open_calls(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
    from polycnc.servers.calls import PORT, CallsServer

    port = PORT if wanted.port is None else wanted.port
    trace = Path(wanted.path) if wanted.path else None
    return CallsServer(machines, address=wanted.address, port=port, log=wanted.log, trace=trace)


_ROWS = (
    focas_kind(),
    DoorKind("http", 8080, _http, shared=True, knows_token=True),
    DoorKind("calls", 8194, _open_calls, frozenset({"fanuc", "apci", "imc"}), shared=True),
    DoorKind("grbl", 8123, _open_grbl, frozenset({"plain"})),
)

DOORS = {row.name: row for row in _ROWS}
"""The doors by name."""
