"""Functions that close and open loops, reset, set zeros, overrides, inputs, outputs, latches, lights, interrupts."""

import math
from collections.abc import Iterator

import pytest

from polycnc.controllers.apci import pcap, sap
from polycnc.controllers.apci.core._registers import Digi
from polycnc.controllers.apci.sap._board_host import BoardTasks
from support.apci_bits import Axst
from support.apci_pc import LATENCY, SCAN_S, Pc, near

SYSTEM = """
[[axis]]
jac = 100.0
jvl = 50.0
sll = -20.0
slr = 20.0
soft_left = "SMA"
soft_right = "SMA"
[axis.plant]
index = 4.0
[[axis]]
motor = "stepper"
jac = 100.0
jvl = 50.0
[[axis]]
[inputs]
3 = { functions = ["LP"], axes = ["A1"] }
4 = { functions = ["REF"], axes = ["A1"] }
5 = { inverted = true }
[outputs]
1 = { functions = ["PAE"], axes = ["A1", "A2"] }
2 = { functions = ["PAE"], axes = ["A3"] }
8 = { set_at_reset = true }
"""


@pytest.fixture
def pc() -> Iterator[Pc]:
    yield Pc(SYSTEM)
    pcap.detach()


def line(pc: Pc, axes: pcap.AS, *distances: float) -> None:
    """Queue a straight line."""
    pcap.smlr(axes, pcap.LMP(ac=100.0, vl=50.0, dtm=[*distances, *[0.0] * (18 - len(distances))]))


def go(pc: Pc, an: int, target: float) -> None:
    """Jog an axis to a position and wait."""
    pc.tsrp[an].tp = target
    pcap.ja(pcap.AS.of(an), pc.tsrp)
    pc.scans_until_rest()


# ---------------------------------------------------------------------- loops and resets


@pytest.mark.covers("apci.rddp", "apci.rdmcp", "apci.wrmcp", "apci.rdaxstb", "apci.TSRP.tp")
@pytest.mark.covers("apci.rddigob", "apci.rdrv")
@pytest.mark.covers("apci.cl", "apci.ol", "apci.ctrl.loop", "apci.rule.relays")
def test_cl_takes_over_the_actual_position_and_sets_pae_and_ol_resets_it(pc: Pc) -> None:
    axes = pcap.AS.of(0)
    record = pcap.TSRP(an=0, mcp=16384)
    pc.tsrp[0].tp = 5.0
    pcap.ja(axes, pc.tsrp)
    pc.run(0.5)
    assert pc.rp(0) == 0.0  # no profile with open loop
    pcap.wrmcp(record)
    pc.run(0.1)
    moved = pc.rp(0)
    assert moved > 9.0
    assert (pcap.rdaxstb(0, 14), pcap.rddigob(0, 1), pcap.rddigob(0, 2)) == (0, 0, 0)
    pcap.cl(axes)
    pcap.rddp(record)
    assert record.dp == near(pc.rp(0), abs=1e-9)
    assert (pcap.rdaxstb(0, 14), pcap.rddigob(0, 1), pcap.rddigob(0, 2)) == (1, 1, 0)
    here = pc.rp(0)
    pc.run(0.1)
    assert (pc.rp(0), pcap.rdrv(0)) == (near(here, abs=1e-6), near(0.0))
    pcap.ol(axes)
    pcap.rdmcp(record)
    assert (record.mcp, pcap.rdaxstb(0, 14), pcap.rddigob(0, 1)) == (0, 0, 0)


@pytest.mark.covers("apci.rdMCiS")
@pytest.mark.covers("apci.cl", "apci.rule.spooler_discard")
def test_cl_rejects_the_queue(pc: Pc) -> None:
    axes = pc.close(0)
    line(pc, axes, 5.0)
    assert pcap.rdMCiS(0) == 1
    pcap.cl(axes)
    assert pcap.rdMCiS(0) == 0


