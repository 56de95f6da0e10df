"""What custom macros ask of the channel that they work for."""

from __future__ import annotations

from typing import Protocol

from polycnc.machine import Machine
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._suppressed import Suppressed
from polycnc.nc.records._block_records import Call
from polycnc.nc.text._program import ProgramText


class Host(Protocol):
    """The channel: what it prepares for, what is in force, and which programs it knows."""

    dialect: Dialect
    machine: Machine
    path: int
    messages: Messages
    state: ChannelState
    skip_levels: frozenset[int]
    suppressed: Suppressed

    @property
    def stack(self) -> tuple[Call, ...]:
        """The calls that led to what is prepared now, the outermost first."""
        ...

    @property
    def depth(self) -> int:
        """How deep the present program is nested; 0 is the main program."""
        ...

    def sub_program(self, number: int) -> ProgramText | None:
        """Return the text that a sub-program stands in, None if there is none."""
        ...
