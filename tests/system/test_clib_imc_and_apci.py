"""IMCnet and mcug3 from C: every function against the façade, to the byte; opening, losing and finding again."""

from __future__ import annotations

import ctypes
import random
import socket
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci import Board, load_system_file, pcap
from polycnc.controllers.apci.clib import MCUG3
from polycnc.controllers.imc import Card, imclib
from polycnc.controllers.imc.clib import IMCNET
from polycnc.controllers.library.clib import Call, Slot
from polycnc.servers.process import Machinery
from support import c_meant
from support.c_hold import Hold, Passed
from support.c_library import Door, Guarded, at_door, built, loaded

SYSTEM = Path(__file__).parents[2] / "examples" / "apci_system.dat"
AXES = 3
LARGEST, LEAST = 0x7FFFFFFF, -0x80000000
MANY = 4096  # more elements than any call looks at


def _size(call: Call, slot: Slot, numbers: dict[str, Any]) -> int:
    """Return what a program has there: so many elements as another argument says, else one structure."""
    name = slot.argument.name
    counter = next((each.name for each in call.function.arguments if each.length_of == name), "")
    if counter:
        width = 8 if name == "spdbuf" else slot.width
        return max(0, min(MANY, int(numbers[counter]))) * width
    if slot.argument.many == "MAXAXIS":
        return 18 * slot.width
    if slot.argument.many:  # up to the highest selected axis
        chosen = numbers["as"]
        named = [] if chosen is None else list(chosen.san)[: max(0, min(18, chosen.unoa))]
        return max((each + 1 for each in named if 0 <= each < 18), default=0) * slot.width
    return 1024 if name == "EnvStr" else slot.width


# ---------------------------------------------------------------------- IMCnet


def _imc_number(call: Call, slot: Slot, dice: random.Random) -> Any:
    name = slot.argument.name
    if name == "Handle":
        return 1 if dice.random() < 0.95 else dice.choice((0, 2, 77))
    if slot.argument.length_of:
        return dice.choice((1, 2, 3, 5, 0, 32, 33, 127, 4000, -1, LARGEST, LEAST))
    if name == "paramloc" and dice.random() < 0.7:
        return dice.choice((imclib.runLoc, imclib.mcstgposLoc, imclib.mcsgoLoc, imclib.encpLoc))
    if dice.random() < 0.7:
        return dice.randrange(0, 4)
    return None


def _larger_than_a_frame(call: Call, passed: list[Passed]) -> Any:
    """Answer a list of more elements than a frame holds, as the library does itself."""
    if call.function.name != "IMC_SetMulParam" or passed[1].is_null or passed[2].python <= MANY:
        return None
    return imclib.IMC_INVALID_PARAM


def _imc_hold(monkeypatch: pytest.MonkeyPatch, folder: Path, rounds: int, seed: int) -> Hold:
    library = loaded("imc", folder)
    door = Door(("imc", Machinery()))
    at_door(monkeypatch, door)
    twin, session = Card(), imclib.Session()
    session.attach(twin, clock=None)
    try:
        handle = ctypes.c_void_p(0xABCD)
        assert library.IMC_Open(ctypes.byref(handle), 0, 0) == 0
        assert handle.value == 1
        _, mine = session.IMC_Open(0, 0)
        hold = Hold(
            IMCNET,
            library,
            session,
            random.Random(seed),
            _imc_number,
            _size,
            _larger_than_a_frame,
            c_meant.IMC,
            twin.snapshot,
            objects={1: mine},
        )
        opening = {"IMC_Open", "IMC_OpenX", "IMC_OpenUsePassword", "IMC_Close"}
        calls = [each for each in IMCNET.calls if each.function.name not in opening]
        for each in calls:
            hold.nulls(each)
        for number in range(rounds):
            for call in hold.dice.sample(calls, len(calls)):
                hold.call(call)
            for card in (twin, door.devices[0]):
                card.advance(3 * (number % 90))
    finally:
        door.close()
    for each in calls:
        hold.lost(each)
    return hold


