"""Any commands to one axis at any time: its flags say what is so, and its speed never jumps."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.imc import Card
from polycnc.controllers.imc.core import _ownership as own
from polycnc.controllers.imc.core._homing import home_sequence
from polycnc.controllers.imc.core._instructions import WriteMany
from polycnc.controllers.imc.core._parameters import address
from support.imc_card import FLAG, IFIFO, enable_path, line, ready_card, send, setting
from support.often import share

SLAVE = 1
GEAR = {"master": 0, "gearsrc": address("curvel"), "syntype": 0}
TICKS = {"synsrc": address("ticks"), "synaxis": 0}
HOME = home_sequence(switch=True, index=False, negative=False, rising=True, go_to=True)
CALLS = (
    {"mcstgpos": 900, "mcsgo": FLAG},
    {"mcsdist": -333, "mcsgo": FLAG},
    {"mcsgo": 0},
    {"mcstgvel": 4},
    {"mcstgvel": -2.5},
    {"mcstgvel": 0},
    {"homeseq": HOME, "gohome": FLAG},
    {"gohome": 0},
    {**GEAR, "gearratio": 0.3, "enasyn": 0, "engear": FLAG},
    {**GEAR, "gearratio": -0.6, **TICKS, "synsrcvar": 37, "enasyn": FLAG, "engear": FLAG},
    {"engear": 0},
    {"syntype": FLAG, **TICKS, "synsrcvar": 211, "slavedist": 157, "slaveabs": 0, "enasyn": FLAG},
    {"syntype": 0, **TICKS, "synsrcvar": 53, "mcstgvel": 3, "enasyn": FLAG},
    {"startsyn": FLAG},
    {"startsyn": 0},
    {"enasyn": 0},
    {"pcsdist": 41, "pcsgo": FLAG},
    {"run": 0},
    {"run": FLAG},
)
STEPS = st.lists(st.tuples(st.sampled_from([*range(len(CALLS)), -1]), st.integers(1, 60)), max_size=14)
RATE = 1.0  # mcsaccel and mcsdecel
SYNCHRONOUS_RATE = 1.2  # that the motions above have beside them at most


def give(card: Card, call: int) -> None:
    if call < 0:
        card.write("startpath1", FLAG)
        line(card, 250, speed=4)
        return
    writes = (setting(name, value, SLAVE) for name, value in CALLS[call].items())
    assert card.push(IFIFO, WriteMany(tuple(writes)))


def check(card: Card) -> None:
    """Hold the flags to what the axis does."""
    owner, axis = own.owner_of(card.state, SLAVE), card.state.axis[SLAVE]
    if axis["commands"]:  # kept for the cycle after a path
        return
    geared = owner in (own.ENGAGING, own.ENGAGED)
    runs = owner in (own.ENGAGING, own.SYNCHRONOUS)
    shown = {
        name: card.read(name, SLAVE) != 0 for name in ("engear", "gohome", "startsyn", "enasyn", "mcsgo")
    }
    assert shown["engear"] == (geared or bool(axis["waits"])), owner
    assert shown["gohome"] == (owner == own.HOMES)
    assert shown["mcsgo"] == (owner == own.MOVES or (owner == own.HOMES and shown["mcsgo"]))
    assert runs == bool(axis["sync_share"] >= 0.0)
    if shown["startsyn"]:
        assert runs or (axis["prepared"] and not shown["enasyn"])
    if runs or axis["waits"]:
        assert shown["enasyn"]
    assert (card.read("moving", SLAVE) != 0) >= (card.read("curvel", SLAVE) != 0)


@settings(max_examples=share(60))
@given(STEPS)
def test_flags_say_what_an_axis_does_and_its_speed_never_jumps(steps: list[tuple[int, int]]) -> None:
    card = ready_card("[[axis]]\n[[axis]]\norigin = [700.0, 760.0]\n")
    enable_path(card, SLAVE)
    send(card, IFIFO, ("mcstgvel", 5, 0))
    card.advance(20)
    speed, path = 0.0, False
    for call, cycles in steps:
        path = path or call < 0
        stopped = call == 17
        give(card, call)
        for _ in range(cycles):
            card.advance(1)
            check(card)
            now = card.read("mcsvel", SLAVE)
            if not stopped and not path:
                assert abs(now - speed) <= RATE + SYNCHRONOUS_RATE
            speed, stopped = now, False
    assert card.read("error", SLAVE) in ((0, 0x1000) if path else (0,))  # a segment out of run
