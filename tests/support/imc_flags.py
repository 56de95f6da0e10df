"""Scenes of the card for what the others have one number for: flags, spans, pulses, settings, all coordinates."""

from __future__ import annotations

from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._parameters import PARAMETERS, address
from support.imc_bench import Bench

IF, Q, P1, P2, C = lib.FIFO_SEL
ONE = 65536
HOLE = 9  # an address within the memory that no parameter has
# What sets a flag is any number but 0.
SET = (1, 0x300, -0x8000)

FLAGS_FILE = """
number_of_axes = 8
ready = true
[[axis]]
lag_s = 0.003
gain = 80.0
[[axis]]
parameters = { pathabs = 0 }
[[axis]]
parameters = { mcsaccel = 0.75, pcsaccel = 0.5 }
[[axis]]
parameters = { cirpos = 37 }
[[axis]]
[[axis]]
origin = [20, 33]
index = { first = 33, pitch = 9 }
parameters = { highvel = 3.5, lowvel = 1.25, homepos = -8, homestpos = 13 }
"""


def flags(b: Bench) -> None:
    """Every flag set by other numbers than FFFFh, with what it stands for under way."""
    b.set(IF, 7, mcsmaxvel=9)
    for value in SET:
        for axis in range(8):
            b.set(IF, axis, clear=value, error=0)
        b.step(1)
        for axis in range(8):
            b.set(IF, axis, ena=value, run=value, smooth=0)
        b.set(IF, 0, shiftmaster=value)
        b.MoveAbsolute(60, 0, IF)
        b.MoveSuperimposed(25, 0, IF)
        b.set(IF, 1, pcsdist=-17, pcsgo=value, mcsdist=41, mcsgo=value)
        b.set(IF, 2, mcstrack=value, mcstgpos=30, mcsgo=value, pcstrack=value, pcstgpos=-9, pcsgo=value)
        b.set(IF, 3, ciraxis=value, biciraxis=value if value < 0 else 0)
        b.MoveVelocity(-3 * ONE - 55, 3, IF)
        b.MoveVelocity(4 * ONE + 77, 4, IF)
        b.set(IF, 5, homeseq=0x14 if value > 1 else 0x34, gohome=value)
        b.set(IF, 6, master=4, gearsrc=address("curvel"), gearratio=-0.375, enasyn=0, engear=value)
        b.MoveInDist(70, 4, 55, 7, IF)
        b.set(IF, 7, slaveabs=value, enasyn=value, startsyn=value)
        b.step(12)
        b.set(IF, 2, mcstgpos=51, pcstgpos=-20)
        b.set(IF, 4, haltmode=value, haltstep=value)
        b.set(IF, 1, haltstep=value)
        b.step(6)
        b.set(IF, 4, haltstep=0)
        b.set(IF, 1, haltstep=0)
        b.set(IF, hpause=value)
        b.step(4)
        b.set(IF, hpause=0)
        b.set(IF, 2, mcstrack=0, pcstrack=0)
        b.set(IF, 6, gearoutmod=value, gearoutvel=1.5, engear=0)
        b.set(IF, 0, shiftmaster=0, sethome=value, homepos=3)
        b.step(30)
        b.MoveInTime(9, -21, 6, IF)
        b.set(IF, 6, slaveabs=value, startsyn=value)
        b.TgvelInTime(7, ONE + 5, 7, IF)
        b.set(IF, 7, startsyn=value)
        b.step(14)
        b.set(IF, 3, ciraxis=0)
        b.set(
            IF,
            segmap_x1=1,
            segmap_y1=2,
            pathaxisnum1=2,
            pathacc1=1,
            segtgvel1=5,
            feedrate1=1,
            startpath1=value,
        )
        b.set(IF, 2, pathabs=value)
        b.AddLineN(lib.PFIFOSegData.of(15, 70), P1)
        b.set(IF, groupnum=2, group_x=0, group_y=5, groupsmooth=3, startgroup=value)
        b.PutContourData([7, -5, 4, 9], 4, C)
        b.step(15)
        b.set(IF, startpath1=0, startgroup=0)
        b.set(IF, 0, clrencs=value, capture=value, popcapfifo=value, clraiolat=value)
        b.set(IF, clearimc=value)
        for axis in range(8):
            b.MoveVelocity(0, axis, IF)
        b.step(12)
        for axis in range(8):
            b.set(IF, axis, run=0, slaveabs=0)
        b.step(1)


SHORT_FILE = """
number_of_axes = 7
ready = true
[[axis]]
[[axis]]
[[axis]]
origin = [20, 35]
index = { first = 20, pitch = 15 }
parameters = { highvel = 5, lowvel = 2.5, homepos = 100, homestpos = 90 }
[[axis]]
origin = [-35, -20]
index = { first = -20, pitch = 15 }
parameters = { highvel = 5, lowvel = 2.5, homepos = -100, homestpos = -97 }
[[axis]]
index = { first = 0, pitch = 1 }
parameters = { highvel = 9, indexNum = 300 }
[[axis]]
"""