def test_every_function_of_imcnet_answers_and_writes_as_the_facade(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    built("imc")
    hold = _imc_hold(monkeypatch, tmp_path, 10, 3)
    assert {0, 3, 6, 7, 8, 9, 13} <= hold.codes
    assert len(hold.done) > 42


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("seed", range(1))
def test_100_000_calls_of_imcnet(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seed: int) -> None:
    built("imc")
    hold = _imc_hold(monkeypatch, tmp_path, 2_100, seed)
    assert len(hold.told) > 100_000
    assert len(hold.done) == len(IMCNET.calls) - 5  # those that open, close and look for adapters


def test_cards_are_opened_closed_lost_and_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    library = loaded("imc", tmp_path)
    door = Door(("imc", Machinery()), ("imc", Machinery(name="second")), ("fanuc", Machinery("third")))
    at_door(monkeypatch, door)
    handle, second = ctypes.c_void_p(), ctypes.c_void_p(0x777)
    assert library.IMC_Open(ctypes.byref(handle), 0, 1) == 0
    assert library.IMC_OpenX(ctypes.byref(second), 0, 2, 40, 1) == imclib.IMC_DEVICE_NOT_FOUND
    assert second.value == 0x777
    moving = ctypes.c_int16()
    assert library.IMC_GetPatamBit is not None
    assert library.IMC_GetParam16(handle, imclib.movingLoc, ctypes.byref(moving), 0) == 0
    assert library.IMC_Close(handle) == 0
    assert library.IMC_Close(handle) == imclib.IMC_INVALID_HANDLE
    assert library.IMC_GetParam16(handle, 1, ctypes.byref(moving), 0) == imclib.IMC_DEVICE_NOT_OPEN
    assert library.IMC_Open(ctypes.byref(handle), 0, 0) == 0
    door.close()
    assert library.IMC_GetParam16(handle, 1, ctypes.byref(moving), 0) == imclib.IMC_TIME_OUT
    assert library.IMC_Open(ctypes.byref(handle), 0, 0) == imclib.IMC_DEVICE_NOT_FOUND
    again = Door(("imc", Machinery()))
    try:
        at_door(monkeypatch, again)
        assert library.IMC_GetParam16(handle, 1, ctypes.byref(moving), 0) == imclib.IMC_TIME_OUT
        assert library.IMC_Open(ctypes.byref(handle), 0, 0) == 0
        assert library.IMC_GetParam16(handle, imclib.movingLoc, ctypes.byref(moving), 0) == 0
    finally:
        again.close()


# ---------------------------------------------------------------------- mcug3


def _apci_number(call: Call, slot: Slot, dice: random.Random) -> Any:
    if slot.element is ctypes.c_double:
        return dice.choice((0.0, 2.5, -7.25, 400.0, 1e101, float("nan"), -0.0))
    if slot.argument.length_of:
        return dice.choice((0, 1, 3, 17, -4, LARGEST, LEAST))
    if slot.argument.name == "ndx" and dice.random() < 0.8:
        return dice.randrange(-1, 1001)
    if dice.random() < 0.75:
        return dice.randrange(-1, AXES + 2)
    return None


def _apci(monkeypatch: pytest.MonkeyPatch, folder: Path, seed: int) -> tuple[Hold, Door, Board]:
    library = loaded("apci", folder)
    door = Door(("apci", Machinery(file=SYSTEM)))
    at_door(monkeypatch, door)
    twin, session = Board(load_system_file(SYSTEM)), pcap.Session()
    session.attach(twin, clock=None)
    hold = Hold(
        MCUG3,
        library,
        session,
        random.Random(seed),
        _apci_number,
        _size,
        meant=c_meant.APCI,
        state=twin.snapshot,
    )
    return hold, door, twin


BESIDE = set(MCUG3.extensions)
"""What needs an extended record, and does nothing with one of the manual."""
FILES = BESIDE | set(MCUG3.interrupts) | {"rdcbcnct", "wrcbcnct"}


def _apci_hold(monkeypatch: pytest.MonkeyPatch, folder: Path, rounds: int, seed: int) -> Hold:
    hold, door, twin = _apci(monkeypatch, folder, seed)
    try:
        by_name = {each.function.name: each for each in MCUG3.calls}
        assert hold.c.rdaxstb(0, 3) == hold.python.rdaxstb(0, 3) == 0
        calls = [each for name, each in by_name.items() if name not in FILES]
        for each in calls:  # no board is there yet
            hold.call(each)
        tsrp, mine = (pcap.TSRP * 18)(), pcap.tsrp_array()
        assert hold.c.InitMcuSystem(tsrp) == hold.python.InitMcuSystem(mine) == 0
        assert bytes(tsrp) == b"".join(map(bytes, mine))[: ctypes.sizeof(tsrp)]
        for each in calls:
            hold.nulls(each)
        for number in range(rounds):
            for call in hold.dice.sample(calls, len(calls)):
                hold.call(call)
            for board in (twin, door.devices[0]):
                board.advance(3 * (number % 90))
    finally:
        door.close()
    for each in calls:
        hold.lost(each)
    return hold


def test_every_function_of_mcug3_answers_and_writes_as_the_facade(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    built("apci")
    hold = _apci_hold(monkeypatch, tmp_path, 3, 4)
    assert {0, 1, -4, 31} <= hold.codes
    assert len(hold.done) > 170


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("seed", range(1))
def test_100_000_calls_of_mcug3(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seed: int) -> None:
    built("apci")
    hold = _apci_hold(monkeypatch, tmp_path, 560, seed)
    assert len(hold.told) > 100_000
    assert {each.function.name for each in MCUG3.calls} - set(hold.done) == FILES


class CBCNCT(ctypes.Structure):
    """The transfer of a buffer as C programs of this width have it."""

    _pack_ = 4
    _layout_ = "ms"
    _fields_ = [
        ("task_number", ctypes.c_int32),
        ("size", ctypes.c_int32),
        ("buffer", ctypes.c_void_p),
    ]


def test_common_buffers_go_through_the_pointer_in_a_structure(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    hold, door, _ = _apci(monkeypatch, tmp_path, 5)
    library = hold.c
    try:
        assert library.InitMcuSystem((pcap.TSRP * 18)()) == 0
        content, held = (ctypes.c_uint8 * 9)(*b"abcdefghi"), Guarded(1001, bytes(1001))
        into = (ctypes.c_uint8 * 9)(*[0xEE] * 9)
        write = CBCNCT(2, 7, ctypes.addressof(content))
        read = CBCNCT(2, 5, ctypes.addressof(into))
        assert library.wrcbcnct(ctypes.byref(write)) == 0
        assert library.rdcbcnct(ctypes.byref(read)) == 0
        assert bytes(into) == b"abcde" + b"\xee" * 4
        assert bytes(write) == bytes(CBCNCT(2, 7, ctypes.addressof(content)))
        assert library.rdcbcnct(ctypes.byref(CBCNCT(9, 5, ctypes.addressof(into)))) == 1
        for call in (library.rdcbcnct, library.wrcbcnct):
            for size in (-1, 1001, 70_000, LARGEST, LEAST):  # more than there is
                assert call(ctypes.byref(CBCNCT(2, size, held.address))) == 2
        assert held.content == bytes(1001)
        assert library.rdcbcnct(ctypes.byref(CBCNCT(2, 5, None))) == 4
        assert library.rdcbcnct(None) == 1
        assert bytes(into) == b"abcde" + b"\xee" * 4
    finally:
        door.close()


def test_values_without_a_place_go_through_an_extended_record(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert len(BESIDE) == 9
    hold, door, _ = _apci(monkeypatch, tmp_path, 8)
    extended, library = MCUG3.classes["TSRPX"], hold.c
    marks = (0x584E4350, 0x31505253, ctypes.sizeof(extended), ~ctypes.sizeof(extended))
    try:
        tsrp, mine = (pcap.TSRP * 18)(), pcap.tsrp_array()
        assert library.InitMcuSystem(tsrp) == hold.python.InitMcuSystem(mine) == 0
        for axis in range(AXES):
            for name in sorted(
                BESIDE, key=lambda each: (each[2:], each[0] == "r")
            ):  # written before it is read
                plain = pcap.TSRP(an=axis)
                outer = extended(tsrp=plain, aux=2.5 + axis, lp=7.25, dv=3.5, sdec=80.0 + axis)
                twin = pcap.TSRP.from_buffer_copy(bytes(plain))
                twin.aux, twin.lp, twin.dv, twin.sdec = outer.aux, outer.lp, outer.dv, outer.sdec
                unmarked = Guarded(ctypes.sizeof(plain), bytes(plain))
                getattr(library, name)(ctypes.c_void_p(unmarked.address))
                assert unmarked.content == bytes(plain), name
                for k, mark in enumerate(marks):
                    outer.tsrp.scratch[k] = mark
                memory = Guarded(ctypes.sizeof(outer), bytes(outer))
                getattr(library, name)(ctypes.c_void_p(memory.address))
                getattr(hold.python, name)(twin)
                after = extended.from_buffer_copy(memory.content)
                shown = (after.aux, after.lp, after.dv, after.sdec)
                assert shown == (twin.aux, twin.lp, twin.dv, twin.sdec), name
                assert list(after.tsrp.scratch) == list(marks)
                assert memory.is_kept
            read = pcap.TSRP(an=axis)
            hold.python.rdaux(read)
            assert read.aux == 2.5 + axis  # so it has been written
    finally:
        door.close()


def test_a_board_is_initialised_lost_and_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    hold, door, _ = _apci(monkeypatch, tmp_path, 6)
    library, records, kind = hold.c, (pcap.TSRP * 18)(), ctypes.c_int32(-7)
    rosi = (ctypes.c_uint8 * ctypes.sizeof(pcap.ROSI))(*[0xEE] * ctypes.sizeof(pcap.ROSI))
    initialised = (records, rosi, 0, b"C:\\CNC\\system.dat", ctypes.byref(kind))
    mine, system = pcap.tsrp_array(), pcap.ROSI()
    try:
        expected = hold.python.InitMcuSystem3(mine, system, 0, "system.dat")
        assert (library.InitMcuSystem3(*initialised), kind.value) == expected
        assert expected[0] == 0
        assert bytes(rosi) == bytes(system)
        text = ctypes.create_string_buffer(b"NOTHING\0" + b"\xee" * 20, 1024)
        assert library.getEnvStr(text) == hold.python.getEnvStr("NOTHING")[0]
        assert library.BootFile(b"rwmos.elf", 0) == 202
        value = ctypes.c_int32(5)
        assert library.rdSampleTime(None) == 0
        assert library.rdSampleTime(ctypes.byref(value)) == 1
    finally:
        door.close()
    value = ctypes.c_int32(5)
    assert library.rdtrvl(ctypes.byref(ctypes.c_double())) == -4
    assert (library.rdSampleTime(ctypes.byref(value)), value.value) == (0, 5)
    assert library.rdaxstb(0, 3) == 0
    kind.value = -7
    assert (library.InitMcuSystem3(*initialised), kind.value) == (31, -7)
    again = Door(("apci", Machinery(file=SYSTEM)))
    try:
        at_door(monkeypatch, again)
        assert library.rdtrvl(ctypes.byref(ctypes.c_double())) == -4
        assert library.InitMcuSystem3(*initialised) == 0
        assert library.rdtrvl(ctypes.byref(ctypes.c_double())) == 0
    finally:
        again.close()


def test_programs_leave_nothing_at_a_board(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    hold, door, _ = _apci(monkeypatch, tmp_path, 7)
    try:
        board = door.devices[0]
        assert isinstance(board, Board)
        before = len(board.interrupts)
        for _ in range(5):
            line = socket.create_connection(("127.0.0.1", int(door.place.rpartition(":")[2])))
            said = b"PNCCALL1\x08\0\0\0" + b"mcug3".ljust(16, b"\0") + bytes(16) + MCUG3.table_hash
            line.sendall(said)
            assert line.recv(12) == b"PNCCALL1" + bytes(4)
            line.close()
        assert hold.c.InitMcuSystem((pcap.TSRP * 18)()) == 0
        assert len(board.interrupts) == before + 1
    finally:
        door.close()


@pytest.mark.parametrize(
    ("kind", "nobody"), [("fanuc", -9), ("imc", imclib.IMC_DEVICE_NOT_FOUND), ("apci", 31)]
)
def test_an_opening_call_finds_a_server_that_was_started_again(
    kind: str, nobody: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library, machinery = loaded(kind, tmp_path), Machinery(file=SYSTEM if kind == "apci" else None)
    handle, records = ctypes.c_void_p(), (pcap.TSRP * 18)()

    def opened() -> int:
        if kind == "apci":
            return int(library.InitMcuSystem(records))
        if kind == "imc":
            return int(library.IMC_Open(ctypes.byref(handle), 0, 0))
        return int(library.cnc_allclibhndl(ctypes.byref(handle)) or library.cnc_freelibhndl(handle))

    first = Door((kind, machinery))
    at_door(monkeypatch, first)
    assert opened() == 0
    first.close()
    again = Door((kind, machinery), port=int(first.place.rpartition(":")[2]))
    try:
        assert opened() == 0  # no call in between has told the library that the first one is gone
    finally:
        again.close()
    assert opened() == nobody
