"""The door `calls` without sockets: hello, frames cut anywhere, doubled, too long, garbage; nothing half done."""

from __future__ import annotations

import ctypes
import json
import random
import struct
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.clib import FWLIB
from polycnc.controllers.library.clib import Call, Slot, Way, alike, length_in
from polycnc.errors import UsageError
from polycnc.servers.calls import LIBRARIES, CallClient, Caller, Trace, replay
from polycnc.servers.process import KINDS, Machinery
from support.often import share

NUMBERS = {each.function.name: each.number for each in FWLIB.calls}
WELCOME = b"PNCCALL1" + struct.pack("<i", 0)


def hello(
    name: bytes = b"fwlib32", table: bytes = FWLIB.table_hash, pointer: int = 8, packing: int = 0
) -> bytes:
    return b"PNCCALL1" + bytes([pointer, packing, 0, 0]) + struct.pack("<16s16s16s", name, b"7.5", table)


def frame(name: str, packed: bytes, serial: int = 513) -> bytes:
    return struct.pack("<IHH", 4 + len(packed), NUMBERS[name], serial) + packed


OPEN = frame("cnc_allclibhndl", struct.pack("<I", 2), 21)
WRITE = frame("cnc_wrmacro", struct.pack("<HhhiH", 1, 103, 10, 31415, 3), 22)
READ = frame("cnc_rdmacro", struct.pack("<HhhI", 1, 103, 10, 10), 23)


class Rig:
    """A control, and a client of it."""

    def __init__(self, **more: object) -> None:
        self.device = PowerMate(3)
        self.told: list[str] = []
        self.client = self.another(**more)

    def another(self, **more: object) -> CallClient:
        return CallClient(self.find, self.told.append, **more)  # type: ignore[arg-type]

    def find(self, name: str, packing: int) -> Caller | None:
        if name != "fwlib32":
            return None
        return LIBRARIES["fanuc"].make(FWLIB.packed(packing) or FWLIB, [self.device], None)


def answers(sent: bytes) -> list[tuple[int, int, bytes]]:
    """Return serial, code and outputs of each answer."""
    found = []
    while sent:
        size, _, serial, _, code = struct.unpack_from("<IHHIq", sent)
        found.append((serial, code, sent[20 : 4 + size]))
        sent = sent[4 + size :]
    return found


def test_a_whole_talk() -> None:
    rig = Rig()
    assert rig.client.receive(hello()) == WELCOME
    sent = answers(rig.client.receive(OPEN + WRITE + READ))
    assert sent == [
        (21, 0, struct.pack("<IH", 2, 1)),
        (22, 0, b""),
        (23, 0, struct.pack("<Ihhih", 10, 103, 0, 31415, 3)),
    ]


@cache
def shared() -> Rig:
    """Return a rig for what its clients do anew."""
    return Rig()


@settings(max_examples=25)
@given(cuts=st.lists(st.integers(1, 150), max_size=8))
def test_bytes_may_be_cut_anywhere(cuts: list[int]) -> None:
    client = shared().another()
    talk, sent = hello() + OPEN + WRITE + READ, b""
    places = [0, *sorted({cut % len(talk) for cut in cuts}), len(talk)]
    for first, last in pairwise(places):
        sent += client.receive(talk[first:last])
    assert sent == shared().another().receive(talk)


def test_a_doubled_frame_is_a_second_call() -> None:
    rig = Rig()
    rig.client.receive(hello())
    assert [code for _, code, _ in answers(rig.client.receive(OPEN + OPEN))] == [0, 0]
    assert not rig.client.ended


@pytest.mark.parametrize(
    ("said", "answer", "told"),
    [
        (hello(table=bytes(16)), fwlib.EW_VERSION, "fwlib32 7.5 has another table of functions"),
        (hello(packing=2), fwlib.EW_VERSION, "fwlib32 packs structures to 2 bytes"),
        (hello(packing=4), fwlib.EW_VERSION, "fwlib32 7.5 has another table of functions"),
        (hello(name=b"mcug7"), None, "no machine here has the library mcug7"),
        (hello(pointer=2), None, "a client that does not say hello"),
        (b"GET / HTTP/1.1\r\n", None, "a client that does not say hello"),
        (b"\xa0\xa0\xa0\xa0\0\1\1\1\0\2\0\2", None, "a client that does not say hello"),
    ],
)
def test_a_hello_that_is_refused(said: bytes, answer: int | None, told: str) -> None:
    rig = Rig()
    sent = rig.client.receive(said)
    assert sent == (b"" if answer is None else b"PNCCALL1" + struct.pack("<i", answer))
    assert rig.client.ended
    assert rig.told[0].startswith(told)
    assert rig.client.receive(OPEN) == b""


