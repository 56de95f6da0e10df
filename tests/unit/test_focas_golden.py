"""What the server answers, byte for byte: golden files of every series, sizes and orders of real controls."""

from __future__ import annotations

import functools

import pytest

from polycnc.controllers.fanuc.wire import (
    LAYOUTS,
    Frame,
    FrameReader,
    FrameType,
    Reply,
    Request,
    read_replies,
    read_requests,
    write_requests,
)
from polycnc.servers.focas import COMMANDS, PROFILES, WRITING, Session, from_hex, load_profile
from support.focas_scenes import ALL, GOLDEN, SCENES, open_session, path, r, render, scene_control


@pytest.mark.parametrize("profile", PROFILES)
def test_every_answer_is_that_of_the_golden_file(profile: str) -> None:
    assert render(profile) == (GOLDEN / f"{profile}.txt").read_text(encoding="utf-8")


def test_the_golden_files_ask_for_every_command() -> None:
    asked = {(each.target, each.command) for _, requests in SCENES for each in requests}
    acting = {(1, code) for code in (0x01, 0x03, 0x05, 0x46, 0x52, 0xB5, 0xB6, 0xBA)}  # in other tests
    assert asked >= set(COMMANDS) - acting - {(1, 0xA8)}
    assert set(COMMANDS) <= set(LAYOUTS)
    assert set(COMMANDS) >= WRITING


@functools.cache
def connected(profile: str) -> Session:
    """Return a connection over which a control is read and never changed."""
    return open_session(scene_control(profile))[0]


def replies(profile: str, *requests: Request) -> list[Reply]:
    session = connected(profile)
    (answer,) = FrameReader().feed(
        session.receive(bytes(Frame(FrameType.COMMANDS, write_requests(requests))))
    )
    return [reply for _, reply in read_replies(answer.body)]


# What was seen on controls and in what clients of others read (see docs/reference/focas-protocol.md).
# (request, status, size on series with wide values, size on old series); None: the series refuses it with code 1.
SIZES: tuple[tuple[Request, int, int | None, int | None], ...] = (
    (r(0x06, 1, 19, 2), 0, 72, 72),
    (r(0x08, 3, 4, 1003), 0, 16, 16),
    (r(0x0A), 0, 8, 8),
    (r(0x0B, 1, 1, 1), 0, 8, 8),
    (r(0x0B, 1, 1, ALL), 0, 256, 64),
    (r(0x0B, 1, 1, 0), 4, 0, 0),
    (r(0x0E, 6711, 6712, 0), 0, None, 80),
    (r(0x10, 6711, 2), 0, None, 24),
    (r(0x15, 500, 502), 0, 24, 24),
    (r(0x17), 0, 8, 8),
    (r(0x18), 0, 18, 18),
    (r(0x19), 0, 14, 14),
    (r(0x1A), 0, 4, 4),
    (r(0x1B, 0), 0, 16, 16),
    (r(0x1C), 0, 8, 8),
    (r(0x1D), 0, 4, 4),
    (r(0x23, ALL, 10, 1, 32), 0, 96, 96),
    (r(0x24), 0, 8, 8),
    (r(0x25), 0, 8, 8),
    (r(0x26, 4, ALL), 0, 256, 64),
    (r(0x26, 4, 3), 0, 8, 8),
    (r(0x26, 4, 4), 4, 0, 0),
    (r(0x30, 300, 300, ALL), 0, None, 40),
    (r(0x34, 0), 0, 268, 268),
    (r(0x34, 5), 4, 0, 0),
    (r(0x40, 5, ALL), 0, 64, 32),
    (r(0x40, 4, ALL), 0, 64, None),
    (r(0x45, 0), 0, 12, 12),
    (r(0x4A), 6, 0, 0),
    (r(0x56, 1), 0, 256, 64),
    (r(0x5D, -1), 0, 26, 26),
    (r(0x89), 0, 12, 12),
    (r(0x8A), 0, 4, 4),
    (r(0x8D, 6711, 6712, 0), 0, 528, None),
    (r(0x93, 300, 301, ALL), 0, 528, None),
    (r(0x96, 0, 0), 0, 12, None),
    (r(0x96, 24, 0), 3, 0, None),
    (r(0x97, ALL, 0), 0, 120, None),
    (r(0xA4, 2), 0, 2, 2),
    (r(0xA7, 500, 2), 0, 16, None),
    (r(0xAE), 0, 12, None),
    (r(0xB0, 1), 0, 256, None),
    (r(0xB3, 0, 9, 0, 1, data=path()), 0, 128, None),
    (r(0xB4, data=path()), 0, 8, None),
    (r(0xCF), 0, 40, None),
    (r(0xFC), 0, 256, None),
    (r(0x120, 1), 0, 8, 8),
    (r(0x8001, 10, 13, 5, 2, target=2), 0, 4, 4),
)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("row", SIZES, ids=lambda row: f"0x{row[0].command:X}{row[0].arguments}")
def test_sizes(profile: str, row: tuple[Request, int, int | None, int | None]) -> None:
    request, status, wide, old = row
    size = wide if load_profile(profile).wide_values else old
    (reply,) = replies(profile, request)
    if request.command == 0x40 and size is None:
        assert (reply.status, len(reply.payload)) == (4, 0)  # the library falls back to other commands
    else:
        assert (reply.status, len(reply.payload)) == ((1, 0) if size is None else (status, size))


