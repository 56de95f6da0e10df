"""Run the installed events once: two's complement arithmetic, triggers on the result of the last unconditional one."""

from __future__ import annotations

import numpy as np

from polycnc.controllers.imc.core._event_codes import ADD, AND, COMPARE, MULTIPLY, OR, SCALE, TAKE
from polycnc.controllers.imc.core._parameters import WORDS
from polycnc.controllers.imc.core._state import CardState
from polycnc.controllers.imc.core._words import FLAG, get_words, wrap_words
from polycnc.controllers.imc.core._write_effects import write_words
from polycnc.kernel import compiled

_LAST_EDGE = 7  # types 1 to 7 are edges, 8 to 14 the same conditions as levels
_MASK_48 = (1 << 48) - 1


@compiled
def scale(value: int, factor: int) -> int:
    """Return `value` times `factor` (S16.32), rounded down; both have up to 48 bits."""
    low = factor & 0xFFFFFFFF
    return value * (factor >> 32) + (((value >> 16) * low + ((value & 0xFFFF) * low >> 16)) >> 16)


@compiled
def scale_short(value: int, factor: int) -> int:
    """Return `value` times `factor` (S32.16), rounded down; both have up to 48 bits, as has what is kept of it."""
    return value * (factor >> 16) + (value * (factor & 0xFFFF) >> 16)


@compiled
def condition(kind: int, result: int, carry: int) -> bool:
    """Tell whether the condition of an event type (1 to 7, or 8 to 14) holds for a result."""
    which = kind if kind <= _LAST_EDGE else kind - _LAST_EDGE
    if which == 1:
        return result == 0
    if which == 2:
        return result != 0
    if which == 3:
        return result > 0
    if which == 4:
        return result >= 0
    if which == 5:
        return result < 0
    return carry != 0 if which == 6 else carry == 0


@compiled
def _operand(s: CardState, row: int, at: int, words: int) -> int:
    if row < 0 or at + words > WORDS:
        return 0
    return get_words(s.memory, row, at, words)


@compiled
def computed(operation: int, a: int, b: int) -> int:
    """Return the exact result of an operation on signed numbers."""
    if operation == ADD:
        return a + b
    if operation == COMPARE:
        return a - b
    if operation == SCALE:
        return scale(a, b)
    if operation == MULTIPLY:
        return a * b
    if operation == TAKE:
        return b
    if operation == OR:
        return a | b
    return a & b if operation == AND else a ^ b


@compiled
def carried(operation: int, a: int, b: int, words: int) -> int:
    """Return 1 if an addition carries or a comparison borrows, taking the numbers as unsigned."""
    mask = _MASK_48 if words == 3 else 0xFFFFFFFF
    if operation == ADD:
        return 1 if (a & mask) + (b & mask) > mask else 0
    if operation == COMPARE:
        return 1 if (a & mask) < (b & mask) else 0
    return 0


@compiled
def _is_due(event: np.void, result: int, carry: int) -> bool:
    """Tell whether a conditional event acts now; an edge needs that the condition was seen not to hold."""
    holds = condition(event["type"], result, carry)
    if event["type"] > _LAST_EDGE:
        return holds
    before = event["held"]
    event["held"] = 1 if holds else 0
    return holds and before == 0


@compiled
def events_cycle(s: CardState) -> None:
    """Run all events in their order."""
    result = 0
    carry = 0
    for k in range(s.card[0]["events"]):
        event = s.event[k]
        always = event["type"] == 0
        if not always and not _is_due(event, result, carry):
            continue
        operation, words = event["operation"], event["words"]
        a = 0
        if event["first_words"] != 0:
            a = _operand(s, event["first_row"], event["first"], event["first_words"])
        b = event["constant"]
        if event["second_words"] != 0:
            b = _operand(s, event["second_row"], event["second"], event["second_words"])
        if operation == SCALE and s.card[0]["short_factor"] != 0:
            exact = scale_short(a, b)
        else:
            exact = computed(operation, a, b)
        value = wrap_words(exact, words)
        if event["boolean"] != 0:
            value = FLAG if value != 0 else 0
        if always:
            result = exact if operation == COMPARE else value
            carry = carried(operation, a, b, words)
        if event["target"] != 0:
            write_words(s, event["target"], event["target_axis"], words, value)
