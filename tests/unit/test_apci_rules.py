"""Rules of the board that go across its functions, and what a program finds before it has set anything."""

from __future__ import annotations

import logging
import math
from itertools import pairwise
from pathlib import Path

import pytest

from polycnc.controllers.apci import (
    BootCode,
    Digi,
    ErrorReg,
    Ifs,
    InitCode,
    InstalledBoard,
    Status,
    Success,
    TransferCode,
    pcap,
    sap,
)
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._jog_commands import ja, jr
from polycnc.controllers.apci.board._move_commands import Speeds, mca, mcr, mlr
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.sap._board_host import BoardTasks
from support.apci_pc import Pc
from support.apci_rig import Rig

SYSTEM = """
sample_time_us = 1000
[[axis]]
name = "X"
jac = 321.0
[[axis]]
name = "C"
unit = "deg"
"""


@pytest.fixture(autouse=True)
def _nothing_attached() -> None:
    pcap.detach()


# ---------------------------------------------------------------------- the system file of a board


def test_a_default_board_takes_the_system_file_that_initialising_names(tmp_path: Path) -> None:
    (tmp_path / "system.dat").write_text(SYSTEM)
    board = Board()
    pcap.attach(board, folder=tmp_path)
    tsrp, rosi = pcap.tsrp_array(), pcap.ROSI()
    assert pcap.InitMcuSystem3(tsrp, rosi, 0, "system.dat") == (0, 4)
    assert (rosi.number_axis, rosi.sysfile_loaded, tsrp[0].jac) == (2, 1, 321.0)
    assert pcap.board() is board
    assert (board.clock.cycle_s, board.config.axis_names) == (0.001, ("X", "C"))
    pcap.cl(axes := pcap.AS.of(1))
    tsrp[1].tp = 7.5
    pcap.ja(axes, tsrp)
    while not pcap.rdaxstb(1, 13):
        pass
    pcap.rdrp(tsrp[1])
    assert tsrp[1].rp == 7.5
    assert pcap.gettskinfo(0)[0] == 0  # its tasks are there too
    (tmp_path / "system.dat").write_text("[[axis]]\njac = 5.0\n")  # it is loaded, once
    pcap.InitMcuSystem3(tsrp, rosi, 0, "system.dat")
    assert tsrp[0].jac == 321.0


def test_a_damaged_system_file_of_a_default_board_is_refused(tmp_path: Path) -> None:
    (tmp_path / "system.dat").write_text("jac = 5\n")
    pcap.attach(Board(), folder=tmp_path)
    code, _ = pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
    assert code == TransferCode.DAMAGED


def test_a_default_board_without_a_system_file_says_so(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    pcap.attach(Board(), folder=tmp_path)
    with caplog.at_level(logging.WARNING):
        assert pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "mine.dat")[0] == 0
    assert [each.message for each in caplog.records] == [
        "there is no system file 'mine.dat': the board keeps its default parameters"
    ]


def test_a_board_that_was_described_does_not_ask_for_a_file(tmp_path: Path) -> None:
    (tmp_path / "system.dat").write_text(SYSTEM)
    for described in (
        Board(parse_system_file("[[axis]]\njac = 77.0\n")),
        InstalledBoard(parse_system_file("[[axis]]\njac = 77.0\n")),
    ):
        pcap.attach(described, folder=tmp_path)
        tsrp = pcap.tsrp_array()
        assert pcap.InitMcuSystem3(tsrp, pcap.ROSI(), 0, "system.dat")[0] == 0
        assert tsrp[0].jac == 77.0


def test_axes_may_be_called_by_their_number_in_programs() -> None:
    board = Board(parse_system_file('[[axis]]\nname = "X"\n[[axis]]\nname = "A1"\n[[axis]]\nname = "Z"\n'))
    tasks = BoardTasks(board)
    tasks.load(sap.compile_program("BEGIN A3.jvl := 33; a1.jvl := 22; x.jvl := 11; A2.jac := 44 END."))
    tasks.startcnct(0)
    board.advance(5)
    assert tasks.each[0].error == ""
    # A1 is the name of the second axis here; A2, which nobody is called, is the second as well.
    assert [axis.jvl for axis in board.axes] == [11, 22, 33]
    assert board.axes[1].jac == 44
    tasks.load(sap.compile_program("BEGIN A4.jvl := 1 END."))
    tasks.startcnct(0)
    board.advance(2)
    assert "A4" in tasks.each[0].error


