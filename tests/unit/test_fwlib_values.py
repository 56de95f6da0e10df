"""What the elements of structures say on a control that lives, where other tests show where they lie (Manual 000)."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from datetime import datetime
from functools import partial
from typing import Any

import pytest

from polycnc.cnc import RunState
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.data._configuration import Configuration
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW
from support.power_mate import OK, attached, psd, registered, running

AT = datetime(2031, 11, 23, 22, 58, 37)


def covers(*rows: str) -> pytest.MarkDecorator:
    return pytest.mark.covers(*(f"fanuc.{row}" for row in rows))


@pytest.mark.covers("fanuc.cnc_clearophis", "fanuc.cnc_stopophis")
@covers(
    "ODBAHIS.s_no", "ODBAHIS.e_no", "ODBAHIS.alm_his.alm_no", "ODBAHIS.alm_his.year", "ODBAHIS.alm_his.month",
    "ODBAHIS.alm_his.day", "ODBAHIS.alm_his.hour", "ODBAHIS.alm_his.minute", "ODBAHIS.alm_his.second",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdalmhistry")
@pytest.mark.covers("fanuc.ODBAHIS")
def test_an_alarm_of_the_history_says_when_it_came() -> None:
    control, handle = attached()
    assert fwlib.cnc_clearophis(handle, 1) == OK
    control.clock.set_now(AT)
    control.raise_alarm(85)
    control.clock.set_now(datetime(2045, 2, 3, 4, 5, 6))
    control.raise_alarm(417, axis=2)
    control.raise_alarm(700)
    assert fwlib.cnc_stopophis(handle) == OK
    code, found = fwlib.cnc_rdalmhistry(handle, 1, 2, 6 + 2 * 48)
    assert (code, found.s_no, found.e_no) == (OK, 1, 2)
    first, second = found.alm_his[:2]
    times = [
        (each.year, each.month, each.day, each.hour, each.minute, each.second) for each in (first, second)
    ]
    assert times == [(31, 11, 23, 22, 58, 37), (45, 2, 3, 4, 5, 6)]
    assert (first.alm_no, second.alm_no) == (85, 417)
    code, found = fwlib.cnc_rdalmhistry(handle, 2, 3, 6 + 2 * 48)
    assert (code, found.s_no, found.e_no, found.alm_his[1].alm_no) == (OK, 2, 3, 700)


@pytest.mark.covers("fanuc.cnc_clearophis", "fanuc.cnc_stopophis")
@covers(
    "ODBHIS.alm_no",
    "ODBHIS.key_code",
    "ODBHIS.month",
    "ODBHIS.day",
    "ODBHIS.hour",
    "ODBHIS.minute",
    "ODBHIS.second",
)
@pytest.mark.covers("fanuc.cnc_rdophistry")
@pytest.mark.covers("fanuc.ODBHIS")
@pytest.mark.covers("fanuc.cnc_rdophisno")
def test_records_of_the_operation_history_say_what_was_done_and_when() -> None:
    control, handle = attached()
    control.clock.set_now(AT)
    assert fwlib.cnc_clearophis(handle, 0) == OK
    control.power_cycle()  # notes date and time
    control.history.press_key(0x47)
    control.raise_alarm(5011)
    assert fwlib.cnc_stopophis(handle) == OK
    count = fwlib.cnc_rdophisno(handle)[1]
    code, found = fwlib.cnc_rdophistry(handle, 1, count, 6 + 8 * count)
    assert code == OK
    records = {each.rec_mdi.rec_type: each for each in found.data[:count]}
    assert records[0].rec_mdi.key_code == 0x47
    assert records[2].rec_alm.alm_no == 5011
    assert (records[3].rec_date.month, records[3].rec_date.day) == (11, 23)
    time = records[4].rec_time
    assert (time.hour, time.minute, time.second) == (22, 58, 37)


@pytest.mark.covers("fanuc.cnc_alarm")
@covers("ODBALM.data", "ALMINFO.alm.alm_no", "ODBST.alarm")
@pytest.mark.covers("fanuc.cnc_rdalminfo", "fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.ALMINFO", "fanuc.ODBALM", "fanuc.ODBST")
def test_alarms_as_bits_and_by_number() -> None:
    control, handle = attached()
    assert (fwlib.cnc_alarm(handle)[1].data, fwlib.cnc_statinfo(handle)[1].alarm) == (0, 0)
    control.raise_alarm(417, axis=3)
    control.raise_alarm(506, axis=1)
    assert fwlib.cnc_alarm(handle)[1].data == 1 << 6 | 1 << 4
    assert fwlib.cnc_statinfo(handle)[1].alarm == 1
    code, found = fwlib.cnc_rdalminfo(handle, 0, 1 << 6, 2 + 2 * 4)
    assert (code, found.u.alm1.alm[0].alm_no, found.u.alm1.alm[0].axis) == (OK, 417, 3)


@pytest.mark.covers("fanuc.cnc_statinfo")
@covers("ODBST.run", "ODBST.motion", "ODBST.emergency", "ODBST.edit")
@pytest.mark.covers("fanuc.cnc_dwnstart")
@pytest.mark.covers("fanuc.ODBST")
def test_the_state_of_a_control_that_runs_holds_dwells_and_stops() -> None:
    control, handle = attached(axes=1)
    registered(control, O7="\nG1X4.F3000\nG4X0.2\nM30\n")

    def state() -> tuple[int, int, int, int]:
        found = fwlib.cnc_statinfo(handle)[1]
        return found.run, found.motion, found.emergency, found.edit

    assert state() == (0, 0, 0, 0)
    running(control, 7)
    control.advance(30)
    assert state() == (4, 1, 0, 0)
    control.feed_hold()
    control.advance(200)
    assert state() == (2, 0, 0, 0)
    control.cycle_start()
    control.advance(150)
    assert state() == (4, 3, 0, 0)
    control.emergency_stop(True)
    control.advance(50)
    assert state()[2] == 1
    control.emergency_stop(False)
    control.reset()
    assert fwlib.cnc_dwnstart(handle) == OK
    assert state() == (0, 0, 0, 6)


PANEL: dict[str, tuple[int, int, Callable[[PowerMate], object], object]] = {
    "mode": (0, 3, lambda it: it.mode.label, "HND"),
    "feed_ovrd": (5, 7, lambda it: it.signals.feed_override, 70),
    "sngl_blck": (8, 1, lambda it: it.control.switches.single_block, True),
    "machn_lock": (9, 1, lambda it: it.control.switches.machine_lock, True),
    "dry_run": (10, 1, lambda it: it.control.switches.dry_run, True),
    "feed_hold": (12, 1, lambda it: it.signals.state.hold_is_on, True),
}


@covers("IODBSGNL.type")
@pytest.mark.parametrize("name", [pytest.param(each, marks=covers(f"IODBSGNL.{each}")) for each in PANEL])
@pytest.mark.covers("fanuc.cnc_rdopnlsgnl", "fanuc.cnc_wropnlsgnl")
@pytest.mark.covers("fanuc.IODBSGNL")
def test_a_signal_of_the_panel_acts(name: str) -> None:
    bit, value, seen, wanted = PANEL[name]
    control, handle = attached()
    before = {each: read(control) for each, (_, _, read, _) in PANEL.items()}
    given = {each: number for each, (_, number, _, _) in PANEL.items()}
    assert fwlib.cnc_wropnlsgnl(handle, fwlib.IODBSGNL(type=1 << bit, **given)) == OK
    assert seen(control) == wanted
    for other, (_, _, read, _) in PANEL.items():
        assert other == name or read(control) == before[other]
    code, found = fwlib.cnc_rdopnlsgnl(handle, 1 << bit)
    assert (code, found.type, getattr(found, name)) == (OK, 1 << bit, value)


@pytest.mark.covers("fanuc.cnc_wropnlgnrl")
@covers("IODBGNRL.type")
@pytest.mark.covers("fanuc.cnc_rdopnlgnrl")
@pytest.mark.covers("fanuc.IODBGNRL")
def test_general_purpose_signals_are_chosen_by_their_bits() -> None:
    _, handle = attached()
    assert fwlib.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=0x2C, sgnal=0xFF)) == OK
    code, found = fwlib.cnc_rdopnlgnrl(handle, 0x0F)
    assert (code, found.type, found.sgnal) == (OK, 0x0F, 0x0C)


@pytest.mark.covers("fanuc.pmc_wrpmcrng")
@covers("IODBPMC.type_a", "IODBPMC.datano_s", "IODBPMC.datano_e")
@pytest.mark.covers("fanuc.pmc_rdpmcrng")
@pytest.mark.covers("fanuc.IODBPMC")
def test_pmc_data_say_what_they_are_of() -> None:
    control, handle = attached()
    control.pmc.write("D", 101, b"\x11\x22\x33")
    code, found = fwlib.pmc_rdpmcrng(handle, 9, 0, 101, 103, 8 + 3)
    assert (code, found.type_a, found.datano_s, found.datano_e) == (OK, 9, 101, 103)
    found.datano_s, found.datano_e = 111, 113
    assert fwlib.pmc_wrpmcrng(handle, 8 + 3, bytes(found)) == OK
    assert control.pmc.read("D", 110, 114) == b"\0\x11\x22\x33\0"
    found.type_a = 5  # R
    assert fwlib.pmc_wrpmcrng(handle, 8 + 3, bytes(found)) == OK
    assert control.pmc.read("R", 111, 113) == b"\x11\x22\x33"


@pytest.mark.covers("fanuc.pmc_rdpmcinfo")
@covers("ODBPMCINF.info.pmc_adr", "ODBPMCINF.info.top_num", "ODBPMCINF.info.last_num")
@pytest.mark.covers("fanuc.pmc_rdpmcrng", "fanuc.pmc_rdpmcrng.err.EW_NUMBER")
@pytest.mark.covers("fanuc.ODBPMCINF")
def test_pmc_areas_have_a_letter_and_ends() -> None:
    _, handle = attached()
    code, found = fwlib.pmc_rdpmcinfo(handle, 7)
    parts = [(chr(each.pmc_adr), each.top_num, each.last_num) for each in found.info[: found.datano]]
    assert (code, parts) == (OK, [("K", 0, 16), ("K", 17, 19)])
    for address in (0, 16, 17, 19):
        assert fwlib.pmc_rdpmcrng(handle, 7, 0, address, address, 9)[0] == OK
    assert fwlib.pmc_rdpmcrng(handle, 7, 0, 20, 20, 9)[0] == EW.EW_NUMBER


@pytest.mark.covers("fanuc.cnc_wrparam", "fanuc.cnc_rdparam", "fanuc.ALL_AXES")
@covers("IODBPSD.datano", "IODBPSD.type", "IODBPSD.u.ldata", "IODBPSD.u.ldatas")
@pytest.mark.covers("fanuc.struct.IODBPSD")
@pytest.mark.covers("fanuc.concept.axis_number", "fanuc.ncparam.1320", "fanuc.ncparam.1321")
@pytest.mark.covers("fanuc.enum.param_axis.1..m")
def test_stroke_limits_are_written_and_read_by_number_and_axis() -> None:
    control, handle = attached()
    assert fwlib.cnc_wrparam(handle, 8, psd(1320, 2, ldata=98_765)) == OK
    code, one = fwlib.cnc_rdparam(handle, 1320, 2, 8)
    assert (code, one.datano, one.type, one.u.ldata) == (OK, 1320, 2, 98_765)
    code, every = fwlib.cnc_rdparam(handle, 1320, ALL_AXES, 4 + 4 * 3)
    assert (code, every.datano, every.type) == (OK, 1320, ALL_AXES)
    assert list(every.u.ldatas)[:3] == [99_999_999, 98_765, 99_999_999]
    assert control.machine.config.axes[1].soft_limits[1] == 98.765


@covers("IODBPSD.u.cdata", "IODBPSD.u.cdatas", "IODBPSD.u.idata", "IODBPSD.u.idatas")
@pytest.mark.covers("fanuc.cnc_rdparam", "fanuc.cnc_wrparam")
@pytest.mark.covers("fanuc.struct.IODBPSD")
@pytest.mark.covers("fanuc.concept.c_types", "fanuc.concept.bit_param_rmw")
@pytest.mark.covers("fanuc.paramtype.bit", "fanuc.paramtype.word")
def test_parameters_of_bits_and_words_act() -> None:
    control, handle = attached()
    assert fwlib.cnc_wrparam(handle, 5, psd(3202, 0, cdata=0x11)) == OK
    assert fwlib.cnc_rdparam(handle, 3202, 0, 5)[1].u.cdata == 0x11
    assert control.parameters.value(3202) == 0x11
    assert fwlib.cnc_wrparam(handle, 6, psd(1410, 0, idata=1234)) == OK
    assert fwlib.cnc_rdparam(handle, 1410, 0, 6)[1].u.idata == 1234
    assert fwlib.cnc_wrparam(handle, 10, psd(1851, ALL_AXES, idatas=(7, -8, 9))) == OK
    assert list(fwlib.cnc_rdparam(handle, 1851, ALL_AXES, 10)[1].u.idatas)[:3] == [7, -8, 9]
    assert [control.parameters.value(1851, axis) for axis in (1, 2, 3)] == [7, -8, 9]


@pytest.mark.covers(
    "fanuc.ODBPARAIF.info.prm_no", "fanuc.ODBPARAIF.prm_type.bit0_1", "fanuc.concept.sparse_parameters",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdparainfo")
@pytest.mark.covers("fanuc.cnc_wrparas")
@covers("ODBPARAIF.info.prm_type", "paramtype.two_word", "paramtype.word", "paramtype.byte", "paramtype.bit")
@pytest.mark.parametrize(("number", "size"), [(3202, 1), (6710, 1), (1410, 2), (6711, 4)])
@pytest.mark.covers("fanuc.cnc_rdparar")
@pytest.mark.covers("fanuc.struct.ODBPARAIF")
@pytest.mark.covers("fanuc.concept.param_record_stream")
@pytest.mark.covers(
    "fanuc.enum.prm_attr.0", "fanuc.enum.prm_attr.1", "fanuc.enum.prm_attr.2", "fanuc.enum.prm_attr.3"
)
def test_types_of_parameters_are_the_bytes_of_their_records(number: int, size: int) -> None:
    control, handle = attached()
    code, info = fwlib.cnc_rdparainfo(handle, number, 1)
    kind = {3202: 0, 6710: 1, 1410: 2, 6711: 3}[number]
    assert (code, info.info[0].prm_no, info.info[0].prm_type & 3) == (OK, number, kind)
    value = {1: 77, 2: 12_345, 4: 1_234_567}[size]
    control.parameters.set(number, value)
    code, first, last, length, data = fwlib.cnc_rdparar(handle, number, 0, number, 100)
    assert (code, first, last, length) == (OK, number, number, 4 + size + size % 2)
    assert data[:4] == number.to_bytes(2, "little") + bytes((0, kind))
    assert data[4 : 4 + size] == value.to_bytes(size, "little")
    other = data[:4] + (value - 1).to_bytes(size, "little") + data[4 + size :]
    assert fwlib.cnc_wrparas(handle, len(other), other) == OK
    assert control.parameters.value(number) == value - 1


@covers(
    "ODBDGN.datano", "ODBDGN.u.cdata", "ODBDGN.u.cdatas", "ODBDGN.u.idata", "ODBDGN.u.idatas", "ODBDGN.u.ldata",
    "ODBDGN.u.ldatas",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_diagnoss")
@pytest.mark.covers("fanuc.ODBDGN")
@pytest.mark.covers(
    "fanuc.diag.kind.byte",
    "fanuc.diag.kind.byte_axis",
    "fanuc.diag.kind.word",
    "fanuc.diag.kind.word_axis",
    "fanuc.diag.kind.2word",
    "fanuc.diag.kind.2word_axis",
)
@pytest.mark.covers("fanuc.diag.axis.0", "fanuc.diag.axis.-1")
def test_diagnosis_data_of_a_control_that_moves() -> None:
    control, handle = attached()
    registered(control, O7="\nG1X20.Y-10.F3000\nM30\n")
    control.signals.give(12, 255 - 80)
    control.signals.set_torque_override(2, 51)
    running(control, 7)
    control.advance(100)

    def diagnosis(number: int, axis: int, length: int) -> Any:
        code, found = fwlib.cnc_diagnoss(handle, number, axis, length)
        assert (code, found.datano, found.type) == (OK, number, axis)
        return found.u

    assert diagnosis(1, 0, 5).cdata == 1  # axes move
    assert diagnosis(30, 0, 6).idata == 80
    assert diagnosis(31, 0, 8).ldata == control.positions.feed() == 2400
    assert list(diagnosis(201, ALL_AXES, 7).cdatas)[:3] == [1, 1, 0]
    assert list(diagnosis(202, ALL_AXES, 10).idatas)[:3] == [1000, 200, 1000]
    places = control.positions.read()
    assert list(diagnosis(301, ALL_AXES, 16).ldatas)[:3] == [each.machine for each in places]
    assert places[1].machine < 0 < places[0].machine


@pytest.mark.covers(
    "fanuc.concept.position_contents", "fanuc.concept.dynamic_snapshot", "fanuc.cnc_rddynamic"
)
@pytest.mark.covers("fanuc.cnc_rdseqnum")
@covers("ODBDY.pos.faxis.absolute", "ODBDY.pos.faxis.machine", "ODBDY.pos.faxis.relative", "ODBSEQ.data")
@pytest.mark.covers("fanuc.struct.ODBDY", "fanuc.struct.ODBSEQ")
@pytest.mark.covers("fanuc.concept.axis_number")
def test_positions_of_all_axes_at_once() -> None:
    control, handle = attached()
    control.control.offsets.set("G54", {"X": 2.0, "Y": -1.0, "Z": 0.25})
    control.positions.preset_relative({3: 500})
    registered(control, O7="\nN25G54G1X6.Y3.Z-1.F6000\nM30\n")
    running(control, 7)
    control.advance(60)
    code, data = fwlib.cnc_rddynamic(handle, ALL_AXES, 22 + 16 * 6)
    assert code == OK
    every, places = data.pos.faxis, control.positions.read()
    assert list(every.machine)[:3] == [each.machine for each in places]
    offsets = (2000, -1000, 250)
    assert list(every.absolute)[:3] == [
        place.machine - offset for place, offset in zip(places, offsets, strict=True)
    ]
    assert list(every.relative)[:3] == [places[0].machine, places[1].machine, places[2].machine + 500]
    assert places[2].machine < 0 < places[0].machine
    assert fwlib.cnc_rdseqnum(handle)[1].data == data.seqnum == 25


@covers("ODBM.datano", "ODBM.mcr_val", "ODBTOFS.datano", "ODBTOFS.type", "ODBTOFS.data", "PRGDIR.prg_data")
@pytest.mark.covers("fanuc.cnc_rdmacro", "fanuc.cnc_rdprogdir", "fanuc.cnc_rdtofs")
@pytest.mark.covers("fanuc.struct.ODBM", "fanuc.struct.ODBTOFS", "fanuc.struct.PRGDIR")
@pytest.mark.covers("fanuc.format.progdir_type0", "fanuc.concept.macro_empty")
def test_variables_offsets_and_the_directory() -> None:
    control, handle = attached()
    control.macros.set(502, -12.75)
    code, found = fwlib.cnc_rdmacro(handle, 502, 10)
    assert (code, found.datano, found.mcr_val, found.dec_val) == (OK, 502, -1275, 2)
    control.tool_offsets.set_all({17: -4_321})
    code, offset = fwlib.cnc_rdtofs(handle, 17, 0, 8)
    assert (code, offset.datano, offset.type, offset.data) == (OK, 17, 0, -4_321)
    registered(control, O7="(FLANGE)\nM30\n", O31="\nM99\n")
    code, listed = fwlib.cnc_rdprogdir(handle, 0, 1, 9999, 64)
    assert (code, bytes(listed.prg_data).rstrip(b"\0")) == (OK, b"O7O31%")


@covers("ODBMDL.type", "ODBMDL.aux.aux_data", "ODBMDL.aux.flag1", "ODBMDL.raux2")
@pytest.mark.covers("fanuc.cnc_modal")
@pytest.mark.covers("fanuc.ODBMDL", "fanuc.ODBMDL.aux")
def test_modal_data_of_the_block_that_was_asked_for() -> None:
    control, handle = attached()
    registered(control, O7="\nG1X2.5Y-3.F600\nX4.F1200\nM30\n")
    running(control, 7)
    control.advance(20)
    code, here = fwlib.cnc_modal(handle, 103, 0)
    assert (code, here.type, here.modal.aux.aux_data) == (OK, 0, 600)
    code, following = fwlib.cnc_modal(handle, 103, 1)
    assert (code, following.type, following.modal.aux.aux_data) == (OK, 1, 1200)
    assert here.modal.aux.flag1 == 0x80 | 3  # commanded here, three digits
    every = fwlib.cnc_modal(handle, -3, 0)[1].modal.raux2
    assert [every[k].aux_data for k in range(3)] == [2500, -3000, 0]
    assert [every[k].flag1 >> 7 for k in range(3)] == [1, 1, 0]
    assert every[1].flag1 & 0x20


@pytest.mark.covers("fanuc.cnc_opdi")
@covers("ODBOPDI.u.cdata")
@pytest.mark.covers("fanuc.ODBOPDI")
def test_an_operation_signal_has_the_value_that_is_given() -> None:
    control, handle = attached()
    signal = fwlib.ODBOPDI()
    for value in (64, 173):
        signal.u.cdata = value
        assert fwlib.cnc_opdi(handle, 10, signal) == OK
        assert control.signals.feed_override == value


@covers("ODBSYSC.frmmin", "ODBSYSC.drmmin", "ODBSYSC.pmcmin", "ODBSYSC.submin")
@pytest.mark.covers("fanuc.cnc_sysconfig")
@pytest.mark.covers("fanuc.ODBSYSC")
def test_modules_of_the_control() -> None:
    control, handle = attached()
    control.configuration = Configuration(
        from_module="2 MB", dram_module="2.5 MB", pmc_module="PMP module", sub_board="M-NET"
    )
    found = fwlib.cnc_sysconfig(handle)[1]
    other = attached()[1]
    usual = fwlib.cnc_sysconfig(other)[1]
    assert (found.pmcmin, found.submin, found.frmmin, found.drmmin) == (2, 3, 0, 1)
    assert (usual.pmcmin, usual.submin) == (0, -1)
    assert found.frmmin != usual.frmmin
    assert found.drmmin != usual.drmmin


@covers("cnc_refpoint")
@pytest.mark.parametrize("axis", [1, 2, 3])
@pytest.mark.covers("fanuc.concept.direct_command")
def test_the_axis_that_is_named_goes_to_its_reference_position(axis: int) -> None:
    control, handle = attached()
    control.parameters.set(8003, 1 << 7)
    for each in (1, 2, 3):
        control.parameters.set(8010, each, each)
    registered(control, O7="\nG0X3.Y4.Z5.\nM30\n")
    running(control, 7, lambda: control.status().channel.run_state is RunState.COMPLETED)
    assert fwlib.cnc_refpoint(handle, 1, 0, axis)[0] == OK
    control.advance(3000)
    places = [control.machine.actual[name] for name in "XYZ"]
    assert places == [0.0 if each == axis else at for each, at in enumerate((3.0, 4.0, 5.0), 1)]


CODES: dict[str, Callable[[PowerMate, int], int]] = {
    "EW_OK": lambda it, handle: fwlib.cnc_rdtofs(handle, 1, 0, 8)[0],
    "EW_LENGTH": lambda it, handle: fwlib.cnc_rdtofs(handle, 1, 0, 7)[0],
    "EW_NUMBER": lambda it, handle: fwlib.cnc_rdtofs(handle, 100, 0, 8)[0],
    "EW_ATTRIB": lambda it, handle: fwlib.cnc_rdtofs(handle, 1, 9, 8)[0],
    "EW_DATA": lambda it, handle: fwlib.cnc_wrtofs(handle, 1, 0, 8, 1_000_000),
    "EW_FUNC": lambda it, handle: fwlib.cnc_rdophisno(handle)[0],
    "EW_PROT": lambda it, handle: fwlib.pmc_wrpmcrng(handle, 9, bytes((1, 0, 0, 0, 5, 0, 5, 0, 1))),
    "EW_PATH": lambda it, handle: fwlib.cnc_refpoint(handle, 9, 0, 1)[0],
    "EW_PARAM": lambda it, handle: fwlib.cnc_refpoint(handle, 1, 0, 1)[0],
}
VALUES = {
    "EW_OK": 0, "EW_FUNC": 1, "EW_LENGTH": 2, "EW_NUMBER": 3, "EW_ATTRIB": 4, "EW_DATA": 5, "EW_PROT": 7, "EW_PARAM": 9,
    "EW_PATH": 11,
}  # fmt: skip


@pytest.mark.covers(
    "fanuc.cnc_rdtofs.err.EW_ATTRIB", "fanuc.cnc_rdtofs.err.EW_LENGTH", "fanuc.cnc_rdtofs.err.EW_NUMBER",
    "fanuc.concept.length_argument", "fanuc.concept.tool_offset_memory",
)  # fmt: skip
@pytest.mark.parametrize("name", [pytest.param(each, marks=covers(each)) for each in CODES])
@pytest.mark.covers("fanuc.concept.return_convention")
def test_a_call_answers_the_code_of_the_manual(name: str) -> None:
    control, handle = attached()
    if name == "EW_PARAM":
        control.parameters.set(8003, 0)
    elif name == "EW_PATH":
        control.parameters.set(8003, 1 << 7)
    assert int(CODES[name](control, handle)) == VALUES[name]


@covers("EW_NOOPT")
@pytest.mark.covers("fanuc.cnc_rdopmsg")
@pytest.mark.covers("fanuc.common.allmode")
def test_an_option_that_is_not_fitted_is_refused() -> None:
    control = PowerMate(options=("pmc_axis",))
    fwlib.detach()
    fwlib.attach(0, control)
    _, handle = fwlib.cnc_allclibhndl()
    code, _ = fwlib.cnc_rdopmsg(handle, 0, 6 + 256)
    assert int(code) == 6


@covers("ODBSYSC.sv3min", "ODBSYSC.sv5min")
@pytest.mark.parametrize("axes", [1, 2, 3, 4, 5, 6])
@pytest.mark.covers("fanuc.cnc_sysconfig")
@pytest.mark.covers("fanuc.ODBSYSC")
@pytest.mark.covers(
    "fanuc.ODBSYSC.sv3min.0", "fanuc.ODBSYSC.sv3min.-1", "fanuc.ODBSYSC.sv5min.0", "fanuc.ODBSYSC.sv5min.-1"
)
def test_servo_modules_are_there_for_every_pair_of_axes(axes: int) -> None:
    found = fwlib.cnc_sysconfig(attached(axes=axes)[1])[1]
    assert (found.sv3min, found.sv5min) == (0 if axes > 2 else -1, 0 if axes > 4 else -1)


@pytest.mark.covers("fanuc.cnc_opdi")
@covers("cnc_opdi.sig4.cdata.bit5")
@pytest.mark.parametrize("axis", [1, 5, 6])
def test_a_servo_is_off_by_the_bit_of_its_axis(axis: int) -> None:
    control, handle = attached(axes=6)
    signal = fwlib.ODBOPDI()
    signal.u.cdata = 1 << axis - 1
    assert fwlib.cnc_opdi(handle, 4, signal) == OK
    assert [control.signals.state.servo_is_off(each) for each in range(1, 7)] == [
        each == axis for each in range(1, 7)
    ]


UNUSED = {  # beside the elements that are called dummy
    "ODBDY": ("acts",), "IODBSIG": ("datano", "type"), "ODBHIS": ("type",), "ODBAHIS": ("type",),
    "ALM_HIS": ("alm_grp",), "REC_ALM": ("axis_no",), "REC_MDI": ("pw_flag",),
    "ODBSYSC": ("slot_no_p", "slot_no_l", "mod_id", "m_rom", "s_rom", "spl1_soft", "spl2_soft"),
    "IODBSGNL": ("datano", "hndl_ax", "hndl_mv", "spdl_ovrd"), "IODBGNRL": ("datano",), "IODBRDNA": ("datano",),
}  # fmt: skip
RECORDS = ("rec_mdi", "rec_sgn", "rec_alm", "rec_date", "rec_time")  # by what their rec_type says


def unused(memory: Any) -> dict[str, bytes]:
    """Return the elements of a structure that the manual leaves unused, those of its records too."""
    kind = type(memory).__name__
    if kind == "ODBHIS_DATA":
        return unused(getattr(memory, RECORDS[memory.rec_mdi.rec_type]))
    found = {}
    raw = bytes(memory)
    for name, *_ in type(memory)._fields_:
        value, place = getattr(memory, name), getattr(type(memory), name)
        if name.startswith("dummy") or name in UNUSED.get(kind, ()):
            found[f"{kind}.{name}"] = raw[place.offset : place.offset + place.size]
        for each in value if isinstance(value, ctypes.Array) else (value,):
            if isinstance(each, (ctypes.Structure, ctypes.Union)):
                found |= unused(each)
    return found


READS: tuple[Callable[[int], tuple[Any, ...]], ...] = (
    fwlib.cnc_actf, fwlib.cnc_rdprgnum, fwlib.cnc_rdseqnum, fwlib.cnc_exebufstat, fwlib.cnc_finstate, fwlib.cnc_sysinfo,
    fwlib.cnc_sysconfig, fwlib.cnc_statinfo, fwlib.cnc_alarm, fwlib.cnc_rdhissgnl,
    *(partial(read, axis=ALL_AXES, length=28) for read in (
        fwlib.cnc_absolute, fwlib.cnc_machine, fwlib.cnc_relative, fwlib.cnc_distance, fwlib.cnc_srvdelay,
        fwlib.cnc_accdecdly, fwlib.cnc_skip,
    )),
    lambda handle: fwlib.cnc_rddynamic(handle, 2, 22 + 16),
    lambda handle: fwlib.cnc_rdmacro(handle, 502, 10),
    lambda handle: fwlib.cnc_rdmacror(handle, 502, 504, 6 + 3 * 6),
    lambda handle: fwlib.cnc_upload(handle, 5)[:2],
    lambda handle: fwlib.cnc_rdophistry(handle, 2, 6, 6 + 5 * 8),
    lambda handle: fwlib.cnc_rdalmhistry(handle, 1, 2, 6 + 2 * 48),
    lambda handle: fwlib.cnc_rdopnlsgnl(handle, 0x1FB9),
    lambda handle: fwlib.cnc_rdopnlgnrl(handle, 0xFF),
    lambda handle: fwlib.cnc_rdopnlgsname(handle, 0xFF),
)  # fmt: skip


@covers(
    "ODBACT.dummy", "ODBAXIS.dummy", "ODBDY.dummy", "ODBDY.acts", "ODBUP.dummy", "ODBPRO.dummy", "ODBSEQ.dummy",
    "ODBM.dummy", "IODBMR.dummy", "ODBHIS.type", "ODBHIS.axis_no", "ODBHIS.pw_flag", "ODBHIS.rec_alm.dummy",
    "ODBHIS.rec_mdi.dummy", "ODBHIS.rec_sgn.dummy", "ODBHIS.rec_date.dummy", "ODBHIS.rec_time.dummy", "ODBAHIS.type",
    "ODBAHIS.alm_his.dummy", "ODBAHIS.alm_his.alm_grp", "ODBAHIS.alm_his.dummy2", "IODBSIG.datano", "IODBSIG.type",
    "ODBEXEC.dummy", "ODBFIN.dummy", "ODBSYS.dummy", "ODBSYSC.slot_no_p", "ODBSYSC.slot_no_l", "ODBSYSC.mod_id",
    "ODBSYSC.dummy1", "ODBSYSC.m_rom", "ODBSYSC.s_rom", "ODBSYSC.spl1_soft", "ODBSYSC.spl2_soft", "ODBSYSC.dummy2",
    "ODBST.dummy", "ODBALM.dummy", "IODBSGNL.datano", "IODBSGNL.hndl_ax", "IODBSGNL.hndl_mv", "IODBSGNL.spdl_ovrd",
    "IODBGNRL.datano", "IODBRDNA.datano",
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.IODBGNRL",
    "fanuc.IODBRDNA",
    "fanuc.IODBSGNL",
    "fanuc.IODBSIG",
    "fanuc.ODBAHIS",
    "fanuc.ODBALM",
    "fanuc.ODBEXEC",
    "fanuc.ODBFIN",
    "fanuc.ODBHIS",
    "fanuc.ODBHIS.rec_alm",
    "fanuc.ODBHIS.rec_date",
    "fanuc.ODBHIS.rec_mdi",
    "fanuc.ODBHIS.rec_sgn",
    "fanuc.ODBHIS.rec_time",
    "fanuc.ODBST",
    "fanuc.ODBSYS",
    "fanuc.ODBSYSC",
    "fanuc.struct.IODBMR",
    "fanuc.struct.ODBACT",
    "fanuc.struct.ODBAXIS",
    "fanuc.struct.ODBDY",
    "fanuc.struct.ODBM",
    "fanuc.struct.ODBPRO",
    "fanuc.struct.ODBSEQ",
    "fanuc.struct.ODBUP",
)
def test_what_the_manual_leaves_unused_is_zero_whatever_the_control_does() -> None:
    control, handle = attached(options=("custom_macro", "pmc_axis", "pmc"))
    control.parameters.set(8003, 1 << 7)
    control.clock.set_now(AT)
    sig = fwlib.IODBSIG(type=1)
    first = sig.data[0]
    for field, value in zip(("ent_no", "sig_no", "sig_name", "mask_pat"), (1, 44, 2, 0xFF), strict=True):
        setattr(first, field, value)
    assert fwlib.cnc_wrhissgnl(handle, sig) == OK
    assert fwlib.cnc_clearophis(handle, 0) == fwlib.cnc_clearophis(handle, 1) == OK
    for number in (502, 503, 504):
        control.macros.set(number, number - 7.75)
    for number, axis in ((85, None), (417, 3)):
        control.raise_alarm(number, axis=axis)
    control.history.press_key(0x47)
    control.pmc.write("G", 44, b"\x53")
    control.power_cycle()
    assert fwlib.cnc_stopophis(handle) == OK
    panel = fwlib.IODBSGNL(
        type=0x39, mode=1, hndl_ax=2, hndl_mv=3, spdl_ovrd=4, rpd_ovrd=2, jog_ovrd=9, feed_ovrd=7
    )
    assert fwlib.cnc_wropnlsgnl(handle, panel) == OK
    registered(control, O7="\nN25G1X60.Y-30.Z20.F3000\nM30\n")
    assert fwlib.cnc_upstart(handle, 7) == OK
    running(control, 7)
    control.advance(60)
    control.raise_alarm(2003)
    seen: dict[str, bytes] = {}
    for read in READS:
        code, memory = read(handle)
        assert code == OK, read
        assert any(bytes(memory)) or isinstance(memory, (fwlib.ODBEXEC, fwlib.ODBFIN, fwlib.ODBAXIS)), memory
        seen |= unused(memory)
    assert {each: memory for each, memory in seen.items() if any(memory)} == {}
    assert len(seen) == 43
