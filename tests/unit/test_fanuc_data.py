"""Tool offsets, parameters and settings (Manual 000, 2712-4853)."""

from __future__ import annotations

import struct
from typing import Any

import pytest

from polycnc.controllers.fanuc import Attribute, Kind, fwlib, parameter_rows
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW, IODBTO
from support.power_mate import OK, attached, moved, psd, registered, running

MODES = ("MDI", "MEM", "EDIT", "HND", "JOG", "T-JOG", "T-HND", "INC", "REF", "RMT")


def covers(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.covers(*(f"fanuc.{name}" for name in names))


# ---------------------------------------------------------------------- tool offsets


def offset(handle: int, number: int) -> int:
    code, data = fwlib.cnc_rdtofs(handle, number, 0, 8)
    assert (code, data.datano, data.type) == (OK, number, 0)
    return int(data.data)


@pytest.mark.covers(
    "fanuc.ODBAXIS.data", "fanuc.ODBTOFS.data", "fanuc.ODBTOFS.datano", "fanuc.ODBTOFS.type",
    "fanuc.concept.axis_number", "fanuc.concept.position_contents", "fanuc.enum.axis.1..m", "fanuc.struct.ODBTOFS",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_machine")
@covers("cnc_rdtofs", "cnc_wrtofs", "example.cnc_rdtofs", "example.cnc_wrtofs", "enum.offset_type.0")
@pytest.mark.covers("fanuc.concept.tool_offset_memory")
def test_a_tool_offset_is_written_read_and_used() -> None:
    control, handle = attached()
    assert offset(handle, 99) == 0
    assert fwlib.cnc_wrtofs(handle, 99, 0, 8, -12_345) == OK
    assert fwlib.cnc_wrtofs(handle, 4, 0, 12, 7) == OK
    assert (offset(handle, 99), offset(handle, 4), offset(handle, 5)) == (-12_345, 7, 0)
    moved(control, "G43 H99 G0 Z20.")
    assert fwlib.cnc_machine(handle, 3, 8)[1].data[0] == 7655
    for mode in MODES:
        control.select_mode(mode)
        assert fwlib.cnc_wrtofs(handle, 1, 0, 8, 17) == OK


@pytest.mark.covers(
    "fanuc.EW_ATTRIB", "fanuc.EW_LENGTH", "fanuc.EW_NUMBER", "fanuc.ODBTOFS.data", "fanuc.ODBTOFS.datano",
    "fanuc.ODBTOFS.type", "fanuc.enum.offset_type.0", "fanuc.struct.ODBTOFS",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdtofs", "fanuc.cnc_wrtofs")
@covers(
    "cnc_rdtofs.err.EW_LENGTH", "cnc_rdtofs.err.EW_NUMBER", "cnc_rdtofs.err.EW_ATTRIB", "cnc_wrtofs.err.EW_LENGTH",
    "cnc_wrtofs.err.EW_NUMBER", "cnc_wrtofs.err.EW_ATTRIB", "concept.tool_offset_memory",
)  # fmt: skip
@pytest.mark.covers("fanuc.concept.length_argument")
def test_tool_offsets_that_are_refused() -> None:
    _, handle = attached(offsets=64)
    assert fwlib.cnc_wrtofs(handle, 64, 0, 8, 5) == OK
    for code, number, kind, length in (
        (EW.EW_LENGTH, 0, 9, 7),
        (EW.EW_LENGTH, 64, 0, -1),
        (EW.EW_NUMBER, 0, 9, 8),
        (EW.EW_NUMBER, 65, 0, 8),
        (EW.EW_NUMBER, -1, 0, 8),
        (EW.EW_ATTRIB, 64, 1, 8),
        (EW.EW_ATTRIB, 64, -1, 8),
    ):
        assert fwlib.cnc_rdtofs(handle, number, kind, length)[0] == code
        assert fwlib.cnc_wrtofs(handle, number, kind, length, 9) == code
        assert offset(handle, 64) == 5


@pytest.mark.covers(
    "fanuc.EW_DATA", "fanuc.ODBTOFS.data", "fanuc.ODBTOFS.datano", "fanuc.ODBTOFS.type", "fanuc.cnc_rdtofs",
    "fanuc.enum.offset_type.0", "fanuc.struct.ODBTOFS",
)  # fmt: skip
@pytest.mark.parametrize(
    ("increment", "limit", "mm", "inch"),
    [
        pytest.param("IS-A", 99_999, 0.01, 0.001, marks=covers("units.IS_A", "ncparam.1004_0")),
        pytest.param("IS-B", 999_999, 0.001, 0.0001, marks=covers("units.IS_B")),
        pytest.param("IS-C", 9_999_999, 0.0001, 0.00001, marks=covers("units.IS_C", "ncparam.1004_1")),
    ],
)
@pytest.mark.covers("fanuc.cnc_wrtofs")
@pytest.mark.covers("fanuc.concept.decimal_point", "fanuc.concept.increment_system")
def test_unit_and_range_of_tool_offsets(increment: str, limit: int, mm: float, inch: float) -> None:
    for model in ("H", "D"):
        control, handle = attached(increment=increment, model=model)
        assert control.parameters.value(1004) == {"IS-A": 1, "IS-B": 0, "IS-C": 2}[increment]
        for value in (limit, -limit):
            assert fwlib.cnc_wrtofs(handle, 3, 0, 8, value) == OK
            assert offset(handle, 3) == value
        assert control.control.tools[3].length_mm == pytest.approx(-limit * mm)
        for value in (limit + 1, -limit - 1):
            assert fwlib.cnc_wrtofs(handle, 3, 0, 8, value) == EW.EW_DATA
        assert offset(handle, 3) == -limit
    control, handle = attached(increment=increment, inch_input=True)
    assert fwlib.cnc_wrtofs(handle, 3, 0, 8, limit) == OK
    assert control.control.tools[3].length_mm == pytest.approx(limit * inch * 25.4)
    assert fwlib.cnc_wrtofs(handle, 3, 0, 8, limit + 1) == EW.EW_DATA
    assert offset(handle, 3) == limit
    control, _ = attached(increment="IS-B")
    control.parameters.set(1004, 1 if increment == "IS-A" else 2 if increment == "IS-C" else 0)
    control.power_cycle()
    assert control.units.increment == increment


@pytest.mark.covers(
    "fanuc.ODBTOFS.data", "fanuc.ODBTOFS.datano", "fanuc.ODBTOFS.type", "fanuc.cnc_rdtofs",
    "fanuc.enum.offset_type.0", "fanuc.example.cnc_rdtofs", "fanuc.struct.ODBTOFS",
)  # fmt: skip
@covers(
    "cnc_rdtofsr", "cnc_wrtofsr", "example.cnc_rdtofsr", "example.cnc_wrtofsr", "enum.offset_type.all",
    "cnc_rdtofsinfo",
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.IODBTO.datano_s",
    "fanuc.IODBTO.datano_e",
    "fanuc.IODBTO.type",
    "fanuc.IODBTO.u.m_ofs",
    "fanuc.IODBTO.u.m_ofs_a",
    "fanuc.ODBTLINF.ofs_type",
    "fanuc.ODBTLINF.use_no",
)
@pytest.mark.covers("fanuc.struct.IODBTO", "fanuc.struct.ODBTLINF")
@pytest.mark.covers("fanuc.concept.tool_offset_memory")
def test_examples_of_tool_offset_ranges() -> None:
    _, handle = attached()
    values = [37 * k - 1500 for k in range(1, 100)]
    data = IODBTO(datano_s=1, datano_e=99, type=-1)
    data.u.m_ofs_a[:] = list(values)
    assert fwlib.cnc_wrtofsr(handle, 402, data) == OK
    assert [offset(handle, number) for number in range(1, 100)] == values
    for kind, name in ((0, "m_ofs"), (-1, "m_ofs_a")):
        code, found = fwlib.cnc_rdtofsr(handle, 1, kind, 99, 402)
        assert (code, found.datano_s, found.type, found.datano_e) == (OK, 1, kind, 99)
        assert list(getattr(found.u, name)) == values
        assert struct.unpack_from("<3l", found.pack(), 6) == tuple(values[:3])
    assert list(fwlib.cnc_rdtofsr(handle, 41, 0, 43, 18)[1].u.m_ofs[:4]) == [*values[40:43], 0]
    few = IODBTO(datano_s=98, datano_e=99)
    few.u.m_ofs[0], few.u.m_ofs[1] = 7, -8
    assert fwlib.cnc_wrtofsr(handle, 14, few) == OK
    assert [offset(handle, number) for number in (97, 98, 99)] == [values[96], 7, -8]
    code, info = fwlib.cnc_rdtofsinfo(handle)
    assert (code, info.ofs_type, info.use_no) == (OK, 0, 99)
    assert fwlib.cnc_rdtofsinfo(attached(offsets=32)[1])[1].use_no == 32


@pytest.mark.covers(
    "fanuc.EW_ATTRIB", "fanuc.EW_DATA", "fanuc.EW_LENGTH", "fanuc.EW_NUMBER", "fanuc.IODBTO.u.m_ofs",
    "fanuc.enum.offset_type.0",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdtofsr", "fanuc.cnc_wrtofsr")
@covers(
    "cnc_rdtofsr.err.EW_LENGTH", "cnc_rdtofsr.err.EW_NUMBER", "cnc_rdtofsr.err.EW_ATTRIB", "cnc_wrtofsr.err.EW_LENGTH",
    "cnc_wrtofsr.err.EW_NUMBER", "cnc_wrtofsr.err.EW_ATTRIB",
)  # fmt: skip
@pytest.mark.covers("fanuc.concept.length_argument", "fanuc.concept.tool_offset_memory")
def test_tool_offset_ranges_that_are_refused_change_nothing() -> None:
    _, handle = attached()
    for code, first, last, kind, length in (
        (EW.EW_LENGTH, 1, 3, 0, 17),
        (EW.EW_LENGTH, 1, 3, 5, 17),
        (EW.EW_NUMBER, 0, 3, 5, 400),
        (EW.EW_NUMBER, 98, 100, 0, 400),
        (EW.EW_NUMBER, 4, 3, 0, 400),
        (EW.EW_ATTRIB, 1, 3, 1, 400),
        (EW.EW_ATTRIB, 1, 3, -2, 400),
    ):
        assert fwlib.cnc_rdtofsr(handle, first, kind, last, length)[0] == code
        data = IODBTO(datano_s=first, datano_e=last, type=kind)
        data.u.m_ofs[:] = [*range(1, 100)]
        assert fwlib.cnc_wrtofsr(handle, length, data) == code
        assert not any(fwlib.cnc_rdtofsr(handle, 1, 0, 99, 402)[1].u.m_ofs)
    data = IODBTO(datano_s=1, datano_e=3)
    data.u.m_ofs[:3] = [5, 6, 1_000_000]
    assert fwlib.cnc_wrtofsr(handle, 18, data) == EW.EW_DATA
    assert not any(fwlib.cnc_rdtofsr(handle, 1, 0, 99, 402)[1].u.m_ofs)


# ---------------------------------------------------------------------- one parameter


def parameter(handle: int, number: int, axis: int = 0) -> Any:
    """Return a parameter, or its values of all axes, by the element that fits its type."""
    row = parameter_rows()[number]
    code, data = fwlib.cnc_rdparam(handle, number, axis, 28)
    assert (code, data.datano, data.type) == (OK, number, axis)
    name = {Kind.BIT: "cdata", Kind.BYTE: "cdata", Kind.WORD: "idata", Kind.TWO_WORD: "ldata"}[row.kind]
    return list(getattr(data.u, f"{name}s")) if axis == ALL_AXES else getattr(data.u, name)


TYPES = {
    "bit": (3202, {"cdata": 0x51}, Kind.BIT, 1),
    "byte": (6710, {"cdata": 77}, Kind.BYTE, 1),
    "word": (2086, {"idata": -1}, Kind.WORD, 2),
    "two_word": (6711, {"ldata": 1_234_567}, Kind.TWO_WORD, 4),
}
AXIS_TYPES = {
    "bit": (1008, (0x15, -128, 0x7F), 1),
    "byte": (8010, (1, 4, 2), 1),
    "word": (1851, (-9999, 333, 9999), 2),
    "two_word": (1321, (-99_999_999, 70_000, -5), 4),
}


@pytest.mark.covers(
    "fanuc.EW_ATTRIB", "fanuc.EW_LENGTH", "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.cdata",
    "fanuc.IODBPSD.u.idata", "fanuc.IODBPSD.u.ldata", "fanuc.concept.length_argument",
    "fanuc.concept.param_record_stream", "fanuc.enum.prm_attr.0", "fanuc.enum.prm_attr.1", "fanuc.enum.prm_attr.2",
    "fanuc.enum.prm_attr.3", "fanuc.ncparam.3202_0", "fanuc.ncparam.3202_4", "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdparam.err.EW_ATTRIB", "fanuc.cnc_wrparam", "fanuc.cnc_rdparam")
@pytest.mark.parametrize("kind", [pytest.param(k, marks=covers(f"paramtype.{k}"), id=k) for k in TYPES])
@covers("enum.param_axis.0")
@pytest.mark.covers("fanuc.cnc_rdparam.err.EW_LENGTH", "fanuc.cnc_rdparar", "fanuc.cnc_wrparam.err.EW_ATTRIB")
@pytest.mark.covers("fanuc.concept.axis_number")
def test_parameters_that_have_one_value(kind: str) -> None:
    _, handle = attached()
    number, given, attribute, size = TYPES[kind]
    number = 1410 if kind == "word" else number
    given = {"idata": 12_345} if kind == "word" else given
    assert parameter_rows()[number].kind is attribute
    name, value = next(iter(given.items()))
    assert fwlib.cnc_wrparam(handle, 4 + size, psd(number, 0, **given)) == OK
    assert parameter(handle, number) == value
    code, data = fwlib.cnc_rdparam(handle, number, 0, 4 + size)
    assert (code, getattr(data.u, name)) == (OK, value)
    assert data.pack()[4 + size :] == b"\0" * (24 - size)
    as_record = record(number, int(attribute), 0, value)
    assert fwlib.cnc_rdparar(handle, number, 0, number, 20) == (OK, number, number, len(as_record), as_record)
    assert fwlib.cnc_rdparam(handle, number, 0, 3 + size)[0] == EW.EW_LENGTH
    for axis in (1, 3, ALL_AXES):
        assert fwlib.cnc_rdparam(handle, number, axis, 28)[0] == EW.EW_ATTRIB
        assert fwlib.cnc_wrparam(handle, 28, psd(number, axis)) == EW.EW_ATTRIB
    assert parameter(handle, number) == value


@pytest.mark.covers(
    "fanuc.EW_ATTRIB", "fanuc.EW_LENGTH", "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.cdata",
    "fanuc.IODBPSD.u.cdatas", "fanuc.IODBPSD.u.idata", "fanuc.IODBPSD.u.idatas", "fanuc.IODBPSD.u.ldata",
    "fanuc.IODBPSD.u.ldatas", "fanuc.concept.length_argument", "fanuc.concept.param_record_stream",
    "fanuc.enum.prm_attr.0", "fanuc.enum.prm_attr.1", "fanuc.enum.prm_attr.2", "fanuc.enum.prm_attr.3",
    "fanuc.ncparam.1321", "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrparam")
@pytest.mark.covers("fanuc.cnc_rdparam")
@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=covers(f"paramtype.{k}_axis"), id=k) for k in AXIS_TYPES]
)
@covers("enum.param_axis.1..m", "enum.param_axis.ALL_AXES")
@pytest.mark.covers(
    "fanuc.cnc_rdparam.err.EW_ATTRIB",
    "fanuc.cnc_rdparam.err.EW_LENGTH",
    "fanuc.cnc_rdparar",
    "fanuc.cnc_wrparam.err.EW_ATTRIB",
    "fanuc.cnc_wrparas",
)
@pytest.mark.covers("fanuc.concept.axis_number")
def test_parameters_of_axes(kind: str) -> None:
    _, handle = attached()
    number, values, size = AXIS_TYPES[kind]
    name = {1: "cdata", 2: "idata", 4: "ldata"}[size]
    assert fwlib.cnc_wrparam(handle, 4 + 3 * size, psd(number, ALL_AXES, **{f"{name}s": values})) == OK
    assert parameter(handle, number, ALL_AXES) == [*values, 0, 0, 0]
    assert [parameter(handle, number, axis) for axis in (1, 2, 3, 4, 6)] == [*values, 0, 0]
    as_records = record(number, list(AXIS_TYPES).index(kind), 0xFF, *values, 0, 0, 0)
    assert fwlib.cnc_rdparar(handle, number, ALL_AXES, number, 100) == (
        OK,
        number,
        number,
        len(as_records),
        as_records,
    )
    assert fwlib.cnc_wrparas(handle, len(as_records), as_records) == OK
    assert parameter(handle, number, ALL_AXES) == [*values, 0, 0, 0]
    assert fwlib.cnc_wrparam(handle, 4 + size, psd(number, 2, **{name: 3})) == OK
    assert parameter(handle, number, ALL_AXES)[:3] == [values[0], 3, values[2]]
    assert fwlib.cnc_rdparam(handle, number, 2, 4 + size)[0] == OK
    assert fwlib.cnc_rdparam(handle, number, ALL_AXES, 4 + 3 * size)[0] == OK
    assert fwlib.cnc_rdparam(handle, number, ALL_AXES, 3 + 3 * size)[0] == EW.EW_LENGTH
    for axis in (0, 7, -2):
        assert fwlib.cnc_rdparam(handle, number, axis, 28)[0] == EW.EW_ATTRIB
        assert fwlib.cnc_wrparam(handle, 28, psd(number, axis, **{name: 1})) == EW.EW_ATTRIB
    assert parameter(handle, number, ALL_AXES)[:3] == [values[0], 3, values[2]]


@pytest.mark.covers("fanuc.enum.param_axis.ALL_AXES", "fanuc.paramtype.byte_axis")
@covers("cnc_rdparam", "example.cnc_rdparam", "ncparam.1020")
@pytest.mark.covers("fanuc.IODBPSD.u.cdatas")
@pytest.mark.covers("fanuc.struct.IODBPSD")
@pytest.mark.covers("fanuc.ALL_AXES")
def test_example_axis_names() -> None:
    _, handle = attached(axes=4, rotary=(3,))
    code, data = fwlib.cnc_rdparam(handle, 1020, ALL_AXES, 4 + 1 * fwlib.MAX_AXIS)
    assert code == OK
    assert "".join(chr(each) if each else "-" for each in data.u.cdatas) == "XYAZ--"


@pytest.mark.covers(
    "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.ldata", "fanuc.ODBAXIS.data", "fanuc.ODBDY.alarm",
    "fanuc.ODBDY.alarm.bit4", "fanuc.cnc_rdparam", "fanuc.concept.axis_number", "fanuc.concept.dynamic_snapshot",
    "fanuc.concept.position_contents", "fanuc.enum.axis.1..m", "fanuc.enum.param_axis.1..m",
    "fanuc.example.cnc_machine", "fanuc.example.cnc_rddynamic", "fanuc.example.cnc_rdparam",
    "fanuc.paramtype.two_word_axis", "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_machine", "fanuc.cnc_rddynamic")
@covers("cnc_wrparam", "example.cnc_wrparam", "ncparam.1320", "ncparam.1321")
def test_example_stroke_limits_act_on_the_machine() -> None:
    control, handle = attached()
    for number, value in ((1320, 12_500), (1321, -7_250)):
        assert fwlib.cnc_wrparam(handle, 8, psd(number, 2, ldata=value)) == OK
    assert [parameter(handle, number, 2) for number in (1320, 1321)] == [12_500, -7_250]
    assert parameter(handle, 1320, 1) == 99_999_999
    assert control.machine.config.axes[1].soft_limits == (-7.25, 12.5)
    control.select_mode("JOG")
    control.control.jog("Y", 1)
    control.advance(20_000)
    assert fwlib.cnc_machine(handle, 2, 8)[1].data[0] == 12_500
    assert fwlib.cnc_rddynamic(handle, 1, 38)[1].alarm == 1 << 4
    control.control.jog("Y", None)
    control.reset()
    registered(control, O7="\nG1 Y12.6 F600\nM30\n")
    running(control, 7)
    control.advance(3000)
    assert fwlib.cnc_machine(handle, 2, 8)[1].data[0] == 12_500
    (alarm,) = control.status().alarms
    assert (alarm.number, alarm.text, alarm.axis) == (500, "OVER TRAVEL : +Y", "Y")
    assert fwlib.cnc_rddynamic(handle, 1, 38)[1].alarm == 1 << 4
    control.reset()
    registered(control, O8="\nG1 X-9. Y-7.26 F600\nM30\n")
    running(control, 8)
    control.advance(3000)
    assert [(each.number, each.text) for each in control.status().alarms] == [(501, "OVER TRAVEL : -Y")]
    assert fwlib.cnc_machine(handle, 2, 8)[1].data[0] == -7_250  # it runs up to the limit
    control.reset()
    assert fwlib.cnc_wrparam(handle, 8, psd(1320, 2, ldata=-8_000)) == OK  # below 1321: no limits
    running(control, 7)
    control.advance(3000)
    assert fwlib.cnc_machine(handle, 2, 8)[1].data[0] == 12_600


@pytest.mark.covers(
    "fanuc.EW_ATTRIB", "fanuc.EW_DATA", "fanuc.EW_LENGTH", "fanuc.EW_NOOPT", "fanuc.EW_NUMBER", "fanuc.EW_PROT",
    "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.cdata", "fanuc.cnc_wrparas",
    "fanuc.concept.option_none", "fanuc.paramtype.byte_axis", "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdparam")
@covers(
    "cnc_rdparam.err.EW_LENGTH", "cnc_rdparam.err.EW_NUMBER", "cnc_rdparam.err.EW_ATTRIB", "cnc_wrparam.err.EW_LENGTH",
    "cnc_wrparam.err.EW_NUMBER", "cnc_wrparam.err.EW_ATTRIB", "cnc_wrparam.err.EW_NOOPT", "cnc_wrparam.err.EW_PROT",
    "option.param_write", "ODBPARAIF.prm_type.bit5", "ODBPARAIF.prm_type.bit7",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrparam")
@pytest.mark.covers("fanuc.struct.ODBPARAIF")
@pytest.mark.covers("fanuc.concept.length_argument", "fanuc.concept.axis_number", "fanuc.common.allmode")
@pytest.mark.covers(
    "fanuc.paramtype.two_word_axis",
    "fanuc.enum.param_axis.0",
    "fanuc.enum.param_axis.1..m",
    "fanuc.enum.param_axis.ALL_AXES",
)
def test_parameters_that_are_refused_change_nothing() -> None:
    control, handle = attached(options=("pmc_axis",))
    before = {key: control.parameters.value(*key) for key in control.parameters._values}
    for code, length, data in (
        (EW.EW_LENGTH, 4, psd(6710)),
        (EW.EW_LENGTH, 4, psd(9)),
        (EW.EW_LENGTH, 7, psd(1320, 2, ldata=5)),
        (EW.EW_LENGTH, 15, psd(1320, ALL_AXES, ldatas=[5, 6, 7])),
        (EW.EW_NUMBER, 28, psd(9)),
        (EW.EW_NUMBER, 28, psd(-1)),
        (EW.EW_ATTRIB, 28, psd(1320, 0)),
        (EW.EW_ATTRIB, 28, psd(1320, 7)),
        (EW.EW_ATTRIB, 28, psd(6710, 1)),
        (EW.EW_DATA, 28, psd(1420, 1, ldata=29)),
        (EW.EW_DATA, 28, psd(1420, 1, ldata=240_001)),
        (EW.EW_DATA, 28, psd(8010, ALL_AXES, cdatas=[1, 5, 1])),
        (EW.EW_NOOPT, 28, psd(6080, 0, cdata=9)),
        (EW.EW_PROT, 28, psd(1010, 0, cdata=2)),
    ):
        assert fwlib.cnc_wrparam(handle, length, data) == code
        assert {key: control.parameters.value(*key) for key in before} == before
    assert fwlib.cnc_wrparam(handle, 28, psd(8010, 1, cdata=3)) == OK  # its option is there
    control.state.parameters_writable = False
    assert fwlib.cnc_wrparam(handle, 28, psd(8010, 1, cdata=4)) == EW.EW_PROT
    assert parameter(handle, 8010, 1) == 3
    assert fwlib.cnc_rdparam(handle, 9, 0, 28)[0] == EW.EW_NUMBER
    assert fwlib.cnc_rdparam(handle, -1, 0, 28)[0] == EW.EW_NUMBER
    assert fwlib.cnc_rdparam(handle, 3210, 0, 28)[0] == EW.EW_NUMBER  # cannot be read
    assert fwlib.cnc_rdparam(handle, 9, 0, 4)[0] == EW.EW_LENGTH
    for axis, least in ((2, 4 + 4), (ALL_AXES, 4 + 4 * 3)):  # 1320 has two words
        assert fwlib.cnc_rdparam(handle, 1320, axis, least - 1)[0] == EW.EW_LENGTH
        assert fwlib.cnc_rdparam(handle, 1320, axis, least)[0] == OK
    for axis in (0, 7, -2):
        assert fwlib.cnc_rdparam(handle, 1320, axis, 28)[0] == EW.EW_ATTRIB
    assert fwlib.cnc_rdparam(handle, 6080, 1, 28)[0] == EW.EW_ATTRIB
    assert fwlib.cnc_rdparam(handle, 6080, 0, 5)[0] == OK  # reading needs no option
    control.state.parameters_writable = True
    assert fwlib.cnc_wrparam(handle, 8, psd(3210, 0, ldata=77)) == OK  # what cannot be read can be written
    assert fwlib.cnc_wrparas(handle, 8, record(3210, 3, 0, 78)) == OK
    assert control.parameters.value(3210) == 78


@pytest.mark.covers(
    "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.cdata", "fanuc.cnc_rdparam",
    "fanuc.enum.param_axis.0", "fanuc.ncparam.3202_0", "fanuc.ncparam.3202_4", "fanuc.paramtype.bit",
    "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrparam")
@covers("concept.bit_param_rmw")
def test_a_bit_is_changed_by_writing_its_byte() -> None:
    _, handle = attached()
    assert fwlib.cnc_wrparam(handle, 5, psd(3202, 0, cdata=0x11)) == OK
    byte = parameter(handle, 3202)
    assert fwlib.cnc_wrparam(handle, 5, psd(3202, 0, cdata=byte & ~0x10)) == OK
    assert parameter(handle, 3202) == 0x01
    assert fwlib.cnc_wrparam(handle, 5, psd(3202, 0, cdata=-128)) == OK  # bit 7 is the sign of a char
    assert parameter(handle, 3202) == -128
    assert attached()[0].parameters.value(3202) == 0


@pytest.mark.covers(
    "fanuc.EW_BUSY", "fanuc.ODBDY.alarm", "fanuc.ODBDY.alarm.bit1", "fanuc.cnc_dwnstart.err.EW_BUSY",
    "fanuc.cnc_upstart.err.EW_BUSY", "fanuc.concept.download_session", "fanuc.concept.dynamic_snapshot",
    "fanuc.concept.position_contents", "fanuc.concept.program_busy_conditions", "fanuc.concept.upload_session",
    "fanuc.enum.axis.1..m", "fanuc.mode.MEM",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_delete", "fanuc.cnc_rddynamic", "fanuc.cnc_search", "fanuc.cnc_upstart")
@covers("concept.ps000_after_write", "ODBPARAIF.prm_type.bit6")
@pytest.mark.covers(
    "fanuc.cnc_delete.err.EW_BUSY", "fanuc.cnc_dwnstart", "fanuc.cnc_search.err.EW_BUSY", "fanuc.cnc_wrparam"
)
@pytest.mark.covers("fanuc.struct.ODBPARAIF")
@pytest.mark.covers("fanuc.concept.alarm_ps000_ps101")
def test_some_parameters_need_the_power_switched_off() -> None:
    control, handle = attached(axes=2)
    registered(control, O12="\nM30\n")
    assert fwlib.cnc_wrparam(handle, 5, psd(1006, 2, cdata=1)) == OK
    assert fwlib.cnc_rddynamic(handle, 1, 38)[1].alarm == 1 << 1
    assert [fwlib.cnc_dwnstart(handle), fwlib.cnc_upstart(handle, 12), fwlib.cnc_search(handle, 12)] == [
        EW.EW_BUSY
    ] * 3
    assert fwlib.cnc_delete(handle, 12) == EW.EW_BUSY
    assert not control.units.is_rotary(2)
    control.reset()
    assert fwlib.cnc_search(handle, 12) == EW.EW_BUSY
    control.power_cycle()
    assert fwlib.cnc_search(handle, 12) == OK
    assert control.units.is_rotary(2)
    assert fwlib.cnc_wrparam(handle, 8, psd(1320, 1, ldata=5000)) == OK
    assert control.power.alarm_bits == 0


# ---------------------------------------------------------------------- records


def records(data: bytes, sizes: dict[int, int], axes: int = 1) -> list[tuple[int, int, int, tuple[int, ...]]]:
    """Take a sequence of records apart: number, type attribute, axis, values."""
    found, at = [], 0
    while at < len(data):
        number, kind = struct.unpack_from("<hH", data, at)
        size = sizes[kind >> 8]
        count = axes if kind & 0xFF == 0xFF else 1
        form = {1: "b", 2: "h", 4: "l"}[size]
        found.append((number, kind >> 8, kind & 0xFF, struct.unpack_from(f"<{count}{form}", data, at + 4)))
        at += 4 + size * count
        at += at % 2
    assert at == len(data)
    return found


SIZES = {0: 1, 1: 1, 2: 2, 3: 4}


@covers(
    "cnc_rdparar", "example.cnc_rdparar", "concept.param_record_stream", "concept.axis_param_rule", "enum.prm_attr.0",
    "enum.prm_attr.1", "enum.prm_attr.2", "enum.prm_attr.3", "concept.sparse_parameters", "concept.range_growth",
    "struct.IODBPSD", "IODBPSD.type",
)  # fmt: skip
@pytest.mark.covers("fanuc.concept.axis_number")
@pytest.mark.covers("fanuc.ALL_AXES", "fanuc.MAX_AXIS")
@pytest.mark.covers("fanuc.paramtype.byte_axis", "fanuc.paramtype.two_word_axis")
def test_a_range_of_parameters_is_a_sequence_of_records() -> None:
    control, handle = attached(axes=3)
    control.parameters.set(1420, 24_000, 2)
    control.parameters.set(1410, 1234)
    control.parameters.set(1401, 0x42)
    code, first, last, length, data = fwlib.cnc_rdparar(handle, 1400, 2, 1425, 1000)
    assert (code, first, last, length) == (OK, 1401, 1425, len(data))
    found = records(data, SIZES)
    assert [each[0] for each in found] == [1401, 1402, 1410, 1420, 1421, 1422, 1423, 1424, 1425]
    assert found[0] == (1401, 0, 0, (0x42,))
    assert found[2] == (1410, 2, 0, (1234,))  # read whatever the axis
    assert found[3] == (1420, 3, 2, (24_000,))
    assert found[8] == (1425, 2, 2, (300,))
    assert length == 6 + 6 + 6 + 8 * 5 + 6
    code, _, _, length, data = fwlib.cnc_rdparar(handle, 1420, ALL_AXES, 1425, 1000)
    found = records(data, SIZES, 6)
    assert found[0] == (1420, 3, 0xFF, (15_000, 24_000, 15_000, 0, 0, 0))
    assert length == 28 * 4 + 8 + 16
    code, _, _, length, data = fwlib.cnc_rdparar(handle, 1020, ALL_AXES, 1023, 1000)
    assert (code, length) == (OK, 3 * 10)
    assert records(data, SIZES, 6)[0] == (1020, 1, 0xFF, tuple(b"XYZ\0\0\0"))
    assert fwlib.cnc_rdparar(handle, 6710, 0, 6710, 6)[3:] == (6, b"\x36\x1a\0\x01\0\0")
    assert fwlib.cnc_rdparar(handle, 0, 0, 0, 6)[:4] == (OK, 0, 0, 6)  # number 0 is a parameter
    _, handle = attached(model="D")
    code, _, _, length, data = fwlib.cnc_rdparar(handle, 1020, ALL_AXES, 1020, 100)
    assert (code, length) == (OK, 6)
    assert fwlib.cnc_rdparar(handle, 1420, ALL_AXES, 1420, 100)[3] == 12


@pytest.mark.covers(
    "fanuc.EW_ATTRIB", "fanuc.EW_LENGTH", "fanuc.EW_NUMBER", "fanuc.concept.param_record_stream",
    "fanuc.enum.param_axis.0", "fanuc.enum.prm_attr.3",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdparar")
@covers("cnc_rdparar.err.EW_LENGTH", "cnc_rdparar.err.EW_NUMBER", "cnc_rdparar.err.EW_ATTRIB")
@pytest.mark.covers(
    "fanuc.concept.length_argument",
    "fanuc.concept.axis_number",
    "fanuc.concept.axis_param_rule",
    "fanuc.concept.range_growth",
    "fanuc.concept.sparse_parameters",
)
def test_ranges_of_parameters_that_are_refused() -> None:
    _, handle = attached()

    def code(first: int, axis: int, last: int, length: int) -> int:
        found = fwlib.cnc_rdparar(handle, first, axis, last, length)
        assert found[1:] == (first, last, length, b"")
        return found[0]

    assert code(6711, 0, 6713, 23) == EW.EW_LENGTH
    assert fwlib.cnc_rdparar(handle, 6711, 0, 6713, 24)[0] == OK
    assert code(6711, 0, 6713, 0) == EW.EW_LENGTH
    assert code(1420, ALL_AXES, 1420, 27) == EW.EW_LENGTH
    assert code(6713, 0, 6711, 100) == EW.EW_NUMBER
    assert code(2, 0, 11, 100) == EW.EW_NUMBER  # none in between
    assert code(-5, 0, 10, 100) == EW.EW_NUMBER
    assert code(3210, 0, 3210, 100) == EW.EW_NUMBER
    assert code(6711, 7, 6713, 100) == EW.EW_ATTRIB
    assert code(6711, -2, 6713, 100) == EW.EW_ATTRIB
    assert code(1410, 0, 1420, 100) == EW.EW_ATTRIB  # 1420 is of axes
    assert fwlib.cnc_rdparar(handle, 1401, 0, 1410, 100)[0] == OK
    # Axis 6 is one that the control could have: what it has not is 0.
    assert fwlib.cnc_rdparar(handle, 1420, 6, 1420, 8) == (OK, 1420, 1420, 8, record(1420, 3, 6, 0))


@pytest.mark.covers(
    "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.cdata", "fanuc.cnc_rdparam",
    "fanuc.enum.param_axis.0", "fanuc.example.cnc_rdparam", "fanuc.paramtype.byte", "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.parametrize(
    "slot", [pytest.param(k, marks=covers(f"ncparam.{6080 + k}"), id=str(6080 + k)) for k in range(10)]
)
@covers("cnc_wrparas", "example.cnc_wrparas")
@pytest.mark.covers("fanuc.concept.param_record_stream")
def test_example_ten_m_codes(slot: int) -> None:
    _, handle = attached()
    data = b"".join(struct.pack("<hhbx", 6080 + k, 0, 31 + 3 * k) for k in range(10))
    assert len(data) == 60
    assert parameter(handle, 6080 + slot) == 0
    assert fwlib.cnc_wrparas(handle, 60, data) == OK
    assert parameter(handle, 6080 + slot) == 31 + 3 * slot


def record(number: int, kind: int, axis: int, *values: int) -> bytes:
    size = SIZES[kind]
    data = struct.pack("<hH", number, kind << 8 | axis)
    data += struct.pack(f"<{len(values)}{ {1: 'b', 2: 'h', 4: 'l'}[size] }", *values)
    return data + b"\0" * (len(data) % 2)


@pytest.mark.covers("fanuc.cnc_wrparas")
@pytest.mark.covers("fanuc.cnc_rdparar")
@pytest.mark.covers("fanuc.concept.param_record_stream")
@pytest.mark.covers("fanuc.enum.prm_attr.3", "fanuc.paramtype.two_word_axis")
def test_what_is_read_as_records_can_be_written_back() -> None:
    control, handle = attached()
    for number in (1420, 1423):
        control.parameters.set(number, 7_000 + number, 3)
    for axis in (3, ALL_AXES):
        _, _, _, length, data = fwlib.cnc_rdparar(handle, 1401, axis, 1430, 1000)
        for number in (1420, 1423):
            control.parameters.set(number, 999, 3)
        assert fwlib.cnc_wrparas(handle, length, data) == OK
        assert [parameter(handle, number, 3) for number in (1420, 1423)] == [8_420, 8_423]
    axes = b"".join(record(1420, 3, axis, 1000 * axis) for axis in (1, 2, 3))
    assert fwlib.cnc_wrparas(handle, len(axes), axes) == OK
    assert parameter(handle, 1420, ALL_AXES) == [1000, 2000, 3000, 0, 0, 0]


REFUSED: list[tuple[EW, bytes, int]] = [
    (EW.EW_LENGTH, record(6711, 3, 0, 5), 7),
    (EW.EW_LENGTH, record(6711, 3, 0, 5), 9),
    (EW.EW_LENGTH, record(6711, 3, 0, 5), 0),
    (EW.EW_LENGTH, record(6711, 3, 0, 5) + b"\0\0", 10),
    (EW.EW_LENGTH, record(6711, 3, 0, 5) + record(6712, 3, 0, 5)[:6], 14),
    (EW.EW_NUMBER, record(6711, 3, 0, 5) + record(6714, 3, 0, 5), 16),
    (EW.EW_NUMBER, record(6712, 3, 0, 5) + record(6711, 3, 0, 5), 16),
    (EW.EW_ATTRIB, record(6711, 3, 0, 5) + record(6712, 3, 1, 5), 16),
]


@pytest.mark.covers("fanuc.cnc_wrparas")
@covers(
    "cnc_wrparas.err.EW_LENGTH", "option.param_write", "cnc_wrparas.err.EW_NUMBER", "cnc_wrparas.err.EW_ATTRIB",
    "cnc_wrparas.err.EW_NOOPT",
    "cnc_wrparas.err.EW_PROT",
)  # fmt: skip
@pytest.mark.covers("fanuc.concept.length_argument", "fanuc.concept.param_record_stream")
def test_records_that_are_refused_change_nothing() -> None:
    control, handle = attached(options=False)
    for code, data, length in (
        *REFUSED,
        (EW.EW_ATTRIB, record(1420, 3, 7, 500), 8),
        (EW.EW_ATTRIB, record(1420, 3, 0, 500), 8),
        (EW.EW_DATA, record(6711, 3, 0, 5) + record(6713, 3, 0, 1_000_000), 16),
        (EW.EW_NOOPT, record(6050, 2, 0, 5) + record(6711, 3, 0, 5), 14),
        (EW.EW_PROT, record(1010, 1, 0, 3) + record(6711, 3, 0, 5), 14),
    ):
        assert fwlib.cnc_wrparas(handle, length, data) == code
        assert (parameter(handle, 6711), parameter(handle, 1420, 1)) == (0, 15_000)
    control.state.parameters_writable = False
    assert fwlib.cnc_wrparas(handle, 8, record(6711, 3, 0, 5)) == EW.EW_PROT


# ---------------------------------------------------------------------- attributes


@covers("cnc_rdparainfo", "cnc_rdparainfo.err.EW_NUMBER")
@pytest.mark.covers(
    "fanuc.ODBPARAIF.info.prm_no",
    "fanuc.ODBPARAIF.info_no",
    "fanuc.ODBPARAIF.prev_no",
    "fanuc.ODBPARAIF.next_no",
)
@pytest.mark.covers("fanuc.struct.ODBPARAIF")
@pytest.mark.covers("fanuc.concept.sparse_parameters")
def test_walking_through_the_parameters() -> None:
    _, handle = attached()
    rows = parameter_rows()
    number = 0
    found: list[int] = []
    while number != -1:
        code, info = fwlib.cnc_rdparainfo(handle, number, 7)
        assert code == OK
        numbers = [each.prm_no for each in info.info]
        assert (len(numbers), numbers[0]) == (info.info_no, number)
        assert info.prev_no == (found[-1] if found else -1)
        found += numbers
        number = info.next_no
    assert found == sorted(rows)
    code, info = fwlib.cnc_rdparainfo(handle, 2, 1)
    assert (code, info.info_no, info.prev_no, info.info[0].prm_no, info.next_no) == (OK, 1, 1, 12, 20)
    assert fwlib.cnc_rdparainfo(handle, max(found) + 1, 5)[0] == EW.EW_NUMBER
    assert fwlib.cnc_rdparainfo(handle, -1, 5)[0] == EW.EW_NUMBER
    assert fwlib.cnc_rdparainfo(handle, 0, 0)[0] == EW.EW_LENGTH
    assert fwlib.cnc_rdparainfo(handle, 0, 65_535)[1].info_no == len(rows)


def attributes(number: int) -> int:
    _, handle = attached()
    code, info = fwlib.cnc_rdparainfo(handle, number, 1)
    assert (code, info.info[0].prm_no) == (OK, number)
    return int(info.info[0].prm_type)


# fmt: off
BITS: dict[str, tuple[int, int, tuple[int, ...]]] = {
    # name: shift, mask, all numbers that have it
    "bit2": (2, 1, (
        12, 1005, 1006, 1008, 1020, 1022, 1023, *range(1220, 1227), 1240, 1241, 1260, 1320, 1321, 1420, 1421, 1423,
        1424, 1425, 1430, 1620, 1622, 1624, 1825, 1826, 1828, 1829, 1850, 1851, 2020, 2086, 8010, 8022,
    )),
    "bit3": (3, 1, ()),
    "bit4": (4, 1, (0, 1, 12, 20, 100, 6711, 6712, 6713, *range(6750, 6759))),
    "bit5": (5, 1, (1010,)),
    "bit6": (6, 1, (
        1001, 1004, 1006, 1008, 1010, 1020, 1022, 1023, 1240, 1241, 1260, 1850, 2020, 2086,
    )),
    "bit7": (7, 1, (3210,)),
    "bit8": (8, 1, ()),
    "bit9_15": (9, 0x7F, ()),
}
# fmt: on


@pytest.mark.covers("fanuc.ODBPARAIF.info.prm_no", "fanuc.ODBPARAIF.info.prm_type", "fanuc.cnc_rdparainfo")
@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=covers(f"ODBPARAIF.prm_type.{n}"), id=n) for n in BITS]
)
@pytest.mark.covers("fanuc.struct.ODBPARAIF")
@pytest.mark.covers("fanuc.concept.setting_subset", "fanuc.concept.sparse_parameters")
@pytest.mark.covers("fanuc.ODBPARAIF.prm_type.bit0_1")
def test_attribute_bits(name: str) -> None:
    shift, mask, have = BITS[name]
    _, handle = attached()
    _, info = fwlib.cnc_rdparainfo(handle, 0, 65_535)
    found = {each.prm_no: each.prm_type >> shift & mask for each in info.info}
    assert found == {number: int(number in have) for number in parameter_rows()}
    flag = {"bit3": Attribute.UNSIGNED, "bit8": Attribute.SPINDLE}.get(name)
    if flag is not None:
        assert int(flag) == 1 << shift


@pytest.mark.covers("fanuc.ODBPARAIF.info.prm_no", "fanuc.ODBPARAIF.info.prm_type", "fanuc.cnc_rdparainfo")
@covers("ODBPARAIF.prm_type.bit0_1")
@pytest.mark.covers("fanuc.struct.ODBPARAIF")
@pytest.mark.covers("fanuc.concept.param_record_stream", "fanuc.concept.sparse_parameters")
@pytest.mark.covers(
    "fanuc.enum.prm_attr.0", "fanuc.enum.prm_attr.1", "fanuc.enum.prm_attr.2", "fanuc.enum.prm_attr.3"
)
def test_type_attribute() -> None:
    assert [attributes(number) & 3 for number in (3201, 6710, 1410, 6711, 1006, 1020, 1825, 1320)] == [
        0,
        1,
        2,
        3,
    ] * 2


# ---------------------------------------------------------------------- settings


@pytest.mark.covers(
    "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.cdatas", "fanuc.cnc_rdparam",
    "fanuc.concept.param_record_stream", "fanuc.enum.param_axis.ALL_AXES", "fanuc.enum.prm_attr.0",
    "fanuc.enum.prm_attr.3", "fanuc.paramtype.bit_axis", "fanuc.struct.IODBPSD",
)  # fmt: skip
@covers("cnc_rdsetr", "cnc_wrsets", "concept.setting_subset")
def test_settings_are_the_parameters_of_the_setting_screen() -> None:
    _, handle = attached()
    code, first, last, length, data = fwlib.cnc_rdsetr(handle, 6700, 0, 6760, 1000)
    assert (code, first, last, length) == (OK, 6711, 6758, 12 * 8)
    assert [each[0] for each in records(data, SIZES)] == [6711, 6712, 6713, *range(6750, 6759)]
    assert fwlib.cnc_wrsets(handle, 16, record(6711, 3, 0, 37) + record(6713, 3, 0, 500)) == OK
    code, _, _, _, data = fwlib.cnc_rdsetr(handle, 6711, 0, 6713, 24)
    assert [each[3][0] for each in records(data, SIZES)] == [37, 0, 500]
    code, first, last, length, data = fwlib.cnc_rdsetr(handle, 0, 3, 20, 100)
    assert (code, first, last, length) == (OK, 0, 20, 4 * 6)
    assert records(data, SIZES)[2] == (12, 0, 3, (0,))
    code, _, _, length, data = fwlib.cnc_rdsetr(handle, 12, ALL_AXES, 12, 100)
    assert (code, length, records(data, SIZES, 6)) == (OK, 10, [(12, 0, 0xFF, (0,) * 6)])
    assert fwlib.cnc_wrsets(handle, 10, record(12, 0, 0xFF, 1, 0, 1, 0, 0, 0)) == OK
    assert parameter(handle, 12, ALL_AXES) == [1, 0, 1, 0, 0, 0]


@pytest.mark.covers(
    "fanuc.EW_ATTRIB", "fanuc.EW_LENGTH", "fanuc.EW_NOOPT", "fanuc.EW_NUMBER", "fanuc.IODBPSD.datano",
    "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.ldata", "fanuc.cnc_rdparam", "fanuc.concept.option_none",
    "fanuc.enum.param_axis.0", "fanuc.paramtype.two_word", "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdsetr", "fanuc.cnc_wrsets")
@covers(
    "cnc_rdsetr.err.EW_LENGTH", "cnc_rdsetr.err.EW_NUMBER", "cnc_rdsetr.err.EW_ATTRIB", "cnc_wrsets.err.EW_LENGTH",
    "option.param_write", "cnc_wrsets.err.EW_NUMBER", "cnc_wrsets.err.EW_ATTRIB", "cnc_wrsets.err.EW_NOOPT",
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.concept.length_argument",
    "fanuc.concept.axis_number",
    "fanuc.concept.axis_param_rule",
    "fanuc.concept.setting_subset",
)
def test_settings_that_are_refused() -> None:
    control, handle = attached(options=False)
    assert fwlib.cnc_rdsetr(handle, 6711, 0, 6713, 23)[0] == EW.EW_LENGTH
    assert fwlib.cnc_rdsetr(handle, 1320, 1, 1321, 100)[0] == EW.EW_NUMBER  # parameters, no settings
    assert fwlib.cnc_rdsetr(handle, 6713, 0, 6711, 100)[0] == EW.EW_NUMBER
    assert fwlib.cnc_rdsetr(handle, 0, 0, 20, 100)[0] == EW.EW_ATTRIB  # 0012 is of axes
    assert fwlib.cnc_rdsetr(handle, 6711, 7, 6713, 100)[0] == EW.EW_ATTRIB
    for code, data, length in (
        *REFUSED,
        (EW.EW_NUMBER, record(6710, 1, 0, 5), 6),
        (EW.EW_ATTRIB, record(12, 0, 0, 1), 6),
    ):
        assert fwlib.cnc_wrsets(handle, length, data) == code
        assert parameter(handle, 6711) == 0
    control.state.parameters_writable = False
    assert fwlib.cnc_wrsets(handle, 8, record(6711, 3, 0, 5)) == OK  # settings can always be put in
    control.parameters.rows = {6711: _with_option(6711, "run_hour")}  # type: ignore[assignment]
    assert fwlib.cnc_wrsets(handle, 8, record(6711, 3, 0, 6)) == EW.EW_NOOPT
    control.options = frozenset({"run_hour"})
    assert fwlib.cnc_wrsets(handle, 8, record(6711, 3, 0, 6)) == OK


def _with_option(number: int, option: str) -> Any:
    from dataclasses import replace

    return replace(parameter_rows()[number], option=option)


@pytest.mark.covers(
    "fanuc.IODBPSD.datano", "fanuc.IODBPSD.type", "fanuc.IODBPSD.u.ldata", "fanuc.cnc_rdparam",
    "fanuc.enum.param_axis.0", "fanuc.paramtype.two_word", "fanuc.struct.IODBPSD",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrsets")
@pytest.mark.covers("fanuc.concept.setting_subset")
def test_counters_and_timers_are_settings() -> None:
    control, handle = attached()
    registered(control, O7="\nG1 X5. F600\nM30\n")
    for _ in range(3):
        running(control, 7)
        control.advance(2000)
    assert [parameter(handle, number) for number in (6711, 6712)] == [3, 3]
    assert parameter(handle, 6757) == round(control.status().timers_s["cycle"] * 1000)  # type: ignore[index]
    assert fwlib.cnc_wrsets(handle, 8, record(6750, 3, 0, 77)) == OK
    control.advance(1)
    assert parameter(handle, 6750) == 77
    assert fwlib.cnc_wrsets(handle, 16, record(6751, 3, 0, 59_500) + record(6752, 3, 0, 12)) == OK
    assert [parameter(handle, number) for number in (6751, 6752)] == [59_500, 12]
    registered(control, O7="\nG1 X0 F600\nM30\n")
    running(control, 7)
    control.advance(1000)
    assert parameter(handle, 6752) in (12, 13)


@pytest.mark.covers("fanuc.cnc_wrsets")
def test_timers_are_minutes_and_what_is_over_in_milliseconds() -> None:
    """6751 and 6752 are automatic operation, 6753 and 6754 cutting, 6757 and 6758 the last operation."""
    control, handle = attached()
    registered(control, O7="\nG1 X5. F600\nG0 X7.\nG4 X0.7\nM30\n")
    running(control, 7)
    control.advance(2000)
    operated, cut, last = (parameter(handle, number) for number in (6751, 6753, 6757))
    assert cut == pytest.approx(500, abs=10)
    assert operated == last > cut + 700
    assert fwlib.cnc_wrsets(handle, 16, record(6753, 3, 0, 59_900) + record(6754, 3, 0, 7)) == OK
    assert fwlib.cnc_wrsets(handle, 16, record(6751, 3, 0, 59_300) + record(6752, 3, 0, 12)) == OK
    running(control, 7)
    control.advance(2000)  # 2 mm are cut
    assert [parameter(handle, number) for number in (6752, 6754, 6758)] == [13, 8, 0]
    assert parameter(handle, 6753) == pytest.approx(100, abs=10)
    assert parameter(handle, 6757) == pytest.approx(last - 300, abs=15)
    assert parameter(handle, 6751) == 59_300 + parameter(handle, 6757) - 60_000
