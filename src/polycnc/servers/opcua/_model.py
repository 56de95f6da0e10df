"""How a model is described: types with members, enumerations, units; each member says how it is read and written."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from polycnc.servers.opcua._moment import At
from polycnc.servers.plant import Seen

CNC = "http://opcfoundation.org/UA/CNC"
DI = "http://opcfoundation.org/UA/DI/"
MACHINERY = "http://opcfoundation.org/UA/Machinery/"
MACHINE_TOOL = "http://opcfoundation.org/UA/MachineTool/"
SPACES = (CNC, DI, MACHINERY, MACHINE_TOOL)
"""The namespaces of the types; the base namespace is ""."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: its UNECE code (Recommendation 20), its sign and its name."""

    code: str
    sign: str
    name: str

    @property
    def number(self) -> int:
        """The number that OPC UA gives a code: its ASCII bytes, the first one highest (OPC 10000-8, 5.6.3)."""
        return int.from_bytes(self.code.encode("ascii"), "big")


UNITS: Mapping[str, Unit] = {
    "mm": Unit("MMT", "mm", "millimetre"),
    "deg": Unit("DD", "°", "degree"),
    "mm/min": Unit("H81", "mm/min", "millimetre per minute"),
    "%": Unit("P1", "%", "percent"),
    "rpm": Unit("RPM", "r/min", "revolutions per minute"),
    "W": Unit("WTT", "W", "watt"),
    "N·m": Unit("NU", "N·m", "newton metre"),
}

OF_AXIS = "axis"
"""The unit or range of a member that has those of its axis; `axis X` names one."""
UNLIMITED = (-1e6, 1e6)
PERCENT = (0.0, 100.0)
COMPONENT, ADD_IN, ORDERED = 47, 17604, 49
"""How an object hangs on another one: HasComponent, HasAddIn, HasOrderedComponent."""
Span = tuple[float, float] | str
"""The range of a value; the name of what has it (`Fixed.spans`), where it depends on the machine."""


@dataclass(frozen=True, slots=True)
class Member:
    """A variable of a type: `data` is its data type, `read` gives its value, None where the machine knows none.

    `number` is its node in its type (0: no number of its own). A member with a `unit` has an EURange, `span`. `write`
    turns a value into a command, for those that may be written; `low` and `high` bound what is written.
    """

    name: str
    data: str
    read: Callable[[At], Any] | None
    number: int = 0
    unit: str = ""
    span: Span = UNLIMITED
    prop: bool = False
    array: bool = False
    optional: bool = False
    space: str | None = None
    write: Callable[[At, Any], Mapping[str, Any] | None] | None = None


@dataclass(frozen=True, slots=True)
class Type:
    """An object type; `base` is another one, or the number of one of the base namespace."""

    name: str
    space: str
    number: int
    base: Type | int = 58
    members: tuple[Member, ...] = ()
    abstract: bool = False

    @property
    def all_members(self) -> tuple[Member, ...]:
        """Its members and those of the types that it stands on, theirs first."""
        inherited = self.base.all_members if isinstance(self.base, Type) else ()
        return (*inherited, *self.members)


@dataclass(frozen=True, slots=True)
class Enumeration:
    """An enumeration: its words from 0."""

    name: str
    space: str
    number: int
    words: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Item:
    """An object of a machine: its path from the machine's own place, its type, and what it is about.

    `about` is an axis, a tool or the object's name. `by` is the reference that it hangs by. `space` is the namespace of
    its name, None that of the machines.
    """

    path: str
    type: Type
    channel: int = 0
    about: str = ""
    space: str | None = None
    by: int = COMPONENT

    @property
    def name(self) -> str:
        """The last part of its path."""
        return self.path.rpartition("/")[2]


@dataclass(frozen=True, slots=True)
class Listing:
    """A list whose objects come and go: its path, the names of its objects now, and what each consists of."""

    path: str
    names: Callable[[Seen], tuple[str, ...]]
    items: Callable[[str], tuple[Item, ...]]
