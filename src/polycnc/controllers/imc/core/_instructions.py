"""What can be put into a queue, and how it is laid out there as a run of integers.

An instruction is `operation, cells, words, ...`: how many integers it takes here, and how many 16-bit words it would
take in the card, which is what the depth of a queue and its count register count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from polycnc.controllers.imc.core._event_codes import SHAPES, EventCommand, EventType, constant_words

WRITE, BITS, WAIT, EVENTS, SEGMENT, POINTS = 1, 2, 3, 4, 5, 6
HEADER = 3
LINE, ARC = 0, 1
EVENT_CELLS = 13


@dataclass(frozen=True, slots=True)
class Write:
    """Write `words` words (1, 2 or 3) of `value`, low word first, at `address`."""

    address: int
    value: int
    axis: int = 0
    words: int = 1


@dataclass(frozen=True, slots=True)
class WriteMany:
    """Write several parameters in the same control cycle."""

    writes: tuple[Write, ...]


@dataclass(frozen=True, slots=True)
class ChangeBits:
    """Replace a word by (word OR `ors`) XOR `xors`."""

    address: int
    ors: int
    xors: int
    axis: int = 0


@dataclass(frozen=True, slots=True)
class WaitTime:
    """Wait `milliseconds`, for ever if 0 or negative."""

    milliseconds: int


@dataclass(frozen=True, slots=True)
class WaitParam:
    """Wait until a word AND `mask` is `data`, at most `timeout` ms, for ever if 0 or negative."""

    address: int
    data: int
    timeout: int = 0
    axis: int = 0
    mask: int = 0xFFFF


@dataclass(frozen=True, slots=True)
class Event:
    """An event; `second` is an address, or `constant` holds the second operand, as the command says."""

    command: EventCommand
    type: EventType
    first: int = 0
    first_axis: int = 0
    second: int = 0
    second_axis: int = 0
    constant: int = 0
    target: int = 0
    target_axis: int = 0


@dataclass(frozen=True, slots=True)
class InstallEvents:
    """Add events to those that are installed."""

    events: tuple[Event, ...]


@dataclass(frozen=True, slots=True)
class Segment:
    """A segment of a path: a line, or an arc in the first two coordinates with lines in the others.

    `speed` and `end_speed` (S16.16) are written to the registers of the space first; None leaves these as they are.
    """

    ends: tuple[int, ...]
    center: tuple[int, int] | None = None
    clockwise: bool = False
    speed: int | None = None
    end_speed: int = 0


@dataclass(frozen=True, slots=True)
class Points:
    """Points of a contour that a path space goes along: displacements, all axes of a point one after the other."""

    displacements: tuple[int, ...]


Instruction: TypeAlias = (
    Write | WriteMany | ChangeBits | WaitTime | WaitParam | InstallEvents | Segment | Points
)


def signed(value: int, words: int) -> int:
    """Return the low `words` words of a number as a signed one."""
    bits = 16 * words
    low = int(value) & ((1 << bits) - 1)
    return low - (1 << bits) if low >> (bits - 1) else low


def _writes(writes: Sequence[Write]) -> list[int]:
    cells = [len(writes)]
    for each in writes:
        cells += (each.address, each.axis, each.words, signed(each.value, each.words))
    return _framed(WRITE, cells, max(1, sum(2 + each.words for each in writes)))


def _framed(operation: int, cells: list[int], words: int) -> list[int]:
    return [operation, HEADER + len(cells), words, *cells]


def written_words(instruction: Instruction) -> frozenset[int]:
    """Return the addresses that an instruction writes when it is carried out."""
    match instruction:
        case Write(address=at, words=words):
            return frozenset(range(at, at + words))
        case WriteMany(writes=writes):
            return frozenset().union(*map(written_words, writes))
        case ChangeBits(address=at):
            return frozenset((at,))
    return frozenset()


def words_of(instruction: Instruction) -> int:
    """Return how many 16-bit words an instruction takes in a queue."""
    return encode(instruction)[2]


def encode(instruction: Instruction) -> list[int]:
    """Return an instruction as it is put into a queue."""
    match instruction:
        case Write():
            return _writes((instruction,))
        case WriteMany(writes):
            return _writes(writes)
        case ChangeBits(address, ors, xors, axis):
            return _framed(BITS, [address, axis, ors, xors], 4)
        case WaitTime(milliseconds):
            return _framed(WAIT, [-1, 0, 0, 0, milliseconds], 3)
        case WaitParam(address, data, timeout, axis, mask):
            return _framed(WAIT, [address, axis, mask & 0xFFFF, data & 0xFFFF, timeout], 6)
        case InstallEvents(events):
            cells = [len(events)]
            for e in events:
                cells += SHAPES[e.command]
                constant = signed(e.constant, constant_words(e.command) or 1)
                cells += (int(e.type), e.first, e.first_axis, e.second, e.second_axis, constant)
                cells += (e.target, e.target_axis)
            return _framed(EVENTS, cells, 1 + 12 * len(events))
        case Segment(ends, center, clockwise, speed, end_speed):
            x, y = center or (0, 0)
            cells = [LINE if center is None else ARC, int(speed is not None), len(ends)]
            cells += (speed or 0, end_speed, x, y, 0 if clockwise else 1, *ends)
            words = 2 + 2 * len(ends) + (4 if speed is not None else 0) + (5 if center is not None else 0)
            return _framed(SEGMENT, cells, words)
        case Points(displacements):
            return _framed(POINTS, [signed(each, 1) for each in displacements], 1 + len(displacements))
