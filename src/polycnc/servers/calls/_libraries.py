"""The libraries by their names, and how a client of one reaches the served machines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from polycnc.controllers.library.clib import CLibrary
from polycnc.errors import UsageError
from polycnc.servers.calls._caller import Caller


@dataclass(frozen=True, slots=True)
class Served:
    """A library: `make` returns a caller with a session of its own, which reaches these devices; `end` ends it."""

    load: Callable[[], CLibrary]
    make: Callable[[CLibrary, Sequence[Any]], Caller]
    end: Callable[[Any], None]


def _load_fwlib() -> CLibrary:
    from polycnc.controllers.fanuc.clib import FWLIB

    return FWLIB


def _call_fwlib(library: CLibrary, devices: Sequence[Any]) -> Caller:
    from polycnc.controllers.fanuc import fwlib

    session = fwlib.Session()
    for node, device in enumerate(devices[:8]):
        session.attach(node, device)

    def by_address(ip: str, port: int, timeout: int) -> tuple[int, int]:
        """Open a handle of the control that the program has reached by this address: the first one here."""
        code, handle = session.cnc_allclibhndl2(0)
        return code, handle

    return Caller(library, session, {"cnc_allclibhndl3": by_address})


LIBRARIES: dict[str, Served] = {
    "fanuc": Served(_load_fwlib, _call_fwlib, lambda session: session.detach()),
}
"""By the kind of controller."""


def library_of(kind: str) -> CLibrary:
    """Return the library of a kind of controller.

    Raises:
        UsageError: There is none.
    """
    if kind not in LIBRARIES:
        raise UsageError(f"there is no C library of '{kind[:40]}'", hint=f"There are {', '.join(LIBRARIES)}.")
    return LIBRARIES[kind].load()
