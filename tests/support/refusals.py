"""Calls that a function refuses: each case claims the code that it ends with."""

from __future__ import annotations

from typing import Any

import pytest


def refused(function: str, *cases: tuple[Any, ...]) -> list[Any]:
    """Return cases of a function, each as one that claims the row of its code, the last of its values."""
    return [
        pytest.param(*case, marks=pytest.mark.covers(f"fanuc.{function}.err.{case[-1]}")) for case in cases
    ]
