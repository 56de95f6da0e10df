"""MMC: what a part program sends to a client program, and the client's answer (Manual 003, chapter 9)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeAlias

from polycnc.controllers.bosch.ncs._buffers import INVALID_PARAMETER, held
from polycnc.errors import shown
from polycnc.nc.cpl import BLOCKED, MOST_OF_MMC, Box, CharacterField, Fault, Field


class MmcResult(IntEnum):
    """What MMC returns."""

    DONE = 0
    NO_CLIENT = 1
    CLIENT_ERROR = 2


@dataclass(slots=True)
class Sent:
    """A variable as the client sees it: `value` is a number, truth value, text, None (NUL), or a field by index."""

    name: str
    value: object


class ClientError(Exception):
    """Raised by a client that cannot process what it was sent."""


Client: TypeAlias = Callable[[Sequence[Sent]], bool]
"""Gets the variables and may change their values; returns whether it has finished, and is asked again if not."""


class Clients:
    """The client program that has registered for MMC, if any."""

    def __init__(self) -> None:
        self.client: Client | None = None


class Mmc:
    """MMC of one channel: `call` is the function of its Host; it waits until the client has finished."""

    def __init__(self, clients: Clients) -> None:
        self._clients = clients
        self._under_way: list[Sent] | None = None

    def call(self, *variables: object, names: Sequence[str], open: bool = False) -> object:
        """Send variables to the client and take over what it has set; return 0, 1 or 2, or BLOCKED.

        Raises:
            Fault: The arguments are not 1 to 20 variables.
        """
        if open or not 1 <= len(variables) <= MOST_OF_MMC:
            raise Fault(INVALID_PARAMETER, f"MMC takes 1 to {MOST_OF_MMC} variables")
        if self._clients.client is None:
            self._under_way = None
            return int(MmcResult.NO_CLIENT)
        if self._under_way is None:
            self._under_way = [Sent(*pair) for pair in zip(names, map(_value, variables), strict=True)]
        sent = self._under_way
        try:
            if not self._clients.client(sent):
                return BLOCKED
            taken = [_checked(variable, each) for variable, each in zip(variables, sent, strict=True)]
        except ClientError:
            self._under_way = None
            return int(MmcResult.CLIENT_ERROR)
        self._under_way = None
        for variable, value in zip(variables, taken, strict=True):
            _put(variable, value)
        return int(MmcResult.DONE)

    def release(self) -> None:
        """Give up what is waited for: the program was stopped."""
        self._under_way = None


def _value(variable: object) -> object:
    if isinstance(variable, Box):
        return variable.value
    if isinstance(variable, CharacterField):
        return variable.text
    assert isinstance(variable, Field)
    return {
        index: _value(each) if isinstance(each, CharacterField) else each for index, each in variable.items()
    }


def _checked(variable: object, sent: Sent) -> object:
    value = sent.value
    if isinstance(variable, Field):
        if not isinstance(value, dict) or value.keys() - variable.keys():
            raise ClientError(f"{sent.name} is a field")
        return {index: _fitting(variable.kind, each) for index, each in value.items()}
    return _fitting("S" if isinstance(variable, CharacterField) else getattr(variable, "kind", "S"), value)


def _fitting(kind: str, value: object) -> object:
    if value is None:
        return None
    if kind in ("S", "B"):
        fits = isinstance(value, str if kind == "S" else bool)
    else:
        fits = isinstance(value, int | float) and not isinstance(value, bool)
        fits = fits and (kind != "I" or (float(value).is_integer() and -(2**31) <= value < 2**31))  # type: ignore[arg-type,operator]
    if not fits:
        raise ClientError(f"{shown(value)} is not of type {kind}")
    return value if isinstance(value, str | bool) else held(kind, value)  # type: ignore[arg-type]


def _put(variable: object, value: object) -> None:
    if isinstance(variable, Box):
        variable.value = value
    elif isinstance(variable, CharacterField):
        variable.assign(value)  # type: ignore[arg-type]
    elif isinstance(variable, Field) and isinstance(value, dict):
        for index, each in value.items():
            if isinstance(variable[index], CharacterField):
                _put(variable[index], each)
            else:
                variable[index] = each
