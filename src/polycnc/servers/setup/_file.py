"""The file of what is to be served: TOML with a table for each machine; unknown keys are refused."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from polycnc.errors import UsageError
from polycnc.machine import StrictModel, load_toml, validate

MOST_PORT = 65535
Port: TypeAlias = Annotated[int, Field(ge=0, le=MOST_PORT)]
MOST_MACHINES = 1000
MOST_PROCESSES = 64
MOST_CHANNELS = 32
_NUMBER = "{n}"
_WITH_CHANNELS = "plain", "bosch"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,31}")


class MachineTable(StrictModel):
    """One machine: `file` is its machine, system or card file; `doors` are ports by door, 0 for free ones.

    `channels` are lists of axes, for a plain or bosch control; the first one has the spindle. With `count` it is so
    many of them: `{n}` in a text is the number, which is put after a name without it; ports count up.
    """

    name: Annotated[
        str,
        Field(
            pattern=r"^(\{n\})?[A-Za-z0-9][A-Za-z0-9_.{}-]{0,31}$",
            description="up to 32 letters, digits, '_', '.' and '-', the first a letter or digit; {n} for its number",
        ),
    ]
    count: Annotated[int, Field(ge=1, le=MOST_MACHINES)] = 1
    controller: Literal["fanuc", "plain", "bosch", "apci", "imc"]
    file: str | None = None
    program: str | None = None
    faults: str | None = None
    scenario: str | None = None
    memory: str | None = None
    rate: Annotated[float, Field(ge=0.0, le=1000.0)] = 1.0
    axes: Annotated[int, Field(ge=1, le=6)] = 3
    channels: Annotated[tuple[tuple[str, ...], ...], Field(max_length=MOST_CHANNELS)] = ()
    doors: dict[str, Port] = Field(default_factory=dict)


class ServeFile(StrictModel):
    """Machines, and `doors` that all of them share (`http`, `opcua`).

    `opcua_nodesets` is a folder of node sets that `opcua` takes its types from. `processes` share the machines among
    them; the ports of shared doors count up from one process to the next. `metrics` is the port of their figures.
    """

    machine: Annotated[tuple[MachineTable, ...], Field(min_length=1, max_length=MOST_MACHINES)]
    doors: dict[str, Port] = Field(default_factory=dict)
    opcua_nodesets: str | None = None
    processes: Annotated[int, Field(ge=1, le=MOST_PROCESSES)] = 1
    metrics: Port | None = None


def load_serve_file(path: Path) -> ServeFile:
    """Read a file of machines.

    Raises:
        UsageError: It cannot be read, or says what cannot be.
    """
    said: ServeFile = validate(ServeFile, *load_toml(path))
    machines = tuple(one for each in said.machine for one in _each(each, path))
    if len(machines) > MOST_MACHINES:
        raise UsageError(
            f"{path}: {len(machines)} machines", hint=f"One file has up to {MOST_MACHINES}: write several."
        )
    if said.processes > len(machines):
        raise UsageError(
            f"{path}: {said.processes} processes for {len(machines)} machines",
            hint="Each process has to have a machine.",
        )
    if said.metrics is not None and said.processes == 1:
        raise UsageError(
            f"{path}: metrics without processes",
            hint="Say how many processes; one alone has /metrics at its door http.",
        )
    return said.model_copy(update={"machine": machines})


def _each(table: MachineTable, path: Path) -> Iterator[MachineTable]:
    """Give the machines that a table stands for.

    Raises:
        UsageError: They would have one memory, a name that is none, or channels that their kind has not.
    """
    several = table.count > 1
    if table.channels and table.controller not in _WITH_CHANNELS:
        raise UsageError(
            f"{path}: no channels for a machine of the kind {table.controller}",
            hint=f"Kinds that have channels are {', '.join(_WITH_CHANNELS)}.",
        )
    if several and table.memory is not None and _NUMBER not in table.memory:
        raise UsageError(
            f"{path}: {table.count} machines cannot share {table.memory}", hint="Write {n} into its name."
        )
    for number in range(1, table.count + 1):
        texts = {
            key: text.replace(_NUMBER, str(number))
            for key in ("name", "program", "faults", "scenario", "memory", "file")
            if (text := getattr(table, key)) is not None
        }
        if several and _NUMBER not in table.name:
            texts["name"] += str(number)
        if not _NAME.fullmatch(texts["name"]):
            raise UsageError(
                f"{path}: '{texts['name']}' is no name of a machine",
                hint="It has up to 32 letters, digits, dots, lines and dashes.",
            )
        doors = {door: port + number - 1 if port else 0 for door, port in table.doors.items()}
        if any(port > MOST_PORT for port in doors.values()):
            raise UsageError(f"{path}: the ports of {table.name} go beyond {MOST_PORT}", hint="Begin lower.")
        yield table.model_copy(update={**texts, "doors": doors, "count": 1})