@pytest.mark.parametrize(
    "bad",
    [
        struct.pack("<I", 3) + b"abc",
        struct.pack("<I", 66557) + b"abcd",
        struct.pack("<I", 0xFFFFFFFF),
        struct.pack("<IHH", 4, 0, 1),
        struct.pack("<IHH", 4, 97, 1),
        frame("cnc_wrmacro", struct.pack("<HhhiH", 1, 103, 10, 31415, 3)[:-1]),
        frame("cnc_wrmacro", struct.pack("<HhhiHb", 1, 103, 10, 31415, 3, 0)),
        frame("cnc_wrmacror", struct.pack("<HhI", 1, 12, 0x7FFFFFFF) + bytes(12)),
    ],
)
def test_a_bad_frame_ends_the_connection_and_does_nothing(bad: bytes) -> None:
    rig = Rig()
    rig.client.receive(hello() + OPEN)
    before = rig.device.snapshot()
    assert rig.client.receive(bad + WRITE) == b""
    assert rig.client.ended
    assert len(rig.told) == 1
    assert rig.device.snapshot() == before


def test_room_is_never_exceeded_and_a_refused_call_writes_nothing() -> None:
    rig = Rig()
    rig.client.receive(hello() + OPEN + WRITE)
    small = frame("cnc_rdmacro", struct.pack("<HhhI", 1, 103, 10, 6))
    assert answers(rig.client.receive(small)) == [(513, 0, struct.pack("<Ihhh", 6, 103, 0, 31415))]
    refused = frame("cnc_rdmacro", struct.pack("<HhhI", 1, 103, 9, 10))
    assert answers(rig.client.receive(refused)) == [(513, fwlib.EW_LENGTH, struct.pack("<I", 0))]
    null = frame("cnc_rdmacro", struct.pack("<HhhI", 1, 103, 10, 0xFFFFFFFF))
    assert answers(rig.client.receive(null)) == [(513, fwlib.EW_DATA, struct.pack("<I", 0))]


PACKED = FWLIB.packed(4)


def _packed_rig() -> Rig:
    assert PACKED is not None
    rig = Rig()
    rig.client.receive(hello(table=PACKED.table_hash, packing=4) + OPEN)
    assert not rig.client.ended
    return rig


def test_structures_of_4_bytes_lie_as_later_headers_have_them() -> None:
    rig = _packed_rig()
    for number, value in ((500, 31415), (501, -27182)):
        rig.client.receive(frame("cnc_wrmacro", struct.pack("<HhhiH", 1, number, 10, value, number % 7)))
    read = struct.pack("<HhhhI", 1, 500, 501, 8 + 8 * 2, 8 + 8 * 2)
    expected = struct.pack("<hhhxxihxxihxx", 500, 0, 501, 31415, 500 % 7, -27182, 501 % 7)
    ((_, code, outputs),) = answers(rig.client.receive(frame("cnc_rdmacror", read)))
    assert (code, outputs) == (0, struct.pack("<I", 24) + expected)
    short = struct.pack("<HhhhI", 1, 500, 501, 8 + 8 * 2 - 3, 24)
    ((_, code, outputs),) = answers(rig.client.receive(frame("cnc_rdmacror", short)))
    assert (code, outputs) == (fwlib.EW_LENGTH, struct.pack("<I", 0))


def test_a_range_of_4_bytes_is_written_whole_or_not_at_all() -> None:
    rig = _packed_rig()
    content = struct.pack("<hhhxxihxxihxx", 500, 0, 501, 1234, 1, -5678, 2)

    def write(length: int) -> int:
        there = content[: max(0, length)]
        packed = struct.pack("<HhI", 1, length, len(there)) + there
        return answers(rig.client.receive(frame("cnc_wrmacror", packed)))[0][1]

    def read() -> list[tuple[int, int]]:
        found = []
        for number in (500, 501):
            asked = frame("cnc_rdmacro", struct.pack("<HhhI", 1, number, 12, 12))
            outputs = answers(rig.client.receive(asked))[0][2]
            found.append(struct.unpack_from("<ih", outputs, 8))
        return found

    before = read()
    assert [write(length) for length in (21, 16, 15, 8, 0, -1)] == [fwlib.EW_LENGTH] * 6
    assert read() == before
    assert write(24) == 0
    assert read() == [(1234, 1), (-5678, 2)]