def test_a_board_has_a_serial_number_of_its_own() -> None:
    Pc()
    length, text = pcap.getEnvStr("SerialNumber")
    assert (length, text.isdigit()) == (8, True)
    Pc('[environment]\nSerialNumber = "4711"\n')
    assert pcap.getEnvStr("SerialNumber") == (4, "4711")


def test_registers_are_shown_by_the_names_of_their_bits() -> None:
    assert str(ErrorReg(0b1000_0000_0000_0101)) == "errAxDef | errUnit | ZeroProfile"
    assert f"{ErrorReg.errUnit}" == "errUnit"
    assert f"{ErrorReg(20):04x}" == "0014"
    assert str(ErrorReg(0)) == "0"
    assert str(ErrorReg(1 << 25 | 4)) == "errUnit | 0x2000000"


def test_the_codes_are_there_for_programs() -> None:
    assert (BootCode.CANNOT_OPEN, InitCode.NOT_BOOTED, TransferCode.DAMAGED) == (11, 32, 24)
    assert (Status.TIMEOUT, Success.DONE) == (-4, 1)


def test_a_program_that_polls_a_board_it_never_initialised_is_told_once(
    caplog: pytest.LogCaptureFixture,
) -> None:
    pcap.attach(Board(parse_system_file("")))
    with caplog.at_level(logging.WARNING):
        for _ in range(50):
            assert pcap.rdaxstb(0, 13) == 0
        pcap.rdrp(pcap.TSRP(an=0))
    assert [each.message for each in caplog.records] == [
        "calls do not reach a board and do nothing: the program has not called InitMcuSystem3"
    ]


# ---------------------------------------------------------------------- rules


ERRORS = (Ifs.pfe, Ifs.wdog, Ifs.iae, Ifs.scwdog, Ifs.scpfe, Ifs.BusError, Ifs.EpmBaseResetFlag)


@pytest.mark.covers(
    "apci.rifs", "apci.rddigib", "apci.wrdigob", "apci.rddigib.bitnr.3", "apci.rddigib.bitnr.4"
)
@pytest.mark.covers("apci.rule.ifs_error", "apci.ssf.1004")
@pytest.mark.parametrize("error", [*ERRORS, Ifs.EpmOpmfResetFlag])
def test_an_error_in_ifs_resets_inputs_and_outputs_until_the_next_boot(tmp_path: Path, error: Ifs) -> None:
    (tmp_path / "rwmos.elf").write_bytes(b"\x7fELF")
    system = "[inputs]\n4 = { inverted = true }\n"
    installed = InstalledBoard(parse_system_file(system))
    pcap.attach(installed, folder=tmp_path, clock=None)

    def initialise() -> None:
        pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
        installed.board.set_input(3, True)
        installed.board.set_input(4, True)
        pcap.wrdigob(0, 2, 1)
        installed.board.advance(2)

    def levels() -> tuple[int, ...]:
        inputs = (pcap.rddigib(0, 3), pcap.rddigib(0, 4))
        return (*inputs, installed.board.outputs)

    initialise()
    working = levels()
    assert working == (1, 0, 2)
    installed.interface.report(error)
    assert levels() == (0, 1, 0)
    pcap.wrdigob(0, 4, 1)
    installed.board.advance(3)
    assert levels() == (0, 1, 0)
    pcap.cl(axes := pcap.AS.of(0))
    pcap.ssf(0, 1004, 0x08)  # the inverted input is active for the board itself
    pcap.ssf(0, 9, 1.0)
    pcap.ssms(axes)
    installed.board.advance(3)
    assert installed.board.state.ci[9] == 1
    pcap.rifs(pcap.TSRP(an=0))
    installed.board.advance(3)
    assert levels() == (0, 1, 0)
    assert pcap.BootFile("rwmos.elf", 0) == 0
    initialise()
    assert levels() == working


@pytest.mark.covers("apci.ifs.0.edv", "apci.ifs.1.cncrdy")
def test_what_is_no_error_leaves_inputs_and_outputs_alone() -> None:
    board = Board()
    board.outputs = 9
    board.variables.interface.report(Ifs.edv | Ifs.cncrdy)
    board.advance(2)
    assert board.outputs == 9


