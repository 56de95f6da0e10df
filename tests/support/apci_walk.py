"""A board that is asked for anything in any order, the same for a seed: by the PC, and by random programs.

Unlike the mixture, which it draws its moves from, it writes every register with any number, names axes that are not
there or twice, stops and continues tasks, gives every command of programs, and notes what functions return.
"""

from __future__ import annotations

from collections.abc import Callable

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.core._registers import ErrorReg
from polycnc.controllers.apci.sap._commands import (
    AXIS_QUALIFIERS,
    COMMANDS,
    INTEGER,
    SYSTEM_VARIABLES,
    TABLE,
    Axes,
    Command,
    Register,
)
from support.apci_bench import OF_AXES, WHOLE, WRITES, Bench
from support.apci_mixture import AXES, MODES, OTHERS, RATES, SCALE, WAITS, Mixture

OTHER_UNITS = """
sample_time_us = 800
[[axis]]
name = "X"
unit = "m"
display_unit = "inch"
jac = 0.9
jvl = 0.05
jtvl = 0.004
sll = -0.03
slr = 0.02
soft_left = "SMA"
soft_right = "TOM"
gf = 0.5
backlash = 0.0005
mpe = 0.002
[axis.plant]
kind = "lag"
lag_s = 0.003
index = 0.006
[[axis]]
unit = "rad"
display_unit = "deg"
time_unit = "tsample"
jac = 0.0004
jvl = 0.03
effradius = 12.0
jerkrel = 0.625
ipw = 0.01
[axis.plant]
reference = [0.25, 0.75]
index = -0.5
[[axis]]
motor = "stepper"
jac = 900.0
jvl = 60.0
sdec = 1200.0
slsp = 400.0
gf = 2.5
mcpmax = 700000
[[axis]]
unit = "rev"
time_unit = "min"
display_unit = "counts"
jac = 30000.0
jvl = 400.0
hac = 20000.0
hvl = 90.0
effradius = 8.0
kp = 35.0
kd = 0.03125
mcpcp = 15
mcpcn = -25
[axis.plant]
kind = "lag"
lag_s = 0.005
reference = [-0.5, -0.25]
encoder = "counts"
[inputs]
1 = { functions = ["LP"], axes = ["A2", "X"] }
2 = { functions = ["REF", "DR"], axes = ["A4"] }
3 = { functions = ["LSR_TOM", "EO"], axes = ["A4"] }
4 = { functions = ["LSL_SMD"], axes = ["A2"], inverted = true }
7 = { functions = ["UI"] }
[outputs]
2 = { functions = ["PAE"] }
7 = { functions = ["PAE"], axes = ["A2"] }
8 = { set_at_reset = true }
[board]
pu = "m"
tu = "min"
trac = 1500.0
trvl = 2.0
"""

NUMBERS = (0.0, 0.0, 1.0, -1.0, 2.5, -7.25, 0.375, -0.0625, 96.0, 4096.0, -30000.0, 1e6)
WHOLES = (0, 1, -1, 2, 5, 255, -256, 65537, 0x7FFFFFFF, -0x80000000)
ENDED = "VAR t: ARRAY[1..6] OF DOUBLE; n: INTEGER; BEGIN {} END."
READ = 200  # first common double that programs write what they read to
QUALIFIERS, SYSTEM = list(AXIS_QUALIFIERS.values()), list(SYSTEM_VARIABLES.values())