def test_modal_data_and_dynamic_data_of_4_bytes_are_those_of_the_manual() -> None:
    rig = _packed_rig()
    twin = rig.another()
    twin.receive(hello() + OPEN)
    for kind, form, packed in (
        (-1, "35s", "35s"),
        (-2, "ibb" * 27, "ibbxx" * 27),
        (-3, "ibb" * 6, "ibbxx" * 6),
    ):
        asked = [frame("cnc_modal", struct.pack("<HhhI", 1, kind, 0, size)) for size in (220, 166)]
        one, two = (
            answers(each.receive(said))[0] for each, said in zip((rig.client, twin), asked, strict=True)
        )
        assert one[1] == two[1] == 0
        assert struct.unpack_from("<hh" + packed, one[2], 4) == struct.unpack_from("<hh" + form, two[2], 4)
    dynamic = [struct.pack("<HhhI", 1, -1, size, size) for size in (120, 118)]
    one = answers(rig.client.receive(frame("cnc_rddynamic", dynamic[0])))[0]
    two = answers(twin.receive(frame("cnc_rddynamic", dynamic[1])))[0]
    assert one[1] == two[1] == 0
    assert struct.unpack_from("<5hxx27i", one[2], 4) == struct.unpack_from("<5h27i", two[2], 4)


def test_what_is_written_several_times_lies_alike_in_both_packings() -> None:
    assert PACKED is not None
    for call, other in zip(FWLIB.calls, PACKED.calls, strict=True):
        for slot, packed in zip(call.slots, other.slots, strict=True):
            several = slot.way is Way.RECORDS or (slot.way is Way.MEMORY and slot.writes)
            if several and hasattr(slot.element, "_table_"):
                assert alike(packed.element, slot.element), f"{call.function.name}: {slot.argument.name}"


@settings(max_examples=share(200))
@given(st.sampled_from(sorted(FWLIB.classes)), st.integers(0, 500))
def test_a_length_in_another_packing_grows_with_it_and_is_whole_where_the_structure_is(
    name: str, length: int
) -> None:
    assert PACKED is not None
    packed, cls = PACKED.classes[name], FWLIB.classes[name]
    assert 0 <= length_in(packed, cls, length) <= length_in(packed, cls, length + 1)
    whole = ctypes.sizeof(packed)
    assert length_in(packed, cls, whole) == ctypes.sizeof(cls)
    assert length_in(packed, cls, whole + length) == ctypes.sizeof(cls) + length
    assert length_in(packed, cls, min(length, whole)) <= min(length, ctypes.sizeof(cls))


def _garbage(seed: int, rounds: int) -> None:
    rig, dice = Rig(), random.Random(seed)
    talk = hello() + OPEN + WRITE + READ
    for _ in range(rounds):
        client = rig.another()
        bad = bytearray(talk)
        for _ in range(dice.randrange(1, 9)):
            bad[dice.randrange(len(bad))] = dice.randrange(256)
        cut = dice.randrange(1, len(bad) + 1)
        client.receive(bytes(bad[:cut]))
        client.receive(dice.randbytes(dice.randrange(90)))
        if client.caller is not None:
            client.caller.session.detach()
    rig.client.receive(hello() + OPEN)
    assert [code for _, code, _ in answers(rig.client.receive(WRITE + READ))] == [0, 0]


def test_garbage_harms_nobody() -> None:
    _garbage(5, 150)


@pytest.mark.long
def test_much_garbage_harms_nobody() -> None:
    _garbage(6, 20_000)


SIZES = (0, 1, 2, 3, 4, 7, 8, 11, 12, 65532, 65533, 0x7FFFFFFF, 0xFFFFFFFF)


def _argument(slot: Slot, dice: random.Random) -> Iterator[bytes]:
    if slot.way is Way.VALUE:
        yield bytes(slot.element(dice.choice((0, 1, 2, -1, 3, 16, 103, 32767))))
        return
    if slot.reads:
        size = dice.choice((0, 1, 2, 4, 10, 16, 64))
        yield dice.choice((struct.pack("<I", size) + dice.randbytes(size), b"\xff" * 4))
    if slot.writes:
        yield struct.pack("<I", dice.choice((0, 4, 10, 16, 64, 0xFFFFFFFF)))


