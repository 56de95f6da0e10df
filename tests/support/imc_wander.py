"""A walk over a card of six axes that writes to every parameter whatever its type can hold, beside what makes sense.

What a walk (`imc_walk`) does not know: upper bits, the other sign, flags by any number, more than two coordinates,
both path spaces alike, words written while what they are for is under way.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.core._parameters import PARAMETERS, Parameter, address
from support.imc_bench import Bench

IF, Q, P1, P2, C = lib.FIFO_SEL
ONE = 65536
AXES = 6
WANDER_FILE = """
number_of_axes = 6
[[axis]]
lag_s = 0.003
gain = 90.0
limit_positive = 900
[[axis]]
origin = [-400, 350]
low_when_on = ["limit_positive"]
limit_positive = 700
index = { first = 5, pitch = 23 }
[[axis]]
probe = { first = 11, pitch = 290 }
counts_per_pulse = 2.5
[[axis]]
lag_s = 0.002
gain = 120.0
[[axis]]
origin = [12, 4000]
limit_negative = -800
[[axis]]
index = { first = 3, pitch = 170 }
"""
# By type: what a careful program does not write.
ODD: dict[str, Sequence[float]] = {
    "F16": (0, -1, 1, 0x100, -0x8000),
    "U16": (0, 1, 3, 5, 300, 0x8001),
    "S16": (0, -1, 300, -0x7000),
    "R16": (0, -1, 0x1248, 0x0421, -0x7FFE, 0x80),
    "S32": (0, -7, 66000, -70001, 5_000_003, -(1 << 31) + 5, (1 << 31) - 7),
    "U32": (0, 70001, (1 << 31) + 3, (1 << 32) - 2),
    "S16.16": (0, 0.3, -0.7, 2.5, -4.25, 310.75, -20000.5, 32767.5),
    "U16.16": (0, 1, 0.625, 300.5, 40000.25),
    "S16.32": (0, 1.5, -0.375, 300.0625, -(2**-20)),
    "S48": (0, -1, 1 << 40, -(1 << 46) - 3),
}
# Words that would only put an end to everything, or that say what the card is.
LEFT_ALONE = {
    "run",
    "ena",
    "emstop",
    "clear",
    "clearimc",
    "naxis",
    "events",
    "clkdiv",
    "fwversion",
    "hwversion",
    "sysclk",
}
OF_AXES = [each for each in PARAMETERS.values() if each.scope == "A" and each.name not in LEFT_ALONE]
OF_CARD = [each for each in PARAMETERS.values() if each.scope == "G" and each.name not in LEFT_ALONE]
POINTERS = {
    "gearsrc": ("curvel", "encpvel", "mcsvel", "pcsvel", "encsvel", "user32b4"),
    "synsrc": ("curpos", "encp", "mcspos", "pcspos", "encs", "ticks", "user32b5"),
}
NUMBERS_OF_AXES = ("master", "synaxis", "segmap_", "group_")


def value_for(each: Parameter, r: random.Random) -> float:
    """Return a number for a parameter: one that its type holds, and mostly an axis or an address where one is meant."""
    if each.name in POINTERS and r.random() < 0.9:
        return address(r.choice(POINTERS[each.name]))
    if each.name.startswith(NUMBERS_OF_AXES) and r.random() < 0.95:
        return r.randrange(AXES)
    if each.name in ("groupnum", "pathaxisnum1", "pathaxisnum2"):
        return r.choice((0, 2, 3, 4, 6))
    return r.choice(ODD[each.type])


def odd(b: Bench, r: random.Random) -> None:
    """Write to any parameter, read-only ones too."""
    each = r.choice(OF_AXES if r.random() < 0.7 else OF_CARD)
    b.set_any(each, each.to_raw(value_for(each, r)), r.randrange(AXES), r.choice((IF, IF, IF, Q, P1, P2)))


def usual(b: Bench, r: random.Random) -> None:
    """Move something, in any of the ways."""
    axis, other, fifo = r.randrange(AXES), r.randrange(AXES), r.choice((IF, IF, Q, P1, P2))
    ratio, way, pace, speed = (
        r.choice((-0.625, 1.25, 3.5)),
        r.randint(-900, 900),
        r.randint(4, 40),
        r.randint(-9, 9) * ONE,
    )
    place = [r.randint(-400, 400) for _ in range(r.choice((2, 3, 4, 6)))]
    data = lib.PFIFOSegData.of(
        *place, center=(r.randint(-90, 90), r.randint(-90, 90)), direction=-r.randint(0, 1)
    )
    space = r.choice((P1, P2))
    r.choice((
        lambda: b.MoveAbsolute(way, axis, fifo),
        lambda: b.MoveRelative(way, axis, fifo),
        lambda: b.MoveSuperimposed(way, axis, fifo),
        lambda: b.MoveVelocity(speed + 777, axis, fifo),
        lambda: b.set(fifo, axis, **{r.choice(("mcsgo", "pcsgo")): 0}),
        lambda: b.set(fifo, axis, **{r.choice(("user16b0", "user32b9", "user48b4")): way}),
        lambda: b.set(fifo, axis, pcstgvel=speed / ONE),
        lambda: b.GearFree(ratio, other, r.randint(0, 4), axis, fifo),
        lambda: b.GearInDist(ratio, other, r.randint(0, 4), r.randrange(AXES), r.randint(0, 4), pace, axis, fifo),
        lambda: b.GearInTime(ratio, other, r.randint(0, 4), pace, axis, fifo),
        lambda: b.HandWheel(ratio, other, axis, fifo),
        lambda: b.MoveInTime(pace, way, axis, fifo),
        lambda: b.MoveInDist(pace, other, way, axis, fifo),
        lambda: b.TgvelInTime(pace, speed, axis, fifo),
        lambda: b.TgvelInDist(pace, other, speed, axis, fifo),
        lambda: b.HomeSwitch2(r.randint(0, 1), r.randint(0, 1), r.randint(0, 1), axis, fifo),
        lambda: b.HomeSwitchIndex3(r.randint(0, 1), r.randint(0, 1), r.randint(0, 1), axis, fifo),
        lambda: b.HomeIndex(r.randint(0, 1), r.randint(0, 1), axis, fifo),
        lambda: b.AddLineN(data, space),
        lambda: b.AddArcLine(data, space),
        lambda: b.AddLineNWithVel(lib.PFIFOSegInfo.of(7 * ONE, abs(speed) // 2, data), space),
        lambda: b.AddSpiral(40, -30, way, 20, 10, r.randint(0, 1), space),
        lambda: b.PutContourData([r.randint(-300, 300) for _ in range(12)], 12, r.choice((C, C, space))),
        lambda: b.set(r.choice((IF, Q)), axis, startsyn=-1, enasyn=-1),
        lambda: b.set(IF, axis, startsyn=-1),
        lambda: b.card.spin_handwheel(axis, r.choice((0, 2.25, -1.5))),
        lambda: b.card.set_input(r.randint(1, 32), bool(r.randint(0, 1))),
        lambda: b.card.touch_probe(axis),
        lambda: b.GetCapData(3, axis),
    ))()  # fmt: skip


def sound(b: Bench, axis: int) -> None:
    """Give an axis values that it can move with, and errors that are over."""
    b.set(
        IF, axis, error=0, run=-1, ena=-1, haltstep=0, vellim=32767, accellim=32767, smooth=axis, stopfilt=-1,
        exitfilt=0, mcsmaxvel=8.5, mcsaccel=0.75, mcsdecel=1.25, pcsmaxvel=3.5, pcsaccel=0.5, pcsdecel=0.625,
        poserrlim=65535, aioctr=0, encpfactor=1, ciraxis=0, highvel=6.5, lowvel=1.75, mcsvel=0, pcsvel=0,
    )  # fmt: skip


def wander(b: Bench, seed: int, acts: int) -> None:
    """Give so many commands, with some cycles after each."""
    r = random.Random(seed)
    for space in (1, 2):
        for k, letter in enumerate("xyzabc"):
            b.set(IF, **{f"segmap_{letter}{space}": (k * (5 if space == 2 else 1) + space) % AXES})
            b.set(IF, **{f"group_{letter}": (5 - k) % AXES})
    for act in range(acts):
        if act % 3 == 0:
            for axis in range(AXES):
                b.set(IF, axis, error=0)
        if act % 6 == 0:
            sound(b, act // 6 % AXES)
            b.set(IF, emstop=0, hpause=0, startpath1=-1, startpath2=1, groupsmooth=3)
            b.set(IF, pathacc1=0.75, pathacc2=1.5, segtgvel1=7, segtgvel2=4.5, feedrate1=1, feedrate2=0.75)
        (odd if r.random() < 0.35 else usual)(b, r)
        if r.random() < 0.8:
            b.leap(r.choice((1, 2, 3, 5, 9)))
    b.leap(5)
    b.ends = b.ends[49::50] + b.ends[-1:]
