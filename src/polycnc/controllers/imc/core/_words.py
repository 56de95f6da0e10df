"""Read and write numbers in the parameter memory, low word first; plain Python integers in, plain integers out."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled

Memory = npt.NDArray[np.int16]

FLAG = -1  # a flag that is set, FFFFh
ONE = 65536  # 1 in S16.16, and a pulse in the integers of positions
HIGHEST_32 = (1 << 31) - 1
LOWEST_32 = -(1 << 31)


@compiled
def wrap16(value: int) -> int:
    """Return the low 16 bits as a signed number."""
    return ((value & 0xFFFF) ^ 0x8000) - 0x8000


@compiled
def wrap32(value: int) -> int:
    """Return the low 32 bits as a signed number."""
    return ((value & 0xFFFFFFFF) ^ 0x80000000) - 0x80000000


@compiled
def wrap48(value: int) -> int:
    """Return the low 48 bits as a signed number."""
    return ((value & 0xFFFFFFFFFFFF) ^ 0x800000000000) - 0x800000000000


@compiled
def clip32(value: int) -> int:
    """Return the nearest number of 32 bits."""
    if value > HIGHEST_32:
        return HIGHEST_32
    return LOWEST_32 if value < LOWEST_32 else value


@compiled
def get16(memory: Memory, row: int, at: int) -> int:
    """Return a signed word."""
    return int(memory[row, at])


@compiled
def get_u16(memory: Memory, row: int, at: int) -> int:
    """Return an unsigned word."""
    return int(memory[row, at]) & 0xFFFF


@compiled
def get32(memory: Memory, row: int, at: int) -> int:
    """Return a signed number of two words."""
    return (int(memory[row, at]) & 0xFFFF) | (int(memory[row, at + 1]) << 16)


@compiled
def get_u32(memory: Memory, row: int, at: int) -> int:
    """Return an unsigned number of two words."""
    return (int(memory[row, at]) & 0xFFFF) | ((int(memory[row, at + 1]) & 0xFFFF) << 16)


@compiled
def get48(memory: Memory, row: int, at: int) -> int:
    """Return a signed number of three words."""
    return get_u32(memory, row, at) | (int(memory[row, at + 2]) << 32)


@compiled
def get_words(memory: Memory, row: int, at: int, words: int) -> int:
    """Return a signed number of one, two or three words."""
    if words == 1:
        return int(memory[row, at])
    return get32(memory, row, at) if words == 2 else get48(memory, row, at)


@compiled
def put16(memory: Memory, row: int, at: int, value: int) -> None:
    """Write the low 16 bits of `value`."""
    memory[row, at] = ((value & 0xFFFF) ^ 0x8000) - 0x8000


@compiled
def put32(memory: Memory, row: int, at: int, value: int) -> None:
    """Write the low 32 bits of `value`."""
    memory[row, at] = ((value & 0xFFFF) ^ 0x8000) - 0x8000
    memory[row, at + 1] = (((value >> 16) & 0xFFFF) ^ 0x8000) - 0x8000


@compiled
def put48(memory: Memory, row: int, at: int, value: int) -> None:
    """Write the low 48 bits of `value`."""
    put32(memory, row, at, value)
    memory[row, at + 2] = (((value >> 32) & 0xFFFF) ^ 0x8000) - 0x8000


@compiled
def wrap_words(value: int, words: int) -> int:
    """Return the low bits of one, two or three words as a signed number."""
    if words == 1:
        return wrap16(value)
    return wrap32(value) if words == 2 else wrap48(value)


@compiled
def scaled(value: int, ratio: int) -> tuple[int, int]:
    """Return `value` (32 bits) times `ratio` (S16.32) as whole part and 32 bits of fraction, exactly."""
    low = value * (ratio & 0xFFFFFFFF)
    return value * (ratio >> 32) + (low >> 32), low & 0xFFFFFFFF
