"""The table of doors: a protocol is a row."""

from __future__ import annotations

from collections.abc import Sequence

from polycnc.errors import UsageError
from polycnc.servers.commands import carry_out
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
    from polycnc.servers.grbl import PORT, GrblCore, GrblServer, GrblWatch, grbl_dialect

    (machine,) = machines
    control, find = machine.control, machine.find_control
    assert control is not None
    assert find is not None
    core: GrblCore | GrblWatch
    if machine.kind == "plain":
        control.change_dialect(grbl_dialect())
        core = GrblCore(control)
    else:  # its programs stay in its own dialect
        core = GrblWatch(find, lambda asked: carry_out(machine, asked))
    port = PORT if wanted.port is None else wanted.port
    return GrblServer(machine.keeper, core, address=wanted.address, port=port, terminal=wanted.path)


_ROWS = (
    focas_kind(),
    DoorKind("http", 8080, _http, shared=True, knows_token=True),
    DoorKind("grbl", 8123, _open_grbl, frozenset({"plain", "fanuc", "bosch"})),
)

DOORS = {row.name: row for row in _ROWS}
"""The doors by name."""
