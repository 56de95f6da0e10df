"""Every function that moves axes, with the times and places that the manual's profiles give."""

import math
from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.board._board import Board
from support.apci_bits import Axst, ErrorReg, ModeReg
from support.apci_pc import LATENCY, SCAN_S, Pc, near

SYSTEM = """
[[axis]]
jac = 100.0
jvl = 50.0
sdec = 200.0
hac = 100.0
hvl = 20.0
[axis.plant]
reference = [-30.0, -28.0]
index = 4.0
[[axis]]
jac = 100.0
jvl = 50.0
sdec = 200.0
[[axis]]
[[axis]]
[inputs]
1 = { functions = ["REF"], axes = ["A1"] }
"""


@pytest.fixture
def pc() -> Iterator[Pc]:
    yield Pc(SYSTEM)
    pcap.detach()


def scans(duration_s: float) -> int:
    """Return the scans of a direct command: its latency, and the scans that the profile needs."""
    return LATENCY + math.ceil(duration_s / SCAN_S - 1e-9)


def dtm(*values: float) -> list[float]:
    return [*values, *[0.0] * (18 - len(values))]


def record(field: str, value: float) -> pcap.TSRP:
    tsrp = pcap.TSRP(an=0)
    setattr(tsrp, field, value)
    return tsrp


def at(pc: Pc) -> tuple[float, ...]:
    return tuple(pc.rp(an) for an in range(4))


# ---------------------------------------------------------------------- jogs


@pytest.mark.covers("apci.ja", "apci.AS", "apci.AS.unoa", "apci.AS.san", "apci.pcap.general.units")
@pytest.mark.covers("apci.const.cmdlatency", "apci.pcap.general.execution")
def test_ja_takes_each_axis_to_its_own_target_in_its_own_time(pc: Pc) -> None:
    axes = pc.close(0, 1)
    pcap.ctru(pcap.TRU(pu=1, tu=1))  # jogs do not care
    pc.tsrp[0].tp, pc.tsrp[1].tp, pc.tsrp[2].tp = 100.0, -10.0, 77.0
    pc.tsrp[0].jvl = 1.0  # is not transferred
    pcap.ja(axes, pc.tsrp)
    pc.board.advance(LATENCY)
    assert at(pc) == (0.0,) * 4
    short = scans(0.632456) - LATENCY  # a triangle: 2 sqrt(10 / 100)
    pc.board.advance(short - 1)
    assert pcap.rdaxstb(1, 13) == 0
    pc.board.advance(1)
    assert (pcap.rdaxstb(1, 13), pc.rp(1)) == (1, -10.0)
    assert pcap.rdaxstb(0, 13) == 0
    pc.board.advance(scans(2.5) - LATENCY - short)  # 0.5 + 1.5 + 0.5
    assert (pcap.rdaxstb(0, 13), at(pc)) == (1, (100.0, -10.0, 0.0, 0.0))


@pytest.mark.covers("apci.jr", "apci.rule.spooler_discard")
def test_jr_goes_on_from_the_instantaneous_position_and_rejects_the_queue(pc: Pc) -> None:
    axes = pc.close(0)
    pcap.smlr(axes, pcap.LMP(ac=100.0, vl=10.0, dtm=dtm(5.0)))
    assert pcap.rdMCiS(0) == 1
    pc.tsrp[0].tp = 100.0
    pcap.jr(axes, pc.tsrp)
    pc.board.advance(LATENCY + 1)
    assert pcap.rdMCiS(0) == 0
    pc.board.advance(624)  # 0.8 s: 12.5 + 15 mm, at 50 mm/s
    assert pc.dv(0) == near(50.0)
    pc.tsrp[0].tp = -5.0
    pcap.jr(axes, pc.tsrp)
    pc.board.advance(LATENCY)
    here = pc.rp(0)
    assert here == near(12.5 + 50.0 * (627 * SCAN_S - 0.5), abs=1e-9)
    pc.scans_until_rest()
    assert pc.rp(0) == near(here - 5.0)


