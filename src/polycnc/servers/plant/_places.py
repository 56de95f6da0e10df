"""What facts are of: the machine, its channels, axes and spindle, each with its place in a status."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.cnc import Status
from polycnc.servers.plant._facts import Scope


@dataclass(frozen=True, slots=True)
class Shape:
    """What a control is made of, which does not change: axes with their units, and the axes of each channel."""

    axes: tuple[tuple[str, str], ...]
    channels: tuple[tuple[str, ...], ...]


def shape_of(status: Status) -> Shape:
    """Return what a control is made of."""
    return Shape(
        tuple((axis.name, axis.unit) for axis in status.axes.values()),
        tuple(channel.axes for channel in status.channels),
    )


@dataclass(frozen=True, slots=True)
class Place:
    """One channel (by its number, from 0), axis (by its name), the spindle or the machine; `unit` is the axis' own."""

    scope: Scope
    number: int = 0
    name: str = ""
    unit: str = ""


def places(shape: Shape, scope: Scope) -> tuple[Place, ...]:
    """Return the places of a scope."""
    match scope:
        case Scope.CHANNEL:
            return tuple(Place(scope, number) for number in range(len(shape.channels)))
        case Scope.AXIS:
            return tuple(Place(scope, number, name, unit) for number, (name, unit) in enumerate(shape.axes))
        case _:
            return (Place(scope),)
