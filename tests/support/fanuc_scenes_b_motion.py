"""Scenes of axis movement control: operation signals and direct commands (Manual 000, cnc_opdi to cnc_setfin)."""

from __future__ import annotations

from typing import Any

from polycnc.controllers.fanuc import fwlib
from support.fanuc_scenes_b import Bench, opdi, plain, positions

SWITCHES = (1, 2, 3, 7, 8, 15)
"""Operation signals that are 0 or 1."""
MODES = (0, 1, 2, 3, 4, 5, 7)


def ready(b: Bench, **machine: Any) -> None:
    """Begin with a control that takes direct commands for all axes."""
    b.fresh(**machine)
    b.parameters(8003, 0x80)
    b.parameters(8010, *(min(axis, 4) for axis in range(1, b.control.axes + 1)))


def signal(b: Bench, number: int, value: int, axis: int = 0, *, cycles: int = 3) -> None:
    """Give an operation signal, let time pass, and look."""
    code = b.library.cnc_opdi(b.handle, number, opdi(value, axis))
    b.control.advance(cycles)
    of = f" axis {axis}" if axis else ""
    b.lines.append(f"signal {number}{of} <- {value} {fwlib.EW(code).name}, {cycles} cycles")
    b.look()


def signals_of_operation(b: Bench) -> None:
    """Each operation signal with each value, at both ends and beyond: idle, in a program, in jogging."""
    b.title("what is a signal, and which values it takes, idle")
    b.fresh(axes=6)
    for number in (-1, 0, 5, 6, 11, 16, 32767):
        signal(b, number, 1, cycles=0)
    for number in SWITCHES:
        for value in (2, 255, 1, 0, 1, 0):
            signal(b, number, value)
        if number in (1, 2):
            signal(b, number, 1)
        b.control.reset()
    for number in (4, 12):
        for bit in range(8):
            signal(b, number, 1 << bit)
        for bit in range(6):
            signal(b, number, 0x3F & ~(1 << bit))
        for value in (0x3F, 0x40, 0x80, 0xFF, 0):
            signal(b, number, value)
    for value in (*MODES, 6, 8, 0x10, 0x11, 0x80, 0xFF):
        signal(b, 9, value)
    signal(b, 9, 1)
    for value in (0, 1, 2, 99, 100, 101, 127, 128, 200, 254, 255, 100):
        signal(b, 10, value)
    for axis, value in ((0, 51), (1, 0), (6, 255), (3, 128), (2, 1), (7, 9), (-1, 9), (0, 255)):
        signal(b, 13, value, axis)
    signal(b, 9, 4)
    for axis in (1, 6, 0):
        for value in (1, 9, 8, 0, 2, 4, 16, 128, 3):
            signal(b, 14, value, axis, cycles=8)
    for axis in (7, -1):
        signal(b, 14, 1, axis)
    b.title("jogging on with each of six servos switched off and on again")
    for bit in range(6):
        signal(b, 14, 1, 0, cycles=20)
        signal(b, 4, 1 << bit, cycles=200)
        signal(b, 4, 0, cycles=60)
        signal(b, 14, 0, 0, cycles=200)
    b.title("a key that is pressed while the servo of its axis is off; keys in REF")
    for bit in range(6):
        signal(b, 4, 1 << bit, cycles=5)
        signal(b, 14, 1, bit + 1, cycles=20)
        signal(b, 4, 0, cycles=40)
        signal(b, 14, 0, bit + 1, cycles=100)
    signal(b, 9, 3)
    for axis, value in ((1, 9), (6, 9), (2, 1), (3, 9), (0, 9)):
        signal(b, 14, value, axis, cycles=30)
        signal(b, 14, 0, axis, cycles=400)
    signal(b, 9, 4)
    b.title("the number of an axis counts for 13 and 14 alone; longer elements of the value do not count")
    signal(b, 10, 44, 7)
    signal(b, 15, 1, -1)
    long = fwlib.ODBOPDI(axis=0)
    long.u.ldata = 0x12345601
    b.do("cnc_opdi", 15, long)
    long.u.ldata = 0x7FFFFF00
    b.do("cnc_opdi", 15, long)
    for number, value in (
        (1, 1),
        (2, 1),
        (3, 0),
        (4, 9),
        (7, 1),
        (8, 0),
        (9, 4),
        (10, 88),
        (12, 0x15),
        (13, 66),
        (14, 0),
    ):
        for others in (0x01000000, -0x3B9D5C00, 0x7F00, 0x3B9D5C00):
            long.u.ldata = others | value
            b.ask("cnc_opdi", number, long)
        b.look()
    b.title("what stays after a reset, and after switching off")
    for number, value in ((4, 5), (10, 37), (12, 9), (13, 77), (15, 1), (7, 1)):
        signal(b, number, value)
    b.act("reset")
    b.act("power_cycle")


