"""fwlib32 from C: every function against the façade, to the byte; who is not there; other tables; whole programs."""

from __future__ import annotations

import ctypes
import random
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.clib import FWLIB
from polycnc.controllers.library.clib import Call, Slot, Way
from polycnc.servers.process import Machinery
from support.c_hold import Hold, Passed
from support.c_library import Door, at_door, built, loaded
from support.focas_line import Line

AXES = 4
HANDLE = 1
LENGTHS = (4, 5, 6, 8, 10, 12, 16, 20, 28, 38, 46, 118, 262)


@pytest.fixture(scope="module")
def door() -> Iterator[Door]:
    made = Door(("fanuc", Machinery(axes=AXES)))
    yield made
    made.close()


def _number(call: Call, slot: Slot, dice: random.Random) -> Any:
    name = slot.argument.name
    if name == "FlibHndl":
        return HANDLE if dice.random() < 0.95 else dice.choice((0, 2, 0xFFFF))
    if slot.argument.length_of and dice.random() < 0.8:
        return dice.choice(LENGTHS)
    if dice.random() < 0.6:
        return dice.randrange(-1, 5)
    return None


def _size(call: Call, slot: Slot, numbers: dict[str, Any]) -> int:
    """Return what a program has there: what its length says, else one structure, or one per count."""
    name = call.function.name
    if name == "cnc_upload" and slot.way is Way.RECORD:
        return 4 + (numbers["number"] or 0)
    counter = next(
        (each.name for each in call.function.arguments if each.length_of == slot.argument.name), ""
    )
    if counter:
        size = int(numbers[counter] or 0)
        return min(size, slot.width) if slot.way is Way.RECORD and not slot.writes else size
    if slot.argument.many:
        count = 6 if slot.argument.many == "MAX_AXIS" else numbers[slot.argument.many] or 0
        most = 6 if slot.argument.many == "axis" else 0x7FFF
        return max(0, min(most, count)) * slot.width
    return slot.width


def _before(call: Call, passed: list[Passed]) -> Any:
    if call.slots and call.slots[0].argument.name == "FlibHndl" and passed[0].slot.way is Way.VALUE:
        return None if passed[0].python == HANDLE else fwlib.EW_HANDLE
    return None


AT_HOME = ("cnc_allclibhndl", "cnc_allclibhndl2", "cnc_allclibhndl3", "cnc_freelibhndl")


def _hold(
    door: Door, monkeypatch: pytest.MonkeyPatch, folder: Path, rounds: int, seed: int
) -> tuple[Hold, PowerMate]:
    at_door(monkeypatch, door)
    twin = PowerMate(AXES, characters=128_000)
    session = fwlib.Session()
    session.attach(0, twin)
    library = loaded("fanuc", folder)
    handle = ctypes.c_uint16()
    assert (
        (library.cnc_allclibhndl(ctypes.byref(handle)), handle.value) == session.cnc_allclibhndl() == (0, 1)
    )
    hold = Hold(FWLIB, library, session, random.Random(seed), _number, _size, _before)
    calls = [each for each in FWLIB.calls if each.function.name not in AT_HOME]
    for number in range(rounds):
        for call in hold.dice.sample(calls, len(calls)):
            hold.call(call)
        for device in (twin, door.devices[0]):
            device.advance(5 * number)
    return hold, twin


