"""Position loops: closing and opening, the filter, monitors, backlash, resets, recording for the analysis."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.controllers.apci.board._axis_commands import (
    RPtoDP,
    azo,
    cl,
    clv,
    lprs,
    ol,
    ra,
    shp,
    szpa,
    szpr,
    utrovr,
)
from polycnc.controllers.apci.board._jog_commands import ja, jr, js
from polycnc.controllers.apci.board._move_commands import Speeds, mla, mlr
from polycnc.controllers.apci.board._system_file import parse_system_file
from support.apci_bits import Axst, ModeReg
from support.apci_rig import LATENCY, SCAN_S, Rig

LAG = '[[axis]]\nkp = 30\n[axis.plant]\nkind = "lag"\nlag_s = 0.005\n'


@pytest.mark.covers("apci.ctrl.loop", "apci.axst.13.cl", "apci.const.mcpservo")
def test_loops_are_open_after_power_up_and_closing_does_not_jump() -> None:
    rig = Rig(LAG, closed=False)
    axis = rig.board.axes[0]
    assert not rig.bits() & Axst.cl
    assert axis.mcp == 0
    rig.board.axes[0].mcp = 32767  # 10 V: 200 mm/s
    rig.board.advance(100)
    assert axis.rv == pytest.approx(200.0)
    for command in (ja, jr):
        command(rig.board, (0,), (1.0,))
    mla(rig.board, (0,), (1.0,), Speeds(10.0, 10.0))
    rig.board.axes[0].mcp = 0
    rig.board.advance(200)
    at = axis.rp
    assert at > 20.0  # none of them was carried out
    cl(rig.board, (0,))
    assert rig.bits() & Axst.cl
    assert axis.dp == axis.rp
    rig.board.advance(100)
    assert axis.rp == pytest.approx(at, abs=1e-9)
    rig.board.axes[0].mcp = 5000
    rig.board.advance(2)
    assert axis.mcp == 0  # the controller writes it
    ol(rig.board, (0,))
    assert not rig.bits() & Axst.cl


@pytest.mark.covers("apci.wrmcp", "apci.const.mcpstep", "apci.const.clock8001", "apci.const.clock8008")
@pytest.mark.parametrize(("kind", "clock_hz"), [("APCI-8001", 70e6), ("APCI-8008", 66.66666e6)])
def test_motor_command_of_a_stepper_is_a_delay(kind: str, clock_hz: float) -> None:
    rig = Rig(f'board_type = "{kind}"\n[[axis]]\nmotor = "stepper"\nslsp = 1000\ngf = 1\n', closed=False)
    axis = rig.board.axes[0]
    for counts in (999, 12_499, -999, 0):
        rig.board.axes[0].mcp = counts
        assert axis.mcp == counts
        rig.board.advance(2)
        expected_hz = math.copysign(clock_hz / 2.0 / (abs(counts) + 1), counts) if counts else 0.0
        assert axis.rv * 1000.0 == pytest.approx(expected_hz)
        if kind == "APCI-8001":
            assert abs(expected_hz) == pytest.approx({999: 35_000.0, 12_499: 2800.0, 0: 0.0}[abs(counts)])
    for counts, taken in ((2_000_000, 1_048_574), (-2_000_000, -1_048_574)):
        rig.board.axes[0].mcp = counts
        assert axis.mcp == taken
    cl(rig.board, (0,))
    rig.set_jog(jac=1000.0, jdec=1000.0, jvl=35.0)
    jr(rig.board, (0,), (100.0,))
    rig.board.advance(200)
    assert axis.mcp == round(clock_hz / 2.0 / 35_000.0) - 1


@pytest.mark.covers("apci.MODEREG.6", "apci.MODEREG.25", "apci.MODEREG.ClearZeroPosition", "apci.MODEREG")
def test_modes_that_part_1_only_names_are_kept_without_effect() -> None:
    mode = ModeReg.bit6 | ModeReg.bit25 | ModeReg.ClearZeroPosition
    runs = []
    for bits in (0, int(mode)):
        rig = Rig()
        rig.board.modereg = bits
        assert rig.board.modereg == bits
        szpa(rig.board, 0, 1.0)
        for i, target in ((0, 10.0), (1, 5.0)):
            rig.board.trovrst = 0.1
            rig.board.trovr = 0.5 + i
            utrovr(rig.board, (0, 1))
            mla(rig.board, (0, 1), (target, 2.0), Speeds(100.0, 20.0))
            rig.scans_until_end()
        runs.append((rig.setpoints(0), rig.setpoints(1)))
    assert np.array_equal(runs[0][0], runs[1][0])
    assert np.array_equal(runs[0][1], runs[1][1])


@pytest.mark.covers("apci.clv")
@pytest.mark.parametrize("kind", ["ideal", "lag"])
def test_closing_the_loop_at_speed_goes_on_with_it(kind: str) -> None:
    rig = Rig(f'[[axis]]\nkp = 30\nkfcv = 1\n[axis.plant]\nkind = "{kind}"\n', closed=False)
    axis = rig.board.axes[0]
    rig.board.axes[0].mcp = 8192
    rig.board.advance(50)
    velocity, at = axis.rv, axis.rp
    assert velocity == pytest.approx(50.0, rel=1e-3)
    clv(rig.board, (0,))
    rig.forget()
    rig.board.advance(100)
    assert axis.dv == velocity
    assert axis.dp == pytest.approx(at + 100 * SCAN_S * velocity)
    assert axis.rp == pytest.approx(axis.dp, abs=0.1)
    axis.sdec = 200.0
    js(rig.board, (0,))
    rig.scans_until_end()
    assert axis.dv == 0.0
    assert axis.dp == pytest.approx(at + 100 * SCAN_S * velocity + velocity**2 / 400.0)


@pytest.mark.covers("apci.ctrl.pidf", "apci.uf")
def test_filter_coefficients_can_be_changed_on_the_way() -> None:
    rig = Rig(LAG)
    axis = rig.board.axes[0]
    rig.set_jog(jac=1000.0, jvl=50.0)
    jr(rig.board, (0,), (1000.0,))
    for kp, kfcv, error in ((30.0, 0.0, 50.0 / 30.0), (60.0, 0.0, 50.0 / 60.0), (60.0, 1.0, 0.0)):
        axis.kp, axis.kfcv = kp, kfcv
        rig.board.update_filter(0)
        rig.board.advance(600)
        assert axis.PosErr == pytest.approx(error, abs=0.05)
    axis.kfcv, axis.ki = 0.0, 600.0  # T_N = 0.1 s
    rig.board.update_filter(0)
    rig.board.advance(2000)
    assert axis.PosErr == pytest.approx(0.0, abs=1e-3)


@pytest.mark.covers("apci.ctrl.kpl", "apci.ctrl.scantime")
@pytest.mark.parametrize(("kpl", "lag_s"), [(0.0, 0.00064), (0.95, 0.000032), (1.0, 0.0)])
def test_filter_lag(kpl: float, lag_s: float) -> None:
    rig = Rig('[[axis]]\nkp = 20\n[axis.plant]\nkind = "lag"\n')
    axis = rig.board.axes[0]
    axis.kpl = kpl
    rig.board.update_filter(0)
    rig.board.axes[0].dp = 1.0
    rig.board.advance(1)
    # The error goes from 0 to 1 in a line over the scan; a lag T answers it with 1 - T/t (1 - exp(-t/T)).
    share = 1.0 - lag_s / SCAN_S * (1.0 - math.exp(-SCAN_S / lag_s)) if lag_s else 1.0
    assert axis.servo["output"] == pytest.approx(20.0 * share)


@pytest.mark.covers("apci.axst.7.mpe", "apci.axst.14.ip", "apci.axst.12.pe")
def test_monitors_of_the_position_error() -> None:
    rig = Rig(LAG)
    axis = rig.board.axes[0]
    rig.set_jog(jac=1000.0, jdec=1000.0)
    jr(rig.board, (0,), (50.0,))
    rig.board.advance(300)
    assert axis.PosErr == pytest.approx(50.0 / 30.0, rel=0.01)
    assert not rig.bits() & (Axst.mpe | Axst.ip)
    axis.mpe, axis.ipw = 1.5, 5.0
    rig.board.advance(1)
    assert rig.bits() & Axst.mpe
    assert not rig.bits() & Axst.ip  # the profile has not ended
    axis.mpe = 1.7
    rig.board.advance(1)
    assert not rig.bits() & Axst.mpe
    axis.ipw = 0.01
    rig.scans_until_end()
    assert not rig.bits() & Axst.ip
    rig.board.advance(400)
    assert rig.bits() & Axst.ip
    axis.mpe = 1e-12
    ol(rig.board, (0,))
    axis.row["closed"] = 0
    rig.board.advance(1)
    assert not rig.bits() & Axst.mpe


@pytest.mark.covers("apci.rule.relays", "apci.io.PAE", "apci.ol", "apci.cl", "apci.ra")
def test_enable_outputs_and_relays() -> None:
    rig = Rig(
        'number_of_axes = 3\n[outputs]\n1 = { functions = ["PAE"], axes = ["A1"] }\n'
        '2 = { functions = ["PAE"], axes = ["A2", "A3"] }\n7 = { set_at_reset = true }\n',
        closed=False,
    )
    board = rig.board
    assert board.outputs == 0x40
    cl(board, (0,))
    clv(board, (1, 2))
    assert board.outputs == 0x43
    assert [axis.relay for axis in board.axes] == [True, True, True]
    board.outputs = 0x0F
    ol(board, (0,))
    assert board.outputs == 0x0E
    assert [axis.relay for axis in board.axes] == [False, True, True]
    cl(board, (0,))
    board.outputs = 0x0F
    ol(board, (0, 2))  # every axis switches its own output off
    assert board.outputs == 0x0C
    assert [axis.relay for axis in board.axes] == [False, True, False]
    cl(board, (0, 2))
    assert board.outputs == 0x0F
    ra(board, (1,))  # also resets the output of axis 2, which is in its group
    assert board.outputs & 0x02 == 0
    assert board.outputs & 0x40
    board.reset()
    assert board.outputs == 0x40
    assert [axis.relay for axis in board.axes] == [False, False, False]


@pytest.mark.covers("apci.rule.commonpersist", "apci.rs")
def test_common_variables_survive_a_reset() -> None:
    rig = Rig()
    rig.board.state.ci[7], rig.board.state.cd[9] = 5, 2.5
    rig.board.axes[0].jvl = 12.5
    jr(rig.board, (0,), (5.0,))
    rig.scans_until_end()
    jr(rig.board, (0,), (5.0,))
    rig.board.reset()
    rig.board.advance(10)
    assert (rig.board.state.ci[7], rig.board.state.cd[9]) == (5, 2.5)
    assert rig.board.axes[0].jvl == 12.5
    assert rig.board.axes[0].rp == 5.0
    assert rig.bits() & (Axst.pe | Axst.cl) == Axst.pe


@pytest.mark.covers("apci.ra")
def test_reset_of_an_axis_zeroes_its_position() -> None:
    rig = Rig()
    jr(rig.board, (0, 1), (5.0, 5.0))
    rig.board.advance(100)
    ra(rig.board, (0,))
    rig.scans_until_end()
    assert [axis.rp for axis in rig.board.axes] == [0.0, 5.0, 0.0]
    assert not rig.bits() & Axst.cl


@pytest.mark.covers("apci.axst.9.cef")
def test_a_system_file_for_another_board() -> None:
    rig = Rig()
    rig.board.load_parameters(parse_system_file('number_of_axes = 3\n[[axis]]\nmotor = "stepper"\n'))
    assert rig.bits() & Axst.cef
    rig.board.reset()
    assert rig.bits() & Axst.cef
    rig.board.load_parameters(parse_system_file("number_of_axes = 3"))
    assert not rig.bits() & Axst.cef


@pytest.mark.covers("apci.rule.backlash", "apci.shp")
def test_backlash_is_compensated_and_its_shift_outlives_shp() -> None:
    rig = Rig('[[axis]]\nkp = 100\nbacklash = 0.2\n[axis.plant]\nkind = "lag"\nplay = 0.2\n')
    axis, load = rig.board.axes[0], rig.board.kernel.plant.row[0]
    for target in (5.0, 2.0, 4.0, 3.0):
        ja(rig.board, (0,), (target,))
        rig.scans_until_end()
        rig.board.advance(500)
        assert axis.dp == pytest.approx(target, abs=1e-12)
        assert axis.rp == pytest.approx(target, abs=1e-6)
        assert load["position"] == pytest.approx(target, abs=1e-6)
        assert load["drive_position"] == pytest.approx(
            target + (0.1 if target in (5.0, 4.0) else -0.1), abs=1e-6
        )
    shp(rig.board, 0, 0.0)
    assert axis.row["shift"] == -0.1
    assert axis.rp == pytest.approx(0.0, abs=1e-6)
    ja(rig.board, (0,), (2.0,))
    rig.scans_until_end()
    rig.board.advance(500)
    assert load["position"] == pytest.approx(5.0, abs=1e-5)


@pytest.mark.covers("apci.var.dpoffset", "apci.wrdpoffset", "apci.wrdvoffset", "apci.var.dvoffset")
def test_offset_of_the_setpoint() -> None:
    rig = Rig()
    axis = rig.board.axes[0]
    axis.dpoffset = 0.5
    rig.board.advance(1)
    assert axis.dp == 0.5
    axis.dvoffset = 10.0
    axis.dpoffset = 1.5
    rig.board.advance(40)
    assert axis.dp == pytest.approx(0.5 + 40 * SCAN_S * 10.0, abs=1e-3)
    rig.board.advance(50)
    assert axis.dp == 1.5
    jr(rig.board, (0,), (2.0,))
    rig.scans_until_end()
    assert axis.dp == 3.5


@pytest.mark.covers("apci.RPtoDP")
def test_setpoint_can_be_put_where_the_axis_is() -> None:
    rig = Rig(LAG)
    axis = rig.board.axes[0]
    rig.board.kernel.servo.row[0]["blocked"] = 1
    rig.board.axes[0].dp = 5.0
    rig.board.advance(3)
    RPtoDP(rig.board, (0,))
    rig.board.advance(1)
    assert axis.dp == pytest.approx(axis.rp, abs=0.5)
    assert axis.dp < 4.0
    rig.board.advance(300)
    jr(rig.board, (0,), (50.0,))
    rig.board.advance(LATENCY + 100)
    before = axis.dp
    RPtoDP(rig.board, (0,))  # without effect in a profile
    rig.board.advance(1)
    assert axis.dp > before
    js(rig.board, (0,))
    rig.scans_until_end()
    rig.set_jog(jtvl=20.0)
    jr(rig.board, (0,), (5.0,))
    rig.scans_until_end()
    rig.board.advance(100)
    lag = axis.PosErr
    assert lag == pytest.approx(20.0 / 30.0, rel=0.01)
    at = axis.rp
    RPtoDP(rig.board, (0,))  # at target velocity it corrects
    rig.board.advance(1)
    assert axis.dp == pytest.approx(at + 20.0 * SCAN_S)
    assert axis.dv == pytest.approx(20.0)


@pytest.mark.covers("apci.azo", "apci.szpa", "apci.szpr", "apci.rdZeroOffset", "apci.var.zeroOffset")
def test_zero_offsets() -> None:
    rig = Rig()
    axis = rig.board.axes[0]
    ja(rig.board, (0,), (10.0,))
    rig.scans_until_end()
    szpa(rig.board, 0, 4.0)
    assert axis.rp == 6.0
    szpr(rig.board, 0, 1.0)
    assert axis.rp == 5.0
    szpa(rig.board, 0, 0.0)
    assert axis.rp == 10.0
    for number in range(5):
        axis.zero_offsets[number] = float(number)
    for number, rp in ((0, 10.0), (3, 7.0), (5, 10.0), (4, 6.0), (77, 10.0)):
        azo(rig.board, number)
        assert axis.rp == rp


def recorded(rig: Rig, i: int) -> npt.NDArray[np.float64]:
    """Return what was recorded of an axis."""
    return rig.board.state.analysis[: rig.board.state.board[0]["recorded"], i]


@pytest.mark.covers("apci.lpr", "apci.lprs", "apci.LATCH_INFOS")
def test_recording_for_the_analysis() -> None:
    rig = Rig("number_of_axes = 3\n" + LAG)
    axis = rig.board.axes[0]
    lprs(rig.board, (0,), every=5)
    jr(rig.board, (0,), (20.0,))
    expected = []
    for scan in range(1, 201):
        rig.board.advance(1)
        if scan % 5 == 0:
            expected.append((axis.dp, axis.rp, float(axis.servo["output"])))
    found = recorded(rig, 0)
    assert found.shape == (40, 3)
    assert found == pytest.approx(np.array(expected))
    lprs(rig.board, (0, 1, 2))
    rig.board.advance(10)
    assert len(recorded(rig, 2)) == 10
    rig.board.advance(10_000)
    assert len(recorded(rig, 0)) == 4096  # full: it keeps what it has


@pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")  # of NumPy, uncompiled
def test_numbers_that_are_none_do_not_get_in() -> None:
    rig = Rig()
    axis = rig.board.axes[0]
    for name in ("jac", "jvl", "jtvl", "jovr", "hac", "sdec", "sll", "jerkrel", "dpoffset", "slsp", "gf"):
        before = getattr(axis, name)
        for wrong in (math.nan, math.inf) if name != "jerkrel" else (math.nan,):
            setattr(axis, name, wrong)
        assert getattr(axis, name) == before
    for name in ("slsp", "gf"):
        before = getattr(axis, name)
        for wrong in (0.0, -3.0, 5e-324, 9e-101):  # the product of the two would be 0
            setattr(axis, name, wrong)
            assert getattr(axis, name) == before
    ja(rig.board, (0,), (math.nan,))
    mlr(rig.board, (0,), (1e308,), Speeds(1e308, 1e308), spool=True)
    rig.board.advance(10)
    assert axis.dp == 0.0
