"""Every function on a line that is bad, a handle that is closed or none, and several handles of one card."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.imc import imclib as lib
from support.imc_calls import OTHERS, PATHS, READERS, SENDERS, WAITERS, functions
from support.imc_network import ToldCard

P1 = lib.SEL_PFIFO1
ALL = {name: (*given, P1) for name, given in {**SENDERS, **WAITERS, **PATHS}.items()} | OTHERS
FAULTS = (lib.IMC_SEND_FAIL, lib.IMC_READ_FAIL, lib.IMC_CHECK_ERROR, lib.IMC_OTHER_ERROR)


@pytest.fixture(autouse=True)
def _leave_no_card() -> Iterator[None]:
    yield
    lib.detach()


def answers(handle: Any) -> set[int]:
    """Call every function once; return their statuses. What reads has to read nothing."""
    statuses = {int(getattr(lib, name)(handle, *given)) for name, given in ALL.items()}
    for name, (given, nothing) in READERS.items():
        status, *read = getattr(lib, name)(handle, *given)
        statuses.add(int(status))
        assert tuple(read) == nothing
    return statuses


@pytest.mark.covers(
    *functions(ALL, READERS), "imc.IMC_Close", "imc.IMC_OpenX", "imc.type.IMC_HANDLE",
    *(f"imc.status.IMC_{name}" for name in ("OK", "SEND_FAIL", "READ_FAIL", "CHECK_ERROR", "OTHER_ERROR", "TIME_OUT")),
    "imc.status.IMC_DEVICE_NOT_OPEN", "imc.status.IMC_INVALID_HANDLE",
)  # fmt: skip
def test_every_function_answers_what_is_wrong_with_the_line_or_the_handle() -> None:
    card, other = ToldCard(), ToldCard()
    port, _ = lib.attach(card, other, clock=None)
    _, handle = lib.IMC_OpenX(0, 0, 33, 1)
    _, beside = lib.IMC_Open(0, 1)
    for fault in FAULTS:
        port.fault = fault
        assert answers(handle) == {fault}
    port.fault, port.reply_ms = lib.IMC_OK, 33.5
    assert answers(handle) == {3}
    port.reply_ms, port.connected = 33.0, False
    assert answers(handle) == {3}
    port.connected = True
    assert (card.told, card.points, card.cleared) == ([], [], [])
    assert answers(handle) == {0}
    assert (len(card.told), card.points, card.cleared) == (len(ALL) - len(OTHERS), [5], [1])
    assert lib.IMC_Close(handle) == 0  # type: ignore[arg-type]
    assert answers(handle) == {4}
    assert answers(None) == answers(beside.__class__) == {6}
    assert answers(beside) == {0}
    assert len(card.told) == len(other.told) == len(ALL) - len(OTHERS)


@pytest.mark.covers(
    "imc.IMC_Close", "imc.IMC_Open", "imc.IMC_OpenX", "imc.IMC_FindNetCard", "imc.type.IMC_HANDLE",
    "imc.status.IMC_DEVICE_NOT_OPEN", "imc.status.IMC_TIME_OUT", "imc.status.IMC_OTHER_ERROR",
)  # fmt: skip
def test_handles_of_one_card_have_their_own_time_out_and_are_closed_one_by_one() -> None:
    card = ToldCard()
    (port,) = lib.attach(card, clock=None)
    for timeout in (1, 0x7FFFFFFF):
        assert lib.IMC_OpenX(0, 0, timeout, 0)[0] == lib.IMC_OK
    handles: list[Any] = [lib.IMC_OpenX(0, 0, 50, 1)[1], lib.IMC_OpenX(0, 0, 5, 0)[1], lib.IMC_Open(0, 0)[1]]
    for reply_ms, expected in ((5.0, (0, 0, 0)), (20.0, (0, 3, 0)), (45.0, (0, 3, 3)), (51.0, (3, 3, 3))):
        port.reply_ms = reply_ms
        assert tuple(lib.IMC_MoveVelocity(each, 7, 0, P1) for each in handles) == expected
        assert tuple(lib.IMC_GetParam16(each, lib.movingLoc, 0)[0] for each in handles) == expected
    port.reply_ms = 1.0
    info = lib.NIC_INFO()
    for closed in (1, 2, 0):
        assert lib.IMC_Close(handles[closed]) == lib.IMC_OK
        assert lib.IMC_MoveVelocity(handles[closed], 7, 0, P1) == lib.IMC_DEVICE_NOT_OPEN
        assert lib.IMC_MoveVelocity(handles[0], 7, 0, P1) == (
            lib.IMC_OK if closed else lib.IMC_DEVICE_NOT_OPEN
        )
        assert lib.IMC_FindNetCard(info) == (lib.IMC_OTHER_ERROR, 0)  # the first one is open still
    assert info.pack() == bytes(4096)


@pytest.mark.covers(
    "imc.IMC_FindNetCard",
    "imc.struct.NIC_INFO",
    "imc.const.limits",
    "imc.IMC_Open",
    "imc.IMC_OpenX",
    "imc.const.openMode",
    "imc.option.openMode",
)
def test_sixteen_adapters_with_long_names_are_listed_and_a_card_is_opened_on_the_last() -> None:
    names = [f"{k:02}" + "x" * 250 + f"{k:03}" for k in range(16)]
    lib.attach(lib.Port(ToldCard(axes=7), id=63, adapter=15), adapters=names)
    info = lib.NIC_INFO()
    assert lib.IMC_FindNetCard(info) == (lib.IMC_OK, 16)
    assert info.descriptions() == names
    for adapter, number in ((15, 62), (14, 63), (0, 63), (15, 0)):
        assert (
            lib.IMC_Open(adapter, number)
            == lib.IMC_OpenX(adapter, number, 40, 1)
            == (lib.IMC_DEVICE_NOT_FOUND, None)
        )
    assert lib.IMC_FindNetCard(info) == (lib.IMC_OK, 16)  # a card that was not found is not open
    lib.attach(lib.Port(ToldCard(axes=7), id=63, adapter=15), adapters=names[:15] + ["last"])
    assert lib.IMC_FindNetCard(info) == (lib.IMC_OK, 16)
    assert info.descriptions() == [*names[:15], "last"]
    status, handle = lib.IMC_Open(15, 63)
    assert handle is not None
    assert (status, handle.axis_count) == (lib.IMC_OK, 7)
    for adapter, number in ((-1, 63), (16, 63), (15, -1), (15, 64)):
        assert lib.IMC_OpenX(adapter, number, 40, 1) == (lib.IMC_OUT_OF_RANGE, None)
        assert lib.IMC_OpenUsePassword(adapter, number, "1234") == (lib.IMC_OUT_OF_RANGE, None)
    for timeout, mode in ((0, 1), (-1, 1), (-40, 0), (40, -1), (40, 2)):
        assert lib.IMC_OpenX(15, 63, timeout, mode) == (lib.IMC_OUT_OF_RANGE, None)


@pytest.mark.covers(
    "imc.IMC_OpenUsePassword", "imc.option.password", "imc.option.openMode", "imc.const.openMode"
)
@pytest.mark.covers("imc.status.IMC_PASSWORD_ERROR", "imc.status.IMC_VERSION_ERROR", "imc.IMC_FindNetCard")
def test_a_card_is_opened_with_its_password_as_it_is_without() -> None:
    word = "open sesame"
    port, *_ = lib.attach(
        lib.Port(ToldCard(password=word), 5),
        lib.Port(ToldCard(password=word), 5, adapter=1),
        lib.Port(ToldCard(password=word, fwversion=400), 6),
        adapters=(lib.NetCard(), lib.NetCard("wireless", promiscuous=False)),
        clock=None,
    )
    for place, given, status in (
        ((1, 5), word, lib.IMC_DEVICE_NOT_FOUND),  # promiscuous
        ((0, 6), word, lib.IMC_VERSION_ERROR),
        ((0, 7), word, lib.IMC_DEVICE_NOT_FOUND),
        ((0, 64), word, lib.IMC_OUT_OF_RANGE),
        ((0, 5), "open Sesame", lib.IMC_PASSWORD_ERROR),
    ):
        assert lib.IMC_OpenUsePassword(*place, given) == (status, None)
    port.reply_ms = 40.5
    assert lib.IMC_OpenUsePassword(0, 5, word) == (lib.IMC_TIME_OUT, None)
    assert lib.IMC_FindNetCard(lib.NIC_INFO()) == (lib.IMC_OK, 2)  # no refused call has opened anything
    port.reply_ms = 40.0
    _, handle = lib.IMC_OpenUsePassword(0, 5, word)
    assert lib.IMC_MoveVelocity(handle, 7, 0, P1) == lib.IMC_OK  # type: ignore[arg-type]
    port.reply_ms = 40.5
    assert lib.IMC_MoveVelocity(handle, 7, 0, P1) == lib.IMC_TIME_OUT  # type: ignore[arg-type]
    assert lib.IMC_FindNetCard(lib.NIC_INFO()) == (lib.IMC_OTHER_ERROR, 0)
