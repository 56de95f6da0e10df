"""Scenes of a Power Mate's axes: where they are, how fast they are, alarms, relative positions (Manual 000)."""
# mypy: disable-error-code="func-returns-value"
# Acts that follow each other are a tuple of calls.

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW
from support.fanuc_scenes_a import POSITIONS, Bench, registered, runs, stream
from support.power_mate import psd

AXES = (-0x8000, -2, -1, 0, 1, 2, 3, 4, 6, 7, 0x7FFF)
CONTROLS = {
    "IS-B, mm, four axes, the fourth rotary": ({"axes": 4, "rotary": (4,)}, "XYZA"),
    "IS-A, inch input, three axes, the second rotary": (
        {"axes": 3, "rotary": (2,), "increment": "IS-A", "inch_input": True},
        "XAY",
    ),
    "IS-B, inch machine, six axes with servos, the last two rotary": (
        {"axes": 6, "rotary": (5, 6), "inch_output": True, "servo": True},
        "XYZUAB",
    ),
    "Power Mate-D, IS-C, inch input and inch machine": (
        {"model": "D", "increment": "IS-C", "inch_input": True, "inch_output": True},
        "XY",
    ),
}


def _words(names: str, *values: float) -> str:
    return "".join(f"{name}{value}" for name, value in zip(names, values, strict=False))


def moves(b: Bench) -> None:
    """One program on four controls: offsets, tool length, feeds, dwells, holds, resets, switching off and on."""
    for title, (keys, names) in CONTROLS.items():
        b.title(title)
        device = b.control(**keys)
        feed = (20, 40, 70) if device.units.inch_input else (600, 1200, 1800)
        registered(device, O4321=";".join(_program(names, feed, "G21" if feed[0] == 20 else "G20")))
        for axis in range(1, device.axes + 1):
            for code, value in ((1221, 110 * axis - 35), (1222, -90 * axis)):
                assert b.code("cnc_wrparam", 8, psd(code, axis, ldata=value)) == EW.EW_OK
        assert b.code("cnc_wrtofs", 3, 0, 8, -1234) == EW.EW_OK
        b.look()
        device.select_program(4321)
        _first_half(b, device)
        _second_half(b, device, names[-1])


def _program(names: str, feed: tuple[int, int, int], other: str) -> Iterator[str]:
    yield from ("", "N5G90G54G17", f"N10G0{_words(names, 1.5, -0.75, 2.25, 3.125, -4.5, 5.25)}")
    if "Z" in names:
        yield "N20G43H3Z0.25"
    yield f"N30G1F{feed[0]}{_words(names, -1.0, 0.5, 0.75, 2.0, -1.5, 2.5)}"
    yield from ("G4P30", "G91", f"N40{_words(names[:2], 0.375, -0.625)}F{feed[1]}")
    yield f"N50{names[-1]}-0.5F{feed[2]}"
    if "Z" in names:
        yield "N60G49"
    yield from (f"N70{other}G90", f"N80G1{names[0]}0.125F{feed[0]}", "N90M30")


def _until(b: Bench, sequence: int) -> None:
    b.device.advance(20000, until=lambda: bool(b.get("cnc_rdseqnum").data == sequence))


def _first_half(b: Bench, device: PowerMate) -> None:
    b.do("start", device.cycle_start)
    b.advance(20)
    b.advance(21)
    _until(b, 30)
    b.advance(30, "of N30")
    b.do("skip signal", lambda: device.skip_signal(True))
    b.advance(20)
    b.do("skip signal away, feed hold", lambda: (device.skip_signal(False), device.feed_hold()))
    b.advance(300)
    preset = fwlib.IDBWRR(type=ALL_AXES, data=[123, -4, 56, 0, 7, -89])
    b.do("relative positions 123, -4 and so on", lambda: b.code("cnc_wrrelpos", 28, preset))
    b.do("start", device.cycle_start)
    b.advance(25)
    far = fwlib.IDBWRR(type=device.axes, data=[99999999])
    b.do("relative position of the last axis 99999999", lambda: b.code("cnc_wrrelpos", 8, far))
    device.signals.give(12, 255 - 50)
    b.advance(25, "at 50 %")
    device.signals.give(12, 255 - 150)
    for number in (40, 50, 80):
        _until(b, number)
        b.advance(35, f"of N{number}")


