"""Feeds in every kind of motion, and walks: any function with any argument, in whatever state a Power Mate comes to."""
# mypy: disable-error-code="func-returns-value"
# Acts that follow each other are a tuple of calls.

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.data._parameter_rows import parameter_rows
from polycnc.controllers.fanuc.fwlib import ALL_AXES, EW
from support.fanuc_scenes_a import Bench, numbers, registered, short, shown, stream
from support.power_mate import psd

FEEDS: tuple[tuple[dict[str, Any], tuple[str, ...]], ...] = (
    ({"axes": 4, "rotary": (3, 4)}, (
        "G1X9.F1234.5", "G1X9.F1234.4", "G1X9.Y9.F1000", "G1A90.F700", "G1A90.B-90.F700", "G1X9.A90.F700",
        "G0X90.", "G0A90.", "G2X9.Y9.R9.F900",
        "G17G3X-9.Y9.R9.F0.5", "G1X9.F60000", "G4P500", "G95S600M3G1X9.F0.5",
    )),
    ({"axes": 3, "rotary": (3,), "inch_input": True}, (
        "G1X9.F12.345", "G1X9.F0.123", "G1A90.F700", "G1A90.X1.F70", "G0X90.", "G0A90.", "G21G1X9.F700",
        "G95S600M3G1X9.F0.05",
    )),
    ({"axes": 2, "inch_output": True}, ("G1X9.F700", "G20G1X9.F7", "G0X90.")),
    ({"model": "D", "increment": "IS-C", "axes": 1}, ("G1X9.F700.6", "G0X90.")),
)  # fmt: skip


def feeds(b: Bench) -> None:
    """The actual feed of each kind of motion, at overrides up to the largest, held, dry, with the machine locked."""
    for keys, blocks in FEEDS:
        b.title(f"{keys}: F while it moves, at 50 %, at 254 %, held, and after the end")
        for block in blocks:
            device = b.control(**keys)
            registered(device, O7=f";{block};M30")
            device.select_program(7)
            device.cycle_start()
            cells = []
            for override in (100, 50, 254, None):
                if override is None:
                    device.feed_hold()
                else:
                    device.signals.give(12, 255 - override)
                device.advance(150)
                dynamic = b.get("cnc_rddynamic", ALL_AXES, 118)
                assert b.get("cnc_actf").data == dynamic.actf
                cells.append(f"{dynamic.actf} {numbers(each for each in b.get('cnc_machine', -1, 28).data)}")
            b.say(f"{block}: {' | '.join(cells)}")
    b.title("how switches change it")
    for words, act in (
        ("dry run", lambda device: device.control.set_switches(dry_run=True)),
        ("machine lock", lambda device: device.signals.give(44, 2)),
        ("rapid at 25 %", lambda device: device.signals.give(14, 2)),
        ("JOG", lambda device: (device.select_mode("JOG"), device.control.jog("Y", -1))),
        ("JOG, rapid", lambda device: (device.select_mode("JOG"), device.control.jog("Y", -1, rapid=True))),
    ):  # fmt: skip
        for block in ("G1X9.F600", "G0X90."):
            device = b.control()
            registered(device, O7=f";{block};M30")
            device.select_program(7)
            act(device)
            if "JOG" not in words:
                device.cycle_start()
            device.advance(150)
            b.say(
                f"{words}, {block}: {b.get('cnc_actf').data}, {numbers(b.get('cnc_absolute', -1, 28).data)} "
                f"machine {numbers(b.get('cnc_machine', -1, 28).data)} to go "
                f"{numbers(b.get('cnc_distance', -1, 28).data)}"
            )


# ---------------------------------------------------------------------- walks

PROGRAMS = {
    7: "N10G90G54G1X2.Y-3.F6000;N20#100=#100+1;M98P8;N30G43H2Z4.;N40G4P20;G49;M30",
    8: "G91X1.5;N81Y0.25;G90M99",
    9: "#500=#5041*2;N5M0;G20G1X0.5F50;G21;M30",
    9010: "M99",
}
MODES = ("MDI", "MEM", "MEM", "MEM", "EDIT", "JOG", "RMT", "REF")
LENGTHS = (0, 5, 6, 7, 8, 10, 12, 16, 18, 20, 28, 28, 38, 118, 118, 262, 402)
PARAMETERS = (
    0,
    12,
    20,
    1004,
    1020,
    1221,
    1320,
    1321,
    1420,
    1620,
    3201,
    3202,
    3210,
    3290,
    6050,
    6071,
    6080,
    6711,
    8010,
    2,
    9999,
)


