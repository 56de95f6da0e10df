"""The table of doors: a protocol is a row."""

from __future__ import annotations

from collections.abc import Sequence

from polycnc.errors import UsageError
from polycnc.servers.machines import Door, DoorKind, ServedMachine, Wanted

FOCAS_PROFILE = "31i"
_WITH_CONTROL = frozenset({"bosch", "fanuc", "plain"})


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


def _opcua(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
    try:
        from polycnc.servers.opcua import OpcuaDoor
    except ModuleNotFoundError as error:
        raise UsageError(
            f"opcua needs {error.name}, which is not installed", hint="pip install 'polycnc[opcua]'"
        ) from None
    return OpcuaDoor(machines, wanted)


def _open_grbl(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
    from polycnc.servers.grbl import PORT, GrblCore, GrblServer, grbl_dialect

    (machine,) = machines
    control = machine.control
    assert control is not None
    control.change_dialect(grbl_dialect())
    port = PORT if wanted.port is None else wanted.port
    core = GrblCore(control)
    return GrblServer(machine.keeper, core, address=wanted.address, port=port, terminal=wanted.path)


_ROWS = (
    focas_kind(),
    DoorKind("http", 8080, _http, shared=True, knows_token=True),
    DoorKind(
        "opcua", 4840, _opcua, _WITH_CONTROL, shared=True, knows_token=True,
        lasts="opcua builds its address space of thousands of nodes: this takes a few seconds",
    ),
    DoorKind("grbl", 8123, _open_grbl, frozenset({"plain"})),
)  # fmt: skip

DOORS = {row.name: row for row in _ROWS}
"""The doors by name."""
