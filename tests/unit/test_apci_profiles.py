"""Every special case of the board's profiles: its numbers, and every setpoint against an integration of our own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from polycnc.controllers.apci.board._axis_commands import cl, ol, ra, utrovr
from polycnc.controllers.apci.board._jog_commands import ja, jr, js
from polycnc.controllers.apci.board._move_commands import Speeds, mla, mlr
from polycnc.controllers.apci.board._spool_commands import ssms
from support.apci_bits import Axst, ErrorReg, ModeReg
from support.apci_rig import LATENCY, SCAN_S, Rig, integrated, scans_for

A = 100.0
TOP = 50.0


def moving_at(velocity: float) -> Rig:
    """Return a rig whose axis 0 goes on with `velocity`, past the end of a jog."""
    rig = Rig()
    sign = math.copysign(1.0, velocity)
    rig.set_jog(jac=1e5, jdec=1e5, jvl=abs(velocity), jtvl=abs(velocity))
    jr(rig.board, (0,), (sign * 10.0,))
    rig.scans_until_end((0,))
    assert rig.board.axes[0].dv == pytest.approx(velocity)
    return rig


def begin(rig: Rig) -> float:
    """Let a direct command take effect; return where the axis is then, and keep setpoints from there."""
    rig.board.advance(LATENCY)
    rig.forget()
    return float(rig.board.kernel.base[0])


def check_against_integration(
    rig: Rig, start: float, expected: tuple[np.ndarray, ...], tolerance: float
) -> None:
    """Compare every setpoint up to the end of the integrated profile."""
    times, positions, _ = expected
    found = rig.setpoints() - start
    at = np.arange(1, len(found) + 1) * SCAN_S
    inside = at < times[-1]
    assert inside.sum() > 5
    wanted = np.interp(at[inside], times, positions)
    assert np.abs(found[inside] - wanted).max() < tolerance


JOGS = {  # what it shows: the row, then distance, first, jvl, jtvl, jac, jdec, duration
    "trapezoid": ("apci.profile.trapezoid", 100, 0, 50, 0, 100, 100, 2.5),
    "triangle": ("apci.profile.jog.case.triangular", 10, 0, 50, 0, 100, 100, 0.632456),
    "two slopes": ("apci.profile.jog.brake_ramp", 100, 0, 50, 0, 100, 50, 2.75),
    "too fast": ("apci.profile.jog.case.v0_gt_vmax", 100, 80, 50, 0, 100, 100, 2.16),
    "wrong way": ("apci.profile.jog.case.wrong_direction", 100, -30, 50, 0, 100, 100, 2.89),
    "comes back": ("apci.profile.jog.case.negative_target_velocity", 100, 0, 50, -20, 100, 100, 2.74),
    "at top": ("apci.profile.jog.case.v0_eq_vmax", 100, 50, 50, 0, 100, 100, 2.25),
    "goes on": ("apci.profile.jog.case.vt_eq_vmax", 100, 0, 50, 50, 100, 100, 2.25),
    "all at once": ("apci.profile.jog.preconditions", 100, 0, 50, 20, 80, 40, None),
}


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("distance", "first", "jvl", "jtvl", "jac", "jdec", "duration"),
    [
        pytest.param(*numbers, id=shows, marks=pytest.mark.covers(row))
        for shows, (row, *numbers) in JOGS.items()
    ],
)
def test_jogs(
    distance: float,
    first: float,
    jvl: float,
    jtvl: float,
    jac: float,
    jdec: float,
    duration: float | None,
    sign: float,
) -> None:
    rig = moving_at(sign * first) if first else Rig()
    rig.set_jog(jac=jac, jdec=jdec, jvl=jvl, jtvl=jtvl)
    jr(rig.board, (0,), (sign * distance,))
    start = begin(rig)
    expected = integrated(distance, first, jvl, jtvl, jac, jdec)
    scans = rig.scans_until_end((0,))
    mirrored = (expected[0], sign * expected[1], expected[2])
    check_against_integration(rig, start, mirrored, 2e-3)
    if duration is None:
        duration = float(expected[0][-1])
    assert expected[0][-1] == pytest.approx(duration, abs=2e-3)
    assert scans in (scans_for(duration), scans_for(duration) + (jtvl != 0.0))
    assert rig.board.axes[0].dv == pytest.approx(sign * jtvl)
    if jtvl == 0.0:
        assert rig.setpoints()[-1] == start + sign * distance
    if jtvl < 0.0:
        assert (sign * (rig.setpoints() - start)).max() == pytest.approx(102.0, abs=1e-3)
    if first < 0.0:
        assert (sign * (rig.setpoints() - start)).min() == pytest.approx(-4.5, abs=1e-3)
    # No velocity step anywhere: no second difference above the ramps.
    positions = np.concatenate(([start], rig.setpoints()))
    steps = np.diff(positions, 2) / SCAN_S**2
    assert np.abs(steps).max() <= max(jac, jdec) * 1.0001


@pytest.mark.covers("apci.profile.target_position", "apci.jr", "apci.ja")
def test_targets_absolute_from_machine_zero_and_relative_from_here() -> None:
    rig = Rig()
    rig.set_jog()
    ja(rig.board, (0,), (5.0,))
    rig.scans_until_end()
    jr(rig.board, (0, 1), (-2.0, 3.0))
    rig.scans_until_end()
    assert [axis.rp for axis in rig.board.axes] == [3.0, 3.0, 0.0]
    ja(rig.board, (0,), (5.0,))
    rig.scans_until_end()
    mla(rig.board, (0, 1), (1.0, -1.0), Speeds(A, TOP))
    rig.scans_until_end()
    mlr(rig.board, (1,), (0.25,), Speeds(A, TOP))
    rig.scans_until_end()
    assert [axis.rp for axis in rig.board.axes] == [1.0, -0.75, 0.0]


@pytest.mark.covers("apci.profile.acceleration", "apci.profile.jog.brake_ramp")
def test_negative_jog_acceleration_sets_the_braking_ramp_only() -> None:
    rig = Rig()
    axis = rig.board.axes[0]
    axis.jvl, axis.jac = TOP, A
    axis.jac = -50.0
    assert axis.jac == A
    jr(rig.board, (0,), (100.0,))
    begin(rig)
    assert rig.scans_until_end() == scans_for(2.75)
    velocity = np.diff(rig.setpoints()) / SCAN_S
    assert velocity[40] - velocity[39] == pytest.approx(A * SCAN_S)
    assert velocity[-40] - velocity[-39] == pytest.approx(50.0 * SCAN_S)
    axis.jac = 200.0  # both are equal again
    assert axis.jdec == 200.0


@pytest.mark.covers("apci.profile.target_velocity", "apci.profile.jog.case.vt_eq_vmax")
def test_target_velocity_goes_the_way_of_travel_and_goes_on() -> None:
    rig = Rig()
    rig.set_jog(jtvl=30.0)
    jr(rig.board, (0,), (-20.0,))
    rig.scans_until_end()
    assert rig.bits() & Axst.pe
    before = rig.board.axes[0].dp
    rig.board.advance(100)
    assert rig.board.axes[0].dp - before == pytest.approx(-30.0 * 100 * SCAN_S)
    assert rig.bits() & Axst.pe


@pytest.mark.covers("apci.profile.jog.jump.short_distance")
def test_jog_too_short_to_brake_jumps_at_its_end() -> None:
    rig = moving_at(50.0)
    rig.set_jog()
    jr(rig.board, (0,), (10.0,))  # 12.5 would do
    start = begin(rig)
    rig.scans_until_end()
    velocity = np.diff(np.concatenate(([start], rig.setpoints()))) / SCAN_S
    assert rig.setpoints()[-1] == start + 10.0
    left = math.sqrt(50.0**2 - 2.0 * A * 10.0)  # 22.36 mm/s
    assert velocity[-2] == pytest.approx(left, abs=2.0 * A * SCAN_S)
    assert np.diff(velocity[:-1]) == pytest.approx(-A * SCAN_S)
    assert rig.board.axes[0].dv == 0.0


@pytest.mark.covers("apci.profile.jog.jump.vt_gt_vmax", "apci.profile.move.jump.vt_gt_vmax")
@pytest.mark.parametrize("move", [False, True])
def test_target_velocity_above_the_maximum_is_jumped_to_at_the_end(move: bool) -> None:
    rig = Rig()
    rig.set_jog(jtvl=70.0)
    if move:
        mlr(rig.board, (0,), (50.0,), Speeds(A, TOP, 70.0))
    else:
        jr(rig.board, (0,), (50.0,))
    begin(rig)
    rig.scans_until_end()
    velocity = np.diff(rig.setpoints()) / SCAN_S
    assert velocity[:-1].max() == pytest.approx(TOP)
    assert rig.board.axes[0].dv == pytest.approx(70.0)
    before = rig.board.axes[0].dp
    rig.board.advance(10)
    assert rig.board.axes[0].dp - before == pytest.approx(70.0 * 10 * SCAN_S)


@pytest.mark.covers("apci.profile.jog.vmax_nonpositive", "apci.profile.max_velocity")
def test_jog_without_positive_velocity_runs_endlessly_the_wrong_way() -> None:
    rig = Rig()
    rig.set_jog(jvl=-20.0)
    jr(rig.board, (0,), (5.0,))
    rig.board.advance(LATENCY + 3000)
    assert rig.board.axes[0].dp == pytest.approx(-20.0 * 3000 * SCAN_S + 2.0, abs=0.05)  # 0.2 s of ramp: 2 mm
    assert not rig.bits() & Axst.pe
    assert rig.board.axes[0].dv == pytest.approx(-20.0)


MOVES = [
    pytest.param(
        100, 0, 50, 0, 2.5, id="trapezoid", marks=pytest.mark.covers("apci.profile.move.trajectory_velocity")
    ),
    pytest.param(
        10, 0, 50, 0, 0.632456, id="triangle", marks=pytest.mark.covers("apci.profile.move.case.triangular")
    ),
    pytest.param(
        100, 80, 50, 0, 2.16, id="too fast", marks=pytest.mark.covers("apci.profile.move.case.v0_gt_vmax")
    ),
    pytest.param(
        100, 50, 50, 0, 2.25, id="at top", marks=pytest.mark.covers("apci.profile.move.case.v0_eq_vmax")
    ),
    pytest.param(
        100, 0, 50, 50, 2.25, id="goes on", marks=pytest.mark.covers("apci.profile.move.case.vt_eq_vmax")
    ),
    pytest.param(
        100,
        0,
        50,
        -20,
        2.74,
        id="comes back",
        marks=pytest.mark.covers("apci.profile.move.case.negative_target_velocity"),
    ),
    pytest.param(
        100, 30, 50, 20, None, id="equal ramps", marks=pytest.mark.covers("apci.profile.move.single_ramp")
    ),
]


@pytest.mark.parametrize(("distance", "first", "vl", "tvl", "duration"), MOVES)
def test_direct_moves(distance: float, first: float, vl: float, tvl: float, duration: float | None) -> None:
    rig = moving_at(first) if first else Rig()
    start_y = float(rig.board.kernel.base[1])
    mlr(rig.board, (0, 1), (distance, 0.0), Speeds(A, vl, tvl))
    start = begin(rig)
    expected = integrated(distance, first, vl, tvl, A, A)
    scans = rig.scans_until_end((0, 1))
    check_against_integration(rig, start, expected, 2e-3)
    duration = float(expected[0][-1]) if duration is None else duration
    assert expected[0][-1] == pytest.approx(duration, abs=2e-3)
    assert scans in (scans_for(duration), scans_for(duration) + (tvl != 0.0))
    assert np.all(rig.setpoints(1) == start_y)
    assert rig.board.axes[0].dv == pytest.approx(tvl)


@pytest.mark.covers("apci.profile.move.case.v0_gt_vmax", "apci.mode.spool")
def test_spooled_move_lowers_a_velocity_above_its_own_at_once() -> None:
    rig = Rig()
    mlr(rig.board, (0,), (32.0,), Speeds(A, 80.0, 80.0), spool=True)  # 80 mm/s where it ends
    mlr(rig.board, (0,), (100.0,), Speeds(A, TOP), spool=True)
    ssms(rig.board, (0,))
    scans = rig.scans_until_end()
    assert scans == scans_for(0.8 + 2.25)
    velocity = np.diff(rig.setpoints()) / SCAN_S
    corner = scans_for(0.8)
    assert velocity[corner - 3] > 79.0
    assert velocity[corner] == pytest.approx(TOP)


@pytest.mark.covers("apci.profile.move.short_accel")
def test_move_too_short_for_its_target_velocity_takes_what_can_be_reached() -> None:
    rig = Rig()
    mlr(rig.board, (0,), (1.0,), Speeds(A, TOP, TOP))
    rig.scans_until_end()
    assert rig.board.axes[0].dv == pytest.approx(14.1421, abs=1e-4)
    before = rig.board.axes[0].dp
    rig.board.advance(1)
    assert rig.board.axes[0].dp - before == pytest.approx(14.1421 * SCAN_S, abs=1e-6)


@pytest.mark.covers("apci.profile.move.jump.short_brake")
def test_move_too_short_to_brake_begins_slower() -> None:
    rig = moving_at(50.0)
    mlr(rig.board, (0,), (1.0,), Speeds(A, TOP))
    start = begin(rig)
    rig.scans_until_end()
    velocity = np.diff(np.concatenate(([start], rig.setpoints()))) / SCAN_S
    assert velocity[0] == pytest.approx(14.1421 - 0.5 * A * SCAN_S, abs=1e-3)
    assert np.diff(velocity[:-1]) == pytest.approx(-A * SCAN_S)
    assert rig.setpoints()[-1] == start + 1.0


@pytest.mark.covers("apci.profile.move.jump.direction_change", "apci.interp.linear")
def test_move_another_way_keeps_the_magnitude_of_the_velocity() -> None:
    rig = Rig()
    mlr(rig.board, (0, 1), (300.0, 400.0), Speeds(A, TOP))
    rig.board.advance(LATENCY + scans_for(1.0))
    assert [rig.board.axes[i].dv for i in (0, 1)] == pytest.approx([30.0, 40.0])
    mlr(rig.board, (0, 1), (-40.0, 30.0), Speeds(A, TOP))
    start = np.array([0.0, 0.0])
    rig.board.advance(LATENCY)
    start = rig.board.kernel.base[:2].copy()
    rig.board.advance(1)
    assert [rig.board.axes[i].dv for i in (0, 1)] == pytest.approx([-40.0, 30.0])
    assert rig.board.kernel.base[:2] - start == pytest.approx(np.array([-40.0, 30.0]) * SCAN_S)


@pytest.mark.covers("apci.profile.move.preconditions", "apci.axst.8.dhef", "apci.rule.dhef_reset")
@pytest.mark.covers("apci.profile.acceleration", "apci.profile.max_velocity")
@pytest.mark.covers("apci.ErrorReg.12.VelocityZero", "apci.ErrorReg.13.AccelZero")
@pytest.mark.parametrize(
    "speeds", [Speeds(-A, TOP), Speeds(A, -TOP), Speeds(A, math.nan), Speeds(A, math.inf)]
)
@pytest.mark.parametrize("spool", [False, True])
def test_move_with_impossible_speeds_is_discarded(speeds: Speeds, spool: bool) -> None:
    rig = Rig()
    free = rig.free_entries()
    mlr(rig.board, (0, 1), (10.0, 0.0), speeds, spool=spool)
    ssms(rig.board, (0, 1))
    rig.board.advance(20)
    assert rig.bits() & Axst.pe
    assert rig.board.axes[0].dp == 0.0
    assert rig.free_entries() == free
    assert rig.board.errorreg == 0  # below 0 is not 0
    assert [bool(rig.bits(i) & Axst.dhef) for i in rig.all] == [True, True, False]
    for command in (ol, cl, js):
        command(rig.board, (0, 1))
        rig.board.advance(2)
        assert rig.bits() & Axst.dhef
    ra(rig.board, (0,))
    assert [bool(rig.bits(i) & Axst.dhef) for i in rig.all] == [False, True, False]
    rig.board.reset()
    assert not rig.bits(1) & Axst.dhef


@pytest.mark.covers(
    "apci.ErrorReg.12.VelocityZero", "apci.ErrorReg.13.AccelZero", "apci.MODEREG.InhibitProfileRefuse"
)
@pytest.mark.parametrize(
    ("speeds", "error"), [(Speeds(A, 0.0), ErrorReg.VelocityZero), (Speeds(0.0, TOP), ErrorReg.AccelZero)]
)
def test_move_without_velocity_or_acceleration(speeds: Speeds, error: int) -> None:
    rig = Rig()
    mlr(rig.board, (0,), (10.0,), speeds)
    rig.board.advance(LATENCY + 1)
    assert rig.board.errorreg == error
    assert rig.bits() & Axst.pe
    # Not refused: nothing can move it, so the profile lasts until something ends it.
    rig.board.modereg = ModeReg.InhibitProfileRefuse
    mlr(rig.board, (0,), (10.0,), speeds)
    rig.board.advance(1000)
    assert not rig.bits() & Axst.pe
    assert rig.board.axes[0].dp == 0.0
    mlr(rig.board, (0,), (10.0,), Speeds(A, TOP))
    rig.scans_until_end()
    assert rig.board.axes[0].dp == 10.0


@pytest.mark.covers("apci.js", "apci.var.sdec")
def test_stop_with_and_without_ramp() -> None:
    rig = Rig()
    rig.set_jog(jac=1000.0, jdec=1000.0)
    rig.board.axes[0].sdec = 200.0
    jr(rig.board, (0,), (1000.0,))
    rig.board.advance(200)
    start = rig.board.axes[0].dp
    js(rig.board, (0,))
    assert not rig.bits() & Axst.pe
    assert rig.scans_until_end() == scans_for(0.25)
    assert rig.board.axes[0].dp - start == pytest.approx(6.25)
    assert rig.bits() & Axst.cl
    jr(rig.board, (0,), (1000.0,))
    rig.board.advance(200)
    rig.board.axes[0].sdec = 0.0
    start = rig.board.axes[0].dp
    js(rig.board, (0,))
    assert rig.scans_until_end() <= 1
    assert rig.board.axes[0].dp == start


@pytest.mark.parametrize(
    ("jerkrel", "used", "peak", "edge"),
    [
        (0.2, 0.2, 120.0, 0.0833333),
        (1.0, 1.0, 200.0, 0.25),
        (0.0, 0.0, 100.0, 0.0),
        (-0.5, 0.0, 100.0, 0.0),
        (3.0, 1.0, 200.0, 0.25),
    ],
)
@pytest.mark.covers("apci.jerkrel", "apci.rule.sprofile", "apci.MODEREG.SProfile")
def test_s_profile_bends_the_ramp_and_keeps_its_mean(
    jerkrel: float, used: float, peak: float, edge: float
) -> None:
    rig = Rig()
    assert rig.board.axes[0].jerkrel == 1.0
    rig.board.axes[0].jerkrel = jerkrel
    assert rig.board.axes[0].jerkrel == used
    rig.board.modereg = ModeReg.SProfile
    rig.set_jog()
    jr(rig.board, (0,), (100.0,))
    begin(rig)
    assert rig.scans_until_end() == scans_for(2.5)  # mean acceleration, duration and distance stay
    positions = np.concatenate(([0.0], rig.setpoints()))
    acceleration = np.diff(positions, 2) / SCAN_S**2
    assert acceleration.max() == pytest.approx(peak, rel=0.01)
    ramp = scans_for(0.5)
    mean = np.diff(positions)[ramp] / SCAN_S / 0.5
    assert mean == pytest.approx(A, rel=1e-3)
    rising = np.flatnonzero(acceleration[:ramp] > 0.99 * peak)[0] * SCAN_S
    assert rising == pytest.approx(edge, abs=4 * SCAN_S)
    # Without the mode jerkrel says nothing.
    rig.board.modereg = 0
    jr(rig.board, (0,), (-100.0,))
    begin(rig)
    rig.scans_until_end()
    assert np.abs(np.diff(rig.setpoints(), 2)).max() / SCAN_S**2 == pytest.approx(A)


@pytest.mark.covers("apci.profile.override")
def test_override_acts_on_velocity_and_acceleration_alike() -> None:
    rig = Rig()
    rig.set_jog()
    rig.board.axes[0].jovr = 0.5
    jr(rig.board, (0,), (100.0,))
    begin(rig)
    assert rig.scans_until_end() == scans_for(4.5)
    check_against_integration(rig, 0.0, integrated(100.0, 0.0, 25.0, 0.0, 50.0, 50.0), 2e-3)
    rig.board.trovr = 0.5
    mlr(rig.board, (1,), (100.0,), Speeds(A, TOP))
    rig.board.advance(LATENCY)
    assert rig.scans_until_end() == scans_for(2.5)  # only stored
    utrovr(rig.board, (1,))
    mlr(rig.board, (1,), (100.0,), Speeds(A, TOP))
    rig.board.advance(LATENCY)
    assert rig.scans_until_end() == scans_for(4.5)
