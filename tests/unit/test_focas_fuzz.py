"""Frames of every kind of wrong against a session without sockets: nothing breaks, hangs, leaks or changes."""

from __future__ import annotations

import random
import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.fanuc.wire import (
    Frame,
    FrameReader,
    FrameType,
    Request,
    read_replies,
    write_requests,
)
from polycnc.machine import copied
from polycnc.servers.focas import COMMANDS, PROFILES, WRITING, FocasControl, Session, State, load_profile

PROGRAM = b"O0815 (SQUARE)\nN10 G90 G1 F600 X-12.5\nN20 Y7.25\nM30\n"
ORDINARY, LONG = 10_000, 1_000_000
SEED = 20261122
_MOST_BODY = 0xFFFF
_NUMBERS = (
    -(1 << 31),
    -1,
    0,
    1,
    2,
    3,
    7,
    99,
    100,
    500,
    501,
    815,
    1000,
    1003,
    1320,
    6711,
    9999,
    (1 << 31) - 1,
)
_LOOK_EVERY = 5
_MOST_GROWTH_KB = 8 << 10
_DATA = (0, 1, 7, 8, 12, 16, 256)
OPEN = [bytes(Frame(FrameType.OPEN, bytes((0, channel)))) for channel in (1, 2)]


class Bench:
    """A control, a client that nobody may disturb, and attackers."""

    def __init__(self, profile: str) -> None:
        self.power_mate = PowerMate(3, characters=4000, most_programs=12)
        self.power_mate.programs.register(815, PROGRAM)
        self.power_mate.select_program(815)
        self.control = FocasControl(self.power_mate, load_profile(profile))
        self.version = self.control.version
        self.witness = Session(self.control)
        self.witness.receive(OPEN[1])
        self.asked = bytes(
            Frame(
                FrameType.COMMANDS,
                write_requests([Request(0x18), Request(0x26, (4, -1, 0, 0)), Request(0x89)]),
            )
        )
        self.seen = self.witness.receive(self.asked)
        self.before = self.state()

    def state(self) -> tuple[Any, ...]:
        """Return everything that a client could have changed."""
        stored = self.power_mate.store.query("SELECT * FROM sqlite_master")
        tables = [row[1] for row in stored if row[0] == "table" and not row[1].startswith("sqlite_")]
        content = tuple(
            tuple(map(tuple, self.power_mate.store.query(f'SELECT * FROM "{name}"'))) for name in tables
        )
        made = self.power_mate
        seen = (
            made.status(),
            copied(made.signals.state),
            copied(made.state.pmc),
            made.mode,
            made.state.cursor,
            made.mdi.state.blocks,
        )
        return content, seen, made.transfer is None, made.clock.epoch

    def look(self, case: object) -> None:
        """Hold the others to what they saw."""
        assert self.witness.state is State.COMMAND, case
        assert self.witness.receive(self.asked) == self.seen, case


def arguments(random: random.Random) -> tuple[int, int, int, int]:
    first = random.choice(_NUMBERS)
    last = first if random.random() < 0.5 else random.choice(_NUMBERS)
    return first, last, random.choice(_NUMBERS), random.choice(_NUMBERS)


def request(random: random.Random) -> Request:
    if random.random() < 0.9:
        target, code = random.choice(list(COMMANDS))
    else:
        target, code = random.choice((0, 1, 2, 3, 0xFFFF)), random.randrange(1 << 16)
    data = random.randbytes(random.choice(_DATA)) if random.random() < 0.3 else b""
    if data and len(data) == 256:
        path = random.choice((b"//CNC_MEM/USER/PATH1/", b"//CNC_MEM/USER/PATH1/O815", b"//CNC_MEM", b"\xff"))
        data = path.ljust(256, b"\0")
    return Request(code, arguments(random), data, target, random.choice((1, 1, 1, 0, 2, 0xFFFF)))


def transfer(random: random.Random) -> bytes:
    kind = random.choice((FrameType.DOWNLOAD_START, FrameType.UPLOAD_START))
    name = random.choice(
        (b"", b"N:", b"N://CNC_MEM/", b"O0815-O0815", b"O0001-O9999", b"O12x", b"\xff\xfe", b"O1")
    )
    head = bytes((0, 0, 0, 1)) + name.ljust(512, b"\0")
    frames = bytes(Frame(kind, head[: random.choice((516, 516, 3, 0, 700))]))
    for _ in range(random.randrange(3)):
        number = b"O%04d" % random.choice((0, 1, 7, 815, 9999))
        text = random.choice(
            (b"\n" + number + b"\nG4X1\nM30\n%", b"G1X", b"\n\xff%", b"\n" * 50, random.randbytes(30))
        )
        frames += bytes(Frame(FrameType.DOWNLOAD_DATA, text))
    return frames + bytes(
        Frame(random.choice((FrameType.DOWNLOAD_END, FrameType.UPLOAD_END, FrameType.CLOSE)))
    )