@pytest.mark.covers("apci.rdrv")
@pytest.mark.covers("apci.clv", "apci.js")
def test_clv_lets_a_moving_axis_go_on_until_js_stops_it(pc: Pc) -> None:
    record = pcap.TSRP(an=0, mcp=8192)  # a quarter of 200 mm/s
    pcap.wrmcp(record)
    pc.run(0.1)
    velocity = pcap.rdrv(0)
    assert velocity == near(200.0 * 8192 / 32767)
    axes = pcap.AS.of(0)
    pcap.clv(axes)
    pc.run(0.1)
    assert (pcap.rdaxstb(0, 14), pc.dv(0)) == (1, near(velocity, rel=1e-6))
    pcap.js(axes)
    assert pc.scans_until_rest() > 0
    pc.run(0.01)
    assert pcap.rdrv(0) == near(0.0, abs=1e-9)


@pytest.mark.covers("apci.TSRP.axst", "apci.rdaxstb")
@pytest.mark.covers("apci.rdMCiS")
@pytest.mark.covers("apci.ra", "apci.rule.override_reset", "apci.rule.referenced", "apci.wrjovr")
def test_ra_resets_its_axes_and_keeps_their_parameters(pc: Pc) -> None:
    axes = pc.close(0, 2)
    pcap.shp(pcap.TSRP(an=0, tp=5.0))
    pcap.wrjovr(pcap.TSRP(an=0, jovr=0.5))
    line(pc, axes, 5.0, 0.0, 5.0)
    pcap.wrjac(pcap.TSRP(an=0, jac=77.0))
    pcap.wrdigo(pcap.TSRP(an=0, digo=0b0000_0110))
    assert pcap.rdaxstb(0, Axst.referenced.bit_length()) == 1
    pcap.ra(pcap.AS.of(0))
    record = pcap.TSRP(an=0)
    pcap.rdap(record)
    assert record.axst & (Axst.cl | Axst.referenced) == 0
    assert (record.rp, record.dp, record.mcp, record.jovr, record.jac) == (0.0, 0.0, 0, 1.0, 77.0)
    assert pcap.rdMCiS(0) == 0
    assert record.digo & 0b1000_0001 == 0b1000_0000  # as planned, and its PAE off
    assert pcap.rdaxstb(2, Axst.cl.bit_length()) == 1


@pytest.mark.covers("apci.rdcd", "apci.rdci", "apci.wrcd", "apci.wrci", "apci.rdifs")
@pytest.mark.covers("apci.rdMCiS", "apci.rdtrovr")
@pytest.mark.covers("apci.rs", "apci.rule.commonpersist", "apci.rule.override_reset", "apci.rule.referenced")
def test_rs_resets_all_axes_and_keeps_parameters_common_variables_and_ifs(pc: Pc) -> None:
    axes = pc.close(0, 1, 2)
    go(pc, 0, 5.0)
    for an in (0, 1, 2):
        pcap.shp(pcap.TSRP(an=an, tp=float(an)))
    line(pc, axes, 5.0, 5.0, 5.0)
    pcap.wrjac(pcap.TSRP(an=0, jac=77.0))
    pcap.wrtrovr(0.5)
    pcap.utrovr(axes)
    pcap.wrdigo(pcap.TSRP(an=0, digo=0b0110))
    cdbuf, cibuf = pcap.CDBUF(), pcap.CIBUF()
    cdbuf.cd[7], cibuf.ci[7] = 0.5, -5
    pcap.wrcd(7, cdbuf)
    pcap.wrci(7, cibuf)
    ifs = pcap.TSRP(an=0)
    pcap.rdifs(ifs)
    pcap.rs()
    for an in (0, 1, 2):
        record = pcap.TSRP(an=an)
        pcap.rdap(record)
        assert record.axst & (Axst.cl | Axst.referenced | Axst.dhef) == 0
        assert (record.mcp, record.jovr, record.digo, record.ifs) == (0, 1.0, 0b1000_0000, ifs.ifs)
        assert pcap.rdMCiS(an) == 0
    assert (pcap.rdtrovr(), ifs.ifs != 0) == (1.0, True)
    cdbuf, cibuf = pcap.CDBUF(), pcap.CIBUF()
    pcap.rdcd(7, cdbuf)
    pcap.rdci(7, cibuf)
    assert (cdbuf.cd[7], cibuf.ci[7]) == (0.5, -5)
    pcap.rdjac(record := pcap.TSRP(an=0))
    assert record.jac == 77.0


