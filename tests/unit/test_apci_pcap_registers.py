"""Every register that the function library reads and writes: default, write, read, unit, and what cannot be written."""

import math
from collections.abc import Callable, Iterator

import pytest

from polycnc.controllers.apci import pcap
from support.apci_bits import Axst, ErrorReg, ModeReg
from support.apci_pc import LATENCY, SCAN_S, Pc, near

SYSTEM = """
[[axis]]
[[axis]]
unit = "mm"
time_unit = "min"
display_unit = "inch"
jac = 101.0
jvl = 102.0
jtvl = 13.0
hac = 104.0
hvl = 105.0
sdec = 106.0
sll = -107.0
slr = 108.0
ipw = 0.109
mpe = 0.11
gf = 0.25
slsp = 4000.0
jerkrel = 0.4
MaxVel = 111.0
MaxAcc = 112.0
MDVEL = 113.0
kp = 1.5
ki = 2.5
kd = 3.5
kpl = 0.5
kfca = 4.5
kfcv = 5.5
[[axis]]
unit = "deg"
effradius = 114.0
[board]
trac = 201.0
trvl = 202.0
trtvl = 20.0
trovrst = 0.5
modereg = ["lookahead", "MS_DECEL"]
nfrax = ["A3"]
"""


@pytest.fixture
def pc() -> Iterator[Pc]:
    yield Pc(SYSTEM)
    pcap.detach()


def row(name: str, *values: object, also: tuple[str, ...] = ()) -> object:
    """Return a case that claims the row of the function rd<name>; what writing does has a test of its own."""
    rows = (f"apci.rd{name}", *also)
    return pytest.param(name, *values, marks=pytest.mark.covers(*rows), id=name)


def pair(name: str, field: str, *values: object) -> object:
    """Return a case of a register that is read and written through an element of the record."""
    also = (f"apci.wr{name}", f"apci.TSRP.{field}")
    return row(name, field, *values, also=(*also, "apci.var.aux") if name == "aux" else also)


@pytest.mark.parametrize(
    ("stem", "field", "planned", "written"),
    [
        pair("jac", "jac", 101.0, (1234.5,)),
        pair("jvl", "jvl", 102.0, (6789.25,)),
        pair("jtvl", "jtv", 13.0, (0.0, -432.5)),
        pair("hac", "hac", 104.0, (2345.75,)),
        pair("hvl", "hvl", 105.0, (987.5,)),
        pair("sdec", "sdec", 106.0, (0.0, 345.25)),
        pair("sll", "sll", -107.0, (-1234.5,)),
        pair("slr", "slr", 108.0, (5678.25,)),
        pair("ipw", "ipw", 0.109, (0.0, 12.375)),
        pair("mpe", "mpe", 0.11, (0.0, 123.625)),
        pair("gf", "gf", 0.25, (1.625,)),
        pair("jovr", "jovr", 1.0, (0.625,)),
        pair("aux", "aux", 0.0, (-1234567.5,)),
        pair("tp", "tp", 0.0, (4321.75,)),
        pair("lp", "lp", 0.0, (-3210.5,)),
    ],
)
def test_an_element_of_the_record_is_the_planned_value_until_it_is_written(
    pc: Pc, stem: str, field: str, planned: float, written: tuple[float, ...]
) -> None:
    read, write = getattr(pcap, f"rd{stem}"), getattr(pcap, f"wr{stem}")
    others = [pcap.TSRP(an=axis) for axis in (0, 2)]
    for other in others:
        read(other)
    untouched = [getattr(other, field) for other in others]
    record = pcap.TSRP(an=1)
    read(record)
    assert getattr(record, field) == near(planned, rel=1e-15)
    for value in written:
        setattr(record, field, value)
        write(record)
        again = pcap.TSRP(an=1)
        read(again)
        assert getattr(again, field) == near(value, rel=1e-15)
        setattr(again, field, 0.0)
        assert again == pcap.TSRP(an=1)  # and nothing else of the record
    for other in others:
        read(other)
    assert [getattr(other, field) for other in others] == untouched  # every axis has its own