def signals_in_a_program(b: Bench) -> None:
    """Each operation signal while a program moves two axes, and while axes are jogged."""
    b.fresh(axes=4)
    text = "N1 G1 X-30. Z18. F2400\nN2 G4 X0.2\nN3 G0 X10.\nN4 Y7.\nN5 M30"
    b.program(51, text, start=False)
    for number, values in (
        (8, (1, 0)),
        (2, (0, 1)),
        (8, (1, 0)),
        (15, (1, 0)),
        (10, (0, 254, 255, 37, 100)),
        (13, (0, 128, 255)),
        (4, (2, 1, 4, 0)),
        (12, (5, 0)),
        (9, (2, 1)),
        (8, (1, 0)),
        (7, (1, 0)),
        (14, (1, 9, 0)),
        (3, (1, 0)),
        (8, (1, 0)),
        (1, (0, 1)),
        (8, (1, 0)),
        (15, (1,)),
    ):
        for value in values:
            signal(b, number, value, cycles=40)
    for _ in range(6):
        b.run(3000)
        signal(b, 8, 1)
        signal(b, 8, 0)
    b.run(3000)
    b.title("jogging")
    signal(b, 9, 4)
    for number, value, axis in (
        (14, 1, 1),
        (14, 9, 4),
        (7, 1, 0),
        (14, 1, 2),
        (7, 0, 0),
        (14, 9, 1),
        (4, 8, 0),
        (4, 0, 0),
        (14, 1, 4),
        (10, 20, 0),
        (2, 0, 0),
        (2, 1, 0),
        (13, 9, 4),
        (14, 1, 0),
        (14, 0, 2),
        (9, 5, 0),
        (14, 9, 3),
        (14, 0, 0),
        (9, 3, 0),
        (14, 1, 3),
        (14, 0, 0),
        (9, 4, 0),
        (14, 9, 0),
        (3, 1, 0),
        (3, 0, 0),
        (14, 9, 1),
        (1, 0, 0),
        (14, 1, 2),
        (1, 1, 0),
        (14, 1, 2),
    ):
        signal(b, number, value, axis, cycles=40)
    b.run(2000)


def command(b: Bench, name: str, *arguments: Any) -> None:
    """Give a direct command; write down its answer, and what has changed."""
    found = getattr(b.library, f"cnc_{name}")(b.handle, *arguments)
    *numbers, data = arguments if isinstance(arguments[-1], bytes) else (*arguments, b"")
    pairs = [fwlib.ODBPOS.unpack(data[k : k + 6]) for k in range(0, len(data) - 5, 6)]
    to = " ".join(f"{each.idata}:{each.ldata}" for each in pairs)
    code, odb = found if isinstance(found, tuple) else (found, None)
    state = "" if odb is None or code else bytes(odb.pack())[2:].hex(" ", 8)
    b.lines.append(f"{name} {' '.join(map(plain, numbers))} [{to}] {fwlib.EW(code).name} {state}".rstrip())
    b.look()


