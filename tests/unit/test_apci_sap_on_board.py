"""Stand-alone programs on the simulated board itself: what a command in a program does to the axes."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest

from polycnc.controllers.apci import sap
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._move_commands import Speeds, mlr
from polycnc.controllers.apci.core import _turn_values
from support.sap_on_board import Sap

REFERENCED, LATCHED, RIGHT_SOFT_LIMIT = 1 << 17, 1 << 16, 1 << 6
JOG = "A1.jac := 100; A1.jvl := 50; A1.jtvl := 0; "
_LEFT, _RIGHT = 1, 2
# Bits of axst as table 12 numbers them: what is behind each, and with which value.
_OF_AXIS = {
    3: ("hard_limit", _LEFT),
    4: ("hard_limit", _RIGHT),
    5: ("soft_limit", _LEFT),
    6: ("soft_limit", _RIGHT),
    7: ("position_error", 1),
    8: ("dhef", 1),
    9: ("cef", 1),
    12: ("pe", 1),
    13: ("closed", 1),
    14: ("in_position", 1),
    16: ("lpsf", 1),
    17: ("referenced", 1),
    19: ("saf", 1),
}
_OF_INPUTS = {1: "EO", 15: "UI", 18: "REF"}  # and 2, DR, while its input is off
MEANT = 0x000FF3FE  # the bits of axst that have a meaning


def test_every_register_of_the_tables_exists_on_the_board() -> None:
    axis = Sap()
    for table, prefix in ((sap.AXIS_QUALIFIERS, "A2."), (sap.SYSTEM_VARIABLES, "")):
        for register in table.values():
            name = prefix + register.name + ("[1]" if register.indexed else "")
            # Writing back what was read changes nothing, whatever the register does.
            axis.run(f"C{register.kind}2 := {name};", scans=2)
            if register.writable:
                axis.run(f"{name} := {name};", scans=2)


def test_a_move_takes_trac_trvl_trtvl_and_wt_waits_for_its_end() -> None:
    axis = Sap()
    axis.run(
        "cl (A2, A3); TRAC := 1000; TRVL := 100; TRTVL := 0; mlr (A2 := 30, A3 := 40); wt (A2, A3);"
        "CD0 := A2.dp; CD1 := A3.dp; CI0 := 1;"
    )
    assert (axis.cd(0), axis.cd(1), axis.ci(0)) == (30.0, 40.0, 1)
    slow = Sap()
    slow.board_tasks.load(
        sap.compile_program("cl (A2); TRAC := 1000; TRVL := 100; mlr (A2 := 50); wt (A2); CI0 := 1;")
    )
    slow.tasks.startcnct(0)
    scans = 0
    while slow.ci(0) == 0:
        scans += slow.board.advance(1)
    # 50 mm at 100 mm/s with two ramps of 0.1 s: 0.6 s, and some scans until the command takes effect.
    assert scans * 0.00128 == pytest.approx(0.6, abs=6 * 0.00128)


@pytest.mark.covers("apci.rwmos")
def test_four_tasks_and_the_pc_command_axes_that_are_interpolated_scan_by_scan() -> None:
    axis = Sap()
    board = axis.board
    for number in range(4):
        text = f"WHILE CI10 = 0 DO CI{number} := CI{number} + 1;"
        axis.board_tasks.load(sap.compile_program(text, task=number))
        axis.tasks.startcnct(number)
    cl(board, (1, 2))
    mlr(board, (1, 2), (30.0, 40.0), Speeds(1000.0, 100.0))
    places = []
    while board.axes[1].is_busy:
        assert board.advance(1) == 1
        places.append((board.axes[1].dp, board.axes[2].dp))
    assert board.clock.cycle_s == 0.00128
    moving = [place for place in places if 0.0 < place[0] < 30.0]
    assert len(moving) > 400  # one new setpoint a scan, both axes in every one of them
    assert all(later[0] > earlier[0] for earlier, later in pairwise(moving))
    assert all(y == pytest.approx(x * 4.0 / 3.0) for x, y in moving)
    counts = [axis.ci(number) for number in range(4)]
    assert min(counts) == max(counts) > len(places)  # equal priority, all of them all the time
    board.state.ci[10] = 1  # the PC ends them
    board.advance(3)
    assert [axis.tasks.rdcncts(number).running for number in range(4)] == [0] * 4


@pytest.mark.covers("sap.JS")
def test_js_stops_with_the_stop_deceleration() -> None:
    axis = Sap()
    axis.run(
        "cl (A2); A2.jac := 100; A2.jvl := 50; A2.sdec := 200; jr (A2 := 1000); wt (1000); CD0 := A2.dp; CD2 := A2.dv;"
        "js (A2); wt (A2); CD1 := A2.dp; CD3 := A2.dv;"
    )
    assert axis.cd(2) == pytest.approx(50.0)
    latency = 3 * 0.00128 * 50.0
    assert 6.25 - 1e-9 <= axis.cd(1) - axis.cd(0) <= 6.25 + latency  # v²/2a
    assert axis.cd(3) == 0.0


@pytest.mark.covers("sap.SHP")
def test_shp_sets_the_home_position_and_arms_the_software_limits() -> None:
    free = Sap()
    free.run(f"cl (A1); {JOG} jr (A1 := 8); wt (A1); CD0 := A1.dp; CI0 := A1.axst;")
    assert free.cd(0) == 8.0
    assert not free.ci(0) & (REFERENCED | RIGHT_SOFT_LIMIT)
    armed = Sap()
    armed.run(
        f"cl (A1); shp (A1 := 2); CD0 := A1.rp; {JOG} jr (A1 := 50); wt (A1); CD1 := A1.dp; CI0 := A1.axst;"
    )
    assert armed.cd(0) == 2.0
    assert 5.0 < armed.cd(1) < 7.0  # caught after the limit at 5
    assert armed.ci(0) & REFERENCED
    assert armed.ci(0) & RIGHT_SOFT_LIMIT


@pytest.mark.covers("sap.RA")
def test_ra_resets_an_axis_its_override_and_its_software_limits() -> None:
    axis = Sap()
    axis.run(
        "cl (A1, A2); shp (A1 := 2); A1.jovr := 0.5; A2.jovr := 0.5; ra (A1); wt (10); CD0 := A1.jovr; CD1 := A2.jovr;"
    )
    assert (axis.cd(0), axis.cd(1)) == (1.0, 0.5)
    axis.run(f"cl (A1); {JOG} jr (A1 := 8); wt (A1); CD0 := A1.dp; CI0 := A1.axst;")
    assert axis.cd(0) == 8.0  # past the limit at 5
    assert not axis.ci(0) & (REFERENCED | RIGHT_SOFT_LIMIT)


@pytest.mark.covers("sap.RS")
def test_rs_resets_all_axes_and_halts_the_program() -> None:
    axis = Sap()
    axis.run("cl (A1, A2); shp (A1 := 2); A1.jovr := 0.5; A2.jovr := 0.5; CI5 := 7; rs; CI6 := 1;")
    assert [one.jovr for one in axis.board.axes] == [1.0, 1.0, 1.0]
    assert not axis.board.axes[0].status_word & REFERENCED
    assert (axis.ci(5), axis.ci(6)) == (7, 0)


@pytest.mark.covers("sap.UTROVR", "sap.TROVR")
def test_utrovr_takes_over_the_trajectory_override() -> None:
    axis = Sap()
    axis.run(
        "cl (A1, A2); TROVR := 0.5; CD0 := A1.jovr; utrovr (A1); wt (10); CD1 := A1.jovr; CD2 := A2.jovr;"
    )
    assert (axis.cd(0), axis.cd(1), axis.cd(2)) == (1.0, 0.5, 1.0)


@pytest.mark.covers("sap.SSMS")
def test_ssms_starts_spooled_moves_and_ends_a_wait_in_the_spooler() -> None:
    axis = Sap()
    axis.run(
        "cl (A2, A3); TRAC := 1000; TRVL := 100; smlr (A2 := 10, A3 := 5); ssf (A2, 1003, 100000); smlr (A2 := 10);"
        "wt (500); CD0 := A2.dp; ssms (A2, A3); wt (500); CD1 := A2.dp; ssms (A2); wt (500); CD2 := A2.dp;"
    )
    assert (axis.cd(0), axis.cd(1), axis.cd(2)) == (0.0, 10.0, 20.0)


@pytest.mark.covers("sap.axis.lp")
def test_reading_lp_takes_the_latched_position_and_clears_its_flag() -> None:
    axis = Sap()
    axis.run(
        "cl (A2); shp (A2 := 7); lps (A2, 10); wt (50); CI0 := A2.axst; lps (A2, 0); CD0 := A2.lp; CI1 := A2.axst;"
    )
    assert axis.ci(0) & LATCHED
    assert axis.cd(0) == 7.0
    assert not axis.ci(1) & LATCHED


def uncompiled(function: Any) -> Any:
    """Return a compiled function as Python, which need not be compiled by itself."""
    return getattr(function, "py_func", function)


@pytest.mark.covers("apci.io.EO", "apci.io.DR", "apci.io.UI", "apci.io.REF")
@pytest.mark.covers("apci.axst.0", "apci.axst.10", "apci.axst.11", "apci.axst.20-31")
@pytest.mark.covers("sap.axis.digi", *(f"apci.digi.{bit}" for bit in range(16, 20)))
def test_a_program_reads_the_status_and_signals_that_the_pc_reads() -> None:
    axis = Sap()
    own, state = axis.board.axes[1], axis.board.state
    register, kernel = uncompiled(_turn_values.register), axis.board.kernel

    def shown() -> int:
        assert int(register(state, kernel, _turn_values.STATUS, 1, 1.0, 0)) == own.status_word
        return own.status_word

    assert shown() == 1 << 12
    state.axis[1]["pe"] = 0
    for bit, (name, value) in _OF_AXIS.items():
        state.axis[1][name] = value
        assert shown() == 1 << bit, name
        state.axis[1][name] = 0
    state.board[0]["inputs"] = 0x6000
    for bit, name in _OF_INPUTS.items():
        for planned, active in ((0x4000, True), (0x4200, True), (0x1000, False), (0x1200, False)):
            state.plan[1][name] = planned
            assert shown() == active << bit, name
        state.plan[1][name] = 0
    for planned, active in ((0x4000, False), (0x6000, False), (0x5000, True), (0x1000, True)):
        state.plan[1]["DR"] = planned
        assert shown() == active << 2
    assert axis.board.axes[0].status_word == axis.board.axes[2].status_word == 1 << 12
    for signals in (0x10000, 0x20000, 0x40000, 0x80000, 0xF0000):
        state.axis[1]["signals"] = signals
        own.alarms = 0x500000  # which an APCI-8001 does not have
        digi = int(register(state, kernel, _turn_values.SIGNALS, 1, 1.0, float(own.alarms)))
        assert digi == own.digi == signals | state.board[0]["inputs"]
        assert state.axis[0]["signals"] == 0
    for name in state.axis.dtype.names or ():  # and nothing else shows in it
        if state.axis.dtype[name].kind == "i":
            state.axis[1][name] = 3
    assert shown() & ~MEANT == 0


def test_events_watch_the_board_in_every_scan() -> None:
    axis = Sap()
    axis.run(
        "EVENT past ON A2.dp >= 10; BEGIN js (A2); CD0 := A2.dp END;"
        "BEGIN cl (A2); A2.jac := 1000; A2.jvl := 100; jr (A2 := 50); wt (A2); CI0 := 1 END."
    )
    assert 10.0 <= axis.cd(0) <= 10.0 + 100.0 * 0.00128 + 1e-9
    assert axis.ci(0) == 1
