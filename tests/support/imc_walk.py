"""A program that gives a card commands of all kinds in an order that nobody would think of, the same for a seed."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import TypeAlias

from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.core._parameters import address
from support.imc_bench import Bench

IF, Q, P1, P2, C = lib.FIFO_SEL
ONE = 65536
AXES = 4
OTHERWISE = 'scale_factor = "S16.16"\noverflow = "wrap"\ndelay_unit = "ms"\n'
CARD_FILE = """
[[axis]]
lag_s = 0.004
gain = 80.0
limit_positive = 140
limit_negative = -150
counts_per_pulse = 1.5
origin = [31, 57]
index = { first = 3, pitch = 17 }
[[axis]]
origin = [-60, -22]
low_when_on = ["origin", "limit_negative"]
limit_negative = -170
index = { first = 5, pitch = 23 }
parameters = { encpfactor = 0.75, smooth = 3 }
[[axis]]
probe = { first = 11, pitch = 29 }
parameters = { ciraxis = -1, cirpos = 97, encpctr = 1024 }
[[axis]]
probe = { first = 30 }
lag_s = 0.002
gain = 120.0
origin = [12, 40]
parameters = { pathabs = 0 }
"""
# What is written to an axis, and the values that it is given.
AXIS_VALUES: dict[str, Sequence[float]] = {
    "mcsgo": (0,), "pcsgo": (0,), "pcstgvel": (0, 0, 1.75, -2.5), "mcsvel": (0, 1.25), "mcstrack": (0, 0, -1),
    "pcstrack": (0, -1), "mcstgpos": (-35, 44, 90), "pcstgpos": (-12, 21), "mcsmaxvel": (3.5, 8.25, 100, 0),
    "mcsaccel": (0.4, 0.9, 2.5), "mcsdecel": (0.3, 1.1, 3, 0), "pcsmaxvel": (2.5, 50), "pcsaccel": (0.6, 2, 0),
    "pcsdecel": (0.7, 1.5), "smooth": (0, 0, 3, 7), "gearratio": (-1.5, 0.625, 2.25), "gearoutmod": (0, -1),
    "gearoutvel": (0, -2.25, 3), "shiftmaster": (0, -1), "haltstep": (0, 0, 0, 1), "haltmode": (0, -1),
    "biciraxis": (0, -1), "cirpos": (61, 97, 0), "ciraxis": (0, -1), "run": (0, -1, -1), "ena": (0, -1, -1),
    "homepos": (0, -19, 33, 2147483600, -2147483620), "sethome": (-1,), "clear": (-1,), "engear": (0, 0, -1),
    "startsyn": (-1, -1, -1, 0), "enasyn": (-1, -1, 0), "gohome": (0, 0, -1), "slaveabs": (0, -1), "syntype": (0, -1),
    "slavedist": (40, -55), "synsrcvar": (9, 26, 0), "homeseq": (0, 0x14), "aioctr": (0, 0xF, 0x1F, 0xC01A),
    "psoftlim": (75, 40), "nsoftlim": (-70, -40), "stopfilt": (0xFFFF, 0xFFFF, 0x10F1, 0), "stopmode": (0, 0xFFFF, 5),
    "exitfilt": (0, 0, 0x1001, 8), "error": (0, 0, 0x40), "breakp": (20, -30), "settlewin": (0, 3), "settlen": (1, 8),
    "trackwin": (2, 9), "encpfactor": (1, 0.5), "encsfactor": (1, 1.75, 60000), "encpctr": (0, 0x400, 0x8000),
    "vellim": (6, 3000, 3000), "accellim": (2, 3000, 3000), "poserrlim": (12, 65535, 65535), "highvel": (2.5, 5),
    "lowvel": (0.75, -1.5), "indexNum": (1, 2), "homestpos": (7, -16), "counter": (0,), "capture": (-1,),
    "clrencs": (-1,), "clraiolat": (5, -1), "popcapfifo": (-1,), "clrcapfifo": (0,), "pathabs": (0, -1),
    "cirswap": (0,), "aio": (0x5A5A,),
}  # fmt: skip
CARD_VALUES: dict[str, Sequence[float]] = {
    "hpause": (0, 0, 0, 1), "timer": (40,), "delayus": (30000,), "events": (0,), "clrqfifo": (-1,),
    "clrPFIFO1": (-1,), "clrPFIFO2": (-1,), "clrCFIFO": (-1,), "clearimc": (-1,), "qwaittime": (0, 5),
    "pwaittime1": (0,), "pwaittime2": (0, 4), "emstop": (0x10, 0x21), "startgroup": (0, -1, -1), "groupnum": (1, 2),
    "groupsmooth": (1, 3, 4), "group_x": (1, 3), "group_y": (0, 2), "startpath1": (0, -1, -1),
    "startpath2": (0, -1, -1), "feedrate1": (0, 0.5, 1, 1.25), "feedrate2": (0, 0.75, 1), "pathacc1": (0.5, 2),
    "pathacc2": (0.8, 1.5), "segendvel2": (0, 1.25), "asseglen2": (0, 1), "segtgvel1": (3, 6.5),
    "segtgvel2": (2.25, 5), "segendvel1": (0, 1.5), "asseglen1": (0, 1, 2), "segmap_x1": (0, 2, 9),
    "segmap_y1": (1, 3), "segmap_x2": (2, 1), "segmap_y2": (3, 0), "pathaxisnum1": (0, 0, 2, 4),
    "pathaxisnum2": (0, 2, 1), "gin1lat": (1, 0xFF), "user16b1": (4, 9),
}  # fmt: skip
Act: TypeAlias = Callable[[Bench, random.Random, int], object]


def speed(r: random.Random) -> int:
    """Return a velocity, sometimes 0."""
    return r.choice((0, r.randint(-6 * ONE, 6 * ONE)))


def chosen(r: random.Random, values: Sequence[float]) -> float:
    """Return one of some values; what is set by FFFFh is sometimes set by another number."""
    value = r.choice(values)
    return r.choice((-1, -1, 1, 0x300)) if value == -1 else value


def segment(r: random.Random, arc: bool = False) -> lib.PFIFOSegData:
    """Return a segment of two axes, sometimes of another number."""
    ends = [r.randint(-60, 60) for _ in range(r.choice((2, 2, 2, 1, 3, 4)) if not arc else 2)]
    return lib.PFIFOSegData.of(*ends, center=(r.randint(-9, 9), r.randint(-9, 9)), direction=-r.randint(0, 1))


def event(r: random.Random) -> lib.EventInfo:
    """Return an event that counts, compares or starts something."""
    command = r.choice((lib.CMD_ADD32i, lib.CMD_CMP32i, lib.CMD_SET16, lib.CMD_COP32, lib.CMD_SCA32i))
    if command == lib.CMD_SET16:
        name = r.choice(("startsyn", "mcsgo", "user16b2", "gohome", "engear"))
        dest, constant = (address(name), r.randrange(AXES)), -1
    else:
        dest, constant = (
            (address(r.choice(("user32b1", "user32b2", "mcstgvel"))), r.randrange(AXES)),
            r.randint(-9, 70),
        )
    first = (address(r.choice(("curpos", "user32b1", "encp", "ticks"))), r.randrange(AXES))
    second = first if command == lib.CMD_COP32 else constant
    return lib.EventInfo.of(command, r.choice(list(lib.IMC_EventType)), src1=first, src2=second, dest=dest)


def home(b: Bench, r: random.Random, axis: int) -> None:
    """Search the origin in one of the ways."""
    way = r.choice(
        (
            b.HomeSwitch1,
            b.HomeSwitch2,
            b.HomeSwitch3,
            b.HomeSwitchIndex1,
            b.HomeSwitchIndex2,
            b.HomeSwitchIndex3,
        )
    )
    if r.random() < 0.2:
        b.HomeIndex(r.randint(0, 1), r.randint(0, 1), axis, IF)
    else:
        way(r.randint(0, 1), r.randint(0, 1), r.randint(0, 1), axis, IF)


def couple(b: Bench, r: random.Random, axis: int) -> None:
    """Set up a gear or a synchronous motion."""
    other, source, pace = r.randrange(AXES), r.randint(0, 4), r.randint(5, 30)
    ratio = r.choice((-1.25, 0.5, 1.75))
    r.choice((
        lambda: b.GearFree(ratio, other, source, axis, IF),
        lambda: b.GearInDist(ratio, other, source, r.randrange(AXES), r.randint(0, 4), pace, axis, IF),
        lambda: b.GearInTime(ratio, other, source, pace, axis, IF),
        lambda: b.HandWheel(ratio, other, axis, IF),
        lambda: b.MoveInTime(pace, r.randint(-50, 50), axis, IF),
        lambda: b.MoveInDist(pace, other, r.randint(-50, 50), axis, IF),
        lambda: b.TgvelInTime(pace, speed(r), axis, IF),
        lambda: b.TgvelInDist(pace, other, speed(r), axis, IF),
    ))()  # fmt: skip


def path(b: Bench, r: random.Random, axis: int) -> None:
    """Add something to a path or to the contour."""
    space = r.choice((P1, P2))
    r.choice((
        lambda: b.AddLineN(segment(r), space),
        lambda: b.AddLineNWithVel(lib.PFIFOSegInfo.of(r.randint(1, 7) * ONE, r.randint(0, 5) * ONE, segment(r)), space),
        lambda: b.AddArcLine(segment(r, arc=True), space),
        lambda: b.AddArcWithVel(4 * ONE, ONE, *(r.randint(-30, 30) for _ in range(4)), r.randint(0, 1), space),
        lambda: b.PutContourData([r.randint(-25, 25) for _ in range(4)], 4, r.choice((space, C, C, C))),
        lambda: b.WaitParam(address("user16b1"), 9, 7, 0, space),
    ))()  # fmt: skip


def move(b: Bench, r: random.Random, axis: int) -> None:
    """Move an axis, from one of the queues."""
    queue = r.choice((IF, IF, Q, Q, P1))
    r.choice((
        lambda: b.MoveAbsolute(r.randint(-130, 130), axis, queue),
        lambda: b.MoveRelative(r.choice((0, r.randint(-99, 99))), axis, queue),
        lambda: b.MoveSuperimposed(r.randint(-40, 40), axis, queue),
        lambda: b.set(queue, axis, pcstgvel=r.choice((0, 2.25, -3.5, 1))),
        lambda: b.MoveVelocity(speed(r), axis, queue),
        lambda: b.MoveVelocity(speed(r), axis, queue),
    ))()  # fmt: skip


def write(b: Bench, r: random.Random, axis: int) -> None:
    """Write some parameters of an axis in one cycle, and one of the card."""
    for name in r.sample(list(AXIS_VALUES), r.choice((1, 1, 2))):
        b.set(r.choice((IF, IF, IF, Q)), axis, **{name: chosen(r, AXIS_VALUES[name])})
    if r.random() < 0.4:
        name = r.choice(list(CARD_VALUES))
        b.set(r.choice((IF, IF, Q)), 0, **{name: chosen(r, CARD_VALUES[name])})


def other(b: Bench, r: random.Random, axis: int) -> None:
    """Do what is neither motion nor a write: waits, bits, events, captures, hands on the machine."""
    r.choice((
        lambda: b.WaitTime(r.randint(1, 6), Q),
        lambda: b.WaitParamBit(address("moving"), 0, 0, r.randint(5, 20), axis, Q),
        lambda: b.WaitParamMask(address("error"), 0x1F, 1, 6, axis, Q),
        lambda: b.SetParamBit(address("stopfilt"), r.randint(0, 15), r.randint(0, 1), axis, IF),
        lambda: b.ORXORParam(address("user16b4"), r.randint(0, 65535), r.randint(0, 65535), 0, Q),
        lambda: b.TurnParamBit(address("stopmode"), r.randint(0, 3), axis, IF),
        lambda: b.InstallEvent([event(r), event(r)], 2, r.choice((IF, Q))),
        lambda: b.set(IF, events=0),
        lambda: b.ClearFIFO(r.choice((IF, Q, P1, P2, C))),
        lambda: b.set(IF, axis, error=r.choice((0x40, 0x80, 1, 10))),
        lambda: b.GetCapData(2, axis),
        lambda: b.card.touch_probe(axis),
        lambda: b.card.turn_handwheel(axis, r.randint(-20, 20)),
        lambda: b.card.spin_handwheel(axis, r.choice((0, 1.25, -0.75))),
        lambda: b.card.set_input(r.randint(1, 32), bool(r.randint(0, 1))),
    ))()  # fmt: skip


def repair(b: Bench, axis: int) -> None:
    """Make an axis ready again."""
    b.set(IF, emstop=0)
    b.set(IF, axis, error=0, ena=-1, run=-1, haltstep=0)


def walk(b: Bench, seed: int, acts: int) -> None:
    """Give so many commands, with some cycles after each."""
    r = random.Random(seed)
    b.set(
        IF,
        segmap_x1=0,
        segmap_y1=1,
        segmap_z1=2,
        segmap_a1=3,
        segmap_x2=2,
        segmap_y2=3,
        startpath1=-1,
        startpath2=-1,
        group_y=2,
    )
    for _ in range(acts):
        axis = r.randrange(AXES)
        for each in range(AXES):
            if r.random() < 0.12:
                repair(b, each)
        act: Act = r.choice((move, move, write, write, write, home, couple, couple, path, path, other))
        act(b, r, axis)
        if r.random() < 0.7:
            b.leap(r.choice((1, 2, 3, 5, 9)))
    b.leap(5)
    b.ends = b.ends[49::50] + b.ends[-1:]
