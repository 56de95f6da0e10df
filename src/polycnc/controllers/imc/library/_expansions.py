"""How the functions of motion are made of parameters: one table, a row for each function.

A function writes all its parameters with one instruction, so in one control cycle. Nowhere is it documented which ones;
where this table is wrong, it is corrected here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from polycnc.controllers.imc.core._homing import home_sequence
from polycnc.controllers.imc.core._instructions import Write, WriteMany
from polycnc.controllers.imc.core._parameters import address, parameter

FLAG = -1  # a flag that is set, FFFFh
GEAR_SOURCES = ("curvel", "encpvel", "mcsvel", "pcsvel", "encsvel")
SYNC_SOURCES = ("curpos", "encp", "mcspos", "pcspos", "encs")


@dataclass(frozen=True, slots=True)
class From:
    """A value made of arguments, and how to say so."""

    text: str
    make: Callable[[Mapping[str, Any]], int]


@dataclass(frozen=True, slots=True)
class Put:
    """Write a value, the argument of this name, or what is made of arguments, to a parameter of the axis."""

    name: str
    value: int | str | From

    def write(self, arguments: Mapping[str, Any]) -> Write:
        """Return the write for these arguments of a call."""
        target, value = parameter(self.name), self.value
        if isinstance(value, From):
            value = value.make(arguments)
        elif isinstance(value, str):
            value = int(arguments[value])
        return Write(target.address, value, int(arguments["axis"]), target.words)

    @property
    def text(self) -> str:
        """Return the write as a reader wants to see it."""
        value = self.value.text if isinstance(self.value, From) else self.value
        return f"{self.name} := {'FFFFh' if value == FLAG else value}"


Expansion: TypeAlias = tuple[Put, ...]


def _go_unless_zero(distance: str) -> From:
    """Return the start of a relative move; a distance of 0 stops instead, as it would mean an absolute move."""
    return From(f"FFFFh, 0 if {distance} is 0", lambda given: FLAG if given[distance] else 0)


def _source(argument: str, names: tuple[str, ...]) -> From:
    return From(f"address of {', '.join(names)} by {argument}", lambda given: address(names[given[argument]]))


def _address(name: str) -> From:
    return From(f"address of {name}", lambda given: address(name))


def _home(returns: int = 0, *, switch: bool = True, index: bool = False) -> Expansion:
    def sequence(given: Mapping[str, Any]) -> int:
        return home_sequence(
            switch=switch,
            index=index,
            negative=bool(given["direction"]),
            rising=bool(given.get("RiseEdge", 0)),
            go_to=bool(given["stop"]),
            returns=returns,
        )

    scheme = " + ".join(name for name, wanted in (("switch", switch), ("index", index)) if wanted)
    how = "direction, RiseEdge, stop" if switch else "direction, stop"
    return (Put("homeseq", From(f"{scheme}, {returns} returns, by {how}", sequence)), Put("gohome", FLAG))


def _gear(master: str, source: From) -> Expansion:
    return (
        Put("master", master),
        Put("gearsrc", source),
        Put("gearratio", From("ratio × 2³²", lambda given: round(given["ratio"] * (1 << 32)))),
        Put("syntype", 0),
    )


def _paced(source: From, axis: str | int, change: str) -> Expansion:
    return (Put("synsrc", source), Put("synaxis", axis), Put("synsrcvar", change))


_GEAR_SOURCE = _source("sourcetype", GEAR_SOURCES)
_WHEEL = _address("encsvel")
_BY_TIME = _address("ticks")
_BY_POSITION = _address("curpos")

EXPANSIONS: dict[str, Expansion] = {
    "IMC_MoveAbsolute": (Put("mcsdist", 0), Put("mcstgpos", "Pos"), Put("mcsgo", FLAG)),
    "IMC_MoveRelative": (Put("mcsdist", "dist"), Put("mcsgo", _go_unless_zero("dist"))),
    "IMC_MoveSuperimposed": (Put("pcsdist", "dist"), Put("pcsgo", _go_unless_zero("dist"))),
    "IMC_Phasing": (Put("pcsdist", "dist"), Put("pcsgo", _go_unless_zero("dist"))),
    "IMC_MoveVelocity": (Put("mcstgvel", "vel"),),
    "IMC_HomeSwitch1": _home(),
    "IMC_HomeSwitch2": _home(1),
    "IMC_HomeSwitch3": _home(2),
    "IMC_HomeSwitchIndex1": _home(index=True),
    "IMC_HomeSwitchIndex2": _home(1, index=True),
    "IMC_HomeSwitchIndex3": _home(2, index=True),
    "IMC_HomeIndex": _home(switch=False, index=True),
    "IMC_GearFree": (*_gear("master", _GEAR_SOURCE), Put("enasyn", 0), Put("engear", FLAG)),
    "IMC_GearInDist": (
        *_gear("master", _GEAR_SOURCE),
        *_paced(_source("synsourcetype", SYNC_SOURCES), "synaxis", "syndist"),
        Put("enasyn", FLAG),
        Put("engear", FLAG),
    ),
    "IMC_GearInTime": (
        *_gear("master", _GEAR_SOURCE),
        *_paced(_BY_TIME, 0, "syntime"),
        Put("enasyn", FLAG),
        Put("engear", FLAG),
    ),
    "IMC_HandWheel": (*_gear("encsaxis", _WHEEL), Put("enasyn", 0), Put("engear", FLAG)),
    "IMC_MoveInTime": (
        Put("syntype", FLAG),
        *_paced(_BY_TIME, 0, "time"),
        Put("slavedist", "movedist"),
        Put("slaveabs", 0),
        Put("enasyn", FLAG),
    ),
    "IMC_MoveInDist": (
        Put("syntype", FLAG),
        *_paced(_BY_POSITION, "refaxis", "refdist"),
        Put("slavedist", "movedist"),
        Put("slaveabs", 0),
    ),
    "IMC_TgvelInTime": (
        Put("syntype", 0),
        *_paced(_BY_TIME, 0, "time"),
        Put("mcstgvel", "tgvel"),
        Put("enasyn", FLAG),
    ),
    "IMC_TgvelInDist": (
        Put("syntype", 0),
        *_paced(_BY_POSITION, "refaxis", "refdist"),
        Put("mcstgvel", "tgvel"),
    ),
}
"""What each function writes to the axis that it is for, in this order."""


def expand(function: str, arguments: Mapping[str, Any]) -> WriteMany:
    """Return the instruction that a function sends for these arguments."""
    return WriteMany(tuple(put.write(arguments) for put in EXPANSIONS[function]))
