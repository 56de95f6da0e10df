"""What a card does with each function of the library, every word of it, in `tests/golden/imc/NAME.txt`.

The numbers themselves are asserted from the manual elsewhere; here nothing can change unseen, on any axis, in either
path space, in any word. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from itertools import cycle
from pathlib import Path

import pytest

from polycnc.conformance import State, load_conformance
from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.core._parameters import PARAMETERS, address
from support.imc_bench import Bench
from support.imc_flags import SCENES as FLAGS
from support.imc_walk import CARD_FILE, OTHERWISE, walk
from support.imc_wander import WANDER_FILE, wander

RECORDED = Path(__file__).parents[1] / "golden" / "imc"
IF, Q, P1, P2, C = lib.FIFO_SEL
ONE = 65536
CELLS = [f"user{width}b{k}" for width, count in ((16, 10), (32, 10), (48, 5)) for k in range(count)]
CELLS.remove("user16b3")  # a queue waits for it
SCENES: dict[str, tuple[str, Callable[[Bench], None]]] = {}


def scene(system: str) -> Callable[[Callable[[Bench], None]], Callable[[Bench], None]]:
    """Make a function a scene of a card."""

    def add(act: Callable[[Bench], None]) -> Callable[[Bench], None]:
        SCENES[act.__name__] = ("ready = true\n" + system, act)
        return act

    return add


MACHINE = """
fwversion = 391
hwversion = 33107
[[axis]]
lag_s = 0.004
gain = 70.0
counts_per_pulse = 1.25
parameters = { mcsmaxvel = 9.5, mcsaccel = 0.75, mcsdecel = 0.625, pcsaccel = 0.4, pcsdecel = 0.9, pcsmaxvel = 6.0 }
[[axis]]
counts_per_pulse = 2.5
parameters = { mcsmaxvel = 8.25, mcsaccel = 1.25, mcsdecel = 0.5, encpfactor = 0.4 }
[[axis]]
parameters = { smooth = 5, mcsmaxvel = 7.125, mcsaccel = 0.875, mcsdecel = 1.5, pcsmaxvel = 5.0, pcsaccel = 0.7 }
"""


@scene(MACHINE)
def singly(b: Bench) -> None:
    """Moves of single axes in two queues, with waits of every kind, bits, and reads of every width."""
    b.MoveAbsolute(-137, 0, IF)
    b.MoveAbsolute(211, 1, Q)
    b.WaitParam(address("moving"), 0, 0, 1, Q)
    b.MoveRelative(-83, 1, Q)
    b.WaitTime(9, Q)
    b.MoveVelocity(-3 * ONE - 4321, 2, Q)
    b.WaitParamBit(address("user16b3"), 11, 1, 23, 0, Q)
    b.SetParam48(address("user48b2"), -(1 << 45) - 77, 0, Q)
    b.WaitParamMask(address("user16b3"), 0x0F0F, 0x0305, 0, 0, Q)
    b.SetParam32(address("user32b6"), -1234567, 0, Q)
    b.step(60)
    b.MoveSuperimposed(45, 0, IF)
    b.Phasing(-31, 2, IF)
    b.SetParam16(address("user16b5"), -4321, 3, P2)
    b.step(40)
    b.SetParamBit(address("user16b6"), 13, 1, 0, IF)
    b.SetParamBit(address("user16b6"), 2, 1, 0, IF)
    b.SetParamBit(address("user16b6"), 13, 0, 0, IF)
    b.TurnParamBit(address("user16b7"), 15, 0, IF)
    b.ORXORParam(address("user16b8"), 0x5A0F, 0x3C55, 0, IF)
    b.ORXORParam(address("user16b8"), 0x8001, 0x8100, 0, IF)
    b.SetParam16(address("user16b3"), 0x7375, 0, IF)
    b.MoveVelocity(2 * ONE, 2, IF)
    b.step(30)
    for k, name in enumerate(CELLS):
        b.set(IF, -3 - k, **{name: (-1) ** (k + 1) * (12345 + 617 * k)})
        (b.GetParam16, b.GetParam32, b.GetParam48)[PARAMETERS[name].words - 1](address(name), 1000 + k)
    b.step(2)
    writes = [
        ("user32b3", 0, 2, -99991),
        ("mcsdist", 1, 2, 57),
        ("mcsgo", 1, 1, -1),
        ("user48b4", 0, 3, 1 << 44),
    ]
    described = [lib.WR_MUL_DES.of(address(name), *rest) for name, *rest in writes]
    b.SetMulParam(described, 4, IF)
    b.step(20)
    for name, axis in (
        ("curpos", 1),
        ("user48b4", 0),
        ("user48b2", 0),
        ("curvel", 2),
        ("encp", 0),
        ("fwversion", 0),
    ):
        for read in (b.GetParam16, b.GetParam32, b.GetParam48):
            read(address(name), axis)
        for bit in (0, 7, 15):
            b.GetParamBit(address(name), bit, axis)
    asked = [
        lib.WR_MUL_DES.of(address(name), axis, 3 - axis)
        for name, axis in (("curpos", 1), ("mcspos", 2), ("encp", 0))
    ]
    b.GetMulParam(asked, 3)
    b.answers.append(f"read: {[each.value for each in asked]}")
    b.MoveRelative(0, 0, IF)
    b.MoveVelocity(0, 2, IF)
    b.step(20)
    b.set(IF, 0, run=0, homepos=-77)
    b.set(IF, 1, sethome=-1)
    b.set(IF, 2, homepos=5000, sethome=-1, haltmode=0, haltstep=1)
    b.step(10)
    for axis in (0, 3):
        b.MoveVelocity(ONE, axis, IF)
        b.MoveSuperimposed(5, axis, IF)
        b.MoveAbsolute(-9, axis, Q)
    b.step(4)
    b.set(IF, 1, clear=-1)
    b.ClearFIFO(Q)
    b.step(10)


HOMES = """
number_of_axes = 3
[[axis]]
counts_per_pulse = 0.75
origin = [93, 151]
index = { first = 21, pitch = 37 }
parameters = { highvel = 4.5, lowvel = 0.875, homepos = -13, homestpos = 29, mcsaccel = 0.625, indexNum = 2 }
[[axis]]
lag_s = 0.003
gain = 90.0
origin = [-170, -88]
low_when_on = ["origin"]
index = { first = 5, pitch = 41 }
parameters = { highvel = 5.25, lowvel = -1.125, homepos = 17, homestpos = -41, mcsdecel = 0.75, indexNum = 3 }
[[axis]]
origin = [-120, -75]
index = { first = -3, pitch = 26 }
parameters = { highvel = 3.75, lowvel = 1.5, homepos = 1003, homestpos = 977, indexNum = 1, mcsdecel = 0.5 }
"""


@scene(HOMES)
def homes(b: Bench) -> None:
    """Each way to search the origin, from either side, to rest and to a place."""
    ways = (
        b.HomeSwitch1,
        b.HomeSwitch2,
        b.HomeSwitch3,
        b.HomeSwitchIndex1,
        b.HomeSwitchIndex2,
        b.HomeSwitchIndex3,
    )
    for k, home in enumerate(ways):
        home(0, k & 1, k >> 1 & 1, 0, IF)
        home(1, 1 - (k & 1), k & 1, 1, Q)
        home(1, k >> 1 & 1, 1, 2, IF)
        b.step(150)
        b.set(IF, 0, gohome=0)
        b.set(IF, 1, gohome=0)
        b.set(IF, 2, gohome=0)
        b.step(12)
        for axis in range(3):
            b.set(IF, axis, clear=-1)
            b.card.state.axis[axis]["machine"] = 0
        b.step(30)
    b.HomeIndex(1, 1, 0, IF)
    b.HomeIndex(0, 0, 1, IF)
    b.set(IF, 2, highvel=0)
    b.HomeIndex(0, 0, 2, IF)
    b.step(120)


@scene(
    "number_of_axes = 6\n[[axis]]\n[[axis]]\n[[axis]]\nparameters = { mcsaccel = 0.375, mcsdecel = 0.25 }\n"
)
def couplings(b: Bench) -> None:
    """Gears of every kind and source, hand wheels, and synchronous motion by time and by distance."""
    b.MoveVelocity(3 * ONE, 0, IF)
    b.MoveVelocity(-2 * ONE + 999, 1, IF)
    b.MoveSuperimposed(400, 1, IF)
    b.card.spin_handwheel(4, 2.5)
    b.step(15)
    for source, axis in ((0, 2), (2, 3), (3, 4), (1, 5)):
        b.GearFree(-1.375 + source / 2, source & 1, source, axis, IF)
    b.step(30)
    b.set(IF, 2, gearoutmod=-1, gearoutvel=-1.25, engear=0)
    b.set(IF, 3, engear=0)
    b.GearInDist(0.625, 0, 2, 1, 2, 37, 4, IF)
    b.GearInTime(-2.25, 1, 0, 21, 5, IF)
    b.HandWheel(1.75, 4, 2, IF)
    b.step(10)
    b.set(IF, 4, startsyn=-1)
    b.set(IF, 5, startsyn=-1)
    b.step(45)
    b.set(IF, 2, engear=0)
    b.set(IF, 4, engear=0)
    b.GearFree(0.875, 4, 4, 3, IF)
    b.step(15)
    for axis in (2, 3, 4, 5):
        b.set(IF, axis, engear=0)
        b.MoveVelocity(0, axis, IF)
    b.step(40)
    b.MoveInTime(23, -71, 2, IF)
    b.MoveInDist(55, 0, 93, 3, IF)
    b.TgvelInTime(17, -2 * ONE - 333, 4, IF)
    b.TgvelInDist(61, 1, ONE + 777, 5, IF)
    b.step(5)
    for axis in (2, 3, 4, 5):
        b.set(IF, axis, enasyn=-1, startsyn=-1)
    b.step(40)
    b.MoveTP(19, 47, 2, Q)
    b.set(Q, 2, startsyn=-1)
    b.MovePP(44, 1, -38, 3, P1)
    b.set(IF, startpath1=-1)
    b.MoveTV(15, 3 * ONE, 4, Q)
    b.MovePV(30, 0, -ONE, 5, IF)
    b.set(IF, 5, enasyn=-1, startsyn=-1)
    b.set(Q, 4, startsyn=-1)
    b.step(12)
    b.set(IF, 3, enasyn=-1, startsyn=-1)
    b.set(IF, 4, enasyn=0)
    b.step(40)
    b.MoveInTime(20, 33, 2, IF)
    b.set(IF, 2, startsyn=-1)
    b.step(5)
    b.GearInTime(0.5, 0, 0, 9, 2, IF)
    b.step(25)
    b.set(IF, 2, startsyn=-1)
    b.step(15)
    b.GearFree(0.5, 0, 0, 3, IF)
    b.step(6)
    b.MoveInTime(9, 40, 3, IF)
    b.set(IF, 3, startsyn=-1)
    b.step(15)
    b.MoveSuperimposed(23, 3, IF)
    b.step(20)
    b.MoveInTime(12, -37, 3, IF)
    b.set(IF, 3, slaveabs=-1, startsyn=-1)
    b.step(20)


def segment(*ends: int, center: tuple[int, int] = (0, 0), direction: int = 0) -> lib.PFIFOSegData:
    """Return the data of a segment."""
    return lib.PFIFOSegData.of(*ends, center=center, direction=direction)


@scene("number_of_axes = 5\n[[axis]]\nlag_s = 0.003\ngain = 80.0\n[[axis]]\nparameters = { pathabs = 0 }\n")
def paths(b: Bench) -> None:
    """Every segment in both path spaces, by positions and by distances, with overrides, pauses and speeds."""
    b.set(
        IF,
        pathaxisnum1=3,
        segmap_x1=2,
        segmap_y1=0,
        segmap_z1=4,
        pathacc1=0.875,
        feedrate1=0.75,
        segtgvel1=6.5,
    )
    b.set(
        IF,
        pathaxisnum2=2,
        segmap_x2=3,
        segmap_y2=1,
        pathacc2=1.25,
        feedrate2=1.25,
        segtgvel2=4.25,
        segendvel2=1.5,
    )
    b.set(IF, startpath1=-1, startpath2=-1)
    b.AddLineN(segment(61, -43, 29), P1)
    b.AddLineNWithVel(lib.PFIFOSegInfo.of(5 * ONE, 2 * ONE, segment(83, -21)), P1)
    b.AddArcWithVel(4 * ONE, ONE, 103, -41, 93, -31, 0, P1)
    b.AddArc(83, -61, 93, -51, 1, P1)
    b.AddLineN(segment(37, 25), P2)
    b.AddLineNWithVel(lib.PFIFOSegInfo.of(7 * ONE, 3 * ONE, segment(57, -15)), P2)
    b.AddArc(77, 10, 67, 5, 1, P2)
    b.AddArcWithVel(3 * ONE, ONE, 97, 20, 87, 10, 0, P2)
    b.step(60)
    b.set(IF, hpause=1, asseglen1=2)
    b.step(8)
    b.set(IF, hpause=0, feedrate1=0.5, feedrate2=0.0)
    b.AddSpiralWithVel(6 * ONE, 2 * ONE, 63, -41, 47, 73, -51, 0, P1)
    b.AddSpiral(43, -61, 55, 53, -51, 1, P1)
    b.AddArcLineWithVel(
        lib.PFIFOSegInfo.of(5 * ONE, 3 * ONE, segment(63, -81, 71, center=(53, -71), direction=-1)), P1
    )
    b.AddArcLine(segment(83, -61, 11, center=(73, -71)), P1)
    b.step(70)
    b.set(IF, feedrate2=1.5, feedrate1=1.125)
    b.AddArcLine(segment(20, 10, center=(10, -5), direction=-1), P2)
    b.step(90)
    b.set(IF, pathaxisnum2=3, segmap_z2=1, segmap_y2=0)
    b.AddApiralWithVel(4 * ONE, 0, 9, 4, 9, 5, 3, 0, P2)
    b.PutContourData([9, -7, 5, 11, 3, -13, 15, -2, 8], 9, P2)
    b.WaitParam(address("user16b1"), 5, 30, 0, P1)
    b.AddLineN(segment(0, 0, 0), P1)
    b.step(60)
    b.set(IF, startpath1=0)
    b.AddLineN(segment(1, 2, 3, 4), P2)
    b.ClearFIFO(P1)
    b.step(20)


@scene("number_of_axes = 4\n")
def contours(b: Bench) -> None:
    """Points of a contour of three axes, in two paces, through a pause, the end of the points and an emergency stop."""
    b.set(IF, groupnum=3, group_x=3, group_y=0, group_z=2, groupsmooth=5, startgroup=-1)
    b.PutContourData([9, -7, 5, 13, -11, 3, -15, 6, 2, 17, 4, -8], 12, C)
    b.PutContourData([32767 % 211, -97, 55, -13, 11, 93], 6, C)
    b.MoveVelocity(ONE, 1, IF)
    b.step(17)
    b.set(IF, hpause=-1)
    b.step(7)
    b.set(IF, hpause=0, groupsmooth=3, timer=400, delayus=70000)
    b.MoveAbsolute(5, 0, IF)
    b.step(20)
    b.AddContourData([4, 5, 6], 3, C)
    b.step(6)
    b.PutContourData([40, 50, 60, -40, -50, -60], 6, C)
    b.step(4)
    b.set(IF, emstop=0x10)
    b.step(4)
    b.set(IF, emstop=0)
    for axis in range(4):
        b.set(IF, axis, error=0, ena=-1, run=-1)
    b.ClearFIFO(C)
    b.set(IF, startgroup=0)
    b.step(4)
    b.set(IF, 1, run=0)
    b.set(IF, groupnum=4, group_a=1, groupsmooth=2, startgroup=-1)
    b.step(1)
    b.PutContourData([3, -2, 4, 5, -6, 1, 2, -3], 8, C)
    b.step(5)
    b.set(IF, 1, run=-1)
    b.step(8)


NUMBERS = (3, -5, 70000, -70001, (1 << 31) - 3, -(1 << 31) + 9, 0, 0x1234567)
LONG = ((1 << 46) + 12345, -(1 << 45) - 999, 1 << 33, -7, 0, (1 << 32) * 3 // 7, -(1 << 32) * 5 // 3, 65536)


@scene("number_of_axes = 2\n")
def events(b: Bench) -> None:
    """Every command of events with some pairs of numbers, and every condition on the results of a counter."""
    more = cycle(range(7))
    for command in lib.IMC_EVENT_CMD:
        for k in range(2):
            n, o = next(more), next(more)
            words = 1 if "16" in command.name else 3 if "48" in command.name else 2
            if words == 1:
                b.set(IF, user16b1=0x5A3C - 977 * n, user16b2=-0x1111 * k - o)
            first, second = (
                (LONG[n], LONG[o]) if words == 3 or "SCA" in command.name else (NUMBERS[n], NUMBERS[o])
            )
            b.set(IF, user32b1=NUMBERS[n], user32b2=NUMBERS[o], user48b1=first, user48b2=second)
            constant = "i" in command.name or "SET" in command.name
            size = {1: 16, 2: 32, 3: 48}[words]
            factor = 48 if "SCA" in command.name else size
            given = second if factor == 48 else NUMBERS[o] if factor == 32 else 0x2B67 + k
            source = given if constant else (address(f"user{factor}b2"), 1)
            b.InstallEvent(
                [
                    lib.EventInfo.of(
                        command,
                        src1=(address(f"user{size}b1"), 0),
                        src2=source,
                        dest=(address(("user48b3", "user48b4")[k]), 1),
                    ),
                ],
                1,
                (IF, Q)[k],
            )
        b.step(2)
        b.set(IF, events=0, user48b3=0, user48b4=0)
    b.step(1)
    b.set(IF, user32b5=-3, user16b9=0)
    counter = lib.EventInfo.of(
        lib.CMD_ADD32i, src1=(address("user32b5"), 0), src2=1, dest=(address("user32b5"), 0)
    )
    marks = [
        lib.EventInfo.of(
            lib.CMD_XOR16i, when, src1=(address("user16b9"), 0), src2=1 << k, dest=(address("user16b9"), 0)
        )
        for k, when in enumerate(list(lib.IMC_EventType)[1:])
    ]
    b.InstallEvent([counter, *marks], 1 + len(marks), IF)
    for start in (-3, (1 << 31) - 3, -1):
        b.set(IF, user32b5=start)
        b.step(6)
    b.set(IF, events=0)
    b.step(1)


LIMITS = """
[[axis]]
limit_positive = 60
limit_negative = -55
low_when_on = ["limit_positive"]
parameters = { aioctr = 14, poserrlim = 40, stopmode = 1 }
[[axis]]
limit_positive = 70
limit_negative = -65
lag_s = 0.02
gain = 15.0
parameters = { aioctr = 15, poserrlim = 9, stopfilt = 65535, exitfilt = 2, settlewin = 4, settlen = 7, trackwin = 6 }
[[axis]]
parameters = { psoftlim = 50, nsoftlim = -45, aioctr = 49152, vellim = 5.0, accellim = 0.75, mcsaccel = 0.5 }
[[axis]]
probe = { first = 17, pitch = 23 }
index = { first = 4, pitch = 15 }
parameters = { encpctr = 1024, ciraxis = -1, cirpos = 90 }
"""


@scene(LIMITS)
def limits(b: Bench) -> None:
    """Switches, software limits, speeds and errors that stop an axis or take it out of run; captures and a ring."""
    for axis, speed in enumerate((4, 3, 3, 7)):
        b.MoveVelocity(speed * ONE + 99, axis, IF)
    b.step(60)
    b.GetCapData(3, 3)
    b.set(IF, 3, capture=-1, aiolat=0)
    for axis, speed in enumerate((-5, -3, -4, -6)):
        b.set(IF, axis, error=0)
        b.MoveVelocity(speed * ONE - 77, axis, IF)
    b.step(90)
    b.GetCapData(120, 3)
    b.set(IF, 0, clraiolat=-1, error=0, stopfilt=0)
    b.set(IF, 1, error=0, run=-1, exitfilt=0x80, poserrlim=5)
    b.set(IF, 2, error=0, run=-1, vellim=2.0)
    b.set(IF, 3, encpctr=-0x8000, biciraxis=-1, clrcapfifo=0, counter=0)
    for axis, speed in enumerate((6, 5, -4, -8)):
        b.MoveVelocity(speed * ONE, axis, IF)
    b.card.set_input(3, True)
    b.card.set_input(18, True)
    b.step(40)
    b.set(IF, gin1lat=4, gio=0x1234, giod=-0x4321, gout3=0x0F0F)
    b.set(IF, 1, encsfactor=1.5)
    b.card.spin_handwheel(1, -1.75)
    b.card.turn_handwheel(2, 33)
    b.card.touch_probe(3)
    b.MoveAbsolute(2147483647, 0, IF)
    b.MoveRelative(2147483647, 3, IF)
    b.step(20)
    b.set(IF, 1, clrencs=-1)
    b.set(IF, emstop=0x11)
    b.step(5)


EDGES = """
number_of_axes = 6
[[axis]]
[[axis]]
[[axis]]
origin = [40, 60]
index = { first = 43, pitch = 9 }
[[axis]]
lag_s = 0.003
gain = 80.0
"""


def far(b: Bench) -> None:
    """Leave 32 bits with what it paces, be refused a target out there, and be a slave that is."""
    b.set(IF, 0, homepos=(1 << 31) - 120, sethome=-1)
    b.set(IF, 3, homepos=-(1 << 31) + 90, sethome=-1)
    b.step(1)
    b.MoveInDist(200, 0, 77, 1, IF)
    b.set(IF, 1, enasyn=-1, startsyn=-1)
    b.MoveVelocity(12 * ONE + 345, 0, IF)
    b.MoveVelocity(-9 * ONE - 77, 3, IF)
    b.step(30)
    b.GearFree(-0.75, 0, 2, 2, IF)
    b.set(IF, 4, homepos=-(1 << 31) + 50, sethome=-1)
    b.step(9)
    b.MoveRelative(-(1 << 31) + 40, 2, IF)
    b.MoveRelative(-90, 4, IF)
    b.MoveSuperimposed((1 << 31) - 1, 4, IF)
    b.step(4)
    b.MoveAbsolute(0, 0, IF)
    b.MoveVelocity(0, 3, IF)
    b.set(IF, 2, error=0)
    b.set(IF, 4, error=0, clear=-1)
    b.step(20)


def refused(b: Bench) -> None:
    """Moves without speed or rates, at first and under way, pauses of one axis, searches of nothing."""
    for axis, name in enumerate(("mcsmaxvel", "mcsaccel", "mcsdecel", "pcsmaxvel")):
        b.set(IF, axis, clear=-1)
        b.step(1)
        b.set(IF, axis, run=-1, ena=-1, **{name: 0})
        b.MoveRelative(70, axis, IF)
        b.MoveSuperimposed(30, axis, IF)
    b.step(8)
    for axis, name in enumerate(("mcsmaxvel", "mcsaccel", "mcsdecel", "pcsmaxvel")):
        b.set(IF, axis, error=0, stopfilt=0, **{name: 5})
        b.MoveRelative(-400, axis, IF)
    b.step(12)
    for axis, name in enumerate(("mcsmaxvel", "mcsaccel", "mcsdecel", "mcsmaxvel")):
        b.set(IF, axis, haltmode=-(axis & 1), haltstep=1, **{name: 0})
    b.step(5)
    for axis in range(4):
        b.set(IF, axis, haltstep=0)
    b.step(20)
    b.set(IF, 2, homeseq=0, gohome=-1)
    for axis in range(4):
        b.set(
            IF,
            axis,
            error=0,
            mcsmaxvel=6,
            mcsaccel=1.25,
            mcsdecel=0.75,
            mcsgo=0,
            mcsvel=0,
            highvel=4,
            homepos=-9,
        )
    b.set(IF, 1, ciraxis=-1, cirpos=0)
    b.HomeSwitchIndex1(0, 1, 0, 2, IF)
    b.step(60)


def coupled(b: Bench) -> None:
    """Pacing that jumps past its end, spans of nothing, starts that are kept, refused or in the way."""
    b.MoveVelocity(7 * ONE + 99, 0, IF)
    b.step(8)
    b.GearInDist(1.5, 0, 0, 0, 0, 3, 1, IF)
    b.MoveInTime(0, 25, 4, IF)
    b.set(IF, 3, startsyn=-1)
    for axis in (1, 4):
        b.set(IF, axis, startsyn=-1)
    b.step(3)
    b.GearFree(0.25, 0, 0, 3, IF)
    b.MoveInTime(40, -90, 5, IF)
    b.set(IF, 5, startsyn=-1)
    b.set(IF, 2, nsoftlim=-30, aioctr=0x8000, error=0, stopfilt=-1)
    b.MoveVelocity(-5 * ONE, 2, IF)
    b.step(9)
    b.MoveAbsolute(3, 5, IF)
    b.set(IF, 1, engear=0)
    b.MoveVelocity(0, 1, IF)
    b.step(20)
    b.set(IF, 4, pathabs=0)
    b.set(IF, 5, pathabs=0)
    b.set(
        IF, segmap_x1=4, segmap_y1=5, pathaxisnum1=2, pathacc1=0.5, segtgvel1=4, segendvel1=2, startpath1=-1
    )
    b.PutContourData([6, -8, 3, 4, -5, 12, 9, 1], 8, P1)
    b.PutContourData([0, 7, 8, 0], 4, P1)
    b.AddArcLine(segment(10, 10, center=(10, 0)), P1)
    b.step(6)
    b.MoveInTime(15, 9, 4, IF)
    b.set(IF, 4, startsyn=-1)
    b.GearFree(1.0, 0, 0, 5, P1)
    b.AddLineN(segment(0, 0), P1)
    b.AddLineN(segment(5, 4, 3), P1)
    b.step(50)
    b.set(IF, 4, error=0)
    b.set(IF, 5, error=0, engear=0)
    b.set(IF, 3, engear=0, mcstgvel=0)
    b.set(IF, groupnum=2, group_x=3, group_y=1, groupsmooth=6, startgroup=-1)
    b.PutContourData([30, -42] * 4, 8, C)
    b.step(9)
    b.AddLineN(segment(8, 9), P1)
    b.set(IF, segmap_x1=3)
    b.AddLineN(segment(4, 4), P1)
    b.step(5)
    b.set(IF, 3, error=0x40, stopmode=0)
    factor = lib.EventInfo.of(
        lib.CMD_SCA48i, src1=(address("curpos"), 0), src2=-98305, dest=(address("user48b1"), 0)
    )
    b.InstallEvent([factor], 1, IF)
    b.step(15)


def edges(b: Bench) -> None:
    """What happens at the ends of numbers, and what is refused."""
    far(b)
    refused(b)
    coupled(b)


SCENES["edges"] = ("ready = true\n" + EDGES, edges)
SCENES["edges_otherwise"] = ("ready = true\n" + OTHERWISE + EDGES, edges)
for number in range(1, 5):
    system = (OTHERWISE if number > 2 else "") + CARD_FILE
    SCENES[f"walk{number}"] = ("ready = true\n" + system, partial(walk, seed=number, acts=400))
for number in (1, 2):
    SCENES[f"wander{number}"] = ("ready = true\n" + WANDER_FILE, partial(wander, seed=number, acts=500))
SCENES |= FLAGS


# What the scenes show of the manual: all of it but for cards on a network, C types and what no card does.
ELSEWHERE = re.compile(
    r"imc\.(IMC_(FindNetCard|Open\w*|Close)|option\.\w+|type\.(IMC\w*|__int64)|concept\.rbfifo"
    r"|status\.(?!IMC_(OK|OUT_OF_RANGE|INVALID_(PARAM|AXIS|FIFO)|FIFO_FULL|PARAM_READ_ONLY)$)\w+"
    r"|struct\.NIC_INFO|file\.\w+|const\.(openMode|limits)|concept\.library"
    r"|param\.clrififo)"
)
CONFORMANCE = load_conformance()
ROWS = [
    row.id
    for row in CONFORMANCE.rows("imc")
    if not ELSEWHERE.fullmatch(row.id) and CONFORMANCE.state(row.id) is State.TESTED
]


@pytest.mark.covers(*ROWS)
@pytest.mark.parametrize("name", SCENES)
def test_a_card_does_what_is_written_down(name: str, request: pytest.FixtureRequest) -> None:
    text, act = SCENES[name]
    bench = Bench(text)
    act(bench)
    lib.detach()
    file, found = RECORDED / f"{name}.txt", bench.text()
    if request.config.getoption("update_goldens"):
        file.write_text(found, encoding="utf-8")
    assert found.splitlines() == file.read_text(encoding="utf-8").splitlines()
