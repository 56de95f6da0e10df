"""What all macro programs of one run share."""

from __future__ import annotations

from typing import Protocol

from polycnc.nc.macro._host import Host
from polycnc.nc.macro._macro_state import ModalCall
from polycnc.nc.macro._output import OutputDevice
from polycnc.nc.macro._system import SystemVariables
from polycnc.nc.macro._variables import MacroVariables


class RunState(Protocol):
    """The language as its sources see it: variables, modal calls, interrupts and jumps under way."""

    variables: MacroVariables
    system: SystemVariables
    output: OutputDevice
    modals: tuple[ModalCall, ...]
    interrupt_program: int | None
    pending: int | None
    codes_off: int
    turns: int
    longest_loop_pauses: int | None

    @property
    def channel(self) -> Host:
        """The channel that the language works for."""
        ...

    def take_interrupt(self) -> bool:
        """Tell whether the interrupt signal has come since this was asked last."""
        ...

    def note_level(self) -> None:
        """Remember the local variables of the macro that begins, for those who look at the block executed."""
        ...

    def bindings(self) -> dict[str, object]:
        """Return the functions and operators as compiled programs call them, and what they are set to."""
        ...
