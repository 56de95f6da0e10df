"""A control with a look-ahead of two or three blocks goes on from any cycle with the same bits."""

from __future__ import annotations

import random
from contextlib import suppress

import numpy as np
import pytest

from polycnc.cnc import Control, ControlError
from polycnc.machine import MachineConfig, load_machine

CYCLES, RESTORES = 1000, 5
ALWAYS, LONG = range(2), range(2, 402)


def _machine(chance: random.Random) -> MachineConfig:
    file = load_machine("mill3")
    depth, tolerance = chance.choice((2, 3)), chance.choice((0.0, 0.01))
    path = file.path.model_copy(update={"look_ahead_blocks": depth, "tolerance_mm": tolerance})
    return file.model_copy(update={"path": path})


def _program(chance: random.Random) -> str:
    lines = [f"G90 G64 F{chance.choice((1000, 6000, 20_000))}"]
    x = y = 0.0
    for _ in range(chance.randint(20, 60)):
        kind = chance.random()
        if kind < 0.6:
            size = chance.choice((0.2, 1.0, 5.0))
            x = min(max(x + chance.uniform(-size, size), -50.0), 50.0)
            y = min(max(y + chance.uniform(-size, size), -50.0), 50.0)
            lines.append(f"G1 X{x:.4f} Y{y:.4f}")
        elif kind < 0.75:
            lines.append(f"G{chance.choice((2, 3))} X{x:.4f} Y{y:.4f} I{chance.uniform(0.1, 3.0):.4f} J0")
        elif kind < 0.85:
            lines.append(f"F{chance.choice((500, 3000, 20_000))}")
        else:
            lines.append(f"G0 Z{chance.uniform(0.0, 5.0):.3f}")
    return "\n".join([*lines, "M30", ""])


def _act(control: Control, act: str | None, cycle: int) -> None:
    with suppress(ControlError):
        if act == "override":
            control.set_overrides(feed=(0.3, 0.7, 1.0, 1.5)[cycle % 4])
        elif act == "hold":
            control.feed_hold()
        elif act == "start":
            control.cycle_start()


@pytest.mark.parametrize(
    "seeds", [ALWAYS, pytest.param(LONG, marks=[pytest.mark.long, pytest.mark.timeout(0)])]
)
def test_a_restored_control_goes_on_with_the_same_bits(seeds: range) -> None:
    for seed in seeds:
        chance = random.Random(seed)
        file, text = _machine(chance), _program(chance)
        acts = {chance.randint(1, CYCLES): chance.choice(("override", "hold", "start")) for _ in range(6)}
        wanted = set(chance.sample(range(1, CYCLES), RESTORES))

        def made(file: MachineConfig = file, text: str = text) -> Control:
            control = Control(file, dialect="fanuc")
            control.programs.create("P", text)
            control.select_program("P")
            return control

        first = made()
        first.cycle_start()
        track, taken = [], []
        for cycle in range(1, CYCLES):
            _act(first, acts.get(cycle), cycle)
            first.advance(1)
            track.append(first.machine.state.setpoint.copy())
            if cycle in wanted:
                taken.append((cycle, first.snapshot()))
        for cycle, snapshot in taken:
            other = made()
            other.restore(snapshot)
            for later in range(cycle + 1, CYCLES):
                _act(other, acts.get(later), later)
                other.advance(1)
                assert np.array_equal(other.machine.state.setpoint, track[later - 1]), (seed, cycle, later)
