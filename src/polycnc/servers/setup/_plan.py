"""Turn flags, or a file, into machines and doors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from polycnc.errors import UsageError, did_you_mean
from polycnc.machine import Device
from polycnc.servers.focas import Faults, load_faults, load_profile
from polycnc.servers.machines import LOOPBACK, DoorKind, Log, Scenario, ServedMachine, Wanted
from polycnc.servers.mtconnect import USUAL_VERSION, VERSIONS
from polycnc.servers.process import DOORS, Machinery, MachineWanted, focas_kind, plant_kinds
from polycnc.servers.scenarios import Story, load_script
from polycnc.servers.setup._file import MachineTable, ServeFile, load_serve_file

_MOST_PORT = 65535
_MOST_TOKEN_BYTES = 4096
_LEAST_TOKEN = 16


@dataclass(frozen=True, slots=True)
class Flags:
    """What was said on the command line; of `kinds`, None was not asked for, "" has no machine file."""

    file: Path | None
    kinds: Mapping[str, str | Path | None]
    profile: str = "31i"
    port: int = 8193
    addresses: tuple[str, ...] = (LOOPBACK,)
    doors: str | None = None
    expose: str | None = None
    token: Path | None = None
    insecure: str | None = None
    log: Path | None = None
    program: Path | None = None
    axes: int = 3
    characters: int | None = None
    rate: float = 1.0
    memory: Path | None = None
    faults: Path | None = None
    mtconnect: str = USUAL_VERSION
    node_sets: Path | None = None
    scenario: Path | None = None
    part: str | None = None


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be served, what the user is warned of, and why opening the doors lasts."""

    machines: tuple[MachineWanted, ...]
    shared: tuple[tuple[DoorKind, Wanted], ...]
    log: Log
    warnings: tuple[str, ...] = ()
    processes: int = 1
    """Among how many the machines are to be shared; what this plan says is all of them then."""
    metrics: int | None = None

    @property
    def lasting(self) -> tuple[str, ...]:
        """Return why opening the doors takes seconds; nothing where it does not."""
        doors = [*self.shared, *(door for each in self.machines for door in each.doors)]
        return tuple(dict.fromkeys(row.lasts for row, _ in doors if row.lasts))


def doors_of(text: str, table: Mapping[str, DoorKind], kind: str) -> list[tuple[DoorKind, Wanted]]:
    """Return the doors of a list like `focas=0,http`; `all` are all that serve this kind of machine.

    Raises:
        UsageError: There is no such door, one is named twice, or its port is none.
    """
    made: list[tuple[DoorKind, Wanted]] = []
    for word in filter(None, map(str.strip, text.split(","))):
        name, _, at = word.partition("=")
        if name == "all" and not at:
            made += [
                (row, Wanted()) for row in table.values() if not row.controllers or kind in row.controllers
            ]
            continue
        if name not in table:
            raise UsageError(
                f"there is no door '{name[:40]}'",
                hint=f"{did_you_mean(name, table)}Doors are {', '.join(table)}, all.",
            )
        made.append((table[name], _at(name, at)))
    names = [row.name for row, _ in made]
    if twice := [name for name in names if names.count(name) > 1]:
        raise UsageError(f"the door {twice[0]} is named twice", hint="Name each once.")
    if not made:
        raise UsageError(
            "no door is named", hint=f"{did_you_mean(name, table)}Doors are {', '.join(table)}, all."
        )
    return made


def _at(name: str, at: str) -> Wanted:
    if not at:
        return Wanted()
    if at.isascii() and at.isdigit():
        if len(at) > 5 or int(at) > _MOST_PORT:
            raise UsageError(f"{name}: there is no port {at[:20]}", hint=f"Give 0 to {_MOST_PORT}.")
        return Wanted(port=int(at))
    return Wanted(path=at)


def check_version(version: str) -> None:
    """Refuse a version of MTConnect that is not served.

    Raises:
        UsageError: It is none.
    """
    if version not in VERSIONS:
        raise UsageError(
            f"there is no version '{version[:20]}' of MTConnect", hint=f"Versions are {', '.join(VERSIONS)}."
        )