def test_every_function_answers_and_writes_as_the_facade(
    door: Door, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    built("fanuc")
    hold, _ = _hold(door, monkeypatch, tmp_path, 12, 11)
    assert {0, 2, 3, 4, 5, -8} <= hold.codes


@pytest.mark.long
@pytest.mark.parametrize("seed", range(1))
def test_many_calls_answer_and_write_as_the_facade(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seed: int
) -> None:
    built("fanuc")
    door = Door(("fanuc", Machinery(axes=AXES)))
    try:
        _hold(door, monkeypatch, tmp_path, 150, seed)
    finally:
        door.close()


def test_every_function_is_exported_by_its_name(tmp_path: Path) -> None:
    library = loaded("fanuc", tmp_path)
    assert len(fwlib.FUNCTIONS) == 96
    for name in fwlib.FUNCTIONS:
        assert getattr(library, name)


def test_one_axis_is_written_into_room_for_one(
    door: Door, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library = loaded("fanuc", tmp_path)
    at_door(monkeypatch, door)
    handle = ctypes.c_uint16()
    assert library.cnc_allclibhndl(ctypes.byref(handle)) == 0
    room = (ctypes.c_uint8 * 40)(*[0xEE] * 40)
    assert library.cnc_absolute(handle, ctypes.c_int16(2), ctypes.c_int16(8), room) == 0
    assert bytes(room) == b"\0\0\2\0\0\0\0\0" + b"\xee" * 32
    room = (ctypes.c_uint8 * 40)(*[0xEE] * 40)
    assert library.cnc_absolute(handle, ctypes.c_int16(-1), ctypes.c_int16(8), room) == fwlib.EW_LENGTH
    assert bytes(room) == b"\xee" * 40


def test_nobody_there_is_the_manuals_code_at_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    library = loaded("fanuc", tmp_path)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        monkeypatch.setenv("POLYCNC_CALLS", f"127.0.0.1:{port}")
        handle = ctypes.c_uint16(77)
        assert library.cnc_allclibhndl(ctypes.byref(handle)) == fwlib.EW_HSSB
        assert library.cnc_allclibhndl2(3, ctypes.byref(handle)) == fwlib.EW_HSSB
        assert library.cnc_allclibhndl3(b"127.0.0.1", port, 2, ctypes.byref(handle)) == fwlib.EW_SOCKET
        assert library.cnc_allclibhndl3(b"127.0.0.1", 0, 2, ctypes.byref(handle)) == fwlib.EW_SOCKET
        assert library.cnc_allclibhndl3(None, port, 2, ctypes.byref(handle)) == fwlib.EW_DATA
        assert handle.value == 77
        assert library.cnc_statinfo(handle, None) == fwlib.EW_HANDLE


def test_who_listens_and_says_nothing_is_waited_for_as_long_as_the_program_says(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library = loaded("fanuc", tmp_path)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        port = silent.getsockname()[1]
        handle = ctypes.c_uint16()
        assert library.cnc_allclibhndl3(b"127.0.0.1", port, 1, ctypes.byref(handle)) == fwlib.EW_SOCKET


def test_a_control_by_its_address_and_another_by_its_own(
    door: Door, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library = loaded("fanuc", tmp_path)
    at_door(monkeypatch, door)
    other = Door(("fanuc", Machinery(axes=2)))
    try:
        ports = [int(each.place.rpartition(":")[2]) for each in (door, other)]
        handles = []
        for port in (ports[1], ports[0], ports[1]):
            handle = ctypes.c_uint16()
            assert library.cnc_allclibhndl3(b"127.0.0.1", port, 5, ctypes.byref(handle)) == 0
            handles.append(handle.value)
        assert len(set(handles)) == 3
        axes = []
        for each in handles:
            system = (ctypes.c_char * 18)()
            assert library.cnc_sysinfo(each, system) == 0
            axes.append(bytes(system)[-1:])
        assert axes == [b"2", b"4", b"2"]
    finally:
        other.close()


def test_an_unchanged_program_finds_its_control_at_the_port_of_focas(tmp_path: Path) -> None:
    library = loaded("fanuc", tmp_path)
    door = Door(("fanuc", Machinery(axes=2)), focas=True)
    try:
        port = int(door.first_place.rpartition(":")[2])
        line = Line(port)
        handle, system = ctypes.c_uint16(), (ctypes.c_char * 18)()
        assert library.cnc_allclibhndl3(b"localhost", port, 5, ctypes.byref(handle)) == 0
        assert library.cnc_sysinfo(handle, system) == 0
        assert bytes(system)[-1:] == b"2"
        assert line.payload(0x19)
        line.close()
        assert library.cnc_freelibhndl(handle) == 0
    finally:
        door.close()


def test_a_door_that_ends_and_comes_back(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    library = loaded("fanuc", tmp_path)
    first = Door(("fanuc", Machinery(axes=2)))
    at_door(monkeypatch, first)
    handle, other, state = ctypes.c_uint16(), ctypes.c_uint16(), (ctypes.c_uint8 * 18)(*[7] * 18)
    assert library.cnc_allclibhndl(ctypes.byref(handle)) == 0
    first.close()
    assert library.cnc_statinfo(handle, state) == fwlib.EW_SOCKET
    assert library.cnc_statinfo(handle, state) == fwlib.EW_SOCKET
    assert bytes(state) == b"\7" * 18
    second = Door(("fanuc", Machinery(axes=2)))
    try:
        at_door(monkeypatch, second)
        assert library.cnc_statinfo(handle, state) == fwlib.EW_SOCKET
        assert library.cnc_freelibhndl(handle) == 0
        assert library.cnc_freelibhndl(handle) == fwlib.EW_HANDLE
        assert library.cnc_allclibhndl(ctypes.byref(other)) == 0
        assert library.cnc_statinfo(other, state) == 0
    finally:
        second.close()