@pytest.mark.parametrize(
    ("stem", "planned", "written"),
    [
        row("EffRadius", 0.0, 123.75, also=("apci.wrEffRadius", "apci.var.effradius")),
        row("JerkRel", 0.4, 0.3125, also=("apci.wrJerkRel", "apci.jerkrel")),
        row("MaxVel", 111.0, 4567.25, also=("apci.wrMaxVel", "apci.var.MaxVel")),
        row("MaxAcc", 112.0, 7654.5, also=("apci.wrMaxAcc", "apci.var.MaxAcc")),
        row("MDVel", 113.0, 321.125, also=("apci.wrMDVel", "apci.var.MDVEL")),
        row("GCR", 0, 0x12345678, also=("apci.var.GCR", "apci.wrGCR")),
        row("ControllerFlags", 0, 0x40010081, also=("apci.var.ControllerFlags", "apci.wrControllerFlags")),
    ],
)
def test_a_register_by_axis_number_is_returned_and_written(
    pc: Pc, stem: str, planned: float, written: float
) -> None:
    read, write = getattr(pcap, f"rd{stem}"), getattr(pcap, f"wr{stem}")
    before = read(0), read(2)

    assert read(1) == planned
    if isinstance(written, int):
        for word in (-(1 << 31), -2, 1 << 30):  # every bit, also the highest
            write(1, word)
            assert read(1) == word
    write(1, written)
    assert read(1) == written
    assert type(read(1)) is type(written)
    assert (read(0), read(2)) == before


@pytest.mark.covers("apci.pcap.general.return_values")
@pytest.mark.parametrize(
    ("stem", "planned", "written"),
    [
        row("dpoffset", 0.0, -1234.5, also=("apci.wrdpoffset", "apci.var.dpoffset")),
        row("dvoffset", 0.0, 4567.5, also=("apci.wrdvoffset", "apci.var.dvoffset")),
        row("gfaux", 1.0, 2.625, also=("apci.var.gfaux", "apci.wrgfaux")),
    ],
)
def test_a_register_with_a_status_returns_0_and_its_value(
    pc: Pc, stem: str, planned: float, written: float
) -> None:
    read, write = getattr(pcap, f"rd{stem}"), getattr(pcap, f"wr{stem}")

    assert read(1) == (0, planned)
    assert write(1, written) == 0
    assert read(1) == (0, near(written, rel=1e-15))
    assert read(0) == (0, planned)


@pytest.mark.covers("apci.pcap.general.return_values")
@pytest.mark.parametrize(
    ("stem", "planned", "written"),
    [
        row("trac", 201.0, 1234.5, also=("apci.wrtrac",)),
        row("trvl", 202.0, 5678.25, also=("apci.wrtrvl",)),
        row("trtvl", 20.0, -4321.5, also=("apci.wrtrtvl",)),
        row("trovrst", 0.5, 12.375, also=("apci.wrtrovrst",)),
    ],
)
def test_a_variable_of_the_board_with_a_status(pc: Pc, stem: str, planned: float, written: float) -> None:
    read, write = getattr(pcap, f"rd{stem}"), getattr(pcap, f"wr{stem}")

    assert read() == (0, planned)
    for value in (written, 0.0, written / 3.0):
        assert write(value) == 0
        assert read() == (0, value)
    kept = -0.75 if stem == "trtvl" else value  # of these only a velocity at the end can be negative
    assert write(-0.75) == (kept != -0.75)
    assert read() == (0, kept)