# ---------------------------------------------------------------------- requests as clients of others send them

SERVO_METER = """
a0a0a0a0 0001 2101 0072 0004
001c 0001 0001 00a4 00000002 00000000 00000000 00000000 00000000
001c 0001 0001 0089 00000000 00000000 00000000 00000000 00000000
001c 0001 0001 0056 00000001 00000000 00000000 00000000 00000000
001c 0001 0001 00a4 00000002 00000000 00000000 00000000 00000000
"""
DYNAMIC = """
a0a0a0a0 0001 2101 00fe 0009
001c 0001 0001 001a 00000000 00000000 00000000 00000000 00000000
001c 0001 0001 001c 00000000 00000000 00000000 00000000 00000000
001c 0001 0001 001d 00000000 00000000 00000000 00000000 00000000
001c 0001 0001 0024 00000000 00000000 00000000 00000000 00000000
001c 0001 0001 0025 00000000 00000000 00000000 00000000 00000000
001c 0001 0001 0026 00000004 ffffffff 00000000 00000000 00000000
001c 0001 0001 0026 00000001 ffffffff 00000000 00000000 00000000
001c 0001 0001 0026 00000006 ffffffff 00000000 00000000 00000000
001c 0001 0001 0026 00000007 ffffffff 00000000 00000000 00000000
"""


def answered(profile: str, sent: bytes) -> bytes:
    session, _ = open_session(scene_control(profile))
    return session.receive(sent)


def test_the_servo_meter_of_a_31i() -> None:
    """The blocks of a capture of four axes, with three: 16 + 2, 16 + 4 for each axis, 16 + 256, 16 + 2 bytes."""
    sent = answered("31i", from_hex(SERVO_METER.encode()))
    assert sent[:12].hex() == "a0a0a0a00003210201520004"
    assert sent[12:30].hex() == "00120001000100a400000000000000020003"
    assert sent[30:58].hex() == "001c000100010089000000000000000c58000000590000005a000000"
    assert sent[58:74].hex() == "01100001000100560000000000000100"
    assert sent[74:82].hex() == "fffffffc000a0000"
    assert sent[82:330].hex() == "00000000000a0000" * 31
    assert sent[330:].hex() == "00120001000100a400000000000000020003"


def test_dynamic_data_of_a_16i() -> None:
    """The blocks of a capture of a 160i, whose spindle and distance options were missing."""
    sent = answered("16i", from_hex(DYNAMIC.encode()))
    body = 2 + 0x14 + 0x18 + 0x14 + 0x18 + 0x18 + 4 * 0x50
    assert sent[:12].hex() == f"a0a0a0a000022102{body:04x}0009"
    sizes, at = [], 12
    while at < len(sent):
        sizes.append(int.from_bytes(sent[at : at + 2], "big"))
        at += sizes[-1]
    assert sizes == [0x14, 0x18, 0x14, 0x18, 0x18, 0x50, 0x50, 0x50, 0x50]
    assert at == len(sent)


def test_a_client_of_another_reads_sequences_of_requests_in_order() -> None:
    asked = read_requests(from_hex(DYNAMIC.encode())[10:])
    assert [each.command for each in asked] == [0x1A, 0x1C, 0x1D, 0x24, 0x25, 0x26, 0x26, 0x26, 0x26]
    echoed = read_replies(answered("0i-d", from_hex(DYNAMIC.encode()))[10:])
    assert [each.command for each, _ in echoed] == [each.command for each in asked]


def test_diagnosis_records_of_old_and_new_series() -> None:
    """Captures: 8 bytes of head, then 8 values of four bytes (160i) or 32 of eight (31i), filled up behind the axes."""
    (old,) = replies("16i", r(0x30, 31, 31, 1))
    assert old.payload.hex() == "0000001f0000000200000258" + "00000000" * 7
    (new,) = replies("31i", r(0x93, 301, 301, ALL))
    assert new.payload.hex() == "0000012dffff0003fffffd08000a0000" + "00000000000a0000" * 31


def test_what_does_not_fit_a_frame_is_a_length_and_the_rest_stays_valid() -> None:
    parameter = r(0x8D, 1320, 1321, ALL)
    found = replies("31i", *[parameter] * 7, r(0x19))
    assert [reply.status for reply in found] == [0] * 5 + [2, 2, 0]
    session, _ = open_session(scene_control("31i"))
    (answer,) = FrameReader().feed(
        session.receive(bytes(Frame(FrameType.COMMANDS, write_requests([parameter] * 1200))))
    )
    assert sum(reply.status == 2 for _, reply in read_replies(answer.body)) == 1200


def test_macro_numbers_have_the_decimals_that_they_need() -> None:
    (found,) = replies("31i", r(0x15, 500, 501))
    assert found.payload.hex() == "fffff5bf000a000300000000ffffffff"
