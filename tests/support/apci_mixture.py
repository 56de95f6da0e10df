"""Random calls of the library on a board of unlike axes: what no scene that somebody thought up has side by side."""

from __future__ import annotations

import random
from collections.abc import Callable

from polycnc.controllers.apci import pcap
from support.apci_bench import Bench

MIXED = """
board_type = "APCI-8008"
[[axis]]
jac = 700.0
jvl = 60.0
sll = -30.0
slr = 30.0
soft_left = "SMD"
soft_right = "SMA"
backlash = 0.03125
ipw = 0.125
mpe = 3.0
kp = 40.0
ki = 5.0
kfcv = 0.5
[axis.plant]
kind = "lag"
lag_s = 0.004
index = 2.5
reference = [-6.0, -3.0]
[[axis]]
unit = "deg"
display_unit = "rev"
time_unit = "min"
jac = 2.0e6
jvl = 3000.0
jtvl = 300.0
effradius = 25.0
gf = 0.75
jerkrel = 0.375
sdec = 1.5e6
[axis.plant]
index = -20.0
reference = [15.0, 40.0]
[[axis]]
motor = "stepper"
unit = "inch"
jac = 20.0
jvl = 2.5
sdec = 35.0
slsp = 800.0
sll = -1.5
slr = 1.25
soft_left = "TOM"
soft_right = "SMD"
[[axis]]
jac = 500.0
jvl = 45.0
mcp_inverted = true
mcpmax = 12000
mcpmin = -9000
hac = 400.0
hvl = 12.0
[axis.plant]
kind = "lag"
lag_s = 0.006
reference = [3.0, 7.0]
[inputs]
1 = { functions = ["REF"], axes = ["A1", "A2"] }
2 = { functions = ["LP"], axes = ["A1", "A4"] }
3 = { functions = ["LSL_SMA"], axes = ["A2"] }
4 = { functions = ["LSR_SMD"], axes = ["A4"] }
5 = { functions = ["UI", "EO"], axes = ["A3"], inverted = true }
6 = { functions = ["DR"], axes = ["A2", "A3"] }
[outputs]
1 = { functions = ["PAE"], axes = ["A1", "A3"] }
6 = { functions = ["PAE"], axes = ["A4"] }
3 = { set_at_reset = true }
[board]
trac = 170.0
"""

AXES = range(4)
SCALE = (1.0, 9.0, 0.05, 1.0)  # what a step of each axis is, in its own unit
RATES = {"jac": 800.0, "jvl": 50.0, "jtvl": 20.0, "sdec": 900.0, "hac": 500.0, "hvl": 15.0}
MODES = (0x1, 0x40, 0x80, 0x400, 0x8000, 0x10000, 0x20000, 0x40000, 0x80000, 0x10000000)
WAITS = (1000, 1003, 1004, 1005, 1006, 1015, 1025)
OTHERS = (2, 99, 999, 1001, 1002, 1101, 1201, 1207, 2001, 10002, 11002, 20003)


