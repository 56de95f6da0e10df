"""Served controls as processes: many at once, faults on real sockets, clients that misbehave, and sudden ends."""

from __future__ import annotations

import random
import socket
import struct
from pathlib import Path

import pytest

from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.fanuc.wire import Frame, FrameType, Request, read_replies, write_requests
from support.command import polycnc
from support.focas_line import Line, end, free_port, serve, values

KILLS, MANY_KILLS = 5, 50
SEED = 815


def test_several_machines_in_one_process_are_machines_of_their_own() -> None:
    process, port = serve("--count", "3", "--axes", "2", port=free_port())
    try:
        lines = [Line(port, address=f"127.0.0.{k}") for k in (1, 2, 3)]
        for k, line in enumerate(lines, 1):
            line.payload(0xA8, 501, 1, data=struct.pack(">d", -1.5 * k))
        assert [values(line.payload(0x15, 501, 501)) for line in lines] == [[-1.5], [-3.0], [-4.5]]
        with pytest.raises(ConnectionError):
            Line(port, address="127.0.0.4")
        for line in lines:
            line.close()
    finally:
        assert "Traceback" not in end(process)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--count", "3", "--memory", "m.db"), "3 controls cannot share m.db"),
        (("--count", "3", "--port", "0"), "several controls on port 0"),
        (
            ("--count", "300", "--address", "127.255.255.1"),
            "there are no 300 addresses from 127.255.255.1 on",
        ),
        (("--faults", "none.toml"), "cannot read 'none.toml'"),
    ],
)
def test_what_cannot_be_served_is_said(arguments: tuple[str, ...], said: str, tmp_path: Path) -> None:
    done = polycnc("serve", "--fanuc", *arguments, cwd=tmp_path, status=2)
    assert done.stdout == ""
    assert said in done.stderr


FAULTS = """
[[fault]]
kind = "drop"
at_request = 3
for_requests = 1

[[fault]]
kind = "half"
at_request = 5
for_requests = 1

[[fault]]
kind = "emergency_stop"
at_request = 6
for_requests = 2

[[fault]]
kind = "unreachable"
at_request = 9
for_requests = 2
"""


def test_faults_on_real_sockets(tmp_path: Path) -> None:
    (tmp_path / "faults.toml").write_text(FAULTS)
    process, port = serve("--faults", tmp_path / "faults.toml")
    state = Frame(FrameType.COMMANDS, write_requests([Request(0x19)]))

    def emergency(line: Line) -> int:
        ((_, reply),) = read_replies(line.ask(state).body)
        return int(struct.unpack_from(">5H", reply.payload)[4])

    try:
        line, spare = Line(port), Line(port)
        assert [emergency(line), emergency(line)] == [0, 0]
        with pytest.raises(ConnectionResetError):
            line.ask(state)
        line.close()
        line = Line(port)
        assert emergency(line) == 0
        with pytest.raises(ConnectionError):
            line.ask(state)
        assert 0 < line.frames.pending < len(bytes(state))
        line.close()
        assert [emergency(spare) for _ in range(3)] == [1, 1, 0]
        assert emergency(spare) == 0  # the ninth: now nobody listens
        while True:
            try:
                Line(port, timeout_s=0.5).close()
            except ConnectionRefusedError:
                break
            except (ConnectionError, TimeoutError):
                continue  # it was in the queue of the socket when that was closed
        assert [emergency(spare), emergency(spare)] == [0, 0]
        while True:
            try:
                line = Line(port, timeout_s=0.5)
            except (ConnectionError, TimeoutError):
                continue
            break
        assert emergency(line) == 0
        line.close()
        spare.close()
    finally:
        assert "Traceback" not in end(process)


