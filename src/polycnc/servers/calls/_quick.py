"""Calls that read through no pointer, which most are: from the bytes of a frame to those of its answer in one go.

They do what `Caller.carry_out` and `Layout.answered` do, without an object for each argument. A frame of such a call
has always the same size.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from polycnc.controllers.library import Session
from polycnc.controllers.library.clib import Call
from polycnc.errors import UsageError
from polycnc.servers.calls._frames import CARRIED_OUT, HEAD, MOST, NULL, REFUSED, SIZE, CallError, form_of

Quick: TypeAlias = Callable[[bytes], bytes]
"""Takes a frame of the right size and returns its answer."""
Take: TypeAlias = tuple[int, Callable[[Any], Any] | None]
"""Which argument the façade is given, and what makes its value of that in the frame; None of the number itself."""
Put: TypeAlias = tuple[int, bool, int, Callable[[Any], bytes]]
"""Which argument is written, from a result or from what is given, from which of them, what makes its bytes."""
BEGIN = HEAD.size - 2
"""Bytes with the size and the number of a frame, before its serial number."""


def quick_of(
    call: Call,
    function: Callable[[list[Any]], Any],
    session: Session,
    null: float | None,
    takes: Sequence[Take],
    puts: Sequence[Put],
) -> tuple[bytes, int, Quick]:
    """Return how frames of a call begin, how long they are, and what answers them; `null` is a null pointer's code."""
    form = struct.Struct("<6x2s" + "".join(map(form_of, call.slots)))
    given_of = _given_of(takes)
    answered = _answered(call, len(puts))
    puts = [(place + 1, is_result, at, put) for place, is_result, at, put in puts]
    written = [place for place, _, _, _ in puts]
    is_void = call.function.result == "void"

    def quick(frame: bytes) -> bytes:
        values = form.unpack(frame)
        for place in written:
            if values[place] == NULL:
                return answered(values[0], REFUSED, null, none)
        given = given_of(values)
        session.refused = False
        try:
            results = function(given)
        except UsageError:
            return answered(values[0], REFUSED, null, none)
        if not isinstance(results, tuple):
            results = (results,)
        code = None if is_void else results[0]
        if session.refused:
            return answered(values[0], REFUSED, code, none)
        outputs = [
            put(results[at] if is_result else given[at])[: values[place]]
            for place, is_result, at, put in puts
        ]
        return answered(values[0], CARRIED_OUT, code, outputs)

    none = [b""] * len(puts)
    return HEAD.pack(form.size - SIZE.size, call.number, 0)[:BEGIN], form.size, quick


def _given_of(takes: Sequence[Take]) -> Callable[[tuple[Any, ...]], list[Any]]:
    """Return what makes the arguments of the façade of what is in a frame, the serial number and all slots."""
    shifted = [(place + 1, made) for place, made in takes]
    end = len(shifted) + 1
    if all(made is None and place == k for k, (place, made) in enumerate(shifted, 1)):
        return lambda values: [*values[1:end]]
    return lambda values: [values[at] if made is None else made(values[at]) for at, made in shifted]


def _answered(call: Call, count: int) -> Callable[[bytes, int, float | None, list[bytes]], bytes]:
    """Return what packs an answer with so many outputs."""
    form = struct.Struct(f"<IH2sI{'d' if call.function.result == 'double' else 'q'}{count}I")
    number, least = call.number, form.size - SIZE.size

    def answered(serial: bytes, state: int, code: float | None, outputs: list[bytes]) -> bytes:
        packed = outputs[0] if count == 1 else b"".join(outputs)
        size = least + len(packed)
        if size > MOST - SIZE.size:
            raise CallError(f"the answer to {call.function.name} has {size} bytes")
        return form.pack(size, number, serial, state, code or 0, *map(len, outputs)) + packed

    return answered
