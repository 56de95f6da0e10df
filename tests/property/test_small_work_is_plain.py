"""What is done uncompiled before it pays to compile gives the same bits as compiled code, for machines of all kinds."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from polycnc.kernel import advance

SCRIPT = """
import json
from polycnc.jit._plain import ALLOWANCE
ALLOWANCE.left = 1 << 40
from property.test_small_work_is_plain import digests
print(json.dumps(digests()))
"""


def _test(name: str) -> Any:
    return importlib.import_module(f"property.{name}")


def _positions() -> list[str]:
    paths = _test("test_motion_keeps_limits")
    state = paths.random_path(4, paths.PathSettings(tolerance=0.02, jerkrel=0.3))
    found = []
    for _ in range(150):
        advance(state, 3)
        found += [value.hex() for value in state.setpoint.tolist()]
    return found


def digests() -> list[object]:
    """Return what some programs, boards, cards and paths come to."""
    boards = _test("test_apci_motion_properties")
    return [
        _test("test_uncompiled_preparation").digest(),
        boards.digest(boards.session(7, 12)),
        _test("test_imc_properties").digest(),
        _positions(),
    ]


def test_plain_and_compiled_work_are_the_same_to_the_last_bit(tmp_path: Path) -> None:
    folders = [str(Path(__file__).parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])]
    cold = {"POLYCNC_CACHE_DIR": str(tmp_path / "cache"), "POLYCNC_COMPILE_AT_ONCE": ""}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", SCRIPT],
        env={**os.environ, **cold, "PYTHONPATH": os.pathsep.join(folders)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout) == digests()
    assert not (tmp_path / "cache").exists()
