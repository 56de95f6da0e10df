"""Scenes of a Power Mate in states beside states: every pair of them, each with calls whose arguments are drawn.

A state here is a level of each factor: which control, parameters, program, motion, edit, transfer, key, alarm,
mode, what was done last.
"""
# mypy: disable-error-code="func-returns-value"
# Acts that follow each other are a tuple of calls.

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import combinations
from typing import Any
from unittest.mock import patch

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc import PowerMate, PowerMateMode, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from polycnc.servers.focas import FocasControl, load_profile
from support.fanuc_scenes_a import Bench, numbers, registered, short, shown, stream
from support.fanuc_scenes_a_calls import axes_calls, data_calls, parameter_calls, program_calls
from support.fanuc_scenes_a_wire import Cable
from support.power_mate import psd

Act = Callable[[Bench], object]
ROWS = 58
TRIES = 12
LETTERS = {
    "OK": "O", "LEN": "L", "NUM": "N", "ATTR": "A", "DATA": "D", "BUSY": "B", "FUNC": "F", "PROT": "P", "OVRFL": "V",
    "MODE": "M", "REJ": "J", "NOOPT": "T", "RESET": "R",
}  # fmt: skip

# ---------------------------------------------------------------------- factors

CONTROLS: dict[str, dict[str, Any]] = {
    "H": {},
    "H, one axis": {"axes": 1},
    "H, six axes, the last rotary": {"axes": 6, "rotary": (6,), "servo": True},
    "D": {"model": "D"},
    "D, one axis, IS-C, inch input": {"model": "D", "axes": 1, "increment": "IS-C", "inch_input": True},
    "H, IS-A, Y rotary": {"increment": "IS-A", "rotary": (2,), "offsets": 32},
    "H, inch machine": {"inch_output": True},
    "H without options": {"options": ()},
    "H, full of programs": {"most_programs": 7},
    "H, four axes, inch input, macros alone": {"axes": 4, "inch_input": True, "options": ("custom_macro",)},
}


def _nothing(b: Bench) -> None:
    pass


def _parameter(number: int, value: int) -> Act:
    member = "ldata" if number in (3210, 3211) else "cdata"
    return lambda b: b.code("cnc_wrparam", 8, psd(number, 0, **{member: value}))


def _run(program: int, cycles: int, stop: Callable[[PowerMate], object] = lambda device: None) -> Act:
    def act(b: Bench) -> None:
        b.device.select_program(program)
        b.device.cycle_start()
        b.device.advance(cycles)
        stop(b.device)
        b.device.advance(300)

    return act


def _single(b: Bench) -> None:
    b.device.control.set_switches(single_block=True)
    _run(8, 700)(b)


def _jog(b: Bench) -> None:
    b.device.select_mode("JOG")
    b.device.control.jog(b.device.machine.config.axis_names[-1], -1)
    b.device.advance(60)


def _mdi(b: Bench, *, start: bool) -> None:
    b.device.select_mode("MDI")
    b.device.mdi.put(stream("O01", "N3G4P9.", "N4M98P8", "M30"))
    if start:
        b.device.cycle_start()
        b.device.advance(40)


def _other(b: Bench, name: str, *given: int) -> None:
    _, handle = fwlib.cnc_allclibhndl()
    getattr(fwlib, name)(handle, *given)


def _edit(b: Bench) -> None:
    b.device.select_mode("EDIT")
    b.device.programs.edit(8)


