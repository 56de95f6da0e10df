"""The structures of the function library lie in memory as the manual's C declarations say."""

from __future__ import annotations

import ctypes
import struct

import pytest

from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.library._declared import Operand2
from polycnc.controllers.library import Structure
from polycnc.errors import UsageError


def offsets(record: type[ctypes.Structure]) -> dict[str, int]:
    return {name: getattr(record, name).offset for name, *_ in record._fields_}


@pytest.mark.covers("imc.struct.NIC_INFO")
def test_adapters_are_sixteen_texts_of_256_bytes() -> None:
    info = imclib.NIC_INFO()
    assert ctypes.sizeof(info) == 4096
    info.description[15].value = b"last"
    assert info.pack()[15 * 256 :] == b"last" + bytes(252)
    assert imclib.NIC_INFO.unpack(info.pack()).descriptions() == ["last"]


@pytest.mark.covers("imc.struct.WR_MUL_DES")
def test_description_of_a_parameter_is_seven_words() -> None:
    made = imclib.WR_MUL_DES.of(imclib.gearratioLoc, 3, 3, -(3 << 31))
    assert made.pack() == struct.pack("<7H", 175, 3, 3, 0x0000, 0x8000, 0xFFFE, 0)
    assert made.value == -(3 << 31)
    assert imclib.WR_MUL_DES.unpack(made.pack()) == made
    assert imclib.WR_MUL_DES.of(12, 0, 2, 100).value == 100


@pytest.mark.covers("imc.struct.EventInfo")
def test_event_has_24_bytes_with_the_second_operand_at_8() -> None:
    assert ctypes.sizeof(imclib.EventInfo) == 24
    assert offsets(imclib.EventInfo) == {
        "EventCMD": 0,
        "EventType": 2,
        "Src1_loc": 4,
        "Src1_axis": 6,
        "Src2": 8,
        "dest_loc": 16,
        "dest_axis": 18,
        "reserve": 20,
    }
    made = imclib.EventInfo.of(imclib.CMD_ADD32, src1=(225, 0), src2=(225, 1), dest=(imclib.user32b0Loc, 0))
    assert made.pack() == struct.pack("<4h2hi2hi", 0, 0, 225, 0, 225, 1, 0, 317, 0, 0)


@pytest.mark.parametrize(
    ("member", "value", "memory"),
    [
        pytest.param(
            "param",
            (225, 1),
            struct.pack("<hhi", 225, 1, 0),
            marks=pytest.mark.covers("imc.struct.EventInfo.Src2.param"),
        ),
        pytest.param(
            "data16",
            (12345,),
            struct.pack("<hhi", 12345, 0, 0),
            marks=pytest.mark.covers("imc.struct.EventInfo.Src2.data16"),
        ),
        pytest.param(
            "data32",
            (12345678,),
            struct.pack("<ii", 12345678, 0),
            marks=pytest.mark.covers("imc.struct.EventInfo.Src2.data32"),
        ),
    ],
)
def test_second_operand_is_a_union_of_eight_bytes(member: str, value: tuple[int, ...], memory: bytes) -> None:
    operand = Operand2()
    part = getattr(operand, member)
    for (name, _), number in zip(part._fields_, value, strict=False):
        setattr(part, name, number)
    assert bytes(operand) == memory
    assert operand.data48 == int.from_bytes(memory, "little", signed=True)


@pytest.mark.covers("imc.struct.EventInfo.Src2.data48")
def test_a_constant_of_48_bits_fits_only_its_own_member() -> None:
    operand = Operand2()
    operand.data48 = 12345678000
    assert bytes(operand) == struct.pack("<q", 12345678000)
    operand.data48 = 0
    operand.data32.data = 12345678000  # as an example of the manual does
    assert operand.data32.data == -539223888


@pytest.mark.covers("imc.struct.PFIFOSegData", "imc.struct.PFIFOSegInfo")
def test_segments_have_80_and_88_bytes() -> None:
    data = imclib.PFIFOSegData.of(1000, -2000, center=(500, 0), direction=-1)
    memory = struct.pack("<i16i3i", 2, 1000, -2000, *[0] * 14, 500, 0, -1)
    assert (len(memory), data.pack()) == (80, memory)
    info = imclib.PFIFOSegInfo.of(10 * 65536, 0, data)
    assert info.pack() == struct.pack("<2i", 10 * 65536, 0) + memory
    assert ctypes.sizeof(info) == 88
    assert imclib.PFIFOSegInfo.unpack(info.pack()).data.SegEndData[1] == -2000


@pytest.mark.covers(
    "imc.struct.NIC_INFO",
    "imc.struct.WR_MUL_DES",
    "imc.struct.EventInfo",
    "imc.struct.PFIFOSegData",
    "imc.struct.PFIFOSegInfo",
)
@pytest.mark.parametrize(
    "record",
    [
        imclib.NIC_INFO,
        imclib.WR_MUL_DES,
        imclib.EventInfo,
        imclib.PFIFOSegData,
        imclib.PFIFOSegInfo,
    ],
)
def test_any_memory_comes_back(record: type[Structure]) -> None:
    memory = bytes(k * 37 % 251 for k in range(ctypes.sizeof(record)))
    made = record.unpack(memory)
    assert made.pack() == memory
    assert hash(made) == hash(record.unpack(memory))
    assert made != record()
    assert made != memory
    with pytest.raises(UsageError, match=f"has {len(memory)} bytes, not 3"):
        record.unpack(b"abc")


@pytest.mark.covers(
    "imc.struct.EventInfo.Src2.data16",
    "imc.struct.EventInfo.Src2.data32",
    "imc.struct.EventInfo.Src2.data48",
    "imc.struct.EventInfo",
)
def test_events_fill_the_member_that_their_command_takes() -> None:
    of = imclib.EventInfo.of
    assert of(imclib.CMD_SET16, src2=-1, dest=(152, 0)).Src2.data16.data == -1
    assert of(imclib.CMD_CMP32i, src1=(225, 0), src2=10000).Src2.data32.data == 10000
    assert of(imclib.CMD_SET48, src2=12345678000, dest=(337, 0)).Src2.data48 == 12345678000
    assert of(imclib.CMD_SCA32i, src1=(317, 0), src2=1 << 32).Src2.data48 == 1 << 32
    assert of(imclib.CMD_COP16, imclib.IMC_IF_Zero, src2=(307, 0), dest=(308, 0)).EventType == 8
