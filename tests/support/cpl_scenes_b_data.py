"""Scenes of what programs read and write: system data, tables, signals, PLC data, and what services refuse."""

from __future__ import annotations

from polycnc.cnc import RunState
from polycnc.controllers.bosch.ncs import DATA_SERVICES
from polycnc.controllers.bosch.system import Signals, Tab
from polycnc.nc.cpl import OMITTED, Field
from support.cpl_scenes_b import EXTRA, LEFT_OUT, Bench, scene, shown_order
from support.cpl_scenes_b_asked import holders, sizes


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
    for what in (
        "shifts of the tables and from outside",
        "inches, another plane, H",
        "program shifts, tools",
        "increments",
    ):
        b.pnc.cycle_start()
        b.pnc.advance(20_000, until=lambda: b.pnc.run_state(1) is not RunState.ACTIVE)
        b.pnc.control.set_overrides(feed=0.7, spindle=1.2)
        b.look(what, 600, b.system_data)
        b.look(what, 0)
    b.say("which system data there are")
    ends = (0, 1, 2, 3, 8, 9, 10, 11, 48, 49, 64, 65)
    more = [
        (),
        *((i,) for i in (0, 1, 2, 3, 4, 8, 9)),
        *((i, j) for i in (0, 1, 2, 3, 4, 11, 13, 22) for j in ends),
    ]
    for name in ("SD", "SDR"):
        for group in (*range(18), *range(20, 26), 68, 131, 168, 200, 202, 205, 212, 268, 328, 581, 999):
            asked = [(shown_order(each), b.call(name, group, *each)) for each in more]
            found = [f"({each}) {value}" for each, value in asked if value != LEFT_OUT]
            b.note(f"{name} {group}", " ".join(found) or "none")


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
        for code in codes:  # what is set replaces what was there
            b.set("FXC", 7.0, 1, code, table)
            b.set("FXC", 7.0, 9, code, table)
        b.set_all("FXC", ((code + table / 8, (axis, code, table)) for code in codes for axis in (1, 9)))
        b.ask_all("FXC", ((axis, code, table) for code in codes for axis in (1, 9, 5)))
    b.say("zero shifts in force, by group and from outside")
    for code in (*range(54, 60), *range(154, 160), *range(254, 260), 160, 260, 360):
        b.pnc.reset(channel=1)
        b.pnc.advance(2)
        b.run(f"N1 G{code}\nN2 G1 F6000\nN3 M0", 8)
        b.note(
            f"G{code}",
            f"{b.data(15, 1)}, outside {b.data(52, 1)}, X is {b.call('FXC', 1)}, {b.call('NCF', f'G{code}')}",
        )
    b.pnc.reset(channel=1)
    b.pnc.advance(2)
    b.run("N1 G1 X0 F600\nN2 M0", 50)
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
    for unit, codes in (
        (-1, (56,)),
        (0, (56,)),
        (1, (56,)),
        (2, (56, 54, 59, 154, 159, 254, 259, 160)),
        (3, (56,)),
    ):
        b.set_all("FXC", ((2.0, (axis, code, 1, unit)) for code in codes for axis in ("X", "-X", "B", "-B")))
        b.ask_all(
            "FXC", ((axis, code, 1, other) for code in codes for axis in ("X", "B", 9) for other in (0, 2))
        )
    b.set_all("FXC", [(each, ("X", 57, 1)) for each in (True, "7", 1e9, -1e9, 1e-9)])
    b.ask_all("FXC", [("X", 57, 1), ("X", 57), ("X", 57, "V1"), ("X", 57, "/none.npv"), ("X", 54.5, 1)])
    b.say("tables as files")
    b.ask_all("FXCR", [(1, "A.npv"), (2, "B.npv", 0), (0, "C.npv", 1), (3, "D.npv"), (-1, "D.npv"), (1, ""),
                       ("A.npv", "E.npv"), ("none.npv", "F.npv"), (1, "G.npv", 2), (1, "A.npv"), (1, "V1")]
    )  # fmt: skip
    b.ask_all("FXINS", [("A.npv", "X", "N"), ("A.npv", 2, "R", 0), ("A.npv", "U", "X"), ("A.npv", 9, "P"),
                        ("A.npv", "Q", "P"), ("A.npv", 1, "P", 2), ("none.npv", 1, "P"), ("A.npv", 0, "P")]
    )  # fmt: skip
    b.ask_all(
        "FXDEL", [("A.npv", "Y"), ("A.npv", "Y"), ("A.npv", 1), ("A.npv", 0), ("A.npv", 9), ("none.npv", 1)]
    )
    b.set_all("FXC", ((axis + 0.5, (axis, 54, "A.npv")) for axis in range(8)))
    for name in "ABCDEFG":
        path = b.folder / f"{name}.npv"
        b.note(name, path.read_text().replace("\n", " / ") if path.exists() else "not there")
    b.say("compensations: every group, selection and table")
    for table in (-1, 0, 3, 4, 5, 6):
        groups = {
            0: (145, 245, 845, 945, 146, 147, 247, 847, 947),
            4: (0, 1, 2, 48, 49, 145, -1),
            5: (1, 48, 147),
        }.get(table, (48, 145))
        for group in groups:  # what is set replaces what was there
            for sel in range(1, 9):
                b.set("TC", 9.0, sel, group, table)
        b.set_all("TC", ((group / 4 + sel, (sel, group, table)) for group in groups for sel in range(10)))
        b.set_all("TC", ((0.5, (-sel, group, table)) for group in (48, 845, 247) for sel in range(1, 9)))
        b.ask_all("TC", ((sel, group, table) for group in groups for sel in range(-1, 10)))
    named = [(name, sel) for name in ("K4", "K5", "K9.wzk", "") for sel in (1, -1, 2)]
    b.set_all("TC", ((1.5 + sel, (sel, 3, name)) for name, sel in named))
    b.ask_all("TC", ((sel, 3, name) for name in (4, 5, "K4", "K5", "K9.wzk") for sel in (1, 2)))
    b.set_all("FXC", ((1.5, ("X", 58, name)) for name in ("V1", "V3", "A.npv", "V9")))
    b.ask_all("FXC", (("X", 58, name) for name in (1, 2, 3, "V1", "V3", "A.npv")))
    b.note("files", " ".join(sorted(each.name for each in b.folder.iterdir() if "store" not in each.name)))
    b.say("compensations: units")
    for unit in (-1, 0, 1, 2, 3):
        for group in groups:
            for sel in range(9):
                b.set("TC", 9.0, sel, group, table)
        b.set_all(
            "TC",
            ((2.0, (sel, group, table, unit)) for sel, group, table in ((1, 7, 4), (-2, 7, 5), (1, 345, 0))),
        )
        b.ask_all("TC", ((sel, 7, table, other) for sel, table in ((1, 4), (2, 5)) for other in (0, 2)))
    b.set_all("TC", ((2.0, (sel, 347, 0)) for sel in range(1, 9)), channel=2)
    for channel in (1, 2):
        b.ask_all(
            "TC",
            [*((sel, 347, 0) for sel in range(1, 9)), (1, 7, 4), (1, 7), *((sel,) for sel in range(10))],
            channel,
        )
    b.say("tool data: fields, sectors, places, tables")
    b.set_all(
        "TDA", ((field + 0 if field not in (8, 49) else f"T{field}", (9, 999, field)) for field in range(51))
    )
    b.ask_all("TDA", ((9, 999, field) for field in range(51)))
    b.ask_all(
        "TDA",
        [(s, p, 3) for s, p in ((0, 1), (1, 0), (1, 1), (1, 999), (1, 1000), (9, 998), (10, 1), (1.5, 1))],
    )
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
        asked = [
            (bit, group, index)
            for bit in (-1, 0, 1, size - 1, size)
            for index in (least - 1, least, most, most + 1)
        ]
        b.ask_all("IC", asked)
        b.ask_all("IC", [(bit, group) for bit in (0, 1, size - 1)], channel=2)
    b.ask_all("IC", [(0,), (1,), (111,), (112,), (0, 10), (0, -1), (0.5,), (0, 0, 0), (True,)])
    b.say("signals that programs set")
    b.set_all(
        "IC",
        ((True, (bit, *rest)) for bit in (79, 80, 95, 96) for rest in ((), (0,), (0, 0), (0, 2), (3,), (1,))),
    )
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
    b.set_all(
        "PLC",
        (
            (-1 if size == 4 else 200, (4, module, 0, size))
            for module in (97, 98, 99, 100)
            for size in (1, 2, 4)
        ),
    )
    values = (-(2**31), -(2**31) - 1, -1, 0, 255, 256, 65535, 65536, 2**31 - 1, 2**31, 1.5, True)
    for size in (1, 2, 4):
        b.set_all("PLC", ((value, (4, 98, 8, size)) for value in values))
        b.ask_all(
            "PLC", [(4, 98, 8, size), (4, 98, 512 - size, size), (4, 98, 513 - size, size), (4, 256, 0, size)]
        )
    b.set_all("PLC", ((1, (kind, OMITTED, 0, 1)) for kind in range(14)))
    b.say("parameters and drives")
    numbers = (100300001, 100300002, 100300004, 101500100, 102000001, 706000020, 701000020, 601000010)
    b.ask_all("MCA", ((each, index) for each in numbers for index in (-1, 0, 1, 2, 8, 11, 12)))
    b.ask_all("MCA", ((701000010, index, channel) for index in (0, 2, 5) for channel in (-1, 0, 1, 2, 3)))
    b.ask_all(
        "SCS",
        (("X", kind, n) for kind in ("S", "P", "Q", "s") for n in (30, 40, 47, 51, 140, 141, 189, 17, 1)),
    )
    b.ask_all("SCS", ((axis, "S", 51) for axis in (0, 1, 3, 5, 12, 13, "B", "X2", "W", "Q")))
    b.ask_all("SCSL", ((axis, "S", n, f"L{n}") for axis in (1, 12, 3) for n in (17, 187, 51)))
    b.note(
        "L17",
        (b.folder / "L17").read_text().replace("\n", " ") if (b.folder / "L17").exists() else "not there",
    )
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
    counts = [(-1, 0, count) for count in (0, 1, 2, 1.5)]
    for channel, category, count in [*cases, *((-1, each, 9) for each in (-1, 10, 11)), *counts]:
        errors = Field("I", (4, 3))
        found = b.call("GETERR", channel, category, errors, count)
        rows = " ".join("/".join(str(errors[row, column]) for column in (1, 2, 3)) for row in range(1, 5))
        b.note(f"GETERR({channel},{category},E%,{count}) {found}", rows)
    for tab in Tab:
        b.note(f"window of {tab.name}", " / ".join(" ".join(each) for each in b.pnc.information(tab)))
    b.pnc.control.emergency_stop(False)
    b.pnc.reset(channel=1)
    errors = Field("I", (1, 3))
    b.note("after a reset of channel 1", b.call("GETERR", -1, 0, errors, 1))
    b.pnc.reset()
    b.note("after a reset of both", b.call("GETERR", -1, 0, errors, 1))
