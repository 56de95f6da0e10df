"""fwlib32 from C: every function against the façade, to the byte; who is not there; other tables; whole programs."""

from __future__ import annotations

import ctypes
import os
import random
import socket
import struct
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.clib import FWLIB
from polycnc.servers.process import Machinery
from support import c_meant
from support.c_hold import Hold, Meant
from support.c_library import Door, Guarded, at_door, loaded
from support.focas_line import Line
from support.fwlib_calls import AT_HOME, HANDLE, before, number_of, size_of
from support.often import share

AXES = 4
OPEN_FILES = Path("/proc/self/fd")


@pytest.fixture(scope="module")
def door() -> Iterator[Door]:
    made = Door(("fanuc", Machinery(axes=AXES)))
    yield made
    made.close()


def _rounds(hold: Hold, devices: tuple[Any, Any], rounds: int) -> None:
    calls = [each for each in FWLIB.calls if each.function.name not in AT_HOME]
    for each in calls:
        hold.nulls(each)
    for number in range(rounds):
        for device in devices:
            device.select_mode(c_meant.FANUC_MODES[number % len(c_meant.FANUC_MODES)])
            for program in (7, 8):
                if program not in device.programs:
                    device.programs.register(program, c_meant.PROGRAM.replace("7", str(program)))
        for call in hold.dice.sample(calls, len(calls)):
            hold.call(call)
        for device in devices:
            device.advance(5 * (number % 60))


def _hold(monkeypatch: pytest.MonkeyPatch, folder: Path, rounds: int, seed: int) -> Hold:
    library, door = loaded("fanuc", folder), Door(("fanuc", Machinery(axes=AXES)))
    at_door(monkeypatch, door)
    twin, session = PowerMate(AXES, characters=128_000), fwlib.Session()
    session.attach(0, twin)
    handle = ctypes.c_uint16()
    hold = Hold(
        FWLIB, library, session, random.Random(seed), number_of, size_of, before, c_meant.FANUC, twin.snapshot
    )
    try:
        assert library.cnc_allclibhndl(ctypes.byref(handle)) == session.cnc_allclibhndl()[0] == 0
        assert handle.value == HANDLE
        _rounds(hold, (twin, door.devices[0]), rounds)
    finally:
        door.close()
    for each in FWLIB.calls:
        if each.function.name not in AT_HOME:
            hold.lost(each)
    return hold


def test_every_function_answers_and_writes_as_the_facade(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    hold = _hold(monkeypatch, tmp_path, 10, 11)
    assert {0, 2, 3, 4, 5, -8, -16} <= hold.codes
    assert len(hold.done) > 75


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("seed", range(1))
def test_100_000_calls_answer_and_write_as_the_facade(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seed: int
) -> None:
    hold = _hold(monkeypatch, tmp_path, 1_090, seed)
    assert len(hold.told) > 100_000
    refused = {each.function.name for each in FWLIB.calls} - set(hold.done) - {*AT_HOME}
    assert refused <= {
        "cnc_rdalmhistry",
        "cnc_rdophistry",
        "cnc_wrmdipntr",
    }  # nothing has stopped the histories


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


def test_as_much_is_read_at_once_as_16_bits_count(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    library, door = loaded("fanuc", tmp_path), Door(("fanuc", Machinery(axes=2)))
    at_door(monkeypatch, door)
    handle, number, text = (
        ctypes.c_uint16(),
        ctypes.c_uint16(0xFFFF),
        "O0007\n" + "G4X0.01\n" * 11_000 + "M30\n",
    )
    try:
        control: Any = door.devices[0]
        control.programs.register(7, text)
        assert library.cnc_allclibhndl(ctypes.byref(handle)) == 0
        assert library.cnc_upstart(handle, 7) == 0
        memory = Guarded(4 + 0xFFFF)
        assert library.cnc_upload(handle, ctypes.c_void_p(memory.address), ctypes.byref(number)) == 0
        assert memory.content[4:] == f"%\n{text}%".encode()[:0xFFFF]
        assert (memory.is_kept, number.value) == (True, 0xFFFF)
    finally:
        door.close()


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


def test_threads_of_a_program_get_each_its_own_answers(
    door: Door, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library = loaded("fanuc", tmp_path)
    at_door(monkeypatch, door)
    wrong: list[tuple[int, int]] = []

    def talk(number: int) -> None:
        handle, macro = ctypes.c_uint16(), fwlib.ODBM()
        codes = [library.cnc_allclibhndl(ctypes.byref(handle))]
        for k in range(12):
            value = 1000 * number + k
            codes.append(library.cnc_wrmacro(handle, 500 + number, 10, value, 1))
            codes.append(library.cnc_rdmacro(handle, 500 + number, 10, ctypes.byref(macro)))
            if macro.mcr_val != value:
                wrong.append((number, k))
        codes.append(library.cnc_freelibhndl(handle))
        if any(codes):
            wrong.append((number, -1))

    threads = [threading.Thread(target=talk, args=(number,)) for number in range(1, 65)]
    for each in threads:
        each.start()
    for each in threads:
        each.join(60)
    assert wrong == []


def _clients(rounds: int) -> None:
    """Let clients come and go, many of them in the middle of a call; the door knows none of them afterwards."""
    door = Door(("fanuc", Machinery(axes=2)))
    port = int(door.place.rpartition(":")[2])
    hello = b"PNCCALL1\x08\0\0\0" + b"fwlib32".ljust(16, b"\0") + bytes(16) + FWLIB.table_hash
    call = next(each for each in FWLIB.calls if each.function.name == "cnc_allclibhndl")
    opening = struct.pack("<IHHI", 8, call.number, 1, 2)
    before = len(os.listdir(OPEN_FILES)) if OPEN_FILES.exists() else 0
    try:
        for number in range(rounds):
            with socket.create_connection(("127.0.0.1", port), timeout=60) as line:
                line.sendall(hello + opening[: number % (len(opening) + 1)])
                assert line.recv(12, socket.MSG_WAITALL) == b"PNCCALL1" + bytes(4)
        assert door.clients() == 0
        assert not before or len(os.listdir(OPEN_FILES)) <= before
    finally:
        door.close()


def test_clients_that_end_in_the_middle_of_a_call_leave_nothing() -> None:
    _clients(60)


def test_structures_of_the_other_packing_are_not_overrun(
    door: Door, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    packed = FWLIB.packed(4)
    assert packed is not None
    library, handle, codes = loaded("fanuc", tmp_path, 4), ctypes.c_uint16(), set[int]()
    at_door(monkeypatch, door)
    assert (library.cnc_allclibhndl(ctypes.byref(handle)), handle.value) == (0, HANDLE)
    meant = Meant(
        {name: {each: value for each, value in row.items() if not isinstance(value, bytes)}
         for name, row in c_meant.FANUC.rows.items()}
    )  # fmt: skip
    hold = Hold(packed, library, fwlib.Session(), random.Random(5), number_of, size_of, meant=meant)
    for _ in range(share(12)):
        codes |= {hold.harmless(each) for each in packed.calls if each.function.name not in AT_HOME}
    assert {0, 2, 3, 4, 5, -8} <= codes


@pytest.mark.long
def test_a_thousand_clients_leave_nothing() -> None:
    _clients(1000)
