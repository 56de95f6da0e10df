"""Calls that open and close: with what is none, and by several programs of one machine."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci import pcap
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.imc import Card, imclib
from polycnc.servers.process import Machinery
from support.c_library import Door, at_door, built, loaded
from support.command import environment
from support.facade_programs import SYSTEM

LARGEST, LEAST = 0x7FFFFFFF, -0x80000000


@pytest.fixture
def cards(monkeypatch: pytest.MonkeyPatch) -> Iterator[Door]:
    door = Door(("imc", Machinery()), ("imc", Machinery(name="second")))
    at_door(monkeypatch, door)
    yield door
    door.close()


OPENINGS = [
    (name, (*card, *rest))
    for card in ((0, 0), (0, 1), (0, 2), (0, -1), (1, 0), (-1, 0), (LARGEST, LARGEST), (LEAST, LEAST))
    for name, rest in (
        ("IMC_Open", ()),
        ("IMC_OpenX", (40, 1)),
        ("IMC_OpenX", (-1, 0)),
        ("IMC_OpenX", (LARGEST, LEAST)),
        ("IMC_OpenUsePassword", ("",)),
        ("IMC_OpenUsePassword", ("x" * 4096,)),
        ("IMC_OpenUsePassword", (None,)),
    )
]


def test_cards_are_opened_and_refused_as_by_the_facade(cards: Door, tmp_path: Path) -> None:
    library, session = loaded("imc", tmp_path), imclib.Session()
    session.attach(Card(), Card(), clock=None)
    for name, given in OPENINGS:
        handle = ctypes.c_void_p(0x777)
        held = [each.encode().ljust(1, b"\0") if isinstance(each, str) else each for each in given]
        code = getattr(library, name)(ctypes.byref(handle), *held)
        expected, mine = getattr(session, name)(*given)
        assert code == expected, (name, given)
        assert (handle.value == 0x777) == (mine is None), (name, given)
        assert getattr(library, name)(None, *held) == imclib.IMC_INVALID_PARAM
        if mine is not None:
            assert library.IMC_Close(handle) == session.IMC_Close(mine) == 0
            assert library.IMC_Close(handle) == session.IMC_Close(mine) == imclib.IMC_INVALID_HANDLE


def test_a_handle_with_more_bits_than_any_has_is_none(cards: Door, tmp_path: Path) -> None:
    library, handle, at = loaded("imc", tmp_path), ctypes.c_void_p(), ctypes.c_int32(5)
    assert library.IMC_Open(ctypes.byref(handle), 0, 0) == 0
    beyond = ctypes.c_void_p((handle.value or 0) | 1 << 32)
    reads = (imclib.curposLoc, ctypes.byref(at), 0)
    assert (library.IMC_GetParam32(beyond, *reads), at.value) == (imclib.IMC_INVALID_HANDLE, 5)
    assert library.IMC_Close(beyond) == imclib.IMC_INVALID_HANDLE
    assert library.IMC_GetParam32(handle, *reads) == 0


def test_adapters_are_found_before_a_card_is_open(cards: Door, tmp_path: Path) -> None:
    library, session = loaded("imc", tmp_path), imclib.Session()
    session.attach(Card(), Card(), clock=None)
    found, number, mine = imclib.NIC_INFO(), ctypes.c_int(-7), imclib.NIC_INFO()
    assert library.IMC_FindNetCard(None, ctypes.byref(number)) == imclib.IMC_INVALID_PARAM
    assert library.IMC_FindNetCard(ctypes.byref(found), None) == imclib.IMC_INVALID_PARAM
    assert (number.value, bytes(found)) == (-7, bytes(imclib.NIC_INFO()))
    code = library.IMC_FindNetCard(ctypes.byref(found), ctypes.byref(number))
    assert (code, number.value) == session.IMC_FindNetCard(mine)
    assert bytes(found) == bytes(mine)


def test_two_programs_have_one_card(cards: Door, tmp_path: Path) -> None:
    programs, handles = [loaded("imc", tmp_path) for _ in range(2)], [ctypes.c_void_p() for _ in range(2)]
    at = ctypes.c_int32()
    for each, handle in zip(programs, handles, strict=True):
        assert each.IMC_Open(ctypes.byref(handle), 0, 0) == 0
    one, other = programs
    queue = imclib.SEL_IFIFO
    assert one.IMC_SetParam32(handles[0], imclib.mcsmaxvelLoc, 70_000, 0, queue) == 0
    cards.devices[0].advance(2)
    assert other.IMC_GetParam32(handles[1], imclib.mcsmaxvelLoc, ctypes.byref(at), 0) == 0
    assert at.value == 70_000
    assert one.IMC_Close(handles[0]) == 0
    assert one.IMC_GetParam32(handles[0], imclib.mcsmaxvelLoc, ctypes.byref(at), 0) != 0
    assert other.IMC_GetParam32(handles[1], imclib.mcsmaxvelLoc, ctypes.byref(at), 0) == 0


def test_two_programs_have_one_board(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    door = Door(("apci", Machinery(file=SYSTEM)))
    at_door(monkeypatch, door)
    one, other = (loaded("apci", tmp_path) for _ in range(2))
    records, read = (pcap.TSRP * 18)(), pcap.TSRP(an=1)
    try:
        assert one.InitMcuSystem(records) == other.InitMcuSystem(records) == 0
        records[1].jvl = 12.5
        one.wrjvl(ctypes.byref(records[1]))
        other.rdjvl(ctypes.byref(read))
        assert read.jvl == 12.5
    finally:
        door.close()


_OPENS = """\
#include "fwlib32.h"
int main(void)
{
    unsigned short handle;
    return cnc_allclibhndl(&handle) ? 1 : 0;
}
"""


def test_a_file_beside_the_program_or_else_the_library_says_where_the_machine_is(tmp_path: Path) -> None:
    door, library, program = Door(("fanuc", Machinery(axes=2))), tmp_path / "lib", tmp_path / "bin" / "opens"
    shutil.copytree(built("fanuc"), library)
    program.parent.mkdir()
    (tmp_path / "opens.c").write_text(_OPENS)
    subprocess.run(
        ["gcc", "-o", program, tmp_path / "opens.c", "-I", library, "-L", library, "-lfwlib32",
         f"-Wl,-rpath,{library}"], check=True,
    )  # fmt: skip
    nobody, served = 'calls = "127.0.0.1:1"\n', f'# a control\ncalls = "{door.place}"\n'

    def opened(beside_program: str, beside_library: str, variable: str = "") -> bool:
        for folder, text in ((program.parent, beside_program), (library, beside_library)):
            (folder / "polycnc.toml").write_text(text)
        ran = subprocess.run([program], env=environment(POLYCNC_CALLS=variable), timeout=60, check=False)
        assert ran.returncode in (0, 1)
        return ran.returncode == 0

    try:
        assert opened("", served)
        assert opened(served, nobody)
        assert not opened(nobody, served)
        assert opened(nobody, nobody, door.place)
    finally:
        door.close()


@pytest.mark.parametrize("address", [b"", b"x" * 255, b"256.0.0.1", b":::", b"[", b"%s%n", b"\xff\xfe"])
def test_an_address_that_is_none_is_a_control_that_nobody_finds(address: bytes, tmp_path: Path) -> None:
    library, handle = loaded("fanuc", tmp_path), ctypes.c_uint16(77)
    for port, wait_s in ((8193, 1), (0, 0), (0xFFFF, LARGEST), (8193, -1), (8193, LEAST)):
        code = library.cnc_allclibhndl3(address, port, wait_s, ctypes.byref(handle))
        assert (code, handle.value) == (fwlib.EW_SOCKET, 77)


def test_handles_of_a_control_are_given_to_their_number(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A program that never frees gets the code of the façade when there are no more, and others still have theirs."""
    door, session = Door(("fanuc", Machinery(axes=2))), fwlib.Session()
    session.attach(0, PowerMate(2))
    at_door(monkeypatch, door)
    libraries: list[Any] = [loaded("fanuc", tmp_path) for _ in range(2)]
    handle = ctypes.c_uint16()
    try:
        codes = [libraries[0].cnc_allclibhndl(ctypes.byref(handle)) for _ in range(300)]
        assert codes == [session.cnc_allclibhndl()[0] for _ in range(300)]
        assert libraries[1].cnc_allclibhndl(ctypes.byref(handle)) == 0
    finally:
        door.close()
