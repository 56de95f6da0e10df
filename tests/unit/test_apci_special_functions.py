"""Special functions in the spooler: variables, outputs, waits, barriers, interrupts."""

from __future__ import annotations

import pytest

from polycnc.controllers.apci.board._axis_commands import cl, ol
from polycnc.controllers.apci.board._move_commands import Speeds, mlr
from polycnc.controllers.apci.board._spool_commands import ssf, ssms
from support.apci_bits import Axst, ErrorReg
from support.apci_rig import SCAN_S, Rig

SLOW = Speeds(100.0, 50.0)
GOES_ON = Speeds(100.0, 50.0, 50.0)


def carried_out(*functions: tuple[int, float], rig: Rig | None = None) -> Rig:
    """Queue functions for axis 0, start and let two scans pass."""
    rig = rig or Rig()
    for command, value in functions:
        ssf(rig.board, 0, command, value)
    ssms(rig.board, (0,))
    rig.board.advance(2)
    return rig


@pytest.mark.covers(
    "apci.ssf", "apci.ssf.0-999", "apci.ssf.10000-10999", "apci.ssf.11000-11999", "apci.ssf.20000-20999"
)
def test_variables_are_written_in_sequence() -> None:
    rig = Rig()
    mlr(rig.board, (0,), (5.0,), SLOW, spool=True)
    ssf(rig.board, 0, 125, 999)
    mlr(rig.board, (0,), (5.0,), SLOW, spool=True)
    ssms(rig.board, (0,))
    while rig.board.state.ci[125] == 0:
        rig.board.advance(1)
    assert rig.board.axes[0].dp == pytest.approx(5.0, abs=1e-3)
    rig = carried_out(
        (0, -7.9),
        (999, 2.0**32 + 5),
        (7, 0b1010),
        (10007, 0b0101),
        (11007, 0b0011),
        (20000, -1.5),
        (20999, 1e300),
    )
    state = rig.board.state
    assert (state.ci[0], state.ci[999], state.ci[7]) == (-7, 5, 0b1100)
    assert (state.cd[0], state.cd[999]) == (-1.5, 1e300)
    assert rig.bits() & Axst.pe


@pytest.mark.covers("apci.ssf.1001", "apci.ssf.1002", "apci.ssf")
@pytest.mark.parametrize(
    "bit", [pytest.param(n, marks=pytest.mark.covers(f"apci.digo.{n}")) for n in range(8)]
)
def test_outputs_are_set_and_reset_by_mask(bit: int) -> None:
    rig = carried_out((1001, 1 << bit), (1001, 1 << (bit + 8)))
    assert rig.board.outputs == 1 << bit
    rig.board.outputs = 0xFF
    carried_out((1002, 1 << bit), rig=rig)
    assert rig.board.outputs == 0xFF & ~(1 << bit)


@pytest.mark.covers("apci.ssf.1101", "apci.rule.interrupt")
def test_interrupt_of_the_pc() -> None:
    rig = Rig()
    calls: list[int] = []
    rig.board.interrupts.append(lambda: calls.append(rig.board.variables.irqpc))
    carried_out((1101, 0), rig=rig)
    assert calls == [1]


@pytest.mark.covers("apci.ssf.1200-1207")
def test_motor_command_of_any_axis() -> None:
    rig = Rig(axes=9, closed=False)
    cl(rig.board, (0, 3))
    carried_out((1201, 16383.5), (1207, -32767), (1203, 100), rig=rig)
    assert [axis.mcp for axis in rig.board.axes] == [0, 16383, 0, 0, 0, 0, 0, -32767, 0]
    before = rig.board.axes[1].rp
    rig.board.advance(100)
    assert rig.board.axes[1].rp - before == pytest.approx(16383 / 32767 * 200.0 * 100 * SCAN_S)
    assert rig.board.axes[3].rp == 0.0
    ol(rig.board, (0, 3))
    cl(rig.board, (8,))
    for number in range(9):  # the ninth is none
        ssf(rig.board, 8, 1200 + number, 111 * (number + 1))
    ssms(rig.board, (8,))
    rig.board.advance(2)
    assert [axis.mcp for axis in rig.board.axes] == [*range(111, 889, 111), 0]


@pytest.mark.covers("apci.ssf.1000")
def test_stop_of_the_spooler_until_the_next_start() -> None:
    rig = carried_out((5, 1), (1000, 0), (5, 2))
    assert rig.board.state.ci[5] == 1
    assert rig.bits() & Axst.pe
    rig.board.advance(50)
    assert rig.board.state.ci[5] == 1
    ssms(rig.board, (0,))
    rig.board.advance(2)
    assert rig.board.state.ci[5] == 2


@pytest.mark.covers("apci.ssf.1003", "apci.const.ssfunit")
@pytest.mark.parametrize(("value", "scans"), [(20, 1), (100, 5), (21, 2), (0, 0), (-5, 0), (1, 1)])
def test_wait_for_a_time(value: float, scans: int) -> None:
    rig = Rig()
    ssf(rig.board, 0, 1003, value)
    ssf(rig.board, 0, 5, 1)
    ssms(rig.board, (0,))
    waited = -1
    while rig.board.state.ci[5] == 0:
        rig.board.advance(1)
        waited += 1
    assert waited == scans


