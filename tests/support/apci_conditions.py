"""Scenes of conditions that stand beside another: each is the one that decides, at least once.

Waits that are entered, left and ended in every way; stops of what stops already; limits that are moved away; numbers
that are none; units of look-ahead and limits of axes.
"""

from __future__ import annotations

import math

from polycnc.controllers.apci import pcap
from support.apci_bench import OF_AXES, WHOLE, WRITES, Bench

TWO = "[[axis]]\n[[axis]]\n"


def waits(b: Bench) -> None:
    """Waits that are entered, skipped, left by stops and jogs, met at once, and refused after a move at speed."""
    b.cl(0, 1)
    for leave in (b.js, b.ms, b.sdels, b.ol, b.cl, b.ra):
        for command, value in ((1003, 9000.0), (1004, 0x20), (1006, 3.0), (1005, 3.0), (1025, 0.0)):
            b.cl(0, 1)
            b.ssf(0, command, value)
            b.ssf(0, 20 + command % 9, value + 0.5)
            b.ssms(0)
            b.board.advance(3)
            b.ssms(0)  # ends waits for time and inputs only
            b.board.advance(2)
            b.step(1, 1)
            leave(0)
            b.board.advance(1)
            b.ssms(0)
            b.step(1, 1)
            b.ClearCI99()
    b.cl(0, 1)
    b.ssf(0, 1003, 3000.0)  # 150 scans
    b.ssf(0, 31, 1.0)
    b.ssms(0)
    b.step(3, 3)
    b.sstps(0)
    b.jr({1: 1.0})
    b.step(150, 150)
    b.ssms(0)
    b.step(3, 3)
    for value in (0.0, -5.0, 19.0, 20.0, 21.0, 1e30):
        b.ssf(0, 1003, value)
        b.ssf(0, 32, value)
        b.ssms(0)
        b.step(1, 1)
        b.step(1, 1)
    b.js(0)
    b.board.set_input(6, True)
    b.board.set_input(1, True)
    for mask in (0x21, 0x23, 0x0):
        b.ssf(0, 1004, mask)
        b.ssf(0, 33, mask + 1)
        b.ssms(0)
        b.step(2, 2)
    b.board.set_input(2, True)
    b.step(2, 2)
    b.ssf(0, 1006, 3.0)  # the other axis stands at something else, then at another barrier, then there
    b.ssf(0, 34, 1.0)
    for command, value in ((1003, 200.0), (1006, 2.0), (1006, 3.0)):
        b.ssf(1, command, value)
        b.ssf(1, 35, value)
    b.ssms(0, 1)
    for _ in range(4):
        b.step(4, 4)
    for command, value in ((0, 1e17), (1, -1e17), (7777, 5.0), (1007, 5.0), (12000, 5.0), (21000, 5.0)):
        b.ssf(0, command, value)
    b.ssms(0)
    b.step(2, 2)
    points = b.points(3.0, 3.25, 3.5, 3.75)
    for follows in range(6):
        b.cl(0, 1)
        b.shp(0, tp=0.0)
        b.smla({0: 2.0}, (900.0, 30.0, 20.0))
        if follows == 0:
            b.ssf(0, 41, 1.0)
        elif follows < 4:
            b.spd(0, 4, points)
            b.ssf(0, 1003, 300.0) if follows == 1 else None
            b.smla({0: 5.0}, (900.0, 30.0, 0.0)) if follows == 2 else None
            b.spd(0, 3, points) if follows == 3 else None
        elif follows == 4:
            b.smla({0: 4.0}, (900.0, 8.0, 0.0))  # slower than it comes
        else:
            b.ssf(0, 1003, 500.0)  # not after a move at speed
            b.ssf(0, 42, 2.0)
        b.ssms(0)
        b.step(60, 20)
        b.step(60, 20)
    b.cl(0)
    b.wrModeReg(0x40000)
    b.smla({0: 9.0}, (900.0, 30.0, 25.0))
    b.ssms(0)
    b.step(20, 20)
    b.sstps(0)  # it runs empty while it is halted: no reset
    b.step(240, 60)
    b.wrModeReg(0)
    for lengths in ((0.01,), (0.01, 2.0), (0.01, 2.0, 0.01), (0.01, 0.01)):  # two in a row are too short
        b.cl(1)
        for length in lengths:
            b.smlr({1: length}, (900.0, 30.0, 30.0))
        b.ssms(1)
        b.step(80, 40)
    b.ends = b.ends[3::8]


