"""Captured bytes explained: every byte once, in its place, from hex and from files of packets."""

from __future__ import annotations

import io
import random
import re
import socket
import struct
from collections.abc import Iterator

import pytest

from polycnc.controllers.fanuc.wire import PMC, Frame, FrameType, Request, Value8, status_body, write_requests
from polycnc.errors import UsageError
from polycnc.servers.focas import PROFILES, Dissector, dissect, explain_capture, from_hex
from support.focas_scenes import SCENES, open_session, scene_control

_LINE = re.compile(r"  ([0-9a-f]{4})  ((?:[0-9a-f]{2} ?)+)")


def talk(profile: str = "31i") -> Iterator[tuple[bytes, bytes]]:
    """Yield requests and replies of every scene."""
    session, opened = open_session(scene_control(profile))
    yield bytes(Frame(FrameType.OPEN, b"\0\2")), bytes(opened)
    for _, requests in SCENES:
        sent = bytes(Frame(FrameType.COMMANDS, write_requests(requests)))
        yield sent, session.receive(sent)


def shown_bytes(lines: list[str]) -> bytes:
    """Return the bytes that an explanation shows, which has to show them in order."""
    made = b""
    for line in lines:
        found = _LINE.match(line)
        if found is None:
            assert not line.startswith(" "), line
            continue
        data = bytes.fromhex(line[8:55])
        made += data
    return made


@pytest.mark.parametrize("profile", PROFILES)
def test_every_byte_is_shown_once_and_in_its_place(profile: str) -> None:
    whole = b"".join(asked + answered for asked, answered in talk(profile))
    lines = list(dissect(whole))
    assert shown_bytes(lines) == whole
    at = 0
    for line in lines:
        found = _LINE.match(line)
        if found is None:
            at = 0
            continue
        assert int(found[1], 16) == at
        at += len(bytes.fromhex(line[8:55]))


def test_fields_have_names_and_values() -> None:
    asked = [
        Request(0x26, (4, -1, 0, 0)),
        Request(0x8001, (100, 103, 9, 1), target=PMC),
        Request(0x16, (500, 500, 0, 0), bytes(Value8(-2625, 3))),
        Request(0x7777),
    ]
    text = "\n".join(dissect(bytes(Frame(FrameType.COMMANDS, write_requests(asked)))))
    for line in (
        "  0004  00 01                                            version 1: client",
        "  0006  21 01                                            type COMMANDS",
        "  0012  00 26                                            command 0x26 cnc_rdposition",
        "  0014  00 00 00 04                                      kind 4",
        "  0018  ff ff ff ff                                      axis -1: all",
        "  0038  00 00 00 09                                      area 9: D",
        "  0060  ff ff f5 bf 00 0a 00 03                          value -2.625",
        "  006e  77 77                                            command 0x7777 : unknown",
    ):
        assert line in text


def test_replies_are_read_with_their_requests() -> None:
    dissector = Dissector()
    session, _ = open_session(scene_control("31i"))
    asked = bytes(
        Frame(
            FrameType.COMMANDS,
            write_requests([Request(0x23, (-1, 10, 1, 32)), Request(0x8001, (100, 103, 9, 1), target=PMC)]),
        )
    )
    list(dissect(asked, dissector))
    text = "\n".join(dissect(session.receive(asked), dissector))
    assert "text (1) 'DOOR OPEN'" in text
    assert "axis (2) 2" in text
    assert "D100 = 13330" in text  # 3412 in hex: the low byte lies first in the PMC
    assert "D102 = 30806" in text


def test_status_frames_say_what_their_code_is() -> None:
    text = "\n".join(dissect(bytes(Frame(FrameType.DOWNLOAD_END_STATUS, status_body(5, 4, 815), 3))))
    assert "code 5 EW_DATA" in text
    assert "detail 4" in text
    assert "data number 815" in text


def test_what_is_no_frame_or_not_whole_is_said() -> None:
    frame = bytes(Frame(FrameType.CLOSE))
    lines = list(dissect(b"GET /" + frame + frame[:7]))
    assert lines[0].startswith("no frame at 0: a frame begins with 47 45 54 20")
    assert lines[1] == "  0000  47 45 54 20 2f                                   unknown"
    assert lines[2] == "frame at 5, client: CLOSE"
    assert lines[-2] == "unfinished frame at 15: 7 bytes"
    assert shown_bytes(lines) == b"GET /" + frame + frame[:7]


