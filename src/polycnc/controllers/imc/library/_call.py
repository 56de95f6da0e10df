"""The makers of the library's functions, and what functions that reach a card have in common."""

from __future__ import annotations

from collections.abc import Sequence

from polycnc.controllers.imc.core._instructions import InstallEvents, Instruction, Points, WriteMany, words_of
from polycnc.controllers.imc.core._parameters import PARAMETERS
from polycnc.controllers.imc.library._codes import (
    IMC_FIFO_FULL,
    IMC_INVALID_AXIS,
    IMC_INVALID_PARAM,
    IMC_OK,
    IMC_OUT_OF_RANGE,
    IMC_PARAM_READ_ONLY,
    IMC_STATUS,
    SEL_IFIFO,
)
from polycnc.controllers.imc.library._network import IMC_HANDLE, Session
from polycnc.controllers.imc.library._types import HANDLE
from polycnc.controllers.library import Facade, Refused

LIBRARY = Facade("polycnc.controllers.imc.imclib", Session(), code="IMC_STATUS")
session_call = LIBRARY.on(lambda session: session)
card_call = LIBRARY.through(Session.find, HANDLE)

_LONG = (WriteMany, InstallEvents, Points)  # the others fit into the smallest queue

_WORDS = {  # by address: the parameter that has this word
    word: each for each in PARAMETERS.values() for word in range(each.address, each.address + each.words)
}


def check_place(handle: IMC_HANDLE, address: int, axis: int, *, written: bool = False) -> int:
    """Make sure that there is a parameter at `address`, and an axis if it needs one; return the axis to ask for.

    For a parameter of the card any axis will do; one that is not there becomes axis 0, which counts only where a wide
    access reaches words of an axis after it.

    Raises:
        Refused: There is not, or it is to be written and cannot.
    """
    parameter = _WORDS.get(address)
    if parameter is None:
        raise Refused(IMC_INVALID_PARAM)
    present = 0 <= axis < handle.axis_count
    if parameter.scope == "A" and not present:
        raise Refused(IMC_INVALID_AXIS)
    if written and parameter.access == "ro":
        raise Refused(IMC_PARAM_READ_ONLY)
    return axis if present else 0


def send(handle: IMC_HANDLE, fifo: int, instruction: Instruction) -> IMC_STATUS:
    """Put an instruction into a queue of the card; one in IFIFO is carried out before the call is over.

    Raises:
        Refused: It is longer than the queue ever holds.
    """
    card = handle.reach()
    if isinstance(instruction, _LONG) and words_of(instruction) > card.config.depths.of(fifo):
        raise Refused(IMC_OUT_OF_RANGE)
    status = taken(handle, card.push(fifo, instruction))
    if status == IMC_OK and fifo == SEL_IFIFO:
        handle.session.let_cycle_pass(handle.card)
    return status


def taken(handle: IMC_HANDLE, fits: bool) -> IMC_STATUS:
    """Return the status of an instruction; time passes if it does not fit, as a program will try again."""
    if fits:
        handle.session.note_sent(handle.card)
        return IMC_OK
    handle.session.let_queue_run(handle.reach())
    return IMC_FIFO_FULL


def signed(words: Sequence[int]) -> int:
    """Return words, the low one first, as one signed number."""
    value = sum((int(word) & 0xFFFF) << (16 * k) for k, word in enumerate(words))
    bits = 16 * len(words)
    return value - (1 << bits) if value >> (bits - 1) else value
