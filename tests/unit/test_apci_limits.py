"""Limits by switch and by software with their three functions, and what each input does to the status word."""

from __future__ import annotations

import numpy as np
import pytest

from polycnc.controllers.apci.board._axis_commands import cl, ol, ra, shp
from polycnc.controllers.apci.board._jog_commands import ja, jr
from polycnc.controllers.apci.board._move_commands import Speeds, mlr
from polycnc.controllers.apci.board._spool_commands import ssms
from polycnc.controllers.apci.core import _registers
from support.apci_bits import Axst, ErrorReg
from support.apci_rig import SCAN_S, Rig, scans_for


def soft(function: str, kind: str = "ideal") -> Rig:
    """Return a referenced axis with software limits at -10 and 20 mm, beside a free one."""
    rig = Rig(
        f'number_of_axes = 2\n[[axis]]\nsoft_left = "{function}"\nsoft_right = "{function}"\nsll = -10\nslr = 20\n'
        f'sdec = 200\n[axis.plant]\nkind = "{kind}"\n'
    )
    shp(rig.board, 0, 0.0)
    rig.set_jog(jac=500.0, jdec=500.0)
    return rig


def switch(side: str, function: str) -> Rig:
    """Return an axis with a limit switch on one side: from 20 mm, or up to -10 mm."""
    place = "limit_right = 20" if side == "R" else "limit_left = -10"
    rig = Rig(
        f'number_of_axes = 2\n[inputs]\n5 = {{ functions = ["LS{side}_{function}"], axes = ["A1"] }}\n'
        f"[[axis]]\nsdec = 200\n[axis.plant]\n{place}\n"
    )
    rig.set_jog(jac=500.0, jdec=500.0)
    return rig


SIDES = [(1.0, 20.0, Axst.lsrs), (-1.0, -10.0, Axst.lsls)]


@pytest.mark.covers("apci.limit.general", "apci.limit.SMD", "apci.axst.5.lsls", "apci.axst.6.lsrs")
@pytest.mark.parametrize(("sign", "limit", "bit"), SIDES)
def test_smd_brakes_refuses_and_lets_out(sign: float, limit: float, bit: int) -> None:
    rig = soft("SMD")
    mlr(rig.board, (0, 1), (sign * 100.0, 0.0), Speeds(500.0, 50.0), spool=True)
    mlr(rig.board, (0, 1), (sign * 100.0, 5.0), Speeds(500.0, 50.0), spool=True)
    ssms(rig.board, (0, 1))
    rig.scans_until_end((0,))
    rest = rig.board.axes[0].dp
    # The first setpoint beyond, then braking with sdec from there.
    found = rig.setpoints() * sign
    first = found[found > abs(limit)][0]
    assert rest * sign == pytest.approx(first + 50.0**2 / 400.0)
    assert rig.bits() & bit
    assert rig.board.axes[0].MCiS == 0
    rig.scans_until_end()
    jr(rig.board, (0,), (sign * 5.0,))
    rig.scans_until_end()
    rig.board.advance(5)
    assert rig.board.axes[0].dp == rest
    ja(rig.board, (0,), (0.0,))
    rig.scans_until_end()
    assert rig.board.axes[0].dp == 0.0
    assert not rig.bits() & bit


@pytest.mark.covers("apci.limit.SMA", "apci.axst.5.lsls", "apci.axst.6.lsrs")
@pytest.mark.parametrize(("sign", "limit", "bit"), SIDES)
def test_sma_holds_the_setpoint_while_the_profile_runs_on(sign: float, limit: float, bit: int) -> None:
    rig = soft("SMA")
    jr(rig.board, (0,), (sign * 100.0,))
    rig.scans_until_end()
    held = rig.board.axes[0].dp
    assert abs(held) <= abs(limit)
    assert abs(limit - held) <= 50.0 * SCAN_S
    assert rig.board.axes[0].rp == held
    assert rig.board.kernel.base[0] == sign * 100.0  # the generator has gone on
    rig.forget()
    jr(rig.board, (0,), (-sign * 100.0,))
    rig.scans_until_end()
    assert rig.board.axes[0].dp == 0.0
    found = rig.setpoints() * sign
    assert np.all(found[: scans_for(1.5)] == held * sign)  # until the profile is back inside
    assert not rig.bits() & bit


