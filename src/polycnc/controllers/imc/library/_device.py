"""Functions that find, open and close cards (manual 004, 2)."""

# ruff: noqa: N802, N803  the names are the manual's

from __future__ import annotations

from polycnc.controllers.imc.library._call import call
from polycnc.controllers.imc.library._codes import (
    IMC_OK,
    IMC_OTHER_ERROR,
    IMC_OUT_OF_RANGE,
    IMC_PASSWORD_ERROR,
    IMC_STATUS,
    Refused,
)
from polycnc.controllers.imc.library._network import DEFAULT_TIMEOUT_MS, IMC_HANDLE, is_password, library
from polycnc.controllers.imc.library._types import INT, Adapters, OpenMode, TimeoutMs


@call(0)
def IMC_FindNetCard(pinfo: Adapters) -> tuple[IMC_STATUS, int]:
    """Fill `pinfo` with the network adapters and return how many there are (Manual 004, 2.1.1).

    No card may be open.
    """
    present = library()
    if present.handles:
        raise Refused(IMC_OTHER_ERROR)
    descriptions = [adapter.description for adapter in present.adapters]
    for k in range(len(pinfo.description)):
        text = descriptions[k] if k < len(descriptions) else ""
        pinfo.description[k].value = text.encode("latin-1", "replace")
    return IMC_OK, len(descriptions)


@call(None)
def IMC_Open(netcardsel: INT, imcid: INT) -> tuple[IMC_STATUS, IMC_HANDLE | None]:
    """Open a card and return its handle; as IMC_OpenX with 40 ms and promiscuous mode (Manual 004, 2.1.2)."""
    return _open(netcardsel, imcid)


@call(None)
def IMC_OpenX(
    netcardsel: INT, imcid: INT, timeout: TimeoutMs, openMode: OpenMode
) -> tuple[IMC_STATUS, IMC_HANDLE | None]:
    """Open a card that answers within `timeout` ms, in promiscuous mode (1) or not (0) (Manual 004, 2.1.3)."""
    return _open(netcardsel, imcid, timeout, promiscuous=openMode == 1)


@call(None)
def IMC_OpenUsePassword(
    netcardsel: INT, imcid: INT, password: str | bytes | None
) -> tuple[IMC_STATUS, IMC_HANDLE | None]:
    """Open a card if this is its password, of 4 to 99 characters; None is not looked at (Manual 004, 2.1.4)."""
    if password is None:
        return _open(netcardsel, imcid)
    text = password.decode("latin-1") if isinstance(password, bytes) else password
    if not is_password(text):
        raise Refused(IMC_OUT_OF_RANGE)
    port = library().open(netcardsel, imcid, DEFAULT_TIMEOUT_MS, promiscuous=True)
    if port.card.config.password != text:
        raise Refused(IMC_PASSWORD_ERROR)
    return IMC_OK, library().add_handle(port, DEFAULT_TIMEOUT_MS)


@call(any_handle=True)
def IMC_Close(Handle: IMC_HANDLE) -> IMC_STATUS:
    """Close a card; its handle is of no more use (Manual 004, 2.1.5)."""
    return library().close(Handle)


def _open(
    netcardsel: int, imcid: int, timeout_ms: int = DEFAULT_TIMEOUT_MS, *, promiscuous: bool = True
) -> tuple[IMC_STATUS, IMC_HANDLE | None]:
    port = library().open(netcardsel, imcid, timeout_ms, promiscuous=promiscuous)
    return IMC_OK, library().add_handle(port, timeout_ms)
