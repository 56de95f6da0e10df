"""The sender door against wrong bytes: every line is answered once, and the machine behind it lives on."""

from __future__ import annotations

import random
import re

import pytest

from polycnc.cnc import Control
from polycnc.servers.grbl import GrblCore, grbl_control

PARTS = (
    b"G0", b"G1", b"G2", b"G90", b"G91", b"G38.2", b"G10L2P1", b"G43.1", b"X1.5", b"Y-2", b"Z", b"F600", b"F0", b"S-1",
    b"I9", b"R1e308", b"Xnan", b"X99999999999999999999", b"M3", b"M30", b"M7.7", b"T1", b"$$", b"$I", b"$G", b"$#",
    b"$N0=", b"$J=G91X1F9", b"$J=", b"$110=0", b"$999=1", b"$1", b"$RST=$", b"$RST=", b"$H", b"$X", b"$C", b"(", b")",
    b";", b"%", b"N99999999", b"*33", b" ", b"\t", b"\xc3\xa4", b"=", b".", b"-", b"/",
)  # fmt: skip
KEYS = (
    b"?",
    b"!",
    b"~",
    b"\x18",
    b"\x84",
    b"\x85",
    b"\x90",
    b"\x91",
    b"\x95",
    b"\x97",
    b"\x9e",
    b"\xa0",
    b"\xff",
    b"\0",
)
ANSWER = re.compile(rb"^(ok|error:\d+)\r\n", re.M)
STARTS = b"Grbl 1.1h"


def _line(chance: random.Random) -> bytes:
    kind = chance.random()
    if kind < 0.15:
        text = chance.randbytes(chance.randrange(1, 100))
        return bytes(byte for byte in text if byte not in b"?!~\x18\r\n" and byte < 0x80)
    if kind < 0.18:
        return b"G1X" + b"1" * chance.randrange(200, 900)
    return b"".join(chance.choices(PARTS, k=chance.randrange(1, 7)))


class Attacked:
    """A control behind the door, and what was sent to it."""

    def __init__(self) -> None:
        self.control: Control = grbl_control("mill3")
        self.control.advance(1)
        self.core = GrblCore(self.control)
        self.core.greet()
        self.owed = 0
        self.answered = 0

    def send(self, data: bytes) -> None:
        self.take(self.core.receive(data))

    def take(self, given: bytes) -> None:
        found = len(ANSWER.findall(given))
        self.answered += found
        self.owed = 0 if STARTS in given else self.owed - found  # a reset forgets the lines that wait
        assert self.owed >= 0, given

    def settle(self) -> None:
        """Let time pass until everything is answered, or only a reset helps, which is pressed then."""
        for _ in range(5):
            self.take(self.core.turn())
            if not self.core.busy and self.owed == 0:
                return
            self.control.advance(400)
        self.send(b"\x18")
        self.control.advance(400)
        self.take(self.core.turn())
        self.owed = 1
        self.send(b"$X\n")  # out of the alarm that a reset in motion is
        assert self.owed == 0


def attack(count: int, seed: int) -> None:
    chance = random.Random(seed)
    one = Attacked()
    for number in range(count):
        text = _line(chance)
        if chance.random() < 0.15:
            at = chance.randrange(len(text) + 1)
            text = text[:at] + chance.choice(KEYS) + text[at:]
        before, reset, text = text.rpartition(b"\x18")
        if reset:  # what comes behind it is a line of its own
            one.send(before + reset)
            one.owed = 0
        data = text + b"\n"
        cut = chance.randrange(len(data) + 1)
        one.owed += 1
        one.send(data[:cut])
        one.send(data[cut:])
        if number % 20 == 19:
            one.settle()
    one.settle()
    assert one.answered > count // 3
    one.send(b"\x18")
    one.control.advance(2_000)
    one.core.turn()
    assert b"|MPos:" in one.core.receive(b"?")


def test_wrong_lines_are_answered_once_each() -> None:
    attack(10_000, 20261124)


@pytest.mark.long
@pytest.mark.timeout(0)
def test_a_million_wrong_lines() -> None:
    attack(1_000_000, 7)
