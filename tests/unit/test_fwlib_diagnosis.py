"""Diagnosis data, figures, servo values and messages to the operator through the library (Manual 000)."""

from __future__ import annotations

from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from support.refusals import refused


def at(control: PowerMate) -> tuple[Any, int]:
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    return session, handle


def moving(text: str = "G1 X90. Y-45. F1200", **more: Any) -> tuple[PowerMate, Any, int]:
    control = PowerMate(**more)
    library, handle = at(control)
    control.programs.memory.create("O0004", f"O0004\n{text}\n".encode())
    control.select_program(4)
    control.cycle_start()
    control.advance(300)
    return control, library, handle


KINDS = [  # kind, diagnosis number, bytes of a value, axis, length, value of the kind in the range's type
    ("bit", 20, 1, 0, 5, 0x28),
    ("bit_axis", 200, 1, 2, 5, 0x10),
    ("byte", 4, 1, 0, 5, 1),
    ("byte_axis", 203, 1, 3, 5, 1),
    ("word", 30, 2, 0, 6, 173),
    ("word_axis", 202, 2, 1, 6, 600),
    ("2word", 31, 4, 0, 8, 1200),
    ("2word_axis", 301, 4, 2, 8, -61500),
]


def arranged(kind: str) -> tuple[PowerMate, Any, int]:
    """Return a control in a state that a kind of diagnosis shows."""
    if kind == "2word":
        return moving("G1 X90. F1200")
    control = PowerMate()
    library, handle = at(control)
    control.signals.give(12, 255 if kind == "byte" else 255 - 173)
    control.signals.state.torque_mode = 4
    control.signals.set_torque_override(1, 153)
    if kind == "2word_axis":
        control.signals.give(12, 155)
        library.cnc_incpoint(handle, 1, 0, 1, 9000, bytes(fwlib.ODBPOS(idata=2, ldata=-61500)))
        control.advance(3000)
    control.signals.give(8, 0)  # emergency stop and feed hold
    control.raise_alarm(417, axis=2)
    return control, library, handle


@pytest.mark.parametrize(
    ("kind", "number", "size", "axis", "length", "value"),
    [pytest.param(*row, marks=pytest.mark.covers(f"fanuc.diag.kind.{row[0]}"), id=row[0]) for row in KINDS],
)
@pytest.mark.covers("fanuc.cnc_diagnoss", "fanuc.diag.bitread", "fanuc.diag.axis.0", "fanuc.diag.axis.1..m")
@pytest.mark.covers("fanuc.cnc_diagnosr", "fanuc.cnc_diagnoss.err.EW_LENGTH")
def test_a_diagnosis_value_of_each_kind(
    kind: str, number: int, size: int, axis: int, length: int, value: int
) -> None:
    _, library, handle = arranged(kind)
    code, diag = library.cnc_diagnoss(handle, number, axis, length)
    assert (code, diag.datano, diag.type) == (0, number, axis)
    member = {1: "cdata", 2: "idata", 4: "ldata"}[size]
    assert getattr(diag.u, member) == value
    assert bytes(diag)[4 + size :] == bytes(28 - 4 - size)
    assert library.cnc_diagnoss(handle, number, axis, length - 1)[0] is EW.EW_LENGTH
    if axis:  # in a range each of six axes has its place
        code, _, _, used, data = library.cnc_diagnosr(handle, number, -1, number, 100)
        assert (code, used) == (0, 4 + 6 * size)
        place = 4 + (axis - 1) * size
        assert int.from_bytes(data[place : place + size], "little", signed=True) == value


@pytest.mark.covers("fanuc.cnc_diagnoss")
@pytest.mark.covers("fanuc.diag.axis.-1")
@pytest.mark.covers("fanuc.ODBDGN.type")
@pytest.mark.covers("fanuc.cnc_diagnoss.err.EW_LENGTH")
@pytest.mark.covers("fanuc.ODBDGN")
@pytest.mark.covers("fanuc.common.ALL_AXES2")
@pytest.mark.covers("fanuc.diag.kind.2word_axis")
def test_all_axes_at_once() -> None:
    control, library, handle = moving()
    control.advance(8000)
    code, diag = library.cnc_diagnoss(handle, 301, -1, 4 + 4 * 3)
    assert (code, diag.type, list(diag.u.ldatas)) == (0, -1, [90000, -45000, 0, 0, 0, 0])
    assert library.cnc_diagnoss(handle, 301, -1, 4 + 4 * 2)[0] is EW.EW_LENGTH
    assert library.cnc_diagnoss(handle, 301, -1, 4 + 4 * 6)[0] is EW.EW_OK


