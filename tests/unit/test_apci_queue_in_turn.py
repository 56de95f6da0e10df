"""Spooled commands that come while axes still move, or right after a command that moves them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import pytest

from polycnc.controllers.apci import pcap
from support.apci_pc import LATENCY, Pc, near

TWO = "[[axis]]\n" * 2


@pytest.fixture(autouse=True)
def _leave_no_board() -> Iterator[None]:
    yield
    pcap.detach()


def line(an: int, distance: float, *, vl: float = 100.0, tvl: float = 0.0) -> pcap.LMP:
    record = pcap.LMP(ac=1000.0, vl=vl, tvl=tvl)
    record.dtm[an] = distance
    return record


def jog(pc: Pc, axes: pcap.AS, target: float) -> None:
    pc.tsrp[0].tp = target
    pcap.ja(axes, pc.tsrp)


def steps(pc: Pc, an: int, scans: int) -> list[float]:
    """Return by how much an axis goes in each of some scans."""
    places = [pc.rp(an)]
    for _ in range(scans):
        pc.board.advance(1)
        places.append(pc.rp(an))
    return [b - a for a, b in pairwise(places)]


@pytest.mark.covers("apci.mode.direct", "apci.rule.spooler_discard")
def test_a_direct_command_rejects_what_was_queued_before_it_and_nothing_else() -> None:
    pc = Pc(TWO)
    axes = pc.close(0)
    pcap.smla(axes, line(0, -50.0))  # before: rejected
    jog(pc, axes, 10.0)
    pcap.smla(axes, line(0, 20.0))
    pcap.smlr(axes, line(0, 5.0))
    pcap.ssf(0, 7, 70.0)
    pcap.ssms(axes)  # not at rest: without effect
    pc.scans_until_rest()
    assert (pc.rp(0), pcap.rdMCiS(0), pc.board.state.ci[7]) == (near(10.0), 2, 0)
    pcap.ssms(axes)
    pc.scans_until_rest()
    assert (pc.rp(0), pcap.rdMCiS(0), pc.board.state.ci[7]) == (near(25.0), 0, 70)


@pytest.mark.parametrize("name", ["js", "ms", "sdels"])
def test_what_rejects_queues_also_rejects_what_waits_for_its_turn(name: str) -> None:
    pc = Pc(TWO)
    axes = pc.close(0)
    jog(pc, axes, 10.0)
    pcap.smla(axes, line(0, 20.0))
    getattr(pcap, name)(axes)
    pc.scans_until_rest()
    pc.board.advance(LATENCY + 1)
    assert pcap.rdMCiS(0) == 0
    assert pc.rp(0) == near(10.0 if name == "sdels" else 0.0)


def begin_jog(pc: Pc, axes: pcap.AS) -> None:
    jog(pc, axes, 10.0)


def begin_line(pc: Pc, axes: pcap.AS) -> None:
    pcap.mla(axes, line(0, 10.0))


def begin_stop(pc: Pc, axes: pcap.AS) -> None:
    pcap.mlr(axes, line(0, 100.0))
    pc.board.advance(200)
    pcap.ms(axes)


def begin_stop_of_the_queue(pc: Pc, axes: pcap.AS) -> None:
    pcap.smlr(axes, line(0, 100.0))
    pcap.ssms(axes)
    pc.board.advance(200)
    pcap.ms(axes)


def begin_jog_stop(pc: Pc, axes: pcap.AS) -> None:
    jog(pc, axes, 100.0)
    pc.board.advance(200)
    pcap.js(axes)


@pytest.mark.parametrize(
    "begin", [begin_jog, begin_line, begin_stop, begin_stop_of_the_queue, begin_jog_stop]
)
@pytest.mark.covers("apci.mode.spool", "apci.smlr")
def test_what_is_queued_on_the_way_begins_where_the_axis_comes_to_rest(
    begin: Callable[[Pc, pcap.AS], None],
) -> None:
    pc = Pc(TWO)
    axes = pc.close(0)
    begin(pc, axes)
    pc.board.advance(LATENCY + 10)
    assert pc.dv(0) > 0.0
    pcap.smlr(axes, line(0, 5.0))
    pc.scans_until_rest()
    rest = pc.rp(0)
    pcap.ssms(axes)
    ways = steps(pc, 0, 200)
    assert max(map(abs, ways)) < 0.1  # from rest, at 1000 mm/s2 over 5 mm
    assert pc.rp(0) - rest == near(5.0)


def test_a_snapshot_keeps_what_waits_for_its_turn() -> None:
    pc = Pc(TWO)
    axes = pc.close(0, 1)
    jog(pc, pcap.AS.of(0), 10.0)
    circle = pcap.CMP(ac=1000.0, vl=100.0, phi=180.0, dtca1=2.0)
    pcap.smcr(axes, circle)
    pcap.ssf(0, 7, 70.0)
    buffer = pcap.SPDBUF()
    buffer.position[0:2] = [0.01, 0.01]
    pcap.spdr(0, 2, buffer, 4)
    pcap.sstvl(pcap.AS.of(0, 1), 20.0)
    pcap.ssms(axes)
    kept = pc.board.snapshot()
    ends = []
    for _ in range(2):
        pc.board.restore(kept)
        pc.scans_until_rest()
        queued = pcap.rdMCiS(0), pcap.rdMCiS(1)
        pcap.ssms(axes)
        pc.board.advance(200)
        ends.append((queued, pc.rp(0), pc.rp(1), int(pc.board.state.ci[7])))
    assert ends[0] == ends[1]
    assert ends[0][0] == (2, 1)
    assert ends[0][3] == 70


# ------------------------------------------------------------------ what acts on the queue, in other units


@pytest.mark.parametrize(("tu", "per_s"), [(0, 1.0), (1, 60.0)])
@pytest.mark.parametrize("behind", ["ssf", "spd"])
@pytest.mark.covers("apci.wrMDVel")
def test_corners_keep_mdvel_in_its_unit_whatever_comes_behind_them(
    tu: int, per_s: float, behind: str
) -> None:
    pc = Pc(TWO)
    axes = pc.close(0, 1)
    pcap.ctru(pcap.TRU(pu=0, tu=tu))
    pcap.wrModeReg(1)
    for an in (0, 1):
        pcap.wrMDVel(an, 10.0 * per_s)
    for an in (0, 1, 0):
        record = line(an, 50.0, vl=100.0 * per_s, tvl=100.0 * per_s)
        record.ac *= per_s**2
        pcap.smlr(axes, record)
    if behind == "ssf":
        pcap.ssf(0, 2001, 0.0)
    else:
        buffer = pcap.SPDBUF()
        buffer.position[0] = 0.0
        pcap.spdr(0, 1, buffer, 0)
    pcap.ssms(axes)
    last, jump = (0.0, 0.0), 0.0
    for _ in range(1500):
        pc.board.advance(1)
        now = pc.dv(0), pc.dv(1)
        jump = max(jump, abs(now[0] - last[0]), abs(now[1] - last[1]))
        last = now
    assert (pc.rp(0), pc.rp(1)) == (near(100.0), near(50.0))
    assert jump < 12.0  # 10 mm/s, and one scan of the ramp


@pytest.mark.parametrize(
    ("vl", "tvl", "limit", "end"),
    [(100.0, 150.0, 1000.0, 150.0), (100.0, -150.0, 120.0, -120.0), (50.0, 80.0, 60.0, 60.0)],
)
@pytest.mark.covers("apci.wrMaxVel", "apci.var.MaxVel")
def test_maxvel_limits_target_velocities_of_either_sign_and_no_others(
    vl: float, tvl: float, limit: float, end: float
) -> None:
    pc = Pc(TWO)
    axes = pc.close(0)
    pcap.wrModeReg(1 << 7)
    pcap.wrMaxVel(0, limit)
    pcap.smla(axes, line(0, 100.0, vl=vl, tvl=tvl))
    pcap.ssms(axes)
    while pc.rp(0) < 50.0:
        pc.board.advance(5)
    assert pc.dv(0) == near(vl)  # a limit above it does not raise it
    pc.board.advance(3000)
    assert pc.dv(0) == near(end)


@pytest.mark.covers("apci.wrtrac")
def test_ms_brakes_with_trac_in_its_unit_beside_axes_of_another_kind() -> None:
    pc = Pc('[[axis]]\n[[axis]]\n[[axis]]\nunit = "deg"\n')
    axes = pc.close(0, 1, 2)
    pcap.ctru(pcap.TRU(pu=0, tu=1))
    pcap.wrModeReg(1 << 15)
    pcap.wrtrac(100.0 * 3600)
    record = line(0, 1000.0, vl=100.0 * 60)
    record.ac = 1000.0 * 3600
    pcap.mlr(pcap.AS.of(0, 1), record)
    pc.board.advance(500)
    before = pc.rp(0)
    pcap.ms(axes)
    pc.scans_until_rest()
    assert pc.rp(0) - before == near(50.0, rel=1e-3)  # 100 mm/s at 100 mm/s2


# ------------------------------------------------------------------ overrides, registers


@pytest.mark.parametrize("settling", [0.0, 1.0])
@pytest.mark.covers("apci.utrovr")
def test_utrovr_acts_on_a_jog_though_the_trajectory_override_has_not_changed(settling: float) -> None:
    pc = Pc(TWO)
    axes = pc.close(0)
    pc.tsrp[0].jovr = 0.5
    pcap.wrjovr(pc.tsrp[0])
    jog(pc, axes, 1000.0)
    pc.board.advance(500)
    assert pc.dv(0) == near(50.0)
    pcap.wrtrovrst(settling)
    pcap.utrovr(axes)
    pc.board.advance(500)
    pcap.rdjovr(pc.tsrp[0])
    assert (pc.tsrp[0].jovr, pc.dv(0)) == (1.0, near(100.0))


@pytest.mark.covers("apci.ra")
def test_ra_sets_all_position_registers_to_zero_with_a_position_error_on_the_way() -> None:
    pc = Pc('[[axis]]\nkp = 20\n[axis.plant]\nkind = "lag"\nlag_s = 0.02\n')
    axes = pc.close(0)
    pcap.wrdpoffset(0, 0.5)
    jog(pc, axes, 50.0)
    pc.board.advance(200)
    assert pcap.rdPosErr(0) > 1.0
    pcap.ra(axes)
    record = pcap.TSRP(an=0)
    for name in ("rp", "dp", "tp"):
        getattr(pcap, f"rd{name}")(record)
    assert (record.rp, record.dp, record.tp) == near((0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.covers("apci.wrdp")
def test_wrdp_writes_what_rddp_reads_whatever_the_offset() -> None:
    pc = Pc(TWO)
    pc.close(0)
    pcap.wrdpoffset(0, 0.5)
    pc.board.advance(2)
    record = pcap.TSRP(an=0, dp=5.0)
    pcap.wrdp(record)
    pc.board.advance(1)
    pcap.rddp(record)
    assert record.dp == near(5.0)
