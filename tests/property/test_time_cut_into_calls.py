"""However the same number of cycles is cut into calls, every device shows the same bits."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest

from support.cut_devices import DEVICES

CYCLES = 600
ALWAYS, LONG = range(4), range(4, 2004)


def _seen(device: Any) -> object:
    """Return all that can be seen of a device."""
    control = getattr(device, "control", device)
    timers = getattr(control, "timers", None)
    times = None if timers is None else [timers.seconds(each) for each in timers.snapshot().cycles]
    tools = None if timers is None else [timers.tool_seconds(each) for each in timers.tools]
    return device.status(), times, tools


@pytest.mark.parametrize(
    "seeds", [ALWAYS, pytest.param(LONG, marks=[pytest.mark.long, pytest.mark.timeout(0)])]
)
@pytest.mark.parametrize("kind", DEVICES)
def test_any_cut_of_the_same_cycles_gives_the_same_bits(kind: str, seeds: range, tmp_path: Path) -> None:
    for seed in seeds:
        by_ones, by_cuts, at_once = (
            DEVICES[kind](random.Random(seed), _folder(tmp_path, f"{seed}{which}")) for which in "abc"
        )
        rng = random.Random(-1 - seed)
        done = 0
        while done < CYCLES:
            cut = min(int(rng.expovariate(1.0 / rng.choice((3.0, 60.0)))) + 1, CYCLES - done)
            assert sum(by_ones.advance(1) for _ in range(cut)) == cut
            assert by_cuts.advance(cut) == cut
            done += cut
            assert _seen(by_cuts) == _seen(by_ones), f"seed {seed}, cycle {done}"
        assert at_once.advance(CYCLES) == CYCLES
        assert _seen(at_once) == _seen(by_ones), f"seed {seed} at once"


def _folder(parent: Path, name: str) -> Path:
    made = parent / name
    made.mkdir()
    return made