@pytest.mark.covers("apci.ssf.1003", "apci.ssf.1004", "apci.ssms")
@pytest.mark.parametrize("command", [(1003, 1e300), (1004, 0b101)])
def test_a_start_ends_waits_for_time_and_inputs(command: tuple[int, float]) -> None:
    rig = carried_out(command, (5, 1))
    rig.board.advance(100)
    assert rig.board.state.ci[5] == 0
    assert not rig.bits() & Axst.pe
    ssms(rig.board, (0,))
    rig.board.advance(1)
    assert rig.board.state.ci[5] == 1


@pytest.mark.covers("apci.ssf.1004")
def test_wait_for_inputs() -> None:
    rig = carried_out((1004, 0b101), (5, 1))
    for number, done in ((1, 0), (3, 1)):
        rig.board.set_input(number, True)
        rig.board.advance(2)
        assert rig.board.state.ci[5] == done


@pytest.mark.covers("apci.ssf.1005", "apci.ssf.1015", "apci.ssf.1025", "apci.ssf.waitnotes", "apci.ClearCI99")
@pytest.mark.parametrize(
    ("command", "value", "written"), [(1005, 6.0, 6), (1015, 3.0, 6), (1015, -3.5, -6), (1025, 0.0, 0b11)]
)
def test_waits_for_ci99_go_on_together(command: int, value: float, written: int) -> None:
    rig = Rig()
    for i in (0, 1):
        ssf(rig.board, i, command, value)
        mlr(rig.board, (i,), (1.0,), SLOW, spool=True)
    ssms(rig.board, (0, 1))
    rig.board.advance(30)
    assert rig.board.state.ci[99] == written
    assert not rig.bits() & Axst.pe
    ssms(rig.board, (0, 1))  # does not end these
    rig.board.advance(30)
    assert rig.board.axes[0].dp == 0.0
    rig.board.state.ci[99] = 0  # between two scans, as ClearCI99 does
    rig.board.advance(1)
    assert rig.board.axes[0].dp == rig.board.axes[1].dp > 0.0
    rig.scans_until_end()
    assert not rig.bits() & Axst.saf


@pytest.mark.covers("apci.ssf.1025")
def test_each_axis_waits_for_its_own_bit() -> None:
    rig = Rig()
    for i in (0, 2):
        ssf(rig.board, i, 1025, 0)
        ssf(rig.board, i, 5 + i, 1)
    ssms(rig.board, (0, 2))
    rig.board.advance(3)
    rig.board.state.ci[99] &= ~0b100
    rig.board.advance(2)
    assert (rig.board.state.ci[5], rig.board.state.ci[7]) == (0, 1)


@pytest.mark.covers("apci.ssf.1006")
def test_barrier_of_axes() -> None:
    rig = Rig()
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    mlr(rig.board, (1,), (20.0,), SLOW, spool=True)
    for i in (0, 1):
        ssf(rig.board, i, 1006, 0b11)
        mlr(rig.board, (i,), (5.0,), SLOW, spool=True)
    ssms(rig.board, (0, 1))
    rig.board.advance(400)
    assert rig.board.axes[0].dp == 1.0
    while rig.board.axes[1].dp <= 20.0:
        rig.board.advance(1)
    assert rig.board.axes[0].dp - 1.0 == pytest.approx(rig.board.axes[1].dp - 20.0)
    rig.scans_until_end()
    assert [axis.rp for axis in rig.board.axes] == [6.0, 25.0, 0.0]


@pytest.mark.covers("apci.ErrorReg.10.SsfWaitRefused", "apci.ssf.1000", "apci.ssf.1005", "apci.ssf.1006")
@pytest.mark.parametrize("command", [1000, 1003, 1004, 1005, 1006, 1015, 1025])
def test_wait_behind_a_target_velocity_is_ignored(command: int) -> None:
    rig = Rig()
    mlr(rig.board, (0,), (5.0,), GOES_ON, spool=True)
    ssf(rig.board, 0, command, 3.0)
    ssf(rig.board, 0, 5, 1)
    mlr(rig.board, (0,), (25.0,), SLOW, spool=True)
    ssms(rig.board, (0,))
    rig.scans_until_end()
    assert rig.board.errorreg == ErrorReg.SsfWaitRefused
    assert rig.board.state.ci[5] == 1
    assert rig.board.state.ci[99] == 0
    assert rig.board.axes[0].rp == 30.0
    # Behind a rest it waits.
    mlr(rig.board, (0,), (1.0,), SLOW, spool=True)
    ssf(rig.board, 0, command, 3.0)
    ssms(rig.board, (0,))
    rig.scans_until_end(limit=300)
    assert rig.board.errorreg == ErrorReg.SsfWaitRefused


@pytest.mark.covers("apci.ssf.2001")
def test_target_velocity_of_the_last_move_is_taken_away() -> None:
    rig = Rig()
    mlr(rig.board, (0, 1), (30.0, 0.0), GOES_ON, spool=True)
    ssf(rig.board, 0, 2001, 0)
    assert rig.board.axes[0].MCiS == 1
    ssf(rig.board, 0, 1003, 20 * 100)
    ssms(rig.board, (0, 1))
    rig.board.advance(1000)
    assert rig.board.errorreg == 0  # the wait is one after a rest
    rig.scans_until_end()
    assert rig.board.axes[0].dv == 0.0


def test_what_is_no_command_is_not_queued() -> None:
    rig = Rig()
    for command in (-1, 1007, 1014, 1100, 1208, 2000, 9999, 12000, 19999, 21000):
        ssf(rig.board, 0, command, 1.0)
    ssf(rig.board, 0, 5, float("nan"))
    assert rig.board.axes[0].queued == 0
