"""Find, open and close cards: adapters, ids, passwords, time-outs, handles, threads."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.imc import imclib as lib
from polycnc.errors import UsageError
from polycnc.machine import Elapsed, Poll
from support.imc_network import ToldCard, opened
from support.time_sources import FakeWall


@pytest.fixture(autouse=True)
def _leave_no_card() -> Iterator[None]:
    yield
    lib.detach()


@pytest.mark.covers("imc.struct.NIC_INFO", "imc.status.IMC_OTHER_ERROR")
@pytest.mark.covers("imc.IMC_FindNetCard")
@pytest.mark.covers("imc.IMC_Close", "imc.IMC_Open")
def test_find_lists_the_adapters_and_only_while_no_card_is_open() -> None:
    lib.attach(ToldCard(), adapters=("first", "second"))
    info = lib.NIC_INFO()
    info.description[5].value = b"left over"
    assert lib.IMC_FindNetCard(info) == (lib.IMC_OK, 2)
    assert info.descriptions() == ["first", "second"]
    _, handle = lib.IMC_Open(0, 0)
    before = info.pack()
    assert lib.IMC_FindNetCard(lib.NIC_INFO()) == (lib.IMC_OTHER_ERROR, 0)
    assert info.pack() == before
    assert handle is not None
    lib.IMC_Close(handle)
    assert lib.IMC_FindNetCard(info) == (lib.IMC_OK, 2)


@pytest.mark.covers("imc.IMC_FindNetCard")
def test_find_needs_a_place_for_its_answer() -> None:
    nowhere: Any = None
    assert lib.IMC_FindNetCard(nowhere) == (lib.IMC_INVALID_PARAM, 0)


@pytest.mark.covers("imc.status.IMC_DEVICE_NOT_FOUND")
@pytest.mark.covers("imc.IMC_Open", "imc.type.IMC_HANDLE")
def test_open_finds_a_card_by_adapter_and_id() -> None:
    here, there = ToldCard(axes=4), ToldCard(axes=8)
    lib.attach(here, lib.Port(there, id=3, adapter=1), adapters=("a", "b"))
    status, first = lib.IMC_Open(0, 0)
    assert status == lib.IMC_OK
    _, second = lib.IMC_Open(1, 3)
    assert first is not None
    assert second is not None
    assert (first.axis_count, second.axis_count) == (4, 8)
    assert repr(second) == "<IMC_HANDLE of card 3 on adapter 1, open>"
    lib.IMC_SetParam16(second, lib.runLoc, -1, 7, lib.SEL_IFIFO)
    assert (here.told, len(there.told)) == ([], 1)
    for adapter, number in ((0, 3), (1, 0), (2, 0)):
        assert lib.IMC_Open(adapter, number) == (lib.IMC_DEVICE_NOT_FOUND, None)
    for adapter, number in ((-1, 0), (16, 0), (0, -1), (0, 64)):
        assert lib.IMC_Open(adapter, number) == (lib.IMC_OUT_OF_RANGE, None)


@pytest.mark.covers("imc.status.IMC_TIME_OUT")
@pytest.mark.covers("imc.IMC_OpenX", "imc.const.openMode", "imc.option.openMode")
@pytest.mark.covers("imc.IMC_Open")
def test_time_out_and_mode_of_openx() -> None:
    port, _ = lib.attach(
        lib.Port(ToldCard(), 0, reply_ms=30.0),
        lib.Port(ToldCard(), 0, adapter=1),
        adapters=(lib.NetCard(), lib.NetCard("wireless", promiscuous=False)),
    )
    assert lib.IMC_OpenX(0, 0, 0, 1) == (lib.IMC_OUT_OF_RANGE, None)
    assert lib.IMC_OpenX(0, 0, 40, 2) == (lib.IMC_OUT_OF_RANGE, None)
    assert lib.IMC_OpenX(0, 0, 29, 1) == (lib.IMC_TIME_OUT, None)
    assert lib.IMC_OpenX(0, 0, 30, 1)[0] == lib.IMC_OK
    assert lib.IMC_OpenX(0, 0, 40, 0)[0] == lib.IMC_OK
    # Open is OpenX with 40 ms in promiscuous mode, which a wireless adapter may not have.
    for reply_ms, status in ((40.0, lib.IMC_OK), (41.0, lib.IMC_TIME_OUT)):
        port.reply_ms = reply_ms
        assert lib.IMC_Open(0, 0)[0] == status
    assert lib.IMC_Open(1, 0)[0] == lib.IMC_OpenX(1, 0, 40, 1)[0] == lib.IMC_DEVICE_NOT_FOUND
    assert lib.IMC_OpenX(1, 0, 40, 0)[0] == lib.IMC_OK


@pytest.mark.covers("imc.status.IMC_PASSWORD_ERROR")
@pytest.mark.covers("imc.IMC_Open")
@pytest.mark.covers("imc.IMC_OpenUsePassword", "imc.option.password")
def test_password_of_4_to_99_characters() -> None:
    long = "p" * 99
    lib.attach(ToldCard(password="12345678"), ToldCard(), ToldCard(password=long), ToldCard(password="abcd"))
    assert lib.IMC_OpenUsePassword(0, 0, "12345678")[0] == lib.IMC_OK
    assert lib.IMC_OpenUsePassword(0, 0, b"12345678")[0] == lib.IMC_OK
    assert lib.IMC_OpenUsePassword(0, 0, "12345679") == (lib.IMC_PASSWORD_ERROR, None)
    assert lib.IMC_OpenUsePassword(0, 0, None)[0] == lib.IMC_OK  # not looked at
    assert lib.IMC_Open(0, 0)[0] == lib.IMC_OK
    assert lib.IMC_OpenUsePassword(0, 1, "12345678")[0] == lib.IMC_PASSWORD_ERROR  # none is stored
    assert lib.IMC_OpenUsePassword(0, 2, long)[0] == lib.IMC_OK
    assert lib.IMC_OpenUsePassword(0, 3, "abcd")[0] == lib.IMC_OK
    others = (long[:98], long[:98] + "q", "q" + long[1:], "p" * 8)  # every character counts, and their number
    for card, wrong in (
        *((2, each) for each in others),
        (3, "abcD"),
        (3, "abcde"),
        (0, "123456789"),
        (0, "1234567"),
    ):
        assert lib.IMC_OpenUsePassword(0, card, wrong) == (lib.IMC_PASSWORD_ERROR, None)
    for wrong in ("", "abc", "p" * 100, "größer"):
        assert lib.IMC_OpenUsePassword(0, 0, wrong) == (lib.IMC_OUT_OF_RANGE, None)
    assert lib.IMC_OpenUsePassword(0, 9, "12345678")[0] == lib.IMC_DEVICE_NOT_FOUND


@pytest.mark.covers("imc.status.IMC_VERSION_ERROR", "imc.param.fwversion")
@pytest.mark.covers("imc.IMC_Open", "imc.IMC_OpenX", "imc.IMC_OpenUsePassword")
def test_firmware_of_another_generation_is_not_opened() -> None:
    others, same = (0, 99, 299, 400, 1320, 65535), (300, 305, 399)
    lib.attach(*(ToldCard(fwversion=version, password="word") for version in (*others, *same)))
    for number in range(len(others)):
        assert lib.IMC_Open(0, number) == lib.IMC_OpenX(0, number, 40, 0) == (lib.IMC_VERSION_ERROR, None)
        assert lib.IMC_OpenUsePassword(0, number, "word") == (lib.IMC_VERSION_ERROR, None)
    for number in range(len(others), len(others) + len(same)):
        assert lib.IMC_Open(0, number)[0] == lib.IMC_OpenX(0, number, 40, 0)[0] == lib.IMC_OK
        assert lib.IMC_OpenUsePassword(0, number, "word")[0] == lib.IMC_OK


@pytest.mark.covers("imc.IMC_Close", "imc.status.IMC_DEVICE_NOT_OPEN", "imc.type.IMC_HANDLE")
@pytest.mark.covers("imc.IMC_Open")
def test_a_closed_card_cannot_be_reached() -> None:
    card = ToldCard()
    handle = opened(card)
    assert lib.IMC_Close(handle) == lib.IMC_OK
    assert repr(handle).endswith("closed>")
    assert lib.IMC_SetParam16(handle, lib.runLoc, -1, 0, lib.SEL_IFIFO) == lib.IMC_DEVICE_NOT_OPEN
    assert lib.IMC_GetParam16(handle, lib.runLoc, 0) == (lib.IMC_DEVICE_NOT_OPEN, 0)
    assert lib.IMC_Close(handle) == lib.IMC_INVALID_HANDLE
    assert card.told == []
    _, again = lib.IMC_Open(0, 0)
    assert again is not None
    assert lib.IMC_SetParam16(again, lib.runLoc, -1, 0, lib.SEL_IFIFO) == lib.IMC_OK


@pytest.mark.covers("imc.IMC_Close", "imc.status.IMC_INVALID_HANDLE", "imc.type.IMC_HANDLE")
def test_what_is_no_handle_is_told_so() -> None:
    old = opened(ToldCard())
    lib.attach(ToldCard())
    nothing: Any
    for nothing in (None, 0, "handle", old):
        assert lib.IMC_Close(nothing) == lib.IMC_INVALID_HANDLE
        assert lib.IMC_MoveVelocity(nothing, 1, 0, lib.SEL_IFIFO) == lib.IMC_INVALID_HANDLE
        assert lib.IMC_GetCapData(nothing, 1, 0) == (lib.IMC_INVALID_HANDLE, [], 0, 0)


@pytest.mark.covers("imc.IMC_ClearFIFO", "imc.IMC_Open")
@pytest.mark.covers("imc.IMC_OpenX")
def test_a_bad_line_keeps_instructions_from_the_card() -> None:
    card = ToldCard()
    (port,) = lib.attach(card)
    _, handle = lib.IMC_OpenX(0, 0, 5, 1)
    assert handle is not None
    port.reply_ms = 6.0
    assert lib.IMC_ClearFIFO(handle, lib.SEL_QFIFO) == lib.IMC_TIME_OUT
    port.reply_ms, port.connected = 1.0, False
    assert lib.IMC_MoveVelocity(handle, 1, 0, lib.SEL_IFIFO) == lib.IMC_TIME_OUT
    assert lib.IMC_Open(0, 0)[0] == lib.IMC_DEVICE_NOT_FOUND
    port.connected = True
    for fault in (lib.IMC_SEND_FAIL, lib.IMC_READ_FAIL, lib.IMC_CHECK_ERROR, lib.IMC_OTHER_ERROR):
        port.fault = fault
        assert lib.IMC_GetParam32(handle, lib.encpLoc, 0) == (fault, 0)
        assert lib.IMC_MoveVelocity(handle, 1, 9, lib.SEL_IFIFO) == lib.IMC_INVALID_AXIS  # before the line
    assert (card.told, card.cleared) == ([], [])


@pytest.mark.covers("imc.IMC_GetParamBit", "imc.IMC_GetParam16", "imc.fifo.SEL_IFIFO", "imc.concept.ififo")
@pytest.mark.covers("imc.fifo.SEL_QFIFO", "imc.status.IMC_FIFO_FULL")
def test_time_passes_when_a_program_reads_or_finds_a_queue_full() -> None:
    here, there = ToldCard(), ToldCard()
    handle = opened(here, clock=Poll(7))
    lib.attach(here, there, clock=Poll(7))
    _, opening = lib.IMC_Open(0, 0)
    assert opening is not None
    assert handle is not opening
    lib.IMC_MoveVelocity(opening, 1, 0, lib.SEL_QFIFO)
    assert here.cycles == 0
    for cycles, axes in (
        (7, (0, 1)),
        (14, (0, 1)),
    ):  # what was sent is taken first; then the second time, not the first
        for axis in axes:
            lib.IMC_GetParam16(opening, lib.movingLoc, axis)
            lib.IMC_GetParamBit(opening, lib.movingLoc, axis, 0)
            assert (here.cycles, there.cycles) == (
                cycles,
                cycles,
            )  # both axes of one cycle; cards keep in step
    here.full = True
    assert lib.IMC_MoveVelocity(opening, 1, 0, lib.SEL_IFIFO) == lib.IMC_FIFO_FULL
    assert here.cycles == 21
    here.full = False
    lib.IMC_MoveVelocity(opening, 1, 0, lib.SEL_IFIFO)
    assert (here.cycles, there.cycles) == (22, 22)  # carried out at once
    lib.attach(here, clock=None)
    _, frozen = lib.IMC_Open(0, 0)
    assert frozen is not None
    lib.IMC_GetParam16(frozen, lib.movingLoc, 0)
    lib.IMC_MoveVelocity(frozen, 1, 0, lib.SEL_IFIFO)
    assert here.cycles == 22


@pytest.mark.parametrize(
    ("ports", "adapters", "what"),
    [
        ((lib.Port(ToldCard(), 1), lib.Port(ToldCard(), 1)), 1, "same adapter and id"),
        ((lib.Port(ToldCard(), 64),), 1, "no place for card 64"),
        ((lib.Port(ToldCard(), 0, adapter=1),), 1, "on adapter 1"),
        ((), 17, "17 network adapters"),
    ],
)
def test_cards_have_places(ports: tuple[lib.Port, ...], adapters: int, what: str) -> None:
    with pytest.raises(UsageError, match=what):
        lib.attach(*ports, adapters=("net",) * adapters)


@pytest.mark.covers("imc.IMC_Open")
def test_cards_without_a_place_take_the_next_free_one() -> None:
    ports = lib.attach(lib.Port(ToldCard(), 0), ToldCard(), lib.Port(ToldCard(), 2), ToldCard())
    assert [port.id for port in ports] == [0, 1, 2, 3]


@pytest.mark.covers("imc.concept.library")
def test_threads_take_turns() -> None:
    card = ToldCard()
    handle = opened(card)
    inside: list[int] = []
    overlaps: list[int] = []
    push = card.push

    def slow_push(fifo: int, instruction: Any) -> bool:
        inside.append(1)
        overlaps.append(len(inside))
        threading.Event().wait(0.001)
        inside.pop()
        return push(fifo, instruction)

    card.push = slow_push  # type: ignore[method-assign]
    threads = [
        threading.Thread(target=lib.IMC_MoveVelocity, args=(handle, k, 0, lib.SEL_IFIFO)) for k in range(16)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (len(card.told), set(overlaps)) == (16, {1})


@pytest.mark.covers("imc.IMC_Close")
def test_two_programs_have_their_own_network_handles_and_time() -> None:
    mine, theirs = ToldCard(), ToldCard()
    here, there = lib.Session(), lib.Session()
    here.attach(mine, clock=Poll(7))
    there.attach(theirs, clock=Poll(4))
    assert lib.IMC_Open(0, 0) == (lib.IMC_DEVICE_NOT_FOUND, None)  # nothing is attached to the module's own
    (_, first), (_, second) = here.IMC_Open(0, 0), there.IMC_Open(0, 0)
    assert here.IMC_GetParam16(second, lib.movingLoc, 0) == (lib.IMC_INVALID_HANDLE, 0)
    for _ in range(2):
        assert here.IMC_GetParam16(first, lib.movingLoc, 0) == (lib.IMC_OK, 0)
    assert (mine.cycles, theirs.cycles) == (7, 0)
    for _ in range(3):
        assert there.IMC_GetPatamBit(second, lib.movingLoc, 0, 0) == (lib.IMC_OK, 0)
    assert (mine.cycles, theirs.cycles) == (7, 8)
    assert here.IMC_Close(first) == lib.IMC_OK
    assert here.IMC_Close(first) == lib.IMC_INVALID_HANDLE


def test_a_program_that_sleeps_sees_a_card_in_real_time() -> None:
    wall, card = FakeWall(), ToldCard()
    handle = opened(card, clock=Elapsed(wall))
    wall.time_s += 0.0105
    assert lib.IMC_MoveVelocity(handle, 5, 0, lib.SEL_QFIFO) == lib.IMC_OK
    assert card.cycles == 10
    wall.time_s += 0.0205
    for _ in range(9):
        lib.IMC_GetParam16(handle, lib.movingLoc, 0)
    assert card.cycles == 31