@pytest.mark.covers("apci.rule.referenced", "apci.cl", "apci.ol")
def test_a_stepper_is_not_referenced_any_more_when_its_loop_opens_or_closes(pc: Pc) -> None:
    referenced = Axst.referenced.bit_length()
    for change in (pcap.cl, pcap.ol):
        for an in (0, 1):
            pcap.shp(pcap.TSRP(an=an))
        assert (pcap.rdaxstb(0, referenced), pcap.rdaxstb(1, referenced)) == (1, 1)
        change(pcap.AS.of(0, 1))
        assert (pcap.rdaxstb(0, referenced), pcap.rdaxstb(1, referenced)) == (1, 0)


@pytest.mark.covers("apci.wrdp", "apci.wrrp", "apci.rddp")
@pytest.mark.covers("apci.RPtoDP", "apci.rule.versions")
def test_rptodp_takes_the_actual_position_as_setpoint_where_no_profile_runs() -> None:
    for revision, expected in (("V2.5.3.100", 12.0), ("V2.5.3.99", 14.0)):
        pc = Pc('[[axis]]\n[axis.plant]\nkind = "lag"\n', revision=revision)
        pcap.wrrp(pcap.TSRP(an=0, rp=5.0))  # the machine zero is elsewhere, and the axis not at it
        axes = pc.close(0)
        pcap.wrdp(pcap.TSRP(an=0, dp=12.0))
        pc.run(2.0)
        pcap.wrdp(pcap.TSRP(an=0, dp=14.0))
        record = pcap.TSRP(an=0)
        pc.board.kernel.servo.row[0]["kp"] = 0.0  # it cannot follow
        pc.board.advance(2)
        pcap.RPtoDP(axes)
        pc.board.advance(1)
        pcap.rddp(record)
        assert record.dp == near(expected, abs=0.3)
        pc.tsrp[0].tp = 50.0
        pcap.ja(axes, pc.tsrp)
        pc.run(0.1)
        pcap.rddp(record)
        before = record.dp
        pcap.RPtoDP(axes)  # a profile runs: without effect
        pc.board.advance(1)
        pcap.rddp(record)
        assert record.dp > before
        pcap.detach()


@pytest.mark.covers("apci.rdaxst", "apci.axst.18.refh")
@pytest.mark.covers("apci.rule.versions", "apci.axst.19.saf", "apci.axst.17.referenced")
def test_old_operating_systems_lack_some_status_bits() -> None:
    seen = {}
    for revision in (15, 16, 46, 47, 87, 88):
        pc = Pc(SYSTEM, revision=f"V2.5.3.{revision}")
        pcap.shp(pcap.TSRP(an=0))
        pc.board.set_input(4, True)
        pc.board.advance(1)
        pc.board.state.axis[0]["saf"] = 1
        pcap.rdaxst(record := pcap.TSRP(an=0))
        pcap.InitMcuSystem(pc.tsrp)
        pcap.rdap(whole := pcap.TSRP(an=0))
        assert whole.axst == pc.tsrp[0].axst == record.axst
        seen[revision] = tuple(bool(record.axst & bit) for bit in (Axst.referenced, Axst.refh, Axst.saf))
    pcap.detach()
    assert seen == {
        15: (False, False, False),
        16: (True, False, False),
        46: (True, False, False),
        47: (True, True, False),
        87: (True, True, False),
        88: (True, True, True),
    }


# ---------------------------------------------------------------------- zeros and overrides


