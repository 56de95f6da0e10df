"""Scenes of a Power Mate's data files: tool offsets, parameters, settings, macro variables; and of handles."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.data._parameter_rows import ParameterRow, parameter_rows
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW
from support.fanuc_scenes_a import Bench, numbers, registered, runs, short, shown, stream
from support.power_mate import psd

LARGEST = 0x7FFFFFFF

# ---------------------------------------------------------------------- tool offsets


def _offsets(first: int, last: int, kind: int, values: Iterable[int], by: str = "m_ofs") -> Any:
    record = fwlib.IODBTO(datano_s=first, datano_e=last, type=kind)
    for k, value in enumerate(values):
        getattr(record.u, by)[k] = value
    return record


def offsets(b: Bench) -> None:
    """Tool offsets: numbers, kinds, lengths, the largest in each unit, ranges, and what programs make of them."""
    b.title("numbers, kinds and lengths")
    for count in (99, 32):
        b.control(offsets=count)
        b.call("cnc_rdtofsinfo")
        for name, rest in (("rdtofs", ()), ("wrtofs", (77,))):
            b.say(
                f"{name}, {count} offsets: {runs((n, b.cell(f'cnc_{name}', n, 0, 8, *rest)) for n in range(-2, count + 3))}"
            )
            b.say(f"  type {runs((n, b.cell(f'cnc_{name}', 2, n, 8, *rest)) for n in range(-2, 4))}")
            b.say(f"  length {runs((n, b.cell(f'cnc_{name}', 2, 0, n, *rest)) for n in range(-1, 11))}")
        for first, last in (
            (0, 5),
            (1, 0),
            (1, 1),
            (1, 2),
            (5, 3),
            (2, count),
            (count, count),
            (1, count),
            (2, count + 1),
            (count + 1, count + 1),
            (-1, 1),
            (3, -1),
        ):
            size = 6 + 4 * (last - first + 1)
            read = [
                f"{n} {b.cell('cnc_rdtofsr', first, 0, last, n)}" for n in (0, 9, 10, size - 1, size, 0x7FFF)
            ]
            written = [
                f"{n} {b.cell('cnc_wrtofsr', n, _offsets(first, last, 0, [77] * 9))}"
                for n in (0, 9, 10, size - 1, size, 0x7FFF)
            ]
            b.say(f"{first} to {last}: {', '.join(read)}; write {', '.join(written)}")
        for kind in range(-3, 4):
            b.say(
                f"type {kind}: {b.cell('cnc_rdtofsr', 1, kind, 3, 18)}, write {b.cell('cnc_wrtofsr', 18, _offsets(1, 3, kind, (7, 8, 9)))}"
            )
    b.title("the largest")
    for keys in ({"increment": "IS-A"}, {"increment": "IS-B"}, {"increment": "IS-C", "model": "D"}):
        for inch in (False, True):
            device = b.control(inch_input=inch, **keys)
            limit = {"A": 99_999, "B": 999_999, "C": 9_999_999}[keys["increment"][-1]]
            codes = [
                f"{value} {b.cell('cnc_wrtofs', 99, 0, 8, value)} {b.get('cnc_rdtofs', 99, 0, 8).data}"
                for value in (limit - 1, limit, limit + 1, -limit, -limit - 1, LARGEST, -LARGEST - 1, 1, -1)
            ]
            b.say(f"{keys['increment']} {'inch' if inch else 'mm'}: {', '.join(codes)}")
            written = b.cell("cnc_wrtofsr", 22, _offsets(2, 5, -1, (11, -limit, limit, 14), "m_ofs_a"))
            refused = b.cell("cnc_wrtofsr", 22, _offsets(2, 5, 0, (1, 2, limit + 1, 4)))
            b.say(f"  {written} {refused} {numbers(b.get('cnc_rdtofsr', 1, 0, 6, 30).u.m_ofs)}")
            device.parameters.set(0, 0 if inch else 4)
            b.say(
                f"  in {'mm' if inch else 'inch'} then {numbers(b.get('cnc_rdtofsr', 1, -1, 6, 30).u.m_ofs_a)}"
            )
    b.title("all of them at once, and the halves")
    b.control()
    b.say(b.cell("cnc_wrtofsr", 402, _offsets(1, 99, -1, (7 * k - 350 for k in range(99)), "m_ofs_a")))
    b.say(numbers(b.get("cnc_rdtofsr", 1, 0, 99, 402).u.m_ofs))
    b.say(" ".join(str(b.get("cnc_rdtofs", number, 0, 8).data) for number in range(1, 100)))
    b.say(numbers(b.get("cnc_rdtofsr", 50, -1, 99, 402).u.m_ofs_a))
    b.title("as tool length of a program, changed while it runs, after switching off")
    device = b.control()
    registered(device, O7=";G43H99Z1.;G4P20;G43H1Z1.;G44H99Z1.;G49Z1.;G43H2Z0;M30")
    b.code("cnc_wrtofs", 99, 0, 8, 12345)
    b.code("cnc_wrtofs", 1, 0, 8, -700)
    device.select_program(7)
    device.control.set_switches(single_block=True)
    b.look(data=True)
    for k in range(8):
        b.say("> start")
        device.cycle_start()
        device.advance(900)
        b.look()
        if k == 2:
            b.code("cnc_wrtofs", 1, 0, 8, -800)
    device.power_cycle()
    b.look(data=True)


# ---------------------------------------------------------------------- parameters

_MEMBER = ("cdata", "cdata", "idata", "ldata")


def _psd(row: ParameterRow, axis: int, *values: int) -> Any:
    bits = 8 * row.kind.size
    signed = [(value + (1 << bits - 1)) % (1 << bits) - (1 << bits - 1) for value in values]
    return psd(row.number, axis, **{f"{_MEMBER[row.kind]}s": signed})


def _read(b: Bench, row: ParameterRow, axis: int) -> str:
    record = b.get("cnc_rdparam", row.number, axis, 28)
    if (record.datano, record.type) != (row.number, axis):
        return f"{record.datano} {record.type}!"
    member = _MEMBER[row.kind]
    return numbers(getattr(record.u, f"{member}s")) if axis == ALL_AXES else str(getattr(record.u, member))


def _parameter(b: Bench, row: ParameterRow) -> Iterator[str]:
    """Yield what one parameter is, how it is read, and both ends of what it takes."""
    axes = b.device.axes
    info = b.get("cnc_rdparainfo", row.number, 1)
    yield f"type {info.info[0].prm_type:#05x}, before {info.prev_no}, after {info.next_no}"
    sizes = [row.kind.size * each for each in (1, axes)]
    yield "read " + " ".join(
        b.cell("cnc_rdparam", row.number, axis, 4 + size)
        for axis in (-2, -1, 0, 1, axes, axes + 1, b.device.max_axis, b.device.max_axis + 1)
        for size in (sizes[axis == ALL_AXES],)
    )
    yield "too short " + " ".join(
        b.cell("cnc_rdparam", row.number, axis, 3 + sizes[axis == ALL_AXES]) for axis in (-1, 0, axes)
    )
    places = (1, axes, ALL_AXES) if row.per_axis else (0,)
    readable = b.code("cnc_rdparam", row.number, places[0], 28) == EW.EW_OK
    if readable:
        yield "is " + " | ".join(_read(b, row, axis) for axis in places)
    step = 1 if row.per_axis else 0
    for words, value in (
        ("low", row.low),
        ("below", row.low - 1),
        ("high", row.high),
        ("above", row.high + 1),
    ):
        code = b.cell("cnc_wrparam", 28, _psd(row, axes * step, value))
        yield f"{words} {code} {_read(b, row, places[-1]) if readable else ''}".rstrip()
    if row.per_axis:
        every = b.cell("cnc_wrparam", 4 + sizes[1], _psd(row, -1, *(row.high - k for k in range(axes))))
        wrong = b.cell("cnc_wrparam", 4 + sizes[1], _psd(row, -1, *[row.high] * (axes - 1), row.high + 1))
        yield f"all {every} {wrong} {_read(b, row, ALL_AXES)}"
    yield "write " + " ".join(
        b.cell("cnc_wrparam", 28, _psd(row, axis, row.default))
        for axis in (-2, -1, 0, 1, axes, axes + 1, b.device.max_axis, b.device.max_axis + 1)
    )
    yield f"too short {b.cell('cnc_wrparam', 3 + sizes[0], _psd(row, places[0], row.default))}"
    alarm = b.get("cnc_rddynamic", 1, 38).alarm
    if alarm:
        yield f"alarm {alarm:#x}"


def parameters(b: Bench) -> None:
    """Every parameter: attributes, neighbours, axes, lengths, both ends of its range and one beyond."""
    b.title("each parameter; axes -2 -1 0 1 3 4 6 7, values of axis 1 | 3 | all")
    for row in parameter_rows().values():
        b.control()
        b.say(f"{row.number}: {'; '.join(_parameter(b, row))}")
    b.title("numbers that are none")
    b.control()
    found: dict[str, list[int]] = {}
    for number in (
        -0x8000,
        -1,
        *(each + 1 for each in parameter_rows() if each + 1 not in parameter_rows()),
        0x7FFF,
    ):
        codes = f"{b.cell('cnc_rdparam', number, 0, 28)} {b.cell('cnc_wrparam', 28, psd(number))}"
        found.setdefault(codes, []).append(number)
    for codes, which in found.items():
        b.say(f"{codes}: {' '.join(map(str, which))}")
    b.title("which there are")
    for start, count in (
        (0, 0),
        (0, 1),
        (0, 5),
        (1, 3),
        (2, 3),
        (6089, 3),
        (8010, 5),
        (8022, 1),
        (8023, 1),
        (-1, 3),
        (-0x8000, 1),
        (0x7FFF, 1),
        (1320, 0xFFFF),
        (0, 0xFFFF),
    ):
        code, record = fwlib.cnc_rdparainfo(b.handle, start, count)
        listed = (
            " ".join(f"{each.prm_no}:{each.prm_type:#x}" for each in record.info) if code == EW.EW_OK else ""
        )
        told = f"{record.info_no} before {record.prev_no} after {record.next_no}, {len(bytes(record))} bytes: {listed}"
        b.say(f"from {start}, {count}: {short(code)} {told if code == EW.EW_OK else ''}".rstrip())


def _record(number: int, kind: int, form: str, *values: int) -> bytes:
    data = struct.pack(f"<hH{len(values)}{form}", number, kind, *values)
    return data + bytes(len(data) % 2)


def _range(b: Bench, name: str, first: int, axis: int, last: int, length: int) -> str:
    code, begin, end, size, data = getattr(fwlib, f"cnc_{name}")(b.handle, first, axis, last, length)
    if code != EW.EW_OK:
        return short(code)
    assert size == len(data)
    return f"OK {begin} to {end}, {size}: {data.hex(' ', -2)}"


def ranges(b: Bench) -> None:
    """Ranges of parameters and of settings as records: bytes, axes, lengths, order, refusals, protection."""
    for keys in ({"axes": 3}, {"model": "D"}):
        device = b.control(**keys)
        b.title(f"read, Power Mate-{device.model}, {device.axes} axes")
        for number, axis, value in (
            (1320, 2, -123456),
            (1620, 1, 300),
            (12, 2, -127),
            (6711, 0, 70000),
            (6080, 0, 96),
            (1300, 0, -128),
            (1825, 2, 9999),
        ):
            row = parameter_rows()[number]
            assert b.code("cnc_wrparam", 28, _psd(row, axis, value)) == EW.EW_OK
        for name, first, last in (
            ("rdparar", 0, 20), ("rdparar", 1020, 1020), ("rdparar", 1300, 1320), ("rdparar", 1410, 1420), ("rdparar", 1620, 1825),
            ("rdparar", 3210, 3211), ("rdparar", 3210, 3210), ("rdparar", 6080, 6089), ("rdparar", 6711, 6711), ("rdparar", 8010, 9999),
            ("rdparar", 8023, 9999), ("rdparar", 21, 99), ("rdparar", 100, 20), ("rdparar", -1, 20), ("rdparar", -5, -1),
            ("rdsetr", 0, 20), ("rdsetr", 1, 12), ("rdsetr", 12, 12), ("rdsetr", 6700, 6712), ("rdsetr", 1000, 6000), ("rdsetr", 6758, 9999), ("rdsetr", -1, 0),
        ):  # fmt: skip
            for axis in (-2, -1, 0, 1, device.axes, device.max_axis, device.max_axis + 1):
                b.say(f"{name} {first} to {last}, axis {axis}: {_range(b, name, first, axis, last, 0x7FFF)}")
        b.say("lengths:")
        for name, first, axis, last in (
            ("rdparar", 1320, -1, 1320),
            ("rdparar", 1320, 1, 1321),
            ("rdparar", 6080, 0, 6082),
            ("rdsetr", 6711, 0, 6711),
            ("rdsetr", 12, -1, 12),
        ):
            size = int(_range(b, name, first, axis, last, 0x7FFF).split(", ")[1].split(":")[0])
            cells = (
                f"{n} {_range(b, name, first, axis, last, n)[:4]}"
                for n in (-1, 0, 5, 6, size - 1, size, size + 1)
            )
            b.say(f"  {name} {first} to {last} of axis {axis}: {', '.join(cells)}")
    _written_ranges(b)


def _written_ranges(b: Bench) -> None:
    b.title("write: codes of wrparas and of wrsets, what has changed")
    cases = (
        ("one word", _record(3281, 0, "b", 5)),
        ("a setting", _record(6711, 0, "i", 77)),
        ("a setting of an axis", _record(12, 2, "b", 5)),
        ("settings in their order", _record(20, 0, "b", 3) + _record(6711, 0, "i", 1) + _record(6712, 0, "i", -0)),
        ("settings in another order", _record(6712, 0, "i", 3) + _record(6711, 0, "i", 1)),
        ("one twice", _record(6711, 0, "i", 3) + _record(6711, 0, "i", 4)),
        ("all axes", _record(1320, 0xFF, "i", 10, 20, 30, 40, 50, 60)),
        ("all axes, too few", _record(1320, 0xFF, "i", 10, 20, 30)),
        ("axis 3", _record(1320, 3, "i", -9)),
        ("axis 4", _record(1320, 4, "i", -9)),
        ("axis 6", _record(1320, 6, "i", -9)),
        ("axis 7", _record(1320, 7, "i", -9)),
        ("axis 0 of one with axes", _record(1320, 0, "i", -9)),
        ("axis 1 of one without", _record(6711, 1, "i", 9)),
        ("all axes of one without", _record(6711, 0xFF, "i", 9)),
        ("with its attribute", _record(6711, 0x300, "i", 9)),
        ("with another attribute", _record(6711, 0x100, "i", 9)),
        ("out of range in the second", _record(20, 0, "b", 9) + _record(6713, 0, "i", 1000000)),
        ("protected in the second", _record(20, 0, "b", 9) + _record(1010, 0, "b", 3)),
        ("not readable", _record(3210, 0, "i", 9)),
        ("none of this number", _record(21, 0, "b", 9)),
        ("not a setting in the second", _record(20, 0, "b", 9) + _record(3281, 0, "b", 9)),
        ("without the byte that makes it even", _record(20, 0, "b", 9)[:-1]),
        ("a byte too few", _record(6711, 0, "i", 9)[:-1]),
        ("a header alone", _record(6711, 0, "h", 9)[:4]),
        ("a word behind", _record(6711, 0, "i", 9) + b"\0\0"),
        ("nothing", b""),
        ("M codes of macros", b"".join(_record(6080 + k, 0, "b", 50 + k) for k in range(10))),
    )  # fmt: skip
    for words, data in cases:
        cells, changed = [], []
        for name in ("wrparas", "wrsets"):
            b.control()
            before = _dump(b)
            cells.append(b.cell(f"cnc_{name}", len(data), data))
            changed.append(
                " ".join(f"{number} {after}" for number, after in _dump(b).items() if before[number] != after)
                or "nothing"
            )
        b.say(
            f"{words}: {' '.join(cells)}; {changed[0] if changed[0] == changed[1] else ' | '.join(changed)}"
        )
    part = _record(6711, 0, "i", 9)
    b.say(f"lengths: {runs((n, b.cell('cnc_wrparas', n, part)) for n in range(-1, 10))}")
    b.title("six axes, a value of its own on each, of each kind")
    for number, values in (
        (12, (1, -2, 3, -128, 127, 6)),
        (1022, (1, 2, 3, 4, 5, 6)),
        (1620, (10, 20, 30, 400, 50, 4000)),
        (1851, (1, -2, 300, -4000, 5, -9999)),
        (1321, (-1, 20, -300, 4000, -50000, 600000)),
    ):
        b.control(axes=6)
        row = parameter_rows()[number]
        size = row.kind.size
        written = [b.cell("cnc_wrparam", 4 + size, _psd(row, k, value)) for k, value in enumerate(values, 1)]
        alone = " ".join(_read(b, row, axis) for axis in range(1, 7))
        b.say(
            f"{number}: {' '.join(written)}; {alone} | {_read(b, row, ALL_AXES)} | {_range(b, 'rdparar', number, -1, number, 99)}"
        )
        b.code("cnc_wrparam", 4 + 6 * size, _psd(row, -1, *values[::-1]))
        b.say(
            f"  {_read(b, row, ALL_AXES)} | {' '.join(_range(b, 'rdparar', number, axis, number, 99)[14:] for axis in range(1, 7))}"
        )
    b.title("options and protection")
    b.control(options=())
    for data in (
        _record(6711, 0, "i", 5) + _record(8010, 1, "b", 1),
        _record(6080, 0, "b", 5) + _record(6711, 0, "i", 5),
    ):
        b.say(
            f"one of two needs an option: {b.cell('cnc_wrparas', len(data), data)}, {b.get('cnc_rdparam', 6711, 0, 8).u.ldata}"
        )
    for options in ((), ("custom_macro",), ("pmc_axis",), ("custom_macro", "pmc_axis")):
        b.control(options=options)
        asked = (f"{number} {_three_ways(b, number)}" for number in (6000, 6080, 8010, 8022, 6711, 1300))
        b.say(f"{' '.join(options) or 'no options'}: {', '.join(asked)}")
    for writable in (False, True):
        b.control().state.parameters_writable = writable
        asked = (f"{number} {_three_ways(b, number)}" for number in (6080, 6711, 12, 1010, 1300, 3210))
        b.say(f"{'writable' if writable else 'not writable'}: {', '.join(asked)}")


def _three_ways(b: Bench, number: int) -> str:
    row = parameter_rows()[number]
    axis = int(row.per_axis)
    record = _record(number, axis, "bbhi"[row.kind], max(row.low, min(row.high, 1)))
    cells = (
        b.cell("cnc_wrparam", 28, _psd(row, axis, max(row.low, min(row.high, 1)))),
        b.cell("cnc_wrparas", len(record), record),
        b.cell("cnc_wrsets", len(record), record),
    )
    return f"{' '.join(cells)} read {b.cell('cnc_rdparam', number, axis, 28)}"


def _dump(b: Bench) -> dict[int, str]:
    value = b.device.parameters.value
    return {
        number: " ".join(str(value(number, axis)) for axis in (range(1, 4) if row.per_axis else (0,)))
        for number, row in parameter_rows().items()
    }


def effects(b: Bench) -> None:
    """What parameters of the manual do: names of axes, stroke limits, macros of M codes, units; before and after power."""
    b.title("M codes of macros, 6080 to 6089")
    device = b.control()
    registered(device, **{f"O{9020 + k}": f";#{500 + k}=#{500 + k}+#24*10+{k + 1};M99" for k in range(10)})
    b.code("cnc_wrparas", 60, b"".join(_record(6080 + k, 0, "b", 30 + k * 7) for k in range(10)))
    registered(
        device,
        O7=";" + ";".join(f"M{30 + k * 7 if k else 30}X{k + 1}." for k in range(1, 10)) + ";M93X1.;M02",
    )
    device.select_program(7)
    device.cycle_start()
    device.advance(4000)
    b.look(data=True)
    b.title("names of axes, 1020")
    for values in ((89, 90, 88), (65, 66, 67), (88, 88, 90), (0, 32, 90), (85, 86, 87)):
        device = b.control()
        written = b.cell("cnc_wrparam", 7, psd(1020, -1, cdatas=values))
        before = device.machine.config.axis_names
        alarm = b.get("cnc_rddynamic", 1, 38).alarm
        device.power_cycle()
        b.say(
            f"{values}: {written}, {' '.join(before)} alarm {alarm:#x}, then {' '.join(device.machine.config.axis_names)} alarm {b.get('cnc_rddynamic', 1, 38).alarm:#x}"
        )
    b.title("stroke limits, 1320 and 1321, of each axis, either side")
    for axis in (1, 2, 3):
        for number, value, target in (
            (1320, 1500, 2),
            (1321, -1500, -2),
            (1320, 2000, 2),
            (1321, -2000, -2),
            (1320, -1, -1),
        ):
            device = b.control(rotary=(3,))
            registered(device, O7=f";G1{'XYA'[axis - 1]}{target}.F9000;M30")
            codes = f"{b.cell('cnc_wrparam', 8, psd(number, axis, ldata=value))}"
            device.select_program(7)
            device.cycle_start()
            device.advance(600)
            b.say(f"{number} of axis {axis} {value}: {codes}, {_stopped(b)}")
    b.title("limits on the other side of zero: from there to a target")
    for axis in (1, 3):
        for number, value, start, target in (
            (1320, -1500, -3, -1),
            (1320, -1500, -1, -3),
            (1321, 1500, 3, 1),
            (1321, 1500, 1, 3),
            (1320, 0, -1, 1),
            (1321, 0, 1, -1),
        ):
            device = b.control(axes=3)
            name = "XYZ"[axis - 1]
            registered(device, O7=f";G1{name}{start}.F9000;M30", O8=f";G1{name}{target}.F9000;M30")
            _run(device, 7)
            written = b.cell("cnc_wrparam", 8, psd(number, axis, ldata=value))
            _run(device, 8)
            b.say(f"{number} of axis {axis} {value}, {start} to {target}: {written}, {_stopped(b)}")
    b.title("units, 1001 and 1004, at once and after the power was off")
    for number, value in ((1004, 1), (1004, 2), (1004, 3), (1004, 4), (1001, 1), (1001, 2)):
        device = b.control()
        registered(device, O7=";G1X12.7F9000;M30")
        device.select_program(7)
        device.cycle_start()
        device.advance(600)
        places = [_places(b)]
        written = b.cell("cnc_wrparam", 5, psd(number, 0, cdata=value))
        places.append(_places(b))
        device.power_cycle()
        places.append(_places(b))
        b.say(f"{number} = {value}: {written}, {' then '.join(places)}")
    b.title("what outlasts the power")
    device = b.control()
    b.code("cnc_wrparam", 8, psd(1320, 2, ldata=5000))
    b.code("cnc_wrparam", 5, psd(6080, 0, cdata=44))
    b.code("cnc_wrtofs", 99, 0, 8, -5)
    b.code("cnc_wrmacro", 100, 10, 12, 1)
    b.code("cnc_wrmacro", 999, 10, -12, 1)
    b.look(data=True)
    b.do("off and on", device.power_cycle, data=True)
    b.do("reset", device.reset, data=True)


def _run(device: PowerMate, program: int) -> None:
    device.select_program(program)
    device.cycle_start()
    device.advance(900)


def _stopped(b: Bench) -> str:
    alarm = [f"{each.number} {each.text}" for each in b.device.control.alarms.active]
    machine, bits = numbers(b.get("cnc_machine", -1, 28).data), b.get("cnc_rddynamic", 1, 38).alarm
    return f"at {machine}, {', '.join(alarm) or 'no alarm'}, bits {bits:#x}"


def _places(b: Bench) -> str:
    return (
        " ".join(str(b.get(f"cnc_{name}", 1, 8).data[0]) for name in ("absolute", "machine", "relative"))
        + f" limit {b.cell('cnc_wrtofs', 1, 0, 8, 100000)}"
    )


# ---------------------------------------------------------------------- macro variables


def macros(b: Bench) -> None:
    """Macro variables: which there are, both forms of numbers, lengths, ranges, locals, programs, power."""
    for options in (
        (),
        ("macro_variables_300",),
        ("macro_variables_600",),
        ("macro_variables_300", "macro_variables_600"),
    ):
        b.control(options=("custom_macro", *options))
        b.title(f"which there are with {' and '.join(options) or 'none of the options'}")
        b.call("cnc_rdmacroinfo")
        edges = sorted(
            {
                each + k
                for each in (1, 33, 100, 149, 199, 500, 531, 699, 999, 1000, 2001, 4001, 5041)
                for k in (-1, 0, 1)
            }
        )
        b.say(f"read {runs((n, b.cell('cnc_rdmacro', n, 10)) for n in (-1, *edges, 0x7FFF))}")
        b.say(f"write {runs((n, b.cell('cnc_wrmacro', n, 10, 5, 0)) for n in (-1, *edges, 0x7FFF))}")
        for first, last in (
            (1, 33),
            (1, 34),
            (0, 1),
            (33, 33),
            (100, 149),
            (100, 150),
            (100, 199),
            (100, 200),
            (149, 500),
            (500, 531),
            (500, 532),
            (500, 699),
            (500, 700),
            (500, 999),
            (500, 1000),
            (33, 100),
            (5, 3),
            (501, 500),
        ):
            size = 6 + 6 * (last - first + 1)
            record = fwlib.IODBMR(datano_s=first, datano_e=last)
            b.say(
                f"{first} to {last}: read {_lengths(b, first, last, size)}; write {' '.join(b.cell('cnc_wrmacror', n, record) for n in (11, 12, size - 1, size, 0x7FFF))}"
            )
    b.say(
        f"lengths of one: {runs((n, b.cell('cnc_rdmacro', 500, n)) for n in range(-1, 13))}; {runs((n, b.cell('cnc_wrmacro', 500, n, 1, 1)) for n in range(-1, 13))}"
    )
    b.title("numbers that are written, and how they read in both forms")
    for kind in (0, 1, -1):
        b.control()
        b.call("cnc_getmactype")
        b.say(f"form {kind}: {b.cell('cnc_setmactype', kind)}")
        b.call("cnc_getmactype")
        for pair in (
            (0, -1), (0, 0), (1, -1), (-1, -1), (5, 0), (-5, 3), (1500, 3), (99999999, 0), (-99999999, 8), (100000000, 0), (-100000000, 1), (1, 8), (1, 9),
            (LARGEST, 0), (-LARGEST - 1, 31), (3, 127), (3, 128), (3, -127), (1, -128), (1, -129), (12300, 2), (0, 5),
        ):  # fmt: skip
            b.say(f"  {pair}: {b.cell('cnc_wrmacro', 500, 10, *pair)}, {_pairs(b, 500)}")
    b.title("numbers of programs, in both forms")
    device = b.control()
    for value in (
        None,
        0.0,
        1.0,
        -1.5,
        0.1,
        1 / 3,
        1e-8,
        4e-9,
        5e-9,
        123456.789,
        12345678.5,
        99999999.0,
        99999999.4,
        99999999.5,
        1e8,
        -1e9,
        1e38,
        1e-40,
        2.0**31,
        -(2.0**-120),
    ):
        device.macros.set(501, value)
        b.say(f"{value}: {_pairs(b, 501)}")
    b.title("ranges: all or none")
    record = fwlib.IODBMR(datano_s=510, datano_e=512)
    for values in (
        ((1, 1), (2, 2), (3, 3)),
        ((4, 0), (5, 9), (6, 0)),
        ((0, -1), (-7, 8), (0, -1)),
        ((8, 0), (9, 0), (1, -1)),
    ):
        for entry, (mantissa, decimals) in zip(record.data, values, strict=False):
            entry.mcr_val, entry.dec_val = mantissa, decimals
        b.say(f"{values}: {b.cell('cnc_wrmacror', 24, record)}")
        b.call("cnc_rdmacror", 509, 513, 36)
    b.title("the largest range")
    b.control()
    record = fwlib.IODBMR(datano_s=500, datano_e=999)
    for k, entry in enumerate(record.data):
        entry.mcr_val, entry.dec_val = (k - 250) * 11, k % 9
    b.say(b.cell("cnc_wrmacror", 3006, record))
    b.say(" ".join(f"{each.mcr_val}/{each.dec_val}" for each in b.get("cnc_rdmacror", 500, 999, 3006).data))
    _locals(b)


def _lengths(b: Bench, first: int, last: int, size: int) -> str:
    return " ".join(b.cell("cnc_rdmacror", first, last, n) for n in (11, 12, size - 1, size, 0x7FFF))


def _pairs(b: Bench, number: int) -> str:
    made, kept = [], b.get("cnc_getmactype")
    for kind in (0, 1):
        b.code("cnc_setmactype", kind)
        one, range_ = b.get("cnc_rdmacro", number, 10), b.get("cnc_rdmacror", number, number, 12).data[0]
        assert (one.mcr_val, one.dec_val) == (range_.mcr_val, range_.dec_val)
        made.append(f"{one.mcr_val} {one.dec_val}")
    b.code("cnc_setmactype", kept)
    return " | ".join(made)


def _locals(b: Bench) -> None:
    b.title("local variables of macros within each other, and what ends them")
    device = b.control()
    registered(
        device,
        O7=";#1=1.5;#33=-33;#100=7;#999=8;G65P8A2.C3.;G4P5;M30",
        O8=";#2=22;G4P40;G65P9X4.Z-5.;G4P5;M99",
        O9=";#33=99;#500=#24;G4P40;M99",
    )
    device.select_program(7)
    b.look(data=True)
    device.cycle_start()
    for number in (8, 9, 8, 7):
        device.advance(5000, until=lambda number=number: bool(b.get("cnc_rdprgnum").data == number))
        device.advance(3)
        b.say(f"> in O{number}")
        b.look(data=True)
        for name, given in (
            ("wrmacro", (1, 10, 5, 0)),
            ("wrmacro", (33, 10, 5, 0)),
            ("wrmacro", (100, 10, number, 0)),
        ):
            b.call(f"cnc_{name}", *given)
    device.advance(500)
    b.say("> at the end")
    assert [b.get("cnc_rdmacro", k, 10).mcr_val for k in range(1, 34)] == [
        each.mcr_val for each in b.get("cnc_rdmacror", 1, 33, 204).data
    ]
    b.look(data=True)
    b.title("local variables while it is held, in single block, at M0, in alarm, in MDI")
    registered(device, O10=";#1=10;G65P11A11.;M30", O11=";#2=12;G4P90;M0;#3=1/0;M99")
    device.select_program(10)
    device.cycle_start()
    device.advance(30)
    for words, act in (
        ("held", device.feed_hold), ("to M0", device.cycle_start), ("to the alarm", device.cycle_start), ("reset", device.reset),
        ("MDI", lambda: (device.select_mode("MDI"), device.mdi.put(b"\nO1\n#5=5\nG65P8A7.\n#6=6\nM30\n%"), device.cycle_start())),
        ("its end", lambda: None), ("MEM", lambda: device.select_mode("MEM")),
    ):  # fmt: skip
        act()
        device.advance(40 if words in ("held", "MDI") else 300)
        b.say(f"> {words}")
        b.look(data=True)
    device.select_program(7)
    device.cycle_start()
    device.advance(500)
    b.look(data=True)
    b.do("reset", device.reset, data=True)
    for value in (0, 64, 128, 192):
        device.macros.set(100, 5.0)
        device.select_program(7)
        device.cycle_start()
        device.advance(20)
        b.code("cnc_wrparam", 5, psd(6001, 0, cdata=value - 256 if value > 127 else value))
        b.do(f"6001 = {value}, reset", device.reset, data=True)
        device.advance(100)
    b.do("off and on", device.power_cycle, data=True)


# ---------------------------------------------------------------------- every state


STATES: dict[str, Callable[[PowerMate], object]] = {
    "at rest": lambda device: None,
    "O7 moves": lambda device: (device.cycle_start(), device.advance(60)),
    "O7 dwells in O8": lambda device: (device.cycle_start(), device.advance(1500)),
    "O7 held": lambda device: (
        device.cycle_start(),
        device.advance(60),
        device.feed_hold(),
        device.advance(300),
    ),
    "O7 after reset": lambda device: (
        device.cycle_start(),
        device.advance(60),
        device.reset(),
        device.advance(300),
    ),
    "alarm 1007": lambda device: device.raise_alarm(1007),
    "alarm 417 of axis 2 while O7 moves": lambda device: (
        device.cycle_start(),
        device.advance(60),
        device.raise_alarm(417, axis=2),
    ),
    "alarm 000": lambda device: device.raise_alarm(0),
    "alarm 100": lambda device: device.raise_alarm(100),
    "emergency stop": lambda device: device.emergency_stop(),
    "off and on": lambda device: device.power_cycle(),
    "keys on": lambda device: device.protect_key(True),
    "a download": lambda device: device.begin_transfer(),
    "a background edit": lambda device: device.programs.edit(8, background=True),
    "skip signal": lambda device: device.skip_signal(True),
    **{mode.label: (lambda device, mode=mode: device.select_mode(mode)) for mode in PowerMateMode},
}
FITTED: dict[str, dict[str, Any]] = {
    "no options": {"options": ()},
    "one axis": {"axes": 1},
    "six axes": {"axes": 6},
    "Power Mate-D": {"model": "D"},
    "inch input": {"inch_input": True},
    "IS-A": {"increment": "IS-A"},
}


def _everything() -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Yield calls of data and axes that are carried out, and those that are refused."""
    yield from (each for each in _ASKED if each[0] in READS)
    far = _record(6711, 0, "i", 31) + _record(6712, 0, "i", 32)
    record = fwlib.IODBMR(datano_s=510, datano_e=511)
    record.data[0].mcr_val, record.data[1].dec_val = 5, 2
    yield from (
        ("absolute", (1, 8)), ("absolute", (0, 8)), ("absolute", (7, 8)), ("machine", (-1, 7)), ("rddynamic", (1, 38)), ("rddynamic", (1, 37)),
        ("skip", (7, 8)), ("distance", (1, 8)), ("wrrelpos", (8, fwlib.IDBWRR(type=1, data=[44]))), ("wrrelpos", (7, fwlib.IDBWRR(type=1))),
        ("wrrelpos", (8, fwlib.IDBWRR(type=7))), ("wrrelpos", (8, fwlib.IDBWRR(type=1, data=[100000000]))), ("relative", (1, 8)),
        ("wrtofs", (99, 0, 8, -321)), ("wrtofs", (100, 0, 8, 1)), ("wrtofs", (1, 1, 8, 1)), ("wrtofs", (1, 0, 8, 10000000)), ("rdtofs", (99, 0, 8)),
        ("rdtofs", (0, 0, 8)), ("wrtofsr", (18, _offsets(2, 4, 0, (4, -5, 6)))), ("wrtofsr", (17, _offsets(2, 4, 0, ()))), ("rdtofsr", (2, -1, 4, 18)),
        ("wrparam", (8, psd(6713, 0, ldata=77))), ("wrparam", (8, psd(1010, 0, cdata=3))), ("wrparam", (8, psd(1423, 1, ldata=3500))),
        ("wrparam", (8, psd(1423, 0, ldata=3500))), ("wrparam", (7, psd(1423, 1, ldata=3500))), ("wrparam", (8, psd(1423, 1, ldata=5))),
        ("wrparam", (8, psd(6080, 0, cdata=33))), ("wrparam", (8, psd(2))), ("rdparam", (1423, 1, 8)), ("rdparam", (3210, 0, 8)), ("rdparam", (6080, 0, 5)),
        ("wrparas", (len(far), far)), ("wrsets", (len(far), far)), ("wrsets", (6, _record(3281, 0, "b", 1))), ("wrparas", (6, _record(1010, 0, "b", 1))),
        ("rdparar", (6711, 0, 6713, 24)), ("rdsetr", (6700, 0, 6712, 16)), ("rdparar", (1423, 0, 1423, 28)), ("rdparainfo", (1420, 2)),
        ("wrmacro", (500, 10, -15, 1)), ("wrmacro", (100, 10, 25, 0)), ("wrmacro", (1, 10, 25, 0)), ("wrmacro", (500, 10, 5, 9)), ("rdmacro", (500, 10)),
        ("rdmacro", (1, 10)), ("rdmacro", (1000, 10)), ("wrmacror", (18, record)), ("rdmacror", (510, 511, 18)), ("rdmacroinfo", ()), ("setmactype", (1,)),
        ("rdmacro", (500, 10)), ("getmactype", ()), ("setmactype", (0,)), ("rdprogdir", (2, 1, 9999, 40)), ("rdproginfo", (1, 31)),
    )  # fmt: skip


