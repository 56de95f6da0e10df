"""What a sender is answered is so: `ok` is seen in the control, after `error` it is as it was, in each state."""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from typing import Any

from polycnc.cnc import Control
from support.grbl_sender import Bench
from support.often import ALL_CASES

STATES: dict[str, str] = {
    "idle": "", "running": "G1 X30 F600\n", "held": "G1 X30 F600\n!", "stopped": "M0\n", "dwelling": "G4 P9\n",
    "jogging": "$J=G91 X9 F600\n", "checking": "$C\n", "at the door": "G1 X30 F600\n\x84", "locked": "G0 X99999\n",
    "sleeping": "$SLP\n",
}  # fmt: skip
"""What brings a machine at rest into a state."""
LINES: dict[str, Callable[[Bench], bool] | None] = {
    "G10 L2 P2 X2.5": lambda bench: bench.control.offsets["G55"]["X"] == 2.5,
    "$110=600": lambda bench: bench.control.machine.config.axes[0].vmax == 10.0,
    "$13=1": lambda bench: bench.core.settings[13] == 1.0,
    "$20=0": lambda bench: bench.core.settings[20] == 0.0,
    "$27=1.5": lambda bench: bench.core.settings[27] == 1.5,
    "M3 S500": lambda bench: bench.control.spindle.state().direction == 1,
    "$J=G91 X1 F600": lambda bench: True,
    "G1 X13 F600": lambda bench: True,
    "$130=-1": None, "$110=0": None, "$J=X": None, "$J=G91 X99999 F600": None, "G2 X1 F100": None, "Q": None,
    "G10 L2 P9 X2": None, "G1 X1 X2": None, "$N3=G0": None, "$200=1": None, "G1 X[": None,
}  # fmt: skip
"""How the control shows that a line has been carried out; None for one that never is."""
_ORDINARY = 30


def facts(control: Control, bench: Bench) -> dict[str, Any]:
    status = control.status()
    return {
        "axes": {name: (axis.machine, axis.work) for name, axis in status.axes.items()},
        "run": status.channel.active
        and not status.channel.starved,  # a program that waits for lines may be open
        "config": control.machine.config.axes,
        "offsets": {name: dict(values) for name, values in control.offsets.items()},
        "settings": {row.number: bench.core.settings[row.number] for row in bench.core.settings.rows},
        "queued": bench.core.busy,
        "spindle": status.spindle,
    }


def check(state: str, line: str) -> bool:
    """Send a line in a state; return whether it was answered with `ok`."""
    bench, seen = Bench(), LINES[line]
    for piece in STATES[state].partition("\n"):
        bench.send(piece, 40 if "\n" not in piece else 100)
    bench.passed(200)
    before = facts(bench.control, bench)
    answers = bench.send(line + "\n")
    if any(each.startswith("error:") for each in answers):
        assert facts(bench.control, bench) == before, (state, line)
        return False
    answers += bench.lines(bench.passed(1500))
    if "ok" not in answers:
        return False
    assert seen is not None, (state, line, answers)
    assert state == "checking" or seen(bench), (state, line, answers)
    return True


def test_each_answer_to_a_line_is_so() -> None:
    pairs = [(state, line) for state in STATES for line in LINES]
    random.Random(24).shuffle(pairs)
    if ALL_CASES not in os.environ:
        pairs = [("idle", line) for line in LINES] + pairs[:_ORDINARY]
    accepted = {line for state, line in pairs if check(state, line)}
    assert accepted == {line for line, seen in LINES.items() if seen is not None}