@pytest.mark.covers("apci.ja", "apci.jr", "apci.wrjac", "apci.wrjtvl", "apci.wrjovr", "apci.wrjvl")
@pytest.mark.covers("apci.TSRP.jac", "apci.TSRP.jvl", "apci.TSRP.jtv", "apci.TSRP.jovr")
def test_jogs_obey_what_was_written_before(pc: Pc) -> None:
    axes = pc.close(0)
    pcap.wrjac(pcap.TSRP(an=0, jac=-50.0))  # the braking ramp: 0.5 + 1.25 + 1.0 s
    pc.tsrp[0].tp = 100.0
    pcap.jr(axes, pc.tsrp)
    assert pc.scans_until_rest() == scans(2.75)
    pcap.wrjac(pcap.TSRP(an=0, jac=100.0))
    pcap.wrjovr(pcap.TSRP(an=0, jovr=0.5))  # 25 mm/s, 50 mm/s2: 0.5 + 3.5 + 0.5 s
    pcap.jr(axes, pc.tsrp)
    assert pc.scans_until_rest() == scans(4.5)
    pcap.wrjovr(pcap.TSRP(an=0, jovr=1.0))
    pcap.wrjvl(pcap.TSRP(an=0, jvl=40.0))  # 0.4 + 2.1 + 0.4 s
    pcap.jr(axes, pc.tsrp)
    assert pc.scans_until_rest() == scans(2.9)
    pcap.wrjtvl(pcap.TSRP(an=0, jtv=17.0))
    pcap.jr(axes, pc.tsrp)
    pc.scans_until_rest()
    pc.board.advance(10)
    assert (pcap.rdaxstb(0, 13), pc.dv(0)) == (1, near(17.0))  # ended, and goes on
    for target, jtv, velocity in ((-60.0, 17.0, -17.0), (60.0, -13.0, -13.0)):  # counted the way of travel
        pcap.js(axes)
        pc.scans_until_rest()
        pcap.wrjtvl(pcap.TSRP(an=0, jtv=jtv))
        pc.tsrp[0].tp = target
        pcap.jr(axes, pc.tsrp)
        pc.scans_until_rest()
        assert pc.dv(0) == near(velocity)


@pytest.mark.covers("apci.jhl", "apci.jhr", "apci.wrhac", "apci.wrhvl", "apci.TSRP.hac", "apci.TSRP.hvl")
def test_the_search_runs_endlessly_until_the_reference_switch_and_brakes_with_hac(pc: Pc) -> None:
    axes = pc.close(0)
    pcap.wrhvl(pcap.TSRP(an=0, hvl=40.0))
    pcap.wrhac(pcap.TSRP(an=0, hac=400.0))
    pcap.jhl(axes)
    pc.run(0.5)
    assert (pcap.rdaxstb(0, 13), pc.dv(0)) == (0, near(-40.0))
    pc.scans_until_rest()
    assert pcap.rdaxstb(0, 13) == 1
    # The switch is on from -28 on; from 40 mm/s it takes 40 * 40 / 800 = 2 mm to stop.
    assert pc.rp(0) == near(-30.0, abs=3 * 40.0 * SCAN_S)
    pcap.jhr(axes)  # the switch is on already, or behind: to the right there is no other
    pc.run(0.2)
    assert pc.rp(0) > -30.5
    pcap.jhr(pcap.AS.of(1))
    pcap.cl(pcap.AS.of(1))
    pcap.jhr(pcap.AS.of(1))
    pc.run(3.0)
    assert (pcap.rdaxstb(1, 13), pc.dv(1)) == (0, near(20.0))


@pytest.mark.covers("apci.jhi", "apci.rdlpndx", "apci.wrlpndx", "apci.var.lpndx")
def test_jhi_stops_behind_the_index_or_where_its_distance_is_used_up(pc: Pc) -> None:
    axes = pc.close(0)
    pc.tsrp[0].tp = 3.0
    pcap.jhi(axes, pc.tsrp)
    assert pcap.rdaxstb(0, 13) == 0
    pc.scans_until_rest()
    assert pc.rp(0) == near(3.0)  # no index on the way
    pc.tsrp[0].tp = 50.0
    pcap.jhi(axes, pc.tsrp)
    pc.scans_until_rest()
    reached = pc.rp(0)  # index at 4: v = sqrt(2 * 100 * 1), so it takes about 1 mm to stop
    assert 4.5 < reached < 6.0
    record = pcap.TSRP(an=0)
    pcap.rdlpndx(record)
    assert record.lp == near(4.0)
    record.lp = 9.0
    pcap.wrlpndx(record)
    record.lp = 0.0
    pcap.rdlpndx(record)
    assert record.lp == 9.0


