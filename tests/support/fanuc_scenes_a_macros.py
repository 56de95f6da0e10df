"""Scenes of a Power Mate's macro variables and handles, and the calls of all data in every state."""
# mypy: disable-error-code="func-returns-value"
# Acts that follow each other are a tuple of calls.

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.fwlib import EW
from support.fanuc_scenes_a import Bench, registered, runs, short, shown, stream
from support.fanuc_scenes_a_data import LARGEST, packed, tool_offsets
from support.power_mate import psd

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
                f"{first} to {last}: read {_lengths(b, first, last, size)}; write "
                f"{' '.join(b.cell('cnc_wrmacror', n, record) for n in (11, 12, size - 1, size, 0x7FFF))}"
            )
    b.say(
        f"lengths of one: {runs((n, b.cell('cnc_rdmacro', 500, n)) for n in range(-1, 13))}; "
        f"{runs((n, b.cell('cnc_wrmacro', 500, n, 1, 1)) for n in range(-1, 13))}"
    )
    b.title("numbers that are written, and how they read in both forms")
    for kind in (0, 1, -1):
        b.control()
        b.call("cnc_getmactype")
        b.say(f"form {kind}: {b.cell('cnc_setmactype', kind)}")
        b.call("cnc_getmactype")
        for pair in (
            (0, -1), (0, 0), (1, -1), (-1, -1), (5, 0), (-5, 3), (1500, 3), (99999999, 0), (-99999999, 8),
            (100000000, 0), (-100000000, 1), (1, 8), (1, 9),
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
    found = b.get("cnc_rdmacror", 500, 999, 3006)
    b.say(f"{found.datano_s} to {found.datano_e}, {len(bytes(found))} bytes")
    b.say(" ".join(f"{each.mcr_val}/{each.dec_val}" for each in found.data))
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


def _is_in(b: Bench, program: int) -> bool:
    return bool(b.get("cnc_rdprgnum").data == program)


def _in_mdi(device: PowerMate, *blocks: str) -> None:
    device.select_mode("MDI")
    device.mdi.put(stream("O1", *blocks))
    device.cycle_start()


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
        device.advance(5000, until=partial(_is_in, b, number))
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
        ("held", device.feed_hold), ("to M0", device.cycle_start), ("to the alarm", device.cycle_start),
        ("reset", device.reset),
        ("MDI", lambda: _in_mdi(device, "#5=5", "G65P8A7.", "#6=6", "M30")),
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
    "O7 dwells in O8": lambda device: (device.cycle_start(), device.advance(600)),
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
    **{mode.label: partial(PowerMate.select_mode, mode=mode) for mode in PowerMateMode},
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
    far = packed(6711, 0, "i", 31) + packed(6712, 0, "i", 32)
    record = fwlib.IODBMR(datano_s=510, datano_e=511)
    record.data[0].mcr_val, record.data[1].dec_val = 5, 2
    yield from (
        ("absolute", (1, 8)), ("absolute", (0, 8)), ("absolute", (7, 8)), ("machine", (-1, 7)),
        ("rddynamic", (1, 38)), ("rddynamic", (1, 37)),
        ("skip", (7, 8)), ("distance", (1, 8)), ("wrrelpos", (8, fwlib.IDBWRR(type=1, data=[44]))),
        ("wrrelpos", (7, fwlib.IDBWRR(type=1))),
        ("wrrelpos", (8, fwlib.IDBWRR(type=7))), ("wrrelpos", (8, fwlib.IDBWRR(type=1, data=[100000000]))),
        ("relative", (1, 8)),
        ("wrtofs", (99, 0, 8, -321)), ("wrtofs", (100, 0, 8, 1)), ("wrtofs", (1, 1, 8, 1)),
        ("wrtofs", (1, 0, 8, 10000000)), ("rdtofs", (99, 0, 8)),
        ("rdtofs", (0, 0, 8)), ("wrtofsr", (18, tool_offsets(2, 4, 0, (4, -5, 6)))),
        ("wrtofsr", (17, tool_offsets(2, 4, 0, ()))), ("rdtofsr", (2, -1, 4, 18)),
        ("wrparam", (8, psd(6713, 0, ldata=77))), ("wrparam", (8, psd(1010, 0, cdata=3))),
        ("wrparam", (8, psd(1423, 1, ldata=3500))),
        ("wrparam", (8, psd(1423, 0, ldata=3500))), ("wrparam", (7, psd(1423, 1, ldata=3500))),
        ("wrparam", (8, psd(1423, 1, ldata=5))),
        ("wrparam", (8, psd(6080, 0, cdata=33))), ("wrparam", (8, psd(2))), ("rdparam", (1423, 1, 8)),
        ("rdparam", (3210, 0, 8)), ("rdparam", (6080, 0, 5)),
        ("wrparas", (len(far), far)), ("wrsets", (len(far), far)), ("wrsets", (6, packed(3281, 0, "b", 1))),
        ("wrparas", (6, packed(1010, 0, "b", 1))),
        ("rdparar", (6711, 0, 6713, 24)), ("rdsetr", (6700, 0, 6712, 16)), ("rdparar", (1423, 0, 1423, 28)),
        ("rdparainfo", (1420, 2)),
        ("wrmacro", (500, 10, -15, 1)), ("wrmacro", (100, 10, 25, 0)), ("wrmacro", (1, 10, 25, 0)),
        ("wrmacro", (500, 10, 5, 9)), ("rdmacro", (500, 10)),
        ("rdmacro", (1, 10)), ("rdmacro", (1000, 10)), ("wrmacror", (18, record)), ("rdmacror", (510, 511, 18)),
        ("rdmacroinfo", ()), ("setmactype", (1,)),
        ("rdmacro", (500, 10)), ("getmactype", ()), ("setmactype", (0,)), ("rdprogdir", (2, 1, 9999, 40)),
        ("rdproginfo", (1, 31)),
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
        registered(device, O7=";N10G90G54G1X9.Y-4.F3000;N30M98P8;M30", O8=";N44G4P900;M99")
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
        f"upload by both: {short(fwlib.cnc_upstart(b.handle, 7))} {short(fwlib.cnc_upstart(other, 7))} "
        f"{short(fwlib.cnc_upend(other))} {short(fwlib.cnc_upload(b.handle, 5)[0])}"
    )
    b.say(
        f"download by both: {short(fwlib.cnc_dwnstart(other))} {b.cell('cnc_dwnstart')} "
        f"{b.cell('cnc_download', b'x', 1)} {b.cell('cnc_dwnend')}"
    )
    data = stream("O8", "M30")
    b.say(
        f"freed while it downloads: {short(fwlib.cnc_download(other, data, len(data)))} "
        f"{short(fwlib.cnc_freelibhndl(other))} {short(fwlib.cnc_dwnend(other))} "
        f"{short(fwlib.cnc_freelibhndl(other))}, then {b.cell('cnc_dwnstart')} {b.cell('cnc_dwnend')}, "
        f"directory {b.get('cnc_rdprogdir', 0, 1, 9999, 30).prg_data.decode()}"
    )
    _, third = fwlib.cnc_allclibhndl()
    b.say(
        f"number form of a new one {fwlib.cnc_getmactype(third)[1]}, its upload {short(fwlib.cnc_upload(third, 5)[0])}"
    )
    b.title("functions that a Power Mate-D does not have")
    for model, axes in (("H", 1), ("H", 6), ("D", 1), ("D", 2)):
        b.control(model=model, axes=axes)
        here = [fwlib.ODBPOS(idata=1, ldata=5)]
        answers = (
            f"{name} {b.cell(f'cnc_{name}', *given)}"
            for name, given in (
                ("opdi", (1, fwlib.ODBOPDI(axis=1))),
                ("refpoint", (1, 0, 1)),
                *((name, (1, 0, 1, 100, here)) for name in ("abspoint", "incpoint")),
                *((name, (1, 0, 1, here)) for name in ("dwell", "coordre")),
                ("exebufstat", ()),
                ("finstate", ()),
                ("setfin", (fwlib.ODBFIN(),)),
            )
        )
        b.say(f"{model}, {axes} axes: {', '.join(answers)}")
    b.title("each function with a handle that is none")
    b.lines += _answers(b, 0x7777)
    for fault in EW:
        if fault is not EW.EW_OK:
            b.title(f"each function while the way to the control answers {fault.name} {int(fault)}")
            b.control()
            place = fwlib.attach(0, b.device)
            _, handle = fwlib.cnc_allclibhndl()
            place.fault = fault
            b.say(f"new handles: {short(fwlib.cnc_allclibhndl()[0])} {short(fwlib.cnc_allclibhndl2(0)[0])}")
            b.lines += _answers(b, handle)
            place.fault = EW.EW_OK
            b.say(f"afterwards {short(fwlib.cnc_actf(handle)[0])}")


_ASKED: tuple[tuple[str, tuple[Any, ...]], ...] = (
    ("actf", ()),
    *((name, (-1, 28)) for name in ("absolute", "machine", "relative", "distance", "skip", "srvdelay", "accdecdly")),
    ("rddynamic", (-1, 118)), ("wrrelpos", (8, fwlib.IDBWRR(type=1))), ("dwnstart", ()),
    ("download", (b"\n", 1)), ("dwnend", ()),
    ("upstart", (1,)), ("upload", (1,)), ("upend", ()), ("search", (1,)), ("delall", ()), ("delete", (1,)),
    ("rdprogdir", (0, 1, 2, 9)),
    ("rdproginfo", (0, 12)), ("rdprgnum", ()), ("rdseqnum", ()), ("rdexecprog", (9,)),
    ("wrmdiprog", (1, b"\n")), ("rdmdipntr", ()),
    ("wrmdipntr", (0,)), ("seqsrch", (1,)), ("rewind", ()), ("rdtofs", (1, 0, 8)), ("wrtofs", (1, 0, 8, 1)),
    ("rdtofsr", (1, 0, 1, 10)),
    ("wrtofsr", (10, fwlib.IODBTO(datano_s=1, datano_e=1))), ("rdtofsinfo", ()), ("rdparam", (6711, 0, 8)),
    ("wrparam", (8, psd(6711))),
    ("rdparar", (6711, 0, 6711, 8)), ("wrparas", (8, packed(6711, 0, "i", 1))), ("rdparainfo", (0, 1)),
    ("rdsetr", (6711, 0, 6711, 8)),
    ("wrsets", (8, packed(6711, 0, "i", 1))), ("rdmacro", (500, 10)), ("wrmacro", (500, 10, 1, 0)),
    ("rdmacror", (500, 500, 12)),
    ("wrmacror", (12, fwlib.IODBMR(datano_s=500, datano_e=500))), ("rdmacroinfo", ()), ("getmactype", ()),
    ("setmactype", (0,)),
)  # fmt: skip


def _answers(b: Bench, handle: int) -> Iterator[str]:
    found: dict[str, list[str]] = {}
    for name, given in _ASKED:
        answer = getattr(fwlib, f"cnc_{name}")(handle, *given)
        code = EW(answer[0] if isinstance(answer, tuple) else answer)
        found.setdefault(f"{code.name} {int(code)}", []).append(name)
    for words, names in found.items():
        yield f"{words}: {'all' if len(names) == len(_ASKED) else ' '.join(names)}"
