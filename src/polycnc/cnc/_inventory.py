"""What of a control changes seldom, frozen, with a revision for each part; what changes with time is in its status."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from polycnc.cnc._alarms import PastAlarm
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._frozen import FrozenDict, row
from polycnc.cnc._program_memory import ProgramEntry
from polycnc.cnc._tables import Tool
from polycnc.machine import MachineConfig


@row
class Identity(NamedTuple):
    """Which control it is: the name of its machine, its serial number, the dialect of its programs."""

    machine: str
    serial_number: str
    dialect: str


@row
class AxisLimits(NamedTuple):
    """What an axis may do, in its `unit` (mm or deg) and per second; None is no limit.

    `low` and `high` are the software limits, `home` is the reference position.
    """

    name: str
    unit: str
    low: float | None
    high: float | None
    home: float
    most_speed: float
    most_acceleration: float


@row
class PastMessage(NamedTuple):
    """A message to the operator that was shown; `time` is the machine's date and time, as ISO text."""

    number: int
    text: str
    time: str


@row
class SetBreakpoint(NamedTuple):
    """Where a channel stops besides: a line of a program (0: every one), perhaps only where a condition is true."""

    channel: int
    program: str
    line: int
    conditional: bool


@row
class Inventory(NamedTuple):
    """What changes seldom; `revisions` has a number for each part, which grows when that part changes."""

    revisions: Mapping[str, int]
    identity: Identity
    axes: tuple[AxisLimits, ...]
    programs: tuple[ProgramEntry, ...]
    tools: Mapping[int, Tool]
    offsets: Mapping[str, Mapping[str, float]]
    alarms: tuple[PastAlarm, ...]
    messages: tuple[PastMessage, ...]
    breakpoints: tuple[SetBreakpoint, ...]


PARTS = Inventory._fields[1:]
"""The names of the parts, as `Inventory.revisions` has them."""


class InventoryReader:
    """Read the inventory of the control that is made of these parts; a part that has not changed is not read again."""

    def __init__(self, of: ControlParts) -> None:
        self._of = of
        self._revisions = dict.fromkeys(PARTS, 0)
        self._seen: dict[str, object] = {}
        self._read: dict[str, Any] = {}
        self._whole: Inventory | None = None

    def read(self) -> Inventory:
        """Return the inventory as it is now; the same object until something of it changes."""
        of = self._of
        states: dict[str, object] = {
            "identity": (of.machine.config.name, of.data.serial_number, of.dialect.name),
            "axes": of.machine.config.axes,
            "programs": of.programs.revision,
            "tools": of.tools.revision,
            "offsets": of.offsets.revision,
            "alarms": of.alarms.revision,
            "messages": of.messages.revision,
            "breakpoints": tuple(channel.breakpoints for channel in of.channels),
        }
        changed = [name for name, state in states.items() if self._seen.get(name) != state]
        if changed or self._whole is None:
            for name in changed:
                self._seen[name] = states[name]
                self._read[name] = _READINGS[name](of)
                self._revisions[name] += 1
            self._whole = Inventory(FrozenDict(self._revisions), **self._read)
        return self._whole


def _axes(config: MachineConfig) -> tuple[AxisLimits, ...]:
    return tuple(
        AxisLimits(axis.name, axis.unit, _finite(low), _finite(high), axis.home, axis.vmax, axis.amax)
        for axis in config.axes
        for low, high in (axis.soft_limits,)
    )


def _finite(value: float) -> float | None:
    return value if abs(value) != float("inf") else None


def _breakpoints(of: ControlParts) -> tuple[SetBreakpoint, ...]:
    return tuple(
        sorted(
            SetBreakpoint(channel.path, each.program, each.line, each.condition is not None)
            for channel in of.channels
            for each in channel.breakpoints
        )
    )


_READINGS: dict[str, Callable[[ControlParts], object]] = {
    "identity": lambda of: Identity(of.machine.config.name, of.data.serial_number, of.dialect.name),
    "axes": lambda of: _axes(of.machine.config),
    "programs": lambda of: of.programs.directory(),
    "tools": lambda of: FrozenDict(of.tools),
    "offsets": lambda of: FrozenDict({name: FrozenDict(values) for name, values in of.offsets.items()}),
    "alarms": lambda of: of.alarms.history(),
    "messages": lambda of: tuple(PastMessage(*each) for each in of.messages.history()),
    "breakpoints": _breakpoints,
}
