"""Programs coming in as a stream of characters, cut anywhere, and going out as one.

The stream is LF O1234 LF block LF ... LF %; what stands before the first LF is ignored (Manual 000, cnc_download).
Nothing is registered before `finish`, so a transfer that is cut leaves no half program.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.device._programs import FIRST, LAST, Programs, name_of
from polycnc.units import whole

LF = b"\n"
_BLOCK_OK = frozenset(b"ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-./*=,#[]&?@: ")
_NUMBER = re.compile(rb"O([0-9]{1,8})(?![0-9])")
_PROGRAM_END = re.compile(rb"M0*(?:2|30|99)(?![0-9.])")
_COMMENT = re.compile(rb"\([^)]*\)")


class Fault(Enum):
    """What is wrong with a stream."""

    NUMBER = "the program does not begin with O and a number from 1 to 9999"
    REGISTERED = "a program of this number is registered"
    SELECTED = "the program of this number is selected"
    CHARACTER = "a character that programs do not have"
    TV = "a block with an odd number of characters"
    UNFINISHED = "the stream does not end in %"
    DIFFERENT = "the program differs from the registered one"
    PROTECTED = "parameters protect programs of this number"
    FULL = "the memory is full"
    RESET = "RESET or STOP was pressed"


class TransferError(Exception):
    """A stream that is not taken."""

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault.value)
        self.fault = fault


def stored_block(block: bytes, *, tv_check: bool) -> bytes:
    """Return a block as the memory keeps it: without spaces outside comments.

    `block` has no LF; with `tv_check` it must have an even number of characters together with it.

    Raises:
        TransferError: An odd number of characters, a character that cannot be used, a comment without end.
    """
    if tv_check and len(block) % 2 == 0:
        raise TransferError(Fault.TV)
    made = bytearray()
    in_comment = False
    for byte in block:
        if in_comment:
            if not 0x20 <= byte < 0x7F or byte in b"(%":
                raise TransferError(Fault.CHARACTER)
            in_comment = byte != ord(")")
            made.append(byte)
        elif byte == ord("("):
            in_comment = True
            made.append(byte)
        elif byte not in _BLOCK_OK:
            raise TransferError(Fault.CHARACTER)
        elif byte != ord(" "):
            made.append(byte)
    if in_comment:
        raise TransferError(Fault.CHARACTER)
    return bytes(made)


def program_number(block: bytes) -> int:
    """Return the number of a program from its first block.

    Raises:
        TransferError: It is none.
    """
    found = _NUMBER.match(block)
    if found is None or not FIRST <= whole(found[1]) <= LAST:
        raise TransferError(Fault.NUMBER)
    return whole(found[1])


@dataclass(slots=True)
class ProgramStream:
    """Cut a stream into blocks and programs; `on_program` and `on_block` may refuse."""

    tv_check: bool
    ends_at_m: bool
    on_program: Callable[[int], None]
    on_block: Callable[[bytes], None]
    programs: list[tuple[int, list[bytes]]] = field(default_factory=list)
    ended: bool = False
    _begun: bool = False
    _open: bool = False
    _rest: bytes = b""

    def take(self, data: bytes) -> None:
        """Take a piece.

        Raises:
            TransferError: The stream is wrong up to here.
        """
        if self.ended:
            return
        data = self._rest + data
        if not self._begun:
            at = data.find(LF)
            if at < 0:
                return
            self._begun, data = True, data[at + 1 :]
        *blocks, self._rest = data.split(LF)
        for block in blocks:
            if block.startswith(b"%"):
                self._end()
                return
            self._block(block)
        if self._rest.startswith(b"%"):
            self._end()

    @property
    def begun(self) -> bool:
        """Whether the first end of block has come, up to which everything is skipped."""
        return self._begun

    @property
    def waiting(self) -> int:
        """How many characters of a block have come whose end has not."""
        return len(self._rest)

    def _end(self) -> None:
        if not self.programs:
            raise TransferError(Fault.NUMBER)
        self.ended, self._rest = True, b""

    def _block(self, block: bytes) -> None:
        kept = stored_block(block, tv_check=self.tv_check)
        if not kept:
            return
        if kept.startswith(b"O") or not self._open:
            number = program_number(kept)
            self.on_program(number)
            head = name_of(number).encode() + kept[_NUMBER.match(kept).end() :]  # type: ignore[union-attr]
            self.programs.append((number, [head]))
            self._open = True
        else:
            self.programs[-1][1].append(kept)
        self.on_block(kept)
        if self.ends_at_m and _PROGRAM_END.search(_COMMENT.sub(b"", kept)):
            self._open = False


def text_of(blocks: list[bytes]) -> bytes:
    """Return a program as the memory keeps it."""
    return b"".join(block + LF for block in blocks)


class Transfer:
    """The one transfer into the control: a download, or a comparison with what is registered."""

    def __init__(
        self, programs: Programs, parameters: Parameters, *, compare: bool = False, owner: object = None
    ) -> None:
        self.compare = compare
        self.owner = owner  # whose end ends the transfer
        self.fault: Fault | None = None
        self._programs = programs
        self._replaces = parameters.bit(3201, 2)
        self._characters = 0
        self._room = programs.memory.free_bytes or 0
        self._stream = ProgramStream(
            tv_check=parameters.bit(0, 0),
            ends_at_m=not parameters.bit(3201, 6),
            on_program=self._check_program,
            on_block=self._count,
        )

    @property
    def begun(self) -> bool:
        """Whether anything has come that counts."""
        return self._stream.begun

    def stop(self) -> None:
        """RESET or STOP was pressed: nothing more is taken, and nothing will be registered."""
        self.fault = Fault.RESET

    def take(self, data: bytes) -> None:
        """Take a piece; a transfer that has failed stays failed.

        Raises:
            TransferError: The stream is refused, or RESET or STOP was pressed.
        """
        if self.fault is not None:
            raise TransferError(self.fault)
        try:
            self._stream.take(data)
            if not self.compare and self._characters + self._stream.waiting > self._room:
                raise TransferError(Fault.FULL)
        except TransferError as error:
            self.fault = error.fault
            raise

    def finish(self) -> None:
        """Register what has come, all of it or nothing; after a reset nothing, and that is no error.

        Raises:
            TransferError: The stream was refused, is not complete, or cannot be registered any more.
        """
        if self.fault is Fault.RESET:
            return
        if self.fault is not None:
            raise TransferError(self.fault)
        if not self._stream.ended:
            raise TransferError(Fault.UNFINISHED)
        programs = {number: text_of(blocks) for number, blocks in self._stream.programs}
        if self.compare:
            self._compare(programs)
            return
        try:
            with self._programs.transaction():
                for number, content in programs.items():
                    self._check_program(number, again=True)
                    self._programs.register(number, content)
        except ControlError as error:
            faults = {Refusal.FULL: Fault.FULL, Refusal.PROTECTED: Fault.PROTECTED}
            raise TransferError(faults.get(error.reason, Fault.REGISTERED)) from error

    def _compare(self, programs: dict[int, bytes]) -> None:
        known = self._programs
        if any(number not in known or known.read(number) != text for number, text in programs.items()):
            raise TransferError(Fault.DIFFERENT)

    def _check_program(self, number: int, *, again: bool = False) -> None:
        if self.compare:
            return
        if self._programs.parameter_protects(number):
            raise TransferError(Fault.PROTECTED)
        if number == self._programs.selected:
            raise TransferError(Fault.SELECTED)
        twice = not again and any(number == known for known, _ in self._stream.programs)
        if twice or (number in self._programs and not self._replaces):
            raise TransferError(Fault.REGISTERED)

    def _count(self, block: bytes) -> None:
        self._characters += len(block) + 1
        if not self.compare and self._characters > self._room:
            raise TransferError(Fault.FULL)


class Upload:
    """A program going out: % LF O1234 LF block LF ... LF %, in pieces of any size; it ends with the power."""

    def __init__(self, content: bytes, power_ups: int = 0) -> None:
        self.power_ups = power_ups
        self._left = b"%\n" + content + b"%"

    def read(self, most: int) -> bytes:
        """Return the next characters, at most so many; none come after the last %."""
        piece, self._left = self._left[:most], self._left[most:]
        return piece
