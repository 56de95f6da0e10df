"""C libraries whose server ends in a call, or answers nonsense: nothing is written; what the manuals say recovers."""

from __future__ import annotations

import ctypes
import random
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci import pcap
from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.imc import imclib
from polycnc.servers.process import Machinery
from support.c_between import Between
from support.c_library import Door, Guarded, loaded
from support.facade_programs import SYSTEM
from support.often import share

LOST = {"fanuc": fwlib.EW_SOCKET, "imc": imclib.IMC_TIME_OUT, "apci": -4}
MACHINES = {"fanuc": Machinery(axes=2), "imc": Machinery(), "apci": Machinery(file=SYSTEM)}


class Program:
    """What a program does with a library: open it, read something into memory, close it."""

    def __init__(self, kind: str, library: Any) -> None:
        self.kind, self.library, self.handle = kind, library, ctypes.c_void_p()

    def open(self) -> int:
        """Open it, as the manual recovers from what was lost."""
        if self.kind == "fanuc":
            self.library.cnc_freelibhndl(ctypes.c_uint16(self.handle.value or 0))
            return int(self.library.cnc_allclibhndl(ctypes.byref(self.handle)))
        if self.kind == "imc":
            self.library.IMC_Close(self.handle)
            return int(self.library.IMC_Open(ctypes.byref(self.handle), 0, 0))
        rosi, kind = (ctypes.c_uint8 * ctypes.sizeof(pcap.ROSI))(), ctypes.c_int32()
        records = (pcap.TSRP * 18)()
        return int(self.library.InitMcuSystem3(records, rosi, 0, b"system.dat", ctypes.byref(kind)))

    def read(self) -> tuple[int, Guarded]:
        """Return the code of a call that reads, and the memory that it got."""
        if self.kind == "fanuc":
            memory = Guarded(ctypes.sizeof(fwlib.ODBST))
            handle = ctypes.c_uint16(self.handle.value or 0)
            return int(self.library.cnc_statinfo(handle, ctypes.c_void_p(memory.address))), memory
        if self.kind == "imc":
            memory = Guarded(4)
            to = ctypes.c_void_p(memory.address)
            return int(self.library.IMC_GetParam32(self.handle, imclib.curposLoc, to, 0)), memory
        memory = Guarded(8)
        return int(self.library.rdtrvl(ctypes.c_void_p(memory.address))), memory


@pytest.fixture(params=sorted(MACHINES))
def between(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[str, Between]]:
    kind = str(request.param)
    door = Door((kind, MACHINES[kind]))
    made = Between(door.place)
    monkeypatch.setenv("POLYCNC_CALLS", made.place)
    yield kind, made
    made.close()
    door.close()


@pytest.mark.parametrize("cut", [0, 3, -1])
def test_a_server_that_ends_in_a_call_is_recovered_from_as_the_manual_says(
    cut: int, between: tuple[str, Between], tmp_path: Path
) -> None:
    kind, middle = between
    program = Program(kind, loaded(kind, tmp_path))
    for _ in range(2):
        middle.spoil, middle.is_last = (lambda answer: answer), False
        assert program.open() == 0
        code, memory = program.read()
        assert code == 0
        assert memory.content != Guarded(memory.size).content
        middle.spoil, middle.is_last = (lambda answer: answer[:cut]), True
        for _ in range(2):
            code, memory = program.read()
            assert (code, memory.content) == (LOST[kind], Guarded(memory.size).content)


def _changed(dice: random.Random) -> Callable[[bytes], bytes]:
    """Change, cut or lengthen an answer where it says how long it is, to what, and how much of it goes where."""

    def spoil(answer: bytes) -> bytes:
        made = bytearray(answer)
        for _ in range(dice.randint(1, 3)):
            at = dice.choice((0, 1, 4, 6, 20, 21, 23))
            made[at] = dice.choice((0, 1, 0x7F, 0xFF, made[at] ^ 4))
        match dice.randrange(4):
            case 0:
                return bytes(made[: dice.randrange(len(made))])
            case 1:
                size = min(65_000, len(made) + dice.choice((1, 4, 4000, 60_000)))
                return struct.pack("<I", size - 4) + bytes(made[4:]).ljust(size - 4, b"\x5a")
            case _:
                return bytes(made)

    return spoil


def test_answers_that_are_none_write_nothing(between: tuple[str, Between], tmp_path: Path) -> None:
    kind, middle = between
    program, dice, lost = Program(kind, loaded(kind, tmp_path)), random.Random(7), 0
    count = share(160)
    for _ in range(count):
        middle.spoil, middle.is_last = (lambda answer: answer), False
        assert program.open() == 0
        middle.spoil, middle.is_last = _changed(dice), True
        code, memory = program.read()
        assert memory.is_kept
        if code == LOST[kind]:
            assert memory.content == Guarded(memory.size).content
            lost += 1
        else:
            assert code == 0  # what was changed was as before
    assert lost > count // 2
