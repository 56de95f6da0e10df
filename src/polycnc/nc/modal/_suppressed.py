"""What a program keeps from acting."""

from __future__ import annotations

from typing import NamedTuple


class Suppressed(NamedTuple):
    """What a program keeps from acting (#3003, #3004): single block, waits for functions, feed hold, feed override."""

    single_block: bool = False
    answers: bool = False
    hold: bool = False
    override: bool = False
