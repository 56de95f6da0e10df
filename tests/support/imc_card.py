"""Short ways to say what a program sends to the card, for tests."""

from __future__ import annotations

from typing import Any

import pytest

from polycnc.controllers.imc.card._card import Card, Fifo
from polycnc.controllers.imc.card._config import CardConfig, parse_card
from polycnc.controllers.imc.core._event_codes import EventCommand, EventType
from polycnc.controllers.imc.core._instructions import (
    Event,
    InstallEvents,
    Segment,
    WaitParam,
    Write,
    WriteMany,
)
from polycnc.controllers.imc.core._parameters import address, parameter

IFIFO, QFIFO, PFIFO1, PFIFO2 = Fifo.SEL_IFIFO, Fifo.SEL_QFIFO, Fifo.SEL_PFIFO1, Fifo.SEL_PFIFO2
FLAG = -1


def shows(names: str) -> pytest.MarkDecorator:
    """Return the claim of a test that it notices when one of these parameters does not do what it should."""
    return pytest.mark.covers(*(f"imc.param.{name}" for name in names.split()))


def ready_card(text: str = "", **given: Any) -> Card:
    """Return a card whose axes are enabled, in run and have speeds; `text` is more of its card file."""
    return Card(parse_card("ready = true\n" + text) if text else CardConfig(ready=True, **given))


def setting(name: str, value: float, axis: int = 0) -> Write:
    """Return the instruction that writes a parameter by name, in its units."""
    each = parameter(name)
    return Write(each.address, each.to_raw(value), axis, each.words)


def send(card: Card, fifo: int, *settings: tuple[str, float] | tuple[str, float, int]) -> None:
    """Push one write for each setting."""
    for each in settings:
        assert card.push(fifo, setting(*each))


def set_now(card: Card, *settings: tuple[str, float] | tuple[str, float, int]) -> None:
    """Write settings between two cycles."""
    for name, value, *axis in settings:
        card.write(name, value, *axis)


def move_absolute(card: Card, position: int, axis: int = 0, fifo: int = IFIFO) -> None:
    """Push the two writes of an absolute move as one instruction."""
    assert card.push(fifo, WriteMany((setting("mcstgpos", position, axis), setting("mcsgo", FLAG, axis))))


def move_relative(card: Card, distance: int, axis: int = 0, fifo: int = IFIFO, system: str = "mcs") -> None:
    """Push the two writes of a relative move as one instruction."""
    writes = (setting(f"{system}dist", distance, axis), setting(f"{system}go", FLAG, axis))
    assert card.push(fifo, WriteMany(writes))


def wait_for(card: Card, fifo: int, name: str, data: int, axis: int = 0, timeout: int = 0) -> None:
    """Push a wait for a parameter to have a value."""
    assert card.push(fifo, WaitParam(address(name), data, timeout, axis))


def enable_path(card: Card, *axes: int, space: int = 1) -> None:
    """Enable a path space and map axes to its coordinates in order."""
    for coordinate, axis in zip("xyzabcdefghijklm", axes, strict=False):
        card.write(f"segmap_{coordinate}{space}", axis)
    card.write(f"startpath{space}", FLAG)


def line(card: Card, *ends: int, speed: float | None = None, end_speed: float = 0.0, space: int = 1) -> None:
    """Push a straight segment."""
    raw = None if speed is None else round(speed * 65536)
    assert card.push(PFIFO1 + space - 1, Segment(ends, speed=raw, end_speed=round(end_speed * 65536)))


def event(command: str, kind: str = "Allways", **operands: int) -> Event:
    """Return an event; operands are those of `Event`."""
    return Event(EventCommand[f"CMD_{command}"], EventType[f"IMC_{kind}"], **operands)


def install(card: Card, *events: Event, fifo: int = IFIFO) -> None:
    """Push one load of events."""
    assert card.push(fifo, InstallEvents(events))


def trace(card: Card, name: str, cycles: int, axis: int = 0) -> list[float]:
    """Return the values of a parameter after each of so many cycles."""
    values = []
    for _ in range(cycles):
        card.advance(1)
        values.append(card.read(name, axis))
    return values
