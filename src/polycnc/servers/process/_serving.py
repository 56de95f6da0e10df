"""Serve machines: make them, open their doors, say where they are, and let time pass until somebody ends it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from polycnc.cnc import Control
from polycnc.errors import UsageError
from polycnc.machine import Device, Wall
from polycnc.servers.machines import (
    Door,
    DoorKind,
    Keeper,
    Log,
    Made,
    Scenario,
    ServedDevice,
    ServedMachine,
    Turns,
    Wanted,
    take_all_files,
    tell_errors,
)
from polycnc.servers.process._kinds import KINDS
from polycnc.servers.process._machinery import Machinery

_SHARE_S = 0.01  # of the wall clock that all machines together may take before a door answers
_LEAST_SHARE_S = 0.002  # of one machine: more than what it does at once costs
_APART_S, _MOST_APART_S = 0.1, 5.0  # the beginnings of two machines, and of the first and the last
_CLOSE_S = 0.6  # that doors have to end their connections
_MOST_PROGRAM_BYTES = 64 << 20


@dataclass(frozen=True, slots=True)
class MachineWanted:
    """A machine that is to be served; `program` runs again and again, `scenario` makes what happens to the device.

    `story` makes what happens to the machine and its doors, once it is made.
    """

    kind: str
    machinery: Machinery = field(default_factory=Machinery)
    program: Path | None = None
    rate: float = 1.0
    scenario: Callable[[Device[Any]], Scenario[Any]] | None = None
    doors: tuple[tuple[DoorKind, Wanted], ...] = ()
    story: Callable[[ServedMachine, Log], Scenario[Any]] | None = None


@dataclass(slots=True)
class Serving:
    """Machines with their doors, in the running event loop; `open` and then `run`, and `close` in any case."""

    wall: Wall
    log: Log
    on_late: Callable[[float], None]
    on_error: Callable[[str], None] = lambda text: None
    machines: list[ServedMachine] = field(default_factory=list)
    doors: list[tuple[str, Door, Sequence[ServedMachine]]] = field(default_factory=list)
    """Each with the machines that it serves."""
    programs: dict[str, tuple[str, bytes]] = field(default_factory=dict)
    """Name and content of what each machine runs, until it has been started."""
    told: set[str] = field(default_factory=set)
    """Kinds of errors that `on_error` has been told of, once each."""

    async def open(
        self, wanted: Sequence[MachineWanted], shared: Sequence[tuple[DoorKind, Wanted]] = ()
    ) -> None:
        """Make the machines and open all doors.

        Raises:
            UsageError: A machine cannot be made, or a door cannot be opened; `close` closes the others.
        """
        tell_errors(asyncio.get_running_loop(), self._tell)
        take_all_files()
        turns = Turns(self.wall)
        for each in wanted:
            self._make(each, max(_SHARE_S / len(wanted), _LEAST_SHARE_S), turns)
        asked = [(kind, at, [self._of(each)]) for each in wanted for kind, at in each.doors]
        asked += [
            (kind, at, list(filter(kind.serves, self.machines)) or self.machines) for kind, at in shared
        ]
        for kind, at, machines in asked:
            if not all(map(kind.serves, machines)):
                raise UsageError(
                    f"{kind.name} does not serve a machine of the kind {machines[0].kind}",
                    hint=f"It serves {', '.join(sorted(kind.controllers))}.",
                )
            door = kind.open_door(machines, at)
            await door.start()
            self.doors.append((kind.name, door, machines))
            for machine in machines:
                machine.doors[kind.name] = door
            self.log.write("open", door=kind.name, address=door.said)

    async def begin(self) -> None:
        """Start the programs and let time begin; what has to be compiled is compiled here.

        Machines begin one after the other: what happens in all of them after the same time does not happen at once.
        """
        await self.start_programs()
        for machine in self.machines:
            await asyncio.sleep(0)  # whoever wants it to end does not wait for the others
            machine.served.advance(1)
        loop = asyncio.get_running_loop()
        apart_s = min(_APART_S, _MOST_APART_S / max(1, len(self.machines)))
        for number, machine in enumerate(self.machines):
            loop.call_later(number * apart_s, machine.keeper.start)

    async def start_programs(self) -> None:
        """Start the programs, without letting time pass."""
        for machine in self.machines:
            if (found := self.programs.pop(machine.name, None)) is not None:
                assert machine.load is not None
                assert machine.served.again is not None
                machine.load(*found)
                machine.served.again()

    async def run(self) -> None:
        """Serve until the time of a machine cannot pass any more, or this is cancelled."""
        failed = [machine.keeper.failed for machine in self.machines]
        await asyncio.wait(failed, return_when=asyncio.FIRST_COMPLETED)
        for each in failed:
            if each.done():
                each.result()

    async def close(self) -> None:
        """Close every door, all at once, and switch the machines off; a door that takes its time is not waited for."""
        tell_errors(asyncio.get_running_loop(), lambda kind, text: self.log.write(kind, text=text))
        closing = [asyncio.ensure_future(door.close()) for _, door, _ in self.doors]
        if closing:
            await asyncio.wait(closing, timeout=_CLOSE_S)
        for machine in self.machines:
            machine.close()
        self.log.write("end")
        self.log.close()

    def _tell(self, kind: str, text: str) -> None:
        self.log.write(kind, text=text)
        if kind not in self.told:
            self.told.add(kind)
            self.on_error(text)

    def _of(self, wanted: MachineWanted) -> ServedMachine:
        return next(each for each in self.machines if each.name == wanted.machinery.name)

    def _make(self, wanted: MachineWanted, share_s: float, turns: Turns) -> None:
        name = wanted.machinery.name
        if any(each.name == name for each in self.machines):
            raise UsageError(f"two machines are called {name}", hint="Give each a name of its own.")
        if wanted.kind not in KINDS:
            raise UsageError(f"there is no kind '{wanted.kind}'", hint=f"Kinds are {', '.join(KINDS)}.")
        made = KINDS[wanted.kind](wanted.machinery)
        if wanted.program is not None:
            if made.load is None:
                made.end()
                raise UsageError(
                    f"machine {name} runs no part programs", hint="Leave the program out, or serve another."
                )
            try:
                self.programs[name] = (wanted.program.name, _read(wanted.program))
            except UsageError:
                made.end()
                raise
        served: ServedDevice[Any] = ServedDevice(
            made.device,
            made.find_control,
            None if wanted.scenario is None else wanted.scenario(made.device),
            again=None if wanted.program is None else _again(made),
        )
        keeper = Keeper(
            served, self.wall, rate=wanted.rate, share_s=share_s, on_late=self.on_late, turns=turns
        )
        machine = ServedMachine(**made.all(), name=name, kind=wanted.kind, served=served, keeper=keeper)
        self.machines.append(machine)
        if wanted.story is not None:
            served.follow(wanted.story(machine, self.log))


def _again(made: Made) -> Callable[[], None]:
    own = made.own.get("cycle_start")
    assert made.find_control is not None
    find: Callable[[], Control] = made.find_control

    def again() -> None:
        if own is None:
            find().cycle_start()
        else:
            own(step="run", line=1, channel=0)

    return again


def _read(path: Path) -> bytes:
    """Return what a program file holds."""
    try:
        if path.stat().st_size > _MOST_PROGRAM_BYTES:
            raise UsageError(
                f"{path}: larger than {_MOST_PROGRAM_BYTES >> 20} MB", hint="Serve a smaller one."
            )
        return path.read_bytes()
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}", hint="Name a program file.") from None
