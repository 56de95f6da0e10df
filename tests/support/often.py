"""How often a test of many cases runs: some of its cases always, all of them with the long mark."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest


def often(cases: Sequence[Any], always: int) -> list[Any]:
    """Return `always` of the cases, evenly from the first to the last, as they are and the others marked as long."""
    last = max(always - 1, 1)
    chosen = {round(k * (len(cases) - 1) / last) for k in range(always)}
    return [
        each if k in chosen else pytest.param(each, marks=pytest.mark.long) for k, each in enumerate(cases)
    ]
