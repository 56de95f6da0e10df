"""A served control over real sockets: an independent client, two clients, reads that come from one cycle, lost ones."""

from __future__ import annotations

import socket
import struct
import subprocess
from collections.abc import Iterator

import pytest

from polycnc.controllers.fanuc.wire import PMC, Frame, FrameType, Request, Value8, read_status
from polycnc.servers.focas import PROFILES, load_profile
from support import focas_line
from support.command import COMMAND, environment
from support.focas_line import end, serve, values

PROGRAM = "%\nO0815 (SLOW SQUARE)\nN10 G90 G1 F600 X-12.5\nN20 Y7.25\nN30 X0\nN40 Y0\nM30\n%\n"


OPEN: list[socket.socket] = []


@pytest.fixture(autouse=True)
def closed_lines() -> Iterator[None]:
    """Close the connections of each test."""
    yield
    while OPEN:
        OPEN.pop().close()


class Line(focas_line.Line):
    """A connection that is closed after its test."""

    def __init__(self, port: int, channel: int = 2) -> None:
        super().__init__(port, channel)
        OPEN.append(self.socket)


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    program = tmp_path_factory.mktemp("served") / "square.nc"
    program.write_text(PROGRAM)
    process, port = serve("--program", program, "--rate", "0.5")
    yield port
    end(process)


@pytest.mark.parametrize("profile", PROFILES)
def test_an_independent_client_reads_and_writes(profile: str) -> None:
    protocol = pytest.importorskip("pyfocas.protocol.protocol")
    process, port = serve("--profile", profile)
    client = protocol.FOCAS("127.0.0.1", port)
    try:
        assert client.connect()
        system, state = client.get_sys_info(), client.get_status_info()
        series = load_profile(profile)
        assert (system.cnc_type.strip(), system.series) == (series.cnc_type.strip(), series.series)
        assert system.axes == "03"
        assert system.max_axis == series.most_axes
        assert (state.aut, state.run, state.emergency, state.alarm) == (1, 0, 0, 0)  # MEM, reset
        client.write_macro_double(501, -2.625)
        bare = Line(port)
        assert values(bare.payload(0x15, 501, 501)) == [-2.625]
        bare.payload(0x16, 500, 500, data=bytes(Value8(3125, 3)))
        assert client.read_macro(500) == {500: 3.125}
    finally:
        client.socket.close()
        end(process)


def test_who_it_is(port: int) -> None:
    line = Line(port)
    assert (line.opened.type, line.opened.version, len(line.opened.body)) == (FrameType.OPENED, 3, 360)
    assert struct.unpack_from(">2H", line.opened.body, 16) == (3, 3)
    assert line.payload(0x18).hex() == "02020020" + b"31 MG40224.003".hex()
    assert line.payload(0x89) == b"X\0\0\0Y\0\0\0Z\0\0\0"
    assert line.payload(0xA4, 2) == b"\0\3"
    assert line.payload(0x1B, 0).hex() == "00000003" + "00030003" * 3
    assert line.payload(0xCF) == struct.pack(">i", 815) + b"O815".ljust(36, b"\0")


def test_a_running_program_is_seen_and_one_frame_is_one_cycle(port: int) -> None:
    line = Line(port)
    mode, run = struct.unpack_from(">2H", line.payload(0x19))
    assert (mode, run) == (1, 3)  # MEM, STRT
    assert struct.unpack(">2i", line.payload(0x1C)) == (815, 815)
    seen = set()
    for _ in range(40):
        first, machine, going, again, sequence = line.commands(
            *(Request(0x26, (kind, -1, 0, 0)) for kind in (4, 1, 7)),
            Request(0x26, (4, -1, 0, 0)),
            Request(0x1D),
        )
        assert first == again
        assert len(first.payload) == 32 * 8
        x, y, z = values(first.payload)[:3]
        assert values(machine.payload)[:3] == [x, y, z]
        assert x is not None
        assert y is not None
        assert z == 0.0
        assert -12.5 <= x <= 0.0
        assert 0.0 <= y <= 7.25
        assert min(abs(x), abs(x + 12.5), abs(y), abs(y - 7.25)) < 1e-9  # on a side of the square
        assert going.status == 0
        (number,) = struct.unpack(">i", sequence.payload)
        seen.add(number)
    assert seen <= {0, 10, 20, 30, 40}
    assert len(line.payload(0x26, 4, 2)) == 8