def short(b: Bench) -> None:
    """Spans of 0, 1 and 2, of a time and of a distance, with either sign; pulses at the edge itself, and very many."""
    b.HomeIndex(0, 0, 4, IF)
    b.MoveVelocity(2 * ONE, 0, IF)
    b.set(IF, 6, ciraxis=-1, cirpos=25)
    for both, end in ((0, 25), (0, -1), (-1, 25), (-1, -25), (-1, 24), (0, 50), (0, 0)):
        b.set(IF, 6, biciraxis=both)
        b.MoveAbsolute(end, 6, IF)
        b.step(18)
    for k, span in enumerate((2, 1, 0, -1, -2, 3)):
        b.MoveInTime(span, 11 + k, 1, IF)
        b.set(IF, 1, startsyn=-1)
        b.MoveInDist(span, 0, -13 - k, 5, IF)
        b.set(IF, 5, enasyn=-1, startsyn=-1)
        b.step(5)
        b.TgvelInTime(span, ONE * (k - 2), 1, IF)
        b.set(IF, 1, startsyn=-1)
        b.TgvelInDist(span, 0, ONE * (2 - k), 5, IF)
        b.set(IF, 5, enasyn=-1, startsyn=-1)
        b.step(5)
        b.GearInTime(0.75, 0, 0, span, 1, IF)
        b.set(IF, 1, startsyn=-1)
        b.GearInDist(-1.25, 0, 0, 0, 0, span, 5, IF)
        b.set(IF, 5, enasyn=-1, startsyn=-1)
        b.step(5)
        for axis in (1, 5):
            b.set(IF, axis, engear=0, enasyn=0)
            b.MoveVelocity(0, axis, IF)
        b.step(3)
    for home in (b.HomeSwitchIndex1, b.HomeSwitchIndex2, b.HomeSwitchIndex3, b.HomeSwitch2):
        arguments = (1,) if home is not b.HomeSwitch2 else (0,)
        home(0, arguments[0], 1, 2, IF)
        home(1, arguments[0], 0, 3, IF)
        b.step(60)
        for axis in (2, 3):
            b.set(IF, axis, gohome=0)
            b.MoveVelocity(0, axis, IF)
        b.step(12)
        for axis in (2, 3):
            b.set(IF, axis, clear=-1)
            b.card.state.axis[axis]["machine"] = 0
        b.step(2)
    b.leap(10)


def settings(b: Bench) -> None:
    """A number of its own in every word that is only kept, of the card and of the first, third and last axis."""
    kept = [
        each
        for each in PARAMETERS.values()
        if each.access != "ro" and b.card.state.word[each.address, 1] == addr.STORE
        if not each.name.startswith(("start", "emstop", "hpause", "halt"))
    ]
    for k, each in enumerate(kept):
        for axis in (0, 2, b.card.axes - 1) if each.scope == "A" else (0,):
            b.set_any(each, (k + 3) * 0x9E3779B97F4A7C15 + (axis + 1) * 0x2545F491 >> 7, axis, IF)
        b.card.advance(1)
    b.leap(1)
    for each in kept[::3]:
        b.set_any(each, 0, 0, IF)
        b.card.advance(1)
    b.set(IF, 2, clear=-1)
    b.set(IF, clrififo=-1, clearimc=-1)
    b.leap(3)


def coordinates(b: Bench) -> None:
    """All sixteen coordinates of a contour, each on an axis of its own, in another order."""
    names = ("x", "y", "z", "a", *"bcdefghijklm")
    b.set(
        IF, groupnum=16, groupsmooth=2, **{f"group_{name}": (7 * k + 5) % 16 for k, name in enumerate(names)}
    )
    b.set(IF, startgroup=-1)
    b.PutContourData([3 * k - 20 for k in range(16)], 16, C)
    b.PutContourData([45 - 5 * k for k in range(16)], 16, C)
    b.leap(3)
    b.leap(1)
    b.set(IF, groupnum=15, startgroup=0)
    b.leap(2)
    b.set(IF, startgroup=-1)
    b.PutContourData([k * k for k in range(15)], 15, C)
    b.leap(5)