@pytest.mark.covers("apci.shp", "apci.wrsll", "apci.wrslr", "apci.TSRP.sll", "apci.TSRP.slr")
def test_shp_sets_the_machine_zero_and_arms_the_software_limits(pc: Pc) -> None:
    pc.close(0)
    go(pc, 0, 30.0)  # beyond slr = 20, which is not watched yet
    assert (pc.rp(0), pcap.rdaxstb(0, Axst.lsrs.bit_length())) == (30.0, 0)
    pcap.shp(pcap.TSRP(an=0, tp=5.0))
    assert (pc.rp(0), pcap.rdaxstb(0, Axst.referenced.bit_length())) == (5.0, 1)
    go(pc, 0, 8.0)
    assert pc.rp(0) == 8.0  # targets count from the new zero
    pcap.wrslr(pcap.TSRP(an=0, slr=12.0))
    pcap.wrsll(pcap.TSRP(an=0, sll=2.0))
    go(pc, 0, 15.0)
    assert pcap.rdaxstb(0, Axst.lsrs.bit_length()) == 1
    assert pc.rp(0) == near(12.0, abs=50.0 * SCAN_S)  # SMA holds the setpoint
    go(pc, 0, 0.0)
    assert pcap.rdaxstb(0, Axst.lsls.bit_length()) == 1
    pcap.ra(pcap.AS.of(0))
    pc.close(0)
    go(pc, 0, 15.0)
    assert (pc.rp(0), pcap.rdaxstb(0, Axst.lsrs.bit_length())) == (near(15.0), 0)


@pytest.mark.covers("apci.rdZeroOffset", "apci.szpr")
@pytest.mark.covers("apci.shp", "apci.szpa", "apci.rule.toolradius_spline")
def test_zeros_are_not_moved_under_a_moving_axis_or_queued_commands(pc: Pc) -> None:
    axes = pc.close(0)
    line(pc, axes, 5.0)
    pcap.shp(pcap.TSRP(an=0, tp=9.0))
    pcap.szpa(0, 9.0)
    pcap.szpr(0, 9.0)
    assert (pc.rp(0), pcap.rdZeroOffset(0)) == (0.0, (0, 0.0))
    pcap.ssms(axes)
    pc.run(0.1)
    pcap.shp(pcap.TSRP(an=0, tp=90.0))
    pcap.szpa(0, 90.0)
    pc.scans_until_rest()
    assert (pc.rp(0), pcap.rdZeroOffset(0)) == (near(5.0), (0, 0.0))


@pytest.mark.covers("apci.szpa", "apci.szpr", "apci.azo", "apci.rdZeroOffset", "apci.var.zeroOffset")
def test_zero_offsets_shift_what_positions_count_from(pc: Pc) -> None:
    pc.close(0, 2)
    go(pc, 0, 10.0)
    assert pcap.rdZeroOffset(0) == (0, 0.0)
    pcap.szpa(0, 4.0)
    assert (pcap.rdZeroOffset(0), pc.rp(0)) == ((0, 4.0), 6.0)
    pcap.szpa(0, 3.0)  # absolute: from the machine zero
    assert (pcap.rdZeroOffset(0), pc.rp(0)) == ((0, 3.0), 7.0)
    pcap.szpr(0, 2.0)  # relative: from the present one
    assert (pcap.rdZeroOffset(0), pc.rp(0)) == ((0, 5.0), 5.0)
    go(pc, 0, 0.0)
    pcap.szpa(0, 0.0)  # deletes it
    assert (pcap.rdZeroOffset(0), pc.rp(0)) == ((0, 0.0), 5.0)
    pc.board.axes[0].zero_offsets[3] = 1.5
    pc.board.axes[2].zero_offsets[3] = 2.5
    pcap.azo(3)
    assert (pcap.rdZeroOffset(0), pcap.rdZeroOffset(2), pcap.rdZeroOffset(1)) == (
        (0, 1.5),
        (0, 2.5),
        (0, 0.0),
    )
    pcap.azo(0)
    assert pcap.rdZeroOffset(0) == (0, 0.0)
    pcap.azo(3)
    pcap.azo(5)  # all off
    assert (pcap.rdZeroOffset(0), pcap.rdZeroOffset(2)) == ((0, 0.0), (0, 0.0))
    assert pcap.rdZeroOffset(9) == (1, 0.0)