READS = (
    "actf",
    "absolute",
    "machine",
    "relative",
    "distance",
    "skip",
    "srvdelay",
    "accdecdly",
    "rddynamic",
    "rdprgnum",
    "rdseqnum",
    "rdexecprog",
)


def everywhere(b: Bench) -> None:
    """The same calls in every state and mode, and on other controls: what differs from a control at rest."""
    wanted: list[str] = []
    for words in (*STATES, *FITTED):
        device = b.control(**FITTED.get(words, {}))
        registered(device, O7=";G90G54N10G1X9.Y-4.F3000;N30M98P8;M30", O8=";N44G4P900;M99")
        device.select_program(7)
        STATES.get(words, STATES["at rest"])(device)
        lines = [_answered(b, name, given) for name, given in _everything()]
        b.title(words)
        if wanted:
            different = [line for line, other in zip(lines, wanted, strict=True) if line != other]
            b.lines += different or ["as at rest"]
        else:
            wanted = lines
            b.lines += lines


def _answered(b: Bench, name: str, given: tuple[Any, ...]) -> str:
    answer = getattr(fwlib, f"cnc_{name}")(b.handle, *given)
    code, rest = (answer[0], answer[1:]) if isinstance(answer, tuple) else (answer, ())
    told = " ".join(shown(each) for each in rest) if code == EW.EW_OK else ""
    return f"{name}({', '.join(map(shown, given))}): {short(code)} {told}".rstrip()


