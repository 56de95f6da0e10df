"""Look-ahead over the spooler, and the axes' limits on lines."""

from __future__ import annotations

import math

import numpy as np
import pytest

from polycnc.controllers.apci.board._move_commands import Speeds, mla, mlr
from polycnc.controllers.apci.board._spool_commands import ssf, ssms
from support.apci_bits import ErrorReg, ModeReg
from support.apci_rig import SCAN_S, Rig, scans_for

FAST = Speeds(500.0, 40.0, 40.0)
LAST = Speeds(500.0, 40.0)


def run(rig: Rig) -> np.ndarray:
    """Run the queues of axes 0 and 1; return the velocities of both by scan."""
    rig.forget()
    ssms(rig.board, (0, 1))
    rig.scans_until_end()
    return np.array([np.diff(rig.setpoints(i)) for i in (0, 1)]) / SCAN_S


@pytest.mark.covers("apci.rule.lookahead", "apci.MODEREG.0.lookahead", "apci.var.MDVEL", "apci.wrMDVel")
@pytest.mark.covers("apci.MODEREG.6")  # which changes nothing of it
@pytest.mark.parametrize("mdvel", [0.0, 5.0, 1000.0])
def test_velocity_is_lowered_so_that_no_axis_jumps_more_than_it_stands(mdvel: float) -> None:
    corners = []
    for mode in (0, ModeReg.lookahead, ModeReg.lookahead | ModeReg.bit6):
        rig = Rig()
        rig.board.modereg = mode
        rig.board.axes[0].MDVEL = mdvel
        turn = math.radians(30.0)
        mlr(rig.board, (0, 1), (20.0, 0.0), FAST, spool=True)
        mlr(rig.board, (0, 1), (20.0 * math.cos(turn), 20.0 * math.sin(turn)), LAST, spool=True)
        velocity = run(rig)
        assert rig.board.axes[1].rp == pytest.approx(10.0)
        corner = int(np.flatnonzero(velocity[1] > 1e-9)[0])
        corners.append(velocity[0, corner - 1])
        jump = velocity[0, corner + 1] - velocity[0, corner - 2]
        ramp = 3 * 500.0 * SCAN_S
        if mode and mdvel == 5.0:
            assert abs(jump) <= mdvel + ramp
            assert velocity[0, corner - 1] == pytest.approx(
                5.0 / (1.0 - math.cos(turn)), abs=ramp
            )  # 37.3 mm/s
        else:
            assert abs(jump) == pytest.approx(40.0 * (1.0 - math.cos(turn)), abs=ramp)
    assert corners[0] == pytest.approx(40.0, abs=1.0)


@pytest.mark.covers("apci.rule.lookahead", "apci.MODEREG.0.lookahead")
def test_short_lines_are_braked_for_what_lies_far_ahead() -> None:
    rig = Rig()
    rig.board.modereg = ModeReg.lookahead
    for axis in rig.board.axes:
        axis.MDVEL = 1.0
    for _ in range(200):
        mlr(rig.board, (0, 1), (0.1, 0.0), FAST, spool=True)
    for _ in range(200):
        mlr(rig.board, (0, 1), (0.0, 0.1), FAST, spool=True)
    ssf(rig.board, 0, 5, 1)
    velocity = run(rig)
    assert velocity.max() == pytest.approx(40.0, rel=1e-3)
    acceleration = np.diff(np.hypot(*velocity)) / SCAN_S
    # Ramps only, but for the corner itself, which both axes stand with 1 mm/s.
    assert np.sort(np.abs(acceleration))[-4:].max() <= 500.0 + 2.0 / SCAN_S
    assert np.sort(np.abs(acceleration))[:-4].max() <= 501.0
    assert np.abs(np.diff(velocity, axis=1)).max() <= 1.0 + 2 * 500.0 * SCAN_S
    assert rig.board.errorreg & ~ErrorReg.ProfileTooSmall == 0
    assert [axis.rp for axis in rig.board.axes] == pytest.approx([20.0, 20.0, 0.0])


@pytest.mark.covers("apci.rule.lookahead")
def test_special_functions_do_not_brake_a_path() -> None:
    rig = Rig()
    rig.board.modereg = ModeReg.lookahead
    mlr(rig.board, (0, 1), (20.0, 0.0), FAST, spool=True)
    ssf(rig.board, 0, 5, 1)
    mlr(rig.board, (0, 1), (20.0, 0.0), LAST, spool=True)
    ssms(rig.board, (0, 1))
    assert rig.scans_until_end() == scans_for(1.0 + 0.08)
    assert rig.board.state.ci[5] == 1


@pytest.mark.covers("apci.ErrorReg.17.SpoolerDeepTooLess")
def test_a_profile_that_came_too_late_for_the_look_ahead() -> None:
    rig = Rig()
    rig.board.modereg = ModeReg.lookahead
    mlr(rig.board, (0, 1), (20.0, 0.0), FAST, spool=True)
    mlr(rig.board, (0, 1), (20.0, 0.0), FAST, spool=True)
    ssms(rig.board, (0, 1))
    rig.board.advance(100)
    mlr(
        rig.board, (0, 1), (20.0, 0.0), LAST, spool=True
    )  # in time: the second can still be quicker at its end
    assert rig.board.errorreg == 0
    rig.board.advance(scans_for(1.45) - 100)
    mlr(rig.board, (0, 1), (20.0, 0.0), LAST, spool=True)  # the third runs already, and comes to rest
    assert rig.board.errorreg == 0  # as it was programmed
    rig.scans_until_end()
    mlr(rig.board, (0, 1), (20.0, 0.0), FAST, spool=True)
    ssms(rig.board, (0, 1))
    rig.board.advance(100)
    mlr(rig.board, (0, 1), (20.0, 0.0), LAST, spool=True)
    assert rig.board.errorreg == ErrorReg.SpoolerDeepTooLess
    rig.scans_until_end()
    assert rig.board.axes[0].rp == pytest.approx(120.0)


@pytest.mark.covers(
    "apci.MODEREG.7.maxcheck", "apci.var.MaxVel", "apci.var.MaxAcc", "apci.wrMaxVel", "apci.wrMaxAcc"
)
@pytest.mark.parametrize("spool", [False, True])
@pytest.mark.parametrize("mode", [0, ModeReg.maxcheck])
def test_axis_limits_on_spooled_lines(mode: int, spool: bool) -> None:
    rig = Rig()
    rig.board.modereg = mode
    rig.board.axes[1].MaxVel, rig.board.axes[1].MaxAcc = 16.0, 80.0
    mla(rig.board, (0, 1), (30.0, 40.0), LAST, spool=spool)
    ssms(rig.board, (0, 1))
    rig.board.advance(0 if spool else 2)
    rig.forget()
    scans = rig.scans_until_end()
    limited = spool and mode
    # The second axis has 0.8 of the path: 20 mm/s and 100 mm/s2 at most.
    assert scans == scans_for(50.0 / 20.0 + 20.0 / 100.0 if limited else 50.0 / 40.0 + 40.0 / 500.0)
    velocity = np.diff(rig.setpoints(1)) / SCAN_S
    assert velocity.max() == pytest.approx(16.0 if limited else 32.0)
    assert np.abs(np.diff(velocity)).max() / SCAN_S == pytest.approx(80.0 if limited else 400.0)