class Mixture:
    """Draws calls and their numbers."""

    def __init__(self, bench: Bench, seed: int) -> None:
        self.bench = bench
        self.draw = random.Random(seed)
        self.group: tuple[int, ...] = tuple(AXES)
        self.kinds: list[tuple[int, Callable[[], None]]] = [
            (3, self.close),
            (4, self.jog),
            (4, self.move),
            (12, self.queue),
            (9, self.start),
            (2, self.stop),
            (4, self.rate),
            (4, self.override),
            (3, self.mode),
            (4, self.place),
            (3, self.signal),
            (3, self.output),
            (2, self.latch),
            (1, self.reset),
            (2, self.path_limit),
        ]

    def run(self, rounds: int) -> None:
        """Make some calls, let some scans pass, and so on."""
        weights, acts = zip(*self.kinds, strict=True)
        self.bench.cl(*AXES)
        for _ in range(rounds):
            self.group = tuple(self.draw.sample(AXES, 4))
            for act in self.draw.choices(acts, weights, k=3):
                act()
            if self.draw.random() < 0.4:
                self.bench.ssms(*AXES)
            self.bench.step(self.draw.choice((12, 24, 48)), 12)
        self.bench.ends = self.bench.ends[5::6]  # the sums tell of the others

    # ------------------------------------------------------------------ numbers

    def number(self, size: float) -> float:
        """Return a number of either sign whose bits are in use; now and then 0."""
        return 0.0 if self.draw.random() < 0.06 else round(self.draw.uniform(-size, size) * 64.0) / 64.0

    def positive(self, size: float) -> float:
        return round(self.draw.uniform(0.1, 1.0) * size * 64.0) / 64.0

    def axis(self) -> int:
        return self.draw.choice(AXES)

    def some(self, least: int = 1) -> tuple[int, ...]:
        """Return some axes, of those that this round begins with."""
        return self.group[: self.draw.randint(least, 4)]

    def per_time(self, an: int, name: str, value: float) -> float:
        minutes = 60.0 if an == 1 else 1.0
        return value * SCALE[an] * minutes ** (2 if name in ("jac", "hac", "sdec") else 1)

    def speeds(self) -> tuple[float, float, float]:
        ac, vl = self.positive(900.0), self.positive(40.0)
        if self.draw.random() < 0.08:
            ac, vl = self.draw.choice(((-ac, vl), (ac, -vl), (0.0, vl), (ac, 0.0)))
        return ac, vl, self.draw.choice((0.0, 0.0, self.number(30.0), vl))

    # ------------------------------------------------------------------ calls

    def close(self) -> None:
        self.draw.choice((self.bench.cl, self.bench.cl, self.bench.clv))(*self.some())

    def jog(self) -> None:
        name = self.draw.choice(("ja", "jr", "jr", "jhi", "jhl", "jhr"))
        axes = self.some()
        call = getattr(self.bench, name)
        call(*axes) if name in ("jhl", "jhr") else call({an: self.number(8.0 * SCALE[an]) for an in axes})

    def shape(self) -> tuple[str, tuple[object, ...]]:
        way = self.draw.choice("ar")
        kind = self.draw.choice(("ml", "ml", "ml", "mc", "mh", "3d"))
        centre = (self.number(2.0), self.number(2.0))
        if kind == "ml":
            return f"ml{way}", ({an: self.number(3.0) for an in self.some()}, self.speeds())
        if kind == "mc":
            return f"mc{way}", (self.some(2)[:2], self.speeds(), self.number(200.0), *centre)
        if kind == "mh":
            axes = self.some(3)
            phi = self.draw.choice((0.0, self.number(200.0)))
            return f"mh{way}", ({an: self.number(2.0) for an in axes}, self.speeds(), phi, *centre)
        normal = (self.number(1.0), self.number(1.0), self.positive(1.0))
        return f"mc{way}3d", (self.some(3)[:3], self.speeds(), self.number(90.0), *centre, 0.5, *normal)

    def move(self) -> None:
        name, arguments = self.shape()
        getattr(self.bench, name)(*arguments)

    def queue(self) -> None:
        chance, an = self.draw.random(), self.axis()
        if chance < 0.45:
            name, arguments = self.shape()
            getattr(self.bench, f"s{name}")(*arguments)
        elif chance < 0.6:
            targets = {each: self.number(2.0) for each in self.some()}
            getattr(self.bench, self.draw.choice(("smlai", "smlri")))(
                targets, self.speeds(), index=self.draw.randint(1, 999)
            )
        elif chance < 0.85:
            command = self.draw.choice((self.draw.choice(WAITS), *OTHERS, *OTHERS[:6]))
            value = float(self.draw.randint(0, 300)) if command in WAITS else self.number(300.0)
            self.bench.ssf(an, command, value) if chance < 0.75 else self.bench.ssfi(an, command, value, 700)
        else:
            points = [round(k * self.number(0.05 * SCALE[an]) * 64) / 64 for k in range(6)]
            self.draw.choice(
                (
                    lambda: self.bench.spd(an, 5, self.bench.points(*points)),
                    lambda: self.bench.spda(an, 6, self.bench.points(*points), 300),
                    lambda: self.bench.spdr(an, 4, self.bench.points(*points), 400),
                )
            )()

    def start(self) -> None:
        chance = self.draw.random()
        if chance < 0.7:
            self.bench.ssms(*self.some())
        elif chance < 0.8:
            self.bench.sstps(*self.some())
        elif chance < 0.85:
            self.bench.sdels(*self.some())
        elif chance < 0.93:
            pcap.sstvl(pcap.AS.of(*self.some()), self.number(20.0))
        else:
            self.bench.ClearCI99()

    def stop(self) -> None:
        self.draw.choice((self.bench.js, self.bench.ms))(*self.some())

    def rate(self) -> None:
        name, an = self.draw.choice(list(RATES)), self.axis()
        value = self.number(RATES[name]) if name in ("jac", "jtvl") else self.positive(RATES[name])
        getattr(self.bench, f"wr{name}")(an, self.per_time(an, name, value))

    def override(self) -> None:
        self.draw.choice(
            (
                lambda: self.bench.wrjovr(self.axis(), self.positive(1.6)),
                lambda: self.bench.wrtrovr(self.positive(1.6)),
                lambda: self.bench.wrtrovrst(self.draw.choice((0.0, 0.05, 0.2))),
                lambda: self.bench.utrovr(*self.some()),
                lambda: self.bench.utrovr(*self.some()),
            )
        )()

    def mode(self) -> None:
        self.draw.choice(
            (
                lambda: self.bench.wrModeReg(sum(self.draw.sample(MODES, 3))),
                lambda: self.bench.wrnfrax(self.draw.randint(0, 15)),
                lambda: self.bench.ctru(pcap.TRU(pu=self.draw.choice((0, 0, 0, 1, 4)), tu=0)),
                lambda: self.bench.wrJerkRel(self.axis(), self.positive(1.1)),
            )
        )()

    def place(self) -> None:
        an = self.axis()
        value = self.number(2.0 * SCALE[an])
        name = self.draw.choice(("szpa", "szpr", "wrdpoffset", "wrdvoffset", "shp", "wrdp", "wrrp", "wrlp"))
        name = self.draw.choice((name, "wrlpndx", "wrtp", "RPtoDP"))
        if name == "RPtoDP":
            self.bench.RPtoDP(an)
        elif name == "shp":
            self.bench.shp(an, tp=value)
        elif name == "wrdvoffset":
            self.bench.wrdvoffset(an, abs(value))
        else:
            getattr(self.bench, name)(an, value)

    def signal(self) -> None:
        self.bench.board.set_input(
            self.draw.choice((1, 2, 3, 4, 5, 6, 9, 14, 15, 16)), self.draw.random() < 0.5
        )

    def output(self) -> None:
        self.draw.choice(
            (
                lambda: self.bench.wrdigo(0, self.draw.randint(0, 255)),
                lambda: self.bench.wrdigob(1, self.draw.randint(1, 9), self.draw.randint(0, 2)),
                lambda: self.bench.wrmcp(self.axis(), self.draw.randint(-16000, 16000)),
                lambda: self.bench.ol(self.axis()),
                lambda: self.bench.wrledyl(self.draw.randint(0, 2)),
            )
        )()

    def latch(self) -> None:
        an = self.axis()
        record = pcap.TSRP(an=an)
        self.draw.choice(
            (
                lambda: self.bench.lps(an, self.draw.randint(0, 9)),
                lambda: self.bench.rdigi(an),
                lambda: (pcap.rdlp(record), self.bench.wraux(an, record.lp + 0.25)),
            )
        )()

    def reset(self) -> None:
        if self.draw.random() < 0.3:
            self.bench.rs()
        else:
            self.bench.ra(self.axis())

    def path_limit(self) -> None:
        name = self.draw.choice(("MaxVel", "MaxAcc", "MDVel"))
        getattr(self.bench, f"wr{name}")(self.axis(), self.positive(600.0 if name == "MaxAcc" else 25.0))