# ---------------------------------------------------------------------- handles


def handles(b: Bench) -> None:
    """Nodes, handles, faults on the way, and what belongs to a handle alone."""
    b.title("nodes")
    for attached in ((), (0,), (7,), (1, 3)):
        fwlib.detach()
        for node in attached:
            fwlib.attach(node, PowerMate(axes=node % 3 + 1))
        codes = runs(
            (node, short(fwlib.cnc_allclibhndl2(node)[0]))
            for node in (-0x80000000, *range(-1, 10), 0x7FFFFFFF)
        )
        b.say(f"{attached}: default {short(fwlib.cnc_allclibhndl()[0])}, node {codes}")
    _, first = fwlib.cnc_allclibhndl2(1)
    _, third = fwlib.cnc_allclibhndl2(3)
    b.say(f"axes of node 1 and 3: {fwlib.cnc_sysinfo(first)[1].axes!r} {fwlib.cnc_sysinfo(third)[1].axes!r}")
    b.title("a handle that was freed, and one that never was")
    device = b.control()
    registered(device, O7=";M30")
    _, other = fwlib.cnc_allclibhndl()
    b.say(f"second handle is another: {other != b.handle}")
    for handle in (0, 0xFFFF, 999):
        b.say(
            f"free {handle}: {short(fwlib.cnc_freelibhndl(handle))}, read {short(fwlib.cnc_actf(handle)[0])}"
        )
    fwlib.cnc_setmactype(other, 1)
    b.say(f"number form of each: {fwlib.cnc_getmactype(b.handle)[1]} {fwlib.cnc_getmactype(other)[1]}")
    b.say(
        f"upload by both: {short(fwlib.cnc_upstart(b.handle, 7))} {short(fwlib.cnc_upstart(other, 7))} {short(fwlib.cnc_upend(other))} {short(fwlib.cnc_upload(b.handle, 5)[0])}"
    )
    b.say(
        f"download by both: {short(fwlib.cnc_dwnstart(other))} {b.cell('cnc_dwnstart')} {b.cell('cnc_download', b'x', 1)} {b.cell('cnc_dwnend')}"
    )
    data = stream("O8", "M30")
    b.say(
        f"freed while it downloads: {short(fwlib.cnc_download(other, data, len(data)))} {short(fwlib.cnc_freelibhndl(other))} {short(fwlib.cnc_dwnend(other))} {short(fwlib.cnc_freelibhndl(other))}, then {b.cell('cnc_dwnstart')} {b.cell('cnc_dwnend')}, directory {b.get('cnc_rdprogdir', 0, 1, 9999, 30).prg_data.decode()}"
    )
    _, third = fwlib.cnc_allclibhndl()
    b.say(
        f"number form of a new one {fwlib.cnc_getmactype(third)[1]}, its upload {short(fwlib.cnc_upload(third, 5)[0])}"
    )
    b.title("each function with a handle that is none")
    b.lines += _answers(b, 0x7777)
    for fault in EW:
        if fault is not EW.EW_OK:
            b.title(f"each function while the way to the control answers {fault.name} {int(fault)}")
            b.control()
            node = fwlib.attach(0, b.device)
            _, handle = fwlib.cnc_allclibhndl()
            node.fault = fault
            b.say(f"new handles: {short(fwlib.cnc_allclibhndl()[0])} {short(fwlib.cnc_allclibhndl2(0)[0])}")
            b.lines += _answers(b, handle)
            node.fault = EW.EW_OK
            b.say(f"afterwards {short(fwlib.cnc_actf(handle)[0])}")