@pytest.mark.covers("fanuc.cnc_diagnoss")
@pytest.mark.parametrize(
    ("number", "axis", "code"),
    refused(
        "cnc_diagnoss",
        (6, 0, "EW_NUMBER"),
        (-1, 0, "EW_NUMBER"),
        (301, 0, "EW_ATTRIB"),
        (301, 7, "EW_ATTRIB"),
        (301, -2, "EW_ATTRIB"),
    ),
)
@pytest.mark.covers("fanuc.diag.axis.0", "fanuc.diag.axis.1..m")
def test_a_diagnosis_is_refused(number: int, axis: int, code: str) -> None:
    library, handle = at(PowerMate())
    assert library.cnc_diagnoss(handle, number, axis, 28)[0] is EW[code]


@pytest.mark.covers("fanuc.cnc_diagnoss", "fanuc.cnc_diagnoss.err.EW_LENGTH")
@pytest.mark.covers("fanuc.concept.length_argument")
def test_a_diagnosis_needs_its_length() -> None:
    library, handle = at(PowerMate())  # with three axes
    for number, axis, size in (
        (4, 0, 1),
        (20, 0, 1),
        (30, 0, 2),
        (31, 0, 4),
        (203, -1, 3),
        (202, -1, 6),
        (301, -1, 12),
    ):
        assert library.cnc_diagnoss(handle, number, axis, 4 + size)[0] is EW.EW_OK
        assert library.cnc_diagnoss(handle, number, axis, 4 + size - 1)[0] is EW.EW_LENGTH


@pytest.mark.parametrize(
    ("number", "axis", "kind", "length"),
    [
        pytest.param(20, 0, 0, 6, marks=pytest.mark.covers("fanuc.diag.type_attr.0")),
        pytest.param(4, 0, 1, 6, marks=pytest.mark.covers("fanuc.diag.type_attr.1")),
        pytest.param(30, 0, 2, 6, marks=pytest.mark.covers("fanuc.diag.type_attr.2")),
        pytest.param(31, 0, 3, 8, marks=pytest.mark.covers("fanuc.diag.type_attr.3")),
        (203, 3, 1, 6),
        (203, -1, 1, 10),
        (202, -1, 2, 16),
        (300, -1, 3, 28),
    ],
)
@pytest.mark.covers("fanuc.diag.padding", "fanuc.cnc_diagnosr")
def test_an_entry_of_a_range(number: int, axis: int, kind: int, length: int) -> None:
    library, handle = at(PowerMate())
    code, first, last, used, data = library.cnc_diagnosr(handle, number, axis, number, 99)
    assert (code, first, last, used) == (0, number, number, length)
    assert data[:4] == number.to_bytes(2, "little") + bytes([axis & 0xFF, kind])
    assert len(data) == length


@pytest.mark.covers("fanuc.cnc_diagnosr")
@pytest.mark.covers("fanuc.diag.padding")
@pytest.mark.covers(
    "fanuc.diag.type_attr.0", "fanuc.diag.type_attr.1", "fanuc.diag.type_attr.2", "fanuc.diag.type_attr.3"
)
def test_a_range_of_diagnosis_numbers() -> None:
    _, library, handle = arranged("byte_axis")
    code, first, last, used, data = library.cnc_diagnosr(handle, 25, -1, 250, 99)
    assert (code, first, last, used) == (0, 30, 203, 6 + 8 + 10 + 10 + 16 + 10)
    numbers = [int.from_bytes(data[k : k + 2], "little") for k in (0, 6, 14, 24, 34, 50)]
    assert numbers == [30, 31, 200, 201, 202, 203]
    assert data[:6] == b"\x1e\0\0\2\xad\0"
    assert [data[k + 3] for k in (0, 6, 14, 24, 34, 50)] == [2, 3, 0, 1, 2, 1]  # the kinds
    assert data[14:24] == b"\xc8\0\xff\0\0\x10\0\0\0\0"
    assert data[34:50] == b"\xca\0\xff\2" + b"\x58\2\xe8\3\xe8\3" + bytes(6)


