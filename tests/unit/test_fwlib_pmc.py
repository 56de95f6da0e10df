"""PMC memory through the library, and what writing G signals does to the control (Manual 000, PMC)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from polycnc.cnc import Answer, Function, RunState
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.fwlib import EW
from polycnc.controllers.fanuc.library._structs import HEADER
from support.refusals import refused

LETTERS = dict(enumerate("GFYXARTKCD"))
G, F, Y, X, A, R, T, K, C, D = range(10)


def at(control: PowerMate) -> tuple[Any, int]:
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    return session, handle


def write(library: Any, handle: int, kind: int, first: int, *data: int) -> EW:
    block = HEADER.make("IODBPMC", PMC_ITEMS=len(data))(
        type_a=kind, type_d=0, datano_s=first, datano_e=first + len(data) - 1
    )
    block.u.cdata = [each - 256 if each > 127 else each for each in data]
    return EW(library.pmc_wrpmcrng(handle, 8 + len(data), bytes(block)[: 8 + len(data)]))


def read(library: Any, handle: int, kind: int, first: int, last: int | None = None) -> list[int]:
    last = first if last is None else last
    code, block = library.pmc_rdpmcrng(handle, kind, 0, first, last, 8 + last - first + 1)
    assert code == 0
    return [each & 0xFF for each in block.u.cdata]


# ---------------------------------------------------------------------- samples of the manual


@pytest.mark.covers(
    "fanuc.example.pmc_write_word", "fanuc.example.pmc_read_word", "fanuc.pmc_wrpmcrng", "fanuc.pmc_rdpmcrng"
)
@pytest.mark.covers("fanuc.pmc.data_type.1")
def test_word_of_the_manual() -> None:
    library, handle = at(PowerMate())
    buf = fwlib.IODBPMC(type_a=9, type_d=1, datano_s=100, datano_e=101)
    buf.u.idata[0] = 250
    assert library.pmc_wrpmcrng(handle, 10, buf) == 0
    code, found = library.pmc_rdpmcrng(handle, 9, 1, 100, 101, 10)
    assert (code, found.u.idata[0]) == (0, 250)
    assert bytes(found)[:10] == b"\x09\0\1\0\x64\0\x65\0\xfa\0"
    assert read(library, handle, D, 99, 102) == [0, 250, 0, 0]


@pytest.mark.covers("fanuc.example.pmc_write_bytes", "fanuc.example.pmc_read_bytes")
@pytest.mark.covers("fanuc.pmc_rdpmcrng")
@pytest.mark.covers("fanuc.pmc.data_type.0")
def test_bytes_of_the_manual() -> None:
    control = PowerMate()
    library, handle = at(control)
    control.pmc.write("R", 198, bytes(range(31, 45)))
    code, found = library.pmc_rdpmcrng(handle, 5, 0, 200, 209, 18)
    assert (code, list(found.u.cdata)) == (0, list(range(33, 43)))
    assert write(library, handle, R, 200, *[0] * 10) == 0
    assert read(library, handle, R, 198, 211) == [31, 32, *[0] * 10, 43, 44]


# ---------------------------------------------------------------------- addresses

AREAS = [
    ("G", 0, 255), ("G", 1000, 1255), ("F", 0, 255), ("F", 1000, 1255), ("Y", 0, 127), ("Y", 1000, 1063),
    ("X", 0, 127), ("X", 1000, 1063), ("A", 0, 24), ("R", 0, 999), ("R", 9000, 9117), ("T", 0, 79), ("K", 0, 19),
    ("C", 0, 79), ("D", 0, 1859),
]  # fmt: skip


@pytest.mark.parametrize(
    ("letter", "first", "last"),
    [
        pytest.param(
            letter,
            first,
            last,
            marks=pytest.mark.covers(
                f"fanuc.pmc.area.{letter}.{first:04d}_{last:04d}",
                f"fanuc.pmc.adr_type.{'GFYXARTKCD'.index(letter)}",
            ),
        )
        for letter, first, last in AREAS
    ],
)
@pytest.mark.covers("fanuc.pmc_rdpmcrng", "fanuc.pmc_rdpmcrng.err.EW_NUMBER")
def test_an_area_ends_where_the_manual_says(letter: str, first: int, last: int) -> None:
    library, handle = at(PowerMate())
    kind = "GFYXARTKCD".index(letter)
    assert len(read(library, handle, kind, first, last)) == last - first + 1
    assert library.pmc_rdpmcrng(handle, kind, 0, last, last + 1, 10)[0] is EW.EW_NUMBER
    assert library.pmc_rdpmcrng(handle, kind, 0, first - 1, first, 10)[0] is EW.EW_NUMBER
    protected = letter in "FX" or first == 9000
    assert write(library, handle, kind, first, 1) is (EW.EW_PROT if protected else EW.EW_OK)
    if not protected:
        assert (read(library, handle, kind, first), read(library, handle, kind, last)) == ([1], [0])
    assert write(library, handle, kind, last, 1) is (EW.EW_PROT if protected or letter == "K" else EW.EW_OK)


@pytest.mark.parametrize(
    ("kind", "letter", "code"),
    [
        pytest.param(kind, letter, EW.EW_PROT if letter in "FX" else EW.EW_OK, id=letter,
                     marks=pytest.mark.covers(f"fanuc.pmc.adr_type.{kind}"))
        for kind, letter in LETTERS.items()
    ],
)  # fmt: skip
def test_a_kind_is_its_letter(kind: int, letter: str, code: EW) -> None:
    control = PowerMate()
    library, handle = at(control)
    for other in "GYARTKCD":
        control.pmc.write(other, 13, bytes([0x35]))
    control.pmc.set_input(13, 0x6A)
    before = read(library, handle, kind, 13)
    assert before == [{"F": 0, "X": 0x6A}.get(letter, 0x35)]
    assert write(library, handle, kind, 13, 0x51) is code
    assert control.pmc.read(letter, 13, 13)[0] == (before[0] if code else 0x51)
    others = [each for each in "GYARTKCD" if each != letter]
    assert all(control.pmc.read(each, 13, 13) == b"\x35" for each in others)


@pytest.mark.parametrize(
    ("kind", "first", "count"),
    [
        pytest.param(F, 40, 2, marks=pytest.mark.covers("fanuc.pmc.wrprot.FX")),
        pytest.param(X, 1003, 2, marks=pytest.mark.covers("fanuc.pmc.wrprot.FX")),
        pytest.param(R, 9000, 3, marks=pytest.mark.covers("fanuc.pmc.wrprot.R9000")),
        pytest.param(R, 9115, 3, marks=pytest.mark.covers("fanuc.pmc.wrprot.R9000")),
        pytest.param(K, 17, 1, marks=pytest.mark.covers("fanuc.pmc.wrprot.K17")),
        pytest.param(K, 19, 1, marks=pytest.mark.covers("fanuc.pmc.wrprot.K17")),
        pytest.param(K, 15, 3, marks=pytest.mark.covers("fanuc.pmc.wrprot.K17")),
    ],
)
def test_protected_addresses_are_not_written(kind: int, first: int, count: int) -> None:
    library, handle = at(PowerMate())
    before = read(library, handle, kind, first, first + count - 1)
    assert write(library, handle, kind, first, *[0x5A] * count) is EW.EW_PROT
    assert read(library, handle, kind, first, first + count - 1) == before
    assert write(library, handle, K, 16, 0x5A) is EW.EW_OK


@pytest.mark.parametrize(
    ("data_type", "last", "length", "member", "values"),
    [
        pytest.param(
            0, 43, 12, "cdata", [0x12, 0x34, 0x56, -2], marks=pytest.mark.covers("fanuc.pmc.data_type.0")
        ),
        pytest.param(1, 43, 12, "idata", [0x3412, -426], marks=pytest.mark.covers("fanuc.pmc.data_type.1")),
        pytest.param(2, 43, 12, "ldata", [-0x1A9CBEE], marks=pytest.mark.covers("fanuc.pmc.data_type.2")),
    ],
)
@pytest.mark.covers(
    "fanuc.IODBPMC.type_d",
    "fanuc.IODBPMC.u",
    "fanuc.IODBPMC.u.cdata",
    "fanuc.IODBPMC.u.idata",
    "fanuc.IODBPMC.u.ldata",
)
@pytest.mark.covers("fanuc.pmc_wrpmcrng", "fanuc.pmc_rdpmcrng", "fanuc.pmc.adr_type.9")
@pytest.mark.covers("fanuc.IODBPMC.type_a", "fanuc.IODBPMC.datano_s", "fanuc.IODBPMC.datano_e")
@pytest.mark.covers("fanuc.IODBPMC")
def test_items_of_a_type(data_type: int, last: int, length: int, member: str, values: list[int]) -> None:
    control = PowerMate()
    library, handle = at(control)
    control.pmc.write("D", 40, b"\x12\x34\x56\xfe")
    code, found = library.pmc_rdpmcrng(handle, D, data_type, 40, last, length)
    assert (code, list(getattr(found.u, member))) == (0, values)
    assert (found.type_a, found.type_d, found.datano_s, found.datano_e) == (9, data_type, 40, last)
    buf = fwlib.IODBPMC(type_a=9, type_d=data_type, datano_s=1850, datano_e=1850 + last - 40)
    getattr(buf.u, member)[: len(values)] = values
    assert library.pmc_wrpmcrng(handle, length, buf) == 0
    assert control.pmc.read("D", 1849, 1854) == b"\0\x12\x34\x56\xfe\0"


@pytest.mark.parametrize(
    ("kind", "data_type", "first", "last", "length", "code"),
    refused(
        "pmc_rdpmcrng",
        (D, 1, 100, 101, 9, "EW_LENGTH"),
        (D, 1, 100, 101, 11, "EW_LENGTH"),
        (D, 1, 100, 101, 12, "EW_LENGTH"),
        (D, 0, 100, 100, 0, "EW_LENGTH"),
        (D, 2, 100, 102, 11, "EW_LENGTH"),
        (D, 0, 101, 100, 9, "EW_NUMBER"),
        (G, 0, 255, 1000, 8 + 746, "EW_NUMBER"),
        (A, 0, -1, 0, 10, "EW_NUMBER"),
        (10, 0, 1, 1, 9, "EW_ATTRIB"),
        (-1, 0, 1, 1, 9, "EW_ATTRIB"),
        (D, 3, 1, 1, 9, "EW_ATTRIB"),
    ),
)
@pytest.mark.covers("fanuc.pmc_rdpmcrng")
def test_reading_is_refused(kind: int, data_type: int, first: int, last: int, length: int, code: str) -> None:
    library, handle = at(PowerMate())
    assert library.pmc_rdpmcrng(handle, kind, data_type, first, last, length)[0] is EW[code]


@pytest.mark.covers("fanuc.pmc_wrpmcrng")
@pytest.mark.parametrize(
    ("head", "length", "code"),
    refused(
        "pmc_wrpmcrng",
        ((D, 1, 100, 101), 9, "EW_LENGTH"),
        ((D, 1, 100, 101), 12, "EW_LENGTH"),
        *(((D, 1, 100, 102), 11, "EW_LENGTH"), ((D, 2, 100, 101), 10, "EW_LENGTH")),  # no whole words
        ((D, 2, 100, 105), 14, "EW_LENGTH"),
        ((D, 1, 100, 101), 2000, "EW_LENGTH"),
        ((D, 1, 100, 101), 4, "EW_LENGTH"),
        ((D, 0, 1859, 1860), 10, "EW_NUMBER"),
        ((11, 0, 3, 4), 10, "EW_ATTRIB"),
        ((D, 5, 3, 4), 10, "EW_ATTRIB"),
    ),
)
def test_writing_is_refused_and_writes_nothing(head: tuple[int, ...], length: int, code: str) -> None:
    control = PowerMate()
    library, handle = at(control)
    control.pmc.write("D", 0, bytes(k % 251 for k in range(1860)))
    before = control.pmc.read("D", 0, 1859)
    buf = fwlib.IODBPMC(type_a=head[0], type_d=head[1], datano_s=head[2], datano_e=head[3])
    assert library.pmc_wrpmcrng(handle, length, buf) is EW[code]
    assert control.pmc.read("D", 0, 1859) == before


@pytest.mark.covers("fanuc.pmc_rdpmcrng")
@pytest.mark.covers("fanuc.EW_NOPMC", "fanuc.pmc_rdpmcrng.err.EW_NOPMC", "fanuc.pmc_wrpmcrng.err.EW_NOPMC")
@pytest.mark.covers("fanuc.pmc_wrpmcrng")
@pytest.mark.covers("fanuc.common.allmode")
def test_a_control_without_a_pmc() -> None:
    library, handle = at(PowerMate(options=("custom_macro",)))
    assert library.pmc_rdpmcrng(handle, D, 0, 3, 3, 9)[0] is EW.EW_NOPMC
    assert int(write(library, handle, D, 3, 7)) == 1


@pytest.mark.covers(
    "fanuc.pmc_rdpmcinfo", "fanuc.pmc_rdpmcinfo.adr_type.-1", "fanuc.pmc_rdpmcinfo.err.EW_ATTRIB",
    "fanuc.ODBPMCINF.adr_attr.bit7", "fanuc.ODBPMCINF.adr_attr.bits6_0",
)  # fmt: skip
@pytest.mark.covers("fanuc.ODBPMCINF.datano", "fanuc.ODBPMCINF.info.adr_attr")
@pytest.mark.covers("fanuc.ODBPMCINF")
def test_which_addresses_there_are() -> None:
    library, handle = at(PowerMate())
    code, every = library.pmc_rdpmcinfo(handle, -1)
    found = [(chr(e.pmc_adr), e.adr_attr, e.top_num, e.last_num) for e in every.info[: every.datano]]
    assert code == 0
    assert found == [
        ("G", 0, 0, 255), ("G", 0, 1000, 1255), ("F", 0x80, 0, 255), ("F", 0x80, 1000, 1255), ("Y", 0, 0, 127),
        ("Y", 0, 1000, 1063), ("X", 0x80, 0, 127), ("X", 0x80, 1000, 1063), ("A", 0, 0, 24), ("R", 0, 0, 999),
        ("R", 0x80, 9000, 9117), ("T", 0, 0, 79), ("K", 0, 0, 16), ("K", 0x80, 17, 19), ("C", 0, 0, 79),
        ("D", 0, 0, 1859),
    ]  # fmt: skip
    _, one = library.pmc_rdpmcinfo(handle, 5)
    assert [(e.pmc_adr, e.top_num) for e in one.info[: one.datano]] == [(ord("R"), 0), (ord("R"), 9000)]
    assert library.pmc_rdpmcinfo(handle, 10)[0] is EW.EW_ATTRIB
    assert library.pmc_rdpmcinfo(handle, -2)[0] is EW.EW_ATTRIB


@pytest.mark.covers(
    "fanuc.pmc.area.T.0000_0079",
    "fanuc.pmc.area.K.0000_0019",
    "fanuc.pmc.area.C.0000_0079",
    "fanuc.pmc.area.D.0000_1859",
)
def test_timers_keep_relays_counters_and_data_outlast_switching_off(tmp_path: Path) -> None:
    control = PowerMate(memory=tmp_path / "memory")
    library, handle = at(control)
    for kind in (T, K, C, D, R, A):
        assert write(library, handle, kind, 5, 0x40 + kind) == 0
    control.close()
    again = PowerMate(memory=tmp_path / "memory")
    assert [again.pmc.read(letter, 5, 5)[0] for letter in "TKCDRA"] == [0x46, 0x47, 0x48, 0x49, 0, 0]
    again.close()


# ---------------------------------------------------------------------- signals that act


def test_feed_override_is_255_less_the_value() -> None:
    control = PowerMate()
    library, handle = at(control)
    assert read(library, handle, G, 12) == [155]
    write(library, handle, G, 12, 185)
    assert control.control.overrides.feed == 0.7
    write(library, handle, G, 12, 255)
    assert control.control.overrides.feed == 0.0
    assert read(library, handle, G, 12) == [255]
    control.control.set_overrides(feed=0.4, rapid=0.25)
    assert (read(library, handle, G, 12), read(library, handle, G, 14)) == ([215], [2])
    control.select_mode("MDI")
    write(library, handle, G, 14, 1)
    assert (control.control.overrides.feed, control.control.overrides.rapid) == (0.4, 0.5)


def test_rapid_override_shows_in_the_speed() -> None:
    control = PowerMate()
    library, handle = at(control)
    control.programs.memory.create("O0004", b"O0004\nG0 X800.\n")
    control.select_program(4)
    control.cycle_start()
    speeds = []
    for code in (0, 1, 2, 3):
        write(library, handle, G, 14, code)
        control.advance(300)
        speeds.append(round(control.status().axes["X"].velocity * 60.0))
    assert speeds == [15000, 7500, 3750, 500]
    assert read(library, handle, F, 2)[0] & 2


@pytest.mark.parametrize(
    ("signals", "mode", "lamp"),
    [(0, "MDI", 3), (1, "MEM", 5), (3, "EDIT", 6), (4, "HND", 1), (5, "JOG", 2), (6, "T_JOG", 2), (0x85, "REF", None),
     (0x21, "RMT", 4)],
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_statinfo")
def test_mode_signals_select_the_mode(signals: int, mode: str, lamp: int | None) -> None:
    control = PowerMate()
    library, handle = at(control)
    write(library, handle, G, 43, 0x03)
    write(library, handle, G, 43, signals)
    assert control.mode is PowerMateMode[mode]
    assert read(library, handle, G, 43) == [signals]
    lamps = read(library, handle, F, 3)[0] & 0x7F
    assert lamps == (0 if lamp is None else 1 << lamp)
    assert library.cnc_statinfo(handle)[1].aut == int(PowerMateMode[mode])


def test_start_hold_and_reset_signals() -> None:
    control = PowerMate()
    library, handle = at(control)
    control.programs.memory.create("O0004", b"O0004\nG1 X80. F600\n")
    control.select_program(4)
    write(library, handle, G, 7, 4)
    assert control.status().channel.run_state is RunState.READY
    write(library, handle, G, 7, 0)
    control.advance(50)
    assert (control.control.channels[0].run_state, read(library, handle, F, 0)[0] & 0xB0) == (
        RunState.ACTIVE,
        0xA0,
    )
    write(library, handle, G, 8, 0x10)  # *SP
    control.advance(300)
    assert (control.control.channels[0].run_state, read(library, handle, F, 0)[0] & 0xB0) == (
        RunState.HOLD,
        0x90,
    )
    held = control.positions.read()[0].machine
    write(library, handle, G, 7, 4)
    write(library, handle, G, 7, 0)
    control.advance(300)
    assert control.positions.read()[0].machine == held
    write(library, handle, G, 8, 0x30)
    write(library, handle, G, 7, 4)
    write(library, handle, G, 7, 0)
    control.advance(100)
    assert control.positions.read()[0].machine > held
    write(library, handle, G, 8, 0xB0)  # ERS
    assert control.control.status().channel.run_state is RunState.RESET


def test_switches_and_keys_are_signals() -> None:
    control = PowerMate()
    library, handle = at(control)
    write(library, handle, G, 44, 1)
    write(library, handle, G, 46, 0x82 | 0x50)
    switches = control.control.switches
    assert (switches.single_block, switches.dry_run, switches.block_delete) == (True, True, frozenset({1}))
    assert control.state.protection_keys == {1, 3}
    assert read(library, handle, F, 4) == [0x09]
    control.control.set_switches(single_block=False)
    assert read(library, handle, G, 46) == [0x80 | 0x50]


def test_the_pmc_ends_a_function() -> None:
    control = PowerMate(script={(Function.M, 300): Answer(after_s=None)})
    library, handle = at(control)
    control.programs.memory.create("O0004", b"O0004\nM300\nG1 X80. F600\n")
    control.select_program(4)
    control.cycle_start()
    control.advance(20)
    assert read(library, handle, F, 7) == [1]
    assert read(library, handle, F, 10, 13) == [300 & 0xFF, 300 >> 8, 0, 0]
    write(library, handle, G, 4, 8)
    control.advance(20)
    assert read(library, handle, F, 7) == [0]
    assert control.positions.read()[0].machine > 0


def test_jog_keys_and_a_servo_that_is_off() -> None:
    control = PowerMate()
    library, handle = at(control)
    write(library, handle, G, 43, 5)
    write(library, handle, G, 102, 2)
    control.advance(200)
    assert read(library, handle, F, 102) == [2]
    assert read(library, handle, F, 106) == [2]
    write(library, handle, G, 126, 2)
    control.advance(300)
    assert read(library, handle, F, 102) == [0]
    there = control.positions.read()[1].machine
    assert there < 0
    write(library, handle, G, 102, 0)
    write(library, handle, G, 102, 2)
    control.advance(300)
    assert control.positions.read()[1].machine == there
