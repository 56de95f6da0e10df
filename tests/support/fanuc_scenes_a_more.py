"""Scenes of what a Power Mate's data do elsewhere: limits in every unit, macros of M codes, offsets, parity."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from polycnc.controllers.fanuc import PowerMate, PowerMateMode, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from support.fanuc_scenes_a import Bench, numbers, registered, short, stream
from support.power_mate import psd

UNITS: dict[str, dict[str, Any]] = {
    "IS-B, inch machine": {"inch_output": True},
    "IS-B, inch input": {"inch_input": True},
    "IS-A": {"increment": "IS-A"},
    "D, IS-C, inch machine": {"model": "D", "increment": "IS-C", "inch_output": True},
    "D, IS-C, the second rotary": {"model": "D", "increment": "IS-C", "rotary": (2,)},
    "six axes, the last rotary, inch machine": {"axes": 6, "rotary": (6,), "inch_output": True},
}


def _where(b: Bench) -> str:
    places = [numbers(b.get(f"cnc_{name}", -1, 28).data) for name in ("machine", "absolute")]
    alarms = " ".join(str(each.number) for each in b.device.control.alarms.active)
    return f"{' | '.join(places)}, alarms {alarms or 'none'}, bits {b.get('cnc_rddynamic', 1, 38).alarm & 0xFFFF:#x}"


def elsewhere(b: Bench) -> None:
    """Limits, macro calls, offsets and TV check where a second part of the control looks at them."""
    _limits(b)
    _macro_calls(b)
    _offsets(b)
    _parity(b)
    _streams(b)
    _freed(b)
    _beside(b)


def _limits(b: Bench) -> None:
    b.title("stroke limits of the last axis in every unit, none, by a program, MDI, jog, 1301#7")
    for words, keys in UNITS.items():
        for number, value, way in ((1320, 400, 1), (1321, -400, -1)):
            cells = []
            for act in ("free", "MEM", "MDI", "JOG", "before"):
                device = b.control(**keys)
                name = device.machine.config.axis_names[-1]
                if act != "free":
                    assert b.code("cnc_wrparam", 8, psd(number, device.axes, ldata=value)) == EW.EW_OK
                if act == "before":
                    b.code("cnc_wrparam", 5, psd(1301, 0, cdata=-128))
                _go(device, act, name, way)
                cells.append(f"{act} {_where(b)}")
            b.say(f"{words}, {number} = {value}: {'; '.join(cells)}")
    b.title("limits that are none, and one changed while it moves")
    for high, low in ((100, 100), (100, 200), (0, 0), (99999999, -99999999), (-100, -200)):
        device = b.control()
        codes = [
            b.cell("cnc_wrparam", 8, psd(1320, 2, ldata=high)),
            b.cell("cnc_wrparam", 8, psd(1321, 2, ldata=low)),
        ]
        _go(device, "MEM", "Y", 1)
        b.say(f"{high} and {low}: {' '.join(codes)}, {_where(b)}")
    device = b.control()
    registered(device, O7=";G1X9.F3000;X0;M30")
    device.select_program(7)
    device.cycle_start()
    device.advance(60)
    codes = [
        b.cell("cnc_wrparam", 8, psd(1320, 1, ldata=5000)),
        b.cell("cnc_wrparam", 8, psd(1420, 1, ldata=600)),
    ]
    device.advance(400)
    b.say(f"in motion: {' '.join(codes)}, {_where(b)}")
    device.reset()
    device.advance(300)
    device.cycle_start()
    device.advance(300)
    b.say(f"afterwards: {_where(b)}")


def _go(device: PowerMate, act: str, name: str, way: int) -> None:
    if act == "JOG":
        device.select_mode("JOG")
        device.control.jog(name, way)
    elif act == "MDI":
        device.select_mode("MDI")
        device.mdi.put(stream("O1", f"G0{name}{way}.", "M30"))
        device.cycle_start()
    else:
        registered(device, O7=f";G0{name}{way}.;M30")
        device.select_program(7)
        device.cycle_start()
    device.advance(500)


def _macro_calls(b: Bench) -> None:
    b.title(
        "M codes of macros: none, twice the same, below 0, in MDI, in a macro, with arguments, without the option"
    )
    macros = {f"O{9020 + k}": f";#{500 + k}=#{500 + k}+1+#24;M{50 + k};M99" for k in range(10)}
    for values, blocks in (
        ((0,) * 10, "M0;M1"), ((50, 51, 52, 53, 54, 55, 56, 57, 58, 59), "M50X1.;M59X2.;M55"), ((97,) * 10, "M97"),
        ((59, 58, 57, 56, 55, 54, 53, 52, 51, 50), "M50;N7M059;M59X4.Y5."),
        ((98, 99, 30, 2, 6, 4, 3, 5, 8, 9), "M3;M8;M9"),
        ((-1, 127, 100, 10, 11, 12, 13, 14, 15, 16), "M127;M100;M16;M10X3."),
    ):  # fmt: skip
        for where in ("MEM", "MDI", "no option"):
            device = b.control(**({"options": ()} if where == "no option" else {}))
            registered(device, **macros, O7=f";{blocks};M30")
            codes = " ".join(
                b.cell("cnc_wrparam", 5, psd(6080 + k, 0, cdata=value)) for k, value in enumerate(values)
            )
            if where == "MDI":
                device.select_mode("MDI")
                device.mdi.put(stream("O1", *blocks.split(";"), "M30"))
            else:
                device.select_program(7)
            device.cycle_start()
            device.advance(200)
            found = b.get("cnc_rdmacror", 500, 509, 66).data
            made = " ".join(f"{each.mcr_val}/{each.dec_val}" for each in found)
            b.say(f"{blocks} with {numbers(values)}, {where}: {codes}, {made}, {_where(b)}")


def _offsets(b: Bench) -> None:
    b.title("tool offsets as lengths in every unit; by a program; more than one control has")
    for words, keys in {**UNITS, "32 offsets": {"offsets": 32}, "no option": {"options": ()}}.items():
        device = b.control(**keys)
        last = device.tool_offsets.count
        codes = [
            b.cell("cnc_wrtofs", number, 0, 8, value) for number, value in ((1, 700), (last, -1250), (2, 1))
        ]
        registered(device, O7=f";G1F3000G43H{last}Z1.;#2001=0.5;G43H1Z1.;G44H2Z0.5;G49Z0;G43H{last + 1};M30")
        device.select_program(7)
        device.control.set_switches(single_block=True)
        cells = []
        for _ in range(7):
            if not device.control.alarms.active:
                device.cycle_start()
                device.advance(400)
            cells.append(numbers(b.get("cnc_absolute", -1, 28).data))
        read = [b.get("cnc_rdtofs", number, 0, 8).data for number in (1, 2, last)]
        b.say(f"{words}: {' '.join(codes)}, {' | '.join(cells)}; {numbers(read)}, {_where(b)}")


def _sent(b: Bench, data: bytes) -> str:
    codes = [b.cell("cnc_dwnstart"), b.cell("cnc_download", data, len(data)), b.cell("cnc_dwnend")]
    b.device.select_mode("MDI")
    codes.append(b.cell("cnc_wrmdiprog", len(data), data))
    b.device.select_mode("MEM")
    return " ".join(codes)


def _parity(b: Bench) -> None:
    b.title("TV check: blocks with comments, blanks, a %, what MDI and a download say of them; 100#0")
    for tv, comments in ((0, 0), (1, 0), (1, 1), (255, 2), (254, 255)):
        b.control()
        for number, value in ((0, tv), (100, comments)):
            b.code("cnc_wrparam", 5, psd(number, 0, cdata=value - 256 if value > 127 else value))
        cells = []
        for block in (
            "G01",
            "G1",
            "G1 ",
            "G01(A)",
            "G01(AB)",
            "G1(A)",
            "(AB)",
            "(ABC)",
            " G01",
            "G01\r",
            "",
            "/G1",
        ):
            data = stream("O77", block, "M30")
            cells.append(f"{block!r} {_sent(b, data)}")
            b.remove(77)
        b.say(f"0000 = {tv}, 0100 = {comments}: {', '.join(cells)}")


def _streams(b: Bench) -> None:
    b.title("several programs in a stream: which is wrong, the same again later, with 3201 = 64, 68 and 0")
    for numbers_sent in (
        (5, 6, 5), (5, 6, 6), (5, 5, 6), (5, 7, 6), (5, 6, 7), (5, 8, 6), (8, 5, 6), (5, 8500, 6), (5, 6, 9001),
        (5, 6, 11), (10000, 5, 6),
        (5, 0, 6), (5, 6, 8, 5),
    ):  # fmt: skip
        cells = []
        for value in (64, 68, 0):
            device = b.control(characters=90)
            registered(device, O7=";M30", O8=";G1;M30")
            device.select_program(7)
            for number, each in ((3201, value), (3202, 17)):
                b.code("cnc_wrparam", 5, psd(number, 0, cdata=each))
            data = stream(
                *(part for number in numbers_sent for part in (f"O{number}", f"G{number % 90}", "M30"))
            )
            codes = [b.cell("cnc_dwnstart")]
            codes += [
                b.cell("cnc_download", data[at : at + 20], len(data[at : at + 20]))
                for at in range(0, len(data), 20)
            ]
            codes.append(b.cell("cnc_dwnend"))
            listed = b.get("cnc_rdprogdir", 2, 1, 9999, 99).prg_data.decode()
            cells.append(f"{' '.join(codes)} {listed}")
        b.say(f"{' '.join(map(str, numbers_sent))}: {' | '.join(cells)}")


def _freed(b: Bench) -> None:
    b.title("a handle that is freed: what stays of its transfers, and of another's")
    for words in (
        "download",
        "half",
        "wrong",
        "stopped",
        "reset",
        "MDI",
        "alarm 101",
        "key",
        "other",
        "other, stopped",
        "comparison",
        "upload",
        "form",
    ):
        device = b.control()
        registered(device, O7=";M30")
        _, other = fwlib.cnc_allclibhndl()
        if words.startswith("other"):
            fwlib.cnc_dwnstart(other)
        elif words == "comparison":
            device.start_compare()
        elif words == "upload":
            b.code("cnc_upstart", 7)
        elif words == "form":
            b.code("cnc_setmactype", 1)
        else:
            b.code("cnc_dwnstart")
        if words in ("half", "wrong"):
            b.code(
                "cnc_download",
                b"\nO9\nG!\n" if words == "wrong" else b"\nO9\nG1",
                7 if words == "wrong" else 6,
            )
        if "stopped" in words:
            device.feed_hold()
        elif words == "reset":
            device.reset()
        elif words == "MDI":
            device.select_mode("MDI")
        elif words == "alarm 101":
            device.raise_alarm(101)
        elif words == "key":
            device.protect_key(True)
        codes = [short(fwlib.cnc_freelibhndl(b.handle)), short(fwlib.cnc_freelibhndl(b.handle))]
        codes += [short(fwlib.cnc_actf(b.handle)[0]), short(fwlib.cnc_actf(other)[0])]
        codes += [
            short(fwlib.cnc_download(other, b"\n", 1)),
            short(fwlib.cnc_dwnend(other)),
            short(fwlib.cnc_dwnstart(other)),
        ]
        codes += [short(fwlib.cnc_upstart(other, 7)), str(fwlib.cnc_getmactype(other)[1])]
        b.say(f"{words}: {' '.join(codes)}, {'a transfer' if device.transfer else 'none'}")


def _beside(b: Bench) -> None:
    b.title("a key in every mode")
    for mode in PowerMateMode:
        device = b.control()
        registered(device, O7=";M30", O8=";M30")
        device.select_mode(mode)
        device.protect_key(True, key=3)
        codes = [
            b.cell("cnc_dwnstart"),
            b.cell("cnc_delete", 7),
            b.cell("cnc_upstart", 8),
            b.cell("cnc_search", 8),
        ]
        b.say(
            f"{mode.label}: {' '.join(codes)} {b.cell('cnc_delall')}, {len(device.programs.memory)} programs"
        )
    b.title("selected, or registered, between a download and its end; 3201 = 64 and 68")
    for value in (64, 68):
        for words in ("selected", "registered"):
            device = b.control()
            registered(device, O7=";M30", O8=";G1;M30")
            b.code("cnc_wrparam", 5, psd(3201, 0, cdata=value))
            data = stream("O8" if words == "selected" and value == 68 else "O9", "G2", "M30")
            codes = [b.cell("cnc_dwnstart"), b.cell("cnc_download", data, len(data))]
            if words == "registered":
                registered(device, O9=";G3;M30")
            elif value == 68:
                device.select_program(8)
            codes.append(b.cell("cnc_dwnend"))
            b.say(
                f"{value}, {words}: {' '.join(codes)}, {b.get('cnc_rdprogdir', 2, 1, 9999, 99).prg_data.decode()}"
            )
    b.title("a rotary axis more than a turn away, either side, with limits and without")
    for way in (-400, 400):
        for limit in (None, 399, -399, 500, -500):
            device = b.control(rotary=(3,))
            registered(device, O7=f";G0A{way}.;M30")
            if limit:
                b.code("cnc_wrparam", 8, psd(1320 if limit > 0 else 1321, 3, ldata=limit * 1000))
            device.select_program(7)
            device.cycle_start()
            device.advance(3000)
            b.say(f"to {way}, limit {limit}: {_where(b)}")
    b.title("what a Power Mate-D does not have, in states")
    here = [fwlib.ODBPOS(idata=1, ldata=5)]
    for words in ("alarm", "emergency stop", "MDI", "JOG", "moves", "reset", "off and on"):
        device = b.control(model="D")
        registered(device, O7=";G1X9.F600;M30")
        device.select_program(7)
        acts: dict[str, Callable[[], object]] = {
            "alarm": partial(device.raise_alarm, 1007),
            "emergency stop": device.emergency_stop,
            "moves": device.cycle_start,
            "reset": device.reset,
            "off and on": device.power_cycle,
        }
        acts.get(words, partial(device.select_mode, words))()
        device.advance(20)
        codes = [
            b.cell(f"cnc_{name}", *given)
            for name, given in (
                ("opdi", (1, fwlib.ODBOPDI(axis=1))), ("refpoint", (1, 0, 1)), ("abspoint", (1, 0, 1, 100, here)),
                ("incpoint", (1, 0, 1, 100, here)), ("dwell", (1, 0, 1, here)), ("coordre", (1, 0, 1, here)),
                ("exebufstat", ()), ("finstate", ()), ("setfin", (fwlib.ODBFIN(),)),
            )
        ]  # fmt: skip
        b.say(f"{words}: {' '.join(codes)}")
