"""The makers of the library's functions, and checks that they share."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

from polycnc.controllers.fanuc.library._codes import ALL_AXES, EW
from polycnc.controllers.fanuc.library._network import Link, Session
from polycnc.controllers.fanuc.library._remote import RemoteLink, carry_out
from polycnc.controllers.library import USHORT, Facade, Refused

LIBRARY = Facade("polycnc.controllers.fanuc.fwlib", Session(), code="short")
session_call = LIBRARY.on(lambda session: session)
_of_node = LIBRARY.through(Session.find, USHORT, name="FlibHndl")

P = ParamSpec("P")
R = TypeVar("R")


def call(body: Callable[Concatenate[Link, P], R]) -> Callable[Concatenate[int, P], R]:
    """Make a function of the library of its body, which gets what the handle stands for.

    On a handle of the network the request of that name takes the body's place. A program that is refused as busy tries
    again: that counts as reading the same.
    """

    @wraps(body)
    def either(link: Link | RemoteLink, /, *given: P.args, **named: P.kwargs) -> R:
        if isinstance(link, RemoteLink):
            result: R = carry_out(link, body.__name__, given)
            return result
        link.reach()
        try:
            return body(link, *given, **named)
        except Refused as refusal:
            if refusal.code == EW.EW_BUSY:
                link.read(EW.EW_BUSY)
            raise

    return _of_node(either)


def check_length(length: int, least: int) -> None:
    """Refuse a data block that is too short.

    Ruling: a longer one is accepted, among them the structures packed to 4 bytes.

    Raises:
        Refused: It is shorter than `least`.
    """
    if length < least:
        raise Refused(EW.EW_LENGTH)


def check_axis(axis: int, axes: int) -> None:
    """Refuse an axis that is neither 1 to `axes` nor all.

    Raises:
        Refused: It is not.
    """
    if axis != ALL_AXES and not 1 <= axis <= axes:
        raise Refused(EW.EW_ATTRIB)