def plan_of(flags: Flags) -> Plan:
    """Return what is to be served.

    Raises:
        UsageError: It is not said what, or it cannot be.
    """
    load_profile(flags.profile)
    check_version(flags.mtconnect)
    rows = (focas_kind(flags.profile), *plant_kinds(flags.mtconnect))
    table = {**DOORS, **{row.name: row for row in rows}}
    machines, shared, node_sets, said = _asked(flags, table)
    keep = next(
        (_kept(each.machinery.memory) for each in machines if each.machinery.memory is not None), None
    )
    token = None if flags.token is None else _token(flags.token)
    insecure = frozenset(filter(None, (flags.insecure or "").split(",")))
    if unknown := insecure - set(table):
        raise UsageError(f"there is no door '{sorted(unknown)[0]}'", hint=f"Doors are {', '.join(table)}.")
    log = Log(flags.log)
    warnings: dict[str, None] = {}

    def exposed(row: DoorKind, wanted: Wanted) -> tuple[DoorKind, Wanted]:
        wanted = replace(
            wanted, log=log, token=token if row.knows_token else None, keep=keep, node_sets=node_sets
        )
        if flags.expose is None:
            return row, wanted
        if row.knows_token and token is None:
            raise UsageError(
                f"{row.name} is not exposed without a secret", hint="Name a file of one with --token."
            )
        if not row.knows_token and row.name not in insecure:
            return row, wanted
        if not row.knows_token:
            does = "command" if row.commands else "read"
            warnings[
                f"{row.name} on {flags.expose} knows no passwords: whoever reaches it can {does} the machine"
            ] = None
        return row, replace(wanted, address=flags.expose)

    return Plan(
        tuple(replace(each, doors=tuple(exposed(*door) for door in each.doors)) for each in machines),
        tuple(exposed(*door) for door in shared),
        log,
        tuple(warnings),
        1 if said is None or flags.part is not None else said.processes,
        None if said is None else said.metrics,
    )


def _asked(
    flags: Flags, table: Mapping[str, DoorKind]
) -> tuple[list[MachineWanted], list[tuple[DoorKind, Wanted]], Path | None, ServeFile | None]:
    """Return the machines, the doors that they share, the folder of node sets, and the file that says so."""
    named = [kind for kind, machine in flags.kinds.items() if machine is not None]
    if flags.file is None:
        if len(named) > 1:
            raise UsageError(
                f"{' and '.join(f'--{kind}' for kind in named)} at once",
                hint="Serve several machines from a file of machines.",
            )
        if not named:
            raise UsageError(
                "which machine shall be served?", hint="Write --fanuc, --plain mill3, or a file of machines."
            )
        return *_of_flags(flags, named[0], table), flags.node_sets, None
    if named:
        if named == ["fanuc"] and flags.file.suffix != ".toml":
            raise UsageError(
                f"--fanuc takes no machine, but '{flags.file}' is given",
                hint="Leave it out: --axes says how many axes the control has, --profile which series it is.",
            )
        raise UsageError("a file and a machine at once", hint="Put the machine into the file.")
    for key, given in (("opcua_nodesets", flags.node_sets), ("scenario", flags.scenario)):
        if given is not None:
            raise UsageError(
                f"{given} and a file of machines at once", hint=f'Write {key} = "..." into the file.'
            )
    return _of_file(flags.file, table, flags.part)


def _of_flags(
    flags: Flags, kind: str, table: Mapping[str, DoorKind]
) -> tuple[list[MachineWanted], list[tuple[DoorKind, Wanted]]]:
    doors = doors_of(flags.doors or ("focas" if kind == "fanuc" else "http"), table, kind)
    own = [(row, at if at.port is not None else replace(at, port=flags.port))
           if row.name == "focas" else (row, at) for row, at in doors if not row.shared]  # fmt: skip
    several = len(flags.addresses) > 1
    characters = flags.characters or load_profile(flags.profile).program_characters
    machines = [
        MachineWanted(
            kind,
            Machinery(
                f"machine{number}" if several else "machine",
                flags.kinds[kind] or None,
                flags.memory,
                flags.axes,
                characters,
            ),
            flags.program,
            flags.rate,
            _scenario(flags.faults, kind),
            tuple((row, replace(at, address=address)) for row, at in own),
            _story(flags.scenario, flags.faults),
        )
        for number, address in enumerate(flags.addresses, 1)
    ]
    return machines, [door for door in doors if door[0].shared]