@pytest.mark.covers("apci.js", "apci.wrsdec", "apci.TSRP.sdec", "apci.var.sdec")
def test_js_brakes_with_sdec_and_stops_at_once_with_0(pc: Pc) -> None:
    axes = pc.close(0)
    pc.tsrp[0].tp = 1000.0
    pcap.jr(axes, pc.tsrp)
    pc.run(1.0)
    before = pc.rp(0)
    pcap.js(axes)
    assert pcap.rdaxstb(0, 13) == 0
    taken = pc.scans_until_rest()
    assert taken * SCAN_S == near(0.25, abs=2 * SCAN_S)
    assert pc.rp(0) - before == near(6.25, abs=1e-9)
    assert pcap.rdaxstb(0, 14) == 1
    pcap.jr(axes, pc.tsrp)
    pc.run(1.0)
    pcap.wrsdec(pcap.TSRP(an=0, sdec=0.0))
    before = pc.rp(0)
    pcap.js(axes)
    pc.scans_until_rest()
    assert pc.rp(0) == near(before, abs=50.0 * SCAN_S)


@pytest.mark.covers("apci.MODEREG.15.MS_DECEL")
@pytest.mark.covers("apci.ms", "apci.wrtrac")
def test_ms_brakes_along_the_circle_with_the_path_deceleration_or_trac(pc: Pc) -> None:
    axes = pc.close(0, 1)
    for modes, deceleration in ((0, 100.0), (ModeReg.MS_DECEL, 400.0)):
        pcap.wrModeReg(modes)
        assert pcap.wrtrac(400.0) == 0
        start = at(pc)
        pcap.mcr(axes, pcap.CMP(ac=100.0, vl=40.0, phi=360.0, dtca1=-20.0))
        pc.run(1.0)
        from_angle = math.atan2(pc.rp(1) - start[1], pc.rp(0) - start[0] + 20.0)
        pcap.ms(axes)
        pc.scans_until_rest()
        dx, dy = pc.rp(0) - start[0] + 20.0, pc.rp(1) - start[1]
        assert math.hypot(dx, dy) == near(20.0)
        braked = (math.atan2(dy, dx) - from_angle) % (2.0 * math.pi) * 20.0
        assert braked == near(40.0 * 40.0 / (2.0 * deceleration), abs=1e-6)


# ---------------------------------------------------------------------- interpolation at once


@pytest.mark.covers("apci.mla", "apci.LMP", "apci.LMP.dtm", "apci.LMP.ac", "apci.LMP.vl", "apci.LMP.tvl")
def test_mla_takes_targets_by_axis_number(pc: Pc) -> None:
    axes = pc.close(1, 3)
    pcap.mla(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(-7.0, 60.0, -7.0, 80.0)))
    assert pcap.rdaxstb(1, 13) == pcap.rdaxstb(3, 13) == 0
    pc.board.advance(LATENCY + 625)  # 0.8 s: 12.5 + 15 mm of 100
    assert (pc.rp(1), pc.rp(3)) == (near(0.6 * 27.5), near(0.8 * 27.5))
    assert pc.scans_until_rest() + LATENCY + 625 == scans(2.5)
    assert at(pc) == (0.0, 60.0, 0.0, 80.0)
    pcap.mla(axes, pcap.LMP(ac=100.0, vl=50.0, tvl=25.0, dtm=dtm(0.0, 0.0, 0.0, 0.0)))
    pc.scans_until_rest()
    assert math.hypot(pc.dv(1), pc.dv(3)) == near(25.0)


@pytest.mark.covers("apci.mlr", "apci.pcap.general.units")
def test_mlr_counts_from_where_the_axes_are_in_the_units_of_ctru(pc: Pc) -> None:
    axes = pc.close(0, 1)
    pcap.ctru(pcap.TRU(pu=1, tu=1))  # inch and minute
    speeds = {"ac": 100.0 / 25.4 * 3600.0, "vl": 50.0 / 25.4 * 60.0}
    for _ in range(2):
        pcap.mlr(axes, pcap.LMP(**speeds, dtm=dtm(100.0 / 25.4, 0.0)))
        assert pc.scans_until_rest() == scans(2.5)
    assert at(pc) == near((200.0, 0.0, 0.0, 0.0))


