"""Why a control refuses a command: one error class, told apart by a reason that programs can compare."""

from __future__ import annotations

from enum import StrEnum

from polycnc.errors import PolycncError


class Refusal(StrEnum):
    """Why a command was refused."""

    MODE = "mode"  # not in this mode
    RUNNING = "running"  # a program or a motion is running
    IDLE = "idle"  # nothing is running that could be stopped or continued
    ALARM = "alarm"  # an alarm must be cleared first
    EMERGENCY = "emergency"  # the emergency stop is on
    HELD = "held"  # a signal of feed hold is given
    TRAVEL = "travel"  # the axis stands at the end of its travel in that direction
    DISPLACED = "displaced"  # an axis is not where the program was interrupted
    NOT_REFERENCED = "not_referenced"  # an axis must be referenced first
    NOT_FOUND = "not_found"  # there is nothing of that name or number
    EXISTS = "exists"  # there is something of that name already
    PROTECTED = "protected"  # a program, or the whole memory, must not be changed
    IN_USE = "in_use"  # the program is being executed or edited
    FULL = "full"  # no room in the memory
    DATA = "data"  # a number, name or text that cannot be meant
    SNAPSHOT = "snapshot"  # of another machine or control


class ControlError(PolycncError):
    """A command that a control refuses; nothing has changed."""

    def __init__(self, reason: Refusal, what: str, *, hint: str = "") -> None:
        super().__init__(what, hint=hint)
        self.reason = reason
