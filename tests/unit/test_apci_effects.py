"""What the registers do that a program writes: monitors, the position controller, gear factors, effective radii."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from polycnc.controllers.apci import pcap
from support.apci_bits import Axst, ModeReg
from support.apci_pc import LATENCY, SCAN_S, Pc, near

DRIVE = '[[axis]]\nkp = 20\njac = 100.0\njvl = 100.0\n[axis.plant]\nkind = "lag"\nvelocity_at_10_v = 500\n'


@pytest.fixture(autouse=True)
def _leave_no_board() -> Iterator[None]:
    yield
    pcap.detach()


def jog(pc: Pc, *axes: int, by: float) -> None:
    """Close the loops of axes and begin to jog them all by a distance."""
    selection = pc.close(*axes)
    for an in axes:
        pc.tsrp[an].tp = by
    pcap.jr(selection, pc.tsrp)
    pc.board.advance(LATENCY)


def bit(an: int, flag: int) -> bool:
    return pcap.rdaxstb(an, flag.bit_length()) == 1


# ------------------------------------------------------------------ monitors


@pytest.mark.covers("apci.rdPosErr")
@pytest.mark.covers("apci.wrmpe", "apci.TSRP.mpe", "apci.axst.7.mpe")
def test_the_position_error_is_watched_against_mpe_where_it_is_above_0() -> None:
    pc = Pc(DRIVE * 3)
    for an, limit in ((0, 4.75), (1, 5.25), (2, 0.0)):
        pcap.wrmpe(pcap.TSRP(an=an, mpe=limit))
    jog(pc, 0, 1, 2, by=300.0)
    for _ in range(12):
        pc.run(0.1)
        for an, limit in ((0, 4.75), (1, 5.25)):
            assert bit(an, Axst.mpe) == (pcap.rdPosErr(an) > limit)
        assert not bit(2, Axst.mpe)
    assert [pcap.rdPosErr(an) for an in range(3)] == near([5.0] * 3, rel=1e-3)  # 100 mm/s / 20
    assert [bit(an, Axst.mpe) for an in range(3)] == [True, False, False]
    pcap.wrmpe(pcap.TSRP(an=1, mpe=4.9))
    pcap.wrmpe(pcap.TSRP(an=0, mpe=0.0))
    pc.board.advance(1)
    assert [bit(an, Axst.mpe) for an in range(3)] == [False, True, False]


@pytest.mark.covers("apci.rdPosErr", "apci.axst.12.pe")
@pytest.mark.covers("apci.wripw", "apci.TSRP.ipw", "apci.axst.14.ip")
def test_the_axis_is_in_position_within_ipw_of_its_target_behind_the_end_of_the_profile() -> None:
    pc = Pc(DRIVE * 3)
    for an, window in ((0, 0.15), (1, 0.02), (2, 0.0)):
        pcap.wripw(pcap.TSRP(an=an, ipw=window))
    jog(pc, 0, 1, 2, by=30.0)
    first: dict[int, float] = {}
    for _ in range(1200):
        for an in range(2):
            ended = bit(an, Axst.pe)
            assert bit(an, Axst.ip) == (ended and abs(pcap.rdPosErr(an)) < (0.15, 0.02)[an])
            if bit(an, Axst.ip):
                first.setdefault(an, pc.board.time_s)
        assert not bit(2, Axst.ip)
        pc.board.advance(1)
    assert first[1] - first[0] == near(0.1007, abs=0.005)  # ln(0.15 / 0.02) / kp


# ------------------------------------------------------------------ the position controller

BASE = {"kp": 20.0, "ki": 0.0, "kd": 0.0, "kpl": 1.0, "kfca": 0.0, "kfcv": 0.0}
# While the velocity v grows by 100 mm/s every second the controller asks for kp e + ki Se + kd e' + kfcv v + kfca v',
# later by TA/2 where kpl is 0. 0.8 s after the start transients have died away, and the error e is, with v = 80 mm/s:
ERRORS = {
    "kp": (32.0, (80 - 100 / 32) / 32),
    "ki": (90.0, 100 / 90),
    "kd": (0.5, (80 - 1.5 * 100 / 20) / 20),
    "kpl": (0.0, (80 - 100 / 20 + 100 * 0.00064) / 20),
    "kfca": (0.12, (80 - 100 / 20 - 0.12 * 100) / 20),
    "kfcv": (0.6, 0.4 * (80 - 100 / 20) / 20),
}


@pytest.mark.covers("apci.uf", *(f"apci.TSRP.{name}" for name in BASE), "apci.ctrl.pidf")
def test_uf_sends_six_coefficients_that_act_at_once_on_their_own_axis() -> None:
    pc = Pc(DRIVE * 7)
    pcap.uf(pcap.TSRP(an=6, **BASE))
    for an, (name, (value, _)) in enumerate(ERRORS.items()):
        pcap.uf(pcap.TSRP(an=an, **{**BASE, name: value}))
    jog(pc, *range(7), by=300.0)
    pc.run(0.8)
    plain = (80 - 100 / 20) / 20
    assert pcap.rdPosErr(6) == near(plain, rel=2e-3)
    for an, (name, (_, error)) in enumerate(ERRORS.items()):
        found = pcap.rdPosErr(an) - pcap.rdPosErr(6)
        assert found == near(error - plain, rel=0.03, abs=5e-4), name
        assert abs(error - plain) > 1e-3 + 0.03 * abs(error - plain)
    pcap.uf(pcap.TSRP(an=6, **{**BASE, "kfcv": 1.0}))  # on the way
    pc.run(0.4)
    assert pcap.rdPosErr(6) == near(0.0, abs=0.01)


# ------------------------------------------------------------------ conversions


@pytest.mark.covers("apci.TSRP.rp", "apci.TSRP.dv", "apci.mlr")
@pytest.mark.covers("apci.wrgf", "apci.TSRP.gf", "apci.wrslsp", "apci.var.slsp")
@pytest.mark.parametrize("how", ["gf", "slsp"])
def test_gear_factor_and_resolution_convert_counts_to_the_unit_of_the_axis(how: str) -> None:
    pc = Pc("[[axis]]\nslsp = 4000.0\ngf = 0.25\n" * 2)
    axes = pc.close(0, 1)
    if how == "gf":
        pcap.wrgf(pcap.TSRP(an=0, gf=0.375))
    else:
        pcap.wrslsp(0, 6000.0)
    pcap.ctru(pcap.TRU(pu=6))  # counts
    speed = 1500.0 * 40.0
    pcap.mlr(axes, pcap.LMP(ac=1e9, vl=speed, dtm=[3000.0, 3000.0, *[0.0] * 16]))
    pc.run(0.0256)
    along = 2.0**0.5
    assert pc.dv(0) == near(40.0 / along)  # 1500 counts a unit now
    assert pc.dv(1) == near(60.0 / along)
    pc.scans_until_rest()
    assert (pc.rp(0), pc.rp(1)) == near((2.0, 3.0))


@pytest.mark.covers(
    "apci.rdjac", "apci.rdjvl", "apci.TSRP.jac", "apci.TSRP.jvl", "apci.TSRP.gf", "apci.TSRP.rp"
)
@pytest.mark.covers("apci.wrgf", "apci.wrslsp")
@pytest.mark.parametrize(("gf", "slsp"), [(0.375, 4000.0), (0.25, 7000.0), (0.1, 900.0)])
def test_positions_speeds_and_a_running_jog_keep_their_numbers_when_counts_per_unit_change(
    gf: float, slsp: float
) -> None:
    runs = []
    for change in (False, True):
        pc = Pc("[[axis]]\nslsp = 4000.0\ngf = 0.25\n")
        record = pcap.TSRP(an=0, jac=300.0, jvl=35.0)
        pcap.wrjac(record)
        pcap.wrjvl(record)
        jog(pc, 0, by=17.5)
        pc.run(0.0512)
        if change:
            pcap.wrgf(pcap.TSRP(an=0, gf=gf))
            pcap.wrslsp(0, slsp)
        pcap.rdjac(record)
        pcap.rdjvl(record)
        seen = [record.jac, record.jvl, pc.rp(0), pc.dv(0)]
        for _ in range(4):
            pc.run(0.0512)
            seen += [pc.rp(0), pc.dv(0)]
        pc.scans_until_rest()
        runs.append([*seen, pc.rp(0)])
        pcap.detach()
    assert runs[0] == runs[1]
    assert (runs[1][:2], runs[1][-1]) == (near([300.0, 35.0]), near(17.5))
    assert runs[1][3] > 0.0


@pytest.mark.covers("apci.rdEffRadius", "apci.MODEREG.10.rotaxisunit", "apci.TRU.pu", "apci.mlr")
@pytest.mark.covers("apci.wrEffRadius", "apci.var.effradius", "apci.interp.surface")
@pytest.mark.parametrize(("pu", "unit_mm"), [(0, 1.0), (1, 25.4), (2, 1000.0)])
@pytest.mark.parametrize("in_degrees", [False, True])
def test_an_effective_radius_counts_in_the_position_unit(pu: int, unit_mm: float, in_degrees: bool) -> None:
    pc = Pc('[[axis]]\n[[axis]]\nunit = "deg"\n')
    axes = pc.close(0, 1)
    pcap.wrModeReg(ModeReg.rotaxisunit if in_degrees else 0)
    pcap.ctru(pcap.TRU(pu=pu))
    pcap.wrEffRadius(1, 45.0 / unit_mm)
    around_mm, turned_deg = 37.0, 47.109863  # 37 / 45 rad
    around = turned_deg if in_degrees else around_mm / unit_mm
    speeds = {"ac": 1e5 / unit_mm, "vl": 20.0 / unit_mm}
    pcap.mlr(axes, pcap.LMP(**speeds, dtm=[16.0 / unit_mm, around, *[0.0] * 16]))
    pc.run(0.256)
    path_mm = 40.311289  # of 16 and 37
    assert pc.dv(0) == near(20.0 * 16.0 / path_mm)
    assert pc.dv(1) == near(20.0 * turned_deg / path_mm)
    pc.scans_until_rest()
    assert (pc.rp(0), pc.rp(1)) == near((16.0, turned_deg))
    assert pcap.rdEffRadius(1) == near(45.0 / unit_mm)
    assert pc.board.time_s == near(path_mm / 20.0, abs=6 * SCAN_S)


@pytest.mark.covers("apci.MODEREG.10.rotaxisunit")
def test_the_unit_of_rotary_axes_can_be_changed_between_two_moves() -> None:
    pc = Pc('[[axis]]\n[[axis]]\nunit = "deg"\n')
    axes = pc.close(0, 1)
    pcap.wrEffRadius(1, 45.0)
    places = []
    for modes in (0, ModeReg.rotaxisunit, 0):
        pcap.wrModeReg(modes)
        pcap.mlr(axes, pcap.LMP(ac=1e5, vl=300.0, dtm=[2.0, 37.0, *[0.0] * 16]))
        pc.scans_until_rest()
        places.append(pc.rp(1))
    assert places == near([47.109863, 84.109863, 131.219726])  # 37 / 45 rad, 37 degrees, 37 / 45 rad


@pytest.mark.parametrize("unit", ["counts", "steps"])
def test_an_axis_that_is_planned_in_counts_moves_in_counts(unit: str) -> None:
    pc = Pc(f'[[axis]]\n[[axis]]\nunit = "{unit}"\nslsp = 4000.0\ngf = 0.25\n')
    axes = pc.close(1)
    for pu, way in ((6, 3100.0), (7, -1700.0)):
        pcap.ctru(pcap.TRU(pu=pu))
        pcap.mlr(axes, pcap.LMP(ac=1e8, vl=50_000.0, dtm=[0.0, way, *[0.0] * 16]))
        pc.scans_until_rest()
    assert pc.rp(1) == near(1400.0)
