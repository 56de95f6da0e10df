"""What is executed: programs, sequence number, blocks read ahead, and where a start begins."""

from __future__ import annotations

import re
from dataclasses import dataclass

from polycnc.cnc import ControlError, Refusal, RunState
from polycnc.controllers.fanuc.device._device_state import DeviceState
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._power import Power
from polycnc.controllers.fanuc.device._programs import Programs, number_of
from polycnc.controllers.fanuc.device._remote_program import REMOTE_NAME
from polycnc.nc import BlockRecord
from polycnc.units import whole

_SEQUENCE = re.compile(rb"/?[0-9]?N([0-9]+)")


@dataclass(frozen=True, slots=True)
class MdiPointers:
    """Programs (0: the MDI program) and blocks, from 0, of what is executed and of what was read ahead last."""

    program: int
    block: int
    ahead_program: int
    ahead_block: int


class Execution:
    """Read what a Power Mate executes."""

    def __init__(self, power: Power, programs: Programs, state: DeviceState) -> None:
        self._power = power
        self._programs = programs
        self._state = state

    # ------------------------------------------------------------------ numbers

    @property
    def block(self) -> BlockRecord | None:
        """The block that is executed, or was last; None when there is none of a program that goes on."""
        return self._power.control.channel_status().block

    @property
    def _going_on(self) -> BlockRecord | None:
        """The block of a program that is executed or interrupted."""
        channel = self._power.control.channel_status()
        going = channel.active or channel.interrupted or channel.run_state is RunState.ALARM
        return channel.block if going else None

    @property
    def numbers(self) -> tuple[int, int]:
        """The numbers of the program in execution and of its main program; at rest both that of the selected one."""
        block = self._going_on
        if block is None:
            return self._programs.selected, self._programs.selected
        main = block.stack[0].program if block.stack else block.program
        return number_of(block.program), number_of(main)

    @property
    def sequence(self) -> int:
        """The last sequence number on the way to the executed block; at rest the one at the cursor."""
        block = self.block
        if self._state.cursor:
            return self._sequence_before(self._programs.selected, self._state.cursor + 1)
        if block is None:
            return 0
        if block.sequence is not None:
            return block.sequence
        places = [(call.program, call.line) for call in block.stack] + [(block.program, block.line)]
        for program, line in reversed(places):
            if program == REMOTE_NAME:
                break  # what has been executed of it is not kept
            if found := self._sequence_before(number_of(program), line, mdi=not number_of(program)):
                return found
        return 0

    def _sequence_before(self, number: int, line: int, *, mdi: bool = False) -> int:
        """Return the sequence number of a line, or of the last line before it that has one."""
        lines = self._lines(0 if mdi else number)
        for text in reversed(lines[:line]):
            if found := _SEQUENCE.match(text):
                return whole(found[1])
        return 0

    def _lines(self, number: int) -> list[bytes]:
        if number == 0:
            return [block.encode() for block in self._state.mdi.blocks]
        return self._programs.read(number).split(b"\n") if number in self._programs else []

    @property
    def count(self) -> int:
        """How many blocks have been executed since the program began, of those that move, dwell or have functions."""
        run = self._power.control.channels[0].run
        return 0 if run is None else run.reading.blocks_done

    # ------------------------------------------------------------------ texts

    @property
    def prepared(self) -> BlockRecord | None:
        """The block that was read ahead last."""
        return self._power.control.channels[0].prepared

    @property
    def ahead(self) -> int:
        """How many blocks are read ahead."""
        block, last = self._going_on, self.prepared
        if block is None or last is None or last.program != block.program:
            return 0 if last is None or block is None else 1
        return max(0, last.line - block.line)

    def text(self, most: int) -> bytes:
        """Return the program from the executed block on, or from the cursor at rest; at most so many characters."""
        block = self._going_on
        if block is not None and block.program == REMOTE_NAME:
            return block.text.encode()[:most]
        if block is not None:
            lines = self._lines(number_of(block.program))
            return b"\n".join(lines[block.line - 1 :])[:most]
        if self._state.mode is PowerMateMode.MDI:
            return b"\n".join(self._lines(0)[self._state.mdi.start :])[:most]
        if not self._programs.selected:
            return b""
        return b"\n".join(self._lines(self._programs.selected)[self._state.cursor :])[:most]

    @property
    def mdi_pointers(self) -> MdiPointers:
        """The pointers of MDI operation."""
        block, ahead = self._going_on, self.prepared
        start = self._state.mdi.start
        if block is None or ahead is None:
            return MdiPointers(0, start, 0, start)
        return MdiPointers(number_of(block.program), block.line - 1, number_of(ahead.program), ahead.line - 1)

    # ------------------------------------------------------------------ searches

    def search_sequence(self, sequence: int) -> bool:
        """Put the cursor of the selected program to the first block with this sequence number; tell if there is one.

        Raises:
            ControlError: A program is being executed or is interrupted.
        """
        self._check_idle()
        if not self._programs.selected:
            return False
        for line, text in enumerate(self._lines(self._programs.selected)):
            found = _SEQUENCE.match(text)
            if found and whole(found[1]) == sequence:
                self._state.cursor = line
                return True
        return False

    def rewind(self) -> None:
        """Put the cursor to the head of the selected program.

        Raises:
            ControlError: A program is being executed or is interrupted, or none is selected.
        """
        self._check_idle()
        if not self._programs.selected:
            raise ControlError(Refusal.NOT_FOUND, "no program is selected", hint="Select one.")
        self._state.cursor = 0

    def _check_idle(self) -> None:
        if self._programs.in_operation:
            raise ControlError(
                Refusal.RUNNING, "a program is being executed or is interrupted", hint="Reset it first."
            )
