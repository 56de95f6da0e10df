"""Take instructions out of the queues and carry them out, and wait where they say so."""

from __future__ import annotations

from polycnc.controllers.imc.core._addresses import COUNTS, EVENTS, WAIT_TIMES
from polycnc.controllers.imc.core._instructions import BITS, EVENT_CELLS, HEADER, POINTS, SEGMENT, WAIT, WRITE
from polycnc.controllers.imc.core._instructions import EVENTS as INSTALL
from polycnc.controllers.imc.core._state import EVENTS_MOST, CardState
from polycnc.controllers.imc.core._words import get32, get_u16, put16, put32
from polycnc.controllers.imc.core._write_effects import row_of, write_words
from polycnc.kernel import compiled

# What became of a queue's turn.
EMPTY = 0
DONE = 1
BLOCKED = 2
AT_SEGMENT = 3  # a segment of a path has been reached; it is still in the queue


@compiled
def cell(s: CardState, f: int, k: int) -> int:
    """Return integer `k` of the instruction at the head of queue `f`."""
    return int(s.ring[f, (s.fifo[f]["head"] + k) & (s.ring.shape[1] - 1)])


@compiled
def drop_head(s: CardState, f: int) -> None:
    """Take the instruction at the head of queue `f` out of it."""
    q = s.fifo[f]
    q["words"] -= cell(s, f, 2)
    q["head"] += cell(s, f, 1)
    put16(s.memory, s.axis.shape[0], COUNTS[f], q["words"])


@compiled
def drop_point(s: CardState, f: int, count: int) -> None:
    """Take the first point, of `count` displacements, out of the points at the head of queue `f`."""
    size, words = cell(s, f, 1), cell(s, f, 2)
    if size - count <= HEADER:
        drop_head(s, f)
        return
    q, ring = s.fifo[f], s.ring
    mask = ring.shape[1] - 1
    head = q["head"] + count
    ring[f, (head + 2) & mask] = words - count
    ring[f, (head + 1) & mask] = size - count
    ring[f, head & mask] = POINTS
    q["head"] = head
    q["words"] -= count
    put16(s.memory, s.axis.shape[0], COUNTS[f], q["words"])


@compiled
def _is_met(s: CardState, f: int) -> bool:
    """Tell whether what queue `f` waits for is so."""
    q = s.fifo[f]
    row = row_of(s, q["address"], q["axis"])
    return row >= 0 and get_u16(s.memory, row, q["address"]) & q["mask"] == q["data"]


@compiled
def _wait_is_over(s: CardState, f: int) -> bool:
    """Take the wait of queue `f` one control cycle on; a time of 0 left, that a client may write, ends it."""
    n = s.axis.shape[0]
    at = WAIT_TIMES[f]
    left = get32(s.memory, n, at)
    if left > 0:
        left -= 1
        put32(s.memory, n, at, left)
    if left == 0:
        return True
    if _is_met(s, f):
        put32(s.memory, n, at, 0)
        return True
    return False


@compiled
def _begin_wait(s: CardState, f: int) -> None:
    q = s.fifo[f]
    q["address"] = cell(s, f, HEADER)
    q["axis"] = cell(s, f, HEADER + 1)
    q["mask"] = cell(s, f, HEADER + 2)
    q["data"] = cell(s, f, HEADER + 3)
    if _is_met(s, f):
        return
    time = cell(s, f, HEADER + 4)
    q["waiting"] = 1
    put32(s.memory, s.axis.shape[0], WAIT_TIMES[f], time if time > 0 else -1)


@compiled
def _install(s: CardState, f: int) -> None:
    """Append events, as many as there is room for."""
    card = s.card[0]
    for k in range(cell(s, f, HEADER)):
        if card["events"] >= EVENTS_MOST:
            break
        event = s.event[card["events"]]
        at = HEADER + 1 + k * EVENT_CELLS
        event["operation"] = cell(s, f, at)
        event["first_words"] = cell(s, f, at + 1)
        event["second_words"] = cell(s, f, at + 2)
        event["words"] = cell(s, f, at + 3)
        event["boolean"] = cell(s, f, at + 4)
        event["type"] = cell(s, f, at + 5)
        event["first"] = cell(s, f, at + 6)
        event["first_row"] = row_of(s, cell(s, f, at + 6), cell(s, f, at + 7))
        event["second"] = cell(s, f, at + 8)
        event["second_row"] = row_of(s, cell(s, f, at + 8), cell(s, f, at + 9))
        event["constant"] = cell(s, f, at + 10)
        event["target"] = cell(s, f, at + 11)
        event["target_axis"] = cell(s, f, at + 12)
        event["held"] = -1
        card["events"] += 1
    put16(s.memory, s.axis.shape[0], EVENTS, card["events"])


@compiled
def _write(s: CardState, f: int, operation: int) -> None:
    """Carry out a write of some parameters, or a change of bits."""
    count = cell(s, f, HEADER) if operation == WRITE else 1
    for k in range(count):
        at = HEADER + 1 + 4 * k if operation == WRITE else HEADER
        address, axis = cell(s, f, at), cell(s, f, at + 1)
        words, value = cell(s, f, at + 2), cell(s, f, at + 3)
        if operation != WRITE:
            row = row_of(s, address, axis)
            old = get_u16(s.memory, row, address) if row >= 0 else 0
            value = (old | words) ^ value
            words = 1
        write_words(s, address, axis, words, value)


@compiled
def _carry_out(s: CardState, f: int, operation: int) -> None:
    if operation in (WRITE, BITS):
        _write(s, f, operation)
    elif operation == WAIT:
        _begin_wait(s, f)
    elif operation == INSTALL:
        _install(s, f)


@compiled
def take_instruction(s: CardState, f: int) -> int:
    """Carry out the next instruction of queue `f`, unless it waits; tell what became of its turn."""
    q = s.fifo[f]
    if q["waiting"] != 0:
        if not _wait_is_over(s, f):
            return BLOCKED
        q["waiting"] = 0
    if q["head"] == q["tail"]:
        return EMPTY
    operation = cell(s, f, 0)
    if operation in (SEGMENT, POINTS):
        return AT_SEGMENT
    head, size, words = q["head"], cell(s, f, 1), cell(s, f, 2)
    _carry_out(s, f, operation)
    if q["head"] == head and q["tail"] != head:  # unless it has emptied this queue itself
        q["head"] += size
        q["words"] -= words
    put16(s.memory, s.axis.shape[0], COUNTS[f], q["words"])
    return DONE if q["waiting"] == 0 else BLOCKED
