"""The file of what is to be served: TOML with a table for each machine; unknown keys are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from polycnc.machine import StrictModel, load_toml, validate

Port: TypeAlias = Annotated[int, Field(ge=0, le=65535)]
MOST_MACHINES = 1000


class MachineTable(StrictModel):
    """One machine: `file` is its machine, system or card file; `doors` are ports by door, 0 for free ones."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,31}$")]
    controller: Literal["fanuc", "plain", "bosch", "apci", "imc"]
    file: str | None = None
    program: str | None = None
    faults: str | None = None
    scenario: str | None = None
    memory: str | None = None
    rate: Annotated[float, Field(ge=0.0, le=1000.0)] = 1.0
    axes: Annotated[int, Field(ge=1, le=6)] = 3
    doors: dict[str, Port] = Field(default_factory=dict)


class ServeFile(StrictModel):
    """Machines, and `doors` that all of them share (`http`, `opcua`).

    `opcua_nodesets` is a folder of node sets that `opcua` takes its types from.
    """

    machine: Annotated[tuple[MachineTable, ...], Field(min_length=1, max_length=MOST_MACHINES)]
    doors: dict[str, Port] = Field(default_factory=dict)
    opcua_nodesets: str | None = None


def load_serve_file(path: Path) -> ServeFile:
    """Read a file of machines.

    Raises:
        UsageError: It cannot be read, or says what cannot be.
    """
    return validate(ServeFile, *load_toml(path))