@pytest.mark.covers("apci.limit.SMA")
def test_sma_lets_go_when_its_software_limit_is_moved_away() -> None:
    rig = soft("SMA")
    jr(rig.board, (0,), (30.0,))
    rig.scans_until_end()
    assert rig.board.axes[0].dp < 20.1
    rig.board.axes[0].slr = 50.0
    rig.board.advance(2)
    assert rig.board.axes[0].dp == 30.0


@pytest.mark.covers("apci.cl", "apci.limit.SMA")
def test_cl_of_an_axis_that_has_run_beyond_its_hold_keeps_it_where_it_is() -> None:
    rig = Rig(
        'number_of_axes = 2\n[[axis]]\nsoft_right = "SMA"\nslr = 20\nkp = 60\n'
        '[axis.plant]\nkind = "lag"\nlag_s = 0.02\n'
    )
    shp(rig.board, 0, 0.0)
    rig.set_jog(jac=500.0, jdec=500.0)
    axis = rig.board.axes[0]
    jr(rig.board, (0,), (100.0,))
    while axis.rp <= axis.dp or not rig.bits() & Axst.lsrs:  # it swings over
        rig.board.advance(1)
    while axis.rv > 0.0:
        rig.board.advance(1)
    beyond = axis.rp
    assert beyond > axis.dp + 0.05
    cl(rig.board, (0,))
    rig.board.advance(5)
    assert axis.dp == beyond


@pytest.mark.covers("apci.limit.TOM", "apci.axst.5.lsls", "apci.axst.6.lsrs")
@pytest.mark.parametrize(("sign", "limit", "bit"), SIDES)
def test_tom_takes_the_drive_away_and_it_coasts(sign: float, limit: float, bit: int) -> None:
    rig = Rig(
        'number_of_axes = 2\n[[axis]]\nsoft_left = "TOM"\nsoft_right = "TOM"\nsll = -10\nslr = 20\nkp = 30\n'
        '[axis.plant]\nkind = "lag"\nlag_s = 0.05\n'
    )
    shp(rig.board, 0, 0.0)
    rig.set_jog(jac=500.0, jdec=500.0)
    axis = rig.board.axes[0]
    jr(rig.board, (0,), (sign * 100.0,))
    while not rig.bits() & bit:
        rig.board.advance(1)
    at, velocity = axis.rp, axis.rv
    assert velocity * sign > 40.0
    rig.scans_until_end()
    rig.board.advance(500)
    assert axis.mcp == 0
    assert axis.dp == sign * 100.0  # the setpoint runs on
    coasted = (axis.rp - at) * sign
    assert coasted == pytest.approx(abs(velocity) * 0.05, rel=0.1)  # v T of a drive without command
    rest = axis.rp
    rig.board.advance(500)
    assert axis.rp == rest
    ja(rig.board, (0,), (0.0,))
    rig.scans_until_end()
    rig.board.advance(1000)
    assert axis.rp == pytest.approx(0.0, abs=1e-3)
    assert not rig.bits() & bit


