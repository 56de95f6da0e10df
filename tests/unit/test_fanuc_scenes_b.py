"""What a Power Mate does with each function of the manual's second half, all of it, in `tests/golden/fanuc_b/NAME.txt`.

A scene drives a whole control through states; every call with its answer, and everything that the library can read and
that has changed by it, is written down. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from support import (
    fanuc_scenes_b_history,
    fanuc_scenes_b_motion,
    fanuc_scenes_b_panel,
    fanuc_scenes_b_state,
)
from support.fanuc_scenes_b import Bench

RECORDED = Path(__file__).parents[1] / "golden" / "fanuc_b"
SCENES: dict[str, Callable[[Bench], None]] = {
    act.__name__: act
    for part in (fanuc_scenes_b_panel, fanuc_scenes_b_motion, fanuc_scenes_b_state, fanuc_scenes_b_history)
    for act in part.SCENES
}


@pytest.mark.parametrize("name", SCENES)
def test_a_power_mate_does_what_is_written_down(name: str, request: pytest.FixtureRequest) -> None:
    bench = Bench()
    SCENES[name](bench)
    file, found = RECORDED / f"{name}.txt", bench.text()
    if request.config.getoption("update_goldens"):
        file.write_text(found, encoding="utf-8")
    assert found.splitlines() == file.read_text(encoding="utf-8").splitlines()