def direct_commands(b: Bench) -> None:
    """Each direct command, on each path, with and without flag; what it takes and what it refuses."""
    b.title("not allowed by parameters: 8003#7, 8010 of an axis")
    b.fresh(axes=3)
    command(b, "abspoint", 1, 0, 1, 600, positions((1, 5)))
    b.ask("cnc_exebufstat")
    b.ask("cnc_finstate")
    b.ask("cnc_setfin", fwlib.ODBFIN())
    b.parameters(8003, 0x7F)
    command(b, "refpoint", 1, 0, 1)
    b.parameters(8003, 0x80)
    b.ask("cnc_exebufstat")
    b.parameters(8010, 1, 0, 3)
    for data in (positions((2, 5)), positions((1, 5), (2, 6)), positions((3, 5))):
        command(b, "abspoint", 1, 0, len(data) // 6, 600, data)
    command(b, "refpoint", 2, 0, 2)
    for name in ("dwell", "coordre"):
        command(b, name, 2, 0, 1, positions((2, 5)))
    b.title("8010 of one axis alone is 0, and of all but one")
    ready(b, axes=6)
    for axis in range(1, 7):
        for before, value in ((0, 1), (2, 0)):
            for each in range(1, 7):
                b.control.parameters.set(8010, value if each == axis else before, each)
            for each in (axis, axis % 6 + 1):
                command(b, "refpoint", 1, 0, each)
                command(b, "incpoint", 2, 0, 1, 600, positions((each, 1)))
                command(b, "abspoint", 3, 0, 1, 600, positions((each, 2)))
                command(b, "dwell", 4, 0, 1, positions((each, 1)))
                command(b, "coordre", 5, 0, 1, positions((each, 3)))
                command(b, "dwell", 6, 0, 2, positions((each, 1), (each % 6 + 1, 1)))
                b.control.advance(20)
    b.look()
    b.title("axes that this machine does not have")
    ready(b, axes=3)
    for axis in (3, 4, 6):
        command(b, "refpoint", 1, 0, axis)
        command(b, "incpoint", 2, 0, 1, 600, positions((axis, 5)))
        command(b, "abspoint", 3, 0, 1, 600, positions((axis, 5)))
        command(b, "dwell", 4, 0, 1, positions((axis, 5)))
        command(b, "coordre", 5, 0, 1, positions((axis, 5)))
        command(b, "incpoint", 6, 0, axis, 600, positions(*((each, 1) for each in range(1, axis + 1))))
        b.run(100)
    b.title("the examples of the manual")
    ready(b, axes=6)
    command(b, "abspoint", 1, 0, 2, 500, positions((1, 100000), (2, -100000)))
    b.run(20000)
    command(b, "incpoint", 1, 0, 2, 500, positions((1, 100000), (2, -100000)))
    b.run(30000)
    command(b, "refpoint", 1, 0, 1)
    b.run(9000)
    b.title("one after the other, on each path")
    ready(b, axes=6)
    for path in range(1, 7):
        flag = path % 2
        command(b, "incpoint", path, flag, 1, 6000, positions((path, (-1) ** path * 700 * path)))
        command(b, "abspoint", path, 1 - flag, 1, 1200, positions((path, 40 * path)))
        command(b, "dwell", path, 0, 1, positions((path, 5)))
    for _ in range(9):
        b.run(40)
    b.run(2000)
    for longest in range(6):
        command(b, "dwell", 1, 1, 6, positions(*((k + 1, 30 if k == longest else k + 1) for k in range(6))))
        b.run(20)
        b.run(25)
        b.library.cnc_setfin(b.handle, fwlib.ODBFIN(cdata=[1, 0, 0, 0, 0, 0, 0, 0]))
    b.title("flags: each alone, other bits of its byte, all but one")
    for path in range(1, 7):
        for flag in (0, 1):
            command(b, "coordre", path, flag, 1, positions((path, 1000 * path + flag)))
            b.run(2)
    for k in range(8):
        b.do("cnc_setfin", fwlib.ODBFIN(cdata=[0xFF & ~(1 << j) if j == k else 0 for j in range(8)]))
    for k in range(6):
        b.do("cnc_setfin", fwlib.ODBFIN(dummy=9, cdata=[1 << j if j == k else 0 for j in range(8)]))
        command(b, "dwell", k + 1, 1, 1, positions((6 - k, 1)))
        b.run(5)
    for k in range(6):
        b.do("cnc_setfin", fwlib.ODBFIN(cdata=[0 if j == k else 0xFF for j in range(8)]))
        for path in range(1, 7):
            b.library.cnc_dwell(b.handle, path, 1, 1, positions((path, 1)))
        b.run(5)
    b.title("what is refused")
    good = positions((1, 50))
    for path in (0, 7, -1, 1):
        for name, more in (("refpoint", (1,)), ("abspoint", (1, 600, good)), ("incpoint", (1, 600, good)),
                           ("dwell", (1, good)), ("coordre", (1, good))):  # fmt: skip
            command(b, name, path, 0, *more)
        b.run(400)
    for nmod in (-1, 2, 32767):
        command(b, "refpoint", 1, nmod, 1)
        command(b, "abspoint", 1, nmod, 1, 600, good)
        command(b, "dwell", 1, nmod, 1, good)
    for axis in (0, -1, 7, 6):
        command(b, "refpoint", 1, 0, axis)
        command(b, "abspoint", 1, 0, 1, 600, positions((axis, 5)))
        command(b, "coordre", 2, 0, 1, positions((axis, 7)))
        b.run(500)
    for count in (0, -1, 7, 2, 6):
        command(
            b,
            "incpoint",
            1,
            0,
            count,
            600,
            positions((6, 3), (1, 2), (2, 1), (3, 4), (4, 5), (5, 6))[: 6 * max(count, 1)],
        )
        b.run(100)
    command(b, "incpoint", 1, 0, 2, 600, positions((1, 3), (1, 4)))
    command(b, "incpoint", 1, 0, 2, 600, positions((1, 3)))
    for feed in (0, -1, 1, 240000):
        command(b, "incpoint", 1, 0, 1, feed, positions((1, 30)))
        b.run(4000 if feed == 1 else 100)
        command(b, "abspoint", 1, 0, 1, feed, positions((1, -30)))
        b.run(100)
        b.act("reset")
    for value in (99_999_999, 100_000_000, -99_999_999, -100_000_000, 2**31 - 1, -(2**31)):
        command(b, "coordre", 1, 0, 1, positions((2, value)))
        b.run(3)
    command(b, "coordre", 1, 0, 1, positions((2, 0)))
    for value in (0, -1, 1, 99_999_999, 100_000_000, 2**31 - 1):
        command(b, "dwell", 1, 1, 1, positions((2, value)))
        b.run(4)
        b.act("reset")


def direct_at_work(b: Bench) -> None:
    """Direct commands beside each other and beside programs, modes, holds, overrides, resets, alarms, in units."""
    b.title(
        "one axis for two paths; two buffers; the longest dwell counts; the flag of a command that is dropped"
    )
    ready(b, axes=3)
    command(b, "incpoint", 1, 1, 2, 3000, positions((1, 900), (3, -2500)))
    command(b, "incpoint", 2, 1, 1, 3000, positions((3, 700)))
    command(b, "dwell", 3, 1, 3, positions((1, 20), (2, 90), (3, 50)))
    command(b, "refpoint", 1, 0, 1)
    command(b, "refpoint", 1, 0, 3)
    for cycles in (3, 20, 30, 20, 20, 60, 300, 1000):
        b.run(cycles)
    b.title("the feed override, a hold, a servo that is off, a mode, a lock")
    for name, acts in (
        ("override", ((10, 50), (10, 200), (10, 0), (10, 100))),
        ("hold", ((2, 0), (2, 1))),
        ("servo off", ((4, 1), (4, 0))),
        ("modes", ((9, 4), (9, 0), (9, 1))),
        ("reset", ((3, 1), (3, 0))),
        ("emergency", ((1, 0), (1, 1))),
    ):
        b.lines.append(f"- {name}")
        command(b, "incpoint", 1, 1, 1, 3000, positions((1, 4000)))
        command(b, "incpoint", 1, 1, 1, 3000, positions((1, -4000)))
        b.run(30)
        for number, value in acts:
            signal(b, number, value, cycles=30)
        b.run(1000)
        b.do("cnc_setfin", fwlib.ODBFIN(cdata=[0xFF] * 8))
    b.title("the buffer that becomes free takes the next command, though the other one is not empty")
    for axis, value in ((1, 90), (2, 4000), (3, 70), (1, -50), (2, -4000)):
        command(b, "incpoint", 3, axis % 2, 1, 6000, positions((axis, value)))
        b.run(25)
        command(b, "dwell", 3, 0, 1, positions((axis, 9)))
    b.run(600)
    b.title("commands that are given while a hold or a servo that is off is there already")
    for number, on, off in ((2, 0, 1), (4, 2, 0)):
        signal(b, number, on)
        command(b, "incpoint", 1, 1, 1, 6000, positions((2, 60)))
        command(b, "coordre", 2, 1, 1, positions((2, 33)))
        command(b, "dwell", 3, 1, 1, positions((2, 7)))
        command(b, "refpoint", 4, 1, 3)
        b.run(40)
        signal(b, number, off, cycles=40)
        b.run(100)
    b.title(
        "held on the way: two axes, a reference return, a dwell, a coordinate; by the button; a reset while held"
    )
    command(b, "incpoint", 1, 1, 2, 3000, positions((1, 2000), (3, -900)))
    command(b, "refpoint", 1, 0, 3)
    command(b, "refpoint", 2, 1, 1)
    command(b, "dwell", 4, 1, 1, positions((2, 60)))
    b.run(20)
    for number, value, axis in ((2, 0, 0), (4, 4, 0), (2, 1, 0), (4, 0, 0), (2, 0, 0)):
        signal(b, number, value, axis, cycles=45)
    command(b, "coordre", 5, 1, 1, positions((2, 77)))
    b.run(20)
    for value in (1, 0, 1, 0, 1):
        signal(b, 2, value, cycles=25)
    b.run(2000)
    command(b, "abspoint", 1, 1, 1, 3000, positions((1, 5000)))
    b.run(30)
    b.act("feed_hold")
    b.run(300)
    b.act("cycle_start")
    b.run(20)
    b.act("feed_hold")
    b.run(100)
    b.act("reset")
    b.run(300)
    command(b, "abspoint", 1, 1, 1, 3000, positions((1, 0)))
    b.run(400)
    b.do("cnc_setfin", fwlib.ODBFIN(cdata=[0xFF] * 8))
    b.title("an alarm, the emergency stop, a command while it is on, a limit of each axis in each direction")
    command(b, "incpoint", 1, 1, 1, 3000, positions((1, 4000)))
    b.run(30)
    b.act("raise_alarm", 410, axis=2)
    b.run(300)
    command(b, "incpoint", 2, 1, 1, 3000, positions((2, 40)))
    b.run(30)
    b.act("reset")
    signal(b, 1, 0)
    command(b, "refpoint", 2, 1, 1)
    command(b, "refpoint", 9, 1, 1)
    signal(b, 1, 1)
    signal(b, 3, 1)
    command(b, "dwell", 2, 1, 1, positions((1, 5)))
    signal(b, 3, 0)
    b.act("power_cycle")
    b.parameters(1320, 5000, 6000, 7000)
    b.parameters(1321, -5100, -6100, -7100)
    for axis, value in ((1, 9000), (2, -9000), (3, 9000), (1, -9000), (2, 9000), (3, -9000)):
        command(b, "abspoint", 1, 1, 1, 3000, positions((axis, value)))
        b.run(400)
        b.act("reset")
        b.run(100)
    for here, low, high, there in ((3000, 1000, 6000, 500), (-3000, -6000, -1000, -500)):
        command(b, "abspoint", 1, 0, 1, 3000, positions((2, here)))
        b.run(900)
        b.parameters(1321, -5100, low, -7100)
        b.parameters(1320, 5000, high, 7000)
        command(b, "abspoint", 1, 1, 1, 3000, positions((2, there)))
        b.run(400)
        b.act("reset")
        b.parameters(1321, -5100, -6100, -7100)
        b.parameters(1320, 5000, 6000, 7000)
    b.title("a program has the axes")
    b.program(61, "N1 G1 X2. F1200\nN2 G4 X0.1\nN3 M30")
    command(b, "dwell", 6, 0, 1, positions((3, 4)))
    b.run(20)
    command(b, "incpoint", 1, 0, 1, 3000, positions((2, 40)))
    b.act("feed_hold")
    b.run(100)
    command(b, "incpoint", 1, 0, 1, 3000, positions((2, 40)))
    b.run(100)
    b.act("cycle_start")
    b.run(900)
    command(b, "incpoint", 1, 0, 1, 3000, positions((2, 40)))
    b.act("cycle_start")
    b.run(400)
    b.act("power_cycle")


def direct_units(b: Bench) -> None:
    """Units and signs of positions and feeds: increments, inches, rotary axes; what a Power Mate-D refuses."""
    for machine in (
        {"increment": "IS-A"},
        {"increment": "IS-B", "inch_output": True},
        {"inch_input": True},
        {"rotary": (2,)},
        {"increment": "IS-A", "inch_output": True, "rotary": (3,)},
        {"inch_input": True, "inch_output": True},
        {"inch_output": True, "axes": 6, "rotary": (2, 5)},
    ):
        ready(b, **({"axes": 3} | machine))
        if b.control.axes > 3:
            command(b, "incpoint", 2, 0, 3, 1200, positions((4, 333), (5, -444), (6, -555)))
            command(b, "coordre", 3, 0, 2, positions((4, 1000), (5, -70)))
            command(b, "abspoint", 6, 0, 3, 1200, positions((6, 71), (5, 72), (4, -73)))
            b.run(3000)
        command(b, "incpoint", 1, 0, 3, 900, positions((1, 123), (2, -456), (3, 78)))
        b.run(12)
        b.run(3000)
        command(b, "coordre", 1, 0, 2, positions((2, 1000), (3, -70)))
        b.run(3)
        command(b, "abspoint", 1, 0, 3, 900, positions((3, 5), (1, -7), (2, 400)))
        b.run(3000)
        command(b, "refpoint", 4, 1, 2)
        b.run(3000)
        command(b, "refpoint", 5, 1, 3)
        b.run(3000)
    b.title("a Power Mate-D")
    b.fresh(model="D")
    b.parameters(8003, 0x80)
    b.parameters(8010, 1, 2)
    good = positions((1, 50))
    for name, more in (("refpoint", (1,)), ("abspoint", (1, 600, good)), ("incpoint", (1, 600, good)),
                       ("dwell", (1, good)), ("coordre", (1, good))):  # fmt: skip
        command(b, name, 1, 0, *more)
        command(b, name, 9, 3, *more)
    for number in range(17):
        signal(b, number, 1, cycles=0)
    b.ask("cnc_exebufstat")
    b.ask("cnc_finstate")
    b.ask("cnc_setfin", fwlib.ODBFIN())


SCENES = (signals_of_operation, signals_in_a_program, direct_commands, direct_at_work, direct_units)
