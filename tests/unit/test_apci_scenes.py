"""What whole boards do, every register of it, written down in `tests/golden/apci/NAME.txt`.

The numbers themselves are asserted from the manual elsewhere; here nothing can change unseen, on any axis, in any
unit, as the PC reads it and as a program reads it. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from polycnc.conformance import State, load_conformance
from polycnc.controllers.apci import ErrorReg, pcap
from polycnc.controllers.apci.sap._commands import AXIS_QUALIFIERS, SYSTEM_VARIABLES
from support.apci_bench import OF_AXES, WHOLE, WRITES, Bench, difference
from support.apci_conditions import CONDITIONS
from support.apci_ends import SCENES as ENDS
from support.apci_mixture import MIXED, Mixture
from support.apci_pc import near
from support.apci_walk import OTHER_UNITS, Walk

RECORDED = Path(__file__).parents[1] / "golden" / "apci"
SCENES: dict[str, tuple[str, Callable[[Bench], None]]] = {}


def scene(system: str) -> Callable[[Callable[[Bench], None]], Callable[[Bench], None]]:
    """Make a function a scene of a board."""

    def add(act: Callable[[Bench], None]) -> Callable[[Bench], None]:
        SCENES[act.__name__] = (system, act)
        return act

    return add


LAGS = """
[[axis]]
time_unit = "min"
jac = 1.3e6
jvl = 1900.0
kp = 45.0
kfcv = 0.75
backlash = 0.125
ipw = 0.0625
[axis.plant]
kind = "lag"
lag_s = 0.004
velocity_at_10_v = 15000.0
play = 0.125
index = 0.75
[[axis]]
unit = "inch"
display_unit = "mm"
display_factor = 1.5
slsp = 4000.0
gf = 2.5
jac = 60.0
jvl = 4.0
jerkrel = 0.5
kp = 30.0
ki = 12.0
kd = 0.0625
mpe = 0.05
mcpcp = 30
mcpcn = -20
[axis.plant]
kind = "lag"
lag_s = 0.006
velocity_at_10_v = 8.0
encoder = "counts"
[[axis]]
unit = "deg"
time_unit = "tsample"
jac = 0.0007
jvl = 0.11
jtvl = -0.02
sdec = 0.0013
gf = 0.0125
effradius = 30.0
MaxVel = 70.0
MaxAcc = 900.0
[board]
tu = "min"
trac = 17.0
trvl = 19.0
trtvl = 23.0
trovrst = 0.05
"""


@scene(LAGS)
def jogs(b: Bench) -> None:
    """Jogs of three axes with units, plants and ramps of their own, offsets of the setpoint, zero offsets."""
    b.cl(0, 1, 2)
    b.jr({0: 1.75, 1: -0.3125, 2: 4.5})
    b.step(50)
    b.wrjac(1, -45.0)
    b.wrjovr(0, 0.625)
    b.wrjtvl(1, 0.75)
    b.ja({0: -1.25, 1: 0.1875})
    b.js(2)
    b.step(80)
    b.wrdpoffset(0, 0.375)
    b.wrdpoffset(0, 0.3125)
    b.wrdvoffset(1, -0.5)
    b.wrdpoffset(1, -0.03125)
    b.RPtoDP(2)
    b.step(30)
    b.js(0, 1, 2)
    b.step(20)
    b.shp(0, tp=6.5)
    b.szpa(1, 0.25)
    b.szpr(1, 0.125)
    b.szpa(2, -7.5)
    b.wrdp(2, 3.25)
    b.wrtp(1, 8.5)
    b.step(20)
    b.ja({1: 0.25, 0: 6.125})
    b.step(40)
    b.clv(0, 1)
    b.step(30)
    b.azo(2)
    b.ol(0, 1)
    b.wrmcp(0, -1234)
    b.wrmcp(1, 40000)
    b.wrrp(1, -2.5)
    b.step(20)
    b.clv(0)
    b.ra(1)
    b.step(20)
    b.rs()
    b.step(10)


STEPPERS = """
board_type = "APCI-8008"
sample_time_us = 900
[[axis]]
name = "S"
motor = "stepper"
slsp = 400.0
gf = 0.5
mcpmax = 900000
mcpmin = -800000
jac = 300.0
[[axis]]
motor = "stepper"
unit = "rev"
display_unit = "deg"
slsp = 200.0
gf = 7.0
mcp_inverted = true
jac = 5.0
jvl = 0.75
[[axis]]
unit = "counts"
time_unit = "min"
jac = 3.0e8
jvl = 90000.0
mcpmax = 9000
mcpmin = -7000
mcp_inverted = true
[axis.plant]
kind = "lag"
lag_s = 0.003
velocity_at_10_v = 700000.0
[inputs]
3 = { functions = ["EO"], axes = ["S"] }
5 = { functions = ["DR", "UI"], axes = ["A2"] }
11 = { functions = ["REF"], inverted = true }
[outputs]
4 = { functions = ["PAE"], axes = ["A3"], set_at_reset = true }
6 = { functions = ["PAE"], axes = ["S", "A2"] }
2 = { set_at_reset = true }
"""


@scene(STEPPERS)
def steppers(b: Bench) -> None:
    """Motor commands of steppers and of an inverted servo with limits; terminals, lights, what a loop switches."""
    b.wrmcp(0, 1000)
    b.wrmcp(1, -350)
    b.wrmcp(2, 20000)
    b.jr({0: 5.0, 1: 1.0, 2: 300.0})
    b.step(30)
    b.wrmcp(0, 2000000)
    b.wrmcp(2, -20000)
    b.step(10)
    b.shp(0, tp=2.5)
    b.shp(2, tp=-70.0)
    b.wrdigo(1, 0x55)
    b.cl(0, 2)
    b.step(10)
    b.cl(1)
    b.shp(1, tp=0.75)
    b.jr({0: -3.5, 1: 0.125, 2: 900.0})
    b.board.set_input(3, True)
    b.step(60)
    b.board.set_input(5, True)
    b.board.set_input(11, True)
    b.board.axes[1].alarms = 0xF00000
    b.wrgf(0, 0.75)
    b.wrslsp(1, 300.0)
    b.wrdigob(0, 4, 0)
    b.wrdigob(2, 3, 2)
    b.step(10)
    b.ol(0, 2)
    b.wrledgn(3)
    b.wrledrd(-1)
    b.step(10)
    b.wrledyl(5)
    b.wrledgn(0)
    b.ra(2)
    b.wrdigo(0, 0xFF)
    b.step(10)
    b.board.variables.interface.report(0x80000)
    b.wrdigob(0, 1, 1)
    b.step(10)
    b.rifs(0)
    b.step(10)


PLANNED = """
[[axis]]
sll = -1.5
slr = 2.25
soft_left = "TOM"
soft_right = "SMA"
sdec = 900.0
[[axis]]
sll = -1.25
slr = 2.5
soft_left = "SMA"
soft_right = "SMD"
sdec = 700.0
[[axis]]
sll = -1.75
slr = 2.75
soft_left = "SMD"
soft_right = "TOM"
sdec = 500.0
[axis.plant]
kind = "lag"
lag_s = 0.004
[inputs]
1 = { functions = ["LSL_TOM"], axes = ["A1"] }
2 = { functions = ["LSL_SMA"], axes = ["A2"] }
3 = { functions = ["LSL_SMD"], axes = ["A3"] }
4 = { functions = ["LSR_SMD"], axes = ["A1"] }
5 = { functions = ["LSR_TOM"], axes = ["A2"] }
6 = { functions = ["LSR_SMA"], axes = ["A3"] }
"""


@scene(PLANNED)
def limits(b: Bench) -> None:
    """Every limit function on either side, by software and by switches, and how axes come out again."""
    b.cl(0, 1, 2)
    for an, zero in enumerate((0.25, -0.5, 0.75)):
        b.shp(an, tp=zero)
    b.jr({0: 5.0, 1: 5.5, 2: 6.0})
    b.step(100)
    b.jr({0: -3.0, 1: -0.75, 2: -0.5})
    b.step(60)
    b.cl(0, 1, 2)
    b.jr({0: -5.0, 1: -5.5, 2: -6.0})
    b.step(110)
    b.wrsll(1, -2.5)
    b.wrslr(0, 1.0)
    b.jr({0: 1.0, 1: 1.25, 2: 1.5})
    b.step(60)
    b.cl(0, 1, 2)
    b.ra(0, 1, 2)
    b.cl(0, 1, 2)
    for number in (1, 2, 3):
        b.board.set_input(number, True)
    b.jr({0: -2.0, 1: -2.0, 2: -2.0})
    b.step(50)
    b.jr({0: 1.0, 1: 1.0, 2: 1.0})
    b.step(40)
    for number in range(1, 7):
        b.board.set_input(number, number > 3)
    b.jr({0: 3.0, 1: 3.0, 2: 3.0})
    b.step(60)
    b.jr({0: -1.0, 1: -1.0, 2: -1.0})
    b.step(40)


@scene(
    """
