"""The makers of the library's functions, and checks that they share."""

from __future__ import annotations

from polycnc.controllers.fanuc.library._codes import ALL_AXES, EW
from polycnc.controllers.fanuc.library._network import Session
from polycnc.controllers.library import USHORT, Facade, Refused

LIBRARY = Facade("polycnc.controllers.fanuc.fwlib", Session(), code="short")
session_call = LIBRARY.on(lambda session: session)
call = LIBRARY.through(Session.find, USHORT, name="FlibHndl")


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
