"""Override: two steps for paths, settling, what copies and what resets it; nothing jumps that need not."""

from __future__ import annotations

import numpy as np
import pytest

from polycnc.controllers.apci.board._axis_commands import ra, utrovr
from polycnc.controllers.apci.board._jog_commands import jr
from polycnc.controllers.apci.board._move_commands import Speeds, mcr, mlr
from polycnc.controllers.apci.board._spool_commands import ssms
from support.apci_bits import Axst, ModeReg
from support.apci_rig import LATENCY, SCAN_S, Rig, scans_for

PATH = Speeds(100.0, 50.0)


@pytest.mark.covers("apci.wrtrovr", "apci.utrovr", "apci.wrtrovrst", "apci.profile.override")
def test_override_of_a_path_settles_in_its_time() -> None:
    rig = Rig()
    rig.board.trovrst = 2.0
    mlr(rig.board, (0, 1), (300.0, 400.0), PATH)
    rig.board.advance(LATENCY + scans_for(1.0))
    rig.board.trovr = 0.5
    rig.board.advance(100)
    assert rig.board.axes[0].dv == pytest.approx(30.0)  # written is not taken over
    utrovr(rig.board, (0, 1))
    rig.forget()
    assert rig.board.trovr == 0.5
    rig.board.advance(scans_for(0.5))
    assert rig.board.axes[0].jovr == pytest.approx(0.75, abs=1e-3)
    assert rig.board.axes[0].dv == pytest.approx(30.0 * 0.75, abs=0.1)
    rig.board.advance(scans_for(0.5) + 1)
    assert rig.board.axes[1].jovr == 0.5
    assert [rig.board.axes[i].dv for i in (0, 1)] == pytest.approx([15.0, 20.0], abs=0.1)
    velocity = np.diff(rig.setpoints(0)) / SCAN_S
    assert np.abs(np.diff(velocity)).max() <= 60.0 * SCAN_S * 1.001
    assert rig.setpoints(0) * 4.0 == pytest.approx(rig.setpoints(1) * 3.0)
    rig.scans_until_end()
    assert [axis.rp for axis in rig.board.axes] == [300.0, 400.0, 0.0]


@pytest.mark.covers("apci.MODEREG.OvrMode", "apci.wrjovr")
def test_override_of_a_path_is_copied_into_that_of_jogs_or_not() -> None:
    for mode, copied in ((0, 0.5), (ModeReg.OvrMode, 1.0)):
        rig = Rig()
        rig.board.modereg = mode
        rig.board.trovr = 0.5
        utrovr(rig.board, (0, 1))
        rig.board.advance(1)
        assert [axis.jovr for axis in rig.board.axes] == [copied, copied, 1.0]
        rig.board.axes[0].jovr = 0.0  # not above 0
        assert rig.board.axes[0].jovr == copied


@pytest.mark.covers("apci.rule.override_reset")
def test_what_resets_overrides() -> None:
    rig = Rig()
    rig.board.trovr = 0.5
    utrovr(rig.board, rig.all)
    rig.board.advance(1)
    ra(rig.board, (0,))
    row = rig.board.state.axis
    assert [axis.jovr for axis in rig.board.axes] == [1.0, 0.5, 0.5]
    assert list(row["tovr"]) == [1.0, 0.5, 0.5]
    assert rig.board.trovr == 0.5
    rig.board.reset()
    assert [axis.jovr for axis in rig.board.axes] == [1.0, 1.0, 1.0]
    assert list(row["tovr"]) == [1.0, 1.0, 1.0]
    assert rig.board.trovr == 1.0


@pytest.mark.covers("apci.profile.override", "apci.wrjovr")
@pytest.mark.parametrize("jerkrel", [0.0, 1.0])
@pytest.mark.parametrize("share", [0.3, 0.9, 0.97])
def test_a_lower_override_while_it_brakes_lets_a_profile_end_where_it_should(
    share: float, jerkrel: float
) -> None:
    rig = Rig()
    rig.board.modereg = ModeReg.SProfile
    rig.board.axes[0].jerkrel = jerkrel
    rig.set_jog()
    jr(rig.board, (0,), (100.0,))
    rig.board.advance(LATENCY + int(share * scans_for(2.5)))
    before = rig.board.axes[0].dv
    rig.forget()
    rig.board.advance(1)
    rig.board.axes[0].jovr = 0.5
    rig.scans_until_end()
    assert rig.setpoints()[-1] == 100.0
    velocity = np.diff(rig.setpoints()) / SCAN_S
    assert velocity[0] == pytest.approx(before, abs=1.0)
    assert np.abs(np.diff(velocity)).max() <= 100.0 * (1.0 + jerkrel) * SCAN_S * 1.6


@pytest.mark.covers("apci.profile.override", "apci.interp.circular")
def test_override_on_the_way_leaves_a_circle_round_and_axes_in_step() -> None:
    rig = Rig()
    rig.board.trovrst = 0.2
    for _ in range(3):
        mcr(rig.board, (0, 1), (-20.0, 0.0), 180.0, Speeds(300.0, 60.0, 60.0), spool=True)
        mcr(rig.board, (0, 1), (20.0, 0.0), 180.0, Speeds(300.0, 60.0, 60.0), spool=True)
    mcr(rig.board, (0, 1), (-20.0, 0.0), 180.0, Speeds(300.0, 60.0), spool=True)
    ssms(rig.board, (0, 1))
    for k, factor in enumerate((0.5, 1.7, 0.1, 2.0, 1.0, 0.3, 1.2) * 3):
        rig.board.advance(37 * (k % 5 + 1))
        rig.board.trovr = factor
        utrovr(rig.board, (0, 1))
    rig.scans_until_end()
    radius = np.hypot(rig.setpoints(0) + 20.0, rig.setpoints(1))
    assert radius == pytest.approx(20.0)
    assert not rig.bits() & Axst.saf
    assert [axis.rp for axis in rig.board.axes][:2] == pytest.approx([-40.0, 0.0], abs=1e-9)