@pytest.mark.covers("apci.rdjovr")
@pytest.mark.covers("apci.utrovr", "apci.wrtrovr", "apci.profile.override")
def test_the_trajectory_override_works_from_utrovr_on(pc: Pc) -> None:
    axes = pc.close(0)
    move = pcap.LMP(ac=100.0, vl=50.0, dtm=[100.0, *[0.0] * 17])
    pcap.wrtrovr(0.5)
    pcap.mlr(axes, move)
    assert pc.scans_until_rest() == LATENCY + math.ceil(2.5 / SCAN_S)
    pcap.utrovr(axes)
    pcap.mlr(axes, move)  # 25 mm/s, 50 mm/s2: 4.5 s
    assert pc.scans_until_rest() == LATENCY + math.ceil(4.5 / SCAN_S)
    pcap.rdjovr(record := pcap.TSRP(an=0))
    assert record.jovr == 0.5


@pytest.mark.covers("apci.wrdpoffset", "apci.wrdvoffset", "apci.rddpoffset")
def test_an_offset_is_added_at_once_or_with_its_velocity(pc: Pc) -> None:
    pc.close(0)
    assert pcap.wrdpoffset(0, 0.5) == 0
    pc.board.advance(2)
    assert pc.rp(0) == near(0.5)
    assert pcap.wrdvoffset(0, 1.0) == 0
    assert pcap.wrdpoffset(0, 1.5) == 0
    pc.run(0.5)
    assert pc.rp(0) == near(1.0, abs=3 * SCAN_S)
    assert pcap.rddpoffset(0) == (0, 1.5)  # the programmed one
    pc.run(0.6)
    assert pc.rp(0) == near(1.5)


# ---------------------------------------------------------------------- inputs and outputs


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(n, marks=pytest.mark.covers(f"apci.digi.{n - 1}", f"apci.rddigib.bitnr.{n}"))
        for n in range(1, 17)
    ],
)
@pytest.mark.covers("apci.rddigi", "apci.rddigib", "apci.TSRP.digi")
def test_inputs_by_word_and_by_number(pc: Pc, number: int) -> None:
    record = pcap.TSRP(an=2)
    idle = 1 << 4  # input 5 is inverted: active while low
    pcap.rddigi(record)
    assert record.digi & 0xFFFF in (0, idle)
    pc.board.set_input(number, True)
    pc.board.advance(2)
    pcap.rddigi(record)
    assert record.digi & 0xFFFF == (0 if number == 5 else idle | 1 << (number - 1))
    assert pcap.rddigib(2, number) == (0 if number == 5 else 1)
    assert pcap.rddigib(2, 17 if number == 16 else number + 1) == (1 if number == 4 else 0)


@pytest.mark.parametrize("board", ["APCI-8001", "APCI-8008"])
@pytest.mark.parametrize("number", [21, 22, 23, 24])
@pytest.mark.covers(*(f"apci.digi.{bit}" for bit in (20, 21, 22, 23, "24-31")), "apci.rddigi", "apci.rddigib")
@pytest.mark.covers(*(f"apci.rddigib.bitnr.{number}" for number in (21, 22, 23, 24, "25-32")))
def test_alarms_of_an_encoder_are_seen_on_an_apci_8008_only(board: str, number: int) -> None:
    pc = Pc(f'board_type = "{board}"\n')
    pc.board.axes[1].alarms = 1 << number - 1
    pc.board.advance(1)
    records = pcap.TSRP(an=1), pcap.TSRP(an=2)
    shown = board == "APCI-8008"
    for read in (pcap.rddigi, pcap.rdap):
        for record in records:
            record.digi = 0
            read(record)
        assert [record.digi for record in records] == [shown << number - 1, 0]
    pcap.InitMcuSystem2(pc.tsrp, 0, "system.dat")
    assert [pc.tsrp[an].digi for an in range(3)] == [0, shown << number - 1, 0]
    assert isinstance(pc.board.tasks, BoardTasks)
    pc.board.tasks.load(sap.compile_program("CI1 := A2.digi; CI2 := A3.digi;"))
    pcap.startcnct(0)
    pc.board.advance(2)
    assert list(pc.board.state.ci[1:3]) == [shown << number - 1, 0]
    assert [pcap.rddigib(1, bit) for bit in range(17, 33)] == [
        shown and bit == number for bit in range(17, 33)
    ]
    pcap.rdigi(pcap.TSRP(an=1))  # resets bits 17 to 20 alone
    assert pcap.rddigib(1, number) == shown
    pcap.detach()