@pytest.mark.covers(
    "apci.MODEREG.0.lookahead", "apci.MODEREG.15.MS_DECEL", "apci.MODEREG.28.JSatSAF", "apci.MODEREG.SProfile"
)
@pytest.mark.covers("apci.rdModeReg", "apci.wrModeReg", "apci.MODEREG")
def test_the_mode_register_is_read_and_written_as_a_whole_word(pc: Pc) -> None:
    assert pcap.rdModeReg() == ModeReg.lookahead | ModeReg.MS_DECEL == 0x8001
    pcap.wrModeReg(pcap.rdModeReg() | ModeReg.JSatSAF)
    assert pcap.rdModeReg() == 0x10008001
    pcap.wrModeReg(ModeReg.SProfile)
    assert pcap.rdModeReg() == ModeReg.SProfile  # what was on before is off


@pytest.mark.covers("apci.rdnfrax", "apci.wrnfrax", "apci.NFRAX")
def test_axes_in_nfrax_do_not_count_for_the_path_velocity(pc: Pc) -> None:
    assert pcap.rdnfrax() == 0b100
    axes = pc.close(0, 1)
    pcap.wrnfrax(0b010)
    assert pcap.rdnfrax() == 0b010
    lmp = pcap.LMP(ac=1e9, vl=10.0, dtm=[30.0, 40.0, *[0.0] * 16])
    pcap.mlr(axes, lmp)
    pc.run(1.0)
    assert pc.dv(0) == near(10.0)  # not 6.0: axis 1 rides along
    assert pc.dv(1) == near(10.0 * 4.0 / 3.0 * 60.0)  # per minute


@pytest.mark.covers("apci.rdtrovr", "apci.wrtrovr", "apci.rdjovr", "apci.wrtrovrst", "apci.rdtrovrst")
def test_the_trajectory_override_reads_as_programmed_and_jovr_shows_what_is_in_force(pc: Pc) -> None:
    assert pcap.wrtrovrst(2.0) == 0
    pcap.wrtrovr(0.5)
    assert pcap.rdtrovr() == 0.5
    pcap.rdjovr(pc.tsrp[0])
    assert pc.tsrp[0].jovr == 1.0  # only stored
    pcap.utrovr(pcap.AS.of(0))
    pc.run(0.5)  # of the 1 s that 1.0 to 0.5 takes
    assert pcap.rdtrovr() == 0.5
    pcap.rdjovr(pc.tsrp[0])
    assert pc.tsrp[0].jovr == near(0.75, abs=2 * SCAN_S)
    pcap.wrtrovr(0.0)
    pcap.wrtrovr(-1.0)
    assert pcap.rdtrovr() == 0.5  # only factors above 0


@pytest.mark.covers("apci.rdSampleTime")
@pytest.mark.covers("apci.rdslsp", "apci.ret.bool.1", "apci.ret.bool.0")
def test_slsp_is_read_with_1_for_success_and_only_positive_values_are_written(pc: Pc) -> None:
    assert pcap.rdslsp(1) == (1, 4000.0)
    pcap.wrslsp(1, 8000.0)
    assert pcap.rdslsp(1) == (1, 8000.0)
    pcap.wrslsp(1, 0.0)
    pcap.wrslsp(1, -1.0)
    assert pcap.rdslsp(1) == (1, 8000.0)
    pc.slot.stop()
    assert pcap.rdslsp(1) == (0, 0.0)
    assert pcap.rdSampleTime() == (0, 0)


@pytest.mark.covers("apci.rdSampleTime", "apci.const.sampletime", "apci.ret.bool.1", "apci.ctrl.scantime")
def test_the_sample_time_is_1280_microseconds(pc: Pc) -> None:
    assert pcap.rdSampleTime() == (1, 1280)
    before = pc.board.time_s
    pc.board.advance(1)
    assert pc.board.time_s - before == near(1280e-6)
    for sample_time_us in (1023, 639, 99_999):  # to the microsecond, as it is planned
        other = Pc(f"sample_time_us = {sample_time_us}\n")
        assert pcap.rdSampleTime() == (1, sample_time_us)
        other.board.advance(3)
        assert other.board.time_s == near(3e-6 * sample_time_us)