STOPS = """
[[axis]]
sll = -2.0
slr = 2.0
soft_left = "SMA"
soft_right = "SMA"
sdec = 300.0
[[axis]]
sll = -2.0
slr = 2.0
soft_left = "SMD"
soft_right = "SMD"
sdec = 500.0
[axis.plant]
limit_right = 7.0
limit_left = -7.0
[[axis]]
sll = -2.0
slr = 2.0
soft_left = "TOM"
soft_right = "TOM"
motor = "stepper"
mcpmax = 900
mcpmin = -700
[[axis]]
mcpmin = -32000
mcpmax = 9000
jtvl = 6.0
backlash = 0.25
[axis.plant]
kind = "lag"
lag_s = 0.003
[inputs]
1 = { functions = ["LSR_TOM"], axes = ["A2"] }
2 = { functions = ["LSL_SMD"], axes = ["A2"] }
"""


def stops(b: Bench) -> None:
    """Limits moved away, jumps beyond them, stops of what stops, commands after others that still act."""
    for an, zero in ((0, 0.5), (1, 0.0), (2, 0.25), (3, 1.0)):
        b.shp(an, tp=zero)
    b.wrmcp(2, 800)  # past its limits with the loop open
    b.step(300, 100)
    b.wrmcp(2, -2000)
    b.step(100, 100)
    b.ol(2)
    b.shp(2, tp=1.5)
    b.ol(2)
    b.step(1, 1)
    b.shp(2, tp=0.5)
    b.wrrp(2, 0.75)
    b.step(1, 1)
    b.cl(0, 1, 2, 3)
    b.wrrp(1, 4.0)
    b.jr({0: 4.0, 1: 1.75, 2: 1e-4})
    b.step(90, 30)
    b.wrslr(0, 3.0)  # held by software: it jumps on
    b.step(4, 2)
    b.wrdpoffset(1, 0.5)  # from rest over the limit in one scan
    b.step(2, 1)
    b.smlr({1: -1.0}, (500.0, 20.0, 0.0))
    b.ssms(1)
    b.step(20, 20)
    b.wrdpoffset(1, 0.0)
    b.jr({1: -1.0})
    b.step(30, 30)
    b.jr({1: 8.0, 0: -2.0})
    b.step(70, 10)
    b.smlr({1: -0.5}, (500.0, 20.0, 0.0))  # while the limit brakes it
    b.step(40, 40)
    b.cl(0, 1)
    b.jr({0: -3.0})
    b.step(15, 15)
    b.jr({0: 1.5})  # first it has to turn
    b.step(6, 6)
    b.wrjovr(0, 0.5)
    b.step(60, 20)
    b.mlr({0: -2.0, 3: 1.0}, (300.0, 20.0, 0.0))
    b.step(30, 30)
    b.js(0)
    b.step(2, 2)
    b.smlr({0: 0.25}, (300.0, 20.0, 0.0))
    b.ms(0, 3)
    b.step(3, 3)
    b.ms(0, 3)
    b.js(3)
    b.ssms(0)
    b.step(80, 40)
    b.smlr({0: 0.5}, (300.0, 20.0, 15.0))
    b.ssms(0)
    b.step(12, 12)
    pcap.sstvl(pcap.AS.of(0), 0.0)
    b.step(10, 10)
    b.ms(0)
    b.step(2, 2)
    pcap.sstvl(pcap.AS.of(0), 9.0)
    b.step(30, 10)
    b.js(0, 1, 2, 3)
    b.step(10, 10)
    b.jr({3: 1.0})  # ends with 6 mm/s
    b.step(80, 40)
    b.wrdp(3, 9.0)
    b.ms(3)
    b.step(20, 20)
    b.wrdvoffset(3, 2.0)
    b.wrdpoffset(3, 0.5)
    b.step(30, 30)
    b.wrdvoffset(3, 0.0)
    b.wrdpoffset(3, -0.25)
    b.step(3, 3)
    b.wrdp(3, 5.0)
    b.step(3, 3)
    b.wrmcp(3, 31000)
    b.ol(3)
    b.wrmcp(3, 31000)
    b.step(3, 3)
    b.wrmcp(3, -31000)
    b.step(3, 3)
    b.cl(3)
    b.wrjvl(3, -5.0)
    b.jr({3: 1.0})
    b.step(20, 20)
    b.jr({3: -1.0})
    b.step(20, 20)
    b.js(3)
    b.lps(0, 4)
    b.lps(0, -1)
    b.jr({0: 0.75})
    b.step(11, 11)
    b.wrjac(3, 0.0)
    b.jr({3: 1.0})
    b.step(4, 4)
    b.wrjovr(0, 0.75)
    b.wrModeReg(0x20000)
    b.utrovr(0, 1)
    b.step(4, 4)
    b.wrModeReg(0)
    b.utrovr(0)
    b.step(4, 4)
    b.program(
        "BEGIN A1.jovr := -0.5; A2.jovr := 0; A1.jovr := 0.25; trovr := 0; trovr := -2.0; trovrst := -1.0; "
        "CD1 := trovr; CD2 := trovrst; CD3 := A1.jovr; irqpc := 1; irqpc := 0; pu := 9; trac := 500; "
        "trvl := 10; mlr (A1 := 1.0); CI3 := errorreg; pu := 0; tu := 7; mlr (A1 := 1.0); tu := 0; CI4 := errorreg END."
    )
    b.step(10, 10)


