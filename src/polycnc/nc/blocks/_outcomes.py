"""How a program continues after a block: calls of sub-programs, returns, stops and ends."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from polycnc.nc.modal._actions import MAction
from polycnc.nc.text._place import Place

Problem = tuple[str, str, str]
"""What is wrong, what to do and its code, of something that is not a matter of the block's words alone."""


class Continuation(Enum):
    """What comes after a block."""

    NEXT = "next"
    CALL = "call"
    RETURN = "return"
    STOP = "stop"
    END = "end"
    GO_ON = "go on"


@dataclass(frozen=True, slots=True)
class Outcome:
    """Say how the program goes on; a call names the sub-program and how often it runs, GO_ON a place."""

    continuation: Continuation = Continuation.NEXT
    program: int = 0
    repeats: int = 1
    place: Place | None = None


NEXT = Outcome()
JUMPS = (MAction.SUB_CALL, MAction.SUB_RETURN)  # never leave the control