@pytest.mark.covers(
    "apci.uf",
    "apci.TSRP.kp",
    "apci.TSRP.ki",
    "apci.TSRP.kd",
    "apci.TSRP.kpl",
    "apci.TSRP.kfca",
    "apci.TSRP.kfcv",
)
@pytest.mark.covers("apci.rdf")
def test_the_filter_is_read_and_sent_as_a_whole(pc: Pc) -> None:
    record = pcap.TSRP(an=1)
    pcap.rdf(record)
    assert record == pcap.TSRP(an=1, kp=1.5, ki=2.5, kd=3.5, kpl=0.5, kfca=4.5, kfcv=5.5)
    sent = pcap.TSRP(an=1, kp=10.0, ki=0.0, kd=1.0, kpl=0.95, kfca=2.0, kfcv=3.0, jac=9.0)
    pcap.uf(sent)
    pcap.rdf(record)
    assert (record.kp, record.ki, record.kd, record.kpl, record.kfca, record.kfcv) == (
        *(10.0, 0.0, 1.0, 0.95, 2.0, 3.0),
    )
    servo = pc.board.kernel.servo.row[1]
    assert (servo["kp"], servo["kpl"], servo["kfcv"]) == (10.0, 0.95, 3.0)  # at once, in the position loop
    pcap.rdjac(record)
    assert record.jac == near(101.0)  # uf sends nothing else
    pcap.uf(pcap.TSRP(an=1, kp=math.nan))
    assert servo["kp"] == 10.0


@pytest.mark.covers("apci.wrJerkRel", "apci.rdJerkRel")
def test_relative_jerk_is_limited_to_0_to_1_and_its_default_is_1(pc: Pc) -> None:
    assert pcap.rdJerkRel(0) == 1.0
    for written, stored in ((-0.5, 0.0), (3.0, 1.0), (0.2, 0.2)):
        pcap.wrJerkRel(0, written)
        assert pcap.rdJerkRel(0) == stored


@pytest.mark.covers("apci.rdtp", "apci.rdrp", "apci.rddp", "apci.wrjtvl", "apci.wrjvl")
@pytest.mark.covers("apci.rdrpd", "apci.rddpd", "apci.rdtpd", "apci.rule.display_units")
def test_positions_in_the_display_unit(pc: Pc) -> None:
    axes = pc.close(1)  # mm, displayed in inches
    pcap.wrdpoffset(1, 2.54)
    pc.tsrp[1].tp = 50.8
    pcap.wrjvl(pcap.TSRP(an=1, jvl=60_000.0))
    pcap.wrjac(pcap.TSRP(an=1, jac=3.6e7))
    pcap.wrjtvl(pcap.TSRP(an=1, jtv=0.0))
    pcap.ja(axes, pc.tsrp)
    pc.scans_until_rest()
    record = pcap.TSRP(an=1)
    pcap.rdtp(record)
    assert record.tp == near(50.8)
    pcap.rdtpd(record)
    assert record.tp == near(2.0)
    pcap.rdrpd(record)
    pcap.rddpd(record)
    in_inches = record.rp, record.dp
    pcap.rdrp(record)
    pcap.rddp(record)
    assert (record.rp, record.dp) == (near(53.34), near(53.34))
    assert in_inches == (near(2.1), near(2.1))


@pytest.mark.covers("apci.rdtp", "apci.wrtp", "apci.TSRP.tp")
def test_the_target_is_that_of_the_last_travel_command_and_always_absolute(pc: Pc) -> None:
    axes = pc.close(0)
    record = pcap.TSRP(an=0)
    for distance, target in ((5.0, 5.0), (-2.0, 3.0)):
        pc.tsrp[0].tp = distance
        pcap.jr(axes, pc.tsrp)
        pc.scans_until_rest()
        pcap.rdtp(record)
        assert record.tp == near(target)
    lmp = pcap.LMP(ac=100.0, vl=10.0, dtm=[1.5, *[0.0] * 17])
    pcap.mlr(axes, lmp)
    pc.scans_until_rest()
    pcap.rdtp(record)
    assert record.tp == near(4.5)
    record.tp = 7.0
    pcap.wrtp(record)
    pc.run(0.1)
    pcap.rdtp(record)
    assert record.tp == 7.0
    assert pc.rp(0) == near(4.5)  # writing it moves nothing


