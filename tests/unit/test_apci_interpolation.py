"""Lines, circles, helices, circles in space: geometry, path velocity, units, rotary axes, what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from polycnc.controllers.apci.board._axis_commands import szpa
from polycnc.controllers.apci.board._jog_commands import ja, jr, js, ms, ms_of_pc
from polycnc.controllers.apci.board._move_commands import (
    Speeds,
    mca,
    mca3d,
    mcr,
    mcr3d,
    mha,
    mhr,
    mla,
    mlr,
)
from polycnc.controllers.apci.board._spool_commands import ssms
from polycnc.controllers.apci.board._units import PositionUnit, TimeUnit
from support.apci_bits import Axst, ErrorReg, ModeReg
from support.apci_rig import LATENCY, SCAN_S, Floats, Rig, scans_for

FAST = Speeds(500.0, 40.0)


def at(rig: Rig, *positions: float) -> None:
    """Bring the first axes to positions."""
    ja(rig.board, range(len(positions)), positions)
    rig.scans_until_end()
    rig.forget()


def places(rig: Rig) -> list[float]:
    """Return all actual positions."""
    return [axis.rp for axis in rig.board.axes]


def speeds_along(rig: Rig, *axes: int) -> Floats:
    """Return the path velocity of every scan."""
    return np.array(np.hypot.reduce([np.diff(rig.setpoints(i)) for i in axes])) / SCAN_S


@pytest.mark.covers("apci.interp.linear", "apci.interp.general", "apci.profile.move.trajectory_velocity")
def test_axes_of_a_line_stay_on_it_and_end_together() -> None:
    rig = Rig()
    mlr(rig.board, (2, 0), (30.0, -40.0), FAST)
    rig.board.advance(LATENCY)
    rig.forget()
    assert rig.scans_until_end() == scans_for(50.0 / 40.0 + 40.0 / 500.0)
    assert places(rig) == [-40.0, 0.0, 30.0]
    assert rig.setpoints(0) * 30.0 == pytest.approx(rig.setpoints(2) * -40.0)
    assert speeds_along(rig, 0, 2).max() == pytest.approx(40.0)


@pytest.mark.covers("apci.interp.formal")
def test_axis_without_distance_takes_part_formally() -> None:
    rig = Rig()
    rig.board.kernel.base[1] = -7.0  # it stands there
    mlr(rig.board, (0, 1), (10.0, 0.0), Speeds(500.0, 40.0, 40.0), spool=True)
    mlr(rig.board, (0, 1), (10.0, 20.0), FAST, spool=True)
    ssms(rig.board, (0, 1))
    rig.board.advance(scans_for(0.1))
    assert not rig.bits(1) & Axst.pe
    assert rig.board.axes[1].dp == -7.0
    rig.scans_until_end()
    assert places(rig) == [20.0, 13.0, 0.0]
    assert not rig.bits(1) & Axst.saf
    x, y = rig.setpoints(0), rig.setpoints(1)
    assert set(y[x <= 10.0]) == {-7.0}
    assert y[x > 10.0] == pytest.approx(2.0 * (x[x > 10.0] - 10.0) - 7.0)


@pytest.mark.covers("apci.interp.circular")
@pytest.mark.parametrize("spool", [False, True])
@pytest.mark.parametrize(
    ("phi", "end", "length"),
    [(90.0, (0.0, 10.0), 15.70796), (-90.0, (0.0, -10.0), 15.70796), (720.0, (10.0, 0.0), 125.66371)],
)
def test_circles_absolute_and_relative(
    phi: float, end: tuple[float, float], length: float, spool: bool
) -> None:
    for command, center in ((mca, (0.0, 0.0)), (mcr, (-10.0, 0.0))):
        rig = Rig()
        at(rig, 10.0, 0.0)
        command(rig.board, (0, 1), center, phi, FAST, spool=spool)
        ssms(rig.board, (0, 1))
        rig.board.advance(0 if spool else LATENCY)
        rig.forget()
        assert rig.scans_until_end() == scans_for(length / 40.0 + 40.0 / 500.0)
        assert places(rig)[:2] == pytest.approx(end, abs=1e-12)
        assert np.hypot(rig.setpoints(0), rig.setpoints(1)) == pytest.approx(10.0, abs=1e-12)
        angles = np.unwrap(np.arctan2(rig.setpoints(1), rig.setpoints(0)))
        assert np.all(np.diff(angles) * phi > 0.0)
        assert speeds_along(rig, 0, 1).max() == pytest.approx(40.0, rel=1e-4)


@pytest.mark.covers("apci.mha", "apci.mhr")
@pytest.mark.covers("apci.interp.helical")
@pytest.mark.parametrize("relative", [False, True])
def test_helix_all_axes_end_together(relative: bool) -> None:
    rig = Rig()
    at(rig, 10.0, 0.0, 1.0)
    if relative:
        mhr(rig.board, (0, 1, 2), (-10.0, 0.0), 180.0, (0.0, 0.0, 5.0), FAST)
    else:
        mha(rig.board, (0, 1, 2), (0.0, 0.0), 180.0, (0.0, 0.0, 6.0), FAST)
    rig.board.advance(LATENCY)
    rig.forget()
    length = math.hypot(10.0 * math.pi, 5.0)
    assert rig.scans_until_end() == scans_for(length / 40.0 + 40.0 / 500.0)
    assert places(rig) == pytest.approx([-10.0, 0.0, 6.0], abs=1e-12)
    turned = np.arctan2(rig.setpoints(1), rig.setpoints(0))[:-1] / math.pi
    assert (rig.setpoints(2)[:-1] - 1.0) / 5.0 == pytest.approx(turned)


@pytest.mark.covers("apci.mha")
@pytest.mark.covers("apci.interp.helical", "apci.const.phithreshold")
@pytest.mark.parametrize(
    ("phi", "target", "end", "turn_deg"),
    [
        (-1e-101, (0.0, 10.0), (0.0, 10.0), -270.0),
        (1e-101, (0.0, 10.0), (0.0, 10.0), 90.0),
        (-1e-100, (0.0, 11.0), (0.0, 10.0), -270.0),
        (1e-101, (10.0, 0.0), (10.0, 0.0), 360.0),
    ],
)
def test_helix_to_a_target_point(
    phi: float, target: tuple[float, float], end: tuple[float, float], turn_deg: float
) -> None:
    rig = Rig()
    at(rig, 10.0, 0.0)
    mha(rig.board, (0, 1, 2), (0.0, 0.0), phi, (*target, 2.0), FAST)
    rig.scans_until_end()
    assert places(rig) == pytest.approx([*end, 2.0], abs=1e-12)
    angles = np.unwrap(np.arctan2(rig.setpoints(1), rig.setpoints(0)))
    assert math.degrees(angles[-1]) == pytest.approx(turn_deg)


@pytest.mark.covers("apci.mca3d", "apci.mcr3d", "apci.interp.general")
def test_circle_in_space() -> None:
    rig = Rig()
    at(rig, 10.0, 0.0, 0.0)
    mca3d(rig.board, (0, 1, 2), (0.0, 0.0, 0.0), (0.0, -2.0, 2.0), 90.0, FAST)
    rig.scans_until_end()
    root = 10.0 / math.sqrt(2.0)
    assert places(rig) == pytest.approx([0.0, root, root], abs=1e-12)
    rig.forget()
    mcr3d(rig.board, (0, 1, 2), (0.0, -root, -root), (0.0, -1.0, 1.0), -90.0, FAST)
    rig.scans_until_end()
    assert places(rig) == pytest.approx([10.0, 0.0, 0.0], abs=1e-12)
    radii = np.sqrt(sum(rig.setpoints(i) ** 2 for i in range(3)))
    assert radii == pytest.approx(10.0)


PIPE = """
[[axis]]
name = "X"
[[axis]]
name = "C"
unit = "deg"
slsp = 3600
gf = 1
"""


@pytest.mark.covers("apci.interp.surface", "apci.var.effradius", "apci.MODEREG.10.rotaxisunit")
@pytest.mark.parametrize(
    ("in_degrees", "turned_deg", "length"), [(False, 34.377, 65.0), (True, 60.0, 107.66)]
)
def test_pipe_of_200_mm(in_degrees: bool, turned_deg: float, length: float) -> None:
    rig = Rig(PIPE)
    rig.board.axes[1].effradius = 100.0
    rig.board.modereg = ModeReg.rotaxisunit if in_degrees else 0
    mlr(rig.board, (0, 1), (25.0, 60.0), FAST)
    rig.board.advance(LATENCY)
    scans = rig.scans_until_end()
    assert places(rig) == pytest.approx([25.0, turned_deg], abs=1e-3)
    assert scans * SCAN_S == pytest.approx(length / 40.0 + 40.0 / 500.0, abs=SCAN_S)


@pytest.mark.covers("apci.ErrorReg.2.errUnit", "apci.interp.surface")
def test_rotary_axis_without_radius_does_not_go_with_millimetres() -> None:
    rig = Rig(PIPE)
    mlr(rig.board, (0, 1), (25.0, 60.0), FAST)
    rig.board.advance(LATENCY + 5)
    assert rig.board.errorreg == ErrorReg.errUnit
    assert places(rig) == [0.0, 0.0]
    rig.board.variables.pu = 8
    mlr(rig.board, (0,), (25.0,), FAST)
    rig.board.advance(LATENCY + 5)
    assert places(rig) == [0.0, 0.0]
    rig.board.variables.pu = PositionUnit.rev
    mlr(rig.board, (1,), (0.5,), FAST)
    rig.scans_until_end()
    assert places(rig) == pytest.approx([0.0, 180.0])


@pytest.mark.covers("apci.TRU.pu", "apci.TRU.tu", "apci.profile.acceleration")
@pytest.mark.parametrize(
    ("unit", "time", "distance", "speeds"),
    [
        (PositionUnit.inch, TimeUnit.sec, 2.0, Speeds(500.0 / 25.4, 40.0 / 25.4)),
        (PositionUnit.m, TimeUnit.min, 0.0508, Speeds(0.5 * 3600.0, 0.04 * 60.0)),
        (PositionUnit.counts, TimeUnit.tsample, 50_800.0, Speeds(5e5 * SCAN_S**2, 4e4 * SCAN_S)),
    ],
)
def test_units_of_interpolation(unit: PositionUnit, time: TimeUnit, distance: float, speeds: Speeds) -> None:
    rig = Rig()
    rig.board.variables.pu, rig.board.variables.tu = int(unit), int(time)
    mlr(rig.board, (0,), (distance,), speeds)
    rig.board.advance(LATENCY)
    assert rig.scans_until_end() == scans_for(50.8 / 40.0 + 40.0 / 500.0)
    assert places(rig)[0] == pytest.approx(50.8)


@pytest.mark.covers("apci.NFRAX", "apci.wrnfrax")
def test_axes_that_do_not_count_for_the_path() -> None:
    rig = Rig()
    rig.board.nfrax = 0b100
    mlr(rig.board, (0, 2), (40.0, 300.0), FAST)
    rig.board.advance(LATENCY)
    rig.forget()
    assert rig.scans_until_end() == scans_for(40.0 / 40.0 + 40.0 / 500.0)
    assert places(rig) == [40.0, 0.0, 300.0]
    assert np.diff(rig.setpoints(0)).max() / SCAN_S == pytest.approx(40.0)
    mlr(rig.board, (0, 2), (0.0, -20.0), FAST)  # nothing else moves: the feed is theirs
    rig.board.advance(LATENCY)
    assert rig.scans_until_end() == scans_for(20.0 / 40.0 + 40.0 / 500.0)
    assert places(rig) == [40.0, 0.0, 280.0]


@pytest.mark.covers("apci.interp.sync")
def test_several_interpolations_and_a_jog_at_once() -> None:
    rig = Rig(axes=5)
    at(rig, 10.0, 0.0, 5.0, 0.0)
    mca(rig.board, (0, 1), (0.0, 0.0), 360.0, FAST, spool=True)
    mca(rig.board, (2, 3), (0.0, 0.0), -360.0, FAST, spool=True)
    ssms(rig.board, (0, 1, 2, 3))
    jr(rig.board, (4,), (-3.0,))
    first = rig.scans_until_end((2, 3))
    assert first == scans_for(10.0 * math.pi / 40.0 + 0.08)
    assert rig.scans_until_end() > 0
    assert places(rig) == pytest.approx([10.0, 0.0, 5.0, 0.0, -3.0], abs=1e-12)
    assert np.hypot(rig.setpoints(0), rig.setpoints(1)) == pytest.approx(10.0)
    assert np.hypot(rig.setpoints(2), rig.setpoints(3)) == pytest.approx(5.0)
    assert not any(rig.bits(i) & Axst.saf for i in rig.all)


REFUSED = [
    ("twice", lambda rig: mlr(rig.board, (0, 0), (1.0, 1.0), FAST), ErrorReg.errAxDef),
    ("jog twice", lambda rig: jr(rig.board, (0, 1, 0), (1.0, 1.0, 1.0)), ErrorReg.errAxDef),
    ("no way", lambda rig: mlr(rig.board, (0, 1), (0.0, 1e-12), FAST), ErrorReg.ZeroProfile),
    ("no angle", lambda rig: mcr(rig.board, (0, 1), (1.0, 0.0), 0.0, FAST), ErrorReg.ZeroProfile),
    (
        "no radius",
        lambda rig: mcr(rig.board, (0, 1), (0.0, 0.0), 90.0, FAST),
        ErrorReg.RadiusError | ErrorReg.errCenterPoint,
    ),
    (
        "no radius in space",
        lambda rig: mcr3d(rig.board, (0, 1, 2), (0.0, 0.0, 3.0), (0.0, 0.0, 1.0), 90.0, FAST),
        ErrorReg.RadiusError | ErrorReg.errCenterPoint,
    ),
]


@pytest.mark.covers("apci.ErrorReg.0.errAxDef", "apci.ErrorReg.3.errCenterPoint")
@pytest.mark.covers("apci.ErrorReg.15.ZeroProfile", "apci.ErrorReg.16.RadiusError")
@pytest.mark.parametrize(("name", "command", "error"), REFUSED)
def test_what_is_refused_sets_its_error_and_moves_nothing(name: str, command, error: int) -> None:  # type: ignore[no-untyped-def]
    rig = Rig()
    free = rig.free_entries()
    command(rig)
    rig.board.advance(LATENCY + 5)
    assert rig.board.errorreg == error, name
    assert rig.free_entries() == free
    assert places(rig) == [0.0, 0.0, 0.0]
    assert all(rig.bits(i) & Axst.pe for i in rig.all)
    # Errors stay, and what is right is carried out.
    jr(rig.board, (0,), (1.0,))
    rig.scans_until_end()
    assert places(rig)[0] == 1.0
    assert rig.board.errorreg == error


@pytest.mark.covers("apci.ms", "apci.MODEREG.15.MS_DECEL")
@pytest.mark.parametrize(("mode", "deceleration"), [(0, 500.0), (ModeReg.MS_DECEL, 100.0)])
def test_motion_stop_stays_on_the_circle(mode: int, deceleration: float) -> None:
    rig = Rig()
    at(rig, 20.0, 0.0)
    rig.board.modereg = mode
    mca(rig.board, (0, 1), (0.0, 0.0), 360.0, FAST)
    rig.board.advance(LATENCY + 800)
    rig.forget()
    begin = math.atan2(rig.board.axes[1].dp, rig.board.axes[0].dp)
    ms_of_pc(rig.board, (0, 1), 100.0)
    assert not rig.bits() & Axst.pe
    assert rig.scans_until_end() == scans_for(40.0 / deceleration)
    assert np.hypot(rig.setpoints(0), rig.setpoints(1)) == pytest.approx(20.0)
    angle = math.atan2(rig.board.axes[1].dp, rig.board.axes[0].dp) - begin
    assert angle % (2.0 * math.pi) * 20.0 == pytest.approx(40.0**2 / (2.0 * deceleration))
    assert rig.bits() & Axst.cl


@pytest.mark.covers("apci.var.sdec")
@pytest.mark.covers("apci.ms", "apci.js")
def test_motion_stop_of_what_is_past_its_end_uses_the_stop_deceleration() -> None:
    rig = Rig()
    for axis in rig.board.axes:
        axis.sdec = 200.0
    mlr(rig.board, (0, 1), (30.0, 40.0), Speeds(500.0, 50.0, 50.0))
    rig.scans_until_end()
    begin = [axis.dp for axis in rig.board.axes]
    ms(rig.board, (0, 1))
    rig.scans_until_end()
    moved = np.array([axis.dp for axis in rig.board.axes]) - begin
    assert moved[:2] == pytest.approx([30.0**2 / 400.0, 40.0**2 / 400.0])
    rig.set_jog(2, jdec=50.0)
    jr(rig.board, (2,), (1000.0,))
    rig.board.advance(1000)
    start = rig.board.axes[2].dp
    ms(rig.board, (2,))
    rig.scans_until_end()
    assert rig.board.axes[2].dp - start == pytest.approx(50.0**2 / 100.0)  # of the profile, not sdec


@pytest.mark.covers("apci.js")
def test_jog_stop_leaves_the_contour() -> None:
    rig = Rig()
    at(rig, 20.0, 0.0)
    mca(rig.board, (0, 1), (0.0, 0.0), 360.0, FAST)
    rig.board.advance(LATENCY + 800)
    for i, sdec in enumerate((50.0, 5000.0)):
        rig.board.axes[i].sdec = sdec
    js(rig.board, (0, 1))
    rig.scans_until_end()
    assert abs(math.hypot(rig.board.axes[0].dp, rig.board.axes[1].dp) - 20.0) > 1.0


@pytest.mark.covers("apci.szpa", "apci.mla")
def test_absolute_targets_with_a_zero_offset() -> None:
    rig = Rig()
    szpa(rig.board, 0, 5.0)
    mla(rig.board, (0, 1), (10.0, 1.0), FAST)
    rig.scans_until_end()
    assert places(rig) == [10.0, 1.0, 0.0]
    assert rig.setpoints(0)[-1] == 15.0
