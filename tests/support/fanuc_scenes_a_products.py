"""Scenes of a Power Mate's functions, every argument beside every other: ends of ranges, one beyond, what refuses."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import count as count_from
from itertools import product
from typing import Any
from zlib import crc32

from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.fanuc.data._parameter_rows import parameter_rows
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW
from support.fanuc_scenes_a import POSITIONS, Bench, numbers, registered, runs, short, stream
from support.fanuc_scenes_a_data import packed
from support.power_mate import psd

LOW, HIGH = -0x8000, 0x7FFF
LISTED = 12  # of more rows there are the first, the last and a sum of all
Make = Callable[..., tuple[Any, ...]]


def _told(b: Bench, name: str, given: tuple[Any, ...]) -> tuple[str, int]:
    """Return the code of a call, and a sum of what it returned or, of one that writes, of what is read afterwards."""
    answer = getattr(fwlib, f"cnc_{name}")(b.handle, *given)
    code, rest = (answer[0], answer[1:]) if isinstance(answer, tuple) else (answer, ())
    if code != EW.EW_OK:
        return short(code), 0
    rest = rest or (_left(b, name, given),)
    return short(code), crc32(repr(rest).encode())


def _left(b: Bench, name: str, given: tuple[Any, ...]) -> str:
    """Return what is read of all that a call may have written."""
    if name in ("wrtofs", "wrtofsr"):
        return numbers(b.get("cnc_rdtofsr", 1, 0, b.device.tool_offsets.count, HIGH).u.m_ofs)
    if name == "wrmacro":
        return repr(b.get("cnc_rdmacro", given[0], 10))
    if name == "wrmacror":
        return repr(b.get("cnc_rdmacror", given[1].datano_s, given[1].datano_e, HIGH))
    if name in ("wrparam", "wrparas", "wrsets"):
        number = given[1].datano if name == "wrparam" else int.from_bytes(given[1][:2], "little", signed=True)
        axis = ALL_AXES if parameter_rows()[number].per_axis else 0
        code, record = fwlib.cnc_rdparam(b.handle, number, axis, 28)
        return f"{code} {record!r}"
    return ""


def _product(b: Bench, name: str, *values: Iterable[Any], make: Make = lambda *given: given) -> None:
    """Call a function with all arguments, and write each row of the last one down; equal rows beside each other."""
    *firsts, last = (tuple(each) for each in values)
    found: dict[str, list[str]] = {}
    total = 0
    for row in product(*firsts):
        answers = [_told(b, name, make(*row, each)) for each in last]
        cells = [code for code, _ in answers]
        total = crc32(repr(answers).encode(), total)
        text = cells[0] if len({*cells}) == 1 else " ".join(cells)
        found.setdefault(text, []).append(" ".join(map(str, row)))
    b.say(f"{name}, last {' '.join(map(str, last))}; sum of all that was returned {total:08x}")
    for text, rows in found.items():
        listed = rows if len(rows) <= LISTED else [*rows[:3], "...", *rows[-3:]]
        b.say(f"  {text}: {len(rows)}, sum {crc32('; '.join(rows).encode()):08x}: {'; '.join(listed)}")


def products(b: Bench) -> None:
    """Tool offsets, macro variables, parameters, programs: the code of each argument beside each other."""
    for keys in ({"axes": 3}, {"model": "D", "axes": 1, "offsets": 32, "options": ("custom_macro",)}):
        b.title(f"{keys}")
        b.control(**keys)
        _axes(b)
        _offsets(b)
        _macros(b)
        _parameters(b)
        _programs(b)


def _offsets(b: Bench) -> None:
    count = b.device.tool_offsets.count
    ends = (LOW, -2, -1, 0, 1, 2, count, count + 1, 257, HIGH)
    kinds = (LOW, -2, -1, 0, 1, 256)
    _product(b, "rdtofs", ends, kinds, (LOW, -1, 0, 7, 8, 9, HIGH))
    _product(b, "wrtofs", ends, kinds, (7, 8), (0, 5, 999999, 1000000, -999999, -1000000))
    _product(
        b,
        "rdtofsr",
        (-1, 0, 1, 2, count, count + 1),
        kinds,
        (-1, 0, 1, 2, count, count + 1),
        (0, 9, 10, 14, 6 + 4 * count, HIGH),
    )

    serial = count_from(-400)

    def record(first: int, last: int, kind: int, length: int, value: int) -> tuple[Any, ...]:
        made = fwlib.IODBTO(datano_s=first, datano_e=last, type=kind)
        made.u.m_ofs[0], made.u.m_ofs[1] = next(serial), value
        return length, made

    _product(
        b,
        "wrtofsr",
        (-1, 0, 1, count - 1, count),
        (0, 1, 2, count, count + 1),
        kinds,
        (9, 10, 13, 14, HIGH),
        (0, 1000000),
        make=record,
    )


def _axes(b: Bench) -> None:
    m, most = b.device.axes, b.device.max_axis
    axes = (LOW, -255, -2, -1, 0, 1, m, m + 1, most, most + 1, 255, 256, 257, 256 + m, HIGH)
    registered(b.device, O7=f";G90G54G1{b.device.machine.config.axis_names[-1]}-7.25F3000;M30")
    b.device.select_program(7)
    b.device.cycle_start()
    b.device.advance(90)
    for name in POSITIONS:
        _product(b, name, axes, (LOW, 0, 7, 8, 3 + 4 * m, 4 + 4 * m, HIGH))
    _product(b, "rddynamic", axes, (37, 38, 21 + 16 * most, 22 + 16 * most, HIGH))
    serial = count_from(-50_000, 777)

    def preset(axis: int, length: int) -> tuple[Any, ...]:
        return length, fwlib.IDBWRR(type=axis, datano=9, data=[next(serial) for _ in range(6)])

    _product(b, "wrrelpos", axes, (7, 8, 3 + 4 * m, 4 + 4 * m), make=preset)
    b.say(f"then {numbers(b.get('cnc_relative', ALL_AXES, 28).data)}")


def _macros(b: Bench) -> None:
    ends = (-1, 0, 1, 33, 34, 99, 100, 149, 150, 199, 200, 499, 500, 531, 532, 699, 700, 999, 1000, HIGH)
    for kind in (0, 1):
        b.code("cnc_setmactype", kind)
        b.say(f"number form {kind}")
        _product(b, "rdmacro", ends, (LOW, 0, 9, 10, 11, HIGH))
        _product(b, "rdmacror", (2, 7, 101, 501), (5, 33, 120, 503), (HIGH,))
        _product(b, "rdmacror", ends, ends, (11, 12, 18, 6 + 6 * 500))
        _product(
            b, "wrmacro", (0, 33, 100, 999, 1000), (9, 10),
            (0, -1, 1, 99999999, 100000000, -99999999, -100000000, 0x7FFFFFFF),
            (LOW, -129, -128, -2, -1, 0, 1, 8, 9, 127, 128, HIGH),
        )  # fmt: skip

        def record(first: int, last: int, length: int, mantissa: int, decimals: int) -> tuple[Any, ...]:
            made = fwlib.IODBMR(datano_s=first, dummy=7, datano_e=last)
            (
                made.data[min(1, max(0, last - first))].mcr_val,
                made.data[min(1, max(0, last - first))].dec_val,
            ) = mantissa, decimals
            return length, made

        _product(
            b, "wrmacror", (0, 33, 100, 149, 300, 999), (33, 100, 149, 150, 301, 999, 1000), (11, 12, 18, 5000),
            (0, 5, 100000000), (-2, -1, 0, 8, 9),
            make=record,
        )  # fmt: skip
    b.code("cnc_setmactype", 0)


def _one_of_each() -> list[int]:
    """Return a number of each kind of parameter, with axes and without, and those that are read or written only."""
    kinds: dict[tuple[Any, ...], int] = {}
    for row in parameter_rows().values():
        kinds.setdefault((row.kind, row.per_axis, row.attributes, row.option), row.number)
    return [*kinds.values()]


def _parameters(b: Bench) -> None:
    most, rows = b.device.max_axis, parameter_rows()
    numbers = (-1, 2, *_one_of_each(), 8023, HIGH)
    axes = (LOW, -2, ALL_AXES, 0, 1, b.device.axes, b.device.axes + 1, most, most + 1, 255, 257)
    lengths = (LOW, 0, 4, 5, 6, 7, 8, 4 + most, 4 + 2 * most, 3 + 4 * most, 4 + 4 * most, HIGH)
    _product(b, "rdparam", numbers, axes, lengths)

    def one(number: int, axis: int, length: int, above: int) -> tuple[Any, ...]:
        row = rows.get(number)
        value = (
            0
            if row is None
            else row.low
            if above is LOW
            else min(row.high + 1, 0x7FFFFFFF)
            if above
            else row.default
        )
        bits = 8 if row is None else 8 * row.kind.size
        signed = (value + (1 << bits - 1)) % (1 << bits) - (1 << bits - 1)
        member = "cdatas" if row is None else ("cdatas", "cdatas", "idatas", "ldatas")[row.kind]
        return length, psd(number, axis, **{member: [signed] * most})

    wanted = [number for number in numbers if number not in rows or "P" not in str(rows[number].attributes)]
    _product(b, "wrparam", wanted, axes, (0, 4, 5, 6, 8, HIGH), (0, 1, LOW), make=one)
    _product(
        b,
        "rdparar",
        rows,
        (ALL_AXES, 0, 1, most),
        (HIGH,),
        make=lambda number, axis, length: (number, axis, number, length),
    )
    _product(
        b,
        "rdsetr",
        rows,
        (ALL_AXES, 0, 1, most),
        (HIGH,),
        make=lambda number, axis, length: (number, axis, number, length),
    )
    ends = (-1, 0, 1, 12, 20, 100, 1300, 1320, 1321, 6711, 8022, 8023, HIGH)
    for name in ("rdparar", "rdsetr"):
        _product(
            b,
            name,
            ends,
            axes,
            ends,
            (5, 6, 16, 24, HIGH),
            make=lambda first, axis, last, length: (first, axis, last, length),
        )
    _product(b, "rdparainfo", (LOW, -1, *range(30), *range(1000, 8024, 61), HIGH), (0, 1, 2, 0xFFFF))

    serial = count_from(70)

    def records(number: int, axis: int, other: int, cut: int) -> tuple[Any, ...]:
        data = b""
        for each in (number, other):
            row = rows.get(each)
            form = "b" if row is None else "bbhi"[row.kind]
            many = most if row is not None and row.per_axis and axis == 0xFF else 1
            value = 1 if row is None else row.default if row.kind else next(serial) % 256 - 128
            data += packed(each, axis if each == number else 0, form, *[value] * many)
        return len(data) - cut, data

    for name in ("wrparas", "wrsets"):
        _product(
            b, name, wanted, (0, 1, most, most + 1, 0xFE, 0xFF), (20, 6711, 3281), (0, 1, 2, -1), make=records
        )


def _programs(b: Bench) -> None:
    device = b.control(axes=b.device.axes, model=b.device.model)
    registered(device, O1=";N5G4;M30", O9999="(LAST);N5G4;N99999M30")
    numbers = (LOW, -9999, -1, 0, 1, 2, 257, 9998, 9999, 10000, 10001, HIGH)
    _product(b, "rdprogdir", range(-1, 4), numbers, numbers, (LOW, 0, 1, HIGH))
    _product(b, "rdproginfo", (LOW, -1, 0, 1, 2, HIGH), (LOW, -1, *range(10, 34), HIGH))
    b.say(f"upload of {runs((n, _upload(b, n)) for n in numbers)}")
    for mode in ("MEM", "EDIT", "JOG"):
        for selected in (0, 1, 9999):
            device.select_mode("MEM")
            device.programs.unselect()
            if selected:
                device.select_program(selected)
            device.select_mode(mode)
            codes = {
                name: runs(
                    (n, b.cell(f"cnc_{name}", n))
                    for n in (-0x80000000, -5, -1, 0, 1, 5, 6, 99999, 100005, 65541, 0x7FFFFFFF)
                )
                for name in ("seqsrch", "wrmdipntr")
            }
            ends = f"rewind {b.cell('cnc_rewind')}, delete {b.cell('cnc_delete', selected)}"
            b.say(f"{mode}, O{selected} selected: {codes}, {ends}")
            found = runs((n, f"{b.cell('cnc_search', n)} O{device.programs.selected}") for n in numbers)
            b.say(f"  search {found}")
            registered(
                device,
                **({} if 1 in device.programs else {"O1": ";N5G4;M30"}),
                **({} if 9999 in device.programs else {"O9999": ";N5G4;M30"}),
            )
    device.select_mode("MDI")
    text = stream("O1", "N7G4", "M30") + b" " * 300
    for number in (LOW, -1, 0, 1, 16, 17, 18, 199, 200, 256, HIGH):
        code = b.cell("cnc_wrmdiprog", number, text)
        pointers = runs((n, b.cell("cnc_wrmdipntr", n)) for n in range(-1, 4))
        b.say(f"MDI, {number} characters: {code} of {len(device.state.mdi.blocks)}, pointers {pointers}")
    device.select_mode("MEM")
    for piece in (b"", b"\n", b"\nO77\nM30\n%", b"\n" * 256, b"\n" * 257):
        cells = []
        for number in (LOW, -1, 0, 1, 9, 10, 255, 256, 257, HIGH):
            b.code("cnc_dwnstart")
            cells.append(f"{number} {b.cell('cnc_download', piece, number)} {b.cell('cnc_dwnend')}")
            b.remove(77)
        b.say(f"download of {len(piece)}: {', '.join(cells)}")
    assert b.code("cnc_upload", 1) == EW.EW_FUNC


def _upload(b: Bench, number: int) -> str:
    code, *pieces = b.cell("cnc_upstart", number), *(b.cell("cnc_upload", n) for n in (0, 1, 0xFFFF))
    return f"{code} {' '.join(pieces)} {b.cell('cnc_upend')}"
