"""What the functions send: instructions, and the parameters that the functions of motion are made of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.core._event_codes import EventCommand, EventType
from polycnc.controllers.imc.core._instructions import (
    ChangeBits,
    Event,
    InstallEvents,
    Segment,
    WaitParam,
    WaitTime,
    Write,
    WriteMany,
)
from polycnc.controllers.imc.core._parameters import PARAMETERS
from polycnc.controllers.imc.library._expansions import EXPANSIONS
from support.imc_network import ToldCard, opened


@pytest.fixture
def card() -> ToldCard:
    return ToldCard(axes=4)


@pytest.fixture
def handle(card: ToldCard) -> Iterator[lib.IMC_HANDLE]:
    yield opened(card, clock=None)
    lib.detach()


def named(writes: WriteMany) -> dict[str, int]:
    """Return writes by parameter; all are for axis 2, in the width of the parameter."""
    table = {each.address: each for each in reversed(PARAMETERS.values())}
    for each in writes.writes:
        assert (each.axis, each.words) == (2, table[each.address].words)
    return {table[each.address].name: each.value for each in writes.writes}


SYNC = {"synsrc": 502, "synaxis": 0}
CASES: dict[str, tuple[tuple[Any, ...], dict[str, int]]] = {
    "IMC_MoveAbsolute": ((-1906250003,), {"mcsdist": 0, "mcstgpos": -1906250003, "mcsgo": -1}),
    "IMC_MoveRelative": ((-1850000001,), {"mcsdist": -1850000001, "mcsgo": -1}),
    "IMC_MoveSuperimposed": ((-1530000007,), {"pcsdist": -1530000007, "pcsgo": -1}),
    "IMC_Phasing": ((1730000009,), {"pcsdist": 1730000009, "pcsgo": -1}),
    "IMC_MoveVelocity": ((-30000 * 65536 - 13,), {"mcstgvel": -1966080013}),
    "IMC_HomeSwitch1": ((0, 7, 0), {"homeseq": 0x14, "gohome": -1}),
    "IMC_HomeSwitch2": ((1, 0, -3), {"homeseq": 0x27, "gohome": -1}),
    "IMC_HomeSwitch3": ((1, 0, 256), {"homeseq": 0x47, "gohome": -1}),
    "IMC_HomeSwitchIndex1": ((1, -2, 0), {"homeseq": 0x1D, "gohome": -1}),
    "IMC_HomeSwitchIndex2": ((0, 0, 1), {"homeseq": 0x2E, "gohome": -1}),
    "IMC_HomeSwitchIndex3": ((1, 256, 2), {"homeseq": 0x5F, "gohome": -1}),
    "IMC_HomeIndex": ((1, 32767), {"homeseq": 0x0B, "gohome": -1}),
    "IMC_GearFree": (
        (0.5, 1, 2),
        {"master": 1, "gearsrc": 4, "gearratio": 1 << 31, "syntype": 0, "enasyn": 0, "engear": -1},
    ),
    "IMC_GearInDist": (
        (-1.5, 1, 1, 3, 4, 1000000007),
        {
            "master": 1,
            "gearsrc": 75,
            "gearratio": -(3 << 31),
            "syntype": 0,
            "synsrc": 86,
            "synaxis": 3,
            "synsrcvar": 1000000007,
            "enasyn": -1,
            "engear": -1,
        },
    ),
    "IMC_GearInTime": (
        (-30000.25, 3, 3, 2000000011),
        {
            "master": 3,
            "gearsrc": 27,
            "gearratio": -(120001 << 30),
            "syntype": 0,
            **SYNC,
            "synsrcvar": 2000000011,
            "enasyn": -1,
            "engear": -1,
        },
    ),
    "IMC_HandWheel": (
        (10.0, 3),
        {"master": 3, "gearsrc": 83, "gearratio": 10 << 32, "syntype": 0, "enasyn": 0, "engear": -1},
    ),
    "IMC_MoveInTime": (
        (1000000003, -1500000005),
        {
            "syntype": -1,
            **SYNC,
            "synsrcvar": 1000000003,
            "slavedist": -1500000005,
            "slaveabs": 0,
            "enasyn": -1,
        },
    ),
    "IMC_MoveInDist": (
        (2000000017, 1, -1500000007),
        {
            "syntype": -1,
            "synsrc": 225,
            "synaxis": 1,
            "synsrcvar": 2000000017,
            "slavedist": -1500000007,
            "slaveabs": 0,
        },
    ),
    "IMC_TgvelInTime": (
        (1500000019, -1966080013),
        {"syntype": 0, **SYNC, "synsrcvar": 1500000019, "mcstgvel": -1966080013, "enasyn": -1},
    ),
    "IMC_TgvelInDist": (
        (2000000023, 3, 1966080017),
        {"syntype": 0, "synsrc": 225, "synaxis": 3, "synsrcvar": 2000000023, "mcstgvel": 1966080017},
    ),
}


def test_every_function_of_motion_is_tried() -> None:
    assert set(CASES) == set(EXPANSIONS)


ROWS = {  # functions that the manual describes under another name
    "IMC_MoveInTime": "IMC_MoveTP", "IMC_MoveInDist": "IMC_MovePP",
    "IMC_TgvelInTime": "IMC_MoveTV", "IMC_TgvelInDist": "IMC_MovePV",
}  # fmt: skip


@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=pytest.mark.covers(f"imc.{ROWS.get(each, each)}")) for each in CASES]
)
@pytest.mark.covers("imc.const.RiseEdge", "imc.const.stop", "imc.const.direction", "imc.param.homeseq")
@pytest.mark.covers("imc.type.IMC32", "imc.type.IMCFLOAT")
def test_functions_of_motion_are_one_instruction(card: ToldCard, handle: lib.IMC_HANDLE, name: str) -> None:
    arguments, writes = CASES[name]
    assert getattr(lib, name)(handle, *arguments, 2, lib.SEL_QFIFO) == lib.IMC_OK
    ((fifo, instruction),) = card.told
    assert fifo == lib.SEL_QFIFO
    assert isinstance(instruction, WriteMany)
    assert named(instruction) == writes
    assert [put.name for put in EXPANSIONS[name]] == list(writes)


@pytest.mark.covers(
    "imc.IMC_GearInDist",
    "imc.synsourcetype.0",
    "imc.synsourcetype.1",
    "imc.synsourcetype.2",
    "imc.synsourcetype.3",
    "imc.synsourcetype.4",
)
@pytest.mark.covers(
    *(f"imc.sourcetype.{k}" for k in range(5)), "imc.const.sourcetype", "imc.const.synsourcetype"
)
@pytest.mark.covers("imc.param.gearsrc")
def test_source_types_are_addresses_of_velocities_and_positions(
    card: ToldCard, handle: lib.IMC_HANDLE
) -> None:
    for k in range(5):
        assert lib.IMC_GearInDist(handle, 1.0, 0, k, 1, k, 100, 2, lib.SEL_IFIFO) == lib.IMC_OK
    found = [named(each) for _, each in card.told if isinstance(each, WriteMany)]
    # chapter 5: curvel, encpvel, mcsvel, pcsvel, encsvel; curpos, encp, mcspos, pcspos, encs
    assert [each["gearsrc"] for each in found] == [227, 75, 4, 27, 83]
    assert [each["synsrc"] for each in found] == [225, 78, 10, 33, 86]


@pytest.mark.covers("imc.IMC_HandWheel", "imc.IMC_GearFree", "imc.IMC_GearInDist", "imc.IMC_GearInTime")
@pytest.mark.covers("imc.param.gearratio", "imc.type.S16.32")
@pytest.mark.parametrize(
    ("raw", "words"),
    [(0.5, (0x0000, 0x8000, 0x0000)), (-1.5, (0x0000, 0x8000, 0xFFFE)), (2**-32, (1, 0, 0))]
    # rounded to the nearest: 2/3 is AAAA AAAA.AAA...
    + [(2.0 / 3.0, (0xAAAB, 0xAAAA, 0)), (-2.0 / 3.0, (0x5555, 0x5555, 0xFFFF)), (7.25, (0, 0x4000, 7))],
)
@pytest.mark.covers("imc.type.IMCFLOAT")
def test_ratios_become_48_bits(
    card: ToldCard, handle: lib.IMC_HANDLE, raw: float, words: tuple[int, ...]
) -> None:
    lib.IMC_HandWheel(handle, raw, 0, 2, lib.SEL_IFIFO)
    lib.IMC_GearFree(handle, raw, 0, 0, 2, lib.SEL_QFIFO)
    lib.IMC_GearInDist(handle, raw, 0, 0, 1, 0, 70, 2, lib.SEL_IFIFO)
    lib.IMC_GearInTime(handle, raw, 0, 0, 70, 2, lib.SEL_IFIFO)
    sent = [instruction for _, instruction in card.told if isinstance(instruction, WriteMany)]
    assert len(sent) == 4
    for each in sent:
        value = named(each)["gearratio"]
        assert tuple(value >> 16 * k & 0xFFFF for k in range(3)) == words


@pytest.mark.covers(
    "imc.IMC_SetParam16",
    "imc.IMC_SetParam32",
    "imc.IMC_SetParam48",
    "imc.IMC_SetParamBit",
    "imc.IMC_TurnParamBit",
    "imc.IMC_ORXORParam",
    "imc.IMC_WaitTime",
    "imc.IMC_WaitParam",
    "imc.IMC_WaitParamBit",
    "imc.IMC_WaitParamMask",
    "imc.type.IMC16",
    "imc.type.IMC32",
    "imc.type.__int64",
)
def test_basic_functions(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    calls: list[tuple[str, tuple[Any, ...], Any]] = [
        ("IMC_SetParam16", (152, -1, 1, 1), Write(152, -1, 1, 1)),
        ("IMC_SetParam16", (307, 32767, 3, 0), Write(307, 32767, 3, 1)),
        ("IMC_SetParam32", (12, -2000000001, 3, 0), Write(12, -2000000001, 3, 2)),
        ("IMC_SetParam32", (12, 2147483647, 0, 1), Write(12, 2147483647, 0, 2)),
        ("IMC_SetParam48", (175, -(1 << 46) - 5, 3, 0), Write(175, -(1 << 46) - 5, 3, 3)),
        ("IMC_SetParam48", (175, (1 << 47) - 1, 0, 1), Write(175, (1 << 47) - 1, 0, 3)),
        ("IMC_SetParamBit", (562, 3, 1, 2, 0), ChangeBits(562, 8, 0, 2)),
        ("IMC_SetParamBit", (562, 3, 0, 2, 0), ChangeBits(562, 8, 8, 2)),
        ("IMC_TurnParamBit", (562, 15, 2, 0), ChangeBits(562, 0, 0x8000, 2)),
        ("IMC_ORXORParam", (562, -1, 0xF0, 2, 0), ChangeBits(562, 0xFFFF, 0xF0, 2)),
        ("IMC_WaitTime", (2000000003, 2), WaitTime(2000000003)),
        ("IMC_WaitTime", (0xFFFFFFFF, 1), WaitTime(-1)),
        ("IMC_WaitParam", (218, -1, 70005, 3, 2), WaitParam(218, 0xFFFF, 70005, 3)),
        ("IMC_WaitParamBit", (562, 2, 1, 70007, 3, 2), WaitParam(562, 4, 70007, 3, 4)),
        ("IMC_WaitParamBit", (562, 2, 0, 0, 1, 2), WaitParam(562, 0, 0, 1, 4)),
        ("IMC_WaitParamMask", (307, 0xFF, 0x1234, -1, 9, 2), WaitParam(307, 0x1234, -1, 0, 0xFF)),
        ("IMC_WaitParamMask", (562, 0xA500, 0x8100, 70009, 3, 1), WaitParam(562, 0x8100, 70009, 3, 0xA500)),
    ]
    for name, arguments, instruction in calls:
        card.told.clear()
        assert getattr(lib, name)(handle, *arguments) == lib.IMC_OK
        assert card.told == [(arguments[-1], instruction)], name


@pytest.mark.covers("imc.IMC_SetMulParam", "imc.struct.WR_MUL_DES")
def test_several_parameters_are_one_instruction(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    elements = [lib.WR_MUL_DES.of(12, 0, 2, -7), lib.WR_MUL_DES.of(23, 1, 1, -1)]
    elements.append(lib.WR_MUL_DES.of(175, 2, 3, -(1 << 46) - 5))
    elements.append(lib.WR_MUL_DES.of(12, 3, 2, 1_900_000_003))
    lib.IMC_SetMulParam(handle, elements, 2, lib.SEL_QFIFO)
    first = (Write(12, -7, 0, 2), Write(23, -1, 1, 1))
    assert card.told == [(1, WriteMany(first))]
    lib.IMC_SetMulParam(handle, elements, 4, lib.SEL_PFIFO2)
    last = (Write(175, -(1 << 46) - 5, 2, 3), Write(12, 1_900_000_003, 3, 2))
    assert card.told[1:] == [(3, WriteMany((*first, *last)))]


@pytest.mark.covers(
    "imc.IMC_AddLineN",
    "imc.IMC_AddLineNWithVel",
    "imc.IMC_AddArcLine",
    "imc.IMC_AddArcLineWithVel",
    "imc.IMC_AddArc",
    "imc.IMC_AddArcWithVel",
    "imc.IMC_AddSpiral",
    "imc.IMC_AddSpiralWithVel",
    "imc.struct.PFIFOSegData",
    "imc.struct.PFIFOSegInfo",
)
@pytest.mark.covers("imc.const.arc_dir", "imc.const.dir_conflict")
def test_segments(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    of = lib.PFIFOSegData.of
    ends, center = (1900000003, -1800000005), (-1700000007, 1600000009)
    last, speed, end_speed = -1500000011, 2000000013, 1400000017
    arc = of(*ends, last, center=center, direction=0)
    calls: list[tuple[str, tuple[Any, ...], Segment]] = [
        ("IMC_AddLineN", (of(*ends, last),), Segment((*ends, last), clockwise=True)),
        (
            "IMC_AddLineNWithVel",
            (lib.PFIFOSegInfo.of(speed, end_speed, of(last)),),
            Segment((last,), None, True, speed, end_speed),
        ),
        ("IMC_AddArcLine", (arc,), Segment((*ends, last), center, clockwise=True)),
        ("IMC_AddArcLine", (of(*ends, center=center, direction=-1),), Segment(ends, center)),
        ("IMC_AddArcLine", (of(*ends, center=center, direction=0xFFFF),), Segment(ends, center)),
        (
            "IMC_AddArcLineWithVel",
            (lib.PFIFOSegInfo.of(speed, end_speed, arc),),
            Segment((*ends, last), center, True, speed, end_speed),
        ),
        ("IMC_AddArc", (*ends, *center, 0), Segment(ends, center)),
        ("IMC_AddArc", (*ends, *center, 1), Segment(ends, center, clockwise=True)),
        (
            "IMC_AddArcWithVel",
            (speed, end_speed, *ends, *center, 1),
            Segment(ends, center, True, speed, end_speed),
        ),
        ("IMC_AddSpiral", (*ends, last, *center, 0), Segment((*ends, last), center)),
        (
            "IMC_AddSpiralWithVel",
            (speed, end_speed, *ends, last, *center, 1),
            Segment((*ends, last), center, True, speed, end_speed),
        ),
        (
            "IMC_AddSpiralWithVel",
            (end_speed, speed, *ends, last, *center, 1),
            Segment((*ends, last), center, True, end_speed, speed),
        ),
    ]
    for name, arguments, segment in calls:
        card.told.clear()
        assert getattr(lib, name)(handle, *arguments, lib.SEL_PFIFO2) == lib.IMC_OK
        ((fifo, sent),) = card.told
        assert fifo == lib.SEL_PFIFO2
        assert isinstance(sent, Segment)
        if segment.center is None:  # a line has no direction
            sent = Segment(sent.ends, sent.center, segment.clockwise, sent.speed, sent.end_speed)
        assert sent == segment, name


@pytest.mark.covers(
    "imc.IMC_InstallEvent",
    "imc.enum.IMC_EVENT_CMD",
    "imc.enum.IMC_EventType",
    "imc.struct.EventInfo",
    "imc.struct.EventInfo.Src2.param",
    "imc.struct.EventInfo.Src2.data16",
    "imc.struct.EventInfo.Src2.data32",
    "imc.struct.EventInfo.Src2.data48",
)
def test_events_take_the_operands_of_their_command(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    of = lib.EventInfo.of
    factor = of(lib.CMD_SCA32i, src1=(317, 0), dest=(319, 0))
    factor.Src2.data32.data = 65536  # as the manual's example fills it: the same memory as data48
    events = [
        of(lib.CMD_ADD32, src1=(225, 0), src2=(225, 1), dest=(317, 0)),
        of(lib.CMD_CMP32i, src1=(225, 3), src2=-1900000003),
        of(lib.CMD_ADD48i, src1=(175, 1), src2=-(1 << 46) - 9, dest=(175, 2)),
        of(lib.CMD_SET48, src2=-(1 << 46) - 7, dest=(337, 0)),
        of(lib.CMD_OR16i, lib.IMC_IF_NotCarry, src1=(562, 2), src2=-32767, dest=(307, 0)),
        of(lib.CMD_SET16, lib.IMC_Edge_GreatEqu, src2=-1, dest=(189, 2)),
        of(lib.CMD_COP48, src2=(340, 0), dest=(337, 0)),
        factor,
    ]
    assert lib.IMC_InstallEvent(handle, events, 8, lib.SEL_IFIFO) == lib.IMC_OK
    always = EventType.IMC_Allways
    told = (
        Event(EventCommand.CMD_ADD32, always, 225, 0, 225, 1, target=317),
        Event(EventCommand.CMD_CMP32i, always, 225, 3, constant=-1900000003),
        Event(EventCommand.CMD_ADD48i, always, 175, 1, constant=-(1 << 46) - 9, target=175, target_axis=2),
        Event(EventCommand.CMD_SET48, always, constant=-(1 << 46) - 7, target=337),
        Event(EventCommand.CMD_OR16i, EventType.IMC_IF_NotCarry, 562, 2, constant=-32767, target=307),
        Event(EventCommand.CMD_SET16, EventType.IMC_Edge_GreatEqu, constant=-1, target=189, target_axis=2),
        Event(EventCommand.CMD_COP48, always, second=340, target=337),
        Event(EventCommand.CMD_SCA32i, always, 317, constant=65536, target=319),
    )
    assert card.told == [(0, InstallEvents(told))]


@pytest.mark.covers(
    "imc.IMC_GetMulParam",
    "imc.IMC_GetParam16",
    "imc.IMC_GetParam32",
    "imc.IMC_GetParam48",
    "imc.IMC_GetParamBit",
)
def test_reading(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    words = {152: 0x0000, 153: 0xFFFF, 175: 0x0001, 176: 0x0000, 177: 0xFFFE}
    card.memory = {(at, 1): word for at, word in words.items()}
    assert lib.IMC_GetParam16(handle, 153, 1) == (lib.IMC_OK, -1)
    assert lib.IMC_GetParam32(handle, 152, 1) == (lib.IMC_OK, -0x10000)
    assert lib.IMC_GetParam48(handle, 175, 1) == (lib.IMC_OK, 1 - (2 << 32))
    assert lib.IMC_GetParamBit(handle, 177, 0, 1) == (lib.IMC_OK, 0)
    assert lib.IMC_GetParamBit(handle, 177, 15, 1) == (lib.IMC_OK, 1)
    array = (lib.WR_MUL_DES * 2)(lib.WR_MUL_DES.of(152, 1, 2), lib.WR_MUL_DES.of(175, 1, 3))
    assert lib.IMC_GetMulParam(handle, array, 2) == lib.IMC_OK
    assert [list(each.data) for each in array] == [[0, 0xFFFF, 0, 0], [1, 0, 0xFFFE, 0]]
    assert array[1].value == 1 - (2 << 32)


@pytest.mark.covers("imc.IMC_GetCapData")
def test_captured_positions(card: ToldCard, handle: lib.IMC_HANDLE) -> None:
    places = [(-1) ** k * (2_000_000_000 + k) for k in range(130)]
    card.captured[2] = list(places)
    assert lib.IMC_GetCapData(handle, 100, 2) == (lib.IMC_OK, places[:100], 100, 30)
    assert lib.IMC_GetCapData(handle, 100, 2) == (lib.IMC_OK, places[100:], 30, 0)
    assert lib.IMC_GetCapData(handle, 100, 2) == (lib.IMC_OK, [], 0, 0)