@pytest.mark.covers("fanuc.cnc_diagnosr")
@pytest.mark.parametrize(
    ("first", "axis", "last", "length", "code"),
    refused(
        "cnc_diagnosr",
        (25, -1, 250, 59, "EW_LENGTH"),
        (30, 0, 31, 13, "EW_LENGTH"),
        (32, 0, 199, 99, "EW_NUMBER"),
        (30, 0, 20, 99, "EW_NUMBER"),
        (-3, 0, 4, 99, "EW_NUMBER"),
        (30, 0, 200, 99, "EW_ATTRIB"),
        (200, 7, 201, 99, "EW_ATTRIB"),
    ),
)
def test_a_range_is_refused(first: int, axis: int, last: int, length: int, code: str) -> None:
    library, handle = at(PowerMate())
    answer = library.cnc_diagnosr(handle, first, axis, last, length)
    assert (answer[0], answer[1:4]) == (EW[code], (first, last, length))
    assert library.cnc_diagnosr(handle, 30, 0, 31, 14)[0] is EW.EW_OK


# ---------------------------------------------------------------------- figures

AXIS = {  # decimals in mm, inch and degree
    "IS-A": (2, 3, 2), "IS-B": (3, 4, 3), "IS-C": (4, 5, 4),
}  # fmt: skip
OFFSET = {"IS-A": (2, 3), "IS-B": (3, 4), "IS-C": (4, 5)}
MACRO = {"IS-A": (3, 4), "IS-B": (3, 4), "IS-C": (4, 5)}


@pytest.mark.covers("fanuc.concept.decimal_point")
@pytest.mark.covers("fanuc.cnc_getfigure", "fanuc.cnc_getfigure.data_type.0", "fanuc.getfigure.valid.axis",
                    "fanuc.param.0000_2", "fanuc.param.1001_0", "fanuc.concept.increment_system")  # fmt: skip
