"""How often a test of many cases runs: some of its cases always, all of them when long tests are asked for."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import pytest

ALL_CASES = "POLYCNC_ALL_CASES"
"""The environment variable that lets every test run with all its cases (`-m "long or not long"` sets it)."""


def often(cases: Sequence[Any], always: int) -> list[Any]:
    """Return `always` of the cases, evenly from the first to the last, and the others marked as long.

    A tuple is the values of several arguments.
    """
    last = max(always - 1, 1)
    chosen = {round(k * (len(cases) - 1) / last) for k in range(always)}
    rows = [each if type(each) is tuple else (each,) for each in cases]
    return [pytest.param(*row, marks=() if k in chosen else pytest.mark.long) for k, row in enumerate(rows)]


def share(count: int) -> int:
    """Return how many of `count` random cases are tried: half of a few, a sixth of many; or all."""
    return count if ALL_CASES in os.environ else max((min(count, 20) + 1) // 2, count // 6)
