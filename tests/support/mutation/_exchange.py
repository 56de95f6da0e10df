"""Give the functions of an imported module the code of a changed text, without importing anything anew."""

from __future__ import annotations

import gc
from types import CodeType, FunctionType


class NotExchangeableError(Exception):
    """The change is not in functions alone."""


def exchange(file: str, before: bytes, after: bytes) -> None:
    """Let the functions that came from a file do what the changed text says.

    Raises:
        NotExchangeableError: The change is in what the import runs, or alters which variables functions share.
    """
    pairs: dict[CodeType, CodeType] = {}
    _pair(compile(before, file, "exec"), compile(after, file, "exec"), pairs)
    done = 0
    gc.unfreeze()  # what conftest has frozen is not among the objects
    for function in gc.get_objects():
        if isinstance(function, FunctionType) and function.__code__.co_filename == file:
            code = pairs.get(function.__code__)
            if code is not None:
                if code.co_freevars != function.__code__.co_freevars:
                    raise NotExchangeableError
                function.__code__ = code
                done += 1
    if not done:
        raise NotExchangeableError


def _pair(old: CodeType, new: CodeType, pairs: dict[CodeType, CodeType]) -> None:
    """Note the new code of each function that is not the same; what is no function has to be the same itself."""
    inner_old, inner_new = _inner(old), _inner(new)
    if [each.co_name for each in inner_old] != [each.co_name for each in inner_new]:
        raise NotExchangeableError
    if not old.co_flags & 2 and (old.co_code != new.co_code or _plain(old) != _plain(new)):  # CO_NEWLOCALS
        raise NotExchangeableError
    for one, other in zip(inner_old, inner_new, strict=True):
        if one != other:
            if one.co_flags & 2:
                pairs[one] = other
            _pair(one, other, pairs)


def _inner(code: CodeType) -> list[CodeType]:
    return [each for each in code.co_consts if isinstance(each, CodeType)]


def _plain(code: CodeType) -> list[str]:
    return [repr(each) for each in code.co_consts if not isinstance(each, CodeType)]
