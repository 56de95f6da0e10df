"""Handles, and the functions about controlled axes (Manual 000, 271-1321)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW, IDBWRR
from polycnc.controllers.library import variant
from polycnc.machine import Poll
from support.power_mate import OK, attached, moved, registered, running

READS = ("absolute", "machine", "relative", "distance", "skip", "srvdelay", "accdecdly")


def covers(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.covers(*(f"fanuc.{name}" for name in names))


def read(name: str, handle: int, axis: int, length: int) -> tuple[EW, list[int]]:
    code, data = getattr(fwlib, f"cnc_{name}")(handle, axis, length)
    assert data.type == (axis if code == OK else 0)
    return code, list(data.data)


# ---------------------------------------------------------------------- handles


@pytest.mark.covers("fanuc.cnc_rdprgnum")
@covers("cnc_allclibhndl", "cnc_freelibhndl", "concept.handle_lifecycle")
@pytest.mark.covers("fanuc.common.handle2", "fanuc.range.node")
def test_a_handle_is_opened_used_and_closed() -> None:
    control, handle = attached()
    assert 0 < handle <= 0xFFFF
    code, other = fwlib.cnc_allclibhndl()
    assert (code, other != handle) == (OK, True)
    assert fwlib.cnc_rdprgnum(handle)[0] == OK
    assert fwlib.cnc_freelibhndl(handle) == OK
    assert fwlib.cnc_rdprgnum(handle)[0] == EW.EW_HANDLE
    assert fwlib.cnc_freelibhndl(handle) == EW.EW_HANDLE
    assert fwlib.cnc_rdprgnum(other)[0] == OK
    assert fwlib.cnc_rdprgnum(0)[0] == EW.EW_HANDLE
    assert control.mode.label == "MEM"
    for mode in ("MDI", "EDIT", "JOG", "REF"):
        control.select_mode(mode)
        code, handle = fwlib.cnc_allclibhndl()
        assert code == OK
        assert fwlib.cnc_freelibhndl(handle) == OK


@pytest.mark.covers("fanuc.EW_ATTRIB", "fanuc.EW_NUMBER", "fanuc.concept.axis_number")
@pytest.mark.covers("fanuc.EW_HSSB")
@pytest.mark.covers("fanuc.cnc_absolute")
@covers("cnc_allclibhndl2", "range.node")
@pytest.mark.covers("fanuc.concept.handle_lifecycle")
@pytest.mark.covers("fanuc.cnc_absolute.err.EW_ATTRIB")
def test_nodes_0_to_7_are_controls_of_their_own() -> None:
    attached()
    controls = [PowerMate(axes=axes) for axes in (1, 2, 4)]
    for node, control in zip((3, 0, 7), controls, strict=True):
        fwlib.attach(node, control)
    handles = {}
    for node in (3, 0, 7):
        code, handles[node] = fwlib.cnc_allclibhndl2(node)
        assert code == OK
    assert [fwlib.cnc_absolute(handles[node], axis, 8)[0] for node, axis in ((3, 1), (0, 2), (7, 4))] == [
        OK
    ] * 3
    assert [fwlib.cnc_absolute(handles[node], axis, 8)[0] for node, axis in ((3, 2), (0, 3), (7, 5))] == [
        EW.EW_ATTRIB
    ] * 3
    assert fwlib.cnc_allclibhndl2(-1) == (EW.EW_NUMBER, 0)
    assert fwlib.cnc_allclibhndl2(8) == (EW.EW_NUMBER, 0)
    assert fwlib.cnc_allclibhndl2(6) == (EW.EW_HSSB, 0)  # nothing is there
    fwlib.detach(3)
    assert fwlib.cnc_absolute(handles[3], 1, 8)[0] == EW.EW_HANDLE
    assert fwlib.cnc_absolute(handles[7], 4, 8)[0] == OK


@pytest.mark.covers("fanuc.EW_ATTRIB", "fanuc.EW_NUMBER", "fanuc.concept.axis_number")
@pytest.mark.covers("fanuc.cnc_absolute")
@pytest.mark.covers("fanuc.concept.handle_lifecycle", "fanuc.range.node")
@pytest.mark.covers("fanuc.cnc_absolute.err.EW_ATTRIB")
@pytest.mark.covers("fanuc.cnc_allclibhndl")
def test_the_default_node_can_be_changed_and_nodes_be_listed() -> None:
    attached()
    fwlib.attach(5, PowerMate(axes=2, model="D"))
    assert fwlib.cnc_rdnodenum() == (OK, 2)
    assert fwlib.cnc_setdefnode(8) == EW.EW_NUMBER
    assert fwlib.cnc_setdefnode(5) == OK
    _, handle = fwlib.cnc_allclibhndl()
    assert fwlib.cnc_absolute(handle, 3, 8)[0] == EW.EW_ATTRIB
    code, info = fwlib.cnc_rdnodeinfo(5)
    assert (code, info.node_no, info.status, info.cnc_type, info.node_name) == (
        0,
        5,
        1,
        ord("D"),
        b"Power Mate-D",
    )
    assert fwlib.cnc_rdnodeinfo(4)[1].status == 0
    assert fwlib.cnc_rdnodeinfo(-1)[0] == EW.EW_NUMBER
    assert fwlib.cnc_rdnodenum() == (OK, 2)


@pytest.mark.covers("fanuc.EW_HSSB", "fanuc.concept.return_convention")
@pytest.mark.covers("fanuc.cnc_absolute", "fanuc.cnc_allclibhndl")
@pytest.mark.covers("fanuc.cnc_dwnstart")
def test_a_fault_of_a_node_is_the_answer_of_every_call() -> None:
    control, _ = attached()
    node = fwlib.attach(0, control)
    _, handle = fwlib.cnc_allclibhndl()
    node.fault = EW.EW_HSSB
    assert fwlib.cnc_absolute(handle, 1, 8)[0] == EW.EW_HSSB
    assert fwlib.cnc_dwnstart(handle) == EW.EW_HSSB
    assert fwlib.cnc_allclibhndl() == (EW.EW_HSSB, 0)
    node.fault = EW.EW_OK
    assert fwlib.cnc_absolute(handle, 1, 8)[0] == OK


@pytest.mark.covers("fanuc.EW_FUNC")
@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_freelibhndl")
@pytest.mark.covers("fanuc.cnc_dwnstart")
@pytest.mark.covers(
    "fanuc.concept.handle_lifecycle",
    "fanuc.common.handle2",
    "fanuc.concept.download_session",
    "fanuc.concept.upload_session",
)
@pytest.mark.covers("fanuc.cnc_download.err.EW_FUNC")
@pytest.mark.covers("fanuc.cnc_allclibhndl")
def test_closing_a_handle_breaks_its_transfers_off_and_no_others() -> None:
    control, handle = attached()
    _, other = fwlib.cnc_allclibhndl()
    assert fwlib.cnc_dwnstart(handle) == OK
    assert fwlib.cnc_download(other, "\nO1\n", 4) == EW.EW_FUNC
    assert fwlib.cnc_freelibhndl(other) == OK
    assert fwlib.cnc_download(handle, "\nO1\nM3", 6) == OK
    assert fwlib.cnc_freelibhndl(handle) == OK
    assert (control.transfer, len(control.programs)) == (None, 0)
    _, handle = fwlib.cnc_allclibhndl()
    assert fwlib.cnc_dwnstart(handle) == OK


@pytest.mark.covers(
    "fanuc.ODBAXIS.data", "fanuc.concept.axis_number", "fanuc.concept.position_contents", "fanuc.enum.axis.1..m",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_freelibhndl", "fanuc.cnc_relative")
@pytest.mark.covers("fanuc.cnc_wrrelpos")
@pytest.mark.covers("fanuc.concept.handle_lifecycle", "fanuc.common.handle2")
@pytest.mark.covers("fanuc.cnc_allclibhndl")
def test_two_sessions_have_handles_of_their_own() -> None:
    control, handle = attached()
    session = fwlib.Session()
    session.attach(0, control)
    _, other = session.cnc_allclibhndl()
    assert session.cnc_wrrelpos(other, 8, IDBWRR(type=2, data=(4321,))) == OK
    assert fwlib.cnc_relative(handle, 2, 8)[1].data[0] == 4321
    assert fwlib.cnc_freelibhndl(handle) == OK
    assert session.cnc_relative(other, 2, 8)[0] == OK


# ---------------------------------------------------------------------- worked examples


@covers("example.cnc_actf", "cnc_actf")
@pytest.mark.covers("fanuc.ODBACT.data")
@pytest.mark.covers("fanuc.struct.ODBACT")
def test_example_actual_feed() -> None:
    control, handle = attached()
    registered(control, O1234="\nN10 G98 F1200\nN20 G1 X10. Z200.\nM30\n")
    assert fwlib.cnc_actf(handle)[1].data == 0
    running(control, 1234)
    control.advance(1500)
    assert control.execution.sequence == 20
    code, feed = fwlib.cnc_actf(handle)
    assert (code, feed.data) == (OK, 1200)
    control.control.set_overrides(feed=0.5)
    control.advance(1000)
    assert fwlib.cnc_actf(handle)[1].data == 600
    for percent, shown in ((0.33, 396), (0.4996, 600), (0.5003, 600)):  # the nearest whole number
        control.control.set_overrides(feed=percent)
        control.advance(400)
        assert fwlib.cnc_actf(handle)[1].data == shown
    control.feed_hold()
    control.advance(1000)
    assert fwlib.cnc_actf(handle)[1].data == 0


@pytest.mark.covers("fanuc.ODBACT.data")
@pytest.mark.covers("fanuc.cnc_actf")
def test_actual_feed_in_inch_has_two_decimals() -> None:
    control, handle = attached(inch_input=True)
    registered(control, O7="\nG1 X12. F55.5\nM30\n")
    running(control, 7)
    control.advance(2000)
    assert fwlib.cnc_actf(handle)[1].data == 5550
    control, handle = attached(inch_input=True, rotary=(2,))
    registered(control, O7="\nG1 A90. F300\nM30\n")
    running(control, 7)
    control.advance(1000)
    assert fwlib.cnc_actf(handle)[1].data == 300  # deg/min


@pytest.mark.covers("fanuc.concept.position_contents")
@covers(
    "example.cnc_absolute", "cnc_absolute", "enum.axis.ALL_AXES", "enum.axis.1..m", "concept.decimal_point"
)
@pytest.mark.covers("fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type")
@pytest.mark.covers("fanuc.struct.ODBAXIS")
@pytest.mark.covers("fanuc.concept.axis_number")
@pytest.mark.covers("fanuc.ALL_AXES")
def test_example_absolute() -> None:
    control, handle = attached()
    moved(control, "G0 X120.005 Y-50.119 Z0.08")
    assert read("absolute", handle, ALL_AXES, 16) == (OK, [120005, -50119, 80, 0, 0, 0])
    assert read("absolute", handle, 2, 8) == (OK, [-50119, 0, 0, 0, 0, 0])
    assert read("absolute", handle, 3, 8)[1][0] == 80


@pytest.mark.covers("fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.enum.axis.1..m")
@covers("example.cnc_machine", "cnc_machine")
@pytest.mark.covers(
    "fanuc.concept.axis_number",
    "fanuc.concept.decimal_point",
    "fanuc.concept.position_contents",
    "fanuc.param.1001_0",
)
def test_example_machine_in_inch_output() -> None:
    control, handle = attached(inch_output=True, inch_input=True)
    moved(control, "G0 Y-26.5593")
    assert read("machine", handle, 2, 8) == (OK, [-265593, 0, 0, 0, 0, 0])


@pytest.mark.covers("fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.enum.axis.1..m")
@covers("example.cnc_relative", "cnc_relative")
@pytest.mark.covers(
    "fanuc.concept.axis_number", "fanuc.concept.decimal_point", "fanuc.concept.position_contents"
)
def test_example_relative_of_a_rotary_axis_is_not_folded() -> None:
    control, handle = attached(axes=4, rotary=(4,))
    moved(control, "G0 A900.051")
    assert read("relative", handle, 4, 8) == (OK, [900051, 0, 0, 0, 0, 0])


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.concept.axis_number", "fanuc.enum.axis.1..m",
    "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@covers("example.cnc_distance", "cnc_distance")
@pytest.mark.covers("fanuc.concept.decimal_point", "fanuc.concept.position_contents")
def test_example_distance_is_twice_the_real_one() -> None:
    control, handle = attached(axes=4, rotary=(3,))
    assert [control.units.axis_name(axis) for axis in (1, 2, 3, 4)] == ["X", "Y", "A", "Z"]
    control.control.set_overrides(feed=1e-3)
    control.select_mode("MDI")
    control.mdi.put(b"\nO1\nG91G1X-17.3Y30.009A-.18Z4.F600\nM30\n%")
    control.cycle_start()
    control.advance(20)
    assert read("distance", handle, ALL_AXES, 20) == (OK, [-34600, 60018, -360, 8000, 0, 0])
    control.control.set_overrides(feed=1.0)
    control.advance(700)
    left = control.status().axes["Y"].to_go
    assert 0 < left < 30
    assert read("distance", handle, 2, 8)[1][0] == pytest.approx(2000 * left, abs=1.01)


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.cnc_absolute", "fanuc.cnc_relative",
    "fanuc.concept.axis_number", "fanuc.enum.axis.1..m", "fanuc.enum.axis.ALL_AXES", "fanuc.example.cnc_absolute",
    "fanuc.example.cnc_relative",
)  # fmt: skip
@covers("example.cnc_wrrelpos", "cnc_wrrelpos", "concept.position_contents")
@pytest.mark.covers("fanuc.IDBWRR.data", "fanuc.IDBWRR.type")
@pytest.mark.covers("fanuc.struct.IDBWRR")
def test_example_relative_preset_to_the_origin() -> None:
    control, handle = attached()
    moved(control, "G0 X33.21 Y-7.5 Z3.")
    assert fwlib.cnc_wrrelpos(handle, 8, IDBWRR(type=1, data=(0,))) == OK
    assert read("relative", handle, ALL_AXES, 16)[1][:3] == [0, -7500, 3000]
    assert read("absolute", handle, 1, 8)[1][0] == 33210
    moved(control, "G0 X34.22")
    assert read("relative", handle, 1, 8)[1][0] == 1010
    assert fwlib.cnc_wrrelpos(handle, 16, IDBWRR(type=ALL_AXES, data=(5, -6, 99_999_999))) == OK
    assert read("relative", handle, ALL_AXES, 16)[1][:3] == [5, -6, 99_999_999]
    assert fwlib.cnc_wrrelpos(handle, 8, variant(IDBWRR, data=1)(type=2, data=(77,))) == OK
    assert read("relative", handle, 2, 8)[1][0] == 77


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.EW_ATTRIB", "fanuc.EW_DATA", "fanuc.EW_LENGTH", "fanuc.ODBAXIS.data",
    "fanuc.ODBAXIS.type", "fanuc.cnc_relative", "fanuc.concept.position_contents", "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrrelpos")
@covers("cnc_wrrelpos.err.EW_LENGTH", "cnc_wrrelpos.err.EW_ATTRIB", "cnc_wrrelpos.err.EW_DATA")
@pytest.mark.covers("fanuc.concept.length_argument", "fanuc.concept.axis_number")
def test_presets_that_are_refused_change_nothing() -> None:
    control, handle = attached()
    moved(control, "G0 X1. Y2. Z3.")
    for expected, length, axis, data in (
        (EW.EW_LENGTH, 7, 1, (5,)),
        (EW.EW_LENGTH, 15, ALL_AXES, (5, 6, 7)),
        (EW.EW_ATTRIB, 8, 0, (5,)),
        (EW.EW_ATTRIB, 8, 4, (5,)),
        (EW.EW_ATTRIB, 8, -2, (5,)),
        (EW.EW_DATA, 8, 1, (100_000_000,)),
        (EW.EW_DATA, 16, ALL_AXES, (5, 6, -100_000_000)),
    ):
        assert fwlib.cnc_wrrelpos(handle, length, IDBWRR(type=axis, data=data)) == expected
        assert read("relative", handle, ALL_AXES, 16)[1][:3] == [1000, 2000, 3000]


# ---------------------------------------------------------------------- what positions contain


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.concept.axis_number", "fanuc.enum.axis.1..m",
    "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrtofs")
@pytest.mark.covers(
    "fanuc.concept.position_contents", "fanuc.cnc_relative", "fanuc.cnc_absolute", "fanuc.cnc_machine"
)
def test_positions_know_work_offsets_tool_length_and_units() -> None:
    control, handle = attached()
    control.parameters.set(1221, 10_000, 1)
    assert fwlib.cnc_wrtofs(handle, 5, 0, 8, 2_500) == OK
    assert read("absolute", handle, 1, 8)[1][0] == -10_000
    moved(control, "G43 H5 G0 X4. Z7.")
    assert read("machine", handle, ALL_AXES, 16)[1][:3] == [14_000, 0, 9_500]
    assert read("absolute", handle, ALL_AXES, 16)[1][:3] == [4_000, 0, 9_500]  # 7 and the tool's 2.5
    assert read("relative", handle, 3, 8)[1][0] == 9_500
    moved(control, "G44 H5 Z7.")
    assert read("absolute", handle, 3, 8)[1][0] == read("machine", handle, 3, 8)[1][0] == 4_500


@pytest.mark.covers(
    "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.concept.axis_number", "fanuc.concept.position_contents",
    "fanuc.enum.axis.1..m",
)  # fmt: skip
@pytest.mark.covers("fanuc.concept.decimal_point")
@pytest.mark.parametrize(
    ("increment", "inch", "counts"),
    [
        ("IS-A", False, 1235),
        ("IS-B", False, 12346),
        ("IS-C", False, 123457),
        ("IS-A", True, 486),
        ("IS-B", True, 4861),
    ],
)
@pytest.mark.covers(
    "fanuc.cnc_relative",
    "fanuc.cnc_absolute",
    "fanuc.cnc_machine",
    "fanuc.param.1004_0",
    "fanuc.param.1004_1",
    "fanuc.concept.increment_system",
)
def test_increments_scale_positions_of_linear_axes(increment: str, inch: bool, counts: int) -> None:
    control, handle = attached(increment=increment, inch_input=inch, axes=2, rotary=(2,))
    moved(control, "G21 G0 X12.34567 A-7.5" if not inch else "G0 X.48605 A-7.5")
    assert read("absolute", handle, 1, 8)[1][0] == counts
    assert read("absolute", handle, 2, 8)[1][0] == -75 * 10 ** {"IS-A": 1, "IS-B": 2, "IS-C": 3}[increment]


@pytest.mark.covers("fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.enum.axis.1..m")
@covers("concept.decimal_point", "cnc_absolute", "cnc_machine")
@pytest.mark.covers("fanuc.concept.position_contents", "fanuc.param.0000_2")
def test_units_follow_g20_and_the_setting() -> None:
    control, handle = attached()
    moved(control, "G20 G0 X2.")
    assert read("absolute", handle, 1, 8)[1][0] == 20_000
    assert read("machine", handle, 1, 8)[1][0] == 50_800
    assert control.parameters.bit(0, 2)
    moved(control, "G21 G0 X50.8")
    assert read("absolute", handle, 1, 8)[1][0] == 50_800
    assert not control.parameters.bit(0, 2)
    control.parameters.set(0, 4)
    assert read("absolute", handle, 1, 8)[1][0] == 20_000
    moved(control, "G0 X1.5")
    assert read("absolute", handle, 1, 8)[1][0] == 15_000


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.cnc_absolute", "fanuc.concept.axis_number",
    "fanuc.enum.axis.1..m", "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@covers("example.cnc_skip", "cnc_skip")
@pytest.mark.covers("fanuc.concept.position_contents")
def test_skip_positions_are_those_at_the_signal() -> None:
    control, handle = attached(axes=2)
    assert read("skip", handle, ALL_AXES, 12)[1][:2] == [0, 0]
    registered(control, O5="\nG1 X30. Y-40. F3000\nM30\n")
    running(control, 5)
    control.advance(600)
    control.skip_signal(True)
    there = read("absolute", handle, ALL_AXES, 12)[1]
    assert 0 < there[0] < 30_000
    control.advance(100)
    control.skip_signal(True)  # still on: no new edge
    assert [read("skip", handle, axis, 8)[1][0] for axis in (1, 2)] == there[:2]
    control.skip_signal(False)
    control.skip_signal(True)
    assert read("skip", handle, 1, 8)[1][0] > there[0]
    control.power_cycle()
    assert read("skip", handle, ALL_AXES, 12)[1][:2] == [0, 0]


@pytest.mark.covers("fanuc.ALL_AXES", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.enum.axis.ALL_AXES")
@pytest.mark.covers("fanuc.concept.position_contents")
@covers("cnc_skip", "cnc_machine", "cnc_absolute")
def test_skip_positions_are_absolute_ones() -> None:
    control, handle = attached(axes=2)
    control.parameters.set(1221, 7_000, 2)
    moved(control, "G54 G0 X5. Y3.")
    control.skip_signal(True)
    assert read("skip", handle, ALL_AXES, 12)[1][:2] == [5_000, 3_000]
    assert read("machine", handle, ALL_AXES, 12)[1][:2] == [5_000, 10_000]


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.cnc_absolute", "fanuc.concept.axis_number",
    "fanuc.enum.axis.1..m", "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@covers("example.cnc_srvdelay", "cnc_srvdelay")
@pytest.mark.covers("fanuc.concept.position_contents")
def test_servo_delay_is_the_following_error() -> None:
    control, handle = attached(servo=True, axes=2)
    registered(control, O5="\nG1 X60. Y-45. F3000\nM30\n")  # 75 mm along both, 40 and -30 mm/s
    running(control, 5)
    control.advance(800)
    delays = read("srvdelay", handle, ALL_AXES, 12)[1]
    assert delays[0] == pytest.approx(40.0 / 30.0 * 1000, rel=0.1)  # speed by loop gain
    assert delays[1] == pytest.approx(-30.0 / 30.0 * 1000, rel=0.1)
    for k, axis in enumerate(control.status().axes.values()):
        assert delays[k] == round((axis.setpoint - axis.actual) * 1000)
        assert read("absolute", handle, k + 1, 8)[1][0] == round(axis.actual * 1000)
    assert read("srvdelay", handle, 2, 8)[1][0] == delays[1]
    _, ideal = attached()
    assert read("srvdelay", ideal, ALL_AXES, 16)[1] == [0] * 6


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.concept.axis_number", "fanuc.enum.axis.1..m",
    "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_actf")
@covers("example.cnc_accdecdly", "cnc_accdecdly")
@pytest.mark.covers("fanuc.concept.position_contents")
def test_nothing_is_delayed_by_acceleration() -> None:
    control, handle = attached()
    registered(control, O5="\nG1 X60. F3000\nM30\n")
    running(control, 5)
    control.advance(15)
    assert fwlib.cnc_actf(handle)[1].data < 3000
    assert read("accdecdly", handle, ALL_AXES, 16) == (OK, [0] * 6)
    assert read("accdecdly", handle, 3, 8) == (OK, [0] * 6)


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.EW_ATTRIB", "fanuc.EW_LENGTH", "fanuc.ODBAXIS.type", "fanuc.concept.position_contents",
    "fanuc.enum.axis.1..m", "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=covers(f"cnc_{n}.err.EW_LENGTH", f"cnc_{n}.err.EW_ATTRIB"), id=n) for n in READS],
)
@covers("concept.length_argument", "concept.axis_number")
@pytest.mark.covers(
    "fanuc.cnc_absolute",
    "fanuc.cnc_accdecdly",
    "fanuc.cnc_distance",
    "fanuc.cnc_machine",
    "fanuc.cnc_relative",
    "fanuc.cnc_skip",
    "fanuc.cnc_srvdelay",
)
def test_lengths_and_axes_of_position_reads(name: str) -> None:
    _, handle = attached(axes=4)
    assert read(name, handle, 1, 7)[0] == EW.EW_LENGTH
    assert read(name, handle, ALL_AXES, 19)[0] == EW.EW_LENGTH
    assert read(name, handle, 9, 7)[0] == EW.EW_LENGTH  # the length comes first
    for axis in (0, 5, -2):
        assert read(name, handle, axis, 8)[0] == EW.EW_ATTRIB
    assert read(name, handle, 4, 8)[0] == OK
    assert read(name, handle, ALL_AXES, 20)[0] == OK
    assert read(name, handle, ALL_AXES, 28)[0] == OK


@pytest.mark.covers(
    "fanuc.EW_DATA", "fanuc.EW_NOOPT", "fanuc.ODBAXIS.type", "fanuc.cnc_absolute", "fanuc.cnc_accdecdly",
    "fanuc.cnc_distance", "fanuc.cnc_machine", "fanuc.cnc_relative", "fanuc.cnc_skip", "fanuc.cnc_srvdelay",
    "fanuc.concept.position_contents", "fanuc.concept.program_number_range", "fanuc.enum.axis.1..m",
    "fanuc.option.param_write",
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.cnc_dwnend", "fanuc.cnc_rdmacro", "fanuc.cnc_rdparam", "fanuc.cnc_rdtofs", "fanuc.cnc_wrtofs"
)
@covers("concept.option_none")
@pytest.mark.covers(
    "fanuc.cnc_dwnend.err.EW_DATA",
    "fanuc.cnc_dwnstart",
    "fanuc.cnc_wrparam",
    "fanuc.cnc_wrparam.err.EW_NOOPT",
)
def test_reads_need_no_option() -> None:
    control, handle = attached(options=False)
    for name in READS:
        assert read(name, handle, 1, 8)[0] == OK
    assert fwlib.cnc_dwnstart(handle) == OK
    assert fwlib.cnc_dwnend(handle) == EW.EW_DATA
    assert fwlib.cnc_rdtofs(handle, 1, 0, 8)[0] == OK
    assert fwlib.cnc_rdparam(handle, 6080, 0, 5)[0] == OK
    assert fwlib.cnc_rdmacro(handle, 100, 10)[0] == OK
    assert fwlib.cnc_wrtofs(handle, 1, 0, 8, 9) == OK
    assert not control.has_option("custom_macro")
    assert fwlib.cnc_wrparam(handle, 5, fwlib.IODBPSD(datano=6080)) == EW.EW_NOOPT


# ---------------------------------------------------------------------- everything at one moment


@pytest.mark.covers(
    "fanuc.ALL_AXES", "fanuc.ODBACT.data", "fanuc.ODBAXIS.data", "fanuc.ODBAXIS.type", "fanuc.ODBDY.alarm.bit15",
    "fanuc.ODBDY.dummy", "fanuc.ODBDY.pos.faxis.absolute", "fanuc.ODBDY.pos.faxis.machine",
    "fanuc.ODBDY.pos.faxis.relative", "fanuc.cnc_absolute", "fanuc.cnc_distance", "fanuc.cnc_machine",
    "fanuc.cnc_relative", "fanuc.concept.axis_number", "fanuc.concept.position_contents", "fanuc.enum.axis.1..m",
    "fanuc.enum.axis.ALL_AXES",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_actf")
@covers("cnc_rddynamic", "concept.dynamic_snapshot", "example.cnc_rddynamic")
@pytest.mark.covers(
    "fanuc.ODBDY.actf",
    "fanuc.ODBDY.acts",
    "fanuc.ODBDY.alarm",
    "fanuc.ODBDY.axis",
    "fanuc.ODBDY.prgmnum",
    "fanuc.ODBDY.prgnum",
    "fanuc.ODBDY.seqnum",
    "fanuc.ODBDY.pos.faxis.distance",
    "fanuc.ODBDY.pos.oaxis.absolute",
    "fanuc.ODBDY.pos.oaxis.distance",
    "fanuc.ODBDY.pos.oaxis.machine",
    "fanuc.ODBDY.pos.oaxis.relative",
)
@pytest.mark.covers("fanuc.struct.ODBDY")
@pytest.mark.covers("fanuc.concept.subprogram_numbers")
@pytest.mark.covers("fanuc.cnc_wrrelpos")
def test_the_dynamic_data_are_those_of_the_single_functions() -> None:
    control, handle = attached(axes=4, rotary=(4,))
    registered(
        control, O12="\nN5 G92 X1.\nN10 M98 P34\nM30\n", O34="\nN110 G1 X31. Y-12. Z5. A9. F1500\nM99\n"
    )
    fwlib.cnc_wrrelpos(handle, 8, IDBWRR(type=2, data=(100,)))
    running(control, 12)
    control.advance(900)
    control.raise_alarm(1007, "DOOR")
    code, data = fwlib.cnc_rddynamic(handle, ALL_AXES, 22 + 16 * 6)
    assert (code, data.axis, data.dummy, data.acts) == (OK, -1, 0, 0)
    assert (data.prgnum, data.prgmnum, data.seqnum) == (34, 12, 110)
    assert data.actf == fwlib.cnc_actf(handle)[1].data == 1500
    assert data.alarm == -32768
    for name in ("absolute", "machine", "relative", "distance"):
        values = list(getattr(data.pos.faxis, name))
        assert values == read(name, handle, ALL_AXES, 20)[1]
        assert values[0] not in (0, values[1])
        assert values[4:] == [0, 0]
    for axis in (1, 2, 3, 4):
        code, one = fwlib.cnc_rddynamic(handle, axis, 38)
        assert (code, one.axis) == (OK, axis)
        assert [
            one.pos.oaxis.absolute,
            one.pos.oaxis.machine,
            one.pos.oaxis.relative,
            one.pos.oaxis.distance,
        ] == [
            getattr(data.pos.faxis, name)[axis - 1]
            for name in ("absolute", "machine", "relative", "distance")
        ]
    assert data.pos.faxis.absolute[0] - data.pos.faxis.machine[0] == 1000


@pytest.mark.covers("fanuc.EW_ATTRIB", "fanuc.EW_LENGTH")
@pytest.mark.covers("fanuc.cnc_rddynamic")
@covers("cnc_rddynamic.err.EW_LENGTH", "cnc_rddynamic.err.EW_ATTRIB")
@pytest.mark.covers("fanuc.concept.length_argument", "fanuc.concept.axis_number")
def test_lengths_and_axes_of_the_dynamic_data() -> None:
    _, handle = attached(axes=2)
    assert fwlib.cnc_rddynamic(handle, 1, 37)[0] == EW.EW_LENGTH
    assert fwlib.cnc_rddynamic(handle, ALL_AXES, 22 + 16 * 6 - 1)[0] == EW.EW_LENGTH  # of all that could be
    assert fwlib.cnc_rddynamic(handle, ALL_AXES, 22 + 16 * 2)[0] == EW.EW_LENGTH
    assert fwlib.cnc_rddynamic(handle, ALL_AXES, 22 + 16 * 6)[0] == OK
    for axis in (0, 3, -2):
        assert fwlib.cnc_rddynamic(handle, axis, 200)[0] == EW.EW_ATTRIB


ALARMS = {0: 100, 1: 0, 2: 101, 3: 85, 4: 506, 5: 700, 6: 417, 8: 300, 10: 5010, 15: 1003}
ENDS = {
    3: (3, 99, 102, 255), 4: (500, 599), 5: (700, 749), 6: (400, 499), 8: (301, 399), 10: (5000, 5999),
    15: (1000, 1999),
}  # fmt: skip


@pytest.mark.covers(
    "fanuc.ODBDY.alarm.bit3", "fanuc.concept.dynamic_snapshot", "fanuc.concept.position_contents",
    "fanuc.concept.ps000_after_write", "fanuc.enum.axis.1..m",
)  # fmt: skip
@pytest.mark.parametrize(
    "bit",
    [pytest.param(bit, marks=covers(f"ODBDY.alarm.bit{bit}"), id=str(bit)) for bit in range(16)],
)
@pytest.mark.covers("fanuc.ODBDY.alarm", "fanuc.struct.ODBDY")
@pytest.mark.covers("fanuc.concept.alarm_ps000_ps101")
@pytest.mark.covers("fanuc.cnc_rddynamic")
def test_bits_of_the_alarm_status(bit: int) -> None:
    control, handle = attached()

    def status() -> int:
        return int(fwlib.cnc_rddynamic(handle, 1, 38)[1].alarm) & 0xFFFF

    assert status() == 0
    if bit in ALARMS:
        control.raise_alarm(ALARMS[bit], "TEST", axis=2 if bit in (4, 6) else None)
        assert status() == 1 << bit
        control.reset()
        assert status() == (
            1 << bit if bit in (1, 2) else 0
        )  # these two stay until the power is switched off
        control.power_cycle()
        assert status() == 0
        for end in ENDS.get(bit, ()):
            control.raise_alarm(end, "TEST", axis=2 if bit in (4, 6) else None)
            assert status() == 1 << bit
    else:
        for number in (*range(300), *range(301, 800, 7), *range(1000, 6000, 97)):
            control.raise_alarm(number, "TEST")
        control.emergency_stop(True)
        assert status() & 1 << bit == 0
        assert status() & 1 << 3


# ---------------------------------------------------------------------- time


@pytest.mark.covers("fanuc.cnc_absolute")
def test_a_polling_program_sees_time_pass_and_one_cycle_in_one_round() -> None:
    control, handle = attached(Poll(1))
    registered(control, O5="\nG1 X-6. Y8. F3000\nM30\n")
    running(control, 5)
    seen = []
    for _ in range(300):
        x = fwlib.cnc_absolute(handle, 1, 8)[1].data[0]
        y = fwlib.cnc_absolute(handle, 2, 8)[1].data[0]
        seen.append((x, y))
    assert control.clock.cycles == 299
    assert max(abs(8 * x + 6 * y) for x, y in seen) <= 7  # on the path, but for rounding
    assert len(set(seen)) > 100
    control, handle = attached()
    for _ in range(3):
        fwlib.cnc_absolute(handle, 1, 8)
    assert control.clock.cycles == 0


@pytest.mark.covers("fanuc.EW_BUSY", "fanuc.mode.MEM")
@pytest.mark.covers("fanuc.cnc_incpoint")
def test_a_program_that_tries_again_what_is_busy_sees_time_pass() -> None:
    control, handle = attached(Poll(1))
    to = bytes(fwlib.ODBPOS(idata=1, ldata=700))
    for _ in range(2):  # one is carried out, one waits
        assert fwlib.cnc_incpoint(handle, 1, 0, 1, 6000, to)[0] == 0
    tried = 0
    while fwlib.cnc_incpoint(handle, 1, 0, 1, 6000, to)[0] == fwlib.EW_BUSY:
        tried += 1
        assert tried < 1000
    assert control.clock.cycles == tried - 1 > 5
    assert control.positions.read()[0].machine >= 690


@pytest.mark.covers("fanuc.cnc_allclibhndl2", "fanuc.cnc_actf")
def test_controls_with_one_clock_stay_in_step() -> None:
    attached()
    clock: Any = Poll(3)
    first, second, third = PowerMate(), PowerMate(), PowerMate()
    fwlib.attach(0, first, clock)
    fwlib.attach(1, second, clock)
    fwlib.attach(2, third)
    _, handle = fwlib.cnc_allclibhndl2(1)
    reads: Callable[[], Any] = lambda: fwlib.cnc_actf(handle)  # noqa: E731
    for _ in range(5):
        reads()
    assert [each.clock.cycles for each in (first, second, third)] == [12, 12, 0]