@pytest.mark.covers(
    "apci.ErrorReg.0.errAxDef",
    "apci.ErrorReg.12.VelocityZero",
    "apci.ErrorReg.13.AccelZero",
    "apci.ErrorReg.15.ZeroProfile",
)
@pytest.mark.covers("apci.rdErrorReg")
@pytest.mark.parametrize("name", ["mla", "mlr"])
@pytest.mark.covers("apci.mla", "apci.mlr")
def test_a_line_that_cannot_be_is_not_begun(pc: Pc, name: str) -> None:
    move = getattr(pcap, name)
    good: dict[str, Any] = {"ac": 100.0, "vl": 10.0, "dtm": dtm(5.0)}
    move(pcap.AS.of(0), pcap.LMP(**good))  # the loop is open
    axes = pc.close(0)
    for change in ({"ac": -1.0}, {"vl": -1.0}, {"dtm": dtm(math.nan)}, {"tvl": math.inf}):
        move(axes, pcap.LMP(**{**good, **change}))
    assert pcap.rdErrorReg() == 0
    move(pcap.AS(unoa=2), pcap.LMP(**good))  # axis 0 twice
    assert pcap.rdErrorReg() == ErrorReg.errAxDef
    move(axes, pcap.LMP(**{**good, "vl": 0.0}))
    move(axes, pcap.LMP(**{**good, "ac": 0.0}))
    assert pcap.rdErrorReg() == ErrorReg.errAxDef | ErrorReg.VelocityZero | ErrorReg.AccelZero
    move(axes, pcap.LMP(**{**good, "dtm": dtm(0.0)}))
    move(pcap.AS.of(0, 9), pcap.LMP(**good))  # there is no axis 9
    pc.run(1.0)
    assert pcap.rdErrorReg() & ErrorReg.ZeroProfile
    assert at(pc) == (0.0,) * 4


@pytest.mark.covers("apci.ErrorReg.3.errCenterPoint", "apci.ErrorReg.16.RadiusError")
@pytest.mark.covers("apci.rdErrorReg")
@pytest.mark.covers("apci.mca", "apci.mcr")
def test_a_circle_needs_two_axes_and_a_radius(pc: Pc) -> None:
    axes = pc.close(0, 1)
    pcap.mca(pcap.AS.of(0), pcap.CMP(ac=100.0, vl=50.0, phi=90.0, dtca1=5.0))
    pc.run(0.1)
    assert (pcap.rdErrorReg(), at(pc)) == (0, (0.0,) * 4)
    pcap.mca(axes, pcap.CMP(ac=100.0, vl=50.0, phi=90.0))
    pc.run(0.1)
    assert pcap.rdErrorReg() == ErrorReg.errCenterPoint | ErrorReg.RadiusError
    pcap.mca3d(axes, pcap.HMP3D(100.0, 50.0, 0.0, 90.0, 3.0, 4.0, 5.0, 0.0, 0.0, 1.0))  # needs three
    pc.run(0.1)
    assert at(pc) == (0.0,) * 4
    pcap.mcr(axes, pcap.CMP(ac=100.0, vl=50.0, phi=90.0, dtca1=5.0))
    assert (pcap.rdaxstb(0, 13), pcap.rdaxstb(1, 13)) == (0, 0)


@pytest.mark.parametrize(("unit", "name", "length_mm"), [(0, "mm", 1.0), (1, "inch", 25.4), (2, "m", 1000.0)])
@pytest.mark.covers("apci.ctru", "apci.pu.mm", "apci.pu.inch", "apci.pu.m", "apci.TRU", "apci.TRU.pu")
def test_units_of_length(pc: Pc, unit: int, name: str, length_mm: float) -> None:
    axes = pc.close(0)
    pcap.ctru(pcap.TRU(pu=unit))
    pcap.mlr(axes, pcap.LMP(ac=1e6, vl=10.0 / length_mm, dtm=dtm(5.0 / length_mm)))
    pc.board.advance(LATENCY)
    pc.run(0.256)
    assert pc.dv(0) == near(10.0), name
    pc.scans_until_rest()
    assert pc.rp(0) == near(5.0)