def _frame(dice: random.Random) -> bytes:
    """Return a frame, of any call, good or bad in one or some places, or a frame and a piece of one."""
    call = dice.choice(FWLIB.calls)
    packed = b"".join(part for slot in call.slots for part in _argument(slot, dice))
    made = bytearray(struct.pack("<IHH", 4 + len(packed), call.number, 513) + packed)
    way = dice.random()
    if way < 0.3:
        made[dice.randrange(len(made))] ^= 1 << dice.randrange(8)
    elif way < 0.4:
        made[:4] = struct.pack("<I", dice.choice(SIZES))
    elif way < 0.5:
        made += dice.randbytes(dice.randrange(1, 30))
    elif way < 0.55:
        made = bytearray(dice.randbytes(dice.randrange(1, 80)))
    return bytes(made)


def _frames(seed: int, count: int) -> None:
    """Send frames to clients of one session: each is answered or ends its connection, and the machine stays whole."""
    rig, dice = Rig(), random.Random(seed)
    rig.client.receive(hello() + OPEN)
    caller = rig.client.caller
    client, answered, refused = rig.client, 0, 0
    for _ in range(count):
        data = _frame(dice)
        cut = dice.randrange(len(data) + 1)
        sent = client.receive(data[:cut]) + client.receive(data[cut:])
        assert len(sent) < 4 or struct.unpack_from("<I", sent)[0] + 4 <= len(sent)
        answered += bool(sent)
        if client.ended:
            assert rig.told
            refused += 1
            rig.told.clear()
        if client.ended or not sent:  # some wait for the rest of what their frame says it has
            client = rig.another()
            client.caller = caller
    assert answered > count // 4
    assert refused > count // 20
    again = rig.another()
    again.receive(hello() + OPEN)
    assert [code for _, code, _ in answers(again.receive(WRITE + READ))] == [0, 0]


def test_10_000_frames() -> None:
    _frames(7, 10_000)


@pytest.mark.long
def test_a_million_frames() -> None:
    _frames(8, 1_000_000)


def test_calls_are_traced(tmp_path: Path) -> None:
    trace = Trace(tmp_path / "calls.jsonl")
    rig = Rig(trace=trace, now_s=lambda: 2.5)
    rig.client.receive(hello() + OPEN + WRITE + READ)
    trace.close()
    lines = [json.loads(line) for line in (tmp_path / "calls.jsonl").read_text().splitlines()]
    assert lines[1] == {
        "time_s": 2.5, "client": 1, "call": "cnc_wrmacro", "code": 0, "out": {},
        "in": {"FlibHndl": 1, "number": 103, "length": 10, "mcr_val": 31415, "dec_val": 3},
    }  # fmt: skip
    assert lines[2]["out"] == {"macro": struct.pack("<hhih", 103, 0, 31415, 3).hex()}


_OPENING = {
    "fanuc": [("cnc_allclibhndl", struct.pack("<I", 2))],
    "imc": [("IMC_Open", struct.pack("<Iii", 4, 0, 0))],
    "apci": [("InitMcuSystem", struct.pack("<I3744xI", 3744, 3744))],
}


@pytest.mark.parametrize("kind", LIBRARIES)
def test_calls_are_answered_alike_with_and_without_a_trace(kind: str, tmp_path: Path) -> None:
    """Without one, calls that read through no pointer are carried out in a shorter way."""
    library, dice = LIBRARIES[kind].load(), random.Random(11)
    trace = Trace(tmp_path / "calls.jsonl")
    clients = []
    for each in (None, trace):
        device = KINDS[kind](Machinery()).device
        client = CallClient(
            lambda *_, device=device: LIBRARIES[kind].make(library, [device], None), trace=each
        )  # fmt: skip
        assert client.receive(hello(library.name.encode(), library.table_hash)) == WELCOME
        clients.append(client)
    by_name = {each.function.name: each.number for each in library.calls}
    for name, packed in _OPENING[kind]:
        asked = struct.pack("<IHH", 4 + len(packed), by_name[name], 7) + packed
        assert clients[0].receive(asked) == clients[1].receive(asked)
    codes = set()
    for call in [each for each in library.calls for _ in range(4)]:
        packed = b"".join(part for slot in call.slots for part in _argument(slot, dice))
        if library.through and slot_is_handle(call) and dice.random() < 0.9:
            packed = struct.pack("<H", 1) + packed[2:]
        asked = struct.pack("<IHH", 4 + len(packed), call.number, 513) + packed
        plain, traced = (each.receive(asked) for each in clients)
        assert plain == traced, call.function.prototype
        codes |= {code for _, code, _ in answers(plain)}
    trace.close()
    caller = clients[0].caller
    assert caller is not None
    assert len(caller.quick) > len(library.calls) // 4
    assert len(codes) > 3