class Walk:
    """Draw calls and acts of the operator, and write them down with what they changed."""

    def __init__(self, b: Bench, seed: int) -> None:
        self.b = b
        self.draw = random.Random(seed)

    def run(self, steps: int, **keys: Any) -> None:
        """Walk some steps on a new control."""
        device = self.b.control(**keys)
        registered(device, **{f"O{number}": f";{blocks}" for number, blocks in PROGRAMS.items()})
        self.b.look(data=True)
        for step in range(steps):
            if self.draw.random() < 0.3:
                self._operate(device)
            else:
                self._call(*self._chosen())
            if step % 3 == 2:
                self.b.look(data=True)

    def _operate(self, device: PowerMate) -> None:
        acts: tuple[tuple[str, Callable[[], Any]], ...] = (
            ("start", device.cycle_start), ("start", device.cycle_start), ("hold", device.feed_hold),
            ("reset", device.reset),
            ("emergency stop", device.emergency_stop), ("released", lambda: device.emergency_stop(False)),
            ("key 3", lambda: device.protect_key(True, key=3)), ("no key", lambda: device.protect_key(False)),
            ("off and on", device.power_cycle), ("skip", lambda: device.skip_signal(not device.state.skip)),
            ("alarm 1007", lambda: device.raise_alarm(1007)),
        )  # fmt: skip
        words, act = self.draw.choice(acts)
        program = self.draw.choice((7, 7, 9))
        if self.draw.random() < 0.3:
            words, act = f"run O{program}", lambda: self._begin(device, program)
        elif self.draw.random() < 0.4:
            mode = self.draw.choice(MODES)
            words, act = mode, lambda: device.select_mode(mode)
        cycles = self.draw.choice((1, 7, 40, 40, 300))
        try:
            act()
        except ControlError as error:
            words = f"{words}, refused: {str(error).splitlines()[0]}"
        device.advance(cycles)
        self.b.say(f"> {words}, {cycles} ms")

    def _begin(self, device: PowerMate, program: int) -> None:
        device.emergency_stop(False)
        device.reset()
        device.advance(300)
        device.select_mode("MEM")
        device.select_program(program)
        device.cycle_start()

    def _call(self, name: str, *given: Any) -> None:
        answer = getattr(fwlib, f"cnc_{name}")(self.b.handle, *given)
        code, rest = (answer[0], answer[1:]) if isinstance(answer, tuple) else (answer, ())
        told = " ".join(shown(each) for each in rest) if code == EW.EW_OK else ""
        self.b.say(f"{name}({', '.join(map(shown, given))}): {short(code)} {told}".rstrip())

    def _chosen(self) -> tuple[Any, ...]:
        one, draw = self.draw.choice, self.draw
        axis = one((-1, -1, -1, 0, 1, 1, 2, 2, 3, 4, 7))
        length = one(LENGTHS)
        number = one((*PROGRAMS, *PROGRAMS, 1, 0, 9999))
        value = one((0, 1, -1, 77, -1234, 99999999, 100000000, 999999, draw.randrange(-500000, 500000)))
        data = one(
            (
                stream(f"O{number}", "G1 X1. (A)", "M30"),
                stream(f"O{number}(C{number})", "N44 G0 Y0", "M99"),
                b"\nO3\nG!\n%",
                b"\nO3\nM30",
            )
        )
        variable = one((1, 33, 34, 100, 149, 500, 501, 999, 1000))
        relative = fwlib.IDBWRR(type=axis, data=[value, 5, -6])
        offset = fwlib.IODBTO(datano_s=one((1, 2, 98)), datano_e=one((2, 3, 99)), type=one((0, -1, 1)))
        offset.u.m_ofs[:3] = [value, 11, -12]
        pair = fwlib.IODBMR(datano_s=variable, datano_e=variable + one((0, 1, 2)))
        for entry in pair.data:
            entry.mcr_val, entry.dec_val = value, one((-1, 0, 2, 8, 9))
        parameter = one(PARAMETERS)
        wanted = (
            psd(parameter, axis, ldatas=[value % 128, 2, 3])
            if parameter in parameter_rows()
            else psd(parameter)
        )
        return one((
            ("actf",), ("rdprgnum",), ("rdseqnum",), *((name, axis, length) for name in POSITION_CALLS),
            ("rddynamic", axis, length),
            ("wrrelpos", length, relative), ("wrrelpos", length, relative), ("dwnstart",), ("dwnstart",),
            ("download", data, len(data)),
            ("download", data, one((0, 1, 9, 257))), ("dwnend",), ("dwnend",), ("upstart", number),
            ("upload", one((0, 1, 5, 99))), ("upend",),
            ("search", number), ("search", number), ("delete", number),
            ("delall",) if draw.random() < 0.1 else ("rewind",),
            ("rdprogdir", one((0, 1, 2, 3)), one((1, 8, 0)), one((9999, 8, 10000)), one((0, 9, 60))),
            ("rdproginfo", one((0, 1, 2)), one((12, 31, 13))),
            ("rdexecprog", one((0, 1, 20, 99))), ("wrmdiprog", len(data), data), ("wrmdiprog", len(data), data),
            ("rdmdipntr",),
            ("wrmdipntr", one((0, 1, 2, -1))), ("seqsrch", one((10, 20, 30, 81, 5, 0))),
            ("rdtofs", one((0, 1, 2, 99, 100)), one((0, 1)), length),
            ("wrtofs", one((0, 1, 2, 99, 100)), 0, one((7, 8)), value), ("wrtofsr", length, offset),
            ("rdtofsr", one((1, 2)), one((0, -1, 2)), one((0, 2, 3)), length),
            ("rdparam", parameter, axis, length), ("wrparam", length, wanted),
            ("wrparam", 28, wanted), ("rdparainfo", parameter, one((0, 1, 2))), ("rdmacro", variable, one((9, 10))),
            ("wrmacro", variable, one((9, 10)), value, one((-1, 0, 3, 9))),
            ("rdmacror", variable, variable + one((0, 1, -1)), length),
            ("wrmacror", length, pair), ("setmactype", one((0, 1))), ("getmactype",),
            ("rdparar", parameter, axis, parameter + 1, one((5, 40))),
            ("rdsetr", parameter, axis, parameter + 1, one((5, 40))),
        ))  # fmt: skip


POSITION_CALLS = ("absolute", "machine", "relative", "distance", "skip", "srvdelay", "accdecdly")
WALKS: dict[str, dict[str, Any]] = {
    "walk1": {"axes": 3},
    "walk2": {"axes": 2, "model": "D", "increment": "IS-C", "inch_input": True},
    "walk3": {"axes": 6, "rotary": (3, 6), "increment": "IS-A", "servo": True, "inch_output": True},
}


def walk(name: str, b: Bench) -> None:
    """Ask for anything in any state."""
    Walk(b, int(name[-1])).run(240, **WALKS[name])