def _of_file(
    path: Path, table: Mapping[str, DoorKind], part: str | None
) -> tuple[list[MachineWanted], list[tuple[DoorKind, Wanted]], Path | None, ServeFile]:
    said = load_serve_file(path)
    number = 0 if part is None else _number_of(part, said.processes)
    machines, count = [], len(said.machine)
    first, last = (
        (0, count)
        if part is None
        else (count * number // said.processes, count * (number + 1) // said.processes)
    )
    for each in said.machine[first:last]:
        doors = [_row(table, name, port, shared=False) for name, port in each.doors.items()]
        machines.append(
            MachineWanted(
                each.controller,
                Machinery(
                    each.name,
                    _file_of(each, path),
                    _beside(path, each.memory),
                    each.axes,
                    channels=each.channels,
                ),
                _beside(path, each.program),
                each.rate,
                _scenario(_beside(path, each.faults), each.controller),
                tuple(doors),
                _story(_beside(path, each.scenario), _beside(path, each.faults)),
            )
        )
    shared = [
        _row(table, name, port + number if port else 0, shared=True) for name, port in said.doors.items()
    ]
    return machines, shared, _beside(path, said.opcua_nodesets), said


def _number_of(part: str, processes: int) -> int:
    """Return which process of a fleet this is, from 0."""
    number, _, of = part.partition("/")
    if not (number.isdigit() and of == str(processes) and 1 <= int(number) <= processes):
        raise UsageError(f"{part[:20]} is no part of {processes} processes", hint="Leave --part out.")
    return int(number) - 1


def _kept(memory: Path) -> Path:
    """Return the folder beside a machine's memory in which doors keep theirs."""
    return memory.with_name(f"{memory.name}.doors")


def _row(table: Mapping[str, DoorKind], name: str, port: int, *, shared: bool) -> tuple[DoorKind, Wanted]:
    fitting = [row.name for row in table.values() if row.shared is shared]
    if name not in fitting:
        place = "that all machines share" if shared else "of one machine"
        raise UsageError(f"there is no door '{name[:40]}' {place}", hint=f"Such are {', '.join(fitting)}.")
    return table[name], Wanted(port=port)


def _beside(path: Path, name: str | None) -> Path | None:
    return None if name is None else path.parent / name


def _file_of(table: MachineTable, path: Path) -> str | Path | None:
    """Return a machine's file: beside the file of machines if there is one, else the name of a preset."""
    if table.file is None:
        return None
    found = path.parent / table.file
    return found if found.exists() or table.controller in ("apci", "imc") else table.file


def _scenario(path: Path | None, kind: str) -> Callable[[Device[Any]], Scenario[Any]] | None:
    if path is None:
        return None
    if kind != "fanuc":
        raise UsageError(f"no script of faults for a machine of the kind {kind}", hint="Serve a fanuc.")
    script = load_faults(path)
    return lambda device: Faults(script, device.clock.now_s)


def _story(path: Path | None, faults: Path | None) -> Callable[[ServedMachine, Log], Scenario[Any]] | None:
    if path is None:
        return None
    if faults is not None:
        raise UsageError(
            "a scenario and a script of faults at once", hint="Write the faults as steps of the scenario."
        )
    script = load_script(path)
    return lambda machine, log: Story(script, machine, log)


def _token(path: Path) -> str:
    try:
        content = path.read_bytes()[:_MOST_TOKEN_BYTES].decode("ascii").strip()
    except (OSError, UnicodeDecodeError):
        raise UsageError(f"{path}: no secret can be read", hint="Write one line of ASCII into it.") from None
    if len(content) < _LEAST_TOKEN or not content.isprintable() or " " in content:
        raise UsageError(
            f"{path}: this secret is too short", hint=f"Write {_LEAST_TOKEN} or more characters, no blanks."
        )
    return content