def _replayed(path: Path) -> list[tuple[str, bool]]:
    device = PowerMate(3)
    found = replay(path, device, lambda: LIBRARIES["fanuc"].make(FWLIB, [device], None))
    return [(each.call, each.is_equal) for each in found]


def test_a_trace_is_carried_out_once_more_with_the_same_answers(tmp_path: Path) -> None:
    path, dice = tmp_path / "calls.jsonl", random.Random(9)
    trace = Trace(path)
    rig = Rig(trace=trace)
    clock = rig.device.clock
    clients = [rig.another(trace=trace, now_s=lambda: clock.now_s) for _ in range(2)]
    for each in clients:
        each.receive(hello() + OPEN)
    for number in range(400):
        client = dice.choice(clients)
        call = dice.choice(FWLIB.calls)
        packed = b"".join(part for slot in call.slots for part in _argument(slot, dice))
        if slot_is_handle(call):
            packed = struct.pack("<H", 1) + packed[2:]
        client.receive(struct.pack("<IHH", 4 + len(packed), call.number, 513) + packed)
        rig.device.advance(number % 7)
    trace.close()
    told = _replayed(path)
    assert len(told) > 350
    assert [name for name, equal in told if not equal] == []
    lines = path.read_text().splitlines(keepends=True)
    at = next(k for k, line in enumerate(lines) if '"code": 0' in line and '"call": "cnc_sysinfo"' in line)
    lines[at] = lines[at].replace('"code": 0', '"code": 3')
    path.write_text("".join(lines))
    assert [k for k, (_, equal) in enumerate(_replayed(path)) if not equal] == [at]


def slot_is_handle(call: Call) -> bool:
    return bool(call.slots) and call.slots[0].argument.name == "FlibHndl" and call.slots[0].way is Way.VALUE


GOOD = (
    '{"time_s": 0.0, "client": 1, "call": "cnc_allclibhndl", "in": {}, "room": {"FlibHndl": 2}, "code": 0, '
    '"out": {"FlibHndl": 1}}'
)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("{", "no line of a trace"),
        ("[]", "no line of a trace"),
        ("7", "no line of a trace"),
        (GOOD.replace('"cnc_allclibhndl"', '"rdap"'), "fwlib32 has no function 'rdap'"),
        (GOOD.replace('"FlibHndl": 2', '"FlibHndl": -2'), "no line of a trace: room for FlibHndl"),
        (GOOD.replace('"FlibHndl": 2', '"FlibHndl": 70000'), "no line of a trace: room for FlibHndl"),
        (GOOD.replace("0.0", "NaN"), "the time nan s is before"),
        (GOOD.replace("0.0", "1e300"), "the time 1e\\+300 s is before"),
        (GOOD.replace("0.0", "-1"), "the time -1 s is before"),
        (
            GOOD.replace("cnc_allclibhndl", "cnc_sysinfo").replace('"in": {}', '"in": {"FlibHndl": "x"}'),
            "no line",
        ),
        ("x" * (1 << 20), "a line of more than"),
    ],
)
def test_a_line_that_is_none_of_a_trace_is_refused_with_its_place(
    line: str, told: str, tmp_path: Path
) -> None:
    path = tmp_path / "calls.jsonl"
    path.write_text(f"{GOOD}\n\n{line}\n")
    with pytest.raises(UsageError, match=f":3: .*{told}|:3: {told}"):
        list(replay(path, shared().device, lambda: LIBRARIES["fanuc"].make(FWLIB, [shared().device], None)))


def test_a_trace_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot be read"):
        _replayed(tmp_path / "missing.jsonl")
    (tmp_path / "bytes.jsonl").write_bytes(b"\xff\xfe\x80")
    with pytest.raises(UsageError, match="it is no text"):
        _replayed(tmp_path / "bytes.jsonl")


def test_a_trace_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot be written"):
        Trace(tmp_path / "missing" / "calls.jsonl")