def commands(random: random.Random) -> bytes:
    many = random.choice((0, 1, 1, 2, 9, 60))
    return bytes(Frame(FrameType.COMMANDS, write_requests([request(random) for _ in range(many)])))


def case(random: random.Random) -> list[bytes]:
    """Return the pieces that a client sends: a beginning, then frames that are more or less wrong."""
    begin = random.choice((OPEN[1], OPEN[1], OPEN[1], OPEN[0], OPEN[0], b""))
    good = transfer(random) if begin == OPEN[0] and random.random() < 0.9 else commands(random)
    match random.randrange(8):
        case 0:
            sent = good[: random.randrange(len(good))]  # truncated
        case 1:
            sent = good + random.randbytes(random.randrange(1, 60))
        case 2:
            spoiled = bytearray(good)
            for _ in range(random.randrange(1, 4)):
                spoiled[random.randrange(len(spoiled))] ^= 1 << random.randrange(8)
            sent = bytes(spoiled)
        case 3:
            sent = random.randbytes(random.randrange(1, 120))
        case 4:
            sent = bytes(
                Frame(random.choice(list(FrameType)), random.randbytes(random.choice((0, 2, 8, 40))))
            )  # out of order
        case 5:
            sent = good[:8] + random.randrange(1 << 16).to_bytes(2, "big") + good[10:]  # another length
        case 6:
            sent = good + commands(random)
        case _:
            sent = good
    cut = random.randrange(len(sent) + 1)
    return [begin, sent[:cut], sent[cut:]] if random.random() < 0.5 else [begin + sent]


def wrote(frames: list[Frame]) -> bool:
    """Whether an answer says that something was changed."""
    for frame in frames:
        if frame.type == FrameType.DOWNLOAD_ENDED:
            return True
        if frame.type == FrameType.ANSWERS and any(
            (asked.target, asked.command) in WRITING and reply.status == 0
            for asked, reply in read_replies(frame.body)
        ):
            return True
    return False


def attack(bench: Bench, pieces: list[bytes]) -> bool:
    """Send pieces in a session of its own; return whether something may have been changed."""
    session, reader, changed = Session(bench.control), FrameReader(), False
    for piece in pieces:
        sent = session.receive(piece)
        turns = 0
        while True:
            assert len(sent) <= 1 << 18
            frames = list(reader.feed(sent))
            assert reader.pending == 0
            assert all(frame.version == bench.version for frame in frames)
            changed |= wrote(frames)
            if not session.more:
                break
            sent, turns = session.receive(b""), turns + 1
            assert turns < 3000
        assert session.reader.pending <= _MOST_BODY + 10
    session.lost()
    assert bench.control.sessions == {1: 0, 2: 1}
    return changed


def fuzz(count: int, seed: int) -> Iterator[bool]:
    """Attack one control after the other; hold it to its state whenever nothing was written."""
    each = count // len(PROFILES)
    for profile in PROFILES:
        bench = Bench(profile)
        changed_since = False
        for number in range(each):
            chance = random.Random(f"{seed} {profile} {number}")
            pieces = case(chance)
            changed = attack(bench, pieces)
            where = (profile, number, [piece.hex() for piece in pieces])
            changed_since |= changed
            if changed:
                bench.seen = bench.witness.receive(bench.asked)
            elif number % _LOOK_EVERY == 0:
                bench.look(where)
            if number % (each // 25) == 0 or number == each - 1:
                after = bench.state()
                if not changed_since:
                    assert after == bench.before, where
                bench.before, changed_since = after, False
            yield changed


def run(count: int, seed: int) -> None:
    writing = sum(fuzz(count, seed))
    assert count // 1000 < writing < count // 2  # it is no test of refusals alone


def resident_kb() -> int:
    """Return the memory that this process holds now."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() >> 10


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the system does not tell")
def test_memory_does_not_grow_with_wrong_frames() -> None:
    bench, before_kb = Bench("31i"), 0
    for number in range(5_000):
        attack(bench, case(random.Random(f"{SEED} memory {number}")))
        if number == 2_000:
            before_kb = resident_kb()
    assert resident_kb() - before_kb < _MOST_GROWTH_KB


def test_ten_thousand_wrong_frames() -> None:
    run(ORDINARY, SEED)


@pytest.mark.long
@pytest.mark.timeout(0)
def test_a_million_wrong_frames() -> None:
    run(LONG, SEED + 1)
