"""A served machine: one device, who lets its time pass, its control, and what its operator does in its own way."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Protocol, TypeVar

from polycnc.cnc import Control
from polycnc.errors import PolycncError
from polycnc.machine import Device
from polycnc.servers.machines._owner import Keeper
from polycnc.servers.machines._programs import MemoryPrograms, Programs
from polycnc.servers.machines._scenario import ServedDevice
from polycnc.servers.machines._screens import Screen, Tasks
from polycnc.servers.machines._values import NO_PARAMETERS, NO_SIGNALS, NO_VARIABLES, Values

R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class Treatment:
    """How a door treats a request: `drop` ends the connection instead, `delay_s` answers later."""

    drop: bool = False
    delay_s: float = 0.0


AS_USUAL = Treatment()


def _as_usual(_: str) -> Treatment:
    return AS_USUAL


class OpenDoor(Protocol):
    """A door to a machine, as others see it."""

    @property
    def said(self) -> str:
        """Where it is, as users write it: a URL or host:port; known after `start`."""

    @property
    def clients(self) -> list[str]:
        """The addresses of the clients that are connected now."""


class MachineError(PolycncError):
    """A machine whose time cannot pass any more."""


@dataclass(slots=True)
class Made:
    """A device with its control and what its operator does in its own way.

    `find_control` returns the control within the device, None for a device without one. `own` are commands that the
    device carries out itself, by their names, in place of its control. `end` switches the device off and keeps its
    memory. `load` takes the name and bytes of a file over and selects the program; None where no part programs run.
    `programs` are None where they are those of the control's memory as they come. `folder` is where the control keeps
    its programs as files, if it does.
    """

    device: Device[Any]
    find_control: Callable[[], Control] | None = None
    own: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    end: Callable[[], None] = lambda: None
    load: Callable[[str, bytes], None] | None = None
    parameters: Values = NO_PARAMETERS
    variables: Values = NO_VARIABLES
    signals: Values = NO_SIGNALS
    screen: Screen | None = None
    tasks: Tasks | None = None
    programs: Programs | None = None
    folder: Path | None = None

    def all(self) -> dict[str, Any]:
        """Return its parts by their names."""
        return {each.name: getattr(self, each.name) for each in fields(Made)}


@dataclass(slots=True, kw_only=True)
class ServedMachine(Made):
    """One device with a name; what its doors need of it. `kind` is the controller ("fanuc", "plain", ...)."""

    name: str
    kind: str
    served: ServedDevice[Any]
    keeper: Keeper
    treat: Callable[[str], Treatment] = _as_usual
    """A door tells its name with every request, and does with it what is said."""

    doors: dict[str, OpenDoor] = field(default_factory=dict)
    """The doors to it by name, those that it shares with others among them."""

    def __post_init__(self) -> None:
        if self.programs is None and self.find_control is not None:
            self.programs = MemoryPrograms(self.find_control)

    @property
    def parts(self) -> list[str]:
        """What it has of what only some machines have."""
        has = {
            "control": self.control is not None,
            "path": self.control is not None and self.control.dialect.language != "cpl",
            "parameters": self.parameters is not NO_PARAMETERS,
            "variables": self.variables is not NO_VARIABLES,
            "signals": self.signals is not NO_SIGNALS,
            "screen": self.screen is not None,
            "tasks": self.tasks is not None,
        }
        return [name for name, there in has.items() if there]

    @property
    def control(self) -> Control | None:
        """The control within the device; None for a device without one."""
        return None if self.find_control is None else self.find_control()

    @property
    def is_usual(self) -> bool:
        """Whether its doors treat every request as usual."""
        return self.treat is _as_usual

    def treat_as_usual(self) -> None:
        """Treat every request as usual again."""
        self.treat = _as_usual

    async def ask(self, question: Callable[[], R]) -> R:
        """Ask between two cycles, after what is due, and return the answer.

        Raises:
            MachineError: The machine's time cannot pass any more.
            PolycncError: What `question` raises.
        """
        return self.ask_at_once(question)

    def ask_at_once(self, question: Callable[[], R]) -> R:
        """Do what `ask` does, for those who cannot wait.

        Raises:
            MachineError: The machine's time cannot pass any more.
            PolycncError: What `question` raises.
        """
        found: list[R | PolycncError] = []

        def asked() -> R | PolycncError:
            try:
                return question()
            except PolycncError as error:
                return error

        if not self.keeper.submit(asked, found.append):
            raise MachineError(f"machine {self.name} has failed", hint="Start the server anew.")
        result = found[0]
        if isinstance(result, PolycncError):
            raise result
        return result

    def close(self) -> None:
        """Let no more time pass and switch off."""
        self.keeper.close()
        self.end()


def machines_of_path(machines: Iterable[ServedMachine], path: str) -> list[ServedMachine]:
    """Return the machines that a path of a URL names; all, if it names none."""
    names, every = path.split("/"), list(machines)
    return [each for each in every if each.name in names] or every


def treatment_of(machines: Iterable[ServedMachine], door: str) -> Treatment:
    """Count a request of a door at these machines, after what is due, and say how it is to be treated."""
    found: list[Treatment] = []
    for machine in machines:
        if not machine.is_usual:
            machine.keeper.submit(lambda machine=machine: machine.treat(door), found.append)  # type: ignore[misc]
    return Treatment(any(each.drop for each in found), max((each.delay_s for each in found), default=0.0))
