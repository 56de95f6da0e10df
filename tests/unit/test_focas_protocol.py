"""Frames, blocks, numbers and sessions of the FOCAS protocol, byte for byte, without sockets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc.controllers.fanuc.wire import (
    PMC,
    VACANT,
    Frame,
    FrameReader,
    FrameType,
    Reply,
    Request,
    Value8,
    read_replies,
    read_requests,
    read_status,
    status_body,
    text,
    write_replies,
    write_requests,
)
from polycnc.errors import ProtocolError
from polycnc.servers.focas import TRANSITIONS, Ending, Plan, Session, State, Status

OPEN_TRANSFER, OPEN_COMMAND = (bytes(Frame(FrameType.OPEN, bytes((0, n)))) for n in (1, 2))
CLOSE = bytes(Frame(FrameType.CLOSE))


@dataclass
class Control:
    """A control that notes what it is asked."""

    version: int = 3
    sessions: int = 0
    taken: bytearray = field(default_factory=bytearray)
    aborted: int = 0
    end_status: Status = field(default_factory=Status)

    def open_session(self, channel: int) -> Status:
        if self.sessions == 2:
            return Status(2)
        self.sessions += 1
        return Status()

    def close_session(self, channel: int) -> None:
        self.sessions -= 1

    def opening(self) -> bytes:
        return b"\x11" * 360

    def answer(self, requests: Sequence[Request], plan: Plan) -> list[Reply] | Status:
        if any(request.command == 0x15 for request in requests):
            return Status(-17, 1)
        return [Reply(bytes([request.command] * 3), -(request.command == 0x25)) for request in requests]

    def plan(self) -> Plan:
        return Plan()

    def download_start(self, name: str) -> Status:
        return Status(5, 1) if name == "N:bad" else Status()

    def download(self, text: bytes) -> None:
        self.taken += text

    def download_end(self, *, aborted: bool = False) -> Status:
        self.aborted += aborted
        return self.end_status

    def upload(self, name: str) -> Status | bytes:
        return b"\nO0100\n" + b"G4P1\n" * 300 + b"%" if name == "O0100-O0100" else Status(5)


def frames(data: bytes) -> list[Frame]:
    return list(FrameReader().feed(data))


def transfer(kind: FrameType, name: str) -> bytes:
    return bytes(Frame(kind, bytes((0, 0, 0, 1)) + name.encode().ljust(512, b"\0")))


def test_a_frame_is_a_header_of_ten_bytes_and_a_body() -> None:
    refused = Frame(FrameType.OPEN_REFUSED, status_body(2), 3)
    assert bytes(refused).hex() == "a0a0a0a00003010300080000000200000000"
    assert frames(bytes(refused)) == [refused]
    assert read_status(refused.body) == (2, 0, 0)
    assert read_status(bytes.fromhex("0000ffef00010000")) == (-17, 1, 0)
    assert (refused.name, Frame(0x7777).name) == ("OPEN_REFUSED", "0x7777")


def test_a_command_is_28_bytes_and_its_data() -> None:
    write = Request(0x16, (500, 500, 0, 0), bytes(Value8.of(3.25, 4)))
    assert write_requests([write]).hex() == (
        "00010024000100010016000001f4000001f400000000000000000000000800007ef4000a0004"
    )
    asked = [write, Request(0x8001, (12, 12, 0, -1), target=PMC, path=2)]
    assert read_requests(write_requests(asked)) == asked
    replies = [Reply(b"\x01\x02\x03", 6, 4, 5), Reply()]
    assert write_replies(asked, replies)[2:21].hex() == "00130001000100160006000400050003010203"
    assert [reply for _, reply in read_replies(write_replies(asked, replies))] == replies


@pytest.mark.parametrize(
    ("value", "decimals", "wire"),
    [
        (-26.559, 3, "ffff9841000a0003"),
        (25.0, 7, "0ee6b280000a0007"),
        (3000000.25, 4, "11e1a319000a0002"),  # four decimals do not fit: two do
        (-9e99, 3, "80000000000a0000"),
        (None, 3, "00000000ffffffff"),
    ],
)
def test_numbers(value: float | None, decimals: int, wire: str) -> None:
    packed = Value8.of(value, decimals)
    assert bytes(packed).hex() == wire
    assert Value8.from_wire(bytes.fromhex(wire)) == packed
    if value is not None and abs(value) < 1e9:
        assert packed.number == pytest.approx(value, abs=10.0**-packed.exponent)


def test_numbers_that_are_none() -> None:
    assert VACANT.number is None
    assert Value8.from_wire(bytes.fromhex("0000000500020002")).number == 1.25
    for wire in ("00000001000b0002", "00000001000a7fff", "000001"):
        with pytest.raises(ProtocolError):
            Value8.from_wire(bytes.fromhex(wire))


def test_texts_are_cut_and_padded() -> None:
    assert (text("D4F6", 4), text("31", 4), text("O\u00e9X", 3), text("ABCDE", 2)) == (
        b"D4F6",
        b"31\0\0",
        b"O?X",
        b"AB",
    )


@given(st.data())
def test_frames_come_whole_however_the_stream_is_cut(data: st.DataObject) -> None:
    sent = [
        Frame(FrameType.COMMANDS, bytes(n), 1) for n in data.draw(st.lists(st.integers(0, 40), min_size=1))
    ]
    stream, reader = b"".join(map(bytes, sent)), FrameReader()
    got: list[Frame] = []
    while stream:
        cut = data.draw(st.integers(1, len(stream)))
        got += reader.feed(stream[:cut])
        stream = stream[cut:]
    assert got == sent
    assert reader.pending == 0


@pytest.mark.parametrize(
    "data", [b"GET / HTTP/1.1\r\n\r\n", b"\xa0\xa0\xa1", b"\xa0\xa0\xa0\xa0\0\1\x21\1\xff\xff"]
)
def test_what_is_no_frame_or_too_large_is_refused(data: bytes) -> None:
    with pytest.raises(ProtocolError):
        list(FrameReader(most_body=3000).feed(data))


@pytest.mark.parametrize(
    "body",
    [
        "",
        "00",
        "0001",
        "0001001b" + "00" * 25,
        "0002001c" + "00" * 26,
        "0001001c" + "00" * 27,
        "0001001d" + "00" * 27,
    ],
)
def test_blocks_that_do_not_fit_are_refused(body: str) -> None:
    with pytest.raises(ProtocolError):
        read_requests(bytes.fromhex(body))


def test_a_session_of_commands() -> None:
    control = Control()
    session = Session(control)
    (opened,) = frames(session.receive(OPEN_COMMAND))
    assert (opened.type, opened.version, len(opened.body), control.sessions) == (FrameType.OPENED, 3, 360, 1)
    asked = [Request(0x24), Request(0x25)]
    sent = session.receive(bytes(Frame(FrameType.COMMANDS, write_requests(asked))))
    (answer,) = frames(sent)
    assert [reply for _, reply in read_replies(answer.body)] == [Reply(b"$$$"), Reply(b"%%%", -1)]
    (refused,) = frames(session.receive(bytes(Frame(FrameType.COMMANDS, write_requests([Request(0x15)])))))
    assert (refused.type, refused.body.hex()) == (FrameType.COMMANDS_REFUSED, "0000ffef00010000")
    (bad,) = frames(session.receive(bytes(Frame(FrameType.COMMANDS, b"\0\7"))))
    assert (bad.type, read_status(bad.body)) == (FrameType.COMMANDS_REFUSED, (-17, 1, 0))
    assert session.state is State.COMMAND
    assert session.receive(CLOSE).hex() == "a0a0a0a0000302020000"
    assert (session.ending, control.sessions) == (Ending.CLOSE, 0)


def test_one_session_too_many_is_refused_and_counts_nothing() -> None:
    control = Control(sessions=2)
    session = Session(control)
    (refused,) = frames(session.receive(OPEN_COMMAND))
    assert (refused.type, read_status(refused.body), session.ending) == (
        FrameType.OPEN_REFUSED,
        (2, 0, 0),
        Ending.CLOSE,
    )
    session.lost()
    assert control.sessions == 2


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (OPEN_COMMAND, OPEN_COMMAND),
        (OPEN_COMMAND, transfer(FrameType.UPLOAD_START, "O1")),
        (OPEN_TRANSFER, bytes(Frame(FrameType.COMMANDS, write_requests([Request(0x24)])))),
        (OPEN_TRANSFER, bytes(Frame(FrameType.DOWNLOAD_DATA, b"O1"))),
        (bytes(Frame(FrameType.OPEN, b"\0\3")), b""),
        (bytes(Frame(FrameType.COMMANDS, write_requests([]))), b""),
        (b"\0\1\2\3", b""),
    ],
)
def test_a_frame_out_of_order_resets_the_connection(first: bytes, second: bytes) -> None:
    control = Control()
    session = Session(control)
    session.receive(first)
    if second:
        assert session.ending is None
        assert session.receive(second) == b""
    assert (session.ending, session.state, control.sessions) == (Ending.RESET, State.ENDED, 0)


def test_a_program_comes_in_and_data_are_never_answered() -> None:
    control = Control()
    session = Session(control)
    session.receive(OPEN_TRANSFER)
    (refused,) = frames(session.receive(transfer(FrameType.DOWNLOAD_START, "N:bad")))
    assert (refused.type, read_status(refused.body)) == (FrameType.DOWNLOAD_START_STATUS, (5, 1, 0))
    (started,) = frames(session.receive(transfer(FrameType.DOWNLOAD_START, "N:")))
    assert (started.type, started.body) == (FrameType.DOWNLOAD_STARTED, bytes(256))
    assert session.receive(bytes(Frame(FrameType.DOWNLOAD_DATA, b"\nO12\nG1X"))) == b""
    assert session.receive(bytes(Frame(FrameType.DOWNLOAD_DATA, b"7\n%"))) == b""
    control.end_status = Status(5, 4)
    (end,) = frames(session.receive(bytes(Frame(FrameType.DOWNLOAD_END))))
    assert (end.type, end.body.hex()) == (FrameType.DOWNLOAD_END_STATUS, "0000000500040000")
    assert (bytes(control.taken), session.state) == (b"\nO12\nG1X7\n%", State.TRANSFER)


def test_a_connection_lost_in_a_download_drops_it() -> None:
    control = Control()
    session = Session(control)
    session.receive(OPEN_TRANSFER)
    session.receive(transfer(FrameType.DOWNLOAD_START, "N:"))
    session.lost()
    session.lost()
    assert (control.aborted, control.sessions) == (1, 0)


def sent_in_turns(session: Session, data: bytes) -> list[list[Frame]]:
    """Return the frames that leave for `data`, by the turn that they leave in."""
    turns = [frames(session.receive(data))]
    while session.more:
        assert session.pause_s > 0.0
        turns.append(frames(session.receive(b"")))
    assert session.pause_s == 0.0
    return turns


def test_what_comes_while_a_program_goes_out_is_answered_after_it() -> None:
    session = Session(Control())
    session.receive(OPEN_TRANSFER)
    both = transfer(FrameType.UPLOAD_START, "O0100-O0100") + bytes(Frame(FrameType.UPLOAD_ACKNOWLEDGED))
    turns = [frames(session.receive(both)), frames(session.receive(CLOSE))]
    while session.more:
        turns.append(frames(session.receive(b"")))
    names = [[frame.name for frame in turn] for turn in turns]
    assert names == [["UPLOAD_STARTED"], ["UPLOAD_DATA"], ["UPLOAD_DATA"], ["UPLOAD_FINISHED"], ["CLOSED"]]
    assert session.ending is Ending.CLOSE


def test_who_is_lost_while_a_program_goes_out_gets_no_more() -> None:
    control = Control()
    session = Session(control)
    session.receive(OPEN_TRANSFER)
    session.receive(transfer(FrameType.UPLOAD_START, "O0100-O0100"))
    session.lost()
    assert (session.receive(b""), session.more, control.sessions) == (b"", False, 0)


def test_a_program_goes_out_in_pieces() -> None:
    session = Session(Control())
    session.receive(OPEN_TRANSFER)
    (missing,) = frames(session.receive(transfer(FrameType.UPLOAD_START, "O7-O7")))
    assert (missing.type, missing.body.hex()) == (FrameType.UPLOAD_STARTED, "00000005")
    turns = sent_in_turns(session, transfer(FrameType.UPLOAD_START, "O0100-O0100"))
    assert [[frame.name for frame in turn] for turn in turns] == [
        ["UPLOAD_STARTED"],
        ["UPLOAD_DATA"],
        ["UPLOAD_DATA"],
        ["UPLOAD_FINISHED"],
    ]
    sent = [frame for turn in turns for frame in turn]
    assert len(sent[1].body) == 0x500
    assert b"".join(frame.body for frame in sent[1:3]) == b"\nO0100\n" + b"G4P1\n" * 300 + b"%"
    assert session.receive(bytes(Frame(FrameType.UPLOAD_ACKNOWLEDGED))) == b""
    assert session.receive(bytes(Frame(FrameType.UPLOAD_END))).hex() == "a0a0a0a00003190300080000000d00000000"


def test_an_old_series_sends_an_empty_piece_for_a_program_that_is_not_there() -> None:
    session = Session(Control(version=2))
    session.receive(OPEN_TRANSFER)
    missing = [each for (each,) in sent_in_turns(session, transfer(FrameType.UPLOAD_START, "O7-O7"))]
    assert [(each.name, len(each.body)) for each in missing] == [
        ("UPLOAD_STARTED", 513),
        ("UPLOAD_DATA", 0),
        ("UPLOAD_FINISHED", 0),
    ]
    assert session.receive(bytes(Frame(FrameType.UPLOAD_ACKNOWLEDGED))) == b""
    sent = [each for (each,) in sent_in_turns(session, transfer(FrameType.UPLOAD_START, "O0100-O0100"))]
    assert [len(each.body) for each in sent] == [513, 0x500, 228, 0]


def test_every_state_but_the_last_can_be_closed() -> None:
    closing = {row.state for row in TRANSITIONS if row.frame is FrameType.CLOSE}
    assert closing == set(State) - {State.ENDED}


_ANY_FRAME = st.builds(
    lambda kind, body: bytes(Frame(kind, body)), st.integers(0, 0xFFFF), st.binary(max_size=40)
)
_KNOWN = st.sampled_from([OPEN_COMMAND, OPEN_TRANSFER, CLOSE, transfer(FrameType.DOWNLOAD_START, "N:")])


@given(st.lists(st.binary(max_size=60) | _ANY_FRAME | _KNOWN))
def test_whatever_comes_a_session_answers_in_frames_and_counts_right(received: list[bytes]) -> None:
    control = Control()
    session = Session(control)
    for data in received:
        frames(session.receive(data))
        if session.ending:
            break
    session.lost()
    assert control.sessions == 0
    assert session.receive(OPEN_COMMAND) == b""