@pytest.mark.covers("apci.limit.TOM", "apci.limit.SMA", "apci.limit.SMD")
@pytest.mark.parametrize(
    ("side", "function", "bit"),
    [
        pytest.param(side, function, bit, marks=pytest.mark.covers(f"apci.io.LS{side}_{function}", row))
        for side, bit, row in (("L", Axst.lslh, "apci.axst.3.lslh"), ("R", Axst.lsrh, "apci.axst.4.lsrh"))
        for function in ("SMD", "SMA", "TOM")
    ],
)
def test_limit_switches(side: str, function: str, bit: int) -> None:
    sign, limit = (1.0, 20.0) if side == "R" else (-1.0, -10.0)
    rig = switch(side, function)
    jr(rig.board, (0,), (sign * 50.0,))
    rig.scans_until_end()
    rig.board.advance(2)
    axis = rig.board.axes[0]
    beyond = (axis.rp - limit) * sign
    assert rig.bits() & bit
    assert not rig.bits(1) & bit
    if function == "SMD":
        assert 6.25 <= beyond <= 6.25 + 2 * 50.0 * SCAN_S
        assert axis.dp == axis.rp
    else:
        assert 0.0 <= beyond <= 2 * 50.0 * SCAN_S
    if function == "TOM":
        assert axis.dp == sign * 50.0
    if function == "SMA":
        assert axis.dp == axis.rp
    ja(rig.board, (0,), (0.0,))
    rig.scans_until_end()
    assert axis.rp == 0.0
    assert not rig.bits() & bit


@pytest.mark.covers("apci.limit.TOM", "apci.io.LSR_TOM")
def test_tom_also_takes_an_open_loop_command_away() -> None:
    rig = switch("R", "TOM")
    ol(rig.board, (0,))
    rig.board.axes[0].mcp = 32767
    rig.board.advance(1000)
    assert 20.0 <= rig.board.axes[0].rp < 21.0
    rig.board.axes[0].mcp = -32767
    rig.board.advance(10)
    assert rig.board.axes[0].rp < 20.0


@pytest.mark.covers("apci.limit.general", "apci.rule.referenced", "apci.axst.17.referenced")
def test_software_limits_are_watched_from_shp_to_the_next_reset() -> None:
    rig = soft("SMD")
    ra(rig.board, (0,))
    cl(rig.board, (0,))
    assert not rig.bits() & Axst.referenced
    ja(rig.board, (0,), (-15.0,))
    rig.scans_until_end()
    assert rig.board.axes[0].rp == -15.0
    assert not rig.bits() & Axst.lsls
    shp(rig.board, 0, 0.0)
    rig.set_jog(jvl=10.0)
    ja(rig.board, (0,), (-15.0,))
    rig.scans_until_end()
    assert -11.0 < rig.board.axes[0].rp < -10.0
    rig.board.reset()
    assert not rig.bits() & (Axst.referenced | Axst.lsls)


@pytest.mark.covers("apci.limit.general", "apci.cl")
def test_closing_the_loop_erases_limit_states() -> None:
    rig = soft("SMA")
    jr(rig.board, (0,), (100.0,))
    rig.scans_until_end()
    assert rig.board.state.axis[0]["held"]
    cl(rig.board, (0,))
    assert not rig.bits() & Axst.lsrs
    rig.board.advance(1)
    assert rig.board.kernel.base[0] == rig.board.axes[0].dp <= 20.0
    jr(rig.board, (0,), (-1.0,))
    rig.scans_until_end()
    assert rig.board.axes[0].dp < 19.1


FLAGS = [
    pytest.param("EO", Axst.eo, True, marks=pytest.mark.covers("apci.io.EO", "apci.axst.1.eo")),
    pytest.param("DR", Axst.dnr, False, marks=pytest.mark.covers("apci.io.DR", "apci.axst.2.dnr")),
    pytest.param("UI", Axst.ui, True, marks=pytest.mark.covers("apci.io.UI", "apci.axst.15.ui")),
    pytest.param("REF", Axst.refh, True, marks=pytest.mark.covers("apci.io.REF", "apci.axst.18.refh")),
]