@pytest.mark.parametrize(("unit", "degrees"), [(3, 360.0), (4, 1.0), (5, 180.0 / math.pi)])
@pytest.mark.covers("apci.ctru", "apci.pu.rev", "apci.pu.deg", "apci.pu.rad")
def test_units_of_angle(unit: int, degrees: float) -> None:
    pc = Pc('[[axis]]\nunit = "deg"\n')
    axes = pc.close(0)
    pcap.ctru(pcap.TRU(pu=unit))
    pcap.mlr(axes, pcap.LMP(ac=1e6, vl=10.0 / degrees, dtm=dtm(5.0 / degrees)))
    pc.board.advance(LATENCY)
    pc.run(0.256)
    assert pc.dv(0) == near(10.0)
    pc.scans_until_rest()
    assert pc.rp(0) == near(5.0)
    pcap.detach()


@pytest.mark.parametrize("unit", [6, 7])
@pytest.mark.covers("apci.ctru", "apci.pu.counts", "apci.pu.steps")
def test_units_of_counts_and_steps(unit: int) -> None:
    pc = Pc('[[axis]]\nmotor = "stepper"\nslsp = 200.0\ngf = 0.5\n')  # 100 steps a mm
    axes = pc.close(0)
    pcap.ctru(pcap.TRU(pu=unit))
    pcap.mlr(axes, pcap.LMP(ac=1e8, vl=1000.0, dtm=dtm(500.0)))
    pc.board.advance(LATENCY)
    pc.run(0.256)
    assert pc.dv(0) == near(10.0)
    pc.scans_until_rest()
    assert pc.rp(0) == near(5.0)
    pcap.detach()


@pytest.mark.parametrize(("unit", "seconds"), [(0, 1.0), (1, 60.0), (2, SCAN_S)])
@pytest.mark.covers("apci.ctru", "apci.tu.sec", "apci.tu.min", "apci.tu.tsample", "apci.TRU.tu")
def test_units_of_time(pc: Pc, unit: int, seconds: float) -> None:
    axes = pc.close(0)
    pcap.ctru(pcap.TRU(tu=unit))
    pcap.mlr(axes, pcap.LMP(ac=100.0 * seconds * seconds, vl=50.0 * seconds, dtm=dtm(100.0)))
    assert pc.scans_until_rest() == scans(2.5)


@pytest.mark.covers("apci.ErrorReg.2.errUnit", "apci.TRU.tu")
@pytest.mark.covers("apci.ctru")
def test_a_unit_that_does_not_exist_changes_nothing_but_the_error_register(pc: Pc) -> None:
    for tru in (pcap.TRU(pu=8), pcap.TRU(pu=-1), pcap.TRU(pu=1, tu=3)):
        pcap.ctru(tru)
        assert pcap.rdErrorReg() == ErrorReg.errUnit
        assert (pc.board.variables.pu, pc.board.variables.tu) == (0, 0)


# ---------------------------------------------------------------------- the spooler


@pytest.mark.covers("apci.smla", "apci.smlr", "apci.ssms")
def test_queued_lines_wait_for_ssms_and_follow_without_a_gap(pc: Pc) -> None:
    axes = pc.close(0, 1)
    pcap.smlr(axes, pcap.LMP(ac=100.0, vl=50.0, tvl=50.0, dtm=dtm(50.0)))
    pcap.smlr(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(50.0)))  # from the end of the first
    pcap.smla(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(100.0, 100.0)))
    pc.run(0.1)
    assert at(pc) == (0.0,) * 4
    pcap.ssms(axes)
    assert (pcap.rdaxstb(0, 13), pcap.rdaxstb(1, 13)) == (0, 0)
    pc.run(1.28)
    assert pc.dv(0) == near(50.0)  # 0.5 s + 37.5 mm, and on without braking
    rest = pc.scans_until_rest()
    assert rest * SCAN_S + 1.28 == near(5.0, abs=4 * SCAN_S)  # twice 2.5 s
    assert at(pc)[:2] == (100.0, 100.0)


