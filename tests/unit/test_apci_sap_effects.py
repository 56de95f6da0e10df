"""What commands and variables of a stand-alone program do to the board: places, speeds, tables, filters, signals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from polycnc.controllers.apci import pcap, sap
from polycnc.controllers.apci.core._registers import Ifs
from support.sap_on_board import Sap

FAST = "TRAC := 100000; TRVL := 4000; TRTVL := 0; "
HOME = f"cl (A1, A2, A3); {FAST} mla (A1 := 17, A2 := -9, A3 := 4); wt (A1, A2, A3); "
FREE = {"sll": -500.0, "slr": 500.0}


def places(board: Sap) -> list[float]:
    return [axis.dp for axis in board.board.axes]


# ------------------------------------------------------------------ circles, helices, circles in space

CIRCLES = {  # statement, and where it ends from (17, -9, 4); the numbers are worked out in test_apci_circles
    "mla": ("(A1 := 21, A3 := -6)", (21.0, -9.0, -6.0)),
    "mlr": ("(A1 := 21, A3 := -6)", (38.0, -9.0, -2.0)),
    "mca": ("(A1 := 11, A2 := -1, 90)", (19.0, 5.0, 4.0)),
    "mcr": ("(A1 := -6, A2 := 8, -90)", (3.0, -7.0, 4.0)),
    "mha": ("(A1 := 11, A2 := -1, A3 := 17.5, phi := -90)", (3.0, -7.0, 17.5)),
    "mhr": ("(A1 := -6, A2 := 8, A3 := 13.5, phi := 90)", (19.0, 5.0, 17.5)),
    "mca3d": ("(A1 := 11, A2 := -12, A3 := 10, 1.5, 3, 3, 90)", (5.0, -6.0, 7.0)),
    "mcr3d": ("(A1 := -6, A2 := -3, A3 := 6, 1.5, 3, 3, -90)", (17.0, -18.0, 13.0)),
}


@pytest.mark.covers("sap.spoolnames", "sap.named_axis_args")
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.covers("sap.mlr") if n == "mlr" else ()) for n in CIRCLES]
)
def test_moves_of_a_program_reach_their_ends_at_once_and_queued(name: str) -> None:
    arguments, end = CIRCLES[name]
    axis = Sap()
    axis.run(f"{HOME} {name} {arguments}; wt (A1, A2, A3);")
    assert places(axis) == pytest.approx(end)
    queued = Sap()
    queued.run(
        f"{HOME} smlr (A1 := 2.5, A2 := -3.5); smla (A1 := 17, A2 := -9); s{name} {arguments}; CI7 := 5;"
    )
    assert queued.ci(7) == 5
    assert places(queued) == pytest.approx([17.0, -9.0, 4.0])  # nothing before ssms
    queued.run("ssms (A1, A2, A3); wt (A1, A2, A3);")
    assert places(queued) == pytest.approx(end)


def test_a_helix_of_a_program_may_end_at_a_point() -> None:
    axis = Sap()
    axis.run(f"{HOME} mha (A1 := 11, A2 := -1, A3 := 17.5, -1E-101, 23, 8); wt (A1, A2, A3);")
    assert places(axis) == pytest.approx([19.0, 5.0, 17.5])  # on the ray from the centre to (23, 8)


@pytest.mark.parametrize(("names", "third"), [("X Y Q", "A3"), ("X Y Q", "q"), ("A3 A1 A2", "A2")])
def test_an_axis_is_known_by_its_name_and_by_its_number(names: str, third: str) -> None:
    axis = Sap(names=names)
    axis.run(f"cl ({third}); {FAST} mla ({third} := 3.75); wt ({third}); CD0 := {third}.dp;")
    assert (axis.cd(0), places(axis)) == (3.75, [0.0, 0.0, 3.75])


# ------------------------------------------------------------------ what moves take from the variables of the system


@pytest.mark.covers(
    "sap.TRAC", "sap.TRVL", "sap.TRTVL", "sap.PU", "sap.TU", "apci.wrtrac", "apci.wrtrvl", "apci.wrtrtvl"
)
@pytest.mark.parametrize("who", ["program", "pc"])
def test_moves_have_the_acceleration_velocity_and_units_that_program_or_pc_set(who: str) -> None:
    axis = Sap()
    # In inches and minutes: 254 mm/s2 up to 50.8 mm/s, 101.6 mm, and 12.7 mm/s after the end.
    speeds = {"TRAC": 36000.0, "TRVL": 120.0, "TRTVL": 30.0}
    if who == "program":
        setting = "PU := 1; TU := 1; " + "".join(f"{name} := {value}; " for name, value in speeds.items())
    else:
        setting = ""
        pcap.attach(axis.board, clock=None)
        pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
        pcap.ctru(pcap.TRU(pu=1, tu=1))
        for name, value in speeds.items():
            assert getattr(pcap, f"wr{name.lower()}")(value) == 0
        pcap.detach()
    axis.board_tasks.load(
        sap.compile_program(f"cl (A2); {setting} mlr (A2 := 4); CI0 := 1; wt (A2); CI0 := 2;")
    )
    axis.tasks.startcnct(0)
    while axis.ci(0) < 1:
        axis.board.advance(1)
    axis.board.advance(2 + 100)  # 0.128 s
    assert axis.board.axes[1].dv == pytest.approx(254.0 * 0.128, rel=0.02)
    axis.board.advance(200)
    assert axis.board.axes[1].dv == pytest.approx(50.8)
    scans = 302 - 2
    while axis.ci(0) < 2:
        scans += axis.board.advance(1)
    # 0.2 s and 5.08 mm up, 0.15 s and 4.7625 mm down to 12.7 mm/s, the rest at 50.8 mm/s
    assert scans * 0.00128 == pytest.approx(0.35 + (101.6 - 9.8425) / 50.8, abs=5 * 0.00128)
    assert axis.board.axes[1].dv == pytest.approx(12.7)


@pytest.mark.covers("sap.axis.effradius", "sap.PU")
@pytest.mark.parametrize(("pu", "unit_mm"), [(0, 1.0), (1, 25.4), (2, 1000.0)])
def test_the_pipe_example_turns_by_path_over_radius_in_its_unit(pu: int, unit_mm: float) -> None:
    axis = Sap(units=("mm", "mm", "deg"))
    axis.run(
        f"cl (A1, A3); PU := {pu}; A3.effradius := {45.0 / unit_mm!r}; TRAC := {2e4 / unit_mm!r};"
        f"TRVL := {300.0 / unit_mm!r}; mlr (A1 := {16.0 / unit_mm!r}, A3 := {37.0 / unit_mm!r}); wt (A1, A3);"
    )
    assert places(axis) == pytest.approx([16.0, 0.0, math.degrees(37.0 / 45.0)])


@pytest.mark.covers("sap.TROVRST")
def test_the_settling_time_of_a_program_stretches_a_change_of_the_override() -> None:
    axis = Sap()
    axis.run(
        "cl (A2); TROVRST := 1.6; TROVR := 0.6; utrovr (A2); wt (320); CD0 := A2.jovr; wt (400); CD1 := A2.jovr;"
    )
    assert axis.cd(0) == pytest.approx(0.8, abs=2 * 0.00128)  # 0.32 s of the 0.64 s for 0.4
    assert axis.cd(1) == pytest.approx(0.6)


@pytest.mark.covers("apci.rdirqpc")
@pytest.mark.covers("sap.IRQPC", "sap.LEDGN", "sap.LEDRD", "sap.LEDYL")
def test_lights_and_the_interrupt_of_a_program_reach_the_pc() -> None:
    axis = Sap()
    pcap.attach(axis.board, clock=None)
    pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
    for number, light in ((1, "gn"), (2, "rd"), (-1, "yl")):
        axis.run(f"LED{light.upper()} := {number}; CI3 := LEDGN * 4 + LEDRD * 2 + LEDYL;", scans=3)
        assert [getattr(pcap, f"rdled{each}")() for each in ("gn", "rd", "yl")] == [
            int(each == light) for each in ("gn", "rd", "yl")
        ]
        assert axis.ci(3) == {"gn": 4, "rd": 2, "yl": 1}[light]
        axis.run(f"LED{light.upper()} := 0;", scans=3)
    assert pcap.rdirqpc() == 0
    axis.run("IRQPC := 1;", scans=3)
    assert pcap.rdirqpc() == 1
    axis.run("CI4 := IRQPC; IRQPC := 0;", scans=3)
    assert (axis.ci(4), pcap.rdirqpc()) == (1, 0)
    pcap.detach()


@pytest.mark.covers("apci.rdcd", "apci.rdci", "apci.wrcd", "apci.wrci")
@pytest.mark.covers("sap.CI", "sap.CD", "apci.const.cncount")
def test_common_variables_are_those_of_the_pc() -> None:
    axis = Sap()
    pcap.attach(axis.board, clock=None)
    pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
    integers, doubles = pcap.CIBUF(), pcap.CDBUF()
    integers.ci[713], doubles.cd[999] = -1_345_678_901, -654321.25
    pcap.wrci(713, integers)
    pcap.wrcd(999, doubles)
    axis.run("CI999 := CI713 - 2; CD641 := CD999 * 3;", scans=3)
    pcap.rdci(999, integers)
    pcap.rdcd(641, doubles)
    assert (integers.ci[999], doubles.cd[641]) == (-1_345_678_903, -1962963.75)
    pcap.detach()


@pytest.mark.covers(
    "apci.rdSysVarInt", "apci.rdSysVarDbl", "apci.wrSysVarInt", "apci.rdAxVarInt", "apci.wrAxVarDbl"
)
@pytest.mark.covers(
    "sap.SysVarInt", "sap.SysVarDbl", "sap.axis.varint", "sap.axis.vardbl", "sap.qualifier_access"
)
def test_application_variables_are_those_of_the_pc() -> None:
    axis = Sap()
    pcap.attach(axis.board, clock=None)
    pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
    pcap.wrSysVarInt(37, -712_345_678)
    pcap.wrAxVarDbl(1, 6, -41234.625)  # axis 1 (A2), variable 6
    axis.run(
        "CI0 := SysVarInt[37]; SysVarDbl[41] := A2.vardbl[5 + 1] * 3; A3.varint[8] := CI0 - 5;"
        "CD0 := A1.vardbl[6]; CD1 := A2.vardbl[7];",
        scans=3,
    )
    assert (axis.ci(0), pcap.rdSysVarDbl(41), pcap.rdAxVarInt(2, 8)) == (
        -712_345_678,
        -123703.875,
        -712_345_683,
    )
    assert (axis.cd(0), axis.cd(1), pcap.rdSysVarInt(36), pcap.rdAxVarInt(1, 8)) == (0.0, 0.0, 0, 0)
    pcap.detach()


@pytest.mark.covers("sap.axis.jerkrel", "sap.axis.dpoffset", "sap.axis.dvoffset", "sap.axis.slsp")
def test_qualifiers_of_a_program_act_on_their_axis() -> None:
    axis = Sap()
    axis.run(
        "A2.jerkrel := 3.5; CD0 := A2.jerkrel; A2.jerkrel := 0.35; CD1 := A2.jerkrel; CD2 := A3.jerkrel;",
        scans=3,
    )
    assert (axis.cd(0), axis.cd(1), axis.cd(2)) == (1.0, 0.35, 1.0)
    axis.run(
        "cl (A2); A2.dpoffset := 0.4; wt (5); CD0 := A2.dp; A2.dvoffset := 2.5; A2.dpoffset := 1.9; wt (320);"
    )
    assert axis.cd(0) == 0.4
    assert axis.board.axes[1].dp == 1.9  # after 0.6 s
    slow = Sap()
    slow.run("cl (A2); A2.dvoffset := 2.5; A2.dpoffset := 1.9; wt (320); CD0 := A2.dp;", scans=400)
    assert slow.cd(0) == pytest.approx(0.8, abs=0.01)
    slow.run("CD1 := A3.slsp; A3.slsp := 1250; CD2 := A3.slsp; A3.gf := 2;", scans=3)
    assert (slow.cd(2), slow.board.axes[2].counts_per_unit) == (1250.0, 2500.0)
    assert slow.cd(1) != 1250.0


# ------------------------------------------------------------------ tables of setpoints


@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        ("spd (A2, 4, p)", [3.0, 3.2, 3.7, 3.4]),
        ("spda (A2, 4, p, 20)", [3.0, 3.2, 3.7, 3.4]),
        ("spdr (A2, 4, p, 30)", [5.9, 9.1, 12.8, 16.2]),
        ("spda (A2, 3, p)", [3.0, 3.2, 3.7]),
    ],
)
def test_tables_of_a_program_give_one_setpoint_a_scan(statement: str, expected: list[float]) -> None:
    axis = Sap()
    axis.run(
        f"VAR p : ARRAY [1..5] OF DOUBLE; BEGIN cl (A2); {FAST} mla (A2 := 2.9); wt (A2);"
        f"p[1] := 3; p[2] := 3.2; p[3] := 3.7; p[4] := 3.4; p[5] := 3.1; {statement}; END."
    )
    axis.board_tasks.load(sap.compile_program("ssms (A2); CI5 := 1;"))
    axis.tasks.startcnct(0)
    seen, indices = [], []
    for _ in range(12):
        axis.board.advance(1)
        seen.append(axis.board.axes[1].dp)
        indices.append(int(axis.board.axes[1].row["pcap_index"]))
    begun = next(k for k, place in enumerate(seen) if place != pytest.approx(2.9))
    assert seen[begun : begun + len(expected)] == pytest.approx(expected)
    assert set(np.round(seen[begun + len(expected) :], 9)) == {round(expected[-1], 9)}
    if statement.endswith("0)"):
        first = int(statement[-3:-1])
        assert indices[begun : begun + 4] == [first, first + 1, first + 2, first + 3]


# ------------------------------------------------------------------ filter, signals, interface, buffers


@pytest.mark.covers("apci.TSRP.kp", "apci.TSRP.kfcv")
@pytest.mark.covers("apci.uf")
def test_a_filter_that_a_program_writes_acts_from_uf_on_and_for_its_axes_only() -> None:
    axis = Sap()
    plan = axis.board.axes[0].kp
    axis.run("A1.kp := 31; A2.kp := 32; A3.kp := 33; A2.kfcv := 0.4; uf (A2, A3); CD0 := A2.kp;", scans=3)
    servo = axis.board.kernel.servo.row
    assert [float(row["kp"]) for row in servo[:3]] == [plan, 32.0, 33.0]
    assert (float(servo[1]["kfcv"]), axis.cd(0)) == (0.4, 32.0)


def test_clearci99_lets_all_axes_go_on_in_the_same_scan() -> None:
    axis = Sap()
    axis.run(
        f"cl (A2, A3); {FAST} ssf (A2, 1015, 3); ssf (A3, 1015, 4); smlr (A2 := 6, A3 := 2); ssms (A2, A3);"
        "wt (100); CI0 := CI99; CD0 := A2.dp; ClearCI99; wt (A2, A3); CI1 := CI99;"
    )
    assert (axis.ci(0), axis.cd(0), axis.ci(1)) == (7, 0.0, 0)
    assert places(axis) == pytest.approx([0.0, 6.0, 2.0])


def test_rdigi_of_a_program_resets_the_latched_signals_of_its_axes() -> None:
    axis = Sap()
    axis.board.state.axis["signals"] = 0xE0000
    axis.run("CI0 := A2.digi; rdigi (A1, A2); CI1 := A2.digi; CI2 := A3.digi;", scans=3)
    assert (axis.ci(0), axis.ci(1), axis.ci(2)) == (0b1110 << 16, 0, 0b1110 << 16)
    assert list(axis.board.state.axis["signals"]) == [0, 0, 0xE0000]


@pytest.mark.covers("apci.ifs.17.wdog", "apci.ifs.18.iae")
@pytest.mark.covers("sap.axis.ifs", "sap.axis.digi")
def test_rifs_of_a_program_resets_the_errors_of_the_interface() -> None:
    axis = Sap()
    axis.board.variables.interface.report(Ifs.wdog | Ifs.iae)
    axis.run("CI0 := A1.ifs; rifs (A1); CI1 := A1.ifs;", scans=3)
    errors = int(Ifs.wdog | Ifs.iae)
    assert axis.ci(0) & errors == errors
    assert axis.ci(1) == axis.ci(0) - errors


@pytest.mark.covers("apci.rdcbcnct", "apci.wrcbcnct", "apci.CBCNCT")
@pytest.mark.covers("sap.RDCBx", "sap.WRCBx", "apci.const.cbsize")
def test_the_common_buffer_of_a_task_is_that_of_the_pc() -> None:
    axis = Sap()
    pcap.attach(axis.board, clock=None)
    pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
    sent = pcap.CBCNCT(
        task_number=0, size=11, buffer=bytearray(b"\x00\x01\x02\xfe\xff\xff\xff\x07\x08\x09\x0a")
    )
    assert pcap.wrcbcnct(sent) == 0
    axis.run(
        "CI0 := RDCBi(3); CI1 := RDCBb(9); WRCBd (16, 2.75); WRCBi (992, -3); WRCBb (997, 258);", scans=3
    )
    assert (axis.ci(0), axis.ci(1)) == (-2, 9)
    back = pcap.CBCNCT(task_number=0, size=1000, buffer=bytearray(1000))
    assert pcap.rdcbcnct(back) == 0
    assert bytes(back.buffer[16:24]) == b"\x00\x00\x00\x00\x00\x00\x06\x40"
    assert bytes(back.buffer[992:998]) == b"\xfd\xff\xff\xff\x00\x02"
    pcap.detach()


# ------------------------------------------------------------------ what else a program writes, reads and commands


@pytest.mark.covers("apci.TSRP.digo")
def test_positions_motor_command_and_outputs_of_a_program_go_to_their_axis() -> None:
    axis = Sap()
    axis.run(
        "A2.rp := 12.5; A3.mcp := -1234; CI0 := A3.mcp; CI1 := A2.mcp; A1.digo := 37; CI2 := A3.digo;",
        scans=3,
    )
    assert [one.rp for one in axis.board.axes[:2]] == [0.0, 12.5]
    assert (axis.ci(0), axis.ci(1), axis.ci(2), axis.board.outputs) == (-1234, 0, 37, 37)
    axis.run("ol (A3); cl (A2); A2.dp := 13.25; A2.rp := 99; wt (3); CD0 := A2.rp; CD1 := A1.dp;")
    assert (axis.cd(0), axis.cd(1)) == (13.25, 0.0)  # rp cannot be written in position control


def test_zero_offsets_of_a_program_count_from_each_other_and_go_away() -> None:
    axis = Sap()
    axis.run(
        f"cl (A1, A2, A3); {FAST} szpa (A2, 2.5); mla (A2 := 10); wt (A2); CD0 := A2.ZeroOffset; CD1 := A2.dp;"
        "szpr (A2, 1.25); CD2 := A2.ZeroOffset; CD3 := A2.dp; CD4 := A3.ZeroOffset; azo (9); CD5 := A2.dp;"
    )
    assert [axis.cd(k) for k in range(6)] == [2.5, 10.0, 3.75, 8.75, 0.0, 12.5]


@pytest.mark.covers("apci.var.PcapIndex")
def test_a_program_reads_error_queue_and_index_of_its_axis() -> None:
    axis = Sap()
    axis.run(
        f"VAR p : ARRAY [1..2] OF DOUBLE; BEGIN cl (A2, A3); {FAST} CI0 := A2.lsm; smlr (A2 := 5); smlr (A2 := 6);"
        "CI1 := A2.MCiS; CI2 := A3.MCiS; CI3 := CI0 - A2.lsm; CI4 := CI0 - A3.lsm; CI5 := A2.PcapIndex;"
        "p[1] := 11.5; p[2] := 12; spda (A2, 2, p, 41); ssms (A2); wt (A2);"
        "CI6 := A2.PcapIndex; CI7 := A3.PcapIndex END."
    )
    assert [axis.ci(k) for k in (1, 2, 4, 5, 6, 7)] == [2, 0, 0, -1, 42, -1]
    assert axis.ci(3) == 2 * 145
    late = Sap(plant={"kind": "lag"}, kp=20.0)
    late.run(
        "cl (A2, A3); A2.jac := 1000; A2.jvl := 50; jr (A2 := 90); wt (1000); CD0 := A2.PosErr; CD1 := A3.PosErr;"
    )
    assert late.cd(0) == pytest.approx(2.5, rel=1e-3)  # v / kp
    assert late.cd(1) == 0.0


def test_queues_of_a_program_pause_are_dropped_and_change_their_last_velocity() -> None:
    axis = Sap()
    queue = "cl (A2); TRAC := 1000; TRVL := 50; TRTVL := 0; smlr (A2 := 10); smlr (A2 := 7); smlr (A2 := 6); ssms (A2);"
    axis.run(
        f"{queue} wt (50); sstps (A2); wt (A2); CD0 := A2.dp; CI0 := A2.MCiS; sdels (A2); CI1 := A2.MCiS;"
    )
    assert (axis.cd(0), axis.ci(0), axis.ci(1)) == (10.0, 2, 0)
    axis.run(f"{queue} sstvl (A2, 12.5); wt (A2); CD1 := A2.dv; ms (A2); wt (A2); CD2 := A2.dv;")
    assert axis.cd(1) == pytest.approx(12.5)
    assert axis.cd(2) == 0.0


def test_loops_of_a_program_open_and_close_without_a_jump() -> None:
    axis = Sap()
    axis.run(
        "A2.mcp := 8192; wt (100); clv (A2); wt (50); CD0 := A2.dv; CD1 := A1.dv; js (A2); wt (A2); CD2 := A2.dv;"
    )
    assert axis.cd(0) == pytest.approx(200.0 * 8192 / 32767, rel=1e-3)  # goes on as it was driven
    assert (axis.cd(1), axis.cd(2)) == (0.0, 0.0)
    late = Sap(plant={"kind": "lag"})
    late.run("cl (A2); A2.dp := 3; wt (2); CD3 := A2.dp; RPtoDP (A2); wt (2); CD4 := A2.dp;", scans=20)
    assert late.cd(3) == 3.0
    assert 0.0 < late.cd(4) < 0.3  # to where the axis had come until then


@pytest.mark.parametrize(("name", "way"), [("jhl", -1), ("jhr", 1)])
def test_the_search_of_a_program_runs_its_way(name: str, way: int) -> None:
    axis = Sap()
    axis.run(f"cl (A2); A2.hac := 400; A2.hvl := 23; {name} (A2); wt (200); CD0 := A2.dv; CD1 := A3.dv;")
    assert axis.cd(0) == pytest.approx(23.0 * way)
    assert axis.cd(1) == 0.0


# ------------------------------------------------------------------ numbers that no board can be given

WITHOUT_END = {
    "a target velocity": "TRTVL := 1e308; mlr (A1 := 2.5, A2 := 1.5)",
    "a speed": "TRVL := 1e200 * 1e200; smlr (A1 := 2.5, A2 := 1.5); ssms (A1, A2)",
    "a distance": "mlr (A1 := 1e300, A2 := 1.5)",
    "a jog": "ja (A1 := 0.0 - 1e101)",
    "a spooled velocity": "smlr (A1 := 0.0, A2 := 0.0); sstvl (A1, A2, 0.0 - 1e308); ssms (A1, A2)",
    "a setpoint": "A1.dp := 1e308; A1.rp := 1e308; A1.jac := 1e200; A1.jovr := 1e150",
    "a point of a table": "d[2] := 1e308; spdr (A1, 3, d); ssms (A1)",
}


@pytest.mark.parametrize("what", WITHOUT_END)
def test_a_program_cannot_send_an_axis_where_numbers_end(what: str) -> None:
    axis = Sap()
    axis.run(f"VAR d: ARRAY [1..3] OF DOUBLE; BEGIN {HOME} {WITHOUT_END[what]} END.")
    axis.board.advance(500)
    assert places(axis) == pytest.approx([17.0, -9.0, 4.0])
    axis.run(f"{FAST} mlr (A1 := 2.5, A3 := -1.5); wt (A1, A3);")
    assert places(axis) == pytest.approx([19.5, -9.0, 2.5])
