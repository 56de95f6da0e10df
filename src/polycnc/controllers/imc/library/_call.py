"""What happens around every call: one at a time, a handle that is open, arguments that the card can be given."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from copy import copy
from functools import wraps
from typing import Any, ParamSpec, TypeVar, cast, get_type_hints

from polycnc.controllers.imc.core._instructions import Instruction
from polycnc.controllers.imc.core._parameters import PARAMETERS
from polycnc.controllers.imc.library._codes import (
    IMC_FIFO_FULL,
    IMC_INVALID_AXIS,
    IMC_INVALID_PARAM,
    IMC_OK,
    IMC_PARAM_READ_ONLY,
    IMC_STATUS,
    SEL_IFIFO,
    Refused,
)
from polycnc.controllers.imc.library._network import IMC_HANDLE, library
from polycnc.controllers.imc.library._types import CType

P = ParamSpec("P")
R = TypeVar("R")

MODULE = "polycnc.controllers.imc.imclib"

_WORDS = {  # by address: the parameter that has this word
    word: each for each in PARAMETERS.values() for word in range(each.address, each.address + each.words)
}


def c_type(hint: Any) -> CType | None:
    """Return the C type of an annotation, None for a handle."""
    for each in getattr(hint, "__metadata__", ()):
        if hasattr(each, "check"):
            return cast("CType", each)
    return None


def call(*nothing: object, any_handle: bool = False) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Make a function of the library: `nothing` is what it returns beside its status when it refuses.

    With `any_handle` it looks at its handle itself.
    """

    def decorate(body: Callable[P, R]) -> Callable[P, R]:
        signature = inspect.signature(body)
        hints = get_type_hints(body, include_extras=True)
        types = {name: c_type(hints[name]) for name in signature.parameters}
        checks = [(name, each) for name, each in types.items() if each is not None]

        @wraps(body)
        def called(*args: P.args, **kwargs: P.kwargs) -> R:
            bound = signature.bind(*args, **kwargs).arguments
            present = library()
            with present.lock:
                try:
                    handle = bound.get("Handle")
                    if "Handle" in types and not any_handle:
                        present.check(handle)
                    axes = handle.axis_count if isinstance(handle, IMC_HANDLE) else 0
                    for name, each in checks:
                        status = each.check(bound[name], axes)
                        if status != IMC_OK:
                            raise Refused(status)
                    return body(*args, **kwargs)
                except Refused as refused:
                    answer = refused.status
                    return cast("R", (answer, *map(copy, nothing)) if nothing else answer)

        called.__module__ = MODULE
        return called

    return decorate


def check_place(handle: IMC_HANDLE, address: int, axis: int, *, written: bool = False) -> int:
    """Make sure that there is a parameter at `address`, and an axis if it needs one; return the axis to ask for.

    For a parameter of the card any axis will do; one that is not there becomes axis 0, which counts only where a wide
    access reaches words of an axis behind it.

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
    """Put an instruction into a queue of the card; one in IFIFO is carried out before the call is over."""
    status = taken(handle, handle.reach().push(fifo, instruction))
    if status == IMC_OK and fifo == SEL_IFIFO:
        handle.let_cycle_pass()
    return status


def taken(handle: IMC_HANDLE, fits: bool) -> IMC_STATUS:
    """Return the status of an instruction; time passes if it does not fit, as a program will try again."""
    if fits:
        return IMC_OK
    handle.reach_later()
    return IMC_FIFO_FULL


def signed(words: Sequence[int]) -> int:
    """Return words, the low one first, as one signed number."""
    value = sum((int(word) & 0xFFFF) << (16 * k) for k, word in enumerate(words))
    bits = 16 * len(words)
    return value - (1 << bits) if value >> (bits - 1) else value