@pytest.mark.parametrize(
    ("system", "mm", "inch", "degree"),
    [
        pytest.param(
            system, *row, id=system,
            marks=pytest.mark.covers(*(f"fanuc.getfigure.dec.axis.{system}.{unit}" for unit in ("mm", "inch", "deg"))),
        )
        for system, row in AXIS.items()
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.param.1004_0", "fanuc.param.1004_1")
def test_figures_of_axes(system: str, mm: int, inch: int, degree: int) -> None:
    for inch_input in (False, True):
        for inch_output in (False, True):
            control = PowerMate(
                increment=system, rotary=(2,), axes=4, inch_input=inch_input, inch_output=inch_output
            )
            library, handle = at(control)
            code, digits, read, shown = library.cnc_getfigure(handle, 0)
            entered, moved = inch if inch_input else mm, inch if inch_output else mm
            assert (code, digits) == (0, 8)
            assert read == [entered, degree, entered, entered, 0, 0]
            assert shown == [moved, degree, moved, moved, 0, 0]


@pytest.mark.parametrize(
    ("kind", "digits", "system", "mm", "inch"),
    [
        pytest.param(
            kind, digits, system, *row, id=f"{name}-{system}",
            marks=pytest.mark.covers(
                f"fanuc.getfigure.dec.{name}.{system}.mm", f"fanuc.getfigure.dec.{name}.{system}.inch",
                f"fanuc.getfigure.valid.{name}", f"fanuc.cnc_getfigure.data_type.{kind}"),
        )
        for kind, digits, name, table in ((1, 7, "tool_offset", OFFSET), (2, 8, "macro", MACRO))
        for system, row in table.items()
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_getfigure")
@pytest.mark.covers(
    "fanuc.concept.decimal_point",
    "fanuc.param.1004_0",
    "fanuc.param.1004_1",
    "fanuc.concept.increment_system",
)
@pytest.mark.covers("fanuc.units.IS_A", "fanuc.units.IS_B", "fanuc.units.IS_C")
def test_figures_of_tool_offsets_and_macro_variables(
    kind: int, digits: int, system: str, mm: int, inch: int
) -> None:
    for inch_input, decimals in ((False, mm), (True, inch)):
        library, handle = at(PowerMate(increment=system, inch_input=inch_input, rotary=(1,)))
        code, valid, read, _ = library.cnc_getfigure(handle, kind)
        assert (code, valid, read[0]) == (0, digits, decimals)


@pytest.mark.covers("fanuc.cnc_getfigure")
@pytest.mark.covers("fanuc.param.1004_0", "fanuc.param.1004_1", "fanuc.cnc_getfigure.err.EW_ATTRIB")
@pytest.mark.covers(
    "fanuc.concept.decimal_point",
    "fanuc.ncparam.1004_0",
    "fanuc.ncparam.1004_1",
    "fanuc.concept.increment_system",
)
def test_the_increment_system_is_a_parameter() -> None:
    control = PowerMate()
    library, handle = at(control)
    for bits, decimals in ((1, 2), (2, 4), (0, 3), (0x80 | 2, 4), (0x40 | 1, 2), (0xFC, 3)):
        control.parameters.set(1004, bits)
        control.power_cycle()
        assert library.cnc_getfigure(handle, 0)[2][0] == decimals
    assert library.cnc_getfigure(handle, 3)[0] is EW.EW_ATTRIB
    assert library.cnc_getfigure(handle, -1)[0] is EW.EW_ATTRIB


# ---------------------------------------------------------------------- servo values


@pytest.mark.covers("fanuc.cnc_rdcurrent", "fanuc.param.2086", "fanuc.cnc_rdsrvspeed", "fanuc.cnc_rdloopgain")
def test_servo_values_of_a_moving_machine() -> None:
    control, library, handle = moving("G0 X90. Y-45.")
    code, speed = library.cnc_rdsrvspeed(handle)
    assert (code, speed) == (0, [15000, -7500, 0, 0, 0, 0])
    code, current = library.cnc_rdcurrent(handle)
    assert (code, current) == (0, [1782, -891, 0, 0, 0, 0])
    control.parameters.set(2086, 0, 1)
    control.parameters.set(1825, 4500, 2)
    assert library.cnc_rdcurrent(handle)[1] == [0, -891, 0, 0, 0, 0]
    assert library.cnc_rdloopgain(handle) == (EW.EW_OK, [3000, 4500, 3000, 0, 0, 0])
    control.advance(3000)
    assert library.cnc_rdsrvspeed(handle)[1] == library.cnc_rdcurrent(handle)[1] == [0] * 6


# ---------------------------------------------------------------------- messages


@pytest.mark.covers(
    "fanuc.cnc_rdopmsg", "fanuc.example.cnc_rdopmsg", "fanuc.OPMSG.datano.-1", "fanuc.OPMSG.datano.range",
    "fanuc.cnc_rdopmsg.type.0", "fanuc.OPMSG.type.0",
)  # fmt: skip
@pytest.mark.covers("fanuc.OPMSG.datano", "fanuc.OPMSG.type", "fanuc.OPMSG.char_num", "fanuc.OPMSG.data")
@pytest.mark.covers("fanuc.OPMSG")
@pytest.mark.covers("fanuc.OPMSG", "fanuc.OPMSG.char_num", "fanuc.OPMSG.data", "fanuc.MSG_SIZE")
def test_the_manuals_program_prints_the_message() -> None:
    control = PowerMate()
    library, handle = at(control)

    def printed() -> str:
        code, buf = library.cnc_rdopmsg(handle, 0, 6 + 256)
        assert (code, buf.type, buf.char_num) == (0, 0, len(buf.data))
        return "No operator message." if buf.datano == -1 else f"{buf.datano:04d} {buf.data.decode()}"

    seen = [printed()]
    for number in (99, 1000, 1999, 2100):
        control.operator_message(number, "NOT ONE OF THESE")
    seen.append(printed())
    control.operator_message(2099, "LUBRICANT LOW")
    seen.append(printed())
    control.control.messages.withdraw(2099)
    control.operator_message(100, "X" * 255)
    seen.append(printed())
    assert seen == ["No operator message.", "No operator message.", "2099 LUBRICANT LOW", "0100 " + "X" * 255]
    assert library.cnc_rdopmsg(handle, 0, 262)[1].char_num == 255
    control.operator_message(999, "AND ANOTHER")
    code, count, messages = library.cnc_rdopmsg3(handle, -1, 5)
    assert (code, count, [each.datano for each in messages]) == (0, 2, [100, 999])
    assert printed()[:4] == "0100"  # the first one


@pytest.mark.covers("fanuc.cnc_rdopmsg")
@pytest.mark.parametrize(
    ("kind", "length", "options", "code"),
    [
        *refused(
            "cnc_rdopmsg",
            (0, 261, True, "EW_LENGTH"),
            (1, 262, True, "EW_ATTRIB"),
            (-1, 262, True, "EW_ATTRIB"),
            (0, 262, False, "EW_NOOPT"),
        ),
        pytest.param(0, 262, ("external_data_input",), "EW_NOOPT",
                     marks=pytest.mark.covers("fanuc.option.external_message")),
        pytest.param(0, 262, ("external_message",), "EW_NOOPT",
                     marks=pytest.mark.covers("fanuc.option.external_data_input")),
        (0, 262, ("external_message", "external_data_input"), "EW_OK"),
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.common.allmode")
def test_messages_are_refused(kind: int, length: int, options: Any, code: str) -> None:
    control = PowerMate(options=options)
    control.operator_message(2001, "DOOR")
    library, handle = at(control)
    assert library.cnc_rdopmsg(handle, kind, length)[0] is EW[code]


@pytest.mark.covers("fanuc.diag.kind.byte", "fanuc.diag.kind.byte_axis")
@pytest.mark.covers("fanuc.diag.axis.1..m")
@pytest.mark.covers("fanuc.cnc_diagnoss")
def test_what_moves_is_told_of_each_axis() -> None:
    control, library, handle = moving("G1 X90. Y-45. F1200\nG4 X3.\nM30")

    def told(number: int, *axes: int) -> list[int]:
        return [library.cnc_diagnoss(handle, number, axis, 8)[1].u.ldata for axis in axes]

    assert [told(number, 0) for number in (1, 2)] == [[1], [0]]
    assert told(201, 1, 2, 3) == [1, 1, 0]
    control.advance(6000)
    assert [told(number, 0) for number in (1, 2)] == [[0], [1]]
    assert told(201, 1, 2, 3) == [0, 0, 0]


@pytest.mark.covers("fanuc.cnc_diagnoss")
@pytest.mark.covers("fanuc.diag.kind.bit", "fanuc.diag.kind.byte_axis")
def test_what_moves_by_hand_and_what_stops_is_told() -> None:
    control = PowerMate()
    library, handle = at(control)
    assert [library.cnc_diagnoss(handle, 203, axis, 5)[1].u.cdata for axis in (1, 2, 3)] == [0, 0, 0]
    control.select_mode("JOG")
    control.signals.give(100, 0b010)
    control.signals.give(102, 0b100)
    control.advance(200)
    assert [library.cnc_diagnoss(handle, 201, axis, 5)[1].u.cdata for axis in (1, 2, 3)] == [0, 2, 2]
    control.signals.give(100, 0)
    control.advance(500)
    assert [library.cnc_diagnoss(handle, 201, axis, 5)[1].u.cdata for axis in (1, 2, 3)] == [0, 0, 2]
    for given, shown in ((0x30, 0x00), (0xB0, 0x04), (0x20, 0x08), (0x10, 0x20)):
        control.signals.give(8, given)
        assert library.cnc_diagnoss(handle, 20, 0, 5)[1].u.cdata & 0xFF == shown
    control.signals.give(8, 0x30)
    control.raise_alarm(411, axis=3)
    assert [library.cnc_diagnoss(handle, 200, axis, 5)[1].u.cdata for axis in (1, 2, 3)] == [0, 0, 0x08]
    assert [control.signals.f(address) for address in (94, 120)] == [0b001, 0b111]