FACTORS: dict[str, dict[str, Act]] = {
    "parameters": {
        "": _nothing,
        **{
            f"{number} = {value}": _parameter(number, value)
            for number, value in (
                (3202, 1),
                (3202, 16),
                (0, 1),
                (3290, -128),
                (3201, 68),
                (3201, 0),
                (3210, 321),
            )
        },
        "parameters not writable": lambda b: setattr(b.device.state, "parameters_writable", False),
    },
    "programs": {
        "": _nothing,
        "none": lambda b: (b.device.select_mode("EDIT"), b.code("cnc_delall"), b.device.select_mode("MEM")),
        "O9001 selected": lambda b: b.device.select_program(9001),
        "none selected": lambda b: b.device.programs.unselect(),
        "N30 sought": lambda b: b.code("cnc_seqsrch", 30),
    },
    "upload": {
        "": _nothing,
        "an upload": lambda b: b.code("cnc_upstart", 9001),
        "an upload of another": lambda b: _other(b, "cnc_upstart", 8),
    },
    "motion": {
        "": _nothing,
        "O7 moves": _run(7, 60),
        "O7 held": _run(7, 60, PowerMate.feed_hold),
        "O8 after a block": _single,
        "O7 in O8": _run(7, 900),
        "O9 at M0": _run(9, 60),
        "O10 in alarm": _run(10, 60),
        "O7 after reset": _run(7, 60, PowerMate.reset),
        "O11 at its end": _run(11, 60),
        "jog": _jog,
        "MDI program": partial(_mdi, start=False),
        "MDI program runs": partial(_mdi, start=True),
    },
    "edit": {
        "": _nothing,
        "background edit": lambda b: b.device.programs.edit(8, background=True),
        "edit": _edit,
    },
    "transfer": {
        "": _nothing,
        "a download": lambda b: b.code("cnc_dwnstart"),
        "a download of another": lambda b: _other(b, "cnc_dwnstart"),
        "half a download": lambda b: (b.code("cnc_dwnstart"), b.code("cnc_download", b"\nO12(C)\nG1", 10)),
        "a comparison": lambda b: b.device.start_compare(),
        "a download, stopped": lambda b: (
            b.code("cnc_dwnstart"),
            b.device.transfer and b.device.transfer.stop(),
        ),
    },
    "key": {
        "": _nothing,
        "key 3": lambda b: b.device.protect_key(True, key=3),
        "all but key 3": lambda b: (b.device.protect_key(True), b.device.protect_key(False, key=3)),
    },
    "alarm": {
        "": _nothing,
        **{
            f"alarm {number}": partial(lambda n, b: b.device.raise_alarm(n), number)
            for number in (0, 10, 100, 101, 300, 500, 700, 1007, 5010)
        },
        "alarm 417 of the last axis": lambda b: b.device.raise_alarm(417, axis=b.device.axes),
        "emergency stop": lambda b: b.device.emergency_stop(),
    },
    "signals": {
        "": _nothing,
        "skip": lambda b: b.device.skip_signal(True),
        "machine lock": lambda b: b.device.signals.give(44, 2),
        "override 0": lambda b: b.device.signals.give(12, 255),
        "binary numbers": lambda b: b.code("cnc_setmactype", 7),
    },
    "mode": {
        "": _nothing,
        **{mode.label: partial(lambda m, b: b.device.select_mode(m), mode) for mode in PowerMateMode},
    },
    "last": {
        "": _nothing,
        "reset": lambda b: b.device.reset(),
        "off and on": lambda b: b.device.power_cycle(),
        "feed hold": lambda b: b.device.feed_hold(),
        "20 ms": lambda b: b.device.advance(20),
    },
}


def covering(levels: Sequence[int], rows: int, draw: random.Random) -> list[tuple[int, ...]]:
    """Return rows of levels that hold as many pairs of levels as are found by drawing."""
    places = [*combinations(range(len(levels)), 2)]
    known: set[tuple[int, int, int, int]] = set()
    made = []
    for _ in range(rows):
        tries = [tuple(draw.randrange(most) for most in levels) for _ in range(TRIES)]
        pairs = [{(i, row[i], k, row[k]) for i, k in places} for row in tries]
        best = max(range(TRIES), key=lambda n: len(pairs[n] - known))
        known |= pairs[best]
        made.append(tries[best])
    return made


def _calls(b: Bench) -> list[tuple[str, list[tuple[Any, ...]]]]:
    m, most = b.device.axes, b.device.max_axis
    data = data_calls(b.device.tool_offsets.count)
    return [*program_calls(), *axes_calls(m, most), *data, *parameter_calls(m, most)]


