"""The event loop that machines and their doors live in."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

R = TypeVar("R")


def run(main: Coroutine[Any, Any, R]) -> R:
    """Carry out `main` in the quickest event loop that this system has, and return its result."""
    try:
        import uvloop  # not for Windows
    except ImportError:
        return asyncio.run(main)
    return uvloop.run(main)
