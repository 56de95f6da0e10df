"""Make a control that a sender finds its grbl in."""

from __future__ import annotations

from pathlib import Path

from polycnc.cnc import Control
from polycnc.machine import MachineConfig, Store
from polycnc.nc import Dialect, load_dialect

_PROBES = {"38.2": "probe_move", "38.3": "probe_move"}


def grbl_dialect() -> Dialect:
    """Return the dialect grbl with its probing moves towards the workpiece, which need a machine."""
    dialect = load_dialect("grbl")
    return Dialect.model_validate(dialect.model_dump() | {"g": {**dialect.g, **_PROBES}})


def grbl_control(
    machine: MachineConfig | str | Path | None = None, *, memory: str | Path | Store | None = None
) -> Control:
    """Return a control of a machine that reads what a grbl reads."""
    return Control(machine, memory=memory, dialect=grbl_dialect())