[[axis]]
hac = 200.0
hvl = 30.0
gf = 0.4
[axis.plant]
kind = "lag"
lag_s = 0.003
index = 0.875
reference = [-4.0, -1.5]
[[axis]]
time_unit = "min"
hac = 9.0e5
hvl = 1500.0
jvl = 1200.0
backlash = 0.25
[axis.plant]
reference = [2.0, 5.0]
index = 1.25
[[axis]]
[inputs]
1 = { functions = ["REF"], axes = ["A1"] }
2 = { functions = ["REF"], axes = ["A2"] }
3 = { functions = ["LP"], axes = ["A1", "A3"] }
"""
)
def searches(b: Bench) -> None:
    """Search runs to switches and index pulses, with latches by scans, by an input and by the strobes."""
    b.cl(0, 1, 2)
    b.jhl(0)
    b.jhr(1)
    pcap.lprs(pcap.AS.of(0, 1), pcap.LATCH_INFOS(san=2))
    b.lps(2, 7)
    b.jr({2: 6.5})
    b.step(130)
    b.lps(2, 0)
    for an in (0, 1, 2):
        b.wraux(an, float(sum(k * pcap.recording(an)[:, k].sum() for k in range(3))))
    pcap.lpr(pcap.LATCH_INFOS(san=2))
    b.jhi({0: 3.0, 1: -2.5})
    b.board.set_input(3, True)
    b.step(120)
    b.rdigi(0)
    b.wrlp(1, 4.5)
    b.wrlpndx(2, -3.25)
    b.szpa(0, 1.5)
    b.szpa(2, -2.5)
    for an in (0, 2):
        record = pcap.TSRP(an=an)
        pcap.rdlp(record)
        b.wraux(an, record.lp)
    b.jhi({0: -9.0, 1: 0.25})
    for number in (14, 15, 16):
        b.board.set_input(number, True)
    b.board.set_input(3, False)
    b.board.state.axis[2]["signals"] |= 0x20000
    b.step(80)
    for an in (0, 1, 2):
        record = pcap.TSRP(an=an)
        pcap.rdlp(record)
        b.wraux(an, record.lp)
    b.rdigi(2)
    b.jr({0: 4.0, 2: -3.0})
    b.step(10)
    b.board.set_input(3, True)
    b.step(10)
    for an in (0, 2):
        record = pcap.TSRP(an=an)
        pcap.rdlp(record)
        b.wraux(an, record.lp + 0.5)
    b.board.set_input(15, False)
    b.step(30)


PATHS = """
[[axis]]
[[axis]]
time_unit = "min"
jac = 3.0e6
jvl = 5000.0
[[axis]]
unit = "inch"
[[axis]]
unit = "deg"
effradius = 20.0
[[axis]]
unit = "rad"
gf = 0.3
"""


@scene(PATHS)
def moves(b: Bench) -> None:
    """Every interpolation at once, absolute and relative, with target velocities of either sign, in many units."""
    b.cl(0, 1, 2, 3, 4)
    b.szpa(1, 1.5)
    b.mla({0: 1.5, 1: -2.25, 2: 0.75}, (600.0, 40.0, 0.0))
    b.step(110, 10)
    b.mlr({1: 0.5, 3: 2.5}, (500.0, 60.0, -12.0))
    b.step(110, 10)
    b.mca((0, 1), (400.0, 30.0, 7.0), -100.0, 0.5, -1.75)
    b.step(110, 10)
    b.ms(0, 1)
    b.step(20)
    b.mcr((1, 0), (400.0, 30.0, 0.0), 145.0, 0.5, 0.25)
    b.step(110, 10)
    b.mcr((1, 0), (400.0, 9.0, 14.0), 20.0, 0.5, 0.25)
    b.step(60, 10)
    b.js(0, 1)
    b.step(20)
    b.mha({0: 1.25, 1: 0.75, 3: 4.5}, (500.0, 35.0, -6.0), 120.0, 1.0, -0.5)
    b.step(420, 20)
    b.js(0, 1, 3)
    b.step(10)
    b.mhr({1: 0.5, 0: -0.375, 2: 0.125}, (500.0, 35.0, 9.0), -0.0, 0.25, -0.5)
    b.step(110, 10)
    b.js(0, 1, 2, 3)
    b.step(20)
    b.mca3d((0, 1, 2), (300.0, 25.0, -5.0), 80.0, 1.0, 0.5, 3.0, 0.25, -0.5, 1.0)
    b.step(420, 20)
    b.js(0, 1, 2)
    b.step(20)
    b.mcr3d((2, 0, 1), (300.0, 25.0, 4.0), -60.0, 1.0, 0.75, -1.5, 1.0, 0.5, -0.25)
    b.step(110, 10)
    b.ms(0, 1, 2)
    b.step(30)


@scene(PATHS)
def units(b: Bench) -> None:
    """A line in each pair of units, of axes that fit, and what does not fit; other radius and resolution on the way."""
    b.cl(0, 1, 2, 3, 4)
    for pu, axes in (
        (0, (0, 3)),
        (1, (2, 0)),
        (2, (1,)),
        (3, (3, 4)),
        (4, (4,)),
        (5, (3,)),
        (6, (0, 1)),
        (7, (2,)),
    ):
        for tu in range(3):
            scale = (0.5, 0.02, 0.0005, 0.002, 0.75, 0.0125, 400.0, 500.0)[pu]
            time_s = (1.0, 60.0, 0.00128)[tu]
            b.ctru(pcap.TRU(pu=pu, tu=tu))
            b.mlr(dict.fromkeys(axes, scale), (scale * 900.0 * time_s**2, scale * 20.0 * time_s, 0.0))
            b.step(10)
    b.ctru(pcap.TRU(pu=0, tu=0))
    b.wrEffRadius(3, 35.0)
    b.mlr({0: 0.5, 3: 1.25}, (700.0, 40.0, 0.0))
    b.step(20)
    b.wrModeReg(0x400)
    b.mlr({0: 0.5, 3: 1.25}, (700.0, 40.0, 0.0))
    b.step(20)
    b.wrnfrax(0x12345678)
    b.mlr({0: 0.5, 1: 0.25, 3: 1.25}, (700.0, 40.0, 0.0))
    b.step(20)
    b.wrnfrax(-2)
    b.mlr({0: 0.5, 1: 0.25, 3: 1.25}, (700.0, 40.0, 0.0))
    b.step(20)
    b.ctru(pcap.TRU(pu=6, tu=0))
    b.wrslsp(0, 5000.0)
    b.wrgf(1, 0.4)
    b.mlr({0: 300.0, 1: 400.0}, (900000.0, 30000.0, 0.0))
    b.step(20)
    b.ctru(pcap.TRU(pu=4, tu=1))
    b.mlr({0: 1.0}, (100.0, 10.0, 0.0))
    b.ctru(pcap.TRU(pu=8, tu=0))
    b.step(10)


@scene(PATHS)
def queues(b: Bench) -> None:
    """Queued paths with look-ahead, limits of axes, tables, indices, target velocities, and what is refused."""
    b.cl(0, 1, 2, 3, 4)
    b.wrModeReg(0x81)
    b.wrMDVel(0, 3.0)
    b.wrMDVel(1, 5.0)
    b.wrMaxVel(2, 11.0)
    b.wrMaxAcc(0, 350.0)
    b.smlai({0: 1.0, 1: 0.5}, (500.0, 25.0, 20.0), index=41)
    b.smlri({0: 0.75, 1: -0.25}, (500.0, 30.0, 24.0), index=57)
    b.smcr((0, 1), (500.0, 18.0, 9.0), 65.0, 0.25, -0.75)
    b.smla({0: 2.5, 1: 1.25}, (500.0, 22.0, -8.0))
    b.ssfi(0, 1003, 600.0, 63)
    b.smlr({2: 0.125}, (500.0, 90.0, 60.0))
    b.smlr({2: 0.0625}, (500.0, 90.0, 0.0))
    b.spda(3, 5, b.points(0.25, 0.75, 1.5, 2.0, 2.25), 100)
    b.spdr(4, 4, b.points(0.25, -0.125, 0.5, 0.0625), 200)
    b.spd(4, 3, b.points(1.0, 1.25, 1.375))
    b.step(5)
    b.ssms(0, 1, 2, 3, 4)
    b.step(100)
    b.smlr({0: -2.0, 1: -1.0}, (500.0, 25.0, 20.0))
    b.smlr({0: -2.0, 1: 1.0}, (500.0, 25.0, 20.0))
    b.smha({0: 0.5, 1: 0.25, 2: 0.125}, (300.0, 12.0, 0.0), -90.0, 0.5, 0.75)
    b.smhr({0: 0.5, 1: 0.25, 3: 1.5}, (300.0, 12.0, 0.0), 0.0, 0.25, -0.5)
    b.smca((0, 1), (300.0, 12.0, 0.0), 40.0, 3.5, 0.75)
    b.smca3d((0, 1, 2), (300.0, 12.0, 0.0), 30.0, 1.0, 2.0, 3.0, 0.5, 0.25, 1.0)
    b.smcr3d((1, 2, 0), (300.0, 12.0, 0.0), -30.0, 1.0, -2.0, 3.0, 0.5, -0.25, 1.0)
    pcap.sstvl(pcap.AS.of(0, 1, 2), 3.0)
    b.ssms(0, 1, 2, 3)
    b.step(90)
    b.sstps(0)
    b.step(60)
    b.wrModeReg(0x10000081)
    b.ssms(0)
    b.step(60)
    b.sdels(0, 1, 2)
    b.step(40)
    b.ssms(0, 1, 2, 3)
    b.step(40)
    b.ra(0, 1)
    b.cl(0, 1)
    b.smlr({0: 2.0}, (500.0, 20.0, 20.0))
    b.smlr({0: 0.1}, (500.0, 20.0, 20.0))
    b.ssms(0)
    b.step(10)
    b.smlr({0: 0.09}, (500.0, 20.0, 20.0))
    b.step(60)


@scene("[[axis]]\ntime_unit = 'min'\n[[axis]]\nunit = 'deg'\n[[axis]]\nmotor = 'stepper'\n")
def values(b: Bench) -> None:
    """A number of its own in every register that the PC can write, then in each that a program can."""
    for k, name in enumerate(WRITES):
        for an in range(3) if name in OF_AXES else ("",):
            number = 3 * k + 2 + (an if isinstance(an, int) else 0)
            value = number if name in WHOLE else number / 8
            getattr(b, name)(*([] if an == "" else [an]), value)
    b.step(15)
    for an in range(3):
        record = pcap.TSRP(
            an=an, **{name: k + an / 4 for k, name in enumerate(("kp", "ki", "kd", "kpl", "kfca", "kfcv"))}
        )
        pcap.uf(record)
    b.step(5)
    qualifiers = [
        each for each in AXIS_QUALIFIERS.values() if each.writable and each.name not in ("tp", "lp")
    ]
    program = [
        f"A{an + 1}.{each.name}{'[7]' if each.indexed else ''} := {3 * k + an + 2}"
        + ("" if each.kind == "i" else ".625")
        for k, each in enumerate(qualifiers)
        for an in range(3)
    ]
    words = [each for each in SYSTEM_VARIABLES.values() if each.writable and each.name not in ("pu", "tu")]
    program += [
        f"{each.name}{'[11]' if each.indexed else ''} := {3 * k + 5}" + ("" if each.kind == "i" else ".125")
        for k, each in enumerate(words)
    ]
    program += [
        "pu := 5",
        "tu := 1",
        "CI20 := A2.varint[7] + sysvarint[11]",
        "CD20 := A3.vardbl[7] - sysvardbl[11]",
    ]
    b.program(f"BEGIN {'; '.join(program)} END.")
    b.step(15)


@scene("[[axis]]\n[[axis]]\n")
def words(b: Bench) -> None:
    """What expressions of programs give, of constants and of variables, in whole numbers and in others."""
    whole: tuple[str, ...] = (
        "a + b",
        "a - b",
        "a * b",
        "a DIV b",
        "a MOD b",
        "b DIV a",
        "b MOD a",
        "a AND b",
        "a OR b",
        "a XOR b",
    )
    whole += (
        "a SHL 3",
        "b SHR 2",
        "-a",
        "NOT b",
        "ABS(b)",
        "SQR(b)",
        "TRUNC(x)",
        "ROUND(x)",
        "TRUNC(y)",
        "ROUND(y)",
    )
    real: tuple[str, ...] = (
        "x + y",
        "x - y",
        "x * y",
        "x / y",
        "a / b",
        "ABS(y)",
        "SQR(y)",
        "SQRT(x)",
        "SIN(x)",
        "COS(y)",
        "TAN(x)",
    )
    real += ("ARCTAN(y)", "LN(x)", "EXP(y)", "x + a", "-y", "a * x - b * y", "(x + 1) * -2")
    tests: tuple[str, ...] = (
        "a < b",
        "a <= 37",
        "a > b",
        "a >= 38",
        "a = 37",
        "a <> b",
        "ODD(a)",
        "ODD(b)",
        "x < y",
        "NOT (x = y)",
    )
    tests += ("(a > 0) AND (b > 0)", "(a > 0) OR (b > 0)", "(a > 0) XOR (b < 0)", "x <= 2.5")
    lines = [f"CI[{20 + k}] := {each}" for k, each in enumerate(whole)]
    lines += [f"CD[{20 + k}] := {each}" for k, each in enumerate(real)]
    lines += [f"IF {each} THEN CI[{60 + k}] := 1 ELSE CI[{60 + k}] := 2" for k, each in enumerate(tests)]
    begin = "VAR a, b, k: INTEGER; x, y: DOUBLE; BEGIN a := 37; b := -11; x := 2.5; y := -1.75;"
    b.program(f"{begin} {'; '.join(lines)} END.")
    b.step(20)
    b.program(
        f"{begin} FOR k := 7 DOWNTO 3 DO CI1 := CI1 * 2 + k; CASE b + 14 OF 1, 2: CI2 := 5; 3..4: CI2 := 6 ELSE "
        "CI2 := 7 END; WHILE a > 30 DO BEGIN a := a - 2; CI3 := CI3 + a END; REPEAT b := b + 4 UNTIL b > 2; CI4 := b; "
        "CD1 := $FF * 1E-2; x := CI1 / 4; WRITE(x:9:2, a, TRUE, b:6); WRITELN END.",
        2,
    )
    b.step(10)
    for k, letter in enumerate(pcap.gettskstr(2)[1]):
        b.wrAxVarInt(1, k, ord(letter))
        pcap.wrcd(100 + k, pcap.CDBUF(cd=[float(ord(letter))] * 1000))
    b.step(5)


@scene(PATHS)
def refusals(b: Bench) -> None:
    """What sets a bit of the error register or dhef, with and without the modes that have a say."""
    b.mlr({0: 1.0}, (100.0, 10.0, 0.0))
    b.cl(0, 1)
    b.step(5)
    b.wrModeReg(0x80000)
    b.mlr({0: 1.0}, (100.0, 0.0, 0.0))
    b.step(5)
    b.mlr({0: 1.0}, (0.0, 10.0, 0.0))
    b.wrModeReg(0)
    b.ra(0)
    b.cl(0)
    b.step(5)
    pcap.mlr(pcap.AS(2, [1, 1, *[0] * 16]), pcap.LMP(ac=100.0, vl=10.0))
    b.step(5)
    b.mlr({0: 1.0}, (100.0, 0.0, 0.0))
    b.step(5)
    b.ra(0)
    b.cl(0)
    b.mlr({1: 1.0}, (0.0, 10.0, 0.0))
    b.step(5)
    b.wrModeReg(0x80000)
    b.mlr({0: 1.0}, (100.0, 0.0, 0.0))
    b.mcr((1, 0), (100.0, 10.0, 0.0), 30.0, 0.0, 0.0)
    b.step(5)
    b.smlr({0: 0.0, 1: 0.0}, (100.0, 10.0, 0.0))
    b.smlr({1: -1.0}, (-100.0, 10.0, 0.0))
    b.wrjac(1, 0.0)
    b.jr({1: 2.0})
    b.step(5)
    b.board.raise_error(ErrorReg(0x40380))
    b.wrModeReg(0x40000)
    b.smlr({0: 0.75}, (400.0, 20.0, 15.0))
    b.ssf(0, 1003, 700.0)
    b.ssms(0)
    b.step(60)
    b.cl(0)
    b.smlr({0: 0.01}, (400.0, 20.0, 20.0))
    b.smlr({0: 0.01}, (400.0, 20.0, 20.0))
    b.ssms(0)
    b.step(20)


@scene("[[axis]]\n[[axis]]\nmotor = 'stepper'\n[[axis]]\nmcp_inverted = true\n[[axis]]\n")
def special(b: Bench) -> None:
    """Special functions of four spoolers: variables, outputs, waits of every kind, motor commands, interrupts."""
    b.cl(0, 1, 3)
    commands = (
        *(
            (0, 7.9),
            (999, -3.5),
            (321, 5e9),
            (11000, 3.0),
            (10321, 0x101),
            (10999, -2147483648.0),
            (20999, -1.75),
        ),
        *(
            (20000, 2.5),
            (1001, 0x1A5),
            (1101, 0.0),
            (1002, 0x21),
            (1003, 500.0),
            (1101, 2.0),
            (1202, 4321.0),
            (1000, 0.0),
        ),
        *((1101, 1.0), (5, 6.0), (1004, 0x0A), (6, 7.0), (1006, 11.0), (7, 8.0), (1005, 3.0), (8, 9.0)),
        *((1015, -2.0), (9, 10.0), (1025, 0.0), (10, 11.0), (1207, 1.0), (11010, 2.0)),
    )
    for command, value in commands:
        b.ssf(0, command, value)
    for an in (1, 3):
        b.ssf(an, 1006, 11.0)
        b.ssf(an, 1005, 4.0)
        b.ssf(an, 1015, 2.0)
        b.ssf(an, 1025, 0.0)
        b.ssf(an, 50 + an, 1.0)
    b.ssms(0)
    b.step(40)
    b.program("BEGIN CI70 := irqpc + 6; irqpc := 0; CI71 := irqpc + 3; ledrd := 1; ledyl := ledrd + 1 END.")
    b.ssms(0, 1)
    b.step(20)
    b.board.set_input(2, True)
    b.step(10)
    b.board.set_input(4, True)
    b.ssms(3)
    for _ in range(4):
        b.step(15)
        b.ClearCI99()
    b.step(15)
    b.smlr({0: 0.75}, (400.0, 20.0, 11.0))
    b.ssf(0, 2001, 0.0)
    b.ssf(0, 1003, 2000.0)
    b.ssf(0, 12, 1.0)
    b.ssms(0)
    b.step(60)
    b.ssms(0)
    b.step(10)


@scene(LAGS)
def overrides(b: Bench) -> None:
    """Overrides of jogs and paths: at once and in their time, copied and not, through stops and resets."""
    b.ctru(pcap.TRU(pu=0, tu=0))
    b.cl(0, 1, 2)
    b.wrtrovrst(0.08)
    b.wrtrovr(0.5)
    b.jr({1: 0.4})
    b.smlr({0: 1.5, 2: -2.0}, (300.0, 25.0, 0.0))
    b.ssms(0, 2)
    b.step(20)
    b.utrovr(0, 1, 2)
    b.step(60)
    b.wrModeReg(0x20000)
    b.wrtrovrst(0.0)
    b.wrtrovr(1.75)
    b.utrovr(0, 2)
    b.step(40)
    b.wrjovr(1, 0.25)
    b.jr({1: -0.3})
    b.mlr({0: -1.5, 2: 2.0}, (300.0, 25.0, 4.0))
    b.step(40)
    b.ms(0, 2)
    b.step(15)
    b.wrtrac(55.0)
    b.wrModeReg(0x8000 | 0x10000)
    b.mlr({0: 2.5}, (300.0, 25.0, 0.0))
    b.step(30)
    b.ms(0)
    b.step(40)
    b.ra(1)
    b.step(5)
    b.rs()
    b.step(5)


@scene(LAGS)
def programs(b: Bench) -> None:
    """Three tasks that move axes, wait, compute, write and control each other."""
    b.program(
        "VAR n: INTEGER; s: DOUBLE; t: ARRAY[1..4] OF DOUBLE;\n"
        "PROCEDURE add(k: INTEGER; d: DOUBLE); VAR e: DOUBLE; BEGIN e := d * 2; t[k] := t[k] + e - s END;\n"
        "BEGIN\n"
        "  pu := 0; tu := 0; trac := 300; trvl := 20; trtvl := 0; cl (A1, A2, A3);\n"
        "  FOR n := 1 TO 4 DO add(n, n / 8);\n"
        "  mlr (A1 := t[4], A3 := -1.5); wt (A1, A3);\n"
        "  CD1 := t[1] + 10 * t[2] + 100 * t[3]; CI1 := ROUND(t[4] * 1000) XOR 5;\n"
        "  smlr (A1 := -0.5, A2 := 0.03125); ssf (A1, 1001, 4); ssms (A1, A2); wt (A1, A2);\n"
        "  A2.jovr := 0.5; jr (A2 := 0.125); wt (40); js (A2); s := A1.rp; CD2 := s;\n"
        "  WRITE('at ', s:8:3); startcnct (1); WRITELN;\n"
        "  REPEAT CI2 := CI2 + 3 UNTIL CI2 > 50; shp (A1 := 2.5); szpa (A2, 0.25); rdigi (A1);\n"
        "  A3.dpoffset := 0.75; A1.varint[7] := 70; sysvardbl[9] := 9.5; WRCBI(8, -5);\n"
        "  WRCBB(3, 200); WRCBD(16, -2.75); ABORT\n"
        "END.\n",
        0,
    )
    b.program(
        "BEGIN CI5 := CI5 + 1; CI6 := RDCBI(8) DIV 2; STOP; CI7 := CI6 SHL 3; IF CI5 > 1 THEN CI8 := 1 END.",
        1,
    )
    b.program(
        "EVENT e ON CI2 > 30; BEGIN CI9 := CI9 + 1; contcnct (1) END;\nBEGIN WHILE TRUE DO CD9 := CD9 + 1 END.",
        2,
    )
    for _ in range(6):
        b.step(60, 10)
    for task in (0, 1):
        pcap.rdcbcnct(buffer := pcap.CBCNCT(task_number=task, size=24, buffer=bytearray(24)))
        for k, byte in enumerate(buffer.buffer):
            b.wrAxVarInt(task, 20 + k, byte)
        pcap.wrcbcnct(pcap.CBCNCT(task_number=1, size=24, buffer=bytearray(buffer.buffer)))
    code, text = pcap.gettskstr(0)
    b.wrAxVarDbl(0, 3, float(code))
    b.wrSysVarInt(5, pcap.gettskinfo(0)[1] * 10 + len(text.strip()))
    b.wrSysVarDbl(6, pcap.rdSysVarDbl(9) + pcap.rdAxVarInt(0, 7) + pcap.rdAxVarDbl(0, 3))
    b.program(
        "BEGIN CI11 := RDCBB(3); CI12 := RDCBI(8); CD6 := RDCBD(16); "
        "CD3 := sysvarint[5]; CD4 := sysvardbl[6]; CD5 := A1.vardbl[3]; CD7 := A1.varint[23] + A1.varint[28]; rs END.",
        1,
    )
    b.step(20)


def mix(seed: int, b: Bench) -> None:
    """Make random calls."""
    Mixture(b, seed).run(36)


for seed in (1, 2, 3, 4):
    SCENES[f"mixed{seed}"] = (MIXED, partial(mix, seed))


SCENES |= CONDITIONS | ENDS


def walk(seed: int, b: Bench) -> None:
    """Ask for anything, from the PC and from programs."""
    Walk(b, seed).run(180)


for seed in (1, 2, 3, 4):
    SCENES[f"walk{seed}"] = (MIXED if seed % 2 else OTHER_UNITS, partial(walk, seed))

WITH_PROGRAM = ("values", "jogs", "steppers", "queues", "overrides", "walk2", "walk3", "readers")

# What the scenes show of the manual: these parts of the inventory, without what needs no board at work.
PARTS = re.compile(
    r"2\.\d|PCAP functions|ctru|axst|digi|rddigib|ErrorReg|ifs|S profile|ssf|digo|gettskinfo|Functions named"
    r"|Digital input|MODEREG|SAP|rw_SymPas|Axis |wrdigob|Cross-function|Numeric facts"
)
RECORDS = re.compile(
    r"apci\.(TSRP|LMP|CMP|HMP|HMP3D|TRU|CBCNCT)\.(?!epc|scratch|an)|apci\.(LMP|CMP|HMP|HMP3D|TRU|AS|AS\.unoa|AS\.san)$"
    r"|apci\.(SPDBUF|CDBUF|CIBUF|CBCNCT|CNCTS|InterruptRoutine|rwmos|sap|sap\.multitasking|pcap\.general\.units)$"
    r"|apci\.CNCTS\.(errnum|errline|running|csrcline|running\.bit[03])$"
)
ELSEWHERE = re.compile(
    r"(apci|sap)\.(\w*Boot\w*|CardSelect|MsgToScreen|getEnvStr|Init\w+|mcuinit|MCUG3_Reset\w+|txbf\w*|rdepc"
    r"|scp|stepcnct|stopcnct|wrci|ErrorReg\.(4|6|11|14|20)\.\w+|const\.(eeprom|cncount|cbsize|taskstr|spdsize|phithreshold)"
    r"|rule\.(versions|toolradius_spline|relays|commonpersist)|comment|STOPCNCT"
    r"|errors|task_roles)"
)
CONFORMANCE = load_conformance()
ROWS = [
    row.id
    for row in CONFORMANCE.rows("apci")
    if (PARTS.match(row.group) or RECORDS.match(row.id)) and not ELSEWHERE.fullmatch(row.id)
    if CONFORMANCE.state(row.id) is not State.NOT_APPLICABLE
]


@pytest.mark.covers(*ROWS)
@pytest.mark.parametrize("name", SCENES)
def test_a_board_does_what_is_written_down(name: str, request: pytest.FixtureRequest) -> None:
    system, act = SCENES[name]
    bench = Bench(system, program=name in WITH_PROGRAM)
    act(bench)
    pcap.detach()
    file, found = RECORDED / f"{name}.txt", bench.text()
    if request.config.getoption("update_goldens"):
        file.write_text("\n".join([*found, ""]), encoding="utf-8")
    wanted = file.read_text(encoding="utf-8").splitlines()
    assert difference(found, wanted, lambda number: near(number, rel=1e-8, abs=1e-9)) == ""
