"""Measure the FOCAS server: requests of one client, many machines in one process, what each costs."""

from __future__ import annotations

import os
import resource
import socket
import subprocess
import sys
import time
from pathlib import Path

from _measure import Figure, at_least, at_most
from _report import run_script
from polycnc.controllers.fanuc.wire import Frame, FrameReader, FrameType, Request, write_requests

PROGRAM = "O0815\nN10 G90 G1 F600 X-12.5\nN20 Y7.25\nN30 X0\nN40 Y0\nM30\n"
TICKS = os.sysconf("SC_CLK_TCK")
REQUESTS = {
    "state": [Request(0x19)],
    "positions of all axes": [Request(0x26, (4, -1, 0, 0))],
    "macro variable": [Request(0x15, (500, 500, 0, 0))],
    "state, alarm, positions in one frame": [
        *(Request(code) for code in (0x1A, 0x1C, 0x1D, 0x24, 0x25)),
        *(Request(0x26, (kind, -1, 0, 0)) for kind in (4, 1, 6, 7)),
    ],
}


class Served:
    """A process that serves machines."""

    def __init__(self, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "polycnc.cli", "serve", "--fanuc", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        assert self.process.stdout is not None
        self.said = self.process.stdout.readline()
        self.port = int(self.said.partition("127.0.0.1:")[2].split(";")[0].split(" ")[0])

    def cpu_s(self) -> float:
        """Return the processor time that it has used."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def memory_mb(self) -> float:
        """Return the memory that it holds."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * resource.getpagesize() / 1e6

    def end(self) -> None:
        """End it."""
        self.process.terminate()
        self.process.communicate()


def _open(address: str, port: int) -> socket.socket:
    line = socket.create_connection((address, port))
    line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    line.sendall(bytes(Frame(FrameType.OPEN, b"\0\2")))
    _frame(line)
    return line


def _frame(line: socket.socket) -> Frame:
    reader = FrameReader()
    while True:
        for frame in reader.feed(line.recv(65536)):
            return frame


def _per_second(
    served: Served, line: socket.socket, requests: list[Request], count: int
) -> tuple[float, float]:
    """Return requests for each second of the server's processor, and of the wall clock."""
    sent = bytes(Frame(FrameType.COMMANDS, write_requests(requests)))
    size = len(bytes(_ask(line, sent)))
    before, begin = served.cpu_s(), time.perf_counter()
    for _ in range(count):
        line.sendall(sent)
        left = size
        while left:
            left -= len(line.recv(left))
    return count / (served.cpu_s() - before), count / (time.perf_counter() - begin)


def _ask(line: socket.socket, sent: bytes) -> Frame:
    line.sendall(sent)
    return _frame(line)


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    made = []
    count = 3_000 if quick else 20_000
    program = Path(os.environ.get("TMPDIR", "/tmp")) / f"bench_focas_{os.getpid()}.nc"
    program.write_text(PROGRAM)
    served = Served("--port", "0", "--program", str(program))
    try:
        line = _open("127.0.0.1", served.port)
        for name, requests in REQUESTS.items():
            by_processor, by_wall = max(_per_second(served, line, requests, count) for _ in range(3))
            figure, note = (
                f"FOCAS, one client, a running machine: {name}",
                f"{by_wall:,.0f}/s by the wall clock",
            )
            made.append(
                at_least(figure, by_processor, "requests/s of processor", 5_000, note)
                if len(requests) == 1
                else Figure(figure, by_processor, "requests/s of processor", note=note)
            )
        line.close()
    finally:
        served.end()
        program.unlink()
    one = Served("--port", "18193")
    alone_mb = one.memory_mb()
    one.end()
    for machines in (100,) if quick else (100, 1000):
        made += _many(machines, alone_mb)
    return made


def _many(machines: int, alone_mb: float) -> list[Figure]:
    served = Served("--port", "18193", "--count", str(machines))
    try:
        lines = [_open(f"127.0.{k // 256}.{k % 256}", served.port) for k in range(1, machines + 1)]
        sent = bytes(Frame(FrameType.COMMANDS, write_requests([Request(0x19)])))
        begin = time.perf_counter()
        for line in lines:
            _ask(line, sent)
        round_s = time.perf_counter() - begin
        before, begin = served.cpu_s(), time.perf_counter()
        time.sleep(5.0)
        share = (served.cpu_s() - before) / (time.perf_counter() - begin) * 100.0
        each_mb = (served.memory_mb() - alone_mb) / (machines - 1)
        for line in lines:
            line.close()
    finally:
        served.end()
    name = f"FOCAS, {machines} idle machines in one process"
    return [
        at_most(f"{name}: processor", share, "% of a core", 5.0)
        if machines == 100
        else Figure(f"{name}: processor", share, "% of a core"),
        Figure(f"{name}: memory of each", each_mb, "MB"),
        Figure(f"{name}: state of all, one after the other", round_s * 1e3, "ms"),
    ]


if __name__ == "__main__":
    run_script("FOCAS server", figures)
