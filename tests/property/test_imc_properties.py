"""The card under random traffic: the same compiled and not, nothing lost between coordinates, nothing breaks it."""

from __future__ import annotations

import hashlib
import os
import random
import subprocess
import sys

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.core._homing import home_sequence
from polycnc.controllers.imc.core._instructions import Segment, WaitParam, WaitTime, Write, WriteMany
from polycnc.controllers.imc.core._parameters import PARAMETERS, address
from support.imc_card import (
    FLAG,
    IFIFO,
    PFIFO1,
    PFIFO2,
    QFIFO,
    enable_path,
    event,
    install,
    ready_card,
    send,
    set_now,
    setting,
)
from support.often import share

PRINT_DIGEST = "from property.test_imc_properties import digest; print(digest())"
WORLD = """
number_of_axes = 6
[[axis]]
origin = [700.0, 900.0]
index = { first = 13.0, pitch = 250.0 }
[[axis]]
lag_s = 0.01
[[axis]]
counts_per_pulse = 1.7
probe = { first = 3.0, pitch = 40.0 }
[[axis]]
limit_positive = 3000.0
limit_negative = -3000.0
"""


def busy_card(seed: int) -> Card:
    """Return a card that does a bit of everything, with random numbers."""
    rng = random.Random(seed)
    card = ready_card(WORLD)
    set_now(card, ("smooth", 12, 1), ("encpctr", 0x400, 2), ("aioctr", 0xF, 3))
    homing = home_sequence(switch=True, index=True, negative=False, rising=True, go_to=True, returns=2)
    send(card, IFIFO, ("homeseq", homing), ("homestpos", 5), ("gohome", FLAG))
    send(card, IFIFO, ("mcstgvel", rng.uniform(-30, 30), 2), ("mcstgvel", rng.uniform(5, 30), 3))
    send(
        card,
        IFIFO,
        ("gearratio", rng.uniform(-3, 3), 4),
        ("gearsrc", 75, 4),
        ("master", 2, 4),
        ("engear", FLAG, 4),
    )
    enable_path(card, 1, 5)
    set_now(card, ("pathacc1", rng.uniform(0.1, 2)))
    for _ in range(6):
        ends = (rng.randint(-900, 900), rng.randint(-900, 900))
        center = (rng.randint(-500, 500), rng.randint(-500, 500)) if rng.random() < 0.5 else None
        speed = round(rng.uniform(3, 40) * 65536)
        card.push(PFIFO1, Segment(ends, center, rng.random() < 0.5, speed, rng.choice((0, speed))))
    install(
        card,
        event("ADD48", first=224, second=224, second_axis=4, target=337),
        event("SCA48i", first=337, constant=rng.getrandbits(40), target=340),
        event("CMP32i", first=225, first_axis=2, constant=rng.randint(-3000, 3000)),
        event("SET32", "Edge_GreatEqu", constant=rng.randint(-(2**20), 2**20), target=6, target_axis=2),
        event("ADD32i", "IF_Carry", first=317, constant=1, target=317),
        fifo=QFIFO,
    )
    card.push(QFIFO, WaitParam(address("homed"), 0xFFFF, 300))
    send(card, QFIFO, ("feedrate1", rng.uniform(0.2, 1.5)), ("pcsdist", 77, 1), ("pcsgo", FLAG, 1))
    return card


def digest() -> str:
    """Return a digest of the memories of some cards, on the way."""
    found = hashlib.sha256()
    for seed in range(2):
        card = busy_card(seed)
        for _ in range(8):
            card.advance(60)
            found.update(card.state.memory.tobytes())
            found.update(card.kernel.servo.actual.tobytes())
            found.update(card.state.capture.tobytes())
    return found.hexdigest()


def test_compiled_and_uncompiled_cards_are_the_same_to_the_last_bit() -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", PRINT_DIGEST],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == digest()


def test_a_card_advanced_in_pieces_is_the_same_as_in_one_go() -> None:
    one, many = busy_card(7), busy_card(7)
    one.advance(700)
    rng = random.Random(1)
    left = 700
    while left:
        left -= many.advance(min(left, rng.randint(1, 40)))
    assert (one.state.memory == many.state.memory).all()
    assert (one.kernel.servo.actual == many.kernel.servo.actual).all()


MOVES = st.lists(
    st.tuples(
        st.sampled_from(["mcstgpos", "mcsdist", "mcstgvel", "pcsdist", "pcstgvel", "stop", "hpause"]),
        st.integers(-3000, 3000),
        st.integers(1, 60),
    ),
    min_size=1,
    max_size=8,
)


@settings(deadline=None, max_examples=share(60))
@given(MOVES, st.integers(0, 40))
def test_what_both_systems_move_is_what_the_axis_moves(
    moves: list[tuple[str, int, int]], smooth: int
) -> None:
    card = ready_card(number_of_axes=1)
    set_now(card, ("smooth", smooth))
    total = 0
    for name, value, cycles in moves:
        if name == "stop":
            send(card, IFIFO, ("mcsgo", 0), ("pcsgo", 0))
        elif name == "hpause":
            send(card, IFIFO, ("hpause", FLAG if value > 0 else 0))
        elif name.endswith("tgvel"):
            send(card, IFIFO, (name, value / 64))
        else:
            card.push(IFIFO, WriteMany((setting(name, value), setting(name[:3] + "go", FLAG))))
        for _ in range(cycles):
            card.advance(1)
            total += card.read_raw(address("curvel"), 0, 2)
            assert card.read_raw(address("curpos") - 1, 0, 3) == total
            assert card.state.axis[0]["machine"] == total
    send(card, IFIFO, ("hpause", 0), ("mcstgvel", 0), ("pcstgvel", 0))
    card.wait()
    systems = [card.read_raw(address(name) - 1, 0, 3) for name in ("mcspos", "pcspos")]
    assert card.read_raw(address("curpos") - 1, 0, 3) == sum(systems)
    assert card.read("encp") == card.read("curpos")


def test_random_writes_break_nothing() -> None:
    """Nothing stops the cycle, and what is read-only or of no parameter keeps its meaning."""
    names = sorted(PARAMETERS)
    for seed in range(12):
        rng = random.Random(seed)
        card = ready_card(WORLD)
        for _ in range(60):
            for _ in range(10):
                each = PARAMETERS[rng.choice(names)]
                value = rng.choice((0, -1, 1, rng.getrandbits(16), rng.getrandbits(48), -rng.getrandbits(20)))
                words = rng.choice((1, 2, 3, each.words))
                at = min(each.address, 1024 - words)
                card.push(
                    rng.choice((IFIFO, QFIFO, PFIFO1, PFIFO2)), Write(at, value, rng.randrange(6), words)
                )
            if rng.random() < 0.3:
                ends = tuple(rng.randint(-(2**31), 2**31 - 1) for _ in range(rng.randint(2, 16)))
                center = (rng.randint(-(2**31), 2**31 - 1), 0) if rng.random() < 0.5 else None
                card.push(rng.choice((PFIFO1, PFIFO2)), Segment(ends, center, False, rng.getrandbits(31)))
            if rng.random() < 0.1:
                card.push(QFIFO, WaitTime(rng.randint(1, 5)))
            card.push_points([rng.getrandbits(16) for _ in range(6)])
            assert card.advance(rng.randint(1, 30)) > 0
        assert card.read("naxis") == 6
        flags = [card.read(name, i) for name in ("moving", "motion", "profiling") for i in range(6)]
        assert set(flags) <= {0, FLAG}
        assert np.isfinite(card.kernel.servo.actual).all()
