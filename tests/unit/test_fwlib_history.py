"""Operation and alarm history through the library (Manual 000, operation history)."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from support.refusals import refused

AT = datetime(2031, 4, 17, 22, 53, 41)


def at(control: PowerMate) -> tuple[Any, int]:
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    return session, handle


def fresh(**more: Any) -> tuple[PowerMate, Any, int]:
    """Return a control at a known date with empty histories."""
    control = PowerMate(**more)
    control.clock.set_now(AT)
    library, handle = at(control)
    assert library.cnc_clearophis(handle, 0) == library.cnc_clearophis(handle, 1) == 0
    return control, library, handle


ENDS = {
    3: (3, 99, 102, 255),
    4: (500, 599),
    5: (749,),
    6: (400, 499),
    8: (399,),
    10: (5000, 5999),
    15: (1000, 1999),
}
"""First and last numbers of the groups of alarms."""


def operations(library: Any, handle: int) -> list[bytes]:
    """Stop, read all operation records as bytes, go on."""
    assert library.cnc_stopophis(handle) == 0
    code, count = library.cnc_rdophisno(handle)
    assert code == 0
    records = []
    if count:
        code, his = library.cnc_rdophistry(handle, 1, count, 6 + 8 * count)
        assert (code, his.s_no, his.e_no) == (0, 1, count)
        memory = bytes(his)
        records = [memory[6 + 8 * k : 14 + 8 * k] for k in range(count)]
    assert library.cnc_startophis(handle) == 0
    return records


def alarms(library: Any, handle: int) -> bytes:
    library.cnc_stopophis(handle)
    _, count = library.cnc_rdalmhisno(handle)
    code, his = library.cnc_rdalmhistry(handle, 1, count, 6 + 48 * count)
    assert code == 0
    library.cnc_startophis(handle)
    return bytes(his)


# ---------------------------------------------------------------------- stop and start


@pytest.mark.covers("fanuc.cnc_rdalmhistry")
@pytest.mark.covers(
    "fanuc.cnc_stopophis", "fanuc.cnc_startophis", "fanuc.cnc_rdophisno", "fanuc.cnc_rdalmhisno",
    "fanuc.cnc_rdophisno.err.EW_FUNC", "fanuc.cnc_rdophistry.err.EW_FUNC", "fanuc.cnc_rdalmhisno.err.EW_FUNC",
    "fanuc.cnc_rdalmhistry.err.EW_FUNC", "fanuc.concept.history_protocol",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdophistry")
def test_histories_are_read_while_sampling_is_stopped() -> None:
    control, library, handle = fresh()
    control.raise_alarm(85, "A")
    control.raise_alarm(417, axis=2)

    def codes() -> list[EW]:
        return [
            library.cnc_rdophisno(handle)[0],
            library.cnc_rdalmhisno(handle)[0],
            library.cnc_rdophistry(handle, 1, 2, 22)[0],
            library.cnc_rdalmhistry(handle, 1, 2, 102)[0],
        ]

    assert codes() == [EW.EW_FUNC] * 4
    library.cnc_stopophis(handle)
    assert codes() == [EW.EW_OK] * 4
    control.raise_alarm(700)
    control.history.press_key(0x41)
    assert (library.cnc_rdophisno(handle)[1], library.cnc_rdalmhisno(handle)[1]) == (2, 2)
    library.cnc_startophis(handle)
    assert codes() == [EW.EW_FUNC] * 4
    control.raise_alarm(5011, "B")
    library.cnc_stopophis(handle)
    assert (library.cnc_rdophisno(handle)[1], library.cnc_rdalmhisno(handle)[1]) == (3, 3)
    assert [each.alm_no for each in library.cnc_rdalmhistry(handle, 1, 3, 150)[1].alm_his] == [85, 417, 5011]
    library.cnc_startophis(handle)
    for number in range(401, 417):
        control.raise_alarm(number)
        control.history.press_key(number - 400)
    library.cnc_stopophis(handle)
    assert (library.cnc_rdophisno(handle)[1], library.cnc_rdalmhisno(handle)[1]) == (3 + 2 * 16, 3 + 16)
    assert library.cnc_rdalmhistry(handle, 19, 19, 54)[1].alm_his[0].alm_no == 416


# ---------------------------------------------------------------------- operation records


@pytest.mark.covers("fanuc.cnc_rdophistry", "fanuc.ODBHIS.rec_type.0", "fanuc.concept.history_record_kinds")
@pytest.mark.covers("fanuc.ODBHIS.rec_mdi", "fanuc.ODBHIS.rec_type", "fanuc.ODBHIS.rec_mdi.dummy")
@pytest.mark.covers("fanuc.ODBHIS.key_code", "fanuc.ODBHIS.pw_flag")
@pytest.mark.covers("fanuc.ODBHIS")
@pytest.mark.covers("fanuc.concept.history_protocol")
def test_a_key() -> None:
    control, library, handle = fresh()
    control.history.press_key(ord("G"))
    control.history.press_key(0x9C)
    assert operations(library, handle) == [b"\0\0G\0\0\0\0\0", b"\0\0\x9c\0\0\0\0\0"]


NAMES = {"X": 1, "G": 2, "Y": 3, "F": 4}


def monitored(library: Any, handle: int, *entries: tuple[int, int, int, int]) -> EW:
    sig = fwlib.IODBSIG(type=len(entries))
    for each, (entry, name, address, mask) in zip(sig.data, entries, strict=False):
        each.ent_no, each.sig_name, each.sig_no, each.mask_pat = entry, name, address, mask
    return EW(library.cnc_wrhissgnl(handle, sig))


@pytest.mark.covers(*(f"fanuc.IODBSIG.sig_name.{number}" for number in (1, 2, 3)))
@pytest.mark.covers(*(f"fanuc.ODBHIS.sig_name.{number}" for number in (1, 2, 3)), "fanuc.ODBHIS.sig_no")
@pytest.mark.covers("fanuc.cnc_wrhissgnl", "fanuc.IODBSIG.data.mask_pat", "fanuc.ODBHIS.rec_sgn")
def test_signals_beyond_1000_and_several_of_one_letter_are_noted() -> None:
    control, library, handle = fresh()
    chosen = ((1, 1, 1003, 0x0F), (2, 2, 1200, 0x80), (3, 3, 1063, 0xFF), (4, 1, 127, 0x01))
    assert monitored(library, handle, *chosen) is EW.EW_OK
    control.pmc.set_input(1003, 0x71)
    control.pmc.set_input(1003, 0xF1)  # outside the mask
    control.pmc.set_input(127, 0x83)
    control.pmc.set_input(3, 0xFF)  # not chosen
    control.pmc.write("G", 1200, b"\xc4")
    control.pmc.write("Y", 1063, b"\x06")
    assert operations(library, handle) == [
        bytes((1, 0, 1, 0, 0x71, 0, 0xEB, 3)),
        bytes((1, 0, 1, 0, 0x83, 0, 127, 0)),
        bytes((1, 0, 2, 0, 0xC4, 0, 0xB0, 4)),
        bytes((1, 0, 3, 0, 0x06, 0, 0x27, 4)),
    ]


@pytest.mark.parametrize(
    ("letter", "number"),
    [
        pytest.param(letter, number, id=letter,
                     marks=pytest.mark.covers(f"fanuc.ODBHIS.sig_name.{number}", f"fanuc.IODBSIG.sig_name.{number}"))
        for letter, number in NAMES.items()
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.ODBHIS.rec_type.1", "fanuc.cnc_wrhissgnl")
@pytest.mark.covers(
    "fanuc.ODBHIS.rec_sgn",
    "fanuc.ODBHIS.rec_sgn.dummy",
    "fanuc.ODBHIS.sig_name",
    "fanuc.ODBHIS.sig_old",
    "fanuc.ODBHIS.sig_new",
    "fanuc.ODBHIS.sig_no",
    "fanuc.concept.history_record_kinds",
)
@pytest.mark.covers("fanuc.IODBSIG", "fanuc.ODBHIS", "fanuc.ODBHIS.rec_type")
@pytest.mark.covers("fanuc.concept.history_protocol")
def test_the_change_of_a_signal(letter: str, number: int) -> None:
    control, library, handle = fresh()
    address = 3 if letter == "F" else 44
    assert monitored(library, handle, (7, number, address, 0xFE)) is EW.EW_OK

    def change(value: int) -> None:
        if letter == "X":
            control.pmc.set_input(address, value)
        elif letter == "F":
            control.select_mode({0x12: "HND", 0x28: "MEM", 0x29: "MEM"}[value])
            control.advance(1)
        else:
            control.pmc.write(letter, address, bytes([value]))

    if letter == "Y":  # bit 7 is a bit as any other
        change(0x92)
        change(0x6C)
        records = operations(library, handle)
        assert records == [
            bytes((1, 0, number, 0, 0x92, 0, 44, 0)),
            bytes((1, 0, number, 0x92, 0x6C, 0, 44, 0)),
        ]
        change(0)
        library.cnc_clearophis(handle, 0)
    change(0x12)
    change(0x28)
    change(0x29)
    first = b"\x20\x02" if letter == "F" else b"\0\x12"
    second = b"\x02\x20" if letter == "F" else b"\x12\x28"
    head = bytes([1, 0, number])
    tail = bytes([0, address, 0])
    assert operations(library, handle) == [head + first + tail, head + second + tail]


@pytest.mark.parametrize(
    ("bit", "number"),
    [
        pytest.param(bit, number, marks=pytest.mark.covers(f"fanuc.ODBHIS.alm_grp.bit{bit}"), id=str(bit))
        for bit, number in {
            0: 100,
            1: 0,
            2: 101,
            3: 85,
            4: 506,
            5: 700,
            6: 417,
            8: 300,
            10: 5010,
            15: 1003,
        }.items()
    ],
)
@pytest.mark.covers("fanuc.ODBHIS.rec_type.2")
@pytest.mark.covers(
    "fanuc.ODBHIS.rec_alm",
    "fanuc.ODBHIS.rec_alm.dummy",
    "fanuc.ODBHIS.alm_no",
    "fanuc.ODBHIS.alm_grp",
    "fanuc.ODBHIS.axis_no",
    "fanuc.concept.history_record_kinds",
)
@pytest.mark.covers("fanuc.ODBHIS", "fanuc.ODBHIS.rec_type")
@pytest.mark.covers("fanuc.concept.history_protocol")
def test_an_alarm(bit: int, number: int) -> None:
    control, library, handle = fresh()
    numbers = (number, *ENDS.get(bit, ()))
    for each in numbers:
        control.raise_alarm(each, "TEXT", axis=2)
    group = (1 << bit).to_bytes(2, "little")
    expected = [b"\2\0" + group + each.to_bytes(2, "little") + b"\0\0" for each in numbers]
    assert operations(library, handle) == expected


@pytest.mark.covers(*(f"fanuc.ODBHIS.alm_grp.bit{bit}" for bit in (9, 11, 12, 13, 14)))
@pytest.mark.covers("fanuc.ODBHIS", "fanuc.ODBHIS.alm_grp")
def test_unused_alarm_groups_never_appear() -> None:
    control, library, handle = fresh()
    for number in (3, 100, 101, 255, 310, 399, 444, 512, 704, 749, 1000, 1999, 2000, 5999):
        control.raise_alarm(number, "TEXT")
    bits = 0
    for record in operations(library, handle):
        bits |= int.from_bytes(record[2:4], "little")
    assert bits & 0x7A00 == 0
    assert bits & 0x0100


@pytest.mark.covers(
    "fanuc.ODBHIS.rec_date",
    "fanuc.ODBHIS.rec_time",
    "fanuc.ODBHIS.rec_date.dummy",
    "fanuc.ODBHIS.rec_time.dummy",
    "fanuc.ODBHIS.month",
    "fanuc.ODBHIS.day",
    "fanuc.ODBHIS.hour",
    "fanuc.ODBHIS.minute",
    "fanuc.ODBHIS.second",
    "fanuc.ODBHIS.year",
    "fanuc.ODBHIS.pw_flag",
    "fanuc.concept.history_record_kinds",
)
@pytest.mark.covers("fanuc.ODBHIS")
@pytest.mark.covers("fanuc.concept.history_protocol")
def test_power_on_notes_date_and_time() -> None:
    control, library, handle = fresh()
    control.power_cycle()
    assert operations(library, handle) == [b"\3\0\x1f\4\x11\1\0\0", b"\4\0\x16\x35\x29\1\0\0"]


@pytest.mark.covers("fanuc.cnc_rdophistry")
@pytest.mark.covers("fanuc.ODBHIS.s_no", "fanuc.ODBHIS.e_no")
@pytest.mark.covers("fanuc.ODBHIS")
@pytest.mark.covers("fanuc.cnc_stopophis")
def test_fewer_records_than_asked_for() -> None:
    control, library, handle = fresh()
    for code in (65, 66, 67):
        control.history.press_key(code)
    library.cnc_stopophis(handle)
    code, his = library.cnc_rdophistry(handle, 2, 6, 6 + 8 * 5)
    assert (code, his.s_no, his.e_no) == (0, 2, 3)
    assert [each.rec_mdi.key_code for each in his.data] == [66, 67, 0, 0, 0]
    assert library.cnc_rdophistry(handle, 4, 4, 14)[0] is EW.EW_NUMBER


@pytest.mark.parametrize(
    ("function", "first", "last", "length", "code"),
    [
        *refused(
            "cnc_rdophistry",
            *(("cnc_rdophistry", 1, 2, 6 + length, "EW_LENGTH") for length in (8, 15, 17, 24)),
        ),
        ("cnc_rdophistry", 2, 1, 6 + 8, "EW_NUMBER"),
        ("cnc_rdophistry", 0, 1, 6 + 16, "EW_NUMBER"),
        *refused(
            "cnc_rdalmhistry",
            *(("cnc_rdalmhistry", 1, 2, 6 + length, "EW_LENGTH") for length in (48, 95, 97)),
            ("cnc_rdalmhistry", 0, 1, 6 + 96, "EW_NUMBER"),
            ("cnc_rdalmhistry", 1, 3, 6 + 144, "EW_NUMBER"),
            ("cnc_rdalmhistry", 2, 1, 6, "EW_NUMBER"),
        ),
    ],
)
@pytest.mark.covers("fanuc.cnc_rdalmhistry", "fanuc.cnc_rdophistry")
def test_reading_is_refused(function: str, first: int, last: int, length: int, code: str) -> None:
    control, library, handle = fresh()
    control.raise_alarm(85, "A")
    control.raise_alarm(86, "B")
    library.cnc_stopophis(handle)
    assert getattr(library, function)(handle, first, last, length)[0] is EW[code]


# ---------------------------------------------------------------------- alarm records


@pytest.mark.covers("fanuc.cnc_rdalmhistry")
@pytest.mark.covers(
    *(f"fanuc.ODBAHIS.{each}" for each in ("s_no", "type", "e_no")),
    *(
        f"fanuc.ODBAHIS.alm_his.{each}"
        for each in ("dummy", "dummy2", "alm_no", "year", "month", "day", "hour", "minute", "second")
    ),
    "fanuc.ODBAHIS.alm_his.alm_grp",
    "fanuc.ODBAHIS.alm_his.alm_msg",
    "fanuc.ODBAHIS.alm_his.axis_no",
    "fanuc.ODBAHIS.alm_his.len_msg",
)
@pytest.mark.covers("fanuc.ODBAHIS")
def test_an_alarm_record_byte_by_byte() -> None:
    control, library, handle = fresh()
    control.raise_alarm(85, "COMMUNICATION ERROR OF THE READER/PUNCHER")
    control.raise_alarm(417, axis=3)
    control.raise_alarm(1007, "")
    memory = alarms(library, handle)
    date = bytes([31, 4, 17, 22, 53, 41, 0])
    assert memory[:6] == b"\1\0\0\0\3\0"
    assert memory[6:54] == b"\0\0\0\0\x55\0\xff" + date + b"\x20\0COMMUNICATION ERROR OF THE READE"
    assert memory[54:102] == b"\0\0\0\0\xa1\1\3" + date + b"\x11\0" + b"Z AXIS DGTL PARAM".ljust(32, b"\0")
    assert memory[102:150] == b"\0\0\0\0\xef\3\xff" + date + b"\0\0" + bytes(32)


@pytest.mark.covers(
    "fanuc.cnc_clearophis",
    "fanuc.cnc_clearophis.slct.0",
    "fanuc.cnc_clearophis.slct.1",
    "fanuc.cnc_clearophis.err.EW_ATTRIB",
)
@pytest.mark.covers("fanuc.concept.history_protocol")
@pytest.mark.covers(
    "fanuc.cnc_stopophis", "fanuc.cnc_rdophisno", "fanuc.cnc_rdalmhisno", "fanuc.cnc_startophis"
)
def test_one_history_is_cleared_alone() -> None:
    control, library, handle = fresh()

    def counts() -> tuple[int, int]:
        library.cnc_stopophis(handle)
        found = library.cnc_rdophisno(handle)[1], library.cnc_rdalmhisno(handle)[1]
        library.cnc_startophis(handle)
        return found

    control.raise_alarm(85, "A")
    assert counts() == (1, 1)
    assert library.cnc_clearophis(handle, 2) == library.cnc_clearophis(handle, -1) == EW.EW_ATTRIB
    assert counts() == (1, 1)
    library.cnc_clearophis(handle, 0)
    assert counts() == (0, 1)
    control.raise_alarm(86, "B")
    library.cnc_clearophis(handle, 1)
    assert counts() == (1, 0)


# ---------------------------------------------------------------------- monitored signals


@pytest.mark.covers("fanuc.cnc_rdhissgnl", *(f"fanuc.IODBSIG.sig_name.{number}" for number in (0, 1, 2, 4)))
@pytest.mark.covers("fanuc.cnc_wrhissgnl")
@pytest.mark.covers(
    "fanuc.IODBSIG",
    "fanuc.IODBSIG.type",
    "fanuc.IODBSIG.data.ent_no",
    "fanuc.IODBSIG.data.sig_name",
    "fanuc.IODBSIG.data.sig_no",
    "fanuc.IODBSIG.data.mask_pat",
)
def test_the_table_has_twenty_entries_and_keeps_those_not_named() -> None:
    _, library, handle = fresh()
    assert monitored(library, handle, (20, 2, 1003, 0x81), (3, 1, 12, 0x7F)) is EW.EW_OK
    assert monitored(library, handle, (20, 4, 7, 0xFF)) is EW.EW_OK
    code, sig = library.cnc_rdhissgnl(handle)
    found = [(each.ent_no, each.sig_name, each.sig_no, each.mask_pat) for each in sig.data]
    assert code == 0
    assert found == [(k, *{3: (1, 12, 0x7F), 20: (4, 7, 0xFF)}.get(k, (0, 0, 0))) for k in range(1, 21)]
    monitored(library, handle, (3, 0, 12, 0x7F))
    assert library.cnc_rdhissgnl(handle)[1].data[2].sig_name == 0
    full = [(k, 1 + k % 4, 5 + k, 0x80 + k) for k in range(1, 21)]
    assert monitored(library, handle, *full) is EW.EW_OK  # 20 are as many as there can be
    code, sig = library.cnc_rdhissgnl(handle)
    assert [(each.ent_no, each.sig_name, each.sig_no, each.mask_pat) for each in sig.data] == full
    some = fwlib.IODBSIG(type=1)
    for each, entry in zip(some.data, (6, 9), strict=False):
        each.ent_no = entry
    assert library.cnc_wrhissgnl(handle, some) == 0  # one is taken from the table
    assert [each.ent_no for each in library.cnc_rdhissgnl(handle)[1].data if not each.sig_name] == [6]


@pytest.mark.covers("fanuc.cnc_rdhissgnl")
@pytest.mark.parametrize(
    ("letter", "good", "bad"),
    [
        pytest.param(letter, good, bad, id=letter,
                     marks=pytest.mark.covers(f"fanuc.IODBSIG.sig_no.{letter}", f"fanuc.ODBHIS.sig_no.{letter}"))
        for letter, good, bad in (
            ("X", (0, 127, 1000, 1063), (-1, 128, 999, 1064)),
            ("Y", (0, 127, 1000, 1063), (-1, 128, 999, 1064)),
            ("G", (0, 255, 1000, 1255), (-1, 256, 999, 1256)),
            ("F", (0, 255, 1000, 1255), (-1, 256, 999, 1256)),
        )
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrhissgnl.err.EW_DATA")
@pytest.mark.covers("fanuc.IODBSIG", "fanuc.ODBHIS", "fanuc.ODBHIS.sig_no", "fanuc.cnc_wrhissgnl")
def test_addresses_that_can_be_watched(letter: str, good: tuple[int, ...], bad: tuple[int, ...]) -> None:
    _, library, handle = fresh()
    for address in good:
        assert monitored(library, handle, (5, NAMES[letter], address, 0x3C)) is EW.EW_OK
        assert library.cnc_rdhissgnl(handle)[1].data[4].sig_no == address
    for address in bad:
        assert monitored(library, handle, (5, NAMES[letter], address, 0x3C)) is EW.EW_DATA
    assert library.cnc_rdhissgnl(handle)[1].data[4].sig_no == good[-1]


@pytest.mark.covers("fanuc.cnc_rdhissgnl", "fanuc.cnc_wrhissgnl")
@pytest.mark.covers("fanuc.cnc_wrhissgnl.err.EW_ATTRIB")
@pytest.mark.covers("fanuc.IODBSIG.data.ent_no")
def test_a_wrong_table_is_refused_whole() -> None:
    _, library, handle = fresh()
    for count in (0, 21, -1):
        assert library.cnc_wrhissgnl(handle, fwlib.IODBSIG(type=count)) is EW.EW_ATTRIB
    assert monitored(library, handle, (4, 2, 9, 1), (21, 2, 9, 1)) is EW.EW_DATA
    assert monitored(library, handle, (4, 2, 9, 1), (0, 2, 9, 1)) is EW.EW_DATA
    assert monitored(library, handle, (4, 2, 9, 1), (5, 5, 9, 1)) is EW.EW_DATA
    assert all(each.sig_name == 0 for each in library.cnc_rdhissgnl(handle)[1].data)


@pytest.mark.covers("fanuc.cnc_rdhissgnl")
@pytest.mark.covers("fanuc.concept.history_protocol")
def test_histories_and_table_outlast_switching_off(tmp_path: Path) -> None:
    control, library, handle = fresh(memory=tmp_path / "memory")
    monitored(library, handle, (11, 3, 1007, 0x18))
    control.raise_alarm(85, "A")
    control.pmc.write("Y", 1007, b"\x08")
    control.advance(1)
    control.close()
    again = PowerMate(memory=tmp_path / "memory")
    library, handle = at(again)
    records = operations(library, handle)
    assert {record[0] for record in records[:2]} == {1, 2}
    assert [record[0] for record in records[2:]] == [3, 4]
    assert alarms(library, handle)[10:12] == b"\x55\0"
    entry = library.cnc_rdhissgnl(handle)[1].data[10]
    assert (entry.sig_name, entry.sig_no, entry.mask_pat) == (3, 1007, 0x18)
    again.close()