@pytest.mark.covers("apci.digi.16", "apci.rddigib.bitnr.17", "apci.rddigib.bitnr.25-32", "apci.rddigi")
@pytest.mark.covers("apci.rddigib", "apci.TSRP.digi")
def test_the_index_signal_is_seen_while_the_encoder_passes_it(pc: Pc) -> None:
    axes = pc.close(0)
    pc.tsrp[0].tp = 6.0
    pcap.jr(axes, pc.tsrp)
    seen = []
    while not pcap.rdaxstb(0, 13):
        before = pc.rp(0)
        pc.board.advance(1)
        own, other = pcap.TSRP(an=0), pcap.TSRP(an=1)
        pcap.rddigi(own)
        pcap.rddigi(other)
        assert (own.digi >> 16 & 1, other.digi >> 16 & 1) == (
            pcap.rddigib(0, 17),
            0,
        )  # the signal of this axis
        assert pcap.rddigib(1, 17) == 0
        if pcap.rddigib(0, 17):
            seen.append((before, pc.rp(0)))
        assert not any(pcap.rddigib(0, bit) for bit in range(25, 33))
    ((before, after),) = seen
    assert before < 4.0 <= after


@pytest.mark.covers("apci.rddigi", "apci.rddigib")
@pytest.mark.covers("apci.rdigi", "apci.digi.17", "apci.digi.18", "apci.digi.19", "apci.rddigib.bitnr.18")
@pytest.mark.covers("apci.rddigib.bitnr.19", "apci.rddigib.bitnr.20")
def test_rdigi_resets_the_latched_signals_of_its_axis(pc: Pc) -> None:
    pc.close(0)
    go(pc, 0, 10.0)  # over the index at 4
    pc.board.set_input(14, True)  # the strobe of axis 0
    pc.board.state.axis[0]["signals"] |= Digi.encoder_error
    pc.board.advance(2)
    assert [pcap.rddigib(0, bit) for bit in (18, 19, 20)] == [1, 1, 1]
    assert [pcap.rddigib(2, bit) for bit in (18, 19, 20)] == [0, 0, 0]
    pc.board.state.axis["signals"][:2] |= int(Digi.index)  # in this scan
    pcap.rdigi(pcap.TSRP(an=0))
    assert list(pc.board.state.axis["signals"][:2]) == [0, Digi.index]
    assert [pcap.rddigib(0, bit) for bit in (17, 18, 19, 20)] == [0, 0, 0, 0]
    pcap.rddigi(record := pcap.TSRP(an=0))
    assert record.digi & (Digi.encoder_error | Digi.index_latched | Digi.strobe_latched) == 0
    assert record.digi & Digi.input14


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(n, marks=pytest.mark.covers(f"apci.digo.{n - 1}", f"apci.wrdigob.bitnr.{n}"))
        for n in range(1, 9)
    ],
)
@pytest.mark.covers("apci.wrdigo", "apci.rddigo", "apci.wrdigob", "apci.rddigob", "apci.TSRP.digo")
def test_outputs_by_word_and_by_number(pc: Pc, number: int) -> None:
    record = pcap.TSRP(an=0, digo=0)
    pcap.wrdigo(record)
    pcap.wrdigob(1, number, 5)
    pcap.rddigo(record)
    assert record.digo == 1 << (number - 1)  # outputs are not those of an axis
    assert [pcap.rddigob(2, n) for n in range(1, 9)] == [int(n == number) for n in range(1, 9)]
    pcap.wrdigo(pcap.TSRP(an=0, digo=0xFF))
    pcap.wrdigob(0, number, 0)
    pcap.rddigo(record)
    assert record.digo == 0xFF & ~(1 << (number - 1))