@pytest.mark.covers("apci.sstps", "apci.sdels", "apci.ssms")
def test_sstps_pauses_behind_the_command_and_sdels_drops_the_rest(pc: Pc) -> None:
    axes = pc.close(0)
    for _ in range(4):
        pcap.smlr(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(10.0)))
    pcap.ssms(axes)
    pc.run(0.3)
    pcap.sstps(axes)
    pc.scans_until_rest()
    assert (pc.rp(0), pcap.rdMCiS(0)) == (near(10.0), 3)
    pcap.ssms(axes)
    pc.run(0.3)
    pcap.sdels(axes)
    pc.scans_until_rest()
    assert (pc.rp(0), pcap.rdMCiS(0)) == (near(20.0), 0)


@pytest.mark.covers("apci.ssms")
def test_ssms_starts_only_axes_at_rest_in_position_control(pc: Pc) -> None:
    axes = pc.close(0)
    pcap.smlr(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(10.0)))
    pcap.ol(axes)
    pcap.ssms(axes)
    pc.run(0.5)
    assert (pc.rp(0), pcap.rdaxstb(0, 13)) == (0.0, 1)


@pytest.mark.covers("apci.rdci")
@pytest.mark.covers("apci.rddigob")
@pytest.mark.covers("apci.ssf", "apci.ssfi", "apci.ssfni", "apci.smlai", "apci.smlri", "apci.rdPcapIndex")
@pytest.mark.covers("apci.var.PcapIndex")
def test_special_functions_run_in_their_turn_and_indices_show_what_is_executed(pc: Pc) -> None:
    axes = pc.close(0)
    assert pcap.rdPcapIndex(0) == (0, -1)
    pcap.smlai(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(10.0)), 7)
    pcap.ssf(0, 125, 999)  # CI125 := 999
    pcap.ssfi(0, 1001, 1, 8)  # output 1 on
    pcap.ssf(0, 1003, 100.0)  # wait 5 scans
    pcap.smlri(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(10.0)), 9)
    pcap.ssfni(0, 1002, 1, 10)  # output 1 off
    cibuf = pcap.CIBUF()
    pcap.ssms(axes)
    pc.run(0.3)
    pcap.rdci(125, cibuf)
    assert (pcap.rdPcapIndex(0), cibuf.ci[125], pcap.rddigob(0, 1)) == ((0, 7), 0, 0)
    while pcap.rdPcapIndex(0) == (0, 7):
        pc.board.advance(1)
    pcap.rdci(125, cibuf)
    assert (pcap.rdPcapIndex(0), cibuf.ci[125], pcap.rddigob(0, 1)) == ((0, 8), 999, 1)
    assert pc.rp(0) == near(10.0)
    pc.run(0.3)
    assert pcap.rdPcapIndex(0) == (0, 9)
    pc.scans_until_rest()
    assert (pc.rp(0), pcap.rdPcapIndex(0), pcap.rddigob(0, 1)) == (near(20.0), (0, 10), 0)


@pytest.mark.covers("apci.ClearCI99")
def test_clearing_ci99_releases_all_axes_that_wait_for_it_together(pc: Pc) -> None:
    axes = pc.close(0, 1)
    for an in (0, 1):
        pcap.ssf(an, 1005, 3)  # CI99 := 3, and wait until it is 0
    pcap.smlr(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=dtm(10.0, 10.0)))
    pcap.ssms(axes)
    pc.run(0.1)
    cibuf = pcap.CIBUF()
    pcap.rdci(99, cibuf)
    assert (cibuf.ci[99], at(pc)[:2]) == (3, (0.0, 0.0))
    pcap.ClearCI99()
    pc.run(0.1)
    pcap.rdci(99, cibuf)
    assert (cibuf.ci[99], pc.rp(0) == pc.rp(1) > 0.0) == (0, True)