_ASKED: tuple[tuple[str, tuple[Any, ...]], ...] = (
    ("actf", ()), *((name, (-1, 28)) for name in ("absolute", "machine", "relative", "distance", "skip", "srvdelay", "accdecdly")),
    ("rddynamic", (-1, 118)), ("wrrelpos", (8, fwlib.IDBWRR(type=1))), ("dwnstart", ()), ("download", (b"\n", 1)), ("dwnend", ()),
    ("upstart", (1,)), ("upload", (1,)), ("upend", ()), ("search", (1,)), ("delall", ()), ("delete", (1,)), ("rdprogdir", (0, 1, 2, 9)),
    ("rdproginfo", (0, 12)), ("rdprgnum", ()), ("rdseqnum", ()), ("rdexecprog", (9,)), ("wrmdiprog", (1, b"\n")), ("rdmdipntr", ()),
    ("wrmdipntr", (0,)), ("seqsrch", (1,)), ("rewind", ()), ("rdtofs", (1, 0, 8)), ("wrtofs", (1, 0, 8, 1)), ("rdtofsr", (1, 0, 1, 10)),
    ("wrtofsr", (10, fwlib.IODBTO(datano_s=1, datano_e=1))), ("rdtofsinfo", ()), ("rdparam", (6711, 0, 8)), ("wrparam", (8, psd(6711))),
    ("rdparar", (6711, 0, 6711, 8)), ("wrparas", (8, _record(6711, 0, "i", 1))), ("rdparainfo", (0, 1)), ("rdsetr", (6711, 0, 6711, 8)),
    ("wrsets", (8, _record(6711, 0, "i", 1))), ("rdmacro", (500, 10)), ("wrmacro", (500, 10, 1, 0)), ("rdmacror", (500, 500, 12)),
    ("wrmacror", (12, fwlib.IODBMR(datano_s=500, datano_e=500))), ("rdmacroinfo", ()), ("getmactype", ()), ("setmactype", (0,)),
)  # fmt: skip


def _answers(b: Bench, handle: int) -> Iterator[str]:
    found: dict[str, list[str]] = {}
    for name, given in _ASKED:
        answer = getattr(fwlib, f"cnc_{name}")(handle, *given)
        code = EW(answer[0] if isinstance(answer, tuple) else answer)
        found.setdefault(f"{code.name} {int(code)}", []).append(name)
    for code, names in found.items():
        yield f"{code}: {'all' if len(names) == len(_ASKED) else ' '.join(names)}"
