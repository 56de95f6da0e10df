"""Numbers that ask for what would never end: refused where they stand, and nothing that runs keeps a signal waiting."""

from __future__ import annotations

import signal
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from polycnc import check
from polycnc.cnc import Control, ControlError
from polycnc.controllers.apci import Board
from polycnc.controllers.imc import Card
from polycnc.errors import ConfigurationError
from polycnc.machine import LONGEST_BLOCK_S, Clock, Timed, load_machine, preset_text
from support.started import started_python

TINY = "0." + "0" * 14 + "1"
MANY = "".join(f"G1 X{7 + i % 2} F300\n" for i in range(2500)) + "X0\n"  # more than the ordinary path takes

ENDLESS = {
    "feed": (f"G1 X3 F{TINY}", "F"),
    "feed of before": (f"F{TINY}\nG1 X3", "G1"),
    "arc": (f"G2 X4 Y0 I2 J0 F{TINY}", "F"),
    "radius": (f"G3 X4 Y2 R30 F{TINY}", "F"),
    "inverse time": (f"G93 G1 X3 F{TINY}", "F"),
    "per revolution": (f"G95 S7 M3 G1 X3 F{TINY}", "F"),
    "slow spindle": (f"G95 S{TINY} M3\nG1 X3 F0.2", "F"),
    "turns": ("G2 X0 Y0 I10 J0 P900000000 F0.3", "F"),
    "dwell": ("G4 P" + "9" * 30, "P"),
    "cycle": (f"G81 X3 Y2 Z-5 R2 F{TINY}", "F"),
    "dwell of a cycle": ("G82 X3 Y2 Z-5 R2 P" + "9" * 30 + " F100", "P"),
    "compensated": (f"G41 D1 G1 X3 Y2 F{TINY}\nX9\nX12 Y7\nG40 X20", "F"),
    "end": ("G1 X3" + "0" * 20 + " F100", "X"),
    "centre": ("G2 X3 Y0 I3" + "0" * 20 + " J0 F100", "I"),
}


@pytest.mark.parametrize("before", ["", MANY], ids=["ordinary", "compiled"])
@pytest.mark.parametrize("case", ENDLESS)
def test_a_block_without_end_is_refused_at_its_word(case: str, before: str) -> None:
    text, letter = ENDLESS[case]
    errors = check(f"{before}{text}\nM30\n")
    assert errors
    position = errors[0].position
    assert position is not None
    assert position.line == before.count("\n") + 1 + (case in ("feed of before", "slow spindle"))
    assert position.text[position.column - 1 :].startswith(letter)
    assert errors[0].hint


def test_the_longest_block_passes_and_a_longer_one_does_not() -> None:
    per_minute = 60.0 * 7.0 / LONGEST_BLOCK_S  # 7 mm in just that time
    assert check(f"G1 X7 F{per_minute * 1.001:.12f}\nM30\n") == []
    refused = check(f"G1 X7 F{per_minute * 0.999:.12f}\nM30\n")
    assert [error.what for error in refused] == ["the block would take 116 days"]
    assert check(f"{MANY}G1 X0 Y7 F{per_minute * 1.5:.12f}\nM30\n") == []


MACHINES = {
    "cycle": ("[[axis]]", "cycle_s = 1e-300\n[[axis]]", "cycle_s"),
    "speed": ("vmax_mm_s = ", "vmax_mm_s = 1e-300 # ", "vmax_mm_s"),
    "acceleration": ("amax_mm_s2 = ", "amax_mm_s2 = 1e-300 # ", "amax_mm_s2"),
    "high speed": ("vmax_mm_s = ", "vmax_mm_s = 1e300 # ", "vmax_mm_s"),
    "tool change": ("[times]", "[times]\nauxiliary_s = 1e300\n#", "auxiliary_s"),
}


@pytest.mark.parametrize("case", MACHINES)
def test_a_machine_that_never_arrives_is_refused(case: str, tmp_path: Path) -> None:
    old, new, key = MACHINES[case]
    text = preset_text("mill3")
    if old == "[times]" and old not in text:
        text += "\n[times]\n"
    assert old in text
    (tmp_path / "m.toml").write_text(text.replace(old, new, 1))
    with pytest.raises(ConfigurationError, match=key) as refused:
        load_machine(tmp_path / "m.toml")
    assert refused.value.position is not None


def test_an_override_too_small_to_arrive_is_refused() -> None:
    control = Control(load_machine("mill3"))
    for factor in (1e-300, 0.0009, -0.5, float("nan")):
        with pytest.raises(ControlError):
            control.set_overrides(feed=factor)
    control.set_overrides(feed=0.001)
    assert control.overrides.feed == 0.001


def test_a_wait_without_end_is_a_count_that_never_comes() -> None:
    clock = Clock(0.004)
    assert clock.cycles_for(1e300) == clock.cycles_for(float("inf")) == 1 << 62
    clock.tick(1 << 62)
    assert clock.now.year == 9999


SCRIPT = """
import signal, sys
from polycnc.machine import Machine, load_machine
signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
machine = Machine(load_machine("mill3"))
machine.advance(1)
print("begun", flush=True)
machine.advance(1 << 61)
"""


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, -signal.SIGINT)])
def test_a_signal_ends_a_process_within_compiled_code(number: signal.Signals, status: int) -> None:
    with started_python(SCRIPT) as process:
        assert process.stdout.readline() == "begun\n"
        process.send_signal(number)
        assert process.wait(30) == status


class Interrupted(Exception):
    """Raised by the handler of the signal."""


def _interrupt(number: int, frame: object) -> None:
    raise Interrupted


@pytest.mark.parametrize("make", [Board, Card, partial(Control, load_machine("mill3"))])
def test_a_device_can_be_interrupted_within_cycles_without_end(make: Callable[[], Timed]) -> None:
    device = make()
    device.advance(3)
    before = signal.signal(signal.SIGALRM, _interrupt)
    try:
        for attempt in range(12):  # until it has got on, however busy the machine is
            signal.setitimer(signal.ITIMER_REAL, 0.05 * 2**attempt)
            with pytest.raises(Interrupted):
                device.advance(1 << 61)
            if device.clock.cycles > 3:
                break
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    cycles = device.clock.cycles
    assert cycles > 3
    device.advance(5)
    assert device.clock.cycles == cycles + 5  # and goes on as if nothing had been