@pytest.mark.covers("apci.spd", "apci.spda", "apci.spdr", "apci.SPDBUF", "apci.const.spdsize")
def test_setpoint_tables_give_one_setpoint_a_scan(pc: Pc) -> None:
    axes = pc.close(0, 1, 2)
    absolute, relative = pcap.SPDBUF(), pcap.SPDBUF()
    absolute.position[:6] = [0.1, 0.3, 0.6, 0.8, 0.9, 99.0]
    relative.position[:6] = [0.1, 0.2, 0.3, 0.2, 0.1, 99.0]
    pcap.spda(0, 5, absolute, 100)
    pcap.spdr(1, 5, relative, 200)
    pcap.spd(2, 5, absolute)
    pcap.ssms(axes)
    for n, place in enumerate(absolute.position[:5]):
        pc.board.advance(1)
        assert at(pc)[:3] == near((place,) * 3)
        assert (pcap.rdPcapIndex(0), pcap.rdPcapIndex(1), pcap.rdPcapIndex(2)) == (
            *((0, 100 + n), (0, 200 + n), (0, -1)),
        )
    pc.board.advance(5)
    assert at(pc)[:3] == near((0.9,) * 3)
    for size in (0, -1, 1001):
        pcap.spd(0, size, absolute)
    absolute.position[2] = math.nan
    pcap.spda(0, 5, absolute, 0)
    assert pcap.rdMCiS(0) == 0
    pcap.spd(0, 1000, relative)
    assert pcap.rdMCiS(0) == 1


@pytest.mark.covers("apci.sstvl")
def test_sstvl_lets_a_line_run_on_into_a_table(pc: Pc) -> None:
    axes = pc.close(0)
    pcap.wrModeReg(ModeReg.lookahead)
    step = 20.0 * SCAN_S
    table = pcap.SPDBUF()
    table.position[:200] = [step] * 200
    for tvl in (None, 20.0):
        pcap.smlr(axes, pcap.LMP(ac=100.0, vl=20.0, dtm=dtm(10.0)))
        if tvl is not None:
            pcap.sstvl(axes, tvl)
        pcap.spdr(0, 200, table, 0)
        pcap.ssms(axes)
        slowest = 20.0
        pc.run(0.3)  # past the ramp: 0.2 s
        while not pcap.rdaxstb(0, 13):
            before = pc.rp(0)
            pc.board.advance(1)
            slowest = min(slowest, (pc.rp(0) - before) / SCAN_S)
            if pcap.rdPcapIndex(0)[1] == 5:
                break
        assert (slowest > 19.0) == (tvl is not None)
        pcap.sdels(axes)
        pc.run(1.0)
        pcap.cl(axes)


# ---------------------------------------------------------------------- bad numbers, and a board that is not there


def test_jogs_want_a_record_for_every_axis(pc: Pc) -> None:
    axes = pc.close(2)
    for wrong in (pc.tsrp[:2], pc.tsrp[2]):
        with pytest.raises(ValueError, match="TSRP"):
            pcap.ja(axes, wrong)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e300])
@pytest.mark.covers("apci.pcap.general.return_values")
def test_numbers_that_are_none_change_nothing(pc: Pc, value: float) -> None:
    axes = pc.close(0, 1)
    for stem, field in (("jac", "jac"), ("jvl", "jvl"), ("hvl", "hvl"), ("mpe", "mpe"), ("dp", "dp")):
        getattr(pcap, f"wr{stem}")(record(field, value))
    for code in (pcap.wrdpoffset(0, value), pcap.wrdvoffset(0, value), pcap.wrtrac(value)):
        assert code == 1
    pc.tsrp[0].tp = value
    pcap.shp(pc.tsrp[0])
    if value != 1e300:
        pcap.ja(axes, pc.tsrp)
        pcap.mlr(axes, pcap.LMP(ac=100.0, vl=10.0, dtm=dtm(value)))
        pcap.mcr(axes, pcap.CMP(ac=100.0, vl=10.0, phi=value, dtca1=1.0))
    pcap.szpa(0, value)
    pcap.szpr(0, value)
    pcap.ssf(0, 1003, value)
    pc.run(0.1)
    pc.tsrp[0].tp = 100.0
    pcap.ja(pcap.AS.of(0), pc.tsrp)
    assert pc.scans_until_rest() == scans(2.5)
    assert at(pc) == (100.0, 0.0, 0.0, 0.0)
    assert pcap.rdaxstb(0, Axst.cl.bit_length()) == 1


def test_a_selection_with_an_unknown_axis_is_ignored_as_a_whole() -> None:
    pc = Pc()
    assert len(Board().axes) == 3
    for asel in (pcap.AS.of(0, 3), pcap.AS(unoa=19), pcap.AS(unoa=-1), pcap.AS(1, [-1])):
        pcap.cl(asel)
        pcap.jhl(asel)
    assert [pcap.rdaxstb(an, 14) for an in range(4)] == [0] * 4
    pcap.detach()
    assert pc.code == 0