@pytest.mark.covers("apci.rddigo", "apci.wrdigob", "apci.wrdigo")
@pytest.mark.covers("apci.rddigob")
@pytest.mark.covers("apci.wrdigob.bitnr.9-32", "apci.digo.8-31", "apci.const.digout")
def test_there_are_no_outputs_beyond_the_eighth(pc: Pc) -> None:
    record = pcap.TSRP(an=0, digo=-1)
    pcap.wrdigo(record)
    pcap.rddigo(record)
    assert record.digo == 0xFF
    for number in (0, *range(9, 33)):
        pcap.wrdigob(0, number, 0)
        assert pcap.rddigob(0, number) == 0
    pcap.rddigo(record)
    assert record.digo == 0xFF


@pytest.mark.covers("apci.ifs.0.edv", "apci.ifs.20.scpfe", "apci.ifs.21.BusError")
@pytest.mark.covers("apci.rdifs", "apci.rdifsb", "apci.rifs", "apci.TSRP.ifs", "apci.ifs.16.pfe")
@pytest.mark.covers("apci.ifs.17.wdog", "apci.ifs.18.iae", "apci.ifs.1.cncrdy")
def test_the_interface_status_and_its_reset(pc: Pc) -> None:
    record = pcap.TSRP(an=0)
    assert pcap.rdifs(record) == 0
    assert record.ifs == 0x110003  # valid data, ready, both supplies just switched on
    assert [pcap.rdifsb(0, bit) for bit in (1, 2, 3, 17, 18)] == [1, 1, 0, 1, 0]
    pc.slot.board.interface.report(0x260000)  # type: ignore[attr-defined]
    assert [number for number in range(1, 33) if pcap.rdifsb(0, number)] == [1, 2, 17, 18, 19, 21, 22]
    pcap.rifs(record)
    assert pcap.rdifs(record) == 0
    assert record.ifs == 0x200003  # what a connection lost stays until the board boots
    assert pcap.rdifs(pcap.TSRP(an=9)) == 1


@pytest.mark.parametrize("colour", ["gn", "yl", "rd"])
@pytest.mark.covers("apci.rdledgn", "apci.rdledyl", "apci.rdledrd", "apci.wrledgn", "apci.wrledyl")
@pytest.mark.covers("apci.wrledrd")
def test_each_light_is_switched_by_itself(pc: Pc, colour: str) -> None:
    lights = {name: getattr(pcap, f"rdled{name}") for name in ("gn", "yl", "rd")}
    assert [light() for light in lights.values()] == [0, 0, 0]
    getattr(pcap, f"wrled{colour}")(1)
    assert {name for name, light in lights.items() if light() == 1} == {colour}
    for name in lights:
        getattr(pcap, f"wrled{name}")(1)
    getattr(pcap, f"wrled{colour}")(0)
    assert {name for name, light in lights.items() if light() == 0} == {colour}
    getattr(pcap, f"wrled{colour}")(-4)  # anything but 0 is on
    assert [light() for light in lights.values()] == [1, 1, 1]


# ---------------------------------------------------------------------- latches, recording, interrupts


