"""Scenes of the board: numbers of many digits, 0 and either sign in every register, and moves that share axes."""

from __future__ import annotations

from polycnc.controllers.apci import pcap
from support.apci_bench import OF_AXES, WHOLE, WRITES, Bench

SYSTEM = """
[[axis]]
jac = 700.0
jvl = 40.0
[[axis]]
time_unit = "min"
unit = "inch"
jac = 9.0e5
jvl = 900.0
[[axis]]
motor = "stepper"
effradius = 25.0
unit = "deg"
"""
NUMBERS = (0.1234567891, -0.7654321098, 0.0, 1.5, 98765.4321, 1e-7, -1e-100)
WHOLES = (0x7FFFFFFF, -0x80000000, 0, 0x12345678, -1, 0x55AA55, 3)
_MODES = {"wrModeReg", "wrnfrax"}


def digits(b: Bench) -> None:
    """Every register that the PC writes given numbers of many digits, 0, and what it may not have."""
    for turn, (number, whole) in enumerate(zip(NUMBERS, WHOLES, strict=True)):
        for k, name in enumerate(WRITES):
            for an in range(3) if name in OF_AXES else ("",):
                value: float = whole ^ k if name in WHOLE else number * (1.0 + k / 64)
                if name not in _MODES:
                    getattr(b, name)(*([] if an == "" else [an]), value)
        b.step(5)
        if turn == 3:
            b.cl(0, 2)
    b.ol(0, 2)
    b.wrModeReg(0x7654321)
    b.step(5)
    b.wrnfrax(-3)
    b.wrModeReg(-1)
    b.step(5)
    b.rs()
    b.step(5)


def joined(b: Bench) -> None:
    """Queued moves whose axes are some of those of the move before, or more, or others, with look-ahead."""
    b.cl(0, 1, 2)
    for an, jump in enumerate((2.5, 30.0, 4.0)):
        b.wrMDVel(an, jump)
    b.wrModeReg(0x1)
    speeds = (500.0, 20.0, 12.0)
    for targets in (
        {0: 0.75, 1: 0.25},
        {0: 0.75},
        {0: 0.5, 2: 0.25},
        {2: 0.5},
        {1: 0.25, 0: -0.5},
        {1: -0.25, 0: 0.5, 2: 0.25},
        {0: 0.25, 2: 0.125},
    ):
        b.smlr(targets, speeds)
    b.ssms(0, 1, 2)
    b.step(150)
    b.mlr({0: 1.5, 1: 0.5}, (400.0, 15.0, 0.0))
    b.js(1)
    b.step(10)
    b.mlr({0: 1.5, 1: 0.5}, (400.0, 15.0, 0.0))
    b.step(20)
    b.js(0)
    b.step(30)
    b.mlr({0: 0.5, 1: 0.5}, (400.0, 15.0, 0.0))
    b.step(1, 1)
    b.ra(0)
    b.step(20)


TERMINALS = "[[axis]]\n[[axis]]\n[inputs]\n" + "".join(
    f"{number} = {{ inverted = {'true' if number % 3 else 'false'} }}\n" for number in range(1, 17)
)


def terminals(b: Bench) -> None:
    """Each input alone, inverted or not; each output set and reset by every axis with numbers of any size."""
    b.step(5)
    for number in range(1, 17):
        b.board.set_input(number, True)
        b.board.advance(1)
        b.tell(*(b.rddigib(an, number + beside) for an in (0, 1) for beside in (-1, 0, 1)))
    b.step(5)
    for number in range(1, 17, 2):
        b.board.set_input(number, False)
    b.step(5)
    for value in (2, 0, -1, 0x100, 0, 1, -0x80000000):
        for number in range(10):
            b.wrdigob(number % 2, number, value)
            b.tell(*(b.rddigob(an, number + beside) for an in (0, 1) for beside in (-1, 0, 1)))
    b.step(5)
    b.rs()
    b.step(5)


def modes(b: Bench) -> None:
    """Each bit of the mode register alone, while a path is stopped, ends at speed, waits and is overridden."""
    b.wrtrac(150.0)
    b.wrtrovr(0.75)
    b.cl(0, 1)
    for bit in range(32):
        b.wrModeReg(1 << bit)
        b.mlr({0: 0.75, 1: -0.5}, (400.0, 20.0, 0.0))
        b.step(10, 10)
        b.utrovr(0)
        b.ms(0, 1)
        b.smlr({0: -0.25}, (400.0, 20.0, 5.0))
        b.ssf(0, 1003, 200.0)
        b.ssms(0)
        b.step(30, 30)
        b.ra(0, 1)
        b.cl(0, 1)


def handlers(b: Bench) -> None:
    """Lines written by a program and by the handler of an event, which stop the task or do not."""
    for mode in (0, 1 << 26):
        b.wrModeReg(mode)
        b.program(
            "EVENT e ON CI2 > 30; BEGIN CI3 := CI3 + 1; WRITE('in '); WRITELN(CI3); CI4 := CI4 + 1; CI2 := 0 END;\n"
            "BEGIN WHILE TRUE DO BEGIN CI2 := CI2 + 1; IF CI2 = 20 THEN WRITELN('b') END END.",
            1,
        )
        for _ in range(5):
            b.step(3, 3)
            b.tell(*(pcap.gettskinfo(1)), *map(ord, pcap.gettskstr(1)[1]))
            b.contcnct(1)
        b.stopcnct(1)


LIMITS = "".join(
    f'[[axis]]\nsll = -0.5\nslr = 0.75\nsoft_left = "{left}"\nsoft_right = "{right}"\nipw = 0.125\nmpe = 0.25\n'
    for left, right in (("TOM", "SMA"), ("SMA", "SMD"), ("SMD", "TOM"))
)


def exactly(b: Bench) -> None:
    """Axes that rest at their limits and not beyond them, then one step beyond, and limits that come to them."""
    b.cl(0, 1, 2)
    for an in range(3):
        b.shp(an, tp=0.0)
    for end in (0.75, -0.5, 0.0):
        b.ja(dict.fromkeys(range(3), end))
        b.step(100, 20)
        for an in range(3):
            b.wrdp(an, end * 1.0000001)
        b.step(5)
    for an, place in enumerate((0.0, 0.125, -0.25)):
        b.ja({an: place})
        b.step(20)
        b.wrsll(an, place)
        b.wrslr(an, place)
        b.step(5)
        b.jr({an: 0.5})
        b.step(10)
        b.jr({an: -0.5})
        b.step(10)
    b.step(40)
    for factor in (1.0, 0.999999999, 1.000000001):  # a window that is just as wide as the error
        for an in range(3):
            error = abs(pcap.rdPosErr(an)) * factor
            b.wrmpe(an, error)
            b.wripw(an, error)
        b.step(5)


SCENES = {
    "exactly": (LIMITS, exactly),
    "handlers": ("[[axis]]\n", handlers),
    "terminals": (TERMINALS, terminals),
    "modes": ("[[axis]]\n[[axis]]\n", modes),
    "digits": (SYSTEM, digits),
    "joined": (SYSTEM, joined),
}