@pytest.mark.covers("apci.wrjtvl")
@pytest.mark.covers("apci.rdrp", "apci.rddp", "apci.rddv", "apci.rdrv", "apci.rdPosErr", "apci.TSRP.dv")
@pytest.mark.covers("apci.profile.acceleration", "apci.profile.max_velocity", "apci.wrjac", "apci.wrjvl")
@pytest.mark.covers("apci.TSRP.rp", "apci.TSRP.dp", "apci.var.dv", "apci.var.rv", "apci.var.PosErr")
def test_positions_and_velocities_during_a_jog() -> None:
    pc = Pc(
        '[[axis]]\ntime_unit = "min"\n[axis.plant]\nkind = "lag"\nlag_s = 0.005\nvelocity_at_10_v = 12000\n'
    )
    axes = pc.close(0)
    record = pcap.TSRP(an=0, jac=100.0 * 3600.0, jvl=50.0 * 60.0, jtv=0.0)
    for write in (pcap.wrjac, pcap.wrjvl, pcap.wrjtvl):
        write(record)
    pc.tsrp[0].tp = 100.0
    pcap.ja(axes, pc.tsrp)
    ramp = round(0.32 / SCAN_S)
    pc.board.advance(LATENCY + ramp)  # on the ramp the axis is slower than its setpoint, by a / kp
    pcap.rddv(record)
    assert record.dv == near(100.0 * 0.32 * 60.0, abs=60.0 * 100.0 * SCAN_S)
    assert pcap.rdrv(0) == near(60.0 * (100.0 * 0.32 - 100.0 / 20.0), rel=0.02)
    scans = round(1.28 / SCAN_S) - ramp
    pc.board.advance(scans)  # 1.28 s after the start: 0.5 s of ramp, 12.5 mm, and 0.78 s at 50 mm/s
    pcap.rddp(record)
    pcap.rddv(record)
    assert record.dp == near(12.5 + 0.78 * 50.0, abs=50.0 * SCAN_S)
    assert record.dv == near(3000.0)
    pcap.rdrp(record)
    assert pcap.rdPosErr(0) == near(record.dp - record.rp)
    assert pcap.rdPosErr(0) == near(50.0 / 20.0, rel=0.01)  # v / kp without feed-forward
    assert pcap.rdrv(0) == near(3000.0, rel=1e-3)
    assert (pcap.rdrv(1), pcap.rdPosErr(1)) == (0.0, 0.0)
    pcap.detach()


@pytest.mark.covers("apci.axst.17.referenced", "apci.rdaxstb")
@pytest.mark.covers("apci.wrrp", "apci.rdrp")
def test_the_actual_position_is_written_with_open_loop_only_and_the_reference_is_lost(pc: Pc) -> None:
    record = pcap.TSRP(an=0, tp=5.0, rp=12.0)
    pcap.shp(record)
    assert pcap.rdaxstb(0, 18) == 1  # referenced
    pcap.wrrp(record)
    assert pc.rp(0) == 12.0
    assert pcap.rdaxstb(0, 18) == 0
    pc.close(0)
    record.rp = 99.0
    pcap.wrrp(record)
    assert pc.rp(0) == 12.0


@pytest.mark.covers("apci.wrdp", "apci.rddp")
def test_the_setpoint_is_written_with_closed_loop_only(pc: Pc) -> None:
    record = pcap.TSRP(an=0, dp=1.5)
    pcap.wrdp(record)
    pc.board.advance(2)
    assert pc.rp(0) == 0.0
    pc.close(0)
    pcap.wrdp(record)
    pc.board.advance(2)
    pcap.rddp(record)
    assert (record.dp, pc.rp(0)) == (1.5, 1.5)