SCALES = """
[[axis]]
[[axis]]
unit = "deg"
effradius = 20.0
[[axis]]
unit = "deg"
[[axis]]
unit = "counts"
"""


def scales(b: Bench) -> None:
    """Look-ahead, limits of axes and TRAC in other units than mm and s; paths that close, and what is none."""
    b.cl(0, 1, 2, 3)
    for pu, tu, scale, time_s in ((1, 1, 25.4, 60.0), (2, 2, 1000.0, 0.00128), (1, 2, 25.4, 0.00128)):
        b.ctru(pcap.TRU(pu=pu, tu=tu))
        vl, ac = time_s / scale, time_s**2 / scale
        for an in (0, 1):
            b.wrMaxVel(an, (11.0 + an) * vl)
            b.wrMaxAcc(an, (150.0 + an) * ac)
            b.wrMDVel(an, (4.0 + an) * vl)
        b.wrModeReg(0x8081)
        b.wrtrac(90.0 * ac)
        for x, y in ((0.75, 0.25), (0.5, -0.5), (0.5, 0.0)):
            b.smlr({0: x / scale, 1: y / scale}, (400.0 * ac, 30.0 * vl, 25.0 * vl))
        b.smlr({0: 0.5 / scale, 1: 0.5 / scale}, (400.0 * ac, 30.0 * vl, -25.0 * vl))
        b.ssms(0, 1)
        b.step(120, 40)
        b.smlr({0: 0.25 / scale}, (400.0 * ac, 9.0 * vl, 8.0 * vl))  # comes late
        b.ms(0, 1)
        b.step(40, 20)
        b.cl(0, 1)
        b.mlr({0: 5.0 / scale}, (400.0 * ac, 30.0 * vl, 0.0))
        b.step(20, 20)
        b.smlr({0: 1.0 / scale}, (400.0 * ac, 20.0 * vl, 8.0 * vl))  # while a direct move runs
        b.ms(0)
        b.step(20, 20)
        b.cl(0, 1)
        b.ra(0, 1)
        b.cl(0, 1)
    b.ctru(pcap.TRU(pu=0, tu=0))
    b.wrModeReg(0)
    for axes in ((2,), (3,), (0, 2), (0, 3)):
        b.mlr(dict.fromkeys(axes, 1.0), (300.0, 20.0, 0.0))  # no radius, or no angle
        b.step(4, 4)
    b.mlr({0: 1.0}, (300.0, -20.0, 0.0))
    b.smlr({0: 1e-10}, (300.0, 20.0, 0.0))
    b.step(4, 4)
    b.ra(0, 1, 3)
    b.cl(0, 1, 3)
    b.ctru(pcap.TRU(pu=6, tu=0))
    b.mlr({0: 100.0, 3: -250.0}, (300000.0, 20000.0, 0.0))
    b.step(20, 20)
    b.ctru(pcap.TRU(pu=0, tu=0))
    b.cl(0, 3)
    for phi in (0.0, -0.0):
        b.mha({0: 0.0, 1: 0.0}, (3000.0, 60.0, 0.0), phi, 0.5, 0.0)  # a whole turn either way
        b.step(40, 20)
        b.js(0, 1)
        b.cl(0, 1)
        b.ra(0, 1)
        b.cl(0, 1)
    one, two = pcap.AS.of(0), pcap.AS.of(0, 1)
    pcap.mcr(one, pcap.CMP(ac=300.0, vl=20.0, phi=90.0, dtca1=1.0))
    pcap.mcr3d(two, pcap.HMP3D(ac=300.0, vl=20.0, phi=90.0, dtca1=1.0, pn3=1.0))
    for count in (0, -1, 19):
        selected = pcap.AS.of(0)
        selected.unoa = count
        pcap.smlr(selected, pcap.LMP(ac=300.0, vl=20.0, dtm=[1.0]))
        pcap.ol(selected)
    points = b.points(0.5, 0.75)
    for size in (0, -1, 1001):
        b.spd(0, size, points)
        b.spda(0, size, points, 5)
        b.spdr(0, size, points, 5)
    b.step(4, 4)
    for name in WRITES:
        for value in () if name in WHOLE else (math.inf, -math.inf, math.nan):
            getattr(b, name)(*([1] if name in OF_AXES else []), value)
    for call in (pcap.wrtp, pcap.wrlp, pcap.wrlpndx, pcap.shp, pcap.uf):
        call(pcap.TSRP(an=1, tp=math.nan, lp=math.inf, kp=math.nan))
    b.szpa(1, math.inf)
    b.szpr(1, math.nan)
    b.ssf(1, 5, math.inf)
    pcap.sstvl(two, math.nan)
    pcap.wrcd(5, pcap.CDBUF(cd=[math.inf] * 1000))
    b.jr({0: math.inf})
    b.mlr({0: math.nan}, (300.0, 20.0, 0.0))
    b.smlr({0: 1.0}, (math.inf, 20.0, 0.0))
    b.step(4, 4)
    for exchange in (pcap.wrci, pcap.rdci):
        exchange(-1, pcap.CIBUF(ci=[7] * 1000))
        exchange(1000, pcap.CIBUF(ci=[7] * 1000))
    b.step(4, 4)