def test_data_is_written_and_read_back_as_another_client_sees_it(port: int) -> None:
    one, two = Line(port), Line(port)
    one.payload(0xA8, 502, data=struct.pack(">d", -0.03125))
    assert values(two.payload(0x15, 502, 502)) == [-0.03125]
    assert struct.unpack(">d", two.payload(0xA7, 502, 1)) == (-0.03125,)
    one.payload(0xA8, 502, data=struct.pack(">d", float("nan")))
    assert two.payload(0x15, 502, 502).hex() == "00000000ffffffff"
    (unknown,) = one.commands(Request(0x15, (5000, 5000, 0, 0)))
    assert (unknown.status, unknown.payload) == (3, b"")
    number, axis, kind = struct.unpack_from(">Ihh", one.payload(0x8D, 1320, 1320, 1))
    assert (number, axis, kind) == (1320, 1, 3)
    (old,) = one.commands(Request(0x0E, (1320, 1320, 1, 0)))
    assert old.status == 1  # later series know the new code only


def test_the_pmc_acts(port: int) -> None:
    line = Line(port)
    before = line.payload(0x8001, 12, 12, 0, 0, target=PMC)
    line.payload(0x8002, 12, 12, 0, 0, data=b"\xcd", target=PMC)  # 255 - 205: 50 %
    assert line.payload(0x8001, 12, 12, 0, 0, target=PMC) == b"\xcd"
    line.payload(0x8002, 12, 12, 0, 0, data=before, target=PMC)
    (protected,) = line.commands(Request(0x8002, (0, 0, 1, 0), b"\1", PMC))
    assert protected.status == 7


def test_programs_come_and_go_on_their_own_channel(port: int) -> None:
    line = Line(port, channel=1)
    body = bytes((0, 0, 0, 1)) + b"N:".ljust(512, b"\0")
    for status, text in (((0, 0, 0), b"\nO4711 (NEW)\nG4 X.5\nM30\n%"), ((5, 4, 0), b"\nO4711\nM30\n%")):
        assert line.ask(Frame(FrameType.DOWNLOAD_START, body)).type == FrameType.DOWNLOAD_STARTED
        line.socket.sendall(bytes(Frame(FrameType.DOWNLOAD_DATA, text[:7])))
        line.socket.sendall(bytes(Frame(FrameType.DOWNLOAD_DATA, text[7:])))
        end = line.ask(Frame(FrameType.DOWNLOAD_END))
        assert (read_status(end.body) if end.body else (0, 0, 0)) == status
    name = bytes((0, 0, 0, 1)) + b"O4711-O4711".ljust(512, b"\0")
    assert line.ask(Frame(FrameType.UPLOAD_START, name)).type == FrameType.UPLOAD_STARTED
    assert line.next().body == b"%\nO4711(NEW)\nG4X.5\nM30\n%"  # without spaces, as memory keeps it
    assert line.next().type == FrameType.UPLOAD_FINISHED
    line.socket.sendall(bytes(Frame(FrameType.UPLOAD_ACKNOWLEDGED)))
    commands = Line(port)
    listed = commands.payload(0x06, 1, 10, 2)
    assert [struct.unpack_from(">I", listed, at)[0] for at in range(0, len(listed), 72)] == [815, 4711]
    assert b"NEW" in listed
    (kept,) = commands.commands(Request(0x05, (4711, 0, 0, 0)))
    assert kept.status == -1  # a program is executed: nothing is deleted
    assert commands.payload(0x06, 1, 10, 2) == listed


def test_sessions_are_limited_and_given_back(port: int) -> None:
    lines = [Line(port) for _ in range(5)]
    try:
        assert Line(port).opened.type == FrameType.OPEN_REFUSED
    finally:
        for line in lines:
            line.socket.close()
    again = Line(port)
    while again.opened.type == FrameType.OPEN_REFUSED:  # until the closed ones have been noticed
        again = Line(port)
    assert again.opened.type == FrameType.OPENED


def test_wrong_frames_reset_one_client_and_leave_the_others(port: int) -> None:
    good, bad = Line(port), Line(port)
    bad.socket.sendall(b"GET / HTTP/1.0\r\n\r\n")
    with pytest.raises(ConnectionError):
        bad.next()
    assert good.payload(0xA4, 0) == b"\0\3"


def test_only_this_computer_can_connect() -> None:
    done = subprocess.run(
        [*COMMAND, "serve", "--fanuc", "--address", "0.0.0.0"],
        capture_output=True,
        text=True,
        env=environment(),
    )
    assert done.returncode == 2
    assert "no address of this computer alone" in done.stderr
