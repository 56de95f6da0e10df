"""A call that a card cannot be given is refused with the right status, and nothing reaches the card."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.imc import Card, parse_card
from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.core._instructions import Points as Displacements
from polycnc.controllers.imc.core._instructions import Write, WriteMany
from polycnc.controllers.imc.core._parameters import PARAMETERS
from support.imc_calls import PATHS, SENDERS, WAITERS, fast, functions, line, many
from support.imc_network import ToldCard, opened

I, Q, P1, P2, C = range(5)  # noqa: E741


@pytest.fixture
def card() -> ToldCard:
    return ToldCard(axes=4)


@pytest.fixture
def handle(card: ToldCard) -> Iterator[lib.IMC_HANDLE]:
    yield opened(card, clock=None)
    lib.detach()


@pytest.mark.covers(*functions(SENDERS, WAITERS, PATHS), "imc.status.IMC_INVALID_FIFO", "imc.enum.FIFO_SEL")
@pytest.mark.covers(
    "imc.fifo.SEL_IFIFO",
    "imc.fifo.SEL_QFIFO",
    "imc.fifo.SEL_PFIFO1",
    "imc.fifo.SEL_PFIFO2",
    "imc.fifo.SEL_CFIFO",
    *(f"imc.concept.{name}" for name in ("instruction_fifos", "ififo", "qfifo", "pfifo1", "pfifo2", "cfifo")),
)
@pytest.mark.parametrize(
    ("calls", "accepted"), [(SENDERS, {I, Q, P1, P2}), (WAITERS, {Q, P1, P2}), (PATHS, {P1, P2})]
)
def test_queues_that_take_an_instruction(
    card: ToldCard, handle: lib.IMC_HANDLE, calls: dict[str, tuple[Any, ...]], accepted: set[int]
) -> None:
    for name, arguments in calls.items():
        for fifo in (-1, *range(6)):
            card.told.clear()
            status = getattr(lib, name)(handle, *arguments, fifo)
            assert status == (lib.IMC_OK if fifo in accepted else lib.IMC_INVALID_FIFO), (name, fifo)
            assert [each[0] for each in card.told] == ([fifo] if fifo in accepted else [])
    assert len(SENDERS) + len(WAITERS) + len(PATHS) == 40


@pytest.mark.covers("imc.IMC_ClearFIFO", "imc.IMC_AddContourData", "imc.concept.cfifo", "imc.enum.FIFO_SEL")
@pytest.mark.covers(*(f"imc.fifo.SEL_{name}" for name in ("IFIFO", "QFIFO", "PFIFO1", "PFIFO2", "CFIFO")))
def test_contour_points_go_to_queues_of_points_only(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    for fifo in (-1, I, Q, 5):
        assert lib.IMC_PutContourData(handle, [1, 2], 2, fifo) == lib.IMC_INVALID_FIFO
        assert card.points == []
    assert lib.IMC_PutContourData(handle, [1, 2], 2, C) == lib.IMC_OK
    for fifo in (-1, 5):
        assert lib.IMC_ClearFIFO(handle, fifo) == lib.IMC_INVALID_FIFO
    for fifo in range(5):
        assert lib.IMC_ClearFIFO(handle, fifo) == lib.IMC_OK
    assert card.cleared == list(range(5))


@pytest.mark.covers("imc.status.IMC_FIFO_FULL", *functions(SENDERS, WAITERS, PATHS))
@pytest.mark.covers(
    "imc.IMC_AddContourData",
)
def test_a_full_queue_refuses_and_nothing_is_sent_again(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    card.full = True
    for name, arguments in {**SENDERS, **WAITERS, **PATHS}.items():
        assert getattr(lib, name)(handle, *arguments, P1) == lib.IMC_FIFO_FULL, name
    assert lib.IMC_PutContourData(handle, [1], 1, C) == lib.IMC_FIFO_FULL
    card.full = False
    assert (card.told, card.points) == ([], [])


AXIS_LAST = sorted(set(SENDERS) - {"IMC_SetMulParam", "IMC_InstallEvent"})


@pytest.mark.covers("imc.status.IMC_INVALID_AXIS")
@pytest.mark.covers("imc.IMC_GetCapData", "imc.IMC_GetParamBit")
@pytest.mark.covers("imc.const.AXISNUM", *functions(AXIS_LAST))
@pytest.mark.covers("imc.IMC_GetParam16", "imc.IMC_GetParam48")
def test_axes_that_the_card_does_not_have(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    for name in AXIS_LAST:
        for axis in (-1, 4):
            arguments = (*SENDERS[name][:-1], axis)
            assert getattr(lib, name)(handle, *arguments, Q) == lib.IMC_INVALID_AXIS, name
    for name in ("IMC_GetParam16", "IMC_GetParam32", "IMC_GetParam48"):
        assert getattr(lib, name)(handle, 218, 4) == (lib.IMC_INVALID_AXIS, 0)
    assert lib.IMC_GetParamBit(handle, 562, 0, 4) == (lib.IMC_INVALID_AXIS, 0)
    assert lib.IMC_GetCapData(handle, 1, 4) == (lib.IMC_INVALID_AXIS, [], 0, 0)
    assert lib.IMC_WaitParam(handle, 218, 0, 0, 4, Q) == lib.IMC_INVALID_AXIS
    for name, place in (
        ("IMC_GearFree", 1),
        ("IMC_GearInDist", 1),
        ("IMC_GearInDist", 3),
        ("IMC_GearInTime", 1),
        ("IMC_HandWheel", 1),
        ("IMC_MoveInDist", 1),
        ("IMC_TgvelInDist", 1),
    ):
        for axis in (-1, 4):
            arguments = (*SENDERS[name][:place], axis, *SENDERS[name][place + 1 :])
            assert getattr(lib, name)(handle, *arguments, Q) == lib.IMC_OUT_OF_RANGE, name
    assert card.told == []


@pytest.mark.covers("imc.IMC_GetParam32", "imc.IMC_SetParam16")
@pytest.mark.covers("imc.param.emstop")
def test_the_axis_of_a_parameter_of_the_card_does_not_matter(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    assert lib.IMC_SetParam16(handle, lib.emstopLoc, 0x10, 99, I) == lib.IMC_OK
    assert lib.IMC_GetParam32(handle, lib.ticksLoc, -1)[0] == lib.IMC_OK
    assert lib.IMC_WaitParam(handle, lib.user32b0Loc, 0, 0, 99, P1) == lib.IMC_OK
    assert len(card.told) == 2


@pytest.mark.covers("imc.status.IMC_INVALID_PARAM")
@pytest.mark.covers(
    "imc.IMC_GetParam16",
    "imc.IMC_GetParam32",
    "imc.IMC_GetParamBit",
    "imc.IMC_SetParam16",
    "imc.IMC_TurnParamBit",
)
@pytest.mark.covers(
    "imc.IMC_WaitParam",
)
def test_addresses_without_a_parameter(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    for at in (-1, 0, 3, 9, 24, 900, 1024, 40000):
        assert lib.IMC_SetParam16(handle, at, 1, 0, I) == lib.IMC_INVALID_PARAM, at
        assert lib.IMC_GetParam32(handle, at, 0) == (lib.IMC_INVALID_PARAM, 0)
        assert lib.IMC_GetParamBit(handle, at, 0, 0) == (lib.IMC_INVALID_PARAM, 0)
        assert lib.IMC_TurnParamBit(handle, at, 0, 0, I) == lib.IMC_INVALID_PARAM
        assert lib.IMC_WaitParam(handle, at, 0, 0, 0, Q) == lib.IMC_INVALID_PARAM
    assert lib.IMC_GetParam16(handle, lib.mcsposLoc + 1, 0)[0] == lib.IMC_OK  # the high word of a position
    assert card.told == []


@pytest.mark.covers("imc.status.IMC_PARAM_READ_ONLY")
@pytest.mark.covers("imc.IMC_GetParam16")
@pytest.mark.parametrize("name", ["mcsmoving", "curpos", "naxis", "fwversion", "gin1", "poserr"])
@pytest.mark.covers(
    "imc.IMC_SetParam16",
    "imc.IMC_TurnParamBit",
)
@pytest.mark.covers(
    *(f"imc.IMC_{name}" for name in ("SetParam16", "SetParam32", "SetParam48", "SetParamBit", "ORXORParam")),
    *(f"imc.IMC_{name}" for name in ("TurnParamBit", "SetMulParam", "InstallEvent", "GetParam16")),
)
def test_parameters_that_cannot_be_written(card: ToldCard, handle: lib.IMC_HANDLE, name: str) -> None:
    at = PARAMETERS[name].address
    for refused in (
        lib.IMC_SetParam16(handle, at, 1, 0, I),
        lib.IMC_SetParam32(handle, at, 1, 0, I),
        lib.IMC_SetParam48(handle, at, 1, 0, I),
        lib.IMC_SetParamBit(handle, at, 0, 1, 0, I),
        lib.IMC_ORXORParam(handle, at, 1, 0, 0, I),
        lib.IMC_TurnParamBit(handle, at, 0, 0, I),
        lib.IMC_SetMulParam(handle, many((12, 0, 2), (at, 0, 1)), 2, I),
        lib.IMC_InstallEvent(handle, [lib.EventInfo.of(lib.CMD_SET16, dest=(at, 0))], 1, I),
    ):
        assert refused == lib.IMC_PARAM_READ_ONLY
    assert lib.IMC_GetParam16(handle, at, 0)[0] == lib.IMC_OK
    assert card.told == []


bit, out = lib.IMC_INVALID_PARAM, lib.IMC_OUT_OF_RANGE
event = lib.EventInfo.of(lib.CMD_SET16, src2=1, dest=(307, 0))
nan = float("nan")
REFUSED: list[tuple[lib.IMC_STATUS, str, tuple[Any, ...]]] = [
    (bit, "IMC_SetParamBit", (562, 16, 1, 0, I)),
    (bit, "IMC_SetParamBit", (562, -1, 1, 0, I)),
    (out, "IMC_SetParamBit", (562, 0, 2, 0, I)),
    (bit, "IMC_TurnParamBit", (562, 16, 0, I)),
    (bit, "IMC_WaitParamBit", (562, 16, 1, 0, 0, Q)),
    (out, "IMC_WaitParamBit", (562, 0, -1, 0, 0, Q)),
    (out, "IMC_SetParam16", (12, 1 << 16, 0, I)),
    (out, "IMC_SetParam32", (12, -(1 << 31) - 1, 0, I)),
    (out, "IMC_SetParam48", (175, 1 << 48, 0, I)),
    (out, "IMC_SetMulParam", (many((12, 0, 1)), 0, I)),
    (out, "IMC_SetMulParam", (many((12, 0, 1)), 2, I)),
    (out, "IMC_SetMulParam", (many((12, 0, 4)), 1, I)),
    (out, "IMC_SetMulParam", (many((12, 0, 0)), 1, I)),
    (lib.IMC_INVALID_AXIS, "IMC_SetMulParam", (many((12, 0, 1), (12, 4, 1)), 2, I)),
    (bit, "IMC_SetMulParam", (many((12, 0, 1), (9, 0, 1)), 2, I)),
    (bit, "IMC_SetMulParam", (None, 1, I)),
    (out, "IMC_GetMulParam", (many((12, 0, 1)), 0)),
    (out, "IMC_GetMulParam", (many(*[(12, 0, 1)] * 33), 33)),
    (out, "IMC_InstallEvent", ([event] * 40, 0, I)),
    (out, "IMC_InstallEvent", ([event] * 40, 32, I)),
    (out, "IMC_InstallEvent", ([event], 2, I)),
    (out, "IMC_AddLineN", (line(0), P1)),
    (out, "IMC_AddLineN", (line(5), P1)),
    (out, "IMC_AddLineNWithVel", (fast(17), P1)),
    (out, "IMC_AddArcLine", (line(1), P1)),
    (out, "IMC_AddArc", (0, 0, 1, 1, 2, P1)),
    (out, "IMC_AddSpiral", (0, 0, 0, 1, 1, -1, P1)),
    (bit, "IMC_AddLineN", (None, P1)),
    (out, "IMC_PutContourData", ([0] * 127, 127, C)),
    (out, "IMC_PutContourData", ([0], 0, C)),
    (out, "IMC_PutContourData", ([0], 2, C)),
    (out, "IMC_PutContourData", ([32768], 1, C)),
    (out, "IMC_GearFree", (32768.0, 1, 0, 0, I)),
    (out, "IMC_GearFree", (-32768.1, 1, 0, 0, I)),
    (out, "IMC_GearFree", (nan, 1, 0, 0, I)),
    (out, "IMC_GearFree", (1.0, 1, 5, 0, I)),
    (out, "IMC_GearInDist", (1.0, 1, 0, 1, 5, 1000, 0, I)),
    (out, "IMC_GearInDist", (1e300, 1, 0, 1, 2, 1000, 0, I)),
    (out, "IMC_GearInDist", (-1e300, 1, 0, 1, 2, 1000, 0, I)),
    (out, "IMC_GearInDist", (10**400, 1, 0, 1, 2, 1000, 0, I)),
    (out, "IMC_GearInDist", (1.0, 1, 0, 1, 0, 0, 0, I)),
    (out, "IMC_GearInTime", (1.0, 1, -1, 1000, 0, I)),
    (out, "IMC_HandWheel", (float("inf"), 1, 0, I)),
    (out, "IMC_MoveInTime", (0, 100, 0, I)),
    (out, "IMC_MoveInDist", (-5, 1, 100, 0, I)),
    (out, "IMC_TgvelInTime", (0, 65536, 0, I)),
    (out, "IMC_TgvelInDist", (0, 1, 65536, 0, I)),
]


@pytest.mark.covers(*functions(name for _, name, _ in REFUSED))
@pytest.mark.covers("imc.status.IMC_OUT_OF_RANGE")
@pytest.mark.covers("imc.IMC_GetCapData")
@pytest.mark.covers("imc.const.limits")
def test_numbers_out_of_range(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    for status, name, arguments in REFUSED:
        assert getattr(lib, name)(handle, *arguments) == status, (name, arguments)
    for rdnum in (-1, 121):
        assert lib.IMC_GetCapData(handle, rdnum, 0) == (out, [], 0, 0)
    assert (card.told, card.points) == ([], [])


@pytest.mark.covers("imc.IMC_AddLineN", "imc.IMC_GetMulParam", "imc.IMC_SetParam16", "imc.IMC_SetParamBit")
@pytest.mark.covers(
    "imc.const.limits", "imc.IMC_GetCapData", "imc.IMC_AddContourData", "imc.IMC_InstallEvent"
)
@pytest.mark.covers("imc.type.IMCFLOAT", "imc.IMC_GearFree")
def test_the_largest_that_is_taken(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    event = lib.EventInfo.of(lib.CMD_SET16, src2=1, dest=(307, 0))
    assert lib.IMC_GetMulParam(handle, many(*[(12, 0, 3)] * 32), 32) == lib.IMC_OK
    assert lib.IMC_InstallEvent(handle, [event] * 31, 31, I) == lib.IMC_OK
    points = [(-1) ** k * 32767 - k % 2 for k in range(126)]
    assert lib.IMC_PutContourData(handle, points, 126, C) == lib.IMC_OK
    assert card.points == points
    assert lib.IMC_GetCapData(handle, 120, 0) == (lib.IMC_OK, [], 0, 0)
    assert lib.IMC_AddLineN(handle, line(4), P1) == lib.IMC_OK
    assert lib.IMC_GearFree(handle, 32767.999999999767, 3, 4, 0, I) == lib.IMC_OK
    assert lib.IMC_SetParam16(handle, 12, 0xFFFF, 3, I) == lib.IMC_OK
    assert lib.IMC_SetParamBit(handle, 562, 15, 1, 3, I) == lib.IMC_OK


@pytest.mark.covers("imc.IMC_SetParam16", "imc.IMC_SetParam32", "imc.IMC_SetParam48", "imc.IMC_WaitParamMask")
@pytest.mark.covers("imc.type.IMC16", "imc.type.IMC32", "imc.type.__int64", "imc.status.IMC_OUT_OF_RANGE")
def test_a_number_may_have_a_sign_or_not_within_its_width(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    for name, at, bits in (("SetParam16", 307, 16), ("SetParam32", 317, 32), ("SetParam48", 337, 48)):
        least, most = -(1 << bits - 1), (1 << bits) - 1
        for value, status in ((least, 0), (most, 0), (1 << bits - 1, 0), (least - 1, 13), (most + 1, 13)):
            assert getattr(lib, f"IMC_{name}")(handle, at, value, 0, Q) == status, (name, value)
    assert lib.IMC_WaitParamMask(handle, 307, 0xFFFF, -0x8000, 0xFFFFFFFF, 0, Q) == lib.IMC_OK
    for given in ((0x10000, 1, 1), (1, -0x8001, 1), (1, 1, 1 << 32)):
        assert lib.IMC_WaitParamMask(handle, 307, *given, 0, Q) == lib.IMC_OUT_OF_RANGE
    assert len(card.told) == 10


@pytest.mark.covers("imc.param.groupnum", "imc.IMC_AddContourData", "imc.concept.cfifo")
def test_contour_data_are_whole_points(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    card.memory[lib.groupnumLoc, 0] = 3
    assert lib.IMC_PutContourData(handle, list(range(30)), 30, C) == lib.IMC_OK
    assert lib.IMC_PutContourData(handle, list(range(30)), 29, C) == lib.IMC_OUT_OF_RANGE
    assert card.points == list(range(30))


@pytest.mark.covers("imc.IMC_InstallEvent")
def test_events_that_do_not_fit_any_more(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    event = lib.EventInfo.of(lib.CMD_SET16, src2=1, dest=(307, 0))
    card.room_for_events = 3
    assert lib.IMC_InstallEvent(handle, [event] * 4, 4, I) == lib.IMC_OUT_OF_RANGE
    assert lib.IMC_InstallEvent(handle, [event] * 3, 3, I) == lib.IMC_OK


@pytest.mark.covers("imc.IMC_InstallEvent")
@pytest.mark.parametrize(
    ("event", "status"),
    [
        (lib.EventInfo(EventCMD=34), lib.IMC_OUT_OF_RANGE),
        (lib.EventInfo(EventCMD=-1), lib.IMC_OUT_OF_RANGE),
        (lib.EventInfo(EventType=15), lib.IMC_OUT_OF_RANGE),
        (lib.EventInfo.of(lib.CMD_ADD32, src1=(9, 0), src2=(225, 0)), lib.IMC_INVALID_PARAM),
        (lib.EventInfo.of(lib.CMD_ADD32, src1=(225, 0), src2=(225, 4)), lib.IMC_INVALID_AXIS),
        (lib.EventInfo.of(lib.CMD_CMP32i, src1=(225, 4)), lib.IMC_INVALID_AXIS),
        (lib.EventInfo.of(lib.CMD_SET16, src2=1), lib.IMC_INVALID_PARAM),  # nowhere to put it
        (lib.EventInfo.of(lib.CMD_COP32, src2=(317, 0)), lib.IMC_INVALID_PARAM),
        (lib.EventInfo.of(lib.CMD_SET16, dest=(12, 7)), lib.IMC_INVALID_AXIS),
    ],
)
def test_events_that_mean_nothing(
    card: ToldCard, handle: lib.IMC_HANDLE, event: lib.EventInfo, status: lib.IMC_STATUS
) -> None:
    good = lib.EventInfo.of(lib.CMD_CMP32i, src1=(225, 3), src2=5)
    assert lib.IMC_InstallEvent(handle, [good, event], 2, I) == status
    assert card.told == []


@pytest.mark.covers(*(f"imc.event.{command.name}" for command in lib.IMC_EVENT_CMD), "imc.struct.EventInfo")
@pytest.mark.covers("imc.IMC_InstallEvent")
def test_a_copy_and_a_constant_need_a_place_and_a_result_does_not(
    card: ToldCard, handle: lib.IMC_HANDLE
) -> None:
    for command in lib.IMC_EVENT_CMD:
        name = command.name.removeprefix("CMD_")
        constant = "i" in name or name.startswith("SET")
        event = lib.EventInfo.of(command, src1=(337, 0), src2=5 if constant else (340, 0))
        status = lib.IMC_INVALID_PARAM if name[:3] in ("COP", "SET") else lib.IMC_OK
        assert lib.IMC_InstallEvent(handle, [event], 1, I) == status, name
        event.dest_loc, event.dest_axis = 337, 3
        assert lib.IMC_InstallEvent(handle, [event], 1, I) == lib.IMC_OK, name
    assert len(card.told) == 2 * 34 - 6


@pytest.mark.covers("imc.IMC_GetMulParam")
def test_a_refused_read_leaves_its_structures_alone(handle: lib.IMC_HANDLE) -> None:
    elements = many((12, 0, 2), (9, 0, 2))
    elements[0].data[0] = 77
    assert lib.IMC_GetMulParam(handle, elements, 2) == lib.IMC_INVALID_PARAM
    assert elements[0].data[0] == 77


@pytest.mark.covers(
    "imc.param.groupnum", "imc.param.pathaxisnum1", "imc.param.pathaxisnum2", "imc.IMC_AddContourData"
)
def test_points_for_a_path_queue_are_an_instruction_of_whole_points(
    card: ToldCard, handle: lib.IMC_HANDLE
) -> None:
    card.memory[lib.groupnumLoc, 0] = 3
    card.memory[lib.pathaxisnum1Loc, 0] = 2
    card.memory[lib.pathaxisnum2Loc, 0] = 5
    values: list[Any] = [1.9, -2.9, 3, 4]
    assert lib.IMC_PutContourData(handle, values, 4, P1) == lib.IMC_OK
    assert lib.IMC_PutContourData(handle, [1, 2, 3, 4, 5], 5, P1) == lib.IMC_OUT_OF_RANGE
    assert lib.IMC_PutContourData(handle, [1, 2, 3, 4, 5], 5, P2) == lib.IMC_OK
    assert card.told == [(P1, Displacements((1, -2, 3, 4))), (P2, Displacements((1, 2, 3, 4, 5)))]
    assert card.points == []


@pytest.mark.covers("imc.IMC_SetMulParam")
@pytest.mark.covers("imc.IMC_AddContourData", "imc.IMC_InstallEvent")
def test_what_a_queue_never_holds_is_out_of_range_and_not_a_full_queue() -> None:
    card = Card(parse_card("ready = true\n[depths]\nififo = 64\nqfifo = 64\npfifo1 = 64\ncfifo = 100\n"))
    handle = opened(card)
    writes = many(*((lib.user32b0Loc, 0, 2),) * 17)
    for fifo in (I, Q, P1):
        assert lib.IMC_SetMulParam(handle, writes, 17, fifo) == lib.IMC_OUT_OF_RANGE
        assert lib.IMC_SetMulParam(handle, writes, 16, fifo) == lib.IMC_OK
    assert lib.IMC_SetMulParam(handle, writes, 17, P2) == lib.IMC_OK
    events = [lib.EventInfo() for _ in range(31)]
    for each in events:
        each.EventCMD, each.Src1_loc = 5, lib.curposLoc  # CMP32i
    assert lib.IMC_InstallEvent(handle, events, 31, I) == lib.IMC_OUT_OF_RANGE
    assert lib.IMC_PutContourData(handle, [5] * 101, 101, C) == lib.IMC_OUT_OF_RANGE
    assert lib.IMC_PutContourData(handle, [5] * 64, 64, P1) == lib.IMC_OUT_OF_RANGE
    assert card.waiting_words(4) == 0
    lib.detach()


@pytest.mark.covers("imc.file.paramdef_h")
def test_a_star_import_brings_functions_codes_and_addresses() -> None:
    names: dict[str, Any] = {}
    exec("from polycnc.controllers.imc.imclib import *", names)
    assert names["mcstgposLoc"] == 12
    assert names["gohomeLoc"] == 152
    assert names["startgroup"] == 256
    assert names["IMC_MoveAbsolute"] is lib.IMC_MoveAbsolute
    assert {name for name in dir(lib) if name.endswith("Loc")} <= set(names)


@pytest.mark.covers("imc.IMC_SetParam32")
@pytest.mark.covers("imc.param.mcstgpos", "imc.IMC_MoveVelocity")
def test_floats_are_converted_where_c_converts_them(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    position: Any = -1234.9
    velocity: Any = 2.5 * 65536
    assert lib.IMC_SetParam32(handle, lib.mcstgposLoc, position, 2, Q) == lib.IMC_OK
    assert lib.IMC_MoveVelocity(handle, velocity, 1, Q) == lib.IMC_OK
    assert card.told == [(Q, Write(12, -1234, 2, 2)), (Q, WriteMany((Write(6, 163840, 1, 2),)))]
