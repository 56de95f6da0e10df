"""Blocks that say nothing: empty ones, numbers and comments."""

from __future__ import annotations

import re

_SILENT = re.compile(r"(?:[\s%]|[nN][ \t]*[0-9]+|\([^()\r\n]*\)|;[^\r\n]*)*")


def is_silent(text: str) -> bool:
    """Tell whether a stretch of a program has no word but block numbers."""
    return _SILENT.fullmatch(text) is not None
