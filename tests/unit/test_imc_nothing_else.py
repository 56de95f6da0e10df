"""What a command changes on a card at rest, and that it changes nothing else, in any parameter of any axis."""

from __future__ import annotations

from typing import TypeAlias

import pytest

from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.core._instructions import WaitTime
from polycnc.controllers.imc.core._parameters import PARAMETERS
from support.imc_card import (
    FLAG,
    QFIFO,
    event,
    install,
    move_absolute,
    move_relative,
    ready_card,
    set_now,
    setting,
)

Seen: TypeAlias = dict[tuple[str, int], int]
AXIS, CARD = 1, -1
TIME = {"ticks", "qwaittime"}


def seen(card: Card) -> Seen:
    """Return every parameter but those that count time, as integers; those of the card belong to `CARD`."""
    rows = [
        (each, CARD if each.scope == "G" else i) for each in PARAMETERS.values() for i in range(card.axes)
    ]
    return {
        (each.name, row): card.read_raw(each.address, max(row, 0), each.words)
        for each, row in rows
        if each.name not in TIME
    }


def rich_card() -> Card:
    """Return a card at rest of which nearly everything is something."""
    card = ready_card("number_of_axes = 3\n")
    for i in range(3):
        set_now(card, ("breakp", -5000, i), ("stopfilt", 0, i), ("encpctr", 0x400, i), ("homepos", 25 + i, i))
        set_now(card, ("gearoutvel", 3, i), ("mcstgvel", 0, i), ("aiod", 77, i), ("shiftmaster", FLAG, i))
        card.turn_handwheel(i, 70 + i)
        move_absolute(card, 700 + i, i)
        card.advance(5)
        card.touch_probe(i)
        card.wait()
        move_relative(card, 50 + i, i, system="pcs")
        card.wait()
        set_now(card, ("capture", FLAG, i), ("error", 0xA00 + i, i))
        card.state.memory[i, PARAMETERS["aiolat"].address] = 5
    set_now(
        card,
        ("startgroup", FLAG),
        ("startpath1", FLAG),
        ("startpath2", FLAG),
        ("user32b3", -70_000),
        ("gio", 0x5A),
    )
    set_now(card, ("emstop", 0x20), ("hpause", 3), ("segtgvel2", 4.5), ("groupnum", 2), ("group_y", 1))
    install(card, event("CMP32i", first=PARAMETERS["user32b3"].address, constant=5))
    card.push(QFIFO, WaitTime(0))
    card.push(QFIFO, setting("user16b2", 9))
    card.advance(3)
    return card


PLACES = ("curpos", "mcspos", "mcstgpos", "encp")
ALL = range(3)
# What is written, and what it makes of each parameter that it changes.
CHANGES: dict[str, tuple[list[tuple[str, float]], dict[tuple[str, int], int]]] = {
    "clear": (
        [("clear", FLAG)],
        {(name, AXIS): 0 for name in (*PLACES, "pcspos", "pcstgpos", "encs", "error", "aiolat", "clraiolat")}
        | {(name, CARD): 0 for name in ("emstop", "hpause", "events")},
    ),
    "sethome": (
        [("sethome", FLAG)],
        {(name, AXIS): 26 for name in PLACES} | {("pcspos", AXIS): 0, ("homed", AXIS): FLAG},
    ),
    "capture": (
        [("capture", FLAG)],
        {(name, AXIS): 3 for name in ("capfifocnt", "clrcapfifo")},
    ),
    "popcapfifo": (
        [("popcapfifo", FLAG)],
        {(name, AXIS): 1 for name in ("capfifocnt", "clrcapfifo")} | {("capfifo", AXIS): 752},
    ),
    "clrcapfifo": (
        [("clrcapfifo", 0)],
        {(name, AXIS): 0 for name in ("capfifocnt", "clrcapfifo", "capfifo")},
    ),
    "clrencs": ([("clrencs", FLAG)], {("encs", AXIS): 0}),
    "clraiolat": ([("clraiolat", 4)], {(name, AXIS): 1 for name in ("aiolat", "clraiolat")}),
    "counter": ([("counter", 9)], {("counter", AXIS): 0}),
    "run": ([("run", 0)], {("run", AXIS): 0}),
    "ena": ([("ena", 0)], {("ena", AXIS): 0}),
    "error": ([("error", 0)], {("error", AXIS): 0x20}),  # from emstop, every cycle
    "hpause": ([("hpause", 0)], {("hpause", CARD): 0}),
    "events": ([("events", 0)], {("events", CARD): 0}),
    "emstop": (
        [("emstop", 0x30)],
        {(name, i): 0 for name in ("run", "ena") for i in ALL}
        | {("error", i): 0xA30 + i for i in ALL}
        | {(name, CARD): 0 for name in ("startgroup", "startpath1", "startpath2")}
        | {("emstop", CARD): 0x30},
    ),
    "clrqfifo": ([("clrqfifo", FLAG)], {(name, CARD): 0 for name in ("clrqfifo", "qfifocnt")}),
    "clrPFIFO1": ([("clrPFIFO1", FLAG)], {}),
    "clearimc": ([("clearimc", FLAG)], {(name, CARD): 0 for name in ("clrqfifo", "qfifocnt")}),
    "nothing to end": (
        [
            (name, 0)
            for name in ("mcsgo", "pcsgo", "mcstgvel", "gohome", "engear", "startsyn", "enasyn", "haltstep")
        ],
        {},
    ),
}


@pytest.mark.covers(
    *(f"imc.param.{name}" for name in ("clear", "sethome", "capture", "run", "ena", "error", "hpause", "events")),
    *(f"imc.param.{name}" for name in ("emstop", "clrqfifo", "clraiolat", "clrencs", "aiolat", "encs", "homepos")),
    *(f"imc.param.{name}" for name in ("mcsgo", "pcsgo", "mcstgvel", "gohome", "engear", "startsyn", "enasyn")),
    "imc.concept.capfifo", "imc.IMC_ClearFIFO", "imc.concept.fifo_independence",
)  # fmt: skip
def test_a_command_changes_what_it_is_for_and_nothing_else() -> None:
    rich = rich_card()
    start = rich.snapshot()
    for name, (writes, changes) in CHANGES.items():
        rich.restore(start)
        before = seen(rich)
        set_now(
            rich, *((what, value, 0 if PARAMETERS[what].scope == "G" else AXIS) for what, value in writes)
        )
        rich.advance(2)
        after = seen(rich)
        changed = {key: value for key, value in after.items() if before[key] != value}
        assert {key: value & 0xFFFFFFFF for key, value in changed.items()} == {
            key: value & 0xFFFFFFFF for key, value in changes.items()
        }, name