def _second_half(b: Bench, device: PowerMate, last: str) -> None:
    b.do("emergency stop", device.emergency_stop)
    b.advance(200)
    b.do("released and reset", lambda: (device.emergency_stop(False), device.reset()))
    b.do("off and on", device.power_cycle)
    device.control.set_switches(single_block=True)
    for _ in range(4):
        b.do("start, single block", device.cycle_start)
        b.advance(3000)
    b.do("reset", device.reset)
    b.advance(300)
    b.do("JOG", lambda: (device.select_mode("JOG"), device.control.jog(last, 1)))
    b.advance(60)
    b.do("jog ends", lambda: device.control.jog(last, None))
    b.advance(200)


def _code(b: Bench, name: str, axis: int, length: int) -> str:
    if name == "wrrelpos":
        return b.cell(f"cnc_{name}", length, fwlib.IDBWRR(type=axis, datano=-7, data=[8, 7, 6, 5, 4, 3]))
    return b.cell(f"cnc_{name}", axis, length)


def refusals(b: Bench) -> None:
    """Every axis number with every length, and what a preset takes."""
    for keys in ({"axes": 6}, {"axes": 3}, {"axes": 1}, {"model": "D", "axes": 2}):
        device = b.control(**keys)
        b.title(
            f"Power Mate-{device.model}, {device.axes} of {device.max_axis} axes: a code for each axis and length"
        )
        n, most = device.axes, device.max_axis
        tables: dict[tuple[Any, ...], list[str]] = {}
        for name in (*POSITIONS, "rddynamic", "wrrelpos"):
            head = 22 if name == "rddynamic" else 4
            each, every = (16, 22 + 16 * most) if name == "rddynamic" else (4, 4 + 4 * n)
            lengths = (-0x8000, -1, 0, 7, head + each - 1, head + each, every - 1, every, every + 1, 0x7FFF)
            rows = tuple((axis, tuple(_code(b, name, axis, length) for length in lengths)) for axis in AXES)
            tables.setdefault((lengths, rows), []).append(name)
        for (lengths, rows), names in tables.items():
            b.say(f"{', '.join(names)}:")
            b.table("axis", lengths, rows)
            b.say("")
        b.say(f"then {b.get('cnc_relative', ALL_AXES, 28)}")
    b.title("what a preset takes, three axes")
    b.control()
    largest = 99_999_999
    for values in (
        (1, -2, 3), (largest, -largest, 0), (largest + 1, 0, 0), (4, -largest - 1, 5), (6, 7, largest + 1),
        (-0x80000000, 0, 0), (0, 0, 0x7FFFFFFF), (9, 9, 9, largest + 1),
    ):  # fmt: skip
        b.call("cnc_wrrelpos", 16, fwlib.IDBWRR(type=ALL_AXES, datano=77, data=values))
        b.call("cnc_relative", ALL_AXES, 16)
    for value in (largest, -largest, largest + 1, -largest - 1, 0):
        for axis in (1, 3):
            b.call("cnc_wrrelpos", 8, fwlib.IDBWRR(type=axis, data=[value, 1, 2]))
        b.call("cnc_relative", ALL_AXES, 16)
        b.call("cnc_absolute", ALL_AXES, 16)


def structures(b: Bench) -> None:
    """The bytes of what is returned."""
    for keys in ({"axes": 3}, {"model": "D"}):
        device = b.control(**keys)
        b.title(f"Power Mate-{device.model}: the bytes of structures, of a control that moves")
        registered(device, O1027=";N70M98P515;M30", O515=";N54321G1X30.Y-20.F3000;M99")
        device.select_program(1027)
        device.raise_alarm(1007)
        device.reset()
        device.cycle_start()
        device.advance(140)
        device.raise_alarm(417, axis=2)
        b.code("cnc_wrrelpos", 8, fwlib.IDBWRR(type=2, data=[-70000]))
        for name, *given in (
            ("actf",), ("absolute", -1, 28), ("absolute", 2, 8), ("machine", 1, 8), ("relative", 2, 8),
            ("distance", -1, 28), ("rddynamic", -1, 118), ("rddynamic", 2, 38), ("rdprgnum",), ("rdseqnum",),
            ("rdproginfo", 0, 12), ("rdproginfo", 1, 31), ("rdprogdir", 1, 1, 9999, 30), ("rdtofs", 3, 0, 8),
            ("rdtofsr", 2, 0, 4, 18), ("rdtofsr", 2, -1, 4, 18), ("rdtofsinfo",), ("rdparam", 1320, -1, 28),
            ("rdparam", 1420, 2, 8), ("rdparam", 6080, 0, 5), ("rdparainfo", 1320, 3), ("rdmacro", 500, 10),
            ("rdmacror", 500, 502, 24), ("rdmacroinfo",),
        ):  # fmt: skip
            if name == "rdmacro":
                offsets = fwlib.IODBTO(datano_s=2, datano_e=4)
                offsets.u.m_ofs[:3] = [5, -6, 70000]
                b.code("cnc_wrtofsr", 18, offsets)
                b.code("cnc_wrmacro", 500, 10, -70000, 3)
                b.code("cnc_wrmacro", 502, 10, 5, 0)
            found = b.get(f"cnc_{name}", *given)
            b.memory(f"{name}{tuple(given)}", found)
        device.reset()
        device.advance(300)
        device.select_mode("MDI")
        text = stream("O7", "M98P515", "M98P515", "M30")
        b.code("cnc_wrmdiprog", len(text), text)
        b.code("cnc_wrmdipntr", 1)
        b.memory("rdmdipntr()", b.get("cnc_rdmdipntr"))
        device.cycle_start()
        device.advance(100)
        b.memory("rdmdipntr()", b.get("cnc_rdmdipntr"))
        device.select_mode("MEM")
        b.code("cnc_upstart", 515)
        b.memory("upload(12)", b.get("cnc_upload", 12)[0])