@pytest.mark.covers("apci.profile.over_demand")
def test_more_than_the_drive_can_do_is_commanded_all_the_same_and_shows_as_position_error() -> None:
    plant = "[axis.plant]\nkind = 'lag'\nlag_s = 0.02\nvelocity_at_10_v = 60.0\n"
    worst = {}
    for jvl in (40.0, 90.0):  # the drive reaches 60
        rig = Rig(f"[[axis]]\nkfcv = 1.0\n{plant}")
        rig.set_jog(jac=2000.0, jdec=2000.0, jvl=jvl)
        jr(rig.board, (0,), (70.0,))
        rig.scans_until_end()
        assert rig.board.axes[0].dp == 70.0
        steps = rig.setpoints()
        assert max(abs(b - a) for a, b in pairwise(steps)) == pytest.approx(
            jvl * rig.board.clock.cycle_s, rel=1e-6
        )
        assert rig.board.errorreg == 0
        rows = rig.board.kernel.recorder
        worst[jvl] = abs(rig.board.axes[0].PosErr)
        assert rows.filled[0] > 0
    assert worst[90.0] > 10.0 > 2.0 > worst[40.0]


@pytest.mark.covers("apci.digi.24-31")
@pytest.mark.parametrize("board_type", ["APCI-8001", "APCI-8008"])
def test_the_highest_bits_of_digi_stay_0(board_type: str) -> None:
    board = Board(parse_system_file(f'board_type = "{board_type}"\n'))
    for number in range(1, 17):
        board.set_input(number, True)
    board.state.axis[1]["signals"] = 0xF0000
    board.advance(1)
    word = int(board.axes[1].digi)
    assert word & Digi.input16
    assert word >> 24 == 0
    if board_type == "APCI-8001":
        assert word & 0xFFFFFFFF & ~((1 << 20) - 1) & ~Digi.assigned() == 0


@pytest.mark.covers("apci.ErrorReg.12.VelocityZero", "apci.ErrorReg.13.AccelZero")
@pytest.mark.covers("apci.ErrorReg")
def test_one_error_register_of_the_board_tells_why_dhef_is_set() -> None:
    pc = Pc()
    pc.close(0, 1)
    assert (pcap.rdErrorReg(), pcap.rdaxstb(1, 9)) == (0, 0)
    mlr(pc.board, (0, 1), (3.0, 4.0), Speeds(100.0, 0.0))
    pc.board.advance(5)
    assert pcap.rdErrorReg() == ErrorReg.VelocityZero
    mlr(pc.board, (1,), (3.0,), Speeds(0.0, 20.0))
    pc.board.advance(5)
    assert pcap.rdErrorReg() == ErrorReg.VelocityZero | ErrorReg.AccelZero
    assert not hasattr(pcap, "wrErrorReg")


@pytest.mark.covers("apci.rule.planned_values")
@pytest.mark.parametrize(
    "name", ["jac", "jvl", "hac", "hvl", "sdec", "ipw", "mpe", "sll", "slr", "kp", "kd", "kfcv"]
)
def test_a_planned_value_holds_until_another_one_is_written(name: str) -> None:
    planned, written = 37.0, 53.0
    text = f"[[axis]]\n{name} = {planned}\n" + ("jtvl = 1.0\n" if name == "jvl" else "")
    pc = Pc(text)
    record = pcap.TSRP(an=0)
    read, write = getattr(pcap, f"rd{name}", None), getattr(pcap, f"wr{name}", None)
    if read is None:  # the filter is read and written as one
        read, write = pcap.rdf, pcap.uf
    read(record)
    assert getattr(record, name) == planned
    pc.close(0)
    pc.tsrp[0].tp = 1.0
    setattr(pc.tsrp[0], name, 99.0)  # a motion call does not transfer it
    pcap.ja(pcap.AS.of(0), pc.tsrp)
    pc.scans_until_rest()
    read(record)
    assert getattr(record, name) == planned
    setattr(record, name, written)
    assert write is not None
    write(record)
    record = pcap.TSRP(an=0)
    read(record)
    assert getattr(record, name) == written
    assert float(getattr(pc.board.axes[0], name)) == written


@pytest.mark.covers("apci.rule.setpoint_actual")
def test_setpoint_and_actual_value_agree_in_position_control() -> None:
    rig = Rig("[[axis]]\nkp = 40.0\nkfcv = 1.0\n[axis.plant]\nkind = 'lag'\nlag_s = 0.004\n")
    rig.set_jog(jac=300.0, jdec=300.0, jvl=35.0)
    jr(rig.board, (0,), (60.0,))
    worst = worst_velocity = 0.0
    for _ in range(400):
        rig.board.advance(1)
        axis = rig.board.axes[0]
        worst = max(worst, abs(axis.dp - axis.rp))
        worst_velocity = max(worst_velocity, abs(axis.dv - axis.rv))
    assert 1e-6 < worst < 0.1
    rig.scans_until_end()
    rig.board.advance(300)
    assert rig.board.axes[0].rp == pytest.approx(60.0, abs=1e-6)
    assert rig.board.axes[0].rv == pytest.approx(rig.board.axes[0].dv, abs=1e-4)
    assert worst_velocity < 3.0


