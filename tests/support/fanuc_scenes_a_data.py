"""Scenes of a Power Mate's data files: tool offsets, parameters, settings, macro variables; and of handles."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from typing import Any

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.data._parameter_rows import ParameterRow, parameter_rows
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW
from support.fanuc_scenes_a import Bench, numbers, registered, runs, short
from support.power_mate import psd

LARGEST = 0x7FFFFFFF

# ---------------------------------------------------------------------- tool offsets


def tool_offsets(first: int, last: int, kind: int, values: Iterable[int], by: str = "m_ofs") -> Any:
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
                f"{name}, {count} offsets: "
                f"{runs((n, b.cell(f'cnc_{name}', n, 0, 8, *rest)) for n in range(-2, count + 3))}"
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
                f"{n} {b.cell('cnc_wrtofsr', n, tool_offsets(first, last, 0, [77] * 9))}"
                for n in (0, 9, 10, size - 1, size, 0x7FFF)
            ]
            b.say(f"{first} to {last}: {', '.join(read)}; write {', '.join(written)}")
        for kind in range(-3, 4):
            b.say(
                f"type {kind}: {b.cell('cnc_rdtofsr', 1, kind, 3, 18)}, write "
                f"{b.cell('cnc_wrtofsr', 18, tool_offsets(1, 3, kind, (7, 8, 9)))}"
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
            taken = b.cell("cnc_wrtofsr", 22, tool_offsets(2, 5, -1, (11, -limit, limit, 14), "m_ofs_a"))
            refused = b.cell("cnc_wrtofsr", 22, tool_offsets(2, 5, 0, (1, 2, limit + 1, 4)))
            b.say(f"  {taken} {refused} {numbers(b.get('cnc_rdtofsr', 1, 0, 6, 30).u.m_ofs)}")
            device.parameters.set(0, 0 if inch else 4)
            b.say(
                f"  in {'mm' if inch else 'inch'} then {numbers(b.get('cnc_rdtofsr', 1, -1, 6, 30).u.m_ofs_a)}"
            )
    b.title("all of them at once, and the halves")
    b.control()
    b.say(
        b.cell(
            "cnc_wrtofsr",
            402,
            tool_offsets(1, 99, -1, ((7 * k + 2) * (-1) ** k for k in range(99)), "m_ofs_a"),
        )
    )
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


def packed(number: int, kind: int, form: str, *values: int) -> bytes:
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
            ("rdparar", 0, 20), ("rdparar", 1020, 1020), ("rdparar", 1300, 1320), ("rdparar", 1410, 1420),
            ("rdparar", 1620, 1825),
            ("rdparar", 3210, 3211), ("rdparar", 3210, 3210), ("rdparar", 6080, 6089), ("rdparar", 6711, 6711),
            ("rdparar", 8010, 9999),
            ("rdparar", 8023, 9999), ("rdparar", 21, 99), ("rdparar", 100, 20), ("rdparar", -1, 20),
            ("rdparar", -5, -1),
            ("rdsetr", 0, 20), ("rdsetr", 1, 12), ("rdsetr", 12, 12), ("rdsetr", 6700, 6712),
            ("rdsetr", 1000, 6000), ("rdsetr", 6758, 9999), ("rdsetr", -1, 0),
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
        ("one word", packed(3281, 0, "b", 5)),
        ("a setting", packed(6711, 0, "i", 77)),
        ("a setting of an axis", packed(12, 2, "b", 5)),
        ("settings in their order", packed(20, 0, "b", 3) + packed(6711, 0, "i", 1) + packed(6712, 0, "i", -0)),
        ("settings in another order", packed(6712, 0, "i", 3) + packed(6711, 0, "i", 1)),
        ("one twice", packed(6711, 0, "i", 3) + packed(6711, 0, "i", 4)),
        ("all axes", packed(1320, 0xFF, "i", 10, 20, 30, 40, 50, 60)),
        ("all axes, too few", packed(1320, 0xFF, "i", 10, 20, 30)),
        ("axis 3", packed(1320, 3, "i", -9)),
        ("axis 4", packed(1320, 4, "i", -9)),
        ("axis 6", packed(1320, 6, "i", -9)),
        ("axis 7", packed(1320, 7, "i", -9)),
        ("axis 0 of one with axes", packed(1320, 0, "i", -9)),
        ("axis 1 of one without", packed(6711, 1, "i", 9)),
        ("all axes of one without", packed(6711, 0xFF, "i", 9)),
        ("with its attribute", packed(6711, 0x300, "i", 9)),
        ("with another attribute", packed(6711, 0x100, "i", 9)),
        ("out of range in the second", packed(20, 0, "b", 9) + packed(6713, 0, "i", 1000000)),
        ("protected in the second", packed(20, 0, "b", 9) + packed(1010, 0, "b", 3)),
        ("not readable", packed(3210, 0, "i", 9)),
        ("none of this number", packed(21, 0, "b", 9)),
        ("not a setting in the second", packed(20, 0, "b", 9) + packed(3281, 0, "b", 9)),
        ("without the byte that makes it even", packed(20, 0, "b", 9)[:-1]),
        ("a byte too few", packed(6711, 0, "i", 9)[:-1]),
        ("a header alone", packed(6711, 0, "h", 9)[:4]),
        ("a word behind", packed(6711, 0, "i", 9) + b"\0\0"),
        ("nothing", b""),
        ("M codes of macros", b"".join(packed(6080 + k, 0, "b", 50 + k) for k in range(10))),
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
    part = packed(6711, 0, "i", 9)
    b.say(f"lengths: {runs((n, b.cell('cnc_wrparas', n, part)) for n in range(-1, 10))}")
    b.title("six axes, a value of its own on each, of each kind")
    for number, values in (
        (12, (1, -2, 3, -128, -127, -6)),
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
            f"{number}: {' '.join(written)}; {alone} | {_read(b, row, ALL_AXES)} | "
            f"{_range(b, 'rdparar', number, -1, number, 99)}"
        )
        b.code("cnc_wrparam", 4 + 6 * size, _psd(row, -1, *values[::-1]))
        b.say(
            f"  {_read(b, row, ALL_AXES)} | "
            f"{' '.join(_range(b, 'rdparar', number, axis, number, 99)[14:] for axis in range(1, 7))}"
        )
    b.title("options and protection")
    b.control(options=())
    for data in (
        packed(6711, 0, "i", 5) + packed(8010, 1, "b", 1),
        packed(6080, 0, "b", 5) + packed(6711, 0, "i", 5),
    ):
        b.say(
            f"one of two needs an option: {b.cell('cnc_wrparas', len(data), data)}, "
            f"{b.get('cnc_rdparam', 6711, 0, 8).u.ldata}"
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
    record = packed(number, axis, "bbhi"[row.kind], max(row.low, min(row.high, 1)))
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
    """What parameters of the manual do: names of axes, limits, macros of M codes, units; what outlasts the power."""
    b.title("M codes of macros, 6080 to 6089")
    device = b.control()
    registered(device, **{f"O{9020 + k}": f";#{500 + k}=#{500 + k}+#24*10+{k + 1};M99" for k in range(10)})
    b.code("cnc_wrparas", 60, b"".join(packed(6080 + k, 0, "b", 30 + k * 7) for k in range(10)))
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
            f"{values}: {written}, {' '.join(before)} alarm {alarm:#x}, then "
            f"{' '.join(device.machine.config.axis_names)} alarm {b.get('cnc_rddynamic', 1, 38).alarm:#x}"
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
