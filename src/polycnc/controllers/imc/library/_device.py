"""Functions that find, open and close cards (manual 004, 2)."""

# ruff: noqa: N802, N803  the names are the manual's

from __future__ import annotations

from polycnc.controllers.imc.library._call import session_call
from polycnc.controllers.imc.library._codes import (
    IMC_OK,
    IMC_OTHER_ERROR,
    IMC_OUT_OF_RANGE,
    IMC_PASSWORD_ERROR,
    IMC_STATUS,
)
from polycnc.controllers.imc.library._network import DEFAULT_TIMEOUT_MS, Session, is_password
from polycnc.controllers.imc.library._types import (
    HANDLE,
    INT,
    Adapters,
    Found,
    Opened,
    OpenMode,
    Password,
    TimeoutMs,
)
from polycnc.controllers.library import Refused


@session_call
def IMC_FindNetCard(session: Session, pinfo: Adapters) -> tuple[IMC_STATUS, Found]:
    """Fill `pinfo` with the network adapters and return how many there are (Manual 004, 2.1.1).

    No card may be open.
    """
    if session.handles:
        raise Refused(IMC_OTHER_ERROR)
    descriptions = [adapter.description for adapter in session.adapters]
    for k in range(len(pinfo.description)):
        text = descriptions[k] if k < len(descriptions) else ""
        pinfo.description[k].value = text.encode("latin-1", "replace")
    return IMC_OK, len(descriptions)


@session_call
def IMC_Open(session: Session, netcardsel: INT, imcid: INT) -> tuple[IMC_STATUS, Opened]:
    """Open a card and return its handle; as IMC_OpenX with 40 ms and promiscuous mode (Manual 004, 2.1.2)."""
    return _open(session, netcardsel, imcid)


@session_call
def IMC_OpenX(
    session: Session, netcardsel: INT, imcid: INT, timeout: TimeoutMs, openMode: OpenMode
) -> tuple[IMC_STATUS, Opened]:
    """Open a card that answers within `timeout` ms, in promiscuous mode (1) or not (0) (Manual 004, 2.1.3)."""
    return _open(session, netcardsel, imcid, timeout, promiscuous=openMode == 1)


@session_call
def IMC_OpenUsePassword(
    session: Session, netcardsel: INT, imcid: INT, password: Password
) -> tuple[IMC_STATUS, Opened]:
    """Open a card if this is its password, of 4 to 99 characters; None is not looked at (Manual 004, 2.1.4)."""
    if password is None:
        return _open(session, netcardsel, imcid)
    if not is_password(password):
        raise Refused(IMC_OUT_OF_RANGE)
    port = session.open(netcardsel, imcid, DEFAULT_TIMEOUT_MS, promiscuous=True)
    if port.card.config.password != password:
        raise Refused(IMC_PASSWORD_ERROR)
    return IMC_OK, session.add_handle(port, DEFAULT_TIMEOUT_MS)


@session_call
def IMC_Close(session: Session, Handle: HANDLE) -> IMC_STATUS:
    """Close a card; its handle is of no more use (Manual 004, 2.1.5)."""
    return session.close(Handle)


def _open(
    session: Session,
    netcardsel: int,
    imcid: int,
    timeout_ms: int = DEFAULT_TIMEOUT_MS,
    *,
    promiscuous: bool = True,
) -> tuple[IMC_STATUS, Opened]:
    port = session.open(netcardsel, imcid, timeout_ms, promiscuous=promiscuous)
    return IMC_OK, session.add_handle(port, timeout_ms)


# fmt: off
__all__ = [
    "IMC_Close", "IMC_FindNetCard", "IMC_Open", "IMC_OpenUsePassword", "IMC_OpenX",
]
# fmt: on