@pytest.mark.covers("sap.task_roles")
def test_tasks_share_the_work_and_control_each_other() -> None:
    board = Board(
        parse_system_file(
            "[[axis]]\nhac = 400.0\nhvl = 20.0\n[axis.plant]\nreference = [4.0, 9.0]\n"
            '[inputs]\n7 = { functions = ["REF"], axes = ["A1"] }\n'
        )
    )
    tasks = BoardTasks(board)
    programs = (
        # reference travel, then hands over
        "BEGIN cl (A1); jhr (A1); wt (A1); shp (A1 := 0); CI3 := 5; startcnct (2); END.",
        # watches the drive
        "EVENT far ON A1.rp > 12.5; BEGIN js (A1); CI4 := CI4 + 1; stopcnct (2) END; BEGIN WHILE TRUE DO; END.",
        # the work
        "BEGIN A1.jac := 200; A1.jvl := 30; WHILE TRUE DO BEGIN ja (A1 := 20); wt (A1); CI5 := CI5 + 1 END END.",
        # plain logic with terminals and the registers that the PC reads
        "BEGIN WHILE TRUE DO IF A1.digi AND 2 <> 0 THEN BEGIN A1.digo := 8; CI6 := 77 END END.",
    )
    for number, text in enumerate(programs):
        tasks.load(sap.compile_program(text, task=number))
        if number != 2:
            tasks.startcnct(number)
    board.advance(4000)
    assert [tasks.each[number].error for number in range(4)] == [""] * 4
    ci = board.state.ci
    assert (ci[3], ci[4], ci[6]) == (5, 1, 0)
    assert 12.5 < board.axes[0].rp < 20.0
    assert tasks.rdcncts(2).running & 1 == 0
    board.set_input(2, True)
    board.advance(5)
    assert (ci[6], board.outputs) == (77, 8)


def test_a_position_is_commanded_to_the_axis_that_was_named() -> None:
    board = Board(parse_system_file(SYSTEM))
    cl(board, (0, 1))
    ja(board, (1,), (3.25,))
    board.advance(2000)
    assert [axis.rp for axis in board.axes] == [0.0, 3.25]


@pytest.mark.covers("apci.mca", "apci.mcr")
@pytest.mark.parametrize("absolute", [True, False])
def test_a_circle_goes_round_a_centre_that_lies_on_no_axis(absolute: bool) -> None:
    start, centre, phi = (2.5, -4.25, 1.125), (6.1, 3.7), -137.0
    rig = Rig()
    ja(rig.board, (0, 1, 2), start)
    rig.scans_until_end()
    rig.forget()
    command = mca if absolute else mcr
    given = centre if absolute else (centre[0] - start[0], centre[1] - start[1])
    command(rig.board, (0, 1), given, phi, Speeds(200.0, 30.0))
    rig.scans_until_end()
    x, y = rig.setpoints(0), rig.setpoints(1)
    radius = math.hypot(start[0] - centre[0], start[1] - centre[1])
    assert [math.hypot(a - centre[0], b - centre[1]) for a, b in zip(x, y, strict=True)] == pytest.approx(
        [radius] * len(x), rel=1e-9
    )
    angle = math.atan2(start[1] - centre[1], start[0] - centre[0]) + math.radians(phi)
    end = (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle), start[2])
    assert tuple(axis.rp for axis in rig.board.axes) == pytest.approx(end, abs=1e-9)


@pytest.mark.covers("apci.rdgf", "apci.wrgf")
def test_another_gear_factor_changes_the_counts_of_a_unit() -> None:
    pc = Pc("[[axis]]\nslsp = 4000.0\ngf = 0.25\n")
    assert pc.board.axes[0].counts_per_unit == 1000.0
    record = pcap.TSRP(an=0)
    record.gf = 0.375
    pcap.wrgf(record)
    assert pc.board.axes[0].counts_per_unit == 1500.0
    record = pcap.TSRP(an=0)
    pcap.rdgf(record)
    assert record.gf == 0.375
