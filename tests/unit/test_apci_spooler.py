"""The spoolers: order, start and pause, what empties them, how they end, how they stay in step, tables of setpoints."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from polycnc.controllers.apci.board._axis_commands import cl, ol, ra, utrovr
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._jog_commands import ja, jr, js, ms
from polycnc.controllers.apci.board._move_commands import Speeds, mla, mlr
from polycnc.controllers.apci.board._spool_commands import (
    sdels,
    spd,
    ssf,
    ssms,
    sstps,
    sstvl,
)
from support.apci_bits import Axst, ErrorReg, ModeReg
from support.apci_rig import LATENCY, SCAN_S, Rig, scans_for

SLOW = Speeds(100.0, 50.0)
GOES_ON = Speeds(100.0, 50.0, 50.0)


def three_lines(rig: Rig) -> None:
    """Queue 40 mm in three pieces that pass into each other, for axes 0 and 1."""
    mlr(rig.board, (0, 1), (10.0, 0.0), GOES_ON, spool=True)
    mlr(rig.board, (0, 1), (5.0, 0.0), GOES_ON, spool=True)
    mla(rig.board, (0, 1), (40.0, 0.0), SLOW, spool=True)


@pytest.mark.covers("apci.mode.spool", "apci.const.cmdlatency")
def test_queue_is_run_back_to_back_and_ends_in_direct_mode() -> None:
    rig = Rig()
    three_lines(rig)
    assert rig.bits() & Axst.pe
    rig.board.advance(50)
    assert rig.board.axes[0].dp == 0.0  # queued is not started
    rig.forget()
    ssms(rig.board, (0, 1))
    assert rig.scans_until_end() == scans_for(40.0 / 50.0 + 0.5)  # the time of one profile of 40 mm
    assert rig.board.axes[0].rp == 40.0
    velocity = np.diff(rig.setpoints()) / SCAN_S
    assert np.abs(np.diff(velocity)).max() <= 100.0 * SCAN_S * 1.0001
    # In direct mode again: what is queued now waits for a start.
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    rig.board.advance(50)
    assert rig.board.axes[0].rp == 40.0
    # A direct command begins after its latency, and makes the entry void.
    ja(rig.board, (0,), (41.0,))
    rig.board.advance(LATENCY)
    assert rig.board.axes[0].dp == 40.0
    rig.board.advance(1)
    assert rig.board.axes[0].dp > 40.0
    assert rig.board.axes[0].MCiS == 0


@pytest.mark.covers("apci.mode.spool", "apci.const.spoolmem", "apci.ErrorReg.4.errSpoolerOverrun")
def test_memory_shrinks_with_entries_and_grows_with_execution() -> None:
    rig = Rig()
    empty = rig.board.axes[0].lsm
    assert empty == 145_000
    free = rig.free_entries()
    three_lines(rig)
    assert rig.board.axes[0].lsm == rig.board.axes[1].lsm < empty
    assert rig.board.axes[2].lsm == empty
    assert rig.board.axes[0].MCiS == 3
    ssms(rig.board, (0, 1))
    rig.board.advance(scans_for(0.5))
    assert rig.board.axes[0].MCiS == 2
    mlr(rig.board, (0, 1), (1.0, 0.0), SLOW, spool=True)  # while it runs
    rig.scans_until_end()
    assert rig.board.axes[0].rp == 41.0
    assert rig.board.axes[0].lsm == empty
    assert rig.free_entries() == free
    for _ in range(1000):
        mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    assert rig.board.errorreg == 0
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    assert rig.board.errorreg == ErrorReg.errSpoolerOverrun
    assert rig.board.axes[0].MCiS == 1000


@pytest.mark.covers("apci.mode.spool.conditions", "apci.ssms")
def test_start_needs_closed_loops_and_rest() -> None:
    rig = Rig(closed=False)
    mlr(rig.board, (0,), (10.0,), SLOW, spool=True)
    assert rig.board.axes[0].MCiS == 0
    cl(rig.board, rig.all)
    rig.set_jog(jtvl=5.0)
    jr(rig.board, (0,), (1.0,))
    rig.scans_until_end()
    mlr(rig.board, (0,), (10.0,), SLOW, spool=True)
    mlr(rig.board, (1,), (10.0,), SLOW, spool=True)
    ssms(rig.board, (0, 1))  # axis 0 goes on with 5 mm/s: nothing starts
    rig.board.advance(10)
    assert rig.board.axes[1].dp == 0.0
    js(rig.board, (0,))
    rig.scans_until_end()
    mlr(rig.board, (0,), (10.0,), SLOW, spool=True)
    ssms(rig.board, (0, 1))
    rig.scans_until_end()
    assert rig.board.axes[1].dp == 10.0


@pytest.mark.covers("apci.ErrorReg.5.ProfileTooSmall", "apci.mode.spool.conditions")
def test_two_profiles_in_a_row_shorter_than_a_scan() -> None:
    rig = Rig()
    short = Speeds(1000.0, 10.0, 10.0)
    mlr(rig.board, (0, 1), (1.0, 0.0), short, spool=True)
    mlr(rig.board, (0, 1), (0.001, 0.0), short, spool=True)
    mlr(rig.board, (0, 1), (1.0, 0.0), Speeds(1000.0, 10.0), spool=True)
    ssms(rig.board, (0, 1))
    rig.scans_until_end()
    assert rig.board.errorreg == 0
    for _ in range(5):
        mlr(rig.board, (0, 1), (0.001, 0.0), short, spool=True)
    mlr(rig.board, (0, 1), (1.0, 0.0), Speeds(1000.0, 10.0), spool=True)
    ssms(rig.board, (0, 1))
    rig.scans_until_end()
    assert rig.board.errorreg == ErrorReg.ProfileTooSmall
    assert not rig.bits() & Axst.saf  # both axes took them in the same scans
    assert rig.board.axes[0].rp == pytest.approx(3.006, abs=1e-12)


def _trip(board: Board, axes: tuple[int, ...]) -> None:
    board.set_input(1, True)


EMPTIES: list[tuple[str, Callable[[Board, tuple[int, ...]], object]]] = [
    ("direct jog", lambda board, axes: jr(board, axes, (0.0, 0.0))),
    ("direct move", lambda board, axes: mlr(board, axes, (1.0, 0.0), SLOW)),
    ("cl", cl),
    ("ra", ra),
    ("rs", lambda board, _: board.reset()),
    ("js", js),
    ("ms", ms),
    ("sdels", sdels),
    ("ol", ol),
    ("limit", _trip),
]
SYSTEM = """
number_of_axes = 3
[inputs]
1 = { functions = ["LSR_SMD"] }
"""


@pytest.mark.covers("apci.rule.spooler_discard", "apci.mode.direct", "apci.sdels")
@pytest.mark.parametrize(("name", "command"), EMPTIES)
def test_what_empties_the_spooler(name: str, command: Callable[[Board, tuple[int, ...]], object]) -> None:
    rig = Rig(SYSTEM)
    free = rig.free_entries()
    for running in (False, True):
        cl(rig.board, rig.all)
        three_lines(rig)
        if running:
            ssms(rig.board, (0, 1))
            rig.board.advance(100)
            assert rig.board.axes[0].dv > 10.0
        elif name == "limit":
            continue
        command(rig.board, (0, 1))
        rig.board.advance(LATENCY + 1)
        runs_on = running and name in ("sdels", "ms")  # to the end of what it does, or on its path to rest
        assert rig.board.axes[0].MCiS == runs_on
        rig.board.set_input(1, False)
        rig.scans_until_end()
        assert rig.board.axes[0].MCiS == 0
        assert rig.free_entries() == free
        assert rig.bits() & Axst.pe
        if name == "sdels" and running:
            assert rig.board.axes[0].dv == pytest.approx(
                math.sqrt(2.0 * 100.0 * 10.0)
            )  # what ran was finished
    assert rig.board.errorreg == 0


@pytest.mark.covers("apci.sstps", "apci.rule.spooler_discard")
def test_pause_finishes_what_runs_and_keeps_the_rest() -> None:
    rig = Rig()
    mlr(rig.board, (0,), (10.0,), SLOW, spool=True)
    mlr(rig.board, (0,), (10.0,), SLOW, spool=True)
    ssms(rig.board, (0,))
    rig.board.advance(20)
    sstps(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.axes[0].rp == 10.0
    assert rig.board.axes[0].MCiS == 1
    rig.board.advance(100)
    assert rig.board.axes[0].rp == 10.0
    ssms(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.axes[0].rp == 20.0


def test_pause_in_a_wait_lets_the_wait_end() -> None:
    rig = Rig()
    ssf(rig.board, 0, 1003, 20 * 100)
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    ssms(rig.board, (0,))
    rig.board.advance(10)
    sstps(rig.board, (0,))
    rig.board.advance(80)
    assert not rig.bits() & Axst.pe
    rig.board.advance(20)
    assert rig.bits() & Axst.pe
    assert rig.board.axes[0].MCiS == 1
    ssms(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.axes[0].rp == 1.0


@pytest.mark.parametrize("command", [js, ms, sdels, cl])
def test_a_stop_in_a_wait_ends_it(command: Callable[[Board, tuple[int, ...]], None]) -> None:
    rig = Rig()
    free = rig.free_entries()
    ssf(rig.board, 0, 1003, 20 * 50)
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    ssms(rig.board, (0,))
    rig.board.advance(10)
    command(rig.board, (0,))
    rig.board.advance(60 if command is sdels else 1)
    assert rig.bits() & Axst.pe
    assert rig.free_entries() == free
    assert rig.board.axes[0].rp == 0.0


@pytest.mark.covers("apci.MODEREG.ForbidTargetVel", "apci.ErrorReg.1.errTargetVel")
def test_queue_that_ends_with_velocity() -> None:
    rig = Rig()
    mlr(rig.board, (0,), (40.0,), GOES_ON, spool=True)
    ssms(rig.board, (0,))
    rig.scans_until_end()
    before = rig.board.axes[0].dp
    rig.board.advance(10)
    assert rig.board.axes[0].dp - before == pytest.approx(50.0 * 10 * SCAN_S)
    assert rig.board.errorreg == 0
    js(rig.board, (0,))
    rig.scans_until_end()
    rig.board.modereg = ModeReg.ForbidTargetVel
    mlr(rig.board, (0,), (40.0,), GOES_ON, spool=True)
    ssms(rig.board, (0,))
    rig.board.advance(2000)
    assert rig.board.errorreg == ErrorReg.errTargetVel
    assert not rig.bits() & Axst.cl  # the system was reset


@pytest.mark.covers("apci.mode.spool.sync", "apci.axst.19.saf", "apci.rule.saf_clear")
@pytest.mark.parametrize(
    "clear", [js, ra, cl, lambda b, a: ja(b, a, (0.0, 0.0)), lambda b, a: mla(b, a, (50.0, 0.0), SLOW)]
)
def test_axes_out_of_step_are_noticed(clear: Callable[[Board, tuple[int, ...]], None]) -> None:
    rig = Rig()
    three_lines(rig)
    ssms(rig.board, (0,))  # axis 1 is left behind
    rig.board.advance(2)
    assert [bool(rig.bits(i) & Axst.saf) for i in rig.all] == [True, True, False]
    assert rig.board.errorreg == 0
    rig.scans_until_end()
    assert rig.board.axes[0].rp == 40.0
    clear(rig.board, (0, 1))
    rig.board.advance(1)
    assert bool(rig.bits() & Axst.saf) is (clear is js)


@pytest.mark.covers("apci.MODEREG.28.JSatSAF", "apci.ErrorReg.19.JSatSAFdone", "apci.mode.spool.sync")
def test_axes_out_of_step_are_stopped_if_wanted() -> None:
    rig = Rig()
    rig.board.modereg = ModeReg.JSatSAF
    rig.board.axes[2].sdec = 100.0
    jr(rig.board, (2,), (1000.0,))
    rig.board.advance(300)
    velocity = rig.board.axes[2].dv
    mlr(rig.board, (0, 1), (10.0, 0.0), GOES_ON, spool=True)
    mlr(rig.board, (0, 1), (0.0, 10.0), SLOW, spool=True)
    ssms(rig.board, (0, 1))
    rig.board.advance(20)
    assert rig.board.errorreg == 0
    rig.board.trovr = 0.5
    utrovr(rig.board, (0,))  # of one axis only: it comes late
    rig.board.advance(2000)
    assert rig.board.errorreg == ErrorReg.JSatSAFdone
    assert rig.bits() & Axst.saf
    assert all(rig.bits(i) & Axst.pe for i in rig.all)
    assert velocity == 100.0
    assert rig.board.axes[2].dv == 0.0


@pytest.mark.covers("apci.ErrorReg.11.SpoolerLoadError")
def test_a_command_reaches_the_spooler_while_a_limit_brakes_the_axis() -> None:
    rig = Rig(SYSTEM)
    rig.board.axes[0].sdec = 100.0
    jr(rig.board, (0,), (1000.0,))
    rig.board.advance(100)
    rig.board.set_input(1, True)
    rig.board.advance(1)
    free = rig.free_entries()
    mlr(rig.board, (0, 1), (1.0, 1.0), SLOW, spool=True)
    assert rig.board.errorreg == ErrorReg.SpoolerLoadError
    assert rig.board.axes[1].MCiS == 0
    assert rig.free_entries() == free


@pytest.mark.covers("apci.spd", "apci.spda", "apci.spdr", "apci.var.PcapIndex", "apci.rdPcapIndex")
def test_tables_give_one_setpoint_a_scan() -> None:
    rig = Rig()
    free = rig.board.axes[0].lsm
    points = [0.01, 0.03, 0.06, 0.08, 0.09]
    spd(rig.board, 0, points, index=100)
    spd(rig.board, 1, [0.01, 0.02, 0.03, 0.02, 0.01], relative=True)
    assert rig.board.axes[0].lsm < free
    ssms(rig.board, (0, 1))
    found = []
    for _ in points:
        rig.board.advance(1)
        row = rig.board.state.axis[0]
        found.append((rig.board.axes[0].dp, int(row["pcap_index"])))
        assert not rig.bits() & Axst.pe
    assert found == [(value, 100 + k) for k, value in enumerate(points)]
    rig.board.advance(1)
    assert rig.bits() & Axst.pe
    assert rig.board.axes[0].dp == 0.09
    assert rig.setpoints(1)[-6:] == pytest.approx([0.01, 0.03, 0.06, 0.08, 0.09, 0.09])
    assert rig.board.axes[0].lsm == free
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    spd(rig.board, 0, [1.1, 1.2], index=7)
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True, index=42)
    ssms(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.axes[0].rp == pytest.approx(2.2)
    assert rig.board.state.axis[0]["pcap_index"] == 42


@pytest.mark.covers("apci.spd", "apci.spdr")
def test_a_relative_line_counts_from_the_end_of_the_last_table() -> None:
    rig = Rig()
    spd(rig.board, 1, [0.02, 0.05], index=3)
    spd(rig.board, 2, [0.03, 0.07, 0.09])
    spd(rig.board, 2, [0.04, -0.01], relative=True)
    mlr(rig.board, (1, 2), (0.7, -1.3), SLOW, spool=True)
    ssms(rig.board, (1, 2))
    rig.scans_until_end()
    assert rig.board.axes[1].rp == pytest.approx(0.75)
    assert rig.board.axes[2].rp == pytest.approx(-1.18)


@pytest.mark.covers("apci.ErrorReg.4.errSpoolerOverrun")
@pytest.mark.covers("apci.spd", "apci.const.spdsize")
def test_table_sizes_and_memory() -> None:
    rig = Rig(keep=50_000)
    for size in (0, 1001):
        spd(rig.board, 0, [0.0] * size)
    assert rig.board.axes[0].MCiS == 0
    full = [k * 1e-6 for k in range(1000)]
    for count in range(30):
        spd(rig.board, 0, [count * 1e-3 + value for value in full])
    queued = rig.board.axes[0].MCiS
    assert queued == 145_000 // (145 + 8000)
    assert rig.board.errorreg == ErrorReg.errSpoolerOverrun
    rig.forget()
    ssms(rig.board, (0,))
    for count in range(queued, 40):  # more than the memory holds, while it is emptied
        rig.board.advance(1001)
        spd(rig.board, 0, [count * 1e-3 + value for value in full])
    rig.scans_until_end()
    found = rig.setpoints()
    assert rig.board.axes[0].dp == pytest.approx(0.039999)
    assert np.diff(found[:40_000]) == pytest.approx(1e-6, abs=1e-12)


@pytest.mark.covers("apci.sstvl", "apci.spd", "apci.rule.lookahead", "apci.ssf.2001")
@pytest.mark.parametrize("look_ahead", [False, True])
def test_a_path_passes_into_a_table(look_ahead: bool) -> None:
    rig = Rig()
    rig.board.modereg = ModeReg.lookahead if look_ahead else 0
    table = [40.0 + 50.0 * SCAN_S * k for k in range(1, 101)]
    for aimed in (False, True):
        cl(rig.board, rig.all)
        rig.board.kernel.base[0] = 0.0
        mla(rig.board, (0,), (40.0,), GOES_ON, spool=True)
        if aimed:
            sstvl(rig.board, (0,), 50.0)
        spd(rig.board, 0, table)
        rig.forget()
        ssms(rig.board, (0,))
        rig.scans_until_end()
        velocity = np.diff(rig.setpoints()) / SCAN_S
        assert rig.board.axes[0].dp == table[-1]
        corner = int(np.flatnonzero(rig.setpoints() >= 40.0)[0])
        stops = look_ahead and not aimed
        assert bool(velocity[corner - 3] < 1.0) is stops
        if not stops:
            assert velocity[corner - 3 : corner - 1] == pytest.approx(50.0)
            assert velocity[corner : corner + 90] == pytest.approx(50.0)
    # ssf 2001 takes the target velocity away again.
    cl(rig.board, rig.all)
    mlr(rig.board, (0,), (40.0,), GOES_ON, spool=True)
    sstvl(rig.board, (0,), 30.0)
    ssf(rig.board, 0, 2001, 0.0)
    ssms(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.axes[0].dv == 0.0


@pytest.mark.covers("apci.sstvl")
def test_target_velocity_can_be_given_while_the_move_runs() -> None:
    rig = Rig()
    mlr(rig.board, (0, 1), (30.0, 40.0), SLOW, spool=True)
    ssms(rig.board, (0, 1))
    rig.board.advance(500)
    sstvl(rig.board, (0, 1), 20.0)
    rig.scans_until_end()
    assert [rig.board.axes[i].dv for i in (0, 1)] == pytest.approx([12.0, 16.0])
    js(rig.board, (0, 1))
    rig.scans_until_end()
    mlr(rig.board, (0, 1), (30.0, 40.0), SLOW, spool=True)
    sstvl(rig.board, (0, 1), 500.0)  # more than the move's velocity
    ssms(rig.board, (0, 1))
    rig.scans_until_end()
    assert [rig.board.axes[i].dv for i in (0, 1)] == pytest.approx([30.0, 40.0])


@pytest.mark.covers("apci.smlai", "apci.smlri", "apci.ssfi", "apci.rdPcapIndex")
@pytest.mark.parametrize("indices", [[11, 12, 13], [7, 0, 0x7FFFFFFF], [0, 5, 0]])
def test_lines_and_special_functions_have_an_index(indices: list[int]) -> None:
    rig = Rig()
    mla(rig.board, (0,), (1.0,), SLOW, spool=True, index=indices[0])
    ssf(rig.board, 0, 1003, 20 * 10, index=indices[1])
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True, index=indices[2])
    ssms(rig.board, (0,))
    row = rig.board.state.axis[0]
    seen: list[int] = []
    while not row["pe"]:
        rig.board.advance(1)
        if not seen or seen[-1] != row["pcap_index"]:
            seen.append(int(row["pcap_index"]))
    assert seen == indices


@pytest.mark.covers("apci.mode.direct")
def test_a_stop_takes_a_command_back_that_is_on_its_way() -> None:
    rig = Rig()
    ja(rig.board, (0, 1), (5.0, 5.0))
    js(rig.board, (0,))
    rig.board.advance(1)
    assert rig.bits() & Axst.pe
    assert not rig.bits(1) & Axst.pe
    rig.scans_until_end()
    assert [axis.rp for axis in rig.board.axes] == [0.0, 5.0, 0.0]
    mla(rig.board, (0, 1), (7.0, 7.0), SLOW)
    ol(rig.board, (1,))
    cl(rig.board, (1,))
    rig.scans_until_end()
    rig.board.advance(10)
    assert [axis.rp for axis in rig.board.axes] == [0.0, 5.0, 0.0]
    assert all(rig.bits(i) & Axst.pe for i in rig.all)


@pytest.mark.covers("apci.ssms")
@pytest.mark.parametrize("scans", [1, 20, 200])
def test_a_start_while_the_last_entry_before_a_pause_still_runs_undoes_the_pause(scans: int) -> None:
    rig = Rig()
    for way in (11.0, 7.0, -3.0):
        mlr(rig.board, (0, 2), (way, 2.0 * way), SLOW, spool=True)
    ssms(rig.board, (0, 2))
    rig.board.advance(scans)
    sstps(rig.board, (0, 2))
    rig.board.advance(5)
    ssms(rig.board, (0, 2))
    rig.scans_until_end()
    assert (rig.board.axes[0].rp, rig.board.axes[2].rp) == (15.0, 30.0)
    assert (rig.board.axes[0].MCiS, rig.board.errorreg) == (0, 0)
    assert not rig.bits() & Axst.saf


def test_a_start_behind_a_pause_takes_axes_at_rest_along_and_no_jogging_one() -> None:
    rig = Rig()
    mlr(rig.board, (0,), (11.0,), SLOW, spool=True)
    mlr(rig.board, (0,), (-2.0,), SLOW, spool=True)
    mlr(rig.board, (1,), (5.0,), SLOW, spool=True)
    ssms(rig.board, (0,))
    rig.board.advance(30)
    sstps(rig.board, (0,))
    rig.set_jog(2)
    jr(rig.board, (2,), (3.0,))
    rig.board.advance(LATENCY + 2)
    mlr(rig.board, (2,), (1.0,), SLOW, spool=True)
    ssms(rig.board, (0, 1, 2))  # axis 2 jogs: nothing is started
    rig.board.advance(3)
    assert rig.board.axes[1].dp == 0.0
    ssms(rig.board, (0, 1))
    rig.scans_until_end((0, 1))
    assert (rig.board.axes[0].rp, rig.board.axes[1].rp) == (9.0, 5.0)


@pytest.mark.covers("apci.rule.spool_reload")
def test_a_contour_longer_than_the_spooler_runs_without_a_break_while_it_is_refilled() -> None:
    rig = Rig(axes=1)
    total, sent, step = 1200, 0, 0.125
    rates: list[float] = []
    while sent < total:
        while sent < total and rig.board.axes[0].lsm > 130_000:
            last = sent == total - 1
            mlr(rig.board, (0,), (step,), SLOW if last else GOES_ON, spool=True)
            sent += 1
        if not rates:
            ssms(rig.board, (0,))
        before = rig.board.axes[0].dp
        rig.board.advance(20)
        rates.append((rig.board.axes[0].dp - before) / (20 * SCAN_S))
    assert rates[25:] == pytest.approx([50.0] * len(rates[25:]), rel=1e-6)
    rig.scans_until_end()
    assert rig.board.axes[0].rp == pytest.approx(total * step, abs=1e-9)
    assert rig.board.errorreg == 0


def test_a_board_may_take_a_start_at_rest_only() -> None:
    rig = Rig("[rulings]\nssms_undoes_sstps = false\n")
    for way in (11.0, 7.0):
        mlr(rig.board, (0,), (way,), SLOW, spool=True)
    ssms(rig.board, (0,))
    rig.board.advance(20)
    sstps(rig.board, (0,))
    ssms(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.axes[0].rp == 11.0
    ssms(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.axes[0].rp == 18.0