@pytest.mark.covers("apci.wrmcp", "apci.rdmcp", "apci.TSRP.mcp", "apci.const.mcpservo", "apci.const.mcpstep")
def test_the_motor_command_port() -> None:
    pc = Pc('[[axis]]\n[[axis]]\nmotor = "stepper"\nslsp = 200.0\ngf = 1.0\n')
    servo, stepper = pcap.TSRP(an=0, mcp=40_000), pcap.TSRP(an=1, mcp=999)
    pcap.rdmcp(servo)
    assert servo.mcp == 0  # after the start
    for value, stored in ((40_000, 32767), (-40_000, -32767), (16384, 16384)):
        servo.mcp = value
        pcap.wrmcp(servo)
        pcap.rdmcp(servo)
        assert servo.mcp == stored
    pc.board.advance(100)
    assert pcap.rdrv(0) == near(200.0 * 16384 / 32767)  # half of 10 V, 200 mm/s at 10 V

    pcap.wrmcp(stepper)
    pc.board.advance(100)
    assert pcap.rdrv(1) == near(35_000.0 / 200.0)  # 70 MHz / 2 / 1000 = 35 kHz
    stepper.mcp = -2_000_000
    pcap.wrmcp(stepper)
    pcap.rdmcp(stepper)
    assert stepper.mcp == -1_048_574
    stepper.mcp = 0
    pcap.wrmcp(stepper)
    pc.board.advance(2)
    assert pcap.rdrv(1) == 0.0

    pc.close(0)
    servo.mcp = 16384
    pcap.wrmcp(servo)
    pc.board.advance(1)
    pcap.rdmcp(servo)
    assert servo.mcp == 0  # the position loop writes it
    pcap.detach()


@pytest.mark.covers("apci.rdaxst", "apci.rdaxstb", "apci.TSRP.axst", "apci.pcap.general.profile_end")
def test_the_axis_status_by_word_and_by_bit(pc: Pc) -> None:
    axes = pc.close(0)
    record = pcap.TSRP(an=0)
    pcap.rdaxst(record)
    assert record.axst & (Axst.pe | Axst.cl) == Axst.pe | Axst.cl
    pc.tsrp[0].tp = 10.0
    pcap.jr(axes, pc.tsrp)
    assert (pcap.rdaxstb(0, 13), pcap.rdaxstb(0, 14)) == (0, 1)  # pe and cl: bits count from 1
    pcap.rdaxst(record)
    assert record.axst & Axst.pe == 0
    other = pcap.TSRP(an=1)  # open, and at rest
    pcap.rdaxst(other)
    assert other.axst & (Axst.pe | Axst.cl) == Axst.pe
    pcap.rdap(other)
    assert other.axst & (Axst.pe | Axst.cl) == Axst.pe
    pc.scans_until_rest()
    assert (pcap.rdaxstb(0, 13), pcap.rdaxstb(1, 14)) == (1, 0)
    assert [pcap.rdaxstb(0, bit) for bit in (0, -1, 33)] == [0, 0, 0]
    lmp = pcap.LMP(ac=100.0, vl=50.0, dtm=[5.0, *[0.0] * 17])  # queued moves have one end, that of the last
    for _ in range(2):
        pcap.smlr(axes, lmp)
        pcap.ssf(0, 1003, 100)
    pcap.smlr(axes, lmp)
    pcap.ssms(axes)
    seen = []
    for _ in range(1200):
        pc.board.advance(1)
        seen.append(pcap.rdaxstb(0, 13))
    assert seen == sorted(seen)
    assert (seen[5], seen[-1], pc.rp(0)) == (0, 1, 25.0)


