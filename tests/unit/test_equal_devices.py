"""Devices that were made and moved alike have equal snapshots, byte by byte, in this process and in every other."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from support import equal_devices
from support.often import often


def _elsewhere(**environment: str) -> dict[str, list[str]]:
    """Return the digests that a fresh process finds."""
    done = subprocess.run(
        [sys.executable, equal_devices.__file__],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    found: dict[str, list[str]] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("kind", equal_devices.KINDS)
def test_two_devices_of_a_kind_have_equal_snapshots(kind: str) -> None:
    first = equal_devices.digests(kind)
    assert len(set(first)) == len(first) > 1
    assert equal_devices.digests(kind) == first


@pytest.mark.parametrize(("seed", "fill"), often([("11", "85"), ("4242", "170")], 1))
def test_snapshots_hold_no_memory_that_was_never_set_and_no_order_of_a_hash(seed: str, fill: str) -> None:
    # glibc fills what it allocates and frees with a byte that is another one in each process
    here = {kind: equal_devices.digests(kind) for kind in equal_devices.KINDS}
    assert _elsewhere(PYTHONHASHSEED=seed, MALLOC_PERTURB_=fill) == here