def answers(b: Bench) -> None:
    """What is answered to what cannot be: every argument one beyond its ends, full queues, words that are only read."""
    cell, last = address("user16b1"), b.card.axes - 1
    for place in (HOLE, -1, 65535, address("ticks"), address("curpos")):
        b.SetParam16(place, 5, 0, IF)
        b.SetParam32(place, 6, last, Q)
        b.SetParamBit(place, 3, 1, 0, IF)
        b.ORXORParam(place, 1, 2, 0, IF)
        b.GetParam16(place, 0)
        b.GetParam48(place, last)
        b.WaitParam(place, 3, 4, 0, Q)
    for axis in (-1, last, last + 1, 255):
        b.SetParam16(cell, 7, axis, IF)
        b.SetParam32(address("mcstgpos"), 8, axis, IF)
        b.GetParam32(address("mcstgpos"), axis)
        b.MoveVelocity(ONE, axis, IF)
        b.HomeSwitch1(0, 0, 0, axis, IF)
        b.GearFree(0.5, axis, 0, 0, IF)
        b.MoveInDist(9, axis, 5, 0, IF)
        b.GetCapData(1, axis)
        b.step(1)
    for fifo in (-1, *lib.FIFO_SEL, 5):
        b.SetParam16(cell, 9, 0, fifo)
        b.WaitTime(1, fifo)
        b.WaitParamBit(cell, 2, 1, 3, 0, fifo)
        b.MoveAbsolute(2, 1, fifo)
        b.AddLineN(lib.PFIFOSegData.of(3, 4), fifo)
        b.AddContourData([5, 6], 2, fifo)
        b.InstallEvent([lib.EventInfo.of(lib.CMD_SET16, src2=3, dest=(cell, 0))], 1, fifo)
        b.ClearFIFO(fifo)
        b.step(1)
    for bit in (-1, 15, 16):
        b.SetParamBit(cell, bit, 1, 0, IF)
        b.TurnParamBit(cell, bit, 0, IF)
        b.GetParamBit(cell, bit, 0)
        b.WaitParamBit(cell, bit, 1, 3, 0, Q)
    for source in (-1, 4, 5):
        b.GearFree(0.5, 0, source, 1, IF)
        b.GearInDist(0.5, 0, 0, 0, source, 5, 1, IF)
    for count in (0, 1, 32, 33):
        b.GetMulParam([lib.WR_MUL_DES.of(cell, 0, 1)] * 33, count)
    for count in (-1, 0, 120, 121):
        b.GetCapData(count, 0)
    for count in (0, 1, 126, 127):
        b.PutContourData([0] * 127, count, C)
    b.step(1)
    b.WaitTime(0, Q)
    told = len(b.answers)
    for _ in range(1200):  # until it is full
        b.SetParam48(address("user48b1"), 11, 0, Q)
        if len(b.answers) > told:
            break
    b.step(1)


def beyond(b: Bench) -> None:
    """Ends faster than their segments, axes by the number of axes, targets that creep, events that are no number."""
    n = b.card.axes
    b.set(IF, segmap_x1=0, segmap_y1=1, segmap_z1=2, pathaxisnum1=3, pathacc1=0.75, startpath1=-1)
    b.set(IF, segmap_x2=3, segmap_y2=n, pathaxisnum2=2, pathacc2=1.25, segtgvel2=4, startpath2=-1)
    b.AddLineN(lib.PFIFOSegData.of(9, 8), P2)
    data = lib.PFIFOSegData.of(40, 30, 12)
    arc = lib.PFIFOSegData.of(60, 50, -8, center=(60, 30))
    for end in (9 * ONE, -2 * ONE, 0):
        b.AddLineNWithVel(lib.PFIFOSegInfo.of(4 * ONE, end, data), P1)
        b.AddArcLineWithVel(lib.PFIFOSegInfo.of(3 * ONE, end, arc), P1)
        b.AddArcWithVel(2 * ONE, end, 80, 30, 80, 50, 1, P1)
        b.AddSpiralWithVel(5 * ONE, end, 60, 10, -15, 80, 10, 0, P1)
        b.step(40)
        b.set(IF, error=0, stopfilt=0)
    b.set(IF, startpath1=0, startpath2=0)
    b.set(IF, 3, error=0, mcstrack=-1, mcstgpos=20, mcsgo=-1, pcstrack=-1, pcstgpos=-20, pcsgo=-1)
    for k in range(8):
        b.step(3)
        b.set(IF, 3, mcstgpos=21 + k, pcstgpos=-21 - k)
    b.step(20)
    for k in range(4):
        b.set(IF, 3, mcstgpos=27 - k, pcstgpos=-27 + k)
        b.step(4)
    count = lib.EventInfo.of(
        lib.CMD_ADD32i, src1=(address("user32b1"), 0), src2=1, dest=(address("user32b1"), 0)
    )
    b.InstallEvent([count] * 3, 3, IF)
    for number in (1, 3, 127, 128, 129, 255, 32767, -1, 0):
        b.step(2)
        b.set(IF, events=number)
    b.step(2)
    for words in (1, 2, 3):
        asked = [lib.WR_MUL_DES.of(address(name), 3, words) for name in ("mcspos", "user48b4", "curvel")]
        for each in asked:
            each.data[0:3] = [111, 222, 333]
        b.GetMulParam(asked, 2)
        b.answers.append(f"read: {[list(each.data) for each in asked]}")


SCENES = {
    "beyond": ("number_of_axes = 4\nready = true\n", beyond),
    "answers_alone": ("number_of_axes = 1\nready = true\n", answers),
    "flags": (FLAGS_FILE, flags),
    "short": (SHORT_FILE, short),
    "settings": ("number_of_axes = 4\nready = true\n", settings),
    "answers": ("number_of_axes = 3\nready = true\n", answers),
    "coordinates": ("number_of_axes = 16\nready = true\n", coordinates),
}