@pytest.mark.covers("apci.sdels")
@pytest.mark.covers("apci.rdlsm", "apci.rdMCiS", "apci.TSRP.lsm", "apci.const.spoolmem")
def test_the_spooler_memory_shrinks_and_motion_commands_are_counted(pc: Pc) -> None:
    axes = pc.close(0)
    record = pcap.TSRP(an=0)
    pcap.rdlsm(record)
    assert record.lsm == 145_000
    lmp = pcap.LMP(ac=100.0, vl=10.0, dtm=[5.0, *[0.0] * 17])
    pcap.smlr(axes, lmp)
    pcap.ssf(0, 1001, 1)
    pcap.smlr(axes, lmp)
    assert pcap.rdMCiS(0) == 2  # ssf is no motion
    used = 145_000
    pcap.rdlsm(record)
    used -= record.lsm
    assert used > 0
    pcap.sdels(axes)
    pcap.rdlsm(record)
    assert (record.lsm, pcap.rdMCiS(0)) == (145_000, 0)


@pytest.mark.covers("apci.rdepc", "apci.TSRP.epc", "apci.const.eeprom")
def test_eeprom_cycles_are_those_of_the_board(pc: Pc) -> None:
    record = pcap.TSRP(an=0)
    pc.slot.board.eprom_cycles = 10_000  # type: ignore[attr-defined]
    pcap.rdepc(record)
    assert record.epc == 10_000


@pytest.mark.covers("apci.ErrorReg.2.errUnit")
@pytest.mark.covers("apci.rdErrorReg")
def test_the_error_register_belongs_to_the_board_and_stays(pc: Pc) -> None:
    assert pcap.rdErrorReg() == 0
    pcap.ctru(pcap.TRU(pu=8))
    assert pcap.rdErrorReg() == int(ErrorReg.errUnit)
    pcap.rs()
    assert pcap.rdErrorReg() == 4


@pytest.mark.covers(
    *(f"apci.TSRP.{each}" for each in ("kp", "jvl", "rp", "tp", "lsm", "epc", "digi", "digo", "scratch")),
    *(
        f"apci.{each}"
        for each in ("rdf", "rdjvl", "rdrp", "rdtp", "rdlsm", "rdepc", "rddigi", "rddigo", "rdifs", "wrdigo")
    ),
)
@pytest.mark.covers("apci.rdap", "apci.TSRP.an")
def test_rdap_reads_all_of_the_record_that_the_table_lists(pc: Pc) -> None:
    pcap.wrrp(pcap.TSRP(an=1, rp=-1234.5))
    pcap.wrtp(pcap.TSRP(an=1, tp=4321.25))
    pcap.wrdigo(pcap.TSRP(an=1, digo=0xA5))
    pc.slot.board.eprom_cycles = 4321  # type: ignore[attr-defined]
    for number in (3, 11):
        pc.board.set_input(number, True)
    pc.board.advance(3)
    record = pcap.TSRP(an=1, scratch=[1, 2, 3, 4], aux=1.0, lp=2.0, dv=3.0, sdec=4.0)
    pcap.rdap(record)
    assert (record.an, list(record.scratch)) == (1, [1, 2, 3, 4])
    assert (record.aux, record.lp, record.dv, record.sdec) == (1.0, 2.0, 3.0, 4.0)  # stand in no table
    single = pcap.TSRP(an=1, scratch=[1, 2, 3, 4], aux=1.0, lp=2.0, dv=3.0, sdec=4.0)
    functions: list[Callable[[pcap.TSRP], object]] = [
        *(pcap.rdf, pcap.rdjac, pcap.rdjvl, pcap.rdjtvl, pcap.rdjovr, pcap.rdhac, pcap.rdhvl, pcap.rdrp),
        *(pcap.rddp, pcap.rdtp, pcap.rdsll, pcap.rdslr, pcap.rdipw, pcap.rdmpe, pcap.rdgf, pcap.rdmcp),
        *(pcap.rdaxst, pcap.rdlsm, pcap.rdepc, pcap.rddigi, pcap.rddigo, pcap.rdifs),
    ]
    for function in functions:
        function(single)
    assert record == single
    assert (record.kp, record.jvl, record.lsm) == (1.5, near(102.0), 145_000)
    assert (record.rp, record.tp, record.epc) == (near(-1234.5), near(4321.25), 4321)
    assert (record.digi & 0xFFFF, record.digo, record.ifs & 2) == (0x404, 0xA5, 2)
    record.an = 7
    pcap.rdap(record)
    assert record.kp == 1.5  # there is no such axis