def changes(b: Bench) -> None:
    """Overrides that change, at once or in their time, while ramps are bent or a path comes back to its target."""
    b.cl(0, 1)
    b.wrJerkRel(0, 0.625)
    for mode in (0x10000, 0x30000, 0):
        b.wrModeReg(mode)
        b.mlr({0: 2.0, 1: 0.5}, (300.0, 20.0, 0.0))
        b.step(16, 8)
        b.wrtrovrst(0.05)
        b.wrtrovr(0.5)
        b.utrovr(0, 1)
        b.step(40, 8)
        b.wrtrovrst(0.0)
        b.wrtrovr(1.25)
        b.utrovr(0)
        b.step(24, 8)
        b.js(0, 1)
        b.cl(0, 1)
        b.jr({0: 1.5})
        b.step(24, 8)
        b.wrjovr(0, 0.625)
        b.step(24, 8)
        b.js(0)
        b.step(8, 8)
        b.utrovr(0, 1)
        b.cl(0, 1)
    for tvl in (-12.0, 12.0):
        b.mlr({0: 1.0}, (300.0, 20.0, tvl))
        for override in (0.75, 1.125, 0.5, 1.0, 0.625, 1.25):
            b.step(18, 9)
            b.wrtrovr(override)
            b.utrovr(0)
        b.step(40, 20)
        b.cl(0)
    b.jhl(0)
    b.step(16, 8)
    b.wrjovr(0, 0.5)
    b.step(16, 8)
    b.board.set_input(1, True)
    b.step(2, 2)
    b.wrjovr(0, 1.5)  # it has found the switch and brakes
    b.step(24, 8)