class Walk:
    """Draws what a board is asked for."""

    def __init__(self, bench: Bench, seed: int) -> None:
        self.bench = bench
        self.calls = Mixture(bench, seed)
        self.draw = self.calls.draw
        self.read = 0
        self.acts: list[tuple[int, Callable[[], object]]] = [
            *((2 * weight, act) for weight, act in self.calls.kinds),
            (16, self.write),
            (22, self.program),
            (8, self.task),
            (5, self.variable),
            (4, self.buffer),
            (4, self.fault),
            (3, self.units),
            (3, self.coefficients),
            (3, self.zero),
            (2, self.record),
            (4, self.strange_axes),
        ]

    def run(self, acts: int) -> None:
        """Ask for as much, and let scans pass now and then."""
        for axis in self.bench.board.axes:
            axis.zero_offsets[:] = [SCALE[axis.index] * each for each in (0.5, -0.25, 0.0, 1.5, -2.0)]
        weights, kinds = zip(*self.acts, strict=True)
        self.bench.cl(*AXES)
        for number in range(1, acts + 1):
            if number % 30 == 0:
                self.repair()
            self.calls.group = tuple(self.draw.sample(AXES, 4))
            self.draw.choices(kinds, weights)[0]()
            if number % 3 == 0:
                self.bench.board.advance(self.draw.choice((1, 2, 5, 9)))
            if number % 9 == 0:
                self.bench.step(self.draw.choice((12, 24, 36)), 12)
                if self.draw.random() < 0.5:
                    self.bench.cl(*AXES)
        self.bench.ends = self.bench.ends[3::4]

    def repair(self) -> None:
        """Take back what keeps axes from moving at all."""
        self.bench.ctru(pcap.TRU(pu=0, tu=0))
        for an in AXES:
            for name in ("jac", "jvl", "sdec", "hac", "hvl"):
                getattr(self.bench, f"wr{name}")(
                    an, self.calls.per_time(an, name, self.calls.positive(RATES[name]))
                )
            self.bench.wrgf(an, self.calls.positive(2.0))
            self.bench.wrslsp(an, 500.0)

    # ------------------------------------------------------------------ the PC

    def write(self) -> None:
        """Write a register, sometimes of an axis that is not there."""
        name = self.draw.choice(WRITES)
        value = self.draw.choice(WHOLES if name in WHOLE else NUMBERS)
        axes = [self.draw.choice((*AXES, *AXES, -1, 4))] if name in OF_AXES else []
        if name == "wrModeReg":
            value = sum(self.draw.sample(MODES, 2))
        getattr(self.bench, name)(*axes, value)

    def task(self) -> None:
        number = self.draw.choice((0, 1, 2, 3, 4, -1))
        self.draw.choice((pcap.contcnct, pcap.stopcnct, pcap.startcnct, pcap.stepcnct))(number)
        self.bench.tell(*pcap.gettskinfo(number))
        if self.draw.random() < 0.4:
            count, text = pcap.gettskstr(number, self.draw.choice((512, 5)))
            self.bench.tell(count, sum(k * ord(letter) for k, letter in enumerate(text, 1)))

    def variable(self) -> None:
        """Write a common or special variable, and read one back."""
        index, value = self.draw.choice((0, 7, 98, 99, 100, 999, 1000, -1)), self.draw.choice(NUMBERS)
        whole, axis = self.draw.choice(WHOLES), self.draw.choice((*AXES, 4))
        self.draw.choice(
            (
                lambda: pcap.wrci(index, pcap.CIBUF(ci=[whole] * 1000)),
                lambda: pcap.wrcd(index, pcap.CDBUF(cd=[value] * 1000)),
                lambda: pcap.wrSysVarInt(index, whole),
                lambda: pcap.wrSysVarDbl(index, value),
                lambda: pcap.wrAxVarInt(axis, index, whole),
                lambda: pcap.wrAxVarDbl(axis, index, value),
            )
        )()
        self.bench.tell(pcap.rdSysVarInt(index), pcap.rdSysVarDbl(index))
        self.bench.tell(pcap.rdAxVarInt(axis, index), pcap.rdAxVarDbl(axis, index))
        pcap.rdci(index, whole_field := pcap.CIBUF())
        pcap.rdcd(index, real_field := pcap.CDBUF())
        self.bench.tell(sum(whole_field.ci[:101]), sum(real_field.cd[:101]))

    def buffer(self) -> None:
        """Copy bytes to a common buffer, and others back."""
        task, size = self.draw.choice((0, 1, 2, 3, 4)), self.draw.choice((0, 1, 9, 24, 1000, 1001))
        sent = bytearray(self.draw.randrange(256) for _ in range(min(size, 40))).ljust(size, b"\7")
        code = pcap.wrcbcnct(pcap.CBCNCT(task, size, sent))
        got = bytearray(30)
        other = pcap.rdcbcnct(pcap.CBCNCT(self.draw.randrange(4), self.draw.choice((4, 30, 31)), got))
        self.bench.tell(code, other, sum(k * each for k, each in enumerate(got, 1)))

    def fault(self) -> None:
        board, axis = self.bench.board, self.draw.choice(AXES)
        self.draw.choice(
            (
                lambda: board.variables.interface.report(1 << self.draw.randint(16, 23)),
                lambda: self.bench.rifs(axis),
                lambda: self.bench.rifs(axis),
                lambda: board.raise_error(ErrorReg(1 << self.draw.choice((7, 8, 18)))),
                lambda: setattr(board.axes[axis], "alarms", self.draw.getrandbits(24)),
                lambda: board.set_input(self.draw.randint(1, 16), self.draw.random() < 0.5),
            )
        )()

    def units(self) -> None:
        self.bench.ctru(
            pcap.TRU(pu=self.draw.choice((0, 0, 0, 1, 2, 6, 8)), tu=self.draw.choice((0, 0, 1, 2, 3)))
        )

    def coefficients(self) -> None:
        axis = self.draw.choice(AXES)
        names, record = ("kp", "ki", "kd", "kpl", "kfca", "kfcv"), pcap.TSRP(an=axis)
        pcap.rdf(record)
        setattr(record, self.draw.choice(names), self.draw.choice((0.0, 0.25, 0.5, 0.03125)))
        record.kp = self.draw.choice((20.0, 40.0))
        pcap.uf(record)

    def zero(self) -> None:
        """Put zero offsets in force where something is latched, and write what was latched."""
        axis = self.draw.choice(AXES)
        self.bench.azo(self.draw.choice((0, 1, 3, 5, -1)))
        record = pcap.TSRP(an=axis)
        record.lp = self.calls.number(3.0)
        self.draw.choice((pcap.wrlp, pcap.wrlpndx, lambda _: None))(record)
        self.draw.choice((pcap.rdlp, pcap.rdlpndx))(record)
        self.bench.tell(record.lp)

    def record(self) -> None:
        axis = self.draw.choice(AXES)
        for an in AXES:
            self.bench.tell(float(pcap.recording(an).sum()))
        one = pcap.LATCH_INFOS(san=axis)
        self.draw.choice((lambda: pcap.lpr(one), lambda: pcap.lprs(pcap.AS.of(*self.calls.some()), one)))()

    def strange_axes(self) -> None:
        """Name an axis twice, or one that is not there, beside one that is."""
        axis = self.draw.choice(AXES)
        axes = pcap.AS.of(axis, self.draw.choice((axis, 5, 17)))
        lmp = pcap.LMP(ac=500.0, vl=20.0, dtm=[self.calls.number(2.0)] * 18)
        self.draw.choice(
            (
                lambda: pcap.jr(axes, pcap.tsrp_array()),
                lambda: pcap.mlr(axes, lmp),
                lambda: pcap.smlr(axes, lmp),
                lambda: pcap.js(axes),
                lambda: pcap.ssms(axes),
                lambda: pcap.ol(axes),
                lambda: pcap.utrovr(axes),
            )
        )()

    # ------------------------------------------------------------------ programs

    def program(self) -> None:
        """Let a task carry out random statements."""
        rates = f"pu := {self.draw.choice((0, 0, 0, 0, 1, 6))}; tu := 0; trac := {self.calls.positive(900.0)}"
        head = [rates, f"trvl := {self.calls.positive(40.0)}; trtvl := {self.draw.choice((0, 12.5, -6.25))}"]
        head += [f"t[{k}] := {self.calls.number(0.02)}" for k in range(1, 7)]
        body = [self.statement() for _ in range(self.draw.randint(3, 9))]
        self.bench.program(ENDED.format("; ".join([*head, *body])), self.draw.randrange(3))

    def statement(self) -> str:
        """Return a command, an assignment, or a wait."""
        chance = self.draw.random()
        if chance < 0.5:
            return self.command(self.draw.choice([each for each in COMMANDS.values() if each.name != "rs"]))
        if chance < 0.68:
            return self.assigned()
        if chance < 0.9:
            place = READ + self.read % 90
            self.read += 1
            return f"CD[{place}] := {self.register(False)[0]}"
        axis = self.draw.choice(AXES) + 1
        return self.draw.choice(
            (
                f"wt ({self.draw.randint(0, 60)})",
                f"wt (A{axis})",
                f"WRITE('r', A{axis}.rp:{self.draw.randint(0, 9)}:3)",
                "WRITELN",
                f"IF ODD(A{axis}.axst DIV 4096) THEN n := n + 1 ELSE js (A{axis})",
                f"WRCBI({self.draw.choice((0, 4, 997))}, {self.draw.choice(WHOLES[:8])}); CI[40] := RDCBB(2)",
                f"CI[41] := CI[41] * 3 + {axis}",
            )
        )

    def register(self, writable: bool) -> tuple[str, Register]:
        """Return what reads or writes a register."""
        if self.draw.random() < 0.75:
            each = self.draw.choice([each for each in QUALIFIERS if each.writable or not writable])
            name = f"A{self.draw.choice(AXES) + 1}.{each.name}"
        else:
            each = self.draw.choice([each for each in SYSTEM if each.writable or not writable])
            name = each.name
        return (f"{name}[{self.draw.choice((3, 42, 99))}]" if each.indexed else name), each

    def assigned(self) -> str:
        name, register = self.register(True)
        value = self.draw.choice(WHOLES[:8] if register.kind == INTEGER else NUMBERS)
        if register.name == "modereg":
            value = sum(self.draw.sample(MODES[:6], 2))
        return f"{name} := {value}"

    def command(self, command: Command) -> str:
        """Return a command of a program with numbers that fit."""
        numbers = [self.argument(name, kind) for name, kind in command.numbers]
        if command.optional and self.draw.random() < 0.4:
            del numbers[-command.optional :]
        if command.axes is Axes.NONE:
            return f"{command.name} ({', '.join(numbers)})" if numbers else command.name
        count = 1 if command.axes is Axes.ONE else self.draw.randint(command.least, min(command.most, 4))
        axes = [f"A{an + 1}" for an in self.draw.sample(AXES, count)]
        if command.axes is Axes.NAMED:
            axes = [f"{axis} := {self.calls.number(2.0 * SCALE[int(axis[1:]) - 1])}" for axis in axes]
        return f"{command.name} ({', '.join([*axes, *numbers])})"

    def argument(self, name: str, kind: str) -> str:
        if kind == TABLE:
            return "t"
        if name == "size":
            return str(self.draw.choice((1, 4, 6, 6, 7)))
        if name == "command":
            return str(self.draw.choice((*WAITS, *OTHERS, *OTHERS)))
        if kind == INTEGER:
            return str(self.draw.choice((0, 1, 2, 4, 5, 9)))
        return str(self.calls.number(170.0) if name == "phi" else self.calls.number(3.0))