@pytest.mark.covers("apci.scp", "apci.CTRLPARAMS")
def test_scp_sends_a_field_of_15_by_15(pc: Pc) -> None:
    parameters = pcap.CTRLPARAMS()
    parameters.parameters[2][14] = 0.5
    pcap.scp(1, parameters)
    assert pc.board.axes[1].ctrlparams[2, 14] == 0.5
    assert pc.board.axes[1].ctrlparams.sum() == 0.5
    assert pc.board.axes[0].ctrlparams.sum() == 0.0
    parameters.parameters[0][0] = math.nan
    pcap.scp(0, parameters)
    assert pc.board.axes[0].ctrlparams.sum() == 0.0


@pytest.mark.covers(
    "apci.sysvar", "apci.rdSysVarInt", "apci.rdSysVarDbl", "apci.wrSysVarInt", "apci.wrSysVarDbl"
)
@pytest.mark.covers("apci.axvar", "apci.rdAxVarInt", "apci.rdAxVarDbl", "apci.wrAxVarInt", "apci.wrAxVarDbl")
def test_variables_of_special_firmware(pc: Pc) -> None:
    pcap.wrSysVarInt(1, -7)
    pcap.wrSysVarDbl(1, 0.5)
    pcap.wrAxVarInt(2, 1, 2**31)  # does not fit into 32 bits
    pcap.wrAxVarDbl(2, 1, -1000.0 / 3.0)
    assert (pcap.rdSysVarInt(1), pcap.rdSysVarDbl(1)) == (-7, 0.5)
    assert (pcap.rdAxVarInt(2, 1), pcap.rdAxVarDbl(2, 1)) == (-(2**31), -1000.0 / 3.0)
    pcap.wrSysVarDbl(1, 1.0 / 3.0)
    pcap.wrSysVarInt(1, 123_456_789)
    pcap.wrAxVarInt(2, 1, -123_456_789)
    assert (pcap.rdSysVarInt(1), pcap.rdSysVarDbl(1), pcap.rdAxVarInt(2, 1)) == (
        123_456_789,
        1.0 / 3.0,
        -123_456_789,
    )
    assert (pcap.rdSysVarInt(0), pcap.rdSysVarDbl(0), pcap.rdAxVarInt(1, 1), pcap.rdAxVarDbl(2, 0)) == (
        0,
    ) * 4
    for ndx in (0, 99):  # the first and the last
        pcap.wrSysVarInt(ndx, ndx - 55_555)
        pcap.wrSysVarDbl(ndx, ndx + 0.25)
        for an in range(3):
            pcap.wrAxVarInt(an, ndx, 44_444 - 7 * an - ndx)
            pcap.wrAxVarDbl(an, ndx, -0.125 - 3 * an - ndx)
    for ndx in (0, 99):
        assert (pcap.rdSysVarInt(ndx), pcap.rdSysVarDbl(ndx)) == (ndx - 55_555, ndx + 0.25)
        assert [pcap.rdAxVarInt(an, ndx) for an in range(3)] == [44_444 - 7 * an - ndx for an in range(3)]
        assert [pcap.rdAxVarDbl(an, ndx) for an in range(3)] == [-0.125 - 3 * an - ndx for an in range(3)]
    pcap.wrSysVarDbl(-1, 3.0)
    assert (pcap.rdSysVarDbl(-1), pcap.rdSysVarDbl(999), pcap.rdAxVarInt(0, 5000)) == (0.0, 0.0, 0)