READ_TWICE = """
board_type = "APCI-8008"
[[axis]]
time_unit = "min"
jac = 2.0e6
jvl = 2000.0
backlash = 0.125
mpe = 0.5
ipw = 0.01
[axis.plant]
kind = "lag"
lag_s = 0.004
index = 0.0625
[[axis]]
motor = "stepper"
unit = "deg"
effradius = 9.0
slsp = 900.0
[inputs]
1 = { functions = ["EO"], axes = ["A1"] }
3 = { functions = ["LP"], axes = ["A1"], inverted = true }
[rulings]
instructions_per_scan = 2000
"""


def readers(b: Bench) -> None:
    """What programs read is the same in the compiled scan and out of it, where one does not fit into it."""
    names = b.read_by_program
    lines = "; ".join(f"CD[{600 + k}] := {name}" for k, name in enumerate(names))
    b.program(f"VAR t: ARRAY[1..9999] OF DOUBLE; BEGIN WHILE TRUE DO BEGIN {lines} END END.", 2)
    b.cl(0, 1)
    b.board.axes[1].alarms = 0xF00000
    cd = b.board.state.cd

    def compare(scans: int) -> None:
        for _ in range(scans):
            b.board.advance(1)
            b.tell(sum(cd[300 + k] != cd[600 + k] for k in range(len(names))))
        b.step(1, 1)

    b.wrtrovr(0.75)
    b.wrtrovrst(0.01)
    b.smlai({0: 0.75, 1: -4.0}, (900.0, 30.0, 0.0), index=5)
    b.spda(1, 3, b.points(1.0, 2.0, 3.0), 9)
    b.ssms(0, 1)
    b.utrovr(0, 1)
    b.board.set_input(1, True)
    b.board.set_input(9, True)
    b.wrdigo(0, 0x5A)
    b.wrmcp(1, 77)
    compare(4)
    b.wraux(0, -1.5)
    b.szpa(1, 3.0)
    b.wrlpndx(0, 2.5)
    b.wrdpoffset(0, 0.125)
    b.wrgfaux(1, 2.5)
    b.wrGCR(0, -7)
    b.wrControllerFlags(1, 0x12345)
    b.wrnfrax(-2)
    b.wrModeReg(-5)
    b.ctru(pcap.TRU(pu=4, tu=2))
    b.wrledyl(1)
    compare(6)
    b.js(0, 1)
    b.board.variables.interface.report(0x80000)
    b.board.variables.irqpc = 1
    compare(3)
    b.rifs(0)
    b.jr({0: -2.0})
    compare(5)
    b.ol(0, 1)
    b.wrmcp(1, -900)
    compare(3)


REFERENCE = (
    "[[axis]]\nhac = 200.0\nhvl = 30.0\njerkrel = 0.5\n[[axis]]\n"
    "[inputs]\n1 = { functions = ['REF'], axes = ['A1'] }\n"
)
CONDITIONS = {
    "readers": (READ_TWICE, readers),
    "changes": (REFERENCE, changes),
    "waits": (TWO, waits),
    "stops": (STOPS, stops),
    "scales": (SCALES, scales),
}
