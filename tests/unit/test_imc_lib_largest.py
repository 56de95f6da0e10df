"""What the manual lets one call carry at most (Manual 004, chapters 3 and 6), all of it, and nothing beyond."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.core._instructions import InstallEvents, Segment, Write, WriteMany
from polycnc.controllers.imc.core._parameters import PARAMETERS
from support.imc_calls import fast, line, many
from support.imc_card import shows
from support.imc_network import Program, ToldCard, opened

I, Q, P1, P2 = range(4)  # noqa: E741


@pytest.fixture(autouse=True)
def _leave_no_card() -> Iterator[None]:
    yield
    lib.detach()


@pytest.mark.covers(
    "imc.const.limits", "imc.struct.PFIFOSegData", "imc.struct.PFIFOSegInfo", "imc.IMC_AddLineN"
)
@pytest.mark.covers("imc.IMC_AddLineNWithVel", "imc.IMC_AddArcLine", "imc.IMC_AddArcLineWithVel")
@pytest.mark.parametrize(("axes", "most"), [(3, 3), (16, 16), (32, 16)])
def test_a_segment_has_as_many_axes_as_the_card_and_16_at_most(axes: int, most: int) -> None:
    card = ToldCard(axes=axes)
    handle = opened(card, clock=None)
    data, info = line(most), fast(most)
    data.SegEndData[0:most] = info.data.SegEndData[0:most] = [-70_001 * (k + 1) for k in range(most)]
    calls: list[tuple[Any, Any]] = [
        (data, lib.IMC_AddLineN), (info, lib.IMC_AddLineNWithVel), (data, lib.IMC_AddArcLine),
        (info, lib.IMC_AddArcLineWithVel),
    ]  # fmt: skip
    for given, add in calls:
        assert add(handle, given, P2) == lib.IMC_OK
        fifo, sent = card.told[-1]
        assert isinstance(sent, Segment)
        assert (fifo, sent.ends) == (P2, tuple(-70_001 * (k + 1) for k in range(most)))
    for count in (most + 1, -1, 0):
        data.datanum = info.data.datanum = count
        assert lib.IMC_AddLineN(handle, data, P1) == lib.IMC_OUT_OF_RANGE
        assert lib.IMC_AddLineNWithVel(handle, info, P1) == lib.IMC_OUT_OF_RANGE
        assert lib.IMC_AddArcLine(handle, data, P1) == lib.IMC_OUT_OF_RANGE
        assert lib.IMC_AddArcLineWithVel(handle, info, P1) == lib.IMC_OUT_OF_RANGE
    assert len(card.told) == 4


@pytest.mark.covers("imc.const.limits", "imc.IMC_GetMulParam", "imc.IMC_SetMulParam", "imc.struct.WR_MUL_DES")
@pytest.mark.covers("imc.IMC_InstallEvent", "imc.struct.EventInfo", "imc.struct.EventInfo.Src2.data32")
def test_all_elements_of_the_largest_call_are_read_written_and_installed() -> None:
    card = ToldCard(axes=32)
    handle = opened(card, clock=None)
    for axis in range(32):
        for k, word in enumerate((0x1111 + axis, 0x2222 + axis, 0x8000 + axis)):
            card.memory[175 + k, axis] = word
    asked = many(*((175, 31 - k, 3) for k in range(32)))
    assert lib.IMC_GetMulParam(handle, asked, 32) == lib.IMC_OK
    for k, each in enumerate(asked):
        assert list(each.data[0:3]) == [0x1111 + 31 - k, 0x2222 + 31 - k, 0x8000 + 31 - k]
    written = [lib.WR_MUL_DES.of(12, k % 32, 2, -70_001 * k) for k in range(500)]
    assert lib.IMC_SetMulParam(handle, written, 500, Q) == lib.IMC_OK
    assert card.told == [(Q, WriteMany(tuple(Write(12, -70_001 * k, k % 32, 2) for k in range(500))))]
    events = [
        lib.EventInfo.of(lib.CMD_ADD32i, src1=(225, k), src2=-70_001 * k, dest=(12, 31 - k))
        for k in range(31)
    ]
    assert lib.IMC_InstallEvent(handle, events, 31, P2) == lib.IMC_OK
    fifo, sent = card.told[-1]
    assert isinstance(sent, InstallEvents)
    shown = [(each.first_axis, each.constant, each.target_axis) for each in sent.events]
    assert (fifo, shown) == (P2, [(k, -70_001 * k, 31 - k) for k in range(31)])


CONSTANTS = {
    each: 48
    if "SCA" in each.name
    else 32
    if "MUL" in each.name
    else int("".join(filter(str.isdigit, each.name)))
    for each in lib.IMC_EVENT_CMD
    if "i" in each.name or "SET" in each.name
}


@pytest.mark.covers(
    *(f"imc.event.{each.name}" for each in CONSTANTS), "imc.struct.EventInfo", "imc.IMC_InstallEvent"
)
@pytest.mark.covers(*(f"imc.struct.EventInfo.Src2.data{bits}" for bits in (16, 32, 48)))
@pytest.mark.parametrize("pattern", [0x9A3C_7E1F_8B2D, 0x65C3_81E0_74D2, 0x8000_0000_8000, 0xFFFF_FFFF_FFFE])
def test_the_constant_of_an_event_has_all_its_bits_and_its_sign(pattern: int) -> None:
    card = ToldCard(axes=4)
    handle = opened(card, clock=None)
    assert len(CONSTANTS) == 17
    for k, (command, bits) in enumerate(CONSTANTS.items()):
        half = 1 << bits - 1
        constant = (pattern + half) % (2 * half) - half
        given = lib.EventInfo.of(command, src1=(175, k % 4), src2=constant, dest=(337, 0))
        assert lib.IMC_InstallEvent(handle, [given], 1, Q) == lib.IMC_OK
        _, sent = card.told[-1]
        assert isinstance(sent, InstallEvents)
        assert [(each.command, each.constant) for each in sent.events] == [(command, constant)]
    live = Program("ready = true\nnumber_of_axes = 2\n")
    first = 0x5A5A_3C3C_F00F
    program = {16: "user16b5", 32: "user32b5", 48: "user48b3"}
    for name, bits in (
        ("AND", 16),
        ("OR", 16),
        ("XOR", 16),
        ("ADD", 32),
        ("CMP", 32),
        ("ADD", 48),
        ("CMP", 48),
    ):
        cell, half = program[bits], 1 << bits - 1
        constant, value = ((each + half) % (2 * half) - half for each in (pattern, first))
        live.set(cell, value)
        command = getattr(lib, f"CMD_{name}{bits}i")
        event = lib.EventInfo.of(command, src1=(PARAMETERS[cell].address, 0), src2=constant, dest=(337, 0))
        live.ok(lib.IMC_InstallEvent, [event], 1, I)
        live.run(1)
        exact = {
            "AND": value & constant,
            "OR": value | constant,
            "XOR": value ^ constant,
            "ADD": value + constant,
        }
        result = exact.get(name, value - constant)
        assert live.card.read_raw(337, 0, bits // 16) == (result + half) % (2 * half) - half, name
        live.set("events", 0)
        live.run(1)


@pytest.mark.covers("imc.IMC_GetCapData", "imc.concept.capfifo", "imc.const.limits")
@shows("capture cappos")
def test_120_captured_positions_are_taken_at_once_and_the_others_stay() -> None:
    program = Program()
    for k in range(259):
        program.set("encp", 7 * k - 900, 2)
        program.run(1)
        program.set("capture", -1, 2)
        program.run(1)
    for first, count, left in ((0, 120, 139), (120, 120, 19), (240, 19, 0), (259, 0, 0)):
        expected = [7 * k - 900 for k in range(first, first + count)]
        assert lib.IMC_GetCapData(program.handle, 120, 2) == (lib.IMC_OK, expected, count, left)
    assert program.get("cappos", 2) == 7 * 258 - 900
    assert lib.IMC_GetCapData(program.handle, 120, 1) == (lib.IMC_OK, [], 0, 0)


@pytest.mark.covers("imc.IMC_WaitTime", "imc.IMC_WaitParam", "imc.IMC_WaitParamBit", "imc.IMC_WaitParamMask")
@pytest.mark.covers("imc.concept.qfifo", "imc.concept.pfifo1", "imc.concept.pfifo2", "imc.fifo.SEL_PFIFO2")
@pytest.mark.parametrize("kind", ["time", "param", "bit", "mask"])
def test_a_wait_of_more_than_a_minute_lasts_as_long_in_every_queue(kind: str) -> None:
    program = Program()
    program.set("startpath1", -1)
    program.set("startpath2", -1)
    program.run(1)
    for k, fifo in enumerate((Q, P1, P2)):
        time = 70_000 + k
        wait, arguments = {
            "time": (lib.IMC_WaitTime, (time,)),
            "param": (lib.IMC_WaitParam, (lib.user16b9Loc, 5, time, 0)),
            "bit": (lib.IMC_WaitParamBit, (lib.user16b9Loc, 15, 1, time, 0)),
            "mask": (lib.IMC_WaitParamMask, (lib.user16b9Loc, 0x8001, 0x8000, time, 0)),
        }[kind]
        program.ok(wait, *arguments, fifo)
        program.set(f"user16b{k}", 1, 0, fifo)
    program.run(5000)  # beyond what is left of 70,000 in 16 bits
    left = [program.get(name) for name in ("qwaittime", "pwaittime1", "pwaittime2")]
    assert left == [70_000 - 4999, 70_001 - 4999, 70_002 - 4999]
    assert [program.get(f"user16b{k}") for k in range(3)] == [0, 0, 0]
    for name in ("qwaittime", "pwaittime1", "pwaittime2"):
        program.set(name, 2)
    program.run(4)
    assert [program.get(f"user16b{k}") for k in range(3)] == [1, 1, 1]
