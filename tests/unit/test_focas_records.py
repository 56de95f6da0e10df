"""Records of the protocol are declared once: the same table packs, unpacks, and knows what clients and servers need."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.fanuc.library._remote import _POSITIONS, READINGS
from polycnc.controllers.fanuc.library._structs import HEADER
from polycnc.controllers.fanuc.wire import (
    LAYOUTS,
    POSITION_KINDS,
    Layout,
    Part,
    Record,
    Request,
    Value8,
    layout_of,
    record,
)
from polycnc.controllers.library import layout
from polycnc.errors import ProtocolError
from polycnc.servers.focas import COMMANDS
from support.often import share

DECLARED = sorted(
    {text for each in LAYOUTS.values() for text in (each.head, each.each, each.data, each.data_each) if text}
)
_VALUES: dict[str, st.SearchStrategy[Any]] = {
    "B": st.integers(0, 255),
    "H": st.integers(0, 65535),
    "h": st.integers(-32768, 32767),
    "I": st.integers(0, 2**32 - 1),
    "i": st.integers(-(2**31), 2**31 - 1),
    "<i": st.integers(-(2**31), 2**31 - 1),
    "d": st.floats(allow_nan=False),
    "8": st.builds(Value8, st.integers(-(2**31), 2**31 - 1), st.integers(0, 9)),
}


def _value_of(part: Part) -> st.SearchStrategy[Any]:
    if part.slot:
        return st.lists(_VALUES["8" if part.slot == 8 else "i"], min_size=1, max_size=32)
    if part.code in _VALUES:
        return _VALUES[part.code]
    size = part.size
    return st.binary(min_size=1 if size is None else size, max_size=9 if size is None else size)


@pytest.mark.parametrize("declared", DECLARED)
@settings(max_examples=share(30))
@given(data=st.data())
def test_what_is_packed_is_unpacked(declared: str, data: st.DataObject) -> None:
    made = record(declared)
    values = {
        part.name: data.draw(_value_of(part))
        for part in made.parts
        if part.code[0] != "?" and part.code != "s-"
    }
    packed = made.pack({**values, "text": values.get("text", b"")})
    found = made.unpack(packed)
    assert {name: found[name] for name in values} == values
    assert made.size in (None, len(packed))
    assert b"".join(piece for _, piece in made.cut(packed)) == packed


@pytest.mark.parametrize("declared", [each for each in DECLARED if record(each).size])
def test_a_record_that_is_too_short_is_refused(declared: str) -> None:
    size = record(declared).size
    assert size is not None
    with pytest.raises(ProtocolError):
        record(declared).unpack(bytes(size - 1))


def test_the_bytes_of_a_record_by_hand() -> None:
    made = Record("number:I axis:h letter:s1 name:s3 unknown:?2 time:<i rate:d")
    packed = made.pack(
        {"number": 2**32 + 7, "axis": -3, "letter": "X", "name": "spindle", "time": 259, "rate": 2.5}
    )
    assert packed.hex(" ") == "00 00 00 07 ff fd 58 73 70 69 00 00 03 01 00 00 40 04 00 00 00 00 00 00"
    assert made.size == 24
    assert Record("decimals:H").pack({"decimals": -1}) == b"\xff\xff"  # cut as C does
    assert Record("block:i").pack({"block": 2**31}) == b"\x7f\xff\xff\xff"  # the nearest that fits
    assert Record("values:8*").pack({"values": [5, Value8(-17, 3), 0]}).hex(" ", 8) == (
        "00000005000a0000 ffffffef000a0003 00000000000a0000"
    )
    assert Record("values:4*").unpack(b"\0\0\1\3\xff\xff\xff\xfe") == {"values": [259, -2]}


def test_rows_are_mappings_or_plain_values_of_one_field() -> None:
    made = Layout("tp_figures", "", "count:H", "digits:h")
    assert made.pack(({"count": 3}, [7, -2, 9])) == made.pack(
        ({"count": 3}, [{"digits": 7}, {"digits": -2}, {"digits": 9}])
    )
    assert made.unpack(b"\0\3\0\7\xff\xfe\0\x09") == (
        {"count": 3},
        [{"digits": 7}, {"digits": -2}, {"digits": 9}],
    )
    assert (made.pack(None), made.pack({"count": 5}), made.pack([4])) == (b"", b"\0\5", b"\0\4")


def test_what_a_value_of_eight_bytes_holds_is_shown() -> None:
    part = Part("load", "8")
    assert part.shown(bytes(Value8(-12345, 3))) == "-12.345"
    assert part.shown(bytes(Value8(0, 0, None))) == "vacant"
    assert part.shown(b"\0\0\0\1\0\7\0\0") == "no number"
    assert Part("rate", "d").shown(b"\x40\x04" + bytes(6)) == str(2.5)
    assert math.isnan(Part("rate", "d").unpack(b"\x7f\xf8" + bytes(6)))


@pytest.mark.parametrize("name", READINGS)
def test_a_reading_finds_its_elements_in_the_record_of_its_command(name: str) -> None:
    row = READINGS[name]
    fields = {each.name for each in record(layout_of(Request(row.commands[0])).head).parts}
    elements = {each.name for each in layout(HEADER.classes[row.structure]).fields}
    assert set(row.names.values()) <= fields
    assert set(row.names) <= elements
    assert {row.names.get(each, each) for each in elements} & fields == fields - {"addinfo"}
    assert all((1, command) in COMMANDS for command in row.commands)


def test_the_kinds_of_positions_are_one_table() -> None:
    assert set(_POSITIONS.values()) == set(POSITION_KINDS.values())
    assert {each.removeprefix("cnc_") for each in _POSITIONS} >= {
        "absolute",
        "machine",
        "relative",
        "distance",
    }
