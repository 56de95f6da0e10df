"""Time the iMC card: 16 axes with 128 events, two gears and a running path space, and instructions that are pushed."""

from __future__ import annotations

import statistics
import time

from _measure import Figure, at_least
from _report import run_script
from polycnc.controllers.imc.card._card import Card, Fifo
from polycnc.controllers.imc.card._config import CardConfig
from polycnc.controllers.imc.core._event_codes import LOAD_MOST, EventCommand, EventType
from polycnc.controllers.imc.core._instructions import Event, InstallEvents, Segment, Write
from polycnc.controllers.imc.core._parameters import address

RUNS = 3
AXES = 16
EVENTS = 128
CYCLES = 100_000
PUSHES = 10_000
SPEED = 65536  # 1 pulse/ms


def _events() -> list[Event]:
    cell, flag, position = address("user32b0"), address("user16b0"), address("curpos")
    each = [
        Event(EventCommand.CMD_CMP32i, EventType.IMC_Allways, position, constant=10_000),
        Event(EventCommand.CMD_SET16, EventType.IMC_Edge_Great, constant=-1, target=flag),
        Event(EventCommand.CMD_ADD32i, EventType.IMC_Allways, cell, constant=1, target=cell),
        Event(EventCommand.CMD_AND16i, EventType.IMC_IF_NotZero, flag, constant=0xFF, target=flag),
    ]
    return each * (EVENTS // len(each))


def busy_card() -> Card:
    """Return a card with everything at work: a path of three axes, two gears on it, the other axes at a velocity."""
    card = Card(CardConfig(ready=True, number_of_axes=AXES))
    events = _events()
    for first in range(0, EVENTS, LOAD_MOST):
        card.push(Fifo.SEL_QFIFO, InstallEvents(tuple(events[first : first + LOAD_MOST])))
    card.advance(10)
    for slave in (4, 5):
        for name, value in (("gearratio", 0.3), ("gearsrc", address("curvel")), ("engear", -1)):
            card.write(name, value, slave)
    for k, name in enumerate("xyz"):
        card.write(f"segmap_{name}1", k)
    card.write("startpath1", -1)
    for k in range(20):
        end = 30_000 * (k + 1 & 1)
        card.push(Fifo.SEL_PFIFO1, Segment((end, end, 10_000), speed=SPEED))
    for axis in range(6, AXES):
        card.write("mcstgvel", 10.0, axis)
    card.advance(100)
    return card


def run_rate(card: Card) -> float:
    """Return card seconds per processor second."""
    begin = time.process_time()
    card.advance(CYCLES)
    spent = time.process_time() - begin
    assert card.read("pathmoving1"), "the path space ran empty"
    assert card.read("events") == EVENTS
    return CYCLES * 0.001 / spent


def push_rate() -> float:
    """Return writes pushed per processor second."""
    card = Card(CardConfig(ready=True, number_of_axes=1))
    write = Write(address("user32b0"), 5, 0, 2)
    spent = 0.0
    for _ in range(PUSHES // 100):
        begin = time.process_time()
        for _ in range(100):
            card.push(Fifo.SEL_IFIFO, write)
        spent += time.process_time() - begin
        card.advance(1)
    return PUSHES / spent


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    runs = 1 if quick else RUNS
    rates = [run_rate(busy_card()) for _ in range(runs)]
    pushed = [push_rate() for _ in range(runs)]
    return [
        at_least("16 axes, 128 events, 2 gears, a path", statistics.median(rates), "x real", 500.0),
        at_least("writes pushed from Python", statistics.median(pushed), "1/s", 100_000.0),
    ]


if __name__ == "__main__":
    run_script("iMC card", figures)
