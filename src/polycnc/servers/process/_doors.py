"""The table of doors: a protocol is a row."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.servers.commands import carry_out
from polycnc.servers.machines import Door, DoorKind, ServedMachine, Wanted, treatment_of
from polycnc.servers.mtconnect import USUAL_VERSION

FOCAS_PROFILE = "31i"
_CONTROLS = frozenset({"plain", "fanuc", "bosch"})


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
    return GrblServer(
        machine.keeper,
        core,
        address=wanted.address,
        port=port,
        terminal=wanted.path,
        treat=lambda: treatment_of([machine], "grbl"),
        is_usual=lambda: machine.is_usual,
    )


def plant_kinds(version: str = USUAL_VERSION) -> tuple[DoorKind, ...]:
    """Return the rows of MTConnect and SHDR, with the version that clients see."""

    def open_agent(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
        try:
            from polycnc.servers.mtconnect import MTConnectDoor
        except ModuleNotFoundError as error:
            raise UsageError(
                f"mtconnect needs {error.name}, which is not installed", hint="pip install 'polycnc[serve]'"
            ) from None
        return MTConnectDoor(machines, wanted, version)

    def open_adapter(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
        from polycnc.servers.shdr import PORT, ShdrServer

        (machine,) = machines
        port = PORT if wanted.port is None else wanted.port
        return ShdrServer(machine, version, address=wanted.address, port=port)

    return (
        DoorKind("mtconnect", 5000, open_agent, _CONTROLS, shared=True, commands=False),
        DoorKind("shdr", 7878, open_adapter, _CONTROLS, commands=False),
    )


def _open_calls(machines: Sequence[ServedMachine], wanted: Wanted) -> Door:
    from polycnc.servers.calls import PORT, CallsServer

    port = PORT if wanted.port is None else wanted.port
    trace = Path(wanted.path) if wanted.path else None
    return CallsServer(machines, address=wanted.address, port=port, log=wanted.log, trace=trace)


_ROWS = (
    focas_kind(),
    DoorKind("http", 8080, _http, shared=True, knows_token=True),
    DoorKind("calls", 8194, _open_calls, frozenset({"fanuc", "apci", "imc"}), shared=True),
    DoorKind("grbl", 8123, _open_grbl, _CONTROLS),
    *plant_kinds(),
    DoorKind(
        "opcua", 4840, _opcua, _CONTROLS, shared=True, knows_token=True,
        lasts="opcua builds its address space of thousands of nodes: this takes a few seconds",
    ),
)  # fmt: skip

DOORS = {row.name: row for row in _ROWS}
"""The doors by name."""
