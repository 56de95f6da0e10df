"""What a whole Power Mate tells programs on a PC, written down in `tests/golden/fanuc_a/NAME.txt`.

Manual 000, first half; the numbers were compared with it when they were written down. Here nothing can change unseen:
positions in every unit, refusals with every argument, each program function in every state, each parameter with both
ends of its range. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import zip_longest
from pathlib import Path

import pytest

from polycnc.controllers.fanuc import fwlib
from support import fanuc_scenes_a_axes as axes
from support import fanuc_scenes_a_data as data
from support import fanuc_scenes_a_programs as programs
from support import fanuc_scenes_a_walk as walk
from support import fanuc_scenes_a_wire as wire
from support.fanuc_scenes_a import Bench

RECORDED = Path(__file__).parents[1] / "golden" / "fanuc_a"
SCENES: dict[str, Callable[[Bench], None]] = {
    "moves": axes.moves,
    "refusals": axes.refusals,
    "structures": axes.structures,
    "alarms": axes.alarms,
    "transfers": programs.transfers,
    "rules": programs.rules,
    "directory": programs.directory,
    "execution": programs.execution,
    "mdi": programs.mdi,
    "states": programs.states,
    "offsets": data.offsets,
    "parameters": data.parameters,
    "ranges": data.ranges,
    "effects": data.effects,
    "macros": data.macros,
    "handles": data.handles,
    "feeds": walk.feeds,
    "wire": wire.wire,
    **{name: partial(walk.walk, name) for name in walk.WALKS},
}


@pytest.mark.parametrize("name", SCENES)
def test_a_control_tells_what_is_written_down(name: str, request: pytest.FixtureRequest) -> None:
    bench = Bench()
    SCENES[name](bench)
    fwlib.detach()
    file = RECORDED / f"{name}.txt"
    if request.config.getoption("update_goldens"):
        file.write_text("\n".join([*bench.lines, ""]), encoding="utf-8")
    wanted = file.read_text(encoding="utf-8").splitlines()
    different = next(
        (pair for pair in zip_longest(bench.lines, wanted, fillvalue="nothing") if pair[0] != pair[1]), None
    )
    assert different is None, f"{different[0]} instead of {different[1]}"