def test_a_client_that_only_sends_stops_nobody() -> None:
    process, port = serve("--count", "2", port=free_port())
    try:
        flood = socket.create_connection(("127.0.0.1", port))
        flood.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        flood.sendall(bytes(Frame(FrameType.OPEN, b"\0\2")))
        flood.setblocking(False)
        asked = bytes(Frame(FrameType.COMMANDS, write_requests([Request(0x26, (4, -1, 0, 0))] * 5))) * 50
        good, other = Line(port), Line(port, address="127.0.0.2")
        full = 0
        while full < 20:  # until the server takes no more
            try:
                flood.send(asked)
            except BlockingIOError:
                full += 1
            assert good.payload(0xA4, 2) == b"\0\3"
            assert other.payload(0xA4, 1) == b"\0\1"
        memory_kb = int(
            next(
                line
                for line in Path(f"/proc/{process.pid}/status").read_text().splitlines()
                if "VmRSS" in line
            ).split()[1]
        )
        assert memory_kb < 600_000
        flood.close()
        good.close()
        other.close()
    finally:
        assert "Traceback" not in end(process)


# ---------------------------------------------------------------------- sudden ends


def writes(chance: random.Random) -> tuple[Request, str, int, float]:
    """Return a request that writes, and what it writes where."""
    value = chance.randrange(-900_000, 900_000)
    match chance.randrange(4):
        case 0:
            number = chance.randrange(500, 520)
            return Request(0xA8, (number, 1, 0, 0), struct.pack(">d", value / 8)), "macro", number, value / 8
        case 1:
            number = chance.randrange(1, 20)
            return (
                Request(0x09, (number, number, 1003, 0), struct.pack(">iHh", value, 0, -1)),
                "tool",
                number,
                value,
            )
        case 2:
            number = chance.randrange(1, 7)
            return (
                Request(0x0C, (number, number, 2, 0), struct.pack(">iHh", value, 0, -1)),
                "work",
                number,
                value,
            )
        case _:
            number = chance.randrange(0, 50)
            data = bytes((value & 0xFF,))
            return Request(0x8002, (number, number, 9, 0), data, 2), "pmc", number, value & 0xFF


def held(control: PowerMate, kind: str, number: int) -> float | None:
    """Return what a control holds at a place."""
    match kind:
        case "macro":
            return control.macros.get(number)
        case "tool":
            return control.tool_offsets.get(number)
        case "work":
            return round(control.control.offsets[f"G{53 + number}"]["Y"] * 1000.0)
        case _:
            return control.pmc.read("D", number, number)[0]


def kill_in_the_middle(path: Path, kills: int) -> None:
    chance = random.Random(SEED)
    known: dict[tuple[str, int], float] = {}
    for _ in range(kills):
        process, port = serve("--memory", path)
        line = Line(port)
        for _ in range(chance.randrange(1, 120)):
            request, kind, number, value = writes(chance)
            (reply,) = line.commands(request)
            assert reply.status == 0
            known[kind, number] = value
        flying = [writes(chance) for _ in range(chance.randrange(1, 30))]
        for request, *_ in flying:
            line.socket.sendall(bytes(Frame(FrameType.COMMANDS, write_requests([request]))))
        process.kill()
        process.communicate()
        line.close()
        control = PowerMate(memory=path)
        for (kind, number), value in known.items():
            allowed = {value, *(each for _, of, at, each in flying if (of, at) == (kind, number))}
            assert held(control, kind, number) in allowed
        for _, kind, number, _ in flying:  # what came through of the last ones is known from now on
            try:
                found = held(control, kind, number)
            except KeyError:
                continue
            if found is not None:
                known[kind, number] = found
        control.close()


def test_a_killed_process_loses_nothing_that_it_acknowledged(tmp_path: Path) -> None:
    kill_in_the_middle(tmp_path / "machine.db", KILLS)


@pytest.mark.long
@pytest.mark.timeout(0)
def test_fifty_killed_processes_lose_nothing_that_they_acknowledged(tmp_path: Path) -> None:
    kill_in_the_middle(tmp_path / "machine.db", MANY_KILLS)