def _drawn(b: Bench, draw: random.Random) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Yield a call or two of each function, none of those that take programs away."""
    for name, given in _calls(b):
        if name not in ("delall", "delete", "dwnend", "upend", "download", "wrparam"):
            for chosen in draw.sample(given, min(len(given), 1 if name.startswith("rd") else 2)):
                yield name, chosen


def _every(b: Bench) -> None:
    """Write down the codes of all calls: O, or the first letter or two of what refuses."""
    told: list[str] = []
    for name, given in _calls(b):
        codes = "".join(LETTERS.get(code, code) for code in (b.cell(f"cnc_{name}", *each) for each in given))
        if told and told[-1].startswith(f"{name} "):
            told[-1] += f" {codes}"
        else:
            told.append(f"{name} {codes}")
    b.say(f"codes: {', '.join(told)}")


# ---------------------------------------------------------------------- the scene


def mixed(b: Bench) -> None:
    """States beside each other; in each: what is read, calls with drawn arguments, what they left, 40 ms more."""
    draw = random.Random(5)
    factors: list[dict[str, Any]] = [CONTROLS, *FACTORS.values()]
    for row in covering([len(each) for each in factors], ROWS, draw):
        chosen = [[*factor.items()][k] for factor, k in zip(factors, row, strict=True)]
        device = b.control(**chosen[0][1])
        _programs(device)
        words = [chosen[0][0]]
        for name, act in chosen[1:]:
            try:
                act(b)
            except ControlError:
                name += " (refused)"
            words.append(name)
        b.title("; ".join(filter(None, words)))
        b.look()
        _far(b, draw)
        _answers(b, [*_drawn(b, draw)])
        _every(b)
        device.advance(40)
        b.look(data=True)


def _programs(device: PowerMate) -> None:
    last = device.machine.config.axis_names[-1]
    registered(
        device,
        O7=f";N10G90G54G1X9.F3000;{last}-4.;N30M98P8;M30", O8=";N44G4P900;G4P1;M99", O9="(STOP);G4P1;N30M0;M30",
        O10=f";N30{last}1.F9000;G1Q9;M30",
        O11=f";N5G1{last}0.125F9000;M30", O8500=";M99", O9001="(NINE);M99",
    )  # fmt: skip
    device.select_program(7)


def _answers(b: Bench, calls: Sequence[tuple[str, tuple[Any, ...]]]) -> None:
    """Write down what calls answer: those that return something a line each, the others by their code."""
    codes: dict[str, list[str]] = {}
    for name, given in calls:
        answer = getattr(fwlib, f"cnc_{name}")(b.handle, *given)
        code, rest = (answer[0], answer[1:]) if isinstance(answer, tuple) else (answer, ())
        call = f"{name}({', '.join(map(_given, given))})"
        if code == EW.EW_OK and rest:
            b.say(f"{call}: {' '.join(map(shown, rest))}")
        else:
            codes.setdefault(short(code), []).append(call)
    for told, which in codes.items():
        b.say(f"{told}: {', '.join(which)}")


def _given(value: Any) -> str:
    """Return an argument, of what is long its begin."""
    if isinstance(value, fwlib.IODBPSD):
        return f"{value.datano} of {value.type}: {numbers(value.u.ldatas)}"
    if isinstance(value, bytes):
        return shown(value[:40])
    return shown(value).partition(", u.m_ofs_a")[0]


def _far(b: Bench, draw: random.Random) -> None:
    """Ask over the network too, and write down where that differs."""
    m, most = b.device.axes, b.device.max_axis
    asked = [
        *((name, draw.choice(given)) for name, given in axes_calls(m, most) if name != "wrrelpos"),
        ("actf", ()), ("rdprgnum", ()), ("rdseqnum", ()), ("rdmacro", (draw.choice((1, 100, 500, 999, 1000)), 10)),
        ("rdparam", draw.choice(((1320, m, 8), (1320, -1, 28), (6711, 0, 8), (12, 1, 5)))),
    ]  # fmt: skip
    with patch(
        "socket.create_connection", lambda *_: Cable(FocasControl(b.device, PROFILE), lambda *_: None)
    ):
        _, far = fwlib.cnc_allclibhndl3("control", 8193, 1)
        for name, given in asked:
            near, there = (getattr(fwlib, f"cnc_{name}")(handle, *given) for handle in (b.handle, far))
            if repr(near) != repr(there):
                b.say(f"far {name}{given}: {short(there[0])} {', '.join(map(shown, there[1:]))}")
        fwlib.cnc_freelibhndl(far)


PROFILE = load_profile("power-mate")
