"""Random calls of the Power Mate's library: none leaves a traceback, and a refused one changes nothing."""

from __future__ import annotations

import ctypes
import random
from typing import Any

import pytest

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from polycnc.errors import UsageError
from support.power_mate import attached, registered

NUMBERS = (
    -32768, -2, -1, 0, 1, 2, 3, 5, 7, 8, 12, 24, 28, 31, 33, 38, 100, 118, 149, 200, 256, 300, 500, 501, 1000, 1006,
    1020, 1320, 1420, 6080, 6711, 6750, 8010, 9000, 9999, 32767, 70000,
)  # fmt: skip
TEXTS = (
    "\n",
    "%",
    "\nO9\nM30\n%",
    "\nO9\n",
    "G1X1.\n",
    "~",
    "(",
    "\nO7\nM30\n%",
    "\nO9001\nM99\n%",
    "",
    "X" * 256,
)
LEFT_OUT = {"cnc_freelibhndl", "cnc_setdefnode", "cnc_delall"}  # the last deletes what is not protected
BUTTONS = ("cycle_start", "feed_hold", "reset", "power_cycle")


def state(control: PowerMate) -> tuple[Any, ...]:
    """Return everything that calls can change, but for positions, which time changes as well."""
    return (
        {
            (n, a): control.parameters.value(n, a)
            for n, a in control.parameters._values
            if not 6750 <= n <= 6758
        },
        {number: control.macros.get(number) for number in (*range(100, 200), *range(500, 1000))},
        [control.tool_offsets.get(number) for number in range(1, 100)],
        [(each, control.programs.read(each.number)) for each in control.programs.directory()],
        (
            control.programs.selected,
            control.state.cursor,
            control.mdi.state.blocks,
            control.mdi.state.start,
            control.power.alarm_bits,
        ),
        control.control.relative_zero,
    )


def argument(chance: random.Random, c: str) -> Any:
    """Return something to pass for a type of C."""
    kind = c.replace("*", "").strip()
    if "char" in kind:
        return chance.choice(TEXTS)
    if kind == "void":
        return bytes(chance.choice((0, 0, 3, 26, 55, 255)) for _ in range(chance.choice((0, 6, 8, 12, 60))))
    cls = getattr(fwlib, kind, None)
    if cls is None:
        return chance.choice(NUMBERS)
    made = cls()
    for name in ("datano", "type", "datano_s", "datano_e"):
        if hasattr(made, name):
            setattr(made, name, ctypes.c_int16(chance.choice(NUMBERS)).value)
    if hasattr(made, "u"):
        ctypes.memset(ctypes.addressof(made) + 4, chance.choice((0, 1, 5, 255)), 8)
    return made


@pytest.mark.parametrize("seed", range(3))
def test_random_calls(seed: int) -> None:
    chance = random.Random(seed)
    control, handle = attached(characters=2000)
    registered(control, O7="\nN10 G1 X5. F6000\nN20 M98 P8\nM30\n", O8="\nG4 P20\nM99\n", O9002="\nM99\n")
    control.select_program(7)
    names = sorted(set(fwlib.FUNCTIONS) - LEFT_OUT)
    answers = set()
    before = state(control)
    for _ in range(700):
        function = fwlib.FUNCTIONS[chance.choice(names)]
        given = [handle if each.name == "FlibHndl" else argument(chance, each.c) for each in function.passed]
        try:
            answer = getattr(fwlib, function.name)(*given)
        except UsageError:
            assert state(control) == before
            continue
        code = answer[0] if isinstance(answer, tuple) else answer
        answers.add((function.name, EW(code)))
        after = state(control) if code == EW.EW_OK or chance.random() < 0.3 else before
        assert code == EW.EW_OK or after == before, (function.name, given, code)
        what = chance.random()
        try:
            if what < 0.03:
                control.select_mode(chance.choice(("MDI", "MEM", "EDIT", "JOG", "RMT")))
            elif what < 0.06:
                getattr(control, chance.choice(BUTTONS))()
            elif what < 0.15:
                control.advance(chance.choice((1, 5, 40)))
            elif what < 0.16:
                control.parameters.set(3202, chance.choice((0, 1, 16)))
        except ControlError:
            pass
        before = state(control) if code == EW.EW_OK or what < 0.16 else before
    assert len(answers) > 90