@pytest.mark.parametrize("inverted", [False, True])
@pytest.mark.parametrize(("function", "bit", "when_active"), FLAGS)
def test_inputs_show_in_the_status(function: str, bit: int, when_active: bool, inverted: bool) -> None:
    rig = Rig(
        f'number_of_axes = 2\n[inputs.16]\nfunctions = ["{function}"]\naxes = ["A2"]\n'
        f"inverted = {str(inverted).lower()}\n"
    )
    for active in (False, True, False):
        rig.board.set_input(16, active is not inverted)
        rig.board.advance(1)
        assert bool(rig.bits(1) & bit) is (active is when_active)
        assert not rig.bits(0) & bit
        assert bool(rig.board.inputs & 1 << 15) is active


@pytest.mark.covers("apci.axst.0", "apci.axst.10", "apci.axst.11", "apci.axst.20-31", "apci.ErrorReg.21-31")
def test_bits_without_a_meaning_stay_0() -> None:
    rig = Rig()
    rig.board.raise_error(_registers.ErrorReg(_registers.ErrorReg.assigned()))
    row = rig.board.state.axis[0]
    for name in row.dtype.names or ():
        if row.dtype[name] == np.int64:
            row[name] = 3
    assert int(rig.bits()) == int(rig.bits()) & 0x000FF3FE != 0
    assert int(rig.board.errorreg) == 0x001FFFFF


@pytest.mark.covers(
    "apci.ErrorReg.8.PciBusError", "apci.ErrorReg.9.CheckMonitorScreen", "apci.ErrorReg.18.IOResetHandled"
)
@pytest.mark.parametrize(
    "fault", [ErrorReg.PciBusError, ErrorReg.CheckMonitorScreen, ErrorReg.IOResetHandled]
)
def test_faults_of_hardware_can_be_injected_and_stay(fault: int) -> None:
    rig = Rig()
    rig.board.raise_error(_registers.ErrorReg(fault))
    jr(rig.board, (0,), (1.0,))
    rig.scans_until_end()
    rig.board.reset()
    assert rig.board.errorreg == fault


@pytest.mark.covers("apci.ErrorReg.14.LimitDefError", "apci.rule.limits_mcp")
@pytest.mark.parametrize("wrong", ["mcpmax = 40000", "mcpmin = 5\nmcpmax = 2", "mcpcp = -5", "mcpcn = 7"])
def test_limits_of_the_motor_command_that_cannot_be_meant(wrong: str) -> None:
    rig = Rig(f"[[axis]]\n{wrong}\n")
    assert rig.board.errorreg == ErrorReg.LimitDefError


@pytest.mark.covers("apci.rule.limits_mcp", "apci.ctrl.loop")
def test_limits_of_the_motor_command_act_in_both_modes() -> None:
    rig = Rig(
        "[[axis]]\nmcpmax = 8192\nmcpmin = -4096\nmcpcp = 300\nmcpcn = -200\nkp = 50\n"
        '[axis.plant]\nkind = "lag"\nlag_s = 0.01\n'
    )
    axis = rig.board.axes[0]
    rig.set_jog(jac=5000.0, jvl=190.0, jdec=5000.0)
    for sign, limit in ((1.0, 8192), (-1.0, -4096)):
        jr(rig.board, (0,), (sign * 200.0,))
        rig.board.advance(400)
        assert axis.mcp == limit
        assert axis.rv == pytest.approx(limit / 32767 * 200.0, rel=1e-3)
        rig.scans_until_end()
        rig.board.advance(10_000)
        assert axis.rp == pytest.approx(axis.dp, abs=1e-6)
    jr(rig.board, (0,), (1000.0,))
    rig.set_jog(jvl=10.0)
    rig.board.advance(1)
    axis.servo["output"] = 10.0
    assert axis.mcp == round(10.0 / 200.0 * 32767) + 300
    axis.servo["output"] = -10.0
    assert axis.mcp == -round(10.0 / 200.0 * 32767) - 200
    ol(rig.board, (0,))
    for written, taken in ((30_000, 8192), (-30_000, -4096), (100, 100)):
        rig.board.axes[0].mcp = written
        assert axis.mcp == taken