@pytest.mark.covers("apci.axst.16.lpsf")
@pytest.mark.covers("apci.lps", "apci.rdlp", "apci.wrlp", "apci.TSRP.lp", "apci.var.lp")
def test_lps_latches_every_so_many_scans_and_reading_clears_the_flag(pc: Pc) -> None:
    axes = pc.close(0)
    record = pcap.TSRP(an=0)
    pc.tsrp[0].tp = 100.0
    pcap.jr(axes, pc.tsrp)
    pc.run(1.0)
    pcap.lps(0, 10)
    flag = Axst.lpsf.bit_length()
    for _ in range(3):
        assert pcap.rdaxstb(0, flag) == 0
        pc.board.advance(9)
        assert pcap.rdaxstb(0, flag) == 0
        pc.board.advance(1)  # 12.8 ms
        assert pcap.rdaxstb(0, flag) == 1
        here = pc.rp(0)
        pcap.rdlp(record)
        assert record.lp == near(here)
    pcap.lps(0, 0)
    pc.board.advance(100)
    assert pcap.rdaxstb(0, flag) == 0
    record.lp = 1.25
    pcap.wrlp(record)
    record.lp = 0.0
    pcap.rdlp(record)
    assert record.lp == 1.25


@pytest.mark.covers("apci.rdlp", "apci.const.lplatency")
def test_an_input_and_the_strobe_latch_the_position_once_until_they_are_inactive(pc: Pc) -> None:
    axes = pc.close(0)
    record = pcap.TSRP(an=0)
    pc.tsrp[0].tp = 100.0
    pcap.jr(axes, pc.tsrp)
    for number in (3, 14):  # planned LP, and the hardware strobe of axis 0
        pc.run(0.3)
        here = pc.rp(0)
        pc.board.set_input(number, True)
        pc.board.advance(2)
        pcap.rdlp(record)
        assert here <= record.lp <= pc.rp(0)
        first = record.lp
        pc.board.advance(50)
        pcap.rdlp(record)
        assert record.lp == first  # still active: not armed again
        pc.board.set_input(number, False)
        pc.board.advance(2)
        pc.board.set_input(number, True)
        pc.board.advance(2)
        pcap.rdlp(record)
        assert record.lp > first


@pytest.mark.covers("apci.lpr", "apci.lprs", "apci.LATCH_INFOS")
def test_recording_begins_with_lpr_or_lprs(pc: Pc) -> None:
    pc.board.advance(10)
    axes = pc.close(0, 2)
    assert pcap.recording(2).shape == (0, 3)
    pcap.lpr(pcap.LATCH_INFOS(san=2))
    pc.tsrp[2].tp = 3.0
    pcap.jr(axes, pc.tsrp)
    places = []
    for _ in range(50):
        pc.board.advance(1)
        places.append(pc.rp(2))
    rows = pcap.recording(2)  # setpoint, actual position, commanded velocity
    assert rows[:, 0].tolist() == rows[:, 1].tolist() == places
    assert pcap.recording(0).shape == (0, 3)
    pcap.lprs(axes, pcap.LATCH_INFOS(san=1))  # san is ignored
    pc.board.advance(5)
    assert [pcap.recording(an).shape[0] for an in range(3)] == [5, 0, 5]
    pcap.lpr(pcap.LATCH_INFOS(san=9))
    assert pcap.recording(2)[-1, 1] == near(pc.rp(2))


@pytest.mark.covers("apci.rdirqpc", "apci.rule.interrupt", "apci.MCUG3_SetBoardIntRoutine")
@pytest.mark.covers("apci.MCUG3_ResetBoardIntRoutine", "apci.ssf.1101")
def test_an_interrupt_from_the_spooler_calls_the_routine_and_is_read(pc: Pc) -> None:
    calls: list[int] = []
    axes = pc.close(0)
    pcap.MCUG3_SetBoardIntRoutine(calls.append)
    assert pcap.rdirqpc() == 0
    pcap.ssf(0, 1101, 0.0)
    line(pc, axes, 1.0)
    pcap.ssms(axes)
    pc.board.advance(3)
    assert (pcap.rdirqpc(), calls) == (1, [1])
    pc.scans_until_rest()
    pc.board.raise_interrupt(False)
    pcap.MCUG3_ResetBoardIntRoutine()
    pcap.ssf(0, 1101, 0.0)
    line(pc, axes, 1.0)
    pcap.ssms(axes)
    pc.board.advance(3)
    assert (pcap.rdirqpc(), calls) == (1, [1])