def test_random_bytes_and_bent_frames_are_explained_without_losing_any() -> None:
    whole = [part for pair in talk() for part in pair]
    chance = random.Random(8193)
    for _ in range(400):
        data = bytearray(b"".join(chance.choice(whole) for _ in range(chance.randrange(1, 3))))
        for _ in range(chance.randrange(0, 6)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        cut = bytes(data[: chance.randrange(len(data) + 1)])
        assert shown_bytes(list(dissect(cut))) == cut


# ---------------------------------------------------------------------- files


def test_hex_may_have_offsets_notes_and_sides() -> None:
    text = """
    # a note
    0000: a0 a0 A0a0 [sync] 00 01
    > 0x02,0x01 <close>   00 00   ; that was it
    """
    assert from_hex(text.encode()) == bytes(Frame(FrameType.CLOSE))


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"a0 a0\nxy a0", "talk.hex:2: 'xy' is no byte in hex"),
        (b"a0 a", "'a' is no byte"),
        (b"\xff\xfe", "neither hex"),
    ],
)
def test_what_is_no_hex_is_refused(data: bytes, said: str) -> None:
    with pytest.raises(UsageError, match=re.escape(said)):
        list(explain_capture(data, "talk.hex"))


def packets(kind: str) -> bytes:
    """Return a captured talk: a segment twice, two in the wrong order, a frame cut in two, and other traffic."""
    dpkt = pytest.importorskip("dpkt")
    (opened, accepted), (system, told) = list(talk())[:2]
    client, control, other = ("127.0.0.1", 50000), ("127.0.0.1", 8193), ("127.0.0.1", 80)
    made = [
        (client, control, 0xFFFFFFF0, b"", dpkt.tcp.TH_SYN),
        (control, client, 7, b"", dpkt.tcp.TH_SYN | dpkt.tcp.TH_ACK),
        (client, control, 0xFFFFFFF1, opened, 0),
        (client, control, 0xFFFFFFF1, opened, 0),
        (other, client, 5, b"HTTP/1.0 200\r\n\r\n", 0),
        (control, client, 8 + 100, accepted[100:], 0),
        (control, client, 8, accepted[:100], 0),
        (client, control, 0xFFFFFFF1 + len(opened), system[:9], 0),
        (client, control, 0xFFFFFFF1 + len(opened) + 9, system[9:], 0),
        (control, client, 8 + len(accepted), told, 0),
    ]
    file = io.BytesIO()
    writer = (dpkt.pcap if kind == "pcap" else dpkt.pcapng).Writer(file)
    for (source, port), (target, to), sequence, data, flags in made:
        tcp = dpkt.tcp.TCP(
            sport=port, dport=to, seq=sequence & 0xFFFFFFFF, flags=flags or dpkt.tcp.TH_ACK, data=data
        )
        ip = dpkt.ip.IP(src=socket.inet_aton(source), dst=socket.inet_aton(target), p=6, data=tcp)
        ip.len = len(ip)
        writer.writepkt(bytes(dpkt.ethernet.Ethernet(data=ip, type=0x0800)), ts=1.0)
    return file.getvalue()


@pytest.mark.parametrize("kind", ["pcap", "pcapng"])
def test_packets_are_put_in_order(kind: str) -> None:
    lines = list(explain_capture(packets(kind), "talk.pcap"))
    assert lines[0] == "connection of 127.0.0.1:50000 to 127.0.0.1:8193"
    assert [line for line in lines if line.startswith("frame")] == [
        "frame at 0, client: OPEN",
        "frame at 0, control: OPENED",
        "frame at 12, client: COMMANDS",
        "frame at 370, control: ANSWERS",
    ]
    assert any(line.endswith("series 'G402'") for line in lines)


def test_a_file_of_packets_that_breaks_off_is_explained_as_far_as_it_goes() -> None:
    whole = packets("pcap")
    lines = list(explain_capture(whole[:-30], "talk.pcap"))
    assert "frame at 12, client: COMMANDS" in lines
    assert list(explain_capture(whole[:24], "talk.pcap")) == ["no connection to port 8193"]
    for size in range(4, 400, 7):
        list(explain_capture(whole[:size], "talk.pcap"))
    assert list(explain_capture(whole, "talk.pcap", port=9999)) == ["no connection to port 9999"]
    assert struct.pack("<I", 0xA1B2C3D4) == whole[:4]
