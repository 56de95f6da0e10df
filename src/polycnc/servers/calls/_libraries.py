"""The libraries by their names, and how a client of one reaches the served machines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import PureWindowsPath
from typing import Any

from polycnc.controllers.library.clib import CLibrary
from polycnc.errors import UsageError, did_you_mean
from polycnc.machine import Way
from polycnc.servers.calls._caller import Caller


@dataclass(frozen=True, slots=True)
class Served:
    """A library: `make` returns a caller with a session of its own, which reaches these devices.

    The third argument of `make` is what calls that read do to the time of the devices, None for nothing.
    """

    load: Callable[[], CLibrary]
    make: Callable[[CLibrary, Sequence[Any], Way | None], Caller]


def _load_fwlib() -> CLibrary:
    from polycnc.controllers.fanuc.clib import FWLIB

    return FWLIB


def _call_fwlib(library: CLibrary, devices: Sequence[Any], clock: Way | None = None) -> Caller:
    from polycnc.controllers.fanuc import fwlib

    session = fwlib.Session()
    for node, device in enumerate(devices[:8]):
        session.attach(node, device, clock)

    def by_address(ip: str, port: int, timeout: int) -> tuple[int, int]:
        """Open a handle of the control that the program has reached by this address: the first one here."""
        code, handle = session.cnc_allclibhndl2(0)
        return code, handle

    return Caller(library, session, {"cnc_allclibhndl3": by_address})


def _load_imcnet() -> CLibrary:
    from polycnc.controllers.imc.clib import IMCNET

    return IMCNET


def _call_imcnet(library: CLibrary, devices: Sequence[Any], clock: Way | None = None) -> Caller:
    from polycnc.controllers.imc import imclib

    session = imclib.Session()
    session.attach(*devices, clock=clock)
    return Caller(library, session)


def _load_mcug3() -> CLibrary:
    from polycnc.controllers.apci.clib import MCUG3

    return MCUG3


def _call_mcug3(library: CLibrary, devices: Sequence[Any], clock: Way | None = None) -> Caller:
    from polycnc.controllers.apci import pcap

    session = pcap.Session()
    session.attach(*devices, clock=clock)

    def beside(name: str) -> Callable[..., Any]:
        """Return a function that takes files of the server's folder alone, whatever folder the program names."""
        call = getattr(session, name)
        return lambda *given: call(
            *(PureWindowsPath(each).name if isinstance(each, str) else each for each in given)
        )

    def set_routine(what: int) -> int:
        """Listen to a board, numbered from 1; return the number of the selected one, from 0, where `what` is 0."""
        lines = list(session.lines.values())
        if not what:
            return session.application.selected
        if not 0 < what <= len(lines):
            return library.null
        caller.listens = True
        return lines[what - 1].set_routine(lambda bits: caller.push(bits))

    ways: dict[str, Callable[..., Any]] = {name: beside(name) for name in _OF_FILES}
    caller = Caller(library, session, ways | {"MCUG3_SetBoardIntRoutine": set_routine})
    return caller


_OF_FILES = ("InitMcuSystem2", "InitMcuSystem3", "txbf", "txbf2")

LIBRARIES: dict[str, Served] = {
    "fanuc": Served(_load_fwlib, _call_fwlib),
    "imc": Served(_load_imcnet, _call_imcnet),
    "apci": Served(_load_mcug3, _call_mcug3),
}
"""By the kind of controller."""


def library_of(kind: str) -> CLibrary:
    """Return the library of a kind of controller.

    Raises:
        UsageError: There is none.
    """
    if kind not in LIBRARIES:
        raise UsageError(
            f"there is no C library of '{kind[:40]}'",
            hint=f"{did_you_mean(kind, LIBRARIES)}There are {', '.join(LIBRARIES)}.",
        )
    return LIBRARIES[kind].load()
