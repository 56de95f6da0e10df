"""What the services of a living control tell in every state, written down in `tests/golden/cpl_b/NAME.txt`.

The numbers themselves are asserted from the manual elsewhere; here nothing can change unseen, on any axis, in either
channel, whoever asks. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import pytest

from polycnc.cnc import Mode as ControlMode
from polycnc.cnc import RunState
from polycnc.controllers.bosch.ncs import DATA_SERVICES, Mode
from polycnc.controllers.bosch.system import Signals, Tab
from polycnc.nc.cpl import OMITTED, Field
from support.cpl_scenes_b import EXTRA, Bench, Orders, Waiters, holders, show, sizes

RECORDED = Path(__file__).parents[1] / "golden" / "cpl_b"
SCENES: dict[str, Callable[[Bench], None]] = {}


def scene(act: Callable[[Bench], None]) -> Callable[[Bench], None]:
    """Make a function a scene of a control."""
    SCENES[act.__name__] = act
    return act


PART = """1 FXC("X",54,1)=3 : FXC("Y",154,1)=-0.5 : FXC("B",254,1)=12 : FXC("U",160,0)=40.25 : FXC("Z",160,0)=-8
N1 G54 (MSG,CLAMP THE PART)
N1 G154
N1 G254
N2 G160
N3 H3 S1500 M3 M8
N4 G92 X-1.25
N5 G1 X20 Y-12.5 Z7 B-30 U6 F6000
N6 G4 F0.1
N7 M0
N8 M1 X22
N9 H0 G53 M5 M9
N9 G153
N9 G253
N10 G167
N11 X0 Y0 Z0 B0 U0
"""


@scene
def states(b: Bench) -> None:
    """A program runs, is held, goes on, dwells, stops at M0 and M1, ends; then single blocks, MDI, jog, alarm."""
    control = b.pnc.control
    b.look("power on")
    b.write("main1", PART)
    b.pnc.select_program("main1")
    b.look("selected", 1)
    b.pnc.cycle_start()
    b.look("started", 1)
    b.look("in N3, the spindle speeds up", 160)
    b.pnc.advance(2000, until=lambda: b.pnc.axes["X"].velocity > 5.0)
    b.pnc.feed_hold(channel=1)
    b.look("held: it runs down", 4)
    b.look("held: stopped", 200)
    b.pnc.cycle_start()
    b.look("goes on", 50)
    control.set_overrides(feed=0.3)
    b.look("feed override 30 %", 100)
    control.set_overrides(feed=0.0)
    b.look("feed override 0 %", 100)
    control.set_overrides(feed=1.5, spindle=1.2)
    b.look("feed override 150 %, spindle override 120 %", 40)
    b.pnc.advance(2000, until=lambda: b.data(39, 1) == "1")
    b.look("in N6, the dwell")
    b.look("in N7, M0", 200)
    control.set_switches(optional_stop=True, block_delete=frozenset({1}), channel=0)
    b.pnc.cycle_start()
    b.look("in N8, M1", 200)
    b.pnc.cycle_start()
    b.look("in N11, back", 60)
    b.pnc.reset(channel=1)
    b.look("reset on the way", 1)
    b.look("reset: stopped", 300)
    control.set_overrides(feed=1.0, spindle=1.0)
    control.set_switches(optional_stop=False, block_delete=frozenset(), channel=0)
    b.look("overrides as before", 1)


@scene
def modes(b: Bench) -> None:
    """Every mode, by hand, by blocks put in, one after the other, and after a search; then what goes wrong."""
    control, pnc = b.pnc.control, b.pnc
    b.look("power on")
    control.set_overrides(feed=0.25, channel=1)
    control.set_overrides(spindle=0.75)
    control.set_switches(optional_stop=True, block_delete=frozenset({2}), machine_lock=True, channel=1)
    b.look("overrides and switches of channel 2 before its first program", 1)
    control.set_overrides(feed=1.0, spindle=1.0)
    control.set_switches(optional_stop=False, block_delete=frozenset(), machine_lock=False)
    for mode in (
        Mode.PROGRAM_BLOCK,
        Mode.SINGLE_STEP,
        Mode.SINGLE_BLOCK,
        Mode.DEBUG_BLOCK,
        Mode.DEBUG_AUTOMATIC,
    ):
        pnc.select_mode(mode, channel=2)
        b.look(f"mode {mode.name} of channel 2", 1)
    pnc.select_mode(Mode.SINGLE_BLOCK, channel=2)
    b.run("N1 G70 X2=0.5 C2=20 F100\nN2 X2=1 (MSG,SECOND)\nN3 X2=0", 3, channel=2)
    b.look("channel 2, one block in inches", 100)
    b.look("channel 2 stands after the block", 10_000)
    pnc.cycle_start(channel=2)
    b.look("channel 2, the next block", 300)
    pnc.reset(channel=2)
    b.look("channel 2, reset while it moves", 1)
    b.look("channel 2 stands", 500)
    pnc.select_mode(Mode.MDI, channel=1)
    b.look("MDI", 1)
    pnc.select_blocks("N1 G1 X7.5 B-10 F3000")
    b.look("MDI, a block put in", 1)
    pnc.cycle_start()
    b.look("MDI, under way", 60)
    b.look("MDI, over", 1500)
    pnc.select_mode(Mode.JOG)
    b.look("jog", 1)
    control.jog("X", -1)
    control.jog("W", 1, rapid=True)
    control.jog("C2", 1)
    b.look("jog of X, W and C2", 200)
    control.jog("X", None)
    control.jog("W", None)
    control.jog("C2", None)
    b.look("jog over", 500)
    control.select_mode(ControlMode.INC)
    control.increment("Z", 1, 0.1)
    b.look("a step of Z", 15)
    control.select_mode(ControlMode.HANDLE)
    control.handwheel("U", -3, 0.01)
    b.look("three pulses of U back", 15)
    pnc.select_mode(Mode.REFERENCE)
    b.look("reference", 1)
    control.reference("Y")
    b.look("Y searches its reference point", 10)
    b.look("Y is there", 3000)
    pnc.select_mode(Mode.AUTOMATIC)
    b.write("main1", "N1 G1 X10 F6000\nN2 X20 (MSG,TWO)\nN3 M4 S900 X30\nN4 X40\nN5 X50")
    pnc.select_program("main1")
    pnc.search_block("N3", "N4")
    b.look("a search for N3", 1)
    pnc.cycle_start()
    b.look("on the way to N3", 40)
    b.look("over after N4", 20_000)
    control.set_switches(machine_lock=True)
    b.run("N1 G0 X5", 5)
    b.look("test without motion", 30)
    pnc.reset()
    pnc.advance(500)
    control.set_switches(machine_lock=False)
    pnc.advance(500)
    b.run("N1 G1 X50 F6000\n2 A=SD(999)", 900)
    b.look("an error of the program")
    pnc.reset()
    pnc.advance(500)
    b.run("N1 S500 M3\nN2 G1 X100 F6000", 500)
    control.emergency_stop()
    b.look("emergency stop on the way", 2)
    b.look("emergency stop, it stands", 1000)
    b.attempt("start", lambda: pnc.cycle_start())
    control.emergency_stop(False)
    b.look("emergency stop released", 10)
    pnc.reset()
    b.look("reset", 10)
    b.run("N1 G1 X-60 F9000", 50)
    control.put_alarm("following_error", axis="X")
    b.look("alarm of X on the way", 2)
    b.look("alarm, it stands", 1000)
    pnc.reset()
    b.look("reset", 10)


@scene
def new(b: Bench) -> None:
    """How often what waits for new data is answered, while nothing happens and while blocks are executed."""
    waiters = Waiters(b)
    b.say("power on")
    waiters.pass_cycles(1)
    waiters.pass_cycles(6)
    b.say("a program of three short blocks")
    b.run("".join(f"N{k} G1 X{k / 2} F60000\n" for k in range(1, 4)), 0)
    waiters.pass_cycles(60)
    b.say("channel 2: a message, a dwell, M8, inches, H3")
    b.run("N1 (MSG,A)\nN2 G4 F0.01\nN3 M8\nN4 G70\nN5 H3\nN6 X2=1 F100", 0, channel=2)
    waiters.pass_cycles(25)
    b.say("overrides, switches, modes")
    b.pnc.reset()
    b.pnc.advance(400)
    waiters.pass_cycles(1)
    b.pnc.control.set_overrides(feed=0.5, spindle=0.5)
    waiters.pass_cycles(2)
    b.pnc.control.set_switches(optional_stop=True, block_delete=frozenset({1}), machine_lock=True)
    waiters.pass_cycles(2)
    b.pnc.select_mode(Mode.JOG)
    waiters.pass_cycles(2)
    b.pnc.transfer_axis("W", 2)
    waiters.pass_cycles(2)
    b.pnc.control.jog("Y", 1)
    waiters.pass_cycles(10)


@scene
def refusals(b: Bench) -> None:
    """What services answer of channels, selections, types and sizes that are not theirs."""
    b.run("1 A=1", 20)
    for channel in (-3, -2, -1, 0, 1, 2, 3, 64):
        b.say(f"channel {channel}")
        found: dict[str, list[str]] = {}
        for service in range(-1, 103):
            answer = b.data(service, channel, *EXTRA.get(service, ()))
            found.setdefault(answer if answer.startswith("code") else "data", []).append(str(service))
        for answer, services in found.items():
            b.note(answer, " ".join(services))
    b.say("selections")
    for service, selections in {
        42: [(), (-1,), (0,), (65535,), (65536,)],
        **{k: [(), (-1,), (0,), (1,), (2,), (3,), (4,), (5,), (12,), (13,), (64,)] for k in (55, 56, 57)},
        62: [(), (1,), (1, 39), (1, 40), (1, 41), (1, 47), (1, 51), (2, 51), (1, 53), (1, -1)],
    }.items():
        for selection in selections:
            b.note(f"{service} {selection}", b.data(service, -1, *selection))
    b.say("variables that are filled")
    kinds: dict[str, list[str]] = {}
    for service in DATA_SERVICES:
        kinds.setdefault(holders(b, service), []).append(str(service))
    for kind, services in kinds.items():
        b.note(kind, " ".join(services))
    b.say("sizes from 0, of a field of 3 or a text of 9")
    kinds = {}
    for service in DATA_SERVICES:
        kinds.setdefault(sizes(b, service), []).append(str(service))
    for kind, services in kinds.items():
        b.note(" ".join(services), kind)


PARTS = {
    "PART": "N1 G1 X2=1 F6000\nN2 X2=2\nN3 X2=3\nN4 X2=4\nM30\n",
    "WRONG": "N1 G1 X2=1 F600\n20 IF A\n",
    "main2": "N1 G1 X2=20 F600\nN2 X2=30\nN3 M0\nN4 X2=0\n",
    "stop": "N1 M0\nN2 G1 X2=30 F600\nN3 X2=40\n",
}


@scene
def orders(b: Bench) -> None:
    """What a channel does when another control asks for process services, in every state of its own."""
    pnc = b.pnc
    for name, program in PARTS.items():
        b.write(name, program)
    given = Orders(b)
    given.give_all("nothing selected")
    for channel in (-3, -2, -1, 0, 1, 3):
        given.channel = channel
        b.note(
            f"channel {channel}",
            " ".join(given.give(order) for order in ((6,), (5,), (7, 5), (8, 1, 1), (9,), (1,))),
        )
    given.channel = 2
    pnc.select_program("main2", channel=2)
    given.give_all("selected")
    pnc.cycle_start(channel=2)
    pnc.advance(300)
    given.give_all("under way")
    pnc.feed_hold(channel=2)
    pnc.advance(100)
    pnc.reset(channel=2)
    pnc.advance(100)
    pnc.select_program("stop", channel=2)
    pnc.cycle_start(channel=2)
    pnc.advance(20)
    given.give_all("at M0")
    pnc.reset(channel=2)
    pnc.advance(20)
    pnc.select_mode(Mode.MDI, channel=2)
    given.give_all("MDI")
    pnc.select_blocks("G1 X2=30 F600", channel=2)
    pnc.cycle_start(channel=2)
    pnc.advance(100)
    given.give_all("MDI, under way")
    pnc.reset(channel=2)
    pnc.advance(200)
    pnc.select_mode(Mode.JOG, channel=2)
    given.give_all("jog")
    pnc.select_mode(Mode.REFERENCE, channel=2)
    pnc.select_mode(Mode.AUTOMATIC, channel=2)
    pnc.control.emergency_stop()
    given.give_all("emergency stop")


PROGRAMMED = """10 FXC("X",54,1)=3 : FXC("Y",154,1)=-0.5 : FXC("B",255,1)=12 : FXC("U",260,0)=40.25 : TC(1,345,0)=2.5
11 TC(3,247,0)=1.5 : TC(1,247,0)=-7 : TC(2,247,0)=0.25
N1 G54
N2 G154
N3 G255
N4 G260
N5 G1 X4 Y-2 Z1.5 B7 U0.5 F6000 S900 M4
6 WAIT
N7 M0
N8 G70 H3 M3 S1234
N9 G18 X0.5 B-7.5 F100
10 WAIT
N11 M0
N12 G71 G17 G168 X1.5 Z-2 U0.25
N13 G268 X0.125 B3
N14 G92 Y7
N15 G345
N16 G247
N17 X1 Y8 Z-3
18 WAIT
N19 M0
N20 G91 X-1 G94 F1500 M19
N21 G54 G90 G360
N22 X0 Z0
23 WAIT
N24 M0
"""


@scene
def programmed(b: Bench) -> None:
    """System data, positions and last functions of both channels, with what is in force of a program."""
    b.run("N1 G70 G168 X2=1\nN2 G1 X2=0.5 C2=10 F50\nN3 M0\n", 900, channel=2)
    b.write("main1", PROGRAMMED)
    b.pnc.select_program("main1")
    for what in ("shifts of the tables and from outside", "inches, another plane, H", "program shifts, tools", "increments"):
        b.pnc.cycle_start()
        b.pnc.advance(20_000, until=lambda: b.pnc.run_state(1) is not RunState.ACTIVE)
        b.pnc.control.set_overrides(feed=0.7, spindle=1.2)
        b.look(what, 600, b.system_data)
        b.look(what, 0)


GROUPS = (*range(53, 60), *range(153, 160), *range(253, 260), 160, 260, 360, 161, 60, 0, -54)
ENDS = (0, 1, 2, 5, 6, 8, 9, 12, 13, 64, 65, -1, -2, -65)


@scene
def tables(b: Bench) -> None:
    """Zero shifts, compensations and tool data as programs of both channels write and read them, to the ends."""
    b.run("N1 G1 X0 F600\nN2 M0", 50)
    b.run("N1 G70 G1 X2=0 F600\nN2 M0", 50, channel=2)
    b.say("zero shifts: every G address of V1, V2 and V3, and from outside, by index and name")
    for table in range(-1, 5):
        codes = GROUPS if table in (1, 3) else (54, 159, 259, 160, 260, 360)
        b.set_all("FXC", ((code + table / 8, (axis, code, table)) for code in codes for axis in (1, 9)))
        b.ask_all("FXC", ((axis, code, table) for code in codes for axis in (1, 9, 5)))
    b.say("zero shifts: axes")
    b.set_all("FXC", ((2.5, (axis, code, table)) for code, table in ((54, 1), (160, 0)) for axis in ENDS))
    b.ask_all("FXC", ((axis, code, table) for code, table in ((54, 1), (160, 0)) for axis in ENDS))
    names = ("X", "-X", "B", "U", "W", "X2", "-X2", "Q", "", "x", "--X")
    for channel in (1, 2):
        b.set_all("FXC", ((1.25, (axis, 55, 2)) for axis in names), channel=channel)
        b.set_all("FXC", ((1.25, (axis, 360, 0)) for axis in names), channel=channel)
        b.ask_all("FXC", ((axis, 55, 2) for axis in names), channel=channel)
        b.ask_all("FXC", ((axis, 360, 0) for axis in names), channel=channel)
        b.ask_all("FXC", ((axis,) for axis in names), channel=channel)
    b.say("zero shifts: units, and what is added")
    for unit in (-1, 0, 1, 2, 3):
        b.set_all("FXC", ((2.0, (axis, 56, 1, unit)) for axis in ("X", "-X", "B", "-B")))
        b.ask_all("FXC", ((axis, 56, 1, other) for axis in ("X", "B", 9) for other in (0, 2)))
    b.set_all("FXC", [(each, ("X", 57, 1)) for each in (True, "7", 1e9, -1e9, 1e-9)])
    b.ask_all("FXC", [("X", 57, 1), ("X", 57), ("X", 57, "V1"), ("X", 57, "/none.npv"), ("X", 54.5, 1)])
    b.say("tables as files")
    b.ask_all("FXCR", [(1, "A.npv"), (2, "B.npv", 0), (0, "C.npv", 1), (3, "D.npv"), (-1, "D.npv"), (1, ""),
                       ("A.npv", "E.npv"), ("none.npv", "F.npv"), (1, "G.npv", 2), (1, "A.npv"), (1, "V1")])  # fmt: skip
    b.ask_all("FXINS", [("A.npv", "X", "N"), ("A.npv", 2, "R", 0), ("A.npv", "U", "X"), ("A.npv", 9, "P"),
                        ("A.npv", "Q", "P"), ("A.npv", 1, "P", 2), ("none.npv", 1, "P"), ("A.npv", 0, "P")])  # fmt: skip
    b.ask_all("FXDEL", [("A.npv", "Y"), ("A.npv", "Y"), ("A.npv", 1), ("A.npv", 0), ("A.npv", 9), ("none.npv", 1)])
    b.set_all("FXC", ((axis + 0.5, (axis, 54, "A.npv")) for axis in range(8)))
    for name in "ABCDEFG":
        path = b.folder / f"{name}.npv"
        b.note(name, path.read_text().replace("\n", " / ") if path.exists() else "not there")
    b.say("compensations: every group, selection and table")
    for table in (-1, 0, 3, 4, 5, 6):
        groups = {0: (145, 245, 845, 945, 146, 147, 247, 847, 947), 4: (0, 1, 2, 48, 49, 145, -1), 5: (1, 48, 147)}.get(
            table, (48, 145)
        )
        b.set_all("TC", ((group / 4 + sel, (sel, group, table)) for group in groups for sel in range(10)))
        b.set_all("TC", ((0.5, (-sel, group, table)) for group in (48, 845, 247) for sel in range(1, 9)))
        b.ask_all("TC", ((sel, group, table) for group in groups for sel in range(-1, 10)))
    b.say("compensations: units")
    for unit in (-1, 0, 1, 2, 3):
        b.set_all("TC", ((2.0, (sel, group, table, unit)) for sel, group, table in ((1, 7, 4), (-2, 7, 5), (1, 345, 0))))
        b.ask_all("TC", ((sel, 7, table, other) for sel, table in ((1, 4), (2, 5)) for other in (0, 2)))
    b.set_all("TC", ((2.0, (sel, 347, 0)) for sel in range(1, 9)), channel=2)
    for channel in (1, 2):
        b.ask_all("TC", [*((sel, 347, 0) for sel in range(1, 9)), (1, 7, 4), (1, 7), *((sel,) for sel in range(10))], channel)
    b.say("tool data: fields, sectors, places, tables")
    b.set_all("TDA", ((field + 0 if field not in (8, 49) else f"T{field}", (9, 999, field)) for field in range(51)))
    b.ask_all("TDA", ((9, 999, field) for field in range(51)))
    b.ask_all("TDA", [(s, p, 3) for s, p in ((0, 1), (1, 0), (1, 1), (1, 999), (1, 1000), (9, 998), (10, 1), (1.5, 1))])
    b.ask_all("TDA", [(9, 999, 48, table) for table in (0, 1, 2)] + [(9, 999, 3.5), ("A", 1, 3)])
    values = (2**31 - 1, -(2**31), 1.0, 1.5, True, "TEXT", "L" * 31, "L" * 32, "")
    for field in (3, 7, 8, 9, 48, 49):
        b.set_all("TDA", ((value, (1, 1, field)) for value in values))
        b.ask_all("TDA", [(1, 1, field)])


@scene
def signals(b: Bench) -> None:
    """Interface signals, data of the PLC, parameters, drives and errors, to the ends of their ranges."""
    b.write("macoda.dat", "")
    b.run("N1 G1 X7.5 B12 F6000\nN2 M0", 400)
    b.run("N1 G70 G1 X2=0.5 F60\nN2 M0", 50, channel=2)
    b.say("signals: bits of every group, TRUE in turn by the PLC")
    sizes_of = (112, 112, 112, 96, 64, 64, 32, 32, 8, 6)
    for group, size in enumerate(sizes_of):
        most = {0: 2, 3: 2, 1: 64, 4: 64, 2: 8, 5: 8}.get(group, 1)
        least = 0 if group in (0, 3) else 1
        for index in (least, most):
            for bit in (0, 1, size - 1):
                b.pnc.system.interface.set_bit(Signals(group), index, bit, bit != 1)
        asked = [(bit, group, index) for bit in (-1, 0, 1, size - 1, size) for index in (least - 1, least, most, most + 1)]
        b.ask_all("IC", asked)
        b.ask_all("IC", [(bit, group) for bit in (0, 1, size - 1)], channel=2)
    b.ask_all("IC", [(0,), (1,), (111,), (112,), (0, 10), (0, -1), (0.5,), (0, 0, 0), (True,)])
    b.say("signals that programs set")
    b.set_all("IC", ((True, (bit, *rest)) for bit in (79, 80, 95, 96) for rest in ((), (0,), (0, 0), (0, 2), (3,), (1,))))
    b.set_all("IC", [(1, (81,)), (False, (80,)), (False, (95, 0, 2)), (True, (90, 0, 3))])
    for channel in (1, 2):
        b.ask_all("IC", ((bit, 3, index) for bit in (79, 80, 81, 90, 95) for index in (0, 1, 2)), channel)
        b.ask_all("IC", ((bit, 0) for bit in (79, 80, 95)), channel)
    b.say("data of the PLC")
    plc = b.pnc.system.plc
    for kind, data in plc.ranges.items():
        data[:6] = bytes((kind, 254, 3, 128, 0, 255))
        data[-2:] = bytes((7, 200 + kind))
    plc.timers_ms[255], plc.counters[0] = 1234, 56
    for size in (0, 1, 2, 3, 4):
        ends = (-1, 0, 1, 2, 256 - max(size, 1), 257 - max(size, 1))
        b.ask_all("PLC", ((kind, OMITTED, address, size) for kind in range(14) for address in ends))
    b.ask_all("PLC", ((kind, OMITTED, place) for kind in (7, 8) for place in (-1, 0, 255, 256)))
    plc.first_writable, plc.writable = 98, 2
    b.set_all("PLC", ((-1 if size == 4 else 200, (4, module, 0, size)) for module in (97, 98, 99, 100) for size in (1, 2, 4)))
    values = (-(2**31), -(2**31) - 1, -1, 0, 255, 256, 65535, 65536, 2**31 - 1, 2**31, 1.5, True)
    for size in (1, 2, 4):
        b.set_all("PLC", ((value, (4, 98, 8, size)) for value in values))
        b.ask_all("PLC", [(4, 98, 8, size), (4, 98, 512 - size, size), (4, 98, 513 - size, size), (4, 256, 0, size)])
    b.set_all("PLC", ((1, (kind, OMITTED, 0, 1)) for kind in range(14)))
    b.say("parameters and drives")
    numbers = (100300001, 100300002, 100300004, 101500100, 102000001, 706000020, 701000020, 601000010)
    b.ask_all("MCA", ((each, index) for each in numbers for index in (-1, 0, 1, 2, 8, 11, 12)))
    b.ask_all("MCA", ((701000010, index, channel) for index in (0, 2, 5) for channel in (-1, 0, 1, 2, 3)))
    b.ask_all("SCS", (("X", kind, n) for kind in ("S", "P", "Q", "s") for n in (30, 40, 47, 51, 140, 141, 189, 17, 1)))
    b.ask_all("SCS", ((axis, "S", 51) for axis in (0, 1, 3, 5, 12, 13, "B", "X2", "W", "Q")))
    b.ask_all("SCSL", ((axis, "S", n, f"L{n}") for axis in (1, 12, 3) for n in (17, 187, 51)))
    b.note("L17", (b.folder / "L17").read_text().replace("\n", " ") if (b.folder / "L17").exists() else "not there")
    b.say("errors")
    b.pnc.reset()
    b.pnc.advance(400)
    b.run("1 A=SD(999)", 20)
    b.run("N1 G1 Q5", 20, channel=2)
    b.pnc.control.put_alarm("following_error", axis="X2")
    b.pnc.control.put_alarm("function_failed", detail="M8")
    b.pnc.control.emergency_stop()
    b.pnc.advance(5)
    cases = [(channel, kind, 9) for channel in (-2, -1, 0, 1, 2, 3) for kind in (0, 2, 5, 6, 8)]
    for channel, kind, count in [*cases, *((-1, kind, 9) for kind in (-1, 10, 11)), *((-1, 0, n) for n in (0, 1, 2, 1.5))]:
        errors = Field("I", (4, 3))
        found = b.call("GETERR", channel, kind, errors, count)
        rows = " ".join("/".join(str(errors[row, column]) for column in (1, 2, 3)) for row in range(1, 5))
        b.note(f"GETERR({channel},{kind},E%,{count}) {found}", rows)
    for tab in Tab:
        b.note(f"window of {tab.name}", " / ".join(" ".join(each) for each in b.pnc.information(tab)))
    b.pnc.control.emergency_stop(False)
    b.pnc.reset(channel=1)
    errors = Field("I", (1, 3))
    b.note("after a reset of channel 1", b.call("GETERR", -1, 0, errors, 1))
    b.pnc.reset()
    b.note("after a reset of both", b.call("GETERR", -1, 0, errors, 1))


_ = OMITTED
BITMAP = (
    b"BM" + struct.pack("<IHHI", 54 + 8 * 2, 0, 0, 54) + struct.pack("<IiiHHIIiiII", 40, 2, 2, 1, 24, 0, 16, 0, 0, 0, 0)
    + bytes((0, 0, 255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0))
)  # fmt: skip
"""Red and white above, blue and green above black, from below as bitmaps are."""


FORMATS = (
    "I%", "R", "D!", "T$", "B?", '"A ##.# B ### C",R,I%', '"#",I%', '"##",I%', '"#.#",R', '"##.#",R', '"###.###",99.9996',
    '"[##]",I%', 'I%,R', '"##",T$,I%', '"A","B",I%', '"##.##",I%', '"###",R', '"######",1E5', "1E10", "0.0001", "-0.5",
)  # fmt: skip


@scene
def screen(b: Bench) -> None:
    """What each function of the screen draws and writes, to the ends of its arguments; refused ones draw nothing."""
    (b.folder / "cplbmp").mkdir()
    (b.folder / "cplbmp" / "m.bmp").write_bytes(BITMAP)
    b.run("1 A=1", 20)
    show(b, ("CLS",))
    for kind in (0, 3, 4, 5, -1, 1.0):
        show(b, ("CLR",), ("GMD", kind), ("LIN", 10, 20, 60, 20), ("LIN", 10, 25, 40, 55))
    for kind in (1, 2, 2, 1, 2):
        show(b, ("GMD", kind), ("LIN", 10, 20, 60, 20), ("LIN", 10, 25, 40, 55))
    show(b, ("GMD", 0), ("CLR",), ("LIN", 0, 0, 632, 374), ("LIN", 632, 374, 632, 0), ("LIN", 0, 0, 633, 0))
    show(b, ("CLR",), ("LIN", 5, 6), ("LIN", _, 9), ("LIN", 12, _), ("LIN", 1.5, 2.4, 7.5, 8.6), ("LIN", -5, 3))
    show(b, ("CLS",), ("COL", 3), ("CIR", 100, 80, 10), ("CIR", _, 120, _), ("CIR", 130, 80, 0), ("CIR", 130, 80, -1))
    show(b, ("CLS",), ("CIR", 200, 0, _, _, 200, 10), ("CIR", 50, 50, 70, 70, 70, 50), ("CIR", 300, 60, 300, 40, 300, 50))
    for edges in ((0, 632, 0, 374), (10, 110, 20, 70), (0, 633, 0, 374), (-1, 9, 0, 9), (5, 5, 0, 9), (0, 9, 9, 9), (0, 9, 0, 375)):
        show(b, ("GWD", *edges), ("CLR",), ("LIN", 0, 0, 632, 374), ("CIR", 60, 40, 30))
    show(b, ("GWD", 100, 300, 50, 150), ("MWD", 0, 20, 0, 10), ("LIN", 0, 0, 20, 10), ("LIN", 10, 5), ("CIR", 10, 5, 2))
    show(b, ("MWD", 0, 20, 0, 20), ("LIN", 0, 0, 20, 20), ("MWD", 9, 9, 0, 1), ("MWD", 0, 1, 5, 4))
    show(b, ("CLS",), ("GWD", 0, 632, 0, 374), ("COL", 5), ("LIN", 10, 10, 30, 10), ("LIN", 30, 30), ("LIN", 10, 30), ("LIN", 10, 10))
    for more in ((0, 4, 5), (0, 6), (5, 2, 5), (6, 2), (-1, 2), (0, 8), (0, -1), (0, 7, 8)):
        show(b, ("FIL", 20, 20, *more))
    show(b, ("FIL", 633, 20, 0, 3), ("FIL", 20, 375, 0, 3), ("CLG",), ("DLF",))
    for place in ((0, 1), (7, 7), (8,), (-1,), (1.5,), (_, 3, 1), (_, _, 6)):
        show(b, ("CLS",), ("COL", *place), ("LIN", 1, 1, 4, 1), ("DSP", 1, 1, "A"))
    for table in (7, 10, 1, 2, 3, 4):
        show(b, ("COL", 2, 4, 3, table, 6, 5), ("LIN", 1, 1, 9, 1), ("DSP", 3, 4, "TABLE"))
    for portions in ((0, 255, 0, 0), (7, 1, 2, 3), (8, 0, 0, 0), (-1, 0, 0, 0), (3, 256, 0, 0), (3, 0, -1, 0), (3, 0, 0, 256)):
        show(b, ("RGB", *portions))
    show(b, ("CLS",), ("COL", 1, 2, 0, 7))
    for line, column in ((1, 1), (46, 79), (0, 1), (47, 1), (1, 0), (1, 80), (20, 40)):
        show(b, ("DSP", line, column, "<AB>"))
    show(b, ("DSP", 16, 1, "T" * 77), ("DSP", 17, 1, "T" * 78))
    show(b, ("CLS",))
    for row, what in enumerate(FORMATS, 1):
        b.run(f"1 I%=42 : R=-3.25 : D!=1.5 : T$=\"AB\" : B?=TRUE\n2 DSP({row},3,{what})\n3 WAIT\nN4 M0", 10)
        b.note(f"DSP({row},3,{what})", repr(b.pnc.screen().lines()[row - 1].rstrip()))
        b.note(" ".join(alarm.text for alarm in b.pnc.status().alarms) or "shown")
        b.pnc.reset()
        b.pnc.advance(2)
    b.run("1 CLS\nN2 M0", 10)
    for place in ((0, 0), (632, 414), (633, 0), (0, 415), (-1, 0), (0, -1), (40, 50)):
        show(b, ("GPR", *place, "GRAPHIC"))
    for font in (0, 5, 10, 11, -1):
        show(b, ("CLS",), ("TFO", font, 12, 1, 90), ("DSP", 4, 5, "FONT"))
    for font in ((1, 500), (1, 501), (1, 0), (1, 500500), (1, 501012), (1, 12501), (1, -1), (1, 20008), (1, 1000)):
        show(b, ("CLS",), ("TFO", *font), ("GPR", 9, 9, "F"))
    for font in ((1, 8, 3, 360), (1, 8, 4), (1, 8, -1), (1, 8, 2, 361), (1, 8, 0, -1), (_, _, 3), (5, 8, 0, 45), (0, 0, 0, 0)):
        show(b, ("CLS",), ("TFO", *font), ("GPR", 9, 9, "F"))
    for copy in (_, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, -1):
        show(b, ("CLS",), ("COL", 3), ("LIN", 20, 40, 21, 40), ("BMP", 20, 40, "m", copy))
    for place in ((0, 0), (632, 374), (633, 0), (0, 375), (-1, 0), (0, -1)):
        show(b, ("CLS",), ("BMP", *place, "m"))
    show(b, ("BMP", 1, 1, "none"), ("BMP", 1, 1, "n" * 70), ("BMP", 1, 1, "n" * 71), ("BMP", 1, 1, "../m"))


@pytest.mark.parametrize("name", SCENES)
def test_a_control_tells_what_is_written_down(
    name: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    bench = Bench(tmp_path)
    try:
        SCENES[name](bench)
    except Exception:
        print("\n".join(bench.lines))
        raise
    finally:
        bench.pnc.close()
    file, found = RECORDED / f"{name}.txt", "\n".join([f"# {SCENES[name].__doc__}", *bench.lines, ""])
    if request.config.getoption("update_goldens"):
        file.write_text(found, encoding="utf-8")
    assert found.splitlines() == file.read_text(encoding="utf-8").splitlines()