def alarms(b: Bench) -> None:
    """Every alarm number by itself, sums of groups, what ends them, and alarms that happen."""
    b.title("alarm bits of each number")
    device = b.control()

    def bits(number: int) -> str:
        device.raise_alarm(number, axis=number % 3 + 1)
        dynamic = b.get("cnc_rddynamic", 1, 38).alarm & 0xFFFF
        if device.power.blocks_transfers:
            device.power_cycle()
        else:
            device.reset()
        return f"{dynamic:#x}"

    edges = sorted(
        {
            max(0, edge + k)
            for edge in (0, 100, 101, 300, 400, 500, 600, 700, 750, 1000, 2000, 3000, 5000, 6000)
            for k in (-2, -1, 0, 1)
        }
    )
    for line in runs((number, bits(number)) for number in edges if number < 6000).split(", "):
        b.say(line)
    b.title("groups one after another, RESET, switching off")
    for number in (100, 10, 500, 700, 417, 300, 5010, 1007, 101, 0):
        device.raise_alarm(number, axis=2)
        dynamic = b.get("cnc_rddynamic", ALL_AXES, 118)
        alone = b.get("cnc_rddynamic", 3, 38)
        assert alone.alarm == dynamic.alarm
        b.say(f"{number}: {dynamic.alarm} {dynamic.alarm & 0xFFFF:#x} alarm {b.get('cnc_alarm').data:#x}")
    device.reset()
    b.say(f"after RESET {b.get('cnc_rddynamic', ALL_AXES, 118).alarm:#x}")
    device.power_cycle()
    b.say(f"after power {b.get('cnc_rddynamic', ALL_AXES, 118).alarm:#x}")
    b.title("alarms that happen")
    device = b.control(axes=3, servo=True)
    registered(
        device,
        O1=";G1X1.F1000;G1Q5",
        O2=";N7G90G1Y2.F30000;M30",
        O3=";#3000=7(DOOR);M30",
        O4=";#1=1/0",
        O5=";N9G1X50.F60000;M30",
    )
    b.code("cnc_wrparam", 8, psd(1320, 2, ldata=1000))
    b.code("cnc_wrparam", 8, psd(1321, 2, ldata=-1000))
    b.look()
    for number, words in (
        (1, "a wrong word"),
        (2, "a stroke limit of axis 2"),
        (3, "#3000"),
        (4, "division by 0"),
    ):
        device.select_program(number)
        b.say(f"> O{number}: {words}")
        device.cycle_start()
        device.advance(900)
        b.look()
        device.reset()
        b.say(f"  after RESET {b.get('cnc_rddynamic', ALL_AXES, 118).alarm:#x}")
    b.code("cnc_wrparam", 8, psd(1828, 1, ldata=100))
    device.power_cycle()
    device.select_program(5)
    b.do("a servo that lags too far behind", device.cycle_start)
    b.advance(100)
    device.reset()
    b.do("a parameter that needs the power off", lambda: b.code("cnc_wrparam", 5, psd(1004, 0, cdata=1)))
    b.do("RESET", device.reset)
    b.do("off and on", device.power_cycle)
    b.do("emergency stop", device.emergency_stop)
